"""What users type, from end to end: results, messages and exit codes."""

import json
import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from results import made
from typer.testing import CliRunner, Result

import mckibben as mk
from mckibben.app.cli import app
from mckibben.app.fields import case_text
from mckibben.experiments import run as experiment
from mckibben.spec import presets
from mckibben.spec.text import from_mapping

pytestmark = pytest.mark.app

CASE = """
[muscle]
preset = "paper"
[test]
kind = "isometric"
length = "115 mm"
pressure = "0 to 1 bar"
points = 3
"""
BEYOND = 'test.length="130 mm"'
"""Every state lies beyond full extension, so that nothing is compiled: fast."""
COMMANDS = (
    "run", "sweep", "limits", "working-range", "force-map", "check", "presets", "data check", "plot",
    "view", "reproduce", "info", "simulate",
)  # fmt: skip


def invoke(*words: object) -> Result:
    """A command in this process; nothing but an exit may come out of it."""
    result = CliRunner().invoke(app, [str(word) for word in words])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result


def typed(*words: object) -> subprocess.CompletedProcess[str]:
    """A command as users type it, in a process of its own."""
    call = [sys.executable, "-c", "from mckibben.app.cli import main; main()", *map(str, words)]
    return subprocess.run(call, capture_output=True, text=True, encoding="utf-8")


def refused(result: Result | subprocess.CompletedProcess[str], *said: str) -> None:
    """Exit code 2 with one message on stderr that says all of `said`."""
    code = result.exit_code if isinstance(result, Result) else result.returncode
    assert (code, result.stdout) == (2, ""), result.stderr
    assert result.stderr.startswith("mckibben: ")
    assert result.stderr.count("\n") == 1
    for words in said:
        assert words in result.stderr


@pytest.fixture
def case(tmp_path: Path) -> Path:
    path = tmp_path / "case.toml"
    path.write_text(CASE, encoding="utf-8")
    return path


def test_run_plot_info_as_typed(case: Path, tmp_path: Path) -> None:
    output, picture = tmp_path / "out.nc", tmp_path / "force.png"
    done = typed("run", case, "--json", "-o", output)
    assert (done.returncode, done.stderr) == (0, "")
    drawn = typed("plot", output, "-o", picture)
    assert (drawn.returncode, drawn.stderr) == (0, "")
    assert picture.read_bytes().startswith(b"\x89PNG")
    told = invoke("info", output)
    assert told.exit_code == 0
    for words in ("isometric test, 3 states", "3 stable", "braid.fibres", "115 mm", "mckibben 0."):
        assert words in told.stdout

    printed, result = json.loads(done.stdout), mk.load(output)
    assert result.muscle == presets.paper()
    assert set(result.verdict) == {"stable"}
    assert printed["complete"] is True
    assert printed["file"] == str(output)
    assert printed["assumed"] == list(result.muscle.assumed)
    assert printed["units"]["force"] == "N"
    assert [state["force"] for state in printed["states"]] == result.force.tolist()
    assert result.force[-1] == pytest.approx(101.221, abs=2e-3)  # the theory page's reference value
    assert from_mapping({"muscle": printed["muscle"], "test": printed["test"]}).test == result.test
    assert mk.load(mk.save(result, tmp_path / "again.nc")) == result


@pytest.mark.parametrize(
    ("kind", "suffix", "start"),
    [
        ("auto", ".png", b"\x89PNG"),
        ("profiles", ".pdf", b"%PDF"),
        ("tension", ".svg", b"<?xml"),
        ("energy", ".PNG", b"\x89"),
    ],
)
def test_pictures(tmp_path: Path, kind: str, suffix: str, start: bytes) -> None:
    result = made(presets.paper(), mk.Isobaric(pressure="1 bar", length="85 mm to 130 mm", points=4), reached=3)
    output, picture = mk.save(result, tmp_path / "out.nc"), tmp_path / f"out{suffix}"
    words = ["plot", output, "--kind", kind] + ([] if kind == "auto" else ["-o", picture])
    assert invoke(*words).exit_code == 0
    assert picture.read_bytes().startswith(start)
    refused(invoke(*words), "exists; give --force")
    refused(invoke("plot", output, "-o", tmp_path / "force.gif"), "must end in .png", ".pdf")
    assert invoke(*words, "--force").exit_code == 0


def test_part_that_is_not_there_exits_3_and_is_saved(case: Path, tmp_path: Path) -> None:
    output = tmp_path / "out.nc"
    done = invoke("run", case, "--set", BEYOND, "-o", output)
    assert (done.exit_code, done.stderr) == (3, "")
    for words in ("no equilibrium", "states 0 to 2: no equilibrium: the fibres are straight at 128.7", "saved to"):
        assert words in done.stdout
    assert "assumed, not measured: braid.fibres = 56" in done.stdout
    assert mk.load(output).reached == 0
    told = invoke("info", output)
    assert "3 no equilibrium" in told.stdout
    assert "none reached" in told.stdout


def test_json_has_null_where_there_is_no_number(case: Path) -> None:
    done = invoke("run", case, "--set", BEYOND, "--json")
    assert (done.exit_code, done.stderr) == (3, "")
    printed = json.loads(done.stdout, parse_constant=lambda word: pytest.fail(f"{word} is not JSON"))
    assert printed["complete"] is False
    assert printed["states"][0]["force"] is None
    assert "straight" in printed["states"][0]["reason"]


def test_quiet_is_silent(case: Path, tmp_path: Path) -> None:
    done = invoke("run", case, "--set", BEYOND, "--quiet", "-o", tmp_path / "out.csv")
    assert (done.exit_code, done.stdout, done.stderr) == (3, "", "")
    assert "McKibben muscle, isometric test" in (tmp_path / "out.csv.txt").read_text(encoding="utf-8")
    refused(invoke("run", case, "--set", "braid.angle=37", "--quiet"), "braid.angle = 37")


WRONG = [
    ("braid.angel=36 deg", ["muscle.braid.angel: unknown key", 'did you mean "angle"?']),
    ("braid.radius=12.5 N", ['wrong kind of unit, "N"', "braid.radius"]),
    ("braid.radius=12.5 furlongz", ['unknown unit "furlongz"']),
    ("braid.angle=0 deg", ["braid.angle = 0 deg: must be above 0 deg and below 90 deg"]),
    ("braid.angle=90 deg", ["braid.angle = 90 deg: must be above 0 deg and below 90 deg", 'angle_from = "axis"']),
    ("braid.radius=-1 mm", ["braid.radius = -1 mm: must be above 0 mm"]),
    ("braid.fibres=700", ["the fibres overlap", "use at most"]),
    ("braid.fibres=57", ["must be even"]),
    ("chamber.law.name=moony", ["is unknown", "mooney-rivlin"]),
    ("test.kind=isometrisch", ["test.kind", 'did you mean "isometric"?']),
    ("test.pressure=0 to bar", ["test.pressure"]),
    ("test.points=0", ["test.points = 0: must be at least 1"]),
    ("braid.angle", ["must be name=value"]),
]


@pytest.mark.parametrize(("override", "said"), WRONG, ids=[override for override, _ in WRONG])
@pytest.mark.parametrize("command", ["run", "check"])
def test_wrong_input_is_one_message(case: Path, command: str, override: str, said: list[str]) -> None:
    refused(invoke(command, case, "--set", override), *said)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (None, "there is no such file"),
        (b"[muscle\n", "is not valid TOML"),
        (b"\xff\xfe", "is not UTF-8 text"),
        (b"", "muscle: is missing"),
        (b'[muscle]\npreset = "papr"\n[test]\nkind = "isometric"\n', 'did you mean "paper"?'),
        (b'[muscle]\npreset = "paper"\n', "test: is missing"),
    ],
)
def test_unreadable_case(tmp_path: Path, content: bytes | None, said: str) -> None:
    if content is not None:
        (tmp_path / "case.toml").write_bytes(content)
    refused(invoke("run", tmp_path / "case.toml"), said)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["-o", "there.nc"], "exists; give --force to replace it"),
        (["-o", "out.xls"], "must end in .nc"),
        (["-o", "no/folder/out.nc"], "there is no folder"),
        (["-o", "case.toml/out.nc"], "case.toml"),
        (["--tolerance", "0"], "tolerance"),
        (["--tolerance", "nan"], "tolerance"),
    ],
)
def test_what_would_lose_the_result_is_refused_before_solving(
    case: Path, monkeypatch: pytest.MonkeyPatch, words: list[str], said: str
) -> None:
    monkeypatch.chdir(case.parent)
    Path("there.nc").write_text("precious")

    def solving(*_: object, **__: object) -> None:
        pytest.fail("solved before checking")

    monkeypatch.setattr(experiment, "_follow", solving)
    refused(invoke("run", case, *words), said)
    assert Path("there.nc").read_text() == "precious"


def test_files_that_are_no_result(case: Path, tmp_path: Path) -> None:
    half = tmp_path / "half.nc"
    assert invoke("run", case, "--set", BEYOND, "--quiet", "-o", half).exit_code == 3
    half.write_bytes(half.read_bytes()[:40_000])
    (tmp_path / "text.nc").write_text("not HDF5")
    for command in ("plot", "info"):
        refused(invoke(command, half), "is cut short or damaged")
        refused(invoke(command, tmp_path / "text.nc"), "is no NetCDF-4 file")
        refused(invoke(command, tmp_path / "missing.nc"), "there is no such file")
    assert not half.with_suffix(".png").exists()


def test_wrong_input_as_typed(case: Path) -> None:
    refused(typed("run", case, "--set", "braid.angle=95 deg"), "braid.angle = 95 deg")
    for words in (["--colour", "red"], ["--discretisation", "finite"], ["--tolerance", "small"]):
        done = invoke("run", case, *words)
        assert (done.exit_code, done.stdout) == (2, "")
        assert "Traceback" not in done.stderr
    assert invoke("runn").exit_code == 2


def test_interruption(case: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(experiment, "run", interrupt)
    done = invoke("run", case)
    assert (done.exit_code, done.stdout) == (130, "")
    assert done.stderr.startswith("mckibben: interrupted")


def test_check_shows_what_is_understood(case: Path) -> None:
    shown = invoke("check", case, "--set", "braid.fibre.diameter=0.3 mm", "--set", BEYOND)
    assert shown.exit_code == 0
    lines = {line.split()[0]: line for line in shown.stdout.splitlines() if line.strip()}
    assert "37 deg" in lines["braid.angle"]
    assert "ASSUMED" in lines["braid.fibres"]
    assert "ASSUMED" not in lines["braid.fibre.diameter"]  # given now
    assert "[1]" in lines["braid.radius"]
    assert "RoboSoft 2023" in lines["[1]"]
    assert "mooney-rivlin" in lines["chamber.law"]
    assert "0 bar to 1 bar" in lines["pressure"]
    assert "128.779 mm" in lines["full"]
    assert "asks for a length of 130 mm" in lines["note:"]
    for words in ("fibre stiffness B1", "N mm^2", "jamming room", "shear modulus", "17 kPa"):
        assert words in shown.stdout


def test_check_needs_no_test_and_no_chamber(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text('[muscle]\npreset = "reference"\nchamber = "none"\n', encoding="utf-8")
    shown = invoke("check", path)
    assert shown.exit_code == 0
    assert "There is no test" in shown.stdout
    assert "jamming room" not in shown.stdout


@pytest.mark.parametrize("name", presets.names())
def test_presets(name: str, tmp_path: Path) -> None:
    assert name in invoke("presets").stdout
    assert ("ASSUMED" in invoke("presets", name).stdout) == bool(presets.get(name).assumed)
    written = invoke("presets", name, "--toml").stdout
    assert written == case_text(name)
    assert from_mapping(tomllib.loads(written)).muscle == presets.get(name)
    (tmp_path / "case.toml").write_text(written, encoding="utf-8")
    checked = invoke("check", tmp_path / "case.toml")
    assert checked.exit_code == 0
    assert "note:" not in checked.stdout


def test_presets_that_are_not_there() -> None:
    refused(invoke("presets", "papr"), 'did you mean "paper"?')
    refused(invoke("presets", "--toml"), "needs the name of a preset")


def test_reproduce_refuses_before_it_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(experiment, "_follow", lambda *_, **__: pytest.fail("solved before checking"))
    (tmp_path / "fig4_cases_a_to_d.png").write_text("precious")
    refused(invoke("reproduce", "-o", tmp_path), "fig4_cases_a_to_d.png")
    refused(invoke("reproduce", "-o", tmp_path / "fig4_cases_a_to_d.png"), "cannot be made")
    refused(invoke("reproduce", "-o", tmp_path, "--measured", "lab.csv"), "must be CASE=FILE.csv")
    refused(invoke("reproduce", "-o", tmp_path, "--measured", f"a={tmp_path}/lab.csv"), "cannot be read")


@pytest.mark.parametrize("command", ["", *COMMANDS])
def test_help_teaches(command: str) -> None:
    shown = invoke(*command.split(), "--help")
    assert shown.exit_code == 0
    assert "Examples" in shown.stdout
    assert f"mckibben {command}".rstrip() in shown.stdout.split("Examples")[1]


def test_help_and_version_import_nothing_heavy() -> None:
    code = """
import sys
from typer.testing import CliRunner
from mckibben.app.cli import app
for words in (["--help"], ["run", "--help"], ["--version"]):
    assert CliRunner().invoke(app, words).exit_code == 0
heavy = {"jax", "numpy", "xarray", "matplotlib", "scipy", "pint"} & sys.modules.keys()
assert not heavy, heavy
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


LIGHT = """
import sys
from typer.testing import CliRunner
import mckibben as mk
from mckibben.app.cli import app
heavy = set(sys.argv[1].split(","))
done = CliRunner().invoke(app, sys.argv[2:])
assert done.exit_code == 0, done.output
assert not heavy & sys.modules.keys(), heavy & sys.modules.keys()
"""


@pytest.mark.parametrize(
    ("words", "heavy"),
    [
        (("presets",), "jax,scipy,pint,xarray,pandas,matplotlib"),
        (("presets", "paper", "--toml"), "jax,scipy,pint,xarray,pandas,matplotlib"),
        (("check", "case.toml"), "jax,scipy,pint,xarray,pandas,matplotlib"),
        (("info", "made.nc"), "jax,matplotlib"),
        (("plot", "made.nc"), "jax"),
    ],
)
def test_what_solves_nothing_loads_no_solver(tmp_path: Path, words: tuple[str, ...], heavy: str) -> None:
    paper = mk.presets.paper()
    (tmp_path / "case.toml").write_text(invoke("presets", "paper", "--toml").stdout, encoding="utf-8")
    mk.save(made(paper, mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=5), 5), tmp_path / "made.nc")
    call = [sys.executable, "-c", LIGHT, heavy, *words]
    done = subprocess.run(call, capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0, done.stderr


def test_a_second_run_compiles_nothing_and_stays_light(tmp_path: Path) -> None:
    """Nor does it need what is heavy to show its states, or to save them as a file with everything."""
    (tmp_path / "case.toml").write_text(invoke("presets", "paper", "--toml").stdout, encoding="utf-8")
    environment = os.environ | {"MCKIBBEN_CACHE": str(tmp_path / "compiled")}
    kept: list[set[Path]] = []
    for heavy, output in (("matplotlib", "first.nc"), ("xarray,pandas,matplotlib,dask", "second.nc")):
        call = [sys.executable, "-c", LIGHT, heavy, "run", "case.toml", "-o", output]
        done = subprocess.run(call, capture_output=True, text=True, cwd=tmp_path, env=environment)
        assert done.returncode == 0, done.stderr
        kept.append(set((tmp_path / "compiled").rglob("*.kernel")))
    assert kept[0] == kept[1] != set()
    first, second = (mk.load(tmp_path / f"{name}.nc") for name in ("first", "second"))
    assert (first.force == second.force).all()


def test_installation() -> None:
    shown = invoke("info")
    assert shown.exit_code == 0
    for words in ("mckibben", "jax", "python", "JAX platforms", "compiled functions"):
        assert words in shown.stdout

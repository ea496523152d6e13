"""How a fit is kept and shown: files, pictures, the fit file, the command. One small fit serves all."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import mckibben as mk
from mckibben.app.cli import app
from mckibben.fitting.fitfile import read_fit
from mckibben.spec.text import to_toml

pytestmark = pytest.mark.app

FREE = {"braid.angle": "35 deg to 39 deg", "chamber.law.c1": "4 kPa to 20 kPa"}


def bench() -> mk.Data:
    """Two curves of the paper's muscle, of 8 points each, with noise of 0.2 N."""
    parts = []
    for bar in (0.5, 1.0):
        curve = mk.run(mk.presets.paper(), mk.Isobaric(length="80 mm to 112 mm", pressure=f"{bar} bar", points=8))
        parts.append((curve.length, curve.pressure, curve.force))
    length, pressure, force = (np.concatenate(column) for column in zip(*parts, strict=True))
    noise = np.random.default_rng(4).normal(0.0, 0.2, len(force))
    return mk.read_data({"length [m]": length, "pressure [Pa]": pressure, "force [N]": force + noise})


@pytest.fixture(scope="module")
def data() -> mk.Data:
    return bench()


@pytest.fixture(scope="module")
def fit(data: mk.Data) -> mk.Fit:
    return mk.fit(mk.presets.paper(), data, FREE, starts=1)


def test_a_fit_is_loaded_as_it_was_saved(fit: mk.Fit, tmp_path: Path) -> None:
    path = mk.save(fit, tmp_path / "fit.nc")
    found = mk.load(path)
    assert isinstance(found, mk.Fit)
    assert found == fit
    assert hash(found) == hash(fit)
    assert found != fit.data
    for name in fit.data.variables:
        assert found.data[name].values.dtype.kind == fit.data[name].values.dtype.kind
        assert not found.data[name].values.flags.writeable
    assert found.data.attrs == fit.data.attrs
    assert found.table.equals(fit.table)
    test = mk.Isobaric(length="85 mm to 105 mm", pressure="1 bar", points=3)
    np.testing.assert_array_equal(found.predict(test).error, fit.predict(test).error)
    with pytest.raises(mk.SpecError, match="exists"):
        mk.save(fit, path)
    assert mk.save(fit, path, force=True) == path


def test_a_damaged_fit_is_refused(fit: mk.Fit, tmp_path: Path) -> None:
    path = mk.save(fit, tmp_path / "fit.nc")
    content = path.read_bytes()
    rng = np.random.default_rng(0)
    for at in rng.integers(0, len(content), 40).tolist():
        path.write_bytes(content[:at] + bytes([content[at] ^ 0x10]) + content[at + 1 :])
        with pytest.raises(mk.SpecError, match=r"damaged|no NetCDF-4") as told:
            mk.load(path)
        assert "\n" not in str(told.value)
    for size in (0, 100, len(content) // 2, len(content) - 1):
        path.write_bytes(content[:size])
        with pytest.raises(mk.SpecError, match=r"damaged|empty"):
            mk.load(path)


def test_a_result_is_no_fit_nor_the_reverse(fit: mk.Fit, tmp_path: Path) -> None:
    from mckibben.files import fits, netcdf, store

    path = mk.save(fit, tmp_path / "fit.nc")
    for load in (netcdf.load, store.load_result):
        with pytest.raises(mk.SpecError, match="holds a fit, not a result"):
            load(path)
    curve = mk.run(mk.presets.paper(), mk.Isobaric(length="85 mm to 105 mm", pressure="1 bar", points=3))
    other = mk.save(curve, tmp_path / "curve.nc")
    assert mk.load(other) == curve
    with pytest.raises(mk.SpecError, match="holds no fit"):
        fits.load(other)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda data: data.drop_vars("predicted"), "holds no predicted"),
        (lambda data: data.assign(force=data["force"].astype(str)), "holds force"),
        (lambda data: data.assign_attrs(given="ends = ["), "not TOML"),
        (lambda data: data.assign_attrs(given="ends = 'none'"), "cannot be built again"),
        (lambda data: data.assign_attrs(level="high"), "does not say its level"),
    ],
)
def test_a_fit_of_another_make_is_refused(fit: mk.Fit, tmp_path: Path, change: object, said: str) -> None:
    other = change(fit.data).assign_attrs(holds="fit")  # type: ignore[operator]
    other.to_netcdf(tmp_path / "other.nc", engine="h5netcdf")
    with pytest.raises(mk.SpecError, match=said) as told:
        mk.load(tmp_path / "other.nc")
    assert "\n" not in str(told.value)


def test_the_table_of_a_fit(fit: mk.Fit, tmp_path: Path) -> None:
    import pandas as pd

    path = mk.save(fit, tmp_path / "points.csv")
    table = pd.read_csv(path)
    np.testing.assert_allclose(table["residual [N]"], fit.residuals, rtol=1e-12)
    np.testing.assert_allclose(table["force [N]"], fit.data["force"].values, rtol=1e-14)
    assert list(table["test"]) == list(fit.data["test"].values)
    notes = (tmp_path / "points.csv.txt").read_text(encoding="utf-8")
    assert "braid.angle: " in notes
    assert "[braid]" in notes
    with pytest.raises(mk.SpecError, match="is a table only"):
        mk.load(path)


def test_the_picture_of_a_fit(fit: mk.Fit) -> None:
    figure = mk.plot(fit)
    forces, residuals, strips = figure.axes
    assert forces.get_xlabel() == residuals.get_xlabel() == "Contraction (%)"
    assert [tick.get_text() for tick in strips.get_xticklabels()] == ["0.5 bar", "1 bar"]
    drawn = np.concatenate([np.asarray(line.get_ydata()) for line in residuals.lines if line.get_marker() != "None"])
    np.testing.assert_allclose(np.sort(drawn), np.sort(fit.residuals), rtol=1e-12)
    said = figure.get_suptitle().replace("\u00a0", " ").replace("\n", " ")
    assert f"rms {fit.rms:.3g} N ({fit.percent:.2g} % of the largest force)" in said
    assert f"largest difference {fit.largest:.3g} N" in said
    assert "braid.angle" in figure.get_supxlabel()
    assert "are assumed" in figure.get_supxlabel()
    with pytest.raises(mk.SpecError, match="is for a result"):
        mk.plot(fit, kind="tension")
    page = fit._repr_html_()
    assert page is not None
    assert page.count("<img") == 1
    assert str(fit.table.loc["braid.angle", "value"]) in page


@pytest.mark.parametrize("tests", [1, 3, 30])
@pytest.mark.parametrize("isometric", [False, True])
def test_pictures_of_many_tests(fit: mk.Fit, tests: int, isometric: bool) -> None:
    rng, count = np.random.default_rng(0), 10 * tests
    names = np.repeat([f"a test with a long name, {k}" for k in range(tests)], 10)
    levels, ramp = np.repeat(np.arange(tests), 10), np.tile(np.arange(10), tests)
    length, pressure = (0.08 + 1e-3 * levels, 1e4 * ramp) if isometric else (0.08 + 3e-3 * ramp, 1e4 * (1 + levels))
    force = 1e-3 * pressure
    columns = {"length": length, "pressure": pressure, "force": force, "predicted": force + rng.normal(size=count)}
    data = fit.data.drop_dims("point").assign({name: ("point", values) for name, values in columns.items()})
    data = data.assign(test=("point", names), branch=("point", np.array(["loading", "unloading"] * (count // 2))))
    data["undetermined"] = ("number", np.array([False, True]))
    figure = mk.plot(type(fit)(fit.muscle, fit.given, data))
    assert figure.axes[0].get_xlabel() == ("Pressure (bar)" if isometric else "Contraction (%)")
    assert len(figure.legends[0].get_texts()) <= 30
    assert "Not determined by these data: chamber.law.c1." in figure.get_supxlabel()


def test_residuals_over_both_where_both_vary(fit: mk.Fit) -> None:
    data = fit.data.assign(pressure=("point", np.linspace(1e4, 1e5, len(fit.residuals))))
    labels = {axes.get_xlabel() for axes in mk.plot(type(fit)(fit.muscle, fit.given, data)).axes}
    assert labels == {"Contraction (%)", "Pressure (bar)"}


FILE = """
[muscle]
preset = "paper"

[data]
file = "bench.csv"
points = 6
branch = "loading"

[free]
"braid.angle" = "35 deg to 39 deg"
chamber.law.c1 = "4 kPa to 20 kPa"

[weights]
"0.5 bar" = 2

[options]
starts = 1
"""


@pytest.fixture
def file(data: mk.Data, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    data.to_pandas().to_csv("bench.csv", index=False)
    path = tmp_path / "fit.toml"
    path.write_text(FILE, encoding="utf-8")
    return path


def test_a_fit_file_says_what_fit_takes(file: Path) -> None:
    asked = read_fit(file, ["options.starts=3", "free.braid.angle=36 deg to 38 deg", "braid.fibres=60"])
    assert asked.free == {"braid.angle": "36 deg to 38 deg", "chamber.law.c1": "4 kPa to 20 kPa"}
    assert asked.muscle.braid.fibres == 60
    assert asked.options == {"starts": 3, "weights": {"0.5 bar": 2.0}}
    assert (asked.data.tests, len(asked.data)) == (("0.5 bar", "1 bar"), 12)
    only = read_fit(file, ['data.only=["1 bar"]', "data.points=8"]).data
    assert (only.tests, len(only)) == (("1 bar",), 8)
    several = read_fit(file, ['data.file=["bench.csv", "bench.csv"]']).data
    assert len(several.tests) == 4


@pytest.mark.parametrize(
    ("override", "said"),
    [
        ("data.fiel=a.csv", 'data.fiel: unknown key; did you mean "file"'),
        ("data.file=3", "data.file = 3: must be text or a list of texts"),
        ("data.file=[]", "data.file"),
        ("data.file=none.csv", "none.csv"),
        ("data.points=1", "data.points = 1: must be a whole number, at least 3"),
        ("data.points=true", "data.points = True: must be a whole number"),
        ("data.only=2 bar", "data.only = .*: is no test of these data"),
        ("data.branch=up", "data.branch = .*: must be one of loading, unloading, unknown"),
        ("data.branch=unloading", "data.branch = .*: has no points; there are: loading"),
        ("options.start=2", 'options.start: unknown key; did you mean "starts"'),
        ("options.starts=0", "options.starts = 0: must be from 1 to 1000"),
        ("options.tolerance=1", "options.tolerance = 1: must be from 1e-10 to 0.01"),
        ("options.profiles=yes", "options.profiles = .*: must be true or false"),
        ("weights.1 bar=much", "weights.1 bar = .*: must be a number"),
        ("braid.angel=1 deg", "braid.angel"),
    ],
)
def test_what_is_wrong_in_a_fit_file_is_named(file: Path, override: str, said: str) -> None:
    with pytest.raises(mk.SpecError, match=said) as told:
        read_fit(file, [override])
    assert "\n" not in str(told.value)


SEVERAL = (
    FILE.replace("[data]", "[[data]]")
    + """
[[data]]
file = "bench.csv"
only = "1 bar"
set."braid.fibres" = 60
"""
)


def test_a_fit_file_of_several_muscles(file: Path) -> None:
    file.write_text(SEVERAL, encoding="utf-8")
    asked = read_fit(file)
    assert [int(one.braid.fibres) for one in asked.muscle] == [56, 60]
    assert [len(one) for one in asked.data] == [12, 8]
    file.write_text(SEVERAL.replace("fibres", "fibers"), encoding="utf-8")
    with pytest.raises(mk.SpecError, match="fibers"):
        read_fit(file)
    file.write_text(SEVERAL.replace('only = "1 bar"', 'only = "2 bar"'), encoding="utf-8")
    with pytest.raises(mk.SpecError, match=r"data\[1\].only = .*: is no test of these data"):
        read_fit(file)


def test_a_fit_of_several_muscles_is_kept_and_drawn(fit: mk.Fit, tmp_path: Path) -> None:
    """Made from a fit of one, so that nothing is solved again."""
    other = fit.muscle.replace("braid.length", "120 mm")
    of = np.repeat([0, 1], len(fit.residuals) // 2)
    data = fit.data.assign({"further": ("further_muscle", [to_toml(other)]), "of": ("point", of)})
    both = mk.Fit(fit.muscle, fit.given, data, (other,))
    mk.save(both, tmp_path / "both.nc")
    again = mk.load(tmp_path / "both.nc")
    assert again == both
    assert again.muscles == (fit.muscle, other)
    assert "2 muscles" in repr(again)
    np.testing.assert_allclose(again.rest_lengths, np.where(of, 0.12, 0.085))
    assert "2 muscles, 16 points" in mk.plot(again).get_suptitle()
    mk.save(both, tmp_path / "both.csv")
    texts = [one.read_text(encoding="utf-8") for one in tmp_path.glob("both.*") if one.suffix != ".nc"]
    assert any("the fitted muscle, number 2 (TOML):" in text for text in texts)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (FILE.replace("[free]", "[frei]"), 'frei: unknown key; did you mean "free"'),
        (FILE.replace("[data]", "[options.data]"), "data: is missing; write a"),
        ("free = 3\n" + FILE.replace("[free]", "[priors]"), "free = 3: must be a table"),
        (FILE.replace('file = "bench.csv"', ""), "data.file: is missing"),
    ],
)
def test_tables_that_are_missing_are_named(file: Path, text: str, said: str) -> None:
    file.write_text(text, encoding="utf-8")
    with pytest.raises(mk.SpecError, match=said):
        read_fit(file)


def test_a_fit_file_is_no_case(file: Path) -> None:
    for command in ("run", "check", "sweep"):
        done = CliRunner().invoke(app, [command, str(file)])
        assert done.exit_code == 2
        assert "describes a fit; give it to mckibben fit" in done.stderr


def test_command(file: Path) -> None:
    runner = CliRunner()
    done = runner.invoke(app, ["fit", str(file), "-o", "fit.nc", "--plot", "fit.png", "--muscle", "fitted.toml"])
    assert done.exit_code == 0, done.output
    for said in ("braid.angle", "95 % interval", "0.5 bar", "R² 0.99", "muscles tried in", "saved to fit.nc"):
        assert said in done.stdout
    assert Path("fit.png").read_bytes().startswith(b"\x89PNG")
    found = mk.load("fit.nc")
    assert isinstance(found, mk.Fit)
    assert mk.read_case("fitted.toml", test_required=False).muscle == found.muscle
    assert runner.invoke(app, ["check", "fitted.toml"]).exit_code == 0
    assert runner.invoke(app, ["plot", "fit.nc", "-o", "again.png"]).exit_code == 0
    assert Path("again.png").read_bytes() == Path("fit.png").read_bytes()
    held = runner.invoke(app, ["info", "fit.nc"])
    assert "a fit of 2 numbers to 12 points" in held.stdout
    refused = runner.invoke(app, ["fit", str(file), "-o", "fit.nc"])
    assert refused.exit_code == 2
    assert "exists" in refused.stderr
    assert runner.invoke(app, ["plot", "fit.nc", "--data", "bench.csv", "-o", "b.png"]).exit_code == 2


def test_command_for_programs(file: Path) -> None:
    runner = CliRunner()
    done = runner.invoke(app, ["fit", str(file), "--json", "--set", "free.braid.angle=36.5 deg to 37.5 deg"])
    assert done.exit_code == 0, done.output
    found = json.loads(done.stdout)
    angle = found["numbers"]["braid.angle"]
    assert angle["determined"]
    assert angle["low"] < angle["value"] < angle["high"]
    assert np.rad2deg(angle["value"]) == pytest.approx(37.0, abs=0.3)
    assert [one["name"] for one in found["tests"]] == ["0.5 bar", "1 bar"]
    assert found["muscle"]["braid"]["fibres"] == 56
    profiled = json.loads(runner.invoke(app, ["fit", str(file), "--json", "--profiles"]).stdout)
    assert profiled["intervals"] == "profile likelihood"
    quiet = runner.invoke(app, ["fit", str(file), "-q", "-o", "points.csv"])
    assert (quiet.exit_code, quiet.output) == (0, "")
    assert Path("points.csv.txt").exists()
    wrong = runner.invoke(app, ["fit", str(file), "--json", "--set", "free.braid.angel=1 deg to 2 deg"])
    assert wrong.exit_code == 2
    assert 'did you mean \\"braid.angle\\"' in wrong.stdout


def test_a_search_that_had_not_settled_exits_3(fit: mk.Fit, file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data = fit.data.assign_attrs(converged=0, message="too long")
    data["undetermined"] = ("number", np.array([False, True]))
    lost = type(fit)(fit.muscle, fit.given, data)
    monkeypatch.setattr("mckibben.fitting.fit.fit", lambda *_, **__: lost)
    done = CliRunner().invoke(app, ["fit", str(file), "-o", "fit.nc"])
    assert done.exit_code == 3
    assert "not determined" in done.stdout
    assert "had not settled" in done.stdout
    assert "had not settled" in CliRunner().invoke(app, ["info", "fit.nc"]).stdout
    found = json.loads(CliRunner().invoke(app, ["fit", str(file), "--json"]).stdout)
    assert found["numbers"]["chamber.law.c1"]["value"] is None
    assert not found["converged"]


def test_looking_at_files_loads_no_solver(fit: mk.Fit, tmp_path: Path) -> None:
    curve = mk.run(mk.presets.paper(), mk.Isobaric(length="85 mm to 105 mm", pressure="1 bar", points=3))
    mk.save(curve, tmp_path / "curve.nc")
    mk.save(fit, tmp_path / "fit.nc")
    script = """
import sys
from typer.testing import CliRunner
import mckibben as mk
from mckibben.app.cli import app
mk.load("curve.nc")
assert not {"jax", "matplotlib", "mckibben.results.fit"} & sys.modules.keys()
for words in (["info", "fit.nc"], ["plot", "fit.nc"], ["fit", "--help"]):
    assert CliRunner().invoke(app, words).exit_code == 0
assert "jax" not in sys.modules
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0, done.stderr

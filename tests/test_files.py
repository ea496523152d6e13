"""Results in files: what is loaded equals what was saved, and no file is ever half old, half new or silently wrong."""

import csv
import errno
import os
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path

import attrs
import numpy as np
import pandas as pd
import pytest
import xarray as xr
from results import made

import mckibben as mk
from mckibben import disk
from mckibben.results.result import Result
from mckibben.results.variables import FIELDS
from mckibben.spec.text import muscle_from_mapping, test_from_mapping

pytestmark = pytest.mark.files

PAPER = mk.presets.paper()
CURVE = mk.Isobaric(pressure="1 bar", length="118 mm to 130 mm", points=5)


@pytest.fixture(scope="module")
def incomplete() -> Result:
    return made(PAPER, CURVE, reached=3)


def same(a: Result, b: Result) -> bool:
    """Equal, also in types, and as well protected."""
    types = all(a.data[name].dtype.kind == b.data[name].dtype.kind for name in a.data)
    return a == b and types and not any(b.data[name].values.flags.writeable for name in b.data)


@pytest.mark.parametrize(
    ("muscle", "test", "reached"),
    [
        (PAPER, CURVE, 3),
        (mk.presets.reference(), mk.Isometric(length="115 mm", pressure=[0.0, 12345.678901234567]), 2),
        (
            PAPER.replace("chamber", mk.Chamber(thickness=1e-3, law=mk.Ogden(mu=[1e4, 2e3], alpha=[1.3, -2.0]))),
            mk.Protocol(
                steps=[
                    mk.Step(length="to 115 mm", pressure=0.0, points=3),
                    mk.Step(length="hold", pressure="0 to 1 bar", points=4),
                    mk.Step(pressure="hold", force="to 0 N", points=2),
                ]
            ),
            4,
        ),
        (mk.Muscle(braid=PAPER.braid, name='bare "braid", ends = [free]\n'), CURVE, 0),
    ],
    ids=["assumed", "list", "protocol", "bare"],
)
def test_loaded_equals_saved(
    tmp_path: Path, muscle: mk.Muscle, test: mk.Isobaric | mk.Protocol | mk.Isometric, reached: int
) -> None:
    result = made(muscle, test, reached)
    again = mk.load(mk.save(result, tmp_path / "out.nc"))
    assert same(result, again)
    assert again.verdict == result.verdict
    assert again.reached == reached


def test_a_run_is_saved_and_loaded(tmp_path: Path) -> None:
    result = mk.run(PAPER, attrs.evolve(CURVE, points=4))
    assert set(result.verdict) == {"stable", "no equilibrium"}
    assert same(result, mk.load(mk.save(result, tmp_path / "run.nc")))


def test_table_says_what_it_is(tmp_path: Path, incomplete: Result) -> None:
    path = mk.save(incomplete, tmp_path / "out.csv")
    lines = path.read_text(encoding="utf-8").splitlines()
    comments = Path(f"{path}.txt").read_text(encoding="utf-8").splitlines()
    assert "mckibben 0.1.0" in comments[1]
    assert "2026-01-01" in comments[1]
    assert "braid.fibres" in comments[2]
    assert "warning: neighbouring fibres touch" in comments
    start, middle = comments.index("the muscle (TOML):"), comments.index("the test (TOML):")
    assert muscle_from_mapping(tomllib.loads("\n".join(comments[start + 1 : middle]))) == PAPER
    assert test_from_mapping(tomllib.loads("\n".join(comments[middle + 1 :]))) == CURVE
    rows = list(csv.DictReader(lines))
    frame = pd.read_csv(path)
    assert frame["force [N]"].tolist()[:3] == incomplete.force[:3].tolist()
    assert frame["largest_diameter [m]"][0] == 2.0 * incomplete.column("r")[0].max()
    assert frame["peak_fibre_tension [N]"][0] == incomplete.column("fibre_tension")[0].max()
    assert frame["safety_factor"].isna().all()  # no breaking force is given
    assert [float(row["force [N]"]) for row in rows[:3]] == incomplete.force[:3].tolist()
    assert {"contraction", "pressure [Pa]", "volume [m^3]", "energy [J]"} <= rows[0].keys()
    assert not set(FIELDS) & rows[0].keys()
    lost = [rows[3][name] for name in ("force [N]", "length [m]", "converged", "verdict")]
    assert lost == ["", "", "false", "no equilibrium"]
    assert rows[3]["reason"] == incomplete.data["reason"].values[3]


@pytest.mark.parametrize("name", ["out.nc", "out.csv"])
def test_nothing_is_replaced_unless_asked(tmp_path: Path, incomplete: Result, name: str) -> None:
    path = tmp_path / name
    path.write_text("precious")
    with pytest.raises(mk.SpecError, match=r"exists; give --force"):
        mk.save(incomplete, path)
    assert path.read_text() == "precious"
    mk.save(incomplete, path, force=True)
    assert path.stat().st_size > 1000
    assert sorted(os.listdir(tmp_path)) == sorted({name, *([f"{name}.txt"] if name.endswith(".csv") else [])})


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("out.xlsx", r"must end in \.nc .* or \.csv"),
        ("out", "must end in"),
        ("missing/out.nc", "there is no folder"),
        ("file/out.nc", "there is no folder|cannot be written"),
        ("folder.nc", "is a folder"),
        ("nu\0ll.nc", "no name of a file"),
    ],
)
def test_places_that_cannot_be_written(tmp_path: Path, incomplete: Result, name: str, said: str) -> None:
    (tmp_path / "file").write_text("")
    (tmp_path / "folder.nc").mkdir()
    with pytest.raises(mk.SpecError, match=said) as error:
        mk.save(incomplete, tmp_path / name, force=True)
    assert "\n" not in str(error.value)


def test_every_cut_is_noticed(tmp_path: Path, incomplete: Result) -> None:
    whole = mk.save(incomplete, tmp_path / "whole.nc").read_bytes()
    path = tmp_path / "cut.nc"
    for size in {0, 1, 7, 8, 9, 47, 48, 96, 511, *range(600, len(whole), 4001), len(whole) - 1}:
        path.write_bytes(whole[:size])
        with pytest.raises(mk.SpecError, match=r"is empty|is no NetCDF-4 file|is cut short or damaged") as error:
            mk.load(path)
        assert "\n" not in str(error.value)


def test_damage_is_a_clear_error(tmp_path: Path, incomplete: Result, capfd: pytest.CaptureFixture[str]) -> None:
    whole = mk.save(incomplete, tmp_path / "whole.nc").read_bytes()
    path, rng, noticed = tmp_path / "damaged.nc", np.random.default_rng(0), 0
    for _ in range(40):
        damaged = bytearray(whole)
        for at in rng.integers(0, len(whole), 60):
            damaged[at] = rng.integers(256)
        path.write_bytes(damaged)
        try:
            mk.load(path)
        except mk.SpecError:
            noticed += 1
    assert noticed == 40
    assert capfd.readouterr().err == ""


def test_no_damage_passes_for_whole(tmp_path: Path, incomplete: Result) -> None:
    """A bit, a cut or a run of zeros anywhere: an error, without which HDF5 would give other content or never end."""
    whole = mk.save(incomplete, tmp_path / "whole.nc").read_bytes()
    path, rng = tmp_path / "damaged.nc", np.random.default_rng(1)
    for turn in range(60):
        at, damaged = int(rng.integers(len(whole))), bytearray(whole)
        if turn % 3 == 0:
            damaged[at] ^= 1 << int(rng.integers(8))
        elif turn % 3 == 1:
            del damaged[at:]
        else:
            damaged[at : at + 4096] = bytes(len(damaged[at : at + 4096]))
        if damaged != whole:
            path.write_bytes(damaged)
            with pytest.raises(mk.SpecError, match=r"is cut short or damaged|is no NetCDF-4 file"):
                mk.load(path)


def test_what_is_damaged_is_said(tmp_path: Path, incomplete: Result) -> None:
    whole, path = mk.save(incomplete, tmp_path / "whole.nc").read_bytes(), tmp_path / "damaged.nc"

    def said(find: bytes) -> str:
        at = whole.index(find)
        path.write_bytes(whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :])
        with pytest.raises(mk.SpecError) as caught:
            mk.load(path)
        return str(caught.value)

    assert "damaged: force not as written" in said(incomplete.force[:3].tobytes())
    assert "damaged: r not as written" in said(incomplete.data["r"].values[1].tobytes())
    assert "damaged: its text or description not as written" in said(b"the fibres are straight")
    assert "damaged: its seal not as written" in said(b"\nmckibben seal ")
    path.write_bytes(whole + b"more")
    with pytest.raises(mk.SpecError, match="is cut short or damaged: its"):
        mk.load(path)


def test_the_seal_is_no_trouble_to_others(tmp_path: Path, incomplete: Result) -> None:
    path = mk.save(incomplete, tmp_path / "out.nc")
    with xr.open_dataset(path) as data:
        assert data["force"].identical(incomplete.data["force"])
        rewritten = data.load().copy()
    rewritten.to_netcdf(tmp_path / "by_xarray.nc", engine="h5netcdf")
    assert mk.load(tmp_path / "by_xarray.nc") == incomplete


def test_files_that_hold_no_result(tmp_path: Path, incomplete: Result) -> None:
    path = tmp_path / "other.nc"

    def refused(data: xr.Dataset, said: str) -> None:
        data.to_netcdf(path, engine="h5netcdf")
        with pytest.raises(mk.SpecError, match=said):
            mk.load(path)

    refused(xr.Dataset({"x": ("t", [1.0, 2.0])}), "holds no result of mckibben")
    refused(incomplete.data.drop_vars("force"), "holds no force per step")
    refused(incomplete.data.assign(force=incomplete.data["r"]), "holds no force per step")
    refused(incomplete.data.assign(force=incomplete.data["verdict"]), "holds force as")
    refused(incomplete.data.drop_vars("v"), "holds no coordinate v")
    refused(incomplete.data.assign_attrs(muscle="[["), "is not TOML")
    refused(incomplete.data.assign_attrs(test='kind = "isometic"'), r"test\.kind = isometic: is unknown")
    for name, said in (("missing.nc", "no such file"), ("out.csv", "is a table only"), ("", "cannot be read")):
        with pytest.raises(mk.SpecError, match=said):
            mk.load(tmp_path / name)


def test_a_law_of_ones_own_is_saved_but_not_rebuilt(tmp_path: Path) -> None:
    law = mk.CustomLaw(function=lambda l1, l2, l3, constants: constants["a"] * (l1 - 1.0) ** 2, constants={"a": 1e4})
    result = made(mk.Muscle(braid=PAPER.braid, chamber=mk.Chamber(thickness="1 mm", law=law)), CURVE, reached=2)
    path = mk.save(result, tmp_path / "own.nc")
    with pytest.raises(mk.SpecError, match=r"a law of your own .* xarray\.open_dataset"):
        mk.load(path)
    with xr.open_dataset(path, engine="h5netcdf") as data:
        assert data["force"].identical(result.data["force"])


@pytest.mark.parametrize("broken", ["fsync", "replace", "fdopen"])
def test_a_failed_write_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, broken: str) -> None:
    path = tmp_path / "out.nc"
    path.write_bytes(b"old")

    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(disk.os, broken, full)
    with pytest.raises(mk.SpecError, match="cannot be written: No space left on device"):
        disk.write(path, b"new", force=True)
    assert path.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["out.nc"]


def test_an_interrupted_write_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "out.nc"
    path.write_bytes(b"old")

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(disk.os, "fsync", interrupt)
    with pytest.raises(KeyboardInterrupt):
        disk.write(path, b"new", force=True)
    assert path.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["out.nc"]


WRITER = """
import sys
from mckibben.disk import write
turn = 0
while True:
    turn += 1
    write(sys.argv[1], bytes([turn % 256]) * 3_000_000, force=True)
    print(turn, flush=True)
"""


@pytest.mark.skipif(os.name != "posix", reason="kills by signal")
def test_a_kill_leaves_a_whole_file(tmp_path: Path) -> None:
    path = tmp_path / "out.bin"
    for pause in (0.011, 0.023):
        with subprocess.Popen([sys.executable, "-c", WRITER, str(path)], stdout=subprocess.PIPE) as writer:
            assert writer.stdout is not None
            writer.stdout.readline()
            time.sleep(pause)
            writer.send_signal(signal.SIGKILL)
        content = path.read_bytes()
        assert len(content) == 3_000_000
        assert len(set(content)) == 1


@pytest.mark.skipif(os.name != "posix", reason="links and permissions")
def test_links_and_permissions_stay(tmp_path: Path) -> None:
    real, link = tmp_path / "real.nc", tmp_path / "link.nc"
    real.write_bytes(b"old")
    real.chmod(0o640)
    link.symlink_to(real)
    disk.write(link, b"new", force=True)
    assert link.is_symlink()
    assert real.read_bytes() == b"new"
    assert real.stat().st_mode & 0o777 == 0o640
    mask = os.umask(0o027)
    try:
        assert disk.write(tmp_path / "fresh.nc", b"").stat().st_mode & 0o777 == 0o640
    finally:
        os.umask(mask)


def untouched(path: Path) -> tuple[int, ...]:
    """What writing would change; when a link was last read is no such thing."""
    status = path.lstat()
    return status.st_mode, status.st_ino, status.st_size, status.st_mtime_ns


@pytest.mark.skipif(os.name != "posix", reason="pipes, devices and links")
@pytest.mark.parametrize("kind", ["pipe", "link to a pipe", "link to a device", "link to nothing", "link to a folder"])
def test_only_regular_files_are_replaced(tmp_path: Path, incomplete: Result, kind: str) -> None:
    path, pipe = tmp_path / "out.nc", tmp_path / "pipe"
    os.mkfifo(pipe)
    (tmp_path / "folder").mkdir()
    if kind == "pipe":
        path = pipe.rename(path)
    else:
        goal = {"pipe": pipe, "device": Path(os.devnull), "nothing": tmp_path / "gone", "folder": tmp_path / "folder"}
        path.symlink_to(goal[kind.rpartition(" ")[2]])
    before, there = untouched(path), sorted(os.listdir(tmp_path))
    for force in (False, True):
        with pytest.raises(mk.SpecError, match="is a folder" if "folder" in kind else "is no regular file"):
            mk.save(incomplete, path, force=force)
    with pytest.raises(OSError, match="is no regular file"):
        disk.replace(path, b"")
    assert (untouched(path), sorted(os.listdir(tmp_path))) == (before, there)


def test_a_file_that_comes_in_between_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "out.nc"
    monkeypatch.setattr(disk.os, "fsync", lambda _: path.write_bytes(b"of someone else"))
    with pytest.raises(mk.SpecError, match="exists"):
        disk.write(path, b"new")
    assert path.read_bytes() == b"of someone else"
    assert os.listdir(tmp_path) == ["out.nc"]


def test_what_a_killed_process_left_is_taken_by_the_next(tmp_path: Path) -> None:
    left = tmp_path / ".c.0.tmp"
    left.write_bytes(b"half of it, and longer")
    disk.replace(tmp_path / "c.0", b"whole", alone=True)
    assert (tmp_path / "c.0").read_bytes() == b"whole"
    assert os.listdir(tmp_path) == ["c.0"]


def test_a_folder_comes_whole_or_not_at_all(tmp_path: Path) -> None:
    path = tmp_path / "out"

    def fill(text: str, broken: bool = False) -> None:
        with disk.new_folder(path) as made:
            made.mkdir()
            (made / "inside").write_text(text, encoding="utf-8")
            if broken:
                raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fill("never", broken=True)
    assert os.listdir(tmp_path) == []
    fill("first")
    fill("second")
    with pytest.raises(KeyboardInterrupt):
        fill("never", broken=True)
    assert (path / "inside").read_text(encoding="utf-8") == "second"
    assert os.listdir(tmp_path) == ["out"]


@pytest.mark.skipif(os.name != "posix", reason="numbers of processes")
def test_what_dead_processes_left_is_cleared(tmp_path: Path) -> None:
    """Folders and files, by the next write to the same name; what is of others or of living processes stays."""
    with subprocess.Popen([sys.executable, "-c", ""]) as process:
        process.wait()
    dead, alive, machine = process.pid, os.getppid(), disk._here().partition(".")[0]
    left = [f".out.{dead}.tmp", f".out.{machine}.{dead}.0123abcd.tmp", f".out.{machine}.{dead}.0123abcd.old"]
    stays = [
        f".out.{alive}.tmp", f".out.{machine}.{alive}.0123abcd.tmp", f".out.ffffff.{dead}.0123abcd.tmp",
        f".other.{dead}.tmp", f"out.{dead}.tmp", f".out.{dead}.txt", f".out.nc.{dead}.tmp",
    ]  # fmt: skip
    for name in (*left, *stays):
        (tmp_path / name).mkdir()
        (tmp_path / name / "inside").write_text("half")
    with disk.new_folder(tmp_path / "out") as made:
        made.mkdir()
    assert sorted(os.listdir(tmp_path)) == sorted([*stays, "out"])
    half = tmp_path / f".out.nc.{machine}.{dead}.89abcdef.tmp"
    half.write_bytes(b"half")
    disk.write(tmp_path / "out.nc", b"whole")
    assert not half.exists()
    assert not (tmp_path / f".out.nc.{dead}.tmp").exists()
    assert (tmp_path / f".out.{alive}.tmp").exists()


@pytest.mark.skipif(os.name != "posix", reason="kills by signal")
def test_a_killed_writer_leaves_nothing_for_good(tmp_path: Path) -> None:
    script = """
import os, signal, sys
from pathlib import Path
from mckibben import disk
with disk.new_folder(Path(sys.argv[1])) as made:
    made.mkdir()
    os.kill(os.getpid(), signal.SIGKILL)
"""
    for _ in range(2):
        assert subprocess.run([sys.executable, "-c", script, str(tmp_path / "out.zarr")]).returncode == -signal.SIGKILL
    assert len(os.listdir(tmp_path)) == 1  # the second has cleared what the first left
    with disk.new_folder(tmp_path / "out.zarr") as made:
        made.mkdir()
    assert os.listdir(tmp_path) == ["out.zarr"]

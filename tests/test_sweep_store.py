"""Sweeps in a Zarr store: what is in it, and that a sweep that was cut short goes on to the same chunk files."""

import errno
import json
import os
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

import mckibben as mk
from mckibben.app.cli import app
from mckibben.sweeps import chunk
from mckibben.sweeps import store as sweeps

pytestmark = pytest.mark.sweeps

MUSCLE = mk.presets.paper()
TEST = mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3)
OVER = {"braid.angle": ["36 deg", "37 deg"], "braid.fibres": [40, 56, 400], "ends": ["clamped", "pinned"]}
"""The last third does not fit side by side."""
CHUNKS = 3  # of 5, 5 and 2 designs


def content(store: Path) -> dict[str, bytes]:
    """Every file of a store but the descriptions, which hold the date."""
    return {
        file.relative_to(store).as_posix(): file.read_bytes()
        for file in store.rglob("*")
        if file.is_file() and file.name != "zarr.json"
    }


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An undisturbed sweep."""
    store = tmp_path_factory.mktemp("sweep") / "whole.zarr"
    mk.sweep(MUSCLE, TEST, OVER, to=store, workers=0, chunk=5)
    return store


def again(store: Path, **options: object) -> xr.Dataset:
    return mk.sweep(MUSCLE, TEST, OVER, **({"to": store, "workers": 0, "chunk": 5} | options))


def test_a_store_holds_what_memory_does(whole: Path) -> None:
    in_memory, loaded = mk.sweep(MUSCLE, TEST, OVER, workers=0, chunk=5), mk.load(whole)
    assert list(in_memory.variables) == list(loaded.variables)
    assert loaded.sizes == in_memory.sizes
    for name, variable in in_memory.variables.items():
        np.testing.assert_array_equal(loaded[name].values.astype(variable.dtype), variable.values)
        assert loaded[name].attrs == variable.attrs
    assert {k: v for k, v in loaded.attrs.items() if k != "date"} == {
        k: v for k, v in in_memory.attrs.items() if k != "date"
    }
    opened = xr.open_zarr(whole)
    assert dict(opened.sizes) == {"design": 12, "step": 3}
    np.testing.assert_array_equal(opened.force.values.ravel(), in_memory.force.values.ravel())
    assert opened["ends"].values.tolist() == ["clamped", "pinned"] * 6
    assert opened["braid.angle"].attrs["units"] == "rad"
    assert opened.status.attrs["flag_meanings"].split() == [
        "pending", "complete", "incomplete", "wrong_input", "failed"
    ]  # fmt: skip


def test_a_finished_sweep_is_not_solved_again(whole: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = content(whole)
    monkeypatch.setattr(chunk, "solve_together", lambda *_, **__: pytest.fail("solved again"))
    again(whole)
    again(whole, workers=None)
    assert content(whole) == before


@pytest.mark.parametrize("after", range(CHUNKS))
def test_a_full_disk_keeps_what_is_finished(
    whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, after: int
) -> None:
    """The disk fills while chunk number `after` is written, half of its files being there already."""
    store, write, left = tmp_path / "out.zarr", sweeps._write, [int((after + 0.5) * len(sweeps.STATES | sweeps.DESIGN))]

    def limited(path: Path, data: bytes) -> None:
        left[0] -= 1
        if left[0] < 0:
            path.with_name(f".{path.name}.tmp").write_bytes(data[:7])
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        write(path, data)

    with monkeypatch.context() as patch:
        patch.setattr(sweeps, "_write", limited)
        with pytest.raises(mk.SweepError, match="the disk is full; what is finished is kept"):
            again(store)
    status = mk.load(store).status.values.ravel()
    assert (status[: 5 * after] >= 0).all()
    assert (status[5 * after :] == -1).all()
    told: list[tuple[int, int]] = []
    again(store, watch=lambda *said: told.append(said))
    assert told[0] == (5 * after, 12)
    assert content(store) == content(whole)


def test_half_written_and_failed_chunks_are_solved_again(whole: Path, tmp_path: Path) -> None:
    store = tmp_path / "out.zarr"
    again(store)
    (store / "status" / "c.1").unlink()
    (store / "force" / "c.1.0").write_bytes(b"\0" * 17)
    (store / "status" / "c.0").write_bytes(bytes([0, 3, 0, 0, 0]))  # a design of the first failed
    (store / "volume" / "c.0.0").unlink()
    again(store)
    assert content(store) == content(whole)


def test_interruption_keeps_what_is_finished(whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store, together, left = tmp_path / "out.zarr", chunk.groups, [2]

    def interrupted(*args: object, **options: object) -> object:
        left[0] -= 1
        if left[0] == 0:
            raise KeyboardInterrupt
        return together(*args, **options)

    with monkeypatch.context() as patch:
        patch.setattr(chunk, "groups", interrupted)
        with pytest.raises(KeyboardInterrupt):
            again(store)
    assert sorted(file.name for file in (store / "status").glob("c.*")) == ["c.0"]
    again(store)
    assert content(store) == content(whole)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"tolerance": 1e-5}, "tolerance is 1e-06 there and 1e-05 here"),
        ({"chunk": 4}, "chunk is 5 there and 4 here"),
        (
            {"muscle": MUSCLE.replace("chamber.thickness", "2 mm")},
            "muscle.chamber.thickness is 0.001 there and 0.002 here",
        ),
        (
            {"test": mk.Isometric(length="110 mm", pressure="0 to 1 bar", points=3)},
            "test.length is 0.115 there and 0.11",
        ),
        (
            {"over": OVER | {"braid.fibres": [40, 56, 402]}},
            "over.braid.fibres is [40, 56, 400] there and [40, 56, 402] here",
        ),
        ({"over": dict(reversed(OVER.items()))}, "fields is ["),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_another_sweep_is_refused(whole: Path, changes: dict[str, object], said: str) -> None:
    asked = {"muscle": MUSCLE, "test": TEST, "over": OVER, "to": whole, "workers": 0, "chunk": 5} | changes
    with pytest.raises(mk.SpecError) as caught:
        mk.sweep(**asked)
    assert "holds another sweep" in str(caught.value)
    assert said in str(caught.value)


def test_what_is_no_store_is_left_alone(tmp_path: Path) -> None:
    folder = tmp_path / "precious.zarr"
    folder.mkdir()
    (folder / "thesis.tex").write_text("precious")
    for force in (False, True):
        with pytest.raises(mk.SpecError, match="is no store of a sweep"):
            again(folder, force=force)
    (folder / "zarr.json").write_text('{"attributes": {}}')
    with pytest.raises(mk.SpecError, match="is no store of a sweep of mckibben"):
        again(folder, force=True)
    assert (folder / "thesis.tex").read_text() == "precious"
    with pytest.raises(mk.SpecError, match=r"must end in \.zarr"):
        again(tmp_path / "out")
    with pytest.raises(mk.SpecError, match="there is no folder"):
        again(tmp_path / "none" / "out.zarr")
    with pytest.raises(mk.SpecError, match="there is no such store"):
        mk.load(tmp_path / "none.zarr")
    assert not list(tmp_path.glob(".*"))


SWEEP = """
[muscle]
preset = "paper"
[test]
kind = "isometric"
length = "250 mm"  # beyond full extension: quick
pressure = "0 to 1 bar"
points = 3
[sweep]
chunk = 2
"""
GRID = 'over = { "braid.angle" = { from = "36 deg", to = "38 deg", points = 3 }, "ends" = ["clamped", "pinned"] }'


def invoke(*words: object) -> tuple[int, str, str]:
    done = CliRunner().invoke(app, [str(word) for word in words])
    assert done.exception is None or isinstance(done.exception, SystemExit), done.exception
    return done.exit_code, done.stdout, done.stderr


def test_command_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file, store = tmp_path / "sweep.toml", tmp_path / "sweep.zarr"
    file.write_text(SWEEP + GRID, encoding="utf-8")
    code, shown, _ = invoke("check", file)
    assert code == 0
    assert "3: 36 to 38 deg" in shown
    assert invoke("run", file)[2] == f"mckibben: {file}: describes a sweep; give it to mckibben sweep\n"
    code, shown, errors = invoke("sweep", file, "--workers", 0)
    alone = "mckibben: 6 of 6 designs were solved one by one: 6 for states that are not there\n"
    assert (code, errors) == (3, alone)
    assert "incomplete         6   state 0: no equilibrium: the fibres" in shown
    assert "mckibben.load(" in shown
    code, shown, _ = invoke("sweep", file, "--json")  # all there: no workers are started
    assert code == 3
    assert json.loads(shown) == {
        "file": str(store), "complete": False, "designs": {"incomplete": 6},
        "dimensions": {"braid.angle": 3, "ends": 2, "step": 3},
    }  # fmt: skip
    code, shown, _ = invoke("info", store)
    assert code == 0
    for words in (
        "sweep of 6 McKibben muscles",
        "6 incomplete",
        "3: 36 to 38 deg",
        "2: clamped, pinned",
        "none reached",
    ):
        assert words in shown
    code, _, errors = invoke("sweep", file, "--set", "braid.fibres=40", "--workers", 0)
    assert code == 2
    assert "braid.fibres is 56 there and 40 here" in errors
    assert invoke("sweep", file, "--set", "braid.fibres=40", "--workers", 0, "--force", "--quiet") == (3, "", "")
    assert "holds a sweep" in invoke("plot", store)[2]

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(sweeps, "_write", full)
    code, shown, errors = invoke("sweep", file, "--workers", 0, "-o", tmp_path / "full.zarr")
    assert (code, shown) == (4, "")
    assert errors.startswith("mckibben: ")
    assert "the disk is full" in errors


def test_interruption_of_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file, single, left = tmp_path / "sweep.toml", chunk.run, [3]
    file.write_text(SWEEP + GRID, encoding="utf-8")

    def interrupted(*args: object, **options: object) -> mk.Result:
        left[0] -= 1
        if left[0] == 0:
            raise KeyboardInterrupt
        return single(*args, **options)

    monkeypatch.setattr(chunk, "run", interrupted)
    code, shown, errors = invoke("sweep", file, "--workers", 0)
    assert (code, shown) == (130, "")
    assert errors.startswith("mckibben: interrupted: about 2 of 6 designs are in ")
    assert "the same command goes on from there" in errors


def test_command_line_table(tmp_path: Path) -> None:
    file = tmp_path / "sweep.toml"
    file.write_text(SWEEP + 'designs = "designs.csv"', encoding="utf-8")
    code, _, errors = invoke("sweep", file)
    assert code == 2
    assert "there is no such file" in errors
    (tmp_path / "designs.csv").write_text("braid.angle [deg],braid.fibres\n36,56\n37,40\n38,400\n", encoding="utf-8")
    code, shown, _ = invoke("sweep", file, "--workers", 0, "--json", "-o", tmp_path / "table.zarr")
    assert code == 3
    assert json.loads(shown)["designs"] == {"incomplete": 2, "wrong input": 1}
    data = mk.load(tmp_path / "table.zarr")
    assert data["braid.fibres"].dims == ("design",)
    assert "the fibres overlap" in str(data.reason.values[2])
    assert "table" not in invoke("info", tmp_path / "table.zarr")[2]


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ("", "must give either over or designs"),
        ('over = ["braid.angle"]', "sweep.over"),
        ("designs = 3", "must be the name of a CSV file"),
        ("ovr = {}", 'did you mean "over"?'),
        ('over = { "braid.angel" = [1] }', 'did you mean "braid.angle"?'),
        ('over = { "ends" = "clamped" }', "must be a list"),
    ],
)
def test_wrong_sweep_files(tmp_path: Path, table: str, said: str) -> None:
    file = tmp_path / "sweep.toml"
    file.write_text(SWEEP + table, encoding="utf-8")
    code, shown, errors = invoke("sweep", file)
    assert (code, shown) == (2, "")
    assert said in errors
    assert errors.count("\n") == 1
    assert not (tmp_path / "sweep.zarr").exists()


def test_unquoted_dots_are_understood(tmp_path: Path) -> None:
    from mckibben.sweeps.sweepfile import read_sweep

    file = tmp_path / "sweep.toml"
    file.write_text(SWEEP + "[sweep.over]\nbraid.angle = [0.6]\nchamber.law.c1 = [1e4]\n", encoding="utf-8")
    assert read_sweep(file).over == {"braid.angle": [0.6], "chamber.law.c1": [1e4]}

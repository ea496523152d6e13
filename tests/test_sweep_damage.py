"""Stores that were damaged: never loaded as whole, and mended by the same sweep, which solves no more than it must.

The designs are beyond full extension, so that nothing needs to be solved to know it.
"""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from test_old_files import DATA
from typer.testing import CliRunner

import mckibben as mk
from mckibben.app.cli import app
from mckibben.sweeps import sweep as sweeps
from mckibben.sweeps.outcome import DESIGN, STATES

pytestmark = pytest.mark.sweeps

TEST = mk.Isometric(length="250 mm", pressure="0 to 1 bar", points=3)
OVER = {"braid.fibres": [40, 50, 56], "ends": ["clamped", "pinned"]}
CHUNKS = 3  # of 2 designs


def run(store: Path) -> xr.Dataset:
    return mk.sweep(mk.presets.paper(), TEST, OVER, to=store, workers=0, chunk=2)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    store = tmp_path_factory.mktemp("sweep") / "whole.zarr"
    run(store)
    return store


@pytest.fixture
def store(whole: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(whole, tmp_path / "out.zarr"))


@pytest.fixture
def solved(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The chunks that are solved, by their first design."""
    first, solve = [], sweeps.solve_piece

    def counted(piece, *rest):
        fibres, ends = piece.rows[0]
        first.append(2 * OVER["braid.fibres"].index(fibres) + OVER["ends"].index(str(ends)))
        return solve(piece, *rest)

    monkeypatch.setattr(sweeps, "solve_piece", counted)
    return first


def content(store: Path) -> dict[str, bytes]:
    """Every file of a store, with its date."""
    return {file.relative_to(store).as_posix(): file.read_bytes() for file in store.rglob("*") if file.is_file()}


def refused(store: Path, *words: str) -> None:
    """Loading is one clear sentence, in Python and on the command line."""
    with pytest.raises(mk.SpecError, match="is damaged") as caught:
        mk.load(store)
    assert "\n" not in str(caught.value)
    assert "run the same sweep again" in str(caught.value)
    for word in words:
        assert word in str(caught.value)
    done = CliRunner().invoke(app, ["info", str(store)])
    assert (done.exit_code, done.stdout, done.stderr) == (2, "", f"mckibben: {caught.value}\n")


def damaged(data: bytes, kind: str) -> bytes | None:
    match kind:
        case "flipped":
            return data[:-3] + bytes([data[-3] ^ 4]) + data[-2:] if len(data) > 2 else bytes([data[0] ^ 4]) + data[1:]
        case "cut":
            return data[: len(data) // 2]
        case "emptied":
            return b""
        case "longer":
            return data + b"\0"
        case _:
            return None


@pytest.mark.parametrize("kind", ["flipped", "cut", "emptied", "longer", "missing"])
@pytest.mark.parametrize("name", ["force/c.1.0", "verdict/c.1.0", "reason/c.1", "status/c.1", "status/sha256.1"])
def test_a_damaged_chunk(whole: Path, store: Path, solved: list[int], kind: str, name: str) -> None:
    before = content(whole)
    made = damaged(before[name], kind)
    if made is None:
        (store / name).unlink()
    else:
        (store / name).write_bytes(made)
    if (name, kind) == ("status/c.1", "missing"):  # pending again: what else there is counts for nothing
        data = mk.load(store)
        assert data.status.values.ravel().tolist() == [1, 1, -1, -1, 1, 1]
        assert data.verdict.values.reshape(6, 3)[2:4].tolist() == [[-1] * 3] * 2
        assert data.reason.values.ravel()[2:4].tolist() == ["", ""]
    else:
        refused(store, "chunk 1 (designs 2 to 3: ")
    run(store)
    assert solved == [2]
    assert content(store) == before


@pytest.mark.parametrize("kind", ["flipped", "cut", "emptied", "missing"])
@pytest.mark.parametrize("name", ["zarr.json", "force/zarr.json", "braid.fibres/c.0", "ends/c.0"])
def test_a_damaged_description(whole: Path, store: Path, solved: list[int], kind: str, name: str) -> None:
    before = content(whole)
    made = damaged(before[name], kind)
    if made is None:
        (store / name).unlink()
    else:
        (store / name).write_bytes(made)
    if name != "zarr.json":
        refused(store, f"its description ({name}) is not as written")
    with pytest.raises(mk.SpecError, match="damaged"):
        mk.load(store)
    run(store)
    assert solved == []
    after = content(store)
    if name == "zarr.json":  # the date may be lost with it
        before, after = ({k: v for k, v in files.items() if k != "zarr.json"} for files in (before, after))
    assert after == before
    assert mk.load(store).sizes == mk.load(whole).sizes


def test_a_word_of_the_description_that_changed(store: Path, solved: list[int]) -> None:
    text = (store / "zarr.json").read_text(encoding="utf-8")
    (store / "zarr.json").write_text(text.replace('"N"', '"M"', 1), encoding="utf-8")
    refused(store, "its description (zarr.json)")
    date = json.loads(text)["attributes"]["date"]
    assert run(store).attrs["date"] == date
    assert solved == []
    assert (store / "zarr.json").read_text(encoding="utf-8") == text


def test_chunks_that_changed_places(whole: Path, store: Path, solved: list[int]) -> None:
    for file in [*store.glob("*/c.0"), *store.glob("*/c.0.0"), store / "status" / "sha256.0"]:
        other = file.with_name(file.name.replace(".0", ".2", 1))
        if other.exists():  # coordinates have one chunk
            (was, there) = file.read_bytes(), other.read_bytes()
            file.write_bytes(there)
            other.write_bytes(was)
    refused(store, "chunk 0 (designs 0 to 1: its note), chunk 2 (designs 4 to 5: its note)")
    (store / "verdict" / "c.1.0").unlink()
    refused(store, "chunk 1 (designs 2 to 3: verdict)")
    run(store)
    assert solved == [0, 2, 4]
    assert content(store) == content(whole)


def test_a_sweep_from_before_there_were_digests(whole: Path, store: Path, solved: list[int]) -> None:
    """Its chunks are believed where they have the right form, and have digests once it is gone on with."""
    document = json.loads((store / "zarr.json").read_text(encoding="utf-8"))
    del document["attributes"]["sha256"]
    (store / "zarr.json").write_text(json.dumps(document), encoding="utf-8")
    for note in (store / "status").glob("sha256.*"):
        note.unlink()
    assert mk.load(store).identical(mk.load(whole))
    (store / "force" / "c.1.0").write_bytes(b"\0" * 17)
    refused(store, "chunk 1 (designs 2 to 3: force)")
    run(store)
    assert solved == [2]
    assert content(store) == content(whole)


@pytest.mark.parametrize("name", ["force/c.0.0", "reason/c.0", "status/c.0"])
def test_a_file_of_version_0_1_0(tmp_path: Path, name: str) -> None:
    shutil.unpack_archive(DATA / "old_sweep.zarr.zip", tmp_path)
    old = tmp_path / "old.zarr"
    (old / name).write_bytes((old / name).read_bytes()[:-1])
    refused(old, "chunk 0 (designs 0 to 1: ")


def test_damage_at_random_never_passes(whole: Path, tmp_path: Path) -> None:
    rng, loaded = np.random.default_rng(2), mk.load(whole).load()
    names = sorted(content(whole))
    assert len(names) > CHUNKS * len(STATES | DESIGN)
    for turn in range(40):
        store = Path(shutil.copytree(whole, tmp_path / f"{turn}.zarr"))
        file = store / names[rng.integers(len(names))]
        data = bytearray(file.read_bytes())
        at = int(rng.integers(len(data)))
        data[at : at + (1, len(data), 64)[turn % 3]] = (bytes([data[at] ^ 16]), b"", bytes(len(data[at : at + 64])))[
            turn % 3
        ]
        if data != file.read_bytes():
            file.write_bytes(data)
            with pytest.raises(mk.SpecError, match="is damaged"):
                mk.load(store)
        else:
            assert mk.load(store).identical(loaded)

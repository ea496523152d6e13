"""MAT files: vectors of the top level or of a struct, in the forms of MATLAB's versions, and what cannot be read."""

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.io import savemat

import mckibben as mk

pytestmark = pytest.mark.data

P, L, F = np.array([1.0, 1.0, 1.0, 1.0]), np.array([80.0, 85.0, 90.0, 95.0]), np.array([0.0, 8.0, 17.0, 27.5])
VECTORS = {"pressure_bar": P, "length_mm": L, "force_N": F}


def old(path: Path, variables: dict[str, Any], **options: Any) -> Path:
    savemat(path, variables, **options)
    return path


def new(path: Path, variables: dict[str, Any]) -> Path:
    """As MATLAB writes version 7.3: HDF5 behind a header, structs as groups, rows and columns the other way round."""
    with h5py.File(path, "w", userblock_size=512) as file:
        _put(file, variables)
    with path.open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")
    return path


def _put(group: Any, variables: dict[str, Any]) -> None:
    for name, value in variables.items():
        if isinstance(value, dict):
            inner = group.create_group(name)
            inner.attrs["MATLAB_class"] = np.bytes_("struct")
            _put(inner, value)
        elif isinstance(value, str):
            item = group.create_dataset(name, data=np.array([[ord(one)] for one in value], np.uint16))
            item.attrs["MATLAB_class"] = np.bytes_("char")
        else:
            item = group.create_dataset(name, data=np.atleast_2d(np.asarray(value, float)))
            item.attrs["MATLAB_class"] = np.bytes_("double")


def check(data: mk.Data, test: str = "1 bar") -> None:
    assert_allclose(data.pressure, 1e5)
    assert_allclose(data.length, 1e-3 * L)
    assert_allclose(data.force, F)
    assert data.tests == (test,)
    assert data.branches.tolist() == ["loading"] * 4


@pytest.mark.parametrize("form", ["4", "5"])
@pytest.mark.parametrize("as_column", ["row", "column"])
def test_vectors_of_the_top_level(form: str, as_column: str, tmp_path: Path) -> None:
    """Beside matrices, text, and vectors of something else."""
    more = {"calibration": np.eye(3), "time_s": np.arange(7.0)} | ({} if form == "4" else {"note": "first try"})
    path = old(tmp_path / "bench.mat", VECTORS | more, format=form, oned_as=as_column)
    data = mk.read_data(path)
    check(data)
    assert "of another length and left out: time_s" in data.assumptions


@pytest.mark.parametrize("write", [old, new])
def test_vectors_of_a_struct(write: Any, tmp_path: Path) -> None:
    """Compressed or HDF5; a single pressure holds for all points; units may be said."""
    bare = {"run": {"pressure_bar": 1.0, "length": L, "force_N": F, "operator": "me"}, "version": 3.0}
    data = mk.read_data(write(tmp_path / "bench.mat", bare), units={"length": "mm"})
    check(data)
    assert "pressure_bar is a single number, taken for every row" in data.assumptions


@pytest.mark.parametrize("write", [old, new])
def test_one_of_several_structs(write: Any, tmp_path: Path) -> None:
    half = VECTORS | {"force_N": 0.5 * F}
    path = write(tmp_path / "bench.mat", {"day": {"first": half, "second": VECTORS}})
    with pytest.raises(mk.SpecError) as raised:
        mk.read_data(path)
    said = 'has vectors in several structs: "day.first", "day.second"; say sheet="day.first" (--sheet)'
    assert str(raised.value) == f"bench.mat: {said}"
    check(mk.read_data(path, sheet="day.second"))
    with pytest.raises(mk.SpecError, match=r"day.secnd.* is none of its structs; did you mean"):
        mk.read_data(path, sheet="day.secnd")


def test_a_struct_array_and_texts(tmp_path: Path) -> None:
    runs = np.array([(P, L, F), (2.0 * P, L, 2.0 * F)],
                    dtype=[("pressure_bar", object), ("length_mm", object), ("force_N", object)])  # fmt: skip
    path = old(tmp_path / "bench.mat", {"run": runs})
    check(mk.read_data(path, sheet="run(1)"))
    assert_allclose(mk.read_data(path, sheet=2).pressure, 2e5)
    branches = np.array(["up", "up", "down", "down"], object)
    data = mk.read_data(old(tmp_path / "words.mat", VECTORS | {"branch": branches}))
    assert data.branches.tolist() == ["loading", "loading", "unloading", "unloading"]


def test_cells_of_a_new_file(tmp_path: Path) -> None:
    path = new(tmp_path / "bench.mat", VECTORS)
    with h5py.File(path, "r+") as file:
        words = file.create_group("#refs#")
        cells = [words.create_dataset(f"{k}", data=np.array([[ord(one)] for one in said], np.uint16))
                 for k, said in enumerate(("up", "up", "up", "down"))]  # fmt: skip
        for cell in cells:
            cell.attrs["MATLAB_class"] = np.bytes_("char")
        file.create_dataset("branch", data=np.array([[cell.ref for cell in cells]], h5py.ref_dtype))
        file["branch"].attrs["MATLAB_class"] = np.bytes_("cell")
    assert mk.read_data(path).branches.tolist() == ["loading", "loading", "loading", "unloading"]


def test_a_gap_and_what_is_wrong_are_named(tmp_path: Path) -> None:
    gap = VECTORS | {"force_N": np.array([0.0, np.nan, 17.0, 27.5])}
    data = mk.read_data(old(tmp_path / "gap.mat", gap))
    assert len(data) == 3
    assert "1 row without a number left out: the first is element 2, without force" in data.assumptions
    with pytest.raises(mk.SpecError) as raised:
        mk.read_data(old(tmp_path / "bench.mat", VECTORS | {"force_N": np.array([0.0, np.inf, 1.0, 2.0])}))
    assert str(raised.value).startswith('bench.mat, element 2, column "force_N" = inf: must be a number')
    with pytest.raises(mk.SpecError, match=r"bench.mat: .*different lengths: pressure_bar has 4, .*force_N has 3"):
        mk.read_data(old(tmp_path / "bench.mat", VECTORS | {"force_N": F[:3]}))
    with pytest.raises(mk.SpecError, match=r'bench.mat, column "length": the length has no unit'):
        mk.read_data(old(tmp_path / "bench.mat", {"pressure_bar": P, "length": L, "force_N": F}))
    with pytest.raises(mk.SpecError, match=r"holds no vectors of numbers; .*table2struct"):
        mk.read_data(old(tmp_path / "bench.mat", {"table": np.eye(4)}))


@pytest.mark.parametrize("write", [old, new])
def test_a_damaged_file_is_one_sentence(write: Any, tmp_path: Path) -> None:
    path = write(tmp_path / "bench.mat", VECTORS)
    path.write_bytes(path.read_bytes()[:200])
    with pytest.raises(mk.SpecError, match=r"bench.mat: is no MAT file that can be read"):
        mk.read_data(path)

"""Files that version 0.1.0 wrote (commit 3d786c1) are read as they were, number by number."""

import shutil
from pathlib import Path

import attrs
import numpy as np
import pytest
import xarray as xr

import mckibben as mk
from mckibben.results.result import Result
from mckibben.sweeps import store

pytestmark = pytest.mark.files

DATA = Path(__file__).parent / "data"
PAPER = mk.presets.paper()
TEST = mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3)


def test_a_result() -> None:
    result = mk.load(DATA / "old_result.nc")
    assert isinstance(result, Result)
    assert result.muscle == PAPER
    assert result.test == TEST
    np.testing.assert_array_equal(result.force, [3.290307334898661, 52.358283498394925, 101.22143524414084])
    np.testing.assert_array_equal(result.pressure, [0.0, 5e4, 1e5])
    np.testing.assert_allclose(result.length, 0.115, rtol=1e-9)
    np.testing.assert_array_equal(result.column("energy")[1], 0.03624195783818301)
    assert result.verdict == ("stable",) * 3
    assert result.data["r"].shape == (3, 129)
    assert result.status == "complete"
    assert result.attributes["date"] == "2026-11-24T09:30:44+00:00"


def test_a_result_is_saved_again_as_it_is(tmp_path: Path) -> None:
    result = mk.load(DATA / "old_result.nc")
    assert isinstance(result, Result)
    assert mk.load(mk.save(result, tmp_path / "again.nc")) == result


@pytest.fixture
def old_sweep(tmp_path: Path) -> Path:
    shutil.unpack_archive(DATA / "old_sweep.zarr.zip", tmp_path)
    return tmp_path / "old.zarr"


def test_a_sweep(old_sweep: Path) -> None:
    assert store.is_store(old_sweep)
    data = mk.load(old_sweep)
    assert isinstance(data, xr.Dataset)
    assert dict(data.sizes) == {"braid.angle": 2, "step": 2}
    np.testing.assert_allclose(data["braid.angle"], np.radians([36.0, 38.0]), rtol=1e-14)
    assert data["braid.angle"].attrs["units"] == "rad"
    expected = [[2.5975491525612076, 87.63314743407096], [4.459955966822061, 117.26602884246725]]
    np.testing.assert_array_equal(data["force"], expected)
    assert data["force"].attrs["units"] == "N"
    assert data["air_volume"].isnull().all()  # not kept then
    assert not data["status"].values.any()
    assert not data["verdict"].values.any()
    about = data.attrs
    assert about["title"] == "sweep of 2 McKibben muscles, isometric test"
    assert about["tolerance"] == 1e-4
    assert {"muscle", "test", "over", "dimensions", "assumed", "versions", "date", "sweep"} <= set(about)


def test_what_a_sweep_depends_on_is_said_as_then(old_sweep: Path) -> None:
    """Another sweep is told from the stored one by what differs, which is not the form of the record."""
    from mckibben.sweeps.plan import plan

    wanted = plan(
        PAPER, attrs.evolve(TEST, points=2), {"braid.angle": ["36 deg", "38 deg"]}, None, tolerance=1e-4, chunk=2
    )
    there, here = store._sweep_in(old_sweep), wanted.identity()
    assert {key: there[key] for key in there if key != "versions"} == {
        key: here[key] for key in here if key != "versions"
    }

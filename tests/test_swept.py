"""A sweep in short: `data.mckibben`, its picture, and what a notebook shows of it; the Dataset stays one."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from test_notebook import Reader, executed

import mckibben as mk

pytestmark = pytest.mark.view

PAPER = mk.presets.paper()
OVER = {"braid.angle": ["36 deg", "37 deg", "38 deg"], "test.length": ["110 mm", "140 mm"]}


@pytest.fixture(scope="module")
def data() -> xr.Dataset:
    test = mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3)
    return mk.sweep(PAPER, test, OVER, tolerance=1e-4, workers=0)


def test_counts_and_ends_are_those_of_the_dataset(data: xr.Dataset) -> None:
    short = data.mckibben
    assert short.statuses == {"complete": 3, "incomplete": 3}
    assert short.counts == {"stable": 9, "no equilibrium": 9}
    assert sum(short.counts.values()) == data.verdict.size
    forces = data.force.values[data.verdict.values == 0]
    assert short.table.loc["force [N]"].tolist() == [f"{forces.min():.4g}", f"{forces.max():.4g}"]
    assert short.fields["values"].tolist() == ["36, 37, 38 deg", "110, 140 mm"]
    assert repr(short) == (
        "<Sweep: 6 designs (braid.angle 3 x test.length 2), isometric test, 3 states each; "
        "designs: 3 complete, 3 incomplete; states: 9 stable, 9 no equilibrium>"
    )


def test_a_part_of_it_and_what_is_none(data: xr.Dataset) -> None:
    assert type(data) is xr.Dataset
    part = data.isel(step=-1).sel({"test.length": 0.11})
    assert repr(part.mckibben).startswith("<Sweep: 3 designs (braid.angle 3), isometric test, one state each;")
    plain = xr.Dataset({"force": 1.0})
    assert hasattr(plain, "mckibben")  # whoever looks through its attributes is not stopped
    assert repr(plain.mckibben) == "<Sweep: this Dataset is none>"
    with pytest.raises(mk.SpecError, match="is for what sweep gave"):
        _ = plain.mckibben.table


def test_the_picture_has_the_numbers(data: xr.Dataset) -> None:
    (axes,) = mk.plot(data).axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("braid.angle (deg)", "Force (N)")
    near = next(line for line in axes.lines if line.get_label() == "test.length 110 mm")
    np.testing.assert_allclose(near.get_xdata(), [36.0, 37.0, 38.0])
    np.testing.assert_allclose(near.get_ydata(), data.force.isel(step=-1).sel({"test.length": 0.11}).values)


def test_curves_that_are_left_out_are_told() -> None:
    over = {"braid.angle": ["36 deg", "37 deg"], "test.length": {"from": "100 mm", "to": "114 mm", "points": 8}}
    found = mk.sweep(PAPER, mk.Isometric(length="115 mm", pressure="1 bar"), over, tolerance=1e-4, workers=0)
    figure = mk.plot(found)
    assert len(figure.axes[0].lines) == 2  # over the length, which has more values, a curve for each angle
    assert "Drawn:" not in figure.get_supxlabel()
    found = found.isel({"test.length": slice(None, 1)})
    many = xr.concat([found] * 4, dim="braid.angle").assign_coords({"braid.angle": np.radians(np.arange(30.0, 38.0))})
    twice = xr.concat([many] * 9, dim="test.length").assign_coords({"test.length": np.linspace(0.1, 0.11, 9)})
    twice.attrs, twice["test.length"].attrs = found.attrs, found["test.length"].attrs
    figure = mk.plot(twice)
    assert len(figure.axes[0].lines) == 6
    assert "Drawn: 6 of 8 values of braid.angle." in figure.get_supxlabel().replace("\n", " ")


def test_words_tables_and_states_that_are_not_stable() -> None:
    designs = pd.DataFrame({"braid.angle [deg]": [36.0, 37.0, 37.0], "ends": ["clamped", "clamped", "pinned"]})
    found = mk.sweep(PAPER, mk.FreeContraction(pressure="1 bar"), designs=designs, tolerance=1e-4, workers=0)
    (axes,) = mk.plot(found).axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("Design", "Contraction (%)")
    np.testing.assert_allclose(axes.lines[0].get_ydata(), 100.0 * found.contraction.values[:, -1])
    assert found.mckibben.fields["values"].tolist() == ["36, 37, 37 deg", "clamped, pinned"]
    pushed = found.assign(verdict=found.verdict.copy(data=[[1], [0], [0]]))
    assert len(mk.plot(pushed).axes[0].lines[1].get_xdata()) == 1


def test_a_store_that_is_not_finished(tmp_path: Path) -> None:
    test = mk.Isometric(length="115 mm", pressure="1 bar")

    def stop(done: int, total: int) -> None:
        if done:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        mk.sweep(PAPER, test, OVER, tolerance=1e-4, to=tmp_path / "s.zarr", chunk=2, workers=0, watch=stop)
    found = mk.load(tmp_path / "s.zarr")
    assert found.mckibben.statuses["pending"] >= 2
    assert "not computed" in found.mckibben.counts
    assert "pending" in mk.plot(found).get_supxlabel()


def test_a_notebook_shows_it_and_leaves_others_alone() -> None:
    _, (swept,), (part,), (other,) = executed(
        "import mckibben as mk\nimport xarray as xr\n"
        "data = mk.sweep(mk.presets.paper(), mk.Isometric(length='115 mm', pressure='1 bar'),\n"
        "                {'braid.angle': ['36 deg', '37 deg']}, tolerance=1e-4)",
        "data", "data[['force']]", "xr.Dataset({'a': 1})",
    )  # fmt: skip
    page = Reader(swept.data["text/html"])
    assert page.tags.count("img") == 1
    assert "states: 2 stable" in page.said
    assert "36, 37 deg" in page.said
    assert swept.data["text/plain"].startswith("<Sweep: 2 designs (braid.angle 2), isometric test")
    for one in (part, other):
        assert one.data["text/plain"].startswith("<xarray.Dataset>")
        assert "xr-wrap" in one.data["text/html"]

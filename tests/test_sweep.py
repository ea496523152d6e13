"""Sweeps in this process: designs, values, tables, and what becomes of each design."""

import itertools
import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

import mckibben as mk
from mckibben.spec.vary import changed
from mckibben.sweeps import chunk
from mckibben.sweeps.dataset import arranged, flat
from mckibben.sweeps.outcome import STATUSES, empty
from mckibben.sweeps.plan import plan

pytestmark = pytest.mark.sweeps

MUSCLE = mk.presets.paper()
TEST = mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3)
BEYOND = mk.Isometric(length="250 mm", pressure="0 to 1 bar", points=3)
"""Beyond full extension: nothing is solved, so it is quick."""
SINGLE = ("length", "contraction", "force", "pressure", "volume", "energy", "energy_chamber")


def status(data: xr.Dataset) -> list[str]:
    """The words of every design's status, in a row."""
    return [str(STATUSES[k]) for k in data.status.values.ravel()]


def same(data: xr.Dataset, alone: mk.Result) -> None:
    """One design of a sweep against the run of the same muscle and test."""
    for name in SINGLE:
        expected = alone.data[name].values
        size = np.abs(expected).max()
        np.testing.assert_allclose(data[name].values, expected, rtol=1e-9, atol=1e-9 * size, err_msg=name)
    np.testing.assert_allclose(data.peak_fibre_tension, alone.data.fibre_tension.max("v"), rtol=1e-8)
    np.testing.assert_allclose(data.largest_radius, alone.data.r.max("v"), rtol=1e-9)
    np.testing.assert_allclose(data.error_estimate, alone.data.error_estimate, rtol=1e-2)
    words = data.verdict.attrs["flag_meanings"].split()[1:]
    assert [words[k] for k in data.verdict.values] == list(alone.verdict)


def test_grid_equals_single_runs() -> None:
    over = {"braid.angle": ["35 deg", 0.65], "test.length": ["100 mm", "115 mm"], "ends": ["clamped", "pinned"]}
    told: list[tuple[int, int]] = []
    data = mk.sweep(MUSCLE, TEST, over, workers=0, watch=lambda *said: told.append(said))
    assert dict(data.sizes) == {"braid.angle": 2, "test.length": 2, "ends": 2, "step": 3}
    assert data["braid.angle"].attrs["units"] == "rad"
    np.testing.assert_allclose(data["braid.angle"], [np.radians(35.0), 0.65], rtol=1e-15)
    assert data["ends"].values.tolist() == ["clamped", "pinned"]
    assert told == sorted(told)
    assert told[0] == (0, 8)
    assert told[-1] == (8, 8)
    for i, j, k in itertools.product(range(2), repeat=3):
        muscle = MUSCLE.replace("braid.angle", over["braid.angle"][i]).replace("ends", over["ends"][k])
        alone = mk.run(muscle, mk.Isometric(length=over["test.length"][j], pressure="0 to 1 bar", points=3))
        same(data.isel({"braid.angle": i, "test.length": j, "ends": k}), alone)
    assert status(data) == ["complete"] * 8
    assert set(data.reason.values.ravel()) == {""}
    assert json.loads(data.attrs["over"])["test.length"] == [0.1, 0.115]


def test_table_from_csv_and_frame(tmp_path: Path) -> None:
    (tmp_path / "designs.csv").write_text(
        "# as measured\nbraid.angle [deg],chamber.thickness [mm],braid.fibres,ends,test.pressure [bar]\n"
        "36,1.0,56,clamped,0 to 1\n37.5,1.25,60,pinned,0 to 0.5 bar\n",
        encoding="utf-8",
    )
    frame = pd.DataFrame(
        {
            "braid.angle": np.radians([36.0, 37.5]), "chamber.thickness [mm]": [1.0, 1.25], "braid.fibres": [56, 60],
            "ends": ["clamped", "pinned"], "test.pressure": ["0 to 1 bar", "0 to 50 kPa"],
        }
    )  # fmt: skip
    data = mk.sweep(MUSCLE, TEST, designs=tmp_path / "designs.csv", workers=0)
    again = mk.sweep(MUSCLE, TEST, designs=frame, workers=0)
    assert dict(data.sizes) == {"design": 2, "step": 3}
    assert data["braid.fibres"].dims == ("design",)
    assert data["braid.fibres"].values.tolist() == [56, 60]
    assert data["test.pressure"].values[1] == "0 bar to 0.5 bar"
    second = MUSCLE.replace("braid.angle", "37.5 deg").replace("chamber.thickness", "1.25 mm")
    second = second.replace("braid.fibres", 60).replace("ends", "pinned")
    same(data.isel(design=1), mk.run(second, mk.Isometric(length="115 mm", pressure="0 to 0.5 bar", points=3)))
    np.testing.assert_allclose(again.force, data.force, rtol=1e-11)  # radians(37.5) may differ in the last bit


def test_one_bad_design_spoils_no_other(monkeypatch: pytest.MonkeyPatch) -> None:
    over = {
        "braid.fibres": [56, 400],
        "braid.fibre.diameter": ["0.25 mm", "0.1 mm"],
        "test.length": ["100 mm", "0.2 m"],
    }
    single = chunk.run

    def fragile(muscle: mk.Muscle, test: mk.Isometric, **options: float) -> mk.Result:
        if muscle.braid.fibres == 400:
            raise ZeroDivisionError("so\nwhat")
        return single(muscle, test, **options)

    monkeypatch.setattr(chunk, "run", fragile)
    monkeypatch.setattr(chunk, "solve_together", lambda *_, **__: [])
    data = mk.sweep(MUSCLE, TEST, over, workers=0)
    assert status(data) == [*["complete", "incomplete"] * 2, *["wrong input"] * 2, *["failed"] * 2]
    reasons = data.reason.values.ravel().tolist()
    assert reasons[0] == ""
    assert reasons[1].startswith("state 0: no equilibrium: the fibres are straight at 128.7")
    assert reasons[4].startswith("braid.fibres = 400: the fibres overlap")
    assert reasons[6] == "ZeroDivisionError: so what"
    assert data.verdict.values[0, 0].tolist() == [[0, 0, 0], [3, 3, 3]]
    assert np.isfinite(data.force.values[0, :, 0]).all()
    assert np.isnan(data.force.values[0, :, 1]).all()
    assert np.isnan(data.force.values[1]).all()
    assert (data.verdict.values[1] == -1).all()


WRONG = [
    ({"braid.angel": [1]}, "braid.angel", 'did you mean "braid.angle"?'),
    ({"braid.angle": ["36 mm"]}, "over.braid.angle[0]", "wrong kind of unit"),
    ({"braid.angle": ["36 deg", "95 deg"]}, "over.braid.angle[1] = 95 deg", "below 90 deg"),
    ({"braid.angle": []}, "over.braid.angle", "at least one value"),
    ({"braid.angle": "36 deg"}, "over.braid.angle", "must be a list"),
    ({"braid.angle": [0.6], "muscle.braid.angle": [0.6]}, "braid.angle", "given twice"),
    ({"braid.angle": {"from": "30 deg", "to": "50 deg"}}, "over.braid.angle", "points"),
    ({"ends": {"from": "pinned", "to": "free", "points": 3}}, "over.ends", "list the values"),
    ({"ends": ["clampd"]}, "over.ends[0] = clampd", 'did you mean "clamped"?'),
    ({"test.points": [3]}, "test.points", "as many states"),
    ({"test.force": [3]}, "test.force", "is no field"),
    ({"chamber.law": [{"name": "yeoh", "c2": 1e4}]}, "chamber.law", "is missing"),
    ({"assumed": [[]]}, "assumed", "cannot be varied"),
    ({}, "over", "at least one field"),
    (None, "sweep", "either over or designs"),
]


@pytest.mark.parametrize(("over", "field", "said"), WRONG, ids=[repr(over) for over, _, _ in WRONG])
def test_wrong_lists_are_refused_at_once(over: dict[str, object], field: str, said: str) -> None:
    with pytest.raises(mk.SpecError) as caught:
        mk.sweep(MUSCLE, TEST, over)
    assert field in str(caught.value)
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", "is empty"),
        ("braid.angle [deg]\n", "holds no designs"),
        ("braid.angle [deg]\n36\n36,37\n", "row 2 has 2 cells"),
        ("braid.angle [deg],ends\n36,clamped\n96,clamped\n", "braid.angle in row 2 = 96 deg: must be above 0 deg"),
        ("braid.angle [mm]\n36\n", 'braid.angle in row 1 = 36 mm: has the wrong kind of unit, "mm"'),
        ("braid.angle [deg,ends\n36,clamped\n", "is no head of a column"),
        ("braid.angle,braid.angle\n0.6,0.6\n", "is given twice"),
    ],
)
def test_wrong_tables_name_the_row(tmp_path: Path, content: str, said: str) -> None:
    (tmp_path / "designs.csv").write_text(content, encoding="utf-8")
    with pytest.raises(mk.SpecError) as caught:
        mk.sweep(MUSCLE, TEST, designs=tmp_path / "designs.csv")
    assert said in str(caught.value)


def test_parts_laws_and_steps_vary() -> None:
    test = mk.Protocol(
        steps=[
            mk.Step(length="to 115 mm", pressure=0, points=2),
            mk.Step(length="hold", pressure="0 to 1 bar", points=2),
        ]
    )
    over = {
        "chamber.law": [mk.NeoHookean(c1="8 kPa"), {"name": "yeoh", "c1": "8 kPa", "c2": "1 kPa", "c3": 0}],
        "test.steps.1.pressure": ["0 to 1 bar", "0 to 2 bar"],
        "braid.fibre": [mk.Fibre(B1=1e-6, B2=1e-6, B3=1e-6)],
        "chamber.thickness": [1e-3],
    }
    wanted = plan(MUSCLE, test, over)
    assert [varied.coordinate.dtype.kind for varied in wanted.varied] == ["U", "U", "U", "f"]
    muscle, changed_test = wanted.design(3)
    assert muscle.chamber.law == mk.Yeoh(c1=8e3, c2=1e3, c3=0.0)
    assert muscle.braid.fibre.B1 == 1e-6
    assert changed_test.steps[1].pressure.waypoints == (0.0, 2e5)
    assert changed_test.steps[0] == test.steps[0]
    json.dumps(wanted.identity())


def test_stiffnesses_replace_material_and_back() -> None:
    given = {"braid.fibre.B1": 1e-6, "braid.fibre.B2": 1e-6, "braid.fibre.B3": 1e-6}
    by_stiffness, _ = changed(MUSCLE, TEST, given)
    assert by_stiffness.braid.fibre.E is None
    assert by_stiffness.braid.fibre.diameter == MUSCLE.braid.fibre.diameter
    back, _ = changed(by_stiffness, TEST, {"braid.fibre.E": "3 GPa", "braid.fibre.nu": 0.4})
    assert back.braid.fibre == mk.Fibre(diameter=MUSCLE.braid.fibre.diameter, E="3 GPa", nu=0.4)


VALUES = {
    "braid.angle": st.floats(0.5, 0.7),
    "chamber.thickness": st.floats(1e-3, 2e-3), "braid.fibres": st.sampled_from([40, 56]),
    "ends": st.sampled_from(["clamped", "pinned", "free"]), "test.length": st.floats(0.1, 0.12),
    "chamber.law.c1": st.floats(1e3, 1e5), "braid.fibre.natural": st.sampled_from(["helical", "straight"]),
}  # fmt: skip


@settings(max_examples=30)
@given(
    st.permutations(list(VALUES)).flatmap(
        lambda names: st.fixed_dictionaries({n: st.lists(VALUES[n], min_size=1, max_size=3) for n in names[:3]})
    ),
    st.integers(1, 7),
)
def test_designs_are_the_grid_in_order_whatever_the_chunks(over: dict[str, list[object]], size: int) -> None:
    wanted = plan(MUSCLE, BEYOND, over, chunk=size)
    combinations = list(itertools.product(*over.values()))
    assert len(wanted) == len(combinations)
    pieces = [wanted.piece(index) for index in range(wanted.chunks)]
    in_chunks = [piece.design(k) for piece in pieces for k in range(len(piece))]
    assert in_chunks == [wanted.design(k) for k in range(len(wanted))]
    for (muscle, test), values in zip(in_chunks, combinations, strict=True):
        one_by_one, length = MUSCLE, BEYOND.length
        for name, value in zip(over, values, strict=True):
            if name == "test.length":
                length = value
            else:
                one_by_one = one_by_one.replace(name, value)
        assert muscle == one_by_one
        assert test == mk.Isometric(length=length, pressure=BEYOND.pressure, points=3)


@settings(max_examples=15)
@given(
    st.lists(st.tuples(st.floats(0.5, 0.7), st.sampled_from(["clamped", "free"])), min_size=1, max_size=9),
    st.integers(1, 4),
)
def test_a_table_is_its_rows(rows: list[tuple[float, str]], size: int) -> None:
    frame = pd.DataFrame(rows, columns=["braid.angle", "ends"])
    data = mk.sweep(MUSCLE, BEYOND, designs=frame, chunk=size, workers=0)
    assert data["braid.angle"].values.tolist() == [angle for angle, _ in rows]
    assert data["ends"].values.tolist() == [ends for _, ends in rows]
    assert set(status(data)) == {"incomplete"}


def test_designs_in_a_row_become_a_grid_by_xarray_alone() -> None:
    """As xarray.open_zarr gives them, and as the recipe says."""
    made = plan(MUSCLE, BEYOND, {"braid.angle": ["36 deg", "37 deg"], "ends": ["pinned", "clamped", "free"]})
    row = flat(made, empty(len(made), made.steps))
    row["force"][:] = np.arange(18.0).reshape(6, 3)
    grid = row.set_index(design=["braid.angle", "ends"]).unstack("design")
    assert dict(grid.sizes) == dict(arranged(row).sizes)
    found = grid.force.transpose("braid.angle", "ends", "step").sel(ends=arranged(row)["ends"])
    np.testing.assert_array_equal(found, arranged(row).force)

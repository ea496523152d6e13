"""Bare numbers: SI, unless that is absurd and mm, bar or deg is plausible; then the reading is offered."""

import tomllib
from pathlib import Path as File

import attrs
import numpy as np
import pytest

import mckibben as mk
from mckibben.experiments import foresee
from mckibben.measure.signs import after
from mckibben.spec import Path, Step
from mckibben.spec.plausible import trusted
from mckibben.spec.text import muscle_from_mapping, plain, test_from_mapping, to_toml
from mckibben.sweeps.plan import plan

pytestmark = pytest.mark.spec

PAPER = mk.presets.paper()
FIBRE = {"diameter": "0.25 mm", "E": "3 GPa", "nu": 0.4}
BRAID = {"radius": "12.5 mm", "length": "85 mm", "angle": "37 deg", "fibres": 56, "fibre": mk.Fibre(**FIBRE)}
TEST = mk.Isometric(length="115 mm", pressure="1 bar")
ABSURD = [
    (lambda: mk.Braid(**BRAID | {"radius": 12.5}), "braid.radius", '12.5 m? write "12.5 mm"'),
    (lambda: mk.Braid(**BRAID | {"length": 85}), "braid.length", '85 m? write "85 mm"'),
    (lambda: mk.Braid(**BRAID | {"angle": 37}), "braid.angle", '37 rad? write "37 deg"'),
    (lambda: mk.Fibre(**FIBRE | {"diameter": 0.25}), "braid.fibre.diameter", '0.25 m? write "0.25 mm"'),
    (lambda: mk.Chamber(thickness=1, law=PAPER.chamber.law), "chamber.thickness", '1 m? write "1 mm"'),
    (lambda: mk.Isometric(length=115, pressure="1 bar"), "isometric.length", '115 m? write "115 mm"'),
    (lambda: mk.Isometric(length="115 mm", pressure=1), "isometric.pressure", '1 Pa? write "1 bar"'),
    (lambda: mk.FreeContraction(pressure=[0, 0.5, 1]), "free-contraction.pressure", '0.5 Pa? write "0.5 bar"'),
    (lambda: mk.FreeContraction(pressure=np.linspace(0, 1, 7)), "free-contraction.pressure", 'write "0.166666666667 b'),
    (lambda: Step(volume=40, pressure="1 bar"), "step.volume", '40 m^3? write "40 mL"'),
    (lambda: PAPER.replace("braid.radius", 12.5), "braid.radius", '12.5 m? write "12.5 mm"'),
    (lambda: plan(PAPER, TEST, {"test.pressure": [1, 2]}), "over.test.pressure[0]", '1 Pa? write "1 bar"'),
    (
        lambda: plan(PAPER, TEST, {"braid.radius": {"from": 12, "to": 13, "points": 2}}),
        "over.braid.radius.from",
        '12 m? write "12 mm"',
    ),
    (lambda: mk.least_pressure(PAPER, length=115), "step.length", '115 m? write "115 mm"'),
]


@pytest.mark.parametrize(("make", "field", "meant"), ABSURD, ids=[row[1] for row in ABSURD])
def test_what_is_absurd_in_si_is_refused_with_the_other_reading(make, field, meant) -> None:
    with pytest.raises(mk.SpecError) as caught:
        make()
    assert caught.value.field.split(" ")[0] == field
    assert meant in str(caught.value)


def test_si_numbers_that_can_be_and_units_that_are_said_are_taken() -> None:
    assert mk.Braid(**BRAID | {"radius": 0.0125, "length": 2, "angle": 1}).length == 2.0
    wide = mk.Braid(**BRAID | {"radius": "12.5 m", "length": "1 km", "angle": 0.6458})
    assert (wide.radius, wide.length) == (12.5, 1000.0)
    assert Step(length="20 m", pressure="1 Pa").pressure.waypoints == (1.0,)
    assert Step(length=0.1, pressure=[0.0, 1.0, 1e5]).points == 3
    assert Step(length=0.1, pressure=3.21456789).points == 1  # computed: nobody types it
    assert Step(length=0.1, pressure=0).points == 1
    with trusted():
        assert Step(length=0.1, pressure=1.0).pressure.waypoints == (1.0,)


def test_what_was_said_is_kept_by_changes_and_files() -> None:
    muscle = attrs.evolve(PAPER, braid=mk.Braid(**BRAID | {"radius": "12.5 m", "length": "20 m"}))
    assert muscle.replace("braid.length", "21 m").braid.radius == 12.5
    assert muscle_from_mapping(tomllib.loads(to_toml(muscle))) == muscle
    test = mk.FreeContraction(pressure=["1 Pa", "2 Pa"])
    assert test_from_mapping(tomllib.loads(to_toml(test))) == test
    assert plain(Path((1.0,), unit="Pa")) == "1.0 Pa"
    assert mk.BlockedForce(pressure="1 bar").as_steps(muscle)[0].length.waypoints == (20.0,)
    between = plan(PAPER, TEST, {"test.pressure": {"from": "0 Pa", "to": "2 Pa", "points": 3}})
    assert [value.waypoints for value in between.varied[0].values] == [(0.0,), (1.0,), (2.0,)]


def test_a_pressure_that_no_muscle_holds() -> None:
    with pytest.raises(mk.SpecError, match=r"test.pressure = 1e6 bar: must be at least -1.01325 bar and at most 10000"):
        test_from_mapping({"kind": "blocked-force", "pressure": "1e6 bar"})
    assert Step(length=0.1, pressure="1000 bar").points == 1
    steps = {"length": np.array([0.1, 0.1]), "pressure": np.array([1e5, 1e8]), "force": np.array([1.0, 2.0])}
    fields = {name: np.full((2, 1), 0.01) for name in ("r", "theta", "fibre_tension")}
    bare = attrs.evolve(PAPER, braid=attrs.evolve(PAPER.braid, fibre=mk.Fibre(B1=1e-6, B2=1e-6, B3=1e-6)), assumed=())
    (caution,) = after(bare, steps, fields)
    assert "from state 1 (100 mm, 1000 bar) on: the pressure is above 100 bar" in caution


def test_check_and_run_say_what_the_braid_does(tmp_path: File) -> None:
    known = {name: value for name, value, _ in foresee.derived(PAPER)}
    assert known["braid"] == "contracts under pressure"
    assert foresee.turns(PAPER.replace("braid.angle", "25 deg")) == (
        "braid of 25 deg from the parallels (65 deg from the axis): lengthens under pressure"
    )

"""Paths, steps and tests."""

import jax
import numpy as np
import pint
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mckibben.spec import (
    TESTS,
    BlockedForce,
    FreeContraction,
    Isobaric,
    Isometric,
    Isotonic,
    Path,
    Protocol,
    SpecError,
    Step,
    presets,
)
from mckibben.units import UnitError

pytestmark = pytest.mark.spec

PROPERTY = settings(max_examples=50, deadline=None, derandomize=True, database=None)
MUSCLE = presets.paper()
numbers = st.floats(min_value=-1e5, max_value=1e5, allow_nan=False)


@pytest.mark.parametrize(
    ("value", "waypoints", "mode"),
    [
        (5e4, (5e4,), "constant"),
        ("0.5 bar", (5e4,), "constant"),
        ("0", (0.0,), "constant"),
        ("0 to 1 bar", (0.0, 1e5), "ramp"),
        ("1 to 2 bar", (1e5, 2e5), "ramp"),
        ("0 to 50 kPa to 1 bar", (0.0, 5e4, 1e5), "ramp"),
        ("0 to 1 to 0 bar", (0.0, 1e5, 0.0), "ramp"),
        ("1e5 Pa to 1 bar", (1e5, 1e5), "ramp"),
        ("0 to 1e-1 MPa", (0.0, 1e5), "ramp"),
        ("to 1 bar", (1e5,), "ramp from present"),
        ("to 1 to 2 bar", (1e5, 2e5), "ramp from present"),
        ("hold", (), "hold"),
        (" hold ", (), "hold"),
        ([0.0, "0.5 bar", 1e5], (0.0, 5e4, 1e5), "list"),
        (np.array([0.0, 1.0]), (0.0, 1.0), "list"),
        (pint.UnitRegistry().Quantity([0.0, 1.0], "bar"), (0.0, 1e5), "list"),
    ],
)
def test_reading_a_path(value, waypoints, mode):
    path = Path.parse(value, "Pa")
    assert (path.waypoints, path.mode) == (waypoints, mode)
    assert Path.parse(path.to_plain(), "Pa") == path


@pytest.mark.parametrize(
    "value",
    ["", "to", "1 bar to", "to to 1 bar", "1 to 2", "1 bar to 2 mm", "0 until 1 bar", [], [[1.0]], None, "1 bar to 2"],
)
def test_what_is_no_path(value):
    with pytest.raises(UnitError):
        Path.parse(value, "Pa")


def test_sampling():
    assert Path.parse("0 to 1 bar", "Pa").sample(3).tolist() == [0.0, 5e4, 1e5]
    assert Path.parse("2 N", "N").sample(2).tolist() == [2.0, 2.0]
    assert Path.parse("hold", "N").sample(2, present=7.0).tolist() == [7.0, 7.0]
    assert Path.parse("to 0 N", "N").sample(3, present=8.0).tolist() == [8.0, 4.0, 0.0]
    assert Path.parse([3.0, 1.0, 2.0], "N").sample(3).tolist() == [3.0, 1.0, 2.0]
    assert Path.parse("0 to 2 to 1 N", "N").sample(4).tolist() == [0.0, 1.0, 2.0, 1.0]
    for text in ("hold", "to 0 N"):
        with pytest.raises(ValueError, match="needs the present value"):
            Path.parse(text, "N").sample(3)
    with pytest.raises(ValueError, match="3 points, not 4"):
        Path.parse([1.0, 2.0, 3.0], "N").sample(4)
    with pytest.raises(ValueError, match="cannot visit"):
        Path.parse("0 to 1 N", "N").sample(1)


@PROPERTY
@given(st.lists(numbers, min_size=2, max_size=5), st.integers(0, 20), st.booleans())
def test_waypoints_are_hit_in_order_and_nothing_else_is_visited(values, extra, from_present):
    path = Path(tuple(values[1:] if from_present else values), "ramp from present" if from_present else "ramp", "N")
    points = path.fewest_points + extra
    sampled = path.sample(points, values[0] if from_present else None)
    assert sampled.shape == (points,)
    at = -1
    for value in values:
        later = np.flatnonzero(sampled == value)
        at = later[later > at][0]
    assert (sampled[0], sampled[-1]) == (values[0], values[-1])
    assert min(values) <= sampled.min() + 1e-9
    assert sampled.max() <= max(values) + 1e-9


def test_two_paths_with_as_many_legs_turn_together():
    step = Step(length="115 mm to 60 mm to 115 mm", pressure="0 to 1 to 0.2 bar", points=9)
    turn = int(np.argmin(step.length.sample(9)))
    assert turn == int(np.argmax(step.pressure.sample(9))) == 4


def test_samples_can_be_differentiated_through_the_weights():
    def last(x):
        path = Isobaric(pressure=0.0, length=[0.1, 0.2, x]).length
        return (path.weights(3) @ jax.numpy.stack([jax.numpy.asarray(w) for w in path.waypoints]))[-1]

    assert jax.grad(last)(0.3) == 1.0


@pytest.mark.parametrize(
    ("test", "points"),
    [
        (Isometric(length="115 mm", pressure="0 to 1 bar"), 21),
        (Isometric(length="115 mm", pressure="0 to 1 bar", points=5), 5),
        (Isometric(length="115 mm", pressure="1 bar"), 1),
        (Isometric(length="115 mm", pressure=[0.0, 1e4]), 2),
        (Isobaric(pressure="1 bar", length="115 mm to 60 mm"), 21),
        (Isotonic(force="20 N", pressure="0 to 1 bar"), 21),
        (BlockedForce(pressure="0 to 1 bar"), 21),
        (FreeContraction(pressure="to 1 bar"), 21),
        (Step(force="to 0 N", pressure="hold"), 21),
        (Step(force=0.0, volume="40 mL"), 1),
        (Step(length="80 mm", force="0 to 20 N"), 21),
    ],
)
def test_points(test, points):
    assert test.points == points
    (step,) = test.as_steps(MUSCLE)
    assert step.points == points


def test_tests_as_steps():
    def controlled(test):
        (step,) = test.as_steps(MUSCLE)
        return {name: str(getattr(step, name)) for name in step.controls}

    assert controlled(Isometric(length=0.115, pressure="0 to 1 bar")) == {
        "length": "115 mm", "pressure": "0 bar to 1 bar",
    }  # fmt: skip
    assert controlled(Isobaric(pressure=1e5, length="115 to 60 mm")) == {
        "length": "115 mm to 60 mm", "pressure": "1 bar",
    }  # fmt: skip
    assert controlled(Isotonic(force=20, pressure="1 bar")) == {"force": "20 N", "pressure": "1 bar"}
    assert controlled(BlockedForce(pressure="1 bar")) == {"length": "85 mm", "pressure": "1 bar"}
    assert controlled(BlockedForce(pressure="1 bar", length="9 cm")) == {"length": "90 mm", "pressure": "1 bar"}
    assert controlled(FreeContraction(pressure="1 bar")) == {"force": "0 N", "pressure": "1 bar"}
    first, second = Step(length="hold", pressure="0 to 1 bar"), Step(force="to 0 N", pressure="hold")
    assert Protocol([first, second]).as_steps(MUSCLE) == (first, second)
    assert {kind: cls.kind for kind, cls in TESTS.items()} == {kind: kind for kind in TESTS}


@pytest.mark.parametrize(
    ("make", "field", "words"),
    [
        (lambda: Isometric(length="0 mm", pressure=0), "isometric.length", "above 0 mm"),
        (lambda: Isometric(length="115 mm", pressure="0 to -2 bar"), "isometric.pressure", "at least -1.01325 bar"),
        (lambda: Isometric(length="1 to 2 mm", pressure=0), "isometric.length", "holds its length"),
        (lambda: Isometric(length="hold", pressure=0), "isometric.length", "must be one value"),
        (lambda: Isometric(length="1 bar", pressure=0), "isometric.length", "wrong kind of unit"),
        (lambda: Isometric(length=1, pressure=0, points=0), "isometric.points", "at least 1"),
        (lambda: Isometric(length=1, pressure="0 to 1 bar", points=1), "isometric.points", "at least 2"),
        (lambda: Isometric(length=1, pressure=[1e5, 2e5], points=3), "isometric.points", "as many as pressure lists"),
        (lambda: Isotonic(force=[1, 2], pressure=0), "isotonic.force", "must be one value"),
        (lambda: Step(pressure=0), "step", "pressure given; control exactly two"),
        (lambda: Step(length=1, force=1, pressure=0), "step", "length and force and pressure given"),
        (lambda: Step(length=1), "step", "exactly two of length, force, pressure, volume, or"),
        (lambda: Step(length=[1, 2], pressure=[1e5, 2e5, 3e5]), "step", "length lists 2 values and pressure lists 3"),
        (lambda: Step(length=1, volume=-1), "step.volume", "above 0 mL"),
        (lambda: Protocol([]), "protocol.steps", "one or more"),
        (lambda: Protocol([{"length": 1}]), "protocol.steps[0]", "must be a Step"),
    ],
)
def test_tests_that_cannot_be(make, field, words):
    with pytest.raises(SpecError, match=words) as caught:
        make()
    assert caught.value.field == field


def test_vacuum_is_allowed():
    assert FreeContraction(pressure="0 to -1 bar").pressure.waypoints == (0.0, -1e5)
    assert FreeContraction(pressure=-101325).pressure.waypoints == (-101325.0,)


@PROPERTY
@given(st.lists(numbers, min_size=1, max_size=4), st.sampled_from(["Pa", "kPa", "bar"]))
def test_a_path_in_text_equals_its_numbers(values, unit):
    """Shared or repeated units, spelt or plain: the same path."""
    repeated = Path.parse(" to ".join(f"{value!r} {unit}" for value in values), "Pa")
    shared = Path.parse(" to ".join(f"{value!r}" for value in values) + f" {unit}", "Pa")
    scale = {"Pa": 1.0, "kPa": 1e3, "bar": 1e5}[unit]
    assert repeated == shared
    assert repeated.waypoints == pytest.approx([value * scale for value in values], rel=1e-15)

"""Text and quantities to SI floats and back."""

import math
from decimal import Decimal

import numpy as np
import pint
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mckibben import units
from mckibben.units import UnitError, from_si, show, split, to_si

pytestmark = pytest.mark.spec

PROPERTY = settings(max_examples=50, deadline=None, derandomize=True, database=None)
SCALES = {
    "m": {"mm": "0.001", "cm": "0.01", "m": "1", "um": "0.000001"},
    "Pa": {"Pa": "1", "kPa": "1e3", "bar": "1e5", "MPa": "1e6", "GPa": "1e9"},
    "N": {"N": "1", "mN": "0.001", "kN": "1000"},
    "N m^2": {"N mm^2": "0.000001", "N*mm**2": "0.000001", "N·mm²": "0.000001", "N m^2": "1"},
    "m^3": {"mL": "0.000001", "mm^3": "1e-9", "m**3": "1", "L": "0.001"},
}
numbers = st.floats(min_value=-1e6, max_value=1e6, allow_nan=False)


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("12.5 mm", "m", 0.0125),
        ("85mm", "m", 0.085),
        (" 0.25 mm ", "m", 0.00025),
        ("1 bar", "Pa", 1e5),
        ("-0.5 bar", "Pa", -5e4),
        ("3e0 GPa", "Pa", 3e9),
        ("8.5 kPa", "Pa", 8500.0),
        ("0.575 N mm^2", "N m^2", 0.575e-6),
        ("37 deg", "rad", math.radians(37)),
        ("37°", "rad", math.radians(37)),
        ("0.5 rad", "rad", 0.5),
        ("40 mL", "m^3", 4e-5),
        ("0", "m", 0.0),
        ("-0.0", "N", 0.0),
        ("0.4", "1", 0.4),
    ],
)
def test_text_is_the_si_float(text, unit, value):
    assert to_si(text, unit) == value


@PROPERTY
@given(numbers, st.sampled_from([(unit, name) for unit, scales in SCALES.items() for name in scales]))
def test_text_with_a_unit_is_the_correctly_rounded_product(number, case):
    unit, name = case
    assert to_si(f"{number!r} {name}", unit) == float(Decimal(repr(number)) * Decimal(SCALES[unit][name]))


@PROPERTY
@given(numbers, st.sampled_from(["m", "Pa", "rad", "N", "m^3", "N m^2", "1"]))
def test_shown_text_reads_back(number, unit):
    assert to_si(show(number, unit, digits=17), unit) == pytest.approx(number, rel=1e-14, abs=1e-300)


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.0125, "m", "12.5 mm"),
        (1e5, "Pa", "1 bar"),
        (3e9, "GPa", "3 GPa"),
        (math.radians(37), "rad", "37 deg"),
        (0.575e-6, "N m^2", "0.575 N mm^2"),
        (-0.0, "N", "0 N"),
        (0.4, "1", "0.4"),
    ],
)
def test_show(value, unit, text):
    assert show(value, unit) == text


def test_from_si_takes_arrays():
    np.testing.assert_array_equal(from_si(np.array([0.0, 5e4, 1e5]), "bar"), [0.0, 0.5, 1.0])


@pytest.mark.parametrize("value", [3, 3.0, np.float32(3), np.int64(3), np.array(3.0), Decimal(3)])
def test_bare_numbers_are_si(value):
    result = to_si(value, "m")
    assert result == 3.0
    assert type(result) is float


def test_pint_quantities_of_any_registry():
    registry = pint.UnitRegistry()
    registry.formatter.default_format = "~P"
    assert to_si(12.5 * registry.mm, "m") == 0.0125
    assert to_si(registry.Quantity(0.4, "dimensionless"), "1") == 0.4
    assert to_si(registry.Quantity(0.41, "N mm^2"), "N m^2") == 0.41e-6
    with pytest.raises(UnitError, match="wrong kind of unit"):
        to_si(1.0 * registry.second, "m")


@pytest.mark.parametrize(
    ("value", "unit", "problem"),
    [
        ("12.5", "m", "needs a unit"),
        ("0.5", "rad", "needs a unit"),
        ("12.5 s", "m", "wrong kind"),
        ("5 percent", "rad", "wrong kind"),
        ("5 dB", "rad", "wrong kind"),
        ("20 degC", "m", "wrong kind"),
        ("12.5 mmm", "m", "unknown unit"),
        ("12.5 __import__('os')", "m", "unreadable unit"),
        ("1 m**9**9**9**9", "m", "unreadable unit"),
        ("9**9**9**9 m", "m", "unreadable unit"),
        ("0.4 mm", "1", "without a unit"),
        ("mm", "m", "must be a number"),
        ("", "m", "must be a number"),
        ("nan mm", "m", "must be a number"),
        ("1e400 mm", "m", "finite"),
        ("1e99999999999999999999 mm", "m", "finite"),
        (True, "1", "must be a number"),
        (np.True_, "1", "must be a number"),
        (math.nan, "m", "finite"),
        (-math.inf, "m", "finite"),
        (10**400, "m", "finite"),
        (None, "m", "must be a number"),
        ([1.0], "m", "must be a number"),
        (1j, "m", "must be a number"),
        (b"1 mm", "m", "must be a number"),
    ],
)
def test_what_is_no_number_of_the_unit(value, unit, problem):
    with pytest.raises(UnitError, match=problem):
        to_si(value, unit)


def test_an_error_says_what_to_write():
    with pytest.raises(UnitError) as caught:
        to_si("12.5", "m")
    assert caught.value.advice == 'write it like "12.5 mm"'


@pytest.mark.parametrize(("text", "parts"), [("1e5 Pa", ("1e5", "Pa")), ("-.5", ("-.5", "")), ("bar", None)])
def test_split(text, parts):
    assert split(text) == parts


@PROPERTY
@given(st.text(max_size=30), st.sampled_from(["m", "Pa", "rad", "1"]))
def test_garbage_is_a_unit_error(text, unit):
    value, said = 0.0, ""
    try:
        value = to_si(text, unit)
    except UnitError as error:
        said = str(error)
    assert math.isfinite(value)
    assert "\n" not in said


@pytest.mark.parametrize("unit", units._USUAL)
def test_the_usual_units_are_those_of_pint(unit):
    wanted, factor = units._USUAL[unit]
    assert units._looked_up(unit, unit, wanted, "") == factor

"""Limits of the reference muscle, and what ends a path."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from cases import CASES
from typer.testing import CliRunner

import mckibben as mk
from mckibben.app.cli import app
from mckibben.experiments import limits as experiment

pytestmark = pytest.mark.experiments

REFERENCE = mk.presets.reference()
LIMITS = [case for case in CASES["limits_default"] if "P" in case]


@pytest.mark.parametrize("case", LIMITS, ids=lambda case: f"{case['bc']}-{case['P']}")
def test_shortest_stable_length(case):
    found = mk.limits(REFERENCE.replace("ends", case["bc"]), pressure=case["P"] * 1e6)
    assert found.stable_down_to * 1e3 == pytest.approx(case["limit_h"], rel=1e-6)
    assert found.stable_force == pytest.approx(case["F"], rel=1e-6)
    assert found.longest * 1e3 == pytest.approx(CASES["full_extension_mm"], rel=1e-9)
    assert found.shortest >= found.stable_down_to * (1 - 1e-9)
    if found.shortest > found.stable_down_to * (1 + 1e-6):  # the wall meets the fitting first
        assert "behind its fitting" in found.shortest_cause
    # compression is largest where stability under force control ends, or where the path does
    assert found.force_extremum <= found.shortest_force * (1 - 1e-9)


def test_least_pressure_that_holds_a_length():
    case = next(case for case in CASES["limits_default"] if "h" in case)
    muscle = REFERENCE.replace("ends", case["bc"])
    length = case["h"] * 1e-3
    stable = mk.least_pressure(muscle, length=length, shapes=False)
    assert stable * 1e-6 == pytest.approx(case["limit_P"], rel=1e-6)
    held = mk.least_pressure(muscle, length=length)
    assert held > stable  # pinned ends lean back before they give way
    assert mk.solve(muscle, length=length, pressure=held * 1.001).verdict == "stable"
    below = mk.solve(muscle, length=length, pressure=held * 0.98)
    assert below.verdict == "inadmissible"
    assert "or more holds 55 mm" in below.reason
    assert below.last_good.verdict == "stable"
    with pytest.warns(mk.MuscleWarning, match="the longest possible length"):
        assert math.isnan(mk.least_pressure(muscle, length="130 mm"))


def test_no_pressure_is_needed_near_the_initial_length():
    assert mk.least_pressure(REFERENCE, length="85 mm") == 0.0


def test_working_range_narrows_nowhere_with_pressure():
    region = mk.working_range(REFERENCE, pressures=[0.0, "1 bar", "3 bar"])
    shortest = region["shortest"].values
    assert shortest[0] > shortest[1] > shortest[2]
    assert (region["longest"].values == region["longest"].values[0]).all()
    assert region["shortest"].attrs["units"] == "m"


def test_force_map_is_the_isobaric_curves():
    grid = mk.force_map(REFERENCE, length=[0.08, 0.1, 0.13], pressure=["0 bar", "1 bar"])
    assert dict(grid.sizes) == {"pressure": 2, "length": 3}
    state = mk.solve(REFERENCE, length=0.1, pressure="1 bar")
    assert float(grid["force"][1, 1]) == pytest.approx(state.force, rel=1e-8)
    assert math.isnan(float(grid["force"][1, 2]))
    assert str(grid["verdict"][1, 2].values) == "no equilibrium"


@pytest.mark.parametrize("value", ["0 to 1 bar", "-2 bar", "1 mm"])
def test_wrong_pressure(value):
    with pytest.raises(mk.SpecError, match="pressure"):
        mk.limits(REFERENCE, pressure=value)


def test_a_fibre_breaks_where_its_tension_is_what_it_bears():
    strong = REFERENCE.replace("braid.fibre.breaking_force", "12 N")
    found = mk.burst_pressures(strong, length="100 mm")
    state = mk.solve(strong, length="100 mm", pressure=found.fibre)
    assert float(state.data["fibre_tension"].max()) == pytest.approx(12.0, rel=1e-5)
    assert not any("breaking" in said for said in mk.solve(strong, length=0.1, pressure=0.999 * found.fibre).cautions)
    assert any("breaking" in said for said in mk.solve(strong, length=0.1, pressure=1.001 * found.fibre).cautions)
    assert math.isnan(found.wall)
    assert "chamber inside the braid" in found.wall_reason
    lifting = mk.burst_pressures(strong, force=state.force)
    assert lifting.fibre == pytest.approx(found.fibre, rel=1e-4)
    assert lifting.held.endswith(" N")
    weak = mk.burst_pressures(strong.replace("braid.fibre.breaking_force", "1 mN"), length="100 mm")
    assert weak.fibre == 0.0  # without pressure already
    with pytest.raises(mk.SpecError, match=r"burst_pressures\.length = 80 mm to 100 mm: must be one value"):
        mk.burst_pressures(strong, length="80 to 100 mm")


def test_a_wall_bulges_between_fibres_in_closed_form():
    """At its length as made the braid is a cylinder of its own radius: P = 5.25 mu t/w (theory page)."""
    inside = mk.presets.paper().replace("chamber.lies", "inside")
    found = mk.burst_pressures(inside)
    width = 4.0 * np.pi * 12.5e-3 * np.sin(np.radians(37.0)) / 56 - 0.25e-3
    stretch = np.pi / 2.0
    assert found.wall == pytest.approx(4.0 * 2.0 * 8.5e3 * 1e-3 / width * (stretch - stretch**-3), rel=1e-5)
    assert found.held == "85 mm"
    assert found.fibre_reason == "braid.fibre.breaking_force is not given"


def test_the_command_tells_where_it_would_burst(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    asked = []

    def told(_, **given):
        asked.append(given)
        burst = mk.Burst("50 N", 2e5, "", math.nan, "no wall", ("new fibres",))
        return mk.Limits(1e5, 0.03, -70.0, "it folds", 0.03, -70.0, 0.12, -71.0, 0.04, burst)

    monkeypatch.setattr(experiment, "limits", told)
    case = tmp_path / "case.toml"
    case.write_text('[muscle]\npreset = "paper"\n')
    lines = CliRunner().invoke(app, ["limits", str(case), "--pressure", "1 bar", "--load", "50 N"]).stdout
    assert "2 bar" in lines
    assert "no wall" in lines
    found = json.loads(CliRunner().invoke(app, ["limits", str(case), "--pressure", "1 bar", "--json"]).stdout)
    assert found["burst"] == {
        "held": "50 N", "fibre": 2e5, "fibre_reason": "", "wall": None, "wall_reason": "no wall",
        "assumed": ["new fibres"],
    }  # fmt: skip
    assert asked[0] == {"pressure": "1 bar", "length": None, "contraction": None, "force": "50 N"}
    assert asked[1]["length"] == pytest.approx(85e-3)  # at rest, if nothing is given

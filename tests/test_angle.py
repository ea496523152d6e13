"""The two conventions of the braid angle: one given anew means what the muscle's own words meant."""

import json
import math
import tomllib

import numpy as np
import pytest
import xarray as xr

import mckibben as mk
from mckibben.app.look import _short
from mckibben.spec.angle import MAGIC, as_written, tendency
from mckibben.spec.rows import muscle_rows
from mckibben.spec.text import from_mapping, muscle_from_mapping, to_mapping, to_toml
from mckibben.spec.vary import changed
from mckibben.sweeps.groups import groups
from mckibben.sweeps.plan import plan

pytestmark = pytest.mark.spec

PAPER = mk.presets.paper()
FIBRE = mk.Fibre(diameter="0.25 mm", E="3 GPa", nu=0.4)
BRAID = mk.Braid(radius="12.5 mm", length="85 mm", angle="53 deg", angle_from="axis", fibres=56, fibre=FIBRE)
AXIS = mk.Muscle(braid=BRAID, chamber=PAPER.chamber)
TEST = mk.Isometric(length="90 mm", pressure="0 to 1 bar", points=3)
BEYOND = mk.Isometric(length="250 mm", pressure="0 to 1 bar", points=2)


def degrees(muscle: mk.Muscle) -> float:
    return round(math.degrees(muscle.braid.angle), 9)


def test_an_angle_given_anew_means_what_the_muscles_words_meant() -> None:
    assert degrees(AXIS.replace("braid.angle", "25 deg")) == 65.0
    assert degrees(AXIS.replace("braid.angle", "25 deg").replace("braid.angle", "30 deg")) == 60.0
    assert degrees(AXIS.replace("braid.radius", "13 mm").replace("braid.angle", "25 deg")) == 65.0
    assert degrees(PAPER.replace("braid.angle", "25 deg")) == 25.0
    whole = PAPER.replace("braid", BRAID)
    assert degrees(whole.replace("braid.angle", "25 deg")) == 65.0
    both = changed(AXIS, TEST, {"braid.angle": math.radians(25), "braid.radius": 0.013})[0]
    assert degrees(both) == 65.0


def test_what_it_is_measured_from_may_be_given_anew() -> None:
    """Alone, the number stays as given."""
    assert degrees(AXIS.replace("braid.angle_from", "parallels")) == 53.0
    assert degrees(AXIS.replace("braid.angle_from", "axis")) == 37.0
    turned = PAPER.replace("braid.angle", "37 deg")
    assert degrees(turned.replace("braid.angle_from", "axis").replace("braid.angle", "25 deg")) == 65.0
    said = changed(PAPER, TEST, {"braid.angle_from": "axis", "braid.angle": math.radians(25)})[0]
    assert degrees(said) == 65.0
    some = mk.Muscle(braid=BRAID, chamber=PAPER.chamber, assumed=("braid.angle",))
    assert some.replace("braid.angle_from", "parallels").assumed == ()
    with pytest.raises(mk.SpecError, match="must be one of parallels, axis"):
        AXIS.replace("braid.angle_from", "axes")


def test_files_and_overrides_keep_the_words() -> None:
    again = muscle_from_mapping(tomllib.loads(to_toml(AXIS)))
    assert again == AXIS
    assert degrees(again.replace("braid.angle", "25 deg")) == 65.0
    case = {"muscle": to_mapping(AXIS)}
    assert case["muscle"]["braid"]["angle_from"] == "axis"
    put = from_mapping(mk_overridden(case, "braid.angle=25 deg"), test_required=False).muscle
    assert put == AXIS.replace("braid.angle", "25 deg")
    put = from_mapping(mk_overridden(case, "braid.angle_from=parallels"), test_required=False).muscle
    assert put == AXIS.replace("braid.angle_from", "parallels")


def mk_overridden(case: dict[str, object], *overrides: str) -> dict[str, object]:
    from mckibben.spec.text import apply_overrides

    return apply_overrides(case, overrides)


@pytest.mark.parametrize("given", np.linspace(0.01, 1.56, 400))
def test_what_is_written_reads_back_to_the_last_bit(given: float) -> None:
    braid = mk.Braid(radius=0.1, length=0.3, angle=float(given), angle_from="axis", fibres=2, fibre=FIBRE)
    written = as_written(braid.angle, "axis")
    assert written["angle_from"] == "axis"
    assert math.pi / 2 - written["angle"] == braid.angle
    assert as_written(1e-3 * math.pi, "axis") == {
        "angle": 1e-3 * math.pi
    }  # this one would not: then from the parallels


def test_sweeps_follow_the_same_rule() -> None:
    over = {"braid.angle": ["50 deg", "54 deg"]}
    wanted = plan(AXIS, TEST, over)
    assert [degrees(wanted.design(k)[0]) for k in range(2)] == [40.0, 36.0]
    (group,) = groups(wanted.piece(0))
    np.testing.assert_allclose(np.degrees(group.p.theta0), [40.0, 36.0], rtol=1e-14)
    about = wanted.varied[0].about
    assert about["measured_from"] == "axis"
    assert about["long_name"] == "braid angle theta0, measured from the axis"
    assert plan(PAPER, TEST, over).varied[0].about["measured_from"] == "parallels"
    assert plan(PAPER, TEST, over).identity() != plan(AXIS, TEST, over).identity()


def test_a_sweep_over_both_conventions() -> None:
    over = {"braid.angle_from": ["parallels", "axis"], "braid.angle": ["40 deg", "44 deg"]}
    wanted = plan(PAPER, TEST, over)
    angles = [40.0, 44.0, 50.0, 46.0]
    assert [degrees(wanted.design(k)[0]) for k in range(4)] == angles
    made = groups(wanted.piece(0))
    found = dict(zip(np.concatenate([g.index for g in made]), np.concatenate([g.p.theta0 for g in made]), strict=True))
    np.testing.assert_allclose(np.degrees([found[k] for k in range(4)]), angles, rtol=1e-14)
    assert wanted.varied[1].about["measured_from"] == "braid.angle_from"
    alone = plan(AXIS, TEST, {"braid.angle_from": ["parallels", "axis"]})
    assert [degrees(alone.design(k)[0]) for k in range(2)] == [53.0, 37.0]
    braids = plan(PAPER, TEST, {"braid": [BRAID, PAPER.braid], "braid.angle": ["40 deg", "44 deg"]})
    made = groups(braids.piece(0))
    found = dict(zip(np.concatenate([g.index for g in made]), np.concatenate([g.p.theta0 for g in made]), strict=True))
    np.testing.assert_allclose(np.degrees([found[k] for k in range(4)]), [50.0, 46.0, 40.0, 44.0], rtol=1e-14)


def test_the_dataset_says_which_is_meant() -> None:
    data = mk.sweep(AXIS, BEYOND, {"braid.angle": ["25 deg", "30 deg"]}, workers=0)
    np.testing.assert_allclose(data["braid.angle"], np.radians([25.0, 30.0]))
    assert isinstance(data, xr.Dataset)
    assert data["braid.angle"].attrs["measured_from"] == "axis"
    assert json.loads(data.attrs["sweep"])["muscle"]["braid"]["angle_from"] == "axis"


def test_tables_and_reprs_show_both() -> None:
    steep = AXIS.replace("braid.angle", "25 deg")
    both = "65 deg from the parallels (25 deg from the axis)"
    assert both in repr(steep)
    assert both in repr(steep.braid)
    assert "angle='25 deg'" in repr(steep)
    assert eval(repr(steep), vars(mk.spec) | {name: getattr(mk, name) for name in dir(mk)}) == steep
    assert {row[0]: row[1] for row in muscle_rows(steep)}["braid.angle"] == both
    assert _short("braid.angle", both, "the angle") == ("braid.angle", "65 deg", f"the angle: {both}")


def test_what_a_braid_does_under_pressure() -> None:
    assert repr(PAPER).endswith(": contracts under pressure")
    assert repr(PAPER.replace("braid.angle", "25 deg")).endswith(": lengthens under pressure")
    assert tendency(MAGIC) == "neither contracts nor lengthens under pressure"
    assert math.degrees(MAGIC) == pytest.approx(35.2644, abs=1e-4)

"""The size of each effect: what two calls of `solve` say, as a table, a chart and a command."""

import json
import re
import runpy
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from typer.testing import CliRunner

import mckibben as mk
from mckibben.app.cli import app
from mckibben.experiments import effects as experiment

pytestmark = pytest.mark.effects

HELD = {"length": "115 mm", "pressure": "1 bar"}


@pytest.fixture(scope="module")
def found() -> mk.Effects:
    return mk.effects(mk.presets.paper(), **HELD)


def test_an_effect_is_with_it_against_without(found: mk.Effects) -> None:
    base = mk.solve(mk.presets.paper(), **HELD)  # type: ignore[arg-type]
    stretched = mk.solve(mk.presets.paper().replace("braid.fibre.stretch", True), **HELD)  # type: ignore[arg-type]
    row = found.table.loc["stretch of the fibres"]
    assert_allclose(row["force [%]"], 100.0 * (stretched.force / base.force - 1.0), rtol=1e-12)
    assert row["switch"] == "braid.fibre.stretch = true"
    free = mk.solve(mk.presets.paper().replace("ends", "free"), **HELD)  # type: ignore[arg-type]
    assert_allclose(found.table.loc["ends that hold the radius", "force [%]"], 100.0 * (base.force / free.force - 1.0))


def test_what_is_on_is_switched_off(found: mk.Effects, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = [one for one in experiment.EFFECTS if one.name == "stretch of the fibres"]
    monkeypatch.setattr(experiment, "EFFECTS", asked)  # the others have nothing to do with it, and are dear
    other = mk.effects(mk.presets.paper().replace("braid.fibre.stretch", True), **HELD)
    assert_allclose(
        other.table.loc["stretch of the fibres", "force [%]"], found.table.loc["stretch of the fibres", "force [%]"]
    )


def test_the_largest_comes_first_and_what_has_no_numbers_last(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = ("stretch of the fibres", "thickness of the wall", "ends that hold the radius")
    monkeypatch.setattr(experiment, "EFFECTS", [one for one in experiment.EFFECTS if one.name in asked])
    table = mk.effects(mk.presets.reference().replace("chamber", None), **HELD).table
    assert (table["reason"] == "").tolist() == [True, False, False]
    assert "give EA" in table.loc["stretch of the fibres", "reason"]
    assert "bare braid has no chamber" in table.loc["thickness of the wall", "reason"]


def test_they_are_sorted_by_what_they_do_to_the_force(found: mk.Effects) -> None:
    shares = np.abs(found.table["force [%]"].to_numpy())
    assert len(shares) == 7
    assert (np.diff(shares) <= 0.0).all()


def test_friction_is_half_of_what_lies_between_lengthening_and_shortening(found: mk.Effects) -> None:
    rubbing = mk.presets.paper().replace("friction", mk.Friction(coefficient=0.3, arm="0.1 mm"))
    state = mk.solve(rubbing, **HELD)  # type: ignore[arg-type]
    assert state.force_interval is not None
    below, above = state.force_interval
    share = 50.0 * (above - below) / state.force
    assert_allclose(found.table.loc["friction at the crossings", "force [%]"], share, rtol=1e-9)
    own = mk.effects(rubbing, **HELD)  # type: ignore[arg-type]
    assert_allclose(own.table.loc["friction at the crossings", "force [%]"], share, rtol=1e-9)
    assert_allclose(own.table.loc["stretch of the fibres", "force [%]"], found.table["force [%]"].min())


def test_a_notebook_shows_them(found: mk.Effects) -> None:
    page = found._repr_html_()
    assert page is not None
    assert f"{found.table.loc['stretch of the fibres', 'force [%]']:.4g}" in page
    assert page.count("<img") == 1


def test_the_page_has_the_table(found: mk.Effects) -> None:
    """docs/effects.md holds what docs/effects.py makes; of its three muscles the one that is computed here anyway."""
    docs = Path(__file__).parent.parent / "docs"
    script = runpy.run_path(str(docs / "effects.py"))
    assert script["CASES"]["paper"] == HELD
    page = (docs / "effects.md").read_text(encoding="utf-8")
    assert set(script["CASES"]) == set(re.findall(r"<!-- table of (\S+) -->", page))
    assert script["table"](found) in page


def test_chart(found: mk.Effects) -> None:
    figure = mk.plot(found)
    axes = figure.axes[0]
    assert axes.get_yticklabels()[0].get_text() == "ends that hold the radius"
    assert axes.get_xlabel() == "Change by the effect (%)"


def test_command(tmp_path: Path) -> None:
    case = tmp_path / "case.toml"
    case.write_text('[muscle]\npreset = "paper"\n')
    at = ["effects", str(case), "--length", "115 mm", "--pressure", "1 bar"]
    told = CliRunner().invoke(app, [*at, "-o", str(tmp_path / "effects.csv")])
    assert told.exit_code == 0, told.output
    assert "stretch of the fibres" in told.output
    assert "ASSUMED" in told.output
    assert (tmp_path / "effects.csv").read_text().startswith("effect,force [%]")
    parsed = json.loads(CliRunner().invoke(app, [*at, "--json"]).stdout)
    assert {row["effect"] for row in parsed["effects"]} >= {"roll at the crossings", "fittings that give way"}


def test_no_state_to_compare_with() -> None:
    with pytest.raises(mk.SpecError, match="not stable there"):
        mk.effects(mk.presets.paper(), length="130 mm", pressure="1 bar")


TUBE = mk.Chamber(outer_diameter="20 mm", inner_diameter="18 mm", law=mk.NeoHookean(c1="50 kPa"), gap=True)
SLIDES, CROSSINGS = "chamber sliding along the mesh", "friction at the crossings"


def test_a_chamber_that_slides(monkeypatch: pytest.MonkeyPatch) -> None:
    """Brought to the length without pressure and filled, by `run`; friction at the crossings is told apart from it."""
    frictions = [one for one in experiment.EFFECTS if one.name in (SLIDES, CROSSINGS)]
    monkeypatch.setattr(experiment, "EFFECTS", frictions)
    monkeypatch.setattr(experiment, "CLOSE", 1e-2)
    muscle, at = mk.presets.paper().replace("chamber", TUBE), {"length": "105 mm", "pressure": "0.3 bar"}
    held = mk.solve(muscle, **at)  # type: ignore[arg-type]
    path = mk.Isometric(length="105 mm", pressure="0 to 0.3 bar", points=11)

    def told(found: mk.Effects, coefficient: float) -> float:
        """What the row says, once it is found to be what `run` says of the chamber's friction alone."""
        sliding = muscle.replace("friction", mk.Friction(chamber_coefficient=coefficient))
        force = mk.run(sliding, path, tolerance=1e-2).force[-1]
        share = float(found.table.loc[SLIDES, "force [%]"])
        assert_allclose(share, 100.0 * (force / held.force - 1.0), rtol=1e-9)
        return share

    found = mk.effects(muscle, **at)  # type: ignore[arg-type]
    assert -1.0 < told(found, 0.3) < -0.5  # the tube lies loose, and is caught as it lies
    assert found.data["assumed"].values.all()
    assert found.table.loc[SLIDES, "switch"] == "friction.chamber_coefficient = 0.3"
    assert np.isfinite(
        found.table.loc[SLIDES, ["volume [%]", "middle_radius [%]", "peak_fibre_tension [%]"]].tolist()
    ).all()
    both = mk.Friction(coefficient=0.3, arm="0.1 mm", chamber_coefficient=0.1)
    own = mk.effects(muscle.replace("friction", both), **at)  # type: ignore[arg-type]
    assert told(own, 0.1) != told(found, 0.3)
    assert not own.data["assumed"].values.any()
    assert own.table.loc[SLIDES, "switch"] == "friction.chamber_coefficient, as given"
    assert_allclose(own.table.loc[CROSSINGS, "force [%]"], found.table.loc[CROSSINGS, "force [%]"], rtol=1e-12)
    alone = mk.Friction(chamber_coefficient=0.1)
    asked = dict(
        zip(("crossings", "chamber"), experiment._own(frictions, muscle.replace("friction", alone)), strict=True)
    )
    assert asked["crossings"].assumed
    assert asked["crossings"].on.chamber_coefficient is None
    assert not asked["chamber"].assumed


def test_chambers_that_cannot_slide_have_no_row() -> None:
    law = mk.NeoHookean(c1="50 kPa")
    bellows = mk.Bellows(axial_stiffness="2 N")
    for chamber, slides in (
        (None, False),
        (mk.Chamber(thickness="1 mm", law=law), False),
        (mk.Chamber(thickness="1 mm", law=law, lies="inside"), False),
        (mk.Chamber(law=bellows), False),
        (mk.Chamber(law=bellows, lies="inside"), True),
        (TUBE, True),
    ):
        names = [
            one.name for one in experiment._own(experiment.EFFECTS, mk.presets.paper().replace("chamber", chamber))
        ]
        assert (SLIDES in names) == slides
        assert CROSSINGS in names

"""A chamber that slides along the mesh: shear lag in closed form, what is lost, the limits of no and much friction."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose

import mckibben as mk
from mckibben.experiments import going
from mckibben.experiments import walked as walked_module
from mckibben.experiments.going import Going
from mckibben.model import slide
from mckibben.model.friction import Remembered
from mckibben.model.parameters import parameters
from mckibben.model.point import Point
from mckibben.model.wall import chamber_density, chamber_pull
from mckibben.solver.held import Held
from mckibben.solver.problem import Problem
from mckibben.spec.text import from_mapping, to_mapping

pytestmark = pytest.mark.effects

STIFF = 2.0
BELLOWS = mk.Chamber(law=mk.Bellows(axial_stiffness=STIFF), lies="inside")
TUBE = mk.Chamber(outer_diameter="20 mm", inner_diameter="18 mm", law=mk.NeoHookean(c1="50 kPa"), gap=True)


def sliding(coefficient: float | None, chamber: mk.Chamber = BELLOWS, **more: Any) -> mk.Muscle:
    """The paper's muscle with another chamber that slides along its mesh."""
    muscle = mk.presets.paper().replace("chamber", chamber)
    return muscle.replace("friction", mk.Friction(chamber_coefficient=coefficient, **more))


def isobaric(pressure: str, *lengths: float) -> mk.Isobaric:
    """At one pressure through lengths in mm."""
    return mk.Isobaric(pressure=pressure, length=[1e-3 * length for length in lengths])


def along(result: mk.Result, step: int) -> dict[str, np.ndarray]:
    """Fields of a state, as NumPy arrays, and v."""
    one = result.data.isel(step=step)
    names = ("v", "r", "psi", "theta", "stretch_axial", "stretch_hoop", "slide", "shear_stress", "contact_pressure")
    return {name: one[name].values for name in names}


def meridian(at: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Meridian stretch s of the mesh, and the length [m] along it from the first fitting to each point."""
    s = np.sin(at["theta"]) / np.sin(np.radians(37.0))
    return s, np.concatenate([[0.0], np.cumsum(0.5 * (s[1:] + s[:-1]) * np.diff(at["v"]))])


def test_energy_of_a_step() -> None:
    """Its derivative is the force, stuck and sliding; what slid is remembered; the chamber pulls by its own stretch."""
    p = parameters(sliding(0.3, TUBE))
    memory = Remembered(jnp.asarray(0.0), jnp.asarray(0.0), jnp.asarray(1e-4), jnp.asarray(300.0))
    stiffness = 2.0 * np.pi * 12.5e-3 * 1e8
    for where in (-2e-3, 6e-5, 1.2e-4, 1.4e-4, 3e-3):
        at = Point.cylinder(jnp.asarray(0.8))._replace(slide=where, slide_rate=0.1)
        force = slide.slide_force(at, p, memory)
        assert_allclose(force, np.clip(stiffness * (where - 1e-4), -300.0, 300.0), rtol=1e-12)
        by_slide = jax.grad(lambda x, at=at: slide.slide_energy(at._replace(slide=x), p, memory))(where)
        assert_allclose(by_slide, force, rtol=1e-12)
        assert_allclose(stiffness * (where - slide.after_slide(at, p, memory).slid), force, rtol=1e-9)
        assert_allclose(slide.shear_stress(at, p, memory) * slide.arm(at, p), force, rtol=1e-12)
    held = Point.cylinder(jnp.asarray(0.8))
    moved = held._replace(slide=0.0, slide_rate=0.25)
    shorter = parameters(sliding(0.3, mk.Chamber(
        outer_diameter="20 mm", inner_diameter="18 mm", law=mk.NeoHookean(c1="50 kPa"), gap=True, length=0.085 * 1.25,
    )))  # fmt: skip
    assert_allclose(chamber_density(moved, p), chamber_density(held, shorter), rtol=1e-13)  # as one of 5/4 the length
    assert_allclose(chamber_pull(moved, p), chamber_pull(held, shorter), rtol=1e-13)
    assert np.isnan(chamber_density(held._replace(slide=0.0, slide_rate=-1.1), p))


def test_without_friction_bellows_pull_evenly() -> None:
    """k (lambda - 1) all along, with lambda the length of the meridian over theirs."""
    found = mk.run(sliding(0.0), isobaric("0.05 bar", 110), tolerance=1e-4)
    at = along(found, 0)
    _, length = meridian(at)
    assert_allclose(at["stretch_axial"], length[-1] / 0.085, rtol=2e-4)  # by trapezia
    assert np.ptp(at["stretch_axial"]) < 1e-6
    assert_allclose(at["slide"], -at["slide"][::-1], atol=1e-15)
    assert_allclose(at["slide"][1:-1], 0.085 * length[1:-1] / length[-1] - at["v"][1:-1], atol=1e-6)
    assert (found.data["dissipated"] == 0.0).all()


def test_shear_lag() -> None:
    """Where bellows slide their pull changes by mu p 2 pi r per length of the mesh; where they stick, by less."""
    found = mk.run(sliding(0.01), isobaric("0.05 bar", 110, 100), tolerance=1e-10)
    turned = []
    for step in (0, 1):
        at = along(found, step)
        _, length = meridian(at)
        most = 0.01 * np.maximum(at["contact_pressure"], 0.0)
        slides = np.abs(np.abs(at["shear_stress"]) - most) < 1e-6 * most.max()
        assert 0.1 < slides.mean() < 0.99
        assert (np.abs(at["shear_stress"]) <= most * (1.0 + 1e-6)).all()
        pull = STIFF * (at["stretch_axial"] - 1.0)
        carried = -at["shear_stress"] * 2.0 * np.pi * at["r"]  # the mesh pushes on, what is behind pulls less
        by_length = np.concatenate([[0.0], np.cumsum(0.5 * (carried[1:] + carried[:-1]) * np.diff(length))])
        inside = slice(8, 57)  # of the stress, which jumps at the fitting and at mid-length, trapezia know too little
        assert_allclose((pull - pull[32])[inside], (by_length - by_length[32])[inside], atol=4e-3 * np.ptp(pull))
        turned.append(at["shear_stress"][20])
    assert turned[0] * turned[1] < 0.0  # on the way back it is held the other way
    assert found.data["dissipated"][1] > found.data["dissipated"][0] > 0.0


def test_loop() -> None:
    """Work of a closed loop = dissipated; nothing is ever won back, in length as in pressure."""
    leg = np.concatenate([np.geomspace(0.02, 1.0, 14), np.linspace(1.5, 10.0, 18)])  # close after a corner
    down, up, n = 110.0 - leg, 100.0 + leg, len(leg)
    found = mk.run(sliding(0.01), isobaric("0.05 bar", 110, *down, *up, *down), tolerance=1e-2)
    lost = found.data["dissipated"].values
    assert (np.diff(lost) >= 0.0).all()
    assert_allclose(np.trapezoid(found.force[n:], found.length[n:]), lost[-1] - lost[n], rtol=5e-3)  # by trapezia
    assert_allclose(found.force[n], found.force[-1], rtol=3e-6)  # but for the steps
    pressures = 1e5 * np.concatenate([np.linspace(0.05, 0.15, 11), np.linspace(0.14, 0.05, 10)])
    held = mk.run(sliding(0.01), mk.Isometric(length="105 mm", pressure=[*pressures, *pressures[1:]]), tolerance=1e-2)
    lost = held.data["dissipated"].values
    assert (np.diff(lost) >= 0.0).all()


def test_steps() -> None:
    """One step of the path or many: the limit of friction is that at the end of each, so that little depends on it."""
    ways = [np.linspace(90, 110, n + 1)[1:] for n in (1, 8)]
    some = [mk.run(sliding(0.01), isobaric("0.05 bar", *way), tolerance=1e-2) for way in ways]
    assert_allclose(some[0].force[-1], some[1].force[-1], rtol=1e-5)
    assert_allclose(some[0].data["dissipated"][-1], some[1].data["dissipated"][-1], rtol=2e-2)


def test_much_friction_holds_the_chamber() -> None:
    """Rough and stiff, it is the chamber that goes with the mesh; the error falls with the stiffness."""
    test = isobaric("1 bar", 105)
    held = mk.run(sliding(None), test, tolerance=1e-4).force
    off = [
        float(abs(mk.run(sliding(10.0, chamber_stiffness=grip), test, tolerance=1e-4).force - held)[0])
        for grip in (1e10, 1e11)
    ]
    assert off[1] < 0.2 * off[0] < 0.02 * held[0]
    assert not {"slide", "shear_stress", "energy_sliding"} & set(mk.run(sliding(None), test, tolerance=1e-2).data)


def test_a_tube_slides_until_it_is_pressed_to_the_mesh() -> None:
    """Free, a neo-Hookean tube slides until c1 (l1^2 - l2^2 + 3/(l1 l2)^2) is even; then the mesh holds it as it is."""
    test = mk.Isometric(length="105 mm", pressure=["0 bar", "0.5 bar", "0 bar"])
    found = mk.run(sliding(0.3, TUBE), test, tolerance=1e-2)
    free, touching, again = (along(found, step) for step in range(3))
    around, axial = free["stretch_hoop"], free["stretch_axial"]
    even = around**2 - axial**2 + 3.0 / (around * axial) ** 2
    assert np.ptp(even) < 1e-5 * even.mean()
    assert_allclose(axial, meridian(free)[1][-1] / 0.085, rtol=2e-4)  # nothing blows it up: one stretch all along
    assert found.data["contact"].values.tolist() == [0.0, 1.0, 0.0]
    assert_allclose(again["slide"], free["slide"], atol=1e-9)  # let go, it slides back
    assert np.abs(touching["slide"] - free["slide"]).max() > 1e-5
    held = mk.run(sliding(None, TUBE), test, tolerance=1e-2)
    assert held.force[0] - found.force[0] > 0.01 * held.force[0]
    assert found.data["dissipated"][2] >= found.data["dissipated"][1] > found.data["dissipated"][0] == 0.0


def test_a_sweep_goes_one_by_one() -> None:
    test = isobaric("0.05 bar", 105, 100)
    swept = mk.sweep(sliding(0.1), test, {"friction.chamber_coefficient": [0.1, 0.2]}, workers=1, tolerance=1e-2)
    assert (swept["status"] == 0).all()
    assert (swept["method"] == 1).all()
    assert_allclose(swept["force"].values[1], mk.run(sliding(0.2), test, tolerance=1e-2).force, rtol=1e-12)


def test_files(tmp_path: Any) -> None:
    muscle = sliding(0.2, constant="0.01 N mm", chamber_stiffness="0.2 MPa/mm")
    assert muscle.friction is not None
    assert muscle.friction.chamber_stiffness == pytest.approx(2e8)
    assert from_mapping({"muscle": to_mapping(muscle)}, test_required=False).muscle == muscle
    found = mk.run(muscle, isobaric("0.05 bar", 105, 100), tolerance=1e-2)
    mk.save(found, tmp_path / "loop.nc")
    assert mk.load(tmp_path / "loop.nc") == found
    assert found.data["energy_sliding"].min() > 0.0
    assert_allclose(
        found.data["energy"], sum(found.data[n] for n in found.data if str(n).startswith("energy_")), rtol=1e-12
    )
    plain = to_mapping(muscle.replace("friction", mk.Friction(constant="0.01 N mm")))
    assert not [name for name in plain["friction"] if name.startswith("chamber")]
    state = mk.solve(muscle, length="105 mm", pressure="0.5 bar")
    assert "the chamber held to the mesh" in state.reason
    assert state.force_interval is not None


WRONG: list[tuple[dict[str, Any], str]] = [
    ({"chamber_coefficient": -0.1}, "at least 0"),
    ({"chamber_stiffness": "0.1 MPa/mm"}, "chamber_coefficient: is missing"),
    ({"chamber_coefficient": 0.1, "chamber_stiffness": 0.0}, "above 0"),
    ({"chamber_coefficient": 0.1, "chamber_stiffness": "1 MPa"}, "wrong kind of unit"),
]


@pytest.mark.parametrize(("given", "said"), WRONG)
def test_wrong_input(given: dict[str, Any], said: str) -> None:
    with pytest.raises(mk.SpecError, match=said):
        mk.Friction(**given)


def test_chambers_that_cannot_slide() -> None:
    law = mk.NeoHookean(c1="50 kPa")
    for chamber, said in (
        (None, "a bare braid"),
        (mk.Chamber(thickness="1 mm", law=law), "lies around the fibres"),
        (mk.Chamber(thickness="1 mm", law=law, lies="inside"), r"needs chamber\.gap = true"),
    ):
        muscle = mk.presets.paper().replace("chamber", chamber)
        with pytest.raises(mk.SpecError, match=said):
            muscle.replace("friction", mk.Friction(chamber_coefficient=0.3))
    with pytest.raises(mk.SpecError, match="does not go with a map"):
        mk.chart(sliding(0.3), length="90 mm to 110 mm", pressure="0 to 1 bar")


def test_a_chamber_lost_on_the_way_is_sought_at_the_first_pressure(monkeypatch: pytest.MonkeyPatch) -> None:
    """The same state as by the way, as long as no crossing turns further than in a step."""
    muscle = sliding(0.3).replace("braid.fibre.stretch", True)
    usual = mk.run(muscle, isobaric("1 bar", 85.0, 84.0), tolerance=1e-3)
    way, lost = walked_module.step_to, []

    def step_to(problem: Problem, here: Going, begin: Held, end: Held, **more: Any) -> Going | None:
        if begin.get("pressure") == 0.0:
            lost.append(end)
            return None
        return way(problem, here, begin, end, **more)

    monkeypatch.setattr(walked_module, "step_to", step_to)
    found = mk.run(muscle, isobaric("1 bar", 85.0, 84.0), tolerance=1e-3)
    assert lost
    assert found.status == "complete"
    assert_allclose(found.force, usual.force, rtol=1e-8)
    # Neither has rubbed: the chamber gives elastically before it slides.
    assert_allclose(found.data["dissipated"], usual.data["dissipated"], atol=1e-15)
    monkeypatch.setattr(walked_module, "LARGEST_TURN", 1e-9)
    assert mk.run(muscle, isobaric("1 bar", 85.0, 84.0), tolerance=1e-3).reached == 0


def test_a_chamber_that_begins_to_grip_is_not_thrown_back(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without pressure bellows in a programmed braid pull evenly, under some they stick: the way there takes few walks.

    With limits that are new to points that slid freely, a Newton step goes as far as the soft bellows let it.
    """
    walk, walks = going.rub_along, []

    def counted(*given: Any) -> Any:
        walks.append(given)
        return walk(*given)

    monkeypatch.setattr(going, "rub_along", counted)
    muscle = sliding(0.38, mk.Chamber(law=mk.Bellows(axial_stiffness=0.26), lies="inside", length="80 mm"))
    muscle = muscle.replace("braid.fibre.stretch", True)
    muscle = muscle.replace("braid.angle_profile", mk.AngleProfile(angle=["42 deg"]))
    found = mk.run(muscle, isobaric("1 bar", 99.0, 98.5), tolerance=1e-2)
    assert found.status == "complete"
    assert len(walks) < 40  # 93 without

"""Fibres that stretch: against an independent code, the cylinder in closed form, and the paper's model in the limit."""

from typing import Any

import jax
import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

import mckibben as mk
from mckibben.measure.survey import error_bound, read_states
from mckibben.model.axial import axial_energy, axial_tension
from mckibben.model.parameters import parameters
from mckibben.search.finer import estimated_error
from mckibben.solver.bench import Bench
from mckibben.solver.find import find, refine
from mckibben.solver.held import Held
from mckibben.spec.text import muscle_from_mapping, to_mapping, to_toml

pytestmark = pytest.mark.effects

PET = 147.26215563702155
"""EA [N] of the paper's fibres as assumed: E pi d^2/4."""

# Case, joint, length [mm], EA over the fibre's; force [N], mid radius [mm], mid tension [N] by an independent code
# with psi and s as unknowns. Clamped, 1 bar.
STORED = [
    ("paper", "hinge", 55.0, 1.0, -47.65036898688873, 14.596184355873092, 1.0613913965716637),
    ("paper", "hinge", 55.0, 100.0, -46.698989671561286, 14.47882074685256, 1.0535654042295504),
    ("paper", "hinge", 115.0, 1.0, 92.23913206016495, 8.621525133703432, 2.4352592927435417),
    ("paper", "hinge", 115.0, 100.0, 101.11697119243861, 7.824994294966173, 2.464192415713228),
    ("bare", "pin", 115.0, 1.0, 89.96089188789398, 8.616599221958245, 2.4062042675556796),
    ("bare", "pin", 115.0, 100.0, 97.8469781366339, 7.827010539732406, 2.414021631220503),
]


def stretching(factor: float | None = 1.0, **changes: Any) -> mk.Muscle:
    """The paper's muscle with fibres of `factor` times the axial stiffness of PET ones."""
    muscle = mk.presets.paper().replace("braid.fibre.stretch", True)
    if factor is not None:
        muscle = muscle.replace("braid.fibre.axial_stiffness", factor * PET)
    for name, value in changes.items():
        muscle = muscle.replace(name.replace("__", "."), value)
    return muscle


@pytest.mark.parametrize(("case", "joint", "length", "factor", "force", "radius", "tension"), STORED)
def test_independent_values(
    case: str, joint: str, length: float, factor: float, force: float, radius: float, tension: float
) -> None:
    muscle = stretching(factor, braid__joint=joint)
    muscle = muscle.replace("chamber", None) if case == "bare" else muscle
    state = mk.solve(muscle, length=1e-3 * length, pressure="1 bar", tolerance=1e-9)
    middle = state.result.data.isel(step=0, v=64)
    assert state.verdict == "stable"
    assert_allclose(state.force, force, rtol=1e-10)
    assert_allclose(1e3 * middle["r"], radius, rtol=1e-7)
    assert_allclose(middle["fibre_tension"], tension, rtol=2e-5 if factor > 1.0 else 3e-6)
    assert_allclose(middle["fibre_tension"], factor * PET * (middle["fibre_stretch"] - 1.0), rtol=1e-12)


def test_stiff_fibres_tend_to_the_papers_model() -> None:
    held = {"length": "115 mm", "pressure": "1 bar", "tolerance": 1e-9}
    exact = mk.solve(mk.presets.paper(), **held)  # type: ignore[arg-type]
    factors = 10.0 ** np.arange(1, 5)
    states = [mk.solve(stretching(float(factor)), **held) for factor in factors]  # type: ignore[arg-type]
    short = [exact.force - state.force for state in states]
    slope = -np.polyfit(np.log(factors[1:]), np.log(short[1:]), 1)[0]
    assert abs(slope - 1.0) < 1e-3
    tension = [state.result.data["fibre_tension"].values[0, 64] for state in (exact, states[-1])]
    assert abs(tension[1] / tension[0] - 1.0) < 1e-4


def test_ea_follows_from_a_round_fibre() -> None:
    fibre = stretching(None).braid.fibre
    assert pytest.approx(PET, rel=1e-12, abs=0.0) == fibre.EA
    assert mk.presets.paper().braid.fibre.EA is None


def test_long_muscle_with_free_ends_is_the_cylinder() -> None:
    muscle = stretching(ends="free")
    braid, law = muscle.braid, muscle.chamber.law  # type: ignore[union-attr]
    _, B2, B3 = (float(B) for B in braid.fibre.stiffnesses)
    R0, t0, N, t = braid.radius, braid.angle, braid.fibres, muscle.chamber.thickness  # type: ignore[union-attr]
    A0, pressure, length = np.pi * t * (t + 2.0 * R0), 1e5, 1.3 * braid.length

    def energy(theta: float, s: float) -> float:
        """Per unit v, less P pi r^2 s; s is the meridian stretch, so that lambda = s sin(theta0)/sin(theta)."""
        stretch = s * np.sin(t0) / np.sin(theta)
        r = R0 * stretch * np.cos(theta) / np.cos(t0)
        u2 = -np.cos(t0) * np.cos(theta) / R0 + np.cos(t0) ** 2 / R0
        u3 = np.cos(t0) * np.sin(theta) / R0 - np.cos(t0) * np.sin(t0) / R0
        fibres = N / (2.0 * np.sin(t0)) * (B2 * u2**2 + B3 * u3**2 + PET * (stretch - 1.0) ** 2)
        hoop = r / R0
        chamber = A0 * float(law.c1) * (hoop**2 + s**2 + (hoop * s) ** -2 - 3.0)
        return float(fibres + chamber - pressure * np.pi * r**2 * s)

    def by(f: Any, x: float) -> float:
        return float((f(x - 2e-4) - 8.0 * f(x - 1e-4) + 8.0 * f(x + 1e-4) - f(x + 2e-4)) / 1.2e-3)

    state = mk.solve(muscle, length=length, pressure=pressure, tolerance=1e-9)
    middle = state.result.data.isel(step=0, v=64)  # where the edge effect of bending has died away
    s = float(middle["fibre_stretch"] * np.sin(middle["theta"]) / np.sin(t0))
    theta = brentq(lambda theta: by(lambda x: energy(x, s), theta), 0.7, 1.3, xtol=1e-14)
    assert_allclose(middle["theta"], theta, rtol=1e-8)
    # EA N = 8,247 N times an error of 1e-9 in the stretch is 8e-6 N.
    assert_allclose(state.force, by(lambda x: energy(theta, x), s), rtol=3e-7)


def test_longer_than_straight_fibres() -> None:
    """Full extension is no wall: 128.8 mm with the ends held, 141.2 mm along the fibres."""
    longest = mk.limits(mk.presets.paper(), pressure="1 bar").longest
    assert longest < 0.129
    curve = mk.run(stretching(), mk.Isobaric(pressure="1 bar", length="120 mm to 150 mm", points=7))
    assert curve.verdict == ("stable",) * 7
    assert (np.diff(curve.force) > 0.0).all()
    assert curve.data["error_estimate"].max() < 1e-6


def test_cautions_beyond_straight_fibres() -> None:
    """The cylinder by which they are judged is as long as its fibres at most: beyond, it says nothing of them."""
    assert mk.cautions(stretching(), length="150 mm", pressure="1 bar") == ()
    assert "pressure is above" in mk.cautions(stretching(), length="150 mm", pressure="150 bar")[0]


def test_work_is_stored() -> None:
    """Change of the stored energy = integral of F dh + P dV."""
    curve = mk.run(stretching(), mk.Isobaric(pressure="1 bar", length="100 mm to 115 mm", points=61))
    stored = curve.data["energy"].values[-1] - curve.data["energy"].values[0]
    assert_allclose(curve.data["work"].values[-1], stored, rtol=1e-6)
    parts = sum(curve.data[f"energy_{name}"] for name in ("bending_1", "bending_2", "twist", "chamber", "stretch"))
    assert_allclose(parts, curve.data["energy"], rtol=1e-12)


def test_a_slack_fibre_carries_no_compression() -> None:
    """Squeezed at no pressure the chamber presses on the fibres, which then shorten or go slack."""
    test = {"length": "70 mm", "pressure": 0.0}
    pressed = mk.solve(stretching(), **test).result.data["fibre_tension"]  # type: ignore[arg-type]
    slack = mk.solve(stretching(braid__fibre__slack=True), **test).result.data["fibre_tension"]  # type: ignore[arg-type]
    assert float(pressed.min()) < -1e-4
    assert float(slack.min()) == 0.0


CURVED = mk.AxialLaw(strain=[-0.02, 0.0, 0.01, 0.02, 0.05], force=[-0.5, 0.0, 0.3, 1.2, 6.0])
"""A yarn that is soft before it is tight."""


def by_law(law: mk.AxialLaw) -> mk.Muscle:
    """The paper's muscle with fibres of a law."""
    return stretching(None, braid__fibre=mk.Fibre(diameter="0.25 mm", E="3 GPa", nu=0.4, stretch=True, axial_law=law))


def test_points_in_line_are_an_axial_stiffness() -> None:
    held = {"length": "115 mm", "pressure": "1 bar", "tolerance": 1e-9}
    line = mk.AxialLaw(strain=[-0.01, 0.0, 0.03], force=[-0.01 * PET, 0.0, 0.03 * PET])
    one, other = (mk.solve(muscle, **held) for muscle in (by_law(line), stretching()))  # type: ignore[arg-type]
    assert_allclose(one.force, other.force, rtol=1e-11)
    assert pytest.approx(PET, rel=1e-14) == by_law(line).braid.fibre.EA


def test_between_points_the_tension_is_scipys_and_the_energy_its_integral() -> None:
    p, given = parameters(by_law(CURVED)), PchipInterpolator(CURVED.strain, CURVED.force)
    inside = np.linspace(-0.02, 0.05, 141)
    assert_allclose(jax.vmap(lambda e: axial_tension(e, p))(inside), given(inside), rtol=0.0, atol=1e-14)
    energy = jax.vmap(lambda e: axial_energy(e, p))
    assert_allclose(energy(inside), [given.integrate(0.0, e) for e in inside], rtol=0.0, atol=1e-16)
    wide = np.linspace(-0.05, 0.1, 76)  # beyond the points too
    found = jax.vmap(jax.grad(lambda e: axial_energy(e, p)))(wide)
    assert_allclose(found, jax.vmap(lambda e: axial_tension(e, p))(wide), rtol=0.0, atol=1e-13)
    assert (np.diff(found) > 0.0).all()


def test_a_curved_law_in_a_muscle() -> None:
    """Its force lies between those of muscles of its softest and of its steepest piece."""
    held = {"length": "115 mm", "pressure": "1 bar"}
    state = mk.solve(by_law(CURVED), **held)  # type: ignore[arg-type]
    field = state.result.data.isel(step=0)
    assert state.verdict == "stable"
    given = PchipInterpolator(CURVED.strain, CURVED.force)
    assert_allclose(field["fibre_tension"], given(field["fibre_stretch"] - 1.0), rtol=1e-11)
    soft, stiff = (mk.solve(stretching(EA / PET), **held).force for EA in (25.0, 160.0))  # type: ignore[arg-type]
    assert soft < state.force < stiff


def test_derivative_by_a_point_of_the_law() -> None:
    test = mk.Isometric(length="115 mm", pressure="1 bar")
    name = "braid.fibre.axial_law.force[4]"
    found = mk.sensitivity(by_law(CURVED), test, of="force", by=[name], tolerance=1e-9).absolute.loc[name, "force"]

    def force(last: float) -> float:
        law = mk.AxialLaw(strain=CURVED.strain, force=[*CURVED.force[:4], last])
        return mk.solve(by_law(law), length="115 mm", pressure="1 bar", tolerance=1e-9).force

    assert found == pytest.approx((force(6.0 + 1e-3) - force(6.0 - 1e-3)) / 2e-3, rel=1e-6)


def test_a_law_in_a_file() -> None:
    muscle = by_law(CURVED)
    assert muscle_from_mapping(to_mapping(muscle)) == muscle
    assert "axial_law" in to_toml(muscle)


POINTS: list[tuple[dict[str, Any], str]] = [
    ({"strain": [0.0, 0.01], "force": [0.0]}, "as many numbers as strain"),
    ({"strain": [0.0, 0.02, 0.01], "force": [0.0, 1.0, 2.0]}, r"strain\[2\].*above the number before"),
    ({"strain": [0.0, 0.01, 0.02], "force": [0.0, 2.0, 1.0]}, r"force\[2\].*above the number before"),
    ({"strain": [0.01, 0.02], "force": ["1 N", "2 N"]}, "strain 0 and force 0"),
    ({"strain": [0.0, 0.02], "force": [0.1, 0.2]}, "strain 0 and force 0"),
    ({"strain": [-1.0, 0.0], "force": [-1.0, 0.0]}, "above -1"),
]


@pytest.mark.parametrize(("given", "said"), POINTS)
def test_points_that_are_no_law(given: dict[str, Any], said: str) -> None:
    with pytest.raises(mk.SpecError, match=said):
        mk.AxialLaw(**given)


WRONG: list[tuple[dict[str, Any], str]] = [
    ({"axial_stiffness": "147 N"}, "only for fibres that stretch"),
    ({"slack": True}, "only for fibres that stretch"),
    ({"axial_law": CURVED}, "only for fibres that stretch"),
    ({"stretch": True, "axial_law": CURVED, "axial_stiffness": "147 N"}, "leave one of them out"),
    ({"stretch": "yes"}, "must be true or false"),
    ({"stretch": True, "axial_stiffness": "-1 N"}, "above 0"),
]


@pytest.mark.parametrize(("given", "said"), WRONG)
def test_wrong_input(given: dict[str, Any], said: str) -> None:
    with pytest.raises(mk.SpecError, match=said):
        mk.Fibre(diameter="0.25 mm", E="3 GPa", nu=0.4, **given)


def test_stiffnesses_alone_tell_no_axial_one() -> None:
    with pytest.raises(mk.SpecError, match="give EA"):
        mk.Fibre(B1="0.5 N mm^2", B2="0.5 N mm^2", B3="0.4 N mm^2", stretch=True)


def test_the_papers_mesh_refuses() -> None:
    with pytest.raises(mk.SpecError, match="neither stretch nor roll"):
        mk.run(stretching(), mk.Isometric(length="115 mm", pressure="1 bar"), discretisation="paper")


def test_a_region_without_a_longest_length_says_so() -> None:
    pressures = np.array([0.5e5, 1e5])
    lengths = {name: ("pressure", np.full(2, 0.033)) for name in ("shortest", "stable_down_to")}
    data = xr.Dataset(
        {**lengths, "longest": ("pressure", np.full(2, np.nan))},
        {"pressure": pressures},
        {"muscle": to_toml(stretching()), "assumed": ""},
    )
    (axes,) = mk.plot(data).axes
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert "admissible and stable, with no longest length" in labels
    assert "full extension" not in labels


def test_the_estimate_knows_where_fibres_go_slack() -> None:
    """Between two points, near the fittings of a muscle that is pressed together: the sum over points errs there."""
    muscle = stretching(braid__fibre__slack=True)
    bench, held = Bench.of(muscle), Held.of(length=0.075, pressure=0.0)
    b = bench.placement(held)
    coarse = find(bench.problem(48, b), held)
    fine = refine(coarse, bench.problem(192, b), held)
    assert coarse.converged
    assert fine.converged
    off = abs(coarse.force / fine.force - 1.0)
    seen = read_states(coarse.problem, coarse.u[None], coarse.loads[None], False)[0]
    without = float(error_bound(seen.conserved_variation, seen.coefficient_tail)[0])
    assert without < off < estimated_error(coarse, held) < 10.0 * off
    slender = find(Bench.of(muscle).problem(48, b), Held.of(length=0.11, pressure=1e5))
    told = read_states(slender.problem, slender.u[None], slender.loads[None], False)[0].missed
    assert told is not None
    assert float(told.length[0]) == 0.0  # taut everywhere

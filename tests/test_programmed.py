"""A programmed braid: an angle that varies along the length, against what does not, closed forms, and other codes."""

import math
from functools import cache
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose
from readings import profile
from scipy.interpolate import CubicSpline, PchipInterpolator
from scipy.optimize import fsolve

import mckibben as mk
from mckibben.designing.space import space_of
from mckibben.measure.bow import left_to_bow
from mckibben.model.kinematics import natural_strains
from mckibben.model.parameters import parameters
from mckibben.model.point import Point
from mckibben.model.profile import along, evened, fibre_lengths, made_at
from mckibben.search.finer import estimated_error
from mckibben.solver.bench import Bench
from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.find import find
from mckibben.solver.held import Held
from mckibben.spec.change import changed_muscle
from mckibben.spec.text import muscle_from_mapping, to_mapping
from mckibben.spec.winding import fibre_length, turned
from mckibben.sweeps.groups import grouped
from mckibben.view.tube import Tube

pytestmark = pytest.mark.effects

UNIFORM = mk.presets.paper().replace("braid.fibre.stretch", True)
R0, H0, H, P = 12.5e-3, 85e-3, 0.105, 1e5
DEG = math.pi / 180.0
CROWDED = 2.2
"""How strongly points are crowded to the ends, whatever the muscle, so that only what differs does."""
QUARTERS = np.linspace(0.0, 1.0, 5)


def programmed(*angles: float, **others: Any) -> mk.Muscle:
    """The paper's muscle with angles [deg] at even places beyond the first end, whose own is 37 deg."""
    fields = {name: others.pop(name) for name in ("at", "mirrored", "between") if name in others}
    made = mk.AngleProfile(angle=[f"{angle!r} deg" for angle in angles], **fields)
    return changed_muscle(UNIFORM, {"braid.angle_profile": made} | others)


def halves(quarter: float = 41.0, middle: float = 46.0, **others: Any) -> mk.Muscle:
    """A mirrored one, by a spline."""
    return programmed(quarter, middle, mirrored=True, **others)


def whole(*angles: float, **others: Any) -> mk.Muscle:
    """One that is not mirrored, by monotone pieces over the quarters of the length."""
    return programmed(*angles, between="monotone", **others)


LOPSIDED = whole(40.0, 44.0, 46.0, 45.0)


@cache
def found(muscle: mk.Muscle, length: float = H, pressure: float = P, size: int = 24) -> Equilibrium:
    """The state, without what is read off it."""
    state = find(Bench.of(muscle).problem(size, CROWDED), Held.of(length=length, pressure=pressure))
    assert state.converged
    return state


@cache
def solved() -> mk.State:
    return mk.solve(halves(), length=H, pressure=P, tolerance=1e-4)


def test_one_angle_all_along_is_the_uniform_braid() -> None:
    """To rounding, on half the length and on all of it."""
    uniform = found(UNIFORM)
    for muscle in (halves(37.0, 37.0), whole(37.0, 37.0, 37.0, 37.0)):
        state = found(muscle)
        assert_allclose([state.force, state.volume], [uniform.force, uniform.volume], rtol=1e-12)
    shape = profile(found(halves(37.0, 37.0)).problem, found(halves(37.0, 37.0)).u, 33)
    assert_allclose(shape, profile(uniform.problem, uniform.u, 33), atol=1e-9)


def test_a_mirror_image() -> None:
    """As nearly as so few unknowns know pieces with jumps of their curvature."""
    there, back = found(LOPSIDED), found(changed_muscle(whole(46.0, 44.0, 40.0, 37.0), {"braid.angle": "45 deg"}))
    assert_allclose([back.force, back.volume], [there.force, there.volume], rtol=3e-4)
    (theta, psi, _), (other, opposite, _) = (profile(one.problem, one.u, 65) for one in (there, back))
    assert_allclose(other[::-1], theta, atol=2e-4)
    assert_allclose(opposite[::-1], -psi, atol=3e-4)


def test_as_made_nothing_is_strained() -> None:
    """At its own length, without pressure, there is no force; the fibres lie as they were braided."""
    state = found(halves(), H0, 0.0)
    assert abs(state.force) < 1e-9
    assert_allclose(state.u, 0.0, atol=1e-9)
    theta, psi, _ = profile(state.problem, state.u, 33)
    share = state.problem.basis.coordinate(np.linspace(-1.0, 0.0, 33), state.problem.p, CROWDED) / H0
    assert_allclose(theta, CubicSpline(QUARTERS, np.radians([37, 41, 46, 41, 37]))(share), rtol=1e-12)
    assert_allclose(psi, 0.0, atol=1e-9)


def test_work_is_stored() -> None:
    """Force and volume are the slopes of one potential, W = U - P V."""

    def potential(length: float, pressure: float) -> float:
        state = found(halves(), length, pressure)
        return float(state.totals[0] * state.problem.unit[0]) - pressure * state.volume

    by, state = 1e-5, found(halves())
    assert_allclose((potential(H + by, P) - potential(H - by, P)) / (2.0 * by), state.force, rtol=5e-8)
    assert_allclose(-(potential(H, P + 100.0) - potential(H, P - 100.0)) / 200.0, state.volume, rtol=5e-9)


def test_unknowns_converge() -> None:
    """By the sixth power where the third derivative of the angle jumps at mid-length alone; the error is not less than
    what the estimate says."""
    exact = found(halves(), size=48).force
    coarse, fine = (abs(found(halves(), size=size).force / exact - 1.0) for size in (12, 24))
    assert 1e-5 < coarse < 1e-3
    assert fine < coarse / 30.0
    state = solved()
    assert state.verdict == "stable"
    assert state.modes.antisymmetric == 0
    off = abs(state.force - exact) / (abs(exact) + math.pi * R0**2 * P)
    assert off < state.error_estimate < 4.0 * off


@pytest.mark.parametrize(("muscle", "safe"), [(halves(), 2.0), (LOPSIDED, 8.0)], ids=["spline", "monotone"])
def test_the_error_estimate_is_what_more_unknowns_change(muscle: mk.Muscle, safe: float) -> None:
    """Times 2, and 8 for monotone pieces; to a fifth, whatever is held: the step that foretells the finer state is one
    of Newton's and a little more."""
    coarse, fine = found(muscle, size=12), found(muscle, size=24)
    load = abs(fine.force) + math.pi * R0**2 * P
    by_force = estimated_error(coarse, Held.of(length=H, pressure=P))
    assert by_force == pytest.approx(safe * abs(coarse.force - fine.force) / load, rel=0.2)
    for names, free in ((("force", "pressure"), "length"), (("length", "volume"), "pressure")):
        held = Held(names, tuple(float(getattr(fine, name)) for name in names))
        state = find(coarse.problem, held, coarse, radius=0.1)
        assert state.converged
        miss = safe * abs(getattr(state, free) / getattr(fine, free) - 1.0)
        assert estimated_error(state, held) >= 0.8 * miss > 1e-8
        if free == "length":
            assert estimated_error(state, held) <= 1.2 * miss


def test_the_error_estimate_as_made() -> None:
    """Where no load is to compare with, rounding is not taken for an error."""
    assert estimated_error(found(halves(), H0, 0.0), Held.of(length=H0, pressure=0.0)) < 1e-9


def test_slopes_by_the_angles() -> None:
    """Against central differences."""
    test, by = mk.Isometric(length=H, pressure=P), 1e-3
    slopes = jax.grad(lambda muscle: mk.response(muscle, test, tolerance=1e-4)["force"][0])(halves()).braid
    pairs = [
        [changed_muscle(halves(), {"braid.angle": (37.0 + d) * DEG}) for d in (by, -by)],
        [halves(quarter=41.0 + d) for d in (by, -by)],
        [halves(middle=46.0 + d) for d in (by, -by)],
    ]
    for slope, (up, down) in zip((slopes.angle, *slopes.angle_profile.angle), pairs, strict=True):
        difference = (found(up).force - found(down).force) / (2.0 * by * DEG)
        assert float(slope) == pytest.approx(difference, rel=1e-4)


def cylinder(angle: float, force: float, pressure: float) -> float:
    """Braid angle [rad] of a long muscle under a force and a pressure, by its energy per unit v."""
    braid, law = UNIFORM.braid, UNIFORM.chamber.law
    EA, N, A0 = float(braid.fibre.EA), braid.fibres, float(UNIFORM.chamber.area(R0))
    _, B2, B3 = map(float, braid.fibre.stiffnesses)
    c0, s0 = math.cos(angle), math.sin(angle)

    def density(x: jax.Array) -> jax.Array:
        hoop, axial = x
        stretch = jnp.hypot(axial * s0, hoop * c0)
        s, c = axial * s0 / stretch, hoop * c0 / stretch
        bent, turned = c0 * (c - c0) / R0, c0 * (s - s0) / R0
        w = N / (2.0 * s0) * (B2 * bent**2 + B3 * turned**2 + EA * (stretch - 1.0) ** 2)
        w = w + A0 * float(law.c1) * (hoop**2 + axial**2 + (hoop * axial) ** -2 - 3.0)
        return w - force * axial - pressure * math.pi * (R0 * hoop) ** 2 * axial

    hoop, axial = fsolve(jax.grad(density), [0.8, 1.1], fprime=jax.hessian(density), xtol=1e-12)
    return math.atan2(axial * s0, hoop * c0)


def test_zones_of_a_long_muscle_are_cylinders() -> None:
    """Each has the angle of the closed form for its own, under the force of the whole."""
    muscle = whole(37.0, 44.0, 44.0, 44.0, at=[0.44, 0.56, 0.8, 1.0], **{"braid.length": "0.4 m"})
    state = found(muscle, 0.45, 2e5, 36)
    theta, psi, _ = profile(state.problem, state.u, 401)
    share = state.problem.basis.coordinate(np.linspace(-1.0, 1.0, 401), state.problem.p, CROWDED) / 0.4
    for angle, place in ((37.0, 0.22), (44.0, 0.78)):
        k = int(np.argmin(np.abs(share - place)))
        assert abs(psi[k]) < 1e-3
        assert_allclose(theta[k], cylinder(angle * DEG, state.force, 2e5), atol=5e-4)  # the zones differ by 0.035


def elements(angle: Any, start: Equilibrium, n: int) -> float:
    """Force [N] by straight elements in slope and meridian stretch, of which the fibres' stretch and angle follow."""
    braid, chamber, dv = UNIFORM.braid, UNIFORM.chamber, H0 / n
    B1, B2, B3 = map(float, braid.fibre.stiffnesses)
    EA, N, A0, c1 = float(braid.fibre.EA), braid.fibres, float(chamber.area(R0)), float(chamber.law.c1)
    share = (np.arange(n) + 0.5) / n
    s0, c0, rate0 = np.sin(angle(share)), np.cos(angle(share)), angle(share, 1) / H0

    def totals(x: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
        psi, s = jnp.pad(x[: n - 1], 1), x[n - 1 :]
        mid, kappa = 0.5 * (psi[1:] + psi[:-1]), (psi[1:] - psi[:-1]) / dv
        steps = dv * s * jnp.sin(mid)
        r = R0 + jnp.cumsum(steps) - 0.5 * steps
        stretch = jnp.hypot(s * s0, r / R0 * c0)
        sine, cosine = s * s0 / stretch, r / R0 * c0 / stretch
        theta = jnp.arctan2(sine, cosine)
        first, last = ((-3 * t[0] + 4 * t[1] - t[2]) / (2.0 * dv) for t in (theta, theta[::-1]))
        rate = jnp.concatenate([first[None], (theta[2:] - theta[:-2]) / (2.0 * dv), -last[None]])
        u1 = s0 * (rate - rate0) - c0 * jnp.sin(mid) / R0
        u2 = -c0 * cosine * jnp.cos(mid) / R0 + s0 * sine * kappa + c0 * c0 / R0
        u3 = c0 * sine * jnp.cos(mid) / R0 + s0 * cosine * kappa - c0 * s0 / R0
        w = N / (2 * s0) * (B1 * u1**2 + B2 * u2**2 + B3 * u3**2 + EA * (stretch - 1.0) ** 2)
        hoop, rise = r / R0, s * jnp.cos(mid)
        w = w + A0 * c1 * (hoop**2 + s**2 + (hoop * s) ** -2 - 3.0) - P * math.pi * r**2 * rise
        return jnp.sum(w) * dv, jnp.sum(rise) * dv, jnp.sum(steps)

    def lagrangian(x: jax.Array) -> jax.Array:
        energy, h, closure = totals(x[:-2])
        return energy - x[-2] * (h - H) - x[-1] * closure

    slope, bend = jax.jit(jax.grad(lagrangian)), jax.jit(jax.hessian(lagrangian))
    theta, psi, _ = profile(start.problem, start.u, 401)  # Newton alone: a start that is near
    at = start.problem.basis.coordinate(np.linspace(-1.0, 1.0, 401), start.problem.p, CROWDED) / H0
    stretched = np.interp(share, at, np.sin(theta)) / s0
    x = np.concatenate([np.interp(np.arange(1, n) / n, at, psi), stretched, [start.force, 0.0]])
    for _ in range(8):
        x = x - np.linalg.solve(bend(x), slope(x))
    assert np.abs(slope(x)).max() < 1e-8
    return float(x[-2])


def test_against_a_code_of_its_own() -> None:
    """Second order: extrapolated, its force is that of the series."""
    state = found(LOPSIDED)
    angle = PchipInterpolator(QUARTERS, np.radians([37.0, 40.0, 44.0, 46.0, 45.0]))
    coarse, fine = (elements(angle, state, n) for n in (80, 160))
    assert 1e-5 < abs(fine / state.force - 1.0) < 1e-2
    assert_allclose((4.0 * fine - coarse) / 3.0, state.force, rtol=1e-4)


@pytest.mark.parametrize("between", ["spline", "monotone"])
@pytest.mark.parametrize("angles", [(45.0,), (45.0, 41.0), (45.0, 45.0, 40.0), (44.0, 48.0, 39.0, 42.0, 38.0)])
def test_the_angle_is_that_of_scipy(between: str, angles: tuple[float, ...]) -> None:
    muscle = programmed(*angles, between=between)
    x, y = np.linspace(0.0, 1.0, len(angles) + 1), np.radians([37.0, *angles])
    curve = (CubicSpline if between == "spline" else PchipInterpolator)(x, y)
    share = np.linspace(0.0, 1.0, 77)
    angle, rate = along(jnp.asarray(share), parameters(muscle))
    assert_allclose(angle, curve(share), rtol=1e-13)
    assert_allclose(rate, curve(share, 1), atol=1e-12)


def test_how_the_fibres_wind() -> None:
    """Their length, their turns, and their strains as made, from the curve in space."""
    muscle = programmed(40.0, 48.0, 44.0, between="monotone")
    share = np.linspace(0.0, 1.0, 20001)
    angle = PchipInterpolator(np.linspace(0.0, 1.0, 4), np.radians([37.0, 40.0, 48.0, 44.0]))
    phi = turned(muscle.braid, share)
    xyz = np.stack([R0 * np.cos(phi), R0 * np.sin(phi), H0 * share], axis=1)
    way = float(np.linalg.norm(np.diff(xyz, axis=0), axis=1).sum())
    assert_allclose([fibre_length(muscle.braid), float(fibre_lengths(muscle))], way, rtol=1e-8)
    tube = Tube.cylinder(muscle)  # what pictures draw
    v, around = tube.fibre(0.3, -1)
    assert_allclose(around, 0.3 - turned(muscle.braid, v / H0), atol=1e-5)
    assert_allclose(tube.reached(tube.turned(v)), v, atol=1e-12)
    p = parameters(muscle)
    assert_allclose(float(p.H0 / jnp.sin(evened(p).theta0)), way, rtol=1e-8)
    places = np.array([0.2, 0.5, 0.9])
    k = (places * 20000).astype(int)
    tangent = np.gradient(xyz, share, axis=0)
    speed = np.linalg.norm(tangent, axis=1)
    tangent = tangent / speed[:, None]
    curved = (np.gradient(tangent, share, axis=0) / speed[:, None])[k]
    normal = np.stack([np.cos(phi), np.sin(phi), 0.0 * phi], axis=1)[k]
    aside, bent = np.sum(curved * np.cross(normal, tangent[k]), axis=1), np.sum(curved * normal, axis=1)
    found = jax.vmap(lambda share: jnp.stack(natural_strains(_as_made(share, p), p)))(jnp.asarray(places))
    assert_allclose(found[:, 0], aside, rtol=1e-5)
    assert_allclose(found[:, 1], bent, rtol=1e-6)
    assert_allclose(found[:, 2], np.sin(2.0 * angle(places)) / (2.0 * R0), rtol=1e-12)


def _as_made(share: jax.Array, p: Any) -> Point:
    made = made_at(share, p)
    return Point(made.angle, 0.0, 0.0, 1.0, made.rate, made=made)


def test_in_sweeps_fits_and_files() -> None:
    muscle = halves()
    assert muscle_from_mapping(to_mapping(muscle)) == muscle
    assert "angle_profile" not in to_mapping(UNIFORM)["braid"]
    space = space_of(muscle, {"braid.angle_profile.angle[1]": "42 deg to 50 deg"})
    assert_allclose(space.muscle_at(np.array([0.5])).braid.angle_profile.angle, np.radians([41.0, 46.0]))
    assert LOPSIDED.braid.__remark__() == "37 deg to 46 deg from the parallels, programmed along the length"
    angles = {"braid.angle_profile.angle[0]": np.radians([[41.0], [89.0], [5.0], [42.0]])}
    group = grouped(muscle, mk.Isometric(length=H, pressure=P), angles, np.arange(4))
    assert group is not None
    assert group.index.tolist() == [0, 3]  # the others swing beyond 90 deg, or below 0


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            {"braid.fibre.stretch": False},
            r"angle_profile: asks for fibres that stretch.*set braid\.fibre",
        ),
        ({"end_radii": "11 mm"}, "does not go with end_radii"),
        ({"braid.angle_from": "axis"}, "does not go with an angle that is given from the axis"),
        ({"braid.angle_profile.angle": ["95 deg", "40 deg"]}, r"angle\[0\] = 95 deg: must be above 0 deg and below 90"),
        ({"braid.angle_profile.angle": [40.0, 41.0]}, 'write "40 deg"'),
        ({"braid.angle_profile.angle": ["-3 deg", "40 deg"]}, r"angle\[0\]"),
        ({"braid.angle_profile.angle": ["88 deg", "3 deg"]}, "swings from .* between the angles given"),
        ({"braid.angle_profile": mk.AngleProfile(angle="5 deg")}, "the fibres overlap"),
        ({"braid.angle_profile.at": [0.5]}, "must have as many numbers as angle"),
        ({"braid.angle_profile.at": [0.3, 0.9]}, "must be 0.5, mid-length"),
        ({"braid.angle_profile.at": [0.6, 0.5]}, "must be above the number before it"),
        ({"braid.angle_profile.between": "linear"}, "must be one of spline, monotone"),
    ],
)
def test_what_is_refused(change: dict[str, Any], said: str) -> None:
    with pytest.raises(mk.SpecError, match=said):
        changed_muscle(halves(), change)


def test_the_margin_against_bowing_takes_the_mean_braid() -> None:
    """That of one angle, whose fibres are as long, and not that of the first end."""
    length, force = np.array([0.085, 0.08]), np.array([-40.0, -60.0])

    def left(muscle: mk.Muscle) -> np.ndarray:
        twice = jax.tree.map(lambda number: jnp.stack([jnp.asarray(number)] * 2), parameters(muscle))
        return left_to_bow(twice, length, force, P)

    made = halves()
    even = UNIFORM.replace("braid.angle", math.asin(H0 / fibre_length(made.braid)))
    assert left(programmed(37.0, 37.0, mirrored=True)) == pytest.approx(left(UNIFORM), rel=1e-12)
    assert left(made) == pytest.approx(left(even), rel=1e-9)
    assert left(made)[0] > left(UNIFORM)[0] + 0.01


def test_what_knows_one_angle_alone() -> None:
    with pytest.raises(mk.SpecError, match="textbook formulas, which know one braid angle"):
        mk.textbook_force(halves(), length="0.1 m", pressure="1 bar")
    tube = mk.Chamber(outer_diameter="20 mm", inner_diameter="18 mm", law=mk.MooneyRivlin(c1="20 kPa"), gap=True)
    with pytest.raises(mk.SpecError, match=r"chamber\.gap = true: does not go with braid\.angle_profile"):
        mk.solve(halves(chamber=tube), length=H, pressure=P)

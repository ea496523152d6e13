"""Fittings of another radius than the braid's: equal on half the length, unequal on all of it."""

import math
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad

import mckibben as mk
from mckibben.model.cylinder import cylinder_force
from mckibben.model.extension import between, full_extension, longest
from mckibben.model.kinematics import end_angle
from mckibben.model.parameters import parameters
from mckibben.search.finer import estimated_error
from mckibben.solver.bench import Bench
from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.find import find, refine
from mckibben.solver.held import Held
from mckibben.spec.change import changed_muscle
from mckibben.spec.text import muscle_from_mapping, to_mapping

pytestmark = pytest.mark.effects

R0, H0, THETA0 = 12.5e-3, 85e-3, math.radians(37.0)
UNIT = R0 / math.cos(THETA0)
"""Radius of a braid whose fibres lie flat around it [m]."""
NARROW, WIDE = 10e-3, 14e-3
OUTER, INNER, TUBE, C1 = 18e-3, 15e-3, 80e-3, 50e3
STRAIGHT = changed_muscle(
    mk.presets.paper(),
    {
        "braid.fibre.natural": "straight",
        "chamber": mk.Chamber(outer_diameter=OUTER, inner_diameter=INNER, length=TUBE, law=mk.NeoHookean(c1=C1)),
    },
)
"""Neither its fibres, straight when free, nor its tube knows the radius at which the braid was made."""
HELD = {"length": "110 mm", "pressure": "1 bar"}


def ended(*radii: float, **changes: Any) -> mk.Muscle:
    return changed_muscle(STRAIGHT, {"end_radii": list(radii)} | changes)


def again(R: float, *radii: float) -> mk.Muscle:
    """The same fibres on the same fittings, as a braid that was made at another radius R [m]: N, their length, and
    R/cos(theta) stay."""
    theta = math.acos(R / UNIT)
    made = {"braid.radius": R, "braid.angle": theta, "braid.length": H0 * math.sin(theta) / math.sin(THETA0)}
    return ended(*radii, **made)


def test_what_is_held() -> None:
    state = mk.solve(ended(NARROW, WIDE), **HELD)
    r, psi = state.data["r"].values, state.data["psi"].values
    assert state.verdict == "stable"
    assert_allclose([r[0], r[-1]], [NARROW, WIDE], rtol=1e-12)
    assert_allclose([psi[0], psi[-1]], 0.0, atol=1e-12)
    assert state.error_estimate < 1e-6
    assert end_angle(parameters(ended(R0)), 0) == pytest.approx(THETA0, rel=1e-15)


def found(muscle: mk.Muscle, length: float, pressure: float) -> Equilibrium:
    """The state of a symmetric muscle, without what is read off it."""
    held, bench = Held.of(length=length, pressure=pressure), Bench.of(muscle)
    state = find(bench.problem(48, bench.placement(held)), held)
    assert state.converged
    return state


def test_equal_radii_by_either_way() -> None:
    """On half the length, and on all of it."""
    one, two = found(ended(NARROW), 0.11, 1e5), mk.solve(ended(NARROW, NARROW), **HELD)
    assert two.modes.antisymmetric is None
    assert_allclose(two.force, one.force, rtol=1e-9)
    assert_allclose(two.volume, one.volume, rtol=1e-9)


def test_a_mirror_image() -> None:
    there, back = (mk.solve(ended(*radii), **HELD) for radii in ((NARROW, WIDE), (WIDE, NARROW)))
    assert_allclose(back.force, there.force, rtol=1e-10)
    assert_allclose(back.data["r"].values[::-1], there.data["r"], rtol=1e-9)
    assert_allclose(back.data["psi"].values[::-1], -there.data["psi"], atol=1e-9)
    assert_allclose(back.data["fibre_tension"].values[::-1], there.data["fibre_tension"], rtol=1e-7)


def test_a_cylinder_at_the_radius_of_the_fittings() -> None:
    """Of that length the clamped muscle is that cylinder, at every pressure, with the force of the closed form."""
    muscle = ended(NARROW)
    theta = math.acos(NARROW / UNIT)
    length = H0 * math.sin(theta) / math.sin(THETA0)
    for pressure in (0.0, 2e5):
        state = found(muscle, length, pressure)
        assert_allclose(state.force, cylinder_force(theta, pressure, parameters(muscle)), rtol=1e-11)
        assert_allclose(state.volume, math.pi * NARROW**2 * length, rtol=1e-11)
        assert_allclose(state.u, 0.0, atol=1e-11)


def test_the_middle_of_a_long_muscle() -> None:
    """Whatever the fittings, it is the uniform cylinder, and the force is the cylinder's at its angle."""
    muscle = ended(NARROW, WIDE, **{"braid.length": 0.25, "chamber.length": 0.24})
    state = mk.solve(muscle, length="0.3 m", pressure="2 bar")
    middle = float(state.data["theta"][64])
    assert_allclose(state.force, float(cylinder_force(middle, 2e5, parameters(muscle))), rtol=1e-7)


def test_the_radius_at_which_it_was_made_does_not_matter() -> None:
    """The same fibres on the same fittings, made as another cylinder, are the same muscle."""
    one, two = (mk.solve(muscle, **HELD) for muscle in (ended(NARROW, WIDE), again(11e-3, NARROW, WIDE)))
    assert one.verdict == "stable"
    assert_allclose(two.force, one.force, rtol=1e-9)
    assert_allclose(two.volume, one.volume, rtol=1e-9)
    assert_allclose(two.data["energy"], one.data["energy"], rtol=1e-9)
    assert_allclose(two.data["fibre_tension"][64], one.data["fibre_tension"][64], rtol=1e-7)
    three, four = (found(muscle, 0.11, 1e5) for muscle in (ended(NARROW), again(11e-3, NARROW)))
    assert_allclose(four.force, three.force, rtol=1e-9)


def test_work_is_stored() -> None:
    """Force and volume are the slopes of one potential, W = U - P V."""
    muscle, h, P, by = ended(NARROW, WIDE), 0.11, 1e5, 1e-4

    def potential(length: float, pressure: float) -> float:
        state = mk.solve(muscle, length=length, pressure=pressure)
        return float(state.data["energy"]) - pressure * state.volume

    state = mk.solve(muscle, length=h, pressure=P)
    along = (potential(h + by, P) - potential(h - by, P)) / (2.0 * by)
    across = (potential(h, P + 1e3) - potential(h, P - 1e3)) / 2e3
    assert_allclose(along, state.force, rtol=5e-6)
    assert_allclose(-across, state.volume, rtol=5e-8)


def elements(n: int, length: float, pressure: float) -> float:
    """Force [N] by straight elements in psi, midpoint rule and Newton: theory page, sections 2 to 5 and the tube."""
    fibre = STRAIGHT.braid.fibre
    B = math.pi * fibre.E * fibre.diameter**4 / 64
    A0 = math.pi * (OUTER**2 - INNER**2) / 4 * TUBE / H0
    N, dv, s0, c0, a = STRAIGHT.braid.fibres, H0 / n, math.sin(THETA0), math.cos(THETA0), 1 / (R0 * math.tan(THETA0))
    first, last = (math.acos(radius / UNIT) for radius in (NARROW, WIDE))

    def totals(inner: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
        psi = jnp.pad(inner, 1)
        mid, kappa = 0.5 * (psi[1:] + psi[:-1]), (psi[1:] - psi[:-1]) / dv
        turned = a * dv * jnp.cumsum(jnp.sin(mid))
        theta = first - turned + 0.5 * a * dv * jnp.sin(mid)
        u1 = -2 * c0 * jnp.sin(mid) / R0
        u2 = -c0 * jnp.cos(theta) * jnp.cos(mid) / R0 + s0 * jnp.sin(theta) * kappa
        u3 = c0 * jnp.sin(theta) * jnp.cos(mid) / R0 + s0 * jnp.cos(theta) * kappa
        w = N * B / (2 * s0) * (u1**2 + u2**2 + u3**2 / (1 + fibre.nu))
        r, s = R0 * jnp.cos(theta) / c0, jnp.sin(theta) / s0
        hoop, axial, rise = r / (OUTER / 2), s * H0 / TUBE, s * jnp.cos(mid)
        w = w + A0 * C1 * (hoop**2 + axial**2 + (hoop * axial) ** -2 - 3.0) - pressure * math.pi * r**2 * rise
        return jnp.sum(w) * dv, jnp.sum(rise) * dv, first - turned[-1] - last

    def lagrangian(x: jax.Array) -> jax.Array:
        energy, h, closure = totals(x[:-2])
        return energy - x[-2] * (h - length) - x[-1] * closure

    slope, bend = jax.jit(jax.grad(lagrangian)), jax.jit(jax.hessian(lagrangian))
    start = mk.solve(ended(NARROW, WIDE), length=length, pressure=pressure).data  # Newton alone: a start that is near
    v = np.linspace(0.0, H0, n + 1)[1:-1]
    x = np.concatenate([np.interp(v, start["v"], start["psi"]), [float(start["force"]), 0.0]])
    for _ in range(8):
        x = x - np.linalg.solve(bend(x), slope(x))
    assert np.abs(slope(x)).max() < 1e-9
    return float(x[-2])


def test_against_a_code_of_its_own() -> None:
    """Second order: extrapolated, its force is that of the series."""
    coarse, fine = (elements(n, 0.1, 5e4) for n in (120, 240))
    found = mk.solve(ended(NARROW, WIDE), length=0.1, pressure=5e4).force
    assert 1e-5 < abs(fine / found - 1.0) < 1e-2
    assert_allclose((4.0 * fine - coarse) / 3.0, found, rtol=2e-5)


def test_slopes_by_the_radii() -> None:
    """Against central differences of `solve`."""
    test, h = mk.Isometric(**HELD), 1e-6
    by = jax.grad(lambda muscle: mk.response(muscle, test)["force"][0])(ended(NARROW, WIDE)).end_radii
    for k, slope in enumerate(by):
        up, down = [NARROW, WIDE], [NARROW, WIDE]
        up[k], down[k] = up[k] + h, down[k] - h
        difference = mk.solve(ended(*up), **HELD).force - mk.solve(ended(*down), **HELD).force
        assert float(slope) == pytest.approx(difference / (2.0 * h), rel=1e-6)


def through(narrow: float, wide: float, T: float | None, k: float = 0.0) -> tuple[float, float]:
    """Fibre and length of an extremal in units of R0/cos(theta0), by quadrature: its waist T before the narrow end."""
    c = -k if T is None else (math.cos(narrow) / math.cosh(T)) ** 2

    def both(low: float, high: float) -> np.ndarray:  # in t, x = sqrt(c) cosh(t), or in theta
        if T is None:
            rates = (
                lambda t: math.sqrt((1 - c) / (math.cos(t) ** 2 - c)),
                lambda t: math.sin(t) ** 2 / math.sqrt(math.cos(t) ** 2 - c),
            )
        else:
            rates = (
                lambda t: math.sqrt((1 - c) / (1 - c * math.cosh(t) ** 2)),
                lambda t: math.sqrt(1 - c * math.cosh(t) ** 2),
            )
        return np.array([quad(rate, low, high, epsabs=1e-13, epsrel=1e-13)[0] for rate in rates])

    if T is None:
        return tuple(both(wide, narrow))
    return tuple(both(-T, math.acosh(math.cos(wide) / math.sqrt(c))))


@pytest.mark.parametrize("T", [3.0, 0.4, 0.0, -0.3, -2.0, None])
def test_full_extension_between_two_radii(T: float | None) -> None:
    """The extremal between them, its waist between the ends, beyond the narrow one, or none at all."""
    narrow, wide = math.radians(62.0), math.radians(25.0)
    for k in (0.01, 0.7) if T is None else (0.0,):
        fibre, length = through(narrow, wide, T, k)
        assert between(narrow, wide, fibre) == pytest.approx(length, rel=1e-11)


def test_full_extension() -> None:
    """Equal radii by either way; of a long muscle; and no state at or beyond it."""
    assert full_extension(R0, H0, THETA0, "clamped", (R0,)) == pytest.approx(longest(mk.presets.paper()), rel=1e-14)
    near = full_extension(R0, H0, THETA0, "clamped", (NARROW, NARROW * (1.0 + 1e-12)))
    assert near == pytest.approx(full_extension(R0, H0, THETA0, "clamped", (NARROW,)), rel=1e-11)
    for radii in ((NARROW,), (NARROW, WIDE)):
        takes = sum(1.0 - math.sin(math.acos(radius / UNIT)) for radius in (radii[0], radii[-1]))
        length = 60 * UNIT
        reached = full_extension(R0, length, THETA0, "clamped", radii)
        assert reached == pytest.approx(length / math.sin(THETA0) - UNIT * takes, rel=1e-12)
    muscle = ended(NARROW, WIDE)
    most = longest(muscle)
    assert mk.solve(muscle, length=0.97 * most, pressure="1 bar").verdict == "stable"
    assert mk.solve(muscle, length=most, pressure="1 bar").verdict == "no equilibrium"


def test_where_a_test_begins(tmp_path: Path) -> None:
    """At the braid's own length, without pressure, where the fittings strain it."""
    muscle = ended(NARROW, WIDE)
    begin = mk.solve(muscle, length=H0, pressure=0.0)
    step = mk.Step(force="to 20 N", pressure="0.5 bar", points=3)
    curve = mk.run(muscle, step)
    assert_allclose(curve.force, [begin.force, 0.5 * (begin.force + 20.0), 20.0], rtol=1e-6)
    assert curve.verdict == ("stable",) * 3
    with pytest.raises(mk.SpecError, match=r"muscle\.end_radii: has no derivatives where the test begins"):
        mk.response(muscle, step)
    mk.save(curve, tmp_path / "curve.nc")
    assert mk.load(tmp_path / "curve.nc") == curve


def test_in_case_files() -> None:
    muscle = ended(NARROW, WIDE)
    assert muscle_from_mapping(to_mapping(muscle)) == muscle
    assert muscle_from_mapping({"preset": "paper", "end_radii": "10 mm"}).end_radii == (NARROW,)
    assert "end_radii" not in to_mapping(STRAIGHT)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (
            {"end_radii": "16 mm"},
            r"end_radii = 16 mm: must be from .* mm to .* mm, beyond which the fibres touch each other",
        ),
        ({"end_radii": ["12 mm", "0.1 mm"]}, r"end_radii = 0\.1 mm: must be from"),
        ({"end_radii": ["9 mm"] * 3}, "must be one or two radii"),
        ({"end_radii": "0 mm"}, "end_radii"),
        ({"end_radii": 10.0}, 'write "10 mm"'),
        ({"end_radii": "10 mm", "ends": "free"}, "which hold no radius"),
        ({"end_radii": "10 mm", "friction": mk.Friction(constant="0.01 N mm")}, "do not go with friction"),
    ],
)
def test_wrong_input(changes: dict[str, Any], said: str) -> None:
    with pytest.raises(mk.SpecError, match=said):
        changed_muscle(mk.presets.paper(), changes)


def test_the_papers_mesh_has_the_radius_of_the_braid() -> None:
    with pytest.raises(mk.SpecError, match="in rigid fittings of its own radius"):
        mk.run(ended(NARROW), mk.Isometric(length="110 mm", pressure="1 bar"), discretisation="paper")


def test_the_error_estimate_knows_of_the_excess_at_the_fittings() -> None:
    """Of a bare braid with a small force, whose conserved quantity is the same to eight digits all the same."""
    fibre = mk.Fibre(diameter="0.46 mm", E="3.2 GPa", nu=0.4, natural="straight", stretch=True)
    braid = mk.Braid(radius="5.76 mm", length="108.56 mm", angle="69.28 deg", fibres=90, fibre=fibre)
    muscle = mk.Muscle(braid=braid, chamber=None, ends="pinned", end_radii="5.965 mm")
    held, bench = Held.of(length=0.105, pressure=0.0), Bench.of(muscle)
    b = bench.placement(held)
    coarse = find(bench.problem(24, b), held)
    fine = refine(coarse, bench.problem(48, b), held)
    off = abs(coarse.force / fine.force - 1.0)
    assert off > 1e-6
    assert off < estimated_error(coarse, held) < 4.0 * off


def test_a_sweep_over_them_is_single_runs() -> None:
    test = mk.Isobaric(pressure="1 bar", length="100 mm to 95 mm", points=2)
    one = mk.presets.paper().replace("end_radii", ["11 mm"])
    found = mk.sweep(one, test, over={"end_radii": ["11 mm", "12 mm"]})
    for row, radius in zip(found.force.values, ("11 mm", "12 mm"), strict=True):
        np.testing.assert_allclose(row, mk.run(one.replace("end_radii", radius), test).force, rtol=1e-8)
    with pytest.raises(mk.SpecError, match=r"end_radii\[0\]: is no field that can be varied; did you mean .end_radii."):
        mk.sweep(one, test, over={"end_radii[0]": ["11 mm", "12 mm"]})


def test_the_end_of_a_path_is_found_past_states_that_are_lost_from_its_last_good_one() -> None:
    """Between two steps to this end the state changes by more than a search from the first of them follows."""
    muscle = mk.presets.paper().replace("end_radii", [R0, NARROW])
    end = mk.limits(muscle, pressure="0.75 bar")
    assert end.shortest_cause.startswith("the tube bulges back behind its fitting")
    held = mk.solve(muscle, length=f"{1.0005 * end.shortest} m", pressure="0.75 bar")
    assert held.verdict == "stable"

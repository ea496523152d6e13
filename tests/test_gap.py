"""A chamber with a gap: a tube that is blown up alone until it touches the braid."""

import warnings
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import mckibben as mk
from mckibben.measure.survey import error_bound, read_states
from mckibben.model.cylinder import cylinder_force
from mckibben.model.energy import lagrangian, stored, works
from mckibben.model.gap import borne, inflated, relaxed_density
from mckibben.model.parameters import Parameters, parameters
from mckibben.model.point import Point
from mckibben.results.result import Result
from mckibben.results.told import columns
from mckibben.solver.bench import Bench
from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.find import equilibrium, find
from mckibben.solver.held import Held
from mckibben.solver.problem import Problem

pytestmark = pytest.mark.effects

C1, OUTER, INNER = 150e3, 20e-3, 18e-3
PAPER = mk.presets.paper()
R0, H0, THETA0 = 12.5e-3, 85e-3, np.radians(37.0)


def made(**more: object) -> mk.Muscle:
    tube = mk.Chamber(outer_diameter=OUTER, inner_diameter=INNER, law=mk.NeoHookean(c1=C1), gap=True)
    muscle = PAPER.replace("chamber", tube)
    for name, value in more.items():
        muscle = muscle.replace(f"chamber.{name}", value)
    return muscle


MUSCLE = made()
TOUCHES = C1 * np.pi * (OUTER**2 - INNER**2) / 4.0 / (np.pi * (OUTER / 2.0) ** 2) * (1.0 - 0.8**4)
"""Pressure at which the thin tube at its own length has the braid's radius as made: P = (c1 A/pi R^2)(1 - (R/r)^4)."""


def thick_tube(hoop: float, axial: float) -> float:
    """Pressure of a neo-Hookean tube in closed form, from the stretches at its outer face as made (theory page)."""
    Ro, Ri = OUTER / 2.0, INNER / 2.0
    ro = hoop * Ro
    ri, k = np.sqrt(ro**2 - (Ro**2 - Ri**2) / axial), axial * ro**2 - Ro**2
    ratio = np.log(Ro * ri / (Ri * ro)) / axial
    return float(2.0 * C1 * (ratio - k / (2.0 * axial**2) * (ro**-2 - ri**-2)))


def blown(theta: float, P: float, p: Parameters) -> float:
    return float(jax.jit(lambda P: inflated(Point.cylinder(theta), P, p).blown)(P))


def test_a_free_thin_tube_in_closed_form() -> None:
    """P = C (1 - (free/H)^4), with C = c1 A/(pi R^2 lambda_z), where free^2 = 1/lambda_z."""
    p = parameters(MUSCLE)
    for theta in (THETA0, 0.8):
        axial, most = np.sin(theta) / np.sin(THETA0), R0 * np.cos(theta) / np.cos(THETA0) / (OUTER / 2.0)
        C = C1 * (OUTER**2 - INNER**2) / OUTER**2 / axial
        for P in (-0.3 * C, 0.0, 0.2 * C, 0.4 * C, 0.58 * C, 0.9 * C, 2.0 * C):
            hoop = axial**-0.5 * (1.0 - min(P / C, 0.999)) ** -0.25
            assert blown(theta, P, p) * R0 / (OUTER / 2.0) == pytest.approx(min(hoop, most), rel=1e-12), (theta, P)


def test_a_free_thick_tube_bears_its_pressure() -> None:
    p, theta = parameters(made(wall="thick")), 0.75
    axial = np.sin(theta) / np.sin(THETA0)
    for P in (-2e3, 4e3, 11e3):
        hoop = blown(theta, P, p) * R0 / (OUTER / 2.0)
        assert thick_tube(hoop, axial) == pytest.approx(P, abs=1e-6)


def test_the_chamber_is_at_its_least() -> None:
    """Of all radii up to the mesh's, none has less energy less the work of the pressure."""
    p, at, P = parameters(MUSCLE), Point(0.75, 0.3, 12.0), 1.0e4

    def potential(hoop: float) -> jnp.ndarray:
        tried = at._replace(blown=hoop)
        return stored(tried, p) - P * works(tried, p)[1]

    found = inflated(at, P, p).blown
    around = jax.jit(jax.vmap(potential))(found * np.array([0.95, 0.999, 1.0, 1.001, 1.05]))
    assert int(np.argmin(around)) == 2
    assert float(around[2]) == pytest.approx(float(lagrangian(at, p, 0.0, P)), rel=1e-13)


def test_derivatives_of_the_least() -> None:
    """First and second ones, free and in touch, by the state, the pressure and the numbers."""
    p = parameters(MUSCLE)

    def density(x: jnp.ndarray) -> jnp.ndarray:
        law = p.law.__class__(c1=C1)
        object.__setattr__(law, "c1", x[3])
        return relaxed_density(Point(x[0], x[1], 0.0), x[2], p._replace(law=law, R0=x[4]))

    def volume(x: jnp.ndarray) -> jnp.ndarray:
        return works(inflated(Point(x[0], x[1], 0.0), x[2], p), p)[1]

    size = np.array([1.0, 1.0, 1e4, C1, R0])
    for function, several in ((density, 5), (volume, 3)):
        scaled = jax.jit(lambda y, function=function: function(y * size) * 1e3)
        slope, bend = jax.jit(jax.grad(scaled)), jax.jit(jax.hessian(scaled))
        for P in (0.6, 4.0):
            y, h = np.array([0.75, 0.3, P, 1.0, 1.0]), 1e-5
            steps = h * np.eye(5)[:several]
            first = [(scaled(y + d) - scaled(y - d)) / (2.0 * h) for d in steps]
            second = [(slope(y + d) - slope(y - d)) / (2.0 * h) for d in steps]
            np.testing.assert_allclose(slope(y)[:several], first, rtol=1e-8, atol=1e-6)
            np.testing.assert_allclose(bend(y)[:several], second, rtol=1e-7, atol=1e-5)


def test_the_braid_bears_nothing_before_it_is_touched() -> None:
    """The cylinder's force is that of the bare braid and of a closed tube on its own, in closed form."""
    p, bare = parameters(MUSCLE), parameters(PAPER.replace("chamber", None))
    theta, P = 0.7, 9e3
    axial, A, R = np.sin(theta) / np.sin(THETA0), np.pi * (OUTER**2 - INNER**2) / 4.0, OUTER / 2.0
    C = C1 * A / (np.pi * R**2) / axial
    hoop = axial**-0.5 * (1.0 - P / C) ** -0.25
    assert hoop * R < R0 * np.cos(theta) / np.cos(THETA0)
    tube = A * 2.0 * C1 * (axial - hoop**-2 * axial**-3) - P * np.pi * (hoop * R) ** 2
    expected = float(cylinder_force(theta, 0.0, bare)) + tube
    assert float(cylinder_force(theta, P, p)) == pytest.approx(expected, rel=1e-12)


def test_refusals() -> None:
    for wall in ({"thickness": "1 mm"}, {"thickness": "1 mm", "lies": "outside"}):
        with pytest.raises(mk.SpecError, match="needs a chamber inside the braid"):
            mk.Chamber(law=mk.NeoHookean(c1=C1), gap=True, **wall)
    with pytest.raises(mk.SpecError, match="must be at most 25 mm, twice the radius of the braid"):
        made(outer_diameter="26 mm")
    soft = made(inner_diameter="10 mm", outer_diameter="12 mm", law=mk.Ogden(mu=["200 kPa"], alpha=[1.3]))
    with pytest.raises(mk.SpecError, match=r"bears 0\.\d+ bar at most before it touches .* and jumps from there"):
        mk.solve(soft, length="85 mm", pressure="0.1 bar")
    with pytest.raises(mk.SpecError, match="there is no dead zone to find"):
        mk.dead_zone(made(gap=False), length="85 mm")


@pytest.mark.parametrize("wall", ["thin", "thick"])
def test_a_law_that_softens_is_found(wall: str) -> None:
    """And one that does not is not: of neo-Hookean rubber every tube bears the more the wider it is."""
    p = parameters(made(wall=wall))
    hoops = jnp.linspace(0.85, 3.0, 200)
    assert (np.diff(jax.jit(jax.vmap(lambda hoop: borne(hoop, 1.2, p)))(hoops)) > 0.0).all()


CURVE = mk.Isometric(length="95 mm", pressure="0 to 0.24 bar", points=7)


@pytest.fixture(scope="module")
def curve() -> Result:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mk.MuscleWarning)
        return mk.run(MUSCLE, CURVE)


@pytest.mark.experiments
def test_contact_grows_to_all_of_the_length(curve: Result, tmp_path: Path) -> None:
    contact, gap, pressed = (curve.data[name].values for name in ("contact", "gap", "contact_pressure"))
    assert contact[:4].tolist() == [0.0] * 4
    assert 0.5 < contact[4] < 1.0
    assert contact[5:].tolist() == [1.0, 1.0]
    assert (gap[:4] > 0.0).all()
    assert (gap[5:] == 0.0).all()
    assert ((gap > 0.0) ^ (pressed > 0.0)).all()
    assert set(curve.verdict) == {"stable"}
    assert not any("dead zone" in note for note in curve.cautions)
    assert "contact" in [name for name, _, _ in columns(MUSCLE)]
    assert mk.load(mk.save(curve, tmp_path / "curve.nc")) == curve
    head = mk.save(curve, tmp_path / "curve.csv").read_text().splitlines()[0]
    assert ",contact," in head
    np.testing.assert_allclose(curve.data["air_volume"], curve.volume - np.pi * (1e-4 - 8.1e-5) * H0, rtol=1e-13)
    assert "contact" not in mk.solve(PAPER, length="95 mm", pressure="0.5 bar").data


@pytest.mark.experiments
def test_in_touch_it_is_the_chamber_that_is_held(curve: Result) -> None:
    bench = Bench.of(MUSCLE)
    target = Held.of(length=95e-3, pressure=0.24e5)
    found = find(bench.problem(48, bench.placement(target)), target)
    assert curve.force[-1] == pytest.approx(found.force, rel=1e-8)
    held = Problem.of(found.problem.basis, parameters(made(gap=False)), found.problem.b)
    state = equilibrium(held, found.u, found.loads)
    assert state.residual < 1e-12
    np.testing.assert_allclose(state.totals, found.totals, rtol=1e-13, atol=1e-13)


@pytest.mark.experiments
def test_work_is_what_is_stored(curve: Result) -> None:
    """On the part without touch, where nothing has a kink."""
    fine = mk.run(MUSCLE, mk.Isometric(length="95 mm", pressure="0 to 0.12 bar", points=13))
    gained = fine.data["energy"].values - fine.data["energy"].values[0]
    assert float(fine.data["work"][-1]) == pytest.approx(gained[-1], rel=1e-6)


@pytest.mark.experiments
def test_a_held_volume_gives_the_same_states(curve: Result) -> None:
    k = [1, 3, 4, 6]
    volumes = [f"{value!r} m^3" for value in curve.volume[k].tolist()]
    again = mk.run(MUSCLE, mk.Step(length="95 mm", volume=volumes))
    # where it touches in part, the kink lies between two points, and the volume is less sure than the force
    for rows, close in (([0, 1, 3], 1e-9), ([2], 1e-4)):
        np.testing.assert_allclose(again.pressure[rows], curve.pressure[k][rows], rtol=close)
        np.testing.assert_allclose(again.force[rows], curve.force[k][rows], rtol=close)
    assert 1e-6 < float(again.data["error_estimate"][2]) < 1e-4
    assert float(again.data["error_estimate"][[0, 1, 3]].max()) < 1e-7
    assert set(again.verdict) == {"stable"}


@pytest.mark.experiments
def test_the_estimate_knows_the_kink(curve: Result) -> None:
    """Where touch begins between two points the error is of second order, and far above that of the series."""
    P, bench = 0.145e5, Bench.of(MUSCLE)
    held = Held.of(length=95e-3, pressure=P)
    b = bench.placement(held)
    coarse, fine = (find(bench.problem(size, b), held) for size in (24, 48))
    full = np.pi * R0**2 * P
    off = abs(coarse.force - fine.force) / (abs(fine.force) + full)
    assert 100.0 * errors_of(coarse, held, kinks=False) < off < errors_of(coarse, held) < 10.0 * off
    volume = Held.of(length=95e-3, volume=fine.volume)
    other = find(coarse.problem, volume, coarse)
    off = abs(other.pressure / P - 1.0)
    assert off < errors_of(other, volume) < 10.0 * off
    assert errors_of(other, volume) > errors_of(other, held)


def errors_of(state: Equilibrium, held: Held, kinks: bool = True) -> float:
    seen = read_states(state.problem, state.u[None], state.loads[None], False)[0]
    assert seen.missed is not None
    more = seen.missed.under(held.names) if kinks else 0.0
    return float(error_bound(seen.conserved_variation, seen.coefficient_tail, kinks=more)[0])


@pytest.mark.experiments
def test_sealed_gas_has_the_volume_of_the_air(curve: Result) -> None:
    """Beside rubber: (P + 1 atm) V of the air stays, as the tube swells in the gap and in touch."""
    filled = mk.Step(length="95 mm", pressure="0 to 0.24 bar", points=7)
    sealed = mk.Step(length="95 mm to 90 mm", gas="isothermal", points=7)
    # no more unknowns than the volume of its gas asks for: one state on the way touches in part
    after = mk.run(MUSCLE, mk.Protocol([filled, sealed]), tolerance=1e-5).data.isel(step=slice(7, None))
    amount = (after["pressure"] + 101325.0) * after["air_volume"]
    np.testing.assert_allclose(amount, float(amount[0]), rtol=1e-6)
    assert float(after["pressure"].max() - after["pressure"].min()) > 300.0


@pytest.mark.experiments
def test_dead_zone_in_closed_form() -> None:
    """At its length as made the braid is a cylinder: the tube comes to touch it at one pressure."""
    found = mk.dead_zone(MUSCLE, length="85 mm")
    assert found.begins == pytest.approx(TOUCHES, rel=1e-8)
    assert found.ends == pytest.approx(TOUCHES, rel=1e-8)
    tube = np.pi * (1e-4 - 8.1e-5) * 2.0 * C1 * (1.0 - 0.8**2) - TOUCHES * np.pi * R0**2
    assert found.force == pytest.approx(tube, rel=1e-6)
    with pytest.warns(mk.MuscleWarning, match="the fibres are straight"):
        assert np.isnan(mk.dead_zone(MUSCLE, length="130 mm").ends)


def by_elements(length: float, pressures: list[float], n: int) -> list[tuple[float, float]]:
    """Forces [N] and shares in touch by straight elements for the slope on half the length, with none of the package.

    The radius of the tube is put in by its closed form.
    """
    N, B, B3, a = (
        56,
        3e9 * np.pi * 0.25e-3**4 / 64.0,
        3e9 / 2.8 * np.pi * 0.25e-3**4 / 32.0,
        1.0 / (R0 * np.tan(THETA0)),
    )
    A, R = np.pi * (OUTER**2 - INNER**2) / 4.0, OUTER / 2.0
    t = np.linspace(0.0, 1.0, n + 1)
    v = H0 / 2.0 * t**2  # fine where the fibres leave the fitting
    dv, points = np.diff(v), np.array([0.5 - 0.5 / 3**0.5, 0.5 + 0.5 / 3**0.5])

    def fields(psi: jnp.ndarray) -> tuple[jnp.ndarray, ...]:
        ends = jnp.concatenate([jnp.zeros(1), psi, jnp.zeros(1)])
        first, last = ends[:-1], ends[1:]
        inner = first[:, None] + (last - first)[:, None] * points
        third = first[:, None] + (last - first)[:, None] * points[None] * 0.5  # midpoint of the way to each point
        whole = dv * (jnp.sin(first) + 4.0 * jnp.sin(0.5 * (first + last)) + jnp.sin(last)) / 6.0
        before = jnp.concatenate([jnp.zeros(1), jnp.cumsum(whole)[:-1]])
        part = dv[:, None] * points * (jnp.sin(first)[:, None] + 4.0 * jnp.sin(third) + jnp.sin(inner)) / 6.0
        theta = THETA0 - a * (before[:, None] + part)
        return theta, inner, jnp.broadcast_to(((last - first) / dv)[:, None], theta.shape)

    def hoops(theta: jnp.ndarray, psi: jnp.ndarray, P: float) -> tuple[jnp.ndarray, ...]:
        r, s = R0 * jnp.cos(theta) / np.cos(THETA0), jnp.sin(theta) / np.sin(THETA0)
        C = C1 * A / (np.pi * R**2) / s
        free = s**-0.5 * (1.0 - jnp.minimum(P * jnp.cos(psi) / C, 0.999)) ** -0.25
        return r, s, jnp.minimum(free, r / R)

    def totals(psi: jnp.ndarray, P: float) -> jnp.ndarray:
        theta, psi, kappa = fields(psi)
        _, s, hoop = hoops(theta, psi, P)
        c, d = np.cos(THETA0), np.sin(THETA0)
        u1 = -2.0 * c * jnp.sin(psi) / R0
        u2 = -c / R0 * jnp.cos(theta) * jnp.cos(psi) + d * jnp.sin(theta) * kappa + c**2 / R0
        u3 = c / R0 * jnp.sin(theta) * jnp.cos(psi) + d * jnp.cos(theta) * kappa - c * d / R0
        fibres = N / (2.0 * d) * (B * u1**2 + B * u2**2 + B3 * u3**2)
        tube = A * C1 * (hoop**2 + s**2 + 1.0 / (hoop * s) ** 2 - 3.0)
        work = P * np.pi * (hoop * R) ** 2 * s * jnp.cos(psi)
        half = jnp.stack([(dv @ (fibres + tube - work)).sum(), (dv @ (s * jnp.cos(psi))).sum()])
        return half * jnp.array([0.5, 1.0])  # the length is that of both halves

    def residual(x: jnp.ndarray, target: float, P: float) -> jnp.ndarray:
        slopes = jax.jacrev(totals)(x[:-1], P)
        balance = slopes[0] - 0.5 * x[-1] * slopes[1]
        return jnp.concatenate([1e3 * balance, (totals(x[:-1], P)[1:] - target) / H0])

    equations, tangent = jax.jit(residual), jax.jit(jax.jacfwd(residual))
    found = []
    for P in pressures:
        x = np.zeros(n)
        for target in np.linspace(H0, length, 5)[1:]:
            for _ in range(20):
                step = np.linalg.solve(tangent(x, target, P), equations(x, target, P))
                share = min(1.0, 0.1 / np.abs(step[:-1]).max())
                x = np.append(x[:-1] - share * step[:-1], x[-1] - step[-1])
                if np.abs(step).max() < 1e-9:
                    break
        assert np.abs(equations(x, length, P)).max() < 1e-10
        theta, psi, _ = fields(x[:-1])
        r, _, hoop = hoops(theta, psi, P)
        found.append((float(x[-1]), float(dv @ np.asarray(hoop >= r / R, float).mean(axis=1) / (H0 / 2.0))))
    return found


@pytest.mark.experiments
def test_against_elements(curve: Result) -> None:
    """An independent discretisation, free and partly in touch."""
    some = [2, 4]
    for k, (force, contact) in zip(some, by_elements(95e-3, curve.pressure[some].tolist(), 40), strict=True):
        assert curve.force[k] == pytest.approx(force, rel=1.5e-4)  # of second order: 7e-6 with 160 elements
        assert float(curve.data["contact"][k]) == pytest.approx(contact, abs=0.03)

"""Derivatives of motions: against closed forms, and against differences of what `simulate` gives.

The maps are polynomials that the series of a map hold exactly: a vessel, and the textbook cylinder beside a spring.
"""

import json
import math
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any

import attrs
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.polynomial import chebyshev

import mckibben as mk
from mckibben.motion.flow import GAS, RHO, TEMPERATURE
from mckibben.motion.kinks import flows_of
from mckibben.motion.plant import Plant
from mckibben.motion.regime import FIRST, PER, Mode, Regime
from mckibben.motion.start import state_of
from mckibben.motiongradients.traced import TracedMap, TracedMode, TracedRegime
from mckibben.potential.evaluate import ORDERS, Table, in_blocks
from mckibben.potential.scalar import scalar

pytestmark = pytest.mark.motion

M = mk.presets.paper()
LENGTHS, PRESSURES, SOFT = (0.05, 0.15), (-5e4, 2e6), 1e3


@attrs.frozen(eq=False)
class Exact:
    """A map from its potential W(h, P), a polynomial of degree 4 in h and 1 in P."""

    table: Table

    @classmethod
    def of(cls, potential: Callable[[Any, Any], Any]) -> "Exact":
        first, last = PRESSURES
        ends = [math.sqrt(SOFT), math.sqrt(last - first + SOFT)]
        (h0, h1), (q0, q1) = ((0.5 * sum(pair), 0.5 * (pair[1] - pair[0])) for pair in (LENGTHS, ends))
        n, m = 5, 3
        x, y = (np.cos(np.pi * (np.arange(k) + 0.5) / k) for k in (n, m))
        W = potential(h0 + h1 * x[:, None], (q0 + q1 * y[None, :]) ** 2 + first - SOFT)
        c = np.linalg.solve(chebyshev.chebvander(x, n - 1), W)
        c = np.linalg.solve(chebyshev.chebvander(y, m - 1), c.T).T
        series = np.zeros((len(ORDERS), n, m))
        for k, (i, j) in enumerate(ORDERS):
            one = chebyshev.chebder(chebyshev.chebder(c, i, axis=0), j, axis=1) / (h1**i * q1**j)
            series[k, : one.shape[0], : one.shape[1]] = one
        low, high = (np.array([[end, 0.0]]) for end in LENGTHS)
        return cls(Table(series, np.array([h0, h1]), np.float64(first), np.float64(last), np.float64(SOFT),
                         np.array([q0, q1]), low, high, np.float64(1e-3), np.zeros((2, 2)), np.zeros((2, 2)),
                         np.float64(0.0)))  # fmt: skip

    @property
    def at(self) -> Any:
        return scalar(self.table)

    @property
    def pressures(self) -> tuple[float, float]:
        return PRESSURES

    def lengths(self, pressure: Any) -> tuple[Any, Any]:
        return LENGTHS

    def air_volume(self, h: Any, P: Any) -> Any:
        return in_blocks(self.table, h, P).volume


@attrs.frozen(eq=False)
class Quick(Exact):
    """The same, whose function for one point is made once."""

    at: Any = attrs.field(init=False)

    def __attrs_post_init__(self) -> None:
        object.__setattr__(self, "at", scalar(self.table))


@cache
def cylinder(k: float = 100.0, rest: float = 0.1, b: float = 0.16, n: float = 1.2) -> Exact:
    c = 1.0 / (4.0 * math.pi * n**2)
    return Quick.of(lambda h, P: 0.5 * k * (h - rest) ** 2 - P * c * h * (b * b - h * h))


SIZE = 5e-5
VESSEL = Quick.of(lambda h, P: -P * SIZE + 0.0 * h)
VALVE = mk.Valve(C="0.05 L/s/bar", b=0.3)
PARTS: Mapping[str, Any] = {"muscle": M, "supply": mk.Supply(gauge="6 bar"), "valve": VALVE}
RIGS = {
    "held": (mk.Rig(
        load=mk.FixedEnd(length="100 mm"), command=mk.Sine(0.8, frequency=2.0, phase=0.1), tube="5 mL", pressure=2e4,
        air=mk.WallHeat(conductance=0.1), **PARTS,
    ), 0.6),
    "line": (mk.Rig(
        load=mk.Load(mass="5 kg", damping="20 N s/m", push=mk.Ramp("9 N", begin="1 N", start="0.1 s", stop="0.33 s"),
                     spring=50.0),
        command=mk.Series(time=[0.0, 0.11, 0.23, 0.7], value=[0.01, 1.0, -0.4, 0.3]), air=mk.Polytropic(n=1.2),
        pressure=1e5, viscosity=mk.Viscosity(damping=30.0, stiffness=400.0), **PARTS,
    ), 0.6),
    "pulses": (mk.Rig(
        load=mk.Load(mass="5 kg", damping="20 N s/m", friction=4.0, stop_low=0.07, stop_high=0.1, start=0.091),
        command=mk.PWM(mk.Ramp(0.6, begin=0.5), frequency=2.3), pressure=1e5, **PARTS,
    ), 0.9),
    "slack": (mk.Rig(
        load=mk.Load(mass="1 kg", damping="2 N s/m", slack=True, push=mk.Series(
            time=[0.0, 0.213, 0.3331, 2.0], value=[0.5, -12.0, 5.0, 5.0], between="hold")),
        pressure=5e4, command=mk.Jump(0.3, before=0.1, at=0.107),
        viscosity=mk.Viscosity(damping=20.0, stiffness=400.0), **PARTS,
    ), 0.6),
    "pair": (mk.Rig(
        antagonist=M, pressure=1.5e5, **{**PARTS, "valve": attrs.evolve(VALVE, delay=0.011)},
        load=mk.Pulley(radius="20 mm", inertia="1e-3 kg m^2", damping="0.05 N m s", length="95 mm", friction=0.01),
        command=mk.PID(of="angle", target=mk.Jump("10 deg", at="0.093 s"), kp=3.0, ki=5.0, kd=0.1, every=0.02,
                       filter=0.01),
    ), 0.4),
}  # fmt: skip
RIGS["turning"] = (attrs.evolve(RIGS["pulses"][0], pressure=5e5), 0.9)
HAPPENS = {
    "turning": {"turned round", "came to rest: friction holds", "friction gave way"},
    "pulses": {
        "reached the high end stop",
        "left the high end stop",
        "came to rest: friction holds",
        "friction gave way",
    },
    "slack": {"the muscle went slack", "the muscle pulls again"},
    "pair": {"friction gave way"},
}
POINTS = 30  # so that no time of the answer is that of a jump, where derivatives have two sides
SEEN = ("length", "speed", "force", "pressure", "temperature", "mass", "inflow", "consumed", "heat", "work")


NUMBERS = {
    "held": ("valve.C", "supply.gauge", "command.frequency", "air.conductance", "tube"),
    "line": (
        "load.mass",
        "load.damping",
        "load.push.stop",
        "command.value[1]",
        "command.time[1]",
        "viscosity.stiffness",
    ),
    "pulses": ("load.friction", "load.stop_high", "command.duty.to", "command.frequency", "valve.C"),
    "turning": ("load.start", "load.friction", "pressure"),
    "slack": ("load.push.value[1]", "load.push.time[1]", "valve.b", "viscosity.damping"),
    "pair": ("command.kp", "command.kd", "valve.delay", "load.inertia", "atmosphere"),
}


def putter(rig: mk.Rig, names: Sequence[str]) -> tuple[list[float], Callable[[Any], mk.Rig]]:
    """Some numbers of a rig, and the function that puts others in their place."""
    leaves, tree = jax.tree.flatten(rig)
    all_names = [jax.tree_util.keystr(path)[1:] for path, _ in jax.tree_util.tree_flatten_with_path(rig)[0]]
    places = [all_names.index(name) for name in names]

    def put(some: Any) -> mk.Rig:
        new = [some[places.index(k)] if k in places else leaf for k, leaf in enumerate(leaves)]
        return jax.tree.unflatten(tree, new)

    return [leaves[k] for k in places], put


@pytest.mark.parametrize("name", RIGS)
def test_values_and_derivatives_are_those_of_simulate(name: str) -> None:
    """Derivatives to 1e-4 of the largest over time, beside what differences of values good to 5e-11 can tell."""
    rig, until = RIGS[name]
    at, put = putter(rig, NUMBERS[name])

    def seen(some: Any) -> Any:
        found = mk.motion_response(put(some), until, chart=cylinder(), points=POINTS, tolerance=1e-8)
        picked = {name: found[name] for name in SEEN}
        return picked, picked

    def told(some: list[float], tolerance: float = 1e-12, method: str = "DOP853") -> Any:
        return mk.simulate(put(some), until, chart=cylinder(), points=POINTS, tolerance=tolerance, method=method)

    slopes, values = jax.jacfwd(seen, has_aux=True)(jnp.array(at))
    motion = told(at, 1e-8, "RK45")
    assert {what for _, what in json.loads(motion.data.attrs["events"])} == HAPPENS.get(name, set())
    for one in SEEN:
        right = motion.of(one)
        np.testing.assert_allclose(values[one], right, rtol=1e-5, atol=1e-6 * np.abs(right).max(), err_msg=one)
    for k, named in enumerate(NUMBERS[name]):
        step = 2e-5 * abs(at[k])
        up, down = (told([*at[:k], at[k] + sign * step, *at[k + 1 :]]) for sign in (1.0, -1.0))
        for one in SEEN:
            slope = (up.of(one) - down.of(one)) / (2.0 * step)
            off = np.abs(np.asarray(slopes[one])[..., k] - slope).max()
            assert off <= 1e-4 * np.abs(slope).max() + 5e-11 * np.abs(up.of(one)).max() / step, (named, one)


HELD = mk.Rig(load=mk.FixedEnd(length="100 mm"), pressure="5 bar", command=mk.Jump(-1.0, at="0.1 s"), **PARTS)


def test_a_vessel_that_empties_while_choked() -> None:
    """p = p0 exp(-k C (t - a)): its derivatives by C, by the time a of the jump, and by C twice."""
    k = RHO * math.sqrt(TEMPERATURE / HELD.temperature) * GAS * HELD.temperature / SIZE

    def last(some: Any) -> Any:
        C, at = some
        rig = attrs.evolve(HELD, valve=mk.Valve(C=C, b=0.3), command=mk.Jump(-1.0, at=at))
        return mk.motion_response(rig, "0.25 s", chart=VESSEL, points=2, tolerance=1e-9)["pressure_absolute"][-1]

    C, at = VALVE.C, 0.1
    p = (5e5 + HELD.atmosphere) * math.exp(-k * C * 0.15)
    assert float(last((C, at))) == pytest.approx(p, rel=1e-8)
    by_valve, by_time = jax.grad(last)((C, at))
    assert float(by_valve) == pytest.approx(-k * 0.15 * p, rel=1e-7)
    assert float(by_time) == pytest.approx(k * C * p, rel=1e-7)
    twice = jax.jacfwd(jax.jacfwd(lambda C: last((C, at))))(C)
    assert float(twice) == pytest.approx((k * 0.15) ** 2 * p, rel=1e-7)


def test_a_mass_on_a_spring_by_its_damping() -> None:
    """x = exp(-d t) (cos w t + (d / w) sin w t) from rest, d = c / 2 m, w^2 = k / m - d^2: its slope by differences."""
    m, k, t = 2.0, 800.0, np.linspace(0.0, 0.5, 11)
    rig = mk.Rig(load=mk.Load(mass=m, gravity=0.0, spring=k, spring_at=0.1, start=0.11), **PARTS)

    def length(c: Any) -> Any:
        put = attrs.evolve(rig, load=attrs.evolve(rig.load, damping=c))
        return mk.motion_response(put, "0.5 s", chart=VESSEL, points=11, tolerance=1e-10)["length"]

    def exact(c: float) -> np.ndarray:
        d = 0.5 * c / m
        w = math.sqrt(k / m - d * d)
        return 0.1 + 0.01 * np.exp(-d * t) * (np.cos(w * t) + d / w * np.sin(w * t))

    slope = jax.jacfwd(length)(6.0)
    np.testing.assert_allclose(length(6.0), exact(6.0), atol=1e-11)
    np.testing.assert_allclose(slope, (exact(6.001) - exact(5.999)) / 0.002, atol=1e-10)


def test_a_stop_that_a_constant_push_reaches() -> None:
    """All work of the push up to the stop is lost there, and the mass stays at it."""
    rig = mk.Rig(load=mk.Load(mass=2.0, gravity=0.0, push=3.0, start=0.1, stop_high=0.12), **PARTS)

    def last(some: Any) -> Any:
        push, stop = some
        put = attrs.evolve(rig, load=attrs.evolve(rig.load, push=push, stop_high=stop))
        found = mk.motion_response(put, "0.3 s", chart=VESSEL, points=4)
        return jnp.stack([found[name][-1] for name in ("length", "lost", "speed")])

    slopes = np.array(jax.jacfwd(last)(jnp.array([3.0, 0.12])))
    np.testing.assert_allclose(last((3.0, 0.12)), [0.12, 0.06, 0.0], atol=1e-9)
    np.testing.assert_allclose(slopes, [[0.0, 1.0], [0.02, 3.0], [0.0, 0.0]], atol=1e-8)


def test_gradient_of_a_rig_and_inside_jit_and_vmap() -> None:
    """The same everywhere; by a muscle whose map is held, and by a friction of 0, it is not finite."""
    rig = mk.Rig(load=mk.Load(mass="5 kg", damping="20 N s/m"), pressure=1e5, command=1.0, **PARTS)

    def last(rig: mk.Rig) -> Any:
        return mk.motion_response(rig, "0.1 s", chart=cylinder(), points=3)["length"][-1]

    slope = jax.grad(last)(rig)
    assert isinstance(slope, mk.Rig)
    assert all(np.isinf(leaf) for leaf in jax.tree.leaves((slope.muscle, slope.load.friction)))
    assert 0.0 != float(slope.valve.C) < math.inf

    def by_valve(C: Any) -> Any:
        return last(attrs.evolve(rig, valve=mk.Valve(C=C, b=0.3)))

    value, slope_inside = jax.jit(jax.value_and_grad(by_valve))(VALVE.C)
    assert float(value) == pytest.approx(float(last(rig)), rel=1e-12)
    assert float(slope_inside) == pytest.approx(float(slope.valve.C), rel=1e-9)
    several = jax.vmap(by_valve)(jnp.array([VALVE.C, 2.0 * VALVE.C]))
    assert float(several[0]) == pytest.approx(float(value), rel=1e-12)
    assert float(several[1]) < float(several[0])
    small = jax.jit(
        lambda C: mk.motion_response(attrs.evolve(rig, valve=mk.Valve(C=C)), 0.1, chart=cylinder(), room=64)
    )
    with pytest.raises(Exception, match="room"):
        jax.block_until_ready(small(VALVE.C))


@pytest.mark.parametrize("name", ["line", "pulses", "pair"])
def test_the_equations_are_those_of_floats(name: str) -> None:
    """At random states: selection chooses what `if` chooses."""
    rig, chart, rng = RIGS[name][0], cylinder(), np.random.default_rng(1)
    plant = Plant.of(rig, [chart] * len(rig.muscles))
    traced = attrs.evolve(plant, ats=[TracedMap(chart.table, 0.0).at] * plant.n)
    for u in (0.7, -0.4):
        for p in (9e4, 1.02e5, 3e5, 7.01e5, 8e5):
            y = state_of(plant, 0.02 if rig.turns else 0.09)
            y[1] = rng.normal()
            for k in range(plant.n):
                at = FIRST + PER * k
                y[at : at + 4] = [p, 280.0 + 20.0 * rng.random(), y[at + 2], rng.normal()]
            commands = [lambda t, u=u: u, lambda t, u=u: -u][: plant.n]
            plain = Regime(plant, Mode("free", 1.0 if y[1] > 0.0 else -1.0), commands)
            mode = TracedMode(True, 0.0, plain.mode.sliding, (False,) * plant.n, flows_of(plain, 0.0, y))
            other = TracedRegime(plant=traced, mode=mode, commands=commands, outer=plant.outer)
            right, found = plain.rates(0.0, y), other.rates(0.0, [jnp.asarray(one) for one in y])
            np.testing.assert_allclose([float(one) for one in found.state], right.state, rtol=1e-11, atol=1e-12)


RUBS = mk.Friction(coefficient=0.2, arm="0.05 mm")


@pytest.mark.parametrize(
    ("field", "rig", "options"),
    [
        ("rig.command", attrs.evolve(HELD, command=mk.Controller(lambda t, seen: 0.0)), {}),
        ("muscle.friction", attrs.evolve(HELD, muscle=M.replace("friction", RUBS)), {}),
        ("simulate.chart", HELD, {"chart": attrs.evolve}),
        ("motion_response.points", HELD, {"points": 1}),
        ("motion_response.tolerance", HELD, {"tolerance": 0.1}),
        ("motion_response.room", HELD, {"room": 3}),
        ("fixed.length", attrs.evolve(HELD, load=mk.FixedEnd(length="400 mm")), {}),
    ],
)  # fmt: skip
def test_what_is_refused(field: str, rig: Any, options: dict[str, Any]) -> None:
    with pytest.raises(mk.SpecError) as caught:
        mk.motion_response(rig, "0.1 s", **{"chart": VESSEL, **options})
    assert caught.value.field == field


def test_a_map_is_wanted_where_none_can_be_made() -> None:
    with pytest.raises(mk.SpecError, match="make it before"):
        jax.jit(lambda rig: mk.motion_response(rig, "0.1 s")["time"])(HELD)

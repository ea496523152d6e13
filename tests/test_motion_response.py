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

    def told(some: list[float], tolerance: float = 1e-11, method: str = "DOP853") -> Any:
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

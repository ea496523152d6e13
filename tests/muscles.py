"""Muscles that the tests share: the reference muscle, and plausible ones drawn by hypothesis."""

import math
from typing import NamedTuple

import numpy as np
from hypothesis import strategies as st

from mckibben import spec
from mckibben.model.parameters import Parameters, parameters
from mckibben.spec import presets

MAGIC = math.atan(math.sqrt(0.5))
"""The magic angle [rad], from the parallels."""


def reference() -> Parameters:
    """Numbers in SI of the muscle of the theory page's reference values."""
    return parameters(presets.reference())


class Drawn(NamedTuple):
    """A muscle as numbers in SI. It is made inside the test: hypothesis refuses strategies that use `random`, and the
    run-time type checks do."""

    R0: float
    H0: float
    theta0: float
    N: int
    d: float
    E: float
    nu: float
    t0: float
    c1: float
    c2: float
    ends: str

    def muscle(self) -> spec.Muscle:
        fibre = spec.Fibre(diameter=self.d, E=self.E, nu=self.nu)
        return spec.Muscle(
            braid=spec.Braid(radius=self.R0, length=self.H0, angle=self.theta0, fibres=self.N, fibre=fibre),
            chamber=spec.Chamber(thickness=self.t0, law=spec.MooneyRivlin(c1=self.c1, c2=self.c2)),
            ends=self.ends,
        )

    def parameters(self) -> Parameters:
        """Numbers of the muscle, with a Mooney-Rivlin chamber."""
        return parameters(self.muscle())


def between(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_subnormal=False)


@st.composite
def muscles(draw: st.DrawFn, ends: tuple[str, ...] = ("clamped", "pinned")) -> Drawn:
    """Plausible muscles with a Mooney-Rivlin chamber, whose fibres fit side by side."""
    R0, theta0, N = draw(between(5e-3, 30e-3)), math.radians(draw(between(20.0, 70.0))), 2 * draw(st.integers(4, 48))
    room = 2.0 * math.pi * R0 * math.sin(theta0) / (N // 2)
    c1 = draw(between(0.02e6, 1e6))
    return Drawn(
        R0, draw(between(2.0, 20.0)) * R0, theta0, N,
        d=draw(between(1e-4, min(1e-3, 0.99 * room))), E=draw(between(0.5e9, 100e9)), nu=draw(between(0.0, 0.5)),
        t0=draw(between(0.3e-3, 3e-3)), c1=c1, c2=c1 * draw(between(0.0, 0.5)), ends=draw(st.sampled_from(ends)),
    )  # fmt: skip


def seeded(seed: int, ends: str = "clamped") -> Drawn:
    """A plausible muscle by a number, for tests that solve: as `muscles`, without the extremes of every range."""
    random = np.random.default_rng(seed)
    R0, theta0, N = (
        random.uniform(5e-3, 20e-3),
        math.radians(random.uniform(25.0, 65.0)),
        2 * int(random.integers(8, 40)),
    )
    room = 2.0 * math.pi * R0 * math.sin(theta0) / (N // 2)
    return Drawn(
        R0, random.uniform(4.0, 15.0) * R0, theta0, N,
        d=min(random.uniform(1e-4, 5e-4), 0.9 * room), E=10 ** random.uniform(8.7, 10.5), nu=random.uniform(0.1, 0.45),
        t0=random.uniform(0.5e-3, 2e-3), c1=10 ** random.uniform(4.0, 5.5), c2=10 ** random.uniform(3.0, 4.0),
        ends=ends,
    )  # fmt: skip


def scaled(p: Parameters, factor: float) -> Parameters:
    """The muscle with all stored energy multiplied by a factor: 0 leaves inextensible fibres and nothing else."""
    return p._replace(B1=factor * p.B1, B2=factor * p.B2, B3=factor * p.B3, A0=factor * p.A0)

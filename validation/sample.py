"""Random muscles and targets, the same ones on every machine: case k is drawn from the sample's seed and k alone.

Ranges: theta0 20-70 deg, H0/R0 2-20, R0 5-25 mm, N 8-96 even, d 0.1-1 mm, E 0.5-100 GPa, nu 0.4, chamber c1 0.02-1 MPa,
c2 up to c1/2, wall 0.3-3 mm, P 0-0.6 MPa (one in ten without pressure); log-uniform where a range spans a decade or
more. Muscles whose fibres do not fit side by side are drawn again. Even cases are clamped, odd ones pinned.
"""

import math
from typing import Any

import attrs
import numpy as np

import mckibben as mk
from mckibben.model.cylinder import cylinder_angle, cylinder_force
from mckibben.model.extension import full_extension
from mckibben.model.parameters import parameters

Case = dict[str, Any]


@attrs.frozen(eq=False)
class Sample:
    """Muscles with one target each."""

    name: str
    title: str
    seed: int
    count: int
    shares: dict[str, float]  #: of the kinds of target
    said: str  #: what the kinds are


FIRST = Sample(
    "first", "First sample: targets of every day", 20230403, 1000,
    {"length": 0.65, "free contraction": 0.15, "isotonic": 0.2},
    "A length lies between 0.6 H0 and 0.999 of full extension; isotonic is the force of a cylinder between 0.8 H0 and "
    "0.95 of full extension.",
)  # fmt: skip
SECOND = Sample(
    "second", "Second sample: targets at the edge", 20261124, 300,
    {"short": 0.3, "stretched": 0.45, "large force": 0.25},
    "Short is a length of 0.3 to 0.65 H0; stretched one that is short of full extension by 10^-2 to 10^-4 of it. The "
    "forces of a cylinder between 0.8 H0 and 0.95 of full extension make the ordinary range; a large force lies beyond "
    "it, above or below, by up to five times its width. Many of these have no state.",
)  # fmt: skip
SAMPLES = (FIRST, SECOND)


def draw(k: int, sample: Sample = FIRST) -> Case:
    """Case k as plain numbers in SI units."""
    rng = np.random.default_rng((sample.seed, k))
    case = draw_muscle(k, rng)
    pressure = 0.0 if rng.random() < 0.1 else float(rng.uniform(0.0, 0.6e6))
    kind = str(rng.choice(list(sample.shares), p=list(sample.shares.values())))
    x = float(rng.random())
    case |= {"kind": kind}
    return case | {"held": target(case, x, pressure)}


def draw_muscle(k: int, rng: np.random.Generator) -> Case:
    """The muscle of case k."""
    m, ends = _fitting(rng), ("clamped", "pinned")[k % 2]
    return {"id": k, "ends": ends, "muscle": m, "longest": full_extension(m["R0"], m["H0"], m["theta0"], ends)}


def target(case: Case, x: float, pressure: float) -> dict[str, float]:
    """What is held of a muscle for a kind of target; x from 0 to 1."""
    H0, longest = case["muscle"]["H0"], case["longest"]
    match case["kind"]:
        case "length":
            return {"length": _between(x, 0.6 * H0, 0.999 * longest), "pressure": pressure}
        case "short":
            return {"length": _between(x, 0.3 * H0, 0.65 * H0), "pressure": pressure}
        case "stretched":
            return {"length": (1.0 - 10.0 ** _between(x, -4.0, -2.0)) * longest, "pressure": pressure}
        case "isotonic":
            return {"force": ordinary_force(case, x, pressure), "pressure": pressure}
        case "large force":
            low, high = (ordinary_force(case, end, pressure) for end in (0.0, 1.0))
            beyond = 5.0 * (2.0 * x - 1.0) * (high - low)
            return {"force": beyond + (high if beyond > 0.0 else low), "pressure": pressure}
    return {"force": 0.0, "pressure": pressure}


def ordinary_force(case: Case, x: float, pressure: float) -> float:
    """Force of the cylinder whose length lies at x between 0.8 H0 and 0.95 of full extension."""
    p = parameters(muscle_of(case))
    angle = cylinder_angle(_between(x, 0.8 * case["muscle"]["H0"], 0.95 * case["longest"]), p)
    return float(cylinder_force(angle, pressure, p))


def muscle_of(case: Case) -> mk.Muscle:
    """The specification of a case."""
    m = case["muscle"]
    fibre = mk.Fibre(diameter=m["d"], E=m["E"], nu=m["nu"])
    braid = mk.Braid(radius=m["R0"], length=m["H0"], angle=m["theta0"], fibres=m["N"], fibre=fibre)
    chamber = mk.Chamber(thickness=m["t0"], law=mk.MooneyRivlin(c1=m["c1"], c2=m["c2"]))
    return mk.Muscle(braid=braid, chamber=chamber, ends=case["ends"])


def _fitting(rng: np.random.Generator) -> dict[str, Any]:
    """Numbers of a muscle whose fibres fit side by side."""

    def decades(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(math.log(low), math.log(high))))

    while True:
        R0, theta0 = float(rng.uniform(5e-3, 25e-3)), math.radians(float(rng.uniform(20.0, 70.0)))
        H0, N = R0 * decades(2.0, 20.0), 2 * int(rng.integers(4, 49))
        d, E = decades(1e-4, 1e-3), decades(0.5e9, 100e9)
        c1, t0 = decades(0.02e6, 1e6), decades(0.3e-3, 3e-3)
        c2 = c1 * float(rng.uniform(0.0, 0.5))
        if N // 2 * d <= 2.0 * math.pi * R0 * math.sin(theta0):
            return {
                "R0": R0, "H0": H0, "theta0": theta0, "N": N, "d": d, "E": E, "nu": 0.4, "t0": t0, "c1": c1, "c2": c2,
            }  # fmt: skip


def _between(x: float, low: float, high: float) -> float:
    return low + x * (high - low)

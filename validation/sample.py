"""Random muscles and targets, the same ones on every machine: case k is drawn from the seed (SEED, k) alone.

Ranges: theta0 20-70 deg, H0/R0 2-20, R0 5-25 mm, N 8-96 even, d 0.1-1 mm, E 0.5-100 GPa, nu 0.4, chamber c1 0.02-1 MPa,
c2 up to c1/2, wall 0.3-3 mm, P 0-0.6 MPa (one in ten without pressure); log-uniform where a range spans a decade or
more. Muscles whose fibres do not fit side by side are drawn again. Even cases are clamped, odd ones pinned.
"""

import math
from typing import Any

import numpy as np

import mckibben as mk
from mckibben.model.cylinder import cylinder_angle, cylinder_force
from mckibben.model.extension import full_extension
from mckibben.model.parameters import parameters

SEED = 20230403
SHARES = {"length": 0.65, "free contraction": 0.15, "isotonic": 0.2}
"""Kinds of target: a length in 0.6 H0 .. 0.999 h_max; no force; the force of a cylinder of 0.8 H0 .. 0.95 h_max."""

Case = dict[str, Any]


def draw(k: int) -> Case:
    """Case k as plain numbers in SI units."""
    rng = np.random.default_rng((SEED, k))
    numbers = _fitting(rng)
    case: Case = {"id": k, "ends": ("clamped", "pinned")[k % 2], "muscle": numbers}
    pressure = 0.0 if rng.random() < 0.1 else float(rng.uniform(0.0, 0.6e6))
    longest = full_extension(numbers["R0"], numbers["H0"], numbers["theta0"], case["ends"])
    kind = str(rng.choice(list(SHARES), p=list(SHARES.values())))
    x = float(rng.random())
    case |= {"kind": kind, "longest": longest}
    if kind == "length":
        return case | {"held": {"length": _between(x, 0.6 * numbers["H0"], 0.999 * longest), "pressure": pressure}}
    force = 0.0
    if kind == "isotonic":
        muscle = muscle_of(case)
        p = parameters(muscle)
        angle = cylinder_angle(_between(x, 0.8 * numbers["H0"], 0.95 * longest), p)
        force = float(cylinder_force(angle, pressure, p))
    return case | {"held": {"force": force, "pressure": pressure}}


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

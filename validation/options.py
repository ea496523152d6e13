"""Random muscles with random options, the same ones on every machine: case k is drawn from the seed and k alone.

Options are drawn once for every `EACH` cases, because each combination of them is compiled anew; numbers for each case.
"""

import math
from typing import Any

import numpy as np
from sample import _fitting

import mckibben as mk
from mckibben.model.extension import longest
from mckibben.model.profile import fibre_lengths
from mckibben.spec.end_radii import limits

SEED, EACH = 20261129, 5
POINTS, SWINGS = 8, math.radians(8.0)
"""Of an axial law; how far the angles of a programmed braid lie from the first one at most."""
Case = dict[str, Any]
LAWS = ("mooney-rivlin", "neo-hookean", "yeoh", "ogden", "gent", "arruda-boyce", "rubber")
OFF: dict[str, Any] = {
    "ends": "clamped", "radii": 0, "joint": "hinge", "stretch": False, "slack": False, "natural": "helical",
    "stiffening": False, "chamber": "paper's", "law": "neo-hookean", "shorter": False, "compliance": False,
    "dead": False,
}  # fmt: skip
"""Options of which none is on, to switch some on by name."""
CHAMBERS = {"paper's": 0.2, "inside": 0.15, "thick": 0.15, "tube": 0.22, "gap": 0.12, "bellows": 0.09, "none": 0.07}


def drawn(k: int) -> Case:
    """Options and numbers of case k, plain values in SI units."""
    return {"id": k, "options": options(k // EACH), "seed": [SEED, 2, k]}


def options(s: int) -> dict[str, Any]:
    """What is switched on in the cases of number s."""
    rng = np.random.default_rng((SEED, 1, s))

    def odds(share: float) -> bool:
        return bool(rng.random() < share)

    ends = str(rng.choice(["clamped", "pinned", "free"], p=[0.45, 0.45, 0.1]))
    radii = int(rng.choice([0, 1, 2], p=[0.6, 0.2, 0.2]))
    return {
        "ends": ends, "radii": 0 if ends == "free" else radii,
        "joint": "pin" if odds(0.3) else "hinge", "stretch": odds(0.4), "slack": odds(0.2),
        "natural": "straight" if odds(0.2) else "helical", "stiffening": odds(0.15),
        "chamber": str(rng.choice(list(CHAMBERS), p=list(CHAMBERS.values()))), "law": str(rng.choice(LAWS)),
        "shorter": odds(0.5), "compliance": odds(0.25), "dead": odds(0.25),
    } | _later(s)  # fmt: skip


def _later(s: int) -> dict[str, Any]:
    """What came to the options later, so that what was drawn before stays: both ask for fibres that stretch."""
    rng = np.random.default_rng((SEED, 3, s))
    return {
        "axial": bool(rng.random() < 0.3), "profile": str(rng.choice(["", "mirrored", "whole"], p=[0.5, 0.25, 0.25])),
        "between": str(rng.choice(["spline", "monotone"])), "places": int(rng.integers(1, 6)),
    }  # fmt: skip


def has_profile(on: dict[str, Any]) -> bool:
    """Whether the options make a programmed braid: of fibres that stretch, between fittings of the braid's radius."""
    return bool(on.get("profile") and on["stretch"] and not on["radii"])


def case_of(case: Case) -> tuple[mk.Muscle, float, float]:
    """The muscle of a case, and the length [m] and pressure [Pa] that are held."""
    on, rng, more = case["options"], np.random.default_rng(case["seed"]), np.random.default_rng([*case["seed"], 4])
    while True:
        m = _fitting(rng)
        try:
            muscle = _muscle(m, on, rng, more)
        except mk.SpecError:  # a bore that is closed as mounted, a wall too thick for its radius
            continue
        straight = float(fibre_lengths(muscle)) if has_profile(on) else m["H0"] / math.sin(m["theta0"])
        most = min(longest(muscle), straight + float(muscle.rest_length - m["H0"]))
        if not most > 0.8 * float(muscle.rest_length):
            continue
        low = 0.75 * float(muscle.rest_length)
        length = low + rng.random() * (0.97 * most - low)
        return muscle, length, 0.0 if rng.random() < 0.1 else float(rng.uniform(0.0, 0.4e6))


def _muscle(m: dict[str, Any], on: dict[str, Any], rng: np.random.Generator, more: np.random.Generator) -> mk.Muscle:
    fibre: dict[str, Any] = {"diameter": m["d"], "E": m["E"], "nu": m["nu"], "natural": on["natural"]}
    if on["stretch"]:
        fibre |= {"stretch": True, "slack": on["slack"]}
        if on.get("axial"):
            fibre["axial_law"] = _axial(math.pi / 4.0 * m["d"] ** 2 * m["E"], more)
    if on["stiffening"]:
        fibre["stiffening"] = mk.Stiffening(curvature=float(rng.uniform(0.3, 2.0)) / m["R0"])
    braid = mk.Braid(
        radius=m["R0"], length=m["H0"], angle=m["theta0"], fibres=m["N"], fibre=mk.Fibre(**fibre), joint=on["joint"],
        angle_profile=_profile(m["theta0"], on, more) if has_profile(on) else None,
    )  # fmt: skip
    fittings = {}
    if on["compliance"]:
        fittings["compliance"] = float(10.0 ** rng.uniform(-7.0, -4.5))
    if on["dead"]:
        fittings["dead_length"] = float(rng.uniform(0.0, 0.3)) * m["H0"]
    low, high = limits(braid)
    radii = [min(max(m["R0"] * float(rng.uniform(0.75, 1.2)), 1.01 * low), 0.99 * high) for _ in range(on["radii"])]
    return mk.Muscle(
        braid=braid, chamber=_chamber(m, on, rng), ends=on["ends"], end_radii=radii or None,
        fittings=mk.Fittings(**fittings) if fittings else None,
    )  # fmt: skip


def _axial(EA: float, rng: np.random.Generator) -> mk.AxialLaw:
    """A yarn that gets stiffer: from a fifth of EA at rest to all of it; three points under compression."""
    strain = np.linspace(0.0, float(rng.uniform(0.01, 0.05)), POINTS)
    force = EA * strain * (0.2 + 0.8 * strain / strain[-1])
    return mk.AxialLaw(strain=[*-strain[3:0:-1], *strain], force=[*-0.2 * EA * strain[3:0:-1], *force])


def _profile(first: float, on: dict[str, Any], rng: np.random.Generator) -> mk.AngleProfile:
    """Angles beside the first one, at places drawn at random, not too close."""
    last, count = 0.5 if on["profile"] == "mirrored" else 1.0, on["places"]
    angles = np.clip(first + rng.uniform(-SWINGS, SWINGS, count), math.radians(15.0), math.radians(75.0))
    widths = 0.4 + rng.random(count)
    at = last * np.cumsum(widths) / widths.sum()
    at[-1] = last
    return mk.AngleProfile(angle=list(angles), at=list(at), mirrored=last == 0.5, between=on["between"])


def _chamber(m: dict[str, Any], on: dict[str, Any], rng: np.random.Generator) -> mk.Chamber | None:
    kind, t0 = on["chamber"], min(m["t0"], 0.4 * m["R0"])
    length = {"length": m["H0"] / float(rng.uniform(1.0, 1.3))} if on["shorter"] and kind != "paper's" else {}
    law = _law(m["c1"], "neo-hookean" if kind == "gap" else on["law"], rng)
    if kind == "none":
        return None
    if kind == "bellows":
        return mk.Chamber(law=mk.Bellows(axial_stiffness=float(10.0 ** rng.uniform(-1.0, 2.0))), **length)
    if kind == "paper's":
        return mk.Chamber(thickness=t0, law=law)
    if kind in ("inside", "thick"):
        return mk.Chamber(thickness=t0, lies="inside", wall="thick" if kind == "thick" else None, law=law, **length)
    outer = 2.0 * m["R0"] * float(rng.uniform(0.7, 1.0))
    inner = outer * (1.0 - float(rng.uniform(0.05, 0.4)))
    wall = "thick" if on["slack"] or on["joint"] == "pin" else None  # by what is drawn for the structure
    return mk.Chamber(outer_diameter=outer, inner_diameter=inner, wall=wall, gap=kind == "gap", law=law, **length)


def _law(c1: float, name: str, rng: np.random.Generator) -> Any:
    """A law of shear modulus 2 c1."""
    share = float(rng.uniform(0.0, 0.5))
    match name:
        case "mooney-rivlin":
            return mk.MooneyRivlin(c1=c1 * (1.0 - share), c2=c1 * share)
        case "yeoh":
            return mk.Yeoh(c1=c1, c2=-0.05 * share * c1, c3=0.01 * share * c1)
        case "ogden":
            alpha = [float(rng.uniform(1.5, 4.0)), -2.0]
            return mk.Ogden(mu=[4.0 * c1 * (1.0 - share) / alpha[0], -2.0 * c1 * share], alpha=alpha)
        case "gent":
            return mk.Gent(mu=2.0 * c1, Jm=float(rng.uniform(15.0, 60.0)))
        case "arruda-boyce":
            return mk.ArrudaBoyce(mu=2.0 * c1, lambda_m=float(rng.uniform(3.0, 6.0)))
        case "rubber":
            return mk.Rubber(E=6.0 * c1)
    return mk.NeoHookean(c1=c1)

"""Random muscles that rub, each through a closed test: does friction ever give a wrong number?

    python validation/random_friction.py [--count 64] [--first 0] [--report-only]

What must hold of every path, whatever is switched on: nothing that was dissipated comes back; work is what is stored
and dissipated; a loop that closes comes back to its state, and its area is what it dissipated; rougher calls and
rougher paths give the same within the errors that are told; the force lies between the sliding branches that
`mk.solve` tells; without friction, by numbers that are zero, the plain state; turned around, the mirrored path; and a
path that ends early says why and keeps what was reached. Paths come from `validation/friction_options.py`. Results go
line by line to validation/random_friction.jsonl; a run that was cut short goes on where it stopped. Writes
validation/random_friction.md.
"""

import argparse
import os
import warnings
from typing import Any

from environment import ROOT
from friction_options import CORNERS, drawn, path, rubbing_case, test_of
from friction_report import INSIDE, ROUGH, report
from options import has_profile
from random_muscles import read, within, write_lines

os.environ.setdefault("MCKIBBEN_COMPILE", "quick")

import attrs
import numpy as np

import mckibben as mk

FILE = ROOT / "validation" / "random_friction.jsonl"
LIMIT = 240
"""Seconds of the processor that a case may take, compiling included."""
TOLERANCE = 1e-5
"""Of the runs that are judged."""
ROUNDING = 1e-9


def one(case: dict[str, Any]) -> dict[str, Any]:
    """All checks of one case."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mk.MuscleWarning)
        return within(LIMIT, checked, case)


def checked(case: dict[str, Any]) -> dict[str, Any]:
    """By how much each check of a case is off, over what it may be: above 1 it fails."""
    muscle, given = rubbing_case(case)

    def walk(muscle: mk.Muscle, finer: int = 1, tolerance: float = TOLERANCE) -> mk.Result:
        values = path(given["first"], given["other"], finer)
        return mk.run(muscle, test_of(case["test"], given["at"], values), tolerance=tolerance)

    first, asked = walk(muscle), CORNERS[-1] + 1
    found: dict[str, Any] = {"status": first.status, "reached": first.reached} | given
    if first.reached < asked:
        plain = walk(muscle.replace("friction", None))
        return found | _ended(first) | {"plain": sum(verdict == "stable" for verdict in plain.verdict)}
    found["unstable"] = sum(verdict != "stable" for verdict in first.verdict)
    second, third = walk(muscle, 2), walk(muscle, tolerance=ROUGH)
    if second.reached < 2 * asked - 1 or third.reached < asked:
        return found | {"lost": f"{second.reached} of {2 * asked - 1} and {third.reached} of {asked} states"}
    one, two, rough = Walked(first), Walked(second), Walked(third)
    lost = max(-np.diff(each.lost).min() / (ROUNDING * max(each.lost[-1], 1e-300)) for each in (one, two))
    found |= {"estimate": one.error, "second law": lost}
    if rough.error != one.error:  # otherwise it is the same walk
        found["finer"] = one.apart(rough) / (one.error + rough.error)
    found |= {"steps": one.apart(two, 2) / (one.error + two.error)} | balances(one, two)
    corners = np.array([given["first"], given["other"], given["first"]])
    found |= _nothing(muscle, test_of(case["test"], given["at"], corners))
    if not case["slides"]:
        found |= _between(muscle, one)
    if has_profile(case["options"]) and case["options"]["profile"] == "whole":
        found["mirror"] = one.apart(Walked(walk(_turned(muscle)))) / (one.error + ROUNDING)
    return found


class Walked:
    """What a path that was reached whole reads, as arrays over its states."""

    def __init__(self, result: mk.Result) -> None:
        self.force, self.length, self.pressure, self.volume, self.energy, self.lost = (
            result.data[name].values for name in ("force", "length", "pressure", "volume", "energy", "dissipated")
        )
        self.error = float(result.data["error_estimate"].max())
        self.load = np.maximum(np.abs(self.force), np.pi * float(result.muscle.braid.radius) ** 2 * self.pressure)

    def apart(self, other: "Walked", every: int = 1) -> float:
        """Largest difference of force and length from another path, of which each state counts or every other one."""
        force = np.abs(self.force - other.force[::every]) / self.load
        return float(max(force.max(), np.abs(self.length / other.length[::every] - 1.0).max()))

    def part(self, begin: int, end: int) -> dict[str, float]:
        """Work [J] on a part of the path by trapezia, how much of it there is to and fro, what is stored and lost."""
        F, h, P, V = (x[begin : end + 1] for x in (self.force, self.length, self.pressure, self.volume))
        pieces = np.stack([0.5 * (F[1:] + F[:-1]) * np.diff(h), 0.5 * (P[1:] + P[:-1]) * np.diff(V)])
        stored, lost = (float(x[end] - x[begin]) for x in (self.energy, self.lost))
        return {"work": float(pieces.sum()), "size": float(np.abs(pieces).sum()), "stored": stored, "lost": lost}


def balances(one: Walked, two: Walked) -> dict[str, float]:
    """Work against what is stored and dissipated, on the way and around both loops, and whether these close.

    What the trapezia and the steps leave is told by the same path in half the steps, `one`.
    """
    found: dict[str, float] = {}
    for name, (first, last) in {"way": (0, 1), "minor loop": (1, 3), "major loop": (4, 6)}.items():
        begin, end = CORNERS[first], CORNERS[last]
        few, many = one.part(begin, end), two.part(2 * begin, 2 * end)
        may = sum(abs(many[key] - few[key]) for key in ("work", "stored", "lost"))
        may += (two.error + ROUNDING) * many["size"]
        found[f"{name}: balance"] = abs(many["work"] - many["stored"] - many["lost"]) / may
        if name != "way":
            apart = max(
                abs(two.force[2 * end] - two.force[2 * begin]) / two.load[2 * end],
                abs(two.length[2 * end] / two.length[2 * begin] - 1.0),
            )
            found[f"{name}: closes"] = apart / (2.0 * two.error + one.apart(two, 2))
            found[f"{name}: area"] = abs(many["work"] - many["lost"]) / (may + 2.0 * two.error * many["size"])
            found[f"{name}: lost"] = many["lost"] / many["size"]
    return found


def _nothing(muscle: mk.Muscle, test: mk.Step) -> dict[str, float]:
    """The corners of the path with coefficients of zero: nothing is lost, and states are those of the plain muscle.

    A chamber that slides freely is no plain muscle's: its path must come back to its first state.
    """
    slides = muscle.friction is not None and muscle.friction.chamber_coefficient is not None
    none = mk.Friction(chamber_coefficient=0.0 if slides else None)
    walked = mk.run(muscle.replace("friction", none), test, tolerance=TOLERANCE)
    if walked.reached < 3:
        return {"zero: ended": walked.reached}
    zero = Walked(walked)
    found = {"zero: lost": float(np.abs(zero.lost).max() / (ROUNDING * np.abs(zero.energy).max()))}
    if slides:
        off = abs(zero.force[2] - zero.force[0]) / zero.load[0] + abs(zero.length[2] / zero.length[0] - 1.0)
        return found | {"zero: back": float(off / (2.0 * zero.error + ROUNDING))}
    off = []
    for k in (0, 1):
        plain = mk.solve(muscle.replace("friction", None), length=zero.length[k], pressure=zero.pressure[k])
        may = zero.error + float(plain.error_estimate) + ROUNDING
        off.append(abs(plain.force - zero.force[k]) / zero.load[k] / may)
    return found | {"zero: plain": float(max(off))}


def _between(muscle: mk.Muscle, one: Walked) -> dict[str, float]:
    """How far forces at the corners lie outside of the sliding branches, over what they may; and the largest height."""
    beyond, heights = [], []
    for k in CORNERS[:3]:
        state = mk.solve(muscle, length=one.length[k], pressure=one.pressure[k])
        if state.force_interval is not None:
            low, high = state.force_interval
            heights.append((high - low) / one.load[k])
            may = INSIDE * (high - low) + one.error * one.load[k]
            beyond.append(max(low - one.force[k], one.force[k] - high, 0.0) / may)
    return {"between": float(max(beyond)), "height": float(max(heights))} if beyond else {}


def _ended(found: mk.Result) -> dict[str, Any]:
    """Of a path that ends early: whether it says why and keeps the part before."""
    k = found.reached
    said = str(found.data["reason"].values[k])
    kept = bool(np.isfinite(found.force[:k]).all() and np.isnan(found.force[k:]).all() and said)
    return {"reason": said, "kept": kept}


def _turned(muscle: mk.Muscle) -> mk.Muscle:
    """The same braid from its other end."""
    profile = muscle.braid.angle_profile
    assert profile is not None
    assert profile.at is not None
    angles, at = [float(muscle.braid.angle), *map(float, profile.angle)], [0.0, *map(float, profile.at)]
    turned = mk.AngleProfile(angle=angles[-2::-1], at=[1.0 - x for x in at[-2::-1]], between=profile.between)
    return muscle.replace("braid", attrs.evolve(muscle.braid, angle=angles[-1], angle_profile=turned))


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", type=int, default=64)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--report-only", action="store_true")
    asked = parser.parse_args()
    if not asked.report_only:
        write_lines(one, [drawn(k) for k in range(asked.first, asked.first + asked.count)], FILE, asked.workers)
    report([row for _, row in sorted(read(FILE).items())], (__doc__ or "").split("\n\n")[2])


if __name__ == "__main__":
    main()

"""Random muscles with random options: does any combination of effects give a wrong number?

    python validation/random_options.py [--count 300] [--first 0] [--report-only]

What must hold of every state, whatever is switched on: forces and volumes are the slopes of one potential, W = U - P V
with dW = F dh - V dP; the error estimate covers the difference to a finer solution of the same state; a muscle that is
turned around has the mirrored state; and the state stays where the force that was found is held. Where the default call
gives no stable state, the other methods of validation/judges.py seek one, and where they find none either the branch is
followed by arclength to where it turns back. Results go line by line to
validation/random_options.jsonl; a run that was cut short goes on where it stopped. Writes validation/random_options.md.
"""

import argparse
import os
from pathlib import Path
from typing import Any

from environment import ROOT
from judges import judge_target, turns_back
from options import EACH, SEED, case_of, drawn, has_profile
from random_muscles import read, within, write_lines

os.environ.setdefault("MCKIBBEN_COMPILE", "quick")

import numpy as np

import mckibben as mk
from mckibben.experiments.answer import seek
from mckibben.search.finer import estimated_error
from mckibben.search.walk import look
from mckibben.solver.bench import Bench
from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.find import find, refine
from mckibben.solver.held import Held

FILE, PAGE = ROOT / "validation" / "random_options.jsonl", Path(__file__).with_name("random_options.md")
FINE = (64, 128, 256)
"""Half-length unknowns of the states that judge: as many as it takes until what is estimated of their own error is
below what they judge. Braids that vary from end to end have twice as many, so that the last would take half an hour."""
LIMIT = 1200
"""Seconds of the processor that a case may take, compiling included."""
STEP = 1e-4
"""Of lengths and pressures in differences, over the rest length and 1 bar; halved once and extrapolated."""
SLOPES, MIRROR, BACK = 1e-6, 1e-7, 1e-7
"""How far each check may be off, over |F| + pi R0^2 P for forces, and over the length or volume."""
ROUNDING = 1e-10
TOLERANCE = 1e-6
"""That of the default call."""


def one(case: dict[str, Any]) -> dict[str, Any]:
    """All checks of one case."""
    return within(LIMIT, checked, case)


def checked(case: dict[str, Any]) -> dict[str, Any]:
    """The state of a case by the default call, and by how much each check is off."""
    muscle, length, pressure = case_of(case)
    usual = mk.solve(muscle, length=length, pressure=pressure)
    found: dict[str, Any] = {
        "verdict": str(usual.verdict), "reason": usual.reason, "force": usual.force, "length": length,
        "pressure": pressure, "estimate": float(usual.error_estimate), "shape": str(usual.data["shape"].values),
    }  # fmt: skip
    bench, held = Bench.of(muscle), Held.of(length=length, pressure=pressure)
    if usual.verdict != "stable" or usual.modes is None:
        found["judges"] = judge_target(bench, held, case["id"])
        if usual.verdict == "not converged" and not found["judges"]["reached"]:
            found["branch"] = turns_back(bench, held)
        return found
    size = abs(usual.force) + np.pi * float(muscle.braid.radius) ** 2 * pressure
    b = bench.placement(held)
    fine = find(bench.problem(FINE[0], b), held)
    found["fine"] = fine.converged
    if not fine.converged:
        return found
    straight = seek(bench, held, TOLERANCE).state
    same = abs(straight.force - usual.force) <= ROUNDING * size  # unless it was found on the way or from another start
    best, found["size"], found["own"] = _finer(bench, held, straight if same else fine, found["estimate"])
    found["fine"] = best.converged
    found["error"] = abs(usual.force - best.force) / size if best.converged else float("inf")
    apart = abs(fine.force - best.force) / size
    if best.converged and apart > found["own"] + max(estimated_error(fine, held), ROUNDING):
        seen = look(fine, held)
        found["other"] = {"apart": apart, "stable": seen.good, "reason": seen.verdict.reason}
    found["slope_length"] = abs(_slope(fine, held, 0) - fine.force) / size
    found["slope_pressure"] = abs(_slope(fine, held, 1) + fine.volume) / fine.volume
    if len(muscle.end_radii or ()) == 2:
        turned = Bench.of(muscle.replace("end_radii", list((muscle.end_radii or ())[::-1])))
        other = find(turned.problem(FINE[0], b), held)
        found["mirror"] = max(abs(other.force - fine.force) / size, abs(other.volume / fine.volume - 1.0))
    if usual.modes.force_control == 0:
        back = find(fine.problem, Held.of(force=fine.force, pressure=pressure), fine, radius=0.1)
        found["back"] = abs(back.length - length) / length if back.converged else float("inf")
    return found


def _finer(bench: Bench, held: Held, state: Equilibrium, estimate: float) -> tuple[Equilibrium, int, float]:
    """The same state on more unknowns than it has, how many, and what is estimated of its error there."""
    best, size, own = state, 0, float("inf")
    sizes = [n for n in FINE if bench.problem(n, state.problem.b).basis.half or n < FINE[-1]]
    for size in sizes:
        problem = bench.problem(size, state.problem.b)
        if problem.basis.size <= state.problem.basis.size and size < sizes[-1]:
            continue
        best = refine(best, problem, held)
        if not best.converged:
            break
        own = estimated_error(best, held)
        if own <= max(estimate, ROUNDING):
            break
    return best, size, own


def _slope(at: Equilibrium, held: Held, which: int) -> float:
    """Slope of W by the length (0) or the pressure (1) on the same unknowns: central differences of two steps,
    extrapolated; NaN where a state beside is not found."""

    def potential(by: float) -> float:
        values = list(held.values)
        values[which] += by
        state = find(at.problem, Held(held.names, tuple(values)), at, radius=0.1)
        energy = float(state.totals[0] * at.problem.unit[0])
        return energy - values[1] * state.volume if state.converged else float("nan")

    step = STEP * (float(at.problem.p.rest) if which == 0 else 1e5)
    wide, narrow = ((potential(by) - potential(-by)) / (2.0 * by) for by in (step, step / 2.0))
    return (4.0 * narrow - wide) / 3.0


CHECKS = {
    "slope_length": ("dW/dh is the force", SLOPES),
    "slope_pressure": ("-dW/dP is the volume", SLOPES),
    "mirror": ("turned around, the mirrored state", MIRROR),
    "back": ("held by its force, the same length", BACK),
}


def _allowed(found: dict[str, Any]) -> float:
    """How far a state may be from its finer one: what was estimated of the one, and if that is more of the other."""
    return float(max(found["estimate"], found["own"], ROUNDING))


def failures(row: dict[str, Any]) -> list[str]:
    """What is wrong with a case, in words."""
    found, said = row["found"], []
    gone = found["verdict"] == "not converged" and found.get("branch", {}).get("turned", False)
    if found["verdict"] in ("crash", "not converged") and not gone:
        said.append(f"{found['verdict']}: {found['reason']}")
    better = [name for name, worth in found.get("judges", {}).get("worth", {}).items() if worth["stable"]]
    if better:
        said.append(f"{found['verdict']} by the default call; stable by {', '.join(better)}")
    if found["verdict"] == "stable" and not found.get("fine"):
        said.append("no state on more unknowns")
    if "error" in found and found["error"] > _allowed(found):
        said.append(f"the error {found['error']:.1e} is above the estimate {found['estimate']:.1e}")
    for name, (what, limit) in CHECKS.items():
        off = found.get(name, 0.0)
        if not off <= limit:  # also where a state beside was not found
            said.append(f"{what}: off by {off:.1e}")
    return said


def words(options: dict[str, Any]) -> str:
    """Options in a line, without those that are off."""
    said = [options["ends"], f"chamber {options['chamber']}"]
    if options["chamber"] not in ("none", "bellows", "gap"):
        said.append(options["law"])
    said += [f"{options['radii']} end radii"] if options["radii"] else []
    said += [name for name in ("stretch", "stiffening", "compliance", "dead") if options[name]]
    said += ["pin"] if options["joint"] == "pin" else []
    said += ["axial law"] if options.get("axial") and options["stretch"] else []
    said += [f"programmed ({options['profile']})"] if has_profile(options) else []
    said += ["straight fibres"] if options["natural"] == "straight" else []
    return ", ".join(said)


def report(rows: list[dict[str, Any]]) -> None:
    """The page."""
    verdicts = [row["found"]["verdict"] for row in rows]
    lines = [
        "# Random muscles with random options",
        "",
        "Written by `python validation/random_options.py`. " + " ".join((__doc__ or "").split("\n\n")[2].split()),
        "",
        f"{len(rows)} muscles, {len({str(row['case']['options']) for row in rows})} combinations of options (one for "
        f"{EACH} muscles each; seed {SEED}). Numbers as in `validation/sample.py`, options as in "
        "`validation/options.py`; lengths from 0.75 of the rest length to 0.97 of full extension or of a fibre, "
        "0 to 4 bar, one in ten without pressure.",
        "",
        "| verdict | muscles |",
        "| --- | --- |",
        *(f"| {name} | {verdicts.count(name)} |" for name in sorted(set(verdicts))),
        "",
        "| check | states | median | largest | allowed | beyond it |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    errors = [row["found"] for row in rows if "error" in row["found"]]
    ratio = np.array([one["error"] / _allowed(one) for one in errors])
    lines.append(
        f"| error over its estimate | {len(ratio)} | {np.median(ratio):.1e} | {ratio.max():.1e} | 1 | "
        f"{int((ratio > 1.0).sum())} |"
    )
    for name, (what, limit) in CHECKS.items():
        off = np.array([row["found"][name] for row in rows if name in row["found"]])
        off = off[np.isfinite(off)]
        if len(off):
            beyond = int((off > limit).sum())
            lines.append(f"| {what} | {len(off)} | {np.median(off):.1e} | {off.max():.1e} | {limit:.0e} | {beyond} |")
    on: dict[str, int] = {}
    for row in rows:
        for word in words(row["case"]["options"]).split(", "):
            on[word] = on.get(word, 0) + 1
    lines += ["", "How often each option was there: " + ", ".join(f"{k} {n}" for k, n in sorted(on.items())) + "."]
    blunt = sum(one["own"] > max(one["estimate"], ROUNDING) for one in errors)
    lines += [
        "",
        f"The finer solution is the same state, refined to {FINE[0]} unknowns for each half, and to {FINE[1]} and "
        f"(where both halves are alike) {FINE[2]} where its own estimated error is above the estimate that it judges; "
        f"of {blunt} states it still is, and counts in its place.",
    ]
    others = [row for row in rows if "other" in row["found"]]
    if others:
        which = ", ".join(
            f"{row['case']['id']} ({row['found']['other']['apart']:.0e} of the load away, "
            f"{'stable too' if row['found']['other']['stable'] else 'unstable'})"
            for row in others
        )
        lines += ["", f"Sought straight on {FINE[0]} unknowns, another equilibrium was found in the cases {which}."]
    gone = [row for row in rows if row["found"].get("branch", {}).get("turned")]
    if gone:
        which = ", ".join(f"{row['case']['id']} ({row['found']['branch']['furthest']:.3f} of the way)" for row in gone)
        lines += [
            "",
            "Not converged, and no other method found a state: followed by arclength the branch turns back before the "
            f"target in the cases {which}.",
        ]
    bad = [(row, failures(row)) for row in rows if failures(row)]
    lines += ["", f"{len(bad)} muscles with a check that failed."]
    if bad:
        lines += [
            "",
            "| case | options | length (mm) | pressure (bar) | what failed |",
            "| --- | --- | --- | --- | --- |",
        ]
        for row, said in bad:
            found = row["found"]
            place = f"{1e3 * found.get('length', np.nan):.4g} | {1e-5 * found.get('pressure', np.nan):.4g}"
            lines.append(f"| {row['case']['id']} | {words(row['case']['options'])} | {place} | {'; '.join(said)} |")
    PAGE.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--report-only", action="store_true")
    asked = parser.parse_args()
    if not asked.report_only:
        write_lines(one, [drawn(k) for k in range(asked.first, asked.first + asked.count)], FILE, asked.workers)
    report([row for _, row in sorted(read(FILE).items())])


if __name__ == "__main__":
    main()

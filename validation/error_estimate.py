"""The error estimate against the true error, on random states at every size, and on stretched ones by the call.

    python validation/error_estimate.py [--count 120] [--stretched 180] [--workers 2]
        [--report-only]

The rows go to out/error_estimate.json and out/error_estimate_stretched.jsonl, the tables into validation/README.md.
"""

import argparse
import itertools
import json
from textwrap import fill
from typing import Any

import numpy as np
from environment import OUT
from judges import placement
from pictures import draw_errors
from random_muscles import done, read, write_lines
from sample import FIRST, SECOND, Case, draw, muscle_of
from sections import README, put
from summary import table

import mckibben as mk
from mckibben.measure.survey import errors, read_states
from mckibben.solver.bench import Bench
from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.find import find, refine
from mckibben.solver.held import Held

ROWS, STRETCHED = OUT / "error_estimate.json", OUT / "error_estimate_stretched.jsonl"
TOLERANCES, FINE = (1e-4, 1e-6), 1e-10
"""Of the calls on stretched states, and of the call that gives the true force."""
FLOOR = 1e-11
"""Relative differences below this are rounding."""
SIZES, FINEST = (12, 24, 48, 96), 144


def chosen(count: int) -> list[dict[str, Any]]:
    """The first stable states, half of them those that needed the most unknowns or have the largest estimates."""
    stable = [row for _, row in sorted(done(FIRST).items()) if row["found"]["verdict"] == "stable"]
    hard = sorted(stable, key=lambda row: -row["found"]["error_estimate"])[: count // 2]
    ids = {row["case"]["id"] for row in hard}
    return hard + [row for row in stable if row["case"]["id"] not in ids][: count - len(hard)]


def measure(row: dict[str, Any]) -> list[dict[str, Any]]:
    """One line for each size."""
    case = row["case"]
    bench, held = Bench.of(muscle_of(case)), Held.of(**case["held"])
    states: list[Equilibrium] = []
    for size in (*SIZES, FINEST):
        problem = bench.problem(size, placement(bench, held))
        state = refine(states[-1], problem, held) if states else find(problem, held)
        states.append(state if state.converged else find(problem, held))
    finest, other = states[-1], "force" if "length" in held.names else "length"
    natural = float(np.pi * bench.p.R0**2 * held.get("pressure")) + abs(finest.force)
    lines = []
    for size, state in zip(SIZES, states, strict=False):
        seen = read_states(state.problem, state.u[None], state.loads[None], False)[0]
        value, true = getattr(state, other), getattr(finest, other)
        lines.append({
            "id": case["id"], "size": size, "other": other, "converged": state.converged and finest.converged,
            "value": value, "true": true, "error": abs(value - true) / max(abs(true), 1e-300),
            "natural": abs(value - true) / (natural if other == "force" else abs(true)),
            "estimate": float(errors(state.problem, state.u[None], state.loads[None])[0]),
            "variation": float(seen.conserved_variation[0]),
            "tail": float(seen.coefficient_tail[0]), "finest_tail": finest.tail,
        })  # fmt: skip
    return lines


def stretched(case: Case) -> dict[str, Any]:
    """The force at a length close to full extension, by calls of several tolerances."""
    fine = mk.solve(muscle_of(case), **case["held"], tolerance=FINE)
    natural = np.pi * case["muscle"]["R0"] ** 2 * case["held"]["pressure"] + abs(fine.force)
    gap = 1.0 - case["held"]["length"] / case["longest"]
    lines = []
    for tolerance in TOLERANCES:
        state = mk.solve(muscle_of(case), **case["held"], tolerance=tolerance)
        line = {"id": case["id"], "gap": gap, "tolerance": tolerance, "estimate": state.error_estimate}
        line |= {"natural": abs(state.force - fine.force) / natural, "fine estimate": fine.error_estimate}
        line["converged"] = str(state.verdict) == str(fine.verdict) == "stable"
        lines.append(line)
    return {"case": case, "lines": lines}


def near_extension(count: int) -> list[Case]:
    """The first stretched cases of the second sample, and of what it would go on with."""
    cases = (draw(k, SECOND) for k in itertools.count())
    return list(itertools.islice((case for case in cases if case["kind"] == "stretched"), count))


def section() -> list[str]:
    """The section of the page."""
    rows = json.loads(ROWS.read_text(encoding="utf-8"))
    near = [line for row in read(STRETCHED).values() for line in row["lines"]]
    draw_errors(rows, README.parent / "error_estimate.png")
    rows = [row for row in rows if row["converged"]]
    groups = {f"{size} unknowns": [row for row in rows if row["size"] == size] for size in SIZES}
    groups |= {"the size that the default call ends with": _ended(rows), "every size": rows}
    text = ["", SAID, *_table("states on", groups), "", "![estimate against true error](error_estimate.png)"]
    if not near:
        return text
    lost = len({row["id"] for row in near if not row["converged"]})
    near = [row for row in near if row["converged"]]
    groups = {
        f"{low:g} to {high:g}, tolerance {tolerance:g}": [
            row for row in near if low <= row["gap"] < high and row["tolerance"] == tolerance
        ]
        for tolerance in TOLERANCES
        for low, high in ((1e-4, 1e-3), (1e-3, 1e-2))
    }
    said = fill(NEAR.format(count=len({row["id"] for row in near}), lost=lost), 120)
    return [*text, "", said, *_table("short of full extension by", groups)]


def _table(what: str, groups: dict[str, list[dict[str, Any]]]) -> list[str]:
    lines = []
    for name, of in groups.items():
        below = [row for row in of if row["natural"] > max(row["estimate"], FLOOR)]
        wrong = [row for row in of if row["estimate"] <= 1e-6 < row["natural"]]
        factor = max((row["natural"] / row["estimate"] for row in below), default=0.0)
        over = [row["estimate"] / row["natural"] for row in of if row["natural"] > FLOOR]
        typical = f"{np.median(over):.0f}" if over else ""
        largest = f"{max((row['natural'] for row in of), default=0.0):.1e}"
        lines.append([name, len(of), len(below), f"{factor:.1f}" if below else "", typical, largest, len(wrong)])
    head = [what, "count", "estimate below the true error", "by at most", "median estimate over error",
            "largest true error", "estimate below 1e-6 and error not"]  # fmt: skip
    return table(head, lines)


def _ended(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Of each state, the size with which the default call is content."""
    by: dict[int, list[dict[str, Any]]] = {}
    for row in rows:
        if row["size"] > SIZES[0]:
            by.setdefault(row["id"], []).append(row)
    return [next((row for row in of if row["estimate"] <= 1e-6), of[-1]) for of in by.values()]


SAID = """Written by `python validation/error_estimate.py`. Stable states of the first sample, half of them those with
the largest estimates. The true error is the difference to 144 unknowns, over |F| + pi R0^2 P for a force and the length
for a length; below 1e-11 it is rounding. 12 unknowns serve only where a tolerance of 1e-4 or more is asked for."""

NEAR = """{count} stretched states of the second sample by `mk.solve`, against the same call with a tolerance of 1e-10
(which ends with 192 unknowns at most); {lost} more have no stable state by one of the calls."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=120)
    parser.add_argument("--stretched", type=int, default=180)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--report-only", action="store_true")
    asked = parser.parse_args()
    if not asked.report_only:
        ROWS.write_text(json.dumps([line for row in chosen(asked.count) for line in measure(row)]), encoding="utf-8")
        write_lines(stretched, near_extension(asked.stretched), STRETCHED, asked.workers)
    put("## The error estimate", section())


if __name__ == "__main__":
    main()

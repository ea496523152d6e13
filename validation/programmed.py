"""States of random programmed braids: does the error estimate cover the true error, and how far is it from it?

    python validation/programmed.py [--count 20] [--kinds 5] [--seed 20261201]

Each braid is put at a length and a pressure drawn at random. The same state is sought on few unknowns with what `HELD`
says held, and compared with that on 128 for each half. Results go line by line to out/programmed.jsonl; a run that was
cut short goes on where it stopped. Writes validation/programmed.md; the table of another seed is printed.
"""

import argparse
import json
import os
from pathlib import Path
from typing import Any

from environment import OUT
from options import OFF, case_of
from touching import HELD, apart

os.environ.setdefault("MCKIBBEN_COMPILE", "quick")

import numpy as np

from mckibben.measure.survey import error_bound, read_states
from mckibben.search.finer import estimated_error
from mckibben.solver.bench import Bench
from mckibben.solver.find import embedded, find
from mckibben.solver.held import Held

FILE, PAGE = OUT / "programmed.jsonl", Path(__file__).with_name("programmed.md")
SEED, SIZES, FINE = 20261201, (24, 48), 128
UNRESOLVED = 0.1
"""Estimated error from which a state is a guess: how wrong it is a step cannot tell."""
OTHER = 0.1
"""Change of psi [rad] from which it is another state, as where two have the same force."""
ON = OFF | {"stretch": True, "chamber": "inside"}
KINDS: dict[str, dict[str, Any]] = {
    "mirrored, spline, 2 places": {"profile": "mirrored", "between": "spline", "places": 2},
    "mirrored, spline, 4 places, pinned": {"profile": "mirrored", "between": "spline", "places": 4, "ends": "pinned"},
    "mirrored, monotone, 3 places": {"profile": "mirrored", "between": "monotone", "places": 3},
    "mirrored, monotone, 2 places, pin joints, free ends": {
        "profile": "mirrored", "between": "monotone", "places": 2, "joint": "pin", "ends": "free"
    },
    "not mirrored, spline, 3 places, compliance": {
        "profile": "whole", "between": "spline", "places": 3, "compliance": True
    },
}  # fmt: skip


def looked_at(options: dict[str, Any], k: int, seed: int = SEED) -> list[dict[str, Any]]:
    """True errors and their estimates, on each number of unknowns and whatever is held."""
    muscle, length, pressure = case_of({"options": ON | options, "seed": [seed, k]})
    bench, at = Bench.of(muscle), Held.of(length=length, pressure=pressure)
    b = bench.placement(at)
    fine = find(bench.problem(FINE, b), at)
    rows = []
    for size in SIZES:
        near = find(bench.problem(size, b), at)
        for names in (names for names in HELD if pressure or "pressure" in names):
            held = Held(names, tuple(float(getattr(fine, name)) for name in names))
            state = near if names == HELD[0] else find(near.problem, held, near, radius=0.1)
            if fine.converged and state.converged and near.converged:
                on = fine.problem
                far = on.moved(embedded(state, on).u - fine.u)
                seen = read_states(state.problem, state.u[None], state.loads[None], False)[0]
                by_tail = float(error_bound(seen.conserved_variation, seen.coefficient_tail, True)[0])
                rows.append(
                    {"size": size, "held": names, "error": apart(state, fine, names), "by_tail": by_tail}
                    | {"estimate": estimated_error(state, held), "moved": far}
                )
    return rows


def report(lines: list[dict[str, Any]]) -> str:
    """The page."""
    said = [
        "# Programmed braids",
        "",
        "Written by `python validation/programmed.py`. " + " ".join((__doc__ or "").split("\n\n")[2].split()),
        "",
        "`ratio` is the true error over its estimate, of force and pressure (over |F| + pi R0^2 P and P) and length, "
        "whichever is not held: at most 1 if the estimate is honest, and near 1 if it is sharp. `by tail` is the "
        "median ratio, and the largest, of an estimate by the last coefficients alone (2 tail^1.5). States whose "
        f"estimate is above {UNRESOLVED:g} are said to be unresolved, and left out, as are other states than that on "
        f"128 (more than {OTHER:g} rad from it).",
        "",
        "| braids | held | unknowns | states | error | largest | ratio | largest | above 1 | by tail | largest |",
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for kind in (*KINDS, "all"):
        for names in HELD:
            for size in SIZES:
                rows = [row for line in lines if kind in (line["kind"], "all") for row in line["rows"]]
                rows = [row for row in rows if tuple(row["held"]) == names and row["size"] == size]
                rows = [row for row in rows if row["estimate"] <= UNRESOLVED and row["moved"] <= OTHER]
                if not rows:
                    continue
                error, estimate, tail = (np.array([row[k] for row in rows]) for k in ("error", "estimate", "by_tail"))
                ratio, old = error / estimate, error / tail
                said.append(
                    f"| {kind} | {', '.join(names)} | {size} | {len(rows)} | {np.median(error):.1e} "
                    f"| {error.max():.1e} | {np.median(ratio):.2f} | {ratio.max():.2f} | {int((ratio > 1.0).sum())} "
                    f"| {np.median(old):.3f} | {old.max():.2g} |"
                )
    braids = sum(1 for line in lines if line["rows"])
    every = [row for line in lines for row in line["rows"]]
    lost = [row for row in every if row["estimate"] > UNRESOLVED]
    least = min((row["error"] for row in lost), default=float("nan"))
    said += ["", f"{len(lost)} of {len(every)} states are unresolved; the least error among them is {least:.1e}."]
    others = [row for row in every if row["estimate"] <= UNRESOLVED and row["moved"] > OTHER]
    said += ["", f"{len(others)} are other states."]
    said += ["", f"{braids} braids; {sum(1 for line in lines if not line['rows'])} more had no state there."]
    return "\n".join(said) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--kinds", type=int, default=len(KINDS), help="of which kinds: the first so many")
    parser.add_argument("--seed", type=int, default=SEED, help="of other braids, whose table is printed")
    asked = parser.parse_args()
    OUT.mkdir(exist_ok=True)
    own = asked.seed == SEED
    path = FILE if own else FILE.with_stem(f"programmed-{asked.seed}")
    lines = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()] if path.exists() else []
    known = {(line["kind"], line["k"]) for line in lines}
    with path.open("a", encoding="utf-8") as file:
        for name, kind in list(KINDS.items())[: asked.kinds]:
            for k in range(asked.count):
                if (name, k) not in known:
                    lines.append({"kind": name, "k": k, "rows": looked_at(kind, k, asked.seed)})
                    file.write(json.dumps(lines[-1]) + "\n")
                    file.flush()
    page = report(lines)
    if own:
        PAGE.write_text(page, encoding="utf-8")
    else:
        print(page)


if __name__ == "__main__":
    main()

"""The error estimate against the true error, on random stable states at every size that the default call may use.

    python validation/error_estimate.py [--count 120]

The true error is the difference to 144 unknowns. Rows go to out/error_estimate.json, the table into README.md.
"""

import argparse
import json
from typing import Any

import numpy as np
from environment import OUT, ROOT
from judges import placement
from random_muscles import done
from sample import muscle_of

from mckibben.measure.survey import errors, read_states
from mckibben.solver.bench import Bench
from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.find import find, refine
from mckibben.solver.held import Held

ROWS = OUT / "error_estimate.json"
SIZES, FINEST = (12, 24, 48, 96), 144


def chosen(count: int) -> list[dict[str, Any]]:
    """The first stable states, half of them those that needed the most unknowns or have the largest estimates."""
    stable = [row for _, row in sorted(done().items()) if row["found"]["verdict"] == "stable"]
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


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=120)
    rows = [line for row in chosen(parser.parse_args().count) for line in measure(row)]
    ROWS.write_text(json.dumps(rows), encoding="utf-8")
    print(len(rows), "rows in", ROWS.relative_to(ROOT))
    print("now: python validation/random_muscles.py --report-only")


if __name__ == "__main__":
    main()

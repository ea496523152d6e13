"""States of random muscles whose chamber touches in part: does the error estimate cover the true error?

    python validation/touching.py [--count 5]

Each muscle is put at a length where its chamber comes to touch the braid between two pressures (`mk.dead_zone`), and at
three pressures in between. The same state is sought on few unknowns with what `HELD` says held, and compared with that
on 192 for each half. Writes validation/touching.md.
"""

import argparse
import os
import warnings
from pathlib import Path
from typing import Any

from options import OFF, case_of

os.environ.setdefault("MCKIBBEN_COMPILE", "quick")

import numpy as np

import mckibben as mk
from mckibben.measure.survey import error_bound, read_states
from mckibben.search.finer import estimated_error
from mckibben.solver.bench import Bench
from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.find import find
from mckibben.solver.held import Held

PAGE = Path(__file__).with_name("touching.md")
SEED, SIZES, FINE = 20261130, (24, 48), 192
SHARES = (0.2, 0.5, 0.9)
"""Of the way from the pressure at which touch begins to that at which it is complete, or to twice as much."""
HELD = (("length", "pressure"), ("length", "volume"), ("force", "pressure"), ("force", "volume"))
KINDS: dict[str, dict[str, Any]] = {
    "clamped": {},
    "pinned, thick wall": {"ends": "pinned", "slack": True},
    "fibres stretch, one radius at the ends": {"stretch": True, "radii": 1},
    "two end radii": {"radii": 2},
}


def states(kind: dict[str, Any], count: int) -> list[tuple[mk.Muscle, float, float]]:
    """Muscles with lengths and pressures at which they touch in part."""
    found: list[tuple[mk.Muscle, float, float]] = []
    k = 0
    while len(found) < 3 * count and k < 10 * count:
        k += 1
        muscle, length, _ = case_of({"options": OFF | {"chamber": "gap"} | kind, "seed": [SEED, k]})
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", mk.MuscleWarning)  # where a narrow end is never reached
            zone = mk.dead_zone(muscle, length=length)
        most = 2.0 * zone.begins if zone.ends != zone.ends else zone.ends
        if most > 1.001 * zone.begins > 0.0:  # no cylinder's
            found += [(muscle, length, zone.begins + share * (most - zone.begins)) for share in SHARES]
    return found


def looked_at(muscle: mk.Muscle, length: float, pressure: float) -> list[dict[str, Any]]:
    """True errors and their estimates, on each number of unknowns and whatever is held."""
    bench, at = Bench.of(muscle), Held.of(length=length, pressure=pressure)
    b = bench.placement(at)
    fine = find(bench.problem(FINE, b), at)
    contact = float(read_states(fine.problem, fine.u[None], fine.loads[None], False)[0].numbers["contact"][0])
    rows = []
    for size in SIZES:
        problem = bench.problem(size, b)
        near = find(problem, at)
        for names in HELD:
            held = Held(names, tuple(float(getattr(fine, name)) for name in names))
            state = near if names == HELD[0] else find(problem, held, near, radius=0.1)
            if fine.converged and state.converged:
                seen = read_states(problem, state.u[None], state.loads[None], False)[0]
                plain = float(error_bound(seen.conserved_variation, seen.coefficient_tail)[0])
                rows.append(
                    {"size": size, "held": names, "contact": contact, "error": apart(state, fine, names)}
                    | {"estimate": estimated_error(state, held), "plain": plain}
                )
    return rows


def apart(state: Equilibrium, fine: Equilibrium, names: tuple[str, ...]) -> float:
    """Largest relative difference of what was not held."""
    p = fine.problem.p
    size = abs(fine.force) + np.pi * float(p.R0) ** 2 * abs(fine.pressure)
    sizes = {"force": size, "length": fine.length, "pressure": fine.pressure}
    return float(max(abs(getattr(state, k) - getattr(fine, k)) / v for k, v in sizes.items() if k not in names))


def report(rows: list[dict[str, Any]]) -> None:
    """The page."""
    lines = [
        "# Chambers that touch in part",
        "",
        "Written by `python validation/touching.py`. " + " ".join((__doc__ or "").split("\n\n")[2].split()),
        "",
        "Medians and largest values; `ratio` is the true error over its estimate, of force (over |F| + pi R0^2 P), "
        "length and pressure, whichever is not held; `without` is its largest value for an estimate without kinks.",
        "",
        "| muscles | held | unknowns | states | error | largest | ratio | largest | without |",
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for kind in KINDS:
        for names in HELD:
            for size in SIZES:
                some = [r for r in rows if (r["kind"], r["held"], r["size"]) == (kind, names, size)]
                some = [r for r in some if 0.0 < r["contact"] < 1.0]
                if some:
                    error, estimate, plain = (np.array([r[k] for r in some]) for k in ("error", "estimate", "plain"))
                    ratio, without = error / estimate, (error / plain).max()
                    lines.append(
                        f"| {kind} | {', '.join(names)} | {size} | {len(some)} | {np.median(error):.1e} | "
                        f"{error.max():.1e} | {np.median(ratio):.2f} | {ratio.max():.2f} | {without:.0f} |"
                    )
    PAGE.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", type=int, default=3)
    asked = parser.parse_args()
    rows = []
    for name, kind in KINDS.items():
        for one in states(kind, asked.count):
            rows += [row | {"kind": name} for row in looked_at(*one)]
            print(name, len(rows), flush=True)
        report(rows)


if __name__ == "__main__":
    main()

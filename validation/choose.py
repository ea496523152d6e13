"""The fixed subset of the random targets that the tests solve: tests/data/random_targets.json.

    python validation/choose.py

Stable states spread over the set, the ones with the largest error estimates, some that tip to one side (those where a
judge knows a stable state first), the quickest without a good state, and some that were once answered wrongly. Forces
and lengths are those of 144 unknowns, but for asymmetric and last good states.
"""

import json
from typing import Any

from environment import ROOT
from judges import placement
from random_muscles import done
from sample import FIRST, muscle_of
from summary import missed

from mckibben.solver.bench import Bench
from mckibben.solver.find import find
from mckibben.solver.held import Held

FILE = ROOT / "tests" / "data" / "random_targets.json"
FINEST = 144
OTHER = "found from another shape"
"""What the reason says of a state that the direct search does not find."""
EVEN, HARD, TIPPING, LOST = 25, 8, 3, 4
"""How many of each sort."""
ONCE_WRONG = (240, 286, 391, 755)
"""Cases that earlier versions called inadmissible, or whose last good state was not good to the tolerance."""


def chosen(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Rows of the subset."""
    by = {word: [row for row in rows if row["found"]["verdict"] == word] for word in ("stable", "unstable")}
    lost = sorted(
        (row for row in rows if row["found"]["verdict"] == "inadmissible"), key=lambda row: row["found"]["seconds"]
    )
    behind = [row for row in lost if "fitting" in row["found"]["reason"]][:1]
    tipping = sorted(by["unstable"], key=lambda row: row["case"]["id"] not in ids(missed(rows, "stable")))
    hard = sorted(by["stable"], key=lambda row: -row["found"]["error_estimate"])[:HARD]
    rest = [row for row in by["stable"] if row not in hard]
    even = rest[:: len(rest) // EVEN][:EVEN]
    picked = [*even, *hard, *tipping[:TIPPING], *lost[: LOST - 1], *behind]
    known = ids(picked)
    return picked + [row for row in rows if row["case"]["id"] in ONCE_WRONG and row["case"]["id"] not in known]


def ids(rows: list[dict[str, Any]]) -> set[int]:
    """Numbers of cases."""
    return {row["case"]["id"] for row in rows}


def entry(row: dict[str, Any]) -> dict[str, Any]:
    """One target with what is expected of it."""
    case, found = row["case"], row["found"]
    held = Held.of(**case["held"])
    expected: dict[str, Any] = {"verdict": found["verdict"]}
    if "asymmetric" in found:
        expected["asymmetric"] = found["asymmetric"]["force"]
    if found["verdict"] == "inadmissible":
        expected["last_good"] = {name: found["last_good"][name] for name in ("length", "force")}
    elif OTHER not in found["reason"]:
        bench = Bench.of(muscle_of(case))
        fine = find(bench.problem(FINEST, placement(bench, held)), held)
        assert fine.converged, case["id"]
        expected |= {"force": fine.force, "length": fine.length, "volume": fine.volume}
    return {**{name: case[name] for name in ("id", "ends", "kind", "muscle", "held")}, "expected": expected}


def main() -> None:
    entries = [entry(row) for row in chosen([row for _, row in sorted(done(FIRST).items())])]
    lines = ",\n  ".join(json.dumps(one) for one in entries)
    note = "Written by validation/choose.py: random muscles and targets, SI units, states on 144 unknowns."
    FILE.write_text(f'{{"note": "{note}",\n "targets": [\n  {lines}\n]}}\n', encoding="utf-8")
    print(len(entries), "targets in", FILE.relative_to(ROOT))


if __name__ == "__main__":
    main()

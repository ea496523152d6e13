"""Random muscles with random options: never a silent wrong number. Writes validation/random_options.md.

    python validation/random_options.py --count 300

Every muscle of the first sample is given options by chance: joints, fibres that stretch, a thick wall inside the braid,
fittings that give way. Each state that `solve` gives as good is judged without its multipliers: the work of the force
and pressure over a small change of length is that of the stored energy; and a solution to 1e-9 differs by no more than
the error estimate says.
"""

import argparse
import json
import subprocess
import sys
import warnings
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from sample import FIRST, draw, muscle_of

import mckibben as mk

PAGE = Path(__file__).with_name("random_options.md")
SEED = 20261128
STEP = 1e-4
"""Change of length for the work, over H0."""
WORK = 1e-4
"""Miss of the work over the size of the force that is called wrong; the step leaves some 1e-6."""
SAFETY = 3.0
"""True error over its estimate that is called wrong."""


def optional(k: int) -> tuple[mk.Muscle, dict[str, float], str]:
    """Case k: the muscle with its options, what is held, and the options in words."""
    case, rng = draw(k, FIRST), np.random.default_rng((SEED, k))
    muscle, said = muscle_of(case), []
    number = case["muscle"]
    if rng.random() < 0.5:
        fibre = mk.Fibre(diameter=number["d"], E=number["E"], nu=number["nu"], stretch=True)
        muscle, said = muscle.replace("braid.fibre", fibre), [*said, "stretch"]
    if rng.random() < 0.5:
        muscle, said = muscle.replace("braid.joint", "pin"), [*said, "pin"]
    if rng.random() < 0.5:
        law = mk.MooneyRivlin(c1=number["c1"], c2=number["c2"])
        wall = mk.Chamber(thickness=min(number["t0"], 0.4 * number["R0"]), law=law, lies="inside", wall="thick")
        muscle, said = muscle.replace("chamber", wall), [*said, "thick wall inside"]
    if rng.random() < 0.5:
        give = 10.0 ** rng.uniform(-8.0, -5.0)
        dead = float(rng.uniform(0.0, 0.1)) * number["H0"]
        muscle, said = muscle.replace("fittings", mk.Fittings(compliance=give, dead_length=dead)), [*said, "fittings"]
    more = float(muscle.rest_length) - number["H0"]
    length = float(rng.uniform(0.7 * number["H0"], 0.98 * case["longest"])) + more
    return muscle, {"length": length, "pressure": case["held"]["pressure"]}, " + ".join(said) or "none"


def judged(k: int) -> dict[str, Any]:
    """What came of case k."""
    muscle, held, said = optional(k)
    found: dict[str, Any] = {"id": k, "options": said}
    state = mk.solve(muscle, **held)
    found |= {"verdict": str(state.verdict)}
    if state.verdict not in ("stable", "unstable"):
        return found | {"nan": bool(np.isnan(state.force)), "reason": state.reason}
    step = STEP * float(muscle.braid.length)
    there, back = (mk.solve(muscle, length=held["length"] + s * step, pressure=held["pressure"]) for s in (1.0, -1.0))
    fine = mk.solve(muscle, tolerance=1e-9, **held)
    size = max(abs(state.force), abs(held["pressure"]) * np.pi * float(muscle.braid.radius) ** 2, 1e-3)
    estimate = float(state.data["error_estimate"].item())
    found |= {"estimate": estimate, "size": size, "force": state.force}
    if there.verdict == back.verdict == state.verdict:
        energy = [float(one.data["energy"].item()) for one in (there, back)]
        volume = [one.volume for one in (there, back)]
        by_work = (energy[0] - energy[1] - held["pressure"] * (volume[0] - volume[1])) / (2.0 * step)
        found["work"] = abs(by_work - state.force) / size
    if fine.verdict == state.verdict:
        found["error"] = abs(fine.force - state.force) / size
    return found


def written(rows: list[dict[str, Any]]) -> str:
    """The page."""
    lines = [
        "# Random muscles with random options", "",
        f"Written by `python validation/random_options.py --count {len(rows)}`; do not edit.", "",
        "Joints, fibres that stretch, a thick wall inside the braid and fittings (compliance and dead length), each "
        "with a chance of one half, on the muscles of the first sample; a length from 0.7 H0 to 0.98 of full extension "
        "is held.", "",
        "| options | count | stable | other verdicts | largest miss of the work | largest error over its estimate |",
        "| --- | --- | --- | --- | --- | --- |",
    ]  # fmt: skip
    for said in sorted({row["options"] for row in rows}):
        some = [row for row in rows if row["options"] == said]
        lines.append(f"| {said} | " + " | ".join(_cells(some)) + " |")
    lines.append("| all | " + " | ".join(_cells(rows)) + " |")
    wrong = [row for row in rows if row.get("work", 0.0) > WORK or _over(row) > SAFETY or row.get("nan") is False]
    crashes = [row for row in rows if row["verdict"] == "crash"]
    lines += [
        "", f"Silent wrong numbers (work off by more than {WORK:g}, error above {SAFETY:g} times its estimate, numbers "
        f"without a state): {len(wrong)}. Crashes: {len(crashes)}.", "",
    ]  # fmt: skip
    lines += [f"- case {row['id']} ({row['options']}): {json.dumps(row)}" for row in (*wrong, *crashes)]
    return "\n".join(lines).rstrip() + "\n"


def _over(row: dict[str, Any]) -> float:
    """True error over its estimate; the finer solution has rounding of 1e-9 of its own."""
    return max(row["error"] - 2e-9, 0.0) / row["estimate"] if "error" in row else 0.0


def _cells(rows: list[dict[str, Any]]) -> list[str]:
    verdicts = Counter(row["verdict"] for row in rows)
    others = ", ".join(f"{count} {name}" for name, count in verdicts.items() if name != "stable") or "none"
    work = max((row["work"] for row in rows if "work" in row), default=float("nan"))
    over = max((_over(row) for row in rows), default=float("nan"))
    return [str(len(rows)), str(verdicts["stable"]), others, f"{work:.1e}", f"{over:.2f}"]


def part(begin: int, count: int, every: int) -> None:
    """Cases begin, begin + every, ..., a line of JSON each."""
    warnings.simplefilter("ignore", mk.MuscleWarning)
    for k in range(begin, count, every):
        try:
            row = judged(k)
        except Exception as error:
            row = {"id": k, "options": optional(k)[2], "verdict": "crash", "reason": f"{type(error).__name__}: {error}"}
        print(json.dumps(row), flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--part", type=int, nargs=2, metavar=("BEGIN", "EVERY"), help="cases of one process, as JSON")
    given = parser.parse_args()
    if given.part:
        part(given.part[0], given.count, given.part[1])
        return
    command = [sys.executable, __file__, "--count", str(given.count), "--part"]
    running = [subprocess.Popen([*command, str(k), "2"], stdout=subprocess.PIPE, text=True) for k in range(2)]
    rows = [json.loads(line) for one in running for line in one.communicate()[0].splitlines()]
    PAGE.write_text(written(sorted(rows, key=lambda row: row["id"])), encoding="utf-8")
    print(PAGE.read_text(encoding="utf-8"))


if __name__ == "__main__":
    main()

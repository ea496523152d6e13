"""The page on random muscles that rub: what came of each check, and which cases fail."""

from pathlib import Path
from typing import Any

import numpy as np
from friction_options import CORNERS, EACH, LEG, SEED
from random_options import words

PAGE = Path(__file__).with_name("random_friction.md")
ROUGH = 1e-2
"""Tolerance of the run whose error estimate is judged."""
INSIDE = 0.02
"""Of the height between the sliding branches, by which a force may lie outside: they are told with the crossings next
to the fittings slipping the same way as all others."""

CHECKS = {
    "second law": "what was dissipated never falls",
    "way: balance": "work = stored + dissipated, on the way to the first corner",
    "minor loop: balance": "the same around the minor loop",
    "major loop: balance": "the same around the whole way",
    "minor loop: closes": "back in the state in which the minor loop began",
    "major loop: closes": "back in the state in which the whole way to and fro began",
    "minor loop: area": "area of the minor loop = dissipated",
    "major loop: area": "area of the whole way to and fro = dissipated",
    "finer": f"a call with a tolerance of {ROUGH:g}, within its error estimate",
    "steps": "twice as many steps, within the error estimates",
    "between": "force between the sliding branches",
    "zero: lost": "nothing dissipated with coefficients of zero",
    "zero: plain": "states with coefficients of zero are those without friction",
    "zero: back": "a chamber that slides freely comes back to its first state",
    "mirror": "turned around, the mirrored path",
}


def failures(row: dict[str, Any]) -> list[str]:
    """What is wrong with a case, in words."""
    found, said = row["found"], []
    if found.get("verdict") == "crash":
        said.append(f"crash: {found['reason']}")
    if "lost" in found:
        said.append(f"the same path in other steps or on other unknowns ends early: {found['lost']}")
    if "zero: ended" in found:
        said.append(f"with coefficients of zero {found['zero: ended']} of 3 corners are reached straight")
    if not found.get("kept", True):
        said.append("the part reached was not kept")
    if "kept" in found and found["plain"] == CORNERS[-1] + 1:
        said.append(f"{found['reached']} states reached, all without friction: {found['reason']}")
    for name, what in CHECKS.items():
        if not found.get(name, 0.0) <= 1.0:
            said.append(f"{what}: {found[name]:.1f} times what it may be off")
    return said


def report(rows: list[dict[str, Any]], about: str) -> None:
    """The page, which begins with what is checked."""
    whole = [row["found"] for row in rows if "steps" in row["found"]]
    ended = [row for row in rows if "kept" in row["found"]]
    lines = [
        "# Random muscles that rub",
        "",
        "Written by `python validation/random_friction.py`. " + " ".join(about.split()),
        "",
        f"{len(rows)} muscles, {len({str(row['case']['options']) for row in rows})} combinations of options (one for "
        f"{EACH} muscles each; seed {SEED}), {sum(row['case']['slides'] for row in rows)} with a chamber that slides. "
        "Each path goes to a corner, back in part, to the corner again, back to where it began, and once more to the "
        f"corner and back, in {LEG} steps each; {len(whole)} were reached whole, {len(ended)} end early.",
        "",
        "What a check may be off is the error that is told; of work, how much it and what is stored and dissipated "
        f"change with twice as many steps in addition; of the branches {INSIDE:.0%} of the height between them.",
        "",
        "| check | paths | median | largest | beyond it |",
        "| --- | --- | --- | --- | --- |",
    ]
    for name, what in CHECKS.items():
        off = np.array([abs(max(found[name], 0.0)) for found in whole if name in found])
        if len(off):
            lines.append(f"| {what} | {len(off)} | {np.median(off):.1e} | {off.max():.1e} | {int((off > 1.0).sum())} |")
    if whole:
        lost = [100.0 * found["major loop: lost"] for found in whole]
        heights = [100.0 * found["height"] for found in whole if "height" in found]
        lines += [
            "",
            f"Friction took {np.median(lost):.2g} % of the work to and fro in the median, {max(lost):.2g} % at most; "
            f"the height between the sliding branches is {np.median(heights):.2g} % of the load in the median and "
            f"{max(heights):.2g} % at most. Error estimates are {np.median([f['estimate'] for f in whole]):.0e} in the "
            f"median and {max(f['estimate'] for f in whole):.0e} at most.",
        ]
    on: dict[str, int] = {}
    for row in rows:
        for word in [*words(row["case"]["options"]).split(", "), row["case"]["test"]]:
            on[word] = on.get(word, 0) + 1
    lines += ["", "How often each option was there: " + ", ".join(f"{k} {n}" for k, n in sorted(on.items())) + "."]
    if ended:
        lines += [
            "",
            "| case | test | states reached | without friction stable | why |",
            "| --- | --- | --- | --- | --- |",
        ]
        lines += [
            f"| {row['case']['id']} | {row['case']['test']} | {row['found']['reached']} of {CORNERS[-1] + 1} | "
            f"{row['found']['plain']} | {row['found']['reason']} |"
            for row in ended
        ]
    bad = [(row, failures(row)) for row in rows if failures(row)]
    lines += ["", f"{len(bad)} muscles with a check that failed."]
    if bad:
        lines += ["", "| case | options | test | what failed |", "| --- | --- | --- | --- |"]
        for row, said in bad:
            options = words(row["case"]["options"]) + (", sliding" if row["case"]["slides"] else "")
            lines.append(f"| {row['case']['id']} | {options} | {row['case']['test']} | {'; '.join(said)} |")
    PAGE.write_text("\n".join(lines) + "\n", encoding="utf-8")

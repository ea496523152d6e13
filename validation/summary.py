"""The report on the random muscles: validation/README.md with its tables, and the two pictures."""

import json
from typing import Any

import numpy as np
from environment import OUT, ROOT
from pictures import draw_errors, draw_map
from random_muscles import is_reached, is_stable, is_told
from sample import SEED, SHARES
from sections import kept

TOLERANCE = 1e-10
"""Residual below which a state counts as converged."""
ERRORS = OUT / "error_estimate.json"
README = ROOT / "validation" / "README.md"
QUANTILES = (0.5, 0.9, 0.95, 0.99, 1.0)

Row = dict[str, Any]


def write(rows: list[Row]) -> None:
    """README and pictures from the results."""
    here = README.parent
    text = [INTRODUCTION.format(count=len(rows), seed=SEED, shares=_shares()), *_reach(rows), *_trust(rows)]
    text += [*_times(rows), *_bad(rows)]
    draw_map(rows, here / "random_muscles.png")
    text += ["", "![verdicts](random_muscles.png)"]
    if ERRORS.exists():
        errors = json.loads(ERRORS.read_text(encoding="utf-8"))
        draw_errors(errors, here / "error_estimate.png")
        text += [*_errors(errors), "", "![estimate against true error](error_estimate.png)"]
    README.write_text("\n".join([*text, *kept()]) + "\n", encoding="utf-8")


INTRODUCTION = """# Validation on random muscles

Written by `python validation/random_muscles.py` and `python validation/error_estimate.py`; do not edit.

{count} random muscles with one target each ({shares}; seed {seed};
ranges in `validation/sample.py`), each given to `mk.solve` with nothing but its target. A target counts as reachable if
the default call or any of the judges finds a converged state of admissible shape that is stable there. The judges
(`validation/judges.py`) are asked wherever the default call gave no stable state: two long paths (pressure first,
pressure last; 2 x 24 states) and six searches from random shapes."""


def _shares() -> str:
    return ", ".join(f"{share:.0%} {kind}" for kind, share in SHARES.items())


def missed(rows: list[Row], word: str) -> list[Row]:
    """Targets where a judge has a state that is `good`, or even `stable`, and the default call has none that is."""
    lost = [row for row in rows if not (is_reached(row) or is_stable(row) if word == "good" else is_stable(row))]
    return [row for row in lost if any(one[word] for one in row.get("judges", NOBODY)["worth"].values())]


NOBODY: Row = {"worth": {}}


NAMED = """A state that gives way to one side, to no admissible shape, holds nothing. Where only other starts find such
a state the call says inadmissible and names it, as the reference cases do (T403c: "no admissible state")."""


def table(head: list[str], lines: list[list[Any]]) -> list[str]:
    """Rows of a Markdown table, after an empty line."""
    cells = [head, ["---"] * len(head), *lines]
    return ["", *("| " + " | ".join(str(cell) for cell in line) + " |" for line in cells)]


def _reach(rows: list[Row]) -> list[str]:
    good = [row for row in rows if is_reached(row)]
    stable, strict, loose = sum(is_stable(row) for row in rows), missed(rows, "stable"), missed(rows, "good")
    unasked = sum(row["found"]["verdict"] != "stable" and "judges" not in row for row in rows)
    verdicts = ("stable", "unstable", "inadmissible", "not converged", "no equilibrium", "crash")
    lines = []
    for kind in (*SHARES, "all"):
        of = [row for row in rows if kind in ("all", row["case"]["kind"])]
        lines.append([kind, len(of), *(sum(row["found"]["verdict"] == word for row in of) for word in verdicts)])
    told = sum(is_told(row) for row in loose)
    said = [
        [name, reached, rest, f"{reached / (reached + rest):.2%}"]
        for name, reached, rest in (
            ("stable in all modes, as given or as what it tips to", stable, len(strict)),
            ("stable in the symmetric modes, as given", len(good), len(loose)),
            ("... or named in the reason as unstable, without its numbers", len(good) + told, len(loose) - told),
        )
    ]
    head = ["state", "reached by the default call", "reached only by a judge", "share"]
    note = ["", NAMED, *(["", f"{unasked} targets were not yet judged."] if unasked else [])]
    return ["", "## Reach", *table(head, said), *table(["target", "count", *verdicts], lines), *note]


def _trust(rows: list[Row]) -> list[str]:
    good = [row["found"] for row in rows if row["found"]["verdict"] in ("stable", "unstable")]
    good += [row["found"]["asymmetric"] | {"miss": 0.0} for row in rows if "asymmetric" in row["found"]]
    last = [row["found"]["last_good"] for row in rows if "last_good" in row["found"]]
    lost = sum(not is_stable(row) for row in rows)
    largest = {name: max(found[name] for found in good) for name in ("residual", "miss", "error_estimate")}
    above = sum(found["residual"] > TOLERANCE or found["miss"] > TOLERANCE for found in good)
    lines = [
        ["states given as good whose residual or miss of the target is above 1e-10", above],
        ["largest residual; largest relative miss", f"{largest['residual']:.1e}; {largest['miss']:.1e}"],
        ["good states whose error estimate is above the tolerance 1e-6", sum(f["error_estimate"] > 1e-6 for f in good)],
        ["largest error estimate of a good state", f"{largest['error_estimate']:.1e}"],
        ["calls without a stable state; with a last good state instead", f"{lost}; {len(last)}"],
        ["last good states judged stable, with residual below 1e-10", sum(_sound(one) for one in last)],
        [
            "... found again by a fresh search on 96 or 256 unknowns, to 1e-6",
            sum(one["difference"] < 1e-6 for one in last),
        ],
    ]
    return ["", "## Trust", *table(["check", "result"], lines)]


def _sound(last: dict[str, Any]) -> bool:
    return last["verdict"] == "stable" and last["residual"] < TOLERANCE


def _times(rows: list[Row]) -> list[str]:
    groups = {
        "stable": [row for row in rows if row["found"]["verdict"] == "stable"],
        "unstable": [row for row in rows if row["found"]["verdict"] == "unstable"],
        "no good state": [row for row in rows if row["found"]["verdict"] not in ("stable", "unstable", "crash")],
    }
    lines = []
    for name, of in groups.items():
        seconds = [row["found"]["seconds"] for row in of]
        if seconds:
            lines.append([name, len(of), *(f"{np.quantile(seconds, q):.3f}" for q in QUANTILES)])
    head = ["verdict", "count", *(f"{q:.0%}" for q in QUANTILES)]
    said = "Seconds of the default call, compiled, two processes side by side on a shared machine. Without a good "
    said += "state the call looks for the end of the branch."
    return ["", "## Time", "", said, *table(head, lines)]


def _bad(rows: list[Row]) -> list[str]:
    lines = []
    for word in ("stable", "good"):
        for row in missed(rows, word):
            found, case, worth = row["found"], row["case"], row["judges"]["worth"]
            h = case["held"].get("length", np.nan) / case["muscle"]["H0"]
            ways = [name for name, one in worth.items() if one[word]]
            best = worth[ways[0]]
            lines.append([case["id"], case["ends"], f"{h:.3f}", f"{case['held']['pressure'] / 1e5:.3f}",
                          found["verdict"], f"{found['force']:.4g}", ", ".join(ways), f"{best['force']:.4g}",
                          best["why"]])  # fmt: skip
    if not lines:
        return []
    head = [
        "case",
        "ends",
        "h/H0",
        "P (bar)",
        "verdict",
        "its force (N)",
        "reached by",
        "with (N)",
        "the judge's state",
    ]
    return ["", "## Reached only by a judge", *table(head, lines)]


def _errors(errors: list[Row]) -> list[str]:
    errors = [row for row in errors if row["converged"]]
    groups = {f"{size} unknowns": [row for row in errors if row["size"] == size] for size in (12, 24, 48, 96)}
    groups |= {"the size that the default call ends with": _ended(errors), "every size": errors}
    lines = []
    for name, of in groups.items():
        below = [row for row in of if row["natural"] > max(row["estimate"], FLOOR)]
        wrong = [row for row in of if row["estimate"] <= 1e-6 < row["natural"]]
        factor = max((row["natural"] / row["estimate"] for row in below), default=0.0)
        over = [row["estimate"] / row["natural"] for row in of if row["natural"] > FLOOR]
        typical = f"{np.median(over):.0f}" if over else ""
        largest = f"{max(row['natural'] for row in of):.1e}"
        lines.append([name, len(of), len(below), f"{factor:.1f}" if below else "", typical, largest, len(wrong)])
    head = ["states on", "count", "estimate below the true error", "by at most", "median estimate over error",
            "largest true error", "estimate below 1e-6 and error not"]  # fmt: skip
    return ["", "## The error estimate", "", ERROR_TEXT, *table(head, lines)]


def _ended(errors: list[Row]) -> list[Row]:
    """Of each state, the size with which the default call is content."""
    by: dict[int, list[Row]] = {}
    for row in errors:
        if row["size"] > 12:
            by.setdefault(row["id"], []).append(row)
    return [next((row for row in of if row["estimate"] <= 1e-6), of[-1]) for of in by.values()]


FLOOR = 1e-11
"""Relative differences below this are rounding."""

ERROR_TEXT = """The true error is the difference to 144 unknowns, over |F| + pi R0^2 P for a force and the length for
a length; below 1e-11 it is rounding. Half of the states are those with the largest estimates. 12 unknowns serve only
where a tolerance of 1e-4 or more is asked for."""

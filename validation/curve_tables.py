"""The tables on random curves."""

import math
from textwrap import fill
from typing import Any

import numpy as np
from summary import table

GOOD = ("stable", "unstable")
ROUNDING = 1e-9
"""Relative difference beyond the stated errors that two states may have."""
BOUNDS = {"state": 5.0, "curve": 10.0}
"""Seconds asked for at most, at 99%, of what fails."""

WAYS = ("run", "sweep")

Row = dict[str, Any]


def targets(case: Row) -> list[dict[str, float]]:
    """What each state of a curve holds."""
    return [
        {name: value[k] if isinstance(value, list) else value for name, value in case["test"].items()}
        for k in range(case["points"])
    ]


def compared(row: Row, way: str) -> list[Row]:
    """Every state of a curve by one way beside the single call."""
    found, case, lines = row[way], row["case"], []
    for k, (held, alone) in enumerate(zip(targets(case), row["solve"], strict=True)):
        other, word = "force" if "length" in held else "length", found["verdict"][k]
        size = alone["length"]
        if other == "force":
            size = abs(alone["force"]) + math.pi * case["muscle"]["R0"] ** 2 * held["pressure"]
        both = word in GOOD and alone["verdict"] in GOOD
        difference = abs(found[other][k] - alone[other]) / size if both else 0.0
        stated = found["error_estimate"][k] + alone["error_estimate"] + ROUNDING if both else 0.0
        lines.append({
            "kind": case["kind"], "at": f"{case['id']}: {k}", "ends": case["ends"], "held": held, "way": way,
            "word": word, "alone": alone["verdict"], "other": other, "value": found[other][k],
            "by solve": alone[other], "reason": alone["reason"], "wrong": difference > stated,
        })  # fmt: skip
    return lines


def report(rows: list[Row]) -> list[str]:
    """The section of the page."""
    crashed = [row for row in rows if "crash" in row]
    rows = [row for row in rows if "crash" not in row]
    lines = {way: [line for row in rows if way in row for line in compared(row, way)] for way in WAYS}
    lines = {way: of for way, of in lines.items() if of}
    swept = sum("sweep" in row for row in rows)
    text = [
        "",
        *fill(
            SAID.format(count=len(rows), states=len(lines["run"]), crashed=len(crashed), swept=swept), 120
        ).splitlines(),
    ]
    for way, of in lines.items():
        text += table(
            [f"by `{way}`", *HEAD], [_counts(kind, of) for kind in [*dict.fromkeys(r["kind"] for r in of), "all"]]
        )
    differing = [line for of in lines.values() for line in of if line["word"] != line["alone"] or line["wrong"]]
    head = ["curve: state", "by", "ends", "held", "verdict", "number", "by `solve`", "number", "its reason"]
    text += table(head, [_said(line) for line in differing]) if differing else ["", "No state differs."]
    return [*text, "", *fill(TIMES, 120).splitlines(), *_times(rows)]


SAID = """Written by `python validation/curves.py`. {count} random curves ({states} states in all; {crashed} crashes) of
the muscles of `validation/sample.py`: lengths of 0.5 H0 to 0.99 of full extension, forces ordinary and up to twice as
far beyond that range as it is wide, of both signs. Each is given to `mk.run`, {swept} of them to `mk.sweep`, too, and
every state alone to `mk.solve`. Numbers differ where the force (over |F| + pi R0^2 P) or the length does by more than
the two error estimates together."""

TIMES = """Seconds of the calls with everything compiled (what took more than 5 s was made twice), two processes side by
side on a busy machine; processor seconds are those without the waiting. A curve fails where one of its states has no
admissible equilibrium. Asked for at 99%: 5 s for a state that fails, 10 s for a curve."""

HEAD = ["curves' states", "stable by `solve`", "of these reached", "share", "stable here only", "another verdict",
        "other numbers"]  # fmt: skip


def _counts(kind: str, lines: list[Row]) -> list[Any]:
    of = [line for line in lines if kind in ("all", line["kind"])]
    stable = [line for line in of if line["alone"] == "stable"]
    reached = sum(line["word"] == "stable" for line in stable)
    more = sum(line["word"] == "stable" != line["alone"] for line in of)
    differ, wrong = sum(line["word"] != line["alone"] for line in of), sum(line["wrong"] for line in of)
    share = f"{reached / len(stable):.2%}" if stable else ""
    return [kind, len(of), len(stable), reached, share, more, differ, wrong]


def _said(line: Row) -> list[Any]:
    held = ", ".join(f"{name} {value:.6g}" for name, value in line["held"].items())
    return [line["at"], line["way"], line["ends"], held, line["word"], f"{line['value']:.6g}", line["alone"],
            f"{line['by solve']:.6g}", line["reason"].replace("|", "/")]  # fmt: skip


def _fails(found: Row) -> bool:
    return any(word not in GOOD for word in found["verdict"])


def _times(rows: list[Row]) -> list[str]:
    """Times of curves and of states, whole and failing."""
    states = [state for row in rows for state in row["solve"]]
    bad = [state["verdict"] not in GOOD for state in states]
    groups = {
        f"{word} by `{way}`": [row[way] for row in rows if way in row and _fails(row[way]) == failing]
        for way in WAYS
        if any(way in row for row in rows)
        for word, failing in (("complete curve", False), ("failing curve", True))
    }
    groups |= {
        f"{word} by `solve`": [state for state, fail in zip(states, bad, strict=True) if fail == failing]
        for word, failing in (("good state", False), ("failing state", True))
    }
    lines = []
    for name, of in groups.items():
        clocks = [[one[clock] for one in of] for clock in ("seconds", "processor")]
        quantiles = [f"{np.quantile(values, q):.2f}" if of else "" for values in clocks for q in (0.5, 0.99, 1.0)]
        above = ""
        if "failing" in name:
            above = sum(one["processor"] > BOUNDS["curve" if "curve" in name else "state"] for one in of)
        lines.append([name, len(of), *quantiles, above])
    head = ["what", "count", "50%", "99%", "100%", "processor 50%", "99%", "100%", "processor above what is asked for"]
    return table(head, lines)

"""The report on the random muscles: validation/README.md with its tables, and the pictures."""

from textwrap import fill
from typing import Any

import numpy as np
from pictures import draw_map
from random_muscles import is_reached, is_stable, is_told
from sample import Sample
from sections import README, kept

TOLERANCE = 1e-10
"""Residual below which a state counts as converged."""
QUANTILES = (0.5, 0.9, 0.95, 0.99, 1.0)
BOUND = 5.0
"""Seconds asked for at most, at 99%, of a target without a good state."""

Row = dict[str, Any]


def write(samples: dict[Sample, list[Row]]) -> None:
    """README and pictures from the results."""
    text = [INTRODUCTION]
    for sample, rows in samples.items():
        if not rows:
            continue
        shares = ", ".join(f"{share:.0%} {kind}" for kind, share in sample.shares.items())
        said = SAID.format(count=len(rows), shares=shares, seed=sample.seed, name=sample.name)
        text += ["", f"## {sample.title}", "", fill(f"{said} {sample.said}", 120)]
        text += [*_reach(sample, rows), *_trust(rows), *_times(rows), *_bad(rows)]
        picture = f"random_muscles_{sample.name}.png"
        draw_map(rows, README.parent / picture)
        text += ["", f"![verdicts]({picture})"]
    README.write_text("\n".join([*text, *kept()]) + "\n", encoding="utf-8")


INTRODUCTION = """# Validation on random muscles

Every section is written by the script that it names; do not edit.

Each target is given to `mk.solve` with nothing else. It counts as reachable if the default call or any of the judges
finds a converged state of admissible shape that is stable there. The judges (`validation/judges.py`) are asked wherever
the default call gave no stable state: two long paths (pressure first, pressure last; 2 x 24 states) and six searches
from random shapes.

Pages of their own: [random options](random_options.md), whether any combination of effects gives a wrong number;
[random friction](random_friction.md), the same of muscles that rub, along closed paths; [chambers that touch in
part](touching.md), [programmed braids](programmed.md) and [paths with friction](friction_steps.md), whether the error
estimate covers the true error; [fits](recovery.md), whether intervals hold the truth."""

SAID = """{count} random muscles with one target each ({shares}; seed {seed}; ranges in `validation/sample.py`), by
`python validation/random_muscles.py --sample {name}`."""


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


def _reach(sample: Sample, rows: list[Row]) -> list[str]:
    good = [row for row in rows if is_reached(row)]
    stable, strict, loose = sum(is_stable(row) for row in rows), missed(rows, "stable"), missed(rows, "good")
    unasked = sum(row["found"]["verdict"] != "stable" and "judges" not in row for row in rows)
    verdicts = ("stable", "unstable", "inadmissible", "not converged", "no equilibrium", "crash")
    lines = []
    for kind in (*sample.shares, "all"):
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
    return ["", "### Reach", *table(head, said), *table(["target", "count", *verdicts], lines), *note]


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
    return ["", "### Trust", *table(["check", "result"], lines), *_not_again(rows)]


def _not_again(rows: list[Row]) -> list[str]:
    """The last good states that a fresh search does not find to 1e-6."""
    lines = []
    for row in rows:
        last = row["found"].get("last_good")
        if last is not None and not last["difference"] < 1e-6:
            found = [f"{last[name]:.6g}" for name in ("length", "force")]
            sizes = [f"{last[name]:.1e}" for name in ("error_estimate", "difference")]
            lines.append([row["case"]["id"], *found, *sizes, last["again"]["why"]])
    head = ["last good state of", "length (m)", "force (N)", "error estimate", "difference", "a fresh search finds"]
    return table(head, lines) if lines else []


def _sound(last: dict[str, Any]) -> bool:
    return last["verdict"] == "stable" and last["residual"] < TOLERANCE


def _times(rows: list[Row]) -> list[str]:
    verdicts = {"stable": ("stable",), "unstable": ("unstable",)}
    verdicts["no good state"] = ("inadmissible", "not converged", "no equilibrium")
    lines = []
    for name, words in verdicts.items():
        of = [row["found"] for row in rows if row["found"]["verdict"] in words]
        for clock, said in (("seconds", "clock"), ("processor", "processor")):
            seconds = [found[clock] for found in of]
            if seconds:
                above = sum(value > BOUND for value in seconds)
                lines.append([name, said, len(of), *(f"{np.quantile(seconds, q):.3f}" for q in QUANTILES), above])
    head = ["verdict", "seconds", "count", *(f"{q:.0%}" for q in QUANTILES), f"above {BOUND:.0f} s"]
    again = sum("again" in row["found"] for row in rows)
    once = sum(row["found"].get("processor", 0.0) > BOUND and "again" not in row["found"] for row in rows)
    return ["", "### Time", "", *fill(TIMES.format(again=again, once=once), 120).splitlines(), *table(head, lines)]


TIMES = """Seconds of the default call, two processes side by side on a busy machine; those of the processor leave out
the waiting. Of what took more than 5 s, {again} calls were timed again with everything compiled; {once} were not, and
hold what was compiled in them. Without a good state the call looks for the end of the branch; 5 s is asked for at
99%."""


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
    head = ["case", "ends", "h/H0", "P (bar)", "verdict", "its force (N)", "reached by", "with (N)",
            "the judge's state"]  # fmt: skip
    return ["", "### Reached only by a judge", *table(head, lines)]

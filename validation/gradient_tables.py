"""The tables on derivatives."""

from textwrap import fill
from typing import Any

import numpy as np
from summary import table

KINDS = ("isometric", "isobaric", "isotonic", "free contraction", "blocked force", "volume held", "sealed gas")
SMALL = 1e-3
"""Slopes below this share of a result's largest one are held against that share."""
LIMIT = 1e-5
"""Relative difference above which a slope is listed."""
RESULTS = ("length", "force", "pressure", "volume", "energy", "energy_chamber", "peak_fibre_tension", "largest_radius")


def compared(row: dict[str, Any]) -> list[dict[str, Any]]:
    """Every slope with its relative difference."""
    lines = []
    for name, found in row["slopes"].items():
        by, difference, doubt, fine = (np.array(found.get(key, found["by"])) for key in KEYS)
        size = np.maximum(np.abs(by), SMALL * np.maximum(np.abs(by).max(axis=1, keepdims=True), 1.0))
        relative, doubtful, again = abs(by - difference) / size, doubt / size, abs(fine - difference) / size
        for at in np.ndindex(by.shape):
            lines.append({
                "id": row["id"], "kind": row["kind"], "ends": row["ends"], "result": name, "state": at[0],
                "number": row["numbers"][at[1]], "by": by[at], "difference": difference[at],
                "relative": float(relative[at]), "doubt": float(doubtful[at]), "fine": float(again[at]),
            })  # fmt: skip
    return lines


KEYS = ("by", "difference", "doubt", "fine")


def wrong(line: dict[str, Any], key: str) -> bool:
    """Whether a slope differs by more than the limit, and by more than the doubt of the differences explains."""
    return bool(line[key] > max(LIMIT, 3.0 * line["doubt"]))


def report(rows: list[dict[str, Any]]) -> list[str]:
    """The section of the page."""
    lines, slopes = [], [line for row in rows if row["slopes"] for line in compared(row)]
    for kind in (*KINDS, "all"):
        mine = [row for row in rows if kind in ("all", row["kind"])]
        of = [line for line in slopes if kind in ("all", line["kind"])]
        solved = sum(row["slopes"] is not None for row in mine)
        lines.append([kind, len(mine), sum("crash" in row for row in mine), solved, *_numbers(of)])
    results = [[name, *_numbers([line for line in slopes if line["result"] == name])] for name in RESULTS]
    worst = sorted((line for line in slopes if wrong(line, "relative")), key=lambda line: -line["relative"])[:LISTED]
    listed = [
        [line["id"], line["kind"], line["ends"], f"{line['result']} by {line['number']}", f"{line['by']:.8g}",
         f"{line['difference']:.8g}", f"{line['relative']:.1e}", f"{line['doubt']:.1e}", f"{line['fine']:.1e}"]
        for line in worst
    ]  # fmt: skip
    lost = [row for row in rows if row.get("finite") is False]
    told = sum(row["told"] for row in lost)
    tipping = sum(row.get("stable") is False for row in rows)
    away = sum(row.get("lost", False) for row in rows)
    counts = {"count": len(rows), "lost": len(lost), "told": told, "tipping": tipping, "away": away}
    said = SAID.format(results=", ".join(RESULTS), **counts)
    text = fill(said, 120)
    out = ["", *text.splitlines(), *table(["test", "muscles", "crashes", "with both states", *HEAD], lines)]
    out += table(["result", *HEAD], results)
    if any(wrong(line, "fine") for line in slopes):
        out += ["", *fill(PEAKS, 120).splitlines()]
    return [*out, "", "The largest differences beyond doubt:", *table(LAST, listed)] if listed else out


LISTED = 12
PEAKS = """What is left with a tolerance of 1e-10 is no error of the states. It is in slopes next to zero, where the
differences show how volumes held near full extension and energies at rest round; and in the largest tension and radius,
those of the series through the points of the mesh (`measure/peak.py`), which the tolerance does not look at."""
HEAD = ["slopes", "median difference", "99.9%", "largest", "above 1e-5", "beyond doubt", "also with 1e-10"]
LAST = ["muscle", "test", "ends", "slope", "derivative", "by differences", "difference", "doubt", "with 1e-10"]


def _numbers(of: list[dict[str, Any]]) -> list[Any]:
    """What is counted of slopes."""
    if not of:
        return [0] + [""] * (len(HEAD) - 1)
    relative = np.array([line["relative"] for line in of])
    above, sure, still = (
        sum(line["relative"] > LIMIT for line in of), sum(wrong(line, "relative") for line in of),
        sum(wrong(line, "fine") for line in of),
    )  # fmt: skip
    quantiles = [f"{np.quantile(relative, q):.1e}" for q in (0.5, 0.999, 1.0)]
    return [len(of), *quantiles, above, sure, still]


SAID = """Written by `python validation/gradients.py`. {count} random muscles (`validation/sample.py`) with a test of
two states each. The derivatives of the default call of `mk.response` by every number of the muscle and of the test
(`jax.jacfwd`) of {results}, as per cent per per cent, against central differences of the same call with a tolerance of
1e-10: three steps, each half of the last, so small that no result changes by more than about 0.1%, and the two pairs
extrapolated (Richardson). How far the two extrapolations lie apart is the doubt of the differences; what is less than
three times that is not held against the derivatives. A difference is relative to the slope, or to 1/1000 of the largest
slope of the same result (at least 1) where that is more. Where a muscle's derivatives differ by more than 1e-5, those
of a call with a tolerance of 1e-10 are compared too: what is gone then was the error of the discretisation. Of {lost}
muscles a state was not reached; {told} of these have derivatives that are not finite, as they should. Of {tipping} more
`mk.run` calls a state unstable or inadmissible: a step may tip it over, so these are left out. Of {away} a step of the
differences, or the way to the derivatives, lost a state that is there: nothing wrong is told, and they are left out."""

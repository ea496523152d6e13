"""Measure, print a table, and write out/bench.json and out/bench.png: `make bench`.

Every time hangs on the machine and on what else it does. What counts are the ratios of rows measured in the same run.
"""

import json
from pathlib import Path
from typing import Any

import command
import curve
import peer
from timing import machine

from mckibben.app import cache
from mckibben.view import style

OUT = Path(__file__).parent.parent / "out"


def main() -> None:
    """Everything, in two minutes or so of processor time."""
    about = machine()
    cache.use()  # what an earlier run compiled is not compiled again: it is not part of any time but the commands'
    exact = curve.reference()
    rows = curve.measure(exact) + curve.measure_others(exact) + peer.measure(exact) + command.measure()
    following = next(row for row in rows if row["name"].startswith("following alone, 24"))
    unit = following["processor_s"] / following["states"]
    for row in rows:
        row["ratio"] = row["processor_s"] / row["states"] / unit
    OUT.mkdir(exist_ok=True)
    report = {"machine": about, "test": "case a: 115 mm, 0 to 1 bar, preset paper", "rows": rows}
    (OUT / "bench.json").write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")
    show(rows)
    picture(rows)
    print(f"{OUT.name}/bench.json, {OUT.name}/bench.png")


def show(rows: list[dict[str, Any]]) -> None:
    """The table, as Markdown."""
    print("| what | states | time | processor time | ratio | error of the force |")
    print("|---|---|---|---|---|---|")
    for row in rows:
        off = "" if row["error"] is None else f"{row['error']:.1e}"
        times = f"{written(row['median_s'])} | {written(row['processor_s'])} | {row['ratio']:.2g}"
        print(f"| {row['name']} | {row['states']} | {times} | {off} |")
    print("time: median on the clock; processor time: of all threads, which other work on the machine disturbs less")
    print("ratio: processor time per state over that of following alone with 24 unknowns, in this run")
    print(f"error: largest, over the largest force of the curve, against {curve.EXACT} unknowns")


def written(seconds: float) -> str:
    """A time with a unit that people read."""
    for size, unit in ((1.0, "s"), (1e-3, "ms")):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds * 1e6:.3g} µs"


def picture(rows: list[dict[str, Any]]) -> None:
    """Error against processor time per state."""
    figure = style.new_figure(style.PAGE, 3.2)
    axes = figure.add_subplot()
    shown = [row for row in rows if row["error"] is not None]
    for k, row in enumerate(shown):
        colour, mark = style.LINES[k % len(style.LINES)], "os^D"[k // len(style.LINES)]
        axes.plot(
            1e3 * row["processor_s"] / row["states"], row["error"], mark, color=colour, markersize=5, label=row["name"]
        )
    axes.set(xscale="log", yscale="log", xlabel="Processor time per state (ms)", ylabel="Error of the force, relative")
    style.tidy(axes)
    axes.legend(fontsize=style.TICK - 0.5, frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))
    style.note(
        figure, "Case a of the paper, everything compiled; one machine, one run: compare only points in the picture."
    )
    style.save(figure, OUT / "bench", ("png",))


if __name__ == "__main__":
    main()

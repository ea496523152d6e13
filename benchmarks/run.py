"""Measure, print tables, and write out/bench.json, out/bench.png and out/scaling.png: `make bench`.

Every time hangs on the machine and on what else it does. What counts are the ratios of rows measured in the same run.
`python benchmarks/run.py --quick` leaves out how cost grows, which takes minutes.
"""

import json
import sys
from pathlib import Path
from typing import Any

import batch
import command
import curve
import effects
import numpy as np
import others
import peer
import scaling
import tools
from matplotlib.ticker import NullFormatter
from timing import machine

from mckibben.view import style

OUT = Path(__file__).parent.parent / "out"


def main() -> None:
    """Everything, in some minutes."""
    about = machine()
    exact = curve.reference()
    rows = curve.measure(exact) + batch.measure() + curve.measure_others(exact)
    rows += effects.measure() + tools.measure()
    rows += others.measure(exact) + peer.measure(exact) + command.measure()
    following = next(row for row in rows if row["name"].startswith("following alone, 24"))
    unit = following["processor_s"] / following["states"]
    for row in rows:
        row["ratio"] = row["processor_s"] / row["states"] / unit
    OUT.mkdir(exist_ok=True)
    report = {"machine": about, "test": "case a: 115 mm, 0 to 1 bar, preset paper", "rows": rows}
    if "--quick" not in sys.argv:
        report["scaling"] = scaling.measure()
        report["cluster"] = scaling.cluster(report["scaling"]["sweeps"])
    (OUT / "bench.json").write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")
    show(rows)
    picture(rows)
    if "scaling" in report:
        show_growth(report["scaling"], report["cluster"])
        picture_growth(report["scaling"])
    print(f"{OUT.name}/bench.json, {OUT.name}/bench.png" + (f", {OUT.name}/scaling.png" if "scaling" in report else ""))


def show(rows: list[dict[str, Any]]) -> None:
    """The table, as Markdown."""
    print("| what | states | cold | time | processor time | ratio | error of the force |")
    print("|---|---|---|---|---|---|---|")
    for row in rows:
        off = "" if row["error"] is None else f"{row['error']:.1e}"
        times = f"{written(row['median_s'])} | {written(row['processor_s'])} | {row['ratio']:.2g}"
        cold = written(row["cold_s"]) if "cold_s" in row else ""
        print(f"| {row['name']} | {row['states']} | {cold} | {times} | {off} |")
    for row in rows:
        if "curves_per_s" in row:
            print(f"{row['name']}: {row['curves_per_s']:.0f} curves/s")
    print("cold: the first call in this process, which compiles what no row above needed")
    print("time: median on the clock; processor time: of all threads, which other work on the machine disturbs less")
    print("ratio: processor time per state over that of following alone with 24 unknowns, in this run")
    print(f"error: largest, over the largest force of the curve, against {curve.EXACT} unknowns")


def show_growth(growth: dict[str, Any], cluster: dict[str, float]) -> None:
    """How cost grows, as Markdown."""
    print("\n| one curve: unknowns | states | time |\n|---|---|---|")
    for row in growth["unknowns"] + growth["states"]:
        print(f"| {row['unknowns']} | {row['states']} | {written(row['least_s'])} |")
    print("\n| muscles in step | time per curve |\n|---|---|")
    for row in growth["together"]:
        print(f"| {row['muscles']} | {written(row['least_s'])} |")
    print("\n| designs | workers | time | designs/s | singly | memory of the client | of a worker | store |")
    print("|---|---|---|---|---|---|---|---|")
    for row in growth["sweeps"]:
        sizes = f"{row['client_mb']:.0f} MB | {row['worker_mb']:.0f} MB | {row['store_mb']:.0f} MB"
        share = f"{100.0 * row['single']:.1f} %"
        cold = " (cold)" if row["cold"] else ""
        head = f"| {row['designs']} | {row['workers']} | {written(row['median_s'])}{cold}"
        print(f"{head} | {row['designs_per_s']:.0f} | {share} | {sizes} |")
    print(
        f"\nOn paper, {cluster['designs']:.0e} designs: {cluster['core_hours']:.0f} core hours "
        f"({cluster['hours_on_1000_cores']:.1f} h on 1000 cores), {cluster['store_tb']:.2g} TB, "
        f"{cluster['mb_per_s_into_the_store_on_1000_cores']:.0f} MB/s into the store"
    )


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


def picture_growth(growth: dict[str, Any]) -> None:
    """Time against unknowns, states, muscles in step, and designs."""
    figure = style.new_figure(style.PAGE, 4.8)
    panels = figure.subplots(2, 2)
    for axes, rows, name, label, per in (
        (panels[0, 0], growth["unknowns"], "unknowns", "Unknowns (21 states)", 1e3),
        (panels[0, 1], growth["states"], "states", "States (24 unknowns)", 1e3),
        (panels[1, 0], growth["together"], "muscles", "Muscles that advance in step", 1e3),
    ):
        axes.plot([row[name] for row in rows], [per * row["least_s"] for row in rows], "o-", color=style.LINES[0])
        axes.set(xscale="log", yscale="log", xlabel=label, ylabel="Time per curve (ms)")
        style.tidy(axes)
    for k, workers in enumerate((1, 2)):
        rows = [row for row in growth["sweeps"] if row["workers"] == workers and not row["cold"]]
        at, times = [row["designs"] for row in rows], [row["median_s"] for row in rows]
        panels[1, 1].plot(at, times, "os"[k] + "-", color=style.LINES[k], label=f"{workers} worker{'s' * k}")
    panels[1, 1].set(xscale="log", yscale="log", xlabel="Designs in a sweep (21 states, 1e-4)", ylabel="Time (s)")
    panels[1, 1].legend(frameon=False, fontsize=style.TICK)
    style.tidy(panels[1, 1])
    for axes in panels.flat:
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_minor_formatter(NullFormatter())
        low, high = axes.get_ylim()
        axes.set_ylim(10.0 ** np.floor(np.log10(low)), 10.0 ** np.ceil(np.log10(high)))
    style.note(
        figure,
        "One machine, one run. Sweeps include the start of their workers; what they need was compiled before.",
    )
    style.save(figure, OUT / "scaling", ("png",))


if __name__ == "__main__":
    main()

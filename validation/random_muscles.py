"""The default call on random muscles: how often it reaches what can be reached, and whether it ever misleads.

    python validation/random_muscles.py [--sample first] [--count 1000] [--workers 2] [--report-only]

Results go line by line to out/random_muscles_first.jsonl; a run that was cut short goes on where it stopped. The report
on all samples is in validation/README.md, with a picture of each.
"""

import argparse
import json
import multiprocessing
import signal
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any

from environment import OUT
from judges import judge_target, placement, worth_of
from sample import SAMPLES, Case, Sample, draw, muscle_of

import mckibben as mk
from mckibben.experiments.answer import UNSTABLE
from mckibben.solver.bench import Bench
from mckibben.solver.find import find
from mckibben.solver.held import Held

AGAIN = (96, 256)
"""Unknowns on which a last good state is sought afresh; the larger number where the smaller does not resolve it."""
LONG = 5.0
"""Seconds of the processor after which a call is timed once more: it may have been compiling."""
NUMBERS = ("force", "length", "volume", "error_estimate", "residual", "coefficient_tail", "conserved_variation")


def warm() -> None:
    """Compile everything a solve may need, so that the times are those of solving."""
    for ends in ("clamped", "pinned"):
        muscle = mk.presets.reference().replace("ends", ends)
        bench = Bench.of(muscle)
        for size in (24, 48, 96):
            find(bench.problem(size, 2.0), Held.of(length=0.1, pressure=1e5))
        for length in (0.1, 0.0505, 0.0443, 0.04):
            mk.solve(muscle, length=length, pressure=1e5)
            mk.solve(muscle, length=length, pressure=1e5, tolerance=1e-10)


def one(case: Case) -> dict[str, Any]:
    """The default call on one case."""
    muscle, bench, held = muscle_of(case), Bench.of(muscle_of(case)), Held.of(**case["held"])
    start, worked = time.perf_counter(), time.process_time()
    state = mk.solve(muscle, **case["held"])
    found: dict[str, Any] = {"seconds": time.perf_counter() - start, "processor": time.process_time() - worked}
    found |= {"verdict": str(state.verdict), "reason": state.reason, "shape": str(state.data["shape"].values)}
    found |= {name: float(state.data[name].values) for name in NUMBERS}
    found["miss"] = max(abs(getattr(state, k) - v) / max(abs(v), 1.0 if k == "force" else 0.0) for k, v in pairs(held))
    found["modes"] = None if state.modes is None else [state.modes.length_control, state.modes.force_control,
                                                       state.modes.antisymmetric]  # fmt: skip
    if state.asymmetric is not None:
        found["asymmetric"] = {name: float(state.asymmetric.data[name].values) for name in NUMBERS}
        found["asymmetric"]["verdict"] = str(state.asymmetric.verdict)
    if state.last_good is not None:
        found["last_good"] = last_good(bench, case, state.last_good)
    return {"case": case, "found": found}


def judged(case: Case) -> dict[str, Any]:
    """What the other methods make of a case."""
    return {"case": case, "judges": judge_target(Bench.of(muscle_of(case)), Held.of(**case["held"]), case["id"])}


def timed(case: Case) -> dict[str, Any]:
    """Times of the default call on a case once more, when all that it needs is compiled."""
    muscle = muscle_of(case)
    mk.solve(muscle, **case["held"])
    start, worked = time.perf_counter(), time.process_time()
    mk.solve(muscle, **case["held"])
    return {"case": case, "times": {"seconds": time.perf_counter() - start, "processor": time.process_time() - worked}}


def pairs(held: Held) -> list[tuple[str, float]]:
    """Held names with values; pressure last and not zero, so that a relative miss can be said."""
    return [(name, value) for name, value in zip(held.names, held.values, strict=True) if name != "pressure" or value]


def is_reached(row: dict[str, Any]) -> bool:
    """Whether the default call gave a state that is stable in its symmetric modes and admissible."""
    found = row["found"]
    if found["verdict"] == "unstable":
        return bool(found["modes"]["length" not in row["case"]["held"]] == 0)
    return bool(found["verdict"] == "stable")


def is_told(row: dict[str, Any]) -> bool:
    """Whether the reason of a call without a state names an unstable one that other starts found."""
    return UNSTABLE in row["found"]["reason"]


def is_stable(row: dict[str, Any]) -> bool:
    """Whether the default call gave a stable state, symmetric or the one that it tips to."""
    found = row["found"]
    return bool(found["verdict"] == "stable" or found.get("asymmetric", {}).get("verdict") == "stable")


def last_good(bench: Bench, case: Case, last: Any) -> dict[str, Any]:
    """The last good state, and what a fresh search on more unknowns says at the same place."""
    axial = "length" if "length" in case["held"] else "force"
    held = Held.of(**{axial: getattr(last, axial), "pressure": last.pressure})
    size = max(abs(last.force), 1.0) if axial == "length" else last.length
    other = "force" if axial == "length" else "length"
    for unknowns in AGAIN:
        again = find(bench.problem(unknowns, placement(bench, held)), held)
        difference = abs(getattr(again, other) - getattr(last, other)) / size
        if difference < 1e-6:
            break
    return {
        "verdict": str(last.verdict), "length": last.length, "force": last.force, "pressure": last.pressure,
        "residual": float(last.data["residual"].values), "error_estimate": last.error_estimate,
        "again": worth_of(again, held), "difference": difference,
    }  # fmt: skip


def safely(case: Case) -> dict[str, Any]:
    """A crash is a finding, not the end of the run."""
    try:
        return one(case)
    except Exception as error:
        return {"case": case, "found": {"verdict": "crash", "reason": repr(error)}}


def read(file: Path) -> dict[int, dict[str, Any]]:
    """Lines so far, by case."""
    if not file.exists():
        return {}
    rows = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines() if line.endswith("}")]
    return {row["case"]["id"]: row for row in rows}


def file_of(sample: Sample, what: str = "") -> Path:
    """Where the results of a sample are: of the default call, "_judged" or "_timed"."""
    return OUT / f"random_muscles_{sample.name}{what}.jsonl"


def done(sample: Sample) -> dict[int, dict[str, Any]]:
    """Results so far, with the judges' word and with the times once all was compiled where those were asked."""
    rows, judges, times = (read(file_of(sample, what)) for what in ("", "_judged", "_timed"))
    for k in rows.keys() & judges.keys():
        rows[k]["judges"] = judges[k]["judges"]
    for k in rows.keys() & times.keys():
        rows[k]["found"] |= times[k]["times"] | {"again": True}
    return rows


def within(seconds: float, checked: Callable[[Case], dict[str, Any]], case: Case) -> dict[str, Any]:
    """What is found of a case; a crash is a finding, not the end of the run, and so is one that takes too long: more
    than so many seconds of the processor, compiling included."""

    def late(*_: Any) -> None:
        raise TimeoutError(f"took more than {seconds} s of the processor")

    signal.signal(signal.SIGPROF, late)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        return {"case": case, "found": checked(case)}
    except Exception as error:
        return {"case": case, "found": {"verdict": "crash", "reason": repr(error)}}
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)


def write_lines(
    task: Callable[[Case], dict[str, Any]],
    cases: list[Case],
    file: Path,
    workers: int,
    first: Callable[[], None] | None = None,
) -> None:
    """The task on every case that is not yet in the file; each worker does `first` before."""
    known = read(file)
    left = [case for case in cases if case["id"] not in known]
    if not left:
        return
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, spawn, initializer=first) as pool, file.open("a", encoding="utf-8") as lines:
        for job in as_completed([pool.submit(task, case) for case in left]):
            lines.write(json.dumps(job.result()) + "\n")
            lines.flush()


def run(sample: Sample, count: int, workers: int) -> None:
    """The default call on everything; then the judges wherever it gave no stable state."""
    OUT.mkdir(exist_ok=True)
    lines = file_of(sample)
    write_lines(safely, [draw(k, sample) for k in range(count)], lines, workers, warm)
    lost = [row["case"] for _, row in sorted(read(lines).items()) if row["found"]["verdict"] != "stable"]
    write_lines(judged, lost, file_of(sample, "_judged"), workers)
    slow = [row["case"] for _, row in sorted(read(lines).items()) if row["found"].get("processor", 0.0) > LONG]
    write_lines(timed, slow, file_of(sample, "_timed"), workers)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sample", choices=[sample.name for sample in SAMPLES], default=SAMPLES[0].name)
    parser.add_argument("--count", type=int, help="as many as the sample has by default")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--report-only", action="store_true")
    asked = parser.parse_args()
    sample = next(sample for sample in SAMPLES if sample.name == asked.sample)
    if not asked.report_only:
        run(sample, asked.count or sample.count, asked.workers)
    from summary import write

    write({sample: [row for _, row in sorted(done(sample).items())] for sample in SAMPLES})


if __name__ == "__main__":
    main()

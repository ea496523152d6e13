"""Random curves: whether `mk.run` and `mk.sweep` reach and say of every state what `mk.solve` says of it alone.

    python validation/curves.py [--count 80] [--swept 80] [--workers 2] [--report-only]

Curves go line by line to out/curves.jsonl and out/curves_swept.jsonl, the tables into validation/README.md.
"""

import argparse
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from curve_tables import report, targets
from environment import OUT
from random_muscles import read, write_lines
from sample import Case, draw_muscle, muscle_of, ordinary_force
from sections import put

import mckibben as mk

SEED = 20261125
KINDS = ("isometric", "isobaric", "isotonic", "large isotonic", "free contraction")
"""Isometric and isotonic over the pressure, isobaric over the length. A large force lies up to twice as far beyond the
ordinary ones as those lie apart."""
LINES, SWEPT = OUT / "curves.jsonl", OUT / "curves_swept.jsonl"
LONG = 5.0
"""Seconds of the processor after which a call may have been compiling."""


def draw(k: int) -> Case:
    """Curve k as plain numbers in SI units: what is held, and the values of what varies."""
    rng = np.random.default_rng((SEED, k))
    case = draw_muscle(k, rng) | {"kind": KINDS[k % len(KINDS)]}
    n, H0 = int(rng.integers(3, 9)), case["muscle"]["H0"]
    ends = rng.uniform(0.0, 0.6e6, 2)
    pressures, held = np.linspace(*(ends if rng.random() < 0.5 else (0.0, ends[1])), n).tolist(), float(ends[1])
    lengths = [float(low + rng.random() * (0.99 * case["longest"] - low)) for low in (0.5 * H0, 0.8 * H0)]
    match case["kind"]:
        case "isometric":
            test: dict[str, Any] = {"length": lengths[1], "pressure": pressures}
        case "isobaric":
            test = {"length": np.linspace(*lengths[:: int(rng.choice([-1, 1]))], n).tolist(), "pressure": held}
        case "free contraction":
            test = {"force": 0.0, "pressure": pressures}
        case _:
            low, high = (ordinary_force(case, end, held) for end in (0.0, 1.0))
            share = float(rng.random())
            force = low + share * (high - low)
            if case["kind"] == "large isotonic":
                beyond = 2.0 * (2.0 * share - 1.0) * (high - low)
                force = beyond + (high if beyond > 0.0 else low)
            test = {"force": force, "pressure": pressures}
    return case | {"test": test, "points": n}


def test_of(case: Case) -> Any:
    """The test of a curve."""
    return mk.Step(**case["test"], points=case["points"])


def timed(call: Callable[[], Any]) -> tuple[Any, dict[str, float]]:
    """What a call gives, and its seconds by the clock and of the processor.

    One that takes long is made again: what it needs is then compiled.
    """
    for _ in range(2):
        start, worked = time.perf_counter(), time.process_time()
        found = call()
        took = {"seconds": time.perf_counter() - start, "processor": time.process_time() - worked}
        if took["processor"] < LONG:
            break
    return found, took


NAMES = ("force", "length", "volume", "error_estimate")


def one(case: Case) -> dict[str, Any]:
    """A curve as `run` gives it, and its states as `solve` gives them."""
    muscle, test = muscle_of(case), test_of(case)
    curve, took = timed(lambda: mk.run(muscle, test))
    found = _numbers(curve.column) | took
    found |= {"verdict": list(curve.verdict), "reason": [str(text) for text in curve.column("reason")]}
    alone = []
    for held in targets(case):
        state, seconds = timed(lambda held=held: mk.solve(muscle, **held))
        line = {name: getattr(state, name) for name in NAMES} | seconds
        alone.append(line | {"verdict": str(state.verdict), "reason": state.reason})
    return {"case": case, "run": found, "solve": alone}


def swept(case: Case) -> dict[str, Any]:
    """A curve as `sweep` gives it."""
    over = {"braid.fibres": [case["muscle"]["N"]]}
    data, took = timed(lambda: mk.sweep(muscle_of(case), test_of(case), over, workers=0))
    words = [word.replace("_", " ") for word in data["verdict"].attrs["flag_meanings"].split()]
    verdicts = [words[int(flag) + 1] for flag in data["verdict"].values[0]]
    return {"case": case, "sweep": _numbers(lambda name: data[name].values[0]) | {"verdict": verdicts} | took}


def _numbers(column: Callable[[str], Any]) -> dict[str, Any]:
    return {name: [float(value) for value in column(name)] for name in NAMES}


def done() -> list[dict[str, Any]]:
    """Curves so far, by every way that was asked."""
    rows, sweeps = read(LINES), read(SWEPT)
    return [
        row | {key: value for key, value in sweeps.get(k, {}).items() if key != "case"}
        for k, row in sorted(rows.items())
    ]


def safely(case: Case) -> dict[str, Any]:
    """A crash is a finding, not the end of the run."""
    try:
        return one(case)
    except Exception as error:
        return {"case": case, "crash": repr(error)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=80)
    parser.add_argument("--swept", type=int, help="how many of them by sweep, too; all by default")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--report-only", action="store_true")
    asked = parser.parse_args()
    OUT.mkdir(exist_ok=True)
    if not asked.report_only:
        cases = [draw(k) for k in range(asked.count)]
        write_lines(safely, cases, LINES, asked.workers)
        write_lines(swept, cases[: asked.swept], SWEPT, 1)  # most of its time is compiling, once
    put("## Curves", report(done()))


if __name__ == "__main__":
    main()

"""Random curves: whether `mk.run` and `mk.sweep` reach and say of every state what `mk.solve` says of it alone.

    python validation/curves.py [--count 80] [--workers 2]

Curves go line by line to out/curves.jsonl, the tables into validation/README.md.
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
LINES = OUT / "curves.jsonl"
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


def one(case: Case) -> dict[str, Any]:
    """A curve as `run`, `sweep` and `solve` give it."""
    muscle, test = muscle_of(case), test_of(case)
    over = {"braid.fibres": [case["muscle"]["N"]]}
    curve, took = timed(lambda: mk.run(muscle, test))
    data, sweep_took = timed(lambda: mk.sweep(muscle, test, over, workers=0))
    words = [word.replace("_", " ") for word in data["verdict"].attrs["flag_meanings"].split()]
    names = ("force", "length", "volume", "error_estimate")
    columns = {"run": curve.column, "sweep": lambda name: data[name].values[0]}
    ways = {way: {name: [float(x) for x in column(name)] for name in names} for way, column in columns.items()}
    ways["run"] |= {"verdict": list(curve.verdict), "reason": [str(x) for x in curve.column("reason")]} | took
    ways["sweep"] |= {"verdict": [words[int(x) + 1] for x in data["verdict"].values[0]]} | sweep_took
    alone = []
    for held in targets(case):
        state, seconds = timed(lambda held=held: mk.solve(muscle, **held))
        alone.append({name: getattr(state, name) for name in names} | {
            "verdict": str(state.verdict), "reason": state.reason, "cautions": len(state.cautions)} | seconds
        )  # fmt: skip
    return {"case": case, **ways, "solve": alone}


def safely(case: Case) -> dict[str, Any]:
    """A crash is a finding, not the end of the run."""
    try:
        return one(case)
    except Exception as error:
        return {"case": case, "crash": repr(error)}


def warm() -> None:
    """Compile what curves need, so that the times are those of solving."""
    from random_muscles import warm as warm_states

    warm_states()
    for k in range(2 * len(KINDS)):  # one of each kind and ends, other than those that count
        safely(draw(10_000 + k))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=80)
    parser.add_argument("--workers", type=int, default=2)
    asked = parser.parse_args()
    OUT.mkdir(exist_ok=True)
    write_lines(safely, [draw(k) for k in range(asked.count)], LINES, asked.workers, warm)
    put("## Curves", report([row for _, row in sorted(read(LINES).items())]))


if __name__ == "__main__":
    main()

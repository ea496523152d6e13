"""Derivatives of `mk.response` by every number of random muscles and tests, against central differences.

    python validation/gradients.py [--count 200] [--workers 2] [--report-only]

Derivatives are those of the default call, differences those of calls with a tolerance of 1e-10. The slopes go line
by line to out/gradients_*.jsonl, a file for each kind of test and ends; the tables into validation/README.md. A run
that was cut short goes on.
"""

import argparse
import itertools
import json
import multiprocessing
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import environment
import jax
import numpy as np
from gradient_tables import KINDS, LIMIT, RESULTS, compared, report
from sample import Case, draw_muscle, muscle_of, ordinary_force
from sections import put

import mckibben as mk
from mckibben import spec

SEED = 20261126
GROUPS = range(2 * len(KINDS))
"""Muscle k is of group k modulo their number: ends go by turns, kinds of test by pairs."""
STEP = 1e-3
"""Largest relative step of a number, and largest relative change of a result in a step."""
FINE = 1e-10
"""Tolerance of the calls that differences are taken of."""

Values = dict[str, np.ndarray]


def draw(k: int) -> tuple[Case, Any]:
    """Muscle k and a test of it."""
    rng = np.random.default_rng((SEED, k))
    case = draw_muscle(k, rng) | {"kind": KINDS[k // 2 % len(KINDS)]}
    P, H0 = float(rng.uniform(0.02e6, 0.6e6)), case["muscle"]["H0"]
    a, b = (float(0.8 * H0 + share * (0.98 * case["longest"] - 0.8 * H0)) for share in rng.random(2))
    pressures = [0.5 * P, P]
    match case["kind"]:
        case "isometric":
            return case, mk.Isometric(length=a, pressure=pressures)
        case "isobaric":
            return case, mk.Isobaric(pressure=P, length=[a, b])
        case "isotonic":
            return case, mk.Isotonic(force=ordinary_force(case, float(rng.random()), P), pressure=pressures)
        case "free contraction":
            return case, mk.FreeContraction(pressure=pressures)
        case "blocked force":
            return case, mk.BlockedForce(pressure=pressures)
        case "volume held":
            volumes = mk.response(muscle_of(case), mk.Isometric(length=a, pressure=pressures))["volume"]
            return case, mk.Step(length=a, volume=[float(volume) for volume in volumes]) if np.isfinite(
                volumes
            ).all() else None
    return case, mk.Protocol([mk.Step(length=a, pressure=P), mk.Step(length=b, gas="isothermal")])


def values(leaves: Any, tree: Any, tolerance: float) -> dict[str, Any]:
    """The results of a muscle and a test given by their numbers."""
    muscle, test = jax.tree.unflatten(tree, list(leaves))
    found = mk.response(muscle, test, tolerance=tolerance)
    return {name: found[name] for name in RESULTS}


def measure(k: int) -> dict[str, Any]:
    """Slopes of every result at every state by every number, both ways; none where a state was not reached."""
    case, test = draw(k)
    row: dict[str, Any] = {"id": k, "kind": case["kind"], "ends": case["ends"], "slopes": None}
    if test is None:
        return row
    muscle = muscle_of(case)
    given, tree = jax.tree.flatten((muscle, test))
    leaves = np.array([float(leaf) for leaf in given])
    at = {name: np.asarray(value) for name, value in values(leaves, tree, FINE).items()}
    jacobian = jax.jacfwd(partial(values, tree=tree, tolerance=1e-6))(leaves)
    row["finite"] = all(np.isfinite(value).all() for value in at.values())
    if not row["finite"]:
        return row | {"told": not np.isfinite(np.concatenate([slope.ravel() for slope in jacobian.values()])).all()}
    row["stable"] = set(mk.run(muscle, test, tolerance=FINE).verdict) == {"stable"}
    if not row["stable"]:  # a step of a difference may tip it over
        return row
    sizes = natural(case, at)
    shares = {name: np.asarray(jacobian[name]) * leaves / sizes[name][:, None] for name in RESULTS}
    strongest = np.max([np.abs(share).max(axis=0) for share in shares.values()], axis=0)
    pairs = [difference(leaves, tree, i, STEP / max(1.0, float(strongest[i]))) for i in range(len(leaves))]
    row["numbers"] = [f"muscle.{name}" for name, _, _ in spec.numbers(muscle)]
    row["numbers"] += [f"test.{name}" for name, _, _ in spec.numbers(test)]
    row["slopes"] = {
        name: {
            "by": shares[name].tolist(),
            "difference": _share([pair[0][name] for pair in pairs], leaves, sizes[name]),
            "doubt": _share([pair[1][name] for pair in pairs], leaves, sizes[name]),
        }
        for name in RESULTS
    }
    if not all(np.isfinite(part).all() for slopes in row["slopes"].values() for part in slopes.values()):
        return row | {"slopes": None, "lost": True}
    if max(line["relative"] for line in compared(row)) > LIMIT:
        fine = jax.jacfwd(partial(values, tree=tree, tolerance=FINE))(leaves)
        for name in RESULTS:
            row["slopes"][name]["fine"] = (np.asarray(fine[name]) * leaves / sizes[name][:, None]).tolist()
    return row


def _share(slopes: list[np.ndarray], leaves: np.ndarray, sizes: np.ndarray) -> list[list[float]]:
    """Slopes by each number as per cent per per cent (states, numbers)."""
    shares: list[list[float]] = (np.array(slopes).T * leaves / sizes[:, None]).tolist()
    return shares


def natural(case: Case, at: Values) -> Values:
    """Sizes that results are held against: a force may pass through zero."""
    sizes = {name: np.abs(value) for name, value in at.items()}
    sizes["force"] = sizes["force"] + np.pi * case["muscle"]["R0"] ** 2 * sizes["pressure"]
    work = sizes["pressure"] * np.pi * case["muscle"]["R0"] ** 2 * case["muscle"]["H0"]
    sizes["energy"] = np.maximum(sizes["energy"], 1e-6 * work)  # held at rest, a clamped braid stores nothing
    sizes["energy_chamber"] = sizes["energy"]
    return sizes


def difference(leaves: np.ndarray, tree: Any, i: int, step: float) -> tuple[Values, Values]:
    """Slopes by number i from central differences of three steps, each half of the last, and how sure they are."""
    slopes = []
    for part in (1.0, 0.5, 0.25):
        h = part * step * abs(leaves[i])
        up, down = (
            values(np.where(np.arange(len(leaves)) == i, leaves + side * h, leaves), tree, FINE) for side in (1, -1)
        )
        slopes.append({name: (np.asarray(up[name]) - np.asarray(down[name])) / (2.0 * h) for name in RESULTS})
    coarse, fine = ({name: (4.0 * b[name] - a[name]) / 3.0 for name in RESULTS} for a, b in itertools.pairwise(slopes))
    return fine, {name: np.abs(fine[name] - coarse[name]) for name in RESULTS}


def file_of(group: int) -> Path:
    """Rows of the muscles of one kind of test and ends."""
    return environment.OUT / f"gradients_{group}.jsonl"


def measured() -> list[dict[str, Any]]:
    """All rows so far, by muscle; a line that was cut short does not count."""
    lines = [
        line for group in GROUPS if (file := file_of(group)).exists() for line in file.read_text("utf-8").splitlines()
    ]
    rows = {row["id"]: row for row in (json.loads(line) for line in lines if line.endswith("}"))}
    return [rows[k] for k in sorted(rows)]


def write_group(group: int, ids: list[int]) -> None:
    """Muscles of one kind of test and ends, which share what is compiled: row by row."""
    with file_of(group).open("a", encoding="utf-8") as lines:
        for k in ids:
            lines.write(json.dumps(safely(k)) + "\n")
            lines.flush()


def safely(k: int) -> dict[str, Any]:
    try:
        return measure(k)
    except Exception as error:
        return {"id": k, "kind": KINDS[k // 2 % len(KINDS)], "slopes": None, "crash": repr(error)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--report-only", action="store_true")
    asked = parser.parse_args()
    if not asked.report_only:
        run(asked.count, asked.workers)
    put("## Gradients", report(measured()))


def run(count: int, workers: int) -> None:
    """Muscles of one kind of test and ends are measured in one process, since they share what is compiled."""
    environment.OUT.mkdir(exist_ok=True)
    known = {row["id"] for row in measured()}
    with ProcessPoolExecutor(workers, multiprocessing.get_context("spawn")) as pool:
        left = {first: [k for k in range(first, count, len(GROUPS)) if k not in known] for first in GROUPS}
        for job in [pool.submit(write_group, first, ids) for first, ids in left.items() if ids]:
            job.result()


if __name__ == "__main__":
    main()

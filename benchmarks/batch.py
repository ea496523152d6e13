"""Many muscles: 512 isometric curves of 21 states at 1e-4, where their time goes, and a floor to measure it against.

The muscles have angles and walls about the paper's. `solving` is the compiled path of every muscle from rest through
its 21 states by one Newton step each; `solving to the tolerance` places the points before, and adds the Newton steps
that are missing after; `appraising` is stability, fibre tension and error estimates; `mk.sweep` is what a user calls,
from specifications to a Dataset with a verdict for every state.
"""

import time
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import attrs
import jax
import numpy as np
from curve import EXACT, MUSCLE, error
from timing import once, timed

import mckibben as mk
from mckibben.discretise.spectral import Line
from mckibben.measure.many import appraised
from mckibben.solver.batch import march
from mckibben.solver.newton import batch_size
from mckibben.sweeps import batches, paths
from mckibben.sweeps.groups import Group, groups
from mckibben.sweeps.plan import plan

CURVES, POINTS, TOLERANCE, UNKNOWNS = 512, 21, 1e-4, 12
TEST = mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=POINTS)
GRID = {
    "braid.angle": (np.radians([33.0, 41.0]), 32),
    "chamber.thickness": ([0.6e-3, 1.8e-3], 16),
}
"""Fields, their ends in SI, and how many values of each."""
OVER = {name: {"from": float(ends[0]), "to": float(ends[1]), "points": n} for name, (ends, n) in GRID.items()}
THREADS = 2


def designs(count: int = CURVES) -> Group:
    """The muscles of the sweep, as a batch takes them."""
    over = {name: np.linspace(*ends, n).tolist() for name, (ends, n) in GRID.items()}
    (group,) = groups(plan(MUSCLE, TEST, over, tolerance=TOLERANCE, chunk=CURVES).piece(0))
    assert len(group) == CURVES
    return group.take(np.arange(count) % CURVES)


def captured(group: Group, tolerance: float = TOLERANCE) -> dict[str, list[tuple[Any, ...]]]:
    """What batches give the compiled functions, call by call."""
    calls: dict[str, list[tuple[Any, ...]]] = {"march": [], "appraised": []}
    before = paths.march, batches.appraised

    def keep(name: str, function: Any) -> Any:
        def call(*args: Any) -> Any:
            calls[name].append(args)
            return function(*args)

        return call

    paths.march, batches.appraised = keep("march", march), keep("appraised", appraised)
    try:
        batches.solve_together(group, tolerance)
    finally:
        paths.march, batches.appraised = before
    return calls


def together(function: Any, calls: list[tuple[Any, ...]], threads: int) -> Any:
    """Every batch, some at a time."""
    with ThreadPoolExecutor(threads) as pool:
        return list(pool.map(lambda args: jax.block_until_ready(function(*args)), calls))


def measure() -> list[dict[str, Any]]:
    """Rows with curves per second."""
    group = designs()
    cold, calls = once(lambda: captured(group.take(np.zeros(1, int)))), captured(group)
    courses, states = calls["march"], calls["appraised"]
    off = accuracy(group)
    rows = []
    for name, function, given in (("solving", march, courses), ("appraising", appraised, states)):
        for threads in (1, THREADS):
            times = timed(lambda function=function, given=given, threads=threads: together(function, given, threads), 5)
            times["cold_s"] = cold[0]["median_s"]  # of one batch, solved and appraised: both compile
            rows.append(row(f"512 curves, {name}, {threads} thread{'s' * (threads > 1)}", times, off))
    line, close = attrs.evolve(group.line, size=UNKNOWNS), batches.CLOSE * TOLERANCE**0.5
    with ThreadPoolExecutor(THREADS) as pool:
        times = timed(lambda: paths.followed(pool, group, line, close), 5)
    rows.append(row(f"512 curves, solving to the tolerance, {THREADS} threads", times, off))
    times = timed(lambda: mk.sweep(MUSCLE, TEST, OVER, tolerance=TOLERANCE, workers=0), 5)
    rows.append(row("512 curves, mk.sweep in full, one process", times, off))
    times = timed(lambda: mk.sweep(MUSCLE, TEST, OVER, workers=0), 2)
    rows.append(row("512 curves, mk.sweep at 1e-6, one process", times, accuracy(group, 1e-6)))
    systems = np.mean([int(np.asarray(march(*path).systems).max()) for path in courses])
    return [*rows, {**floor(UNKNOWNS, POINTS + systems), "systems_per_curve": float(POINTS + systems)}]


def row(name: str, times: dict[str, Any], off: float) -> dict[str, Any]:
    return {
        "name": name, "states": CURVES * POINTS, "error": off, "curves_per_s": CURVES / times["least_s"], **times,
    }  # fmt: skip


def accuracy(group: Group, tolerance: float = TOLERANCE) -> float:
    """Largest error of every 37th curve against single runs on many unknowns."""
    worst, some = 0.0, group.take(np.arange(0, len(group), 37))
    forces = {int(k): one.numbers["force"][d] for one in batches.solve_together(some, tolerance)
              for d, k in enumerate(one.group.index)}  # fmt: skip
    for d, k in enumerate(some.index.tolist()):
        angle, wall = (float(x) for x in (some.p.theta0[d], np.sqrt(some.p.R0[d] ** 2 + some.p.A0[d] / np.pi)))
        muscle = MUSCLE.replace("braid.angle", angle).replace("chamber.thickness", wall - float(some.p.R0[d]))
        worst = max(worst, error(forces[k], mk.run(muscle, TEST, tolerance=1e-9).force))
    return worst


def floor(unknowns: int, systems: float) -> dict[str, Any]:
    """The least that one Newton system can cost here: its matrix products and its factorisation, nothing else.

    Per system: A from its sweep (q x q m), the own part of the stiffness (3 q x m^2), the mixed part (m x q x m), and a
    Cholesky factor with three right-hand sides (m^3/3 + 6 m^2 operations), each at the rate measured here for it.
    """
    line = Line(unknowns)
    q, m, batch = line.points, line.unknowns, batch_size(line.unknowns)
    rng = np.random.default_rng(0)
    left, right = rng.standard_normal((batch, 3 * q)), rng.standard_normal((3 * q, m * m))
    product = jax.jit(lambda a, b: a @ b)
    rate = 2.0 * left.size * right.shape[1] / least(lambda: product(left, right))
    K = rng.standard_normal((batch, m, m))
    K = K @ K.swapaxes(1, 2) + m * np.eye(m)
    sides = rng.standard_normal((batch, m, 3))
    factor = jax.jit(lambda K, s: jax.scipy.linalg.cho_solve((jax.numpy.linalg.cholesky(K), True), s))
    solving = least(lambda: factor(K, sides)) / batch
    operations = 2.0 * (q * q * m + 3 * q * m * m + q * m * m)
    one = operations / rate + solving
    return {
        "name": "floor: products and factors of the systems alone, 1 thread", "states": CURVES * POINTS, "error": None,
        "curves_per_s": 1.0 / (systems * one), "median_s": CURVES * systems * one, "least_s": CURVES * systems * one,
        "processor_s": CURVES * systems * one, "repeats": 0, "gflop_per_s": rate / 1e9, "factor_us": 1e6 * solving,
    }  # fmt: skip


def least(call: Any, repeats: int = 200) -> float:
    """Least time [s] of a short call."""
    jax.block_until_ready(call())
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        jax.block_until_ready(call())
        times.append(time.perf_counter() - start)
    return min(times)


assert EXACT  # the reference of `error` is on this many unknowns for single curves

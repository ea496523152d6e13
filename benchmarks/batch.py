"""Many muscles: 512 isometric curves of 21 states at 1e-4, where their time goes, and a floor to measure it against.

The muscles have angles and walls about the paper's. `solving` is the compiled path of every muscle from rest through
its 21 states; `appraising` adds a last Newton step, stability, fibre tension and error estimates; `mk.sweep` is what a
user calls, from specifications to a Dataset with a verdict for every state.
"""

import time
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import jax
import numpy as np
from curve import EXACT, MUSCLE, error
from timing import once, timed

import mckibben as mk
from mckibben import fleet
from mckibben.appraise import appraised
from mckibben.discretise.line import Line
from mckibben.solver.lockstep import batch_size
from mckibben.solver.march import march

CURVES, POINTS, TOLERANCE, UNKNOWNS = 512, 21, 1e-4, 12
TEST = mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=POINTS)
OVER = {
    "braid.angle": {"from": "33 deg", "to": "41 deg", "points": 32},
    "chamber.thickness": {"from": "0.6 mm", "to": "1.8 mm", "points": 16},
}
THREADS = 2


def asks(count: int = CURVES) -> list[fleet.Ask]:
    """The muscles of the sweep, as a batch takes them."""
    angles, walls = np.radians(np.linspace(33.0, 41.0, 32)), np.linspace(0.6e-3, 1.8e-3, 16)
    found = []
    for angle in angles:
        muscle = MUSCLE.replace("braid.angle", float(angle))
        found += [fleet.ask(muscle.replace("chamber.thickness", float(wall)), TEST) for wall in walls]
    some = [one for one in found if one is not None]
    assert len(some) == CURVES
    return (some * (1 + count // CURVES))[:count]


def captured(some: list[fleet.Ask], size: int, tolerance: float) -> list[tuple[Any, ...]]:
    """What `fleet` gives the compiled functions, batch by batch: arguments of `march`, and those of `appraised`."""
    calls: list[tuple[Any, ...]] = []
    line = Line(size)

    def keep_march(*args: Any) -> Any:
        calls.append(args)
        return march(*args)

    def keep_appraised(*args: Any) -> Any:
        calls[-1] = (calls[-1], args) if not isinstance(calls[-1][0], tuple) else calls[-1]
        return appraised(*args)

    before = fleet.march, fleet.appraised
    fleet.march, fleet.appraised = keep_march, keep_appraised
    try:
        b = np.concatenate([fleet._placement(part) for part in fleet._split(some, fleet.MOST)])
        for part in fleet._split(list(range(len(some))), batch_size(line.unknowns)):
            curves = fleet._on([some[k] for k in part], b[part], line, tolerance)
            assert all(curve is not None for curve in curves)
    finally:
        fleet.march, fleet.appraised = before
    return calls


def together(function: Any, calls: list[tuple[Any, ...]], threads: int) -> Any:
    """Every batch, some at a time."""
    with ThreadPoolExecutor(threads) as pool:
        return list(pool.map(lambda args: jax.block_until_ready(function(*args)), calls))


def measure() -> list[dict[str, Any]]:
    """Rows with curves per second."""
    some = asks()
    cold, calls = once(lambda: captured(some[:1], UNKNOWNS, TOLERANCE)), captured(some, UNKNOWNS, TOLERANCE)
    paths, states = [call[0] for call in calls], [call[1] for call in calls]
    off = accuracy(some)
    rows = []
    for name, function, given in (("solving", march, paths), ("appraising", appraised, states)):
        for threads in (1, THREADS):
            times = timed(lambda function=function, given=given, threads=threads: together(function, given, threads), 5)
            times["cold_s"] = cold[0]["median_s"]  # of one batch, solved and appraised: both compile
            rows.append(row(f"512 curves, {name}, {threads} thread{'s' * (threads > 1)}", times, off))
    times = timed(lambda: mk.sweep(MUSCLE, TEST, OVER, tolerance=TOLERANCE, workers=0), 3)
    rows.append(row("512 curves, mk.sweep in full, one process", times, off))
    times = timed(lambda: mk.sweep(MUSCLE, TEST, OVER, workers=0), 2)
    rows.append(row("512 curves, mk.sweep at 1e-6, one process", times, accuracy(some, 1e-6)))
    systems = np.mean([int(np.asarray(march(*path).systems).max()) for path in paths])
    return [*rows, {**floor(UNKNOWNS, POINTS + systems), "systems_per_curve": float(POINTS + systems)}]


def row(name: str, times: dict[str, Any], off: float) -> dict[str, Any]:
    return {
        "name": name, "states": CURVES * POINTS, "error": off, "curves_per_s": CURVES / times["least_s"], **times,
    }  # fmt: skip


def accuracy(some: list[fleet.Ask], tolerance: float = TOLERANCE) -> float:
    """Largest error of every 37th curve against single runs on many unknowns."""
    worst = 0.0
    for one, curve in list(zip(some, fleet.solve_together(some, tolerance), strict=True))[::37]:
        assert curve is not None
        p = one.p
        muscle = MUSCLE.replace("braid.angle", float(p.theta0)).replace(
            "chamber.thickness", float(np.sqrt(p.R0**2 + p.A0 / np.pi) - p.R0)
        )
        exact = mk.run(muscle, TEST, tolerance=1e-9).force
        worst = max(worst, error(curve.numbers["force"], exact))
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

"""Times that can be compared: repeats in one process, one after another, and what they ran on.

Besides the time on the clock there is the processor's, of all threads and of child processes: on a busy machine it says
more about the work, and less about what else was running.
"""

import os
import platform
import statistics
import time
from collections.abc import Callable
from importlib.metadata import version
from typing import Any


def timed(function: Callable[[], Any], repeats: int = 7) -> dict[str, Any]:
    """Median and least time [s] of several calls, after a first one, the cold one, that compiles what is new."""
    cold = once(function)[0]["median_s"]
    return {"cold_s": cold, **summary([once(function)[0] for _ in range(repeats)])}


def in_turns(one: Callable[[], Any], other: Callable[[], Any], repeats: int = 50) -> float:
    """How many times longer the other takes, by medians on the clock of calls in turns: neither gains by repetition."""
    one(), other()
    calls = [(once(one)[0]["median_s"], once(other)[0]["median_s"]) for _ in range(repeats)]
    first, second = (statistics.median(times) for times in zip(*calls, strict=True))
    return second / first


def summary(calls: list[dict[str, Any]]) -> dict[str, Any]:
    """Of several calls."""
    clock, processor = ([call[name] for call in calls] for name in ("median_s", "processor_s"))
    return {
        "median_s": statistics.median(clock),
        "least_s": min(clock),
        "processor_s": statistics.median(processor),
        "repeats": len(calls),
    }


def once(function: Callable[[], Any]) -> tuple[dict[str, Any], Any]:
    """Time [s] of one call, and what it gave."""
    start, used = time.perf_counter(), processor_time()
    answer = function()
    took, used = time.perf_counter() - start, processor_time() - used
    return {"median_s": took, "least_s": took, "processor_s": used, "repeats": 1}, answer


def processor_time() -> float:
    """Seconds of processor time of this process and of its finished children."""
    times = os.times()
    return times.children_user + times.children_system + time.process_time()


def machine() -> dict[str, Any]:
    """What the times hang on."""
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else None  # not on Windows
    packages = ("mckibben", "jax", "jaxlib", "numpy", "scipy")
    return {
        "processor": platform.processor() or platform.machine(),
        "cores": os.cpu_count(),
        "load_at_start": load,
        "system": platform.system(),
        "python": platform.python_version(),
        "versions": {name: version(name) for name in packages},
    }

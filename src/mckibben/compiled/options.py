"""How compilers are asked to compile, and which of that they understand."""

import functools
import os
from typing import Any

import jax

__all__ = ["OPTIONS", "QUICK", "Options", "understood", "usual"]

Options = dict[str, Any]
"""Options of XLA, as `jax.jit` takes them."""

OPTIONS: Options = {
    "xla_cpu_use_fusion_emitters": False,
    "xla_cpu_multi_thread_eigen": False,
    "xla_disable_hlo_passes": "cpu-parallel-task-assigner",
}
"""With the former emitters of loops XLA compiles in two thirds of the time, to faster code. No work is divided among
threads: the same bits come out on one core and on many."""
QUICK: Options = OPTIONS | {"xla_backend_optimization_level": 0, "xla_cpu_parallel_codegen_split_count": 1}
"""For few calls: half the time to compile again, three times the time to run. So little is left for the
last stage of the compiler that dividing it among threads takes longer than doing it."""


def usual() -> Options:
    """QUICK where the environment has MCKIBBEN_COMPILE=quick, else OPTIONS."""
    return QUICK if os.environ.get("MCKIBBEN_COMPILE") == "quick" else OPTIONS


def understood(options: Options) -> Options:
    """Those that this compiler takes: none on other devices than the processor, fewer where some no longer exist."""
    return dict(_understood(tuple(options.items())))


@functools.cache
def _understood(options: tuple[tuple[str, Any], ...]) -> tuple[tuple[str, Any], ...]:
    if jax.default_backend() != "cpu":
        return ()
    return options if _takes(options) else tuple(one for one in options if _takes((one,)))


def _takes(options: tuple[tuple[str, Any], ...]) -> bool:
    try:
        jax.jit(lambda x: x).lower(0.0).compile(compiler_options=dict(options))
    except (RuntimeError, ValueError, TypeError):  # which of them is up to the version of JAX
        return False
    return True

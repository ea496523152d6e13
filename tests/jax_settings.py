"""What the environment says to JAX and the package while they are tested.

    python tests/jax_settings.py COMMAND ...

runs a command in it. Kernels are kept between runs, in one folder for all processes, and compiled with the least
optimisation: a test calls them a few times. Whatever runs in the same environment finds those of the tests.
"""

import os
import subprocess
import sys
from pathlib import Path

ALWAYS = {"JAX_PLATFORMS": "cpu", "JAX_NUMPY_DTYPE_PROMOTION": "strict", "MPLBACKEND": "Agg"}
UNLESS_SAID = {
    "MCKIBBEN_CACHE": str(Path(__file__).parent.parent / ".pytest_cache" / "kernels"),
    "MCKIBBEN_COMPILE": "quick",
    # So does what tests compile by `jax.jit` themselves (compiled/options.py says more of these).
    "XLA_FLAGS": "--xla_backend_optimization_level=0 --xla_cpu_use_fusion_emitters=false "
    "--xla_cpu_parallel_codegen_split_count=1",
}


def enter() -> None:
    """Before anything imports JAX or the package."""
    os.environ.update(ALWAYS)
    for name, value in UNLESS_SAID.items():
        os.environ.setdefault(name, value)


if __name__ == "__main__":
    enter()
    sys.exit(subprocess.run(sys.argv[1:], check=False).returncode)

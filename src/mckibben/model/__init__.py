"""The mechanics as plain pointwise functions. Float64 everywhere: equilibria here are differences of large terms."""

import jax

jax.config.update("jax_enable_x64", True)

from . import pytrees as pytrees  # noqa: E402  # spec objects become pytrees with the first use of the model

"""A sealed muscle: a fixed amount of gas inside, (P + atmosphere) V^n constant, isothermal (n = 1) or adiabatic."""

import numpy as np

from .direct import find
from .equilibrium import Equilibrium, Held
from .path import INTERRUPTED, Trace, Watch
from .problem import Problem

ATMOSPHERE = 101325.0
"""Standard atmosphere [Pa], which turns gauge pressure into absolute."""
EXPONENTS = {"isothermal": 1.0, "adiabatic": 1.4}
"""n of P V^n: slow enough to exchange heat, or too fast to (air)."""


def sealed(
    problem: Problem, name: str, values: list[float], start: Equilibrium, gas: str, watch: Watch = lambda k, n: None
) -> Trace:
    """States with `name` (length or force) along `values` and the gas of `start` sealed in.

    For each the pressure is the root of the gas law, by secant over states of held pressure.
    """
    exponent, n = EXPONENTS[gas], len(values)
    amount = np.log(start.pressure + ATMOSPHERE) + exponent * np.log(start.volume)
    u, loads, counts = np.full((n, len(start.u)), np.nan), np.full((n, 4), np.nan), np.zeros(n, int)
    here, message = start, "converged"
    reached = 0
    try:
        for k, value in enumerate(values):
            found, count = _balance(problem, name, value, here, exponent, amount)
            if not found.converged:
                message = found.message
                break
            here = found
            u[k], loads[k], counts[k], reached = found.u, found.loads, count, k + 1
            watch(reached, n)
    except KeyboardInterrupt:
        message = INTERRUPTED
    return Trace(problem, u, loads, counts, reached, message)


def _balance(
    problem: Problem, name: str, value: float, near: Equilibrium, exponent: float, amount: float
) -> tuple[Equilibrium, int]:
    """The state at which gas and muscle agree on the pressure."""

    def trial(pressure: float) -> tuple[Equilibrium, float]:
        state = find(problem, Held.of(**{name: value, "pressure": pressure}), near, radius=0.3)
        if not state.converged:
            return state, np.nan
        return state, float(np.exp(amount - exponent * np.log(state.volume))) - ATMOSPHERE - pressure

    a, count = near.pressure, 0
    state, miss = trial(a)
    b = a + miss / (1.0 + exponent)
    for _ in range(40):
        before, last = state, miss
        if not before.converged:
            return before, count
        count += before.iterations
        if abs(miss) < 1e-10 * (abs(a) + ATMOSPHERE):
            return before, count
        state, miss = trial(b)
        slope = (miss - last) / (b - a) if b != a else -1.0
        a, b = b, b - miss / slope
    return state, count

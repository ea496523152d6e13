"""The least pressure that holds a length, sought upwards."""

from mckibben.results.verdict import Shape
from mckibben.search.walk import branch_end, look
from mckibben.solver.bench import Bench
from mckibben.solver.find import find
from mckibben.solver.held import Held
from mckibben.solver.threads import one_thread

__all__ = ["FIRST", "SIZE", "TRIALS", "holding"]

SIZE = 48
"""Half-length unknowns: limits of the reference muscle to 1e-8."""
TRIALS = 12
"""Pressures tried upwards, each four times the last."""
FIRST = 1e3
"""The first of these above the pressure at which it starts [Pa]."""


@one_thread()
def holding(
    bench: Bench, length: float, pressure: float, tolerance: float = 1e-10, shapes: bool = True, size: int = SIZE
) -> float:
    """Least pressure at or above `pressure` that holds a length; NaN if none up to some 10 GPa does."""
    problem = bench.problem(size, bench.placement(Held.of(length=length, pressure=max(pressure, 1e4))))
    low = Held.of(length=length, pressure=pressure)

    def holds(held: Held) -> bool:
        seen = look(find(problem, held), held)
        folded = seen.verdict.shape in (Shape.ROLLED_UP, Shape.SELF_CONTACT)  # another branch
        return seen.good if shapes else seen.stiffness > 0.0 and not folded

    if holds(low):
        return pressure
    for k in range(TRIALS):
        high = Held.of(length=length, pressure=pressure + FIRST * 4.0**k)
        if holds(high):
            return float(branch_end(problem, high, low, tolerance, shapes).held.get("pressure"))
    return float("nan")

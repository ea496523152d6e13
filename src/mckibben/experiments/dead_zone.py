"""`dead_zone()`: the pressures at which a chamber that is smaller than its braid comes to touch it."""

from __future__ import annotations

import warnings
from typing import Any

import attrs
import jax
import numpy as np
from jaxtyping import Float

from mckibben.compiled.arrays import Array
from mckibben.compiled.kernel import kernel
from mckibben.discretise.fields import place, variables
from mckibben.experiments.foresee import refuse_friction
from mckibben.measure.caution import MuscleWarning
from mckibben.model.gap import pressed
from mckibben.model.parameters import Number, Parameters
from mckibben.solver.bench import Bench
from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.find import find
from mckibben.solver.held import Held
from mckibben.solver.problem import Basis, Problem
from mckibben.solver.threads import one_thread
from mckibben.spec import Muscle, SpecError, Step
from mckibben.units import show

__all__ = ["DeadZone", "dead_zone"]

SIZE = 48
"""Half-length unknowns."""
FIRST, TRIALS = 1e3, 14
"""First pressure [Pa] above which touching is sought, and how often it is doubled: up to some 80 bar."""
CLOSE = 1e-10
"""Relative error of a pressure."""


@attrs.frozen
class DeadZone:
    """Pressures between which a chamber comes to touch its braid, at one length; all in SI units.

    It is what `dead_zone` gives.

    Args:
        length: distance between the fittings [m].
        begins: gauge pressure [Pa] from which the chamber touches anywhere; NaN where it never does.
        ends: gauge pressure [Pa] from which it touches all along the braid; NaN where it never does.
        force: of the muscle [N] where it has come to touch everywhere.

    >>> tube = mk.Chamber(outer_diameter="20 mm", inner_diameter="18 mm", law=mk.NeoHookean(c1="0.15 MPa"), gap=True)
    >>> found = mk.dead_zone(mk.presets.paper().replace("chamber", tube), length="95 mm")
    >>> round(found.begins / 1e5, 4), round(found.ends / 1e5, 4)  # bar
    (0.137, 0.1683)
    """

    length: float
    begins: float
    ends: float
    force: float


@kernel
def touch(basis: Basis, p: Parameters, b: Number, u: Float[Array, " m"], pressure: Number) -> Float[Array, " 2"]:
    """The largest and the least pressure [Pa] of the chamber on the mesh, below 0 where it would need more."""
    on = place(basis, p, b)
    at = basis.form.point(variables(basis, on, u), on.p, on.made)
    found = jax.vmap(lambda at: pressed(at, pressure, on.p))(at)
    return jax.numpy.stack([found.max(), found.min()])


def dead_zone(muscle: Muscle, *, length: Any = None, contraction: Any = None) -> DeadZone:
    """The pressures at which the chamber of a muscle held at a length begins to touch its braid, and has done so.

    Below, the chamber is blown up alone and the muscle pulls no more for it: what labs report as a dead zone.

    Args:
        muscle: the specification, of a chamber with `gap`.
        length: distance between the fittings [m], a number or text with a unit.
        contraction: in place of the length: 1 - h/H0, such as "10 %" or 0.1.

    Returns:
        A `DeadZone` with `begins` and `ends` [Pa], 0 where it touches without pressure. Where no pressure up to some
        80 bar will do, or no state is found on the way, both or one are NaN, and a `MuscleWarning` says so.

    Raises:
        SpecError: for a muscle without a chamber with a gap, or with friction, or a length that is not one value.

    >>> tube = mk.Chamber(outer_diameter="20 mm", inner_diameter="18 mm", law=mk.NeoHookean(c1="0.15 MPa"), gap=True)
    >>> muscle = mk.presets.paper().replace("chamber", tube)
    >>> found = mk.dead_zone(muscle, length="85 mm")
    >>> round(found.ends / 1e5, 4)  # bar
    0.1683
    """
    refuse_friction(muscle, "dead_zone")
    if muscle.chamber is None or not muscle.chamber.gap:
        said = "is off: the chamber is held to the braid, and there is no dead zone to find"
        raise SpecError("chamber.gap", allowed=said, advice='switch it on: muscle.replace("chamber.gap", True)')
    (step,) = Step(length=length, contraction=contraction, force=0.0).as_steps(muscle)  # type: ignore[call-arg]
    if step.length is None or step.length.needs_present or step.length.varies:
        raise SpecError("dead_zone.length", str(step.length), "must be one value")
    h, bench = float(step.length.sample(1)[0]), Bench.of(muscle)
    nothing = DeadZone(h, *(np.nan,) * 3)
    if h >= bench.longest:
        return _warned(nothing, bench.too_long())
    return _sought(bench, h)


def _warned(found: DeadZone, why: str) -> DeadZone:
    warnings.warn(f"no dead zone at {show(found.length, 'm')}: {why}", MuscleWarning, stacklevel=3)
    return found


@one_thread()
def _sought(bench: Bench, length: float) -> DeadZone:
    problem = bench.problem(SIZE, bench.placement(Held.of(length=length, pressure=1e4)))
    state = find(problem, Held.of(length=length, pressure=0.0))
    seen = _Seen(problem, length, state)
    begins = seen.root(0)
    ends = seen.root(1) if begins == begins else np.nan
    found = DeadZone(length, begins, ends, seen.state.force if ends == ends else np.nan)
    return found if ends == ends else _warned(found, "the chamber does not come to touch the braid everywhere")


@attrs.define
class _Seen:
    """What was seen of states at one length: the last of them, from which the next is sought."""

    problem: Problem
    length: float
    state: Equilibrium

    def at(self, pressure: float) -> np.ndarray:
        """Largest and least pressure on the mesh, or by which the chamber falls short of it; NaN without a state."""
        held = Held.of(length=self.length, pressure=pressure)
        found = find(self.problem, held, self.state, radius=0.3) if self.state.converged else self.state
        found = found if found.converged else find(self.problem, held)
        if not found.converged:
            return np.full(2, np.nan)
        self.state = found
        on = self.problem
        return np.asarray(touch(on.basis, on.p, on.b, found.u, np.asarray(pressure)))

    def root(self, which: int) -> float:
        """The least pressure at or above 0 at which the largest (0) or least (1) is 0."""
        from scipy.optimize import brentq  # here, because few calls need it

        if self.at(0.0)[which] >= 0.0:
            return 0.0
        low, high = 0.0, FIRST
        for _ in range(TRIALS):
            value = self.at(high)[which]
            if not value < 0.0:
                break
            low, high = high, 2.0 * high
        if not value >= 0.0:
            return float("nan")
        try:
            return float(brentq(lambda P: float(self.at(P)[which]), low, high, xtol=1e-3, rtol=CLOSE))
        except (ValueError, RuntimeError):  # a state on the way was not found
            return float("nan")

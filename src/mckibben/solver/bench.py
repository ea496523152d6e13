"""A muscle on the bench: its numbers, what limits its length, and the discretisations to put it on."""

from functools import partial
from typing import Any

import attrs
import jax
import numpy as np

from mckibben.compiled.arrays import Array
from mckibben.compiled.kernel import kernel
from mckibben.discretise.bspline import Spline
from mckibben.discretise.placement import crowding
from mckibben.discretise.spectral import Line
from mckibben.model.extension import longest_of
from mckibben.model.gap import STEADY, leaves, peak
from mckibben.model.parameters import Parameters, parameters
from mckibben.solver.held import Held
from mckibben.solver.problem import Basis, Problem
from mckibben.spec import Muscle, SpecError
from mckibben.units import show

__all__ = ["LADDER", "SIZES", "Bench", "jumps", "sizes_for"]

LADDER = (24, 48, 96, 192)
"""Half-length unknowns, tried in turn until the error estimate is below the tolerance; few states need the last."""
SIZES = {"spectral": LADDER[:3], "paper": (43,)}
"""Sizes of the two discretisations for a whole test."""
QUICK = 12
"""Half-length unknowns to start with where 1e-4 will do."""
NEARLY = 0.999
"""Share of full extension for which points are placed where a target is at or beyond it."""


@attrs.frozen
class Bench:
    """A muscle on the bench."""

    p: Parameters
    line: Line  #: of one unknown for each half, with what the fibres may do
    longest: float  #: full extension [m], infinite where the fibres stretch

    @classmethod
    def of(cls, muscle: Muscle) -> "Bench":
        """From the specification."""
        p, line = parameters(muscle), Line.of(muscle, 1)
        _refuse_jumps(p)
        return cls(p, line, longest_of(p, line.ends))

    @property
    def ends(self) -> str:
        """What the fittings hold."""
        return self.line.ends

    def problem(self, size: int, b: float, discretisation: str = "spectral", modes: Any = None) -> Problem:
        """The muscle on a discretisation: with as many unknowns as that has for `modes`, or for each half where these
        are the muscle's own."""
        return Problem.of(self.basis(size, discretisation, modes), self.p, b)

    def basis(self, size: int, discretisation: str = "spectral", modes: Any = None) -> Basis:
        """The discretisation."""
        if discretisation != "paper" and modes is None:
            return attrs.evolve(self.line, size=size * self.line.size)
        if discretisation != "paper":
            return attrs.evolve(self.line, size=size, modes=modes)
        if self.line.stretch or self.line.roll or self.line.give or self.p.end_radii is not None:
            said = "is the paper's own mesh, whose fibres neither stretch nor roll, in rigid fittings of its own radius"
            raise SpecError("discretisation", discretisation, said, 'use "spectral", or leave the effect out')
        return Spline(size, self.ends)

    def placement(self, held: Held) -> float:
        """Crowding of points for one state."""
        force, pressure = held.get("force", np.nan), held.get("pressure", 0.0)
        length = min(held.get("length", float(self.p.rest) if np.isnan(force) else np.nan), NEARLY * self.longest)
        return crowding(self.p, np.array([length]), np.array([force]), np.array([pressure]))

    def too_long(self) -> str:
        """Why no equilibrium exists beyond full extension."""
        return f"no equilibrium: the fibres are straight at {1e3 * self.longest:.4f} mm, the longest possible length"


@partial(kernel, static_argnums=())
def peaks(p: Parameters) -> tuple[Array, Array]:
    """`model.gap.peak`, compiled."""
    return peak(p)


def jumps(p: Parameters) -> np.ndarray:
    """Which of many muscles, whose numbers are arrays (n), have a chamber with a gap that would jump to the braid."""
    if not leaves(p) or isinstance(p.law, STEADY):
        return np.zeros(len(p.R0), bool)
    if p.profile is not None:  # refused, one by one
        return np.ones(len(p.R0), bool)
    return np.isfinite(np.asarray(jax.vmap(peak)(p)[0]))


def _refuse_jumps(p: Parameters) -> None:
    """SpecError for a chamber with a gap whose pressure has a maximum on the way to the braid: it would jump there."""
    if not leaves(p) or isinstance(p.law, STEADY):
        return
    if p.profile is not None:
        said = (
            "does not go with braid.angle_profile and a law that may soften: whether the tube would jump to the braid "
            "is known for braids of one angle"
        )
        raise SpecError("chamber.gap", "true", said, "leave gap out, or take a law that does not soften (NeoHookean)")
    pressure, radius = map(float, peaks(p))
    if pressure == pressure:
        bears, wide = show(pressure, "Pa", 3), show(2.0 * radius, "m", 3)
        said = (
            f"is for tubes that bear the more the wider they are: this one, blown up alone, bears {bears} at most "
            f"before it touches the braid, at a diameter of {wide}, and jumps from there, which is not followed"
        )
        raise SpecError("chamber.gap", "true", said, "leave gap out, or take a law that does not soften (NeoHookean)")


def sizes_for(discretisation: str, tolerance: float) -> tuple[int, ...]:
    """Sizes to try in turn."""
    if discretisation not in SIZES:
        raise SpecError("discretisation", discretisation, "must be one of " + ", ".join(SIZES))
    if not 1e-10 <= tolerance <= 1e-2:
        raise SpecError("tolerance", tolerance, "must be from 1e-10 to 1e-2", "1e-6 is the default")
    sizes = SIZES[discretisation]
    return (QUICK, *sizes) if discretisation == "spectral" and tolerance >= 1e-4 else sizes

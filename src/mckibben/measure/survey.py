"""What solved states are worth: everything read off them, their modes and verdicts, an estimate of their error."""

from typing import Any, NamedTuple

import attrs
import jax
import numpy as np

from mckibben.measure.judge import Judgement, judge, shape_of
from mckibben.measure.meridian import meridian
from mckibben.measure.read import NODES, Reading, Stable, read_many
from mckibben.measure.unresolved import asks_for_step
from mckibben.model.extension import longest_of
from mckibben.model.parameters import Parameters
from mckibben.results.verdict import Modes, Shape
from mckibben.solver.follow import padded
from mckibben.solver.held import GASES
from mckibben.solver.problem import Basis, Problem
from mckibben.solver.stability import count_modes, of_states
from mckibben.solver.system import Unknowns

__all__ = [
    "PLAIN_SLOPE",
    "STRETCHED",
    "Memories",
    "Survey",
    "error_bound",
    "errors",
    "padded_states",
    "prepare",
    "survey",
    "unresolved_bound",
]

ROUNDING = 1e-11
"""Relative error that rounding leaves in a force or length at best."""
STRETCHED = 0.998
"""Share of full extension beyond which the variation of the conserved quantity says too little of the force."""
PLAIN_SLOPE = 1.5
"""Slope [rad] of the meridian below which no shape is anything but ordinary."""
ODD = ("psi", "u1", "roll", "slide", "shear_stress")
"""Fields that change sign at mid-length of a symmetric state."""
PLAIN = Modes(0, 0, 0, float("nan"), float("nan"), float("nan"))
"""Of a state that is stable in every way: nothing was counted."""


@attrs.frozen
class Survey:
    """n states on one problem."""

    problem: Problem
    u: np.ndarray  #: (n, m)
    loads: np.ndarray  #: (n, l) dimensionless
    numbers: dict[str, np.ndarray]  #: (n) by the names of a result's variables, SI
    half: dict[str, np.ndarray]  #: fields (n, nodes) as they were read
    residual: np.ndarray  #: (n) imbalance over the size of its terms
    modes: list[Modes]
    verdicts: list[Judgement]

    @property
    def error(self) -> np.ndarray:
        """Estimated relative error of force and length (n)."""
        return np.asarray(self.numbers["error_estimate"])

    @property
    def fields(self) -> dict[str, np.ndarray]:
        """Fields over the full length (n, NODES)."""
        if not self.problem.basis.half:
            return self.half
        return {name: _mirrored(name, values) for name, values in self.half.items()}

    @property
    def v(self) -> np.ndarray:
        """Material coordinate of the fields' points [m]."""
        problem = self.problem
        return np.asarray(problem.basis.coordinate(problem.basis.uniform(NODES), problem.p, problem.b))


def _mirrored(name: str, half: np.ndarray) -> np.ndarray:
    """A field over the full length from its first half, mid-length included."""
    back = half[:, -2::-1]
    if name == "z":
        return np.concatenate([half, 2.0 * half[:, -1:] - back], axis=1)
    return np.concatenate([half, -back if name in ODD else back], axis=1)


def prepare(basis: Basis, p: Parameters, b: float, count: int) -> None:
    """Have what a survey of `count` states calls compiled in the background (see `compiled.kernel`)."""
    states = Unknowns(np.empty((count, basis.unknowns)), np.empty((count, 3 if basis.closes else 2)))
    read_many.prepare(basis, p, b, padded_states(states), np.array(False), np.array(count))


def padded_states(states: Unknowns) -> Unknowns:
    """States repeated up to 1 or a power of two from 32, so that few shapes are compiled."""
    padding: Unknowns = jax.tree.map(lambda rows: rows if len(rows) == 1 else padded(rows), states)
    return padding


class Memories(NamedTuple):
    """What n states of a path were found with: memories, n rows each."""

    inner: Any  #: of the quadrature points
    outer: Any  #: of the output points


def read_states(
    problem: Problem, u: np.ndarray, loads: np.ndarray, volume: bool, kept: Memories | None = None
) -> tuple[Reading, Stable, np.ndarray]:
    """Readings of states u (n, m) under loads (n, l), as NumPy arrays."""
    n, memories = len(u), kept or Memories(None, None)
    states = padded_states(Unknowns(u, loads, memories.inner))
    asked = [problem.basis, problem.p, problem.b, states, np.array(volume), np.array(n)]
    if kept is not None:
        asked.append(jax.tree.map(lambda rows: rows if n == 1 else padded(rows), memories.outer))
    reading, stable, left = read_many(*asked)
    cut: Reading = jax.tree.map(lambda values: np.asarray(values)[:n], reading)
    return cut, Stable(*(np.asarray(part)[:n] for part in stable)), np.asarray(left)[:n]


def survey(
    problem: Problem, u: np.ndarray, loads: np.ndarray, held: tuple[Any, ...], kept: Memories | None = None
) -> Survey:
    """Look at states u (n, m) under loads (n, l), found with `held` controlled, and what they remembered."""
    reading, stable, residual = read_states(problem, u, loads, "volume" in held, kept)
    certain = stable.length & stable.force & stable.antisymmetric
    softly = problem.leaves and "volume" in held
    if softly or any(name in GASES for name in held):  # they were taken to be at held pressure
        certain = np.zeros_like(certain)
    modes = [PLAIN] * len(u)
    if not problem.basis.half:
        modes = [attrs.evolve(PLAIN, antisymmetric=None, softest_antisymmetric=None)] * len(u)
    open_ones = np.flatnonzero(~certain)
    if len(open_ones):
        memory = None if kept is None else jax.tree.map(lambda rows: rows[open_ones], kept.inner)
        states = padded_states(Unknowns(u[open_ones], loads[open_ones], memory))
        tangents = of_states(problem, states.u, states.loads, held, states.memory)
        counted = count_modes(problem, tangents, pressure_held=softly or "volume" not in held)
        for k, one in zip(open_ones, counted, strict=False):
            modes[k] = one
    shapes = [Shape.ORDINARY] * len(u)
    steep = np.flatnonzero(~(reading.largest_slope < PLAIN_SLOPE))
    for k, line in zip(steep, zip(*meridian(problem, u[steep]), strict=True), strict=True):
        shapes[k] = shape_of(*line)
    verdicts = [judge(mode, shape, "length" in held) for mode, shape in zip(modes, shapes, strict=True)]
    variation, tail = reading.conserved_variation, reading.coefficient_tail
    estimate = _bound(problem, reading, held, kept is not None)
    numbers = reading.numbers | {
        "error_estimate": estimate, "conserved_variation": variation,
        "coefficient_tail": tail,
    }  # fmt: skip
    return Survey(problem, u, loads, numbers, reading.fields, residual, modes, verdicts)


def _bound(problem: Problem, reading: Reading, held: tuple[Any, ...], remembers: bool = False) -> np.ndarray:
    """The error estimate; of states that remember a path nothing is conserved along the length."""
    missed = 0.0 if reading.missed is None else np.asarray(reading.missed.under(held))
    if asks_for_step(problem.basis, problem.p) and not remembers:
        return unresolved_bound(missed)
    near = nearly_straight(problem, reading.numbers["length"]) | (problem.p.profile is not None) | remembers
    return error_bound(reading.conserved_variation, reading.coefficient_tail, near, missed)


def errors(problem: Problem, u: np.ndarray, loads: np.ndarray, held: tuple[Any, ...]) -> np.ndarray:
    """Estimated relative error of force and length of states u (n, m) under loads (n, l), found with `held`."""
    return _bound(problem, read_states(problem, u, loads, False)[0], held)


def unresolved_bound(missed: np.ndarray | float) -> np.ndarray:
    """Of what asks for a step: what `measure.unresolved` found, and kinks."""
    return np.maximum(missed, ROUNDING)


def error_bound(
    conserved_variation: np.ndarray,
    coefficient_tail: np.ndarray,
    stretched: np.ndarray | bool = False,
    kinks: np.ndarray | float = 0.0,
) -> np.ndarray:
    """The smaller of two bounds that hold on random muscles; of those `stretched` nearly to full extension only one.

    In validation/ the variation of the conserved quantity fell short of the true error by 2.5 at most. The tail of the
    coefficients enters the energy squared; near an instability the force follows less well, hence the power 1.5 (and
    `Line.tail` has more for series that end in small coefficients by chance). Near full extension the force answers to
    the last digits of the length, of which the conserved quantity knows nothing: there the tail counts, which fell
    short by 1.8 at most. Neither knows of `kinks` between the points, whose share comes on top.
    """
    by_tail = coefficient_tail**1.5
    usual = np.minimum(3.0 * conserved_variation, by_tail)
    return np.maximum(np.where(stretched, 2.0 * by_tail, usual), ROUNDING) + kinks


def nearly_straight(problem: Problem, length: np.ndarray) -> np.ndarray:
    """At which lengths [m] the fibres are so nearly straight that an error estimate must know it."""
    p = problem.p
    return length > STRETCHED * longest_of(p, problem.basis.ends)

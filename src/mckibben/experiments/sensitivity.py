"""`sensitivity()`: what drives a result, in per cent per per cent."""

from collections.abc import Sequence
from functools import partial
from typing import Any

import attrs
import jax
import jax.numpy as jnp
import numpy as np

from mckibben.compiled.arrays import Array
from mckibben.compiled.kernel import kernel
from mckibben.discretise.fields import place
from mckibben.experiments.foresee import BY_DIFFERENCES, refuse_friction
from mckibben.experiments.response import differentiable, settled
from mckibben.experiments.run import crowding_for, solved
from mckibben.measure.judge import Judgement
from mckibben.measure.read import read
from mckibben.measure.report import Part, versions
from mckibben.model.parameters import Number, parameters
from mckibben.results.sensitivity import ANGLES, Sensitivity, sensitivities
from mckibben.results.variables import OBSERVED
from mckibben.results.verdict import Verdict
from mckibben.solver.bench import Bench
from mckibben.solver.from_rest import reading, rest
from mckibben.solver.problem import Basis, Problem
from mckibben.solver.system import Unknowns
from mckibben.solver.threads import one_thread
from mckibben.spec import Muscle, SpecError, Step, Test, numbers
from mckibben.spec.declared import Declared, evolved
from mckibben.spec.errors import nearest
from mckibben.spec.text import to_toml

ZERO = 1e-9
"""Part of its natural size below which a result counts as zero: per cents of it would be those of rounding errors."""


def sensitivity(
    muscle: Muscle,
    test: Test,
    of: Sequence[str] | str | None = None,
    by: Sequence[str] | str | None = None,
    state: int = -1,
    *,
    tolerance: float = 1e-6,
) -> Sensitivity:
    """How much each number of the muscle and of the test matters to results at one state.

    Args:
        muscle: the specification.
        test: as for `run`; not along a branch.
        of: results: length, contraction, force, pressure, volume, air_volume, energy (or one of its parts),
            peak_fibre_tension, largest_radius. By default what the test is for (the force, or length and contraction
            where the force is held) and the peak fibre tension.
        by: numbers, such as "braid.angle", "chamber.law.c1", "test.pressure"; a name stands for all within it
            ("chamber"). By default every number on which one of the results depends.
        state: which state of the test, counted from 0, or from the last one as -1.
        tolerance: relative error aimed at in force and length.

    Returns:
        A `Sensitivity`: tables `relative` and `absolute`. Without an admissible state they hold NaN; `reason` says why.

    Raises:
        SpecError: for unknown names, a state that the test does not have, friction, or a test without derivatives.

    >>> test = mk.Isometric(length="115 mm", pressure="1 bar")
    >>> found = mk.sensitivity(mk.presets.paper(), test, of="force", by=["braid.angle", "test.length"])
    >>> print(found.table.round(2))
                  value  force
    test.length  115 mm   5.39
    braid.angle  37 deg   5.35
    """
    refuse_friction(muscle, "sensitivity", BY_DIFFERENCES)
    steps = differentiable(test.as_steps(muscle), muscle)
    index, row = _place(steps, state)
    columns = [list(OBSERVED).index(name) for name in _results(of, steps[index])]
    known = {name: (declared, number) for name, declared, number in numbers(muscle)}
    known |= {f"test.{name}": (declared, number) for name, declared, number in numbers(test)}
    wanted = _numbers(by, tuple(known))
    bench = Bench.of(muscle)
    parts = solved(bench, steps, crowding_for(bench, steps), tolerance)
    judgement = _judgement(parts[index], row)
    value, slope, size = _derivatives(muscle, test, steps, parts, index, row, judgement, len(known))
    value, slope, size = value[columns], slope[:, columns], size[columns]
    rows = [k for k, name in enumerate(known) if name in wanted and (by is not None or (slope[k] != 0.0).any())]
    names, slope = [list(known)[k] for k in rows], slope[rows]
    at = np.array([float(known[name][1]) for name in names])[:, None]
    meaningful = (np.abs(value) > ZERO * size) & (at != 0.0)
    share = np.where(meaningful, at * slope, np.nan) / np.where(value == 0.0, 1.0, value)
    state = sum(step.points for step in steps[:index]) + row
    about = {
        "title": f"McKibben muscle, {test.kind} test, state {state}: what matters",
        "state": state, "verdict": str(judgement.verdict), "reason": judgement.reason,
        "muscle": to_toml(muscle, allow_custom=True), "test": to_toml(test), "assumed": ", ".join(muscle.assumed),
        "angles": ANGLES, "mckibben_version": versions()["mckibben"],
    }  # fmt: skip
    inputs = {name: _said(name, *known[name], muscle.assumed) for name in names}
    results = {}
    for column, number in zip(columns, value.tolist(), strict=True):
        name, (unit, meaning) = list(OBSERVED.items())[column]
        results[name] = {"value": number, "unit": unit, "meaning": meaning}
    return Sensitivity(muscle, test, sensitivities(inputs, results, share, slope, about))


def _place(steps: tuple[Step, ...], state: int) -> tuple[int, int]:
    """Step and row of a state of the whole test."""
    ends = np.cumsum([step.points for step in steps])
    total = int(ends[-1])
    if not -total <= state < total:
        raise SpecError("state", state, f"must be from {-total} to {total - 1}: the test has {total} states")
    index = int(np.searchsorted(ends, state % total, side="right"))
    return index, state % total - int(ends[index] - steps[index].points)


def _results(of: Sequence[str] | str | None, step: Step) -> tuple[str, ...]:
    """Names of the results asked for; those that a test is for if none are."""
    if of is None:
        free = next(name for name in ("force", "length", "pressure") if name not in step.controls)
        return (free, *(("contraction",) if free == "length" else ()), "peak_fibre_tension")
    names = (of,) if isinstance(of, str) else tuple(of)
    if not names:
        raise SpecError("of", allowed="must name at least one result", advice="one of " + ", ".join(OBSERVED))
    for name in names:
        if name not in OBSERVED:
            raise SpecError("of", name, "must be one of " + ", ".join(OBSERVED), nearest(str(name), tuple(OBSERVED)))
    return tuple(dict.fromkeys(names))


def _numbers(by: Sequence[str] | str | None, known: tuple[str, ...]) -> tuple[str, ...]:
    """Names of the numbers asked for; all of them if none are."""
    if by is None:
        return known
    wanted: list[str] = []
    for name in (by,) if isinstance(by, str) else tuple(by):
        inside = [full for full in known if _within(full, name)]
        if not inside:
            raise SpecError("by", name, "is no number of this muscle or test", nearest(str(name), known))
        wanted += inside
    return tuple(wanted)


def _within(name: str, field: str) -> bool:
    return name == field or name.startswith((f"{field}.", f"{field}["))


def _judgement(part: Part, row: int) -> Judgement:
    """Verdict on one state of a step."""
    if part.survey is not None and row < part.reached:
        return part.survey.verdicts[row]
    lost = Judgement.lost(part.why)
    return attrs.evolve(lost, verdict=Verdict.NO_EQUILIBRIUM) if row >= max(part.reached, part.possible) else lost


@one_thread()
def _derivatives(
    muscle: Muscle, test: Test, steps: tuple[Step, ...], parts: list[Part], index: int, row: int, judgement: Judgement,
    count: int,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:  # fmt: skip
    """The `OBSERVED` results at a state, their derivatives (numbers, results) and their natural sizes; NaN if none."""
    n = len(OBSERVED)
    if judgement.verdict not in (Verdict.STABLE, Verdict.UNSTABLE):
        return np.full(n, np.nan), np.full((count, n), np.nan), np.ones(n)
    # Before it, the ends of those steps are needed from whose present values it goes on.
    first, rows = index, [row]
    while first and _goes_on(steps[first]):
        first, rows = first - 1, [-1, *rows]
    surveys = [part.survey for part in parts[first : index + 1] if part.survey is not None]
    states = tuple(Unknowns(view.u[k], view.loads[k]) for view, k in zip(surveys, rows, strict=True))
    problem, plain = surveys[-1].problem, evolved(muscle, name=None, assumed=())
    value, slope = _slopes(problem.basis, first, problem.b, states, np.asarray(row), plain, test)
    return np.array(value), np.array(slope), _natural(problem)


def _goes_on(step: Step) -> bool:
    """Whether what a step holds depends on where the one before it ended."""
    return step.gas is not None or any(getattr(step, name).needs_present for name in step.controls)


@partial(kernel, static_argnums=(0, 1))
def _slopes(
    basis: Basis, first: int, b: Number, states: tuple[Unknowns, ...], row: Array, muscle: Muscle, test: Test
) -> tuple[Array, Array]:
    """The `OBSERVED` results at the last of the states, and their derivatives by every number (numbers, results).

    The states are those of the steps from `first` on: the ends of all but the last one, of which it is number `row`.
    """
    leaves, tree = jax.tree.flatten((muscle, test))
    last = len(states) - 1

    def results(leaves: Array) -> tuple[Array, Array]:
        muscle, test = jax.tree.unflatten(tree, list(leaves))
        p = parameters(muscle)
        on = place(basis, p, b)
        present = rest(on)
        for k, (step, near) in enumerate(zip(test.as_steps(muscle)[first:], states, strict=False)):
            at = settled(basis, p, b, near, step, present, row if k == last else -1)
            present = reading(basis, on, at)
        seen = read(basis, on, at).numbers
        found = jnp.stack([seen[name] for name in OBSERVED])
        return found, found

    at = jnp.stack([jnp.asarray(leaf, float) for leaf in leaves])
    slope, found = jax.jacfwd(results, has_aux=True)(at)
    return found, slope.T


def _natural(problem: Problem) -> np.ndarray:
    """A natural size of each result."""
    energy, length, volume, _ = problem.unit
    sizes = {"N": energy / length, "Pa": energy / volume, "J": energy, "m": length, "m^3": volume, "1": 1.0}
    return np.array([sizes[unit] for unit, _ in OBSERVED.values()])


def _said(name: str, declared: Declared, number: Number, assumed: tuple[str, ...]) -> dict[str, Any]:
    """What is known of a number."""
    plain = declared.kind == "constants"  # of a user's own law, whose units are not known
    return {
        "value": float(number),
        "unit": "" if plain else declared.unit or "1",
        "shown": f"{float(number):.6g}" if plain else declared.text(float(number)),
        "meaning": declared.meaning,
        "assumed": any(_within(name, field) for field in assumed),
    }

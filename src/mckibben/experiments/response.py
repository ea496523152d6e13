"""`response()`: the results of a test as a function that JAX can differentiate, batch and compile."""

from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Float

from mckibben.compiled.arrays import Array
from mckibben.compiled.kernel import kernel
from mckibben.discretise.fields import place
from mckibben.discretise.placement import crowdings
from mckibben.discretise.spectral import Line
from mckibben.experiments.foresee import BY_DIFFERENCES, refuse_friction
from mckibben.experiments.run import crowding_for, solved
from mckibben.measure.read import read
from mckibben.model.parameters import Number, Parameters, parameters
from mckibben.results.variables import OBSERVED
from mckibben.solver.bench import Bench
from mckibben.solver.from_rest import approach, reading, rest, wanted
from mckibben.solver.held import Now, rows_of
from mckibben.solver.implicit import settle
from mckibben.solver.problem import Basis
from mckibben.solver.system import Unknowns
from mckibben.spec import Along, Muscle, SpecError, Step, Test

__all__ = ["BEYOND", "differentiable", "honest", "response", "settled"]

SIZE = 24
"""Unknowns where the numbers are traced, so that an error estimate cannot be asked for."""
BEYOND = 1e308


def response(
    muscle: Muscle, test: Test, *, tolerance: float = 1e-6, size: int = SIZE
) -> dict[str, Float[Array, " states"]]:
    """Results of a test, state by state, differentiable by every number of the muscle and of the test.

    Muscles and tests are pytrees whose leaves are their numbers, so that `jax.grad(lambda m: mk.response(m,
    test)["force"][-1])(muscle)` is a muscle of derivatives. `jax.jit`, `vmap`, `jacobian` and `hessian` work too. The
    derivatives are those of the equilibrium (implicit function theorem), not of the search for it.

    Args:
        muscle: the specification; its numbers may be traced.
        test: as for `run`; not along a branch.
        tolerance: relative error aimed at in force and length, where the numbers are known.
        size: unknowns where they are not, as inside `jit` and `vmap`; the search is a simpler one there, too.

    Returns:
        Arrays over the states of the test, in SI units: length, contraction, force, pressure, volume,
        energy_bending_1, energy_bending_2, energy_twist, energy_chamber, energy, air_volume, peak_fibre_tension,
        largest_radius.
        A state that was not reached, or whose wall rolls up on itself, is NaN and its derivatives are not finite; they
        do not touch those of the others. States are as symmetric as the muscle, and are not judged further: `run` says
        which ones are stable and admissible.

    Raises:
        SpecError: for a test without derivatives, friction, or a tolerance out of range.

    >>> test = mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3)
    >>> found = mk.response(mk.presets.paper(), test)
    >>> found["force"].round(2).tolist()  # N
    [3.29, 52.36, 101.22]
    """
    refuse_friction(muscle, "response", BY_DIFFERENCES)
    steps = differentiable(test.as_steps(muscle), muscle)
    p = parameters(muscle)
    fixed_p, fixed_steps = jax.tree.map(jax.lax.stop_gradient, (p, steps))
    if any(isinstance(leaf, jax.core.Tracer) for leaf in jax.tree.leaves((fixed_p, fixed_steps))):
        basis: Basis = Line.of(muscle, size)
        b = placement(fixed_p, fixed_steps)
        states = approach(basis, fixed_p, b, fixed_steps)
    else:
        basis, b, states = solved_states(jax.tree.map(jax.lax.stop_gradient, muscle), fixed_steps, tolerance)
    return _results(basis, b, states, p, steps)


def differentiable(steps: tuple[Step, ...], muscle: Muscle) -> tuple[Step, ...]:
    """The steps; SpecError for those whose states are no function of the numbers given."""
    first = steps[0]
    if muscle.end_radii is not None and (
        first.gas is not None or any(getattr(first, name).needs_present for name in first.controls)
    ):
        said = "has no derivatives where the test begins at what the muscle reads as mounted"
        raise SpecError("muscle.end_radii", allowed=said, advice='say where it begins, such as pressure = "0 to 1 bar"')
    for step in steps:
        if step.along == Along.BRANCH:
            advice = 'leave it out, or give the values of what is held ("values")'
            raise SpecError(
                "step.along", str(step.along), "places its states by itself, which have no derivatives", advice
            )
    return steps


def placement(p: Parameters, steps: tuple[Step, ...]) -> Number:
    """Crowding of points that serves all steps."""
    rows = []
    for step in steps:
        known = {name: getattr(step, name).waypoints for name in step.controls}
        none = () if known.get("length") or known.get("force") else (p.rest,)
        for h in known.get("length") or none or (jnp.nan,):
            for F in known.get("force") or (jnp.nan,):
                rows += [jnp.stack([jnp.asarray(x, float) for x in (h, F, P)]) for P in known.get("pressure") or (0.0,)]
    return crowdings(p, *jnp.stack(rows).T).max()


def solved_states(
    muscle: Muscle, steps: tuple[Step, ...], tolerance: float
) -> tuple[Basis, float, tuple[Unknowns, ...]]:
    """Discretisation, placement and states of every step by the robust search; NaN where there are none."""
    bench = Bench.of(muscle)
    parts = solved(bench, steps, crowding_for(bench, steps), tolerance)
    problem = next((part.survey.problem for part in parts if part.survey is not None), None)
    if problem is None:
        problem = bench.problem(SIZE, 1.0)
    states = []
    for part in parts:
        u: Array = jnp.full((part.asked, problem.basis.unknowns), jnp.nan)
        loads: Array = jnp.full((part.asked, problem.loads), jnp.nan)
        if part.survey is not None:
            u, loads = u.at[: part.reached].set(part.survey.u), loads.at[: part.reached].set(part.survey.loads)
        states.append(Unknowns(u, loads))
    return problem.basis, problem.b, tuple(states)


def settled(
    basis: Basis, p: Parameters, b: Number, near: Unknowns, step: Step, present: Now, row: Any = None
) -> Unknowns:
    """The states of a step (or the one in its `row`) as functions of the numbers, from states that are known."""
    asked, loads = wanted(step, present, place(basis, p, b)), near.loads.shape[-1]
    own, rows = rows_of(asked.names, loads)
    targets = asked.targets if loads == 2 else jnp.pad(asked.targets, ((0, 0), (0, 1)))
    one = partial(_settled_one, (basis, own), p, b, jnp.asarray(rows))
    return one(near, targets[row]) if row is not None else jax.vmap(one)(near, targets)


def _settled_one(static: Any, p: Parameters, b: Number, rows: Array, near: Unknowns, target: Array) -> Unknowns:
    return settle(static, near, p, b, rows, target)


@kernel
def _results(
    basis: Basis, b: Number, states: tuple[Unknowns, ...], p: Parameters, steps: tuple[Step, ...]
) -> dict[str, Array]:
    """Results at states that are known, as functions of the numbers."""
    on = place(basis, p, b)
    present = rest(on)
    everything = jnp.sum(jnp.stack([jnp.asarray(leaf, float) for leaf in jax.tree.leaves((p, steps))]))
    still = everything - jax.lax.stop_gradient(everything)
    found = []
    for step, near in zip(steps, states, strict=True):
        state = settled(basis, p, b, near, step, present)
        good = jnp.isfinite(state.u).all(axis=1)
        safe = jax.tree.map(lambda row, good=good: jnp.where(good[:, None], row, 0.0), state)
        seen = jax.vmap(partial(read, basis, on))(safe)
        good = good & (seen.largest_slope <= jnp.pi)
        found.append({name: honest(seen.numbers[name], good, still) for name in OBSERVED})
        present = reading(basis, on, jax.tree.map(lambda row: row[-1], state))
    return {name: jnp.concatenate([seen[name] for seen in found]) for name in OBSERVED}


def honest(values: Array, good: Array, still: Array) -> Array:
    """NaN where there is no state, and derivatives there that are not finite.

    The values there are finite stand-ins, since one NaN would spoil every derivative of the others in reverse mode (as
    0 NaN). Instead `still`, which is zero and depends on every number, is multiplied twice by something large: what is
    asked for becomes infinite, and zeros stay zero.
    """
    beyond = jnp.where(good, 0.0, BEYOND)
    return jnp.where(good, values, jnp.nan) + still * beyond * beyond

"""`response()`: the results of a test as a function that JAX can differentiate, batch and compile."""

from functools import partial
from typing import Any

from jaxtyping import Float

from .discretise.line import Line
from .experiment import Bench, solved
from .lazy import Array, jax, jnp
from .model.chamber import law_of
from .model.parameters import Number, Parameters, parameters
from .observe import OBSERVED, observe
from .solver.approach import approach, targets, units
from .solver.equilibrium import selection
from .solver.implicit import potential, settle
from .solver.placement import crowdings
from .solver.problem import Space
from .spec import Along, Muscle, SpecError, Step, Test

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
        test: as for `run`; not with gas sealed in, nor along a branch.
        tolerance: relative error aimed at in force and length, where the numbers are known.
        size: unknowns where they are not, as inside `jit` and `vmap`; the search is a simpler one there, too.

    Returns:
        Arrays over the states of the test, in SI units: length, contraction, force, pressure, volume,
        energy_bending_1, energy_bending_2, energy_twist, energy_chamber, energy, peak_fibre_tension, largest_radius.
        A state that was not reached is NaN and its derivatives are not finite; they do not touch those of the others.
        States are symmetric and are not judged: `run` says which ones are stable and admissible.

    Raises:
        SpecError: for a test without derivatives, or a tolerance out of range.
    """
    steps = differentiable(test.as_steps(muscle))
    p, law = parameters(muscle), law_of(muscle)
    fixed_p, fixed_steps = jax.tree.map(jax.lax.stop_gradient, (p, steps))
    if any(isinstance(leaf, jax.core.Tracer) for leaf in jax.tree.leaves((fixed_p, fixed_steps))):
        space = Space(Line(size, str(muscle.ends)), law)
        b = placement(space, fixed_p, fixed_steps)
        states = approach(space, fixed_p, b, fixed_steps)
    else:
        space, b, states = known(jax.tree.map(jax.lax.stop_gradient, muscle), fixed_steps, tolerance)
    return _results(space, b, states, p, steps)


def differentiable(steps: tuple[Step, ...]) -> tuple[Step, ...]:
    """The steps; SpecError for those whose states are no function of the numbers given."""
    for step in steps:
        if step.gas is not None:
            advice = "hold the pressure or the volume instead"
            raise SpecError("step.gas", str(step.gas), "has no derivatives yet", advice)
        if step.along == Along.BRANCH:
            advice = 'leave it out, or give the values of what is held ("values")'
            raise SpecError(
                "step.along", str(step.along), "places its states by itself, which have no derivatives", advice
            )
    return steps


def placement(space: Space, p: Parameters, steps: tuple[Step, ...]) -> Number:
    """Crowding of points that serves all steps."""
    rows = []
    for step in steps:
        known = {name: getattr(step, name).waypoints for name in step.controls}
        none = () if known.get("length") or known.get("force") else (p.H0,)
        for h in known.get("length") or none or (jnp.nan,):
            for F in known.get("force") or (jnp.nan,):
                rows += [jnp.stack([jnp.asarray(x, float) for x in (h, F, P)]) for P in known.get("pressure") or (0.0,)]
    return crowdings(space.law, p, *jnp.stack(rows).T).max()


def known(muscle: Muscle, steps: tuple[Step, ...], tolerance: float) -> tuple[Space, float, tuple[Any, ...]]:
    """Space, placement and states of every step by the robust search; NaN where there are none."""
    bench = Bench.of(muscle)
    parts = solved(bench, steps, tolerance)
    problem = next((part.survey.problem for part in parts if part.survey is not None), None)
    if problem is None:
        problem = bench.problem(SIZE, 1.0)
    states = []
    for part in parts:
        rows = jnp.full((part.asked, problem.space.basis.unknowns + 2), jnp.nan)
        if part.survey is not None:
            found = jnp.concatenate([part.survey.u, part.survey.loads[:, 1:3]], axis=1)
            rows = rows.at[: part.reached].set(found)
        states.append(rows)
    return problem.space, problem.b, tuple(states)


@partial(jax.jit, static_argnums=0)
def _results(
    space: Space, b: Number, states: tuple[Array, ...], p: Parameters, steps: tuple[Step, ...]
) -> dict[str, Array]:
    """Results at states that are known, as functions of the numbers."""
    unit = units(space, p)
    present = jnp.array([1.0, 1.0, 0.0, 0.0])
    everything = jnp.sum(jnp.stack([jnp.asarray(leaf, float) for leaf in jax.tree.leaves((p, steps))]))
    still = everything - jax.lax.stop_gradient(everything)
    found = []
    for step, near in zip(steps, states, strict=True):
        wanted, select = targets(step, present, unit), jnp.asarray(selection(step.controls))
        w = jax.vmap(lambda w, t, s=select: settle(space, w, p, b, s, t))(near, wanted)
        good = jnp.isfinite(w).all(axis=1)
        seen = jax.vmap(lambda w: observe(space, p, b, w))(jnp.where(good[:, None], w, 0.0))
        seen = {name: _honest(values, good, still) for name, values in seen.items()}
        present = potential(space, p, b, w[-1])[1]
        found.append(seen)
    return {name: jnp.concatenate([seen[name] for seen in found]) for name in OBSERVED}


def _honest(values: Array, good: Array, still: Array) -> Array:
    """NaN where there is no state, and derivatives there that are not finite.

    The values there are finite stand-ins, since one NaN would spoil every derivative of the others in reverse mode (as
    0 NaN). Instead `still`, which is zero and depends on every number, is multiplied twice by something large: what is
    asked for becomes infinite, and zeros stay zero.
    """
    beyond = jnp.where(good, 0.0, BEYOND)
    return jnp.where(good, values, jnp.nan) + still * beyond * beyond

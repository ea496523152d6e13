"""One step of a muscle whose crossings or chamber rub: the state at new targets, from what its points remember.

Newton minimises the energy of the step at fixed moments M, and forces at which the chamber slides; the tension and the
pressure on the mesh of the state found give them anew, until they settle. Then the memory moves on. All of it is one
compiled function.
"""

from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Bool, Float, Int

from mckibben.compiled.arrays import Array
from mckibben.compiled.kernel import kernel
from mckibben.discretise.fields import Placed, place, points_at, states
from mckibben.measure.read import costates, nodes
from mckibben.model.energy import remember, works
from mckibben.model.friction import Remembered, as_made, crossings, slip_moment, turn
from mckibben.model.gap import inflated
from mckibben.model.parameters import Number, Parameters
from mckibben.model.point import Point
from mckibben.model.slide import grip, slide_limit
from mckibben.model.tension import tension
from mckibben.solver.held import conditions
from mckibben.solver.newton import correct
from mckibben.solver.problem import Basis
from mckibben.solver.system import Unknowns, system

__all__ = ["Stepped", "fresh", "rub", "rub_along"]

CORRECTIONS = 40
"""Newton systems at most for one set of moments: a few where all crossings go on, some ten where they turn back."""
CLOSE = 1e-9
"""Largest change of an unknown in the last Newton step, at most."""
ROUNDS = 20
"""Sets of moments at most; each is closer than the one before by about mu a/l, some hundredth."""
SETTLED = 1e-8
"""Largest change of a moment, or of the chamber's limit, in the last round over the largest one, at most."""
NOTHING = 1e-12
"""Moments are none whose work, where all crossings turn by 1 rad, is less than this over the unit of energy: those that
the rounding of a tension leaves where there is none."""
ROUGH, SHARE = 1e-4, 1e-2
"""What is enough of `CLOSE` in a round whose moments are not the last: the first one, and over the change of moments in
the round before in the others."""
FREE, SLOW, LEAST = 6, 0.6, 0.125
"""Newton steps that are always whole; change of a later one, over that of the one before, above which the next is
halved, lest points go on changing between sticking and slipping; and the least part that is taken of a step."""

GRIPS = 0.5
"""Change of the chamber's limits in a round, over the largest, from which on the next one begins as if nothing slid."""

STRAIGHT, FORETOLD = 1e-6, 4.0
"""Of a step along a path: how far it may lie off the direction of the one before, over its length, and how many times
as long it may be, for its state to be foretold from the two before."""


class Stepped(NamedTuple):
    """A state with what it was found from and what it leaves behind."""

    state: Unknowns  #: with the memory of its quadrature points as the step began, and the moments it ended with
    kept: Remembered  #: the same of the output points
    next_inner: Remembered  #: what the points remember from now on
    next_outer: Remembered
    totals: Float[Array, "2"]  #: length [m] and volume [m^3]
    dissipated: Float[Array, ""]  #: in this step [J]
    largest_turn: Float[Array, ""]  #: of a crossing in this step [rad]
    iterations: Int[Array, ""]
    good: Bool[Array, ""]


class _Round(NamedTuple):
    state: Unknowns
    change: Array  #: largest change of a moment over the largest moment, and the same of the chamber's limits
    step: Array  #: largest change of an unknown in the last Newton step
    rounds: Array
    iterations: Array
    good: Array


def fresh(basis: Basis, p: Parameters) -> tuple[Remembered, Remembered]:
    """Memories as made, of the quadrature points and the output points."""
    made, counts = as_made(p), (basis.points, nodes(basis))
    inner, outer = (jax.tree.map(partial(jnp.full, count), made) for count in counts)
    return inner, outer


class _Way(NamedTuple):
    """How far a path has been walked."""

    done: Array
    state: Unknowns  #: with what its points remember from now on
    outer: Remembered
    before: Unknowns  #: the state before, with the moments that it ended with
    rows: Stepped
    going: Array


@kernel
def rub_along(
    static: tuple[Basis, Any],
    p: Parameters,
    b: Number,
    state: Unknowns,
    kept: Remembered,
    which: Int[Array, " l"],
    targets: Float[Array, "n l"],
    count: Int[Array, ""],
    farthest: Float[Array, ""],
) -> Stepped:
    """One state after another at `targets`, of which the first are those of `state`, and as many as `count` count.

    It ends after a step that is not good, or in which a crossing turns by more than `farthest` [rad]; rows after that
    are zero, and not good. A path that goes straight on is foretold from the two states before; where it turns round,
    the first Newton step is taken as if no crossing slipped.
    """
    basis, own = static
    on = place(basis, p, b)

    def step(k: Array, way: _Way) -> Stepped:
        last, now, to = targets[jnp.maximum(k - 1, 0)], targets[k], targets[k + 1]
        ahead, was = to - now, now - last
        share = ahead @ was / jnp.maximum(was @ was, 1e-300)
        straight = (k > 0) & (share > 0.0) & (share <= FORETOLD)
        straight = straight & (jnp.abs(ahead - share * was).max() <= STRAIGHT * jnp.abs(ahead).max())
        share = jnp.where(straight, share, 0.0)
        guess = _foretold(way.before, way.state, share)
        return _stepped(basis, own, on, way.state, guess, way.outer, which, to, ~straight)

    def more(way: _Way) -> Array:
        return (way.done < count) & way.going

    def again(way: _Way) -> _Way:
        found = step(way.done, way)
        rows = jax.tree.map(lambda row, new: row.at[way.done].set(new), way.rows, found)
        new = found.state._replace(memory=found.next_inner)
        good = found.good & (found.largest_turn <= farthest)
        return _Way(way.done + 1, new, found.next_outer, way.state, rows, good)

    none = jnp.zeros((), int)
    blank = jax.eval_shape(lambda: _stepped(basis, own, on, state, state, kept, which, targets[0], jnp.array(True)))
    rows = jax.tree.map(lambda one: jnp.zeros((len(targets) - 1, *one.shape), one.dtype), blank)
    start = _Way(none, state, kept, state, rows, jnp.array(True))
    walked: Stepped = jax.lax.while_loop(more, again, start).rows
    return walked


def _foretold(before: Unknowns, now: Unknowns, share: Array) -> Unknowns:
    """What a state is sought from, by a share of the last step: shape, loads, and at what the points slip."""
    u, loads = (new + share * (new - old) for new, old in zip(now[:2], before[:2], strict=True))
    memory, old = now.memory, before.memory
    moment = jnp.maximum(memory.moment + share * (memory.moment - old.moment), 0.0)
    return Unknowns(u, loads, memory._replace(moment=moment))


@kernel
def rub(
    static: tuple[Basis, Any],
    p: Parameters,
    b: Number,
    state: Unknowns,
    kept: Remembered,
    which: Int[Array, " l"],
    targets: Float[Array, " l"],
    stuck: Bool[Array, ""],
) -> Stepped:
    """The state at `targets` from one with its memory, `kept` that of the output points.

    `stuck` has the first Newton step taken as if no crossing slipped: then it does not matter which of those at their
    limit are so by a rounding error.
    """
    basis, own = static
    return _stepped(basis, own, place(basis, p, b), state, state, kept, which, targets, stuck)


def _stepped(
    basis: Basis, own: Any, on: Placed, begun: Unknowns, guess: Unknowns, kept: Remembered, which: Array,
    targets: Array, stuck: Array,
) -> Stepped:  # fmt: skip
    """The state at `targets` from the state `begun`, sought from a guess."""
    p = on.p
    slides = p.friction.chamber is not None

    def newton(state: Unknowns) -> tuple[Unknowns, Array, Array]:
        s = system(basis, on, state)
        c = correct(s, conditions(own, which, targets, on, s, state.loads))
        new = state._replace(u=state.u + c.step.u, loads=state.loads + c.step.loads)
        return new, jnp.abs(c.step.u).max(), c.stable

    def solved(start: Unknowns, stuck: Array, close: Array) -> tuple[Unknowns, Array, Array, Array]:
        sticks = _stuck(start.memory, p)

        def more(now: Any) -> Array:
            _, change, taken, stable, _ = now
            return (change > close) & (taken < CORRECTIONS) & stable

        def again(now: Any) -> Any:
            state, before, taken, _, share = now
            first = stuck & (taken == 0)
            held = jax.tree.map(lambda one, other: jnp.where(first, one, other), sticks, start.memory)
            new, change, stable = newton(state._replace(memory=held))
            circles = (change > SLOW * before) & (taken >= FREE)
            share = jnp.clip(jnp.where(circles, 0.5 * share, 1.4 * share), LEAST, 1.0)
            new = jax.tree.map(lambda a, b: a + share * (b - a), state, new._replace(memory=state.memory))
            return new, change, taken + 1, stable, share

        begin = (start, jnp.asarray(jnp.inf), jnp.zeros((), int), jnp.array(True), jnp.ones(()))
        found, change, taken, stable, _ = jax.lax.while_loop(more, again, begin)
        return found._replace(memory=start.memory), change, taken, stable if slides else stable & (change <= close)

    def more(now: _Round) -> Array:
        return ((now.change > SETTLED) | (now.step > CLOSE)) & (now.rounds < ROUNDS) & now.good

    def again(now: _Round) -> _Round:
        close = jnp.clip(SHARE * now.change, CLOSE, ROUGH)
        afresh = stuck & (now.rounds == 0)
        if slides:  # points that slid freely so far would be thrown back too far by a limit that is new to them
            afresh = afresh | ((now.change > GRIPS) & (now.rounds > 0))
        found, step, taken, good = solved(now.state, afresh, close)
        inner = limits(basis, on, found)
        change = _change(inner, found.memory, on)
        return _Round(found._replace(memory=inner), change, step, now.rounds + 1, now.iterations + taken, good)

    none = jnp.zeros((), int)
    far = jnp.asarray(jnp.inf)
    start = _Round(guess, far, far, none, none, jnp.array(True))
    found = jax.lax.while_loop(more, again, start)
    return _after(basis, on, begun, found, outer_limits(basis, on, found.state, kept))


def _after(basis: Basis, on: Placed, begun: Unknowns, found: _Round, kept: Remembered) -> Stepped:
    """What a step from a state leaves behind."""
    p, state = on.p, found.state
    inner, outer = states(basis, on, state.u), points_at(basis, on, state.u, basis.sampling(nodes(basis)))
    next_inner, next_outer = (
        jax.vmap(lambda at, memory: remember(at, p, memory))(at, memory)
        for at, memory in ((inner, state.memory), (outer, kept))
    )

    def turned(at: Point) -> Array:
        return jax.vmap(lambda at: turn(at, p))(at)

    P = state.loads[1] * on.unit[0] / on.unit[2]
    rates = jax.vmap(lambda at: works(inflated(at, P, p), p))(inner)
    mean = 0.5 * (begun.memory.moment + state.memory.moment)  # of second order in the step, and never negative
    slipped = mean * jnp.abs(next_inner.alpha - state.memory.alpha)
    weights = jnp.asarray(basis.operators().weights) * on.jacobian
    many = crossings(inner, p)
    lost = many * (weights @ slipped) if inner.made is None else weights @ (many * slipped)
    if state.memory.slid is not None:
        mean = 0.5 * (begun.memory.limit + state.memory.limit)
        lost = lost + weights @ (mean * jnp.abs(next_inner.slid - state.memory.slid))
    settled = (found.change <= SETTLED) & (found.step <= CLOSE)
    good = found.good & settled & jnp.isfinite(state.u).all()
    return Stepped(
        state, kept, next_inner, next_outer, jnp.stack([weights @ one for one in rates[:2]]),
        lost, jnp.abs(turned(inner) - turned(states(basis, on, begun.u))).max(), found.iterations, good,
    )  # fmt: skip


def _stuck(memory: Remembered, p: Parameters) -> Remembered:
    """A memory by which nothing slips: not within a turn of 1 rad and a slide of H0."""
    sticks = memory._replace(moment=jnp.full_like(memory.moment, p.friction.stiffness))
    return sticks if memory.slid is None else sticks._replace(limit=jnp.full_like(memory.limit, p.H0 * grip(p)))


def _change(new: Remembered, old: Remembered, on: Placed) -> Array:
    """Largest change of a moment over the largest one, and the same of the forces at which the chamber slides.

    What is none is not told by its largest: moments by `NOTHING`, forces that would move the chamber by less than
    `CLOSE` of H0.
    """
    p = on.p
    least = NOTHING / SETTLED * on.unit[0] / (p.N**2 * p.H0 / (4.0 * jnp.pi * p.R0))
    change = jnp.abs(new.moment - old.moment).max() / jnp.maximum(new.moment.max(), least)
    if new.slid is None:
        return change
    least = CLOSE / SETTLED * on.unit[0] / p.H0**2
    return jnp.maximum(change, jnp.abs(new.limit - old.limit).max() / jnp.maximum(new.limit.max(), least))


def limits(basis: Basis, on: Placed, state: Unknowns) -> Remembered:
    """What the quadrature points remember, with M by the tension of a state and the chamber's limit by its pressure on
    the mesh."""
    p, (F, P, M) = on.p, _loads(basis, on, state)
    at = jax.vmap(lambda at: inflated(at, P, p))(states(basis, on, state.u))
    along = costates(basis, on, at, (F, P, M), basis.sampling(nodes(basis)), state.memory)[0]
    found: Remembered = jax.vmap(partial(_limit, F, P, p))(at, along, state.memory)
    return found


def outer_limits(basis: Basis, on: Placed, state: Unknowns, kept: Remembered) -> Remembered:
    """The same of the output points, whose own memory is `kept`: by as many rounds as their moments need."""
    p, (F, P, M), sampling = on.p, _loads(basis, on, state), basis.sampling(nodes(basis))
    inner, outer = states(basis, on, state.u), points_at(basis, on, state.u, sampling)
    inner, outer = (jax.vmap(lambda at: inflated(at, P, p))(one) for one in (inner, outer))
    along = costates(basis, on, inner, (F, P, M), sampling, state.memory)[1]

    def more(now: tuple[Remembered, Array, Array]) -> Array:
        return (now[1] > SETTLED) & (now[2] < ROUNDS)

    def again(now: tuple[Remembered, Array, Array]) -> tuple[Remembered, Array, Array]:
        new = jax.vmap(partial(_limit, F, P, p))(outer, along, now[0])
        return new, _change(new, now[0], on), now[2] + 1

    found: Remembered = jax.lax.while_loop(more, again, (kept, jnp.asarray(jnp.inf), jnp.zeros((), int)))[0]
    return found


def _loads(basis: Basis, on: Placed, state: Unknowns) -> tuple[Any, Any, Any]:
    """Force [N], pressure [Pa] and closing moment."""
    F, P = state.loads[0] * on.unit[0] / on.unit[1], state.loads[1] * on.unit[0] / on.unit[2]
    return F, P, state.loads[2] * on.unit[0] if basis.closes else 0.0


def _limit(F: Number, P: Number, p: Parameters, at: Point, c: tuple[Array, ...], memory: Remembered) -> Remembered:
    moment = slip_moment(at, tension(at, c, F, P, p, memory), p)
    return memory._replace(moment=moment, limit=None if memory.slid is None else slide_limit(at, P, p))

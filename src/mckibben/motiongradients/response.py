"""`motion_response()`: a rig in motion as a function that JAX can differentiate, batch and compile."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Float

from mckibben.compiled.arrays import Array
from mckibben.compiled.kernel import kernel
from mckibben.experiments.response import BEYOND, honest
from mckibben.motion.energies import of_muscles, of_rig
from mckibben.motion.maps import maps_of
from mckibben.motion.plant import Plant, without_rubber
from mckibben.motion.regime import Seen
from mckibben.motion.simulate import check_simulation, read_time
from mckibben.motiongradients.along import Pattern, gone_along
from mckibben.motiongradients.known import Beforehand, Request, concrete, kept_by, simulated_at
from mckibben.motiongradients.moments import commanding, sources_of
from mckibben.motiongradients.rows import kinds_of
from mckibben.motiongradients.starting import started
from mckibben.motiongradients.traced import TracedMap
from mckibben.potential.evaluate import Table
from mckibben.spec.controls import Controller
from mckibben.spec.errors import SpecError
from mckibben.spec.rig import Rig
from mckibben.units import is_traced

__all__ = ["motion_response"]

ROOM = 1024
"""Rows of a motion whose numbers are not there yet."""
KEPT = 16
"""Commands that such a motion may hold back."""
ROOMS = (64, 1_000_000)


def motion_response(
    rig: Rig, until: Any, *, chart: Any = None, points: int = 101, tolerance: float = 1e-6, room: int = ROOM
) -> dict[str, Float[Array, " ..."]]:
    """What `simulate` gives, as arrays that are differentiable by every number of load, air, valve and command.

    Rigs are pytrees whose leaves are their numbers, so that `jax.grad(lambda rig: mk.motion_response(rig, "1 s",
    chart=chart)["length"][-1])(rig)` is a rig of derivatives; `jacfwd`, `hessian`, `jit` and `vmap` work too. The
    motion is simulated by SciPy's RK45, and its steps are gone along once more. Jumps of commands move with their
    times, and ends of modes (stops, friction, slack cables) with the state. No step goes over a kink of a valve's flow.

    Args:
        rig: as for `simulate`; its numbers may be traced. Not with a `Controller`, nor with friction at the crossings.
        until: how long [s], such as "2 s".
        chart: the map of the muscle (or of both), as `mk.chart` gives it. It is made where it is left out, unless all
            numbers of the rig are traced by `jit` or `vmap`.
        points: times in the answer, evenly spread.
        tolerance: relative error of a step.
        room: steps of a motion for which there is room inside `jit` and `vmap`, where their number cannot be known.

    Returns:
        Arrays over the times, of two muscles over times and muscles, in SI units. They are "time" and what
        `Motion.data` has as numbers, such as length, speed, force, pressure, consumed and angle. Where a motion stops
        early they are NaN, and derivatives there not finite. The map is held: derivatives by the muscle's own numbers
        are not finite, nor is that by a friction of 0. At a command of exactly 0, where the flow has a kink, the
        derivative is that of opening to the supply; at a delay of 0 and a jump at time 0 that of a later one.

    Raises:
        SpecError: as `simulate`; for what has no derivatives; for a map that is not one of `chart`. Inside `jit` and
            `vmap` what depends on the numbers is raised by JAX when it runs.

    >>> rig = mk.Rig(
    ...     muscle=mk.presets.paper(), load=mk.FixedEnd(length="100 mm"), command=1.0,
    ...     supply=mk.Supply(gauge="2 bar"), valve=mk.Valve(C="0.02 L/s/bar", b=0.3),
    ... )
    >>> found = mk.motion_response(rig, until="0.5 s", points=3)
    >>> found["pressure"].round(-3).tolist()  # Pa
    [0.0, 39000.0, 76000.0]
    """
    if not isinstance(rig, Rig):
        said = "such as mk.Rig(muscle=..., load=..., supply=..., valve=...)"
        raise SpecError("motion_response.rig", rig, "must be a Rig", said)
    end = read_time(until, "motion_response.until")
    check_simulation(points, tolerance, "RK45", "motion_response")
    if isinstance(room, bool) or not isinstance(room, int) or not ROOMS[0] <= room <= ROOMS[1]:
        raise SpecError("motion_response.room", room, f"must be a whole number from {ROOMS[0]} to {ROOMS[1]}")
    _refuse(rig)
    plain = concrete(rig)
    charts = _charts(rig, plain, chart)
    tables = tuple(TracedMap(one.table, without_rubber(one)) for one in charts)
    friction = getattr(rig.load, "friction", 0.0)
    kinds = kinds_of(Plant.of(rig, tables), is_traced(friction) or friction > 0.0)
    way = Pattern(sources_of(rig), kinds, KEPT if plain is None else kept_by(plain))
    asked = Request(end, points, tolerance, room)
    return _response(way, tables, rig, simulated_at(rig, charts, way, asked), asked.times)


def _refuse(rig: Rig) -> None:
    """SpecError for what has no derivatives."""
    for k in range(len(rig.muscles)):
        if isinstance(commanding(rig, k)[0], Controller):
            said = "is a Controller: a function of Python's that has no derivatives"
            raise SpecError(("rig.command", "rig.antagonist_command")[k], allowed=said, advice="use a PID or a signal")
    for name, muscle in zip(("muscle", "antagonist"), rig.muscles, strict=False):
        if muscle.friction is not None:
            said = "has no derivatives in motion: crossings that stick remember their path"
            raise SpecError(f"{name}.friction", allowed=said, advice=f'leave it out: {name}.replace("friction", None)')


def _charts(rig: Rig, plain: Rig | None, chart: Any) -> tuple[Any, ...]:
    """The map of each muscle, which may be compared with it where its numbers are known."""
    if plain is not None:
        charts = maps_of(plain, chart)
    elif chart is None:
        said = "is left out, and none can be made of a muscle whose numbers are not there yet, inside jit or vmap"
        raise SpecError("motion_response.chart", allowed=said, advice="make it before: mk.chart(muscle, ...)")
    else:
        charts = tuple(chart) if isinstance(chart, (tuple, list)) else (chart,) * len(rig.muscles)
        if len(charts) != len(rig.muscles):
            said = f"must be {len(rig.muscles)}, one for each muscle, not {len(charts)}"
            raise SpecError("motion_response.chart", allowed=said)
    for one in charts:
        if not isinstance(getattr(one, "table", None), Table):
            said = "must be a map that mk.chart gives: others have no derivatives"
            raise SpecError("motion_response.chart", one, said)
    return charts


@kernel
def _response(
    way: Pattern, tables: tuple[TracedMap, ...], rig: Rig, known: Beforehand, times: Any
) -> dict[str, Float[Array, " ..."]]:
    plant, y = started(Plant.of(rig, tables), known.begin)
    found = jax.tree.map(lambda one: one[known.at], gone_along(way, plant, y, known.rows))
    seen = {name: jnp.stack([getattr(one, name) for one in found.muscles], axis=1) for name in Seen._fields}
    muscles = of_muscles(plant, found.y, seen)
    answer = muscles if plant.n > 1 else {name: values[:, 0] for name, values in muscles.items()}
    answer |= of_rig(plant, found.y, muscles)
    unknown, everything = _still(rig)
    good = known.at >= 0
    large = jnp.where(known.begin.at >= 0, BEYOND, 0.0)  # always, but no compiler may multiply it by itself beforehand
    lost = unknown * large * large

    def told(values: Array) -> Array:
        return honest(values, good.reshape(-1, *(1,) * (values.ndim - 1)), everything) + lost

    return {"time": jnp.asarray(times)} | {name: told(values) for name, values in answer.items()}


def _still(rig: Rig) -> tuple[Any, Any]:
    """Two zeros that depend on numbers by which there are no derivatives, and on all numbers.

    Multiplied twice by something large, they make derivatives infinite that were asked for, and leave others alone.
    """
    friction = getattr(rig.load, "friction", None)
    none = [] if friction is None else [jnp.where(friction == 0.0, friction, 0.0)]  # a rig without has no such modes
    unknown, everything = (
        jnp.sum(jnp.stack([jnp.asarray(leaf, float) for leaf in leaves]))
        for leaves in ([*jax.tree.leaves(rig.muscles), *none], jax.tree.leaves(rig))
    )
    return unknown - jax.lax.stop_gradient(unknown), everything - jax.lax.stop_gradient(everything)

"""`effects()`: how much each effect that the paper leaves out matters for a muscle, computed with it and without."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Iterable
from typing import Any

import attrs
import numpy as np

from mckibben.experiments.run import run
from mckibben.experiments.solve import solve
from mckibben.measure.caution import MuscleWarning
from mckibben.results.effects import QUANTITIES, Effects
from mckibben.results.result import Result, State
from mckibben.results.verdict import Verdict
from mckibben.spec import Fittings, Friction, Isometric, Muscle, SpecError, Step
from mckibben.spec.declared import evolved
from mckibben.spec.friction import held_to_mesh
from mckibben.spec.text import to_toml
from mckibben.units import show

__all__ = ["EFFECTS", "Effect", "effects"]


@attrs.frozen
class Effect:
    """One effect: the field that switches it, and what it says with and without."""

    name: str
    field: str
    on: Any
    off: Any
    switch: str  #: what to write into a case file
    assumed: bool = False  #: whether its size rests on a number that is not the muscle's own


_COMPLIANCE = "0.01 mm/N"
_CROSSINGS, _SLIDING = "friction at the crossings", "chamber sliding along the mesh"
FILLED, CLOSE = 11, 1e-4
"""States from no pressure to that asked for, by which a chamber that slides is filled: twice as many change its force
by some mN; and what its error is aimed at, which is far below what it changes."""

EFFECTS = (
    Effect("stretch of the fibres", "braid.fibre.stretch", True, False, "braid.fibre.stretch = true"),
    Effect("roll at the crossings", "braid.joint", "pin", "hinge", 'braid.joint = "pin"'),
    Effect("wall inside the braid", "chamber.lies", "inside", "outside", 'chamber.lies = "inside"'),
    Effect("thickness of the wall", "chamber.wall", "thick", "thin", 'chamber.wall = "thick"'),
    Effect("gap between tube and braid", "chamber.gap", True, False, "chamber.gap = true"),
    Effect(
        "fittings that give way", "fittings", Fittings(compliance=_COMPLIANCE), None,
        f'fittings.compliance = "{_COMPLIANCE}"', assumed=True,
    ),
    Effect(
        _CROSSINGS, "friction", Friction(coefficient=0.3, arm="0.1 mm"), None,
        'friction = { coefficient = 0.3, arm = "0.1 mm" }', assumed=True,
    ),
    Effect(
        _SLIDING, "friction", Friction(chamber_coefficient=0.3), None,
        "friction.chamber_coefficient = 0.3", assumed=True,
    ),
    Effect("ends that hold the radius", "ends", "clamped", "free", 'ends = "clamped"'),
    Effect("fittings of another radius", "end_radii", None, None, "end_radii, as given"),
    Effect("angle along the length", "braid.angle_profile", None, None, "braid.angle_profile, as given"),
)  # fmt: skip
"""What can be switched. Compliance and friction are those of measured Festo muscles (theory page): put in your own."""


def effects(
    muscle: Muscle,
    *,
    length: Any = None,
    contraction: Any = None,
    pressure: Any,
    watch: Callable[[int, int], None] | None = None,
) -> Effects:
    """The size of each effect for a muscle at a length and pressure: solved with it and without, nothing guessed.

    Stretch and roll of the fibres, where the wall lies and how thick it is, a gap between tube and braid, fittings that
    give way or have a radius of their own, friction, and the ends. What a muscle already has is switched off for the
    comparison; the rest is switched on, one by one. Friction at the crossings has no one state: what is told is half of
    what lies between the forces as the muscle lengthens and as it shortens. A chamber that slides along the mesh (a
    tube with a gap, bellows) is told against one that the mesh holds as it is mounted, along one path: brought to the
    length without pressure, as made, and then filled. A gap has a row where the chamber lies inside, end radii where
    the muscle has them: no others are known. Bellows have no row: without their folds they would be another
    tube, whose wall and law the muscle does not tell, so compare two muscles for that.

    Args:
        muscle: the specification.
        length: distance between the fittings [m], a number or text with a unit.
        contraction: in place of the length: 1 - h/H0.
        pressure: gauge pressure [Pa], likewise.
        watch: called with (effects done, effects in all).

    Returns:
        An `Effects`: its `table` has a row for each effect, the largest first, with changes in per cent, what to switch
        on, and what that costs in time.

    Raises:
        SpecError: for wrong input, or where the muscle as it is has no stable state at this length and pressure.

    >>> found = mk.effects(mk.presets.paper(), length="115 mm", pressure="1 bar")
    >>> found.table.index[0]
    'ends that hold the radius'
    """
    (step,) = Step(length=length, contraction=contraction, pressure=pressure, points=1).as_steps(muscle)  # type: ignore[call-arg]
    if any(getattr(step, name).needs_present for name in step.controls):
        raise SpecError("effects", allowed="length and pressure must be one value each")
    held = {name: float(getattr(step, name).sample(1)[0]) for name in ("length", "pressure")}
    rubbing, muscle = muscle, evolved(muscle, friction=None)  # the other effects are told without it
    base, pace = _timed(muscle, held)
    if base.verdict != Verdict.STABLE:
        raise SpecError("effects", allowed=f"the muscle is not stable there: {base.reason}", advice="ask for another")
    own, tell = _own(EFFECTS, rubbing), watch or (lambda done, total: None)
    rows: list[dict[str, Any]] = []
    for effect in own:
        tell(len(rows), len(own))
        rows.append(_row(muscle, held, effect, base, pace))
    tell(len(rows), len(own))
    at = f"{show(held['length'], 'm')} and {show(held['pressure'], 'Pa')}"
    about = {"title": f"size of effects at {at}", "muscle": to_toml(rubbing, allow_custom=True)}
    return Effects(rubbing, held["length"], held["pressure"], _dataset(rows, about))


def _own(effects: Iterable[Effect], muscle: Muscle) -> list[Effect]:
    """The effects, with the muscle's own friction where it has one, and on its own dead length.

    A gap is one of a chamber inside alone, sliding of one that the mesh does not hold, and of another radius of the
    fittings, or a programmed braid, none is known but the muscle's own. Such a braid asks for fibres that stretch.
    """
    inside = muscle.chamber is not None and muscle.chamber.inside
    effects = [one for one in effects if one.name != _SLIDING or not held_to_mesh(muscle.chamber)]
    effects = [one for one in effects if one.field != "chamber.gap" or inside]
    effects = [one for one in effects if one.field != "end_radii" or muscle.end_radii is not None]
    programmed = muscle.braid.angle_profile is not None
    effects = [one for one in effects if one.field != ("braid.fibre.stretch" if programmed else "braid.angle_profile")]
    own: dict[str, dict[str, Any]] = {}
    rubs = muscle.friction
    if rubs is not None and (rubs.coefficient > 0.0 or rubs.constant > 0.0):
        crossings = evolved(rubs, chamber_coefficient=None, chamber_stiffness=None)
        own[_CROSSINGS] = {"on": crossings, "switch": "friction, as given", "assumed": False}
    if rubs is not None and rubs.chamber_coefficient is not None:
        sliding = Friction(chamber_coefficient=rubs.chamber_coefficient, chamber_stiffness=rubs.chamber_stiffness)
        own[_SLIDING] = {"on": sliding, "switch": "friction.chamber_coefficient, as given", "assumed": False}
    dead = None if muscle.fittings is None else muscle.fittings.dead_length
    if dead is not None:
        given = {"on": Fittings(compliance=_COMPLIANCE, dead_length=dead), "off": Fittings(dead_length=dead)}
        own |= {one.name: given for one in effects if one.field == "fittings"}
    return [attrs.evolve(one, **own.get(one.name, {})) for one in effects]


def _timed(muscle: Muscle, held: dict[str, float]) -> tuple[State, float]:
    """A state, and how long it takes once its functions are compiled [s]; of a chamber that slides with its path."""
    reach = _filled if _slides(muscle) else solve
    reach(muscle, **held)
    begin = time.perf_counter()
    state = reach(muscle, **held)
    return state, time.perf_counter() - begin


def _slides(muscle: Muscle) -> bool:
    return muscle.friction is not None and muscle.friction.chamber_coefficient is not None


def _filled(muscle: Muscle, length: float, pressure: float) -> State:
    """The end of the path by which a chamber that slides is told: as made, to the length without pressure, filled."""
    test = Isometric(length=length, pressure=np.linspace(0.0, pressure, FILLED if pressure else 1).tolist())
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MuscleWarning)  # the other effects' states do not warn either
        curve = run(muscle, test, tolerance=CLOSE)
    last = curve.data.isel(step=[-1])
    verdict, reason = (str(last[name].values[0]) for name in ("verdict", "reason"))
    return State(Result(muscle, test, last), Verdict(verdict), reason, None)


def _row(muscle: Muscle, held: dict[str, float], effect: Effect, base: State, pace: float) -> dict[str, Any]:
    """Numbers without and with one effect, or why there are none."""
    row = {"effect": effect.name, "switch": effect.switch, "assumed": effect.assumed, "time": np.nan}
    nothing = dict.fromkeys(QUANTITIES, (np.nan, np.nan))
    try:
        has = _has(muscle, effect)
        other, seconds = _timed(muscle.replace(effect.field, effect.off if has else effect.on), held)
    except SpecError as error:
        return row | nothing | {"reason": str(error)}
    if other.verdict != Verdict.STABLE:
        return row | nothing | {"reason": f"{'without' if has else 'with'} it: {other.reason}"}
    pair = (other, base) if has else (base, other)
    ratio = pace / seconds if has else seconds / pace
    numbers = {name: tuple(_number(state, name) for state in pair) for name in QUANTITIES}
    return row | numbers | {"time": ratio, "reason": ""}


def _has(muscle: Muscle, effect: Effect) -> bool:
    """Whether the muscle has an effect; SpecError where that means nothing for it."""
    owner: Any = muscle
    *parts, last = effect.field.split(".")
    for part in parts:
        owner = getattr(owner, part)
    if owner is None:
        raise SpecError(effect.field, allowed="a bare braid has no chamber")
    value = getattr(owner, last)
    if effect.field == "chamber.lies":
        value = "inside" if owner.inside else "outside"
    return value is not None and value != effect.off


def _number(state: State, name: str) -> float:
    """One quantity; of a muscle whose crossings rub the force as it lengthens, and nothing else."""
    if state.result.muscle.friction is not None and not _slides(state.result.muscle):
        below, above = state.force_interval or (np.nan, np.nan)
        return state.force + 0.5 * (above - below) if name == "force" else np.nan
    data = state.result.data.isel(step=0)
    if name == "middle_radius":
        return float(data["r"][data.sizes["v"] // 2])
    return float(data["fibre_tension"].max() if name == "peak_fibre_tension" else data[name])


def _dataset(rows: list[dict[str, Any]], about: dict[str, Any]) -> Any:
    import xarray as xr  # here, because it takes half a second to import

    values = {
        name: (("effect", "state"), np.array([row[name] for row in rows], float), {"units": unit, "long_name": meaning})
        for name, (unit, meaning) in QUANTITIES.items()
    }
    words = {name: ("effect", [row[name] for row in rows]) for name in ("switch", "assumed", "reason")}
    ratio = ("effect", [row["time"] for row in rows], {"long_name": "time of a state over that without the effect"})
    coords = {"effect": [row["effect"] for row in rows], "state": ["without", "with"]}
    return xr.Dataset(values | words | {"time": ratio}, coords, about)

"""`design()`: the muscle that does what is wanted."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from mckibben.designing.answer import Design, answer
from mckibben.designing.front import check_pymoo, evolve_front, front_of, middle_of, smooth_front
from mckibben.designing.prices import Prices, prices_of
from mckibben.designing.reading import check_measure
from mckibben.designing.search import evolve, neighbours, smooth_end
from mckibben.designing.space import Space, space_of
from mckibben.designing.tried import LOST, MET, Task, Tried, limits_of
from mckibben.experiments.foresee import refuse_friction
from mckibben.solver.bench import sizes_for
from mckibben.spec import Muscle, SpecError
from mckibben.spec.wishes import Demand, Goal

__all__ = ["design"]

COARSE = 1e-3
"""Tolerance of the search at best; its smooth end is computed to the tolerance asked for."""
ONE, SEVERAL = 2_000, 6_000
"""Designs that are tried for one goal, and for a front, where nothing is said."""
ENDS = 3
"""Sets of options from which the smooth end is tried."""
NEARLY = 0.2
"""Sum of violations that the smooth end may well mend."""
ROUNDS = 6
"""Smooth ends at most."""
FEWEST, MOST = 16, 1_000_000


def design(
    muscle: Muscle,
    free: Mapping[str, Any],
    objective: Any,
    subject_to: Any = (),
    *,
    designs: int | None = None,
    seed: int = 0,
    tolerance: float = 1e-3,
    watch: Callable[[int, int], None] | None = None,
) -> Design:
    """Find the muscle that does best what is wanted, within limits: chosen numbers, whole numbers and parts.

    Designs are computed many at a time, as in a sweep. Quasi-random ones come first, then differential evolution
    (SciPy), then for what is smooth sequential quadratic programming; for several goals NSGA-II (pymoo). A design
    without a stable state where it is asked for counts as not fulfilling, and ends nothing.

    Args:
        muscle: what is not free is taken from here.
        free: names of fields and where they are searched: a range, "55 deg to 70 deg"; a range of whole numbers for a
            count, "24 to 96"; or a list to choose from, of numbers, words or parts, ["6 mm", "8 mm"] or
            [mk.NeoHookean(c1="0.1 MPa"), mk.NeoHookean(c1="0.3 MPa")]. A range of a list of numbers, such as
            "braid.angle_profile.angle", is that of each of them; "braid.angle_profile.angle[1]" is one.
        objective: `Maximise` or `Minimise` of a measure; several for a front. Measures: `ForceAt`, `Stroke`,
            `PressureFor`, `Work`, `ForceVariation`, `CurveMiss`, `ProfileMiss`, `Diameter`, `FibreTension`,
            `FibreSafety`, `JammingMargin`, `StabilityMargin`, `AirVolume`, `Mass`.
        subject_to: demands, made by comparing measures: [mk.Stroke(pressure="4 bar") >= "20 %"].
        designs: how many are tried; 2000, for a front 6000, where it is left out.
        seed: of what is random. The same one gives the same answer.
        tolerance: bound of the relative error of the states in the search, which are mostly much better; those of the
            answer are computed to 1e-6.
        watch: called with (designs done, designs in all).

    Returns:
        A `Design`: `muscle`, `table`, `limits`, `states`, `curves`, `notes`, for several goals `front`. Where the
        demands cannot be met together, `feasible` is False, `muscle` is the one that misses least, and the notes say
        which demands block and by how much. After Ctrl-C it is the best so far.

    Raises:
        SpecError: for names, ranges, measures or numbers that cannot be, friction, or where no design that was tried
            has a state.

    >>> muscle = mk.presets.paper().replace("braid.angle", "45 deg")
    >>> pull = mk.ForceAt(pressure="1 bar", contraction="5 %")
    >>> limit = mk.Diameter(pressure="1 bar", between="0 to 5 %") <= "27 mm"
    >>> best = mk.design(muscle, {"braid.angle": "42 deg to 50 deg"}, mk.Maximise(pull), [limit], designs=64)
    >>> best.limits["reached"].tolist(), round(best.values["braid.angle"], 2)  # rad
    ([True], 0.8)
    """
    instead = "sweep() over the same numbers"
    refuse_friction(muscle, "design", instead)
    task = Task(space_of(muscle, free), _goals(objective), limits_of(_demands(subject_to)))
    for own in _kinds(task.space):
        refuse_friction(own, "design", instead)  # also where it is one of the choices
    for measure in task.measures:
        for own in _kinds(task.space):
            check_measure(measure, own)
    several = len(task.goals) > 1
    if several:
        check_pymoo()
    count = _whole("designs", designs, FEWEST, MOST) if designs is not None else SEVERAL if several else ONE
    seed = _whole("seed", seed, 0, 2**32 - 1)
    sizes_for("spectral", tolerance)
    tell = _telling(watch, count)
    coarse = Tried(task, max(COARSE, tolerance), tell)
    fine = coarse if tolerance >= COARSE else Tried(task, tolerance, tell)
    settled, notes = False, []
    try:
        (evolve_front if several else evolve)(coarse, count, seed)
        if several:
            smooth_front(coarse, fine)
        settled = several or _smooth(coarse, fine)
    except KeyboardInterrupt:
        if not len(coarse):
            raise
        notes.append("the search was interrupted: this is the best so far")
    _refuse_nothing(coarse)
    front = None
    if several:
        fine, best, front = _front(coarse, fine)
    else:
        if not len(fine):
            fine(coarse.x[coarse.ranked()[:1]])
        best = int(fine.ranked()[0])
    met = bool(fine.worth.met[best])
    notes += [] if met else _blocking(fine, best, coarse)
    lost = int((coarse.worth.over >= LOST).any(axis=1).sum())
    if lost:
        notes.append(f"{lost} of {len(coarse)} designs counted as not fulfilling: no stable state where one was asked "
                     "for, too near full extension for a batch, or values that do not go together")  # fmt: skip
    empty = Prices(np.full(len(task.limits), np.nan), np.abs(fine.worth.over[best, :-1]) < 1e-3, ())
    prices = prices_of(fine, fine.x[best]) if met and not several else empty
    about = {
        "feasible": int(met), "converged": int(settled), "seed": seed, "tolerance": tolerance,
        "tried": len(coarse) + (len(fine) if fine is not coarse else 0),
    }  # fmt: skip
    return answer(task, fine, best, prices, front, about, notes)


def _telling(watch: Callable[[int, int], None] | None, count: int) -> Callable[[int], None]:
    """Adds up what is done; what the end takes beyond the count is not told."""
    done = 0

    def tell(more: int) -> None:
        nonlocal done
        done = min(done + more, count)
        if watch is not None:
            watch(done, count)

    return tell


def _goals(objective: Any) -> tuple[Goal, ...]:
    several = (objective,) if isinstance(objective, Goal) else objective
    advice = 'such as mk.Maximise(mk.ForceAt(pressure="4 bar", contraction="10 %"))'
    if isinstance(several, str) or not isinstance(several, Sequence) or not 1 <= len(several) <= 3:
        raise SpecError("objective", objective, "must be one goal, or two or three of them in a list", advice)
    for goal in several:
        if not isinstance(goal, Goal) or type(goal) is Goal:
            raise SpecError("objective", goal, "must be mk.Maximise or mk.Minimise of a measure", advice)
    return tuple(several)


def _demands(subject_to: Any) -> tuple[Demand, ...]:
    several = (subject_to,) if isinstance(subject_to, Demand) else subject_to
    advice = 'such as [mk.Stroke(pressure="4 bar") >= "20 %"]'
    if isinstance(several, str) or not isinstance(several, Sequence):
        raise SpecError("subject_to", subject_to, "must be a list of demands", advice)
    for k, demand in enumerate(several):
        if not isinstance(demand, Demand):
            raise SpecError(f"subject_to[{k}]", demand, "must be a measure with a limit", advice)
    return tuple(several)


def _whole(field: str, value: Any, low: int, high: int) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise SpecError(field, value, f"must be a whole number from {low} to {high}")
    return value


def _kinds(space: Space) -> Iterator[Muscle]:
    """A muscle of each kind that can be chosen: the first option, and each one in its turn."""
    first = np.array([axis.number.x(axis.number.start) if axis.number is not None else 0.0 for axis in space.axes])
    yield space.muscle
    for k, axis in enumerate(space.axes):
        for place in range(len(axis.options) if not axis.numeric else 0):
            row = first.copy()
            row[k] = place
            try:
                yield space.muscle_at(row)
            except SpecError:  # these values do not go together, others may
                continue


def _smooth(coarse: Tried, fine: Tried) -> bool:
    """From the best designs of several sets of options to the best near each; whether the best came to an end."""
    listed = ~coarse.task.space.smooth
    starts: dict[bytes, np.ndarray] = {}
    for k in coarse.ranked():
        starts.setdefault(coarse.x[k][listed].tobytes(), coarse.x[k])
        if len(starts) == ENDS:
            break
    queue, seen = list(starts.values()), set(starts)
    ended, leading = False, -1
    for _ in range(ROUNDS):
        if not queue:
            beside = [x for x in _promising(fine, leading) if x[listed].tobytes() not in seen]
            queue = beside[:ENDS]
            seen |= {x[listed].tobytes() for x in queue}
        if not queue:
            break
        done = smooth_end(fine, queue[0])
        fine(queue.pop(0)[None])
        if (now := int(fine.ranked()[0])) != leading:
            ended, leading = done, now
    return ended


def _promising(fine: Tried, leading: int) -> list[np.ndarray]:
    """Designs with one number of a list changed that do better, or would but for a little of their limits."""
    beside = neighbours(fine.task.space, fine.x[leading])
    if not len(beside):
        return []
    worth, cost = fine(beside), fine.worth.costs[leading, 0]
    if not fine.worth.met[leading]:
        return [beside[k] for k in np.argsort(worth.violation) if worth.violation[k] < fine.worth.violation[leading]]
    good = (worth.violation < NEARLY) & (worth.costs[:, 0] < cost)
    return [beside[k] for k in np.argsort(worth.costs[:, 0]) if good[k]]


def _front(coarse: Tried, fine: Tried) -> tuple[Tried, int, tuple[np.ndarray, Any] | None]:
    """The front at the tolerance asked for, and its middle; none where no design keeps the limits."""
    own = front_of(coarse)
    if not len(own):
        fine(coarse.x[coarse.ranked()[:1]])
        return fine, int(fine.ranked()[0]), None
    fine(coarse.x[own])
    own = front_of(fine)
    if not len(own):
        return fine, int(fine.ranked()[0]), None
    worth = fine.some(own)
    return fine, int(own[middle_of(worth.costs)]), (fine.x[own], worth)


def _refuse_nothing(tried: Tried) -> None:
    """SpecError where not one design had its states."""
    if (tried.worth.over >= LOST).any(axis=1).all():
        said = f"none of {len(tried)} designs has a stable state wherever it is asked for one"
        advice = "ask for less contraction, or give other ranges"
        if any(getattr(measure, "z", None) for measure in tried.task.measures):
            advice += "; a wanted profile must end within the muscle: give its places by at, as shares of the length"
        raise SpecError("free", allowed=said, advice=advice)


def _blocking(fine: Tried, best: int, coarse: Tried) -> list[str]:
    """Which limits cannot be met, and by how much they are missed: together, and each with all others met."""
    task = fine.task
    notes = ["the demands cannot be met together: this is the design that misses them least"]
    for k, limit in enumerate(task.limits):
        over, measure = fine.worth.over[best, k], limit.demand.measure
        if over > MET:
            value = float(fine.worth.limited[best, k])
            missing = measure.text(abs(value - limit.at)) if np.isfinite(value) else "unknown"
            notes.append(f"blocks: {limit.said}; {measure.text(value)} was reached, {missing} "
                         f"{'too much' if limit.sign > 0.0 else 'short'}")  # fmt: skip
    for k, limit in enumerate(task.limits):
        others = np.delete(coarse.worth.over, k, axis=1)
        free = (others <= MET).all(axis=1) & (coarse.worth.over[:, k] < LOST)
        if free.any() and (coarse.worth.over[free, k] > MET).all():
            nearest = float(coarse.worth.limited[free, k][np.argmin(coarse.worth.over[free, k])])
            measure = limit.demand.measure
            notes.append(
                f"with all other demands met the best that was tried has {measure.text(nearest)}: {limit.said}"
            )
    return notes

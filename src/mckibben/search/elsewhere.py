"""Where the direct search finds no stable state: what else is tried, in turn, and how far the way there is good."""

from collections.abc import Iterator

import attrs

from mckibben.results.verdict import Verdict
from mckibben.search.finer import estimated_error, sharpened
from mckibben.search.sideways import tip, tip_on
from mckibben.search.starts import starts
from mckibben.search.walk import BranchEnd, Look, branch_end, look
from mckibben.solver.bench import LADDER, Bench
from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.find import embedded, find
from mckibben.solver.held import Held

SEARCH = LADDER[1]
"""Unknowns of the searches from other starts."""
REFINED = tuple(zip(LADDER, (1e-5, 1e-8, 1e-8, 1e-8), strict=True))
"""Unknowns of the walk along the way, and to what share of it its end is found."""
BY_PRESSURE = 1e-5
"""The same of a way on which the pressure rises: a step beyond its end costs a search that finds nothing, and with
hundreds of unknowns those to the share above take minutes."""


@attrs.frozen
class Way:
    """A way to the target: its start and its end, as far as its states are good. Of several the one that leads there.

    Pressure first, then from the initial length, or from no force, to the target; where there is no good state at that
    start, up to it by the pressure; where none is at rest either, at the target's length by the pressure.
    """

    first: Held
    end: BranchEnd


@attrs.frozen
class Else:
    """What was found instead, and how many starts were tried."""

    symmetric: Look | None  #: a symmetric state of admissible shape, stable or unstable to one side only
    asymmetric: Look | None  #: a good state of another shape
    tipped: Look | None  #: where the unstable symmetric state went, good or not
    tried: int


def way_there(bench: Bench, held: Held, b: float, tolerance: float, roughly: bool = False) -> Way | None:
    """The way to a target, as far as its states are good (see `Way`); None where the pressure is not held.

    On more unknowns until the last good state is good to the tolerance, or `roughly` on the fewest.
    """
    axial = next((name for name in ("length", "force") if name in held.names), None)
    if axial is None or "pressure" not in held.names:
        return None
    pressure, rest = held.get("pressure"), float(bench.p.rest) if axial == "length" else 0.0
    first = Held.of(**{axial: rest, "pressure": pressure})

    def way(start: Held, target: Held, begin: Equilibrium | None = None, share: float = 0.0, few: bool = False) -> Way:
        return Way(start, _end(bench, start, target, b, tolerance, roughly or few, begin, share))

    straight = way(first, held)
    if straight.end.last is not None or not pressure:
        return straight
    rises = way(Held.of(**{axial: rest, "pressure": 0.0}), first, share=BY_PRESSURE)
    if rises.end.complete and rises.end.last is not None:
        return way(first, held, rises.end.last.state)
    unloaded = Held.of(**{axial: held.get(axial), "pressure": 0.0})
    if rises.end.last is not None and not way(unloaded, held, share=BY_PRESSURE, few=True).end.complete:
        return rises
    there = way(unloaded, held, share=BY_PRESSURE)
    if there.end.complete or rises.end.last is None:
        return straight if there.end.last is None else there
    return rises


def _end(
    bench: Bench, start: Held, target: Held, b: float, tolerance: float, roughly: bool, begin: Equilibrium | None,
    least: float,
) -> BranchEnd:  # fmt: skip
    """Where good states on the straight way end, on as many unknowns as the last of them needs, to no less than a
    share."""
    end: BranchEnd | None = None
    for size, share in REFINED:
        problem = bench.problem(size, b)
        near = None if begin is None else embedded(begin, problem)
        end = branch_end(problem, start, target, max(share, least), coarse=end, begin=near)
        if roughly or (size >= SEARCH and (end.last is None or estimated_error(end.last.state, target) <= tolerance)):
            break
    assert end is not None
    return end


def look_elsewhere(bench: Bench, held: Held, found: Look, way: Way | None, tolerance: float) -> Else:
    """Tip what tips, follow the asymmetric branch, and search from other starts until something stable is found."""
    unstable = found if found.verdict.verdict == Verdict.UNSTABLE else None
    end = None if way is None else way.end
    tipped = tip(bench, found, held, tolerance)
    if unstable is None and (tipped is None or not tipped.good) and end is not None:
        tipped = tip_on(bench, end, held, tolerance)
    good = tipped if tipped is not None and tipped.good else None
    if way is None or good is not None:  # where a muscle goes from rest comes before what other starts find
        return Else(unstable, good, tipped, 0)
    count = 0
    for state in _searched(bench, held, found.state.problem.b, end):
        count += 1
        seen = look(state, held)
        if seen.good:
            seen = sharpened(bench, state, held, tolerance)
            if seen.good:
                return Else(seen, None, tipped, count)
        elif unstable is None and _tips(seen, held):
            seen = sharpened(bench, state, held, tolerance)
            tipped = tip(bench, seen, held, tolerance)
            if not _tips(seen, held) or tipped is None:
                continue
            unstable, good = seen, tipped if tipped.good else None
            if good is not None:
                break
    return Else(unstable, good, tipped, count)


def _searched(bench: Bench, held: Held, b: float, end: BranchEnd | None) -> Iterator[Equilibrium]:
    problem = bench.problem(SEARCH, b)
    for start in starts(problem, held, end):
        yield find(problem, held, start)


def _tips(seen: Look, held: Held) -> bool:
    """Whether a state of admissible shape is unstable in antisymmetric modes alone."""
    if seen.modes is None or seen.verdict.verdict != Verdict.UNSTABLE:
        return False
    return not (seen.modes.length_control if "length" in held.names else seen.modes.force_control)

"""One state sought by every means, with a verdict and a reason; and where it is not stable, what stands nearest."""

import attrs
import numpy as np

from mckibben.experiments.holding import holding
from mckibben.measure.judge import Judgement
from mckibben.results.verdict import Shape, Verdict
from mckibben.search.elsewhere import Else, Way, look_elsewhere, way_there
from mckibben.search.finer import sharpened
from mckibben.search.near_extension import near_extension, stretched
from mckibben.search.walk import Look, look
from mckibben.solver.bench import Bench, sizes_for
from mckibben.solver.find import find
from mckibben.solver.held import Held
from mckibben.solver.threads import one_thread
from mckibben.units import show

__all__ = ["UNSTABLE", "Answer", "answer", "seek"]

COARSE = 24
"""Unknowns with which the pressure that would hold a length is looked for: it is told to three digits."""

UNITS = {"length": "m", "volume": "m^3", "force": "N", "pressure": "Pa"}

UNSTABLE = "an unstable state of another shape"
"""In a reason: a symmetric state that tips to one side, found from another start than rest."""


@attrs.frozen
class Answer:
    """What was found for a target."""

    given: Look | None  #: the state that is given; None where none is admissible
    verdict: Verdict
    reason: str
    asymmetric: Look | None = None  #: where the given state tips to one side: the stable state that it goes to
    way: Way | None = None  #: the way on which the last good state lies, where that is worth telling

    @property
    def good(self) -> bool:
        """Whether a stable state is given."""
        return self.verdict == Verdict.STABLE

    @property
    def judgement(self) -> Judgement:
        """The verdict with its reason and the shape of what is given."""
        shape = Shape.ORDINARY if self.given is None else self.given.verdict.shape
        return Judgement(self.verdict, self.reason, shape)


@one_thread()
def answer(bench: Bench, held: Held, tolerance: float, b: float | None = None, thorough: bool = True) -> Answer:
    """The state at which two things are held: straight, then along the way there, then from other starts.

    Points are crowded by b, or as the target asks for. Without `thorough` other starts are left out, which take most
    of the time of a target without a state.
    """
    if held.get("length", 0.0) >= bench.longest:
        return Answer(None, Verdict.NO_EQUILIBRIUM, bench.too_long())
    found = seek(bench, held, tolerance, b)
    if found.good:
        return _plain(found)
    way = way_there(bench, held, found.state.problem.b, tolerance, roughly=not thorough)
    if way is not None and way.end.complete and way.end.last is not None:
        return _plain(way.end.last if thorough else sharpened(bench, way.end.last.state, held, tolerance))
    if thorough:
        return _instead(bench, held, found, way, look_elsewhere(bench, held, found, way, tolerance))
    unstable = found if found.verdict.verdict == Verdict.UNSTABLE else None
    return _instead(bench, held, found, way, Else(unstable, None, None, 0), "; sought straight and from its neighbours")


def seek(bench: Bench, held: Held, tolerance: float, b: float | None = None) -> Look:
    """Straight to a state, on as many unknowns as the tolerance needs."""
    crowded = bench.placement(held) if b is None else b
    problem = bench.problem(sizes_for("spectral", tolerance)[0], crowded)
    state = find(problem, held)
    if not state.converged and near_extension(bench, held):
        near = stretched(bench, state, held, tolerance)
        if near.converged:
            return look(near, held)
    return sharpened(bench, state, held, tolerance, again=True)


def _plain(found: Look) -> Answer:
    return Answer(found, found.verdict.verdict, found.verdict.reason)


def _instead(bench: Bench, held: Held, found: Look, way: Way | None, instead: Else, tried: str | None = None) -> Answer:
    """The best of what was found where the direct search gave nothing stable, and what was `tried` if that is short."""
    symmetric, asymmetric = instead.symmetric, instead.asymmetric
    on_the_way = "" if way is None else f": on the way there {_ending(way)}"
    if symmetric is not None and symmetric.good:
        reason = symmetric.verdict.reason + "; found from another shape than rest" + on_the_way
        return Answer(symmetric, symmetric.verdict.verdict, reason)
    if symmetric is not None and (symmetric is found or asymmetric is not None):
        return _unstable(symmetric, found, way, instead)
    if asymmetric is not None:
        return Answer(
            asymmetric, asymmetric.verdict.verdict, asymmetric.verdict.reason + "; an asymmetric state" + on_the_way
        )
    verdict = found.verdict.verdict
    if way is None:
        return Answer(None, verdict, found.verdict.reason)
    inadmissible = Verdict.INADMISSIBLE in (verdict, way.end.cause.verdict)
    verdict = Verdict.INADMISSIBLE if inadmissible else Verdict.NOT_CONVERGED
    lacks = f"no {'stable' if symmetric else 'admissible'} state was found at {_said(held)}"
    more = _tried(instead) + _holds(bench, held) if tried is None else tried
    return Answer(None, verdict, f"{lacks}: {_ending(way)}{more}", way=way)


def _unstable(symmetric: Look, found: Look, way: Way | None, instead: Else) -> Answer:
    """A symmetric state that tips to one side, and the asymmetric state that it goes to."""
    reason, other, tipped = symmetric.verdict.reason, instead.asymmetric, instead.tipped
    if other is not None:
        reason += f"; the stable asymmetric state carries {show(other.state.force, 'N', 6)}"
    elif tipped is not None:
        reason += f"; no admissible asymmetric state was found either ({tipped.verdict.reason})"
    if symmetric is not found and way is not None:
        reason += f"; found from another shape than rest: on the way there {_ending(way)}"
    return Answer(symmetric, symmetric.verdict.verdict, reason, other, way if other is None else None)


def _ending(way: Way) -> str:
    """Where the good states on the way to a target end, and why."""
    if way.end.last is None:
        return f"there is no good state at {_said(way.first)}, where {way.end.cause.reason}"
    varied = [k for k, value in enumerate(way.end.held.values) if value != way.first.values[k]] or [0]
    at = show(way.end.held.values[varied[0]], UNITS[str(way.end.held.names[varied[0]])], 5)
    return f"from {_said(way.first)} good states end at {at}, where {way.end.cause.reason}"


def _tried(instead: Else) -> str:
    """What other starts gave: nothing, or a state that no muscle holds because it tips to nothing admissible."""
    if instead.symmetric is not None:
        force = show(instead.symmetric.state.force, "N", 5)
        return f"; {UNSTABLE} carries {force}, but gives way to one side, to no admissible shape that was found"
    return f"; {instead.tried} searches from other starts found none either" if instead.tried else ""


def _holds(bench: Bench, held: Held) -> str:
    """What pressure holds a length that this one does not."""
    if "length" not in held.names:
        return ""
    enough = holding(bench, held.get("length"), held.get("pressure"), 1e-4, size=COARSE)
    return f"; {show(enough, 'Pa', 3)} or more holds {show(held.get('length'), 'm', 5)}" if np.isfinite(enough) else ""


def _said(held: Held) -> str:
    return " and ".join(show(value, UNITS[name], 5) for name, value in zip(held.names, held.values, strict=True))

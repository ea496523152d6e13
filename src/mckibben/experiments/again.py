"""The states of a step that following did not reach, or that are not stable there: each is sought on its own.

From good neighbours both ways along the path, straight, along the way there, and at the two ends of every stretch of
such states from other starts too, so that a curve says of a state what a single call says.
"""

from collections.abc import Callable, Iterator

import attrs

from mckibben.experiments.answer import Answer, answer
from mckibben.measure.judge import Judgement
from mckibben.measure.report import Part, Sought
from mckibben.measure.survey import survey
from mckibben.results.verdict import Verdict
from mckibben.search.finer import estimated_error
from mckibben.search.walk import Look, look
from mckibben.solver.bench import Bench
from mckibben.solver.find import equilibrium
from mckibben.solver.follow import follow_to
from mckibben.solver.path import INTERRUPTED, LOOSE, Watch
from mckibben.solver.threads import one_thread

__all__ = ["sought_again"]


@one_thread()
def sought_again(bench: Bench, part: Part, b: float, tolerance: float, watch: Watch = lambda k, n: None) -> Part:
    """A step with the states that were not stable sought again; `part` itself where all are."""
    if not part.path:
        return part
    verdicts = [Verdict.NOT_CONVERGED] * len(part.path)
    if part.survey is not None:
        verdicts[: part.reached] = [judgement.verdict for judgement in part.survey.verdicts]
    left = [k for k, verdict in enumerate(verdicts) if verdict != Verdict.STABLE]
    if not left:
        return part
    search, why = _Search(bench, part, b, tolerance, {}), part.why
    try:
        for stretch in _stretches(left):
            _fill(search, stretch, lambda done: watch(len(part.path) - len(left) + done, len(part.path)))
    except KeyboardInterrupt:  # what was found is worth keeping
        why = INTERRUPTED
    return attrs.evolve(part, sought=search.found, why=why)


def _stretches(places: list[int]) -> Iterator[list[int]]:
    """Places that follow each other without a gap."""
    cuts = [k for k in range(1, len(places)) if places[k] != places[k - 1] + 1]
    for first, last in zip([0, *cuts], [*cuts, len(places)], strict=True):
        yield places[first:last]


@attrs.frozen
class _Search:
    bench: Bench
    part: Part
    b: float
    tolerance: float
    found: dict[int, Sought]

    def neighbour(self, k: int) -> Look | None:
        """A state of the step that is stable, if there is one at k."""
        view = self.part.survey
        if view is None or not 0 <= k < self.part.reached or view.verdicts[k].verdict != Verdict.STABLE:
            return None
        return look(equilibrium(view.problem, view.u[k], view.loads[k]), self.part.path[k])

    def keep(self, k: int, judgement: Judgement, given: Look | None) -> None:
        """Note what was found at k."""
        if given is None:
            self.found[k] = Sought(judgement)
            return
        state = given.state
        view = survey(state.problem, state.u[None], state.loads[None], self.part.path[k].names)
        self.found[k] = Sought(judgement, view, state.iterations)

    def along(self, here: Look, k: int, way: list[int]) -> None:
        """Follow from a good state at k through the places of `way`, as far as they are good."""
        path = [self.part.path[i] for i in (k, *way)]
        states = follow_to(here.state.problem, path, here.state, min(LOOSE, self.tolerance))[1:]
        for i, one in zip(way, states, strict=False):
            seen = look(equilibrium(here.state.problem, one.u, one.loads, one.iterations), self.part.path[i])
            if not seen.good or estimated_error(seen.state, self.part.path[i]) > self.tolerance:
                return
            self.keep(i, seen.verdict, seen)


def _fill(search: _Search, stretch: list[int], tell: Callable[[int], None]) -> None:
    """Seek the states of a stretch: from behind it first, then from its two ends inwards."""
    first, last = stretch[0], stretch[-1]
    behind = search.neighbour(last + 1)
    if behind is not None:
        search.along(behind, last + 1, stretch[::-1])
    for k in (last, first, *stretch[-2:0:-1]):
        if k in search.found:
            continue
        got: Answer = answer(search.bench, search.part.path[k], search.tolerance, search.b, thorough=k in (first, last))
        search.keep(k, got.judgement, got.given)
        tell(len(search.found))
        if got.good and got.given is not None:
            for way in (stretch[stretch.index(k) + 1 :], stretch[: stretch.index(k)][::-1]):
                open_ones = [i for i in way if i not in search.found]
                search.along(got.given, k, open_ones[: _run(way, open_ones)])


def _run(way: list[int], open_ones: list[int]) -> int:
    """How many places lie between a state and the next one on the way that is known."""
    return next((count for count, (i, j) in enumerate(zip(way, open_ones, strict=False)) if i != j), len(open_ones))

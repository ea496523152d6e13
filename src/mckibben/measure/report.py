"""From the steps of a test, as far as they were reached, to the `Result`."""

import datetime
from functools import cache
from importlib.metadata import version
from typing import Any

import attrs
import numpy as np

from mckibben.measure.judge import Judgement
from mckibben.measure.read import ENERGIES, NODES
from mckibben.measure.signs import after
from mckibben.measure.survey import Survey
from mckibben.measure.work import work
from mckibben.results.result import Result, Table, about
from mckibben.results.variables import FIELDS, has
from mckibben.results.verdict import Shape, Verdict
from mckibben.solver.held import Held
from mckibben.solver.path import INTERRUPTED
from mckibben.spec import Muscle, Test

NUMBERS = (
    "length", "contraction", "force", "pressure", "volume", "air_volume", "contact",
    *(f"energy_{name}" for name in ENERGIES), "energy_stretch", "energy_fittings", "energy_crossings",
    "energy_sliding", "energy", "dissipated", "residual", "error_estimate", "coefficient_tail", "conserved_variation",
)  # fmt: skip


@attrs.frozen
class Sought:
    """One state of a step that was sought on its own: nothing was found, or a state on a problem of its own."""

    judgement: Judgement
    survey: Survey | None = None  #: of the one state
    iterations: int = 0


@attrs.frozen
class Part:
    """One step of a test: what was held, how many states were asked for, and those that were reached."""

    held: tuple[str, ...]
    asked: int
    possible: int  #: states before full extension
    survey: Survey | None
    iterations: np.ndarray  #: of the reached states
    why: str  #: why the rest was not reached
    path: tuple[Held, ...] = ()  #: what each possible state holds
    sought: dict[int, Sought] = attrs.field(factory=dict)  #: states sought on their own, instead of what following gave

    @property
    def reached(self) -> int:
        """Number of states with an equilibrium."""
        return 0 if self.survey is None else len(self.survey.u)


def report(muscle: Muscle, test: Test, parts: list[Part], H0: float, cautions: list[str]) -> tuple[Result, list[str]]:
    """The Result, and what a real muscle would do that the model does not know."""
    columns = [_columns(k, part, H0, [name for name in NUMBERS if has(muscle, name)]) for k, part in enumerate(parts)]
    steps = {name: np.concatenate([column[name] for column in columns]) for name in columns[0]}
    fields = _fields(parts, [name for name in FIELDS if has(muscle, name)])
    lost = ~np.isin(steps["verdict"], [Verdict.STABLE, Verdict.UNSTABLE])
    for values in (*fields.values(), *(steps[name] for name in NUMBERS if name in steps)):
        values[lost] = np.nan
    steps["work"] = np.concatenate(_work(columns, lost))
    notes = [*cautions, *after(muscle, steps, fields)]
    stopped = any(part.why == INTERRUPTED for part in parts)
    status = INTERRUPTED if stopped else "incomplete" if lost.any() else "complete"
    date = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
    known = [
        one.v for part in parts for one in (part.survey, *(s.survey for s in part.sought.values())) if one is not None
    ]
    v = known[0] if known else np.linspace(0.0, H0, NODES)
    return Result(muscle, test, Table(steps, fields, v, about(versions(), date, notes, status))), notes


@cache
def versions() -> dict[str, str]:
    """Versions that a result carries."""
    return {name: version(name) for name in ("mckibben", "jax", "numpy", "scipy", "xarray")}


def _columns(k: int, part: Part, H0: float, numbers: list[str]) -> dict[str, np.ndarray]:
    """Per-state variables of one step of the test; NaN beyond the part reached."""
    n, seen, look = part.asked, slice(0, part.reached), part.survey
    column: dict[str, np.ndarray] = {name: np.full(n, np.nan) for name in numbers}
    counts = {f"modes_{name}": np.full(n, -1) for name in ("length_control", "force_control", "antisymmetric")}
    column |= counts | {"iterations": np.zeros(n, int), "protocol_step": np.full(n, k)}
    column["converged"] = np.arange(n) < part.reached
    verdicts = [Judgement.lost(part.why)] * n
    for i in range(max(part.reached, part.possible), n):
        verdicts[i] = Judgement(Verdict.NO_EQUILIBRIUM, part.why, Shape.ORDINARY)
    if look is not None:
        found: dict[str, Any] = {name: look.numbers[name] for name in NUMBERS if name in look.numbers}
        found |= {"residual": look.residual, "iterations": part.iterations}
        found |= {
            "modes_length_control": [modes.length_control for modes in look.modes],
            "modes_force_control": [modes.force_control for modes in look.modes],
            "modes_antisymmetric": [-1 if m.antisymmetric is None else m.antisymmetric for m in look.modes],
        }
        for name, values in found.items():
            column[name][seen] = values
        verdicts[seen] = look.verdicts
    for i, one in part.sought.items():
        verdicts[i] = one.judgement
        for name, values in _single(one).items():
            column[name][i] = values
    for name in ("verdict", "reason", "shape"):
        column[name] = np.array([str(getattr(verdict, name)) for verdict in verdicts])
    return column


def _single(one: Sought) -> dict[str, Any]:
    """Per-state variables of a state that was sought on its own."""
    if one.survey is None:
        return {"converged": False}
    modes = one.survey.modes[0]
    return {name: one.survey.numbers[name][0] for name in NUMBERS if name in one.survey.numbers} | {
        "residual": one.survey.residual[0], "iterations": one.iterations, "converged": True,
        "modes_length_control": modes.length_control, "modes_force_control": modes.force_control,
        "modes_antisymmetric": -1 if modes.antisymmetric is None else modes.antisymmetric,
    }  # fmt: skip


def _fields(parts: list[Part], names: list[str]) -> dict[str, np.ndarray]:
    """Fields of all steps of the test; NaN beyond the parts reached."""
    rooms = []
    for part in parts:
        seen = {} if part.survey is None else part.survey.fields
        absent, beyond = (np.full((n, NODES), np.nan) for n in (part.reached, part.asked - part.reached))
        room = {name: np.concatenate([seen.get(name, absent), beyond]) for name in names}
        for i, one in part.sought.items():
            for name, values in _at(part, one).items():
                room[name][i] = values
        rooms.append(room)
    return rooms[0] if len(rooms) == 1 else {name: np.concatenate([room[name] for room in rooms]) for name in names}


def _at(part: Part, one: Sought) -> dict[str, np.ndarray]:
    """Fields of a state sought on its own, at the points of the others."""
    if one.survey is None:
        return {}
    fields, v = one.survey.fields, one.survey.v
    if part.survey is None or np.array_equal(v, part.survey.v):
        return {name: values[0] for name, values in fields.items()}
    from scipy.interpolate import CubicSpline  # here: few states have points of their own

    return {name: CubicSpline(v, values[0])(part.survey.v) for name, values in fields.items()}


def _work(columns: list[dict[str, np.ndarray]], lost: np.ndarray) -> list[np.ndarray]:
    """Work done on the muscle in each step of the test, up to the first state that is lost."""
    done, found, at = 0.0, [], 0
    for column in columns:
        n = len(column["force"])
        good = int(np.argmax(np.append(lost[at : at + n], True)))
        total = np.full(n, np.nan)
        total[:good] = done + work(*(column[name][:good] for name in ("force", "length", "pressure", "volume")))
        done = float(total[good - 1]) if good > 1 else done
        found.append(total)
        at += n
    return found

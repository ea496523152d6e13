"""From the steps of a test, as far as they were reached, to the `Result`."""

import datetime
from functools import cache
from importlib.metadata import version

import attrs
import numpy as np

from .caution import after
from .judge import Judgement
from .recover import ENERGIES, NODES
from .result import Result, Table, about
from .solver.path import INTERRUPTED
from .spec import Muscle, Test
from .survey import Survey
from .variables import FIELDS
from .verdict import Shape, Verdict
from .work import work

NUMBERS = (
    "length", "contraction", "force", "pressure", "volume", *(f"energy_{name}" for name in ENERGIES), "energy",
    "residual", "error_estimate", "coefficient_tail", "conserved_variation",
)  # fmt: skip


@attrs.frozen
class Part:
    """One step of a test: what was held, how many states were asked for, and those that were reached."""

    held: tuple[str, ...]
    asked: int
    possible: int  #: states before full extension
    survey: Survey | None
    iterations: np.ndarray  #: of the reached states
    why: str  #: why the rest was not reached

    @property
    def reached(self) -> int:
        """Number of states with an equilibrium."""
        return 0 if self.survey is None else len(self.survey.u)


def report(muscle: Muscle, test: Test, parts: list[Part], H0: float, cautions: list[str]) -> tuple[Result, list[str]]:
    """The Result, and what a real muscle would do that the model does not know."""
    columns = [_columns(k, part, H0) for k, part in enumerate(parts)]
    steps = {name: np.concatenate([column[name] for column in columns]) for name in columns[0]}
    fields = {name: np.concatenate([_rows(part, name) for part in parts]) for name in FIELDS}
    lost = ~np.isin(steps["verdict"], [Verdict.STABLE, Verdict.UNSTABLE])
    for values in (*fields.values(), *(steps[name] for name in NUMBERS)):
        values[lost] = np.nan
    steps["work"] = np.concatenate(_work(columns, lost))
    notes = [*cautions, *after(muscle, steps, fields)]
    stopped = any(part.why == INTERRUPTED for part in parts)
    status = INTERRUPTED if stopped else "incomplete" if lost.any() else "complete"
    date = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
    known = [part.survey.recovered.v for part in parts if part.survey is not None]
    v = known[0] if known else np.linspace(0.0, H0, NODES)
    return Result(muscle, test, Table(steps, fields, v, about(muscle, test, versions(), date, notes, status))), notes


@cache
def versions() -> dict[str, str]:
    """Versions that a result carries."""
    return {name: version(name) for name in ("mckibben", "jax", "numpy", "scipy", "xarray")}


def _columns(k: int, part: Part, H0: float) -> dict[str, np.ndarray]:
    """Per-state variables of one step of the test; NaN beyond the part reached."""
    n, seen, look = part.asked, slice(0, part.reached), part.survey
    column: dict[str, np.ndarray] = {name: np.full(n, np.nan) for name in NUMBERS}
    counts = {f"modes_{name}": np.full(n, -1) for name in ("length_control", "force_control", "antisymmetric")}
    column |= counts | {"iterations": np.zeros(n, int), "protocol_step": np.full(n, k)}
    column["converged"] = np.arange(n) < part.reached
    verdicts = [Judgement.lost(part.why)] * n
    for i in range(max(part.reached, part.possible), n):
        verdicts[i] = Judgement(Verdict.NO_EQUILIBRIUM, part.why, Shape.ORDINARY)
    if look is not None:
        energies = look.recovered.energies
        found = {
            "length": look.length, "volume": look.volume, "force": look.force, "pressure": look.pressure,
            "contraction": 1.0 - look.length / H0, "energy": sum(energies.values()),
            "residual": look.residual, "error_estimate": look.error, "iterations": part.iterations,
            "coefficient_tail": look.recovered.coefficient_tail,
            "conserved_variation": look.recovered.conserved_variation,
            "modes_length_control": [modes.length_control for modes in look.modes],
            "modes_force_control": [modes.force_control for modes in look.modes],
            "modes_antisymmetric": [-1 if m.antisymmetric is None else m.antisymmetric for m in look.modes],
        } | {f"energy_{name}": energies[name] for name in ENERGIES}  # fmt: skip
        for name, values in found.items():
            column[name][seen] = values
        verdicts[seen] = look.verdicts
    for name in ("verdict", "reason", "shape"):
        column[name] = np.array([str(getattr(verdict, name)) for verdict in verdicts])
    return column


def _rows(part: Part, name: str) -> np.ndarray:
    rows = np.full((part.asked, NODES), np.nan)
    if part.survey is not None:
        rows[: part.reached] = part.survey.recovered.fields[name]
    return rows


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

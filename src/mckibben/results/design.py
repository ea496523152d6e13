"""What `design()` gives: the best muscle, what it does, what limits it, and the front. Nothing is solved here."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from mckibben.results.variables import OBSERVED
from mckibben.shown import Shown
from mckibben.spec import Muscle
from mckibben.spec.wishes import text_of

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["CURVES", "STATES", "Designed"]

STATES = {
    name: OBSERVED[name]
    for name in ("length", "contraction", "pressure", "force", "volume", "largest_radius", "peak_fibre_tension")
}
"""What is known of each state of the best design."""
CURVES = {f"curve_{name}": OBSERVED[name] for name in ("contraction", "force")}
"""What is known of its force-contraction curves."""


@attrs.frozen(eq=False, repr=False)
class Designed(Shown):
    """The best muscle within what is free, as `design` gives it; `muscle` is a muscle like any other.

    Args:
        muscle: the best design; of a front, the one nearest to having the best of every goal.
        given: the muscle from which the design began.
        data: xarray Dataset: of each free `number` its value; of each `goal` and `limit` what the best design has; its
            `state`s and `curve`s; of each `design` of a front its numbers and goals.
    """

    muscle: Muscle
    given: Muscle
    data: xr.Dataset

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Designed):
            return NotImplemented
        same = self.muscle == other.muscle and self.given == other.given
        return same and bool(self.data.identical(other.data))

    def __hash__(self) -> int:
        return hash((self.muscle, self.given))

    @property
    def feasible(self) -> bool:
        """Whether the best design keeps every limit."""
        return bool(self.data.attrs["feasible"])

    @property
    def converged(self) -> bool:
        """Whether the search came to an end by itself."""
        return bool(self.data.attrs["converged"])

    @property
    def tried(self) -> int:
        """Number of designs that were looked at."""
        return int(self.data.attrs["tried"])

    @property
    def numbers(self) -> tuple[str, ...]:
        """Names of what was free."""
        return tuple(str(name) for name in self.data["number"].values)

    @property
    def values(self) -> dict[str, float]:
        """Best values by name, SI; NaN where a word or a part was chosen, which `table` names."""
        return dict(zip(self.numbers, self.data["value"].values.tolist(), strict=True))

    @property
    def goals(self) -> dict[str, float]:
        """What the best design has of each goal, SI, by the goal in words."""
        return dict(zip(map(str, self.data["goal"].values), self.data["goal_value"].values.tolist(), strict=True))

    @property
    def notes(self) -> tuple[str, ...]:
        """What must be known of the design, and what more room would give, in sentences."""
        return tuple(line for line in str(self.data.attrs["notes"]).split("\n") if line)

    @property
    def table(self) -> Any:
        """DataFrame for people: the best value of what was free, and where it was searched."""
        import pandas as pd

        columns = {"value": self.data["said"].values, "searched": self.data["searched"].values}
        return pd.DataFrame({name: values.astype(str) for name, values in columns.items()}, index=list(self.numbers))

    @property
    def limits(self) -> Any:
        """DataFrame for people: each limit, what the best design has, and the room left in per cent of the limit."""
        import pandas as pd

        rows = []
        for k, name in enumerate(map(str, self.data["limit"].values)):
            unit, display = (str(self.data[f"limit_{kind}"].values[k]) for kind in ("unit", "display"))
            over = float(self.data["limit_over"].values[k])
            rows.append({
                "limit": name, "value": text_of(float(self.data["limit_value"].values[k]), unit, display, 5),
                "room [%]": round(-100.0 * over, 2) + 0.0, "reached": bool(self.data["limit_active"].values[k]),
            })  # fmt: skip
        return pd.DataFrame(rows, columns=["limit", "value", "room [%]", "reached"])

    @property
    def states(self) -> Any:
        """DataFrame for people: the states at which the design was judged."""
        import pandas as pd

        columns: dict[str, Any] = {}
        for name, (unit, _) in STATES.items():
            values = self.data[name].values.tolist()
            columns[name] = [text_of(round(value, 12), unit, "%" if name == "contraction" else "") for value in values]
        columns["verdict"] = self.data["verdict"].values.astype(str)
        return pd.DataFrame(columns, index=[str(name) for name in self.data["state"].values])

    @property
    def curves(self) -> Any:
        """Dataset of the force over the contraction of the best design, at each pressure at which it was judged."""
        return self.data[list(CURVES)].rename({name: name.removeprefix("curve_") for name in CURVES})

    @property
    def front(self) -> Any:
        """Dataset of designs of which none is better in every way: their numbers and their goals; None for one goal.

        Each number is a coordinate (text where words or parts are chosen), each goal a variable named by its measure.
        """
        if "front_goal" not in self.data:
            return None
        import xarray as xr

        coords, variables = {}, {}
        for k, name in enumerate(self.numbers):
            values, said = self.data["front_value"].values[:, k], self.data["front_said"].values[:, k]
            plain = np.isfinite(values).all()
            about = {"units": str(self.data["unit"].values[k])} if plain else {}
            coords[name] = ("design", values if plain else said.astype(str), about)
        for k, name in enumerate(self.goal_names):
            about = {"units": str(self.data["goal_unit"].values[k]), "long_name": str(self.data["goal"].values[k])}
            variables[name] = ("design", self.data["front_goal"].values[:, k], about)
        return xr.Dataset(variables, coords)

    @property
    def goal_names(self) -> tuple[str, ...]:
        """Short names of the goals: the word of each measure, with a number where two are of one kind."""
        kinds = [str(kind) for kind in self.data["goal_kind"].values]
        return tuple(kind if kinds.count(kind) == 1 else f"{kind}_{kinds[:k].count(kind) + 1}"
                     for k, kind in enumerate(kinds))  # fmt: skip

    def __repr__(self) -> str:
        found = "; ".join(
            f"{name}: {text_of(value, str(unit), str(display))}"
            for (name, value), unit, display in zip(
                self.goals.items(), self.data["goal_unit"].values, self.data["goal_display"].values, strict=True
            )
        )
        kept = "" if self.feasible else ", limits not met"
        return f"<Design: {found}{kept}>"

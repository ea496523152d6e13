"""What `sensitivity()` gives: how much each number matters to each result at one state. Nothing here computes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from mckibben.shown import Shown
from mckibben.spec import Muscle, Test

if TYPE_CHECKING:
    import xarray as xr

ANGLES = "angles are measured from the parallels, and so is a per cent of one"


def sensitivities(
    numbers: dict[str, dict[str, Any]],
    results: dict[str, dict[str, Any]],
    relative: np.ndarray,
    absolute: np.ndarray,
    about: dict[str, Any],
) -> xr.Dataset:
    """The Dataset of a `Sensitivity`, with what is known of each number and of each result as coordinates."""
    coords: dict[str, Any] = {"number": list(numbers), "result": list(results)}
    for dimension, known, kinds in (
        ("number", numbers, {"value": float, "unit": str, "shown": str, "meaning": str, "assumed": bool}),
        ("result", results, {"value": float, "unit": str, "meaning": str}),
    ):
        for kind, form in kinds.items():
            coords[f"{dimension}_{kind}"] = (dimension, np.array([item[kind] for item in known.values()], form))
    for array in (relative, absolute):
        array.flags.writeable = False
    dims = ("number", "result")
    variables = {
        "relative": (
            dims,
            relative,
            {"units": "1", "long_name": "per cent of the result per per cent of the number"},
        ),
        "absolute": (dims, absolute, {"long_name": "derivative, SI unit of the result over that of the number"}),
    }
    import xarray as xr  # here, because it takes half a second to import

    return xr.Dataset(variables, coords, about)


@attrs.frozen(eq=False)
class Sensitivity(Shown):
    """Derivatives of results of one state by the numbers of the muscle and of the test.

    It is what `sensitivity` gives. `relative` is d ln(result)/d ln(number): per cent of the result for one per cent of
    the number. It is NaN where either of them is zero; `absolute` has the derivative itself, in SI units. Both are
    DataFrames with a row for each number and a column for each result. Angles are measured from the parallels.

    Args:
        muscle: the muscle at which the derivatives are taken.
        test: the test, likewise.
        data: xarray Dataset with `relative` and `absolute` over `number` and `result`.

    >>> test = mk.Isometric(length="115 mm", pressure="1 bar")
    >>> found = mk.sensitivity(mk.presets.paper(), test, of="force", by=["braid.angle", "test.length"])
    >>> round(float(found.relative.loc["braid.angle", "force"]), 2)  # per cent per per cent
    5.35
    >>> round(float(found.absolute.loc["test.length", "force"]))  # N/m
    4745
    """

    muscle: Muscle
    test: Test
    data: xr.Dataset

    def _frame(self, name: str) -> Any:
        frame = self.data[name].to_pandas()
        frame.columns.name = frame.index.name = None
        return frame

    @property
    def relative(self) -> Any:
        """DataFrame, per cent per per cent: a row for each number, a column for each result."""
        return self._frame("relative")

    @property
    def absolute(self) -> Any:
        """DataFrame of derivatives in SI units: a row for each number, a column for each result."""
        return self._frame("absolute")

    @property
    def table(self) -> Any:
        """DataFrame: the value of each number and its row of `relative`, sorted by influence on the first result."""
        frame = self.relative
        frame.insert(0, "value", self.data["number_shown"].values)
        return frame.iloc[self.order]

    @property
    def order(self) -> np.ndarray:
        """Numbers of the rows, sorted by their influence on the first result, the largest first; NaN comes last."""
        share = np.abs(self.data["relative"].values[:, 0])
        return np.argsort(-np.where(np.isnan(share), -1.0, share), kind="stable")

    @property
    def verdict(self) -> str:
        """Verdict on the state."""
        return str(self.data.attrs["verdict"])

    @property
    def reason(self) -> str:
        """Reason for the verdict; where there are no derivatives, why."""
        return str(self.data.attrs["reason"])

    @property
    def complete(self) -> bool:
        """Whether the state exists and is admissible, so that there are derivatives."""
        return bool(np.isfinite(self.data["result_value"].values).all())

    def __repr__(self) -> str:
        numbers, results = self.data["relative"].shape
        counts = f"{numbers} numbers, {results} results"
        return f"<Sensitivity: {self.test.kind}, state {self.data.attrs['state']}, {self.verdict}, {counts}>"

"""What `tolerances()` gives: how results scatter where the numbers of a muscle do. Nothing is solved here."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from mckibben.shown import Shown
from mckibben.spec import Muscle, Test
from mckibben.units import show

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["OF_NUMBERS", "OF_RESULTS", "QUANTILES", "SHARES", "Tolerances", "dataset"]

QUANTILES = (0.05, 0.5, 0.95)
"""What the samples are summed up by."""
OF_NUMBERS = {"value": float, "tolerance": float, "deviation": float, "distribution": str, "unit": str,
               "display": str, "shown": str, "said": str, "meaning": str, "assumed": bool}  # fmt: skip
"""What is known of each number: its value, its tolerance as given and as a standard deviation [SI], and so on."""
OF_RESULTS = {"value": float, "unit": str, "meaning": str}
SHARES = {
    "effect": "change of the result for one standard deviation of the number, SI unit of the result",
    "share": "share of the variance of the result by derivatives",
    "first": "share of the variance by this number alone, by sampling (Sobol index of first order)",
    "total": "share of the variance in which this number has a part, by sampling (total Sobol index)",
}
"""Variables over numbers and results."""


def dataset(
    numbers: dict[str, dict[str, Any]],
    results: dict[str, dict[str, Any]],
    shares: dict[str, np.ndarray],
    samples: tuple[np.ndarray, np.ndarray],
    about: dict[str, Any],
) -> xr.Dataset:
    """The Dataset of a `Tolerances`; `samples` are the numbers drawn (sample, number) and the results there."""
    coords: dict[str, Any] = {"number": list(numbers), "result": list(results)}
    for dimension, known, kinds in (("number", numbers, OF_NUMBERS), ("result", results, OF_RESULTS)):
        for kind, form in kinds.items():
            coords[f"{dimension}_{kind}"] = (dimension, np.array([item[kind] for item in known.values()], form))
    for array in (*shares.values(), *samples):
        array.flags.writeable = False
    variables: dict[str, Any] = {
        name: (("number", "result"), shares[name], {"long_name": meaning}) for name, meaning in SHARES.items()
    }
    variables["drawn"] = (("sample", "number"), samples[0], {"long_name": "numbers of each sample, SI units"})
    said = "results of each sample, SI units; NaN where the state is not stable"
    variables["sampled"] = (("sample", "result"), samples[1], {"long_name": said})
    import xarray as xr  # here, because it takes half a second to import

    return xr.Dataset(variables, coords, about)


@attrs.frozen(eq=False, repr=False)
class Tolerances(Shown):
    """How far results scatter where numbers of the muscle and the test do, by derivatives and by sampling.

    It is what `tolerances` gives. `spread` and `table` are for people; `data` has everything in SI units.

    Args:
        muscle: the muscle with the numbers as meant.
        test: the test, likewise.
        data: xarray Dataset: over `number` and `result` the `effect` of one standard deviation, the linear `share` of
            the variance, and the Sobol indices `first` and `total`; over `sample` the numbers `drawn` and the results
            `sampled`.

    >>> test = mk.Isometric(length="115 mm", pressure="1 bar")
    >>> found = mk.tolerances(mk.presets.paper(), test, {"braid.angle": "0.5 deg"}, samples=64)
    >>> found.stable, len(found.data["sample"])
    (True, 64)
    """

    muscle: Muscle
    test: Test
    data: xr.Dataset

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Tolerances):
            return NotImplemented
        same = self.muscle == other.muscle and self.test == other.test
        return same and bool(self.data.identical(other.data))

    def __hash__(self) -> int:
        return hash((self.muscle, self.test))

    @property
    def results(self) -> tuple[str, ...]:
        """Names of the results."""
        return tuple(str(name) for name in self.data["result"].values)

    @property
    def numbers(self) -> tuple[str, ...]:
        """Names of the numbers that scatter."""
        return tuple(str(name) for name in self.data["number"].values)

    @property
    def linear(self) -> np.ndarray:
        """Standard deviation of each result by derivatives, to first order [SI]."""
        effect = self.data["effect"].values
        return np.asarray(np.sqrt((effect**2).sum(axis=0)))

    @property
    def deviation(self) -> np.ndarray:
        """Standard deviation of each result over the samples whose state is stable [SI]."""
        good = self._good
        return np.asarray(good.std(axis=0, ddof=1) if len(good) > 1 else np.full(len(self.results), np.nan))

    @property
    def quantiles(self) -> np.ndarray:
        """Quantiles 5, 50 and 95 % of each result over the samples whose state is stable: (quantile, result) [SI]."""
        good = self._good
        shape = (len(QUANTILES), len(self.results))
        return np.asarray(np.quantile(good, QUANTILES, axis=0) if len(good) else np.full(shape, np.nan))

    @property
    def _good(self) -> np.ndarray:
        sampled = np.asarray(self.data["sampled"].values)
        return sampled[np.isfinite(sampled).all(axis=1)]

    @property
    def stable(self) -> bool:
        """Whether the state as meant, and that of every muscle tried, is stable."""
        return not self.data.attrs["lost"] and bool(np.isfinite(self.data["result_value"].values).all())

    @property
    def notes(self) -> tuple[str, ...]:
        """What must be known to use the numbers, in sentences."""
        return tuple(line for line in str(self.data.attrs["notes"]).split("\n") if line)

    @property
    def order(self) -> np.ndarray:
        """Numbers of the rows, sorted by their total part in the first result, the largest first; NaN comes last."""
        total, share = (self.data[name].values[:, 0] for name in ("total", "share"))
        by = np.where(np.isnan(total), share, total)
        return np.argsort(-np.where(np.isnan(by), -np.inf, by), kind="stable")

    @property
    def spread(self) -> Any:
        """DataFrame for people, a row for each result: as meant, standard deviations, quantiles 5, 50 and 95 %."""
        import pandas as pd

        rows = []
        for k, name in enumerate(self.results):
            unit = str(self.data["result_unit"].values[k])
            values = {"as meant": float(self.data["result_value"].values[k]), "sd, linear": float(self.linear[k]),
                      "sd, sampled": float(self.deviation[k])}  # fmt: skip
            values |= {f"{100.0 * share:g} %": float(self.quantiles[j, k]) for j, share in enumerate(QUANTILES)}
            rows.append(pd.Series({head: said(value, unit) for head, value in values.items()}, name=name))
        return pd.DataFrame(rows)

    @property
    def table(self) -> Any:
        """DataFrame for people, a row for each number, the largest part in the first result on top: its value and
        tolerance, and of each result the share of the variance [%] by derivatives, alone, and in all."""  # fmt: skip
        import pandas as pd

        frame = pd.DataFrame(index=list(self.numbers))
        frame["value"], frame["tolerance"] = self.data["number_shown"].values, self.data["number_said"].values
        for k, name in enumerate(self.results):
            for kind in ("share", "first", "total"):
                frame[f"{name} {kind} [%]"] = 100.0 * self.data[kind].values[:, k]
        return frame.iloc[self.order]

    def __repr__(self) -> str:
        unit = str(self.data["result_unit"].values[0])
        meant, off = (said(float(value), unit) for value in (self.data["result_value"].values[0], self.deviation[0]))
        counts = f"{len(self.numbers)} numbers, {self.data.sizes['sample']} samples"
        return f"<Tolerances: {counts}, {self.results[0]} {meant}, sd {off}>"


def said(value: float, unit: str) -> str:
    """A result for people, a contraction in per cent; "-" where there is none."""
    if value != value:
        return "-"
    return f"{show(100.0 * value, '1', 4)} %" if unit == "1" else show(value, str(unit), 4)

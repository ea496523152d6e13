"""The posterior of a fit as a Dataset: draws, what they say of each number, and the fit's own intervals beside them."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from mckibben.fitting.free import Free
from mckibben.fitting.misfit import Points
from mckibben.fitting.sample import drawn
from mckibben.fitting.together import misfit_of
from mckibben.results.fit import Fitted
from mckibben.spec import SpecError

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["posterior"]

AGREE = 1.05
"""R-hat from which on it is told that chains differ."""


def posterior(
    fit: Fitted, free: tuple[Free, ...], draws: int, chains: int, seed: int, watch: Callable[[int, int], None]
) -> xr.Dataset:
    """What `Fit.sample` gives."""
    import xarray as xr

    for name, count, fewest in (("draws", draws, 50), ("chains", chains, 2), ("seed", seed, 0)):
        if isinstance(count, bool) or not isinstance(count, int) or not fewest <= count < 2**31:
            raise SpecError(f"sample.{name}", count, f"must be a whole number, at least {fewest}")
    about = fit.data.attrs
    if about.get("loss") != "linear" or "prior" not in fit.data:
        said = "takes a fit with normal errors" if "prior" in fit.data else "takes a fit made by this version"
        raise SpecError("sample", allowed=said, advice='fit again, with loss="linear"')
    points = fit.data
    measured = Points(
        np.stack([points["length"].values, points["pressure"].values], axis=1), points["force"].values,
        points["test"].values, points["branch"].values, points["weight"].values, points["path"].values,
    )  # fmt: skip
    of = points["of"].values if fit.further else np.zeros(len(measured.force), int)
    misfit = misfit_of(fit.muscles, free, [measured.some(of == k) for k in range(len(fit.muscles))],
                       int(about["unknowns"]))  # fmt: skip
    best = np.clip(misfit.start, 1e-9, 1.0 - 1e-9)
    found = drawn(
        misfit, best, float(about["force_error"]) if about["error_known"] else None, draws, chains, seed, watch
    )
    value = np.array([[misfit.values(x) for x in chain] for chain in found.x])
    tail = 0.5 * (1.0 - float(about["level"]))
    low, high = np.quantile(value, [tail, 1.0 - tail], axis=(0, 1))
    notes = [
        f"the chains differ by {name} (R-hat {rhat:.3f}): make more draws, or narrow what is free"
        for name, rhat in zip(fit.numbers, found.rhat.tolist(), strict=True)
        if not rhat < AGREE
    ]
    of_number = {
        "mean": value.mean(axis=(0, 1)), "sd": value.std(axis=(0, 1), ddof=1), "low": low, "high": high,
        "rhat": found.rhat, "effective": found.effective, "effective_tail": found.effective_tail,
        "fit_low": fit.data["low"].values, "fit_high": fit.data["high"].values, "unit": fit.data["unit"].values,
    }  # fmt: skip
    return xr.Dataset(
        {"value": (("chain", "draw", "number"), value)} | {name: ("number", row) for name, row in of_number.items()},
        {"number": list(fit.numbers)},
        {"accepted": found.accepted, "level": about["level"], "seed": seed, "notes": "\n".join(notes)},
    )

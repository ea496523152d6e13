"""`Fit`: the answer of a fit, which predicts tests, and how it is made."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from mckibben.data.values import Data
from mckibben.experiments.run import run
from mckibben.fitting.free import Free, put_in
from mckibben.fitting.misfit import Compared, Points
from mckibben.fitting.posterior import posterior
from mckibben.fitting.search import Least
from mckibben.fitting.together import AnyMisfit, misfit_of
from mckibben.fitting.uncertain import Spread
from mckibben.measure.report import versions
from mckibben.results.fit import POINTS, Fitted
from mckibben.results.found import NUMBERS
from mckibben.results.result import Result
from mckibben.spec import Muscle, SpecError, Test
from mckibben.spec.text import to_toml

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Fit", "Prediction", "answer", "of_numbers"]


@attrs.frozen(eq=False)
class Prediction:
    """A test of the fitted muscle, and how sure its force is."""

    curve: Result
    error: np.ndarray  #: standard error of the force [N] at each state, from that of the fitted numbers; NaN if none

    @property
    def low(self) -> np.ndarray:
        """Force less two standard errors [N]."""
        return np.asarray(self.curve.force - 2.0 * self.error)

    @property
    def high(self) -> np.ndarray:
        """Force and two standard errors [N]."""
        return np.asarray(self.curve.force + 2.0 * self.error)


@attrs.frozen(eq=False, repr=False)
class Fit(Fitted):
    """What `fit` gives: the fitted muscle, how sure its numbers are, and how far it is from each point.

    Args:
        muscle: the muscle with the best values.
        given: the muscle from which the fit began.
        data: xarray Dataset of the numbers and the points, in SI.
        further: where several muscles were fitted together, the others; `muscles` are all of them.

    >>> muscle = mk.presets.paper()
    >>> curve = mk.run(muscle, mk.Isobaric(length="85 mm to 110 mm", pressure="1 bar", points=6))
    >>> table = {"length [m]": curve.length, "pressure [Pa]": curve.pressure, "force [N]": curve.force}
    >>> found = mk.fit(muscle, mk.read_data(table), {"braid.angle": "35 deg to 39 deg"}, starts=1)
    >>> found.numbers, found.undetermined
    (('braid.angle',), ())
    """

    def predict(self, test: Test, *, tolerance: float = 1e-6) -> Prediction:
        """A test of the fitted muscle with the standard error of its force.

        Args:
            test: any test that `run` takes.
            tolerance: as for `run`.

        Returns:
            The curve, and the standard error [N] that the fitted numbers leave at each state's length and pressure. The
            scatter of a single measurement (`data.attrs["force_error"]`) comes on top.

        >>> muscle, test = mk.presets.paper(), mk.Isobaric(length="85 mm to 110 mm", pressure="1 bar", points=6)
        >>> curve = mk.run(muscle, test)
        >>> table = {"length [m]": curve.length, "pressure [Pa]": curve.pressure, "force [N]": curve.force}
        >>> found = mk.fit(muscle, mk.read_data(table), {"braid.angle": "35 deg to 39 deg"}, starts=1)
        >>> float(found.predict(test).error.max()) < 0.01  # N: nothing was wrong with these data
        True
        """
        curve = run(self.muscle, test, tolerance=tolerance)
        own = [k for k, name in enumerate(self.numbers) if not name.startswith("offset.")]
        free = tuple(self.free[k] for k in own)
        points = np.stack([curve.length, curve.pressure], axis=1)
        error = np.full(len(points), np.nan)
        good = np.isfinite(points).all(axis=1) & np.isfinite(curve.force)
        if good.any():
            none = np.zeros(int(good.sum()))
            names = np.full(len(none), "curve")
            there = Points(points[good], none, names, np.full(len(none), ""), none + 1.0, none.astype(int))
            misfit = misfit_of((self.muscle,), free, (there,), int(self.data.attrs["unknowns"]))
            x = misfit.start
            slopes = misfit(x).slopes / np.array([one.slope(float(at)) for one, at in zip(free, x, strict=True)])
            covariance = self.data["covariance"].values[np.ix_(own, own)]
            with np.errstate(invalid="ignore"):
                error[good] = np.sqrt(np.einsum("nk,kl,nl->n", slopes, covariance, slopes))
        return Prediction(curve, error)

    def forces(self, data: Data | Sequence[Data]) -> np.ndarray:
        """Forces [N] of the fitted muscle at measured points, as the instruments would show them; NaN beyond its reach.

        Of several muscles each takes its own of as many data.

        >>> muscle = mk.presets.paper()
        >>> curve = mk.run(muscle, mk.Isobaric(length="85 mm to 110 mm", pressure="1 bar", points=6))
        >>> table = {"length [m]": curve.length, "pressure [Pa]": curve.pressure, "force [N]": curve.force}
        >>> data = mk.read_data(table)
        >>> found = mk.fit(muscle, data, {"braid.angle": "35 deg to 39 deg"}, starts=1)
        >>> bool(abs(found.forces(data) - data.force).max() < 1e-3)
        True
        """
        several = (data,) if isinstance(data, Data) else tuple(data)
        if len(self.muscles) > 1 and len(several) != len(self.muscles):
            said = f"are {len(several)} for {len(self.muscles)} muscles"
            raise SpecError(
                "data", allowed=said, advice="give those of each muscle, or ask one: fit.one(0).forces(data)"
            )
        groups = [several] if len(self.muscles) == 1 else [(one,) for one in several]
        points = [Points.of(muscle, group, {}) for muscle, group in zip(self.muscles, groups, strict=True)]
        misfit = misfit_of(self.muscles, self.free, points, int(self.data.attrs["unknowns"]))
        return misfit(misfit.start).force

    def one(self, k: int) -> Fit:
        """Of several muscles number k, counted from 0, with the same numbers: to predict its tests.

        >>> short = mk.presets.paper()
        >>> long = short.replace("braid.length", "120 mm")
        >>> held = mk.Isobaric(contraction="-0.2 to 0.05", pressure="1 bar", points=5)
        >>> curves = [mk.run(muscle, held) for muscle in (short, long)]
        >>> tables = [{"length [m]": c.length, "pressure [Pa]": c.pressure, "force [N]": c.force} for c in curves]
        >>> data = [mk.read_data(table) for table in tables]
        >>> found = mk.fit([short, long], data, {"braid.angle": "35 deg to 39 deg"}, starts=1)
        >>> float(found.one(1).muscle.braid.length)  # m
        0.12
        """
        if not 0 <= k < len(self.muscles):
            raise SpecError("k", k, f"must be a whole number from 0 to {len(self.muscles) - 1}")
        if not self.further:
            return self
        data = self.data.isel(point=np.flatnonzero(self.data["of"].values == k)).drop_vars(["further", "of"])
        data.attrs = self.data.attrs | {"muscle": to_toml(self.muscles[k], allow_custom=True)}
        return attrs.evolve(self, muscle=self.muscles[k], data=data, further=())

    def applied_to(self, muscle: Muscle) -> Muscle:
        """Another muscle with the fitted numbers: a length that was not measured, say.

        >>> muscle = mk.presets.paper()
        >>> curve = mk.run(muscle, mk.Isobaric(length="85 mm to 110 mm", pressure="1 bar", points=6))
        >>> table = {"length [m]": curve.length, "pressure [Pa]": curve.pressure, "force [N]": curve.force}
        >>> angle = {"braid.angle": "35 deg to 39 deg"}
        >>> found = mk.fit(muscle.replace("braid.angle", "36 deg"), mk.read_data(table), angle, starts=1)
        >>> longer = found.applied_to(muscle.replace("braid.length", "120 mm"))
        >>> print(f"{float(longer.braid.length):.2f} m, {np.degrees(float(longer.braid.angle)):.2f} deg")
        0.12 m, 37.00 deg
        """
        return put_in(muscle, self.free, np.array(list(self.values.values())))

    def sample(
        self, draws: int = 500, chains: int = 4, seed: int = 0, *, watch: Callable[[int, int], None] | None = None
    ) -> xr.Dataset:
        """Draws from the posterior: what is known of the numbers after the data, with nothing taken as straight.

        Errors of measured forces are normal, of the size that `force_error` told; where it was not told, that size is
        one more unknown, integrated out. What is known beforehand counts (`priors`, `offsets`); else all of a range is
        as likely (of its logarithm, where it is wider than a factor of 10). A draw takes one muscle at all points, some
        25 ms for every 32 of them: 500 draws of 4 chains take about a minute.

        Args:
            draws: of each chain, at least 50; a fifth as many more are made first and left out.
            chains: independent chains, at least 2.
            seed: of the random numbers: the same seed gives the same draws.
            watch: called with (steps done, steps in all).

        Returns:
            An xarray Dataset: `value` (chain, draw, number), and of each `number` its `mean`, `sd`, `low` and `high`
            (quantiles at the fit's level), `rhat` (below 1.01 where the chains agree), `effective` and `effective_tail`
            (independent draws for the mean, and for the ends), and the fit's own interval, `fit_low` and `fit_high`;
            SI. Attributes: `accepted`, `level`, `seed`, `notes`.

        Raises:
            SpecError: for counts out of range, a fit with another loss than "linear", and where emcee and arviz-stats
                are missing: `pip install "mckibben[bayes]"`.

        >>> muscle = mk.presets.paper()
        >>> curve = mk.run(muscle, mk.Isobaric(length="85 mm to 110 mm", pressure="1 bar", points=6))
        >>> force = curve.force + [0.2, -0.1, 0.1, -0.3, 0.2, 0.0]  # N
        >>> data = mk.read_data({"length [m]": curve.length, "pressure [Pa]": curve.pressure, "force [N]": force})
        >>> found = mk.fit(muscle, data, {"braid.angle": "35 deg to 39 deg"}, starts=1, force_error="0.2 N")
        >>> drawn = found.sample(draws=50, chains=2)
        >>> dict(drawn.sizes)
        {'chain': 2, 'draw': 50, 'number': 1}
        >>> bool(0.6 < drawn["sd"].item() / found.data["error"].item() < 1.6)
        True
        """
        return posterior(self, self.free, draws, chains, seed, watch or (lambda done, total: None))

    @property
    def free(self) -> tuple[Free, ...]:
        """The numbers with their ranges, the best values for a start, and what was known of them beforehand."""
        columns = zip(*(self.data[name].values.tolist() for name in ("unit", "from", "to", "value")), strict=True)
        free = [Free(name, *of) for name, of in zip(self.numbers, columns, strict=True)]
        if "prior" not in self.data:
            return tuple(free)
        known = zip(self.data["prior"].values.tolist(), self.data["prior_error"].values.tolist(), strict=True)
        return tuple(
            one if sd != sd else attrs.evolve(one, prior=(mean, sd))
            for one, (mean, sd) in zip(free, known, strict=True)
        )


def of_numbers(
    misfit: Compared, best: Least, spread: Spread, ends: tuple[np.ndarray, np.ndarray]
) -> dict[str, Any]:  # fmt: skip
    """Variables of a Dataset: what is known of each free number, SI, with the ends of its interval given in x."""
    free = misfit.free
    names = [one.name for one in free]
    slopes = np.array([one.slope(float(x)) for one, x in zip(free, best.x, strict=True)])
    known = {
        "value": misfit.values(best.x), "error": spread.errors * slopes, "low": misfit.values(ends[0]),
        "high": misfit.values(ends[1]), "from": np.array([one.low for one in free]),
        "to": np.array([one.high for one in free]), "start": np.array([one.start for one in free]),
    }  # fmt: skip
    square = ("number", "other")
    return {name: ("number", column, {"long_name": NUMBERS[name]}) for name, column in known.items()} | {
        "number": ("number", names), "other": ("other", names),
        "correlation": (square, spread.correlation),
        "covariance": (square, spread.covariance * np.outer(slopes, slopes)),
        "undetermined": ("number", spread.undetermined),
        "unit": ("number", [one.unit or "1" for one in free]),
        "display": ("number", [one.display or one.unit or "1" for one in free]),
        "meaning": ("number", [one.meaning for one in free]),
    }  # fmt: skip


def answer(
    misfit: AnyMisfit, best: Least, spread: Spread, ends: tuple[np.ndarray, np.ndarray], about: dict[str, Any]
) -> Fit:
    """The answer from where a search ended, with the ends of the intervals in x."""
    import xarray as xr

    free, values = misfit.free, misfit.values(best.x)
    measured = misfit.measured
    points = {
        "length": measured.points[:, 0], "pressure": measured.points[:, 1], "force": measured.force,
        "predicted": misfit(best.x).force, "weight": measured.weights,
    }  # fmt: skip
    variables = of_numbers(misfit, best, spread, ends)
    variables |= {name: ("point", column, dict(zip(("units", "long_name"), POINTS[name], strict=True)))
                  for name, column in points.items()}  # fmt: skip
    priors = np.array([one.prior or (np.nan, np.nan) for one in free])
    variables |= {
        "prior": ("number", priors[:, 0], {"long_name": "mean of what was known beforehand, NaN where nothing was"}),
        "prior_error": ("number", priors[:, 1], {"long_name": "its standard deviation"}),
        "test": ("point", measured.tests), "branch": ("point", measured.branches), "path": ("point", measured.paths),
    }  # fmt: skip
    given, *_ = misfit.muscles
    muscle, *further = (put_in(one, free, values) for one in misfit.muscles)
    if further:
        variables |= {
            "further": ("further_muscle", [to_toml(one, allow_custom=True) for one in further]),
            "of": ("point", misfit.of, {"long_name": "which muscle, 0 the first"}),
        }  # fmt: skip
    attributes = about | {
        "muscle": to_toml(muscle, allow_custom=True), "given": to_toml(given, allow_custom=True),
        "mckibben_version": versions()["mckibben"],
    }  # fmt: skip
    dataset = xr.Dataset(variables, attrs=attributes)
    for name in dataset.variables:
        dataset[name].values.flags.writeable = False
    return Fit(muscle, given, dataset, tuple(further))

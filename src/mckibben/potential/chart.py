"""`Chart`: the map of a muscle, which tells force, volume and their slopes at any length and pressure at once."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from mckibben.potential import inverse
from mckibben.potential.evaluate import Table, Values, across, edge, evaluate, in_blocks, largest_radius
from mckibben.potential.rubbing import At as RubbingAt
from mckibben.potential.rubbing import FrictionAt, Rubs, rubbing, rubbing_at, rubs_of
from mckibben.potential.scalar import scalar
from mckibben.potential.table import table_of
from mckibben.shown import Shown
from mckibben.spec import Muscle, SpecError
from mckibben.units import UnitError, show, to_si

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

__all__ = ["Chart"]


@attrs.frozen(eq=False, repr=False, slots=False)
class Chart(Shown):
    """The map of a muscle: force, volume and their slopes over length and pressure, as one smooth function.

    It is what `chart` gives and `load` gives back. Force and volume are slopes of one potential W (dW = F dh - V dP),
    so that stiffness dF/dh, dV/dP and dV/dh = -dF/dP agree with them exactly. Lengths in m, gauge pressures in Pa, or
    text with units; arrays of any shape that fit together. Nothing is solved.

    Outside of the range every function goes on smoothly and `inside` is False: beyond the shortest and the longest
    length a spring takes over (force straight, volume nearly constant), beyond the pressures the force is straight and
    the volume constant in pressure. Such values keep a simulation going; they are not the muscle's.

    Args:
        muscle: the muscle, as it was given.
        data: xarray Dataset: the series, the edges of the range, and the states by which the error was measured.

    >>> chart = mk.chart(mk.presets.paper(), length="60 mm to 115 mm", pressure="0 to 3 bar")
    >>> chart.force("100 mm", ["0.5 bar", "1 bar"]).round(2)  # N
    array([23.43, 45.81])
    >>> float(chart.free_length("1 bar").round(5))  # m
    0.08198
    >>> bool(chart.inside("130 mm", "1 bar"))
    False
    """

    muscle: Muscle
    data: xr.Dataset

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Chart):
            return NotImplemented
        return self.muscle == other.muscle and bool(self.data.identical(other.data))

    def __hash__(self) -> int:
        return hash(self.muscle)

    def __repr__(self) -> str:
        error = f"force to {show(self.force_error, 'N', 2)}, {100 * self.error:.2g} % of the largest"
        return f"<Chart: {self.range_said}; {error}>"

    @cached_property
    def table(self) -> Table:
        """The numbers of the map, for `mckibben.potential.evaluate`."""
        return table_of(self.data)

    @cached_property
    def at(self) -> Callable[[float, float], Values]:
        """The quick way for one point: a function of length [m] and pressure [Pa], both floats, that gives `Values`."""
        return scalar(self.table)

    @cached_property
    def rubs(self) -> Rubs | None:
        """The numbers of the friction at the crossings; None for a muscle without."""
        return rubs_of(self.data)

    @cached_property
    def rubbing_at(self) -> RubbingAt | None:
        """The quick way for the friction at one point, as `at`; None for a muscle without."""
        return None if self.rubs is None else rubbing_at(self.rubs, self.table)

    def values(self, length: Any, pressure: Any) -> Values:
        """All at once: force, volume, stiffness, volume_by_length, volume_by_pressure, potential and inside."""
        return in_blocks(self.table, _read("length", length, "m"), _read("pressure", pressure, "Pa"))

    def force(self, length: Any, pressure: Any, slack: bool = False) -> Any:
        """Force [N] without friction; with `slack` not below zero, as behind a tendon, which does not push."""
        force = self.values(length, pressure).force
        return np.maximum(force, 0.0) if slack else force

    def volume(self, length: Any, pressure: Any) -> Any:
        """Volume [m^3] inside the braid."""
        return self.values(length, pressure).volume

    def air_volume(self, length: Any, pressure: Any) -> Any:
        """Volume [m^3] inside the braid without the rubber that lies inside."""
        return self.volume(length, pressure) - self.rubber_inside

    def stiffness(self, length: Any, pressure: Any) -> Any:
        """dF/dh [N/m] at constant pressure."""
        return self.values(length, pressure).stiffness

    def stored_energy(self, length: Any, pressure: Any) -> Any:
        """Energy [J] stored in the muscle since it was made."""
        found = self.values(length, pressure)
        return found.potential + _read("pressure", pressure, "Pa") * found.volume

    def largest_radius(self, length: Any, pressure: Any) -> Any:
        """Largest radius [m] along the muscle: a function of its own, with an error of its own (`radius_error`)."""
        h, P = np.broadcast_arrays(_read("length", length, "m"), _read("pressure", pressure, "Pa"))
        return largest_radius(self.table, h.ravel(), P.ravel()).reshape(h.shape)

    def friction(self, length: Any, pressure: Any) -> Any:
        """Half of what lies between the sliding branches [N]: the friction of crossings that all slip; 0 without."""
        return self._rubbing(length, pressure).friction

    def sticking(self, length: Any, pressure: Any) -> Any:
        """What crossings that stick add to dF/dh [N/m], as where a path turns; 0 without friction."""
        return self._rubbing(length, pressure).sticking

    def branches(self, length: Any, pressure: Any) -> tuple[Any, Any]:
        """The forces [N] between which friction leaves the muscle: as it shortens, and as it lengthens."""
        force, friction = self.force(length, pressure), self.friction(length, pressure)
        return force - friction, force + friction

    def _rubbing(self, length: Any, pressure: Any) -> FrictionAt:
        h, P = np.broadcast_arrays(_read("length", length, "m"), _read("pressure", pressure, "Pa"))
        if self.rubs is None:
            return FrictionAt(*np.zeros((5, *h.shape)))
        return FrictionAt(*(one.reshape(h.shape) for one in rubbing(self.rubs, self.table, h.ravel(), P.ravel())))

    def inside(self, length: Any, pressure: Any) -> Any:
        """Whether points lie in the range, where the muscle is stable and the error holds."""
        return self.values(length, pressure).inside

    def lengths(self, pressure: Any) -> tuple[Any, Any]:
        """The shortest and the longest length [m] of the range at a pressure."""
        y = across(self.table, _read("pressure", pressure, "Pa"))
        return edge(self.table.low, y)[0], edge(self.table.high, y)[0]

    @property
    def pressures(self) -> tuple[float, float]:
        """The lowest and the highest pressure [Pa] of the range."""
        return float(self.table.first), float(self.table.last)

    def free_length(self, pressure: Any) -> Any:
        """Length [m] at which the muscle pulls nothing; NaN where the range has none."""
        return self.length_for(pressure, 0.0)

    def length_for(self, pressure: Any, force: Any) -> Any:
        """The longest length [m] at which the muscle pulls a force [N] at a pressure; NaN where the range has none."""
        P, F = np.broadcast_arrays(_read("pressure", pressure, "Pa"), _read("force", force, "N"))
        return inverse.length_for(self.table, P.ravel(), F.ravel()).reshape(P.shape)

    def pressure_for(self, length: Any, force: Any) -> Any:
        """The lowest pressure [Pa] at which the muscle pulls a force [N] at a length; NaN where the range has none."""
        h, F = np.broadcast_arrays(_read("length", length, "m"), _read("force", force, "N"))
        return inverse.pressure_for(self.table, h.ravel(), F.ravel()).reshape(h.shape)

    def jax(self) -> Callable[[Any, Any], Values]:
        """A function of length [m] and pressure [Pa], numbers or arrays, for `jax.grad`, `jit` and `vmap`."""
        import jax.numpy as jnp

        table = Table(*(jnp.asarray(one) for one in self.table))

        def at(length: Any, pressure: Any) -> Values:
            h, P = jnp.broadcast_arrays(jnp.asarray(length, float), jnp.asarray(pressure, float))
            found = evaluate(table, h.reshape(-1), P.reshape(-1), jnp)
            return Values(*(one.reshape(h.shape) for one in found))

        return at

    def to_c(self, name: str = "muscle") -> str:
        """One C99 file that tells the same; its functions begin with `name`: muscle_force(length, pressure), ...

        With friction at the crossings it has muscle_friction(length, pressure) too.
        """
        from mckibben.potential.c_source import c_source

        return c_source(self.table, self.told, name, self.rubs)

    def to_numpy(self) -> str:
        """A Python module that tells the same and needs NumPy alone: force(length, pressure) and so on.

        With friction at the crossings it has friction(length, pressure) and branches(length, pressure) too.
        """
        from mckibben.potential.script import script

        return script(self.table, self.told, self.rubs)

    @property
    def rubber_inside(self) -> float:
        """Volume [m^3] of the rubber that lies inside the braid."""
        return float(self.data.attrs["rubber_inside"])

    @property
    def error(self) -> float:
        """The largest error of the force at states that were not used, over the largest force."""
        return self.force_error / self.largest_force

    @property
    def force_error(self) -> float:
        """That error in N."""
        return float(self.data.attrs["force_error"])

    @property
    def volume_error(self) -> float:
        """The largest error of the volume [m^3] at these states."""
        return float(self.data.attrs["volume_error"])

    @property
    def radius_error(self) -> float:
        """The largest error of the largest radius [m] at these states."""
        return float(self.data.attrs["radius_error"])

    @property
    def stiffness_error(self) -> float:
        """The largest error of the stiffness [N/m] at these states, by the equations; NaN where it was not measured.

        Elsewhere in the range expect up to twice as much, as of the other errors: they are the largest of some states.
        """
        return float(self.data.attrs.get("stiffness_error", np.nan))

    @property
    def friction_error(self) -> float:
        """The largest error of the sliding branches [N] at states that were not used; 0 without friction."""
        return float(self.data.attrs.get("friction_error", 0.0))

    @property
    def largest_force(self) -> float:
        """The largest force [N] of the range, pulling or pushing."""
        return float(self.data.attrs["largest_force"])

    @property
    def tolerance(self) -> float:
        """The error that was asked for, over the largest force."""
        return float(self.data.attrs["tolerance"])

    @property
    def converged(self) -> bool:
        """Whether the errors of force and volume are below it."""
        return bool(self.data.attrs["converged"])

    @property
    def notes(self) -> tuple[str, ...]:
        """What must be known of the map, in sentences."""
        return tuple(line for line in str(self.data.attrs["notes"]).split("\n") if line)

    @property
    def told(self) -> tuple[str, ...]:
        """What must be known of the map in another program, line by line."""
        about, error = self.data.attrs, self.stiffness_error
        stiff = "" if np.isnan(error) else f", stiffness {show(error, 'N/m', 2)}"
        return (
            f"a map of a McKibben muscle, made by mckibben {about['mckibben_version']}",
            f"range: {self.range_said}; gauge pressure; force is positive where the muscle pulls",
            f"largest errors against the solver: force {show(self.force_error, 'N', 2)} (largest force "
            f"{show(self.largest_force, 'N', 4)}), volume {show(self.volume_error, 'm^3', 2)}, "
            f"largest radius {show(self.radius_error, 'm', 2)}{stiff}",
            "outside of the range values go on smoothly, and are not the muscle's",
            *self.notes,
            "the muscle (TOML):",
            *str(about["muscle"]).splitlines(),
        )

    @property
    def range_said(self) -> str:
        """The range in words."""
        ends = float(self.table.low[:, 0].min()), float(self.table.high[:, 0].max())
        said = [[show(end, unit, 4) for end in some] for some, unit in ((ends, "m"), (self.pressures, "Pa"))]
        return ", ".join(" to ".join(words) for words in said)

    @property
    def summary(self) -> pd.DataFrame:
        """DataFrame for people: the largest value of each quantity and its largest error."""
        import pandas as pd

        about = self.data.attrs
        rows = {}
        rubs = () if self.rubs is None else (("friction", "N"),)
        stiff = () if np.isnan(self.stiffness_error) else (("stiffness", "N/m"),)
        for name, unit in (("force", "N"), ("volume", "m^3"), ("radius", "m"), *stiff, *rubs):
            error, largest = float(about[f"{name}_error"]), float(about[f"largest_{name}"])
            rows[name] = (show(largest, unit, 4), show(error, unit, 2), f"{100 * error / largest:.2g} %")
        return pd.DataFrame(rows, index=["largest", "error", "relative"]).T


def _read(name: str, value: Any, unit: str) -> np.ndarray:
    """Numbers of any shape, in SI."""
    try:
        if isinstance(value, (str, list, tuple)) or hasattr(value, "magnitude"):
            found = _parsed(value, unit)
        else:
            found = np.asarray(value, float)
    except UnitError as error:
        raise SpecError(f"chart.{name}", value, str(error), error.advice) from error
    except (TypeError, ValueError) as error:
        raise SpecError(f"chart.{name}", value, f"must be numbers in {unit}, or text with units") from error
    if not np.isfinite(found).all():
        raise SpecError(f"chart.{name}", value, "must be finite numbers")
    return found


def _parsed(value: Any, unit: str) -> np.ndarray:
    if isinstance(value, (list, tuple)):
        return np.array([_parsed(one, unit) for one in value], float)
    return np.asarray(to_si(value, unit), float)

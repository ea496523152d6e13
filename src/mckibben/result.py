"""The answer: an immutable value around an xarray Dataset. It computes nothing.

Every variable is declared once in `VARIABLES`, with its unit and meaning; files, plots and the reference page read it.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from .spec import Muscle, Test
from .spec.text import to_toml
from .verdict import Modes, Verdict

if TYPE_CHECKING:
    import xarray as xr

STEP: dict[str, tuple[str, str]] = {
    "length": ("m", "distance between the fittings"),
    "contraction": ("1", "contraction 1 - h/H0, positive when shorter"),
    "force": ("N", "axial force, positive in tension"),
    "pressure": ("Pa", "gauge pressure"),
    "volume": ("m^3", "volume inside the braid"),
    "energy_bending_1": ("J", "fibre energy, bending in the tangent plane"),
    "energy_bending_2": ("J", "fibre energy, bending normal to the surface"),
    "energy_twist": ("J", "fibre energy, twist"),
    "energy_chamber": ("J", "energy of the chamber"),
    "energy": ("J", "stored energy"),
    "work": ("J", "work done on the muscle since the first state"),
    "verdict": ("", "verdict"),
    "reason": ("", "reason for the verdict"),
    "shape": ("", "shape of the meridian"),
    "converged": ("", "whether equilibrium was found"),
    "iterations": ("1", "Newton systems solved"),
    "residual": ("1", "imbalance over the size of its terms"),
    "error_estimate": ("1", "estimated relative error of force and length"),
    "coefficient_tail": ("1", "last coefficients over the largest"),
    "conserved_variation": ("1", "relative variation of the conserved quantity along the length"),
    "modes_length_control": ("1", "negative symmetric modes under length control"),
    "modes_force_control": ("1", "negative symmetric modes under force control"),
    "modes_antisymmetric": ("1", "negative antisymmetric modes (-1: not separated)"),
    "protocol_step": ("1", "which step of the test a state belongs to"),
}
"""Variables with one value per state: unit and meaning."""

FIELDS: dict[str, tuple[str, str]] = {
    "theta": ("rad", "braid angle from the parallels"),
    "psi": ("rad", "slope angle of the meridian"),
    "r": ("m", "radius"),
    "z": ("m", "axial position from the fixed fitting"),
    "stretch_hoop": ("1", "hoop stretch of the chamber"),
    "stretch_axial": ("1", "meridian stretch of the chamber"),
    "stretch_thickness": ("1", "thickness stretch of the chamber"),
    "u1": ("1/m", "fibre strain u1, geodesic curvature"),
    "u2": ("1/m", "fibre strain u2, normal curvature"),
    "u3": ("1/m", "fibre strain u3, twist"),
    "density_bending_1": ("J/m", "fibre energy per unit v, bending in the tangent plane"),
    "density_bending_2": ("J/m", "fibre energy per unit v, bending normal to the surface"),
    "density_twist": ("J/m", "fibre energy per unit v, twist"),
    "density_fibres": ("J/m", "fibre energy per unit v"),
    "density_chamber": ("J/m", "energy of the chamber per unit v"),
    "fibre_tension": ("N", "tension of one fibre"),
    "share_mesh": ("1", "share of the axial load F + pi r^2 P carried by the mesh"),
    "share_chamber": ("1", "share of the axial load F + pi r^2 P carried by the chamber"),
}
"""Variables along the material coordinate v: unit and meaning."""

VARIABLES = STEP | FIELDS


@attrs.frozen(eq=False)
class Table:
    """What a Dataset is made of, as plain arrays: made and read without xarray, which takes half a second to import."""

    steps: dict[str, np.ndarray]  #: per state (n)
    fields: dict[str, np.ndarray]  #: per state and point (n, q)
    v: np.ndarray  #: axial material coordinate (q) [m]
    attrs: dict[str, Any]

    def dataset(self) -> xr.Dataset:
        """The Dataset; its arrays are read-only."""
        return dataset(self.steps, self.fields, self.v, self.attrs)


def dataset(steps: dict[str, Any], fields: dict[str, np.ndarray], v: np.ndarray, about: dict[str, Any]) -> xr.Dataset:
    """The Dataset of a result; every declared variable must be given."""
    import xarray as xr  # here, because not everybody who wants numbers wants to wait for it

    variables: dict[str, Any] = {}
    for names, values, dims in ((STEP, steps, ("step",)), (FIELDS, fields, ("step", "v"))):
        for name, (unit, meaning) in names.items():
            array = np.asarray(values[name])
            array.flags.writeable = False
            variables[name] = (dims, array, {"long_name": meaning} | ({"units": unit} if unit else {}))
    count = len(variables["length"][1])
    coords = {
        "step": ("step", np.arange(count), {"long_name": "state"}),
        "v": ("v", v, {"units": "m", "long_name": "axial material coordinate"}),
    }
    return xr.Dataset(variables, coords, about)


@attrs.frozen(eq=False)
class Result:
    """States of one test: its specification and a Dataset. Equal if both are the same, number by number."""

    muscle: Muscle
    test: Test
    _given: Table | xr.Dataset = attrs.field(alias="data")

    @cached_property
    def data(self) -> xr.Dataset:
        """Everything known of the states."""
        return self._given.dataset() if isinstance(self._given, Table) else self._given

    @property
    def attributes(self) -> dict[str, Any]:
        """What the Dataset carries beside its variables: title, muscle and test as TOML, versions, date, warnings."""
        return self._given.attrs

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Result):
            return NotImplemented
        return self.muscle == other.muscle and self.test == other.test and self.data.identical(other.data)

    def __hash__(self) -> int:
        return hash((self.muscle, self.test))

    def __len__(self) -> int:
        return len(self.column("length"))

    def column(self, name: str) -> np.ndarray:
        """A variable as a plain read-only array: (states) or (states, points along the muscle)."""
        if isinstance(self._given, Table):
            values = np.asarray((self._given.steps if name in STEP else self._given.fields)[name])
            values.flags.writeable = False
            return values
        return np.asarray(self._given[name].values)

    @property
    def force(self) -> np.ndarray:
        """Axial force [N] per state, positive in tension; NaN where there is none."""
        return self.column("force")

    @property
    def length(self) -> np.ndarray:
        """Distance between the fittings [m] per state."""
        return self.column("length")

    @property
    def contraction(self) -> np.ndarray:
        """Contraction 1 - h/H0 per state."""
        return self.column("contraction")

    @property
    def pressure(self) -> np.ndarray:
        """Gauge pressure [Pa] per state."""
        return self.column("pressure")

    @property
    def volume(self) -> np.ndarray:
        """Volume inside the braid [m^3] per state."""
        return self.column("volume")

    @property
    def verdict(self) -> tuple[str, ...]:
        """Verdict per state."""
        return tuple(str(word) for word in self.column("verdict"))

    @property
    def cautions(self) -> tuple[str, ...]:
        """What a real muscle may do that the model does not know; each names the state from which it may."""
        return tuple(filter(None, self.attributes["warnings"].split("\n")))

    @property
    def reached(self) -> int:
        """Number of states with an equilibrium."""
        return int(self.column("converged").sum())

    @property
    def status(self) -> str:
        """complete, incomplete (some states have no admissible equilibrium or were not reached) or interrupted."""
        return str(self.attributes["status"])

    def __repr__(self) -> str:
        words = sorted(set(self.verdict))
        return f"<Result: {self.test.kind}, {len(self)} states, {self.reached} reached, {', '.join(words)}>"


@attrs.frozen(eq=False)
class State:
    """One state, sought directly: its numbers, verdict and, where it is no good, what there is instead."""

    result: Result
    verdict: Verdict  #: compares equal to its word
    reason: str  #: a sentence that a lab user understands
    modes: Modes | None  #: counts of negative modes
    last_good: State | None = None  #: the last stable state on the way, where none was found at the target
    asymmetric: State | None = None  #: the stable state to which an antisymmetrically unstable one goes

    @property
    def muscle(self) -> Muscle:
        """The specification."""
        return self.result.muscle

    @property
    def data(self) -> xr.Dataset:
        """Everything known of the state, without the step dimension."""
        return self.result.data.isel(step=0)

    def _number(self, name: str) -> float:
        return float(self.result.column(name)[0])

    @property
    def force(self) -> float:
        """Axial force [N], positive in tension; NaN without an admissible state."""
        return self._number("force")

    @property
    def length(self) -> float:
        """Distance between the fittings [m]."""
        return self._number("length")

    @property
    def contraction(self) -> float:
        """Contraction 1 - h/H0."""
        return self._number("contraction")

    @property
    def pressure(self) -> float:
        """Gauge pressure [Pa]."""
        return self._number("pressure")

    @property
    def volume(self) -> float:
        """Volume inside the braid [m^3]."""
        return self._number("volume")

    @property
    def cautions(self) -> tuple[str, ...]:
        """What a real muscle may do there that the model does not know."""
        return tuple(filter(None, self.result.attributes["warnings"].split("\n")))

    @property
    def error_estimate(self) -> float:
        """Estimated relative error of force and length."""
        return self._number("error_estimate")

    def __repr__(self) -> str:
        numbers = (
            f"force {self.force:.6g} N, length {1e3 * self.length:.6g} mm, pressure {1e-5 * self.pressure:.6g} bar"
        )
        return f"<State: {self.verdict}, {numbers}>"


def about(
    muscle: Muscle, test: Test, versions: dict[str, str], date: str, warnings: list[str], status: str
) -> dict[str, Any]:
    """Attributes that a Dataset carries."""
    return {
        "title": f"McKibben muscle, {test.kind} test",
        "muscle": to_toml(muscle, allow_custom=True),
        "test": to_toml(test, allow_custom=True),
        "assumed": ", ".join(muscle.assumed),
        "mckibben_version": versions["mckibben"],
        "versions": ", ".join(f"{name} {version}" for name, version in versions.items()),
        "date": date,
        "status": status,
        "warnings": "\n".join(warnings),
        "source": "Quaglierini, Arroyo, DeSimone, RoboSoft 2023",
    }

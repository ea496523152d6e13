"""`AxialLaw`: how fibres that stretch pull, as a pull test measures it."""

from __future__ import annotations

from mckibben.spec.declared import Reads
from mckibben.spec.errors import SpecError
from mckibben.spec.fields import quantities, spec
from mckibben.units import Number, is_traced

__all__ = ["AxialLaw"]

_SOURCE = "theory page, stretch of the fibres"
_LARGEST = (1e-12, 1e12)


@spec("axial_law")
class AxialLaw:
    """Tension of a fibre over its strain, point by point, as a pull test of one fibre or yarn gives it.

    Between the points the tension is the monotone cubic of Fritsch and Carlson (as SciPy's PCHIP), beyond the first and
    the last one a straight line with the slope there. The energy is its integral, exactly.

    Args:
        strain: lambda - 1 of the points, rising, at least two of them. One of them is 0, where the fibre is free of
            tension; below it, where given, are points under compression.
        force: tension of one fibre at each of them [N], rising, 0 at strain 0.

    Raises:
        SpecError: if the lists are not equally long, do not rise, or have no point at rest.

    >>> yarn = mk.AxialLaw(strain=[0.0, 0.01, 0.02, 0.04], force=["0 N", "0.3 N", "1 N", "4 N"])
    >>> fibre = mk.Fibre(diameter="0.25 mm", E="3 GPa", nu=0.4, stretch=True, axial_law=yarn)
    >>> muscle = mk.presets.paper().replace("braid.fibre", fibre)
    >>> round(mk.solve(muscle, length="115 mm", pressure="1 bar").force, 1)  # N; 101.2 N if they did not stretch
    86.7
    """

    strain: Reads[tuple[float, ...]] = quantities(
        "1", meaning="strain lambda - 1 of each point", size=(1e-12, 1e3), source=_SOURCE
    )
    force: Reads[tuple[float, ...]] = quantities(
        "N", meaning="tension of one fibre at each point", size=_LARGEST, source=_SOURCE
    )

    def __attrs_post_init__(self) -> None:
        if len(self.strain) != len(self.force) or len(self.strain) < 2:
            said = f"must have as many numbers as strain ({len(self.strain)}), two or more"
            raise SpecError("axial_law.force", self.force, said)
        if any(map(is_traced, (*self.strain, *self.force))):
            return
        for name in ("strain", "force"):
            values = getattr(self, name)
            for k in range(1, len(values)):
                if values[k] <= values[k - 1]:
                    said = f"must be above the number before it, {values[k - 1]:g}"
                    raise SpecError(f"axial_law.{name}[{k}]", values[k], said, "sort the points")
        if self.strain[0] <= -1.0:
            raise SpecError("axial_law.strain[0]", self.strain[0], "must be above -1: a fibre has some length")
        at_rest = [force for strain, force in zip(self.strain, self.force, strict=True) if strain == 0.0]
        if at_rest != [0.0]:
            said = "must have the point without tension, strain 0 and force 0 N"
            raise SpecError("axial_law.strain", self.strain, said, "subtract the strain at which the fibre gets tight")

    @property
    def stiffness(self) -> Number:
        """Slope of the first piece from rest on [N], by which the fibre is called stiff or soft."""
        k = self.strain.index(0.0) if 0.0 in self.strain else 0
        k = min(k, len(self.strain) - 2)
        return (self.force[k + 1] - self.force[k]) / (self.strain[k + 1] - self.strain[k])

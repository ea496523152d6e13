"""One fibre: `Fibre`, by its material or by its stiffnesses."""

from __future__ import annotations

import math
from enum import StrEnum

from mckibben.spec.axial import AxialLaw
from mckibben.spec.declared import Reads
from mckibben.spec.errors import SpecError
from mckibben.spec.fields import choice, part, quantity, spec, switch
from mckibben.spec.limits import BENDING
from mckibben.spec.stiffening import Stiffening
from mckibben.units import Number

__all__ = ["Fibre", "Natural"]


class Natural(StrEnum):
    """The shape of a fibre without stress: the helix of the braid as made, or a straight rod."""

    HELICAL = "helical"
    STRAIGHT = "straight"


_ROUND = ("diameter", "E", "nu")
"""What a round solid fibre is given by."""
_GIVEN = ("B1", "B2", "B3")
"""What a fibre of any section is given by."""
_STRETCH = "theory page, stretch of the fibres"
_ENERGY = "Eqs. (20-28)"
"""Source of the stiffnesses: the energy of the paper."""


@spec("braid.fibre")
class Fibre:
    """One fibre: round and solid (diameter, E, nu), or any section by its stiffnesses (B1, B2, B3).

    A round solid fibre has B1 = B2 = E pi d^4/64 and B3 = G pi d^4/32 with G = E/(2 (1 + nu)). The energy that B1, B2,
    B3 multiply is Eq. (20) of the paper. Give all of one way and nothing of the other. The paper's fibres do not
    stretch; with `stretch` they do, by T = EA (lambda - 1) at stretch lambda, or by a law of their own (theory page).

    Args:
        diameter: diameter d of the fibre [m]. Beside B1, B2, B3 it may be given too; it then serves only to check that
            the fibres fit side by side and when they touch.
        E: Young's modulus [Pa].
        nu: Poisson's ratio, above -1 and at most 0.5.
        B1: bending stiffness in the tangent plane of the tube [N m^2].
        B2: bending stiffness normal to the tube [N m^2].
        B3: torsional stiffness [N m^2].
        breaking_force: tension that breaks one fibre [N]. Only compared with the tension found: see `cautions`.
        natural: shape of the fibre without stress, "helical" (as braided, the paper's) or "straight".
        stretch: True if the fibres stretch; False is the paper's.
        axial_stiffness: EA [N], tension over strain; of a round solid fibre it is E pi d^2/4 where it is not given.
        stiffening: `Stiffening` of bending and twist, or None for the paper's quadratic energy.
        axial_law: `AxialLaw` of a fibre that stretches, in place of EA, or None.
        slack: True if a fibre that stretches carries no compression, as yarns do.

    Raises:
        SpecError: for a value out of range, both ways at once, or half of one; for a stretching fibre whose EA is
            unknown, or an axial stiffness of one that does not stretch.

    >>> fibre = mk.Fibre(diameter="0.25 mm", E="3 GPa", nu=0.4)
    >>> [round(1e6 * B, 3) for B in fibre.stiffnesses]  # in N mm^2
    [0.575, 0.575, 0.411]
    """

    diameter: Reads[float | None] = quantity(
        "m",
        meaning="diameter of the round solid fibre",
        low=0.0,
        low_open=True,
        size=(1e-7, 0.1),
        default=None,
        doubt=(0.05, 50.0),
    )
    E: Reads[float | None] = quantity(
        "Pa", meaning="Young's modulus", low=0.0, low_open=True, size=(1e3, 1e13), display="GPa", default=None
    )
    nu: Reads[float | None] = quantity("1", meaning="Poisson's ratio", low=-1.0, low_open=True, high=0.5, default=None)
    B1: Reads[float | None] = quantity(
        "N m^2",
        meaning="bending stiffness in the tangent plane of the tube",
        low=0.0,
        size=BENDING,
        source=_ENERGY,
        default=None,
    )
    B2: Reads[float | None] = quantity(
        "N m^2", meaning="bending stiffness normal to the tube", low=0.0, size=BENDING, source=_ENERGY, default=None
    )
    B3: Reads[float | None] = quantity(
        "N m^2", meaning="torsional stiffness", low=0.0, size=BENDING, source=_ENERGY, default=None
    )
    breaking_force: Reads[float | None] = quantity(
        "N", meaning="tension that breaks one fibre", low=0.0, low_open=True, size=(1e-9, 1e9), default=None
    )
    natural: Reads[Natural] = choice(Natural, meaning="shape of the fibre without stress", default=Natural.HELICAL)
    stretch: Reads[bool] = switch(meaning="whether the fibres stretch", source=_STRETCH, default=False)
    axial_stiffness: Reads[float | None] = quantity(
        "N", meaning="axial stiffness EA of one fibre", low=0.0, low_open=True, size=(1e-6, 1e12), source=_STRETCH,
        default=None,
    )  # fmt: skip
    stiffening: Stiffening | None = part(
        Stiffening, meaning="bending and twist that stiffen, none for the paper's", default=None, quiet=True
    )
    axial_law: AxialLaw | None = part(
        AxialLaw, meaning="tension over strain of a fibre that stretches, none for EA", default=None, quiet=True
    )
    slack: Reads[bool] = switch(
        meaning="whether a fibre that stretches carries no compression", source=_STRETCH, default=False
    )

    def __attrs_post_init__(self) -> None:
        given = [name for name in _GIVEN if getattr(self, name) is not None]
        material = [name for name in ("E", "nu") if getattr(self, name) is not None]
        if given and material:
            said = f"both {' and '.join(given)} and {' and '.join(material)} are given"
            raise SpecError("braid.fibre", allowed=said, advice="give either diameter, E, nu or B1, B2, B3")
        way = _GIVEN if given else _ROUND
        missing = [name for name in way if getattr(self, name) is None]
        if missing:
            other = "diameter, E, nu" if given else "B1, B2, B3"
            said = f"{' and '.join(missing)} missing"
            raise SpecError("braid.fibre", allowed=said, advice=f"give all of {', '.join(way)} (or instead {other})")
        self._check_stretch()

    def _check_stretch(self) -> None:
        """Raise for an axial stiffness, law or slack without stretch, two of them at once, or stretch without any."""
        if self.axial_law is not None and self.axial_stiffness is not None:
            said = "does not go with an axial law, which says it all"
            raise SpecError("braid.fibre.axial_stiffness", self.axial_stiffness, said, "leave one of them out")
        if self.stretch and self.B1 is not None and self.axial_stiffness is None and self.axial_law is None:
            said = "is missing: B1, B2, B3 do not tell how stiff a fibre is along its length"
            raise SpecError("braid.fibre.axial_stiffness", allowed=said, advice="give EA, such as 147 N")
        only = ("axial_stiffness", "axial_law", "slack")
        idle = [] if self.stretch else [name for name in only if getattr(self, name)]
        if idle:
            said = "means something only for fibres that stretch"
            advice = "set stretch to true, or leave it out"
            raise SpecError(f"braid.fibre.{idle[0]}", getattr(self, idle[0]), said, advice)

    @property
    def is_round(self) -> bool:
        """Whether the stiffnesses follow from diameter, E and nu."""
        return self.B1 is None

    @property
    def stiffnesses(self) -> tuple[Number, Number, Number]:
        """B1, B2, B3 [N m^2]; round: B1 = B2 = E pi d^4/64, B3 = G pi d^4/32, G = E/(2 (1 + nu))."""
        if self.B1 is not None and self.B2 is not None and self.B3 is not None:
            return self.B1, self.B2, self.B3
        assert self.diameter is not None
        assert self.E is not None
        assert self.nu is not None
        bending = self.E * math.pi * self.diameter**4 / 64.0
        return bending, bending, bending / (1.0 + self.nu)

    @property
    def EA(self) -> Number | None:  # noqa: N802
        """Axial stiffness [N]: as given, E pi d^2/4, or that of a law at rest; None for one that does not stretch."""
        if self.axial_law is not None:
            return self.axial_law.stiffness
        if not self.stretch or self.axial_stiffness is not None:
            return self.axial_stiffness
        assert self.diameter is not None
        assert self.E is not None
        return self.E * math.pi * self.diameter**2 / 4.0

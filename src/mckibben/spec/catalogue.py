"""The catalogue behind the presets: families of muscles that are sold or made at home, each value with its source.

Little of them is published. What cannot be shown to be printed somewhere is assumed, and says so wherever it shows.
"""

from __future__ import annotations

from collections.abc import Callable

import attrs

from mckibben.spec.chamber import Chamber
from mckibben.spec.fibre import Fibre
from mckibben.spec.laws import NeoHookean
from mckibben.spec.muscle import Braid, Muscle
from mckibben.spec.sleeve import centre_radius

__all__ = ["CATALOGUE", "Entry", "assumed_in"]


@attrs.frozen
class Entry:
    """One muscle of the catalogue."""

    about: str  #: what it is, in a line
    rated: str  #: gauge pressure that it is meant for
    make: Callable[[], Muscle]
    sources: dict[str, str]  #: by the name of a field; those of assumptions start with "assumed"


def assumed_in(sources: dict[str, str]) -> tuple[str, ...]:
    """The fields whose values are assumptions."""
    return tuple(field for field, source in sources.items() if source.startswith("assumed"))


_MARTENS = "printed: Martens and Boblan, Actuators 2017, 6, 33 (DMSP-20-300)"
_LIKE = "assumed: that of the DMSP-20 in Martens and Boblan, Actuators 2017, 6, 33"
_SPREAD = (
    "assumed: tubes of latex and silicone lie between some 100 and 400 kPa, which moves the free contraction of pet-10 "
    "at 3 bar from 24 to 9 %: measure your own (recipes)"
)
_ENDS = "assumed: the fittings hold radius and slope"
_INSIDE = "assumed: a real wall lies inside the fibres and is no thin one"
_HELICAL = "assumed: fibres take the helix of the braid as made"


def _festo(size: int, length: str, named: str) -> Entry:
    """A DMSP of an inner diameter [mm]: fibres at the outer radius, which is that of the wall's outside."""
    own, wall = size == 20, 1.8
    printed = _MARTENS if own else _LIKE
    sources = {
        "braid.radius": (
            "assumed: the fibres lie in the outer face of the membrane; inner diameter "
            + ("and wall " if own else "by its name, wall as of the DMSP-20, both ")
            + ("printed in Martens and Boblan, Actuators 2017, 6, 33" if own else "unpublished here")
        ),
        "braid.length": _MARTENS if own else "assumed: the length that its name says, or one that is usual",
        "braid.angle": printed,
        "braid.fibres": "assumed: nothing is published",
        "braid.fibre.diameter": "assumed: aramid yarn, of which nothing is published; for jamming alone",
        "braid.fibre.B1": "assumed: yarn, whose filaments slide, hardly bends",
        "braid.fibre.B2": "assumed: yarn, whose filaments slide, hardly bends",
        "braid.fibre.B3": "assumed: yarn, whose filaments slide, hardly twists",
        "braid.fibre.natural": _HELICAL,
        "chamber.thickness": printed,
        "chamber.law.c1": "assumed: chloroprene, of which nothing is published; the largest unknown",
        "chamber.lies": _INSIDE,
        "chamber.wall": _INSIDE,
        "ends": _ENDS,
    }

    def make() -> Muscle:
        fibre = Fibre(diameter="0.25 mm", B1="0.05 N mm^2", B2="0.05 N mm^2", B3="0.05 N mm^2")
        braid = Braid(
            radius=f"{0.5 * size + wall} mm", length=length, angle="28.6 deg", angle_from="axis",
            fibres=8 * round(4.0 * (0.5 * size + wall) / 4.0), fibre=fibre,
        )  # fmt: skip
        chamber = Chamber(thickness=f"{wall} mm", law=NeoHookean(c1="0.3 MPa"), lies="inside", wall="thick")
        return Muscle(braid=braid, chamber=chamber, name=named, assumed=assumed_in(sources))

    pressure = "8 bar" if size == 10 else "6 bar"
    said = f"a Festo DMSP of {size} mm inner diameter, as far as published; up to {pressure} (assumed)"
    return Entry(said, pressure, make, sources)


def _thin(outer: float) -> Entry:
    """A thin muscle of an outer diameter [mm]: the braid's fibres cross on a tube that fills it but for a twentieth."""
    said = "assumed: as thin muscles are described (24 fibres, 18 deg from the axis), without a publication at hand"
    tube = "assumed: silicone tube that fills the braid, a wall of a sixth of its diameter"
    sources = {
        "braid.radius": "assumed: half of the outer diameter that it is named by, less one fibre",
        "braid.length": "assumed: they are sold by length",
        "braid.angle": said,
        "braid.fibres": said,
        "braid.fibre.diameter": "assumed: a twentieth of the outer diameter",
        "braid.fibre.B1": "assumed: yarn, whose filaments slide, hardly bends",
        "braid.fibre.B2": "assumed: yarn, whose filaments slide, hardly bends",
        "braid.fibre.B3": "assumed: yarn, whose filaments slide, hardly twists",
        "braid.fibre.natural": _HELICAL,
        "chamber.outer_diameter": tube,
        "chamber.inner_diameter": tube,
        "chamber.law.c1": _SPREAD,
        "chamber.wall": _INSIDE,
        "ends": _ENDS,
    }

    def make() -> Muscle:
        thick = outer / 20.0
        stiffness = f"{1e-3 * (outer / 1.8) ** 4:.6g} N mm^2"
        braid = Braid(
            radius=f"{0.5 * outer - thick:.6g} mm", length="100 mm", angle="18 deg", angle_from="axis", fibres=24,
            fibre=Fibre(diameter=f"{thick:.6g} mm", B1=stiffness, B2=stiffness, B3=stiffness),
        )  # fmt: skip
        tube = 0.95 * (outer - 4.0 * thick)
        chamber = Chamber(
            outer_diameter=f"{tube:.6g} mm", inner_diameter=f"{tube * 2.0 / 3.0:.6g} mm", wall="thick",
            law=NeoHookean(c1="0.2 MPa"),
        )  # fmt: skip
        return Muscle(braid=braid, chamber=chamber, name=f"thin-{outer}", assumed=assumed_in(sources))

    about = f"a thin muscle of {outer} mm outer diameter, 24 fibres; up to 3 bar (assumed)"
    return Entry(about, "3 bar", make, sources)


def _sleeve(size: int, fibres: int, diameter: float, tube: tuple[float, float]) -> Entry:
    """A home-made muscle: PET sleeving of a nominal (inner) diameter [mm] on a tube of two diameters [mm]."""
    filament = "assumed: PET monofilament; makers name the size alone, count and measure your own"
    sold = "assumed: a tube of a size that is sold and slips in"
    sources = {
        "braid.radius": "assumed: from the nominal diameter as the inner one, by centre_radius",
        "braid.length": "assumed: cut as you like",
        "braid.angle": (
            "assumed: sleeving opens to some 1.8 times its nominal diameter (mj-ist.com, PET cable sleeve tolerance "
            "management, 2025), where its fibres lie flat: cos(theta0) of about 1/1.8"
        ),
        "braid.fibres": filament,
        "braid.fibre.diameter": filament,
        "braid.fibre.E": filament,
        "braid.fibre.nu": filament,
        "braid.fibre.natural": _HELICAL,
        "braid.fibre.stretch": "switched on: fibres of PET stretch (theory page)",
        "chamber.outer_diameter": sold,
        "chamber.inner_diameter": sold,
        "chamber.law.c1": _SPREAD,
        "chamber.wall": _INSIDE,
        "ends": _ENDS,
    }  # fmt: skip

    def make() -> Muscle:
        radius = centre_radius(inner_diameter=f"{size} mm", fibre_diameter=f"{diameter} mm")
        fibre = Fibre(diameter=f"{diameter} mm", E="3 GPa", nu=0.4, stretch=True)
        braid = Braid(radius=radius, length="200 mm", angle="56 deg", fibres=fibres, fibre=fibre)
        outer, inner = (f"{number} mm" for number in tube)
        chamber = Chamber(outer_diameter=outer, inner_diameter=inner, wall="thick", law=NeoHookean(c1="0.2 MPa"))
        return Muscle(braid=braid, chamber=chamber, name=f"pet-{size}", assumed=assumed_in(sources))

    about = f"home-made: PET sleeving of {size} mm on a tube of {tube[0]:g} x {tube[1]:g} mm; up to 3 bar (assumed)"
    return Entry(about, "3 bar", make, sources)


CATALOGUE = {
    "festo-dmsp-10": _festo(10, "250 mm", "festo-dmsp-10"),
    "festo-dmsp-20": _festo(20, "296 mm", "festo-dmsp-20"),
    "festo-dmsp-40": _festo(40, "300 mm", "festo-dmsp-40"),
    "thin-1.8": _thin(1.8),
    "thin-2.5": _thin(2.5),
    "thin-4.5": _thin(4.5),
    "pet-3": _sleeve(3, 24, 0.2, (3.0, 2.0)),
    "pet-6": _sleeve(6, 48, 0.25, (6.0, 4.0)),
    "pet-10": _sleeve(10, 64, 0.25, (8.0, 6.0)),
    "pet-12": _sleeve(12, 72, 0.25, (10.0, 7.0)),
}
"""The catalogue, by name."""

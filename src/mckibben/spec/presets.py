"""Named muscles. Every value has a source; values that are assumptions are named in `muscle.assumed`.

`paper()` is the muscle of Quaglierini, Arroyo and DeSimone (RoboSoft 2023), `reference()` the one whose results were
computed with two independent codes. The others are families that are sold or made at home: `get` them by name.

>>> mk.presets.names()[:5]
('paper', 'reference', 'festo-dmsp-10', 'festo-dmsp-20', 'festo-dmsp-40')
>>> mk.presets.paper().replace("braid.fibres", 40).name
'paper (changed)'
"""

from __future__ import annotations

from collections.abc import Callable

from mckibben.spec.catalogue import CATALOGUE, assumed_in
from mckibben.spec.chamber import Chamber
from mckibben.spec.errors import SpecError, nearest
from mckibben.spec.fibre import Fibre
from mckibben.spec.laws import MooneyRivlin
from mckibben.spec.muscle import Braid, Muscle

__all__ = ["about", "get", "names", "paper", "reference", "sources"]

_PAPER = "printed: Quaglierini, Arroyo and DeSimone, RoboSoft 2023, section III"
_COUNT = "assumed: common factor of the element counts 13,048 and 14,728 in Hassan et al. 2019"
_FIBRE = "assumed: PET monofilament, chosen to satisfy every statement of the paper, which prints no stiffness"
_CHAMBER = "assumed: soft thin chamber, chosen to satisfy every statement of the paper, which prints no constants"
_ENDS = "assumed: the paper calls the mesh clamped at its bases, and leaves open whether the slope is held too"
_VERIFY = "verification set of this project, computed with two independent codes; not a measured muscle"

_SOURCES: dict[str, dict[str, str]] = {
    "paper": {
        "braid.radius": _PAPER,
        "braid.length": _PAPER,
        "braid.angle": _PAPER,
        "braid.fibres": _COUNT,
        "braid.fibre.diameter": _FIBRE,
        "braid.fibre.E": _FIBRE,
        "braid.fibre.nu": _FIBRE,
        "braid.fibre.natural": "stated by the model of the paper: the helix is free of stress",
        "chamber.thickness": _CHAMBER,
        "chamber.law.c1": _CHAMBER,
        "chamber.law.c2": _CHAMBER,
        "ends": _ENDS,
    },
    "reference": {
        "braid.radius": _VERIFY,
        "braid.length": _VERIFY,
        "braid.angle": _VERIFY,
        "braid.fibres": _VERIFY,
        "braid.fibre.B1": _VERIFY,
        "braid.fibre.B2": _VERIFY,
        "braid.fibre.B3": _VERIFY,
        "braid.fibre.natural": _VERIFY,
        "chamber.thickness": _VERIFY,
        "chamber.law.c1": _VERIFY,
        "chamber.law.c2": _VERIFY,
        "ends": _VERIFY,
    },
}


def paper() -> Muscle:
    """The actuator of the paper: geometry as printed, everything else assumed.

    Radius 12.5 mm, length 85 mm, braid angle 37 deg from the parallels (section III of the paper). Assumed are 56 PET
    fibres of 0.25 mm, a chamber of 1 mm with c1 = 8.5 kPa, and clamped ends.

    Returns:
        A `Muscle` whose `assumed` names the fields that the paper does not print.

    Raises:
        Nothing.

    >>> muscle = mk.presets.paper()
    >>> muscle.braid.radius, "braid.radius" in muscle.assumed, "braid.fibres" in muscle.assumed
    (0.0125, False, True)
    """
    return Muscle(
        braid=Braid(
            radius="12.5 mm", length="85 mm", angle="37 deg", fibres=56,
            fibre=Fibre(diameter="0.25 mm", E="3 GPa", nu=0.4),
        ),
        chamber=Chamber(thickness="1 mm", law=MooneyRivlin(c1="8.5 kPa", c2=0.0)),
        ends="clamped",
        name="paper",
        assumed=assumed_in(_SOURCES["paper"]),
    )  # fmt: skip


def reference() -> Muscle:
    """The stiffer muscle of the reference values: each of them was computed with two independent codes.

    The paper's geometry with B1 = B2 = 0.575 and B3 = 0.41 N mm^2, and a chamber of 1 mm with c1 = 50 kPa. It is for
    checking codes against each other, and is not a measured muscle.

    Returns:
        A `Muscle`; nothing in it counts as assumed.

    Raises:
        Nothing.

    >>> muscle = mk.presets.reference()
    >>> muscle.chamber.law
    MooneyRivlin(c1='50 kPa', c2='0 kPa')
    """
    return Muscle(
        braid=Braid(
            radius="12.5 mm", length="85 mm", angle="37 deg", fibres=56,
            fibre=Fibre(B1="0.575 N mm^2", B2="0.575 N mm^2", B3="0.41 N mm^2"),
        ),
        chamber=Chamber(thickness="1 mm", law=MooneyRivlin(c1="0.05 MPa", c2=0.0)),
        ends="clamped",
        name="reference",
    )  # fmt: skip


_PRESETS: dict[str, Callable[[], Muscle]] = {"paper": paper, "reference": reference}
_PRESETS |= {name: entry.make for name, entry in CATALOGUE.items()}
_SOURCES |= {name: entry.sources for name, entry in CATALOGUE.items()}


def names() -> tuple[str, ...]:
    """The names of all presets.

    Returns:
        A tuple of names that `get`, `about` and `sources` take.

    Raises:
        Nothing.

    >>> mk.presets.names()[-4:]
    ('pet-3', 'pet-6', 'pet-10', 'pet-12')
    """
    return tuple(_PRESETS)


def get(name: str) -> Muscle:
    """The preset called `name`.

    Args:
        name: one of `names()`.

    Returns:
        A `Muscle`, the same as from the function of that name.

    Raises:
        SpecError: with the nearest name if there is no preset called so.

    >>> mk.presets.get("paper") == mk.presets.paper()
    True
    """
    _check(name)
    return _PRESETS[name]()


def about(name: str) -> str:
    """What a preset is, in a line, with the pressure that it is meant for where one is known or assumed.

    Args:
        name: one of `names()`.

    Returns:
        A sentence without its full stop.

    Raises:
        SpecError: with the nearest name if there is no preset called so.

    >>> mk.presets.about("pet-10")
    'home-made: PET sleeving of 10 mm on a tube of 8 x 6 mm; up to 3 bar (assumed)'
    """
    _check(name)
    return CATALOGUE[name].about if name in CATALOGUE else (_PRESETS[name].__doc__ or "").partition("\n")[0].rstrip(".")


def sources(name: str) -> dict[str, str]:
    """Where each value of a preset comes from, by dotted field name.

    Args:
        name: one of `names()`.

    Returns:
        A dict from the name of a field to its source in words; those of assumptions start with "assumed".

    Raises:
        SpecError: with the nearest name if there is no preset called so.

    >>> mk.presets.sources("paper")["braid.angle"]
    'printed: Quaglierini, Arroyo and DeSimone, RoboSoft 2023, section III'
    """
    _check(name)
    return dict(_SOURCES[name])


def _check(name: object) -> None:
    if not isinstance(name, str):
        raise SpecError("muscle.preset", name, "must be a name", "choose from " + ", ".join(_PRESETS))
    if name not in _PRESETS:
        raise SpecError("muscle.preset", name, "there is no such preset", nearest(name, _PRESETS))

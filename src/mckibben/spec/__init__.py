"""The specification: the muscle and the test that a user describes, immutable and checked, in SI numbers."""

from mckibben.spec.chamber import Chamber, Side, Wall
from mckibben.spec.declared import describe, numbers, walk
from mckibben.spec.ends import Ends
from mckibben.spec.errors import SpecError
from mckibben.spec.fibre import Fibre
from mckibben.spec.fields import spec_classes
from mckibben.spec.fittings import Fittings
from mckibben.spec.friction import Friction
from mckibben.spec.laws import LAWS, ArrudaBoyce, CustomLaw, Gent, Law, MooneyRivlin, NeoHookean, Ogden, Rubber, Yeoh
from mckibben.spec.loading import (
    TESTS,
    Along,
    BlockedForce,
    FreeContraction,
    Gas,
    Isobaric,
    Isometric,
    Isotonic,
    Protocol,
    Step,
    Test,
)
from mckibben.spec.muscle import Braid, Joint, Muscle
from mckibben.spec.path import Path, PathMode
from mckibben.spec.reference import reference_markdown
from mckibben.spec.stiffening import Stiffening

__all__ = [
    "LAWS",
    "TESTS",
    "Along",
    "ArrudaBoyce",
    "BlockedForce",
    "Braid",
    "Chamber",
    "CustomLaw",
    "Ends",
    "Fibre",
    "Fittings",
    "FreeContraction",
    "Friction",
    "Gas",
    "Gent",
    "Isobaric",
    "Isometric",
    "Isotonic",
    "Joint",
    "Law",
    "MooneyRivlin",
    "Muscle",
    "NeoHookean",
    "Ogden",
    "Path",
    "PathMode",
    "Protocol",
    "Rubber",
    "Side",
    "SpecError",
    "Step",
    "Stiffening",
    "Test",
    "Wall",
    "Yeoh",
    "describe",
    "numbers",
    "reference_markdown",
    "spec_classes",
    "walk",
]

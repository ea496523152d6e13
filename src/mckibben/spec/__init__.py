"""The specification: the muscle and the test that a user describes, immutable and checked, in SI numbers."""

from mckibben.spec.air import Isothermal, Polytropic, Supply, Valve, WallHeat
from mckibben.spec.angle_profile import AngleProfile
from mckibben.spec.axial import AxialLaw
from mckibben.spec.chamber import Chamber, Side, Wall
from mckibben.spec.controls import PID, Controller
from mckibben.spec.declared import describe, numbers, walk
from mckibben.spec.ends import Ends
from mckibben.spec.errors import SpecError
from mckibben.spec.fibre import Fibre
from mckibben.spec.fields import spec_classes
from mckibben.spec.fittings import Fittings
from mckibben.spec.friction import Friction
from mckibben.spec.laws import (
    LAWS,
    ArrudaBoyce,
    Bellows,
    CustomLaw,
    Gent,
    Law,
    MooneyRivlin,
    NeoHookean,
    Ogden,
    Rubber,
    Yeoh,
)
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
from mckibben.spec.loads import FixedEnd, Load, Pulley, Viscosity
from mckibben.spec.measures import AirVolume, ForceAt, Mass, PressureFor, Stroke
from mckibben.spec.muscle import Braid, Joint, Muscle
from mckibben.spec.path import Path, PathMode
from mckibben.spec.ranged import (
    Diameter,
    FibreSafety,
    FibreTension,
    ForceVariation,
    JammingMargin,
    StabilityMargin,
    Work,
)
from mckibben.spec.reference import reference_markdown
from mckibben.spec.rig import Rig
from mckibben.spec.series import Series
from mckibben.spec.signal import Constant
from mckibben.spec.signals import PWM, Jump, Ramp, Sine
from mckibben.spec.stiffening import Stiffening
from mckibben.spec.targets import CurveMiss, ProfileMiss

__all__ = [
    "LAWS",
    "PID",
    "PWM",
    "TESTS",
    "AirVolume",
    "Along",
    "AngleProfile",
    "ArrudaBoyce",
    "AxialLaw",
    "Bellows",
    "BlockedForce",
    "Braid",
    "Chamber",
    "Constant",
    "Controller",
    "CurveMiss",
    "CustomLaw",
    "Diameter",
    "Ends",
    "Fibre",
    "FibreSafety",
    "FibreTension",
    "Fittings",
    "FixedEnd",
    "ForceAt",
    "ForceVariation",
    "FreeContraction",
    "Friction",
    "Gas",
    "Gent",
    "Isobaric",
    "Isometric",
    "Isothermal",
    "Isotonic",
    "JammingMargin",
    "Joint",
    "Jump",
    "Law",
    "Load",
    "Mass",
    "MooneyRivlin",
    "Muscle",
    "NeoHookean",
    "Ogden",
    "Path",
    "PathMode",
    "Polytropic",
    "PressureFor",
    "ProfileMiss",
    "Protocol",
    "Pulley",
    "Ramp",
    "Rig",
    "Rubber",
    "Series",
    "Side",
    "Sine",
    "SpecError",
    "StabilityMargin",
    "Step",
    "Stiffening",
    "Stroke",
    "Supply",
    "Test",
    "Valve",
    "Viscosity",
    "Wall",
    "WallHeat",
    "Work",
    "Yeoh",
    "describe",
    "numbers",
    "reference_markdown",
    "spec_classes",
    "walk",
]

"""Mechanics of McKibben artificial muscles. `import mckibben as mk`; heavy parts load when they are used."""

import sys
from importlib import import_module
from typing import Any

from mckibben.shown import drawn_by

_PUBLIC = {
    "mckibben.spec": (
        "AngleProfile", "ArrudaBoyce", "AxialLaw", "Bellows", "Braid", "Chamber", "CustomLaw", "Ends", "Fibre",
        "Fittings", "Friction",
        "Gent", "Joint", "MooneyRivlin", "Muscle", "NeoHookean", "Ogden", "Rubber", "Yeoh", "BlockedForce",
        "FreeContraction",
        "Isobaric", "Isometric", "Isotonic", "Protocol", "Step", "Stiffening",
        "SpecError", "Constant", "Controller", "FixedEnd", "Isothermal", "Jump", "Load", "PID", "PWM", "Polytropic",
        "Pulley", "Ramp", "Rig", "Series", "Sine", "Supply", "Valve", "Viscosity", "WallHeat",
    ),
    "mckibben.spec.sleeve": ("centre_radius",),
    "mckibben.spec.measures": (
        "AirVolume", "ForceAt", "Mass", "PressureFor", "Stroke",
    ),
    "mckibben.spec.targets": ("CurveMiss", "ProfileMiss"),
    "mckibben.spec.ranged": (
        "Diameter", "FibreSafety", "FibreTension", "ForceVariation", "JammingMargin", "StabilityMargin", "Work",
    ),
    "mckibben.spec.wishes": ("Demand", "Maximise", "Minimise"),
    "mckibben.watching": ("progress",),
    "mckibben.experiments.run": ("run",),
    "mckibben.experiments.solve": ("solve",),
    "mckibben.experiments.dead_zone": ("DeadZone", "dead_zone"),
    "mckibben.experiments.burst": ("Burst", "burst_pressures"),
    "mckibben.experiments.limits": ("Limits", "least_pressure", "limits", "working_range"),
    "mckibben.measure.caution": ("MuscleWarning", "cautions"),
    "mckibben.sweeps.sweep": ("sweep",),
    "mckibben.sweeps.trouble": ("SweepError",),
    "mckibben.experiments.force_map": ("force_map",),
    "mckibben.experiments.textbook": ("textbook_force",),
    "mckibben.experiments.response": ("response",),
    "mckibben.experiments.sensitivity": ("sensitivity",),
    "mckibben.experiments.effects": ("effects",),
    "mckibben.results.effects": ("Effects",),
    "mckibben.results.sensitivity": ("Sensitivity",),
    "mckibben.fitting.fit": ("fit",),
    "mckibben.fitting.answer": ("Fit",),
    "mckibben.fitting.choice": ("compare_models",),
    "mckibben.charts.chart": ("chart",),
    "mckibben.exports.export": ("export",),
    "mckibben.exports.mujoco": ("in_mujoco",),
    "mckibben.potential.chart": ("Chart",),
    "mckibben.designing.design": ("design",),
    "mckibben.designing.answer": ("Design",),
    "mckibben.motion.simulate": ("simulate", "simulate_many"),
    "mckibben.motion.rigfile": ("read_rig", "read_signal"),
    "mckibben.motiongradients.response": ("motion_response",),
    "mckibben.motion.steps": ("per_cycle", "step_response"),
    "mckibben.motion.linear": ("bode",),
    "mckibben.motion.sizing": ("size_valve",),
    "mckibben.results.motion": ("Motion",),
    "mckibben.data.recording": ("Recording", "read_recording"),
    "mckibben.motionfits.fit": ("fit_motion",),
    "mckibben.results.motionfit": ("MotionFit",),
    "mckibben.view.plot": ("plot",),
    "mckibben.view.interactive": ("interactive",),
    "mckibben.view.scene": ("scene",),
    "mckibben.film.animate": ("animate",),
    "mckibben.view.shapefile": ("save_shape",),
    "mckibben.scatter.tolerances": ("tolerances",),
    "mckibben.results.tolerances": ("Tolerances",),
    "mckibben.sheet.datasheet": ("datasheet",),
    "mckibben.page.serve": ("serve",),
    "mckibben.results.result": ("Result", "State"),
    "mckibben.data.read": ("read_data",),
    "mckibben.data.samples": ("sample_data",),
    "mckibben.data.values": ("Data",),
    "mckibben.files.case": ("read_case",),
    "mckibben.files.store": ("save",),
    "mckibben.designing.load": ("load",),
}  # fmt: skip
_HOME = {name: module for module, names in _PUBLIC.items() for name in names}
_MODULES = ("presets",)

__all__ = sorted([*_HOME, *_MODULES])


def _html(value: Any) -> str:
    """A value as a notebook shows it."""
    made: str = import_module("mckibben.view.notebook").html(value)
    return made


drawn_by(_html)


def __getattr__(name: str) -> Any:
    if "jax" in sys.modules and name in __all__:  # whoever uses JAX may give it muscles, which must be pytrees by then
        import_module("mckibben.model.parameters")
    if name in _HOME:
        return getattr(import_module(_HOME[name]), name)
    if name in _MODULES:
        return import_module(f"mckibben.spec.{name}")
    laws = import_module("mckibben.spec.laws")
    if name in laws.__all__:  # a law that is new there needs no other list
        return getattr(laws, name)
    raise AttributeError(f"module 'mckibben' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__

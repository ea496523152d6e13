"""Mechanics of McKibben artificial muscles. `import mckibben as mk`; heavy parts load when they are used."""

import sys
from importlib import import_module
from typing import Any

_PUBLIC = {
    "mckibben.spec": (
        "Braid", "Chamber", "CustomLaw", "Ends", "Fibre", "Gent", "MooneyRivlin", "Muscle", "NeoHookean", "Ogden",
        "Yeoh", "BlockedForce", "FreeContraction", "Isobaric", "Isometric", "Isotonic", "Protocol", "Step",
        "SpecError",
    ),
    "mckibben.experiment": ("run", "MuscleWarning"),
    "mckibben.seek": ("solve",),
    "mckibben.reach": ("Limits", "least_pressure", "limits", "working_range"),
    "mckibben.caution": ("cautions",),
    "mckibben.study.sweep": ("sweep",),
    "mckibben.study.trouble": ("SweepError",),
    "mckibben.datasheet": ("force_map",),
    "mckibben.differentiable": ("response",),
    "mckibben.derivative": ("sensitivity",),
    "mckibben.sensitivities": ("Sensitivity",),
    "mckibben.view.curves": ("plot",),
    "mckibben.result": ("Result", "State"),
    "mckibben.files.case": ("read_case",),
    "mckibben.files.store": ("load", "save"),
}  # fmt: skip
_HOME = {name: module for module, names in _PUBLIC.items() for name in names}
_MODULES = ("presets",)

__all__ = sorted([*_HOME, *_MODULES])


def __getattr__(name: str) -> Any:
    if "jax" in sys.modules and name in __all__:  # whoever uses JAX may give it muscles, which must be pytrees by then
        import_module("mckibben.model.pytrees")
    if name in _HOME:
        return getattr(import_module(_HOME[name]), name)
    if name in _MODULES:
        return import_module(f"mckibben.{name}")
    raise AttributeError(f"module 'mckibben' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__

"""What an FMU says of itself: modelDescription.xml, and its variables in C."""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree as Xml

from mckibben.exports.fmuvariables import Variable

__all__ = ["description", "in_c"]

UNITS: dict[str, tuple[dict[str, int], tuple[str, float] | None]] = {
    "Pa": ({"kg": 1, "m": -1, "s": -2}, ("bar", 1e-5)),
    "m": ({"m": 1}, ("mm", 1e3)),
    "N": ({"kg": 1, "m": 1, "s": -2}, None),
    "m2": ({"m": 2}, ("cm2", 1e4)),
    "m3": ({"m": 3}, ("cm3", 1e6)),
    "N/m": ({"kg": 1, "s": -2}, ("N/mm", 1e-3)),
    "m3/Pa": ({"kg": -1, "m": 4, "s": 2}, ("cm3/bar", 1e11)),
    "kg": ({"kg": 1}, ("g", 1e3)),
    "N.s/m": ({"kg": 1, "s": -1}, None),
    "m/s": ({"m": 1, "s": -1}, None),
    "m/s2": ({"m": 1, "s": -2}, None),
    "m3/(s.Pa)": ({"kg": -1, "m": 4, "s": 1}, ("L/s/bar", 1e8)),
    "K": ({"K": 1}, None),
    "kg/s": ({"kg": 1, "s": -1}, ("g/s", 1e3)),
    "s": ({"s": 1}, None),
}
"""Units by FMI's names: exponents of the base units, and the unit for people with its factor."""
STEP = 1e-3
"""Step [s] of communication that is proposed."""


def description(variables: Sequence[Variable], name: str, guid: str, meaning: str, version: str) -> str:
    """The file's text, for FMI 2.0."""
    root = Xml.Element("fmiModelDescription", {
        "fmiVersion": "2.0", "modelName": name, "guid": guid, "description": meaning,
        "generationTool": f"mckibben {version}", "variableNamingConvention": "flat",
    })  # fmt: skip
    model = Xml.SubElement(root, "CoSimulation", {
        "modelIdentifier": name, "canHandleVariableCommunicationStepSize": "true",
        "canNotUseMemoryManagementFunctions": "true", "canGetAndSetFMUstate": "true",
    })  # fmt: skip
    Xml.SubElement(Xml.SubElement(model, "SourceFiles"), "File", name="fmu.c")
    units = Xml.SubElement(root, "UnitDefinitions")
    for unit in dict.fromkeys(variable.unit for variable in variables if variable.unit):
        _unit(units, unit)
    Xml.SubElement(root, "DefaultExperiment", startTime="0", stopTime="1", stepSize=str(STEP))
    listed = Xml.SubElement(root, "ModelVariables")
    for k, variable in enumerate(variables):
        _variable(listed, k, variable)
    structure = Xml.SubElement(root, "ModelStructure")
    for group in ("Outputs", "InitialUnknowns"):
        inside = Xml.SubElement(structure, group)
        for k, variable in enumerate(variables):
            if variable.kind == "output":
                Xml.SubElement(inside, "Unknown", index=str(k + 1))
    Xml.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + Xml.tostring(root, encoding="unicode") + "\n"


def _unit(units: Xml.Element, unit: str) -> None:
    exponents, shown = UNITS[unit]
    inside = Xml.SubElement(units, "Unit", name=unit)
    Xml.SubElement(inside, "BaseUnit", {base: str(power) for base, power in exponents.items()})
    if shown:
        Xml.SubElement(inside, "DisplayUnit", name=shown[0], factor=repr(shown[1]))


def _variable(listed: Xml.Element, k: int, variable: Variable) -> None:
    output, varies = variable.kind == "output", "discrete" if variable.flag else "continuous"
    about = {
        "name": variable.name, "valueReference": str(k), "description": variable.meaning, "causality": variable.kind,
        "variability": "fixed" if variable.kind == "parameter" else varies,
    }  # fmt: skip
    if variable.kind != "input":
        about["initial"] = "calculated" if output else "exact"
    scalar = Xml.SubElement(listed, "ScalarVariable", about)
    start = {} if output else {"start": str(variable.start).lower() if variable.flag else repr(variable.start)}
    if variable.flag:
        Xml.SubElement(scalar, "Boolean", start)
        return
    shown = UNITS[variable.unit][1] if variable.unit else None
    unit = {"unit": variable.unit} if variable.unit else {}
    Xml.SubElement(scalar, "Real", unit | ({"displayUnit": shown[0]} if shown else {}) | start)


def in_c(variables: Sequence[Variable]) -> str:
    """The same variables in C: their numbers, kinds and starts."""
    names = ", ".join(variable.name for variable in variables)
    kinds = ", ".join(variable.kind.upper() + (" | FLAG" if variable.flag else "") for variable in variables)
    starts = ", ".join(repr(float(variable.start or 0.0)) for variable in variables)
    return (
        f"enum {{ {names}, COUNT }};\n"
        f"static const int KIND[COUNT] = {{{kinds}}};\n"
        f"static const double START[COUNT] = {{{starts}}};\n"
    )

"""What an FMU says of itself: modelDescription.xml of FMI 2.0 or 3.0, and its variables in C."""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree as Xml

from mckibben.exports.fmuvariables import Variable

__all__ = ["MAIN", "build_description", "description", "in_c"]

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
MAIN = {2: "fmi2.c", 3: "fmi3.c"}
"""The file to compile, by the version of FMI."""


def description(variables: Sequence[Variable], name: str, guid: str, meaning: str, version: str, fmi: int) -> str:
    """The text of modelDescription.xml for FMI 2.0 (`fmi` 2) or 3.0 (3)."""
    root = Xml.Element("fmiModelDescription", {
        "fmiVersion": f"{fmi}.0", "modelName": name, "guid" if fmi == 2 else "instantiationToken": guid,
        "description": meaning, "generationTool": f"mckibben {version}", "variableNamingConvention": "flat",
    })  # fmt: skip
    able = {"modelIdentifier": name, "canHandleVariableCommunicationStepSize": "true"}
    if fmi == 2:
        able |= {"canNotUseMemoryManagementFunctions": "true", "canGetAndSetFMUstate": "true"}
        model = Xml.SubElement(root, "CoSimulation", able)
        Xml.SubElement(Xml.SubElement(model, "SourceFiles"), "File", name=MAIN[fmi])
    else:
        Xml.SubElement(root, "CoSimulation", able | {"canGetAndSetFMUState": "true"})
    units = Xml.SubElement(root, "UnitDefinitions")
    for unit in dict.fromkeys(variable.unit for variable in variables if variable.unit):
        _unit(units, unit)
    Xml.SubElement(root, "DefaultExperiment", startTime="0", stopTime="1", stepSize=str(STEP))
    listed = Xml.SubElement(root, "ModelVariables")
    for k, variable in enumerate(variables):
        _variable(listed, k, variable, fmi)
    if fmi == 3:
        Xml.SubElement(listed, "Float64", name="time", valueReference=str(len(variables)), causality="independent",
                       variability="continuous", description="time")  # fmt: skip
    structure = Xml.SubElement(root, "ModelStructure")
    outputs = [k for k, variable in enumerate(variables) if variable.kind == "output"]
    for group, single in (("Outputs", "Output"), ("InitialUnknowns", "InitialUnknown")):
        if fmi == 2:
            inside = Xml.SubElement(structure, group)
            for k in outputs:
                Xml.SubElement(inside, "Unknown", index=str(k + 1))
        else:
            for k in outputs:
                Xml.SubElement(structure, single, valueReference=str(k))
    return _text(root)


def build_description(name: str) -> str:
    """The text of buildDescription.xml, which FMI 3.0 has beside the source."""
    root = Xml.Element("fmiBuildDescription", fmiVersion="3.0")
    how = Xml.SubElement(root, "BuildConfiguration", modelIdentifier=name)
    Xml.SubElement(Xml.SubElement(how, "SourceFileSet", language="C99"), "SourceFile", name=MAIN[3])
    return _text(root)


def _text(root: Xml.Element) -> str:
    Xml.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + Xml.tostring(root, encoding="unicode") + "\n"


def _unit(units: Xml.Element, unit: str) -> None:
    exponents, shown = UNITS[unit]
    inside = Xml.SubElement(units, "Unit", name=unit)
    Xml.SubElement(inside, "BaseUnit", {base: str(power) for base, power in exponents.items()})
    if shown:
        Xml.SubElement(inside, "DisplayUnit", name=shown[0], factor=repr(shown[1]))


def _variable(listed: Xml.Element, k: int, variable: Variable, fmi: int) -> None:
    output, varies = variable.kind == "output", "discrete" if variable.flag else "continuous"
    about = {
        "name": variable.name, "valueReference": str(k), "description": variable.meaning, "causality": variable.kind,
        "variability": "fixed" if variable.kind == "parameter" else varies,
    }  # fmt: skip
    if variable.kind != "input":
        about["initial"] = "calculated" if output else "exact"
    shown = UNITS[variable.unit][1] if variable.unit else None
    kind = ({"unit": variable.unit} if variable.unit else {}) | ({"displayUnit": shown[0]} if shown else {})
    kind |= {} if output else {"start": str(variable.start).lower() if variable.flag else repr(variable.start)}
    if fmi == 3:
        Xml.SubElement(listed, "Boolean" if variable.flag else "Float64", about | kind)
    else:
        scalar = Xml.SubElement(listed, "ScalarVariable", about)
        Xml.SubElement(scalar, "Boolean" if variable.flag else "Real", kind)


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

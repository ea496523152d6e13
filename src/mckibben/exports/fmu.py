"""A map as an FMU for co-simulation (FMI 2.0 or 3.0): its source in C, compiled here, with what describes it."""

from __future__ import annotations

import hashlib
import html
import io
import zipfile
from importlib.resources import files

from mckibben.exports.compiler import compiled, library_place
from mckibben.exports.fmudescription import MAIN, build_description, description, in_c
from mckibben.exports.fmuvariables import muscle_variables, rig_variables
from mckibben.potential.c_source import check_name
from mckibben.potential.chart import Chart

__all__ = ["as_fmu", "sources"]

DATE = (1980, 1, 1, 0, 0, 0)
"""Of every file inside, so that equal maps are equal files; ZIP knows none before."""


def as_fmu(chart: Chart, name: str, mass: float | None = None, fmi: int = 2) -> bytes:
    """The FMU (FMI 2.0, or 3.0 for `fmi` 3) of a muscle alone; with `mass` [kg] of one with a mass and a valve.

    SpecError without a C compiler.
    """
    described, written = sources(chart, name, mass, fmi)
    folder, ending = library_place(fmi)
    library = compiled(written, MAIN[fmi])
    notes = "\n".join(html.escape(line) for line in chart.told)
    page = f"<!DOCTYPE html>\n<html><head><meta charset='utf-8'><title>{name}</title></head>\n<body><pre>{notes}</pre>"
    held: dict[str, str | bytes] = {
        "modelDescription.xml": described,
        "documentation/index.html": page + "</body></html>\n",
        **{f"sources/{file}": text for file, text in written.items()},
        f"binaries/{folder}/{name}{ending}": library,
    }
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        for file, data in held.items():
            entry = zipfile.ZipInfo(file, DATE)
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            archive.writestr(entry, data)
    return content.getvalue()


def sources(chart: Chart, name: str, mass: float | None = None, fmi: int = 2) -> tuple[str, dict[str, str]]:
    """The description, and the files of the source in C."""
    check_name(name, "export.name")
    first, last = (float(end) for end in chart.pressures)
    middle = 0.5 * sum(float(end) for end in chart.lengths(first))
    rubs = mass is None and chart.rubs is not None
    variables = muscle_variables(middle, first, rubs) if mass is None else rig_variables(mass, (first, last))
    meaning = f"{'a muscle' if mass is None else 'a muscle with a mass and a valve'}: {chart.told[1]}; {chart.told[2]}"
    body = "fmu_muscle.c" if mass is None else "fmu_rig.c"
    inside = files("mckibben.exports")
    defined = ("#define RUBS\n" if rubs else "") + f"#define RUBBER {chart.rubber_inside!r}"
    written = {
        **{file: (inside / file).read_text(encoding="utf-8") for file in (MAIN[fmi], "fmu.h")},
        "muscle.h": chart.to_c(),
        "model.h": f'#include "muscle.h"\n\n{defined}\n{in_c(variables)}\n'
        + (inside / body).read_text(encoding="utf-8"),
    }
    version = str(chart.data.attrs["mckibben_version"])
    guid = hashlib.sha256("".join((name, version, meaning, *written.values())).encode()).hexdigest()[:32]
    written["model.h"] = f'#define MODEL_GUID "{guid}"\n' + written["model.h"]
    if fmi == 3:
        written["buildDescription.xml"] = build_description(name)
    return description(variables, name, guid, meaning, version, fmi), written

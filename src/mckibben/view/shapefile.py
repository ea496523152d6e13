"""`save_shape()`: the shape of a state for other programs: ParaView, the web, CAD."""

from __future__ import annotations

import json
import struct
import tempfile
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from mckibben import disk
from mckibben.results.result import Result
from mckibben.results.variables import FIELDS, has
from mckibben.spec.errors import SpecError
from mckibben.view.appearance import Appearance, the_result, the_state
from mckibben.view.braid3d import Body
from mckibben.view.mesh import Mesh, solid
from mckibben.view.projection import MM
from mckibben.view.render import library

__all__ = ["ENDINGS", "UNITS", "save_shape"]

ENDINGS = {".vtp": "ParaView, in m", ".glb": "the web, in m", ".stl": "CAD, the outer shape in mm"}
UNITS = {".vtp": "m, fields in SI units", ".glb": "m", ".stl": "mm"}
"""In what a file's lengths are: glTF is in m by its definition, VTP is because its fields are in SI units."""
_PLAIN = {"fibres": (0.24, 0.28, 0.32), "chamber": (0.87, 0.88, 0.89), "fittings": (0.6, 0.63, 0.66)}


def save_shape(
    result: Any, path: str | PathLike[str], state: int | None = None, *, colour: str | None = "fibre_tension",
    force: bool = False,
) -> Path:  # fmt: skip
    """Write the shape of one state for another program; the ending of the file's name says for which.

    - .vtp for ParaView, in m: fibres, chamber and fittings (`part` 0, 1, 2) with every variable along the muscle, in SI
      units, at their points. It takes PyVista: pip install "mckibben[view]".
    - .glb for the web (glTF), in m: fibres, chamber and fittings, the fibres or the chamber coloured.
    - .stl for CAD, in mm: the closed outer shape, a body of revolution around the outside of the fibres with flat ends,
      without fittings.

    Args:
        result: what `run`, `solve` or `load` gave.
        path: the file. It is written whole or not at all.
        state: number of the state, from 0, or from the end -1, -2, ...; the last that was reached where left out.
        colour: variable that colours a .glb, as of `scene`.
        force: replace a file that is there already.

    Returns:
        The path of the file.

    Raises:
        SpecError: for a state that was not reached, another ending, an unknown colour, a file that exists (without
            `force`) or cannot be written, or PyVista missing for a .vtp.

    >>> state = mk.solve(mk.presets.paper(), length="115 mm", pressure="1 bar")
    >>> mk.save_shape(state, "muscle.stl").name
    'muscle.stl'
    """
    ending = Path(path).suffix.lower()
    if ending not in ENDINGS:
        known = " or ".join(f"{name} ({meaning})" for name, meaning in ENDINGS.items())
        raise SpecError(str(path), allowed=f"must end in {known}")
    shape = the_result("save_shape", result)
    look = Appearance.of("save_shape", shape, colour, False, False, False, "horizontal", 0.0, 0.0, 1.0, None)
    number = the_state("save_shape", shape, state)
    disk.check_target(path, force)
    body = look.body(shape, number)
    if ending == ".stl":
        made = stl(solid(body.tube.shifted(body.diameter)))
    elif ending == ".glb":
        made = glb(_parts(body), _colours(shape, number, look, body))
    else:
        made = _vtp(str(path), shape, number, body)
    return disk.write(path, made, force)


def _parts(body: Body) -> dict[str, Mesh]:
    chamber = body.chamber()
    return {"fibres": body.fibre_pipes()} | ({} if chamber is None else {"chamber": chamber}) | {
        "fittings": body.fittings()
    }  # fmt: skip


def stl(mesh: Mesh) -> bytes:
    """A binary STL in mm, of a mesh in m."""
    corners = (mesh.points * MM).astype("<f4")[mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    rows = np.zeros(len(corners), np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("end", "<u2")]))
    rows["normal"], rows["corners"] = normals, corners
    return b"McKibben muscle, outer shape, unit: mm".ljust(80) + struct.pack("<I", len(rows)) + rows.tobytes()


def _colours(result: Result, state: int, look: Appearance, body: Body) -> dict[str, Any]:
    """The colours of parts that a field colours, (points, 3) or rather a function of v."""
    values = look.values(result, state)
    if values is None:
        return {}
    low, high = look.limits(result, [state])
    on_chamber = look.on_chamber(result)
    scale = look.map(result)

    def of(v: Any) -> Any:
        return scale((np.interp(v, body.tube.v, values) - low) / (high - low))[:, :3]

    return {"chamber" if on_chamber else "fibres": of}


def glb(parts: dict[str, Mesh], colours: dict[str, Any]) -> bytes:
    """A binary glTF 2.0: one node a part, with normals and colours at the points; y is up and x along the muscle."""
    turn = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    views: list[dict[str, Any]] = []
    accessors: list[dict[str, Any]] = []
    meshes: list[dict[str, Any]] = []
    content = bytearray()

    def add(array: Any, kind: str, component: int, target: int, **more: Any) -> int:
        views.append({"buffer": 0, "byteOffset": len(content), "byteLength": array.nbytes, "target": target})
        content.extend(array.tobytes())
        count = array.size if kind == "SCALAR" else len(array)
        entry = {"bufferView": len(views) - 1, "componentType": component, "count": count, "type": kind}
        accessors.append(entry | more)
        return len(accessors) - 1

    for name, mesh in parts.items():
        points = (mesh.points @ turn.T).astype("<f4")
        bounds = {"min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist()}
        plain = np.broadcast_to(_PLAIN.get(name, (0.5, 0.5, 0.5)), mesh.points.shape)
        shade = colours[name](mesh.v) if name in colours else plain
        linear = np.where(shade <= 0.04045, shade / 12.92, ((shade + 0.055) / 1.055) ** 2.4)  # glTF's are linear
        rgba = np.full((len(linear), 4), 255, np.uint8)
        rgba[:, :3] = np.round(255.0 * linear)
        attributes = {
            "POSITION": add(points, "VEC3", 5126, 34962, **bounds),
            "NORMAL": add((mesh.normals @ turn.T).astype("<f4"), "VEC3", 5126, 34962),
            "COLOR_0": add(rgba, "VEC4", 5121, 34962, normalized=True),
        }
        indices = add(mesh.faces.astype("<u4"), "SCALAR", 5125, 34963)
        primitive = {"attributes": attributes, "indices": indices, "material": 0}
        meshes.append({"name": name, "primitives": [primitive]})
    surface = {"baseColorFactor": [1.0, 1.0, 1.0, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.6}
    told = {
        "asset": {"version": "2.0", "generator": "mckibben"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(meshes)))}],
        "nodes": [{"mesh": number, "name": mesh["name"]} for number, mesh in enumerate(meshes)],
        "meshes": meshes,
        "materials": [{"pbrMetallicRoughness": surface, "doubleSided": True}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(content)}],
    }
    text = json.dumps(told, separators=(",", ":")).encode()
    chunks = ((b"JSON", text + b" " * (-len(text) % 4)), (b"BIN\0", bytes(content) + b"\0" * (-len(content) % 4)))
    body = b"".join(struct.pack("<I", len(data)) + kind + data for kind, data in chunks)
    return b"glTF" + struct.pack("<II", 2, 12 + len(body)) + body


def _vtp(name: str, result: Result, state: int, body: Body) -> bytes:
    """A VTK XML file of all parts with all fields."""
    library(name)
    from mckibben.view.stage import poly_data

    parts = _parts(body)
    numbers = {"fibres": 0, "chamber": 1, "fittings": 2}
    whole = Mesh.joined(list(parts.values()))
    made = poly_data(whole, 1.0)
    made.point_data["part"] = np.concatenate(
        [np.full(len(mesh.points), numbers[part], np.int32) for part, mesh in parts.items()]
    )
    for field, (unit, _) in FIELDS.items():
        if has(result.muscle, field):
            made.point_data[field] = np.interp(whole.v, body.tube.v, result.column(field)[state])
            made.field_data[f"unit of {field}"] = [unit]
    for total in ("length", "pressure", "force"):
        made.field_data[total] = [float(result.column(total)[state])]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "out.vtp"
        made.save(path)
        return path.read_bytes()

"""Reading a rig file (TOML): the rig, and how long and how finely to simulate it."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import attrs

from mckibben.files.case import read_mapping
from mckibben.spec.declared import describe
from mckibben.spec.errors import SpecError, nearest
from mckibben.spec.merge import apply_overrides
from mckibben.spec.rig import Rig
from mckibben.spec.rigtext import rig_from_mapping
from mckibben.spec.series import Series

__all__ = ["RigFile", "read_rig", "read_signal"]

OPTIONS = ("until", "points", "tolerance", "method")
"""What a rig file may say beside the rig, as `simulate` takes it."""


@attrs.frozen
class RigFile:
    """What a rig file says: the rig, and the options of `simulate`."""

    rig: Rig
    options: dict[str, Any]


def read_rig(path: str | PathLike[str], overrides: Iterable[str] = ()) -> RigFile:
    """The rig in a file (TOML), and how it is to be simulated.

    The tables are the fields of `Rig`: [muscle], [load], [supply], [valve], [command] and so on, each of several kinds
    with its `kind`. Beside them stand `until`, `points`, `tolerance` and `method`. A signal may stand in a CSV file:
    kind = "csv" and file = "signal.csv", from the folder of the rig file.

    Args:
        path: the file.
        overrides: changes that are made before it is read, each "dotted.name=value": "load.mass=3 kg", "until=2 s".

    Returns:
        A RigFile with `rig` and `options`: `mk.simulate(found.rig, **found.options)`.

    Raises:
        SpecError: for a file that cannot be read or is not TOML, and for whatever is wrong in it, in one line.

    >>> from pathlib import Path
    >>> text = 'until = "1 s"\\ncommand = 1.0\\n[muscle]\\npreset = "paper"\\n'
    >>> text += '[load]\\nkind = "fixed"\\nlength = "0.1 m"\\n'
    >>> text += '[supply]\\ngauge = "2 bar"\\n[valve]\\nC = "0.02 L/s/bar"\\n'
    >>> written = Path("rig.toml").write_text(text)
    >>> found = mk.read_rig("rig.toml", ["load.length=90 mm"])
    >>> found.rig.load.length, found.options["until"]
    (0.09, '1 s')
    """
    mapping = read_mapping(path)
    known = (*(item.name for item in describe(Rig)), *OPTIONS)
    mapping = apply_overrides({"rig": mapping}, [f"rig.{text}" for text in overrides], ("rig",))["rig"]
    options = {name: mapping.pop(name) for name in OPTIONS if name in mapping}
    for key in mapping:
        if key not in known:
            raise SpecError(str(key), allowed="unknown key", advice=nearest(str(key), known))
    if "until" not in options:
        raise SpecError("until", allowed="is missing: how long to simulate", advice='write until = "2 s" at the top')
    return RigFile(rig_from_mapping(_with_series(mapping, Path(path).parent)), options)


def _with_series(mapping: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """The mapping with signals of CSV files in place of their names."""
    made: dict[str, Any] = {}
    for key, value in mapping.items():
        if isinstance(value, Mapping) and value.get("kind") == "csv":
            for one in value:
                if one not in ("kind", "file", "between"):
                    raise SpecError(f"{key}.{one}", allowed="unknown key", advice="a csv signal has file and between")
            if "file" not in value:
                raise SpecError(f"{key}.file", allowed="is missing", advice='such as file = "signal.csv"')
            read = read_signal(folder / str(value["file"]), between=str(value.get("between", "line")))
            pairs = {"time": list(read.time), "value": list(read.value)}
            made[key] = {"kind": "series", "between": str(read.between), **pairs}
        else:
            made[key] = _with_series(value, folder) if isinstance(value, Mapping) else value
    return made


def read_signal(path: str | PathLike[str], between: str = "line") -> Series:
    """A signal from a CSV file: its first column is the time in seconds, the second one the value.

    A first line of words is skipped. Values are SI where they have no unit.

    Args:
        path: the file.
        between: "line" for straight lines between the times, "hold" for values that stay until the next.

    Returns:
        A `Series`.

    Raises:
        SpecError: for a file that cannot be read, or a line without two numbers.

    >>> from pathlib import Path
    >>> written = Path("signal.csv").write_text("t [s],command\\n0,0\\n1,1\\n")
    >>> mk.read_signal("signal.csv")(0.25)
    0.25
    """
    name = str(path)
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except FileNotFoundError as error:
        raise SpecError(name, allowed="there is no such file") from error
    except (OSError, UnicodeDecodeError, ValueError) as error:
        raise SpecError(name, allowed="cannot be read as text") from error
    lines = text.splitlines()
    mark = ";" if lines and ";" in lines[-1] else "\t" if lines and "\t" in lines[-1] else ","
    times: list[float] = []
    values: list[float] = []
    for number, row in enumerate(csv.reader(lines, delimiter=mark), 1):
        if not [cell for cell in row if cell.strip()]:
            continue
        try:
            times.append(float(row[0]))
            values.append(float(row[1]))
        except (ValueError, IndexError) as error:
            if not times and number == 1:
                continue
            said = f"line {number} does not begin with two numbers: {mark.join(row)}"
            raise SpecError(name, allowed=said, advice="write the time in s and the value") from error
    if not times:
        raise SpecError(name, allowed="holds no numbers")
    return Series(time=times, value=values, between=between)

"""Reading a case file (TOML): a muscle and a test."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from mckibben.spec.errors import SpecError
from mckibben.spec.merge import check_depth, too_deep
from mckibben.spec.text import Case, apply_overrides, from_mapping

__all__ = ["dotted", "read_case", "read_mapping"]

_DEEP = re.compile(r"""(?:[\w"'-]{1,40}[ \t]*\.[ \t]*){100}""")
"""A hundred names joined by dots."""


def read_case(path: str | PathLike[str], overrides: Iterable[str] = (), *, test_required: bool = True) -> Case:
    """The muscle and the test in a case file (TOML).

    Args:
        path: the file.
        overrides: changes that are made before the case is read, each "dotted.name=value": "braid.angle=36 deg",
            "test.points=41". Names are the muscle's unless they begin with "test.".
        test_required: whether a file without a [test] table is an error.

    Returns:
        A Case with `muscle` and `test`; `test` is None if there is none. Numbers are in SI units.

    Raises:
        SpecError: for a file that cannot be read or is not TOML, and for whatever is wrong in it, in one line.

    >>> from pathlib import Path
    >>> text = '[muscle]\\npreset = "paper"\\n[test]\\nkind = "free-contraction"\\npressure = "0 to 1 bar"\\n'
    >>> written = Path("case.toml").write_text(text)
    >>> case = mk.read_case("case.toml", ["braid.angle=36 deg"])
    >>> case.muscle.name, case.test.points
    ('paper (changed)', 21)
    """
    mapping = read_mapping(path)
    if "sweep" in mapping:
        raise SpecError(str(path), allowed="describes a sweep", advice="give it to mckibben sweep")
    if "free" in mapping:
        what = "design" if "objective" in mapping else "fit"
        raise SpecError(str(path), allowed=f"describes a {what}", advice=f"give it to mckibben {what}")
    if "tolerances" in mapping:
        raise SpecError(str(path), allowed="describes tolerances", advice="give it to mckibben tolerances")
    return from_mapping(apply_overrides(mapping, overrides), test_required=test_required)


def read_mapping(path: str | PathLike[str]) -> dict[str, Any]:
    """What the TOML file at `path` says. SpecError, in one line, for a file that cannot be read or is not TOML."""
    name = str(path)
    try:
        text = Path(path).read_bytes().decode("utf-8-sig")  # some editors put a mark before the text
        if _DEEP.search(text):  # whose reading takes as long as its length squared
            raise too_deep(name)
        mapping = tomllib.loads(text)
    except SpecError:
        raise
    except FileNotFoundError as error:
        raise SpecError(name, allowed="there is no such file") from error
    except OSError as error:
        raise SpecError(name, allowed=f"cannot be read: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        said = f"is not UTF-8 text (byte {error.start})"
        raise SpecError(name, allowed=said, advice="save the file as UTF-8") from error
    except tomllib.TOMLDecodeError as error:  # its message ends in the line and column
        raise SpecError(name, allowed=f"is not valid TOML: {error}", advice=_habit(text, str(error))) from error
    except (RecursionError, ValueError) as error:  # brackets without end; a path with a null character
        raise SpecError(name, allowed="cannot be read") from error
    check_depth(mapping, name)
    return mapping


def dotted(table: Mapping[str, Any], whole: str | None = None, prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Values by their dotted names, also where the dots were not quoted and TOML has made tables of them.

    A table with the key `whole` is a value itself.
    """
    for key, value in table.items():
        if isinstance(value, Mapping) and whole not in value:
            yield from dotted(value, whole, f"{prefix}{key}.")
        else:
            yield prefix + key, value


def _habit(text: str, said: str) -> str:
    """Advice on a line that is not TOML, where it is another language's way to write one."""
    found = re.search(r"at line (\d+)", said)
    lines = text.splitlines()
    line = lines[int(found[1]) - 1] if found and 0 < int(found[1]) <= len(lines) else ""
    if line.partition("#")[0].rstrip().endswith(";"):
        return 'a line of TOML ends without ";"'
    if re.search(r"=\s*[+-]?\d+,\d", line):
        return 'write a decimal point, "12.5 mm"'
    return ""

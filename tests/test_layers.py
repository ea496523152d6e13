"""The imports of the package against docs/architecture.md, which says all there is to enforce: see the top of the page.

Imports in functions and under TYPE_CHECKING count too. Only `mckibben/__init__.py` is exempt: it is the public face.
"""

import ast
import re
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

pytestmark = pytest.mark.docs

ROOT = Path(__file__).parent.parent
PAGE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
SOURCE = ROOT / "src" / "mckibben"


def tables(page: str) -> tuple[list[str], dict[str, list[str]]]:
    """What the page lists, in order (files, and rooms as "spec/"), and what some rooms see only."""
    listed: list[str] = []
    promised: dict[str, list[str]] = {}
    promises = False
    for line in page.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")] if line.startswith("|") else []
        if len(cells) < 2:
            continue
        name = re.fullmatch(r"`([\w/]+(?:/|\.py))`", cells[0])
        if cells[0] in ("room", "module"):
            promises = cells[1] == "sees only"
        elif name and promises:
            promised[name[1]] = re.findall(r"`([^`]+)`", cells[1])
        elif name:
            listed.append(name[1])
    return listed, promised


def room_of(file: str) -> str:
    """The folder of a file ("spec/"), or the file itself where it lies beside the folders."""
    return f"{file.partition('/')[0]}/" if "/" in file else file


def imports(file: Path, source: Path) -> Iterator[tuple[int, str | None]]:
    """(line, imported file relative to the package) of every import of the package's own; None where it is relative."""

    def resolve(dotted: str) -> str | None:
        parts = dotted.split(".")
        if parts[0] != source.name:
            return None
        target = source.joinpath(*parts[1:])
        for candidate in (target / "__init__.py", target.with_suffix(".py")):
            if candidate.is_file():
                return candidate.relative_to(source).as_posix()
        return None

    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        names: list[str | None] = []
        if isinstance(node, ast.Import):
            names = [resolve(alias.name) or "" for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            # `from package import name`: the submodule of that name, else something that the package's __init__ holds
            names = [resolve(f"{base}.{alias.name}") or resolve(base) or "" for alias in node.names]
            names = [None] if node.level else names
        elif isinstance(node, ast.Call) and node.args and isinstance(node.args[0], ast.Constant):
            called = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", None)
            name = node.args[0].value
            if called in ("import_module", "__import__") and isinstance(name, str):
                names = [None if name.startswith(".") else resolve(name) or ""]
        yield from ((node.lineno, name) for name in names if name != "")  # type: ignore[attr-defined]


def circle(graph: dict[str, set[str]]) -> str | None:
    """A circle in a graph, as text."""
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return " -> ".join(reversed(error.args[1]))
    return None


def violations(source: Path, page: str) -> list[str]:
    """Everything in the package that the page forbids, one sentence each."""
    listed, promised = tables(page)
    order = {room: place for place, room in enumerate(dict.fromkeys(room_of(name) for name in listed))}
    files: dict[str, set[str]] = {}
    rooms: dict[str, set[str]] = {}
    wrong = [f"{name}: is listed twice" for name in sorted(set(listed)) if listed.count(name) > 1]
    wrong += [f"{name}: is listed and does not exist" for name in listed if not (source / name).exists()]
    wrong += [f"{room}: its promise is of no room" for room in promised if room not in order]
    for place, room in enumerate([room_of(name) for name in listed][1:]):
        if order[room] < order[room_of(listed[place])]:
            wrong.append(f"{listed[place + 1]}: is listed apart from its room")
    for file in sorted(source.rglob("*.py")):
        name = file.relative_to(source).as_posix()
        if name == "__init__.py":
            continue
        room = room_of(name)
        if name not in listed and not (name.endswith("/__init__.py") and room in order):
            wrong.append(f"{name}: not in the table of docs/architecture.md")
            continue
        for line, target in imports(file, source):
            here = f"{name}:{line}"
            if target is None:
                wrong.append(f"{here} is a relative import")
                continue
            if target == "__init__.py":
                wrong.append(f"{here} imports from the public face, mckibben/__init__.py")
                continue
            files.setdefault(name, set()).add(target)
            other = room_of(target)
            if other == room:
                continue
            rooms.setdefault(room, set()).add(other)
            if order.get(other, -1) > order[room]:
                wrong.append(f"{here} imports {target}, whose room is below its own")
            if room in promised and not {other, target} & set(promised[room]):
                wrong.append(f"{here} imports {target}, but {room} sees only {', '.join(promised[room]) or 'itself'}")
    for what, graph in (("files", files), ("rooms", rooms)):
        found = circle(graph)
        if found:
            wrong.append(f"circle of {what}: {found}")
    return wrong


def test_the_package_is_as_the_page_says() -> None:
    found = violations(SOURCE, PAGE)
    assert not found, "\n".join(found)


def test_the_page_is_read() -> None:
    listed, promised = tables(PAGE)
    assert {"units.py", "spec/", "spec/muscle.py", "app/cli.py"} <= set(listed)
    assert promised["units.py"] == []
    assert promised["spec/"] == ["units.py", "shown.py"]


# The checker itself, on a small house with one fault planted at a time.

SMALL = """
| module | one concept |
|---|---|
| `units.py` | |
| `spec/` | |
| `spec/errors.py` | |
| `spec/muscle.py` | |
| `solver/` | |
| `solver/newton.py` | |
| `solver/path.py` | |
| `results/` | |
| `results/result.py` | |
| `study/` | |
| `study/sweep.py` | |
| `view/` | |
| `view/plots.py` | |

| room | sees only |
|---|---|
| `units.py` | nothing |
| `view/` | `results/`, `spec/errors.py` |
"""
SOUND = {
    "__init__.py": "from mckibben.view.plots import plot",
    "units.py": "import math",
    "spec/__init__.py": "from mckibben.spec.errors import SpecError\nfrom mckibben.spec.muscle import Muscle",
    "spec/errors.py": "from mckibben.units import parse",
    "spec/muscle.py": "from mckibben.spec import errors\nfrom mckibben.units import parse",
    "solver/__init__.py": "from mckibben.solver.path import follow",
    "solver/newton.py": "from mckibben import spec",
    "solver/path.py": "from mckibben.solver.newton import solve",
    "results/result.py": "import mckibben.solver.newton",
    "study/sweep.py": "from mckibben.results.result import Result",
    "view/plots.py": "from mckibben.results.result import Result\nfrom mckibben.spec.errors import SpecError",
}


def small_house(folder: Path, changed: dict[str, str]) -> Path:
    source = folder / "mckibben"
    for name, content in {**SOUND, **changed}.items():
        (source / name).parent.mkdir(parents=True, exist_ok=True)
        (source / name).write_text(content, encoding="utf-8")
    return source


BELOW = "whose room is below"


@pytest.mark.parametrize(
    ("file", "text", "complaint"),
    [
        ("units.py", "", None),
        ("spec/errors.py", "from mckibben.solver import newton", BELOW),
        ("spec/errors.py", "import mckibben.results.result as r", BELOW),
        ("solver/newton.py", "def f():\n    from mckibben.results.result import Result", "solver/newton.py:2 imports"),
        ("solver/newton.py", "import importlib\nimportlib.import_module('mckibben.results.result')", BELOW),
        ("units.py", "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from mckibben import spec", BELOW),
        ("spec/errors.py", "from mckibben.view.plots import plot", "circle of rooms"),
        ("results/result.py", "def f():\n    from mckibben.view import plots", "circle of rooms: "),
        ("solver/newton.py", "from mckibben.solver.path import follow", "circle of files"),
        ("solver/newton.py", "from mckibben.solver import follow", "circle of files"),
        ("spec/errors.py", "def f():\n    from mckibben.spec.muscle import Muscle", "circle of files"),
        ("view/plots.py", "from mckibben.solver import newton", "view/ sees only results/, spec/errors.py"),
        ("view/plots.py", "from mckibben.spec.muscle import Muscle", "view/ sees only"),
        ("view/plots.py", "def f():\n    import mckibben.study.sweep", "view/plots.py:2 imports study/sweep.py, but"),
        ("view/plots.py", "if TYPE_CHECKING:\n    from mckibben.solver.path import follow", "view/ sees only"),
        ("units.py", "from mckibben.spec.errors import SpecError", "units.py sees only itself"),
        ("spec/muscle.py", "from . import errors", "is a relative import"),
        ("spec/muscle.py", "def f():\n    from ..units import parse", "spec/muscle.py:2 is a relative import"),
        ("study/sweep.py", "from importlib import import_module\nimport_module('..units', __package__)", "relative"),
        ("solver/newton.py", "from mckibben import plot", "public face"),
        ("helpers.py", "", "helpers.py: not in the table"),
        ("spec/extra.py", "", "spec/extra.py: not in the table"),
        ("extra/__init__.py", "", "extra/__init__.py: not in the table"),
    ],
)
def test_the_checker_sees(tmp_path: Path, file: str, text: str, complaint: str | None) -> None:
    found = violations(small_house(tmp_path, {file: text}), SMALL)
    if complaint is None:
        assert found == []
    else:
        assert any(complaint in sentence for sentence in found), found


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ("| `spec/gone.py` | |", "spec/gone.py: is listed and does not exist"),
        ("| `units.py` | |", "units.py: is listed twice"),
        ("| `spec/__init__.py` | |", "spec/__init__.py: is listed apart from its room"),
        ("\n| room | sees only |\n|---|---|\n| `gone/` | nothing |", "gone/: its promise is of no room"),
    ],
)
def test_the_checker_sees_what_is_wrong_with_the_page(tmp_path: Path, line: str, complaint: str) -> None:
    page = SMALL.replace("\n\n| room", f"\n{line}\n\n| room")
    assert complaint in violations(small_house(tmp_path, {}), page)


def test_every_check_has_a_marker() -> None:
    declared = (ROOT / "pyproject.toml").read_text(encoding="utf-8").partition("\nmarkers = [")[2].partition("\n]")[0]
    marks = "|".join(re.findall(r'^    "(\w+): ', declared, re.MULTILINE))
    assert marks.count("|") > 20
    for file in sorted((ROOT / "tests").glob("test_*.py")):
        text = file.read_text(encoding="utf-8")
        whole = re.search(rf"^pytestmark = \[?\s*pytest\.mark\.(?:{marks})\b", text, re.MULTILINE)
        single = len(re.findall(rf"^@pytest\.mark\.(?:{marks})\b", text, re.MULTILINE))
        assert whole or single == len(re.findall(r"^def test_", text, re.MULTILINE)), file.name

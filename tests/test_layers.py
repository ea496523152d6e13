"""The imports of the package against the map in docs/architecture.md.

A module imports only from lower layers and from what is listed above it in its own layer. Folders named in one row are
siblings and import nothing from each other; inside such a folder any order goes that has no cycle. Imports in functions
and under TYPE_CHECKING count too. Only `mckibben/__init__.py` is exempt: it is the public face, and nothing inside the
package imports from it.
"""

import ast
import re
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).parent.parent
MAP = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
SOURCE = ROOT / "src" / "mckibben"


class Place(NamedTuple):
    """Where the map puts a module."""

    layer: int
    row: int  # order of listing
    entry: int  # order within the row
    name: str  # as listed: "spec/muscle.py" or a whole folder, "solver/"


def places(page: str) -> list[Place]:
    """Entries of the page's table, in order: rows that start with a layer number, modules named in the second cell."""
    rows = re.findall(r"^\|\s*(\d+)\s*\|([^|]*)\|", page, re.MULTILINE)
    return [
        Place(int(layer), row, entry, name)
        for row, (layer, cell) in enumerate(rows)
        for entry, name in enumerate(re.findall(r"`([^`]+)`", cell))
    ]


def place_of(file: str, table: list[Place]) -> Place | None:
    """Place of a file given relative to the package. A folder's `__init__.py` follows the folder's last listed file."""
    exact = [p for p in table if p.name == file]
    folders = [p for p in table if p.name.endswith("/") and file.startswith(p.name)]
    inside = [p for p in table if file.endswith("/__init__.py") and p.name.startswith(file.removesuffix("__init__.py"))]
    if exact or folders:
        return (exact or folders)[0]
    if inside:
        last = inside[-1]
        return Place(last.layer, last.row, last.entry + 1, file)
    return None


def imports(file: Path, source: Path) -> list[tuple[int, str]]:
    """(line, imported file relative to the package) of every import of the package's own modules in a file."""

    def resolve(dotted: str) -> str | None:
        parts = dotted.split(".")
        if parts[0] != source.name:
            return None
        target = source.joinpath(*parts[1:])
        for candidate in (target / "__init__.py", target.with_suffix(".py")):
            if candidate.is_file():
                return candidate.relative_to(source).as_posix()
        return None

    package = [source.name, *file.relative_to(source).parent.parts]
    found: list[tuple[int, str | None]] = []
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found += [(node.lineno, resolve(alias.name)) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            base = ".".join([*base, *(node.module or "").split(".")]).rstrip(".")
            # `from package import name`: the submodule of that name, else something that the package's __init__ holds
            found += [(node.lineno, resolve(f"{base}.{alias.name}") or resolve(base)) for alias in node.names]
        elif isinstance(node, ast.Call) and node.args and isinstance(node.args[0], ast.Constant):
            called = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", None)
            if called in ("import_module", "__import__") and isinstance(node.args[0].value, str):
                name = node.args[0].value
                depth = len(name) - len(name.lstrip("."))
                base = [*package[: len(package) - depth + 1], name.lstrip(".")] if depth else [name]
                found.append((node.lineno, resolve(".".join(base))))
    return [(line, target) for line, target in found if target is not None]


def violations(source: Path, page: str) -> list[str]:
    """Everything in the package that the page forbids, one sentence each."""
    table = places(page)
    graph: dict[str, set[str]] = {}
    wrong: list[str] = []
    for file in sorted(source.rglob("*.py")):
        name = file.relative_to(source).as_posix()
        if name == "__init__.py":
            continue
        here = place_of(name, table)
        if here is None:
            wrong.append(f"{name}: not in the table of docs/architecture.md")
            continue
        graph[name] = set()
        for line, target in imports(file, source):
            graph[name].add(target)
            there = place_of(target, table)
            if target == "__init__.py":
                wrong.append(f"{name}:{line} imports from the public face, mckibben/__init__.py")
            elif there is None:
                continue  # the target itself is reported as missing from the table
            elif there.layer > here.layer:
                wrong.append(f"{name}:{line} (layer {here.layer}) imports {target} of the higher layer {there.layer}")
            elif there.layer == here.layer and there.name != here.name:
                siblings = there.row == here.row and there.name.endswith("/")
                if siblings or there > here:
                    wrong.append(f"{name}:{line} imports {target}, which is not listed above it")
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        wrong.append(f"import cycle: {' -> '.join(reversed(error.args[1]))}")
    return wrong


def test_imports_follow_the_map() -> None:
    found = violations(SOURCE, MAP)
    assert not found, "\n".join(found)


def test_everything_on_the_map_exists() -> None:
    missing = [p.name for p in places(MAP) if not (SOURCE / p.name).exists()]
    assert not missing, missing


# The checker itself, on a small house with one fault planted at a time.

PAGE = """
| layer | module | one concept |
|---|---|---|
| 0 | `units.py` | |
| 0 | `spec/errors.py` | |
| 0 | `spec/muscle.py` | |
| 0 | `presets.py` | |
| 1 | `solver/` | |
| 2 | `recover.py`, `result.py` | |
| 3 | `study/`, `view/` | |
"""
SOUND = {
    "__init__.py": "from .view.plots import plot",
    "units.py": "import math",
    "spec/__init__.py": "from .errors import SpecError\nfrom .muscle import Muscle",
    "spec/errors.py": "from mckibben.units import parse",
    "spec/muscle.py": "from . import errors\nfrom ..units import parse",
    "presets.py": "from .spec import Muscle",
    "solver/__init__.py": "from .path import follow",
    "solver/path.py": "from .newton import solve",
    "solver/newton.py": "from .. import spec",
    "recover.py": "import mckibben.solver.newton",
    "result.py": "from .recover import tension",
    "study/sweep.py": "from ..result import Result",
    "view/plots.py": "from ..result import Result",
}


@pytest.mark.parametrize(
    ("file", "text", "complaint"),
    [
        ("units.py", "", None),
        ("spec/errors.py", "from ..solver import newton", "higher layer 1"),
        ("spec/errors.py", "import mckibben.result as r", "higher layer 2"),
        ("solver/newton.py", "def f():\n    from ..result import Result", "solver/newton.py:2 (layer 1)"),
        ("solver/newton.py", "import importlib\nimportlib.import_module('mckibben.result')", "higher layer 2"),
        (
            "solver/newton.py",
            "from importlib import import_module\nimport_module('..result', __package__)",
            "higher layer",
        ),
        (
            "units.py",
            "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from . import presets",
            "not listed above",
        ),
        ("spec/errors.py", "from .muscle import Muscle", "not listed above"),
        ("spec/errors.py", "from . import Muscle", "not listed above"),
        ("spec/muscle.py", "from ..presets import paper", "not listed above"),
        ("recover.py", "from .result import Result", "not listed above"),
        ("view/plots.py", "from ..study.sweep import sweep", "not listed above"),
        ("solver/newton.py", "from .path import follow", "import cycle"),
        ("solver/newton.py", "from . import follow", "import cycle"),
        ("solver/newton.py", "from mckibben import plot", "public face"),
        ("helpers.py", "", "helpers.py: not in the table"),
        ("spec/extra.py", "", "spec/extra.py: not in the table"),
    ],
)
def test_the_checker_sees(tmp_path: Path, file: str, text: str, complaint: str | None) -> None:
    source = tmp_path / "mckibben"
    for name, content in {**SOUND, file: text}.items():
        (source / name).parent.mkdir(parents=True, exist_ok=True)
        (source / name).write_text(content, encoding="utf-8")
    found = violations(source, PAGE)
    if complaint is None:
        assert found == []
    else:
        assert any(complaint in sentence for sentence in found), found

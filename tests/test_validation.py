"""The scripts of validation/ still run: each is imported, and those that read files read what is right."""

import importlib
import random
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

pytestmark = pytest.mark.app

FOLDER = Path(__file__).parent.parent / "validation"
SCRIPTS = sorted(file.stem for file in FOLDER.glob("*.py"))


@pytest.fixture(autouse=True)
def from_their_folder(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    known = set(sys.modules)
    monkeypatch.syspath_prepend(str(FOLDER))
    yield
    for name in set(SCRIPTS) & (sys.modules.keys() - known):
        del sys.modules[name]


@pytest.mark.parametrize("name", SCRIPTS)
def test_a_script_imports(name: str) -> None:
    assert importlib.import_module(name).__doc__


def test_what_is_right_is_read(tmp_path: Path) -> None:
    fuzz, mutants = (importlib.import_module(name) for name in ("fuzz", "mutants"))
    reader = fuzz.Reader(tmp_path)
    for case in (mutants.CASE, mutants.PRESET):
        assert "Muscle(" in reader("case file", {"case.toml": case.encode()}, [])
    designs = {"case.toml": mutants.TABLED.encode(), "designs.csv": mutants.TABLE.encode()}
    assert " designs, " in reader("table of designs", designs, [])
    assert mutants.mutated(mutants.CASE, random.Random(1)) != mutants.CASE.encode()

"""Every public name has a docstring that says what it takes, gives and raises, and an example that runs."""

import doctest
import inspect
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import mckibben as mk

pytestmark = pytest.mark.docs

PRESETS = ("about", "get", "names", "paper", "reference", "sources")
NAMES = (*mk.__all__, *(f"presets.{name}" for name in PRESETS))
OPTIONS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


def named(name: str) -> Any:
    """What `mk.name` is; the name may be dotted."""
    value: Any = mk
    for part in name.split("."):
        value = getattr(value, part)
    return value


def documented(name: str) -> str:
    return inspect.getdoc(named(name)) or ""


def test_the_presets_are_all_of_them() -> None:
    assert sorted(PRESETS) == sorted(mk.presets.__all__)


@pytest.mark.parametrize("name", NAMES)
def test_says_what_it_is_in_one_line_and_shows_an_example(name: str) -> None:
    first, second, *_ = [*documented(name).splitlines(), "", ""]
    assert first.endswith((".", ")"))
    assert not second
    assert ">>> " in documented(name)


@pytest.mark.parametrize("name", [name for name in NAMES if inspect.isroutine(named(name))])
def test_a_function_says_what_it_takes_gives_and_raises(name: str) -> None:
    takes = inspect.signature(named(name)).parameters
    parts = [*(["Args:"] if takes else []), "Returns:", "Raises:"]
    lines = [line.strip() for line in documented(name).splitlines()]
    assert [part for part in parts if part not in lines] == []
    assert [taken for taken in takes if not any(line.startswith(f"{taken}: ") for line in lines)] == []


@pytest.mark.filterwarnings("ignore::mckibben.MuscleWarning")
@pytest.mark.parametrize("name", NAMES)
def test_the_example_does_what_it_shows(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    example = doctest.DocTestParser().get_doctest(documented(name), {"mk": mk}, f"mk.{name}", None, 0)
    assert example.examples
    said: list[str] = []
    failed, _ = doctest.DocTestRunner(optionflags=OPTIONS).run(example, out=said.append)
    assert not failed, "".join(said)


def test_nothing_is_public_that_this_page_does_not_check() -> None:
    values = [named(name) for name in NAMES]
    assert all(isinstance(value, (type, ModuleType)) or callable(value) for value in values)

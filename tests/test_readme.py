"""The README does what it says: its Python, its commands, its pictures; and the pages of docs/ run."""

import contextlib
import io
import re
import shlex
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from mckibben.app.cli import app
from mckibben.view import render

pytestmark = pytest.mark.docs

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
PICTURE = re.compile(r"!\[[^\]]*\]\(([^)#]+)\)")
LINK = re.compile(r"(?<!!)\[[^\]]*\]\(([^)]+)\)")
TOO_LONG = ("reproduce", "serve")
"""Commands that have tests of their own."""


def blocks(text: str) -> list[tuple[str, str]]:
    """(language, content) of the fenced blocks, in order."""
    return re.findall(r"^```(\w*)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def commands(text: str) -> list[list[str]]:
    """The words of every line of a shell block that calls `mckibben`."""
    lines = [line for language, block in blocks(text) if language == "sh" for line in block.splitlines()]
    return [words for words in (shlex.split(line, comments=True) for line in lines) if words[:1] == ["mckibben"]]


def slug(heading: str) -> str:
    """The anchor that a heading gets."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def can_draw() -> bool:
    """Whether recipes of three-dimensional pictures run on this machine; tests/test_scene.py says what it takes."""
    return find_spec("pyvista") is not None and render.can_draw()


def executed(code: str, names: dict[str, Any]) -> str:
    """What a block prints."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(code, "<documentation>", "exec"), names)
    return printed.getvalue()


def test_python_prints_what_the_readme_shows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    found, checked = blocks(README), 0
    for (language, code), (following, shown) in zip(found, [*found[1:], ("", "")], strict=True):
        if language == "python":
            assert following == "text", "every Python block of the README is followed by what it prints"
            assert executed(code, names) == shown
            checked += 1
    assert checked == 4
    assert (tmp_path / "curve.nc").exists()


def test_commands_of_the_readme_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (case,) = [block for language, block in blocks(README) if language == "toml"]
    (tmp_path / "case.toml").write_text(case, encoding="utf-8")
    called = []
    for _, *words in commands(README):
        called.append(words[0])
        if words[0] not in TOO_LONG and (words[0] != "view" or can_draw()):
            done = CliRunner().invoke(app, words)
            assert done.exit_code == 0, (words, done.output)
    assert set(called) == {"check", "run", "plot", "info", "presets", "reproduce", "sensitivity", "serve", "view"}
    assert (tmp_path / "force.png").read_bytes().startswith(b"\x89PNG")


def test_case_of_the_readme_is_the_paper_preset(tmp_path: Path) -> None:
    from mckibben import read_case
    from mckibben.spec import presets

    (case,) = [block for language, block in blocks(README) if language == "toml"]
    path = tmp_path / "case.toml"
    path.write_text(case, encoding="utf-8")
    muscle = read_case(path).muscle
    assert (muscle.braid, muscle.chamber, muscle.ends) == (
        presets.paper().braid,
        presets.paper().chamber,
        presets.paper().ends,
    )


PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_pictures_and_links_lead_somewhere(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    for picture in PICTURE.findall(text):
        target = page.parent / picture
        assert target.exists(), picture
        assert target.stat().st_size < 300_000, f"{picture} is too large for a repository"
    for link in LINK.findall(text):
        place, _, anchor = link.partition("#")
        if "://" in place:
            continue
        target = page.parent / place if place else page
        assert target.exists(), link
        if anchor and target.suffix == ".md":
            headings = re.findall(r"^#+ (.*)$", target.read_text(encoding="utf-8"), re.MULTILINE)
            assert anchor in map(slug, headings), link


@pytest.mark.parametrize("page", ["tutorial.md", "howto.md", "adding_a_law.md"])
def test_python_of_the_pages_runs(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    start: dict[str, Any] = {}
    for count, (_, code) in enumerate(block for block in blocks(text) if block[0] == "python"):
        if "mk.scene(" in code and not can_draw():
            continue
        # a recipe stands alone after the first two lines; a tutorial goes on
        names = start if page == "tutorial.md" or count == 0 else dict(start)
        printed = executed(code, names)
        shown = [(line, said) for line, said in re.findall(r"^(print\(.*\))  # (.*)$", code, re.MULTILINE)]
        for line, said in shown:
            again = executed(line, names)
            for number in re.findall(r"-?\d+\.\d+", said):
                assert any(agrees(other, number) for other in re.findall(r"-?\d+\.\d+(?:e[-+]\d+)?", again)), line
        assert printed or not shown


def agrees(computed: str, written: str) -> bool:
    """Whether a number is the written one at the digits that are written."""
    digits = len(written.partition(".")[2])
    return f"{float(computed):.{digits}f}" == written


def test_commands_of_the_recipes_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for _, *words in commands((ROOT / "docs" / "howto.md").read_text(encoding="utf-8")):
        if words[1] == "view" and words[-1] == "--cut" and not can_draw():
            continue
        written = words.index(">") if ">" in words else len(words)
        done = CliRunner().invoke(app, words[:written])
        assert done.exit_code == 0, (words, done.output)
        if written < len(words):
            Path(words[written + 1]).write_text(done.output, encoding="utf-8")

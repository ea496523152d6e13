"""The bundle that ships with the package against its sources, without Node.js: a change of one without the other."""

import hashlib
import json
import re
from pathlib import Path

import pytest

pytestmark = pytest.mark.page

SOURCES = Path(__file__).parent.parent / "page"
ASSETS = Path(__file__).parent.parent / "src" / "mckibben" / "page" / "assets"


def digest() -> str:
    """As page/build.mjs makes it."""
    names = [f"{folder}/{path.name}" for folder in ("src", "static") for path in (SOURCES / folder).iterdir()]
    made = hashlib.sha256()
    for name in sorted([*names, "build.mjs", "package.json", "package-lock.json"]):
        content = (SOURCES / name).read_bytes()
        made.update(f"{name}\0{len(content)}\0".encode() + content)
    return made.hexdigest()


@pytest.mark.parametrize("name", ["page.js", "page.css"])
def test_the_bundle_is_that_of_its_sources(name: str) -> None:
    head = (ASSETS / name).read_text(encoding="utf-8").partition("*/")[0]
    assert digest() in head, "run make page"
    assert re.search(r"three [\d.]+ \(MIT\), uplot [\d.]+ \(MIT\)", head)


def test_what_is_served_as_it_is_is_a_copy() -> None:
    for path in (SOURCES / "static").iterdir():
        assert (ASSETS / path.name).read_bytes() == path.read_bytes()


def test_licences_ship_with_the_bundle() -> None:
    notice = (ASSETS / "NOTICE.txt").read_text(encoding="utf-8")
    for words in ("three.js authors", "Leon Sorokin", "Permission is hereby granted"):
        assert words in notice


def test_the_lock_names_no_registry_and_pins_everything() -> None:
    text = (SOURCES / "package-lock.json").read_text(encoding="utf-8")
    assert "resolved" not in text
    assert "http" not in re.sub(r'"(url|homepage|funding)": .*', "", text)
    asked = json.loads((SOURCES / "package.json").read_text(encoding="utf-8"))
    for version in [*asked["dependencies"].values(), *asked["devDependencies"].values()]:
        assert re.fullmatch(r"\d+\.\d+\.\d+", version)


def test_the_page_asks_for_nothing_from_outside() -> None:
    page = (ASSETS / "index.html").read_text(encoding="utf-8")
    assert not re.search(r"""(src|href)=["'](https?:)?//""", page)
    assert "style=" not in page
    assert not re.search(r"\son\w+=", page)
    sheet = (ASSETS / "page.css").read_text(encoding="utf-8").partition("*/")[2]
    assert "url(" not in sheet
    assert "@import" not in sheet

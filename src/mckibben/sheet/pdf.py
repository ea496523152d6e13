"""The datasheet as PDF, set by typst."""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path
from typing import Any, Literal

import attrs
import matplotlib

from mckibben.sheet.words import Page
from mckibben.spec import SpecError

__all__ = ["pdf", "typeset"]


def pdf(page: Page) -> bytes:
    """The pages as a PDF file; equal pages are equal files. SpecError where typst is not installed."""
    (made,) = typeset(page, "pdf")
    return made


def typeset(page: Page, kind: Literal["pdf", "png"]) -> list[bytes]:
    """The pages as one PDF file ("pdf"), or as a picture each ("png")."""
    try:
        import typst
    except ImportError as error:
        said = "a datasheet as PDF takes typst to set it"
        raise SpecError("datasheet", allowed=said, advice='pip install "mckibben[report]", or write .html') from error
    fonts: list[Any] = [Path(matplotlib.get_data_path()) / "fonts" / "ttf"]
    made: Any = typst.compile(
        (files("mckibben.sheet") / "sheet.typ").read_bytes(), format=kind, ppi=150.0,
        font_paths=fonts, ignore_system_fonts=True, sys_inputs={"data": json.dumps(attrs.asdict(page))},
    )  # fmt: skip
    return made if isinstance(made, list) else [made]

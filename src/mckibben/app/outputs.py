"""What commands write beside what they print: a table or everything, a picture, a muscle for case files."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import attrs

__all__ = ["PICTURES", "PIXELS", "Outputs", "case_of", "check_picture", "finite", "numbers", "picture"]

PICTURES = {".png": "picture", ".pdf": "print", ".svg": "web", ".html": "interactive page"}
PIXELS = 1200
"""Least width of a picture in pixels, for slides and screens."""
TOML = {".toml": "a muscle for case files"}


@attrs.frozen
class Outputs:
    """Where a fit or a design goes, as far as it was asked for."""

    file: Path | None
    picture: Path | None
    case: Path | None  #: the muscle that was found
    force: bool

    def check(self) -> None:
        """SpecError if `write` would fail for a name, a folder or a file that is there already."""
        from mckibben import disk
        from mckibben.files import store

        if self.file is not None:
            store.check_output(self.file, self.force)
        for path, endings in ((self.picture, PICTURES), (self.case, TOML)):
            if path is not None:
                store.suffix_of(path, endings)
                disk.check_target(path, self.force)
        if self.picture is not None:
            check_picture(self.picture)

    def write(self, found: Any, case: str) -> dict[str, str | None]:
        """Write it all; the names of the files."""
        from mckibben import disk
        from mckibben.files import store

        if self.file is not None:
            store.save(found, self.file, self.force)
        if self.picture is not None:
            content = picture(found, self.picture.suffix.lower(), PIXELS)
            disk.write(self.picture, content, self.force)
        if self.case is not None:
            disk.write(self.case, case.encode("utf-8"), self.force)
        places = {"file": self.file, "picture": self.picture, "case": self.case}
        return {what: None if path is None else str(path) for what, path in places.items()}


def check_picture(path: Path) -> None:
    """SpecError if what draws a picture of this ending is missing."""
    if path.suffix.lower() == ".html":
        from mckibben.view import web

        web.check_plotly(str(path))


def picture(found: Any, suffix: str, pixels: int = 0, kind: str = "auto", data: Any = None) -> bytes:
    """The natural picture of what a call gave, or one of another kind, as the bytes of a file."""
    import matplotlib

    matplotlib.use("Agg")  # draws to files only, without a window
    if suffix == ".html":
        from mckibben.spec.errors import SpecError
        from mckibben.view.interactive import drawn

        if kind != "auto":
            raise SpecError("--kind", kind, "has no interactive picture", "leave it out, or write .png, .pdf or .svg")
        return drawn(found, data).page()
    from mckibben.view import style
    from mckibben.view.plot import plot

    return style.picture(plot(found, kind, data), suffix[1:], pixels)


def case_of(muscle: Any, lines: Iterable[str]) -> str:
    """A muscle as the [muscle] table of a case file, with where it comes from in comments."""
    from mckibben.spec.text import Case, to_toml

    comments = [*lines, "add a [test] table for mckibben run"]
    return "".join(f"# {line}\n" for line in comments) + to_toml(Case(muscle), allow_custom=True)


def finite(value: Any) -> float | None:
    """A number for JSON; None for NaN and infinity."""
    return float(value) if math.isfinite(value) else None


def numbers(values: Any) -> list[float | None]:
    """An array for JSON, None for NaN."""
    return [None if value != value else value for value in values.tolist()]

"""Sections of validation/README.md that are written by themselves and outlive the others."""

from environment import ROOT

README = ROOT / "validation" / "README.md"
TITLES = ("## The error estimate", "## Curves", "## Gradients", "## Damaged files", "## Wrong input")
"""In this order, at the end."""


def kept() -> list[str]:
    """The sections that are there, as lines; for whoever writes the whole page."""
    return [line for title in TITLES for line in _there(title)]


def put(title: str, lines: list[str]) -> None:
    """Write one of the sections anew."""
    sections = {name: _there(name) for name in TITLES} | {title: ["", title, *lines]}
    text = README.read_text(encoding="utf-8").splitlines()
    start = min((text.index(name) for name in TITLES if name in text), default=len(text))
    while start and not text[start - 1]:
        start -= 1
    written = [line for name in TITLES for line in sections[name]]
    README.write_text("\n".join([*text[:start], *written]) + "\n", encoding="utf-8")


def _there(title: str) -> list[str]:
    """A section with the empty line before it; nothing where it is not there."""
    text = README.read_text(encoding="utf-8").splitlines() if README.exists() else []
    if title not in text:
        return []
    start = text.index(title)
    end = next((k for k in range(start + 1, len(text)) if text[k].startswith("## ")), len(text))
    while not text[end - 1]:
        end -= 1
    return ["", *text[start:end]]

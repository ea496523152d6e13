"""The muscles that have a name, as a page lists them."""

from __future__ import annotations

from mckibben.spec import presets

__all__ = ["told"]


def told() -> list[dict[str, str]]:
    """Name and description of each preset."""
    return [{"name": name, "about": presets.about(name)} for name in presets.names()]

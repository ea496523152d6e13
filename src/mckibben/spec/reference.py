"""The reference page of all spec classes, derived from the declared fields."""

from __future__ import annotations

from mckibben.spec.declared import describe
from mckibben.spec.fields import spec_classes

__all__ = ["reference_markdown"]


def reference_markdown() -> str:
    """The reference page: one table per spec class."""
    lines: list[str] = []
    for cls in spec_classes():
        summary = (cls.__doc__ or "").strip().splitlines()[0]
        lines += [f"## {cls.__name__}", "", summary, "", "| field | meaning | unit | allowed | default | source |"]
        lines.append("|---|---|---|---|---|---|")
        for field in describe(cls):
            default = "required" if field.required else "none" if field.default is None else str(field.default)
            allowed = field.allowed or " or ".join(kind.__name__ for kind in field.parts)
            allowed = "; ".join(filter(None, (allowed, field.computed and f"computed: {field.computed}")))
            cells = (f"`{field.name}`", field.meaning, field.unit, allowed, default, field.source)
            lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
        lines.append("")
    return "\n".join(lines)

"""Fields of a spec object given anew, one or several at once: by `Muscle.replace`, by a sweep, over a preset.

A field goes by its dotted name: "braid.angle", "chamber.law.c1", "steps.0.pressure".
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from mckibben.spec.angle import anew
from mckibben.spec.contraction import DECLARED as CONTRACTION
from mckibben.spec.contraction import takes_it
from mckibben.spec.declared import describe, evolved, walk
from mckibben.spec.errors import SpecError, nearest

__all__ = ["CHANGED", "changed", "changed_muscle", "changed_name", "left_behind", "still_assumed"]

CHANGED = " (changed)"
"""Added to the name of a muscle that is no longer what its name says."""

_ANGLE = "braid.angle"
_EITHER = {"braid.fibre.": (("B1", "B2", "B3"), ("E", "nu")), "chamber.law.": (("E",), ("shore",))}
"""Two ways to give a part, one of which replaces the other."""


def changed_muscle(muscle: Any, values: Mapping[str, Any]) -> Any:
    """The muscle with all of `values` put in at once.

    What was changed, and all within it, leaves `assumed`; the name says that the muscle was changed. Giving B1, B2, B3
    replaces a fibre's E and nu, and giving E a rubber's hardness; and the other way round. An angle is measured from
    what the muscle's own was given from. SpecError for an unknown name, or values that cannot be.
    """
    given = dict(values)
    if "assumed" not in values:
        given["assumed"] = still_assumed(muscle.assumed, values)
    if muscle.name and not {"name", "assumed"} & values.keys():
        given["name"] = changed_name(muscle.name)
    return changed(muscle, given)


def changed(owner: Any, values: Mapping[str, Any], prefix: str = "") -> Any:
    """A copy of a spec object, or a tuple of them, with `values` put in at once, inner ones first."""
    new, inner = _grouped(values)
    if "contraction" in new and takes_it(owner):
        new["length"] = CONTRACTION.read(new.pop("contraction"), f"{prefix}contraction", CONTRACTION)
    if isinstance(owner, tuple):
        return tuple(changed(part, inner.get(str(k), {}), f"{prefix}{k}.") for k, part in enumerate(owner))
    known = {item.name: item.kind for item in describe(type(owner))}
    for head in (*new, *inner):
        if head not in known or (head in inner and known[head] not in ("part", "steps")):
            full = prefix + next(name for name in values if name.partition(".")[0] == head)
            options = dict.fromkeys(prefix + name for name in (*known, *(name for name, _, _ in walk(owner))))
            raise SpecError(full, allowed="is no field of this muscle", advice=nearest(full, options))
    for head, some in inner.items():
        part = new.get(head, getattr(owner, head))
        if part is None:
            (name, value), *_ = some.items()
            raise SpecError(
                f"{prefix}{head}.{name}", value, f"this muscle has no {head}", f"give the whole {head} first"
            )
        new[head] = changed(part, some, f"{prefix}{head}.")
    if "angle_from" in known:
        new = anew(owner, new)
    return evolved(owner, **dict.fromkeys(left_behind(new, prefix)), **new)


def _grouped(values: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
    """What is given for an object's own fields, and what for fields within each of them."""
    own: dict[str, Any] = {}
    inner: dict[str, dict[str, Any]] = {}
    for name, value in values.items():
        head, dot, rest = name.partition(".")
        if dot:
            inner.setdefault(head, {})[rest] = value
        else:
            own[head] = value
    return own, inner


def left_behind(given: Iterable[Any], prefix: str) -> tuple[str, ...]:
    """Fields that have no meaning beside those given: E and nu beside a fibre's stiffnesses, and the other way."""
    names, (one, other) = set(given), _EITHER.get(prefix, ((), ()))
    first, second = names & set(one), names & set(other)
    if bool(first) == bool(second):  # nothing, or both, which the part refuses
        return ()
    return other if first else one


def still_assumed(assumed: Iterable[str], given: Iterable[str]) -> tuple[str, ...]:
    """Names of assumed fields that are neither given, nor within what is given, nor left behind by it."""
    said = list(given)
    said += [_ANGLE for name in said if name == f"{_ANGLE}_from"]
    for prefix in _EITHER:
        inside = [name.removeprefix(prefix) for name in said if name.startswith(prefix)]
        said += [prefix + name for name in left_behind(inside, prefix)]
    return tuple(name for name in assumed if not any(name == field or name.startswith(field + ".") for field in said))


def changed_name(name: str) -> str:
    """Name of a muscle that is no longer what its name says."""
    return name if name.endswith(CHANGED) else name + CHANGED

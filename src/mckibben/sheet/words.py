"""The datasheet in words: plain text in titles, rows and sentences, which PDF and HTML set each in its way."""

from __future__ import annotations

from collections.abc import Iterator

import attrs

from mckibben.measure.report import versions
from mckibben.sheet.facts import Facts
from mckibben.sheet.levels import Fact
from mckibben.spec import Muscle, presets
from mckibben.spec.change import CHANGED
from mckibben.spec.constants import ATMOSPHERE
from mckibben.spec.rows import ASSUMED, muscle_rows
from mckibben.units import show

__all__ = ["Page", "page"]

TITLE = 80
"""Characters of a title."""
VALUE = 160
"""Characters of a value or a meaning."""
CAUTIONS = 8
"""Cautions at most, so that two pages do."""

Rows = tuple[tuple[str, ...], ...]


@attrs.frozen
class Page:
    """All that a datasheet says, as text; pictures as SVG."""

    title: str
    subtitle: str
    key: Rows  #: what, value
    heads: tuple[str, ...]
    levels: Rows  #: a row for each pressure
    reasons: tuple[str, ...]  #: why some of these are not there
    parameters: Rows  #: field, value, meaning, "assumed" or ""
    limits: tuple[str, ...]
    made: str
    drawing: str
    curves: str


def page(facts: Facts, drawing: str, curves: str, date: str) -> Page:
    """Put what was computed into words."""
    muscle = facts.muscle
    top = show(facts.pressure, "Pa", 3)
    name = _short(muscle.name or "Muscle without a name", TITLE)
    preset = (muscle.name or "").removesuffix(CHANGED)
    kind = _short(presets.about(preset), VALUE) if preset in presets.names() else "McKibben muscle"
    subtitle = f"{kind[:1].upper()}{kind[1:]}. Computed up to {top}; pressures are gauge pressures."
    heads = ("Pressure", "Blocked force", "Free contraction", "Free length")
    levels: list[tuple[str, ...]] = []
    reasons: dict[str, list[str]] = {}
    for level in facts.levels:
        cells = [_text(level.blocked, "N"), _text(level.contraction, "1"), _text(level.length, "m")]
        levels.append((show(level.pressure, "Pa", 3), *cells))
        for what, one in (("blocked force", level.blocked), ("free contraction", level.contraction)):
            if one.reason:
                reasons.setdefault(f"no {what}: {one.reason}", []).append(show(level.pressure, "Pa", 3))
    said = tuple(f"At {', '.join(where)} {why}." for why, where in reasons.items())
    if facts.cautions:
        said = (*said, "Of some states more must be known: see assumptions and limits.")
    about = ", ".join(f"{package} {number}" for package, number in versions().items())
    return Page(
        name, subtitle, tuple(_key(facts, top)), heads, tuple(levels), said, tuple(_parameters(muscle)),
        tuple(_limits(facts)), f"Made on {date} with {about}.", drawing, curves,
    )  # fmt: skip


def _text(known: Fact, unit: str, digits: int = 4) -> str:
    if known.value != known.value:
        return "–"
    return f"{show(100.0 * known.value, '1', digits)} %" if unit == "1" else show(known.value, unit, digits)


def _or_reason(known: Fact, text: str) -> str:
    if known.value == known.value:
        return text
    return known.reason if known.reason.startswith("not known") else f"not computed: {known.reason}"


def _key(facts: Facts, top: str) -> Iterator[tuple[str, str]]:
    """What a colleague asks for first."""
    muscle, last = facts.muscle, facts.levels[-1]
    yield f"Blocked force at {top}", _or_reason(last.blocked, f"{_text(last.blocked, 'N')} at the length as made")
    free = f"{_text(last.contraction, '1')} (to {_text(last.length, 'm')})"
    yield f"Free contraction at {top}", _or_reason(last.contraction, free)
    reach = facts.range
    if reach is None:
        yield f"Working range at {top}", f"not computed: {facts.no_range}"
    else:
        limit = f"to {show(reach.longest, 'm', 4)}" if reach.longest == reach.longest else "and longer, without a limit"
        push = f"; pushes with at most {show(-reach.force_extremum, 'N', 3)}" if reach.force_extremum < 0.0 else ""
        yield f"Working range at {top}", f"{show(reach.shortest, 'm', 4)} {limit}{push}"
    yield "Length as made", show(float(muscle.rest_length), "m", 4)
    yield "Largest diameter", _or_reason(facts.diameter, f"{_text(facts.diameter, 'm')} on the curves shown")
    before, after = show(facts.bore, "m^3", 4), _text(facts.volume, "m^3")
    yield "Air volume", f"{before} as made, " + _or_reason(facts.volume, f"{after} free at {top}")
    litres = f"{show(1e3 * facts.air.value, '1', 3)} normal litres ({show(ATMOSPHERE, 'Pa', 4)})"
    yield "Air per stroke", _or_reason(facts.air, f"{litres}, from no pressure to free at {top}")
    yield f"Work of a slow stroke at {top}", _or_reason(facts.work, f"{facts.work.value:.3g} J")
    yield "Peak fibre tension", _or_reason(facts.tension, f"{_text(facts.tension, 'N', 3)}, {facts.where}")
    safe = f"{facts.safety.value:.3g} (breaking force over peak tension)"
    yield "Safety of the fibres", _or_reason(facts.safety, safe)
    yield "Mass without fittings", _or_reason(facts.mass, f"{1e3 * facts.mass.value:.3g} g")


def _parameters(muscle: Muscle) -> Iterator[tuple[str, str, str, str]]:
    for name, said, meaning, source in muscle_rows(muscle):
        text = {"True": "yes", "False": "no"}.get(said, said).replace("^2", "²").replace("^3", "³")
        yield name, _short(text, VALUE), meaning, "assumed" if source.startswith(ASSUMED) else ""


def _limits(facts: Facts) -> Iterator[str]:
    """What a reader must know to trust a number, what is special to this muscle first."""
    muscle = facts.muscle
    if muscle.assumed:
        yield f"Assumed, not measured: {_short(', '.join(muscle.assumed), 6 * VALUE)}."
    for said in facts.cautions[:CAUTIONS]:
        yield f"{said[:1].upper()}{said[1:]}."
    if len(facts.cautions) > CAUTIONS:
        yield f"There are {len(facts.cautions) - CAUTIONS} more cautions: see mckibben run."
    if muscle.friction is None:
        yield "Friction between fibres is left out: a real muscle pulls less as it shortens than as it is stretched."
    else:
        yield "With friction between fibres: each curve is that of a muscle that is filled first and shortens then."
    if not muscle.braid.fibre.stretch:
        yield "The fibres do not stretch: forces of compliant muscles are overestimated."
    yield (
        "Computed, not measured, for slow changes, with the model of Quaglierini, Arroyo and DeSimone (RoboSoft 2023): "
        "axisymmetric states, no wear, no leaks, no bursting, no temperature. Force is positive where the muscle "
        "pulls; contraction is 1 - length / length as made. States that are not stable are not shown."
    )


def _short(text: str, most: int) -> str:
    """One line of at most so many characters, with places to break long words."""
    line = " ".join("".join(c if c.isprintable() else " " for c in text).split())
    line = line if len(line) <= most else f"{line[: most - 1]}…"
    return " ".join("\u200b".join(word[k : k + 16] for k in range(0, len(word), 16)) for word in line.split(" "))

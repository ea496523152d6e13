"""Valid input of every kind, and what is made of it: characters, values, lines and whole tables changed at random."""

import random
import re
from collections.abc import Callable

CASE = """\
[muscle]
ends = "clamped"
[muscle.braid]
radius = "12.5 mm"
length = "85 mm"
angle = "37 deg"
fibres = 56
fibre = { diameter = "0.25 mm", E = "3 GPa", nu = 0.4 }
[muscle.chamber]
thickness = "1 mm"
law = { name = "mooney-rivlin", c1 = "8.5 kPa", c2 = "0 Pa" }
[test]
kind = "isometric"
length = "100 mm"
pressure = "0 to 1 bar"
points = 3
"""
PRESET = """\
[muscle]
preset = "reference"
ends = "pinned"
[muscle.braid]
angle = "55 deg"
angle_from = "axis"
[muscle.chamber.law]
name = "ogden"
mu = ["20 kPa", 1e3]
alpha = [1.8, -2.0]
[test]
kind = "protocol"
[[test.steps]]
length = "to 95 mm"
pressure = 0.0
points = 2
[[test.steps]]
length = "hold"
pressure = "to 0.5 bar"
points = 2
"""
SWEEP = (
    CASE
    + """\
[sweep]
chunk = 8
over = { "braid.angle" = { from = "34 deg", to = "40 deg", points = 3 }, "braid.fibres" = [40, 56], ends = ["pinned"] }
"""
)
TABLED = CASE + '[sweep]\ndesigns = "designs.csv"\n'
TABLE = """\
braid.angle [deg],chamber.thickness [mm],braid.fibres,ends,test.length [mm]
36,1.0,56,clamped,100
37,1.2,40,pinned,95
38.5,0.8,48,clamped,105
"""
OVERRIDES = ("braid.angle=36 deg", "test.pressure=0 to 2 bar", "ends=pinned", "chamber.law.c1=1e4", "braid.fibres=40",
             'chamber={ thickness = "2 mm", law = { name = "gent", mu = "20 kPa", Jm = 30 } }')  # fmt: skip

NUMBERS = ("3", "12", "20", "40", "60", "100", "1.5", "0.25", "0", "-0.0", "-1", "1e-320", "5e-324", "1e-30", "1e-6",
           "1e30", "1e308", "1e999", "-1e200", "nan", "inf", "-inf", "0x10", "0b1", "1_000", "00", "1.", ".5", "9" * 40,
           "2e5", "56.5", "0.1")  # fmt: skip
VALUES = ("true", "[]", "{}", '""', '"hold"', '"none"', '"12,5 mm"', '"1 bar to"', '"0 to 1 to 0 bar"', '"1 furlong"',
          "1979-05-27", "07:32:00", "[1, 2, 3]", '["1 mm", "2 mm"]', "{ a = 1 }", '"nan mm"', '"1e400 mm"',
          '"-5 mm"', '"37 °"', '"5 %"', "'''\nx'''", '"0.5"', "[[1]]", '"\\u0000"', '"custom"', '"free"')  # fmt: skip
JUNK = ("\x00", "=", "[", "]]", '"', "mm", "-", "é", "{", "}", "to", ",", ";", "\t", "\n", "\r\n", "#", ".", "'",
        "\ufeff", "θ", "\u202e", "%", "e9", "  ", "\\")  # fmt: skip
UNITS = (
    "mm",
    "m",
    "km",
    "um",
    "inch",
    "bar",
    "Pa",
    "GPa",
    "psi",
    "deg",
    "rad",
    "N",
    "kg",
    "degC",
    "mm^2",
    "N mm^2",
    "1/m",
)

_NUMBER = re.compile(r"-?\d+\.?\d*(?:e-?\d+)?")
_VALUE = re.compile(r"(?<== )[^,}\n]+")
_UNIT = re.compile(r"(?<=\d )[A-Za-z^0-9 ]+(?=\")|(?<=\[)[a-z]+(?=\])")
_WORD = re.compile(r"[A-Za-z_][\w.-]*")


def mutated(text: str, chance: random.Random) -> bytes:
    """A text with one to three things changed, and now and then its bytes."""
    for _ in range(chance.choice((1, 1, 1, 2, 3))):
        text = chance.choice(CHANGES)(text, chance)
    data = text.encode("utf-8", "replace")
    if chance.random() < 0.08 and data:
        return damaged(data, chance)
    if chance.random() < 0.05:
        return chance.choice((b"\xef\xbb\xbf" + data, data.replace(b"\n", b"\r\n"), text.encode("utf-16"), data + data))
    return data


def damaged(data: bytes, chance: random.Random) -> bytes:
    """Bytes with one place changed, cut, zeroed or lost."""
    at, kind = chance.randrange(len(data)), chance.randrange(5)
    end = min(len(data), at + chance.randint(1, 4096))
    if kind == 0:
        return data[:at]
    if kind == 1:
        return data[:at] + bytes(end - at) + data[end:]
    if kind == 2:
        return data[:at] + data[end:]
    if kind == 3:
        return data[:at] + chance.randbytes(end - at) + data[end:]
    return data[:at] + bytes([data[at] ^ 1 << chance.randrange(8)]) + data[at + 1 :]


def _replaced(pattern: re.Pattern[str], options: tuple[str, ...]) -> Callable[[str, random.Random], str]:
    def change(text: str, chance: random.Random) -> str:
        places = list(pattern.finditer(text))
        if not places:
            return text
        place = chance.choice(places)
        return text[: place.start()] + chance.choice(options) + text[place.end() :]

    return change


def _word(text: str, chance: random.Random) -> str:
    """A word put where another was, from the same text."""
    words = list(_WORD.finditer(text))
    if not words:
        return text
    place = chance.choice(words)
    return text[: place.start()] + chance.choice(words).group() + text[place.end() :]


def _junk(text: str, chance: random.Random) -> str:
    at = chance.randint(0, len(text))
    return text[:at] + chance.choice(JUNK) + text[at:]


def _lines(text: str, chance: random.Random) -> str:
    """A line dropped, doubled, cut or moved."""
    lines = text.splitlines()
    if not lines:
        return text
    at, kind = chance.randrange(len(lines)), chance.randrange(4)
    line = lines.pop(at)
    if kind == 1:
        lines[at:at] = [line, line]
    elif kind == 2:
        lines.insert(at, line[: chance.randint(0, len(line))])
    elif kind == 3:
        lines.insert(chance.randint(0, len(lines)), line)
    return "\n".join(lines) + "\n"


def _grown(text: str, chance: random.Random) -> str:
    """Something very long, or very deep."""
    at, times = chance.randint(0, len(text)), chance.choice((30, 1000, 20000))
    return text[:at] + chance.choice(("a.", "[", "{a=", "9", "x", " ", "\n", "#", "1 to ", ",")) * times + text[at:]


CHANGES: tuple[Callable[[str, random.Random], str], ...] = (
    _replaced(_NUMBER, NUMBERS), _replaced(_NUMBER, NUMBERS), _replaced(_NUMBER, NUMBERS), _replaced(_VALUE, VALUES),
    _replaced(_VALUE, VALUES), _replaced(_UNIT, UNITS), _word, _junk, _junk, _lines, _lines, _grown,
)  # fmt: skip

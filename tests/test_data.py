"""Measured data as laboratories write them: what is in the file is what is read, and nothing is guessed in silence."""

import contextlib
import hashlib
import json
import re
import sys
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import attrs
import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from workbooks import workbook

import mckibben as mk
from mckibben.data import samples
from mckibben.data.branches import loading
from mckibben.data.compare import compare, difference
from mckibben.data.heads import read_head
from mckibben.data.numbers import decimal_mark, numbers

pytestmark = pytest.mark.data

SHARED = Path(__file__).parents[2] / "shared" / "data"
PLAIN = "pressure [bar],length [mm],force [N]\n1,80,0\n1,90,12.5\n1,100,31\n"


def written(folder: Path, text: str | bytes, name: str = "bench.csv") -> Path:
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode("utf-8"))
    return path


def same(data: mk.Data) -> None:
    """The three points of PLAIN."""
    assert data.measured == "length"
    np.testing.assert_array_equal(data.pressure, [1e5, 1e5, 1e5])
    np.testing.assert_array_equal(data.length, [0.08, 0.09, 0.1])
    np.testing.assert_array_equal(data.force, [0.0, 12.5, 31.0])


FORMS = {
    "plain": (PLAIN, {}),
    "tabs": (PLAIN.replace(",", "\t"), {}),
    "semicolons and decimal commas": (PLAIN.replace(",", ";").replace(".", ","), {}),
    "spaces": ("p_bar  l_mm  F_N\n 1   80    0\n 1   90  12.5\n 1  100    31\n", {}),
    "a row of units": (
        'Time,Pressure,Length,Load\n(s),(bar),(mm),(N)\n0,"1","80","0"\n1,"1","90","12.5"\n2,"1","100","31"\n',
        {},
    ),
    "quoted decimal commas": (
        '"Druck (bar)","Länge [mm]","Kraft [N]"\n"1,0","80,0","0,0"\n"1,0","90,0","12,5"\n"1,0","100,0","31,0"\n',
        {},
    ),
    "a byte order mark": ("\ufeff" + PLAIN, {}),
    "UTF-16": (PLAIN.encode("utf-16"), {}),
    "UTF-16 without its mark": (PLAIN.encode("utf-16-le"), {}),
    "Latin-1": (PLAIN.replace("length", "länge").encode("latin-1"), {}),
    "Windows lines": (PLAIN.replace("\n", "\r\n"), {}),
    "old Mac lines": (PLAIN.replace("\n", "\r"), {}),
    "comments and blank lines": ("# made by hand\n\n" + PLAIN.replace("\n1,90", "\n# a pause\n\n1,90"), {}),
    "heads in a comment": ("# pressure [bar], length [mm], force [N]\n" + PLAIN.partition("\n")[2], {}),
    "a preamble": ("Operator,Smith\nDate,2026-03-04\nSpeed,0.5\n\n" + PLAIN, {}),
    "units in the names": (PLAIN.replace(" [bar]", "_bar_gauge").replace(" [mm]", "_mm").replace(" [N]", "_N"), {}),
    "units behind a stroke or a comma": (
        PLAIN.replace("pressure [bar],length [mm],force [N]", 'p / bar,"Length, mm",F in N'),
        {},
    ),
    "units of the caller": (
        PLAIN.replace(" [bar]", "").replace(" [mm]", ""),
        {"units": {"pressure": "bar", "length": "mm"}},
    ),
    "columns of the caller": (
        PLAIN.replace("force", "Load cell 2 signal").replace("length", "LVDT"),
        {"columns": {"force": "Load cell 2 signal", "length": 2}},
    ),
    "capital units": (PLAIN.replace("bar", "BAR").replace("mm", "MM"), {}),
    "other columns": ("n,note," + PLAIN.replace("\n1,", "\n7,ok,1,"), {}),
    "a trailing separator": (PLAIN.replace("\n", ",\n"), {}),
    "thousands marked": (
        'pressure (Pa),length (mm),force (N)\n"100,000.0",80,0\n"100,000.0",90,12.5\n"100,000.0",100,31\n',
        {},
    ),
    "thin thousands and a true minus": (
        "pressure [Pa];length [mm];force [N]\n100 000,0;80;−0,0\n100 000,0;90;12,5\n100 000,0;100;31\n",
        {},
    ),
}


@pytest.mark.parametrize("form", FORMS)
def test_a_form_is_read(tmp_path: Path, form: str) -> None:
    text, options = FORMS[form]
    same(mk.read_data(written(tmp_path, text, "bench.txt"), **options))


def test_a_workbook_is_read(tmp_path: Path) -> None:
    pytest.importorskip("python_calamine")
    rows = [["pressure", "length", "force"], ["bar", "mm", "N"], [1.0, 80.0, 0], [1.0, 90.0, 12.5], [1.0, 100.0, 31]]
    path = written(tmp_path, workbook({"notes": [], "bench": rows}), "bench.xlsx")
    same(mk.read_data(path))
    path = written(tmp_path, workbook({"notes": [["by hand"]], "3 bar": rows}), "two.xlsx")
    with pytest.raises(mk.SpecError, match=r'two.xlsx: has several sheets: "notes", "3 bar"; say sheet="notes"'):
        mk.read_data(path)
    same(mk.read_data(path, sheet="3 bar"))
    same(mk.read_data(path, sheet=2))
    with pytest.raises(mk.SpecError, match=r"sheet = 2 bar: is none of its sheets; did you mean"):
        mk.read_data(path, sheet="2 bar")
    rows[3][2] = "slack"
    path = written(tmp_path, workbook({"bench": rows}), "wrong.xlsx")
    with pytest.raises(mk.SpecError, match=r'wrong.xlsx, row 4, column "force" = slack: must be a number'):
        mk.read_data(path)
    with pytest.raises(mk.SpecError, match="is no workbook that can be read"):
        mk.read_data(written(tmp_path, b"PK\x03\x04 and nothing more", "torn.xlsx"))


def test_without_its_reader_a_workbook_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "python_calamine", None)
    path = written(tmp_path, workbook({"bench": [["a"]]}), "bench.xlsx")
    with pytest.raises(mk.SpecError, match=r'takes python-calamine to read; pip install "mckibben\[lab\]"'):
        mk.read_data(path)


def test_a_table_with_units_in_its_heads_reads_the_same_way() -> None:
    columns = {"pressure [bar]": [1, 1, 1], "length [mm]": [80.0, 90.0, 100.0], "force [N]": [0, 12.5, 31]}
    data = mk.read_data(pd.DataFrame(columns))
    same(data)
    assert data == mk.read_data(columns)
    assert data == mk.read_data(data.to_pandas())
    assert data.rows.tolist() == [1, 2, 3]
    two = pd.DataFrame(columns)
    two.columns = pd.MultiIndex.from_tuples([tuple(head.split()) for head in columns])
    same(mk.read_data(two))


@settings(max_examples=150)
@given(
    numbers=st.lists(st.tuples(*[st.floats(-1e6, 1e6).map(lambda x: float(f"{x:.9g}"))] * 2), min_size=2, max_size=12),
    separator=st.sampled_from([",", ";", "\t", "|"]),
    decimal=st.sampled_from([".", ","]),
    quoted=st.booleans(),
    encoding=st.sampled_from(["utf-8", "utf-8-sig", "utf-16", "latin-1"]),
    lines=st.sampled_from(["\n", "\r\n"]),
    unit=st.sampled_from(["N", "kN", "mN", "lbf", "kg"]),
    style=st.sampled_from(["{} [{}]", "{} ({})", "{}_{}", "{}, {}"]),
    length=st.sampled_from(["m", "mm", "cm", "inch"]),
    swapped=st.booleans(),
)
def test_what_a_dialect_writes_is_read_back(
    numbers: Any, separator: str, decimal: str, quoted: bool, encoding: str, lines: str, unit: str, style: str,
    length: str, swapped: bool, tmp_path_factory: pytest.TempPathFactory,
) -> None:  # fmt: skip
    quoted = quoted or separator == decimal or (style == "{}, {}" and separator == ",")
    factor = {"N": 1.0, "kN": 1e3, "mN": 1e-3, "lbf": 4.4482216152605, "kg": 9.80665}[unit]
    metres = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "inch": 0.0254}[length]
    cells = [[style.format("Force", unit), style.format("Length", length)], *numbers]
    cells = [row[::-1] for row in cells] if swapped else cells
    texts = [[cell if isinstance(cell, str) else f"{cell:.9f}".replace(".", decimal) for cell in row] for row in cells]
    text = lines.join(separator.join(f'"{cell}"' if quoted else cell for cell in row) for row in texts) + lines
    path = written(tmp_path_factory.mktemp("dialect"), text.encode(encoding))
    data = mk.read_data(path, held={"pressure": "2 bar"})
    read = np.array([[float(f"{x:.9f}") for x in row] for row in numbers])
    np.testing.assert_allclose(data.force, factor * read[:, 0], rtol=1e-14, atol=0.0)
    np.testing.assert_allclose(data.length, metres * read[:, 1], rtol=1e-14, atol=0.0)
    assert set(data.pressure) == {2e5}
    assert data.rows.tolist() == list(range(2, 2 + len(numbers)))


@settings(max_examples=200)
@given(st.one_of(st.binary(max_size=60), st.text(st.sampled_from("1,.;\t\n\"'[]()-eEN pbarlmF%#x"), max_size=80)))
def test_whatever_a_file_holds_it_is_read_or_refused(
    tmp_path_factory: pytest.TempPathFactory, content: bytes | str
) -> None:
    heads = "" if isinstance(content, bytes) else "p [bar],l [mm],F [N]\n1,2,3\n"
    path = tmp_path_factory.mktemp("any") / "x.csv"
    path.write_bytes(content if isinstance(content, bytes) else (heads + content).encode())
    with contextlib.suppress(mk.SpecError):
        assert len(mk.read_data(path)) > 0


@given(st.lists(st.floats(allow_nan=False, allow_infinity=False, width=64), min_size=1, max_size=8))
def test_every_digit_counts(values: list[float]) -> None:
    for texts in ([repr(x) for x in values], [repr(x).replace(".", ",") for x in values]):
        mark = "," if texts[0] != repr(values[0]) or "," in "".join(texts) else "."
        found, wrong = numbers(texts, mark)
        assert wrong is None
        np.testing.assert_array_equal(found, values)


@pytest.mark.parametrize(
    ("cells", "mark"),
    [
        (["1.5", "2"], "."), (["1,5", "2"], ","), (["1,234.5"], "."), (["1.234,5"], ","), (["0,125"], ","),
        (["1,234", "1,2"], ","), (["1e3"], "."), (["text", ""], "."),
    ],
)  # fmt: skip
def test_the_decimal_mark_is_told_by_the_numbers(cells: list[str], mark: str) -> None:
    assert decimal_mark([cells], "x") == mark


@pytest.mark.parametrize(
    ("text", "readings", "unit"),
    [
        ("Force [N]", ("force",), "N"), ("pressure (bar)", ("pressure",), "bar"), ("length_mm", ("length",), "mm"),
        ("Load cell (kg)", ("force",), "kg"), ("LoadCell", ("force",), ""), ("rest_length_mm", ("rest_length",), "mm"),
        ("free_length_at_pressure_mm", ("free_length",), "mm"), ("pressure_Pa_gauge", ("pressure",), "Pa"),
        ("p (bar(a))", ("pressure",), "bar"), ("P", ("pressure",), ""), ("force std [N]", (), "N"),
        ("supply pressure [bar]", (), "bar"), ("Force at 600 kPa [N]", ("force",), "N"),
        ("Contraction [%]", ("contraction",), "%"), ("F / kN", ("force",), "kN"), ("Displacement [mm]", (), "mm"),
        ("Force (Channel 1) [N]", ("force",), "N"),
        ("muscle", ("test",), ""), ("Time (s)", (), "s"), ("Pull, N", ("force",), "N"),
    ],
)  # fmt: skip
def test_heads(text: str, readings: tuple[str, ...], unit: str) -> None:
    head = read_head(text)
    assert (head.readings, head.unit) == (readings, unit)


@pytest.mark.parametrize(
    ("head", "pressure", "options", "gauge"),
    [
        ("pressure [bar]", 3.0, {}, 3e5), ("pressure abs [bar]", 3.0, {}, 198675.0), ("p (bara)", 3.0, {}, 198675.0),
        ("p [psig]", 10.0, {}, 68947.57293), ("pressure [Pa]", 2e5, {"absolute": True}, 98675.0),
        ("absolute pressure (kPa)", 300.0, {"atmosphere": "95 kPa"}, 205e3),
        ("pressure [bar]", 3, {"absolute": False}, 3e5),
        ("pressure [MPa]", 0.3, {}, 3e5), ("pressure [hPa]", 3000, {}, 3e5),
    ],
)  # fmt: skip
def test_absolute_and_gauge(head: str, pressure: float, options: dict[str, Any], gauge: float) -> None:
    data = mk.read_data({head: [pressure] * 2, "length [m]": [1, 2], "force [N]": [1, 2]}, **options)
    np.testing.assert_allclose(data.pressure, gauge, rtol=1e-9)
    said = any("taken as gauge" in note for note in data.assumptions)
    assert said == (head in ("pressure [bar]", "pressure [MPa]", "pressure [hPa]") and not options)


def test_hung_masses_signs_and_missing_units_are_told() -> None:
    data = mk.read_data({"p [bar]": [1, 1], "length [mm]": [80, 90], "mass hung [g]": [0, 500]})
    np.testing.assert_allclose(data.force, [0.0, 0.5 * 9.80665])
    assert "force: g taken as the weight of a mass, with 9.80665 m/s^2" in data.assumptions
    data = mk.read_data({"p [bar]": [1, 1], "length [mm]": [80, 90], "force": [0, -5]}, reverse=["force"])
    assert data.force.tolist() == [0.0, 5.0]
    assert "unit of force taken as N: the file says none" in data.assumptions


def test_contraction_extension_and_length() -> None:
    muscle = mk.presets.paper()  # 85 mm long
    table = {"p [bar]": [1, 1], "F [N]": [0, 5]}
    for head, values in (("contraction [%]", [0, 25]), ("contraction", [0.0, 0.25])):
        data = mk.read_data(table | {head: values})
        assert data.measured == "contraction"
        np.testing.assert_allclose(data.lengths(muscle), [0.085, 0.75 * 0.085])
        with pytest.raises(mk.SpecError, match=r"data\.length: .*rest_length"):
            data.length  # noqa: B018
        told = mk.read_data(table | {head: values}, held={"rest_length": "100 mm"})
        np.testing.assert_allclose(told.length, [0.1, 0.075])
        np.testing.assert_allclose(told.lengths(muscle), [0.1, 0.075])
    data = mk.read_data(table | {"extension [mm]": [0, 4]})
    with pytest.raises(mk.SpecError, match="free_length"):
        data.lengths(muscle)
    np.testing.assert_allclose(data.lengths(muscle, free_length="60 mm"), [0.06, 0.064])
    np.testing.assert_allclose(data.lengths(muscle, free_length=[0.05, 0.06]), [0.05, 0.064])
    told = mk.read_data(table | {"extension [mm]": [0, 4], "free length [mm]": [60, 60]})
    np.testing.assert_allclose(told.length, [0.06, 0.064])
    np.testing.assert_allclose(told.extension, [0.0, 0.004])
    lengths = mk.read_data(table | {"length [mm]": [80, 90], "rest length [mm]": [100, 100]})
    np.testing.assert_allclose(lengths.contraction, [0.2, 0.1])
    with pytest.raises(mk.SpecError, match="above 1"):
        mk.read_data(table | {"contraction": [0, 25]})


def test_length_and_contraction_that_say_the_same() -> None:
    data = mk.read_data({"p [bar]": [1, 1], "F [N]": [0, 5], "length [mm]": [80, 60], "contraction": [0.2, 0.4]})
    assert data.measured == "length"
    assert any("says what the length says" in note for note in data.assumptions)
    with pytest.raises(mk.SpecError, match=r'which of them was measured: "length \[mm\]" and "contraction"\?; say'):
        mk.read_data({"p [bar]": [1, 1], "F [N]": [0, 5], "length [mm]": [80, 60], "contraction": [0.2, 0.3]})


PULLS = np.concatenate([np.linspace(80, 100, 21), np.linspace(99, 80, 20)])
"""Out and back."""


def test_tests_and_branches_are_told_apart(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    rows = [(P + 0.004 * rng.normal(), h, P * (h - 78)) for P in (1, 2, 3) for h in PULLS]
    text = "pressure [bar],length [mm],force [N]\n" + "".join(f"{P:.4f},{h},{F}\n" for P, h, F in rows)
    data = mk.read_data(written(tmp_path, text))
    assert data.tests == ("1 bar", "2 bar", "3 bar")
    assert "tests: told apart by pressure, which takes 3 values" in data.assumptions
    one = data["2 bar"]
    assert len(one) == 41
    assert np.ptp(one.pressure) > 0.0
    np.testing.assert_allclose(one.branch("loading").length, 1e-3 * PULLS[:21], rtol=1e-15)
    np.testing.assert_allclose(one.branch("unloading").length, 1e-3 * PULLS[21:], rtol=1e-15)
    assert one.rows[0] == 43
    with pytest.raises(mk.SpecError, match="did you mean"):
        data["2bar"]
    with pytest.raises(mk.SpecError, match="must be one of loading"):
        data.branch("lading")
    assert mk.read_data(written(tmp_path, text), tests="file").tests == ("bench",)


def test_a_column_may_name_tests_and_branches() -> None:
    table = {
        "specimen": ["A", "A", "B", "B"], "direction": ["up", "down", "up", "down"], "p [bar]": [1, 1, 1, 1],
        "l [mm]": [1, 2, 3, 4], "F [N]": [1, 2, 3, 4], "batch": ["x", "y", "x", "y"],
    }  # fmt: skip
    data = mk.read_data(table)
    assert data.tests == ("A", "B")
    assert data.branches.tolist() == ["loading", "unloading"] * 2
    assert mk.read_data(table, tests="batch")["y"].force.tolist() == [2.0, 4.0]
    assert mk.read_data(table, columns={"test": "batch"}).tests == ("x", "y")
    with pytest.raises(mk.SpecError, match='row 2, column "direction" = sideways: must be "loading" or "unloading"'):
        mk.read_data(table | {"direction": ["up", "sideways", "up", "down"]})


def test_isometric_tests_are_told_apart_by_their_length() -> None:
    P = np.tile(np.linspace(0, 2, 11), 3)
    h = np.repeat([90.0, 100.0, 110.0], 11)
    data = mk.read_data({"pressure [bar]": P, "length [mm]": h, "force [N]": P * h})
    assert data.tests == ("90 mm", "100 mm", "110 mm")
    assert set(data.branches) == {"loading"}


def test_levels_that_differ_by_rounding_are_one() -> None:
    """As the pressures of a computed curve do."""
    pressure = 1e5 * (1.0 + 2e-16 * np.array([0, 1, 0, 1, 1, 0, 1, 0]))
    assert len(set(pressure.tolist())) == 2
    table = {"pressure [Pa]": pressure, "length [mm]": np.linspace(80, 90, 8), "force [N]": np.linspace(5, 60, 8)}
    assert mk.read_data(table).tests == ("1 bar",)


def test_a_staircase_of_pressures_is_one_test() -> None:
    P = np.repeat([0.0, 1.0, 2.0, 3.0, 2.0, 1.0, 0.0], 10)
    h = 100.0 - 8.0 * P + np.tile(np.linspace(0, 0.1, 10), 7)
    data = mk.read_data({"pressure [bar]": P, "length [mm]": h, "force [N]": np.zeros(70)})
    assert data.tests == ("table",)
    assert data.branches[0] == "loading"
    assert data.branches[-1] == "unloading"


def test_readings_of_a_sensor_are_one_level(tmp_path: Path) -> None:
    table = {"pressure [bar]": [1 + 0.001 * (k % 3) for k in range(30)], "length [mm]": range(80, 110)}
    data = mk.read_data(table | {"force [N]": range(30)})
    assert data.tests == ("1 bar",)
    near = {"pressure [bar]": [4.9] * 10 + [5.0] * 10, "length [mm]": [*range(10)] * 2, "force [N]": range(20)}
    assert mk.read_data(near).tests == ("4.9 bar", "5 bar")
    both = mk.read_data([pd.DataFrame(near)] * 2)
    assert len(set(both.tests)) == 4
    few = mk.read_data({"p [bar]": [1, 1, 2, 2], "l [mm]": [80, 90, 80, 90], "F [N]": [0, 1, 2, 3]})
    assert any("taken as one" in note for note in few.assumptions)


def test_files_are_tests_of_their_own(tmp_path: Path) -> None:
    text = "Extension [mm],Load [N]\n0,0\n1,2\n2,5\n"
    files = [written(tmp_path, text, f"{k} bars.csv") for k in (3, 4)]
    held = {"pressure": {"3 bars": "3 bar", "4 bars": "4 bar"}, "free_length": "600 mm"}
    data = mk.read_data(files, held=held)
    assert data.tests == ("3 bars", "4 bars")
    assert data["4 bars"].pressure.tolist() == [4e5] * 3
    assert data.rows.tolist() == [2, 3, 4, 2, 3, 4]
    with pytest.raises(mk.SpecError, match=r'held.pressure: says nothing of the test "4 bars"'):
        mk.read_data(files, held={"pressure": {"3 bars": "3 bar"}})
    with pytest.raises(mk.SpecError, match="the files measured different things"):
        mk.read_data([files[0], written(tmp_path, "p [bar],l [mm],F [N]\n3,1,2\n")], held={"pressure": "3 bar"})


def test_turns_of_noisy_ways_and_points_without_order() -> None:
    rng = np.random.default_rng(2)
    way = np.concatenate([np.linspace(0, 1, 500), np.linspace(1, 0.2, 400), np.linspace(0.2, 1, 400)])
    rising = loading(way + 2e-3 * rng.normal(size=len(way)))
    assert rising is not None
    wanted = np.repeat([True, False, True], [500, 400, 400])
    assert np.mean(rising == wanted) > 0.98
    assert loading(rng.permutation(np.linspace(0, 1, 200))) is None
    data = mk.read_data({"p [bar]": [1] * 40, "l [mm]": rng.permutation(40), "F [N]": range(40)})
    assert set(data.branches) == {"unknown"}
    assert any("no order" in note for note in data.assumptions)


def test_rows_without_a_number_are_left_out_and_told(tmp_path: Path) -> None:
    data = mk.read_data(written(tmp_path, PLAIN + "1,,40\n1,NaN,50\n1,110,n/a\n1,120,60\n"))
    assert data.rows.tolist() == [2, 3, 4, 8]
    assert any(
        note == "3 rows without a number left out: the first is line 5, without length" for note in data.assumptions
    )


WRONG = {
    "a text for a number": (PLAIN + "1,abc,2\n", r'bench.csv, line 5, column "length \[mm\]" = abc: must be a number'),
    "infinity": (PLAIN + "1,80,inf\n", r'line 5, column "force \[N\]" = inf: must be a number'),
    "no pressure": (
        "length [mm],force [N]\n1,2\n",
        r'bench.csv, line 1: has no column of pressure .*held=\{"pressure": "3 bar"\}',
    ),
    "no length": (
        "p [bar],Displacement [mm],force [N]\n1,1,2\n",
        r'no column of length, .*columns=\{"length": "Displacement \[mm\]"\}',
    ),
    "an unknown unit": (
        PLAIN.replace("[N]", "[Nwt]"),
        r'column "force \[Nwt\]": has an unknown unit "Nwt".*units=\{"force": "N"\}',
    ),
    "a wrong unit": (PLAIN.replace("[bar]", "[V]"), r'column "pressure \[V\]": has the wrong kind of unit, "V"'),
    "a length without a unit": (
        PLAIN.replace(" [mm]", ""),
        r'column "length": the length has no unit; .*\(--unit length="mm"\)',
    ),
    "two forces": (
        PLAIN.replace("\n", ",1\n").replace("[N],1", "[N],load cell [N]"),
        r'could be the force: "force \[N\]" and "load cell \[N\]"; say columns=',
    ),
    "nothing": ("", "bench.csv: is empty"),
    "blanks": (" \n\n", "bench.csv: is empty"),
    "heads only": (PLAIN.partition("\n")[0] + "\n", "bench.csv: "),
    "no heads": (PLAIN.partition("\n")[2], "bench.csv: has no row of heads"),
    "a picture": (b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR", "bench.csv: is no table of text"),
    "prose": ("It was a dark\nand stormy night\n", "bench.csv: "),
    "too many cells": (
        PLAIN + "1,5,80,0,2\n",
        r"bench.csv, line 5: has 5 cells, the heads \(line 1\) are 3; numbers with decimal commas",
    ),
    "a strain": (
        PLAIN.replace("length [mm]", "Strain [%]"),
        r'no column of length, .*columns=\{"contraction": "Strain \[%\]"\} .* with reverse=',
    ),
    "no whole row": ("p [bar],l [mm],F [N]\n1,,2\n1,,3\n", "no row has a number in every column"),
    "a doubtful comma": (
        "p [bar];l [mm];F [N]\n1;80;1,234\n",
        r'"1,234" may have a decimal comma or thousands marked; say decimal=',
    ),
    "mixed marks": (
        "p [bar];l [mm];F [N]\n1;80;1,5\n1;80;1.5\n",
        r'line 3.*= 1.5: must be a number; its decimal mark was taken to be ","',
    ),
    "above one": ("p [bar];contraction;F [N]\n1;12;1.5\n", "above 1"),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_what_is_wrong_is_named(tmp_path: Path, wrong: str) -> None:
    text, said = WRONG[wrong]
    with pytest.raises(mk.SpecError, match=said):
        mk.read_data(written(tmp_path, text))


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"columns": {"forse": "force"}}, r'columns = forse: is no quantity of a bench; did you mean "force"\?'),
        ({"columns": {"force": "Kraft"}}, "columns.force = Kraft: is no column of bench.csv"),
        ({"columns": {"force": 9}}, "columns.force = 9: bench.csv has the columns 1 to 3"),
        ({"units": {"force": "mm"}}, 'units.force: has the wrong kind of unit, "mm"'),
        ({"held": {"pressure": "3 N"}}, "held.pressure = 3 N: has the wrong kind"),
        ({"held": {"length": "3 mm", "contraction": 0.1}}, "only one of length"),
        ({"tests": "moon"}, "columns.test = moon: is no column"),
        ({"tests": "force"}, "tests = force: must be pressure, length, file"),
        ({"header": 9}, "header = 9: is no line"),
        ({"decimal": ";"}, "decimal = ;"),
        ({"sheet": "x"}, "has no sheets"),
        ({"atmosphere": "1 m"}, "atmosphere = 1 m"),
        ({"reverse": ["fource"]}, "reverse = fource"),
    ],
)
def test_what_is_asked_wrongly_is_named(tmp_path: Path, options: dict[str, Any], said: str) -> None:
    with pytest.raises(mk.SpecError, match=said):
        mk.read_data(written(tmp_path, PLAIN), **options)


def test_files_that_are_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(mk.SpecError, match="no such file"):
        mk.read_data(tmp_path / "none.csv")
    with pytest.raises(mk.SpecError, match="is a folder"):
        mk.read_data(tmp_path)
    with pytest.raises(mk.SpecError, match="at least one file"):
        mk.read_data([])
    with pytest.raises(mk.SpecError, match=r"must be the path of a file, a list of them, or a pandas\.DataFrame"):
        mk.read_data(3)
    with pytest.raises(mk.SpecError, match="table: is empty"):
        mk.read_data(pd.DataFrame())
    monkeypatch.setattr("mckibben.data.text.MOST", 10)
    with pytest.raises(mk.SpecError, match="is too large"):
        mk.read_data(written(tmp_path, PLAIN))


def test_a_header_line_may_be_told(tmp_path: Path) -> None:
    text = "force,count\n7,8\n9,10\n" + PLAIN
    with pytest.raises(mk.SpecError):
        mk.read_data(written(tmp_path, text))
    same(mk.read_data(written(tmp_path, text), header=4, columns={"force": "3"}))


def test_a_dataset_never_changes_and_is_compared_by_value() -> None:
    data = mk.read_data({"p [bar]": [1, 1], "l [mm]": [80, 90], "F [N]": [0, 5]})
    with pytest.raises(ValueError, match="read-only"):
        data.force[0] = 1.0
    with pytest.raises(AttributeError):
        data.force = np.zeros(2)
    assert data == mk.read_data({"p [bar]": [1, 1], "l [mm]": [80, 90], "F [N]": [0, 5]})
    assert data != mk.read_data({"p [bar]": [1, 1], "l [mm]": [80, 90], "F [N]": [0, 6]})
    assert repr(data) == "<Data: 2 points of 1 test (1 bar), length measured, force 0 to 5 N>"


def test_many_rows_are_read_whole_and_thinned_to_the_same_curve(tmp_path: Path) -> None:
    x = np.concatenate([np.linspace(0, 50, 50_000), np.linspace(50, 0, 50_000)])
    rng = np.random.default_rng(3)
    force = 0.02 * x**2 + np.repeat([0.0, -2.0], 50_000) * np.minimum(1, np.abs(50 - x))
    table = pd.DataFrame({"Extension [mm]": x, "Load [N]": force + 0.05 * rng.normal(size=len(x))})
    table.to_csv(tmp_path / "long.csv", index=False)
    data = mk.read_data(tmp_path / "long.csv", held={"pressure": "3 bar", "free_length": "60 cm"})
    np.testing.assert_array_equal(data.force, table["Load [N]"])
    assert len(data.branch("loading")) == 50_000
    few = data.decimated(41)
    assert len(few) == 82
    assert set(few.branches) == {"loading", "unloading"}
    for branch, shift in (("loading", 0.0), ("unloading", -2.0)):
        part, whole = few.branch(branch), data.branch(branch)
        assert (part.extension[0], part.extension[-1]) == (whole.extension[0], whole.extension[-1])
        assert (part.force[0], part.rows[-1]) == (whole.force[0], whole.rows[-1])
        h = 1e3 * part.extension
        exact = 0.02 * h**2 + shift * np.minimum(1, np.abs(50 - h))
        assert np.abs(part.force - exact)[2:-2].max() < 0.03  # means: less than the noise of a point
    assert data.decimated(200_000).force.tolist() == data.force.tolist()
    with pytest.raises(mk.SpecError, match="at least 3"):
        data.decimated(2)


def curve(kind: str, count: int = 21) -> Any:
    """A result of the paper's muscle: solved once, coarse."""
    muscle = mk.presets.paper()
    tests = {
        "isobaric": mk.Isobaric(pressure="1 bar", length="115 mm to 60 mm", points=6),
        "isometric": mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=6),
        "free": mk.FreeContraction(pressure="0.1 to 1 bar", points=6),
    }
    return mk.run(muscle, tests[kind], tolerance=1e-4)


@pytest.fixture(scope="module")
def curves() -> dict[str, Any]:
    return {kind: curve(kind) for kind in ("isobaric", "isometric", "free")}


def bench(result: Any, shift: float, extra: float = 0.0) -> mk.Data:
    """Points on the curve of an isobaric result, shifted in force."""
    h = np.linspace(0.062, 0.113, 40)
    force = np.interp(h, result.length[::-1], result.force[::-1]) + shift
    if extra:
        h, force = np.append(h, [extra, extra + 1e-3]), np.append(force, [0.0, 0.0])
    return mk.read_data({"p [bar]": np.ones(len(h)), "length [m]": h, "force [N]": force})


def test_differences_are_those_of_the_curve(curves: dict[str, Any]) -> None:
    found = compare(curves["isobaric"], bench(curves["isobaric"], 2.0, 0.12))
    assert found.outside == 2
    np.testing.assert_allclose(found.differences, -2.0, rtol=1e-9)
    assert found.rms == pytest.approx(2.0)
    assert found.percent(2.0) == pytest.approx(200.0 / np.abs(found.measured).max())
    said = str(found)
    for words in ("rms 2 N (", "% of the largest measured", "largest difference -2 N (", "2 of 42 points outside"):
        assert words in said
    with pytest.raises(mk.SpecError, match="no point has the pressure of the curve, 1 bar: they have 2 bar"):
        compare(curves["isobaric"], mk.read_data({"p [bar]": [2, 2], "l [mm]": [80, 90], "F [N]": [0, 5]}))


def test_a_curve_that_turns_is_compared_way_by_way() -> None:
    xs, ys = np.array([0.0, 1.0, 2.0, 1.0, 0.0]), np.array([0.0, 1.0, 2.0, 0.5, 0.0])
    x, rising = np.array([1.0, 1.0, 3.0]), np.array([True, False, True])
    found = difference(xs, ys, x, np.zeros(3), rising, "N", "m")
    assert found.differences.tolist() == [1.0, 0.5]
    assert found.outside == 1


def test_contractions_are_compared_where_the_force_is_held(curves: dict[str, Any]) -> None:
    free = curves["free"]
    table = {"p [Pa]": free.pressure, "length [m]": free.length + 1e-3, "force [N]": np.full(6, 0.1)}
    found = compare(free, mk.read_data(table))
    np.testing.assert_allclose(found.differences, 1e-3 / 0.085, rtol=1e-9)
    assert "%" in str(found)
    assert " N" not in str(found)


def test_points_are_drawn_over_a_curve(curves: dict[str, Any]) -> None:
    result = curves["isobaric"]
    data = bench(result, 2.0)
    figure = mk.plot(result, data=data)
    (points,) = [line for line in figure.axes[0].lines if line.get_label() == "measured"]
    np.testing.assert_allclose(points.get_ydata(), data.force)
    np.testing.assert_allclose(points.get_xdata(), 100.0 * (1.0 - data.length / 0.085))
    note = figure.get_supxlabel().replace("\n", " ")
    assert "Model less measured (table): rms 2 N" in note
    assert "assumed" in note
    assert [text.get_text() for text in figure.axes[0].get_legend().get_texts()][:2] == ["model", "measured"]
    both = mk.plot({"one": result, "two": result}, data=data)
    assert both.get_supxlabel().replace("\n", " ").count("rms 2 N") == 2
    with pytest.raises(mk.SpecError, match=r"plot\.data = 3"):
        mk.plot(result, data=3)
    with pytest.raises(mk.SpecError, match="has no room"):
        mk.plot(result, kind="energy", data=data)
    with pytest.raises(mk.SpecError, match="goes with a result"):
        mk.plot(mk.presets.paper(), data=data)


def test_data_that_are_shared_are_read() -> None:
    if not SHARED.is_dir():
        pytest.skip("needs the measured data beside the repository (../shared/data)")
    big = mk.read_data(SHARED / "quadsegrity" / "big_isobaric.csv")
    assert (big.tests, big.measured) == (("3 bar", "4 bar", "5 bar", "6 bar"), "extension")
    assert set(big.branches) == {"loading"}
    np.testing.assert_allclose(big["3 bar"].length[[0, -1]], [0.66, 0.699356])
    np.testing.assert_allclose(big["6 bar"].contraction[0], 1.0 - 624.0 / 850.0)
    raw = mk.read_data(SHARED / "quadsegrity" / "raw_head_big_3bar.csv", held={"pressure": "3 bar"})
    assert (len(raw), raw.rows[0], raw.measured) == (298, 3, "extension")
    assert raw.force[0] == 0.01866
    festo = mk.read_data(SHARED / "martens_boblan" / "dmsp-20-300.csv")
    assert (len(festo), len(festo.tests), festo.measured) == (126, 21, "length")
    folder = SHARED / "festo_length"
    asked = {"columns": {"length": "held_length_mm"}, "units": {"force": "N"}, "held": {"pressure": "600 kPa"}}
    aarl = mk.read_data(folder / "aarl_festo10mm_isometric.csv", tests="rest_length_mm", **asked)
    assert len(aarl.tests) == 6
    np.testing.assert_allclose(aarl.contraction[:2], [0.0, 0.0392], atol=1e-4)
    with pytest.raises(mk.SpecError, match="has no column of pressure"):
        mk.read_data(folder / "aarl_festo10mm_isometric_hysteresis.csv")


def test_a_sample_is_read_from_a_folder(tmp_path: Path) -> None:
    with pytest.raises(mk.SpecError, match="is no known set"):
        mk.sample_data("festo")
    with pytest.raises(mk.SpecError, match=r"its files .* are not in .*; fetch them with download=True, or get them"):
        mk.sample_data("quadsegrity", tmp_path)
    for name in ("3 bars.csv", "6 bars.csv"):
        written(tmp_path, PULLED, name)
    data = mk.sample_data("quadsegrity", folder=tmp_path)
    assert data.tests == ("3 bars", "6 bars")
    np.testing.assert_allclose(data["6 bars"].length, [0.624, 0.625, 0.626, 0.627, 0.628])
    assert "MIT" in data.assumptions[0]


PULLED = "Time,Extension,Load\n(s),(mm),(N)\n" + "".join(f'"{0.1 * k:.5f}","{k:.5f}","{2 * k:.5f}"\n' for k in range(5))


@pytest.fixture
def published(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[list[str]]:
    """The files at addresses of this machine, in place of their authors'; what was asked for."""
    asked = []

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            asked.append(self.path)
            self.send_response(200)
            self.end_headers()
            self.wfile.write(PULLED.encode())

        def log_message(self, *_: object) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    sample = attrs.evolve(samples.SAMPLES["quadsegrity"], root=f"http://127.0.0.1:{server.server_port}/at")
    monkeypatch.setitem(samples.SAMPLES, "quadsegrity", sample)
    monkeypatch.setattr(samples, "place_of", lambda name: tmp_path / name)
    yield asked
    server.shutdown()
    server.server_close()
    thread.join()


def test_a_sample_is_fetched_once(published: list[str], tmp_path: Path) -> None:
    """Each file from a commit; from then on it is what it was, and no connection is needed."""
    pytest.importorskip("pooch")
    data = mk.sample_data("quadsegrity", download=True)
    assert data.tests == ("3 bars", "4 bars", "5 bars", "6 bars")
    assert len(published) == 4
    address = r"/at/[0-9a-f]{40}/[eE]xperiences/session1/McKibbenBig/\d%20bars\.csv"
    assert all(re.fullmatch(address, asked) for asked in published)
    again = mk.sample_data("quadsegrity", download=True), mk.sample_data("quadsegrity")
    assert len(published) == 4
    assert [one.tests for one in again] == [data.tests] * 2
    folder = tmp_path / "quadsegrity"
    known = (folder / "checksums.txt").read_text(encoding="utf-8").splitlines()
    assert known[0] == f"{hashlib.sha256(PULLED.encode()).hexdigest()}  3 bars.csv"
    (folder / "3 bars.csv").write_text(PULLED.replace("2.0", "9.0"), encoding="utf-8")
    with pytest.raises(mk.SpecError, match=r"3 bars\.csv: in .* is not the file that was fetched.*; delete it"):
        mk.sample_data("quadsegrity")
    (folder / "3 bars.csv").unlink()
    assert mk.sample_data("quadsegrity", download=True).tests == data.tests
    assert len(published) == 5
    (folder / "4 bars.csv").unlink()
    (folder / "checksums.txt").write_text("\n".join([known[0], "0" * 64 + known[1][64:]]), encoding="utf-8")
    with pytest.raises(mk.SpecError, match=r"4 bars\.csv: at http.* is no longer what it was"):
        mk.sample_data("quadsegrity", download=True)
    assert not (folder / "4 bars.csv").exists()


def test_a_sample_without_a_connection(published: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pooch")
    nowhere = attrs.evolve(samples.SAMPLES["quadsegrity"], root="http://127.0.0.1:9/at")
    monkeypatch.setitem(samples.SAMPLES, "quadsegrity", nowhere)
    with pytest.raises(mk.SpecError, match=r"cannot be fetched from http.*; go online, or give the folder= that holds"):
        mk.sample_data("quadsegrity", download=True)
    monkeypatch.setitem(sys.modules, "pooch", None)
    with pytest.raises(mk.SpecError, match=r"takes pooch; pip install \"mckibben\[lab\]\", or give"):
        mk.sample_data("quadsegrity", download=True)


def invoke(*words: object) -> Any:
    from typer.testing import CliRunner

    from mckibben.app.cli import app

    return CliRunner().invoke(app, [str(word) for word in words], env={"COLUMNS": "120"})


def test_the_command_shows_what_was_understood(tmp_path: Path) -> None:
    path = written(tmp_path, "p;Weg (mm);Kraft\n1,0;80;0\n1,0;90;1,5\n1,0;80;0,2\n")
    options = ("--column", "length=Weg", "--unit", "pressure=bar", "--unit", "force=kg")
    done = invoke("data", "check", path, *options)
    assert done.exit_code == 0, done.stderr
    for words in ("bench.csv", "1 bar", "2 loading, 1 unloading", "80 to 90 mm", "0 to 14.71 N", "taken as gauge"):
        assert words in done.stdout
    told = json.loads(invoke("data", "check", path, *options, "--absolute", "--atmosphere", "1 bar", "--json").stdout)
    assert told["measured"] == "length"
    assert told["tests"][0]["pressure"] == [0.0, 0.0]
    refused = invoke("data", "check", path, "--json")
    assert refused.exit_code == 2
    assert json.loads(refused.stdout)["error"]["field"] == "bench.csv, line 1"
    assert refused.stderr.count("\n") == 1
    assert "NAME=VALUE" in invoke("data", "check", path, "--unit", "kg").stderr


def test_the_command_draws_points_over_a_saved_curve(curves: dict[str, Any], tmp_path: Path) -> None:
    result = curves["isobaric"]
    mk.save(result, tmp_path / "out.nc")
    bench(result, 2.0, 0.12).to_pandas().drop(columns=["row"]).to_csv(tmp_path / "bench.csv", index=False)
    done = invoke("plot", tmp_path / "out.nc", "--data", tmp_path / "bench.csv")
    assert done.exit_code == 0, done.stderr
    assert "model less measured: rms 2 N (" in done.stdout
    assert "2 of 42 points outside" in done.stdout
    assert (tmp_path / "out.png").read_bytes().startswith(b"\x89PNG")
    other = invoke("plot", tmp_path / "out.nc", "--force", "--data", tmp_path / "bench.csv", "--held", "pressure=2 bar")
    assert other.exit_code == 2
    assert "no point has the pressure of the curve" in other.stderr

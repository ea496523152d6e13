"""Input that stood out as bad in trials: each gets a word that helps, or is taken for what it plainly is."""

import math
from pathlib import Path

import pytest
from matplotlib.figure import Figure
from texts import CASE
from typer.testing import CliRunner

import mckibben as mk
from mckibben.app.cli import app
from mckibben.experiments import limits
from mckibben.files.case import read_mapping
from mckibben.paper import reproduce as making
from mckibben.paper.measured import read_measured
from mckibben.spec import Path as Held
from mckibben.sweeps.plan import plan
from mckibben.units import UnitError, to_si

pytestmark = pytest.mark.experiments

PAPER = mk.presets.paper()
TEST = mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3)
MARK = b"\xef\xbb\xbf"
"""The byte order mark that some editors put before text."""


def test_a_case_file_with_a_mark_before_the_text(tmp_path: Path) -> None:
    plain, marked = tmp_path / "plain.toml", tmp_path / "marked.toml"
    plain.write_text(CASE, encoding="utf-8")
    marked.write_bytes(MARK + CASE.encode())
    assert read_mapping(marked) == read_mapping(plain)


@pytest.mark.parametrize(
    ("line", "advice"),
    [("radius = 0.0125;", 'a line of TOML ends without ";"'), ("radius = 12,5", "write a decimal point")],
)
def test_the_habits_of_other_languages(tmp_path: Path, line: str, advice: str) -> None:
    (tmp_path / "case.toml").write_text(f"[muscle.braid]\n{line}\n", encoding="utf-8")
    with pytest.raises(mk.SpecError) as caught:
        read_mapping(tmp_path / "case.toml")
    assert "is not valid TOML" in str(caught.value)
    assert advice in str(caught.value)


@pytest.mark.parametrize(
    ("text", "pointed"),
    [("12,5 mm", "12.5 mm"), ("-0,25 bar", "-0.25 bar"), ("12,5", "12.5"), ("1,5 mm wide", "1.5 mm")],
)
def test_a_decimal_comma(text: str, pointed: str) -> None:
    with pytest.raises(UnitError, match="has a comma in its number") as caught:
        to_si(text, "m")
    assert caught.value.advice.startswith(f'write a decimal point: "{pointed}')
    with pytest.raises(mk.SpecError, match=r'write a decimal point: "12.5 mm"'):
        PAPER.replace("braid.radius", "12,5 mm")


@pytest.mark.parametrize("mark", [b"", MARK])
def test_tables_from_spreadsheets(tmp_path: Path, mark: bytes) -> None:
    """With a mark before the text, and with semicolons between the cells."""
    file = tmp_path / "designs.csv"
    file.write_bytes(mark + b"# measured; in May\nbraid.angle [deg];ends\n36;clamped\n\n37.5;pinned\n")
    made = plan(PAPER, TEST, designs=file)
    assert [made.row(k)[1] for k in range(2)] == ["clamped", "pinned"]
    assert math.degrees(made.row(1)[0]) == pytest.approx(37.5)
    file.write_bytes(mark + b"braid.angle [deg];ends\n36,5;clamped\n")
    with pytest.raises(
        mk.SpecError, match=r'row 1 = 36,5 deg: has a comma in its number; write a decimal point: "36.5'
    ):
        plan(PAPER, TEST, designs=file)
    lab = tmp_path / "lab.csv"
    lab.write_bytes(mark + b"pressure;value\n0;3\n1;90.5\n")
    assert read_measured(lab, "a", "115 mm").force.tolist() == [3.0, 90.5]
    lab.write_bytes(mark + b"pressure;value\n0;3\n1;90,5\n")
    assert read_measured(lab, "a", "115 mm").force.tolist() == [3.0, 90.5]


def test_more_designs_than_anyone_can_solve() -> None:
    axis = {"from": "30 deg", "to": "50 deg", "points": 10_000}
    thin = {"from": "1 mm", "to": "2 mm", "points": 10_000}
    over = {"braid.angle": axis, "chamber.thickness": thin, "braid.fibre.diameter": thin}
    with pytest.raises(mk.SpecError) as caught:
        mk.sweep(PAPER, TEST, over)
    said = str(caught.value)
    assert said.startswith("sweep: 1,000,000,000,000 designs of 3 states, some 32 years at 1,000 designs a second and ")
    assert "GB: at most 100,000,000 are taken" in said
    with pytest.raises(mk.SpecError, match=r"over\.braid\.angle\.points = 10+: must be at most 10,000,000"):
        plan(PAPER, TEST, {"braid.angle": axis | {"points": 10**12}})
    many = {"braid.angle": axis, "ends": ["pinned", "clamped", "free"] * 1000}
    with pytest.raises(mk.SpecError, match=r"too much to keep in memory; give a store, to="):
        mk.sweep(PAPER, TEST, many, workers=0)


def test_a_failed_state_shows_what_was_asked_for() -> None:
    state = mk.solve(PAPER, length="130 mm", pressure="1 bar")
    assert repr(state) == (
        "<State: no equilibrium, asked for length 130 mm and pressure 1 bar: "
        "the fibres are straight at 128.7786 mm, the longest possible length>"
    )


def test_no_least_pressure_says_why() -> None:
    with pytest.warns(mk.MuscleWarning, match="no least pressure: no equilibrium: the fibres are straight at 128.7"):
        none = mk.least_pressure(PAPER, length="130 mm")
    assert math.isnan(none)
    assert "the longest possible length" in none.reason
    assert limits.Pressure(2.0).reason == ""
    assert limits.Pressure(2.0) == 2.0


def test_a_least_pressure_that_was_not_found_says_how_far_it_was_sought(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "holding", lambda *_, **__: math.nan)
    with pytest.warns(mk.MuscleWarning, match="no pressure up to 4.2e.04 bar holds 20 mm"):
        assert math.isnan(mk.least_pressure(PAPER, length=Held((0.02,), unit="m")))


@pytest.mark.parametrize("given", [None, 3.0, "out.nc", PAPER, [1, 2]])
def test_what_is_no_result_is_neither_drawn_nor_saved(given: object, tmp_path: Path) -> None:
    with pytest.raises(mk.SpecError, match=r"plot = .*: must be a result of run, solve"):
        mk.plot(given)
    with pytest.raises(mk.SpecError, match=r"save = .*: must be what run, solve, .*gave"):
        mk.save(given, tmp_path / "out.nc")
    assert not (tmp_path / "out.nc").exists()


def test_states_are_drawn_and_saved(tmp_path: Path) -> None:
    """Also one that was not reached: the picture says why."""
    state = mk.solve(PAPER, length="130 mm", pressure="1 bar")
    assert isinstance(mk.plot(state), Figure)
    assert mk.load(mk.save(state, tmp_path / "state.nc")) == state.result
    with pytest.raises(mk.SpecError, match=r'plot\.kind = profile: is unknown; did you mean "profiles"'):
        mk.plot(state, kind="profile")
    assert [axes.get_ylabel() for axes in mk.plot(state, kind="energy").axes] == ["Energy (mJ)"]


def test_datasets_are_drawn_or_refused(tmp_path: Path) -> None:
    beyond = mk.force_map(PAPER, length=["130 mm", "131 mm"], pressure=["0.5 bar", "1 bar"])
    assert "no state" in " ".join(text.get_text() for text in mk.plot(beyond).axes[0].texts)
    with pytest.raises(mk.SpecError, match="is for a result or a state"):
        mk.plot(beyond, kind="tension")
    swept = mk.sweep(PAPER, mk.Isometric(length="130 mm", pressure="1 bar"), {"ends": ["pinned"]}, workers=0)
    assert "no state" in " ".join(text.get_text() for text in mk.plot(swept).axes[0].texts)
    with pytest.raises(mk.SpecError, match="this part of a sweep does not say how its states came out"):
        mk.plot(swept[["force"]])
    with pytest.raises(mk.SpecError, match=r'write a Dataset with data.to_netcdf\("x.nc"\)'):
        mk.save(swept, tmp_path / "out.nc")


def test_a_failed_reproduce_leaves_no_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: object, **__: object) -> None:
        raise mk.SpecError("measured.a", allowed="is no good")

    monkeypatch.setattr(making, "reproduce", fails)
    (tmp_path / "there").mkdir()
    for folder in ("new", "new/inner", "there"):
        done = CliRunner().invoke(app, ["reproduce", "-o", str(tmp_path / folder)])
        assert done.exit_code == 2
    assert [entry.name for entry in tmp_path.iterdir()] == ["there"]

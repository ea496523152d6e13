"""Designs: the best against a dense grid and against closed forms, whole numbers and choices, limits, wrong input."""

import itertools
import json
from pathlib import Path

import attrs
import numpy as np
import pytest
from typer.testing import CliRunner

import mckibben as mk
from mckibben.app.cli import app
from mckibben.designing import front
from mckibben.designing.designfile import read_design
from mckibben.designing.reading import places_of, value_of
from mckibben.designing.search import scatter
from mckibben.designing.states import states_at
from mckibben.designing.tried import Tried

pytestmark = pytest.mark.designing

PET, RUBBER = "1380 kg/m^3", "1100 kg/m^3"
AT = {"pressure": "1 bar"}
PULL = mk.ForceAt(**AT, contraction="5 %")
WIDE = mk.Diameter(**AT, between="0 to 5 %")


def muscle() -> mk.Muscle:
    """The paper's, steeper, so that it contracts."""
    return mk.presets.paper().replace("braid.angle", "46 deg")


ANGLE = {"braid.angle": "42 deg to 50 deg"}


@pytest.fixture(scope="module")
def best() -> mk.Design:
    return mk.design(muscle(), ANGLE, mk.Maximise(PULL), [WIDE <= "27 mm"], designs=64)


def worth(measures: list, muscle: mk.Muscle, **values: np.ndarray) -> list[np.ndarray]:
    """Measures of many muscles by their fields, through the batches."""
    columns = {name.replace("_", ".", 1): numbers[:, None] for name, numbers in values.items()}
    count = len(next(iter(values.values()))) if values else 1
    seen = states_at(muscle, columns, count, [place for one in measures for place in places_of(one)], 1e-6)
    assert seen is not None
    return [value_of(one, seen) for one in measures]


def test_the_best_is_that_of_a_dense_grid() -> None:
    """Two numbers, one limit: nothing on a grid of 31 x 31 is better, and the best of the grid is near."""
    free = {"braid.angle": "42 deg to 50 deg", "braid.radius": "11 mm to 14 mm"}
    found = mk.design(muscle(), free, mk.Maximise(PULL), [WIDE <= "27 mm"], designs=300)
    angle, radius = np.meshgrid(np.linspace(*np.deg2rad([42.0, 50.0]), 31), np.linspace(0.011, 0.014, 31))
    force, width = worth([PULL, WIDE], muscle(), braid_angle=angle.ravel(), braid_radius=radius.ravel())
    allowed = force[width <= 0.027]
    (most,) = found.goals.values()
    assert allowed.max() <= most * (1.0 + 1e-6)
    assert allowed.max() > 0.97 * most  # the grid is coarse
    assert found.feasible
    assert found.converged
    assert found.limits["reached"].tolist() == [True]


def test_a_mass_has_a_closed_form() -> None:
    """The lightest braid of a given room: m = rho N pi d^2/4 H0/sin(theta) and the wall's, least at the bounds."""
    mass = mk.Mass(fibre_density=PET, chamber_density=RUBBER)
    free = {"braid.angle": "42 deg to 50 deg", "chamber.thickness": "0.8 mm to 1.2 mm", "braid.fibres": "40 to 56"}
    found = mk.design(muscle(), free, mk.Minimise(mass), designs=64)
    length, area = 40 * 0.085 / np.sin(np.deg2rad(50.0)), np.pi * 0.25 * 0.00025**2
    wall = np.pi * 0.0008 * (0.0008 + 2 * 0.0125) * 0.085
    assert next(iter(found.goals.values())) == pytest.approx(1380.0 * length * area + 1100.0 * wall, rel=1e-6)
    assert found.muscle.braid.fibres == 40
    assert found.muscle.braid.angle == pytest.approx(np.deg2rad(50.0))


def test_measures_are_what_single_runs_give() -> None:
    m = muscle()
    measures = [
        PULL, mk.Stroke(**AT), mk.Stroke(**AT, force="5 N"),
        mk.PressureFor(force="30 N", contraction="5 %", up_to="2 bar"),
        mk.Work(**AT, between="0 to 5 %"), mk.ForceVariation(**AT, between="0 to 5 %"), WIDE,
        mk.FibreTension(**AT, between="0 to 5 %"), mk.AirVolume(**AT, contraction="5 %"),
        mk.CurveMiss(**AT, contractions=["0 %", "5 %"], forces=["50 N", "40 N"]),
        mk.Work(**AT, between="0 to 5 %", per="volume"),
    ]  # fmt: skip
    found = [float(value[0]) for value in worth(measures, m)]
    curve = mk.run(m, mk.Isobaric(**AT, contraction="0 to 5 %", points=101))
    work = -float(np.trapezoid(curve.force, curve.length))
    volume = np.pi * m.braid.radius**2 * m.braid.length
    expected = [
        curve.force[-1], mk.solve(m, force="0 N", **AT).contraction, mk.solve(m, force="5 N", **AT).contraction,
        mk.solve(m, force="30 N", contraction="5 %").pressure, work, np.ptp(curve.force[[0, -1]]) / curve.force.mean(),
        2.0 * (curve.data["r"].values.max() + 0.00025), curve.data["fibre_tension"].values.max(),
        curve.data["air_volume"].values[-1], np.sqrt(np.mean((curve.force[[0, -1]] - [50.0, 40.0]) ** 2)),
        work / volume,
    ]  # fmt: skip
    rtol = [1e-6, 1e-6, 1e-6, 1e-4, 1e-4, 2e-3, 1e-6, 1e-6, 1e-6, 1e-6, 1e-4]
    for one, value, wanted, tolerance in zip(measures, found, expected, rtol, strict=True):
        assert value == pytest.approx(wanted, rel=tolerance), one.said


def test_safety_room_and_weight() -> None:
    m = muscle().replace("braid.fibre.breaking_force", "20 N")
    safety, tension, room = (
        kind(**AT, between="0 to 5 %") for kind in (mk.FibreSafety, mk.FibreTension, mk.JammingMargin)
    )
    factor, pull, left = (float(value[0]) for value in worth([safety, tension, room], m))
    assert factor == pytest.approx(20.0 / pull)
    state = mk.solve(m, contraction="5 %", **AT)
    fields = state.result.data.isel(step=-1)
    k = int(fields["r"].values.argmax())
    r, theta = (float(fields[name].values[k]) for name in ("r", "theta"))
    assert left == pytest.approx(4.0 * np.pi * r * np.sin(theta) / 56 / 0.00025 - 1.0, rel=1e-6)
    steep = muscle().replace("braid.angle", "60 deg")
    made = 4.0 * np.pi * 0.0125 * np.sin(np.deg2rad(60.0)) / 56 / 0.00025 - 1.0
    assert float(worth([room], steep)[0][0]) == pytest.approx(made)


def test_the_margin_against_bowing() -> None:
    """1 + F/F_col by the closed form of a braid that hardly stores energy; it pushes, and the range has its least."""
    soft = (
        muscle().replace("chamber.law.c1", "1 Pa").replace("braid.fibre.E", "1 kPa").replace("braid.length", "200 mm")
    )
    contractions = np.linspace(0.25, 0.3, 4)
    margin = mk.StabilityMargin(**AT, between="25 to 30 %")
    forces = [mk.ForceAt(**AT, contraction=float(at)) for at in contractions]
    found, *pushes = (float(value[0]) for value in worth([margin, *forces], soft))
    h = 0.2 * (1.0 - contractions)
    theta = np.arcsin(h / 0.2 * np.sin(np.deg2rad(46.0)))
    area, steep = np.pi * (0.0125 * np.cos(theta) / np.cos(np.deg2rad(46.0))) ** 2, np.tan(theta) ** 2
    stiffness = area / np.pi * (pushes + 2.0 * area * 1e5 + area * 1e5 * steep) * steep
    left = 1.0 + pushes / (4.0 * np.pi**2 * stiffness / h**2)
    assert found == pytest.approx(left.min(), abs=1e-5)
    assert left.argmin() == 3
    assert left.max() < 0.5  # and -0.03 at 30 %: there it bows


def test_the_answer(best: mk.Design) -> None:
    assert best.muscle.braid.angle == best.values["braid.angle"]
    assert best.feasible
    state = best.solution("5 % contraction at 1 bar")
    assert state.force == pytest.approx(next(iter(best.goals.values())), rel=1e-6)
    assert best.states["verdict"].tolist() == ["stable"] * len(best.states)
    curve = best.curves
    np.testing.assert_allclose(curve["pressure" if "pressure" in curve else "curve"].values, [1e5])
    assert np.isfinite(curve["force"].values).all()
    assert best.front is None
    with pytest.raises(mk.SpecError, match="is no state of this design"):
        best.solution("nowhere")


def test_what_more_room_gives_is_what_it_gives(best: mk.Design) -> None:
    """The price of a limit against designs with half a hundredth more and less of it."""
    wider = mk.design(muscle(), ANGLE, mk.Maximise(PULL), [WIDE <= "27.135 mm"], designs=64)
    narrower = mk.design(muscle(), ANGLE, mk.Maximise(PULL), [WIDE <= "26.865 mm"], designs=64)
    (more,), (less,) = wider.goals.values(), narrower.goals.values()
    assert float(best.data["limit_gain"].values[0]) == pytest.approx(more - less, rel=0.01)
    assert any(note.startswith("at its limit: largest diameter") for note in best.notes)
    assert any("1 % more pressure everywhere would raise the force by" in note for note in best.notes)


def test_the_same_seed_gives_the_same(best: mk.Design) -> None:
    assert mk.design(muscle(), ANGLE, mk.Maximise(PULL), [WIDE <= "27 mm"], designs=64) == best


def test_what_cannot_be_met_says_what_blocks() -> None:
    found = mk.design(muscle(), ANGLE, mk.Maximise(PULL), [PULL >= "80 N", WIDE <= "27 mm"], designs=64)
    assert not found.feasible
    said = " ".join(found.notes)
    assert "cannot be met together" in said
    assert "blocks: " in said
    assert "with all other demands met the best that was tried has 36." in said  # N, where it is 27 mm wide
    assert "limits not met" in repr(found)


def test_whole_numbers_and_choices() -> None:
    """Everything is tried: six sets of options."""
    thicker = mk.Chamber(thickness="2 mm", law=mk.MooneyRivlin(c1="8.5 kPa"))
    free = {"chamber": [muscle().chamber, thicker], "braid.fibres": [40, 48, 56]}
    found = mk.design(muscle(), free, mk.Maximise(PULL), designs=64)
    every = [
        mk.solve(muscle().replace("chamber", chamber).replace("braid.fibres", fibres), contraction="5 %", **AT).force
        for chamber, fibres in itertools.product(free["chamber"], free["braid.fibres"])
    ]
    assert next(iter(found.goals.values())) == pytest.approx(max(every), rel=1e-6)
    assert found.tried <= 64
    assert np.isnan(found.values["chamber"])
    assert found.table.loc["chamber", "value"].startswith("Chamber(")


def test_designs_without_states_end_nothing() -> None:
    """Half of the range is beyond full extension of the length asked for."""
    far = mk.ForceAt(**AT, length="115 mm")
    found = mk.design(muscle(), {"braid.angle": "37 deg to 60 deg"}, mk.Maximise(far), designs=64)
    assert found.feasible
    assert any("counted as not fulfilling" in note for note in found.notes)
    with pytest.raises(mk.SpecError, match=r"none of \d+ designs has a stable state"):
        mk.design(muscle(), {"braid.angle": "57 deg to 60 deg"}, mk.Maximise(far), designs=64)


def test_an_interrupted_search_keeps_the_best(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[tuple[int, int]] = []

    def begun(tried: Tried, designs: int, seed: int) -> None:
        tried(scatter(tried.task, 32, seed))
        raise KeyboardInterrupt

    def nothing(tried: Tried, designs: int, seed: int) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("mckibben.designing.design.evolve", begun)
    found = mk.design(
        muscle(), ANGLE, mk.Maximise(PULL), [WIDE <= "27 mm"], designs=64, watch=lambda *done: told.append(done)
    )
    assert found.feasible
    assert not found.converged
    assert found.notes[0].startswith("the search was interrupted")
    assert told[0] == (32, 64)
    monkeypatch.setattr("mckibben.designing.design.evolve", nothing)
    with pytest.raises(KeyboardInterrupt):
        mk.design(muscle(), ANGLE, mk.Maximise(PULL), designs=64)


@pytest.fixture(scope="module")
def compromises() -> mk.Design:
    goals = [mk.Maximise(PULL), mk.Minimise(WIDE)]
    return mk.design(muscle(), ANGLE, goals, [PULL >= "20 N"], designs=128)


def test_a_front(compromises: mk.Design) -> None:
    """Along one number both goals rise, so that every design is on the front that pulls enough."""
    found = compromises.front
    force, width = found["force"].values, found["diameter"].values
    assert (np.diff(force) <= 0.0).all()
    assert (np.diff(width) <= 0.0).all()
    assert force.min() == pytest.approx(20.0, rel=0.02)
    ends = mk.solve(muscle().replace("braid.angle", "50 deg"), contraction="5 %", **AT)
    assert force.max() == pytest.approx(ends.force, rel=1e-4)
    member = compromises.member(3)
    assert member.braid.angle == pytest.approx(float(found["braid.angle"].values[3]))
    assert compromises.values["braid.angle"] in found["braid.angle"].values
    with pytest.raises(mk.SpecError, match="is no design of the front"):
        compromises.member(10_000)


def test_without_pymoo_a_front_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pymoo", None)
    with pytest.raises(mk.SpecError, match=r"pip install mckibben\[optimise\]"):
        front.check_pymoo()


@pytest.mark.parametrize("which", ["best", "compromises"])
def test_designs_are_loaded_as_they_were_saved(which: str, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    made = request.getfixturevalue(which)
    found = mk.load(mk.save(made, tmp_path / "design.nc"))
    assert isinstance(found, mk.Design)
    assert found == made
    assert hash(found) == hash(made)
    assert found.notes == made.notes
    with pytest.raises(mk.SpecError, match="exists"):
        mk.save(made, tmp_path / "design.nc")
    table = mk.save(made, tmp_path / "design.csv").read_text(encoding="utf-8").splitlines()
    assert table[0].startswith("braid.angle [rad],force [N]")
    assert len(table) == 1 + (1 if made.front is None else len(made.front.design))
    other = made.data.drop_vars("limit_value").assign_attrs(holds="design")
    other.to_netcdf(tmp_path / "other.nc", engine="h5netcdf")
    with pytest.raises(mk.SpecError, match="holds no limit_value of a design"):
        mk.load(tmp_path / "other.nc")


def test_pictures(best: mk.Design, compromises: mk.Design) -> None:
    curves, room = mk.plot(best).axes
    assert curves.get_xlabel() == "Contraction (%)"
    assert room.get_xlabel() == "Room left (% of the limit)"
    goals, free = mk.plot(compromises).axes
    assert goals.get_xlabel().startswith("Force at 5 % contraction and 1 bar (N)")
    assert free.get_ylabel() == "Place in its range (%)"


def test_a_stroke_against_a_force_is_drawn_at_that_force(best: mk.Design) -> None:
    limit = {"limit_kind": "stroke", "limit_at": 0.08, "limit_sign": -1.0, "limit_force": 20.0}
    data = best.data.assign({name: ("limit", [value]) for name, value in limit.items()})
    curves = mk.plot(attrs.evolve(best, data=data)).axes[0]
    (mark,) = [line for line in curves.lines if line.get_label() == "demanded, at least"]
    assert (mark.get_xdata()[0], mark.get_ydata()[0]) == (8.0, 20.0)


def test_a_notebook_shows_a_design(best: mk.Design) -> None:
    page = best._repr_html_()
    assert page is not None
    assert page.count("<img") == 1
    assert best.table.loc["braid.angle", "value"] in page


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"free": {}}, "free = {}: must name at least one field"),
        ({"free": {"braid.angel": "42 deg to 50 deg"}}, 'free.braid.angel.*did you mean "braid.angle"'),
        ({"free": {"braid.angle": "50 deg to 42 deg"}}, "free.braid.angle.*from the smaller bound to the larger one"),
        ({"free": {"braid.angle": "42 deg"}}, "free.braid.angle = 42 deg: must be a range"),
        ({"free": {"braid.angle": []}}, r"free.braid.angle = \[\]: must hold at least one option"),
        ({"free": {"braid.fibres": "40 to many"}}, "free.braid.fibres = 40 to many: must be a range of whole numbers"),
        ({"free": {"ends": "clamped to pinned"}}, "free.ends.*is no number: it needs a list"),
        ({"free": {"test.pressure": "1 bar to 2 bar"}}, "free.test.pressure: is no field of a muscle"),
        (
            {"free": {"chamber.law": [mk.NeoHookean(c1=1e4)], "chamber.law.c1": "1 kPa to 9 kPa"}},
            "lies within chamber.law",
        ),
        ({"objective": "force"}, "objective = force: must be one goal"),
        ({"objective": [PULL]}, "objective.*must be mk.Maximise or mk.Minimise"),
        ({"subject_to": [PULL]}, r"subject_to\[0\].*must be a measure with a limit"),
        ({"subject_to": [mk.FibreSafety(**AT) >= 3]}, "braid.fibre.breaking_force: is missing"),
        ({"designs": 3}, "designs = 3: must be a whole number from 16"),
        ({"seed": -1}, "seed = -1: must be a whole number from 0"),
        ({"tolerance": 1.0}, "tolerance = 1.0"),
    ],
)
def test_wrong_input_is_named(change: dict, said: str) -> None:
    given = {"free": ANGLE, "objective": mk.Maximise(PULL), "subject_to": [], "designs": 64}
    with pytest.raises(mk.SpecError, match=said) as told:
        mk.design(muscle(), **given | change)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: mk.FibreSafety(**AT) >= -3, "fibre-safety.at_least = -3: must be above 0"),
        (lambda: mk.Stroke(**AT) >= 20, "stroke.at_least = 20: must be below 100 %"),
        (lambda: mk.Stroke(**AT) >= "20 mm", "stroke.at_least = 20 mm: must be a plain number"),
        (lambda: mk.Demand(PULL), "force: is given no limit"),
        (lambda: mk.Demand(PULL, least="2 N", most="1 N"), "force.at_least = 2 N: must be below at_most, 1 N"),
        (lambda: 1 <= mk.FibreSafety(**AT) <= 3, "cannot be compared twice in a row"),
        (lambda: mk.ForceAt(pressure=4), "force.pressure = 4.*4 bar"),
        (lambda: mk.ForceAt(**AT, contraction="5 %", length="80 mm"), "force.length.*is given beside a contraction"),
        (lambda: mk.Diameter(**AT, between="20 to 10 %"), "diameter.between.*to a larger one"),
        (lambda: mk.Work(**AT, per="mass"), "work.fibre_density: is missing"),
        (lambda: mk.CurveMiss(**AT, contractions=["0 %"], forces=["1 N", "2 N"]), "curve-miss.forces"),
        (lambda: mk.Maximise("force"), "objective = force: must be a measure"),
    ],
)
def test_wrong_measures_are_named(make, said: str) -> None:
    with pytest.raises(mk.SpecError, match=said):
        make()


FILE = """\
[muscle]
preset = "paper"
[muscle.braid]
angle = "46 deg"
[free]
"braid.angle" = "42 deg to 50 deg"
[objective]
maximise = "force"
pressure = "1 bar"
contraction = "5 %"
[[subject_to]]
measure = "diameter"
pressure = "1 bar"
between = "0 to 5 %"
at_most = "27 mm"
[options]
designs = 64
"""


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "design.toml"
    path.write_text(FILE, encoding="utf-8")
    return path


def test_a_file_says_what_design_takes(file: Path) -> None:
    asked = read_design(file, ["options.seed=4", "braid.fibres=48"])
    assert asked.objective == (mk.Maximise(PULL),)
    assert asked.subject_to == (WIDE <= "27 mm",)
    assert (asked.free, asked.options) == (ANGLE, {"designs": 64, "seed": 4})
    assert asked.muscle.braid.fibres == 48


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("[free]", "[fre]", 'fre: unknown key; did you mean "free"'),
        ("[objective]", "[[objective]]\nminimise = 'mass'\nfibre_density = 1380\n[[objective]]", None),
        ('maximise = "force"', 'maximise = "forse"', 'objective.maximise = forse: is no measure; did you mean "force"'),
        ('maximise = "force"', 'most = "force"', "objective: is neither maximise nor minimise"),
        ('measure = "diameter"', "", r"subject_to\[0\].measure: is missing"),
        ('at_most = "27 mm"', "", r"subject_to\[0\]: is given no limit"),
        ('at_most = "27 mm"', 'at_mots = "27 mm"', r"subject_to\[0\].at_mots: unknown key"),
        ('at_most = "27 mm"', 'at_most = "27 N"', r"subject_to\[0\].at_most = 27 N: has the wrong kind of unit"),
        ("designs = 64", "desings = 64", 'options.desings: unknown key; did you mean "designs"'),
        ("designs = 64", 'designs = "64"', "options.designs = 64: must be a whole number"),
    ],
)
def test_what_is_wrong_in_a_file_is_named(file: Path, old: str, new: str, said: str | None) -> None:
    assert old in FILE
    file.write_text(FILE.replace(old, new), encoding="utf-8")
    if said is None:
        assert len(read_design(file).objective) == 2
        return
    with pytest.raises(mk.SpecError, match=said):
        read_design(file)


def test_command(file: Path, best: mk.Design) -> None:
    runner = CliRunner()
    words = ["design", str(file), "-o", "design.nc", "--plot", "design.png", "--muscle", "best.toml"]
    done = runner.invoke(app, words)
    assert done.exit_code == 0, done.output
    for said in ("Best design", "braid.angle", "at most 27 mm", "designs tried in", "saved to design.nc"):
        assert said in done.stdout
    found = mk.load("design.nc")
    assert isinstance(found, mk.Design)
    assert found.values == best.values
    assert mk.read_case("best.toml", test_required=False).muscle.braid == found.muscle.braid
    assert runner.invoke(app, ["plot", "design.nc", "-o", "again.png"]).exit_code == 0
    assert Path("again.png").read_bytes() == Path("design.png").read_bytes()
    assert "a design: the best of" in runner.invoke(app, ["info", "design.nc"]).stdout
    refused = runner.invoke(app, ["run", str(file)])
    assert (refused.exit_code, "describes a design; give it to mckibben design" in refused.stderr) == (2, True)
    done = runner.invoke(app, ["design", str(file), "--json", "--set", "options.seed=1"])
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout)["feasible"]
    blocked = runner.invoke(app, ["design", str(file), "--set", "free.braid.angle=48 deg to 50 deg"])
    assert blocked.exit_code == 3
    assert "blocks: largest diameter" in blocked.stdout

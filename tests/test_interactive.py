"""Interactive pictures: one page without outside resources, the numbers of the result, words for people; refusals."""

import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import attrs
import numpy as np
import pytest
import xarray as xr
from browsers import CHROMIUM, FLAGS, Watched, environment_is_ready
from results import made
from test_fit_shown import FREE, bench
from test_simulate import Vessel
from test_view import broken
from typer.testing import CliRunner

import mckibben as mk
from mckibben.app.cli import app
from mckibben.results.result import State
from mckibben.results.verdict import Modes
from mckibben.view import style, web
from mckibben.view.interactive import drawn
from mckibben.view.plot import plot

pytestmark = pytest.mark.view

COARSE = {"tolerance": 1e-4}
HOUSE = '</script><b>A & B</b> "%{x}"'
"""A name that must not be read as HTML or as a template."""
READBACK = "Multiple readback operations"
"""What Chromium says of plotly's way to draw in space without a graphics card."""


@pytest.fixture(scope="module")
def curve() -> mk.Result:
    muscle = mk.presets.paper().replace("name", HOUSE)
    return mk.run(muscle, mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=4), **COARSE)


@pytest.fixture(scope="module")
def isobaric() -> mk.Result:
    return mk.run(mk.presets.paper(), mk.Isobaric(pressure="1 bar", length="115 mm to 75 mm", points=4), **COARSE)


def invoke(*words: Any) -> Any:
    return CliRunner().invoke(app, [str(word) for word in words])


DESIGN = """
[muscle]
preset = "paper"
braid.angle = "46 deg"
[free]
"braid.angle" = "42 deg to 50 deg"
"braid.fibres" = "40 to 56"
[[objective]]
maximise = "force"
pressure = "1 bar"
contraction = "5 %"
[[objective]]
maximise = "stroke"
pressure = "1 bar"
[[subject_to]]
measure = "stroke"
pressure = "1 bar"
at_least = "10 %"
[[subject_to]]
measure = "force"
pressure = "1 bar"
contraction = "5 %"
at_least = "30 N"
[options]
designs = 48
"""


@pytest.fixture(scope="module")
def front(tmp_path_factory: pytest.TempPathFactory) -> mk.Design:
    """What the command finds, whose page is beside it; few designs, so that the search need not settle."""
    folder = tmp_path_factory.mktemp("design")
    (folder / "design.toml").write_text(DESIGN, encoding="utf-8")
    files = "--plot", folder / "front.html", "-o", folder / "design.nc"
    done = invoke("design", folder / "design.toml", *files)
    assert done.exit_code in (0, 3), done.stderr
    found = mk.load(folder / "design.nc")
    assert isinstance(found, mk.Design)
    assert (folder / "front.html").read_bytes() == drawn(found).page()
    return found


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    if environment_is_ready():
        pytest.skip(environment_is_ready())
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=[*FLAGS, "--enable-unsafe-swiftshader"])
        yield browser
        browser.close()


class Opened(Watched):
    """A page that is opened from the disk, and what plotly drew of it."""

    def __init__(self, chromium: Any, path: Path) -> None:
        super().__init__(chromium.new_context(viewport={"width": 1200, "height": 800}), path.as_uri())
        self.tab.goto(self.address)
        self.until("document.querySelector('#picture')?._fullData !== undefined")

    def column(self, trace: int, axis: str) -> np.ndarray:
        """The numbers of a line or of points."""
        found = self.tab.evaluate(f"Array.from(document.querySelector('#picture')._fullData[{trace}].{axis})")
        return np.array([np.nan if value is None else value for value in found], float)

    def read(self, point: int) -> list[str]:
        """What a point tells, line by line, when the mouse is over it."""
        box = self.tab.locator("#picture .scatterlayer .point").nth(point).bounding_box()
        self.tab.mouse.move(1, 1)
        self.until("document.querySelector('.hoverlayer text') === null")
        self.tab.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
        self.until("document.querySelector('.hoverlayer text') !== null")
        lines: list[str] = self.tab.evaluate("[...document.querySelectorAll('.hoverlayer .hovertext tspan.line')]"
                                             ".map(line => line.textContent)")  # fmt: skip
        return lines

    def close(self) -> None:
        self.complaints = [said for said in self.complaints if READBACK not in said]
        self.quiet()
        self.tab.context.close()


def trace(made: web.Web, name: str) -> Any:
    """A trace of a picture by its name."""
    (found,) = (one for one in made.figure.data if one.name == name)
    return found


def test_a_curve_in_a_browser(chromium: Any, curve: mk.Result, tmp_path: Path) -> None:
    result = broken(curve, slice(3, None), 2)
    page = Opened(chromium, mk.interactive(result, tmp_path / "curve.html"))
    np.testing.assert_array_equal(page.column(0, "x")[:3], style.shown(result.pressure, "Pa")[:3])
    np.testing.assert_array_equal(page.column(0, "y"), result.force)
    np.testing.assert_array_equal(page.column(1, "y"), result.force[2:3])
    assert page.read(1) == [
        "state 1: stable", "length: 115 mm", "contraction: -35.294 %", f"force: {result.force[1]:.5g} N",
        "pressure: 0.33333 bar", f"volume: {1e6 * result.volume[1]:.5g} mL", "largest diameter: 25 mm",
        f"peak fibre tension: {result.column('fibre_tension')[1].max():.4g} N",
    ]  # fmt: skip
    assert page.read(2)[:2] == ["state 2: unstable", "why: unstable: the fibres are straight"]
    assert page.tab.inner_text("h1") == f'Muscle "{HOUSE}": isometric test, length 115 mm'
    said = page.tab.inner_text("body")
    assert "1 of 4 states have no values, from state 3 on: the fibres are straight." in said
    assert "fibre and chamber values and end condition are assumed." in said
    buttons = page.tab.evaluate("[...document.querySelectorAll('.modebar-btn')].map(one => one.dataset.title)")
    assert set(buttons) == {"Download plot", "Zoom", "Pan", "Zoom in", "Zoom out", "Reset axes"}  # none that sends
    page.close()


def test_a_front_in_a_browser(chromium: Any, front: mk.Design, tmp_path: Path) -> None:
    page = Opened(chromium, mk.interactive(front, tmp_path / "front.html"))
    force, stroke = front.front.force.values, 100.0 * front.front.stroke.values
    np.testing.assert_array_equal(page.column(0, "x"), force)
    np.testing.assert_array_equal(page.column(0, "y"), stroke)
    said = front.data["front_said"].values[last := 0]
    assert page.read(last) == [
        f"design {last}", f"braid.angle: {said[0]}", f"braid.fibres: {said[1]}",
        f"maximise force at 5 % contraction and 1 bar: {force[last]:.5g} N",
        f"maximise free contraction at 1 bar: {stroke[last]:.5g} %",
    ]  # fmt: skip
    told = trace(drawn(front), "nearest to the best of every goal").text[0].split("<br>")
    assert told[0] == "<b>nearest to the best of every goal</b>"
    assert f"braid.angle: {front.table.loc['braid.angle', 'value']}" in told
    limit = front.limits.iloc[-1]
    assert told[-1] == f"{limit['limit']}: {limit['value']}, room {limit['room [%]']:g} %"
    page.close()


def test_three_goals_are_drawn_in_space(chromium: Any, front: mk.Design, tmp_path: Path) -> None:
    """The third is made up: the force in newtons, as if it were a diameter in metres."""
    more = front.data.isel(goal=[0]).assign_coords(goal=["minimise largest diameter at 1 bar"])
    more = more.assign(goal_unit=("goal", ["m"]), goal_display=("goal", [""]))
    data = xr.concat([front.data, more], "goal", data_vars="minimal", coords="minimal", compat="override", join="outer")
    design = attrs.evolve(front, data=data)
    points = trace(drawn(design), "front")
    assert points.type == "scatter3d"
    force, stroke = front.front.force.values, front.front.stroke.values
    for axis, values in zip("xyz", (force, 100.0 * stroke, 1e3 * force), strict=True):
        np.testing.assert_allclose(points[axis], values, rtol=1e-12)
    assert drawn(design).figure.layout.scene.zaxis.title.text == "Largest diameter at 1 bar<br>(mm), smaller is better"
    page = Opened(chromium, mk.interactive(design, tmp_path / "space.html"))
    assert page.tab.evaluate("document.querySelector('#picture')._fullData[0].z.length") == len(force)
    page.close()


def test_the_best_design_with_its_demands_and_the_room_left(front: mk.Design) -> None:
    kept = [name for name in front.data.data_vars if not str(name).startswith("front_")]
    best = attrs.evolve(front, data=front.data[kept])
    picture = drawn(best)
    np.testing.assert_array_equal(trace(picture, "1 bar").y, best.data["curve_force"].values[0])
    stroke, force = (one for one in picture.figure.data if one.name == "demanded, at least")
    assert (*stroke.x, *stroke.y, *force.x, *force.y) == pytest.approx((10.0, 0.0, 5.0, 30.0))
    assert force.text[0] == "<b>demanded, at least</b><br>contraction: 5 %<br>force: 30 N"
    (bars,) = (one for one in picture.figure.data if one.type == "bar")
    np.testing.assert_allclose(bars.x, np.minimum(best.limits["room [%]"], 100.0), atol=0.006)
    assert list(bars.text) == list(best.limits["value"])


def test_a_page_asks_for_nothing_and_is_the_same_every_time(curve: mk.Result, tmp_path: Path) -> None:
    first, again = (mk.interactive(curve, tmp_path / f"{k}.html").read_bytes() for k in range(2))
    assert first == again
    shell = re.sub(rb"<script[^>]*>.*?</script>", b"", first, flags=re.DOTALL).decode()
    assert not re.findall(r"<link|<iframe|<img|https?://|\bsrc=", shell)
    assert "default-src 'none'" in shell
    assert not re.findall(rb"<script[^>]*\bsrc", first)
    assert HOUSE.encode() not in first


def test_a_protocol_state_by_state() -> None:
    steps = [
        mk.Step(length="to 115 mm", pressure=0.0, points=3),
        mk.Step(pressure="0 to 1 bar", length="hold", points=2),
    ]
    whole = made(mk.presets.paper(), mk.Protocol(steps=steps), 4)
    data = whole.data.assign(protocol_step=("step", np.array([0, 0, 0, 1, 1])))
    result = type(whole)(whole.muscle, whole.test, data)
    picture = drawn(result)
    for k, (values, unit) in enumerate(((result.force, "N"), (result.length, "m"), (result.pressure, "Pa"))):
        np.testing.assert_array_equal(picture.figure.data[k].y, style.shown(values, unit))
    cycle = [trace(picture, f"step {k}") for k in (1, 2)]
    np.testing.assert_array_equal(np.concatenate([one.x for one in cycle]), style.shown(result.length, "m"))
    assert picture.heading.startswith('Muscle "paper": protocol test, 1 length to 115 mm')


def test_measured_points_lie_over_curves(isobaric: mk.Result) -> None:
    table = {"pressure [bar]": [1, 1, 1, 3], "length [mm]": [80, 90, 100, 100], "force [N]": [-5, 15, 45, 200]}
    data = mk.read_data(table)
    alone = drawn(isobaric, data)
    points = trace(alone, "measured, loading")
    np.testing.assert_allclose(points.x, 100.0 * (1.0 - np.array([80.0, 90.0, 100.0]) / 85.0))
    np.testing.assert_array_equal(points.y, [-5.0, 15.0, 45.0])
    assert (
        points.text[1]
        == f"<b>measured, loading</b><br>test: {data.tests[0]}<br>length: 90 mm<br>pressure: 1 bar<br>force: 15 N"
    )
    assert alone.notes[0] in plot(isobaric, data=data).get_supxlabel().replace("\n", " ")
    several = drawn({"A & b": isobaric}, data)
    assert trace(several, "A &amp; b").text[0].startswith("<b>A &amp; b, state 0: stable</b>")
    assert several.heading == "Isobaric tests: A & b"
    assert several.notes[0].startswith("A & b: model less measured")
    with pytest.raises(mk.SpecError, match="no point has the pressure of the curve"):
        drawn(isobaric, mk.read_data({name: values[3:] for name, values in table.items()}))


def test_a_force_map_and_a_map(isobaric: mk.Result) -> None:
    forces = mk.force_map(mk.presets.paper(), length="115 mm to 75 mm", pressure="1 to 2 bar", points=4)
    (found,) = drawn(forces).figure.data
    np.testing.assert_array_equal(found.z, forces.force.values)
    np.testing.assert_allclose(found.customdata[..., 1], 1e6 * forces.volume.values)
    assert "largest fibre tension: %{customdata[2]:.5~g} N" in found.hovertemplate
    with pytest.raises(mk.SpecError, match="a force map of one length or one pressure is a curve"):
        drawn(forces.isel(pressure=[0]))
    chart = mk.chart(mk.presets.paper(), length="75 mm to 110 mm", pressure="0.2 to 1 bar", tolerance=1e-3)
    picture = drawn(chart)
    line = trace(picture, "1 bar")
    length = 0.085 * (1.0 - 0.01 * line.x)
    np.testing.assert_allclose(line.y, chart.force(length, 1e5), rtol=1e-9, atol=1e-9)
    told = line.text[100].split("<br>")
    assert told[0] == f"length: {1e3 * length[100]:.5g} mm"
    assert told[-1] == f"stiffness: {1e-3 * chart.stiffness(length[100], 1e5):.5g} N/mm"
    (area,) = (one for one in picture.figure.data if one.type == "contour")
    x, y = np.meshgrid(1e-3 * area.x, 1e5 * area.y)
    inside = np.isfinite(area.z)
    assert inside.mean() > 0.9
    np.testing.assert_allclose(area.z[inside], chart.force(x, y)[inside], rtol=1e-9, atol=1e-9)


def test_a_motion_over_time() -> None:
    rig = mk.Rig(
        muscle=mk.presets.paper(), load=mk.Load(mass="2 kg", gravity=0.0, start="105 mm", stop_low="99 mm"),
        supply=mk.Supply(gauge="2 bar"), valve=mk.Valve(C="0.1 L/s/bar", b=0.3), command=1.0,
    )  # fmt: skip
    motion = mk.simulate(rig, until="1 s", chart=Vessel(k=800.0))
    picture = drawn(motion)
    wanted = {
        "length": 1e3 * motion.length, "pressure": 1e-5 * motion.pressure, "force": motion.force,
        "command": motion.of("command"), "air taken": motion.of("consumed"), "kinetic": motion.of("kinetic"),
    }  # fmt: skip
    for name, values in wanted.items():
        np.testing.assert_allclose(trace(picture, name).y, values, rtol=1e-12)
    assert trace(picture, "kinetic").hovertemplate.startswith("kinetic: %{y:.5~g} J")
    assert picture.figure.layout.yaxis6.title.text == "Energy (J)"
    events = trace(picture, "event")
    assert list(events.x) == motion.events["time"].tolist()
    assert list(events.text) == [f"<b>{event}</b>" for event in motion.events["event"]]


def test_a_fit_tells_every_point() -> None:
    fit = mk.fit(mk.presets.paper(), bench(), FREE, starts=1)
    picture = drawn(fit)
    for name in ("0.5 bar", "1 bar"):
        of = fit.data["test"].values == name
        points, line, left = (one for one in picture.figure.data if one.name == name)
        np.testing.assert_array_equal(points.y, fit.data["force"].values[of])
        np.testing.assert_array_equal(line.y, fit.data["predicted"].values[of][np.argsort(points.x)])
        np.testing.assert_array_equal(left.y, fit.residuals[of])
        force, model, residual = (float(values[of][1]) for values in (fit.data["force"].values,
                                  fit.data["predicted"].values, fit.residuals))  # fmt: skip
        assert points.text[1].split("<br>")[-3:] == [
            f"measured: {force:.5g} N", f"model: {model:.5g} N", f"model less measured: {residual:.4g} N",
        ]  # fmt: skip


def test_what_cannot_be_drawn_is_said(curve: mk.Result, isobaric: mk.Result, tmp_path: Path) -> None:
    for name in ("x.png", "x"):
        with pytest.raises(mk.SpecError, match=r"must end in \.html \(page for a browser\)"):
            mk.interactive(curve, tmp_path / name)
    page = tmp_path / "x.html"
    for wrong in (
        State(curve, "stable", "", Modes(0, 0, 0, 1.0, 1.0, 1.0)),
        "curve",
        xr.Dataset(attrs={"sweep": "{}"}),
    ):
        with pytest.raises(mk.SpecError, match="has no interactive picture: those are of a result of run"):
            mk.interactive(wrong, page)
    with pytest.raises(mk.SpecError, match="are tests of several kinds"):
        mk.interactive({"a": curve, "b": isobaric}, page)
    with pytest.raises(mk.SpecError, match="must be what read_data gives"):
        mk.interactive(curve, page, data="bench.csv")
    with pytest.raises(mk.SpecError, match="goes with a result of run"):
        mk.interactive(mk.presets.paper(), page, data=mk.read_data({"p [bar]": [1], "l [mm]": [80], "F [N]": [1]}))
    with pytest.raises(mk.SpecError, match=r"is a file's name; mk.interactive\(result, \"x.html\"\) writes a page"):
        mk.plot(curve, "x.html")
    assert not page.exists()
    page.write_text("old", encoding="utf-8")
    with pytest.raises(mk.SpecError, match="exists"):
        mk.interactive(curve, page)
    assert mk.interactive(curve, page, force=True).read_bytes().startswith(b"<!doctype html>")


def test_on_the_command_line(curve: mk.Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    mk.save(curve, "curve.nc")
    done = invoke("plot", "curve.nc", "-o", "curve.html")
    assert done.exit_code == 0, done.stderr
    assert done.stdout.strip() == "drawn: curve.html"
    assert Path("curve.html").read_bytes() == drawn(curve).page()
    refused = invoke("plot", "curve.nc", "-o", "other.html", "--kind", "tension")
    assert refused.exit_code == 2
    assert "--kind = tension: has no interactive picture" in refused.stderr
    Path("design.toml").write_text(DESIGN, encoding="utf-8")
    monkeypatch.setitem(sys.modules, "plotly", None)
    for words in (("plot", "curve.nc", "-o", "x.html"), ("design", "design.toml", "--plot", "x.html")):
        missing = invoke(*words)
        assert missing.exit_code == 2
        assert "x.html: is an interactive picture, which takes plotly to draw" in missing.stderr
        assert 'pip install "mckibben[interactive]"' in missing.stderr
        assert "Best design" not in missing.stdout
    with pytest.raises(mk.SpecError, match="takes plotly to draw"):
        mk.interactive(curve, "x.html")
    assert not Path("x.html").exists()

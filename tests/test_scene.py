"""Muscles in three dimensions: the geometry against closed forms, pictures and files opened again, bad input."""

import json
import os
import struct
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from results import made
from test_cli import invoke, refused

import mckibben as mk
from mckibben.results.result import Result
from mckibben.spec import SpecError
from mckibben.view import mesh, render, stage
from mckibben.view.braid3d import SHARE, Body, display_diameter
from mckibben.view.tube import Tube

pytestmark = pytest.mark.view

SMALL = (300, 200)
ROOT = Path(__file__).parent.parent


@pytest.fixture(scope="module")
def curve() -> Result:
    """The paper's muscle at 115 mm: a waist, and so a surface that is curved both ways."""
    return mk.run(mk.presets.paper(), mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3))


@pytest.fixture(scope="module")
def saved(curve: Result, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return mk.save(curve, tmp_path_factory.mktemp("scene") / "out.nc")


@pytest.fixture(scope="module")
def body(curve: Result) -> Body:
    return Body.of(curve, -1)


@pytest.fixture(scope="module")
def pyvista():
    """PyVista where it can draw; without it, or without EGL and OSMesa, the tests of pictures have nothing to test."""
    found = pytest.importorskip("pyvista")
    if not render.can_draw():
        pytest.skip("VTK cannot draw here: neither a display nor EGL nor OSMesa")
    return found


def edges(faces: np.ndarray) -> set[int]:
    """How often edges occur."""
    pairs = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    return set(np.unique(pairs, axis=0, return_counts=True)[1].tolist())


def colourful(picture: Image.Image) -> np.ndarray:
    """Where a picture is neither white nor grey."""
    pixels = np.asarray(picture.convert("RGB")).astype(int)
    return np.ptp(pixels, axis=2) > 30


def test_fibres_keep_their_length_on_the_surface(body: Body) -> None:
    v = np.linspace(0.0, body.tube.v[-1], 4001)
    points, _ = body.centre_line(0.3, -1, v, weave=False)
    length = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    assert length == pytest.approx(85e-3 / np.sin(np.deg2rad(37.0)), rel=2e-5)  # 129 points along the muscle


def test_fibres_pass_over_and_under_each_other_by_turns_a_diameter_apart(body: Body) -> None:
    v, number = body.crossings(), body.fibres // 2
    step = 2.0 * np.pi / number
    right, normal = body.centre_line(0.0, 1, v)
    heights = []
    for k, (at, here, out) in enumerate(zip(v, right, normal, strict=True)):
        left, _ = body.centre_line(k * step, -1, np.array([at]))  # the fibre that meets this one at its crossing k
        between = here - left[0]
        assert np.linalg.norm(between) == pytest.approx(body.diameter, rel=1e-9)
        heights.append(float(between @ out))
    assert len(heights) > 50
    np.testing.assert_allclose(heights, body.diameter * (-1.0) ** np.arange(len(v)), rtol=1e-9)
    assert body.diameter == 0.25e-3  # the muscle's own


def test_bars_are_closed_and_as_thick_as_fibres(body: Body) -> None:
    v = np.linspace(0.0, body.tube.v[-1], 801)
    one = mesh.pipe(*body.centre_line(0.0, 1, v), body.diameter / 2.0, v, 12)
    centres, _ = body.centre_line(0.0, 1, v)
    length = np.linalg.norm(np.diff(centres, axis=0), axis=1).sum()
    section = 6.0 * np.sin(np.pi / 6.0) * (body.diameter / 2.0) ** 2  # of twelve sides
    assert one.volume() == pytest.approx(section * length, rel=2e-3)
    assert np.linalg.norm(one.normals, axis=1) == pytest.approx(1.0)


@pytest.mark.parametrize("cut", [None, 0.7])
def test_faces_look_the_way_of_their_normals(curve: Result, cut: float | None) -> None:
    body = Body.of(curve, 0, cut)
    chamber = body.chamber()
    assert chamber is not None
    for part in (body.fibre_pipes(), chamber, body.fittings()):
        a, b, c = (part.points[part.faces[:, k]] for k in range(3))
        assert np.all(np.sum(np.cross(b - a, c - a) * part.normals[part.faces].mean(axis=1), axis=1) > 0.0)


def test_a_cut_takes_its_sector_out(curve: Result) -> None:
    whole, cut = Body.of(curve, -1), Body.of(curve, -1, 0.0)
    points = cut.fibre_pipes().points
    angle = np.degrees(np.arctan2(points[:, 1], points[:, 0]))
    assert np.abs(angle).min() > 50.0 - 2.0  # half the sector, less the thickness of a fibre
    share = cut.fibre_pipes().volume() / whole.fibre_pipes().volume()
    assert share == pytest.approx(1.0 - 100.0 / 360.0, rel=0.01)


def test_the_wall_is_as_thick_as_deformed(curve: Result) -> None:
    body = Body.of(curve, -1)
    chamber = body.chamber()
    assert chamber is not None
    middle = np.isclose(chamber.v, body.tube.v[-1] / 2.0)
    radii = np.hypot(*chamber.points[middle, :2].T)
    outside = float(body.tube.at(body.tube.v[-1] / 2.0)[0]) - body.diameter
    thickness = 1e-3 * float(curve.data["stretch_thickness"].isel(step=-1, v=64))
    assert radii.max() == pytest.approx(outside, rel=1e-6)
    assert np.ptp(radii) == pytest.approx(thickness, rel=1e-6)


def test_solids_hold_the_volume_of_the_state(curve: Result, body: Body) -> None:
    facets = np.sinc(2.0 / mesh.AROUND)  # the share of a circle that its polygon fills
    cylinder = mesh.solid(Tube.cylinder(curve.muscle))
    assert cylinder.volume() == pytest.approx(facets * np.pi * 12.5e-3**2 * 85e-3, rel=1e-9)
    solid = mesh.solid(body.tube)
    assert solid.volume() == pytest.approx(facets * curve.volume[-1], rel=5e-4)
    assert edges(solid.faces) == {2}
    assert len(np.unique(solid.points, axis=0)) == len(solid.points)


def test_fibres_without_a_diameter_get_one_for_display() -> None:
    fibre = mk.Fibre(B1="0.2 N mm^2", B2="0.2 N mm^2", B3="0.2 N mm^2")
    muscle = mk.presets.paper().replace("braid.fibre", fibre)
    room = 2.0 * np.pi * 12.5e-3 * np.sin(np.deg2rad(37.0)) / 28
    assert display_diameter(muscle) == pytest.approx(SHARE * room)


def test_a_braid_of_very_many_fibres_is_drawn_with_fewer(curve: Result) -> None:
    fine = mk.Fibre(diameter="1 um", E="3 GPa", nu=0.4)
    muscle = mk.presets.paper().replace("braid.fibre", fine).replace("braid.fibres", 20_000)
    body = Body.of(Result(muscle, curve.test, curve.data), 0)
    assert 100 < body.fibres < 1000
    assert body.fibres % 2 == 0


def test_stl_is_closed_outside_the_fibres_and_in_mm(curve: Result, body: Body, tmp_path: Path) -> None:
    content = mk.save_shape(curve, tmp_path / "x.stl", 1).read_bytes()
    assert b"unit: mm" in content[:80]
    (count,) = struct.unpack_from("<I", content, 80)
    assert len(content) == 84 + 50 * count
    rows = np.frombuffer(content[84:], np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("end", "<u2")]))
    corners = rows["corners"].astype(float)
    points, index = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    assert edges(index.reshape(-1, 3)) == {2}
    low, high = points.min(axis=0), points.max(axis=0)
    assert high[2] - low[2] == pytest.approx(115.0, abs=0.01)
    assert high[0] == pytest.approx(12.5 + 0.25, abs=1e-3)  # the fibres' outside where they are clamped
    volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0
    outside = Tube.of(curve, 1).shifted(0.25e-3)
    exact = np.pi * np.trapezoid(outside.r**2, outside.z) * 1e9
    assert volume == pytest.approx(np.sinc(2.0 / mesh.AROUND) * exact, rel=5e-4)
    assert exact > curve.volume[1] * 1e9


def test_glb_holds_parts_in_m_with_colours(curve: Result, body: Body, tmp_path: Path) -> None:
    content = mk.save_shape(curve, tmp_path / "x.glb").read_bytes()
    magic, version, length, text, kind = struct.unpack_from("<4sIII4s", content)
    assert (magic, version, length, kind) == (b"glTF", 2, len(content), b"JSON")
    told = json.loads(content[20 : 20 + text])
    assert [node["name"] for node in told["nodes"]] == ["fibres", "chamber", "fittings"]
    attributes = told["meshes"][0]["primitives"][0]["attributes"]
    positions, colours = (told["accessors"][attributes[name]] for name in ("POSITION", "COLOR_0"))
    assert positions["count"] == len(body.fibre_pipes().points)
    assert positions["max"][0] - positions["min"][0] == pytest.approx(0.115, rel=3e-3)  # x along the muscle
    view = told["bufferViews"][colours["bufferView"]]
    start = 28 + text + view["byteOffset"]
    rgba = np.frombuffer(content[start : start + view["byteLength"]], np.uint8).reshape(-1, 4)
    assert len(np.unique(rgba, axis=0)) > 50
    assert sum(view["byteLength"] for view in told["bufferViews"]) == told["buffers"][0]["byteLength"]


def test_vtp_opens_with_fields_in_si_units(curve: Result, tmp_path: Path) -> None:
    pyvista = pytest.importorskip("pyvista")
    opened = pyvista.read(mk.save_shape(curve, tmp_path / "x.vtp"))
    tension = opened.point_data["fibre_tension"][opened.point_data["part"] == 0]
    state = curve.data["fibre_tension"].isel(step=-1)
    # the peak beside a fitting lies between points of the fibres
    assert (tension.min(), tension.max()) == pytest.approx((float(state.min()), float(state.max())), rel=3e-3)
    assert opened.field_data["unit of fibre_tension"][0] == "N"
    assert opened.field_data["length"][0] == pytest.approx(0.115)
    assert opened.bounds[5] - opened.bounds[4] == pytest.approx(0.115 + 2.0 * 0.005, rel=1e-3)  # with the fittings


def test_glb_and_stl_open_in_another_reader(pyvista, curve: Result, tmp_path: Path) -> None:
    solid = pyvista.read(mk.save_shape(curve, tmp_path / "x.stl"))
    assert solid.is_manifold
    assert solid.n_cells == len(mesh.solid(Tube.of(curve, -1)).faces)
    opened = pyvista.read(mk.save_shape(curve, tmp_path / "x.glb"))
    assert opened.n_blocks == 3
    assert opened.bounds[1] - opened.bounds[0] == pytest.approx(0.125, rel=1e-3)


def test_a_picture_from_the_command_line(pyvista, saved: Path, tmp_path: Path) -> None:
    target = tmp_path / "picture.png"
    done = invoke("view", saved, "-o", target, "--size", "600x300", "--tilt", 0)
    assert (done.exit_code, done.stdout) == (0, f"drawn: {target}\n"), done.stderr
    with Image.open(target) as picture:
        assert picture.size == (600, 300)
        seen = colourful(picture)[30:200]  # the muscle, without head, scale and notes
    assert 0.03 < seen.mean() < 0.5
    columns = np.flatnonzero(seen.any(axis=0))
    assert columns[0] + columns[-1] == pytest.approx(599, abs=4)  # the muscle is symmetric
    assert seen.sum(axis=0)[columns[5] : 150].mean() > seen.sum(axis=0)[280:320].mean()  # and has a waist


def test_the_picture_has_the_structure_of_the_one_in_the_documentation(pyvista, tmp_path: Path) -> None:
    """Blocks of 20 x 20 pixels of the same scene, in grey: drawn elsewhere, single pixels are others."""
    with Image.open(ROOT / "docs" / "pictures" / "scene.png") as stored:
        size, before = stored.size, blocks(stored)
    state = mk.solve(mk.presets.paper(), length="115 mm", pressure="1 bar")
    plotter = mk.scene(state, cut=True, ghost=True, off_screen=True)
    with Image.fromarray(np.asarray(plotter.screenshot(return_img=True))) as drawn:
        assert drawn.size[0] / drawn.size[1] == pytest.approx(size[0] / size[1], rel=0.01)
        now = blocks(drawn.resize(size))
    plotter.close()
    likeness = np.corrcoef(before.ravel(), now.ravel())[0, 1]
    turned = np.corrcoef(before.ravel(), now[:, ::-1].ravel())[0, 1]
    assert likeness > 0.999 > 0.97 > turned


def blocks(picture: Image.Image) -> np.ndarray:
    """Means of blocks of 20 x 20 pixels, in grey."""
    grey = picture.convert("L")
    return np.asarray(grey.resize((grey.width // 20, grey.height // 20), Image.Resampling.BOX), float)


def test_what_is_asked_for_changes_the_picture(pyvista, curve: Result) -> None:
    def drawn(**asked: object) -> np.ndarray:
        plotter = mk.scene(curve, size=SMALL, off_screen=True, **asked)
        shot = np.asarray(plotter.screenshot(return_img=True)).astype(int)
        assert set(plotter.actors) >= {"fibres", "chamber", "fittings"}
        assert plotter._repr_png_().startswith(b"\x89PNG")  # what a notebook shows
        plotter.close()
        return shot

    plain = drawn(colour=None)
    asked = [{"colour": "theta"}, {"colour": "stretch_hoop"}, {"cut": True}, {"translucent": True}, {"ghost": True}]
    asked += [{"turn": 90.0, "tilt": 60.0}, {"axis": "vertical"}, {"zoom": 3.0}]
    for change in asked:
        other = drawn(**{"colour": None} | change)
        assert np.mean(np.abs(other - plain).max(axis=2) > 20) > 0.005, change


def test_an_animation_has_a_frame_for_each_state_that_was_reached(pyvista, curve: Result, tmp_path: Path) -> None:
    data = curve.data.copy(deep=True)
    data["r"].values = np.where(np.arange(3)[:, None] == 1, np.nan, data["r"].values)
    part = Result(curve.muscle, curve.test, data)
    with Image.open(mk.animate(part, tmp_path / "x.gif", size=SMALL, fps=4)) as film:
        assert (film.n_frames, film.size, film.info["duration"]) == (2, SMALL, 250)
        frames = []
        for k in range(film.n_frames):
            film.seek(k)
            frames.append(np.asarray(film.convert("RGB")).astype(int))
    assert all(tuple(frame[100, 0]) == (255, 255, 255) for frame in frames)
    scale = slice(165, 175)
    assert np.array_equal(frames[0][scale], frames[1][scale])  # the colours mean the same
    assert not np.array_equal(frames[0], frames[1])
    told = invoke("view", mk.save(part, tmp_path / "part.nc"), "-o", tmp_path / "y.gif", "--size", "300x200")
    assert "1 of 3 states were not reached and are left out." in told.stdout


def test_without_pyvista_one_sentence(
    curve: Result, saved: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(SpecError, match=r'scene: takes PyVista; pip install "mckibben\[view\]"'):
        mk.scene(curve)
    refused(invoke("view", saved, "-o", tmp_path / "x.gif"), "takes PyVista")
    refused(invoke("view", saved, "-o", tmp_path / "x.vtp"), "takes PyVista")
    for ending in ("stl", "glb"):
        assert mk.save_shape(curve, tmp_path / f"x.{ending}").exists()


def test_where_vtk_cannot_draw_one_sentence_names_the_packages(curve: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pyvista")
    monkeypatch.setattr(render, "_TRIAL", "import os; os.abort()")  # what VTK does without EGL and OSMesa
    monkeypatch.delenv("VTK_DEFAULT_OPENGL_WINDOW", raising=False)
    monkeypatch.setattr(render, "has_display", lambda: False)
    render.can_draw.cache_clear()
    try:
        with pytest.raises(SpecError, match="libegl1 and libgl1-mesa-dri, or libosmesa6"):
            mk.scene(curve)
    finally:
        render.can_draw.cache_clear()


def test_an_mp4_says_what_it_takes(curve: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(SpecError, match="pip install imageio-ffmpeg"):
        mk.animate(curve, tmp_path / "x.mp4")


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"colour": "tension"}, 'did you mean "fibre_tension"'),
        ({"colour": "fibre_stretch"}, "is unknown"),  # these fibres do not stretch
        ({"state": 3}, "from 0 to 2"),
        ({"state": True}, "whole number"),
        ({"axis": "upright"}, "scene.axis"),
        ({"tilt": float("nan")}, "in degrees"),
        ({"zoom": 0.0}, "from 0.1 to 100"),
        ({"size": (10, 10)}, "100 to 8000 pixels"),
        ({"size": "large"}, "100 to 8000 pixels"),
    ],
)
def test_wrong_input_is_named(curve: Result, asked: dict[str, object], said: str) -> None:
    with pytest.raises(SpecError, match=said):
        mk.scene(curve, **asked)


def test_states_that_were_not_reached_are_said(tmp_path: Path) -> None:
    test = mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3)
    part, none = (made(mk.presets.paper(), test, reached) for reached in (2, 0))
    with pytest.raises(SpecError, match=r"state = -1: was not reached: the fibres are straight.* states 0, 1"):
        mk.save_shape(part, tmp_path / "x.stl", -1)
    with pytest.raises(SpecError, match="none of the 3 states was reached"):
        mk.animate(none, tmp_path / "x.gif")
    with pytest.raises(SpecError, match="must be what run or solve gave"):
        mk.scene(3.0)


def test_files_are_not_overwritten_and_windows_need_a_display(
    saved: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    there = tmp_path / "there.stl"
    there.write_text("mine")
    refused(invoke("view", saved, "-o", there), "exists", "--force")
    refused(invoke("view", saved, "-o", tmp_path / "x.obj"), "must end in .png", ".stl (CAD")
    refused(invoke("view", saved, "-o", tmp_path / "x.gif", "--state", 1), "an animation shows all states")
    refused(invoke("view", saved, "-o", tmp_path / "x.png", "--size", "big"), "WIDTHxHEIGHT")
    monkeypatch.setattr(render, "has_display", lambda: False)
    refused(invoke("view", saved), "no display")
    assert there.read_text() == "mine"
    assert list(tmp_path.iterdir()) == [there]
    done = invoke("view", saved, "-o", there, "--force", "--state", 0)
    assert (done.exit_code, done.stdout) == (0, f"written: {there}, in mm\n")


@pytest.mark.skipif(os.name != "posix", reason="links and devices")
def test_links_and_devices_are_refused(curve: Result, tmp_path: Path) -> None:
    link = tmp_path / "x.stl"
    link.symlink_to("/dev/null")
    for force in (False, True):
        with pytest.raises(SpecError, match="is no regular file"):
            mk.save_shape(curve, link, force=force)


def test_a_notebook_turns_it_where_pyvista_can(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is installed beside it decides; trame alone is not enough for PyVista since 0.48."""
    pyvista = pytest.importorskip("pyvista")
    monkeypatch.setitem(sys.modules, "IPython", None)
    for registered in ((), ("trame",)):
        monkeypatch.setattr(pyvista, "registered_jupyter_backends", lambda found=registered: found, raising=False)
        assert stage._turns(pyvista) == bool(registered)
    monkeypatch.delitem(sys.modules, "IPython")
    assert not stage._turns(pyvista)

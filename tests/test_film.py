"""A motion as a moving picture: frames evenly spread, the drawing true to the motion and the solver, refusals."""

import sys
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from PIL import Image
from test_cli import invoke, refused
from test_simulate import Cylinder, Vessel

import mckibben as mk
from mckibben.film.frames import Frames, frames_of
from mckibben.film.pen import valve_word
from mckibben.film.picture import SCALE, Film
from mckibben.film.silhouettes import Silhouette, silhouettes
from mckibben.spec.errors import SpecError
from mckibben.view import moving

pytestmark = pytest.mark.film

M = mk.presets.paper()
SIZE = (600, 340)
AIR: dict[str, Any] = {"supply": mk.Supply(gauge="2 bar"), "valve": mk.Valve(C="0.05 L/(s bar)", b=0.3)}


@pytest.fixture(scope="module")
def chart() -> mk.Chart:
    return mk.chart(M, length="70 mm to 118 mm", pressure="0 to 2 bar", tolerance=1e-3)


@pytest.fixture(scope="module")
def lift(chart: mk.Chart) -> mk.Motion:
    """A weight that stands on the floor until pressure lifts it."""
    load = mk.Load(mass="3 kg", damping="40 N s/m", spring="100 N/m", stop_high="108 mm")
    return mk.simulate(mk.Rig(muscle=M, load=load, command=mk.Jump(1.0, at="0.1 s"), **AIR), "1 s", chart=chart)


@pytest.fixture(scope="module")
def joint(chart: mk.Chart) -> mk.Motion:
    pulley = mk.Pulley(radius="15 mm", inertia="2e-3 kg m^2", damping="0.08 N m s", length="100 mm")
    pid = mk.PID(of="angle", target=mk.Jump("8 deg", at="0.1 s"), kp=4.0, kd=0.2, filter="5 ms")
    rig = mk.Rig(muscle=M, antagonist=M, load=pulley, command=pid, pressure="1 bar", **AIR)
    return mk.simulate(rig, "0.5 s", chart=chart, points=101)


def drawn(motion: mk.Motion, frames: Frames, lines: list[tuple[Silhouette | None, ...]] | None = None) -> Film:
    rig = motion.rig
    made = lines or [
        silhouettes(muscle, frames.length[:, k], frames.pressure[:, k], frames.inside[:, k])
        for k, muscle in enumerate(rig.muscles)
    ]
    return Film(motion, frames, made, 1.0, SIZE)


def marked(picture: Film, name: str) -> Iterator[Polygon | Line2D]:
    for one in picture.axes.get_children():
        if one.get_gid() == name:
            assert isinstance(one, (Polygon, Line2D))
            yield one


def corners(picture: Film, name: str) -> np.ndarray:
    (one,) = marked(picture, name)
    assert isinstance(one, Polygon)
    return np.asarray(one.get_xy())


@pytest.mark.parametrize(("fps", "speed", "shown"), [(20.0, 1.0, 0.05), (30.0, 0.25, 0.03), (4.0, 2.0, 0.25)])
def test_frames_are_evenly_spread_and_shown_as_long_as_the_speed_says(
    lift: mk.Motion, fps: float, speed: float, shown: float
) -> None:
    frames = frames_of(lift, fps, speed, whole=True)
    assert frames.shown == pytest.approx(shown)
    assert np.allclose(np.diff(frames.time), shown * speed, rtol=1e-12)
    assert lift.time[-1] - shown * speed < frames.time[-1] <= lift.time[-1] + 1e-12
    assert np.allclose(frames.length[:, 0], np.interp(frames.time, lift.time, lift.length), rtol=1e-12)


def test_a_gif_has_the_frames_at_their_size_and_pace(lift: mk.Motion, tmp_path: Path) -> None:
    path = mk.animate(lift, tmp_path / "lift.gif", fps=5, size=SIZE)
    with Image.open(path) as film:
        assert (film.n_frames, film.size, film.info["duration"]) == (6, SIZE, 200)
        seen = []
        for k in range(film.n_frames):
            film.seek(k)
            seen.append(np.asarray(film.convert("RGB")).astype(int))
    assert path.stat().st_size < 6 * 50_000  # 100 frames are below 5 MB
    changes = np.abs(np.diff(seen, axis=0)).max(axis=3) > 20
    assert changes.reshape(5, -1).any(axis=1).all()
    assert not changes[:, -20:].any()  # notes stay where they are


def test_the_drawing_is_that_of_the_motion_and_of_the_solver(lift: mk.Motion) -> None:
    frames = frames_of(lift, 5.0, 1.0, whole=True)
    picture = drawn(lift, frames)
    top = lift.pressure.max()
    for k in (0, 5):
        picture.show(k)
        (muscle,) = marked(picture, "muscle 0")
        across, along = np.asarray(muscle.get_xy()).T
        h, P = float(frames.length[k, 0]), float(frames.pressure[k, 0])
        assert (along.min(), along.max()) == pytest.approx((0.0, 1e3 * h), abs=1e-9)
        state = mk.solve(M, length=h, pressure=P)
        assert across.max() == pytest.approx(1e3 * state.data["r"].values.max(), rel=1e-4)
        assert np.allclose(across.max(), -across.min())
        assert np.allclose(muscle.get_facecolor(), SCALE(P / top))
        assert muscle.get_linestyle() == "-"


def test_a_frame_is_what_the_whole_figure_shows(joint: mk.Motion) -> None:
    """Only what moves is drawn anew."""
    frames = frames_of(joint, 10.0, 1.0, whole=True)
    picture = drawn(joint, frames, [(None,) * len(frames)] * 2)
    for k in (5, 0, 3):
        quick = np.asarray(picture.image(k)).astype(int)
        canvas: Any = picture.figure.canvas
        canvas.draw()
        whole = np.asarray(canvas.buffer_rgba())[:, :, :3].astype(int)
        assert (np.abs(quick - whole).max(axis=2) > 20).mean() < 1e-3  # a line may lie over a tick, not below it


def test_the_mass_stands_on_its_stop_and_leaves_it(lift: mk.Motion) -> None:
    frames = frames_of(lift, 5.0, 1.0, whole=True)
    picture = drawn(lift, frames, [(None,) * len(frames)])
    stops = [one for one in picture.axes.lines if one.get_gid() == "stop" and len(np.asarray(one.get_xdata())) == 2]
    floor = max(float(np.max(np.asarray(one.get_ydata()))) for one in stops)
    picture.show(0)
    first = corners(picture, "mass")[:, 1].max()
    assert first == pytest.approx(floor, abs=1e-6)
    picture.show(5)
    lifted = 1e3 * (frames.length[0, 0] - frames.length[5, 0])
    assert lifted > 3.0
    assert first - corners(picture, "mass")[:, 1].max() == pytest.approx(lifted, rel=1e-9)


def test_a_pulley_turns_by_its_angle_and_both_muscles_end_at_their_lengths(joint: mk.Motion) -> None:
    frames = frames_of(joint, 10.0, 1.0, whole=True)
    picture = drawn(joint, frames, [(None,) * len(frames)] * 2)
    for k in (0, 5):
        picture.show(k)
        (arm,) = marked(picture, "arm")
        (x0, x1), (y0, y1) = np.asarray(arm.get_xdata()), np.asarray(arm.get_ydata())
        assert np.arctan2(y1 - y0, x1 - x0) == pytest.approx(float(frames.place[k]), abs=1e-9)
        for which in (0, 1):
            ends = corners(picture, f"muscle {which}")
            assert ends[:, 0].max() == pytest.approx(1e3 * frames.length[k, which], rel=1e-9)
    assert frames.place[5] > 0.05
    (dashed,) = [one for one in picture.axes.lines if one.get_linestyle() == "--"]
    (x0, x1), (y0, y1) = np.asarray(dashed.get_xdata()), np.asarray(dashed.get_ydata())
    assert np.arctan2(y1 - y0, x1 - x0) == pytest.approx(np.radians(8.0))


def test_outside_of_the_map_a_dashed_outline_stands_for_the_muscle(lift: mk.Motion) -> None:
    data = lift.data.copy(deep=True)
    data["inside"].values = lift.time < 0.5
    part = mk.Motion(data)
    frames = frames_of(part, 5.0, 1.0, whole=True)
    picture = drawn(part, frames)
    looks = []
    for k in range(len(frames)):
        picture.show(k)
        (muscle,) = marked(picture, "muscle 0")
        looks.append(muscle.get_linestyle())
    assert looks == ["-"] * 3 + ["--"] * 3
    assert "outline stands for a muscle whose shape is not known" in picture.figure.get_supxlabel().replace("\n", " ")


def test_there_is_no_outline_where_there_is_no_state() -> None:
    some = silhouettes(M, np.array([0.2, 0.1, 0.1]), np.array([1e5, 1e5, 1e5]), np.array([True, True, False]))
    assert some[0] is None
    assert some[1] is not None
    assert some[2] is None
    rubs = M.replace("friction", mk.Friction(coefficient=0.3, arm="0.1 mm", constant="0.01 N mm"))
    (same,) = silhouettes(rubs, np.array([0.1]), np.array([1e5]), np.array([True]))
    assert same is not None
    assert np.allclose(same.r, some[1].r, rtol=1e-9)


def test_valves_say_what_they_do() -> None:
    vessel = Vessel(k=400.0)
    load = mk.FixedEnd(length="100 mm")
    pulses = mk.PWM(0.3, frequency="20 Hz")
    pulsed, opened = (
        mk.simulate(mk.Rig(muscle=M, load=load, command=one, **AIR), "1 s", chart=vessel)
        for one in (pulses, mk.Jump(1.0, at="0.52 s"))
    )
    frames = frames_of(pulsed, 4.0, 1.0, whole=True)
    assert frames.switching[1:-1].all()
    assert np.allclose(frames.command[1:-1], -0.4, atol=0.05)
    frames = frames_of(opened, 4.0, 1.0, whole=True)
    words = [
        valve_word(float(u), bool(s))[0] for u, s in zip(frames.command[:, 0], frames.switching[:, 0], strict=True)
    ]
    assert words == ["closed", "closed", "closed", "fills", "fills"]
    assert valve_word(-0.3, False)[0] == "vents, 30 %"
    assert valve_word(-0.4, True)[0] == "pulses, mean -0.40"


def test_a_slack_cable_keeps_where_the_load_is(tmp_path: Path) -> None:
    push = mk.Series([0, 0.1, 0.3, 2], [0, -60, 60, 60])
    load = mk.Load(mass="20 kg", gravity=0.0, damping=100.0, slack=True, push=push)
    rig = mk.Rig(muscle=M, load=load, pressure="2 bar", **AIR)
    motion = mk.simulate(rig, until="0.5 s", chart=Cylinder(k=2000.0, rest=0.09))
    slack = motion.of("slack")
    gap = motion.length - motion.of("position")
    assert slack.any()
    assert not slack.all()
    assert np.allclose(gap[~slack], 0.0, atol=1e-9)
    assert gap[slack].max() > 1e-3
    assert mk.load(mk.save(motion, tmp_path / "slack.nc")) == motion
    frames = frames_of(motion, 50.0, 1.0, whole=True)
    picture = drawn(motion, frames, [(None,) * len(frames)])
    k = int((frames.length[:, 0] - frames.place).argmax())
    tops = []
    for one in (0, k):
        picture.show(one)
        tops.append(corners(picture, "mass")[:, 0].min())
    assert tops[0] - tops[1] == pytest.approx(1e3 * (frames.place[0] - frames.place[k]), rel=1e-9)


def test_a_controller_of_ones_own_is_drawn_too(tmp_path: Path) -> None:
    own = mk.Controller(lambda t, seen: 1.0, every="10 ms")
    motion = mk.simulate(
        mk.Rig(muscle=M, load=mk.FixedEnd(length="100 mm"), command=own, **AIR), "0.2 s", chart=Vessel()
    )
    assert mk.animate(motion, tmp_path / "x.gif", fps=5, size=SIZE).exists()


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"fps": 0.0}, "animate.fps = 0.0: must be from 0.1 to 50"),
        ({"speed": 0.0}, "animate.speed = 0.0: must be a number from 1e-05 to 1000"),
        ({"speed": True}, "animate.speed"),
        ({"speed": 1e-4}, r"makes 200001 frames of 1 s, and there may be 1500; ask for a speed of at least 0.013"),
        ({"cut": True}, "animate.cut = True: has no meaning for a motion"),
        ({"colour": "theta"}, "animate.colour"),
        ({"size": (200, 100)}, "at least 480 by 300 pixels"),
        ({"size": "large"}, "100 to 8000 pixels"),
    ],
)
def test_wrong_input_is_told_before_anything_is_solved(
    lift: mk.Motion, asked: dict[str, Any], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mckibben.film.silhouettes.silhouettes", None)
    with pytest.raises(SpecError, match=said):
        mk.animate(lift, tmp_path / "x.gif", **asked)
    assert not list(tmp_path.iterdir())


def test_speed_is_that_of_a_motion(tmp_path: Path) -> None:
    with pytest.raises(SpecError, match=r"animate\.speed = 2.0: is that of a motion"):
        mk.animate(mk.solve(M, length="115 mm", pressure="1 bar"), tmp_path / "x.gif", speed=2.0)


def test_a_file_is_whole_or_not_there(lift: mk.Motion, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    there = tmp_path / "there.gif"
    there.write_text("mine")
    with pytest.raises(SpecError, match="exists"):
        mk.animate(lift, there)
    with pytest.raises(SpecError, match=r"must end in \.gif"):
        mk.animate(lift, tmp_path / "x.mov")
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(SpecError, match="pip install imageio-ffmpeg"):
        mk.animate(lift, tmp_path / "x.mp4")
    monkeypatch.setattr(moving, "gif", lambda *_: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        mk.animate(lift, tmp_path / "x.gif", fps=2, size=SIZE)
    assert there.read_text() == "mine"
    assert list(tmp_path.iterdir()) == [there]


def test_an_mp4_gets_the_frames_with_even_sides(
    lift: mk.Motion, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Any] = []

    def write_frames(path: str, size: tuple[int, int], fps: float, **_: Any) -> Iterator[None]:
        """Stands for the writer of imageio-ffmpeg, which need not be installed."""
        asked.append((size, fps))
        try:
            while True:
                frame = yield
                assert frame.shape == (size[1], size[0], 3)
                assert frame.dtype == np.uint8
                asked.append(frame)
        finally:
            Path(path).write_bytes(b"film")

    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", SimpleNamespace(write_frames=write_frames))
    assert mk.animate(lift, tmp_path / "x.mp4", fps=3, size=(601, 341)).read_bytes() == b"film"
    (size, fps), *frames = asked
    assert (size, fps, len(frames)) == ((600, 340), pytest.approx(3.0), 4)  # at 0, 1/3, 2/3 and 1 s
    assert (frames[0] != frames[-1]).any()


def test_an_mp4(lift: mk.Motion, tmp_path: Path) -> None:
    pytest.importorskip("imageio_ffmpeg")
    assert b"ftyp" in mk.animate(lift, tmp_path / "x.mp4", fps=5, size=SIZE).read_bytes()[:16]


def test_the_command_draws_a_saved_motion(lift: mk.Motion, tmp_path: Path) -> None:
    saved = mk.save(lift, tmp_path / "motion.nc")
    done = invoke("view", saved, "-o", tmp_path / "x.gif", "--fps", "5", "--speed", "2", "--size", "600x340")
    assert "drawn: " in done.stdout
    with Image.open(tmp_path / "x.gif") as film:
        assert (film.n_frames, film.size) == (3, SIZE)
    refused(invoke("view", saved, "-o", tmp_path / "x.png"), "holds a motion", "mckibben plot")
    refused(invoke("view", saved), "holds a motion")
    still = mk.save(mk.solve(M, length="115 mm", pressure="1 bar"), tmp_path / "state.nc")
    refused(invoke("view", still, "-o", tmp_path / "x.stl", "--speed", "2"), "animation of a motion")
    refused(invoke("view", saved, "-o", tmp_path / "y.gif", "--ghost"), "has no meaning for a motion")

"""Friction in maps and in motion: sliding branches against paths, the rule between them against closed forms."""

import ctypes
import itertools
import math
import runpy
import shutil
import subprocess
import zipfile
from pathlib import Path
from typing import Any

import attrs
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import mckibben as mk
from mckibben.experiments.answer import answer
from mckibben.experiments.sliding import sticking
from mckibben.motion.crossings import rubbed
from mckibben.motion.plant import Plant
from mckibben.motion.regime import FIRST, PER
from mckibben.motion.start import state_of
from mckibben.potential.evaluate import Table, Values, evaluate
from mckibben.potential.rubbing import FrictionAt, Rubs, rubbing, rubbing_at
from mckibben.solver.bench import Bench
from mckibben.solver.held import Held
from mckibben.spec.declared import evolved
from mckibben.units import show
from mckibben.view.interactive import drawn

pytestmark = pytest.mark.motion

BOTH = mk.Friction(coefficient=0.3, arm="0.1 mm", constant="0.01 N mm")
MUSCLE = mk.presets.paper().replace("friction", BOTH)
RANGE = {"length": "85 mm to 110 mm", "pressure": "0.5 to 1.5 bar", "tolerance": 1e-3}


@pytest.fixture(scope="module")
def chart() -> mk.Chart:
    return mk.chart(MUSCLE, **RANGE)


# ---------------------------------------------------------------- the map


def test_the_map_between_the_branches_is_that_without_friction(chart: mk.Chart) -> None:
    plain = mk.chart(mk.presets.paper(), **RANGE)
    h, P = np.random.default_rng(0).uniform([0.07, 0.2e5], [0.12, 2e5], (500, 2)).T
    assert all((a == b).all() for a, b in zip(chart.values(h, P), plain.values(h, P), strict=True))
    assert plain.rubs is plain.rubbing_at is None
    assert_array_equal(plain.friction(h, P), 0.0)
    assert_array_equal(plain.branches(h, P), [plain.force(h, P)] * 2)
    assert plain.friction_error == 0.0
    low, high = chart.branches(h, P)
    assert_allclose(0.5 * (low + high), chart.force(h, P), rtol=1e-12, atol=1e-12)
    assert (high > low).all()


def test_branches_are_those_of_a_path_and_good_to_what_is_said(chart: mk.Chart) -> None:
    """Far one way `run` is on a branch; the error is that at states by which the series were not made."""
    data = chart.data
    h, P = data["check_branch_length"].values, data["check_branch_pressure"].values
    known = data["check_branch_shortening"].values, data["check_branch_lengthening"].values
    off = np.abs(np.array(chart.branches(h, P)) - known).max()
    assert off == pytest.approx(chart.friction_error, rel=1e-9)
    assert chart.friction_error < 0.015 * data.attrs["largest_friction"]
    half = 0.5 * (known[1] - known[0])
    assert_allclose(chart.friction(h, P), half, rtol=1e-3)  # the rest: the state without friction is not in the middle
    found = mk.run(
        MUSCLE, mk.Isobaric(pressure="0.93 bar", length=[0.09, 0.1037, 0.109, 0.1037, 0.097]), tolerance=1e-4
    )
    low, high = chart.branches(found.length, "0.93 bar")
    assert_allclose(found.force[[3, 4]], low[[3, 4]], atol=chart.friction_error)
    assert_allclose(found.force[[1, 2]], high[[1, 2]], atol=chart.friction_error)
    assert any("branches good to" in line for line in chart.notes)


def test_crossings_that_stick_are_as_stiff_as_on_a_cylinder() -> None:
    """H0 n_c k (2 dtheta/dh)^2, at free ends under enough pressure for the ends to matter little."""
    muscle = MUSCLE.replace("ends", "free")
    angle, k, many = np.radians(37.0), 0.01, 26493.648410122617
    for h in (0.07, 0.1, 0.115):
        free = answer(Bench.of(evolved(muscle, friction=None)), Held.of(length=h, pressure=3e5), 1e-6).given
        assert free is not None
        theta = np.arcsin(h / 0.085 * np.sin(angle))
        turning = 2.0 * np.sin(angle) / (0.085 * np.cos(theta))
        assert sticking(Bench.of(muscle), free.state) == pytest.approx(0.085 * many * k * turning**2, rel=1e-4)


def test_one_point_at_a_time_is_the_same_with_slopes_that_agree(chart: mk.Chart) -> None:
    edges = np.array([[0.09, 0.0], [0.095, 0.001], [0.093, 0.0]])  # a shortest length that moves with the pressure
    for table in (chart.table, chart.table._replace(low=edges)):
        check_points(chart.rubs, table)


def check_points(rubs: Rubs | None, table: Table) -> None:
    assert rubs is not None
    at, points = rubbing_at(rubs, table), np.random.default_rng(1).uniform([0.075, 0.3e5], [0.115, 1.8e5], (300, 2))
    many = rubbing(rubs, table, *points.T)
    inside = evaluate(table, *points.T).inside
    assert 0.2 < inside.mean() < 0.8
    for k, (h, P) in enumerate(points.tolist()):
        one = at(h, P)
        assert_allclose(one[:3], [values[k] for values in many[:3]], rtol=1e-11)
        dh, dP = 1e-7, 1.0
        if min(abs(P - table.first), abs(P - table.last)) < dP:
            continue  # a kink
        by_length = (at(h + dh, P).room - at(h - dh, P).room) / (2.0 * dh)
        by_pressure = (at(h, P + dP).room - at(h, P - dP).room) / (2.0 * dP)
        assert_allclose(one.room_by_length, by_length, rtol=1e-5, atol=1e-6)
        assert_allclose(one.room_by_pressure, by_pressure, rtol=1e-4, atol=1e-11)
    assert at(0.3, 1e5).room_by_length == 0.0 == at(0.1, 9e5).room_by_pressure


def test_files_and_tables_have_the_friction(chart: mk.Chart, tmp_path: Path) -> None:
    again = mk.load(mk.save(chart, tmp_path / "chart.nc"))
    assert again == chart
    assert again.muscle.friction == BOTH
    assert_array_equal(again.friction("100 mm", "1 bar"), chart.friction("100 mm", "1 bar"))
    text = mk.export(chart, tmp_path / "map.csv", points=(4, 3)).read_text()
    head, *rows = text.splitlines()
    assert head.split(",")[-2:] == ["friction [N]", "inside"]
    table = np.array([row.split(",") for row in rows], float)
    assert_allclose(table[:, -2], chart.friction(table[:, 0], table[:, 1]), rtol=1e-12)
    assert "friction at the crossings: up to" in mk.export(chart, tmp_path / "muscle.h").read_text()
    broken = attrs.evolve(chart, data=chart.data.drop_vars("sticking"))
    with pytest.raises(mk.SpecError, match="holds no sticking of a chart"):
        mk.load(mk.save(broken, tmp_path / "broken.nc"))


def around(chart: mk.Chart) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Lengths and pressures within and around the range, and the friction there."""
    h, P = np.random.default_rng(7).uniform([0.05, -0.3e5], [0.14, 2.5e5], (400, 2)).T
    return h, P, chart.friction(h, P)


@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc to compile with")
def test_c_tells_the_friction(chart: mk.Chart, tmp_path: Path) -> None:
    (tmp_path / "all.c").write_text("""
#include "arm.h"
void all(int n, const double *h, const double *P, double *out) {
    for (int i = 0; i < n; i++) out[i] = arm_friction(h[i], P[i]);
}
""")
    mk.export(chart, tmp_path / "arm.h", name="arm")
    flags = "-std=c99 -Wall -Wextra -Werror -pedantic -O1 -ffp-contract=off -shared -fPIC all.c -o all.so -lm"
    subprocess.run(["gcc", *flags.split()], cwd=tmp_path, check=True)
    h, P, expected = around(chart)
    h, P, out = np.append(h, np.nan), np.append(P, 1e5), np.zeros(len(h) + 1)
    ctypes.CDLL(str(tmp_path / "all.so")).all(len(h), *(ctypes.c_void_p(one.ctypes.data) for one in (h, P, out)))
    assert_allclose(out[:-1], expected, rtol=1e-12)
    assert np.isnan(out[-1])
    assert expected.min() > 0.1
    assert "friction" not in mk.chart(mk.presets.paper(), **RANGE).to_c()


def test_the_module_for_numpy_alone_tells_the_branches(chart: mk.Chart, tmp_path: Path) -> None:
    module = runpy.run_path(str(mk.export(chart, tmp_path / "muscle_map.py")))
    h, P, expected = around(chart)
    assert_array_equal(module["friction"](h, P), expected)
    assert_array_equal(module["branches"](h, P), chart.branches(h, P))
    assert "FRICTION" not in mk.chart(mk.presets.paper(), **RANGE).to_numpy()


@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc to compile with")
@pytest.mark.parametrize("fmi", [2, 3])
def test_an_fmu_of_the_muscle_tells_the_friction(chart: mk.Chart, fmi: int, tmp_path: Path) -> None:
    fmpy = pytest.importorskip("fmpy")
    from test_export import Running

    path = mk.export(chart, tmp_path / "muscle.fmu", fmi=fmi)
    assert fmpy.validation.validate_fmu(str(path)) == []
    one = Running(path)
    try:
        for h, P, expected in np.array(around(chart)).T[:40].tolist():
            one.set(length=h, pressure=P)
            one.step(1e-3)
            assert one.get("friction") == pytest.approx(expected, rel=1e-12)
    finally:
        one.stop()
    lift = mk.export(chart, tmp_path / "lift.fmu", name="lift", mass="2 kg", fmi=fmi)
    told = fmpy.read_model_description(str(lift))
    assert "friction" not in [variable.name for variable in told.modelVariables]
    with zipfile.ZipFile(lift) as archive:
        assert "without friction" in archive.read("documentation/index.html").decode()


def test_too_much_friction_is_refused() -> None:
    rough = mk.presets.paper().replace("friction", mk.Friction(coefficient=1.0, arm="3 mm"))
    with pytest.raises(mk.SpecError, match="friction: is too much for a map"):
        mk.chart(rough, **RANGE)


# ---------------------------------------------------------------- the rule between the branches


def even(friction: float, sticking: float, by_length: float = 0.0, by_pressure: float = 0.0) -> Any:
    """Friction that changes evenly from (0, 0) on."""

    def at(h: float, P: float) -> FrictionAt:
        root = math.sqrt(sticking)
        f = friction + by_length * h + by_pressure * P
        return FrictionAt(f, sticking, f / root, by_length / root, by_pressure / root)

    return at


def walked(at: Any, points: np.ndarray, e: float = 0.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Force, stored energy and heat so far along points (n, 2), by a midpoint rule."""
    rows, lost = [], 0.0
    for (h, P), (dh, dP) in zip(points, np.diff(points, axis=0, append=points[-1:]), strict=True):
        now = rubbed(at, h, P, 0.0, 0.0, e)
        rows.append((now.force, now.stored, lost))
        half = rubbed(at, h, P, dh, dP, e)
        step = rubbed(at, h + 0.5 * dh, P + 0.5 * dP, dh, dP, e + 0.5 * half.rate)
        e, lost = e + step.rate, lost + step.lost
    return tuple(np.array(rows).T)  # type: ignore[return-value]


def there_and_back(*turns: float, n: int = 2000) -> np.ndarray:
    legs = [np.linspace(a, b, n, endpoint=False) for a, b in itertools.pairwise(turns)]
    lengths = np.concatenate([*legs, [turns[-1]]])
    return np.stack([lengths, np.zeros_like(lengths)], axis=1)


def test_far_one_way_is_a_branch_and_a_turn_begins_by_sticking() -> None:
    points = there_and_back(0.0, 1e-3, 0.0)
    force, _, lost = walked(even(2.0, 1e4), points)
    assert force[2000] == pytest.approx(2.0, rel=1e-7)  # what is left falls by e^-4 with each f / S
    assert force[-1] == pytest.approx(-2.0, rel=2e-6)
    assert (force[2000] - force[2100]) / (points[2000, 0] - points[2100, 0]) == pytest.approx(1e4, rel=1e-9)
    assert lost[2100] == lost[2000]  # nothing slips until the force has turned its sign
    assert (np.diff(lost) >= 0.0).all()


def test_a_loop_encloses_what_it_loses_and_long_ones_little_less_than_a_sharp_corner() -> None:
    """Coulomb: 4 f a for the amplitude a; Prandtl: 4 f (a - f / S); the round corner takes a little from that."""
    f, S, a = 2.0, 1e4, 2e-3
    points = there_and_back(0.0, a, -a, a, n=4000)
    force, stored, lost = walked(even(f, S), points)
    n = 4000
    area, heat = np.trapezoid(force[n:], points[n:, 0]), lost[-1] - lost[n]
    assert area == pytest.approx(heat, rel=1e-6)
    assert stored[-1] == pytest.approx(stored[n], rel=1e-9)
    assert 0.985 < heat / (4.0 * f * (a - f / S)) < 1.0
    assert 4.0 * f * a * (1.0 - 1.25 * f / S / a) < heat
    work = np.concatenate([[0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(points[:, 0]))])
    assert_allclose(work, stored + lost, atol=1e-7 * work.max())


def test_whatever_the_path_no_energy_comes_from_friction() -> None:
    walk = np.random.default_rng(2).normal(0.0, 1.0, (40, 2)).cumsum(axis=0)
    walk = np.clip(walk / np.abs(walk).max(axis=0), -1.0, 1.0) * [1e-3, 0.9]
    fine = np.concatenate([np.linspace(a, b, 200, endpoint=False) for a, b in itertools.pairwise(walk)])
    force, _, lost = walked(even(2.0, 1e4, 300.0, 1.5), fine)
    assert (np.diff(lost) >= 0.0).all()
    assert lost[-1] > 0.0
    assert (np.abs(force) <= (2.0 + 300.0 * fine[:, 0] + 1.5 * fine[:, 1]) * (1.0 + 1e-3)).all()


def test_at_a_fixed_length_pressure_takes_friction_down_with_its_limit_alone() -> None:
    at = even(1.0, 1e4, by_pressure=1.0)
    rise = np.stack([np.zeros(1001), np.linspace(0.0, 1.0, 1001)], axis=1)
    up = walked(at, rise, e=0.01)[0]
    assert_allclose(up, 1.0, rtol=1e-12)  # it sticks as it was
    down = walked(at, rise[::-1], e=0.02)[0]  # from the limit, 2 N at 1 Pa
    assert_allclose(down, 1.0 + rise[::-1, 1], rtol=1e-6)


# ---------------------------------------------------------------- in motion


@attrs.frozen
class Spring:
    """A spring beside a vessel of constant volume, with friction."""

    rub: Any
    k: float = 800.0
    pressures: tuple[float, float] = (-5e4, 2e6)

    def lengths(self, pressure: float) -> tuple[float, float]:
        return 0.05, 0.15

    def at(self, h: float, P: float) -> Any:
        d, V = h - 0.1, 5e-5
        return Values(self.k * d, V, self.k, 0.0, 0.0, 0.5 * self.k * d * d - P * V, True)

    def air_volume(self, h: float, P: float) -> float:
        return 5e-5

    @property
    def rubbing_at(self) -> Any:
        return self.rub


PARTS = {"supply": mk.Supply(gauge="6 bar"), "valve": mk.Valve(C="0.05 L/s/bar", b=0.3)}


def test_a_swing_on_a_muscle_loses_the_same_at_each_turn() -> None:
    """Coulomb: the amplitude falls by 4 f / k in each cycle."""
    f, k, m, a = 0.5, 800.0, 2.0, 0.01
    rig = mk.Rig(muscle=MUSCLE, load=mk.Load(mass=m, gravity=0.0, start=0.1 + a), **PARTS)
    motion = mk.simulate(rig, until="0.8 s", chart=Spring(even(f, 1e6)), points=2001, tolerance=1e-9)
    off = motion.length - 0.1
    turns = [k for k in range(1, len(off) - 1) if (off[k] - off[k - 1]) * (off[k + 1] - off[k]) <= 0.0]
    assert len(turns) == 5
    assert_allclose(np.abs(off[turns]), a - 2.0 * f / k * np.arange(1, 6), atol=3e-6)  # f / S is 0.5 um
    assert_allclose(motion.time[turns], np.pi * math.sqrt(m / k) * np.arange(1, 6), atol=2e-3)
    travelled = a + np.abs(off[turns]).sum() * 2.0 - np.abs(off[turns[-1]])
    lost = np.interp(motion.time[turns[-1]], motion.time, motion.of("lost"))
    assert lost == pytest.approx(f * travelled, rel=1e-3)
    assert np.abs(motion.of("balance")).max() < 1e-8 * motion.of("internal").max()


def test_without_friction_the_state_has_nothing_more() -> None:
    rig = mk.Rig(muscle=mk.presets.paper(), load=mk.FixedEnd(length="100 mm"), **PARTS)
    plain = Plant.of(rig, [attrs.evolve(Spring(None))])
    assert plain.rubs == {}
    assert len(state_of(plain, 0.1)) == FIRST + PER
    assert len(state_of(Plant.of(rig, [Spring(even(1.0, 1e4))]), 0.1)) == FIRST + PER + 1


SLOW = [0.0, 2.0, 4.0, 6.0]
PUSHES = [40.0, 75.0, 55.0, 75.0]


@pytest.mark.parametrize("method", ["LSODA", "Radau"])
def test_a_slow_loop_is_that_of_a_path(chart: mk.Chart, method: str) -> None:
    """Lengths and the energy lost in a loop of force against `run`; the pressure is that of a large vessel."""
    load = mk.Load(mass="0.05 kg", gravity=0.0, damping="1 N s/m", push=mk.Series(SLOW, PUSHES), start="98 mm")
    rig = mk.Rig(muscle=MUSCLE, load=load, pressure="1 bar", tube="1 m^3", **PARTS)
    motion = mk.simulate(rig, until="6 s", chart=chart, points=121, method=method)
    some = np.flatnonzero(motion.time % 0.25 < 1e-9)[2:]
    push = np.interp(motion.time[some], SLOW, PUSHES)
    found = path(tuple(push.tolist()))
    friction = chart.friction(found.length, "1 bar") / chart.stiffness(found.length, "1 bar")
    assert np.abs(motion.length[some] - found.length).max() < 0.1 * friction.max()
    assert np.abs(motion.length[some] - chart.length_for("1 bar", push)).max() > 0.8 * friction.max()
    of = [np.flatnonzero(np.isclose(motion.time[some], t))[0] for t in (2.0, 6.0)]
    lost = [values[of[1]] - values[of[0]] for values in (found.data["dissipated"].values, motion.of("lost")[some])]
    assert lost[1] == pytest.approx(lost[0], rel=0.03)
    assert any("friction at the crossings goes by the length alone" in line for line in motion.notes)
    assert np.abs(motion.of("balance")).max() < 1e-4 * motion.of("work").max() + 1e-9 * motion.of("internal").max()


PATHS: dict[tuple[float, ...], mk.Result] = {}


def path(push: tuple[float, ...]) -> mk.Result:
    """Lengths under forces at 1 bar, by `run`, once for both solvers."""
    if push not in PATHS:
        PATHS[push] = mk.run(MUSCLE, mk.Step(force=list(push), pressure="1 bar", points=len(push)), tolerance=1e-3)
    return PATHS[push]


def test_of_two_muscles_one_may_have_friction() -> None:
    pulley = mk.Pulley(radius="20 mm", inertia="1e-3 kg m^2", length="101 mm", start=0.2)
    rig = mk.Rig(muscle=MUSCLE, antagonist=MUSCLE, load=pulley, **PARTS)
    found = []
    for charts in ((Spring(even(0.2, 1e5)), Spring(None)), (Spring(None), Spring(even(0.2, 1e5)))):
        motion = mk.simulate(rig, until="0.3 s", chart=charts, tolerance=1e-9)
        assert np.abs(motion.of("balance")).max() < 1e-7
        found.append(motion)
    assert_allclose(found[0].angle, found[1].angle, atol=1e-6)  # two springs alike: friction does the same on either
    assert found[0].of("lost")[-1] == pytest.approx(found[1].of("lost")[-1], rel=1e-5)
    assert found[0].of("lost")[-1] > 0.1 * (0.5 * 1600.0 * 0.004**2)
    assert_allclose(found[0].force[:, 0] - 800.0 * (found[0].length[:, 0] - 0.1), 0.0, atol=0.2 * (1 + 1e-6))


def test_a_frequency_response_is_that_without_friction() -> None:
    rig = mk.Rig(muscle=MUSCLE, load=mk.Load(mass="2 kg", gravity=0.0), **PARTS)
    found = mk.bode(rig, frequency="1 Hz", chart=Spring(even(0.5, 1e6)))
    assert found.natural_frequency == pytest.approx(math.sqrt(800.0 / 2.0) / (2.0 * math.pi), rel=1e-6)


def test_the_interactive_picture_shows_the_branches(chart: mk.Chart) -> None:
    pytest.importorskip("plotly")
    lines = drawn(chart).figure.data
    low, high = [line for line in lines if line.name == "with friction"][-2:]  # of the highest pressure
    length = chart.muscle.rest_length * (1.0 - 0.01 * low.x)
    for line, force in zip((low, high), chart.branches(length, chart.pressures[1]), strict=True):
        assert_allclose(line.y, force, rtol=1e-9, atol=1e-9)
    (curve,) = (line for line in lines if line.name == show(chart.pressures[1], "Pa", 3))
    told = curve.text[0].split("<br>")[-1]
    assert told == f"with friction: ± {show(float(chart.friction(length[0], chart.pressures[1])), 'N', 3)}"

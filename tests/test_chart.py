"""The map of a muscle: errors at other states, slopes that agree, what lies outside, the map in other programs."""

import ctypes
import importlib.util
import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import jax
import numpy as np
import pytest
from scipy.io import loadmat
from typer.testing import CliRunner

import mckibben as mk
from mckibben.app.cli import app
from mckibben.charts.edges import narrowed
from mckibben.charts.sample import KEPT, Samples
from mckibben.charts.series import Edges, fitted
from mckibben.potential.evaluate import Table, Values, in_blocks
from mckibben.potential.grid import COLUMNS

pytestmark = pytest.mark.charts

RANGE = {"length": "60 mm to 115 mm", "pressure": "0 to 3 bar"}
EVERYWHERE = np.random.default_rng(0).uniform([0.03, -0.5e5], [0.15, 3.5e5], (4000, 2)).T
"""Lengths and pressures within and around the range."""


@pytest.fixture(scope="module")
def chart() -> mk.Chart:
    return mk.chart(mk.presets.paper(), **RANGE)


@pytest.fixture(scope="module")
def moving() -> Table:
    """A map whose shortest length depends on the pressure, of made-up states: W = (h - 2)^2 (1 + P) - P h^2."""
    low = np.linspace(1.0, 1.4, 5) + 0.05 * np.array([0.0, 1.0, 0.0, 1.0, 0.0])
    h, P = (one.ravel() for one in np.meshgrid(np.linspace(1.0, 3.0, 15), np.linspace(0.0, 1.0, 12)))
    volume, energy = h**2 - (h - 2.0) ** 2, (h - 2.0) ** 2
    numbers = {
        "force": 2.0 * (h - 2.0) * (1.0 + P) - 2.0 * P * h,
        "volume": volume,
        "energy": energy,
        "largest_radius": h,
    }
    seen = Samples(h, P, numbers, np.ones(len(h), bool))
    return fitted(seen, Edges(0.0, 1.0, low, np.full(5, 3.0), 0.1), (2.0, 1.0), 1e-9, (6, 6), lambda table: 0.0)


def test_the_error_is_below_what_was_asked_for_and_what_is_stated_holds_elsewhere(chart: mk.Chart) -> None:
    assert chart.converged
    assert chart.error < chart.tolerance == 1e-4
    curve = mk.run(mk.presets.paper(), mk.Isometric(length="101.37 mm", pressure="0.11 to 2.93 bar", points=21))
    found = chart.values(curve.length, curve.pressure)
    assert np.abs(found.force - curve.force).max() < 2.0 * chart.force_error
    assert np.abs(found.volume - curve.volume).max() < 2.0 * chart.volume_error
    assert (
        np.abs(chart.largest_radius(curve.length, curve.pressure) - curve.data["r"].max("v")).max()
        < 2.0 * chart.radius_error
    )
    off = chart.stored_energy(curve.length, curve.pressure) - curve.data["energy"]
    assert np.abs(off).max() < chart.volume_error * 3e5  # W + P V, and V is good to that
    assert found.inside.all()


def test_the_states_by_which_the_error_was_measured_are_kept_and_give_it_again(chart: mk.Chart) -> None:
    data = chart.data
    off = chart.force(data["check_length"].values, data["check_pressure"].values) - data["check_force"].values
    assert np.abs(off).max() == pytest.approx(chart.force_error, rel=1e-9)


def by_differences(h: np.ndarray, P: np.ndarray) -> np.ndarray:
    """dF/dh by central differences of solved states, with Richardson's step."""
    steps = 5e-5 * np.array([-2.0, -1.0, 1.0, 2.0])
    forces = [[mk.solve(mk.presets.paper(), length=x + d, pressure=y, tolerance=1e-9).force for d in steps.tolist()]
              for x, y in zip(h.tolist(), P.tolist(), strict=True)]  # fmt: skip
    far, near, ahead, further = np.array(forces).T
    return np.asarray((8.0 * (ahead - near) - (further - far)) / (12.0 * steps[2]))


def test_the_stated_error_of_the_stiffness_holds_elsewhere(chart: mk.Chart) -> None:
    h, P = np.random.default_rng(3).uniform([0.0605, 0.02e5], [0.1145, 2.98e5], (8, 2)).T
    off = np.abs(chart.stiffness(h, P) - by_differences(h, P))
    assert off.max() < 2.0 * chart.stiffness_error
    data, largest = chart.data, float(chart.data.attrs["largest_stiffness"])
    assert chart.stiffness_error < 1e-3 * largest
    h, P, own = (data[f"check_{name}"].values for name in ("length", "pressure", "stiffness"))
    assert np.abs(own).max() == largest
    assert np.abs(chart.stiffness(h, P) - own).max() == pytest.approx(chart.stiffness_error, rel=1e-9)
    some = np.flatnonzero((h > 0.0605) & (h < 0.1145))[::37]
    np.testing.assert_allclose(own[some], by_differences(h[some], P[some]), rtol=0.0, atol=2e-5 * largest)
    assert "stiffness" in chart.summary.index
    assert any("stiffness" in line for line in chart.told)


def test_a_map_from_before_the_stiffness_was_measured_loads(chart: mk.Chart, tmp_path: Path) -> None:
    data = chart.data.drop_vars("check_stiffness")
    data.attrs = {name: value for name, value in chart.data.attrs.items() if "stiff" not in name}
    old = mk.load(mk.save(mk.Chart(chart.muscle, data), tmp_path / "old.nc"))
    assert np.isnan(old.stiffness_error)
    assert "stiffness" not in old.summary.index
    assert old.force("100 mm", "1 bar") == chart.force("100 mm", "1 bar")
    assert not any("nan" in line for line in old.told)


def slopes(at: Any, name: str, h: np.ndarray, P: np.ndarray, dh: float, dP: float) -> np.ndarray:
    ahead, behind = (getattr(at(h + sign * dh, P + sign * dP), name) for sign in (1.0, -1.0))
    return np.asarray((ahead - behind) / (2.0 * max(dh, dP)))


def check_slopes(at: Any, h: np.ndarray, P: np.ndarray, dh: float, dP: float, near: np.ndarray) -> None:
    """Each slope against central differences of what it is the slope of, but for points near a kink of it."""
    found = at(h, P)
    pairs = (
        ("potential", dh, 0.0, found.force), ("force", dh, 0.0, found.stiffness),
        ("volume", dh, 0.0, found.volume_by_length),
        ("potential", 0.0, dP, -found.volume), ("force", 0.0, dP, -found.volume_by_length),
        ("volume", 0.0, dP, found.volume_by_pressure),
    )  # fmt: skip
    for name, by_length, by_pressure, said in pairs:
        off = np.abs(slopes(at, name, h, P, by_length, by_pressure) - said)
        assert off[~near].max() < 2e-6 * np.abs(said).max(), name


def test_slopes_are_those_of_the_potential_inside_and_outside(chart: mk.Chart) -> None:
    h, P = EVERYWHERE
    near = (np.abs(P) < 100.0) | (np.abs(P - 3e5) < 100.0)
    check_slopes(chart.values, h, P, 1e-7, 1.0, near)


def test_so_they_are_where_the_edge_moves(moving: Table) -> None:
    h, P = np.random.default_rng(1).uniform([0.5, -0.2], [3.5, 1.2], (2000, 2)).T
    near = (np.abs(P) < 1e-4) | (np.abs(P - 1.0) < 1e-4)
    check_slopes(lambda h, P: in_blocks(moving, h, P), h, P, 1e-6, 1e-6, near)
    seen = in_blocks(moving, h, P)
    assert 0.3 < seen.inside.mean() < 0.7
    assert np.allclose(seen.force[seen.inside], (2.0 * (h - 2.0) * (1.0 + P) - 2.0 * P * h)[seen.inside], atol=1e-8)


def test_outside_the_force_goes_on_without_falling_back_or_exploding(chart: mk.Chart) -> None:
    h, table = np.linspace(0.001, 0.6, 4000), chart.table
    steepest = table.springs[1, 1] + chart.largest_force / table.width  # the first width takes up all of the force
    for P in np.linspace(0.0, 3e5, 7):
        found = chart.values(h, P)
        assert all(np.isfinite(values).all() for values in found)
        assert (found.stiffness > 0.0).all()
        assert found.stiffness.max() < steepest
        assert found.volume.min() > 0.0
        assert found.volume.max() < 1.01 * chart.data.attrs["largest_volume"]
        assert (found.inside == ((h >= 0.06) & (h <= 0.115))).all()
    over = chart.values(0.1, [3e5, 4e5, 5e5])
    assert over.force[2] - over.force[1] == pytest.approx(over.force[1] - over.force[0])
    assert over.inside.tolist() == [True, False, False]


def test_points_without_a_state_narrow_the_range(chart: mk.Chart) -> None:
    h, P = (one.ravel() for one in np.meshgrid(np.linspace(0.06, 0.115, 12), np.linspace(0.0, 3e5, 9)))
    edges = Edges(0.0, 3e5, np.array([0.06]), np.array([0.115]), 1e3)
    numbers = {name: np.ones(len(h)) for name in KEPT}
    good = h > 0.071 - 5e-8 * P / 3.0
    narrower = narrowed(edges, Samples(h, P, numbers, good))
    assert narrower.low[0] > h[~good].max()
    assert narrower.low[0] < h[~good].max() + 0.001
    assert narrower.high[0] == 0.115
    with pytest.raises(mk.SpecError, match="in the middle of the range"):
        narrowed(edges, Samples(h, P, numbers, (h < 0.08) | (h > 0.10)))


def test_lengths_and_pressures_for_a_force(chart: mk.Chart) -> None:
    pressures = np.linspace(0.2e5, 3e5, 5)
    free = chart.free_length(pressures)
    assert np.abs(chart.force(free, pressures)).max() < 1e-9
    assert free[0] == pytest.approx(mk.run(chart.muscle, mk.FreeContraction(pressure="0.2 bar")).length[-1], rel=1e-5)
    assert chart.force(chart.length_for("1 bar", 50.0), "1 bar") == pytest.approx(50.0, rel=1e-12)
    assert chart.force("100 mm", chart.pressure_for("100 mm", "50 N")) == pytest.approx(50.0, rel=1e-12)
    assert np.isnan(chart.length_for("1 bar", 1e4))
    assert np.isnan(chart.pressure_for("100 mm", 1e4))
    assert chart.force("70 mm", "1 bar") < 0.0 == chart.force("70 mm", "1 bar", slack=True)


def test_one_point_at_a_time_is_the_same(chart: mk.Chart) -> None:
    for h, P in ((0.1, 1e5), (0.06, 0.0), (0.13, 1e5), (0.1, 3.5e5), (0.03, -1e3)):
        one, many = chart.at(h, P), chart.values(h, P)
        for name in Values._fields:
            assert getattr(one, name) == pytest.approx(getattr(many, name).item(), rel=1e-10), name


def test_jax_tells_the_same_and_differentiates_it(chart: mk.Chart) -> None:
    h, P = EVERYWHERE
    at, found = chart.jax(), chart.values(h, P)
    seen = jax.jit(at)(h, P)
    for name in Values._fields:
        expected = np.asarray(getattr(found, name), float)
        assert np.abs(np.asarray(getattr(seen, name), float) - expected).max() <= 1e-11 * np.abs(expected).max(), name
    stiffness = jax.jit(jax.vmap(jax.grad(lambda h, P: at(h, P).force)))(h, P)
    np.testing.assert_allclose(stiffness, found.stiffness, rtol=0.0, atol=1e-11 * np.abs(found.stiffness).max())


def test_a_saved_map_is_the_same_to_the_last_bit(chart: mk.Chart, tmp_path: Path) -> None:
    again = mk.load(mk.save(chart, tmp_path / "chart.nc"))
    assert isinstance(again, mk.Chart)
    assert again == chart
    h, P = EVERYWHERE
    assert all((a == b).all() for a, b in zip(again.values(h, P), chart.values(h, P), strict=True))
    assert (again.largest_radius(h, P) == chart.largest_radius(h, P)).all()
    table = np.loadtxt(mk.save(chart, tmp_path / "chart.csv"), delimiter=",", skiprows=1)
    np.testing.assert_allclose(table[:, 2], chart.force(table[:, 0], table[:, 1]), rtol=1e-12, atol=1e-9)


CANCELS = Values._fields.index("volume_by_pressure")
"""A difference of two larger terms."""
C_PROGRAM = """
#include "muscle.h"
void all(int count, const double *h, const double *P, double *out) {
    for (int i = 0; i < count; i++, out += 8) {
        muscle_values v;
        muscle_evaluate(h[i], P[i], &v);
        out[0] = v.force; out[1] = v.volume; out[2] = v.stiffness; out[3] = v.volume_by_length;
        out[4] = v.volume_by_pressure; out[5] = v.potential; out[6] = v.inside;
        out[7] = muscle_largest_radius(h[i], P[i]);
        if (muscle_force(h[i], P[i]) != v.force || muscle_inside(h[i], P[i]) != v.inside) out[0] = NAN;
        if (muscle_force_slack(h[i], P[i]) != (v.force > 0.0 ? v.force : 0.0)) out[0] = NAN;
    }
}
"""


@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc to compile with")
@pytest.mark.parametrize("edge", ["still", "moving"])
def test_c_tells_the_same(chart: mk.Chart, moving: Table, edge: str, tmp_path: Path) -> None:
    from mckibben.potential.c_source import c_source
    from mckibben.potential.evaluate import largest_radius

    (tmp_path / "muscle.h").write_text(chart.to_c() if edge == "still" else c_source(moving, (), "muscle"))
    (tmp_path / "all.c").write_text(C_PROGRAM)
    flags = "-std=c99 -Wall -Wextra -Werror -pedantic -O1 -ffp-contract=off -shared -fPIC all.c -o all.so -lm"
    subprocess.run(["gcc", *flags.split()], cwd=tmp_path, check=True)
    h, P = EVERYWHERE if edge == "still" else np.random.default_rng(1).uniform([0.5, -0.2], [3.5, 1.2], (2000, 2)).T
    table = chart.table if edge == "still" else moving
    h, P, out = np.ascontiguousarray(h), np.ascontiguousarray(P), np.zeros((len(h), 8))
    ctypes.CDLL(str(tmp_path / "all.so")).all(len(h), *(ctypes.c_void_p(one.ctypes.data) for one in (h, P, out)))
    found = [*in_blocks(table, h, P), largest_radius(table, h, P)]
    for k, expected in enumerate(found):
        scale = np.abs(np.asarray(expected, float)).max()
        most = 1e-11 if k == CANCELS else 1e-12
        assert np.abs(out[:, k] - expected).max() <= most * scale, k
    nothing, out = np.full(1, np.nan), np.zeros((1, 8))  # what is no number gives none, and reads nothing elsewhere
    pointers = (ctypes.c_void_p(one.ctypes.data) for one in (h, nothing, out))
    ctypes.CDLL(str(tmp_path / "all.so")).all(1, *pointers)
    assert np.isnan(out[0, [0, 7]]).all()


def test_the_module_for_numpy_alone_tells_the_same(chart: mk.Chart, tmp_path: Path) -> None:
    path = mk.export(chart, tmp_path / "muscle_map.py")
    assert "mckibben." not in "".join(line for line in path.read_text().splitlines() if "import" in line)
    spec = importlib.util.spec_from_file_location("muscle_map", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    h, P = EVERYWHERE
    assert (module.force(h, P) == chart.force(h, P)).all()
    assert (module.radius(h, P) == chart.largest_radius(h, P)).all()
    assert module.force(0.07, 1e5, slack=True) == 0.0


def test_tables_for_other_programs(chart: mk.Chart, tmp_path: Path) -> None:
    held = loadmat(mk.export(chart, tmp_path / "map.mat", points=(12, 7)))
    assert held["force"].shape == (12, 7)
    np.testing.assert_allclose(held["force"], chart.force(held["length"], held["pressure"].T), rtol=1e-12, atol=1e-9)
    middle = np.diff(held["length"][:, 0]) / 2.0 + held["length"][:-1, 0]
    between = 0.5 * (held["force"][1:] + held["force"][:-1])
    assert np.abs(between - chart.force(middle[:, None], held["pressure"].T)).max() <= held["force_error"].item()
    same = mk.export(chart, tmp_path / "again.mat", points=(12, 7)).read_bytes()
    assert same == (tmp_path / "map.mat").read_bytes()
    told = json.loads(mk.export(chart, tmp_path / "map.json", points=(12, 7)).read_text())
    np.testing.assert_array_equal(told["volume"], held["volume"])
    assert told["errors"]["force"] == chart.force_error
    assert any("assumed" in line for line in told["notes"])


def test_tables_for_modelica(chart: mk.Chart, tmp_path: Path) -> None:
    """As the standard library reads them: "#1", comments, "double name(rows,columns)", and as many numbers."""
    text = mk.export(chart, tmp_path / "map.txt", points=(12, 7)).read_text()
    assert text.startswith("#1\n")
    body = "\n".join(line.partition("#")[0] for line in text.splitlines())
    found = {}
    for part in body.split("double ")[1:]:
        head, _, numbers = part.partition("\n")
        name, rows, columns = re.fullmatch(r"(\w+)\((\d+),(\d+)\) *", head).groups()
        found[name] = np.array(numbers.split(), float).reshape(int(rows), int(columns))
    assert list(found) == list(COLUMNS)[2:]
    h, P = found["force"][1:, 0], found["force"][0, 1:]
    assert (len(h), len(P)) == (12, 7)
    np.testing.assert_array_equal(found["force"][1:, 1:], chart.force(h[:, None], P))
    np.testing.assert_array_equal(found["largest_radius"][1:, 1:], chart.largest_radius(h[:, None], P))
    assert any("assumed" in line for line in text.splitlines() if line.startswith("# "))


def test_pictures_and_notebooks_say_the_error(chart: mk.Chart) -> None:
    figure = mk.plot(chart)
    assert [axes.get_xlabel() for axes in figure.axes[:2]] == ["Contraction (%)", "Length (mm)"]
    assert f"{100.0 * chart.error:.2g} % of the largest" in figure.get_suptitle()
    assert "0.00" in chart._repr_html_()


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"length": "60 mm to 130 mm"}, "chart.length = 130 mm: must be below 126.2 mm"),
        ({"length": "60 mm"}, "must be a range"),
        ({"length": "60 mm to 60 mm"}, "is empty"),
        ({"length": "60 to 115"}, "unit"),
        ({"pressure": "1 bar to 1 bar"}, "is empty"),
        ({"pressure": [0.0, 3.0]}, "without a unit"),
        ({"tolerance": 1e-9}, "must be from 1e-06 to 0.01"),
    ],
)
def test_what_is_no_range_is_refused(asked: dict[str, Any], said: str) -> None:
    with pytest.raises(mk.SpecError, match=said):
        mk.chart(mk.presets.paper(), **(RANGE | asked))


def test_wrong_points_are_refused(chart: mk.Chart) -> None:
    with pytest.raises(mk.SpecError, match=r"chart.length = .*10 quarks"):
        chart.force("10 quarks", 1e5)
    with pytest.raises(mk.SpecError, match="finite"):
        chart.force([0.1, np.nan], 1e5)
    with pytest.raises(mk.SpecError, match="letters, digits"):
        chart.to_c("my muscle")
    with pytest.raises(mk.SpecError, match=r"muscle.xyz: must end in"):
        mk.export(chart, "muscle.xyz")


def test_commands_from_a_case_to_c(tmp_path: Path) -> None:
    case = tmp_path / "case.toml"
    case.write_text('[muscle]\npreset = "paper"\n')

    def invoke(*words: object) -> Any:
        return CliRunner().invoke(app, [str(word) for word in words])

    words = ("--length", RANGE["length"], "--pressure", RANGE["pressure"])
    done = invoke("chart", case, *words, "-o", tmp_path / "chart.nc")
    assert done.exit_code == 0, done.output
    assert "largest error" in done.stdout
    told = invoke("info", tmp_path / "chart.nc")
    assert "a map of 60 mm to 115 mm, 0 bar to 3 bar" in told.stdout
    done = invoke("export", tmp_path / "chart.nc", "-o", tmp_path / "muscle.h", "--name", "arm")
    assert done.exit_code == 0, done.output
    assert "arm_evaluate(double length" in (tmp_path / "muscle.h").read_text()
    assert invoke("export", case, "-o", tmp_path / "x.h").exit_code == 2
    assert invoke("plot", tmp_path / "chart.nc").exit_code == 0

"""Maps in other programs, each run there: FMUs by fmpy, models by MuJoCo."""

import ctypes
import math
import re
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import fmpy
import mujoco
import numpy as np
import pytest
import xarray as xr
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu
from typer.testing import CliRunner

import mckibben as mk
from mckibben.app.cli import app
from mckibben.charts.sample import Samples
from mckibben.charts.series import Edges, fitted
from mckibben.exports.affine import affine
from mckibben.potential.table import variables_of
from mckibben.spec.text import to_toml

pytestmark = pytest.mark.exports

LENGTHS, LAST = (0.06, 0.115), 3e5
THREAD, TURNS = 0.1412, 1.06
WALL, FREE = 200.0, 0.09
"""Stiffness [N/m] and length without force [m] of the wall."""
GRAVITY, GAS, RHO = 9.80665, 287.05, 1.185
needs_compiler = pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")


def volume(h: Any) -> Any:
    return (THREAD**2 * h - h**3) / (4.0 * math.pi * TURNS**2)


def volume_slope(h: Any) -> Any:
    return (THREAD**2 - 3.0 * h**2) / (4.0 * math.pi * TURNS**2)


def force(h: Any, P: Any) -> Any:
    return WALL * (h - FREE) - P * volume_slope(h)


def stiffness(h: Any, P: Any) -> Any:
    return WALL + 6.0 * P * h / (4.0 * math.pi * TURNS**2)


@pytest.fixture(scope="module")
def chart() -> mk.Chart:
    """The map of a cylinder whose threads do not stretch, with a wall that is a spring: known in closed form."""
    h, P = (one.ravel() for one in np.meshgrid(np.linspace(*LENGTHS, 15), np.linspace(0.0, LAST, 12)))
    energy = 0.5 * WALL * (h - FREE) ** 2
    radius = np.sqrt(volume(h) / (math.pi * h))
    numbers = {"force": force(h, P), "volume": volume(h), "energy": energy, "largest_radius": radius}
    edges = Edges(0.0, LAST, *(np.array([end]) for end in LENGTHS), 3e3)
    seen = Samples(h, P, numbers, np.ones(len(h), bool))
    table = fitted(seen, edges, (0.5 * sum(LENGTHS), 0.5 * (LENGTHS[1] - LENGTHS[0])), 1e-9, (6, 4), lambda table: 1.0)
    about = {
        "muscle": to_toml(mk.presets.paper()), "notes": "made up -- for tests", "tolerance": 1e-3, "converged": 1,
        "force_error": 1e-9, "volume_error": 1e-15, "radius_error": 1e-6, "largest_volume": float(volume(h).max()),
        "largest_force": float(np.abs(numbers["force"]).max()), "largest_radius": float(radius.max()),
        "rubber_inside": 2e-6, "asked_shortest": LENGTHS[0], "asked_longest": LENGTHS[1], "states": len(h),
        "mckibben_version": "0",
    }  # fmt: skip
    checks = {"length": h, "pressure": P, "force": numbers["force"], "volume": numbers["volume"], "radius": radius}
    held = variables_of(table) | {f"check_{name}": (("check",), values, {}) for name, values in checks.items()}
    made = mk.Chart(mk.presets.paper(), xr.Dataset(held, attrs=about))
    np.testing.assert_allclose(made.force(h, P), force(h, P), rtol=0.0, atol=1e-9)
    return made


class Running:
    """An FMU under way, of either version of FMI."""

    def __init__(self, path: Path, **parameters: float) -> None:
        about = fmpy.read_model_description(str(path))
        self.third = about.fmiVersion == "3.0"
        self.folder = fmpy.extract(str(path))
        self.numbers = {variable.name: variable.valueReference for variable in about.modelVariables}
        self.flags = {variable.name for variable in about.modelVariables if variable.type == "Boolean"}
        self.said: list[str] = []
        self.slave: FMU2Slave | FMU3Slave = fmpy.instantiate_fmu(
            self.folder, about, "CoSimulation", logger=lambda *words: self.said.append(words[-1].decode())
        )
        self.time = 0.0
        self.start(**parameters)

    def start(self, **parameters: float) -> None:
        if not self.third:
            self.slave.setupExperiment()
        self.set(**parameters)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def set(self, **values: float) -> None:
        for name, value in values.items():
            real = self.slave.setFloat64 if self.third else self.slave.setReal
            tell = self.slave.setBoolean if name in self.flags else real
            tell([self.numbers[name]], [value])

    def step(self, span: float) -> None:
        self.slave.doStep(self.time, span)
        self.time += span

    def get(self, name: str) -> float:
        real = self.slave.getFloat64 if self.third else self.slave.getReal
        ask = self.slave.getBoolean if name in self.flags else real
        return float(ask([self.numbers[name]])[0])

    def stop(self) -> None:
        self.slave.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


@pytest.fixture(scope="module")
def fmus(chart: mk.Chart, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("fmus")
    return {
        "muscle": mk.export(chart, folder / "muscle.fmu"),
        "lift": mk.export(chart, folder / "lift.fmu", name="lift", mass="2 kg"),
        "muscle 3": mk.export(chart, folder / "muscle3.fmu", fmi=3),
        "lift 3": mk.export(chart, folder / "lift3.fmu", name="lift", mass="2 kg", fmi=3),
    }


@pytest.fixture
def running(fmus: dict[str, Path]) -> Iterator[Callable[..., Running]]:
    started: list[Running] = []

    def run(name: str, **parameters: float) -> Running:
        started.append(Running(fmus[name], **parameters))
        return started[-1]

    yield run
    for one in started:
        one.stop()


@needs_compiler
@pytest.mark.parametrize("name", ["muscle", "lift", "muscle 3", "lift 3"])
def test_fmus_are_valid_and_hold_their_source(fmus: dict[str, Path], name: str) -> None:
    assert validate_fmu(str(fmus[name])) == []
    assert set(fmpy.supported_platforms(str(fmus[name]))) == {"c-code", fmpy.platform}
    with zipfile.ZipFile(fmus[name]) as archive:
        assert "made up" in archive.read("documentation/index.html").decode()


@needs_compiler
def test_equal_maps_are_equal_fmus(chart: mk.Chart, fmus: dict[str, Path], tmp_path: Path) -> None:
    assert mk.export(chart, tmp_path / "again.fmu").read_bytes() == fmus["muscle"].read_bytes()


@needs_compiler
def test_an_fmu_tells_what_the_map_does_inside_and_outside(chart: mk.Chart, running: Any) -> None:
    one = running("muscle")
    h, P = np.random.default_rng(0).uniform([0.03, -0.5e5], [0.15, 3.5e5], (300, 2)).T
    names = ("force", "volume", "stiffness", "volume_by_length", "volume_by_pressure", "inside", "largest_radius")
    seen = []
    for k in range(len(h)):
        one.set(length=h[k], pressure=P[k])
        one.step(1e-3)
        seen.append([one.get(name) for name in names])
    values = chart.values(h, P)
    for name, told in zip(names, np.array(seen).T, strict=True):
        expected = np.asarray(chart.largest_radius(h, P) if name == "largest_radius" else getattr(values, name), float)
        # of a cylinder of threads the volume does not depend on the pressure: what is left are rounding errors
        scale = np.abs(expected).max() if name != "volume_by_pressure" else np.abs(values.volume).max() / LAST
        assert np.abs(told - expected).max() <= 1e-12 * scale, name
    assert 0.2 < values.inside.mean() < 0.8


@needs_compiler
@pytest.mark.parametrize("name", ["muscle", "lift"])
def test_fmi_3_gives_the_same_numbers_as_fmi_2(running: Any, name: str) -> None:
    both = [running(name + version) for version in ("", " 3")]
    outputs = sorted(both[0].numbers)
    assert {*both[1].numbers} == {*outputs, "time"}
    seen: list[list[list[float]]] = [[], []]
    for one, rows in zip(both, seen, strict=True):
        for k in range(20):
            one.set(**({"pressure": 1e4 * k, "length": 0.11 - 1e-3 * k} if name == "muscle" else {"command": 1.0}))
            one.step(5e-3)
            rows.append([one.get(output) for output in outputs])
    assert seen[0] == seen[1]
    assert both[1].get("time") == pytest.approx(0.1)


@needs_compiler
def test_every_function_of_fmi_3_is_there(fmus: dict[str, Path], tmp_path: Path) -> None:
    header = (Path(fmpy.__file__).parent / "c-code" / "fmi3Functions.h").read_text()
    names = set(re.findall(r"^FMI3_Export fmi3\w+TYPE +(fmi3\w+);", header, re.MULTILINE))
    assert len(names) == 75
    folder = fmpy.extract(str(fmus["muscle 3"]), str(tmp_path))
    (path,) = Path(folder, "binaries").glob("*/muscle.*")
    library = ctypes.CDLL(str(path))
    assert [name for name in sorted(names) if not hasattr(library, name)] == []


@needs_compiler
@pytest.mark.parametrize("name", ["muscle", "muscle 3"])
def test_a_slack_muscle_does_not_push_and_inputs_count_at_once(chart: mk.Chart, running: Any, name: str) -> None:
    one = running(name, slack=True)
    one.set(length=0.07, pressure=1e5)
    assert chart.force(0.07, 1e5) < 0.0 == one.get("force") == one.get("stiffness")
    one.set(length=0.1)
    assert one.get("force") == pytest.approx(float(chart.force(0.1, 1e5)), rel=1e-12)


@needs_compiler
def test_the_rig_starts_at_rest_and_stays_there(chart: mk.Chart, running: Any) -> None:
    one = running("lift", pressure_start=1e5)
    resting = float(chart.length_for(1e5, 2.0 * GRAVITY))
    assert one.get("length") == pytest.approx(resting, rel=1e-10)
    one.step(1.0)
    assert one.get("length") == pytest.approx(resting, rel=1e-10)
    assert one.get("pressure") == pytest.approx(1e5, rel=1e-10)
    one.set(push=10.0)
    one.step(20.0)
    held = (one.get("pressure") + 101325.0) * one.get("air_volume")
    assert held == pytest.approx((1e5 + 101325.0) * (volume(resting) - 2e-6), rel=1e-8)  # isothermal, none flows
    assert one.get("length") == pytest.approx(float(chart.length_for(one.get("pressure"), 2 * GRAVITY + 10)), rel=1e-8)


@needs_compiler
@pytest.mark.parametrize("exponent", [1.0, 1.4])
def test_choked_air_comes_at_a_constant_rate(running: Any, exponent: float) -> None:
    """A heavy load on a table hardly moves, so the volume is rigid: dp/dt = n C rho0 p1 R T/V at 20 degC."""
    one = running("lift", mass=1e9, gravity=0.0, length_start=0.1, exponent=exponent, tube=1e-5, supply=6e5,
                  conductance=2e-9)  # fmt: skip
    one.set(command=1.0)
    one.step(0.02)
    room = volume(0.1) - 2e-6 + 1e-5
    rate = exponent * 2e-9 * RHO * (6e5 + 101325.0) * GAS * 293.15 / room
    assert one.get("pressure") == pytest.approx(0.02 * rate, rel=1e-6)
    assert one.get("inflow") == pytest.approx(2e-9 * RHO * (6e5 + 101325.0), rel=1e-12)
    # all the air is as warm as p V = m R T says
    assert one.get("temperature") == pytest.approx(
        (one.get("pressure") + 101325.0) * room / (one.get("air_mass") * GAS), rel=1e-6
    )
    assert (one.get("temperature") > 294.0) == (exponent > 1.0)


@needs_compiler
def test_air_of_one_temperature_leaves_as_an_exponential(running: Any) -> None:
    """While the flow to the atmosphere is choked, p falls as exp(-C rho0 R T t/V)."""
    one = running("lift", mass=1e9, gravity=0.0, length_start=0.1, pressure_start=5e5, vent=2e-9)
    one.set(command=-1.0)
    one.step(0.1)
    falls = 2e-9 * RHO * GAS * 293.15 / (volume(0.1) - 2e-6)
    assert one.get("pressure") + 101325.0 == pytest.approx((5e5 + 101325.0) * math.exp(-0.1 * falls), rel=1e-6)
    assert one.get("pressure") > 101325.0 / 0.3 - 101325.0


@needs_compiler
def test_the_frequency_is_that_of_muscle_and_enclosed_air(running: Any) -> None:
    one = running("lift", pressure_start=1e5, damping=0.0, step=1e-3)
    h, p = one.get("length"), 1e5 + 101325.0
    one.slave.reset()
    one.start(pressure_start=1e5, damping=0.0, step=1e-3, length_start=h + 1e-6)
    seen = []
    for _ in range(2000):
        one.step(1e-3)
        seen.append(one.get("length") - h)
    closed = stiffness(h, 1e5) + p * volume_slope(h) ** 2 / (volume(h) - 2e-6)
    assert frequency(np.array(seen), 1e-3) == pytest.approx(math.sqrt(closed / 2.0), rel=1e-3)
    assert max(seen[-200:]) == pytest.approx(1e-6, rel=0.02)  # nothing damps


def frequency(seen: np.ndarray, step: float) -> float:
    """Angular frequency by the rising zeros, the mean taken off."""
    seen = seen - 0.5 * (seen.max() + seen.min())
    k = np.flatnonzero((seen[:-1] < 0.0) & (seen[1:] >= 0.0))
    zeros = k + seen[k] / (seen[k] - seen[k + 1])
    return float(2.0 * math.pi * (len(zeros) - 1) / (zeros[-1] - zeros[0]) / step)


@needs_compiler
def test_a_lift_by_a_valve_does_not_depend_on_the_steps(running: Any) -> None:
    ends = []
    for longest, span in ((1e-5, 0.1), (2e-3, 0.1), (2e-3, 0.01)):
        one = running("lift", step=longest, pressure_start=0.2e5, exponent=1.2)
        one.set(command=1.0)
        for _ in range(round(0.2 / span)):
            one.step(span)
        ends.append([one.get("length"), 1e-6 * one.get("pressure"), 1e3 * one.get("air_mass")])
    np.testing.assert_allclose(ends[1:], [ends[0]] * 2, rtol=1e-5)


@needs_compiler
def test_a_lift_is_that_of_simulate(chart: mk.Chart, running: Any) -> None:
    """Two programs: C with its own steps, and SciPy's solver on the equations of motion."""
    air = {"supply": 2e5, "conductance": 1e-9, "tube": 5e-6}
    one, seen = running("lift", pressure_start=0.2e5, damping=30.0, **air), []
    one.set(command=1.0)
    for _ in range(30):
        one.step(0.01)
        seen.append([one.get("length"), one.get("pressure"), one.get("air_mass")])
    rig = mk.Rig(
        chart.muscle, mk.Load(mass="2 kg", damping="30 N s/m"), supply=mk.Supply(gauge="2 bar"), tube="5 mL",
        valve=mk.Valve(C=1e-9, b=0.3), pressure="0.2 bar", command=mk.Constant(1.0), air=mk.Isothermal(),
    )  # fmt: skip
    motion = mk.simulate(rig, until="0.3 s", chart=chart, points=31, tolerance=1e-9)
    lifted = motion.length[0] - motion.length[-1]
    assert lifted > 5e-3
    np.testing.assert_allclose([row[0] for row in seen], motion.length[1:], rtol=0.0, atol=2e-7 * lifted)
    np.testing.assert_allclose([row[1] for row in seen], motion.pressure[1:], rtol=2e-7)
    np.testing.assert_allclose([row[2] for row in seen], motion.data["mass"].values[1:], rtol=2e-7)


@needs_compiler
@pytest.mark.parametrize("name", ["lift", "lift 3"])
def test_an_fmu_goes_back_to_a_kept_state(running: Any, name: str) -> None:
    one = running(name, pressure_start=0.2e5)
    one.set(command=1.0)
    one.step(0.05)
    slave = one.slave
    keep, back, forget = (
        (slave.getFMUState, slave.setFMUState, slave.freeFMUState)
        if one.third
        else (slave.getFMUstate, slave.setFMUstate, slave.freeFMUstate)
    )
    kept = keep()
    one.step(0.05)
    first = one.get("length")
    back(kept)
    forget(kept)
    one.step(0.05)
    assert one.get("length") == first


@needs_compiler
@pytest.mark.parametrize("version", ["", " 3"])
def test_an_fmu_says_what_is_wrong(running: Any, version: str) -> None:
    one = running("muscle" + version)
    for wrong, said in (({"force": 1.0}, "output"), ({"slack": True}, "parameter"), ({"length": math.nan}, "finite")):
        with pytest.raises(fmpy.fmi1.FMICallException):
            one.set(**wrong)
        assert said in one.said[-1]
    assert one.get("length") > 0.0
    rig = running("lift" + version)
    rig.slave.reset()
    with pytest.raises(fmpy.fmi1.FMICallException):
        rig.start(critical_ratio=1.0)
    assert "critical_ratio must be" in rig.said[-1]


def test_without_a_compiler_there_is_no_fmu(chart: mk.Chart, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(mk.SpecError, match=r"CC says no-such-compiler, which is not there; install one"):
        mk.export(chart, tmp_path / "muscle.fmu")
    monkeypatch.delenv("CC")
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(mk.SpecError, match="none of cc, gcc, clang is there"):
        mk.export(chart, tmp_path / "muscle.fmu")
    assert not list(tmp_path.iterdir())


def test_a_compiler_that_fails_is_quoted(chart: mk.Chart, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    broken = tmp_path / "broken"
    broken.write_text("#!/bin/sh\necho no such target >&2\nexit 1\n")
    broken.chmod(0o755)
    monkeypatch.setenv("CC", f"{broken} -m64")
    with pytest.raises(mk.SpecError, match=r"failed on .*: no such target"):
        mk.export(chart, tmp_path / "muscle.fmu")


@pytest.mark.parametrize(
    ("file", "asked", "said"),
    [
        ("muscle.h", {"mass": "2 kg"}, r"export.mass.*is for .fmu and .xml"),
        ("muscle.xml", {"mass": "2 N"}, r"export.mass"),
        ("muscle.xml", {"mass": 0.0}, r"export.mass.*must be above 0"),
        ("muscle.xml", {"name": "my muscle"}, r"export.name.*letters, digits"),
        ("muscle.xml", {"points": (1, 2)}, r"export.points"),
        ("muscle.xml", {"fmi": 3}, r"export.fmi.*is for .fmu"),
        ("muscle.fmu", {"fmi": 1}, r"export.fmi.*must be 2 or 3"),
    ],
)
def test_what_makes_no_sense_is_refused(
    chart: mk.Chart, file: str, asked: dict[str, Any], said: str, tmp_path: Path
) -> None:
    with pytest.raises(mk.SpecError, match=said):
        mk.export(chart, tmp_path / file, **asked)


def hung(chart: mk.Chart, folder: Path, mass: float) -> tuple[Any, Any]:
    path = mk.export(chart, folder / "muscle.xml", mass=mass, force=True)
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    return model, data


def test_the_affine_law_is_as_good_as_it_says(chart: mk.Chart) -> None:
    law = affine(chart)
    h, P = (one.ravel() for one in np.meshgrid(np.linspace(*LENGTHS, 101), np.linspace(0.0, LAST, 77)))
    off = [abs(law.force(*point) - max(force(*point), 0.0)) for point in zip(h, P, strict=True)]
    assert law.error == pytest.approx(max(off), rel=5e-3)
    assert law.error < 0.05 * law.largest
    assert law.stiffness(0.0) >= 0.0
    assert law.force(law.length(20.0, 1e5), 1e5) == pytest.approx(20.0)


def test_a_mass_hangs_on_the_affine_actuator_in_mujoco(chart: mk.Chart, tmp_path: Path) -> None:
    law, (model, data) = affine(chart), hung(chart, tmp_path, 4.0)
    data.ctrl[0] = 2e5
    mujoco.mj_step(model, data, 16000)
    assert data.ten_length[0] == pytest.approx(law.length(4.0 * GRAVITY, 2e5), rel=1e-9)
    assert data.actuator_force[0] == pytest.approx(-4.0 * GRAVITY, rel=1e-9)
    assert data.act[0] == pytest.approx(2e5, rel=1e-9)
    off = abs(data.ten_length[0] - chart.length_for(2e5, 4.0 * GRAVITY))
    assert 1e-5 < off < law.error / stiffness(LENGTHS[0], 2e5)
    data.ctrl[0] = 9e5  # beyond the range: held at its end
    mujoco.mj_step(model, data, 4000)
    assert data.act[0] == pytest.approx(LAST, rel=1e-9)
    text = (tmp_path / "muscle.xml").read_text()
    assert f"within its range: {law.error:.2g} N" in text
    assert "made up - - for tests" in text


def test_the_tendon_has_a_stop_at_the_longest_length(chart: mk.Chart, tmp_path: Path) -> None:
    model, data = hung(chart, tmp_path, 50.0)
    mujoco.mj_step(model, data, 3000)
    assert LENGTHS[1] < data.ten_length[0] < LENGTHS[1] + 0.005


def test_the_map_itself_in_mujoco_by_a_callback(chart: mk.Chart, tmp_path: Path) -> None:
    model, data = hung(chart, tmp_path, 4.0)
    kept = model.actuator_gainprm.copy()
    data.ctrl[0] = 2e5
    with mk.in_mujoco(model, {"muscle": chart}):
        mujoco.mj_step(model, data, 10000)
        resting = data.ten_length[0]
        assert resting == pytest.approx(float(chart.length_for(2e5, 4.0 * GRAVITY)), rel=1e-7)
        model.tendon_damping[:] = 0.0
        data.qpos[0] += 1e-5
        seen = []
        for _ in range(1500):
            mujoco.mj_step(model, data)
            seen.append(data.ten_length[0] - resting)
        expected = math.sqrt(stiffness(resting, 2e5) / 4.0)
        assert frequency(np.array(seen), model.opt.timestep) == pytest.approx(expected, rel=3e-4)
        data.qpos[0] += 0.04
        mujoco.mj_forward(model, data)
        assert chart.force(data.ten_length[0], 2e5) < 0.0 == data.actuator_force[0]
    assert mujoco.get_mjcb_act_bias() is None
    assert model.actuator_biastype[0] == mujoco.mjtBias.mjBIAS_AFFINE
    assert (model.actuator_gainprm == kept).all()
    with pytest.raises(mk.SpecError, match=r"muscel.*did you mean .muscle."), mk.in_mujoco(model, {"muscel": chart}):
        pass


@needs_compiler
@pytest.mark.skipif(sys.platform == "win32", reason="the command in the file is one for a shell")
def test_the_map_itself_in_mujoco_by_a_plugin(chart: mk.Chart, tmp_path: Path) -> None:
    text = mk.export(chart, tmp_path / "tested.c", name="tested").read_text()
    command = re.search(r"M=\$.*\n.*-lm", text)
    extension = re.search(r"<extension>.*</extension>", text)
    actuator = re.search(r"<plugin name.*?/>", text, re.DOTALL)
    assert command and extension and actuator  # noqa: PT018
    said = command[0].replace("python", sys.executable).replace("-O2", "-O1 -Wall -Wextra -Werror")
    subprocess.run(["sh", "-c", said], cwd=tmp_path, check=True)
    mujoco.mj_loadPluginLibrary(str(tmp_path / "tested.so"))

    model = mk.export(chart, tmp_path / "tested.xml", name="tested", mass=4.0).read_text()
    model = re.sub(r"<general.*?/>", actuator[0], model, flags=re.DOTALL)
    model = mujoco.MjModel.from_xml_string(model.replace("<worldbody>", f"{extension[0]}<worldbody>"))
    data = mujoco.MjData(model)
    for length, pressure in np.random.default_rng(1).uniform([0.03, 0.0], [0.15, 3e5], (50, 2)):
        data.qpos[0] += data.ten_length[0] - length
        data.act[0] = pressure
        mujoco.mj_forward(model, data)
        expected = -max(float(chart.force(data.ten_length[0], pressure)), 0.0)
        assert data.actuator_force[0] == pytest.approx(expected, rel=1e-12, abs=1e-10)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    data.ctrl[0] = 2e5
    mujoco.mj_step(model, data, 16000)
    assert data.ten_length[0] == pytest.approx(float(chart.length_for(2e5, 4.0 * GRAVITY)), rel=1e-9)


def test_commands_write_them_and_say_the_error(chart: mk.Chart, tmp_path: Path) -> None:
    saved = mk.save(chart, tmp_path / "chart.nc")

    def invoke(*words: object) -> Any:
        return CliRunner().invoke(app, ["export", str(saved), *map(str, words)])

    done = invoke("-o", tmp_path / "arm.xml", "--name", "arm", "--mass", "3 kg")
    assert done.exit_code == 0, done.output
    assert "the affine actuator is off the map by up to" in done.stdout
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "arm.xml")).body_mass[1] == pytest.approx(3.0)
    done = invoke("-o", tmp_path / "arm.h", "--mass", "3 kg")
    assert done.exit_code == 2
    assert "export.mass" in done.output
    done = invoke("-o", tmp_path / "arm.h", "--fmi", "3")
    assert done.exit_code == 2
    assert "export.fmi" in done.output


@needs_compiler
def test_the_command_writes_fmi_3(chart: mk.Chart, tmp_path: Path) -> None:
    saved, written = tmp_path / "chart.nc", tmp_path / "muscle.fmu"
    mk.save(chart, saved)
    done = CliRunner().invoke(app, ["export", str(saved), "-o", str(written), "--fmi", "3"])
    assert done.exit_code == 0, done.output
    assert fmpy.read_model_description(str(written)).fmiVersion == "3.0"

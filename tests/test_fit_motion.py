"""Fits of motions: a known rig comes back from noisy recordings; recordings as people write them."""

from pathlib import Path
from typing import Any

import attrs
import numpy as np
import pytest
from numpy.testing import assert_allclose
from test_simulate import Cylinder

import mckibben as mk
from mckibben.motionfits.fit import free_of_rig
from mckibben.motionfits.misfit import MotionMisfit

pytestmark = pytest.mark.motionfits

CHART = Cylinder(k=500.0)
RIG = mk.Rig(
    muscle=mk.presets.paper(), load=mk.Load(mass="2 kg", damping="20 N s/m", start="100 mm"),
    supply=mk.Supply(gauge="2 bar"), valve=mk.Valve(C="0.05 L/s/bar", b=0.3), command=mk.Jump(1.0, at="0.1 s"),
    viscosity=mk.Viscosity(damping="30 N s/m"),
)  # fmt: skip
START = attrs.evolve(RIG, valve=mk.Valve(C="0.1 L/s/bar", b=0.3), viscosity=mk.Viscosity(damping="10 N s/m"))
FREE = {"valve.C": "0.02 L/s/bar to 0.2 L/s/bar", "viscosity.damping": "5 N s/m to 100 N s/m"}
TRUTH = {"valve.C": 5e-10, "viscosity.damping": 30.0}
NOISE = {"length": 1e-4, "pressure": 1e3}


@pytest.fixture(scope="module")
def recording() -> mk.Recording:
    seen = mk.simulate(RIG, "1 s", chart=CHART, points=31, tolerance=1e-8)
    random = np.random.default_rng(0)
    table = {"time [s]": seen.time, "length [m]": seen.length, "pressure [Pa]": seen.pressure}
    for name, size in NOISE.items():
        head = next(one for one in table if one.startswith(name))
        table[head] = table[head] + size * random.normal(size=31)
    return mk.read_recording(table)


@pytest.fixture(scope="module")
def found(recording: mk.Recording) -> mk.MotionFit:
    return mk.fit_motion(START, recording, FREE, chart=CHART)


def test_what_is_known_comes_back(found: mk.MotionFit) -> None:
    """Valve and viscosity within their intervals, and the size of the noise of each quantity."""
    assert found.converged
    assert found.undetermined == ()
    for name, truth in TRUTH.items():
        low, high = found.intervals.loc[name]
        assert low < truth < high
        assert high - low < 0.2 * truth
    for name, size in NOISE.items():
        assert_allclose(found.rms[name], size, rtol=0.25)  # of 31 values: 13 % standard error
        told = found.data["size"].values[found.data["quantity"].values == name]
        assert_allclose(told, found.rms[name] * np.sqrt(62 / 60), rtol=0.02)
    assert found.values["valve.C"] == found.rig.valve.C
    assert found.rig.load == RIG.load


def test_errors_are_those_of_the_linear_model(found: mk.MotionFit, recording: mk.Recording) -> None:
    """(J^T J)^-1, with J by differences of `simulate` itself in the numbers, over the sizes of the errors."""
    columns = []
    for name in FREE:
        owner, field = name.split(".")
        ends = []
        for way in (1.001, 0.999):
            part = attrs.evolve(getattr(found.rig, owner), **{field: way * found.values[name]})
            moved = mk.simulate(attrs.evolve(found.rig, **{owner: part}), "1 s", chart=CHART, points=31, tolerance=1e-9)
            ends.append(np.concatenate([moved.length, moved.pressure]))
        columns.append((ends[0] - ends[1]) / (0.002 * found.values[name]) / found.data["size"].values)
    J = np.stack(columns, axis=1)
    assert_allclose(found.data["covariance"].values, np.linalg.inv(J.T @ J), rtol=5e-3)


def test_known_errors_and_a_prior(recording: mk.Recording) -> None:
    """Errors as told stay; what is known beforehand counts as one more measurement."""
    errors = {"length": "0.1 mm", "pressure": "0.01 bar"}
    free = {"viscosity.damping": FREE["viscosity.damping"]}
    rig = attrs.evolve(RIG, viscosity=START.viscosity)
    plain = mk.fit_motion(rig, recording, free, errors=errors, chart=CHART, starts=1)
    assert_allclose(plain.data["size"], np.repeat([1e-4, 1e3], 31), rtol=1e-12)
    sd = float(plain.data["error"].values[0])
    known = mk.fit_motion(rig, recording, free, errors=errors, chart=CHART, starts=1,
                          priors={"viscosity.damping": (28.0, sd)})  # fmt: skip
    assert_allclose(known.data["error"], sd / np.sqrt(2.0), rtol=0.02)
    assert_allclose(known.values["viscosity.damping"], 0.5 * (plain.values["viscosity.damping"] + 28.0), rtol=2e-3)


def test_it_is_kept(found: mk.MotionFit, tmp_path: Path) -> None:
    assert mk.load(mk.save(found, tmp_path / "motion.nc")) == found
    written = mk.save(found, tmp_path / "motion.csv").read_text().splitlines()
    assert written[0] == "quantity,time [s],measured,predicted,size"
    assert len(written) == 1 + found.data.sizes["point"]
    assert "valve.C: " in (tmp_path / "motion.csv.txt").read_text()
    assert "valve.C" in mk.plot(found).get_suptitle()
    assert repr(found).startswith("<MotionFit: 2 numbers to 62 values, rms length 0.")


def test_motions_that_stop_are_no_motions(recording: mk.Recording) -> None:
    """Numbers of which no motion comes give NaN, from which a search takes a smaller step."""
    heavy = attrs.evolve(RIG, load=mk.Load(mass="60 kg"))  # which no spring of this map holds
    free = free_of_rig(heavy, {"valve.C": FREE["valve.C"]}, {})
    misfit = MotionMisfit(heavy, free, recording, (CHART,), 1e-6, {"length": 1.0, "pressure": 1.0})
    assert not misfit(misfit.start).found.all()
    with pytest.raises(mk.SpecError, match="not reached to its end by any of the 1 rigs tried"):
        mk.fit_motion(heavy, recording, {"valve.C": FREE["valve.C"]}, chart=CHART, starts=1)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"free": {}}, "must name at least one number"),
        ({"free": {"muscle.braid.angle": "30 deg to 40 deg"}}, "find it from forces at rest by mk.fit"),
        ({"free": {"valve.c": "1 L/s/bar to 2 L/s/bar"}}, 'did you mean "valve.C"'),
        ({"free": {"valve.b": "0.2 to 1.2"}}, "valve.b"),
        ({"free": FREE, "errors": {"force": "1 N"}}, "errors.force: was not measured"),
        ({"free": FREE, "errors": {"length": "0 mm"}}, "must be above 0"),
        ({"free": FREE, "priors": {"tube": "1 mL +- 1 mL"}}, "priors.tube: is not free"),
        ({"free": FREE, "loss": "cubic"}, "loss"),
    ],
)
def test_bad_input(options: dict[str, Any], message: str, recording: mk.Recording) -> None:
    with pytest.raises(mk.SpecError, match=message):
        mk.fit_motion(RIG, recording, **options, chart=CHART)


def test_an_angle_needs_a_pulley() -> None:
    recording = mk.read_recording({"time [s]": [0, 1], "angle [deg]": [0, 90]})
    assert_allclose(recording.values["angle"], [0.0, np.pi / 2.0])
    with pytest.raises(mk.SpecError, match="this rig has no pulley"):
        mk.fit_motion(RIG, recording, FREE, chart=CHART)


def test_a_recording_of_a_file(tmp_path: Path) -> None:
    """Units below the heads, decimal commas, a time that begins later, a gap, another pressure beside it."""
    lines = ["Zeit;supply pressure;pressure;Kraft", "ms;bar;bar abs;N", "500,0;6,1;1,01325;10,5", "600;6,1;;11",
             "700;6,0;2,01325;12,5"]  # fmt: skip
    path = tmp_path / "run.csv"
    path.write_text("\n".join(lines))
    found = mk.read_recording(path)
    assert_allclose(found.time, [0.0, 0.2], atol=1e-12)
    assert_allclose(found.values["pressure"], [0.0, 1e5], atol=1e-6)
    assert_allclose(found.values["force"], [10.5, 12.5])
    assert found.assumptions == ("1 rows without a number left out",)


@pytest.mark.parametrize(
    ("table", "options", "message"),
    [
        ({"t [s]": [0, 1], "speed [m/s]": [0, 1]}, {}, "has no column of length, pressure, force or angle"),
        ({"p [bar]": [0, 1], "force [N]": [0, 1]}, {}, "has no column of time"),
        ({"t [s]": [0, 1], "p [bar]": [0, 1], "pressure [kPa]": [0, 1]}, {}, "several columns could be the pressure"),
        ({"t": [0, 1], "p [bar]": [0, 1]}, {}, 'the time has no unit; say units={"time": "s"}'),
        ({"t [s]": [0, 2, 1], "p [bar]": [0, 1, 1]}, {}, "times must rise"),
        ({"t [s]": [0, 1], "p [bar]": [0, "x"]}, {}, "must be a number"),
        ({"t [s]": [0, 1], "p [mm]": [0, 1]}, {}, "pressure in mm"),
        ({"t [s]": [0, 1], "p [bar]": [0, 1]}, {"units": {"presure": "bar"}}, 'did you mean "pressure"'),
    ],
)
def test_wrong_recordings(table: dict[str, Any], options: dict[str, Any], message: str) -> None:
    with pytest.raises(mk.SpecError) as raised:
        mk.read_recording(table, **options)
    assert message in str(raised.value)

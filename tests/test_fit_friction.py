"""Fits of muscles whose crossings rub: forces along the path of a test, and what loading and unloading tell."""

import attrs
import numpy as np
import pytest
from numpy.testing import assert_allclose

import mckibben as mk
from mckibben.fitting import choice
from mckibben.fitting.free import free_numbers
from mckibben.fitting.misfit import Points
from mckibben.fitting.paths import PathMisfit

pytestmark = pytest.mark.fitting

MUSCLE = mk.presets.paper().replace("friction", mk.Friction(constant="0.02 N mm"))
# At 0.1 MPa, from 85 mm: length [mm], force [N], by a code of its own (as in test_friction.py).
PATH = [
    (115.0, 102.52823807896088), (112.0, 86.72190112279961), (107.0, 67.64519828653685),
    (100.0, 44.86309429911333), (103.0, 56.15325017883358), (115.0, 102.52823807896094),
]  # fmt: skip
LOOP = 1e-3 * np.array([92.0, 97.0, 102.0, 107.0, 110.0, 108.0, 105.0, 100.0, 96.0, 91.0])
CONSTANT = {"friction.constant": "0 N mm to 0.05 N mm"}
ANGLE = {"braid.angle": "35 deg to 39 deg"}
TRUTH = {"friction.constant": 2e-5, "braid.angle": np.radians(37.0)}


def measured(length: np.ndarray, force: np.ndarray) -> mk.Data:
    return mk.read_data({"length [m]": length, "pressure [Pa]": np.full(len(length), 1e5), "force [N]": force})


def misfit_of(data: mk.Data, free: dict[str, str], muscle: mk.Muscle = MUSCLE) -> PathMisfit:
    return PathMisfit(muscle, free_numbers(muscle, free, {}), Points.of(muscle, (data,), {}), 24)


@pytest.fixture(scope="module")
def exact() -> np.ndarray:
    """Forces of the loop [N]."""
    misfit = misfit_of(measured(LOOP, LOOP), CONSTANT)
    return misfit(misfit.start).force


@pytest.fixture(scope="module")
def noisy(exact: np.ndarray) -> mk.Data:
    return measured(LOOP, exact + 0.3 * np.random.default_rng(4).normal(size=len(exact)))


def test_forces_along_a_path_by_another_code() -> None:
    length, force = np.array(PATH).T
    misfit = misfit_of(measured(1e-3 * length, force), CONSTANT)
    assert_allclose(misfit(misfit.start).force, force, atol=7e-6)
    assert misfit.error(misfit.start) < 1e-4
    left_out = np.arange(len(PATH)) != 3  # a turning point that is not compared is on the path all the same
    points = attrs.evolve(misfit.path, weights=np.where(left_out, 1.0, 0.0))
    misfit = PathMisfit(MUSCLE, misfit.free, points, 24)
    assert_allclose(misfit(misfit.start).force, force[left_out], atol=7e-6)


def test_derivatives_inside_and_at_a_bound(noisy: mk.Data) -> None:
    """By the numbers themselves, from differences of other sizes, and to one side."""
    found = []
    for constant, angle in (("0 N mm to 0.05 N mm", "35 deg to 39 deg"), ("0.02 N mm to 0.1 N mm", "37 deg to 45 deg")):
        misfit = misfit_of(noisy, {"friction.constant": constant, "braid.angle": angle})
        x = misfit.start
        found.append(misfit(x).slopes / [one.slope(float(at)) for one, at in zip(misfit.free, x, strict=True)])
    assert_allclose(found[0], found[1], rtol=2e-5)
    up = np.arange(len(LOOP)) < 5
    assert (np.sign(found[0][:, 0]) == np.where(up, 1.0, -1.0)).all()  # friction pulls as it lengthens


def test_what_is_known_comes_back(noisy: mk.Data) -> None:
    """Angle and moment together, within their intervals; no worse than the truth."""
    start = MUSCLE.replace("friction.constant", "0.005 N mm").replace("braid.angle", "36 deg")
    fit = mk.fit(start, noisy, CONSTANT | ANGLE, starts=1, force_error="0.3 N")
    assert fit.converged
    for name, truth in TRUTH.items():
        low, high = fit.intervals.loc[name]
        assert low < truth < high
    # Half the height of the loop is some 1 N for these 2e-5 N m: ten points of 0.3 N tell it to a tenth.
    assert_allclose(fit.data["error"].values[0], 2e-5 * 0.3 / (1.0 * np.sqrt(10.0)), rtol=0.2)
    assert abs(fit.data["correlation"].values[0, 1]) < 0.3
    assert fit.muscle.friction.constant == fit.values["friction.constant"]


def test_whether_friction_is_needed(noisy: mk.Data, monkeypatch: pytest.MonkeyPatch) -> None:
    """The model with it predicts points it has not seen to their noise; the one without misses half the loop."""
    monkeypatch.setattr(choice, "FOLDS", 2)
    models = {"without": (MUSCLE.replace("friction", None), ANGLE), "with": (MUSCLE, CONSTANT)}
    found = mk.compare_models(models, noisy, starts=1)
    assert found.best == "with"
    assert found.errors["with"] < 0.5 < 1.0 < found.errors["without"]
    assert len(found.force) == len(LOOP) - 1  # all but the turning point


def test_prediction_has_both_branches(noisy: mk.Data) -> None:
    fit = mk.fit(MUSCLE, noisy, CONSTANT, starts=1)
    assert_allclose(fit.forces(noisy), fit.data["predicted"], rtol=1e-12)
    test = mk.Isobaric(length=LOOP[[0, 4, 8]].tolist(), pressure="1 bar")
    found = fit.predict(test, tolerance=1e-5)
    assert_allclose(found.curve.force, fit.forces(noisy)[[0, 4, 8]], rtol=1e-6)
    assert ((found.error > 0.0) & (found.error < 0.5)).all()


def test_points_in_no_order_are_refused() -> None:
    length = 1e-3 * np.random.default_rng(0).permutation(np.linspace(90.0, 110.0, 20))
    with pytest.raises(mk.SpecError, match="come in no order, and with friction forces depend on the path"):
        mk.fit(MUSCLE, measured(length, length), CONSTANT)


def test_a_chamber_that_slides_is_fitted_along_the_path() -> None:
    """Forces are those of runs, and derivatives those of runs beside it."""
    bellows = mk.Chamber(law=mk.Bellows(axial_stiffness=2.0), lies="inside")
    muscle = mk.presets.paper().replace("chamber", bellows)
    muscle = muscle.replace("friction", mk.Friction(chamber_coefficient=0.01))
    lengths = [0.11, 0.105, 0.1, 0.104]

    def force(coefficient: float) -> np.ndarray:
        own = muscle.replace("friction.chamber_coefficient", coefficient)
        return mk.run(own, mk.Isobaric(pressure="0.05 bar", length=lengths), tolerance=1e-2).force

    data = mk.read_data({"length [m]": lengths, "pressure [Pa]": [5e3] * 4, "force [N]": force(0.01)})
    misfit = misfit_of(data, {"friction.chamber_coefficient": "0.005 to 0.015"}, muscle)
    seen = misfit(misfit.start)
    assert_allclose(seen.force, data.force, rtol=1e-5)
    by_runs = (force(0.0101) - force(0.0099)) / 2e-4
    (slope,) = (seen.slopes / [one.slope(float(at)) for one, at in zip(misfit.free, misfit.start, strict=True)]).T
    assert_allclose(slope, by_runs, rtol=0.02, atol=0.02 * np.abs(by_runs).max())
    assert np.abs(by_runs).max() > 0.1

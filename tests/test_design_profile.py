"""Designs that aim at a profile r(z): the measure against single runs, the best against a grid, wrong input."""

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import mckibben as mk
from mckibben.designing.designfile import read_design
from mckibben.designing.reading import lined_of, places_of, value_of
from mckibben.designing.space import space_of
from mckibben.designing.states import states_at
from mckibben.measure.meridian import radii_at
from mckibben.spec.change import changed_muscle

pytestmark = pytest.mark.designing

AT = {"pressure": "1 bar"}
SHARES = [0.0, 0.1, 0.35, 0.5, 0.8]
STEEP = mk.presets.paper().replace("braid.angle", "46 deg")
STRETCHING = mk.presets.paper().replace("braid.fibre.stretch", True)
BOTH = "braid.angle_profile.angle"


def programmed(*angles: float, **others: Any) -> mk.Muscle:
    """Angles [deg] beyond the first end, whose own is 42 deg."""
    made = mk.AngleProfile(angle=[f"{angle!r} deg" for angle in angles], **others)
    return changed_muscle(STRETCHING, {"braid.angle": "42 deg", "braid.angle_profile": made})


WAISTED = programmed(50.0, 44.0, mirrored=True)
LOPSIDED = STEEP.replace("end_radii", ["12.5 mm", "11.5 mm"])


def worth(measures: list[Any], muscle: mk.Muscle, tolerance: float = 1e-5, **angles: np.ndarray) -> list[np.ndarray]:
    """Measures of many muscles by their angles, through the batches."""
    columns = {f"{BOTH}[{name[-1]}]": values[:, None] for name, values in angles.items()}
    count = len(next(iter(angles.values()))) if angles else 1
    places = [place for one in measures for place in places_of(one)]
    seen = states_at(muscle, columns, count, places, tolerance, lined_of(measures))
    assert seen is not None
    return [value_of(one, seen) for one in measures]


@cache
def radii(muscle: mk.Muscle, where: tuple[float, ...], shares: bool, **held: Any) -> np.ndarray:
    """Radius of a single run at places, by a spline through its fields."""
    data = mk.solve(muscle, **AT, **held, tolerance=1e-5).data
    z, r = data["z"].values, data["r"].values
    return np.asarray(CubicSpline(z, r)(np.array(where) * (z[-1] if shares else 1.0)))


FREE: dict[str, Any] = {"force": 0.0}
CASES = [(STEEP, [FREE, {"contraction": "2 %"}]), (LOPSIDED, [{"length": "80 mm"}])]


@pytest.mark.parametrize(("muscle", "held"), CASES, ids=["uniform", "lopsided"])
def test_the_measure_is_its_definition(muscle: mk.Muscle, held: list[dict[str, Any]]) -> None:
    """Wanted is what a single run has, and everywhere 1 mm more; then one place alone is off, by 1 mm."""
    z = (0.0, 0.02, 0.05, 0.07)
    measures = []
    for state in held:
        by = {"z": z} if "length" in state else {"at": SHARES}
        found = radii(muscle, tuple(*by.values()), "at" in by, **state)
        alone = found + 1e-3 * (np.arange(len(found)) == 2)
        free = {} if state is FREE else state
        measures += [mk.ProfileMiss(**AT, **by, r=r.tolist(), **free) for r in (found, found + 1e-3, alone)]
    values = np.array([float(value[0]) for value in worth(measures, muscle)]).reshape(len(held), 3)
    counts = np.array([len(z) if "length" in state else len(SHARES) for state in held])
    exact = np.stack([0.0 * counts, 1e-3 + 0.0 * counts, 1e-3 / np.sqrt(counts)], axis=1)
    np.testing.assert_allclose(values, exact, atol=2e-7)


def test_radii_of_a_known_meridian() -> None:
    """A cubic r(z) is exact; beyond the ends, and where the wall turns back, nothing is known."""
    z = np.array([0.0, 0.01, 0.025, 0.04])
    r, slope = 0.01 + 0.2 * z - 40.0 * z**3, 0.2 - 120.0 * z**2
    at = np.array([-0.001, 0.0, 0.017, 0.04 + 1e-9, 0.041])
    nan = float("nan")
    exact = [nan, 0.01, 0.01 + 0.2 * 0.017 - 40.0 * 0.017**3, r[-1], nan]
    np.testing.assert_allclose(radii_at(np.arctan(slope), r, z, at), exact, rtol=1e-12)
    assert np.isnan(radii_at(np.arctan(slope), r, z[[0, 2, 1, 3]], at)).all()
    assert np.isnan(radii_at(np.array([0.0, 1.0, 1.7, 0.0]), r, z, at)).all()


ANGLES = {f"{BOTH}[0]": "46 deg to 54 deg", f"{BOTH}[1]": "40 deg to 48 deg"}


@pytest.fixture(scope="module")
def wanted() -> mk.ProfileMiss:
    """A profile that no two angles have: that of one pair, less 0.2 mm at a place."""
    found = radii(programmed(49.0, 45.0, mirrored=True), (0.2, 0.35, 0.5), True, force=0.0)
    return mk.ProfileMiss(**AT, at=[0.2, 0.35, 0.5], r=(found - [0.0, 2e-4, 0.0]).tolist())


@pytest.fixture(scope="module")
def best(wanted: mk.ProfileMiss) -> mk.Design:
    return mk.design(WAISTED, ANGLES, mk.Minimise(wanted), designs=16, tolerance=1e-4)


def test_the_best_is_that_of_a_dense_grid(best: mk.Design, wanted: mk.ProfileMiss) -> None:
    first, second = np.meshgrid(np.radians(np.linspace(47.0, 51.0, 5)), np.radians(np.linspace(43.0, 47.0, 5)))
    (missed,) = worth([wanted], WAISTED, 1e-4, angle_0=first.ravel(), angle_1=second.ravel())
    (least,) = best.goals.values()
    assert best.feasible
    assert best.converged
    assert least <= missed.min() * (1.0 + 1e-3)
    assert least > 0.5 * missed.min()  # the grid is coarse
    assert "nothing holds the design: the goal is best within the ranges" in best.notes
    own = radii(best.muscle, tuple(wanted.places), True, force=0.0)
    assert least == pytest.approx(np.sqrt(np.mean((own - wanted.r) ** 2)), abs=5e-7)


def test_a_profile_as_a_limit() -> None:
    """The most force that misses the profile of 46 deg by 0.03 mm: a steeper braid, until that is reached."""
    own = radii(STEEP, (0.3, 0.5), True, contraction="2 %")
    near = mk.ProfileMiss(**AT, contraction="2 %", at=[0.3, 0.5], r=own.tolist())
    pull = mk.ForceAt(**AT, contraction="2 %")
    found = mk.design(STEEP, {"braid.angle": "42 deg to 50 deg"}, mk.Maximise(pull), [near <= "0.03 mm"], designs=16)
    assert found.feasible
    assert found.limits["reached"].tolist() == [True]
    assert found.limits["value"].tolist() == ["0.03 mm"]
    assert found.muscle.braid.angle > STEEP.braid.angle
    off = radii(found.muscle, (0.3, 0.5), True, contraction="2 %") - own
    assert np.sqrt(np.mean(off**2)) == pytest.approx(3e-5, abs=2e-7)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"at": [0.2, 0.1], "r": ["1 mm"] * 2}, r"profile-miss.at\[1\] = 0.1: must be above the one before it, 0.2"),
        ({"z": ["9 mm", "9 mm"], "r": ["1 mm"] * 2}, r"profile-miss.z\[1\].*sort the places"),
        ({"at": [0.2], "r": ["1 mm"] * 2}, "profile-miss.r = 2 of them: must be 1, as many as at"),
        ({"at": [0.2, 1.1], "r": ["1 mm"] * 2}, r"profile-miss.at\[1\] = 1.1: must be at least 0 and at most 1"),
        ({"z": ["-1 mm"], "r": ["1 mm"]}, r"profile-miss.z\[0\] = -1 mm: must be at least 0"),
        ({"z": ["81 mm"], "r": ["1 mm"], "length": "80 mm"}, r"z\[0\] = 81 mm: lies outside the muscle.*80 mm"),
        ({"at": [0.2], "z": ["9 mm"], "r": ["1 mm"]}, "profile-miss.at: is given beside z"),
        ({"r": ["1 mm"]}, "profile-miss.at: says no places"),
        ({"at": [0.2], "r": [16.4]}, r'profile-miss.r\[0\] = 16.4.*write "16.4 mm"'),
        ({"at": [0.2], "r": ["0 mm"]}, r"profile-miss.r\[0\] = 0 mm: must be above 0"),
        ({"at": [0.2], "r": ["1 mm"], "force": "1 N", "length": "9 mm"}, "profile-miss.force = 1 N: is given beside"),
        ({"at": [0.2], "r": ["1 mm"], "contraction": "1 %", "length": "9 mm"}, "profile-miss.length"),
    ],
)
def test_wrong_profiles_are_named(given: dict[str, Any], said: str) -> None:
    with pytest.raises(mk.SpecError, match=said):
        mk.ProfileMiss(**AT, **given)


def test_places_beyond_every_muscle() -> None:
    far = mk.ProfileMiss(**AT, contraction="2 %", z=["90 mm"], r=["13 mm"])
    with pytest.raises(mk.SpecError, match="a wanted profile must end within the muscle"):
        mk.design(STEEP, {"braid.angle": "42 deg to 50 deg"}, mk.Minimise(far), designs=16)


def test_one_range_for_all_angles() -> None:
    space = space_of(WAISTED, {BOTH: "46 deg to 54 deg", "braid.angle": "40 deg to 44 deg"})
    assert [axis.name for axis in space.axes] == [*ANGLES, "braid.angle"]
    np.testing.assert_allclose(space.muscle_at(np.full(3, 0.5)).braid.angles, np.radians([42.0, 50.0, 50.0]))
    other = programmed(46.0, 50.0)
    one_of = space_of(WAISTED, {"braid.angle_profile": [WAISTED.braid.angle_profile, other.braid.angle_profile]})
    assert one_of.muscle_at(np.ones(1)).braid == other.braid
    with pytest.raises(mk.SpecError, match=r"free.braid.angle_profile.angle\[1\].*is given twice"):
        space_of(WAISTED, {BOTH: "46 deg to 54 deg", f"{BOTH}[1]": "40 deg to 44 deg"})
    with pytest.raises(mk.SpecError, match=r"free.braid.angle_profile.angle"):
        space_of(STRETCHING, {BOTH: "46 deg to 54 deg"})


FILE = """\
[muscle]
preset = "paper"
[muscle.braid]
angle = "42 deg"
angle_profile = { angle = ["50 deg", "44 deg"], mirrored = true }
[muscle.braid.fibre]
stretch = true
[free]
"braid.angle_profile.angle" = "40 deg to 54 deg"
[objective]
minimise = "profile-miss"
pressure = "1 bar"
at = ["20 %", "50 %"]
r = ["14 mm", "13.5 mm"]
[[subject_to]]
measure = "profile-miss"
pressure = "1 bar"
length = "80 mm"
z = ["10 mm", "40 mm"]
r = ["14 mm", "13.5 mm"]
at_most = "1 mm"
"""


def test_a_file(tmp_path: Path) -> None:
    path = tmp_path / "design.toml"
    path.write_text(FILE, encoding="utf-8")
    asked = read_design(path)
    assert asked.muscle.braid == WAISTED.braid
    assert asked.objective == (mk.Minimise(mk.ProfileMiss(**AT, at=[0.2, 0.5], r=[0.014, 0.0135])),)
    within = mk.ProfileMiss(**AT, z=[0.01, 0.04], r=[0.014, 0.0135], length=0.08)
    assert asked.subject_to == (within <= 1e-3,)
    path.write_text(FILE.replace('at = ["20 %", "50 %"]', 'at = ["50 %", "20 %"]'), encoding="utf-8")
    with pytest.raises(mk.SpecError, match=r"objective.at\[1\]"):
        read_design(path)


def test_it_is_loaded_as_it_was_saved(best: mk.Design, tmp_path: Path) -> None:
    found = mk.load(mk.save(best, tmp_path / "design.nc"))
    assert isinstance(found, mk.Design)
    assert found == best
    assert found.muscle == best.muscle

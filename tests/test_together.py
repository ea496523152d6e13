"""Everything that can be switched on, together: derivatives, sweeps and files of a muscle with all effects."""

from typing import Any

import attrs
import jax
import numpy as np
import pytest
from numpy.testing import assert_allclose

import mckibben as mk

# such soft rubber at 1 bar would bulge through the sleeve: a caution, and no matter here
pytestmark = [
    pytest.mark.effects,
    pytest.mark.filterwarnings("ignore:.*bulges by half a circle:mckibben.MuscleWarning"),
]

FIBRE = attrs.evolve(mk.presets.paper().braid.fibre, stretch=True, axial_stiffness="150 N")
TUBE = mk.Chamber(outer_diameter="24 mm", inner_diameter="22 mm", wall="thick", law=mk.Rubber(E="0.1 MPa"))
MUSCLE = (
    mk.presets.paper()
    .replace("braid.fibre", FIBRE)
    .replace("braid.joint", "pin")
    .replace("fittings", mk.Fittings(compliance="0.01 mm/N"))
    .replace("chamber", TUBE)
)
NUMBERS = (
    "braid.angle", "braid.fibre.diameter", "braid.fibre.axial_stiffness", "chamber.outer_diameter", "chamber.law.E",
    "fittings.compliance",
)  # fmt: skip
TEST = mk.Isobaric(length="112 mm to 124 mm", pressure="1 bar", points=3)


@pytest.fixture(scope="module")
def curve() -> mk.Result:
    return mk.run(MUSCLE, TEST)


def test_states(curve: mk.Result) -> None:
    data = curve.data
    assert curve.verdict == ("stable",) * 3
    assert data["error_estimate"].max() < 1e-6
    assert_allclose(curve.length, data["z"].values[:, -1] + 1e-5 * curve.force, rtol=1e-9)
    assert_allclose(data["fibre_tension"], 150.0 * (data["fibre_stretch"] - 1.0), rtol=1e-12)
    assert np.abs(data["roll"]).max() > 0.1
    assert (data["air_volume"] < data["volume"]).all()


@pytest.fixture(scope="module")
def slopes() -> mk.Muscle:
    held = mk.Isometric(length="115 mm", pressure="1 bar")
    return jax.grad(lambda muscle: mk.response(muscle, held, tolerance=1e-9)["force"][0])(MUSCLE)


@pytest.mark.parametrize("name", NUMBERS)
def test_derivatives(name: str, slopes: mk.Muscle) -> None:
    """Of the force at 115 mm and 1 bar, by numbers of every effect, against central differences."""

    def value(muscle: Any) -> Any:
        for part in name.split("."):
            muscle = getattr(muscle, part)
        return muscle

    size, step = value(MUSCLE), 3e-5
    up, down = (
        mk.solve(MUSCLE.replace(name, size * (1.0 + sign * step)), length=0.115, pressure=1e5, tolerance=1e-9).force
        for sign in (1.0, -1.0)
    )
    assert float(value(slopes)) == pytest.approx((up - down) / (2.0 * step * size), rel=2e-6, abs=0.0)


def test_a_sweep_is_its_single_runs(curve: mk.Result) -> None:
    swept = mk.sweep(MUSCLE, TEST, {"fittings.compliance": ["0.01 mm/N", "0.02 mm/N"]}, workers=1)
    assert (swept["method"] == 0).all()
    assert_allclose(swept["force"].values[0], curve.force, rtol=1e-9)
    assert_allclose(swept["peak_fibre_tension"].values[0], curve.data["fibre_tension"].max("v"), rtol=1e-8)


def test_files(curve: mk.Result, tmp_path: Any) -> None:
    mk.save(curve, tmp_path / "curve.nc")
    assert mk.load(tmp_path / "curve.nc") == curve
    mk.save(curve, tmp_path / "curve.csv")
    head = (tmp_path / "curve.csv").read_text().splitlines()[0].split(",")
    assert {"energy_stretch [J]", "energy_fittings [J]", "air_volume [m^3]"} <= set(head)


def test_a_muscle_without_effects_says_nothing_of_them() -> None:
    plain = mk.run(mk.presets.paper(), mk.Isometric(length="115 mm", pressure="1 bar"))
    assert not {"fibre_stretch", "energy_stretch", "energy_fittings", "roll"} & set(plain.data)
    assert not any(word in plain.attributes["muscle"] for word in ("stretch", "joint", "fittings", "wall"))

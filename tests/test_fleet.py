"""Batches of muscles against one muscle at a time."""

import warnings

import numpy as np
import pytest

import mckibben as mk
from mckibben import fleet
from mckibben.experiment import MuscleWarning

PAPER = mk.presets.paper()
SAME = ("force", "length", "volume", "contraction", "energy", "energy_twist", "energy_chamber", "pressure")


def muscles(ends: str) -> list[mk.Muscle]:
    """Angles and walls about the paper's, seeded."""
    rng = np.random.default_rng(7)
    found = []
    for _ in range(5):
        muscle = PAPER.replace("braid.angle", float(np.radians(rng.uniform(33.0, 41.0)))).replace("ends", ends)
        found.append(muscle.replace("chamber.thickness", float(rng.uniform(0.6e-3, 1.8e-3))))
    return found


def singly(muscle: mk.Muscle, test: mk.Isometric | mk.Isobaric | mk.Isotonic, tolerance: float) -> mk.Result:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MuscleWarning)
        return mk.run(muscle, test, tolerance=tolerance)


@pytest.mark.parametrize("ends", ["clamped", "pinned", "free"])
@pytest.mark.parametrize(
    "test",
    [
        mk.Isometric(length="105 mm", pressure="0 to 1 bar", points=6),
        mk.Isobaric(pressure="0.8 bar", length="100 mm to 80 mm", points=5),
        mk.Isotonic(force="20 N", pressure="0.5 to 1 bar", points=4),
    ],
    ids=lambda test: test.kind,
)
def test_a_batch_gives_the_numbers_of_single_runs(ends: str, test: mk.Isometric | mk.Isobaric | mk.Isotonic) -> None:
    some = muscles(ends)
    curves = fleet.solve_together([fleet.ask(muscle, test) for muscle in some], 1e-6)
    if ends == "free" and test.kind == "isotonic":
        assert curves == [None] * len(some)
        return
    for muscle, curve in zip(some[:3], curves, strict=False):
        assert curve is not None
        one = singly(muscle, test, 1e-6)
        for name in SAME:
            size = np.abs(one.data[name].values).max()
            np.testing.assert_allclose(curve.numbers[name], one.data[name].values, rtol=1e-9, atol=1e-9 * size)
        for name, field in {"peak_fibre_tension": "fibre_tension", "largest_radius": "r"}.items():
            np.testing.assert_allclose(curve.numbers[name], one.data[field].values.max(axis=1), rtol=1e-8)
        np.testing.assert_allclose(curve.numbers["error_estimate"], one.data["error_estimate"].values, rtol=1e-2)
        assert curve.numbers["residual"].max() < 1e-11
        plain = one.data["modes_antisymmetric"].values == 0
        np.testing.assert_array_equal(curve.plain, plain)
        np.testing.assert_array_equal(curve.stable_loads, one.data["modes_force_control"].values == 0)


def test_what_a_batch_cannot_follow_is_left_to_the_single_solver() -> None:
    test = mk.Isometric(length="55 mm", pressure="0 to 1 bar", points=5)  # pinned, the unpressurised braid folds
    some = [mk.presets.reference(), mk.presets.reference().replace("ends", "pinned")]
    curves = fleet.solve_together([fleet.ask(muscle, test) for muscle in some], 1e-6)
    assert curves[0] is not None
    assert curves[1] is None


def test_neighbours_in_a_batch_do_not_matter() -> None:
    test = mk.Isometric(length="105 mm", pressure="0 to 1 bar", points=5)
    some = muscles("clamped")
    together = fleet.solve_together([fleet.ask(muscle, test) for muscle in some], 1e-4)
    bad = [fleet.ask(some[0].replace("braid.fibre", mk.Fibre(B1=0.0, B2=0.0, B3=0.0)), test)]  # no state
    mixed = fleet.solve_together([*bad, *(fleet.ask(muscle, test) for muscle in some)], 1e-4)
    for before, after in zip(together, mixed[1:], strict=True):
        assert before is not None
        assert after is not None
        np.testing.assert_allclose(before.numbers["force"], after.numbers["force"], rtol=1e-12, atol=0.0)


@pytest.mark.parametrize(
    "test",
    [
        mk.Protocol(steps=[mk.Step(length="90 mm", pressure="0 to 1 bar"), mk.Step(force="to 0 N", pressure="hold")]),
        mk.Step(volume="40 ml", pressure="1 bar"),
        mk.Isometric(length="10 m", pressure="1 bar"),
    ],
    ids=["several steps", "volume held", "beyond full extension"],
)
def test_tests_that_only_a_single_run_can_do(test: mk.Protocol | mk.Step | mk.Isometric) -> None:
    assert fleet.ask(PAPER, test) is None

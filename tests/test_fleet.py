"""Batches of muscles against one muscle at a time."""

import warnings

import jax
import numpy as np
import pytest

import mckibben as mk
from mckibben.experiments.run import MuscleWarning
from mckibben.sweeps.batches import Solved, solve_together
from mckibben.sweeps.groups import Group, group_of, groups
from mckibben.sweeps.plan import Piece

pytestmark = pytest.mark.sweeps

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
    asked = [group_of(muscle, test) for muscle in some]
    if ends == "free" and test.kind == "isotonic":
        assert asked == [None] * len(some)
        return
    (solved,) = solve_together(joined(asked), 1e-6)
    assert solved.group.index.tolist() == list(range(len(some)))
    for d, muscle in enumerate(some[:3]):
        one = singly(muscle, test, 1e-6)
        for name in SAME:
            size = np.abs(one.data[name].values).max()
            np.testing.assert_allclose(solved.numbers[name][d], one.data[name].values, rtol=1e-9, atol=1e-9 * size)
        for name, field in {"peak_fibre_tension": "fibre_tension", "largest_radius": "r"}.items():
            np.testing.assert_allclose(solved.numbers[name][d], one.data[field].values.max(axis=1), rtol=1e-8)
        np.testing.assert_allclose(solved.numbers["error_estimate"][d], one.data["error_estimate"].values, rtol=1e-2)
        plain = one.data["modes_antisymmetric"].values == 0
        np.testing.assert_array_equal(solved.plain[d], plain)
        np.testing.assert_array_equal(solved.stable_loads[d], one.data["modes_force_control"].values == 0)
    assert solved.numbers["residual"].max() < 1e-11


def joined(asked: list[Group | None]) -> Group:
    """Designs of one kind together, each numbered by its place."""
    assert all(one is not None for one in asked)
    p = jax.tree.map(lambda *each: np.concatenate(each), *(one.p for one in asked))
    rows = (np.concatenate([getattr(one, name) for one in asked]) for name in ("wanted", "corners"))
    return Group(np.arange(len(asked)), p, asked[0].ends, asked[0].held, *rows)


def by_design(found: list[Solved]) -> dict[int, np.ndarray]:
    """Forces of each design that was followed cleanly."""
    return {int(k): one.numbers["force"][d] for one in found for d, k in enumerate(one.group.index)}


def test_what_a_batch_cannot_follow_is_left_to_the_single_solver() -> None:
    test = mk.Isometric(length="55 mm", pressure="0 to 1 bar", points=5)  # pinned, the unpressurised braid folds
    some = [mk.presets.reference(), mk.presets.reference().replace("ends", "pinned")]
    found = [by_design(solve_together(group_of(muscle, test), 1e-6)) for muscle in some]
    assert list(found[0]) == [0]
    assert not found[1]


def test_neighbours_in_a_batch_do_not_matter() -> None:
    test = mk.Isometric(length="105 mm", pressure="0 to 1 bar", points=5)
    some = muscles("clamped")
    asked = [group_of(muscle, test) for muscle in some]
    together = by_design(solve_together(joined(asked), 1e-4))
    bad = group_of(some[0].replace("braid.fibre", mk.Fibre(B1=0.0, B2=0.0, B3=0.0)), test)  # no state
    mixed = by_design(solve_together(joined([bad, *asked]), 1e-4))
    assert sorted(together) == list(range(len(some)))
    assert sorted(mixed) == list(range(1, len(some) + 1))
    for k, force in together.items():
        np.testing.assert_allclose(force, mixed[k + 1], rtol=1e-12, atol=0.0)


def test_groups_have_the_numbers_of_the_designs_one_by_one() -> None:
    """Numbers put in for all at once, and what only the specification can say left to it."""
    fields = ("braid.angle", "braid.fibres", "braid.fibre.diameter", "chamber.law.c2", "ends", "test.pressure")
    paths = [mk.Isometric(length=0.1, pressure=path, points=3).pressure for path in ("0 to 1 bar", "0.2 to 2 bar")]
    rows = tuple(
        (angle, fibres, diameter, c2, ends, path)
        for angle in (0.6, 0.7) for fibres in (56, 57, 200) for diameter in (2e-4, 5e-4) for c2 in (0.0, -2e4, 3e3)
        for ends in ("clamped", "pinned") for path in paths
    )  # fmt: skip
    piece = Piece(PAPER, mk.Isometric(length="100 mm", pressure="0 to 1 bar", points=3), fields, rows, 3, 1e-4)
    found = {int(k): (group, d) for group in groups(piece) for d, k in enumerate(group.index)}
    for k in range(len(rows)):
        design = piece.design(k)
        if isinstance(design, mk.SpecError):
            assert k not in found
            continue
        group, d = found[k]
        alone = group_of(*design)
        assert (alone.ends, alone.held) == (group.ends, group.held)
        for one, many in zip(jax.tree.leaves(alone.p), jax.tree.leaves(group.p), strict=True):
            assert float(one[0]) == float(many[d])
        np.testing.assert_array_equal(alone.wanted[0], group.wanted[d])
        np.testing.assert_array_equal(alone.corners[0], group.corners[d])
    assert len({id(group) for group, _ in found.values()}) == 2  # one for each kind of ends
    assert 0 < len(found) < len(rows)


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
    assert group_of(PAPER, test) is None

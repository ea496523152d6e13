"""Batches of muscles against one muscle at a time."""

import warnings
from typing import Any

import jax
import numpy as np
import pytest

import mckibben as mk
from mckibben.experiments.run import MuscleWarning
from mckibben.spec import Test
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


def singly(muscle: mk.Muscle, test: Test, tolerance: float) -> mk.Result:
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
        mk.Protocol(
            [
                mk.Step(length="to 105 mm", pressure="0.2 bar", points=3),
                mk.Step(length="hold", pressure="to 1 bar", points=3),
            ]
        ),
    ],
    ids=lambda test: test.kind,
)
def test_a_batch_gives_the_numbers_of_single_runs(ends: str, test: Test) -> None:
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
    return Group(np.arange(len(asked)), p, asked[0].line, asked[0].held, *rows)


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
        assert (alone.line, alone.held) == (group.line, group.held)
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


def ramps(first: str = "0.2 bar", second: str = "to 1 bar") -> mk.Protocol:
    """To a length at one pressure, then to another pressure."""
    return mk.Protocol(
        [mk.Step(length="to 110 mm", pressure=first, points=2), mk.Step(length="hold", pressure=second, points=2)]
    )


def plateau(pressure: str = "1 bar") -> mk.Protocol:
    """A protocol of one step."""
    return mk.Protocol([mk.Step(length="110 mm", pressure=pressure, points=1)])


@pytest.mark.parametrize(
    ("made", "field", "values"),
    [
        (plateau, "test.steps.0.pressure", ("0.5 bar", "0.8 bar")),
        (ramps, "test.steps.0.pressure", ("0.3 bar", "0.5 bar")),
        (lambda second: ramps(second=second), "test.steps.1.pressure", ("to 0.5 bar", "to 0.8 bar")),
    ],
)
def test_what_a_protocol_varies_is_what_its_steps_hold(made: Any, field: str, values: tuple[str, ...]) -> None:
    """Also in a protocol of one step, where every design once got the values of the first."""
    swept = mk.sweep(PAPER, made(values[0]), {field: list(values)}, workers=0)
    assert (swept["method"] == 0).all()
    for k, value in enumerate(values):
        curve = singly(PAPER, made(value), 1e-6)
        np.testing.assert_allclose(swept["pressure"][k], curve.pressure, rtol=1e-12)
        np.testing.assert_allclose(swept["force"][k], curve.force, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(
    "test",
    [
        mk.Isometric(length="100 mm", pressure="0 to 4 bar", points=5),
        mk.Isobaric(pressure="2 bar", length="80 to 110 mm", points=5),
        mk.Isotonic(force="20 N", pressure="0 to 4 bar", points=5),
        mk.FreeContraction(pressure="0 to 4 bar", points=5),
        mk.BlockedForce(pressure="0 to 4 bar", points=5),
        mk.Protocol(
            [
                mk.Step(length="to 105 mm", pressure="0.2 bar", points=5),
                mk.Step(length="hold", pressure="to 3 bar", points=5),
            ]
        ),
    ],
    ids=lambda test: test.kind,
)
def test_coarse_ramps_stay_in_the_batch(test: Test) -> None:
    """At most one design in a hundred is solved singly, though the first steps in pressure are far too long."""
    angles, walls = np.meshgrid(np.radians(np.linspace(32.0, 40.0, 10)), np.linspace(0.6e-3, 1.5e-3, 10))
    rows = tuple(zip(angles.ravel().tolist(), walls.ravel().tolist(), strict=True))
    states = sum(step.points for step in test.as_steps(PAPER))
    piece = Piece(PAPER, test, ("braid.angle", "chamber.thickness"), rows, states, 1e-6)
    done = sum(len(one.group) for group in groups(piece) for one in solve_together(group, 1e-6))
    assert done >= 99

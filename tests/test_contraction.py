"""A contraction wherever a length is given: in Python, in files, in sweeps and on the command line."""

import tomllib

import attrs
import jax
import numpy as np
import pytest

import mckibben as mk
from mckibben.experiments import limits
from mckibben.spec import numbers
from mckibben.spec.rows import test_rows as rows_of
from mckibben.spec.text import apply_overrides, from_mapping, test_from_mapping, to_mapping, to_toml
from mckibben.spec.vary import changed
from mckibben.sweeps.groups import group_of, groups
from mckibben.sweeps.plan import plan

pytestmark = pytest.mark.spec

PAPER = mk.presets.paper()
TESTS = [
    (mk.Isometric(contraction="10 %", pressure="0 to 1 bar"), [0.9]),
    (mk.Isometric(contraction=0.1, pressure="0 to 1 bar"), [0.9]),
    (mk.Isobaric(pressure="1 bar", contraction="-10 to 20 %", points=4), [1.1, 0.8]),
    (mk.Isobaric(pressure="1 bar", contraction=["0 %", "5 %", 0.1]), [1.0, 0.95, 0.9]),
    (mk.BlockedForce(pressure="1 bar", contraction="-35 %"), [1.35]),
    (mk.Step(contraction="to 10 %", pressure="hold"), [0.9]),
    (mk.Protocol([mk.Step(contraction="10 %", force="to 0 N")]), [0.9]),
]


@pytest.mark.parametrize(("test", "shares"), TESTS, ids=[str(to_mapping(test)) for test, _ in TESTS])
def test_it_is_a_length_once_the_muscle_is_known(test: mk.Step, shares: list[float]) -> None:
    for muscle in (PAPER, PAPER.replace("braid.length", "120 mm")):
        (step,) = test.as_steps(muscle)
        np.testing.assert_allclose(step.length.waypoints, np.array(shares) * muscle.braid.length, rtol=1e-14)
        assert step.length.unit == "m"
    written = tomllib.loads(to_toml(test))
    assert "length" not in written
    assert test_from_mapping(written) == test


def test_it_is_shown_as_given() -> None:
    test = mk.Isometric(contraction="10 %", pressure="0 to 1 bar")
    assert {row[0]: row[1] for row in rows_of(test)}["contraction"] == "10 %"
    assert next(name for name, _, _ in numbers(test)) == "contraction"
    assert next(declared.text(number) for _, declared, number in numbers(test)) == "0.1"


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"contraction": "100 %"}, "isometric.contraction = 100 %: must be below 1 (100 %)"),
        ({"contraction": 10}, 'isometric.contraction = 10: must be below 1 (100 %); write it like "10 %"'),
        ({"contraction": "10 mm"}, "isometric.contraction = 10 mm: must be a plain number"),
        ({"contraction": "10 %", "length": "90 mm"}, "is given beside a length"),
        ({"contraction": "0 to 10 %"}, "must be one value"),
    ],
)
def test_what_is_no_contraction(given: dict[str, object], said: str) -> None:
    with pytest.raises(mk.SpecError) as caught:
        mk.Isometric(**given, pressure="1 bar")
    assert said in str(caught.value)


def test_files_and_overrides() -> None:
    case = {"muscle": {"preset": "paper"}, "test": {"kind": "isometric", "length": "90 mm", "pressure": "1 bar"}}
    put = from_mapping(apply_overrides(case, ["test.contraction=10 %"]))
    assert put.test == mk.Isometric(contraction="10 %", pressure="1 bar")
    back = from_mapping(apply_overrides(to_mapping(put), ["test.length=90 mm"]))
    assert back.test == mk.Isometric(length="90 mm", pressure="1 bar")
    with pytest.raises(mk.SpecError, match=r"test\.contraction.*is given beside a length"):
        from_mapping(case | {"test": case["test"] | {"contraction": "10 %"}})
    with pytest.raises(mk.SpecError, match=r"test\.length: is missing"):
        test_from_mapping({"kind": "isometric", "pressure": "1 bar"})


def test_sweeps() -> None:
    base = mk.Isometric(length="90 mm", pressure="0 to 1 bar", points=3)
    wanted = plan(PAPER, base, {"test.contraction": ["0 %", "10 %"], "braid.length": ["85 mm", "100 mm"]})
    held = [
        muscle_test[1].as_steps(muscle_test[0])[0].length.waypoints[0] for muscle_test in map(wanted.design, range(4))
    ]
    np.testing.assert_allclose(held, [0.085, 0.1, 0.0765, 0.09], rtol=1e-14)
    np.testing.assert_allclose(wanted.varied[0].coordinate, [0.0, 0.1])
    assert groups(wanted.piece(0)) == []  # one by one: a batch takes lengths
    relative = mk.Isometric(contraction="10 %", pressure="0 to 1 bar", points=3)
    assert groups(plan(PAPER, relative, {"braid.length": ["85 mm", "100 mm"]}).piece(0)) == []
    assert group_of(PAPER, relative).wanted[0, :, 0] == pytest.approx(0.0765)
    assert changed(PAPER, relative, {"test.length": "90 mm"})[1] == base


def test_derivatives_go_through_it() -> None:
    def held(muscle: mk.Muscle) -> object:
        return mk.Isometric(contraction=0.1, pressure="1 bar").as_steps(muscle)[0].length.waypoints[0]

    assert jax.grad(held)(PAPER).braid.length == pytest.approx(0.9)


def test_calls_that_take_a_length(monkeypatch: pytest.MonkeyPatch) -> None:
    state = mk.solve(PAPER, contraction="-60 %", pressure="1 bar")  # beyond full extension: nothing is solved
    assert state.verdict == "no equilibrium"
    assert "length 136 mm" in repr(state)
    asked: list[float] = []
    monkeypatch.setattr(limits, "holding", lambda bench, length, *_, **__: asked.append(length) or 0.0)
    assert mk.least_pressure(PAPER, contraction="10 %") == 0.0
    assert asked == [pytest.approx(0.0765)]
    table = mk.force_map(PAPER, contraction="-60 to -55 %", pressure="1 to 2 bar", points=2)
    np.testing.assert_allclose(table.length, [0.136, 0.13175])
    with pytest.raises(mk.SpecError, match="is given beside a length"):
        mk.solve(PAPER, contraction="10 %", length="90 mm", pressure="1 bar")
    assert attrs.evolve(PAPER) == PAPER

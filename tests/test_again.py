"""States that following does not reach: a curve says of each of them what a single call says."""

import math

import pytest

import mckibben as mk

pytestmark = pytest.mark.experiments

SHORT = mk.Muscle(
    braid=mk.Braid(
        radius=21.439155749386693e-3, length=56.03700035479651e-3, angle=1.0536376658619258, fibres=18,
        fibre=mk.Fibre(B1=96.00156682009693e-6, B2=96.00156682009693e-6, B3=68.57254772864067e-6),
    ),
    chamber=mk.Chamber(
        thickness=0.8264375987584851e-3, law=mk.MooneyRivlin(c1=0.14990945757798543e6, c2=0.03930057999003511e6)
    ),
    ends="pinned",
)  # fmt: skip
FORCE, PRESSURES = -366.395, [68563.0, 205689.0, 342815.0]


@pytest.fixture(scope="module")
def alone() -> list[mk.State]:
    """What single calls say."""
    return [mk.solve(SHORT, force=FORCE, pressure=pressure) for pressure in PRESSURES]


@pytest.mark.parametrize("order", [1, -1])
def test_a_first_state_that_is_not_there_costs_no_other(order: int, alone: list[mk.State]) -> None:
    curve = mk.run(SHORT, mk.Isotonic(force=FORCE, pressure=PRESSURES[::order]))
    assert curve.status == "incomplete"
    assert curve.verdict == tuple(state.verdict for state in alone[::order])
    for k, state in enumerate(alone[::order]):
        if state.verdict != "stable":
            assert str(curve.data["reason"].values[k]) == state.reason
            assert math.isnan(curve.length[k])
            continue
        assert curve.length[k] == pytest.approx(state.length, rel=2e-6)
        assert curve.data["force"].values[k] == pytest.approx(FORCE, rel=1e-9)
        assert curve.data["z"].values[k, -1] == pytest.approx(curve.length[k], rel=1e-6)
    known = [math.isfinite(value) for value in curve.data["work"].values]
    assert known == ([False, False, False] if order == 1 else [True, True, False])  # up to the first that is lost


def test_a_sweep_agrees(alone: list[mk.State]) -> None:
    test = mk.Isotonic(force=FORCE, pressure=PRESSURES)
    table = mk.sweep(SHORT, test, {"braid.fibres": [18]}, workers=0)
    words = table["verdict"].attrs["flag_meanings"].split()
    assert [words[int(k) + 1] for k in table["verdict"].values.ravel()] == [str(state.verdict) for state in alone]


def test_an_interruption_keeps_what_was_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C while a state is sought on its own: the result says so, and the states that following reached stay."""
    from mckibben.experiments import again

    def stop(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(again, "answer", stop)
    curve = mk.run(SHORT, mk.Isotonic(force=FORCE, pressure=PRESSURES[::-1]))
    assert curve.status == "interrupted"
    assert curve.verdict[:2] == ("stable", "stable")

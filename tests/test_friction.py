"""Friction at the crossings: the cylinder in closed form, paths by an independent code, and what no path may break."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import mckibben as mk
from mckibben.experiments import going
from mckibben.experiments import rubbing as rubbing_module
from mckibben.experiments import walked as walked_module
from mckibben.model import friction
from mckibben.model.parameters import parameters
from mckibben.model.point import Point
from mckibben.spec.text import from_mapping, to_mapping

pytestmark = pytest.mark.effects

RADIUS, LENGTH, ANGLE, FIBRES = 12.5e-3, 85e-3, np.radians(37.0), 56

# Cylinder: length [mm], mu a [mm], m0 [N mm]; moment [N mm] as it lengthens and shortens and tension [N] as it
# lengthens and shortens, force [N] likewise, and that without friction. At 0.1 MPa, in closed form by another code.
CYLINDER = [
    (115.0, 0.0, 0.02, (0.02, 0.02),
     (2.2772059520887984, 2.2452608279618715),
     (79.10093820891827, 76.90383394215978), 78.00238607553902),
    (115.0, 0.02, 0.0, (0.015911099532364328, 0.015734261469052557),
     (2.2739404412642665, 2.248667566633475),
     (78.87634469232343, 77.1381407503403), 78.00238607553902),
    (115.0, 0.02, 0.01, (0.025967294754383363, 0.025678690808158863),
     (2.281971601379567, 2.240725665893245),
     (79.4287074280648, 76.59191704705458), 78.00238607553902),
    (70.0, 0.02, 0.01, (0.02047169287286283, 0.02037025742136748),
     (1.370032173424729, 1.3567611738106518),
     (-20.435955732415046, -21.9354662780819), -21.187573104488667),
]  # fmt: skip

# Clamped, 0.1 MPa, m0 = 0.02 N mm, from 85 mm through these lengths [mm]: force [N], dissipated [N mm] since it was
# made, energy of the crossings [N mm], angle [deg] and tension [N] at mid-length, by a code of its own (24 unknowns).
PATH = [
    (115.0, 102.52823807896088, 29.249251035681244, 0.04494495527924919, 60.04427998063674, 2.484908000812606),
    (112.0, 86.72190112279961, 32.81291143041259, 0.04456911677825184, 56.80875891380701, 2.3318958718834395),
    (107.0, 67.64519828653685, 38.43680894801858, 0.044761573191562556, 52.12887972298805, 2.1771068180950333),
    (100.0, 44.86309429911333, 45.44281395267844, 0.04483033488844022, 46.585707691443034, 1.9919685983853495),
    (103.0, 56.15325017883358, 48.16651150108183, 0.044476565436475796, 48.85511171289165, 2.094883924240185),
    (115.0, 102.52823807896094, 61.636376869675644, 0.04494495527924919, 60.04427998063678, 2.4849080008126068),
]


def rubbing(friction: mk.Friction | None = None, **changes: Any) -> mk.Muscle:
    """The paper's muscle with friction, that of the stored path unless said."""
    muscle = mk.presets.paper().replace("friction", friction or mk.Friction(constant="0.02 N mm"))
    for name, value in changes.items():
        muscle = muscle.replace(name.replace("__", "."), value)
    return muscle


BOTH = mk.Friction(coefficient=0.3, arm="0.1 mm", constant="0.01 N mm")


def isobaric(*lengths: float) -> mk.Isobaric:
    """At 1 bar through lengths in mm."""
    return mk.Isobaric(pressure="1 bar", length=[1e-3 * length for length in lengths])


@pytest.mark.parametrize(("length", "arm", "constant", "moment", "tension", "force", "free"), CYLINDER)
def test_cylinder(
    length: float,
    arm: float,
    constant: float,
    moment: tuple[float, float],
    tension: tuple[float, float],
    force: tuple[float, float],
    free: float,
) -> None:
    """M by the tension, and F = F_c + sigma N M/(l cos(theta)), pointwise."""
    p = parameters(rubbing(mk.Friction(coefficient=1.0, arm=1e-3 * arm, constant=1e-3 * constant)))
    theta = float(np.arcsin(length / 85.0 * np.sin(ANGLE)))
    at = Point.cylinder(jnp.asarray(theta))
    for M, T, F, way in zip(moment, tension, force, (1.0, -1.0), strict=True):
        found = friction.slip_moment(at, T, p)
        assert_allclose(1e3 * found, M, rtol=1e-12)
        memory = friction.Remembered(jnp.asarray(-10.0 * way), found)  # long since slipping
        by_length = float(friction.pull(at, p, memory)) * np.sin(ANGLE) / np.cos(theta)
        spacing = 2.0 * np.pi * RADIUS / (FIBRES * np.cos(ANGLE))
        assert_allclose(by_length, way * FIBRES * found / (spacing * np.cos(theta)), rtol=1e-13)
        assert_allclose(free + by_length, F, rtol=1e-12)


def test_energy_of_a_step() -> None:
    """Its derivative is the moment, on both sides of slipping and through it; what slips is remembered."""
    p = parameters(rubbing())
    memory = friction.Remembered(jnp.asarray(0.01), jnp.asarray(2e-5))
    for beta in (-0.3, 0.0079, 0.008, 0.0081, 0.0105, 0.0119, 0.0121, 0.4):
        theta = float(ANGLE + 0.5 * beta)

        def energy(theta: Any) -> Any:
            return friction.incremental_density(Point.cylinder(theta), p, memory)

        at = Point.cylinder(jnp.asarray(theta))
        tau = float(friction.crossing_moment(at, p, memory))
        assert_allclose(tau, np.clip(0.01 * (beta - 0.01), -2e-5, 2e-5), rtol=1e-10)
        assert_allclose(jax.grad(energy)(theta), friction.pull(at, p, memory), rtol=1e-10)
        after = friction.after_step(at, p, memory)
        assert_allclose(0.01 * (beta - float(after.alpha)), tau, rtol=1e-10)
    assert_allclose(friction.crossings(Point.cylinder(0.6), p), 26493.648410122617, rtol=1e-13)


def test_isobaric_path_by_another_code() -> None:
    found = mk.run(rubbing(), isobaric(*(row[0] for row in PATH)))
    assert found.verdict == ("stable",) * len(PATH)
    _, force, dissipated, stored, angle, tension = np.array(PATH).T
    middle = found.data.isel(v=64)
    assert_allclose(found.force, force, atol=7e-6)
    assert_allclose(1e3 * found.data["dissipated"], dissipated, atol=2e-5)
    assert_allclose(1e3 * found.data["energy_crossings"], stored, rtol=1e-3)
    assert_allclose(np.degrees(middle["theta"]), angle, atol=1e-6)
    assert_allclose(middle["fibre_tension"], tension, rtol=1e-6)
    assert_allclose(1e3 * middle["crossing_moment"], 0.02 * np.array([1, -1, -1, -1, 1, 1]), rtol=1e-12)
    assert found.data["error_estimate"].max() < 1e-6
    assert (np.abs(found.force - force) < found.data["error_estimate"].values * force).all()


def test_a_state_depends_on_its_path_not_on_the_steps() -> None:
    """A constant moment: one step of the path or many, the same; and back to the point of reversal, the same."""
    few = mk.run(rubbing(), isobaric(110, 100, 105), tolerance=1e-5)
    many = mk.run(rubbing(), isobaric(*np.linspace(90, 110, 6), *np.linspace(109, 100, 10), 101.5, 103, 105))
    assert_allclose(few.force[-1], many.force[-1], rtol=1e-11)
    assert_allclose(few.data["dissipated"][-1], many.data["dissipated"][-1], rtol=1e-11)
    loop = mk.run(rubbing(BOTH), isobaric(110, 105, 108, 105, 100), tolerance=1e-5)
    without = mk.run(rubbing(BOTH), isobaric(110, 105, 100), tolerance=1e-5)
    assert_allclose(loop.force[3], loop.force[1], rtol=2e-10)  # the minor loop closes
    assert_allclose(loop.force[4], without.force[2], rtol=1e-11)  # and is forgotten
    assert loop.force[2] - loop.force[1] > 10.0
    assert loop.data["dissipated"][4] > without.data["dissipated"][2]


def test_steps_of_a_moment_by_tension() -> None:
    """Where all crossings slip at last, the steps do not matter; where only some do, forces are good to some mN."""
    slipping = [mk.run(rubbing(BOTH), isobaric(*np.linspace(100, 110, n + 1)), tolerance=1e-5) for n in (1, 16)]
    assert_allclose(slipping[0].force[-1], slipping[1].force[-1], rtol=1e-11)
    assert_allclose(slipping[0].data["dissipated"][-1], slipping[1].data["dissipated"][-1], rtol=1e-4)
    law, some = mk.Friction(coefficient=0.2, arm="0.1 mm"), []
    for n in (5, 20):
        pressures = 1e5 * np.concatenate([np.linspace(0.0, 1.0, 2 * n + 1), np.linspace(1.0, 0.5, n + 1)[1:]])
        found = mk.run(rubbing(law), mk.Isometric(length="115 mm", pressure=pressures.tolist()), tolerance=1e-2)
        some.append(found.force[[0, n, 2 * n, 3 * n]])
    assert_allclose(some[0], some[1], atol=3e-3)
    # By another code with steps of its own, which with 24 and 32 unknowns differs from itself by up to 1e-3 N.
    assert_allclose(some[1], [3.314401953472822, 52.098898291515454, 100.59757549193819, 52.36566828225918], atol=6e-3)


def test_loop() -> None:
    """Work of a closed loop = dissipated; nothing is ever won back; work = stored + dissipated on the way."""
    leg = np.concatenate([np.geomspace(0.005, 1.0, 30), np.linspace(1.5, 10.0, 18)])  # close after a corner
    down, up, n = 110.0 - leg, 100.0 + leg, len(leg)
    found = mk.run(rubbing(BOTH), isobaric(110, *down, *up, *down), tolerance=1e-5)
    lost = found.data["dissipated"].values
    assert (np.diff(lost) >= 0.0).all()
    area = np.trapezoid(found.force[n:], found.length[n:])
    assert_allclose(area, lost[-1] - lost[n], rtol=1.5e-4)  # by trapezia
    assert_allclose(found.force[n], found.force[-1], rtol=1e-10)
    work, stored = (found.data[name].values[n + 30 : 2 * n + 1] for name in ("work", "energy"))
    on_the_way = lost[n + 30 : 2 * n + 1]
    assert_allclose(work[-1] - work[0], stored[-1] - stored[0] + on_the_way[-1] - on_the_way[0], rtol=1e-4)


def test_crossings_stick_where_a_path_turns() -> None:
    """Slope of a long cylinder: beyond that without friction, H0 n_c 4 k (dtheta/dh)^2."""
    muscle = rubbing(ends="free")
    turned = mk.run(muscle, isobaric(99, 100, 99.999), tolerance=1e-5)
    free = mk.run(muscle.replace("friction", None), isobaric(99.999, 100), tolerance=1e-8)
    theta = np.arcsin(0.1 / LENGTH * np.sin(ANGLE))
    spring = LENGTH * 26493.648410122617 * 4.0 * 0.01 * (np.sin(ANGLE) / (LENGTH * np.cos(theta))) ** 2
    found = (turned.force[1] - turned.force[2]) / 1e-6 - (free.force[1] - free.force[0]) / 1e-6
    assert_allclose(found, spring, rtol=1.5e-3)  # at the free ends the angle differs
    lost = turned.data["dissipated"].values
    assert lost[2] == lost[1]


def test_little_friction() -> None:
    """None at all gives the conservative numbers; a little gives a little."""
    plain = mk.run(mk.presets.paper(), isobaric(110, 100), tolerance=1e-8).force
    nothing = mk.run(rubbing(mk.Friction()), isobaric(110, 100))
    assert_allclose(nothing.force, plain, rtol=1e-11)
    assert_array_equal(nothing.data["dissipated"], 0.0)
    beyond = [
        mk.run(rubbing(mk.Friction(constant=moment)), isobaric(110, 100)).force - plain for moment in (1e-6, 1e-7)
    ]
    assert_allclose(beyond[1] / beyond[0], 0.1, rtol=1e-6)
    assert beyond[0][0] > 0.0 > beyond[0][1]


@pytest.mark.parametrize(("length", "arm", "constant", "moment", "tension", "force", "free"), CYLINDER[1:])
def test_without_a_path(
    length: float, arm: float, constant: float, moment: Any, tension: Any, force: Any, free: float
) -> None:
    """The forces between the two sliding branches, on a muscle so long that its ends matter little."""
    law = mk.Friction(coefficient=0.5, arm=2e-3 * arm, constant=1e-3 * constant)
    muscle = rubbing(law, ends="free", braid__length="850 mm")
    state = mk.solve(muscle, length=1e-2 * length, pressure="1 bar")
    assert state.force_interval is not None
    low, high = state.force_interval
    assert_allclose([high - state.force, low - state.force], np.array(force) - free, rtol=1e-4)
    assert "depends on the path" in state.reason
    assert mk.solve(mk.presets.paper(), length="115 mm", pressure="1 bar").force_interval is None


def test_runs_end_on_the_sliding_branches() -> None:
    state = mk.solve(rubbing(BOTH), length="105 mm", pressure="1 bar")
    found = mk.run(rubbing(BOTH), isobaric(100, 105, 110, 105), tolerance=1e-5)
    assert state.force_interval is not None
    assert_allclose(found.force[[3, 1]], state.force_interval, atol=3e-3)  # crossings at the fittings hardly turn
    assert state.force == pytest.approx(mk.solve(mk.presets.paper(), length="105 mm", pressure="1 bar").force, rel=0.0)


def test_lengths_under_a_weight() -> None:
    """Hysteresis of length over pressure; the first state comes from the muscle as made, pressurised, then let go."""
    test = mk.Isotonic(force="20 N", pressure="0.5 to 1 to 0.5 bar", points=11)
    found = mk.run(rubbing(BOTH), test, tolerance=1e-5)
    free = mk.run(mk.presets.paper(), test, tolerance=1e-5)
    up, down = found.length[1:5], found.length[9:5:-1]
    assert found.verdict == ("stable",) * 11
    assert (up - free.length[1:5] > 1e-4).all()
    assert (free.length[1:5] - down > 1e-4).any()
    assert (np.diff(found.data["dissipated"]) >= 0.0).all()


def test_a_protocol_goes_on_from_where_it_is() -> None:
    steps = [mk.Step(length="100 to 110 mm", pressure="1 bar", points=2)]
    steps.append(mk.Step(length="to 105 mm", pressure="hold", points=2))
    found = mk.run(rubbing(), mk.Protocol(steps), tolerance=1e-5)
    assert_allclose(found.force[3], mk.run(rubbing(), isobaric(100, 110, 105), tolerance=1e-5).force[2], rtol=1e-9)
    assert_allclose(found.force[2], found.force[1], rtol=1e-9)
    assert_allclose(found.data["dissipated"][2], found.data["dissipated"][1], rtol=1e-9)


def test_part_reached() -> None:
    found = mk.run(rubbing(), isobaric(110, 130), tolerance=1e-5)
    assert found.reached == 1
    assert found.verdict[1] == "no equilibrium"
    assert np.isnan(found.force[1])
    assert np.isnan(found.data["dissipated"][1])


def test_an_interrupted_path_is_walked_no_further() -> None:
    """The walk that is interrupted goes over every second state: those are put in, and none beyond."""
    asked: list[int] = []

    def stop(done: int, total: int) -> None:
        asked.append(done)
        if len(asked) == 2:
            raise KeyboardInterrupt

    lengths = np.linspace(110, 102, 9)
    found = mk.run(rubbing(), isobaric(*lengths), watch=stop)
    assert found.status == "interrupted"
    assert found.reached == max(asked) == asked[1] < 6
    assert found.verdict[: found.reached] == ("stable",) * found.reached
    assert str(found.data["reason"].values[-1]) == "interrupted"
    whole = mk.run(rubbing(), isobaric(*lengths))
    assert_allclose(found.force[: found.reached], whole.force[: found.reached], rtol=1e-4)


def test_what_was_reached_on_few_unknowns_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """More of them may lose the way: then the coarser states count, with their error."""
    fine = mk.run(rubbing(), isobaric(110, 112), tolerance=1e-5)
    step = walked_module.step_to
    monkeypatch.setattr(
        walked_module,
        "step_to",
        lambda problem, *rest, **named: None if problem.basis.dense else step(problem, *rest, **named),
    )
    found = mk.run(rubbing(), isobaric(110, 112), tolerance=1e-9)
    assert found.verdict == ("stable", "stable")
    assert 1e-9 < float(found.data["error_estimate"].max()) < 1e-2
    assert_allclose(found.force, fine.force, rtol=1e-3)


def test_many_states_at_once_or_one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """A path walked in compiled code, its states foretold, is that walked state by state from sticking crossings."""
    test = isobaric(*np.linspace(104, 110, 7), 109.5, 108.5, 107.5)
    at_once = mk.run(rubbing(BOTH), test, tolerance=1e-2)
    along = walked_module.steps_along
    monkeypatch.setattr(
        walked_module, "steps_along", lambda one, here, begin, path, *rest: along(one, here, begin, path[:1], *rest)
    )
    one_by_one = mk.run(rubbing(BOTH), test, tolerance=1e-2)
    assert_allclose(at_once.force, one_by_one.force, rtol=1e-9)
    assert_allclose(at_once.data["dissipated"], one_by_one.data["dissipated"], rtol=1e-8)
    assert at_once.data["iterations"].sum() < one_by_one.data["iterations"].sum()


def test_newton_does_not_go_round_in_circles(monkeypatch: pytest.MonkeyPatch) -> None:
    """Filled from rest at a fixed length, crossings begin to slip from the fittings on: every walk gets on."""
    walk, reached = going.rub_along, []

    def counted(*given: Any) -> Any:
        found = walk(*given)
        reached.append(int(np.sum(found.good)))
        return found

    monkeypatch.setattr(going, "rub_along", counted)
    assert mk.run(rubbing(BOTH), mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=21)).status == "complete"
    assert min(reached) > 0  # where every Newton step is whole, 5 of 22 walks find no state


def test_unknowns_are_not_doubled_in_vain(monkeypatch: pytest.MonkeyPatch) -> None:
    """Under a weight the series of 24 unknowns end within the tolerance: what is left of the error is the steps'."""
    walk, unknowns = rubbing_module.walked, []

    def counted(bench: Any, problem: Any, *given: Any, **named: Any) -> Any:
        unknowns.append(problem.basis.unknowns)
        return walk(bench, problem, *given, **named)

    monkeypatch.setattr(rubbing_module, "walked", counted)
    found = mk.run(rubbing(BOTH), mk.Isotonic(force="10 N", pressure="0.2 bar to 1 bar", points=21))
    assert unknowns == [24, 24]
    assert 1e-6 < float(found.data["error_estimate"].max()) < 2e-6  # with 48 unknowns too


@pytest.mark.parametrize("ends", ["clamped", "pinned"])
def test_filled_from_rest_without_a_constant_part(ends: str) -> None:
    """As made no tension presses on the crossings, and what rounding leaves of it is no moment that has to settle."""
    forces = []
    for constant in (0.0, 1e-8):
        muscle = rubbing(mk.Friction(coefficient=0.3, arm="0.1 mm", constant=f"{constant} N mm"), ends=ends)
        filled = mk.run(muscle, mk.Isometric(length="105 mm", pressure=["0 bar", "1 bar"]), tolerance=1e-3)
        assert filled.status == "complete"
        forces.append(filled.force)
    assert_allclose(forces[0], forces[1], rtol=2e-5)


def test_error_estimates_hold() -> None:
    """Those of few points against many: at a fixed length, where the border of sticking crossings wanders."""
    test = mk.Isometric(length="112 mm", pressure="0 to 1 to 0 bar", points=15)
    rough, fine = mk.run(rubbing(BOTH), test, tolerance=1e-2), mk.run(rubbing(BOTH), test, tolerance=1e-6)
    load = np.maximum(np.abs(fine.force), np.pi * RADIUS**2 * fine.pressure)
    estimate = rough.data["error_estimate"].values
    assert (np.abs(rough.force - fine.force) < (estimate + fine.data["error_estimate"].values) * load).all()
    assert fine.data["error_estimate"].max() < 0.7 * estimate.max() < 1e-2


def test_error_estimates_know_the_steps() -> None:
    """Free ends at a fixed length: soon after a turn crossings begin to slip, which few equal steps all go over."""
    pressures = np.concatenate([np.linspace(0.0, 2e5, 25), np.linspace(2e5, 0.0, 25)[1:]])
    many = mk.run(rubbing(BOTH, ends="free"), mk.Isometric(length="100 mm", pressure=pressures.tolist()))
    few = mk.run(rubbing(BOTH, ends="free"), mk.Isometric(length="100 mm", pressure=pressures[::6].tolist()))
    load = np.maximum(np.abs(many.force), np.pi * RADIUS**2 * many.pressure)[::6]
    off = np.abs(few.force - many.force[::6]) / load
    assert 1e-3 < off.max() < 2e-2
    estimate, fine = few.data["error_estimate"].values, many.data["error_estimate"].values[::6]
    assert (off < estimate + fine).all()
    assert fine.max() < 0.7 * estimate.max() < 8e-2


def test_with_fibres_that_stretch_and_roll() -> None:
    """At a fixed length crossings turn because fibres stretch: the loop is wider than that of inextensible ones."""
    test = mk.Isometric(length="105 mm", pressure=["0.3 bar", "1 bar", "0.3 bar"])
    plain = mk.run(rubbing(BOTH), test, tolerance=1e-2)
    muscle = rubbing(BOTH, braid__fibre__stretch=True, braid__joint="pin")
    soft = mk.run(muscle, test, tolerance=1e-2)
    assert soft.verdict == ("stable",) * 3
    assert_allclose(soft.data["fibre_tension"], 147.26215563702155 * (soft.data["fibre_stretch"] - 1.0), rtol=1e-10)
    lost = [float(one.data["dissipated"][2] - one.data["dissipated"][0]) for one in (plain, soft)]
    assert lost[1] > 3.0 * lost[0] > 0.0


def test_a_sweep_and_files(tmp_path: Any) -> None:
    swept = mk.sweep(rubbing(), isobaric(110, 105), {"friction.constant": ["0.01 N mm", "0.02 N mm"]}, workers=1)
    assert (swept["status"] == 0).all()
    assert (swept["method"] == 1).all()
    found = mk.run(rubbing(), isobaric(110, 105))
    assert_allclose(swept["force"].values[1], found.force, rtol=1e-12)
    mk.save(found, tmp_path / "loop.nc")
    assert mk.load(tmp_path / "loop.nc") == found
    mk.save(found, tmp_path / "loop.csv")
    assert "dissipated [J]" in (tmp_path / "loop.csv").read_text().splitlines()[0]
    muscle = rubbing(BOTH)
    assert from_mapping({"muscle": to_mapping(muscle)}, test_required=False).muscle == muscle
    assert "friction" not in repr(mk.presets.paper())
    plain = mk.run(mk.presets.paper(), isobaric(110, 105))
    assert not {"dissipated", "energy_crossings", "crossing_moment"} & set(plain.data)
    assert "friction" not in plain.attributes["muscle"]


WRONG: list[tuple[dict[str, Any], str]] = [
    ({"coefficient": -0.1, "arm": "0.1 mm"}, "at least 0"),
    ({"coefficient": 0.1}, "arm: is missing"),
    ({"constant": "-1 N mm"}, "at least 0"),
    ({"constant": "1 N"}, "wrong kind of unit"),
    ({"stiffness": 0.0}, "above 0"),
]


@pytest.mark.parametrize(("given", "said"), WRONG)
def test_wrong_input(given: dict[str, Any], said: str) -> None:
    with pytest.raises(mk.SpecError, match=said):
        mk.Friction(**given)


def test_what_needs_a_diameter() -> None:
    stiffnesses = mk.Fibre(B1="0.5 N mm^2", B2="0.5 N mm^2", B3="0.4 N mm^2")
    with pytest.raises(mk.SpecError, match="diameter"):
        rubbing(BOTH, braid__fibre=stiffnesses)
    assert rubbing(braid__fibre=stiffnesses).friction is not None  # a constant moment does not ask for it


def _loose(muscle: mk.Muscle) -> mk.Muscle:
    """The muscle with a tube that slides, whose crossings do not rub."""
    tube = mk.Chamber(outer_diameter="20 mm", inner_diameter="18 mm", law=mk.NeoHookean(c1="50 kPa"), gap=True)
    return muscle.replace("friction", None).replace("chamber", tube)


HELD = mk.Isometric(length="110 mm", pressure="1 bar")
PULL = mk.Maximise(mk.ForceAt(pressure="1 bar", contraction="5 %"))
WITHOUT_A_PATH: dict[str, Any] = {
    "limits": lambda muscle: mk.limits(muscle, pressure="1 bar"),
    "least_pressure": lambda muscle: mk.least_pressure(muscle, length="110 mm"),
    "working_range": lambda muscle: mk.working_range(muscle, pressures=["1 bar"]),
    "force_map": lambda muscle: mk.force_map(muscle, length=["110 mm"], pressure=["1 bar"]),
    "burst_pressures": lambda muscle: mk.burst_pressures(muscle, length="110 mm"),
    "response": lambda muscle: mk.response(muscle, HELD),
    "sensitivity": lambda muscle: mk.sensitivity(muscle, HELD),
    "tolerances": lambda muscle: mk.tolerances(muscle, HELD, {"braid.angle": "1 deg"}),
    "design": lambda muscle: mk.design(muscle, {"braid.angle": "36 deg to 38 deg"}, PULL),
}


@pytest.mark.parametrize("slides", [False, True])
@pytest.mark.parametrize("name", WITHOUT_A_PATH)
def test_calls_that_refuse(name: str, slides: bool) -> None:
    """Each names itself, and what to do in its place: those that differentiate, differences."""
    muscle = rubbing()
    if slides:
        muscle = _loose(muscle).replace("friction", mk.Friction(chamber_coefficient=0.3))
    with pytest.raises(mk.SpecError, match=rf"does not go with {name}\(\): .* depends on the path .* use ") as caught:
        WITHOUT_A_PATH[name](muscle)
    assert ("differences of run()" in str(caught.value)) == (name in ("response", "sensitivity"))


def test_derivatives_under_a_transformation_refuse_too() -> None:
    def force(moment: Any) -> Any:
        return mk.response(rubbing(mk.Friction(constant=moment)), HELD)["force"][0]

    with pytest.raises(mk.SpecError, match="differences of run"):
        jax.grad(force)(2e-5)


def test_choices_with_friction_are_refused_too() -> None:
    choices = {"friction": [mk.Friction(constant="0.02 N mm"), mk.Friction(constant="0.01 N mm")]}
    with pytest.raises(mk.SpecError, match="does not go with design"):
        mk.design(mk.presets.paper(), choices, PULL, designs=64)


def test_tests_that_refuse() -> None:
    with pytest.raises(mk.SpecError, match="sealed gas"):
        mk.run(rubbing(), mk.Step(length="110 mm", gas="isothermal"))
    with pytest.raises(mk.SpecError, match="turn freely"):
        mk.run(rubbing(), HELD, discretisation="paper")


@pytest.mark.filterwarnings("ignore:.*would not touch:mckibben.MuscleWarning")
def test_slack_fibres_are_mounted_first(monkeypatch: pytest.MonkeyPatch) -> None:
    """A tube smaller than the braid pulls slack fibres in so far that Newton finds no way from the braid as made."""
    tube = mk.Chamber(outer_diameter="18 mm", inner_diameter="14.6 mm", law=mk.NeoHookean(c1="500 kPa"))
    muscle = rubbing(BOTH, braid__fibre__stretch=True, braid__fibre__slack=True, chamber=tube)
    test = isobaric(100, 95, 90, 95)
    found = mk.run(muscle, test, tolerance=1e-2)
    assert found.verdict == ("stable",) * 4
    assert found.force[3] - found.force[1] > 0.1  # more is needed to lengthen it than it pulls as it shortens
    assert (np.diff(found.data["dissipated"]) > 0.0).all()
    monkeypatch.setattr(walked_module, "mounted", lambda *_: None)
    assert mk.run(muscle, test, tolerance=1e-2).reached == 0

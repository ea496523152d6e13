"""Rigs in motion against closed forms: air through valves, masses on springs, energies; and what is refused.

Most muscles here are maps in closed form: a vessel of constant volume beside a spring, and the textbook cylinder.
"""

import json
import math
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import attrs
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import mckibben as mk
from mckibben.motion.flow import GAMMA, GAS, RHO, TEMPERATURE, mass_flow
from mckibben.motion.plant import Plant
from mckibben.motion.regime import FIRST, PER, Mode, Regime
from mckibben.motion.start import state_of
from mckibben.spec.rigtext import rig_from_mapping, rig_to_mapping, rig_to_toml

pytestmark = pytest.mark.motion

M = mk.presets.paper()
ATMOSPHERE = 101325.0


class Values(NamedTuple):
    force: float
    volume: float
    stiffness: float
    volume_by_length: float
    volume_by_pressure: float
    potential: float
    inside: bool


@attrs.frozen
class Vessel:
    """A vessel of constant volume beside a spring."""

    size: float = 5e-5
    k: float = 0.0
    rest: float = 0.1
    pressures: tuple[float, float] = (-5e4, 2e6)

    def lengths(self, pressure: float) -> tuple[float, float]:
        return 0.05, 0.15

    def at(self, h: float, P: float) -> Values:
        d = h - self.rest
        return Values(self.k * d, self.size, self.k, 0.0, 0.0, 0.5 * self.k * d * d - P * self.size, 0.05 <= h <= 0.15)

    def air_volume(self, h: float, P: float) -> float:
        return self.size


@attrs.frozen
class Cylinder:
    """The textbook cylinder, V = h (b^2 - h^2) / (4 pi n^2), F = -P dV/dh, and a spring."""

    b: float = 0.16
    n: float = 1.2
    k: float = 0.0
    rest: float = 0.1
    pressures: tuple[float, float] = (-5e4, 2e6)

    def lengths(self, pressure: float) -> tuple[float, float]:
        return 0.05, 0.15

    def at(self, h: float, P: float) -> Values:
        c, d = 1.0 / (4.0 * math.pi * self.n**2), h - self.rest
        V, V1, V2 = c * h * (self.b**2 - h * h), c * (self.b**2 - 3.0 * h * h), -6.0 * c * h
        energy = 0.5 * self.k * d * d
        return Values(self.k * d - P * V1, V, self.k - P * V2, V1, 0.0, energy - P * V, 0.05 <= h <= 0.15)

    def air_volume(self, h: float, P: float) -> float:
        return self.at(h, P).volume


VALVE = mk.Valve(C="0.05 L/s/bar", b=0.3)
PARTS = {"muscle": M, "supply": mk.Supply(gauge="6 bar"), "valve": VALVE}
HELD = mk.Rig(load=mk.FixedEnd(length="100 mm"), command=1.0, **PARTS)
LIFT = mk.Rig(
    load=mk.Load(mass="5 kg", damping="20 N s/m"), command=mk.Jump(1.0, at="0.1 s"), pressure="1 bar", **PARTS
)
PAIR = mk.Rig(
    antagonist=M, load=mk.Pulley(radius="20 mm", inertia="1e-3 kg m^2", damping="0.05 N m s", length="100 mm"),
    pressure="1.5 bar", **PARTS,
)  # fmt: skip


def test_flow_is_choked_below_the_critical_ratio_and_straight_near_one() -> None:
    choked = mass_flow(1e-9, 0.3, 7e5, 300.0, 1e5)
    assert choked == pytest.approx(1e-9 * RHO * 7e5 * math.sqrt(TEMPERATURE / 300.0), rel=1e-14)
    assert mass_flow(1e-9, 0.3, 7e5, 300.0, 0.3 * 7e5) == choked
    half = mass_flow(1e-9, 0.3, 7e5, 300.0, 0.65 * 7e5)
    assert half == pytest.approx(choked * math.sqrt(0.75), rel=1e-12)
    near = [mass_flow(1e-9, 0.3, 7e5, 300.0, (1.0 - d) * 7e5) for d in (0.0, 2e-4, 4e-4)]
    assert near[0] == 0.0
    assert near[2] == pytest.approx(2.0 * near[1], rel=1e-9)


@settings(max_examples=50)
@given(st.floats(0.0, 0.95), st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_flow_falls_steadily_with_the_pressure_behind(b: float, low: float, more: float) -> None:
    high = low + more * (1.0 - low)
    flows = [mass_flow(1e-9, b, 7e5, 293.15, ratio * 7e5) for ratio in (low, high)]
    assert flows[0] >= flows[1] >= 0.0


@pytest.mark.parametrize("n", [1.0, 1.25, 1.4])
def test_a_rigid_volume_fills_along_a_straight_line_while_choked(n: float) -> None:
    """dp/dt = n C rho0 p1 sqrt(T0/T1) R T1 / V, constant up to b p1."""
    rig = attrs.evolve(HELD, air=mk.Isothermal() if n == 1.0 else mk.Polytropic(n=n), valve=mk.Valve(C="0.005 L/s/bar"))
    motion = mk.simulate(rig, until="0.3 s", chart=Vessel(), points=31)
    p1 = 6e5 + ATMOSPHERE
    rate = n * 5e-11 * RHO * p1 * GAS * TEMPERATURE / 5e-5
    assert rate * 0.3 + ATMOSPHERE < 0.3 * p1  # choked to the end
    expected = ATMOSPHERE + rate * motion.time
    np.testing.assert_allclose(motion.of("pressure_absolute"), expected, rtol=1e-8)


def test_isothermal_discharge_decays_exponentially_while_choked() -> None:
    rig = attrs.evolve(HELD, command=-1.0, pressure=6e5, valve=mk.Valve(C="0.005 L/s/bar", b=0.3))
    motion = mk.simulate(rig, until="1 s", chart=Vessel(), points=21)
    absolute = motion.of("pressure_absolute")
    expected = (6e5 + ATMOSPHERE) * np.exp(-5e-11 * RHO * GAS * TEMPERATURE / 5e-5 * motion.time)
    choked = absolute > ATMOSPHERE / 0.3
    assert choked.sum() > 15
    np.testing.assert_allclose(absolute[choked], expected[choked], rtol=1e-5)


def test_an_adiabatic_fill_from_nothing_ends_at_gamma_times_the_temperature() -> None:
    """From p0 at T: m = m0 + (p - p0) V / (gamma R T), T' = p V / (m R); gamma T for p0 << p."""
    rig = attrs.evolve(HELD, air=mk.Polytropic(n=1.4), atmosphere=1e4, supply=mk.Supply(absolute="20 bar"))
    vessel = Vessel(pressures=(-5e3, 3e6))
    motion = mk.simulate(rig, until="2 s", chart=vessel, points=21, tolerance=1e-8)
    p0, p = 1e4, motion.of("pressure_absolute")[-1]
    expected = p * TEMPERATURE / (p0 + (p - p0) / GAMMA)
    assert motion.of("temperature")[-1] == pytest.approx(expected, rel=1e-7)
    assert motion.of("temperature")[-1] == pytest.approx(GAMMA * TEMPERATURE, rel=3e-3)
    assert float(np.abs(motion.of("heat")).max()) < 1e-4 * motion.of("enthalpy")[-1]


def test_heat_to_the_wall_has_both_limits() -> None:
    def filled(air: object) -> mk.Motion:
        return mk.simulate(attrs.evolve(HELD, air=air), until="3 s", chart=Vessel(), points=31, tolerance=1e-8)

    adiabatic, isothermal = filled(mk.Polytropic(n=1.4)), filled(mk.Isothermal())
    np.testing.assert_allclose(filled(mk.WallHeat(conductance=0.0)).pressure, adiabatic.pressure, rtol=1e-6, atol=1.0)
    np.testing.assert_allclose(filled(mk.WallHeat(conductance=1e4)).pressure, isothermal.pressure, rtol=1e-4, atol=20.0)
    cooling = filled(mk.WallHeat(conductance=0.2)).of("temperature")
    assert TEMPERATURE < cooling[-1] < cooling.max() < adiabatic.of("temperature").max()


def test_closed_air_keeps_its_polytrope() -> None:
    rig = attrs.evolve(LIFT, air=mk.Polytropic(n=1.3), command=0.0, load=mk.Load(mass="5 kg", start="95 mm"))
    motion = mk.simulate(rig, until="0.5 s", chart=Cylinder(), tolerance=1e-9)
    assert np.ptp(motion.length) > 1e-3
    kept = motion.of("pressure_absolute") * motion.of("volume") ** 1.3
    np.testing.assert_allclose(kept, kept[0], rtol=1e-6)
    np.testing.assert_allclose(motion.of("mass"), motion.of("mass")[0], rtol=1e-6)


SWINGING = attrs.evolve(HELD, command=0.0, load=mk.Load(mass="2 kg", gravity=0.0, start="105 mm"))


def test_a_mass_on_a_spring_swings_at_its_natural_frequency() -> None:
    motion = mk.simulate(SWINGING, until="1 s", chart=Vessel(k=800.0), tolerance=1e-10)
    expected = 0.1 + 0.005 * np.cos(math.sqrt(800.0 / 2.0) * motion.time)
    np.testing.assert_allclose(motion.length, expected, atol=5e-3 * 1e-5)


def test_a_damped_mass_decays() -> None:
    load = mk.Load(mass="2 kg", gravity=0.0, start="105 mm", damping=6.0, spring=300.0, spring_at="100 mm")
    motion = mk.simulate(attrs.evolve(SWINGING, load=load), until="1.5 s", chart=Vessel(k=500.0), tolerance=1e-10)
    decay, omega = 6.0 / 4.0, math.sqrt(800.0 / 2.0 - (6.0 / 4.0) ** 2)
    turned = np.cos(omega * motion.time) + decay / omega * np.sin(omega * motion.time)
    np.testing.assert_allclose(motion.length, 0.1 + 0.005 * np.exp(-decay * motion.time) * turned, atol=5e-8)
    assert motion.of("lost")[-1] == pytest.approx(0.5 * 800.0 * 0.005**2 * (1.0 - math.exp(-2 * decay * 1.5)), rel=0.02)


def test_dry_friction_takes_the_same_from_each_swing_and_then_holds() -> None:
    """Coulomb: the amplitude falls by 2 f / k each half swing, until k x <= f."""
    load = attrs.evolve(SWINGING.load, friction=0.5)
    motion = mk.simulate(attrs.evolve(SWINGING, load=load), until="2 s", chart=Vessel(k=800.0), tolerance=1e-9)
    events = motion.events
    half = math.pi / math.sqrt(400.0)
    turns = events[events["event"] != "friction gave way"]
    np.testing.assert_allclose(turns["time"], half * np.arange(1, len(turns) + 1), atol=1e-6)
    assert turns["event"].tolist() == ["turned round"] * 3 + ["came to rest: friction holds"]
    assert motion.length[-1] == pytest.approx(0.1 + (0.005 - 4 * 2 * 0.5 / 800.0), abs=1e-8)
    assert motion.of("moves")[-1] == "stuck"


def test_a_stop_takes_the_speed_and_is_left_when_the_push_turns() -> None:
    load = mk.Load(mass="5 kg", damping="20 N s/m", stop_low="99 mm", stop_high="104 mm")
    rig = attrs.evolve(LIFT, load=load, pressure=0.0, command=mk.PWM(0.5, frequency="1 Hz"))
    motion = mk.simulate(rig, until="2 s", chart=Cylinder())
    assert motion.length.min() == 0.099
    assert motion.length.max() == 0.104
    events = motion.events["event"].tolist()
    assert events[:2] == ["left the high end stop", "reached the high end stop"]
    assert events[-2:] == ["reached the low end stop", "left the low end stop"]
    assert motion.of("moves")[450] == "low"
    assert float(np.abs(motion.of("balance")).max()) < 1e-4 * motion.of("enthalpy").max()


def test_a_cable_goes_slack_and_is_straight_again() -> None:
    push = mk.Series([0, 0.1, 0.3, 2], [0, -60, 60, 60])
    load = mk.Load(mass="20 kg", gravity=0.0, damping=100.0, slack=True, push=push)
    rig = attrs.evolve(LIFT, load=load, command=0.0, pressure="2 bar")
    motion = mk.simulate(rig, until="0.5 s", chart=Cylinder(k=2000.0, rest=0.09), tolerance=1e-8)
    slack = motion.of("slack")
    assert slack.any()
    assert not slack[-1]
    assert motion.force.min() >= -1e-6
    assert float(np.abs(motion.force[slack]).max()) == 0.0
    free = [Cylinder(k=2000.0, rest=0.09).at(float(h), float(P)).force
            for h, P in zip(motion.length[slack], motion.pressure[slack], strict=True)]  # fmt: skip
    assert float(np.abs(free).max()) < 1e-3
    assert float(np.abs(motion.of("balance")).max()) < 2e-5


@pytest.mark.parametrize("stiffness", [None, 3000.0])
def test_rubber_relaxes(stiffness: float | None) -> None:
    """Kelvin-Voigt: F + c v in a steady pull; the standard linear solid tends to that and fades with c / k."""
    viscosity = mk.Viscosity(damping=40.0, stiffness=stiffness)
    load = mk.Load(mass="1 kg", gravity=0.0, push=mk.Jump(10.0), start="100 mm")
    rig = attrs.evolve(SWINGING, load=load, viscosity=viscosity)
    motion = mk.simulate(rig, until="1 s", chart=Vessel(k=400.0), tolerance=1e-9)
    assert motion.length[-1] == pytest.approx(0.1 + 10.0 / 400.0, abs=3e-5)
    assert float(np.abs(motion.of("balance")).max()) < 1e-6
    if stiffness is None:
        v = motion.speed
        np.testing.assert_allclose(motion.force, 400.0 * (motion.length - 0.1) + 40.0 * v, atol=1e-9)


def test_energy_is_kept_over_a_cycle_with_heat_and_viscosity() -> None:
    rig = attrs.evolve(LIFT, air=mk.WallHeat(conductance=0.05), viscosity=mk.Viscosity(damping=50.0, stiffness=500.0),
                       command=mk.PWM(0.6, frequency="2 Hz"), tube=1e-5)  # fmt: skip
    motion = mk.simulate(rig, until="2 s", chart=Cylinder(k=200.0), tolerance=1e-8)
    assert float(np.abs(motion.of("balance")).max()) < 1e-6 * motion.of("enthalpy").max()
    gained = motion.of("mass_in") - motion.of("mass_out")
    np.testing.assert_allclose(motion.of("mass") - motion.of("mass")[0], gained, atol=1e-10)
    cycle = mk.per_cycle(motion, period="0.5 s")
    assert cycle.air == pytest.approx((motion.consumed - np.interp(1.5, motion.time, motion.of("consumed"))), rel=1e-9)
    assert 0.0 < cycle.efficiency < 1.0


def test_the_error_falls_with_the_tolerance() -> None:
    rig = attrs.evolve(LIFT, air=mk.WallHeat(conductance=0.5), pressure="1 bar")
    ends = [mk.simulate(rig, until="0.4 s", chart=Cylinder(), points=2, tolerance=tol).length[-1]
            for tol in (1e-4, 1e-6, 1e-8, 1e-11)]  # fmt: skip
    errors = np.abs(np.array(ends[:-1]) - ends[-1])
    assert errors[0] > 5.0 * errors[1] > 25.0 * errors[2] > 0.0
    stiff = mk.simulate(rig, until="0.4 s", chart=Cylinder(), points=2, tolerance=1e-8, method="Radau").length[-1]
    assert stiff == pytest.approx(ends[-1], abs=1e-7)


def test_pressure_stays_between_the_supply_and_the_atmosphere() -> None:
    for rig in (HELD, attrs.evolve(HELD, command=mk.PWM(0.7, frequency="5 Hz"))):
        P = mk.simulate(rig, until="2 s", chart=Vessel()).pressure
        assert P.min() >= -1e-3
        assert P.max() <= 6e5 * (1.0 + 1e-6)


def test_mirrored_muscles_stay_where_they_are() -> None:
    same = attrs.evolve(PAIR, command=mk.Jump(1.0, at="0.1 s"), antagonist_command=mk.Jump(1.0, at="0.1 s"))
    motion = mk.simulate(same, until="0.5 s", chart=Cylinder())
    assert float(np.abs(motion.angle).max()) < 1e-12
    assert motion.pressure[-1, 0] == motion.pressure[-1, 1] > 3e5
    left, right = (mk.simulate(attrs.evolve(PAIR, command=mk.PWM(0.5, "10 Hz", high=u, low=0.0)), until="0.3 s",
                               chart=Cylinder()) for u in (1.0, -1.0))  # fmt: skip
    assert left.angle.max() > 0.05
    np.testing.assert_allclose(left.angle, -right.angle, atol=1e-9)


def test_the_equations_are_those_of_their_derivatives() -> None:
    """Rates of pressure and temperature against the balance of energy and the gas law, at states all over."""
    rig = attrs.evolve(PAIR, air=mk.WallHeat(conductance=0.3), viscosity=mk.Viscosity(damping=20.0, stiffness=300.0))
    plant = Plant.of(rig, [Cylinder(k=100.0), Cylinder(n=1.3)])
    regime = Regime(plant, Mode("free"), [lambda t: 0.4, lambda t: -0.7])
    y = np.array(state_of(plant, 0.1))
    y[[1, FIRST, FIRST + 1, FIRST + 3, FIRST + PER, FIRST + PER + 1]] = 2.0, 3.1e5, 320.0, 4.0, 2.2e5, 280.0
    rates = np.array(regime.rates(0.0, y.tolist()).state)
    step = 1e-6

    def gas(k: int, y: np.ndarray) -> tuple[float, float, float]:
        seen = regime.rates(0.0, y.tolist()).muscles[k]
        p = float(y[FIRST + PER * k])
        return seen.mass, p * seen.volume / (GAMMA - 1.0), seen.volume

    for k in range(2):
        later, sooner = (np.array(gas(k, y + sign * step * rates)) for sign in (1.0, -1.0))
        mass, internal, volume = (later - sooner) / (2.0 * step)
        seen = regime.rates(0.0, y.tolist()).muscles[k]
        part = rates[FIRST + PER * k : FIRST + PER * (k + 1)]
        assert mass == pytest.approx(seen.inflow - seen.outflow, rel=1e-5)
        wall = 0.3 * (293.15 - y[FIRST + PER * k + 1])
        assert part[7] == pytest.approx(wall, rel=1e-6)
        assert internal == pytest.approx(part[6] + wall - y[FIRST + PER * k] * volume, rel=1e-5)


def test_a_pid_brings_a_joint_to_its_target() -> None:
    pid = mk.PID(of="angle", target=mk.Jump("10 deg", at="0.1 s"), kp=6.0, kd=0.1, filter="5 ms")
    motion = mk.simulate(attrs.evolve(PAIR, command=pid), until="1.5 s", chart=Cylinder())
    assert math.degrees(motion.angle[-1]) == pytest.approx(10.0, abs=0.4)
    found = mk.step_response(motion, at="0.1 s", final=math.radians(10.0))
    assert found.rise < 1.0
    assert found.overshoot < 0.3
    assert found.delay < 0.2 < found.rise


def test_the_integral_does_not_wind_up() -> None:
    """A target out of reach for a second costs no second on the way back."""
    target = mk.Series(time=[0.0, 1.0, 1.001, 3.0], value=["20 bar", "20 bar", "2 bar", "2 bar"])
    rig = attrs.evolve(HELD, command=mk.PID(of="pressure", target=target, kp=1e-5, ki=1e-4))
    motion = mk.simulate(rig, until="2 s", chart=Vessel(size=2e-5))
    assert motion.pressure[250] == pytest.approx(6e5, rel=1e-3)
    assert motion.of("command")[252:300].tolist() == [-1.0] * 48
    assert motion.pressure[-1] == pytest.approx(2e5, rel=0.02)


def test_a_function_is_called_at_its_samples_with_what_is_seen() -> None:
    called: list[tuple[float, dict[str, float]]] = []

    def decide(t: float, seen: dict[str, float]) -> float:
        called.append((t, dict(seen)))
        return 1.0 if seen["pressure"] < 3e5 else -1.0

    valve = mk.Valve(C="0.05 L/s/bar", b=0.3, delay="20 ms")
    rig = attrs.evolve(HELD, valve=valve, command=mk.Controller(decide, every="10 ms"))
    motion = mk.simulate(rig, until="0.5 s", chart=Vessel())
    np.testing.assert_allclose([t for t, _ in called], 0.01 * np.arange(50 + 1)[: len(called)], atol=1e-12)
    assert set(called[0][1]) == {"length", "speed", "force", "pressure"}
    assert motion.of("command")[motion.time < 0.0199].max() == 0.0  # the dead time
    assert motion.pressure[-100:] == pytest.approx(3e5, rel=0.15)
    with pytest.raises(mk.SpecError, match="Python function, which no file holds"):
        rig_to_toml(rig)
    with pytest.raises(mk.SpecError, match="Python function"):
        motion.rig  # noqa: B018


def test_pulses_lift_in_proportion_to_their_duty() -> None:
    def mean(duty: float) -> float:
        rig = attrs.evolve(HELD, command=mk.PWM(duty, frequency="50 Hz"), pressure="1 bar")
        return float(mk.simulate(rig, until="3 s", chart=Vessel(size=2e-4)).pressure[-100:].mean())

    means = [mean(duty) for duty in (0.2, 0.4, 0.6)]
    assert 0.0 < means[0] < means[1] < means[2] < 6e5


LINEAR = attrs.evolve(LIFT, command=0.0, pressure="2 bar", load=mk.Load(mass="5 kg", damping=30.0))


def test_a_frequency_response_has_the_frequency_of_closed_air() -> None:
    """k = dF/dh at constant mass: F_h + (dV/dh)^2 p / V, isothermal."""
    found = mk.bode(LINEAR, frequency=[1.0, 5.0], chart=Cylinder())
    h = found.at["length"]
    at = Cylinder().at(h, 2e5)
    k = at.stiffness + at.volume_by_length**2 * (2e5 + ATMOSPHERE) / at.volume
    assert found.natural_frequency == pytest.approx(math.sqrt(k / 5.0) / (2.0 * math.pi), rel=1e-5)
    assert found.damping == pytest.approx(30.0 / (2.0 * math.sqrt(5.0 * k)), rel=1e-5)
    s = 2j * math.pi * found.frequency
    np.testing.assert_allclose(found.response, 1.0 / (5.0 * s**2 + 30.0 * s + k), rtol=1e-5)
    drawn = mk.plot(found).axes[0]
    assert drawn.get_ylabel() == "Length by push (mm/N)"
    np.testing.assert_allclose(drawn.lines[0].get_ydata(), 1e3 * found.gain)


@pytest.mark.parametrize("by", ["push", "command"])
def test_a_frequency_response_is_that_of_a_small_sine_in_time(by: str) -> None:
    f, periods = 3.0, 14
    rig = attrs.evolve(LINEAR, load=mk.Load(mass="5 kg", damping=120.0, push=mk.Sine(0.5, f) if by == "push" else None),
                       command=mk.Sine(0.002, f) if by == "command" else 0.0)  # fmt: skip
    motion = mk.simulate(rig, until=periods / f, chart=Cylinder(), points=periods * 50 + 1, tolerance=1e-8)
    t, x = motion.time[-501:], motion.length[-501:]
    t, x = t[:-1], (x - np.linspace(x[0], x[-1], 501))[:-1]  # ten periods, without the slow drift
    seen = 2.0 * np.mean(x * np.exp(-2j * np.pi * f * t)) * 1j / (0.5 if by == "push" else 0.002)
    told = mk.bode(rig, frequency=f, by=by, chart=Cylinder()).response[0]
    assert abs(seen) == pytest.approx(abs(told), rel=0.02)
    assert np.angle(seen / told) == pytest.approx(0.0, abs=0.03)


def test_a_valve_is_as_large_as_choked_flow_into_a_vessel_needs() -> None:
    found = mk.size_valve(HELD, within="0.5 s", pressure="1 bar", chart=Vessel())
    C = 1e5 * 5e-5 / (0.5 * RHO * (6e5 + ATMOSPHERE) * GAS * TEMPERATURE)
    assert pytest.approx(C, rel=2e-4) == found.valve.C
    again = mk.simulate(attrs.evolve(HELD, valve=found.valve), until="0.5 s", chart=Vessel(), points=3)
    assert again.pressure[-1] == pytest.approx(1e5, rel=2e-4)
    out = mk.size_valve(
        attrs.evolve(HELD, pressure="5 bar"), within="0.5 s", pressure="0.5 bar", vent=True, chart=Vessel()
    )
    assert out.valve.venting > found.valve.C
    with pytest.raises(mk.SpecError, match=r"size_valve.pressure = 7 bar: must be between"):
        mk.size_valve(HELD, within="1 s", pressure="7 bar", chart=Vessel())


def test_many_are_as_each_by_itself() -> None:
    rigs = [attrs.evolve(HELD, valve=mk.Valve(C=C, b=0.3)) for C in (1e-10, 2e-10)]
    many = mk.simulate_many(rigs, until="0.1 s", chart=Vessel(), points=11, workers=1)
    assert many == [mk.simulate(rig, until="0.1 s", chart=Vessel(), points=11) for rig in rigs]
    assert mk.simulate_many([], until="0.1 s", chart=Vessel(), workers=2) == []
    wrong = [*rigs, attrs.evolve(HELD, command=mk.Series([0, 0.05], [0, 1]))]
    with pytest.raises(mk.SpecError, match=r"rigs\[2\]: rig.command: ends at 0.05 s"):
        mk.simulate_many(wrong, until="0.1 s", chart=Vessel(), workers=1)


SCRIPT = """
import attrs, mckibben as mk
from mckibben.potential.evaluate import Values

@attrs.frozen
class Vessel:
    pressures = (-5e4, 2e6)
    def lengths(self, pressure):
        return 0.05, 0.15
    def at(self, h, P):
        return Values(0.0, 5e-5, 0.0, 0.0, 0.0, -P * 5e-5, True)
    def air_volume(self, h, P):
        return 5e-5

def half(time, sensed):
    return 0.5

print("begun")
parts = dict(muscle=mk.presets.paper(), load=mk.FixedEnd(length="100 mm"), supply=mk.Supply(gauge="2 bar"))
rigs = [mk.Rig(valve=mk.Valve(C=C, b=0.3), command=mk.Controller(half, "10 ms"), **parts) for C in (1e-10, 2e-10)]
apart, here = (mk.simulate_many(rigs, until="0.1 s", chart=Vessel(), points=11, workers=n) for n in (2, 1))
print("same", apart == here)
"""


def test_processes_do_not_run_the_script_again(tmp_path: Path) -> None:
    """One without the usual guard, whose controller and map are its own."""
    (tmp_path / "script.py").write_text(SCRIPT, encoding="utf-8")
    done = subprocess.run([sys.executable, "script.py"], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split("\n") == ["begun", "same True", ""]


SIGNALS = {
    "jump": mk.Jump(1.0, before=-1.0, at="0.1 s"), "pwm": mk.PWM(mk.Ramp(0.9, stop="1 s"), frequency="20 Hz"),
    "series": mk.Series([0.0, 1.0], [0.0, 0.5], between="hold"), "sine": mk.Sine(0.3, "2 Hz", mean=0.2),
    "pid": mk.PID(of="length", target=mk.Ramp("90 mm", begin="110 mm"), kp=50.0, low=-0.5),
}  # fmt: skip


@pytest.mark.parametrize("name", SIGNALS)
def test_a_rig_in_a_file_reads_back_equal(name: str) -> None:
    import tomllib

    rig = attrs.evolve(
        LIFT, command=SIGNALS[name], viscosity=mk.Viscosity(damping=3.0), air=mk.WallHeat(conductance=0.1)
    )
    assert rig_from_mapping(tomllib.loads(rig_to_toml(rig))) == rig
    pair = attrs.evolve(PAIR, antagonist_command=0.5, antagonist_pressure="2 bar", antagonist_valve=VALVE)
    assert rig_from_mapping(rig_to_mapping(pair)) == pair


def without(**parts: object) -> Callable[[], object]:
    return lambda: mk.Rig(**{**PARTS, "load": HELD.load, "command": 1.0, **parts})  # type: ignore[arg-type]


REFUSED: dict[str, Callable[[], object]] = {
    r"rig.supply: is missing: a rig without air does not move": without(supply=None),
    r"rig.valve: is missing: a rig without air does not move": without(valve=None),
    r"valve.b = 1.2: must be at least 0 and below 1": lambda: mk.Valve(C=1e-9, b=1.2),
    r"valve.b = -0.1: must be at least 0": lambda: mk.Valve(C=1e-9, b=-0.1),
    r"supply: is given both as gauge and as absolute": lambda: mk.Supply(gauge="6 bar", absolute="7 bar"),
    r"supply: has no pressure; give either gauge": mk.Supply,
    r"supply.absolute = 1 bar: must be above the atmosphere": without(supply=mk.Supply(absolute="1 bar")),
    r"supply.gauge = 6: .* write \"6 bar\"": lambda: mk.Supply(gauge=6),
    r"supply.temperature = 70 degF: must be a temperature in K or degC": lambda: mk.Supply(
        gauge=1e5, temperature="70 degF"
    ),
    r"rig.pressure = 7 bar: must be at most that of the supply, 6 bar gauge": without(pressure="7 bar"),
    r"rig.command = 2: must be at least -1 and at most 1": without(command=2),
    r"rig.command.amplitude": without(command=mk.Sine(0.8, "1 Hz", mean=0.5)),
    r"rig.load: two muscles need a pulley, not FixedEnd": without(antagonist=M),
    r"muscle.friction: does not go with slack = true": without(
        muscle=M.replace("friction", mk.Friction(constant=1e-5)), load=mk.Load(mass="1 kg", slack=True)
    ),
    r"pid.of = angle: is that of a pulley": without(command=mk.PID(of="angle", target=0.1, kp=1.0)),
    r"pid.target = 2 bar: has the wrong kind of unit": lambda: mk.PID(of="length", target="2 bar", kp=1.0),
    r"series.time\[1\] = 0 s: must be after the time before": lambda: mk.Series([0.0, 0.0], [0.0, 1.0]),
    r"rig.command: ends at 0.5 s, before the simulation does, at 1 s": lambda: mk.simulate(
        attrs.evolve(HELD, command=mk.Series([0.0, 0.5], [0.0, 1.0])), until="1 s", chart=Vessel()
    ),
    r"rig.command = nan: is no command: the controller gave it at 0.01 s": lambda: mk.simulate(
        attrs.evolve(HELD, command=mk.Controller(lambda t, seen: math.nan if t > 0.005 else 1.0)), "1 s", chart=Vessel()
    ),
    r"fixed.length = 160 mm: is outside of the map": lambda: mk.simulate(
        attrs.evolve(HELD, load=mk.FixedEnd(length="160 mm")), "1 s", chart=Vessel()
    ),
    r"load.start: is not given, and no equilibrium is between 50 mm and 150 mm": lambda: mk.simulate(
        attrs.evolve(LIFT, load=mk.Load(mass="500 kg")), "1 s", chart=Cylinder()
    ),
    r"simulate.method = LSOD: is unknown; did you mean \"LSODA\"": lambda: mk.simulate(HELD, "1 s", method="LSOD"),
    r"simulate.until = -1 s: must be above 0 s": lambda: mk.simulate(HELD, "-1 s", chart=Vessel()),
    r"simulate.chart = .*: must be a map": lambda: mk.simulate(HELD, "1 s", chart="map"),
}  # fmt: skip


@pytest.mark.parametrize("said", REFUSED)
def test_wrong_input_is_told_in_one_line(said: str) -> None:
    with pytest.raises(mk.SpecError, match=said) as caught:
        REFUSED[said]()
    assert "\n" not in str(caught.value)


def test_what_was_reached_is_kept_where_a_simulation_cannot_go_on() -> None:
    class Breaks(Vessel):
        def at(self, h: float, P: float) -> Values:
            found = Vessel.at(self, h, P)
            return found if P < 3e5 else found._replace(volume=math.nan)

    motion = mk.simulate(HELD, until="2 s", chart=Breaks())
    assert not motion.complete
    assert motion.reason.startswith("stopped at 0.")
    assert 10 < len(motion.time) < 501
    assert np.isfinite(motion.pressure).all()


def test_times_outside_of_the_map_are_told() -> None:
    rig = attrs.evolve(LIFT, load=mk.Load(mass="2 kg", gravity=0.0, push=-300.0, start="60 mm", damping=50.0))
    motion = mk.simulate(rig, until="0.2 s", chart=Cylinder())
    assert motion.complete
    assert not motion.inside
    assert any("outside of its map" in note for note in motion.notes)


def test_the_command_simulates_saves_and_draws(tmp_path: Path) -> None:
    """From the rig file to what is saved, with a map from a file; and the picture of a pair."""
    from typer.testing import CliRunner

    from mckibben.app.cli import app

    chart = tmp_path / "chart.nc"
    mk.save(mk.chart(M, length="60 mm to 115 mm", pressure="0 to 2 bar"), chart)
    (tmp_path / "command.csv").write_text("t [s];command\n0;1\n0.2;1\n0.6;-1\n", encoding="utf-8")
    text = (Path(__file__).parent.parent / "examples" / "rig.toml").read_text(encoding="utf-8")
    rig = tmp_path / "rig.toml"
    rig.write_text(text.partition("[command]")[0] + '[command]\nkind = "csv"\nfile = "command.csv"\n', encoding="utf-8")
    call = ["simulate", str(rig), "--chart", str(chart), "--set", "until=0.5 s", "--set", "load.mass=1 kg"]
    done = CliRunner().invoke(app, [*call, "-o", str(tmp_path / "m.nc"), "--plot", str(tmp_path / "m.png")])
    assert done.exit_code == 0, done.output
    assert "left the high end stop" in done.stdout
    motion = mk.load(tmp_path / "m.nc")
    assert isinstance(motion, mk.Motion)
    assert motion.rig.load.mass == 1.0
    assert motion == mk.simulate(motion.rig, until="0.5 s", chart=mk.load(chart))
    assert motion.notes[0].startswith("the forces are those of a map, good to 0.0")
    assert float(np.abs(motion.of("balance")).max()) < 1e-4 * motion.of("enthalpy").max()
    table = mk.save(motion, tmp_path / "m.csv").read_text(encoding="utf-8").splitlines()
    assert table[0].startswith("time [s],length [m],speed [m/s]")
    assert len(table) == 502
    described = CliRunner().invoke(app, ["info", str(tmp_path / "m.nc")])
    assert 'the motion of "paper" with 1 kg' in described.stdout
    told = json.loads(CliRunner().invoke(app, [*call, "--json"]).stdout)
    assert told["complete"]
    assert told["values"]["length"]["last"] == motion.length[-1]
    wrong = CliRunner().invoke(app, [*call, "--set", "until=2 s"])
    assert wrong.exit_code == 2
    assert wrong.stderr == (
        "mckibben: rig.command: ends at 0.6 s, before the simulation does, at 2 s; "
        "give it values to the end, or simulate less\n"
    )
    rig.write_text(text.replace('kind = "pwm"', 'kind = "pwn"'), encoding="utf-8")
    assert 'did you mean "pwm"?' in CliRunner().invoke(app, call).stderr


def test_a_pair_is_drawn_shown_and_summed_up() -> None:
    pid = mk.PID(of="angle", target="5 deg", kp=6.0)
    motion = mk.simulate(attrs.evolve(PAIR, command=pid), until="0.2 s", chart=Cylinder(), points=21)
    axes = mk.plot(motion).axes
    assert [one.get_ylabel() for one in axes[:4]] == [
        "Angle (deg)", "Gauge pressure (bar)", "Force (N)", "Air taken (normal L)",
    ]  # fmt: skip
    assert [line.get_label() for line in axes[0].lines] == ["angle", "target"]
    assert {"angle", "force of the agonist", "force of the antagonist"} <= set(motion.summary().index)
    assert "data:image/png" in motion._repr_html_()


@settings(max_examples=30)
@given(st.data())
def test_no_rig_hangs_and_energies_add_up(data: st.DataObject) -> None:
    """Masses, stops, friction, cables and pulses of all kinds come to their end, with all energy accounted for."""
    pick = data.draw
    load = mk.Load(
        mass=10.0 ** pick(st.floats(-1.0, 1.3)), gravity=pick(st.sampled_from([0.0, 9.81])),
        damping=pick(st.sampled_from([0.0, 30.0])), friction=pick(st.sampled_from([0.0, 5.0])),
        stop_low=pick(st.sampled_from([None, 0.092])), stop_high=0.11, slack=pick(st.booleans()),
        push=pick(st.sampled_from([None, mk.Sine(40.0, "5 Hz"), mk.Jump(-50.0, at="0.1 s")])),
    )  # fmt: skip
    command = pick(st.sampled_from([1.0, mk.PWM(0.5, "20 Hz"), mk.PID(of="length", target="97 mm", kp=300.0)]))
    rig = attrs.evolve(
        LIFT, load=load, command=command, pressure=pick(st.floats(1e3, 2e5)),
        air=pick(st.sampled_from([mk.Isothermal(), mk.WallHeat(conductance=0.5)])),
        viscosity=pick(st.sampled_from([None, *(mk.Viscosity(damping=20.0, stiffness=k) for k in (None, 500.0))])),
    )  # fmt: skip
    motion = mk.simulate(rig, until="0.3 s", chart=Cylinder(k=300.0), points=31)
    assert motion.complete
    assert -1e-9 <= motion.length.max() - 0.11 <= 1e-9 or motion.length.max() < 0.11 or load.slack
    moved = max(float(np.abs(motion.of(name)).max()) for name in ("enthalpy", "work", "lost"))
    assert float(np.abs(motion.of("balance")).max()) < 1e-3 * max(moved, 1e-2)
    if load.slack:
        assert motion.force.min() > -1e-3


def test_where_no_map_can_be_made_it_is_said_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[float, float]] = []

    def fails(muscle: mk.Muscle, *, length: tuple[float, float], pressure: tuple[float, float]) -> None:
        asked.append(length)
        raise mk.SpecError("chart", allowed="no stable state was found")

    monkeypatch.setattr("mckibben.charts.chart.chart", fails)
    stretches = mk.presets.get("pet-6")  # whose fibres stretch: it has no full extension
    rig = attrs.evolve(HELD, muscle=stretches, supply=mk.Supply(gauge="3.3 bar"))
    with pytest.raises(
        mk.SpecError, match=r"none can be made over .* 0 to 4 bar \(chart: no stable .*chart=mk.chart\("
    ):
        mk.simulate(rig, until="1 s")
    assert 1.1 * stretches.rest_length < asked[0][1] < 2.0 * stretches.rest_length

"""What every equilibrium satisfies, whatever solved it: conservation, balances, symmetry, limits, minima."""

import math
from typing import Any

import attrs
import numpy as np
import pytest
from muscles import MAGIC
from readings import profile, recovered
from scipy.interpolate import CubicSpline

import mckibben as mk
from mckibben.measure.read import NODES
from mckibben.model.cylinder import cylinder_force
from mckibben.model.parameters import parameters
from mckibben.model.textbook import virtual_work_force
from mckibben.solver.bench import Bench
from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.find import find
from mckibben.solver.held import Held

pytestmark = pytest.mark.solver

BAR = 1e5
REFERENCE = mk.presets.reference()
MIDDLE = NODES // 2


def fibres(muscle: mk.Muscle, factor: float) -> mk.Muscle:
    """The muscle with fibres stiffer by a factor."""
    f = muscle.braid.fibre
    return muscle.replace("braid.fibre", mk.Fibre(B1=factor * f.B1, B2=factor * f.B2, B3=factor * f.B3))


STIFF, THIN, PINNED = fibres(REFERENCE, 100.0), fibres(REFERENCE, 1e-6), REFERENCE.replace("ends", "pinned")
MUSCLES = {
    "reference": REFERENCE, "stiff": STIFF, "thin": THIN, "pinned": PINNED,
    "stiff pinned": STIFF.replace("ends", "pinned"), "thinner": fibres(REFERENCE, 1e-2),
    "straight": REFERENCE.replace("braid.fibre.natural", "straight"),
}  # fmt: skip


def solved(muscle: mk.Muscle, size: int = 48, modes: str = "odd", **values: float) -> Equilibrium:
    """A state on a space of given size."""
    bench, held = Bench.of(muscle), Held.of(**values)
    state = find(bench.problem(size, bench.placement(held), modes=modes), held)
    assert state.converged
    return state


@pytest.mark.parametrize(
    ("name", "length", "pressure"),
    [("reference", 0.115, BAR), ("reference", 0.055, BAR), ("reference", 0.060, 0.0), ("stiff", 0.055, BAR),
     ("thinner", 0.115, BAR)],
)  # fmt: skip
def test_a_quantity_is_conserved_along_the_length(name: str, length: float, pressure: float) -> None:
    sizes = (12, 24, 48)
    variation = [
        float(recovered(solved(MUSCLES[name], size, length=length, pressure=pressure)).conserved_variation[0])
        for size in sizes
    ]
    assert variation[1] < 0.02 * variation[0]
    assert variation[2] < max(0.02 * variation[1], 1e-12)
    assert variation[2] < 1e-8


@pytest.mark.parametrize(
    "test",
    [
        lambda n: mk.Isometric(length="115 mm", pressure="0.2 to 1 bar", points=n),
        lambda n: mk.Isobaric(pressure="1 bar", length="70 to 110 mm", points=n),
    ],
    ids=["isometric", "isobaric"],
)
def test_work_tends_to_the_change_of_energy(test: Any) -> None:
    """Cubic splines through the states of the path: the error falls with the fourth power of their distance."""
    points = np.array([8, 16, 32])
    error = []
    for n in points.tolist():
        data = mk.run(REFERENCE, test(n)).data
        gained = data["energy"] - data["energy"][0]
        error.append(abs(float(data["work"][-1] / gained[-1]) - 1.0))
    slope, _ = np.polyfit(np.log(points - 1), np.log(error), 1)
    assert -5.0 < slope < -4.0
    assert error[-1] < 5e-6


def test_mirror_symmetry() -> None:
    """The full length finds the half's state by itself: force, shape and, with another costate, tension."""
    held = {"length": 0.100, "pressure": BAR}
    half, full = solved(REFERENCE, 24, **held), solved(REFERENCE, 48, "all", **held)
    assert full.force == pytest.approx(half.force, rel=1e-13)
    assert np.abs(full.u[0::2]).max() < 5e-14
    np.testing.assert_allclose(full.u[1::2], half.u, atol=5e-14)
    one, two = (recovered(state).fields for state in (half, full))
    np.testing.assert_allclose(two["r"], two["r"][:, ::-1], rtol=1e-13)
    np.testing.assert_allclose(two["psi"], -two["psi"][:, ::-1], rtol=0.0, atol=1e-13)
    for name in ("theta", "z", "fibre_tension", "share_mesh"):
        np.testing.assert_allclose(two[name], one[name], rtol=0.0, atol=5e-14 * np.abs(one[name]).max())


def test_energies_add_up() -> None:
    for muscle in (REFERENCE, STIFF, PINNED):
        state = solved(muscle, length=0.070, pressure=BAR)
        parts = recovered(state).energies
        total = state.totals[0] * state.problem.unit[0]
        assert sum(float(part[0]) for part in parts.values()) == pytest.approx(total, rel=1e-14)
        assert min(float(part[0]) for part in parts.values()) > 0.0


class Longer:
    """A state's fields, and its potential if fibres were 1 + e f(v) times as long with the slopes psi(v) kept.

    Then r and s are 1 + e f times what the angle gives, theta' gains e f' cot(theta), and the fittings' radius turns
    theta(0) by e f(0) cot(theta0). At equilibrium only the tension T does work in this, N T e f/sin(theta0) per unit v,
    and where pinned ends hold the angle of fibres that would bend in the tangent plane, so does the couple N B1 u1.
    Written out once more after the theory page (sections 3, 5 and 10), without the package's mechanics.
    """

    def __init__(self, muscle: mk.Muscle, **held: float) -> None:
        self.state, self.muscle, braid = solved(muscle, **held), muscle, muscle.braid
        found = recovered(self.state)
        data = {name: values[0] for name, values in found.fields.items()}
        self.R0, self.t0, self.N = braid.radius, braid.angle, braid.fibres
        self.B = braid.fibre.stiffnesses
        self.v, self.theta, self.psi = found.v, data["theta"], data["psi"]
        self.tension, self.u1 = data["fibre_tension"], data["u1"]
        self.kappa = (data["u2"] * np.sin(self.theta) + data["u3"] * np.cos(self.theta)) / math.sin(self.t0)

    def integral(self, values: np.ndarray) -> float:
        return float(CubicSpline(self.v, values).integrate(0.0, self.v[-1]))

    def potential(self, e: float, f: np.ndarray, slope: np.ndarray) -> float:
        R0, t0, psi, chamber = self.R0, self.t0, self.psi, self.muscle.chamber
        turn = f[0] / math.tan(t0) + CubicSpline(self.v, slope / np.tan(self.theta)).antiderivative()(self.v)
        theta = self.theta + e * turn
        rate = -np.sin(psi) / (R0 * math.tan(t0)) + e * slope / np.tan(self.theta)
        hoop, axial = (1.0 + e * f) * np.cos(theta) / math.cos(t0), (1.0 + e * f) * np.sin(theta) / math.sin(t0)
        wind, bend = math.cos(t0) * np.cos(psi) / R0, math.sin(t0) * self.kappa
        natural = float(self.muscle.braid.fibre.natural == "helical") * math.cos(t0) / R0
        strains = (
            math.sin(t0) * rate - math.cos(t0) * np.sin(psi) / R0,
            bend * np.sin(theta) - wind * np.cos(theta) + natural * math.cos(t0),
            bend * np.cos(theta) + wind * np.sin(theta) - natural * math.sin(t0),
        )
        wall = math.pi * chamber.thickness * (chamber.thickness + 2.0 * R0)
        energy = self.N / (2.0 * math.sin(t0)) * sum(B * u**2 for B, u in zip(self.B, strains, strict=True))
        energy = energy + wall * chamber.law.c1 * (hoop**2 + axial**2 + (hoop * axial) ** -2 - 3.0)
        rise = axial * np.cos(psi)
        return self.integral(energy - (self.state.force + self.state.pressure * math.pi * (R0 * hoop) ** 2) * rise)

    def work(self, f: np.ndarray, slope: np.ndarray) -> tuple[float, float, float]:
        """-dPi/de by central differences, what tension and end couples say it is, and the size of its terms."""
        e = 1e-4
        near = [self.potential(k * e, f, slope) for k in (-2, -1, 1, 2)]
        per_length = self.N / math.sin(self.t0) * self.tension * f
        couples = 2.0 * self.N * self.B[0] * self.u1[0] * f[0] / math.tan(self.t0)
        expected = self.integral(per_length) + couples
        return -float(np.dot([1, -8, 8, -1], near)) / (12.0 * e), expected, self.integral(np.abs(per_length))


@pytest.mark.parametrize(
    ("name", "length"),
    [("reference", 0.115), ("reference", 0.055), ("reference", 0.0446), ("stiff", 0.055), ("thin", 0.115),
     ("stiff pinned", 0.115), ("stiff pinned", 0.07), ("straight", 0.1)],
)  # fmt: skip
def test_tension_is_the_price_of_fibre_length(name: str, length: float) -> None:
    """The virial identity for the whole field: fibres longer everywhere, or here more than there."""
    longer = Longer(MUSCLES[name], length=length, pressure=BAR)
    for waves in (0, 1, 2, 4):
        phase = 2.0 * math.pi * waves / longer.v[-1]
        f, slope = 0.3 + np.cos(phase * longer.v), -phase * np.sin(phase * longer.v)
        found, expected, size = longer.work(f, slope)
        assert found == pytest.approx(expected, abs=1e-5 * size)  # that is the cubic spline through the output points


def test_tension_is_the_price_of_fibre_length_solved_anew() -> None:
    """The same with every fibre longer by e, as a muscle of its own: between the same fittings, at a steeper angle."""
    muscle = MUSCLES["straight"]
    angle, f = muscle.braid.angle, muscle.braid.fibre

    def law(l1, l2, l3, c):  # the wall as it was, on the other muscle's stretches and length
        axial = c["stretch"] * l2
        return c["c1"] / c["length"] * (l1**2 + axial**2 + (l1 * axial) ** -2 - 3.0)

    def potential(e: float) -> float:
        steeper = math.acos(math.cos(angle) / (1.0 + e))
        length = (1.0 + e) * math.sin(steeper) / math.sin(angle)
        fibre = mk.Fibre(B1=(1.0 + e) * f.B1, B2=(1.0 + e) * f.B2, B3=(1.0 + e) * f.B3, natural="straight")
        constants = {"c1": muscle.chamber.law.c1, "stretch": length, "length": length}
        braid = attrs.evolve(muscle.braid, angle=steeper, length=length * muscle.braid.length, fibre=fibre)
        wall = attrs.evolve(muscle.chamber, law=mk.CustomLaw(function=law, constants=constants))
        state = solved(attrs.evolve(muscle, braid=braid, chamber=wall), length=0.115, pressure=BAR)
        return float(state.totals[0] * state.problem.unit[0]) - BAR * state.volume

    e = 1e-3
    slope = np.dot([1, -8, 8, -1], [potential(k * e) for k in (-2, -1, 1, 2)]) / (12.0 * e)
    longer = Longer(muscle, length=0.115, pressure=BAR)
    price = longer.integral(longer.N * longer.tension / math.sin(angle))
    assert -slope == pytest.approx(price, rel=3e-7)


def middle(muscle: mk.Muscle, **held: float) -> dict[str, float]:
    """A state at mid-length, with what its parts carry there by formulas written out once more."""
    state = solved(muscle, **held)
    fields = recovered(state).fields
    at = {
        name: float(fields[name][0, MIDDLE])
        for name in ("theta", "r", "u2", "u3", "fibre_tension", "share_mesh", "share_chamber")
    }
    braid, theta = muscle.braid, at["theta"]
    R0, t0, N, (B1, B2, B3) = braid.radius, braid.angle, braid.fibres, braid.fibre.stiffnesses
    sine, cosine = math.sin(t0), math.cos(t0)
    kappa = (at["u2"] * math.sin(theta) + at["u3"] * math.cos(theta)) / sine
    by_u2, by_u3 = B2 * (at["u2"] + cosine**2 / R0), B3 * (at["u3"] - cosine * sine / R0)
    by_theta = by_u2 * (cosine / R0 * math.sin(theta) + sine * kappa * math.cos(theta))
    by_theta += by_u3 * (cosine / R0 * math.cos(theta) - sine * kappa * math.sin(theta))
    hoop, axial = math.cos(theta) / cosine, math.sin(theta) / sine
    wall = math.pi * muscle.chamber.thickness * (muscle.chamber.thickness + 2.0 * R0)
    return at | {
        "force": state.force,
        "load": state.force + math.pi * at["r"] ** 2 * state.pressure,
        "pull": N * at["fibre_tension"] * math.sin(theta),
        "chamber": 2.0 * wall * muscle.chamber.law.c1 * (axial - hoop**-2 * axial**-3),
        "moments": N / sine * by_theta * sine * math.cos(theta),
        "geodesic": 2.0 * N * B1 * cosine / R0 * kappa * sine * math.cos(theta),
        "cylinder": float(cylinder_force(theta, state.pressure, parameters(muscle))),
    }


@pytest.mark.parametrize(("name", "length"), [("reference", 0.115), ("stiff", 0.07), ("stiff", 0.12), ("pinned", 0.1)])
def test_section_equilibrium_at_mid_length(name: str, length: float) -> None:
    at = middle(MUSCLES[name], length=length, pressure=BAR)
    rounding = 1e-14 * at["load"]
    assert at["share_chamber"] * at["load"] == pytest.approx(at["chamber"], abs=rounding)
    mesh = at["pull"] + at["moments"] + at["geodesic"]
    assert at["share_mesh"] * at["load"] == pytest.approx(mesh, abs=rounding)
    assert at["share_mesh"] + at["share_chamber"] == pytest.approx(1.0, abs=1e-14)


@pytest.mark.parametrize(
    ("name", "stretch"), [("reference", 1.35), ("reference", 0.75), ("stiff", 1.2), ("stiff", 0.9)]
)
def test_a_long_muscle_is_a_cylinder_in_the_middle(name: str, stretch: float) -> None:
    """Force at the mid angle in closed form; the tension from the section alone, whose meridian is straight."""
    at = middle(MUSCLES[name].replace("braid.length", 0.4), length=0.4 * stretch, pressure=BAR)
    assert at["force"] == pytest.approx(at["cylinder"], rel=5e-8)
    assert at["pull"] + at["moments"] + at["chamber"] == pytest.approx(at["load"], rel=1e-10)


def test_force_without_stored_energy_is_equation_31() -> None:
    """Stiffness of mesh and wall smaller by 10 each time: so is what the force has beyond Eq. (31) at mid-length."""
    rest = []
    for factor in (1.0, 1e-1, 1e-2, 1e-3):
        muscle = fibres(REFERENCE, factor)
        muscle = muscle.replace("chamber.law.c1", factor * REFERENCE.chamber.law.c1)
        state = solved(muscle, length=0.070, pressure=BAR)
        theta = float(recovered(state).fields["theta"][0, MIDDLE])
        rest.append(state.force - float(virtual_work_force(theta, BAR, parameters(muscle))))
    assert rest[1:] == pytest.approx([factor * rest[0] for factor in (1e-1, 1e-2, 1e-3)], rel=5e-3)


def test_blocked_at_the_magic_angle_nothing_pulls() -> None:
    curve = mk.run(REFERENCE.replace("braid.angle", MAGIC), mk.BlockedForce(pressure="0 to 5 bar", points=6))
    assert curve.verdict == ("stable",) * 6
    assert np.abs(curve.force).max() < 1e-11


@pytest.mark.parametrize("angle", [30, 50])
def test_free_contraction_tends_to_the_magic_angle(angle: float) -> None:
    """Long enough that the fittings do not matter, from either side (Liu and Rahn 2003)."""
    muscle = REFERENCE.replace("braid.angle", f"{angle} deg").replace("braid.length", 0.2)
    distance = []
    for pressure in (10 * BAR, 100 * BAR, 1000 * BAR):
        state = solved(muscle, force=0.0, pressure=pressure)
        distance.append(float(recovered(state).fields["theta"][0, MIDDLE]) - MAGIC)
    assert np.sign(distance).tolist() == [np.sign(math.radians(angle) - MAGIC)] * 3
    assert distance[1:] == pytest.approx([0.1 * distance[0], 0.01 * distance[0]], rel=0.02)
    assert abs(distance[-1]) < 3e-5


def test_order_of_loading_does_not_matter() -> None:
    stretch = {"length": "to 110 mm", "points": 4}
    first = mk.Protocol([mk.Step(pressure=0.0, **stretch), mk.Step(length="hold", pressure="0 to 1 bar", points=4)])
    then = mk.Protocol([
        mk.Step(length=0.085, pressure="0 to 1 bar", points=4), mk.Step(pressure="hold", **stretch),
    ])  # fmt: skip
    one, two = (mk.run(REFERENCE, test) for test in (first, then))
    for name in ("force", "energy", "volume"):
        assert float(one.data[name][-1]) == pytest.approx(float(two.data[name][-1]), rel=2e-13)
    np.testing.assert_allclose(one.data["theta"][-1], two.data["theta"][-1], rtol=0.0, atol=1e-13)


def test_relaxation_forgets_where_it_came_from() -> None:
    """Cases c and d of the paper end in one state."""
    curves = []
    for length in ("115 mm", "70 mm"):
        there = mk.Step(length=f"to {length}", pressure=0.0, points=4)
        up, relaxed = mk.Step(length="hold", pressure="0 to 1 bar", points=4), mk.Step(force=0.0, pressure="hold")
        curves.append(mk.run(REFERENCE, mk.Protocol([there, up, relaxed]), tolerance=5e-5))
    one, two = curves
    assert one.length[-1] == pytest.approx(0.0823022528, rel=1e-9)
    for name in ("length", "volume", "energy"):
        assert float(one.data[name][-1]) == pytest.approx(float(two.data[name][-1]), rel=1e-13)


def test_random_starts_reach_the_same_minimum() -> None:
    bench, held = Bench.of(REFERENCE), Held.of(length=0.100, pressure=BAR)
    problem = bench.problem(24, bench.placement(held))
    expected, random, spread = find(problem, held), np.random.default_rng(0), []
    for _ in range(12):
        u = random.normal(size=24) / (1.0 + np.arange(24))
        while True:
            theta, psi, _ = profile(problem, u, 101)
            if theta.min() > 0.05 and theta.max() < 1.5 and np.abs(psi).max() < 1.5:
                break
            u = 0.9 * u
        state = find(problem, held, attrs.evolve(expected, u=u, loads=np.zeros(2)))
        spread.append(float(np.abs(psi).max()))
        assert state.converged
        assert state.force == pytest.approx(expected.force, rel=1e-13)
        np.testing.assert_allclose(state.u, expected.u, rtol=0.0, atol=1e-13)
    assert max(spread) > 0.7

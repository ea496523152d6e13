"""Muscles and tests as JAX pytrees: numbers are leaves, everything else is static."""

import subprocess
import sys

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import mckibben as mk
from mckibben import spec
from mckibben.model.cylinder import cylinder_force
from mckibben.model.parameters import parameters

pytestmark = pytest.mark.derivatives

PAPER = mk.presets.paper()
LAWS = (
    mk.MooneyRivlin(c1=1e4, c2=1e3),
    mk.NeoHookean(c1=1e4),
    mk.Yeoh(c1=1e4, c2=10.0, c3=1.0),
    mk.Ogden(mu=[1e4, 1e3], alpha=[2.0, -2.0]),
    mk.Gent(mu=1e4, Jm=20.0),
    mk.ArrudaBoyce(mu=1e4, lambda_m=4.0),
    mk.Rubber(E=1e6),
    mk.Rubber(shore=30.0),
    mk.Bellows(axial_stiffness=50.0),
    mk.CustomLaw(function=max, constants={"b": 0.1, "mu": 1e4}),
)
OBJECTS = (
    PAPER,
    mk.presets.reference(),
    PAPER.replace("chamber", None),
    *(PAPER.replace("chamber.law", law) for law in LAWS),
    mk.Isometric(length="115 mm", pressure="0 to 1 bar"),
    mk.Isotonic(force="20 N", pressure=[0.0, 1e5]),
    mk.BlockedForce(pressure="1 bar"),
    mk.FreeContraction(pressure="0 to 1 to 0 bar"),
    mk.Step(length="hold", volume="to 30 mL"),
    mk.Protocol(steps=[mk.Step(length="to 115 mm", pressure=0), mk.Step(length="hold", pressure="0 to 1 bar")]),
)


@pytest.mark.parametrize("value", OBJECTS, ids=lambda value: type(value).__name__)
def test_taken_apart_and_put_together(value: object) -> None:
    leaves, tree = jax.tree.flatten(value)
    again = jax.tree.unflatten(tree, leaves)
    assert again == value
    assert hash(again) == hash(value)
    assert repr(again) == repr(value)
    assert all(isinstance(leaf, float) for leaf in leaves)
    assert leaves == [number for _, _, number in spec.numbers(value)]
    assert hash(tree) == hash(jax.tree.structure(again))


def test_placeholders_are_not_read() -> None:
    """JAX puts anything where numbers belong; what it asks for are numbers that no converter would let through."""
    nothing = jax.tree.map(lambda _: object(), PAPER)
    assert jax.tree.structure(nothing) == jax.tree.structure(PAPER)
    negative = jax.tree.map(lambda number: -number, PAPER)
    assert negative.braid.radius == -PAPER.braid.radius
    assert jax.tree.leaves(jax.tree.map(lambda a, b: a + b, PAPER, negative)) == [0.0] * 10


def test_names() -> None:
    ogden = PAPER.replace("chamber.law", LAWS[3])
    assert [name for name, _, _ in spec.numbers(ogden)] == [
        "braid.radius", "braid.length", "braid.angle", "braid.fibres", "braid.fibre.diameter", "braid.fibre.E",
        "braid.fibre.nu", "chamber.thickness", "chamber.law.mu[0]", "chamber.law.mu[1]", "chamber.law.alpha[0]",
        "chamber.law.alpha[1]",
    ]  # fmt: skip
    test = mk.Protocol(steps=[mk.Step(length="to 115 mm", pressure="0 to 1 bar"), mk.Step(length="hold", force=3.0)])
    assert [name for name, _, _ in spec.numbers(test)] == [
        "steps[0].length", "steps[0].pressure[0]", "steps[0].pressure[1]", "steps[1].force",
    ]  # fmt: skip


def test_a_choice_or_a_number_of_states_is_another_structure() -> None:
    trees = [jax.tree.structure(PAPER), jax.tree.structure(PAPER.replace("ends", "pinned"))]
    ramps = [mk.Isometric(length=0.1, pressure="0 to 1 bar", points=n) for n in (5, 6)]
    lists = mk.Isometric(length=0.1, pressure=[0.0, 1e5])
    trees += [jax.tree.structure(test) for test in (*ramps, lists)]
    assert len(set(trees)) == len(trees)


def test_gradient_of_a_muscle_is_a_muscle() -> None:
    def force(muscle: mk.Muscle) -> jax.Array:
        return cylinder_force(0.8, 1e5, parameters(muscle))

    slope = jax.jit(jax.grad(force))(PAPER)
    assert isinstance(slope, mk.Muscle)
    assert slope.ends == "clamped"
    assert "radius=Array" in repr(slope)
    by_angle = jax.grad(lambda angle: force(PAPER.replace("braid.angle", angle)))(PAPER.braid.angle)
    assert float(slope.braid.angle) == pytest.approx(float(by_angle), rel=1e-12)
    assert float(slope.braid.fibres) != 0.0
    several = jax.tree.map(lambda number: jnp.array([number, 1.1 * number]), PAPER)
    forces = jax.vmap(force)(several)
    assert float(forces[0]) == pytest.approx(float(force(PAPER)), rel=1e-12)


def test_specification_alone_loads_no_jax_and_jax_first_registers() -> None:
    alone = "import sys, mckibben as mk; mk.presets.paper(); assert 'jax' not in sys.modules"
    first = "import jax, mckibben as mk; assert len(jax.tree.leaves(mk.presets.paper())) == 10"
    for code in (alone, first):
        assert subprocess.run([sys.executable, "-c", code], check=False, timeout=120).returncode == 0


FIRST_CALL = """
import jax, mckibben as mk
muscle, test = mk.presets.paper(), mk.Isometric(length=0.11, pressure=[1e5])
def force(angle):
    return mk.response(muscle.replace("braid.angle", angle), test)["force"][-1]
print(float({call}))
"""
STEP = 1e-3
VALUE = np.array([0.0, 0.0, 1.0, 0.0, 0.0])
# Central differences, exact for polynomials of degree 4 and 5.
SLOPE, BEND = np.array([1, -8, 0, 8, -1]) / (12.0 * STEP), np.array([-1, 16, -30, 16, -1]) / (12.0 * STEP**2)
CALLS = {  # what is called first, and the weights of forces at angles a step apart whose sum it is
    "jit": ("jax.jit(force)(0.65)", VALUE),
    "vmap": ("jax.vmap(force)(jax.numpy.array([0.64, 0.65]))[1]", VALUE),
    "grad": ("jax.grad(force)(0.65)", SLOPE),
    "jvp": ("jax.jvp(force, (0.65,), (1.0,))[1]", SLOPE),
    "jacfwd": ("jax.jacfwd(force)(0.65)", SLOPE),
    "hessian": ("jax.hessian(force)(0.65)", BEND),
}


@pytest.mark.parametrize("name", CALLS)
def test_a_transformation_as_the_first_call_of_a_process(name: str) -> None:
    """In 64 bits from the first trace on: in JAX's own 32 the call fails, or is right to 1e-7 at best."""
    call, weights = CALLS[name]
    code = FIRST_CALL.format(call=call)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    test = mk.Isometric(length=0.11, pressure=[1e5])
    angles = 0.65 + STEP * np.arange(-2, 3)
    forces = [float(mk.response(PAPER.replace("braid.angle", float(a)), test)["force"][-1]) for a in angles]
    assert float(done.stdout) == pytest.approx(float(weights @ forces), rel=2e-12 if weights is VALUE else 1e-8)

"""`response()`: the results of `run` as a function for JAX."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import mckibben as mk
from mckibben import spec

pytestmark = pytest.mark.derivatives

PAPER = mk.presets.paper()
TEST = mk.Isometric(length="110 mm", pressure=[2e4, 1e5])
compiled = jax.jit(mk.response)


def force(numbers: Any) -> Any:
    """Force at the last state as a function of braid angle, radius and pressure."""
    angle, radius, pressure = numbers
    muscle = PAPER.replace("braid.angle", angle).replace("braid.radius", radius)
    return mk.response(muscle, mk.Isometric(length=0.110, pressure=jnp.stack([2e4, pressure])))["force"][-1]


AT = jnp.array([PAPER.braid.angle, PAPER.braid.radius, 1e5])
gradient = jax.jit(jax.grad(force))


def test_it_is_what_run_gives() -> None:
    curve, found = mk.run(PAPER, TEST), mk.response(PAPER, TEST)
    for name in ("force", "length", "pressure", "volume", "contraction", "energy", "energy_twist", "energy_chamber"):
        np.testing.assert_allclose(found[name], curve.data[name], rtol=1e-9, err_msg=name)
    np.testing.assert_allclose(found["largest_radius"], curve.data["r"].max("v"), rtol=1e-6)
    at_nodes = curve.data["fibre_tension"].max("v").values
    assert (found["peak_fibre_tension"] >= at_nodes).all()
    np.testing.assert_allclose(found["peak_fibre_tension"], at_nodes, rtol=1e-3)


@pytest.mark.parametrize(
    "test",
    [
        TEST,
        mk.FreeContraction(pressure=[2e4, 1e5]),
        mk.Step(length="100 mm", volume=[38.000e-6, 38.005e-6]),
        mk.Step(force="10 N", volume=[3.5e-5, 3.6e-5]),
        mk.Step(length=[0.095, 0.1], force="10 N"),
        mk.Protocol(
            steps=[
                mk.Step(length="to 115 mm", pressure="0.1 bar", points=3),
                mk.Step(length="hold", pressure="to 1 bar", points=3),
                mk.Step(pressure="hold", force="to 5 N", points=4),
            ]
        ),
    ],
    ids=["isometric", "free", "length and volume", "force and volume", "length and force", "protocol"],
)
def test_compiled_and_searched_states_are_the_same(test: Any) -> None:
    """The quick way from rest, which `jit` and `vmap` take, and the robust search."""
    muscle = mk.presets.reference()
    quick, searched = compiled(muscle, test), mk.response(muscle, test)
    for name, values in searched.items():
        assert np.isfinite(values).all(), name
        np.testing.assert_allclose(quick[name], values, rtol=2e-8, atol=1e-12, err_msg=name)


def test_transformations_agree() -> None:
    exact = np.asarray(jax.grad(force)(AT))
    np.testing.assert_allclose(gradient(AT), exact, rtol=1e-8)
    np.testing.assert_allclose(jax.jit(jax.jacfwd(force))(AT), exact, rtol=1e-8)
    many = jax.jit(jax.vmap(force))(jnp.stack([AT, 1.01 * AT]))
    assert float(many[0]) == pytest.approx(float(force(AT)), rel=1e-9)
    assert float(many[1]) == pytest.approx(float(force(1.01 * AT)), rel=1e-9)


def test_second_derivatives() -> None:
    """Symmetric, and central differences of the first; by pressure and angle, whose results are far from linear."""
    hessian = np.asarray(jax.jit(jax.hessian(force))(AT))
    unit = np.outer(AT, AT)
    np.testing.assert_allclose(hessian * unit, hessian.T * unit, rtol=1e-8, atol=1e-9)
    for k in range(3):
        near = [np.asarray(gradient(AT * (1.0 + sign * 1e-4 * np.eye(3)[k]))) for sign in (-1, 1)]
        slope = (near[1] - near[0]) / (2e-4 * AT[k])
        np.testing.assert_allclose(
            hessian[k] * AT, slope * AT, rtol=1e-5, atol=1e-7 * np.abs(hessian * unit).max() / AT[k]
        )


def test_whole_curve_by_every_number() -> None:
    jacobian = jax.jacrev(lambda muscle: mk.response(muscle, TEST)["force"])(PAPER)
    assert isinstance(jacobian, mk.Muscle)
    for k, state in enumerate((0, 1)):
        found = mk.sensitivity(PAPER, TEST, of="force", by=("braid", "chamber"), state=state)
        columns = [float(leaf[k]) for leaf in jax.tree.leaves(jacobian)]
        np.testing.assert_allclose(found.absolute["force"], columns, rtol=1e-9)


@pytest.mark.parametrize("by_jit", [False, True])
def test_a_state_that_is_not_there_spoils_no_other(by_jit: bool) -> None:
    """Beyond full extension: NaN, with derivatives that are not finite; those of the first state are as without it."""

    def forces(angle: Any, lengths: Any = (0.105, 0.145)) -> Any:
        test = mk.Isobaric(pressure="1 bar", length=list(lengths))
        return mk.response(PAPER.replace("braid.angle", angle), test)["force"]

    def all_of_it(angle: Any) -> Any:
        return forces(angle), jax.jacrev(forces)(angle), jax.jacfwd(forces)(angle)

    values, slopes, forward = (jax.jit(all_of_it) if by_jit else all_of_it)(PAPER.braid.angle)
    assert np.isfinite(values[0])
    assert np.isnan(values[1])
    alone = jax.grad(lambda angle: forces(angle, (0.105, 0.106))[0])(PAPER.braid.angle)
    assert float(slopes[0]) == pytest.approx(float(alone), rel=1e-8)
    assert not np.isfinite(slopes[1])
    assert not np.isfinite(forward[1])


def test_a_wall_that_rolls_up_is_no_state() -> None:
    """Random muscle 19 of validation/gradients.py: followed through a bulge, it would be -373 and -368 mm long."""
    fibre = mk.Fibre(diameter=0.4043166400424732e-3, E=632579644.3477709, nu=0.4)
    braid = mk.Braid(
        radius=0.02253413062945334, length=0.16891414852749567, angle=0.41254084539713354, fibres=8, fibre=fibre
    )
    law = mk.MooneyRivlin(c1=26100.00183993157, c2=4610.580069838202)
    muscle = mk.Muscle(braid=braid, chamber=mk.Chamber(thickness=0.6313748044171586e-3, law=law), ends="pinned")
    test = mk.Isotonic(force=-609.706979862, pressure=[265740.917929, 531481.835858])
    assert np.isnan(mk.response(muscle, test)["length"]).all()
    at_rest = mk.response(muscle, mk.Isotonic(force=0.0, pressure=[1e4, 2e4]))
    assert (at_rest["length"] > 0.0).all()


def test_tests_without_derivatives_are_refused() -> None:
    with pytest.raises(mk.SpecError, match=r"step\.along"):
        mk.response(PAPER, mk.Step(length="100 mm to 90 mm", pressure="1 bar", along="branch"))


def test_gas_sealed_in_has_derivatives_like_all_else() -> None:
    """By the pressure to which it was filled and by the length, against central differences; also inside `jit`."""

    def pressure(filled: Any, length: Any) -> Any:
        fill = mk.Step(length="85 mm", pressure=filled)
        return mk.response(PAPER, mk.Protocol([fill, mk.Step(length=length, gas="adiabatic")]))["pressure"][-1]

    at, steps = (1e5, 0.100), (1e2, 1e-5)
    found = jax.grad(pressure, argnums=(0, 1))(*at)
    traced = jax.jit(jax.grad(pressure, argnums=(0, 1)))(*at)
    for k, step in enumerate(steps):
        near = [pressure(*(x + side * step * (i == k) for i, x in enumerate(at))) for side in (-1, 1)]
        assert float(found[k]) == pytest.approx(float(near[1] - near[0]) / (2.0 * step), rel=1e-6)
        assert float(traced[k]) == pytest.approx(float(found[k]), rel=1e-7)
    test = mk.Protocol([mk.Step(length="85 mm", pressure=1e5), mk.Step(length=0.1, gas="adiabatic")])
    table = mk.sensitivity(PAPER, test, of="pressure").absolute
    assert table["pressure"]["test.steps[0].pressure"] == pytest.approx(float(found[0]), rel=1e-9)


def test_a_muscle_of_arrays_is_a_batch() -> None:
    """`vmap` over the muscle itself."""
    angles = np.deg2rad([36.0, 37.0, 38.0])
    several = jax.tree.map(lambda number: jnp.full(3, number), PAPER)
    leaves, tree = jax.tree.flatten(several)
    place = [name for name, _, _ in spec.numbers(PAPER)].index("braid.angle")
    leaves[place] = jnp.asarray(angles)
    found = jax.jit(jax.vmap(lambda muscle: mk.response(muscle, TEST)["force"]))(jax.tree.unflatten(tree, leaves))
    for angle, row in zip(angles, found, strict=True):
        alone = mk.response(PAPER.replace("braid.angle", float(angle)), TEST)["force"]
        np.testing.assert_allclose(row, alone, rtol=1e-8)

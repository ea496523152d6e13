"""Executables run by jaxlib alone against the same ones run by JAX."""

import pickle
from typing import Any, NamedTuple

import numpy as np
import pytest

from mckibben import native
from mckibben.lazy import Array, jax, jnp


class Found(NamedTuple):
    """Results of several kinds."""

    factor: Any
    parts: tuple[Any, ...]
    good: Any


def worked(A: Array, shift: Array, unused: Array) -> Found:
    factor = jnp.linalg.cholesky(A)
    return Found(factor, (shift + 1, {"trace": jnp.trace(A), "none": None}), jnp.isfinite(factor).all())


def compiled(*arguments: Any) -> Any:
    forms = [jax.ShapeDtypeStruct(np.shape(x), np.asarray(x).dtype) for x in arguments]
    return jax.jit(worked, keep_unused=True).lower(*forms).compile()


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_gives_what_jax_gives(sign: float) -> None:
    """LAPACK, whole numbers, yes or no, numbers without dimensions, and arguments in any layout."""
    A = sign * np.array([[4.0, 1.0, 0.5], [1.0, 3.0, 0.0], [0.5, 0.0, 2.0]])
    whole = compiled(A, 3, np.zeros((2, 0)))
    alone = native.Executable(*pickle.loads(pickle.dumps(native.serialize(whole))))
    for matrix in (A, np.asfortranarray(A), np.repeat(A, 2, axis=1)[:, ::2], jnp.asarray(A)):
        mine, theirs = alone(matrix, 3, np.zeros((2, 0))), whole(np.asarray(A), 3, np.zeros((2, 0)))
        assert jax.tree.structure(mine) == jax.tree.structure(theirs)
        assert isinstance(mine, Found)
        for one, other in zip(jax.tree.leaves(mine), jax.tree.leaves(theirs), strict=True):
            assert type(one) is np.ndarray
            assert one.dtype == other.dtype
            assert np.array_equal(one, other, equal_nan=one.dtype.kind == "f")
    assert bool(mine.good) is (sign > 0.0)


def test_what_does_not_fit_is_refused() -> None:
    """Other shapes or numbers of arguments never end in numbers."""
    alone = native.Executable(*native.serialize(compiled(np.eye(3), 3, 1.0)))
    for arguments in ((np.eye(2), 3, 1.0), (np.eye(3), 3), (np.eye(3), 3, 1.0, 1.0), (np.eye(3), 3.5, np.ones(7))):
        with pytest.raises((TypeError, ValueError, RuntimeError)):
            alone(*arguments)


def test_where_jax_is_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only where it could run on something else than the processor."""
    asked: list[bool] = []
    monkeypatch.setattr(native, "imported", lambda: False)
    monkeypatch.setattr(jax, "default_backend", lambda: asked.append(True) or "gpu")
    for platforms, plugins, alone in (("cpu", True, True), ("", False, True), ("", True, False), ("cuda", True, False)):
        monkeypatch.setenv("JAX_PLATFORMS", platforms)
        monkeypatch.setattr(native, "find_spec", lambda name, there=plugins: "here" if there else None)
        assert native.alone() is alone
    assert len(asked) == 2

"""Linear algebra on one thread while states are sought, and as it was before."""

import pytest
from threadpoolctl import threadpool_info, threadpool_limits

import mckibben as mk
from mckibben.solver.threads import one_thread


def threads() -> set[int]:
    """Threads of each linear algebra library that is loaded."""
    return {one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"}


pytestmark = [
    pytest.mark.solver,
    pytest.mark.skipif(not threads(), reason="this NumPy's linear algebra has no number of threads to set"),
]


def test_a_test_runs_on_one_thread_and_leaves_the_setting_as_it_was() -> None:
    seen: list[set[int]] = []
    mk.run(mk.presets.paper(), mk.Isometric(length="110 mm", pressure="1 bar", points=1))  # loads every library
    with threadpool_limits(2, user_api="blas"):
        assert threads() == {2}
        curve = mk.run(
            mk.presets.paper(),
            mk.Isometric(length="110 mm", pressure="0 to 1 bar", points=2),
            watch=lambda done, total: seen.append(threads()),
        )
        assert threads() == {2}
    assert curve.status == "complete"
    assert seen
    assert all(one == {1} for one in seen)


def test_one_within_the_other() -> None:
    with threadpool_limits(2, user_api="blas"):
        with one_thread():
            with one_thread():
                assert threads() == {1}
            assert threads() == {1}
        assert threads() == {2}


def test_an_error_inside_undoes_it_too() -> None:
    with threadpool_limits(2, user_api="blas"):
        with pytest.raises(ValueError, match="meant"), one_thread():
            raise ValueError("meant")
        assert threads() == {2}

"""Kernels give what JAX gives; a later process compiles nothing and gets the same bits; damage is survived."""

import json
import os
import pickle
import subprocess
import sys
import threading
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import mckibben as mk
from mckibben.compiled import kernel as kernels
from mckibben.compiled import options, recent
from mckibben.compiled.executable import Executable, compiled, loaded
from mckibben.compiled.folder import SUFFIX, private
from mckibben.compiled.kernel import Kernel, keeping, kernel
from mckibben.compiled.options import OPTIONS
from mckibben.compiled.rows import filled
from mckibben.solver.bench import Bench
from mckibben.solver.find import find
from mckibben.solver.held import Held
from mckibben.solver.problem import balance, curvature, setting

pytestmark = pytest.mark.compiled

OWN = 5
"""Unknowns that no other test has compiled before."""
CASE = """
import json, sys
import mckibben as mk
from mckibben.compiled import executable, kernel
pressure, ends = sys.argv[1:]
counts = {"compiled": 0}
compiling = kernel.Kernel._compile
def counted(*args):
    counts["compiled"] += 1
    return compiling(*args)
kernel.Kernel._compile = counted
muscle = mk.presets.paper().replace("ends", ends)
curve = mk.run(muscle, mk.Isometric(length="115 mm", pressure=f"0 to {pressure}", points=3), tolerance=1e-4)
heavy = {"xarray", "pandas", "pint", "scipy.interpolate", "scipy.optimize", "matplotlib"} & sys.modules.keys()
assert not heavy, heavy
print(json.dumps(counts | {"force": [x.hex() for x in curve.force.tolist()], "verdict": curve.verdict}))
"""


def case(place: Path | str, pressure: str = "1 bar", ends: str = "pinned", **more: str) -> dict[str, Any]:
    """Count of compilations and forces of a short test in a process of its own, which must not say anything."""
    environment = os.environ | {"MCKIBBEN_CACHE": str(place)} | more
    done = subprocess.run([sys.executable, "-c", CASE, pressure, ends], capture_output=True, text=True, env=environment)
    assert (done.returncode, done.stderr) == (0, "")
    return json.loads(done.stdout)


def test_a_second_process_compiles_nothing(tmp_path: Path) -> None:
    first, again, other = case(tmp_path), case(tmp_path), case(tmp_path, "0.9 bar")
    assert first["compiled"] > 0
    assert (again["compiled"], other["compiled"]) == (0, 0)
    assert again["force"] == first["force"] != other["force"]
    assert set(first["verdict"]) == set(other["verdict"]) == {"stable"}
    files = sorted(tmp_path.iterdir(), key=lambda file: file.stat().st_size)
    assert {file.suffix for file in files} == {SUFFIX}  # nothing half-written
    names = {file.name.partition("-")[0] for file in files}
    assert names == {"crowdings_at", "setting", "follow", "balance", "read_many"}  # nothing of the search, the dearest
    contents = [file.read_bytes() for file in files[:4]]
    short, changed, _, other = contents
    damaged = (short[:-1], changed[:999] + bytes([changed[999] ^ 1]) + changed[1000:], b"", other[::-1])
    for file, content in zip(files, damaged, strict=False):
        file.write_bytes(content)
    mended = case(tmp_path)
    assert mended["compiled"] == 4
    assert mended["force"] == first["force"]
    for file, content in zip(files, contents, strict=False):
        assert abs(file.stat().st_size - len(content)) < 500
    assert case(tmp_path)["compiled"] == 0


def test_who_wants_nothing_kept(tmp_path: Path) -> None:
    """And who has JAX keep what it compiles, as it reads back what cannot be written again."""
    off = case("off", JAX_COMPILATION_CACHE_DIR=str(tmp_path / "off"))
    assert off["compiled"] > 0
    assert not list(tmp_path.rglob(f"*{SUFFIX}"))
    theirs = {"JAX_COMPILATION_CACHE_DIR": str(tmp_path), "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0"}
    kept_there, again, anew = case("", **theirs), case("", **theirs), case(tmp_path / "other", **theirs)
    assert kept_there["compiled"] == anew["compiled"] > 0
    assert again["compiled"] == 0
    assert case(tmp_path / "other", **theirs)["compiled"] == 0
    assert off["force"] == kept_there["force"] == again["force"] == anew["force"]


class Found(NamedTuple):
    """Results of several kinds."""

    factor: Any
    parts: tuple[Any, ...]
    good: Any


def worked(power: int, A: Any, shift: Any, unused: Any) -> Found:
    factor = jnp.linalg.cholesky(A)
    return Found(factor**power, (shift + 1, {"trace": jnp.trace(A), "none": None}), jnp.isfinite(factor).all())


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_gives_what_jax_gives(sign: float) -> None:
    """LAPACK, whole numbers, yes or no, numbers without dimensions, and arguments in any layout."""
    A = sign * np.array([[4.0, 1.0, 0.5], [1.0, 3.0, 0.0], [0.5, 0.0, 2.0]])
    mine, theirs = kernel(worked), jax.jit(partial(worked, 2))(A, 3, np.zeros((2, 0)))
    for matrix in (A, np.asfortranarray(A), np.repeat(A, 2, axis=1)[:, ::2], jnp.asarray(A)):
        for found in (mine(2, matrix, 3, np.zeros((2, 0))), carried(2, matrix, 3, np.zeros((2, 0)))):
            assert jax.tree.structure(found) == jax.tree.structure(theirs)
            assert isinstance(found, Found)
            for one, other in zip(jax.tree.leaves(found), jax.tree.leaves(theirs), strict=True):
                assert type(one) is np.ndarray
                assert one.dtype == other.dtype
                np.testing.assert_allclose(one, other, rtol=1e-15, equal_nan=True)
    assert bool(mine(2, A, 3, np.zeros((2, 0))).good) is (sign > 0.0)
    assert mine._cache_size() == 1


def executable(*arrays: Any) -> Executable:
    """As another process gets it."""
    forms = [(np.shape(x), np.asarray(x).dtype) for x in arrays]
    return loaded(*pickle.loads(pickle.dumps(compiled(lambda leaves: worked(2, *leaves), "w", forms, {}).portable())))


def carried(power: int, *arrays: Any) -> Any:
    return executable(*arrays)(arrays)


def test_what_does_not_fit_is_refused() -> None:
    """Other shapes or numbers of arguments never end in numbers."""
    alone = executable(np.eye(3), 3, 1.0)
    for arguments in ((np.eye(2), 3, 1.0), (np.eye(3), 3), (np.eye(3), 3, 1.0, 1.0), (np.eye(3), 3.5, np.ones(7))):
        with pytest.raises((TypeError, ValueError, RuntimeError)):
            alone(arguments)


def test_static_arguments_by_position_and_name(tmp_path: Path) -> None:
    """Each value is compiled apart, as by JAX, and numbers are passed under their names too."""

    @partial(kernel, static_argnums=(0, 2), static_argnames=("turn", "word"))
    def mixed(power: int, x: Any, more: int, *, turn: int = 1, word: str = "", y: Any = 0.0) -> Any:
        return {"sum": x**power + more + turn + len(word) + y}

    with keeping(tmp_path):
        for args, named, sum in (
            ((2, 3.0, 1), {}, 11.0), ((1, 3.0, 1), {}, 5.0), ((2, 3.0, 2), {"turn": 5, "word": "of"}, 18.0),
            ((2, 3.0, 2), {"word": "of", "turn": 4, "y": 0.5}, 17.5),
        ):  # fmt: skip
            assert mixed(*args, **named)["sum"] == sum
            assert jax.jit(lambda x, args=args, named=named: mixed(args[0], x, args[2], **named)["sum"])(3.0) == sum
        count = mixed._cache_size()
        mixed.prepare(2, 3.0, 1)
        assert mixed(2, np.float64(2.0), 1)["sum"] == 6.0
        assert mixed._cache_size() == count


def test_rows_are_filled_by_a_function_traced_once() -> None:
    """Two rows at a time, as far as is asked."""
    traced = []

    @jax.jit
    def squares(x: Any, count: Any) -> Any:
        def at(k: Any) -> Any:
            traced.append(k)
            some = jax.lax.dynamic_slice_in_dim(x, 2 * k, 2)
            return {"square": some**2, "positive": some > 0.0}

        return filled(at, count, len(x))

    found = squares(np.arange(8.0), np.array(3))
    assert found["square"].tolist() == [0.0, 1.0, 4.0, 9.0, 16.0, 25.0, 0.0, 0.0]
    assert found["positive"].tolist() == [False, *[True] * 5, False, False]
    assert len(traced) == 1


@pytest.fixture
def forgetful() -> Iterator[None]:
    """Nothing is kept, so that what an earlier run left on the disk does not count."""
    with keeping(None):
        yield


@pytest.mark.usefixtures("forgetful")
def test_ahead_and_at_once() -> None:
    """Many threads ask for the same, one compiles it. An error in a kernel is the caller's, and no lasting one."""
    made, broken = [], [True]

    @kernel
    def slow(power: int, x: Any) -> Any:
        made.append(power)
        if power == 3 and broken[0]:
            raise ArithmeticError("broken")
        return setting_of(power, x) * eager(2, 1.0)  # one kernel called with a plain number while another is traced

    @kernel
    def setting_of(power: int, x: Any) -> Any:
        return x**power

    @kernel
    def eager(power: int, x: Any) -> Any:
        return x + power

    slow.prepare(2, 1.0)
    eager.prepare(2, 1.0)
    found: list[Any] = []
    threads = [threading.Thread(target=lambda: found.append(float(slow(2, 3.0)))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert (found, made) == ([27.0] * 4, [2])
    slow.prepare(3, 1.0)
    with pytest.raises(ArithmeticError):
        slow(3, 1.0)
    broken[0] = False
    assert slow(3, 2.0) == 24.0


@pytest.fixture
def sought(tmp_path: Path) -> tuple[Path, Held, Bench]:
    """With nothing in memory."""
    for function in (setting, balance, curvature):
        function.clear_cache()
    return tmp_path / "kernels", Held.of(length=0.09, pressure=5e4), Bench.of(mk.presets.reference())


def test_kept_and_plain_agree(sought: tuple[Path, Held, Bench]) -> None:
    """Least optimised and as usual: to rounding. Within another transformation a kernel is part of that."""
    place, held, bench = sought
    with keeping(None, OPTIONS):
        plain = find(bench.problem(OWN, 2.0), held)
    with keeping(place):
        kept_there = find(bench.problem(OWN, 2.0), held)
    assert list(place.iterdir())
    assert kept_there.converged
    assert kept_there.force == pytest.approx(plain.force, rel=1e-11)
    problem, us = plain.problem, np.stack([plain.u, 0.5 * plain.u])
    with keeping(place):
        both = jax.vmap(lambda u: balance(problem.basis, problem.p, problem.b, u).totals)(us)
    one = balance(problem.basis, problem.p, problem.b, us[1])
    assert np.asarray(both[1]) == pytest.approx(np.asarray(one.totals), rel=1e-12)


def test_an_executable_of_something_else_is_dropped(
    sought: tuple[Path, Held, Bench], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A whole file with the wrong content, which nothing but a hand can make; first under a wrong name."""
    place, held, bench = sought
    with keeping(place):
        right = find(bench.problem(OWN, 2.0), held)
        file, other = next(place.glob("setting-*")), next(place.glob("balance-*"))
        size = file.stat().st_size
        for wrong in ("renamed", "forged", "exchanged"):
            if wrong == "renamed":
                file.write_bytes(other.read_bytes())
            elif wrong == "forged":
                kernels.kept.write(file, kernels.kept.read(other))
            else:  # both under each other's name, and sealed as such
                contents = kernels.kept.read(file), kernels.kept.read(other)
                kernels.kept.write(file, contents[1])
                kernels.kept.write(other, contents[0])
                balance.clear_cache()
            setting.clear_cache()
            assert find(bench.problem(OWN, 2.0), held).force == pytest.approx(right.force, rel=1e-11)
            assert abs(file.stat().st_size - size) < 500  # made anew


def test_what_cannot_be_serialised_or_written_is_used(
    sought: tuple[Path, Held, Bench], monkeypatch: pytest.MonkeyPatch
) -> None:
    place, held, bench = sought

    def refuse(*_: Any) -> Any:
        raise NotImplementedError

    monkeypatch.setattr(Executable, "portable", refuse)
    with keeping(place):
        assert find(bench.problem(OWN, 2.0), held).converged
    assert not list(place.iterdir())


def test_a_users_law_is_not_kept(sought: tuple[Path, Held, Bench]) -> None:
    """Its name says nothing of what it does."""
    place, held, _ = sought
    law = mk.CustomLaw(function=lambda a, b, c, _: 5e4 * (a**2 + b**2 + c**2 - 3.0))
    custom = Bench.of(mk.presets.reference().replace("chamber.law", law))
    with keeping(place):
        found = find(custom.problem(OWN, 2.0), held)
    assert found.converged
    assert not list(place.iterdir())


def test_a_compiler_with_other_options(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is asked for those that it has; none of the processor's on another device."""
    taken = options.understood(OPTIONS | {"xla_no_such_option": 1})
    assert taken == OPTIONS
    monkeypatch.setattr(jax, "default_backend", lambda: "gpu")
    options._understood.cache_clear()
    assert options.understood(OPTIONS) == {}
    options._understood.cache_clear()


@pytest.mark.parametrize("text", ["", "quick"])
def test_how_scripts_compile(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MCKIBBEN_COMPILE", text)
    assert options.usual() == (options.QUICK if text else OPTIONS)


def test_a_kernel_is_known_by_its_name() -> None:
    assert pickle.loads(pickle.dumps(balance)) is balance
    assert isinstance(balance, Kernel)


@pytest.mark.skipif(os.name != "posix", reason="other systems have no such permissions")
def test_a_folder_that_others_can_write_to_is_not_used(sought: tuple[Path, Held, Bench]) -> None:
    place, held, bench = sought
    place.mkdir()
    place.chmod(0o777)
    with keeping(place):
        assert find(bench.problem(OWN, 2.0), held).converged
    assert not list(place.iterdir())
    assert private(place.parent / "new")
    assert (place.parent / "new").stat().st_mode & 0o777 == 0o700


def test_executables_in_memory_are_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    """The least recently used goes, and comes back when it is called."""
    monkeypatch.setattr(recent, "_entries", [])
    monkeypatch.setattr(recent, "LIMIT", 2)
    double = kernel(lambda factor, x: factor * x)
    made: list[tuple[int, ...]] = []
    make = Kernel._made

    def counted(self: Kernel, kind: Any) -> Any:
        made.append(kind.static)
        return make(self, kind)

    monkeypatch.setattr(Kernel, "_made", counted)
    for factor in (2, 3, 2, 4, 2, 3):
        assert double(factor, np.ones(2)).tolist() == [factor, factor]
        assert double._cache_size() <= 2
    assert made == [(2,), (3,), (4,), (3,)]
    double.clear_cache()
    assert double._cache_size() == 0
    assert recent._entries == []

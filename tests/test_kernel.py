"""Compiled functions kept on the disk: a later process compiles nothing, gets the same bits and survives damage."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import attrs
import jax
import numpy as np
import pytest

import mckibben as mk
from mckibben import kept
from mckibben.discretise.line import Line
from mckibben.experiment import Bench
from mckibben.kernel import QUICK, keeping
from mckibben.model.chamber import mooney_rivlin
from mckibben.solver.direct import find
from mckibben.solver.equilibrium import Held
from mckibben.solver.problem import Space, evaluate

OWN = 5
"""Unknowns that no other test has compiled before."""
CASE = """
import json, sys
from pathlib import Path
import numpy as np
import mckibben as mk
from mckibben import cache, kernel
place, pressure, ends = Path(sys.argv[1]), sys.argv[2], sys.argv[3]
cache.folder = lambda: place
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
slow = bool({"jax", "scipy.linalg"} & sys.modules.keys())
force = [x.hex() for x in curve.force.tolist()]
print(json.dumps(counts | {"jax": slow, "force": force, "verdict": curve.verdict}))
"""


def case(place: Path, pressure: str = "1 bar", ends: str = "pinned", **more: str) -> dict[str, Any]:
    """Counts of compilations and forces of a short test in a process of its own, which must not say anything."""
    environment = {name: value for name, value in os.environ.items() if "CACHE" not in name} | more
    call = [sys.executable, "-c", CASE, str(place), pressure, ends]
    done = subprocess.run(call, capture_output=True, text=True, env=environment)
    assert (done.returncode, done.stderr) == (0, "")
    return json.loads(done.stdout)


def test_a_second_process_compiles_nothing_and_needs_no_jax(tmp_path: Path) -> None:
    first, again, other = case(tmp_path), case(tmp_path), case(tmp_path, "0.9 bar")
    assert first["jax"]
    assert first["compiled"] > 0
    assert (again["jax"], again["compiled"]) == (other["jax"], other["compiled"]) == (False, 0)
    assert again["force"] == first["force"] != other["force"]
    assert set(first["verdict"]) == set(other["verdict"]) == {"stable"}
    files = sorted((tmp_path / "kernels").iterdir(), key=lambda file: file.stat().st_size)
    assert {file.suffix for file in files} == {kept.SUFFIX}  # nothing half-written
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
    assert not case(tmp_path)["jax"]


def test_who_wants_nothing_kept(tmp_path: Path) -> None:
    off = case(tmp_path, MCKIBBEN_CACHE="off")
    assert off["jax"]
    assert off["compiled"] == 0  # but by JAX
    assert not list(tmp_path.iterdir())
    kept_there = case(tmp_path)
    assert kept_there["compiled"] > 0
    mine, theirs = ([float.fromhex(x) for x in one["force"]] for one in (kept_there, off))
    assert mine == pytest.approx(theirs, rel=1e-11)


@pytest.fixture
def sought(tmp_path: Path) -> tuple[Path, Held, Bench]:
    return tmp_path / "kernels", Held.of(length=0.09, pressure=5e4), Bench.of(mk.presets.reference())


def test_kept_and_plain_agree(sought: tuple[Path, Held, Bench]) -> None:
    """Least optimised and as usual: to rounding. Within another transformation a kernel is part of that."""
    place, held, bench = sought
    plain = find(bench.problem(OWN, 2.0), held)
    with keeping(place):
        kept_there = find(bench.problem(OWN, 2.0), held)
    assert kept_there.converged
    assert kept_there.force == pytest.approx(plain.force, rel=1e-11)
    problem, us = plain.problem, np.stack([plain.u, 0.5 * plain.u])
    with keeping(place):
        both = jax.vmap(lambda u: evaluate(problem.space, problem.p, problem.b, u).totals)(us)
    one = evaluate(problem.space, problem.p, problem.b, us[1])
    assert np.asarray(both[1]) == pytest.approx(np.asarray(one.totals), rel=1e-12)


def test_an_executable_of_something_else_is_dropped(sought: tuple[Path, Held, Bench]) -> None:
    """A whole file with the wrong content, which nothing but a hand can make."""
    place, held, bench = sought
    with keeping(place):
        right = find(bench.problem(OWN, 2.0), held)
    wrong = next(place.glob("setting-*"))
    wrong.write_bytes(next(place.glob("evaluate-*")).read_bytes())
    from mckibben.solver.problem import setting

    setting.clear_cache()
    with keeping(place):
        assert find(bench.problem(OWN, 2.0), held).force == pytest.approx(right.force, rel=1e-11)
    assert not wrong.exists()


def test_a_users_law_is_not_kept(sought: tuple[Path, Held, Bench]) -> None:
    """Its name says nothing of what it does."""
    place, held, _ = sought
    law = mk.CustomLaw(function=lambda *state: mooney_rivlin(*state[:3], (5e4, 0.0)))
    custom = Bench.of(mk.presets.reference().replace("chamber.law", law))
    with pytest.raises(kept.UnkeepableError):
        kept.describe(Space(Line(OWN), custom.law))
    with keeping(place):
        found = find(custom.problem(OWN, 2.0), held)
    assert found.converged
    assert not list(place.iterdir())


def test_what_a_key_covers(monkeypatch: pytest.MonkeyPatch) -> None:
    space = Space(Line(OWN), mooney_rivlin)
    shapes = ("tree", (((3,), np.dtype(float)),))
    keys = {
        kept.key("name", space, shapes, QUICK), kept.key("other", space, shapes, QUICK),
        kept.key("name", attrs.evolve(space, basis=Line(OWN, "pinned")), shapes, QUICK),
        kept.key("name", space, ("tree", (((4,), np.dtype(float)),)), QUICK), kept.key("name", space, shapes, {}),
    }  # fmt: skip
    assert kept.key("name", space, shapes, QUICK) in keys
    for name in ("source", "processor"):
        monkeypatch.setattr(kept, name, lambda: "another")
        kept.surroundings.cache_clear()
        keys.add(kept.key("name", space, shapes, QUICK))
    kept.surroundings.cache_clear()
    before = jax.config.values["jax_enable_checks"]
    jax.config.update("jax_enable_checks", not before)
    keys.add(kept.key("name", space, shapes, QUICK))
    jax.config.update("jax_enable_checks", before)
    assert len(keys) == 8


@pytest.mark.skipif(os.name != "posix", reason="other systems have no such permissions")
def test_a_folder_that_others_can_write_to_is_not_used(sought: tuple[Path, Held, Bench]) -> None:
    place, held, bench = sought
    place.mkdir()
    place.chmod(0o777)
    with keeping(place):
        assert find(bench.problem(OWN, 2.0), held).converged
    assert not list(place.iterdir())
    assert kept.private(place.parent / "new")
    assert (place.parent / "new").stat().st_mode & 0o777 == 0o700

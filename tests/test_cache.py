"""The folder of compiled functions: what JAX keeps there, damage to it, and where it is."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from mckibben import cache

COMPILE = """
import sys
from pathlib import Path
from mckibben import cache
place = Path(sys.argv[1])
cache.folder = lambda: place
import jax
for turn in range(2):
    jax.clear_caches()
    with cache.kept():
        jax.jit(lambda x: 2.0 * x + 1.0)(1.0).block_until_ready()
    print(cache.size(place)[0])
"""


def compiled(place: Path) -> list[int]:
    """Entries in the cache after each of two compilations, in a process that must not say anything."""
    environment = {name: value for name, value in os.environ.items() if "CACHE" not in name}
    call = [sys.executable, "-c", COMPILE, str(place)]
    done = subprocess.run(call, capture_output=True, text=True, env=environment)
    assert (done.returncode, done.stderr) == (0, "")
    return [int(line) for line in done.stdout.split()]


def test_compiled_functions_are_kept_and_damage_is_mended(tmp_path: Path) -> None:
    first, second = compiled(tmp_path / "jax")
    assert first == second > 0
    for entry in tmp_path.rglob("*-cache"):
        entry.write_bytes(entry.read_bytes()[:20])
    assert compiled(tmp_path / "jax") == [0, first]  # heard of the damage and cleared; then all is well


def test_a_cache_that_cannot_be_written_is_no_trouble(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.delenv("JAX_COMPILATION_CACHE_DIR")
    monkeypatch.setattr(cache, "folder", lambda: tmp_path / "file" / "jax")
    assert cache.use() is None


def test_cache_place(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("JAX_COMPILATION_CACHE_DIR", str(tmp_path))
    assert cache.folder() == tmp_path
    monkeypatch.delenv("JAX_COMPILATION_CACHE_DIR")
    assert cache.folder().name.startswith("jax-")

"""Keys of compiled functions, the folder they are in, and what needs no JAX at all."""

import os
import subprocess
import sys
from collections import OrderedDict
from enum import Enum
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import attrs
import jax
import numpy as np
import pytest

import mckibben as mk
from mckibben.compiled import folder, kept
from mckibben.compiled.describe import UnkeepableError, describe, describe_tree
from mckibben.compiled.options import QUICK
from mckibben.discretise.spectral import Line
from mckibben.model.chamber import mooney_rivlin
from mckibben.model.parameters import Parameters, parameters

pytestmark = pytest.mark.compiled

ROOT = Path(__file__).parent.parent
KEYS = """
import numpy as np, jax, mckibben as mk
from mckibben.compiled.describe import describe, describe_tree
from mckibben.discretise.spectral import Line
from mckibben.model.chamber import mooney_rivlin
muscle, test = mk.presets.paper(), mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3)
print(describe((Line(5), mooney_rivlin, np.dtype(float), np.float32(1.5))))
print(describe_tree(jax.tree.structure((muscle, test, {"a": None, "b": [1.0]}))))
"""


class Pair(NamedTuple):
    """A user's."""

    a: Any
    b: Any


class Colour(Enum):
    """A user's."""

    red = 1


@attrs.frozen
class Thing:
    """A user's."""

    size: int = 1


def own(*state: Any) -> Any:
    return state


def test_what_a_key_covers(monkeypatch: pytest.MonkeyPatch) -> None:
    basis = Line(5)
    forms = (((3,), np.dtype(float)),)

    def key(
        name: str = "name", basis: Any = basis, forms: Any = forms, options: Any = QUICK, tree: Any = (1, 2)
    ) -> str:
        static = describe((basis, mooney_rivlin)) + describe_tree(jax.tree.structure(tree))
        return kept.key(name, static, forms, options)

    keys = {
        key(), key("other"), key(basis=Line(5, "pinned")), key(options={}),
        key(forms=(((4,), np.dtype(float)),)), key(forms=(((3,), np.dtype(np.float32)),)), key(tree=(1,)),
    }  # fmt: skip
    assert key() in keys
    for name in ("source", "processor"):
        monkeypatch.setattr(kept, name, lambda: "another")
        kept.surroundings.cache_clear()
        keys.add(key())
    kept.surroundings.cache_clear()
    before = jax.config.values["jax_enable_checks"]
    jax.config.update("jax_enable_checks", not before)
    keys.add(key())
    jax.config.update("jax_enable_checks", before)
    assert len(keys) == 10


def test_keys_are_the_same_in_every_process() -> None:
    """Whatever the addresses and hashes there."""
    said = set()
    for seed in ("1", "2"):
        environment = os.environ | {"PYTHONHASHSEED": seed, "PYTHONPATH": str(ROOT / "src")}
        call = [sys.executable, "-c", KEYS]
        said.add(subprocess.run(call, capture_output=True, text=True, env=environment, check=True).stdout)
    (text,) = said
    assert "0x" not in text
    assert "mckibben.spec.muscle.Muscle" in text
    assert "mooney_rivlin" in text


def test_structures_are_told_apart() -> None:
    """As JAX does."""
    paper = mk.presets.paper()
    trees = [
        1.0, (1.0,), [1.0], {"a": 1.0}, {"b": 1.0}, None, (None,), (1.0, (2.0,)), ((1.0, 2.0),), (1.0, 2.0),
        OrderedDict(a=1.0), OrderedDict(a=1.0, b=1.0), OrderedDict(b=1.0, a=1.0), {"a": 1.0, "b": 1.0}, {1: 1.0},
        paper, paper.replace("ends", "pinned"), paper.replace("chamber.law", mk.NeoHookean(c1="1 MPa")),
        parameters(paper),
    ]  # fmt: skip
    structures = list(map(jax.tree.structure, trees))
    assert len(set(structures)) == len(set(map(describe_tree, structures))) == len(trees)
    assert Parameters.__qualname__ in describe_tree(structures[-1])
    for tree in trees:
        assert describe_tree(jax.tree.structure(jax.tree.map(lambda x: 2 * x, tree))) in map(describe_tree, structures)


def test_what_is_a_users_own_has_no_key() -> None:
    """Its name says nothing of what it does."""
    custom = mk.presets.reference().replace("chamber.law", mk.CustomLaw(function=own))
    for value in (own, Thing(), Colour.red, Pair(1, 2), object(), cached_property, np.zeros(2)):
        with pytest.raises(UnkeepableError):
            describe(value)
    for tree in (Pair(1.0, 2.0), (1.0, {"a": Pair(1.0, 2.0)}), custom):
        with pytest.raises(UnkeepableError):
            describe_tree(jax.tree.structure(tree))
    spoofed = type("Line", (), {"__module__": Line.__module__, "__qualname__": "Line"})
    with pytest.raises(UnkeepableError):
        describe(spoofed())


def test_a_cache_that_cannot_be_written_is_no_trouble(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("MCKIBBEN_CACHE", str(tmp_path / "file" / "kernels"))
    assert folder.ready() is None
    kept.write(tmp_path / "file" / "name.kernel", (1, 2))
    assert kept.read(tmp_path / "file" / "name.kernel") is None


@pytest.fixture
def two(tmp_path: Path) -> tuple[Path, Path]:
    tmp_path.chmod(0o700)
    files = tmp_path / "one-00.kernel", tmp_path / "two-11.kernel"
    for turn, file in enumerate(files):
        kept.write(file, (b"code", turn))
        assert kept.read(file) == (b"code", turn)
    return files


def test_exchanged_files_are_not_read(two: tuple[Path, Path], tmp_path: Path) -> None:
    """Each says which kernel it holds."""
    one, other = two
    assert one.read_bytes().startswith(b"mckibben kernel 4\none-00.kernel\n")
    one.rename(tmp_path / "spare")
    other.rename(one)
    (tmp_path / "spare").rename(other)
    assert (kept.read(one), kept.read(other)) == (None, None)
    first, rest = one.read_bytes(), other.read_bytes()
    one.write_bytes(rest.splitlines(keepends=True)[0] + b"one-00.kernel\n" + first.partition(b".kernel\n")[2])
    assert kept.read(one) is None
    kept.write(one, (b"code", 0))
    assert kept.read(one) == (b"code", 0)


@pytest.mark.skipif(os.name != "posix", reason="owners and permissions")
def test_only_the_users_own_files_are_read(
    two: tuple[Path, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Asked on every reading, of the file and of its folder."""
    one, other = two
    for where, wrong, right in ((one, 0o620, 0o600), (one, 0o602, 0o600), (tmp_path, 0o770, 0o700)):
        where.chmod(wrong)
        assert kept.read(one) is None
        where.chmod(right)
        assert kept.read(one) == (b"code", 0)
    with monkeypatch.context() as patch:
        patch.setattr(folder.os, "getuid", lambda: one.stat().st_uid + 1)
        assert kept.read(one) is None
        assert not folder.private(tmp_path)
    os.link(one, tmp_path / "elsewhere")
    assert kept.read(one) is None
    (tmp_path / "elsewhere").rename(other)
    one.unlink()
    one.symlink_to(other)
    assert kept.read(one) is None
    one.unlink()
    os.mkfifo(one)
    assert kept.read(one) is None
    assert kept.read(other) is None  # under another name


def test_cache_place(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("MCKIBBEN_CACHE", str(tmp_path / "mine"))
    monkeypatch.setenv("JAX_COMPILATION_CACHE_DIR", str(tmp_path / "jax"))
    assert folder.folder() == tmp_path / "mine"
    monkeypatch.setenv("MCKIBBEN_CACHE", "off")
    assert folder.ready() is None
    monkeypatch.delenv("MCKIBBEN_CACHE")
    assert folder.folder() == tmp_path / "jax" / "kernels"
    monkeypatch.delenv("JAX_COMPILATION_CACHE_DIR")
    assert folder.folder().name.startswith("jax-")


def test_a_full_folder_loses_its_oldest(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("MCKIBBEN_CACHE", str(tmp_path))
    monkeypatch.setattr(folder, "LIMIT", 1000)
    tmp_path.chmod(0o700)
    for age in range(11):
        file = tmp_path / f"{age}{folder.SUFFIX}"
        file.write_bytes(bytes(100))
        os.utime(file, (1e9 - age, 1e9 - age))
    (tmp_path / "other").write_bytes(bytes(5000))
    assert folder.size(tmp_path) == (11, 1100)
    assert folder.ready() == tmp_path
    assert sorted(file.stem for file in tmp_path.glob("*.kernel")) == list("01234")
    assert (tmp_path / "other").exists()


def test_what_is_used_again_is_not_the_first_to_go(tmp_path: Path) -> None:
    file = tmp_path / f"one{folder.SUFFIX}"
    tmp_path.chmod(0o700)
    kept.write(file, "content")
    os.utime(file, (1e9, 1e9))
    assert kept.read(file) == "content"
    assert file.stat().st_mtime > 1e9


@pytest.mark.parametrize("call", ["--help", "run --help", "presets", "presets paper", "info", "check", "plot"])
def test_needs_no_jax(call: str, tmp_path: Path) -> None:
    if call == "check":
        call += f" {ROOT / 'examples' / 'case_a.toml'}"
    if call == "plot":
        from mckibben.files import store

        test = mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3)
        store.save(mk.run(mk.presets.paper(), test, tolerance=1e-3), tmp_path / "out.nc")
        call += f" {tmp_path / 'out.nc'} -o {tmp_path / 'out.png'}"
    script = f"""
import sys
from mckibben.app.cli import main
sys.argv = ["mckibben", *{call.split()!r}]
try:
    main()
except SystemExit as end:
    assert not end.code, end.code
assert not {{"jax", "jaxlib"}} & sys.modules.keys()
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")

"""The system's C compiler: from a C file to a shared library."""

from __future__ import annotations

import os
import platform
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path

from mckibben.spec.errors import SpecError

__all__ = ["compiled", "compiler", "library_place"]

TRIED = ("cc", "gcc", "clang")
FLAGS = ("-std=c99", "-O2", "-funroll-loops", "-ffp-contract=off", "-fvisibility=hidden", "-shared")
INSTALL = {
    "linux": "apt install gcc (Debian, Ubuntu) or dnf install gcc (Fedora)",
    "darwin": "xcode-select --install",
    "win32": "MinGW-w64 (winget install BrechtSanders.WinLibs.POSIX.UCRT)",
}
ARM = ("arm64", "aarch64", "armv7l", "armv8l")
"""What machines of that kind call themselves."""
SHOWN = 400
"""Characters of what a compiler says that are shown."""


def compiler() -> list[str]:
    """The compiler's command: what CC says, or cc, gcc or clang. SpecError where there is none."""
    said = shlex.split(os.environ.get("CC", ""))
    for command in [said] if said else [[name] for name in TRIED]:
        found = shutil.which(command[0])
        if found:
            return [found, *command[1:]]
    missing = f"CC says {said[0]}, which is not there" if said else f"none of {', '.join(TRIED)} is there"
    advice = f"install one: {INSTALL.get(sys.platform, 'gcc')}"
    raise SpecError("compiler", allowed=f"an FMU takes a C compiler, and {missing}", advice=advice)


def library_place(fmi: int = 2) -> tuple[str, str]:
    """The folder of an FMU (FMI 2.0 or 3.0) for a library of this machine, and the library's ending."""
    system, ending = {"win32": ("win", ".dll"), "darwin": ("darwin", ".dylib")}.get(sys.platform, ("linux", ".so"))
    wide = sys.maxsize > 2**32
    if fmi == 2:
        return f"{system}{'64' if wide else '32'}", ending
    machine = ("aarch64" if wide else "aarch32") if platform.machine().lower() in ARM else "x86_64" if wide else "x86"
    return f"{machine}-{'windows' if system == 'win' else system}", ending


def compiled(sources: Mapping[str, str], main: str) -> bytes:
    """The shared library of `main` among some sources, by their names. SpecError with what the compiler says."""
    command = compiler()
    position = () if sys.platform == "win32" else ("-fPIC",)
    with tempfile.TemporaryDirectory() as folder:
        for name, text in sources.items():
            (Path(folder) / name).write_text(text, encoding="utf-8")
        words = [*command, *FLAGS, *position, main, "-o", "library.out", "-lm"]
        try:
            done = subprocess.run(words, cwd=folder, capture_output=True, text=True, errors="replace", check=False)
        except OSError as error:
            raise SpecError("compiler", command[0], f"cannot be run: {error.strerror or error}") from error
        if done.returncode:
            said = f"failed on {platform.machine()}: {done.stderr.strip()[:SHOWN]}"
            raise SpecError("compiler", command[0], said, "set CC to another compiler")
        return (Path(folder) / "library.out").read_bytes()

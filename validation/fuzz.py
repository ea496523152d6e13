"""Wrong input of every kind: whether anything ends in a traceback, a crash or a hang, and what is accepted.

    python validation/fuzz.py [--count 10000] [--seed 1] [--solve 100]

Case files, overrides, sweep files, tables of designs, saved results and stores of sweeps are changed at random and
given to what reads them; some case files are run, with JSON asked for. What was accepted goes to
out/fuzz_accepted.jsonl, what was not right to out/fuzz_wrong.jsonl, and the figures into validation/README.md.
"""

import argparse
import collections
import json
import multiprocessing
import random
import shutil
import tempfile
import time
from multiprocessing.connection import Connection
from pathlib import Path
from textwrap import fill
from typing import Any

from environment import OUT, ROOT
from mutants import CASE, OVERRIDES, PRESET, SWEEP, TABLE, TABLED, damaged, mutated
from sections import put
from summary import table

HANGS = 30.0
"""Seconds after which an input counts as a hang."""
SHARES = {"case file": 0.38, "override": 0.1, "sweep file": 0.16, "table of designs": 0.18, "result (.nc)": 0.12,
          "sweep (.zarr)": 0.06}  # fmt: skip
KINDS = (*SHARES, "run with --json")
COLUMNS = ("refused in one line", "accepted", "traceback", "crash", "hang")

Files = dict[str, bytes]


def inputs(count: int, solve: int, seed: int) -> Any:
    """(kind, files, overrides) of every input; files of a store are relative to it, empty bytes for a lost one."""
    for turn in range(count):
        chance = random.Random(f"{seed} {turn}")
        kind = chance.choices(list(SHARES), list(SHARES.values()))[0] if turn >= solve else KINDS[-1]
        text = chance.choice((CASE, CASE, PRESET))
        if kind in ("case file", "run with --json"):
            yield kind, {"case.toml": mutated(text, chance)}, []
        elif kind == "override":
            yield (
                kind,
                {"case.toml": text.encode()},
                [mutated(chance.choice(OVERRIDES), chance).decode("utf-8", "replace")],
            )
        elif kind == "sweep file":
            yield kind, {"case.toml": mutated(SWEEP, chance)}, []
        elif kind == "table of designs":
            yield kind, {"case.toml": TABLED.encode(), "designs.csv": mutated(TABLE, chance)}, []
        elif kind == "result (.nc)":
            yield kind, {"seed": str(chance.random()).encode()}, []
        else:
            yield kind, {"seed": str(chance.random()).encode()}, []


class Reader:
    """What reads the inputs, in a process of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.whole: dict[str, Any] = {}

    def __call__(self, kind: str, files: Files, overrides: list[str]) -> str:
        """What was accepted, in words. Raises SpecError for what is refused."""
        for name, data in files.items():
            (self.folder / name).write_bytes(data)
        path = self.folder / "case.toml"
        if kind == "run with --json":
            return self._run(path)
        if kind == "result (.nc)":
            return self._result(files["seed"])
        if kind == "sweep (.zarr)":
            return self._store(files["seed"])
        return self._read(path, overrides)

    def _read(self, path: Path, overrides: list[str]) -> str:
        """As `mckibben check` does, and back to text."""
        import tomllib

        from mckibben.experiments import foresee
        from mckibben.spec.rows import muscle_rows
        from mckibben.spec.text import from_mapping, to_toml
        from mckibben.sweeps.plan import plan
        from mckibben.sweeps.sweepfile import read_sweep

        asked = read_sweep(path, overrides, required=False)
        again = from_mapping(tomllib.loads(to_toml(asked.case)), test_required=False)
        assert again == asked.case, "does not read back equal"
        list(muscle_rows(asked.case.muscle))
        list(foresee.derived(asked.case.muscle))
        list(foresee.beyond(asked.case.muscle, asked.case.test))
        said = ""
        if asked.over is not None or asked.designs is not None:
            wanted = plan(asked.case.muscle, asked.case.test, asked.over, asked.designs, chunk=asked.chunk)
            json.dumps(wanted.identity())
            said = f"{len(wanted)} designs, {[(v.field, v.values[:4]) for v in wanted.varied]}; "
        return f"{said}{asked.case.muscle!r}; {asked.case.test!r}"

    def _run(self, path: Path) -> str:
        """As `mckibben run --json` does: JSON without NaN, and an exit code."""
        from typer.testing import CliRunner

        from mckibben.app.cli import app
        from mckibben.files.case import read_case
        from mckibben.spec.errors import SpecError

        case = read_case(path)
        states = sum(step.points for step in case.test.as_steps(case.muscle))
        if states > 50:
            return f"not run: {states} states"
        done = CliRunner().invoke(app, ["run", str(path), "--json", "--tolerance", "1e-2"])
        if done.exit_code == 2 and len(done.stderr.strip().splitlines()) == 1:
            raise SpecError(done.stderr.strip())
        if done.exception is not None and not isinstance(done.exception, SystemExit):
            raise done.exception
        assert done.exit_code in (0, 3), f"exit code {done.exit_code}: {done.stderr}"
        found = json.loads(done.stdout, parse_constant=lambda word: 1 / 0)
        return f"{case.muscle!r}; {case.test!r}; exit code {done.exit_code}, {len(found)} keys"

    def _result(self, seed: bytes) -> str:
        """A damaged result; one that is accepted must be equal to what was saved."""
        import mckibben as mk
        from mckibben.files.seal import damage

        if "result" not in self.whole:
            curve = mk.run(mk.presets.paper(), mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3))
            self.whole["result"] = curve, mk.save(curve, self.folder / "whole.nc", force=True).read_bytes()
        curve, data = self.whole["result"]
        changed = damaged(data, random.Random(seed))
        (self.folder / "copy.nc").write_bytes(changed)
        assert mk.load(self.folder / "copy.nc") == curve, "loads with other content"
        return "the same content" if damage(changed) is None else "whole"

    def _store(self, seed: bytes) -> str:
        """A store with a damaged or lost file; one that is accepted must be equal but for designs called pending."""
        import mckibben as mk

        place, copy, chance = self.folder / "whole.zarr", self.folder / "copy.zarr", random.Random(seed)
        if "store" not in self.whole:
            test = mk.Isometric(length="250 mm", pressure="0 to 1 bar", points=3)
            over = {"braid.fibres": [40, 50, 56], "ends": ["clamped", "pinned"]}
            self.whole["store"] = mk.sweep(mk.presets.paper(), test, over, to=place, workers=0, chunk=2).load()
        whole = self.whole["store"]
        shutil.rmtree(copy, ignore_errors=True)
        shutil.copytree(place, copy)
        file = chance.choice(sorted(file for file in copy.rglob("*") if file.is_file()))
        if chance.random() < 0.2:
            file.unlink()
        else:
            file.write_bytes(damaged(file.read_bytes(), chance))
        found = mk.load(copy).load()
        pending = found.status == -1
        same = all(bool(((found[name] == whole[name]) | pending).all()) for name in ("verdict", "reason", "status"))
        assert same, "loads with other content"
        assert found.attrs == whole.attrs, "loads with another description"
        return "a chunk is pending" if bool(pending.any()) else "the same content"


def serve(pipe: Connection, folder: str) -> None:
    """The child process: one answer for each input."""
    from mckibben.spec.errors import SpecError

    reader = Reader(Path(folder))
    reader("case file", {"case.toml": CASE.encode()}, [])  # what is imported on first use
    pipe.send(("ready", ""))
    while True:
        given = pipe.recv()
        if given is None:
            return
        try:
            pipe.send((COLUMNS[1], reader(*given)))
        except SpecError as error:
            one_line = "\n" not in str(error) and len(str(error)) < 2000
            pipe.send((COLUMNS[0] if one_line else COLUMNS[2], str(error)))
        except BaseException as error:
            import traceback

            pipe.send((COLUMNS[2], f"{error!r}: {traceback.format_exc()[-1500:]}"))


class Child:
    """A process that reads, started anew where one hangs or dies."""

    def __init__(self, folder: str) -> None:
        self.folder = folder
        self._start()

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(target=serve, args=(theirs, self.folder), daemon=True)
        self.process.start()
        theirs.close()
        self.pipe.recv()

    def ask(self, given: Any) -> tuple[str, str]:
        self.pipe.send(given)
        try:
            if self.pipe.poll(HANGS):
                outcome, said = self.pipe.recv()
                return str(outcome), str(said)
            outcome = "hang"
        except (EOFError, ConnectionError):
            outcome = "crash"
        self.process.kill()
        self.process.join()
        self._start()
        return outcome, ""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--solve", type=int, default=100, help="how many of them are run")
    asked = parser.parse_args()
    OUT.mkdir(exist_ok=True)
    counted, slowest, began = collections.Counter[tuple[str, str]](), (0.0, ""), time.perf_counter()
    with tempfile.TemporaryDirectory() as folder, (OUT / "fuzz_accepted.jsonl").open("w") as accepted, (
        OUT / "fuzz_wrong.jsonl"
    ).open("w") as wrong:  # fmt: skip
        child = Child(folder)
        for given in inputs(asked.count, asked.solve, asked.seed):
            start = time.perf_counter()
            outcome, said = child.ask(given)
            slowest = max(slowest, (time.perf_counter() - start, given[0]))
            counted[given[0], outcome] += 1
            if outcome != COLUMNS[0]:
                texts = {name: data.decode("utf-8", "replace") for name, data in given[1].items()}
                line = {"kind": given[0], "outcome": outcome, "said": said, "files": texts, "overrides": given[2]}
                (accepted if outcome == COLUMNS[1] else wrong).write(json.dumps(line) + "\n")
        child.pipe.send(None)
    report(counted, slowest, time.perf_counter() - began, asked)


def report(counted: Any, slowest: tuple[float, str], seconds: float, asked: argparse.Namespace) -> None:
    """The figures, here and in README.md."""
    rows = [[kind, *(counted[kind, column] for column in COLUMNS)] for kind in KINDS]
    rows = [[row[0], sum(row[1:]), *row[1:]] for row in rows]
    rows.append(["all", *(sum(row[k] for row in rows) for k in range(1, len(rows[0])))])
    command = f"python validation/fuzz.py --count {asked.count} --seed {asked.seed} --solve {asked.solve}"
    said = f"""Written by `{command}`: valid input of each kind (`validation/mutants.py`) with characters, values,
lines or bytes changed at random, read as `mckibben check`, `sweep` and `mckibben.load` read it. What is accepted must
read back equal from its own TOML; a result or sweep that loads must be what was saved, or say which designs are
pending. A hang is an input that takes more than {HANGS:.0f} s; the slowest of the others took {slowest[0]:.1f} s
({slowest[1]}), all of them {seconds:.0f} s in one process."""
    head = ["input", "count", *COLUMNS]
    put("## Wrong input", ["", fill(" ".join(said.split()), 120), *table(head, rows)])
    print(*("  ".join(map(str, row)) for row in (head, *rows)), f"{seconds:.0f} s", sep="\n")
    print("what was accepted, and what was wrong:", (OUT / "fuzz_*.jsonl").relative_to(ROOT))


if __name__ == "__main__":
    main()

"""How soon the page follows: from an input to the picture in a browser, and with many people at once.

    python benchmarks/page.py [seconds of the load, 60]

It takes Chromium and Playwright (the extra `dev`). Times are in ms: the median, the 95th percentile, the largest.
"""

from __future__ import annotations

import asyncio
import json
import random
import sys
import time
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))

from browsers import CHROMIUM, FLAGS, Watched, served

PEOPLE = 20
MOVES = 60
BEGINNING = 20.0
"""Seconds in which processes are started for many people."""
PAUSE = 0.25
"""Seconds between the moves of one slider in the browser: each is seen before the next."""
STEP = 0.1
"""Seconds between the moves of each of many people."""


def told(name: str, times: list[float]) -> dict[str, Any]:
    """Print a row, and give it as numbers."""
    ordered = sorted(times)
    at = [ordered[min(len(ordered) - 1, int(share * len(ordered)))] for share in (0.5, 0.95)]
    print(f"{name:52} {len(times):6} {at[0]:8.0f} {at[1]:8.0f} {ordered[-1]:8.0f}")
    return {"what": name, "count": len(times), "p50": at[0], "p95": at[1], "largest": ordered[-1]}


def moved(seen: Watched, label: str, moves: int) -> tuple[list[float], list[float]]:
    """Times [ms] to the shape and to the curves, of a slider that is moved to and fro by the keyboard."""
    slider = seen.tab.get_by_label(label)
    slider.focus()
    seen.tab.evaluate("performance.clearMeasures()")
    for k in range(moves):
        seen.tab.keyboard.press("ArrowLeft" if k % 20 < 10 else "ArrowRight")
        time.sleep(PAUSE)
    time.sleep(2.0)
    return tuple(  # type: ignore[return-value]
        seen.tab.evaluate(f"performance.getEntriesByName('input to {what}').map(one => one.duration)")
        for what in ("shape", "picture")
    )


def in_a_browser(address: str) -> list[dict[str, Any]]:
    """One person."""
    from playwright.sync_api import sync_playwright

    rows = []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=list(FLAGS))
        seen = Watched(browser.new_context(viewport={"width": 1366, "height": 900}), address)
        seen.open()
        time.sleep(8.0)  # the working range is found
        sliders = {"pressure": "Pressure, in bar", "braid angle": "Braid angle, from the parallels, in deg",
                   "load": "Load, in N"}  # fmt: skip
        for name, label in sliders.items():
            moved(seen, label, 5)
            shape, curves = moved(seen, label, MOVES)
            rows += [told(f"{name}: input to shape", shape), told(f"{name}: input to all curves", curves)]
        seen.quiet()
        browser.close()
    return rows


async def person(address: str, number: int, seconds: float, times: list[float], errors: list[str]) -> None:
    """Somebody who drags a slider: the newest look is waited for, then the next is asked."""
    from websockets.asyncio.client import connect

    chance = random.Random(number)
    host = address.removeprefix("http://").rstrip("/")
    async with connect(f"ws://{host}/socket", origin=address.rstrip("/"), max_size=None) as socket:  # type: ignore[arg-type]
        end, k = time.perf_counter() + seconds, 0
        while time.perf_counter() < end:
            changes = {"braid.angle": f"{37.0 + chance.uniform(-2.0, 2.0):.1f} deg"}
            said = {"muscle": {"from": {"preset": "paper"}, "changes": changes}, "pressure": 1e5, "hold": "force",
                    "value": 0.0, "top": 1e5}  # fmt: skip
            begun, k = time.perf_counter(), k + 1
            await socket.send(json.dumps({"id": k, "task": "look", "said": said}))
            while (message := json.loads(await socket.recv()))["part"] not in ("done", "error", "busy", "cancelled"):
                pass
            if message["part"] == "done":
                times.append(1e3 * (time.perf_counter() - begun))
            else:
                errors.append(str(message))
            await asyncio.sleep(STEP)


async def load(address: str, seconds: float) -> tuple[list[float], list[str]]:
    """Many people at once."""
    times: list[float] = []
    errors: list[str] = []
    await asyncio.gather(*(person(address, number, seconds, times, errors) for number in range(PEOPLE)))
    return times, errors


def main(seconds: float) -> None:
    """Print the table, and write it to out/page.json."""
    print(f"{'what':52} {'count':>6} {'p50':>8} {'p95':>8} {'largest':>8}")
    with served() as address:
        rows = in_a_browser(address)
        begun, first = asyncio.run(load(address, BEGINNING))
        times, errors = asyncio.run(load(address, seconds))
    rows.append(told(f"{PEOPLE} people, the first {BEGINNING:g} s, {len(first)} errors: request to curves", begun))
    rows.append(told(f"{PEOPLE} people for {seconds:g} s, {len(errors)} errors: request to curves", times))
    print(*errors[:3], sep="\n")
    Path("out").mkdir(exist_ok=True)
    (Path("out") / "page.json").write_text(json.dumps(rows, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 60.0)

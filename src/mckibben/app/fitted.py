"""A fit for people and for programs: tables of its numbers and tests, JSON, and a muscle for case files."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from mckibben.app.console import say, table
from mckibben.app.outputs import case_of, finite

if TYPE_CHECKING:
    from mckibben.results.fit import Fitted

__all__ = ["as_json", "described", "muscle_text", "show"]


def show(fit: Fitted, seconds: float, tried: int) -> None:
    """Print the numbers, what is left in each test, and the notes."""
    about = fit.data.attrs
    rows = [(name, row["value"], row["error"], row["interval"], row["bounds"]) for name, row in fit.table.iterrows()]
    head = ("number", "value", "error", f"{100.0 * about['level']:g} % interval", "searched")
    title = f"{len(rows)} numbers fitted to {len(fit.residuals)} points of {about['source']}"
    say(table(head, rows, title=title, right=(2,), whole=(0, 1, 3, 4)), whole=True)
    tests = [
        (one["name"], str(one["points"]), f"{one['rms']:.3g}", *map(_percent, (one["of_range"], one["of_force"])),
         f"{one['largest']:.3g}")
        for one in _tests(fit)
    ]  # fmt: skip
    left = ("test", "points", "rms\n[N]", "% of its\nrange", "% of the\nlargest force", "largest\n[N]")
    say(table(left, tests, title="Model less measured", right=range(1, 6), most=40))
    say(_goodness(fit))
    say(f"intervals by {about['intervals']}; standard deviation of a measured force: {about['force_error']:.3g} N")
    say(f"{tried} muscles tried in {seconds:.1f} s" + ("" if fit.converged else ": the search had not settled"))
    for note in fit.notes:
        say(f"- {note}")


def _percent(value: float | None) -> str:
    return "-" if value is None else f"{value:.2g}"


def _goodness(fit: Fitted) -> str:
    explained = "" if math.isnan(fit.explained) else f", R² {fit.explained:.6f}"
    return f"{fit.goodness}, largest {fit.largest:.3g} N{explained}"


def _tests(fit: Fitted) -> list[dict[str, Any]]:
    """What is left in each test: in N, and in per cent of the test's range of forces and of the largest force."""
    import numpy as np

    names, force, residuals = fit.data["test"].values, fit.data["force"].values, fit.residuals
    most = float(np.abs(force).max())
    found = []
    for name in dict.fromkeys(names.tolist()):
        rows = names == name
        rms, spread = float(np.sqrt(np.mean(residuals[rows] ** 2))), float(np.ptp(force[rows]))
        found.append({
            "name": str(name), "points": int(rows.sum()), "rms": rms, "largest": float(np.abs(residuals[rows]).max()),
            "of_range": 100.0 * rms / spread if spread else None, "of_force": 100.0 * rms / most if most else None,
        })  # fmt: skip
    return found


def as_json(fit: Fitted, seconds: float, tried: int, files: dict[str, str | None]) -> dict[str, Any]:
    """The whole fit for JSON, in SI units; None for what is not determined, and for NaN and infinity."""
    from mckibben.results.found import NUMBERS
    from mckibben.spec.text import to_mapping

    data, numbers = fit.data, {}
    for k, name in enumerate(fit.numbers):
        known = {kind: finite(data[kind].values[k]) for kind in NUMBERS}
        lost = name in fit.undetermined
        known |= {"value": None, "error": None} if lost else {}
        numbers[name] = {"unit": str(data["unit"].values[k]), "determined": not lost, **known}
    return {
        "converged": fit.converged, **files, "numbers": numbers, "level": float(data.attrs["level"]),
        "intervals": str(data.attrs["intervals"]),
        "correlation": [[finite(value) for value in row] for row in data["correlation"].values.tolist()],
        "points": len(fit.residuals), "rms": fit.rms, "of_force": finite(fit.percent), "largest": fit.largest,
        "explained": finite(fit.explained), "tests": _tests(fit), "notes": list(fit.notes),
        "force_error": float(data.attrs["force_error"]), "muscle": to_mapping(fit.muscle, allow_custom=True),
        "further": [to_mapping(one, allow_custom=True) for one in fit.further],
        "source": str(data.attrs["source"]), "tried": tried, "seconds": seconds,
        "mckibben_version": str(data.attrs["mckibben_version"]),
    }  # fmt: skip


def described(fit: Fitted) -> list[tuple[str, str]]:
    """What a saved fit is, in rows of a name and a text."""
    about = fit.data.attrs
    rows = [
        ("holds", f"a fit of {len(fit.numbers)} numbers to {len(fit.residuals)} points of {about['source']}"),
        ("made", f"with mckibben {about['mckibben_version']}"),
        ("residuals", _goodness(fit)),
        ("search", "settled" if fit.converged else f"had not settled: {about.get('message', '')}"),
    ]
    rows += [(name, row["value"] + (f", standard error {row['error']}" if row["error"] else ""))
             for name, row in fit.table.iterrows()]  # fmt: skip
    rows += [(f"test {one['name']}", f"{one['points']} points, rms {one['rms']:.3g} N") for one in _tests(fit)]
    return rows + [("note", note) for note in fit.notes]


def muscle_text(fit: Fitted) -> str:
    """The fitted muscle as the [muscle] table of a case file, with what it comes from in comments."""
    about = fit.data.attrs
    lines = [f"fitted to {about['source']} by mckibben {about['mckibben_version']}: {_goodness(fit)}"]
    lines += [f"the first of {len(fit.muscles)} muscles that were fitted together"] if fit.further else []
    lines += [f"{name}: {row['value']}" + (f" +- {row['error']}" if row["error"] else "")
              for name, row in fit.table.iterrows()]  # fmt: skip
    return case_of(fit.muscle, lines)

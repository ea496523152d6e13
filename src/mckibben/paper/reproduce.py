"""The paper's tests and figures, made from nothing: `reproduce()` runs them, draws them and sums them up."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping
from pathlib import Path

import attrs
import numpy as np
from matplotlib.figure import Figure

from mckibben.data.values import Data
from mckibben.discretise.bspline import Spline
from mckibben.discretise.placement import crowding
from mckibben.discretise.spectral import Line
from mckibben.experiments.run import run
from mckibben.model.parameters import parameters
from mckibben.paper import figures as paper
from mckibben.paper.measured import Measured, measured_points, read_measured
from mckibben.results.result import Result
from mckibben.solver.find import find
from mckibben.solver.held import Held
from mckibben.solver.problem import Problem
from mckibben.spec import FreeContraction, Isobaric, Isometric, Muscle, Protocol, SpecError, Step, presets
from mckibben.units import show
from mckibben.view import style
from mckibben.view.curves import profiles, tension

Watch = Callable[[int, int, str], None]

PICTURES = (
    "fig1_volume_angle", "fig2_mesh", "fig3_infinitesimal_cylinder", "fig4_cases_a_to_d", "fig5_energy_density",
    "fig6_stiff_fibres", "profiles", "fibre_tension", "textbook", "convergence",
)  # fmt: skip
CASES = {"a": "115 mm", "b": "55 mm", "c": "115 mm", "d": "55 mm"}
STIFFER = 100.0
PRESSURES = ("0.1 bar", "0.5 bar", "1 bar")
"""Of the comparison with the textbook formulas."""
LINES, SPLINES, EXACT = (6, 8, 12, 24), (23, 43, 83, 163), 48
"""Sizes in the convergence study; the reference is the spectral line of size EXACT."""


@attrs.frozen
class Row:
    """One number of the summary: the model's, Eq. (31)'s where it says something, and the one stated beforehand.

    `stated` comes from this project's theory page (docs/theory.md), computed with independent codes: the paper prints
    curves and no numbers.
    """

    case: str
    what: str
    unit: str
    model: float
    formula: float | None
    stated: float | None


@attrs.frozen
class Reproduction:
    """What `reproduce` made: the summary's rows, the files of the pictures, and the points laid over Fig. 4."""

    rows: tuple[Row, ...]
    pictures: tuple[Path, ...]
    muscle: Muscle
    measured: dict[str, Measured]


def reproduce(
    out_dir: str | os.PathLike[str],
    *,
    watch: Watch | None = None,
    measured: Mapping[str, str | os.PathLike[str]] | None = None,
    force: bool = False,
) -> Reproduction:
    """Run the paper's tests a to d and its stiff muscle, and write every figure as PDF and PNG into `out_dir`.

    Args:
        out_dir: folder of the pictures; made if missing.
        watch: called with (parts done, parts in all, what comes next).
        measured: files of measured curves for the panels of Fig. 4, by "a", "b", "c", "d", as `read_data` takes them:
            pressure and force, or pressure and length. None is part of this package.
        force: whether pictures that exist may be replaced; if not and there are some, SpecError and nothing is run.
    """
    folder, muscle = Path(out_dir), presets.paper()
    data = _check(folder, dict(measured or {}), force)
    tell = watch or (lambda done, total, what: None)
    total = 8
    results: dict[str, Result] = {}
    for k, name in enumerate(CASES):
        tell(k, total, f"case {name}")
        results[name] = run(muscle, case(name))
    tell(4, total, "states without force")
    few = [float(x) for x in np.geomspace(2e2, 1e5, 32)]
    results["relaxed"] = run(muscle, FreeContraction(pressure=few))
    stiff = muscle.replace("braid.fibre.E", STIFFER * float(muscle.braid.fibre.E or 0.0))
    results["stiff"] = run(stiff, Isometric(length="55 mm", pressure="0 to 1 bar"))
    tell(5, total, "comparison with the formulas")
    curves = [run(muscle, Isobaric(pressure=P, length="120 mm to 45 mm", points=32)) for P in PRESSURES]
    tell(6, total, "convergence")
    errors, splines = _convergence(muscle)
    tell(7, total, "pictures")
    points = measured_points(data, results, results["relaxed"])
    pictures = _save(folder, _figures(muscle, results, curves, errors, points))
    tell(8, total, "done")
    return Reproduction(_rows(results, splines), pictures, muscle, points)


def case(name: str) -> Isometric | Protocol:
    """The paper's test "a", "b", "c" or "d" (Sec. III)."""
    length = CASES[name]
    if name in "ab":
        return Isometric(length=length, pressure="0 to 1 bar")
    return Protocol(steps=[
        Step(length=f"to {length}", pressure=0.0, points=11),
        Step(length="hold", pressure="0 to 1 bar", points=11),
        Step(pressure="1 bar", force="to 0 N", points=21),
    ])  # fmt: skip


def _check(folder: Path, measured: Mapping[str, str | os.PathLike[str]], force: bool) -> dict[str, Data]:
    """Everything that can be wrong with what was asked, before anything takes time; the measured points."""
    if folder.exists() and not folder.is_dir():
        raise SpecError("out_dir", str(folder), "is not a folder")
    unknown = sorted(set(measured) - set(CASES))
    if unknown:
        raise SpecError("measured", unknown[0], "must be one of " + ", ".join(CASES))
    data = {name: read_measured(path, name, CASES[name]) for name, path in measured.items()}
    there = [f"{stem}.{kind}" for stem in PICTURES for kind in ("pdf", "png") if (folder / f"{stem}.{kind}").exists()]
    if there and not force:
        said = f"holds {len(there)} of the pictures already, {there[0]} for one"
        raise SpecError("out_dir", str(folder), said, "choose another folder, or allow replacing them with force")
    return data


def _figures(
    muscle: Muscle, results: Mapping[str, Result], curves: list[Result],
    errors: Mapping[str, tuple[list[float], list[float]]], measured: Mapping[str, Measured],
) -> dict[str, Figure]:  # fmt: skip
    made = (
        paper.fig1(muscle), paper.fig2(muscle), paper.fig3(muscle), paper.fig4(results, results["relaxed"], measured),
        paper.fig5(results["a"]), paper.fig6(results["stiff"], STIFFER), profiles(results["a"]), tension(results["a"]),
        paper.textbook(curves), paper.convergence(errors, muscle),
    )  # fmt: skip
    return dict(zip(PICTURES, made, strict=True))


def _save(folder: Path, figures: Mapping[str, Figure]) -> tuple[Path, ...]:
    return tuple(path for stem, figure in figures.items() for path in style.save(figure, folder / stem))


def _convergence(muscle: Muscle) -> tuple[dict[str, tuple[list[float], list[float]]], float]:
    """Errors of the force of case a at 1 bar by discretisation and size, and the paper's 43 splines' force [N]."""
    p, ends = parameters(muscle), str(muscle.ends)
    held = Held.of(length=0.115, pressure=1e5)
    b = crowding(p, np.array([0.115]), np.array([np.nan]), np.array([1e5]))

    def force(basis: Line | Spline) -> float:
        found = find(Problem.of(basis, p, b), held)
        return found.force if found.converged else float("nan")

    exact = force(Line(EXACT, ends))
    lines = [force(Line(size, ends)) for size in LINES]
    splines = [force(Spline(size, ends)) for size in SPLINES]
    errors = {
        name: ([float(size) for size in sizes], [abs(x / exact - 1.0) for x in found])
        for name, sizes, found in (
            ("spectral line, odd modes (ours)", LINES, lines), ("cubic B-splines (the paper's: 43)", SPLINES, splines)
        )
    }  # fmt: skip
    return errors, splines[SPLINES.index(43)]


def _rows(results: Mapping[str, Result], splines: float) -> tuple[Row, ...]:
    """The summary; stated values are those of the theory page, section "The paper's actuator"."""
    rows = []
    stated = {"a": (3.290, 101.221), "b": (-3.196, -46.689), "stiff": (-11.80, -59.06)}
    for name, values in stated.items():
        result, title = results[name], "b, fibres 100 times stiffer" if name == "stiff" else name
        formula = paper.formula_force(result)
        for k, value in zip((0, -1), values, strict=True):
            pressure = show(result.pressure[k], "Pa")
            rows.append(Row(title, f"force at {pressure}", "N", float(result.force[k]), float(formula[k]) + 0.0, value))
    rows.append(Row("a", "force at 1 bar, 43 B-splines as in the paper", "N", splines, None, None))
    magic = _magic_length(results["c"].muscle)
    for name, value in (("c", -0.2872), ("d", 0.4905)):
        h = results[name].length
        L = float(h[np.flatnonzero(results[name].data["protocol_step"].values == 0)[-1]])
        rows.append(Row(name, "length let go at 1 bar", "mm", 1e3 * float(h[-1]), 1e3 * magic, 81.976))
        rows.append(Row(name, "change of length over length", "1", float(h[-1]) / L - 1.0, magic / L - 1.0, value))
    last = results["a"].data.isel(step=-1)
    fibres = sum(float(last[f"energy_{part}"]) for part in ("bending_1", "bending_2", "twist"))
    rows.append(Row("a", "energy of the fibres at 1 bar", "mJ", 1e3 * fibres, None, 8.65))
    rows.append(Row("a", "energy of the chamber at 1 bar", "mJ", 1e3 * float(last["energy_chamber"]), None, 29.36))
    return tuple(rows)


def _magic_length(muscle: Muscle) -> float:
    """Length [m] of the cylinder at the magic angle, where Eq. (31) has no force at any pressure."""
    return float(muscle.braid.length) / math.sqrt(3.0) / math.sin(float(muscle.braid.angle))

"""Pictures of the validation."""

from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from sample import muscle_of

from mckibben.model.cylinder import cylinder_force, cylinder_length, end_layer
from mckibben.model.kinematics import radius
from mckibben.model.parameters import Parameters, parameters
from mckibben.model.point import Point
from mckibben.model.wrinkling import wrinkling
from mckibben.view.style import BLUE, GREY, NOTE, ORANGE, PAGE, PURPLE, VERMILLION, new_figure, panel, tidy

COLOURS = {
    "stable": BLUE, "unstable": ORANGE, "inadmissible": VERMILLION, "not converged": PURPLE, "crash": "k",
    "no equilibrium": GREY,
}  # fmt: skip
LIMIT = 100.0
"""Wrinkling indices above this are drawn here: far from wrinkling."""


@jax.jit
def _cylinder(p: Parameters, length: Any, force: Any, pressure: Any) -> tuple[Any, Any, Any]:
    """Length of the cylinder with the target's length or force, H0 over its end layer, and its wrinkling index."""
    angles = jnp.linspace(jnp.deg2rad(3.0), jnp.deg2rad(88.0), 1001)
    forces = jax.vmap(lambda theta: cylinder_force(theta, pressure, p))(angles)
    lengths = cylinder_length(angles, p)
    best = jnp.argmin(jnp.where(jnp.isnan(length), jnp.abs(forces - force), jnp.abs(lengths - length)))
    theta, h = angles[best], lengths[best]
    layer = end_layer(theta, forces[best] + jnp.pi * radius(Point.cylinder(theta), p) ** 2 * pressure, p)
    return h, p.H0 / layer, wrinkling(h, pressure, p)[0]


def _place(row: dict[str, Any]) -> tuple[float, float, float]:
    """H0/delta, h/h_max and wrinkling index of a case's cylinder."""
    case, held = row["case"], row["case"]["held"]
    asked = (held.get("length", np.nan), held.get("force", np.nan), held["pressure"])
    h, layers, index = _cylinder(parameters(muscle_of(case)), *(np.asarray(x, float) for x in asked))
    return float(layers), float(h) / case["longest"], float(index)


def draw_map(rows: list[dict[str, Any]], path: Path) -> None:
    """Where the verdicts lie: length and wrinkling index of the target's cylinder against H0 over the end layer."""
    figure = new_figure(PAGE, 3.0)
    left, right = figure.subplots(1, 2)
    places = np.array([_place(row) for row in rows])
    verdicts = np.array([row["found"]["verdict"] for row in rows])
    by_length = np.array(["length" in row["case"]["held"] for row in rows])
    for verdict, colour in COLOURS.items():
        for of, marker, control in ((by_length, "o", "length held"), (~by_length, "^", "force held")):
            x, h, index = places[(verdicts == verdict) & of].T
            if not len(x):
                continue
            look: Any = {
                "s": 7.0 if verdict == "stable" else 20.0, "color": colour, "marker": marker, "linewidths": 0.0,
                "alpha": 0.45 if verdict == "stable" else 0.95, "zorder": 2 if verdict == "stable" else 3,
            }  # fmt: skip
            left.scatter(x, h, label=f"{verdict}, {control} ({len(x)})", **look)
            right.scatter(x, np.minimum(index, LIMIT), **look)
    left.set(xscale="log", ylabel="Length of the cylinder / h_max", xlabel="H0 / width of the end layer")
    right.set(xscale="log", ylabel="Wrinkling index", xlabel="H0 / width of the end layer")
    right.set_yscale("symlog", linthresh=1.0)
    right.axhline(-1.0, color=GREY, linewidth=0.8, linestyle="--")
    right.text(0.98, -1.15, "expected to wrinkle below", transform=right.get_yaxis_transform(), fontsize=NOTE,
               va="top", ha="right", color=GREY)  # fmt: skip
    for axes, letter in ((left, "a"), (right, "b")):
        tidy(axes)
        panel(axes, letter)
    figure.legend(loc="outside lower center", ncols=3, fontsize=6.0, frameon=False)
    figure.savefig(path, dpi=200)


def draw_errors(rows: list[dict[str, Any]], path: Path) -> None:
    """Estimate against true error, and the two measures of which the estimate is made."""
    figure = new_figure(PAGE, 2.7)
    names = (("estimate", "Error estimate"), ("variation", "Variation of the conserved quantity"),
             ("tail", "Coefficient tail"))  # fmt: skip
    rows = [row for row in rows if row["converged"]]
    true = np.maximum([row["natural"] for row in rows], 1e-16)
    size = np.array([row["size"] for row in rows])
    for axes, (name, label), letter in zip(figure.subplots(1, 3), names, "abc", strict=True):
        value = np.maximum([row[name] for row in rows], 1e-16)
        for each, colour in zip(sorted(set(size.tolist())), (VERMILLION, ORANGE, BLUE, PURPLE), strict=False):
            axes.loglog(value[size == each], true[size == each], ".", markersize=2.5, color=colour, label=f"{each}")
        axes.plot([1e-16, 1.0], [1e-16, 1.0], color=GREY, linewidth=0.8)
        axes.set(xlabel=label, xlim=(3e-17, 2.0), ylim=(3e-17, 2.0))
        tidy(axes, "upper left" if name == "estimate" else None, title="unknowns", title_fontsize=6.5)
        panel(axes, letter)
        if name == "estimate":
            axes.set_ylabel("True error")
    figure.savefig(path, dpi=200)

"""Fits of measured muscles: what is fitted, what is predicted, where the model fails. Writes README.md beside it.

    python validation/measured/measured.py ../shared/data

The folder holds the data as its own README describes them; they are other people's and not part of this repository.
"""

import argparse
import time
import warnings
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import mckibben as mk

HERE = Path(__file__).parent
Model = tuple[mk.Muscle, dict[str, Any], dict[str, Any]]


def part(data: mk.Data, names: set[str]) -> mk.Data:
    """The tests of those names."""
    return data.where(np.array([data.tests[k] in names for k in data.which]))


def fitted(title: str, data: mk.Data, models: dict[str, Model], training: set[str], picture: str) -> list[str]:
    """A section: every model fitted to the training tests, and its errors on the others."""
    lines = [f"## {title}", ""]
    known, unseen = part(data, training), part(data, set(data.tests) - training)
    shown = len(unseen.tests) <= 4
    heads = [f"{name}" for name in unseen.tests] if shown else []
    lines += [
        f"Fitted to {', '.join(known.tests)}; predicted: {', '.join(unseen.tests)}.", "",
        "Differences are rms, in N and in per cent of the range of a test's force; at the end those of all predicted "
        "points, in per cent of the largest force.", "",
        "| model | free numbers | rms, fitted | " + "".join(f"{head} | " for head in heads) + "all predicted | time |",
        "| --- | --- | --- | " + "--- | " * len(heads) + "--- | --- |",
    ]  # fmt: skip
    best: tuple[float, str, mk.Fit] | None = None
    details = []
    for name, (muscle, free, options) in models.items():
        begun = time.perf_counter()
        found = mk.fit(muscle, known, free, **options)
        took = time.perf_counter() - begun
        misses = found.forces(unseen) - unseen.force
        rms = float(np.sqrt(np.mean(misses**2)))
        cells = []
        for k, _ in enumerate(unseen.tests if shown else ()):
            some, force = misses[unseen.which == k], unseen.force[unseen.which == k]
            size = float(np.sqrt(np.mean(some**2)))
            cells.append(f"{size:.2f} N, {100 * size / np.ptp(force):.1f} %")
        share = 100 * rms / np.abs(data.force).max()
        lines.append(
            f"| {name} | {len(found.numbers)} | {found.rms:.2f} N | "
            + "".join(f"{cell} | " for cell in cells)
            + f"{rms:.2f} N, {share:.2f} % | {took:.1f} s |"
        )
        details += ["", f"**{name}**", "", "| number | value | error | 95 % interval |", "| --- | --- | --- | --- |"]
        details += [
            f"| `{one}` | {row['value']} | {row['error']} | {row['interval']} |" for one, row in found.table.iterrows()
        ]
        details += ["", *(f"- {note}" for note in found.notes if "taken" not in note)]
        if best is None or rms < best[0]:
            best = rms, name, found
        print(f"{title}: {name}: {found.rms:.2f} N fitted, {rms:.2f} N predicted, {took:.1f} s", flush=True)
    assert best is not None
    draw(data, best[2], training, f"{title}: {best[1]}", HERE / picture)
    return [*lines, "", f"![{best[1]}]({picture})", *details, ""]


def draw(data: mk.Data, found: mk.Fit, training: set[str], title: str, path: Path) -> None:
    """Measured points over the forces of the model; tests that were not fitted have open marks."""
    figure, axes = plt.subplots(figsize=(8.0, 5.0), layout="constrained")
    colours = plt.get_cmap("viridis")(np.linspace(0.0, 0.9, len(data.tests)))
    for name, colour in zip(data.tests, colours, strict=True):
        test = data[name]
        x, order = 1e3 * test.lengths(found.muscle), np.argsort(test.lengths(found.muscle), kind="stable")
        axes.plot(x[order], found.forces(test)[order], color=colour, lw=1.2)
        face = colour if name in training else "none"
        label = name if name in training else f"{name} (predicted)"
        axes.scatter(x, test.force, 14, facecolors=[face], edgecolors=[colour], label=label)
    axes.set(xlabel="length (mm)", ylabel="force (N)", title=title)
    axes.legend(fontsize=7, ncols=1 + len(data.tests) // 9, title="points: measured; lines: model")
    figure.savefig(path, dpi=110)
    plt.close(figure)


def home_made(folder: Path) -> list[str]:
    """The muscle of QuadSegrity, whose braid and tube nobody wrote down."""
    path = folder / "quadsegrity" / "big_isobaric.csv"
    data = mk.read_data(path, columns={"length": "length_mm_derived"}, tests="pressure")
    rigid = mk.Muscle(
        braid=mk.Braid(radius="8 mm", length="850 mm", angle="62 deg", fibres=48, fibre=mk.Fibre(**PLAIN)),
        chamber=mk.Chamber(thickness="1.5 mm", law=mk.NeoHookean(c1="150 kPa")),
    )
    stretching = rigid.replace("braid.fibre", mk.Fibre(**PLAIN, stretch=True, axial_stiffness="150 N"))
    free = {"braid.angle": "50 deg to 80 deg", "braid.radius": "5 mm to 30 mm", "chamber.law.c1": "1 kPa to 5 MPa"}
    length = {"braid.length": "600 mm to 1000 mm"}
    stiff = {"braid.fibre.axial_stiffness": "10 N to 5 kN"}
    models: dict[str, Model] = {
        "1. rigid fibres": (rigid, free, {}),
        "2. rigid fibres, rest length": (rigid, free | length, {}),
        "3. stretching fibres": (stretching, free | stiff, {}),
        "4. stretching fibres, rest length": (stretching, free | stiff | length, {}),
    }
    return fitted("A home-made muscle of 850 mm (QuadSegrity)", data, models, {"3 bar", "5 bar"}, "home_made.png")


PLAIN = {"diameter": "0.25 mm", "E": "3 GPa", "nu": 0.4}


def festo_map(folder: Path) -> list[str]:
    """The force map of a Festo DMSP-20-300."""
    path = folder / "martens_boblan" / "dmsp-20-300.csv"
    data = mk.read_data(path, columns={"length": "length_m"}, tests="pressure")
    data = data.where(data.force > 0.0)
    muscle = mk.presets.get("festo-dmsp-20").replace("chamber.law", mk.MooneyRivlin(c1="0.6 MPa", c2="0.01 MPa"))
    free = {
        "braid.angle": "24 deg to 32 deg", "chamber.law.c1": "50 kPa to 3 MPa", "chamber.law.c2": "0 Pa to 3 MPa",
        "braid.radius": "9 mm to 13 mm",
    }  # fmt: skip
    gives = muscle.replace("fittings", mk.Fittings(compliance="0.001 mm/N"))
    give = {"fittings.compliance": "1e-6 mm/N to 0.05 mm/N"}
    zero = {"offsets": {"pressure": "0.2 bar"}}
    models: dict[str, Model] = {
        "1. braid and wall": (muscle, free, {}),
        "2. ... and a pressure that is off": (muscle, free, zero),
        "3. ... and fittings that give way": (gives, free | give, zero),
    }
    training = set(data.tests[1::3])
    return fitted("Force map of a 20 mm membrane (Festo DMSP-20-300)", data, models, training, "festo_map.png")


def length_series(folder: Path) -> list[str]:
    """One make of membrane in six lengths, at one pressure: one set of numbers for all of them."""
    import pandas as pd

    table = pd.read_csv(folder / "festo_length" / "aarl_festo10mm_isometric.csv")
    made = mk.presets.get("festo-dmsp-10")
    lengths = [float(rest) for rest in dict.fromkeys(table["rest_length_mm"])]
    data = []
    for rest in lengths:
        rows = table[table["rest_length_mm"] == rest]
        columns = {"length [mm]": rows["held_length_mm"], "force [N]": rows["force_N_at_600kPa_filling"]}
        data.append(mk.read_data(pd.DataFrame(columns | {"pressure [kPa]": 600.0})))
    free = {
        "braid.angle": "18 deg to 34 deg", "braid.radius": "4 mm to 8 mm", "chamber.law.c1": "50 kPa to 3 MPa",
    }  # fmt: skip
    gives = made.replace("fittings", mk.Fittings(compliance="0.005 mm/N"))
    models: dict[str, tuple[mk.Muscle, dict[str, str]]] = {
        "1. rigid fittings": (made, free),
        "2. fittings that give way": (gives, free | {"fittings.compliance": "1e-4 mm/N to 0.05 mm/N"}),
    }
    heads = [f"{rest:g} mm" for rest in lengths]
    lines = [
        "## A 10 mm membrane in six lengths (Festo)", "",
        "One set of numbers for all lengths, at 600 kPa, filling. First fitted to all of them; then to every second "
        f"one ({', '.join(heads[::2])}), the others predicted. Differences are rms, in N, by length.", "",
        "| model | free numbers | fitted to | all | " + " | ".join(heads) + " | predicted |",
        "| --- | --- | --- | --- | " + "--- | " * len(heads) + "--- |",
    ]  # fmt: skip
    details = []
    for name, (muscle, numbers) in models.items():
        muscles = [muscle.replace("braid.length", f"{rest} mm") for rest in lengths]
        for known, said in ((slice(None), "all"), (slice(None, None, 2), "every second")):
            found = mk.fit(muscles[known], data[known], numbers)
            misses = [_misses(found.applied_to(one), points) for one, points in zip(muscles, data, strict=True)]
            unseen = [] if said == "all" else misses[1::2]
            cells = [f"{_rms(one):.1f}" for one in misses]
            lines.append(
                f"| {name} | {len(numbers)} | {said} | {_rms(np.concatenate(misses)):.1f} | {' | '.join(cells)} | "
                f"{f'{_rms(np.concatenate(unseen)):.1f} N' if unseen else '-'} |"
            )
            print(lines[-1], flush=True)
            if said == "all":
                details += [
                    "",
                    f"**{name}**",
                    "",
                    "| number | value | error | 95 % interval |",
                    "| --- | --- | --- | --- |",
                ]
                details += [
                    f"| `{one}` | {row['value']} | {row['error']} | {row['interval']} |"
                    for one, row in found.table.iterrows()
                ]
                details += ["", *(f"- {note}" for note in found.notes if "taken" not in note)]
    figure = mk.plot(found)
    figure.savefig(HERE / "length_series.png", dpi=130)
    return [*lines, "", "![fitted to every second length](length_series.png)", *details, ""]


def _misses(muscle: mk.Muscle, data: mk.Data) -> np.ndarray:
    states = [mk.solve(muscle, length=h, pressure=P).force for h, P in zip(data.length, data.pressure, strict=True)]
    return np.array(states) - data.force


def _rms(misses: np.ndarray) -> float:
    return float(np.sqrt(np.mean(misses**2)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    warnings.simplefilter("ignore", mk.MuscleWarning)
    lines = [
        "# Measured muscles", "",
        "Written by `python validation/measured/measured.py FOLDER`, where FOLDER holds the data; do not edit.", "",
        "Forces of the home-made muscle: QuadSegrity (GitHub martantoine/QuadSegrity, MIT licence); its braid and tube "
        "are not known.",
        "Map of the membrane: M. Martens, I. Boblan, Actuators 2017, 6, 33, Table A1 (CC BY 4.0); points of 0 N, slack "
        "or not reached, are left out.",
        "Length series: facts reduced from GitHub Agile-and-Adaptive-Robotics/Muscle_Sensory; the zero of its load "
        "cell (up to -9 N) is not corrected.", "",
        *home_made(folder), *festo_map(folder), *length_series(folder),
    ]  # fmt: skip
    (HERE / "README.md").write_text("\n".join(lines).rstrip() + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()

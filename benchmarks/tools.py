"""What is built on curves: fits, designs, maps, motion, and muscles that rub or whose tube is smaller than the braid.

Ratios are to following one curve of 21 states; what each is asked to take is in the row's name.
"""

import tempfile
import time
from pathlib import Path
from typing import Any

import attrs
import numpy as np
import pandas as pd
from curve import MUSCLE
from timing import once, timed

import mckibben as mk

CURVE = 21
"""States of the curve that ratios are to."""
SIMULATIONS = 1000


def measure() -> list[dict[str, Any]]:
    """Everything, in some three minutes."""
    return [*fits(), *designs(), *maps(), *effects()]


def row(name: str, times: dict[str, Any]) -> dict[str, Any]:
    return {"name": name, "states": CURVE, "error": None, **times}


def fits() -> list[dict[str, Any]]:
    """Five numbers fitted to four curves of 40 points with noise, and their intervals by profiles."""
    rng, curves = np.random.default_rng(0), []
    for pressure in (0.4, 0.6, 0.8, 1.0):
        curve = mk.run(MUSCLE, mk.Isobaric(length="85 mm to 112 mm", pressure=f"{pressure} bar", points=40))
        curves.append(np.stack([curve.length, curve.pressure, curve.force + rng.normal(0.0, 0.3, 40)], axis=1))
    length, pressure, force = np.concatenate(curves).T
    data = mk.read_data(pd.DataFrame({"length [m]": length, "pressure [Pa]": pressure, "force [N]": force}))
    free = {
        "braid.angle": "34 deg to 40 deg", "braid.radius": "11 mm to 14 mm", "chamber.law.c1": "4 kPa to 40 kPa",
        "braid.fibre.E": "1 GPa to 10 GPa",
    }  # fmt: skip
    offsets = {"force": "1 N"}

    def call(**options: Any) -> Any:
        return mk.fit(MUSCLE, data, free, offsets=offsets, **options)

    return [
        row("fit of five numbers to four curves of 40 points (asked 2 s)", timed(lambda: call(profiles=False), 3)),
        row("the same with intervals by profiles (asked 20 s)", timed(lambda: call(profiles=True), 2)),
    ]


def designs() -> list[dict[str, Any]]:
    """The design of examples/design_muscle.py, and a front of two goals over 20,000 designs."""
    fibre = mk.Fibre(diameter="0.25 mm", E="3 GPa", nu=0.4, breaking_force="10 N")
    braid = mk.Braid(radius="6 mm", length="200 mm", angle="65 deg", fibres=96, fibre=fibre)
    muscle = mk.Muscle(
        braid=braid, chamber=mk.Chamber(thickness="1 mm", lies="inside", law=mk.NeoHookean(c1="0.15 MPa"))
    )
    free = {"braid.angle": "55 deg to 70 deg", "braid.radius": "2 mm to 10 mm", "braid.fibres": "30 to 160"}
    at, limits = {"pressure": "4 bar"}, [mk.Diameter(pressure="4 bar") <= "30 mm"]

    def one() -> Any:
        return mk.design(
            muscle,
            free=free | {"chamber.thickness": "0.4 mm to 1.2 mm"},
            objective=mk.Minimise(mk.Mass(fibre_density="1380 kg/m^3", chamber_density="1100 kg/m^3")),
            subject_to=[
                mk.ForceAt(**at, contraction="10 %") >= "150 N", mk.Stroke(**at) >= "20 %", *limits,
                mk.FibreSafety(**at) >= 3,
            ],
            designs=1000,
        )  # fmt: skip

    def front() -> Any:
        goals = [mk.Maximise(mk.ForceAt(**at, contraction="10 %")), mk.Maximise(mk.Stroke(**at))]
        return mk.design(muscle, free=free, objective=goals, subject_to=limits, designs=20_000)

    return [
        row("design of examples/design_muscle.py (asked 30 s)", timed(one, 1)),
        row("front of two goals, 20,000 designs (asked 60 s)", once(front)[0]),
    ]


def maps() -> list[dict[str, Any]]:
    """A map, motions on it, and the same as an FMU."""
    about = {"length": "60 mm to 115 mm", "pressure": "0 to 3 bar"}
    times = timed(lambda: mk.chart(MUSCLE, **about), 2)
    chart = mk.chart(MUSCLE, **about)
    rig = mk.Rig(
        muscle=MUSCLE, load=mk.Load(mass="2 kg", damping="20 N s/m", stop_high="110 mm"),
        supply=mk.Supply(gauge="2 bar"),
        valve=mk.Valve(C="0.05 L/(s bar)", b=0.3), command=mk.Jump(1.0, at="0.1 s"), tube="5 mL",
    )  # fmt: skip
    masses = np.linspace(1.0, 3.0, SIMULATIONS).tolist()
    many = [attrs.evolve(rig, load=attrs.evolve(rig.load, mass=mass)) for mass in masses]
    rows = [
        row("map to 1e-4 of its largest force (asked 3 s)", times),
        row("1 s of a valve, a muscle and a mass (asked 50 ms)",
            timed(lambda: mk.simulate(rig, until="1 s", chart=chart), 5)),
        row(f"{SIMULATIONS:,} such simulations, two processes (asked 20 s)",
            once(lambda: mk.simulate_many(many, until="1 s", chart=chart))[0]),
    ]  # fmt: skip
    return rows + fmu(chart)


def fmu(chart: Any) -> list[dict[str, Any]]:
    """An FMU with mass and valve, run by FMPy in steps of 10 ms; shorter ones time FMPy's calls, 1.4 µs each."""
    import fmpy

    with tempfile.TemporaryDirectory() as folder:
        path = mk.export(chart, Path(folder) / "lift.fmu", name="lift", mass="2 kg")
        described = fmpy.read_model_description(str(path))
        number = {variable.name: variable.valueReference for variable in described.modelVariables}
        lift = fmpy.instantiate_fmu(fmpy.extract(str(path), folder), described, "CoSimulation")
        lift.setupExperiment()
        names = ("pressure_start", "supply", "conductance", "command")
        lift.setReal([number[name] for name in names], [0.2e5, 2e5, 1e-9, 1.0])
        lift.enterInitializationMode()
        lift.exitInitializationMode()
        times = []
        for k in range(20):
            start, used = time.perf_counter(), time.process_time()
            for step in range(10):
                lift.doStep(1e-2 * (10 * k + step), 1e-2)
            times.append((time.perf_counter() - start, time.process_time() - used))
        lift.terminate()
        lift.freeInstance()
    clock, processor = (sorted(column) for column in zip(*times, strict=True))
    middle = {"median_s": clock[10], "least_s": clock[0], "processor_s": processor[10], "repeats": len(times)}
    name = f"0.1 s of an FMU with mass and valve: {0.1 / clock[10]:.0f} times real time (asked 1,000)"
    return [row(name, middle)]


def effects() -> list[dict[str, Any]]:
    """Curves of a muscle whose crossings rub, and of one whose tube is smaller than its braid."""
    test = mk.Isobaric(length="90 mm to 115 mm", pressure="1 bar", points=CURVE)
    filled = mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=CURVE)
    hanging = mk.Isotonic(force="10 N", pressure="0.2 bar to 1 bar", points=CURVE)
    rubbing = MUSCLE.replace("friction", mk.Friction(coefficient=0.3, arm="0.1 mm", constant="0.01 N mm"))
    tube = mk.Chamber(
        outer_diameter="20 mm", inner_diameter="18 mm", gap=True, law=mk.MooneyRivlin(c1="40 kPa", c2="4 kPa")
    )
    loose = MUSCLE.replace("chamber", tube)
    pressed = mk.Isometric(length="85 mm", pressure="0 to 2 bar", points=CURVE)
    return [
        row("mk.run in full, isobaric", timed(lambda: mk.run(MUSCLE, test), 5)),
        row("mk.run in full, isobaric, with friction", timed(lambda: mk.run(rubbing, test), 5)),
        row("mk.run in full, filled from rest", timed(lambda: mk.run(MUSCLE, filled), 5)),
        row("mk.run in full, filled from rest, with friction", timed(lambda: mk.run(rubbing, filled), 5)),
        row("mk.run in full, isotonic", timed(lambda: mk.run(MUSCLE, hanging), 5)),
        row("mk.run in full, isotonic, with friction", timed(lambda: mk.run(rubbing, hanging), 5)),
        row("mk.run in full, a tube that comes to touch", timed(lambda: mk.run(loose, pressed, tolerance=1e-4), 3)),
    ]

"""A muscle as an FMU for other simulators: with a mass on it and a valve, run here by FMPy.

The FMU is compiled from C and needs no Python. To write it takes a C compiler, to run it here `pip install fmpy`.
"""

import sys
from pathlib import Path

import mckibben as mk

try:
    import fmpy
except ImportError:
    print("skipped: FMPy is missing, which would run the FMU: pip install fmpy")
    sys.exit()

out = Path("out")
out.mkdir(exist_ok=True)
muscle, weight = mk.presets.paper(), 2.0 * 9.80665

chart = mk.chart(muscle, length="60 mm to 115 mm", pressure="0 to 3 bar")
try:
    mk.export(chart, out / "muscle.fmu", force=True)  # pressure and length in, force and more out
    path = mk.export(chart, out / "lift.fmu", name="lift", mass="2 kg", force=True)
except mk.SpecError as error:
    print(f"skipped: {error}")
    sys.exit()

# 2 kg at 0.2 bar; from 0.1 s on a valve of 0.1 L/s/bar fills the muscle from a supply of 2 bar
described = fmpy.read_model_description(str(path))
number = {variable.name: variable.valueReference for variable in described.modelVariables}
lift = fmpy.instantiate_fmu(fmpy.extract(str(path)), described, "CoSimulation")
lift.setupExperiment()
lift.setReal([number[name] for name in ("pressure_start", "supply", "conductance")], [0.2e5, 2e5, 1e-9])
lift.enterInitializationMode()
lift.exitInitializationMode()
seen = []
for k in range(1500):
    lift.setReal([number["command"]], [1.0 if k >= 100 else 0.0])
    lift.doStep(1e-3 * k, 1e-3)
    seen.append(lift.getReal([number[name] for name in ("length", "pressure", "air_mass")]))
lift.freeInstance()

for t in (0.1, 0.2, 1.5):
    length, pressure, _ = seen[round(1e3 * t) - 1]
    print(f"after {t} s: {1e3 * length:.2f} mm at {1e-5 * pressure:.3f} bar")
print(f"the map says {1e3 * chart.length_for(seen[99][1], weight):.2f} mm at the start")
print(f"and {1e3 * chart.length_for(seen[-1][1], weight):.2f} mm at the end")
print(f"{1e3 * (seen[-1][2] - seen[0][2]):.3f} g of air")

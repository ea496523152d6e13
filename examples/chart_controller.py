"""A map for a controller: which pressure pulls a force at a length, how stiff the muscle is, and the same in C.

The controller knows the length of the muscle and the force that it is to pull. It asks the map for the pressure.
"""

from pathlib import Path

import mckibben as mk

muscle = mk.presets.paper()
out = Path("out")
out.mkdir(exist_ok=True)

chart = mk.chart(muscle, length="60 mm to 115 mm", pressure="0 to 3 bar")
print(f"force to {1e3 * chart.force_error:.1f} mN of {chart.largest_force:.1f} N")

for length in ("90 mm", "100 mm", "110 mm"):
    pressure = chart.pressure_for(length, "40 N")
    stiffness = chart.stiffness(length, pressure)
    print(f"40 N at {length}: {1e-5 * pressure:.3f} bar, stiffness {1e-3 * stiffness:.3f} N/mm")

pressure = float(chart.pressure_for("100 mm", "40 N"))
state = mk.solve(muscle, length="100 mm", pressure=pressure)
print(f"the solver says {state.force:.2f} N")
print(f"free at 1 bar: {1e3 * chart.free_length('1 bar'):.2f} mm")

mk.save(chart, out / "chart.nc", force=True)
mk.export(chart, out / "muscle.h", force=True)  # for the controller: muscle_force(length, pressure), ...
mk.plot(chart).savefig(out / "chart.png", dpi=200)

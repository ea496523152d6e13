"""A valve sized: which conductance lifts a weight within a quarter of a second, and what a smaller valve does.

Writes out/size_a_valve.png.
"""

from pathlib import Path

from matplotlib.figure import Figure

import mckibben as mk

rig = mk.Rig(
    muscle=mk.presets.paper(),
    load=mk.Load(mass="5 kg", damping="40 N s/m", stop_high="110 mm"),
    supply=mk.Supply(gauge="2 bar"),
    valve=mk.Valve(C="1 L/(s bar)", b=0.3, delay="10 ms"),
    command=1.0,
    tube="10 mL",
)
filled = mk.size_valve(rig, within="0.25 s", pressure="1.5 bar")
print(f"to fill: {filled}")
full = mk.Rig(muscle=rig.muscle, load=rig.load, supply=rig.supply, valve=rig.valve, tube="10 mL", pressure="1.5 bar")
vented = mk.size_valve(full, within="0.25 s", pressure="0.2 bar", vent=True)
print(f"to vent: C = {1e8 * vented.valve.venting:.3f} L/s/bar")

figure = Figure(figsize=(3.5, 2.6), layout="constrained")
axes = figure.subplots()
for part in (1.0, 0.5, 0.2):
    valve = mk.Valve(C=part * filled.valve.C, b=0.3, delay="10 ms")
    made = mk.Rig(muscle=rig.muscle, load=rig.load, supply=rig.supply, valve=valve, command=1.0, tube="10 mL")
    motion = mk.simulate(made, until="1 s")
    length, reached = 1e3 * motion.length, motion.time[motion.pressure >= 1e5][0]
    print(f"{100 * part:.0f} % of it: 1 bar after {reached:.3f} s, {length[-1]:.2f} mm after 1 s")
    axes.plot(motion.time, length, label=f"{100 * part:.0f} %")
axes.set_xlabel("Time (s)")
axes.set_ylabel("Length (mm)")
figure.legend(title="Conductance", frameon=False, ncols=3, loc="outside lower center")
Path("out").mkdir(exist_ok=True)
figure.savefig("out/size_a_valve.png", dpi=200)
print("out/size_a_valve.png")

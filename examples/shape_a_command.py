"""A command over time that lifts a weight along a smooth curve, found by derivatives through the motion.

The command is a series of values with straight lines between them; least squares by SciPy, with exact derivatives of
the length by each value. Writes out/shape_a_command.png.
"""

from pathlib import Path

import attrs
import jax
import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import least_squares

import mckibben as mk

END, POINTS = 0.8, 41
muscle = mk.presets.paper()
chart = mk.chart(muscle, length="60 mm to 115 mm", pressure="0 to 3 bar")
rig = mk.Rig(
    muscle=muscle,
    load=mk.Load(mass="2 kg", damping="20 N s/m", start="92 mm", stop_high="92 mm"),  # it stands on the floor at first
    supply=mk.Supply(gauge="2.5 bar"),
    valve=mk.Valve(C="0.1 L/s/bar", b=0.3),
    pressure="0.3 bar",
)

time = np.linspace(0.0, END, POINTS)
share = np.clip((time - 0.15) / 0.5, 0.0, 1.0)
wanted = 0.092 - 0.006 * share**3 * (10.0 - 15.0 * share + 6.0 * share**2)  # m: as little jerk as can be
places = np.linspace(0.0, END, 13)


def lifted(values, of="length"):
    command = mk.Series(time=places, value=tuple(values))
    return mk.motion_response(attrs.evolve(rig, command=command), END, chart=chart, points=POINTS)[of]


def miss(values):
    return 1e3 * (np.asarray(lifted(values)) - wanted)  # mm


def slopes(values):
    return 1e3 * np.asarray(jax.jacfwd(lifted)(values))


first = np.full(len(places), 0.2)
found = least_squares(miss, first, slopes, bounds=(-1.0, 1.0), max_nfev=40)
before, after = (float(np.sqrt(np.mean(miss(values) ** 2))) for values in (first, found.x))
print(f"a constant command of {first[0]:g} is off by {before:.2f} mm on the average, the one found by {after:.3f} mm")
print(f"{found.njev} derivatives of {POINTS} lengths by {len(places)} values")
motion = mk.simulate(attrs.evolve(rig, command=mk.Series(time=places, value=tuple(found.x))), END, chart=chart)
print(
    f"largest speed {1e3 * np.abs(motion.data.speed.values).max():.1f} mm/s, {motion.consumed:.3f} normal litres of air"
)

figure, (top, middle, bottom) = plt.subplots(3, 1, sharex=True, figsize=(5.0, 5.5), layout="constrained")
top.plot(time, 1e3 * wanted, color="0.7", linewidth=5.0, label="wanted")
top.plot(time, 1e3 * np.asarray(lifted(first)), ":", color="C1", label="constant command")
top.plot(motion.time, 1e3 * motion.length, color="C0", label="command found")
top.set_ylabel("length (mm)")
top.legend(fontsize="small")
middle.plot(motion.time, 1e-5 * motion.data.pressure.values, color="C0")
middle.set_ylabel("pressure (bar)")
bottom.axhline(0.0, color="0.8", linewidth=0.8)
bottom.plot(places, first, ":", color="C1")
bottom.plot(places, found.x, "o-", color="C0", markersize=3.5)
bottom.set(ylabel="command (1)", xlabel="time (s)")
bottom.text(0.99, 0.95, "1 fills, -1 vents", transform=bottom.transAxes, ha="right", va="top", fontsize="small")
Path("out").mkdir(exist_ok=True)
figure.savefig("out/shape_a_command.png", dpi=200)
print("out/shape_a_command.png")

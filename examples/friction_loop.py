"""Hysteresis by friction where fibres cross: force over length at one pressure, there and back, with a minor loop.

Prints what each turn of the loop costs. Writes out/friction_loop.png.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import mckibben as mk

muscle = mk.presets.paper()
rubbing = muscle.replace("friction", mk.Friction(coefficient=0.3, arm="0.1 mm", constant="0.01 N mm"))

legs = [(90.0, 115.0), (115.0, 95.0), (95.0, 103.0), (103.0, 95.0), (95.0, 90.0), (90.0, 115.0)]
lengths = np.concatenate([[90.0], *(np.linspace(a, b, 41)[1:] for a, b in legs)])  # mm
loop = mk.run(rubbing, mk.Isobaric(pressure="1 bar", length=(1e-3 * lengths).tolist()))
free = mk.run(muscle, mk.Isobaric(pressure="1 bar", length="90 mm to 115 mm", points=26))

lost = 1e3 * loop.data["dissipated"].values
print(f"minor loop  95 to 103 mm: {lost[4 * 40] - lost[2 * 40]:6.2f} mJ lost")
print(f"whole loop  90 to 115 mm: {lost[-1] - lost[40]:6.2f} mJ lost, the minor loop included")

figure, axes = plt.subplots(figsize=(5.0, 3.6), layout="constrained")
axes.plot(lengths, loop.force, label="with friction")
axes.plot(1e3 * free.length, free.force, "--", color="0.5", label="without")
axes.set(xlabel="length [mm]", ylabel="force [N]", title="1 bar")
axes.legend()
Path("out").mkdir(exist_ok=True)
figure.savefig("out/friction_loop.png", dpi=200)
print("out/friction_loop.png")

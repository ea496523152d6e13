"""A tube that is smaller than its sleeve, blown up alone until it touches: the dead zone of a home-made muscle.

Held at a length, the muscle pulls no more for its pressure until the tube has come to the braid. Writes out/gap.png.
"""

import warnings
from pathlib import Path

import matplotlib.pyplot as plt

import mckibben as mk

tube = mk.Chamber(outer_diameter="20 mm", inner_diameter="18 mm", law=mk.NeoHookean(c1="150 kPa"), gap=True)
muscle = mk.presets.paper().replace("chamber", tube)
zone = mk.dead_zone(muscle, length="95 mm")
print(f"at 95 mm it touches from {zone.begins / 1e5:.4f} bar, and everywhere from {zone.ends / 1e5:.4f} bar")

test = mk.Isometric(length="95 mm", pressure="0 to 0.24 bar", points=13)
blown = mk.run(muscle, test, tolerance=5e-5)
warnings.simplefilter("ignore", mk.MuscleWarning)  # that a tube held to the braid has no dead zone is the point here
held = mk.run(muscle.replace("chamber.gap", False), test, tolerance=5e-5)
forces = ", ".join(f"{blown.force[k]:.3f} N at {blown.pressure[k] / 1e5:.2f} bar" for k in (0, 6, 10))
print(f"it pulls with {forces}")

figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 3.2), layout="constrained")
left.axvspan(zone.begins / 1e5, zone.ends / 1e5, color="0.9", label="begins to touch")
left.plot(blown.pressure / 1e5, blown.force, "o-", markersize=3, label="tube with a gap")
left.plot(held.pressure / 1e5, held.force, "--", label="tube held to the braid")
left.set(xlabel="pressure [bar]", ylabel="force [N]", title="95 mm")
left.legend(loc="lower right")
for k in (0, 6, 8):
    radius, gap = (1e3 * blown.data[name].values[k] for name in ("r", "gap"))
    (line,) = right.plot(1e3 * blown.data["z"].values[k], radius - gap, label=f"{blown.pressure[k] / 1e5:.2f} bar")
    right.plot(1e3 * blown.data["z"].values[k], radius, ":", color=line.get_color())
right.set(xlabel="axis [mm]", ylabel="radius of tube (solid), braid [mm]")
right.legend()
Path("out").mkdir(exist_ok=True)
figure.savefig("out/gap.png", dpi=200)
print("out/gap.png")

"""Fittings that are narrower than the braid, at one end or at both: what a short muscle makes of them.

The braid is made as a cylinder and pushed over them, so that it is strained before any load. Writes
out/tapered_fittings.png.
"""

from pathlib import Path

import matplotlib.pyplot as plt

import mckibben as mk

short = mk.presets.paper().replace("braid.length", "60 mm")
muscles = {  # one radius would do where both ends have it, on half the length
    "of the braid's radius": short.replace("end_radii", ["12.5 mm", "12.5 mm"]),
    "9 mm at one end": short.replace("end_radii", ["12.5 mm", "9 mm"]),
    "9 mm at both": short.replace("end_radii", ["9 mm", "9 mm"]),
}
test = mk.Isobaric(pressure="1 bar", length="72 mm to 48 mm", points=13)

figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 3.2), layout="constrained")
for number, (name, muscle) in enumerate(muscles.items()):
    curve = mk.run(muscle, test)
    middle = int(abs(curve.length - 0.06).argmin())
    print(f"fittings {name}: {curve.force[middle]:.2f} N at 60 mm")
    left.plot(1e3 * curve.length, curve.force, label=name)
    z, r = (1e3 * curve.data[key].values[middle] for key in ("z", "r"))
    for side in (-1.0, 1.0):
        right.plot(z, side * r, color=f"C{number}")
left.set(xlabel="length [mm]", ylabel="force [N]", title="1 bar")
left.legend(title="fittings")
right.set(xlabel="axis [mm]", ylabel="radius [mm]", title="60 mm, 1 bar", aspect="equal")
Path("out").mkdir(exist_ok=True)
figure.savefig("out/tapered_fittings.png", dpi=200)
print("out/tapered_fittings.png")

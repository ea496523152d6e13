"""Fibres that stiffen as they are bent: the last step that the paper names, beyond its quadratic energy.

From some curvature on the energy of bending and twist grows faster than its square. Most of it is near the fittings, so
that the shape there changes, and the force of a muscle that is pushed together. Writes out/stiffening_fibres.png.
"""

from pathlib import Path

import matplotlib.pyplot as plt

import mckibben as mk

quadratic = mk.presets.paper().replace("braid.fibre.diameter", "0.4 mm")
muscles = {
    "quadratic, as in the paper": quadratic,
    "stiffening from 60 1/m": quadratic.replace("braid.fibre.stiffening", mk.Stiffening(curvature="60 1/m")),
    "stiffening from 30 1/m": quadratic.replace("braid.fibre.stiffening", mk.Stiffening(curvature="30 1/m")),
}
test = mk.Isobaric(pressure="0.5 bar", length="115 mm to 60 mm", points=23)

figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 3.2), layout="constrained")
for number, (name, muscle) in enumerate(muscles.items()):
    curve = mk.run(muscle, test)
    print(f"{name}: {curve.force[0]:.2f} N at 115 mm, {curve.force[-1]:.2f} N at 60 mm")
    left.plot(1e3 * curve.length, curve.force, label=name)
    z, r = (1e3 * curve.data[key].values[-1] for key in ("z", "r"))
    right.plot(z, r, color=f"C{number}")
left.set(xlabel="length [mm]", ylabel="force [N]", title="0.5 bar, fibres of 0.4 mm (assumed)")
left.legend(fontsize="small")
right.set(xlabel="axis [mm]", ylabel="radius [mm]", title="60 mm, 0.5 bar")
Path("out").mkdir(exist_ok=True)
figure.savefig("out/stiffening_fibres.png", dpi=200)
print("out/stiffening_fibres.png")

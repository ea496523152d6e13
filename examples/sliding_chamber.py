"""A loose tube in a sleeve: it slides along the mesh until it is pressed to it, and is then held by friction.

The muscle is pulled long without pressure, when the tube lies loose and evenly stretched, and filled. Where it sticks
and where it slides, and the shear between tube and mesh, along the length. Writes out/sliding_chamber.png.
"""

from pathlib import Path

import matplotlib.pyplot as plt

import mckibben as mk

tube = mk.Chamber(outer_diameter="20 mm", inner_diameter="18 mm", law=mk.NeoHookean(c1="50 kPa"), gap=True)
muscle = mk.presets.paper().replace("chamber", tube)
rubbing = muscle.replace("friction", mk.Friction(chamber_coefficient=0.3))
test = mk.Isometric(length="105 mm", pressure=["0 bar", "0.25 bar", "0.5 bar", "1 bar"])

held, curve = (mk.run(one, test, tolerance=1e-2) for one in (muscle, rubbing))
for k, pressure in enumerate(curve.pressure):
    forces = f"{held.force[k]:.3f} N if the tube follows the mesh, {curve.force[k]:.3f} N if it slides"
    print(f"{1e-5 * pressure:.2f} bar: {forces}")
print(f"lost by sliding: {1e3 * float(curve.data['dissipated'].values[-1]):.3f} mJ")

figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 3.2), layout="constrained")
for k, pressure in enumerate(curve.pressure):
    z, slide, shear = (curve.data[name].values[k] for name in ("z", "slide", "shear_stress"))
    left.plot(1e3 * z, 1e3 * slide, label=f"{1e-5 * pressure:g} bar")
    right.plot(1e3 * z, 1e-3 * shear)
left.set(xlabel="axis [mm]", ylabel="slide of the tube [mm]", title="105 mm, friction 0.3 (assumed)")
left.legend(fontsize="small")
right.set(xlabel="axis [mm]", ylabel="shear stress [kPa]", title="between tube and mesh")
Path("out").mkdir(exist_ok=True)
figure.savefig("out/sliding_chamber.png", dpi=200)
print("out/sliding_chamber.png")

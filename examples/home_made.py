"""A home-made muscle with everything that matters: a PET sleeve, a smaller tube, fibres that stretch and rub.

It lifts a weight, is filled to 3 bar and vented. The rubber is known by its hardness alone and the friction is a guess;
both are marked as assumed. Writes out/home_made.png.
"""

import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import mckibben as mk

warnings.simplefilter("ignore", mk.MuscleWarning)  # at low pressure the tube does not touch the sleeve yet

fibre = mk.Fibre(diameter="0.25 mm", E="3 GPa", nu=0.4, stretch=True)
sleeve = mk.Braid(
    radius=mk.centre_radius(inner_diameter="10 mm", fibre_diameter="0.25 mm"),
    length="200 mm",
    angle="65 deg",
    fibres=48,
    fibre=fibre,
)
tube = mk.Chamber(outer_diameter="8 mm", inner_diameter="6 mm", wall="thick", law=mk.Rubber(shore="35A"))
friction = mk.Friction(coefficient=0.3, arm="0.1 mm")  # what measured loops of a Festo muscle need
muscle = mk.Muscle(
    braid=sleeve,
    chamber=tube,
    friction=friction,
    name="home-made",
    assumed=("friction.coefficient", "friction.arm"),
)

up, down = np.linspace(1.0, 3.0, 9), np.linspace(3.0, 1.0, 9)[1:]
pressures = np.concatenate([up, down])  # bar
weight = mk.run(muscle, mk.Isotonic(force="20 N", pressure=[f"{bar} bar" for bar in pressures]))
contraction, filled = 100.0 * weight.contraction, len(up)

print(f"at 3 bar the weight of 20 N is up by {contraction[filled - 1]:.2f} % of the length")
print(f"at 2 bar: {contraction[4]:.2f} % as it is filled, {contraction[12]:.2f} % as it is vented")
print("assumed:", ", ".join(muscle.assumed))

figure, axes = plt.subplots(figsize=(5.0, 3.4), layout="constrained")
axes.plot(pressures[:filled], contraction[:filled], "o-", ms=3, label="filled")
axes.plot(pressures[filled - 1 :], contraction[filled - 1 :], "s--", ms=3, label="vented")
axes.set(xlabel="pressure [bar]", ylabel="contraction [%]", title="Home-made muscle, 20 N (rubber, friction assumed)")
axes.legend()
Path("out").mkdir(exist_ok=True)
figure.savefig("out/home_made.png", dpi=200)
print("out/home_made.png")

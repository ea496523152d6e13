"""Crossings that are glued flat or free to roll: what the joints of the fibres make of a muscle's force.

With hinges the sections of the fibres stay with the surface; with pins they roll about their fibre to where they bend
least. It matters where fibres carry much of the load by bending: here thick ones, without pressure. Writes
out/pinned_crossings.png.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import mckibben as mk

thick = mk.presets.paper().replace("braid.fibre.diameter", "0.6 mm")
muscles = {joint: thick.replace("braid.joint", joint) for joint in ("hinge", "pin")}
test = mk.Isobaric(pressure="0.1 bar", length="120 mm to 60 mm", points=25)

figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 3.2), layout="constrained")
for joint, muscle in muscles.items():
    curve = mk.run(muscle, test)
    print(f"{joint}: {curve.force[0]:.2f} N at 120 mm, {curve.force[-1]:.2f} N at 60 mm")
    left.plot(1e3 * curve.length, curve.force, label=joint)
    if joint == "pin":
        for state in (0, len(curve) - 1):
            z, roll = (curve.data[name].values[state] for name in ("z", "roll"))
            label = f"{1e3 * curve.length[state]:.0f} mm"
            right.plot(1e3 * z, np.degrees(roll), color=f"C{2 + bool(state)}", label=label)
        print(f"the sections roll by up to {np.degrees(abs(curve.data['roll'].values).max()):.1f} deg")
left.set(xlabel="length [mm]", ylabel="force [N]", title="0.1 bar, fibres of 0.6 mm (assumed)")
left.legend(title="crossings")
right.set(xlabel="axis [mm]", ylabel="roll of the sections [deg]", title="pins")
right.legend(title="length")
Path("out").mkdir(exist_ok=True)
figure.savefig("out/pinned_crossings.png", dpi=200)
print("out/pinned_crossings.png")

"""The lightest muscle that does what is wanted: 150 N at 10 % contraction and 20 % free stroke, within 30 mm and 4 bar.

Its fibres are to be safe by 3. Free are the braid (angle, radius, number of fibres) and the chamber's wall. The same
from a file: mckibben design examples/design.toml. Writes out/design.png. The stiffness of the rubber and the strength
of the fibres are assumed.
"""

from pathlib import Path

import mckibben as mk

fibre = mk.Fibre(diameter="0.25 mm", E="3 GPa", nu=0.4, breaking_force="10 N")
braid = mk.Braid(radius="6 mm", length="200 mm", angle="65 deg", fibres=96, fibre=fibre)
chamber = mk.Chamber(thickness="1 mm", lies="inside", law=mk.NeoHookean(c1="0.15 MPa"))
muscle = mk.Muscle(
    braid=braid, chamber=chamber, name="gripper drive",
    assumed=("braid.fibre.E", "braid.fibre.breaking_force", "chamber.law.c1"),
)  # fmt: skip

best = mk.design(
    muscle,
    free={
        "braid.angle": "55 deg to 70 deg",
        "braid.radius": "2 mm to 10 mm",
        "braid.fibres": "30 to 160",
        "chamber.thickness": "0.4 mm to 1.2 mm",
    },
    objective=mk.Minimise(mk.Mass(fibre_density="1380 kg/m^3", chamber_density="1100 kg/m^3")),
    subject_to=[
        mk.ForceAt(pressure="4 bar", contraction="10 %") >= "150 N",
        mk.Stroke(pressure="4 bar") >= "20 %",
        mk.Diameter(pressure="4 bar") <= "30 mm",
        mk.FibreSafety(pressure="4 bar") >= 3,
    ],
    designs=1000,
)

for name, row in best.table.iterrows():
    print(f"{name}: {row['value']} (searched: {row['searched']})")
for goal, value in best.goals.items():
    print(f"{goal}: {1e3 * value:.3f} g")
for _, row in best.limits.iterrows():
    print(f"{row['limit']}: {row['value']}")
for note in best.notes:
    print("-", note)

Path("out").mkdir(exist_ok=True)
mk.plot(best).savefig("out/design.png", dpi=200)
print("out/design.png")

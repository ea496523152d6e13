"""Stroke against force: the muscles of which none is better at both, within 30 mm at 6 bar and with safe fibres.

A steeper braid contracts farther, but pulls harder at its fibres, so it must be thinner and is weaker. Needs pymoo (the
extra "optimise"). Writes out/design_front.png. The stiffness of the rubber and the strength of the fibres are assumed.
"""

from pathlib import Path

import mckibben as mk

fibre = mk.Fibre(diameter="0.25 mm", E="3 GPa", nu=0.4, breaking_force="10 N")
braid = mk.Braid(radius="6 mm", length="200 mm", angle="65 deg", fibres=96, fibre=fibre)
chamber = mk.Chamber(thickness="0.5 mm", lies="inside", law=mk.NeoHookean(c1="0.15 MPa"))
muscle = mk.Muscle(
    braid=braid, chamber=chamber, name="gripper drive",
    assumed=("braid.fibre.E", "braid.fibre.breaking_force", "chamber.law.c1"),
)  # fmt: skip

best = mk.design(
    muscle,
    free={"braid.angle": "55 deg to 75 deg", "braid.radius": "2 mm to 10 mm", "braid.fibres": "60 to 240"},
    objective=[mk.Maximise(mk.ForceAt(pressure="6 bar", contraction="10 %")), mk.Maximise(mk.Stroke(pressure="6 bar"))],
    subject_to=[
        mk.Diameter(pressure="6 bar") <= "30 mm",
        mk.FibreSafety(pressure="6 bar") >= 3,
        mk.JammingMargin(pressure="6 bar") >= 0.05,
    ],
    designs=1280,
)

front = best.front
print(f"{len(front.design)} designs on the front, of {best.tried} tried")
for k in (0, -1):
    one = front.isel(design=k)
    radius = 1e3 * float(one["braid.radius"])
    print(f"{float(one.force):.1f} N at 10 %, {100 * float(one.stroke):.2f} % free: radius {radius:.2f} mm")
print("between:", ", ".join(f"{name} {row['value']}" for name, row in best.table.iterrows()))

Path("out").mkdir(exist_ok=True)
mk.plot(best).savefig("out/design_front.png", dpi=200)
print("out/design_front.png")

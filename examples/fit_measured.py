"""A home-made muscle as a laboratory measured it: fitted to its curves at 3 and 5 bar, foretold at 4 and 6 bar.

The curves are those of QuadSegrity (MIT licence), which are no part of this package: `python examples/fit_measured.py
--download` fetches them once, and without them this is skipped. Nobody wrote down its braid and its tube: angle,
radius, rubber and give of the fibres are free, and the length at rest, said to be 850 mm. Writes out/fit_measured.png.
"""

import sys
from pathlib import Path

import numpy as np

import mckibben as mk

folder = next((word for word in sys.argv[1:] if not word.startswith("-")), None)
try:
    data = mk.sample_data("quadsegrity", folder, download="--download" in sys.argv).decimated(40)
except mk.SpecError as error:
    print(f"skipped: {error}")
    sys.exit()

fibre = mk.Fibre(diameter="0.25 mm", E="3 GPa", nu=0.4, stretch=True, axial_stiffness="150 N")
muscle = mk.Muscle(
    braid=mk.Braid(radius="8 mm", length="850 mm", angle="62 deg", fibres=48, fibre=fibre),
    chamber=mk.Chamber(thickness="1.5 mm", law=mk.NeoHookean(c1="150 kPa")),
    name="QuadSegrity",
    assumed=("braid.fibres", "braid.fibre.diameter", "braid.fibre.E", "chamber.thickness"),
)
free = {
    "braid.angle": "50 deg to 80 deg",
    "braid.radius": "5 mm to 30 mm",
    "braid.length": "600 mm to 1000 mm",
    "chamber.law.c1": "1 kPa to 5 MPa",
    "braid.fibre.axial_stiffness": "10 N to 5 kN",
}
known = data.where(np.isin(data.which, [data.tests.index(name) for name in ("3 bars", "5 bars")]))
found = mk.fit(muscle, known, free)

for name, row in found.table.iterrows():
    print(f"{name}: {row['value']}, 95 % from {row['interval']}")
for name in ("4 bars", "6 bars"):
    test = data.test(name)
    miss = np.sqrt(np.mean((found.forces(test) - test.force) ** 2))
    print(f"{name}, foretold: rms {miss:.2f} N, {100 * miss / np.ptp(test.force):.1f} % of its range")
for note in found.notes:
    print("note:", note)

Path("out").mkdir(exist_ok=True)
mk.plot(found).savefig("out/fit_measured.png", dpi=200)
print("out/fit_measured.png")

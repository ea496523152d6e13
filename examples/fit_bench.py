"""The muscle behind measured curves: braid angle and stiffness of the rubber from two tests, and a third one foretold.

The curves in bench.csv are no measurements: the model made them, with noise, from an angle of 36.2 deg and c1 = 12 kPa.
The fit has to find these. The same from a file: mckibben fit examples/fit.toml. Writes out/fit_bench.png.
"""

from pathlib import Path

import mckibben as mk

data = mk.read_data(Path(__file__).parent / "bench.csv")
free = {"braid.angle": "34 deg to 40 deg", "chamber.law.c1": "4 kPa to 40 kPa"}
found = mk.fit(mk.presets.paper(), data, free, starts=4)

for name, row in found.table.iterrows():
    print(f"{name}: {row['value']}, standard error {row['error']}, 95 % from {row['interval']}")
print(f"rms {found.rms:.3f} N, {found.percent:.2f} % of the largest force; R squared {found.explained:.5f}")

# a pressure that was not measured, and how sure its forces are
third = found.predict(mk.Isobaric(length=["90 mm", "110 mm"], pressure="0.75 bar"))
for length, force, error in zip(third.curve.length, third.curve.force, third.error, strict=True):
    print(f"at 0.75 bar and {1e3 * length:.0f} mm: {force:.2f} N, standard error {error:.2f} N")
for note in found.notes:
    print("note:", note)

Path("out").mkdir(exist_ok=True)
mk.plot(found).savefig("out/fit_bench.png", dpi=200)
print("out/fit_bench.png")

"""Fittings that give way: why a short muscle pulls less than a long one of the same kind.

What clamps the braid yields by as much at every length, which is a larger share of a short muscle. A Festo muscle of
10 mm, held at its length as made under 6 bar, with fittings that do not yield and with some that do. Writes
out/soft_fittings.png.
"""

import warnings
from pathlib import Path

import matplotlib.pyplot as plt

import mckibben as mk

warnings.simplefilter("ignore", mk.MuscleWarning)  # what is assumed stands on the picture

muscle = mk.presets.get("festo-dmsp-10")
soft = mk.Fittings(compliance="0.005 mm/N")  # both together; assumed here, a pull on the bench tells
lengths = [60, 90, 140, 220, 380]  # mm

pulls: dict[str, list[float]] = {"rigid": [], "0.005 mm/N": []}
for length in lengths:
    one = muscle.replace("braid.length", f"{length} mm")
    for name, fittings in zip(pulls, (None, soft), strict=True):
        pulls[name].append(mk.solve(one.replace("fittings", fittings), length=f"{length} mm", pressure="6 bar").force)
for name, forces in pulls.items():
    told = [f"{force:.0f} N at {length} mm" for length, force in zip(lengths, forces, strict=True)]
    print(f"{name}: {', '.join(told)}")

figure, axes = plt.subplots(figsize=(5.0, 3.4), layout="constrained")
for name, forces in pulls.items():
    axes.plot(lengths, forces, "o-", ms=3, label=name)
axes.set(xlabel="length as made [mm]", ylabel="blocked force [N]")
axes.set_title("Festo 10 mm, 6 bar (wall and fittings assumed)")
axes.set_ylim(0.0)
axes.legend(title="fittings", loc="lower right")
Path("out").mkdir(exist_ok=True)
figure.savefig("out/soft_fittings.png", dpi=200)
print("out/soft_fittings.png")

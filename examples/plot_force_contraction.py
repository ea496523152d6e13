"""Force against contraction at three pressures, for a muscle described from scratch.

The braid angle is measured from the axis here, as most catalogues do. Writes out/force_contraction.pdf and .png.
"""

from pathlib import Path

import mckibben as mk

muscle = mk.Muscle(
    braid=mk.Braid(
        radius="6 mm", length="150 mm", angle="24 deg", angle_from="axis", fibres=64,
        fibre=mk.Fibre(diameter="0.2 mm", E="3 GPa", nu=0.4),
    ),
    chamber=mk.Chamber(thickness="1 mm", law=mk.NeoHookean(c1="0.1 MPa")),
    ends="clamped",
    name="example",
)  # fmt: skip

curves = {}
print("pressure   force at 150 mm   free contraction")
for pressure in (1, 2, 3):
    result = mk.run(muscle, mk.Isobaric(pressure=f"{pressure} bar", length="150 mm to 100 mm", points=32))
    curves[f"{pressure} bar"] = result
    free = mk.run(muscle, mk.FreeContraction(pressure=f"{pressure} bar"))
    print(f"{pressure} bar      {result.force[0]:8.2f} N        {100 * free.contraction[0]:8.2f} %")

figure = mk.plot(curves)
figure.axes[0].axhline(0.0, color="0.5", linewidth=0.6)
Path("out").mkdir(exist_ok=True)
for path in ("out/force_contraction.pdf", "out/force_contraction.png"):
    figure.savefig(path, dpi=200)
    print(path)

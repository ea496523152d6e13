"""Force against contraction at three pressures, for a muscle described from scratch.

The braid angle is measured from the axis here, as most catalogues do. Writes out/force_contraction.pdf and .png.
"""

from matplotlib.ticker import MaxNLocator

import mckibben as mk
from mckibben.view import curves, style

muscle = mk.Muscle(
    braid=mk.Braid(
        radius="6 mm", length="150 mm", angle="24 deg", angle_from="axis", fibres=64,
        fibre=mk.Fibre(diameter="0.2 mm", E="3 GPa", nu=0.4),
    ),
    chamber=mk.Chamber(thickness="1 mm", law=mk.NeoHookean(c1="0.1 MPa")),
    ends="clamped",
    name="example",
)  # fmt: skip

figure = style.new_figure()
axes = figure.add_subplot()
print("pressure   force at 150 mm   free contraction")
for pressure, colour in zip((1, 2, 3), style.LINES, strict=False):
    result = mk.run(muscle, mk.Isobaric(pressure=f"{pressure} bar", length="150 mm to 100 mm", points=32))
    curves.line(axes, result, "contraction", "force", color=colour, label=f"{pressure} bar")
    free = mk.run(muscle, mk.FreeContraction(pressure=f"{pressure} bar"))
    print(f"{pressure} bar      {result.force[0]:8.2f} N        {100 * free.contraction[0]:8.2f} %")

axes.axhline(0.0, color="0.5", linewidth=0.6)
axes.set(xlabel=curves.label("contraction"), ylabel=curves.label("force"))
axes.xaxis.set_major_locator(MaxNLocator(6))
style.tidy(axes, "best")
for path in style.save(figure, "out/force_contraction"):
    print(path)

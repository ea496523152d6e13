"""How far the textbook formula is off on your muscle: force at a few lengths, by the model and by Eq. (31).

Eq. (31) takes the muscle for a cylinder that stores no energy; Chou-Hannaford and Tondu-Lopez are the same formula.
"""

import mckibben as mk

muscle = mk.presets.paper()
result = mk.run(muscle, mk.Isobaric(pressure="1 bar", length="115 mm to 55 mm", points=7))
formula = mk.textbook_force(muscle, length=result.length, pressure=result.pressure)

print("length    model      formula")
for length, force, simple in zip(result.length, result.force, formula, strict=True):
    print(f"{1e3 * length:5.0f} mm  {force:7.2f} N  {simple:7.2f} N")
print("assumed:", ", ".join(muscle.assumed))

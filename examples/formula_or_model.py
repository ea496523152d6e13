"""How far the textbook formula is off on your muscle: force at a few lengths, by the model and by Eq. (31).

Eq. (31) takes the muscle for a cylinder that stores no energy; Chou-Hannaford and Tondu-Lopez are the same formula.
"""

import numpy as np

import mckibben as mk
from mckibben.model.cylinder import cylinder_angle
from mckibben.model.parameters import parameters
from mckibben.model.textbook import virtual_work_force

muscle = mk.presets.paper()
p = parameters(muscle)
result = mk.run(muscle, mk.Isobaric(pressure="1 bar", length="115 mm to 55 mm", points=7))
formula = np.asarray(virtual_work_force(cylinder_angle(result.length, p), result.pressure, p))

print("length    model      formula")
for length, force, simple in zip(result.length, result.force, formula, strict=True):
    print(f"{1e3 * length:5.0f} mm  {force:7.2f} N  {simple:7.2f} N")
print("assumed:", ", ".join(muscle.assumed))

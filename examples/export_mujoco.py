"""A muscle in MuJoCo: a mass hangs on it, by MuJoCo's own affine actuator, and by the map itself.

It takes `pip install "mckibben[mujoco]"` to run the model here.
"""

import math
import sys
from pathlib import Path

import numpy as np

import mckibben as mk

try:
    import mujoco
except ImportError:
    print('skipped: MuJoCo is missing, which would run the model: pip install "mckibben[mujoco]"')
    sys.exit()

out = Path("out")
out.mkdir(exist_ok=True)
muscle, mass = mk.presets.paper(), 2.0

chart = mk.chart(muscle, length="60 mm to 115 mm", pressure="0 to 3 bar")
path = mk.export(chart, out / "muscle.xml", mass=mass, force=True)
model = mujoco.MjModel.from_xml_path(str(path))
data = mujoco.MjData(model)
mujoco.mj_resetDataKeyframe(model, data, 0)
data.ctrl[0] = 1e5  # gauge pressure in Pa

mujoco.mj_step(model, data, nstep=15_000)
print(f"affine actuator: {1e3 * data.ten_length[0]:.2f} mm at 1 bar")

with mk.in_mujoco(model, {"muscle": chart}):
    mujoco.mj_step(model, data, nstep=15_000)
    resting = data.ten_length[0]
    print(f"the map itself: {1e3 * resting:.3f} mm")
    print(f"at rest by the map: {1e3 * chart.length_for('1 bar', mass * 9.80665):.3f} mm")

    model.tendon_damping[:] = 0.0  # a small oscillation
    data.qpos[0] += 1e-4
    seen = []
    for _ in range(1500):
        mujoco.mj_step(model, data)
        seen.append(data.ten_length[0] - resting)
rises = np.flatnonzero(np.diff(np.sign(seen)) > 0.0)
turns = (len(rises) - 1) / (model.opt.timestep * (rises[-1] - rises[0]))
print(f"{turns:.2f} Hz in MuJoCo")
print(f"{math.sqrt(chart.stiffness(resting, 1e5) / mass) / (2.0 * math.pi):.2f} Hz by sqrt(k/m)")

"""A weight lifted by pulses: a valve that fills or vents twenty times a second, its duty raised from 30 to 50 %.

The same from a file: mckibben simulate examples/rig.toml. Writes out/lift_by_pwm.png and out/lift_by_pwm.gif.
"""

from pathlib import Path

import numpy as np

import mckibben as mk

rig = mk.Rig(
    muscle=mk.presets.paper(),
    load=mk.Load(mass="3 kg", damping="20 N s/m", stop_high="110 mm"),  # it stands on the floor at first
    supply=mk.Supply(gauge="2 bar"),
    valve=mk.Valve(C="0.03 L/(s bar)", b=0.3, delay="5 ms"),
    command=mk.PWM(mk.Jump(0.5, before=0.3, at="1.5 s"), frequency="20 Hz"),
    tube="5 mL",
)
motion = mk.simulate(rig, until="3 s")

for begin, duty in ((1.25, 30), (2.75, 50)):
    last = (motion.time > begin) & (motion.time <= begin + 0.25)
    length, pressure = 1e3 * motion.length[last].mean(), 1e-5 * motion.pressure[last]
    print(f"{duty} %: {length:.2f} mm at {pressure.mean():.3f} bar, which ripples by {np.ptp(pressure):.3f} bar")
for time, event in motion.events.values[:1]:
    print(f"{time:.3f} s: {event}")
cycle = mk.per_cycle(motion, period="50 ms")
print(f"air of one pulse: {1e3 * cycle.air:.2f} mL (normal); {motion.consumed:.3f} normal litres in all")

Path("out").mkdir(exist_ok=True)
mk.plot(motion).savefig("out/lift_by_pwm.png", dpi=200)
print("out/lift_by_pwm.png")
print(mk.animate(motion, "out/lift_by_pwm.gif", fps=10, force=True))  # mk.animate(..., speed=0.1) shows every pulse

"""Two muscles against each other on a pulley, held at an angle by a PID controller, and pushed at.

One valve fills while the other vents. Writes out/joint_pid.png.
"""

import math
from pathlib import Path

import mckibben as mk

muscle = mk.presets.paper()
pid = mk.PID(of="angle", target=mk.Jump("12 deg", at="0.2 s"), kp=4.0, kd=0.2, every="5 ms", filter="5 ms")
rig = mk.Rig(
    muscle=muscle,
    antagonist=muscle,
    load=mk.Pulley(
        radius="15 mm", inertia="2e-3 kg m^2", damping="0.08 N m s", length="100 mm",
        torque=mk.Jump("0.2 N m", at="1.5 s"),
    ),
    supply=mk.Supply(gauge="2 bar"),
    valve=mk.Valve(C="0.05 L/(s bar)", b=0.3),
    command=pid,
    pressure="1 bar",
)  # fmt: skip
motion = mk.simulate(rig, until="3 s")

before = motion.data.sel(time=slice(0.0, 1.5))
step = mk.step_response(mk.Motion(before), at="0.2 s", final=math.radians(12.0))
print(f"rise {step.rise:.3f} s, overshoot {100 * step.overshoot:.1f} %, settled after {step.settling:.3f} s")
lowest = math.degrees(motion.angle[motion.time > 1.5].min())
print(f"pushed with 0.2 N m it goes back to {lowest:.2f} deg, and ends at {math.degrees(motion.angle[-1]):.2f} deg")
first, second = 1e-5 * motion.pressure[-1]
print(f"pressures at the end: {first:.3f} bar and {second:.3f} bar; {motion.consumed:.3f} normal litres of air")

closed = mk.bode(mk.Rig(muscle=muscle, antagonist=muscle, load=rig.load, supply=rig.supply, valve=rig.valve,
                        pressure="1 bar"), frequency="1 Hz")  # fmt: skip
print(f"with closed valves it swings at {closed.natural_frequency:.2f} Hz, damping ratio {closed.damping:.3f}")

Path("out").mkdir(exist_ok=True)
mk.plot(motion).savefig("out/joint_pid.png", dpi=200)
print("out/joint_pid.png")

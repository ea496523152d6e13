"""What a muscle can do: the lengths it can be held at over pressure, and force over both, as a datasheet shows them.

The muscle is the one of the theory page's reference values, with pinned ends: without pressure it folds early.
"""

from pathlib import Path

import mckibben as mk

muscle = mk.presets.reference().replace("ends", "pinned")
out = Path("out")
out.mkdir(exist_ok=True)

region = mk.working_range(muscle, pressures=["0 bar", "0.2 bar", "1 bar", "3 bar"])
for state in region.transpose("pressure").to_dataframe().reset_index().itertuples():
    print(f"{1e-5 * state.pressure:4.1f} bar: {1e3 * state.shortest:6.2f} mm to {1e3 * state.longest:6.2f} mm")
print(f"held at 55 mm from {1e-5 * mk.least_pressure(muscle, length='55 mm'):.3f} bar on")
mk.plot(region).savefig(out / "working_range.png", dpi=200)

forces = mk.force_map(muscle, length="70 mm to 115 mm", pressure="0 to 2 bar", points=7)
print(f"force at 115 mm and 2 bar: {float(forces['force'][-1, -1]):.2f} N")
mk.plot(forces).savefig(out / "force_map.png", dpi=200)

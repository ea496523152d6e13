"""A braid programmed to a given profile: which angles along it make a muscle of this shape at 1 bar?

A braid under pressure turns towards 35.3 deg from the parallels everywhere, so its radius there is about R0 0.816 over
the cosine of the angle that it was made with. The stiffness of the fibres, the chamber and the fittings change that;
the angles are found with all of it, by SciPy. Writes out/programmed_braid.png.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import least_squares

import mckibben as mk

PLACES = [0.15, 0.3, 0.5]  # of the length, from either fitting: the angles there are to be found
FIRST = "45 deg"  # at the fittings
SHARES = np.array([0.18, 0.26, 0.34, 0.42, 0.5])  # of the height, where the radius is wanted
WANTED = np.array([16.4e-3, 17.0e-3, 16.4e-3, 15.3e-3, 14.8e-3])  # two bulges and a waist

fibre = mk.Fibre(diameter="0.25 mm", E="3 GPa", nu=0.4, stretch=True)
chamber = mk.Chamber(thickness="1 mm", law=mk.MooneyRivlin(c1="8.5 kPa", c2="0 kPa"))


def muscle(angles: np.ndarray) -> mk.Muscle:
    profile = mk.AngleProfile(at=PLACES, angle=angles.tolist(), mirrored=True)
    braid = mk.Braid(radius="12.5 mm", length="150 mm", angle=FIRST, angle_profile=profile, fibres=40, fibre=fibre)
    return mk.Muscle(braid=braid, chamber=chamber, ends="clamped")


def shape(state: mk.State) -> np.ndarray:
    z, r = state.data["z"].values, state.data["r"].values
    return np.interp(SHARES, z / z[-1], r)


def missed(angles: np.ndarray) -> np.ndarray:
    return (shape(mk.solve(muscle(angles), force=0.0, pressure="1 bar", tolerance=1e-4)) - WANTED) / 1e-3


start = np.radians([50.0, 50.0, 47.0])
found = least_squares(missed, start, bounds=(np.radians(38.0), np.radians(62.0)), diff_step=1e-4, xtol=1e-6)
state = mk.solve(muscle(found.x), force=0.0, pressure="1 bar", tolerance=1e-4)
print("angles from the parallels:", ", ".join(f"{angle:.1f} deg" for angle in np.degrees(found.x)))
print(
    f"{state.verdict}, {1e3 * state.length:.1f} mm long; off by {1e3 * abs(shape(state) - WANTED).max():.2f} mm at most"
)

figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 3.2), layout="constrained")
knots = np.array([0.0, *PLACES, *(1.0 - x for x in PLACES[-2::-1]), 1.0])
angles = [45.0, *np.degrees([*found.x, *found.x[-2::-1]]), 45.0]
along = np.linspace(0.0, 1.0, 201)
left.plot(100.0 * knots, angles, "o", color="C1")
left.plot(100.0 * along, CubicSpline(knots, angles)(along), color="C0", zorder=1)
left.set(xlabel="place along the braid [%]", ylabel="braid angle from the parallels [deg]", title="as made")
z, r = 1e3 * state.data["z"].values, 1e3 * state.data["r"].values
right.plot(z, r, label="muscle")
right.plot(1e3 * state.length * SHARES, 1e3 * WANTED, "o", label="wanted")
right.set(xlabel="axis [mm]", ylabel="radius [mm]", title="at 1 bar, free")
right.legend()
Path("out").mkdir(exist_ok=True)
figure.savefig("out/programmed_braid.png", dpi=200)
print("out/programmed_braid.png")

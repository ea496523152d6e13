"""A map as a MuJoCo model (MJCF): a mass that hangs on the muscle, which is a tendon with an affine actuator."""

from __future__ import annotations

import math
from xml.sax.saxutils import quoteattr

from mckibben.exports.affine import Affine, affine
from mckibben.potential.c_source import check_name
from mckibben.potential.chart import Chart
from mckibben.spec.constants import GRAVITY
from mckibben.units import show

__all__ = ["as_mjcf", "default_mass"]

LAG = 0.05
"""Time constant [s] of the pressure behind the control."""
DAMPED = 0.05
"""Damping over the critical one."""
STEEL = 7850.0
"""Density [kg/m^3] of the mass as it is drawn."""

_TEMPLATE = """<mujoco model={name}>
  <!--
{notes}
  -->
  <option timestep="0.001" integrator="implicitfast" gravity="0 0 -{gravity!r}"/>
  <visual>
    <global azimuth="90" elevation="-10"/>
    <headlight ambient="0.5 0.5 0.5"/>
    <rgba haze="1 1 1 1"/>
  </visual>
  <asset>
    <texture type="skybox" builtin="flat" rgb1="1 1 1" width="8" height="48"/>
  </asset>
  <worldbody>
    <geom name="ceiling" type="box" pos="0 0 {above!r}" size="{wide!r} {wide!r} {radius!r}" contype="0" conaffinity="0"
          rgba="0.5 0.5 0.5 1"/>
    <site name="top" pos="0 0 {top!r}" size="0.004"/>
    <body name="load" pos="0 0 {bottom!r}">
      <joint name="lift" type="slide" axis="0 0 1"/>
      <geom name="load" type="box" pos="0 0 -{half!r}" size="{half!r} {half!r} {half!r}" mass="{mass!r}" contype="0"
            conaffinity="0" rgba="0.3 0.35 0.4 1"/>
      <site name="bottom" size="0.004"/>
    </body>
  </worldbody>
  <tendon>
    <spatial name={name} width="{radius!r}" rgba="0.8 0.5 0.2 1" damping="{damping!r}" limited="true"
             range="0 {longest!r}">
      <site site="top"/>
      <site site="bottom"/>
    </spatial>
  </tendon>
  <actuator>
    <general name={name} tendon={name} dyntype="filterexact" dynprm="{lag!r}"
             gaintype="affine" gainprm="{gain!r} {gain_slope!r} 0" biastype="affine" biasprm="{bias!r} {slope!r} 0"
             ctrllimited="true" ctrlrange="{first!r} {last!r}" actlimited="true" actrange="{first!r} {last!r}"
             forcelimited="true" forcerange="-{largest!r} 0"/>
  </actuator>
  <sensor>
    <tendonpos name="length" tendon={name}/>
    <actuatorfrc name="minus_force" actuator={name}/>
  </sensor>
  <keyframe>
    <key name="rest" qpos="0" act="{middle!r}" ctrl="{middle!r}"/>
  </keyframe>
</mujoco>
"""


def default_mass(chart: Chart) -> float:
    """A fifth of the largest force as a weight, to one digit [kg]."""
    return float(f"{0.2 * chart.largest_force / GRAVITY:.1g}")


def as_mjcf(chart: Chart, name: str, mass: float | None) -> str:
    """The model's text; `mass` [kg], or one that goes with the muscle."""
    check_name(name, "export.name")
    law, m = affine(chart), default_mass(chart) if mass is None else mass
    first, last = (float(end) for end in chart.pressures)
    middle = 0.5 * (first + last)
    low, high = (float(end) for end in chart.lengths(middle))
    stiffness = law.stiffness(middle)
    resting = min(max(law.length(m * GRAVITY, middle), low), high) if stiffness > 0.0 else high
    top = 2.0 * high
    radius = float(chart.largest_radius(resting, middle))
    half = 0.5 * (m / STEEL) ** (1.0 / 3.0)
    numbers = {
        "gravity": GRAVITY, "top": top, "above": top + radius, "wide": 2.0 * radius, "bottom": top - resting,
        "half": half, "mass": m, "damping": 2.0 * DAMPED * math.sqrt(max(stiffness, 0.0) * m), "longest": high,
        "radius": radius, "lag": LAG, "gain": -law.gain,
        "gain_slope": -law.gain_slope, "bias": -law.bias, "slope": -law.slope, "first": first, "last": last,
        "largest": law.largest, "middle": middle,
    }  # fmt: skip
    notes = "\n".join(f"  {line}".rstrip().replace("--", "- -") for line in _notes(chart, law, m, mass is None))
    return _TEMPLATE.format(name=quoteattr(name), notes=notes, **numbers)


def _notes(chart: Chart, law: Affine, mass: float, chosen: bool) -> list[str]:
    """What must be known of the model, in lines."""
    cut = f"cut off below 0 (a tendon does not push) and above {show(law.largest, 'N', 4)}"
    chosen_said = " (chosen here)" if chosen else ""
    return [
        "the muscle is the tendon; its pressure [Pa, gauge] is the activation, which follows the control",
        "the actuator's force is minus the force of the muscle [N], straight in length and in pressure; largest error",
        f"against the map within its range: {show(law.error, 'N', 2)}, {100.0 * law.error / law.largest:.2g} % of the "
        f"largest force; {cut}",
        "outside of the range: the pressure stays at its ends, the tendon has a stop at the longest length",
        "the map itself in MuJoCo: with mckibben.in_mujoco(model, {name: chart}), from Python",
        f"mass: {show(mass, 'kg', 4)}{chosen_said}; assumed: lag of the pressure {LAG:g} s (dynprm), damping of the "
        f"tendon {100.0 * DAMPED:g} % of the critical one",
        *chart.told,
    ]

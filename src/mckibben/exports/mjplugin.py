"""A map as an engine plugin for MuJoCo: an actuator in C, to be compiled against MuJoCo's headers."""

from __future__ import annotations

from importlib.resources import files

from mckibben.potential.chart import Chart

__all__ = ["as_plugin"]

_HEAD = """/* An actuator for MuJoCo that pulls as a muscle does. To compile, with headers and library of the wheel:

   M=$(python -c "import mujoco; print(mujoco.HEADERS_DIR)")/../..
   cc -O2 -shared -fPIC -I$M/include {name}.c -o {name}.so $M/libmujoco.so.* -lm

   then, before the model is loaded, mujoco.mj_loadPluginLibrary("./{name}.so"), or the file in MuJoCo's folder of
   plugins. In the model, with an activation that follows the control by a lag of 0.05 s (assumed), in place of an
   actuator that mckibben export -o {name}.xml has written:

   <extension><plugin plugin="mckibben.{name}"/></extension>

   <actuator>
     <plugin name="{name}" plugin="mckibben.{name}" tendon="{name}" dyntype="filterexact" dynprm="0.05" actdim="1"
             ctrllimited="true" ctrlrange="{first!r} {last!r}" actlimited="true" actrange="{first!r} {last!r}"/>
   </actuator>

   <config key="pushes" value="true"/> inside of it lets the muscle push; without it is slack where it would.
*/
"""


def as_plugin(chart: Chart, name: str) -> str:
    """The plugin's source, one file; it is called mckibben.`name`."""
    first, last = (float(end) for end in chart.pressures)
    body = (files("mckibben.exports") / "mujoco_plugin.c").read_text(encoding="utf-8")
    head = _HEAD.format(name=name, first=first, last=last)
    return f"{head}\n{chart.to_c()}\n{body.replace('@NAME@', name)}"

"""The map itself as an actuator of a MuJoCo model, by a callback in Python."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from mckibben.potential.chart import Chart
from mckibben.spec.errors import SpecError, near

__all__ = ["in_mujoco"]


@contextmanager
def in_mujoco(model: Any, charts: Mapping[str, Chart], *, slack: bool = True) -> Iterator[None]:
    """Let actuators of a MuJoCo model pull as maps say, while a `with` block lasts.

    Each actuator must act on a tendon (or joint) whose length is that of the muscle, and its activation, or where it
    has none its control, must be the gauge pressure in Pa, as in the models that `export` writes. What the actuator had
    as gain and bias comes back at the end. MuJoCo has one callback a process: use one model at a time.

    Args:
        model: a `mujoco.MjModel`.
        charts: maps by the names of the actuators.
        slack: no force below zero: tendons do not push.

    Returns:
        A context manager.

    Raises:
        SpecError: without the package mujoco, and for an actuator that the model lacks.

    >>> import mujoco
    >>> chart = mk.chart(mk.presets.paper(), length="60 mm to 115 mm", pressure="0 to 3 bar")
    >>> model = mujoco.MjModel.from_xml_path(str(mk.export(chart, "muscle.xml", mass="2 kg")))
    >>> data = mujoco.MjData(model)
    >>> with mk.in_mujoco(model, {"muscle": chart}):
    ...     data.ctrl[0] = 1e5
    ...     mujoco.mj_step(model, data, 10000)
    >>> bool(abs(data.ten_length[0] - chart.length_for("1 bar", 2.0 * 9.80665)) < 1e-6)
    True
    """
    try:
        import mujoco
    except ImportError as error:
        raise SpecError("in_mujoco", allowed="takes MuJoCo", advice='pip install "mckibben[mujoco]"') from error
    found = {_actuator(mujoco, model, name): chart.at for name, chart in charts.items()}
    kept = [array.copy() for array in (model.actuator_gaintype, model.actuator_biastype, model.actuator_gainprm)]
    control = getattr(model, "actuator_ctrladr", range(len(model.actuator_gaintype)))  # before 4.0 one each
    before: Callable[..., float] | None = mujoco.get_mjcb_act_bias()

    def bias(m: Any, d: Any, k: int) -> float:
        if k not in found:
            return before(m, d, k) if before else 0.0
        at = m.actuator_actadr[k]
        pressure = d.act[at] if at >= 0 else d.ctrl[control[k]]
        force = found[k](float(d.actuator_length[k]), float(pressure)).force
        return -max(force, 0.0) if slack else -force

    for k in found:
        model.actuator_gaintype[k], model.actuator_gainprm[k] = mujoco.mjtGain.mjGAIN_FIXED, 0.0
        model.actuator_biastype[k] = mujoco.mjtBias.mjBIAS_USER
    mujoco.set_mjcb_act_bias(bias)
    try:
        yield
    finally:
        mujoco.set_mjcb_act_bias(before)
        model.actuator_gaintype[:], model.actuator_biastype[:], model.actuator_gainprm[:] = kept


def _actuator(mujoco: Any, model: Any, name: str) -> int:
    """The number of an actuator."""
    kind = mujoco.mjtObj.mjOBJ_ACTUATOR
    k = int(mujoco.mj_name2id(model, kind, name))
    if k < 0:
        names = [str(mujoco.mj_id2name(model, kind, one)) for one in range(len(model.actuator_gaintype))]
        raise SpecError("in_mujoco.charts", name, f"is no actuator of the model, which has {', '.join(names)}",
                        near(name, names))  # fmt: skip
    return k

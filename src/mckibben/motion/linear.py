"""`bode()`: the frequency response of a rig, by its equations made linear about an equilibrium."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import attrs
import numpy as np

from mckibben.motion.maps import maps_of
from mckibben.motion.plant import Plant
from mckibben.motion.regime import FIRST, PER, Regime
from mckibben.motion.start import at_rest
from mckibben.results.answers import Bode
from mckibben.spec.errors import SpecError, nearest
from mckibben.spec.rig import Rig
from mckibben.units import UnitError, to_si

__all__ = ["bode"]

STEP = 1e-5
"""Step of the differences, over the size of each number of the state."""
AT_REST = 1e-6
"""Push, over the weight, below which a rig is in equilibrium."""
SLIGHT = 1e-3
"""Step of the command."""
ANSWERS = {"length": "m", "angle": "rad", "speed": "m/s", "pressure": "Pa", "force": "N"}
INPUTS = ("push", "command")


def bode(rig: Rig, *, frequency: Any, of: str = "", by: str = "push", chart: Any = None) -> Bode:
    """The frequency response of a rig about its equilibrium at the start, where its valves are closed.

    The equations are made linear there, by differences. Friction, of the load and at the crossings, and end stops are
    left out, as are cables that might go slack. About a closed valve, filling and venting have different slopes: a
    command is answered by the mean of the two, as the first harmonic of a small sine is.

    Args:
        rig: the rig; `rig.pressure` says about which pressure.
        frequency: frequencies [Hz], a number, text or a list.
        of: what answers: "length", "angle", "speed", "pressure" or "force" (of the first muscle); the angle of a pulley
            or the length where it is left out.
        by: "push", a force that lengthens the muscle (of a pulley: a torque along its angle), or the "command" of the
            valve.
        chart: the map of the muscle, as for `simulate`.

    Returns:
        A `Bode`: gain, phase, the poles, natural frequency and damping ratio.

    Raises:
        SpecError: for a rig that is held, an unknown name, or frequencies that are none.

    >>> rig = mk.Rig(
    ...     muscle=mk.presets.paper(), load=mk.Load(mass="3 kg", damping="5 N s/m"), pressure="1 bar",
    ...     supply=mk.Supply(gauge="2 bar"), valve=mk.Valve(C="0.05 L/s/bar", b=0.3),
    ... )
    >>> found = mk.bode(rig, frequency=["1 Hz", "100 Hz"])
    >>> found.natural_frequency.__round__(2)  # Hz
    5.11
    """
    if not isinstance(rig, Rig):
        raise SpecError("bode.rig", rig, "must be a Rig")
    if rig.fixed:
        raise SpecError("bode.rig", allowed="is held: nothing moves", advice="give it a Load or a Pulley")
    name = of or ("angle" if rig.turns else "length")
    if name not in ANSWERS or (name == "angle" and not rig.turns):
        raise SpecError(
            "bode.of", name, "is unknown", nearest(name, [one for one in ANSWERS if one != "angle" or rig.turns])
        )
    if by not in INPUTS:
        raise SpecError("bode.by", by, "is unknown", nearest(by, INPUTS))
    hertz = _frequencies(frequency)
    begun = at_rest(Plant.of(rig, maps_of(rig, chart)))
    plant, y = attrs.evolve(begun.plant, slackens=False), np.array(begun.state)
    regime = Regime.closed(plant)
    push = regime.rates(0.0, begun.state).push
    if abs(push) > AT_REST * max(abs(plant.weight), 1.0):
        unit = "N m" if rig.turns else "N"
        said = f"is no equilibrium: it is held there against {push:.3g} {unit}, by a stop, friction or its start"
        raise SpecError("bode.rig", allowed=said, advice="leave out the start, or give another pressure")
    rows = _moving(plant)
    A = _jacobian(regime, y, rows)
    B = _by_push(plant, rows) if by == "push" else _by_command(regime, y, rows)
    C = _answer(regime, y, rows, name)
    eye = np.eye(len(rows))
    response = np.array([C @ np.linalg.solve(2j * np.pi * f * eye - A, B) for f in hertz])
    names = ["angle" if rig.turns else "length", "speed"]
    for k in range(plant.n):
        names += [f"{one}{'_2' if k else ''}" for one in ("pressure_absolute", "temperature", "viscous force")]
    at = {one: float(y[row]) for one, row in zip(names, _all(plant), strict=True)}
    return Bode(of=name, by=by, frequency=hertz, response=response, poles=np.linalg.eigvals(A), at=at)


def _frequencies(given: Any) -> np.ndarray:
    several = given if isinstance(given, (list, tuple, np.ndarray)) else [given]
    found = []
    for one in several:
        try:
            found.append(float(to_si(one, "1/s")))
        except UnitError as error:
            raise SpecError("bode.frequency", one, str(error), error.advice) from error
        if not found[-1] > 0.0:
            raise SpecError("bode.frequency", one, "must be above 0 Hz")
    if not found:
        raise SpecError("bode.frequency", given, "must hold at least one frequency")
    return np.array(found)


def _all(plant: Plant) -> list[int]:
    return [0, 1, *(FIRST + PER * k + j for k in range(plant.n) for j in (0, 1, 3))]


def _moving(plant: Plant) -> list[int]:
    """Places of the numbers of the state that the others depend on."""
    own = [0] + ([] if plant.isothermal else [1]) + ([3] if plant.series is not None else [])
    return [0, 1, *(FIRST + PER * k + j for k in range(plant.n) for j in own)]


def _sizes(rows: Sequence[int]) -> list[float]:
    sizes = {0: 1e5, 1: 100.0, 3: 10.0}
    return [1e-2 if row < FIRST else sizes[(row - FIRST) % PER] for row in rows]


def _rates(regime: Regime, y: np.ndarray) -> np.ndarray:
    return np.array(regime.rates(0.0, y.tolist()).state)


def _jacobian(regime: Regime, y: np.ndarray, rows: list[int]) -> np.ndarray:
    columns = []
    for row, size in zip(rows, _sizes(rows), strict=True):
        step = np.zeros(len(y))
        step[row] = STEP * size
        columns.append((_rates(regime, y + step) - _rates(regime, y - step))[rows] / (2.0 * STEP * size))
    return np.array(columns).T


def _by_push(plant: Plant, rows: list[int]) -> np.ndarray:
    found = np.zeros(len(rows))
    found[1] = 1.0 / plant.mass
    return found


def _by_command(regime: Regime, y: np.ndarray, rows: list[int]) -> np.ndarray:
    """The mean of the slopes to both sides; a second muscle gets the negative of the command."""

    def at(u: float) -> np.ndarray:
        commands = [lambda t: u, lambda t: -u][: regime.plant.n]
        return _rates(attrs.evolve(regime, commands=commands), y)

    return np.asarray((at(SLIGHT) - at(-SLIGHT))[rows] / (2.0 * SLIGHT))


def _answer(regime: Regime, y: np.ndarray, rows: list[int], name: str) -> np.ndarray:
    """The answer as a row over the moving numbers."""
    found = np.zeros(len(rows))
    if name == "angle":
        found[0] = 1.0
    elif name in ("length", "speed"):
        found[0 if name == "length" else 1] = regime.plant.ratios[0]
    elif name == "pressure":
        found[2] = 1.0
    else:
        for k, (row, size) in enumerate(zip(rows, _sizes(rows), strict=True)):
            step = np.zeros(len(y))
            step[row] = STEP * size
            up, down = (regime.rates(0.0, (y + sign * step).tolist()).muscles[0].force for sign in (1.0, -1.0))
            found[k] = (up - down) / (2.0 * STEP * size)
    return found

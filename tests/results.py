"""Results with numbers out of a hat, for tests of what is done with a result: nothing is solved."""

import numpy as np

from mckibben.results.result import Result, about, dataset, tested
from mckibben.results.variables import FIELDS, STEP, has
from mckibben.spec import Muscle, Test


def made(muscle: Muscle, test: Test, reached: int) -> Result:
    """A result with numbers out of a hat, of which the last states were not reached."""
    count, rng = sum(step.points for step in test.as_steps(muscle)), np.random.default_rng(1)
    v = np.linspace(0.0, muscle.braid.length, 129)
    steps = {name: rng.normal(size=count) for name in STEP if has(muscle, name)}
    fields = {name: rng.normal(size=(count, len(v))) for name in FIELDS if has(muscle, name)}
    for values in (*steps.values(), *fields.values()):
        values[reached:] = np.nan
    lost = np.arange(count) >= reached
    steps["verdict"] = np.where(lost, "no equilibrium", "stable")
    steps["reason"] = np.where(lost, 'the fibres are straight at 128.8 mm, "too long"', "stable; θ = 54.7°")
    steps["shape"] = np.full(count, "ordinary")
    steps["converged"] = ~lost
    for name in ("iterations", "modes_length_control", "modes_force_control", "modes_antisymmetric", "protocol_step"):
        steps[name] = rng.integers(-1, 5, count)
    versions = {"mckibben": "0.1.0", "jax": "0.10"}
    warnings = ["neighbouring fibres touch", "and more"]
    said = tested(muscle, test) | about(versions, "2026-01-01T00:00:00", warnings, "incomplete")
    return Result(muscle, test, dataset(steps, fields, v, said))

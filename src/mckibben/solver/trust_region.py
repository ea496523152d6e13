"""Trust-region minimisation of the energy, straight from any guess to the state, with totals held as constraints.

Sequential quadratic programming (Byrd-Omojokun): a normal step towards the constraints, an exact trust-region step in
their null space, an l1 merit with second-order correction; Newton on the KKT system finishes. It knows no mechanics:
it sees totals and gradients of a few quantities, the first of which is minimised, and where it stands, not where it
tries, their second derivatives added up.
"""

from collections.abc import Callable
from contextlib import suppress
from typing import Any, Protocol

import attrs
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.floating[Any]]


FLOOR = 1e-3
"""What an imbalance is held against where every term vanishes, as at rest: a small share of the energy unit."""

HUGE = 1e50
"""Size of a gradient, in units of the energy, beyond which no state is: a search that runs away there turns back before
squares overflow."""

ROUNDING = 1e-15
"""A residual that no further step makes smaller."""
UNDEFINED = "the energy is not defined at the guess"


def imbalance(signs: Floats, gradients: Floats) -> float:
    """Size of the sum of signed gradients over the sum of their sizes."""
    return float(np.linalg.norm(signs @ gradients) / (np.abs(signs) @ np.linalg.norm(gradients, axis=1) + FLOOR))


class Derivatives(Protocol):
    """A field at the points that must stay in bounds, totals (k) and gradients (k, m)."""

    @property
    def theta(self) -> Any: ...
    @property
    def totals(self) -> Any: ...
    @property
    def gradients(self) -> Any: ...


@attrs.frozen
class Task:
    """Minimise total 0 minus loads times the other totals, with some of those held at targets."""

    evaluate: Callable[[Floats], Derivatives]
    curvature: Callable[[Floats, Floats], Floats]  #: (u, shares (k)) -> second derivatives (m, m) of shares of all
    loads: Floats  #: multiplier of each quantity (k); that of quantity 0 is unused, those of held ones are the guess
    held: tuple[int, ...]  #: quantities held
    targets: Floats  #: their values
    metric: Floats  #: (m, m) norm of a step
    largest_change: Callable[[Floats], float]  #: largest change of a field [rad] in a step
    admissible: Callable[[Any], bool]  #: whether the energy is defined where that field is
    leash: float = np.inf  #: largest change [rad] from the start: a search that goes further is given up


@attrs.frozen
class Minimum:
    """Where the search ended."""

    u: Floats
    loads: Floats  #: all multipliers, those of the held quantities included
    converged: bool
    residual: float  #: imbalance over the sum of the magnitudes of its terms
    iterations: int  #: Newton systems
    message: str
    totals: Floats  #: at u


def minimise(task: Task, u: Floats, radius: float = 1.0, limit: int = 200, tolerance: float = 1e-10) -> Minimum:
    """Search from u; converged means a residual below `tolerance` and constraints met to the same."""
    root = np.linalg.cholesky(task.metric).T
    inverse = np.linalg.inv(root)
    start = _Point.at(task, u, inverse, task.loads)
    if start is None:
        return Minimum(u, task.loads, False, np.inf, 1, UNDEFINED, task.evaluate(u).totals)
    point, hessian, penalty = start, start.hessian(task, inverse), 0.0
    for count in range(1, limit + 1):
        if point.residual < 1e-6 or radius < 1e-9:
            finished = polish(task, point.u, point.loads, tolerance, count)
            if finished.converged and _near(finished.u - point.u, root):
                return finished
            if radius < 1e-9:
                return attrs.evolve(finished, message="the search stalled")
        step, model_gain, normal_gain = _step(point, hessian, radius)
        violation = float(np.abs(point.c).sum())
        if normal_gain > 0.0:
            steep = float(np.abs(point.multipliers).max()) + 1e-3
            penalty = max(penalty, -model_gain / (0.7 * normal_gain) + 1.0, steep)
        predicted = model_gain + penalty * normal_gain
        change = task.largest_change(inverse @ step)
        if change > 1.0:
            radius *= 0.9 / change
            continue
        trial, actual = _trial(task, point, inverse @ step, inverse, penalty, violation)
        if trial is not None and actual < 0.1 * predicted and point.A.size and violation < 0.1:
            # second-order correction: come back to the constraints, which a straight step leaves
            correction = -np.linalg.lstsq(point.A, trial.c, rcond=None)[0]
            again, gain = _trial(task, point, inverse @ (step + correction), inverse, penalty, violation)
            if again is not None and gain > actual:
                trial, actual = again, gain
        length = float(np.linalg.norm(step))
        if trial is not None and actual < 1e-4 * predicted < 1e-18 * point.scale:  # rounding: nothing left to gain
            return polish(task, trial.u, trial.loads, tolerance, count)
        bent = None if trial is None or actual < 1e-4 * predicted else trial.hessian(task, inverse)
        if trial is None or bent is None or not np.isfinite(bent).all():
            radius = 0.25 * min(radius, length)
            continue
        point, hessian = trial, bent
        if task.largest_change(point.u - u) > task.leash:
            return Minimum(point.u, point.loads, False, point.residual, count, "nothing near the start", point.totals)
        if actual > 0.75 * predicted and length > 0.8 * radius:
            radius = min(2.5 * radius, 10.0)
        elif actual < 0.25 * predicted:
            radius = 0.5 * length
    finished = polish(task, point.u, point.loads, tolerance, limit)
    return attrs.evolve(finished, converged=False, message=f"no convergence in {limit} steps")


@attrs.frozen
class _Point:
    """Everything known at one u, in coordinates where the metric is the identity."""

    u: Floats
    value: float
    gradient: Floats
    A: Floats
    c: Floats
    multipliers: Floats
    loads: Floats
    residual: float
    scale: float
    totals: Floats

    @classmethod
    def at(cls, task: Task, u: Floats, inverse: Floats, loads: Floats) -> "_Point | None":
        """None where the energy is not defined."""
        d = task.evaluate(u)
        if not task.admissible(d.theta):
            return None
        totals, gradients = np.asarray(d.totals), np.asarray(d.gradients) @ inverse
        if not (np.abs(gradients) < HUGE).all():  # nor where they are no numbers
            return None
        held = list(task.held)
        free = [k for k in range(1, len(totals)) if k not in held]
        gradient = gradients[0] - loads[free] @ gradients[free]
        A = gradients[held]
        multipliers = np.linalg.lstsq(A.T, gradient, rcond=None)[0] if held else np.zeros(0)
        loads = loads.copy()
        loads[held] = multipliers
        signs = np.concatenate([[1.0], -loads[1:]])
        magnitude = float(np.abs(totals) @ np.abs(np.concatenate([[1.0], loads[1:]])))
        value = float(totals[0] - loads[free] @ totals[free])
        c = totals[held] - task.targets
        residual = max(imbalance(signs, gradients), float(np.abs(c).max(initial=0.0)))
        return cls(u, value, gradient, A, c, multipliers, loads, residual, magnitude + 1e-300, totals)

    def hessian(self, task: Task, inverse: Floats) -> Floats:
        """Of the Lagrangian."""
        return np.asarray(inverse.T @ task.curvature(self.u, np.concatenate([[1.0], -self.loads[1:]])) @ inverse)


def _trial(
    task: Task, point: _Point, du: Floats, inverse: Floats, penalty: float, violation: float
) -> tuple[_Point | None, float]:
    """The point after a step and the actual decrease of the merit; None where the energy is not defined."""
    u = point.u + du
    trial = _Point.at(task, u, inverse, point.loads)
    if trial is None or not np.isfinite(trial.value):
        return None, -np.inf
    return trial, point.value - trial.value + penalty * (violation - float(np.abs(trial.c).sum()))


def _step(point: _Point, hessian: Floats, radius: float) -> tuple[Floats, float, float]:
    """A step within the radius, the decrease of the quadratic model and that of the constraints' violation."""
    if point.A.size:
        normal = -np.linalg.lstsq(point.A, point.c, rcond=None)[0]
        normal = normal * min(1.0, 0.8 * radius / (float(np.linalg.norm(normal)) + 1e-300))
        q = np.linalg.qr(point.A.T, mode="complete")[0][:, point.A.shape[0] :]
    else:
        normal, q = np.zeros_like(point.u), np.eye(len(point.u))
    left = float(np.sqrt(max(radius**2 - float(normal @ normal), 0.0)))
    reduced = q.T @ (point.gradient + hessian @ normal)
    tangential = trust_region_step(q.T @ hessian @ q, reduced, left)
    step = normal + q @ tangential
    gain = -(point.gradient @ step + 0.5 * step @ hessian @ step)
    violation = float(np.abs(point.c).sum())
    return step, float(gain), violation - float(np.abs(point.c + point.A @ step).sum())


def trust_region_step(hessian: Floats, gradient: Floats, radius: float) -> Floats:
    """Exact minimiser of g.s + s.H.s/2 within |s| <= radius: Newton's step where H is positive and it is short enough,
    else from the eigendecomposition (hard case included), which takes six times as long."""
    with suppress(np.linalg.LinAlgError):
        np.linalg.cholesky(hessian)
        newton = np.linalg.solve(hessian, -gradient)
        if np.linalg.norm(newton) <= radius:
            return np.asarray(newton)
    values, vectors = np.linalg.eigh(hessian)
    g = vectors.T @ gradient
    if values[0] > 0.0:
        s = -g / values
        if np.linalg.norm(s) <= radius:
            return np.asarray(vectors @ s)
    low = max(0.0, -values[0])
    near = values + low < 1e-12 * max(1.0, float(np.abs(values).max()))
    regular = np.where(near, 0.0, -g / np.where(near, 1.0, values + low))
    if np.abs(g[near]).max(initial=0.0) < 1e-14 * (np.abs(g).max() + 1e-300) and np.linalg.norm(regular) < radius:
        regular[0] = np.sqrt(radius**2 - regular @ regular)  # hard case: complete along the most negative mode
        return np.asarray(vectors @ regular)
    lower, upper = low, low + np.linalg.norm(g) / radius + 1e-300
    shift = upper
    for _ in range(60):
        s = g / (values + shift)
        norm = np.linalg.norm(s)
        if norm > radius:
            lower = shift
        else:
            upper = shift
        if abs(norm - radius) < 1e-3 * radius:
            break
        slope = (s @ (s / (values + shift))) / norm
        shift = shift + (norm - radius) / radius * norm / slope
        if not lower < shift < upper:
            shift = 0.5 * (lower + upper)
    return np.asarray(-vectors @ (g / (values + shift)))


def polish(task: Task, u: Floats, loads: Floats, tolerance: float, count: int, limit: int = 12) -> Minimum:
    """Newton on the KKT system until the residual stops falling."""
    held, loads = list(task.held), loads.copy()
    best: Minimum | None = None
    for k in range(limit):
        d = task.evaluate(u)
        if not task.admissible(d.theta):
            break
        totals, gradients = np.asarray(d.totals), np.asarray(d.gradients)
        signs = np.concatenate([[1.0], -loads[1:]])
        rest, c = signs @ gradients, totals[held] - task.targets
        defined = bool((np.abs(gradients) < HUGE).all())
        residual = max(imbalance(signs, gradients), float(np.abs(c).max(initial=0.0))) if defined else np.inf
        if best is None or residual < best.residual:
            best = Minimum(u, loads.copy(), residual < tolerance, residual, count + k, "converged", totals)
            if residual < ROUNDING:
                break
        elif best.converged or not np.isfinite(residual) or k > 6:
            break
        hessian = task.curvature(u, signs)
        A = gradients[held]
        system = np.block([[hessian, -A.T], [A, np.zeros((len(held), len(held)))]])
        try:
            step = np.linalg.solve(system, -np.concatenate([rest, c]))
        except np.linalg.LinAlgError:
            break
        u = u + step[: len(u)]
        loads[held] += step[len(u) :]
    if best is None:
        return Minimum(u, loads, False, np.inf, count, UNDEFINED, task.evaluate(u).totals)
    return best if best.converged else attrs.evolve(best, message="Newton did not converge")


def _near(du: Floats, root: Floats) -> bool:
    """Whether polishing stayed at the state that the search had found."""
    return bool(np.linalg.norm(root @ du) < 0.1)

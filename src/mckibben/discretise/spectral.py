"""The spectral line: the slope psi as a Legendre series in a coordinate that crowds points into the end layers.

v = H0/2 (1 + tanh(b x)/tanh(b)), x in [-1, 1]. Symmetric shapes have psi odd about mid-length, so half the length and
the odd polynomials suffice; their small antisymmetric disturbances have psi even; the full line takes both. Stretch and
roll of the fibres and the slide of the chamber, over H0, are series of their own beside it, of the same symmetry.
"""

from functools import lru_cache, reduce
from typing import Any, Literal

import attrs
import numpy as np
from numpy.polynomial import legendre

from mckibben.compiled.arrays import Array
from mckibben.discretise.fields import Floats, Form, Operators, Sampling, cosines
from mckibben.discretise.forms import line_form
from mckibben.model.parameters import Number, Parameters, functions
from mckibben.spec import Joint, Muscle

__all__ = ["Line", "Modes"]

Modes = Literal["odd", "even", "all"]


@attrs.frozen
class Line:
    """A space of slopes psi: `size` modes, their symmetry about mid-length, and the ends they satisfy.

    The unknowns u are the coefficients of the modes: of psi, of the excess where the fibres stretch, of their roll, and
    of the chamber's slide; then what changes at the ends: the braid angle where the radius is free or the fibres
    stretch, the logarithm of their stretch where both is so, and the give of the fittings, which antisymmetric
    disturbances do not touch.
    """

    size: int
    ends: str = "clamped"
    modes: Modes = "odd"
    stretch: bool = False  #: whether the fibres stretch
    roll: bool = False  #: whether they roll
    give: bool = False  #: whether the fittings give way
    slide: bool = False  #: whether the chamber slides along the mesh
    dense: bool = False  #: whether it has twice the points, for kinks that lie between them
    programmed: bool = False  #: whether the braid angle varies along the length

    @classmethod
    def of(cls, muscle: Muscle, size: int) -> "Line":
        """The space of shapes of a muscle: what its ends hold, and what its fibres may do.

        Those of symmetric shapes, on half the length; where both ends have radii of their own, or the braid angle
        varies and is not mirrored, of all shapes, with as many modes for each half.
        """
        roll, give, profile = muscle.braid.joint == Joint.PIN, muscle.gives_way, muscle.braid.angle_profile
        whole = len(muscle.end_radii or ()) == 2 or (profile is not None and not profile.mirrored)
        count, modes = (2 * size, "all") if whole else (size, "odd")
        slide = muscle.friction is not None and muscle.friction.chamber_coefficient is not None
        stretch, programmed = muscle.braid.fibre.stretch, profile is not None
        return cls(count, str(muscle.ends), modes, stretch, roll, give, slide, programmed=programmed)  # type: ignore[arg-type]

    @property
    def form(self) -> Form:
        """What the local variables mean."""
        return line_form(self.stretch, self.roll, self.slide, self.give, self.ends == "free", self.programmed)

    @property
    def points(self) -> int:
        """Quadrature points: 1.5 m + 8 on the half line, a rule that was safe on hard cases; 3 m + 8 where dense."""
        return int((3.0 if self.dense else 1.5) * self.size) + 8

    @property
    def half(self) -> bool:
        """Whether only half the length carries points."""
        return self.modes != "all"

    @property
    def series(self) -> dict[str, slice]:
        """The unknowns of each field with a series: the excess is small and takes half the modes."""
        found, first = {}, 0
        effects = (("psi", True), ("excess", self.stretch), ("roll", self.roll), ("slide", self.slide))
        for name, there in effects:
            if there:
                last = first + ((self.size + 1) // 2 if name == "excess" else self.size)
                found[name], first = slice(first, last), last
        return found

    @property
    def turns(self) -> int:
        """Unknowns of the ends, after the series: theta, the stretch, and the give of the fittings."""
        return (self.ends == "free") + self.stretch + self.gives

    @property
    def gives(self) -> bool:
        """Whether the give of the fittings is among the unknowns."""
        return self.give and self.modes != "even"

    @property
    def unknowns(self) -> int:
        """Unknowns of the equilibrium."""
        return max(part.stop for part in self.series.values()) + self.turns

    @property
    def closes(self) -> bool:
        """Whether the end radii are a condition; odd slopes have equal ones anyway, free ends do not need them."""
        return self.modes == "all" and self.ends != "free"

    def even(self) -> "Line":
        """The small antisymmetric disturbances of a symmetric shape, on the same points."""
        return attrs.evolve(self, modes="even")

    def operators(self) -> Operators:
        """Operators in the mapped coordinate x, which are the same for every muscle."""
        return _operators(self)

    def sampling(self, count: int) -> Sampling:
        """The space at `count` points uniform in x; of a half line on its half alone, the middle included."""
        return _sampling(self, count)

    def uniform(self, count: int) -> Floats:
        """`count` points uniform in x over the full length."""
        return np.linspace(-1.0, 1.0, count)

    def inner_integral(self) -> Floats:
        """Integral in x from the first end to each quadrature point."""
        return _operators(self).cumulate

    def harmonics(self) -> Floats:
        """From a smooth field at the quadrature points to c_k of sum c_k cos(k t), t = 0 at the last of x."""
        return _harmonics(self)

    def coordinate(self, x: Any, p: Parameters, b: Number) -> Any:
        """Material coordinate v [m] of the mapped coordinate x."""
        f = functions(x, b)
        return 0.5 * p.H0 * (1.0 + f.tanh(b * x) / f.tanh(b))

    def jacobian(self, x: Any, p: Parameters, b: Number) -> Any:
        """dv/dx [m] at x."""
        f = functions(x, b)
        return 0.5 * p.H0 * b / f.cosh(b * x) ** 2 / f.tanh(b)

    def slope_factor(self, p: Parameters) -> Number:
        """Small changes of psi over those of the first field: psi is the first field."""
        return 1.0

    def tail(self, u: Array, varied: bool = False) -> Any:
        """Largest of the last coefficients of a series over the largest of all (..., m): how well it has converged.

        Waves of the wall make a series that falls slowly and unevenly, whose last two may be small by chance: the error
        was then three squares of its last eighth x, which counts as the tail whose power 1.5 that is.

        Where the braid is `varied` along its length, the excess follows what varies, and is not small. It enters by its
        integral, so that each of its coefficients counts by its share of the degree.
        """
        f, series = functions(u), {name: abs(u[..., part]) for name, part in self.series.items()}
        if varied:
            step = 1 if self.modes == "all" else 2
            series["excess"] = series["excess"] / (1.0 + step * np.arange(series["excess"].shape[-1]))
        parts = list(series.values())
        top = f.maximum(reduce(f.maximum, [part.max(-1) for part in parts]), 1e-12)
        two, eighth = (
            reduce(f.maximum, [part[..., -max(2, part.shape[-1] // share) :].max(-1) for part in parts]) / top
            for share in (self.size, 8)
        )
        return f.maximum(two, (3.0 * eighth**2) ** (2.0 / 3.0))

    def embedded(self, other: Any, u: Floats) -> Floats:
        """Unknowns u (m) of another line, larger or smaller or half of it, as unknowns of this one."""
        found = np.zeros(self.unknowns)
        for name, part in self.series.items():
            if name in other.series:
                self._embed(found[part], u[other.series[name]], other.modes)
        shared = min(self.turns, other.turns)
        if shared:
            found[len(found) - self.turns :][:shared] = u[len(u) - other.turns :][:shared]
        return found

    def _embed(self, place: Floats, series: Floats, modes: Modes) -> None:
        """Put one series in the place of this line's own: the odd modes of all are the half line's, and so the even."""
        if self.modes != modes:
            place = place[1 if modes == "odd" else 0 :: 2]
        shared = min(len(place), len(series))
        place[:shared] = series[:shared]


@lru_cache(maxsize=64)
def _operators(line: Line) -> Operators:
    xi, w = legendre.leggauss(line.points)
    length = 1.0 if line.half else 2.0
    x = (xi - 1.0) / 2.0 if line.half else xi
    fields, lifts = _at(line, x)
    copies = 2.0 if line.half else 1.0
    return Operators(x, copies * w * length / 2.0, fields, lifts, cumulative(xi, w, xi) * length / 2.0)


@lru_cache(maxsize=64)
def _sampling(line: Line, count: int) -> Sampling:
    xi, w = legendre.leggauss(line.points)
    x = np.linspace(-1.0, 0.0 if line.half else 1.0, count)
    length, at = (0.5, 2.0 * x + 1.0) if line.half else (1.0, x)
    fields, lifts = _at(line, x)
    integral = length * cumulative(xi, w, at)
    return Sampling(x, fields, lifts, integral, integral)


def _at(line: Line, x: Floats) -> tuple[tuple[Floats, ...], tuple[Floats, ...]]:
    """The fields, differentiated by x as often as their order says, and the direct parts of the integrals at x."""

    def wide(part: Floats, first: int) -> Floats:
        """A table of some unknowns as one of all."""
        table = np.zeros((len(x), line.unknowns))
        table[:, first : first + part.shape[1]] = part
        return table

    ends = [wide(np.ones((len(x), 1)), line.unknowns - line.turns + k) for k in range(line.turns)]
    tables = []
    for name, part in line.series.items():
        held = name == "slide" or (line.ends == "clamped" and name != "excess")  # any fitting holds the chamber
        series = _modes(line.modes, part.stop - part.start, clamped=held)
        value, slope = (wide(legendre.legval(x, some).T, part.start) for some in (series, legendre.legder(series)))
        tables += [value, ends[0]] if name == "excess" else [value, slope]
    nothing = wide(np.zeros((len(x), 0)), 0)
    if line.give:
        tables.append(ends.pop() if line.gives else nothing)
    lifts = (*ends, nothing, nothing)
    return tuple(tables), lifts[: len(line.form.integrals)]


def _modes(modes: Modes, size: int, clamped: bool) -> Floats:
    """Legendre coefficients of the modes, one column each; clamped modes vanish at both ends."""
    step = 1 if modes == "all" else 2
    first = 1 if modes == "odd" else 0
    lead = 2 if clamped else 0
    series = np.zeros((first + step * (size - 1) + lead + 1, size))
    for k in range(size):
        n = first + step * k
        series[n + lead, k] = 1.0
        if clamped:  # P_{n+2} - P_n is zero at x = -1 and x = 1
            series[n, k] = -1.0
    return series


@lru_cache(maxsize=64)
def _harmonics(line: Line) -> Floats:
    """Barycentric interpolation at the midpoints of [0, pi]: through the Legendre series the ends lose four digits."""
    xi, w = legendre.leggauss(line.points)
    t = np.pi * (np.arange(line.points) + 0.5) / line.points
    apart = np.cos(t)[:, None] - xi
    same = np.abs(apart) < 1e-14
    share = np.where(np.arange(line.points) % 2, -1.0, 1.0) * np.sqrt((1.0 - xi**2) * w) / np.where(same, 1.0, apart)
    share = np.where(same.any(axis=1, keepdims=True), same, share)
    return cosines(t) @ (share / share.sum(axis=1, keepdims=True))


def cumulative(xi: Floats, w: Floats, at: Floats) -> Floats:
    """Matrix of the integrals from -1 to `at` of the polynomial through values at the Gauss points xi."""
    n = len(xi)
    degree = np.arange(n)
    project = (degree[:, None] + 0.5) * legendre.legvander(xi, n - 1).T * w
    below = legendre.legvander(at, n)
    # integral of P_k from -1 is (P_{k+1} - P_{k-1})/(2k + 1), and x + 1 for k = 0
    integrals = np.concatenate(
        [at[:, None] + 1.0, (below[:, 2:] - below[:, :-2])[:, : n - 1] / (2.0 * degree[1:] + 1.0)], axis=1
    )
    return np.asarray(integrals @ project)

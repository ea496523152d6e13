"""What the local variables of the spectral line mean, with and without the effects that can be switched on.

theta is integrated from theta' = rate(psi), Eq. (12). Where fibres stretch, that rate gains a field, the excess, and
the logarithm q of their stretch is integrated from q' = excess tan(theta). As EA grows the excess tends to zero, so
that the shapes of stiff fibres lie in a plane of unknowns, not along a curved valley: searches stay quick. In a
programmed braid theta goes along with theta0, and the excess with theta0'; there the logarithm of the radius is
integrated in place of that of the stretch, which follows: its rate knows nothing of theta0', which has kinks (theory
page).
"""

from functools import cache
from itertools import chain
from typing import Any

import jax.numpy as jnp

from mckibben.discretise.fields import Form, Integral, Variables
from mckibben.model.angle import cos, radians, sin, tan
from mckibben.model.kinematics import angle_rate, end_angle, made_angle, stretch_rate
from mckibben.model.parameters import Number, Parameters
from mckibben.model.point import Made, Point

__all__ = ["line_form"]

ORDERS = {"psi": 0, "kappa": 1, "excess": 1, "turn": 0, "roll": 0, "roll_rate": 1, "slide": 0, "slide_rate": 1,
          "give": 0}  # fmt: skip
"""How often each field is differentiated by v; what happens at a fitting, turn or give, is the same all along v."""
ANGLES = {"theta", "psi", "turn", "roll"}
"""What enters by its sine and cosine alone."""


@cache
def line_form(stretch: bool, roll: bool, slide: bool, give: bool, free: bool, programmed: bool = False) -> Form:
    """The form of a line with some of the effects, and with its end radius free or held."""
    integrated = ("theta", "log_radius" if programmed else "log_stretch") if stretch else ("theta",)
    effects = (
        ("excess", "turn") if stretch else (), ("roll", "roll_rate") if roll else (),
        ("slide", "slide_rate") if slide else (), ("give",) if give else (),
    )  # fmt: skip
    fields = ("psi", "kappa", *chain(*effects))
    names = (*integrated, *fields)

    def point(x: Variables, p: Parameters, made: Made | None) -> Point:
        at = dict(zip(names, x, strict=True))
        stretched = None
        if programmed:
            assert made is not None
            stretched = jnp.exp(at["log_radius"]) * cos(made.angle) / cos(at["theta"])
        elif stretch:
            stretched = _stretch(at["log_stretch"], None if free else at["turn"], p)
        effects = {name: at.get(name) for name in ("roll", "roll_rate", "give")}
        if slide:
            effects |= {name: p.H0 * at[name] for name in ("slide", "slide_rate")}
        return Point(at["theta"], at["psi"], at["kappa"], stretched, _excess(at, made), **effects, made=made)

    def turning(x: Variables, p: Parameters, made: Made | None) -> Number:
        at = dict(zip(names, x, strict=True))
        return angle_rate(Point(None, at["psi"], at["kappa"], excess=at.get("excess"), made=made), p)

    def stretching(x: Variables, p: Parameters, made: Made | None) -> Number:
        at = dict(zip(names, x, strict=True))
        return stretch_rate(Point(at["theta"], None, None, excess=_excess(at, made), made=made), p)

    def widening(x: Variables, p: Parameters, made: Made | None) -> Number:
        """r'/r = s sin(psi)/r, whatever the fibres' stretch."""
        at = dict(zip(names, x, strict=True))
        return sin(at["psi"]) * tan(at["theta"]) / (p.R0 * tan(made_angle(Point(None, None, None, made=made), p)))

    by = [names.index(name) for name in ("psi", "excess") if name in names]
    integrals = [Integral(_as_made, turning, tuple(by))]
    if stretch:
        rate, field = (widening, "psi") if programmed else (stretching, "excess")
        integrals.append(Integral(lambda p, made: 0.0 * p.R0, rate, (0, names.index(field))))
    orders, angles = tuple(ORDERS[name] for name in fields), tuple(name in ANGLES for name in names)
    return Form(tuple(integrals), point, orders, angles)


def _as_made(p: Parameters, made: Made | None) -> Number:
    """theta of the braid as made, or as the first fitting holds it: that of a programmed braid goes along with it."""
    return end_angle(p, 0) if made is None else radians(made.angle)


def _excess(at: dict[str, Any], made: Made | None) -> Number | None:
    """The excess from its field: in a programmed braid that is what comes to theta0' of the braid as made, so that this
    has the unknowns zero."""
    return at.get("excess") if made is None else at["excess"] + made.rate


def _stretch(log: Number, turn: Number | None, p: Parameters) -> Number:
    """lambda at a point. Where the radius is held at the fitting and theta turns there from theta_1, lambda cos(theta)
    = cos(theta_1)."""
    if turn is None:
        return jnp.exp(log)
    held = p.theta0 if p.end_radii is None else end_angle(p, 0)
    return jnp.exp(log) / (cos(turn) - tan(held) * sin(turn))

"""A map as one C99 file for a controller: the numbers, and the evaluator once more in C."""

from __future__ import annotations

import re
from collections.abc import Iterable

import numpy as np

from mckibben.potential.evaluate import Table
from mckibben.potential.rubbing import LEAST, Rubs
from mckibben.spec.errors import SpecError

__all__ = ["c_source", "check_name"]

_TEMPLATE = r"""/*
@NOTES@

   double @NAME@_force(length, pressure)              N
   double @NAME@_force_slack(length, pressure)        N, not below zero: a tendon does not push
   double @NAME@_volume(length, pressure)             m^3, inside the braid
   double @NAME@_stiffness(length, pressure)          N/m, dF/dh at constant pressure
   double @NAME@_volume_by_length(length, pressure)   m^2, dV/dh, which is -dF/dP
   double @NAME@_volume_by_pressure(length, pressure) m^3/Pa, dV/dP at constant length
   double @NAME@_largest_radius(length, pressure)     m
@SAYS@   int    @NAME@_inside(length, pressure)             whether the error above holds there
   void   @NAME@_evaluate(length, pressure, &values)  all but the radius at once
   void   @NAME@_lengths(pressure, &shortest, &longest)

   length in m, gauge pressure in Pa. C99; needs sqrt, exp and floor of math.h, no memory, no state.
*/
#ifndef @GUARD@_H
#define @GUARD@_H

#include <math.h>

typedef struct {
    double force, volume, stiffness, volume_by_length, volume_by_pressure, potential;
    int inside;
} @NAME@_values;

enum { @NAME@_low_knots = @KL@, @NAME@_high_knots = @KH@ };
@TABLES@
static inline double @NAME@_clip(double x, double low, double high) {
    return x < low ? low : x > high ? high : x;
}

/* Chebyshev polynomials of x */
static inline void @NAME@_polynomials(double x, int n, double *T) {
    T[0] = 1.0;
    if (n > 1) T[1] = x;
    for (int k = 2; k < n; k++) T[k] = 2.0 * x * T[k - 1] - T[k - 2];
}

static inline double @NAME@_sum(const double *c, int n, int m, const double *X, const double *Y) {
    double total = 0.0;
    for (int i = 0; i < n; i++) {
        double row = 0.0;
        for (int j = 0; j < m; j++) row += c[i * m + j] * Y[j];
        total += X[i] * row;
    }
    return total;
}

/* an edge of the range and its derivatives by y, as a cubic through knots even in y */
static inline void @NAME@_edge(const double (*knots)[2], int count, double y, double *f) {
    f[0] = knots[0][0];
    f[1] = f[2] = 0.0;
    if (count == 1) return;
    const double step = 2.0 / (count - 1);
    const double place = (y + 1.0) / step;
    const int k = place > 0.0 ? (int)@NAME@_clip(floor(place), 0.0, count - 2.0) : 0; /* 0 where y is no number, too */
    const double t = place - k;
    const double f0 = knots[k][0], d0 = step * knots[k][1], f1 = knots[k + 1][0], d1 = step * knots[k + 1][1];
    const double c2 = 3.0 * (f1 - f0) - 2.0 * d0 - d1, c3 = 2.0 * (f0 - f1) + d0 + d1;
    f[0] = f0 + t * (d0 + t * (c2 + t * c3));
    f[1] = (d0 + t * (2.0 * c2 + 3.0 * t * c3)) / step;
    f[2] = (2.0 * c2 + 6.0 * t * c3) / (step * step);
}

static inline void @NAME@_lengths(double pressure, double *shortest, double *longest) {
    const double P = @NAME@_clip(pressure, @FIRST@, @LAST@);
    const double y = (sqrt(P - @FIRST@ + @SOFT@) - @Q0@) / @Q1@;
    double f[3];
    @NAME@_edge(@NAME@_low, @NAME@_low_knots, y, f);
    *shortest = f[0];
    @NAME@_edge(@NAME@_high, @NAME@_high_knots, y, f);
    *longest = f[0];
}

static inline void @NAME@_evaluate(double length, double pressure, @NAME@_values *out) {
    if (!(fabs(length) < 1e300 && fabs(pressure) < 1e300)) { /* no number, or infinite */
        const double none = length - length + pressure - pressure;
        out->force = out->volume = out->stiffness = out->volume_by_length = none;
        out->volume_by_pressure = out->potential = none;
        out->inside = 0;
        return;
    }
    const double width = @WIDTH@;
    const double P = @NAME@_clip(pressure, @FIRST@, @LAST@), over = pressure - P;
    const double q = sqrt(P - @FIRST@ + @SOFT@), y = (q - @Q0@) / @Q1@;
    const double q1 = 0.5 / q, q2 = -0.5 * q1 / (q * q);
    double low[3], high[3], X[@N@], Y[@M@];
    @NAME@_edge(@NAME@_low, @NAME@_low_knots, y, low);
    @NAME@_edge(@NAME@_high, @NAME@_high_knots, y, high);
    double h = @NAME@_clip(length, low[0], high[0]);
    const double beyond = length - h, side = beyond < 0.0 ? -1.0 : 1.0, t = fabs(beyond) / width, e = exp(-t);
    const int outside = beyond != 0.0;
    if (outside) h += side * width * (2.0 - (2.0 + t) * e);
    @NAME@_polynomials((h - @H0@) / @H1@, @N@, X);
    @NAME@_polynomials(y, @M@, Y);
    double w[8];
    const int orders = outside || over != 0.0 ? 8 : 6;
    for (int k = 0; k < orders; k++) w[k] = @NAME@_sum(&@NAME@_series[k][0][0], @N@, @M@, X, Y);
    const double W = w[0], Wh = w[1], Whh = w[2], WP = w[3] * q1, WhP = w[4] * q1, WPP = w[5] * q1 * q1 + w[3] * q2;
    out->inside = !outside && over == 0.0;
    if (out->inside) {
        out->force = Wh;
        out->volume = -WP;
        out->stiffness = Whh;
        out->volume_by_length = -WhP;
        out->volume_by_pressure = -WPP;
        out->potential = W;
        return;
    }
    const double Whhh = w[6], WhhP = w[7] * q1;
    double D = 1.0, E = 0.0, p = 0.0, p_P = 0.0, D_P = 0.0, E_P = 0.0, e1 = 0.0, e2 = 0.0;
    double S = 0.0, S1 = 0.0, S2 = 0.0, S3 = 0.0;
    if (outside) {
        const double *f = beyond < 0.0 ? low : high, *spring = @NAME@_springs[beyond < 0.0 ? 0 : 1];
        const double y1 = q1 / @Q1@, y2 = q2 / @Q1@, A = spring[0], k = spring[1];
        const double s2 = -t * e, s3 = (t - 1.0) * e;
        D = (1.0 + t) * e;
        e1 = f[1] * y1;
        e2 = f[2] * y1 * y1 + f[1] * y2;
        E = side * s2 / width;
        p = e1 * (1.0 - D);
        p_P = e2 * (1.0 - D) + side * s2 * e1 * e1 / width;
        D_P = -E * e1;
        E_P = -s3 * e1 / (width * width);
        S = A * width * (t - 2.0 + (2.0 + t) * e) + k * width * width * (0.5 * t * t - 2.0 * t + 3.0 - (3.0 + t) * e);
        S1 = A * (1.0 - (1.0 + t) * e) + k * width * (t - 2.0 + (2.0 + t) * e);
        S2 = A * t * e / width + k * (1.0 - (1.0 + t) * e);
        S3 = (A * (1.0 - t) * e / width + k * t * e) / width;
    }
    const double w_P = WP + Wh * p - side * S1 * e1;
    const double w_hP = (WhP + Whh * p) * D + Wh * D_P - S2 * e1;
    const double w_hh = Whh * D * D + Wh * E + S2;
    const double w_PP = WPP + 2.0 * WhP * p + Whh * p * p + Wh * p_P + S2 * e1 * e1 - side * S1 * e2;
    const double w_hhP =
        (WhhP + Whhh * p) * D * D + 2.0 * Whh * D * D_P + (WhP + Whh * p) * E + Wh * E_P - side * S3 * e1;
    out->force = Wh * D + side * S1 + w_hP * over;
    out->volume = -w_P;
    out->stiffness = w_hh + w_hhP * over;
    out->volume_by_length = -w_hP;
    out->volume_by_pressure = over == 0.0 ? -w_PP : 0.0;
    out->potential = W + S + w_P * over;
}

#define @GUARD@_TELLS(what)                                                 \
    static inline double @NAME@_##what(double length, double pressure) {    \
        @NAME@_values values;                                               \
        @NAME@_evaluate(length, pressure, &values);                         \
        return values.what;                                                 \
    }
@GUARD@_TELLS(force)
@GUARD@_TELLS(volume)
@GUARD@_TELLS(stiffness)
@GUARD@_TELLS(volume_by_length)
@GUARD@_TELLS(volume_by_pressure)
#undef @GUARD@_TELLS

static inline double @NAME@_force_slack(double length, double pressure) {
    const double force = @NAME@_force(length, pressure);
    return force < 0.0 ? 0.0 : force;
}

static inline int @NAME@_inside(double length, double pressure) {
    @NAME@_values values;
    @NAME@_evaluate(length, pressure, &values);
    return values.inside;
}

static inline double @NAME@_largest_radius(double length, double pressure) {
    double shortest, longest, X[@NR@], Y[@MR@];
    @NAME@_lengths(pressure, &shortest, &longest);
    const double P = @NAME@_clip(pressure, @FIRST@, @LAST@), h = @NAME@_clip(length, shortest, longest);
    @NAME@_polynomials((h - @H0@) / @H1@, @NR@, X);
    @NAME@_polynomials((sqrt(P - @FIRST@ + @SOFT@) - @Q0@) / @Q1@, @MR@, Y);
    const double r = @NAME@_sum(&@NAME@_radius[0][0], @NR@, @MR@, X, Y);
    return r < @LEAST@ ? @LEAST@ : r;
}
@RUBS@
#endif
"""
_SAYS = """   double @NAME@_friction(length, pressure)           N, of crossings that all slip: it pulls with
                                                      force - friction as it shortens, + as it lengthens
"""
_RUBS = """
static inline double @NAME@_friction(double length, double pressure) {
    if (!(fabs(length) < 1e300 && fabs(pressure) < 1e300)) return length - length + pressure - pressure;
    double shortest, longest, X[@NF@], Y[@MF@];
    @NAME@_lengths(pressure, &shortest, &longest);
    const double P = @NAME@_clip(pressure, @FIRST@, @LAST@), h = @NAME@_clip(length, shortest, longest);
    @NAME@_polynomials((h - @H0@) / @H1@, @NF@, X);
    @NAME@_polynomials((sqrt(P - @FIRST@ + @SOFT@) - @Q0@) / @Q1@, @MF@, Y);
    const double f = @NAME@_sum(&@NAME@_rubs[0][0], @NF@, @MF@, X, Y);
    return f < @NONE@ ? @NONE@ : f;
}
"""
"""What is added for a muscle with friction at its crossings."""


def c_source(table: Table, notes: Iterable[str], name: str, rubs: Rubs | None = None) -> str:
    """The file's text, of a muscle with friction (`rubs`) with that too; SpecError for a name that C does not take."""
    check_name(name, "to_c.name")
    _, n, m = table.series.shape
    arrays = {"series": table.series, "radius": table.radius, "low": table.low, "high": table.high,
              "springs": table.springs}  # fmt: skip
    template, sizes = _TEMPLATE.replace("@SAYS@", "").replace("@RUBS@", ""), {}
    if rubs is not None:
        template = _TEMPLATE.replace("@SAYS@", _SAYS).replace("@RUBS@", _RUBS)
        arrays["rubs"] = rubs.friction
        sizes = dict(zip(("NF", "MF"), map(str, rubs.friction.shape), strict=True)) | {"NONE": f"({LEAST!r})"}
    tables = "".join(_array(f"{name}_{what}", np.asarray(array, float)) for what, array in arrays.items())
    said = "\n".join(f"   {line}".rstrip() for line in notes).replace("*/", "* /")
    numbers = {
        "FIRST": table.first, "LAST": table.last, "SOFT": table.soft, "Q0": table.q[0], "Q1": table.q[1],
        "H0": table.length[0], "H1": table.length[1], "WIDTH": table.width, "LEAST": table.least,
    }  # fmt: skip
    words = {key: f"({float(value)!r})" for key, value in numbers.items()} | {
        "NAME": name, "GUARD": name.upper(), "N": str(n), "M": str(m), "NR": str(table.radius.shape[0]),
        "MR": str(table.radius.shape[1]), "KL": str(len(table.low)), "KH": str(len(table.high)), "TABLES": tables,
        "NOTES": said, **sizes,
    }  # fmt: skip
    return re.sub(r"@([A-Z0-9]+)@", lambda found: words[found[1]], template)


def check_name(name: str, field: str) -> None:
    """SpecError for a name that C does not take."""
    if not re.fullmatch(r"[A-Za-z]\w*", name, re.ASCII):
        raise SpecError(field, name, "must be letters, digits and _, a letter first", 'such as "muscle"')


def _array(name: str, values: np.ndarray) -> str:
    sizes = "".join(f"[{size}]" for size in values.shape)
    return f"static const double {name}{sizes} = {_braces(values)};\n"


def _braces(values: np.ndarray) -> str:
    if values.ndim == 1:
        return "{" + ", ".join(repr(float(one)) for one in values) + "}"
    return "{\n" + ",\n".join(_braces(one) for one in values) + "}"

"""Carlson's elliptic integrals, by duplication (1995): SciPy's take a third of a second to import.

The arguments approach their mean by a factor of four at a time; the series about the mean is then exact to rounding.
"""

import math

CLOSE = 1e-3
"""Relative distance from the mean below which the sixth power, what the series leaves out, is rounding."""


def elliprf(x: float, y: float, z: float) -> float:
    """R_F(x, y, z), the integral of dt / (2 sqrt((t + x)(t + y)(t + z))) from 0; at most one argument is zero."""
    while True:
        mean = (x + y + z) / 3.0
        X, Y = 1.0 - x / mean, 1.0 - y / mean
        Z = -X - Y
        if max(abs(X), abs(Y), abs(Z)) < CLOSE:
            break
        shift = math.sqrt(x * y) + math.sqrt(y * z) + math.sqrt(z * x)
        x, y, z = 0.25 * (x + shift), 0.25 * (y + shift), 0.25 * (z + shift)
    E2, E3 = X * Y - Z * Z, X * Y * Z
    return (1.0 - E2 / 10.0 + E3 / 14.0 + E2 * E2 / 24.0 - 3.0 * E2 * E3 / 44.0) / math.sqrt(mean)


def elliprd(x: float, y: float, z: float) -> float:
    """R_D(x, y, z) = R_J(x, y, z, z), the integral of 3 dt / (2 sqrt((t + x)(t + y)) (t + z)^1.5) from 0; z > 0."""
    total, factor = 0.0, 1.0
    while True:
        mean = (x + y + 3.0 * z) / 5.0
        X, Y = 1.0 - x / mean, 1.0 - y / mean
        Z = -(X + Y) / 3.0
        if max(abs(X), abs(Y), abs(Z)) < CLOSE:
            break
        shift = math.sqrt(x * y) + math.sqrt(y * z) + math.sqrt(z * x)
        total += factor / (math.sqrt(z) * (z + shift))
        factor *= 0.25
        x, y, z = 0.25 * (x + shift), 0.25 * (y + shift), 0.25 * (z + shift)
    E2, E3 = X * Y - 6.0 * Z * Z, (3.0 * X * Y - 8.0 * Z * Z) * Z
    E4, E5 = 3.0 * (X * Y - Z * Z) * Z * Z, X * Y * Z**3
    series = 1.0 - 3.0 * E2 / 14.0 + E3 / 6.0 + 9.0 * E2 * E2 / 88.0 - 3.0 * E4 / 22.0 - 9.0 * E2 * E3 / 52.0
    return factor * (series + 3.0 * E5 / 26.0) / (mean * math.sqrt(mean)) + 3.0 * total

"""The words and counts of a verdict, which results carry. Nothing here computes: reading a result needs no solver."""

from enum import StrEnum

import attrs


class Verdict(StrEnum):
    """Whether a state can be held; compares equal to its word."""

    STABLE = "stable"
    UNSTABLE = "unstable"
    INADMISSIBLE = "inadmissible"
    NO_EQUILIBRIUM = "no equilibrium"
    NOT_CONVERGED = "not converged"


class Shape(StrEnum):
    """Shape of the meridian. The first two are admissible; the others cannot exist or are outside the model."""

    ORDINARY = "ordinary"
    OVERHANG = "overhang"
    BEHIND_END_PLANE = "behind the end plane"
    SELF_CONTACT = "self-contact"
    ROLLED_UP = "rolled up"


@attrs.frozen
class Modes:
    """Numbers of negative modes, and the softest stiffness of each kind over the stiffest.

    The antisymmetric ones are None where a discretisation does not separate them.
    """

    length_control: int
    force_control: int
    antisymmetric: int | None
    softest_length: float
    softest_force: float
    softest_antisymmetric: float | None

    def softest(self, length_held: bool) -> float:
        """Least stiffness of any symmetry under length or force control: zero at a limit of stability."""
        symmetric = self.softest_length if length_held else self.softest_force
        return symmetric if self.softest_antisymmetric is None else min(symmetric, self.softest_antisymmetric)

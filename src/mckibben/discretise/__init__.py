"""From a field over the length to finitely many unknowns, and from a pointwise energy to totals and derivatives."""

"""Derivatives of motions: a motion that was simulated, as a function of the numbers of its rig."""

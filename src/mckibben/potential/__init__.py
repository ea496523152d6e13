"""A map of a muscle as numbers: one potential of length and pressure, and what is read off it."""

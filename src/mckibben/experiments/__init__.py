"""The calls: run, solve, limits, force maps, responses and sensitivities."""

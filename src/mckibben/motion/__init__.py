"""Muscles in motion: air, loads, signals and controllers over time."""

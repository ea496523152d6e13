"""Measured data: files as laboratories write them, read into a typed dataset in SI, and compared with curves."""

"""Many designs at once: sweeps over fields of the muscle and its test."""

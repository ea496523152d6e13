"""The paper's tests and figures: the one place where pictures meet mechanics."""

"""`SweepError`: a sweep that could not go on."""

__all__ = ["SweepError"]


class SweepError(RuntimeError):
    """A sweep was cut short by something outside it: a full disk, a lost scheduler. What is finished is kept."""

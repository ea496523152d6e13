"""`SweepError`: a sweep that could not go on."""

__all__ = ["SweepError"]


class SweepError(RuntimeError):
    """A sweep was cut short by something outside it: a full disk, a lost scheduler. What is finished is kept.

    A RuntimeError. The same call of `sweep` with the same `to` goes on from what is kept. Designs that cannot be solved
    do not raise it: their `status` and `reason` in the Dataset say so.

    >>> test = mk.Isometric(length="115 mm", pressure="1 bar")
    >>> over = {"braid.angle": ["36 deg", "37 deg"]}
    >>> try:
    ...     data = mk.sweep(mk.presets.paper(), test, over, tolerance=1e-4, to="designs.zarr")
    ... except mk.SweepError as error:
    ...     print("make room and call again:", error)
    >>> data.sizes["braid.angle"]
    2
    """

    def _render_traceback_(self) -> list[str]:
        """What a notebook shows: where the package noticed does not help."""
        return [f"{type(self).__name__}: {self}"]

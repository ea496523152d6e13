"""Chunks of a sweep on many processes and machines, by Dask."""

from collections.abc import Callable, Iterator

from mckibben.study.chunk import solve
from mckibben.study.designs import Piece, Plan
from mckibben.study.outcome import Columns


def here(piece: Piece, watch: Callable[[int], None]) -> Columns:
    return solve(piece, watch)


def spread(plan: Plan, missing: list[int], workers: int | None, scheduler: str | None) -> Iterator[tuple[int, Columns]]:
    raise NotImplementedError

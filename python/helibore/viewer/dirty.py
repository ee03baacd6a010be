"""What a page still lacks, in bounded memory: a few half-open intervals instead of a queue.

A slow or hidden page costs at most `MOST` intervals a tile, however long it is away; when it comes back it gets the
latest values once. Two intervals that touch become one; beyond `MOST` the pair with the smallest gap becomes one,
which resends that gap and loses nothing.
"""

from __future__ import annotations

from helibore.base.ranges import Range as Interval
from helibore.base.ranges import union

__all__ = ["MOST", "Interval", "add"]
MOST = 4


def add(intervals: list[Interval], start: int, stop: int) -> list[Interval]:
    """Return the sorted intervals with [start, stop) added, at most `MOST` of them."""
    return union([*intervals, (start, stop)], MOST)

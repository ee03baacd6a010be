"""What a page still lacks, in bounded memory: a few half-open intervals instead of a queue.

A slow or hidden page costs at most `MOST` intervals a tile, however long it is away; when it comes back it gets the
latest values once. Two intervals that touch become one; beyond `MOST` the pair with the smallest gap becomes one,
which resends that gap and loses nothing.
"""

from __future__ import annotations

MOST = 4

Interval = tuple[int, int]


def add(intervals: list[Interval], start: int, stop: int) -> list[Interval]:
    """Return the sorted intervals with [start, stop) added, at most `MOST` of them."""
    if stop <= start:
        return intervals
    kept: list[Interval] = []
    for a, b in intervals:
        if b < start or a > stop:
            kept.append((a, b))
        else:
            start, stop = min(a, start), max(b, stop)
    kept.append((start, stop))
    kept.sort()
    while len(kept) > MOST:
        gaps = [kept[i + 1][0] - kept[i][1] for i in range(len(kept) - 1)]
        i = gaps.index(min(gaps))
        kept[i : i + 2] = [(kept[i][0], kept[i + 1][1])]
    return kept

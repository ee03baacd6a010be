"""Half-open ranges [start, stop) of integers, such as changed vertices: their union, and how to cut one into pieces."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

Range = tuple[int, int]

PIECE = 1 << 18
"""Numbers in a piece: so few that they stay in the processor's cache and take little memory."""


def pieces(span: slice, size: int = PIECE) -> Iterator[slice]:
    """Yield a range in pieces of at most ``size`` numbers."""
    for start in range(span.start, span.stop, size):
        yield slice(start, min(start + size, span.stop))


def union(ranges: Iterable[Iterable[int]], most: int | None = None) -> list[Range]:
    """Return sorted ranges that cover all of ``ranges``. Ranges that touch are merged; empty ranges are removed.

    If there are more than ``most`` ranges, those with the narrowest gaps between them are merged too; of equal gaps,
    the first is closed first.
    """
    found: list[list[int]] = []
    for start, stop in sorted((int(start), int(stop)) for start, stop in ranges):
        if found and start <= found[-1][1]:
            found[-1][1] = max(stop, found[-1][1])
        elif start < stop:
            found.append([start, stop])
    excess = 0 if most is None else max(len(found) - most, 0)
    gaps = sorted(range(1, len(found)), key=lambda after: found[after][0] - found[after - 1][1])
    for after in sorted(gaps[:excess], reverse=True):
        found[after - 1][1] = found.pop(after)[1]
    return [(start, stop) for start, stop in found]

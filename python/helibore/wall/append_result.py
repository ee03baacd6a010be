"""Two results that a live host gets from a wall: what an append changed, and the values of a range of vertices.

    change = wall.append(depth, toolface, radius)
    for start, stop in change.ranges:
        columns = wall.vertices(start, stop)

`Wall` makes both results; this file computes nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from helibore.base.arrays import Floats, Integers, Integers32, Mask


@dataclass(eq=False, repr=False, slots=True)
class Change:
    """What an append changed.

    Attributes
    ----------
    ranges
        (m, 2) int64, sorted half-open (start, stop) ranges of vertices that are new or have other values than before.
    settled
        Vertices before this number no longer change while the hole only gets deeper.
    accepted, redundant
        Number of samples taken, and number of samples dropped because the wall already has a sample of equal depth,
        time, toolface and radius.
    """

    ranges: Integers
    settled: int
    accepted: int
    redundant: int

    def __len__(self) -> int:
        return int((self.ranges[:, 1] - self.ranges[:, 0]).sum())

    def __repr__(self) -> str:
        counts = f"settled={self.settled}, accepted={self.accepted}, redundant={self.redundant}"
        return f"Change({len(self)} vertices in {len(self.ranges)} ranges, {counts})"


class VertexColumns(NamedTuple):
    """The values of a range of vertices at one moment; the names are those of the properties of `Wall`."""

    depth: Floats
    toolface: Floats
    radius: Floats
    nearest: Floats
    support: Integers32
    iterations: Integers32
    provisional: Mask

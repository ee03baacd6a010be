"""What an append changed, and the values of some vertices at one moment: what a live host asks a wall for.

    change = wall.append(depth, toolface, radius)
    for start, stop in change.ranges:
        columns = wall.vertices(start, stop)

Made by `Wall`; nothing is computed here.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats, Integers


class Change:
    """What an append changed.

    Attributes
    ----------
    ranges
        (m, 2) int64, sorted half-open (start, stop) ranges of vertices that are new or have other values than before.
    settled
        Vertices below this no longer change while the hole only gets deeper.
    accepted
        Samples taken.
    redundant
        Samples dropped because one equal in depth, time, toolface and radius was there.
    """

    __slots__ = ("accepted", "ranges", "redundant", "settled")

    def __init__(self, ranges: Integers, settled: int, accepted: int, redundant: int) -> None:
        self.ranges, self.settled, self.accepted, self.redundant = ranges, settled, accepted, redundant

    def __len__(self) -> int:
        """Return the number of vertices that are new or changed."""
        return int((self.ranges[:, 1] - self.ranges[:, 0]).sum())

    def __repr__(self) -> str:
        return (
            f"Change({len(self)} vertices in {len(self.ranges)} ranges, settled={self.settled}, "
            f"accepted={self.accepted}, redundant={self.redundant})"
        )


class VertexColumns(NamedTuple):
    """One value for each of some vertices, all of one moment.

    Attributes
    ----------
    depth, toolface, radius, nearest, support, iterations, provisional
        As the properties of `Wall` of these names.
    """

    depth: Floats
    toolface: Floats
    radius: Floats
    nearest: Floats
    support: npt.NDArray[np.int32]
    iterations: npt.NDArray[np.int32]
    provisional: npt.NDArray[np.bool_]

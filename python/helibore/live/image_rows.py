"""The rows of one live image in order of arrival; one thread appends while others read.

    buffer  | row 0 | row 1 | ... | row count-1 | free ...               |      doubled when it is full

A row never changes after it arrives. So a reader holds the lock only to get buffers and count, and copies later.
"""

from __future__ import annotations

import threading

import numpy as np

from helibore.base.arrays import Floats


class ImageRows:
    """Rows of one sector image in order of arrival: depth m, values. May be used from several threads."""

    def __init__(self, sectors: int, unit: str) -> None:
        self.sectors, self.unit = sectors, unit
        self._depth: Floats = np.empty(0)
        self._values: Floats = np.empty((0, sectors))
        self._count = 0
        self._lock = threading.Lock()

    def append(self, depth: Floats, values: Floats) -> tuple[int, int]:
        """Append rows; return their range."""
        with self._lock:
            start, stop = self._count, self._count + len(depth)
            if stop > len(self._depth):
                self._depth = _longer(self._depth, start, max(stop, 2 * start))
                self._values = _longer(self._values, start, max(stop, 2 * start))
            self._depth[start:stop], self._values[start:stop] = depth, values
            self._count = stop
            return start, stop

    def __len__(self) -> int:
        return self._count

    def so_far(self) -> tuple[Floats, Floats]:
        """Return (depth (r,), values (r, sectors)) in order of arrival; not copies: do not change them."""
        with self._lock:
            return self._depth[: self._count], self._values[: self._count]

    def rows(self, start: int, stop: int) -> tuple[Floats, Floats]:
        """Return (depth (r,), values (r, sectors)) of the rows [start, stop) in order of arrival; copies.

        `Update.images` has such ranges. :meth:`arrays` returns all rows by depth, only the latest of each depth.
        """
        depth, values = self.so_far()
        return depth[start:stop].copy(), values[start:stop].copy()

    def arrays(self) -> tuple[Floats, Floats]:
        """Return (depth (r,), values (r, sectors)) sorted by depth, only the latest row of each depth; copies."""
        return sorted_rows(*self.so_far())


def sorted_rows(depth: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Sort rows in order of arrival by depth; return copies, only the latest row of each depth."""
    order = np.argsort(depth, kind="stable")
    latest = order[np.append(np.diff(depth[order]) > 0, True)[: len(order)]]
    return depth[latest], values[latest]


def _longer(full: Floats, count: int, capacity: int) -> Floats:
    longer = np.empty((capacity, *full.shape[1:]))
    longer[:count] = full[:count]
    return longer

"""The rows of one live image in order of arrival; one thread appends while others read.

    buffer  | row 0 | row 1 | ... | row count-1 | free ...               |      doubled when it is full

A row never changes after it arrives. So a reader holds the lock only to get buffers and count, and copies later. With a
``step``, a later row in the same step of depth replaces an earlier row. The earlier row is deleted when the buffer is
full. So the memory depends on the length of the hole, not on the number of rows that arrive.
"""

from __future__ import annotations

import threading

import numpy as np

from helibore.base.arrays import Floats, Integers

Columns = tuple[Integers, Floats, Floats]
"""Number, depth and values of each row."""


class ImageRows:
    """Holds the rows of one sector image in order of arrival; several threads may use it at the same time.

    Parameters
    ----------
    sectors, unit
        Number of values of a row, and their unit.
    step
        Length of a step of depth, metres; only the latest row in each step counts. 0: all rows are kept.
    """

    def __init__(self, sectors: int, unit: str, step: float = 0.0) -> None:
        self.sectors, self.unit, self.step = sectors, unit, step
        self._columns: Columns = np.empty(0, np.int64), np.empty(0), np.empty((0, sectors))
        self._kept = self._count = 0
        self._lock = threading.Lock()

    def append(self, depth: Floats, values: Floats) -> tuple[int, int]:
        """Append rows; return the range of their numbers."""
        with self._lock:
            start, stop = self._count, self._count + len(depth)
            if self._kept + len(depth) > len(self._columns[0]):
                self._make_room(len(depth))
            at = slice(self._kept, self._kept + len(depth))
            for column, rows in zip(self._columns, (np.arange(start, stop), depth, values), strict=True):
                column[at] = rows
            self._kept, self._count = at.stop, stop
            return start, stop

    def set_step(self, step: float) -> None:
        """Set the step from now on; first delete the rows that later rows replace according to the old step."""
        with self._lock:
            if step != self.step:
                self._make_room(0)
                self.step = step

    def _make_room(self, more: int) -> None:
        """Delete the rows that later rows replace; make longer buffers, with room for ``more`` rows."""
        rows = [column[: self._kept] for column in self._columns]
        if self.step:
            latest = np.sort(_latest(self._columns[1][: self._kept], self.step))
            rows = [column[latest] for column in rows]
        self._kept = len(rows[0])
        capacity = max(self._kept + more, 2 * self._kept)
        longer = np.empty(capacity, np.int64), np.empty(capacity), np.empty((capacity, self.sectors))
        for column, kept in zip(longer, rows, strict=True):
            column[: self._kept] = kept
        self._columns = longer

    def restore(self, number: Integers, depth: Floats, values: Floats) -> None:
        """Set the rows to the columns that `so_far` returned."""
        self._columns, self._kept = (number, depth, values), len(number)
        self._count = int(number[-1]) + 1 if len(number) else 0

    def __len__(self) -> int:
        """Return the number of rows that have come, including deleted rows."""
        return self._count

    def so_far(self) -> Columns:
        """Return (number (r,), depth (r,), values (r, sectors)) of the kept rows. Do not change these arrays."""
        with self._lock:
            number, depth, values = self._columns
            return number[: self._kept], depth[: self._kept], values[: self._kept]

    def rows(self, start: int, stop: int) -> tuple[Floats, Floats]:
        """Return copies of the rows with numbers in [start, stop), as (depth (r,), values (r, sectors)).

        Rows that were deleted are left out. `Update.images` has such ranges of numbers. :meth:`arrays` returns only
        the latest row of each depth or step.
        """
        number, depth, values = self.so_far()
        first, last = np.searchsorted(number, (start, stop))
        return depth[first:last].copy(), values[first:last].copy()

    def arrays(self) -> tuple[Floats, Floats]:
        """Return copies of the latest row of each depth or step, by depth: (depth (r,), values (r, sectors))."""
        return sorted_rows(*self.so_far()[1:], self.step)


def sorted_rows(depth: Floats, values: Floats, step: float = 0.0) -> tuple[Floats, Floats]:
    """Return copies of the rows, sorted by depth; only the latest row at each depth, or in each step, is returned.

    The rows are given in order of arrival.
    """
    latest = _latest(depth, step)
    return depth[latest], values[latest]


def _latest(depth: Floats, step: float) -> Integers:
    """Return the index of the latest row at each depth or, if ``step`` is not 0, in each step; sorted by depth."""
    place = np.floor(depth / step) if step else depth
    order = np.argsort(place, kind="stable")
    latest: Integers = order[np.append(np.diff(place[order]) > 0, True)[: len(order)]]
    return latest

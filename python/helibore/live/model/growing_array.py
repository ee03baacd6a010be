"""An array that grows at its end and is shortened at its start, at a cost that does not depend on its length."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Array


class GrowingArray:
    """An array with the entries ``values``; one thread may change it while others read ``values``.

    room  [ deleted | values | free ]      an append that needs more room moves the values to an array of twice the size
    """

    STATE = ("values",)

    def __init__(self, dtype: npt.DTypeLike) -> None:
        self.values = np.empty(0, dtype)

    @property
    def values(self) -> Array:
        """A view of the entries; an append does not change a view that was read before."""
        room, start, stop = self._held
        return room[start:stop]

    @values.setter
    def values(self, values: Array) -> None:
        self._held = values, 0, len(values)  # one assignment: another thread sees all of a change or nothing of it

    def append(self, values: Array) -> None:
        """Append entries."""
        room, start, stop = self._held
        if stop + len(values) > len(room):
            before = room[start:stop]
            room = np.empty(2 * (len(before) + len(values)), before.dtype)
            start, stop = 0, len(before)
            room[:stop] = before
        room[stop : stop + len(values)] = values
        self._held = room, start, stop + len(values)

    def forget(self, count: int) -> None:
        """Delete the first ``count`` entries."""
        room, start, stop = self._held
        self._held = room, start + count, stop

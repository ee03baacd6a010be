"""An array that grows at its end and is shortened at its start, at a cost that does not depend on its length."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt


class GrowingArray:
    """An array with the entries ``values``, a view. An append that needs room moves them to an array of twice the size.

    room  [ forgotten | values        | free     ]
    """

    STATE = ("values",)

    def __init__(self, dtype: npt.DTypeLike) -> None:
        self.values = np.empty(0, dtype)

    @property
    def values(self) -> npt.NDArray[Any]:
        """The entries; an append does not change what was read before."""
        return self._room[self._start : self._stop]

    @values.setter
    def values(self, values: npt.NDArray[Any]) -> None:
        self._room, self._start, self._stop = values, 0, len(values)

    def append(self, values: npt.NDArray[Any]) -> None:
        """Append entries."""
        if self._stop + len(values) > len(self._room):
            held = self.values
            self._room = np.empty(2 * (len(held) + len(values)), held.dtype)
            self._room[: len(held)] = held
            self._start, self._stop = 0, len(held)
        self._room[self._stop : self._stop + len(values)] = values
        self._stop += len(values)

    def forget(self, count: int) -> None:
        """Delete the first ``count`` entries."""
        self._start += count

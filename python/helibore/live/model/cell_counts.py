"""Limit the samples that a wall keeps of one source near each vertex, so that the length of the hole bounds memory.

a cell of the wall          | 4 3 |     A cell has two parts around the hole and four along it. The numbers count the
(one vertex, one quad)      | 0 2 |     samples of one source that the wall keeps in each part: the first ``most`` / 8,
                            | 7 1 |     rounded up. The wall does not keep later samples; the model only counts them,
                            | 5 5 |     as "crowded".
"""

from __future__ import annotations

import numpy as np

from helibore.base.arrays import Floats, Integers, Mask, Unsigned16, distinct

PARTS_AROUND, PARTS_ALONG = 2, 4
CHUNK = 4096


class CellCounts:
    """Counts the samples of one source that the wall keeps in each part of a cell, and chooses these samples.

    Parameters
    ----------
    sectors, pitch
        As in `Wall`.
    most
        The most samples of a cell that are kept, as in `set_most`.
    """

    STATE = ("counted",)

    def __init__(self, sectors: int, pitch: float, most: int = 0) -> None:
        self._around, self._along = PARTS_AROUND * sectors, abs(pitch) / PARTS_ALONG
        self.set_most(most)
        self._counts: dict[int, Unsigned16] = {}

    def set_most(self, most: int) -> None:
        """Set how many samples of a cell are kept from now on: ``most``, rounded up to a multiple of 8; 0: all."""
        self._most = -(-most // (PARTS_AROUND * PARTS_ALONG))

    @property
    def counted(self) -> tuple[Integers, Unsigned16]:
        """For each chunk of CHUNK parts that has samples: its number (n,), and the counts of its parts (n, CHUNK)."""
        chunks = np.array(list(self._counts), np.int64)
        return chunks, np.array(list(self._counts.values()), np.uint16).reshape(-1, CHUNK)

    @counted.setter
    def counted(self, counted: tuple[Integers, Unsigned16]) -> None:
        self._counts = dict(zip(counted[0].tolist(), counted[1], strict=True))

    def take(self, depth: Floats, toolface: Floats) -> Mask:
        """Count these samples, given in order of arrival, and return for each whether the wall keeps it."""
        if not self._most:
            return np.ones(len(depth), bool)
        part = np.floor(depth / self._along).astype(np.int64) * self._around
        part += np.minimum(toolface * (self._around / 360.0), self._around - 1).astype(np.int64)
        order = np.argsort(part, kind="stable")
        parts, first, number = np.unique(part[order], return_index=True, return_counts=True)
        before = np.empty(len(parts), np.int64)
        chunks = parts // CHUNK
        for chunk in distinct(chunks).tolist():
            counts = self._counts.setdefault(chunk, np.zeros(CHUNK, np.uint16))
            of = chunks == chunk
            at = parts[of] % CHUNK
            before[of] = counts[at]
            counts[at] = np.maximum(before[of], np.minimum(before[of] + number[of], self._most))
        rank = np.arange(len(part)) - np.repeat(first - before, number)
        kept = np.empty(len(part), bool)
        kept[order] = rank < self._most
        return kept

"""Check the sequence numbers (item 04) of one record type of one source: gaps, late frames, resets, the wrap at 2^31.

    number n after number last      meaning
    last + 1, or 0 after 2^31 - 1   as expected
    greater                         the numbers between them are missing
    less, and was missing           late
    more than LONGEST_GAP greater   the counter was reset
    1 after a repeated number       the counter was reset
    any other                       repeated

``mapping.py`` decides by the text of a frame whether it is a duplicate, so two frames with equal numbers and different
values are both kept.
"""

from __future__ import annotations

import bisect

import numpy as np

from helibore.base.arrays import Floats, Integers
from helibore.live.model.events import Flag

WRAP = 1 << 31
LONGEST_GAP = 65536
MOST_GAPS = 1024


class SequenceWatch:
    """Checks the numbers of one counter.

    Attributes
    ----------
    missing
        Ranges [start, stop) of skipped numbers that may still arrive, sorted; only the last MOST_GAPS are kept.
    lost
        Number of skipped numbers that have not arrived. They count also after a reset.
    """

    STATE = ("last", "missing", "lost", "_repeated")

    def __init__(self) -> None:
        self.last: int | None = None
        self.missing: list[tuple[int, int]] = []
        self.lost = 0
        self._repeated: int | None = None

    def take(self, numbers: Floats) -> tuple[Integers, list[tuple[int, str, str]]]:
        """Return for each number its flags (GAP_BEFORE, LATE or 0), and the (index, rule, text) of each event.

        NaN and numbers outside [0, 2^31) are not checked.
        """
        flags = np.zeros(len(numbers), np.int64)
        known = np.flatnonzero((numbers >= 0) & (numbers < WRAP))
        if not len(known):
            return flags, []
        whole = numbers[known].astype(np.int64)
        if self.last is not None and whole[0] == self.last + 1 and (np.diff(whole) == 1).all():
            self.last, self._repeated = int(whole[-1]), None
            return flags, []
        reported: list[tuple[int, str, str]] = []
        for index, number in zip(known.tolist(), whole.tolist(), strict=True):
            flag, rule, text = self._step(number)
            flags[index] |= flag
            if rule:
                reported.append((index, rule, text))
        return flags, reported

    def _step(self, number: int) -> tuple[int, str, str]:
        last = self.last
        if last is None or number == last + 1 or (last == WRAP - 1 and number == 0):
            self.last, self._repeated = number, None
            return 0, "", ""
        if number > last and number - last <= LONGEST_GAP:
            bisect.insort(self.missing, (last + 1, number))
            del self.missing[:-MOST_GAPS]
            self.lost += number - last - 1
            self.last, self._repeated = number, None
            return Flag.GAP_BEFORE, "gap", f"sequence number {number} after {last}: {number - last - 1} missing"
        if self._arrives(number):
            self.lost -= 1
            return Flag.LATE, "late", f"sequence number {number} after {last}: late"
        if number > last or number == (self._repeated if self._repeated is not None else number) + 1:
            self.last, self._repeated, self.missing = number, None, []
            return Flag.GAP_BEFORE, "reset", f"sequence number {number} after {last}: the counter was reset"
        self._repeated = number
        return 0, "repeated", f"sequence number {number} after {last}: repeated"

    def _arrives(self, number: int) -> bool:
        """Remove ``number`` from the missing numbers; return whether it was missing."""
        at = bisect.bisect_right(self.missing, (number, WRAP)) - 1
        if at < 0 or number >= self.missing[at][1]:
            return False
        start, stop = self.missing[at]
        rest = [(start, number), (number + 1, stop)]
        self.missing[at : at + 1] = [one for one in rest if one[0] < one[1]]
        del self.missing[:-MOST_GAPS]
        return True

"""The model's time: it never goes back, even if someone sets the wall clock.

    time = anchor + (monotonic - monotonic at the anchor)

A session begins when the journal is opened. Each session has one anchor: the later of the wall clock at that moment and
the model's last time. So the model's time is wrong where a machine begins in 1970, or after a session whose clock was
ahead. `ModelClock.utc` shows it by the last clock of its session, because somebody sets a clock when it is wrong:

    shown = time + (wall clock - time, at the end of the session)
"""

from __future__ import annotations

from bisect import bisect_right

import numpy as np

from helibore.base.arrays import Integers
from helibore.base.utc_time import SECOND

JUMP = 2 * SECOND
"""Nanoseconds. If the difference of wall clock and model time changes by this or more, someone set the wall clock."""


class ModelClock:
    """Converts receive times (wall clock and monotonic clock, ns) to model time (ns)."""

    STATE = ("_anchor", "_start", "_drift", "_sessions", "now", "began")

    def __init__(self) -> None:
        self._anchor = 0
        self._start = 0
        self._drift = 0
        self._sessions = [(0, 0)]  # begin of each, and by how much its last clock differed
        self.now = 0
        self.began = 0

    def begin_session(self, wall: int, monotonic: int) -> int:
        """Begin a session; return by how many ns the wall clock is behind the model's latest time, or 0."""
        first, self._anchor = not self.now, max(wall, self.now)
        self._start = monotonic
        self._drift = wall - self._anchor
        self._sessions.append((0 if first else self._anchor, self._drift))  # a latency may reach before the first
        self.began = self.began or self._anchor
        behind = self._anchor - wall
        self.now = self._anchor
        return behind

    def times(self, monotonic: Integers) -> Integers:
        """Return the model time of each record; the times never decrease."""
        times = np.maximum.accumulate(np.maximum(monotonic + (self._anchor - self._start), self.now))
        self.now = int(times[-1])
        return times

    def jumps(self, wall: Integers, times: Integers) -> list[tuple[int, int]]:
        """Return (index of the record after the jump, change in ns) for each jump of the wall clock (see `JUMP`)."""
        drift, found, start = wall - times, [], 0
        while len(late := (np.abs(drift[start:] - self._drift) >= JUMP).nonzero()[0]):
            start += int(late[0])
            found.append((start, int(drift[start]) - self._drift))
            self._drift = int(drift[start])
            self._sessions[-1] = self._sessions[-1][0], self._drift
        return found

    def utc(self, time: int) -> int:
        """Return what a model time was by the last clock of its session, ns since 1970."""
        return time + self._sessions[bisect_right(self._sessions, time, key=lambda of: of[0]) - 1][1]

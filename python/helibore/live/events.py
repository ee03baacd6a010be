"""What went wrong, or changed, on the way from a wire to a wall: events that name source, place and rule, and flags.

An event is told once; every occurrence is counted. Bad bytes stay in the journal at the place the event names.
"""

from __future__ import annotations

import enum
from collections import Counter, deque
from dataclasses import dataclass


class Flag(enum.IntFlag):
    """Why a sample is not drawn, or is drawn with care."""

    NULL = 1
    INVALID = 2
    RANGE = 4
    DUPLICATE = 8
    LATE = 16
    GAP_BEFORE = 32
    OFF_BOTTOM = 64
    NOT_ROTATING = 128
    NO_DEPTH = 256


NEVER_DRAWN = Flag.NULL | Flag.INVALID | Flag.RANGE | Flag.DUPLICATE | Flag.NOT_ROTATING | Flag.NO_DEPTH


@dataclass(frozen=True, slots=True)
class Event:
    """One thing worth telling.

    Attributes
    ----------
    wall
        Receive time, ns since 1970.
    source, connection
        Whose bytes; ``""`` and 0 for the journal and the host.
    line, offset
        Place in the connection's stream; 0 and -1 when the event has none.
    rule
        Its kind, and the key of its counter.
    text
        What happened, in words: place, value, rule.
    """

    wall: int
    source: str
    connection: int
    line: int
    offset: int
    rule: str
    text: str

    def __str__(self) -> str:
        place = f"{self.source} connection {self.connection}" if self.source else "helibore"
        return f"{place}{f' line {self.line}' if self.line else ''}: {self.rule}: {self.text}"


class EventBook:
    """Counts every event, keeps the latest ``kept`` and hands out new ones once."""

    def __init__(self, kept: int = 1000, at_once: int = 100) -> None:
        self.counts: Counter[tuple[str, str]] = Counter()
        self.latest: deque[Event] = deque(maxlen=kept)
        self._new: list[Event] = []
        self._at_once = at_once

    def tell(self, event: Event, times: int = 1) -> None:
        """Count ``event``; of a flood between two calls of :meth:`take`, only the first ones are kept as texts."""
        self.counts[event.source, event.rule] += times
        if len(self._new) < self._at_once:
            self._new.append(event)
            self.latest.append(event)

    def take(self) -> list[Event]:
        """Return what was told since the last call."""
        new, self._new = self._new, []
        return new

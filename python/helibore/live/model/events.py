"""Events (source, time, place, rule) and flags of samples: what went wrong or changed between wire and wall.

    gap at 10:02:11    gap at 10:02:12    ...    gap at 14:55:02     ->    one event: 37 times, the first, the last

Every occurrence is counted. Events with the same source and rule are joined, so that many events take no more memory
than a few events. The time of an event is the time at which its bytes were received, so a replay reports the same
events. A replay reads many records together, so it may report their events in another order, also the events of one
rule. Wrong bytes stay in the journal at the place that the event names.
"""

from __future__ import annotations

import datetime
import enum
import logging
import threading
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

from helibore.base.arrays import Integers
from helibore.base.utc_time import utc

LOGGER = logging.getLogger("helibore.live")
LOGGER.addHandler(logging.NullHandler())  # a host decides where its events go
LISTED = 8
"""The most events of one rule of one source that an update lists; the last of these events counts all later events."""


class Flag(enum.IntFlag):
    """Why a sample is not drawn, or why it may be less reliable."""

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
    """One occurrence of a rule, or several joined occurrences of one rule of one source.

    Attributes
    ----------
    wall
        Time at which the event's bytes were received, or at which an event without bytes (disk, link) happened; ns
        since 1970.
    source, connection
        Source and connection of the event's bytes; ``""`` and 0 for the journal and the host.
    line, offset
        Line of the connection's stream, from 1 (for a store: row of the answer), or 0 without a line; byte of the
        stream, or -1 without a byte.
    rule
        Kind of the event; source and rule together are the key of its counter.
    text
        What happened, in words: place, value, rule.
    count
        How often the event happened.
    last
        The event of the latest occurrence; None if that is this event.
    """

    wall: int
    source: str
    connection: int
    line: int
    offset: int
    rule: str
    text: str
    count: int = 1
    last: Event | None = None

    @property
    def time(self) -> datetime.datetime:
        """``wall`` as a UTC time."""
        return datetime.datetime.fromtimestamp(self.wall / 1e9, datetime.UTC)

    @property
    def newest(self) -> Event:
        """The event of the latest occurrence."""
        return self.last or self

    def and_then(self, more: Event) -> Event:
        """Return this event joined with ``more``, a later event of its rule and source; the counts are added."""
        return replace(self, count=self.count + more.count, last=more.newest)

    def __str__(self) -> str:
        last = self.newest
        place = f"{last.source} connection {last.connection}" if last.source and last.connection else last.source
        line = f" line {last.line}" if last.line else ""
        times = f" ({self.count} times since {utc(self.wall)})" if self.count > 1 else ""
        return f"{utc(last.wall)} {place or 'helibore'}{line}: {self.rule}: {last.text}{times}"


def gather(events: list[Event], more: Iterable[Event]) -> None:
    """Add events to a list, with at most LISTED events of one rule of one source; the last counts all later events."""
    places: dict[tuple[str, str], list[int]] = {}
    for place, event in enumerate(events):
        places.setdefault((event.source, event.rule), []).append(place)
    for event in more:
        _add(events, places, event)


def _add(events: list[Event], places: dict[tuple[str, str], list[int]], event: Event) -> None:
    there = places.setdefault((event.source, event.rule), [])
    if len(there) < LISTED:
        there.append(len(events))
        events.append(event)
    else:
        events[there[-1]] = events[there[-1]].and_then(event)


class EventBook:
    """Counts every event, joins the events of one rule of one source, and returns each new event once.

    Several threads may use it at the same time.

    Attributes
    ----------
    log
        Function that is called with each event when it is reported, in the thread that reports it; None: no function.
    recorded
        By source and rule, the events that records caused, joined as in `latest`; a replay reports them again.
    """

    STATE = ("recorded",)

    def __init__(self) -> None:
        self.log: Callable[[Event], None] | None = None
        self._joined: dict[tuple[str, str], Event] = {}
        self._recorded: dict[tuple[str, str], Event] = {}
        self._new: list[Event] = []
        self._places: dict[tuple[str, str], list[int]] = {}
        self._lock = threading.Lock()

    @property
    def recorded(self) -> dict[tuple[str, str], Event]:
        with self._lock:
            return dict(self._recorded)

    @recorded.setter
    def recorded(self, recorded: dict[tuple[str, str], Event]) -> None:
        with self._lock:
            self._recorded, self._joined = recorded, dict(recorded)

    @property
    def counts(self) -> Counter[tuple[str, str]]:
        """How often each rule of each source was reported."""
        with self._lock:
            return Counter({key: event.count for key, event in self._joined.items()})

    @property
    def latest(self) -> list[Event]:
        """All reported events, joined to one event for each rule of each source; the latest event is last."""
        with self._lock:
            return list(self._joined.values())

    def report(self, event: Event, *, recorded: bool = True) -> None:
        """Count ``event`` and join it to earlier events of its source and rule; ``recorded``: caused by a record."""
        key = event.source, event.rule
        if self.log is not None:
            self.log(event)
        with self._lock:
            for joined in (self._joined, self._recorded) if recorded else (self._joined,):
                before = joined.pop(key, None)  # the latest is at the end
                joined[key] = event if before is None else before.and_then(event)
            _add(self._new, self._places, event)

    def report_rows(self, rows: Sequence[int] | Integers, describe: Callable[[int], Event]) -> None:
        """Report an event for each row; ``describe`` is called only for the first LISTED rows and for the last row."""
        for row in rows[: LISTED - 1]:
            self.report(describe(int(row)))
        if len(rest := rows[LISTED - 1 :]):
            last = describe(int(rest[-1])) if len(rest) > 1 else None
            self.report(replace(describe(int(rest[0])), count=len(rest), last=last))

    def take(self) -> list[Event]:
        """Return the events reported since the last call."""
        with self._lock:
            new, self._new, self._places = self._new, [], {}
            return new

"""Decides the pass of each sample, and lists the passes of a well: time, depth and number of samples of each pass.

    wire       . . 1 1 1 1 2 2 2       number from the source; ".": it sends no number
    string     d d d d r r r r r       d: drill, r: rescan, from bit depth and rotation (depth.py)
    pass       d d d d d d r r r       the number decides; an event reports the two samples that differ
               |-| |-----| |---|       the runs of one source, each with its number and pass

A run is a row of consecutive samples of one source with one number and pass. It does not depend on how the stream was
cut into packets. The current run of each source and the latest 10,000 finished runs are kept.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from helibore.base.arrays import Floats, Integers, Rows, distinct
from helibore.live.model.events import Event, EventBook
from helibore.live.rules.pass_rules import NO_NUMBER, PASSES, UNKNOWN, PassNumbers

KEPT = 10_000


@dataclass(frozen=True, slots=True)
class Pass:
    """Consecutive samples of one source in one pass.

    Attributes
    ----------
    source
        Name of the source; ``""``: the host.
    name
        One of the names in `PASSES`.
    number
        Number that the source gave the pass; None if it gave no number.
    start, stop
        Earliest and latest time of the samples, ns of the model's clock (UTC since 1970, never going back).
    top, bottom
        Least and greatest depth of the samples, metres.
    samples
        Number of samples, including samples that no layer takes.
    """

    source: str
    name: str
    number: int | None
    start: int
    stop: int
    top: float
    bottom: float
    samples: int


class PassLog:
    """Decides the pass of each sample and keeps the runs.

    Parameters
    ----------
    meanings
        Name and table ``pass_numbers`` of each source, by its number in the journal. The host (0) has no entry.
    events
        The book to which the events about pass numbers are reported.
    """

    STATE = ("latest", "_over")

    def __init__(self, meanings: dict[int, tuple[str, PassNumbers]], events: EventBook) -> None:
        self.meanings, self._events = meanings, events
        self.latest: dict[int, Pass] = {}
        self._over: deque[Pass] = deque(maxlen=KEPT)

    @property
    def runs(self) -> list[Pass]:
        """The runs that are kept, sorted by start time."""
        return sorted([*self._over, *self.latest.values()], key=lambda run: (run.start, run.source))

    def decide(self, samples: Rows, kind: Integers) -> Integers:
        """Return the pass of each sample: what its number means, or else ``kind``, the pass from the string's motion.

        Parameters
        ----------
        samples
            Structured (n,): ``source``, ``number`` (pass number, or NO_NUMBER), ``wall``, ``connection``, ``line``.
        kind
            (n,) the pass from the string's motion, as an index into PASSES.
        """
        source, number = samples["source"], samples["number"]
        if not (number != NO_NUMBER).any():
            return kind
        decided = kind.copy()
        found: list[tuple[Integers, str]] = []
        for who, said in np.unique(np.stack([source, number])[:, number != NO_NUMBER], axis=1).T.tolist():
            meaning = self.meanings[who][1]
            means = meaning.kind(said)
            if means is None:
                continue
            rows = np.flatnonzero((source == who) & (number == said))
            decided[rows] = means
            if means == UNKNOWN:
                found.append((rows, f"pass number {said}: is not listed in pass_numbers; the pass is unknown"))
            for own in distinct(kind[rows]).tolist():
                if UNKNOWN not in (own, means) and own != means:
                    differ = rows[kind[rows] == own]
                    text = f"pass number {said} means {PASSES[means]}, but the string's motion means {PASSES[own]}"
                    found.append((differ, f"{text}; the number counts"))
        if found:
            which = np.repeat(np.arange(len(found)), [len(rows) for rows, _ in found])
            reported = np.concatenate([rows for rows, _ in found])
            self.report(samples, reported, "pass", lambda place: found[which[place]][1])
        return decided

    def report(self, samples: Rows, rows: Integers, rule: str, text: Callable[[int], str]) -> None:
        """Report an event for each of ``rows``, by source in order of arrival; ``text(i)`` describes ``rows[i]``."""
        order = np.argsort(rows, kind="stable")
        source = samples["source"][rows[order]]

        def describe(place: int) -> Event:
            return self._event(samples[rows[place]], rule, text(place))

        for who in distinct(source).tolist():
            self._events.report_rows(order[source == who], describe)

    def _event(self, sample: np.void, rule: str, text: str) -> Event:
        """Return an event with the time, source, connection and line of a sample."""
        name = self._name(int(sample["source"]))
        return Event(int(sample["wall"]), name, int(sample["connection"]), int(sample["line"]), -1, rule, text)

    def _name(self, source: int) -> str:
        return self.meanings[source][0] if source in self.meanings else ""

    def add(self, source: Integers, number: Integers, kind: Integers, time: Integers, depth: Floats) -> None:
        """Add samples to the runs of their sources; ``kind`` is the pass that `decide` returned."""
        for who in distinct(source).tolist():
            of = np.flatnonzero(source == who)
            changes = np.flatnonzero((np.diff(kind[of]) != 0) | (np.diff(number[of]) != 0)) + 1
            for rows in np.split(of, changes):
                self._extend(who, int(number[rows[0]]), int(kind[rows[0]]), time[rows], depth[rows])

    def _extend(self, who: int, number: int, kind: int, time: Integers, depth: Floats) -> None:
        said = None if number == NO_NUMBER else number
        more = Pass(self._name(who), PASSES[kind], said, int(time.min()), int(time.max()), float(depth.min()),
                    float(depth.max()), len(time))  # fmt: skip
        now = self.latest.get(who)
        if now is None or (now.name, now.number) != (more.name, more.number):
            if now is not None:
                self._over.append(now)
            self.latest[who] = more
            return
        self.latest[who] = replace(
            now, start=min(now.start, more.start), stop=max(now.stop, more.stop), top=min(now.top, more.top),
            bottom=max(now.bottom, more.bottom), samples=now.samples + more.samples,
        )  # fmt: skip

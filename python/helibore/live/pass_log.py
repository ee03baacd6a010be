"""The passes of a well in order of arrival: the pass of each sample, and time, depth and sample count of each pass.

    wire       . . 1 1 1 1 2 2 2       number from the source; ".": it sends no number
    string     d d d d r r r r r       drill, rescan: from bit depth and rotation (depth.py)
    pass       d d d d d d r r r       the number decides; an event reports the two samples that differ
               |-| |-----| |---|       the runs of one source, each with its number and pass

The runs of each source are in order of arrival, so they do not depend on how the stream was cut into packets. The
latest 10,000 runs are kept.
"""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from helibore.live.events import Event, EventBook
from helibore.live.pass_rules import NO_NUMBER, PASSES, UNKNOWN, PassNumbers

Integers = npt.NDArray[np.int64]
Rows = npt.NDArray[np.void]
KEPT = 10_000


@dataclass(frozen=True, slots=True)
class Pass:
    """Consecutive samples of one source in one pass.

    Attributes
    ----------
    source
        Name of the source; ``""``: the host.
    name
        A pass out of `PASSES`.
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
    """Decides the pass of samples and keeps the runs.

    Parameters
    ----------
    meanings
        Name and pass numbers of each source, by its number in the journal; a source without an entry sends no numbers.
    """

    STATE = ("latest", "_over")

    def __init__(self, meanings: dict[int, tuple[str, PassNumbers]], events: EventBook) -> None:
        self.meanings, self._events = meanings, events
        self.latest: dict[int, Pass] = {}
        self._over: deque[Pass] = deque(maxlen=KEPT)

    @property
    def runs(self) -> list[Pass]:
        """The runs, sorted by start time."""
        return sorted([*self._over, *self.latest.values()], key=lambda run: (run.start, run.source))

    def decide(self, samples: Rows, kind: Integers) -> Integers:
        """Return the pass of each sample: the meaning of its number, or else ``kind``, from the string's motion.

        Parameters
        ----------
        samples
            Fields ``source``, ``number`` (of the pass; NO_NUMBER: none), ``wall``, ``connection`` and ``line``.
        kind
            Pass from the string's motion, an index into PASSES.
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
            for own in np.unique(kind[rows]).tolist():
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

        for who in np.unique(source).tolist():
            self._events.report_rows(order[source == who], describe)

    def _event(self, sample: np.void, rule: str, text: str) -> Event:
        """Return an event at the place from which the sample came."""
        name = self._name(int(sample["source"]))
        return Event(int(sample["wall"]), name, int(sample["connection"]), int(sample["line"]), -1, rule, text)

    def _name(self, source: int) -> str:
        return self.meanings[source][0] if source in self.meanings else ""

    def add(
        self, source: Integers, number: Integers, kind: Integers, time: Integers, depth: npt.NDArray[np.float64]
    ) -> None:
        """Add samples to the runs of their sources; ``kind`` is the pass that `decide` returned."""
        for who in sorted(set(source.tolist())):
            if not (source == source[0]).all():
                rows = np.flatnonzero(source == who)
                self._add_of(who, number[rows], kind[rows], time[rows], depth[rows])
            else:
                self._add_of(who, number, kind, time, depth)

    def _add_of(
        self, who: int, number: Integers, kind: Integers, time: Integers, depth: npt.NDArray[np.float64]
    ) -> None:
        changes = np.flatnonzero((kind[1:] != kind[:-1]) | (number[1:] != number[:-1])) + 1
        for start, stop in itertools.pairwise([0, *changes.tolist(), len(kind)]):
            self._extend(who, int(number[start]), int(kind[start]), time[start:stop], depth[start:stop])

    def _extend(self, who: int, number: int, kind: int, time: Integers, depth: npt.NDArray[np.float64]) -> None:
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

"""Convert a store's answers to columns in core units, as ``mapping.py`` does for frames.

    journal bytes -> answers -> rows after the last index -> cells by unit -> triples, image rows, rig, stations

A row is skipped if its index is not after the last index, because a store sends the row at ``startIndex`` again. All
values of a curve are INVALID, with one event, if its unit is missing or unknown, measures another quantity, or is not
the unit of the image.
"""

from __future__ import annotations

import datetime
import math
import re

import numpy as np

from helibore.base import units
from helibore.base.arrays import Bytes, Floats, Integers
from helibore.base.utc_time import SECOND
from helibore.live.model.events import Event, EventBook
from helibore.live.model.mapping import ABSENT, INVALID, NULL, VALUE, Chunk, Reading, SourceReader
from helibore.live.model.named_reader import NamedReader
from helibore.live.model.sample_rows import frame_rows
from helibore.live.rules.depth_limits import DepthLimits
from helibore.live.rules.sources import INDEX, Item, StoreSource
from helibore.live.wire import witsml

NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d{1,3})?")
BLOCK = 1024
"""Number of rows that are split into cells at a time."""
STANDS = 300.0
"""Seconds for which a log by time may answer without a new row."""
BEHIND = 6
"""The number of answers in a row without a new row, although they have several rows, from which an alarm says so."""
FUTURE = 86_400.0
"""Seconds by which the clock of a store may be ahead of this machine's clock."""


class StoreReader(NamedReader):
    """Reads the answers of one store.

    Attributes
    ----------
    last
        Index of the latest row that was read, as (text, unit); the next query starts there. None if no row was read.
    """

    STATE = (
        *NamedReader.STATE, "_frames", "last", "_last_key", "_nulls", "_reported_jump", "_reported_index", "_grew",
        "_behind",
    )  # fmt: skip
    message, word, nothing = "row", "curve", "answers come, and none of them can be read"

    def __init__(self, source: StoreSource, events: EventBook, limits: DepthLimits) -> None:
        super().__init__(source, events, limits)
        self._store = source
        self._frames = witsml.Frames()
        self.last: tuple[str, str] | None = None
        self._last_key = -np.inf
        self._nulls = source.nulls
        self._reported_jump = self._reported_index = -np.inf
        self._grew = -1  # model time of the latest answer with a new row
        self._behind = 0  # answers in a row whose rows all lie at or before the last index

    def position(self) -> tuple[str, str] | None:
        return self.last

    def go_on_from(self, before: SourceReader) -> None:
        """Take over the state of the reader that this reader replaces, including an answer that is not complete yet.

        If the log is the same, its last index and its null value are taken over, too. Another log is read from its
        first row on, because the last index of the old log does not apply to it.
        """
        super().go_on_from(before)
        if not isinstance(before, StoreReader):
            return
        self._frames = before._frames
        if _log_of(self._store) == _log_of(before._store):
            self.last, self._last_key = before.last, before._last_key
            self._nulls = [*self.source.nulls, *before._nulls[len(before.source.nulls) :]]

    def read(self, chunk: Chunk) -> list[Reading]:
        """Return a `Reading` for each answer that ``chunk`` completes and that has something to read."""
        readings = []
        if chunk.connection != self._connection:
            self._frames, self._connection = witsml.Frames(), chunk.connection
        for row, payload in enumerate(chunk.payloads):
            self.counts["bytes"] += len(payload)
            answers, stray = self._frames.feed(payload)
            stamp = int(chunk.time[row]), int(chunk.order[row]) << 20, int(chunk.wall[row])
            if stray:
                self._report(stamp[2], "stray_text", f"{stray} bytes that belong to no answer were not read")
            readings += [reading for answer in answers if (reading := self._take(*answer, stamp)) is not None]
        return readings

    def _take(self, kind: str, state: str, body: bytes, stamp: tuple[int, int, int]) -> Reading | None:
        """Return the columns of one answer; None if there is nothing to read or it must not be read."""
        if state == "cut":
            self._report(
                stamp[2], "cut_off", f"an answer about the {kind} ended after {len(body)} bytes; it was not read"
            )
        if state == "refused":
            kept = f"{len(body)} bytes of it are kept" if body else "it was empty, or equal to the previous one"
            self._report(stamp[2], "refused", f"an answer about the {kind} was refused and not read; {kept}")
        if kind == "log" and state in ("whole", "same"):
            self._watch_age(stamp)
        if state != "whole":
            return None
        self.counts["frames"] += 1
        try:
            answer = witsml.read_answer(body)
            if answer.result < 0:
                self._report(stamp[2], "store", f"{kind}: error {answer.result}: {answer.message}")
                return None
            if kind == "log":
                return self._log(witsml.read_log(answer.document), stamp)
            return self._trajectory(witsml.read_stations(answer.document), stamp)
        except ValueError as error:
            self._report(stamp[2], "witsml", f"{kind}: {error}: the answer was not read")
            return None

    def _log(self, log: witsml.LogRows, stamp: tuple[int, int, int]) -> Reading | None:
        if log.direction == "decreasing":
            raise ValueError("direction = 'decreasing': must be increasing")
        if log.null and NUMBER.fullmatch(log.null):
            self._nulls = [*self.source.nulls, float(log.null)]
        before = self._last_key
        numbers = self._new_rows(log, stamp[2])
        self._watch_rows(log, numbers, before, stamp)
        if not numbers:
            return None
        time, order, wall = (np.full(len(numbers), value, np.int64) for value in stamp)
        frames = frame_rows(time, order + np.arange(len(numbers)), wall, np.array(numbers), self._connection)
        reading = Reading(frames)
        values = np.full((len(numbers), len(self._column)), np.nan)
        states = np.zeros(values.shape, np.uint8)
        self._read_cells(log, numbers, values, states, stamp[2])
        self._unmeasured(states)
        self.counts["items"] += int(np.count_nonzero(states == VALUE))
        self.counts["nulls"] += int(np.count_nonzero(states == NULL))
        self.counts["not_numbers"] += int(np.count_nonzero(states == INVALID))
        flags = np.zeros(len(numbers), np.int64)
        self._events.report_rows(self._wrong_numbers(values), lambda row: self._wrong_number(row, reading, values))
        self._fill(reading, values, states, flags)
        return reading

    def _watch_age(self, stamp: tuple[int, int, int]) -> None:
        """Report a log by time that answers and does not grow."""
        if self._store.index != "time" or self._grew < 0 or "no_rows" in self.doubts:
            return
        if stamp[0] - self._grew > STANDS * SECOND:
            last = self.last[0] if self.last else ""
            text = f"the log by time answers, and no row after {last} came for {STANDS:g} s"
            self.doubts["no_rows"] = (
                f"{text}: what writes it may be dead, its clock was set back, or it is another log (log)"
            )
            self._report(stamp[2], "no_rows", self.doubts["no_rows"])

    def _watch_rows(self, log: witsml.LogRows, numbers: list[int], before: float, stamp: tuple[int, int, int]) -> None:
        """Note new rows; report an answer of several rows that all lie at or before the last index."""
        if numbers:
            self._grew, self._behind = stamp[0], 0
            self.doubts.pop("no_rows", None)
            self.doubts.pop("behind", None)
        elif len(log.rows) > 1 and before > -np.inf and self._last_key == before:
            self._behind += 1
            first = log.rows[0].partition(",")[0][:60]
            text = f"{len(log.rows)} rows from {first} on lie at or before the last index, and were not read"
            self._report(stamp[2], "behind", text)
            if self._behind >= BEHIND:
                self.doubts["behind"] = (
                    f"{BEHIND} answers: {text}: the clock or zone of the sender went back, or the log is another (log)"
                )

    def _new_rows(self, log: witsml.LogRows, wall: int) -> list[int]:
        """Return the numbers, from 1, of the rows after the last index, and update the last index.

        A row that jumps counts only if the next row continues from its index. Otherwise one wrong index would hide all
        rows after it.
        """
        store, scale = self._store, 1.0
        if store.index == "depth" and log.rows:
            found = self._scale(Item(log.mnemonics[0], kind=units.LENGTH), log.units[0], wall)
            if found is None:
                return []
            scale = found
        texts = [row.partition(",")[0].strip() for row in log.rows]
        keys = [_index(text, store.index, scale) for text in texts]
        new = []
        for place, (key, after) in enumerate(zip(keys, _following(keys), strict=True)):
            if key is None:
                text = f"index {texts[place][:60]!r}: is not a {store.index}: the row was not read"
                self._report(wall, "index", text, place + 1)
            elif key > self._last_key:
                if key - self._last_key > store.jump and not (after is not None and key < after <= key + store.jump):
                    self._report_jump(texts[place], key, wall, place + 1)
                    continue
                if wrong := self._index_rule(key, store.index, wall):
                    if key != self._reported_index:
                        self._report(wall, "index", f"index {texts[place][:60]}: {wrong}: not read", place + 1)
                    self._reported_index = key
                    continue
                self._last_key = key
                self.last = texts[place], log.units[0] if store.index == "depth" else ""
                new.append(place + 1)
        return new

    def _index_rule(self, key: float, index: str, wall: int) -> str:
        """Return the rule that an index breaks, or "" if it breaks none."""
        if index == "depth":
            return self._limits.rule() if self._limits.outside(np.array(key)) else ""
        return "is in the future" if key > wall / 1e9 + FUTURE else ""

    def _report_jump(self, text: str, key: float, wall: int, line: int) -> None:
        if key == self._reported_jump:  # the store sends it again with every answer
            return
        self._reported_jump = key
        unit = "m" if self._store.index == "depth" else "s"
        far = f"{key - self._last_key:.6g} {unit} after the last index" if np.isfinite(self._last_key) else "the first"
        rule = f"no row continues from it within {self._store.jump:g} {unit}: not read"
        self._report(wall, "jump", f"index {text[:60]}: {far}, and {rule}", line)

    def _read_cells(self, log: witsml.LogRows, numbers: list[int], values: Floats, states: Bytes, wall: int) -> None:
        """Write the cells of the mapped curves to ``values`` and ``states``, one block of rows at a time."""
        curves = {curve.name: curve for curve in self._store.curves}
        if self._store.index == "depth" and INDEX in self._column:
            curves = {INDEX: Item(log.mnemonics[0], kind=units.LENGTH)} | curves
        self._note(log.mnemonics[1:])
        places = []
        for name, curve in curves.items():
            if curve.name in log.mnemonics:
                self._seen.add(name)
                at = log.mnemonics.index(curve.name)
                places.append((self._column[name], at, curve.name, self._scale(curve, log.units[at], wall)))
        for start in range(0, len(numbers), BLOCK):
            block = slice(start, start + BLOCK)
            rows = [log.rows[number - 1].split(",") for number in numbers[block]]
            for column, at, mnemonic, scale in places:
                cells = [row[at].strip() for row in rows]
                values[block, column], states[block, column] = self._cells(mnemonic, scale, cells, numbers[block], wall)

    def _cells(
        self, mnemonic: str, scale: float | None, cells: list[str], numbers: list[int], wall: int
    ) -> tuple[Floats, Integers]:
        values, states = np.full(len(cells), np.nan), np.full(len(cells), INVALID, np.int64)
        if scale is None:
            return values, states
        bad = []
        for row, cell in enumerate(cells):
            if not cell:
                states[row] = ABSENT
            elif not NUMBER.fullmatch(cell) or not np.isfinite(number := float(cell)):
                bad.append(row)
            elif number in self._nulls:
                states[row] = NULL
            else:
                values[row], states[row] = number * scale, VALUE

        def describe(row: int) -> Event:
            text = f"curve {mnemonic} = {cells[row][:60]!r}: is not a number"
            return self._event(wall, "invalid", text, numbers[row])

        self._events.report_rows(bad, describe)
        return values, states

    def _trajectory(
        self, stations: list[tuple[tuple[str, str], ...]], stamp: tuple[int, int, int]
    ) -> Reading | None:  # fmt: skip
        rows, numbers = [], []
        for number, station in enumerate(stations, 1):
            try:
                rows.append([_quantity(*cell, kind) for cell, kind in zip(station, _STATION_KINDS, strict=True)])
                numbers.append(number)
            except ValueError as error:
                self._report(stamp[2], "station", f"{error}: left out", number)
        if not rows:
            return None
        time, order, wall = (np.full(len(rows), value, np.int64) for value in stamp)
        frames = frame_rows(time, order, wall, np.array(numbers), self._connection)
        return Reading(frames, stations=np.array(rows), station_frames=frames)


def _log_of(store: StoreSource) -> tuple[tuple[str, str, str] | None, str]:
    return store.table.log.uids if store.table.log else None, store.index


_STATION_KINDS = (units.LENGTH, units.ANGLE, units.ANGLE)


def _quantity(text: str, unit: str, kind: str) -> float:
    if not NUMBER.fullmatch(text):
        raise ValueError(f"{text[:60]!r}: is not a number")
    return float(text) * units.factor(unit, kind)


def _following(keys: list[float | None]) -> list[float | None]:
    """Return for each row the index of the next row that has a valid index; None if there is no such row."""
    after: list[float | None] = []
    following = None
    for key in reversed(keys):
        after.append(following)
        following = following if key is None else key
    return after[::-1]


def _index(text: str, index: str, scale: float) -> float | None:
    """Return a depth in metres, or a time in seconds since 1970 (UTC without a zone); None if ``text`` is neither."""
    if index == "depth":
        depth = float(text) * scale if NUMBER.fullmatch(text) else math.nan
        return depth if math.isfinite(depth) else None
    try:
        when = datetime.datetime.fromisoformat(text)
    except ValueError:
        return None
    return (when if when.tzinfo else when.replace(tzinfo=datetime.UTC)).timestamp()

"""From a store's answers to columns in core units, as ``mapping.py`` does it from frames.

    journal bytes -> answers -> rows behind the last index -> cells by unit -> triples, image rows, rig, stations

A row whose index is not behind the last one is a row that is there already: a store sends the row at ``startIndex``
again. A curve whose unit is not sent, not known or of another quantity is INVALID, and told.
"""

from __future__ import annotations

import datetime
import math
import re

import numpy as np

from helibore import units
from helibore.live import witsml
from helibore.live.configuration import Source
from helibore.live.events import EventBook
from helibore.live.mapping import ABSENT, INVALID, NULL, VALUE, Chunk, Integers, Reading, SourceReader, Values
from helibore.live.store_settings import INDEX, Curve

NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d{1,3})?")
LISTED = 32


class StoreReader(SourceReader):
    """Reads the answers of one store.

    Attributes
    ----------
    last
        Index of the last row read, as (text, unit); from there on is asked next. None before the first.
    """

    def __init__(self, source: Source, events: EventBook) -> None:
        super().__init__(source, events)
        self._frames = witsml.Frames()
        self.last: tuple[str, str] | None = None
        self._last_key = -np.inf
        self._nulls = source.nulls
        self._bad_units: set[str] = set()

    def read(self, chunk: Chunk) -> list[Reading]:
        """Return the columns of the answers that ``chunk`` completes."""
        readings = []
        if chunk.connection != self._connection:
            self._frames, self._connection = witsml.Frames(), chunk.connection
        for row, payload in enumerate(chunk.payloads):
            self.counts["bytes"] += len(payload)
            answers, stray = self._frames.feed(payload)
            stamp = int(chunk.time[row]), int(chunk.order[row]) << 20, int(chunk.wall[row])
            if stray:
                self._tell(stamp[2], "stray_text", f"{stray} bytes belong to no answer: they were not read")
            readings += [reading for answer in answers if (reading := self._take(*answer, stamp)) is not None]
        return readings

    def _take(self, kind: str, state: str, body: bytes, stamp: tuple[int, int, int]) -> Reading | None:
        """Columns of one answer; None where there is nothing to read in it."""
        if state == "cut":
            self._tell(stamp[2], "cut_off", f"an answer about the {kind} ended after {len(body)} bytes: not read")
        if state != "whole":
            return None
        self.counts["frames"] += 1
        try:
            answer = witsml.read_answer(body)
            if answer.result < 0:
                self._tell(stamp[2], "store", f"{kind}: error {answer.result}: {answer.message}")
                return None
            if kind == "log":
                return self._log(witsml.read_log(answer.document), stamp)
            return self._trajectory(witsml.read_stations(answer.document), stamp)
        except ValueError as error:
            self._tell(stamp[2], "witsml", f"{kind}: {error}: the answer was not read")
            return None

    def _log(self, log: witsml.LogRows, stamp: tuple[int, int, int]) -> Reading | None:
        store = self.source.store
        assert store is not None
        if log.direction == "decreasing":
            raise ValueError("direction = 'decreasing': must be increasing")
        if log.null and NUMBER.fullmatch(log.null):
            self._nulls = (*self.source.nulls, float(log.null))
        rows = self._new_rows(log, store.index, stamp[2])
        if not rows:
            return None
        time, order, wall = (np.full(len(rows), value, np.int64) for value in stamp)
        reading = Reading(time, order + np.arange(len(rows)), wall, np.arange(1, len(rows) + 1), self._connection)
        values = np.full((len(rows), len(self._codes)), np.nan)
        states = np.zeros(values.shape, np.uint8)
        curves = {INDEX: Curve(log.mnemonics[0], units.LENGTH)} if store.index == "depth" else {}
        curves |= dict(enumerate(store.curves, INDEX + 1))
        for code, curve in curves.items():
            place = self._column[code]
            if place >= 0 and curve.mnemonic in log.mnemonics:
                at = log.mnemonics.index(curve.mnemonic)
                cells = [row[at] for row in rows]
                values[:, place], states[:, place] = self._cells(curve, log.units[at], cells, stamp[2])
        self._unmeasured(states)
        self.counts["items"] += int(np.count_nonzero(states == VALUE))
        self.counts["nulls"] += int(np.count_nonzero(states == NULL))
        self.counts["not_numbers"] += int(np.count_nonzero(states == INVALID))
        flags = np.zeros(len(rows), np.int64)
        reading.rig = {name: self._value(values, item) for name, item in self.source.items.items()}
        reading.pass_number = self._pass_numbers(reading, values, states, flags)
        self._triples(reading, values, states, flags)
        self._images(reading, values, states, flags)
        return reading

    def _new_rows(self, log: witsml.LogRows, index: str, wall: int) -> list[list[str]]:
        """Rows behind the last index; each moves it on."""
        new = []
        for row in log.rows:
            key = _index(row[0], index)
            if key is None:
                self._tell(wall, "index", f"index {row[0][:60]!r}: is not a {index}: the row was not read")
            elif key > self._last_key:
                self._last_key = key
                self.last = row[0], log.units[0] if index == "depth" else ""
                new.append(row)
        return new

    def _cells(self, curve: Curve, unit: str, cells: list[str], wall: int) -> tuple[Values, Integers]:
        values, states = np.full(len(cells), np.nan), np.full(len(cells), INVALID, np.int64)
        try:
            scale = units.factor(unit, curve.kind) if curve.kind else 1.0
        except ValueError as error:
            if curve.mnemonic not in self._bad_units:
                self._bad_units.add(curve.mnemonic)
                self._tell(wall, "unit", f"curve {curve.mnemonic}: {error}: not read")
            return values, states
        told = 0
        for row, cell in enumerate(cells):
            if not cell:
                states[row] = ABSENT
            elif not NUMBER.fullmatch(cell) or not np.isfinite(number := float(cell)):
                told += 1
                if told <= LISTED:
                    self._tell(wall, "invalid", f"curve {curve.mnemonic} = {cell[:60]!r}: is not a number")
            elif number in self._nulls:
                states[row] = NULL
            else:
                values[row], states[row] = number * scale, VALUE
        return values, states

    def _unmeasured(self, states: np.ndarray[tuple[int, int], np.dtype[np.uint8]]) -> None:
        """A row in which no caliper speaks is no triple, though it has an index."""
        caliper, place = self.source.caliper, self._column[INDEX]
        if caliper and place >= 0:
            spoken = self._column[[item.code for item in (*caliper.toolface, *caliper.radius)]]
            states[(states[:, spoken] == ABSENT).all(axis=1), place] = ABSENT

    def _trajectory(
        self, stations: list[tuple[tuple[str, str], ...]], stamp: tuple[int, int, int]
    ) -> Reading | None:  # fmt: skip
        rows, numbers = [], []
        for number, station in enumerate(stations, 1):
            try:
                rows.append([_quantity(*cell, kind) for cell, kind in zip(station, _STATION_KINDS, strict=True)])
                numbers.append(number)
            except ValueError as error:
                self._tell(stamp[2], "station", f"{error}: left out", number)
        if not rows:
            return None
        time, order, wall = (np.full(len(rows), value, np.int64) for value in stamp)
        reading = Reading(time, order, wall, np.array(numbers), self._connection)
        reading.stations, reading.station_frame = np.array(rows), np.arange(len(rows))
        return reading


def reader_of(source: Source, events: EventBook) -> SourceReader:
    """Return what reads the bytes of ``source``."""
    return StoreReader(source, events) if source.store else SourceReader(source, events)


_STATION_KINDS = (units.LENGTH, units.ANGLE, units.ANGLE)


def _quantity(text: str, unit: str, kind: str) -> float:
    if not NUMBER.fullmatch(text):
        raise ValueError(f"{text[:60]!r}: is not a number")
    return float(text) * units.factor(unit, kind)


def _index(text: str, index: str) -> float | None:
    """A depth as a number, a time as seconds since 1970; None where it is neither."""
    if index == "depth":
        depth = float(text) if NUMBER.fullmatch(text) else math.nan
        return depth if math.isfinite(depth) else None
    try:
        when = datetime.datetime.fromisoformat(text)
    except ValueError:
        return None
    return (when if when.tzinfo else when.replace(tzinfo=datetime.UTC)).timestamp()

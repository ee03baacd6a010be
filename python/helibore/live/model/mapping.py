"""Convert a source's bytes to columns in core units: rig quantities, caliper triples, image rows, survey stations.

    frames x mapped items  ->  one table of float64, one of states (absent, value, null, invalid)  ->  columns

All steps work on many frames together; only bad input, gaps and duplicates are checked one by one. A frame can be a
duplicate only if it contains a measurement, and also a sequence number or the depth of the sensor. It is a duplicate if
its text equals that of one of the last 4096 such frames. Without number and depth, a frame that was sent twice cannot
be distinguished from a new measurement.
"""

from __future__ import annotations

import bisect
import hashlib
import itertools
from collections import OrderedDict
from dataclasses import dataclass, field

import numpy as np

from helibore.base.angles import wrapped
from helibore.base.arrays import Bytes, Floats, Integers, Mask, Rows, distinct
from helibore.live.model.depth_jumps import Steps
from helibore.live.model.events import Event, EventBook, Flag
from helibore.live.model.sample_rows import ROW, frame_rows, measured
from helibore.live.model.sequence import SequenceWatch
from helibore.live.rules.depth_limits import DepthLimits
from helibore.live.rules.pass_rules import LARGEST, NO_NUMBER
from helibore.live.rules.sources import Image, Item, Source
from helibore.live.wire import wits
from helibore.samples.caliper import LARGEST_RADIUS

ABSENT, VALUE, NULL, INVALID = range(4)
REMEMBERED, DIGEST_BYTES = 4096, 16
LARGEST_TOOLFACE = 1e6
"""Degrees: a toolface with a larger absolute value is wrong."""
MOST_ITEMS = 20
"""The most items that a text lists."""
FIRST_TOOLFACES = 100
"""Number of toolfaces from which the reader judges their unit."""


@dataclass(slots=True)
class Chunk:
    """Bytes of one connection, and for each record that holds them: receive time, order and wall clock time.

    ``time`` is in ns of the model's clock, ``order`` is the number of the record, ``wall`` is in ns since 1970. With
    ``closes``, the connection ends, and there are no bytes.
    """

    connection: int
    payloads: list[bytes]
    time: Integers
    order: Integers
    wall: Integers
    closes: bool = False


@dataclass(slots=True)
class Reading:
    """What one chunk completes.

    Attributes
    ----------
    frames
        (n,) a row for each frame, with the pass number that applies to it.
    rig
        The rig quantities by name, (n,); NaN where a frame has no usable value.
    shown
        The channels of the rig by name, (n,); NaN where a frame has no value.
    samples
        (m,) a row for each triple of the caliper.
    images
        The rows of each image that has some: (image, (k,) rows, (k, sectors) values).
    stations, station_frames
        (s, 3) depth, inclination and azimuth; (s,) the frame of each station.
    keep_alives
        Number of frames that hold nothing but an empty item 0111.
    """

    frames: Rows
    rig: dict[str, Floats] = field(default_factory=dict)
    shown: dict[str, Floats] = field(default_factory=dict)
    samples: Rows = field(default_factory=lambda: np.empty(0, ROW))
    images: list[tuple[Image, Rows, Floats]] = field(default_factory=list)
    stations: Floats = field(default_factory=lambda: np.empty((0, 3)))
    station_frames: Rows = field(default_factory=lambda: np.empty(0, ROW))
    keep_alives: int = 0


class SourceReader:
    """Reads one source: parses the bytes of each connection and maps the items.

    Attributes
    ----------
    message, word, nothing
        What a unit of the stream is called, and what a value in it; the text for bytes without such a unit.
    seems_radians
        The reason for which the toolfaces seem to be radians, although their unit is not stated; "" if they do not.
    doubts
        What is wrong with the stream now, by rule.
    seen
        The names of the items that came, sorted.
    """

    STATE: tuple[str, ...] = (
        "_steps", "_parser", "_connection", "counts", "watches", "recent", "_pass_number", "_held", "_ends", "_walls",
        "_toolfaces", "seems_radians", "seen", "doubts",
    )  # fmt: skip
    message, word = "frame", "item"
    nothing = "bytes come, and no WITS frame (&& ... !!) is among them; each of its lines must end with LF"

    def __init__(self, source: Source, events: EventBook, limits: DepthLimits) -> None:
        self.source = source
        self._events = events
        self._limits = limits
        self.refuses_bit = False  # whether the latest bit depth was not used
        self._steps = {name: Steps(limits) for name in ("hole_depth", "bit_depth") if name in source.rig}
        self._parser = self._new_parser()
        self._connection = -1
        self.counts = dict.fromkeys(self._parser.counts, 0)
        self.watches: dict[int, SequenceWatch] = {100 * record + 4: SequenceWatch() for record in source.records}
        names = dict.fromkeys([*map(source.name_of, self.watches), *source.mapped])
        self._column = {name: column for column, name in enumerate(names)}
        self._column_of = np.full(10_000, -1, np.int64)  # the same by code
        self._column_of[[source.number_of(name) for name in names]] = np.arange(len(names))
        caliper = source.caliper
        triple = (caliper.depth, caliper.toolface, caliper.radius) if caliper else ()
        self._caliper = [self._places(items) for items in triple]
        self._measured = distinct(self._places(source.measured)[0])
        depths = [*(caliper.depth if caliper else []), *source.station[:1]]
        depths += [image.depth for image in source.images if image.depth]
        numbers = [self._column[source.name_of(code)] for code in self.watches]
        self._distinguishing = np.append(np.array(numbers, np.int64), self._places(depths)[0])
        self._recent: OrderedDict[bytes, None] = OrderedDict()
        self._pass_number = NO_NUMBER
        self._toolfaces: list[float] = []  # the first FIRST_TOOLFACES
        self.seems_radians = ""
        self._seen: set[str] = set()
        self._seen_codes = np.zeros(10_000, bool)
        self.doubts: dict[str, str] = {}
        # The bytes that the parser holds, and for each record that brought them: offset of its end, wall clock time.
        self._held = bytearray()
        self._ends: list[int] = []
        self._walls: list[int] = []

    def _new_parser(self) -> wits.Parser:
        return wits.Parser(self.source.nulls, *self.source.limits)

    def _places(self, items: list[Item]) -> tuple[Integers, Floats]:
        """Return the table columns and the scales of ``items``."""
        columns = np.array([self._column[item.name] for item in items], np.int64)
        return columns, np.array([item.scale for item in items])

    @property
    def seen(self) -> list[str]:
        return sorted(self._seen)

    @seen.setter
    def seen(self, names: list[str] | Mask) -> None:
        if isinstance(names, np.ndarray):  # older checkpoints have an entry for each number
            names = [self.source.name_of(number) for number in np.flatnonzero(names).tolist()]
        self._seen = set(names)

    def read(self, chunk: Chunk) -> list[Reading]:
        """Return the columns of the frames that ``chunk`` completes."""
        readings = []
        if chunk.connection != self._connection:
            if self._connection >= 0:
                readings.append(self._finish(chunk))
            self._parser, self._connection = self._new_parser(), chunk.connection
        if chunk.payloads:
            ends = self._parser.counts["bytes"] + np.cumsum([len(payload) for payload in chunk.payloads])
            piece = b"".join(chunk.payloads)
            self._held += piece
            batch = self._parser.feed(piece)
            self._ends += ends.tolist()
            self._walls += chunk.wall.tolist()
            readings.append(self._columns(batch, chunk, ends))
            held = bisect.bisect_right(self._ends, batch.base + len(batch.text))
            del self._ends[:held], self._walls[:held], self._held[: len(batch.text)]
        if chunk.closes:
            readings.append(self._finish(chunk))
        return readings

    def _finish(self, chunk: Chunk) -> Reading:
        """End the connection, at the first record of ``chunk``; return the columns of the frame that this completes."""
        reading = self._columns(self._parser.finish(), chunk, np.array([np.iinfo(np.int64).max]))
        self._add_counts()
        self._parser, self._ends, self._walls, self._held = self._new_parser(), [], [], bytearray()
        return reading

    def go_on_from(self, before: SourceReader) -> None:
        """Take over the counts, sequence numbers, recent frames and connection of the reader that this reader replaces.

        The last bit and hole depth and the last pass number are taken over if both readers read them from the same
        items. A frame that has begun is read to its end, unless nulls or limits differ.
        """
        if (self.source.nulls, self.source.limits) == (before.source.nulls, before.source.limits):
            self._parser, self._ends, self._walls, self._held = (
                before._parser,
                before._ends,
                before._walls,
                before._held,
            )
        else:
            before._add_counts()
        for name, steps in self._steps.items():
            if name in before._steps and self.source.rig[name] == before.source.rig[name]:
                before._steps[name].limits = steps.limits
                self._steps[name] = before._steps[name]
        if self.source.pass_number == before.source.pass_number:
            self._pass_number = before._pass_number
        self.counts = {name: before.counts.get(name, 0) for name in self.counts}
        self.watches |= {code: watch for code, watch in before.watches.items() if code in self.watches}
        self._connection, self._recent, self._seen = before._connection, before._recent, before._seen

    @property
    def recent(self) -> bytes:
        """Digests of the last frames that can have duplicates, the oldest first."""
        return b"".join(self._recent)

    @recent.setter
    def recent(self, digests: bytes) -> None:
        size = DIGEST_BYTES
        self._recent = OrderedDict.fromkeys(digests[at : at + size] for at in range(0, len(digests), size))

    @property
    def connection(self) -> int:
        """Number of the latest connection; 0 if none has come."""
        return max(self._connection, 0)

    def _add_counts(self) -> None:
        for name, count in self._parser.counts.items():
            self.counts[name] += count

    def total(self, name: str) -> int:
        """Return the parser's count ``name``, such as "frames", summed over all connections."""
        return self.counts[name] + self._parser.counts[name]

    def _columns(self, batch: wits.Batch, chunk: Chunk, ends: Integers) -> Reading:
        """Return the columns of a batch; ``ends`` are the stream offsets of the ends of the chunk's records."""
        at = np.minimum(np.searchsorted(ends, self._completed(batch)), len(chunk.time) - 1)
        within = np.arange(len(at)) - np.searchsorted(at, at)
        order = (chunk.order[at] << 20) + within
        frames = frame_rows(chunk.time[at], order, chunk.wall[at], batch.frames["line"], self._connection)
        reading = Reading(frames)
        self._report_bad_text(batch, int(chunk.wall[0]))
        if not len(batch.frames):
            return reading
        values, states = self._table(batch, reading)
        repeated = self._repeats(batch, states, reading)
        flags = self._sequence(values, reading)
        self._fill(reading, values, states, flags | repeated)
        if self.source.station:
            stations = np.column_stack([self._value(values, item) for item in self.source.station])
            whole = np.isfinite(stations).all(axis=1) & (repeated == 0)
            reading.stations, reading.station_frames = stations[whole], frames[whole]
        return reading

    def _fill(self, reading: Reading, values: Floats, states: Bytes, flags: Integers) -> None:
        """Set the rig quantities, pass numbers, triples and image rows that a table of values and states gives."""
        reading.rig = self._rig(values, reading)
        reading.shown = {name: self._value(values, one.item) for name, one in self.source.shown.items()}
        reading.frames["number"] = self._pass_numbers(values, states, flags)
        self._triples(reading, values, states, flags)
        self._images(reading, values, states, flags)

    def unmapped(self) -> list[str]:
        """Return the names of the items that came and that no setting maps."""
        return [name for name in self.seen if name not in self.source.mapped]

    def position(self) -> object | None:
        """Return how far the reader has come, for a source that is asked from there; None: from the beginning."""
        return None

    def lacking(self) -> str:
        """Return in words what the samples need and the source has not sent yet; "" if nothing is lacking."""
        source, caliper = self.source, self.source.caliper
        if not self.total("bytes"):
            return ""
        if not self.total("frames"):
            return self.nothing
        if caliper is None or not self._seen:
            return ""
        bit = [source.rig["bit_depth"]] if "bit_depth" in source.rig and not caliper.depth else []
        needed = {"toolface": caliper.toolface, "radius": caliper.radius, "depth": caliper.depth, "bit_depth": bit}
        lacking = [f"{name} ({self.word} {items[0].name or 'the index'})" for name, items in needed.items()
                   if items and self._seen.isdisjoint(item.name for item in items)]  # fmt: skip
        if not lacking:
            return ""
        others = self.unmapped()
        listed = ", ".join(others[:MOST_ITEMS]) + (" ..." if len(others) > MOST_ITEMS else "")
        unmapped = f"{self.word}s that came and are not mapped: {listed or 'none'}"
        cause = "they have other names (caliper, items), or are not sent"
        return f"no {self.message} had {', '.join(lacking)}: {cause}; {unmapped}"

    def _completed(self, batch: wits.Batch) -> Integers:
        """Return the stream offset at which each frame was known to be complete: the end of its last line.

        The last line may be ``!!&&``. Then the frame ends after ``!!``, but ``&&`` may have come in a later packet.
        """
        stops: Integers = batch.frames["stop"].copy()
        last = np.frombuffer(batch.text, np.uint8)[stops - batch.base - 1]
        for row in np.flatnonzero(last != ord("\n")).tolist():
            end = self._held.find(b"\n", int(stops[row]) - batch.base)
            stops[row] = batch.base + end + 1 if end >= 0 else stops[row]
        return stops

    def _table(self, batch: wits.Batch, reading: Reading) -> tuple[Floats, Bytes]:
        items, frames = batch.items, batch.frames
        values = np.full((len(frames), len(self._column)), np.nan)
        states = np.zeros(values.shape, np.uint8)
        if not self._seen_codes[items["code"]].all():
            self._seen_codes[items["code"]] = True
            self._seen.update(map(self.source.name_of, np.flatnonzero(self._seen_codes).tolist()))
        column = self._column_of[items["code"]]
        mapped = np.flatnonzero(column >= 0)[::-1]  # backwards: of an item that a frame has twice, the first one counts
        of = np.repeat(np.arange(len(frames)), frames["items"])
        row = of[mapped]
        values[row, column[mapped]] = items["value"][mapped]
        states[row, column[mapped]] = np.array([VALUE, NULL, INVALID, INVALID], np.uint8)[items["flags"][mapped]]
        empty = (items["code"] == 111) & (items["flags"] == wits.NULL)
        reading.keep_alives = int(np.count_nonzero(frames["items"][of[empty]] == 1))
        bad = mapped[items["flags"][mapped] == wits.INVALID][::-1]
        self._report_invalid(bad, batch, reading, values)
        if len(mapped) != np.count_nonzero(states):
            pairs = (row * len(self._column) + column[mapped])[::-1]
            twice = np.delete(mapped[::-1], np.unique(pairs, return_index=True)[1])
            words = "occurs twice in a frame; the first one counts"
            self._events.report_rows(twice, lambda item: self._item_event(item, batch, reading, "twice", words))
        return values, states

    def _item_event(self, row: int, batch: wits.Batch, reading: Reading, rule: str, words: str) -> Event:
        item = batch.items[row]
        frame = int(np.searchsorted(batch.frames["first"], row, side="right")) - 1
        text = f"item {item['code']:04d} = {batch.text_of(row)[:60]!r}: {words}"
        return self._event(
            int(reading.frames["wall"][frame]), rule, text, batch.line_of(row, frame), int(item["offset"])
        )

    def _report_invalid(self, bad: Integers, batch: wits.Batch, reading: Reading, values: Floats) -> None:
        """Report the items ``bad``, which are not numbers, and the wrong pass numbers, in order of their frames."""
        wrong = self._wrong_numbers(values)
        if not len(bad) and not len(wrong):
            return
        frames = np.concatenate([np.searchsorted(batch.frames["first"], bad, side="right") - 1, wrong])

        def describe(place: int) -> Event:
            if place < len(bad):
                return self._item_event(int(bad[place]), batch, reading, "invalid", "is not a number")
            return self._wrong_number(int(wrong[place - len(bad)]), reading, values)

        self._events.report_rows(np.argsort(frames, kind="stable"), describe)

    def _wrong_numbers(self, values: Floats) -> Integers:
        """Return the frames whose pass number is not a whole number in the allowed range."""
        if self.source.pass_number is None:
            return np.empty(0, np.int64)
        number = values[:, self._column[self.source.pass_number.name]]
        return np.flatnonzero(~np.isnan(number) & ~_counts_passes(number))

    def _wrong_number(self, row: int, reading: Reading, values: Floats) -> Event:
        assert self.source.pass_number is not None
        number = values[row, self._column[self.source.pass_number.name]]
        text = f"pass number {number:g}: must be a whole number from 0 to {LARGEST}"
        return self._of_frame(reading, row, "invalid", text)

    def _report_bad_text(self, batch: wits.Batch, wall: int) -> None:
        """Report bad text at the time at which its first byte came; at ``wall`` if this time is not known."""
        if not len(batch.events):
            return
        rules = batch.events["rule"]

        def describe(row: int) -> Event:
            event = batch.events[row]
            start = int(event["offset"]) - batch.base
            raw = bytes(self._held[max(start, 0) : start + min(int(event["length"]), 60)])
            at = bisect.bisect_right(self._ends, int(event["offset"]))
            name = wits.RULE_NAMES[event["rule"]]
            text = f"{raw!r}: {wits.RULES[name]}"
            came = self._walls[at] if at < len(self._walls) else wall
            return self._event(came, name, text, int(event["line"]), int(event["offset"]))

        for rule in distinct(rules).tolist():
            self._events.report_rows(np.flatnonzero(rules == rule), describe)

    def _event(self, wall: int, rule: str, text: str, line: int = 0, offset: int = -1) -> Event:
        return Event(wall, self.source.name, self._connection, line, offset, rule, text)

    def _of_frame(self, reading: Reading, row: int, rule: str, text: str, offset: int = -1) -> Event:
        """Return an event at the time and line of a frame."""
        frame = reading.frames[row]
        return self._event(int(frame["wall"]), rule, text, int(frame["line"]), offset)

    def _report(self, wall: int, rule: str, text: str, line: int = 0, offset: int = -1) -> None:
        self._events.report(self._event(wall, rule, text, line, offset))

    def _repeats(self, batch: wits.Batch, states: Bytes, reading: Reading) -> Integers:
        """Return DUPLICATE for each frame that is a duplicate (see the top of this file), 0 for all other frames."""
        flags = np.zeros(len(batch.frames), np.int64)
        measured = (states[:, self._measured] != ABSENT).any(axis=1) & (states[:, self._distinguishing] == VALUE).any(
            axis=1
        )
        rows = np.flatnonzero(measured)
        recent, text = self._recent, batch.text
        starts = (batch.frames["start"][rows] - batch.base).tolist()
        stops = (batch.frames["stop"][rows] - batch.base).tolist()
        for row, start, stop in zip(rows.tolist(), starts, stops, strict=True):
            words = self.digest(text[start:stop])
            if words in recent:
                flags[row] = Flag.DUPLICATE
                self._events.report(
                    self._of_frame(reading, row, "duplicate", "a frame was sent twice", start + batch.base)
                )
                continue
            self._remember(words)
        return flags

    @staticmethod
    def digest(message: bytes) -> bytes:
        """Return a digest of a frame or message, which is shorter than it."""
        return hashlib.blake2b(message, digest_size=DIGEST_BYTES).digest()

    def _remember(self, digest: bytes) -> None:
        """Add the digest of a message to the last REMEMBERED ones."""
        self._recent[digest] = None
        if len(self._recent) > REMEMBERED:
            self._recent.popitem(last=False)

    def _sequence(self, values: Floats, reading: Reading) -> Integers:
        flags = np.zeros(len(values), np.int64)
        events: list[tuple[int, str, str]] = []
        for code, watch in self.watches.items():
            numbers = values[:, self._column[self.source.name_of(code)]]
            if np.isnan(numbers).all():
                continue
            found, reported = watch.take(numbers)
            flags |= found
            events += [(index, rule, f"record {code // 100:02d}: {text}") for index, rule, text in reported]
        for row, rule, text in sorted(events, key=lambda event: event[0]):  # in order of arrival, not record by record
            self._events.report(self._of_frame(reading, row, rule, text))
        return flags

    def _rig(self, values: Floats, reading: Reading) -> dict[str, Floats]:
        """Return the rig quantities; a bit or hole depth that is out of range or jumps becomes NaN, with an event."""
        rig = {name: self._value(values, item) for name, item in self.source.rig.items()}
        for name, steps in self._steps.items():
            wrong, levels = steps.take(rig[name])
            depths = rig[name].tolist()
            rules = {row: self._depth_rule(depths[row]) for row in wrong.tolist() if row not in levels}
            self._report_depths(reading, "range", {row: f"{name} {depths[row]:g} m: {rules[row]}" for row in rules})
            said = name.replace("_", " ")
            self._report_depths(reading, "depth_jump", {row: f"{said} {text}" for row, text in levels.items()})
            if name == "bit_depth" and (known := np.flatnonzero(np.isfinite(rig[name]))).size:
                self.refuses_bit = bool(known[-1] in wrong)
            rig[name][wrong] = np.nan
        return rig

    def _report_depths(self, reading: Reading, rule: str, texts: dict[int, str]) -> None:
        self._events.report_rows(
            list(texts),
            lambda row: self._of_frame(reading, row, rule, texts[row]),
        )

    def _depth_rule(self, depth: float) -> str:
        if self._limits.outside(np.array(depth)):
            return self._limits.rule()
        return f"jumps by more than {self._limits.jump:g} m, and nothing confirms it yet"

    def _value(self, values: Floats, item: Item) -> Floats:
        scaled: Floats = values[:, self._column[item.name]] * item.scale
        return scaled

    def _pass_numbers(self, values: Floats, states: Bytes, flags: Integers) -> Integers:
        """Return the pass number of each frame: its own or, if it states none, the latest number before it.

        A null or wrong number gives NO_NUMBER. The number of a late or repeated frame applies to that frame only.
        """
        item = self.source.pass_number
        if item is None:
            return np.full(len(values), NO_NUMBER)
        column = self._column[item.name]
        number, said = values[:, column], states[:, column] != ABSENT
        whole = _counts_passes(number)
        own = np.where(whole, number, NO_NUMBER).astype(np.int64)
        counts = said & ((flags & (Flag.LATE | Flag.DUPLICATE)) == 0)
        last = np.maximum.accumulate(np.where(counts, np.arange(len(own)), -1))
        carried = np.where(last >= 0, own[last], self._pass_number)
        self._pass_number = int(carried[-1])
        return np.where(said, own, carried)

    def _triples(self, reading: Reading, values: Floats, states: Bytes, flags: Integers) -> None:
        caliper = self.source.caliper
        if caliper is None:
            return
        given = np.stack([states[:, column] for column, _ in self._caliper if len(column)])
        frame, group = (given != ABSENT).any(axis=0).nonzero()
        if not len(frame):
            return
        found = given[:, frame, group]
        depth, toolface, radius = (
            values[frame, column[group]] * scale[group] if len(column) else np.full(len(frame), np.nan)
            for column, scale in self._caliper
        )
        triple_flags = flags[frame]
        if (found != VALUE).any():
            triple_flags[((found == NULL) | (found == ABSENT)).any(axis=0)] |= Flag.NULL
            triple_flags[(found == INVALID).any(axis=0)] |= Flag.INVALID
        low, high = caliper.radius_range[0], min(caliper.radius_range[1], LARGEST_RADIUS)
        outside = (radius < low) | (radius > high)
        far = np.abs(toolface) > LARGEST_TOOLFACE
        triple_flags[outside | far] |= Flag.RANGE

        def describe(row: int) -> Event:
            text = f"radius {radius[row]:g} m: must be in radius_range [{low:g}, {high:g}]"
            if far[row]:
                text = f"toolface {toolface[row]:g} deg: must be from {-LARGEST_TOOLFACE:g} to {LARGEST_TOOLFACE:g}"
            return self._of_frame(reading, int(frame[row]), "range", text)

        self._events.report_rows((outside | far).nonzero()[0], describe)
        self._judge_unit(toolface, reading, frame)
        toolface = wrapped(toolface + np.broadcast_to(caliper.toolface_offset, len(caliper.toolface))[group])
        rows = reading.samples = measured(reading.frames[frame], caliper.latency, caliper.offset)
        rows["depth"], rows["toolface"], rows["radius"] = depth, toolface, radius
        rows["flags"], rows["row"] = triple_flags, group

    def _judge_unit(self, toolface: Floats, reading: Reading, frame: Integers) -> None:
        """Report that toolfaces seem to be radians: the first ones span more than pi, in [0, 2 pi] or [-pi, pi].

        The unit is judged once, for a WITS source whose configuration does not state it.
        """
        caliper = self.source.caliper
        if caliper is None or caliper.has_toolface_unit or len(self._toolfaces) == FIRST_TOOLFACES:
            return
        rows = np.flatnonzero(np.isfinite(toolface))[: FIRST_TOOLFACES - len(self._toolfaces)]
        self._toolfaces += toolface[rows].tolist()
        low, high = min(self._toolfaces, default=0.0), max(self._toolfaces, default=0.0)
        half = np.pi + 0.005  # senders round their values
        one_turn = (low >= 0 and high <= 2 * half) or (low >= -half and high <= half)
        if len(self._toolfaces) == FIRST_TOOLFACES and self._seem_tenths(low, high):
            rule = "it seems that they are tenths of a degree, or no angles: map an item in degrees (caliper.toolface)"
            self.seems_radians = f"the first {FIRST_TOOLFACES} toolfaces lie from {low:g} to {high:g}: {rule}"
            at = int(frame[rows[-1]])
            self._events.report(self._of_frame(reading, at, "toolface", self.seems_radians))
        if len(self._toolfaces) == FIRST_TOOLFACES and one_turn and high - low > np.pi:
            rule = 'it seems that they are radians: state toolface_unit = "rad", or "deg" if they are degrees'
            self.seems_radians = f"the first {FIRST_TOOLFACES} toolfaces lie from {low:g} to {high:g}: {rule}"
            at = int(frame[rows[-1]])
            self._events.report(self._of_frame(reading, at, "toolface", self.seems_radians))

    def _seem_tenths(self, low: float, high: float) -> bool:
        """Return whether the first toolfaces lie in one turn of tenths of a degree and do not only count turns."""
        falls = sum(after < before for before, after in itertools.pairwise(self._toolfaces))
        return low >= -1800 and 720 < high <= 3600 and FIRST_TOOLFACES / 5 < falls < FIRST_TOOLFACES * 4 / 5

    def _images(self, reading: Reading, values: Floats, states: Bytes, flags: Integers) -> None:
        for image in self.source.images:
            sectors = [self._column[item.name] for item in image.sectors]
            frame = np.flatnonzero((states[:, sectors] == VALUE).any(axis=1))
            if not len(frame):
                continue
            depth = np.full(len(values), np.nan) if image.depth is None else self._value(values, image.depth)
            lacking = image.depth is not None and np.isnan(depth[frame])
            rows = measured(reading.frames[frame], image.latency, image.offset)
            rows["depth"], rows["flags"] = depth[frame], flags[frame] | np.where(lacking, Flag.NULL, 0)
            reading.images.append((image, rows, values[frame][:, sectors]))


def _counts_passes(number: Floats) -> Mask:
    whole: Mask = (number >= 0) & (number <= LARGEST) & (np.floor(number) == number)
    return whole

"""The model of a live wall: a pure function of the journal's records, in order.

    records -> parser and mapping of each source -> rig tracks -> samples placed -> layers (walls), images, path

The same records give the same bits, whether the model takes them one by one or, at a replay, in thousands. Each sample
has its time, so the wall does not depend on how samples were grouped; a sample gets its depth only when the depth
entries before and after it are known. The model uses no socket, no file and no system clock.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from helibore.base.angles import wrapped
from helibore.live import journal
from helibore.live.clock import SECOND, ModelClock
from helibore.live.configuration import Configuration
from helibore.live.depth import Rig
from helibore.live.depth_limits import CONFIRMED_WITHIN, HeldSample
from helibore.live.events import NEVER_DRAWN, Event, EventBook, Flag
from helibore.live.image_rows import ImageRows
from helibore.live.layout import Layout
from helibore.live.mapping import Chunk, Reading, SourceReader
from helibore.live.pass_log import PassLog
from helibore.live.pass_rules import NO_NUMBER, PASSES, layer_of
from helibore.live.stations import Stations
from helibore.live.store_reader import reader_of
from helibore.live.update import Update, joined
from helibore.wall.wall import Wall

Rows = npt.NDArray[np.void]
PENDING = np.dtype(
    [("time", "i8"), ("order", "i8"), ("received", "i8"), ("depth", "f8"), ("offset", "f8"), ("toolface", "f8"),
     ("radius", "f8"), ("flags", "i8"), ("image", "i8"), ("row", "i8"), ("wall", "i8"),
     ("source", "i4"), ("number", "i4"), ("connection", "i4"), ("line", "i8")]
)  # fmt: skip


LATEST = 4e9
"""Seconds since 1970: a sample with a time later than this (2096), or earlier than its negative, is wrong."""
LARGEST_TOOLFACE = 1e6
"""Degrees: a toolface with a larger absolute value is wrong."""
LARGEST_RADIUS = 10.0
"""Metres: a larger radius from a host is wrong."""


class Model:
    """The walls, images and path that result from a configuration and records.

    Attributes
    ----------
    layers
        A wall for each layer of the configuration; ``layers["main"]`` is the wall.
    images, stations
        The image rows and the survey stations.
    layouts
        The layout of each image whose layout is known.
    records, wall_time
        Number of records taken, and receive time of the last one, ns since 1970.
    passes
        The log that decides the pass of each sample and lists the passes so far.
    events, counts
        Events, and counters of samples: received, drawn, kept apart, and not drawn by each flag.
    """

    def __init__(self, configuration: Configuration) -> None:
        self.configuration = configuration
        self.events = EventBook()
        self.counts: Counter[str] = Counter()
        self.layers = {name: Wall(**configuration.wall) for name in configuration.layers}
        self.stations = Stations(configuration.path, configuration.depth)
        self.images: dict[str, ImageRows] = {}
        self.readers = {
            number: reader_of(configuration.sources[name], self.events, configuration.depth)
            for number, name in enumerate(sorted(configuration.sources), 1)
        }
        self.numbers = {name: number for number, name in enumerate(sorted(configuration.sources), 1)}
        self.layouts = {image.name: image.layout for one in configuration.sources.values() for image in one.images}
        self._image_list = [image for source in configuration.sources.values() for image in source.images]
        for image in self._image_list:
            self.images[image.name] = ImageRows(len(image.sectors), image.unit)
        self.clock = ModelClock()
        self.rig = Rig(configuration.passes, configuration.depth)
        self._held = {number: HeldSample(configuration.depth) for number in self.readers}
        self._takes = {name: layer_of(names) for name, names in configuration.layers.items()}
        numbers = {self.numbers[name]: (name, one.pass_numbers) for name, one in configuration.sources.items()}
        self.passes = PassLog(numbers, self.events)
        self._pending = np.empty(0, PENDING)
        self._held_rows: dict[int, npt.NDArray[np.float64]] = {}
        self._next_row = 0
        self._session = ""
        latencies = [image.latency for image in self._image_list]
        latencies += [source.caliper.latency for source in configuration.sources.values() if source.caliper]
        self._longest_latency = int(max(latencies, default=0.0) * SECOND)
        self._deepest = dict.fromkeys(self.layers, -np.inf)
        self.last_seen: dict[str, int] = {}
        self.records = self.wall_time = 0

    @property
    def waiting(self) -> int:
        """Samples and image rows whose depth is not known yet."""
        return len(self._pending)

    def take(self, records: Rows, payloads: list[bytes]) -> Update:
        """Read records in order; any grouping of the same records gives the same walls."""
        update = Update()
        if len(records):
            self.records, self.wall_time = self.records + len(records), int(records["wall"][-1])
        opened = np.flatnonzero(records["kind"] == journal.OPENED).tolist()
        for start, stop in zip([0, *opened], [*opened, len(records)], strict=True):
            if start in opened and start < stop:
                self._open(records[start], payloads[start])
            if start < stop:
                self._take_session(records[start:stop], payloads[start:stop], update)
        update.events = self.events.take()
        return update

    def report(self, wall: int, rule: str, text: str, source: str = "") -> None:
        """Report an event that belongs to no record, at ``wall``, ns since 1970."""
        self.events.report(Event(wall, source, 0, 0, -1, rule, text))

    def _open(self, record: np.void, payload: bytes) -> None:
        session = ""
        with self._set_aside(record, "session header"):
            session = str(json.loads(payload or b"{}").get("session", ""))
        if session and session == self._session:
            return  # the same session goes on in a new segment
        self._session = session
        behind = self.clock.begin_session(int(record["wall"]), int(record["monotonic"]))
        if behind:
            self._report(
                record, "clock", f"the wall clock is {behind / SECOND:.3f} s behind the last session: not followed"
            )

    def _report(self, record: np.void, rule: str, text: str, source: str = "", connection: int = 0) -> None:
        self.events.report(Event(int(record["wall"]), source, connection, 0, -1, rule, text))

    @contextmanager
    def _set_aside(self, record: np.void, what: str, source: str = "") -> Iterator[None]:
        """Report an error in the block and leave its record out: no record may stop the drawing."""
        try:
            yield
        except Exception as error:
            self.counts["set aside"] += 1
            number, reason = int(record["sequence"]), f"{type(error).__name__}: {error}"
            self._report(record, "aside", f"{what} of record {number}: {reason}: set aside", source)

    def _take_session(self, records: Rows, payloads: list[bytes], update: Update) -> None:
        times = self.clock.times(records["monotonic"])
        for row, jumped in self.clock.jumps(records["wall"], times):
            self._report(records[row], "clock", f"the wall clock was set by {jumped / SECOND:+.3f} s: not followed")
        found: list[Rows] = []
        for number in np.unique(records["source"]).tolist():
            rows = np.flatnonzero(records["source"] == number)
            if number in self.readers:
                found += self._read(number, rows, records, payloads, times, update)
            else:
                found += self._pushed(rows, records, payloads, times, update)
        self.rig.settle()
        if found or len(self._pending):
            self._pending = np.concatenate([self._pending, *found])
            before = self._pending
            with self._set_aside(records[-1], f"{len(before)} samples and image rows"):
                self._place(int(times[-1]), update)
            if self._pending is before:  # it failed before it set the rows that wait
                self._pending = before[:0]
        oldest = int(self._pending["time"].min()) if len(self._pending) else int(times[-1])
        self.rig.forget(min(oldest, int(times[-1]) - max(self._longest_latency, CONFIRMED_WITHIN)))

    def _read(
        self, source: int, rows: npt.NDArray[np.int64], records: Rows, payloads: list[bytes],
        times: npt.NDArray[np.int64], update: Update,
    ) -> list[Rows]:  # fmt: skip
        """Pass one source's records to its reader, one connection at a time."""
        reader = self.readers[source]
        name = reader.source.name
        found: list[Rows] = []
        self._watch_silence(name, rows, records, times)
        closed = records["kind"][rows] == journal.CLOSED
        connection = records["connection"][rows]
        cuts = np.flatnonzero((np.diff(connection) != 0) | closed[:-1]) + 1
        for run in np.split(rows, cuts):
            kinds = records["kind"][run]
            number = int(records["connection"][run[0]])
            for row in run[kinds == journal.CONNECTED].tolist():
                self.counts[f"connections {name}"] += 1
                self._report(records[row], "connected", payloads[row].decode(errors="replace"), name, number)
            for some, closing in ((run[kinds == journal.BYTES], False), (run[kinds == journal.CLOSED], True)):
                if not len(some):
                    continue
                texts = [] if closing else [payloads[row] for row in some.tolist()]
                order = records["sequence"][some].astype(np.int64)
                chunk = Chunk(number, texts, times[some], order, records["wall"][some], closing)
                with self._set_aside(records[some[0]], f"{len(some)} packets", name):
                    for reading in reader.read(chunk):
                        found += self._use(reading, reader, update)
        return found

    def _watch_silence(
        self, name: str, rows: npt.NDArray[np.int64], records: Rows, times: npt.NDArray[np.int64]
    ) -> None:
        last_received = rows[records["kind"][rows] == journal.BYTES]
        if not len(last_received):
            return
        silence = int(self.configuration.sources[name].silence * SECOND)
        before = np.concatenate([[self.last_seen.get(name, int(times[last_received[0]]))], times[last_received]])
        for index in np.flatnonzero(np.diff(before) > silence).tolist():
            quiet = (int(before[index + 1]) - int(before[index])) / SECOND
            record = records[last_received[index]]
            self._report(record, "silence", f"nothing came for {quiet:.1f} s", name, int(record["connection"]))
        self.last_seen[name] = int(times[last_received[-1]])

    def _use(self, reading: Reading, reader: SourceReader, update: Update) -> list[Rows]:
        """Add rig quantities to tracks and stations to the path; return triples and image rows as pending rows."""
        self.counts["keep_alives"] += reading.keep_alives
        for name, values in reading.rig.items():
            self.rig.tracks[name].append(reading.time, reading.order, values)
        name = reader.source.name
        for station, frame in zip(reading.stations.tolist(), reading.station_frame.tolist(), strict=True):
            wall, line = int(reading.wall[frame]), int(reading.line[frame])
            event = Event(wall, name, reading.connection, line, -1, "station", "")
            self._station(station, event, update)
        found = []
        caliper = reader.source.caliper
        if caliper and len(reading.triple_frame):
            rows = self._pending_rows(reading, reading.triple_frame, caliper.latency, caliper.offset)
            rows["depth"], rows["toolface"], rows["radius"] = reading.triples.T
            rows["flags"], rows["image"] = reading.triple_flags, -1
            rows["source"], rows["number"] = self.numbers[name], reading.pass_number[reading.triple_frame]
            rows, wrong = self._held[self.numbers[name]].take(rows)
            jumped = f"jumps by more than {self.configuration.depth.jump:g} m, and the next depth does not confirm it"
            self._report_depths(wrong, lambda _: jumped)
            found.append(rows)
        for image, frame, depth, values, flags in reading.images:
            rows = self._pending_rows(reading, frame, image.latency, image.offset)
            rows["depth"], rows["flags"], rows["image"] = depth, flags, self._image_list.index(image)
            rows["row"] = np.arange(self._next_row, self._next_row + len(rows))
            self._held_rows.update(zip(rows["row"].tolist(), values, strict=True))
            self._next_row += len(rows)
            found.append(rows)
        return found

    @staticmethod
    def _pending_rows(reading: Reading, frame: npt.NDArray[np.int64], latency: float, offset: float) -> Rows:
        rows = np.zeros(len(frame), PENDING)
        rows["received"] = reading.order[frame]
        rows["time"] = reading.time[frame] - int(latency * SECOND)
        rows["order"] = reading.order[frame] if latency == 0 else -1
        rows["offset"] = offset
        rows["wall"], rows["line"], rows["connection"] = reading.wall[frame], reading.line[frame], reading.connection
        return rows

    def _station(self, station: list[float], event: Event, update: Update) -> None:
        """Add a station to the survey; if it is refused, report ``event`` with the reason."""
        moved, refused = self.stations.take(*station)
        if refused:
            self.events.report(replace(event, text=refused))
        if moved is not None:
            update.path_from = moved if update.path_from is None else min(moved, update.path_from)

    def _pushed(
        self, rows: npt.NDArray[np.int64], records: Rows, payloads: list[bytes], times: npt.NDArray[np.int64],
        update: Update,
    ) -> list[Rows]:  # fmt: skip
        """Read what the host pushed, each with its depth: add stations and image rows, return samples."""
        found: list[Rows] = []
        for row in rows.tolist():
            with self._set_aside(records[row], "what the host pushed"):
                found += self._pushed_record(records[row], payloads[row], int(times[row]), update)
        return found

    def _pushed_record(self, record: np.void, payload: bytes, time: int, update: Update) -> list[Rows]:
        found: list[Rows] = []
        kind = int(record["kind"])
        if kind == journal.SAMPLES:
            depth, toolface, radius, stamp = np.frombuffer(payload).reshape(4, -1)
            good = (np.isnan(stamp) | (np.abs(stamp) <= LATEST)) & (radius > 0) & (radius <= LARGEST_RADIUS)
            wrong = ~(good & (np.abs(toolface) <= LARGEST_TOOLFACE) & np.isfinite(depth))
            stamp = np.where(wrong, np.nan, stamp)
            pending = np.zeros(len(depth), PENDING)
            pending["flags"] = np.where(wrong, int(Flag.RANGE), 0)
            pending["depth"], pending["toolface"], pending["radius"] = depth, wrapped(toolface), radius
            pending["time"] = np.where(np.isnan(stamp), time, np.nan_to_num(stamp) * SECOND)
            pending["order"], pending["image"] = int(record["sequence"]) << 20, -1
            pending["received"] = pending["order"]
            pending["wall"], pending["number"] = int(record["wall"]), NO_NUMBER
            found.append(pending)
        elif kind == journal.STATIONS:
            for station in np.frombuffer(payload).reshape(3, -1).T.tolist():
                self._station(station, Event(int(record["wall"]), "", 0, 0, -1, "station", ""), update)
        elif kind == journal.IMAGE:
            head, _, values = payload.partition(b"\n")
            name, sectors, unit, *layout = json.loads(head)
            if layout:
                self.layouts[name] = Layout(*layout)
            table = np.frombuffer(values).reshape(-1, sectors + 1)
            wrong = ~np.isfinite(table[:, 0]) | self.configuration.depth.outside(table[:, 0])
            if wrong.any():
                text = f"image {name}: depth {table[wrong, 0][0]:g} m: {self.configuration.depth.rule()}"
                self._report(record, "range", text)
            table = table[~wrong]
            image = self.images.setdefault(name, ImageRows(sectors, unit))
            start, stop = image.append(table[:, 0], table[:, 1:])
            update.images[name] = (update.images.get(name, (start, 0))[0], stop)
        return found

    def _place(self, now: int, update: Update) -> None:
        """Compute the depths of pending rows, draw the rows that are ready, and keep the others."""
        rows = self._pending
        depth, kind, flags, ready = self.rig.place(rows["time"], rows["order"], rows["depth"], rows["offset"], now)
        flags = flags | rows["flags"]
        flags[self.configuration.depth.outside(depth)] |= Flag.RANGE
        ready |= (rows["flags"] & int(NEVER_DRAWN)) != 0  # needs no depth
        new = ready & ((flags & ~rows["flags"] & Flag.RANGE) != 0)
        if new.any():
            shown = rows[new]
            shown["depth"] = depth[new]
            orders = shown["received"].tolist()
            self._report_depths(shown, lambda place: self.rig.depth_rule(float(shown["depth"][place]), orders[place]))
        self._pending = rows[~ready]
        late_from_bit = ((flags & Flag.LATE) != 0) & np.isnan(rows["depth"])
        flags[late_from_bit] |= Flag.NO_DEPTH  # its time of measurement is not known
        triples = ready & (rows["image"] < 0)
        if not triples.all():  # copying nearly all rows would double memory
            self._draw(rows[triples], depth[triples], kind[triples], flags[triples], update)
        else:
            self._draw(rows, depth, kind, flags, update)
        for index in np.unique(rows["image"][ready & (rows["image"] >= 0)]).tolist():
            self._draw_image(index, rows, depth, flags, ready & (rows["image"] == index), update)

    def _report_depths(self, rows: Rows, rule: Callable[[int], str]) -> None:
        """Report depths that cannot be true; ``rule(i)`` returns what is wrong with row ``i``."""
        if len(rows):
            depths = rows["depth"].tolist()
            self.passes.report(rows, np.arange(len(rows)), "range", lambda i: f"depth {depths[i]:g} m: {rule(i)}")

    def _append(self, name: str, rows: Rows, columns: tuple[npt.NDArray[np.float64], ...], update: Update) -> None:
        """Append samples to a layer; if that fails, append record by record and leave out only the wrong record."""
        layer = self.layers[name]
        try:
            change = layer.append(*columns)
        except (ValueError, MemoryError, RuntimeError) as error:
            failure = error
        else:
            update.changes[name] = joined(update.changes.get(name), change)
            return
        records = rows["received"] >> 20
        numbers = np.unique(records)
        if len(numbers) == 1:
            text = f"layer {name}: {len(rows)} samples: {str(failure) or type(failure).__name__}: set aside"
            self.passes.report(rows, np.arange(1), "aside", lambda _: text)
            self.counts["set aside"] += len(rows)
            return
        for number in numbers:
            of = records == number
            self._append(name, rows[of], tuple(column[of] for column in columns), update)

    def _draw(
        self, rows: Rows, depth: npt.NDArray[np.float64], kind: npt.NDArray[np.int64], flags: npt.NDArray[np.int64],
        update: Update,
    ) -> None:  # fmt: skip
        if not len(rows):
            return
        self.counts["received"] += len(rows)
        if flags.any():
            for flag in Flag:
                self.counts[f"flag {flag.name}"] += int(np.count_nonzero(flags & flag))
        good = (flags & int(NEVER_DRAWN)) == 0
        if not good.all():
            self.counts["not drawn"] += int(np.count_nonzero(~good))
            rows, depth, kind = rows[good], depth[good], kind[good]
        if not len(rows):
            return
        kind = self.passes.decide(rows, kind)
        self.passes.add(rows["source"], rows["number"], kind, rows["time"], depth)
        for name, count in zip(PASSES, np.bincount(kind, minlength=len(PASSES)).tolist(), strict=True):
            self.counts[f"pass {name}"] += count
        time = (rows["time"] - self.clock.began) / SECOND
        drawn = np.zeros(len(rows), bool)
        gaps = []
        for name in self.layers:
            chosen = self._takes[name].chosen(kind, rows["number"])
            if not chosen.any():
                continue
            drawn |= chosen
            columns = (depth[chosen], rows["toolface"][chosen], rows["radius"][chosen], time[chosen])
            self._append(name, rows[chosen], columns, update)
            gaps += self._depth_gaps(name, depth[chosen], np.flatnonzero(chosen))
        if gaps:
            self.passes.report(rows, np.array([row for row, _ in gaps]), "depth_gap", lambda place: gaps[place][1])
        self.counts["drawn"] += int(np.count_nonzero(drawn))
        self.counts["kept apart"] += int(np.count_nonzero(~drawn))

    def _depth_gaps(
        self, name: str, depth: npt.NDArray[np.float64], rows: npt.NDArray[np.int64]
    ) -> list[tuple[int, str]]:
        """Return (row, text) for each of ``rows`` after a gap in ``depth`` that is longer than samples can fill."""
        limit = 2 * float(self.configuration.wall.get("max_distance") or 1.0)
        deepest = np.maximum.accumulate(np.concatenate([[self._deepest[name]], depth]))
        jumps = np.flatnonzero(np.isfinite(deepest[:-1]) & (np.diff(deepest) > limit))
        self._deepest[name] = float(deepest[-1])
        return [
            (int(rows[jump]), f"layer {name}: no samples from {deepest[jump]:.3f} m to {depth[jump]:.3f} m")
            for jump in jumps.tolist()
        ]

    def _draw_image(
        self, index: int, rows: Rows, depth: npt.NDArray[np.float64], flags: npt.NDArray[np.int64],
        chosen: npt.NDArray[np.bool_], update: Update,
    ) -> None:  # fmt: skip
        name = self._image_list[index].name
        good = chosen & ((flags & NEVER_DRAWN) == 0)
        held = {int(row): self._held_rows.pop(int(row)) for row in rows["row"][chosen].tolist()}
        self.counts[f"image {name} rows not drawn"] += int(np.count_nonzero(chosen & ~good))
        if good.any():
            values = np.array([held[row] for row in rows["row"][good].tolist()])
            start, stop = self.images[name].append(depth[good], values)
            update.images[name] = (update.images.get(name, (start, 0))[0], stop)

"""The model of a live wall: a pure function of the journal's records, in order.

    records -> parser and mapping of each source -> rig tracks -> samples placed -> layers (walls), images, path

The same records give walls that are equal in every bit, whether the model takes them one by one or, at a replay, in
thousands. Each sample has its own time, so the wall does not depend on how samples were grouped. A sample without a
depth of its own waits until the bit depths before and after its time are known. The model uses no socket, no file and
no system clock.
"""

from __future__ import annotations

import itertools
import json
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np

from helibore import _core
from helibore.base.angles import wrapped
from helibore.base.arrays import Floats, Integers, Integers32, Mask, Rows, distinct
from helibore.base.errors import InputError
from helibore.base.utc_time import SECOND, utc
from helibore.live.journal import journal
from helibore.live.journal.session_header import configuration_of, read_header
from helibore.live.model.cell_counts import CellCounts
from helibore.live.model.clock import ModelClock
from helibore.live.model.depth import RigHistory
from helibore.live.model.depth_jumps import CONFIRMED_WITHIN, HeldSample
from helibore.live.model.events import NEVER_DRAWN, Event, EventBook, Flag
from helibore.live.model.fits import LayerFits, fits_of, read_fit
from helibore.live.model.growing_array import GrowingArray
from helibore.live.model.image_rows import ImageRows
from helibore.live.model.mapping import LARGEST_TOOLFACE, Chunk, Reading, SourceReader
from helibore.live.model.pass_log import PassLog
from helibore.live.model.rig_channels import RigChannels
from helibore.live.model.sample_rows import ROW, frame_rows
from helibore.live.model.stations import Stations
from helibore.live.model.update import Update, joined
from helibore.live.model.watch import Frame, Watch, WatchedCaliper
from helibore.live.rules.configuration import Configuration, HoleTable
from helibore.live.rules.kinds import kind_of
from helibore.live.rules.layout import Layout
from helibore.live.rules.pass_rules import PASSES, layer_of
from helibore.live.rules.sources import Source
from helibore.samples.caliper import LARGEST_RADIUS
from helibore.trajectory.survey import Path
from helibore.wall.latest_pass import SAMPLE, latest_pass, stuck
from helibore.wall.state import WallState
from helibore.wall.wall import Wall

LATEST = 4e9
"""Seconds. A sample is wrong if its time differs from the start of 1970 by more than this, as in the year 2097."""
MOST_SET_ASIDE = 10_000
"""The model keeps the numbers and reasons of at most this many records that were set aside."""
AFTER_FRAMES = (1 << 20) - 1
"""The place of a record of bytes among its frames."""
APART = "passes apart"
"""What stands in the place of a layer's name for the samples that the layer ``main`` does not take."""
UNUSABLE = Flag.NULL | Flag.INVALID | Flag.DUPLICATE | Flag.LATE
"""Flags of triples that the watch does not take."""
USABLE, OUTSIDE = "usable", "outside"
"""Outcomes of a sample that no flag refuses: usable, or outside, because all layers that take it begin after it."""


class Model:
    """The walls, images and path that result from a configuration and records.

    Attributes
    ----------
    layers
        A wall for each layer of the configuration in each hole, by its name; ``layers[main]`` is the wall.
    main
        Name of the layer ``main`` in the hole that is drilled now.
    left
        Stations of the other holes, by the name of their layer ``main``.
    apart
        The samples of passes that ``layers[main]`` does not take, in order of arrival, by the name of this layer.
    images, stations
        The rows of each image by its name; the survey stations.
    layouts
        The layout of the sectors of each image, if it is known.
    records
        Number of records taken, without session headers.
    wall_time, next_sequence
        Receive time (ns since 1970) of the latest record; the number of the record after it.
    passes
        The log that decides the pass of each sample and lists the passes.
    fits
        The fits of each layer, if the estimator is 'automatic'.
    stretches
        One entry for each change of the configuration: utc and record of the change, the new text and its meaning.
    events
        The book of all events.
    counts
        Counters by name. A sample that is ``received`` is ``not drawn`` (refused by a flag), ``kept apart`` (no layer
        takes it, it lies before the start, it is ``crowded`` or it was set aside) or ``drawn``. Other names count the
        samples with each flag and of each pass, connections, keep-alives, and what was set aside.
    outcomes
        Number of samples by source and outcome: `USABLE`, `OUTSIDE`, or each flag that refuses the sample, except
        NOT_ROTATING. Samples of the host are not counted.
    out_of_memory
        Whether a record was set aside because the memory was full. A replay with more memory can draw this record.
    set_aside
        The reason for each record that was set aside, by its number; at most MOST_SET_ASIDE records.
    channels
        The channels of the rig that are shown.
    last_seen
        Time of the last bytes of each source, ns of the model's clock.
    """

    STATE = (
        "fits", "samples", "image_rows", "stations", "layouts", "readers", "clock", "rig", "passes", "events", "counts",
        "outcomes", "records", "wall_time", "next_sequence", "last_seen", "set_aside", "_cell_counts", "_held",
        "_pending", "_held_rows", "_next_row", "_session", "_meaning", "_deepest", "watch",
        "channels", "left", "apart", "_apart_counts",
    )  # fmt: skip

    def __init__(
        self, configuration: Configuration, *, follows: bool = True, numbers: Mapping[str, int] | None = None
    ) -> None:
        self.configuration = configuration
        self.follows = follows  # whether session headers change the configuration
        self._meaning = configuration.meaning()
        self.stretches: list[dict[str, str]] = []
        self.events = EventBook()
        self.counts: Counter[str] = Counter()
        self.outcomes: Counter[tuple[str, str]] = Counter()
        self.fits: dict[str, LayerFits] = {}
        self.layers = {name: self._begin_wall(name) for name in configuration.layers}
        self._given_hole, self._first_hole, self.main = configuration.hole, configuration.hole.name, "main"
        self._drawn_layers = {name: name for name in configuration.layers}  # in the hole that is drilled now
        self._hole_of = dict.fromkeys(configuration.layers, "main")
        self.left: dict[str, Stations] = {}
        self.stations = Stations(configuration.path, configuration.depth)
        self.images: dict[str, ImageRows] = {}
        self.numbers = dict(numbers or {name: number for number, name in enumerate(sorted(configuration.sources), 1)})
        self.readers = {
            self.numbers[name]: kind_of(source).reader(source, self.events, configuration.depth)
            for name, source in sorted(configuration.sources.items())
        }
        self.layouts = {image.name: image.layout for one in configuration.sources.values() for image in one.images}
        self._image_list = [image for source in configuration.sources.values() for image in source.images]
        for image in self._image_list:
            self._image(image.name, len(image.sectors), image.unit)
        self.clock = ModelClock()
        self.rig = RigHistory(configuration.passes, configuration.depth)
        self._held = {number: HeldSample(configuration.depth) for number in self.readers}
        self._takes = {name: layer_of(names) for name, names in configuration.layers.items()}
        meanings = {self.numbers[name]: (name, one.pass_numbers) for name, one in configuration.sources.items()}
        self.passes = PassLog(meanings, self.events)
        self._pending = np.empty(0, ROW)
        self._held_rows: dict[int, Floats] = {}
        self._next_row = 0
        self.apart = {self.main: GrowingArray(SAMPLE)}
        self._session = ""
        self.out_of_memory = False
        self._longest_latency = 0
        self._deepest: dict[tuple[str, int], float] = {}
        self.last_seen: dict[str, int] = {}
        self.records = self.wall_time = self.next_sequence = 0
        self.set_aside: dict[int, str] = {}
        self.watch = Watch(self._watched)
        self.channels = RigChannels(self._watched)
        self._frames: list[Frame] = []
        self._cell_counts: dict[str, dict[int, CellCounts]] = {name: {} for name in self.layers}
        self._apart_counts: dict[int, CellCounts] = {}
        self._set_limits()

    @property
    def samples(self) -> dict[str, tuple[tuple[Floats, ...], int]]:
        """For each layer that has samples: the columns of its samples, and a checksum of its vertices."""
        states = {name: wall._state() for name, wall in self.layers.items() if wall.sample_count}
        return {name: (state.sample_columns, _checksum(state)) for name, state in states.items()}

    @samples.setter
    def samples(self, samples: dict[str, tuple[tuple[Floats, ...], int]]) -> None:
        for name, (columns, checksum) in samples.items():
            if name in self.fits:
                self.layers[name]._redraw(self.fits[name].settings)
            self.layers[name].append(*columns)
            if _checksum(self.layers[name]._state()) != checksum:
                raise InputError(f"layer {name}", "its samples give another wall than before")

    @property
    def image_rows(self) -> dict[str, tuple[Any, ...]]:
        """For each image: number of sectors, unit, and the rows in order of arrival (numbers, depths and values)."""
        return {name: (rows.sectors, rows.unit, *rows.so_far()) for name, rows in self.images.items()}

    @image_rows.setter
    def image_rows(self, images: dict[str, tuple[Any, ...]]) -> None:
        for name, (sectors, unit, *columns) in images.items():
            self._image(name, sectors, unit).restore(*columns)

    def _image(self, name: str, sectors: int, unit: str) -> ImageRows:
        """Return the rows of an image; if there are none yet, make an empty `ImageRows`."""
        return self.images.setdefault(name, ImageRows(sectors, unit, self.configuration.samples.image_step))

    def _begin_wall(self, layer: str, before: str = "") -> Wall:
        """Return an empty wall for a layer; with what was found for the layer ``before``, if it is fitted."""
        if fits := fits_of(self.configuration.wall, self.fits.get(before)):
            self.fits[layer] = fits
        return Wall(**self.configuration.wall | (vars(fits.settings) if fits else {}))

    def path_of(self, layer: str) -> Path | None:
        """Return the path of the hole of a layer; None while there is no survey of it."""
        hole = self._hole_of[layer]
        return (self.stations if hole == self.main else self.left[hole]).path

    @property
    def waiting(self) -> int:
        """Number of samples and image rows whose depth is not known yet."""
        return len(self._pending)

    @property
    def was_stuck(self) -> bool:
        """Whether a caliper has sent one radius again and again."""
        return any(rule == "stays" for _, rule in self.events.counts)

    def last_scan(self, wall: WallState) -> WallState:
        """Return the wall of the layer ``main``, or a part of it, as the last pass of any kind saw it."""
        return latest_pass(wall, self.was_stuck, self.apart[self.main].values)

    def take(self, records: Rows, payloads: list[bytes]) -> Update:
        """Read records in order and return what changed; any grouping of the same records gives the same walls."""
        update = Update()
        kinds = records["kind"]
        if len(records):
            self.records += int(np.count_nonzero(kinds != journal.OPENED))
            self.wall_time = int(records["wall"][-1])
            self.next_sequence = int(records["sequence"][-1]) + 1
        cuts = np.flatnonzero((kinds == journal.OPENED) | (kinds == journal.FITTED)).tolist()
        for start, stop in itertools.pairwise(sorted({0, *cuts, len(records)})):
            if kinds[start] == journal.OPENED:
                self._open(records[start], payloads[start])
            elif kinds[start] == journal.FITTED and self.follows:
                with self._set_aside(records[start], "fit"):
                    self.use_fit(payloads[start], int(records["wall"][start]), update)
            self._take_session(records[start:stop], payloads[start:stop], update)
        update.events = self.events.take()
        return update

    def use_fit(self, payload: bytes, wall: int, update: Update) -> None:
        """Draw a layer again with what a fit found, the payload of a record FITTED that came at ``wall``."""
        name, length, found, text = read_fit(payload)
        if name not in self.fits:
            raise InputError("fit.layer", "must be a layer whose estimator is automatic", repr(name))
        if (change := self.fits[name].use(length, found, self.layers[name])) is not None:
            update.changes[name] = joined(update.changes.get(name), change)
        said = f"layer {name}: from its first {length:g} m: {text}"
        self.events.report(Event(wall, "", 0, 0, -1, "estimator", said))

    def report(self, wall: int, rule: str, text: str, source: str = "", *, recorded: bool = False) -> None:
        """Report an event at ``wall``, ns since 1970; ``recorded``: a replay of the journal reports it again."""
        self.events.report(Event(wall, source, 0, 0, -1, rule, text), recorded=recorded)

    def _open(self, record: np.void, payload: bytes) -> None:
        header: dict[str, str] = {}
        with self._set_aside(record, "session header"):
            header = read_header(payload)
        if self._reads(header) and header.get("meaning", self._meaning) != self._meaning:
            self._meaning = header["meaning"]
            with self._set_aside(record, "session header"):
                now = configuration_of(header)
                if not self.follows:
                    if not self._session:  # the first header of the journal
                        self._first_hole = now.hole.name
                    now = replace(self.configuration, hole=now.hole)
                if now.meaning() != self.configuration.meaning():
                    self._change(record, now)
        session = str(header.get("session", ""))
        if session and session == self._session:
            return  # the same session goes on in a new segment, or with another configuration
        self._session = session
        behind = self.clock.begin_session(int(record["wall"]), int(record["monotonic"]))
        if behind:
            self._report(
                record,
                "clock",
                f"the wall clock is {behind / SECOND:.3f} s behind the last session; sample times do not go back",
            )

    def _reads(self, header: dict[str, str]) -> bool:
        """Return whether a session header changes the configuration, or at least the hole.

        A replay with a configuration of its own goes through the holes of the journal, unless it states a hole.
        """
        return self.follows or (self._given_hole == HoleTable() and bool(header.get("configuration")))

    def change_from(self, record: np.void, configuration: Configuration) -> None:
        """Read ``record`` and all later ones with another configuration, whatever later session headers say.

        They still change the hole, unless ``configuration`` states one. The caller has checked as for `reconfigure`.
        """
        self.follows, self._given_hole = False, configuration.hole
        self._change(record, configuration)

    def _change(self, record: np.void, configuration: Configuration) -> None:
        before, now = self.configuration.hole, configuration.hole
        self.reconfigure(configuration, utc(int(record["wall"])), int(record["sequence"]))
        self._report(record, "configuration", "another configuration applies from here on")
        if now.name != before.name:
            shared = "" if now.kickoff is None else f", which leaves the hole before at {now.kickoff:g} m"
            text = f"hole {now.name or 'without a name'}{shared}: later samples are drawn in the wall {self.main}"
            self._report(record, "hole", text)
        if now.shift != before.shift:
            text = f"depths that come are shifted by {now.shift:+g} m from here on, {before.shift:+g} m before"
            self._report(record, "shift", text)

    def reconfigure(self, configuration: Configuration, since: str, sequence: int) -> None:
        """Read all later records with another configuration; walls, images and path stay.

        ``since`` and ``sequence`` are UTC and number of the record that changes the configuration. The caller has
        checked with ``session_header.py`` that the journal can change to this configuration.
        """
        before, self.configuration = self.configuration, configuration
        if self.main != ("main" if configuration.hole.name == self._first_hole else configuration.hole.name):
            self._begin_hole(configuration.hole)
        self.watch.shift(configuration.hole.shift - before.hole.shift)
        self.stretches.append({"utc": since, "record": str(sequence), "configuration": configuration.text,
                               "meaning": configuration.meaning()})  # fmt: skip
        for name, source in sorted(configuration.sources.items()):
            number = self.numbers.setdefault(name, len(self.numbers) + 1)
            if number in self.readers and (before.sources.get(name), before.depth) == (source, configuration.depth):
                continue
            old = self.readers.get(number)
            self.readers[number] = kind_of(source).reader(source, self.events, configuration.depth)
            if old:
                self.readers[number].go_on_from(old)
            if number in self._held and _depth_items(before.sources.get(name)) != _depth_items(source):
                self._held[number].forget()
        for number in self.readers:
            self._held.setdefault(number, HeldSample(configuration.depth)).limits = configuration.depth
        self.rig.use(configuration.passes, configuration.depth)
        self.passes.meanings |= {
            self.numbers[name]: (name, one.pass_numbers) for name, one in configuration.sources.items()
        }
        for image in [image for source in configuration.sources.values() for image in source.images]:
            places = [place for place, one in enumerate(self._image_list) if one.name == image.name]
            for place in places:
                self._image_list[place] = image
            if not places:
                self._image_list.append(image)
                self._image(image.name, len(image.sectors), image.unit)
            self.layouts[image.name] = image.layout
        self._set_limits()

    def _begin_hole(self, hole: HoleTable) -> None:
        """Draw all later samples in other walls: those of an earlier hole, or new ones with what is above the kickoff.

        Walls that no sample comes to any more stay as they are.
        """
        names = {name: name if hole.name == self._first_hole else hole.layer(name) for name in self._drawn_layers}
        new = {}
        for name, layer in names.items():
            if layer in self.layers:
                continue
            wall = new[layer] = self._begin_wall(layer, self._drawn_layers[name])
            before = self.layers[self._drawn_layers[name]]
            if hole.kickoff is not None and before.sample_count:
                columns = before._state().sample_columns
                wall.append(*(column[columns[0] <= hole.kickoff] for column in columns))
                if layer in self.fits:  # the settings found are of these samples too: no fit is due
                    self.fits[layer].count(columns[0][columns[0] <= hole.kickoff])
            self._takes[layer], self._cell_counts[layer] = self._takes[name], {}
            self._hole_of[layer] = names["main"]
        self.layers = {**self.layers, **new}  # another dictionary: other threads go through the old one
        self.left[self.main], stations = self.stations, self.left.pop(names["main"], None)
        if stations is None:
            stations = Stations(self.configuration.path, self.configuration.depth)
            if hole.kickoff is not None:
                columns = self.stations.columns
                stations.columns = tuple(column[columns[0] <= hole.kickoff] for column in columns)
        if names["main"] not in self.apart:
            seen, apart = self.apart[self.main].values, GrowingArray(SAMPLE)
            if hole.kickoff is not None:
                apart.append(seen[seen["depth"] <= hole.kickoff])
            self.apart, self._apart_counts = {**self.apart, names["main"]: apart}, {}
        self.stations, self._drawn_layers, self.main = stations, names, names["main"]
        self.watch.begin_hole(hole.kickoff)
        self.rig.begin_hole()

    def _set_limits(self) -> None:
        """Set what a new configuration changes: longest latency (never shorter), image step, samples near a vertex."""
        latencies = [image.latency for image in self._image_list]
        latencies += [one.caliper.latency for one in self.configuration.sources.values() if one.caliper]
        self._longest_latency = max(self._longest_latency, int(max(latencies, default=0.0) * SECOND))
        for rows in self.images.values():
            rows.set_step(self.configuration.samples.image_step)
        measures = {one.caliper.measures for one in self.configuration.sources.values() if one.caliper}
        if "diameter" in measures:
            for name in self._drawn_layers.values():
                self.layers[name].made_from["measures"] = "diameter"
        calipers, bit = {}, self.configuration.wall["bit_diameter"] / 2
        for name, source in self.configuration.sources.items():
            if (caliper := source.caliper) is not None:
                turned = caliper.toolface_offset
                sensors = len(turned) if isinstance(turned, list) else 0
                calipers[name] = WatchedCaliper(bit, caliper.offset, sensors)
        images = {one.name: name for name, source in self.configuration.sources.items() for one in source.images}
        self.watch.use(calipers, images, self.configuration.passes, self.configuration.depth.jump)
        self.channels.use(self.configuration.sources, self.configuration.passes.on_bottom)
        size = self.layers[self.main].settings
        for counts in (*self._cell_counts.values(), self._apart_counts):
            for number in (0, *self.readers):  # 0: the host
                counts.setdefault(number, CellCounts(size.sectors, size.pitch)).set_most(
                    self.configuration.samples.most
                )

    def _watched(self, wall: int, rule: str, source: str, text: str) -> None:
        self.events.report(Event(wall, source, 0, 0, -1, rule, text))

    def _report(self, record: np.void, rule: str, text: str, source: str = "", connection: int = 0) -> None:
        self.events.report(Event(int(record["wall"]), source, connection, 0, -1, rule, text))

    @contextmanager
    def _set_aside(self, record: np.void, what: str, source: str = "") -> Iterator[None]:
        """Catch and report an exception of the ``with`` block, so that a wrong record does not stop the live wall.

        ``what`` is the part of ``record`` that is left out.
        """
        try:
            yield
        except Exception as error:
            self.counts["set aside"] += 1
            self.out_of_memory |= isinstance(error, MemoryError)
            number, reason = int(record["sequence"]), f"{type(error).__name__}: {error}"
            if len(self.set_aside) < MOST_SET_ASIDE:
                self.set_aside[number] = f"{what}: {reason}"
            self._report(record, "aside", f"set aside {what} of record {number}: {reason}", source)

    def _take_session(self, records: Rows, payloads: list[bytes], update: Update) -> None:
        times = self.clock.times(records["monotonic"])
        for row, jumped in self.clock.jumps(records["wall"], times):
            self._report(
                records[row],
                "clock",
                f"the wall clock was set by {jumped / SECOND:+.3f} s; sample times do not jump",
            )
        found: list[Rows] = []
        for number in sorted(set(records["source"].tolist())):
            rows = (records["source"] == number).nonzero()[0]
            if number in self.readers:
                found += self._read(number, rows, records, payloads, times, update)
            else:
                found += self._pushed(rows, records, payloads, times, update)
        self.rig.settle()
        frames, self._frames = self._frames, []
        self.watch.take(frames)
        self.channels.take(frames)
        if parts := [part for part in (self._pending, *found) if len(part)]:
            self._pending = before = np.concatenate(parts) if len(parts) > 1 else parts[0]
            with self._set_aside(records[-1], f"{len(before)} samples and image rows"):
                self._place(int(times[-1]), update)
            if self._pending is before:  # _place failed before it set the rows that still wait
                self._pending = before[:0]
        oldest = int(self._pending["time"].min()) if len(self._pending) else int(times[-1])
        self.rig.forget(min(oldest, int(times[-1]) - max(self._longest_latency, CONFIRMED_WITHIN)))

    def _read(
        self, source: int, rows: Integers, records: Rows, payloads: list[bytes],
        times: Integers, update: Update,
    ) -> list[Rows]:  # fmt: skip
        """Pass the records of a source to its reader, one connection after the other; return pending rows."""
        reader = self.readers[source]
        name = reader.source.name
        found: list[Rows] = []
        self._watch_silence(name, rows, records, times)
        closed = records["kind"][rows] == journal.CLOSED
        connection = records["connection"][rows]
        cuts = np.flatnonzero((connection[1:] != connection[:-1]) | closed[:-1]) + 1
        for start, stop in itertools.pairwise([0, *cuts.tolist(), len(rows)]):
            run = rows[start:stop]
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
                if "bit_depth" in reader.source.rig and not closing:
                    self._frames += [
                        Frame(at + AFTER_FRAMES, time, wall, name, {}, only_bytes=True)
                        for at, time, wall in zip(
                            (order << 20).tolist(), chunk.time.tolist(), chunk.wall.tolist(), strict=True
                        )
                    ]
                with self._set_aside(records[some[0]], f"{len(some)} packets", name):
                    for reading in reader.read(chunk):
                        found += self._use(reading, reader, update)
        return found

    def _watch_silence(self, name: str, rows: Integers, records: Rows, times: Integers) -> None:
        last_received = rows[records["kind"][rows] == journal.BYTES]
        if not len(last_received):
            return
        silence = int(self.configuration.sources[name].silence * SECOND)
        before = np.concatenate([[self.last_seen.get(name, int(times[last_received[0]]))], times[last_received]])
        quiet_for = before[1:] - before[:-1]
        for index in (quiet_for > silence).nonzero()[0].tolist():
            quiet = int(quiet_for[index]) / SECOND
            record = records[last_received[index]]
            self._report(record, "silence", f"nothing came for {quiet:.1f} s", name, int(record["connection"]))
        self.last_seen[name] = int(times[last_received[-1]])

    def _use(self, reading: Reading, reader: SourceReader, update: Update) -> list[Rows]:
        """Add rig quantities to tracks and stations to the path; return triples and image rows as pending rows."""
        self.counts["keep_alives"] += reading.keep_alives
        if shift := self.configuration.hole.shift:
            _shift(reading, shift)
        self._frames += _frames_of(reading, reader.source.name)
        for name, values in reading.rig.items():
            self.rig.tracks[name].append(reading.frames["time"], reading.frames["received"], values)
        name = reader.source.name
        for station, frame in zip(reading.stations.tolist(), reading.station_frames, strict=True):
            wall, connection, line = (int(frame[of]) for of in ("wall", "connection", "line"))
            event = Event(wall, name, connection, line, -1, "station", "")
            self._station(station, event, update)
        found = []
        if len(rows := reading.samples):
            rows["source"] = self.numbers[name]
            rows, wrong, levels = self._held[self.numbers[name]].take(rows)
            jump = f"jumps by more than {self.configuration.depth.jump:g} m, and the next depth does not confirm it"
            text = lambda place: f"depth {rows['depth'][wrong[place]]:g} m: {jump}"  # noqa: E731
            self.passes.report(rows, np.array(wrong, np.int64), "range", text)
            texts = list(levels.values())
            self.passes.report(rows, np.array(list(levels), np.int64), "depth_jump", lambda i: f"depth {texts[i]}")
            found.append(rows)
        for image, rows, values in reading.images:
            rows["image"] = self._image_list.index(image)
            rows["row"] = np.arange(self._next_row, self._next_row + len(rows))
            self._held_rows.update(zip(rows["row"].tolist(), values, strict=True))
            self._next_row += len(rows)
            found.append(rows)
        return found

    def _station(self, station: list[float], event: Event, update: Update) -> None:
        """Add a station to the survey; if the survey refuses it, report ``event`` with the reason."""
        moved, refused = self.stations.take(*station)
        if refused:
            self.events.report(replace(event, text=refused))
        if moved is not None:
            update.path_from = moved if update.path_from is None else min(moved, update.path_from)

    def _pushed(
        self, rows: Integers, records: Rows, payloads: list[bytes], times: Integers,
        update: Update,
    ) -> list[Rows]:  # fmt: skip
        """Read records of the host: add its stations and image rows, and return its samples as pending rows."""
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
            rules = (
                ("depth", "m", depth, np.isfinite(depth), "must be finite"),
                ("toolface", "deg", toolface, np.abs(toolface) <= LARGEST_TOOLFACE,
                 f"must be from {-LARGEST_TOOLFACE:g} to {LARGEST_TOOLFACE:g}"),
                ("radius", "m", radius, (radius > 0) & (radius <= LARGEST_RADIUS),
                 f"must be above 0 and at most {LARGEST_RADIUS:g}"),
                ("time", "s", stamp, np.isnan(stamp) | (np.abs(stamp) <= LATEST),
                 f"must be from {-LATEST:g} to {LATEST:g}, in seconds since 1970"),
            )  # fmt: skip
            wrong = np.zeros(len(depth), bool)
            for name, unit, column, right, rule in rules:
                self._report_wrong(record, name, unit, column, ~right, rule)
                wrong |= ~right
            stamp = np.where(wrong, np.nan, stamp)
            times = np.where(np.isnan(stamp), time, np.nan_to_num(stamp) * SECOND)
            order = np.full(len(depth), int(record["sequence"]) << 20)
            pending = frame_rows(times, order, int(record["wall"]), 0, 0)
            pending["flags"] = np.where(wrong, int(Flag.RANGE), 0)
            pending["depth"], pending["toolface"], pending["radius"] = depth, wrapped(toolface), radius
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
            rule = self.configuration.depth.rule()
            self._report_wrong(record, f"image {name}: depth", "m", table[:, 0], wrong, rule)
            table = table[~wrong]
            image = self._image(name, sectors, unit)
            start, stop = image.append(table[:, 0], table[:, 1:])
            update.images[name] = (update.images.get(name, (start, 0))[0], stop)
        return found

    def _report_wrong(
        self, record: np.void, name: str, unit: str, values: Floats, wrong: Mask,
        rule: str,
    ) -> None:  # fmt: skip
        """Report an event for each of the host's ``values`` that is ``wrong``; the event states the ``rule``."""
        wall = int(record["wall"])
        self.events.report_rows(
            np.flatnonzero(wrong),
            lambda row: Event(wall, "", 0, 0, -1, "range", f"{name} {values[row]:g} {unit}: {rule}"),
        )

    def _place(self, now: int, update: Update) -> None:
        """Compute the depths of pending rows, draw the rows that are ready, and keep the others."""
        rows = self._pending
        depth, kind, flags, ready = self.rig.place(rows["time"], rows["order"], rows["depth"], rows["offset"], now)
        flags = flags | rows["flags"]
        flags[self.configuration.depth.outside(depth)] |= Flag.RANGE
        # A refused row needs no depth. It gets no new flags, because these would depend on how the stream was cut.
        rejected = (rows["flags"] & int(NEVER_DRAWN)) != 0
        flags[rejected] = rows["flags"][rejected]
        ready |= rejected
        new = ready & ((flags & ~rows["flags"] & Flag.RANGE) != 0)
        if new.any():
            shown = rows[new]
            shown["depth"] = depth[new]
            self.passes.report(shown, np.arange(len(shown)), "range", lambda place: self.rig.depth_rule(shown[place]))
        self._pending = rows[~ready]
        late_from_bit = ((flags & Flag.LATE) != 0) & np.isnan(rows["depth"])
        flags[late_from_bit] |= Flag.NO_DEPTH  # the time of the measurement is not known, so no bit depth applies
        triples = ready & (rows["image"] < 0)
        if triples.all():  # a selection would copy all rows and double the memory
            self._draw(rows, depth, kind, flags, update)
            return
        self._draw(rows[triples], depth[triples], kind[triples], flags[triples], update)
        for index in distinct(rows["image"][ready & (rows["image"] >= 0)]).tolist():
            self._draw_image(index, rows, depth, flags, ready & (rows["image"] == index), update)

    def _append(self, name: str, rows: Rows, columns: tuple[Floats, ...], update: Update) -> Mask:
        """Append samples to a layer; return for each sample whether it was appended.

        If the layer refuses the samples, they are appended record by record, without the wrong records.
        """
        layer, fits = self.layers[name], self.fits.get(name)
        length, stop = fits.reached(columns[0]) if fits else (0.0, 0)
        before = layer._state().sample_columns if length and layer.sample_count else (np.empty(0),) * 4
        try:
            change = layer.append(*columns)
        except (ValueError, MemoryError, RuntimeError) as error:
            failure = error
        else:
            if fits:
                fits.count(columns[0])
            if fits and length:
                first = tuple(column[:stop] for column in columns)
                samples = tuple(np.concatenate(both) for both in zip(before, first, strict=True))
                if self.was_stuck:  # such a value would count as noise of all sensors
                    measured = ~stuck(*samples)
                    samples = tuple(column[measured] for column in samples)
                fits.due = length, samples
            update.changes[name] = joined(update.changes.get(name), change)
            return np.ones(len(rows), bool)
        records = rows["received"] >> 20
        numbers = distinct(records)
        if len(numbers) == 1:
            text = f"layer {name}: set aside {len(rows)} samples: {str(failure) or type(failure).__name__}"
            self.passes.report(rows, np.arange(1), "aside", lambda _: text)
            self.counts["set aside"] += len(rows)
            self.out_of_memory |= isinstance(failure, MemoryError)
            self.set_aside[int(numbers[0])] = text
            return np.zeros(len(rows), bool)
        appended = np.zeros(len(rows), bool)
        for number in numbers:
            of = records == number
            appended[of] = self._append(name, rows[of], tuple(column[of] for column in columns), update)
        return appended

    def _draw(
        self, rows: Rows, depth: Floats, kind: Integers, flags: Integers,
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
            self._count_refused(rows["source"][~good], flags[~good])
            rows, depth, kind = rows[good], depth[good], kind[good]
        if not len(rows):
            return
        kind = self.passes.decide(rows, kind)
        self.passes.add(rows["source"], rows["number"], kind, rows["time"], depth)
        self._compare(rows, depth)
        for name, count in zip(PASSES, np.bincount(kind, minlength=len(PASSES)).tolist(), strict=True):
            self.counts[f"pass {name}"] += count
        time = (rows["time"] - self.clock.began) / SECOND
        apart = ~self._takes[self.main].chosen(kind, rows["number"])
        if apart.any():
            self._leave_out_crowded(APART, rows, depth, apart)
            kept = np.empty(np.count_nonzero(apart), SAMPLE)
            for name, column in zip(SAMPLE.names or (), (depth, rows["toolface"], rows["radius"], time), strict=True):
                kept[name] = column[apart]
            self.apart[self.main].append(kept)
        drawn = np.zeros(len(rows), bool)
        gaps, outside = [], []
        for name in self._drawn_layers.values():
            chosen = self._takes[name].chosen(kind, rows["number"])
            if not chosen.any():
                continue
            self._leave_out_crowded(name, rows, depth, chosen)
            before = chosen & self._before_start(name, depth)
            if before.any():
                outside.append((name, np.flatnonzero(before)))
            columns = (depth[chosen], rows["toolface"][chosen], rows["radius"][chosen], time[chosen])
            drawn[chosen] |= self._append(name, rows[chosen], columns, update) & ~before[chosen]
            for source in sorted(set(rows["source"][chosen].tolist())):  # samples of one source are in order of arrival
                of = np.flatnonzero(chosen & (rows["source"] == source))
                gaps += self._depth_gaps((name, source), depth[of], of)
        self._report_outside(rows, depth, outside)
        before_start = distinct(np.concatenate([np.empty(0, np.int64), *(of for _, of in outside)]))
        before_start = before_start[~drawn[before_start]]
        self._count(rows["source"][before_start], OUTSIDE)
        self._count(np.delete(rows["source"], before_start), USABLE)
        if gaps:
            self.passes.report(rows, np.array([row for row, _ in gaps]), "depth_gap", lambda place: gaps[place][1])
        self.counts["drawn"] += int(np.count_nonzero(drawn))
        self.counts["kept apart"] += int(np.count_nonzero(~drawn))

    def _compare(self, rows: Rows, depth: Floats) -> None:
        """Let the watch compare the samples of each source, in order of arrival, with its wall."""
        for number in distinct(rows["source"]).tolist():
            if number in self.readers:
                of = rows["source"] == number
                columns = (rows["wall"][of], rows["time"][of], depth[of], rows["toolface"][of], rows["radius"][of])
                self.watch.compare(self.readers[number].source.name, columns)

    def _count(self, sources: Integers32, outcome: str) -> None:
        for number, count in enumerate(np.bincount(sources).tolist()):
            if count and number in self.readers:
                self.outcomes[self.readers[number].source.name, outcome] += count

    def _count_refused(self, sources: Integers32, flags: Integers) -> None:
        """Count refused samples by source and flag, without NOT_ROTATING, because a string often stands still."""
        for flag in NEVER_DRAWN & ~Flag.NOT_ROTATING:
            self._count(sources[(flags & int(flag)) != 0], str(flag.name))

    def _before_start(self, name: str, depth: Floats) -> Mask:
        """Return which samples lie before the first vertex of a layer by more than ``max_distance``."""
        settings = self.layers[name].settings
        start, reach = settings.start_depth, settings.max_distance
        if start is None or reach is None:
            return np.zeros(len(depth), bool)
        before: Mask = np.copysign(1.0, settings.pitch) * (start - depth) > reach
        return before

    def _report_outside(self, rows: Rows, depth: Floats, outside: list[tuple[str, Integers]]) -> None:
        """Report the samples before the start of a layer: by layer and then in order of arrival, the order of a replay.

        ``outside`` has the name of each such layer and the rows of its samples.
        """
        if not outside:
            return
        names = [name for name, of in outside for _ in of]
        places = np.concatenate([of for _, of in outside])
        rule = f"lies before the wall, which begins at start_depth = {self.configuration.wall['start_depth']:g} m"
        text = "layer {}: a sample at {:.1f} m {}: not drawn"
        self.passes.report(rows, places, "outside", lambda at: text.format(names[at], depth[places[at]], rule))

    def _leave_out_crowded(self, name: str, rows: Rows, depth: Floats, chosen: Mask) -> None:
        """Remove from ``chosen`` the samples that exceed the limit of a source, or of the host, near a vertex."""
        if not (most := self.configuration.samples.most):
            return
        crowded = []
        of_sources = self._apart_counts if name == APART else self._cell_counts[name]
        for source, counts in of_sources.items():
            of = np.flatnonzero(chosen & (rows["source"] == source))
            if len(of) and not (kept := counts.take(depth[of], rows["toolface"][of])).all():
                chosen[of[~kept]] = False
                crowded.append(of[~kept])
        if crowded:
            left_out = np.concatenate(crowded)
            self.counts["crowded"] += len(left_out)
            rule = f"this part of a vertex's cell already has its share of samples.most = {most} samples of this source"
            text = f"layer {name}: {rule}: not drawn"
            self.passes.report(rows, left_out, "crowded", lambda _: text)

    def _depth_gaps(self, of: tuple[str, int], depth: Floats, rows: Integers) -> list[tuple[int, str]]:
        """Return (row, text) of each sample more than `gap_reach` beyond all earlier ones; ``of``: (layer, source)."""
        limit = self.layers[of[0]].settings.gap_reach
        ahead = np.copysign(1.0, self.layers[of[0]].settings.pitch)  # -1 for a wall that grows upwards
        farthest = np.maximum.accumulate(np.concatenate([[self._deepest.get(of, -np.inf)], ahead * depth]))
        jumps = np.flatnonzero(np.isfinite(farthest[:-1]) & (np.diff(farthest) > limit))
        self._deepest[of] = float(farthest[-1])
        return [
            (int(rows[jump]), f"layer {of[0]}: no samples from {ahead * farthest[jump]:.3f} m to {depth[jump]:.3f} m")
            for jump in jumps.tolist()
        ]

    def _draw_image(
        self, index: int, rows: Rows, depth: Floats, flags: Integers,
        chosen: Mask, update: Update,
    ) -> None:  # fmt: skip
        name = self._image_list[index].name
        good = chosen & ((flags & NEVER_DRAWN) == 0)
        held = {int(row): self._held_rows.pop(int(row)) for row in rows["row"][chosen].tolist()}
        self.counts[f"image {name} rows not drawn"] += int(np.count_nonzero(chosen & ~good))
        if good.any():
            values = np.array([held[row] for row in rows["row"][good].tolist()])
            start, stop = self.images[name].append(depth[good], values)
            update.images[name] = (update.images.get(name, (start, 0))[0], stop)


def _shift(reading: Reading, shift: float) -> None:
    """Add a length to the depths of a reading, but for those of stations."""
    for name in ("bit_depth", "hole_depth"):
        if name in reading.rig:
            reading.rig[name] = reading.rig[name] + shift
    reading.samples["depth"] += shift
    for _, rows, _ in reading.images:
        rows["depth"] += shift


def _frames_of(reading: Reading, source: str) -> list[Frame]:
    """Return what the watch sees of a reading: each frame with a rig quantity, a sample or an image row."""
    frames: dict[int, Frame] = {}

    def at(place: int) -> Frame:
        if place not in frames:
            order, time, wall = (int(reading.frames[of][place]) for of in ("received", "time", "wall"))
            frames[place] = Frame(order, time, wall, source, {})
        return frames[place]

    def places(rows: Rows) -> Integers:
        return np.searchsorted(reading.frames["received"], rows["received"])

    for name, values in reading.rig.items():
        for place in np.flatnonzero(np.isfinite(values)).tolist():
            at(place).rig[name] = float(values[place])
    for name, values in reading.shown.items():
        for place in np.flatnonzero(np.isfinite(values)).tolist():
            at(place).shown[name] = float(values[place])
    samples = reading.samples
    usable = np.isfinite(samples["toolface"]) & np.isfinite(samples["radius"])
    samples = samples[usable & ((samples["flags"] & int(UNUSABLE)) == 0)]
    of = places(samples)
    starts = np.flatnonzero(np.diff(of, prepend=-1)).tolist()
    for start, stop in itertools.pairwise([*starts, len(of)]):
        one, rows = at(int(of[start])), samples[start:stop]
        one.sensor, one.depth, one.toolface, one.radius = (
            rows[name] for name in ("row", "depth", "toolface", "radius")
        )
    for image, rows, _ in reading.images:
        for place in places(rows).tolist():
            at(place).images += (image.name,)
    return list(frames.values())


def _depth_items(source: Source | None) -> object:
    """Return the items that state the depths of a source's samples; none if the depths follow from the bit depth."""
    return source.caliper.depth if source and source.caliper else []


def _checksum(wall: WallState) -> int:
    """Return a checksum of the values of all vertices."""
    checksum = 0
    for values in (wall.radius, wall.nearest, wall.support, wall.iterations):
        checksum = _core.crc32c(values.data, checksum)
    return checksum

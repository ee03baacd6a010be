"""``hb.Live``: a wall that grows from received bytes; every byte is stored in a journal first.

    live = hb.Live("rig.toml", journal="well-7.journal")      # reads the records of the journal, then continues it
    update = live.receive("mwd", chunk)                       # stored, read, drawn
    update.changes["main"].ranges                             # the vertices that are new or changed
    live.wall.radius, live.path, live.image("GR")

`Live` is for software with its own transport: it has no thread and no callback. ``helibore live`` adds sockets and a
status page. The logger ``helibore.live`` logs every event, but counts fast repetitions in one line.

`Live` shares the C++ classes `Wall` and `Stations` with `helibore::Live`, so both give equal numbers
(``test_a_host_in_cpp_has_the_bits_of_python``). It does not bind `helibore::Live` itself, because `helibore::Live` has
only one wall instead of one for each layer, stores nothing, and copies image rows while it holds its lock. In a trial
with 400,000 rows of 36 sectors, an append had to wait up to 500 ms for an export in `helibore::Live`, and up to 0.2 ms
in this class, because a reader of `ImageRows` copies without holding a lock.
"""

from __future__ import annotations

import json
import logging
import os
import secrets
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import astuple, replace
from pathlib import Path as FilePath
from typing import Any, NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from helibore import _core
from helibore.base.arrays import Floats, Rows, column, numbers
from helibore.base.errors import InputError
from helibore.images.sector_image import SectorImage
from helibore.live.journal import checkpoint as checkpoints
from helibore.live.journal import journal as journals
from helibore.live.journal.journal import Journal, JournalFullError, Segment, segment_of, segments
from helibore.live.journal.session_header import (
    changed_to,
    configuration_of,
    continued_with,
    numbers_of,
    recorded_configuration,
)
from helibore.live.model.events import LOGGER, Event, gather
from helibore.live.model.image_rows import ImageRows
from helibore.live.model.model import Model
from helibore.live.model.packed_state import pack, unpack
from helibore.live.model.pass_log import Pass
from helibore.live.model.update import Update, merge
from helibore.live.rules.configuration import Configuration, load
from helibore.live.rules.file_names import RULE, can_be_file
from helibore.live.rules.layout import given_layout
from helibore.trajectory.survey import Path, Survey
from helibore.wall.wall import Wall

RECORD = np.dtype(
    [("sequence", "u8"), ("wall", "i8"), ("monotonic", "i8"), ("offset", "i8"), ("length", "u4"), ("connection", "u4"),
     ("source", "u2"), ("kind", "u2"), ("unused", "u4")]
)  # fmt: skip
Read = TypeVar("Read")
WINDOW_BYTES = 1 << 20
OF_RECOVERY = "journal", "checkpoint"
WINDOW_RECORDS = 8192
VALUES_AT_ONCE = 10_000
"""The most pushed values in a record."""
LOG_AGAIN = 60.0
"""Seconds until the log writes another line about the same rule and source."""
LOGGED_EACH = "alarm_", "address"
"""Beginnings of rule names. The log writes these rules, and events without a source, again after one second."""


class Stored(NamedTuple):
    """A record that is stored in the journal and not read yet."""

    record: Rows
    payloads: list[bytes]

    @property
    def monotonic(self) -> int:
        """Monotonic receive time, ns."""
        return int(self.record["monotonic"][0])


class Live:
    """The walls, images and path of a well while it is drilled.

    Parameters
    ----------
    configuration
        A Configuration, or the TOML file that holds it.
    journal
        Folder of the journal; its records are read first. With None, nothing is stored (for tests).
    clock
        Function that returns the time of the wall clock (since 1970) and of the monotonic clock, both in ns.

    Raises
    ------
    ValueError
        If the configuration breaks a rule, if another process writes the journal, or if the configuration lacks a
        source of the journal or changes what a journal cannot change: settings of the walls other than
        ``bit_diameter``, layers, path, and name, unit, sectors and layout of images.
    """

    def __init__(
        self,
        configuration: Configuration | str | os.PathLike[str],
        journal: str | os.PathLike[str] | None = None,
        *,
        clock: Callable[[], tuple[int, int]] = lambda: (time.time_ns(), time.monotonic_ns()),
    ) -> None:
        given = configuration if isinstance(configuration, Configuration) else load(configuration)
        if journal is not None and journals.paths(FilePath(journal)):
            begun, given = continued_with(FilePath(journal), given)
        else:
            begun = given = given.resolved()
        self.configuration = given
        self.model, self._begun = Model(begun), begun
        self._lock = threading.Lock()
        self.clock = clock
        self._sequence = 0
        self._began, self._last_bytes = clock()[1], dict[str, int]()
        self._silence_reported: dict[str, int] = {}  # by source: when the last bytes before the silence came
        self._pending_update = Update()
        self._logged: dict[tuple[str, str], tuple[float, int]] = {}  # time of the last line, and events since then
        self._checkpointing, self._checkpointed_segment = threading.Lock(), 1
        self._half_read = False  # whether reading a record failed, so that the model may hold only a part of it
        self.journal: Journal | None = None
        self._session = secrets.token_hex(8)
        opening = self._opening(given)
        if journal is None:
            self._store(0, 0, opening, journals.OPENED)
            self.model.events.log = self._log
            return
        self.journal = Journal(
            journal,
            opening,
            segment_bytes=self.configuration.journal.segment_mb << 20,
            sync_interval=self.configuration.journal.sync_interval,
            clock=clock,
        )
        try:
            for note in self.journal.recovery.notes:  # read_into reports the damage
                self.report("journal", note)
            self._restore()
            for update in read_into(self.model, FilePath(journal)):  # earlier sessions reported the other events
                gather(self._pending_update.events, (event for event in update.events if event.rule in OF_RECOVERY))
        except BaseException:
            self.journal.close()  # so that the next try can lock it
            raise
        self.model.events.log = self._log
        self._fit(Update())  # what was due when the process before ended

    def _opening(self, configuration: Configuration) -> bytes:
        """Return the session header for ``configuration``, the payload of an OPENED record."""
        header = {"session": self._session, "meaning": configuration.meaning(), "configuration": configuration.text}
        return json.dumps(header).encode()

    def reconfigure(self, configuration: Configuration) -> Update:
        """Read all later bytes with another configuration; journal and walls stay, and no restart is needed.

        The bit diameter, items, units, offsets, ranges and rules may change; only a restart can add or remove a source.

        Raises
        ------
        InputError
            If ``configuration`` changes what a journal cannot change, or has other sources.
        JournalFullError
            If the change could not be stored; then nothing has changed.
        """
        return self.draw([self.store_change(configuration)])

    def store_change(self, configuration: Configuration) -> Stored:
        """Store the change to ``configuration`` as `reconfigure` does; the caller must pass the result to `draw`."""
        now = changed_to(configuration, self.configuration, self.journal.folder if self.journal else None)
        stamped = self._stamp(0, 0, self._opening(now), journals.OPENED)
        self.configuration = now
        self._logged = {}  # the log shows at once which rules are still broken
        return Stored(*stamped)

    def _restore(self) -> None:
        """Restore the newest usable checkpoint; report each newer checkpoint that is not usable."""
        assert self.journal is not None
        for left in self.journal.folder.glob(".checkpoint-*.part"):  # left by a process that was killed
            left.unlink()
        for found in checkpoints.usable(
            self.journal.folder, self.journal.salt, self.journal.recovery.last_sequence + 1
        ):
            error = found if isinstance(found, InputError) else self._restored(*found)
            if error is None:
                return
            self.report("checkpoint", f"{error}: not used")

    def _restored(self, path: FilePath, facts: dict[str, Any], arrays: checkpoints.Arrays) -> InputError | None:
        """Set the model to a checkpoint's state and return None; if this fails, keep the model and return the error."""
        begun = self._begun
        try:
            if facts["meaning"] != begun.meaning():  # the segment with the first configuration is removed or damaged
                if not facts.get("configuration"):
                    raise InputError(str(path), "was written with another configuration")
                begun = configuration_of(facts)
            model = Model(begun)
            for stretch in facts["stretches"]:
                model.reconfigure(configuration_of(stretch), stretch["utc"], int(stretch["record"]))
            unpack(model, facts["state"], arrays)
        except (ValueError, KeyError, TypeError, AttributeError, IndexError) as error:
            return InputError(str(path), f"cannot be restored: {error}")
        self._begun = begun
        self._set_model(model)
        return None

    def _set_model(self, model: Model) -> None:
        for event in self.model.events.take():  # events that the host has reported so far
            model.events.report(event, recorded=False)
        self.model = model

    def checkpoint(self) -> FilePath | None:
        """Write the state of the model, so that a restart reads only the records after it.

        Returns
        -------
        Path or None
            The file in the journal's folder. None if there is no journal, or if the model lacks a record because
            reading the record failed or the memory was full.

        Raises
        ------
        OSError
            If the disk refuses the file; the earlier checkpoints are then unchanged.
        """
        if self.journal is None:
            return None
        with self._checkpointing:
            with self._lock:
                segment, sequence = self.journal.segment, self.model.next_sequence
                if self._half_read or self.model.out_of_memory:
                    return None
                state = pack(self.model)
                facts: dict[str, Any] = {"meaning": self._begun.meaning(), "configuration": self._begun.text,
                                         "stretches": list(self.model.stretches)}  # fmt: skip
            self.journal.sync()  # a checkpoint must not contain records that a power cut can destroy
            facts = {"helibore": _core.__version__, "salt": self.journal.salt, **facts}
            path = checkpoints.write(self.journal.folder, sequence, facts, state)
            self._checkpointed_segment = segment
            return path

    @property
    def checkpoint_due(self) -> bool:
        """Whether a segment was completed after the last checkpoint of this run, and a checkpoint can be written.

        As `checkpoint` says, a checkpoint cannot be written without a journal, or if the model lacks a record.
        """
        due = self.journal is not None and self.journal.segment > self._checkpointed_segment
        return due and not self._half_read and not self.model.out_of_memory

    @classmethod
    def replay(
        cls,
        folder: str | os.PathLike[str],
        configuration: Configuration | None = None,
        report: Callable[[Segment], None] = lambda _: None,
        since: int = 0,
    ) -> Live:
        """Return the `Live` that the whole journal in ``folder`` gives; the journal is only read.

        Without ``configuration``, the journal's own configurations apply, and the wall equals the live wall in every
        bit. If ``configuration`` is given, it applies to all records from number ``since`` on: to all of them, or for
        example from the record on at which another hole began. The fits of ``estimator = "automatic"`` that the journal
        has are then not used: the last one that is due is made at the end. ``report`` is called with each segment after
        its records are read.

        Raises
        ------
        InputError
            If ``configuration`` changes at record ``since`` what a journal cannot change.
        """
        whole = configuration.resolved() if configuration and since == 0 else None
        begun = whole or recorded_configuration(FilePath(folder))
        numbers = numbers_of(FilePath(folder), whole) if whole else None
        live = cls(begun)
        live.model = Model(begun, follows=whole is None, numbers=numbers)
        change = (since, configuration) if configuration and since else None
        for _ in read_into(live.model, FilePath(folder), report, change):
            pass
        live.configuration = live.model.configuration
        while configuration and (fit := live.fit()) is not None:
            live.model.use_fit(fit, live.model.wall_time, Update())
        return live

    @property
    def wall(self) -> Wall:
        """The wall of layer ``main`` in the hole that is drilled now."""
        return self.model.layers[self.model.main]

    @property
    def layers(self) -> dict[str, Wall]:
        """The wall of each layer of the configuration; a hole that `[hole]` began has its own."""
        return self.model.layers

    @property
    def images(self) -> dict[str, ImageRows]:
        """The rows of each sector image."""
        return self.model.images

    def image(self, name: str, reach: float | None = None) -> SectorImage:
        """Return a sector image: all rows that have come, placed around the hole.

        Parameters
        ----------
        name
            Name of the image: the X of ``[source.NAME.image.X]``, or the name of an image that `append_image` got with
            its origin.
        reach
            As in `SectorImage`; it must be given while the image has only one row.

        Raises
        ------
        ValueError
            If the layout of the image is not known, if no row has come yet, or if `SectorImage` refuses the rows.
        """
        if name not in self.model.layouts:
            rule = "no source sends it, and no rows of it came with an origin: the layout of its sectors is not known"
            raise ValueError(f"image '{name}': {rule}")
        rows = self.images[name]
        return self.model.layouts[name].image(name, rows.unit, rows.arrays(), reach)

    @property
    def passes(self) -> list[Pass]:
        """All passes up to now, sorted by start time, with the source, times, depths and sample count of each pass.

        The times are UTC by the last clock of their session, so that a clock that is set right corrects them.
        """
        shown = self.model.clock.utc
        return [replace(run, start=shown(run.start), stop=shown(run.stop)) for run in self.model.passes.runs]

    @property
    def survey(self) -> Survey | None:
        """The survey of all stations that have come; None while there are fewer than two stations."""
        return self.model.stations.survey

    @property
    def path(self) -> Path | None:
        """The path through the survey; None while there is no survey."""
        return self.model.stations.path

    def receive(self, source: str, payload: bytes | bytearray | memoryview, connection: int = 1) -> Update:
        """Store and read ``payload``, the bytes that came from ``source`` by one of its connections.

        ``connection`` is the number of the connection, which the caller chooses; another number begins a new stream.

        Returns
        -------
        Update
            The changes of all layers, of the images and of the path.

        Raises
        ------
        ValueError
            If the source is not in the configuration, or ``connection`` is not a whole number from 0 to 2^32 - 1.
        JournalFullError
            If the bytes could not be stored. They were not read, so the caller may pass them again.
        """
        number = self._number(source)
        if not isinstance(payload, bytes):  # the length of another buffer may differ from its number of bytes
            payload = bytes(memoryview(payload))
        update = Update()
        for start in range(0, len(payload), journals.LONGEST_PAYLOAD):
            part = payload[start : start + journals.LONGEST_PAYLOAD]
            merge(update, self._store(number, connection, part, journals.BYTES))
        return update

    def connected(self, source: str, connection: int, peer: str) -> Update:
        """Store that a ``connection`` of ``source`` to ``peer`` began, and report it as the event ``connected``."""
        return self._store(self._number(source), connection, peer.encode(), journals.CONNECTED)

    def closed(self, source: str, connection: int) -> Update:
        """Store that a ``connection`` of ``source`` ended; a frame that is still incomplete is dropped."""
        return self._store(self._number(source), connection, b"", journals.CLOSED)

    def append_samples(
        self, depth: npt.ArrayLike, toolface: npt.ArrayLike, radius: npt.ArrayLike, time: npt.ArrayLike | None = None
    ) -> Update:
        """Store and draw samples whose depth the host knows; before the first bit depth, their pass is ``unknown``.

        ``depth`` (m), ``toolface`` (deg), ``radius`` (m) and ``time`` (s; None: no times) are (n,) as in `Caliper`.
        A sample that is out of range (a radius above 2 m, a depth outside ``depth_range``) is stored and not drawn,
        and an event reports it.

        Raises
        ------
        ValueError
            If the arrays differ in size, a value is not finite, or a radius is not above 0; then nothing is stored.
        """
        depths = column("depth", depth)
        columns = {
            "depth": depths,
            "toolface": column("toolface", toolface, depths.size, "depth"),
            "radius": column("radius", radius, depths.size, "depth"),
        }
        if time is not None:
            columns["time"] = column("time", time, depths.size, "depth")
        for name, values in columns.items():
            _require_finite(name, values)
        for index in np.flatnonzero(columns["radius"] <= 0)[:1].tolist():
            raise ValueError(f"radius[{index}] = {columns['radius'][index]:g}: must be above 0")
        update = Update()
        step = journals.LONGEST_PAYLOAD // 32
        for start in range(0, depths.size, step):
            part = [values[start : start + step] for values in columns.values()]
            table = np.vstack([*part, *([] if time is not None else [np.full(len(part[0]), np.nan)])])
            merge(update, self._store(0, 0, table.tobytes(), journals.SAMPLES))
        return update

    def append_values(self, source: str, values: Mapping[str, npt.ArrayLike]) -> Update:
        """Store and read values of a source whose address is ``values``: bit depth, hole depth, rotation and others.

        Parameters
        ----------
        source
            Name of the source.
        values
            By name, as the settings of the source have it: one value, or (n,) values in order of time, in the units of
            the source; NaN where one is missing. They count from the time of this call.

        Raises
        ------
        ValueError
            If the source does not take values, the arrays differ in size, or a value is infinite; then nothing is
            stored.
        JournalFullError
            If the values could not be stored.

        Examples
        --------
        >>> live.append_values("rig", {"bit": 2010.4, "hole": 2010.4, "rpm": 120})  # doctest: +SKIP
        """
        number = self._number(source)
        if self.configuration.source[source]["address"] != "values":
            raise ValueError(f"source '{source}': append_values needs address = \"values\"")
        columns: dict[str, Floats] = {}
        for name, given in values.items():
            first = next(iter(columns), name)
            size = columns[first].size if columns else None
            columns[name] = column(name, np.atleast_1d(numbers(given)), size, first)
            if np.isinf(columns[name]).any():
                raise ValueError(f"{name}: must be finite, or NaN where a value is missing")
        table = [[None if value != value else value for value in of.tolist()] for of in columns.values()]
        rows = [dict(zip(columns, row, strict=True)) for row in zip(*table, strict=True)]
        update, step = Update(), max(VALUES_AT_ONCE // max(len(columns), 1), 1)
        for start in range(0, len(rows), step):
            line = json.dumps(rows[start : start + step]).encode() + b"\n"
            merge(update, self._store(number, 1, line, journals.BYTES))
        return update

    def append_stations(self, depth: npt.ArrayLike, inclination: npt.ArrayLike, azimuth: npt.ArrayLike) -> Update:
        """Store survey stations and add them to the survey; a wrong station is left out, and an event reports it.

        ``depth`` (m), ``inclination`` and ``azimuth`` (deg) are (n,) as in `Survey`.
        """
        depths = column("depth", depth)
        table = [depths, column("inclination", inclination, depths.size, "depth"),
                 column("azimuth", azimuth, depths.size, "depth")]  # fmt: skip
        update = Update()
        step = journals.LONGEST_PAYLOAD // (8 * len(table))
        for start in range(0, max(depths.size, 1), step):
            payload = b"".join(values[start : start + step].tobytes() for values in table)
            merge(update, self._store(0, 0, payload, journals.STATIONS))
        return update

    def append_image(
        self, name: str, depth: npt.ArrayLike, values: npt.ArrayLike, unit: str = "", *,
        origin: str | None = None, reference: str | None = None, direction: str = "clockwise",
        toolface_offset: float = 0.0,
    ) -> Update:  # fmt: skip
        """Store rows of a sector image and add them to the image.

        Parameters
        ----------
        name, unit
            Name and unit of the image.
        depth, values
            Depths (r,) in metres, and values (r, sectors), NaN where a value is missing. A row whose depth is outside
            ``depth_range`` is stored and left out of the image, and an event reports it.
        origin, reference, direction, toolface_offset
            The layout of the sectors, as for the images of a source. Give both origin and reference, or neither. The
            layout applies to all rows of the image, and :meth:`image` returns them as a `SectorImage`.

        Raises
        ------
        ValueError
            If the number of sectors, the unit or the layout differs from that of the earlier rows, if the layout is
            wrong, if there is no sector, if a value is infinite, if a depth is not finite, if a source sends an image
            of this name, or if the name is not allowed in a file name. Then nothing is stored.
        """
        depths = column("depth", depth)
        rows = self._image_rows(name, depths.size, values, unit)
        layout = given_layout(origin, reference, direction, toolface_offset, self.configuration.path.reference)
        if layout and self.model.layouts.get(name, layout) != layout:
            raise ValueError(f"image '{name}': has another layout: {self.model.layouts[name]}")
        _require_finite("depth", depths)
        head = json.dumps([name, rows.shape[1], unit, *(astuple(layout) if layout else ())]).encode() + b"\n"
        table = np.column_stack([depths, rows])
        update = Update()
        step = max((journals.LONGEST_PAYLOAD - len(head)) // (8 * table.shape[1]), 1)
        for start in range(0, max(len(table), 1), step):
            merge(update, self._store(0, 0, head + table[start : start + step].tobytes(), journals.IMAGE))
        return update

    def _image_rows(self, name: str, rows: int, values: npt.ArrayLike, unit: str) -> Floats:
        """Return ``values`` as an array; refuse values that are not rows of this image, with its sectors and unit."""
        if any(image.name == name for source in self.configuration.sources.values() for image in source.images):
            raise ValueError(f"image '{name}': a source sends it already")
        if not can_be_file(name):
            raise ValueError(f"name = {name[:60]!r}: {RULE}")
        try:
            values = numbers(values)
        except (ValueError, TypeError) as error:
            raise ValueError(f"values: must be numbers: {error}") from None
        if np.ndim(values) != 2 or len(values) != rows or values.shape[1] < 1:
            raise ValueError(f"values has shape {np.shape(values)}: must be ({rows}, sectors), 1 sector or more")
        if name in self.images and self.images[name].sectors != values.shape[1]:
            raise ValueError(f"values has {values.shape[1]} sectors: image '{name}' has {self.images[name].sectors}")
        if name in self.images and unit not in ("", self.images[name].unit):
            raise ValueError(f"unit = '{unit}': image '{name}' has the unit '{self.images[name].unit}'")
        for row, sector in np.argwhere(np.isinf(values))[:1].tolist():
            raise ValueError(f"values[{row}, {sector}] = {values[row, sector]}: must be finite, or NaN where missing")
        return values

    def _number(self, source: str) -> int:
        if source not in self.model.numbers:
            raise ValueError(f"source '{source}': is not in the configuration")
        return self.model.numbers[source]

    def _store(self, source: int, connection: int, payload: bytes, kind: int) -> Update:
        """Store a record in the journal, pass it to the model, and return what changed."""
        with self._lock:
            update = self._take(*self._stamp(source, connection, payload, kind))
            self._fit(update)
            return update

    def _fit(self, update: Update) -> None:
        """Make the fits that are due, draw their walls again, and join the changes into ``update``."""
        with suppress(JournalFullError):  # the next record tries again
            while (fit := self.fit()) is not None:
                merge(update, self._take(*self._stamp(0, 0, fit, journals.FITTED)))

    def fit(self) -> bytes | None:
        """Make a fit that is due and return what `store_fit` stores; None if none is due. It takes a second or two."""
        for name, fits in list(self.model.fits.items()):
            if due := fits.due:
                return fits.fit(name, due, self.model.layers[name].basis)
        return None

    def store_fit(self, fit: bytes) -> Stored:
        """Store what `fit` returned; the caller must pass the result to `draw`, in the order of `store`."""
        return Stored(*self._stamp(0, 0, fit, journals.FITTED))

    def _take(self, records: Rows, payloads: list[bytes]) -> Update:
        try:
            update = self.model.take(records, payloads)
        except BaseException:
            self._half_read = True
            raise
        merge(self._pending_update, update)
        return update

    def _log(self, event: Event) -> None:
        """Log an event. If the log got a line of the same source and rule within the last minute, only count the event.

        The next line states the count. For an event without a source, or with a rule of LOGGED_EACH, the limit is one
        second instead of a minute.
        """
        key, now = (event.source, event.rule), time.monotonic()
        last, count = self._logged.get(key, (-LOG_AGAIN, 0))
        once = not event.source or event.rule.startswith(LOGGED_EACH)
        if now - last < (1.0 if once else LOG_AGAIN):
            self._logged[key] = last, count + event.count
            return
        self._logged[key] = now, 0
        since = f" (and {count:,} since the last line)" if count else ""
        LOGGER.log(logging.INFO if event.rule in ("connected", "estimator") else logging.WARNING, "%s%s", event, since)

    def at_one_moment(self, read: Callable[[], Read]) -> Read:
        """Call ``read`` while nothing is drawn and return its result; ``read`` must be quick: it should only copy."""
        with self._lock:
            return read()

    def poll(self) -> Update:
        """Return all changes since the last poll in one update; the first update has the events of the recovery.

        Use it in a host that draws at its own pace: one thread pushes records, and another thread polls.
        """
        self.check_silence()
        with self._lock:
            pending, self._pending_update = self._pending_update, Update()
            gather(pending.events, self.model.events.take())  # events that no record caused
            return pending

    def ages(self) -> dict[str, float]:
        """Return the seconds since the last bytes of each source; since the start if no bytes of the source came."""
        now = self.clock()[1]
        return {name: (now - self._last_bytes.get(name, self._began)) / 1e9 for name in self.model.numbers}

    def check_silence(self) -> None:
        """Report each source that has sent nothing for more than its ``silence`` seconds, once until it sends again."""
        ages = self.ages()
        for name, source in self.configuration.sources.items():
            last = self._last_bytes.get(name, self._began)
            if ages[name] > source.silence and self._silence_reported.get(name) != last:
                self._silence_reported[name] = last
                self.report("silent", f"nothing has come for {source.silence:g} s", name)

    def report(self, rule: str, text: str, source: str = "") -> None:
        """Report an event of the host or of a source's link by its rule and its text; events of one rule are joined.

        The event is not in the journal, because no record caused it.
        """
        self.model.report(self.clock()[0], rule, text, source)

    def store(self, source: str, connection: int, payload: bytes, kind: int) -> Stored:
        """Store a record in the journal only; the caller must pass all results to :meth:`draw` in this order.

        ``source`` and ``connection`` say where ``payload`` came from; ``kind`` is a number of ``journal.py``.

        Raises
        ------
        JournalFullError
            If the bytes could not be stored.
        """
        return Stored(*self._stamp(self._number(source), connection, payload, kind))

    def draw(self, stored: Sequence[Stored]) -> Update:
        """Read all ``stored`` records, draw them, and return what changed; `fit` makes the fits that are due then."""
        with self._lock:
            records = np.concatenate([np.empty(0, RECORD), *(one.record for one in stored)])
            return self._take(records, [payload for one in stored for payload in one.payloads])

    def _stamp(self, source: int, connection: int, payload: bytes, kind: int) -> tuple[Rows, list[bytes]]:
        if not (isinstance(connection, (int, np.integer)) and 0 <= connection < 1 << 32):
            raise ValueError(f"connection = {connection!r}: must be a whole number from 0 to {(1 << 32) - 1}")
        if self.journal is not None and kind == journals.OPENED:
            sequence, wall, monotonic = self.journal.reopen(payload)
        elif self.journal is not None:
            sequence, wall, monotonic = self.journal.append(source, connection, payload, kind)
        else:
            (wall, monotonic), sequence = self.clock(), self._sequence
            self._sequence += 1
        if kind == journals.BYTES:
            self._last_bytes[next(name for name, number in self.model.numbers.items() if number == source)] = monotonic
        record = np.array([(sequence, wall, monotonic, 0, len(payload), connection, source, kind, 0)], dtype=RECORD)
        return record, [payload]

    def sync(self) -> None:
        """Sync the journal to the disk."""
        if self.journal is not None:
            self.journal.sync()

    def close(self) -> None:
        """Write a checkpoint if one is due, then sync and close the journal."""
        if self.journal is not None:
            try:
                if self.checkpoint_due:
                    self.checkpoint()
            finally:
                self.journal.close()

    def __enter__(self) -> Live:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _require_finite(name: str, values: Floats) -> None:
    for index in np.flatnonzero(~np.isfinite(values))[:1].tolist():
        raise ValueError(f"{name}[{index}] = {values[index]}: must be finite")


def read_into(
    model: Model, folder: FilePath, report: Callable[[Segment], None] = lambda _: None,
    change: tuple[int, Configuration] | None = None,
) -> Iterator[Update]:  # fmt: skip
    """Pass a journal's records to ``model``, from its ``next_sequence`` on, and yield an update for each of `windows`.

    Events report damage and missing segments; ``report`` is called with each segment after its records are read.
    ``change`` is a configuration and the number of the first record that is read with it.
    """
    expected = segment_of(folder, model.next_sequence)
    for segment in segments(folder, expected):
        if segment.number > expected:
            last = segment.number - 1
            text = f"segments {expected} to {last} are missing" if expected < last else f"segment {last} is missing"
            model.report(segment.wall_before(0), "journal", text, recorded=True)
        expected = segment.number + 1
        first = int(np.searchsorted(segment.records["sequence"], model.next_sequence))
        known = int(segment.records["offset"][first - 1]) if first else 0
        for (start, _), text in zip(segment.damage, segment.damage_texts(), strict=True):
            if start >= known:
                model.report(segment.wall_before(start), "journal", text, recorded=True)
        cut = int(np.searchsorted(segment.records["sequence"], change[0])) - first if change else 0
        for start, stop in windows(segment.records[first:], cut):
            if change and start >= cut:
                model.change_from(segment.records[first + start], changed_to(change[1], model.configuration, folder))
                change = None
            payloads = [segment.payload(first + row) for row in range(start, stop)]
            yield model.take(segment.records[first + start : first + stop], payloads)
        report(segment)


def windows(records: Rows, cut: int = 0) -> Iterator[tuple[int, int]]:
    """Yield row ranges of at most WINDOW_RECORDS records and WINDOW_BYTES bytes, or of one record with more bytes.

    A range begins at row ``cut``, if there is one.
    """
    ends = np.cumsum(records["length"].astype(np.int64))
    start = 0
    while start < len(records):
        before = int(ends[start - 1]) if start else 0
        stop = int(np.searchsorted(ends, before + WINDOW_BYTES, side="right"))
        stop = max(start + 1, min(stop, start + WINDOW_RECORDS, cut if cut > start else len(records)))
        yield start, stop
        start = stop

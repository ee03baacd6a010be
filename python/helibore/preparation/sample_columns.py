"""Samples on their way from readings to a wall: columns of one length, with where each came from.

    Readings (rows x sensors, one or more files)  --observed-->  depth, toolface, radius, time | file, row, sensor

Columns that only some steps need (arm, turn, pass ...) are made when first asked. Not public: ``preparation`` is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats, Integers
from helibore.preparation.sensors import Observed, Sensor, TimeSeries, observe_by_depth, observe_by_time

if TYPE_CHECKING:
    from helibore.preparation.prepare import Preparation
    from helibore.preparation.readings import Readings
    from helibore.trajectory.survey import Path

Mask = npt.NDArray[np.bool_]
Number = TypeVar("Number", bound=np.generic)
Told = list[tuple[str, str]]

LARGEST_RADIUS = 2.0
"""Metres: the largest radius a Caliper holds."""

IMAGE_ROW = 8
"""From so many sensors on, one row sees the hole all around: it is a turn."""

FAST_TURN = 90.0
"""Degrees between two readings of a toolface, in half of them, from which what lies between is doubtful."""

FASTEST = 20.0
"""Metres a second: no tool goes faster."""

WORDS = {"no depth": "depth", "no toolface": "toolface", "no radius": "radius", "no time": "time"}


@dataclass(frozen=True)
class Track:
    """Where the tool was at any time: depth and, where the file has one, toolface, from a file of their own."""

    depth: TimeSeries
    toolface: TimeSeries | None = None


@dataclass
class Samples:
    """Columns of one length n.

    Attributes
    ----------
    depth, toolface, radius, time
        As in a Caliper; (n,).
    file, row, sensor
        Where each came from, (n,) int64: which readings, which row of them, which of their sensors.
    readings
        What they came from.
    pass_number
        (n,) int64, once numbered.
    """

    depth: Floats
    toolface: Floats
    radius: Floats
    time: Floats | None
    file: Integers
    row: Integers
    sensor: Integers
    readings: list[Readings]
    pass_number: Integers

    @classmethod
    def observed(
        cls, readings: list[Readings], settings: Preparation, track: Track | None, told: Told, counts: dict[str, int]
    ) -> Samples:
        """Bring the sensors of all readings into one frame; tell and count what has no depth, toolface or radius."""
        seen = [_observe(one, settings, track, told) for one in readings]
        for one, found in zip(readings, seen, strict=True):
            for reason, word in WORDS.items():
                if found.counts.get(reason):
                    counts[reason] = counts.get(reason, 0) + found.counts[reason]
                    told.append(("dropped", f"{found.counts[reason]:,} samples of {one.name} without a {word}"))
            if not found.depth.size:
                lacking = [f"{count} values missing in {name}" for name, count in one.missing.items()]
                lacking += [f"{count} dropped as {step}" for step, count in counts.items() if step not in WORDS]
                reason = ", ".join(lacking) or "no values"
                raise ValueError(f"{one.name}: no row has depth, toolface and a radius ({reason})")
        timed = [found.time is not None for found in seen]
        if any(timed) and not all(timed):
            told.append(("time", "left out: not every file has one"))
        times = [found.time for found in seen] if all(timed) else []
        size = sum(found.depth.size for found in seen)
        file = (
            np.broadcast_to(np.int64(0), size) if len(seen) == 1
            else np.repeat(np.arange(len(seen)), [found.depth.size for found in seen])
        )  # fmt: skip
        return cls(
            depth=_joined([found.depth for found in seen]),
            toolface=_joined([found.toolface for found in seen]),
            radius=_joined([found.radius for found in seen]),
            time=_joined([time for time in times if time is not None]) if times else None,
            file=file,
            row=_joined([found.row for found in seen]),
            sensor=_joined([found.sensor for found in seen]),
            readings=readings,
            pass_number=np.empty(0, dtype=np.int64),
        )

    def select(self, kept: Mask) -> Samples:
        """The samples where ``kept`` is True."""
        columns = {name: getattr(self, name)[kept] for name in ("depth", "toolface", "radius", "file", "row", "sensor")}
        numbers = self.pass_number[kept] if self.pass_number.size else self.pass_number
        return replace(self, **columns, time=None if self.time is None else self.time[kept], pass_number=numbers)

    def _of_row(self, columns: Sequence[npt.NDArray[np.generic]]) -> npt.NDArray[np.generic]:
        """A column of each file, read at every sample's row."""
        if len(columns) == 1:
            return columns[0][self.row]
        starts = np.cumsum([0, *(column.size for column in columns[:-1])])
        return np.concatenate(columns)[starts[self.file] + self.row]

    def _of_sensor(self, columns: Sequence[npt.NDArray[np.generic]]) -> npt.NDArray[np.generic]:
        starts = np.cumsum([0, *(column.size for column in columns[:-1])])
        return np.concatenate(columns)[starts[self.file] + self.sensor]

    @property
    def arm(self) -> Integers:
        """Which wall channel each is read from, one number for channels of one name in all files."""
        names = sorted({name for one in self.readings for name in one.channels})
        return self._of_sensor(
            [np.array([names.index(one.channels[arm]) for arm in one.arm], dtype=np.int64) for one in self.readings]
        ).astype(np.int64)

    @property
    def across(self) -> Mask:
        """Whether each is half a diameter."""
        return self._of_sensor([np.array(one.across) for one in self.readings]).astype(bool)

    @property
    def bearing(self) -> Floats:
        """The toolface of the tool itself in each one's row."""
        return self._of_row([one.toolface for one in self.readings]).astype(np.float64)

    def turns(self, height: float | None, told: Told) -> Integers:
        """Number the turns: samples of one number were taken around the hole from one place."""
        turn = np.empty(self.depth.size, dtype=np.int64)
        first, words = 0, set()
        for number, one in enumerate(self.readings):
            mine = np.flatnonzero(self.file == number)
            turn[mine], word = self._turns_of(one, mine, height)
            if mine.size:
                turn[mine] += first - turn[mine].min()
                first = int(turn[mine].max()) + 1
            words.add(word)
        count = np.unique(turn, return_counts=True)[1]
        line = ("turns", f"{count.size:,}, by {' and '.join(sorted(words))}; samples in one: {np.median(count):g}")
        if line not in told:
            told.append(line)
        return turn

    def _turns_of(self, one: Readings, mine: Integers, height: float | None) -> tuple[Integers, str]:
        from helibore.preparation.eccentering import turn_numbers
        from helibore.preparation.passes import number_passes

        if height is not None:
            rows = self.depth[mine]
            passes = self.pass_number[mine] if self.pass_number.size else number_passes(rows)
            cells = np.floor((rows - rows.min(initial=0.0)) / height).astype(np.int64)
            return cells + passes * (int(cells.max(initial=0)) + 1), f"depth, {height:g} m each"
        if len(one.sensors) >= IMAGE_ROW:
            return self.row[mine], "rows of an image"
        if not one.turning and self.toolface.size:
            raise ValueError(f"{one.name}: no toolface to tell the turns of the tool by: give the height of a turn")
        rows = np.unique(self.row[mine])
        turned = np.zeros(one.rows, dtype=np.int64)
        turned[rows] = turn_numbers(one.toolface[rows])
        return turned[self.row[mine]], "rotation"

    def number_passes(self, reversal: float | None, told: Told) -> None:
        """Number the passes: as the files do, else one a file, or anew where the tool went back by ``reversal``."""
        from helibore.preparation.passes import number_passes

        columns, first = [], 0
        for one in self.readings:
            if reversal is not None:
                found = np.full(one.rows, -1, dtype=np.int64)
                known = np.flatnonzero(np.isfinite(one.depth))
                found[known] = number_passes(one.depth[known], reversal) + 1 + first
                first = int(found.max(initial=first))
            elif one.pass_number is not None:
                found = one.pass_number
                first = max(first, int(found.max(initial=0)))
            else:
                first += 1
                found = np.full(one.rows, first, dtype=np.int64)
            columns.append(found)
        self.pass_number = self._of_row(columns).astype(np.int64)
        named = [set(np.unique(column).tolist()) - {-1} for column in columns]
        if sum(map(len, named)) > len(set().union(*named)):
            raise ValueError(f"{self.readings[-1].name}: numbers a pass as another file does: number them anew")
        samples = np.unique(self.pass_number, return_counts=True)
        counted = ", ".join(f"{number} ({count:,})" for number, count in zip(*samples, strict=True))
        how = f"split where the tool went back by {reversal:g} m" if reversal else "as the files number them"
        told.append(("passes", f"{how}; samples of each: {counted}"))

    def referred(self, path: Path | None, settings: Preparation, told: Told, counts: dict[str, int]) -> Samples:
        """With toolfaces in the reference of the path."""
        wanted = [settings.toolface_from or one.reference for one in self.readings]
        tagged = [settings.toolface_from is None and one.high_side is not None for one in self.readings]
        target = path.reference if path is not None else ""
        if target == "parallel-transport" and not all(tags or name for tags, name in zip(tagged, wanted, strict=True)):
            raise ValueError(
                f"{self.readings[0].name}: the wall's toolface is carried down the path, no tool's is: say whether "
                "the samples count from north, the high side or automatically"
            )
        if not any(tags or name not in ("", target) for tags, name in zip(tagged, wanted, strict=True)):
            return self
        if path is None:
            raise ValueError(
                f"{self.readings[0].name}: toolfaces that count from {wanted[0] or 'north and the high side'} need a "
                "survey to be turned into the wall's"
            )
        return self._onto(path, wanted, tagged, settings, told, counts)

    def _onto(
        self, path: Path, wanted: list[str], tagged: list[bool], settings: Preparation, told: Told,
        counts: dict[str, int],
    ) -> Samples:  # fmt: skip
        from helibore.trajectory.references import from_high_side, onto_path

        inside = (self.depth >= path.start_depth) & (self.depth <= path.stop_depth)
        beyond = int(np.count_nonzero(~inside))
        samples = self
        if beyond:
            counts["beyond the survey"] = beyond
            told.append(("dropped", f"{beyond:,} samples beyond the survey: their toolface has no reference there"))
            samples = self.select(inside)
            if not samples.depth.size:
                raise ValueError(f"{self.readings[0].name}: every sample lies beyond the survey")
        high = np.zeros(samples.depth.size, dtype=bool)
        leave = np.zeros(samples.depth.size, dtype=bool)
        for number, (name, tags) in enumerate(zip(wanted, tagged, strict=True)):
            mine = np.flatnonzero(samples.file == number)
            rows = samples.readings[number].high_side
            if tags and rows is not None:
                high[mine] = rows[samples.row[mine]]
                name = "the file's tags"
            elif name == "automatic":
                down = np.clip(path.tangent(samples.depth[mine])[:, 2], -1.0, 1.0)
                high[mine] = from_high_side(np.degrees(np.arccos(down)), settings.steep, settings.level)
            elif name in ("", path.reference):
                leave[mine] = True
            else:
                high[mine] = name == "high-side"
            share = f"{np.count_nonzero(high[mine]):,} of {mine.size:,} samples from the high side"
            told.append(("toolface", f"{samples.readings[number].name}: by {name or 'the wall'}, {share}"))
        turned = onto_path(samples.toolface, samples.depth, path, high) if not leave.all() else samples.toolface
        return replace(samples, toolface=np.where(leave, samples.toolface, turned))


def _joined(columns: list[npt.NDArray[Number]]) -> npt.NDArray[Number]:
    return columns[0] if len(columns) == 1 else np.concatenate(columns)


def _observe(one: Readings, settings: Preparation, track: Track | None, told: Told) -> Observed:
    """The samples of one file, by depth, or by time where a clock has a say."""
    sensors = [
        Sensor(each.name, each.offset + settings.sensor_offset, each.mounting, each.latency + settings.latency)
        for each in one.sensors
    ]
    late = any(sensor.latency for sensor in sensors)
    if track is None and not late:
        found = observe_by_depth(sensors, one.depth, one.toolface, one.radii)
        return found if one.time is None else _timed(found, one.time)
    if one.time is None:
        raise ValueError(f"{one.name}: a latency or a track needs a time, and no channel has that role")
    clocks = [np.flatnonzero(np.isfinite(one.time))] if track else _clocks(one, one.time, told)
    return _together([_by_clock(one, one.time, rows, sensors, track, told) for rows in clocks])


def _by_clock(
    one: Readings, time: Floats, rows: Integers, sensors: list[Sensor], track: Track | None, told: Told
) -> Observed:
    """The samples of rows whose times are of one clock."""
    when = time[rows]
    depth = track.depth if track else TimeSeries(*_in_order(when, one.depth[rows]))
    turning = track.toolface if track and track.toolface is not None else None
    if turning is None:
        turning = TimeSeries(*_in_order(when, one.toolface[rows]), angle=True, beyond=np.inf if not one.turning else 0)
    if turning.step > FAST_TURN:
        line = f"{one.name}: turns by {turning.step:.0f} deg between half of its readings: too fast to be read between"
        if ("toolface", line) not in told:
            told.append(("toolface", line))
    found = observe_by_time(sensors, [when] * len(sensors), [radius[rows] for radius in one.radii], depth, turning)
    return replace(found, row=rows[found.row])


def _clocks(one: Readings, time: Floats, told: Told) -> list[Integers]:
    """The rows that share a clock: all, or those of a pass, unless the clock starts anew among them."""
    rows = np.flatnonzero(np.isfinite(time))
    number = one.pass_number
    clocks = [rows] if number is None else [rows[number[rows] == each] for each in np.unique(number[rows])]
    apart = [part for clock in clocks for part in _runs(clock, time, one.depth)]
    if len(apart) > len(clocks):
        told.append(("time", f"{one.name}: goes back, as by a clock that starts anew: read as {len(apart)} clocks"))
    return apart


def _runs(rows: Integers, time: Floats, depth: Floats) -> list[Integers]:
    """Rows split into runs of rising or falling time, if in the order of time the tool would jump from row to row."""
    known = rows[np.isfinite(depth[rows])]
    when, where = _in_order(time[known], depth[known])
    if not (np.abs(np.diff(where)) > 1.0 + FASTEST * np.diff(when)).any():
        return [rows]
    falls = np.diff(time[rows]) < 0
    starts = [0]
    for step in np.flatnonzero(falls[1:] != falls[:-1]) + 1:
        if step > starts[-1]:  # the step to another clock; the one after it is the first of the next run
            starts.append(int(step) + 1)
    return np.split(rows, starts[1:])


def _together(parts: list[Observed]) -> Observed:
    """Samples of several clocks as one list."""
    if len(parts) == 1:
        return parts[0]
    names = ("depth", "toolface", "radius", "time", "sensor", "row")
    columns = {name: np.concatenate([getattr(part, name) for part in parts]) for name in names}
    return Observed(**columns, counts={name: sum(part.counts[name] for part in parts) for name in parts[0].counts})


def _in_order(time: Floats, values: Floats) -> tuple[Floats, Floats]:
    order = np.argsort(time, kind="stable")
    return time[order], values[order]


def _timed(found: Observed, time: Floats) -> Observed:
    """With the time of each sample; those whose row has none are left out."""
    every = sum(found.counts.values()) == found.depth.size == time.size  # one sensor, and nothing missing
    times = time if every else time[found.row]
    if not np.isnan(times.min(initial=0.0)):
        return replace(found, time=times)
    kept = np.flatnonzero(~np.isnan(times))
    counts = found.counts | {"no time": found.depth.size - kept.size, "taken": kept.size}
    columns = {name: getattr(found, name)[kept] for name in ("depth", "toolface", "radius", "sensor", "row")}
    return Observed(**columns, time=times[kept], counts=counts)


def place_of(samples: Samples, readings: list[Readings], at: int) -> str:
    """Where a sample stands, for an error: file, line and column."""
    one = readings[int(samples.file[at])]
    channel = one.channels[int(one.arm[int(samples.sensor[at])])]
    return f"{one.name}, {one.place(int(samples.row[at]))}, column {channel}"

"""Convert the readings of files to samples in one frame: by depth, or by time if latencies or a track need it.

    Readings (rows x sensors, one or more files) --observe--> Samples: depth, toolface, radius, time | file, row, sensor

A sensor that measures before or after its stamp, and a track with depth and toolface by time, need the time of each
row; rows without a time are left out. A file may hold the times of several clocks, for example if the clock restarts
with each pass. Then values are interpolated only between rows of one clock.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np

from helibore.base.arrays import Floats, Integers, Number, Typed, distinct
from helibore.base.errors import InputError
from helibore.preparation.readings import Readings
from helibore.preparation.sensors import REASONS, Samples, TimeSeries, observe_by_depth, observe_by_time

Report = list[tuple[str, str]]

FAST_TURN = 90.0
"""Degrees; if half of the steps between consecutive toolface readings are larger, the report warns that the tool may
have turned farther between readings."""

FASTEST = 20.0
"""Metres a second; no tool moves faster along the hole, so a larger speed shows that a clock restarts."""


@dataclass(frozen=True)
class Track:
    """Depth of the tool by time, read from a separate file, and toolface of the tool by time if that file has one."""

    depth: TimeSeries
    toolface: TimeSeries | None = None


@contextmanager
def placed(place: str) -> Iterator[None]:
    """Put ``place`` before the place in any InputError that the body of the ``with`` statement raises."""
    try:
        yield
    except InputError as error:
        raise error.within(place) from error


def observe(
    readings: Sequence[Readings],
    track: Track | None = None,
    report: Report | None = None,
    *,
    offset: float = 0.0,
    latency: float = 0.0,
    dropped: Mapping[str, int] | None = None,
) -> Samples:
    """Bring the sensors of all readings into one frame; raise an InputError if no sample of a file is left.

    Parameters
    ----------
    readings
        Readings of one file or more.
    track
        Depth and toolface by time, used instead of those of the files; None: the depth and toolface of each file.
    report
        List that receives a (step, sentence) pair for each reason why samples are left out, and for doubtful times and
        toolfaces. ``counts`` of the result has the number of samples left out for each reason.
    offset, latency
        Metres and seconds to add to the offset and latency of every sensor.
    dropped
        Earlier steps and the number of values that each of them dropped, for the error message.
    """
    report = [] if report is None else report
    found = []
    counts: dict[str, int] = {}
    for one in readings:
        with placed(one.name):
            seen = _observe(one, track, report, offset, latency)
        found.append(seen)
        for reason in REASONS:
            if count := seen.counts.get(reason):
                counts[reason] = counts.get(reason, 0) + count
                report.append(("dropped", f"{count:,} samples of {one.name} without a {reason.removeprefix('no ')}"))
        if not seen.depth.size:
            lacking = [f"{count} values missing in {name}" for name, count in one.missing.items()]
            lacking += [f"{count} dropped as {step}" for step, count in (dropped or {}).items()]
            rule = f"no row has depth, toolface and a radius ({', '.join(lacking) or 'no values'})"
            raise InputError(one.name, rule)
    if any(each.time is None for each in found) and any(each.time is not None for each in found):
        report.append(("time", "left out, because not every file has a time"))
        found = [replace(each, time=None) for each in found]
    if len(found) == 1:
        return replace(found[0], file=np.broadcast_to(np.int64(0), found[0].depth.size), counts=counts)
    file = np.repeat(np.arange(len(found)), [each.depth.size for each in found])
    return replace(_joined(found), file=file, counts=counts)


def _joined(parts: Sequence[Samples]) -> Samples:
    if len(parts) == 1:
        return parts[0]
    columns = {
        name: np.concatenate([getattr(part, name) for part in parts])
        for name in ("depth", "toolface", "radius", "time", "sensor", "row")
        if name != "time" or parts[0].time is not None
    }
    names = {name for part in parts for name in part.counts}
    counts = {name: sum(part.counts.get(name, 0) for part in parts) for name in names}
    return replace(parts[0], **columns, counts=counts)


def _observe(one: Readings, track: Track | None, report: Report, offset: float, latency: float) -> Samples:
    sensors = [replace(each, offset=each.offset + offset, latency=each.latency + latency) for each in one.sensors]
    if track is None and not any(sensor.latency for sensor in sensors):
        return observe_by_depth(sensors, one.depth, one.toolface, one.radii, one.time)
    if one.time is None:
        raise InputError("a latency or a track", "needs a time, and no channel has that role")
    clocks = [np.flatnonzero(np.isfinite(one.time))] if track else _clocks(one, one.time, report)
    parts = []
    for rows in clocks:
        when = one.time[rows]
        depth = track.depth if track else TimeSeries(*_in_order(when, one.depth[rows]))
        turning = track.toolface if track and track.toolface is not None else None
        if turning is None:
            beyond = 0.0 if one.turning else np.inf
            turning = TimeSeries(*_in_order(when, one.toolface[rows]), angle=True, beyond=beyond)
        line = ("toolface", f"{one.name}: half of the toolface readings differ by {turning.step:.0f} deg or more from "
                            "the reading before: how far the tool turned between readings is not known")  # fmt: skip
        if turning.step > FAST_TURN and line not in report:
            report.append(line)
        radii = [radius[rows] for radius in one.radii]
        seen = observe_by_time(sensors, [when] * len(sensors), radii, depth, turning)
        parts.append(replace(seen, row=rows[seen.row]))
    joined = _joined(parts)
    untimed = len(sensors) * (one.rows - sum(rows.size for rows in clocks))
    return replace(joined, counts=joined.counts | {"no time": untimed})


def _clocks(one: Readings, time: Floats, report: Report) -> list[Integers]:
    """Return groups of the rows that have a time, one group for each clock.

    Each numbered pass may have a clock of its own, and a clock may restart.
    """
    rows = np.flatnonzero(np.isfinite(time))
    number = one.pass_number
    clocks = [] if number is None else [rows[number[rows] == each] for each in distinct(number[rows])]
    clocks = clocks or [rows]
    apart = [part for clock in clocks for part in _runs(clock, time, one.depth)]
    if len(apart) > len(clocks):
        report.append(("time", f"{one.name}: the time goes back, as if a clock restarts: read as {len(apart)} clocks"))
    return apart


def _runs(rows: Integers, time: Floats, depth: Floats) -> list[Integers]:
    """Return ``rows`` as one run, or as runs of rising or falling time if the tool moves too fast in order of time."""
    known = rows[np.isfinite(depth[rows])]
    when, where = _in_order(time[known], depth[known])
    if not (np.abs(np.diff(where)) > 1.0 + FASTEST * np.diff(when)).any():
        return [rows]
    falls = np.diff(time[rows]) < 0
    starts = [0]
    for step in np.flatnonzero(falls[1:] != falls[:-1]) + 1:
        if step > starts[-1]:  # the time steps to another clock here; the next row begins the next run
            starts.append(int(step) + 1)
    return np.split(rows, starts[1:])


def _in_order(time: Floats, values: Typed[Number]) -> tuple[Floats, Typed[Number]]:
    order = np.argsort(time, kind="stable")
    return time[order], values[order]

"""From what each sensor reads to samples in one frame: where on the string it sits, which way it looks, how late it is.

       bit depth at t - latency                 depth    = bit depth(t - latency) - offset
    ===[tool]======o=======>  bit               toolface = tool's toolface(t - latency) + mounting
                   |<-offset->                  radius   = the reading

A reading stamped t was taken at t - latency. Bit depth and toolface are time series of their own and are taken at that
moment: linear between their readings, the toolface along the short way round. Sensors that fire at one instant thus
look at different depths and toolfaces, and their samples end up in one list, in order of time.

Depth-indexed files need no clock: :func:`observe_by_depth`. Not here: eccentering, the path, units, file formats.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from helibore.base.angles import wrapped
from helibore.base.arrays import Floats, Integers, column

__all__ = ["Observed", "Sensor", "TimeSeries", "observe_by_depth", "observe_by_time"]


@dataclass(frozen=True)
class Sensor:
    """Where a sensor sits on the string and which way it looks.

    Parameters
    ----------
    name
        For reports.
    offset
        Distance from the bit (or from whatever the depth series gives the depth of) up the string to the sensor, m.
        Negative: below it.
    mounting
        Angle from the tool's toolface reference to the sensor, clockwise looking downhole, degrees.
    latency
        Time from the measurement to its time stamp, seconds.
    """

    name: str
    offset: float = 0.0
    mounting: float = 0.0
    latency: float = 0.0

    def __post_init__(self) -> None:
        for name in ("offset", "mounting", "latency"):
            value = getattr(self, name)
            if not np.isfinite(value):
                raise ValueError(f"sensor {self.name}: {name} = {value:g}: must be finite")


class TimeSeries:
    """Readings over time, read off between them: bit depth, or the toolface of the tool. Frozen: a copy is kept.

    Parameters
    ----------
    time
        Seconds, (n,), not falling. Of several readings of one time the last one counts.
    values
        (n,); NaN readings are left out.
    angle
        The values are degrees: from one reading to the next the short way round, results in [0, 360). A tool that turns
        by 180 degrees or more between two readings cannot be followed.
    gap
        Longest time between two readings that is bridged, seconds. In a longer one the answer is NaN.
    beyond
        Seconds before the first and after the last reading that are answered, along the line of the two readings there.

    Raises
    ------
    ValueError
        If the lengths differ, a time is not finite or falls, a value is infinite, gap <= 0 or beyond < 0.
    """

    def __init__(
        self,
        time: npt.ArrayLike,
        values: npt.ArrayLike,
        *,
        angle: bool = False,
        gap: float = float("inf"),
        beyond: float = 0.0,
    ) -> None:
        if not gap > 0 or not beyond >= 0:
            raise ValueError(f"gap = {gap:g}, beyond = {beyond:g}: gap must be larger than 0, beyond not negative")
        stamps = column("time", time)
        readings = column("values", values, stamps.size, "time")
        _check(stamps, readings)
        known = ~np.isnan(readings)
        stamps, readings = stamps[known], readings[known]
        latest = np.append(stamps[1:] != stamps[:-1], True)[: stamps.size]
        self._time, self._values = stamps[latest], readings[latest]
        if angle:
            self._values = np.unwrap(self._values, period=360.0)
        self._angle, self._gap, self._beyond = angle, gap, beyond

    @property
    def step(self) -> float:
        """Median change from one reading to the next, the short way round where they are angles; 0 for one reading."""
        return float(np.median(np.abs(np.diff(self._values)))) if self._values.size > 1 else 0.0

    def at(self, time: npt.ArrayLike) -> Floats:
        """Values at these times, (n,) float64, new; NaN where there is no answer or the time is NaN."""
        when = column("time", time)
        result = np.full(when.size, np.nan)
        count = self._time.size
        if count == 0:
            return result
        after = np.searchsorted(self._time, when, side="left")
        exact = self._time[np.minimum(after, count - 1)] == when
        result[exact] = self._values[np.minimum(after, count - 1)[exact]]
        if count > 1:
            high = np.clip(after, 1, count - 1)
            low = high - 1
            width = self._time[high] - self._time[low]
            inside = (after > 0) & (after < count)
            outside = np.where(after == 0, self._time[0] - when, when - self._time[-1])
            answered = (width <= self._gap) & np.where(inside, True, outside <= self._beyond) & ~exact
            share = (when - self._time[low]) / width
            line = self._values[low] + share * (self._values[high] - self._values[low])
            result[answered] = line[answered]
        return wrapped(result) if self._angle else result


@dataclass(frozen=True)
class Observed:
    """Samples of several sensors in one frame, in order of time (of row, where there is no time), then of sensor.

    Attributes
    ----------
    depth, toolface, radius
        Metres, degrees in [0, 360), metres: (n,) float64, finite. The radius is from the tool's axis.
    time
        When they were measured, seconds, (n,) float64; None for depth-indexed readings.
    sensor, row
        Which sensor and which of its readings each sample is, (n,) int64.
    counts
        Readings taken, and those dropped for each reason: they add up to all readings given.
    """

    depth: Floats
    toolface: Floats
    radius: Floats
    time: Floats | None
    sensor: Integers
    row: Integers
    counts: dict[str, int]


def observe_by_time(
    sensors: Sequence[Sensor],
    times: Sequence[npt.ArrayLike],
    radii: Sequence[npt.ArrayLike],
    bit_depth: TimeSeries,
    toolface: TimeSeries,
) -> Observed:
    """Bring time-indexed readings of one or more sensors into one frame.

    Parameters
    ----------
    sensors, times, radii
        One of each for every sensor: time stamps (seconds) and radii (metres), (n,); lengths may differ among sensors.
        NaN radii are dropped and counted as ``no radius``.
    bit_depth, toolface
        Depth of the bit in m, and toolface of the tool's reference in degrees (``angle=True``). Readings at times they
        do not answer are dropped and counted as ``no depth`` and ``no toolface``.

    Returns
    -------
    Observed

    Raises
    ------
    ValueError
        If the sequences differ in length, or a time or radius is infinite.
    """
    _check_counts(sensors, times=times, radii=radii)
    parts = []
    for index, sensor in enumerate(sensors):
        stamps = column(f"times[{index}]", times[index])
        when = stamps - sensor.latency
        depth = bit_depth.at(when) - sensor.offset
        looking = wrapped(toolface.at(when) + sensor.mounting)
        parts.append((when, depth, looking, _radii(index, radii[index], stamps.size, f"times[{index}]")))
    return _gather(parts)


def observe_by_depth(
    sensors: Sequence[Sensor], depth: npt.ArrayLike, toolface: npt.ArrayLike, radii: Sequence[npt.ArrayLike]
) -> Observed:
    """Bring depth-indexed readings, such as the arms of a caliper, into one frame.

    Parameters
    ----------
    sensors, radii
        One column of radii (metres, (n,)) for each sensor. Their latency has no say. An X-Y caliper of diameters x and
        y is four sensors mounted at 0, 180, 90 and 270 degrees that read x/2, x/2, y/2 and y/2.
    depth, toolface
        Of each row: metres, and degrees of the tool's reference; (n,). NaN rows are dropped and counted.

    Returns
    -------
    Observed
        ``time`` is None.

    Raises
    ------
    ValueError
        If lengths differ or a value is infinite.
    """
    _check_counts(sensors, radii=radii)
    rows = column("depth", depth)
    reference = column("toolface", toolface, rows.size, "depth")
    columns = [column(f"radii[{index}]", values, rows.size, "depth") for index, values in enumerate(radii)]
    for name, values in (("depth", rows), ("toolface", reference)):
        if np.isinf(values).any():
            raise ValueError(f"{name} is infinite in {np.count_nonzero(np.isinf(values))} rows: must be finite")
    radius = _grid(columns)
    if np.isinf(radius).any():
        row, index = np.argwhere(np.isinf(radius))[0]
        raise ValueError(f"radii[{index}][{row}] = {radius[row, index]:g}: must be finite, or NaN where missing")
    offsets, mountings = (np.array([getattr(one, name) for one in sensors]) for name in ("offset", "mounting"))
    depths = rows[:, None] - offsets if offsets.any() else np.broadcast_to(rows[:, None], radius.shape)
    looking = reference[:, None] + mountings if mountings.any() else np.broadcast_to(reference[:, None], radius.shape)
    sensor = np.broadcast_to(np.arange(len(sensors)), radius.shape).reshape(-1)
    row = np.broadcast_to(np.arange(rows.size)[:, None], radius.shape).reshape(-1)
    flat = (depths.reshape(-1), looking.reshape(-1), radius.reshape(-1))
    kept, counts = _present(*flat)
    if kept is None:
        return Observed(flat[0], wrapped(flat[1]), flat[2], None, sensor, row, counts)
    return Observed(flat[0][kept], wrapped(flat[1][kept]), flat[2][kept], None, sensor[kept], row[kept], counts)


def _grid(columns: Sequence[Floats]) -> Floats:
    """Columns side by side, (n, p)."""
    return columns[0][:, None] if len(columns) == 1 else np.stack(columns, axis=1)


def _present(depth: Floats, toolface: Floats, radius: Floats) -> tuple[Integers | None, dict[str, int]]:
    """The samples that have all three, in order (None: all of them), and a count for each reason that they have not."""
    reasons = (("no depth", depth), ("no toolface", toolface), ("no radius", radius))
    counts = dict.fromkeys((reason for reason, _ in reasons), 0)
    if not any(np.isnan(values.min(initial=0.0)) for _, values in reasons):
        return None, counts | {"taken": depth.size}
    kept = np.ones(depth.size, dtype=bool)
    for reason, values in reasons:
        absent = kept & np.isnan(values)
        counts[reason] = int(np.count_nonzero(absent))
        kept &= ~absent
    chosen = np.flatnonzero(kept)
    return chosen, counts | {"taken": chosen.size}


def _gather(parts: Sequence[tuple[Floats, Floats, Floats, Floats]]) -> Observed:
    """The samples of time-indexed sensors, in order of time."""
    sizes = [part[0].size for part in parts]
    time, depth, toolface, radius = (np.concatenate([part[i] for part in parts]) for i in range(4))
    for name, values in (("time", time), ("depth", depth), ("toolface", toolface)):
        if np.isinf(values).any():
            raise ValueError(f"{name} is infinite in {np.count_nonzero(np.isinf(values))} rows: must be finite")
    sensor = np.repeat(np.arange(len(parts)), sizes)
    row = np.concatenate([np.arange(size) for size in sizes])
    kept, counts = _present(depth, toolface, radius)
    chosen = np.arange(time.size) if kept is None else kept
    chosen = chosen[np.lexsort((sensor[chosen], time[chosen]))]
    return Observed(depth[chosen], toolface[chosen], radius[chosen], time[chosen], sensor[chosen], row[chosen], counts)


def _radii(index: int, values: npt.ArrayLike, size: int, like: str) -> Floats:
    radius = column(f"radii[{index}]", values, size, like)
    if np.isinf(radius).any():
        at = int(np.argmax(np.isinf(radius)))
        raise ValueError(f"radii[{index}][{at}] = {radius[at]:g}: must be finite, or NaN where missing")
    return radius


def _check(time: Floats, values: Floats) -> None:
    for name, array, bad in (("time", time, ~np.isfinite(time)), ("values", values, np.isinf(values))):
        if bad.any():
            at = int(np.argmax(bad))
            raise ValueError(f"{name}[{at}] = {array[at]:g}: must be finite")
    falling = np.flatnonzero(np.diff(time) < 0)
    if falling.size:
        at = int(falling[0]) + 1
        raise ValueError(f"time[{at}] = {time[at]:g}: must not be less than time[{at - 1}] = {time[at - 1]:g}")


def _check_counts(sensors: Sequence[Sensor], **columns: Sequence[npt.ArrayLike]) -> None:
    if not sensors:
        raise ValueError("sensors: must have at least one")
    for name, given in columns.items():
        if len(given) != len(sensors):
            raise ValueError(f"{name} has {len(given)} columns, sensors has {len(sensors)}: must be equal")

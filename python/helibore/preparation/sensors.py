"""Convert readings of sensors to samples in one frame, by each sensor's offset, mounting angle and latency.

       bit depth at t - latency                 depth    = bit depth(t - latency) - offset
    ===[tool]======o=======>  bit               toolface = tool's toolface(t - latency) + mounting
                   |<-offset->                  radius   = the reading

A reading stamped t was taken at t - latency. Bit depth and toolface are time series of their own and are interpolated
at that time: linearly between their readings, toolfaces along the shorter arc. So sensors that fire at the same time
measure at different depths and toolfaces. The samples of all sensors are returned together, in order of time.

Depth-indexed files need no times; :func:`observe_by_depth` converts them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from helibore import _core
from helibore.base.angles import wrapped
from helibore.base.arrays import Floats, Integers, Mask, column, finite_column, require
from helibore.base.errors import InputError

__all__ = ["Samples", "Sensor", "TimeSeries", "observe_by_depth", "observe_by_time"]

REASONS = ("no depth", "no toolface", "no radius", "no time")
"""Why a sample is left out, in the order in which the reasons are looked for."""


@dataclass(frozen=True)
class Sensor:
    """Where a sensor sits on the string and which way it looks; ``name`` is for reports."""

    name: str
    offset: float = 0.0  # m up the string from the point whose depth is recorded (the bit); negative: below this point
    mounting: float = 0.0  # degrees from the tool's toolface reference, clockwise looking downhole
    latency: float = 0.0  # seconds from the measurement to its time stamp

    def __post_init__(self) -> None:
        for name in ("offset", "mounting", "latency"):
            value = getattr(self, name)
            if not np.isfinite(value):
                raise InputError(f"sensor {self.name}: {name}", "must be finite", f"{value:g}")


class TimeSeries:
    """A quantity over time, interpolated between its readings: bit depth, or the tool's toolface. Readings are copied.

    Parameters
    ----------
    time
        Seconds, (n,), not falling. If several readings have the same time, the last reading counts.
    values
        (n,); NaN readings are left out.
    angle
        The values are degrees, which are interpolated the short way round; results lie in [0, 360). A tool that turns
        by 180 degrees or more between two readings cannot be followed.
    gap, beyond
        Seconds. ``gap`` is the longest time between two readings in which values are interpolated; in a longer gap they
        are NaN. ``beyond`` is how long before the first and after the last reading values are extrapolated, along the
        line through the two readings there, if these are at most ``gap`` apart.
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
            raise InputError(f"gap = {gap:g}, beyond = {beyond:g}", "gap must be above 0, beyond not negative")
        stamps = finite_column("time", time)
        readings = column("values", values, stamps.size, "time")
        require("values", readings, ~np.isinf(readings), "must be finite")
        falling = np.flatnonzero(np.diff(stamps) < 0)
        if falling.size:
            at = int(falling[0]) + 1
            rule = f"must not be less than time[{at - 1}] = {stamps[at - 1]:g}"
            raise InputError(f"time[{at}]", rule, f"{stamps[at]:g}")
        known = ~np.isnan(readings)
        stamps, readings = stamps[known], readings[known]
        latest = np.append(stamps[1:] != stamps[:-1], True)[: stamps.size]
        self._time, self._values = stamps[latest], readings[latest]
        if angle:
            self._values = np.unwrap(self._values, period=360.0)
        self._angle, self._gap, self._beyond = angle, gap, beyond

    @property
    def step(self) -> float:
        """Median change from one reading to the next, for angles along the shorter arc; 0 for one reading or none."""
        return float(np.median(np.abs(np.diff(self._values)))) if self._values.size > 1 else 0.0

    def at(self, time: npt.ArrayLike) -> Floats:
        """Return the values at these times, (n,) float64, new; NaN where there is no value or the time is NaN."""
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
class Samples:
    """n samples of several sensors in one frame, in order of time (of row, if indexed by depth), then of sensor."""

    depth: Floats  # metres; depth, toolface and radius are finite
    toolface: Floats  # degrees in [0, 360)
    radius: Floats  # metres from the tool's axis
    time: Floats | None  # when the samples were measured, seconds; None if the readings have no time
    sensor: Integers  # which sensor each sample is from
    row: Integers  # which row of the readings each sample is from
    file: Integers = field(default_factory=lambda: np.empty(0, dtype=np.int64))  # file of each sample; or empty
    pass_number: Integers = field(default_factory=lambda: np.empty(0, dtype=np.int64))  # of each sample; or empty
    counts: dict[str, int] = field(default_factory=dict)  # number of readings "taken", and dropped for each reason

    def select(self, kept: Mask | Integers) -> Samples:
        """Return the samples where ``kept`` is True, or the samples at these indices, in the order of the indices."""
        columns = {name: getattr(self, name) for name in _COLUMNS}
        return replace(self, **{
            name: values[kept] if values is not None and values.size else values for name, values in columns.items()
        })  # fmt: skip


_COLUMNS = ("depth", "toolface", "radius", "time", "sensor", "row", "file", "pass_number")


def observe_by_time(
    sensors: Sequence[Sensor],
    times: Sequence[npt.ArrayLike],
    radii: Sequence[npt.ArrayLike],
    bit_depth: TimeSeries,
    toolface: TimeSeries,
) -> Samples:
    """Bring time-indexed readings of one or more sensors into one frame.

    Parameters
    ----------
    sensors, times, radii
        For every sensor a column of time stamps (seconds) and a column of radii (metres), (n,); n may differ among
        sensors. NaN radii are dropped and counted as ``no radius``.
    bit_depth, toolface
        Depth of the bit in m, and toolface of the tool's reference in degrees (``angle=True``). Readings at times
        without a depth or a toolface are dropped and counted as ``no depth`` and ``no toolface``; a NaN time has no
        depth.
    """
    _check_counts(sensors, times=times, radii=radii)
    parts: list[tuple[Floats, ...]] = []
    for index, sensor in enumerate(sensors):
        when = column(f"times[{index}]", times[index]) - sensor.latency
        radius = column(f"radii[{index}]", radii[index], when.size, f"times[{index}]")
        require(f"radii[{index}]", radius, ~np.isinf(radius), "must be finite, or NaN where missing")
        looking = wrapped(toolface.at(when) + sensor.mounting)
        parts.append((when, bit_depth.at(when) - sensor.offset, looking, radius))
    sizes = [part[0].size for part in parts]
    time, depth, angle, distance = (np.concatenate([part[i] for part in parts]) for i in range(4))
    sensor_index = np.repeat(np.arange(len(parts)), sizes)
    row = np.concatenate([np.arange(size) for size in sizes])
    order = np.lexsort((sensor_index, time))
    return _present(Samples(depth, angle, distance, time, sensor_index, row).select(order), time=time, depth=depth)


def observe_by_depth(
    sensors: Sequence[Sensor],
    depth: npt.ArrayLike,
    toolface: npt.ArrayLike,
    radii: Sequence[npt.ArrayLike],
    time: npt.ArrayLike | None = None,
) -> Samples:
    """Bring depth-indexed readings, such as the arms of a caliper, into one frame.

    Parameters
    ----------
    sensors, radii
        One column of radii (metres, (n,)) for each sensor; latencies are not used. An X-Y caliper of diameters x and
        y is four sensors mounted at 0, 180, 90 and 270 degrees that read x/2, x/2, y/2 and y/2.
    depth, toolface, time
        Depth, toolface of the tool's reference and time of each row: metres, degrees, seconds; (n,). Rows with NaN are
        dropped, and their samples are counted by reason.
    """
    _check_counts(sensors, radii=radii)
    rows = column("depth", depth)
    reference = column("toolface", toolface, rows.size, "depth")
    columns = [column(f"radii[{index}]", values, rows.size, "depth") for index, values in enumerate(radii)]
    times = None if time is None else column("time", time, rows.size, "depth")
    places = [(one.offset, one.mounting, index) for index, one in enumerate(sensors)]
    found = _core.observe_by_depth(rows, reference, columns, times, places)
    reasons = REASONS if times is not None else REASONS[:3]
    return Samples(*found[:6], counts=dict(zip(reasons, found[6], strict=False)) | {"taken": found[0].size})


def _present(samples: Samples, **inputs: Floats) -> Samples:
    """Return the samples that have depth, toolface, radius and, if there are times, time; count the others by reason.

    Raises an InputError if a value of ``inputs`` is infinite.
    """
    for name, values in inputs.items():
        if np.isinf(values).any():
            raise InputError(f"{name} is infinite in {np.count_nonzero(np.isinf(values))} rows", "must be finite")
    names = ("depth", "toolface", "radius", "time")[: 3 if samples.time is None else 4]
    reasons = {f"no {name}": getattr(samples, name) for name in names}
    counts = dict.fromkeys(reasons, 0)
    if any(np.isnan(values.min(initial=0.0)) for values in reasons.values()):
        kept = np.ones(samples.depth.size, dtype=bool)
        for reason, values in reasons.items():
            absent = kept & np.isnan(values)
            counts[reason] = int(np.count_nonzero(absent))
            kept &= ~absent
        samples = samples.select(np.flatnonzero(kept))
    return replace(samples, counts=counts | {"taken": samples.depth.size})


def _check_counts(sensors: Sequence[Sensor], **columns: Sequence[npt.ArrayLike]) -> None:
    if not sensors:
        raise InputError("sensors", "must have at least one sensor")
    for name, given in columns.items():
        if len(given) != len(sensors):
            raise InputError(f"{name} has {len(given)} columns, sensors has {len(sensors)}", "must be equal")

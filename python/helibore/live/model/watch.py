"""Watch the measurement: streams that are well formed and wrong (dead, stuck, of another unit, of another hole).

    frames of all sources, in the order of the journal -> rig: on bottom? turning? -> a watch for each caliper and image
                                                                                          -> event, and what lasts

Every rule takes one frame at a time and the model's time, so a replay in large windows reports the same events. The
alarms of a running server are derived from them. The constants are those with which 150 simulated days of telemetry and
13 days at one sample a second gave no false alarm, and each wrong stream gave one.
"""

from __future__ import annotations

import math
import statistics
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from helibore.base import units
from helibore.base.arrays import Floats, Integers, distinct
from helibore.base.utc_time import SECOND
from helibore.live.model.wall_watch import OF_WALL, WallMemory
from helibore.live.rules.pass_rules import PassRules

Report = Callable[[int, str, str, str], None]
"""Reports an event: wall clock time, rule, source and text."""

QUIET, QUIET_GAPS, QUIET_AFTER_STOP = 60.0, 25.0, 600.0
"""Seconds on bottom without a sample: at least, in median gaps, and at least after the bit was off bottom."""
WIRED, QUIET_TELEMETRY = 2.0, 330.0
"""Seconds between samples up to which a tool is wired; by mud pulse, a downlink can silence a tool for 303 s."""
LEAST_DRILLED, LONGEST_STAND = 0.1, 60.0
"""Metres that must be drilled without a sample, and the seconds that count of a stand on bottom without drilling."""
NO_DEPTH, NO_DEPTH_GAPS = 60.0, 25.0
"""Seconds in which a source sends and none of its bit depths can be used: at least, and in usual intervals."""
KNOWN_GAPS = 10
"""The number of gaps between samples from which their median counts."""
LONGEST_STEP = 30.0
"""Seconds. Of a longer gap between two bit depths, only this much counts as time on bottom."""
FASTEST, SLACK = 3.0, 1.0
"""Speed of a string, m/s, and length, m, that a step of the bit depth may have without any speed before or after it."""
HOLE_FALLS, HOLE_FRAMES = 0.6, 3
"""Metres by which the hole depth must be lower, and the number of frames in a row that must say so."""
FIRST_RADII = 100
_SMALL = units.MILLIMETRE / units.INCH
SCALES = {
    2.0: 'diameters, read as radii (measures = "diameter")',
    0.5: 'radii, read as diameters (measures = "radius")',
    _SMALL: 'inches, read as millimetres (radius_unit = "in")',
    2 * _SMALL: "diameters in inches, read as radii in millimetres (measures and radius_unit)",
    1 / _SMALL: 'millimetres, read as inches (radius_unit = "mm")',
    2 / _SMALL: "diameters in millimetres, read as radii in inches (measures and radius_unit)",
}  # fmt: skip
"""For each ratio of the median radius to that of the bit: what the values seem to be."""
NEAR = 0.12
"""The relative error within which a ratio counts as one of SCALES."""
SENSORS, LEAST_OFF, ERRORS, ONE_WAY = 64, 0.002, 6.0, 0.25
"""Samples of each sensor that are compared, and metres and standard errors by which the median of one must differ from
the others'. If the mean vector of their directions, or of two or three times these, is longer than ONE_WAY, each sensor
has seen its own part of the hole: they are not compared."""
STAYS, STAYS_ROUNDED, ROUNDED, ROUNDED_AFTER = 50, 600, 0.2, 200
"""Equal values in a row; the same for a channel in which more than ROUNDED of at least ROUNDED_AFTER values repeat."""
TURNING = 40.0
"""rpm from which the toolface must move."""
TOOLFACES, TOOLFACE_SECONDS, RESULTANT = 60, 500.0, 0.97
"""Number of toolfaces, the least time over which they are taken, and the length of their mean vector if they stay."""


@dataclass(slots=True)
class Frame:
    """What one frame of one source says: rig quantities, and the samples or rows that came with it.

    ``sensor``, ``depth``, ``toolface`` and ``radius`` have an entry for each sample with a value; ``depth`` may be NaN.
    ``images`` has the names of the images with a row, ``shown`` the values of the channels of the rig. ``only_bytes``:
    it stands for a record of the source of the bit depth, after all frames of this record.
    """

    order: int
    time: int
    wall: int
    source: str
    rig: dict[str, float]
    sensor: Integers | None = None
    depth: Floats | None = None
    toolface: Floats | None = None
    radius: Floats | None = None
    images: tuple[str, ...] = ()
    shown: dict[str, float] = field(default_factory=dict)
    only_bytes: bool = False


@dataclass(frozen=True, slots=True)
class WatchedCaliper:
    """What the watch needs of the settings of a caliper: the radius of the bit, the offset and the number of sensors.

    ``sensors`` is 0 if the triples of a frame are one sensor's samples, one after the other.
    """

    bit_radius: float
    offset: float
    sensors: int


class Quiet:
    """Time on bottom and metres drilled since the last sample of a caliper, or the last row of an image."""

    STATE = ("last", "gaps", "seconds", "stood", "drilled", "stopped", "lasts")

    def __init__(self) -> None:
        self.last = -1
        self.gaps: deque[float] = deque(maxlen=99)
        self.seconds = self.stood = self.drilled = 0.0
        self.stopped = True
        self.lasts = False

    def came(self, time: int) -> None:
        if self.last >= 0 and not self.stopped and time > self.last:
            self.gaps.append((time - self.last) / SECOND)
        self.seconds = self.stood = self.drilled = 0.0
        self.last, self.stopped, self.lasts = time, False, False

    def on(self, seconds: float, metres: float) -> str:
        """Count time on bottom; return the evidence once samples are overdue, "" before and after that."""
        self.stood += seconds
        if metres <= 0:
            return ""
        self.seconds += min(self.stood, LONGEST_STAND)
        self.stood, self.drilled = 0.0, self.drilled + metres
        if self.lasts or len(self.gaps) < KNOWN_GAPS or self.drilled < LEAST_DRILLED:
            return ""
        usual = statistics.median(self.gaps)
        limit = max(QUIET if usual <= WIRED else QUIET_TELEMETRY, QUIET_GAPS * usual)
        if self.seconds <= (max(limit, QUIET_AFTER_STOP) if self.stopped else limit):
            return ""
        self.lasts = True
        return f"in {self.seconds:.0f} s on bottom, {self.drilled:.1f} m drilled; before that, one every {usual:.3g} s"


@dataclass
class WatchedChannel:
    """The values of one channel: how many in a row were equal, and how many of all repeated the one before.

    ``since`` is the depth of the first of the equal values, metres; NaN if it is not known.
    """

    value: float = math.nan
    equal: int = 0
    count: int = 0
    repeats: int = 0
    lasts: bool = False
    since: float = math.nan

    def take(self, values: Floats, depths: Floats) -> int:
        """Take values in order; return the number of equal ones once it is too large, 0 before and after that."""
        found = 0
        for value, depth in zip(values.tolist(), depths.tolist(), strict=True):
            self.count += 1
            if value != self.value:
                self.value, self.equal, self.lasts, self.since = value, 1, False, depth
                continue
            self.equal += 1
            self.repeats += 1
            share = (self.repeats - self.equal + 1) / max(self.count - self.equal, 1)
            known = self.count - self.equal >= ROUNDED_AFTER
            if not self.lasts and self.equal >= (STAYS if known and share <= ROUNDED else STAYS_ROUNDED):
                self.lasts, found = True, self.equal
        return found


class CaliperWatch:
    """The rules for the samples of one caliper."""

    STATE = ("radii", "scale", "channels", "sensors", "directions", "odd", "toolfaces", "toolface_at", "toolface_lasts")

    def __init__(self) -> None:
        self.radii: list[float] = []
        self.scale = ""
        self.channels: dict[int, WatchedChannel] = {}
        self.sensors: dict[int, list[float]] = {}
        self.directions: deque[float] = deque(maxlen=SENSORS)
        self.odd = -1
        self.toolfaces: deque[float] = deque(maxlen=TOOLFACES)
        self.toolface_at = -1
        self.toolface_lasts = False


class Watch:
    """The rules for all sources, and what is wrong now.

    Attributes
    ----------
    active
        The text of each rule of each source that is broken now, by (rule, source).
    """

    STATE = (
        "active", "_bit", "_hole", "_deepest", "_rpm", "_first_hole", "_intervals", "_lower", "_quiet", "_calipers",
        "_walls", "_fell", "_before_fall", "_sends", "_without",
    )  # fmt: skip

    def __init__(self, report: Report) -> None:
        self._report = report
        self.active: dict[tuple[str, str], str] = {}
        self._bit: list[tuple[int, float, int, str]] = []  # the latest bit depths: time, depth, wall, source
        self._hole = self._deepest = self._first_hole = math.nan
        self._rpm: tuple[int, float] | None = None
        self._intervals: deque[float] = deque(maxlen=31)
        self._lower: list[float] = []
        self._quiet: dict[str, Quiet] = {}
        self._calipers: dict[str, CaliperWatch] = {}
        self._settings: dict[str, WatchedCaliper] = {}
        self._walls: dict[str, WallMemory] = {}
        self._fell: list[int] = []  # model times at which the hole depth fell, and was reached again, in turn
        self._before_fall = math.nan
        self._sends = -1  # time of the latest bytes of the source of the bit depth
        self._without = 0.0  # seconds in which it has sent since its latest bit depth

    def use(
        self, calipers: Mapping[str, WatchedCaliper], images: Mapping[str, str], rules: PassRules, jump: float
    ) -> None:
        """Use these settings from now on: the caliper of each source, the source of each image, and the limits."""
        changed = {name for name in calipers if self._settings.get(name, calipers[name]) != calipers[name]}
        self._settings, self._rules, self._jump = dict(calipers), rules, jump
        watched = [*calipers, *(f"{source} image {name}" for name, source in images.items())]
        self._quiet = {name: self._quiet.get(name, Quiet()) for name in watched}
        for name in changed:  # another bit or tool: its first radii are compared again
            self._calipers.pop(name, None)
            self._first_hole = self._hole if self._hole == self._hole else self._deepest
        self._calipers = {name: self._calipers.get(name, CaliperWatch()) for name in calipers}
        self._walls = {name: self._walls.get(name, WallMemory()) for name in calipers}
        self.active = {key: of for key, of in self.active.items()
                       if key[0] == "no_depth" or (key[1] in self._quiet and key[1] not in changed)}  # fmt: skip

    def begin_hole(self, kickoff: float | None) -> None:
        """Forget the depth of the hole, and below ``kickoff`` (None: everywhere) its wall: another hole begins."""
        self._hole = self._deepest = self._first_hole = self._before_fall = math.nan
        self._fell, self._lower, self._bit = [], [], []
        for memory in self._walls.values():
            memory.begin_hole(kickoff)
        self.active = {key: text for key, text in self.active.items() if key[0] not in OF_WALL}

    def shift(self, length: float) -> None:
        """Shift the known depths of bit and hole, because all later depths are shifted."""
        self._bit = [(time, depth + length, wall, source) for time, depth, wall, source in self._bit]
        self._hole, self._deepest = self._hole + length, self._deepest + length
        self._before_fall += length

    def take(self, frames: list[Frame]) -> None:
        """Take frames in any order of one window of the journal; windows must come in order."""
        frames.sort(key=lambda frame: frame.order)
        for frame in frames:
            if frame.rig:
                self._take_rig(frame)
            if frame.only_bytes:
                self._count_without(frame)
            if frame.radius is not None and len(frame.radius):
                self._came(frame.source, frame.time)
                self._take_samples(frame)
            for image in frame.images:
                self._came(f"{frame.source} image {image}", frame.time)

    def compare(self, source: str, columns: tuple[Integers, Integers, Floats, Floats, Floats]) -> None:
        """Compare samples of a source with its wall: `WallMemory.take` has the columns."""

        def say(wall: int, rule: str, text: str, lasts: bool) -> None:
            if not text:
                self.active.pop((rule, source), None)
                return
            if lasts:
                self.active[rule, source] = text
            self._report(wall, rule, source, text)

        if source in self._walls:
            self._walls[source].take(columns, self._fell, say)

    def _begin(self, frame: Frame, rule: str, source: str, text: str) -> None:
        self.active[rule, source] = text
        self._report(frame.wall, rule, source, text)

    def _came(self, name: str, time: int) -> None:
        if (quiet := self._quiet.get(name)) is not None:
            quiet.came(time)
            self.active.pop(("no_samples", name), None)

    def _turning(self, time: int) -> float:
        """Return the latest rotation in rpm; NaN if it is unknown or older than ``stale`` seconds."""
        if self._rpm is None or time - self._rpm[0] > self._rules.stale * SECOND:
            return math.nan
        return self._rpm[1]

    def _take_rig(self, frame: Frame) -> None:
        if (rpm := frame.rig.get("rotation", math.nan)) == rpm:
            self._rpm = frame.time, rpm
        before = self._hole if self._hole == self._hole else self._deepest
        if (hole := frame.rig.get("hole_depth", math.nan)) == hole:
            self._take_hole(frame, hole)
        if (bit := frame.rig.get("bit_depth", math.nan)) == bit:
            self._deepest = max(self._deepest, bit) if self._deepest == self._deepest else bit
            bottom = self._hole if self._hole == self._hole else self._deepest
            self._first_hole = bottom if self._first_hole != self._first_hole else self._first_hole
            self._without = 0.0
            self.active.pop(("no_depth", frame.source), None)
            self._take_bit(frame, bit, bottom, max(bottom - before, 0.0) if before == before else 0.0)

    def _count_without(self, frame: Frame) -> None:
        """Report that the source of the bit depth sends, and that no bit depth comes any more."""
        self._without += min((frame.time - self._sends) / SECOND, LONGEST_STEP) if self._sends >= 0 else 0.0
        self._sends = frame.time
        if len(self._intervals) < KNOWN_GAPS or ("no_depth", frame.source) in self.active:
            return
        usual = statistics.median(self._intervals)
        if self._without > max(NO_DEPTH, NO_DEPTH_GAPS * usual):
            text = (
                f"no bit depth in {self._without:.0f} s in which bytes came; before that, one every {usual:.3g} s: it "
                "has another name or unit (items.bit_depth), what comes cannot be read, or only keep-alives come"
            )
            self._begin(frame, "no_depth", frame.source, text)

    def _take_hole(self, frame: Frame, hole: float) -> None:
        """Report a hole depth that falls: HOLE_FRAMES frames in a row are HOLE_FALLS lower than the deepest one."""
        if hole >= self._before_fall:
            self._fell, self._before_fall = [*self._fell, frame.time], math.nan
        if self._hole != self._hole or hole > self._hole - HOLE_FALLS:
            self._hole, self._lower = max(hole, self._hole) if self._hole == self._hole else hole, []
            return
        self._lower.append(hole)
        if len(self._lower) == HOLE_FRAMES:
            text = (
                f"hole depth fell from {self._hole:.1f} m to {hole:.1f} m: another hole (a sidetrack), or a "
                "corrected depth; for another hole, set hole.name and hole.kickoff; for a corrected depth, hole.shift"
            )
            self._report(frame.wall, "hole_falls", frame.source, text)
            if len(self._fell) % 2 == 0:
                self._fell, self._before_fall = [*self._fell[-20:], frame.time], self._hole
            self._hole = self._deepest = hole
            self._lower = []

    def _take_bit(self, frame: Frame, bit: float, bottom: float, drilled: float) -> None:
        on_bottom = bottom - bit <= self._rules.on_bottom
        if self._bit:
            last = self._bit[-1]
            seconds = (frame.time - last[0]) / SECOND
            self._intervals.append(seconds)
            self._count_quiet(
                frame, on_bottom and bottom - last[1] - drilled <= self._rules.on_bottom, seconds, drilled
            )
        self._bit = [*self._bit[-3:], (frame.time, bit, frame.wall, frame.source)]
        if len(self._bit) == 4:
            self._judge_step()

    def _count_quiet(self, frame: Frame, on_bottom: bool, seconds: float, drilled: float) -> None:
        for name, quiet in self._quiet.items():
            if not on_bottom:
                quiet.stopped = True
            elif text := quiet.on(min(seconds, LONGEST_STEP), drilled):
                setting = "caliper" if name in self._settings else "image"
                cause = f"the tool may be dead, or what it sends has other names ({setting})"
                self._begin(frame, "no_samples", name, f"no sample {text}: {cause}")

    def _judge_step(self) -> None:
        """Report a step of the bit depth that no string can make; it is judged a frame later."""
        (t0, d0, _, _), (t1, d1, _, _), (t2, d2, wall, source), (t3, d3, _, _) = self._bit
        usual = statistics.median(self._intervals)
        first, step, after = ((b - a) / SECOND or usual or 1.0 for a, b in ((t0, t1), (t1, t2), (t2, t3)))
        step = max(step, usual)
        length = abs(d2 - d1)
        speeds = abs(d1 - d0) / max(first, usual) + abs(d3 - d2) / max(after, usual)
        allowed = min(FASTEST * step, step * step / 4 + speeds * step / 2 + SLACK)
        if length > max(allowed, SLACK) and length <= self._jump:
            text = (
                f"bit depth jumped by {d2 - d1:+.1f} m: it came to {d2:.2f} m in {step:.3g} s, faster than a string "
                "moves: a corrected or wrong depth; samples from here on lie at the new depth, unless hole.shift sets "
                "it right"
            )
            self._report(wall, "depth_step", source, text)

    def _take_samples(self, frame: Frame) -> None:
        settings, watch = self._settings.get(frame.source), self._calipers.get(frame.source)
        if settings is None or watch is None or frame.radius is None:
            return
        rpm = self._turning(frame.time)
        if len(watch.radii) < FIRST_RADII:
            self._take_first(frame, settings, watch)
        self._take_channels(frame, settings, watch)
        if settings.sensors >= 3 and rpm >= self._rules.rotating:
            self._take_sensors(frame, settings, watch)
        if rpm > TURNING:
            self._take_toolface(frame, watch, rpm)

    def _depths(self, frame: Frame, settings: WatchedCaliper) -> Floats:
        """Return the depth of each sample of a frame; if it was not sent, by the latest bit depth."""
        assert frame.depth is not None
        if not self._bit:
            return frame.depth
        return np.where(np.isnan(frame.depth), self._bit[-1][1] - settings.offset, frame.depth)

    def _take_first(self, frame: Frame, settings: WatchedCaliper, watch: CaliperWatch) -> None:
        """Compare the first radii of hole that was drilled since the start with the bit."""
        assert frame.radius is not None
        depth = self._depths(frame, settings)
        new = frame.radius[~(depth < self._first_hole)] if self._first_hole == self._first_hole else frame.radius
        watch.radii += new[: FIRST_RADII - len(watch.radii)].tolist()
        if len(watch.radii) < FIRST_RADII:
            return
        median = statistics.median(watch.radii)
        for ratio, what in SCALES.items():
            if abs(median / settings.bit_radius / ratio - 1) < NEAR:
                watch.scale = what
                text = (
                    f"the first {FIRST_RADII} radii have the median {1e3 * median:.1f} mm, "
                    f"{median / settings.bit_radius:.3g} times that of the bit: it seems that they are {what}; "
                    "or the hole is as wide, or bit_diameter is wrong"
                )
                self._begin(frame, "radius_scale", frame.source, text)

    def _take_channels(self, frame: Frame, settings: WatchedCaliper, watch: CaliperWatch) -> None:
        assert frame.radius is not None
        assert frame.sensor is not None
        many, depth, begins = settings.sensors >= 2, self._depths(frame, settings), False
        for sensor in distinct(frame.sensor).tolist() if many else [0]:
            channel = watch.channels.setdefault(sensor, WatchedChannel())
            of = (frame.sensor == sensor) | (not many)
            begins |= channel.take(frame.radius[of], depth[of]) > 0
        stuck = {sensor: channel for sensor, channel in sorted(watch.channels.items()) if channel.lasts}
        if begins:
            numbers = ", ".join(str(sensor + 1) for sensor in stuck)
            which = "caliper" if not many else "all radii" if len(stuck) == settings.sensors else f"radius {numbers}"
            since = min((of.since for of in stuck.values() if of.since == of.since), default=math.nan)
            values = ", ".join(f"{1e3 * of.value:.2f}" for of in stuck.values())
            times = min(of.equal for of in stuck.values())
            text = (
                f"{which} constant{f' since {since:.0f} m' if since == since else ''}: {values} mm, {times} times in a "
            )
            text += "row: stuck, or a channel with few digits (caliper.radius)"
            self._begin(frame, "stays", frame.source, text)
        elif not stuck:
            self.active.pop(("stays", frame.source), None)

    def _take_sensors(self, frame: Frame, settings: WatchedCaliper, watch: CaliperWatch) -> None:
        """Compare the medians of SENSORS samples of each sensor: while the string turns, all see the same wall."""
        assert frame.radius is not None
        assert frame.toolface is not None
        assert frame.sensor is not None
        watch.directions.append(math.radians(float(frame.toolface[0])))
        for sensor, radius in zip(frame.sensor.tolist(), frame.radius.tolist(), strict=True):
            values = watch.sensors.setdefault(sensor, [])
            if len(values) < SENSORS:
                values.append(radius)
        if len(watch.sensors) < settings.sensors or min(map(len, watch.sensors.values())) < SENSORS:
            return
        medians = {sensor: statistics.median(values) for sensor, values in sorted(watch.sensors.items())}
        # The error of a median is 1.25 times that of a mean, and the others' median has one, too.
        error = 1.8 * statistics.median(map(statistics.pstdev, watch.sensors.values())) / math.sqrt(SENSORS)
        limit = max(LEAST_OFF, ERRORS * error)
        one_way = (abs(np.exp(1j * np.outer((1, 2, 3), np.array(watch.directions))).mean(axis=1)) > ONE_WAY).any()
        watch.sensors = {}
        watch.directions.clear()
        if one_way:
            return
        key = "sensors", frame.source
        odd, text = -1, ""
        for sensor, median in medians.items():
            others = [other for one, other in medians.items() if one != sensor]
            middle = statistics.median(others)
            if abs(median - middle) > limit and max(others) - min(others) <= limit / 2:
                odd = sensor
                text = (
                    f"radius {sensor + 1} has the median {1e3 * median:.1f} mm of {SENSORS} samples while the string "
                    f"turns, the others {1e3 * middle:.1f} mm: a sensor that is stuck, worn or not calibrated, or not "
                    "one of this tool (caliper.radius)"
                )
        if odd >= 0 and odd != watch.odd:
            self._begin(frame, *key, text)
        elif odd < 0:
            self.active.pop(key, None)
        watch.odd = odd

    def _take_toolface(self, frame: Frame, watch: CaliperWatch, rpm: float) -> None:
        """Take a toolface at most every TOOLFACE_SECONDS / TOOLFACES: while the string turns, they must not stay."""
        assert frame.toolface is not None
        since = (frame.time - watch.toolface_at) / SECOND if watch.toolface_at >= 0 else math.inf
        if since < TOOLFACE_SECONDS / TOOLFACES:
            return
        watch.toolface_at = frame.time
        turns = since * rpm / 60 if since < math.inf else 0.5
        if abs(turns - round(turns)) < 0.02:
            return  # sampled once in a whole number of turns, a toolface stays
        watch.toolfaces.append(math.radians(float(frame.toolface[0])))
        if len(watch.toolfaces) < TOOLFACES:
            return
        angles = np.array(watch.toolfaces)
        resultant = float(abs(np.exp(1j * angles).mean()))
        key = "toolface_stays", frame.source
        if resultant <= RESULTANT:
            watch.toolface_lasts = False
            self.active.pop(key, None)
        elif not watch.toolface_lasts:
            watch.toolface_lasts = True
            middle = float(np.degrees(np.angle(np.exp(1j * angles).mean())))
            around = np.degrees(np.angle(np.exp(1j * (angles - math.radians(middle)))))
            span = float(around.max() - around.min())
            unit = "radians" if 4 < span <= 6.4 else "tens of degrees" if 25 < span <= 36.5 else ""
            seems = f"it seems that they are {unit} (toolface_unit)"
            cause = (
                seems if unit else "the toolface is stuck (caliper.toolface), or the rotation is wrong (items.rotation)"
            )
            text = (
                f"{TOOLFACES} toolfaces lie within {span:.3g} deg around {middle % 360:.3g} deg, although the string "
                f"turns with {rpm:.0f} rpm: {cause}"
            )
            self._begin(frame, *key, text)

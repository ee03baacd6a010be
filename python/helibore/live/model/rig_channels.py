"""The channels of the rig that are shown: the latest value, the values by time and by depth, alarms low and high.

    frames of all sources, in the order of the journal -> latest value of each channel -> below low or above high: event
                                     '-> means of 10 s, a day of them           '-> means of 0.1 m of new hole

They change nothing in the wall. A replay gives the same values and events.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

import numpy as np

from helibore.base.arrays import Floats
from helibore.base.utc_time import SECOND
from helibore.live.model.growing_array import GrowingArray
from helibore.live.model.watch import Frame, Report
from helibore.live.rules.sources import RigShow, Source

TIME, TIMES = 10 * SECOND, 8640
"""Nanoseconds of a mean by time, and the number of means that are kept: a day of them."""
DEPTH = 0.1
"""Metres of a mean by depth."""
BACK = 60 * SECOND
"""Nanoseconds for which values must be within the limits until an alarm ends."""


class Means:
    """Means of values in steps of equal size; steps must not fall, and a value of an earlier step is left out."""

    STATE = ("_steps", "_means", "_step", "_sum", "_count")

    def __init__(self) -> None:
        self._steps, self._means = GrowingArray(np.int64), GrowingArray(np.float64)
        self._step, self._sum, self._count = -1, 0.0, 0

    def add(self, step: int, value: float, most: int = 0) -> None:
        """Add a value; if ``most`` is not 0, only so many means are kept."""
        if step < self._step:
            return
        if step > self._step:
            if self._count:
                self._steps.append(np.array([self._step]))
                self._means.append(np.array([self._sum / self._count]))
                if most and len(self._steps.values) > most:
                    self._steps.forget(1)
                    self._means.forget(1)
            self._step, self._sum, self._count = step, 0.0, 0
        self._sum, self._count = self._sum + value, self._count + 1

    def columns(self) -> tuple[Floats, Floats]:
        """Return the middles of the steps that have ended, as a number of steps, and their means."""
        means = self._means.values
        return self._steps.values[: len(means)] + 0.5, means.copy()


class RigChannel:
    """One channel.

    Attributes
    ----------
    name, source, shown
        Its name, the name of its source, its settings.
    value, time
        The latest value, NaN before the first one, and its model time, ns.
    """

    STATE = ("value", "time", "_by_time", "_by_depth", "_beyond", "_at")

    def __init__(self, name: str, source: str, shown: RigShow) -> None:
        self.name, self.source, self.shown = name, source, shown
        self.value, self.time = math.nan, -1
        self._by_time, self._by_depth = Means(), Means()
        self._beyond, self._at = "", -1

    @property
    def unit(self) -> str:
        """The unit of its values."""
        return self.shown.table.unit

    @property
    def limits(self) -> tuple[float, float] | None:
        """The values at the edges of its curve; None: round numbers around its values."""
        limits = self.shown.table.limits
        return (limits[0], limits[1]) if limits else None

    @property
    def beyond(self) -> str:
        """The alarm that lasts: "low", "high", or "" for none."""
        return self._beyond

    def by_time(self) -> tuple[Floats, Floats]:
        """Return the model times (s) and the values of the last day, means of 10 s."""
        steps, means = self._by_time.columns()
        return steps * (TIME / SECOND), means

    def by_depth(self) -> tuple[Floats, Floats]:
        """Return the depths (m) and the values while new hole was drilled, means of 0.1 m."""
        steps, means = self._by_depth.columns()
        return steps * DEPTH, means

    def take(self, time: int, value: float, new_hole: float) -> None:
        """Take a value; ``new_hole`` is the depth of the hole if the bit drills it, else NaN."""
        self.value, self.time = value, time
        self._by_time.add(time // TIME, value, TIMES)
        if new_hole == new_hole:
            self._by_depth.add(math.floor(new_hole / DEPTH + 1e-6), value)

    def judge(self, time: int) -> tuple[str, str, bool]:
        """Compare the latest value with the limits; return rule, text and whether the alarm begins now."""
        limits, value = self.shown.table, self.value
        for rule, limit, beyond in (("low", limits.low, -1), ("high", limits.high, 1)):
            if limit is not None and beyond * (value - limit) > 0:
                begins, self._beyond, self._at = self._beyond != rule, rule, time
                unit = f" {self.unit}" if self.unit else ""
                word = "below" if rule == "low" else "above"
                return rule, f"{self.name} is {value:g}{unit}, {word} {rule} = {limit:g}{unit}", begins
        if self._beyond and time - self._at < BACK:
            return self._beyond, "", False
        self._beyond = ""
        return "", "", False


class RigChannels:
    """All channels of the rig, by their names.

    Attributes
    ----------
    active
        The text of each alarm that lasts, by rule and "source CHANNEL".
    """

    STATE = ("by_name", "active", "_bit", "_hole")

    def __init__(self, report: Report) -> None:
        self._report = report
        self.by_name: dict[str, RigChannel] = {}
        self.active: dict[tuple[str, str], str] = {}
        self._bit = self._hole = math.nan

    def use(self, sources: Mapping[str, Source], on_bottom: float) -> None:
        """Use these sources and the limit of ``[passes]`` from now on; a channel keeps its values."""
        before, self._on_bottom = self.by_name, on_bottom
        self.by_name = {}
        for source in sources.values():
            for name, shown in source.shown.items():
                channel = self.by_name[name] = before.get(name) or RigChannel(name, source.name, shown)
                channel.source, channel.shown = source.name, shown
        names = {f"{one.source} {one.name}" for one in self.by_name.values()}
        self.active = {key: text for key, text in self.active.items() if key[1] in names}

    def take(self, frames: Iterable[Frame]) -> None:
        """Take frames in the order of the journal."""
        for frame in frames:
            if (hole := frame.rig.get("hole_depth", math.nan)) == hole:
                self._hole = hole
            if (bit := frame.rig.get("bit_depth", math.nan)) == bit:
                self._bit = bit
            bottom = self._bit if self._hole != self._hole else self._hole
            new_hole = bottom if bottom - self._bit <= self._on_bottom else math.nan
            for name, value in frame.shown.items():
                self._take(self.by_name[name], frame, value, new_hole)

    def _take(self, channel: RigChannel, frame: Frame, value: float, new_hole: float) -> None:
        channel.take(frame.time, value, new_hole)
        place = f"{channel.source} {channel.name}"
        rule, text, begins = channel.judge(frame.time)
        for other in ("low", "high"):
            if other != rule:
                self.active.pop((other, place), None)
        if text:
            self.active[rule, place] = text
        if begins:
            self._report(frame.wall, rule, place, text)

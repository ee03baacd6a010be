"""A rig that drills, connects, slides, reams, surveys and trips, frame by frame; its tool may be wrong."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from helibore.base.utc_time import SECOND
from helibore.live.model.watch import Frame, Watch, WatchedCaliper
from helibore.live.rules.pass_rules import PassRules

BIT = 0.108


@dataclass
class Moment:
    """The state of the rig at one time; ``samples`` are (sensor, toolface deg, radius m)."""

    time: float
    bit: float
    hole: float
    rpm: float
    samples: list[tuple[int, float, float]] = field(default_factory=list)


@dataclass
class Operations:
    """How the rig works: seconds between frames and between samples, and what it does.

    A tool with a sample every second is wired: it needs no mud pulses, so it also sends while the pumps are off.
    """

    seed: int = 1
    every: float = 5.0
    sample_every: float = 17.0
    sensors: int = 1
    rounding: float = 0.0
    exact_rpm: bool = False
    trips: bool = True
    tally: float = 0.3

    def run(self, hours: float) -> Iterator[Moment]:
        """Yield a moment for each frame."""
        draw = np.random.default_rng(self.seed)
        time = bit = 0.0
        bit = hole = 2000.0
        next_sample = 0.0
        turned = 0.0
        for phase, seconds, rate, rpm, sampling in self._phases(draw):
            end = time + seconds
            speed = 0.0
            while time < end:
                step = self.every * (1 + 0.02 * draw.standard_normal())
                time += step
                goal = rate * (1 + 0.1 * draw.standard_normal())
                speed += float(np.clip(goal - speed, -0.25 * step, 0.25 * step))
                bit = min(bit + speed * step, hole) if phase != "drill" else bit + abs(rate) * step
                if phase == "bottom":
                    bit = min(bit + 0.3 * step, hole)
                if phase == "tally":
                    bit, hole = bit + rate / 10, hole + rate / 10
                hole = max(hole, bit)
                now = 0.0 if rpm == 0 else 120.0 if self.exact_rpm else rpm + float(draw.normal(0, 1.5))
                turned += 6 * now * step
                moment = Moment(time, round(bit, 2), round(hole, 2), round(now))
                while (sampling or self.sample_every < 2) and next_sample <= time:
                    gap = self.sample_every * (1 + 0.1 * abs(draw.standard_normal()))
                    next_sample = max(next_sample, time - step) + gap
                    for sensor in range(self.sensors):
                        radius = BIT + 0.002 * float(draw.standard_normal()) + 0.001
                        if self.rounding:
                            radius = round(radius / self.rounding) * self.rounding
                        toolface = (turned + 360 * sensor / self.sensors + 3 * draw.standard_normal()) % 360
                        moment.samples.append((sensor, float(toolface), radius))
                yield moment
                if time > 3600 * hours:
                    return

    def _phases(self, draw: np.random.Generator) -> Iterator[tuple[str, float, float, float, bool]]:
        """Yield kind, seconds, speed (m/s; down is positive), rpm, and whether the tool sends."""
        stands = 0
        while True:
            rate = draw.uniform(8, 40) / 3600
            left = 27 / rate
            while left > 0:
                part = min(left, draw.uniform(300, 2400))
                left -= part
                kind = draw.integers(6)
                if kind == 0:  # a slide, with the string rocked
                    yield "drill", part / 2, rate, 0.0, True
                    yield "drill", part / 2, rate, 35.0, True
                elif kind == 1:  # a downlink
                    yield "drill", draw.uniform(60, 303), rate, 110.0, False
                    yield "drill", part, rate, 110.0, True
                else:
                    yield "drill", part, rate, draw.uniform(60, 160), True
            if draw.integers(4) == 0:  # ream the stand
                yield "up", draw.uniform(60, 130), -0.2, 80.0, True
                yield "down", draw.uniform(60, 130), 0.2, 80.0, True
            yield "up", 20, -0.3, 0.0, False  # a connection, a survey
            yield "stand", draw.uniform(120, 900), 0.0, 0.0, False
            if draw.integers(20) == 0:
                yield "tally", 4 * self.every, self.tally * draw.choice([-1, 1]), 0.0, False
            yield "bottom", 60, 0.3, draw.uniform(40, 100), False
            yield "drill", draw.uniform(60, 303), rate, 110.0, False  # synchronisation after the pumps
            yield "drill", 120, rate, 110.0, True
            stands += 1
            if self.trips and stands % 30 == 0:
                yield "up", 6 * 3600, -0.2, 0.0, False
                yield "stand", 7200, 0.0, 0.0, False
                yield "down", 6 * 3600, 0.2, 0.0, False
                yield "bottom", 600, 0.3, 60.0, False


def frames(moments: Iterator[Moment]) -> Iterator[Frame]:
    """The frames of the source ``mwd`` that carry the moments."""
    for number, moment in enumerate(moments):
        rig = {"bit_depth": moment.bit, "hole_depth": moment.hole, "rotation": moment.rpm}
        rig = {name: value for name, value in rig.items() if value == value}
        frame = Frame(number, int(moment.time * SECOND), int(moment.time * SECOND), "mwd", rig)
        if moment.samples:
            sensor, toolface, radius = zip(*moment.samples, strict=True)
            frame.sensor, frame.toolface, frame.radius = np.array(sensor), np.array(toolface), np.array(radius)
            frame.depth = np.full(len(sensor), np.nan)
        yield frame


def watched(moments: Iterator[Moment], sensors: int = 0, window: int = 1) -> tuple[list[tuple[float, str, str]], Watch]:
    """Return (seconds, rule, text) of each event, and the watch at the end; frames come in windows of some size."""
    found: list[tuple[float, str, str]] = []
    watch = Watch(lambda wall, rule, _, text: found.append((wall / SECOND, rule, text)))
    watch.use({"mwd": WatchedCaliper(BIT, 12.0, sensors)}, {}, PassRules(), 100.0)
    some: list[Frame] = []
    for frame in frames(moments):
        some.append(frame)
        if len(some) == window:
            watch.take(some)
            some = []
    watch.take(some)
    return found, watch


def changed(moments: Iterator[Moment], after: float, change: Callable[[Moment], Moment]) -> Iterator[Moment]:
    """Apply ``change`` to every moment from ``after`` seconds on."""
    for moment in moments:
        yield change(moment) if moment.time >= after else moment


def with_samples(moment: Moment, change: Callable[[int, float, float], tuple[int, float, float]]) -> Moment:
    """Change every sample of a moment."""
    return replace(moment, samples=[change(*sample) for sample in moment.samples])

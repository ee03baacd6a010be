"""Configurations, a clock that a test sets, and a played run, for the tests of the live wall."""

from __future__ import annotations

import re

import numpy as np
import pytest

import helibore as hb
from helibore import Live
from helibore.base.errors import InputError
from helibore.live.rules.configuration import parse
from helibore.live.wire import wits
from helibore.simulation.tool import Hole, Lift, Tool, simulate

SECOND = 1_000_000_000


WALL = "[wall]\nbit_diameter = 0.216\nstart_depth = 100.0\nsectors = 16\nthreads = 1\n"


SENT = (
    WALL + '[source.mwd]\naddress = "host"\nunits = "metric"\n'
    'caliper = { first = "5010", groups = 3, order = ["toolface", "depth", "radius"] }\n'
    'survey = {}\nimage.GR = { first = "5110", count = 4, unit = "gAPI", depth = "0821",'
    ' origin = "edge", reference = "high-side", toolface_offset = 30.0 }\n'
)


CHANGED = SENT.replace("order =", "toolface_offset = 90.0, order =") + (
    '[source.alpha]\naddress = "host"\nunits = "fps"\n'
)


FROM_BIT = (
    WALL + '[source.rig]\naddress = "host"\nunits = "metric"\n'
    'items = { bit_depth = "0108", hole_depth = "0110", rotation = "0120", activity = "0107" }\n'
    '[source.mwd]\naddress = "host"\nunits = "metric"\n'
    'caliper = { toolface = ["5010"], radius = ["5012"], offset = 10.0, latency = LATENCY }\n'
)


def refused(text: str) -> tuple[str, str, str | None]:
    """Place without the line, rule and value of the error of a configuration."""
    with pytest.raises(InputError) as caught:
        parse(text)
    place = re.fullmatch(r"configuration(?:, line \d+)?(?:: (.*))?", caught.value.place, re.DOTALL)
    assert place is not None
    return place[1] or "", caught.value.rule, caught.value.value


class Clock:
    """A clock the test sets: wall and monotonic ns."""

    def __init__(self) -> None:
        self.wall, self.monotonic = 1_700_000_000 * SECOND, 5 * SECOND

    def __call__(self) -> tuple[int, int]:
        return self.wall, self.monotonic

    def step(self, seconds: float) -> None:
        self.wall += int(seconds * SECOND)
        self.monotonic += int(seconds * SECOND)


def small_run(samples=600):
    """Samples of a tool that is lifted once, and their frames of three triples."""
    tool = Tool(lifts=(Lift(103.0, 2.0),), noise=0.001)
    run = simulate(Hole.example(start=100.0, stop=105.0, seed=4), tool, samples=samples, seed=4)
    frames = []
    for i in range(0, samples, 3):
        items = []
        for j in range(3):
            row = (run.toolface[i + j], run.depth[i + j], 1000 * run.radius[i + j])
            items += [(5010 + 3 * j + k, f"{value:.4f}") for k, value in enumerate(row)]
        frames.append(wits.frame([(5004, str(i // 3)), *items]))
    return run, frames


RUN, FRAMES = small_run()


def sent_rows():
    """What the frames say, read by the slow way: (n, 3) toolface, depth, radius."""
    rows = []
    for frame in FRAMES:
        values = [float(line[4:]) for line in frame.decode().split("\r\n")[2:-2]]
        rows += [values[i : i + 3] for i in range(0, 9, 3)]
    return np.array(rows) * [1.0, 1.0, 0.001]


def batch_wall(frame_times):
    """The reconstruction of what the frames say; frame i came ``frame_times[i]`` ns after the start."""
    toolface, depth, radius = sent_rows().T
    caliper = hb.Caliper(depth, toolface, radius, np.repeat(np.array(frame_times) / SECOND, 3))
    return hb.reconstruct(caliper, bit_diameter=0.216, start_depth=100.0, sectors=16)


def same_bits(a, b) -> bool:
    names = ("radius", "nearest", "support", "iterations", "depth", "toolface")
    return all(np.array_equal(getattr(a, n), getattr(b, n), equal_nan=True) for n in names) and len(a) > 0


def from_bit(latency=0.0, clock=None):
    return Live(parse(FROM_BIT.replace("LATENCY", str(latency))), clock=clock or Clock())


def rig(live, depth, hole=None, rpm=60, activity=None):
    items = [(108, f"{depth:.3f}"), (110, f"{hole if hole is not None else depth:.3f}"), (120, str(rpm))]
    live.receive("rig", wits.frame(items + ([(107, str(activity))] if activity is not None else [])))


def sample(live, toolface=30.0, radius=110.0):
    return live.receive("mwd", wits.frame([(5010, f"{toolface:.2f}"), (5012, f"{radius:.2f}")]))


def rules(live) -> list[str]:
    """The rules of the events since the last poll."""
    return [event.rule for event in live.poll().events]


def station(depth, inclination, azimuth):
    return wits.frame([(708, str(depth)), (713, str(inclination)), (715, str(azimuth))])


def write_two_sessions(path, clock):
    """Write a journal in segments of 40 frames; the second session is of `CHANGED`, with one source more."""
    for text, frames in ((SENT, FRAMES[:80]), (CHANGED, FRAMES[80:])):
        with Live(parse(text), path, clock=clock) as live:
            assert live.journal is not None
            live.journal._segment_bytes = 12_000
            for frame in frames:
                clock.step(1)
                live.receive("mwd", frame)
                if live.checkpoint_due:
                    live.checkpoint()
        clock.step(60)

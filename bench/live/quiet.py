"""Count false alarms of what is plausible and wrong: ``python -m bench.live.quiet --days 150 --wired 30``.

A simulated rig drills, connects, slides, rocks, reams, surveys, downlinks, trips, and corrects its tally by 0.3 m; its
hole has relief, washes out, creeps by up to 3 mm, and is opened by an under-reamer in each third run. Its WITS frames
pass through the whole model (parser, tracks, watch, walls) in windows of the journal. ``--days`` are with a sample each
8 to 60 s by mud pulse, ``--wired`` with one each second. Each run has a seed of its own from --seed on and other
operations. Every event of a rule that begins an alarm is printed; the exit code is 1 if there is one. A wall that grew
is a notice, and is counted apart.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np

from helibore.live.journal import journal
from helibore.live.live import RECORD
from helibore.live.model.model import Model
from helibore.live.rules.configuration import parse
from helibore.live.wire import wits

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "python" / "live"))
from watched_rig import BIT, Moment, Operations

DAY, SECOND, WINDOW = 86_400, 1_000_000_000, 8192
BEGAN = 1_700_000_000 * SECOND
OFFSET, TOP, STEP = 12.0, 1800.0, 0.1
QUIET = {"connected", "wall_farther", "depth_gap", "silence", "outside", "crowded", "depth_jump"}
"""Rules of events that begin no alarm of what is plausible and wrong."""
CONFIGURATION = """
[wall]
bit_diameter = 0.216
start_depth = 1980.0
sectors = 16
threads = 1
[samples]
most = 16
[source.mwd]
address = "host"
units = "metric"
items = { bit_depth = "0108", hole_depth = "0110", rotation = "0120" }
caliper = { toolface = ["5010"], radius = RADII, toolface_offset = TURNED, offset = 12.0 }
"""
TELEMETRY = (
    Operations(),
    Operations(rounding=0.001),
    Operations(sample_every=8.0),
    Operations(sample_every=60.0),
    Operations(exact_rpm=True),
)
WIRED = (
    Operations(every=1.0, sample_every=1.0),
    Operations(every=1.0, sample_every=1.0, rounding=0.001),
    Operations(every=1.0, sample_every=1.0, exact_rpm=True),
    Operations(every=1.0, sample_every=1.0, sensors=4),
)


class Hole:
    """A hole whose wall moves with time; places are counted in steps of STEP below TOP."""

    def __init__(self, seed: int, opened: bool) -> None:
        draw = np.random.default_rng(seed + 77)
        self._relief = np.clip(0.003 * _smooth(draw, 15), -0.001, None)
        self._washout = np.clip(0.012 * (_smooth(draw, 60) - 0.8), 0.0, 0.03)
        self._creep = np.clip(0.003 * (_smooth(draw, 200) - 0.7), 0.0, 0.003)
        self._drilled = np.full(len(self._relief), np.inf)
        self._opened = np.zeros(len(self._relief))
        self._opens, self._deepest = opened, 0
        self._draw = draw

    def follow(self, moment: Moment) -> None:
        """Let the bit, and an under-reamer while the string reams, pass the place of a moment."""
        at = max(int((moment.bit - TOP) / STEP), 3)
        if at > self._deepest:
            self._drilled[self._deepest or at : at] = moment.time
            self._deepest = at
        elif self._opens and moment.rpm > 70 and moment.hole - moment.bit > 1:
            self._opened[at - 2 : at + 3] = 0.015

    def radius(self, moment: Moment, toolface: float, noise: float) -> float:
        """The radius where the tool is, metres."""
        at = max(int((moment.bit - OFFSET - TOP) / STEP), 0)
        age = max(moment.time - self._drilled[at], 0.0)
        moved = (self._washout[at] - self._creep[at]) * (1 - np.exp(-age / (2 * DAY))) + self._opened[at]
        return float(BIT + 0.001 + self._relief[at] + moved + 0.002 * np.cos(np.radians(2 * toolface)) + noise)


def _smooth(draw: np.random.Generator, width: int, count: int = 120_000) -> np.ndarray:
    kernel = np.exp(-0.5 * (np.arange(-4 * width, 4 * width + 1) / width) ** 2)
    noise = np.convolve(draw.standard_normal(count), kernel, "same")
    return noise / noise.std()


def play(operations: Operations, days: float, opened: bool) -> tuple[Model, float]:
    """Play days of a rig; return the model and the metres drilled."""
    sensors = operations.sensors
    radii = [f"50{12 + number}" for number in range(sensors)]
    turned = [360 * number // sensors for number in range(sensors)] if sensors > 1 else 0.0
    text = CONFIGURATION.replace("RADII", str(radii).replace("'", '"')).replace("TURNED", str(turned))
    model = Model(parse(text))
    hole, draw = Hole(operations.seed, opened), np.random.default_rng(operations.seed + 5)
    times, payloads = [0], [b"{}"]
    sequence = 0

    def flush(kind: int = journal.BYTES, source: int = 1) -> None:
        nonlocal sequence
        records = np.zeros(len(times), RECORD)
        records["sequence"] = sequence + np.arange(len(times))
        records["monotonic"] = times
        records["wall"] = records["monotonic"] + BEGAN
        records["kind"], records["source"], records["connection"] = kind, source, source
        model.take(records, list(payloads))
        sequence += len(times)
        payloads.clear()
        times.clear()

    flush(journal.OPENED, 0)
    for made in operations.run(24 * days):
        moment = replace(made, bit=max(made.bit, 0.0))  # a trip ends at the surface
        hole.follow(moment)
        items = [(108, f"{moment.bit:.2f}"), (110, f"{moment.hole:.2f}"), (120, f"{moment.rpm:.0f}")]
        sent = moment.samples if moment.bit > OFFSET + 1 else []  # the tool sends nothing on the rig floor
        groups = [sent[at : at + sensors] for at in range(0, len(sent), sensors)]
        for number, group in enumerate(groups[:1] if operations.every < 2 else groups):
            if number:
                items = []
            toolface = group[0][1]
            items.append((5010, f"{toolface:.1f}"))
            for one, (sensor, _, _) in enumerate(group):
                value = hole.radius(moment, toolface + 360 * sensor / sensors, 0.001 * float(draw.standard_normal()))
                digits = 0 if operations.rounding else 2
                items.append((5012 + one, f"{1000 * value:.{digits}f}"))
            payloads.append(wits.frame(items))
            times.append(int(moment.time * SECOND) + number)
        if not groups:
            payloads.append(wits.frame(items))
            times.append(int(moment.time * SECOND))
        if len(times) >= WINDOW:
            flush()
    flush()
    return model, moment.hole - 2000.0


def main() -> int:
    """Play all runs and print a line for each, and the totals."""
    options = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    options.add_argument("--days", type=float, default=150)
    options.add_argument("--wired", type=float, default=30)
    options.add_argument("--run", type=float, default=10, help="days of a run by mud pulse; a wired run has a third")
    options.add_argument("--seed", type=int, default=9100)
    given = options.parse_args()
    alarms: Counter[str] = Counter()
    notices, seed = 0, given.seed
    for name, kinds, days, long in (
        ("mud pulse", TELEMETRY, given.days, given.run),
        ("wired", WIRED, given.wired, given.run / 3),
    ):
        played = 0.0
        while played < days - 1e-6:
            part = min(long, days - played)
            operations = replace(kinds[seed % len(kinds)], seed=seed)
            began = time.process_time()
            model, metres = play(operations, part, seed % 3 == 0)
            counts = model.events.counts
            found = Counter({rule: count for (_, rule), count in counts.items() if rule not in QUIET})
            alarms += found
            notices += counts["mwd", "wall_farther"]
            played += part
            print(
                f"{name}, seed {seed}, day {played:.1f} of {days:g}: {metres:.0f} m, "
                f"{model.counts['received']:,} samples, wall_farther {counts['mwd', 'wall_farther']}, "
                f"alarms {dict(found) or 'none'}, {time.process_time() - began:.0f} s",
                flush=True,
            )
            for event in model.events.latest:
                if event.rule in found:
                    at = (event.newest.wall - BEGAN) / SECOND / 3600
                    print(f"    {event.rule}, {event.count} times, the last at {at:.2f} h: {event.newest.text}")
            seed += 1
    print(f"alarms {sum(alarms.values())}: {dict(alarms)}; notices of a wall that grew: {notices}")
    return int(bool(alarms))


if __name__ == "__main__":
    raise SystemExit(main())

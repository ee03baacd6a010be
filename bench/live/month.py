"""Play thirty days at a rig as fast as they can be read: ``python -m bench.live.month --days 30``.

Each second brings a rig frame of 34 items and a caliper frame, each tenth second an image row of 16 sectors. The tool
drills half of the time; in the other half it turns off bottom, at one depth. In the last --reamed days (a third of all)
the hole gets no deeper, and the string reams its lowest 10 m; memory must not grow then. Journal segments older than a
week are archived, as with ``keep_days = 7``. Each day's line shows depth, resident memory, journal, archive and
checkpoints. At the end a new process restarts from the checkpoint, and its wall must equal the live wall in every bit.
Unless --no-replay is given, a replay of the whole journal is compared in the same way.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from helibore import Live, _core
from helibore.live.journal import checkpoint, journal
from helibore.live.journal.archived_segments import archive
from helibore.live.rules.configuration import parse
from helibore.live.wire import wits

CONFIGURATION = """
[wall]
bit_diameter = 0.216
start_depth = 1000.0
threads = 1
[samples]
most = 16
image_step = 0.01
[source.rig]
address = "host"
units = "metric"
items = { bit_depth = "0108", hole_depth = "0110", rotation = "0120", activity = "0107" }
[source.mwd]
address = "host"
units = "metric"
caliper = { toolface = ["5010"], radius = ["5012"], offset = 12.0 }
[source.gamma]
address = "host"
units = "metric"
image.GR = { first = "5110", count = 16, unit = "gAPI", depth = "0821", origin = "edge", reference = "high-side" }
"""
DAY, HOUR = 86_400, 3600
SECOND = 1_000_000_000
RATE = 100 / (DAY / 2)
"""Metres a second while the tool drills, which is half of the time: 100 m a day."""


def restart(folder: str) -> None:
    """Open the journal in ``folder``; print as JSON the seconds taken, resident memory and a checksum of the wall."""
    began = time.perf_counter()
    with Live(parse(CONFIGURATION), folder) as live:
        seconds = time.perf_counter() - began
        print(json.dumps({"seconds": seconds, "resident": resident(), "wall": checksum(live)}))


def checksum(live: Live) -> int:
    """Return a checksum of all vertices and samples of a live wall."""
    found = 0
    for values in (live.wall.radius, live.wall.nearest, *live.wall._state().sample_columns):
        found = _core.crc32c(values.data, found)
    return found


def resident() -> float:
    """Return the resident memory of this process, MB."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


def main() -> None:
    """Play the days and print a line for each; then restart, replay and compare the walls."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--days", type=int, default=30)
    options.add_argument("--reamed", type=int, help="days of reaming after drilling; by default a third of all days")
    options.add_argument("--no-replay", action="store_true")
    options.add_argument("--restart", help=argparse.SUPPRESS)
    given = options.parse_args()
    if given.restart:
        restart(given.restart)
        return
    now = [1_700_000_000 * SECOND]
    quiet = [f"{100 + item:04d}{item * 1.5:.2f}" for item in range(30, 60)]
    rest = "\r\n".join(quiet)
    draw = np.random.default_rng(1)
    with tempfile.TemporaryDirectory() as folder:
        with Live(parse(CONFIGURATION), folder, clock=lambda: (now[0], now[0])) as live:
            hole = 1000.0
            drilled = (given.days - (given.days // 3 if given.reamed is None else given.reamed)) * DAY
            for second in range(given.days * DAY):
                drills = (second // HOUR) % 2 == 0 and second < drilled
                hole += RATE if drills else 0.0
                bit = hole - (0.0 if drills else 5.0)
                if second >= drilled:
                    bit = hole - 5.0 - abs(second % 1200 - 600) / 60
                if second % 60 == 0:
                    stored, noise = [], draw.normal(110, 1, 60).tolist()
                now[0] += SECOND
                angle, radius = f"{second * 137.3 % 360:.1f}", f"{noise[second % 60]:.3f}"
                rig = f"&&\r\n01072\r\n0108{bit:.3f}\r\n0110{hole:.3f}\r\n012060\r\n{rest}\r\n!!\r\n"
                frames = {"rig": rig.encode(), "mwd": f"&&\r\n5010{angle}\r\n5012{radius}\r\n!!\r\n".encode()}
                if second % 10 == 0:
                    values = [(5110 + sector, f"{50 + sector}") for sector in range(16)]
                    frames["gamma"] = wits.frame([(821, f"{bit - 15:.3f}"), *values])
                stored += [live.store(name, 1, frame, journal.BYTES) for name, frame in frames.items()]
                if second % 60 == 59:
                    live.draw(stored)
                    while (fit := live.fit()) is not None:
                        live.draw([live.store_fit(fit)])
                    if live.checkpoint_due:
                        live.checkpoint()
                        if len(checkpoint.paths(Path(folder))) == checkpoint.KEPT:
                            archive(Path(folder), before=now[0] - 7 * DAY * SECOND)
                if second % DAY == DAY - 1:
                    size = sum(path.stat().st_size for path in journal.paths(Path(folder))) / 1e6
                    packed = sum(path.stat().st_size for path in Path(folder).glob("archive/*")) / 1e6
                    points = sum(path.stat().st_size for path in checkpoint.paths(Path(folder))) / 1e6
                    print(
                        f"day {second // DAY + 1}: {hole:.0f} m, {live.wall.sample_count:,} samples, "
                        f"{live.model.counts['crowded']:,} not kept, {resident():.0f} MB resident, "
                        f"journal {size:.0f}, archive {packed:.0f}, checkpoints {points:.0f} MB",
                        flush=True,
                    )
            expected = checksum(live)
        again = [sys.executable, "-m", "bench.live.month", "--restart", folder]
        found = json.loads(subprocess.run(again, check=True, capture_output=True, text=True).stdout)
        assert found["wall"] == expected, "the restarted wall is not the live wall"
        print(f"restart: {found['seconds']:.1f} s, {found['resident']:.0f} MB resident, the same bits as live")
        if not given.no_replay:
            began = time.perf_counter()
            assert checksum(Live.replay(folder)) == expected, "the replayed wall is not the live wall"
            print(f"replay of the whole journal: {time.perf_counter() - began:.0f} s, the same bits as live")


if __name__ == "__main__":
    main()

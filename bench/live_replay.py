"""How fast a journal is replayed into a wall: ``python bench/live_replay.py --triples 10000000``.

The journal is written as it would be live, packets of up to 1,400 bytes; the replay is checked against what was sent.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time

import numpy as np

from helibore import Live
from helibore.live import wits
from helibore.live.configuration import parse
from helibore.live.journal import Journal

CONFIGURATION = """
[wall]
bit_diameter = 0.216
start_depth = 1000.0
[source.mwd]
address = "host"
units = "metric"
caliper = { first = "5010", groups = 30, order = ["toolface", "depth", "radius"] }
"""


def main() -> None:
    """Write, then replay."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--triples", type=int, default=1_000_000)
    count = options.parse_args().triples // 30 * 30
    draw = np.random.default_rng(1)
    with tempfile.TemporaryDirectory() as folder:
        opening = {"session": "bench", "configuration": CONFIGURATION}
        with Journal(folder, json.dumps(opening).encode()) as journal:
            for first in range(0, count, 30):
                k = np.arange(first, first + 30)
                rows = np.column_stack([k * 22.3 % 360, 1000 + k * 2e-4, draw.normal(110, 1, 30)]).ravel()
                frame = wits.frame((5010 + i, f"{value:.4f}") for i, value in enumerate(rows.tolist()))
                journal.append(1, 1, frame)
        start = time.perf_counter()
        live = Live.replay(folder, parse(CONFIGURATION))
        seconds = time.perf_counter() - start
        assert live.wall.sample_count == count == live.model.counts["drawn"]
        print(f"{count:,} triples in {seconds:.1f} s: {count / seconds:,.0f} triples/s, {len(live.wall):,} vertices")


if __name__ == "__main__":
    main()

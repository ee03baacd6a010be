"""Measure how fast a journal is replayed into a wall: ``python -m bench.live.replay --triples 10000000``.

The journal is written as it would be live, one record for each frame of 30 triples. Before anything is printed, the
replayed wall is compared with the batch reconstruction of its samples, bit for bit. The rates of the four quarters show
whether the cost grows with the journal.
"""

from __future__ import annotations

import argparse
import itertools
import json
import resource
import tempfile
import time
from pathlib import Path

import numpy as np

import helibore as hb
from helibore.live.journal.journal import Journal
from helibore.live.live import read_into
from helibore.live.model.model import Model
from helibore.live.rules.configuration import parse
from helibore.live.wire import wits

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
    """Write a journal, replay it, compare the walls, and print the rates."""
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
        model = Model(parse(CONFIGURATION))
        marks = [(0, time.perf_counter())]
        for _ in read_into(model, Path(folder)):
            marks.append((model.layers["main"].sample_count, time.perf_counter()))
    wall, seconds = model.layers["main"], marks[-1][1] - marks[0][1]
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    assert wall.sample_count == count == model.counts["drawn"]
    batch = hb.reconstruct(wall.samples, bit_diameter=0.216, start_depth=1000.0, estimator="inverse-distance")
    assert np.array_equal(batch.radius, wall.radius, equal_nan=True), "the replayed wall is not the batch wall"
    quarters = [marks[i * (len(marks) - 1) // 4] for i in range(5)]
    rates = [f"{(b - a) / (end - begin):,.0f}" for (a, begin), (b, end) in itertools.pairwise(quarters)]
    print(f"{count:,} triples in {seconds:.1f} s: {count / seconds:,.0f} triples/s, {len(wall):,} vertices as in batch")
    print(f"by quarters {', '.join(rates)}; at most {peak:.0f} MB")


if __name__ == "__main__":
    main()

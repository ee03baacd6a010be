"""Append survey stations one by one to `hb.Live`, with and without a journal: ``python -m bench.live.stations``.

The command prints the processor seconds for 10,000 stations, after it has compared the path with that of all stations.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

import helibore as hb
from helibore.live.rules.configuration import parse

CONFIGURATION = """
[wall]
bit_diameter = 0.216
start_depth = 0.0
threads = 1
[source.mwd]
address = "host"
units = "metric"
"""
COUNT = 10_000


@contextmanager
def opened(journal: bool) -> Iterator[hb.Live]:
    """Yield an open live wall, with or without a journal."""
    with tempfile.TemporaryDirectory() as folder, hb.Live(parse(CONFIGURATION), folder if journal else None) as live:
        yield live


def main() -> None:
    """Append the stations, compare the path, and print the time."""
    depth, draw = np.arange(COUNT) * 1.0, np.random.default_rng(1)
    inclination, azimuth = draw.uniform(0, 90, COUNT), draw.uniform(0, 360, COUNT)
    columns = [column.reshape(-1, 1).tolist() for column in (depth, inclination, azimuth)]
    for journal in (True, False):
        with opened(journal) as live:
            began = time.process_time()
            for station in zip(*columns, strict=True):
                live.append_stations(*station)
            seconds = time.process_time() - began
            expected = hb.Survey(depth, inclination, azimuth).path(extend=100.0)
            at = np.linspace(0, COUNT - 1, 997)
            assert live.path is not None
            assert np.array_equal(live.path.position(at), expected.position(at))
        print(f"{COUNT:,} stations {'with' if journal else 'without'} a journal: {seconds:.2f} s of processor time")


if __name__ == "__main__":
    main()

"""Measure how fast the WITS parser reads, MB in a second of processor time: ``python -m bench.live.wits``.

There are two streams: rig frames of 40 items, and caliper frames of 30 triples. The number of items is checked first.
"""

from __future__ import annotations

import time

import numpy as np

from helibore.live.wire import wits


def rig_frames(count: int) -> bytes:
    values = np.random.default_rng(1).uniform(0, 5000, (count, 40))
    return b"".join(wits.frame((108 + i, f"{v:.2f}") for i, v in enumerate(row)) for row in values)


def caliper_frames(count: int) -> bytes:
    values = np.random.default_rng(2).uniform(0, 360, (count, 90))
    return b"".join(wits.frame((5010 + i, f"{v:.3f}") for i, v in enumerate(row)) for row in values)


def measure(name: str, stream: bytes, items: int, chunk: int = 65536) -> None:
    chunks = [stream[i : i + chunk] for i in range(0, len(stream), chunk)]
    parser = wits.Parser()
    assert sum(len(parser.feed(c).items) for c in chunks) == items
    best = float("inf")
    for _ in range(15):
        parser = wits.Parser()
        start = time.process_time()
        for c in chunks:
            parser.feed(c)
        best = min(best, time.process_time() - start)
    print(f"{name}: {len(stream) / best / 1e6:.0f} MB/s, {items / best / 1e6:.1f} M items/s")


if __name__ == "__main__":
    measure("rig frames of 40 items", rig_frames(20_000), 800_000)
    measure("caliper frames of 30 triples", caliper_frames(10_000), 900_000)

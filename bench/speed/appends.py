"""Live use: the time of appends of 1,000 samples, at the end of a short and a long hole, and for a whole hole."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

import helibore as hb
from bench.measure import in_turn, milliseconds, ratio
from bench.speed.reconstruction import BIT_DIAMETER, PITCH, SECTORS, reconstruct, samples

BATCH = 1000


def latency(length: float, appends: int = 1000, samples_a_metre: int = 1000) -> dict[str, Any]:
    """Return percentiles of the time of an append at the end of a hole ``length`` metres long."""
    count = int(length * samples_a_metre)
    vertices = int((length + appends * BATCH / samples_a_metre) * SECTORS / PITCH)
    depth, toolface, radius, _ = samples(count + appends * BATCH, vertices, "as recorded")
    wall = hb.Wall(bit_diameter=BIT_DIAMETER, sectors=SECTORS, pitch=PITCH, estimator="inverse-distance")
    wall.append(depth[:count], toolface[:count], radius[:count])
    seconds = []
    for first in range(count, count + appends * BATCH, BATCH):
        part = slice(first, first + BATCH)
        start = time.perf_counter()
        wall.append(depth[part], toolface[part], radius[part])
        seconds.append(time.perf_counter() - start)
    whole = hb.reconstruct(
        hb.Caliper(depth, toolface, radius),
        bit_diameter=BIT_DIAMETER,
        sectors=SECTORS,
        pitch=PITCH,
        estimator="inverse-distance",
    )
    assert whole.radius.tobytes() == wall.radius.tobytes()
    p50, p99 = np.percentile(seconds, [50, 99]) * 1000
    return {
        "case": f"append of 1,000 at the end of {length:g} m",
        "p50 ms": p50,
        "p99 ms": p99,
        "most ms": max(seconds) * 1e3,
    }


def streaming(rounds: int = 15) -> dict[str, Any]:
    """Compare 2.4 M samples in appends of 1,000 with the same samples in one append, on all cores and on one."""
    data = samples(2_400_000, 262_144, "as recorded")

    def stream(threads: int | None = None) -> hb.Wall:
        depth, toolface, radius, _ = data
        wall = hb.Wall(bit_diameter=BIT_DIAMETER, sectors=SECTORS, pitch=PITCH, start_depth=0.0, threads=threads)
        for first in range(0, depth.size, BATCH):
            part = slice(first, first + BATCH)
            wall.append(depth[part], toolface[part], radius[part])
        return wall

    count = len(stream())
    assert stream().radius.tobytes() == reconstruct(data).radius[:count].tobytes()
    seconds = in_turn(
        {
            "streamed": stream,
            "batch": lambda: reconstruct(data),
            "streamed, one thread": lambda: stream(1),
            "batch, one thread": lambda: reconstruct(data, threads=1),
        },
        rounds,
    )
    return {
        "case": "2.4 M samples streamed in appends of 1,000",
        "milliseconds": {work: milliseconds(times) for work, times in seconds.items()},
        "streamed / batch": ratio(seconds["streamed"], seconds["batch"]),
        "streamed / batch, one thread": ratio(seconds["streamed, one thread"], seconds["batch, one thread"]),
    }


def cases() -> list[dict[str, Any]]:
    """Return the results for a short and a long hole, their ratio, and streaming."""
    short, long = latency(100.0), latency(10_000.0)
    return [short, long, {"case": "p50, 10 km / 100 m", "ratio": long["p50 ms"] / short["p50 ms"]}, streaming()]

"""Measure the cost of 10,000 to 10 million samples, compared with k-d trees and with copying as many bytes.

A wall must read 24 bytes a sample (depth, toolface, radius), and write 24 bytes a vertex (radius and nearest; support,
iterations and flags). ``copies`` is the time of a wall over that of a plain copy of as many bytes, in the same rounds;
it would be 1 if only the memory limited the speed.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from bench.measure import in_turn, milliseconds, ratio
from bench.speed.memory import measure_apart
from bench.speed.reconstruction import peers, reconstruct, samples

SIZES = (10_000, 100_000, 1_000_000, 10_000_000)
SAMPLES_A_VERTEX = 8
LARGEST_OF_PEERS = 1_000_000
"""Most samples for the k-d trees, since a tree of ten million takes most of the time and shows nothing new."""


def case(count: int, rounds: int) -> dict[str, Any]:
    """Return the results for ``count`` samples."""
    data = samples(count, count // SAMPLES_A_VERTEX, "as recorded")
    wall = reconstruct(data)
    at = (wall.depth, wall.toolface)
    source = np.ones(3 * count + 3 * len(wall))
    target = np.zeros_like(source)
    works: dict[str, Callable[[], object]] = {
        "helibore": lambda: reconstruct(data).radius,
        "copy": lambda: np.copyto(target[: source.size // 2], source[: source.size // 2]),  # reads half, writes half
    }
    if count <= LARGEST_OF_PEERS:
        works |= {name: lambda estimate=estimate: estimate(*data[:3], *at) for name, estimate in peers().items()}
    seconds = in_turn(works, rounds)
    rivals = [name for name in works if name not in ("helibore", "copy")]
    return {
        "case": f"{count:,} samples, {len(wall):,} vertices",
        "samples": count,
        "milliseconds": {work: milliseconds(times) for work, times in seconds.items()},
        "megabytes beyond input and output": 1e-6 * measure_apart(count, count // SAMPLES_A_VERTEX, "as recorded"),
        "copies": ratio(seconds["helibore"], seconds["copy"]),
        **{f"{rival} / helibore": ratio(seconds[rival], seconds["helibore"]) for rival in rivals},
    }


def cases(rounds: int = 5) -> list[dict[str, Any]]:
    """Return the results of all sizes."""
    return [case(count, rounds) for count in SIZES]

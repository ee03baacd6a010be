"""Compare kriging with inverse distance of the same number of neighbours, each without and with sigma; then time tune.

    python -m bench kriging

Each measurement builds a wall: of 1.2 M samples and 128 k vertices, or of four times as many. The time of `Wall.sigma`
includes its calibration, which takes no longer for a larger wall.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

import helibore as hb
from bench.measure import in_turn, milliseconds, ratio

SAMPLES, VERTICES, SECTORS, PITCH, BIT = 1_200_000, 131_072, 64, 0.1, 0.216


def _caliper(times: int = 1) -> hb.Caliper:
    random, count = np.random.default_rng(1), times * SAMPLES
    depth = np.sort(random.uniform(0.0, times * VERTICES * PITCH / SECTORS, count))
    toolface = random.uniform(0.0, 360.0, count)
    shape = 0.004 * np.cos(np.radians(2 * toolface)) * (np.sin(depth / 3) > 0.5)
    return hb.Caliper(depth, toolface, BIT / 2 + shape + random.normal(0.0, 5e-4, count))


def cases(rounds: int = 9) -> list[dict[str, Any]]:
    """Return the results for two sizes, on one thread and on all processors, and then the result of tune."""
    results: list[dict[str, Any]] = []
    for times, threads in ((1, 1), (1, None), (4, 1), (4, None)):
        caliper = _caliper(times)

        def build(
            sigma: bool = False, caliper: hb.Caliper = caliper, threads: int | None = threads, **settings: Any
        ) -> hb.Wall:
            return hb.reconstruct(caliper, bit_diameter=BIT, neighbors=16, threads=threads, sigma=sigma, **settings)

        assert np.isfinite(build(sigma=True, estimator="kriging").sigma).mean() > 0.9
        works: dict[str, Callable[[], object]] = {
            "inverse distance": build,
            "its sigma": lambda build=build: build(sigma=True).sigma,
            "kriging": lambda build=build: build(estimator="kriging"),
            "sigma": lambda build=build: build(sigma=True, estimator="kriging").sigma,
        }
        seconds = in_turn(works, rounds)
        results.append(
            {
                "case": f"{times * VERTICES:,} vertices, {'one thread' if threads else 'all processors'}",
                "kriging ms": milliseconds(seconds["kriging"]),
                "kriging over inverse distance": ratio(seconds["kriging"], seconds["inverse distance"]),
                "kriging over inverse distance at most": 2.0,
                "sigma on top of kriging": ratio(seconds["sigma"], seconds["kriging"]),
                "sigma on top of kriging at most": 1.4,
                "sigma on top of inverse distance": ratio(seconds["its sigma"], seconds["inverse distance"]),
            }
        )
    caliper, began = _caliper(), time.perf_counter()
    hb.tune(caliper, bit_diameter=BIT)
    results.append({"case": f"tune, {SAMPLES:,} samples", "s": time.perf_counter() - began, "s at most": 10.0})
    return results

"""Look for a setting or an order of samples with which helibore is slow: compare many cases with a k-d tree.

The peer is pykdtree on all cores, with a vectorised NumPy estimate from the same neighbours, which it weights once;
helibore iterates up to four times. A case has, unless it says otherwise, 1.2 M samples as recorded, 128 k vertices, 8
neighbours, power 1 and no window. Each case runs on the instruction set in use and on AVX2.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

import helibore as hb
from bench.measure import in_turn, milliseconds, ratio
from helibore.base.arrays import Floats

Samples = tuple[Floats, Floats, Floats]
BIT_DIAMETER, SECTORS, PITCH, VERTICES = 0.216, 64, 0.1, 131_072
LENGTH = (VERTICES - 1) * PITCH / SECTORS


def hole(count: int = 1_200_000, length: float = LENGTH, seed: int = 1) -> Samples:
    """Return samples spread evenly over the wall, sorted by depth."""
    random = np.random.default_rng(seed)
    depth, toolface = np.sort(random.uniform(0, length, count)), random.uniform(0, 360, count)
    return depth, toolface, _radius(depth, toolface)


def _radius(depth: Floats, toolface: Floats) -> Floats:
    noise = np.random.default_rng(2).normal(0, 0.0005, depth.size)
    return BIT_DIAMETER / 2 + 0.004 * np.sin(np.radians(2 * toolface)) * np.sin(depth) + noise


def arms(count: int, angles: int) -> Samples:
    """Return ``count`` samples of a tool that does not turn, at ``angles`` fixed toolfaces."""
    depth, toolface, _ = hole(count)
    toolface = np.floor(toolface * angles / 360) * (360 / angles) + 11.0
    return depth, toolface, _radius(depth, toolface)


def levels(count: int, depths: int) -> Samples:
    """Return ``count`` samples of a tool that turns at ``depths`` depths, and measures nothing between them."""
    _, toolface, _ = hole(count)
    depth = np.sort(np.floor(np.random.default_rng(3).uniform(0, depths, count))) * LENGTH / depths
    return depth, toolface, _radius(depth, toolface)


def crowd(count: int = 1_200_000) -> Samples:
    """Return ``count`` samples, half of which lie in one depth interval of 5 cm."""
    depth, toolface, _ = hole(count)
    depth[::2] = LENGTH / 2 + depth[::2] / LENGTH * 0.05
    depth.sort()
    return depth, toolface, _radius(depth, toolface)


# Samples and settings of each case.
CASES: dict[str, tuple[Callable[[], Samples], dict[str, Any]]] = {
    "base": (hole, {}),
    "2.4 M samples, 256 k vertices": (lambda: hole(2_400_000, 2 * LENGTH), {"stop_depth": 2 * LENGTH}),
    "240 k samples, 64 k vertices": (lambda: hole(240_000, LENGTH / 2), {"stop_depth": LENGTH / 2}),
    **{f"V = {v}": (hole, {"neighbors": v}) for v in (1, 4, 16, 32, 64, 128, 256)},
    **{f"power {power}": (hole, {"power": power}) for power in (0.5, 0.7, 3.3)},
    **{f"window {window}": (hole, {"window": window}) for window in (100, 1000)},
    "max_iterations 20, tolerance 0": (hole, {"max_iterations": 20, "tolerance": 0.0}),
    **{f"angular_scale {scale}": (hole, {"angular_scale": scale}) for scale in (0.25, 2.0, 32.0)},
    "four fixed arms, 600 k samples": (lambda: arms(600_000, 4), {}),
    "one fixed arm, 600 k samples": (lambda: arms(600_000, 1), {}),
    "50 depths of 12,000 samples": (lambda: levels(600_000, 50), {}),
    "half of all samples in 5 cm": (crowd, {}),
    "500 samples": (lambda: hole(500), {}),
}


def reconstruct(data: Samples, **settings: Any) -> hb.Wall:
    """Return the wall of these samples, rebuilt on all cores."""
    fixed = {"bit_diameter": BIT_DIAMETER, "sectors": SECTORS, "pitch": PITCH, "start_depth": 0.0, "stop_depth": LENGTH,
             "estimator": "inverse-distance"}  # fmt: skip
    return hb.reconstruct(hb.Caliper(*data), **{**fixed, **settings})


def peer(data: Samples, wall: hb.Wall, *, neighbors: int = 8, power: float = 1.0, angular_scale: float = 1.0) -> Floats:
    """Return radii by a k-d tree on the unrolled cylinder, weighted once; samples near 0 and 360 appear twice."""
    from pykdtree.kdtree import KDTree

    depth, toolface, radius = data
    metres = np.radians(1) * BIT_DIAMETER / 2 * angular_scale
    even = depth.size / (depth[-1] - depth[0]) / 360 / metres  # samples a square metre
    margin = min(180.0, 3 * np.sqrt(neighbors / even / np.pi) / metres) if depth.size > 500 else 180.0
    low, high = toolface < margin, toolface > 360 - margin
    around = np.concatenate([toolface, toolface[low] + 360, toolface[high] - 360]) * metres
    points = np.column_stack([around, np.concatenate([depth, depth[low], depth[high]])])
    values = np.concatenate([radius, radius[low], radius[high]])
    where = np.column_stack([wall.toolface * metres, wall.depth])
    distance, index = KDTree(points).query(where, k=neighbors)
    weight = distance**-power if power != 1.0 else 1 / distance
    if neighbors == 1:
        return np.asarray(values[index])
    weighted: Floats = (weight * values[index]).sum(1) / weight.sum(1)
    return weighted


def case(name: str, rounds: int) -> dict[str, Any]:
    """Return milliseconds of helibore and of the peer in the case ``name``, and their ratios."""
    make, settings = CASES[name]
    data = make()
    wall = reconstruct(data, **settings)
    of_peer = {key: settings[key] for key in ("neighbors", "power", "angular_scale") if key in settings}
    works: dict[str, Callable[[], object]] = {
        "helibore": lambda: reconstruct(data, **settings).radius,
        "helibore, AVX2": lambda: reconstruct(data, **settings, instruction_set="avx2").radius,
        "pykdtree": lambda: peer(data, wall, **of_peer),
    }
    seconds = in_turn(works, rounds)
    return {
        "case": name,
        "milliseconds": {work: milliseconds(times) for work, times in seconds.items()},
        **{f"pykdtree / {work}": ratio(seconds["pykdtree"], seconds[work]) for work in works if work != "pykdtree"},
    }


# Functions that return the toolfaces of ``count`` samples while the tool turns off bottom.
TOOLFACES: dict[str, Callable[[np.random.Generator, int], Floats]] = {
    "any toolface": lambda random, count: random.uniform(0, 360, count),
    "whole degrees": lambda random, count: np.floor(random.uniform(0, 360, count)),
    "four arms": lambda random, count: np.floor(random.uniform(0, 4, count)) * 90 + 11,
}


def turning_at_one_depth(
    toolfaces: str, samples: int = 1_200_000, appends: int = 300, batch: int = 1000
) -> dict[str, Any]:
    """Return the times of appends while the tool turns at one depth, and while it then drills on.

    Before the first of these appends, the wall holds ``samples`` samples at that depth.
    """
    random = np.random.default_rng(5)
    wall = hb.Wall(bit_diameter=BIT_DIAMETER, sectors=SECTORS, pitch=PITCH, start_depth=0.0)
    wall.append(*hole(100_000, 20.0))

    def some(count: int, low: float = 20.0, high: float = 20.0) -> Samples:
        depth, toolface = np.sort(random.uniform(low, high, count)), TOOLFACES[toolfaces](random, count)
        return depth, toolface, _radius(depth, toolface)

    def append(more: Samples) -> float:
        start = time.perf_counter()
        wall.append(*more)
        return time.perf_counter() - start

    for _ in range(samples // 100_000):
        wall.append(*some(100_000))
    turning = [append(some(batch)) for _ in range(appends)]
    drilling = [append(some(batch, 20 + i * 0.05, 20.05 + i * 0.05)) for i in range(100)]
    p50, p99 = np.percentile(turning, [50, 99]) * 1000
    return {
        "case": f"append of 1,000 after {samples:,} at one depth, {toolfaces}",
        "p50 ms": p50,
        "p99 ms": p99,
        "drilling on, p50 ms": np.median(drilling) * 1000,
        "drilling on, most ms": max(drilling) * 1000,
    }


def cases(rounds: int = 3) -> list[dict[str, Any]]:
    """Return the results of all cases, and of live appends at one depth."""
    return [*(case(name, rounds) for name in CASES), *map(turning_at_one_depth, TOOLFACES)]

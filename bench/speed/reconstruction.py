"""Compare rebuilding a wall from raw arrays, sorting included, with k-d trees and a vectorised NumPy estimate.

The peers find the 8 nearest neighbours on the unrolled cylinder, where samples near 0 and 360 appear twice, and weight
them once; helibore iterates up to four times. SciPy's and pykdtree's trees use all cores. Before anything is timed,
helibore with one iteration is checked against the peers, and with all its iterations against brute force.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import helibore as hb
from bench.measure import in_turn, milliseconds, ratio
from helibore.base.arrays import Floats

BIT_DIAMETER, SECTORS, PITCH, NEIGHBORS = 0.216, 64, 0.1, 8
CASES = {"2.4 M samples, 256 k vertices": (2_400_000, 262_144), "240 k samples, 64 k vertices": (240_000, 65_536)}


def samples(count: int, vertices: int, order: str, seed: int = 1) -> tuple[Floats, Floats, Floats, float]:
    """Return depth, toolface and radius of samples among ``vertices`` vertices, and the depth of the last vertex."""
    random = np.random.default_rng(seed)
    stop = (vertices - 1) * PITCH / SECTORS
    depth, toolface = random.uniform(0, stop, count), random.uniform(0, 360, count)
    if order == "as recorded":
        depth.sort()
    lobes = 0.004 * np.sin(np.radians(2 * toolface)) * np.sin(depth)
    return depth, toolface, BIT_DIAMETER / 2 + lobes + random.normal(0, 0.0005, count), stop


def kd_tree(make_tree: Callable[[Floats], Any], query: dict[str, Any]) -> Callable[..., Floats]:
    """Return a function that estimates radii, in one iteration, by a k-d tree on the unrolled cylinder."""

    def estimate(depth: Floats, toolface: Floats, radius: Floats, at_depth: Floats, at_toolface: Floats) -> Floats:
        metres = np.radians(1) * BIT_DIAMETER / 2
        around, turn = toolface * metres, 360 * metres
        margin = turn / 8  # far more than the distance to the eighth neighbour, as the assertion below checks
        low, high = around < margin, around > turn - margin
        points = np.concatenate(
            [
                np.column_stack([around, depth]),
                np.column_stack([around[low] + turn, depth[low]]),
                np.column_stack([around[high] - turn, depth[high]]),
            ]
        )
        values = np.concatenate([radius, radius[low], radius[high]])
        where = np.column_stack([at_toolface * metres, at_depth])
        distance, index = make_tree(points).query(where, k=NEIGHBORS, **query)
        assert distance.max() < margin
        weight = 1 / distance
        weighted: Floats = (weight * values[index]).sum(1) / weight.sum(1)
        return weighted

    return estimate


def peers() -> dict[str, Callable[..., Floats]]:
    """Return the peers by name: functions that estimate radii from samples at points."""
    from pykdtree.kdtree import KDTree
    from scipy.spatial import cKDTree

    return {"pykdtree": kd_tree(KDTree, {}), "scipy cKDTree": kd_tree(cKDTree, {"workers": -1})}


def brute_force(depth: Floats, toolface: Floats, radius: Floats, at_depth: float, at_toolface: float) -> float:
    """Return the radius at one vertex, computed literally as the method describes."""
    turn = (toolface - at_toolface + 180) % 360 - 180
    current = BIT_DIAMETER / 2
    for _ in range(4):
        distance = np.hypot(current * np.radians(turn), depth - at_depth)
        near = np.argsort(distance, kind="stable")[:NEIGHBORS]
        estimate = (radius[near] / distance[near]).sum() / (1 / distance[near]).sum()
        if abs(estimate - current) <= 1e-6:
            return float(estimate)
        current = estimate
    return float(current)


def reconstruct(data: tuple[Floats, Floats, Floats, float], **settings: Any) -> hb.Wall:
    """Return the wall of raw arrays; by default it is rebuilt on all cores."""
    depth, toolface, radius, stop = data
    fixed = {"bit_diameter": BIT_DIAMETER, "sectors": SECTORS, "pitch": PITCH, "start_depth": 0.0, "stop_depth": stop,
             "estimator": "inverse-distance"}  # fmt: skip
    return hb.reconstruct(hb.Caliper(depth, toolface, radius), **fixed, **settings)


def _check(data: tuple[Floats, Floats, Floats, float], peer: Callable[..., Floats]) -> None:
    once = reconstruct(data, max_iterations=1)
    assert np.abs(once.radius - peer(*data[:3], once.depth, once.toolface)).max() < 1e-12
    wall = reconstruct(data)
    depth, toolface, radius = wall.depth, wall.toolface, wall.radius
    for k in np.random.default_rng(2).integers(0, len(wall), 20):
        assert abs(radius[k] - brute_force(*data[:3], depth[k], toolface[k])) < 1e-12


def case(name: str, order: str, rounds: int) -> dict[str, Any]:
    """Return milliseconds of helibore and its peers on one set of samples, and their ratios."""
    data = samples(*CASES[name], order)
    rivals = peers()
    _check(data, rivals["pykdtree"])
    wall = reconstruct(data)
    at = (wall.depth, wall.toolface)
    works: dict[str, Callable[[], object]] = {
        "helibore": lambda: reconstruct(data).radius,
        "reading and sorting": lambda: reconstruct((*data[:3], 0.0)),
        **{rival: lambda estimate=estimate: estimate(*data[:3], *at) for rival, estimate in rivals.items()},
    }
    seconds = in_turn(works, rounds)
    return {
        "case": f"{name}, {order}",
        "milliseconds": {work: milliseconds(times) for work, times in seconds.items()},
        **{f"{rival} / helibore": ratio(seconds[rival], seconds["helibore"]) for rival in rivals},
    }


def cases(rounds: int = 7) -> list[dict[str, Any]]:
    """Return the results of both sizes, as recorded (by depth) and in random order."""
    return [case(name, order, rounds) for name in CASES for order in ("as recorded", "in random order")]

"""The spiral-profile method once more, by brute force: every vertex looks at every sample, with a stable sort.

Written from the method's text, not from the core; slow on purpose. `random_hole` makes the holes it is compared on.
"""

from __future__ import annotations

import re
from types import SimpleNamespace
from typing import Any

import numpy as np

import helibore as hb
from helibore.base.arrays import Floats, Rows

FIELDS = ("radius", "nearest", "support", "iterations")


def canonical(depth: Floats, toolface: Floats, radius: Floats, time: Floats | None = None) -> tuple[Floats, ...]:
    """Depth, toolface and radius in canonical order; rows equal in all four columns once, where there is a time."""
    toolface = np.mod(toolface, 360.0)
    if time is None:
        order = np.argsort(depth, kind="stable")
        return depth[order], toolface[order], radius[order]
    rows = np.unique(np.column_stack([depth, time, toolface, radius]), axis=0)  # sorted by these columns in turn
    return rows[:, 0], rows[:, 2], rows[:, 3]


def reference(
    depth: Floats,
    toolface: Floats,
    radius: Floats,
    time: Floats | None = None,
    *,
    bit_diameter: float,
    sectors: int = 64,
    pitch: float = 0.1,
    start_depth: float | None = None,
    stop_depth: float | None = None,
    start_toolface: float = 0.0,
    neighbors: int = 8,
    window: int | None = None,
    power: float = 1.0,
    max_distance: float | None = 1.0,
    max_iterations: int = 4,
    tolerance: float = 1e-6,
    angular_scale: float = 1.0,
    estimator: str = "inverse-distance",
    kriging_range: float = 0.0,
    nugget: float = 0.1,
    digits: int | None = None,
) -> SimpleNamespace:
    """Fields of the wall, as arrays. ``digits``: distances that agree when rounded to so many decimals are ties."""
    depth, toolface, radius = canonical(depth, toolface, radius, time)
    n = depth.size
    start = (depth[0] if pitch > 0 else depth[-1]) if start_depth is None else start_depth
    stop = (depth[-1] if pitch > 0 else depth[0]) if stop_depth is None else stop_depth
    count = int(np.floor(sectors * (stop - start) / pitch)) + 1
    wall = SimpleNamespace(
        depth=start + np.arange(count) * pitch / sectors,
        toolface=np.mod(start_toolface + np.arange(count) % sectors * 360.0 / sectors, 360.0),
        radius=np.full(count, np.nan),
        nearest=np.full(count, np.nan),
        support=np.zeros(count, np.int32),
        iterations=np.zeros(count, np.int32),
    )
    for k in range(count):
        first, last = 0, n
        if window is not None:
            upper_bound = int(np.sum(depth <= wall.depth[k]))
            first = max(0, min(upper_bound - window // 2, n - window))
            last = min(first + window, n)
        turn = np.radians((toolface[first:last] - wall.toolface[k] + 180.0) % 360.0 - 180.0)
        along = depth[first:last] - wall.depth[k]
        trial, before = bit_diameter / 2, np.inf
        for iteration in range(1, max_iterations + 1):
            wall.iterations[k] = iteration
            distance = np.hypot(angular_scale * trial * turn, along)
            order = np.argsort(distance if digits is None else np.round(distance, digits), kind="stable")
            if max_distance is not None:  # in metres on the wall, whatever the angular scale
                order = order[np.hypot(trial * turn, along)[order] <= max_distance]
            order = order[:neighbors]
            wall.support[k] = order.size
            if order.size == 0:
                wall.radius[k] = wall.nearest[k] = np.nan
                break
            d, r = distance[order], radius[first:last][order]
            wall.nearest[k] = d.min()
            weight = (d == 0).astype(float) if d.min() == 0 else (d.min() / d) ** power
            wall.radius[k] = np.sum(weight * r) / np.sum(weight)
            estimate = wall.radius[k]
            if estimator == "kriging":  # of the same neighbours; the iteration goes on with inverse distance
                near = (turn[order], along[order], r)
                wall.radius[k] = krige(*near, trial * angular_scale, kriging_range, nugget)
            if abs(estimate - trial) <= tolerance:
                break
            if abs(estimate - before) <= tolerance:  # it would swing for ever
                if estimator != "kriging":
                    wall.radius[k] = (estimate + trial) / 2
                break
            before, trial = trial, estimate
    return wall


def krige(turn: Floats, along: Floats, radius: Floats, scale: float, reach: float, nugget: float) -> float:
    """Ordinary kriging of one vertex by the bordered system of the textbooks; ``scale``: metres a radian."""
    reach = min(reach, np.pi * scale)

    def covariance(turn: Floats, along: Floats) -> Floats:
        around = (turn + np.pi) % (2 * np.pi) - np.pi
        q = np.minimum(np.hypot(scale * around, along) / reach, 1.0)
        return np.asarray((1 - q) ** 4 * (1 + 4 * q))

    n = radius.size
    system, right = np.ones((n + 1, n + 1)), np.ones(n + 1)
    system[:n, :n] = covariance(turn[:, None] - turn, along[:, None] - along) + nugget * np.eye(n)
    system[n, n] = 0.0
    right[:n] = covariance(turn, along)
    estimate = np.linalg.solve(system, right)[:n] @ radius
    half = (radius.max() - radius.min()) / 2
    return float(np.clip(estimate, radius.min() - half, radius.max() + half))


def random_hole(seed: int, shape: str, n: int, length: float, top: float = 1000.0) -> tuple[Floats, Floats, Floats]:
    """Depth, toolface and radius of ``n`` samples of a hole that is 'round', 'oval', 'spiral', 'washed' or 'broken'.

    The tool turns unevenly and sticks; a 'broken' hole lacks all samples of a tenth of its length.
    """
    rng = np.random.default_rng(seed)
    depth = top + np.sort(rng.uniform(0.0, length, n))
    toolface = np.cumsum(rng.gamma(0.7, 50.0, n)) % 360.0
    angle, down = np.radians(toolface), depth - top
    radius = 0.108 + 0.001 * rng.standard_normal(n)
    if shape == "oval":
        radius += 0.02 * np.cos(2 * (angle - 0.4))
    elif shape == "spiral":
        radius += 0.008 * np.cos(angle - 2 * np.pi * down / 0.9)
    elif shape == "washed":
        radius += 0.15 * np.exp(-(((down - length / 2) / (0.1 * length)) ** 2))
    elif shape == "broken":
        keep = abs(down - 0.6 * length) > 0.05 * length
        depth, toolface, radius = depth[keep], toolface[keep], radius[keep]
    return depth, toolface, radius


def bits(wall: hb.Wall) -> bytes:
    """Every bit a user can read from the wall."""
    fields = [getattr(wall, name).tobytes() for name in ("depth", "toolface", *FIELDS, "provisional")]
    return b"".join([*fields, str((len(wall), wall.settled, wall.sample_count)).encode()])


def bits_by_vertex(wall: Any) -> Rows:
    """(n,) one opaque value a vertex that is equal where depth and all fields are equal to the last bit."""
    columns = [wall.depth.view(np.int64), wall.radius.view(np.int64), wall.nearest.view(np.int64)]
    counts = [wall.support.astype(np.int64), wall.iterations.astype(np.int64), wall.provisional.astype(np.int64)]
    rows = np.column_stack([*columns, *counts])
    return np.ascontiguousarray(rows).view([("", np.int64)] * rows.shape[1]).reshape(-1)


def exactly(text: str) -> str:
    """The pattern that `pytest.raises` finds in this text only."""
    return f"^{re.escape(text)}$"


def instruction_sets() -> list[str]:
    """Those of this processor; the others are refused by name."""
    here = []
    for name in ("plain", "avx2", "avx512"):
        try:
            hb.Wall(bit_diameter=0.2, instruction_set=name)
        except hb.InputError as error:
            if error.rule != "this processor does not have it":
                raise
        else:
            here.append(name)
    return here

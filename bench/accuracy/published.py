"""Repeat the published experiment (Energies 2021, 14, 291, section 4.2) with its parameters, on a hole of known shape.

The experiment has 8 neighbours of a window of 100 samples, arcs stretched by a factor of 2, weights 1 / distance, and
390 points; a point that an estimate moves by at most 0.01 mm is settled. Its measurements are not public: 10 samples
and 4 mm a turn of an oval, rough hole of 11 cm radius take their place, which is our choice.
"""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import NamedTuple

import numpy as np

import helibore as hb
from helibore.base.arrays import Floats

POINTS, NEIGHBORS, WINDOW = 390, 8, 100
CHANGED = 1e-5  # metres
SETTINGS = {
    "bit_diameter": 0.22, "sectors": 30, "pitch": 0.004, "angular_scale": 2.0, "window": WINDOW, "tolerance": CHANGED,
}  # fmt: skip
OWN_CHANGES, OWN_DIFFERENCES = (15, 1, 0), (0.5, 0.7)  # of the publication: points; mm, with 4 and with 8 neighbours
OWN_SIMILARITY = (99.88, 97.8, 97.3)  # %, of the publication's table 1, with V1, the nearest sample


class Published(NamedTuple):
    """The results: distances (m) and weights of the neighbours by rank, changes by iteration, and similarities (%)."""

    distances: Floats  # (390, 8)
    contributions: Floats  # (390, 8), each row sums to 1
    changes: list[int]  # points that change by more than 0.01 mm after estimate 1, 2, 3
    differences: tuple[float, float]  # mm, greatest from the nearest sample, with 4 and with 8 neighbours
    with_nearest: tuple[float, ...]  # %, similarity of the wall, of 11 cm and of the mean of V2 to V7 with V1
    with_truth: dict[str, float]  # %, similarity with the true radius


def experiment(seed: int) -> Published:
    """Rebuild 390 points from samples of an oval, rough hole."""
    rng = np.random.default_rng([seed, 9])
    number = np.arange(10 * (POINTS // 30 + 12))
    depth, toolface = number * 0.0004, (number * 36.0 + rng.uniform(-12, 12, number.size)) % 360.0

    def truth(depth: Floats, toolface: Floats) -> Floats:
        angle = np.radians(toolface)
        return 0.11 + 0.003 * np.cos(2 * angle) + 0.001 * np.cos(7 * angle + 300 * depth)

    radius = truth(depth, toolface) + rng.normal(0, 3e-4, number.size)
    ends = {"start_depth": 0.02, "stop_depth": 0.02 + (POINTS - 1) * 0.004 / 30 + 1e-9}
    caliper = hb.Caliper(depth, toolface, radius)
    walls = [hb.reconstruct(caliper, **SETTINGS, **ends, max_iterations=most) for most in (1, 2, 3, 4)]
    wall = walls[-1]
    turn = np.abs((toolface - wall.toolface[:, None] + 180) % 360 - 180)
    distance = np.hypot(2 * np.radians(turn) * wall.radius[:, None], depth - wall.depth[:, None])
    low = np.clip(np.searchsorted(depth, wall.depth, "right") - WINDOW // 2, 0, number.size - WINDOW)[:, None]
    distance[(number < low) | (number >= low + WINDOW)] = np.inf
    nearest = np.argsort(distance, axis=1)[:, :NEIGHBORS]
    distances = np.take_along_axis(distance, nearest, axis=1)
    weights = 1 / np.maximum(distances, 1e-9)
    moved = [int(np.sum(np.abs(b.radius - a.radius) > CHANGED)) for a, b in itertools.pairwise(walls)]

    def similarity(at: Floats, of: Floats) -> float:
        return 100 * float(1 - np.mean(np.abs(at - of) / of))

    true, ranked = truth(wall.depth, wall.toolface), radius[nearest]
    by_four = hb.reconstruct(caliper, **SETTINGS, **ends, neighbors=4)
    alone = hb.reconstruct(caliper, **SETTINGS | {"sectors": 10, "pitch": 0.004}, start_depth=0.02)
    constant, first = np.full(POINTS, 0.11), ranked[:, 0]
    four, eight = (1e3 * float(np.abs(of.radius - first).max()) for of in (by_four, wall))
    with_nearest = tuple(similarity(of, first) for of in (wall.radius, constant, ranked[:, 1:7].mean(axis=1)))
    with_truth = {
        "the wall": similarity(wall.radius, true),
        "a constant 11 cm": similarity(constant, true),
        "the wall at ten points a turn": similarity(alone.radius, truth(alone.depth, alone.toolface)),
    }
    contributions = weights / weights.sum(axis=1, keepdims=True)
    return Published(distances, contributions, moved, (four, eight), with_nearest, with_truth)


def draw(of: Published, file: Path) -> None:
    """Draw distances and weights of the neighbours by rank."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 2, figsize=(8, 3), layout="constrained")
    rank = range(1, NEIGHBORS + 1)
    for panel, values, label in zip(axes, (1e3 * of.distances, 100 * of.contributions), ("distance, mm", "weight, %"),
                                    strict=True):  # fmt: skip
        panel.boxplot(values, positions=rank, whis=(0, 100))
        panel.set(xlabel="neighbour", ylabel=label)
    figure.savefig(file, dpi=110, metadata={"Software": None})
    plt.close(figure)

"""Holes whose true shape is known, for the evidence: five shapes, and six ways to sample them, all seeded."""

from __future__ import annotations

import numpy as np

import helibore as hb
from helibore.base.arrays import Floats

BIT = 0.216
LENGTH = 20.0
HOLES = ("breakout", "key seat", "ledges", "rough", "mixed")
ROTATING = ("64 a turn", "32 a turn", "16 a turn")
OTHERS = ("four arms", "stick-slip", "telemetry")


class Hole:
    """A hole of one of the kinds in `HOLES`; `radius` returns its true radius (m) at depths (m) and toolfaces (deg)."""

    def __init__(self, kind: str, seed: int) -> None:
        rng = np.random.default_rng([seed, 1])
        self.kind, self.direction = kind, rng.uniform(0, 360)
        self.waves = [_waves(rng, 6, 0.3, 3.0, 14), _waves(rng, 20, 0.05, 0.5, 20)]
        self.ledges = np.cumsum(rng.uniform(0.3, 1.5, 60))
        self.steps = rng.uniform(0.0, 0.015, 61)

    def radius(self, depth: Floats, toolface: Floats) -> Floats:
        radius = np.full(depth.shape, 0.109)
        opposite = (toolface - self.direction + 90.0) % 180.0 - 90.0
        alone = (toolface - self.direction + 180.0) % 360.0 - 180.0
        step = self.steps[np.searchsorted(self.ledges, depth)]
        if self.kind == "breakout":
            lobe = np.maximum(1 - (opposite / 35.0) ** 2, 0) ** 2
            radius += 0.018 * lobe * (0.7 + 0.3 * np.sin(depth / 3)) + 0.0003 * _rough(self.waves[0], depth, toolface)
        elif self.kind == "key seat":
            radius += 0.03 * np.exp(-((alone / 20.0) ** 2)) + 0.0002 * _rough(self.waves[0], depth, toolface)
        elif self.kind == "ledges":
            radius += step + 0.0003 * _rough(self.waves[0], depth, toolface)
        elif self.kind == "rough":
            radius += 0.0015 * _rough(self.waves[0], depth, toolface)
        else:
            lobe = np.maximum(1 - (opposite / 35.0) ** 2, 0) ** 2 * (np.sin(2 * depth) > 0)
            radius += 0.5 * step + 0.012 * lobe + 0.001 * _rough(self.waves[0], depth, toolface)
            radius += 0.0008 * _rough(self.waves[1], depth, toolface)
        return radius

    def at_ledge(self, depth: Floats, toolface: Floats) -> np.ndarray:
        """Return, for each of n points, whether the radius 5 cm above and 5 cm below it differ by more than 2 mm."""
        change = self.radius(depth + 0.05, toolface) - self.radius(depth - 0.05, toolface)
        return np.asarray(np.abs(change) > 0.002)


def _waves(rng: np.random.Generator, around: int, least: float, most: float, count: int) -> Floats:
    length = np.exp(rng.uniform(np.log(least), np.log(most), count))
    return np.column_stack([rng.integers(-around, around + 1, count), 2 * np.pi / length, rng.uniform(0, 6.28, count)])


def _rough(waves: Floats, depth: Floats, toolface: Floats) -> Floats:
    angle = np.radians(toolface)
    total = sum(np.cos(around * angle + along * depth + phase) for around, along, phase in waves)
    return np.asarray(total * np.sqrt(2.0 / len(waves)))


def positions(tool: str, seed: int) -> tuple[Floats, Floats]:
    """Return the depths (m) and toolfaces (deg) at which a tool samples a hole."""
    rng = np.random.default_rng([seed, 2])
    if tool in ROTATING:
        per_turn = int(tool.split()[0])
        height = 0.05 if per_turn == 16 else 0.02
        number = np.arange(int(LENGTH / height * per_turn))
        return number * height / per_turn, (number + rng.uniform(-0.25, 0.25, number.size)) * 360.0 / per_turn % 360.0
    if tool == "four arms":
        rows = np.arange(int(LENGTH / 0.025))
        turned = np.cumsum(rng.normal(0, 1.5, rows.size))
        return np.repeat(rows * 0.025, 4), (np.repeat(turned, 4) + np.tile([0, 90, 180, 270], rows.size)) % 360.0
    if tool == "stick-slip":
        time = np.arange(int(LENGTH / 0.0005)) * 0.05
        turns = 117 / 60 * (time + 3.7 / 6.28 * np.sin(6.28 * time / 3.7 + rng.uniform(0, 6.28)))
        return np.arange(time.size) * 0.0005, turns * 360.0 % 360.0
    depth = np.arange(int(LENGTH / 0.12)) * 0.12
    return depth, rng.uniform(0, 360, depth.size)


def measured(kind: str, tool: str, noise: float, seed: int) -> tuple[Hole, hb.Caliper]:
    """Return a hole, and the samples that a tool takes of it."""
    hole = Hole(kind, seed)
    depth, toolface = positions(tool, seed)
    radius = hole.radius(depth, toolface) + np.random.default_rng([seed, 3]).normal(0, noise, depth.size)
    return hole, hb.Caliper(depth, toolface, radius)

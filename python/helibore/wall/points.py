"""Values at any point of a wall: radius, distance to the nearest sample, samples used, angular gap."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats, Integers32, column, finite_column
from helibore.samples.helix import WallLike, helix_of


class PointValues(NamedTuple):
    """Values at points, (m,) each.

    ``radius`` (metres) is that of `evaluate`, NaN if no vertex around the point has a radius. ``nearest`` (metres),
    ``support`` (number of samples) and ``gap`` (the angular gap, degrees) are those of the nearest vertex, as in
    `Wall`; beyond the wall they are NaN, 0 and 360.
    """

    radius: Floats
    nearest: Floats
    support: Integers32
    gap: Floats


def values_at(wall: Any, depth: npt.ArrayLike, toolface: npt.ArrayLike) -> PointValues:
    """Return the values of a wall at points, as `Wall.at` describes."""
    where, angle = (column(name, np.ravel(of)) for name, of in (("depth", depth), ("toolface", toolface)))
    radius = evaluate(wall, where, angle)
    helix, count = helix_of(wall), wall.radius.size
    sector = np.mod(angle - helix.start_toolface, 360.0) * (helix.sectors / 360.0)
    around = np.rint(sector)
    turn = np.rint((where - helix.start_depth) / helix.pitch - around / helix.sectors)
    vertex = np.clip(around + turn * helix.sectors, -1, count).astype(np.int64)
    there = (vertex >= 0) & (vertex < count)
    if not count:
        return PointValues(radius, radius, np.zeros(radius.size, np.int32), np.full(radius.size, 360.0))
    near = np.clip(vertex, 0, count - 1)
    nearest, support = np.where(there, wall.nearest[near], np.nan), np.where(there, wall.support[near], 0)
    return PointValues(radius, nearest, support, np.where(there, wall.angular_gap[near], 360.0))


def evaluate(wall: WallLike, depth: npt.ArrayLike, toolface: npt.ArrayLike) -> Floats:
    """Return the radius of a wall at points, (n,) metres, interpolated bilinearly in the cell of the helix.

    With s = toolface in sectors, s in [0, K), the vertices of one toolface lie at depths start + (s + m K) pitch / K,
    so the turn of a point is m = (depth - start) / pitch - s / K. Vertices without support, or beyond the ends of the
    helix, have weight 0; the weights of the others are normalised. NaN if no vertex of the cell has a radius.
    """
    where = finite_column("depth", depth)
    angle = finite_column("toolface", toolface, where.size, "depth")
    setting, radius = wall.settings, wall.radius
    if radius.size == 0:
        return np.full(where.size, np.nan)
    around = setting.sectors
    sector = ((angle - setting.start_toolface) % 360.0) * (around / 360.0)
    turn = (where - wall.start_depth) / setting.pitch - sector / around
    low_sector, low_turn = np.floor(sector), np.floor(turn)
    part_sector, part_turn = sector - low_sector, turn - low_turn
    corner = np.clip(low_sector + around * low_turn, -2.0 * around, radius.size).astype(np.int64)
    total, weights = np.zeros(where.size), np.zeros(where.size)
    for step, weight in (
        (0, (1 - part_sector) * (1 - part_turn)),
        (1, part_sector * (1 - part_turn)),
        (around, (1 - part_sector) * part_turn),
        (around + 1, part_sector * part_turn),
    ):
        vertex = corner + step
        value = radius[np.clip(vertex, 0, radius.size - 1)]
        there = (vertex >= 0) & (vertex < radius.size) & np.isfinite(value)
        total += np.where(there, weight * value, 0.0)
        weights += np.where(there, weight, 0.0)
    known = weights > 0
    result = np.full(where.size, np.nan)
    result[known] = total[known] / weights[known]
    return result

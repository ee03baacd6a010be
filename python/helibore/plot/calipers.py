"""Diameters along the hole, as the caliper track draws them: by area, least and greatest, one row a turn.

    across(toolface) = r(toolface) + r(toolface + 180)      by area = 2 sqrt(mean(r^2))

Of more turns than a picture has rows, a row shows the mean, the least and the greatest of its turns, so that no
washout of one turn is lost. Derived logs for files are in ``helibore.logs``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from helibore.arrays import Floats
from helibore.helix import WallLike
from helibore.logs import turn_logs


@dataclass(frozen=True)
class Diameters:
    """One row a turn, from the shallowest to the deepest, each (rows,) float64, metres; NaN where missing.

    Attributes
    ----------
    depth
        Of the middle of the turn.
    area
        Diameter of the circle of the same area; NaN unless the turn is whole.
    least, greatest
        Across the hole, through the axis; of what is there.
    coverage
        Share of the turn that has a radius.
    """

    depth: Floats
    area: Floats
    least: Floats
    greatest: Floats
    coverage: Floats


def diameters(wall: WallLike, bit_diameter: float) -> Diameters:
    """Measure every full turn of a wall."""
    logs = turn_logs(wall, bit_diameter)
    K = wall.settings.sectors
    by_turn = wall.radius[: logs.depth.size * K].reshape(-1, K)
    half = K // 2  # with an odd number the far side is the mean of the two vertices next to it
    far = 0.5 * (np.roll(by_turn, -half, axis=1) + np.roll(by_turn, -((K + 1) // 2), axis=1))
    across = by_turn + far
    found = Diameters(
        logs.depth,
        logs.equivalent_diameter,
        np.fmin.reduce(across, axis=1),
        np.fmax.reduce(across, axis=1),
        logs.coverage,
    )
    return found if wall.settings.pitch > 0 else _reversed(found)


def _reversed(one: Diameters) -> Diameters:
    return Diameters(one.depth[::-1], one.area[::-1], one.least[::-1], one.greatest[::-1], one.coverage[::-1])


def thinned(turns: Diameters, top: float, bottom: float, rows: int) -> Diameters:
    """Return the turns between two depths, at most about ``rows`` rows of them."""
    inside = slice(np.searchsorted(turns.depth, top), np.searchsorted(turns.depth, bottom, side="right"))
    depth = turns.depth[inside]
    count = depth.size
    if count <= rows:
        return Diameters(depth, turns.area[inside], turns.least[inside], turns.greatest[inside], turns.coverage[inside])
    first = np.unique(np.arange(rows) * count // rows)
    sizes = np.diff(np.append(first, count))
    there = np.isfinite(turns.area[inside])
    total = np.add.reduceat(np.where(there, turns.area[inside], 0.0), first)
    known = np.add.reduceat(there.astype(np.float64), first)
    return Diameters(
        np.add.reduceat(depth, first) / sizes,
        np.where(2 * known >= sizes, total / np.maximum(known, 1), np.nan),
        np.fmin.reduceat(turns.least[inside], first),
        np.fmax.reduceat(turns.greatest[inside], first),
        np.add.reduceat(turns.coverage[inside], first) / sizes,
    )

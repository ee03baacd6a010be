"""The wall in two levels: every vertex, and an overview of blocks for the whole well.

Vertex k of the wall (level 0, a helix) lies at

    depth = start_depth + k pitch / sectors          toolface = start_toolface + k 360 / sectors

The overview (level 1) is a stack of rings, so a feature that goes straight around the hole stays level. A ring covers
`TURNS` turns and has eight cells, one for each eighth of the circle; a wall of fewer than eight sectors has one cell
for each sector. Cell (R, C) combines the vertices of eighth C in the turns R * TURNS to (R + 1) * TURNS - 1. It holds
the mean radius and the mean of every attribute (missing values do not count). It also holds the largest distance to a
sample and the smallest support of its vertices, because a mean would hide a vertex that few samples support. A cell
counts as interpolated between arms if most of its vertices are. Its uncertainty is the largest of its vertices.
"""

from __future__ import annotations

import numpy as np

from helibore.base.arrays import Array, Floats, Mask, Unsigned16
from helibore.viewer.texels import FIRST, INTERPOLATED, NEAREST, RADIUS, STATE, SUPPORT_MASK, TEXEL, UNCERTAINTY

TURNS = 16  # turns of the wall in one ring of the overview
OVERVIEW_ROWS = 1024  # rings in a tile of the overview


class Level:
    """The columns of a level, which grow: packed texels, and one float32 column for each attribute."""

    def __init__(self, sectors: int, rows: int, columns: int) -> None:
        self.sectors, self.rows, self.size = sectors, rows, 0
        self.texels: Unsigned16 = np.zeros((0, TEXEL), np.uint16)
        self.columns = [np.full(0, np.nan, np.float32) for _ in range(columns)]

    @property
    def tile_size(self) -> int:
        return self.rows * self.sectors

    @property
    def halo(self) -> int:
        """Vertices of the next tile that the last quads of a tile touch."""
        return self.sectors + 1

    def tiles(self, start: int, stop: int) -> range:
        """Return the tiles that show a vertex of [start, stop), halos included."""
        return range(max(0, (start - self.halo) // self.tile_size), max(start, stop - 1) // self.tile_size + 1)

    def frozen_copy(self, start: int, stop: int) -> Level:
        """Return a copy of the vertices [start, stop) of this level; all other vertices are zero and take no memory."""
        copy = Level(self.sectors, self.rows, 0)
        first = max(0, min(start, self.size))
        copy.size, part = self.size, slice(first, max(first, min(stop, self.size)))
        copy.texels = np.zeros((self.size, TEXEL), np.uint16)
        copy.texels[part] = self.texels[part]
        for column in self.columns:
            copy.columns.append(np.zeros(self.size, np.float32))
            copy.columns[-1][part] = column[part]
        return copy

    def reserve(self, size: int) -> None:
        """Grow to ``size`` vertices. Vertices that are never written have radius 0 and attributes NaN."""
        capacity = len(self.texels)
        if size > capacity:
            more = max(size, 2 * capacity, self.tile_size) - capacity
            self.texels = np.concatenate([self.texels, np.zeros((more, TEXEL), np.uint16)])
            empty = np.full(more, np.nan, np.float32)
            self.columns = [np.concatenate([column, empty]) for column in self.columns]
        self.size = max(self.size, size)


def overview_of(wall: Level) -> Level:
    """Return an empty overview for a wall."""
    return Level(min(8, wall.sectors), OVERVIEW_ROWS, len(wall.columns))


def refresh_overview(over: Level, wall: Level, start: int, stop: int) -> tuple[int, int]:
    """Recompute the cells in which the wall's vertices [start, stop) lie; return the half-open range of these cells."""
    block = TURNS * wall.sectors
    over.reserve(-(-wall.size // block) * over.sectors)
    low, high = start // block, (stop - 1) // block + 1
    part = slice(low * block, min(high * block, wall.size))
    first_sectors = -(-np.arange(over.sectors) * wall.sectors // over.sectors)

    def cells(reduce: np.ufunc, values: Array, missing: float) -> Array:
        """Reduce the values of every cell; ``missing`` stands for the vertices beyond the wall's end."""
        beyond = np.full((high - low) * block - values.size, missing, values.dtype)
        by_turn = np.concatenate([values, beyond]).reshape(-1, TURNS, wall.sectors)
        reduced: Array = reduce.reduceat(reduce.reduce(by_turn, axis=1), first_sectors, axis=1)
        return reduced.ravel()

    def mean(values: Array, known: Mask, missing: float) -> Floats:
        total = cells(np.add, np.where(known, values, 0).astype(np.float64), 0.0)
        count = cells(np.add, known.astype(np.float64), 0.0)
        return np.where(count > 0, total / np.maximum(count, 1), missing)

    texels = wall.texels[part]
    there = texels[:, RADIUS] > 0
    support = texels[:, STATE] & SUPPORT_MASK
    target = slice(low * over.sectors, high * over.sectors)
    for column in (RADIUS, FIRST):
        over.texels[target, column] = mean(texels[:, column], there, 0.0)
    over.texels[target, NEAREST] = cells(np.maximum, texels[:, NEAREST], 0)
    over.texels[target, STATE] = cells(np.minimum, support, SUPPORT_MASK)
    between = (texels[:, STATE] & INTERPOLATED) > 0
    most = cells(np.add, np.where(between, 2.0, 0.0), 0.0) > cells(np.add, np.ones(len(between)), 0.0)
    over.texels[target, STATE][most] |= INTERPOLATED
    over.texels[target, STATE] |= cells(np.maximum, texels[:, STATE] >> UNCERTAINTY, 0) << UNCERTAINTY
    for over_column, wall_column in zip(over.columns, wall.columns, strict=True):
        values = wall_column[part]
        over_column[target] = mean(values, np.isfinite(values), np.nan)
    return target.start, target.stop

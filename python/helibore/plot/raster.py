"""Cut the wall and its images open, and lay them flat on a grid of pixels.

            left                                     A pixel shows the mean of the cells whose centres lie in it; if
    top    +----+----+----+----+                     these are fewer than two, the cell that holds the pixel's centre.
           |    |    |    |    |  one row of pixels  The pixel is missing if more than half of its cells are missing,
    bottom +----+----+----+----+                     or if it lies beyond the wall or the image.

No patch is drawn for a quad. So a 10 km well with millions of cells needs only a few sums over its columns, and no more
pixels than the paper shows. ``base.colors`` colours the pixels, and ``tracks`` draws them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from helibore.base.arrays import Floats
from helibore.images.sector_image import SectorImage
from helibore.settings.wall_settings import Settings


@dataclass(frozen=True)
class Grid:
    """Pixels between two depths, once around the hole."""

    top: float  # depths of the edges, metres, the first above the second
    bottom: float
    rows: int
    columns: int
    left: float = 0.0  # toolface at the left and the right edge, degrees

    def edges(self) -> Floats:
        """Return the depths of the edges of the rows, (rows + 1,) metres."""
        return np.linspace(self.top, self.bottom, self.rows + 1)

    def toolfaces(self) -> Floats:
        """Return the toolfaces of the edges of the columns, (columns + 1,) degrees, rising from ``left``."""
        return self.left + np.linspace(0.0, 360.0, self.columns + 1)


def unroll_wall(values: Floats, settings: Settings, start_depth: float, grid: Grid) -> Floats:
    """Return one value a pixel, (rows, columns), from the values (n,) at a helix's vertices, the middles of cells."""
    K, pitch = settings.sectors, settings.pitch
    # Column j lies j/K of a turn farther along, so rows of equal depth differ from column to column.
    along = (grid.edges() - start_depth) / pitch
    first = min(max(math.floor(along.min()) - 2, 0), (values.size - 1) // K)  # only turns that these pixels reach
    values = values[first * K : max(math.ceil(along.max()) + 2, first + 1) * K]
    along -= first
    turns = -(-values.size // K)
    by_turn = np.full(turns * K, np.nan)
    by_turn[: values.size] = values
    reduced = np.empty((grid.rows, K))
    columns = by_turn.reshape(turns, K)
    sums, counts = _running_sums(columns)
    for j in range(K):
        reduced[:, j] = _block_means(columns[:, j], sums[:, j], counts[:, j], along - j / K)
    start = (grid.toolfaces() - settings.start_toolface) * (K / 360.0)
    return _means_around(reduced, start)


def unroll_image(image: SectorImage, values: Floats, grid: Grid) -> Floats:
    """Return one value of a sector image a pixel, (rows, columns); NaN in gaps of the image.

    ``values`` are (n, S): ``image.values``, normalised or not.
    """
    edges = grid.edges()
    middle = 0.5 * (edges[:-1] + edges[1:])
    ends = np.searchsorted(image.depth, edges[[0, -1]])
    part = slice(max(ends[0] - 1, 0), ends[1] + 1)  # only rows that these pixels reach
    depth, values = image.depth[part], values[part]
    sums, counts = _running_sums(values)
    first = np.searchsorted(depth, edges[:-1])
    stop = np.searchsorted(depth, edges[1:])
    several = stop - first >= 2
    total, count = sums[stop] - sums[first], counts[stop] - counts[first]
    reduced = np.where(2 * count >= (stop - first)[:, None], total / np.maximum(count, 1), np.nan)
    reduced[count == 0] = np.nan
    reduced[~several] = _nearest_rows(depth, values, middle[~several], image.reach)
    turn = 1 if image.direction == "clockwise" else -1
    sector = (grid.toolfaces() - image.offset) * (turn * image.sectors / 360.0)
    # Sector 1 is cell 0 of _means_around, centred on 0.
    return _means_around(reduced, sector if image.origin == "centre" else sector - 0.5)


def _nearest_rows(depths: Floats, values: Floats, depth: Floats, reach: float) -> Floats:
    """Return for each ``depth`` the values of the nearest row of those at ``depths``; NaN if it is beyond ``reach``."""
    right = np.clip(np.searchsorted(depths, depth), 1, max(depths.size - 1, 1))
    left = right - 1
    right = np.minimum(right, depths.size - 1)
    row = np.where(depth - depths[left] < depths[right] - depth, left, right)
    near: Floats = values[row].copy()
    near[np.abs(depth - depths[row]) > reach] = np.nan
    return near


def _running_sums(columns: Floats) -> tuple[Floats, Floats]:
    """Return the running sums and running counts of each column's finite values; the first row of both is zeros."""
    there = np.isfinite(columns)
    sums, counts = np.zeros((2, columns.shape[0] + 1, columns.shape[1]))
    np.cumsum(np.where(there, columns, 0.0), axis=0, out=sums[1:])
    np.cumsum(there, axis=0, out=counts[1:])
    return sums, counts


def _block_means(column: Floats, sums: Floats, counts: Floats, edges: Floats) -> Floats:
    """Return for each two neighbouring edges the mean of the cells that are centred between them.

    If these are fewer than two, return the cell that holds the middle between the edges. Edges are in cells; cell i is
    centred on i.
    """
    low, high = np.minimum(edges[:-1], edges[1:]), np.maximum(edges[:-1], edges[1:])
    size = column.size
    middle = 0.5 * (low + high)
    cell = np.floor(middle + 0.5).astype(np.int64)
    inside = (cell >= 0) & (cell < size)
    found = np.where(inside, column[np.clip(cell, 0, size - 1)], np.nan)
    first, stop = (np.clip(np.ceil(edge), 0, size).astype(np.int64) for edge in (low, high))
    several = stop - first >= 2
    total, count = sums[stop] - sums[first], counts[stop] - counts[first]
    mean = np.where(2 * count >= stop - first, total / np.maximum(count, 1), np.nan)
    mean[count == 0] = np.nan
    return np.where(several, mean, found)


def _means_around(rows: Floats, edges: Floats) -> Floats:
    """Return for each two neighbouring edges around the hole the mean of the columns between, as `_block_means` does.

    Edges are in cells; cell j, modulo the number of cells, is centred on j.
    """
    cells = rows.shape[1]
    low, high = np.minimum(edges[:-1], edges[1:]), np.maximum(edges[:-1], edges[1:])
    if high[0] - low[0] < 2.0:
        return rows[:, np.floor(0.5 * (low + high) + 0.5).astype(np.int64) % cells]
    columns = []
    for first, stop in zip(np.ceil(low).astype(int), np.ceil(high).astype(int), strict=True):
        block = rows[:, np.arange(first, stop) % cells]
        there = np.isfinite(block)
        count = there.sum(axis=1)
        total = np.where(there, block, 0.0).sum(axis=1)
        columns.append(np.where(2 * count >= max(stop - first, 1), total / np.maximum(count, 1), np.nan))
        columns[-1][count == 0] = np.nan
    return np.column_stack(columns)


def at_points(image: SectorImage, values: Floats, depth: Floats, toolface: Floats) -> Floats:
    """Return the value of the image's cell that holds each point; NaN in gaps. ``values`` are as in `unroll_image`."""
    turn = 1 if image.direction == "clockwise" else -1
    sector = (toolface - image.offset) * (turn * image.sectors / 360.0)
    column = np.floor(sector + 0.5 if image.origin == "centre" else sector).astype(np.int64) % image.sectors
    rows = _nearest_rows(image.depth, values, depth, image.reach)
    found: Floats = np.take_along_axis(rows, column[:, None], axis=1)[:, 0]
    return found

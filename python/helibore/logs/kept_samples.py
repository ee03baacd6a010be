"""The samples of a wall that show the shape of the hole: of a robust wall, those that are no spikes to it.

A robust wall (`Settings.robust`) hardly follows a sample that stands alone. Such a sample shows no shape either: a
spike was a lobe, and several of them along a hole of bit size were a key seat.
"""

from __future__ import annotations

import numpy as np

from helibore.base.arrays import Floats, Mask, column
from helibore.samples.helix import WallLike, whole_helix

MOST_OFF = 2.5
"""Deviations of the noise by which a sample may lie beyond the vertices on all sides of it, as beyond other samples."""


def columns_of_samples(wall: WallLike) -> tuple[Floats, ...]:
    """Return depth, toolface and radius of the samples in the order of depth; () for a wall without them."""
    columns: tuple[Floats, ...] = getattr(wall, "sample_columns", ())[:3]
    if not columns and hasattr(wall, "samples"):
        columns = (wall.samples.depth, wall.samples.toolface, wall.samples.radius)
    return columns


def columns_of_kept_samples(wall: WallLike) -> tuple[Floats, ...]:
    """Return the same; what is a spike to a robust wall has no radius (NaN)."""
    columns = tuple(
        column(name, of) for name, of in zip(("depth", "toolface", "radius"), columns_of_samples(wall), strict=False)
    )
    if not columns or not getattr(wall.settings, "robust", False):
        return columns
    return *columns[:2], np.where(_spikes(wall, columns), np.nan, columns[2])


def _spikes(wall: WallLike, columns: tuple[Floats, ...]) -> Mask:
    """Return which samples lie beyond all vertices beside them: of their turn, of those above and below, and around."""
    depth, toolface, radius = columns
    helix = whole_helix(wall)
    turns = column("radius", wall.radius).size // helix.sectors
    if not turns:
        return np.zeros(depth.size, dtype=bool)
    radii = column("radius", wall.radius)[: turns * helix.sectors].reshape(turns, -1)
    turn = np.floor((depth - helix.start_depth) / helix.pitch).astype(np.int64) - helix.first // helix.sectors
    around = np.rint((toolface - helix.start_toolface) * helix.sectors / 360).astype(np.int64) % helix.sectors
    at = np.clip(turn, 0, turns - 1), around
    noise = [*(wall.settings.covariance or ())[1:2], *(wall.settings.stretches or ())[2::13]]
    off = MOST_OFF * np.sqrt(max(noise))
    beyond = (radius > _beside(np.fmax, radii)[at] + off) | (radius < _beside(np.fmin, radii)[at] - off)
    found: Mask = beyond & (turn >= 0) & (turn < turns)
    return found


def _beside(most: np.ufunc, radii: Floats) -> Floats:
    """Return the greatest or the least of each vertex and those next to it."""
    turns = np.pad(radii, ((1, 1), (0, 0)), mode="edge")
    along = most(most(turns[:-2], turns[2:]), radii)
    found: Floats = most(most(np.roll(along, 1, axis=1), np.roll(along, -1, axis=1)), along)
    return found

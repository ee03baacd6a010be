"""The samples of a wall that show the shape of the hole: of a robust wall, those that are no spikes to it.

A robust wall (`Settings.robust`) hardly follows a sample that stands alone. Such a sample shows no shape either: a
spike was a lobe, and several of them along a hole of bit size were a key seat.
"""

from __future__ import annotations

from helibore import _core
from helibore.base.arrays import Floats, column
from helibore.samples.helix import WallLike, whole_helix


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
    noise = max([*(wall.settings.covariance or ())[1:2], *(wall.settings.stretches or ())[2::13]])
    depth, toolface, radius = columns
    kept = _core.kept_radii(whole_helix(wall), column("radius", wall.radius), depth, toolface, radius, noise)
    return depth, toolface, kept

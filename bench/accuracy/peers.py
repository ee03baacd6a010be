"""Other methods to rebuild a wall. They work on the unrolled wall. A third of a turn is repeated on both sides.

IDW on a tree, Delaunay, thin plate     by SciPy
natural neighbour                       Sibson's, on a raster (Park and others, 2006), with SciPy's tree
contours                                parallel contours: linear around each turn of samples, and between turns
PyKrige                                 ordinary kriging of the 16 nearest samples
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec

import numpy as np

import helibore as hb
from bench.accuracy.known_holes import BIT
from helibore.base.arrays import Floats

Method = Callable[[hb.Caliper, Floats, Floats], Floats]
RASTER = 0.004  # metres


def methods(*, slow: bool) -> tuple[dict[str, Method], list[str]]:
    """Return the methods whose libraries are installed, by name, and the libraries that are not installed.

    With ``slow``, methods that take long are included.
    """
    needed: dict[str, tuple[str, Method]] = {
        "IDW on a tree": ("scipy", tree),
        "Delaunay": ("scipy", delaunay),
        "natural neighbour": ("scipy", natural_neighbour),
        "thin plate": ("scipy", thin_plate),
        "contours": ("numpy", contours),
    }
    if slow:
        needed["PyKrige"] = ("pykrige", by_pykrige)
    missing = sorted({library for library, _ in needed.values() if find_spec(library) is None})
    return {name: method for name, (library, method) in needed.items() if library not in missing}, missing


def plane(depth: Floats, toolface: Floats) -> Floats:
    """Return points on the unrolled wall, (n, 2) metres: along the circle of the bit, and depth."""
    return np.column_stack([np.radians(toolface) * BIT / 2, depth])


def unrolled(caliper: hb.Caliper) -> tuple[Floats, Floats]:
    """Return points and radii of the samples; points are repeated, so that angles run from -120 to 480 degrees.

    Points are moved at random by about 0.1 um, because a triangulation or a spline fails if two points are equal.
    """
    turns = [(caliper.toolface % 360.0) + turn for turn in (-360.0, 0.0, 360.0)]
    keep = [(turn > -120) & (turn < 480) for turn in turns]
    points = [plane(caliper.depth[some], turn[some]) for turn, some in zip(turns, keep, strict=True)]
    joined = np.concatenate(points)
    moved = joined + np.random.default_rng(1).normal(0, 1e-7, joined.shape)
    return moved, np.concatenate([caliper.radius[some] for some in keep])


def tree(caliper: hb.Caliper, depth: Floats, toolface: Floats) -> Floats:
    from scipy.spatial import cKDTree

    points, radius = unrolled(caliper)
    distance, near = cKDTree(points).query(plane(depth, toolface), 8)
    return np.asarray(np.average(radius[near], weights=1 / distance, axis=1))


def delaunay(caliper: hb.Caliper, depth: Floats, toolface: Floats) -> Floats:
    from scipy.interpolate import LinearNDInterpolator

    return np.asarray(LinearNDInterpolator(*unrolled(caliper))(plane(depth, toolface)))


def thin_plate(caliper: hb.Caliper, depth: Floats, toolface: Floats) -> Floats:
    from scipy.interpolate import RBFInterpolator

    points, radius = unrolled(caliper)
    return np.asarray(RBFInterpolator(points, radius, neighbors=16)(plane(depth, toolface)))


def natural_neighbour(caliper: hb.Caliper, depth: Floats, toolface: Floats) -> Floats:
    """Return radii at points. Each cell of a raster has the radius of its nearest sample.

    The radius at a point is the mean over those cells to which the point is at least as near as the nearest sample is.
    """
    from scipy.spatial import cKDTree

    points, radius = unrolled(caliper)
    at = plane(depth, toolface)
    low, high = at.min(axis=0) - 0.02, at.max(axis=0) + 0.02
    axes = [np.arange(low[i], high[i], RASTER) for i in (0, 1)]
    total, weights = np.zeros(at.shape[0]), np.zeros(at.shape[0])
    samples, targets = cKDTree(points), cKDTree(at)
    for rows in np.array_split(axes[1], max(len(axes[1]) // 500, 1)):
        cells = np.stack(np.meshgrid(axes[0], rows), axis=-1).reshape(-1, 2)
        distance, near = samples.query(cells)
        reached = targets.query_ball_point(cells, distance)
        counts = np.array([len(one) for one in reached])
        of = np.concatenate([np.asarray(one, np.int64) for one in reached])
        total += np.bincount(of, np.repeat(radius[near], counts), at.shape[0])
        weights += np.bincount(of, minlength=at.shape[0])
    return np.divide(total, weights, out=np.full(at.shape[0], np.nan), where=weights > 0)


def contours(caliper: hb.Caliper, depth: Floats, toolface: Floats) -> Floats:
    """Return radii at points, linear between contours; a contour is one turn of samples, at its mean depth."""
    turned = np.cumsum((np.diff(caliper.toolface, prepend=caliper.toolface[0]) + 180.0) % 360.0 - 180.0)
    turn = np.floor(turned / 360.0).astype(np.int64)
    numbers = np.unique(turn)
    height = np.array([caliper.depth[turn == one].mean() for one in numbers])
    above = np.clip(np.searchsorted(height, depth) - 1, 0, numbers.size - 2)
    part = np.clip((depth - height[above]) / (height[above + 1] - height[above]), 0.0, 1.0)
    sides = np.empty((2, depth.size))
    for number, one in enumerate(numbers):
        mine = turn == one
        for side in (0, 1):
            here = above + side == number
            sides[side, here] = np.interp(toolface[here], caliper.toolface[mine], caliper.radius[mine], period=360.0)
    return np.asarray((1 - part) * sides[0] + part * sides[1])


def by_pykrige(caliper: hb.Caliper, depth: Floats, toolface: Floats) -> Floats:
    """Return radii at points by kriging half a metre of hole at a time, because PyKrige keeps all distances in memory.

    Each half metre uses the samples within it, and the samples up to 0.1 m above and below it.
    """
    from pykrige.ok import OrdinaryKriging

    points, radius = unrolled(caliper)
    at, found = plane(depth, toolface), np.full(depth.size, np.nan)
    for top in np.arange(depth.min(), depth.max() + 0.5, 0.5):
        mine = (depth >= top) & (depth < top + 0.5)
        near = np.abs(points[:, 1] - (top + 0.25)) < 0.35
        if mine.any():
            kriging = OrdinaryKriging(*points[near].T, radius[near], variogram_model="spherical")
            found[mine] = kriging.execute("points", *at[mine].T, n_closest_points=16, backend="loop")[0]
    return found

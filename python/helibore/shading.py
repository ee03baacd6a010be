"""A stretch of wall as a shaded picture, in NumPy alone: seen from the formation, from the side and a little above.

    x right, y to the viewer, z down the hole; the viewer stands at toolface ``facing``, ``tilt`` above level
    R' = tube (bit/2 + shape (R - bit/2))          tube and shape are the two exaggerations a caption must state
    x = -R' sin(toolface - facing)    y = R' cos(toolface - facing)    screen = (x, z cos(tilt) + y sin(tilt))

The wall is resampled so finely that no pixel stays empty, and shaded point by point; the nearest point of a pixel wins.
Parallel projection, so that depth reads off a straight scale. Not here: axes and captions (``pictures``).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from helibore.arrays import Floats

Single = npt.NDArray[np.float32]

_LIGHTS = (  # direction towards the light (right, to the viewer, down), strength
    ((-0.62, 0.58, -0.53), 0.78),
    ((0.85, 0.35, 0.10), 0.22),
)
_AMBIENT = 0.22
_FINER = 2  # pixels drawn for each pixel shown, along each axis
_DENSITY = 1.25  # points for each pixel drawn, along each axis


@dataclass(frozen=True)
class View:
    """Where the viewer stands, how the hole is exaggerated, and the picture's size in pixels."""

    facing: float
    tilt: float = 20.0
    tube: float = 10.0
    shape: float = 3.0
    width: int = 480
    height: int = 1000


@dataclass(frozen=True)
class Shaded:
    """The picture, (height, width, 4) float32 in [0, 1], and what its edges are: metres to the right and down the hole.

    ``left``, ``right`` count from the axis, exaggerated; ``top``, ``bottom`` are depths on the axis.
    """

    pixels: Single
    left: float
    right: float
    top: float
    bottom: float


def shade(
    radius: Floats,
    colors: Floats,
    sectors: int,
    pitch: float,
    first: tuple[float, float],
    bit_diameter: float,
    view: View,
) -> Shaded:
    """Draw vertices of a wall, from a whole number of turns.

    Parameters
    ----------
    radius
        (n,) metres, vertex by vertex along the helix; none missing.
    colors
        (n, 3) in [0, 1].
    sectors, pitch
        Of the helix; pitch may be negative.
    first
        Depth (m) and toolface (deg) of the first vertex.
    bit_diameter
        Metres: the shape is exaggerated about it.
    view
        Viewer, exaggeration, size.
    """
    turns = radius.size // sectors - 1
    length = turns * abs(pitch)
    half = view.tube * (0.5 * bit_diameter + view.shape * np.maximum(radius - 0.5 * bit_diameter, 0).max()) * 1.06
    rise, fall = np.sin(np.radians(view.tilt)), np.cos(np.radians(view.tilt))
    scale = _FINER * min(view.width / (2 * half), view.height / (length * fall + 2 * half * rise))

    rows = int(_DENSITY * scale * length * fall) + 2
    columns = int(_DENSITY * scale * 2 * np.pi * half) + 2
    turn = np.linspace(0.0, turns, rows)
    around = np.arange(columns) * (360.0 / columns)
    fine = _resample(np.column_stack([radius, colors]), sectors, turn, (around - first[1]) / 360.0 * np.sign(pitch))
    reach = view.tube * (0.5 * bit_diameter + view.shape * (fine[0] - 0.5 * bit_diameter))
    psi = np.radians(around - view.facing).astype(np.float32)
    x, y = -reach * np.sin(psi), reach * np.cos(psi)
    z = np.broadcast_to((turn * abs(pitch)).astype(np.float32)[:, None], x.shape)

    normal = _normals(x, y, z)
    facing = normal[1] * fall - normal[2] * rise
    seen = (facing > 0) | (z < 2.2 * half * rise / fall)  # the inside shows through the open end only
    x, y, z = x[seen], y[seen], z[seen]
    lit = _light(normal[:, seen], facing[seen], fine[1:, seen], rise, fall)
    middle = 0.5 * length * fall
    across = (x * scale + 0.5 * _FINER * view.width).astype(np.int32)
    down = ((z * fall + y * rise - middle) * scale + 0.5 * _FINER * view.height).astype(np.int32)
    pixels = _nearest_wins(across, down, y * fall - z * rise, lit, _FINER * view.width, _FINER * view.height)
    top_depth = min(first[0], first[0] + turns * pitch)
    span = _FINER * view.height / scale / fall
    return Shaded(
        pixels,
        -0.5 * _FINER * view.width / scale,
        0.5 * _FINER * view.width / scale,
        top_depth + 0.5 * length - 0.5 * span,
        top_depth + 0.5 * length + 0.5 * span,
    )


def _resample(values: Floats, sectors: int, turn: Floats, around: Floats) -> Single:
    """Smooth values (n, channels) of a helix to a grid: (channels, depths in turns, toolfaces in turns from the first).

    A column of vertices lies a sector's share of a turn deeper than the one before it, so it is smoothed along depth
    where it really lies; then neighbouring columns, without a seam. Cubic B-splines: the shading shows no facets.
    """
    turns = values.shape[0] // sectors
    grid = values[: turns * sectors].reshape(turns, sectors, -1).astype(np.float32)
    by_column = np.empty((grid.shape[2], turn.size, sectors), dtype=np.float32)
    for j in range(sectors):
        by_column[:, :, j] = (_spline(turn - j / sectors, turns, wrap=False) @ grid[:, j]).T
    return by_column @ _spline(around * sectors, sectors, wrap=True).T


def _spline(at: Floats, count: int, wrap: bool) -> Single:
    """Weights (len(at), count) of a cubic B-spline at fractional indices, which wrap around or stop at the ends."""
    low = np.floor(at).astype(np.int64)
    t = at - low
    weights = ((1 - t) ** 3, 3 * t**3 - 6 * t**2 + 4, -3 * t**3 + 3 * t**2 + 3 * t + 1, t**3)
    matrix = np.zeros((at.size, count), dtype=np.float32)
    for step, weight in enumerate(weights, start=-1):
        index = (low + step) % count if wrap else np.clip(low + step, 0, count - 1)
        np.add.at(matrix, (np.arange(at.size), index), weight / 6.0)
    return matrix


def _normals(x: Single, y: Single, z: Single) -> Single:
    """Unit normals (3, rows, columns) of the grid, away from the axis."""
    around = [np.roll(p, -1, axis=1) - np.roll(p, 1, axis=1) for p in (x, y)]
    along = [np.gradient(p, axis=0) for p in (x, y, z)]
    normal = np.stack(
        [around[1] * along[2], -around[0] * along[2], around[0] * along[1] - around[1] * along[0]], dtype=np.float32
    )
    normal /= np.sqrt((normal**2).sum(axis=0)) * np.sign(normal[0] * x + normal[1] * y)
    return normal


def _light(normal: Single, facing: Single, colors: Single, rise: float, fall: float) -> Single:
    """Colours (points, 3) under the lamps with a soft shine; the inside, seen through the open end, is darker."""
    normal = normal * np.sign(facing)
    to_viewer = np.array([0.0, fall, -rise])
    bright = np.full(facing.shape, _AMBIENT, dtype=np.float32)
    shine = np.zeros_like(bright)
    for direction, strength in _LIGHTS:
        lamp = np.array(direction) / np.linalg.norm(direction)
        between = (lamp + to_viewer) / np.linalg.norm(lamp + to_viewer)
        bright += strength * np.maximum(lamp.astype(np.float32) @ normal, 0)
        shine += 0.16 * strength * np.maximum(between.astype(np.float32) @ normal, 0) ** 24
    inside = np.where(facing < 0, np.float32(0.5), np.float32(1.0))
    lit: Single = np.clip((colors * bright + shine) * inside, 0, 1).T
    return lit


def _nearest_wins(
    across: npt.NDArray[np.int32], down: npt.NDArray[np.int32], near: Single, colors: Single, width: int, height: int
) -> Single:
    """Put points on a picture, the nearest last, and average it down to the size shown."""
    order = np.argsort(near)
    order = order[(across[order] >= 0) & (across[order] < width) & (down[order] >= 0) & (down[order] < height)]
    target = down[order].astype(np.int64) * width + across[order]
    canvas = np.zeros((height * width, 4), dtype=np.float32)
    canvas[target, :3] = colors[order]
    canvas[target, 3] = 1.0
    mean: Single = canvas.reshape(height // _FINER, _FINER, width // _FINER, _FINER, 4).mean(axis=(1, 3))
    covered = np.maximum(mean[..., 3:], np.float32(1e-6))
    mean[..., :3] = np.where(mean[..., 3:] > 0, mean[..., :3] / covered, 1.0)
    return mean

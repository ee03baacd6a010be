"""Draw an interval of wall as a shaded picture, in NumPy alone: seen from outside, from the side and slightly above.

    x right, y to the viewer, z down the hole; the viewer stands at toolface ``facing``, ``tilt`` above level
    R' = tube (bit/2 + shape (R - bit/2))          R: radius; a caption must state the exaggerations tube and shape
    x = -R' sin(toolface - facing)    y = R' cos(toolface - facing)    screen = (x, z cos(tilt) + y sin(tilt))

The wall is resampled so finely that no pixel stays empty, and shaded point by point; a pixel shows its nearest point.
The projection is parallel, so that a straight scale shows depth. ``plot.solid`` draws axes and captions.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from helibore.base.arrays import Floats, Floats32, Integers
from helibore.plot.hatching import DENSE, HATCH, HATCH_BYTES, LINE, NO_DATA_LINE, rgb

_LIGHTS = (  # direction towards the light (right, to the viewer, down), strength
    ((-0.62, 0.58, -0.53), 0.72),
    ((0.85, 0.40, 0.10), 0.30),
)
_AMBIENT = 0.27
_FINER = 2  # pixels drawn for each pixel shown, along each axis
_BLOCK = 96  # rows of points drawn at once: few enough for the cache
_DENSITY = 1.2  # points for each pixel drawn, along each axis


@dataclass(frozen=True)
class View:
    """Where the viewer stands (degrees), how much the hole is exaggerated, and the picture's size in pixels."""

    facing: float
    tilt: float = 20.0
    tube: float = 10.0
    shape: float = 3.0
    width: int = 480
    height: int = 1000
    hatch: int = 8  # pixels between two lines of the hatching


@dataclass(frozen=True)
class Shaded:
    """The picture, (height, width, 4) float32 in [0, 1], and what its edges are: metres to the right and down the hole.

    ``left``, ``right`` count from the axis, exaggerated; ``top``, ``bottom`` are depths on the axis.
    """

    pixels: Floats32
    left: float
    right: float
    top: float
    bottom: float


def shade(
    radius: Floats, colors: Floats, sectors: int, pitch: float, first: tuple[float, float], bit_diameter: float,
    view: View, interpolated: Floats | None = None,
) -> Shaded:  # fmt: skip
    """Draw the vertices of whole turns of a wall: (n,) radii, none missing, and (n, 3) colours in [0, 1].

    ``first`` is depth and toolface of the first vertex. The shape is exaggerated about ``bit_diameter``. Vertices that
    are 1 in ``interpolated``, (n,), have the lines of interpolated values, and those that are -1 the lines of no data.
    """
    turns = radius.size // sectors - 1
    length = turns * abs(pitch)
    half = view.tube * (0.5 * bit_diameter + view.shape * np.maximum(radius - 0.5 * bit_diameter, 0).max()) * 1.06
    rise, fall = np.sin(np.radians(view.tilt)), np.cos(np.radians(view.tilt))
    scale = _FINER * min(view.width / (2 * half), view.height / (length * fall + 2 * half * rise))

    rows = _rows(radius, sectors, turns, pitch, view, _DENSITY * scale)
    canvas = _Canvas(_FINER * view.width, _FINER * view.height)
    channels = np.column_stack([radius, colors] if interpolated is None else [radius, colors, interpolated])
    for start in range(0, rows.size - 1, _BLOCK):
        turn = rows[max(start - 1, 0) : start + _BLOCK + 2]
        # The inside is visible through the open end only; elsewhere points that face away from the viewer are hidden.
        down_hole = turn * pitch - min(0.0, turns * pitch)
        open_end = down_hole.min() < 2.2 * half * rise / fall
        low, high = max(int(turn[0]) - 2, 0), int(turn[-1]) + 3  # the turns that these rows are smoothed from
        greatest = float(radius[low * sectors : high * sectors].max())
        largest = view.tube * (0.5 * bit_diameter + view.shape * (greatest - 0.5 * bit_diameter))
        psi = _columns(radius[low * sectors : high * sectors], sectors, first[1], view, largest, _DENSITY * scale)
        around = (view.facing + np.degrees(psi) - first[1]) / 360.0
        fine = _resample(channels, sectors, turn, around)
        reach = view.tube * (0.5 * bit_diameter + view.shape * (fine[0] - 0.5 * bit_diameter))
        x, y = -reach * np.sin(psi).astype(np.float32), reach * np.cos(psi).astype(np.float32)
        z = np.broadcast_to(down_hole.astype(np.float32)[:, None], x.shape)
        normal = _normals(x, y, z)
        facing = normal[1] * fall - normal[2] * rise
        seen = np.full(x.shape, True) if open_end else facing > 0
        seen[0], seen[-1] = start == 0, start + _BLOCK + 2 > rows.size  # drawn by the neighbouring block
        x, y, z = x[seen], y[seen], z[seen]
        right = x * scale + 0.5 * canvas.width
        down = (z * fall + y * rise - 0.5 * length * fall) * scale + 0.5 * canvas.height
        lit = _light(normal[:, seen], facing[seen], fine[1:4, seen], rise, fall)
        if interpolated is not None:
            wide = _FINER * view.hatch * LINE / HATCH
            between, gone = fine[4, seen] > 0.5, fine[4, seen] < -0.5
            lit[between & ((right - down) % (_FINER * view.hatch) < wide)] = rgb(HATCH_BYTES)
            lit[gone & ((right + down) % (_FINER * view.hatch * DENSE / HATCH) < wide)] = rgb(NO_DATA_LINE)
        canvas.put(right, down, y * fall - z * rise, lit)
    middle = first[0] + 0.5 * turns * pitch
    side, span = 0.5 * canvas.width / scale, 0.5 * canvas.height / scale / fall
    return Shaded(canvas.mean(), -side, side, middle - span, middle + span)


def _rows(radius: Floats, sectors: int, turns: int, pitch: float, view: View, per_metre: float) -> Floats:
    """Return the depths, in turns, of the rows of points; rows are closer where the radius changes along the hole."""
    grid = radius[: (turns + 1) * sectors].reshape(turns + 1, sectors)
    slope = view.tube * view.shape * np.abs(np.diff(grid, axis=0)).max(axis=1) / abs(pitch)
    steep = np.maximum(slope, np.maximum(np.append(slope[1:], 0), np.append(0, slope[:-1])))  # of the neighbours, too
    drawn = np.append(0.0, np.cumsum(abs(pitch) * per_metre * np.hypot(1.0, 0.7 * steep)))
    rows: Floats = np.interp(np.linspace(0.0, drawn[-1], int(drawn[-1]) + 2), drawn, np.arange(turns + 1))
    return rows


def _columns(
    radius: Floats, sectors: int, start_toolface: float, view: View, largest: float, per_metre: float
) -> Floats:
    """Return the angles of the columns of points from ``view.facing``, radians; closer where the radius changes around.

    ``largest`` is the greatest exaggerated radius of these turns.
    """
    grid = radius[: radius.size // sectors * sectors].reshape(-1, sectors)
    step = np.abs(np.roll(grid, -1, axis=1) - grid).max(axis=0)  # from each sector to the next
    steep = np.maximum(step, np.maximum(np.roll(step, 1), np.roll(step, -1)))  # of the neighbours, too
    ends = np.linspace(-np.pi, np.pi, sectors + 1)
    middle = view.facing + np.degrees(0.5 * (ends[:-1] + ends[1:])) - start_toolface
    steep = view.tube * view.shape * steep[np.floor(middle / 360.0 * sectors).astype(int) % sectors]
    drawn = np.append(0.0, np.cumsum(per_metre * np.hypot(2 * np.pi / sectors * largest, steep)))
    columns: Floats = np.interp(np.linspace(0.0, drawn[-1], int(drawn[-1]) + 2), drawn, ends)
    return columns


def _resample(values: Floats, sectors: int, turn: Floats, around: Floats) -> Floats32:
    """Smooth values (n, channels) of a helix to a grid: (channels, depths in turns, toolfaces in turns from the first).

    A column of vertices lies a sector's share of a turn deeper than the column before. So each column is smoothed along
    its own depths first; then neighbouring columns are smoothed, without a seam. The B-splines are cubic, so that the
    shading shows no facets.
    """
    turns = values.shape[0] // sectors
    grid = values[: turns * sectors].reshape(turns, sectors, -1).astype(np.float32)
    column = np.arange(sectors)
    low, weights = _spline(turn[:, None] - column / sectors)
    by_column: Floats32 = np.zeros((turn.size, sectors, grid.shape[2]), dtype=np.float32)
    for step, weight in enumerate(weights, -1):
        by_column += weight[..., None] * grid[np.clip(low + step, 0, turns - 1), column]
    low, weights = _spline(around * sectors)
    across = np.zeros((sectors, around.size), dtype=np.float32)
    for step, weight in enumerate(weights, -1):
        across[(low + step) % sectors, np.arange(around.size)] += weight
    smooth: Floats32 = np.moveaxis(by_column, 2, 0) @ across
    return smooth


def _spline(at: Floats) -> tuple[Integers, tuple[Floats32, ...]]:
    """Return the integers below fractional indices, and the weights of a cubic B-spline at the four next to them."""
    low = np.floor(at).astype(np.int64)
    t = at - low
    weights = ((1 - t) ** 3, 3 * t**3 - 6 * t**2 + 4, -3 * t**3 + 3 * t**2 + 3 * t + 1, t**3)
    return low, tuple((weight / 6.0).astype(np.float32) for weight in weights)


def _normals(x: Floats32, y: Floats32, z: Floats32) -> Floats32:
    """Return unit normals (3, rows, columns) of the grid, away from the axis."""
    around = [np.gradient(p, axis=1) for p in (x, y)]
    along = [np.gradient(p, axis=0) for p in (x, y, z)]  # per row: only the direction matters
    normal = np.stack(
        [around[1] * along[2], -around[0] * along[2], around[0] * along[1] - around[1] * along[0]], dtype=np.float32
    )
    normal /= np.sqrt((normal**2).sum(axis=0)) * np.sign(normal[0] * x + normal[1] * y)
    return normal


def _light(normal: Floats32, facing: Floats32, colors: Floats32, rise: float, fall: float) -> Floats32:
    """Return colours (points, 3) under the lamps, with a soft shine; the inside, seen at the open end, is darker."""
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
    lit: Floats32 = np.clip((colors * bright + shine) * inside, 0, 1).T
    return lit


class _Canvas:
    """Pixels; each keeps the colour of the nearest of the points that are put on it."""

    def __init__(self, width: int, height: int) -> None:
        self.width, self.height = width, height
        self._colors = np.zeros((height * width, 4), dtype=np.float32)
        self._near = np.full(height * width, -np.inf, dtype=np.float32)

    def put(self, right: Floats32, down: Floats32, near: Floats32, colors: Floats32) -> None:
        """Draw points at pixels (right, down), (n,), with colours (n, 3); in a pixel the greatest ``near`` wins."""
        inside = (right >= 0) & (right < self.width) & (down >= 0) & (down < self.height)
        target = down.astype(np.int64) * self.width + right.astype(np.int64)
        inside[inside] &= near[inside] > self._near[target[inside]]
        order = np.flatnonzero(inside)
        order = order[np.argsort(near[order])]  # of several points on one pixel the nearest is written last
        self._near[target[order]] = near[order]
        self._colors[target[order], :3] = colors[order]
        self._colors[target[order], 3] = 1.0

    def mean(self) -> Floats32:
        """Return the picture at the size shown, with the share of each pixel that is covered as its opacity."""
        blocks = self._colors.reshape(self.height // _FINER, _FINER, self.width // _FINER, _FINER, 4)
        mean: Floats32 = blocks.mean(axis=(1, 3))
        covered = np.maximum(mean[..., 3:], np.float32(1e-6))
        mean[..., :3] = np.where(mean[..., 3:] > 0, mean[..., :3] / covered, 1.0)
        return mean

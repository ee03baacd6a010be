"""Pictures of a wall: the unrolled radius and an image beside a shaded view of a section, on one line of depth.

     T   R   B   L   T      T   R   B   L   T       depth grows downwards; the wall is cut open at toolface 0 and
    +---+---+---+---+      +---+---+---+---+        laid flat: top, right, bottom, left (or north, east, south, west)
    |    radius     |      |     gamma     |

Drawn with matplotlib, which comes with the extra ``plot`` and is imported here only when a picture is made.
Not here: the arithmetic of the shaded view (``shading``).
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from helibore.arrays import Floats
from helibore.shading import View, shade

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from helibore.wall import Wall

INK, FAINT, MISSING = "#22303c", "#8a97a3", "#b9bfc4"
SECTION = 9.0
"""Metres of hole in the shaded view."""
MAPS = {"radius": "viridis", "image": "YlOrBr"}
_SIDES = {"high-side": ("T", "R", "B", "L", "T"), "north": ("N", "E", "S", "W", "N")}


@dataclass(frozen=True)
class Track:
    """An image to draw beside the wall: rows (m), values (rows, sectors), and what they are.

    Sector j covers the toolfaces [j, j + 1) 360 / sectors.
    """

    depth: Floats
    values: Floats
    name: str
    unit: str


def require_matplotlib() -> None:
    """Raise an ImportError that names the extra, where matplotlib is not installed."""
    try:
        import matplotlib as _  # noqa: F401
    except ImportError as error:
        raise ImportError('a picture needs matplotlib: pip install "helibore[plot]"') from error


def overview(wall: Wall, track: Track, title: str, subtitle: str = "", reference: str = "high-side") -> Figure:
    """Return a figure of the unrolled radius, the track, and the section with most relief as a shaded body.

    Parameters
    ----------
    wall
        At least three turns.
    track
        Drawn beside the radius, and on the shaded body.
    title, subtitle
        Above the picture.
    reference
        ``"high-side"`` or ``"north"``: what toolface 0 is, for the letters.
    """
    require_matplotlib()
    from matplotlib.figure import Figure

    figure = Figure(figsize=(13.2, 9.4), dpi=150, facecolor="white")
    figure.text(0.055, 0.957, title, fontsize=19, fontweight="bold", color=INK, va="center")
    figure.text(0.055, 0.922, subtitle, fontsize=11.5, color=FAINT, va="center")
    bottom, height = 0.065, 0.735
    radius_axes = figure.add_axes((0.055, bottom, 0.235, height))
    track_axes = figure.add_axes((0.335, bottom, 0.235, height), sharey=radius_axes)
    solid_axes = figure.add_axes((0.645, bottom, 0.335, height))

    section = _section_of_most_relief(wall)
    over = (wall.radius - 0.5 * wall.settings.bit_diameter) * 1000.0
    high = np.ceil(np.nanpercentile(over, 99.8) / 5.0) * 5.0
    limits = (min(0.0, np.floor(np.nanpercentile(over, 0.1))), max(high, 1.0))
    radius_mesh = _draw_wall(radius_axes, wall, over, limits)
    track_limits = tuple(np.nanpercentile(track.values, [1, 99]))
    track_mesh = _draw_track(track_axes, track, track_limits)
    _scale_bar(figure, radius_axes, radius_mesh, "Radius beyond bit size [mm]")
    _scale_bar(figure, track_axes, track_mesh, f"{track.name} [{track.unit}]")
    for axes in (radius_axes, track_axes):
        _dress_track(axes, reference, section)
    radius_axes.set_ylim(wall.depth.max(), wall.depth.min())
    radius_axes.set_ylabel("Measured depth [m]", fontsize=11, color=INK)
    track_axes.tick_params(labelleft=False)
    _draw_solid(solid_axes, wall, track, track_limits, section)
    return figure


def save_png(figure: Figure, path: str | Path) -> None:
    """Write the figure as PNG, whole or not at all."""
    from helibore.atomic_file import write_whole

    content = io.BytesIO()
    figure.savefig(content, format="png")
    write_whole(path, lambda file: file.write(content.getvalue()))


def _section_of_most_relief(wall: Wall) -> tuple[int, int]:
    """Turns [first, last) of the section whose radius varies most."""
    sectors, pitch = wall.settings.sectors, abs(wall.settings.pitch)
    turns = len(wall) // sectors
    length = min(turns, max(3, round(SECTION / pitch)))
    by_turn = wall.radius[: turns * sectors].reshape(turns, sectors)
    relief = np.nan_to_num(np.nanmax(by_turn, axis=1) - np.nanmedian(by_turn))
    relief[np.isnan(by_turn).any(axis=1)] = -1e3
    sums = np.convolve(np.minimum(relief, np.percentile(relief, 90)), np.ones(length), mode="valid")
    first = int(np.argmax(sums))
    return first, first + length


def _draw_wall(axes: Axes, wall: Wall, values: Floats, limits: tuple[float, float]) -> Any:
    """Each vertex as a cell centred on it, where it really lies on the helix; repeated, to cover the cut at 0."""
    from matplotlib import colormaps

    sectors, pitch = wall.settings.sectors, wall.settings.pitch
    turns = len(wall) // sectors
    row, column = np.meshgrid(np.arange(turns + 1) - 0.5, np.arange(sectors + 1) - 0.5, indexing="ij")
    depth = wall.depth[0] + (row + column / sectors) * pitch
    toolface = wall.settings.start_toolface + column * (360.0 / sectors)
    colors = colormaps[MAPS["radius"]].with_extremes(bad=MISSING)
    cells = np.ma.masked_invalid(values[: turns * sectors].reshape(turns, sectors))
    for turn in (-360.0, 0.0, 360.0):
        whole = pitch * np.sign(turn)
        mesh = axes.pcolormesh(
            toolface + turn, depth + whole, cells, cmap=colors, vmin=limits[0], vmax=limits[1], rasterized=True
        )
    return mesh


def _draw_track(axes: Axes, track: Track, limits: tuple[float, float]) -> Any:
    from matplotlib import colormaps

    step = np.diff(track.depth).mean()
    edges = np.append(track.depth - 0.5 * step, track.depth[-1] + 0.5 * step)
    toolface = np.linspace(0.0, 360.0, track.values.shape[1] + 1)
    colors = colormaps[MAPS["image"]].with_extremes(bad=MISSING)
    cells = np.ma.masked_invalid(track.values)
    return axes.pcolormesh(toolface, edges, cells, cmap=colors, vmin=limits[0], vmax=limits[1], rasterized=True)


def _scale_bar(figure: Figure, axes: Axes, mesh: Any, label: str) -> None:
    """A colour bar over the track, as wide as it, as the head of a log."""
    box = axes.get_position()
    bar = figure.add_axes((box.x0, box.y1 + 0.042, box.width, 0.013))
    figure.colorbar(mesh, cax=bar, orientation="horizontal")
    bar.xaxis.set_ticks_position("top")
    bar.xaxis.set_label_position("top")
    bar.set_xlabel(label, fontsize=11, color=INK, labelpad=6)
    bar.tick_params(labelsize=9, color=FAINT, labelcolor=INK, length=3)
    for spine in bar.spines.values():
        spine.set_visible(False)
    bar.set_frame_on(False)


def _dress_track(axes: Axes, reference: str, section: tuple[int, int]) -> None:
    axes.set_xlim(0, 360)
    axes.set_xticks([0, 90, 180, 270, 360], _SIDES[reference])
    axes.xaxis.set_ticks_position("top")
    axes.tick_params(labelsize=10, color=FAINT, labelcolor=INK, length=3)
    for x in (90, 180, 270):
        axes.axvline(x, color="white", linewidth=0.6, alpha=0.45)
    for spine in axes.spines.values():
        spine.set_color(FAINT)
        spine.set_linewidth(0.8)
    del section


def _draw_solid(axes: Axes, wall: Wall, track: Track, limits: tuple[float, float], section: tuple[int, int]) -> None:
    from matplotlib import colormaps

    settings = wall.settings
    sectors = settings.sectors
    first, last = section[0] * sectors, section[1] * sectors
    radius = wall.radius[first:last]
    radius = np.where(np.isnan(radius), np.nanmedian(radius), radius)
    row = np.clip(np.searchsorted(track.depth, wall.depth[first:last]), 0, track.depth.size - 1)
    column = (wall.toolface[first:last] / 360.0 * track.values.shape[1]).astype(int)
    share = (track.values[row, column] - limits[0]) / (limits[1] - limits[0])
    colors = colormaps[MAPS["image"]](np.clip(share, 0, 1))[:, :3]
    box = axes.get_position()
    figure = axes.get_figure(root=True)
    assert figure is not None
    width, height = figure.get_size_inches() * figure.dpi * (box.width, box.height)
    view = View(facing=135.0, width=int(width) // 2 * 2, height=int(height) // 2 * 2)
    picture = shade(
        radius, colors, sectors, settings.pitch, (float(wall.depth[first]), float(wall.toolface[first])),
        settings.bit_diameter, view,
    )  # fmt: skip
    axes.imshow(
        picture.pixels, extent=(picture.left, picture.right, picture.bottom, picture.top), aspect="auto",
        interpolation="antialiased",
    )  # fmt: skip
    axes.set_axis_off()

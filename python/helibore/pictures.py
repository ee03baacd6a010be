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
from helibore.caliper import BASIS_TEXT
from helibore.shading import View, shade

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from helibore.wall import Wall

INK, FAINT, MISSING = "#22303c", "#8a97a3", "#b9bfc4"
SECTION = 12.0
"""Metres of hole in the shaded view."""
MAPS = {"radius": "viridis", "image": "YlOrBr"}
_SIDES = {"high-side": ("T", "R", "B", "L", "T"), "north": ("N", "E", "S", "W", "N")}
_LEGENDS = {
    "high-side": "T top, R right, B bottom, L left of the hole, looking downhole; grey: no sample in reach",
    "north": "N, E, S, W: toolface from north, clockwise looking downhole; grey: no sample in reach",
}


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


def overview(
    wall: Wall, track: Track, title: str, subtitle: str = "", reference: str = "high-side", dpi: int = 150
) -> Figure:
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
    dpi
        Pixels an inch; the figure is 13.2 by 9.4 inches.
    """
    require_matplotlib()
    from matplotlib.figure import Figure

    figure = Figure(figsize=(13.2, 9.4), dpi=dpi, facecolor="white")
    figure.text(0.055, 0.957, title, fontsize=19, fontweight="bold", color=INK, va="center")
    figure.text(0.055, 0.922, subtitle, fontsize=11.5, color=FAINT, va="center")
    bottom, height = 0.07, 0.73
    radius_axes = figure.add_axes((0.055, bottom, 0.235, height))
    track_axes = figure.add_axes((0.325, bottom, 0.235, height), sharey=radius_axes)
    solid_axes = figure.add_axes((0.655, bottom, 0.325, height))

    over = (wall.radius - 0.5 * wall.settings.bit_diameter) * 1000.0
    high = np.ceil(np.nanpercentile(over, 99.8) / 5.0) * 5.0
    limits = (min(0.0, float(np.floor(np.nanpercentile(over, 0.1)))), max(float(high), 1.0))
    radius_mesh = _draw_wall(radius_axes, wall, over, limits)
    track_limits = (float(np.nanpercentile(track.values, 1)), float(np.nanpercentile(track.values, 99)))
    track_mesh = _draw_track(track_axes, track, track_limits)
    _scale_bar(figure, radius_axes, radius_mesh, "Radius beyond bit size [mm]")
    _scale_bar(figure, track_axes, track_mesh, f"{track.name} [{track.unit}]")
    for axes in (radius_axes, track_axes):
        _dress_track(axes, reference)
    radius_axes.set_ylim(wall.depth.max(), wall.depth.min())
    radius_axes.set_ylabel("Measured depth [m]", fontsize=11, color=INK)
    track_axes.tick_params(labelleft=False)
    section = _section_of_most_relief(wall)
    _draw_solid(solid_axes, wall, track, track_limits, section)
    _tie(figure, track_axes, solid_axes, [float(wall.depth[turn * wall.settings.sectors]) for turn in section])
    legend = _LEGENDS[reference]
    if wall.basis != "azimuthal":
        legend += f". NOT an image of the shape: {BASIS_TEXT[wall.basis]}"
    figure.text(0.055, 0.03, legend, fontsize=10, color=FAINT, va="center")
    return figure


def save_png(figure: Figure, path: str | Path) -> None:
    """Write the figure as PNG, whole or not at all."""
    from helibore.atomic_file import write_whole

    content = io.BytesIO()
    figure.savefig(content, format="png")
    write_whole(path, lambda file: file.write(content.getvalue()))


def _section_of_most_relief(wall: Wall) -> tuple[int, int]:
    """First and last turn of the section that holds most enlarged turns."""
    sectors, pitch = wall.settings.sectors, abs(wall.settings.pitch)
    turns = len(wall) // sectors
    length = min(turns, max(3, round(SECTION / pitch)))
    by_turn = wall.radius[: turns * sectors].reshape(turns, sectors)
    complete = ~np.isnan(by_turn).any(axis=1)
    largest = np.where(complete, by_turn.max(axis=1), -np.inf)
    usual, most = np.median(largest[complete]), largest.max()
    enlarged = np.where(complete, np.clip((largest - usual) / (0.4 * (most - usual) + 1e-9), 0, 1), -1)
    first = int(np.argmax(np.convolve(enlarged, np.ones(length), mode="valid")))
    return first, first + length - 1


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


def _dress_track(axes: Axes, reference: str) -> None:
    axes.set_xlim(0, 360)
    axes.set_xticks([0, 90, 180, 270, 360], _SIDES[reference])
    axes.xaxis.set_ticks_position("top")
    axes.tick_params(labelsize=10, color=FAINT, labelcolor=INK, length=3)
    for x in (90, 180, 270):
        axes.axvline(x, color="white", linewidth=0.6, alpha=0.45)
    for spine in axes.spines.values():
        spine.set_color(FAINT)
        spine.set_linewidth(0.8)


def _draw_solid(axes: Axes, wall: Wall, track: Track, limits: tuple[float, float], section: tuple[int, int]) -> None:
    """The section as a shaded body coloured by the track, seen 50 deg beside where it is largest."""
    from matplotlib import colormaps

    settings = wall.settings
    sectors = settings.sectors
    first, last = section[0] * sectors, (section[1] + 1) * sectors
    radius = wall.radius[first:last]
    radius = np.where(np.isnan(radius), np.nanmedian(radius), radius)
    row = np.clip(np.searchsorted(track.depth, wall.depth[first:last]), 0, track.depth.size - 1)
    column = (wall.toolface[first:last] / 360.0 * track.values.shape[1]).astype(int)
    share = (track.values[row, column] - limits[0]) / (limits[1] - limits[0])
    colors = colormaps[MAPS["image"]](np.clip(share, 0, 1))[:, :3]
    largest = wall.toolface[first + int(np.argmax(radius.reshape(-1, sectors).mean(axis=0)))]
    figure, box = axes.get_figure(root=True), axes.get_position()
    assert figure is not None
    width, height = (figure.get_size_inches() * figure.dpi * (box.width, box.height)).astype(int)
    view = View(facing=float((largest + 50.0) % 360.0), width=int(width), height=int(height))
    start = (float(wall.depth[first]), float(wall.toolface[first]))
    picture = shade(radius, colors, sectors, settings.pitch, start, settings.bit_diameter, view)
    edges = (picture.left, picture.right, picture.bottom, picture.top)
    axes.imshow(picture.pixels, extent=edges, aspect="auto", interpolation="antialiased")
    axes.set_facecolor("none")
    axes.set_xticks([])
    axes.tick_params(labelsize=10, color=FAINT, labelcolor=INK, length=3)
    for side in ("top", "right", "bottom"):
        axes.spines[side].set_visible(False)
    ends = sorted((start[0], float(wall.depth[last - 1])))
    axes.set_yticks(np.arange(np.ceil(ends[0]), ends[1] + 0.01, 2.0 if ends[1] - ends[0] > 6 else 0.5))
    axes.spines["left"].set_bounds(*ends)
    axes.spines["left"].set_color(FAINT)
    caption = (
        f"{ends[0]:.0f} to {ends[1]:.0f} m, coloured by {track.name.lower()}",
        f"diameter \u00d7 {view.tube:g} against depth, relief \u00d7 {view.shape:g} more; "
        f"seen from toolface {view.facing:.0f}\u00b0",
    )
    axes.text(0.5, 1.085, caption[0], transform=axes.transAxes, ha="center", fontsize=11, color=INK)
    axes.text(0.5, 1.052, caption[1], transform=axes.transAxes, ha="center", fontsize=9.5, color=FAINT)


def _tie(figure: Figure, track_axes: Axes, solid_axes: Axes, depths: list[float]) -> None:
    """Mark the section beside the track and tie its ends to the ends of the shaded body's depth axis."""
    from matplotlib.patches import ConnectionPatch

    track_axes.plot([366, 366], depths, color=INK, linewidth=2.2, clip_on=False, solid_capstyle="butt")
    for depth in depths:
        tie = ConnectionPatch(
            (368, depth),
            (-0.12, depth),
            track_axes.transData,
            solid_axes.get_yaxis_transform(),
            color=FAINT,
            linewidth=0.7,
        )
        figure.add_artist(tie)

"""Draw an interval of the wall as a shaded body, with its exaggeration in the caption.

    tube x 10     the diameter is drawn ten times larger than the depth
    shape x 3     the difference of radius and bit size is drawn three times larger than the tube

Where the wall has no radius, the body is grey and has the median radius. Planes that were picked, and the tops of named
intervals, are lines on the side that faces the viewer. ``shading`` draws the pixels.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from helibore.base.arrays import Floats
from helibore.base.colors import PICK_COLORS, TOP_COLOR
from helibore.base.errors import InputError
from helibore.logs.picks import PLANES
from helibore.plot.depth_scales import METRES, DepthUnit, Lines
from helibore.plot.hatching import HATCH, NO_DATA, faded, rgb
from helibore.plot.paper import FAINT, FONT, INK, LEAST, SMALL, USUAL, Sheet
from helibore.plot.picked import DASHES, angles_text, plane_depth, radius_of
from helibore.plot.shading import View, shade

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from helibore.base.colors import ColorScale
    from helibore.wall.wall import Wall

FINE = 130.0
"""Millimetres; a taller body has larger pixels, so that it does not take longer to draw."""
LENGTH = 12.0
"""Metres of hole in a body, unless another length is given."""
STEPS = (1.0, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0)
SLENDER = 5.5
"""Approximate ratio of a body's length to its width at bit size, both as drawn."""
MOST_SHAPE = 10.0
LEAST_RELIEF = 1e-4
"""Metres; a hole that differs less from bit size, as gauge hole does, has no shape to exaggerate."""
MOST_NOISE = 0.25
"""Slope along the hole, as drawn, that the noise of the radii from turn to turn has at most."""


@dataclass(frozen=True)
class Stretched:
    """Whole turns of a wall, from vertex ``first``: (turns, sectors) radius, metres, NaN where missing.

    ``depth`` holds the depths of two vertices: the first of the shallowest turn and the first of the deepest turn.
    ``toolface`` is the toolface of both vertices.
    """

    first: int
    radius: Floats
    depth: tuple[float, float]
    toolface: float


def most_relief(wall: Wall, top: float, bottom: float) -> tuple[float, float] | None:
    """Return the ends, metres, of the 12 m with most enlarged turns; None without a whole turn or without three turns.

    Only turns between ``top`` and ``bottom`` count.
    """
    sectors, pitch = wall.settings.sectors, wall.settings.pitch
    turns = len(wall) // sectors
    by_turn = wall.radius[: turns * sectors].reshape(turns, sectors)
    begins = wall.start_depth + pitch * np.arange(turns)
    inside = (begins >= top - 1e-9) & (begins <= bottom - abs(pitch) + 1e-9)
    complete = ~np.isnan(by_turn).any(axis=1) & inside
    count = min(int(inside.sum()), max(3, round(LENGTH / abs(pitch))))
    if count < 3 or not complete.any():
        return None
    largest = np.where(complete, by_turn.max(axis=1), -np.inf)
    usual, most = np.median(largest[complete]), largest.max()
    enlarged = np.where(complete, np.clip((largest - usual) / (0.4 * (most - usual) + 1e-9), 0, 1), -1)
    enlarged[~inside] = -turns
    first = int(np.argmax(np.convolve(enlarged, np.ones(count), mode="valid")))
    ends = sorted(wall.start_depth + pitch * at for at in (first, first + count - 1))
    return ends[0], ends[1]


def turns_between(wall: Wall, start: float, stop: float) -> Stretched:
    """Return the turns between two depths; raise InputError if they are fewer than three or have no radius."""
    sectors, pitch = wall.settings.sectors, wall.settings.pitch
    turns = len(wall) // sectors
    ends = sorted(((start - wall.start_depth) / pitch, (stop - wall.start_depth) / pitch))
    low, high = max(round(ends[0]), 0), min(round(ends[1]), turns - 1)
    if high - low < 2:
        depth = wall.depth
        there = f"the wall reaches from {depth.min():g} to {depth.max():g} m"
        raise InputError(f"3-D view of {start:g} to {stop:g} m", f"must hold three turns of the wall; {there}")
    radius = wall.radius[low * sectors : (high + 1) * sectors].reshape(-1, sectors)
    if np.isnan(radius).all():
        raise InputError(f"3-D view of {start:g} to {stop:g} m", "the wall has no radius there")
    depths = sorted(wall.start_depth + pitch * at for at in (low, high))
    first = low * sectors
    return Stretched(first, radius, (depths[0], depths[1]), wall.settings.start_toolface)


def exaggeration(one: Stretched, bit_diameter: float) -> tuple[float, float]:
    """Return the factors tube and shape, from `STEPS`, that give a body the usual slenderness and visible relief.

    The narrowest place keeps a radius above 0 as drawn: with a larger shape the body would turn inside out. Where the
    noise would look like a wound rope, the shape is smaller.
    """
    length = one.depth[1] - one.depth[0]
    over = one.radius - 0.5 * bit_diameter
    relief, narrow = float(np.nanmax(np.abs(over))), float(np.nanmin(over))
    tube = _nearest_step(length / SLENDER / bit_diameter)
    if relief < LEAST_RELIEF:
        return tube, 1.0
    noise = tube * _noise(one.radius) / (length / (len(one.radius) - 1))
    most = min(_nearest_step(0.45 * bit_diameter / relief), MOST_SHAPE, MOST_NOISE / max(noise, 1e-9))
    return tube, max((step for step in STEPS if step <= most and 0.5 * bit_diameter + step * narrow > 0), default=1.0)


def _noise(radius: Floats) -> float:
    """Return the standard deviation of radii, metres, that are compared with both neighbours; relief is smoother."""
    bends = [np.abs(np.diff(radius, 2, axis=axis)) for axis in (0, 1)]
    known = [bend[~np.isnan(bend)] for bend in bends]
    return min((float(np.median(each)) / 0.6745 / 6**0.5 for each in known if each.size), default=0.0)


def _nearest_step(value: float) -> float:
    return min(STEPS, key=lambda step: abs(np.log(step / value)))


def draw_solid(
    sheet: Sheet, box: tuple[float, float, float, float], wall: Wall, one: Stretched, scale: ColorScale, values: Floats,
    name: str, interpolated: Floats | None = None, unit: DepthUnit = METRES,
) -> Axes:  # fmt: skip
    """Draw a stretch of the wall as a body with its depth axis and its caption.

    ``box`` is left, top, width and height in millimetres; the caption takes the top 10 mm. ``scale`` makes colours
    of ``values``, one for each vertex of the stretch, NaN where missing; the caption calls them ``name``. Vertices of
    the wall at which ``interpolated`` is 1 are hatched, and those without a radius.
    """
    x, y, width, height = box
    settings = wall.settings
    sectors, bit = settings.sectors, settings.bit_diameter
    flat = one.radius.ravel()
    gone = np.isnan(flat)
    body = np.where(gone, np.nanmedian(flat), flat)
    colors = scale.colors(values)[:, :3] / 255.0
    between = None if interpolated is None else interpolated[one.first : one.first + flat.size] > 0.5
    if between is not None:
        colors[between] = faded(colors[between], 1.0)
    colors[gone] = rgb(NO_DATA)
    lines = np.where(gone, -1.0, 0.0 if between is None else between) if gone.any() or between is not None else None
    largest = settings.start_toolface + 360.0 / sectors * int(np.argmax(body.reshape(-1, sectors).mean(axis=0)))
    tube, shape = exaggeration(one, bit)
    fine = min(1.0, FINE / height)
    view = View(
        facing=float((largest + 50.0) % 360.0), tube=tube, shape=shape,
        width=round(fine * sheet.pixels(width - 14.0)), height=round(fine * sheet.pixels(height - 10.0)),
        hatch=max(round(fine * sheet.pixels(HATCH)), 2),
    )  # fmt: skip
    start = (wall.start_depth + one.first // sectors * settings.pitch, settings.start_toolface)
    picture = shade(body, colors, sectors, settings.pitch, start, bit, view, lines)
    axes = sheet.axes(x + 14.0, y + 10.0, width - 14.0, height - 10.0)
    edges = (picture.left, picture.right, picture.bottom, picture.top)
    axes.imshow(picture.pixels, extent=edges, aspect="auto", interpolation="none")
    _draw_rings(axes, wall, one, body.reshape(-1, sectors), view)
    _draw_depth_axis(axes, one, unit)
    ends = " to ".join(f"{depth / unit.metres:.0f}" for depth in one.depth)
    title = f"{ends} {unit.name}, coloured by {name}"
    sheet.text(x + 0.5 * width, y + 2.5, title, USUAL, within=width, ha="center", weight="bold")
    more = f", shape × {shape:g} more" if shape != 1 else ""
    words = f"tube × {tube:g} against depth{more}; seen from toolface {view.facing:.0f}°; bar right of the tracks"
    sheet.text(x + 0.5 * width, y + 6.5, words, SMALL, within=width, ha="center", color=FAINT)
    return axes


def _draw_rings(axes: Axes, wall: Wall, one: Stretched, radius: Floats, view: View) -> None:
    """Draw the front of the picked planes, each with its dip, and of the tops, each with its name."""
    bit, (top, bottom), pitch = wall.settings.bit_diameter, one.depth, wall.settings.pitch
    toolface = view.facing + np.arange(-90.0, 91.0, 3.0)
    around = ((toolface - wall.settings.start_toolface) / 360 * radius.shape[1]).round().astype(int)
    smooth = np.mean([np.roll(radius, turn, axis=1) for turn in range(-2, 3)], axis=0)  # the body is smooth, too
    first = wall.start_depth + one.first // radius.shape[1] * pitch
    every = np.radians(360 / radius.shape[1] * np.arange(radius.shape[1]) + wall.settings.start_toolface - view.facing)

    def ring(depth: Floats, text: str, color: str, side: int = 1, **look: Any) -> None:
        if not (depth.min() >= top and depth.max() <= bottom):
            return
        turns = np.clip(np.round((depth - first) / pitch).astype(int), 0, len(radius) - 1)
        reach = view.tube * (0.5 * bit + view.shape * (smooth[turns, around % radius.shape[1]] - 0.5 * bit))
        psi = np.radians(toolface - view.facing)
        across, down = -reach * np.sin(psi), depth + reach * np.cos(psi) * math.tan(math.radians(view.tilt))
        axes.plot(across, down, color="white", linewidth=2.0, zorder=5)
        axes.plot(across, down, color=color, linewidth=1.1, zorder=6, **look)
        end = int((side * across).argmax())
        whole = view.tube * (0.5 * bit + view.shape * (smooth[turns[end]] - 0.5 * bit))  # what is behind may be wider
        edge = side * (-side * whole * np.sin(every)).max()
        place: dict[str, Any] = {"va": "center", "size": LEAST, "family": FONT, "color": color, "clip_on": False}
        away = side * 0.02 * float(np.diff(axes.get_xlim())[0])
        axes.text(edge + away, down[end], text, ha="left" if side > 0 else "right", **place)

    for pick in wall.picks:
        if pick.kind in PLANES:
            depth = plane_depth(pick, radius_of(pick, bit), toolface)
            ring(
                depth,
                angles_text(pick, wall.path) + ("" if wall.path else " apparent"),
                PICK_COLORS[pick.kind],
                dashes=DASHES.get(pick.kind, (None, None)),
            )
    for each in wall.intervals:
        if not each.track and each.start is not None:
            ring(np.full(toolface.shape, each.start), each.name, TOP_COLOR, side=-1)


def _draw_depth_axis(axes: Axes, one: Stretched, unit: DepthUnit) -> None:
    """Draw a depth axis beside the body, as long as the body."""
    top, bottom = one.depth
    lines = Lines.of(max(int((bottom - top) * 8), 1), unit)
    axes.set_xticks([])
    axes.set_facecolor("none")
    ticks = list(lines.major(top, bottom))
    axes.set_yticks(ticks, [lines.label(at) for at in ticks])
    axes.tick_params(labelsize=SMALL, color=FAINT, labelcolor=INK, length=2, labelfontfamily=FONT)
    axes.set_ylabel(f"Depth MD [{unit.name}]", fontsize=SMALL, color=INK, family=FONT)
    for side in ("top", "right", "bottom"):
        axes.spines[side].set_visible(False)
    axes.spines["left"].set_bounds(top, bottom)
    axes.spines["left"].set_color(FAINT)

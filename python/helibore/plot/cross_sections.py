"""Cross sections of the hole, with one scale for both axes, the circle of the bit, and the samples.

      U                 each sector has one point, its vertex that is nearest to the depth;
   .-----.              dots are the samples within half a pitch; a grey wedge is a sector without a radius
L |   +   | R
   '-----'              looking downhole, clockwise
      D
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from helibore.base.arrays import Floats, Mask
from helibore.base.colors import FILL_COLORS
from helibore.base.errors import InputError
from helibore.plot.depth_scales import DepthUnit, length_text
from helibore.plot.diameters import Diameters
from helibore.plot.hatching import HATCH_BYTES, NO_DATA, NO_DATA_LINE, rgb
from helibore.plot.paper import INK, RULE, SMALL, USUAL, Sheet
from helibore.plot.tracks import LENGTHS, SIDES

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from helibore.logs.zones import Zone
    from helibore.wall.wall import Wall

WIDTH, HEIGHT = 47.0, 54.0
"""Width and height of a section with its caption, millimetres."""

MOST = 4
"""Greatest number of sections that are chosen by themselves."""


@dataclass(frozen=True)
class CrossSection:
    """The wall at a depth: toolfaces (deg) and radii (m, NaN where missing) of the sectors, and the samples near it.

    ``interpolated``: (sectors,) whether the radius is interpolated, not measured.
    """

    depth: float
    toolface: Floats
    radius: Floats
    interpolated: Mask
    sample_toolface: Floats
    sample_radius: Floats


def sections_at(wall: Wall, depths: list[float], interpolated: Floats | None = None) -> list[CrossSection]:
    """Return the cross section of the wall at each depth; raise InputError if the wall does not reach a depth.

    ``interpolated``: (n,) 1 at vertices whose radius is interpolated, else 0; None: no vertex is.
    """
    settings = wall.settings
    K, pitch = settings.sectors, settings.pitch
    radius, samples = wall.radius, wall.samples
    ends = sorted((wall.start_depth, wall.start_depth + (radius.size - 1) * pitch / K))
    column = np.arange(K)
    toolface: Floats = settings.start_toolface + column.astype(np.float64) * (360.0 / K)
    cut = []
    for depth in depths:
        if not ends[0] <= depth <= ends[1]:
            raise InputError(f"polar section at {depth:g} m", f"the wall reaches from {ends[0]:g} to {ends[1]:g} m")
        turn = np.rint((depth - wall.start_depth) / pitch - column / K).astype(np.int64)
        vertex = turn * K + column
        there = (turn >= 0) & (vertex < radius.size)
        vertex = np.clip(vertex, 0, radius.size - 1)
        across = np.where(there, radius[vertex], np.nan)
        between = np.zeros(K, dtype=bool) if interpolated is None else np.isfinite(across) & (interpolated[vertex] > 0)
        near = np.abs(samples.depth - depth) <= 0.5 * abs(pitch)
        cut.append(CrossSection(depth, toolface, across, between, samples.toolface[near], samples.radius[near]))
    return cut


def telling_depths(turns: Diameters, top: float, bottom: float, zones: Sequence[Zone] = ()) -> list[float]:
    """Return up to four depths for sections, metres: of the worst zone of each kind and of a usual turn.

    Where these are fewer, also of the largest, the most oval and the smallest turn. Only depths between ``top`` and
    ``bottom`` count, and turns with an area and with diameters of all arms.
    """
    ovality = turns.greatest - turns.least
    inside = (turns.depth >= top) & (turns.depth <= bottom) & np.isfinite(turns.area) & np.isfinite(ovality)
    if not inside.any():
        return []
    worst: dict[str, float] = {}
    for zone in sorted(zones, key=lambda zone: -zone.severity):
        if top <= zone.peak <= bottom:
            worst.setdefault(zone.kind, zone.peak)
    area, oval, depth = turns.area[inside], ovality[inside], turns.depth[inside]
    usual = np.abs(area - np.median(area)) + np.abs(oval - np.median(oval))
    apart = 0.03 * (bottom - top)
    chosen: list[float] = []
    turn_depths = (depth[at] for at in (np.argmin(usual), np.argmax(area), np.argmax(oval), np.argmin(area)))
    for wanted in (*list(worst.values())[: MOST - 1], *turn_depths):
        if len(chosen) < MOST and all(abs(wanted - other) >= apart for other in chosen):
            chosen.append(float(wanted))
    return sorted(chosen)


def largest_shown(sections: list[CrossSection], bit_diameter: float) -> float:
    """Return the radius, metres, to which all sections are drawn, so that they have one scale."""
    radii = [one.radius[np.isfinite(one.radius)].max(initial=0.5 * bit_diameter) for one in sections]
    return 1.08 * max(float(radius) for radius in radii)


def draw_section(
    sheet: Sheet, x: float, y: float, section: CrossSection, name: str, look: tuple[float, float, str, str, DepthUnit]
) -> Axes:
    """Draw a section with its caption; ``look``: bit diameter, radius to draw to (m), unit, reference, depth unit."""
    bit, outer, unit, reference, depths = look
    size = HEIGHT - 14.0
    middle = x + 0.5 * WIDTH
    sheet.text(
        middle, y + 2.0, f"{name}   {depths.text(section.depth)} {depths.name}", USUAL, ha="center", weight="bold"
    )
    axes = sheet.axes(middle - 0.5 * size, y + 7.5, size, size)
    axes.set_axis_off()
    axes.set_aspect("equal")
    axes.set_xlim(-1.02 * outer, 1.02 * outer)
    axes.set_ylim(-1.02 * outer, 1.02 * outer)
    scale = LENGTHS[unit]
    power = 10.0 ** np.floor(np.log10(outer / scale / 3))
    step = float(next(power * each for each in (1, 2, 5, 10) if power * each >= outer / scale / 4))
    for ring in np.arange(step, outer / scale * 1.0001, step):
        _circle(axes, ring * scale, color=RULE, linewidth=0.3, alpha=0.7)
    for angle in range(0, 360, 45):
        ray = _xy(np.full(2, float(angle)), np.array([0.0, outer]))
        axes.plot(*ray, color=RULE, linewidth=0.3, alpha=0.7)
    _fill(axes, section, 0.5 * bit, outer)
    _circle(axes, 0.5 * bit, color=INK, linewidth=0.8, dashes=(4, 2))
    axes.plot(*_xy(section.sample_toolface, section.sample_radius), ".", color="#23415f", markersize=1.4, alpha=0.6)
    closed = np.append(np.arange(section.radius.size), 0)
    axes.plot(*_xy(section.toolface[closed], section.radius[closed]), color="#b3261e", linewidth=0.9)
    for side, (right, up) in zip(SIDES[reference], ((0, 1), (1, 0), (0, -1), (-1, 0)), strict=True):
        centre = y + 7.5 + 0.5 * size
        place = (middle + right * (0.5 * size + 1.8), centre - up * (0.5 * size + 1.8))
        if right and len(side) > 1:  # degrees are too wide for the gap between two sections
            place = (middle + right * 0.3 * size, centre - 1.2)
        sheet.text(*place, side, SMALL, ha="center")
    there = np.isfinite(section.radius)
    words = f"rings each {step:g} {unit}" + ("" if there.all() else f"; {100 * (1 - there.mean()):.0f} % missing")
    words += f"; {100 * section.interpolated.mean():.0f} % interpolated" if section.interpolated.any() else ""
    sheet.text(middle, y + HEIGHT - 1.0, words, SMALL, ha="center", within=WIDTH - 2)
    return axes


def key_text(bit_diameter: float, unit: str, pitch: float, hatched: bool) -> str:
    """Return one line that explains the lines and colours of the sections."""
    size, near = length_text(bit_diameter / LENGTHS[unit], unit), f"{500 * abs(pitch):g} mm"
    signs = f"Red: wall; dashed: bit, {size}; orange: over bit; blue: under bit; dots: samples within {near}"
    gaps = "grey: no sample in reach" + ("; falling lines: interpolated" if hatched else "")
    return f"Cross sections, looking downhole. {signs}; {gaps}"


def _fill(axes: Axes, section: CrossSection, bit: float, outer: float) -> None:
    """Fill orange over the bit, blue under it, grey wedges under rising lines where the radius is missing.

    Interpolated sectors are under falling lines.
    """
    K = section.radius.size
    finer = max(720 // K, 1)
    fine = section.toolface[0] + np.linspace(0.0, 360.0, finer * K + 1)
    place = np.arange(fine.size) / finer
    left = np.floor(place).astype(int)
    r = section.radius
    radius = r[left % K] + (place - left) * (r[(left + 1) % K] - r[left % K])
    shown = np.where(np.isnan(radius), bit, radius)
    for other, color in ((np.maximum(shown, bit), FILL_COLORS["over"]), (np.minimum(shown, bit), FILL_COLORS["under"])):
        inner = _xy(fine, np.full(fine.size, bit))
        ring = [np.append(a, b[::-1]) for a, b in zip(_xy(fine, other), inner, strict=True)]
        _patch(axes, ring, color)
    for j in np.flatnonzero(np.isnan(r) | section.interpolated):
        arc = section.toolface[j] + np.linspace(-180.0 / K, 180.0 / K, 8)
        x, y = _xy(arc, np.full(8, outer if np.isnan(r[j]) else r[j]))
        wedge = [np.append(x, 0.0), np.append(y, 0.0)]
        if np.isnan(r[j]):
            _patch(axes, wedge, rgb(NO_DATA))
            _patch(axes, wedge, "none", "//////", rgb(NO_DATA_LINE))
        else:
            _patch(axes, wedge, "none", "\\\\\\\\", rgb(HATCH_BYTES))


def _patch(
    axes: Axes, outline: list[Floats], color: str | tuple[float, ...], hatch: str | None = None, lines: Any = "none"
) -> None:
    """Draw a filled or hatched outline. matplotlib does not measure it, because the limits of the axes are set."""
    from matplotlib.patches import Polygon

    look = {"hatch": hatch, "edgecolor": lines, "linewidth": 0.0} if hatch else {"edgecolor": "none"}
    axes.add_artist(Polygon(np.column_stack(outline), facecolor=color, **look))


def _xy(toolface: Floats, radius: Floats) -> tuple[Floats, Floats]:
    phi = np.radians(toolface)
    return radius * np.sin(phi), radius * np.cos(phi)


def _circle(axes: Axes, radius: float, **look: object) -> None:
    around = np.linspace(0.0, 360.0, 181)
    axes.plot(*_xy(around, np.full(181, radius)), **look)  # type: ignore[arg-type]

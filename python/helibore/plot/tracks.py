"""Draw the tracks of a log: depth, caliper, curves and images, each with its head, all at the same depths.

    |  Depth |     Caliper [in]     |   Over bit radius  |      GR [gAPI]     |     heads
    |        | 6 ................ 9 |   0 [======] 40 mm |    0 [=====] 150   |
    |        |                      |  U   R   D   L   U |  U   R   D   L   U |
    |  2010 -|------(--)------------|--------------------|--------------------|     depth lines across all
    |        |       \\              |                    |                    |

A track has a width and draws itself between two depths; ``log`` places it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from helibore.base.arrays import Floats
from helibore.base.colors import FILL_COLORS, ZONE_COLORS, ColorScale, ink_on
from helibore.base.errors import InputError
from helibore.base.units import INCH, MILLIMETRE
from helibore.images.sector_image import SectorImage
from helibore.logs.curves import ScalarCurve
from helibore.logs.volume_ticks import VolumeTicks
from helibore.logs.zones import Zone
from helibore.plot.depth_scales import METRES, DepthUnit, Lines, length_text
from helibore.plot.diameters import Diameters, thinned
from helibore.plot.hatching import HATCH_BYTES, hatch
from helibore.plot.paper import FAINT, FONT, INK, LEAST, LINE, RULE, SMALL, USUAL, Sheet
from helibore.plot.raster import Grid, unroll_image, unroll_wall
from helibore.samples.caliper import Basis
from helibore.settings.wall_settings import Settings
from helibore.trajectory.true_depth import TrueDepth

if TYPE_CHECKING:
    from matplotlib.axes import Axes

HEAD = 24.0
"""Height of the head over every track, millimetres."""
SIDES = {
    "high-side": ("U", "R", "D", "L"),
    "north": ("N", "E", "S", "W"),
    "parallel-transport": ("0°", "90°", "180°", "270°"),
    "": ("0°", "90°", "180°", "270°"),
}
"""Names of the toolfaces 0, 90, 180 and 270, by what toolface 0 is; "" if that is not known."""
SCALAR = "#1d6b3a"
"""Colour of the line of a `ScalarCurve`."""
AREA = "#b3261e"
LETTERS = {"washout": "W", "breakout": "B", "key seat": "K", "undergauge": "U"}
"""Letters of the kinds of zones, beside their colours."""
STRIP = 0.2
"""Share of the depth track that the zones take."""
EDGE = 0.8
"""Width of the edge of a hollow zone, points."""
CURVES: dict[str, dict[str, Any]] = {
    "C1": {"color": "#0b4f8a"},
    "C2": {"color": "#0b4f8a", "dashes": (2.0, 1.0)},
    "D0": {"color": "#7a2a80"},
    "D90": {"color": "#7a2a80", "dashes": (2.0, 1.0)},
}
"""The lines of the diameters: C1 and C2 have one colour, D0 and D90 another; the second of each pair is dashed."""
ON_PAPER: dict[str, Any] = {"zorder": 7, "bbox": {"facecolor": "white", "edgecolor": "none", "pad": 0.3}}
"""The look of a number over which no line is drawn, such as that of a top."""
LEAST_LINE: dict[str, Any] = {"color": "#7d8894", "linewidth": 0.5}
"""The line of the least diameter, which fills blue to bit size."""


@dataclass(frozen=True)
class Stretch:
    """A stretch of hole on paper: from ``top`` to ``bottom`` metres, ``height`` millimetres from ``y`` down."""

    top: float
    bottom: float
    y: float
    height: float
    lines: Lines


@dataclass(frozen=True)
class Shown:
    """The scale and texts of an image track.

    ``remark`` goes under the name of the track. ``beyond`` of ``count`` values lie outside ``scale.low`` to
    ``scale.high``, the ends of the colour bar, and have the colour of the nearer end. If ``shares``, colours stand for
    no fixed values, and the bar says low and high. ``dropped`` values are not above 0, and are drawn as missing.
    """

    name: str
    unit: str
    scale: ColorScale
    remark: str = ""
    shares: bool = False
    beyond: int = 0
    count: int = 0
    dropped: int = 0

    @property
    def note(self) -> str:
        """The note under the colour bar: whether it is logarithmic, how many values it lacks or cuts."""
        share = 100 * self.beyond / max(self.count, 1)
        cut = f"{self.beyond:,} beyond the ends ({share:.2g}\u00a0%)" if self.beyond else ""
        dropped = f"{self.dropped:,} not above 0: no data" if self.dropped else ""
        return ", ".join(part for part in ("logarithmic" if self.scale.log else "", dropped, cut) if part)


def zone_look(kind: str, sure: bool) -> tuple[str, str, str]:
    """Return the colours of the face, the edge and the letter of a zone: a zone whose kind is not sure is hollow."""
    color = ZONE_COLORS[kind]
    return (color, color, ink_on(color)) if sure else ("white", color, INK)


class DepthTrack:
    """Measured depth, the true depth under it if it is known, and the zones at the left."""

    width = least = 14.0

    def __init__(
        self, scale: int, true_depth: TrueDepth | None = None, zones: Sequence[Zone] = (), unit: DepthUnit = METRES
    ) -> None:
        self.scale, self.true_depth, self.zones, self.unit = scale, true_depth, zones, unit
        self._middle = 0.57  # place of the numbers across the track, between zones and lines

    def head(self, sheet: Sheet, x: float, y: float) -> None:
        """Write what the numbers are, and the scale of the paper."""
        middle = x + 0.5 * self.width
        for down, text in ((8.0, "Depth"), (12.0, f"MD [{self.unit.name}]"), (19.0, f"1:{self.scale}")):
            sheet.text(middle, y + down, text, ha="center")
        if self.true_depth is not None:
            sheet.text(middle, y + 15.2, f"{self.true_depth.name} [{self.unit.name}]", SMALL, ha="center", color=FAINT)

    def draw(self, sheet: Sheet, x: float, stretch: Stretch) -> Axes:
        """Draw the depth lines with their numbers, and the zones at the left."""
        axes = bare_axes(sheet, x, self.width, stretch)
        room = 1.3 * (stretch.bottom - stretch.top) / stretch.height  # half a line of text, in metres
        for depth in stretch.lines.major(stretch.top, stretch.bottom):
            if stretch.top + room <= depth <= stretch.bottom - room:
                look: dict[str, Any] = {"ha": "center", "va": "center", "size": USUAL, "family": FONT, **ON_PAPER}
                axes.text(self._middle, depth, stretch.lines.label(depth), **look)
                if depth + 3.1 * room <= stretch.bottom:
                    self._draw_true_depth(axes, depth, depth + 2.1 * room)
        self._draw_ends(axes, stretch, room)
        axes.set_xlim(0, 1)
        major, minor = (lines(stretch.top, stretch.bottom) for lines in (stretch.lines.major, stretch.lines.minor))
        for zone in self.zones:
            ends = (max(zone.start, stretch.top), min(zone.stop, stretch.bottom))
            if ends[1] > ends[0]:
                face, edge, ink = zone_look(zone.kind, zone.sure)
                width = 0.0 if zone.sure else EDGE
                axes.axhspan(*ends, 0.0, STRIP, facecolor=face, edgecolor=edge, linewidth=width)
                long = (ends[1] - ends[0]) * stretch.height / (stretch.bottom - stretch.top)
                word = zone.kind if long > 1.5 * len(zone.kind) + 1.0 else LETTERS[zone.kind] if long > 2.2 else ""
                look = {"ha": "center", "va": "center", "size": SMALL, "family": FONT}
                look |= {"rotation": 90.0} if len(word) > 1 else {}
                axes.text(0.5 * STRIP, sum(ends) / 2, word, color=ink, weight="bold", **look)
        for left, right, short in ((0.0, 0.12, 0.06), (1.0, 0.9, 0.94)):
            axes.hlines(major, left, right, color=INK, linewidth=0.6)
            axes.hlines(minor, left, short, color=RULE, linewidth=0.4)
        return axes

    def _draw_ends(self, axes: Axes, stretch: Stretch, room: float) -> None:
        """Write the depths of both ends of the stretch, unless another number is near."""
        look: dict[str, Any] = {"ha": "center", "size": USUAL, "family": FONT, **ON_PAPER}
        major = list(stretch.lines.major(stretch.top + room, stretch.bottom - room))
        if all(depth - stretch.top > 3.2 * room for depth in major):
            axes.text(self._middle, stretch.top + 0.6 * room, f"{stretch.top / self.unit.metres:.1f}", va="top", **look)
        if all(stretch.bottom - depth > 5.4 * room for depth in major):
            text = f"{stretch.bottom / self.unit.metres:.1f}"
            axes.text(self._middle, stretch.bottom - 0.6 * room, text, va="bottom", **look)

    def _draw_true_depth(self, axes: Axes, depth: float, place: float) -> None:
        """Write the true depth of ``depth``, if it is known, at ``place``, a depth on the track."""
        true = np.nan if self.true_depth is None else float(self.true_depth.at(np.array([depth]))[0])
        if np.isfinite(true):
            look: dict[str, Any] = {"ha": "center", "va": "center", "size": SMALL, "family": FONT, "color": FAINT}
            look |= ON_PAPER
            axes.text(self._middle, place, f"{true / self.unit.metres:.1f}", **look)


class CaliperTrack:
    """Diameters against bit size: orange from bit to C2, pale from C2 to C1; blue from the least to bit.

    C1, C2 and the least diameter decide the kind of a zone. For a turn with a missing radius, the greatest of the known
    diameters takes the place of C1.

    Parameters
    ----------
    turns
        The diameters to draw.
    basis
        What was measured; a caliper without directions gives no least and greatest diameter. A gauge hole has no
        caliper track.
    bit_diameter
        Metres.
    unit
        ``"in"`` or ``"mm"``.
    limits
        Diameters at the left and the right edge, in that unit.
    curves
        Names in `CURVES` of the pairs to draw: C1 and C2, D0 and D90.
    reference
        One of `SIDES`, for the names of D0 and D90.
    name
        Name of the wall before the title, if there are several walls.
    between
        (turns,), 1 where most of a turn is interpolated, which is hatched, else 0; None: nothing is hatched.
    """

    width, least = 40.0, 32.0

    def __init__(
        self,
        turns: Diameters,
        basis: Basis,
        bit_diameter: float,
        unit: str,
        limits: tuple[float, float],
        curves: Sequence[str] = (),
        reference: str = "high-side",
        name: str = "",
        between: Floats | None = None,
    ) -> None:
        self.name = name
        self.turns, self.basis, self.unit, self.limits = turns, basis, unit, limits
        self.between = between
        self.bit = bit_diameter / LENGTHS[unit]
        self.curves = curves if basis == "azimuthal" else ()
        sides = SIDES[reference]
        self.ticks: list[tuple[VolumeTicks, bool]] = []  # and whether they stand at the right edge
        self.names = {"D0": f"{sides[0]}–{sides[2]}", "D90": f"{sides[1]}–{sides[3]}"}

    def head(self, sheet: Sheet, x: float, y: float) -> None:
        """Write the title and the scale, and draw a key of lines and colours."""
        title = f"{self.name}Caliper [{self.unit}]"
        head_title(sheet, x, y + 2.5, self.width, title)
        sheet.line((x, x + self.width), (y + HEAD - 0.2, y + HEAD - 0.2), color=INK)
        row = y + 6.3
        bit = f"bit {'size ' if self.width > 39 else ''}{length_text(self.bit, self.unit)}"
        line, right = 0.15 * self.width, x + 0.525 * self.width
        room = self.width - line - 3.0 - (13.0 if self.basis == "azimuthal" else 0.0)
        self._key(sheet, x + 1, row, bit, room, line, color=INK, dashes=(4, 2))
        if self.basis == "azimuthal":
            self._key(sheet, x + self.width - 12.0, row, "least", 5.8, 4.0, **LEAST_LINE)
        row += 3.5
        self._key(sheet, x + 1, row, "by area", 12.0, color=AREA)
        self._fill_key(sheet, right, row, "under", "under bit")
        if self.curves:
            row += 3.5
        for number, name in enumerate(self.curves):
            at = x + 1 + number * 0.24 * self.width
            sheet.line((at, at + 3.0), (row, row), linewidth=0.9, **CURVES[name])
            sheet.text(at + 3.4, row, self.names.get(name, name), 5.2, within=0.24 * self.width - 3.6)
        row += 3.5
        self._fill_key(sheet, x + 1, row, "over", "bit to C2" if self.basis == "azimuthal" else "over bit")
        if self.basis == "azimuthal":
            self._fill_key(sheet, right, row, "partly over", "C2 to C1")
        low, high = (f"{limit:g}" for limit in self.limits)
        sheet.text(x + 0.6, y + HEAD - 2.2, low, SMALL)
        sheet.text(x + self.width - 0.6, y + HEAD - 2.2, high, SMALL, ha="right")

    def _key(self, sheet: Sheet, x: float, row: float, text: str, room: float, long: float = 6.0, **look: Any) -> None:
        sheet.line((x, x + long), (row, row), **{"linewidth": 0.9, **look})
        sheet.text(x + long + 1.2, row, text, SMALL, within=room)

    def _fill_key(self, sheet: Sheet, x: float, row: float, fill: str, text: str) -> None:
        sheet.box(x, row - 1.1, 3, 2.2, facecolor=FILL_COLORS[fill], edgecolor=RULE, linewidth=0.3)
        sheet.text(x + 4, row, text, 5.2, within=0.475 * self.width - 5.0)

    def draw(self, sheet: Sheet, x: float, stretch: Stretch) -> Axes:
        """Draw the curves; hatched where a turn has no radius at all, or is mostly interpolated."""
        axes = bare_axes(sheet, x, self.width, stretch)
        step = (self.limits[1] - self.limits[0]) / 5
        for at in range(1, 5):
            axes.axvline(self.limits[0] + at * step, color=RULE, linewidth=0.3, alpha=0.6)
        turns = thinned(self.turns, stretch.top, stretch.bottom, 2 * sheet.pixels(stretch.height))
        scale = LENGTHS[self.unit]
        area, least, greatest = turns.area / scale, turns.least / scale, turns.greatest / scale
        inner, outer = np.fmax(turns.c2 / scale, self.bit), np.maximum(greatest, self.bit)
        for left, right, fill in (
            (np.minimum(least, self.bit), self.bit, "under"),
            (self.bit, inner, "over"),
            (inner, outer, "partly over"),
        ):
            axes.fill_betweenx(turns.depth, left, right, facecolor=FILL_COLORS[fill], linewidth=0)
        if self.basis == "azimuthal":
            axes.plot(least, turns.depth, **LEAST_LINE)
        for name in self.curves:
            axes.plot(getattr(turns, name.lower()) / scale, turns.depth, linewidth=0.8, **CURVES[name])
        axes.plot(area, turns.depth, color=AREA, linewidth=0.8)
        axes.axvline(self.bit, color=INK, linewidth=0.9, dashes=(4, 2))
        self._draw_missing(axes, sheet, stretch)
        axes.set_xlim(*self.limits)
        depth_lines(axes, stretch)
        drawn = [least, greatest, area, *(getattr(turns, name.lower()) / scale for name in self.curves)]
        self._write_beyond(axes, turns.depth, -np.fmin.reduce(drawn), -1, stretch)
        self._write_beyond(axes, turns.depth, np.fmax.reduce(drawn), 1, stretch)
        for ticks, right in self.ticks:
            _draw_ticks(axes, ticks, stretch, right)
        return axes

    def _write_beyond(self, axes: Axes, depth: Floats, values: Floats, side: int, stretch: Stretch) -> None:
        """Write values beyond an edge of the scale at that edge, with an arrow; of those close together, the farthest.

        At the left edge, ``side`` is -1 and ``values`` are the diameters times -1.
        """
        limit = self.limits[side > 0]
        line = LINE * (stretch.bottom - stretch.top) / stretch.height
        rows = np.flatnonzero((values > side * limit) & (depth >= stretch.top) & (depth <= stretch.bottom))
        look: dict[str, Any] = {"va": "center", "size": LEAST, "family": FONT, **ON_PAPER}
        for group in np.split(rows, np.flatnonzero(np.diff(depth[rows]) > 2 * line) + 1) if rows.size else ():
            at = group[np.argmax(values[group])]
            number = f"{side * values[at]:.{0 if self.unit == 'mm' else 1}f}"
            text, ha = (f"{number} →", "right") if side > 0 else (f"← {number}", "left")
            place = min(max(float(depth[at]), stretch.top + 0.5 * line), stretch.bottom - 0.5 * line)
            axes.text(limit, place, text, ha=ha, **look)

    def _draw_missing(self, axes: Axes, sheet: Sheet, stretch: Stretch) -> None:
        """Hatch turns that are mostly interpolated, and those without a radius; so, too, beyond the wall's ends."""
        edges = np.linspace(stretch.top, stretch.bottom, sheet.pixels(stretch.height) + 1)
        middle, depth = 0.5 * (edges[:-1] + edges[1:]), self.turns.depth
        half = 0.5 * float(np.median(np.diff(depth))) if depth.size > 1 else np.inf
        near = np.clip(np.searchsorted(depth + half, middle), 0, depth.size - 1)
        away = np.abs(depth[near] - middle) > half * (1 + 1e-6)
        gone = away | (self.turns.coverage[near] == 0)
        between = ~gone & (self.between[near] > 0.5) if self.between is not None else np.full(gone.shape, False)
        if (gone | between).any():
            wide = (gone.size, sheet.pixels(self.width))
            masks = (np.broadcast_to(one[:, None], wide) for one in (between, gone))
            colors = hatch(sheet, np.full((*wide, 3), 255, np.uint8), *masks)
            inked = gone[:, None] | (colors == HATCH_BYTES).all(axis=2)  # the curves are seen between sparse lines
            pixels = np.dstack([colors, np.where(inked, 255, 0).astype(np.uint8)])
            box = (*self.limits, stretch.bottom, stretch.top)
            axes.imshow(pixels, extent=box, aspect="auto", interpolation="none", zorder=3)


def _draw_ticks(axes: Axes, ticks: VolumeTicks, stretch: Stretch, right: bool) -> None:
    """Draw ticks of volume at an edge of a track; every tenth is long and has its volume."""
    edge, inward = (1.0, -1.0) if right else (0.0, 1.0)
    across = axes.get_yaxis_transform()
    look: dict[str, Any] = {"ha": "right" if right else "left", "va": "bottom", "size": LEAST, "family": FONT}
    for number, depth in enumerate(ticks.depth.tolist(), 1):
        if stretch.top < depth <= stretch.bottom:
            long = number % 10 == 0
            ends = edge, edge + inward * (0.1 if long else 0.04)
            axes.hlines(depth, *ends, color=INK, linewidth=0.8 if long else 0.6, transform=across, zorder=7)
            if long:
                axes.text(ends[0] + 0.01 * inward, depth, f"{number * ticks.every:g}", transform=across, **look)


def _with_unit(name: str, unit: str) -> str:
    """Return a name with its unit, which a column's name may hold already: GR_gAPI."""
    return f"{name.removesuffix(f'_{unit}')} [{unit or 'no unit'}]"


class ScalarTrack:
    """One curve along the hole, on a scale of its own.

    Raises
    ------
    InputError
        ``curve 'GR', 10 to 20 m: has no value there``; on limits that a logarithm cannot show.
    """

    width, least = 30.0, 5.0

    def __init__(self, curve: ScalarCurve, top: float, bottom: float) -> None:
        self.curve = curve
        place = f"curve {curve.name!r}, {top:g} to {bottom:g} m"
        inside = curve.there(top, bottom)
        if not inside.any():
            raise InputError(place, "has no value there")
        self.limits = curve.ends()
        beyond = int(((curve.values[inside] < min(self.limits)) | (curve.values[inside] > max(self.limits))).sum())
        words = ("logarithmic" if curve.log else "", f"{beyond:,} beyond the ends" if beyond else "")
        self.note = ", ".join(word for word in words if word)

    def head(self, sheet: Sheet, x: float, y: float) -> None:
        """Write name and unit, the line, and the values at the edges."""
        curve, middle = self.curve, x + 0.5 * self.width
        title = _with_unit(curve.name, curve.unit)
        head_title(sheet, x, y + 5.5, self.width, title, 5)
        sheet.line((x + 1, x + self.width - 1), (y + 12.0, y + 12.0), color=SCALAR, linewidth=0.9)
        if self.note:
            sheet.lines_of_text(middle, y + 16.0, self.note, 5.6, self.width - 1, 3, ha="center", color=FAINT)
        # The left number stands above the right one if there is no room for them side by side.
        low, high = (f"{limit:g}" for limit in self.limits)
        room, at = self.width - 1.2, y + HEAD - 2.2
        left = sheet.text(x + 0.6, at, low, SMALL, within=room)
        right = sheet.text(x + self.width - 0.6, at, high, SMALL, within=room, ha="right")
        if sheet.text_width(left) + sheet.text_width(right) > self.width - 2.0:
            left.set_y(1.0 - (y + HEAD - 4.4) / sheet.height)
        sheet.line((x, x + self.width), (y + HEAD - 0.2, y + HEAD - 0.2), color=INK)

    def draw(self, sheet: Sheet, x: float, stretch: Stretch) -> Axes:
        """Draw the curve, with a gap where values are missing or rows are more than ten usual steps apart."""
        axes = bare_axes(sheet, x, self.width, stretch)
        curve = self.curve
        first, last = np.searchsorted(curve.depth, [stretch.top, stretch.bottom])
        part = slice(max(first - 1, 0), last + 1)
        depth, values = curve.depth[part], curve.values[part]
        values = np.where((values > 0) | (not curve.log), values, np.nan)
        usual = float(np.median(np.diff(curve.depth))) if curve.depth.size > 1 else np.inf
        gaps = np.flatnonzero(np.diff(depth) > 10.0 * usual) + 1
        if curve.log:
            axes.set_xscale("log")
            axes.set_xticks([])
            axes.minorticks_off()
        axes.plot(np.insert(values, gaps, np.nan), np.insert(depth, gaps, np.nan), color=SCALAR, linewidth=0.8)
        axes.set_xlim(*self.limits)
        depth_lines(axes, stretch)
        return axes


class ImageTrack:
    """The unrolled values of a wall, or of a sector image.

    Parameters
    ----------
    shown
        Name, unit, colours.
    source
        A sector image with the values to show (its own, or normalised); or the settings and the start depth of a wall,
        with one value for each vertex.
    reference
        One of `SIDES`.
    left
        Toolface of the left edge, degrees; a multiple of 90.
    width
        Millimetres.
    interpolated
        Of a wall: (n,), 1 at interpolated vertices, which are hatched, else 0; None: no vertex is hatched.
    ink
        Function that draws over the pixels; its argument is the axes, whose x is degrees from the left edge, 0 to 360.
    """

    least = 16.0

    def __init__(
        self,
        shown: Shown,
        source: tuple[SectorImage, Floats] | tuple[tuple[Settings, float], Floats],
        reference: str,
        left: float,
        width: float,
        interpolated: Floats | None = None,
        ink: Callable[[Axes], None] = lambda _: None,
    ) -> None:
        self.shown, self.source, self.reference, self.left, self.width = shown, source, reference, left, width
        self.interpolated, self.ink = interpolated, ink

    def head(self, sheet: Sheet, x: float, y: float) -> None:
        """Write name and unit, draw the colour bar with its numbers, and the letters of the sides."""
        shown, scale = self.shown, self.shown.scale
        middle, room = x + 0.5 * self.width, self.width - 1
        head_title(sheet, x, y + 2.5, self.width, _with_unit(shown.name, shown.unit))
        sheet.text(middle, y + 6.4, shown.remark, 5.6, within=room, ha="center", color=FAINT)
        color_bar(sheet, scale, x + 1.0, y + 9.0, self.width - 2.0, shares=shown.shares)
        sheet.lines_of_text(middle, y + 17.4, shown.note, 5.6, room, 2, ha="center", color=FAINT)
        first = round(self.left / 90.0)
        every = 2 if self.width < 24.0 and SIDES[self.reference][0] == "0°" else 1
        for place in range(0, 5, every):
            at, side = x + place * self.width / 4, SIDES[self.reference][(first + place) % 4]
            inward = {0: 0.9, 4: -0.9}.get(place, 0.0)
            ha = {0: "left", 4: "right"}.get(place, "center")
            sheet.text(at + inward * 0.6, y + HEAD - 2.2, side, SMALL, ha=ha)
        sheet.line((x, x + self.width), (y + HEAD - 0.2, y + HEAD - 0.2), color=INK)

    def draw(self, sheet: Sheet, x: float, stretch: Stretch) -> Axes:
        """Draw the pixels, and a line at each quarter turn."""
        axes = bare_axes(sheet, x, self.width, stretch)
        grid = Grid(stretch.top, stretch.bottom, sheet.pixels(stretch.height), sheet.pixels(self.width), self.left)
        source, values = self.source
        if isinstance(source, SectorImage):
            pixels = unroll_image(source, values, grid)
        else:
            pixels = unroll_wall(values, source[0], source[1], grid)
        colors = self.shown.scale.colors(pixels)[..., :3]
        gone = np.isnan(pixels)
        between = np.full(gone.shape, False)
        if self.interpolated is not None and not isinstance(source, SectorImage):
            between = ~gone & (unroll_wall(self.interpolated, source[0], source[1], grid) > 0.5)
        colors = hatch(sheet, colors, between, gone)
        box = (0.0, 360.0, stretch.bottom, stretch.top)
        axes.imshow(colors, extent=box, aspect="auto", interpolation="none", origin="upper")
        for quarter in (90, 180, 270):
            axes.axvline(quarter, color="white", linewidth=0.35, alpha=0.5)
        axes.set_xlim(0, 360)
        self.ink(axes)
        depth_lines(axes, stretch)
        return axes


class PlacedTrack(Protocol):
    """A track that `log` places: a head over a stretch of hole, both ``width`` mm wide, at least ``least`` mm."""

    width: float
    least: float

    def head(self, sheet: Sheet, x: float, y: float) -> None: ...
    def draw(self, sheet: Sheet, x: float, stretch: Stretch) -> Axes: ...


def head_title(sheet: Sheet, x: float, y: float, width: float, title: str, most: int = 2) -> None:
    """Write the title of a track ``width`` millimetres wide, in as few lines as it needs, at most ``most``."""
    sheet.lines_of_text(x + 0.5 * width, y, title, USUAL, width - 1.0, most, ha="center", weight="bold")


LENGTHS = {"in": INCH, "mm": MILLIMETRE}
"""Units of diameters, in metres."""


def color_bar(sheet: Sheet, scale: ColorScale, x: float, y: float, width: float, shares: bool = False) -> None:
    """Draw the colours of a scale with the numbers at its ends and in its middle; with ``shares``, with the words low
    and high at its ends instead.
    """
    axes = sheet.axes(x, y, width, 2.6)
    ramp = np.linspace(scale.low, scale.high, 256)
    middle = 0.5 * (scale.low + scale.high)
    if scale.log:
        ramp = np.geomspace(scale.low, scale.high, 256)
        middle = float(np.sqrt(scale.low * scale.high))
    axes.imshow(scale.colors(ramp[None, :])[..., :3], extent=(0, 1, 0, 1), aspect="auto")
    axes.set_axis_off()
    sheet.box(x, y, width, 2.6, edgecolor=RULE, linewidth=0.4)
    words = (
        ("low", "", "high")
        if shares
        else tuple(f"{float(f'{one:.3g}'):.10g}" for one in (scale.low, middle, scale.high))
    )  # 17200, as on the page, not 1.72e+04
    for at, ha, text in zip((0.0, 0.5, 1.0), ("left", "center", "right"), words, strict=True):
        sheet.text(x + at * width, y + 4.9, text, SMALL, ha=ha, within=width / 3)


def bare_axes(sheet: Sheet, x: float, width: float, stretch: Stretch) -> Axes:
    """Return the axes of a track, in a frame and without ticks; depth grows downwards."""
    axes = sheet.axes(x, stretch.y, width, stretch.height)
    axes.set_xticks([])
    axes.set_yticks([])
    axes.set_ylim(stretch.bottom, stretch.top)
    axes.set_autoscaley_on(False)
    for spine in axes.spines.values():
        spine.set_color(RULE)
        spine.set_linewidth(0.6)
        spine.set_zorder(5)
    return axes


def depth_lines(axes: Axes, stretch: Stretch) -> None:
    left, right = axes.get_xlim()
    minor, major = (lines(stretch.top, stretch.bottom) for lines in (stretch.lines.minor, stretch.lines.major))
    axes.hlines(minor, left, right, color=INK, linewidth=0.2, alpha=0.22, zorder=4)
    axes.hlines(major, left, right, color=INK, linewidth=0.4, alpha=0.55, zorder=4)

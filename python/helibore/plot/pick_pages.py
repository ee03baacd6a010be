"""The picks of a print on pages of their own: a stereonet, a rose of strikes, and a table.

stereonet    the pole of each plane on the lower hemisphere, equal area, north up; its symbol is that of its class
rose         the strikes of the planes, both ends, in sectors of 10 degrees whose area is the number of planes
table        a row for each pick, by depth; the report has the same rows

Without a survey dips are apparent, angles count from toolface 0, and the rose has the toolfaces at which planes are
deepest: a plane then has no strike.
"""

from __future__ import annotations

import math
from collections import Counter
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from helibore.base.angles import azimuth_text
from helibore.base.colors import DIP_TITLES, PICK_COLORS
from helibore.base.units import INCH, MILLIMETRE
from helibore.logs.picks import NOTE, PLANES, Pick
from helibore.plot.cells import in_depth_unit, number
from helibore.plot.paper import FAINT, INK, RULE, SMALL, USUAL, Sheet
from helibore.plot.picked import attitude, interval_marks, tadpole
from helibore.plot.print_header import north_of_picks, sentence, toolface_text
from helibore.plot.tracks import SIDES

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from helibore.plot.content import Content

SECTOR = 10
"""Degrees of a sector of the rose."""
NETS, ROW, HEAD = 92.0, 3.6, 12.0
"""Heights of stereonet and rose, of a row and of the head of the table, millimetres."""
ROOM = 1.25
"""Half the width of the axes of the stereonet and the rose, in radii."""
WIDTHS = (30.0, 17.0, 16.0, 17.0, 20.0, 18.0, 22.0, 22.0, 28.0)
"""Millimetres of the columns of the table, for a table 190 mm wide."""


def in_interval(content: Content) -> list[Pick]:
    """Return the picks in the interval of a drawing, by depth."""
    return sorted(
        (pick for pick in content.picks if content.top <= pick.depth <= content.bottom),
        key=lambda pick: pick.depth,
    )


def table_head(content: Content) -> tuple[str, ...]:
    """Return the heads of the columns of the table of picks."""
    depths, size = content.drawing.depth_unit.name, content.drawing.size_unit
    own = (DIP_TITLES["apparent"], "Toolface [°]", "Aperture, opening", f"Misfit [{size}]")
    return "Class", f"MD [{depths}]", DIP_TITLES["true"], "Azimuth [°]", *own, "Note"


def table_row(pick: Pick, content: Content) -> list[str]:
    """Return the cells of the row of a pick."""
    dip, azimuth = pick.dip(content.wall.path)
    own = ["–", number(pick.toolface, 0), f"{number(pick.opening, 0)}°", "–"]
    if pick.kind == NOTE:
        own = ["–"] * 4
    elif pick.kind in PLANES:
        unit = content.drawing.size_unit
        size, digits = (INCH, 2) if unit == "in" else (MILLIMETRE, 1)
        misfit = number(pick.misfit / size, digits)
        aperture = "–" if pick.aperture is None else f"{number(pick.aperture / size, digits - 1)} {unit}"
        fitted = (
            f"{misfit}, {pick.points} points" if pick.points > 3 else f"{pick.points} points" if pick.points else ""
        )
        own = [number(pick.apparent_dip, 1), number(pick.toolface, 0), aperture, fitted or "by hand"]
    axis = pick.axis(content.wall.path)
    towards = axis if math.isnan(azimuth) else azimuth
    angles = [number(dip, 1) or "–", "–" if math.isnan(towards) else azimuth_text(towards)]
    cells = own if math.isnan(dip) else angles  # without a true dip the interval is that of the apparent one
    for at, mark in enumerate(interval_marks(pick, content.wall.path)):
        cells[at] += mark
    return [pick.kind, in_depth_unit(pick.depth, content), *angles, *own, pick.note or "–"]


def table_note(content: Content) -> str:
    """Return what the angles of the table count from, and what a misfit is."""
    fit = "misfit: root mean square along the hole"
    sure = " ±: 95 % interval." if any(pick.dip_sigma is not None for pick in in_interval(content)) else ""
    return (
        f"{sentence(north_of_picks(content))} {sentence(f'toolfaces: {toolface_text(content)}')} {sentence(fit)}{sure}"
    )


def nets(content: Content) -> Figure | None:
    """Return the stereonet and the rose as a figure; None without a plane in the interval."""
    planes = [pick for pick in in_interval(content) if pick.kind in PLANES]
    if not planes:
        return None
    sheet = Sheet(sum(WIDTHS), NETS - 8.0, content.drawing.dpi)
    _draw_nets(content, planes, sheet, 0.0, 0.0)
    return sheet.figure


def pick_parts(content: Content, room: float) -> list[tuple[float, Callable[[Sheet, float], None]]]:
    """Return the height of each page of picks, at most ``room`` millimetres, and what draws it from a height down."""
    picks = in_interval(content)
    if not picks:
        return []
    nets = NETS if any(pick.kind in PLANES for pick in picks) else 0.0
    parts: list[tuple[float, Callable[[Sheet, float], None]]] = []
    first = 0
    while first < len(picks):
        above = nets if not parts else 0.0
        many = len(picks) if math.isinf(room) else max(int((room - above - HEAD) / ROW), 1)
        rows = picks[first : first + many]
        parts.append((above + HEAD + ROW * len(rows), partial(_draw, content, rows, picks if above else [])))
        first += many
    return parts


def _draw(content: Content, rows: list[Pick], shown: list[Pick], sheet: Sheet, y: float) -> None:
    """Draw a page: stereonet and rose of the picks ``shown``, if there are any, then the table of ``rows``."""
    left = (sheet.width - sum(WIDTHS)) / 2
    if shown:
        _draw_nets(content, [pick for pick in shown if pick.kind in PLANES], sheet, left, y)
        y += NETS
    sheet.text(left, y + 2.0, "Picks", USUAL, weight="bold")
    sheet.lines_of_text(left + 12.0, y + 2.5, table_note(content), SMALL, sum(WIDTHS) - 12.0, 2, color=FAINT)
    y += HEAD - ROW
    _draw_row(sheet, left, y, table_head(content), weight="bold")
    sheet.line((left, left + sum(WIDTHS)), (y + ROW / 2, y + ROW / 2), color=INK)
    for pick in rows:
        y += ROW
        _draw_row(sheet, left, y, table_row(pick, content))
        if pick.kind in PLANES:
            sheet.line((left + 1.5, left + 1.5), (y, y), markeredgewidth=0.7, **tadpole(pick.kind, 3.2))
        elif pick.kind != NOTE:
            sheet.box(left + 0.4, y - 1.0, 2.2, 2.0, edgecolor=PICK_COLORS[pick.kind])
        sheet.line((left, left + sum(WIDTHS)), (y + ROW / 2, y + ROW / 2), linewidth=0.2)


def _draw_row(sheet: Sheet, x: float, y: float, cells: tuple[str, ...] | list[str], **look: Any) -> None:
    """Write the cells of a row; all but the first and the last are set flush right."""
    for at, (text, width) in enumerate(zip(cells, WIDTHS, strict=True)):
        if at in (0, len(WIDTHS) - 1):
            sheet.text(x + (1.5 if at else 4.0), y, text, SMALL, within=width - (1.5 if at else 4.5), **look)
        else:
            sheet.text(x + width, y, text, SMALL, within=width - 1.0, ha="right", **look)
        x += width


def _draw_nets(content: Content, planes: list[Pick], sheet: Sheet, x: float, y: float) -> None:
    """Draw the stereonet, the rose and, between them, the classes."""
    path, wide = content.wall.path, sum(WIDTHS)
    angles = np.array([attitude(pick, path) for pick in planes])
    size = NETS - 20.0
    sides = SIDES["north"] if path is not None else SIDES[content.reference]
    places = x, x + wide - size
    titles = ("lower hemisphere, equal area", "Strikes", f"both ends, {SECTOR}° a sector; area: planes")
    if path is None:
        titles = ("apparent dips, equal area, seen downhole", "Deepest toolfaces", f"{SECTOR}° a sector; area: planes")
    for place, title, remark in zip(places, ("Poles of planes", titles[1]), titles[::2], strict=True):
        sheet.text(place + size / 2, y + 3.0, title, USUAL, ha="center", weight="bold")
        sheet.text(place + size / 2, y + 7.0, remark, SMALL, ha="center", color=FAINT)
    net, rose = (_round_axes(sheet, place, y + 11.0, size, sides) for place in places)
    for dip in (30, 60):
        _circle(net, math.sqrt(2) * math.sin(math.radians(dip / 2)), 0.3)
        net.text(0.02, math.sqrt(2) * math.sin(math.radians(dip / 2)) + 0.01, f"{dip}°", size=SMALL, color=FAINT)
    for pick, (dip, azimuth) in zip(planes, angles, strict=True):
        far = math.sqrt(2) * math.sin(math.radians(dip / 2))
        towards = math.radians(azimuth) if math.isfinite(azimuth) else 0.0
        net.plot([-far * math.sin(towards)], [-far * math.cos(towards)], linestyle="none", **tadpole(pick.kind, 4.0))
    _draw_rose(rose, planes, angles[:, 1], strikes=path is not None)
    counts = Counter(pick.kind for pick in planes)
    for row, kind in enumerate(kind for kind in PLANES if counts[kind]):
        at, middle = y + 30.0 + 4.2 * row, x + wide / 2
        sheet.line((middle - 13.0,) * 2, (at, at), markeredgewidth=0.7, **tadpole(kind, 4.0))
        sheet.text(middle - 10.5, at, f"{kind}: {counts[kind]}", SMALL)


def _draw_rose(axes: Axes, planes: list[Pick], azimuths: np.ndarray[Any, Any], *, strikes: bool) -> None:
    """Draw the sectors of the rose, the classes one outside the other, and the number of planes at the outer circle."""
    kinds = [kind for kind in PLANES if any(pick.kind == kind for pick in planes)]
    counts = np.zeros((len(kinds), 360 // SECTOR))
    for pick, azimuth in zip(planes, azimuths, strict=True):
        for turn in (-90, 90) if strikes else (0,):
            if math.isfinite(azimuth):
                counts[kinds.index(pick.kind), int((azimuth + turn) % 360 // SECTOR)] += 1
    sums = counts.cumsum(axis=0)
    most = max(float(sums.max()), 1.0)
    for sector in range(counts.shape[1]):
        arc = np.radians(np.linspace(sector * SECTOR, (sector + 1) * SECTOR, 6))
        for row, kind in enumerate(kinds):
            if not counts[row, sector]:
                continue
            outer, inner = (math.sqrt(of[row, sector] / most) for of in (sums, sums - counts))
            x, y = (np.concatenate([outer * each(arc), inner * each(arc[::-1])]) for each in (np.sin, np.cos))
            axes.fill(x, y, facecolor=PICK_COLORS[kind], edgecolor="white", linewidth=0.3)
    axes.text(0.72, -0.8, f"circle: {most:.0f}", size=SMALL, color=FAINT)


def _round_axes(sheet: Sheet, x: float, y: float, size: float, sides: tuple[str, ...]) -> Axes:
    """Return axes with a circle of radius 1 and the names of its four sides."""
    axes = sheet.axes(x, y, size, size)
    axes.set(xlim=(-ROOM, ROOM), ylim=(-ROOM, ROOM))
    axes.set_axis_off()
    _circle(axes, 1.0, 0.8)
    for quarter, side in enumerate(sides):
        at = math.radians(90 * quarter)
        axes.text(1.13 * math.sin(at), 1.13 * math.cos(at), side, ha="center", va="center", size=USUAL, color=INK)
        ends = ([edge * each(at) for edge in (0.97, 1.03)] for each in (math.sin, math.cos))
        axes.plot(*ends, color=INK, linewidth=0.8)
    for line in ((-1, 1), (0, 0)), ((0, 0), (-1, 1)):
        axes.plot(*line, color=RULE, linewidth=0.2)
    return axes


def _circle(axes: Axes, radius: float, width: float) -> None:
    around = np.radians(np.arange(361))
    axes.plot(radius * np.sin(around), radius * np.cos(around), color=INK if radius == 1 else RULE, linewidth=width)

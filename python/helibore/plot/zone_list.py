"""The zones below the tracks, worst first: kind, depths, size and severity, as the viewer's page lists them.

W washout     2046.0 to 2048.6    +59 mm    4.2 x   97 %    letter and colour are those of the strip beside the depths

The sign of a zone whose kind is not sure is hollow, here and in the strip.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from helibore.logs.zone_criteria import MEASURES
from helibore.plot.paper import FAINT, SMALL, USUAL, Sheet
from helibore.plot.tracks import LENGTHS, LETTERS, zone_look

if TYPE_CHECKING:
    from helibore.logs.zones import Zone
    from helibore.plot.content import Content

COLUMNS, ROW, MOST_ROWS = 3, 4.0, 15
TITLE = 8.0
"""Height of the title, millimetres."""


def zone_sign(sheet: Sheet, x: float, y: float, kind: str, sure: bool = True) -> None:
    """Draw the sign of a kind of zone, its letter on its colour, 3 mm wide and with its middle at height ``y``."""
    face, edge, ink = zone_look(kind, sure)
    sheet.box(x + 0.1, y - 1.3, 2.8, 2.6, facecolor=face, edgecolor=edge, linewidth=0.6)
    sheet.text(x + 1.5, y, LETTERS[kind], SMALL, ha="center", color=ink, weight="bold")


def _zones(content: Content) -> list[Zone]:
    return content.zones.by_severity(content.top, content.bottom) if content.wall.basis == "azimuthal" else []


def zone_list_height(content: Content) -> float:
    """Return the height of the list, millimetres; 0 if it has no zone."""
    count = len(_zones(content))
    return TITLE + ROW * min(-(-count // COLUMNS), MOST_ROWS) if count else 0.0


def criteria_text(content: Content) -> str:
    """Return the criteria of the kinds of zones as text, in the units of the picture."""
    unit, criteria = content.drawing.size_unit, content.zones.criteria
    rules = [
        f"{kind} {MEASURES[kind]} {'below' if kind == 'undergauge' else 'at least'} {limit / LENGTHS[unit]:.3g} {unit}"
        for kind, limit in criteria.limits().items()
    ]
    depths = content.drawing.depth_unit
    shortest = f"over at least {criteria.least_length / depths.metres:.3g} {depths.name} of hole"
    return f"{', '.join(rules)}; {shortest}".replace(" - ", " − ").replace(" -", " −")


def draw_zones(sheet: Sheet, content: Content, x: float, y: float, width: float) -> None:
    """Draw the list; zones that it has no room for are counted in its title."""
    zones, drawing = _zones(content), content.drawing
    unit, depths = drawing.size_unit, drawing.depth_unit
    shown = zones[: COLUMNS * MOST_ROWS]
    more = f"; {len(zones) - len(shown)} more are not listed" if len(zones) > len(shown) else ""
    title = sheet.text(x, y + 2.0, f"Zones, worst first{more}", USUAL, weight="bold")
    key = f"MD [{depths.name}]; extreme of the limited length [{unit}]; times the limit; probability of the kind"
    left = sheet.text_width(title) + 2.0
    sheet.text(x + left, y + 2.1, key, SMALL, within=width - left, color=FAINT)
    for index, zone in enumerate(shown):
        row, column = divmod(index, COLUMNS)
        left, at = x + column * (width + 4.0) / COLUMNS, y + TITLE - 1.0 + row * ROW
        size = f"{zone.measure / LENGTHS[unit]:+.{2 if unit == 'in' else 1}f}"
        zone_sign(sheet, left, at, zone.kind, zone.sure)
        sheet.text(left + 4.0, at, zone.kind, SMALL, within=14.0)
        sheet.text(left + 40.0, at, f"{depths.text(zone.start, 1)} – {depths.text(zone.stop, 1)}", SMALL, ha="right")
        sheet.text(left + 48.5, at, size, SMALL, ha="right", weight="bold")
        sheet.text(left + 55.5, at, f"{zone.severity:.1f} ×", SMALL, ha="right")
        sheet.text(left + 61.5, at, zone.confidence_text, SMALL, ha="right")

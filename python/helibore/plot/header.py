"""The header of a log, which says what hole it is and what was measured, and the foot, which explains signs.

A wall that is not an image of the shape says so in the header, in red.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from helibore._core import __version__
from helibore.base.units import INCH
from helibore.plot.paper import FAINT, LARGE, RULE, SMALL, USUAL, Sheet
from helibore.plot.scales import length_text
from helibore.plot.tracks import GREY, HATCH_COLOR
from helibore.samples.caliper import BASIS_TEXT

if TYPE_CHECKING:
    from helibore.plot.content import Content

REFERENCE_TEXT = {
    "high-side": "from the high side, clockwise looking downhole",
    "north": "from north, clockwise looking downhole",
    "parallel-transport": "from north at the top of the path, without twist, clockwise",
    "": "as the samples count it: no path says from what",
}
SIDES_TEXT = {
    "high-side": "U up (high side), R right, D down, L left of the hole, looking downhole",
    "north": "N, E, S, W: sides of the hole, clockwise looking downhole",
    "parallel-transport": "0° to 270°: toolfaces from north at the top of the path, without twist",
    "": "0° to 270°: toolfaces as the samples count them, clockwise looking downhole",
}
WARNING = "#b3261e"


def facts(content: Content) -> list[tuple[str, str, bool]]:
    """Return label, text and whether it is a warning, for everything a reader must know."""
    wall, settings = content.wall, content.wall.settings
    bit = settings.bit_diameter
    made = BASIS_TEXT[wall.basis]
    ends = f"{content.top:,.2f} to {content.bottom:,.2f} m MD"
    elevation = content.drawing.elevation
    hole = [(name.capitalize(), text, False) for name, text in content.drawing.header.items() if text]
    below = "" if elevation is None else f"; TVDSS is TVD less {elevation:.12g} m"
    return [
        *hole,
        ("Interval", f"{ends} ({content.bottom - content.top:,.1f} m)", False),
        ("Bit size", f"{length_text(bit / INCH, 'in')} ({bit * 1e3:.1f} mm)", False),
        ("Depth scale", f"1:{content.scale}, {1000 / content.scale:g} mm on paper a metre{below}", False),
        ("Toolface", REFERENCE_TEXT[content.reference], False),
        ("Wall made from", made, wall.basis != "azimuthal"),
        ("Samples", f"{wall.sample_count:,}", False),
        ("Helix", f"{settings.sectors} sectors, pitch {settings.pitch:g} m, {len(wall):,} vertices", False),
        ("Measured", measured_text(content), True)
        if content.hatching
        else ("No sample in reach", f"{100 * content.summary().without_radius:.2f} % of the interval", False),
    ]


def header_height(content: Content) -> float:
    """Return the millimetres that the header takes."""
    return 16.8 + 4.3 * ((len(facts(content)) + 1) // 2)


def measured_text(content: Content) -> str:
    """Return how much of the turns was measured, and what the rest is."""
    rest = content.hatching or "interpolated or missing"
    return f"{100 * content.summary().coverage:.2f} % of the turns; the rest is {rest}"


def draw_header(sheet: Sheet, content: Content, x: float, y: float, width: float) -> None:
    """Draw title, subtitle and facts in a frame."""
    title = content.drawing.title or "Borehole wall"
    sheet.text(x, y + 3.5, title, LARGE, weight="bold", within=width)
    sheet.text(x, y + 9.0, content.drawing.subtitle, USUAL, color=FAINT, within=width)
    sheet.line((x, x + width), (y + 11.8, y + 11.8), color=RULE)
    rows = facts(content)
    half = (len(rows) + 1) // 2
    first, label = 0.48 * width, 24.0
    for index, (name, text, warning) in enumerate(rows):
        column, row = divmod(index, half)
        left, at = x + column * first, y + 15.0 + row * 4.3
        sheet.text(left, at, name, SMALL, color=FAINT)
        look = {"color": WARNING, "weight": "bold"} if warning else {}
        sheet.text(left + label, at, text, USUAL, within=(width - first if column else first) - label - 1.0, **look)


def draw_footer(sheet: Sheet, content: Content, x: float, y: float, page: str = "") -> None:
    """Explain the letters and the grey; say what drew it."""
    sheet.line((x, sheet.width - x), (y - 3.0, y - 3.0))
    sheet.box(x, y - 1.2, 4.0, 2.4, facecolor=GREY, edgecolor=RULE, linewidth=0.4)
    words = "missing: no value, or no sample in reach."
    left = x + 5.2
    sheet.text(left, y, words, SMALL)
    if content.hatching:
        left += 46.0
        sheet.box(left, y - 1.2, 4.0, 2.4, facecolor="white", edgecolor=HATCH_COLOR, linewidth=0.4, hatch="//////")
        sheet.text(left + 5.2, y, content.hatching, SMALL)
    left += 41.0 if content.hatching else 46.0
    sheet.text(left, y, SIDES_TEXT[content.reference], SMALL, within=sheet.width - x - 24.0 - left)
    made = f"helibore {__version__}" + (f", {page}" if page else "")
    sheet.text(sheet.width - x, y, made, SMALL, ha="right", color=FAINT)

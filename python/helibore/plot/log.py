"""Lay out a log: header, heads, tracks at a true scale, cross sections and shaded bodies.

    figure = hb.plot.log(wall, title="F-12", scale=200)      one sheet, as long as the interval
    figures = hb.plot.pages(wall, title="F-12")              the same on A4
    figure = hb.plot.overview(wall, title="F-12")            for a screen, the body beside the tracks
    hb.plot.save(figures, "f12.pdf")

Every function returns matplotlib figures. ``content`` decides what is shown.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from helibore.base.errors import InputError, check_choice
from helibore.logs.picks import PLANES
from helibore.plot.content import Body, Content, Drawing, content_of
from helibore.plot.cross_sections import HEIGHT, WIDTH, draw_section, key_text, largest_shown
from helibore.plot.interval_tracks import tops_across
from helibore.plot.paper import FAINT, INK, SMALL, USUAL, Sheet
from helibore.plot.pick_pages import pick_parts
from helibore.plot.print_header import draw_footer, draw_header, footer_height, header_height
from helibore.plot.solid import draw_solid
from helibore.plot.tracks import HEAD, PlacedTrack, Stretch
from helibore.plot.zone_list import draw_zones, zone_list_height

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from helibore.wall.wall import Wall

_Draw = Callable[[Sheet, Content, float, float], None]
MARGIN, GAP = 10.0, 2.0
"""Millimetres around the sheet, and between tracks."""
PAPERS = {"a4": (210.0, 297.0), "a3": (297.0, 420.0)}
NARROWEST = 210.0
STUB = 40.0
"""Least length of the log on the last page, millimetres."""
LEAST_LENGTH = 1.0
"""Least length of the log on any page, millimetres."""
UNUSED = 0.3
"""Share of a page that stays empty at most so that no sinusoid is cut at its end."""
BODY, LEAST_BODY, MOST_BODY = 130.0, 90.0, 215.0
"""Height of a shaded body on a sheet; on pages its least and most height, as it takes what is left; millimetres."""
OVERVIEW_BODY, LEAST, TIES = 96.0, 130.0, 10.0
"""Millimetres of an overview: width of its body, least height, and width of the lines from the tracks to the body."""


def log(wall: Wall, **options: Any) -> Figure:
    """Draw a wall, its images, cross sections and a shaded body on one sheet that is as long as they need.

    Parameters
    ----------
    wall
        At least one full turn; its ``images`` are drawn.
    **options
        As in `Drawing`.

    Returns
    -------
    matplotlib.figure.Figure
        As large as the paper; its resolution is ``dpi``.

    Raises
    ------
    InputError
        On an image that lies outside the interval, has no value in it, is constant, or is not above 0 on a log scale;
        on options that break their rules.
    MissingExtraError
        Without matplotlib.
    """
    content = content_of(wall, Drawing(**options))
    length = content.paper_length()
    tail = _tail(content, _width(content))
    picks = pick_parts(content, math.inf)
    below = GAP + sum(usual for _, usual, _, _ in tail) + sum(tall + GAP for tall, _ in picks) + footer_height(content)
    height = MARGIN + header_height(content) + HEAD + length + below + MARGIN
    sheet = Sheet(_width(content), height, content.drawing.dpi)
    draw_header(sheet, content, MARGIN, MARGIN, sheet.width - 2 * MARGIN)
    y = draw_tracks(sheet, content, content.top, content.bottom, MARGIN + header_height(content))
    for _, usual, _, draw in tail:
        draw(sheet, content, y + GAP, usual)
        y += usual
    for _, draw_picks in picks:
        draw_picks(sheet, y + 2 * GAP)
    draw_footer(
        sheet, content, MARGIN, height - MARGIN, part=content.drawing.depth_unit.ends(content.top, content.bottom)
    )
    return sheet.figure


def pages(wall: Wall, paper: str | tuple[float, float] = "a4", **options: Any) -> list[Figure]:
    """Draw the same as `log` on pages of one size, each with the heads of the tracks, at the same depth scale.

    Parameters
    ----------
    wall, **options
        As in `log`.
    paper
        ``"a4"``, ``"a3"``, or width and height in millimetres. Tracks that do not fit become narrower; if they do not
        fit at their least widths, A4 and A3 lie on their side, and at last the paper becomes wider.

    Returns
    -------
    list of matplotlib.figure.Figure
        One for each page.

    Raises
    ------
    InputError
        As `log`; if the name of the paper is not known, or its height has no room for the tracks.
    """
    return pages_of(content_of(wall, Drawing(**options)), paper)


def pages_of(content: Content, paper: str | tuple[float, float], *, picks: bool = True) -> list[Figure]:
    """Draw ``content`` on pages of a size, as `pages` describes; with ``picks``, those have pages of their own."""
    if isinstance(paper, str):
        check_choice("paper", paper, PAPERS)
    width, height = PAPERS[paper] if isinstance(paper, str) else paper
    least = 2 * MARGIN + sum(track.least + GAP for track in content.tracks) - GAP
    if isinstance(paper, str) and least > width:
        width, height = height, width
    least = 2 * MARGIN + header_height(content) + HEAD + LEAST_LENGTH + footer_height(content)
    if not (math.isfinite(width) and least <= height < math.inf):
        rule = f"must be finite, and at least {math.ceil(least)} mm high for the header, the heads and the foot"
        raise InputError("paper", rule, f"{width:g} x {height:g} mm", "print.paper")
    _fit(content.tracks, width - 2 * MARGIN)
    width = max(width, _width(content))
    free = height - MARGIN - footer_height(content)
    parts = _divided(content, free - MARGIN - HEAD)
    sheets, ends = [], []
    for number, (top, bottom) in enumerate(parts):
        sheets.append(Sheet(width, height, content.drawing.dpi))
        y = MARGIN
        if number == 0:
            draw_header(sheets[0], content, MARGIN, y, width - 2 * MARGIN)
            y += header_height(content)
        y = draw_tracks(sheets[-1], content, top, bottom, y)
        ends.append(content.drawing.depth_unit.ends(top, bottom))
    for least, _, most, draw in _tail(content, width):
        if y + GAP + least > free:  # this part does not fit on the page: a new page
            longest = least + 2 * MARGIN + footer_height(content)
            sheets.append(Sheet(width, max(height, longest), content.drawing.dpi))
            ends.append("")
            y = MARGIN - GAP
        taken = min(max(free - y - GAP, least), most)
        draw(sheets[-1], content, y + GAP, taken)
        y += taken
    for _, draw_picks in pick_parts(content, free - MARGIN) if picks else ():
        sheets.append(Sheet(width, height, content.drawing.dpi))
        ends.append("")
        draw_picks(sheets[-1], MARGIN)
    kind = "page" if picks else "picture"  # of a report, whose pages are not these
    for number, (sheet, part) in enumerate(zip(sheets, ends, strict=True), 1):
        draw_footer(sheet, content, MARGIN, sheet.height - MARGIN, f"{kind} {number} of {len(sheets)}", part)
    return [sheet.figure for sheet in sheets]


def _fit(tracks: list[PlacedTrack], room: float) -> None:
    """Narrow tracks that take more than ``room`` millimetres, each by the same share of what it may lose."""
    free = room - GAP * (len(tracks) - 1)
    over = sum(track.width for track in tracks) - free
    share = over / max(sum(track.width - track.least for track in tracks), 1e-9)
    for track in tracks if over > 0 else ():
        track.width -= min(share, 1.0) * (track.width - track.least)


def _width(content: Content) -> float:
    return max(NARROWEST, 2 * MARGIN + tracks_width(content))


def _divided(content: Content, room: float) -> list[tuple[float, float]]:
    """Return the ends of the interval's part on each page, cut at depth lines.

    Tracks have ``room`` millimetres on a page; the first page also has the header.
    """
    metres = content.scale / 1000.0
    parts, top, free = [], content.top, room - header_height(content)
    while (content.bottom - top) / metres > free + 1e-6:
        cut = _cut(content, top, top + free * metres)
        if cut <= top:
            cut = top + free * metres
        parts.append((top, cut))
        top, free = cut, room
    if parts and content.bottom - top < STUB * metres:  # the last page takes some metres from the page before it
        top = parts.pop()[0]
        cut = _cut(content, top, content.bottom - STUB * metres)
        if top < cut < content.bottom:
            parts.append((top, cut))
            top = cut
    return [*parts, (top, content.bottom)]


def _cut(content: Content, top: float, lowest: float) -> float:
    """Return where a page from ``top`` to ``lowest`` at most ends: at the deepest thick line, or else the deepest thin
    line, that cuts no sinusoid of a plane and leaves at most `UNUSED` of the page; if there is none, at a thick line.
    """
    planes = [pick for pick in content.picks if pick.kind in PLANES]
    bit_diameter = content.wall.settings.bit_diameter
    highest = lowest - UNUSED * (lowest - top)
    for apart in (content.lines.coarse, content.lines.fine):
        for number in range(math.floor(lowest / apart + 1e-9), math.ceil(highest / apart) - 1, -1):
            cut = number * apart
            if not any(pick.reaches(cut, cut, bit_diameter) for pick in planes):
                return cut
    return content.lines.coarse * math.floor(lowest / content.lines.coarse + 1e-9)


def draw_tracks(sheet: Sheet, content: Content, top: float, bottom: float, y: float) -> float:
    """Draw heads and tracks between two depths, from ``y`` millimetres down; return the millimetres where they end."""
    height = (bottom - top) * 1000.0 / content.scale
    stretch = Stretch(top, bottom, y + HEAD, height, content.lines)
    x, first = MARGIN, None
    for track in content.tracks:
        track.head(sheet, x, y)
        sheet.box(x, y, track.width, HEAD)
        axes = track.draw(sheet, x, stretch)
        tops_across(axes, content.wall.intervals, stretch)
        if first is not None:
            axes.sharey(first)
        first = first or axes
        x += track.width + GAP
    _mark(sheet, content, stretch)
    return y + HEAD + height


def _mark(sheet: Sheet, content: Content, stretch: Stretch) -> None:
    """Write the letters of the cross sections left of the tracks; draw a bar along the shaded body right of them."""

    def down(depth: float) -> float:
        return stretch.y + (depth - stretch.top) / (stretch.bottom - stretch.top) * stretch.height

    last = -10.0
    for letter, section in zip(content.letters, content.sections, strict=True):
        if stretch.top <= section.depth < stretch.bottom or section.depth == stretch.bottom == content.bottom:
            at = down(section.depth)
            sheet.line((MARGIN - 2.0, MARGIN), (at, at), color=INK, linewidth=0.8)
            sheet.text(MARGIN - 2.4, max(at, last + 2.4), letter, SMALL, ha="right", weight="bold")
            last = max(at, last + 2.4)
    if content.stretched is not None:
        top, bottom = (min(max(depth, stretch.top), stretch.bottom) for depth in content.stretched.depth)
        if bottom > top:
            right = MARGIN + tracks_width(content)
            sheet.line((right + 1.2, right + 1.2), (down(top), down(bottom)), color=INK, linewidth=2.0)


def tracks_width(content: Content) -> float:
    """Return the millimetres that the tracks take with their gaps."""
    return sum(track.width for track in content.tracks) + GAP * (len(content.tracks) - 1)


def _sections_across(width: float) -> int:
    """Return how many cross sections stand side by side on a sheet ``width`` millimetres wide."""
    return max(int((width - 2 * MARGIN + 2.0) // WIDTH), 1)


def _tail(content: Content, width: float) -> list[tuple[float, float, float, _Draw]]:
    """Return the parts below the tracks: the least, usual and greatest height of each, millimetres, and what draws it.

    The function that draws a part takes the millimetres from the top, and the height that the part has.
    """
    parts: list[tuple[float, float, float, _Draw]] = []
    zones = zone_list_height(content)
    if zones:
        parts.append((zones + 2.0,) * 3 + (_draw_zones,))
    if content.sections:
        rows = math.ceil(len(content.sections) / _sections_across(width))
        parts.append((rows * HEIGHT + 8.0,) * 3 + (_draw_sections,))
    if content.stretched is not None:
        parts.append((LEAST_BODY + 6.0, BODY + 6.0, MOST_BODY + 6.0, _draw_bodies))
    if content.drawing.picture:
        high, wide = content.picture.shape[:2]
        height = min(MOST_BODY, (width - 2 * MARGIN) * high / wide)
        parts.append((height + 6.0,) * 3 + (_draw_picture,))
    return parts


def _draw_zones(sheet: Sheet, content: Content, y: float, _: float) -> None:
    draw_zones(sheet, content, MARGIN, y + 1.0, sheet.width - 2 * MARGIN)


def _draw_sections(sheet: Sheet, content: Content, y: float, _: float) -> None:
    """Draw the cross sections in rows, below a line that explains them."""
    drawing, settings = content.drawing, content.wall.settings
    key = key_text(settings.bit_diameter, drawing.size_unit, settings.pitch, bool(content.hatching))
    sheet.text(MARGIN, y + 3.0, key, USUAL, within=sheet.width - 2 * MARGIN)
    across = _sections_across(sheet.width)
    outer = largest_shown(content.sections, settings.bit_diameter)
    look = (settings.bit_diameter, outer, drawing.size_unit, content.reference, drawing.depth_unit)
    for index, (letter, section) in enumerate(zip(content.letters, content.sections, strict=True)):
        place = (MARGIN + index % across * WIDTH, y + 7.0 + index // across * HEIGHT)
        draw_section(sheet, *place, section, letter, look)


def _draw_bodies(sheet: Sheet, content: Content, y: float, height: float) -> None:
    """Draw the shaded body, once in each of its colours."""
    width = (sheet.width - 2 * MARGIN) / max(len(content.bodies), 2)
    for index, body in enumerate(content.bodies):
        _draw_body(sheet, (MARGIN + index * width, y + 3.0, width - 4.0, height - 6.0), content, body)


def _draw_picture(sheet: Sheet, content: Content, y: float, height: float) -> None:
    """Draw the picture of the page, as wide as its height allows."""
    high, wide = content.picture.shape[:2]
    axes = sheet.axes(MARGIN, y + 3.0, (height - 6.0) * wide / high, height - 6.0)
    axes.imshow(content.picture, aspect="auto", interpolation="antialiased")
    axes.set_axis_off()


def _draw_body(sheet: Sheet, box: tuple[float, float, float, float], content: Content, body: Body) -> Axes:
    """Draw the shaded body in one of its colours."""
    assert content.stretched is not None
    coloured = (body.scale, body.values, body.name, content.interpolated, content.drawing.depth_unit)
    return draw_solid(sheet, box, content.wall, content.stretched, *coloured)


def overview(wall: Wall, **options: Any) -> Figure:
    """Draw the tracks of `log` for a screen, without cross sections, and the shaded body at their right.

    ``wall``, ``options``, result and errors are those of `log`; ``polar`` has no effect.
    """
    content = content_of(wall, Drawing(**{**options, "polar": ()}))
    length = content.paper_length()
    body = content.bodies[-1] if content.bodies else None
    right = MARGIN + tracks_width(content)
    width = max(NARROWEST, right + (TIES + OVERVIEW_BODY if body else 0.0) + MARGIN)  # header and foot need so much
    height = MARGIN + header_height(content) + HEAD + (max(length, LEAST) if body else length)
    height += GAP + footer_height(content) + MARGIN
    sheet = Sheet(width, height, content.drawing.dpi)
    draw_header(sheet, content, MARGIN, MARGIN, width - 2 * MARGIN)
    top = MARGIN + header_height(content)
    draw_tracks(sheet, content, content.top, content.bottom, top)
    if body is not None and content.stretched is not None:
        box = (right + TIES, top + HEAD - 10.0, OVERVIEW_BODY, max(length, LEAST) + 10.0)
        axes = _draw_body(sheet, box, content, body)
        for depth in content.stretched.depth:
            on_tracks = min(max(depth, content.top), content.bottom)
            beside = top + HEAD + (on_tracks - content.top) / (content.bottom - content.top) * length
            place, (low, high) = axes.get_position(), axes.get_ylim()
            at = sheet.height * (1.0 - (place.y0 + (depth - low) / (high - low) * place.height))
            sheet.line((right + 1.8, right + TIES + 1.0), (beside, float(at)), color=FAINT, linewidth=0.5)
    draw_footer(
        sheet, content, MARGIN, height - MARGIN, part=content.drawing.depth_unit.ends(content.top, content.bottom)
    )
    return sheet.figure

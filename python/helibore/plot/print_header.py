"""The header of a log, which states the hole and what was measured, and the foot, which explains the symbols.

If a wall does not show the shape of the hole, the header says so in red.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

from helibore._core import __version__
from helibore.base.colors import PICK_COLORS
from helibore.base.units import INCH
from helibore.logs.turn_logs import COVERED, NO_UNCERTAINTY
from helibore.logs.zones import SURE
from helibore.plot.depth_scales import length_text
from helibore.plot.hatching import HATCH_BYTES, NO_DATA, NO_DATA_LINE, rgb
from helibore.plot.paper import FAINT, INK, LARGE, RULE, SMALL, USUAL, Sheet
from helibore.plot.picked import DASHES
from helibore.plot.tracks import LETTERS
from helibore.plot.zone_list import criteria_text, zone_sign
from helibore.trajectory.references import reference_assumed

if TYPE_CHECKING:
    from helibore.plot.content import Content

REFERENCE_TEXT = {
    "high-side": "from the high side, clockwise looking downhole",
    "north": "from north, clockwise looking downhole",
    "parallel-transport": "from north at the top of the path, without twist, clockwise",
    "": "as the samples count it; no path states what 0 is",
}
SIDES_TEXT = {
    "high-side": "U up (high side), R right, D down, L left of the hole, looking downhole",
    "north": "N, E, S, W: sides of the hole, clockwise looking downhole",
    "parallel-transport": "0° to 270°: toolfaces from north at the top of the path, without twist",
    "": "0° to 270°: toolfaces as the samples count them, clockwise looking downhole",
}
STATES_NORTH = "path.north states it"
"""What the reader of a print can do about a north that the survey does not state."""
WARNING = "#b3261e"
HEADER = {
    "company": "Company", "field": "Field", "location": "Location", "service": "Service co.", "run": "Run",
    "date": "Date", "datum": "Depth datum", "kb": "Elevation KB", "gl": "Elevation GL", "mud": "Mud",
}  # fmt: skip
"""Entries of the header of every log, with their labels; if the drawing lacks an entry, the header shows "not given".
"""
BLOCK = 22.4
"""Height of the upper part of the header, with the title and the entries of `HEADER`, millimetres."""
TOPS_A_ROW, TOP_ROWS = 3, 4
"""Names of tops in a row of the header, and rows that they have at most."""
ROW = 3.6
"""Millimetres between the rows of the foot."""
MADE = 62.0
"""Width at the right of the foot for the number of the scale bar and the version of helibore, millimetres."""


def facts(content: Content) -> list[tuple[str, str, bool]]:
    """Return the rows of the header that follow from the wall: label, text, and whether the text is a warning."""
    wall, settings, summary = content.wall, content.wall.settings, content.summary()
    bit = settings.bit_diameter
    unit = content.drawing.depth_unit
    ends = unit.ends(content.top, content.bottom)
    elevation = content.drawing.elevation
    header = content.drawing.header
    hole = [(name[:1].upper() + name[1:], text, False) for name, text in header.items() if text and name not in HEADER]
    below = "" if elevation is None else f"; TVDSS is TVD less {elevation / unit.metres:.6g} {unit.name}"
    paper = f"{1000 * unit.metres / content.scale:.4g} mm on paper a {'foot' if unit.name == 'ft' else 'metre'}"
    pitch = f"{settings.pitch / unit.metres:.4g} {unit.name}"
    measured: list[tuple[str, str, bool]] = []
    if wall.basis != "gauge":  # samples of a gauge hole are not measurements
        measured.append(("Samples", f"{summary.samples:,}", False))
        measured.append(
            ("Measured", measured_text(content), summary.coverage < COVERED)
            if content.hatching
            else ("No sample in reach", f"{100 * summary.without_radius:.2f} % of the interval", False)
        )
    if wall.basis == "azimuthal":
        metres = (f"{kind} {unit.text(length, 1)} {unit.name}" for kind, length in summary.kinds.items())
        measured.append(("Zones", ", ".join(metres) or "none by the criteria at the foot", False))
    return [
        *hole,
        ("Interval", f"{ends} ({unit.text(content.bottom - content.top, 1)} {unit.name})", False),
        ("Bit size", f"{length_text(bit / INCH, 'in')} ({bit * 1e3:.1f} mm)", False),
        ("Depth scale", f"1:{content.scale}, {paper}{below}", False),
        ("Toolface", toolface_text(content), False),
        *([("Survey", survey_text(content), False)] if wall.path is not None else []),
        ("Wall made from", wall.basis_text, wall.basis != "azimuthal"),
        *shifts(content),
        *measured,
        *picked_and_tops(content),
        ("Helix", f"{settings.sectors} sectors, pitch {pitch}, {summary.vertices:,} vertices", False),
    ]


def shifts(content: Content) -> list[tuple[str, str, bool]]:
    """Return the row on the shifts of passes in depth and toolface; none if no pass was shifted."""
    noted = content.wall.made_from.get("preparation", ())
    found = [text.split(";")[0].removesuffix(" found") for step, text in noted if step == "shift"]
    moved = any("left where it is" not in text for text in found)
    return [("Shifts", "; ".join(found).replace("+-", "±"), False)] if moved else []


def picked_and_tops(content: Content) -> list[tuple[str, str, bool]]:
    """Return the rows on the picks and the tops of the interval; none where there is none."""
    wall, unit = content.wall, content.drawing.depth_unit
    kinds = Counter(pick.kind for pick in content.picks if content.top <= pick.depth <= content.bottom)
    picks = ", ".join(f"{count} {kind}{'s' if count > 1 else ''}" for kind, count in sorted(kinds.items()))
    starts = [(one.name, one.start) for one in wall.intervals if one.start is not None and not one.track]
    tops = [f"{name} {top / unit.metres:.1f}" for name, top in starts if content.top <= top <= content.bottom]
    rows = [("Picks", picks, False), (f"Tops [{unit.name}]", ", ".join(tops), False)]
    return [row for row in rows if row[1]]


def toolface_text(content: Content) -> str:
    """Return as text what toolfaces count from, and whether that is only assumed."""
    assumed = "assumed " if content.reference and reference_assumed(content.wall) else ""
    return assumed + REFERENCE_TEXT[content.reference]


def survey_text(content: Content) -> str:
    """Return as text the survey file that the path comes from, and which north its azimuths count from, if known."""
    noted = content.wall.made_from.get("survey")
    survey = noted if isinstance(noted, dict) else {}
    stated = _north(content)
    north = f"azimuths from {stated} north" if stated else f"north not stated ({STATES_NORTH})"
    north += "".join(f", {name} {survey[name]:+g} deg" for name in ("declination", "convergence") if name in survey)
    return f"{survey['name']}: {north}" if survey.get("name") else north


def north_of_picks(content: Content) -> str:
    """Return as text which north the dip azimuths of picks count from."""
    if content.wall.path is None:
        return "without a survey, dip and azimuth are not known"
    return f"dip azimuths count from {stated_north(content)}"


def stated_north(content: Content) -> str:
    """Return as text which north the azimuths of the path count from."""
    north = _north(content)
    return f"{north} north" if north else f"a north that is not stated ({STATES_NORTH})"


def _north(content: Content) -> str:
    path = content.wall.path
    return "" if path is None else path.survey.north


def header_rows(content: Content) -> list[tuple[str, str, bool]]:
    """Return the facts of the header, the tops in a few rows; of many, the last row says how many more there are."""
    rows = []
    most = TOPS_A_ROW * TOP_ROWS
    for name, text, warning in facts(content):
        parts = text.split(", ") if name.startswith("Tops") else [text]
        shown = parts if len(parts) <= most else [*parts[: most - 1], f"and {len(parts) - most + 1} more"]
        lines = [", ".join(shown[first : first + TOPS_A_ROW]) for first in range(0, len(shown), TOPS_A_ROW)]
        rows += [(name * (not row), line, warning) for row, line in enumerate(lines)]
    return rows


def header_height(content: Content) -> float:
    """Return the height of the header, millimetres."""
    return BLOCK + 7.2 + 4.3 * ((len(header_rows(content)) + 1) // 2)


def measured_text(content: Content) -> str:
    """Return as text the share of the turns that is measured, and what the rest of the turns is."""
    summary = content.summary()
    if summary.basis != "azimuthal":
        return summary.basis_text
    rest = content.hatching or "interpolated or missing"
    return f"{100 * summary.coverage:.2f} % of the turns; the rest is {rest}"


def draw_header(sheet: Sheet, content: Content, x: float, y: float, width: float) -> None:
    """Draw a frame with the title, the subtitle, the entries of `HEADER` (company, date ...), and the `facts`."""
    title = content.drawing.title or "Borehole wall"
    rows = header_rows(content)
    half = (len(rows) + 1) // 2
    sheet.box(x, y, width, header_height(content) - 3.0, facecolor="none", edgecolor=INK, linewidth=0.8)
    sheet.line((x, x + width), (y + BLOCK, y + BLOCK), color=INK, linewidth=0.8)
    first, label = 0.48 * width, 24.0
    sheet.text(x + 2.0, y + 5.0, title, LARGE, weight="bold", within=first - 4.0)
    sheet.lines_of_text(x + 2.0, y + 13.5, content.drawing.subtitle, USUAL, first - 4.0, 4, color=FAINT)
    for index, name in enumerate(HEADER):
        column, row = divmod(index, len(HEADER) // 2)
        left, at = x + first + column * (width - first) / 2, y + 2.9 + row * 4.15
        if not row:
            sheet.line((left - 1.0, left - 1.0), (y, y + BLOCK), color=RULE)
        text = content.drawing.header.get(name, "")
        sheet.text(left + 0.5, at, HEADER[name], SMALL, color=FAINT)
        look = {"weight": "bold"} if text else {"color": FAINT}
        sheet.text(left + 17.0, at, text or "not given", USUAL, within=(width - first) / 2 - 19.0, **look)
    for index, (name, text, warning) in enumerate(rows):
        column, row = divmod(index, half)
        left, at = x + 2.0 + column * (first - 1.5), y + BLOCK + 3.2 + row * 4.3
        sheet.text(left, at, name, SMALL, color=FAINT, within=label - 1.0)
        look = {"color": WARNING, "weight": "bold"} if warning else {}
        sheet.text(left + label, at, text, USUAL, within=(width - first if column else first) - label - 3.0, **look)


def sentence(text: str) -> str:
    """Return a text as a sentence, with a capital letter and a full stop."""
    return f"{text[0].upper()}{text[1:]}."


def _kinds(content: Content) -> tuple[list[str], list[str]]:
    """Return the kinds of the zones and the kinds of the picks in the interval; the foot explains their colours."""
    zones = {zone.kind for zone in content.zones.by_severity(content.top, content.bottom)}
    reach = content.top, content.bottom, content.wall.settings.bit_diameter
    picks = {pick.kind for pick in content.picks if pick.reaches(*reach)}
    return [kind for kind in LETTERS if kind in zones], [kind for kind in PICK_COLORS if kind in picks]


def footer_height(content: Content) -> float:
    """Return the height of the foot from its upper line to the margin, millimetres."""
    rows = (
        content.wall.basis == "azimuthal",
        content.zones.logs.unmeasured_shape,
        content.ticks_text,
        *_kinds(content),
    )
    return 10.0 + ROW * sum(map(bool, rows))


def draw_footer(sheet: Sheet, content: Content, x: float, bottom: float, page: str = "", part: str = "") -> None:
    """Draw the foot of a page: what letters, colours and criteria mean; then well, depths (``part``), scale, ``page``.

    ``bottom`` is the lower edge of the foot, ``x`` its distance from both sides of the sheet.
    """
    zones, picks = _kinds(content)
    y = bottom - footer_height(content) + 6.0
    sheet.line((x, sheet.width - x), (y - 3.0, y - 3.0))
    key = {"linewidth": 0.4, "facecolor": rgb(NO_DATA), "edgecolor": rgb(NO_DATA_LINE)}
    sheet.box(x, y - 1.2, 4.0, 2.4, **key, hatch="////////")
    left = x + 5.2
    left += sheet.text_width(sheet.text(left, y, "missing: no value, or not sampled there.", SMALL)) + 4.0
    if content.hatching:
        sheet.box(
            left, y - 1.2, 4.0, 2.4, facecolor="white", edgecolor=rgb(HATCH_BYTES), linewidth=0.4, hatch="\\\\\\\\\\"
        )
        left += 5.2
        left += sheet.text_width(sheet.text(left, y, content.hatching, SMALL)) + 4.0
    sheet.text(left, y, SIDES_TEXT[content.reference], SMALL, within=sheet.width - x - left)
    if content.zones.logs.unmeasured_shape:
        y += ROW
        sheet.text(x, y, sentence(NO_UNCERTAINTY), SMALL, within=sheet.width - 2 * x)
    if content.ticks_text:
        y += ROW
        sheet.text(x, y, content.ticks_text, SMALL, within=sheet.width - 2 * x)
    for name, kinds in (("Zones", zones), ("Picks", picks)):
        if not kinds:
            continue
        y += ROW
        left = x + sheet.text_width(sheet.text(x, y, f"{name}:", SMALL)) + 2.0
        for kind in kinds:
            if name == "Zones":
                zone_sign(sheet, left, y, kind)
            else:
                look: dict[str, Any] = {"color": PICK_COLORS[kind], "dashes": DASHES.get(kind, (None, None))}
                sheet.line((left - 1.0, left + 4.0), (y, y), linewidth=1.0, **look)
            left += 4.0 + 1.2
            left += sheet.text_width(sheet.text(left, y, kind, SMALL)) + 4.0
        if name == "Zones":
            text = f"hollow: the kind is not sure, its probability is below {SURE:g}"
            sheet.text(left, y, text, SMALL, within=sheet.width - x - left)
    if content.wall.basis == "azimuthal":
        y += ROW
        sheet.text(x, y, f"Criteria: {criteria_text(content)}", SMALL, within=sheet.width - 2 * x)
    y += ROW
    left = _draw_scale_bar(sheet, content, y) if part else sheet.width - MADE
    made = f"helibore {__version__}" + (f", {page}" if page else "")
    sheet.text(sheet.width - x, y, made, SMALL, ha="right", color=FAINT)
    title = content.drawing.title or "Borehole wall"
    sheet.text(x, y, f"{title}, {part}, 1:{content.scale}" if part else title, SMALL, within=left - x - 3.0)


def _draw_scale_bar(sheet: Sheet, content: Content, y: float) -> float:
    """Draw a bar as long as the depth between two numbered lines, to check the scale by ruler; return its left end."""
    unit, depth = content.lines.unit, content.lines.coarse
    length = depth * 1000.0 / content.scale
    left = sheet.width - MADE - length
    for part in range(4):
        face = INK if part % 2 == 0 else "white"
        sheet.box(
            left + 0.25 * part * length, y - 0.6, 0.25 * length, 1.2, facecolor=face, edgecolor=INK, linewidth=0.4
        )
    text = f"{depth / unit.metres:.6g} {unit.name}"
    sheet.text(left + length + 1.2, y, text, SMALL)
    return left

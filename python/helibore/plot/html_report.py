"""A report of a wall as one HTML file, which contains its pictures and loads nothing from the network.

    from helibore.plot.html_report import report
    report(wall, "well.html", title="F-12")         # opens in any browser, prints on A4 at the scale it says

It shows the summary, the pictures, diameters by interval, zones, picks, data quality and settings, and a cement sheet
and the direction of the greatest horizontal stress if these are given. Numbers come from `Wall.summary` and the zones,
pictures from `pages_of`. No template library is used; every text is escaped.
"""

from __future__ import annotations

import base64
import math
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict
from itertools import pairwise, repeat
from typing import TYPE_CHECKING, Any

from helibore._core import __version__
from helibore.base.angles import azimuth_text
from helibore.base.arrays import runs_of
from helibore.base.atomic_file import write_whole
from helibore.base.harmless import in_html
from helibore.base.units import BARREL
from helibore.logs.intervals import interval_table, outside_text, tracks_of
from helibore.logs.summary import WallSummary
from helibore.logs.turn_logs import NO_UNCERTAINTY, RANGED, TOOLFACE_0
from helibore.logs.zone_criteria import MEASURES
from helibore.logs.zones import KINDS, SIZES
from helibore.plot.cells import in_depth_unit, in_unit, number
from helibore.plot.content import Drawing, content_of
from helibore.plot.depth_scales import multiples
from helibore.plot.diameters import Diameters
from helibore.plot.log import pages_of
from helibore.plot.paper import MM, rendered
from helibore.plot.pick_pages import in_interval, nets, table_head, table_note, table_row
from helibore.plot.print_header import HEADER, facts, measured_text, sentence, stated_north, toolface_text
from helibore.plot.stress_rose import stress_rose
from helibore.plot.tracks import LETTERS, zone_look
from helibore.plot.zone_list import criteria_text
from helibore.trajectory.references import reference_assumed

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from helibore.logs.cement_sheet import CementSheet
    from helibore.logs.intervals import Interval
    from helibore.logs.stress import HorizontalStress
    from helibore.logs.zones import Classification, Zone
    from helibore.plot.content import Content
    from helibore.wall.wall import Wall

PAPER = (210.0, 268.0)
"""Width and height of a picture, millimetres: as wide as A4, and as high as the page's margins leave."""
ROWS = 24
"""Most steps of depth in the table of diameters; parts of a step at both ends give one row more."""
MOST_GAPS = 10
SOFT = "\u00ad"
"""Soft hyphen: on a narrow page, the browser breaks a long head of a column there."""
SETTING_UNITS = dict.fromkeys(("bit_diameter", "pitch", "start_depth", "stop_depth", "max_distance", "tolerance"), "m")
SETTING_UNITS |= {"kriging_range": "m", "start_toolface": "deg"}
NO_SETTING = {"start_depth": "that of the samples", "stop_depth": "that of the samples", "window": "all samples"}
STYLE = """
:root { color-scheme: light; }
body { font: 15px/1.5 system-ui, "Segoe UI", Helvetica, Arial, sans-serif; color: #22303c; background: #fff;
       max-width: 200mm; margin: 2rem auto; padding: 0 5mm; }
h1 { font-size: 1.9rem; margin: 0; } h2 { font-size: 1.25rem; margin: 2.2rem 0 .5rem; }
p.lead { color: #5d6b77; margin: .2rem 0 1rem; } .warning { color: #b3261e; font-weight: 600; }
table { border-collapse: collapse; width: 100%; font-size: .84rem; font-variant-numeric: tabular-nums; }
th, td { padding: .25rem .5rem; border-bottom: 1px solid #dfe4e8; text-align: left; vertical-align: top; }
thead th { border-bottom: 1.5px solid #22303c; vertical-align: bottom; }
td.number, th.number { text-align: right; } td.number { white-space: nowrap; }
tbody th { font-weight: 400; color: #5d6b77; width: 26%; }
thead th, td.number { padding: .25rem .3rem; }
td { white-space: nowrap; } tbody th + td { white-space: normal; overflow-wrap: anywhere; }
#zones td:first-child, #intervals td:first-child { white-space: normal; }
#picks td:last-child, #picks th:last-child { white-space: normal; text-align: left; }
#intervals table { font-size: .7rem; } #intervals th, #intervals td { padding: .25rem .15rem; }
td.missing { background: #b0b0b0; } b.sign { display: inline-block; width: 1.3em; border: 2px solid;
  text-align: center; line-height: 1.2; print-color-adjust: exact; -webkit-print-color-adjust: exact; }
 figure { margin: 0 -5mm; } img { max-width: 100%; display: block; }
nav a { color: inherit; margin-right: 1.2em; } footer { color: #5d6b77; font-size: .8rem; margin-top: 2rem; }
@media screen and (max-width: 700px) { body { padding: 0 3mm; margin: 1rem auto; } figure { margin: 0; }
  section, figure { overflow-x: auto; } img { max-width: none; width: 760px !important; }
  figure::before { content: "Scroll sideways \\2192"; position: sticky; left: 0; color: #5d6b77; font-size: .8rem; }
  nav a { display: inline-block; padding: .3rem 0; } tbody th { width: auto; } }
@media screen and (max-width: 480px) { body { padding: 0 2mm; } table { font-size: .7rem; }
  #diameters td { white-space: normal; }
  th, td, thead th, td.number { padding: .25rem .1rem; } thead th { font-size: .62rem; }
  td:first-child, #zones td:last-child { white-space: normal; } }
@page { size: A4; margin: 12mm 0; }
@media print { body { margin: 0; max-width: 200mm; } nav, #pictures h2 { display: none; } tr { break-inside: avoid; }
  figure { break-inside: avoid; } h2 { break-after: avoid; } thead { display: table-header-group; } }
"""


def report(
    wall: Wall,
    filename: str | os.PathLike[str],
    *,
    messages: Sequence[tuple[str, str]] = (),
    cement: CementSheet | None = None,
    stress: HorizontalStress | None = None,
    **options: Any,
) -> None:
    """Write a report of a wall as one self-contained HTML page, whole or not at all.

    Parameters
    ----------
    wall
        At least one full turn.
    filename
        An existing file is replaced.
    messages
        (label, sentence) pairs that say which readings and samples were read, dropped and corrected.
    cement
        From `Logs.cement_sheet`; None: no section on cement.
    stress
        From `helibore.stress_of_picks`, `helibore.stress_of_zones` or `helibore.horizontal_stress`; None: no section.
    **options
        As in `helibore.plot.Drawing`.

    Raises
    ------
    InputError, MissingExtraError
        As `helibore.plot.log`.
    OSError
        If the file cannot be written; an existing file then does not change.
    """
    content = page(wall, messages, cement, stress, **options).encode()
    write_whole(filename, lambda file: file.write(content))


def page(
    wall: Wall,
    messages: Sequence[tuple[str, str]] = (),
    cement: CementSheet | None = None,
    stress: HorizontalStress | None = None,
    **options: Any,
) -> str:
    """Return what `report` writes, as text."""
    content = content_of(wall, Drawing(**options))
    zones = content.zones if wall.basis == "azimuthal" else None
    title = in_html(content.drawing.title or "Borehole wall")
    warned = "" if wall.basis == "azimuthal" else f'<p class="warning">{in_html(wall.basis_text)}.</p>'
    parts = [
        ("summary", "Summary", warned + _summary(content)),
        ("pictures", "Pictures", _pictures(content)),
        ("diameters", "Diameters and volumes", _diameters(content)),
        *([("intervals", "Intervals", _intervals(content))] if wall.intervals else []),
        *([("cement", "Cement", _cement(cement, content))] if cement else []),
        ("zones", "Zones", _zones(zones, content)),
        ("picks", "Picks", _picks(content)),
        *([("stress", "Stress", _stress(stress))] if stress else []),
        ("quality", "Data quality", _quality(content, messages)),
        ("settings", "Settings", _settings(content, zones)),
    ]
    links = "".join(f'<a href="#{name}">{heading}</a>' for name, heading, _ in parts)
    body = "\n".join(f'<section id="{name}"><h2>{heading}</h2>\n{text}</section>' for name, heading, text in parts)
    lead = in_html(content.drawing.subtitle)
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">\n<title>{title}</title>\n'
        f'<meta name="viewport" content="width=device-width, initial-scale=1">\n<style>{STYLE}</style></head>\n'
        f'<body><h1>{title}</h1><p class="lead">{lead}</p><nav>{links}</nav>\n{body}\n'
        f"<footer>helibore {in_html(__version__)}. Depths are measured depths; toolfaces count clockwise "
        f"looking downhole.</footer></body></html>\n"
    )


def table(
    head: Sequence[str], rows: Iterable[Sequence[str]], numbers: bool = True, signs: Iterable[str] = repeat("")
) -> str:
    """Return a table of texts as HTML; with ``numbers``, all columns but the first are set flush right.

    ``signs`` is HTML before the first text of each row.
    """

    def cells(tag: str, row: Sequence[str], sign: str = "") -> str:
        found = []
        for at, text in enumerate(row):
            kinds = ["number"] * (numbers and at > 0) + ["missing"] * (tag == "td" and not text)
            name = f' class="{" ".join(kinds)}"' if kinds else ""
            found.append(f"<{tag}{name}>{'' if at else sign}{in_html(text)}</{tag}>")
        return f"<tr>{''.join(found)}</tr>"

    body = "".join(cells("td", row, sign) for row, sign in zip(rows, signs, strict=False))
    return f"<table><thead>{cells('th', head)}</thead><tbody>{body}</tbody></table>"


def pairs(rows: Iterable[tuple[str, str]]) -> str:
    """Return a table of labels and texts as HTML."""
    lines = (f"<tr><th>{in_html(label)}</th><td>{in_html(text)}</td></tr>" for label, text in rows)
    return f"<table><tbody>{''.join(lines)}</tbody></table>"


def intervals(content: Content) -> list[WallSummary]:
    """Return the summaries of the parts of the interval between multiples of a round length."""
    length = content.bottom - content.top
    steps = (mantissa * 10.0**power for power in range(-1, 5) for mantissa in (1, 2, 5))
    unit = content.drawing.depth_unit.metres
    step = next(unit * step for step in steps if length / (unit * step) <= ROWS)
    between = [
        cut for cut in multiples(step, content.top, content.bottom) if content.top + 1e-6 < cut < content.bottom - 1e-6
    ]
    ends = [content.top, *between, content.bottom]
    return [content.summary(a, b) for a, b in pairwise(ends)]


def _summary(content: Content) -> str:
    summary, wall = content.summary(), content.wall
    stated = [(HEADER[name], text) for name, text in content.drawing.header.items() if text and name in HEADER]
    rows = [*stated, *((label, text) for label, text, _ in facts(content))]
    depths = content.drawing.depth_unit.name
    if summary.whole_turns and wall.basis != "gauge":
        ends = [in_unit(extreme.value, content) for extreme in (summary.least_diameter, summary.greatest_diameter)]
        mean = summary.mean_text(content.drawing.size_unit)
        sizes = f"{mean} mean, {ends[0]} to {ends[1]} {content.drawing.size_unit} across"
        volume = (
            f"{summary.volume_text()} over {in_depth_unit(summary.whole_turns, content, 1)} {depths} of whole turns"
        )
        rows += [
            ("Diameter", sizes),
            ("Hole volume", f"{volume}; {summary.excess_text()} against the bit"),
        ]
    if wall.basis == "azimuthal":
        axis, azimuth = summary.breakout_axis, summary.breakout_azimuth
        if math.isfinite(azimuth.mean):
            axes = f"{azimuth_text(azimuth.mean)}° and {azimuth_text(azimuth.mean + 180)}° from {stated_north(content)}"
            rows.append(("Breakout azimuth", f"{axes}, {azimuth.spread('zone', '°', 0)}"))
        if math.isfinite(axis.mean):
            axes = f"toolfaces {axis.mean:.0f}° and {axis.mean + 180:.0f}°, {axis.spread('zone', '°', 0)}"
            rows.append(("Breakout axis", axes))
    rows += [("Warning", text) for text in summary.warnings]
    images = [f"{name} ({image.unit or 'no unit'})" for name, image in wall.images.items()]
    return pairs([*rows, ("Images", ", ".join(images) or "none")])


def _pictures(content: Content) -> str:
    figures = []
    for at, figure in enumerate(pages_of(content, PAPER, picks=False), 1):
        words = f"Log of {content.drawing.title or 'the wall'}, part {at}: depth, caliper, images at 1:{content.scale}"
        width = figure.get_size_inches()[0] * MM
        # On A4 at 100 %, a picture 210 mm wide is printed at its true size; a wider picture is shrunk, so its scale is
        # not true.
        wide = f"<figcaption>{width:g} mm wide: on narrower paper the depth scale is not true.</figcaption>"
        figures.append(_figure(figure, words, width, wide if width > PAPER[0] + 1e-6 else ""))
    return "\n".join(figures)


def _diameters(content: Content) -> str:
    if content.wall.basis == "gauge":
        return "<p>The hole was not measured.</p>"
    unit, depths = content.drawing.size_unit, content.drawing.depth_unit.name
    head = (f"From [{depths}]", f"To [{depths}]", f"Mean [{unit}]", f"Least [{unit}]", f"Greatest [{unit}]",
            "Volume [m³]", "Excess [%]", "Whole turns [%]")  # fmt: skip
    rows = []
    for row in intervals(content):
        lengths = (row.least_diameter.value, row.greatest_diameter.value)
        has = row.whole_turns > 0
        excesses = row.excess_range if row.ranged else (row.excess,)
        of_row = [in_unit(size, content) for size in row.mean_diameter_range[: 1 + row.ranged]]
        share = 100 * row.whole_turns / max(row.whole_turns + row.incomplete_turns, 1e-9)
        volume = (row.volume_span() if row.ranged else number(row.volume, 4)) if has else ""
        excess = " to ".join(number(100 * each, 0 if row.ranged else 1) for each in excesses) if has else ""
        rest = [volume, excess, number(share, 1)]
        ends = (in_depth_unit(row.start, content), in_depth_unit(row.stop, content))
        rows.append([*ends, " to ".join(of_row) if has else "", *(in_unit(size, content) for size in lengths), *rest])
    note = (
        "Mean: diameter of the cylinder with the same volume. Least and greatest (C1): diameters "
        "through the hole's axis, of two opposite radii; twice the greatest radius can be more. "
        "All these numbers come from whole turns: those without a missing radius, measured or interpolated."
    )
    low, high = content.zones.logs.diameter_range
    if (low < high).any():
        note += f" {sentence(RANGED)}"
    unsure = f"<p>{sentence(NO_UNCERTAINTY)}</p>" if content.zones.logs.unmeasured_shape else ""
    ticks = f"<p>{in_html(content.ticks_text)}.</p>" if content.ticks_text else ""
    return table(head, rows) + f"<p>{note}</p>{ticks}{unsure}"


def _intervals(content: Content) -> str:
    """Return what was measured in each formation, and the casings and columns of the mud log, as HTML."""
    drawing = content.drawing
    found = []
    for name, intervals in sorted(tracks_of(content.wall.intervals).items(), key=lambda track: track[0] != ""):
        if not name:
            note = "Numbers are those of the part that the log reaches; an interval without any has none."
            found.append(f"<p>{note}</p>" + table(*_formations(intervals, content)))
            continue
        outside = outside_text(intervals, content.top, content.bottom)
        found.append(f"<p>{in_html(sentence(f'{name}: {outside}'))}</p>" if outside else "")
        pipes = any(one.diameter is not None for one in intervals)
        shown = [one for one in intervals if pipes or (one.stop > content.top and one.start < content.bottom)]
        depths = drawing.depth_unit.name
        head = [name, f"From [{depths}]", f"To [{depths}]", *[f"Outer diameter [{drawing.size_unit}]"] * pipes]
        rows = [
            [one.name, in_depth_unit(one.start, content),
             in_depth_unit(one.stop, content) if math.isfinite(one.stop) else " ",
             *[" " if one.diameter is None else in_unit(one.diameter, content)] * pipes]
            for one in shown
        ]  # fmt: skip
        found.append(table(head, rows) if rows else "")
    return "".join(found)


def _formations(intervals: Sequence[Interval], content: Content) -> tuple[list[str], list[list[str]]]:
    """Return the head and the rows of what was measured in each formation; a column without values is left out."""
    unit, depths = content.drawing.size_unit, content.drawing.depth_unit.name
    kinds = [f"Wash{SOFT}out", f"Break{SOFT}out", "Key seat", f"Under{SOFT}gauge"]
    head = ["Interval", f"Top [{depths}]", f"Bottom [{depths}]", f"Logged [{depths}]", f"Mean [{unit}]",
            f"Least [{unit}]", f"Great{SOFT}est [{unit}]", f"In{SOFT}scribed [{unit}]", "Volume [m³]", "± [m³]",
            "Excess [%]", f"Meas{SOFT}ured [%]", *(f"{kind} [{depths}]" for kind in kinds)]  # fmt: skip
    rows = []
    for of, summary, sigma in interval_table(content.state, intervals, content.zones).intervals:
        row = [of.name, in_depth_unit(of.start, content), in_depth_unit(of.stop, content) or " "]
        if summary is None:
            rows.append([*row, in_depth_unit(0.0, content), *[""] * (len(head) - 4)])
            continue
        sizes = (summary.least_diameter, summary.greatest_diameter, summary.inscribed_diameter)
        shaped = summary.basis == "azimuthal"
        rows.append([
            *row, in_depth_unit(summary.whole_turns + summary.incomplete_turns, content),
            *(in_unit(size, content) for size in (summary.mean_diameter, *(one.value for one in sizes))),
            number(summary.volume if summary.whole_turns else math.nan, 4), number(sigma, 4),
            number(100 * summary.excess, 1), number(100 * summary.coverage, 1),
            *(in_depth_unit(summary.kinds.get(kind, 0.0), content) if shaped else "" for kind in KINDS[1:]),
        ])  # fmt: skip
    filled = [at for at, column in enumerate(zip(*rows, strict=True)) if at < 4 or any(column)]
    return [head[at] for at in filled], [[row[at] for at in filled] for row in rows]


def _cement(sheet: CementSheet, content: Content) -> str:
    """Return the sheet of a cement job, as HTML."""
    depths, job = content.drawing.depth_unit.name, sheet.job
    sure = not math.isnan(sheet.sigma)
    head = ["Section", "Slurry", f"From [{depths}]", f"To [{depths}]", "Volume [m³]", "[bbl]", *["± [m³]"] * sure,
            "By bit size [m³]", "Measured [%]"]  # fmt: skip
    by_bit = sum(each.by_bit_size for each in sheet.sections)
    rows = [
        [each.name, each.slurry or " ", in_depth_unit(each.top, content), in_depth_unit(each.bottom, content),
         *_volumes(each.volume, each.sigma, sure), number(each.by_bit_size, 2), number(100 * each.measured, 1)]
        for each in sheet.sections
    ]  # fmt: skip
    blank = [" "] * 3
    rows.append(["total", *blank, *_volumes(sheet.total, sheet.sigma, sure), number(by_bit, 2), " "])
    parts = [(name, sheet.slurry(name)) for name in ("lead", "tail")]
    parts.append(("displacement", sheet.displacement))
    rows += [[name, *blank, *_volumes(of, 0.0, False), *[" "] * (2 + sure)] for name, of in parts if of > 0]
    text = f"Casing of {in_unit(job.casing, content)} {content.drawing.size_unit}"
    text += f", shoe at {in_depth_unit(job.shoe, content)} {depths}"
    if job.excess:
        text += f"; {100 * job.excess:g} % excess over the open hole"
    note = "Where the hole was not measured, a section takes the mean of its measured part."
    if sure:
        note += " ±: upper limit of the standard uncertainty."
    return f"<p>{in_html(text)}.</p>{table(head, rows)}<p>{note}</p>"


def _volumes(volume: float, sigma: float, sure: bool) -> list[str]:
    """Return a volume in cubic metres and barrels and, if it is known, its uncertainty."""
    return [number(volume, 2), number(volume / BARREL, 1), *[number(sigma, 2)] * sure]


def _stress(found: HorizontalStress) -> str:
    """Return the direction of the greatest horizontal stress, its rank and its rose, as HTML."""
    if not found.count:
        return f"<p>{in_html(str(found))}.</p>"
    spread = "one feature" if math.isnan(found.deviation) else f"{found.deviation:.1f}°"
    rows = [
        ("SHmax", f"{found.azimuth:.0f}° from true north"),
        ("Standard deviation", spread),
        ("Rank", f"{found.rank} (World Stress Map, {found.scheme}){f'; {found.limit}' if found.limit else ''}"),
        ("Features", f"{found.count} of class {found.kind}, {found.length:.1f} m, weighted by {found.weighting}"),
    ]
    if found.left_out:
        rows.append(("Left out", f"{found.left_out}: the hole is inclined by more than 20°, or has no azimuth there"))
    figure = stress_rose(found)
    return pairs(rows) + _figure(figure, f"Rose of SHmax and {found.count} features by depth")


def _zones(zones: Classification | None, content: Content) -> str:
    if zones is None:
        return "<p>The shape was not measured, so there are no zones.</p>"
    found = zones.by_severity(content.top, content.bottom)
    criteria = f"Criteria: {in_html(criteria_text(content))}."
    if not found:
        return (
            f"<p>None. {criteria} {_left_out(zones) or 'No measured part of the hole meets one of these criteria.'}</p>"
        )
    unit, depths = content.drawing.size_unit, content.drawing.depth_unit.name
    ends = f"From [{depths}]", f"To [{depths}]"
    head = ("Kind and its probability, measure, severity, peak", *ends, f"Enlarge{SOFT}ment [{unit}]",
            f"Elonga{SOFT}tion [{unit}]",
            f"Tool{SOFT}face, s.d. [°]", f"Open{SOFT}ings [°]")  # fmt: skip
    rows = []
    for zone in found:
        openings = " and ".join(number(lobe.opening, 0) for lobe in zone.lobes if math.isfinite(lobe.opening))
        sizes = (in_unit(zone.enlargement, content, 2), in_unit(zone.elongation, content, 2))
        spread = f" ± {number(zone.deviation, 1)}" if math.isfinite(zone.deviation) else ""
        angles = (f"{number(zone.toolface, 0) or '–'}{spread}", openings or "–")
        ends = (in_depth_unit(zone.start, content), in_depth_unit(zone.stop, content))
        most = "narrowest" if zone.kind == "undergauge" else "widest"
        sure = zone.confidence_text + ("" if zone.sure else " (not sure)")
        peak = f"{most} at {in_depth_unit(zone.peak, content)} {depths}"
        measure = f"{MEASURES[zone.kind].replace(' - ', ' − ')} {in_unit(zone.measure, content, 2)} {unit}"
        rows.append([f"{zone.kind} {sure}, {measure}, {zone.severity:.1f} ×, {peak}", *ends, *sizes, *angles])
    note = " ".join(f"{name.capitalize()}: {text}." for name, text in SIZES.items()).replace(" - ", " − ")
    text = (
        f"<p>Worst first, by severity times confidence. {note} {_toolface(content)} {criteria} {_left_out(zones)}</p>"
    )
    return text + table(head, rows, signs=map(_sign, found))


def _left_out(zones: Classification) -> str:
    return f"{zones.left_out()}." if zones.fractures else ""


def _sign(zone: Zone) -> str:
    """Return the sign of a zone as HTML: its letter on its colour, or in a frame of its colour if it is not sure."""
    face, edge, ink = zone_look(zone.kind, zone.sure)
    return f'<b class="sign" style="background:{face};color:{ink};border-color:{edge}">{LETTERS[zone.kind]}</b> '


def _toolface(content: Content) -> str:
    """Return as HTML what the toolfaces of a table count from."""
    return f"Toolfaces: {in_html(toolface_text(content))}."


def _picks(content: Content) -> str:
    """Return the table of the picks in the interval, sorted by depth, as HTML."""
    picks = in_interval(content)
    if not picks:
        return "<p>None.</p>"
    rows = [table_row(pick, content) for pick in picks]
    shown = "" if (drawn := nets(content)) is None else _figure(drawn, "Stereonet and rose of the planes")
    return f"{shown}<p>{in_html(table_note(content))}</p>" + table(table_head(content), rows)


def _figure(figure: Figure, words: str, width: float = 150.0, caption: str = "") -> str:
    """Return a figure as HTML, ``width`` millimetres wide."""
    picture = base64.b64encode(rendered([figure], ".png")).decode()
    shown = f'<img style="width:{width:g}mm" alt="{in_html(words)}" src="data:image/png;base64,{picture}">'
    return f"<figure>{shown}{caption}</figure>"


def _quality(content: Content, messages: Sequence[tuple[str, str]]) -> str:
    wall = content.wall
    summary = content.summary()
    rows = [("Without support", f"{100 * summary.without_radius:.2f} % of the vertices: no sample in reach")]
    if math.isfinite(summary.nearest_half):
        half, most = (in_unit(away, content, 2) for away in (summary.nearest_half, summary.nearest_most))
        unit = content.drawing.size_unit
        rows.append(("Nearest sample", f"{half} {unit} away for half of the vertices, {most} {unit} for 99 %"))
    rows.append(("Measured", measured_text(content)))
    coverage = content.turns.coverage
    broken = int((coverage < 1).sum())
    known = f"{100 * float(coverage.mean()):.2f} % of the wall"
    rows.append(("With a radius", f"{known}, {broken:,} turns lack a radius somewhere"))
    for name, image in wall.images.items():
        share = 100 * image.missing / image.values.size
        rows.append((f"Image {name}", f"{image.depth.size:,} rows, {share:.1f} % of the values missing"))
    depths = content.drawing.depth_unit.name
    gaps = largest_gaps(content.turns, abs(wall.settings.pitch))
    if gaps:
        rows.append(
            (
                "Largest gaps",
                "; ".join(
                    f"{in_depth_unit(top, content)} to {in_depth_unit(bottom, content)} {depths}"
                    for top, bottom in gaps
                ),
            )
        )
    return pairs(rows) + ("<p>What was read, left out and corrected:</p>" + pairs(messages) if messages else "")


def largest_gaps(turns: Diameters, pitch: float) -> list[tuple[float, float]]:
    """Return the longest intervals whose turns all lack a radius somewhere: at most ten, the longest first, metres."""
    runs = sorted(runs_of(turns.coverage < 1), key=lambda run: run[0] - run[1])[:MOST_GAPS]
    return [(float(turns.depth[first]) - pitch / 2, float(turns.depth[stop - 1]) + pitch / 2) for first, stop in runs]


def _settings(content: Content, zones: Classification | None) -> str:
    settings = asdict(content.wall.settings)
    rows = {name.replace("_", " "): _setting_text(name, value) for name, value in settings.items()}
    if zones is not None:
        rows |= zones.facts()
    rows["toolface 0"] = TOOLFACE_0[content.reference] + ", assumed" * reference_assumed(content.wall)
    note = "<p>As settings state them: lengths in metres.</p>"
    return note + pairs([*rows.items(), *_made_from(content.wall.made_from)])


def _made_from(made_from: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield rows, label and text, for the files with their checksums and the other entries of ``made_from``."""
    for name, value in made_from.items():
        if name in ("preparation", "header", "project", "toolface", "survey", "echo"):  # shown elsewhere
            continue
        of_a_run = name == "files" and isinstance(value, list)
        if of_a_run and all(isinstance(one, dict) and one.keys() == {"name", "blake2b"} for one in value):
            yield from (("made from", f"{one['name']}, BLAKE2b {one['blake2b']}") for one in value)
        else:
            yield f"made from: {name}", str(value)


def _setting_text(name: str, value: Any) -> str:
    """Return the value of a setting of the wall as text with its unit; None becomes words."""
    if value is None or isinstance(value, bool):
        return NO_SETTING.get(name, "none") if value is None else "yes" if value else "no"
    if isinstance(value, str):
        return value
    numbers = value if isinstance(value, tuple | list) else [value]
    return f"{', '.join(f'{of:.10g}' for of in numbers)} {SETTING_UNITS.get(name, '')}".strip()

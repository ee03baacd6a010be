"""Make the lines, each a label and a sentence, that the commands print about a wall, its logs, zones and images."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable
from typing import TYPE_CHECKING

from helibore.base.units import BARREL, INCH, size_text
from helibore.cli.quantities import facts_in

if TYPE_CHECKING:
    from helibore.images.image_breakouts import ImageBreakouts
    from helibore.live.live import Live
    from helibore.logs.annulus import Annulus
    from helibore.logs.intervals import IntervalTable
    from helibore.logs.summary import Extreme, WallSummary
    from helibore.logs.turn_logs import Logs
    from helibore.logs.zones import Classification

Lines = list[tuple[str, str]]


def summary_lines(found: WallSummary, cells: str = "") -> Lines:
    """Return the lines on a wall or a part of it; ``cells`` is a text on the number of cells of the written mesh."""
    from helibore.logs.turn_logs import RANGED

    helix = f"{found.sectors} sectors, pitch {found.pitch:g} m: {found.vertices:,} vertices"
    samples = f", from {found.samples:,} samples" if found.samples else ""
    lines = [("wall", f"{found.start:.2f} to {found.stop:.2f} m, {helix}{cells}{samples}")]
    if found.basis != "azimuthal":
        lines.append(("", found.basis_text))
    lines.append(("bit", size_text(found.bit_diameter)))
    if found.basis == "gauge":  # a gauge hole has no measured diameters
        return lines
    if math.isnan(found.mean_diameter):
        lines.append(("diameter", "missing: no turn has all its radii"))
    else:
        lines += [
            ("diameter", f"mean      {_mean(found)}, by volume"),
            ("", f"least     {_extreme(found.least_diameter, found)}"),
            ("", f"greatest  {_extreme(found.greatest_diameter, found)}"),
            *(_shape_lines(found) if found.basis == "azimuthal" else []),
            ("volume", f"{found.volume_text() if found.ranged else _volume(found.volume)} over "
             f"{found.whole_turns:,.1f} m of whole turns, {found.excess_text()} against the bit"),
            *([("", RANGED)] if found.ranged else []),
        ]  # fmt: skip
    if found.incomplete_turns:
        lines.append(("", f"{found.incomplete_turns:,.1f} m of turns miss at least one radius and are not counted"))
    lines.append(("support", f"{100 * found.without_radius:.2f} % of the vertices have no sample in reach"))
    if not math.isnan(found.nearest_half):
        half, most = found.nearest_half * 1e3, found.nearest_most * 1e3
        lines.append(("", f"nearest sample: at most {half:.0f} mm for half of the vertices, {most:.0f} mm for 99 %"))
    return [*lines, *trust_lines(found.warnings)]


def trust_lines(warnings: Iterable[str]) -> Lines:
    """Return the warnings of a summary or of logs as lines, as that a tool with few arms measured the wall."""
    return [("warning", text) for text in warnings]


def counts_line(live: Live) -> str:
    """Return a text on how many samples of a live wall were drawn, and on the number of vertices of its layer ``main``.

    Each sample whose depth is known, or will never be known, is in one of three counts: drawn in a layer; refused by a
    flag; in no layer, because no layer takes its pass, the sample lies before the wall, or it has enough samples
    around it.
    """
    counts, waiting = live.model.counts, live.model.waiting
    text = f"{counts['drawn']:,} samples drawn, {counts['not drawn']:,} refused, {counts['kept apart']:,} in no layer"
    text += f", {waiting:,} samples and image rows wait for their depth" if waiting else ""
    return f"{text}; {len(live.wall):,} vertices"


def _shape_lines(found: WallSummary) -> Lines:
    mean, greatest = found.ovality
    rough = [f"{name} {size * 1e3:.2f} mm" for name, size in zip(("mean", "greatest"), found.rugosity, strict=True)]
    window = f"{found.rugosity_window:g} m, an odd number of turns ({found.rugosity_window / abs(found.pitch):.0f})"
    return [
        ("", f"inscribed {_extreme(found.inscribed_diameter, found)}: the largest circle that passes"),
        ("shape", f"ovality, API: mean {mean:.4f}, greatest {greatest:.4f} (DNV and ISO: twice that)"),
        ("", f"rugosity over {window}: " + (
            "missing" if math.isnan(found.rugosity[0]) else ", ".join(rough))),
    ]  # fmt: skip


def _size(size: float, found: WallSummary) -> str:
    over = (size - found.bit_diameter) / INCH
    return f"{size / INCH:7.3f} in ({size * 1e3:6.1f} mm), {over:+.3f} in against the bit"


def _mean(found: WallSummary) -> str:
    return found.mean_text() if found.ranged else _size(found.mean_diameter, found)


def _extreme(extreme: Extreme, found: WallSummary) -> str:
    return f"{_size(extreme.value, found)}, at {extreme.depth:.2f} m"


def _volume(cubic_metres: float) -> str:
    return f"{cubic_metres:,.3f} m³ ({cubic_metres / BARREL:,.2f} bbl)"


def row_line(rows: Logs) -> tuple[str, str]:
    """Return a line on the rows of logs: depths, number of rows, and whether a row is a turn or a step of depth."""
    each = "one a turn" if rows.step is None else f"one each {rows.step:g} m"
    return "logs", f"{rows.depth.min():.2f} to {rows.depth.max():.2f} m, {len(rows):,} rows, {each}"


def sigma_lines(rows: Logs) -> Lines:
    """Return a line on how many rows have no uncertainty; no line if the logs were made without uncertainty."""
    if not rows.with_sigma:
        return []
    import numpy as np

    missing = int(np.isnan(rows.diameter_sigma).sum())
    why = "there, a tenth of the vertices lies in a gap, or farther from samples than the uncertainty was tested"
    if rows.basis != "azimuthal":
        why = rows.basis_text
    elif rows.shape == "arms":
        why = "the hole between the arms is not sampled"
    return [("missing", f"{missing:,} of {len(rows):,} rows have no sigma" + (f": {why}" if missing else ""))]


MOST_INTERVALS = 12
"""Most intervals that the terminal lists."""


def interval_lines(found: IntervalTable) -> Lines:
    """Return a line on each interval of a wall: depths, mean diameter, volume, measured share, metres by kind."""
    lines: Lines = []
    for row in found.intervals[:MOST_INTERVALS]:
        one, summary = row.interval, row.summary
        bottom = f"to {one.stop:.2f} m" if math.isfinite(one.stop) else "m to the bottom"
        text = f"{one.name}, {one.start:.2f} {bottom}: "
        if summary is None:
            lines.append(("", f"{text}not logged"))
            continue
        size = "no whole turn"
        if summary.whole_turns:
            sigma = f" ± {row.volume_sigma:.3f}" if math.isfinite(row.volume_sigma) else ""
            size = f"mean {size_text(summary.mean_diameter)}, {summary.volume:,.3f}{sigma} m³"
            size += f" ({100 * summary.excess:+.1f} %)"
        kinds = "".join(f", {metres:,.1f} m {kind}" for kind, metres in summary.kinds.items())
        share = f", {100 * summary.coverage:.0f} % measured" if math.isfinite(summary.coverage) else ""
        lines.append(("", f"{text}{size}{share}{kinds}"))
    if len(found.intervals) > MOST_INTERVALS:
        lines.append(("", f"and {len(found.intervals) - MOST_INTERVALS} more"))
    return [("intervals", lines[0][1]), *lines[1:]] if lines else []


def annulus_lines(annuli: Iterable[Annulus]) -> Lines:
    """Return lines on the volume of the annulus around each casing, and on the least clearance of the casing."""
    import numpy as np

    lines: Lines = []
    for each in annuli:
        text = f"{size_text(each.casing)}: annulus {_volume(each.total)}"
        missing = f", without {each.unmeasured:,.1f} m where a radius is missing" if each.unmeasured else ""
        lines.append(("casing", text + missing))
        if each.narrower:
            row = int(np.nanargmin(each.hole))
            narrowest = f"narrowest at {each.depth[row]:.2f} m, {size_text(each.hole[row])}"
            lines.append(("", f"the casing does not pass {each.narrower:,.1f} m, which have no annulus; {narrowest}"))
        if np.isfinite(each.clearance).any():
            row = int(np.nanargmin(each.clearance))
            least = float(each.clearance[row])
            passes = "" if least >= 0 else ": a straight gauge does not pass there"
            size = f"{least / INCH:+.3f} in ({least * 1e3:+.1f} mm)"
            lines.append(("", f"least clearance {size} at {each.depth[row]:.2f} m{passes}"))
    return lines


def zone_lines(zones: Classification, found: WallSummary, unit: str) -> Lines:
    """Return lines on the zones that lie, at least in part, in the interval of a summary, and on their criteria.

    ``unit`` is the value of ``--unit``: the unit in which the criteria are shown.
    """
    from helibore.base.angles import azimuth_text

    inside = [zone for zone in zones.zones if zone.stop > found.start and zone.start < found.stop]
    unsure = Counter(zone.kind for zone in inside if not zone.sure)
    kinds = [
        f"{count} {kind}, {found.kinds.get(kind, 0.0):,.1f} m" + (f" ({unsure[kind]} not sure)" if unsure[kind] else "")
        for kind, count in Counter(zone.kind for zone in inside).items()
    ]
    lines: Lines = [("zones", "; ".join(kinds) or "none by the criteria")]
    axis = found.breakout_axis
    if math.isfinite(axis.mean):
        text = f"breakouts along {axis.mean:.0f} and {axis.mean + 180:.0f} deg, {axis.spread('zone', ' deg', 1)}"
        lines.append(("", f"{text}, of the whole wall"))
    azimuth = found.breakout_azimuth
    if math.isfinite(azimuth.mean):
        both = " and ".join(map(azimuth_text, (azimuth.mean, azimuth.mean + 180)))
        lines.append(("", f"azimuth of breakouts {both} deg from north"))
    criteria = facts_in(zones.criteria.facts(), unit).items()
    if zones.fractures:
        lines.append(("", zones.left_out()))
    return [*lines, ("", "; ".join(f"{name.removeprefix('criterion ')} {text}" for name, text in criteria))]


def breakout_line(found: ImageBreakouts) -> tuple[str, str]:
    """Return a line of text about the breakouts that an image shows."""
    name, axis = found.image.name, found.axis()
    if not found.zones:
        return "image", f"{name}: no dark sectors on opposite sides by the criteria"
    count = f"{len(found.zones)} breakout{'s' * (len(found.zones) != 1)}"
    length, ends = sum(zone.length for zone in found.zones), f"{axis.mean:.0f} and {axis.mean + 180:.0f} deg"
    spread = "" if axis.count == 1 else f", {axis.spread('breakout', ' deg', 1)}"
    return "image", f"{name}: {count}, {length:,.2f} m, along {ends} from {found.image.reference}{spread}"

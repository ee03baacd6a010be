"""What `helibore logs` prints: the figures of the logs that a driller asks for first, as labels and sentences."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from helibore.base.units import INCH, size_text
from helibore.samples.caliper import BASIS_TEXT

if TYPE_CHECKING:
    from helibore.base.arrays import Floats
    from helibore.images.image_breakouts import ImageBreakouts
    from helibore.logs.annulus import Annulus
    from helibore.logs.turn_logs import Logs
    from helibore.logs.zones import Classification

BARREL = 0.158987294928
"""Cubic metres in an oilfield barrel, 42 US gallons."""

Lines = list[tuple[str, str]]


def lines(rows: Logs, turns: Logs, annuli: Iterable[Annulus]) -> Lines:
    """Return the summary of logs: sizes are those of the turns, whatever the rows of the file are."""
    row = "one a turn" if rows.step is None else f"one each {rows.step:g} m"
    found: Lines = [("logs", f"{rows.depth.min():.2f} to {rows.depth.max():.2f} m, {len(rows):,} rows, {row}")]
    if turns.basis != "azimuthal":
        found.append(("", BASIS_TEXT[turns.basis]))
    found += _sizes(turns)
    for one in annuli:
        found += _annulus(one)
    return found


def _sizes(logs: Logs) -> Lines:
    there = np.isfinite(logs.equivalent_diameter)
    bit = logs.bit_diameter
    found: Lines = [("bit", size_text(bit))]
    if not there.any():
        return [*found, ("diameter", "missing: no row is whole")]
    area = logs.equivalent_diameter[there]
    mean = math.sqrt(float(np.mean(area**2)))
    found.append(("diameter", f"by area {size_text(mean)}, {(mean - bit) / INCH:+.3f} in against the bit"))
    found.append(("", f"largest across {_at(logs.c1, logs.depth, np.nanargmax)}"))
    found.append(
        ("", f"smallest inscribed circle, what passes: {_at(logs.inscribed_diameter, logs.depth, np.nanargmin)}")
    )
    ovality = logs.ovality_api[there]
    found.append(
        ("shape", f"ovality, API: mean {ovality.mean():.4f}, most {ovality.max():.4f} (DNV and ISO: twice that)")
    )
    rough = logs.rugosity[np.isfinite(logs.rugosity)]
    text = f"mean {rough.mean() * 1e3:.2f} mm, most {rough.max() * 1e3:.2f} mm" if rough.size else "missing"
    found.append(("", f"rugosity over {logs.rugosity_window:g} m: {text}"))
    volume = float(logs.volume[there].sum())
    length = float(there.sum()) * logs.height
    excess = volume / (math.pi / 4 * bit**2 * length) - 1
    found.append(("volume", f"{_volume(volume)} over {length:,.1f} m measured, {100 * excess:+.1f} % against the bit"))
    if not there.all():
        found.append(("", f"{float((~there).sum()) * logs.height:,.1f} m are not measured all around, and not counted"))
    return found


def _at(values: Floats, depth: Floats, where: Any) -> str:
    row = int(where(values))
    return f"{size_text(float(values[row]))} at {depth[row]:.2f} m"


def _volume(cubic_metres: float) -> str:
    return f"{cubic_metres:,.3f} m³ ({cubic_metres / BARREL:,.2f} bbl)"


def _annulus(one: Annulus) -> Lines:
    text = f"{size_text(one.outer_diameter)}: annulus {_volume(one.total)}"
    if one.unmeasured:
        text += f", without {one.unmeasured:,.1f} m that are not measured"
    found: Lines = [("casing", text)]
    if np.isfinite(one.clearance).any():
        row = int(np.nanargmin(one.clearance))
        least = float(one.clearance[row])
        passes = "" if least >= 0 else ": does not pass a straight gauge there"
        found.append(
            ("", f"least clearance {least / INCH:+.3f} in ({least * 1e3:+.1f} mm) at {one.depth[row]:.2f} m{passes}")
        )
    return found


def zone_lines(zones: Classification, top: float | None, bottom: float | None) -> Lines:
    """Return the zones that reach into [top, bottom], and the criteria they were found with."""
    inside = [
        zone
        for zone in zones.zones
        if zone.stop > (-math.inf if top is None else top) and zone.start < (math.inf if bottom is None else bottom)
    ]
    lengths: dict[str, list[float]] = {}
    for zone in inside:
        lengths.setdefault(zone.kind, []).append(zone.length)
    kinds = [f"{len(each)} {kind}, {sum(each):,.1f} m" for kind, each in lengths.items()]
    found: Lines = [("zones", "; ".join(kinds) or "none by the criteria")]
    axis = zones.breakout_axis()
    if math.isfinite(axis.mean):
        text = f"breakouts along {axis.mean:.0f} and {axis.mean + 180:.0f} deg"
        found.append(("", f"{text}, s.d. {axis.deviation:.1f} deg, of the whole wall"))
    found.append(
        ("", "; ".join(f"{name.removeprefix('criterion ')} {text}" for name, text in zones.criteria.facts().items()))
    )
    return found


def breakout_lines(found: ImageBreakouts) -> Lines:
    """Return what an image shows."""
    name, axis = found.image.name, found.axis()
    if not found.zones:
        return [("image", f"{name}: no dark sectors on opposite sides by the criteria")]
    length = sum(zone.length for zone in found.zones)
    count = f"{len(found.zones)} breakout{'s' * (len(found.zones) != 1)}"
    text = f"{name}: {count}, {length:,.2f} m, along {axis.mean:.0f} and {axis.mean + 180:.0f} deg"
    return [("image", f"{text}, s.d. {axis.deviation:.1f} deg from {found.image.reference}")]

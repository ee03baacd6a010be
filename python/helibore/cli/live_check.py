"""Make the text of ``helibore live --check``: each quantity of each source, its items, and how their numbers are read.

    rig: tcp://127.0.0.1:9872
      bit_depth         0108                ft   the start of the wall comes as 6561.68; no unit stated: taken as ft
      caliper radius    5012 ... 5099 (30)  in   a hole of bit size comes as 4.25; no unit stated: taken as in

WITS transmits no unit. Before data arrive, a user can check a unit only by comparing these numbers with the numbers
that the rig shows.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from helibore.live.rules.configuration import Configuration
from helibore.live.rules.source_tables import LENGTHS
from helibore.live.rules.sources import Item, Source

Row = tuple[str, str, str, str]
_RIG = {"rotation": "rpm", "activity": ""}


def described(settings: Configuration) -> list[str]:
    """Return the lines of ``--check``: each source with its address, then one line for each of its quantities."""
    found = []
    for name, source in settings.sources.items():
        found.append(f"{name}: {settings.source[name]['address']}")
        rows = list(_rows(settings, source))
        widths = [max((len(row[column]) for row in rows), default=0) for column in range(3)]
        found += [
            ("  " + "  ".join(f"{text:{width}}" for text, width in zip(row, [*widths, 0], strict=True))).rstrip()
            for row in rows
        ]
    return found


def _rows(settings: Configuration, source: Source) -> Iterator[Row]:
    """Yield a row for each quantity of a source: its name, its items, their unit, and a remark."""
    entries, wall, caliper = settings.source[source.name], settings.wall, source.caliper
    depth_unit, size_unit = LENGTHS.get(source.units, ("", ""))
    start = f"the start of the wall, {wall['start_depth']:g} m,", wall["start_depth"]
    bit = "a hole of bit size", wall["bit_diameter"] / 2

    def row(
        name: str, items: Sequence[Item], unit: str | None, usual: str = "", known: tuple[str, float] | None = None
    ) -> Row:
        if source.units == "sent":
            curves = [one.name or "the index" for one in items]
            return name, _span(list(dict.fromkeys(curves))), "", "in the unit that the store sends"
        remarks = [f"{known[0]} comes as {known[1] / items[0].scale:.6g}"] if known else []
        remarks += [f"no unit stated: taken as {usual}"] if usual and not unit else []
        return name, _span([one.name for one in items]), unit or usual, "; ".join(remarks)

    for name, item in source.rig.items():
        depths = name in ("bit_depth", "hole_depth")
        yield row(name, [item], *((_unit(entries["items"][name]), depth_unit, start) if depths else (_RIG[name],)))
    if number := source.pass_number:
        yield row("pass_number", [number], "")
    for name, one in source.shown.items():
        yield row(f"show {name}", [one.item], one.table.unit)
    if caliper:
        units = entries["caliper"]
        yield row("caliper toolface", caliper.toolface, units.get("toolface_unit"), "deg")
        if caliper.depth:
            yield row("caliper depth", caliper.depth, units.get("depth_unit"), depth_unit, start)
        else:
            yield "caliper depth", "", "", f"bit depth - {caliper.offset:g} m"
        yield row(f"caliper {caliper.measures}", caliper.radius, units.get("radius_unit"), size_unit, bit)
    if source.station:
        depth, inclination, azimuth = source.station
        yield row("survey depth", [depth], _unit(entries["survey"].get("depth")), depth_unit, start)
        yield row("survey inclination", [inclination], "deg")
        yield row("survey azimuth", [azimuth], "deg")
    for image in source.images:
        yield row(f"image {image.name}", image.sectors, image.unit)
        if image.depth:
            unit = _unit(entries["image"][image.name].get("depth"))
            yield row(f"image {image.name} depth", [image.depth], unit, depth_unit, start)


def _unit(entry: object) -> str | None:
    """Return the unit that an item's entry in the configuration states; None if it states none."""
    return entry.get("unit") if isinstance(entry, dict) else None


def _span(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"{names[0]} ... {names[-1]} ({len(names)})"

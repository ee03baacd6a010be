"""One TOML file says what is connected, what its items mean, and what wall grows from it; a wrong one never starts.

    [wall]
    bit_diameter = 0.216            # metres, as everything in [wall], [layers] and [passes]
    start_depth = 2500.0

    [source.mwd]
    address = "tcp://127.0.0.1:9872"
    units = "metric"                # must be set: nothing on the wire says which
    items = { bit_depth = "0108", hole_depth = "0110", rotation = "0120" }
    caliper = { first = "5010", groups = 30, order = ["toolface", "depth", "radius"] }

``README.md`` beside this file lists every setting. Here texts become numbers and item codes, in core units; opening
sockets is not here.
"""

from __future__ import annotations

import json
import os
import re
import tomllib
from dataclasses import asdict, dataclass, field
from pathlib import Path as FilePath
from typing import Any

from helibore.base import units
from helibore.images.sector_image import Reference
from helibore.live import wits
from helibore.live.address import Address, check_allowed, read_address
from helibore.live.file_names import RULE, can_be_file
from helibore.live.layout import REFERENCES, Layout, read_layout
from helibore.live.pass_rules import PassNumbers, PassRules, read_layers, read_pass_numbers, read_passes
from helibore.live.store_settings import Store, read_store
from helibore.live.tables import Table
from helibore.wall.wall import Wall

RIG_ITEMS = ("bit_depth", "hole_depth", "rotation", "activity")
LENGTHS = {"metric": ("m", "mm"), "fps": ("ft", "in")}
"""Units of depths and of radii, for each unit set (LIVE items 0108 and 0844)."""


@dataclass(frozen=True)
class Item:
    """One mapped item: core value = value x scale."""

    code: int
    scale: float = 1.0


@dataclass(frozen=True)
class CaliperItems:
    """Triples of items, one triple a row of ``toolface``, ``radius`` and ``depth`` (empty: depth from the bit)."""

    toolface: tuple[Item, ...]
    radius: tuple[Item, ...]
    depth: tuple[Item, ...]
    offset: float
    latency: float
    toolface_offset: float
    radius_range: tuple[float, float]


@dataclass(frozen=True)
class ImageItems:
    """The sector items of one image row."""

    name: str
    unit: str
    sectors: tuple[Item, ...]
    depth: Item | None
    offset: float
    latency: float
    layout: Layout


@dataclass(frozen=True)
class Source:
    """One connection: how it is reached, and what its items mean."""

    name: str
    address: Address
    allow: tuple[str, ...]
    mode: str
    every: float
    units: str
    nulls: tuple[float, ...]
    limits: tuple[int, int, int]
    silence: float
    items: dict[str, Item]
    caliper: CaliperItems | None
    images: tuple[ImageItems, ...]
    survey: tuple[Item, Item, Item] | None
    pass_number: Item | None = None
    pass_numbers: PassNumbers = field(default_factory=PassNumbers)
    store: Store | None = None

    def records(self) -> list[int]:
        """Return the record numbers of all mapped items, whose sequence numbers (item 04) are watched."""
        if self.store:
            return []
        mapped = [*self.items.values(), *(self.survey or ()), *([self.pass_number] if self.pass_number else [])]
        if self.caliper:
            mapped += [*self.caliper.toolface, *self.caliper.radius, *self.caliper.depth]
        for image in self.images:
            mapped += [*image.sectors, *([image.depth] if image.depth else [])]
        return sorted({item.code // 100 for item in mapped})


@dataclass(frozen=True)
class Configuration:
    """Everything a live wall needs to know before the first byte."""

    wall: dict[str, Any]
    layers: dict[str, tuple[str, ...]]
    passes: PassRules
    path: dict[str, Any]
    sources: dict[str, Source]
    journal: str | None = None
    sync_interval: float = 0.1
    segment_bytes: int = 64 << 20
    snapshot: dict[str, Any] = field(default_factory=dict)
    text: str = ""

    def meaning(self) -> str:
        """Return, as JSON, what decides the wall: two configurations that differ only in transport mean the same."""
        sources = {name: asdict(source) for name, source in self.sources.items()}
        for name, source in sources.items():
            for transport in ("address", "allow", "mode", "every", "silence", "store"):
                del source[transport]
            if source["pass_number"] is None:  # as it was before there were any
                del source["pass_number"], source["pass_numbers"]
            if store := self.sources[name].store:
                source["store"] = store.meaning()
        return json.dumps(
            {"wall": self.wall, "layers": self.layers, "passes": asdict(self.passes), "path": self.path,
             "sources": sources}, sort_keys=True,
        )  # fmt: skip


def load(file: str | os.PathLike[str]) -> Configuration:
    """Read and check a configuration file.

    Raises
    ------
    ValueError
        ``FILE: PLACE = VALUE: RULE`` for the first setting that breaks a rule, or that the file is not TOML.
    """
    try:
        return parse(FilePath(file).read_text(encoding="utf-8"))
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from None


def parse(text: str) -> Configuration:
    """Check the text of a configuration; see :func:`load`."""
    try:
        top = Table("", tomllib.loads(text))
    except tomllib.TOMLDecodeError as error:
        raise ValueError(f"is not TOML: {error}") from None
    wall = _wall(top.table("wall"))
    path = _path(top.table("path"))
    sources = {}
    for name, table in top.tables("source").items():
        polled = table.starts("address", "https:")
        sources[name] = (read_store if polled else _source)(name, table, wall["bit_diameter"], path["reference"])
    _one_source_each(sources)
    journal = top.table("journal")
    snapshot = top.table("snapshot")
    configuration = Configuration(
        wall=wall,
        layers=read_layers(top.table("layers"), numbered=any(source.pass_number for source in sources.values())),
        passes=read_passes(top.table("passes")),
        path=path,
        sources=sources,
        journal=journal.text("folder", None) if journal.has("folder") else None,
        sync_interval=journal.number("sync_ms", 100.0, least=0, most=60_000) / 1000.0,
        segment_bytes=journal.whole("segment_mb", 64, least=1, most=1024) << 20,
        snapshot={
            "folder": snapshot.text("folder", ""),
            "every": snapshot.number("every", 60.0, least=1),
            "logs": snapshot.choice("logs", ("las", "csv", "none"), "las"),
        },
        text=text,
    )
    for table in (journal, snapshot, top):
        table.close()
    return configuration


def _wall(table: Table) -> dict[str, Any]:
    wall: dict[str, Any] = {
        "bit_diameter": table.number("bit_diameter", least=1e-3, most=10, why="metres"),
        "start_depth": table.number("start_depth", why="metres, the depth of the first vertex"),
    }
    wall.update(table.rest())  # their rules are the wall's own
    try:
        Wall(**wall)
    except (ValueError, TypeError) as error:
        text = str(error)
        unknown = re.search(r"unexpected keyword argument '(\w+)'", text)
        raise ValueError(f"wall.{unknown[1]}: is not a setting" if unknown else f"wall.{text}") from None
    return wall


def _path(table: Table) -> dict[str, Any]:
    head = table.array("head", float, [0.0, 0.0, 0.0])
    if len(head) != 3:
        raise table.fail("head", head, "must be three numbers: north, east, down in metres")
    path = {
        "method": table.choice("method", ("minimum-curvature", "radius-of-curvature"), "minimum-curvature"),
        "reference": table.choice("reference", REFERENCES, "high-side"),
        "head": head,
        "extend": table.number("extend", 100.0, least=0),
    }
    stations = table.take("stations", [], "")
    for index, row in enumerate(stations if isinstance(stations, list) else [stations]):
        if not isinstance(row, list) or len(row) != 3 or not all(isinstance(v, int | float) for v in row):
            raise table.fail(f"stations[{index}]", row, "must be [depth m, inclination deg, azimuth deg]")
    path["stations"] = [[float(v) for v in row] for row in stations]
    table.close()
    return path


def _source(name: str, table: Table, bit_diameter: float, reference: Reference) -> Source:
    address = read_address(table)
    chosen = table.choice("units", tuple(LENGTHS), why=" (nothing on the wire says which)")
    depth_unit, radius_unit = LENGTHS[chosen]
    given = table.has("allow")
    allow = tuple(table.array("allow", str, ["127.0.0.1", "::1"]))
    mode = table.choice("mode", ("listen", "heartbeat", "poll"), "listen")
    check_allowed(table, address, allow, given)
    items = table.table("items")
    rig: dict[str, Item] = {}
    for key in RIG_ITEMS:
        if items.has(key):
            rig[key] = _item(items, key, depth_unit if key.endswith("depth") else None)
    pass_number = _item(items, "pass_number", None) if items.has("pass_number") else None
    items.close()
    source = Source(
        name=name,
        address=address,
        allow=allow,
        mode=mode,
        every=table.number("every", 20.0 if mode == "heartbeat" else 1.0, least=0.05, most=3600),
        units=chosen,
        nulls=tuple(table.array("nulls", float, list(wits.NULLS))),
        limits=(
            table.whole("line_limit", 1024, least=16, most=1 << 24),
            table.whole("frame_limit", 65536, least=16, most=1 << 26),
            table.whole("item_limit", 512, least=1, most=1 << 20),
        ),
        silence=table.number("silence", 120.0, least=0.1),
        items=rig,
        caliper=_caliper(table.table("caliper"), depth_unit, radius_unit, bit_diameter)
        if table.has("caliper")
        else None,
        images=tuple(_image(key, inner, depth_unit, reference) for key, inner in table.tables("image").items()),
        survey=_survey(table.table("survey"), depth_unit) if table.has("survey") else None,
        pass_number=pass_number,
        pass_numbers=read_pass_numbers(table.table("pass_numbers")),
    )
    table.close()
    return source


def _item(table: Table, name: str, unit: str | None, default: str | None = None) -> Item:
    """An item is "0108", or { item = "0108", unit = "ft" } where it is a length with a unit of its own."""
    value = table.take(name, default, "")
    if isinstance(value, dict) and unit is not None:
        inner = Table(f"{table.place}.{name}", value)
        value, unit = inner.text("item"), inner.text("unit", unit)
        inner.close()
    try:
        if not isinstance(value, str):
            raise ValueError("must be four digits RRII, 01 to 99 each")
        return Item(wits.code(value), units.factor(unit, units.LENGTH) if unit else 1.0)
    except ValueError as error:
        raise ValueError(f"{table.place}.{name} = {value!r}: {str(error).rpartition(': ')[2]}") from None


def _run(table: Table, name: str, members: int = 1, fewest: int = 1) -> list[int]:
    """Codes of consecutive items from ``first``: ``members`` times the number that ``name`` gives."""
    first = _item(table, "first", None).code
    given = table.whole(name, least=fewest, most=99)
    count = given * members
    if first % 100 + count - 1 > 99:
        raise table.fail(name, given, f"items {first:04d} and {count - 1} more must not pass item 99")
    return list(range(first, first + count))


def _caliper(table: Table, depth_unit: str, radius_unit: str, bit_diameter: float) -> CaliperItems:
    measure = table.choice("measures", ("radius", "diameter"), "radius")
    columns: dict[str, list[int]] = {}
    if table.has("first"):
        order = table.array("order", str, ["toolface", "depth", "radius"])
        if sorted(order) not in (["depth", "radius", "toolface"], ["radius", "toolface"]):
            raise table.fail("order", order, 'must name "toolface" and "radius" once each, and "depth" at most once')
        codes = _run(table, "groups", len(order))
        columns = {name: codes[place :: len(order)] for place, name in enumerate(order)}
    else:
        for name in ("toolface", "radius", "depth"):
            if name != "depth" or table.has(name):
                texts = table.array(name, str, why="a list of items, one for each triple")
                columns[name] = [_code_at(table, name, index, text) for index, text in enumerate(texts)]
    lengths = {name: len(codes) for name, codes in columns.items()}
    if len(set(lengths.values())) != 1 or not lengths["toolface"]:
        raise ValueError(f"{table.place}: toolface, radius and depth must have equally many items, not {lengths}")
    low, high = bit_diameter / 8, bit_diameter * 2
    limits = table.array("radius_range", float, [low, high])
    if len(limits) != 2 or not 0 < limits[0] < limits[1]:
        raise table.fail("radius_range", limits, "must be [least, most] in metres, 0 < least < most")
    depth = units.factor(table.text("depth_unit", depth_unit), units.LENGTH)
    radius = units.factor(table.text("radius_unit", radius_unit), units.LENGTH)
    radius *= 0.5 if measure == "diameter" else 1.0
    caliper = CaliperItems(
        toolface=tuple(Item(code) for code in columns["toolface"]),
        radius=tuple(Item(code, radius) for code in columns["radius"]),
        depth=tuple(Item(code, depth) for code in columns.get("depth", [])),
        offset=table.number("offset", 0.0, why="metres from the bit up to the sensor"),
        latency=table.number("latency", 0.0, least=0, most=3600),
        toolface_offset=table.number("toolface_offset", 0.0, least=-360, most=360),
        radius_range=(limits[0], limits[1]),
    )
    table.close()
    return caliper


def _code_at(table: Table, name: str, index: int, text: str) -> int:
    try:
        return wits.code(text)
    except ValueError:
        raise table.fail(f"{name}[{index}]", text, "must be four digits RRII, 01 to 99 each") from None


def _image(name: str, table: Table, depth_unit: str, reference: Reference) -> ImageItems:
    if not can_be_file(name):
        raise ValueError(f"{table.place[: -len(name)]}{name[:60]!r}: its name {RULE}")
    unit = table.text("unit", why="the unit of its values, for display")
    scale_depth = _item(table, "depth", depth_unit) if table.has("depth") else None
    offset = table.number("offset", 0.0)
    latency = table.number("latency", 0.0, least=0, most=3600)
    sectors = tuple(Item(code) for code in _run(table, "count", fewest=2))
    image = ImageItems(name, unit, sectors, scale_depth, offset, latency, read_layout(table, reference))
    table.close()
    return image


def _survey(table: Table, depth_unit: str) -> tuple[Item, Item, Item]:
    survey = (
        _item(table, "depth", depth_unit, "0708"),
        _item(table, "inclination", None, "0713"),
        _item(table, "azimuth", None, "0715"),
    )
    table.close()
    return survey


def _one_source_each(sources: dict[str, Source]) -> None:
    """Each rig quantity and each image comes from one source: two would argue. A pass number is its source's own."""
    if not sources:
        raise ValueError("source: must be set: at least one table [source.NAME]")
    seen: dict[str, str] = {}
    for name, source in sources.items():
        for key in [*(f"items.{k}" for k in source.items), *(f"image.{image.name}" for image in source.images)]:
            if key in seen:
                raise ValueError(f"source.{name}.{key}: is mapped by source.{seen[key]} too; one source only")
            seen[key] = name
        if source.pass_number and not source.caliper:
            raise ValueError(f"source.{name}.items.pass_number: numbers the caliper's samples, and there is no caliper")
        if source.pass_numbers.listed and not source.pass_number:
            raise ValueError(f"source.{name}.pass_numbers: items.pass_number must be set: what says the number")
    if "items.bit_depth" not in seen:
        for name, source in sources.items():
            if source.caliper and not source.caliper.depth:
                raise ValueError(f"source.{name}.caliper: has no depth items, and no source maps bit_depth")
            for image in source.images:
                if image.depth is None:
                    raise ValueError(f"source.{name}.image.{image.name}: has no depth item, no source maps bit_depth")

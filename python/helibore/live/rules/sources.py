"""What the tables of sources mean: each item becomes an `Item`, its name in the messages and a scale to core units.

    table (source_tables.py)                   source
    items.bit_depth = "0108", units = "fps"    rig["bit_depth"] = Item("0108", 0.3048)
    caliper.first = "5010", groups = 2         caliper.toolface = [Item("5010"), Item("5013")], depth ..., radius ...

The values of a store's curve are converted when they come, by the unit that the store sends.
"""

from __future__ import annotations

import ipaddress
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any, Self

from helibore.base import units
from helibore.base.cached import cached_property
from helibore.base.errors import InputError
from helibore.live.rules.layout import Layout, LayoutTable
from helibore.live.rules.pass_rules import PassNumbers
from helibore.live.rules.recorded_values import with_values
from helibore.live.rules.source_tables import (
    LENGTHS,
    RIG,
    CaliperTable,
    LengthItem,
    NamedTable,
    ShowTable,
    SourceTable,
    StoreTable,
    WitsCaliper,
    WitsTable,
)
from helibore.live.wire import wits
from helibore.live.wire.address import Address

JUMPS = {"depth": 30.0, "time": 3600.0}
"""The default of ``jump``: metres for a log by depth, seconds for a log by time."""
LOOPBACK = "127.0.0.1", "::1"
"""Who may connect to a listener if nothing is stated."""
INDEX = ""
"""The name of a store's index curve, whose mnemonic does not matter."""
KINDS = {"bit_depth": units.LENGTH, "hole_depth": units.LENGTH, "rotation": units.ROTATION,
         "toolface": units.ANGLE, "radius": units.LENGTH, "depth": units.LENGTH}  # fmt: skip
"""What the values of named items measure, whose unit the source sends."""


@dataclass(frozen=True)
class Item:
    """One mapped item.

    Attributes
    ----------
    name
        Its name in the messages of its source: four digits RRII, a mnemonic, a key; `INDEX`.
    scale
        The factor from its values to core units.
    kind, unit
        Of an item whose unit the source sends: what the unit measures ("": anything), and the unit that it must be
        ("": any).
    """

    name: str
    scale: float = 1.0
    kind: str = ""
    unit: str = ""


@dataclass(frozen=True)
class OtherTables:
    """What sources must know of the other tables: the bit diameter in metres, and the reference of the path."""

    bit_diameter: float
    reference: str


@dataclass(frozen=True)
class CaliperItems:
    """The items of a caliper, equally many of each quantity; without ``depth``, depths follow from the bit depth.

    Attributes
    ----------
    measures
        "radius" or "diameter"; the scale of diameters is halved.
    offset, latency
        Metres from the bit up to the sensor, seconds between measurement and arrival.
    toolface_offset
        Degrees; a list has the angle of the sensor of each radius.
    radius_range
        Least and most radius, metres.
    has_toolface_unit
        Whether somebody states the unit of the toolfaces: the configuration or the source.
    """

    toolface: list[Item]
    radius: list[Item]
    depth: list[Item]
    measures: str
    offset: float
    latency: float
    toolface_offset: float | list[float]
    radius_range: list[float]
    has_toolface_unit: bool


@dataclass(frozen=True)
class Image:
    """The items of an image, one for each sector, and its layout; without ``depth``, depths follow from the bit."""

    name: str
    unit: str
    sectors: list[Item]
    depth: Item | None
    offset: float
    latency: float
    layout: Layout


@dataclass(frozen=True)
class RigShow:
    """A channel of the rig that is shown: its item, and its settings."""

    item: Item
    table: ShowTable


@dataclass(frozen=True)
class Source:
    """A source: its table, and what that means.

    Attributes
    ----------
    table
        The settings as the file states them; those of the transport stand only here.
    units
        "metric", "fps", or "sent" if the source sends the unit of each value.
    nulls, silence, pass_numbers
        As in the table.
    rig
        The items of the rig quantities, by their names.
    pass_number
        The item of the pass number.
    shown
        The channels of the rig that are shown, by their names.
    station
        The items of depth, inclination and azimuth of a survey station; empty if there are none.
    limits
        The most bytes of a line, bytes of a frame and lines of a frame.
    message
        The message that is sent to the source, and the seconds between two messages; None: nothing is sent.
    """

    name: str
    table: SourceTable
    address: Address
    units: str
    nulls: list[float]
    silence: float
    pass_numbers: PassNumbers
    rig: dict[str, Item]
    pass_number: Item | None
    station: list[Item]
    caliper: CaliperItems | None
    images: list[Image]
    shown: dict[str, RigShow] = field(default_factory=dict)
    limits: tuple[int, int, int] = (wits.LINE_LIMIT, wits.FRAME_LIMIT, wits.ITEM_LIMIT)
    message: tuple[bytes, float] | None = None

    @cached_property
    def measured(self) -> list[Item]:
        """All items of stations, caliper and images."""
        caliper = self.caliper
        found = [*self.station, *([*caliper.toolface, *caliper.radius, *caliper.depth] if caliper else [])]
        for image in self.images:
            found += [*image.sectors, *([image.depth] if image.depth else [])]
        return found

    @cached_property
    def mapped(self) -> list[str]:
        """The names of all items that are read, in the order of the settings."""
        number = [self.pass_number] if self.pass_number else []
        shown = [one.item for one in self.shown.values()]
        return list(dict.fromkeys(item.name for item in (*self.rig.values(), *number, *self.measured, *shown)))

    @property
    def records(self) -> list[int]:
        """The WITS records of the items, whose sequence numbers the reader checks; empty for other kinds."""
        return []

    def number_of(self, name: str) -> int:
        """Return the number that journals have in place of the name of an item."""
        return int(name)

    def name_of(self, number: int) -> str:
        """Return the name of the item for which journals have ``number``."""
        return f"{number:04d}"

    def _recorded(self, value: Any) -> Any:
        """Return a setting as journals have it: the number of an item and its scale."""
        if isinstance(value, Item):
            return {"code": self.number_of(value.name), "scale": value.scale}
        return [self._recorded(one) for one in value] if isinstance(value, list) else value

    def meaning(self) -> dict[str, Any]:
        """Return the settings that affect the wall, without those of the transport."""
        meaning: dict[str, Any] = {"name": self.name, "units": self.units, "nulls": self.nulls, "limits": self.limits,
                                   "items": {name: self._recorded(item) for name, item in self.rig.items()},
                                   "survey": self._recorded(self.station) or None}  # fmt: skip
        caliper = ("toolface", "radius", "depth", "offset", "latency", "toolface_offset", "radius_range")
        image = ("name", "unit", "sectors", "depth", "offset", "latency", "layout")
        meaning["caliper"] = self.caliper and {name: self._recorded(getattr(self.caliper, name)) for name in caliper}
        meaning["images"] = [{name: self._recorded(getattr(one, name)) for name in image} for one in self.images]
        if number := self.pass_number:  # older journals have no such settings
            meaning |= {
                "pass_number": self._recorded(number),
                "pass_numbers": {"listed": list(self.pass_numbers.listed.items())},
            }
        if self.shown:
            meaning["show"] = {key: self._recorded(one.item) | asdict(one.table) for key, one in self.shown.items()}
        return meaning

    def with_meaning(self, recorded: dict[str, Any]) -> Self:
        """Return this source with those values of a recorded meaning whose defaults may differ between versions."""
        names = {"nulls", "limits", "caliper", "images"} & recorded.keys()
        return replace(self, **{name: with_values(getattr(self, name), recorded[name]) for name in names})


def _shared(name: str, table: SourceTable) -> dict[str, Any]:
    """Return the fields that sources of all kinds have in the same way."""
    return {
        "name": name, "table": table, "address": table.place, "units": table.unit_set, "nulls": list(table.nulls),
        "silence": table.silence, "pass_numbers": table.pass_numbers,
    }  # fmt: skip


@dataclass(frozen=True)
class WitsSource(Source):
    """A source that sends WITS level 0."""

    table: WitsTable

    @classmethod
    def read(cls, name: str, table: WitsTable, others: OtherTables) -> Self:
        """Return the source that a table means; raise InputError, with the place in the table, if a rule is broken."""
        depth_unit, _ = LENGTHS[table.units]

        def length(of: LengthItem) -> Item:
            return Item(of.item, units.factor(of.unit or depth_unit, units.LENGTH))

        given = {key: getattr(table.items, key) for key in RIG if getattr(table.items, key)}
        messages = {"heartbeat": (wits.HEARTBEAT, table.every or 20.0), "poll": (wits.POLL, table.every or 1.0)}
        survey = table.survey
        return cls(
            **_shared(name, table),
            rig={key: length(of) if isinstance(of, LengthItem) else Item(of) for key, of in given.items()},
            pass_number=Item(table.items.pass_number) if table.items.pass_number else None,
            station=[length(survey.depth), Item(survey.inclination), Item(survey.azimuth)] if survey else [],
            caliper=_wits_caliper(table.caliper, LENGTHS[table.units], others) if table.caliper else None,
            images=[
                Image(key, of.unit, _run(of.first, f"image.{key}.count", of.count),
                      length(of.depth) if of.depth else None, of.offset, of.latency, _layout(key, of, others))
                for key, of in table.image.items()
            ],
            shown={key: RigShow(Item(of.item), of) for key, of in table.show.items()},
            limits=(table.line_limit, table.frame_limit, table.item_limit),
            message=messages.get(table.mode),
        )  # fmt: skip

    @property
    def records(self) -> list[int]:
        return sorted({int(name[:2]) for name in self.mapped})

    @cached_property
    def allow(self) -> Sequence[ipaddress.IPv4Network | ipaddress.IPv6Network]:
        """The networks that may connect to a listener."""
        given = self.table.allow
        return [ipaddress.ip_network(one) for one in (LOOPBACK if given is None else given)]

    @property
    def replace_after(self) -> float:
        """Seconds of silence after which a newcomer replaces the sender."""
        return self.table.replace_after


@dataclass(frozen=True)
class NamedSource(Source):
    """A source whose values have names.

    Attributes
    ----------
    curves
        The items without the index, each once, with a scale of 1, in the order of the settings. In journals the index
        has the number 1, and ``curves[n]`` has n + 2.
    """

    table: NamedTable
    curves: list[Item] = field(default_factory=list)

    @classmethod
    def read(cls, name: str, table: NamedTable, others: OtherTables) -> Self:
        """Return the source that a table means; raise InputError, with the place in the table, if a rule is broken."""
        usual = [units.factor(one, units.LENGTH) for one in LENGTHS.get(table.unit_set, ("m", "m"))]
        scales = {"bit_depth": usual[0], "hole_depth": usual[0], "depth": usual[0], "radius": usual[1]}

        def item(quantity: str, of: str) -> Item:
            return Item(of, scales.get(quantity, 1.0), KINDS.get(quantity, ""))

        rig = {key: item(key, of) for key in RIG if (of := getattr(table.items, key))}
        number = Item(table.items.pass_number) if table.items.pass_number else None
        caliper, index = None, Item(INDEX) if table.index == "depth" else None
        if of := table.caliper:
            depth = [item("depth", one) for one in of.depth] or ([index] * len(of.toolface) if index else [])
            columns = {key: [item(key, one) for one in getattr(of, key)] for key in ("toolface", "radius")}
            caliper = _caliper(of, columns | ({"depth": depth} if depth else {}), "curves", others, True)
        images = [
            Image(key, one.unit, [Item(sector, unit=one.unit) for sector in one.sectors], index, one.offset, 0.0,
                  _layout(key, one, others))
            for key, one in table.image.items()
        ]  # fmt: skip
        shown = {key: RigShow(Item(one.name, unit=one.unit), one) for key, one in table.show.items()}
        places: list[tuple[str, Sequence[Item]]] = [(f"items.{key}", [one]) for key, one in rig.items()]
        places += [("items.pass_number", [number])] if number else []
        places += [(f"caliper.{key}", getattr(caliper, key)) for key in ("toolface", "radius", "depth") if caliper]
        places += [(f"image.{one.name}.sectors", one.sectors) for one in images]
        places += [(f"show.{key}.name", [one.item]) for key, one in shown.items()]
        return cls(
            **_shared(name, table), rig=rig, pass_number=number, station=[], caliper=caliper, images=images,
            shown=shown, curves=_curves(places), **cls.more(table),
        )  # fmt: skip

    @classmethod
    def more(cls, table: Any) -> dict[str, Any]:  # noqa: ARG003
        """Return the fields that a class below has besides."""
        return {}

    def number_of(self, name: str) -> int:
        return 1 if name == INDEX else 2 + [curve.name for curve in self.curves].index(name)

    def name_of(self, number: int) -> str:
        return self.curves[number - 2].name if number > 1 else INDEX

    def meaning(self) -> dict[str, Any]:
        curves = [{"mnemonic": curve.name, "kind": curve.kind} for curve in self.curves]
        return super().meaning() | {"curves": curves}


def _curves(places: Sequence[tuple[str, Sequence[Item]]]) -> list[Item]:
    """Return each named item once, with a scale of 1; refuse a name that is mapped to two quantities."""
    curves: dict[str, Item] = {}
    for place, items in places:
        for item in (replace(one, scale=1.0) for one in items):
            if item.name != INDEX and item != curves.setdefault(item.name, item):
                raise InputError(place, "is mapped to another quantity already", repr(item.name))
    return list(curves.values())


@dataclass(frozen=True)
class StoreSource(NamedSource):
    """A WITSML store that helibore polls; ``index`` and ``jump`` are those of its log.

    The password is read from the environment when a client is made.
    """

    table: StoreTable
    index: str = "depth"
    jump: float = 0.0

    @classmethod
    def more(cls, table: Any) -> dict[str, Any]:
        jump = table.log.jump if table.log else None
        return {"index": table.index, "jump": jump or JUMPS[table.index]}

    def __post_init__(self) -> None:
        if self.curves and self.table.log is None:
            raise InputError("log", f"must be given: the curve {self.curves[0].name} is read from a log")

    def meaning(self) -> dict[str, Any]:
        meaning = super().meaning()
        log, trajectory = (one and one.uids for one in (self.table.log, self.table.trajectory))
        store = {"log": log, "index": self.index, "trajectory": trajectory, "curves": meaning.pop("curves")}
        jump = {"jump": self.jump} if self.jump != JUMPS[self.index] else {}
        return meaning | {"store": store | jump}


def _wits_caliper(table: WitsCaliper, lengths: tuple[str, str], others: OtherTables) -> CaliperItems:
    lists = {"toolface": table.toolface, "radius": table.radius, "depth": table.depth}
    given: Mapping[str, Sequence[str]] = {name: items for name, items in lists.items() if items}
    if table.first:
        for name in given:
            raise InputError(f"caliper.{name}", "must not be given together with first")
        if sorted(table.order) not in (["depth", "radius", "toolface"], ["radius", "toolface"]):
            rule = 'must name "toolface" and "radius" once each, "depth" at most once, and nothing else'
            raise InputError("caliper.order", rule, repr(list(table.order)))
        run = [item.name for item in _run(table.first, "caliper.groups", table.groups, len(table.order))]
        given = {name: run[start :: len(table.order)] for start, name in enumerate(table.order)}
    for name in ("toolface", "radius"):
        if name not in given:
            raise InputError(f"caliper.{name}", "must be given: a list of items, one for each triple")
    columns = {}
    for name, unit in zip(("toolface", "radius", "depth"), ("deg", *reversed(lengths)), strict=True):
        kind = units.ANGLE if name == "toolface" else units.LENGTH
        scale = units.factor(getattr(table, f"{name}_unit") or unit, kind)
        if name in given:
            columns[name] = [Item(code, scale) for code in given[name]]
    return _caliper(table, columns, "items", others, table.toolface_unit is not None, table.latency)


def _caliper(
    table: CaliperTable,
    columns: dict[str, list[Item]],
    what: str,
    others: OtherTables,
    has_unit: bool,
    latency: float = 0.0,
) -> CaliperItems:
    """Return the caliper of the items in ``columns``; ``what`` is the word for the items in error messages."""
    for name in {"toolface", "depth"} & columns.keys():
        columns[name] *= len(columns["radius"]) if len(columns[name]) == 1 else 1
    lengths = {name: len(items) for name, items in columns.items()}
    if len(set(lengths.values())) != 1 or not lengths["toolface"]:
        raise InputError("caliper", f"toolface, radius and depth must have equally many {what}, not {lengths}")
    stated = table.toolface_offset
    offsets = [float(one) for one in stated] if isinstance(stated, list | tuple) else float(stated)
    if isinstance(offsets, list) and len(offsets) != lengths["toolface"]:
        rule = f"must be a number, or a list of {lengths['toolface']}"
        raise InputError("caliper.toolface_offset", rule, repr(offsets))
    names = [[item.name for item in columns[name]] for name in ("toolface", "depth") if name in columns]
    turned = offsets if isinstance(offsets, list) else [offsets] * lengths["toolface"]
    if len(set(zip(*names, turned, strict=True))) < len(turned):
        rule = "several radii have one toolface: must be a list with the angle of each sensor"
        raise InputError("caliper.toolface_offset", f"{rule}, such as [0, 90, 180, 270]", repr(offsets))
    half = 0.5 if table.measures == "diameter" else 1.0
    return CaliperItems(
        toolface=columns["toolface"],
        radius=[replace(item, scale=item.scale * half) for item in columns["radius"]],
        depth=columns.get("depth", []),
        measures=table.measures,
        offset=table.offset,
        latency=latency,
        toolface_offset=offsets,
        radius_range=list(table.radius_range) or [others.bit_diameter / 8, others.bit_diameter * 2],
        has_toolface_unit=has_unit,
    )


def _layout(name: str, table: LayoutTable, others: OtherTables) -> Layout:
    try:
        return table.layout(others.reference)
    except InputError as error:
        raise InputError(f"image.{name}.{error.place}", error.rule, error.value) from None


def _run(first: str, name: str, given: int, members: int = 1) -> list[Item]:
    """Return ``given`` x ``members`` consecutive items from ``first`` on; ``given`` is the setting ``name``."""
    if not given:
        raise InputError(name, "must be given: a whole number")
    count = given * members
    code = int(first)
    if code % 100 + count - 1 > 99:
        raise InputError(name, f"items {first} and {count - 1} more must not pass item 99", str(given))
    return [Item(f"{one:04d}") for one in range(code, code + count)]

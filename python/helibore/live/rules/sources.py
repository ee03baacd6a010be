"""The tables ``[source.NAME]`` of WITS senders and WITSML stores: the connection, and what its items mean.

    [source.mwd]                                  [source.store]
    address = "tcp://127.0.0.1:9872"              address = "https://store.example/witsml"
    units = "metric"                              log = { well = "w", wellbore = "b", log = "c", index = "depth" }
    items = { bit_depth = "0108" }                items = { bit_depth = "DBTM" }
    caliper = { first = "5010", groups = 30 }     caliper = { toolface = ["TF1"], radius = ["R1"] }

While a table is read, each item becomes an `Item`: its name in the messages of the source, and a scale to core units.
The values of a store's curve are converted when they come, by the unit that the store sends.
"""

from __future__ import annotations

import ipaddress
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, PlainValidator, field_validator

from helibore.base import units
from helibore.base.errors import InputError
from helibore.base.nulls import NULLS
from helibore.live.rules.checks import Derived, Table, check, with_values, within
from helibore.live.rules.file_names import RULE, can_be_file
from helibore.live.rules.layout import LayoutTable
from helibore.live.rules.pass_rules import PassNumbers
from helibore.live.wire import wits
from helibore.live.wire.address import Address, read_address

LENGTHS = {"metric": ("m", "mm"), "fps": ("ft", "in")}
"""The units of depths and of radii in each unit set (in WITS, the units of items 0108 and 0844)."""
JUMPS = {"depth": 30.0, "time": 3600.0}
"""The default of ``jump``: metres for a log by depth, seconds for a log by time."""
INDEX = ""
"""The name of a store's index curve, whose mnemonic does not matter."""


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


@dataclass
class Context:
    """What validators must know of the rest of the configuration.

    ``reference`` is the reference of the path. ``lengths`` are the units of depths and radii. ``index`` is "depth" or
    "time".
    """

    name: str
    bit_diameter: float
    reference: str
    lengths: tuple[str, str]
    index: str


def _code(value: object) -> Item:
    rule = "must be four digits RRII, 01 to 99 each"
    if isinstance(value, int) and not isinstance(value, bool):
        raise ValueError(f'{rule}, in quotes: "{value:04d}"')
    try:
        return Item(f"{wits.code(str(value)):04d}")
    except ValueError:
        raise ValueError(rule) from None


def _unit_of(kind: str) -> AfterValidator:
    def check_unit(unit: str) -> str:
        try:
            units.factor(unit, kind)
        except ValueError as error:
            raise ValueError(str(error).partition(": ")[2]) from None
        return unit

    return AfterValidator(check_unit)


Code = Annotated[Item, PlainValidator(_code)]
LengthUnit = Annotated[str, _unit_of(units.LENGTH)]
AngleUnit = Annotated[str, _unit_of(units.ANGLE)]
Latency = Annotated[float, within(0, 3600)]
Text = Annotated[str, Field(min_length=1)]


class LengthTable(Table):
    """An item that measures a length, and the unit of this item: { item = "0108", unit = "ft" }."""

    item: Code = Field(description="an item")
    unit: LengthUnit | None = None


def _length(value: object, info: Any) -> Item:
    usual = info.context.lengths[0]
    if not isinstance(value, dict):
        return Item(_code(value).name, units.factor(usual, units.LENGTH))
    table = check(LengthTable, value)
    return Item(table.item.name, units.factor(table.unit or usual, units.LENGTH))


def _curve(kind: str) -> PlainValidator:
    """Return the validator that turns a mnemonic into an `Item`."""

    def named(mnemonic: object, info: Any) -> Item:
        if not isinstance(mnemonic, str) or not mnemonic:
            raise ValueError("must be a text that is not empty")
        return Item(mnemonic, kind=kind, unit=info.data.get("unit", ""))

    return PlainValidator(named)


def _offsets(value: Any) -> float | list[float]:
    numbers = value if isinstance(value, list) else [value]
    if not all(type(one) in (int, float) and -360 <= one <= 360 for one in numbers):
        raise ValueError("must be a number from -360 to 360, or a list of such numbers")
    return [float(one) for one in numbers] if isinstance(value, list) else float(value)


def _network(network: Any) -> ipaddress.IPv4Network | ipaddress.IPv6Network:
    try:
        return ipaddress.ip_network(network)
    except ValueError:
        raise ValueError("must be an IP address or a network such as 10.1.0.0/16") from None


def _refuse_password(_: object) -> None:
    rule = "must not be in the file, which is copied into the journal: name an environment variable in password_env"
    raise InputError("", rule)


Network = Annotated[ipaddress.IPv4Network | ipaddress.IPv6Network, PlainValidator(_network)]
Length = Annotated[Item, PlainValidator(_length)]
LengthCurve = Annotated[Item, _curve(units.LENGTH)]
RotationCurve = Annotated[Item, _curve(units.ROTATION)]
AngleCurve = Annotated[Item, _curve(units.ANGLE)]
PlainCurve = Annotated[Item, _curve("")]


class RigTable(Table):
    """The rig quantities of a source, and the pass number."""

    bit_depth: Length | None = None
    hole_depth: Length | None = None
    rotation: Code | None = None
    activity: Code | None = None
    pass_number: Code | None = None


class StoreRig(RigTable):
    """The curves of a store that have the rig quantities and the pass number."""

    bit_depth: LengthCurve | None = None
    hole_depth: LengthCurve | None = None
    rotation: RotationCurve | None = None
    activity: PlainCurve | None = None
    pass_number: PlainCurve | None = None


class CaliperTable(Table):
    """The settings of a caliper that WITS senders and stores share; triple n is made of item n of each list.

    A single item of ``toolface`` or ``depth`` applies to all radii. A list ``toolface_offset`` has the angle of the
    sensor of each radius; it must be given if radii share toolface and depth. Without ``depth``, the depth of a triple
    follows from the bit depth; for stores, see `StoreCaliper`.
    """

    measures: Literal["radius", "diameter"] = "radius"
    offset: float = 0.0
    latency: Latency = 0.0
    toolface_offset: Annotated[float | list[float], PlainValidator(_offsets)] = 0.0
    radius_range: list[float] = []
    toolface: list[Code] = []
    radius: list[Code] = []
    depth: list[Code] = []

    def _set_items(self, columns: dict[str, list[Item]], what: str, bit_diameter: float) -> None:
        """Check and set the items in ``columns``, and the range of radii; the scale of diameters is halved.

        ``what`` is the word for the items in error messages.
        """
        for name in {"toolface", "depth"} & columns.keys():
            columns[name] *= len(columns["radius"]) if len(columns[name]) == 1 else 1
        lengths = {name: len(items) for name, items in columns.items()}
        if len(set(lengths.values())) != 1 or not lengths["toolface"]:
            raise InputError("", f"toolface, radius and depth must have equally many {what}, not {lengths}")
        offsets = self.toolface_offset
        if isinstance(offsets, list) and len(offsets) != lengths["toolface"]:
            raise InputError("toolface_offset", f"must be a number, or a list of {lengths['toolface']}", repr(offsets))
        names = [[item.name for item in columns[name]] for name in ("toolface", "depth") if name in columns]
        turned = offsets if isinstance(offsets, list) else [offsets] * lengths["toolface"]
        if len(set(zip(*names, turned, strict=True))) < len(turned):
            rule = "several radii have one toolface: must be a list with the angle of each sensor"
            rule += ", such as [0, 90, 180, 270]"
            raise InputError("toolface_offset", rule, repr(offsets))
        limits = self.radius_range or [bit_diameter / 8, bit_diameter * 2]
        if len(limits) != 2 or not 0 < limits[0] < limits[1]:
            raise InputError("radius_range", "must be [least, most] in metres, 0 < least < most", repr(limits))
        half = 0.5 if self.measures == "diameter" else 1.0
        columns["radius"] = [replace(item, scale=item.scale * half) for item in columns["radius"]]
        self._derive(**columns, radius_range=limits)


class WitsCaliper(CaliperTable):
    """The caliper of a WITS sender: triples in consecutive items from ``first`` on, or a list of items per quantity."""

    first: Code | None = None
    groups: Annotated[int, within(1, 99)] = Field(0, description="a whole number from 1 to 99")
    order: list[str] = ["toolface", "depth", "radius"]
    depth_unit: LengthUnit | None = None
    radius_unit: LengthUnit | None = None
    toolface_unit: AngleUnit | None = None

    def model_post_init(self, context: Context) -> None:
        lists = {"toolface": self.toolface, "radius": self.radius, "depth": self.depth}
        columns = {name: items for name, items in lists.items() if name in self.model_fields_set}
        if self.first is not None:
            for name in columns:
                raise InputError(name, "must not be set together with first")
            if sorted(self.order) not in (["depth", "radius", "toolface"], ["radius", "toolface"]):
                rule = 'must name "toolface" and "radius" once each, "depth" at most once, and nothing else'
                raise InputError("order", rule, repr(self.order))
            run = _run(self.first, "groups", self.groups, len(self.order))
            columns = {name: run[start :: len(self.order)] for start, name in enumerate(self.order)}
        for name in ("toolface", "radius"):
            if name not in columns:
                raise InputError(name, "must be set: a list of items, one for each triple")
        for name, unit in zip(("depth", "radius", "toolface"), (*context.lengths, "deg"), strict=True):
            kind = units.ANGLE if name == "toolface" else units.LENGTH
            scale = units.factor(getattr(self, f"{name}_unit") or unit, kind)
            if name in columns:
                columns[name] = [Item(item.name, scale) for item in columns[name]]
        self._set_items(columns, "items", context.bit_diameter)


class StoreCaliper(CaliperTable):
    """The caliper of a store: the mnemonics of its triples.

    Without ``depth``, the depth of a triple is the index of the log or, in a log by time, follows from the bit depth.
    """

    toolface: list[AngleCurve] = Field(description="mnemonics, one for each sensor")
    radius: list[LengthCurve] = Field(description="mnemonics, one for each sensor")
    depth: list[LengthCurve] = []
    latency: Derived[float] = 0.0

    def model_post_init(self, context: Context) -> None:
        depth = self.depth or ([Item(INDEX)] * len(self.toolface) if context.index == "depth" else [])
        columns = {"toolface": self.toolface, "radius": self.radius} | ({"depth": depth} if depth else {})
        self._set_items(columns, "curves", context.bit_diameter)


class Image(LayoutTable):
    """The settings of an image that WITS senders and stores share.

    Without ``depth``, the depth of a row follows from the bit depth.
    """

    unit: Text = Field(description="the unit of its values")
    offset: float = 0.0
    latency: Latency = 0.0
    depth: Length | None = None
    sectors: Derived[list[Item]] = []
    name: Derived[str] = ""


class WitsImage(Image):
    """An image in ``count`` consecutive items from ``first`` on."""

    first: Code = Field(description="the item of sector 1")
    count: Annotated[int, within(1, 99)] = Field(description="a whole number from 1 to 99")

    def model_post_init(self, context: Context) -> None:
        super().model_post_init(context)
        self._derive(sectors=_run(self.first, "count", self.count))


class StoreImage(Image):
    """An image by the mnemonics of its sectors.

    The depth of a row is the index of the log or, in a log by time, follows from the bit depth.
    """

    sectors: list[PlainCurve] = Field(description="mnemonics, one for each sector")
    depth: Derived[Item | None] = None
    latency: Derived[float] = 0.0

    def model_post_init(self, context: Context) -> None:
        super().model_post_init(context)
        if not self.sectors:
            raise InputError("sectors", "must be 1 mnemonic or more", str(len(self.sectors)))
        self._derive(depth=Item(INDEX) if context.index == "depth" else None)


class StationItems(Table):
    """The items of a survey station."""

    depth: Length = Field("0708", validate_default=True)
    inclination: Code = Item("0713")
    azimuth: Code = Item("0715")


class Source(Table):
    """The settings that WITS senders and stores share.

    Attributes
    ----------
    rig
        The items of the rig quantities, by their names.
    station
        The items of depth, inclination and azimuth of a survey station; empty if there are none.
    measured
        All items of stations, caliper and images.
    mapped
        The names of all items that are read, in the order of the settings.
    records
        The WITS records of these items; the reader checks their sequence numbers. Empty for a store.
    images
        The images of the table ``image``.
    limits
        The most bytes of a line, bytes of a frame and lines of a frame.
    message
        The message that is sent to the source, and the seconds between two messages; None: nothing is sent.
    """

    address: Annotated[Address, PlainValidator(read_address)] = Field(
        description='"tcp://HOST:PORT", "listen://HOST:PORT", "serial:///dev/ttyS0?baud=9600", '
        '"file:///PATH?speed=1", "https://STORE" or "host" (the program pushes the bytes)'
    )
    units: Derived[str] = "sent"
    silence: Annotated[float, within(0.1)] = 120.0
    nulls: list[float] = [*NULLS]
    pass_numbers: PassNumbers = PassNumbers()
    items: RigTable = RigTable()
    caliper: CaliperTable | None = None
    image: Mapping[str, Image] = {}
    name: Derived[str] = ""
    rig: Derived[dict[str, Item]] = {}
    station: Derived[list[Item]] = []
    measured: Derived[list[Item]] = []
    mapped: Derived[list[str]] = []
    records: Derived[list[int]] = []
    images: Derived[list[Image]] = []
    limits: Derived[tuple[int, int, int]] = (wits.LINE_LIMIT, wits.FRAME_LIMIT, wits.ITEM_LIMIT)
    message: Derived[tuple[bytes, float] | None] = None

    @field_validator("image", mode="before")
    @classmethod
    def _check_names(cls, images: Any) -> Any:
        for name in images if isinstance(images, dict) else ():
            if not can_be_file(name):
                raise InputError(f"{name[:60]!r}", f"its name {RULE}")
        return images

    def model_post_init(self, context: Context) -> None:
        for name, image in self.image.items():
            image._derive(name=name)
        caliper, images = self.caliper, list(self.image.values())
        measured = [*self.station, *([*caliper.toolface, *caliper.radius, *caliper.depth] if caliper else [])]
        for image in images:
            measured += [*image.sectors, *([image.depth] if image.depth else [])]
        rig = {name: item for name, item in self.items if item is not None and name != "pass_number"}
        number = [self.items.pass_number] if self.items.pass_number else []
        mapped = list(dict.fromkeys(item.name for item in (*rig.values(), *number, *measured)))
        self._derive(name=context.name, rig=rig, images=images, measured=measured, mapped=mapped)

    @classmethod
    def index_of(cls, entries: dict[str, Any]) -> str:  # noqa: ARG003
        """Return what orders the rows of the source with the table ``entries``: "depth" or "time"."""
        return "time"

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
        if number := self.items.pass_number:  # older journals have no such settings
            meaning |= {
                "pass_number": self._recorded(number),
                "pass_numbers": {"listed": list(self.pass_numbers.listed.items())},
            }
        return meaning

    def with_meaning(self, recorded: dict[str, Any]) -> Source:
        """Return this source with those values of a recorded meaning whose defaults may differ between versions."""
        names = {"nulls", "limits", "caliper", "images"} & recorded.keys()
        return self.model_copy(update={name: with_values(getattr(self, name), recorded[name]) for name in names})


class WitsSource(Source):
    """A source that sends WITS level 0."""

    units: Literal["metric", "fps"] = Field(description='"metric" or "fps", because WITS does not transmit units')
    every: Annotated[float, within(0.05, 3600)] | None = None
    nulls: list[float] = [*wits.NULLS]
    allow: list[Network] = [ipaddress.ip_network("127.0.0.1"), ipaddress.ip_network("::1")]
    mode: Literal["listen", "heartbeat", "poll"] = "listen"
    replace_after: Annotated[float, within(0, 86_400)] = 60.0
    line_limit: Annotated[int, within(16, 1 << 24)] = wits.LINE_LIMIT
    frame_limit: Annotated[int, within(16, 1 << 26)] = wits.FRAME_LIMIT
    item_limit: Annotated[int, within(1, 1 << 20)] = wits.ITEM_LIMIT
    caliper: WitsCaliper | None = None
    image: dict[str, WitsImage] = {}
    survey: StationItems | None = None

    def model_post_init(self, context: Context) -> None:
        messages = {"heartbeat": (wits.HEARTBEAT, self.every or 20.0), "poll": (wits.POLL, self.every or 1.0)}
        self._derive(station=[item for _, item in self.survey or ()], message=messages.get(self.mode),
                     limits=(self.line_limit, self.frame_limit, self.item_limit))  # fmt: skip
        super().model_post_init(context)
        self._derive(records=sorted({int(name[:2]) for name in self.mapped}))
        if self.address.kind == "listen" and not self.address.is_loopback and "allow" not in self.model_fields_set:
            raise InputError(
                "allow", f"must be set: the addresses that may connect to a listener on {self.address.host}"
            )


class NamedSource(Source):
    """A source whose values have names.

    Attributes
    ----------
    curves
        The items without the index, each once, in the order of the settings. In journals the index has the number 1,
        and ``curves[n]`` has n + 2.
    """

    items: StoreRig = StoreRig()
    caliper: StoreCaliper | None = None
    image: dict[str, StoreImage] = {}
    curves: Derived[list[Item]] = []

    def model_post_init(self, context: Context) -> None:
        super().model_post_init(context)
        curves: dict[str, Item] = {}
        for place, items in self._mapped_items():
            for item in items:
                if item.name != INDEX and item != curves.setdefault(item.name, item):
                    raise InputError(place, "is mapped to another quantity already", repr(item.name))
        self._derive(curves=list(curves.values()))

    def _mapped_items(self) -> Iterator[tuple[str, Sequence[Item]]]:
        """Yield place and items of each setting, with scales of 1."""
        for name, item in self.items:
            yield f"items.{name}", [item] if item else []
        if self.caliper:
            for name in ("toolface", "radius", "depth"):
                yield f"caliper.{name}", [replace(item, scale=1.0) for item in getattr(self.caliper, name)]
        for name, image in self.image.items():
            yield f"image.{name}.sectors", image.sectors

    def number_of(self, name: str) -> int:
        return 1 if name == INDEX else 2 + [curve.name for curve in self.curves].index(name)

    def name_of(self, number: int) -> str:
        return self.curves[number - 2].name if number > 1 else INDEX

    def meaning(self) -> dict[str, Any]:
        curves = [{"mnemonic": curve.name, "kind": curve.kind} for curve in self.curves]
        return super().meaning() | {"curves": curves}


class StoreObject(Table):
    """An object of a store, named by the uids of its well, of its wellbore and of the object."""

    well: Text = Field(description="the uid")
    wellbore: Text = Field(description="the uid")


class Log(StoreObject):
    """A log. A row more than ``jump`` (m or s) after the previous row counts only if the next row continues from it."""

    log: Text = Field(description="the uid")
    index: Literal["depth", "time"] = Field(description='"depth" or "time"')
    jump: Annotated[float, within(0.001)] | None = None

    @property
    def uids(self) -> tuple[str, str, str]:
        return self.well, self.wellbore, self.log


class Trajectory(StoreObject):
    """A trajectory, whose stations become survey stations."""

    trajectory: Text = Field(description="the uid")

    @property
    def uids(self) -> tuple[str, str, str]:
        return self.well, self.wellbore, self.trajectory


class StoreSource(NamedSource):
    """A WITSML store that helibore polls; its names are the mnemonics of its log.

    The password is read from the environment when a client is made.
    """

    every: Annotated[float, within(0.05, 3600)] = 10.0
    user: str = ""
    password_env: str = ""
    password: Annotated[str, PlainValidator(_refuse_password)] = ""
    ca: str = ""
    timeout: Annotated[float, within(0.1, 600)] = 30.0
    answer_mb: Annotated[int, within(1, 256)] = 16
    log: Log | None = None
    trajectory: Trajectory | None = None
    index: Derived[str] = "depth"
    jump: Derived[float] = 0.0

    def model_post_init(self, context: Context) -> None:
        super().model_post_init(context)
        jump = self.log.jump if self.log else None
        self._derive(index=context.index, jump=jump or JUMPS[context.index])
        if bool(self.user) != bool(self.password_env):
            raise InputError("", "user and password_env must both be set, or neither")
        if self.log is None and self.trajectory is None:
            raise InputError("", "log or trajectory must be set: the object that is polled")
        if self.curves and self.log is None:
            raise InputError("log", f"must be set: the curve {self.curves[0].name} is read from a log")

    @classmethod
    def index_of(cls, entries: dict[str, Any]) -> str:
        log = entries.get("log")
        return "time" if isinstance(log, dict) and log.get("index") == "time" else "depth"

    def meaning(self) -> dict[str, Any]:
        meaning = super().meaning()
        log, trajectory = self.log and self.log.uids, self.trajectory and self.trajectory.uids
        store = {"log": log, "index": self.index, "trajectory": trajectory, "curves": meaning.pop("curves")}
        jump = {"jump": self.jump} if self.jump != JUMPS[self.index] else {}
        return meaning | {"store": store | jump}


def _run(first: Item, name: str, given: int, members: int = 1) -> list[Item]:
    """Return ``given`` x ``members`` consecutive items from ``first`` on; ``given`` is the setting ``name``."""
    if not given:
        raise InputError(name, "must be set: a whole number")
    count = given * members
    code = int(first.name)
    if code % 100 + count - 1 > 99:
        raise InputError(name, f"items {first.name} and {count - 1} more must not pass item 99", str(given))
    return [Item(f"{one:04d}") for one in range(code, code + count)]

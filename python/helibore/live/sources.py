"""Read the tables ``[source.NAME]`` of WITS senders and WITSML stores: the connection, and what its items mean.

    [source.mwd]                                  [source.store]
    address = "tcp://127.0.0.1:9872"              address = "https://store.example/witsml"
    units = "metric"                              log = { well = "w", wellbore = "b", log = "c", index = "depth" }
    items = { bit_depth = "0108" }                items = { bit_depth = "DBTM" }
    caliper = { first = "5010", groups = 30 }     caliper = { toolface = ["TF1"], radius = ["R1"] }

Each item becomes a number and a scale to core units. A curve of a store has a mnemonic and sends its unit; it gets a
number here, as a WITS item has its code RRII.
"""

from __future__ import annotations

import ipaddress
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, PlainValidator

from helibore.base import units
from helibore.base.errors import InputError
from helibore.base.nulls import NULLS
from helibore.live import wits
from helibore.live.address import Address, read_address
from helibore.live.checks import Table, check, within
from helibore.live.file_names import RULE, can_be_file
from helibore.live.layout import Layout, LayoutTable
from helibore.live.pass_rules import PassNumbers, PassNumbersTable

LENGTHS = {"metric": ("m", "mm"), "fps": ("ft", "in")}
"""Units of depths and of radii, for each unit set (items 0108 and 0844)."""
JUMPS = {"depth": 30.0, "time": 3600.0}
INDEX = 1
"""The number of a store's index curve; its mnemonic does not matter."""
KINDS = {"bit_depth": units.LENGTH, "hole_depth": units.LENGTH, "rotation": units.ROTATION, "activity": ""}
"""The rig quantities, and the kind of unit that each must have."""


@dataclass(frozen=True)
class Item:
    """One mapped item: core value = value x scale."""

    code: int
    scale: float = 1.0


@dataclass(frozen=True)
class CaliperItems:
    """Triples of items; triple n is item n of ``toolface``, ``radius`` and ``depth`` (empty: depth from the bit)."""

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
class Access:
    """The access to a store. The password is not here: it is read from the environment when it is needed."""

    user: str
    password_env: str
    ca: str
    timeout: float
    answer_bytes: int


@dataclass(frozen=True)
class Curve:
    """A curve of the log: its mnemonic, the kind of its unit, and the text of its unit ("": any)."""

    mnemonic: str
    kind: str
    unit: str = ""


@dataclass(frozen=True)
class Store:
    """The objects that are polled: uids of well, wellbore and object; ``curves[n]`` has the number n + 2.

    A row more than ``jump`` (m or s) after the previous one counts only if the next row is within ``jump`` after it.
    """

    access: Access
    log: tuple[str, str, str] | None
    index: str
    jump: float
    trajectory: tuple[str, str, str] | None
    curves: tuple[Curve, ...]

    def meaning(self) -> dict[str, Any]:
        """Return the settings that affect the wall, without those of the access."""
        meaning = {key: value for key, value in asdict(self).items() if key != "access"}
        for curve in meaning["curves"]:
            del curve["unit"]  # the image has the same unit
        if self.jump == JUMPS[self.index]:
            del meaning["jump"]
        return meaning


@dataclass(frozen=True)
class Source:
    """One source: its connection, and what its items mean."""

    name: str
    address: Address
    allow: tuple[str, ...]
    mode: str
    every: float
    units: str
    nulls: tuple[float, ...]
    limits: tuple[int, int, int]
    silence: float
    replace_after: float
    items: dict[str, Item]
    caliper: CaliperItems | None
    images: tuple[ImageItems, ...]
    survey: tuple[Item, Item, Item] | None
    pass_number: Item | None = None
    pass_numbers: PassNumbers = field(default_factory=PassNumbers)
    store: Store | None = None

    def mapped(self) -> list[Item]:
        """Return all items that are read."""
        single = [*self.items.values(), *(self.survey or ()), self.pass_number, *(image.depth for image in self.images)]
        mapped = [item for item in single if item is not None]
        if self.caliper:
            mapped += [*self.caliper.toolface, *self.caliper.radius, *self.caliper.depth]
        return mapped + [item for image in self.images for item in image.sectors]

    def records(self) -> list[int]:
        """Return the record numbers of all mapped items; their sequence numbers (item 04) are checked."""
        return [] if self.store else sorted({item.code // 100 for item in self.mapped()})


def _code(value: object) -> int:
    rule = "must be four digits RRII, 01 to 99 each"
    if isinstance(value, int) and not isinstance(value, bool):
        raise ValueError(f'{rule}, in quotes: "{value:04d}"')
    try:
        return wits.code(str(value))
    except ValueError:
        raise ValueError(rule) from None


def _length_unit(unit: str) -> str:
    try:
        units.factor(unit, units.LENGTH)
    except ValueError as error:
        raise ValueError(str(error).partition(": ")[2]) from None
    return unit


Code = Annotated[int, PlainValidator(_code)]
LengthUnit = Annotated[str, AfterValidator(_length_unit)]


class LengthTable(Table):
    """An item that is a length, with a unit of its own: { item = "0108", unit = "ft" }."""

    item: Code = Field(description="an item")
    unit: LengthUnit | None = None

    def scaled(self, usual: str) -> Item:
        return Item(self.item, units.factor(self.unit or usual, units.LENGTH))


def _length(value: object) -> LengthTable:
    return check(LengthTable, value) if isinstance(value, dict) else LengthTable.model_construct(item=_code(value))


Length = Annotated[LengthTable, PlainValidator(_length)]
Text = Annotated[str, Field(min_length=1)]


class CaliperTable(Table):
    """The settings that the calipers of both kinds of source have."""

    measures: Literal["radius", "diameter"] = "radius"
    offset: float = 0.0
    toolface_offset: Annotated[float, within(-360, 360)] = 0.0
    radius_range: list[float] | None = None

    def items(
        self, place: str, what: str, columns: dict[str, list[Item]], latency: float, bit_diameter: float
    ) -> CaliperItems:
        """Return the caliper of ``columns``; measured diameters are halved."""
        lengths = {name: len(items) for name, items in columns.items()}
        if len(set(lengths.values())) != 1 or not lengths["toolface"]:
            raise InputError(place, f"toolface, radius and depth must have equally many {what}, not {lengths}")
        limits = self.radius_range or [bit_diameter / 8, bit_diameter * 2]
        if len(limits) != 2 or not 0 < limits[0] < limits[1]:
            rule = "must be [least, most] in metres, 0 < least < most"
            raise InputError(f"{place}.radius_range", rule, repr(limits))
        half = 0.5 if self.measures == "diameter" else 1.0
        radius = tuple(Item(item.code, item.scale * half) for item in columns["radius"])
        return CaliperItems(tuple(columns["toolface"]), radius, tuple(columns.get("depth", [])), self.offset, latency,
                            self.toolface_offset, (limits[0], limits[1]))  # fmt: skip


class WitsCaliperTable(CaliperTable):
    """Triples in consecutive items from ``first``, or in a list of items for each quantity."""

    first: Code | None = None
    groups: Annotated[int, within(1, 99)] = Field(0, description="a whole number from 1 to 99")
    order: list[str] | None = None
    toolface: list[Code] | None = None
    radius: list[Code] | None = None
    depth: list[Code] | None = None
    depth_unit: LengthUnit | None = None
    radius_unit: LengthUnit | None = None
    latency: Annotated[float, within(0, 3600)] = 0.0

    def read(self, place: str, source_units: str, bit_diameter: float) -> CaliperItems:
        """Return the caliper items of the table."""
        codes: dict[str, list[int]] = {}
        if self.first is not None:
            order = self.order or ["toolface", "depth", "radius"]
            if sorted(order) not in (["depth", "radius", "toolface"], ["radius", "toolface"]):
                rule = 'must name "toolface" and "radius" once each, and "depth" at most once'
                raise InputError(f"{place}.order", rule, repr(order))
            run = _run(place, self.first, "groups", self.groups, len(order))
            codes = {name: run[start :: len(order)] for start, name in enumerate(order)}
        for name, given in (("toolface", self.toolface), ("radius", self.radius), ("depth", self.depth)):
            if self.first is not None and given is not None:
                raise InputError(f"{place}.{name}", "must not be set beside first")
            if self.first is None and given is None and name != "depth":
                raise InputError(f"{place}.{name}", "must be set: a list of items, one for each triple")
            if given is not None:
                codes[name] = given
        depth_unit, radius_unit = LENGTHS[source_units]
        scales = {"toolface": 1.0, "depth": units.factor(self.depth_unit or depth_unit, units.LENGTH),
                  "radius": units.factor(self.radius_unit or radius_unit, units.LENGTH)}  # fmt: skip
        columns = {name: [Item(code, scales[name]) for code in found] for name, found in codes.items()}
        return self.items(place, "items", columns, self.latency, bit_diameter)


class ImageTable(LayoutTable):
    """The settings that the images of both kinds of source have."""

    unit: Text = Field(description="the unit of its values")
    offset: float = 0.0


class WitsImageTable(ImageTable):
    """An image in ``count`` consecutive items from ``first``."""

    first: Code = Field(description="the item of sector 1")
    count: Annotated[int, within(2, 99)] = Field(description="a whole number from 2 to 99")
    depth: Length | None = None
    latency: Annotated[float, within(0, 3600)] = 0.0

    def read(self, name: str, place: str, source_units: str, reference: str) -> ImageItems:
        """Return the image items of the table."""
        depth = self.depth.scaled(LENGTHS[source_units][0]) if self.depth else None
        sectors = tuple(Item(code) for code in _run(place, self.first, "count", self.count))
        return ImageItems(name, self.unit, sectors, depth, self.offset, self.latency, self.layout(reference, place))


class SurveyTable(Table):
    """The items of a survey station."""

    depth: Length = LengthTable.model_construct(item=708)
    inclination: Code = 713
    azimuth: Code = 715


class RigTable(Table):
    """The rig quantities of a WITS source, and the pass number."""

    bit_depth: Length | None = None
    hole_depth: Length | None = None
    rotation: Code | None = None
    activity: Code | None = None
    pass_number: Code | None = None


class SourceTable(Table):
    """The settings that both kinds of source have."""

    address: Annotated[Address, PlainValidator(read_address)] = Field(
        description='"tcp://HOST:PORT", "listen://HOST:PORT", "serial:///dev/ttyS0?baud=9600", '
        '"file:///PATH?speed=1", "https://STORE" or "host" (the program pushes the bytes)'
    )
    silence: Annotated[float, within(0.1)] = 120.0
    every: Annotated[float, within(0.05, 3600)] | None = None
    nulls: list[float] | None = None
    pass_numbers: PassNumbersTable = PassNumbersTable()


class WitsTable(SourceTable):
    """A source that sends WITS level 0."""

    units: Literal["metric", "fps"] = Field(description='"metric" or "fps" (nothing on the wire says which)')
    allow: list[str] | None = None
    mode: Literal["listen", "heartbeat", "poll"] = "listen"
    replace_after: Annotated[float, within(0, 86_400)] = 60.0
    line_limit: Annotated[int, within(16, 1 << 24)] = 1024
    frame_limit: Annotated[int, within(16, 1 << 26)] = 65536
    item_limit: Annotated[int, within(1, 1 << 20)] = 512
    items: RigTable = RigTable()
    caliper: WitsCaliperTable | None = None
    image: dict[str, WitsImageTable] = {}
    survey: SurveyTable | None = None


def read_wits(name: str, entries: Any, bit_diameter: float, reference: str) -> Source:
    """Return the source of a table whose address is not https."""
    place = f"source.{name}"
    _check_names(place, entries)
    table = check(WitsTable, entries, place)
    items, depth_unit = table.items, LENGTHS[table.units][0]
    rig = {key: value.scaled(depth_unit) if isinstance(value, LengthTable) else Item(value)
           for key in KINDS if (value := getattr(items, key)) is not None}  # fmt: skip
    survey = table.survey
    return Source(
        name=name, address=table.address, allow=_allowed(place, table), mode=table.mode,
        every=table.every or (20.0 if table.mode == "heartbeat" else 1.0), units=table.units,
        nulls=tuple(wits.NULLS if table.nulls is None else table.nulls),
        limits=(table.line_limit, table.frame_limit, table.item_limit), silence=table.silence,
        replace_after=table.replace_after, items=rig,
        caliper=table.caliper.read(f"{place}.caliper", table.units, bit_diameter) if table.caliper else None,
        images=tuple(image.read(key, f"{place}.image.{key}", table.units, reference)
                     for key, image in table.image.items()),
        survey=(survey.depth.scaled(depth_unit), Item(survey.inclination), Item(survey.azimuth)) if survey else None,
        pass_number=Item(items.pass_number) if items.pass_number is not None else None,
        pass_numbers=table.pass_numbers.read(f"{place}.pass_numbers"),
    )  # fmt: skip


def _allowed(place: str, table: WitsTable) -> tuple[str, ...]:
    """Return the networks that may connect; a listener that is not on loopback must set ``allow``."""
    for index, network in enumerate(table.allow or []):
        try:
            ipaddress.ip_network(network)
        except ValueError:
            rule = "must be an IP address or a network such as 10.1.0.0/16"
            raise InputError(f"{place}.allow[{index}]", rule, repr(network)) from None
    if table.address.kind == "listen" and not table.address.is_loopback and table.allow is None:
        raise InputError(f"{place}.allow", f"must be set: who may connect to a listener on {table.address.host}")
    return ("127.0.0.1", "::1") if table.allow is None else tuple(table.allow)


def _run(place: str, first: int, name: str, given: int, members: int = 1) -> list[int]:
    """Return the codes of ``given`` times ``members`` consecutive items from ``first``; ``name``: the setting."""
    if not given:
        raise InputError(f"{place}.{name}", "must be set: a whole number")
    count = given * members
    if first % 100 + count - 1 > 99:
        rule = f"items {first:04d} and {count - 1} more must not pass item 99"
        raise InputError(f"{place}.{name}", rule, str(given))
    return list(range(first, first + count))


def _check_names(place: str, entries: dict[str, Any]) -> None:
    images = entries.get("image")
    for name in images if isinstance(images, dict) else ():
        if not can_be_file(name):
            raise InputError(f"{place}.image.{name[:60]!r}", f"its name {RULE}")


class LogTable(Table):
    """The log of a store."""

    well: Text = Field(description="the uid")
    wellbore: Text = Field(description="the uid")
    log: Text = Field(description="the uid")
    index: Literal["depth", "time"] = Field(description='"depth" or "time"')
    jump: Annotated[float, within(0.001)] | None = None


class TrajectoryTable(Table):
    """The trajectory of a store."""

    well: Text = Field(description="the uid")
    wellbore: Text = Field(description="the uid")
    trajectory: Text = Field(description="the uid")


class StoreRigTable(Table):
    """The rig quantities of a store, and the pass number, by mnemonic."""

    bit_depth: Text | None = None
    hole_depth: Text | None = None
    rotation: Text | None = None
    activity: Text | None = None
    pass_number: Text | None = None


class StoreCaliperTable(CaliperTable):
    """Triples by mnemonic; without ``depth``, the depth is the index of the log."""

    toolface: list[Text] = Field(description="mnemonics, one for each sensor")
    radius: list[Text] = Field(description="mnemonics, one for each sensor")
    depth: list[Text] | None = None


class StoreImageTable(ImageTable):
    """An image by the mnemonics of its sectors."""

    sectors: list[Text] = Field(description="mnemonics, one for each sector")


class StoreTable(SourceTable):
    """A WITSML store that is polled."""

    user: str = ""
    password_env: str = ""
    ca: str = ""
    timeout: Annotated[float, within(0.1, 600)] = 30.0
    answer_mb: Annotated[int, within(1, 256)] = 16
    log: LogTable | None = None
    trajectory: TrajectoryTable | None = None
    items: StoreRigTable = StoreRigTable()
    caliper: StoreCaliperTable | None = None
    image: dict[str, StoreImageTable] = {}


def read_store(name: str, entries: Any, bit_diameter: float, reference: str) -> Source:
    """Return the source of a table whose address is https."""
    place = f"source.{name}"
    if "password" in entries:
        rule = "must not be in the file, which is copied into the journal: name an environment variable in password_env"
        raise InputError(f"{place}.password", rule)
    _check_names(place, entries)
    table = check(StoreTable, entries, place)
    if bool(table.user) != bool(table.password_env):
        raise InputError(place, "user and password_env must be set both, or neither")
    if table.log is None and table.trajectory is None:
        raise InputError(place, "log or trajectory must be set: what is polled")
    index = table.log.index if table.log else "depth"
    curves: list[Curve] = []

    def items(where: str, mnemonics: Sequence[str], kind: str, unit: str = "") -> list[Item]:
        """Return an item for each curve; curves are numbered in the order in which they are first named."""
        for mnemonic in mnemonics:
            known = next((curve for curve in curves if curve.mnemonic == mnemonic), None)
            if known is None:
                curves.append(Curve(mnemonic, kind, unit))
            elif (known.kind, known.unit) != (kind, unit):
                raise InputError(f"{place}.{where}", "is mapped to another quantity too", repr(mnemonic))
        names = [curve.mnemonic for curve in curves]
        return [Item(names.index(mnemonic) + 2) for mnemonic in mnemonics]

    rig = {key: items(f"items.{key}", [curve], kind)[0]
           for key, kind in KINDS.items() if (curve := getattr(table.items, key))}  # fmt: skip
    number = table.items.pass_number
    pass_number = items("items.pass_number", [number], "")[0] if number else None
    caliper = None
    if table.caliper:
        columns = {"toolface": items("caliper.toolface", table.caliper.toolface, units.ANGLE),
                   "radius": items("caliper.radius", table.caliper.radius, units.LENGTH)}  # fmt: skip
        if table.caliper.depth:
            columns["depth"] = items("caliper.depth", table.caliper.depth, units.LENGTH)
        elif index == "depth":
            columns["depth"] = [Item(INDEX)] * len(columns["toolface"])
        caliper = table.caliper.items(f"{place}.caliper", "curves", columns, 0.0, bit_diameter)
    images = []
    for key, image in table.image.items():
        where = f"{place}.image.{key}"
        if len(image.sectors) < 2:
            raise InputError(f"{where}.sectors", "must be 2 mnemonics or more", str(len(image.sectors)))
        sectors = tuple(items(f"image.{key}.sectors", image.sectors, "", image.unit))
        depth = Item(INDEX) if index == "depth" else None
        images.append(ImageItems(key, image.unit, sectors, depth, image.offset, 0.0, image.layout(reference, where)))
    if curves and table.log is None:
        raise InputError(f"{place}.log", f"must be set: {curves[0].mnemonic} is a curve of it")
    log, trajectory = table.log, table.trajectory
    store = Store(
        Access(table.user, table.password_env, table.ca, table.timeout, table.answer_mb << 20),
        (log.well, log.wellbore, log.log) if log else None, index, log.jump if log and log.jump else JUMPS[index],
        (trajectory.well, trajectory.wellbore, trajectory.trajectory) if trajectory else None, tuple(curves),
    )  # fmt: skip
    return Source(
        name=name, address=table.address, allow=(), mode="listen", every=table.every or 10.0, units="sent",
        nulls=tuple(NULLS if table.nulls is None else table.nulls), limits=(1024, 65536, 512),
        silence=table.silence, replace_after=0.0, items=rig, caliper=caliper, images=tuple(images), survey=None,
        pass_number=pass_number,
        pass_numbers=table.pass_numbers.read(f"{place}.pass_numbers"), store=store,
    )  # fmt: skip

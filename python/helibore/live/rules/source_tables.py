"""The tables ``[source.NAME]`` of WITS senders and WITSML stores as the file states them; ``sources.py`` reads them.

[source.mwd]                                  [source.store]
address = "tcp://127.0.0.1:9872"              address = "https://store.example/witsml"
units = "metric"                              log = { well = "w", wellbore = "b", log = "c", index = "depth" }
items = { bit_depth = "0108" }                items = { bit_depth = "DBTM" }
caliper = { first = "5010", groups = 30 }     caliper = { toolface = ["TF1"], radius = ["R1"] }
"""

from __future__ import annotations

import ipaddress
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

from helibore.base import units
from helibore.base.errors import InputError
from helibore.base.nulls import NULLS
from helibore.live.rules.file_names import RULE, can_be_file
from helibore.live.rules.layout import LayoutTable
from helibore.live.rules.pass_rules import PassNumbers
from helibore.live.wire import wits
from helibore.live.wire.address import Address, read_address
from helibore.settings.declared import FINITE, METRES, SECONDS, Declared, Rule, at_least, within

LENGTHS = {"metric": ("m", "mm"), "fps": ("ft", "in")}
"""The units of depths and of radii in each unit set (in WITS, the units of items 0108 and 0844)."""
RIG = ("bit_depth", "hole_depth", "rotation", "activity")
"""The quantities of a rig."""
UnitSet = Literal["metric", "fps"]
Measures = Literal["radius", "diameter"]


def _is_code(text: str) -> bool:
    try:
        wits.code(text)
    except ValueError:
        return False
    return True


def _is_network(text: str) -> bool:
    try:
        ipaddress.ip_network(text)
    except ValueError:
        return False
    return True


def _measures(kind: str) -> Rule:
    """Return the rule of a unit of this kind of quantity."""

    def test(unit: str) -> bool:
        try:
            units.factor(unit, kind)
        except ValueError:
            return False
        return True

    usual = {units.LENGTH: "m, mm, ft or in", units.ANGLE: "deg or rad"}[kind]
    return Rule(f"must be a unit of {kind}, such as {usual}", test)


def _are_offsets(value: Any) -> bool:
    numbers = value if isinstance(value, list | tuple) else [value]
    return all(type(one) in (int, float) and -360 <= one <= 360 for one in numbers)


CODE = Rule("must be four digits RRII, 01 to 99 each", _is_code)
CODES = Rule("must be a list of items of four digits RRII, 01 to 99 each", lambda many: all(map(_is_code, many)))
TEXT = Rule("must not be empty", bool)
NAMES = Rule("must be a list of names that are not empty", all)
ALL_FINITE = Rule("must be finite", lambda values: all(map(math.isfinite, values)))
LENGTH_UNIT, ANGLE_UNIT = _measures(units.LENGTH), _measures(units.ANGLE)
LATENCY = within(0, 3600, "s")
OFFSETS = Rule("must be a number from -360 to 360, or a list of such numbers", _are_offsets)
NETWORKS = Rule("must be IP addresses or networks such as 10.1.0.0/16", lambda many: all(map(_is_network, many)))


@dataclass(frozen=True, kw_only=True)
class LengthItem(Declared):
    """An item that measures a length: ``{ item = "0110", unit = "m" }``, or only ``"0110"``."""

    item: Annotated[str, CODE, "Item, four digits RRII in quotes."]
    unit: Annotated[str | None, LENGTH_UNIT, "Unit of its values. None: that of the source's unit set."] = None


@dataclass(frozen=True, kw_only=True)
class WitsRig(Declared):
    """The items of a WITS sender that have the quantities of the rig, ``[source.NAME.items]``."""

    bit_depth: Annotated[LengthItem | None, "Depth of the bit."] = None
    hole_depth: Annotated[LengthItem | None, "Depth of the hole."] = None
    rotation: Annotated[str, CODE, "Rotation of the string, revolutions a minute."] = ""
    activity: Annotated[str, CODE, "Code of the rig's activity; 4, 5: ream; 8, 9: trip."] = ""
    pass_number: Annotated[str, CODE, "Number of the pass, see ``pass_numbers``."] = ""


@dataclass(frozen=True, kw_only=True)
class NamedRig(Declared):
    """The names of the values that have the quantities of the rig, ``[source.NAME.items]``."""

    bit_depth: Annotated[str, TEXT, "Depth of the bit."] = ""
    hole_depth: Annotated[str, TEXT, "Depth of the hole."] = ""
    rotation: Annotated[str, TEXT, "Rotation of the string."] = ""
    activity: Annotated[str, TEXT, "Code of the rig's activity; 4, 5: ream; 8, 9: trip."] = ""
    pass_number: Annotated[str, TEXT, "Number of the pass, see ``pass_numbers``."] = ""


@dataclass(frozen=True, kw_only=True)
class CaliperTable(Declared):
    """What calipers of all kinds of sources share; triple n is made of value n of each list."""

    measures: Annotated[Measures, "What its values of size are."] = "radius"
    offset: Annotated[float, METRES, FINITE, "Distance from the bit up to the sensor."] = 0.0
    toolface_offset: Annotated[Any, OFFSETS,
        "Degrees added to each toolface; or a list with the angle of the sensor of each radius, clockwise looking "
        "downhole, which must be given if radii share toolface and depth.",
    ] = 0.0  # fmt: skip
    radius_range: Annotated[tuple[float, ...], METRES,
        "Least and most radius; others are flagged and not drawn. Empty: an eighth of the bit size to twice the size.",
    ] = ()  # fmt: skip

    def _check(self) -> None:
        limits = self.radius_range
        if limits and (len(limits) != 2 or not 0 < limits[0] < limits[1]):
            raise InputError("radius_range", "must be [least, most], 0 below least below most", repr(list(limits)))


@dataclass(frozen=True, kw_only=True)
class WitsCaliper(CaliperTable):
    """The caliper of a WITS sender, ``[source.NAME.caliper]``: triples in consecutive items, or lists of items.

    A single item of ``toolface`` or ``depth`` applies to all radii.
    """

    latency: Annotated[float, SECONDS, LATENCY, "Time between measurement and arrival."] = 0.0
    first: Annotated[str, CODE, "First of the consecutive items; then no lists are given."] = ""
    groups: Annotated[int, within(1, 99), "Number of triples from ``first`` on."] = 0
    order: Annotated[tuple[str, ...], "Order of the items in a triple; without depth, it follows from the bit."] = (
        "toolface", "depth", "radius",
    )  # fmt: skip
    toolface: Annotated[tuple[str, ...], CODES, "Items of the toolfaces."] = ()
    radius: Annotated[tuple[str, ...], CODES, "Items of the radii or diameters."] = ()
    depth: Annotated[tuple[str, ...], CODES, "Items of the depths; without them, depth follows from the bit."] = ()
    depth_unit: Annotated[str | None, LENGTH_UNIT, "Unit of the depths. None: that of the unit set."] = None
    radius_unit: Annotated[str | None, LENGTH_UNIT, "Unit of the radii. None: that of the unit set."] = None
    toolface_unit: Annotated[str | None, ANGLE_UNIT, "Unit of the toolfaces. None: degrees."] = None


@dataclass(frozen=True, kw_only=True)
class NamedCaliper(CaliperTable):
    """The caliper of a source whose values have names, ``[source.NAME.caliper]``.

    A single name of ``toolface`` or ``depth`` applies to all radii.
    """

    toolface: Annotated[tuple[str, ...], NAMES, "Names of the toolfaces."]
    radius: Annotated[tuple[str, ...], NAMES, "Names of the radii or diameters."]
    depth: Annotated[tuple[str, ...], NAMES,
        "Names of the depths. Without them, depth is the index of the log; in a log by time and in messages, it "
        "follows from the bit.",
    ] = ()  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class WitsImage(LayoutTable):
    """An image of a WITS sender, ``[source.NAME.image.IMAGE]``: consecutive items from ``first`` on."""

    unit: Annotated[str, TEXT, "Unit of its values."]
    first: Annotated[str, CODE, "Item of sector 1."]
    count: Annotated[int, within(1, 99), "Number of sectors; 1: one value for the whole turn."]
    depth: Annotated[LengthItem | None, "Depth of a row. None: it follows from the bit."] = None
    offset: Annotated[float, METRES, FINITE, "Distance from the bit up to the sensor."] = 0.0
    latency: Annotated[float, SECONDS, LATENCY, "Time between measurement and arrival."] = 0.0


@dataclass(frozen=True, kw_only=True)
class NamedImage(LayoutTable):
    """An image of a source whose values have names, ``[source.NAME.image.IMAGE]``.

    The depth of a row is the index of the log; in a log by time and in messages, it follows from the bit.
    """

    unit: Annotated[str, TEXT, "Unit of its values."]
    sectors: Annotated[tuple[str, ...], TEXT, NAMES, "Names of the sectors' values."]
    offset: Annotated[float, METRES, FINITE, "Distance from the bit up to the sensor."] = 0.0


@dataclass(frozen=True, kw_only=True)
class ShowTable(Declared):
    """What channels of the rig of all kinds of sources share; they are shown and do not change the wall."""

    unit: Annotated[str, "Unit of its values, as it comes."] = ""
    limits: Annotated[tuple[float, ...], ALL_FINITE,
        "Values at the left and the right edge of its curve. Empty: round numbers around its values.",
    ] = ()  # fmt: skip
    low: Annotated[float | None, FINITE, "A value below it begins the alarm ``low``. None: no alarm."] = None
    high: Annotated[float | None, FINITE, "A value above it begins the alarm ``high``. None: no alarm."] = None

    def _check(self) -> None:
        if self.limits and len(set(self.limits)) != 2:
            raise InputError("limits", "must be [left, right], two different numbers", repr(list(self.limits)))
        if self.low is not None and self.high is not None and self.low >= self.high:
            raise InputError("low", f"must be below high = {self.high:g}", f"{self.low:g}")


@dataclass(frozen=True, kw_only=True)
class WitsShow(ShowTable):
    """A channel of the rig that a WITS sender sends, ``[source.NAME.show.CHANNEL]``: ROP, WOB, torque, pressure."""

    item: Annotated[str, CODE, "Item, four digits RRII in quotes."]


@dataclass(frozen=True, kw_only=True)
class NamedShow(ShowTable):
    """A channel of the rig of a source whose values have names, ``[source.NAME.show.CHANNEL]``.

    If the source sends the unit of each value, a value in another unit than ``unit`` is not read.
    """

    name: Annotated[str, TEXT, "Name of its values."]


@dataclass(frozen=True, kw_only=True)
class StationItems(Declared):
    """The items of a survey station, ``[source.NAME.survey]``."""

    depth: Annotated[LengthItem, "Depth; 0708 if it is not stated."] = field(
        default_factory=lambda: LengthItem(item="0708")
    )
    inclination: Annotated[str, CODE, "Inclination."] = "0713"
    azimuth: Annotated[str, CODE, "Azimuth."] = "0715"


@dataclass(frozen=True, kw_only=True)
class SourceTable(Declared):
    """What all kinds of sources share."""

    address: Annotated[str, "Where the source is; the word before the colon decides its kind."]
    silence: Annotated[float, SECONDS, FINITE, at_least(0.1, "s"), "Time without a byte until an alarm begins."] = 120.0
    nulls: Annotated[tuple[float, ...], ALL_FINITE, "Numbers that mean no value."] = NULLS
    pass_numbers: Annotated[PassNumbers, "What its pass numbers mean."] = field(default_factory=PassNumbers)

    def _check(self) -> None:
        self.check_address(self.address)

    @classmethod
    def check_address(cls, address: str) -> None:
        """Raise InputError, which shows no secret, if an address breaks the rule of this kind of source."""
        try:
            cls.place_of(address)
        except InputError as error:
            raise InputError("address", error.rule, error.value) from None

    @classmethod
    def place_of(cls, address: str) -> Address:
        """Return the place that an address names; raise InputError, which shows no secret, if it names none."""
        return read_address(address)

    @property
    def place(self) -> Address:
        """Where the source is."""
        return self.place_of(self.address)

    @property
    def unit_set(self) -> str:
        """Which units its values have: a key of `LENGTHS`, or "sent" if the source sends them."""
        return "sent"


@dataclass(frozen=True, kw_only=True)
class WitsTable(SourceTable):
    """A sender of WITS level 0, ``[source.NAME]``: tcp://, listen://, serial:// or file://, or host, the program."""

    units: Annotated[UnitSet, "Unit set, which WITS does not transmit: m and mm, or ft and in."]
    nulls: Annotated[tuple[float, ...], ALL_FINITE, "Numbers that mean no value."] = wits.NULLS
    allow: Annotated[tuple[str, ...] | None, NETWORKS,
        "Addresses and networks that may connect to a listener. It must be given if other machines can reach it. None: "
        "127.0.0.1 and ::1.",
    ] = None  # fmt: skip
    mode: Annotated[Literal["listen", "heartbeat", "poll"], "What is sent to the rig."] = "listen"
    every: Annotated[float | None, SECONDS, within(0.05, 3600, "s"),
        "Time between two messages to the rig. None: 20 s for heartbeat, 1 s for poll.",
    ] = None  # fmt: skip
    replace_after: Annotated[float, SECONDS, within(0, 86_400, "s"),
        "A newcomer with a whole frame replaces a sender that has been silent for so long.",
    ] = 60.0  # fmt: skip
    line_limit: Annotated[int, within(16, 1 << 24, "bytes"), "Most bytes of a line."] = wits.LINE_LIMIT
    frame_limit: Annotated[int, within(16, 1 << 26, "bytes"), "Most bytes of a frame."] = wits.FRAME_LIMIT
    item_limit: Annotated[int, within(1, 1 << 20, "lines"), "Most lines of a frame."] = wits.ITEM_LIMIT
    items: Annotated[WitsRig, "Quantities of the rig."] = field(default_factory=WitsRig)
    caliper: Annotated[WitsCaliper | None, "Caliper."] = None
    image: Annotated[dict[str, WitsImage], "Images by their names."] = field(default_factory=dict)
    survey: Annotated[StationItems | None, "Items of a survey station."] = None
    show: Annotated[dict[str, WitsShow], "Channels of the rig that are shown, by their names."] = field(
        default_factory=dict
    )

    def _check(self) -> None:
        super()._check()
        check_names(self.image, "image")
        check_names(self.show, "show")
        place = self.place
        if place.kind == "listen" and not place.is_loopback and self.allow is None:
            rule = f"must be given: the addresses that may connect to a listener on {place.host}"
            raise InputError("allow", rule)

    @property
    def unit_set(self) -> str:
        return self.units


@dataclass(frozen=True, kw_only=True)
class NamedTable(SourceTable):
    """What sources share whose values have names."""

    items: Annotated[NamedRig, "Quantities of the rig."] = field(default_factory=NamedRig)
    caliper: Annotated[NamedCaliper | None, "Caliper."] = None
    image: Annotated[dict[str, NamedImage], "Images by their names."] = field(default_factory=dict)
    show: Annotated[dict[str, NamedShow], "Channels of the rig that are shown, by their names."] = field(
        default_factory=dict
    )

    def _check(self) -> None:
        super()._check()
        check_names(self.image, "image")
        check_names(self.show, "show")

    @property
    def index(self) -> str:
        """What orders the rows: "depth" or "time"."""
        return "time"


@dataclass(frozen=True, kw_only=True)
class Log(Declared):
    """A log of a store, ``[source.NAME.log]``."""

    well: Annotated[str, TEXT, "Uid of its well."]
    wellbore: Annotated[str, TEXT, "Uid of its wellbore."]
    log: Annotated[str, TEXT, "Uid of the log."]
    index: Annotated[Literal["depth", "time"], "What orders its rows."]
    jump: Annotated[float | None, FINITE, at_least(0.001),
        "A row more than this, metres or seconds, after the row before it counts only if the next row continues from "
        "it. None: 30 m or 3600 s.",
    ] = None  # fmt: skip

    @property
    def uids(self) -> tuple[str, str, str]:
        return self.well, self.wellbore, self.log


@dataclass(frozen=True, kw_only=True)
class Trajectory(Declared):
    """A trajectory of a store, whose stations become survey stations, ``[source.NAME.trajectory]``."""

    well: Annotated[str, TEXT, "Uid of its well."]
    wellbore: Annotated[str, TEXT, "Uid of its wellbore."]
    trajectory: Annotated[str, TEXT, "Uid of the trajectory."]

    @property
    def uids(self) -> tuple[str, str, str]:
        return self.well, self.wellbore, self.trajectory


@dataclass(frozen=True, kw_only=True)
class StoreTable(NamedTable):
    """A WITSML store that helibore polls, ``[source.NAME]``: https://; its names are the mnemonics of its log."""

    every: Annotated[float, SECONDS, within(0.05, 3600, "s"), "Time between two queries."] = 10.0
    user: Annotated[str, "User; with ``password_env`` or not at all."] = ""
    password_env: Annotated[str, "Environment variable that holds the password."] = ""
    password: Annotated[Any, "Must not be given: the file is copied into the journal. See ``password_env``."] = None
    ca: Annotated[str, "File of certificates of authorities in addition to the system's."] = ""
    timeout: Annotated[float, SECONDS, within(0.1, 600, "s"), "Longest time for a whole answer."] = 30.0
    answer_mb: Annotated[int, within(1, 256, "megabytes"), "A longer answer is refused."] = 16
    log: Annotated[Log | None, "Log that is polled."] = None
    trajectory: Annotated[Trajectory | None, "Trajectory that is polled."] = None

    def _check(self) -> None:
        super()._check()
        if self.password is not None:
            rule = "must not be in the file, which is copied into the journal: name an environment variable in "
            raise InputError("password", rule + "password_env")
        check_user(self.user, self.password_env)
        if self.log is None and self.trajectory is None:
            raise InputError("", "log or trajectory must be set: the object that is polled")

    @property
    def index(self) -> str:
        return self.log.index if self.log else "depth"


def check_user(user: str, password_env: str) -> None:
    """Raise InputError if only one of user and password is given."""
    if bool(user) != bool(password_env):
        raise InputError("", "user and password_env must both be set, or neither")


def check_names(tables: Mapping[str, object], what: str) -> None:
    """Raise InputError if the name of an image or a channel cannot be the name of a file."""
    for name in tables:
        if not can_be_file(name):
            raise InputError(f"{what}.{name[:60]!r}", f"its name {RULE}")

"""Channels of an ETP 1.2 server, joined to rows by their index.

    channel TF   (2010.1, 37)  (2010.2, 74)               row 2010.1: TF 37, RAD 110
    channel RAD  (2010.1, 110)  ...          ----->       row 2010.2 waits until RAD has reached 2010.2

A row is read once every channel that has sent a value has reached its index, or ``wait`` seconds after its first value.
A value counts once: it lies after the last index of its channel, or in a gap that a connection left and whose values
were asked for again. So a value that a server sends twice changes nothing, and a replay gives the same rows.
"""

from __future__ import annotations

import heapq
import math
import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np

from helibore.base import units
from helibore.base.errors import InputError
from helibore.base.utc_time import SECOND
from helibore.live.model.events import EventBook
from helibore.live.model.mapping import Chunk, Reading, SourceReader
from helibore.live.model.named_reader import NamedReader
from helibore.live.model.sample_rows import frame_rows
from helibore.live.rules.depth_limits import DepthLimits
from helibore.live.rules.kinds import Position, Report, SourceKind
from helibore.live.rules.source_tables import NAMES, TEXT, NamedTable, check_user
from helibore.live.rules.sources import Item, NamedSource
from helibore.live.wire.address import Address, read_server_address
from helibore.live.wire.etp_link import EtpOpener, decoded
from helibore.live.wire.redaction import check_password
from helibore.live.wire.transport import Opener
from helibore.settings.declared import SECONDS, within

HEAD = re.compile(rb"etp (\d{1,9})\n")
LONGEST_HEAD = 14
PORTS = {"ws": 80, "wss": 443}
INDEX_KIND = {"depth": "MeasuredDepth", "time": "DateTime"}
MICROSECOND = 1e-6
FUTURE = 86_400.0
"""Seconds by which an index of time may be ahead of this machine's clock."""
BEHIND, BEHIND_FOR = 50, 60.0
"""Values in a row at or before the last index, and the seconds they come, from which an alarm says so."""
MOST_ROWS = 200_000
"""The most rows that wait for channels; beyond that, the first ones are read as they are."""


@dataclass(frozen=True, kw_only=True)
class EtpTable(NamedTable):
    """An ETP 1.2 server, ``[source.NAME]``: wss:// or ws://; its names are those of channels."""

    uris: Annotated[tuple[str, ...], TEXT, NAMES, "URIs of channels, channel sets or logs."]
    ordered_by: Annotated[Literal["depth", "time"], "Index of the channels."]
    token_env: Annotated[str, "Environment variable that holds the token."] = ""
    user: Annotated[str, "User; with ``password_env`` or not at all."] = ""
    password_env: Annotated[str, "Environment variable that holds the password."] = ""
    ca: Annotated[str, "File of certificates of authorities in addition to the system's."] = ""
    message_kb: Annotated[int, within(1, 65_536, "kilobytes"), "A longer message ends the connection."] = 4096
    wait: Annotated[float, SECONDS, within(0, 600, "s"),
        "Longest time for which the values of an index wait for channels that have not reached it.",
    ] = 5.0  # fmt: skip

    def _check(self) -> None:
        super()._check()
        check_user(self.user, self.password_env)
        if self.token_env and self.user:
            raise InputError("", "only one of token_env and user must be set")
        place = self.place
        if (self.user or self.token_env) and place.kind == "ws" and not place.is_loopback:
            raise InputError("address", "must be wss: others can read what proves who you are", repr(self.address))

    @classmethod
    def place_of(cls, address: str) -> Address:
        rule = "must be wss://HOST:PORT/PATH, or ws://HOST:PORT/PATH without encryption"
        return read_server_address(address, rule, "token_env, or user and password_env", PORTS, with_path=True)

    @property
    def index(self) -> str:
        return self.ordered_by


@dataclass(frozen=True)
class EtpSource(NamedSource):
    """An ETP 1.2 server."""

    table: EtpTable

    def meaning(self) -> dict[str, Any]:
        return super().meaning() | {"index": self.table.index, "wait": self.table.wait}


class EtpReader(NamedReader):
    """Reads the framed messages of ``etp_link.py``."""

    STATE = (
        *NamedReader.STATE, "_begun", "_channels", "_last", "_gaps", "_resumed", "_rows", "_waiting", "_read_to",
        "_behind", "_behind_since",
    )  # fmt: skip
    nothing = "messages come, and none of them can be read"

    def __init__(self, source: EtpSource, events: EventBook, limits: DepthLimits) -> None:
        super().__init__(source, events, limits)
        self._stated = source.table
        self._items = {curve.name: curve for curve in source.curves}
        self._begun = b""
        self._channels: dict[int, tuple[str, float, str]] = {}  # by number in the session: name, scale of index, unit
        self._last: dict[str, float] = {}  # by name: the last index, as the server sends it
        self._gaps: dict[str, list[float]] = {}  # by name: the ends of what was asked for again
        self._resumed: set[str] = set()  # channels that have sent a value in this connection
        self._rows: dict[float, tuple[int, dict[str, object]]] = {}  # by key: time of its first value, and values
        self._waiting: list[float] = []  # the keys of these rows, a heap
        self._read_to = -math.inf
        self._behind, self._behind_since = 0, 0

    def position(self) -> dict[str, float]:
        """Return for each channel the index from which it is asked for again."""
        return self._last | {name: gap[0] for name, gap in list(self._gaps.items())}

    def go_on_from(self, before: SourceReader) -> None:
        super().go_on_from(before)
        if isinstance(before, EtpReader):
            for name in EtpReader.STATE[len(NamedReader.STATE) :]:
                setattr(self, name, getattr(before, name))

    def read(self, chunk: Chunk) -> list[Reading]:
        readings = []
        if chunk.connection != self._connection:
            self._begun, self._connection = b"", chunk.connection
            self._channels, self._resumed = {}, set()
        for row, payload in enumerate(chunk.payloads):
            self.counts["bytes"] += len(payload)
            self._begun += payload
            stamp = int(chunk.time[row]), int(chunk.order[row]) << 20, int(chunk.wall[row])
            for message in self._messages(stamp[2]):
                self._take(message, stamp)
            if (reading := self._ready(stamp)) is not None:
                readings.append(reading)
        return readings

    def _messages(self, wall: int) -> Iterator[bytes]:
        """Yield each whole message, and keep the rest."""
        while self._begun:
            head = HEAD.match(self._begun)
            if head is None:
                if len(self._begun) >= LONGEST_HEAD or b"\n" in self._begun:
                    text = f"{len(self._begun)} bytes that belong to no message were not read"
                    self._report(wall, "stray_text", text)
                    self._begun = b""
                return
            stop = head.end() + int(head[1])
            if len(self._begun) < stop:
                return
            message, self._begun = self._begun[head.end() : stop], self._begun[stop:]
            yield message

    def _take(self, message: bytes, stamp: tuple[int, int, int]) -> None:
        try:
            name, _, body = decoded(message)
        except ValueError as error:
            self._report(stamp[2], "damaged", f"a message of {len(message)} bytes was not read: {error}")
            return
        self.counts["frames"] += 1
        if name == "GetChannelMetadataResponse":
            for channel in body["metadata"].values():
                self._describe(channel, stamp[2])
        elif name in ("ChannelData", "GetRangesResponse"):
            self._take_values(body["data"], name == "ChannelData", stamp)
        elif name == "RangeReplaced":
            names = sorted({self._channels.get(one, ("?",))[0] for one in body["channelIds"]})
            text = f"the server replaced {len(body['data'])} values of {', '.join(names)[:100]}: what was drawn stays"
            self._report(stamp[2], "replaced", text)
        elif name == "ChannelsTruncated":
            for one in body["channels"]:
                self._truncate(one["channelId"], one["newEndIndex"]["item"], stamp[2])
        elif name in ("SubscriptionsStopped", "ProtocolException", "CloseSession"):
            self._report(stamp[2], "etp", f"{name}: {str(body.get('reason') or body.get('error') or body)[:200]}")

    def _describe(self, channel: dict[str, Any], wall: int) -> None:
        """Remember the name, index and unit of a channel that a setting names."""
        name = channel["channelName"]
        self._note([name])
        if name not in self._items or any(name == known for known, *_ in self._channels.values()):
            return
        index = channel["indexes"][0] if channel["indexes"] else {"indexKind": "none", "direction": "", "uom": ""}
        wanted, scale = INDEX_KIND[self._stated.index], MICROSECOND
        if index["indexKind"] != wanted or index["direction"] != "Increasing":
            found = f"{index['direction']} {index['indexKind']}"
            rule = f"must be Increasing {wanted} (ordered_by): not read"
            self._report(wall, "index", f"channel {name}: its index is {found}: {rule}")
            return
        if self._stated.index == "depth":
            known = self._scale(Item(f"index of {name}", kind=units.LENGTH), index["uom"], wall)
            if known is None:
                return
            scale = known
        self._channels[channel["id"]] = name, scale, channel["uom"]

    def _truncate(self, number: int, end: object, wall: int) -> None:
        if number in self._channels and isinstance(end, (int, float)):
            name = self._channels[number][0]
            self._last[name] = min(self._last.get(name, end), end)
            self._report(wall, "truncated", f"the server ended channel {name} at {end}: what was drawn stays")

    def _take_values(self, items: list[dict[str, Any]], live: bool, stamp: tuple[int, int, int]) -> None:
        index: object = None
        for item in items:
            index = item["indexes"][0]["item"] if item["indexes"] else index  # without one, that of the item before
            if item["channelId"] not in self._channels:
                continue
            name, scale, _ = self._channels[item["channelId"]]
            rule = self._index_rule(index, scale, stamp[2])
            if rule or not isinstance(index, (int, float)):
                self._report(stamp[2], "index", f"channel {name}: index {str(index)[:60]}: {rule}: not read")
            elif self._is_new(name, float(index), live, stamp):
                key = float(index) * scale
                if key not in self._rows:
                    self._rows[key] = stamp[0], {}
                    heapq.heappush(self._waiting, key)
                self._rows[key][1][name] = item["value"]["item"]

    def _index_rule(self, index: object, scale: float, wall: int) -> str:
        """Return the rule that an index breaks, or "" if it breaks none."""
        if not isinstance(index, (int, float)) or not math.isfinite(index):
            return "must be a finite number"
        if self._stated.index == "time":
            return "is in the future" if index * scale > wall / 1e9 + FUTURE else ""
        least, most = self._limits.depth_range
        return "" if least <= index * scale <= most else self._limits.rule()

    def _is_new(self, name: str, index: float, live: bool, stamp: tuple[int, int, int]) -> bool:
        """Return whether a value counts, and move the last index or the gap of its channel."""
        last = self._last.get(name, -math.inf)
        if live and name not in self._resumed:
            self._resumed.add(name)
            if index > last > -math.inf:  # the server does not repeat the last value: the link asks for what is between
                self._gaps.setdefault(name, [last, index])
        gap = self._gaps.get(name)
        if not live and gap and gap[0] < index <= gap[1]:
            gap[0] = index
            if index < gap[1]:
                return True
            del self._gaps[name]  # its end was read before
            return False
        if live and index > last:
            self._last[name], self._behind = index, 0
            self.doubts.pop("behind", None)
            return True
        if live:
            self._count_behind(name, index, stamp)
        return False

    def _count_behind(self, name: str, index: float, stamp: tuple[int, int, int]) -> None:
        """Begin an alarm if nothing but old values comes."""
        self._behind_since = self._behind_since if self._behind else stamp[0]
        self._behind += 1
        lasting = stamp[0] - self._behind_since > BEHIND_FOR * SECOND
        if self._behind >= BEHIND and lasting and "behind" not in self.doubts:
            text = (
                f"{self._behind} values in a row lie at or before the last index of their channels, as {name} at "
                f"{index:.12g}, and were not read: the server's clock or depth was set back, an index was far "
                "ahead, or its channels are others (uris)"
            )
            self.doubts["behind"] = text
            self._report(stamp[2], "behind", text)

    def _ready(self, stamp: tuple[int, int, int]) -> Reading | None:
        """Return the rows that every channel has reached, or that have waited long enough, in order of their index."""
        last = self.position()
        reached = min((last[name] * of for name, of, _ in self._channels.values() if name in last), default=-math.inf)
        oldest = stamp[0] - int(self._stated.wait * SECOND)
        keys: list[float] = []
        while self._waiting:
            key = self._waiting[0]
            if key > reached and self._rows[key][0] > oldest and len(self._waiting) <= MOST_ROWS:
                break
            keys.append(heapq.heappop(self._waiting))
        rows = [self._rows.pop(key)[1] for key in keys]
        if self._stated.index == "time":
            late = [place for place, key in enumerate(keys) if key < self._read_to]
            for place in late:
                self._leave_out_late(rows[place], stamp[2])
        if not rows:
            return None
        self._read_to = max(self._read_to, keys[-1])
        number = np.arange(len(rows))
        time, order, wall = (np.full(len(rows), value, np.int64) for value in stamp)
        reading = Reading(frame_rows(time, order + number, wall, number + 1, self._connection))
        scales = {name: self._scale(self._items[name], unit, stamp[2]) for name, _, unit in self._channels.values()}
        self._read_named(rows, reading, scales, np.array(keys) if self._stated.index == "depth" else None)
        return reading

    def _leave_out_late(self, row: dict[str, object], wall: int) -> None:
        """Leave out of a row that comes after later ones what needs the bit depth of its time."""
        caliper = self.source.caliper
        names = {item.name for item in self.source.rig.values()}
        if caliper and not caliper.depth:
            names |= {item.name for item in (*caliper.toolface, *caliper.radius)}
        names &= row.keys()
        for name in names:
            del row[name]
        if names:
            text = f"{', '.join(sorted(names))[:100]}: came after later values (wait): not read"
            self._report(wall, "late", text)


class EtpChannels(SourceKind[EtpSource, EtpReader]):
    """ETP 1.2 servers."""

    schemes = "ws", "wss"
    table = EtpTable
    source = EtpSource
    reader = EtpReader
    longest_wait = 60.0
    resumes = True

    def open(self, source: EtpSource, position: Position, report: Report) -> Opener:  # noqa: ARG002
        place, table, secret = f"source.{source.name}", source.table, None
        variable = "token_env" if table.token_env else "password_env"
        if table.token_env or table.user:
            name = getattr(table, variable)
            if name not in os.environ:
                raise InputError(f"{place}.{variable}", "is not set in the environment", repr(name))
            secret = table.user, os.environ[name]
            check_password(f"{place}.{variable}", secret[1])
        names = {curve.name for curve in source.curves}
        return EtpOpener(place, source.address, table.uris, names, table.message_kb << 10, secret, table.ca, position)


KIND = EtpChannels()

"""MQTT: messages of a broker's topics, as JSON objects of named values, or as one number for each topic."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from helibore.base.errors import InputError
from helibore.live.model.events import EventBook
from helibore.live.model.mapping import Chunk, Reading, SourceReader
from helibore.live.model.named_reader import NamedReader
from helibore.live.model.sample_rows import frame_rows
from helibore.live.model.sequence import SequenceWatch
from helibore.live.rules.depth_limits import DepthLimits
from helibore.live.rules.kinds import Position, Report, SourceKind
from helibore.live.rules.source_tables import NAMES, TEXT, NamedTable, UnitSet, check_user
from helibore.live.rules.sources import NamedSource
from helibore.live.wire.address import Address, read_server_address
from helibore.live.wire.mqtt_link import MqttOpener
from helibore.live.wire.redaction import check_password
from helibore.live.wire.transport import Opener
from helibore.settings.declared import within

HEAD = re.compile(rb"mqtt (new|dup|retained|large) (\d{1,5}) (\d{1,8})\n")
LONGEST_HEAD = 40
PORTS = {"mqtt": 1883, "mqtts": 8883}
DEEPEST = 8
"""The most levels of objects in a message."""


@dataclass(frozen=True, kw_only=True)
class MqttTable(NamedTable):
    """An MQTT broker, ``[source.NAME]``: mqtts:// or mqtt://; names are keys of JSON objects, or topics of numbers.

    ``a.b`` is the key ``b`` in the object ``a``; a topic is the name of a bare number.
    """

    units: Annotated[UnitSet, "Unit set, which MQTT does not transmit: m and mm, or ft and in."]
    client: Annotated[str, TEXT, "Client name, for which the broker keeps messages while helibore is away."]
    topics: Annotated[tuple[str, ...], TEXT, NAMES, "Topics to subscribe to."]
    sequence: Annotated[str, "Name of the value that counts the messages, so that gaps show."] = ""
    user: Annotated[str, "User; with ``password_env`` or not at all."] = ""
    password_env: Annotated[str, "Environment variable that holds the password."] = ""
    ca: Annotated[str, "File of certificates of authorities in addition to the system's."] = ""
    message_kb: Annotated[int, within(1, 8192, "kilobytes"), "A longer message is not read."] = 256

    def _check(self) -> None:
        super()._check()
        check_user(self.user, self.password_env)
        place = self.place
        if self.user and place.kind == "mqtt" and not place.is_loopback:
            raise InputError("address", "must be mqtts: others can read the password", repr(f"mqtt://{place.host}"))

    @classmethod
    def place_of(cls, address: str) -> Address:
        rule = "must be mqtts://HOST:PORT, or mqtt://HOST:PORT without encryption"
        return read_server_address(address, rule, "user and password_env", PORTS, with_path=False)

    @property
    def unit_set(self) -> str:
        return self.units


@dataclass(frozen=True)
class MqttSource(NamedSource):
    """An MQTT broker."""

    table: MqttTable

    def meaning(self) -> dict[str, Any]:
        return super().meaning() | {"sequence": self.table.sequence}


class MqttReader(NamedReader):
    """Reads the framed messages of ``mqtt_link.py``."""

    STATE = (*NamedReader.STATE, "_begun")
    nothing = "messages come, and none of them can be read"

    def __init__(self, source: MqttSource, events: EventBook, limits: DepthLimits) -> None:
        super().__init__(source, events, limits)
        self._sequence_name = source.table.sequence
        self._begun = b""
        if self._sequence_name:
            self.watches = {0: SequenceWatch()}

    def go_on_from(self, before: SourceReader) -> None:
        super().go_on_from(before)
        if isinstance(before, MqttReader):
            self._begun = before._begun

    def read(self, chunk: Chunk) -> list[Reading]:
        readings = []
        if chunk.connection != self._connection:
            self._begun, self._connection = b"", chunk.connection
        for row, payload in enumerate(chunk.payloads):
            self.counts["bytes"] += len(payload)
            self._begun += payload
            wall = int(chunk.wall[row])
            rows = [one for message in self._messages(wall) for one in self._rows(*message, wall)]
            if not rows:
                continue
            number = np.arange(len(rows))
            time, order, walls = (np.full(len(rows), column[row]) for column in (chunk.time, chunk.order, chunk.wall))
            reading = Reading(frame_rows(time, (order << 20) + number, walls, number + 1, chunk.connection))
            self._check_sequence(rows, wall)
            self._read_named(rows, reading, {})
            readings.append(reading)
        return readings

    def _messages(self, wall: int) -> Iterator[tuple[str, bytes, bytes]]:
        """Yield state, topic and payload of each whole message, and keep the rest."""
        while self._begun:
            head = HEAD.match(self._begun)
            if head is None:
                if len(self._begun) >= LONGEST_HEAD or b"\n" in self._begun:
                    self._report(
                        wall, "stray_text", f"{len(self._begun)} bytes that belong to no message were not read"
                    )
                    self._begun = b""
                return
            start, topic, size = head.end(), int(head[2]), int(head[3])
            if len(self._begun) < start + topic + size:
                return
            found = (
                head[1].decode(),
                self._begun[start : start + topic],
                self._begun[start + topic : start + topic + size],
            )
            self._begun = self._begun[start + topic + size :]
            yield found

    def _rows(self, state: str, topic: bytes, payload: bytes, wall: int) -> list[dict[str, object]]:
        """Return the rows of a message; a message that was read before, or that is old, has none."""
        name = topic.decode("utf-8", "replace")
        self.counts["frames"] += 1
        digest = self.digest(topic + b"\0" + payload)
        if state == "dup" and digest in self._recent:
            self._report(wall, "duplicate", f"topic {name[:60]}: a message was sent again")
            return []
        self._remember(digest)
        if state == "retained":
            self._report(wall, "retained", f"topic {name[:60]}: a message that the broker kept was not read: it is old")
            return []
        if state == "large":
            self._report(wall, "refused", f"topic {name[:60]}: a message longer than message_kb was not read")
            return []
        try:
            return list(_objects(name, json.loads(payload, parse_constant=_refuse)))
        except (ValueError, RecursionError) as error:
            text = str(error).partition(": line")[0] or type(error).__name__
            self._report(wall, "not_json", f"topic {name[:60]}: {text}: {bytes(payload[:60])!r}")
            return []

    def _check_sequence(self, rows: list[dict[str, object]], wall: int) -> None:
        if not self._sequence_name:
            return
        numbers = [row.get(self._sequence_name) for row in rows]
        known = [float(number) for number in numbers if isinstance(number, (int, float))]
        _, reported = self.watches[0].take(np.array(known))
        for _, rule, text in reported:
            self._report(wall, rule, text)


def _refuse(text: str) -> float:
    raise ValueError(f"{text} is not JSON")


def _objects(topic: str, value: object) -> Iterator[dict[str, object]]:
    """Yield the rows of a message: an object, a list of objects, or a number, whose name is the topic."""
    if isinstance(value, list):
        for one in value:
            if not isinstance(one, dict):
                raise ValueError("must be a number, an object or a list of objects")
            yield from _objects(topic, one)
    elif isinstance(value, dict):
        yield dict(_flat("", value, 0))
    elif value is None or (isinstance(value, (int, float)) and not isinstance(value, bool)):
        yield {topic: value}
    else:
        raise ValueError("must be a number, an object or a list of objects")


def _flat(place: str, value: dict[str, object], depth: int) -> Iterator[tuple[str, object]]:
    for name, one in value.items():
        if isinstance(one, dict) and depth < DEEPEST:
            yield from _flat(f"{place}{name}.", one, depth + 1)
        else:
            yield f"{place}{name}", one


class MqttTopics(SourceKind[MqttSource, MqttReader]):
    """MQTT brokers."""

    schemes = "mqtt", "mqtts"
    table = MqttTable
    source = MqttSource
    reader = MqttReader
    longest_wait = 60.0
    resumes = True

    def open(self, source: MqttSource, position: Position, report: Report) -> Opener:  # noqa: ARG002
        place, table, auth = f"source.{source.name}", source.table, None
        if table.user:
            if table.password_env not in os.environ:
                raise InputError(f"{place}.password_env", "is not set in the environment", repr(table.password_env))
            auth = table.user, os.environ[table.password_env]
            check_password(f"{place}.password_env", auth[1])
        return MqttOpener(place, source.address, table.client, table.topics, table.message_kb << 10, auth, table.ca)


KIND = MqttTopics()

"""A kind of source for a test: lines NAME=VALUE NAME=VALUE ... over TCP, in metres and degrees."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from helibore.live.kinds.toy_link import ToyOpener

from helibore.base.errors import InputError
from helibore.live.model.events import EventBook
from helibore.live.model.mapping import Chunk, Reading
from helibore.live.model.named_reader import NamedReader
from helibore.live.model.sample_rows import frame_rows
from helibore.live.rules.depth_limits import DepthLimits
from helibore.live.rules.kinds import Position, Report, SourceKind
from helibore.live.rules.source_tables import NamedTable
from helibore.live.rules.sources import NamedSource
from helibore.live.wire.address import Address


@dataclass(frozen=True, kw_only=True)
class ToyTable(NamedTable):
    """A toy, ``[source.NAME]``: toy://."""

    greeting: Annotated[str, "What is sent to the toy."] = "hello"

    @classmethod
    def place_of(cls, address: str) -> Address:
        host, _, port = address.removeprefix("toy://").partition(":")
        if not port.isdigit():
            raise InputError("", "must be toy://HOST:PORT", repr(address))
        return Address("toy", host=host, port=int(port))


@dataclass(frozen=True)
class ToySource(NamedSource):
    table: ToyTable


class ToyReader(NamedReader):
    STATE = (*NamedReader.STATE, "_begun")

    def __init__(self, source: ToySource, events: EventBook, limits: DepthLimits) -> None:
        super().__init__(source, events, limits)
        self._begun = b""

    def read(self, chunk: Chunk) -> list[Reading]:
        self._connection = chunk.connection
        readings = []
        for row, payload in enumerate(chunk.payloads):
            self.counts["bytes"] += len(payload)
            *lines, self._begun = (self._begun + payload).split(b"\n")
            if not lines:
                continue
            self.counts["frames"] += len(lines)
            number = np.arange(len(lines))
            time, order, wall = (np.full(len(lines), column[row]) for column in (chunk.time, chunk.order, chunk.wall))
            reading = Reading(frame_rows(time, (order << 20) + number, wall, number + 1, chunk.connection))
            pairs = [[one.partition("=") for one in line.decode().split()] for line in lines]
            self._read_named([{name: float(value) for name, _, value in one} for one in pairs], reading, {})
            readings.append(reading)
        return readings


class Toy(SourceKind[ToySource, ToyReader]):
    schemes = ("toy",)
    table = ToyTable
    source = ToySource
    reader = ToyReader
    of_start = ("greeting",)
    longest_wait = 0.1

    def open(self, source: ToySource, position: Position, report: Report) -> ToyOpener:  # noqa: ARG002
        return ToyOpener(source.address.host, source.address.port, source.table.greeting)


KIND = Toy()

"""Values that the program pushes with `Live.append_values`, by their names: bit depth, hole depth, rotation, others."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from helibore.base.errors import InputError
from helibore.live.model.events import EventBook
from helibore.live.model.mapping import Chunk, Reading
from helibore.live.model.named_reader import NamedReader
from helibore.live.model.sample_rows import frame_rows
from helibore.live.rules.depth_limits import DepthLimits
from helibore.live.rules.kinds import SourceKind
from helibore.live.rules.source_tables import NamedTable, UnitSet
from helibore.live.rules.sources import NamedSource
from helibore.live.wire.address import Address


@dataclass(frozen=True, kw_only=True)
class ValuesTable(NamedTable):
    """Values that the program pushes, ``[source.NAME]``: the address is ``values``; names are those that it gives."""

    units: Annotated[UnitSet, "Unit set of its values: m and mm, or ft and in."]

    @classmethod
    def place_of(cls, address: str) -> Address:
        if address != "values":
            raise InputError("", "must be values: the program pushes them with append_values", repr(address))
        return Address("host")

    @property
    def unit_set(self) -> str:
        return self.units


@dataclass(frozen=True)
class ValuesSource(NamedSource):
    """Values that the program pushes."""

    table: ValuesTable


class ValuesReader(NamedReader):
    """Reads the lines that `Live.append_values` stores: each is a JSON list of rows, objects of named values."""

    STATE = (*NamedReader.STATE, "_begun")
    message, word = "row", "value"
    nothing = "bytes come, and none of them are from append_values"

    def __init__(self, source: ValuesSource, events: EventBook, limits: DepthLimits) -> None:
        super().__init__(source, events, limits)
        self._begun = b""

    def read(self, chunk: Chunk) -> list[Reading]:
        readings = []
        self._connection = chunk.connection
        for place, payload in enumerate(chunk.payloads):
            self.counts["bytes"] += len(payload)
            *lines, self._begun = (self._begun + payload).split(b"\n")
            wall = int(chunk.wall[place])
            rows = [row for line in lines for row in self._rows(line, wall)]
            if not rows:
                continue
            self.counts["frames"] += len(rows)
            number = np.arange(len(rows))
            time, order, walls = (np.full(len(rows), column[place]) for column in (chunk.time, chunk.order, chunk.wall))
            reading = Reading(frame_rows(time, (order << 20) + number, walls, number + 1, chunk.connection))
            self._read_named(rows, reading, {})
            readings.append(reading)
        return readings

    def _rows(self, line: bytes, wall: int) -> list[dict[str, object]]:
        try:
            rows = json.loads(line)
        except ValueError:
            rows = None
        if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
            self._report(wall, "stray_text", f"not of append_values, not read: {line[:60]!r}")
            return []
        return rows


class PushedValues(SourceKind[ValuesSource, ValuesReader]):
    """Values of the program; it opens nothing."""

    schemes = ("values",)
    table = ValuesTable
    source = ValuesSource
    reader = ValuesReader


KIND = PushedValues()

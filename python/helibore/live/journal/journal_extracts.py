"""Read a journal for other programs: the bytes of a source, a table of values, its sessions, and records set aside."""

from __future__ import annotations

import csv
import datetime
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, TextIO

import numpy as np

from helibore.base.errors import InputError
from helibore.base.harmless import cell
from helibore.base.utc_time import SECOND, utc
from helibore.live.journal import journal
from helibore.live.journal.journal import Segment, segments
from helibore.live.journal.session_header import headers
from helibore.live.rules.kinds import kind_of
from helibore.live.rules.sources import Source

KINDS = {
    journal.BYTES: "bytes", journal.OPENED: "opened", journal.CONNECTED: "connected", journal.CLOSED: "closed",
    journal.SAMPLES: "samples", journal.STATIONS: "stations", journal.IMAGE: "image",
    journal.FITTED: "fitted",
}  # fmt: skip
"""The name of each kind of record."""
COLUMNS = {journal.SAMPLES: ("depth_m", "toolface_deg", "radius_m", "time_s"),
           journal.STATIONS: ("depth_m", "inclination_deg", "azimuth_deg")}  # fmt: skip
Report = Callable[[Segment], None]


@dataclass(frozen=True, slots=True)
class SetAside:
    """A record that the model set aside, because it could not be read or drawn.

    Attributes
    ----------
    sequence, wall
        Number and receive time (ns since 1970) of the record.
    source, kind
        Names of its source ("": the host, or the journal itself) and of its kind (see `KINDS`).
    reason, payload
        Why the record was set aside, and the bytes of the record.
    """

    sequence: int
    wall: int
    source: str
    kind: str
    reason: str
    payload: bytes


def export_bytes(folder: Path, number: int, file: BinaryIO, report: Report = lambda _: None) -> int:
    """Write all bytes that the journal has of the source with this number, and return the number of bytes.

    For a WITS source these are the bytes that it sent; for a store, its answers as ``witsml.py`` frames them.
    ``report`` is called with each segment after it is read.
    """
    total = 0
    for segment in segments(folder):
        of = (segment.records["kind"] == journal.BYTES) & (segment.records["source"] == number)
        for row in np.flatnonzero(of).tolist():
            total += file.write(segment.payload(row))
        report(segment)
    return total


def export_csv(folder: Path, sources: dict[int, Source], file: TextIO, report: Report = lambda _: None) -> int:
    """Write a table of the values in a journal: utc, source, connection, line, name and value in each row.

    The table has a row for each WITS item of a whole frame, and for each value of the samples and stations that the
    host pushed. Answers of stores and images of the host are left out. ``report`` is called with each segment after it
    is read.

    Returns
    -------
    int
        The number of rows.
    """
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(["utc", "source", "connection", "line", "name", "value"])
    rows, items = 0, {number: kind_of(source).items(source) for number, source in sources.items()}
    for segment in segments(folder):
        for row, record in enumerate(segment.records):
            kind, number, link = int(record["kind"]), int(record["source"]), int(record["connection"])
            payload, source = segment.payload(row), sources.get(number)
            found: list[tuple[int, int, str, str]] = []
            if kind in COLUMNS and number == 0:
                if len(payload) % (8 * len(COLUMNS[kind])):
                    continue  # the model set this record aside
                values = np.frombuffer(payload).reshape(len(COLUMNS[kind]), -1)
                found = [(link, 0, name, f"{value:.9g}") for one in values.T.tolist()
                         for name, value in zip(COLUMNS[kind], one, strict=True)]  # fmt: skip
            elif kind in (journal.BYTES, journal.CLOSED) and (turn := items.get(number)):
                found = list(turn(link, payload, kind == journal.CLOSED))
            stamp, sender = utc(int(record["wall"])), source.name if source else ""
            writer.writerows(
                [stamp, cell(sender), link, at, cell(name), cell(value)] for link, at, name, value in found
            )
            rows += len(found)
        report(segment)
    return rows


def quarantine(folder: Path, reasons: Mapping[int, str], numbers: Mapping[str, int]) -> list[SetAside]:
    """Return the records that a model set aside.

    ``reasons`` are the model's reasons by the number of the record, ``numbers`` the numbers of its sources by name.
    """
    found = []
    names = {number: name for name, number in numbers.items()}
    for segment in segments(folder):
        for row in np.flatnonzero(np.isin(segment.records["sequence"], list(reasons))).tolist():
            record = segment.records[row]
            sequence, kind = int(record["sequence"]), int(record["kind"])
            source, reason = names.get(int(record["source"]), ""), reasons[sequence]
            what = KINDS.get(kind, str(kind))
            found.append(SetAside(sequence, int(record["wall"]), source, what, reason, segment.payload(row)))
    return found


def sessions(folder: Path) -> list[tuple[int, str]]:
    """Return receive time (ns since 1970) and configuration text of each session and each change within a session."""
    found, last = [], ("", "")
    for segment in segments(folder):
        for row, header in headers(segment):
            this = str(header.get("session", "")), str(header.get("configuration", ""))
            if this != last or not last[0]:
                found.append((int(segment.records["wall"][row]), this[1]))
            last = this
    return found


def record_at(folder: Path, text: str) -> int:
    """Return the number of a record that is stated by its number, or by a UTC time: the first record from then on.

    Raises
    ------
    InputError
        If the text is neither, or if no record but the first one comes at or after it.
    """
    rule = "must be the number of a record after the first one, or a UTC time such as 2026-05-01T10:00:00Z"
    number = time = None
    if text.isdecimal():
        number = int(text)
    else:
        with suppress(ValueError):
            time = datetime.datetime.fromisoformat(text)
        if time is None or time.tzinfo is None:
            raise InputError("since", rule, repr(text))
    for segment in segments(folder):
        records = segment.records
        late = records["sequence"] >= number if time is None else records["wall"] >= time.timestamp() * SECOND
        for row in np.flatnonzero(late & (records["sequence"] > 0))[:1].tolist():
            return int(records["sequence"][row])
    raise InputError("since", f"the journal has no record at or after it: {rule}", repr(text))

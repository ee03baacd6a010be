"""Read a journal for other programs: the bytes of a source, a table of all values, and the records set aside."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, TextIO

import numpy as np

from helibore.live import journal, wits
from helibore.live.clock import utc
from helibore.live.journal import Segment, segments
from helibore.live.model import Model
from helibore.live.session_header import headers
from helibore.live.sources import Source, StoreSource

KINDS = {
    journal.BYTES: "bytes", journal.OPENED: "opened", journal.CONNECTED: "connected", journal.CLOSED: "closed",
    journal.SAMPLES: "samples", journal.STATIONS: "stations", journal.IMAGE: "image",
}  # fmt: skip
"""The name of each kind of record."""
COLUMNS = {journal.SAMPLES: ("depth_m", "toolface_deg", "radius_m", "time_s"),
           journal.STATIONS: ("depth_m", "inclination_deg", "azimuth_deg")}  # fmt: skip
Report = Callable[[Segment], None]


@dataclass(frozen=True, slots=True)
class SetAside:
    """A record that was set aside: its number, receive time, source, kind, reason, and bytes."""

    sequence: int
    wall: int
    source: str
    kind: str
    reason: str
    payload: bytes


def export_bytes(folder: Path, number: int, file: BinaryIO, report: Report = lambda _: None) -> int:
    """Write all bytes of the source with this number in the journal, as it sent them, and return their count."""
    total = 0
    for segment in segments(folder):
        of = (segment.records["kind"] == journal.BYTES) & (segment.records["source"] == number)
        for row in np.flatnonzero(of).tolist():
            total += file.write(segment.payload(row))
        report(segment)
    return total


def export_csv(folder: Path, sources: dict[int, Source], file: TextIO, report: Report = lambda _: None) -> int:
    """Write a table: one row for each WITS item of a whole frame and for each value that the host pushed.

    The columns are utc, source, connection, line, name, value. Answers of stores and images of the host are left out.

    Returns
    -------
    int
        The number of rows.
    """
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(["utc", "source", "connection", "line", "name", "value"])
    rows, parsers = 0, dict[int, tuple[int, wits.Parser]]()
    for segment in segments(folder):
        for row, record in enumerate(segment.records):
            kind, source, link = int(record["kind"]), int(record["source"]), int(record["connection"])
            stamp = utc(int(record["wall"]))
            if kind in COLUMNS and source == 0:
                if len(segment.payload(row)) % (8 * len(COLUMNS[kind])):
                    continue  # it was set aside
                values = np.frombuffer(segment.payload(row)).reshape(len(COLUMNS[kind]), -1)
                found = [(0, name, f"{value:.9g}") for one in values.T.tolist()
                         for name, value in zip(COLUMNS[kind], one, strict=True)]  # fmt: skip
            elif kind == journal.BYTES and (of := sources.get(source)) and not isinstance(of, StoreSource):
                if parsers.get(source, (-1,))[0] != link:
                    parsers[source] = link, wits.Parser(of.nulls, *of.limits)
                found = list(_items(parsers[source][1].feed(segment.payload(row))))
            else:
                continue
            sender = sources[source].name if source else ""
            writer.writerows([stamp, sender, link, line, name, value] for line, name, value in found)
            rows += len(found)
        report(segment)
    return rows


def _items(batch: wits.Batch) -> Iterator[tuple[int, str, str]]:
    for number, frame in enumerate(batch.frames):
        for row in range(int(frame["first"]), int(frame["first"] + frame["items"])):
            text = batch.text_of(row).decode("ascii", "backslashreplace")
            yield batch.line_of(row, number), f"{batch.items['code'][row]:04d}", text


def quarantine(folder: Path, model: Model) -> list[SetAside]:
    """Return the records that ``model``, which has read the journal, set aside."""
    found = []
    names = {number: name for name, number in model.numbers.items()}
    for segment in segments(folder):
        for row in np.flatnonzero(np.isin(segment.records["sequence"], list(model.set_aside))).tolist():
            record = segment.records[row]
            sequence, kind = int(record["sequence"]), int(record["kind"])
            source, reason = names.get(int(record["source"]), ""), model.set_aside[sequence]
            what = KINDS.get(kind, str(kind))
            found.append(SetAside(sequence, int(record["wall"]), source, what, reason, segment.payload(row)))
    return found


def sessions(folder: Path) -> list[tuple[int, str]]:
    """Return (receive time in ns since 1970, configuration) of each session and each later change of configuration."""
    found, last = [], ("", "")
    for segment in segments(folder):
        for row, header in headers(segment):
            this = str(header.get("session", "")), str(header.get("configuration", ""))
            if this != last or not last[0]:
                found.append((int(segment.records["wall"][row]), this[1]))
            last = this
    return found

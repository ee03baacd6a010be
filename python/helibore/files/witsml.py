"""Read WITSML 1.4.1.1 (and 1.3.1.1) logs and trajectories as a stream.

    <logs><log>  <logCurveInfo><mnemonic/><unit/></logCurveInfo> ...     one RawSet a log
                 <logData><mnemonicList/><unitList/><data>1,2,3</data> ...
    <trajectorys><trajectory> <trajectoryStation><md uom="m"/><incl uom="rad"/><azi/> ...   one RawSet a trajectory

Units are read from ``uom`` and kept as written (radians stay radians). Any document type or entity declaration is
refused before the parser gets it. The length of a text, the nesting and the elements of a station are limited.
"""

from __future__ import annotations

import io
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial
from typing import BinaryIO

from helibore.files.number_rows import column_of
from helibore.files.raw_set import Channel, RawFile, RawSet, readable_sets, unique
from helibore.files.source import LINE_LIMIT, Source, file_error

NESTING = 32
"""Greatest depth of nested elements; WITSML needs 6."""

KEPT = ("trajectoryStation", "logCurveInfo")
"""Elements whose children are kept until the element ends; children of all others are freed one by one."""

CHILDREN = 10_000
"""Greatest number of elements within one of ``KEPT``; WITSML has about 60."""

FORBIDDEN = re.compile(rb"<!\s*(DOCTYPE|ENTITY|ELEMENT|ATTLIST|NOTATION)", re.IGNORECASE)
ENCODING = re.compile(rb"""^\s*<\?xml[^>]*encoding\s*=\s*["']([A-Za-z0-9._-]+)["']""")
ENCODINGS = (b"utf-8", b"us-ascii", b"iso-8859-1", b"windows-1252")

# Numbers of a trajectory station that become channels, in the order they are shown.
STATION = ("md", "tvd", "incl", "azi", "mtf", "gtf", "dispNs", "dispEw", "vertSect", "dls", "rateTurn", "rateBuild")


class Checked(io.RawIOBase):
    """Read the bytes of an XML file and check each piece before the parser gets it."""

    def __init__(self, source: Source, stream: BinaryIO) -> None:
        self._source = source
        self._stream = stream
        self._tail = b""
        self._since_tag = 0
        encoding = ENCODING.match(source.head.removeprefix(b"\xef\xbb\xbf"))
        if encoding and encoding[1].lower() not in ENCODINGS:
            raise file_error(source.path, f"encoding {encoding[1].decode()}: must be UTF-8 or ISO-8859-1", 1)

    def readable(self) -> bool:
        return True

    def read(self, size: int = -1) -> bytes:
        piece = self._stream.read(min(size, LINE_LIMIT) if size > 0 else LINE_LIMIT)
        window = self._tail + piece
        if match := FORBIDDEN.search(window):
            what = match[1].decode().upper()
            raise file_error(self._source.path, f"<!{what} ...>: document types and entities are refused")
        self._tail = window[-64:]
        last = piece.rfind(b"<")
        self._since_tag = self._since_tag + len(piece) if last < 0 else len(piece) - last
        if self._since_tag > LINE_LIMIT:
            raise file_error(self._source.path, f"more than {LINE_LIMIT:,} bytes without a tag")
        return piece


@dataclass
class Log:
    """A log under construction."""

    name: str = ""
    index: str = ""
    null: str = ""
    curves: dict[str, tuple[str, str]] = field(default_factory=dict)  # mnemonic -> unit, description
    mnemonics: list[str] = field(default_factory=list)
    units: list[str] = field(default_factory=list)
    rows: list[list[str]] = field(default_factory=list)
    header: dict[str, str] = field(default_factory=dict)


@dataclass
class Trajectory:
    """A trajectory under construction: for each station, (value, uom) by element name."""

    name: str = ""
    stations: list[dict[str, tuple[str, str]]] = field(default_factory=list)
    header: dict[str, str] = field(default_factory=dict)


def read(source: Source, nulls: tuple[float, ...]) -> RawFile:
    """Open a WITSML document of logs or trajectories."""
    found: list[Log | Trajectory] = []
    with source.stream() as stream:
        try:
            for path, element in _elements(source, stream):
                _take(found, path, element)
        except ET.ParseError as error:
            line, character = error.position
            cut = "truncated: " if "no element" in str(error) or "unclosed" in str(error) else ""
            raise file_error(source.path, f"{cut}{error.msg.split(':')[0]} (character {character})", line) from error
        except (LookupError, UnicodeError) as error:
            raise file_error(source.path, f"not in the encoding it declares ({error})") from error
    names = unique([one.name or type(one).__name__.lower() for one in found])
    if not found:
        raise file_error(source.path, "WITSML without a log or trajectory")
    sets = readable_sets(
        partial(_log_set, source, name, one, nulls) if isinstance(one, Log)
        else partial(_trajectory_set, source, name, one, nulls)
        for name, one in zip(names, found, strict=True)
    )  # fmt: skip
    kinds = sorted({type(one).__name__.lower() for one in found})
    return RawFile(f"WITSML {' and '.join(kinds)}", sets)


def _elements(source: Source, stream: BinaryIO) -> Iterator[tuple[list[str], ET.Element]]:
    """Yield (path of local names, element) at every end tag; the caller frees the elements that it has used."""
    path: list[str] = []
    parents: list[ET.Element] = []
    inside = 0
    for event, element in ET.iterparse(Checked(source, stream), events=("start", "end")):
        name = element.tag.rpartition("}")[2]
        if event == "start":
            path.append(name)
            parents.append(element)
            inside = inside + 1 if any(kept in path for kept in KEPT) else 0
            if inside > CHILDREN:
                raise file_error(source.path, f"more than {CHILDREN:,} elements in one {path[2]}")
            if len(path) == 1 and name not in ("logs", "trajectorys", "log", "trajectory"):
                rule = f"<{name}> is no WITSML 1.x document of logs or trajectories (<logs> or <trajectorys>)"
                raise file_error(source.path, rule)
            if len(path) > NESTING:
                raise file_error(source.path, f"elements nested deeper than {NESTING}")
            if name in ("log", "trajectory"):
                yield [*path, "start"], element
        else:
            yield path, element
            path.pop()
            parents.pop()
            if parents and not any(kept in path for kept in KEPT):
                del parents[-1][:]
                inside = 0


def _take(found: list[Log | Trajectory], path: list[str], element: ET.Element) -> None:
    """Copy the needed values from an element, and free it."""
    name = path[-1]
    text = (element.text or "").strip()
    if name == "start":
        found.append(Log() if path[-2] == "log" else Trajectory())
        return
    if not found:
        return
    one = found[-1]
    parent = path[-2] if len(path) > 1 else ""
    if isinstance(one, Trajectory):
        if name == "trajectoryStation":
            one.stations.append(_station(element))
            element.clear()
        elif parent == "trajectory":
            one.header[name] = text
            one.name = text if name == "name" else one.name
        return
    if parent == "log" and name not in ("logCurveInfo", "logData"):
        one.header[name] = text
    if name == "data" and parent == "logData":
        one.rows.append(text.split(","))
        element.clear()
    elif name == "mnemonicList":
        one.mnemonics = [cell.strip() for cell in text.split(",")]
    elif name == "unitList":
        one.units = [cell.strip() for cell in text.split(",")]
    elif name == "logCurveInfo":
        curve = {child.tag.rpartition("}")[2]: (child.text or "").strip() for child in element}
        one.curves[curve.get("mnemonic", "")] = (curve.get("unit", ""), curve.get("curveDescription", ""))
        element.clear()
    elif parent == "log" and name in ("name", "indexCurve", "nullValue"):
        setattr(one, {"name": "name", "indexCurve": "index", "nullValue": "null"}[name], text)


def _station(element: ET.Element) -> dict[str, tuple[str, str]]:
    row = {}
    for child in element:
        name = child.tag.rpartition("}")[2]
        if name in STATION or name in ("dTimStn", "typeTrajStation"):
            row[name] = ((child.text or "").strip(), child.get("uom", ""))
    return row


def _trajectory_set(source: Source, name: str, one: Trajectory, nulls: tuple[float, ...]) -> RawSet:
    if not one.stations:
        raise file_error(source.path, f"trajectory {name!r}: no stations")
    channels = []
    for label in ("dTimStn", "typeTrajStation", *STATION):
        cells = [station.get(label, ("", "")) for station in one.stations]
        if not any(text for text, _ in cells):
            continue
        units = {unit for text, unit in cells if text}
        if len(units) > 1:
            rule = f"units change between stations ({', '.join(sorted(map(repr, units)))})"
            raise file_error(source.path, rule, column=label)
        channels.append(Channel(label, units.pop(), "", column_of([text for text, _ in cells]), nulls))
    return RawSet(source.path, name, channels, len(one.stations), "md", one.header)


def _log_set(source: Source, name: str, one: Log, nulls: tuple[float, ...]) -> RawSet:
    mnemonics = one.mnemonics or list(one.curves)
    if not mnemonics or not one.rows:
        raise file_error(source.path, f"log {name!r}: no {'rows' if mnemonics else 'curves'}")
    if one.units and len(one.units) != len(mnemonics):
        raise file_error(source.path, f"log {name!r}: {len(one.units)} units for {len(mnemonics)} mnemonics")
    for number, row in enumerate(one.rows):
        if len(row) != len(mnemonics):
            rule = f"log {name!r}, row {number}: {len(row)} values where {len(mnemonics)} curves are listed"
            raise file_error(source.path, rule)
    labels = unique(mnemonics)
    if one.null:
        try:
            nulls = (*nulls, float(one.null))
        except ValueError:
            rule, place = "is not a number", f"log {name!r}: nullValue"
            raise file_error(source.path, rule, place, value=repr(one.null[:40])) from None
    channels = []
    for position, label in enumerate(labels):
        unit, described = one.curves.get(mnemonics[position], ("", ""))
        unit = one.units[position] if one.units else unit
        column = column_of([row[position].strip() for row in one.rows])
        channels.append(Channel(label, unit, described, column, nulls))
    index = one.index if one.index in labels else labels[0]
    return RawSet(source.path, name, channels, len(one.rows), index, one.header)

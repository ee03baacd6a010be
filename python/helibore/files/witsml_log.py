"""Read WITSML 1.4.1.1 (and 1.3.1.1) logs and trajectories as a stream; each becomes one RawSet.

    <logs><log>  <logCurveInfo><mnemonic/><unit/><nullValue/></logCurveInfo> ...
                 <logData><mnemonicList/><unitList/><data>1,2,"a text, with a comma"</data> ...
    <trajectorys><trajectory> <trajectoryStation><md uom="m"/><incl uom="rad"/><azi/> ...

Units are kept as written (radians stay radians). Any document type or entity declaration is refused before the parser
reads it. The length of a text, the depth of nesting, and the number of elements in a station or curve are limited.
"""

from __future__ import annotations

import io
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from functools import partial
from typing import BinaryIO

from helibore.base.errors import InputError
from helibore.files.input_file import LINE_LIMIT, InputFile
from helibore.files.number_rows import column_of, split_cells
from helibore.files.raw_set import Channel, RawFile, RawSet, readable_sets, unique

NESTING = 32
"""Greatest depth of nested elements; WITSML needs 6."""

KEPT = ("trajectoryStation", "logCurveInfo")
"""Elements whose children are kept until the element itself ends; other elements are freed at once."""

CHILDREN = 10_000
"""Greatest number of elements within one element of ``KEPT``; WITSML has about 60."""

FORBIDDEN = re.compile(rb"<!\s*(DOCTYPE|ENTITY|ELEMENT|ATTLIST|NOTATION)", re.IGNORECASE)
ENCODING = re.compile(rb"""^\s*<\?xml[^>]*encoding\s*=\s*["']([A-Za-z0-9._-]+)["']""")
ENCODINGS = (b"utf-8", b"us-ascii", b"iso-8859-1", b"windows-1252")

STATION = (
    "dTimStn", "typeTrajStation", "md", "tvd", "incl", "azi", "mtf", "gtf", "dispNs", "dispEw", "vertSect", "dls",
    "rateTurn", "rateBuild",
)  # fmt: skip
"""Elements of a trajectory station that become channels, in this order."""


class Checked(io.RawIOBase):
    """The bytes of an XML file as a stream; each piece is checked before the parser reads it."""

    def __init__(self, source: InputFile, stream: BinaryIO) -> None:
        self._source = source
        self._stream = stream
        self._tail = b""
        self._since_tag = 0
        encoding = ENCODING.match(source.head.removeprefix(b"\xef\xbb\xbf"))
        if encoding and encoding[1].lower() not in ENCODINGS:
            rule = "must be UTF-8, US-ASCII, ISO-8859-1 or Windows-1252"
            raise source.error(f"encoding {encoding[1].decode()}: {rule}", 1)

    def readable(self) -> bool:
        return True

    def read(self, size: int = -1) -> bytes:
        piece = self._stream.read(min(size, LINE_LIMIT) if size > 0 else LINE_LIMIT)
        window = self._tail + piece
        if match := FORBIDDEN.search(window):
            what = match[1].decode().upper()
            raise self._source.error(f"<!{what} ...>: document types and entities are refused")
        self._tail = window[-64:]
        last = piece.rfind(b"<")
        self._since_tag = self._since_tag + len(piece) if last < 0 else len(piece) - last
        if self._since_tag > LINE_LIMIT:
            raise self._source.error(f"more than {LINE_LIMIT:,} bytes without a tag")
        return piece


class LogBuilder:
    """Values of one log, collected while the file is read.

    ``header`` holds the texts of name, indexCurve, nullValue and other elements of the log.
    """

    kind = "log"

    def __init__(self) -> None:
        self.header: dict[str, str] = {}
        self.curves: dict[str, dict[str, str]] = {}  # mnemonic -> unit, curveDescription, nullValue ...
        self.mnemonics: list[str] = []
        self.units: list[str] = []
        self.rows: list[list[str]] = []

    def take(self, name: str, parent: str, element: ET.Element) -> None:
        """Copy the needed values from an element, and free its memory."""
        text = (element.text or "").strip()
        if parent == "log" and name not in ("logCurveInfo", "logData"):
            self.header[name] = text
        if name == "data" and parent == "logData":
            self.rows.append(split_cells(text, ","))
            element.clear()
        elif name == "mnemonicList":
            self.mnemonics = [cell.strip() for cell in text.split(",")]
        elif name == "unitList":
            self.units = [cell.strip() for cell in text.split(",")]
        elif name == "logCurveInfo":
            curve = {child.tag.rpartition("}")[2]: (child.text or "").strip() for child in element}
            self.curves[curve.get("mnemonic", "")] = curve
            element.clear()

    def raw_set(self, source: InputFile, name: str) -> RawSet:
        mnemonics, place = self.mnemonics or list(self.curves), f"log {name!r}"
        if not mnemonics or not self.rows:
            raise source.error(f"{place}: no {'rows' if mnemonics else 'curves'}")
        if self.units and len(self.units) != len(mnemonics):
            raise source.error(f"{place}: {len(self.units)} units for {len(mnemonics)} mnemonics")
        for number, row in enumerate(self.rows):
            if len(row) != len(mnemonics):
                rule = f"{len(row)} values where {len(mnemonics)} curves are listed"
                raise source.error(f"{place}, row {number}: {rule}")
        common = source.nulls + _null(source, place, self.header)
        channels = []
        for position, label in enumerate(unique(mnemonics)):
            curve = self.curves.get(mnemonics[position], {})
            unit = self.units[position] if self.units else curve.get("unit", "")
            column = column_of([row[position].strip() for row in self.rows])
            nulls = common + _null(source, f"{place}: {label}", curve)
            channels.append(Channel(label, unit, curve.get("curveDescription", ""), column, nulls))
        index, labels = self.header.get("indexCurve", ""), [channel.name for channel in channels]
        index = index if index in labels else labels[0]
        return RawSet(source.path, name, channels, len(self.rows), index, self.header)


def _null(source: InputFile, place: str, stated: dict[str, str]) -> tuple[float, ...]:
    """Return the nullValue of a log or curve as a tuple of one number; () if none is stated."""
    null = stated.get("nullValue")
    try:
        return (float(null),) if null else ()
    except ValueError:
        raise source.error("is not a number", f"{place}: nullValue", value=repr(str(null)[:40])) from None


class TrajectoryBuilder:
    """Values of one trajectory, collected while the file is read: for each station, (value, uom) by element name."""

    kind = "trajectory"

    def __init__(self) -> None:
        self.header: dict[str, str] = {}
        self.stations: list[dict[str, tuple[str, str]]] = []

    def take(self, name: str, parent: str, element: ET.Element) -> None:
        """Copy the needed values from an element, and free its memory."""
        if name == "trajectoryStation":
            cells = {
                child.tag.rpartition("}")[2]: ((child.text or "").strip(), child.get("uom", "")) for child in element
            }
            self.stations.append({label: cells[label] for label in STATION if label in cells})
            element.clear()
        elif parent == "trajectory":
            self.header[name] = (element.text or "").strip()

    def raw_set(self, source: InputFile, name: str) -> RawSet:
        if not self.stations:
            raise source.error(f"trajectory {name!r}: no stations")
        channels = []
        for label in STATION:
            cells = [station.get(label, ("", "")) for station in self.stations]
            units = {unit for text, unit in cells if text}
            if len(units) > 1:
                rule = f"units change between stations ({', '.join(sorted(map(repr, units)))})"
                raise source.error(rule, column=label)
            if units:
                channels.append(Channel(label, units.pop(), "", column_of([text for text, _ in cells]), source.nulls))
        return RawSet(source.path, name, channels, len(self.stations), "md", self.header)


def read(source: InputFile) -> RawFile:
    """Open a WITSML document of logs or trajectories."""
    found: list[LogBuilder | TrajectoryBuilder] = []
    with source.stream() as stream:
        try:
            for path, element in _elements(source, stream):
                if path[-1] == "start":
                    found.append(LogBuilder() if path[-2] == "log" else TrajectoryBuilder())
                elif found:
                    found[-1].take(path[-1], path[-2] if len(path) > 1 else "", element)
        except ET.ParseError as error:
            line, character = error.position
            cut = "truncated: " if "no element" in str(error) or "unclosed" in str(error) else ""
            raise source.error(f"{cut}{error.msg.split(':')[0]} (character {character})", line) from error
        except InputError:
            raise
        except (LookupError, ValueError) as error:
            raise source.error(f"not in the encoding it declares ({error})") from error
    names = unique([one.header.get("name") or one.kind for one in found])
    if not found:
        raise source.error("WITSML without a log or trajectory")
    readers = [partial(one.raw_set, source, name) for name, one in zip(names, found, strict=True)]
    kinds = sorted({one.kind for one in found})
    return RawFile(f"WITSML {' and '.join(kinds)}", readable_sets(readers))


def _elements(source: InputFile, stream: BinaryIO) -> Iterator[tuple[list[str], ET.Element]]:
    """Yield (path, element) at every end tag; path has the local names from the root to the element.

    At the start tag of a log or trajectory, yield its path with "start" added. Each element is freed after it is
    yielded, except those within an element of ``KEPT``: these are freed together with the element of ``KEPT``.
    """
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
                kept = next(name for name in path if name in KEPT)
                raise source.error(f"more than {CHILDREN:,} elements in one {kept}")
            if len(path) == 1 and name not in ("logs", "trajectorys", "log", "trajectory"):
                rule = f"<{name}> is no WITSML 1.x document of logs or trajectories (<logs> or <trajectorys>)"
                raise source.error(rule)
            if len(path) > NESTING:
                raise source.error(f"elements nested deeper than {NESTING}")
            if name in ("log", "trajectory"):
                yield [*path, "start"], element
        else:
            yield path, element
            path.pop()
            parents.pop()
            if parents and not any(kept in path for kept in KEPT):
                del parents[-1][:]
                inside = 0

"""Write queries for a WITSML 1.4.1.1 store (SOAP), read its answers, and frame them for the journal.

    question:  WMLS_GetFromStore(WMLtypeIn, QueryIn, OptionsIn)   ->   answer: Result, XMLout, SuppMsgOut

    journal:   "WITSML log whole 1234\\n" + 1234 bytes as they came   |   "WITSML trajectory same 0\\n"   |   ...

An answer equal to the previous one is stored as "same" without its bytes. An answer that was cut off ("cut") or must
not be read ("refused": not 200, compressed, too long) is stored as far as it came, but is not read. Document types and
entities are refused before an XML parser gets them. This file limits the nesting of elements, and ``store.py`` limits
the size of an answer.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, cast
from xml.sax.saxutils import escape, quoteattr

ACTION = "http://www.witsml.org/action/120/Store.WMLS_GetFromStore"
SERIES = 'xmlns="http://www.witsml.org/schemas/1series" version="1.4.1.1"'
PARTIAL = 2
"""The Result of an answer in which the store sent only some rows; another query gets the other rows."""
NESTING = 32
BLOCK = 1 << 16

FORBIDDEN = re.compile(r"<!\s*(DOCTYPE|ENTITY|ELEMENT|ATTLIST|NOTATION)", re.IGNORECASE)
HEAD = re.compile(rb"WITSML (log|trajectory) (whole|cut|same|refused) (\d{1,9})\n")
LONGEST_HEAD = 40
HEAD_START = b"WITSML "


@dataclass(frozen=True)
class Answer:
    """The answer of a store: ``result`` (negative if it is an error), the message, and the document as text."""

    result: int
    message: str
    document: str


@dataclass
class LogRows:
    """The rows of an answer about a log; each row is a text of cells with commas between them.

    ``mnemonics`` and ``units`` have an entry for each cell. There are no rows if the log has not grown. ``null`` is the
    nullValue of the log, and ``direction`` is its direction; "" if the answer does not state them.
    """

    mnemonics: list[str] = field(default_factory=list)
    units: list[str] = field(default_factory=list)
    rows: list[str] = field(default_factory=list)
    null: str = ""
    direction: str = ""


def log_query(uids: tuple[str, str, str], start: tuple[str, str] | None) -> str:
    """Return the query for the rows of a log from the index ``start`` (text, unit) on; if None, for all rows.

    The unit "" means that the index is a time.
    """
    within = ""
    if start is not None and start[1]:
        within = f"<startIndex uom={quoteattr(start[1])}>{escape(start[0])}</startIndex>"
    elif start is not None:
        within = f"<startDateTimeIndex>{escape(start[0])}</startDateTimeIndex>"
    return f"<logs {SERIES}><log {_uids(uids)}>{within}</log></logs>"


def trajectory_query(uids: tuple[str, str, str]) -> str:
    """Return the query for a whole trajectory, because it has few stations and a store may correct each of them."""
    return f"<trajectorys {SERIES}><trajectory {_uids(uids)}/></trajectorys>"


def _uids(uids: tuple[str, str, str]) -> str:
    return " ".join(
        f"{name}={quoteattr(uid)}" for name, uid in zip(("uidWell", "uidWellbore", "uid"), uids, strict=True)
    )


def envelope(kind: str, query: str, options: str) -> bytes:
    """Return the SOAP request for ``query``."""
    return (
        '<?xml version="1.0" encoding="UTF-8"?>'
        '<soap:Envelope xmlns:soap="http://schemas.xmlsoap.org/soap/envelope/"><soap:Body>'
        '<q:WMLS_GetFromStore xmlns:q="http://www.witsml.org/message/120">'
        f"<WMLtypeIn>{kind}</WMLtypeIn><QueryIn>{escape(query)}</QueryIn>"
        f"<OptionsIn>{escape(options)}</OptionsIn><CapabilitiesIn/>"
        "</q:WMLS_GetFromStore></soap:Body></soap:Envelope>"
    ).encode()


def read_answer(body: bytes) -> Answer:
    """Return the answer in a SOAP envelope.

    Raises
    ------
    ValueError
        If ``body`` is not UTF-8 or not XML, declares a document type or entity, nests elements deeper than NESTING,
        reports a SOAP fault, or has no result.
    """
    try:
        text = body.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ValueError(f"byte {error.start} of the answer is not UTF-8") from None
    found: dict[str, str] = {}
    for path, element in _elements(text):
        if path[-1] in ("Result", "XMLout", "SuppMsgOut", "faultstring"):
            found[path[-1]] = element.text or ""
    if "faultstring" in found:
        raise ValueError(f"SOAP fault: {_short(found['faultstring'])}")
    if not re.fullmatch(r"\s*-?\d{1,6}\s*", found.get("Result", "")):
        raise ValueError(f"Result = {_short(found.get('Result', ''))!r}: must be a whole number")
    return Answer(int(found["Result"]), _short(found.get("SuppMsgOut", "")), found.get("XMLout", ""))


def _short(text: str) -> str:
    return " ".join(text.split())[:200]


def _elements(text: str, whole: str = "") -> Iterator[tuple[list[str], ET.Element]]:
    """Yield (path, element) at every end tag of an XML text; path has the local names from the root to the element.

    Each element is deleted after it is yielded, because all elements of a log together would take 24 times the size of
    its text. Only elements inside an element named ``whole`` stay until that element is yielded.
    """
    if match := FORBIDDEN.search(text):
        raise ValueError(f"<!{match[1].upper()} ...>: document types and entities are refused")
    path: list[str] = []
    opened: list[ET.Element] = []
    parser: ET.XMLPullParser[Any] = ET.XMLPullParser(("start", "end"))
    text = text.lstrip()
    try:
        for start in range(0, len(text) + 1, BLOCK):
            parser.feed(text[start : start + BLOCK])  # already decoded, so its encoding declaration does not matter
            for event, element in cast("Iterator[tuple[str, ET.Element]]", parser.read_events()):
                if event == "start":
                    path.append(element.tag.rpartition("}")[2])
                    opened.append(element)
                    if len(path) > NESTING:
                        raise ValueError(f"elements nested deeper than {NESTING}")
                    continue
                yield path, element
                path.pop()
                opened.pop()
                if opened and whole not in path:
                    del opened[-1][-1]
        parser.close()
    except ET.ParseError as error:
        raise ValueError(f"is not XML: {error}") from None


def read_log(document: str) -> LogRows:
    """Return the rows of the log in ``document`` as texts.

    Raises
    ------
    ValueError
        If ``document`` is not the XML of logs, or if the units or the cells of a row are not as many as the mnemonics.
    """
    log = LogRows()
    described: list[tuple[str, str]] = []
    columns: list[str] = []
    if not document.strip():
        return log
    for path, element in _elements(document, "logCurveInfo"):
        name, text = path[-1], (element.text or "").strip()
        if len(path) == 1 and name != "logs":
            raise ValueError(f"<{name}>: must be <logs>")
        if name == "data":
            log.rows.append(text)
        elif name == "mnemonicList":
            log.mnemonics = _cells(text)
        elif name == "unitList":
            log.units = _cells(text)
        elif name == "logCurveInfo":
            children = {child.tag.rpartition("}")[2]: (child.text or "").strip() for child in element}
            described.append((children.get("mnemonic", ""), children.get("unit", "")))
            columns.append(children.get("columnIndex", ""))
        elif name == "nullValue" and path[-2] == "log":
            log.null = text
        elif name == "direction":
            log.direction = text
    if not log.mnemonics:
        if columns and all(column.isdecimal() for column in columns):  # WITSML 1.3.1.1: in any order, with columns
            order = sorted(range(len(columns)), key=lambda place: int(columns[place]))
            described = [described[place] for place in order]
        log.mnemonics, log.units = [name for name, _ in described], [unit for _, unit in described]
    log.units = log.units or [dict(described).get(name, "") for name in log.mnemonics]
    if len(log.units) != len(log.mnemonics):
        raise ValueError(f"{len(log.units)} units for {len(log.mnemonics)} mnemonics")
    for number, row in enumerate(log.rows, 1):
        if (cells := row.count(",") + 1) != len(log.mnemonics):
            raise ValueError(f"row {number}: {cells} values for {len(log.mnemonics)} mnemonics")
    return log


def _cells(text: str) -> list[str]:
    return [cell.strip() for cell in text.split(",")] if text else []


def read_stations(document: str) -> list[tuple[tuple[str, str], ...]]:
    """Return for each station of a trajectory the (text, unit) of its md, incl and azi; ("", "") for a missing value.

    Raises
    ------
    ValueError
        If ``document`` is not the XML of trajectories.
    """
    stations: list[tuple[tuple[str, str], ...]] = []
    if not document.strip():
        return stations
    for path, element in _elements(document, "trajectoryStation"):
        if len(path) == 1 and path[-1] != "trajectorys":
            raise ValueError(f"<{path[-1]}>: must be <trajectorys>")
        if path[-1] == "trajectoryStation":
            cells = {child.tag.rpartition("}")[2]: ((child.text or "").strip(), child.get("uom", ""))
                     for child in element}  # fmt: skip
            stations.append(tuple(cells.get(name, ("", "")) for name in ("md", "incl", "azi")))
    return stations


def framed(kind: str, state: str, body: bytes = b"") -> bytes:
    """Return the bytes that the journal stores of an answer: a line with the answer's kind and state, then ``body``."""
    return b"WITSML %s %s %d\n" % (kind.encode(), state.encode(), len(body)) + body


class Frames:
    """Splits the bytes in the journal into answers; a record may end anywhere in an answer."""

    STATE = ("_held",)

    def __init__(self) -> None:
        self._held = bytearray()

    def feed(self, piece: bytes) -> tuple[list[tuple[str, str, bytes]], int]:
        """Return (kind, state, body) of each answer that ``piece`` completes, and the number of bytes outside answers.

        Bytes outside answers come from a damaged journal.
        """
        self._held += piece
        held, found, stray = self._held, [], 0
        while held:
            head = HEAD.match(held)
            if head is None:
                if b"\n" not in held[:LONGEST_HEAD] and len(held) < LONGEST_HEAD and HEAD_START.startswith(held[:7]):
                    break  # the head is not complete yet
                after = held.find(HEAD_START, 1)
                lost = after if after > 0 else max(len(held) - len(HEAD_START), 1)
                stray += lost
                del held[:lost]
                continue
            stop = head.end() + int(head[3])
            if len(held) < stop:
                break
            found.append((head[1].decode(), head[2].decode(), bytes(held[head.end() : stop])))
            del held[:stop]
        return found, stray

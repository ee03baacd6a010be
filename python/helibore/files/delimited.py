"""Read tables separated by commas, tabs, semicolons, bars or blanks, plain or gzipped.

    # comment lines                      kept as remarks
    depth_m,toolface_deg,radius_mm       the header; the next line may state the units
    1000.0,12.5,108.1

``number_rows`` reads tables of up to 2 MiB. If pyarrow is installed, it reads larger tables with all cores. If pyarrow
refuses a table, or takes numbers for text, ``number_rows`` reads the table or names the bad line. An empty cell is a
missing value; NaN and infinities count as computed numbers. Blanks may separate the columns, too, and a first line
``sep=;`` states the delimiter. `number_spellings` reads decimal commas, marks of thousands and angles.
Units come from the units row below the header if there is one, else from the column names (``headings``).
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from itertools import dropwhile, islice
from types import ModuleType
from typing import Any

import numpy as np

from helibore.base.arrays import Array
from helibore.base.errors import InputError
from helibore.base.limits import check_limit
from helibore.files.facts import read_facts
from helibore.files.headings import is_number, is_units_row, unit_in_name
from helibore.files.input_file import LINE_LIMIT, InputFile, decode
from helibore.files.number_rows import NULL_TEXTS, column_of, read_rows, split_cells
from helibore.files.number_spellings import read_spellings
from helibore.files.raw_set import EXACT, Channel, RawFile, RawSet, unique

STATED_DELIMITER = re.compile(r"\s*sep=(?P<mark>[,;|\t])\s*", re.IGNORECASE)
"""First line of a table in which Excel states the delimiter."""

DELIMITERS = (",", "\t", ";", "|")
BLANKS = tuple(" " * count for count in range(1, 17))

HEADING_LINES = 500
"""The header must be within this many lines from the start of the file."""

NO_HEADER = "numbers, so there is no header"
"""Part of the remark on a table without a header."""

COMMENT = "comment: "
"""Start of the remark on a comment line above the header."""

_AROUND_COMMENT = " #\t"
_AROUND_TITLE = " \t\r,;|"
MOST_TITLES = 20
"""The most lines with text above the names of the columns that are taken for titles."""

PETREL = {
    re.compile(r"WELL (KB|DATUM)\b.*:\s*[-+\d.]+\s*\((?P<unit>m|ft)\)", re.IGNORECASE): ("MD", "TVD"),
    re.compile(r"ANGLES ARE GIVEN IN (?P<unit>DEG)REES", re.IGNORECASE): ("AZIM", "AZIM_TN", "AZIM_GN", "INCL"),
}
"""Comments of a Petrel trace (.dev) that state a unit, and the columns which it is the unit of."""

FEWEST_SECTORS = 4
"""The least number of columns that can form an image."""


@dataclass
class TableLayout:
    """The layout of a table: delimiter (None: blanks), column names, units, and the number of lines above the rows."""

    delimiter: str | None
    names: list[str]
    units: list[str] | None
    skip: int
    remarks: list[str] = field(default_factory=list)


def read(source: InputFile) -> RawFile:
    """Open a delimited table."""
    head, remark, whole = _head_text(source)
    layout = find_layout(source, head)
    if remark:
        layout.remarks.append(remark)
    check_limit(source.path.name, "columns", len(layout.names))
    names = unique(layout.names)
    for name, count in Counter(layout.names).items():
        if 1 < count < FEWEST_SECTORS:
            layout.remarks.append(f"{count} columns are named {name}: they are called {name}:1, {name}:2 ...")
    columns = (
        None if whole or layout.delimiter is None else _by_pyarrow(source, layout, head, "cp1252" if remark else "utf8")
    )
    line_of = _line_finder(source, layout)
    if columns is None:
        text, found_later = (head, "") if whole else source.text()
        if found_later and not remark:  # the text is not UTF-8 below the first 2 MiB
            layout.remarks.append(found_later)
        below, salvage = "".join(text.split("\n", layout.skip)[layout.skip :]), source.options.salvage
        found = read_rows(source.path, below, layout.skip + 1, names, layout.delimiter, salvage=salvage)
        columns, line_of = found.columns, found.line_of
        layout.remarks += found.remarks
    columns, units_of_texts, remarks = read_spellings(columns, names, layout.delimiter == ",", source.options.decimal)
    layout.remarks += remarks
    stated = _units_of_comments(layout)
    channels = []
    for position, (name, values) in enumerate(zip(names, columns, strict=True)):
        unit = layout.units[position] if layout.units else unit_in_name(layout.names[position])
        unit = unit or units_of_texts.get(position, "") or stated.get(name.upper(), "")
        channels.append(Channel(name, unit, "", values, source.nulls, nan_is_missing=False))
    rows = len(columns[0])
    comments = [remark.removeprefix(COMMENT).partition(":") for remark in layout.remarks if remark.startswith(COMMENT)]
    header = {name.strip(): text.strip() for name, colon, text in comments if colon}
    facts, remark = read_facts(source.path)
    layout.remarks += [remark] if remark else []
    header |= facts
    return RawFile("csv", [RawSet(source.path, "table", channels, rows, None, header, layout.remarks, line_of)])


def _units_of_comments(layout: TableLayout) -> dict[str, str]:
    """Return the units by column that the comments of a Petrel trace state, and add a remark on them."""
    found: dict[str, str] = {}
    for remark in layout.remarks:
        for pattern, columns in PETREL.items():
            if match := pattern.search(remark):
                found |= dict.fromkeys(columns, match["unit"].lower())
    found = {name: unit for name, unit in found.items() if name in (each.upper() for each in layout.names)}
    if found:
        listed = ", ".join(f"{name} in {unit}" for name, unit in found.items())
        layout.remarks.append(f"units as the comments state them: {listed}")
    return found


def _head_text(source: InputFile) -> tuple[str, str, bool]:
    """Return the whole lines in the first 2 MiB of a file, a remark on their encoding, and whether the file ends there.

    The remark is "" for UTF-8.
    """
    with source.stream() as stream:
        head = stream.read(2 * LINE_LIMIT)
        more = bool(stream.read(1))
    if more:
        end = head.rfind(b"\n")
        if end < 0:
            raise source.line_too_long(1)
        if len(head) - end > LINE_LIMIT:
            raise source.line_too_long(head.count(b"\n") + 1)
        head = head[: end + 1]
    return *decode(source.path, head), not more


def find_layout(source: InputFile, head: str) -> TableLayout:
    """Find delimiter, header and units row in the first lines of a file.

    Raise an InputError if the file is no table, or if the stated header line is not a line with text.
    """
    remarks = []
    lines = head.split("\n", HEADING_LINES)[:HEADING_LINES]
    start, header_line = 0, source.options.header_line
    stated = STATED_DELIMITER.fullmatch(lines[0])
    if stated:
        start = 1
    if header_line is not None:
        start = header_line - 1
        if not 0 <= start < len(lines) or not lines[start].strip():
            rule = f"must be the line of the column names, within the first {HEADING_LINES}"
            raise InputError(f"{source.path.name}: header_line", rule, str(header_line))
    while header_line is None and start < len(lines) and lines[start].lstrip()[:1] in ("", "#"):
        if comment := lines[start].strip(_AROUND_COMMENT):
            remarks.append(f"{COMMENT}{comment}")
        start += 1
    filled = [line for line in lines[start:] if line.strip()]
    if not filled:
        raise source.error(f"no header and no rows within {HEADING_LINES} lines", start)
    titles = [] if stated or header_line is not None else _titles(filled)
    remarks += [f"{COMMENT}{title.strip(_AROUND_TITLE)}" for title in titles]
    filled = filled[len(titles) :]
    start = lines.index(filled[0], start)
    rows = [
        filled[0],
        *dropwhile(lambda line: line.startswith("#"), filled[1:]),
    ]  # Petrel underlines its header by #===
    delimiter = stated["mark"] if stated else _delimiter(source, rows, start + 1)
    header = rows[0].lstrip("#")
    if delimiter is None:
        first = _names_between_blanks(header, len(rows[-1].split()))
    else:
        first = [cell.strip() for cell in split_cells(header, delimiter)]
    second = [cell.strip() for cell in split_cells(rows[1], delimiter)] if len(rows) > 1 else []
    if header_line is None and all(is_number(cell) for cell in first):
        return _without_header(lines, start, delimiter, len(first), remarks)
    if any(not cell for cell in first) and not first[-1] and second and not second[-1]:
        remarks.append("the header and the rows end in a delimiter: the last column has no name")
    names = [cell or f"column {number}" for number, cell in enumerate(first, 1)]
    units = None
    skip = lines.index(rows[1], start + 1) if len(rows) > 1 else lines.index(rows[0], start) + 1
    if len(second) == len(names) and is_units_row(second):
        units = [cell.strip("()[] ") for cell in second]
        skip = lines.index(rows[1], skip) + 1
    return TableLayout(delimiter, names, units, skip, remarks)


def _titles(lines: list[str]) -> list[str]:
    """Return the lines above the names of the columns (``Well: A-7``): a delimiter cuts only what follows evenly.

    The names are the first line of that, and none of them is a number or empty.
    """
    for count in range(min(MOST_TITLES + 1, len(lines) - 2)):
        for mark in DELIMITERS:
            cells = [split_cells(line, mark) for line in lines[count : count + 20]]
            if len(cells[0]) > 1 and len({len(row) for row in cells}) == 1:
                named = not any(is_number(cell) or not cell.strip() for cell in cells[0])
                return lines[:count] if named else []
    return _titles_between_blanks(lines[: MOST_TITLES + 20])


def _titles_between_blanks(lines: list[str]) -> list[str]:
    """Return the lines above the names of columns that blanks separate, as programs print surveys and logs.

    The rows are the first lines that begin with a number and have equally many cells; above them stand the names, and
    perhaps a row of units between.
    """
    likely = [line.strip()[:1].isdigit() or line.strip()[:2].lstrip("+-.")[:1].isdigit() for line in lines]
    first = next((at for at in range(1, len(lines)) if all(likely[at:]) and len(lines[at].split()) > 1), None)
    if first is None or len({len(line.split()) for line in lines[first:]}) > 1:
        return []
    width = len(lines[first].split())
    names = first - 1
    if names and is_units_row(lines[names].split()) and len(lines[names].split()) == width:
        names -= 1
    above = _names_between_blanks(lines[names], width)
    return lines[:names] if len(above) == width and not any(map(is_number, above)) else []


def _names_between_blanks(header: str, width: int) -> list[str]:
    """Return the names of a header whose columns blanks separate; a name may hold a blank: ``MD (m)``.

    Of the ways to cut it, the first counts that gives ``width`` names: at every blank, but not before a bracket, or at
    two blanks and more.
    """
    cuts = (header.split(), re.findall(r"\S+(?: [\[(][^\])]*[\])])?", header), re.split(r"\s{2,}|\t", header.strip()))
    return next((names for names in cuts if len(names) == width), cuts[0])


def _without_header(lines: list[str], start: int, delimiter: str | None, width: int, remarks: list[str]) -> TableLayout:
    """Return the layout of a table without a header.

    The last comment line above the rows that has ``width`` names, two or more, names the columns. If there is no such
    comment line, the columns are named by number.
    """
    for line in reversed(lines[:start]):
        names = [cell.strip() for cell in split_cells(line.strip().lstrip("#"), delimiter)]
        if len(names) == width and width > 1 and all(names):
            remarks = [remark for remark in remarks if remark != f"{COMMENT}{line.strip(_AROUND_COMMENT)}"]
            return TableLayout(delimiter, names, None, start, [*remarks, "the header is a comment line"])
    remarks = [*remarks, f"line {start + 1}: {NO_HEADER}: columns are named by their number"]
    return TableLayout(delimiter, [f"column {number}" for number in range(1, width + 1)], None, start, remarks)


def _delimiter(source: InputFile, rows: list[str], line: int) -> str | None:
    """Return the delimiter that splits each of the first 20 rows into the same number of cells, at least two.

    If no delimiter does this, blanks (None) separate the columns if they cut header and rows into as many cells. Else
    return the delimiter that splits the header into the most cells. If no delimiter splits the header, return a comma
    if the table is one column, a name above numbers; else raise an InputError.
    """
    sample = rows[:20]
    widths = {mark: [len(split_cells(row, mark)) for row in sample] for mark in DELIMITERS}
    even = [mark for mark in DELIMITERS if widths[mark][0] > 1 and len(set(widths[mark])) == 1]
    if len(even) > 1:  # comma and semicolon split "1,5;2,5" evenly: a decimal comma
        even = [mark for mark in even if not (mark == "," and ";" in even)]
        even.sort(key=lambda mark: -widths[mark][0])
    if even:
        return even[0]
    by_blanks = {len(row.split()) for row in sample[1:]}
    if len(by_blanks) == 1 and (width := by_blanks.pop()) > 1 and len(_names_between_blanks(sample[0], width)) == width:
        return None
    likely = max(DELIMITERS, key=lambda mark: widths[mark][0])
    if widths[likely][0] > 1:
        return likely  # rows of different widths: number_rows names the bad row
    if len(sample) > 1 and len(rows[0].split()) > 1:
        rule = "blanks separate the columns: as many names as cells must be there, or a delimiter"
        raise source.error(rule, line)
    if len(sample) > 1 and max(max(width) for width in widths.values()) > 1:
        raise source.error("the header has one column, the rows have more: another delimiter?", line)
    if len(sample) > 1 and all(is_number(row) for row in sample[1:]):
        return ","  # one column of numbers under a name
    raise source.error("not a table: no comma, tab, semicolon or | separates columns", line)


def _by_pyarrow(source: InputFile, layout: TableLayout, head: str, encoding: str) -> list[Array] | None:
    """Read the columns with pyarrow. Return None if pyarrow is not installed or may read wrong values.

    The first 2 MiB decide the types of the columns, so that the types do not depend on how pyarrow cuts the table.
    """
    try:
        import pyarrow as pa
        from pyarrow import compute, csv
    except ImportError:
        return None
    try:
        sample = _rows(csv, _copied(pa, head.encode()), layout, layout.skip)
        if not sample.num_rows:
            return None
        types = {name: _column_type(pa, sample.column(name)) for name in sample.column_names}
        for column in sample.columns:  # " NULL" or 1.#QNAN turns a column of numbers into text
            if column.type == pa.string() and column_of(column.fill_null("").to_pylist()).dtype.kind != "U":
                return None
        if encoding == "utf8" and source.as_stored:
            table = _rows(csv, str(source.path), layout, layout.skip, types)
        else:
            table = _unpacked(pa, csv, source, layout, encoding, types)
    except (pa.ArrowInvalid, UnicodeDecodeError):
        return None
    for name, kind in types.items():  # after an unclosed quote, pyarrow reads several rows as one cell
        if kind == pa.string() and compute.any(compute.match_substring(table.column(name), "\n")).as_py():
            return None
    return [
        np.ma.MaskedArray(column.to_numpy(), column.is_null().to_numpy())
        if column.null_count and types[name] != pa.string()
        else column.to_numpy()
        for name, column in zip(types, table.columns, strict=True)
    ]


def _rows(csv: Any, content: Any, layout: TableLayout, skip: int, types: dict[str, Any] | None = None) -> Any:
    """Return the rows below the first ``skip`` lines as a ``pyarrow.Table``.

    Its columns are called "0", "1" ..., because pyarrow refuses repeated names.
    """
    numbered = [str(position) for position in range(len(layout.names))]
    return csv.read_csv(
        content,
        csv.ReadOptions(skip_rows=skip, column_names=numbered, block_size=LINE_LIMIT),
        csv.ParseOptions(delimiter=layout.delimiter, newlines_in_values=False),
        csv.ConvertOptions(
            null_values=[*NULL_TEXTS, *BLANKS], column_types=types, strings_can_be_null=True, timestamp_parsers=[]
        ),
    )


def _copied(pa: ModuleType, text: bytes) -> Any:
    """Copy the text into memory that pyarrow owns.

    If a Python object held the text, pyarrow's threads would call Python to free it. They would do so even after an
    error, and abort a process that ends at that time.
    """
    memory = pa.BufferOutputStream()
    memory.write(text)
    return pa.BufferReader(memory.getvalue())


def _unpacked(
    pa: ModuleType, csv: Any, source: InputFile, layout: TableLayout, encoding: str, types: dict[str, Any]
) -> Any:
    """Read a table that must be unpacked or decoded.

    A second thread parses a piece while this thread unpacks the next piece.
    """
    parts: list[Future[Any]] = []
    with ThreadPoolExecutor(1) as beside:
        for piece in source.pieces():
            text = piece if encoding == "utf8" else piece.decode(encoding).encode()
            skip = 0 if parts else layout.skip
            if parts:
                parts[-1].result()
            parts.append(beside.submit(_rows, csv, _copied(pa, text), layout, skip, types))
    return pa.concat_tables(part.result() for part in parts)


def _column_type(pa: ModuleType, column: Any) -> Any:
    kind = column.type
    if pa.types.is_integer(kind):
        import pyarrow.compute as pc

        both = pc.min_max(column).as_py()
        low, high = both["min"] or 0, both["max"] or 0
        return pa.int64() if max(abs(low), abs(high)) >= EXACT else pa.float64()
    if pa.types.is_floating(kind) or pa.types.is_null(kind):
        return pa.float64()
    return pa.string()


def _line_finder(source: InputFile, layout: TableLayout) -> Callable[[int], int]:
    """Return a function that returns the line of a row. Each call reads the file again, so only errors call it."""

    def line_of(row: int) -> int:
        rows = (line for line, raw in enumerate(source.lines(), 1) if line > layout.skip and raw.strip())
        return next(islice(rows, row, None))

    return line_of

"""CSV, TSV and semicolon tables, plain or gzipped, read with pyarrow where it pays (``cells`` reads the others).

    # comment lines                      kept as remarks
    depth_m,toolface_deg,radius_mm       the header; a second line of units is taken as such
    1000.0,12.5,108.1

A column is numbers when everything in its first 2 MiB is; a cell that is not a number after that is an error that names
its line. An empty cell is missing; NaN and infinities are numbers that somebody computed. Decimal commas and
blank-separated columns are refused, not guessed. Units come from the header (``helibore.files.headings``).
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from itertools import islice
from types import ModuleType
from typing import Any

import numpy as np

from helibore.files.cells import NULL_TEXTS, ragged, read_cells, text_lines
from helibore.files.channel import EXACT, NO_HEADER, Array, Channel, LogFile, LogSet, unique
from helibore.files.headings import describe, is_number, is_units_row
from helibore.files.sectors import FEWEST
from helibore.files.source import LINE_LIMIT, Source, complaint, decode

DELIMITERS = (",", "\t", ";", "|")
BLANKS = tuple(" " * count for count in range(1, 17))
# What pyarrow says of a cell that does not fit its column.
NOT_A_NUMBER = re.compile(r"In CSV column #(?P<column>\d+): .*invalid value '(?P<cell>.*)'", re.DOTALL)

HEADING_LINES = 500
"""The header must stand within this many lines."""


@dataclass
class Layout:
    """How a table is laid out: what stands above the rows, and what separates the cells."""

    delimiter: str
    names: list[str]
    units: list[str] | None
    skip: int
    remarks: list[str] = field(default_factory=list)


def read(source: Source, nulls: tuple[float, ...]) -> LogFile:
    """Open a delimited table."""
    head, remark, whole = _head_text(source)
    layout = find_layout(source, head)
    if remark:
        layout.remarks.append(remark)
    encoding = "utf8" if not remark else "cp1252"
    names = unique(layout.names)
    for name, count in Counter(layout.names).items():
        if 1 < count < FEWEST:  # as many are an image
            layout.remarks.append(f"{count} columns are named {name}: they are told apart as {name}:1, {name}:2 ...")
    arrow = None if whole else _arrow()
    if arrow is None:
        lines = head.split("\n") if whole else text_lines(source, encoding)
        arrays = read_cells(source.path, lines, layout.skip, layout.delimiter, names)
        columns = [(_keep(values), values.size, values.dtype.kind == "U") for values in arrays]
    else:
        table = _table(*arrow, source, layout, head, encoding)
        columns = [(_loader(column), len(column), str(column.type) == "string") for column in table.columns]
    channels = []
    for position, (name, (load, rows, text)) in enumerate(zip(names, columns, strict=True)):
        unit = layout.units[position] if layout.units else describe(layout.names[position])
        channels.append(Channel(name, unit, "", (rows,), load, nulls, None, text, nan_is_missing=False))
    line_of = _line_finder(source, layout)
    one = LogSet(source.path, "table", channels, columns[0][1], None, {}, layout.remarks, line_of)
    return LogFile(source.path, "csv", [one])


def _head_text(source: Source) -> tuple[str, str, bool]:
    """The first 2 MiB of the file, cut at the last whole line, the remark on the encoding, and whether that is all."""
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


def find_layout(source: Source, head: str) -> Layout:
    """Find delimiter, header and units row in the first lines of a table, or say which rule they break."""
    remarks = []
    lines = head.split("\n", HEADING_LINES)[:HEADING_LINES]
    start = 0
    while start < len(lines) and (not lines[start].strip() or lines[start].lstrip().startswith("#")):
        if comment := lines[start].strip(" #\t"):
            remarks.append(f"comment: {comment}")
        start += 1
    rows = [line for line in lines[start:] if line.strip()]
    if not rows:
        raise complaint(source.path, f"no header and no rows within {HEADING_LINES} lines", start)
    delimiter = _delimiter(source, rows, start + 1)
    first = split(rows[0], delimiter)
    if all(is_number(cell) for cell in first):
        return _without_header(lines, start, delimiter, len(first), remarks)
    if any(not cell for cell in first) and not first[-1] and len(rows) > 1 and not split(rows[1], delimiter)[-1]:
        remarks.append("the header and the rows end in a delimiter: the last column has no name")
    names = [cell or f"column {number}" for number, cell in enumerate(first, 1)]
    second = split(rows[1], delimiter) if len(rows) > 1 else []
    units = None
    skip = lines.index(rows[0], start) + 1
    if len(second) == len(names) and is_units_row(second):
        units = [cell.strip("()[] ") for cell in second]
        skip = lines.index(rows[1], skip) + 1
    return Layout(delimiter, names, units, skip, remarks)


def _without_header(lines: list[str], start: int, delimiter: str, width: int, remarks: list[str]) -> Layout:
    """Names for a table that starts with numbers: the last comment line if it fits (numpy.savetxt), else numbered."""
    for line in reversed(lines[:start]):
        names = split(line.strip().lstrip("#"), delimiter)
        if len(names) == width and width > 1 and all(names):
            remarks = [remark for remark in remarks if remark != f"comment: {line.strip(' #')}"]
            return Layout(delimiter, names, None, start, [*remarks, "the header is a comment line"])
    remarks = [*remarks, f"line {start + 1}: {NO_HEADER}: columns are named by their number"]
    return Layout(delimiter, [f"column {number}" for number in range(1, width + 1)], None, start, remarks)


def split(line: str, delimiter: str) -> list[str]:
    """Split one line into cells, quotes honoured, blanks trimmed."""
    if '"' not in line:
        return [cell.strip() for cell in line.split(delimiter)]
    cells, cell, quoted = [], "", False
    for piece in line:
        if piece == '"':
            quoted = not quoted
        elif piece == delimiter and not quoted:
            cells.append(cell.strip())
            cell = ""
        else:
            cell += piece
    return [*cells, cell.strip()]


def _delimiter(source: Source, rows: list[str], line: int) -> str:
    """The delimiter that cuts the first rows into the same number (above one) of cells."""
    sample = rows[:20]
    widths = {mark: [len(split(row, mark)) for row in sample] for mark in DELIMITERS}
    even = [mark for mark in DELIMITERS if widths[mark][0] > 1 and len(set(widths[mark])) == 1]
    if len(even) > 1:  # "1,5;2,5" cuts evenly at both: a header without commas means decimal commas
        even = [mark for mark in even if not (mark == "," and ";" in even)]
        even.sort(key=lambda mark: -widths[mark][0])
    if even:
        return even[0]
    likely = max(DELIMITERS, key=lambda mark: widths[mark][0])
    if widths[likely][0] > 1:
        return likely  # ragged: pyarrow names the row
    if len(sample) > 1 and len(rows[0].split()) > 1:
        rule = "columns are separated by blanks: read are comma, tab, semicolon and |"
        raise complaint(source.path, rule, line)
    if len(sample) > 1 and max(max(width) for width in widths.values()) > 1:
        rule = "the header has one column, the rows have more: another delimiter?"
        raise complaint(source.path, rule, line)
    if len(sample) > 1 and all(is_number(row) for row in sample[1:]):
        return ","  # one column of numbers under a name
    raise complaint(source.path, "not a table: no comma, tab, semicolon or | separates columns", line)


def _arrow() -> tuple[ModuleType, Any] | None:
    try:
        import pyarrow as pa
        from pyarrow import csv
    except ImportError:
        return None
    return pa, csv


def _table(pa: ModuleType, csv: Any, source: Source, layout: Layout, head: str, encoding: str) -> Any:
    """The whole table: column types settled on the first 2 MiB, so that they do not depend on how blocks fall."""
    try:
        sample = _rows(csv, _copied(pa, head.encode()), layout, layout.skip)
        if not sample.num_rows:
            raise complaint(source.path, "a header and no rows", layout.skip)
        types = {name: _column_type(pa, sample.column(name)) for name in sample.column_names}
        if encoding == "utf8" and not source.compressed:
            table = _rows(csv, str(source.path), layout, layout.skip, types)
        else:
            table = _unpacked(pa, csv, source, layout, encoding, types)
    except pa.ArrowInvalid as error:
        raise _explain(source, layout, error) from error
    except UnicodeDecodeError as error:
        raise complaint(source.path, f"encodings are mixed: {error.reason} past the first 2 MiB") from error
    if any(kind == pa.string() and _spans_lines(table.column(name)) for name, kind in types.items()):
        raise _explain(source, layout, ValueError("a cell holds a line break"))
    return table


def _rows(csv: Any, content: Any, layout: Layout, skip: int, types: dict[str, Any] | None = None) -> Any:
    """The rows below the first ``skip`` lines, their columns named by number: repeated names would be refused."""
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
    """The text in memory of pyarrow's own: given a Python object, its threads call Python.

    They go on with that after an error, and abort a process that ends meanwhile.
    """
    memory = pa.BufferOutputStream()
    memory.write(text)
    return pa.BufferReader(memory.getvalue())


def _unpacked(pa: ModuleType, csv: Any, source: Source, layout: Layout, encoding: str, types: dict[str, Any]) -> Any:
    """The table of a source that this thread unpacks or translates, a piece being parsed meanwhile."""
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
        low, high = min_max(column)
        return pa.int64() if max(abs(low), abs(high)) > EXACT else pa.float64()
    if pa.types.is_floating(kind) or pa.types.is_null(kind):
        return pa.float64()
    return pa.string()


def _spans_lines(column: Any) -> bool:
    """Whether a cell holds a line break: an open quote swallows rows, and pyarrow lets it."""
    import pyarrow.compute as pc

    return bool(pc.any(pc.match_substring(column, "\n")).as_py())


def min_max(column: Any) -> tuple[int, int]:
    """Smallest and largest of an integer column, (0, 0) when it is empty."""
    import pyarrow.compute as pc

    both = pc.min_max(column).as_py()
    return both["min"] or 0, both["max"] or 0


def _loader(column: Any) -> Callable[[], Array]:
    """The values of a column, masked where cells are empty."""
    if not column.null_count or str(column.type) == "string":
        return lambda: column.to_numpy()
    return lambda: np.ma.MaskedArray(column.to_numpy(), column.is_null().to_numpy())


def _keep(values: Array) -> Callable[[], Array]:
    return lambda: values


def _explain(source: Source, layout: Layout, error: Exception) -> ValueError:
    """Find the line that pyarrow stumbled over: it names none when it reads in threads."""
    told = NOT_A_NUMBER.search(str(error))
    if told and (found := _not_a_number(source, layout, int(told["column"]), told["cell"])):
        return found
    width = len(layout.names)
    for line, raw in enumerate(islice(source.lines(), layout.skip, None), layout.skip + 1):
        if b'"' not in raw and raw.count(layout.delimiter.encode()) == width - 1:
            continue
        text = raw.decode("utf-8", "replace").rstrip("\r\n")
        if not text.strip():
            continue
        cells = split(text, layout.delimiter)
        if len(cells) != width:
            return ragged(source.path, text, line, len(cells), width, layout.delimiter)
        if text.count('"') % 2:
            return complaint(source.path, "a quote is opened and not closed", line)
    return complaint(source.path, str(error).splitlines()[0])


def _not_a_number(source: Source, layout: Layout, position: int, cell: str) -> ValueError | None:
    """The first line that has this cell in this column, None when an open quote hides it."""
    if "\n" in cell:
        return None
    wanted = cell.strip()
    for line, raw in enumerate(islice(source.lines(), layout.skip, None), layout.skip + 1):
        if wanted.encode() not in raw:
            continue
        cells = split(raw.decode("utf-8", "replace"), layout.delimiter)
        if len(cells) > position and cells[position] == wanted:
            return complaint(source.path, f"{wanted[:40]!r} is not a number", line, layout.names[position])
    return None


def _line_finder(source: Source, layout: Layout) -> Callable[[int], int]:
    """A function from row to line: blank lines are not rows, so it counts, and only when an error is to be told."""

    def line_of(row: int) -> int:
        line = layout.skip
        for raw in islice(source.lines(), layout.skip, None):
            line += 1
            if raw.strip():
                row -= 1
                if row < 0:
                    break
        return line

    return line_of

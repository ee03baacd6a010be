"""Read XLSX workbooks, mostly surveys, through python-calamine: one set for each sheet.

Well 15/9-F-12                          rows above the header are left out
MD (m)   Incl (deg)   Azim (deg)        the header: the first row of two names or more with numbers below two of them;
                                        the next row may state the units
100.0          0.50        31.20        rows, up to the first empty row; a remark says if rows follow below it
"""

from __future__ import annotations

import re
import zipfile
from collections import Counter
from collections.abc import Iterator
from functools import partial
from typing import Any, BinaryIO

from helibore.base.errors import InputError, needs
from helibore.base.limits import check_limit, check_unpacked
from helibore.base.zip_errors import DAMAGED_ZIP
from helibore.files.headings import is_units_row, unit_in_name
from helibore.files.input_file import InputFile, zip_pieces
from helibore.files.number_rows import column_of
from helibore.files.number_spellings import is_like_a_number, read_spellings
from helibore.files.raw_set import Channel, Loss, RawFile, RawSet, readable_sets, unique
from helibore.files.row_lines import footers
from helibore.files.table_head import find_head
from helibore.files.text_layouts import text_rules

REFERENCE = re.compile(rb"""\sr\s*=\s*["']\s*([A-Za-z]*)([0-9]*)""")
"""The position that a row or a cell states, ``r="B7"``; also any text that looks like one, which does no harm."""

LOOSE = re.compile(rb"<(?:\w+:)?row(?![^<]*?\sr\s*=)[\s/>]")
"""A row that states no position."""

SHARED = re.compile(rb"""<(?:\w+:)?c(?>[^<>]*?\st\s*=)\s*["']s["'][^<>]*>\s*<(?:\w+:)?v>\s*(\d{1,9})\s*<""")
"""The number of a shared text, in a cell that names one. The first type of a tag is its type: to try all would take the
square of the length of a tag that has many."""

SHARED_TEXT = re.compile(rb"<(?:\w+:)?si[\s>/]")
"""The start of a shared text."""

HEADING_ROWS = 500
"""The header must be within this many rows from the top of a sheet."""

ABOVE, SAMPLE = 2, 40
"""Rows above the names that may hold words of them, and rows below that show which columns have numbers."""


def read(source: InputFile) -> RawFile:
    """Open a workbook; the stated header line is the row of the column names in every sheet, counted from 1."""
    with needs("python-calamine", "xlsx"):
        import python_calamine
    _check_extent(source)
    try:
        book = python_calamine.CalamineWorkbook.from_path(source.path)
        names = book.sheet_names
        check_limit(source.path.name, "sheets", len(names))
        sheets, cells = {}, 0
        for name in names:
            sheets[name] = book.get_sheet_by_name(name).to_python(skip_empty_area=False)
            cells += sum(map(len, sheets[name]))
            check_limit(source.path.name, "cells", cells)
    except InputError:
        raise
    except BaseException as error:  # a panic in calamine's Rust code is not an Exception
        if isinstance(error, KeyboardInterrupt | SystemExit):
            raise
        raise source.damaged("truncated or damaged workbook", error) from error
    return RawFile("xlsx", readable_sets(partial(_sheet, source, name, rows) for name, rows in sheets.items()))


def _before_tags(pieces: Iterator[bytes]) -> Iterator[bytes]:
    """Yield the text of pieces in pieces that end before a "<", so that no tag is divided."""
    rest: list[bytes] = []  # joined once: a long text without a tag would else be copied with every piece
    for more in pieces:
        end = more.rfind(b"<")
        if end < 0:
            rest.append(more)
            continue
        yield b"".join((*rest, more[:end]))
        rest = [more[end:]]
    yield b"".join(rest)


def _column(letters: bytes) -> int:
    """Return the number of a column: 1 for A, 27 for AA."""
    number = 0
    for letter in letters[:4].upper():
        number = 26 * number + letter - 64
    return number


def _check_extent(source: InputFile) -> None:
    """Refuse a workbook for whose cells or texts calamine would ask for too much memory, before calamine reads it.

    One cell at XFD1048576 makes it ask for 550 GB, and ends the process. Every part of the archive is searched, because
    a sheet can be any of them. A cell without a reference follows the one before it. A shared text is copied to every
    cell that names it.
    """
    place, packed = source.path.name, source.path.stat().st_size
    unpacked = 0
    uses: list[bytes] = []

    def counted(pieces: Iterator[bytes]) -> Iterator[bytes]:
        nonlocal unpacked
        for piece in pieces:
            unpacked += len(piece)
            check_unpacked(place, unpacked, packed)
            yield piece

    try:
        with source.path.open("rb") as file, zipfile.ZipFile(file) as archive:
            check_limit(place, "members", len(archive.infolist()))
            for entry in archive.infolist():
                columns = rows = loose = 0
                for text in _before_tags(counted(zip_pieces(source, file, entry))):
                    for letters, digits in set(REFERENCE.findall(text)):
                        columns = max(columns, _column(letters))
                        rows = max(rows, int(digits[:9] or b"0"))
                    loose += len(LOOSE.findall(text))
                    uses += SHARED.findall(text)
                # Cells and rows without a reference follow the last one, so they reach at most this much further.
                check_limit(f"{place}, {entry.filename}", "cells", columns * (rows + loose))
            if uses:
                unpacked += _shared_text(source, file, archive, uses)
                check_unpacked(place, unpacked, packed)
    except (*DAMAGED_ZIP, OSError) as error:
        raise source.damaged("truncated or damaged workbook", error) from error


def _shared_text(source: InputFile, file: BinaryIO, archive: zipfile.ZipFile, uses: list[bytes]) -> int:
    """Return the bytes of all cells together that name a shared text by its number, as in ``uses``."""
    sizes: list[int] = []
    for entry in archive.infolist():
        if entry.filename.lower().endswith("sharedstrings.xml"):
            text = b"".join(zip_pieces(source, file, entry))
            sizes += [len(part) for part in SHARED_TEXT.split(text)[1:]]
    return sum(sizes[number] * count for index, count in Counter(uses).items() if (number := int(index)) < len(sizes))


def _sheet(source: InputFile, name: str, sheet: list[list[Any]]) -> RawSet:
    rows, header = [[_text(cell) for cell in row] for row in sheet], source.options.header_line
    start = _find_header(rows) if header is None else header - 1
    if start is None or not 0 <= start < len(rows) or not any(rows[start]):
        if header is not None:
            raise InputError(f"{source.path.name}: sheet {name}: header_line", "the row holds no names", str(header))
        raise source.error(f"no row of column names with numbers below it within {HEADING_ROWS} rows", f"sheet {name}")
    width = max(position for position, cell in enumerate(rows[start], 1) if cell)
    titles = rows[start][:width]
    units = descriptions = None
    remarks: list[str] = []
    rules = text_rules(source.options.layouts)
    above = max(0, start - ABOVE) if header is None else start
    head = find_head([row[:width] for row in rows[above : start + SAMPLE]], rules)
    start += 1
    if head is not None and above + head.first >= start:
        titles, units, descriptions, start = head.names, head.units, head.descriptions, above + head.first
        remarks += head.remarks
    elif start < len(rows) and is_units_row(rows[start][:width]):
        units = [cell.strip("()[] ") for cell in rows[start][:width]]
        start += 1
    stop = next((at for at in range(start, len(rows)) if not any(rows[at][:width])), len(rows))
    if stop == start:
        raise source.error("no rows below the header", f"sheet {name}, line {start}")
    if any(any(row[:width]) for row in rows[stop:]):
        remarks.append(Loss(f"sheet {name}: line {stop + 1} is empty: the rows below it are left out"))
    columns = [column_of([row[at] for row in rows[start:stop]]) for at in range(width)]
    if any(column.dtype.kind == "U" for column in columns):
        last = footers([row[:width] for row in rows[start:stop]], width, rules)
        if last:
            remarks.append(f"line {stop - last + 1} is no row: {', '.join(filter(None, rows[stop - last]))[:60]}")
            stop -= last
            columns = [column_of([row[at] for row in rows[start:stop]]) for at in range(width)]
    titles = [cell or f"column {position}" for position, cell in enumerate(titles, 1)]
    columns, units_of_texts, read_so = read_spellings(columns, titles, False, source.options.decimal)
    channels = []
    for at, label in enumerate(unique(titles)):
        unit = (units[at] if units else unit_in_name(titles[at])) or units_of_texts.get(at, "")
        described = descriptions[at] if descriptions else ""
        channels.append(Channel(label, unit, described, columns[at], source.nulls, nan_is_missing=False))
    remarks += read_so
    return RawSet(source.path, name, channels, stop - start, None, {}, remarks, lambda row: row + start + 1)


def _find_header(rows: list[list[str]]) -> int | None:
    """Return the index of the header: two names or more, with numbers below two of them; None without such a row.

    A row of units may stand between the names and the numbers.
    """
    for at, row in enumerate(rows[:HEADING_ROWS]):
        names = [position for position, cell in enumerate(row) if cell and not is_like_a_number(cell)]
        below = rows[at + 1 : at + 3]
        if len(names) > 1 and below and is_units_row(below[0]):
            below = below[1:]
        if len(names) > 1 and below and sum(is_like_a_number(below[0][position]) for position in names) > 1:
            return at
    return None


def _text(cell: Any) -> str:
    """Return a cell as text: numbers with all digits, dates as ISO 8601."""
    if isinstance(cell, float):
        return repr(int(cell)) if cell.is_integer() else repr(cell)
    return cell.isoformat() if hasattr(cell, "isoformat") else str(cell).strip()

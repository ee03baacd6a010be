"""The rows of a delimited table, cell by cell in plain Python: for small files, and where pyarrow is not installed.

    lines  --cut-->  cells  --column-->  float64 with empty cells masked, or text

It takes and refuses what ``delimited`` takes and refuses with pyarrow, and gives the same bits; for a few thousand rows
it is done before pyarrow is imported.
"""

from __future__ import annotations

import csv
import re
from array import array
from collections.abc import Iterable, Iterator
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from helibore.files.channel import EXACT, Array
from helibore.files.headings import to_float
from helibore.files.source import LINE_LIMIT, Source, complaint

NULL_TEXTS = ("", "-", "--", "null", "NULL", "(null)", "N/A", "n/a", "NA", "#N/A", "None")
_NULLS = frozenset(NULL_TEXTS)
WHOLE = re.compile(r"-?[0-9]{1,19}")


def read_cells(path: Path, lines: Iterable[str], skip: int, delimiter: str, names: list[str]) -> list[Array]:
    """Read every column of a table.

    Parameters
    ----------
    path
        For errors.
    lines
        All lines of the file.
    skip, delimiter, names
        Lines above the rows, what parts the cells, and the names of the columns.

    Returns
    -------
    list of ndarray
        A column each: float64, masked where cells are empty; int64 where whole numbers are too large for that; else
        text. What a column is, its cells in the first 2 MiB settle.

    Raises
    ------
    ValueError
        Naming file, line, column and rule.
    """
    rows = _rows(path, lines, len(names), skip, delimiter)
    first: list[list[str]] = []
    size = 0
    for _, row, length in rows:
        first.append(row)
        size += length
        if size > 2 * LINE_LIMIT:
            break
    if not first:
        raise complaint(path, "a header and no rows", skip)
    columns = [_Column(path, names[at], [row[at] for row in first]) for at in range(len(names))]
    for line, row, _ in rows:
        for column, cell in zip(columns, row, strict=True):
            column.add(cell, line)
    return [column.values() for column in columns]


def text_lines(source: Source, encoding: str) -> Iterator[str]:
    """Yield the lines of a file too large to be held as text."""
    for line, raw in enumerate(source.lines(), 1):
        try:
            text = raw.decode(encoding).rstrip("\r\n")
        except UnicodeDecodeError as error:
            raise complaint(source.path, f"encodings are mixed: {error.reason} past the first 2 MiB", line) from error
        if "\r" in text:
            raise complaint(source.path, "lines end in carriage returns alone: save it with line feeds", line)
        yield text.removeprefix("\ufeff") if line == 1 else text


def _rows(
    path: Path, lines: Iterable[str], width: int, skip: int, delimiter: str
) -> Iterator[tuple[int, list[str], int]]:
    """Yield line number, cells and length of every line that is not blank."""
    for line, text in enumerate(islice(lines, skip, None), skip + 1):
        if not text.strip():
            continue
        if '"' in text:
            if text.count('"') % 2:
                raise complaint(path, "a quote is opened and not closed", line)
            try:
                cells = next(csv.reader([text], delimiter=delimiter))
            except csv.Error as error:
                raise complaint(path, str(error), line) from error
        else:
            cells = text.split(delimiter)
        if len(cells) != width:
            raise ragged(path, text, line, len(cells), width, delimiter)
        yield line, cells, len(text)


def ragged(path: Path, text: str, line: int, cells: int, width: int, delimiter: str) -> ValueError:
    """The error of a row with another number of cells than the header."""
    other = [mark for mark in (",", "\t", ";", "|") if mark != delimiter and text.count(mark) == width - 1]
    hint = f" (it has {width} when cut at {other[0]!r}: another delimiter?)" if other else ""
    return complaint(path, f"{cells} cells where the header has {width}{hint}", line)


class _Column:
    """Numbers when every one of its first cells is one (whole ones where float64 would round), else text."""

    def __init__(self, path: Path, name: str, first: list[str]) -> None:
        self._path, self._name = path, name
        self._numbers: array[Any] = array(_kind(first))
        self._empty = bytearray()
        self._text: list[str] | None = None
        try:
            for cell in first:
                self._append(cell)
        except ValueError:
            self._text = ["" if cell.strip() in _NULLS else cell for cell in first]

    def add(self, cell: str, line: int) -> None:
        if self._text is not None:
            self._text.append("" if cell.strip() in _NULLS else cell)
            return
        try:
            self._append(cell)
        except (ValueError, OverflowError):
            raise complaint(self._path, f"{cell.strip()[:40]!r} is not a number", line, self._name) from None

    def _append(self, cell: str) -> None:
        bare = cell.strip()
        empty = bare in _NULLS
        if self._numbers.typecode == "q":
            self._numbers.append(0 if empty else int(bare))
        else:
            self._numbers.append(0.0 if empty else to_float(bare))
        self._empty.append(empty)

    def values(self) -> Array:
        if self._text is not None:
            return np.array(self._text, dtype=np.str_)
        empty = np.frombuffer(self._empty, dtype=np.uint8).astype(bool)
        if self._numbers.typecode == "d":
            numbers = np.frombuffer(self._numbers, dtype=np.float64)
            return np.ma.MaskedArray(numbers, empty) if empty.any() else numbers
        whole = np.frombuffer(self._numbers, dtype=np.int64)
        return np.ma.MaskedArray(whole.astype(np.float64), empty) if empty.any() else whole


def _kind(first: list[str]) -> str:
    """ "q" where all cells are whole numbers that fit 64 bits and one is beyond float64, else "d"."""
    least = most = 0
    for cell in first:
        bare = cell.strip()
        if bare in _NULLS:
            continue
        if not WHOLE.fullmatch(bare):
            return "d"
        least, most = min(least, int(bare)), max(most, int(bare))
    return "q" if max(most, -least) > EXACT and least >= -(2**63) and most < 2**63 else "d"

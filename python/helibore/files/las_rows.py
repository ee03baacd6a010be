"""The rows of a LAS data section: blanks, commas or tabs, one row a line or wrapped.

    fast:    every cell a number, every row of one width        one call of numpy.loadtxt
    slow:    text columns, null words, numbers run together     cell by cell, each flaw told or counted

The slow road is taken only when the fast one fails, and then either mends and remarks, or names line and column.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from helibore.files.channel import Array
from helibore.files.headings import not_a_number, to_float
from helibore.files.source import complaint

NULL_WORDS = frozenset({"", "-", "--", "nan", "null", "(null)", "n/a", "#n/a", "na", "none", "-nan"})
# Windows spelled not-a-number and infinity this way: 1.#QNAN, -1.#IND, 1.#INF.
WINDOWS_NAN = re.compile(r"-?1\.#\w+")
# Fixed-width writers run a negative number into its neighbour: 12.3400-999.2500.
RUN_ON = re.compile(r"(?<=\d)-(?=\d)")


@dataclass
class Rows:
    """The columns of a data section, and where its rows stand in the file."""

    columns: list[Array]
    count: int
    remarks: list[str]
    line_of: Callable[[int], int]


def read_rows(
    path: Path, lines: list[str], first_line: int, names: list[str], delimiter: str | None, wrapped: bool
) -> Rows:
    """Read the rows of a data section.

    Parameters
    ----------
    path
        For errors.
    lines, first_line
        The lines below the section's title, and the number of the first.
    names
        Names of the columns.
    delimiter
        None for any run of blanks, else the character.
    wrapped
        Whether a row may run over several lines (LAS 2 with WRAP YES).

    Raises
    ------
    ValueError
        With file, line and column: no rows, a row of another width, a cell that is no number in a column of numbers.
    """
    kept = [line for line in lines if line.strip() and not line.lstrip().startswith("#")]
    if not kept:
        raise complaint(path, "truncated: the data section has no rows", first_line)
    if delimiter is None and all("," in line for line in kept[:3]) and len(kept[0].split()) < len(names):
        rule = f"{len(names)} columns are defined and the rows are cut by commas, not blanks: wrong delimiter (DLM)"
        raise complaint(path, rule, _line_finder(lines, first_line)(0))
    remarks: list[str] = []
    if wrapped:
        return _wrapped(path, kept, lines, first_line, names)
    block = _block(kept, delimiter, len(names))
    columns = list(block.T) if block is not None else _cells(path, lines, first_line, names, delimiter, remarks)
    return Rows(columns, len(kept), remarks, _line_finder(lines, first_line))


def _block(kept: list[str], delimiter: str | None, width: int) -> Array | None:
    """All rows as one block of numbers, None when they are not that plain."""
    try:
        block = np.loadtxt(kept, dtype=np.float64, delimiter=delimiter, comments=None, ndmin=2)
    except ValueError:
        return None
    return block if block.shape[1] == width else None


def _wrapped(path: Path, kept: list[str], lines: list[str], first_line: int, names: list[str]) -> Rows:
    cells = [cell for line in kept for cell in line.split()]
    count, odd = divmod(len(cells), len(names))
    if odd:
        rule = f"truncated: {len(cells)} wrapped values are not a multiple of {len(names)} columns"
        raise complaint(path, rule, _line_finder(lines, first_line)(len(kept) - 1))
    table = [cells[row * len(names) : (row + 1) * len(names)] for row in range(count)]
    line_of_cell = [
        number
        for number, line in enumerate(lines, first_line)
        if line.strip() and not line.lstrip().startswith("#")
        for _ in line.split()
    ]
    starts = line_of_cell[:: len(names)]
    columns = [
        _column(path, [row[position] for row in table], name, lambda row: starts[row])
        for position, name in enumerate(names)
    ]
    return Rows(columns, count, ["wrapped rows"], lambda row: starts[row])


def _cells(
    path: Path, lines: list[str], first_line: int, names: list[str], delimiter: str | None, remarks: list[str]
) -> list[Array]:
    """Cell by cell: every row must have the width, every column be numbers or text."""
    line_of = _line_finder(lines, first_line)
    table: list[list[str]] = []
    parted = 0
    for line in lines:
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        row = _split(line, delimiter)
        if len(row) != len(names) and delimiter is None:
            mended = RUN_ON.sub(" -", line).split()
            if len(mended) == len(names):
                row, parted = mended, parted + 1
        if len(row) != len(names):
            last = len(table) == sum(1 for each in lines if each.strip() and not each.lstrip().startswith("#")) - 1
            cut = "truncated: " if last and len(row) < len(names) else ""
            rule = f"{cut}{len(row)} values where {len(names)} columns are defined"
            raise complaint(path, rule, line_of(len(table)))
        table.append(row)
    if parted:
        remarks.append(f"{parted} rows held numbers run together (12.5-999.25): parted before the minus sign")
    return [_column(path, [row[position] for row in table], name, line_of) for position, name in enumerate(names)]


def _split(line: str, delimiter: str | None) -> list[str]:
    if '"' in line:
        mark = delimiter or " "
        cells = next(csv.reader([line.strip()], delimiter=mark, skipinitialspace=True))
        return [cell.strip() for cell in cells if cell or delimiter]
    if delimiter is None:
        return line.split()
    return [cell.strip() for cell in line.split(delimiter)]


def _column(path: Path, cells: list[str], name: str, line_of: Callable[[int], int]) -> Array:
    """One column: numbers when its first cell that is not null is a number, else text."""
    numbers = np.full(len(cells), np.nan)
    seen = False
    for row, cell in enumerate(cells):
        if cell.lower() in NULL_WORDS or WINDOWS_NAN.fullmatch(cell):
            continue
        try:
            numbers[row] = to_float(cell)
            seen = True
        except ValueError:
            if not seen:
                return np.array(cells, dtype=np.str_)
            raise complaint(path, not_a_number(cell), line_of(row), name) from None
    return numbers


def _line_finder(lines: list[str], first_line: int) -> Callable[[int], int]:
    def line_of(row: int) -> int:
        for number, line in enumerate(lines, first_line):
            if line.strip() and not line.lstrip().startswith("#"):
                row -= 1
                if row < 0:
                    return number
        return first_line + len(lines)

    return line_of

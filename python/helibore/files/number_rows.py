"""Read the rows of a table from text. Blanks, commas or another character separate cells; a row may span several lines.

    fastest   numbers between blanks, all rows of equal length         the core
    fast      every cell a number or empty, all rows of equal length   one call of numpy.loadtxt
    careful   all other tables                                         cell by cell; an error names its line and column

Each reader runs only if the one above fails. All return exactly the same numbers.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path

import numpy as np

from helibore._core import read_number_rows
from helibore.base.arrays import Array
from helibore.files.headings import to_float
from helibore.files.input_file import SALVAGE, file_error
from helibore.files.raw_set import EXACT, Loss

NULL_TEXTS = (
    "", "-", "--", "null", "NULL", "Null", "(null)", "(NULL)", "n/a", "N/A", "#N/A", "na", "NA", "None", "none",
    "#DIV/0!", "#VALUE!", "#REF!", "#NUM!", "#NAME?", "#NULL!", "#NV",
    "#WERT!", "#BEZUG!", "#ZAHL!", "#VALEUR!", "#NOMBRE!",
)  # fmt: skip
"""Texts that people write into an empty cell, and those that Excel writes into a cell whose formula has no value."""
_NULLS = frozenset(NULL_TEXTS)

WINDOWS_NAN = re.compile(r"-?1\.#\w+")
"""Not-a-number and infinity as old programs on Windows wrote them: 1.#QNAN, -1.#IND, 1.#INF."""

RUN_TOGETHER = re.compile(r"(?<=\d)-(?=\d)")
"""The place where two numbers meet: a writer of fixed columns leaves no blank before a wide number, 12.34-999.25."""

OVERFLOW = re.compile(r"\*+")
"""A number that did not fit its field, as Fortran writes it; files also state it as their null value."""

FIRST_COLUMNS = "; salvage = true takes the first columns for the first curves"
"""End of a message about rows that all have another number of cells than there are curves."""

QUOTED = re.compile(r"'[^']*'|\"[^\"]*\"|\S+")
"""Cells between blanks, with quotes of both kinds."""

WHOLE = re.compile(r"-?[0-9]{1,19}")


@dataclass
class Rows:
    """The columns of a table, the number of its rows, and the line of each row."""

    columns: list[Array]
    count: int
    line_of: Callable[[int], int]
    remarks: list[str] = field(default_factory=list)


def read_rows(
    path: Path,
    text: str,
    first_line: int,
    names: list[str],
    delimiter: str | None,
    comments: bool = False,
    wrapped: bool = False,
    salvage: bool = False,
) -> Rows:
    """Read the rows of a table with the columns ``names``; ``text`` begins at line ``first_line`` of the file.

    Blank lines are not rows; with ``comments``, lines that start with # are not rows. If ``delimiter`` is None, any
    number of blanks separates cells; but if the first lines hold commas and too few blanks, commas separate cells. If
    ``wrapped``, a row may run over several lines (LAS 2 with WRAP YES).

    A column is float64, masked where cells are empty. It is int64 if all cells are whole numbers and one is too large
    to be exact in float64, and text if a cell is neither empty nor a number. An InputError names the file and line if
    there is no row, a row has another number of cells than there are names, or a quote is not closed. With ``salvage``,
    a last row that is cut is left out.
    """

    def is_row(line: str) -> bool:
        return line.strip() != "" and not (comments and line.lstrip().startswith("#"))

    def line_of(row: int) -> int:
        numbers = (number for number, line in enumerate(text.split("\n"), first_line) if is_row(line))
        return next(islice(numbers, row, None))

    if delimiter is None and not wrapped:
        block = read_number_rows(text, len(names), comments)
        if block.size:
            return Rows(list(block), block.shape[1], line_of)
    remarks: list[str] = []
    kept = list(filter(str.strip, text.split("\n")))
    if comments:
        kept = [line for line in kept if "#" not in line or is_row(line)]
    if salvage and len(kept) > 1 and not wrapped:
        cells = [len(split_cells(line, delimiter)) for line in (kept[0], kept[-1])]
        if cells[1] < cells[0] or kept[-1].count('"') % 2:
            remarks.append(Loss(f"salvaged: the last row, line {line_of(len(kept) - 1)}, is cut and left out"))
            del kept[-1]
    if not kept:
        raise file_error(path, "no rows below the header", max(1, first_line - 1))

    if wrapped or (delimiter is None and _is_wrapped(kept, len(names))):
        remarks.append("wrapped rows" if wrapped else "rows run over several lines, although the header says WRAP NO")
        return replace(_wrapped(path, kept, line_of, names), remarks=remarks)
    if delimiter is None and all("," in line for line in kept[:3]) and _cut_by_commas(kept[0], len(names)):
        delimiter = ","
        remarks.append("the rows are cut by commas, not by blanks as the header says")
    if delimiter is None and all(line.count(";") == len(names) - 1 > 0 for line in kept[:3]):
        delimiter = ";"
        remarks.append("the rows are cut by semicolons, not by blanks as the header says")
    columns = _fast(kept, delimiter, len(names))
    if columns is None:
        rows = _cells(path, kept, line_of, len(names), delimiter, remarks)
        columns = [column_of(list(cells)) for cells in zip(*rows, strict=True)]
    return Rows(columns, len(kept), line_of, remarks)


def _cut_by_commas(line: str, width: int) -> bool:
    """Return whether blanks cut a line into too few cells, or each of its cells but the last ends in a comma."""
    cells = line.split()
    commas = width > 1 and line.count(",") == width - 1 and all(cell.endswith(",") for cell in cells[:-1])
    return len(cells) < width or commas


def _block(lines: list[str], delimiter: str | None) -> Array | None:
    """Return the rows as one float64 array (rows, columns), or None if NumPy refuses them."""
    try:
        return np.loadtxt(lines, dtype=np.float64, delimiter=delimiter, comments=None, ndmin=2)
    except ValueError:
        return None


def _fast(kept: list[str], delimiter: str | None, width: int) -> list[Array] | None:
    """Return all columns, read by NumPy and masked where cells are empty.

    Return None if NumPy does not read the rows, finds another number of columns, or cannot hold a number exactly.
    """
    block, filled = _block(kept, delimiter), False
    if block is None and delimiter is not None:
        text = "\n".join(kept)
        if "nan" in text.lower():  # a NaN in the text is a computed value, not an empty cell
            return None
        text = f"\n{text}\n".replace(f"\n{delimiter}", f"\nnan{delimiter}").replace(
            f"{delimiter}\n", f"{delimiter}nan\n"
        )
        for _ in range(2):
            text = text.replace(delimiter * 2, f"{delimiter}nan{delimiter}")
        block, filled = _block(text[1:-1].split("\n"), delimiter), True
    if block is None or block.shape[1] != width or (np.abs(block) >= EXACT).any():
        return None
    columns = block.T.copy()
    empty = np.isnan(columns) & filled
    return [
        np.ma.MaskedArray(column, gone) if gone.any() else column for column, gone in zip(columns, empty, strict=True)
    ]


def _cells(
    path: Path, kept: list[str], line_of: Callable[[int], int], width: int, delimiter: str | None, remarks: list[str]
) -> list[list[str]]:
    """Return the cells of every row; raise InputError with the line of a row that does not have ``width`` cells."""
    rows: list[list[str]] = []
    cut_rows = 0
    for line in kept:
        inches = (
            '"' in line
            and delimiter is not None
            and not any(cell.lstrip().startswith('"') for cell in line.split(delimiter))
        )  # 9 5/8" casing
        if '"' in line and line.count('"') % 2 and not inches:
            raise file_error(path, "a quote is opened and not closed", line_of(len(rows)))
        row = line.split(delimiter) if inches else split_cells(line, delimiter)
        if len(row) != width and delimiter is None:
            mended = next((each for each in _mended(line, width) if len(each) == width), None)
            if mended is not None:
                cut_rows += "'" not in line
                row = mended
        if len(row) != width:
            cut = "truncated: " if len(rows) == len(kept) - 1 and len(row) < width else ""
            even = delimiter is None and not rows and len(row) > 1 < len(kept)
            whole = even and {len(each.split()) for each in kept} == {len(row)}
            others = [mark for mark in (",", "\t", ";", "|") if mark != delimiter and line.count(mark) == width - 1]
            hint = f" (it has {width} when cut at {others[0]!r}: another delimiter?)" if others and delimiter else ""
            advice = SALVAGE if cut and not whole else FIRST_COLUMNS if whole else ""
            rule = f"{cut}{len(row)} values where {width} columns are defined{hint}{advice}"
            raise file_error(path, rule, line_of(len(rows)))
        rows.append(row)
    if cut_rows:
        remarks.append(
            f"{cut_rows} rows held numbers without a blank between (12.5-999.25): cut before the minus, or after the "
            "decimals that all numbers of the row have"
        )
    return rows


def _mended(line: str, width: int) -> Iterator[list[str]]:
    """Yield the cells of a line between blanks that has too few or too many, by one rule each.

    Numbers meet at a minus; numbers of fixed decimals meet behind these; fields that overflowed are all asterisks; or
    single quotes hold blanks.
    """
    cells = RUN_TOGETHER.sub(" -", line).split()
    yield cells
    decimals = {len(cell) - cell.index(".") - 1 for cell in cells if cell.count(".") == 1}
    if len(decimals) == 1 and 0 not in decimals:
        cells = re.sub(rf"(?<=\d)(\.\d{{{decimals.pop()}}})(?=\d)", r"\1 ", " ".join(cells)).split()
        yield cells
    short = width - len(cells)
    stars = [at for at, cell in enumerate(cells) if OVERFLOW.fullmatch(cell) and len(cell) > 2 * short]
    if short > 0 and len(stars) == 1:
        yield [*cells[: stars[0]], *["*"] * (short + 1), *cells[stars[0] + 1 :]]
    yield [cell.strip("'\"") for cell in QUOTED.findall(line)]


def split_cells(line: str, delimiter: str | None) -> list[str]:
    """Return the cells of one line. A delimiter between quotes is part of a cell."""
    if '"' in line:
        text = line.strip() if delimiter is None else line
        with suppress(csv.Error):  # csv refuses a cell of more than 128 KiB
            blanks = delimiter is None or f'{delimiter} "' in text
            cells = next(csv.reader([text], delimiter=delimiter or " ", skipinitialspace=blanks))
            return [cell for cell in cells if cell or delimiter]
    return line.split(delimiter)


def _wrapped(path: Path, kept: list[str], line_of: Callable[[int], int], names: list[str]) -> Rows:
    cells = [cell for line in kept for cell in line.split()]
    width = len(names)
    count, odd = divmod(len(cells), width)
    if odd:
        rule = f"truncated: {len(cells)} wrapped values are not a multiple of {width} columns"
        raise file_error(path, rule, line_of(len(kept) - 1))
    starts = [number for number, line in enumerate(kept) for _ in line.split()][::width]
    columns = [column_of(cells[position::width]) for position in range(width)]
    return Rows(columns, count, lambda row: line_of(starts[row]))


def _is_wrapped(kept: list[str], width: int) -> bool:
    """Return whether the rows of ``width`` cells repeat one pattern of several lines, such as 1 cell and then 5."""
    pattern: list[int] = []
    for line in kept[:width]:
        if sum(pattern) >= width:
            break
        pattern.append(len(line.split()))
    if len(pattern) < 2 or sum(pattern) != width or len(kept) % len(pattern):
        return False
    return all(len(line.split()) == pattern[at % len(pattern)] for at, line in enumerate(kept))


def column_of(cells: list[str]) -> Array:
    """Return cells as numbers, masked where cells are empty, or as text if a cell is neither empty nor a number.

    The numbers are float64, or int64 as `read_rows` describes.
    """
    every = "".join(cells)
    try:
        if not every.isascii() or "_" in every:
            raise ValueError
        numbers, empty = np.array(cells, dtype=np.float64), np.zeros(len(cells), dtype=bool)
    except ValueError:
        bare = [cell.strip() for cell in cells]
        empty = np.array([cell in _NULLS or OVERFLOW.fullmatch(cell) is not None for cell in bare])
        try:
            numbers = np.array(
                [0.0 if gone else np.nan if WINDOWS_NAN.fullmatch(cell) else to_float(cell)
                 for cell, gone in zip(bare, empty, strict=True)], dtype=np.float64,
            )  # fmt: skip
        except ValueError:
            return np.array(["" if gone else cell for cell, gone in zip(cells, empty, strict=True)], dtype=np.str_)
    if (np.abs(numbers) >= EXACT).any():
        bare = ["0" if gone else cell.strip() for cell, gone in zip(cells, empty, strict=True)]
        fits = all(WHOLE.fullmatch(cell) for cell in bare) and all(-(2**63) <= int(cell) < 2**63 for cell in bare)
        if fits and not empty.any():
            return np.array([int(cell) for cell in bare], dtype=np.int64)
    return np.ma.MaskedArray(numbers, empty) if empty.any() else numbers

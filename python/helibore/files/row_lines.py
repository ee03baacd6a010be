"""Which lines of a text are rows: cells over several lines become one, and lines that are no rows become empty.

    1,9.5,"tied on         1,9.5,"tied on to surface"
    to surface"            <empty>
    Average,9.4,           <empty>

The number of lines does not change, so that errors and remarks name the lines of the file.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from helibore.base.arrays import Array
from helibore.base.errors import InputError
from helibore.files.input_file import InputFile
from helibore.files.number_rows import NULL_TEXTS, OVERFLOW, WINDOWS_NAN, Rows, read_rows, split_cells
from helibore.files.number_spellings import is_like_a_number
from helibore.files.text_layouts import TextRules

MOST_LINES_OF_A_CELL = 50
"""A quoted cell may run over so many lines; a quote that is opened and not closed within them is an error."""

OPENED = re.compile(r'(?:^|[,;\t|])\s*"(?:[^"]|"")*$')
"""The end of a line whose last cell is quoted, and goes on in the next line."""

CLOSED = re.compile(r'(?:[^"]|"")*"\s*(?:[,;\t|]|$)')
"""The start of a line that ends such a cell."""

WORD = re.compile(r"[^\W\d_]{2}")
SAMPLE = 50
"""Cells at the start of a column that show whether it holds numbers."""

NOT_FINITE = re.compile(r"[+-]?(nan|inf|infinity)", re.IGNORECASE)


def join_quoted(text: str) -> str:
    """Return a text in which each quoted cell stands in one line; empty lines follow, so that no number changes."""
    if '"' not in text:
        return text
    lines = text.split("\n")
    at = 0
    while at < len(lines):
        if lines[at].count('"') % 2 and OPENED.search(lines[at]):
            below = range(at + 1, min(at + MOST_LINES_OF_A_CELL, len(lines)))
            end = next((line for line in below if lines[line].count('"') % 2), None)
            if end is not None and CLOSED.match(lines[end]):
                lines[at] = " ".join(line.strip(" \r") for line in lines[at : end + 1])
                lines[at + 1 : end + 1] = [""] * (end - at)
                continue  # the last cell of the line that was added may go on, too
        at += 1
    return "\n".join(lines)


def read_rows_without_notes(
    source: InputFile, text: str, first_line: int, names: list[str], delimiter: str | None, rules: TextRules,
    head: Iterable[str] = (), **how: Any,
) -> Rows:  # fmt: skip
    """Read rows as `read_rows` does; if a line is no row, read them without the lines that the rules name.

    ``head`` are the lines of titles, names and units, which programs repeat on each page.
    """
    found, error = None, None
    try:
        found = read_rows(source.path, text, first_line, names, delimiter, **how)
    except InputError as refused:
        error = refused
    if found is not None and not any(_has_notes(column, rules) for column in found.columns if column.dtype.kind == "U"):
        return found
    cleaned, remark = _without_notes(text, first_line, len(names), delimiter, rules, head)
    if not remark:
        if found is None:
            raise error or AssertionError
        return found
    again = read_rows(source.path, cleaned, first_line, names, delimiter, **how)
    return replace(again, remarks=[*again.remarks, remark])


def _has_notes(column: Array, rules: TextRules) -> bool:
    """Return whether a text column has words among numbers, or ends in a word of a footer."""
    cells = column.tolist()
    numbers = [is_like_a_number(cell) for cell in cells[:SAMPLE]]
    if rules.is_footer(cells[-1]):
        return True
    return 2 * sum(numbers) > len(numbers) and WORD.search("\n".join(cells)) is not None


def _without_notes(
    text: str, first_line: int, width: int, delimiter: str | None, rules: TextRules, head: Iterable[str]
) -> tuple[str, str]:
    """Return the text with the lines that are no rows emptied, and a remark on these lines ("" without such a line)."""
    lines = text.split("\n")
    cells = {
        at: [_filled(cell) for cell in split_cells(line, delimiter)] for at, line in enumerate(lines) if line.strip()
    }
    numbers = {at: [_is_value(cell) for cell in row] for at, row in cells.items()}
    repeated = {" ".join(line.split()) for line in head} - {""}
    gone: list[int] = []
    for at, row in cells.items():
        same = " ".join(lines[at].split()) in repeated and not all(numbers[at])
        comment = rules.is_comment(lines[at]) and len(row) != width
        if same or comment or (rules.is_never_row(lines[at]) and not numbers[at][0]):
            gone.append(at)
    left = [at for at in cells if at not in set(gone)]
    gone += left[len(left) - footers([cells[at] for at in left], width, rules) :]
    return _emptied(lines, sorted(gone), first_line)


def footers(rows: list[list[str]], width: int, rules: TextRules) -> int:
    """Return how many of the last rows are footers; empty rows among them count, empty rows alone do not."""
    rows = [[_filled(cell) for cell in row] for row in rows]
    numbers = [[_is_value(cell) for cell in row] for row in rows]
    of_numbers = [row for row in numbers if len(row) == width and any(row)]
    sample = of_numbers[: max(1, len(of_numbers) - 1)][:100]
    numeric = {column for column in range(width) if 2 * sum(row[column] for row in sample) > len(sample)}
    last = rows[-1] if rows else []
    named = [row[0] for row in rows[:-1] if len(row) == width]
    if len(named) > 1 and len(set(named)) == 1 and last[0] != named[0] and last[0].lower() in rules.footers:
        return 1  # the sum of a well: Total stands where each row names the well
    count = found = 0
    for row, are_numbers in zip(reversed(rows), reversed(numbers), strict=True):
        if any(row) and not _is_footer(row, are_numbers, width, numeric, rules):
            break
        count += 1
        found = count if any(row) or found else 0
    return count if found else 0


def _filled(cell: str) -> str:
    """Return a cell without blanks around it, "" for a text that means an empty cell, or a number that overflowed."""
    bare = cell.strip()
    return "" if bare in NULL_TEXTS or OVERFLOW.fullmatch(bare) else bare


def _is_value(cell: str) -> bool:
    """Return whether a cell is a number in any spelling, or not-a-number or infinity as a text."""
    return is_like_a_number(cell) or bool(WINDOWS_NAN.fullmatch(cell) or NOT_FINITE.fullmatch(cell))


def _is_footer(row: list[str], numbers: list[bool], width: int, numeric: set[int], rules: TextRules) -> bool:
    """Return whether a line below the rows is a footer: text stands where the rows have a number.

    A row that is cut begins with a digit, as the others do. A line with a number in it is a footer if it has another
    count of cells, or begins with a word of the table of rules.
    """
    first = next(column for column, cell in enumerate(row) if cell)
    if first not in numeric or numbers[first] or row[first].lstrip("+-.")[:1].isdigit():
        return False
    return len(row) != width or not any(numbers) or rules.is_footer(row[first])


def _emptied(lines: list[str], gone: list[int], first_line: int) -> tuple[str, str]:
    if not gone:
        return "\n".join(lines), ""
    kept = list(lines)
    for at in gone:
        kept[at] = ""
    texts = [lines[at].strip(" \t\r\f,;|") for at in gone]
    shown = next(filter(None, texts))
    listed = ", ".join(str(first_line + at) for at in gone[:5]) + (" ..." if len(gone) > 5 else "")
    what = f"line {listed} is no row" if len(gone) == 1 else f"lines {listed} are no rows"
    return "\n".join(kept), f"{what}: {shown[:60]}"

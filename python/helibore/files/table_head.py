"""The head of a table whose rows are cut into cells: titles, names in one or two lines, units, descriptions.

Well A-7,,,             a title
Measured,Hole,Hole,     words of the names below them, or names of groups of columns
Depth,Dev,Azi,TVD       names
m,deg,deg,m             units
...,...,...,...         texts between units and numbers describe the columns
0,0,0,0                 numbers
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field

from helibore.base import units as units_of
from helibore.files.headings import is_units_row
from helibore.files.number_spellings import is_like_a_number
from helibore.files.text_layouts import TextRules

LONGEST_UNIT = 12
"""Letters of a text in a row of units, most of which are known."""

PHRASE = re.compile(r"\S+(?: \S+)*")


@dataclass
class TableHead:
    """The names of the columns, their units and descriptions, the first row of numbers, and titles as texts."""

    names: list[str]
    units: list[str] | None
    descriptions: list[str] | None
    first: int
    titles: list[str] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)


def find_head(rows: list[list[str]], rules: TextRules) -> TableHead | None:
    """Find the head of a table in its first rows; None if no row has numbers, or no row above them has names."""
    width = max(map(len, rows))
    rows = [[*(cell.strip() for cell in row), *[""] * (width - len(row))] for row in rows]
    numbers = [[is_like_a_number(cell) for cell in row] for row in rows]
    below = numbers[len(numbers) // 2 :]
    numeric = [column for column in range(width) if 2 * sum(row[column] for row in below) >= len(below)]
    enough = max(1, (len(numeric) + 1) // 2)
    first = next((at for at, row in enumerate(numbers) if sum(row[column] for column in numeric) >= enough), None)
    if not numeric or not first:
        return None
    lines = [row for row in rows[:first] if any(row)]
    at_units = next((at for at in range(len(lines) - 1, 0, -1) if are_units(lines[at])), None)
    units = None if at_units is None else [cell.strip("()[] ") for cell in lines[at_units]]
    described = [] if at_units is None else lines[at_units + 1 :]
    titles = [_text(row) for row in described if sum(map(bool, row)) < 2]
    described = [row for row in described if sum(map(bool, row)) > 1]
    names = lines if at_units is None else lines[:at_units]
    while names and (any(map(is_like_a_number, names[0])) or _is_title(names[0], rules)):
        titles.append(_text(names.pop(0)))
    while len(names) > 1 and _is_title(names[-1], rules):  # a datum below the names
        titles.append(_text(names.pop()))
    if not names or sum(map(bool, names[-1])) < max(1, len(numeric) // 2):
        return None
    found = names[-1]
    remarks = []
    if len(names) > 1 and (not _are_names(found) or _has_words_of_names(names[-2], rules)):
        found = _joined(names[-2], found)
        remarks.append(f"the names of the columns stand in two lines: {', '.join(filter(None, found[:4]))} ...")
        del names[-2]
    titles += [_text(row) for row in names[:-1]]
    return TableHead(found, units, described[0] if described else None, first, titles, remarks)


def are_units(cells: list[str]) -> bool:
    """Return whether a row above numbers holds units: all are known, or most are and the others are as short."""
    if is_units_row(cells):
        return True
    filled = [cell.strip("()[] ") for cell in cells if cell.strip("()[] -")]
    known = sum(is_units_row([cell]) or bool(units_of.measures(cell)) for cell in filled)
    return len(filled) > 1 and 2 * known >= len(filled) and all(len(c) <= LONGEST_UNIT and " " not in c for c in filled)


def joined_phrases(upper: str, lower: str, names: list[str], rules: TextRules) -> list[str] | None:
    """Return names between blanks with the words of the line above them; None if they do not belong together.

    Each phrase of the upper line must stand over one name, and no two over the same.
    """
    words = list(re.finditer(r"\S+", lower) if len(lower.split()) == len(names) else PHRASE.finditer(lower))
    above = list(PHRASE.finditer(upper))
    if len(words) != len(names) or "\t" in upper or "\t" in lower:
        return None
    over = {}
    for phrase in above:
        under = [at for at, word in enumerate(words) if word.start() < phrase.end() and phrase.start() < word.end()]
        if len(under) != 1 or under[0] in over:
            return None
        over[under[0]] = phrase[0]
    row = [over.get(at, "") for at in range(len(names))]
    if not over or (_are_names(names) and not _has_words_of_names(row, rules)):
        return None
    return _joined(row, names)


def _text(row: list[str]) -> str:
    return ", ".join(filter(None, row))


def _are_names(row: list[str]) -> bool:
    """Return whether each cell has a name of its own; the cells at the start and end that are empty do not count."""
    filled = [at for at, cell in enumerate(row) if cell]
    inner = row[filled[0] : filled[-1] + 1]
    return all(inner) and len(set(inner)) == len(inner)


def _is_title(row: list[str], rules: TextRules) -> bool:
    return sum(map(bool, row)) == 1 < len(row) and not _has_words_of_names(row, rules)


def _has_words_of_names(row: list[str], rules: TextRules) -> bool:
    """Return whether a row has only words that belong to the names below them, such as Measured above Depth."""
    words = set(rules.name_words)
    return all(set(re.findall(r"\w+", cell.lower())) <= words for cell in row if cell) and any(row)


def _joined(upper: list[str], lower: list[str]) -> list[str]:
    """Return the names of two lines; the name of a group counts for the columns after it where names repeat else."""
    names = [" ".join(filter(None, pair)) for pair in zip(upper, lower, strict=True)]
    if max(Counter(filter(None, names)).values()) > 1:
        group, filled = "", []
        for cell in upper:
            group = cell or group
            filled.append(group)
        names = [" ".join(filter(None, pair)) if pair[1] else pair[0] for pair in zip(filled, lower, strict=True)]
    return names

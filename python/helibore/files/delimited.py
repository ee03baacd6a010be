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
from helibore.files.number_rows import NULL_TEXTS, column_of, split_cells
from helibore.files.number_spellings import is_like_a_number, read_spellings
from helibore.files.raw_set import EXACT, Channel, RawFile, RawSet, unique
from helibore.files.row_lines import join_quoted, read_rows_without_notes
from helibore.files.table_head import are_units, find_head, joined_phrases
from helibore.files.text_layouts import StatedLayout, TextRules, text_rules

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

_AROUND_COMMENT = " #\t!%/*"
_AROUND_TITLE = " \t\r,;|"
MOST_TITLES = 20
"""The most lines with text above the names of the columns that are taken for titles."""

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
    descriptions: list[str] | None = None
    head: list[str] = field(default_factory=list)  # the lines above the rows


def read(source: InputFile) -> RawFile:
    """Open a delimited table."""
    head, remark, whole = _head_text(source)
    rules = text_rules(source.options.layouts)
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
        text = text if whole else join_quoted(text)
        if found_later and not remark:  # the text is not UTF-8 below the first 2 MiB
            layout.remarks.append(found_later)
        below, salvage = "".join(text.split("\n", layout.skip)[layout.skip :]), source.options.salvage
        found = read_rows_without_notes(
            source, below, layout.skip + 1, names, layout.delimiter, rules, layout.head, salvage=salvage
        )
        columns, line_of = found.columns, found.line_of
        layout.remarks += found.remarks
    columns, units_of_texts, remarks = read_spellings(columns, names, layout.delimiter == ",", source.options.decimal)
    layout.remarks += remarks
    stated = _units_of_comments(layout, rules)
    channels = []
    for position, (name, values) in enumerate(zip(names, columns, strict=True)):
        unit = layout.units[position] if layout.units else unit_in_name(layout.names[position])
        unit = unit or units_of_texts.get(position, "") or stated.get(name.upper(), "")
        described = layout.descriptions[position] if layout.descriptions else ""
        channels.append(Channel(name, unit, described, values, source.nulls, nan_is_missing=False))
    rows = len(columns[0])
    comments = [remark.removeprefix(COMMENT).partition(":") for remark in layout.remarks if remark.startswith(COMMENT)]
    header = {name.strip(): text.strip() for name, colon, text in comments if colon}
    facts, remark = read_facts(source.path)
    layout.remarks += [remark] if remark else []
    header |= facts
    return RawFile("csv", [RawSet(source.path, "table", channels, rows, None, header, layout.remarks, line_of)])


def _units_of_comments(layout: TableLayout, rules: TextRules) -> dict[str, str]:
    """Return the units by column that comments state, as in a Petrel trace, and add a remark on them."""
    found: dict[str, str] = {}
    for rule in reversed(rules.units):
        for remark in layout.remarks:
            if match := rule.comment.search(remark):
                found |= dict.fromkeys((name.upper() for name in rule.columns), match["unit"].lower())
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
    text, remark = decode(source.path, head)
    return join_quoted(text), remark, not more


def find_layout(source: InputFile, head: str) -> TableLayout:
    """Find delimiter, header and units row in the first lines of a file.

    Raise an InputError if the file is no table, or if the stated header line is not a line with text.
    """
    remarks = []
    lines = head.split("\n", HEADING_LINES)[:HEADING_LINES]
    start, header_line = 0, source.options.header_line
    rules = text_rules(source.options.layouts)
    if header_line is None and (layout := rules.layout_of(lines)):
        return _by_stated_layout(source, lines, layout)
    stated = STATED_DELIMITER.fullmatch(lines[0])
    if stated:
        start = 1
    if header_line is not None:
        start = header_line - 1
        if not 0 <= start < len(lines) or not lines[start].strip():
            rule = f"must be the line of the column names, within the first {HEADING_LINES}"
            raise InputError(f"{source.path.name}: header_line", rule, str(header_line))
    while header_line is None and start < len(lines) and _is_above_names(lines[start], rules):
        if comment := lines[start].strip(_AROUND_COMMENT):
            remarks.append(f"{COMMENT}{comment}")
        start += 1
    filled = [line for line in lines[start:] if line.strip()]
    if header_line is None:
        filled = [line for line in filled if not rules.is_never_row(line) or line.strip()[:1].isdigit()]
    if not filled:
        raise source.error(f"no header and no rows within {HEADING_LINES} lines", start)
    titles = [] if stated or header_line is not None else _titles(filled)
    remarks += [f"{COMMENT}{title.strip(_AROUND_TITLE)}" for title in titles]
    filled = filled[len(titles) :]
    start = lines.index(filled[0], start)
    rows = [
        filled[0],
        *dropwhile(lambda line: line.startswith("#") and re.split(r"[,;|\s]", line)[0] not in NULL_TEXTS, filled[1:]),
    ]  # Petrel underlines its header by #===
    delimiter = stated["mark"] if stated else _delimiter(source, rows, start + 1)
    header = rules.bare(rows[0]) if rows[0].startswith("#") else rows[0]
    if delimiter is None:
        first = _names_between_blanks(header, len(rows[-1].split()))
    else:
        first = [cell.strip() for cell in split_cells(header, delimiter)]
    second = [cell.strip() for cell in split_cells(rows[1], delimiter)] if len(rows) > 1 else []
    if header_line is None and _are_values(first, second):
        return _without_header(lines, start, delimiter, len(first), remarks, rules)
    if any(not cell for cell in first) and not first[-1] and second and not second[-1]:
        remarks.append("the header and the rows end in a delimiter: the last column has no name")
    if delimiter is None and titles and (joined := joined_phrases(titles[-1], header, first, rules)):
        first = joined
        remarks.append(f"the names of the columns stand in two lines: {', '.join(joined[:4])} ...")
    units = descriptions = None
    skip = lines.index(rows[1], start + 1) if len(rows) > 1 else lines.index(rows[0], start) + 1
    if len(second) == len(first) and are_units(second) and not any(map(is_like_a_number, second)):
        units = [cell.strip("()[] ") for cell in second]
        skip = lines.index(rows[1], skip) + 1
    top = rows[2 if units else 1 : 3]
    below = [cell.strip() for cell in split_cells(top[0], delimiter)] if top else []
    texts = [cell for cell in below if cell not in NULL_TEXTS]
    no_numbers = texts and not any(map(is_like_a_number, texts))
    if header_line is None and len(below) > 1 and (no_numbers or not all(first)):
        cells = [split_cells(row, delimiter) for row in rows[:40]]
        found = find_head([row for row in cells if len(row) == len(cells[0])], rules)
        if found is not None:
            first, units, descriptions = found.names, found.units, found.descriptions
            remarks += [*(f"{COMMENT}{title}" for title in found.titles), *found.remarks]
            of_numbers = [at for at, row in enumerate(cells) if len(row) == len(cells[0])][found.first]
            skip = start
            for row in rows[: of_numbers + 1]:
                skip = lines.index(row, skip) + 1
            skip -= 1
    names = [cell.strip('"') or f"column {number}" for number, cell in enumerate(first, 1)]
    names = _with_row_names(names, rows, delimiter, remarks)
    return TableLayout(delimiter, names, units, skip, remarks, descriptions, [line.strip() for line in lines[:skip]])


def _is_above_names(line: str, rules: TextRules) -> bool:
    """Return whether a line above the names is empty, a comment, or holds only delimiters."""
    return not line.strip(" \t\r\f,;|") or rules.is_comment(line)


def _are_values(first: list[str], second: list[str]) -> bool:
    """Return whether the first line of a table is a row: all cells are numbers, or those that are in the next row."""
    numbers = [is_number(cell) for cell in first]
    alike = not second or numbers == [is_number(cell) for cell in second]
    begins = numbers[0] or first[0][:1].isdigit() or (second[:1] == first[:1] and first[0] != "")
    return all(numbers) or (begins and sum(numbers) > 1 and alike)


def _with_row_names(names: list[str], rows: list[str], delimiter: str | None, remarks: list[str]) -> list[str]:
    """Return the names with one for the numbers of the rows, "1", "2" ..., which R writes in quotes without a name."""
    cells = [split_cells(row, delimiter) for row in rows[1:20]]
    counted = all(row.lstrip().startswith(f'"{number}"') for number, row in enumerate(rows[1:20], 1))
    if len(cells) < 2 or not counted or {len(row) for row in cells} != {len(names) + 1}:
        return names
    remarks.append("the first column counts the rows, and has no name: it is called row")
    return ["row", *names]


def _by_stated_layout(source: InputFile, lines: list[str], stated: StatedLayout) -> TableLayout:
    """Return the layout of a table by a rule that states where its names and its rows are."""

    def after(pattern: Any, start: int) -> int:
        found = next((at for at in range(start, len(lines)) if pattern.search(lines[at])), None)
        if found is None:
            raise source.error(f"has the layout {stated.name!r}, but no line fits {pattern.pattern!r}", start + 1)
        return found + 1

    skip = after(stated.line, 0)
    names = list(stated.names)
    if stated.names_from is not None and stated.names_to is not None:
        start = after(stated.names_from, 0)
        skip = after(stated.names_to, start)
        names = [line.strip() for line in lines[start : skip - 1] if line.strip()]
    if stated.rows_after is not None:
        skip = after(stated.rows_after, skip - 1)
    if not names:
        raise source.error(f"has the layout {stated.name!r}, but no names", skip)
    if stated.units and len(stated.units) != len(names):
        raise source.error(f"the layout {stated.name!r} has {len(stated.units)} units for {len(names)} names", skip)
    units = list(stated.units) or None
    head = [line.strip() for line in lines[:skip]]
    return TableLayout(stated.mark, names, units, skip, [f"read by the layout {stated.name!r}"], None, head)


def _titles(lines: list[str]) -> list[str]:
    """Return the lines above the names of the columns (``Well: A-7``): a delimiter cuts only what follows evenly.

    The names are the first line of that, and none of them is a number or empty.
    """
    for count in range(min(MOST_TITLES + 1, len(lines) - 2)):
        for mark in DELIMITERS:
            cells = [split_cells(line, mark) for line in lines[count : count + 20]]
            if len(cells[0]) > 1 and len({len(row) for row in cells}) == 1:
                above = [split_cells(line, mark) for line in lines[:count]]
                if any(len(row) > 1 and all(map(is_number, row)) for row in above):
                    return []  # these are rows of another table
                named = not any(is_number(cell) or not cell.strip() for cell in cells[0])
                return lines[:count] if named else []
    return _titles_between_blanks(lines[: MOST_TITLES + 20])


def _titles_between_blanks(lines: list[str]) -> list[str]:
    """Return the lines above the names of columns that blanks separate, as programs print surveys and logs.

    The rows are the first lines that begin with a number and have equally many cells; above them stand the names, and
    perhaps a row of units between.
    """
    likely = [line.strip()[:1].isdigit() or line.strip()[:2].lstrip("+-.")[:1].isdigit() for line in lines]
    widths = [len(line.split()) if row else 0 for line, row in zip(lines, likely, strict=True)]
    first = next(
        (
            at
            for at in range(1, len(lines))
            if widths[at] > 1 and (all(likely[at:]) or widths[at] in widths[at + 1 : at + 2])
        ),
        None,
    )
    if first is None or len({width for width in widths[first:] if width}) > 1:
        return []
    width = widths[first]
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


def _without_header(
    lines: list[str], start: int, delimiter: str | None, width: int, remarks: list[str], rules: TextRules
) -> TableLayout:
    """Return the layout of a table without a header.

    The last comment line above the rows that has ``width`` names, two or more, names the columns. If there is no such
    comment line, the columns are named by number.
    """
    for line in reversed(lines[:start]):
        names = [cell.strip() for cell in split_cells(rules.bare(line), delimiter)]
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
    if len(rows) == 1 and is_number(sample[0].split()[0]) and len(sample[0].split()) > 1 and widths[likely][0] == 1:
        return None  # one row
    counts = Counter(len(row.split()) for row in sample[1:])
    for usual, count in counts.items() if widths[likely][0] == 1 else ():
        numbered = usual == len(sample[0].split()) + 1  # R counts the rows in a column without a name
        named = numbered or len(_names_between_blanks(sample[0], usual)) == usual
        if named and usual > 1 and 2 * count >= len(sample) - 1:
            return None  # the other lines are footers, or number_rows names them
    if widths[likely][0] > 1:
        return likely  # rows of different widths: number_rows names the bad row
    if len(sample) > 1 and len(rows[0].split()) > 1:
        rule = (
            "blanks separate the columns: as many names as cells must be there, or a delimiter; a file of rules "
            "(reading.layouts) can state names and rows"
        )
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

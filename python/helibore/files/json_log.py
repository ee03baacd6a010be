"""Read JSON Well Log Format: [{header, curves: [{name, unit, valueType, dimensions}], data: [[...], ...]}, ...].

One RawSet for each log. A curve with ``dimensions`` K > 1 holds arrays of K values and becomes an (n, K) channel.

The ISCWSA standard wells have another form; one RawSet is made for each well: {"wells": {name: {"MD": [...],
"IncDeg": [...], "header": {"depth_unit": ...}}}}. Tables of data frames have one RawSet with a channel for each column:
records [{"MD": 1.0, ...}, ...], columns {"MD": [1.0, ...]}, or {"columns": [...], "data": [[...]]}. A JSON file is read
into memory as a whole, so its size is limited.
"""

from __future__ import annotations

import gc
import json
from collections.abc import Iterable, Sequence
from contextlib import suppress
from functools import partial
from itertools import chain
from typing import Any

import numpy as np

from helibore.base.arrays import Array
from helibore.base.limits import check_limit
from helibore.files.headings import unit_in_name
from helibore.files.input_file import InputFile, decode, read_exactly
from helibore.files.number_rows import column_of
from helibore.files.raw_set import Channel, Loss, RawFile, RawSet, readable_sets, unique

SIZE_LIMIT = 1 << 28
"""Largest JSON text (bytes) that is read; the parser needs about ten times its size in memory."""

EMPTY_FREE, EMPTY_RATIO = 1 << 20, 200
"""A curve of arrays may have ``EMPTY_FREE`` cells, and ``EMPTY_RATIO`` more for each cell that the file writes out.

A null in place of an array stands for K empty cells, so a small file could otherwise fill the memory.
"""

WELL_UNITS = {"MD": "depth_unit", "TVD": "depth_unit", "N": "surface_unit", "E": "surface_unit"}
"""For each column of a standard well, the key of the well's header that states the unit."""


def read(source: InputFile) -> RawFile:
    """Open a file in JSON Well Log Format, or a JSON file of the ISCWSA standard wells."""
    collecting = gc.isenabled()
    gc.disable()  # scans of the tree of lists would take a third of the time to read a large log
    try:
        return _read(source)
    finally:
        if collecting:
            gc.enable()


def _read(source: InputFile) -> RawFile:
    tree = _parse(source)
    if isinstance(tree, dict) and isinstance(tree.get("wells"), dict):
        wells = tree["wells"].items()
        return RawFile("JSON wells", readable_sets(partial(_well, source, str(n), well) for n, well in wells))
    if (columns := _table(tree)) is not None:
        return RawFile("JSON table", [_table_set(source, columns)])
    logs = tree if isinstance(tree, list) else [tree]
    if not logs or not all(isinstance(log, dict) and "curves" in log and "data" in log for log in logs):
        raise source.error('not JSON Well Log Format: each log must hold "header", "curves" and "data"')
    names = unique([_header(log).get("name") or "log" for log in logs])
    readers = [partial(_log, source, name, log) for name, log in zip(names, logs, strict=True)]
    return RawFile("JSON Well Log Format", readable_sets(readers))


def _table(tree: Any) -> dict[str, list[Any]] | None:
    """Return the columns of a table as data frames are written: records, columns, or {columns, data}; else None."""
    plain = (str, int, float, bool, type(None))
    if isinstance(tree, dict) and isinstance(tree.get("columns"), list) and isinstance(tree.get("data"), list):
        rows = tree["data"]
        if not rows or not all(isinstance(row, list) and len(row) == len(tree["columns"]) for row in rows):
            return None
        columns = {str(name): [row[at] for row in rows] for at, name in enumerate(tree["columns"])}
    elif isinstance(tree, list) and tree and all(isinstance(row, dict) for row in tree):
        names = dict.fromkeys(name for row in tree for name in row)
        columns = {name: [row.get(name) for row in tree] for name in names}
    elif isinstance(tree, dict) and tree and all(isinstance(column, list | dict) for column in tree.values()):
        rows = [list(column) for column in tree.values() if isinstance(column, dict)]
        if any(each != rows[0] for each in rows):
            return None
        columns = {name: list(column.values() if isinstance(column, dict) else column) for name, column in tree.items()}
        if len({len(column) for column in columns.values()}) > 1:
            return None
    else:
        return None
    flat = all(isinstance(cell, plain) for column in columns.values() for cell in column)
    return columns if columns and flat and any(columns.values()) else None


def _table_set(source: InputFile, columns: dict[str, list[Any]]) -> RawSet:
    check_limit(source.path.name, "columns", len(columns))
    channels = []
    for name, cells in columns.items():
        values = column_of(["" if cell is None else str(cell) for cell in cells])
        channels.append(Channel(name, unit_in_name(name), "", values, source.nulls))
    return RawSet(source.path, "table", channels, len(next(iter(columns.values()))), None)


def _parse(source: InputFile) -> Any:
    content = b""
    if source.path.stat().st_size <= SIZE_LIMIT:
        with source.stream() as stream:
            content = read_exactly(stream, SIZE_LIMIT + 1)
    if len(content) > SIZE_LIMIT or not content:
        raise source.error(f"more than {SIZE_LIMIT >> 20} MiB of JSON, which is read whole; split the file")
    text, _ = decode(source.path, content)
    try:
        return json.loads(text)
    except json.JSONDecodeError as error:
        cut = "" if text[error.pos :].strip() else "truncated: "
        raise source.error(f"{cut}{error.msg} (character {error.colno})", error.lineno) from error
    except (RecursionError, ValueError) as error:  # nested too deep, or an integer of thousands of digits
        raise source.error(f"not sensible JSON ({type(error).__name__})") from error


def _header(log: dict[str, Any]) -> dict[str, str]:
    """Return the header of one log as texts, without null entries; a header that is no JSON object counts as empty."""
    header = log.get("header")
    stated = header.items() if isinstance(header, dict) else ()
    return {str(key): str(value) for key, value in stated if value is not None}


def _log(source: InputFile, name: str, log: dict[str, Any]) -> RawSet:
    """Return the set of one log, its rows of cells turned into columns."""
    curves, rows = log["curves"], log["data"]
    if not isinstance(curves, list) or not curves or not all(isinstance(c, dict) and c.get("name") for c in curves):
        raise source.error(f'{name}: "curves" must be a list of objects with a name')
    if not isinstance(rows, list) or not rows:
        raise source.error(f'{name}: "data" has no rows')
    width = len(curves)
    if set(map(type, rows)) != {list} or set(map(len, rows)) != {width}:
        number, row = next((n, row) for n, row in enumerate(rows) if not isinstance(row, list) or len(row) != width)
        size = len(row) if isinstance(row, list) else "no list of"
        raise source.error(f"{name}, row {number}: {size} values where {width} curves are defined")
    labels = unique([str(curve["name"]) for curve in curves])
    columns: Iterable[Sequence[Any] | Array] = zip(*rows, strict=True)
    if set(map(type, chain.from_iterable(rows))) <= {int, float} and not any(
        c.get("dimensions", 1) != 1 for c in curves
    ):
        with suppress(OverflowError):
            columns = np.fromiter(chain.from_iterable(rows), np.float64, width * len(rows)).reshape(-1, width).T.copy()
    channels = []
    for curve, label, cells in zip(curves, labels, columns, strict=True):
        unit, described = (str(curve.get(key) or "") for key in ("unit", "description"))
        channels.append(Channel(label, unit, described, _column(source, label, curve, cells), source.nulls))
    return RawSet(source.path, name, channels, len(rows), labels[0], _header(log))


NUMBERS = {int, float, type(None)}


def _column(source: InputFile, name: str, curve: dict[str, Any], cells: Sequence[Any] | Array) -> Array:
    """Return one curve as numbers (null is NaN) or texts (null is ""). A cell of a wrong type raises an InputError."""
    if isinstance(cells, np.ndarray):
        return cells
    size = curve.get("dimensions") or 1
    if not isinstance(size, int) or size < 1:
        raise source.error("must be a whole number of at least 1", column=f"{name}: dimensions", value=repr(size))
    if size > 1:
        return _array_column(source, name, size, cells)
    types = set(map(type, cells))
    if types <= NUMBERS:
        return _floats(source, name, cells)
    if types & {list, dict}:
        row = next(row for row, cell in enumerate(cells) if isinstance(cell, list | dict))
        raise source.error("a list in a curve of one dimension", f"row {row}", name)
    if str(curve.get("valueType")).lower() in ("float", "integer"):
        row = next(row for row, cell in enumerate(cells) if type(cell) not in NUMBERS)
        raise source.error("is not a number", f"row {row}", name, repr(str(cells[row])[:40]))
    return np.array(["" if cell is None else str(cell) for cell in cells], dtype=np.str_)


def _array_column(source: InputFile, name: str, size: int, cells: Sequence[Any]) -> Array:
    stated = sum(len(cell) for cell in cells if isinstance(cell, list))
    if size * len(cells) > EMPTY_FREE + EMPTY_RATIO * stated:
        rule = f"{len(cells)} rows hold {stated} values, with more than {EMPTY_RATIO} empty cells for each value"
        raise source.error(rule, column=f"{name}: dimensions", value=str(size))
    empty = [None] * size
    rows = [empty if cell is None else cell for cell in cells]
    for row, cell in enumerate(rows):
        if not isinstance(cell, list) or len(cell) != size:
            raise source.error(f"must hold {size} values", f"row {row}", name)
    flat = list(chain.from_iterable(rows))
    if not set(map(type, flat)) <= NUMBERS:
        row = next(at for at, each in enumerate(flat) if type(each) not in NUMBERS) // size
        raise source.error("holds something that is not a number", f"row {row}", name)
    return _floats(source, name, flat).reshape(len(cells), size)


def _floats(source: InputFile, name: str, cells: Sequence[Any]) -> Array:
    try:
        return np.array(cells, dtype=np.float64)
    except OverflowError as error:
        raise source.error("holds a whole number too large for a float", column=name) from error


def _well(source: InputFile, name: str, well: Any) -> RawSet:
    """Return the set of one standard well: an object of lists, and a header that states their units.

    A list of another length than the first is left out, with a remark.
    """
    if not isinstance(well, dict) or not isinstance(well.get("header", {}), dict):
        raise source.error(f"well {name!r}: must be an object of columns")
    header = {str(key): str(value) for key, value in well.get("header", {}).items()}
    lists = {str(key): value for key, value in well.items() if isinstance(value, list)}
    if not lists:
        raise source.error(f"well {name!r}: holds no columns")
    rows = len(next(iter(lists.values())))
    if not rows:
        raise source.error(f"well {name!r}: no rows")
    channels = []
    remarks: list[str] = []
    for label, cells in lists.items():
        if len(cells) != rows:
            first = next(iter(lists))
            remarks.append(Loss(f"{label}: {len(cells)} values where {first} has {rows}; the channel is left out"))
            continue
        unit = header.get(WELL_UNITS[label], "") if label in WELL_UNITS else unit_in_name(label)
        channels.append(Channel(label, unit, "", _column(source, label, {}, cells), source.nulls))
    return RawSet(source.path, name, channels, rows, next(iter(lists)), header, remarks)

"""Read DLIS (RP66 V1) through dlisio: one RawSet for each frame of each logical file.

    frame row = [FRAMENO, index, channel (scalar), channel (K sectors), ...]      DIMENSION, AXIS, UNITS per channel

All rows of a frame are read once, when a caller first asks for a value. Reading one channel at a time would read the
file again and again (18 minutes instead of 0.6 minutes, dlisio issue 436). dlisio already reverses DIMENSION and AXIS
into C order. A channel with more than one dimension becomes (n, all elements), with a remark.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import cache, partial
from typing import Any

import numpy as np

from helibore.base.arrays import Array
from helibore.base.errors import InputError, needs
from helibore.base.limits import check_unpacked
from helibore.files.dlis_records import has_texts, rows_of
from helibore.files.headings import is_number
from helibore.files.input_file import SALVAGE, InputFile
from helibore.files.raw_set import Channel, Loss, RawFile, RawSet, SectorAxis, readable_sets, unique

WALKED = 1 << 20
"""A frame whose rows would have less than half this many bytes, and less than half of the file's, is walked."""


def read(source: InputFile) -> RawFile:
    """Open a DLIS file; the rows of a frame are read when they are first used."""
    with needs("dlisio", "dlis"):
        from dlisio import dlis
        from dlisio.common import Actions, ErrorHandler
    readers = []
    lost: list[str] = []
    critical = lost.append if source.options.salvage else Actions.RAISE
    with damage_named(source), dlisio_warnings() as warned, ExitStack() as opened:
        logical_files = opened.enter_context(dlis.load(str(source.path), error_handler=ErrorHandler(critical=critical)))
        for number, logical in enumerate(logical_files):
            label = f"{number}/" if len(logical_files) > 1 else ""
            frames, parameters = list(logical.frames), _parameters(logical)
            for name, frame in zip(unique([text_of(frame.name) for frame in frames]), frames, strict=True):
                readers.append(partial(_frame, source, label + name, frame, parameters))
        every = readable_sets(readers)
        sets = [one for one in every if one.rows]
        if not sets:
            raise source.error("DLIS without a frame that has rows")
        opened.pop_all()  # the rows are read later
    empty = ", ".join(one.name for one in every if not one.rows)
    for one in sets:
        one.remarks.extend([f"left out, because they have no rows: {empty}"] if empty else [])
        one.remarks.extend(sorted(warned))
        if lost:
            one.remarks.append(Loss(f"salvaged: {one.rows} rows lie before the damage; what follows it is lost"))
    return RawFile("DLIS", sets, logical_files.close)


@contextmanager
def damage_named(source: InputFile, what: str = "") -> Iterator[None]:
    """Turn any error of dlisio into an InputError that names the file and ``what`` (a frame, a log, a format)."""
    try:
        yield
    except InputError:
        raise
    except Exception as error:
        damage = source.damaged(f"{what or 'DLIS'}: truncated or damaged", error)
        raise InputError(damage.place, damage.rule + ("" if what or source.options.salvage else SALVAGE)) from error


@contextmanager
def dlisio_warnings() -> Iterator[set[str]]:
    """Collect dlisio's warnings, such as one on text that is not UTF-8, in a set that is filled when the block ends."""
    remarks: set[str] = set()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        yield remarks
    remarks.update(str(warning.message) for warning in caught)


def text_of(value: Any) -> str:
    """Return an attribute of DLIS or LIS as text (None: ""); bytes that dlisio did not decode are Windows-1252."""
    if isinstance(value, bytes):
        return value.decode("cp1252", "replace")
    return "" if value is None else str(value)


def _parameters(logical: Any) -> dict[str, str]:
    """Return the parameters of a logical file by name, as text; a number is followed by its unit.

    Damaged parameters are left out.
    """
    found = {}
    for parameter in logical.parameters:
        with suppress(Exception):  # a damaged parameter does not keep the frames from being read
            values = [text_of(value).strip() for value in np.ravel(parameter.values).tolist()]
            unit = text_of(parameter.attic["VALUES"].units) if values and is_number(values[0]) else ""
            found[text_of(parameter.name)] = " ".join([*filter(None, values), unit]).strip()
    return found


def _frame(source: InputFile, name: str, frame: Any, parameters: dict[str, str]) -> RawSet:
    """Return the set of one frame. The definitions of its channels are read now, its rows at their first use."""
    with damage_named(source, f"frame {name}"):
        dtype = frame.dtype(strict=False)
        labels = list(dtype.names[1:])  # the first is FRAMENO
        if not labels:
            raise source.error(f"frame {name}: holds no channel")
        least = len(frame.logicalfile.fdata_index.get(frame.fingerprint, [])) * dtype.itemsize
        check_unpacked(f"{source.path.name}: frame {name}", least, source.path.stat().st_size)
        count = _count(source, frame, dtype.itemsize)
        check_unpacked(f"{source.path.name}: frame {name}", count * dtype.itemsize, source.path.stat().st_size)
        stated = {"index_type": frame.index_type, "direction": frame.direction, "spacing": frame.spacing}
        for origin in frame.logicalfile.origins[:1]:
            stated |= {"well": origin.well_name, "field": origin.field_name, "company": origin.company}
        header = parameters | {key: text_of(value) for key, value in stated.items() if value not in (None, "")}

    @cache
    def rows() -> Array:
        with damage_named(source, f"frame {name}"), dlisio_warnings():
            table: Array = frame.curves(strict=False)
        if len(table) != count and not source.options.salvage:
            raise source.error(f"frame {name}: {len(table)} of {count} rows are there: truncated or damaged")
        return table

    def column(label: str, shape: tuple[int, ...]) -> Array:
        return rows()[label].reshape(shape)

    if source.options.salvage:
        count = len(rows())
    if len(labels) != len(frame.channels):
        raise source.error(f"frame {name}: {len(labels)} columns for {len(frame.channels)} channels")
    channels = []
    remarks = [] if frame.index_type else ["the frame states no index type: the rows have no index"]
    names = unique([text_of(channel.name) for channel in frame.channels])
    for label, own, channel in zip(labels, names, frame.channels, strict=True):
        dimension = tuple(int(size) for size in channel.dimension or [1])
        if len(dimension) > 1:
            remarks.append(f"{label}: {' x '.join(map(str, dimension))} elements a row, laid out as one axis")
        size = int(np.prod(dimension))
        shape = (count,) if size == 1 else (count, size)
        kind = dtype.fields[label][0].base.kind
        if kind == "c":
            remarks.append(Loss(f"{own}: not read, because its values are complex"))
            continue
        unit, described, load = text_of(channel.units), text_of(channel.long_name), partial(column, label, shape)
        channels.append(Channel(own, unit, described, load, source.nulls, _axis(channel), shape, kind in "OSU"))
    return RawSet(source.path, name, channels, count, names[0] if frame.index_type else None, header, remarks)


def _count(source: InputFile, frame: Any, row_size: int) -> int:
    """Return the number of rows of a frame. The file's index has it, unless a record holds several rows.

    The records are walked if rows hold texts, or if one row a record fills less than half of the file.
    """
    from dlisio.common import Actions, ErrorHandler
    from dlisio.core import extract

    places = frame.logicalfile.fdata_index.get(frame.fingerprint, [])
    layout = frame.fmtstr()
    texts, few = has_texts(layout), 2 * len(places) * row_size < min(source.path.stat().st_size, WALKED)
    if not texts and (source.options.salvage or not few):
        return len(places)
    damage = Actions.SWALLOW if source.options.salvage else Actions.RAISE
    records = extract(frame.logicalfile.file, places, ErrorHandler(critical=damage))
    return rows_of((bytes(record) for record in records), layout)


def _axis(channel: Any) -> SectorAxis | None:
    """Return the axis of a channel that has exactly one axis of numbers, else None.

    A first angle that is not stated is NaN; a step that is neither stated nor known from the coordinates is None.
    """
    axes = channel.axis
    if len(axes) != 1:
        return None
    coordinates, spacing = axes[0].coordinates, axes[0].spacing
    unit = text_of(axes[0].attic["COORDINATES"].units) if coordinates else ""
    try:
        if spacing is None and len(coordinates) > 1:
            return SectorAxis.of_angles([float(coordinate) for coordinate in coordinates], unit)
        first = float(coordinates[0]) if coordinates else float("nan")
        return SectorAxis(first, None if spacing is None else float(spacing), unit)
    except (TypeError, ValueError):
        return None

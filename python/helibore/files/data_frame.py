"""Read a data frame as if it were a file: pandas, Polars, Arrow, an xarray data set, or a dict of columns.

    frame, columns "MD_ft", "CAL1 (in)"  -->  RawSet of channels, unit as in the rules for files

The unit of a column is the one its metadata state (Arrow: "unit" or "uom"; xarray: "units"), else the one in its name,
else that of helibore's own arrays.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from helibore.base.arrays import cells
from helibore.base.errors import InputError
from helibore.base.frames import column_names, frame_column, refuse_no_frame
from helibore.files.columnar import own_unit
from helibore.files.headings import unit_in_name
from helibore.files.raw_set import Channel, RawFile, RawSet, unique

PLACE = Path("data frame")
"""Stands for the file in messages."""


def read_frame(table: Any, nulls: tuple[float, ...]) -> RawFile:
    """Return the columns of a data frame as the channels of one set.

    Parameters
    ----------
    table
        ``table[name]`` is a column of one or two dimensions: numbers, texts or dates.
    nulls
        Numbers that mean "no measurement".

    Raises
    ------
    InputError
        If it is no data frame, has no rows, or has columns of different lengths.
    """
    refuse_no_frame(table)
    names = column_names(table)
    channels: list[Channel] = []
    remarks: list[str] = []
    for position, (name, shown) in enumerate(zip(names, unique([str(name) for name in names]), strict=True)):
        try:
            values = cells(frame_column(table, name, position))
        except InputError as error:
            remarks.append(f"{shown}: {error}; left out")
            continue
        except Exception as error:  # each library has an error of its own for a column that NumPy cannot hold
            remarks.append(f"{shown}: cannot be read ({type(error).__name__}); left out")
            continue
        if values.dtype.kind in "cV":
            remarks.append(f"{shown}: holds {values.dtype}, must hold numbers, texts or dates; left out")
            continue
        if values.ndim not in (1, 2):
            remarks.append(f"{shown}: has {values.ndim} dimensions, must have one or two; left out")
            continue
        is_number = values.dtype.kind in "fiub"
        unit = _stated_unit(table, name, position) or unit_in_name(shown)
        channels.append(Channel(shown, unit or (own_unit(shown, remarks) if is_number else ""), "", values, nulls))
    lengths = {channel.name: channel.shape[0] for channel in channels}
    rows = next(iter(lengths.values()), 0)
    for name, length in lengths.items():
        if length != rows:
            place = f"column {name!r} has {length} values, column {channels[0].name!r} has {rows}"
            raise InputError(place, "must be equal")
    if not rows:
        raise InputError(PLACE.name, "has no rows" if channels else "has no columns with names")
    return RawFile("frame", [RawSet(PLACE, "frame", channels, rows, None, {}, remarks)])


def _stated_unit(table: Any, name: Any, position: int) -> str:
    """Return the unit that the metadata of a column state, as written; "" without."""
    schema: Any = getattr(table, "schema", None)
    if hasattr(schema, "field"):  # Arrow
        stated = schema.field(position).metadata or {}
        return (stated.get(b"unit") or stated.get(b"uom") or b"").decode("utf-8", "replace")
    attributes = getattr(table[name], "attrs", {}) if hasattr(table, "variables") else {}  # xarray
    return str(attributes.get("units", ""))

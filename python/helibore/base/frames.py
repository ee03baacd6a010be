"""Columns of a data frame by what they hold: pandas, Polars, Arrow, xarray, or a dict of columns.

frame_columns(frame, {"depth": ("MD", LENGTH), "time": ("T", TIME)}, {"depth": "ft"})   metres; left out: 3 rows
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from helibore.base.arrays import Floats, are_dates, numbers_or_dates
from helibore.base.errors import InputError
from helibore.base.nulls import NULLS
from helibore.base.units import TIME, factor


def frame_columns(
    table: Any, wanted: Mapping[str, tuple[str | None, str | None]], units: Mapping[str, str] | None
) -> tuple[dict[str, Floats], int]:
    """Return the complete rows of some columns, in metres, degrees and seconds, and how many rows were left out.

    Parameters
    ----------
    table
        ``table[name]`` is a column. A row with a missing value (NaN, null, one of `NULLS`) is left out.
    wanted
        For each role the name of its column, None for one that is not wanted, and what its unit measures, None for
        one without a unit. A time may be of dates.
    units
        By role; None: metres, degrees and seconds.

    Raises
    ------
    InputError
        On a column that is missing, comes twice or does not hold numbers; on an unknown unit; if no row is complete.
    """
    units = units or {}
    for unknown in units:
        known = [role for role, (_, kind) in wanted.items() if kind]
        if unknown not in known:
            raise InputError("units", f"{unknown!r} is none of {', '.join(known)}")
    columns: dict[str, Floats] = {}
    names = list(getattr(table, "column_names", getattr(table, "columns", ())))  # Arrow; pandas and Polars
    for role, (name, kind) in wanted.items():
        if name is None:
            continue
        place = f"column {name!r}"
        if names.count(name) > 1:
            raise InputError(place, f"the table has {names.count(name)} of this name ({role})")
        try:
            column = table[name]
        except Exception as error:  # each library has an error of its own for a column that is not there
            index = getattr(table, "index", None)
            way = ": it is the index, which reset_index() makes a column" if getattr(index, "name", "") == name else ""
            raise InputError(place, f"is not in the table ({role}){way}") from error
        try:
            values = numbers_or_dates(column, dates=kind == TIME)
        except InputError as error:
            raise error.within(place) from error
        except (TypeError, ValueError) as error:
            raise InputError(place, "must be numbers") from error
        if role in units and are_dates(column):
            raise InputError("units", f"column {name!r} is of dates, which have no unit ({role})")
        null = np.isin(values, NULLS)
        values = np.where(null, np.nan, values) if null.any() else values
        columns[role] = values * factor(units[role], kind) if role in units and kind else values
    there = np.logical_and.reduce([~np.isnan(of) for of in columns.values()])
    if not there.any():
        raise InputError("table", f"none of {there.size} rows has all of {', '.join(columns)}")
    whole = columns if there.all() else {role: of[there] for role, of in columns.items()}
    return whole, int(there.size - there.sum())

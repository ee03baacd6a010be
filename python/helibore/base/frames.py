"""Take the columns of depth, radius and so on from a data frame: pandas, Polars, Arrow, xarray, or a dict of columns.

rows = frame_rows(frame, {"depth": ("MD", LENGTH), "radius": ("CAL", LENGTH)}, {"radius": "in"})
with rows.named():                  radius[2] = -25.3746: ...   ->   CAL[3] = -999 in: ...
    Caliper(**rows.columns)
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from helibore.base.arrays import Floats, Mask, are_dates, numbers_or_dates
from helibore.base.errors import InputError
from helibore.base.nulls import NULLS
from helibore.base.units import TIME, factor, split

OPTIONAL = ("time", "arm")
"""Roles that a table need not have."""
WAYS = {"fetchall": "df()", "collect": "collect()", "read_all": "read_all()"}
"""Objects that are not data frames, but have a method that makes one: a DuckDB relation, a lazy frame, an Arrow reader.

A key is a method that only one of these three has; the value is that object's call."""


@dataclass(frozen=True)
class FrameRows:
    """The complete rows of some columns of a data frame."""

    columns: dict[str, Floats]  # by role, in metres, degrees and seconds
    complete: Mask  # which rows of the table are complete, one value for each row of the table
    # By role: the column's name, its values as in the table, and the text " UNIT" of the values ("" without a unit).
    stated: dict[str, tuple[str, Floats, str]]

    @contextmanager
    def named(self) -> Iterator[None]:
        """Change an InputError about an entry of a role, so that it names the column, row and value in the table."""
        try:
            yield
        except InputError as error:
            entry = rf"({'|'.join(self.stated)})\[(\d+)\]"
            found = re.fullmatch(entry, error.place)
            rule = re.sub(rf"{entry} = [^ ]+", lambda of: " = ".join(self._in_table(of)), error.rule)
            place, value = self._in_table(found) if found else (error.place, error.value)
            raise InputError(place, rule, value) from None

    def _in_table(self, entry: re.Match[str]) -> tuple[str, str]:
        name, values, unit = self.stated[entry[1]]
        row = int(np.flatnonzero(self.complete)[int(entry[2])])
        return f"{name}[{row}]", f"{values[row]:.15g}{unit}"


def frame_rows(
    table: Any, wanted: Mapping[str, tuple[str | None, str | None]], units: Mapping[str, str] | None
) -> FrameRows:
    """Return the rows of a data frame in which no wanted column has a missing value.

    Parameters
    ----------
    table
        ``table[name]`` is a column. A row with a missing value (NaN, null, masked, one of `NULLS`) is left out.
    wanted
        For each role: the name of its column (None: a time or an arm is not wanted), and the quantity that its unit
        measures (None: the role has no unit). A time may hold dates.
    units
        The unit of each role. A role without one has the unit at the end of its column's name, as in a file (``MD_ft``,
        ``CAL [in]``), or else metres, degrees or seconds.

    Raises
    ------
    InputError
        If a column is missing, comes twice, does not hold numbers, has more than one dimension or has another length
        than the first; if a unit is not known; if no row is complete.
    """
    units = units or {}
    for unknown in units:
        known = [role for role, (_, kind) in wanted.items() if kind]
        if unknown not in known:
            raise InputError("units", f"{unknown!r} is none of {', '.join(known)}")
    refuse_no_frame(table)
    columns: dict[str, Floats] = {}
    stated: dict[str, tuple[str, Floats, str]] = {}
    names = column_names(table)
    for role, (name, kind) in wanted.items():
        if name is None and role in OPTIONAL:
            continue
        if name is None:
            raise InputError(role, "must be the name of a column", "None")
        place = f"column {name!r}"
        if names.count(name) > 1:
            raise InputError(place, f"the table has {names.count(name)} columns of this name ({role})")
        try:
            column = table[name]
        except Exception as error:  # each library has an error of its own for a column that is not there
            raise InputError(place, f"is not in the table ({role}){_way_from_index(table, name)}") from error
        unit = units.get(role) or (split(str(name), kind)[1] if kind and not are_dates(column) else None)
        try:
            values = numbers_or_dates(column, dates=kind == TIME)
        except InputError as error:
            raise error.within(place) from error
        except (TypeError, ValueError) as error:
            raise InputError(place, "must be numbers") from error
        if values.ndim != 1:
            raise InputError(place, f"must be one-dimensional, not {values.ndim}-dimensional")
        first, of, _ = next(iter(stated.values()), (str(name), values, ""))
        if values.size != of.size:
            raise InputError(f"{place} has {values.size} values, column {first!r} has {of.size}", "must be equal")
        if role in units and are_dates(column):
            raise InputError("units", f"column {name!r} is of dates, which have no unit ({role})")
        null = np.isin(values, NULLS)
        values = np.where(null, np.nan, values) if null.any() else values
        stated[role] = (str(name), values, f" {unit}" if unit else "")
        columns[role] = values * factor(unit, kind) if unit and kind else values
    complete = np.logical_and.reduce([~np.isnan(of) for of in columns.values()])
    if not complete.any():
        raise InputError("table", f"none of {complete.size} rows has a value for each of {', '.join(columns)}")
    whole = columns if complete.all() else {role: of[complete] for role, of in columns.items()}
    return FrameRows(whole, complete, stated)


def column_names(table: Any) -> list[Any]:
    """Return the names of the columns; none if the table, such as a structured array, does not list them."""
    for way in ("column_names", "columns", "variables"):  # Arrow; pandas and Polars; xarray, with its coordinates
        if hasattr(table, way):
            return list(getattr(table, way))
    return list(table) if isinstance(table, Mapping) else []


def frame_column(table: Any, name: Any, position: int) -> Any:
    """Return a column by its place if the table has places (pandas, Arrow), else by its name: names may be repeated."""
    if hasattr(table, "iloc"):
        return table.iloc[:, position]
    return table.column(position) if hasattr(table, "column_names") else table[name]


def refuse_no_frame(table: Any) -> None:
    """Refuse what is not a data frame, with the way from there to one."""
    kind, rule = type(table).__name__, "must be a data frame or a dict of columns"
    if isinstance(table, list | tuple):
        raise InputError("table", f"{rule}; pandas.DataFrame(records) makes one from a list", kind)
    for method, way in WAYS.items():
        if hasattr(table, method):
            raise InputError("table", f"{rule}; its {way} is a data frame", kind)
    if isinstance(table, str) or not hasattr(table, "__getitem__"):
        raise InputError("table", rule, kind)


def _way_from_index(table: Any, name: str) -> str:
    """Return the advice to turn the index of a pandas table into a column, if ``name`` may mean the index; else ""."""
    index = getattr(table, "index", None)
    if index is None or type(index).__name__ in ("RangeIndex", "MultiIndex"):
        return ""
    if index.name == name:
        return "; it is the index, and reset_index() makes it a column"
    return "" if index.name is not None else f"; reset_index(names={name!r}) makes the index a column"

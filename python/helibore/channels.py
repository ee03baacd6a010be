"""Which column of a table plays which role, in which unit; and which of its values are there at all.

    NAME[@ANGLE][:UNIT]          x_in@90      CAL1@0:in      MD:ft      depth_m

Without a unit, the one the name ends with is proposed; without a name, a column of a usual name. What was proposed is
written in the channel's ``note`` for the user to see. Nothing is guessed from the values.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from helibore import units
from helibore.arrays import Floats
from helibore.table_file import Table

ROLES = {
    "depth": (units.LENGTH, ("depth", "md", "dept")),
    "toolface": (units.ANGLE, ("toolface", "tf", "rb")),
    "radius": (units.LENGTH, ("radius",)),
    "diameter": (units.LENGTH, ("diameter",)),
    "time": (units.TIME, ("time",)),
    "inclination": (units.ANGLE, ("inclination", "incl", "inc")),
    "azimuth": (units.ANGLE, ("azimuth", "azim", "azi")),
}
"""Kind of unit, and usual names, of every role."""

_CORE_UNIT = {units.LENGTH: "m", units.ANGLE: "deg", units.TIME: "s"}
_SPELLING = re.compile(r"(?P<name>.+?)(?:@(?P<angle>[-+]?\d+\.?\d*))?(?::(?P<unit>[^:]+))?")

Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Channel:
    """A column with a role; ``angle`` is where an arm is mounted (deg), ``note`` says what was chosen and why."""

    role: str
    name: str
    unit: str
    angle: float | None
    note: str

    def convert(self, values: Floats) -> Floats:
        """Turn values of the file into metres, degrees or seconds, in place."""
        factor = units.factor(self.unit, ROLES[self.role][0])
        if factor != 1.0:
            values *= factor
        return values


def choose(table: Table, role: str, spelling: str | None = None) -> Channel:
    """Return the column for ``role`` as spelled, or the one column of a usual name.

    Raises
    ------
    ValueError
        If there is none or more than one, or its unit is not known.
    """
    angle = unit = None
    if spelling is None:
        name = _only_usual(table, role)
    elif spelling in table.names:
        name = spelling
    else:
        match = _SPELLING.fullmatch(spelling)
        if match is None or match["name"] not in table.names:
            wanted = match["name"] if match else spelling
            raise ValueError(f"{table.path}: column '{wanted}': not in the file, which has {_listed(table.names)}")
        name, unit = match["name"], match["unit"]
        angle = float(match["angle"]) if match["angle"] else None
    unit, unit_assumed = _unit(table, role, name, unit)
    assumed = ["column"] * (spelling is None) + ["unit"] * unit_assumed
    at = "" if angle is None else f" at {angle:g} deg"
    remark = f" ({' and '.join(assumed)} assumed by name)" if assumed else ""
    return Channel(role, name, unit, angle, f"{role}: {name}{at}, unit {unit}{remark}")


def usual(table: Table, role: str) -> list[str]:
    """Return the columns with a usual name for ``role``, with or without a unit at the end."""
    kind, names = ROLES[role]
    return [name for name in table.names if units.split(name, kind)[0].lower() in names]


def absent_rows(
    table: Table, channel: Channel, values: Floats, absent: Sequence[float], nan_is_absent: bool = False
) -> Mask | None:
    """Return which rows hold no value, or None where all do.

    Raises
    ------
    ValueError
        At the first infinity, and at the first NaN unless that counts as absent.
    """
    if values.min() > max(absent, default=-np.inf) and values.max() < np.inf:
        return None
    gone = np.isin(values, absent)
    if nan_is_absent:
        gone |= np.isnan(values)
    wrong = ~(gone | np.isfinite(values))
    if wrong.any():
        row = int(np.argmax(wrong))
        raise ValueError(f"{table.path}: {table.place(channel.name, row)}: {values[row]:g}: must be finite")
    return gone


def _only_usual(table: Table, role: str) -> str:
    found = usual(table, role)
    if not found:
        names = ", ".join(ROLES[role][1])
        raise ValueError(
            f"{table.path}: no {role} column: none of a usual name ({names}); name it; "
            f"the file has {_listed(table.names)}"
        )
    if len(found) > 1:
        raise ValueError(f"{table.path}: more than one {role} column: {_listed(found)}; name the one to take")
    return found[0]


def _unit(table: Table, role: str, name: str, given: str | None) -> tuple[str, bool]:
    """Return the unit of a column, and whether it is assumed from the column's name."""
    kind = ROLES[role][0]
    if given is not None:
        try:
            units.factor(given, kind)
        except ValueError as error:
            raise ValueError(f"{table.path}: column {name}: {error}") from None
        return units.canonical(given), False
    _, unit = units.split(name, kind)
    if unit is not None:
        return unit, True
    if table.format == "NPZ" and name == role:
        return _CORE_UNIT[kind], True
    raise ValueError(f"{table.path}: column {name}: unit not given; write it as {name}:{_CORE_UNIT[kind]}")


def _listed(names: Sequence[str]) -> str:
    shown = ", ".join(names[:12])
    return shown if len(names) <= 12 else f"{shown} and {len(names) - 12} more"

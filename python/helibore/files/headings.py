"""Recognise units in column names (``depth_m``, ``Depth (ft)``, ``tdep_0.1in``), numbers, and rows of units.

    "pfc1_x_in" -> "in"      "Depth [ft]" -> "ft"      "MD" -> ""

Only the spelling is read here; what a unit means is in ``helibore.base.units``.
"""

from __future__ import annotations

import re

# Spellings of units, in lower case, that may end a name after "_" or stand in a row of units.
_SPELLED = """
    m mm cm km ft ftus in inch inches feet foot meter meters metre metres 0.1in 0.1_in 1/64in um
    usft usfeet deg degree degrees ° dega rad radian radians grad gon cps
    s sec second seconds ms us min minute h hr hour hours day days
    g/cc g/cm3 g/c3 kg/m3 gapi api ohm.m ohmm pu v/v % unitless b/e rpm c/min m/h m/hr ft/h ft/hr
    psi kpa mpa bar pa degc degf db klbf kn kkgf us/ft us/m mv v hz
"""
SPELLINGS = frozenset(_SPELLED.split())
AMBIGUOUS = frozenset({"min", "v", "h", "pa", "grad", "second", "minute", "hour", "day", "days", "seconds", "hz"})
"""Spellings that are a unit in a row of units, but may mean something else at the end of a name: ``radius_min``."""

BRACKETED = re.compile(r"[\[(]\s*([^\[\]()]+?)\s*[\])]\s*$")
NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")


def unit_in_name(name: str) -> str:
    """Return the unit at the end of a column name, as written there, or ``""`` if the name states no unit."""
    bracketed = BRACKETED.search(name)
    if bracketed and not bracketed[1].isdigit():
        return bracketed[1]
    parts = name.split("_")
    endings = ("_".join(parts[at:]) for at in range(1, len(parts)) if any(parts[:at]))  # longest ending first: 0.1_in
    for ending in endings:
        if ending.lower() in SPELLINGS - AMBIGUOUS:
            return ending
    camel = re.search(r"[a-z](Deg|Rad)$", name)
    return camel[1].lower() if camel else ""


def is_number(cell: str) -> bool:
    """Return whether a cell is a decimal number in ASCII digits (not ``nan``, ``inf``, ``1_000`` or ``0x1f``)."""
    return NUMBER.fullmatch(cell.strip()) is not None


def to_float(cell: str) -> float:
    """Return a cell as a number, as ``float`` does, but refuse ``1_000`` and digits of other scripts."""
    if "_" in cell or not cell.isascii():
        raise ValueError(cell)
    return float(cell)


def is_units_row(cells: list[str]) -> bool:
    """Return whether each cell of a row is a known unit, a dash or blank, and at least one is a unit.

    A unit may stand in brackets; if all cells do, one known unit is enough: (usft) (deg) (deg/100usft).
    """
    spellings = [cell.strip("()[] -").lower() for cell in cells]
    known = [spelling in SPELLINGS for spelling in spellings]
    bracketed = len(cells) > 1 and all(BRACKETED.fullmatch(cell.strip()) for cell in cells)
    return any(spellings) and (
        all(not spelling or found for spelling, found in zip(spellings, known, strict=True))
        or (bracketed and any(known))
    )

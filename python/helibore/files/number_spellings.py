"""Read numbers that are spelled in another way than 1234.5: decimal commas, thousands marks, angles.

    1.234,5   1 234,5   1234,5      decimal commas, with or without marks of thousands
    "4,921.26"   4'921.26           marks of thousands; of lakhs: 12,34,567.25
    (12.50)   −12.50   1.5D+03      negative numbers, an exponent of Fortran
    45°15'30"                       degrees, minutes, seconds
    N 45.3 E   S44E                 a bearing in a quadrant, as an azimuth

A table has one decimal mark. It is found from the cells that only one reading fits: 0,25 and 1500,000 cannot be
thousands, 1,234.5 cannot be decimals, and a column of plain numbers with a fraction has points. If every such cell fits
both readings (228,363), a table whose cells are cut by commas has thousands, and any other table has decimal commas. A
remark states what was read, and the option ``decimal`` of `helibore.open` states the mark.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from helibore.base.arrays import Array, data_and_mask

_END = r"(?:[eE][+-]?\d+|[dD][+-]\d+)?"
_COMMAS = re.compile(rf"[+-]?(?:[1-9]\d{{0,2}}(?:[.'’\u00a0\u202f ]\d{{3}})+|\d+)?(?:,\d*)?{_END}", re.ASCII)
_LAKH = r"[1-9]\d?(?:,\d{2})+,\d{3}"
_POINTS = re.compile(rf"[+-]?(?:[1-9]\d{{0,2}}(?:[,'’\u00a0\u202f ]\d{{3}})+|{_LAKH}|\d+)?(?:\.\d*)?{_END}", re.ASCII)
_BRACKETED = re.compile(r"\(\s*(\d[^()]*)\)")
_MARKS = str.maketrans("", "", "'’\u00a0\u202f ")

_ANGLE = r"\d+(?:\.\d+)?"
_SECONDS = rf"(?P<seconds>{_ANGLE})\s*(?:[\"″s]|'')\s*"
_DEGREES = rf"(?P<degrees>{_ANGLE})\s*(?:[°ºd]\s*(?:(?P<minutes>{_ANGLE})\s*['′’m]\s*(?:{_SECONDS})?)?)?"
SEXAGESIMAL = re.compile(rf"(?P<sign>[+-]?)\s*{_DEGREES}")
ZERO = re.compile(r"0+(?:[.,]0*)?")
"""A plain zero, as the station at the surface has among angles in degrees and minutes or by quarters."""

BEARING = re.compile(rf"(?P<from>[NS])\s*{_DEGREES}\s*(?P<to>[EW])", re.IGNORECASE)
TURN = {("N", "E"): (0.0, 1.0), ("S", "E"): (180.0, -1.0), ("S", "W"): (180.0, 1.0), ("N", "W"): (360.0, -1.0)}
"""For each quadrant: the azimuth of its first word, and the sign with which its angle counts."""


KINDS = {
    "(": "negative numbers in brackets", "\u2212": "true minus signs",
    "D": "exponents of Fortran", "d": "exponents of Fortran",
}  # fmt: skip
"""What is remarked of a number, by a character in it."""


@dataclass(frozen=True)
class Spelled:
    """A column that was text, as numbers; its unit if the spelling states one, and a cell as an example."""

    values: Array
    unit: str
    example: str
    kind: str


def read_spellings(
    columns: Sequence[Array], names: Sequence[str], cut_by_commas: bool, decimal: str | None = None
) -> tuple[list[Array], dict[int, str], list[str]]:
    """Return the columns with the text columns read that hold numbers, the units by position, and remarks.

    A column of text stays as it is if one of its cells fits no spelling, or its cells fit different decimal marks. It
    also stays if 123,420 stands among 123.450, unless ``decimal`` is stated: one format writes all cells of a column.
    """
    found = list(columns)
    texts = {at: column for at, column in enumerate(columns) if column.dtype.kind == "U"}
    if not texts:
        return found, {}, []
    fits = {at: _marks(column) if decimal or _is_even(column) else frozenset() for at, column in texts.items()}
    plain = frozenset("." for column in columns if column.dtype.kind == "f" and _has_fractions(column))
    mark = decimal or _mark_of([marks for marks in (*fits.values(), plain) if marks], cut_by_commas)
    units: dict[int, str] = {}
    remarks: list[str] = []
    numbers: list[int] = []
    ambiguous = decimal is None and not plain and all(len(marks) != 1 for marks in fits.values())
    for at, column in texts.items():
        if mark in fits[at]:
            found[at] = _numbers(column, mark)
            numbers.append(at)
        elif (angles := _angles(column)) is not None:
            found[at], units[at] = angles.values, angles.unit
            remarks.append(f"{names[at]}: {angles.kind} ({angles.example}) are read as degrees")
    if numbers and mark == ",":
        remarks += [
            _points_beside_commas(names[at], column) for at, column in enumerate(columns) if _may_be_thousands(column)
        ]
    if numbers:
        cells = [cell for at in numbers for cell in _cells(columns[at])]
        marked = (cell for cell in cells if set(cell) - set("+-.0123456789"))
        example = next(marked, next((cell for cell in cells if "." in cell), cells[0]))
        value = float(_plain(example, mark))
        what = next((kind for sign, kind in KINDS.items() if sign in example), "")
        what = what or ("decimal commas" if mark == "," else "marks of thousands")
        other = "." if mark == "," else ","
        doubt = f", a guess, since all cells fit both: decimal = {other!r} reads it otherwise" if ambiguous else ""
        listed = ", ".join(names[at] for at in numbers[:6]) + (" ..." if len(numbers) > 6 else "")
        remarks.insert(0, f"{what} in {listed}: {example.strip()} is read as {value:.10g}{doubt}")
    return found, units, remarks


def _may_be_thousands(column: Array) -> bool:
    """Return whether a column of numbers with points may be one of marks of thousands: 1.234 and 950 are whole so."""
    if column.dtype.kind != "f" or not _has_fractions(column):
        return False
    numbers, _ = data_and_mask(column)
    thousands = 1000.0 * numbers[np.isfinite(numbers) & (numbers != np.rint(numbers))]
    return bool((np.abs(thousands - np.rint(thousands)) < 1e-6).all() and (np.abs(thousands) >= 1000.0).all())


def _points_beside_commas(name: str, column: Array) -> str:
    numbers, _ = data_and_mask(column)
    example = float(next(number for number in numbers.tolist() if number == number and number != round(number)))
    return (
        f"{name}: {example:g} has a decimal point, although other columns have decimal commas; if it is a mark of "
        f"thousands, write {1000 * example:.0f}"
    )


def is_like_a_number(cell: str) -> bool:
    """Return whether a cell is a number in any spelling that is read here."""
    bare = _bare(cell)
    return any(character.isdigit() for character in bare) and any(
        pattern.fullmatch(bare) for pattern in (_POINTS, _COMMAS, SEXAGESIMAL, BEARING)
    )


def _has_fractions(column: Array) -> bool:
    numbers, _ = data_and_mask(column)
    return bool((np.isfinite(numbers) & (numbers != np.rint(numbers))).any())


def _cells(column: Array) -> list[str]:
    return [cell for cell in (each.strip() for each in column.tolist()) if cell]


def _marks(column: Array) -> frozenset[str]:
    """Return the decimal marks, of "." and ",", that fit every cell of a text column; none if it is empty."""
    given = _cells(column)
    cells = [_bare(cell) for cell in given]
    if not cells or not any(character.isdigit() for character in cells[0]):
        return frozenset()
    if all(_BRACKETED.fullmatch(cell) for cell in given):  # labels, such as (1)
        return frozenset()
    patterns = {".": _POINTS, ",": _COMMAS}
    return frozenset(mark for mark, pattern in patterns.items() if all(pattern.fullmatch(cell) for cell in cells))


def _is_even(column: Array) -> bool:
    """Return whether not some cells have only commas and others only points."""
    cells = _cells(column)
    return not (
        any("," in cell and "." not in cell for cell in cells)
        and any("." in cell and "," not in cell for cell in cells)
    )


def _mark_of(fits: list[frozenset[str]], cut_by_commas: bool) -> str:
    """Return the decimal mark of a table, "" if its columns contradict each other."""
    sure = {mark for marks in fits if len(marks) == 1 for mark in marks}
    if len(sure) > 1:
        return ""
    return sure.pop() if sure else "." if cut_by_commas else ","


def _bare(cell: str) -> str:
    """Return a cell with the sign of ASCII: a true minus and the brackets of accounting become "-"."""
    bare = cell.strip().replace("\u2212", "-")
    return _BRACKETED.sub(r"-\1", bare) if bare.startswith("(") else bare


def _plain(cell: str, mark: str) -> str:
    bare = _bare(cell).translate(_MARKS).replace("D", "e").replace("d", "e")
    return bare.replace(",", "") if mark == "." else bare.replace(".", "").replace(",", ".")


def _numbers(column: Array, mark: str) -> Array:
    return _masked(column, lambda cell: float(_plain(cell, mark)))


def _masked(column: Array, read: Callable[[str], float]) -> Array:
    cells = column.tolist()
    empty = np.array([not cell.strip() for cell in cells])
    values = np.array([0.0 if gone else read(cell) for cell, gone in zip(cells, empty, strict=True)])
    return np.ma.MaskedArray(values, empty) if empty.any() else values


def _angles(column: Array) -> Spelled | None:
    cells = _cells(column)
    for pattern, kind in ((BEARING, "bearings in quadrants"), (SEXAGESIMAL, "degrees, minutes and seconds")):
        spelled = [cell for cell in cells if pattern.fullmatch(cell)]
        if spelled and all(pattern.fullmatch(cell) or ZERO.fullmatch(cell) for cell in cells):
            return Spelled(_masked(column, _angle), "deg", spelled[0], kind)
    return None


def _angle(cell: str) -> float:
    """Return an angle in degrees from degrees, minutes and seconds, or from a bearing in a quadrant."""
    if ZERO.fullmatch(cell.strip()):
        return 0.0
    bearing = BEARING.fullmatch(cell.strip())
    found = bearing or SEXAGESIMAL.fullmatch(cell.strip())
    if found is None:
        raise ValueError(cell)
    parts = (float(found[name] or 0.0) for name in ("degrees", "minutes", "seconds"))
    angle = sum(part / 60.0**power for power, part in enumerate(parts))
    if bearing is None:
        return -angle if found["sign"] == "-" else angle
    start, sign = TURN[bearing["from"].upper(), bearing["to"].upper()]
    return (start + sign * angle) % 360.0

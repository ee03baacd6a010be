"""Convert the arrays of callers to the arrays that helibore uses; no other file calls ``asarray``.

Inputs may be lists, or arrays that are reversed, strided, Fortran-ordered, read-only, float32 or integer. Anything that
is not already a one-dimensional, C-contiguous float64 array is copied here, and nowhere else.
"""

from __future__ import annotations

import datetime
import sys
from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from helibore import _core
from helibore.base.errors import InputError

Floats = npt.NDArray[np.float64]
Floats32 = npt.NDArray[np.float32]
Reals = npt.NDArray[np.floating]
Integers = npt.NDArray[np.int64]
Integers32 = npt.NDArray[np.int32]
Integers8 = npt.NDArray[np.int8]
Unsigned64 = npt.NDArray[np.uint64]
Unsigned16 = npt.NDArray[np.uint16]
Bytes = npt.NDArray[np.uint8]
Complexes = npt.NDArray[np.complex128]
Mask = npt.NDArray[np.bool_]
Rows = npt.NDArray[np.void]
"""Structured rows, as the core's readers fill them."""
Array = npt.NDArray[Any]
Number = TypeVar("Number", bound=np.generic)
Typed = npt.NDArray[Number]
"""An array of one type, where a function returns the type that it takes."""


def numbers(values: npt.ArrayLike, dtype: npt.DTypeLike = np.float64) -> Array:
    """Return ``values`` as an array of ``dtype``, of the same shape; not copied if it already is such an array."""
    return np.asarray(values, dtype)


def data_and_mask(values: Any) -> tuple[Any, Mask | None]:
    """Return values without their mask, and the mask; None: they have none. ``numpy.ma`` is slow to load, so it stays
    unloaded where nobody has made a masked array."""
    kind = getattr(sys.modules.get("numpy.ma"), "MaskedArray", None)  # another thread may be loading it
    if kind is None or not isinstance(values, kind):
        return values, None
    return values.data, np.ma.getmaskarray(values)


def are_dates(values: npt.ArrayLike) -> bool:
    """Return whether ``values`` are dates: datetime64, or objects of which one or more are datetime objects."""
    array = np.asarray(_decoded(values))
    kind = array.dtype.kind
    return kind == "M" or (kind == "O" and any(isinstance(of, datetime.datetime) for of in array.flat))


def numbers_or_dates(values: npt.ArrayLike, *, dates: bool) -> Floats:
    """Return ``values`` as float64; if ``dates``, dates become seconds since 1970. Masked and missing values are NaN.

    If no date has a time zone, all dates are UTC. Raises InputError if only some of the dates have a time zone.
    """
    data, absent = data_and_mask(values)
    if absent is not None:
        return np.where(absent, np.nan, numbers_or_dates(data, dates=dates))
    array = np.asarray(_decoded(values))
    if dates and are_dates(array):
        array = array if array.dtype.kind == "M" else _in_utc(array)
        return numbers((array - np.datetime64(0, "s")) / np.timedelta64(1, "s"))
    if array.dtype.kind in "Mm":
        raise TypeError("dates are not numbers")
    return numbers(array)


def _in_utc(moments: Array) -> Array:
    """Return an array of datetime objects as datetime64 in UTC; None and NaT become NaT."""
    there = [of if of == of else None for of in moments.tolist()]  # NaT does not equal itself
    for row, of in enumerate(there):
        if of is not None and not isinstance(of, datetime.datetime):
            raise InputError(f"row {row}", "must be a date with a time of day, as others are", repr(of))
    if len({of.tzinfo is None for of in there if of is not None}) > 1:
        raise InputError("dates", "some have a time zone and some have none: all must have one, or none")
    utc = datetime.UTC
    zoned = [of if of is None or of.tzinfo is None else of.astimezone(utc).replace(tzinfo=None) for of in there]
    return np.array(zoned, "M8[us]")


def cells(values: npt.ArrayLike) -> Array:
    """Return the cells of a data frame's column: numbers with NaN for the missing ones, dates or texts.

    Cells that are lists of one length become the rows of an array of two dimensions. Raises InputError if their lengths
    differ, or if a row has no list.
    """
    if isinstance(values, np.ma.MaskedArray):
        return np.ma.filled(values.astype(np.float64), np.nan)
    array = np.asarray(_decoded(values))
    if array.dtype.kind != "O" or are_dates(array):
        return array
    plain = array.ravel().tolist()
    lists = [isinstance(of, list | tuple | np.ndarray) for of in plain]
    if any(lists):
        if not all(lists) or len({np.shape(of) for of in plain}) > 1:
            raise InputError("lists", "every row must have one, all of one length")
        return cells(np.array([cells(of) for of in plain]))
    plain = [None if _is_missing(of) else of for of in plain]
    try:
        return np.array([np.nan if of is None else of for of in plain], np.float64).reshape(array.shape)
    except (TypeError, ValueError, OverflowError):
        return np.array(plain, object).reshape(array.shape)


def _decoded(values: Any) -> Any:
    """Return an Arrow column of codes as its values: ``asarray`` gives the last value of the dictionary for a null."""
    kind: Any = getattr(values, "type", None)
    return values.cast(kind.value_type) if hasattr(kind, "index_type") else values


def _is_missing(cell: Any) -> bool:
    """Return whether a cell is None, NaN, NaT, or the NA of pandas, whose comparison is neither true nor false."""
    try:
        return cell is None or not cell == cell  # noqa: SIM201  # NaN is neither
    except (TypeError, ArithmeticError):  # the signalling NaN of Decimal
        return True


def column(name: str, values: npt.ArrayLike, length: int | None = None, like: str = "") -> Floats:
    """Return ``values`` as a one-dimensional, C-contiguous float64 array; ``name`` is the argument's name, for errors.

    If ``length`` is given, the column must have this length; ``like`` is the name, for errors, of a column with
    this length. Masked arrays are refused, because the mask would be lost without a message.
    """
    if isinstance(values, np.ma.MaskedArray):
        raise InputError(name, "masked arrays are not taken; drop the masked rows or use compressed()")
    try:
        array = np.asarray(values)
        if array.dtype.kind not in "fiu" and array.size:
            raise TypeError
        array = np.asarray(array, np.float64, "C")
    except (TypeError, ValueError) as error:
        raise InputError(name, "must be numbers") from error
    if array.ndim != 1:
        raise InputError(name, f"must be one-dimensional, not {array.ndim}-dimensional")
    if not array.flags.aligned:
        array = array.copy()
    if length is not None and array.size != length:
        raise InputError(f"{name} has {array.size} values, {like} has {length}", "must be equal")
    return array


def finite_column(name: str, values: npt.ArrayLike, length: int | None = None, like: str = "") -> Floats:
    """Return a column as `column` does, and refuse NaN and infinite values: ``toolface[17] = nan: must be finite``."""
    array = column(name, values, length, like)
    require(name, array, np.isfinite(array), "must be finite")
    return array


def whole_column(name: str, values: npt.ArrayLike, length: int | None = None, like: str = "") -> Integers:
    """Return a column of whole numbers as (n,) int64; refuse fractions, and numbers that float64 may have rounded."""
    array = finite_column(name, values, length, like)
    require(name, array, np.floor(array) == array, "must be a whole number")
    require(name, array, np.abs(array) < 2.0**53, "absolute value must be below 9007199254740992")
    return array.astype(np.int64)


def require(name: str, values: Floats | Integers, valid: Mask, rule: str) -> None:
    """Raise InputError if a value is not ``valid``; the error names the first such value."""
    if not valid.all():
        at = int(np.argmin(valid))
        raise InputError(f"{name}[{at}]", rule, f"{values[at]:g}")


def sample_columns(
    depth: npt.ArrayLike, toolface: npt.ArrayLike, radius: npt.ArrayLike, time: npt.ArrayLike | None
) -> tuple[Floats, Floats, Floats, Floats | None]:
    """Return the columns of samples for the core, each converted by `column`; the core compares their lengths."""
    columns: tuple[Any, Any, Any, Any] = depth, toolface, radius, time
    if not _core.are_columns(*columns):  # one quick test: a live host appends thousands of small batches
        when = None if time is None else column("time", time)
        columns = column("depth", depth), column("toolface", toolface), column("radius", radius), when
    if time is not None and columns[3].size == 0 < columns[0].size:  # the core would take this for no times
        raise InputError(f"time has 0 values, depth has {columns[0].size}", "must be equal")
    return columns


def distinct(values: Array) -> Array:
    """Return the different values, in order, none of them NaN.

    NumPy's own (since 2.3, by a hash table) aborts the program where a daemon thread is in it when the program ends.
    """
    ordered = np.sort(values, axis=None)
    is_first = np.ones(ordered.size, np.bool_)
    is_first[1:] = ordered[1:] != ordered[:-1]
    return ordered[is_first]


def runs_of(mask: Mask) -> list[tuple[int, int]]:
    """Return (first, stop) of every run of values that are true; ``stop`` is the index after the run."""
    edges = np.flatnonzero(np.diff(mask, prepend=False, append=False)).reshape(-1, 2)
    return [(first, last) for first, last in edges.tolist()]


def joined(runs: Sequence[tuple[int, int]], gap: int) -> list[tuple[int, int]]:
    """Return runs (first, stop) in order, those at most ``gap`` apart as one."""
    found: list[tuple[int, int]] = []
    for first, stop in runs:
        if found and first - found[-1][1] <= gap:
            found[-1] = found[-1][0], stop
        else:
            found.append((first, stop))
    return found

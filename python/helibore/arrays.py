"""Where callers' arrays become ours: the one file that calls ``asarray``.

Inputs may be lists, reversed, strided, Fortran-ordered, read-only, float32 or integer. Anything that is not already a
one-dimensional, C-contiguous float64 array is copied here, and nowhere else.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]
FLOAT64 = np.dtype(np.float64)


def numbers(values: npt.ArrayLike, dtype: npt.DTypeLike = np.float64) -> npt.NDArray[Any]:
    """Return ``values`` as an array of ``dtype`` and of its own shape, copied only where it is of another."""
    return np.asarray(values, dtype)


def column(name: str, values: npt.ArrayLike, length: int | None = None, like: str = "") -> Floats:
    """Return ``values`` as a one-dimensional, C-contiguous float64 array.

    Parameters
    ----------
    name
        The argument's name, for errors.
    values
        Anything NumPy can read as numbers. Masked arrays are refused: a mask would be lost in silence.
    length, like
        When given, the length the column must have and the name of the column that sets it.

    Raises
    ------
    ValueError
        If the values are not numbers, not one-dimensional, or of another length.
    """
    if type(values) is np.ndarray and values.dtype is FLOAT64 and values.ndim == 1 and values.flags.c_contiguous:
        array = values  # the common case at once: a live host appends thousands of small columns
    else:
        array = _converted(name, values)
    if length is not None and array.size != length:
        raise ValueError(f"{name} has {array.size} values, {like} has {length}: must be equal")
    return array


def _converted(name: str, values: npt.ArrayLike) -> Floats:
    if isinstance(values, np.ma.MaskedArray):
        raise ValueError(f"{name}: masked arrays are not taken; drop the masked rows or use compressed()")
    try:
        array = np.asarray(values)
        if array.dtype.kind not in "fiu" and array.size:
            raise TypeError
        array = np.ascontiguousarray(array, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name}: must be numbers") from error
    if np.ndim(values) != 1:
        raise ValueError(f"{name}: must be one-dimensional, not {np.ndim(values)}-dimensional")
    return array

"""Caliper: the forms arrays come in, what is refused and in which words, what is frozen."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from golden_texts import Golden
from reference import bits, exactly

import helibore as hb

DEPTH, TOOLFACE, RADIUS = [1.0, 2.0, 3.0, 4.0], [0.0, 90.0, 180.0, 270.0], [0.125, 0.25, 0.125, 0.25]


def read_only(values: list[float]) -> Any:
    array = np.array(values)
    array.flags.writeable = False
    return array


class HasArray:
    def __init__(self, values: list[float]) -> None:
        self.values = values

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        return np.array(self.values, dtype)


class Subclass(np.ndarray[Any, Any]):
    pass


FORMS = {
    "list": list,
    "tuple": tuple,
    "contiguous": np.array,
    "reversed": lambda v: np.array(v[::-1])[::-1],
    "strided": lambda v: np.repeat(v, 3)[::3],
    "column of a C matrix": lambda v: np.column_stack([v, v, v])[:, 1],
    "column of a Fortran matrix": lambda v: np.asfortranarray(np.column_stack([v, v]))[:, 1],
    "read-only": read_only,
    "float32": lambda v: np.array(v, np.float32),
    "float16": lambda v: np.array(v, np.float16),
    "long double": lambda v: np.array(v, np.longdouble),
    "big-endian": lambda v: np.array(v, ">f8"),
    "unaligned": lambda v: np.frombuffer(b"x" + np.array(v).tobytes(), np.uint8)[1:].view(np.float64),
    "has __array__": HasArray,
    "of a subclass": lambda v: np.array(v).view(Subclass),
    "of a float64 with metadata": lambda v: np.array(v, np.dtype(np.float64, metadata={"unit": "m"})),
}


@pytest.mark.parametrize("form", FORMS)
def test_array_forms(form: str) -> None:
    make = FORMS[form]
    caliper = hb.Caliper(make(DEPTH), make(TOOLFACE), make(RADIUS), make(DEPTH))
    for array, values in zip(
        (caliper.depth, caliper.toolface, caliper.radius, caliper.time), (DEPTH, TOOLFACE, RADIUS, DEPTH), strict=True
    ):
        assert array is not None
        assert array.tolist() == values
        assert array.dtype == np.float64
        assert array.flags.c_contiguous
    wall, plain = hb.Wall(bit_diameter=0.2), hb.Wall(bit_diameter=0.2)
    change = wall.append(make(DEPTH), make(TOOLFACE), make(RADIUS))
    assert change.accepted == len(DEPTH)
    plain.append(DEPTH, TOOLFACE, RADIUS)
    assert bits(wall) == bits(plain)


@pytest.mark.parametrize("dtype", ["i1", "u1", "i4", "u4", "i8", "u8"])
def test_integers(dtype: str) -> None:
    caliper = hb.Caliper(np.array([1, 2], dtype), np.array([0, 90], dtype), np.array([1, 2], dtype))
    assert caliper.depth.tolist() == [1.0, 2.0]
    assert caliper.radius.dtype == np.float64


ERRORS = [
    (([1.0, np.nan], [0, 0], [0.1, 0.1]), "depth[1] = nan: must be finite"),
    (([1.0, -np.inf], [0, 0], [0.1, 0.1]), "depth[1] = -inf: must be finite"),
    (([1.0, 2.0], [np.nan, np.nan], [0.1, 0.1]), "toolface[0] = nan: must be finite"),
    (([1.0, 2.0], [0, 0], [0.1, np.inf]), "radius[1] = inf: must be finite"),
    (([1.0, 2.0], [0, 0], [0.1, -0.0]), "radius[1] = -0: must be above 0 and at most 2 m"),
    (([1.0, 2.0], [0, 0], [-0.1, 0.1]), "radius[0] = -0.1: must be above 0 and at most 2 m"),
    (([1.0, 2.0], [0, 0], [0.1, 2.5]), "radius[1] = 2.5: must be above 0 and at most 2 m"),
    (([1.0, 2.0], [0, 0], [0.1, 0.1], [0.0, np.nan]), "time[1] = nan: must be finite"),
    (([1.0, 2.0], [0], [0.1, 0.1]), "toolface has 1 values, depth has 2: must be equal"),
    (([1.0, 2.0], [0, 0], []), "radius has 0 values, depth has 2: must be equal"),
    (([1.0], [0], [0.1], [1.0, 2.0]), "time has 2 values, depth has 1: must be equal"),
    ((1.0, [0], [0.1]), "depth: must be one-dimensional, not 0-dimensional"),
    (([[1.0]], [0], [0.1]), "depth: must be one-dimensional, not 2-dimensional"),
    (([1.0], np.zeros((1, 1)), [0.1]), "toolface: must be one-dimensional, not 2-dimensional"),
    ((["1.0"], [0], [0.1]), "depth: must be numbers"),
    (([1.0], [None], [0.1]), "toolface: must be numbers"),
    (([1.0], [0], [0.1 + 0j]), "radius: must be numbers"),
    (([1.0], [0], [True]), "radius: must be numbers"),
    (([1.0, [2.0]], [0, 0], [0.1, 0.1]), "depth: must be numbers"),
    (([10**400], [0], [0.1]), "depth: must be numbers"),
    (([1.0], [0], [0.1], np.array(["2020-01-01"], "M8[s]")), "time: must be numbers"),
    (
        (np.ma.masked_array([1.0, 2.0], [False, True]), [0, 0], [0.1, 0.1]),
        "depth: masked arrays are not taken; drop the masked rows or use compressed()",
    ),
    (
        ([1.0, 2.0], [0, 0], np.ma.masked_array([0.1, 0.1])),
        "radius: masked arrays are not taken; drop the masked rows or use compressed()",
    ),
]


@pytest.mark.parametrize(("columns", "text"), ERRORS, ids=[text for _, text in ERRORS])
def test_errors(columns: tuple[Any, ...], text: str) -> None:
    with pytest.raises(ValueError, match=exactly(text)):
        hb.Caliper(*columns)
    with pytest.raises(ValueError, match=exactly(text)):
        hb.Wall(bit_diameter=0.2).append(*columns)


def test_the_first_bad_row_of_many_is_named_whatever_the_threads(golden: Golden) -> None:
    radius = np.full(300_000, 0.1)
    radius[[70_001, 299_999]] = np.nan
    with golden.raises():
        hb.Caliper(np.arange(300_000), np.zeros(300_000), radius)


def test_frozen() -> None:
    caliper = hb.Caliper(DEPTH, TOOLFACE, RADIUS)
    with pytest.raises(ValueError, match="read-only"):
        caliper.depth[0] = 5.0
    with pytest.raises(AttributeError):
        caliper.depth = np.zeros(4)  # type: ignore[misc]
    with pytest.raises(AttributeError):
        caliper.gamma = 1  # type: ignore[attr-defined]


def test_the_callers_array_stays_writable() -> None:
    depth = np.array(DEPTH)
    hb.Caliper(depth, TOOLFACE, RADIUS)
    depth[0] = 0.5


def test_no_samples() -> None:
    caliper = hb.Caliper([], [], [])
    assert len(caliper) == 0
    assert repr(caliper) == "Caliper(no samples)"
    assert len(hb.reconstruct(caliper, bit_diameter=0.2)) == 0


def test_length_and_text() -> None:
    caliper = hb.Caliper(DEPTH, TOOLFACE, RADIUS)
    assert len(caliper) == 4
    assert caliper.time is None
    assert repr(caliper) == "Caliper(4 samples, 1 to 4 m)"

"""Columns of callers: what is taken, what is refused, and by which words."""

from __future__ import annotations

import sys
import types

import numpy as np
import pytest

from helibore.base.arrays import data_and_mask, distinct, whole_column


def test_whole_numbers_keep_their_value():
    most = 2**53 - 1
    made = whole_column("arm", [0, -most, most])
    assert (made.dtype, made.tolist()) == (np.int64, [0, -most, most])


@pytest.mark.parametrize(
    ("values", "place"),
    [
        ([0.0, 1.5], "arm[1]"),
        ([1e300, 0.0], "arm[0]"),
        (
            np.array([0, 2**64 - 1], dtype=np.uint64),
            "arm[1]",
        ),
        ([2**53 + 1], "arm[0]"),  # float64 holds 2^53
    ],
)
def test_a_number_that_is_not_whole_or_would_change_is_refused(values, place, golden):
    with golden.raises(place):
        whole_column("arm", values)


def test_masked_arrays_may_be_half_loaded_by_another_thread(monkeypatch):
    masked = np.ma.MaskedArray([1.0, 2.0], [False, True])
    values, absent = data_and_mask(masked)
    assert (values.tolist(), absent.tolist()) == ([1.0, 2.0], [False, True])
    monkeypatch.setitem(sys.modules, "numpy.ma", types.ModuleType("numpy.ma"))
    assert data_and_mask([1.0]) == ([1.0], None)


@pytest.mark.parametrize(
    "values",
    [
        [],
        [3],
        [2, 1, 2],
        [[1e300, -1e300], [-1e300, 0.0]],
        np.array([255, 0, 255], np.uint8),
        [True, False],
        [-(2**63)],
    ],
)
def test_distinct_values_come_once_and_in_order(values):
    assert distinct(values).tolist() == sorted({*np.ravel(values).tolist()})

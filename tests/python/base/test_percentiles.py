"""Percentiles from parts are those of all numbers, however many are equal or lie close together."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helibore.base import percentiles as module
from helibore.base.percentiles import percentiles

SHARES = (0, 12.5, 50, 99, 100)
VALUES = st.one_of(st.floats(0, 1e300), st.sampled_from([0.0, 5e-324, 0.1, math.nextafter(0.1, 1.0), 1.0]))


@given(st.lists(st.lists(VALUES, max_size=30), max_size=5), st.sampled_from([1, 3, 1 << 20]))
def test_they_are_those_of_numpy(parts: list[list[float]], few: int) -> None:
    arrays = [np.array(part) for part in parts]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "FEW", few)
        found = percentiles(lambda: arrays, SHARES)
    every = np.concatenate([*arrays, []])
    expected = np.percentile(every, SHARES) if every.size else [math.nan] * len(SHARES)
    np.testing.assert_allclose(found, expected, rtol=1e-15, atol=1e-320)

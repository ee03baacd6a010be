"""Static and dynamic normalisation: percentiles, a slow window, steady windows, gaps, and error texts."""

from __future__ import annotations

import math

import numpy as np
import pytest
from golden_texts import Golden
from hypothesis import given, settings
from hypothesis import strategies as st

from helibore.base.color_limits import percentile_limits
from helibore.images.normalization import sliding_window


def test_limits_are_percentiles_of_what_is_there() -> None:
    values = np.r_[np.arange(101.0), np.nan]
    assert percentile_limits(values) == (2.0, 98.0)
    assert percentile_limits(values, (0, 100)) == (0.0, 100.0)
    assert percentile_limits(values[1:] * 1.0, (10, 90), log=True) == pytest.approx((10.9, 90.1))


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 2**31), window=st.floats(0.05, 3), log=st.booleans())
def test_every_row_equals_a_slow_window(seed: int, window: float, log: bool) -> None:
    random = np.random.default_rng(seed)
    depth = 1000 + np.cumsum(random.uniform(0.05, 0.2, 40))
    values = random.uniform(50, 60, (40, 5))
    values[random.random(values.shape) < 0.2] = np.nan
    values[7] = np.nan
    found = sliding_window(depth, values, window, log)
    assert found.shape == values.shape
    for row in range(40):
        near = values[(depth >= depth[row] - window / 2) & (depth <= depth[row] + window / 2)].ravel()
        near = near[~np.isnan(near)]
        near = np.log(near) if log else near
        for sector in range(5):
            value = values[row, sector]
            if math.isnan(value):
                assert math.isnan(found[row, sector])
                continue
            value = math.log(value) if log else value
            spread = near.std()
            expected = 0.5 + (value - near.mean()) / (4 * spread) if spread > 1e-9 else 0.5
            assert found[row, sector] == pytest.approx(min(max(expected, 0), 1), abs=1e-6)


def test_layers_hidden_by_a_trend_come_out() -> None:
    depth = np.arange(0, 50, 0.1)
    trend = 100 * depth
    layers = np.sign(np.sin(2 * np.pi * depth / 0.4 + 0.1))
    found = sliding_window(depth, trend * 0.01 + layers, 1.0)
    inner = slice(20, -20)
    assert (found[inner][layers[inner] > 0] > 0.5).all()
    assert (found[inner][layers[inner] < 0] < 0.5).all()


def test_a_steady_window_is_in_the_middle_even_beside_large_values() -> None:
    depth = np.arange(0, 20, 0.1)
    values = np.where(depth < 10, 1e6, 0.123)
    found = sliding_window(depth, values, 1.0)
    assert (found[depth < 9] == 0.5).all()
    assert (found[depth > 11] == 0.5).all()


@pytest.mark.parametrize(
    "call",
    [
        lambda: percentile_limits(np.full(6, np.nan)),
        lambda: percentile_limits([60.0, 60.0, np.nan]),
        lambda: percentile_limits([[1.0, 2.0], [3.0, -0.5]], log=True),
        lambda: percentile_limits([1.0, 2.0], (98, 2)),
        lambda: sliding_window([0.0, 1.0], [1.0, 2.0, 3.0]),
        lambda: sliding_window([0.0, 0.0], [1.0, 2.0]),
        lambda: sliding_window([0.0, np.inf], [1.0, 2.0]),
        lambda: sliding_window([0.0, 1.0], [1.0, 2.0], 0),
        lambda: sliding_window([0.0, 1.0], [np.nan, np.nan]),
        lambda: sliding_window([], []),
        lambda: sliding_window([0.0, 1.0], [1.0, 0.0], log=True),
    ],
)
def test_bad_input_is_named(call, golden: Golden) -> None:
    with golden.raises():
        call()

"""The steps of the preparation in the core against slow ones in NumPy: the same to the last bit."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from helibore import _core
from helibore.base.angles import wrapped
from helibore.base.arrays import Floats, Integers
from helibore.preparation.sensors import Sensor, observe_by_depth


def slow_odd(values: Floats, threshold: float, floor: float) -> Integers:
    """Judge the readings of an arm by NumPy's medians and quantiles."""
    known = np.flatnonzero(np.isfinite(values))
    odd = np.zeros(values.size, dtype=np.int64)
    if known.size < 17:
        return odd
    reading = values[known]
    windows = np.lib.stride_tricks.sliding_window_view(np.pad(reading, 8, mode="reflect"), 17)
    off = reading - np.median(windows, axis=1)
    edges = np.linspace(0, off.size, max(1, off.size // 100) + 1).astype(np.int64)
    for first, last in pairwise(edges):
        far = np.abs(off[first:last])
        limit = threshold * max(np.quantile(far, 0.85) / 1.44, floor)
        odd[known[first:last]] = np.sign(off[first:last]) * (far > limit)
    return odd


@given(st.integers(0, 2**32), st.integers(0, 700), st.sampled_from([6.0, 1.0, 0.5]), st.sampled_from([1e-3, 1e-9]))
@settings(max_examples=40, deadline=None)
def test_odd_readings(seed: int, count: int, threshold: float, floor: float) -> None:
    random = np.random.default_rng(seed)
    values = np.round(0.1 + random.normal(0, 1e-3, count), int(random.integers(3, 17)))
    values[random.random(count) < 0.05] += 0.02 * random.choice([-1, 1])
    values[random.random(count) < random.choice([0.0, 0.1, 0.9])] = np.nan
    found = _core.odd_readings(values, threshold, floor)
    assert found.tolist() == slow_odd(values, threshold, floor).tolist()


ANGLE = st.sampled_from([0.0, -0.0, 359.999, 360.0, -1e-20, -90.0, 1e6, np.nan]) | st.floats(-1e6, 1e6)
LENGTH = st.sampled_from([0.0, -0.0, 1.0, np.nan]) | st.floats(-1e4, 1e4)


@given(st.data(), st.integers(0, 12), st.integers(1, 3), st.booleans())
@settings(max_examples=60, deadline=None)
def test_sensors_to_samples(data: st.DataObject, rows: int, width: int, timed: bool) -> None:
    depth, *radii = (data.draw(arrays(np.float64, rows, elements=LENGTH)) for _ in range(1 + width))
    toolface = data.draw(arrays(np.float64, rows, elements=ANGLE))
    time = data.draw(arrays(np.float64, rows, elements=LENGTH)) if timed else None
    place = st.sampled_from([0.0, 1.25, -3.0])
    sensors = [Sensor("s", data.draw(place), 90.0 * data.draw(place)) for _ in range(width)]
    found = observe_by_depth(sensors, depth, toolface, radii, time)

    turned = any(one.mounting for one in sensors)
    every = [
        (depth[row] - one.offset, toolface[row] + one.mounting if turned else toolface[row], radii[at][row],
         0.0 if time is None else time[row], at, row)
        for row in range(rows) for at, one in enumerate(sensors)
    ]  # fmt: skip
    kept = [sample for sample in every if not np.isnan(sample[:4]).any()]
    columns = [np.array([sample[at] for sample in kept], dtype=float) for at in range(6)]
    expected = [columns[0], wrapped(columns[1]), columns[2], *columns[3:]]
    of_time = np.zeros(len(kept)) if found.time is None else found.time
    got = [found.depth, found.toolface, found.radius, of_time, found.sensor.astype(float), found.row.astype(float)]
    assert [each.tobytes() for each in got] == [each.tobytes() for each in expected]
    lost = [int(np.argmax(np.isnan(sample[:4]))) for sample in every if np.isnan(sample[:4]).any()]
    names = ["no depth", "no toolface", "no radius", "no time"][: 4 if timed else 3]
    assert found.counts == {name: lost.count(at) for at, name in enumerate(names)} | {"taken": len(kept)}


@pytest.mark.parametrize("most", [10**6, 300])
def test_share_of_repeats_by_sets(most: int) -> None:
    random = np.random.default_rng(4)
    depth, toolface, radius = (np.tile(random.random(2000), 2) for _ in range(3))
    radius[3000:] += 1.0
    odd = 0x9E3779B97F4A7C15
    judged: list[tuple[int, ...]] = []
    for row in zip(*(values.view(np.uint64).tolist() for values in (depth, toolface, radius)), strict=True):
        place = ((row[0] ^ (row[1] << 1 & 2**64 - 1)) * odd & 2**64 - 1) >> 32
        if place <= int(0xFFFFFFFF * min(1.0, most / 4000)):
            judged.append(row)
    assert _core.share_of_repeats(depth, toolface, radius, most) == 1.0 - len(set(judged)) / len(judged)
    assert 0 < len(judged) < 4000 or most > 4000


def test_columns_of_other_lengths_are_refused() -> None:
    one, two = np.zeros(1), np.zeros(2)
    place = [(0.0, 0.0, 0)]
    for columns in ((two, one, [two], None, place), (two, two, [one], None, place),
                  (two, two, [two], one, place), (two, two, [], None, place)):  # fmt: skip
        with pytest.raises(ValueError, match="must be"):
            _core.observe_by_depth(*columns)
    with pytest.raises(ValueError, match="must be equal"):
        _core.share_of_repeats(one, two, two, 1)

"""Conditioning against slow loops, and its laws: pure, counted, the counts add up."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from helibore.preparation.conditioning import (
    Echo,
    Step,
    closed,
    in_range,
    repeated_rows,
    spikes,
    stuck,
)

NAN = float("nan")
radii = hnp.arrays(np.float64, st.integers(0, 60), elements=st.sampled_from([0.1, 0.1004, 0.101, 0.12, 0.2, NAN]))


def assert_counted(step: Step) -> None:
    assert sum(step.counts.values()) == np.count_nonzero(step.dropped)
    np.testing.assert_array_equal(step.kept, ~step.dropped)


@given(radii)
def test_range_counts_each_reason(values):
    before = values.copy()
    step = in_range(values, 0.1, 0.15)
    np.testing.assert_array_equal(values, before)
    slow = [not (0.1 <= v <= 0.15) for v in values]
    np.testing.assert_array_equal(step.dropped, slow)
    assert step.counts["missing"] == sum(v != v for v in values)
    assert_counted(step)


def test_range_reasons_and_limits():
    step = in_range([0.1, 0.2, 0.05, NAN, 0.3], 0.1, 0.2)
    assert step.counts == {"missing": 1, "below": 1, "above": 1}
    assert step.settings == {"low": 0.1, "high": 0.2}
    with pytest.raises(ValueError, match=r"^low = 2, high = 1: low must not be larger than high$"):
        in_range([1.0], 2.0, 1.0)


def slow_spikes(toolface, radius, turn, neighbors, threshold, floor):
    dropped = np.zeros(len(radius), dtype=bool)
    unjudged = 0
    for number in set(turn.tolist()):
        rows = [i for i in range(len(radius)) if turn[i] == number and radius[i] == radius[i]]
        rows.sort(key=lambda i: toolface[i] % 360)
        if len(rows) < 2 * neighbors + 1:
            unjudged += len(rows)
            continue
        for place, i in enumerate(rows):
            around = sorted(radius[rows[(place + o) % len(rows)]] for o in range(-neighbors, neighbors + 1))
            middle = around[neighbors]
            deviation = 1.4826 * sorted(abs(r - middle) for r in around)[neighbors]
            dropped[i] = abs(radius[i] - middle) > threshold * max(deviation, floor)
    return dropped, unjudged


@settings(deadline=None)
@given(st.integers(0, 10_000), st.integers(1, 4), st.integers(0, 80))
def test_spikes_against_loop(seed, neighbors, count):
    rng = np.random.default_rng(seed)
    toolface, turn = rng.random(count) * 720 - 360, rng.integers(0, 4, count)
    radius = 0.1 + 0.0005 * rng.integers(-3, 4, count) + 0.02 * (rng.random(count) < 0.1)
    radius[rng.random(count) < 0.1] = NAN
    step = spikes(toolface, radius, turn, neighbors=neighbors, threshold=4.0)
    dropped, unjudged = slow_spikes(toolface, radius, turn, neighbors, 4.0, 0.0005)
    np.testing.assert_array_equal(step.dropped, dropped)
    assert step.unjudged == unjudged
    assert_counted(step)


def test_spikes_find_spikes_and_leave_breakouts():
    a = np.arange(0.0, 360.0, 6.0)
    radius = 0.1 + 0.015 * (np.abs((a - 80 + 90) % 180 - 90) < 30)  # two boxes of 60 degrees
    assert not spikes(a, radius, np.zeros(60)).dropped.any()
    hit = [5, 13, 44]  # 13 lies in a lobe
    radius[hit] += [0.02, -0.03, 0.01]
    np.testing.assert_array_equal(np.flatnonzero(spikes(a, radius, np.zeros(60)).dropped), hit)


def test_spikes_floor_spares_quantised_radii():
    radius = np.full(40, 0.1)
    radius[::9] += 0.00038  # one step of the file; the median distance is 0
    a = np.arange(40) * 9.0
    assert not spikes(a, radius, np.zeros(40)).dropped.any()
    assert spikes(a, radius, np.zeros(40), floor=1e-5).counts["spike"] == 5


@settings(deadline=None)
@given(st.integers(0, 10_000), st.floats(-0.02, 0.02), st.floats(0, 360))
def test_spikes_laws(seed, lift, angle):
    """A larger hole and a turned tool change nothing."""
    rng = np.random.default_rng(seed)
    a, turn = np.sort(rng.random(60) * 350), np.repeat([1, 2, 3], 20)
    radius = 0.1 + 0.001 * rng.standard_normal(60) + 0.03 * (rng.random(60) < 0.05)
    step = spikes(a, radius, turn, floor=0.0007)
    lifted = spikes(a, radius + lift, turn, floor=0.0007)
    turned = spikes(a + angle, radius, turn, floor=0.0007)
    assert np.count_nonzero(step.dropped != lifted.dropped) == 0
    np.testing.assert_array_equal(step.dropped, turned.dropped)


def slow_stuck(arms, rows, moving):
    dropped = np.zeros((len(arms), len(arms[0])), dtype=bool)
    for arm, values in enumerate(arms):
        start = 0
        while start < len(values):
            stop = start + 1
            while stop < len(values) and repr(float(values[stop])) == repr(float(values[start])):
                stop += 1
            moves = [
                repr(float(other[i])) != repr(float(other[i - 1]))
                for j, other in enumerate(arms)
                if j != arm
                for i in range(start + 1, stop)
            ]
            if stop - start >= rows and sum(moves) >= moving * len(moves):
                dropped[arm, start:stop] = True
            start = stop
    return dropped


@settings(deadline=None)
@given(st.integers(0, 10_000), st.integers(2, 4), st.integers(2, 6), st.sampled_from([0.25, 0.5, 1.0]))
def test_stuck_against_loop(seed, arms, rows, moving):
    rng = np.random.default_rng(seed)
    values = rng.choice([0.1, 0.2, NAN], (arms, 50), p=[0.6, 0.2, 0.2])
    values[0, 10:30] = 0.3
    step = stuck(list(values), rows=rows, moving=moving)
    np.testing.assert_array_equal(step.dropped, slow_stuck(values, rows, moving))
    assert_counted(step)


def test_stuck_dead_and_a_smooth_pipe():
    moving = 0.1 + 0.001 * np.arange(200.0)
    still, dead = moving.copy(), moving.copy()
    still[40:140], dead[60:] = 0.123456, NAN
    step = stuck([moving, still, moving + 1, dead])
    assert step.counts == {"stuck": 100, "dead": 140}
    assert not step.dropped[[0, 2]].any()
    pipe = np.full(200, 0.1)
    assert not stuck([pipe, pipe, pipe]).dropped.any()


@given(st.lists(st.tuples(st.sampled_from([0.0, 1.0, NAN]), st.sampled_from([0.0, 1.0, NAN])), max_size=30))
def test_repeated_rows_against_set(rows):
    seen, slow = set(), []
    for row in rows:
        slow.append(repr(row) in seen)
        seen.add(repr(row))
    columns = [[row[i] for row in rows] for i in range(2)]
    step = repeated_rows(*columns)
    np.testing.assert_array_equal(step.dropped, np.array(slow, dtype=bool))
    kept = [np.array(c)[step.kept] for c in columns]
    assert not repeated_rows(*kept).dropped.any()  # once is enough
    assert_counted(step)


@given(radii, radii, st.integers(0, 5))
def test_closed_against_loop(x, y, margin):
    size = min(x.size, y.size)
    x, y = x[:size], y[:size]
    step = closed([x, y], 0.1, tolerance=0.0005, margin=margin)
    shut = [any(v == v for v in pair) and all(not v > 0.1005 for v in pair) for pair in zip(x, y, strict=True)]
    near = [any(shut[max(0, i - margin) : i + margin + 1]) for i in range(size)]
    np.testing.assert_array_equal(step.dropped, near)
    assert step.counts["closed"] == sum(shut)
    assert step.unjudged == sum(a != a and b != b for a, b in zip(x, y, strict=True))
    assert_counted(step)


def test_travel_time():
    time = np.array([1e-4, NAN, 2e-5, 1e-6])  # the last comes before the echo has left the tool
    radius = Echo(1500.0, 0.04, 1e-5).radius(time)
    np.testing.assert_allclose(radius, [0.04 + 1500 * 9e-5 / 2, NAN, 0.04 + 1500 * 1e-5 / 2, NAN])


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda: Echo(0, 0.04),
         "tool_radius = 0.04, velocity = 0, window = 0: velocity must be larger than 0, the others not negative, "
         "all finite"),
        (lambda: spikes([0], [1], [0], neighbors=0), "neighbors = 0: must be at least 1"),
        (lambda: spikes([0], [1], [0], floor=0), "threshold = 6, floor = 0: must be larger than 0"),
        (lambda: spikes([0], [1, 2], [0]), "radius has 2 values, toolface has 1: must be equal"),
        (lambda: stuck([[1.0]]), "arms has 1 columns: must have at least 2, to compare"),
        (lambda: stuck([[1.0], [1.0, 2.0]]), "arms[1] has 2 values, arms[0] has 1: must be equal"),
        (lambda: stuck([[1.0], [1.0]], rows=1), "rows = 1, moving = 0.5: rows must be at least 2, moving in (0, 1]"),
        (lambda: repeated_rows(), "columns: must have at least one"),
        (lambda: closed([], 0.1), "arms: must have at least one column"),
        (lambda: closed([[1.0]], -1.0),
         "radius = -1, tolerance = 0.002, margin = 0: radius must be larger than 0, the others not negative"),
    ],
)  # fmt: skip
def test_errors(call, text):
    with pytest.raises(ValueError) as caught:  # noqa: PT011 - the whole text is compared
        call()
    assert str(caught.value) == text

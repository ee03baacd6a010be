"""Conditioning against slow loops, and its laws: pure, counted, the counts add up."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from helibore import _core
from helibore.preparation.conditioning import (
    Step,
    closed,
    in_range,
    repeated_rows,
    share_of_repeats,
    spikes,
    stuck,
)
from helibore.settings.preparation_settings import Echo

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


def test_range_reasons_and_limits(golden):
    step = in_range([0.1, 0.2, 0.05, NAN, 0.3], 0.1, 0.2)
    assert step.counts == {"missing": 1, "below": 1, "above": 1}
    assert step.settings == {"low": 0.1, "high": 0.2}
    with golden.raises():
        in_range([1.0], 2.0, 1.0)


def apart(a, b):
    return abs((a - b + 180) % 360 - 180)


def slow_spikes(toolface, radius, turn, threshold, floor, depth=None):
    """The rules sample by sample."""
    angle = toolface % 360
    rows = [i for i in range(len(radius)) if radius[i] == radius[i]]
    rings = {number: sorted((i for i in rows if turn[i] == number), key=lambda i: angle[i]) for number in set(turn)}
    rings = {number: ring for number, ring in rings.items() if ring}

    def beside(i, number):
        ring = rings.get(number, [])
        after = sum(angle[j] < angle[i] for j in ring)
        return list(dict.fromkeys([ring[(after - 1) % len(ring)], ring[after % len(ring)]])) if ring else []

    around, middle = {}, {}
    for i in rows:
        pairs = [j for step in (-3, -2, -1, 1, 2, 3) for j in beside(i, turn[i] + step)]
        pairs = [j for j in pairs if apart(angle[i], angle[j]) <= min(max(20, 270 / len(rings[turn[i]])), 45)]
        pairs = sorted(pairs, key=lambda j: apart(angle[i], angle[j]))[:6]
        around[i] = sorted(radius[j] for j in pairs)
        middle[i] = np.median(around[i]) if pairs else np.inf
    tolerances = {}
    for first in range(0, len(rings), 100):
        numbers = sorted(rings)[first : first + 100]
        measured = numbers[:: max(1, len(numbers) // 25)]
        off = sorted(sorted(abs(radius[i] - middle[i]) for i in rings[n])[(len(rings[n]) - 1) // 2] for n in measured)
        deviation = 1.4826 * off[(len(off) - 1) // 2]
        tolerances |= dict.fromkeys(numbers, threshold * max(deviation if np.isfinite(deviation) else 0.0, floor))
    odd, beyond = set(), set()
    for i in rows:
        if len(around[i]) < 4:
            continue
        low, high, tolerance = around[i][1], around[i][-2], tolerances[turn[i]]
        slack = tolerance + 0.1 * (high - low)
        if not (radius[i] > high + slack or radius[i] < low - slack):
            continue
        beyond.add(i)
        near = [*beside(i, turn[i] - 1), *beside(i, turn[i] + 1)]
        if all(abs(radius[j] - radius[i]) > 0.5 * tolerance for j in near):
            odd.add(i)
    dropped = np.zeros(len(radius), dtype=bool)
    for number, ring in rings.items():
        tolerance = tolerances[number]
        for start, i in enumerate(ring):
            if i not in odd or (ring[start - 1] in odd and not all(j in odd for j in ring)):
                continue  # begin at the first of a burst
            burst = [i]
            while len(burst) < len(ring) and ring[(start + len(burst)) % len(ring)] in odd:
                burst.append(ring[(start + len(burst)) % len(ring)])
            if len(burst) == len(ring):
                dropped[burst] = len(ring) <= 5
            elif len(burst) <= max(1, min(5, len(ring) // 3)):
                ends = (burst[0], ring[start - 1]), (burst[-1], ring[(start + len(burst)) % len(ring)])
                dropped[burst] = all(b in beyond or abs(radius[a] - radius[b]) > 0.5 * tolerance for a, b in ends)
    if depth is not None:
        for i in np.flatnonzero(dropped):
            own = [depth[j] for j in rings[turn[i]]]
            others = [
                j for j in rows
                if angle[j] // 10 == angle[i] // 10 and abs(turn[j] - turn[i]) > 3 and abs(depth[j] - depth[i]) <= 2
            ]  # fmt: skip
            others = sorted(others, key=lambda j: abs(depth[j] - depth[i]))
            tolerance = tolerances[turn[i]]
            limit, most = (tolerance, 4) if 270 / len(rings[turn[i]]) > 20 else (0.5 * tolerance, 2)
            near = [j for j in others if depth[j] < depth[i]][:most] + [j for j in others if depth[j] > depth[i]][:most]
            if max(own) - min(own) > 1 or any(abs(radius[j] - radius[i]) <= limit for j in near):
                dropped[i] = False
    few = [i for i in rows if len(around[i]) < 4]
    alone = [
        i for i in few
        if all(abs(radius[j] - radius[i]) > 0.5 * threshold * floor for s in (-1, 1) for j in beside(i, turn[i] + s))
    ]  # fmt: skip
    return dropped, len(alone)


def test_the_only_sample_of_a_turn_is_one_neighbour():
    step = spikes(np.zeros(7), [0.1, 0.1, 0.1, 0.2, 0.1, 0.1, 0.1], np.arange(7))
    assert step.unjudged == 0  # the first and the last have three neighbours, and agree with them
    np.testing.assert_array_equal(np.flatnonzero(step.dropped), [3])
    assert spikes(np.zeros(3), [0.1, 0.2, 0.1], np.arange(3)).unjudged == 3


@settings(deadline=None)
@given(
    st.integers(0, 10_000),
    st.integers(0, 120),
    st.one_of(st.integers(2, 12), st.integers(50, 250)),
    st.sampled_from([None, 0.02, 0.5, 5.0]),
)
def test_spikes_against_loop(seed, count, turns, height):
    rng = np.random.default_rng(seed)
    count *= max(1, turns // 12)
    toolface, turn = rng.random(count) * 720 - 360, rng.integers(0, turns, count)
    radius = 0.1 + 0.0005 * rng.integers(-3, 4, count) + 0.02 * (rng.random(count) < 0.1)
    radius[rng.random(count) < 0.1] = NAN
    depth = None if height is None else height * (turn + rng.random(count))
    step = spikes(toolface, radius, turn, depth, threshold=4.0)
    dropped, unjudged = slow_spikes(toolface, radius, turn, 4.0, 0.0005, depth)
    np.testing.assert_array_equal(step.dropped, dropped)
    assert step.unjudged == unjudged
    assert_counted(step)


def lobe(toolface, at, width, depth, profile):
    """A box, a bell or a bowl of this depth; toolfaces and width in degrees."""
    off = np.minimum(np.abs((toolface - at + 180) % 360 - 180) / (width / 2), 1.0)
    shapes = {"box": np.ones_like(off), "bell": np.cos(0.5 * np.pi * off) ** 2, "bowl": 1 - off**2}
    return depth * np.where(off < 1, shapes[profile], 0.0)


def hole_with_spikes(seed):
    """A tool that turns unevenly, 16 to 32 samples a turn, past breakouts, key seats and ledges; 3 % are spikes."""
    rng = np.random.default_rng(seed)
    samples = (16, 32, 24)[seed % 3]
    count = 240 * samples
    travelled = np.cumsum(360 / samples * (1 + 0.3 * rng.uniform(-1, 1, count)))
    toolface, turn, depth = travelled % 360, np.floor(travelled / 360), 0.02 * np.arange(count) / samples
    shape = np.zeros(count)
    for number, (top, bottom) in enumerate(np.sort(rng.uniform(0, depth[-1], (9, 2)), axis=1)):
        inside = (depth > top) & (depth < bottom)
        at = rng.uniform(0, 360) + 10 * np.sin(depth)
        profile = ("box", "bell", "bowl")[(seed + number) % 3]
        if number % 3 == 0:  # a breakout: two opposite lobes
            width, deep = rng.uniform(40, 70), rng.uniform(0.008, 0.025)
            shape += inside * (
                lobe(toolface, at, width, deep, profile) + lobe(toolface, at + 180, width, deep, profile)
            )
        elif number % 3 == 1:  # a key seat: one narrow lobe
            shape += inside * lobe(toolface, at, rng.uniform(30, 60), rng.uniform(0.010, 0.02), profile)
        elif bottom - top < 1.0:  # a ledge, all around
            shape += inside * rng.uniform(0.005, 0.015)
    radius = 0.108 + 0.001 * np.cos(np.radians(2 * toolface)) + shape + rng.normal(0, 0.0005, count)
    spike = rng.random(count) < 0.03
    size = rng.uniform(0.010, 0.060, count) * rng.choice([-1, 1], count)
    return toolface, np.where(spike, np.maximum(radius + size, 0.03), radius), turn, depth, spike, shape > 0.003


def test_spikes_are_found_and_the_shape_of_ten_holes_stays():
    found, spiked, lost, shaped = 0, 0, 0, 0
    for seed in range(10):
        toolface, radius, turn, depth, spike, shape = hole_with_spikes(seed)
        dropped = spikes(toolface, radius, turn, depth).dropped
        found, spiked = found + np.count_nonzero(dropped & spike), spiked + np.count_nonzero(spike)
        lost, shaped = lost + np.count_nonzero(dropped & shape & ~spike), shaped + np.count_nonzero(shape & ~spike)
        assert np.mean(dropped[~spike]) < 0.005
    assert shaped > 10_000
    assert found >= 0.95 * spiked
    assert lost <= 0.01 * shaped


@pytest.mark.parametrize(("per_turn", "height"), [(1.3, 0.07), (3, 0.1), (5, 0.1), (12, 0.3), (16, 0.05)])
def test_a_key_seat_stays_that_few_samples_see(per_turn, height):
    """Narrow and 3 cm deep: most turns miss it, and other turns confirm what one of them saw."""
    rng = np.random.default_rng(int(per_turn))
    position = np.cumsum(rng.uniform(0.7, 1.3, int(20 / height * per_turn))) / per_turn
    toolface = position * 360 % 360
    radius = 0.109 + 0.03 * np.exp(-((apart(toolface, 80) / 20) ** 2)) + rng.normal(0, 0.0005, toolface.size)
    worn = radius > 0.112
    dropped = spikes(toolface, radius, np.floor(position), position * height).dropped
    assert np.count_nonzero(dropped & worn) <= 0.05 * np.count_nonzero(worn)
    assert not (dropped & ~worn).any()


def test_a_tool_that_slides_has_no_spikes():
    """It stands at one toolface past ledges: what lies side by side in its long turn is not of one place."""
    depth = np.arange(0, 8, 0.02)
    toolface = np.where(depth < 4, 200 + np.random.default_rng(1).normal(0, 3, 400), np.arange(400) * 25 % 360)
    turn = np.where(depth < 4, 0, 1 + np.arange(400) * 25 // 360)
    ledge = np.floor(depth / 0.3) % 2 * 0.012
    assert not spikes(toolface, 0.109 + ledge, turn, depth).dropped.any()


@given(st.lists(st.floats(-720, 720), min_size=1, max_size=60), st.floats(0, 0.02))
def test_turns_are_those_of_the_unwrapped_toolface(toolface, step):
    toolface = np.round(np.array(toolface), 3)
    row = np.repeat(np.arange(toolface.size), 2)
    turn = _core.turns_by_rotation(toolface, row, step * row)
    np.testing.assert_array_equal(turn, np.floor(np.unwrap(toolface % 360.0, period=360.0) / 360.0 + 1e-9)[row])
    assert _core.turns_by_rotation(toolface, row, 3.0 * np.abs(turn)) is None or np.unique(turn).size == 1


def test_what_another_pass_saw_too_is_no_spike():
    """A niche one sample wide and one turn high: a spike in one pass, shape where a second pass confirms it."""
    toolface = np.tile(np.arange(0.0, 360.0, 15.0), 80)
    turn = np.repeat(np.arange(80), 24)
    depth = np.concatenate([np.arange(960), np.arange(960)]) * 0.001
    radius = np.full(toolface.size, 0.1)
    radius[[500, 960 + 500]] = 0.13
    assert not spikes(toolface, radius, turn, depth).dropped.any()
    radius[960 + 500] = 0.1
    np.testing.assert_array_equal(np.flatnonzero(spikes(toolface, radius, turn, depth).dropped), [500])


def test_spikes_floor_spares_quantised_radii():
    radius = np.full(200, 0.1)
    radius[::9] += 0.00038  # one step of the file; the median distance is 0
    a, turn = np.tile(np.arange(40) * 9.0, 5), np.repeat(np.arange(5), 40)
    assert not spikes(a, radius, turn).dropped.any()
    assert spikes(a, radius, turn, floor=1e-5).counts["spike"] > 5


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


@pytest.mark.parametrize("most", [1 << 18, 800])
def test_share_of_repeats(most):
    rng = np.random.default_rng(2)
    columns = rng.integers(0, 14, (3, 3000)).astype(float) / 7
    share = 1 - len(set(zip(*columns.tolist(), strict=True))) / 3000
    assert abs(share_of_repeats(*columns, most=most) - share) < (1e-12 if most > 3000 else 0.08)
    assert share_of_repeats(*3 * [np.empty(0)]) == 0


@given(radii, radii)
def test_closed_against_loop(x, y):
    size = min(x.size, y.size)
    x, y = x[:size], y[:size]
    step = closed([x, y], 0.1, tolerance=0.0005)
    shut = [any(v == v for v in pair) and all(not v > 0.1005 for v in pair) for pair in zip(x, y, strict=True)]
    np.testing.assert_array_equal(step.dropped, np.array(shut, dtype=bool))
    assert step.counts["closed"] == sum(shut)
    assert step.unjudged == sum(a != a and b != b for a, b in zip(x, y, strict=True))
    assert_counted(step)


def test_travel_time():
    time = np.array([1e-4, NAN, 2e-5, 1e-6])  # the last comes before the echo has left the tool
    radius = Echo(1500.0, 0.04, 1e-5).radius(time)
    np.testing.assert_allclose(radius, [0.04 + 1500 * 9e-5 / 2, NAN, 0.04 + 1500 * 1e-5 / 2, NAN])


@pytest.mark.parametrize(
    ("call", "place"),
    [
        (lambda: Echo(0, 0.04), "velocity"),
        (lambda: spikes([0], [1], [0], floor=0), "floor"),
        (lambda: spikes([0], [1, 2], [0]), "radius has 2 values, toolface has 1"),
        (lambda: stuck([[1.0]]), "arms has 1 columns"),
        (lambda: stuck([[1.0], [1.0, 2.0]]), "arms[1] has 2 values, arms[0] has 1"),
        (lambda: stuck([[1.0], [1.0]], rows=1), "rows = 1, moving = 0.5"),
        (lambda: repeated_rows(), "columns"),
        (lambda: closed([], 0.1), "arms"),
        (lambda: closed([[1.0]], -1.0),
         "radius = -1, tolerance = 0.002"),
    ],
)  # fmt: skip
def test_errors(call, place, golden):
    with golden.raises(place):
        call()

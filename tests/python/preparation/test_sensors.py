"""Sensors in one frame: against a tool simulated with exact arithmetic, a slow interpolation, and laws."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from helibore.preparation.sensors import Sensor, TimeSeries, observe_by_depth, observe_by_time

NAN = float("nan")


def slow_at(time, values, when, gap, beyond, angle):
    pairs = {}
    for t, v in zip(time, values, strict=True):
        if v == v:
            pairs[t] = v  # the last of equals
    stamps = sorted(pairs)
    track = [pairs[stamps[0]]] if stamps else []
    for t in stamps[1:]:
        step = pairs[t] - track[-1]
        track.append(track[-1] + ((step + 180) % 360 - 180 if angle else step))
    if when in pairs:
        answer = track[stamps.index(when)]
    elif len(stamps) < 2:
        return NAN
    else:
        low = max([i for i in range(len(stamps)) if stamps[i] < when], default=-1)
        outside = max(stamps[0] - when, when - stamps[-1], 0)
        i = min(max(low, 0), len(stamps) - 2)
        if stamps[i + 1] - stamps[i] > gap or outside > beyond:
            return NAN
        answer = track[i] + (when - stamps[i]) / (stamps[i + 1] - stamps[i]) * (track[i + 1] - track[i])
    return answer % 360 if angle else answer


@settings(deadline=None)
@given(
    st.lists(st.tuples(st.integers(0, 30), st.one_of(st.just(NAN), st.floats(-400, 400))), max_size=12),
    st.floats(-5, 35),
    st.sampled_from([2.0, 10.0, float("inf")]),
    st.sampled_from([0.0, 3.0]),
    st.booleans(),
)
def test_time_series_against_loop(readings, when, gap, beyond, angle):
    readings.sort(key=lambda reading: reading[0])
    time, values = [float(t) for t, _ in readings], [v for _, v in readings]
    series = TimeSeries(time, values, angle=angle, gap=gap, beyond=beyond)
    for moment in [when, *time]:
        got, want = series.at([moment])[0], slow_at(time, values, moment, gap, beyond, angle)
        assert np.isnan(got) == np.isnan(want)
        if angle and not np.isnan(want):
            assert 0 <= got < 360
            got = (got - want + 180) % 360 - 180 + want
        np.testing.assert_allclose(got, want, atol=1e-7)


def test_toolface_passes_north_the_short_way():
    series = TimeSeries([0, 1, 2], [350, 10, 350], angle=True)
    np.testing.assert_allclose(series.at([0.25, 0.5, 0.75, 1.5]), [355, 0, 5, 0], atol=1e-12)


def test_nothing_is_read_beyond_the_limits():
    series = TimeSeries([0, 1, 11, 12], [0, 1, 11, 12], gap=5, beyond=0.5)
    np.testing.assert_array_equal(series.at([-0.6, -0.5, 0.5, 1, 5, 11, 12.5, 12.6, NAN]),
                                  [NAN, -0.5, 0.5, 1, NAN, 11, 12.5, NAN, NAN])  # fmt: skip
    assert np.isnan(TimeSeries([], []).at([1.0])).all()
    np.testing.assert_array_equal(TimeSeries([1], [7]).at([1, 2]), [7, NAN])


def test_several_sensors_end_in_one_frame():
    """A tool at 90 rpm that advances 0.1 m/s in a hole whose radius is known everywhere."""

    def wall(depth, toolface):
        return 0.1 + 0.01 * np.cos(np.radians(toolface)) + 0.001 * depth

    clock = np.arange(0.0, 20.0, 0.05)
    bit = TimeSeries(clock, 100 + 0.1 * clock)
    tool = TimeSeries(clock, (17 + 540 * clock) % 360, angle=True)
    sensors = [Sensor("ahead", -0.3, 0.0), Sensor("left", 1.5, 270.0, 0.4), Sensor("right", 4.0, 90.0, 1.1)]
    times, radii = [], []
    for number, sensor in enumerate(sensors):
        taken = np.arange(2.0, 18.0, 0.11 + 0.01 * number)
        times.append(taken + sensor.latency)
        radii.append(wall(100 + 0.1 * taken - sensor.offset, 17 + 540 * taken + sensor.mounting))
    observed = observe_by_time(sensors, times, radii, bit, tool)
    np.testing.assert_allclose(observed.radius, wall(observed.depth, observed.toolface), atol=1e-12)
    assert observed.counts["taken"] == sum(t.size for t in times) == observed.radius.size
    assert np.all(np.diff(observed.time) >= 0)
    assert set(observed.sensor.tolist()) == {0, 1, 2}
    for number in range(3):
        np.testing.assert_array_equal(observed.radius[observed.sensor == number], radii[number])


def test_one_instant_three_places():
    still = TimeSeries([0, 10], [50, 60]), TimeSeries([0, 10], [0, 100], angle=True)
    sensors = [Sensor("a"), Sensor("b", 2.0, 180.0), Sensor("c", 0.0, -20.0, 1.0)]
    observed = observe_by_time(sensors, [[5.0]] * 3, [[0.1]] * 3, *still)
    np.testing.assert_allclose(observed.time, [4, 5, 5])
    np.testing.assert_array_equal(observed.sensor, [2, 0, 1])
    np.testing.assert_allclose(observed.depth, [54, 55, 53])
    np.testing.assert_allclose(observed.toolface, [20, 50, 230])


@settings(deadline=None)
@given(st.integers(0, 10_000), st.floats(-360, 360))
def test_laws_counts_add_up_and_mounting_turns(seed, angle):
    rng = np.random.default_rng(seed)
    clock = np.sort(rng.random(30) * 10)
    depth, looking = rng.random(30), rng.random(30) * 360
    looking[rng.random(30) < 0.2] = NAN
    bit = TimeSeries(clock, depth, gap=0.7)
    tool = TimeSeries(clock, looking, angle=True, gap=1.0)
    times = [rng.random(20) * 12 - 1 for _ in range(2)]
    radii = [np.where(rng.random(20) < 0.2, NAN, 0.1) for _ in range(2)]
    kept = [r.copy() for r in radii]
    plain = observe_by_time([Sensor("a", 1, 0), Sensor("b", 2, 30)], times, radii, bit, tool)
    turned = observe_by_time([Sensor("a", 1, angle), Sensor("b", 2, 30 + angle)], times, radii, bit, tool)
    assert sum(plain.counts.values()) == 40
    assert plain.counts == turned.counts
    np.testing.assert_array_equal(plain.depth, turned.depth)
    apart = (turned.toolface - plain.toolface - angle + 180) % 360 - 180
    np.testing.assert_allclose(apart, 0, atol=1e-9)
    for mine, copy in zip(radii, kept, strict=True):
        np.testing.assert_array_equal(mine, copy)


def test_xy_caliper_by_depth():
    arms = [Sensor(str(m), 0.5, m) for m in (0, 180, 90, 270)]
    x, y = np.array([0.2, 0.21, NAN]), np.array([0.3, 0.31, 0.32])
    observed = observe_by_depth(arms, [10, 11, 12], [350, NAN, 0], [x / 2, x / 2, y / 2, y / 2])
    assert observed.time is None
    assert observed.counts == {"no depth": 0, "no toolface": 4, "no radius": 2, "taken": 6}
    np.testing.assert_array_equal(observed.row, [0, 0, 0, 0, 2, 2])
    np.testing.assert_array_equal(observed.sensor, [0, 1, 2, 3, 2, 3])
    np.testing.assert_allclose(observed.depth, [9.5] * 4 + [11.5] * 2)
    np.testing.assert_allclose(observed.toolface, [350, 170, 80, 260, 90, 270])
    np.testing.assert_allclose(observed.radius, [0.1, 0.1, 0.15, 0.15, 0.16, 0.16])


@pytest.mark.parametrize(
    ("call", "place"),
    [
        (lambda: TimeSeries([0, 2, 1], [1, 2, 3]), "time[2]"),
        (lambda: TimeSeries([0, NAN], [1, 2]), "time[1]"),
        (lambda: TimeSeries([0, 1], [1, np.inf]), "values[1]"),
        (lambda: TimeSeries([0, 1], [1]), "values has 1 values, time has 2"),
        (lambda: TimeSeries([0], [1], gap=0), "gap = 0, beyond = 0"),
        (lambda: Sensor("gamma", NAN), "sensor gamma: offset"),
        (lambda: observe_by_depth([], [1], [1], []), "sensors"),
        (lambda: observe_by_depth([Sensor("a")], [1], [1], []), "radii has 0 columns, sensors has 1"),
        (lambda: observe_by_depth([Sensor("a")], [1], [1], [[1, 2]]),
         "radii[0] has 2 values, depth has 1"),
        (lambda: observe_by_depth([Sensor("a")], [1], [1], [[np.inf]]),
         "radii[0][0]"),
        (lambda: observe_by_depth([Sensor("a")], [np.inf], [1], [[1]]), "depth is infinite in 1 rows"),
    ],
)  # fmt: skip
def test_errors(call, place, golden):
    with golden.raises(place):
        call()

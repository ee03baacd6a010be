"""Spikes in rows of few arms, bursts in dense turns, and closed arms, at any spacing of the rows."""

from __future__ import annotations

import numpy as np
import pytest
from test_conditioning import hole_with_spikes

import helibore as hb
from helibore import _core
from helibore.preparation.conditioning import SuspectRows, spikes
from helibore.preparation.prepare import Preparation
from helibore.preparation.readings import Readings
from helibore.preparation.sensors import Sensor

ARMS = 4


def arm_spikes(radii, depth, turned=None):
    """Return which readings of a tool the core takes for spikes, (arms, n), and how many of each kind."""
    radii = np.stack(radii)
    toolface = np.zeros(radii.shape[1]) if turned is None else turned
    sensors = [(0.0, 360.0 / len(radii) * arm, arm) for arm in range(len(radii))]
    dropped, counts = np.zeros(radii.shape, dtype=bool), {"burst": 0, "jump": 0}
    for found in map(SuspectRows._make, _core.judge_rows(
        np.array(depth), toolface, list(radii), sensors, None, False, False, False, 6.0
    )):  # fmt: skip
        if found.cause in counts:
            dropped[slice(None) if found.column < 0 else found.column, found.first : found.stop] = True
            counts[found.cause] += found.rows
    return dropped & np.isfinite(radii), counts


def closed_stretches(depth, radii):
    """Return the stretches in which the core finds all arms closed."""
    sensors = [(0.0, 90.0 * arm, arm) for arm in range(len(radii))]
    found = _core.judge_rows(depth, depth * 7 % 360, list(radii), sensors, None, True, False, False, 6.0)
    return [each for each in map(SuspectRows._make, found) if each.cause == "closed"]


def lobe(toolface, at, width, deep):
    off = np.abs((toolface - at + 180) % 360 - 180) / (width / 2)
    return deep * np.maximum(1 - off**2, 0)


def tool(seed, step, arms=ARMS, length=150.0):
    """A slowly turning tool past breakouts, key seats and ledges: depth, toolfaces, radii and where the shape is."""
    rng = np.random.default_rng(seed)
    depth = 1500 + np.arange(0, length, step)
    turned = np.cumsum(rng.normal(13 * step, 6 * step, depth.size))
    toolface = (turned + 360 / arms * np.arange(arms)[:, None]) % 360
    shape = np.zeros(toolface.shape)
    for number in range(int(length / 12)):
        top, reach, at = rng.uniform(1500, 1500 + length), rng.uniform(1.5, 6), rng.uniform(0, 360)
        inside = (depth > top) & (depth < top + reach)
        if number % 3 == 0:
            shape += inside * (lobe(toolface, at, 80, 0.02) + lobe(toolface, at + 180, 80, 0.02))
        elif number % 3 == 1:
            shape += inside * lobe(toolface, at, 60, 0.012)
        else:
            shape += inside * 0.01
    radius = 0.108 + 0.001 * np.cos(np.radians(2 * toolface)) + shape + rng.normal(0, 0.0005, shape.shape)
    return depth, toolface, radius, shape > 0.003


@pytest.mark.parametrize(("step", "found", "lost"), [(0.15, 0.8, 0.015), (0.02, 0.85, 0.003)])
def test_spikes_of_arms_are_found_and_the_shape_stays(step, found, lost):
    seen, away, shaped = np.zeros((3, 2)), 0, 0
    for seed in range(4):
        depth, toolface, radius, shape = tool(seed, step)
        rng = np.random.default_rng(900 + seed)
        size = rng.uniform(0.012, 0.06, radius.shape) * rng.choice([-1, 1], radius.shape)
        kinds = np.zeros((3, *radius.shape), dtype=bool)
        kinds[0] = rng.random(radius.shape) < 0.005
        spiked = np.where(kinds[0], radius + size, radius)
        for first in rng.integers(10, depth.size - 10, depth.size // 150):
            arm, count = rng.integers(ARMS), rng.integers(2, 6)
            kinds[1, arm, first : first + count] = True
            spiked[arm, first : first + count] = radius[arm, first : first + count] + abs(size[arm, first])
        for row in rng.choice(depth.size, depth.size // 150, replace=False):
            kinds[2, :, row] = True
            spiked[:, row] = radius[:, row] + abs(size[0, row])
        dropped, _ = arm_spikes(np.maximum(spiked, 0.03), depth, toolface[0])
        kinds[0] &= ~kinds[1] & ~kinds[2]
        seen += [[np.count_nonzero(dropped & kind), np.count_nonzero(kind)] for kind in kinds]
        clean = ~kinds.any(axis=0)
        away, shaped = away + np.count_nonzero(dropped & shape & clean), shaped + np.count_nonzero(shape & clean)
    single, burst, row = seen[:, 0] / seen[:, 1]
    assert single >= found
    assert burst >= found - 0.15
    assert row >= 0.92
    assert away <= lost * shaped


def test_bursts_in_dense_turns_are_found():
    found = spiked = lost = shaped = 0
    for seed in range(30, 34):
        toolface, radius, turn, depth, spike, shape = hole_with_spikes(seed)
        rng = np.random.default_rng(seed)
        burst = np.zeros(radius.size, dtype=bool)
        for first in rng.integers(0, radius.size - 6, 40):
            part = slice(first, first + rng.integers(2, 6))
            burst[part] = True
            radius[part] += rng.uniform(0.01, 0.06)
        dropped = spikes(toolface, radius, turn, depth).dropped
        found, spiked = found + np.count_nonzero(dropped & burst), spiked + np.count_nonzero(burst)
        kept = shape & ~burst & ~spike
        lost, shaped = lost + np.count_nonzero(dropped & kept), shaped + np.count_nonzero(kept)
    assert found >= 0.8 * spiked
    assert lost <= 0.01 * shaped


@pytest.mark.parametrize("step", [0.005, 0.05, 0.1524, 0.5])
def test_a_row_in_which_all_arms_jump_is_dropped_at_any_spacing(step):
    depth = 1000 + step * np.arange(400)
    rng = np.random.default_rng(1)
    arms = 0.1105 + rng.normal(0, 0.0004, (2, 400))
    arms[:, [60, 200, 333]] = 0.5 * 15.25 * 0.0254
    arms[:, 250:280] += 0.02  # a washout
    dropped, _ = arm_spikes(arms, depth)
    np.testing.assert_array_equal(np.flatnonzero(dropped.any(axis=0)), [60, 200, 333])
    assert dropped[:, [60, 200, 333]].all()


def test_a_breakout_that_another_arm_passes_is_no_spike():
    depth = 1000 + 0.15 * np.arange(200)
    toolface = (np.arange(200) * 20.0 + np.array([0.0, 90.0, 180.0, 270.0])[:, None]) % 360
    inside = (depth > 1010) & (depth < 1014)
    radius = 0.11 + np.random.default_rng(2).normal(0, 0.0003, toolface.shape)
    seen = inside & (np.abs(toolface - 45) < 25)  # each arm passes the key seat in three rows
    radius[seen] += 0.02
    assert not arm_spikes(radius, depth, toolface[0])[0].any()
    assert (arm_spikes(radius, depth)[0] & seen).any()


def test_arm_spikes_of_few_rows_and_missing_values():
    assert not arm_spikes([[0.1, 0.2, 0.1]] * 2, [1.0, 2.0, 3.0])[0].any()
    values = np.full((2, 100), 0.1)
    values[0, ::7] = np.nan
    values[0, 50] = 0.2
    dropped, counts = arm_spikes(values, np.arange(100.0))
    np.testing.assert_array_equal(np.argwhere(dropped), [[0, 50]])
    assert counts == {"burst": 1, "jump": 0}


def readings(depth, radii, mountings=(0.0, 90.0, 180.0, 270.0)):
    names = tuple(f"A{number}" for number in range(len(radii)))
    sensors = tuple(Sensor(name, mounting=angle) for name, angle in zip(names, mountings, strict=False))
    arms = np.arange(len(radii))
    return Readings("f.las", depth, depth * 7 % 360, sensors, tuple(radii), arms, names, (False,) * len(radii))


def test_spikes_are_reported_and_dropped_when_asked():
    depth = 1000 + 0.15 * np.arange(300)
    radii = 0.11 + np.random.default_rng(4).normal(0, 0.0004, (4, 300))
    radii[2, 100:103] += 0.03
    radii[:, 200] += 0.05
    prepared = hb.prepare(readings(depth, radii))
    (line,) = (text for label, text in prepared.report if label == "spikes")
    assert line.startswith("f.las: 7 readings look like spikes (3 of one arm, 4 in rows of all arms)")
    assert len(prepared.caliper) == 1200
    made = hb.prepare(readings(depth, radii), Preparation(spikes=6.0))
    assert made.counts["spikes of arms"] == 7
    assert made.caliper.radius.max() < 0.115


@pytest.mark.parametrize("step", [0.01, 0.1524, 0.6])
def test_closed_arms_are_judged_by_metres(step):
    depth = 1000 + step * np.arange(round(60 / step))
    rng = np.random.default_rng(5)
    radii = 0.11 + rng.normal(0, 0.0004, (4, depth.size))
    radii[:, (depth > 1050) & (depth < 1054)] = 0.05
    found = closed_stretches(depth, radii)
    assert len(found) == 1
    radii[:, (depth > 1050) & (depth < 1054)] = 0.11
    radii[:, (depth > 1020) & (depth < 1021)] = 0.05  # a tight spot, however many rows it has
    found = closed_stretches(depth, radii)
    assert not found
    still = np.concatenate([depth, np.full(30, depth[-1])])
    found = closed_stretches(still, np.hstack([radii, np.full((4, 30), 0.05)]))
    assert len(found) == 1

"""The rows that the core judges, against slow steps in NumPy: the same stretches, to the last bit."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from helibore import _core
from helibore.base.arrays import runs_of
from helibore.preparation.conditioning import SuspectRows, stuck


def stretches(mask, rows):
    return [(first, last) for first, last in runs_of(mask) if last - first >= rows]


def disagreements(values, pairs):
    for other, one in pairs:
        off = np.abs(values[one] - values[other])
        known = off[np.isfinite(off)]
        half = float(np.median(known)) if known.size else np.nan
        for first, last in stretches(off > 0.0025, 1 if half > 0.0025 else 10):
            yield "disagreement", other, first, last, False, half, one


def closed(values, depth, bit, drop):
    known = np.isfinite(values).any(axis=0)
    if not known.any():
        return
    largest = np.where(known, np.nan_to_num(values, nan=-np.inf).max(axis=0), np.nan)
    level = float(np.nanmin(largest))
    if np.nanmedian(largest) < level + 0.01 or (bit is not None and level + 0.01 > 0.5 * bit):
        return
    dropped = bit is not None and drop
    for first, last in stretches(known & (largest <= level + 0.002), 3):
        there = depth[first:last][np.isfinite(depth[first:last])]
        length = float(np.ptp(there)) if there.size else 0.0
        enough = 0.5 if first == np.flatnonzero(known)[0] or last == np.flatnonzero(known)[-1] + 1 else 2.0
        if length < enough and not (last - first >= 20 and length <= 0.01):
            continue
        begin, end = first, last
        while end < largest.size and largest[end] > largest[end - 1]:
            end += 1
        while begin > 0 and largest[begin - 1] > largest[begin]:
            begin -= 1
        if begin < first:
            yield "ramp", -1, begin, first, dropped, level, -1
        yield "closed", -1, first, last, dropped, level, -1
        if last < end:
            yield "ramp", -1, last, end, dropped, level, -1


def saturated(values, depth, drop):
    for arm, radius in enumerate(values):
        known = np.isfinite(radius)
        limit = float(radius[known].max()) if known.any() else np.nan
        top = known & (radius >= limit - 1e-9)
        below = known & ~top & (radius > limit - 0.002)
        many, near, tops = (np.count_nonzero(each) for each in (known, below, top))
        stays = any(abs(depth[last - 1] - depth[first]) >= 0.5 for first, last in stretches(top, 5))
        if 2 * tops <= many and tops >= 5 * near and stays:
            for first, last in stretches(top, 1):
                yield "saturated", arm, first, last, drop, limit, -1


def spikes(values, where, toolface, mountings, ways, threshold, drop):
    known = np.isfinite(values)
    odd = np.stack([_core.odd_readings(each, threshold, 0.001) for each in values])
    moved = np.nan_to_num(np.abs(np.diff(where, prepend=where[:1])))
    along = np.cumsum(moved)
    beside = np.pad(odd, ((0, 0), (1, 1)))
    lone = (odd != 0) & (beside[:, :-2] != odd) & (beside[:, 2:] != odd)
    trusted = np.where(lone, np.nan, values)
    angles = toolface + np.array(mountings)[:, None]
    ways = np.array(ways)
    rows = np.zeros(values.shape[1], dtype=bool)
    most = np.maximum(2, 0.75 * known.sum(axis=0))
    for sign in (-1, 1):
        for first, last in runs_of((odd == sign).sum(axis=0) >= most):
            rows[first:last] |= last - first == 1 or along[last - 1] - along[first] <= 0.05
    rows |= lone_rows(values, threshold)
    burst = np.zeros(values.shape, dtype=bool)
    for arm in range(len(values)):
        others = np.delete(odd, arm, axis=0)
        for sign in (-1, 1):
            with_it = (others == sign).any(axis=0)
            for first, last in runs_of((odd[arm] == sign) & ~rows):
                short = last - first <= 5 and along[last - 1] - along[first] <= 1.0
                if not short or with_it[max(first - 1, 0) : last + 1].any():
                    continue
                if not seen_elsewhere(trusted, values, angles, ways, along, arm, (first, last)):
                    burst[arm, first:last] = True
    for arm in range(len(values)):
        for sign in (-1, 1):
            for first, last in runs_of(burst[arm] & (odd[arm] == sign)):
                yield "burst", arm, first, last, drop, np.nan, -1
    for first, last in runs_of(rows):
        yield "jump", -1, first, last, drop, np.nan, -1

    def elsewhere(arm, run):
        return seen_elsewhere(trusted, values, angles, ways, along, arm, run)

    for arm, first, last in runs_of_one_arm(np.where(burst | rows, np.nan, values), along, threshold, elsewhere):
        yield "burst", arm, first, last, drop, np.nan, -1


def middle(values, axis):
    """The median of the values that are there; NaN if none is."""
    there = np.isfinite(values).any(axis=axis)
    return np.where(there, np.nanmedian(np.where(np.expand_dims(there, axis), values, 0.0), axis=axis), np.nan)


def limits(values, threshold):
    blocks = max(1, values.size // 100)
    limit = np.empty(values.size)
    for block in range(blocks):
        part = slice(block * values.size // blocks, (block + 1) * values.size // blocks)
        deviation = 1.4826 * float(middle(np.abs(values[part]), 0)) if values[part].size else 0.0
        limit[part] = threshold * max(0.001, np.nan_to_num(deviation))
    return limit


def lone_rows(values, threshold):
    """Rows whose arms leave together the rows beside them, which agree."""
    found = np.zeros(values.shape[1], dtype=bool)
    if found.size < 3:
        return found
    before, here, after = values[:, :-2], values[:, 1:-1], values[:, 2:]
    off = here - 0.5 * (before + after)
    left = np.full(found.size, np.nan)
    left[1:-1] = middle(off, 0)
    along = (off * left[1:-1] > 0.5 * left[1:-1] ** 2).sum(axis=0)
    most = (along >= 2) & (along >= 0.75 * np.isfinite(off).sum(axis=0))
    agree = middle(np.abs(before - after), 0) < 0.5 * np.abs(left[1:-1])
    found[1:-1] = most & agree & (np.abs(left) > limits(left, threshold))[1:-1]
    return found


def runs_of_one_arm(left, along, threshold, elsewhere):
    """Runs that leave their surroundings by more than the other arms do."""
    arms, count = left.shape
    left = left.copy()
    for _ in range(2):
        filled = np.array([
            np.interp(np.arange(count), np.flatnonzero(np.isfinite(arm)), arm[np.isfinite(arm)])
            if np.isfinite(arm).any() else arm for arm in left
        ]).reshape(arms, count)  # fmt: skip
        for length in range(5, 0, -1):
            if count <= length + 6:
                continue
            first = np.arange(3, count - length - 2)
            before = np.median([filled[:, first - each] for each in (1, 2, 3)], axis=0)
            after = np.median([filled[:, first + length + each] for each in (0, 1, 2)], axis=0)
            off = np.stack([filled[:, first + k] - before - (after - before) * (k + 2) / (length + 3)
                            for k in range(length)])  # fmt: skip
            alone = np.stack([off[:, arm] - middle(np.delete(off, arm, axis=1), 1) for arm in range(arms)], axis=1)
            height = np.full((arms, count), np.nan)
            height[:, first] = middle(alone, 0)
            for arm in range(arms):
                limit = limits(height[arm], threshold)
                for at in np.flatnonzero(np.abs(height[arm]) > limit):
                    run, sign, high = slice(at, at + length), np.sign(height[arm, at]), abs(height[arm, at])
                    edges = (
                        sign * (filled[arm, at] - filled[arm, at - 1]),
                        sign * (filled[arm, at + length - 1] - filled[arm, at + length]),
                    )
                    others = np.delete(height[:, at], arm)
                    if (
                        np.isfinite(left[arm, run]).all()
                        and along[at + length - 1] - along[at] <= 1.0
                        and (sign * alone[:, arm, at - 3] > limit[at]).all()
                        and min(edges) > 0.5 * high
                        and not (sign * others > 0.5 * high).any()
                        and not elsewhere(arm, (at, at + length))
                    ):
                        left[arm, run] = np.nan
                        yield arm, at, at + length


def seen_elsewhere(trusted, values, angles, ways, along, arm, burst):
    """Return whether a reading outside a burst of an arm, near in depth and toolface, is as far off as the burst.

    It is if it differs from the middle of the burst by less than a quarter of the burst's height over the readings
    before and after.
    """
    first, last = burst
    begin = int(np.searchsorted(along, along[first] - 2.0))
    end = int(np.searchsorted(along, along[last - 1] + 2.0, side="right"))
    middle, angle = float(np.median(values[arm, first:last])), float(angles[arm, (first + last) // 2])
    base = np.concatenate([values[arm, max(first - 3, 0) : first], values[arm, last : last + 3]])
    height = abs(middle - float(np.nanmedian(base))) if np.isfinite(base).any() else 0.0
    half = 0.5 * np.minimum(ways, ways[arm])[:, None]
    off = np.abs((angles[:, begin:end] - angle + half) % (2.0 * half) - half)
    near = (off <= 15.0) & (np.abs(trusted[:, begin:end] - middle) < 0.25 * height)
    near[arm, first - begin : last - begin] = False
    return bool(near.any())


def judged(depth, toolface, values, sensors, bit, drops, threshold):
    """All steps in their order; what a step drops is missing for the next."""
    values, found = values.copy(), []
    shown = [next(each for each in sensors if each[2] == column) for column in range(len(values))]
    ends = [sum(each[2] == column for each in sensors) for column in range(len(values))]
    pairs = dict.fromkeys(
        (b[2], a[2]) for at, a in enumerate(sensors) for b in sensors[:at] if a[:2] == b[:2] and a[2] != b[2]
    )
    turned = np.abs((np.diff(toolface) + 180.0) % 360.0 - 180.0)
    turned = turned[np.isfinite(turned)]
    fast = turned.size and np.median(turned) > 30.0

    def still():
        step = stuck(list(values), rows=100)
        for arm in range(len(values)):
            changes = np.flatnonzero(np.diff(np.nan_to_num(values[arm], nan=-1.0))) + 1
            for part in np.split(np.arange(depth.size), changes):
                if part.size and step.dropped[arm, part].all():
                    yield "stuck", arm, part[0], part[-1] + 1, False, values[arm, part[0]], -1

    steps = [
        lambda: disagreements(values, pairs),
        lambda: closed(values, depth, bit, drops[0]),
        lambda: saturated(values, depth, drops[1]),
    ]
    if len(values) > 1:
        steps.append(still)
        if not fast:
            mountings = [mounting for _, mounting, _ in shown]
            ways = [180.0 if count > 1 else 360.0 for count in ends]
            steps.append(lambda: spikes(values, depth, toolface, mountings, ways, threshold, drops[2]))
    for step in steps:
        of_step = list(step())
        for _, arm, first, last, dropped, *_ in of_step:
            if dropped:
                values[slice(None) if arm < 0 else arm, first:last] = np.nan
        found += of_step
    return found


def tool(seed):
    """A tool of one to four arms or diameters, with some of the faults: its log and its sensors."""
    random = np.random.default_rng(seed)
    count, columns = int(random.integers(0, 500)), int(random.integers(1, 5))
    step = random.choice([0.005, 0.05, 0.15, 0.6])
    depth = 1000.0 + step * np.arange(count)
    toolface = np.cumsum(random.normal(0, random.choice([2.0, 60.0]), count)) % 360.0
    values = 0.11 + random.normal(0, 0.0004, (columns, count))

    def part(size):
        first = int(random.integers(0, max(count - size, 1)))
        return slice(first, first + size)

    def few(share):
        return random.random((columns, count)) < share

    faults = random.random(9) < 0.4
    if faults[0]:
        values[:, part(40)] = 0.05
        ramp = values[:, part(8)]
        ramp[:] = 0.05 + 0.008 * np.arange(ramp.shape[1])
    if faults[1]:
        values[0, part(60)] = values[0, part(20)] = 0.19
    if faults[2]:
        values[-1, part(150)] = random.choice([0.1234, np.nan])
    if faults[3]:
        values[few(0.01)] += 0.03 * random.choice([-1, 1])
        values[0, part(4)] += 0.02
    if faults[4]:
        values[:, random.random(count) < 0.01] += 0.04
    if faults[5]:
        values[few(0.1)] = np.nan
    if faults[6]:
        depth[random.random(count) < 0.05] = np.nan
    if faults[7]:
        values = np.round(values, 3)
    if faults[8]:
        toolface[random.random(count) < 0.1] = np.nan
    across = random.random(columns) < 0.5
    same = random.random() < 0.3
    sensors = [
        (0.0, (0.0 if same else 90.0 * column) + 180.0 * end, column)
        for column in range(columns) for end in range(1 + across[column])
    ]  # fmt: skip
    return depth, toolface, values, sensors


def as_bits(found):
    return [(*each[:5], np.float64(each[5]).tobytes() if each[5] == each[5] else "nan", each[6]) for each in found]


@given(st.integers(0, 2**32), st.sampled_from([None, 0.1, 0.216]), st.tuples(*3 * [st.booleans()]),
       st.sampled_from([6.0, 3.0]))  # fmt: skip
@settings(max_examples=150, deadline=None)
def test_stretches_equal_those_of_slow_steps(seed, bit, drops, threshold):
    depth, toolface, values, sensors = tool(seed)
    found = _core.judge_rows(depth, toolface, list(values), sensors, bit, *drops, threshold)
    slow = judged(depth, toolface, values, sensors, bit, drops, threshold)
    assert as_bits(found) == as_bits(slow)


def test_every_cause_is_among_the_tools():
    causes = set()
    for seed in range(60):
        depth, toolface, values, sensors = tool(seed)
        found = _core.judge_rows(depth, toolface, list(values), sensors, 0.216, True, True, False, 6.0)
        causes |= {SuspectRows(*each).cause for each in found}
    assert causes == {"disagreement", "closed", "ramp", "saturated", "stuck", "burst", "jump"}


def test_rows_of_an_image_are_not_judged():
    depth, values = 1000.0 + np.arange(300.0), np.full((8, 300), 0.05)
    values[:, ::2] = 0.2
    sensors = [(0.0, 45.0 * sector, sector) for sector in range(8)]
    assert _core.is_image(sensors)
    assert _core.judge_rows(depth, depth, list(values), sensors, 0.216, True, True, True, 6.0) == []
    assert not _core.is_image([(offset, mounting % 180.0, column) for offset, mounting, column in sensors])
    assert not _core.is_image([(float(column > 3), mounting, column) for _, mounting, column in sensors])


def test_what_cannot_be_judged_is_refused():
    one, two = np.zeros(1), np.zeros(2)
    sensors = [(0.0, 0.0, 0)]
    for depth, toolface, radii, places in (
        (two, one, [two], sensors), (two, two, [one], sensors), (two, two, [], sensors),
        (two, two, [two], [(0.0, 0.0, 1)]), (two, two, [two], [(0.0, 0.0, -1)]),
    ):  # fmt: skip
        with pytest.raises(ValueError, match="must be"):
            _core.judge_rows(depth, toolface, radii, places, None, True, True, False, 6.0)
    with pytest.raises(ValueError, match="above 0"):
        _core.judge_rows(two, two, [two], sensors, None, True, True, False, 0.0)

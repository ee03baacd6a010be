"""A stretch of the helix has the bits of the whole wall: its vertices, its changes, its logs."""

from __future__ import annotations

import math
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden
from hypothesis import given, settings
from hypothesis import strategies as st

import helibore as hb
from helibore.base.arrays import Floats
from helibore.logs.turn_logs import COLUMN_NAMES, Logs, turn_logs

K = 8


def samples(seed: int, count: int, length: float, gap: float) -> tuple[Floats, Floats, Floats]:
    """Samples of a hole in any order, many at one depth, none in a gap in its middle."""
    random = np.random.default_rng(seed)
    depth = 100.0 + np.sort(random.uniform(0.0, length, count))
    depth[::3] = np.round(depth[::3], 1)
    depth[depth > 100.0 + length / 2] += gap
    order = random.permutation(count)
    toolface = np.round(random.uniform(0.0, 360.0, count), 0) % 360.0
    return depth[order], toolface, random.uniform(0.09, 0.13, count)


def bits(columns: Any) -> list[bytes]:
    return [np.ascontiguousarray(column).tobytes() for column in columns]


wholes = st.fixed_dictionaries({
    "sectors": st.sampled_from([8, 10]),
    "pitch": st.sampled_from([0.1, 0.037, -0.1]),
    "neighbors": st.sampled_from([1, 4, 8]),
    "window": st.sampled_from([None, None, 20]),
    "max_distance": st.sampled_from([0.3, 1.0, None]),
    "angular_scale": st.sampled_from([0.5, 1.0, 4.0]),
    "estimator": st.sampled_from(["inverse-distance", "kriging"]),
})  # fmt: skip


@given(wholes, st.integers(0, 2**32), st.sampled_from([0.0, 0.9, 3.0]), st.data())
@settings(max_examples=40)
def test_a_stretch_has_the_bits_of_the_whole(of: dict[str, Any], seed: int, gap: float, data: st.DataObject) -> None:
    columns = samples(seed, 300, 6.0, gap)
    start, sectors = 100.03 if of["pitch"] > 0 else 106.0 + gap, of["sectors"]
    of |= {"bit_diameter": 0.2, "start_depth": start, "kriging_range": 0.2, "threads": 1}
    whole = hb.Wall(**of)
    whole.append(*columns)
    first = sectors * data.draw(st.integers(0, len(whole) // sectors - 1))
    stop = data.draw(st.integers(first + 1, len(whole)))
    want = whole.vertices(first, stop)

    alike = hb.Wall(**of, first_vertex=first, stop_vertex=stop)
    change = alike.append(*columns)
    assert change.ranges.tolist() == [[first, stop]]
    assert first <= change.settled <= stop
    assert bits(alike.vertices()) == bits(want)

    shallow, deep = alike.reach(first, stop)
    inside = (columns[0] >= shallow) & (columns[0] <= deep)
    if inside.any():
        alone = hb.Wall(**of, first_vertex=first, stop_vertex=stop)
        alone.append(*(column[inside] for column in columns))
        assert bits(alone.vertices()) == bits(want)
        assert alone.start_depth == want.depth[0]
        assert alone.reach(first, stop) == (shallow, deep)


@pytest.mark.parametrize("max_distance", [None, 1.0])
def test_the_reach_of_too_few_samples_is_infinite_without_a_limit(max_distance: float | None) -> None:
    wall = hb.Wall(bit_diameter=0.2, sectors=K, max_distance=max_distance)
    wall.append([100.0, 101.0], [0.0, 5.0], [0.1, 0.1])
    assert [math.isinf(depth) for depth in wall.reach(0, K)] == [max_distance is None] * 2


def test_appends_to_a_stretch_report_numbers_of_the_whole(tmp_path: Path, golden: Golden) -> None:
    columns = samples(5, 400, 6.0, 0.0)
    of: dict[str, Any] = {"bit_diameter": 0.2, "sectors": K, "start_depth": 100.0, "max_distance": 0.3, "threads": 1}
    stretch = hb.Wall(**of, first_vertex=20 * K, stop_vertex=40 * K)
    stretch.append(*(column[:200] for column in columns))
    before = stretch.vertices()
    change = stretch.append(*(column[200:] for column in columns))
    after = stretch.vertices()
    differ = np.zeros(20 * K, dtype=bool)
    for old, new in zip(before, after, strict=True):
        differ |= (old != new) & ~((old != old) & (new != new))
    stated = np.zeros(20 * K, dtype=bool)
    for start, stop in change.ranges:
        stated[start - 20 * K : stop - 20 * K] = True
    assert (differ <= stated).all()
    assert differ.any()
    stretch.save(tmp_path / "stretch.wall")
    for again in (hb.load(tmp_path / "stretch.wall"), pickle.loads(pickle.dumps(stretch))):
        assert bits(again.vertices(20 * K, 40 * K)) == bits(after)
    with golden.raises():
        stretch.vertices(0, 8)


@pytest.mark.parametrize(
    "given_",
    [
        {"first_vertex": 4, "start_depth": 1.0},
        {"first_vertex": 8},
        {"stop_vertex": 0},
        {"stop_vertex": 8, "stop_depth": 2.0},
    ],
)
def test_settings_of_a_stretch_that_break_a_rule(given_: dict[str, Any], golden: Golden) -> None:
    with pytest.raises(hb.InputError) as caught:
        hb.Wall(bit_diameter=0.2, sectors=K, **given_)
    golden(str(caught.value))


def rows(logs: Logs, start: int, stop: int) -> list[bytes]:
    return [np.ascontiguousarray(getattr(logs, name)[start:stop]).tobytes() for name in COLUMN_NAMES]


@given(st.integers(0, 2**32), st.sampled_from([0.05, -0.05]))
@settings(max_examples=5)
def test_logs_of_stretches_have_the_bits_of_the_whole(seed: int, pitch: float) -> None:
    columns = samples(seed, 6000, 40.0, 1.5)
    time = np.arange(6000.0)
    of: dict[str, Any] = {"bit_diameter": 0.2, "sectors": K, "start_depth": 100.0 if pitch > 0 else 141.5}
    of |= {"pitch": pitch, "max_distance": 0.5, "threads": 1}
    whole = hb.Wall(**of)
    whole.append(*columns, time)
    want, radius = turn_logs(whole, threads=1), whole.radius
    reference = float(radius[np.isfinite(radius)][0])
    turns, margin = len(whole) // K, 10
    for first in range(0, turns, 256):
        stop = min(first + 256, turns)
        begin, end = max(0, first - margin), min(stop + margin, turns)
        stretch = hb.Wall(**of, first_vertex=begin * K, stop_vertex=end * K)
        stretch.append(*columns, time)
        found = turn_logs(stretch, threads=1, reference=reference)
        assert rows(found, first - begin, stop - begin) == rows(want, first, stop)
    assert math.isfinite(reference)

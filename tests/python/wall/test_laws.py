"""The laws of the wall: split, change, settled, threads and instruction sets, bounds, all or nothing.

Each holds to the last bit unless it says otherwise. (The law of the path is in test_survey.py and test_surface.py.)
"""

from __future__ import annotations

import hashlib
import itertools
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from reference import Floats, bits, bits_by_vertex, canonical, exactly, instruction_sets, random_hole

import helibore as hb

BIT = 0.216
Columns = tuple[Floats, ...]
patient = settings(deadline=None, max_examples=150, suppress_health_check=[HealthCheck.too_slow])


@st.composite
def samples(draw: st.DrawFn, timed: bool | None = None, least: int = 0) -> Columns:
    """Up to 80 samples of 3 m of hole, on a coarse grid (ties, duplicates) or shaken off it; with times or without."""
    row = st.tuples(st.integers(0, 96), st.integers(0, 23), st.integers(0, 9), st.integers(0, 3))
    rows = np.array(draw(st.lists(row, min_size=least, max_size=80)), dtype=float).reshape(-1, 4)
    depth, toolface, radius, time = rows[:, 0] / 32, rows[:, 1] * 15, 0.08 + rows[:, 2] / 100, rows[:, 3]
    if draw(st.booleans()):
        rng = np.random.default_rng(draw(st.integers(0, 99)))
        depth, toolface = depth + rng.uniform(0, 0.03, depth.size), toolface + rng.uniform(-400, 400, depth.size)
    with_time = draw(st.booleans()) if timed is None else timed
    return (depth, toolface, radius, time) if with_time else (depth, toolface, radius)


wall_settings = st.fixed_dictionaries(
    {
        "bit_diameter": st.sampled_from([0.05, BIT, 0.5]),
        "sectors": st.integers(3, 20),
        "pitch": st.sampled_from([0.05, 0.31, 1.0, -0.07, -0.5]),
        "start_depth": st.sampled_from([None, None, -0.5, 0.0, 1.3, 4.0]),
        "stop_depth": st.sampled_from([None, None, None, 2.0]),
        "start_toolface": st.sampled_from([0.0, 359.0, -77.7]),
        "neighbors": st.sampled_from([1, 2, 5, 8, 11, 40]),
        "window": st.sampled_from([None, None, 1, 6, 25]),
        "power": st.sampled_from([1.0, 2.0, 0.7]),
        "max_distance": st.sampled_from([None, 1.0, 0.2, 0.03]),
        "max_iterations": st.integers(1, 5),
        "tolerance": st.sampled_from([0.0, 1e-6, 1e-3]),
        "angular_scale": st.sampled_from([1.0, 2.0, 0.3]),
        "estimator": st.sampled_from(["inverse-distance", "inverse-distance", "kriging"]),
        "kriging_range": st.sampled_from([0.07, 0.4, 30.0]),
        "nugget": st.sampled_from([1e-6, 0.1]),
        "direct": st.booleans(),
        "threads": st.sampled_from([1, 2]),
    }
)


def pieces(columns: Columns, cuts: list[int]) -> list[Columns]:
    edges = [0, *sorted(cut % (columns[0].size + 1) for cut in cuts), columns[0].size]
    return [tuple(c[a:b] for c in columns) for a, b in itertools.pairwise(edges)]


def whole(columns: Columns, given_settings: dict[str, Any]) -> hb.Wall:
    wall = hb.Wall(**given_settings)
    wall.append(*columns)
    return wall


@patient
@given(samples(), wall_settings, st.lists(st.integers(0, 80), max_size=6), st.randoms())
def test_split(columns: Columns, chosen: dict[str, Any], cuts: list[int], random: Any) -> None:
    """Any split into appends, and with times any order of arrival, gives the bits of one append."""
    once = whole(columns, chosen)
    order = list(range(columns[0].size))
    if len(columns) == 4:
        random.shuffle(order)
    wall, accepted = hb.Wall(**chosen), 0
    for piece in pieces(tuple(c[order] for c in columns), cuts):
        accepted += wall.append(*piece).accepted
    assert bits(wall) == bits(once)
    assert accepted == wall.sample_count
    np.testing.assert_array_equal(wall.samples.radius, once.samples.radius)
    np.testing.assert_array_equal(wall.samples.toolface, once.samples.toolface)


@patient
@given(samples(), wall_settings, st.lists(st.integers(0, 80), max_size=6))
def test_change(columns: Columns, chosen: dict[str, Any], cuts: list[int]) -> None:
    """The ranges are the vertices that are new or differ: all of them, no others, sorted and apart.

    Where the helix starts anew at a shallower sample, every vertex is new.
    """
    wall, before, start = hb.Wall(**chosen), bits_by_vertex(hb.Wall(bit_diameter=BIT)), None
    for piece in pieces(columns, cuts):
        change, now = wall.append(*piece), bits_by_vertex(wall)
        flat = change.ranges.ravel()
        assert np.all(np.diff(flat) > 0)  # start < stop < next start
        reported = np.zeros(len(wall), bool)
        for first, last in change.ranges:
            assert 0 <= first < last <= len(wall)
            reported[first:last] = True
        expected = np.ones(len(wall), bool)
        if start == wall.start_depth:
            assert len(wall) >= before.size
            expected[: before.size] = now[: before.size] != before
        np.testing.assert_array_equal(reported, expected)
        assert change.settled == wall.settled
        before, start = now, wall.start_depth if len(wall) else None


@patient
@given(samples(least=1), wall_settings, st.lists(st.integers(1, 80), max_size=8))
def test_settled(columns: Columns, chosen: dict[str, Any], cuts: list[int]) -> None:
    """Below `settled` nothing changes while samples come in the order of the helix, the deepest so far included."""
    direction = np.sign(chosen["pitch"])
    order = np.argsort(direction * columns[0], kind="stable")
    wall, kept = hb.Wall(**chosen), bits_by_vertex(hb.Wall(bit_diameter=BIT))
    for piece in pieces(tuple(c[order] for c in columns), cuts):
        change, now = wall.append(*piece), bits_by_vertex(wall)
        np.testing.assert_array_equal(now[: kept.size], kept)
        assert not change.ranges.size or change.ranges[0, 0] >= kept.size
        assert change.settled <= len(wall)
        kept = now[: change.settled]


@pytest.mark.parametrize("pitch", [0.1, -0.1])
def test_settled_follows_the_bit(pitch: float) -> None:
    """In a dense hole all but the last decimetres are settled, so the law above says something."""
    columns = random_hole(1, "oval", 20_000, 20.0)
    step = slice(None) if pitch > 0 else slice(None, None, -1)
    wall = whole(tuple(c[step] for c in columns), {"bit_diameter": BIT, "pitch": pitch, "sectors": 32})
    assert (len(wall) - wall.settled) * abs(pitch) / 32 < 0.3


@pytest.mark.parametrize("window", [None, 100])
def test_a_rescan_touches_its_metres_and_the_reach_around_them(window: int | None) -> None:
    columns = random_hole(2, "spiral", 30_000, 30.0, top=0.0)
    wall = whole(columns, {"bit_diameter": BIT, "sectors": 32, "pitch": 0.05, "window": window})
    depth, toolface, radius = random_hole(3, "oval", 3000, 2.0, top=14.0)
    before = wall.depth, wall.radius
    change = wall.append(depth, toolface, radius)
    assert 0 < len(change) <= (2.0 + 2 * 0.25) / 0.05 * 32
    touched = np.concatenate([before[0][a:b] for a, b in change.ranges])
    assert 13.75 < touched.min() < 14.05 < 15.95 < touched.max() < 16.25
    assert np.mean(wall.radius != before[1]) > 0.06


@pytest.mark.parametrize(
    "chosen",
    [
        {},
        {"window": 100},
        {"neighbors": 20, "power": 0.7, "pitch": -0.03},
        {"neighbors": 3, "power": 2.0, "max_distance": 0.02, "start_toolface": 123.4},
        {"neighbors": 8, "max_distance": None, "angular_scale": 2.0, "tolerance": 0.0, "sectors": 51},
        {"estimator": "kriging", "kriging_range": 0.2},
        {"estimator": "kriging", "kriging_range": 0.2, "neighbors": 7, "nugget": 1e-6, "max_distance": 0.02},
    ],
    ids=str,
)
def test_threads_and_instruction_sets(chosen: dict[str, Any]) -> None:
    """One hash for 1, 2 and 7 threads and every instruction set; enough work that all seven threads get some."""
    columns = random_hole(4, "washed", 30_000, 12.0)
    columns = (*columns, np.arange(columns[0].size, dtype=float))
    order = np.random.default_rng(5).permutation(columns[0].size)
    columns = tuple(c[order] for c in columns)
    sets = instruction_sets()
    chosen = {"bit_diameter": BIT, "sectors": 48, "pitch": 0.1} | chosen
    hashes = {
        hashlib.sha256(bits(whole(columns, chosen | {"threads": threads, "instruction_set": name}))).hexdigest()
        for threads, name in [*itertools.product((1, 7), sets), (2, "automatic")]
    }
    assert len(hashes) == 1


@patient
@given(samples(), wall_settings)
def test_instruction_sets_on_small_holes(columns: Columns, chosen: dict[str, Any]) -> None:
    """Ties, gaps and lists that do not fill a vector."""
    sets = instruction_sets()
    assert len({bits(whole(columns, chosen | {"instruction_set": name})) for name in sets}) == 1


@pytest.mark.parametrize("timed", [False, True])
def test_sorting_in_parallel(timed: bool) -> None:
    """Large batches are sorted by several threads: no row is lost, moved or counted twice."""
    rng = np.random.default_rng(6)
    n = 200_000
    depth, toolface = np.round(rng.uniform(0, 50, n), 2), np.round(rng.uniform(0, 360, n))
    columns = (depth, toolface, rng.integers(1, 4, n) / 16.0, *([rng.integers(0, 2, n).astype(float)] if timed else []))
    chosen = {"bit_diameter": BIT, "sectors": 4, "pitch": 5.0}
    one, seven = whole(columns, chosen | {"threads": 1}), whole(columns, chosen | {"threads": 7})
    assert bits(one) == bits(seven)
    for name, truth in zip(("depth", "toolface", "radius"), canonical(*columns), strict=True):
        np.testing.assert_array_equal(getattr(seven.samples, name), truth)


@patient
@given(samples(least=1), wall_settings)
def test_bounds(columns: Columns, chosen: dict[str, Any]) -> None:
    """No radius leaves the least and the greatest sample, by kriging by more than half of their difference; a constant
    comes back as it is.
    """
    radius = whole(columns, chosen).radius
    radius = radius[~np.isnan(radius)]
    low, high = columns[2].min(), columns[2].max()
    beyond = 0.5 * (high - low) if chosen["estimator"] == "kriging" else 0.0
    assert np.all((low - beyond <= radius) & (radius <= high + beyond))
    constant = whole((*columns[:2], np.full(columns[0].size, 0.1234567), *columns[3:]), chosen)
    shown = (constant.support > 0) | constant.provisional
    assert np.all((constant.radius == 0.1234567) | ~shown)
    np.testing.assert_array_equal(np.isnan(constant.radius), ~shown)


@pytest.mark.parametrize("pitch", [0.15, -0.15])
def test_turning_by_one_step_shifts_by_one_vertex(pitch: float) -> None:
    """Every toolface turned by 360/K: vertex k + 1 of a helix that starts one vertex earlier is vertex k of before."""
    sectors = 24
    depth, toolface, radius = random_hole(7, "oval", 1500, 4.0)
    start = 1000.5 if pitch > 0 else 1003.5
    chosen = {"bit_diameter": BIT, "sectors": sectors, "pitch": pitch}
    wall = whole((depth, toolface, radius), chosen | {"start_depth": start})
    turned = whole((depth, toolface + 360 / sectors, radius), chosen | {"start_depth": start - pitch / sectors})
    n = min(len(wall), len(turned) - 1)
    assert n > 300
    np.testing.assert_allclose(turned.radius[1 : n + 1], wall.radius[:n], rtol=0, atol=1e-11)
    np.testing.assert_array_equal(turned.support[1 : n + 1], wall.support[:n])


def test_turning_a_level_ring_shifts_it_exactly() -> None:
    """A pitch that is nothing beside the samples' spread: the steps are then exact, and so is the shift."""
    rng = np.random.default_rng(3)
    toolface, radius = rng.integers(0, 360 * 64, 200) / 64.0, rng.uniform(0.1, 0.12, 200)
    chosen = {"bit_diameter": BIT, "sectors": 8, "pitch": 2.0**-60, "start_depth": 0.0, "stop_depth": 2.0**-60}
    wall = whole((np.zeros(200), toolface, radius), chosen)
    turned = whole((np.zeros(200), toolface + 45.0, radius), chosen)
    np.testing.assert_array_equal(turned.radius[1:], wall.radius[:-1])


BAD = [
    (([1.0, np.nan], [0.0, 0.0], [0.1, 0.1], [9.0, 9.0]), "depth[1] = nan: must be finite"),
    (([1.0, 2.0], [0.0, np.inf], [0.1, 0.1], [9.0, 9.0]), "toolface[1] = inf: must be finite"),
    (([1.0, 2.0], [0.0, 0.0], [np.nan, 0.1], [9.0, 9.0]), "radius[0] = nan: must be finite"),
    (([1.0, 2.0], [0.0, 0.0], [0.1, 0.0], [9.0, 9.0]), "radius[1] = 0: must be above 0 and at most 2 m"),
    (([1.0, 2.0], [0.0, 0.0], [0.1, 8.5], [9.0, 9.0]), "radius[1] = 8.5: must be above 0 and at most 2 m"),
    (([1.0, 2.0], [0.0, 0.0], [0.1, 0.1], [9.0, -np.inf]), "time[1] = -inf: must be finite"),
    (([1.0, 2.0], [0.0], [0.1, 0.1], [9.0, 9.0]), "toolface has 1 values, depth has 2: must be equal"),
    (([1.0, 2.0], [0.0, 0.0], [0.1, 0.1, 0.1], [9.0, 9.0]), "radius has 3 values, depth has 2: must be equal"),
    (([1.0, 2.0], [0.0, 0.0], [0.1, 0.1], [9.0]), "time has 1 values, depth has 2: must be equal"),
    (([1.0, 2.0], [0.0, 0.0], [0.1, 0.1], []), "time has 0 values, depth has 2: must be equal"),
    (([1.0], [0.0], [0.1], None), "time: missing, but earlier samples have one; give it for all or none"),
    (
        ([1e7], [0.0], [0.1], [9.0]),
        "depth = 1e+07: the wall from 0 m to 1e+07 m would have 640000001 vertices; "
        "must be at most most_vertices = 100000000",
    ),
    (
        ([1e9], [0.0], [0.1], [9.0]),
        "depth[0] = 1e+09: must lie in -10000000 to 10000000 m",
    ),
]


@pytest.mark.parametrize(("bad", "text"), BAD, ids=[text for _, text in BAD])
def test_all_or_nothing(bad: tuple[Any, ...], text: str) -> None:
    """A rejected append leaves every bit, and the next one as if it had never been."""
    chosen: dict[str, Any] = {"bit_diameter": BIT, "sectors": 8, "pitch": 0.125, "start_depth": 0.0}
    depth, toolface, radius = random_hole(8, "oval", 500, 3.0, top=0.0)
    columns = (depth, toolface, radius, np.arange(500.0))
    early, late = pieces(columns, [300])
    wall = whole(early, chosen)
    before, kept = bits(wall), wall.samples
    with pytest.raises(ValueError, match=exactly(text)):
        wall.append(*bad)
    assert bits(wall) == before
    for name in ("depth", "toolface", "radius", "time"):
        np.testing.assert_array_equal(getattr(wall.samples, name), getattr(kept, name))
    wall.append(*late)
    assert bits(wall) == bits(whole(columns, chosen))


def test_a_time_where_there_was_none(golden: Golden) -> None:
    wall = whole(([1.0], [0.0], [0.1]), {"bit_diameter": BIT})
    before = bits(wall)
    with golden.raises():
        wall.append([1.0], [0.0], [0.1], [3.0])
    assert bits(wall) == before

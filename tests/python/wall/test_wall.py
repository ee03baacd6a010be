"""The wall against the brute-force reference, and at its edges: few samples, gaps, ties, long lists, bad settings."""

from __future__ import annotations

import gc
import threading
import weakref
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden
from reference import FIELDS, Floats, bits, exactly, random_hole, reference

import helibore as hb

BIT = 0.216


def rebuild(columns: tuple[Floats, ...], **settings: Any) -> hb.Wall:
    return hb.reconstruct(hb.Caliper(*columns), **{"bit_diameter": BIT, **settings})


def agree(columns: tuple[Floats, ...], **settings: Any) -> hb.Wall:
    """Compare all four fields with the reference: the published bar, and the one that rounding alone allows."""
    settings = {"bit_diameter": BIT, **settings}
    wall, truth = rebuild(columns, **settings), reference(*columns, **settings)
    np.testing.assert_array_equal(wall.depth, truth.depth)
    np.testing.assert_allclose(wall.toolface, truth.toolface, rtol=0, atol=1e-12)
    error = abs(wall.radius - truth.radius)[~np.isnan(truth.radius)]
    np.testing.assert_array_equal(np.isnan(wall.radius), np.isnan(truth.radius))
    if error.size:
        assert np.mean(error <= 1e-6) >= 0.999
        assert error.max() <= 2e-4
        assert error.max() <= 1e-12
    np.testing.assert_allclose(wall.nearest, truth.nearest, rtol=1e-11, atol=1e-13)
    np.testing.assert_array_equal(wall.support, truth.support)
    np.testing.assert_array_equal(wall.iterations, truth.iterations)
    return wall


CASES = [
    {"shape": "round", "n": 900, "length": 3.0},
    {"shape": "oval", "n": 2500, "length": 6.0, "sectors": 48, "pitch": 0.3},
    {"shape": "spiral", "n": 1500, "length": 9.0, "sectors": 37, "pitch": -0.37},
    {"shape": "washed", "n": 2000, "length": 4.0, "sectors": 16, "pitch": 0.05, "start_toolface": 359.5},
    {"shape": "broken", "n": 600, "length": 30.0, "sectors": 12, "pitch": 0.2, "max_distance": 0.5},
    {"shape": "broken", "n": 300, "length": 40.0, "sectors": 8, "pitch": 0.25, "max_distance": None},
    {"shape": "round", "n": 80, "length": 12.0, "sectors": 24, "pitch": 0.5, "max_distance": 0.06},
    {"shape": "oval", "n": 1200, "length": 5.0, "sectors": 20, "pitch": 0.2, "neighbors": 1},
    {"shape": "washed", "n": 1200, "length": 5.0, "sectors": 20, "pitch": -0.2, "neighbors": 3, "power": 2.0},
    {"shape": "spiral", "n": 1200, "length": 5.0, "sectors": 20, "pitch": 0.2, "neighbors": 20, "power": 0.5},
    {"shape": "oval", "n": 1200, "length": 5.0, "sectors": 20, "pitch": 0.2, "neighbors": 12, "power": 3.7},
    {"shape": "washed", "n": 1200, "length": 5.0, "sectors": 20, "pitch": 0.2, "angular_scale": 2.0},
    {"shape": "broken", "n": 600, "length": 30, "sectors": 12, "pitch": 0.2, "max_distance": 0.2, "angular_scale": 8},
    {"shape": "round", "n": 400, "length": 6, "sectors": 24, "pitch": 0.5, "max_distance": 0.08, "angular_scale": 0.3},
    {"shape": "oval", "n": 2500, "length": 4.0, "sectors": 20, "pitch": 0.2, "neighbors": 60, "angular_scale": 3.0},
    {"shape": "oval", "n": 1200, "length": 5.0, "sectors": 20, "pitch": 0.2, "max_iterations": 1},
    {"shape": "washed", "n": 1200, "length": 5.0, "sectors": 20, "pitch": 0.2, "max_iterations": 40, "tolerance": 1e-9},
    {"shape": "oval", "n": 800, "length": 4, "sectors": 3, "pitch": 0.01, "start_depth": 1001.0, "stop_depth": 1002.0},
    {"shape": "round", "n": 800, "length": 4, "sectors": 30, "pitch": 0.2, "start_depth": 998.0, "stop_depth": 1006.0},
]  # fmt: skip


@pytest.mark.parametrize("window", [None, 100, 31, 1])
@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case['shape']}-{CASES.index(case)}")
def test_agrees_with_the_reference(case: dict[str, Any], window: int | None) -> None:
    settings = {name: value for name, value in case.items() if name not in ("shape", "n", "length")}
    columns = random_hole(CASES.index(case), case["shape"], case["n"], case["length"])
    agree(columns, **settings, window=window)


def test_agrees_with_the_reference_on_holes_nobody_has_seen() -> None:
    rng = np.random.default_rng()
    seed = int(rng.integers(2**31))
    print("seed", seed)  # pytest shows it when the test fails
    rng = np.random.default_rng(seed)
    for shape in ("round", "oval", "spiral", "washed", "broken"):
        length = float(rng.uniform(1, 20))
        columns = random_hole(int(rng.integers(2**31)), shape, int(rng.integers(50, 2000)), length)
        agree(
            columns,
            sectors=int(rng.integers(3, 40)),
            pitch=float(rng.choice([-1, 1]) * rng.uniform(0.02, 0.08) * length),
            neighbors=int(rng.integers(1, 21)),
            window=rng.choice([None, int(rng.integers(1, 200))]),
            max_distance=rng.choice([None, float(rng.uniform(0.01, 1.0))]),
            angular_scale=float(rng.choice([1.0, 2.0])),
        )


@pytest.mark.parametrize("neighbors", [4, 8, 64, 256])
@pytest.mark.parametrize("window", [None, 6000])
def test_candidates_that_fill_the_search_list(neighbors: int, window: int | None) -> None:
    """A few sectors over very dense samples: more candidates than the core keeps at once, so that it drops some."""
    columns = random_hole(5, "washed", 20_000, 0.5)
    agree(columns, sectors=3, pitch=0.1, neighbors=neighbors, window=window, bit_diameter=0.05)


def test_a_trial_radius_far_from_the_wall() -> None:
    """Candidates dropped at the first radius may be the nearest at the next."""
    columns = random_hole(6, "oval", 20_000, 0.5)
    for bit_diameter in (0.002, 3.9):
        agree(columns, sectors=4, pitch=0.2, neighbors=100, bit_diameter=bit_diameter, max_distance=None)


@pytest.mark.parametrize("window", [None, 40])
def test_ties_go_by_canonical_order(window: int | None) -> None:
    """Arms at fixed angles and regular steps: most distances have an equal."""
    rng = np.random.default_rng(8)
    depth, toolface = (
        grid.ravel() for grid in np.meshgrid(np.arange(64) / 64, np.arange(0.0, 360.0, 45.0), indexing="ij")
    )
    radius = 0.1 + 0.02 * rng.random(depth.size)
    settings = {"bit_diameter": BIT, "sectors": 16, "pitch": 0.25, "max_iterations": 1, "window": window}
    wall = rebuild((depth, toolface, radius), **settings)
    truth = reference(depth, toolface, radius, digits=12, **settings)
    error = abs(wall.radius - truth.radius)
    assert np.mean(error <= 1e-6) >= 0.999
    assert error.max() <= 2e-4
    np.testing.assert_array_equal(wall.support, truth.support)


@pytest.mark.parametrize("apart", [1e-5, 1e-7, 1e-9])
@pytest.mark.parametrize("from_surface", [0.0, 1e6])
def test_what_floats_cannot_tell_apart(apart: float, from_surface: float) -> None:
    """Clusters of samples closer together than single precision resolves, with radii that differ: each choice shows."""
    rng = np.random.default_rng(9)
    depth = from_surface + 0.0071 + np.repeat(np.arange(0.0, 1.0, 0.02), 80) + apart * rng.normal(size=4000)
    toolface = 7.3 + np.tile(np.repeat(np.arange(0.0, 360.0, 18.0), 4), 50) + 1000 * apart * rng.normal(size=4000)
    radius = 0.1 + 0.02 * rng.random(4000)
    for neighbors in (1, 5, 8):
        agree((depth, toolface, radius), sectors=24, pitch=0.09, neighbors=neighbors, max_iterations=1)


def test_an_estimate_that_swings_settles_on_the_mean() -> None:
    """One sample beside the vertex and one above it: each radius makes the other the nearest."""
    at = {"sectors": 4, "pitch": 0.4, "neighbors": 1, "start_depth": 1.0, "stop_depth": 1.0, "max_iterations": 50}
    wall = rebuild(([1.0, 1.1], [60.0, 0.0], [0.12, 0.08]), **at)
    assert wall.radius[0] == (0.12 + 0.08) / 2
    assert wall.iterations[0] == 3


def test_max_distance_is_measured_on_the_wall() -> None:
    """At a quarter of a turn: 0.17 m on the wall, 5.4 m as angular_scale sees it."""
    for reach, support in ((0.2, 1), (0.1, 0)):
        wall = rebuild(([1.0], [90.0], [BIT / 2]), sectors=4, start_depth=1.0, max_distance=reach, angular_scale=32.0)
        assert wall.support[0] == support


def test_a_vertex_on_samples_is_their_mean() -> None:
    wall = rebuild(([5.0, 5.0, 5.0, 5.1], [0.0, 360.0, 0.0, 90.0], [0.1, 0.2, 0.6, 0.1]), sectors=4, pitch=0.1)
    assert wall.radius[0] == pytest.approx(0.3, abs=1e-15)
    assert wall.nearest[0] == 0.0
    assert wall.support[0] == 4


def test_across_0_and_360() -> None:
    """The nearest samples of toolface 0 lie on both sides of it."""
    columns = ([1.0] * 4, [359.0, 2.0, 180.0, 90.0], [0.11, 0.14, 0.3, 0.3])
    wall = rebuild(columns, sectors=4, pitch=0.1, neighbors=2)
    assert wall.radius[0] == pytest.approx((2 * 0.11 + 0.14) / 3, abs=1e-12)
    turned = rebuild((columns[0], [-1.0, 362.0, -180.0, 450.0], columns[2]), sectors=4, pitch=0.1, neighbors=2)
    assert bits(turned) == bits(wall)


def test_no_samples_no_vertices() -> None:
    wall = hb.Wall(bit_diameter=BIT, start_depth=10.0, stop_depth=20.0)
    change = wall.append([], [], [])
    assert (len(wall), wall.sample_count, wall.settled, change.ranges.shape) == (0, 0, 0, (0, 2))
    assert np.isnan(hb.Wall(bit_diameter=BIT).start_depth)
    assert all(getattr(wall, name).shape == (0,) for name in ("depth", "toolface", *FIELDS))
    assert repr(wall) == "Wall(empty)"


@pytest.mark.parametrize("pitch", [0.1, -0.1])
def test_one_sample(pitch: float) -> None:
    wall = rebuild(([7.0], [10.0], [0.11]), pitch=pitch)
    assert len(wall) == 1
    assert (wall.radius[0], wall.support[0], wall.depth[0], wall.toolface[0]) == (0.11, 1, 7.0, 0.0)


@pytest.mark.parametrize("n", [2, 7, 8, 9])
@pytest.mark.parametrize("window", [None, 4, 100])
def test_few_samples(n: int, window: int | None) -> None:
    wall = agree(random_hole(n, "round", n, 1.5), sectors=10, pitch=0.3, window=window)
    assert wall.support.max() <= min(n, 8, window or 8)


def test_a_gap_wider_than_max_distance_stays_a_gap() -> None:
    above, below = random_hole(1, "round", 400, 2.0, top=0.0), random_hole(2, "round", 400, 2.0, top=5.0)
    wall = agree(tuple(np.concatenate(pair) for pair in zip(above, below, strict=True)), sectors=8, max_distance=0.7)
    gap = (wall.depth > above[0][-1] + 0.7) & (wall.depth < below[0][0] - 0.7)
    assert gap.any()
    assert np.isnan(wall.radius[gap]).all()
    assert not wall.support[gap].any()
    assert not np.isnan(wall.radius[~gap]).all()


@pytest.mark.parametrize("pitch", [0.2, -0.2])
def test_samples_beyond_the_ends_count_as_neighbours(pitch: float) -> None:
    columns = random_hole(3, "oval", 700, 3.0)
    start, stop = (1001.0, 1002.0) if pitch > 0 else (1002.0, 1001.0)
    wall = agree(columns, pitch=pitch, start_depth=start, stop_depth=stop)
    whole = columns[0]
    cut = tuple(c[(whole >= 1001.0) & (whole <= 1002.0)] for c in columns)
    assert rebuild(cut, pitch=pitch, start_depth=start, stop_depth=stop).radius[0] != wall.radius[0]


def test_a_helix_that_ends_before_its_first_sample_has_no_vertex() -> None:
    wall = rebuild(random_hole(1, "round", 50, 1.0), start_depth=2000.0)
    assert len(wall) == 0
    assert wall.append([2000.0625], [0.0], [0.1]).ranges.tolist() == [[0, 41]]


def test_duplicate_depths() -> None:
    depth, toolface, radius = random_hole(4, "oval", 900, 3.0)
    agree((np.round(depth, 1), toolface, radius), sectors=12, pitch=0.3)
    agree((np.full(900, 1000.0), toolface, radius), sectors=12, stop_depth=1000.4)


def test_logging_up_is_logging_down_mirrored() -> None:
    """The helix that climbs, through mirrored samples, meets the same distances."""
    depth, toolface, radius = random_hole(9, "spiral", 1000, 4.0, top=0.0)
    down = rebuild((depth, toolface, radius), pitch=0.125, start_depth=0.0, stop_depth=4.0)
    up = rebuild((-depth, toolface, radius), pitch=-0.125, start_depth=0.0, stop_depth=-4.0)
    np.testing.assert_array_equal(up.depth, -down.depth)
    np.testing.assert_allclose(up.radius, down.radius, rtol=0, atol=1e-14)


def test_every_array_is_an_owned_copy() -> None:
    wall = rebuild(random_hole(1, "round", 100, 1.0))
    before = bits(wall)
    for name in ("depth", "toolface", *FIELDS):
        array = getattr(wall, name)
        assert array.flags.writeable
        assert array.dtype == (np.int32 if name in ("support", "iterations") else np.float64)
        array[:] = 0
    wall.samples.depth.base[:] = 0
    assert bits(wall) == before


def test_the_samples_come_back_in_canonical_order() -> None:
    wall = rebuild(([2.0, 1.0, 1.0, 1.0], [-10.0, 370.0, 10.0, 10.0], [0.1, 0.2, 0.3, 0.3], [1.0, 5.0, 4.0, 4.0]))
    assert wall.sample_count == 3
    assert wall.samples.depth.tolist() == [1.0, 1.0, 2.0]
    assert wall.samples.toolface.tolist() == [10.0, 10.0, 350.0]
    assert wall.samples.radius.tolist() == [0.3, 0.2, 0.1]
    assert wall.samples.time is not None
    assert wall.samples.time.tolist() == [4.0, 5.0, 1.0]


def test_change_counts(golden: Golden) -> None:
    wall = hb.Wall(bit_diameter=BIT, sectors=8, start_depth=0.0)
    first = wall.append([0.0, 0.1], [0.0, 90.0], [0.1, 0.1], [1.0, 2.0])
    assert (first.ranges.tolist(), first.accepted, first.redundant) == ([[0, 9]], 2, 0)
    second = wall.append([0.1, 0.1], [90.0, 450.0], [0.1, 0.1], [2.0, 2.0])
    assert (second.ranges.shape, second.accepted, second.redundant, len(second)) == ((0, 2), 0, 2, 0)
    assert second.ranges.dtype == np.int64
    golden(repr(first))
    golden(repr(wall))


SETTING_ERRORS = [
    ("bit_diameter", 0, "bit_diameter = 0: must be finite and above 0"),
    ("bit_diameter", 1e-200, "bit_diameter = 1e-200: must be at least 0.001 m"),
    ("most_vertices", 0, "most_vertices = 0: must lie in 1 to 2147483647"),
    ("most_vertices", 1.5, "most_vertices = 1.5: must be an integer"),
    ("bit_diameter", np.nan, "bit_diameter = nan: must be finite and above 0"),
    ("bit_diameter", 8.5, "bit_diameter = 8.5: must be at most 4 m"),
    ("bit_diameter", "8.5in", "bit_diameter = '8.5in': must be a number"),
    ("bit_diameter", None, "bit_diameter = None: must be a number"),
    ("sectors", 2, "sectors = 2: must lie in 3 to 1000000"),
    ("sectors", 1_000_001, "sectors = 1000001: must lie in 3 to 1000000"),
    ("sectors", 10**30, f"sectors = {10**30}: absolute value must be below 2147483648"),
    ("sectors", 64.0, "sectors = 64.0: must be an integer"),
    ("pitch", 0, "pitch = 0: must be finite and not 0"),
    ("pitch", np.inf, "pitch = inf: must be finite and not 0"),
    ("start_depth", np.nan, "start_depth = nan: must be finite"),
    ("stop_depth", -np.inf, "stop_depth = -inf: must be finite"),
    ("start_toolface", np.inf, "start_toolface = inf: must be finite"),
    ("start_toolface", -1e18, "start_toolface = -1e+18: must lie in -1000000 to 1000000 degrees"),
    ("neighbors", 0, "neighbors = 0: must lie in 1 to 256"),
    ("neighbors", 257, "neighbors = 257: must lie in 1 to 256"),
    ("max_iterations", None, "max_iterations = None: must be an integer"),
    ("window", 0, "window = 0: must be at least 1"),
    ("window", -(10**30), f"window = -{10**30}: absolute value must be below 2147483648"),
    ("power", 0, "power = 0: must be finite and above 0"),
    ("power", -1.5, "power = -1.5: must be finite and above 0"),
    ("max_distance", 0, "max_distance = 0: must be above 0"),
    ("max_distance", np.nan, "max_distance = nan: must be above 0"),
    ("max_iterations", 0, "max_iterations = 0: must lie in 1 to 255"),
    ("max_iterations", 256, "max_iterations = 256: must lie in 1 to 255"),
    ("tolerance", -1e-9, "tolerance = -1e-09: must be 0 or above"),
    ("tolerance", np.nan, "tolerance = nan: must be 0 or above"),
    ("angular_scale", 0, "angular_scale = 0: must be finite and above 0"),
    ("threads", 0, "threads = 0: must lie in 1 to 1024"),
    ("threads", 1025, "threads = 1025: must lie in 1 to 1024"),
    ("threads", 1.5, "threads = 1.5: must be an integer"),
    ("threads", 10**30, f"threads = {10**30}: must lie in 1 to 1024"),
    ("instruction_set", "sse9", "instruction_set = 'sse9': must be automatic, plain, avx2 or avx512"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "value", "text"), SETTING_ERRORS, ids=[f"{n}={v}" for n, v, _ in SETTING_ERRORS])
def test_bad_settings(name: str, value: Any, text: str) -> None:
    with pytest.raises(ValueError, match=exactly(text)):
        hb.Wall(**{"bit_diameter": BIT, name: value})


def test_unknown_settings() -> None:
    with pytest.raises(TypeError, match="neighbours"):
        hb.Wall(bit_diameter=BIT, neighbours=8)


def test_a_wall_too_long_to_be_meant() -> None:
    wall = hb.Wall(bit_diameter=BIT, sectors=1000, pitch=1e-6, start_depth=0.0)
    text = (
        r"^depth = 5000: the wall from 0 m to 5000 m would have 5000000000001 vertices; "
        r"must be at most most_vertices = 100000000$"
    )
    with pytest.raises(ValueError, match=text):
        wall.append([5000.0], [0.0], [0.1], [1.0])
    assert len(wall) == wall.sample_count == 0
    assert wall.samples.time is None


def test_several_python_threads_share_a_wall() -> None:
    """Appends from four threads, reads from two: nobody sees a half-written wall, and the order does not matter."""
    depth, toolface, radius = random_hole(10, "oval", 8000, 20.0)
    time = np.arange(depth.size, dtype=float)
    settings = {"bit_diameter": BIT, "sectors": 32, "pitch": 0.1, "start_depth": 1000.0, "stop_depth": 1020.0}
    wall, failures, writing = hb.Wall(**settings, threads=2), [], threading.Event()
    writing.set()

    def write(part: int) -> None:
        for i in range(part, 80, 4):
            rows = slice(100 * i, 100 * i + 100)
            wall.append(depth[rows], toolface[rows], radius[rows], time[rows])

    def read() -> None:
        while writing.is_set():
            samples, ends = wall.samples, len(wall)
            if len(samples) % 100 or ends not in (0, 6401) or np.any(np.diff(samples.depth) < 0):
                failures.append((len(samples), ends))
            seen = wall.radius
            if not np.all(np.isnan(seen) | ((seen >= radius.min()) & (seen <= radius.max()))):
                failures.append(seen)

    writers = [threading.Thread(target=write, args=(part,)) for part in range(4)]
    readers = [threading.Thread(target=read) for _ in range(2)]
    for thread in (*readers, *writers):
        thread.start()
    for thread in writers:
        thread.join()
    writing.clear()
    for thread in readers:
        thread.join()
    assert not failures
    assert bits(wall) == bits(rebuild((depth, toolface, radius, time), **settings))


def test_memory_goes_with_the_last_reference(tmp_path: Path) -> None:
    """Not when the garbage collector next runs: walls are large, and a run over many wells makes one after another."""
    columns = random_hole(5, "oval", 500, 3.0)
    rebuild(columns).save(tmp_path / "hole.wall")
    gc.disable()
    try:
        for make in (lambda: rebuild(columns), lambda: hb.load(tmp_path / "hole.wall")):
            wall = make()
            wall.attributes["age"] = np.zeros(len(wall) - wall.settings.sectors - 1)
            things = [wall, wall.surface(), wall.logs(), wall.zones(), wall.volume(shells=[0.01])]
            left = [weakref.ref(thing) for thing in things]
            del wall, things
            assert [thing() for thing in left] == [None] * len(left)
    finally:
        gc.enable()


def test_a_wall_drawn_again_with_other_settings_has_the_bits_of_a_new_one_and_keeps_what_was_set_on_it() -> None:
    depth, toolface, radius, *_ = random_hole(6, "oval", 800, 4.0)
    first, more = slice(None, 500), slice(500, None)
    settings = {"bit_diameter": BIT, "start_depth": float(depth.min()), "sectors": 16}
    wall, other = hb.Wall(**settings), {**settings, "estimator": "kriging", "kriging_range": 0.3, "neighbors": 12}
    wall.append(depth[first], toolface[first], radius[first])
    ages = np.arange(len(wall) - 17.0)
    wall.attributes["age"] = ages
    wall.attributes.units["age"] = "h"
    before = wall._state()
    change = wall._redraw(hb.Settings(**other))
    new = rebuild((depth[first], toolface[first], radius[first]), **other)
    assert bits(wall) == bits(new)
    assert (wall.settings, wall.settled) == (new.settings, new.settled)
    assert (change.ranges.tolist(), change.settled, change.accepted) == ([[0, len(wall)]], wall.settled, 0)
    assert before.settings.estimator == "inverse-distance"
    wall.append(depth[more], toolface[more], radius[more])
    assert bits(wall) == bits(rebuild((depth, toolface, radius), **other))
    kept = wall.attributes["age"]
    np.testing.assert_array_equal(kept[: ages.size], ages)
    assert wall.attributes.units == {"age": "h"}
    wall.attributes["later"] = np.zeros(len(wall) - 17)

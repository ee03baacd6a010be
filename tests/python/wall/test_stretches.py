"""Stretches of a hole that are unlike each other: where they begin, and what their covariances are worth."""

from __future__ import annotations

from itertools import combinations, pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from reference import Floats

import helibore as hb
from helibore import _core
from helibore.samples.caliper import Caliper
from helibore.wall import covariance, stretches
from helibore.wall.automatic import choose
from helibore.wall.covariance import likely_covariances, stretch_of, stretches_of
from helibore.wall.estimates import in_depth_order
from helibore.wall.near_and_far import estimates_at
from helibore.wall.stretches import find_stretches

BIT = 0.311
LENGTH = 40.0
GAIN = stretches._GAIN


def oval(depth: Floats, toolface: Floats) -> Floats:
    return np.asarray(0.156 + 0.003 * np.cos(np.radians(2 * toolface + 5 * depth)) + 0.0015 * np.sin(depth))


def broken(depth: Floats, toolface: Floats) -> Floats:
    """One strong breakout near the end of an oval hole."""
    away = toolface % 180.0 - 90.0
    return np.asarray(oval(depth, toolface) + 0.02 * np.exp(-(away**2) / 400) * (np.abs(depth - 37.8) < 0.7))


def six_arms(seed: int, hole: object = broken) -> Caliper:
    """Six arms that turn by eight degrees a metre."""
    assert callable(hole)
    row = np.arange(0.0, LENGTH, 0.1)
    depth, arm = np.repeat(row, 6), np.tile(np.arange(6), row.size)
    toolface = (60.0 * arm + 8.0 * depth) % 360.0
    noise = np.random.default_rng(seed).normal(0, 3e-4, depth.size)
    return hb.Caliper(depth, toolface, hole(depth, toolface) + noise, arm=arm)


@pytest.fixture(scope="module")
def wall() -> hb.Wall:
    return hb.reconstruct(six_arms(3), bit_diameter=BIT, estimator="automatic")


def test_one_strong_event_does_not_spoil_the_rest_of_the_hole(wall: hb.Wall) -> None:
    simple = hb.reconstruct(six_arms(3), bit_diameter=BIT, estimator="inverse-distance")
    off, of_simple = (each.radius - broken(each.depth, each.toolface) for each in (wall, simple))
    away = np.abs(wall.depth - 37.8) > 1.5
    assert np.sqrt(np.mean(off[away] ** 2)) < 0.5 * np.sqrt(np.mean(of_simple[away] ** 2))
    assert np.sqrt(np.mean(off**2)) < np.sqrt(np.mean(of_simple**2))
    known = np.isfinite(wall.sigma)
    assert known.mean() > 0.5
    assert np.mean(np.abs(off) <= 1.96 * wall.sigma, where=known) > 0.9


def test_the_stretch_of_an_event_holds_it_and_below_the_samples_the_whole_hole_counts(wall: hb.Wall) -> None:
    _, *found, below = stretches_of(wall.settings)
    assert len(found) == 2
    assert 34.5 < found[1].start <= 37.1
    assert found[1].covariance.variance > 2e-6
    assert below.start > wall.samples.depth.max()
    assert below.covariance.values == wall.settings.covariance


@pytest.mark.parametrize("border", [13.1, 13.4, 13.8])
def test_a_border_lies_where_the_hole_changes(border: float) -> None:
    depth = np.arange(0.0, 30.0, 0.01)
    toolface = (depth * 1237.0) % 360.0
    rough = 0.004 * np.cos(np.radians(2.0 * toolface)) * np.cos(9.0 * (depth - border))
    noise = np.random.default_rng(8).normal(0.0, 3e-4, depth.size)
    radius = 0.156 + np.where(depth < border, 0.0, rough) + noise
    found = choose(hb.Caliper(depth, toolface, radius), hb.Settings(bit_diameter=BIT, estimator="automatic"))
    assert [of.start for of in stretches_of(found.settings)][2] == pytest.approx(border, abs=0.25)  # two slices


def test_the_settings_of_stretches_repeat_the_wall(wall: hb.Wall) -> None:
    again = hb.reconstruct(six_arms(3), **vars(wall.settings))
    np.testing.assert_array_equal(again.radius, wall.radius)
    np.testing.assert_array_equal(again.sigma, wall.sigma)


def test_a_hole_that_is_alike_all_along_has_one_covariance() -> None:
    choice = choose(six_arms(4, oval), hb.Settings(bit_diameter=BIT, estimator="automatic"))
    assert choice.settings.stretches is None
    assert "stretches" not in choice.sentence


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_where_no_arm_meets_a_breakout_that_turns_the_hole_is_no_other_one(seed: int) -> None:
    """In four passes two arms look at four toolfaces a turn: by them parts of the hole are quiet, and parts are not."""
    rng = np.random.default_rng([seed, 29])
    row, first, start = np.arange(0.0, 20.0, 0.05), np.array([91.0, 99.0, 143.0, 144.0]), rng.uniform(0, 180)
    depth, arm = np.tile(row, 8), np.tile(np.repeat([0, 1], row.size), 4)
    toolface = (np.repeat(first, 2 * row.size) + 180 * arm + 3 * depth) % 360
    away = (toolface - start - 8 * depth + 90) % 180 - 90
    radius = 0.109 + 0.016 * np.exp(-((away / 22) ** 2)) + rng.normal(0, 5e-4, depth.size)
    settings = choose(
        hb.Caliper(depth, toolface, radius, arm=arm), hb.Settings(bit_diameter=0.216, estimator="automatic")
    )
    assert settings.settings.stretches is None


def test_the_sentence_says_that_the_hole_changes() -> None:
    choice = choose(six_arms(3), hb.Settings(bit_diameter=BIT, estimator="automatic"))
    assert "the hole changes along it: 2 stretches" in choice.sentence


def test_any_number_of_threads_finds_the_same_stretches() -> None:
    samples = in_depth_order(six_arms(3))
    whole = likely_covariances(samples)[0][0]
    assert find_stretches(samples, whole, False, False, 1) == find_stretches(samples, whole, False, False, 3)


@pytest.mark.parametrize("count", [60, 5000], ids=["few", "many"])
def test_samples_at_one_depth_are_one_stretch(count: int) -> None:
    toolface = np.linspace(0, 360, count, endpoint=False)
    samples = np.full(count, 7.0), toolface, 0.1 + 0.01 * np.cos(np.radians(toolface))
    assert find_stretches(samples, likely_covariances(samples)[0][0], True, False, None) == []


def test_expected_errors_are_those_of_the_stretches(wall: hb.Wall) -> None:
    samples = in_depth_order(wall.samples)
    some = np.arange(5, len(wall), 997)
    places = list(zip(wall.depth[some].tolist(), wall.toolface[some].tolist(), strict=True))
    found = estimates_at(samples, places, wall.settings)
    np.testing.assert_allclose(found[:, 0], wall.radius[some], atol=5e-4)
    of = stretch_of(stretches_of(wall.settings), wall.depth[some])
    assert {1, 2} == set(of.tolist())


def likelihoods() -> st.SearchStrategy[Floats]:
    value = st.integers(-3, 3).map(lambda of: of * GAIN / 3.5)
    table = st.lists(st.lists(value, min_size=3, max_size=3), min_size=1, max_size=6)
    return table.map(lambda rows: np.array(rows, dtype=np.float64))


def score(table: Floats, cuts: list[int], chosen: list[int]) -> float:
    ends = [*cuts[1:], len(table)]
    each = [table[low:high, of].sum() for low, high, of in zip(cuts, ends, chosen, strict=True)]
    return float(np.sum(each)) - GAIN * (len(cuts) - 1)


@given(likelihoods())
def test_no_other_stretches_are_likelier(table: Floats) -> None:
    parts = len(table)
    cuts, chosen = stretches._cut(table, GAIN)
    best = -np.inf
    for number in range(parts):
        for inner in combinations(range(1, parts), number):
            begins = [0, *inner]
            sums = [table[low:high].sum(axis=0).max() for low, high in zip(begins, [*inner, parts], strict=True)]
            best = max(best, float(np.sum(sums)) - GAIN * number)
    assert score(table, cuts, chosen) == pytest.approx(best)


@given(likelihoods())
def test_stretches_side_by_side_are_unlike_and_no_two_kinds_are_alike(table: Floats) -> None:
    cuts, chosen = stretches._join_alike(table, stretches._cut(table, GAIN), GAIN)
    assert cuts[0] == 0
    assert all(one != other for one, other in pairwise(chosen))
    of_part = np.repeat(chosen, np.diff([*cuts, len(table)]))
    for one, other in combinations(sorted(set(chosen)), 2):
        sums = [table[of_part == kind].sum(axis=0) for kind in (one, other)]
        assert sums[0][one] + sums[1][other] - (sums[0] + sums[1]).max() >= GAIN


def test_a_mean_of_samples_ends_at_the_border_of_a_stretch() -> None:
    """Four arms in a round hole, wider by 12 mm below 6 m; cells of far neighbours are higher than half a metre."""
    depth = np.repeat(np.arange(0.0, 12.0, 0.025), 4)
    toolface = (15.0 * depth + np.tile(90.0 * np.arange(4), depth.size // 4)) % 360.0
    radius = 0.109 + 0.012 * (depth >= 6.0) + np.random.default_rng(1).normal(0, 5e-4, depth.size)
    quiet = (0.109, 2.5e-7, 4e-8, 0.06, 0.015, 3e-8, 0.12, 3.1)
    washed = (0.121, 2.5e-7, 5e-6, 1.4, 0.03, 2e-5, 0.27, 0.25)
    stretches = (6.0, *washed, 0.0, 1.0, 1.0, 0.0)
    wall = hb.reconstruct(
        hb.Caliper(depth, toolface, radius), bit_diameter=BIT, estimator="near-and-far", covariance=quiet,
        stretches=stretches,
    )  # fmt: skip
    above = (wall.depth > 4.0) & (wall.depth < 5.8)
    assert np.abs(wall.radius[above] - 0.109).max() < 5e-4


def test_noise_of_a_quiet_stretch_is_no_fine_term() -> None:
    """The whole hole has a fine term, by its ledges; the quiet stretch above them has none."""
    depth, toolface = np.arange(19_200) * (0.02 / 64), np.arange(19_200) * (360.0 / 64) % 360.0
    noise = np.random.default_rng(5).normal(0.0, 5e-4, depth.size)
    start = (0.11, 2.6e-7, 9.6e-6, 4.18, 0.263, 1.29e-5, -0.095, 5.78, 2.4e-7, 0.037, 0.0775)
    samples = depth, toolface, 0.11 + noise
    rows = covariance.choose_blocks(depth, toolface, 0.11, np.random.default_rng(1))
    columns = tuple(of[rows.ravel()] for of in samples)
    (found,) = _core.covariances_near(columns, covariance.BLOCK_SIZE, rows.shape[0], [start], 0.01, 1)
    assert found[1] == pytest.approx(2.5e-7, rel=0.2)

"""The estimator 'automatic': what it finds in known holes, settings that repeat the wall, few samples."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from reference import Floats, exactly

import helibore as hb
from helibore.settings import wall_settings
from helibore.settings.keywords import WallSettings
from helibore.wall.automatic import _open_share, choose
from helibore.wall.continuation import leaves_most_unmeasured
from helibore.wall.covariance import Covariance, Term, choose_blocks, fit_covariance, likely_covariances
from helibore.wall.estimates import choose_left_out, in_depth_order
from helibore.wall.near_and_far import Places
from helibore.wall.tune import cross_validate

BIT = 0.216


def oval(depth: Floats, toolface: Floats) -> Floats:
    return np.asarray(0.11 + 0.006 * np.cos(2.0 * np.radians(toolface - 30.0 - 2.0 * depth)))


def four_arms(length: float = 20.0) -> hb.Caliper:
    depth = np.repeat(np.arange(0.0, length, 0.05), 4)
    toolface = (depth * 12.0 + np.tile([0.0, 90.0, 180.0, 270.0], depth.size // 4)) % 360.0
    noise = np.random.default_rng(3).normal(0.0, 3e-4, depth.size)
    return hb.Caliper(depth, toolface, oval(depth, toolface) + noise)


@pytest.fixture(scope="module")
def wall() -> hb.Wall:
    return hb.reconstruct(four_arms(), bit_diameter=BIT, estimator="automatic")


def test_four_arms_of_an_oval_hole_are_joined_by_its_shape(wall: hb.Wall) -> None:
    default = hb.reconstruct(four_arms(), bit_diameter=BIT)
    off = [np.sqrt(np.mean((of.radius - oval(of.depth, of.toolface)) ** 2)) for of in (wall, default)]
    assert wall.settings.estimator == "near-and-far"
    assert off[0] < 0.3 * off[1]


def test_the_settings_found_repeat_the_wall_bit_for_bit(wall: hb.Wall, tmp_path: Path) -> None:
    again = hb.reconstruct(four_arms(), **vars(wall.settings))
    np.testing.assert_array_equal(again.radius, wall.radius)
    wall.save(tmp_path / "found.wall")
    loaded = hb.load(tmp_path / "found.wall")
    assert loaded.settings == wall.settings
    np.testing.assert_array_equal(loaded.radius, wall.radius)
    assert choose(four_arms(), hb.Settings(bit_diameter=BIT, estimator="automatic")).settings == wall.settings


def test_sigma_holds_the_truth_where_it_is_stated(wall: hb.Wall) -> None:
    sigma, off = wall.sigma, np.abs(wall.radius - oval(wall.depth, wall.toolface))
    known = np.isfinite(sigma)
    assert known.mean() > 0.5
    assert np.mean(off[known] <= 1.96 * sigma[known]) > 0.85
    assert np.median(sigma[known]) < 1e-3


def test_left_out_samples_measure_the_error_of_the_settings_found(wall: hb.Wall) -> None:
    found = cross_validate(wall, 300)
    assert found.settings == wall.settings
    assert found.targets == 300
    assert found.sentence.startswith("kriging with near and far neighbours: cross-validated error")
    assert 3e-4 < found.best.alone < 4e-4  # the noise of the sample itself is included
    assert found.best.alone <= found.best.box < 1e-3


def test_arms_that_do_not_turn_leave_gaps_without_a_sigma() -> None:
    depth = np.repeat(np.arange(0.0, 10.0, 0.05), 4)
    toolface = np.tile([10.0, 100.0, 190.0, 280.0], depth.size // 4)
    caliper = hb.Caliper(depth, toolface, oval(0.0 * depth, toolface))
    covariance = (0.11, 1e-8, 1e-7, 0.05, 0.06, 2e-5, 0.1, 5.0)
    wall = hb.reconstruct(caliper, bit_diameter=BIT, estimator="near-and-far", covariance=covariance)
    assert np.isnan(wall.sigma).mean() > 0.8


def test_dense_samples_of_a_rough_hole_take_the_cheapest_estimator_near_the_best() -> None:
    rng = np.random.default_rng(5)
    depth = np.sort(rng.uniform(0.0, 3.0, 9000))
    toolface = rng.uniform(0.0, 360.0, depth.size)
    caliper = hb.Caliper(depth, toolface, oval(depth, toolface) + rng.normal(0.0, 2e-4, depth.size))
    choice = choose(caliper, hb.Settings(bit_diameter=BIT, estimator="automatic"))
    errors = list(choice.errors.values())
    cheapest = next(name for name, of in choice.errors.items() if of <= 1.03 * min(errors))
    assert choice.settings.estimator == cheapest
    assert errors[1] < errors[0]


FEW = {
    "few": (np.arange(20.0), np.arange(20.0) * 17, np.full(20, 0.1) + np.arange(20) * 1e-4),
    "constant": (np.arange(200.0), np.arange(200.0) * 17, np.full(200, 0.1)),
}


@pytest.mark.parametrize(("name", "reason"), [("few", "too few"), ("constant", "equal")])
def test_samples_that_say_nothing_take_inverse_distance_and_say_so(name: str, reason: str) -> None:
    wall = hb.reconstruct(hb.Caliper(*FEW[name]), bit_diameter=BIT, estimator="automatic")
    assert wall.settings.estimator == "inverse-distance"
    assert reason in choose(hb.Caliper(*FEW[name]), hb.Settings(bit_diameter=BIT, estimator="automatic")).sentence
    np.testing.assert_array_equal(wall.radius, hb.reconstruct(hb.Caliper(*FEW[name]), bit_diameter=BIT).radius)


ODD = {
    "one depth": (np.full(300, 5.0), np.arange(300) * 1.2, 0.1 + 1e-3 * np.sin(np.arange(300.0))),
    "one position": (np.full(300, 5.0), np.full(300, 10.0), 0.1 + 1e-3 * np.sin(np.arange(300.0))),
    "one line": (np.arange(300) * 0.05, np.full(300, 10.0), 0.1 + 1e-3 * np.sin(np.arange(300.0))),
}


@pytest.mark.parametrize("name", ODD)
def test_odd_positions_have_a_value_and_a_sigma(name: str) -> None:
    wall = hb.reconstruct(hb.Caliper(*ODD[name]), bit_diameter=BIT, estimator="automatic", sectors=8)
    assert np.isfinite(wall.radius).any()
    if name != "one position":
        assert wall.sigma.shape == wall.radius.shape


@pytest.mark.parametrize(("max_distance", "known"), [(0.01, True), (0.001, False)])
def test_samples_too_far_apart_to_leave_any_out_are_judged_by_their_covariance(
    max_distance: float, known: bool
) -> None:
    rng = np.random.default_rng(8)
    depth, toolface = np.sort(rng.uniform(0.0, 5.0, 3000)), rng.uniform(0.0, 360.0, 3000)
    caliper = hb.Caliper(depth, toolface, oval(depth, toolface) + rng.normal(0.0, 3e-4, 3000))
    settings = hb.Settings(bit_diameter=BIT, estimator="automatic", max_distance=max_distance)
    found = choose(caliper, settings)
    assert found.settings.max_distance == max_distance
    assert bool(found.errors) == known
    assert found.settings.estimator == ("inverse-distance" if known else "near-and-far")
    assert ("cannot be known" in found.sentence) == (not known)


def fixed_arms(count: int, seed: int) -> tuple[hb.Caliper, Callable[[Floats, Floats], Floats]]:
    """Samples of arms that do not turn in a breakout hole, and its true radius."""
    rng = np.random.default_rng(seed)
    start = rng.uniform(0.0, 360.0)

    def truth(depth: Floats, toolface: Floats) -> Floats:
        away = (toolface - start + 90.0) % 180.0 - 90.0
        return np.asarray(0.109 + 0.016 * np.exp(-((away / 22.0) ** 2)) * (0.8 + 0.2 * np.sin(depth / 2.0)))

    depth = np.repeat(np.arange(0.0, 20.0, 0.05), count)
    toolface = (rng.uniform(0.0, 360.0) + np.tile(np.arange(count) * 360.0 / count, depth.size // count)) % 360.0
    return hb.Caliper(depth, toolface, truth(depth, toolface) + rng.normal(0.0, 5e-4, depth.size)), truth


def test_errors_between_fixed_arms_are_expected_within_a_factor_of_two_where_vertices_have_a_sigma() -> None:
    """No sample that is left out lies between these arms, although their gaps are below the largest one."""
    ratios, known = [], []
    for count, seed in ((10, 0), (10, 1), (15, 0), (15, 1)):
        caliper, truth = fixed_arms(count, seed)
        found = choose(caliper, hb.Settings(bit_diameter=BIT, estimator="automatic"))
        assert found.settings.estimator == "near-and-far"
        made = hb.reconstruct(caliper, **vars(found.settings))
        known.append(found.known)
        assert found.known == np.isfinite(made.sigma).mean()
        off = made.radius - truth(made.depth, made.toolface)
        if found.known:
            ratios.append(found.errors["near-and-far"] / np.sqrt(np.mean(off**2)))
    assert known == [0.0, 0.0, 1.0, 1.0]
    assert 0.5 < np.median(ratios) < 2.0


def test_fixed_arms_that_leave_most_of_the_hole_open_state_where_an_error_can_be_known() -> None:
    settings = hb.Settings(bit_diameter=BIT, estimator="automatic")
    two = choose(fixed_arms(2, 0)[0], settings)
    assert (two.settings.estimator, two.errors, two.known) == ("near-and-far", {}, 0.0)
    assert two.sentence.endswith("; its error so far from samples cannot be known")
    all_around, _ = fixed_arms(16, 0)
    kept = np.arange(len(all_around)) % 16 >= 3  # leaves a gap of a quarter of the turn
    most = choose(hb.Caliper(all_around.depth[kept], all_around.toolface[kept], all_around.radius[kept]), settings)
    assert most.known == pytest.approx(0.75, abs=0.08)
    assert f" mm where it can be known, on {100 * most.known:.0f} % of the wall; inverse distance " in most.sentence


def test_a_stretch_without_samples_does_not_make_a_tool_one_that_leaves_the_hole_open() -> None:
    rng = np.random.default_rng(5)
    depth = np.sort(rng.uniform(0.0, 3.0, 9000))
    toolface, radius = rng.uniform(0.0, 360.0, depth.size), np.full(depth.size, 0.108)
    samples, settings = (np.where(depth < 1.5, depth, depth + 30.0), toolface, radius), hb.Settings(bit_diameter=BIT)
    assert not leaves_most_unmeasured(samples, settings)
    _, boxes = choose_left_out(samples, settings, 1000, 0, "")
    assert _open_share(boxes) < 0.05


@pytest.mark.parametrize("seed", [9201, 9202])
def test_the_error_that_is_expected_between_crossing_arms_is_that_of_the_sigma_of_the_wall(seed: int) -> None:
    """Samples that are left out lie beside others of their own arm, wherever the box around them ends."""
    rng = np.random.default_rng(seed)
    depth = np.tile(np.arange(0.0, 20.0, 0.05), 8)
    first = np.repeat(rng.uniform(0.0, 360.0, 2), 1600)
    toolface = (first + np.tile(np.repeat(np.arange(4) * 90.0, 400), 2) + 12.0 * depth) % 360.0
    away = (toolface - 40.0 - 8.0 * depth + 90.0) % 180.0 - 90.0
    radius = 0.109 + 0.016 * np.exp(-((away / 22.0) ** 2)) * (0.8 + 0.2 * np.sin(depth / 2.0))
    caliper = hb.Caliper(depth, toolface, radius + rng.normal(0.0, 5e-4, depth.size))
    choice = choose(caliper, hb.Settings(bit_diameter=BIT, estimator="automatic"))
    sigma = hb.reconstruct(caliper, **vars(choice.settings)).sigma
    expected = choice.errors["near-and-far"]
    assert 0.7 < expected / np.sqrt(np.nanmean(sigma**2)) < 1.5


def test_fewer_samples_are_left_out_where_many_lie_at_one_depth() -> None:
    rng = np.random.default_rng(9)
    settings = hb.Settings(bit_diameter=BIT)

    def left_out(depth: Floats) -> int:
        return choose_left_out((depth, rng.uniform(0.0, 360.0, depth.size), depth), settings, 2000, 0, "")[0].size

    assert 100 < left_out(np.full(100_000, 5.0)) <= 200
    assert left_out(np.full(1_000_000, 5.0)) == 100
    assert left_out(np.linspace(0.0, 100.0, 100_000)) == 2000


def test_a_live_wall_must_be_given_an_estimator() -> None:
    text = "estimator = 'automatic': must be another one where samples arrive later"
    with pytest.raises(hb.InputError, match=exactly(text)):
        hb.Wall(bit_diameter=BIT, estimator="automatic")
    assert hb.Wall(bit_diameter=BIT).settings.estimator == "inverse-distance"


def test_the_estimator_is_automatic_where_none_is_stated(monkeypatch: pytest.MonkeyPatch, wall: hb.Wall) -> None:
    monkeypatch.setattr(wall_settings, "USUAL", "automatic")  # as for users; conftest.py has another one
    assert hb.reconstruct(four_arms(), bit_diameter=BIT).settings == wall.settings


@pytest.mark.parametrize("stated", [{"neighbors": 12}, {"angular_scale": 4.0}, {"window": 200}, {"power": 2.0}])
def test_a_setting_of_inverse_distance_states_it(stated: WallSettings, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(wall_settings, "USUAL", "automatic")
    made = hb.reconstruct(four_arms(), bit_diameter=BIT, **stated)
    assert made.settings == hb.Settings(bit_diameter=BIT, estimator="inverse-distance", **stated)


def test_a_covariance_is_found_again_in_samples_drawn_from_it() -> None:
    truth = Covariance((Term(1e-6, 0.05, 0.06), Term(9e-6, 0.1, 1.0)), 1e-7, 0.11)
    rng = np.random.default_rng(6)
    depth, toolface = np.sort(rng.uniform(0.0, 6.0, 700)), rng.uniform(0.0, 360.0, 700)
    matrix = truth.at(toolface[:, None] - toolface, depth[:, None] - depth) + truth.noise * np.eye(700)
    radius = 0.11 + np.linalg.cholesky(matrix) @ rng.normal(size=700)
    found = fit_covariance((depth, toolface, radius))
    assert found is not None
    for turn, along in ((20.0, 0.0), (0.0, 0.1), (60.0, 0.5)):
        expected = float(truth.variance - truth.at(np.array(turn), np.array(along)))
        assert float(found.variance - found.at(np.array(turn), np.array(along))) == pytest.approx(expected, rel=0.5)


def six_arms(turn: float, rate: float) -> hb.Caliper:
    """Two passes of six arms in a breakout that turns; the arms turn, too."""
    depth = np.tile(np.arange(0.0, 20.0, 0.05), 12)
    toolface = np.repeat([0, 60, 120, 180, 240, 300, 20, 80, 140, 200, 260, 320], 400) + rate * depth
    away = (toolface - 40.0 - turn * depth + 90.0) % 180.0 - 90.0
    noise = np.random.default_rng(4).normal(0.0, 3e-4, depth.size)
    return hb.Caliper(depth, toolface % 360.0, 0.109 + 0.016 * np.exp(-((away / 22.0) ** 2)) + noise)


@pytest.mark.parametrize(("turn", "rate"), [(0.0, 3.0), (8.0, 3.0), (-5.4, 0.0), (13.7, -7.0), (25.0, 12.0)])
def test_the_turn_of_a_breakout_along_the_hole_is_found(turn: float, rate: float) -> None:
    samples = in_depth_order(six_arms(turn, rate))
    found, unturned = fit_covariance(samples), fit_covariance(samples, turning=False)
    assert found is not None
    assert unturned is not None
    assert found.turn == pytest.approx(turn, abs=0.15)
    assert found.turn == 0.0 or found.terms[1].along > 10.0
    assert (unturned.turn, len(unturned.terms)) == (0.0, 2)


def test_a_turn_is_not_one_under_which_fixed_arms_see_twice_as_many_breakouts() -> None:
    """By one pass of six fixed arms, two breakouts that turn by 8 degrees a metre look like four that turn by -4."""
    depth = np.tile(np.arange(0.0, 30.0, 0.05), 6)
    toolface = np.repeat(np.arange(11.0, 360.0, 60.0), 600)
    away = (toolface - 40.0 - 8.0 * depth + 90.0) % 180.0 - 90.0
    noise = np.random.default_rng(5).normal(0.0, 5e-4, depth.size)
    shape = np.exp(-((away / 22.0) ** 2)) * (0.8 + 0.2 * np.sin(depth / 2.0))
    found = fit_covariance(in_depth_order(hb.Caliper(depth, toolface, 0.109 + 0.016 * shape + noise)))
    assert found is not None
    assert found.turn == 0.0 or found.turn == pytest.approx(8.0, abs=0.5)


def test_arms_that_leave_two_turns_possible_find_both() -> None:
    """Four arms at right angles cannot show to which side a breakout turns that looks the same after half a turn."""
    depth = np.tile(np.arange(0.0, 20.0, 0.05), 4)
    toolface = np.repeat([0.0, 90.0, 180.0, 270.0], 400)
    away = (toolface - 45.0 - 8.0 * depth + 90.0) % 180.0 - 90.0
    noise = np.random.default_rng(4).normal(0.0, 3e-4, depth.size)
    radius = 0.109 + 0.016 * np.exp(-((away / 22.0) ** 2)) + noise
    likely = likely_covariances(in_depth_order(hb.Caliper(depth, toolface, radius)))
    for turn in (8.0, -8.0):
        share = [share for of, share in likely if of.half_turns and of.turn == pytest.approx(turn, abs=0.2)]
        assert share == [pytest.approx(0.5, abs=0.15)]


def arms_in(shape: Callable[[Floats, Floats], Floats], count: int, rate: float, height: float) -> hb.Caliper:
    """One pass of arms that turn, in 20 m of a hole."""
    depth = np.repeat(np.arange(0.0, 20.0, height), count)
    toolface = (rate * depth + np.tile(np.arange(count) * 360.0 / count, depth.size // count) + 17.0) % 360.0
    noise = np.random.default_rng(9).normal(0.0, 4e-4, depth.size)
    return hb.Caliper(depth, toolface, 0.109 + shape(depth, toolface) + noise)


@pytest.mark.parametrize(
    ("waves", "turn", "count", "rate", "height"),
    [
        (1, 200.0, 4, 7.0, 0.1),
        (1, -350.0, 6, 0.0, 0.1),
        (2, 90.0, 5, 7.0, 0.152),
        (2, 43.0, 6, 7.0, 0.152),
        (1, 160.0, 3, 7.0, 0.1),
    ],
)
def test_the_pitch_of_a_spiral_hole_is_found(waves: int, turn: float, count: int, rate: float, height: float) -> None:
    def shape(depth: Floats, toolface: Floats) -> Floats:
        return np.asarray(4e-3 * np.cos(waves * np.radians(toolface - turn * depth)))

    caliper = arms_in(shape, count, rate, height)
    found = fit_covariance(in_depth_order(caliper))
    assert found is not None
    assert found.turn == pytest.approx(turn, abs=0.5)
    errors = []
    for estimator in ("automatic", "inverse-distance"):
        wall = hb.reconstruct(caliper, bit_diameter=0.216, estimator=estimator)
        errors.append(np.nanstd(wall.radius - shape(wall.depth, wall.toolface)))
    assert errors[0] < 0.5 * errors[1]


@pytest.mark.parametrize(("turn", "other"), [(6.0, -6.0), (7.0, -8.0)])
def test_three_arms_are_not_sure_of_a_turn(turn: float, other: float) -> None:
    """They see an oval as a circle off centre that turns the other way, twice as fast as they see it."""
    caliper = arms_in(lambda depth, at: 4e-3 * np.cos(2.0 * np.radians(at - turn * depth)), 3, 2.0, 0.1)
    likely = likely_covariances(in_depth_order(caliper))
    assert [(of.half_turns, of.turn) for of, _ in likely] == [
        (True, pytest.approx(turn, abs=0.2)),
        (False, pytest.approx(other, abs=0.3)),
    ]
    assert likely[1][1] > 0.02


@pytest.mark.parametrize("seed", [2, 5])
def test_four_arms_are_not_sure_of_one_of_two_turns_that_they_see_alike(seed: int) -> None:
    """Arms that turn by 3 degrees a metre see ovals that turn by 2 and by 4 alike; the mean turns by 3."""
    depth = np.repeat(np.arange(0.0, 40.0, 0.1), 4)
    toolface = (3.0 * depth + np.tile([20.0, 110.0, 200.0, 290.0], 400)) % 360.0
    noise = np.random.default_rng(seed).normal(0.0, 3e-4, depth.size)
    radius = 0.156 + 0.006 * np.cos(2.0 * np.radians(toolface - 2.0 * depth)) + noise
    likely = likely_covariances(in_depth_order(hb.Caliper(depth, toolface, radius)))
    assert all(share < 0.7 for covariance, share in likely if abs(covariance.turn - 3.0) > 0.6)


def test_blocks_hold_samples_of_their_window() -> None:
    depth = np.sort(np.random.default_rng(1).uniform(0.0, 50.0, 3000))
    toolface = np.random.default_rng(3).uniform(0.0, 360.0, depth.size)
    rows = choose_blocks(depth, toolface, 0.11, np.random.default_rng(2))
    assert rows.shape == (72, 64)
    assert all(np.unique(block).size == 64 for block in rows)
    spans = np.ptp(depth[rows], axis=1).reshape(6, 12).mean(axis=1)
    assert np.all(np.diff(spans[2:]) > 0)


@pytest.mark.parametrize("term", [Term(1.0, 0.1, 0.05), Term(1.0, 0.02, 40.0)], ids=["short", "longer than any scale"])
def test_nearest_samples_lie_outside_the_box_within_max_distance(term: Term) -> None:
    rng = np.random.default_rng(12)
    depth, toolface = np.sort(rng.uniform(0.0, 3.0, 500)), rng.uniform(0.0, 360.0, 500)
    covariance = Covariance((term,), 1e-7, 0.11)
    where, angle = rng.uniform(0.0, 3.0, 40), rng.uniform(0.0, 360.0, 40)
    boxes = rng.uniform(0.0, 0.2, 40), rng.uniform(0.0, 60.0, 40)
    places = Places((depth, toolface, np.full(500, 0.1)), covariance, 8, 0.15)
    found = places.nearest(list(zip(where.tolist(), angle.tolist(), strict=True)), term, 8, boxes)
    for i, rows in enumerate(found):
        along, turn = np.abs(depth - where[i]), np.abs(toolface - angle[i])
        turn = np.minimum(turn, 360.0 - turn)
        across = np.radians(turn) * 0.11
        free = np.flatnonzero((np.hypot(along, across) <= 0.15) & ~((along <= boxes[0][i]) & (turn <= boxes[1][i])))
        square = (along / term.along) ** 2 + (across / term.around) ** 2
        np.testing.assert_array_equal(rows, np.sort(free[np.argsort(square[free])[:8]]))


def test_far_neighbours_of_a_shape_that_is_short_along_the_hole_are_found_without_a_box() -> None:
    depth, toolface = np.arange(400) * 0.01, np.arange(400) * 37.0 % 360.0
    covariance = Covariance((Term(1e-6, 0.02, 0.02), Term(9e-6, 0.1, 0.4)), 1e-7, 0.11)
    (found,) = Places((depth, toolface, np.full(400, 0.1)), covariance, 4, 1.0).neighbours([(2.0, 10.0)])
    assert found.depth.size > 5


@pytest.mark.parametrize("timed", [True, False], ids=["timed", "untimed"])
def test_the_order_in_which_samples_are_given_does_not_change_what_is_found(timed: bool) -> None:
    given = four_arms(12.0)
    time, arm = np.arange(len(given)) * 0.5 if timed else None, np.arange(len(given)) % 4
    offset = 4e-4 * (arm == 2)

    def shuffled(seed: int) -> hb.Caliper:
        rows = np.random.default_rng(seed).permutation(len(given))
        times, radius = None if time is None else time[rows], (given.radius + offset)[rows]
        return hb.Caliper(given.depth[rows], given.toolface[rows] - 360.0, radius, times, arm=arm[rows])

    one, other = (hb.reconstruct(shuffled(of), bit_diameter=BIT, estimator="automatic") for of in (1, 2))
    assert one.settings == other.settings
    assert one.settings.arm_biases
    if timed:
        np.testing.assert_array_equal(one.radius, other.radius)
        np.testing.assert_array_equal(one.sigma, other.sigma)

"""The uncertainty of a wall: it covers the truth, is missing where nothing was sampled, and never fails in silence."""

from __future__ import annotations

import pickle
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden
from reference import Floats, exactly, instruction_sets

import helibore as hb
from helibore.cli.lines import sigma_lines
from helibore.wall.covariance import covariance_of, likely_covariances, other_turns
from helibore.wall.estimates import in_depth_order
from helibore.wall.uncertainty import Calibration, calibrate

BIT = 0.216
KRIGING = {"estimator": "kriging", "angular_scale": 2.0}


def truth(depth: Floats, toolface: Floats) -> Floats:
    """A breakout that comes and goes."""
    off = (toolface - 60.0 + 90.0) % 180.0 - 90.0
    return np.asarray(0.109 + 0.015 * np.exp(-((off / 25.0) ** 2)) * (1 + np.sin(2 * depth)))


def caliper(count: int = 12_000, length: float = 8.0, noise: float = 5e-4, seed: int = 1) -> hb.Caliper:
    rng = np.random.default_rng(seed)
    depth, toolface = np.sort(rng.uniform(0, length, count)), rng.uniform(0, 360, count)
    return hb.Caliper(depth, toolface, truth(depth, toolface) + rng.normal(0, noise, count))


@pytest.mark.parametrize("settings", [{}, KRIGING], ids=["inverse distance", "kriging"])
@pytest.mark.parametrize("count", [1500, 12_000])
def test_the_interval_covers_the_truth(count: int, settings: dict[str, Any]) -> None:
    wall = hb.reconstruct(caliper(count), bit_diameter=BIT, **settings)
    sigma = wall.sigma
    error = wall.radius - truth(wall.depth, wall.toolface)
    known = np.isfinite(sigma)
    assert known.mean() > 0.95
    assert 0.89 < np.mean(abs(error[known]) <= 1.96 * sigma[known]) <= 1.0
    assert sigma[known].mean() < 1.6 * np.sqrt(np.mean(error[known] ** 2))
    assert np.corrcoef(sigma[known], abs(error[known]))[0, 1] > 0.2  # larger where the error is


def test_the_interval_covers_a_rough_wall_between_samples_far_apart() -> None:
    """A roughness of 1 mm, finer than the samples are apart, looks like noise to them."""
    rng = np.random.default_rng(3)

    def rough(depth: Floats, toolface: Floats) -> Floats:
        fine = 1e-3 * np.sqrt(2.0) * np.sin(40.0 * np.radians(toolface) + 500.0 * depth)
        return np.asarray(0.109 + 4e-3 * np.cos(2.0 * np.radians(toolface)) + fine)

    depth, toolface = np.arange(0.0, 20.0, 0.12), rng.uniform(0.0, 360.0, 167)
    radius = rough(depth, toolface) + rng.normal(0.0, 5e-4, depth.size)
    wall = hb.reconstruct(hb.Caliper(depth, toolface, radius), bit_diameter=BIT, estimator="automatic")
    sigma, error = wall.sigma, wall.radius - rough(wall.depth, wall.toolface)
    known = np.isfinite(sigma)
    assert known.mean() > 0.9
    assert 0.9 < np.mean(abs(error[known]) <= 1.96 * sigma[known]) <= 1.0
    assert sigma[known].mean() < 1.6 * np.sqrt(np.mean(error[known] ** 2))


def test_more_noise_is_less_sure() -> None:
    """As much less sure as the wall is worse."""
    found = []
    for noise in (2e-4, 2e-3):
        wall = hb.reconstruct(caliper(noise=noise), bit_diameter=BIT)
        sigma, error = wall.sigma, wall.radius - truth(wall.depth, wall.toolface)
        known = np.isfinite(sigma)
        found.append((sigma[known].mean(), np.sqrt(np.mean(error[known] ** 2))))
    (quiet, small), (loud, large) = found
    assert 0.7 < quiet / small < 1.4
    assert 0.7 < loud / large < 1.4
    assert loud > 1.5 * quiet


def test_few_arms_cannot_tell_noise_from_shape() -> None:
    """Four arms: along them sigma holds with the noise of a sample in it; between them there is none."""
    rng = np.random.default_rng(4)
    depth = np.repeat(np.arange(0, 20, 0.02), 4)
    toolface = (depth * 8 + np.tile([0, 90, 180, 270], 1000)) % 360
    samples = hb.Caliper(depth, toolface, truth(depth, toolface) + rng.normal(0, 5e-4, depth.size))
    wall = hb.reconstruct(samples, bit_diameter=BIT)
    known = np.isfinite(wall.sigma)
    assert 0.05 < known.mean() < 0.3
    assert wall.sigma[known].min() > 3e-4
    assert np.mean(abs(wall.radius - truth(wall.depth, wall.toolface))[known] <= 1.96 * wall.sigma[known]) > 0.93


def test_equal_radii_of_a_quantised_tool_are_not_sure_for_that() -> None:
    """In steps of 0.1 inch most samples agree with their neighbours exactly, and are wrong by up to half a step."""
    step = 0.00254
    smooth = caliper(noise=2e-4)
    samples = hb.Caliper(smooth.depth, smooth.toolface, np.round(smooth.radius / step) * step)
    wall = hb.reconstruct(samples, bit_diameter=BIT, **KRIGING)
    sigma, error = wall.sigma, np.abs(wall.radius - truth(wall.depth, wall.toolface))
    known = np.isfinite(sigma)
    assert np.mean(error[known] <= 1.96 * sigma[known]) > 0.93
    assert sigma[known].min() > 1e-4


def by_arms(first: Sequence[float], rate: float, turn: float, seed: int = 4) -> tuple[hb.Wall, Floats]:
    """The wall by arms that start at these toolfaces and turn, in a breakout that turns, and its errors."""
    depth = np.repeat(np.arange(0.0, 20.0, 0.05), len(first))
    toolface = (np.tile(first, depth.size // len(first)) + rate * depth) % 360.0

    def shape(depth: Floats, toolface: Floats) -> Floats:
        away = (toolface - 40.0 - turn * depth + 90.0) % 180.0 - 90.0
        return np.asarray(0.109 + 0.016 * np.exp(-((away / 22.0) ** 2)) * (0.8 + 0.2 * np.sin(depth / 2.0)))

    radius = shape(depth, toolface) + np.random.default_rng(seed).normal(0.0, 5e-4, depth.size)
    wall = hb.reconstruct(hb.Caliper(depth, toolface, radius), bit_diameter=BIT, estimator="automatic")
    return wall, np.abs(wall.radius - shape(wall.depth, wall.toolface))


def test_arms_that_leave_several_turns_possible_are_not_sure() -> None:
    """Two passes of two arms see a breakout that turns by 8 degrees a metre as one that does not turn."""
    wall, error = by_arms([10.0, 190.0, 75.0, 255.0], 3.0, 8.0, seed=5)
    likely = likely_covariances(in_depth_order(wall.samples))
    assert sum(share for _, share in likely) == pytest.approx(1.0)
    assert wall.settings.other_turns == other_turns(likely)
    assert len(likely) > 1
    sigma = wall.sigma
    known = np.isfinite(sigma)
    assert known.mean() > 0.8
    assert np.mean(error[known] <= 1.96 * sigma[known]) > 0.93
    assert np.max(error) > 5e-3
    sure = hb.reconstruct(wall.samples, **vars(replace(wall.settings, other_turns=None)))
    assert np.mean(error[known] <= 1.96 * sure.sigma[known]) < 0.75
    again = hb.reconstruct(wall.samples, **vars(wall.settings))
    np.testing.assert_array_equal(again.sigma, sigma)


@pytest.mark.parametrize("turns", [(), (0.5,) * 9])
def test_other_turns_without_ten_numbers_each_are_refused(turns: tuple[float, ...]) -> None:
    with pytest.raises(hb.InputError, match=r"other_turns = .*: must have ten numbers for each turn"):
        hb.Settings(bit_diameter=BIT, other_turns=turns)


def test_a_gap_that_may_hide_a_breakout_has_none() -> None:
    """The gaps between fixed arms are wider than what the arms find that the shape is alike over."""
    wall, error = by_arms([0.0, 30.0, 65.0, 80.0, 120.0, 150.0, 160.0, 215.0, 235.0, 255.0, 310.0, 330.0], 0.0, 0.0)
    covariance = covariance_of(wall.settings.covariance or ())
    around = np.degrees(covariance.terms[1].around / covariance.radius) * (2.0 / 3.0 if covariance.half_turns else 1.0)
    assert 20.0 < around < 50.0
    sigma = wall.sigma
    known = np.isfinite(sigma)
    np.testing.assert_array_equal(known, wall._state().along_shape.angular_gap <= around)
    assert 0.3 < known.mean() < 0.9
    assert np.mean(error[known] <= 1.96 * sigma[known]) > 0.9


def with_breakouts(depth: Floats, toolface: Floats) -> Floats:
    """An oval hole with three breakouts of 0.6 to 3 m."""
    radius = 0.109 + 0.002 * np.cos(2 * np.radians(toolface - 40.0)) + 0.0 * depth
    off = (toolface - 70.0 + 90.0) % 180.0 - 90.0
    for middle, height, most in ((12.0, 1.5, 0.015), (23.0, 0.6, 0.012), (32.0, 3.0, 0.02)):
        radius += most * np.exp(-((off / 20.0) ** 2)) * (np.abs(depth - middle) < height / 2)
    return radius


def turning_arms() -> tuple[Floats, Floats, dict[str, Any]]:
    rows = np.arange(0.0, 40.0, 0.15)
    depth, arm = np.repeat(rows, 4), np.tile(np.arange(4), rows.size)
    return depth, (90.0 * arm + 3.0 * depth) % 360.0, {"arm": arm}


def fixed_arms() -> tuple[Floats, Floats, dict[str, Any]]:
    rows = np.arange(0.0, 40.0, 0.15)
    arm = np.tile(np.arange(6), rows.size)
    return np.repeat(rows, 6), 60.0 * arm + 11.0, {"arm": arm}


def rotating_tool() -> tuple[Floats, Floats, dict[str, Any]]:
    rng = np.random.default_rng(1)
    return np.sort(rng.uniform(0.0, 40.0, 3200)), rng.uniform(0.0, 360.0, 3200), {}


@pytest.mark.parametrize(("tool", "most"), [(turning_arms, 0.02), (fixed_arms, 0.02), (rotating_tool, 0.15)])
def test_the_interval_covers_a_short_breakout_of_an_oval_hole_or_is_not_stated(tool: Any, most: float) -> None:
    """The covariance of the hole is that of the oval, which is alike all along: breakouts are too few to change it."""
    depth, toolface, arms = tool()
    radius = with_breakouts(depth, toolface) + np.random.default_rng(2).normal(0.0, 4e-4, depth.size)
    wall = hb.reconstruct(hb.Caliper(depth, toolface, radius, **arms), bit_diameter=BIT, estimator="automatic")
    assert wall.settings.estimator == "near-and-far"
    sigma, real = wall.sigma, with_breakouts(wall.depth, wall.toolface)
    assert np.isnan(sigma[wall.angular_gap > wall.settings.largest_gap]).all()
    wrong, broken = np.abs(wall.radius - real) > 1.96 * sigma, real > 0.115
    assert wrong[broken].mean() <= most
    assert wrong.sum() <= 0.05 * np.isfinite(sigma).sum()


def test_samples_metres_away_tell_the_shape_of_a_hole_that_is_alike_all_along() -> None:
    depth, toolface, arms = turning_arms()
    oval = 0.109 + 0.002 * np.cos(2 * np.radians(toolface - 40.0))
    samples = hb.Caliper(depth, toolface, oval + np.random.default_rng(2).normal(0.0, 4e-4, depth.size), **arms)
    wall = hb.reconstruct(samples, bit_diameter=BIT, estimator="automatic")
    sigma = wall.sigma
    held = np.abs(wall.radius - 0.109 - 0.002 * np.cos(2 * np.radians(wall.toolface - 40.0))) <= 1.96 * sigma
    known = np.isfinite(sigma)
    assert known[wall.angular_gap > wall.settings.largest_gap].mean() > 0.9
    assert held[known].mean() > 0.93


def test_one_pass_of_two_arms_that_turn_is_known_near_them_alone() -> None:
    """A shape that changes within some metres along the hole gives the same samples as one that changes around it."""
    depth = np.repeat(np.arange(0.0, 20.0, 0.05), 2)
    toolface = (np.tile([17.0, 197.0], depth.size // 2) + 12.0 * depth) % 360.0
    oval = 0.109 + 0.004 * np.cos(2.0 * np.radians(toolface))
    walls = [
        hb.reconstruct(
            hb.Caliper(depth, toolface, oval), bit_diameter=BIT, estimator="near-and-far", max_distance=10.0,
            covariance=(0.11, 2.5e-7, 4e-8, 0.05, 0.02, 2e-5, 0.27, along),
        )
        for along in (2.6, 100.0)
    ]  # fmt: skip
    known = np.isfinite(walls[0].sigma)
    assert 0.0 < known.mean() < 0.1
    assert np.all(walls[0].angular_gap[known] <= 60.0)
    assert np.isfinite(walls[1].sigma).all()


def test_roughness_that_the_covariance_takes_for_noise_is_in_the_interval_of_dense_samples() -> None:
    def rough(depth: Floats, toolface: Floats) -> Floats:
        waves = [(6, 30.0, 0.0), (4, -24.0, 2.0), (5, 36.0, 4.0)]
        angle = np.radians(toolface)
        off = sum(np.cos(around * angle + along * depth + phase) for around, along, phase in waves)
        return np.asarray(0.11 + 4e-4 * off * np.sqrt(2 / 3))

    depth, toolface = np.arange(12_800) * (0.02 / 64), np.arange(12_800) * (360.0 / 64) % 360.0
    radius = rough(depth, toolface) + np.random.default_rng(2).normal(0, 3e-4, depth.size)
    covariance = (0.11, 3e-4**2 + 4e-4**2, 1e-8, 0.5, 5.0)
    wall = hb.reconstruct(
        hb.Caliper(depth, toolface, radius), bit_diameter=BIT, estimator="near-and-far", covariance=covariance
    )
    inside = (wall.depth > 0.2) & (wall.depth < 3.8)
    held = np.abs(wall.radius - rough(wall.depth, wall.toolface))[inside] <= 1.96 * wall.sigma[inside]
    assert 0.9 < np.mean(held) < 0.995
    smooth = rough(depth, toolface) * 0 + 0.11 + np.random.default_rng(2).normal(0, 5e-4, depth.size)
    wall = hb.reconstruct(
        hb.Caliper(depth, toolface, smooth), bit_diameter=BIT, estimator="near-and-far", covariance=covariance
    )
    assert np.median(wall.sigma) < 1e-4


def test_c1_less_c2_of_a_breakout_that_changes_along_the_hole_is_within_its_interval() -> None:
    """Three arms that turn by 12 degrees a metre; between them its depth is interpolated along the hole."""

    def breakout(depth: Floats, toolface: Floats) -> Floats:
        off = (toolface - 60.0 + 90.0) % 180.0 - 90.0
        return np.asarray(0.109 + 0.016 * np.exp(-((off / 22.0) ** 2)) * (0.8 + 0.2 * np.sin(depth / 2)))

    depth = np.repeat(np.arange(0.0, 20.0, 0.05), 3)
    toolface = (12.0 * depth + np.tile(120.0 * np.arange(3), depth.size // 3)) % 360.0
    radius = breakout(depth, toolface) + np.random.default_rng(1).normal(0, 5e-4, depth.size)
    logs = hb.reconstruct(hb.Caliper(depth, toolface, radius), bit_diameter=BIT, estimator="automatic").logs(sigma=True)
    truth = 2 * (breakout(logs.depth, np.full(logs.depth.size, 60.0)) - 0.109)
    inside = (logs.depth > 0.5) & (logs.depth < 19.5)
    held = np.abs(logs.c1 - logs.c2 - truth)[inside] <= 1.96 * logs.c1_c2_sigma[inside]
    assert np.mean(held) > 0.9


def test_missing_in_gaps_of_depth_and_turn() -> None:
    """Three metres without samples, and a quarter of the turn without samples below them."""
    full = caliper()
    gap = (full.depth > 2.5) & (full.depth < 5.5)
    side = (full.depth > 6) & (full.toolface > 200) & (full.toolface < 300)
    kept = ~gap & ~side
    wall = hb.reconstruct(
        hb.Caliper(full.depth[kept], full.toolface[kept], full.radius[kept]), bit_diameter=BIT, max_distance=None
    )
    sigma, depth, toolface = wall.sigma, wall.depth, wall.toolface
    assert np.isfinite(wall.radius).all()
    assert np.isnan(sigma[(depth > 3.3) & (depth < 4.7)]).all()
    assert np.isnan(sigma[(depth > 6.6) & (toolface > 215) & (toolface < 285)]).all()
    assert np.isfinite(sigma[depth < 2.3]).mean() > 0.95


def test_live_as_batch_and_threads() -> None:
    samples = caliper(3000)
    settings = {"bit_diameter": BIT, "start_depth": 0.0, "stop_depth": 8.0, **KRIGING, "kriging_range": 0.3}
    batch, live = hb.Wall(**settings, threads=1), hb.Wall(**settings, threads=2)
    batch.append(samples.depth, samples.toolface, samples.radius)
    for part in np.array_split(np.arange(len(samples)), 5):
        live.append(samples.depth[part], samples.toolface[part], samples.radius[part])
    np.testing.assert_array_equal(live.sigma, batch.sigma)


@pytest.mark.parametrize("settings", [{}, KRIGING], ids=["inverse distance", "kriging"])
def test_a_constant_wall_and_collinear_samples_have_a_value(settings: dict[str, Any]) -> None:
    depth = np.arange(300) * 0.01
    for toolface in (np.arange(300) * 37.0, np.zeros(300)):
        constant = hb.reconstruct(hb.Caliper(depth, toolface, np.full(300, 0.11)), bit_diameter=BIT, **settings)
        sigma = constant.sigma[constant.angular_gap <= 60]
        assert np.isfinite(sigma).mean() > 0.9 if sigma.size else True
        assert np.all(sigma[np.isfinite(sigma)] < 1e-6)
    varying = hb.Caliper(depth, np.arange(300) * 37.0, 0.11 + 1e-3 * np.sin(np.arange(300)))
    assert np.isfinite(hb.reconstruct(varying, bit_diameter=BIT, **settings).sigma).mean() > 0.9


def test_too_few_samples(golden: Golden) -> None:
    wall = hb.reconstruct(caliper(40), bit_diameter=BIT)
    with golden.raises():
        _ = wall.sigma
    together = hb.reconstruct(hb.Caliper(np.ones(200), np.zeros(200), np.full(200, 0.11)), bit_diameter=BIT)
    with golden.raises():
        _ = together.sigma


def test_the_formula_by_hand() -> None:
    calibration = Calibration(
        noise=1e-3,
        between=4e-6 / (2e-6**0.5 * 0.3**1.5),
        scatter_power=0.5,
        distance_power=1.5,
        stretch=16.0,
        quantile=2 * 1.959964,
        reach=0.39,
    )
    one = [np.array([value]) for value in (0.25, 4e-6, 0.12, 0.03)]
    expected = 2 * np.sqrt(1e-6 * 0.25 + 4e-6 * 2.0**0.5 * 2.0**1.5)
    assert calibration.sigma(tuple(one)) == pytest.approx(expected, rel=1e-12)
    assert np.isnan(replace(calibration, reach=0.38).sigma(tuple(one))).all()
    assert np.isnan(calibration.sigma((*one[:3], np.array([np.nan])))).all()


@pytest.mark.parametrize("settings", [{}, KRIGING], ids=["inverse distance", "kriging"])
def test_kept_while_estimating_or_computed_afterwards(settings: dict[str, Any]) -> None:
    """The same bits, on every instruction set, in any split, and from a wall that came out of a pickle."""
    samples = caliper(2000)
    later = hb.reconstruct(samples, bit_diameter=BIT, **settings)
    kept = hb.reconstruct(samples, bit_diameter=BIT, sigma=True, **settings)
    np.testing.assert_array_equal(kept.radius, later.radius)
    np.testing.assert_array_equal(kept.sigma, later.sigma)
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(kept)).sigma, later.sigma)
    for instruction_set in instruction_sets():
        wall = hb.Wall(instruction_set=instruction_set, threads=2, **vars(kept.settings))
        for part in np.array_split(np.random.default_rng(1).permutation(2000), 7):
            wall.append(samples.depth[part], samples.toolface[part], samples.radius[part])
        np.testing.assert_array_equal(wall.sigma, later.sigma)


def test_an_uncertainty_of_windows_is_refused() -> None:
    wall = hb.reconstruct(caliper(), bit_diameter=BIT, window=100)
    text = "window = 100: must be None for an uncertainty: samples are left out of the exact search"
    with pytest.raises(hb.InputError, match=exactly(text)):
        _ = wall.sigma


def test_calibration_finds_the_noise_of_a_dense_round_hole() -> None:
    rng = np.random.default_rng(2)
    depth, toolface = np.sort(rng.uniform(0, 5, 8000)), rng.uniform(0, 360, 8000)
    samples = hb.Caliper(depth, toolface, 0.11 + rng.normal(0, 5e-4, 8000))
    wall = hb.reconstruct(samples, bit_diameter=BIT)
    found = calibrate(in_depth_order(samples), wall.settings)
    assert 1.96 * np.nanmean(wall.sigma) == pytest.approx(1.96 * np.std(wall.radius), rel=0.4)
    assert found.noise * found.quantile / 1.96 == pytest.approx(5e-4, rel=0.35)


def test_logs_carry_the_uncertainty_of_diameters_and_volumes(tmp_path: Path, golden: Golden) -> None:
    wall = hb.reconstruct(caliper(), bit_diameter=BIT, start_depth=0.5, stop_depth=7.5)
    logs, plain = wall.logs(sigma=True), wall.logs()
    turns = wall.sigma[: len(logs) * 64].reshape(-1, 64)
    gap = wall.angular_gap[: len(logs) * 64].reshape(-1, 64).mean(axis=1)
    height, tops = wall.settings.pitch, wall.depth[::64][: len(logs)]
    inside = np.array(
        [np.count_nonzero((wall.samples.depth >= top) & (wall.samples.depth < top + height)) for top in tops]
    )
    near = inside * 30 / 360 * 0.22 / height  # samples in 30 degrees and 0.22 m; a vertex has 8 neighbours
    alike = np.sqrt(8 / np.maximum(near, 8))
    assert 0.4 < alike.min() < alike.max() <= 1
    expected = 2 * np.sqrt(np.nanmean(turns**2, axis=1) * np.maximum(gap, 30 * alike) / 360)
    expected[np.isnan(turns).mean(axis=1) > 0.1] = np.nan
    np.testing.assert_allclose(logs.diameter_sigma, expected, rtol=1e-12)
    true = truth(wall.depth, wall.toolface)[: len(logs) * 64].reshape(-1, 64)
    known = np.isfinite(logs.diameter_sigma)
    off = logs.equivalent_diameter - 2 * np.sqrt(np.mean(true**2, axis=1))
    assert np.mean(abs(off[known]) <= 1.96 * logs.diameter_sigma[known]) > 0.95
    area = np.pi / 4 * ((logs.equivalent_diameter + 1e-6) ** 2 - logs.equivalent_diameter**2)
    np.testing.assert_allclose(logs.volume_sigma, area * 0.1 / 1e-6 * logs.diameter_sigma, rtol=1e-4)
    assert {"DEQ_SIGMA", "VOL_SIGMA"} <= {one.mnemonic for one in logs.table()}
    assert "DEQ_SIGMA" not in {one.mnemonic for one in plain.table()}
    steps = logs.by_step(1.0)
    assert steps.volume_sigma.size == len(steps)
    row = int(np.flatnonzero(np.isfinite(steps.diameter_sigma))[0])
    inside = abs(logs.depth - steps.depth[row]) < 0.5
    of_turns = logs.diameter_sigma[inside]
    errors = 1 / (0.22 * alike[inside].mean()) if (logs.sampled[inside] >= 0.9).all() else 1
    assert steps.diameter_sigma[row] == pytest.approx(np.sqrt(np.mean(of_turns**2) / errors))
    sure = wall.logs(sigma=True, caliper_accuracy=1e-3)
    np.testing.assert_allclose(sure.diameter_sigma, np.hypot(logs.diameter_sigma, 2e-3))
    assert sure.by_step(1.0).diameter_sigma[row] == pytest.approx(np.hypot(steps.diameter_sigma[row], 2e-3))
    with golden.raises():
        wall.logs(caliper_accuracy=-1)
    logs.save(tmp_path / "w.csv")
    assert "VOL_SIGMA" in (tmp_path / "w.csv").read_text()


def test_a_wall_that_is_round_by_assumption_has_no_uncertainty() -> None:
    depth = np.arange(100, 110, 0.05)
    wall = hb.reconstruct(hb.Caliper.from_average(depth, 0.22 + 0.001 * np.sin(depth)), bit_diameter=BIT)
    assert len(wall.samples) > 1000
    assert np.isnan(wall.sigma).all()
    logs = wall.logs(sigma=True)
    assert np.isnan(logs.diameter_sigma).all()
    assert sigma_lines(logs) == [
        (
            "missing",
            f"{len(logs)} of {len(logs)} rows have no sigma: average caliper: size measured, shape assumed round",
        )
    ]


@pytest.mark.parametrize("setting", [{"gap_reach": 1e-8}, {"largest_gap": 1e-6}])
def test_a_tiny_limit_of_gaps_needs_no_more_memory(setting: dict[str, float]) -> None:
    """No gap of random toolfaces is that small, so sigma is missing; a table of all cells would take 50 GB."""
    wall = hb.reconstruct(caliper(2000), bit_diameter=BIT, **setting)
    np.testing.assert_array_equal(np.isnan(wall.sigma), wall.angular_gap > wall.settings.largest_gap)


def test_sigma_has_no_holes_among_random_samples() -> None:
    """Single vertices lie a little farther from the samples than left-out samples do; there, sigma still holds."""
    rng = np.random.default_rng(8)
    depth, toolface = np.sort(rng.uniform(0, 12, 6144)), rng.uniform(0, 360, 6144)
    radius = 0.108 + 0.004 * np.cos(np.radians(2 * toolface)) + rng.normal(0, 5e-4, depth.size)
    wall = hb.reconstruct(hb.Caliper(depth, toolface, radius), bit_diameter=0.2159, sigma=True)
    inside = (wall.depth > 0.2) & (wall.depth < 11.8)
    assert np.isfinite(wall.sigma[inside & wall.measured]).all()
    errors = np.abs(wall.radius - 0.108 - 0.004 * np.cos(np.radians(2 * wall.toolface)))[inside]
    assert 0.93 < np.mean(errors <= 1.96 * wall.sigma[inside]) < 0.995

"""Spikes among the samples of a tool that measures all around: which samples are, and what the choice makes of them."""

from __future__ import annotations

import numpy as np
import pytest
from reference import Floats

import helibore as hb
from helibore.wall.automatic import choose
from helibore.wall.covariance import likely_covariances
from helibore.wall.estimates import in_depth_order
from helibore.wall.near_and_far import estimate_near_and_far
from helibore.wall.spikes import find_spikes, has_spikes

BIT = 0.216
NOISE = 3e-4


def key_seat(depth: Floats, toolface: Floats) -> Floats:
    """A key seat that begins at a ledge."""
    return np.asarray(0.11 + (depth > 1.0) * (0.004 + 0.02 * np.exp(-(((toolface - 180.0) / 20.0) ** 2))))


@pytest.fixture(scope="module")
def measured() -> tuple[Floats, ...]:
    """Depth, toolface, true radius and measured radius of 32 samples a turn, and which samples are spikes."""
    rng = np.random.default_rng(3)
    depth = np.arange(3200) * (0.02 / 32)
    toolface = (np.arange(3200) * 11.25 + rng.uniform(-3, 3, 3200)) % 360.0
    radius, spike = key_seat(depth, toolface), rng.random(3200) < 0.03
    off = rng.normal(0, NOISE, 3200) + spike * rng.choice([-1, 1], 3200) * 4e-3
    return depth, toolface, radius, radius + off, spike


def test_spikes_are_found_and_ledges_and_edges_are_not(measured: tuple[Floats, ...]) -> None:
    depth, toolface, truth, radius, spike = measured
    found, beside = find_spikes((depth, toolface, radius), np.arange(depth.size))
    assert np.mean(found[spike]) > 0.8
    assert np.mean(found[~spike]) < 0.005
    assert np.median(np.abs(beside - truth)) < NOISE
    assert has_spikes((depth, toolface, radius))
    assert not has_spikes((depth, toolface, np.where(spike, truth, radius)))


def test_radii_in_steps_and_samples_at_one_place_have_no_spikes(measured: tuple[Floats, ...]) -> None:
    depth, toolface, truth, radius, spike = measured
    steps = np.round(np.where(spike, truth, radius) / 2e-3) * 2e-3
    assert not has_spikes((depth, toolface, steps))
    assert not has_spikes((np.ones(3200), np.full(3200, 10.0), radius))
    assert not has_spikes((depth[:5], toolface[:5], radius[:5]))


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_edges_of_short_breakouts_are_no_spikes_of_a_tool_with_few_samples(seed: int) -> None:
    rng = np.random.default_rng(seed)
    depth, toolface = np.sort(rng.uniform(0.0, 40.0, 3200)), rng.uniform(0.0, 360.0, 3200)
    off = (toolface - 70.0 + 90.0) % 180.0 - 90.0
    radius = 0.109 + rng.normal(0.0, 4e-4, 3200)
    for middle, height in ((12.0, 1.5), (23.0, 0.6), (32.0, 3.0)):
        radius += 0.018 * np.exp(-((off / 20.0) ** 2)) * (np.abs(depth - middle) < height / 2)
    assert not has_spikes((depth, toolface, radius))


def test_a_tool_with_spikes_gets_a_robust_wall_whose_settings_repeat_it(measured: tuple[Floats, ...]) -> None:
    depth, toolface, _, radius, _ = measured
    caliper = hb.Caliper(depth, toolface, radius)
    choice = choose(caliper, hb.Settings(bit_diameter=BIT, estimator="automatic"))
    assert (choice.settings.estimator, choice.settings.robust) == ("near-and-far", True)
    assert "spikes hardly count" in choice.sentence
    wall = hb.reconstruct(caliper, bit_diameter=BIT, estimator="automatic")
    off = wall.radius - key_seat(wall.depth, wall.toolface)
    away = np.abs(wall.depth - 1.0) > 0.1
    plain = hb.reconstruct(caliper, bit_diameter=BIT, estimator="inverse-distance")
    assert np.sqrt(np.mean(off[away] ** 2)) < 0.6 * np.sqrt(np.mean((plain.radius - wall.radius + off)[away] ** 2))
    assert np.mean(np.abs(off)[away] <= 1.96 * wall.sigma[away]) > 0.85
    assert np.median(wall.sigma) < 1.5 * NOISE
    again = hb.reconstruct(caliper, **vars(wall.settings))
    np.testing.assert_array_equal(again.radius, wall.radius)


def test_the_noise_of_the_covariance_is_that_of_samples_that_are_no_spikes(measured: tuple[Floats, ...]) -> None:
    depth, toolface, _, radius, _ = measured
    samples = in_depth_order(hb.Caliper(depth, toolface, radius))
    fitted = [likely_covariances(samples, robust=robust)[0][0].noise ** 0.5 for robust in (False, True)]
    assert fitted[0] > 2 * NOISE
    assert NOISE / 1.3 < fitted[1] < 1.3 * NOISE


def test_estimates_at_places_agree_with_a_robust_wall(measured: tuple[Floats, ...]) -> None:
    depth, toolface, truth, radius, spike = measured
    samples = in_depth_order(hb.Caliper(depth, toolface, radius))
    covariance = (0.11, NOISE**2, 1e-5, 0.05, 0.1, 3e-5, 0.1, 1.0)
    rows = np.flatnonzero((depth < 0.9) & ~spike)[::20]
    errors = [
        estimate_near_and_far(
            samples, rows, hb.Settings(bit_diameter=BIT, estimator="near-and-far", covariance=covariance, robust=robust)
        )[:, 0]
        - truth[rows]
        for robust in (False, True)
    ]
    assert np.std(errors[1]) < 0.6 * np.std(errors[0])

"""Spikes among the samples of a tool that measures all around: which samples are, and what the choice makes of them."""

from __future__ import annotations

from collections.abc import Callable

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


def short_breakouts(depth: Floats, toolface: Floats) -> Floats:
    """Three short breakouts."""
    off, worn = (toolface - 70.0 + 90.0) % 180.0 - 90.0, 0.0 * depth
    for middle, height in ((12.0, 1.5), (23.0, 0.6), (32.0, 3.0)):
        worn += 0.018 * np.exp(-((off / 20.0) ** 2)) * (np.abs(depth - middle) < height / 2)
    return worn


def pits(depth: Floats, toolface: Floats) -> Floats:
    """Forty pits of 10 cm, most of which one sample sees."""
    rng, worn = np.random.default_rng(7), 0.0 * depth
    for middle, at in rng.uniform((0.0, 0.0), (40.0, 360.0), (40, 2)):
        worn += 0.012 * ((np.abs(depth - middle) < 0.05) & (np.abs((toolface - at + 180.0) % 360.0 - 180.0) < 6.0))
    return worn


def steps(depth: Floats, toolface: Floats) -> Floats:
    """A ledge in each metre or so."""
    rng = np.random.default_rng(8)
    ledges = np.cumsum(rng.uniform(0.3, 1.5, 100))
    return np.asarray(rng.uniform(0.0, 0.015, 101)[np.searchsorted(ledges, depth)] + 0.0 * toolface)


def sharp_key_seat(depth: Floats, toolface: Floats) -> Floats:
    """A key seat of 30 mm."""
    return np.asarray(0.03 * np.exp(-(((toolface - 180.0) / 15.0) ** 2)) + 0.0 * depth)


@pytest.mark.parametrize("radius", [0.078, 0.109, 0.156])
@pytest.mark.parametrize("event", [short_breakouts, pits, steps, sharp_key_seat])
def test_what_few_samples_show_of_a_hole_is_no_spike(event: Callable[..., Floats], radius: float) -> None:
    rng = np.random.default_rng(1)
    for count in (3200, 6000):  # at random toolfaces
        at = np.sort(rng.uniform(0.0, 40.0, count)), rng.uniform(0.0, 360.0, count)
        assert not has_spikes((*at, radius + event(*at) + rng.normal(0.0, NOISE, count)))
    depth = np.arange(16000) / 400.0
    toolface = np.arange(16000) * 22.5 % 360.0
    assert not has_spikes((depth, toolface, radius + event(depth, toolface) + rng.normal(0.0, NOISE, 16000)))


@pytest.mark.parametrize("radius", [0.078, 0.156])
@pytest.mark.parametrize("in_turns", [False, True])
def test_bursts_of_bad_samples_are_spikes_in_slim_and_wide_holes(radius: float, in_turns: bool) -> None:
    rng = np.random.default_rng(2)
    depth, toolface = np.arange(6000) / 150.0, np.arange(6000) * 22.5 % 360.0
    if not in_turns:
        toolface = rng.uniform(0.0, 360.0, 6000)
    truth = radius + 0.003 * np.cos(np.radians(2.0 * toolface + 5.0 * depth))
    measured = truth + rng.normal(0.0, NOISE, 6000)
    bad = np.zeros(6000, bool)
    for first in rng.integers(0, 5994, 40):
        bad[first : first + 6] = True
    measured[bad] += rng.uniform(0.003, 0.015)
    found, _ = find_spikes((depth, toolface, measured), np.arange(6000))
    assert np.mean(found[bad]) > 0.5
    assert np.mean(found[~bad]) < 0.002
    errors = []
    for estimator in ("automatic", "inverse-distance"):
        wall = hb.reconstruct(hb.Caliper(depth, toolface, measured), bit_diameter=2.0 * radius, estimator=estimator)
        true = radius + 0.003 * np.cos(np.radians(2.0 * wall.toolface + 5.0 * wall.depth))
        errors.append(float(np.sqrt(np.mean((wall.radius - true) ** 2))))
    assert errors[0] < 0.6 * errors[1]


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

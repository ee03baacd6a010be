"""Radii in coarse steps: what they make of the mean diameter and the volume of a turn."""

from __future__ import annotations

import numpy as np
import pytest

import helibore as hb
from helibore.logs.rounding import rounding_sigma, step_of

STEP = 0.00254
NOISE = 5e-4


def test_a_step_is_found_where_all_radii_have_it_and_none_elsewhere() -> None:
    steps = np.random.default_rng(1).integers(40, 60, 500) * STEP
    assert step_of(steps) == pytest.approx(STEP)
    assert step_of(np.append(steps, 0.1)) < STEP / 10
    assert step_of(np.random.default_rng(1).normal(0.11, 1e-3, 500)) < 1e-6
    assert step_of(np.full(500, 0.11)) == 0.0


def test_a_round_turn_is_off_alike_and_steps_around_a_turn_cancel() -> None:
    settings = hb.Settings(bit_diameter=0.216, covariance=(0.11, NOISE**2 + STEP**2 / 4, 1e-6, 0.1, 0.3))
    measured = np.arange(40, 50) * STEP
    turn = np.linspace(0, 1, 64, endpoint=False)
    radius = np.array([np.full(64, 0.11), 0.11 + 2 * STEP * turn, np.where(turn < 0.5, 0.11, np.nan)])
    found = rounding_sigma(radius, measured, settings)
    mean_of_rounded = STEP / np.pi * np.exp(-2 * (np.pi * NOISE / STEP) ** 2)
    assert found == pytest.approx([mean_of_rounded / np.sqrt(2), 0.0, mean_of_rounded / np.sqrt(2)], abs=1e-9)
    assert not rounding_sigma(radius, np.random.default_rng(1).normal(0.11, 1e-3, 500), settings).max() > 1e-9
    by_chance = np.random.default_rng(2).normal(0.11, NOISE, 100_000)
    worst = max(
        abs(np.mean(np.round((by_chance + off) / STEP) * STEP - by_chance - off)) for off in np.arange(10) * STEP / 10
    )
    assert worst == pytest.approx(mean_of_rounded, rel=0.1)


def test_the_volume_interval_of_round_holes_measured_in_steps_holds_the_truth() -> None:
    held = []
    for seed in range(12):
        rng = np.random.default_rng(seed)
        depth, toolface = np.arange(1600) * (0.04 / 32), np.arange(1600) * 11.25 % 360.0
        truth = 0.108 + rng.uniform(0, STEP)
        radius = np.round((truth + rng.normal(0, NOISE, 1600)) / STEP) * STEP
        wall = hb.reconstruct(
            hb.Caliper(depth, toolface, radius), bit_diameter=0.216, estimator="inverse-distance", stop_depth=2.0
        )
        logs = wall.logs(sigma=True)
        held.append(np.abs(logs.volume - np.pi * truth**2 * logs.pitch) <= 1.96 * logs.volume_sigma)
    assert np.mean(held) > 0.9

"""The biases of arms in the uncertainty of a wall: their variance in simulated tools, and what they add."""

from __future__ import annotations

import numpy as np
import pytest
from reference import Floats

import helibore as hb
from helibore.wall.arm_biases import arm_numbers, bias_variance, square_shares
from helibore.wall.covariance import fit_covariance
from helibore.wall.estimates import in_depth_order

BIT = 0.216
COVARIANCE = (0.11, 1e-7, 4e-7, 0.05, 0.06, 9e-6, 0.1, 1.5)


def tool(bias: float, numbered: bool = True, length: float = 12.0) -> tuple[hb.Caliper, Floats]:
    """Two passes of six arms that turn in an oval hole; the arms have biases of this deviation."""
    rng = np.random.default_rng(2)
    depth = np.tile(np.arange(0.0, length, 0.05), 12)
    number = np.tile(np.repeat(np.arange(6), depth.size // 12), 2)
    toolface = number * 60.0 + np.repeat([0.0, 25.0], depth.size // 2) + 9.0 * depth
    truth = oval(toolface)
    biases = bias * np.array([1.2, -0.7, 0.3, -1.4, 1.0, -0.4])
    radius = truth + biases[number] + rng.normal(0.0, 3e-4, depth.size)
    arm = 10 + number if numbered else None
    return hb.Caliper(depth, toolface % 360.0, radius, arm=arm), biases


def oval(toolface: Floats) -> Floats:
    return np.asarray(0.112 + 0.005 * np.cos(2 * np.radians(toolface - 30.0)))


@pytest.mark.parametrize("bias", [0.0, 3e-4, 1e-3])
def test_the_variance_of_the_biases_is_found(bias: float) -> None:
    caliper, biases = tool(bias)
    samples = in_depth_order(caliper)
    arm = arm_numbers(samples, caliper)
    assert arm is not None
    np.testing.assert_array_equal(np.unique(arm), np.arange(6))
    covariance = fit_covariance(samples)
    assert covariance is not None
    found = bias_variance(samples, arm, covariance) ** 0.5
    if bias:
        assert found == pytest.approx(np.std(biases), rel=0.4)
    else:
        assert found < 1e-4


def test_the_shares_of_arms_are_those_of_the_weights() -> None:
    caliper, _ = tool(3e-4, length=3.0)
    wall = hb.reconstruct(caliper, bit_diameter=BIT, estimator="near-and-far", covariance=COVARIANCE)
    state = wall._state()
    arm = arm_numbers(state.sample_columns[:3], state.arms)
    assert arm is not None
    samples = state.sample_columns
    expected = np.zeros(len(wall))
    for each in range(6):  # the radius is linear in the samples
        raised = hb.Caliper(samples[0], samples[1], samples[2] + 1e-5 * (arm == each))
        other = hb.reconstruct(raised, bit_diameter=BIT, estimator="near-and-far", covariance=COVARIANCE)
        expected += ((other.radius - wall.radius) / 1e-5) ** 2
    np.testing.assert_allclose(square_shares(samples, arm, wall.settings, 1), expected, atol=1e-6)


def test_sigma_holds_the_truth_of_arms_with_biases() -> None:
    walls = [
        hb.reconstruct(tool(5e-4, numbered)[0], bit_diameter=BIT, estimator="automatic") for numbered in (True, False)
    ]
    np.testing.assert_array_equal(walls[0].radius, walls[1].radius)
    off = np.abs(walls[0].radius - oval(walls[0].toolface))
    with_arms, without = (np.mean(off <= 1.96 * wall.sigma) for wall in walls)
    assert with_arms > 0.9 > without


def test_arms_of_other_samples_and_one_arm_are_not_used() -> None:
    caliper, _ = tool(3e-4, length=2.0)
    samples = in_depth_order(caliper)
    assert arm_numbers(samples, None) is None
    assert caliper.arm is not None
    half = hb.Caliper(caliper.depth[::2], caliper.toolface[::2], caliper.radius[::2], arm=caliper.arm[::2])
    assert arm_numbers(samples, half) is None
    one = hb.Caliper(caliper.depth, caliper.toolface, caliper.radius, arm=np.ones(len(caliper), dtype=int))
    assert arm_numbers(samples, one) is None

"""The biases of arms: found in simulated tools, subtracted by settings, and what remains in the uncertainty."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from reference import Floats

import helibore as hb
from helibore.wall.arm_biases import arm_numbers, arm_shares, biases_of, find_biases, found_biases
from helibore.wall.automatic import choose
from helibore.wall.covariance import covariance_of

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


def of_wall(caliper: hb.Caliper) -> tuple[Floats, Floats, Floats]:
    samples = hb.reconstruct(caliper, bit_diameter=BIT, estimator="inverse-distance").samples
    return samples.depth, samples.toolface, samples.radius


def oval(toolface: Floats) -> Floats:
    return np.asarray(0.112 + 0.005 * np.cos(2 * np.radians(toolface - 30.0)))


@pytest.mark.parametrize("bias", [0.0, 1e-3, 6e-3])
def test_the_biases_are_found_as_well_as_they_say(bias: float) -> None:
    caliper, biases = tool(bias)
    settings = choose(caliper, hb.Settings(bit_diameter=BIT, estimator="automatic")).settings
    stated = np.array(settings.arm_biases or [0.0] * 16)
    np.testing.assert_array_equal(stated[:10], 0.0)
    found = stated[10:]
    assert found.mean() == pytest.approx(0.0, abs=1e-7)  # what arms share is not known
    samples = of_wall(caliper)
    arm = arm_numbers(samples, caliper)
    assert arm is not None
    np.testing.assert_array_equal(np.unique(arm), np.arange(6))
    uncertain = find_biases(samples, arm, covariance_of(settings.covariance or ())).covariance
    off = found - biases + biases.mean()
    np.testing.assert_allclose(off, 0.0, atol=1.2e-4)
    across = np.eye(6) - 1.0 / 6.0
    sigma = np.sqrt(np.diag(across @ uncertain @ across))
    assert np.all(np.abs(off) <= 4.0 * sigma)
    assert np.all(sigma < 1e-4)
    assert np.sqrt(uncertain.mean()) == pytest.approx(bias / np.sqrt(6.0), rel=0.6, abs=3e-5)  # of their mean


def test_biases_that_the_shape_may_cause_are_small() -> None:
    depth = np.repeat(np.arange(0.0, 10.0, 0.05), 4)
    arm = np.tile(np.arange(4), depth.size // 4)
    radius = 0.11 + 0.005 * np.cos(np.pi * arm) + np.random.default_rng(4).normal(0.0, 3e-4, depth.size)
    oval_hole = depth, arm * 90.0, radius  # or a round one, and biases of 5 mm
    found, uncertain, _ = find_biases(oval_hole, arm, covariance_of(COVARIANCE))
    assert np.abs(found).max() < 1e-3
    assert np.sqrt(uncertain.diagonal()).min() > 1e-4


def test_arms_that_follow_a_breakout_that_turns_have_no_biases() -> None:
    depth = np.tile(np.arange(0.0, 12.0, 0.05), 4)
    arm = np.repeat(np.arange(4), depth.size // 4)
    toolface = 70.0 + 8.0 * depth + 90.0 * arm  # two opposite arms stay in the breakout

    def truth(depth: Floats, toolface: Floats) -> Floats:
        away = (toolface - 70.0 - 8.0 * depth + 90.0) % 180.0 - 90.0
        return np.asarray(0.109 + 0.004 * np.exp(-((away / 22.0) ** 2)))

    radius = truth(depth, toolface) + np.random.default_rng(3).normal(0.0, 3e-4, depth.size)
    caliper = hb.Caliper(depth, toolface % 360.0, radius, arm=arm)
    as_bias = np.array(found_biases(caliper))  # of a shape that does not turn
    assert np.abs(as_bias).min() > 1e-3
    settings = choose(caliper, hb.Settings(bit_diameter=BIT, estimator="automatic")).settings
    assert np.abs(settings.arm_biases or 0.0).max() < 1e-4
    assert covariance_of(settings.covariance or ()).turn == pytest.approx(8.0, abs=0.5)
    walls = [hb.reconstruct(caliper, **vars(of)) for of in (settings, hb.Settings(bit_diameter=BIT))]
    found, simple = (np.sqrt(np.mean((of.radius - truth(of.depth, of.toolface)) ** 2)) for of in walls)
    assert found <= 1.05 * simple  # with biases for shape 1.27


def test_an_arm_that_is_far_off_is_found_where_passes_cross() -> None:
    rng = np.random.default_rng(7)
    depth = np.tile(np.arange(0.0, 12.0, 0.05), 6)
    number, arm = np.divmod(np.arange(depth.size) // (depth.size // 6), 2)
    first = np.array([0.0, 3.0, 50.0])[number]  # the last pass turns, two do not
    toolface = (first + 90.0 * arm + np.where(number == 2, 9.0 * depth, 0.0)) % 360.0
    radius = oval(toolface) + np.where(arm == 0, 0.0095, 0.0) + rng.normal(0.0, 3e-4, depth.size)
    wall = hb.reconstruct(hb.Caliper(depth, toolface, radius, arm=arm), bit_diameter=BIT, estimator="automatic")
    one, other = wall.settings.arm_biases or (0.0, 0.0)
    assert one - other == pytest.approx(0.0095, abs=3e-4)
    shape = wall.radius - oval(wall.toolface)
    assert np.sqrt(np.mean((shape - shape.mean()) ** 2)) < 5e-4  # what the arms share is not known
    assert np.abs(shape.mean()) == pytest.approx(0.5 * 0.0095, abs=3e-4)
    known = np.isfinite(wall.sigma)
    assert known.mean() > 0.5
    assert np.mean((np.abs(shape) <= 1.96 * wall.sigma)[known]) > 0.9  # and sigma says so


def test_rows_in_place_of_arms_add_nothing_to_sigma() -> None:
    caliper, _ = tool(3e-4, length=3.0)
    columns = caliper.depth, caliper.toolface, caliper.radius
    rows = np.arange(caliper.depth.size)
    samples = of_wall(caliper)
    assert arm_numbers(samples, hb.Caliper(*columns, arm=rows)) is None
    known = arm_numbers(samples, hb.Caliper(*columns, arm=rows % 256))
    assert known is not None
    assert known.max() == 255
    settings: dict[str, Any] = {"bit_diameter": BIT, "estimator": "near-and-far", "covariance": COVARIANCE}
    found = hb.reconstruct(hb.Caliper(*columns, arm=rows), **settings).sigma
    np.testing.assert_array_equal(found, hb.reconstruct(hb.Caliper(*columns), **settings).sigma)


def test_the_shares_of_arms_are_those_of_the_weights() -> None:
    caliper, _ = tool(3e-4, length=3.0)
    wall = hb.reconstruct(caliper, bit_diameter=BIT, estimator="near-and-far", covariance=COVARIANCE)
    state = wall._state()
    arm = arm_numbers(state.sample_columns[:3], state.arms)
    assert arm is not None
    samples = state.sample_columns
    shares = arm_shares(samples, arm, wall.settings, 1)
    for each in range(6):  # the radius is linear in the samples
        raised = hb.Caliper(samples[0], samples[1], samples[2] + 1e-5 * (arm == each))
        other = hb.reconstruct(raised, bit_diameter=BIT, estimator="near-and-far", covariance=COVARIANCE)
        np.testing.assert_allclose(shares[each], (other.radius - wall.radius) / 1e-5, atol=1e-6)


def rms(wall: hb.Wall) -> float:
    return float(np.sqrt(np.mean((wall.radius - oval(wall.toolface)) ** 2)))


@pytest.fixture(scope="module")
def wall() -> hb.Wall:
    return hb.reconstruct(tool(5e-4)[0], bit_diameter=BIT, estimator="automatic")


def test_automatic_subtracts_the_biases_and_sigma_holds_the_truth(wall: hb.Wall) -> None:
    unknown = hb.reconstruct(tool(5e-4, numbered=False)[0], bit_diameter=BIT, estimator="automatic")
    assert unknown.settings.arm_biases is None
    assert rms(wall) < 0.7 * rms(unknown)
    off = np.abs(wall.radius - oval(wall.toolface))
    assert np.mean(off <= 1.96 * wall.sigma) > 0.9


def test_a_repeat_pass_of_biased_arms_does_not_make_the_wall_worse(wall: hb.Wall) -> None:
    caliper, _ = tool(5e-4)
    assert caliper.arm is not None
    one = slice(0, len(caliper) // 2)
    first = hb.Caliper(caliper.depth[one], caliper.toolface[one], caliper.radius[one], arm=caliper.arm[one])
    assert rms(wall) <= 1.08 * rms(hb.reconstruct(first, bit_diameter=BIT, estimator="automatic"))


GIVEN = {"bit_diameter": BIT, "estimator": "near-and-far", "covariance": COVARIANCE}


def test_settings_subtract_the_biases_of_arms_in_any_split() -> None:
    caliper, biases = tool(5e-4, length=3.0)
    arm = caliper.arm
    assert arm is not None
    settings: Any = {**GIVEN, "arm_biases": (*[0.05] * 10, *biases[:4].tolist())}  # arms 14 and 15 have none
    wall = hb.reconstruct(caliper, **settings)
    radius = caliper.radius - np.array([*biases[:4], 0.0, 0.0])[arm - 10]
    plain = hb.reconstruct(hb.Caliper(caliper.depth, caliper.toolface, radius), **GIVEN)
    np.testing.assert_array_equal(wall.radius, plain.radius)
    order = np.argsort(caliper.depth, kind="stable")
    grown = hb.Wall(**settings)
    for rows in np.array_split(order, 7):
        grown.append(caliper.depth[rows], caliper.toolface[rows], caliper.radius[rows], arm=arm[rows])
    np.testing.assert_array_equal(grown.radius, wall.radius)
    # Samples without arm numbers are taken as they are: those of the wall repeat it.
    again = hb.reconstruct(wall.samples, **settings)
    np.testing.assert_array_equal(again.radius, wall.radius)
    of_samples = wall.interpolate_samples(np.arange(len(caliper)) * 1.0, caliper, on="vertices")
    other = plain.interpolate_samples(
        np.arange(len(caliper)) * 1.0, hb.Caliper(caliper.depth, caliper.toolface, radius), on="vertices"
    )
    np.testing.assert_array_equal(of_samples, other)


def test_a_stored_wall_does_not_subtract_biases_twice(wall: hb.Wall, tmp_path: Path) -> None:
    assert wall.settings.arm_biases is not None
    wall.save(tmp_path / "a.wall")
    for other in (hb.load(tmp_path / "a.wall"), pickle.loads(pickle.dumps(wall))):
        assert other.settings == wall.settings
        np.testing.assert_array_equal(other.radius, wall.radius)
        np.testing.assert_array_equal(other.sigma, wall.sigma)
    repeated = hb.reconstruct(tool(5e-4)[0], **vars(wall.settings))
    np.testing.assert_array_equal(repeated.radius, wall.radius)


def test_biases_that_are_given_are_used_and_others_are_not_sought() -> None:
    caliper, biases = tool(5e-4, length=4.0)
    given = (*[0.0] * 10, *biases.tolist())
    wall = hb.reconstruct(caliper, bit_diameter=BIT, estimator="automatic", arm_biases=given)
    assert wall.settings.arm_biases == given
    corrected = hb.Caliper(caliper.depth, caliper.toolface, caliper.radius - biases[np.asarray(caliper.arm) - 10])
    other = hb.reconstruct(corrected, bit_diameter=BIT, estimator="automatic")
    assert other.settings.covariance == wall.settings.covariance
    np.testing.assert_array_equal(other.radius, wall.radius)


def test_biases_far_below_the_noise_are_none() -> None:
    assert found_biases(tool(1e-3)[0]) is not None
    caliper, _ = tool(0.0)
    off = np.random.default_rng(5).normal(0.0, 3e-3, len(caliper))
    assert found_biases(hb.Caliper(caliper.depth, caliper.toolface, caliper.radius + off, arm=caliper.arm)) is None


@pytest.mark.parametrize("shift", [-11, 250])
def test_arms_with_other_numbers_have_no_biases(shift: int) -> None:
    caliper, _ = tool(5e-4, length=3.0)
    moved = hb.Caliper(caliper.depth, caliper.toolface, caliper.radius, arm=np.asarray(caliper.arm) + shift)
    assert found_biases(moved) is None
    assert np.all(biases_of(hb.Settings(bit_diameter=BIT, arm_biases=(1e-3,)), np.array([-1, 1, 256])) == 0.0)


@pytest.mark.parametrize("biases", [(), (0.2,), (float("nan"),), (0.0,) * 257])
def test_bad_biases_are_refused(biases: tuple[float, ...]) -> None:
    with pytest.raises(hb.InputError, match=r"arm_biases = .*: must have 1 to 256 numbers of -0\.1 to 0\.1 m"):
        hb.Settings(bit_diameter=BIT, arm_biases=biases)


def test_arms_of_other_samples_and_one_arm_are_not_used() -> None:
    caliper, _ = tool(3e-4, length=2.0)
    samples = of_wall(caliper)
    assert arm_numbers(samples, None) is None
    assert caliper.arm is not None
    half = hb.Caliper(caliper.depth[::2], caliper.toolface[::2], caliper.radius[::2], arm=caliper.arm[::2])
    assert arm_numbers(samples, half) is None
    one = hb.Caliper(caliper.depth, caliper.toolface, caliper.radius, arm=np.ones(len(caliper), dtype=int))
    assert arm_numbers(samples, one) is None


@pytest.mark.parametrize("share", [0.5, 1.0], ids=["in half of the hole", "all along"])
def test_what_only_half_of_the_hole_has_is_no_bias(share: float) -> None:
    row = np.arange(0.0, 20.0, 0.1)
    depth, arm = np.repeat(row, 6), np.tile(np.arange(6), row.size)
    toolface = (60.0 * arm + 12.0 * depth) % 360.0
    off = np.array([2e-3, -2e-3, 0.0, 0.0, 0.0, 0.0])[arm] * (depth < 20.0 * share)
    radius = 0.109 + off + np.random.default_rng(1).normal(0, 3e-4, depth.size)
    found = found_biases(hb.Caliper(depth, toolface, radius, arm=arm))
    if share < 1.0:
        assert found is None
    else:
        assert found is not None
        np.testing.assert_allclose(found[:2], [2e-3, -2e-3], atol=2e-4)


@pytest.mark.parametrize("seed", [8, 20])
def test_many_samples_of_many_arms_do_not_lose_their_biases_by_chance(seed: int) -> None:
    """Two of 24 such holes did: a half of the hole was compared with biases of the whole as if these were known."""
    rng = np.random.default_rng([seed, 31])
    row, arms, passes = np.arange(0, 20, 0.05), 12, 8
    depth, arm = np.tile(row, arms * passes), np.tile(np.repeat(np.arange(arms), row.size), passes)
    toolface = (np.repeat(rng.uniform(0, 360, passes), arms * row.size) + 30 * arm + 3 * depth) % 360
    biases = rng.normal(0, 3e-4, arms)
    away = (toolface - rng.uniform(0, 180) + 90) % 180 - 90
    shape = 0.109 + 0.016 * np.exp(-((away / 22) ** 2)) * (0.8 + 0.2 * np.sin(depth / 2))
    radius = shape + biases[arm] + rng.normal(0, 5e-4, depth.size)
    found = found_biases(hb.Caliper(depth, toolface, radius, arm=arm))
    assert found is not None
    assert np.abs(np.array(found) - (biases - biases.mean())).max() < 2e-4


def test_an_arm_that_fails_in_the_lower_half_of_the_hole_leaves_the_others_their_biases() -> None:
    rng = np.random.default_rng(5)
    row, biases = np.arange(0, 20, 0.05), np.array([4e-4, -4e-4, 3e-4, -3e-4])
    depth, arm = np.repeat(row, 4), np.tile(np.arange(4), row.size)
    toolface = (90 * arm + 12 * depth) % 360
    radius = 0.109 + 0.002 * np.cos(np.radians(2 * toolface)) + biases[arm] + rng.normal(0, 2e-4, depth.size)
    kept = (arm < 3) | (depth < 8)
    found = found_biases(hb.Caliper(depth[kept], toolface[kept], radius[kept], arm=arm[kept]))
    assert found is not None
    assert np.diff(found[:3]) == pytest.approx(np.diff(biases[:3]), abs=1.5e-4)

"""Tuning: which candidate wins on holes of known truth, what a tuning says, and bad input."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import asdict
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden
from reference import Floats, exactly

import helibore as hb
from helibore.wall.estimates import FEWEST_SAMPLES, empty_boxes, estimate_left_out, in_depth_order
from helibore.wall.tune import cross_validate
from helibore.wall.tuning import errors_and_gains

BIT = 0.216


def key_seat(depth: Floats, toolface: Floats) -> Floats:
    off = (toolface - 100.0 + 180.0) % 360.0 - 180.0
    return np.asarray(0.109 + 0.03 * np.exp(-((off / 20.0) ** 2)) + 0 * depth)


def caliper(count: int = 6000, length: float = 6.0, seed: int = 1) -> hb.Caliper:
    rng = np.random.default_rng(seed)
    depth, toolface = np.sort(rng.uniform(0, length, count)), rng.uniform(0, 360, count)
    return hb.Caliper(depth, toolface, key_seat(depth, toolface) + rng.normal(0, 5e-4, count))


def rms(wall: hb.Wall) -> float:
    return float(np.sqrt(np.mean((wall.radius - key_seat(wall.depth, wall.toolface)) ** 2)))


@pytest.fixture(scope="module")
def tuning() -> hb.Tuning:
    return hb.tune(caliper(), bit_diameter=BIT, pitch=0.05)


def test_a_key_seat_is_rebuilt_better_with_tuned_settings(tuning: hb.Tuning) -> None:
    """Its shape goes on along the hole: stretched arcs and kriging halve the error."""
    assert tuning.settings.estimator == "kriging"
    assert tuning.settings.angular_scale > 1
    assert tuning.settings.pitch == 0.05
    tuned = hb.reconstruct(caliper(), **vars(tuning.settings))
    assert rms(tuned) < 0.6 * rms(hb.reconstruct(caliper(), bit_diameter=BIT, pitch=0.05))
    assert tuning.best.box < tuning.candidates[0].box
    assert 0.2 < tuning.gain < 1.0


def test_what_a_tuning_says(tuning: hb.Tuning, golden: Golden) -> None:
    assert len(tuning.table) == len(tuning.candidates) == 21
    assert [row["candidate"] for row in tuning.table if row["chosen"]] == [tuning.best.name]
    golden(tuning.table[0]["candidate"])
    assert tuning.best.name in tuning.sentence
    assert str(tuning) == tuning.sentence
    texts = [each.text for each in ET.fromstring(tuning.svg()).iter("{http://www.w3.org/2000/svg}text")]
    assert [each.name for each in tuning.candidates] == texts[1:]


def test_noise_alone_keeps_no_candidate_that_is_worse() -> None:
    """A round hole: whatever is chosen does not rebuild it worse."""
    rng = np.random.default_rng(3)
    depth, toolface = np.sort(rng.uniform(0, 5, 3000)), rng.uniform(0, 360, 3000)
    samples = hb.Caliper(depth, toolface, 0.11 + rng.normal(0, 5e-4, 3000))
    found = hb.tune(samples, bit_diameter=BIT)
    error = [
        float(np.std(hb.reconstruct(samples, **settings).radius))
        for settings in ({"bit_diameter": BIT}, vars(found.settings))
    ]
    assert error[1] <= error[0]


def test_the_result_does_not_depend_on_threads_or_order() -> None:
    one = hb.tune(caliper(), bit_diameter=BIT, targets=300, threads=1)
    two = hb.tune(caliper(), bit_diameter=BIT, targets=300, threads=2)
    assert str(asdict(two)) == str(asdict(one))  # a NaN equals none


def test_fixed_settings_are_kept() -> None:
    found = hb.tune(caliper(), bit_diameter=BIT, targets=300, angular_scale=2.0, nugget=0.05, max_distance=0.5)
    assert len(found.candidates) == 2
    assert {each.settings.angular_scale for each in found.candidates} == {2.0}
    many = hb.tune(caliper(), bit_diameter=BIT, targets=300, neighbors=100)
    assert {(each.settings.estimator, each.settings.neighbors) for each in many.candidates} == {
        ("inverse-distance", 100)
    }, "kriging takes at most 64"
    by_distance = hb.tune(caliper(), bit_diameter=BIT, targets=300, estimator="inverse-distance")
    assert {each.settings.estimator for each in by_distance.candidates} == {"inverse-distance"}


def test_cross_validation_of_a_wall_compares_with_its_own_settings() -> None:
    wall = hb.reconstruct(caliper(), bit_diameter=BIT, angular_scale=0.5)
    found = cross_validate(wall, 300)
    assert found.candidates[0].settings == wall.settings
    assert found.best is not found.candidates[0]


def arms(radius: Any, turn: float, length: float = 60.0) -> hb.Caliper:
    """Four arms that turn once in ``turn`` metres."""
    depth = np.repeat(np.arange(0.0, length, 0.05), 4)
    toolface = (depth * 360 / turn + np.tile([0, 90, 180, 270], depth.size // 4)) % 360
    return hb.Caliper(depth, toolface, radius(depth, toolface))


def ellipse(depth: Floats, toolface: Floats) -> Floats:
    """216 x 240 mm."""
    angle = np.radians(toolface - 30) + 0 * depth
    return np.asarray(0.120 * 0.108 / np.hypot(0.108 * np.cos(angle), 0.120 * np.sin(angle)))


def test_an_ellipse_is_found_between_four_arms() -> None:
    """The shape goes on along the hole, and the likelihood says so: from 3.0 mm to 0.15."""
    found = hb.tune(arms(ellipse, 30.0), bit_diameter=BIT)
    assert found.continuation > 30
    assert found.best is found.candidates[-1]
    assert "because the shape goes on along the hole" in found.sentence
    wall = hb.reconstruct(arms(ellipse, 30.0), **vars(found.settings))
    assert np.sqrt(np.mean((wall.radius - ellipse(wall.depth, wall.toolface)) ** 2)) < 2e-4


def test_a_shape_that_changes_along_the_hole_does_not_go_on() -> None:
    def ledges(depth: Floats, toolface: Floats) -> Floats:
        return np.asarray(0.108 + 0.01 * np.sin(depth * 3) + 0.002 * np.cos(np.radians(toolface) * 3 + depth))

    found = hb.tune(arms(ledges, 30.0, 20.0), bit_diameter=BIT)
    assert found.continuation < 0
    assert found.settings.angular_scale <= 8
    fixed = hb.tune(arms(ellipse, 30.0, 20.0), bit_diameter=BIT, max_distance=0.5)
    assert fixed.settings.max_distance == 0.5
    assert np.isnan(fixed.continuation)
    assert np.isnan(hb.tune(caliper(1000), bit_diameter=BIT, targets=100).continuation)


def test_left_out_estimates_by_hand() -> None:
    """The nearest of the samples outside the box, by brute force."""
    samples = in_depth_order(caliper(400, 2.0))
    rows = np.arange(0, 400, 7)
    settings = hb.Settings(bit_diameter=BIT, neighbors=3, max_iterations=1, angular_scale=2.0)
    box = (np.full(rows.size, 0.05), np.full(rows.size, 40.0))
    found = estimate_left_out(samples, rows, settings, box)
    depth, toolface, radius = samples
    for row, estimate, nearest in zip(rows, found.radius, found.nearest, strict=True):
        turn, along = np.abs((toolface - toolface[row] + 180) % 360 - 180), np.abs(depth - depth[row])
        left = np.flatnonzero((turn > 40) | (along > 0.05))
        arc = np.radians(turn[left]) * BIT / 2
        distance = np.hypot(2 * arc, along[left])
        near = np.argsort(distance)[:3]
        assert estimate == pytest.approx(np.average(radius[left][near], weights=1 / distance[near]), abs=1e-12)
        assert nearest == pytest.approx(distance[near].min(), abs=1e-12)


def test_boxes_are_empty() -> None:
    """Around four fixed arms the boxes are as wide as the arms are apart."""
    depth = np.repeat(np.arange(200) * 0.02, 4)
    samples = (depth, np.tile([0.0, 90.0, 180.0, 270.0], 200), np.full(800, 0.11))
    height, width = empty_boxes(samples, hb.Settings(bit_diameter=BIT), 400, np.random.default_rng(1))
    assert 40 < width.max() <= 45
    assert height.max() == 1.0


BAD: list[tuple[int, dict[str, Any], str]] = [
    (37, {}, f"samples = 37: too few samples to tune: must be at least {FEWEST_SAMPLES}"),
    (
        150,
        {"max_distance": 1e-9},
        "samples: too few samples to tune: no sample has another one outside its box and within max_distance",
    ),
    (150, {"window": 30}, "window = 30: must be None to tune: samples are left out of the exact search"),
    (150, {"pitch": 0.0}, "pitch = 0: must be finite and not 0"),
]


@pytest.mark.parametrize("targets", [0, -5])
def test_at_least_one_sample_must_be_left_out(targets: int, golden: Golden) -> None:
    with golden.raises():
        hb.tune(caliper(), bit_diameter=BIT, targets=targets)


@pytest.mark.parametrize(("count", "settings", "text"), BAD, ids=[text for *_, text in BAD])
def test_bad_input(count: int, settings: dict[str, Any], text: str) -> None:
    with pytest.raises(hb.InputError, match=exactly(text)):
        hb.tune(caliper(count), bit_diameter=BIT, **settings)


def test_equal_positions_and_a_constant_wall(golden: Golden) -> None:
    """No division by the zero error of a constant wall; equal positions have no other sample to be estimated from."""
    depth = np.repeat(np.arange(60) * 0.05, 5)
    toolface = np.tile(np.arange(5) * 72.0, 60)
    constant = hb.tune(hb.Caliper(depth, toolface, np.full(300, 0.11)), bit_diameter=BIT)
    assert constant.best is constant.candidates[0]
    assert constant.gain == 0.0
    together = hb.Caliper(np.ones(200), np.zeros(200), np.full(200, 0.11))
    with golden.raises():
        hb.tune(together, bit_diameter=BIT)


def test_a_hole_whose_samples_are_sparse_in_most_places_can_be_tuned() -> None:
    """Most blocks of the hole hold one sample, and a constant and a covariance need more."""
    rng = np.random.default_rng(0)
    depth = np.sort([*rng.uniform(0, 200, 400), *np.arange(200, 1000, 9.0)])
    samples = hb.Caliper(depth, rng.uniform(0, 360, depth.size), rng.normal(0.11, 3e-3, depth.size))
    found = hb.tune(samples, bit_diameter=BIT, targets=50)
    assert np.isfinite(found.continuation)


def test_errors_count_where_coarse_steps_leave_most_of_them_at_nothing() -> None:
    errors = np.zeros(400)
    errors[::4] = 2.5e-3
    rms, gain = errors_and_gains([errors, 0.5 * errors], np.linspace(0.0, 40.0, 400))
    np.testing.assert_allclose(rms, [1.25e-3, 0.625e-3])
    assert gain[1] > 2.0

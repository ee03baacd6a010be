"""Kriging against the brute-force reference, and where neighbours are equal, collinear, few or far; the laws are in
test_laws.py.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from reference import Floats, exactly, random_hole, reference

import helibore as hb
from helibore.wall import estimates

BIT = 0.216


def kriged(columns: tuple[Floats, ...], **settings: Any) -> hb.Wall:
    return hb.reconstruct(hb.Caliper(*columns), bit_diameter=BIT, estimator="kriging", **settings)


CASES: list[dict[str, Any]] = [
    {"shape": "round", "n": 900, "length": 3.0},
    {"shape": "oval", "n": 2500, "length": 6.0, "angular_scale": 4.0, "nugget": 0.4},
    {"shape": "spiral", "n": 1500, "length": 9.0, "nugget": 0.003, "neighbors": 9},
    {"shape": "washed", "n": 2000, "length": 4.0, "kriging_range": 2.0, "neighbors": 64},
    {"shape": "washed", "n": 1500, "length": 4.0, "angular_scale": 0.5, "neighbors": 8},
    {"shape": "broken", "n": 300, "length": 40.0, "max_distance": 0.3, "neighbors": 12},
    {"shape": "broken", "n": 300, "length": 40.0, "max_distance": None, "neighbors": 1},
    {"shape": "oval", "n": 800, "length": 4.0, "window": 20, "power": 2.0},
]


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case['shape']}-{CASES.index(case)}")
def test_agrees_with_the_reference(case: dict[str, Any]) -> None:
    settings = {name: value for name, value in case.items() if name not in ("shape", "n", "length")}
    columns = random_hole(CASES.index(case), case["shape"], case["n"], case["length"])
    wall = kriged(columns, sectors=20, pitch=0.25, **settings)
    truth = reference(*columns, **vars_of(wall))
    np.testing.assert_allclose(wall.radius, truth.radius, rtol=0, atol=1e-9)
    np.testing.assert_array_equal(wall.support, truth.support)
    np.testing.assert_array_equal(wall.iterations, truth.iterations)


def vars_of(wall: hb.Wall) -> dict[str, Any]:
    apart = (
        "covariance",
        "other_turns",
        "stretches",
        "robust",
        "arm_biases",
        "direct",
        "sigma",
        "gap_reach",
        "largest_gap",
        "most_vertices",
        "first_vertex",
        "stop_vertex",
    )
    return {name: value for name, value in vars(wall.settings).items() if name not in apart}


def test_a_smooth_noisy_wall_is_nearer_the_truth_than_by_inverse_distance() -> None:
    depth, toolface, _ = random_hole(3, "round", 8000, 5.0)
    rng = np.random.default_rng(4)

    def truth(depth: Floats, toolface: Floats) -> Floats:
        return np.asarray(0.11 + 0.01 * np.cos(2 * np.radians(toolface)) * np.cos(depth))

    columns = (depth, toolface, truth(depth, toolface) + rng.normal(0, 5e-4, depth.size))
    rms = []
    for settings in ({}, {"estimator": "kriging", "nugget": 0.1}):
        wall = hb.reconstruct(hb.Caliper(*columns), bit_diameter=BIT, **settings)
        rms.append(np.sqrt(np.mean((wall.radius - truth(wall.depth, wall.toolface)) ** 2)))
    assert rms[1] < 0.7 * rms[0]


DEGENERATE = {
    "one sample": ([1.0], [0.0], [0.1]),
    "equal positions": ([1.0] * 40, [10.0] * 40, [0.1, 0.12] * 20),
    "one line along the hole": (np.linspace(0, 2, 40), [10.0] * 40, np.linspace(0.1, 0.12, 40)),
    "one turn": ([1.0] * 36, np.arange(36) * 10.0, [0.1, 0.12] * 18),
    "opposite": ([1.0] * 36, [0.0, 180.0] * 18, [0.1, 0.12] * 18),
}


@pytest.mark.parametrize("nugget", [1e-6, 0.1])
@pytest.mark.parametrize("name", DEGENERATE)
def test_degenerate_neighbourhoods_have_a_radius(name: str, nugget: float) -> None:
    """Equal and collinear positions: a radius near the samples, the constant where they are constant."""
    columns = tuple(np.asarray(of, dtype=float) for of in DEGENERATE[name])
    wall = kriged(columns, sectors=8, start_depth=0.5, stop_depth=1.5, nugget=nugget, neighbors=16)
    reached = wall.support > 0
    assert reached.any()
    half = np.ptp(columns[2]) / 2
    assert np.all(wall.radius[reached] >= columns[2].min() - half)
    assert np.all(wall.radius[reached] <= columns[2].max() + half)
    constant = kriged((*columns[:2], np.full(columns[0].size, 0.1234567)), sectors=8, nugget=nugget)
    assert np.all(constant.radius == 0.1234567)


def test_the_range_is_four_times_the_median_distance_of_the_16th_neighbour() -> None:
    depth, toolface, radius = random_hole(5, "round", 700, 5.0)
    wall = kriged((depth, toolface, radius), angular_scale=2.0)
    turn = np.radians((toolface[:, None] - toolface + 180) % 360 - 180)
    for_all = np.hypot(2.0 * 0.108 * turn, depth[:, None] - depth)
    expected = 4 * np.median(np.sort(for_all, axis=1)[:, 16])
    assert wall.settings.kriging_range == pytest.approx(expected, rel=0.02)  # radii differ a little from the bit's


def test_the_range_of_a_crowd_at_one_depth_is_found_at_a_few_places(monkeypatch: pytest.MonkeyPatch) -> None:
    count = 40_000
    found: list[int] = []
    estimate = estimates.estimate_left_out

    def counted(samples: estimates.Columns, rows: estimates.Integers, *rest: Any) -> estimates.Estimates:
        found.append(rows.size * samples[0].size)
        return estimate(samples, rows, *rest)

    monkeypatch.setattr(estimates, "estimate_left_out", counted)
    toolface = np.arange(count) * 360.0 / count
    wall = kriged((np.full(count, 5.0), toolface, np.full(count, 0.11)), start_depth=4.9, stop_depth=5.1)
    assert wall.settings.kriging_range == pytest.approx(4 * 8 * 2 * np.pi * 0.11 / count, rel=0.02)
    assert found[0] <= 5_000_000  # comparisons


def test_neighbors_follow_the_estimator() -> None:
    assert hb.Settings(bit_diameter=BIT).neighbors == 8
    assert hb.Settings(bit_diameter=BIT, estimator="kriging").neighbors == 16


BAD = [
    (
        {"estimator": "spline"},
        "estimator = 'spline': must be one of inverse-distance, kriging, near-and-far, automatic",
    ),
    ({"estimator": "kriging"}, "kriging_range: must be given where samples arrive later; reconstruct() finds it"),
    ({"estimator": "kriging", "kriging_range": 0.0}, "kriging_range = 0: must be finite and above 0"),
    ({"estimator": "kriging", "kriging_range": 1, "neighbors": 65}, "neighbors = 65: must lie in 1 to 64"),
    ({"nugget": 0.0}, "nugget = 0: must be finite and at least 1e-6"),
]


@pytest.mark.parametrize(("settings", "text"), BAD, ids=[text for _, text in BAD])
def test_bad_settings(settings: dict[str, Any], text: str) -> None:
    with pytest.raises(hb.InputError, match=exactly(text)):
        hb.Wall(bit_diameter=BIT, **settings)

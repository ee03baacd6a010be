"""Samples that a robust wall leaves out show no zones, and the interval of a key seat does not reach them."""

from __future__ import annotations

import numpy as np
import pytest

import helibore as hb
from helibore import _core
from helibore.logs.kept_samples import columns_of_kept_samples, columns_of_samples
from helibore.viewer.feed import Feed

SPIKES = 0.05


@pytest.fixture(scope="module")
def spiky() -> hb.Wall:
    """One sensor that turns, each 12 mm, in a key seat of 18 mm from 1001 to 1004 m; one of 20 samples is a spike."""
    draw, number = np.random.default_rng(9902), np.arange(1200)
    depth, toolface = 1000 + 0.012 * number, 678.0 * number % 360
    away = np.radians((toolface - 205 + 180) % 360 - 180)
    centre, pipe = 0.0862 + 0.018 - 0.0635, 0.0635
    left = pipe**2 - (centre * np.sin(away)) ** 2
    slot = np.where((left > 0) & (np.cos(away) > 0), centre * np.cos(away) + np.sqrt(np.maximum(left, 0)), 0)
    radius = np.where(abs(depth - 1002.5) < 1.5, np.maximum(0.0862, slot), 0.0862) + draw.normal(0, 5e-4, depth.size)
    radius += np.where(draw.random(depth.size) < SPIKES, draw.uniform(-0.03, 0.05, depth.size), 0)
    return hb.reconstruct(hb.Caliper(depth, toolface, radius), bit_diameter=0.17145, estimator="automatic")


def test_spikes_are_no_key_seats_and_leave_the_true_one_sure(spiky: hb.Wall) -> None:
    assert spiky.settings.robust
    (zone,) = spiky.zones().zones
    assert (zone.kind, zone.start, zone.stop) == (
        "key seat",
        pytest.approx(1001, abs=0.2),
        pytest.approx(1004, abs=0.2),
    )
    assert zone.confidence > 0.9
    feed = Feed(spiky, path=None, attributes={}, well="")
    feed.find_zones()
    (shown,) = feed.scene.state.zones
    assert shown["measure"] == pytest.approx(0.018, abs=0.003)
    assert shown["within"] < 0.005


def test_what_a_robust_wall_keeps_are_all_samples_but_those_that_stand_alone(spiky: hb.Wall) -> None:
    (*places, radius), (*kept_places, kept) = columns_of_samples(spiky), columns_of_kept_samples(spiky)
    assert all(map(np.array_equal, places, kept_places))
    left_out = np.isnan(kept)
    assert left_out.mean() == pytest.approx(SPIKES, abs=0.015)
    assert np.array_equal(kept[~left_out], radius[~left_out])
    plain = hb.reconstruct(hb.Caliper(*places, radius), bit_diameter=0.17145, estimator="inverse-distance")
    assert np.array_equal(columns_of_kept_samples(plain)[2], radius)


def slow_kept(start: float, sectors: int, first: int, wall: np.ndarray, places: np.ndarray, radius: np.ndarray) -> list:
    """The same, vertex by vertex; the helix has a pitch of 0.1 m and begins at a toolface of 30 degrees."""
    turns, found = wall.size // sectors, []
    for (depth, toolface), of in zip(places.T, radius, strict=True):
        turn = int(np.floor((depth - start) / 0.1)) - first // sectors
        sector = round((toolface - 30.0) % 360.0 * sectors / 360.0)
        beside = [
            wall[row * sectors + (sector + step) % sectors]
            for row in (turn - 1, turn, turn + 1)
            for step in (-1, 0, 1)
            if 0 <= row < turns
        ]
        known = [each for each in beside if np.isfinite(each)] if 0 <= turn < turns else []
        keeps = not known or min(known) - 2.5e-3 <= of <= max(known) + 2.5e-3
        found.append(of if keeps else np.nan)
    return found


@pytest.mark.parametrize("seed", range(6))
def test_kept_samples_lie_between_the_vertices_beside_them(seed: int) -> None:
    draw = np.random.default_rng(seed)
    sectors = int(draw.integers(3, 20))
    first, count = sectors * int(draw.integers(0, 3)), int(draw.integers(2 * sectors, 9 * sectors))
    wall = np.where(draw.random(count) < 0.2, np.nan, draw.normal(0.1, 2e-3, count))
    places = np.array([draw.uniform(4.9, 6.2, 400), draw.uniform(0.0, 360.0, 400)])
    radius = draw.normal(0.1, 6e-3, 400)
    found = _core.kept_radii((5.0, 30.0, 0.1, sectors, first), wall, *places, radius, 1e-6)
    np.testing.assert_array_equal(found, slow_kept(5.0, sectors, first, wall, places, radius))
    assert 0 < np.isnan(found).sum() < 400

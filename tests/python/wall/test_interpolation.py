"""Scattered attributes: the radius itself, carried as an attribute, must come back as the radius."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from golden_texts import Golden
from reference import random_hole
from test_wall import BIT, CASES

import helibore as hb


@pytest.mark.parametrize("window", [None, 31])
@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case['shape']}-{CASES.index(case)}")
def test_the_radius_carried_is_the_radius(case: dict[str, Any], window: int | None) -> None:
    chosen = dict(case)
    columns = random_hole(11, chosen.pop("shape"), chosen.pop("n"), chosen.pop("length"))
    wall = hb.reconstruct(hb.Caliper(*columns), bit_diameter=BIT, window=window, **chosen)
    carried = wall.interpolate_samples(wall.samples.radius, on="vertices")
    np.testing.assert_allclose(carried, wall.radius, rtol=0, atol=1e-13)


@pytest.mark.parametrize("case", ["oval", "round", "spiral"])
@pytest.mark.parametrize("chosen", [{}, {"angular_scale": 3.0, "window": 40, "neighbors": 6, "max_distance": 0.1}])
def test_by_kriging_the_radius_carried_has_the_bits_of_the_radius(case: str, chosen: dict[str, Any]) -> None:
    columns = random_hole(12, case, 900, 3.0)
    wall = hb.reconstruct(hb.Caliper(*columns), bit_diameter=BIT, sectors=16, estimator="kriging", **chosen)
    np.testing.assert_array_equal(wall.interpolate_samples(wall.samples.radius, on="vertices"), wall.radius)
    twice = wall.interpolate_samples(2 * wall.samples.radius + 5, on="vertices")
    np.testing.assert_allclose(twice, 2 * wall.radius + 5, rtol=0, atol=1e-9)


def test_by_kriging_a_missing_value_is_a_sample_that_is_not_there() -> None:
    """One neighbour without a value: the others are kriged as in a wall of fewer neighbours."""
    depth, toolface = np.linspace(0, 1, 11), np.zeros(11)
    caliper = hb.Caliper(depth, toolface, np.full(11, 0.1))
    settings: dict[str, Any] = {"bit_diameter": 0.2, "sectors": 4, "pitch": 1.0, "max_distance": None}
    kriging = settings | {"estimator": "kriging", "kriging_range": 0.5, "neighbors": 11}
    values = np.sin(depth)
    values[3] = np.nan
    found = hb.reconstruct(caliper, **kriging).interpolate_samples(values, on="vertices")
    fewer = hb.Caliper(np.delete(depth, 3), toolface[1:], np.full(10, 0.1))
    other = hb.reconstruct(fewer, **kriging | {"neighbors": 10})
    expected = other.interpolate_samples(np.delete(values, 3), on="vertices")
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)
    assert np.isnan(hb.reconstruct(caliper, **kriging).interpolate_samples(np.full(11, np.nan))).all()


def test_long_lists_ties_and_samples_on_vertices() -> None:
    rng = np.random.default_rng(3)
    depth = np.repeat(np.arange(0, 2, 0.05), 64)
    toolface = np.tile(np.arange(64) * 360 / 64, 40)
    radius = 0.1 + 0.02 * rng.random(depth.size)
    for chosen in ({"sectors": 16, "pitch": 0.1}, {"sectors": 4, "pitch": 5.0, "neighbors": 200}):
        wall = hb.reconstruct(hb.Caliper(depth, toolface, radius), bit_diameter=BIT, **chosen)
        carried = wall.interpolate_samples(wall.samples.radius, on="vertices")
        np.testing.assert_allclose(carried, wall.radius, rtol=0, atol=1e-13)


@pytest.mark.parametrize("timed", [False, True])
def test_values_come_in_the_order_of_their_caliper(timed: bool) -> None:
    """Shuffled rows, some of them twice: each value stays with its row."""
    rng = np.random.default_rng(4)
    depth, toolface, radius = (np.repeat(column, 2) for column in random_hole(5, "oval", 500, 2.0))
    order = rng.permutation(1000)
    time = np.repeat(np.arange(500.0), 2)[order] if timed else None
    caliper = hb.Caliper(depth[order], toolface[order] - 360, radius[order], time)
    wall = hb.reconstruct(caliper, bit_diameter=BIT)
    assert wall.sample_count == (500 if timed else 1000)
    carried = wall.interpolate_samples(2 * caliper.radius, caliper, on="vertices")
    np.testing.assert_allclose(carried, 2 * wall.radius, rtol=0, atol=1e-13)


def test_what_is_missing_has_no_say() -> None:
    """A vertex takes the neighbours that have a value; where none has one it has none; a quad needs four corners."""
    columns = random_hole(6, "round", 600, 3.0)
    wall = hb.reconstruct(hb.Caliper(*columns), bit_diameter=BIT, sectors=16, neighbors=4)
    middle = (columns[0].min() + columns[0].max()) / 2
    values = np.where(wall.samples.depth < middle, 7.5, np.nan)
    carried = wall.interpolate_samples(values, on="vertices")
    assert np.isnan(carried).any()
    np.testing.assert_allclose(carried[~np.isnan(carried)], 7.5, rtol=1e-15)
    quads = wall.interpolate_samples(values)
    corners = [carried[first : first + quads.size] for first in (0, 1, 17, 16)]
    np.testing.assert_array_equal(np.isnan(quads), np.isnan(corners).any(axis=0))
    wall.attributes["GR"] = quads
    surface = wall.surface()
    assert np.nanmax(surface.attributes["GR"]) == pytest.approx(7.5)


def test_errors(golden: Golden) -> None:
    columns = random_hole(7, "round", 50, 1.0)
    wall = hb.reconstruct(hb.Caliper(*columns), bit_diameter=BIT)
    with golden.raises():
        wall.interpolate_samples([1.0, 2.0, 3.0])
    with golden.raises():
        wall.interpolate_samples(np.zeros(50), on="cells")
    other = hb.Caliper(columns[0] + 1, *columns[1:])
    with golden.raises():
        wall.interpolate_samples(np.zeros(50), other)

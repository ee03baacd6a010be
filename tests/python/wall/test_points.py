"""`Wall.at` against the vertices themselves."""

from __future__ import annotations

import numpy as np

import helibore as hb


def test_at_a_vertex_a_wall_says_what_the_vertex_says() -> None:
    random = np.random.default_rng(0)
    caliper = hb.Caliper(
        np.sort(random.uniform(10, 12, 400)), random.uniform(0, 360, 400), random.normal(0.11, 1e-3, 400)
    )
    wall = hb.reconstruct(caliper, bit_diameter=0.216, sectors=16, start_toolface=33.0, max_distance=0.1)
    rows = random.integers(0, len(wall), 100)
    found = wall.at(wall.depth[rows], wall.toolface[rows])
    np.testing.assert_allclose(found.radius, wall.radius[rows], atol=1e-12)
    np.testing.assert_array_equal(found.nearest, wall.nearest[rows])
    np.testing.assert_array_equal(found.support, wall.support[rows])
    np.testing.assert_array_equal(found.gap, wall.angular_gap[rows])


def test_beyond_the_wall_there_is_nothing() -> None:
    wall = hb.reconstruct(hb.Caliper([1.0, 2.0], [0, 90], [0.1, 0.1]), bit_diameter=0.2)
    for empty in (wall.at([0.0, 9.0], [0, 0]), hb.Wall(bit_diameter=0.2).at([0.0, 9.0], [0, 0])):
        assert np.isnan(empty.radius).all()
        assert np.isnan(empty.nearest).all()
        assert (empty.support == 0).all()
        assert (empty.gap == 360).all()


def test_far_beyond_the_wall_there_is_nothing_and_no_warning() -> None:
    wall = hb.reconstruct(hb.Caliper([1.0, 2.0], [0, 90], [0.1, 0.1]), bit_diameter=0.2)
    found = wall.at([1e300, -1e300], [0, 0])
    assert np.isnan(found.nearest).all()
    assert (found.gap == 360).all()

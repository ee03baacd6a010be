"""Angular gaps against a search through all samples, vertex by vertex."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from golden_texts import Golden
from hypothesis import given, settings
from hypothesis import strategies as st

import helibore as hb
from helibore._core import angular_gaps
from helibore.samples.helix import Helix


def gaps(helix: Helix, count: int, depth: np.ndarray, toolface: np.ndarray, reach: float) -> list[float]:
    k = np.arange(count)
    found = []
    for at, angle in zip(helix.depth(k), helix.toolface(k), strict=True):
        near = toolface[(depth >= at - reach) & (depth <= at + reach)]
        clockwise, back = np.mod(near - angle, 360), np.mod(angle - near, 360)
        sides = (clockwise.min(), back.min()) if near.size else (360.0, 360.0)
        found.append(0.0 if 0.0 in sides else min(sum(sides), 360.0))
    return found


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    samples=st.sampled_from([0, 1, 2, 5, 60, 600]),
    sectors=st.sampled_from([3, 8, 64]),
    pitch=st.sampled_from([0.1, -0.1, 0.37]),
    grid=st.booleans(),
)
def test_gaps_are_those_of_a_search_through_all(
    seed: int, samples: int, sectors: int, pitch: float, grid: bool
) -> None:
    random = np.random.default_rng(seed)
    depth = np.sort(random.uniform(0, 4, samples))
    toolface = random.uniform(-720, 720, samples)
    if grid:  # some of them at the toolface of vertices
        toolface = np.round(toolface / 45) * 45
    helix = Helix(0.5 if pitch > 0 else 3.5, 0.0 if grid else 17.0, pitch, sectors)
    count = int(3 / abs(pitch) * sectors)
    found = angular_gaps(helix, count, depth, toolface, 0.3, 2)
    np.testing.assert_allclose(found, gaps(helix, count, depth, toolface, 0.3), atol=1e-9)


def test_four_arms_see_a_seventh_and_a_turning_tool_everything() -> None:
    depth = np.repeat(np.arange(0, 20, 0.05), 4)
    arms = np.tile([0, 90, 180, 270], depth.size // 4)
    slow = hb.reconstruct(hb.Caliper(depth, 12 * depth + arms, np.full(depth.size, 0.11)), bit_diameter=0.216)
    # In half a metre up and down each arm sweeps 12 of 90 degrees, but for half a spacing or so.
    assert slow.logs().coverage[10:-10].mean() == pytest.approx(12 / 90, abs=0.01)
    turning = hb.Caliper(depth, 740 * depth + arms, np.full(depth.size, 0.11))
    assert hb.reconstruct(turning, bit_diameter=0.216).logs().coverage[1:].min() == 1.0


def test_settings_say_how_far_and_how_wide(golden: Golden) -> None:
    depth = np.repeat(np.arange(0, 5, 0.05), 4)
    caliper = hb.Caliper(depth, np.tile([5, 95, 185, 275], depth.size // 4), np.full(depth.size, 0.11))
    assert hb.reconstruct(caliper, bit_diameter=0.216).logs().coverage.max() == 0.0
    assert hb.reconstruct(caliper, bit_diameter=0.216, largest_gap=90.0).logs().coverage.min() == 4 * 5 / 64
    with golden.raises():
        hb.Wall(bit_diameter=0.2, gap_reach=0)
    with golden.raises():
        hb.Wall(bit_diameter=0.2, largest_gap=400)


@pytest.mark.parametrize(("chosen", "reach"), [({}, 0.5), ({"gap_reach": 0.12}, 0.12)])
def test_every_vertex_knows_its_gap_within_the_reach(chosen: dict[str, float], reach: float) -> None:
    random = np.random.default_rng(3)
    depth, toolface = np.sort(random.uniform(10, 13, 90)), random.uniform(0, 360, 90)
    wall = hb.reconstruct(hb.Caliper(depth, toolface, np.full(90, 0.11)), bit_diameter=0.2, sectors=16, **chosen)
    helix = Helix(wall.start_depth, wall.settings.start_toolface, wall.settings.pitch, 16)
    np.testing.assert_allclose(wall.angular_gap, gaps(helix, len(wall), depth, toolface, reach), atol=1e-9)


def test_a_gap_of_60_degrees_is_the_largest_that_counts_as_measured_by_default() -> None:
    depth = np.repeat(np.arange(0, 3, 0.05), 6)
    toolface = np.tile([0, 59, 120, 179, 240, 299], depth.size // 6)  # 59 and 61 degrees apart by turns
    caliper = hb.Caliper(depth, toolface, np.full(depth.size, 0.11))
    wall = hb.reconstruct(caliper, bit_diameter=0.216, sectors=360)
    assert set(np.round(wall.angular_gap, 6).tolist()) == {0.0, 59.0, 61.0}
    # In a gap of 59 degrees the vertices from 0 to 15 and from 44 to 59 degrees are near a sample.
    np.testing.assert_allclose(wall.logs().coverage, 3 * (16 + 16) / 360, atol=1e-9)


def x_y_wall(turning: float) -> hb.Wall:
    """Four samples a row, the tool turning by so many degrees a metre: in a part of the hole it measures all around."""
    depth = np.repeat(np.arange(100, 104, 0.05), 4)
    toolface = (np.tile([0, 90, 180, 270], depth.size // 4) + turning * np.maximum(depth - 102, 0)) % 360
    radius = 0.11 + 0.003 * np.cos(np.radians(2 * toolface))
    caliper = hb.Caliper(depth, toolface, radius, arm=np.tile([0, 1, 0, 1], depth.size // 4))
    return hb.reconstruct(caliper, bit_diameter=0.2, sectors=32)


def changes(wall: hb.Wall) -> np.ndarray:
    """Return the change of the wall between each vertex and its samples: a slow reference."""
    along = np.abs(wall.samples.depth - wall.depth[:, None]) / 0.15
    around = np.abs((wall.samples.toolface - wall.toolface[:, None] + 180) % 360 - 180) / 15
    distance = np.where((along <= 2) & (around <= 2), np.hypot(along, around), np.inf)
    found = np.zeros(len(wall))
    for vertex, row in enumerate(distance):
        nearest = np.argsort(row, kind="stable")[:4]
        nearest = nearest[np.isfinite(row[nearest])]
        if nearest.size:
            off = wall.samples.radius[nearest] - wall.radius[vertex]
            mean = np.average(off, weights=1 / np.maximum(row[nearest], 0.02)) * min(1, row[nearest[0]] / 0.3) ** 2
            found[vertex] = np.hypot(mean, 0.5 * np.sqrt(np.mean(off**2)) * row[nearest[0]])
    return found


@pytest.mark.parametrize("pitch", [0.1, -0.1])
def test_where_the_wall_changes_much_between_samples_it_is_not_measured(pitch: float) -> None:
    random = np.random.default_rng(5)
    depth, toolface = np.sort(random.uniform(10, 12, 500)), random.uniform(0, 360, 500)
    lobe = 0.02 * np.maximum(1 - (np.abs((toolface - 120 + 180) % 360 - 180) / 40) ** 2, 0)
    samples = hb.Caliper(depth, toolface, 0.108 + lobe + random.normal(0, 0.0003, 500))
    wall = hb.reconstruct(samples, bit_diameter=0.216, sectors=24, pitch=pitch, start_depth=10 if pitch > 0 else 12)
    change = changes(wall)
    measured = wall.measured
    assert not measured[change > 0.0011 + 1e-9].any()
    away = np.abs((wall.toolface - 120 + 180) % 360 - 180)
    flank, round_part = (away > 20) & (away < 45), away > 60
    assert measured[round_part].mean() > 0.9 > 0.5 > measured[flank].mean()


def test_meshes_of_few_arms_say_which_quads_are_measured(tmp_path: Path) -> None:
    wall, K = x_y_wall(turning=300.0), 32
    along = np.abs(wall.samples.depth - wall.depth[:, None])
    around = np.abs((wall.samples.toolface - wall.toolface[:, None] + 180) % 360 - 180)
    near = ((along <= 0.15 + 1e-9) & (around <= 15 + 1e-9)).any(axis=1)
    measured = np.isfinite(wall.radius) & (wall.angular_gap <= 60) & near & (changes(wall) <= 0.0011)
    np.testing.assert_array_equal(wall.measured, measured)
    corners = [measured[first : measured.size - K - 1 + first] for first in (0, 1, K, K + 1)]
    expected = np.all(corners, axis=0)
    assert 0.05 < expected.mean() < 0.9
    surface, volume = wall.surface(), wall.volume(shells=[0.02, 0.05])
    np.testing.assert_array_equal(surface.attributes["measured"], expected[surface.quad_index])
    np.testing.assert_array_equal(volume.attributes["measured"], np.tile(surface.attributes["measured"], 2))
    part = wall.surface(start=102, stop=103)
    np.testing.assert_array_equal(part.attributes["measured"], expected[part.quad_index])
    wall.save(tmp_path / "w.wall")
    again = hb.load(tmp_path / "w.wall")
    for other in (again, wall._state()):
        np.testing.assert_array_equal(other.surface().attributes["measured"], surface.attributes["measured"])
    assert "measured" not in again.attributes  # it belongs to meshes, and a wall that grows has it anew


def test_an_arm_on_a_vertex_between_two_gaps_is_no_measured_quad() -> None:
    """The vertices at four arms that do not turn are measured, but none of the quads beside them."""
    wall = x_y_wall(turning=0.0)
    assert wall.measured.mean() == pytest.approx(4 / 32, abs=0.01)
    assert not wall.surface().attributes["measured"].any()


def test_a_mesh_of_samples_without_arms_has_no_such_attribute() -> None:
    caliper = hb.Caliper(np.linspace(0, 2, 200), np.arange(200) * 37.0 % 360, np.full(200, 0.11))
    wall = hb.reconstruct(caliper, bit_diameter=0.2, sectors=16)
    assert "measured" not in wall.surface().attributes

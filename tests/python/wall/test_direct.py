"""Direct connection: samples stand for vertices that are not settled yet; the laws hold (test_laws.py draws it too)."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden
from reference import Floats, bits, canonical, random_hole

import helibore as hb

BIT, SECTORS = 0.216, 16


def stand_ins(wall: hb.Wall, columns: tuple[Floats, ...]) -> Floats:
    """For each vertex the last sample, in canonical order, within half a sector and half a pitch; NaN where none is."""
    depth, toolface, radius = canonical(*columns)
    found = np.full(len(wall), np.nan)
    for k in range(wall.settled, len(wall)):
        turn = (toolface - wall.toolface[k] + 180 / SECTORS) % 360
        steps = (depth - wall.depth[k]) / wall.settings.pitch
        cell = np.flatnonzero((turn < 360 / SECTORS) & (steps >= -0.5) & (steps < 0.5))
        if cell.size:
            found[k] = radius[cell[-1]]
    return found


@pytest.mark.parametrize("pitch", [0.11, -0.11])
@pytest.mark.parametrize("timed", [False, True])
def test_samples_stand_for_unsettled_vertices(pitch: float, timed: bool) -> None:
    columns: tuple[Floats, ...] = random_hole(3, "oval", 1500, 5.0)
    if timed:
        columns = (*columns, np.random.default_rng(4).uniform(0, 9, 1500))
    settings: dict[str, Any] = {"bit_diameter": BIT, "sectors": SECTORS, "pitch": pitch}
    plain = hb.reconstruct(hb.Caliper(*columns), **settings)
    wall = hb.reconstruct(hb.Caliper(*columns), direct=True, **settings)
    truth = stand_ins(wall, columns)
    assert 0 < np.count_nonzero(~np.isnan(truth)) < len(wall) / 4
    np.testing.assert_array_equal(wall.provisional, ~np.isnan(truth))
    np.testing.assert_array_equal(wall.radius, np.where(np.isnan(truth), plain.radius, truth))
    for name in ("nearest", "support", "iterations", "settled"):
        np.testing.assert_array_equal(getattr(wall, name), getattr(plain, name))
    assert not plain.provisional.any()


def test_settled_vertices_are_interpolated_and_the_change_says_so() -> None:
    """Streamed by depth: what a vertex showed goes as soon as it is settled, within the ranges of that change."""
    depth, toolface, radius = random_hole(5, "spiral", 1200, 4.0)
    order = np.argsort(depth)
    depth, toolface, radius = depth[order], toolface[order], radius[order]
    settings: dict[str, Any] = {"bit_diameter": BIT, "sectors": SECTORS, "start_depth": float(depth[0])}
    wall, plain = hb.Wall(direct=True, **settings), hb.Wall(**settings)
    shown: Floats = np.empty(0)
    ever = 0
    for first in range(0, 1200, 50):
        part = slice(first, first + 50)
        change = wall.append(depth[part], toolface[part], radius[part])
        plain.append(depth[part], toolface[part], radius[part])
        now = wall.radius
        differs = np.ones(len(now), dtype=bool)
        differs[: len(shown)] = now[: len(shown)].view(np.int64) != shown.view(np.int64)
        reported = np.zeros(len(now), dtype=bool)
        for start, stop in change.ranges:
            reported[start:stop] = True
        assert not np.any(differs & ~reported)
        np.testing.assert_array_equal(now[: wall.settled], plain.radius[: wall.settled])
        assert not wall.provisional[: wall.settled].any()
        ever += int(wall.provisional.sum())
        shown = now
    assert ever > 100
    assert bits(wall) == bits(hb.reconstruct(hb.Caliper(depth, toolface, radius), direct=True, **settings))


def test_a_saved_wall_goes_on_being_direct(tmp_path: Any) -> None:
    wall = hb.reconstruct(hb.Caliper(*random_hole(6, "round", 400, 2.0)), bit_diameter=BIT, direct=True)
    wall.save(tmp_path / "well.wall")
    assert bits(hb.load(tmp_path / "well.wall")) == bits(wall)


def test_direct_is_a_truth_value(golden: Golden) -> None:
    with golden.raises():
        hb.Wall(bit_diameter=BIT, direct=1)


def test_ranges_of_vertices() -> None:
    """A range of vertices reads as the columns do, provisional vertices included."""
    wall = hb.Wall(bit_diameter=0.2, sectors=16, direct=True)
    wall.append(np.linspace(1.0, 4.0, 400), np.arange(400) * 37.0 % 360, 0.1 + 1e-5 * np.arange(400))
    assert 0 < wall.provisional.sum() < len(wall)
    for start, stop in ((0, None), (0, 0), (5, 6), (len(wall) - 40, len(wall)), (len(wall), len(wall))):
        part = wall.vertices(start, stop)
        assert part._fields == ("depth", "toolface", "radius", "nearest", "support", "iterations", "provisional")
        for name, column in part._asdict().items():
            whole = getattr(wall, name)
            assert column.dtype == whole.dtype
            np.testing.assert_array_equal(column, whole[start:stop])
    for start, stop in ((-1, 3), (4, 3), (0, len(wall) + 1)):
        rule = rf"range = [{start}, {stop}): must lie within the wall's {len(wall)} vertices"
        with pytest.raises(ValueError, match=re.escape(rule)):
            wall.vertices(start, stop)

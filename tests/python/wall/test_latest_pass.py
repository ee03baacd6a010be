"""The wall by the last scan of each place: reamed hole, and hole in which the tool was stuck."""

from __future__ import annotations

import numpy as np
import pytest

import helibore as hb
from helibore.wall.latest_pass import SAMPLE, latest_pass, stuck, superseded

BIT = 0.216
REAMED = (1010.0, 1011.5)


def scan(top, bottom, begins, diameter, seed):
    """Return the samples of a turning tool in a hole of 217 mm that is narrower in REAMED."""
    draw = np.random.default_rng(seed)
    depth = np.arange(top, bottom, 1 / 240)
    place = (depth > REAMED[0]) & (depth < REAMED[1])
    radius = np.where(place, diameter, 0.217) / 2 + draw.normal(0, 0.0005, depth.size)
    return depth, np.arange(depth.size) * 360 / 16.3 % 360, radius, begins + (depth - top) / 10


def drawn(*scans):
    wall = hb.Wall(bit_diameter=BIT, start_depth=1000.0, max_distance=0.5, sigma=True)
    for columns in scans:
        wall.append(*columns)
    return wall


def test_reamed_hole_has_the_size_of_the_last_scan_and_other_hole_its_bits():
    wall = drawn(
        *(scan(*ends, 100.0 * i, 0.206 + 0.004 * i, i) for i, ends in enumerate([(1000, 1020), *[(1009, 1012)] * 2]))
    )
    before, last = wall._state(), latest_pass(wall._state())
    place = (wall.depth > REAMED[0] + 0.2) & (wall.depth < REAMED[1] - 0.2)
    assert 2 * np.median(before.radius[place]) < 0.212, "the wall takes all samples"
    assert 2 * np.median(last.radius[place]) == pytest.approx(0.214, abs=0.0002)
    assert 2 * np.std(last.radius[place]) < 0.0006, "nothing of the size before is left"
    assert np.median(last.sigma[place]) < 0.5 * np.median(before.sigma[place])
    away = (wall.depth < REAMED[0] - 1.5) | (wall.depth > REAMED[1] + 1.5)
    assert np.array_equal(last.radius[away], before.radius[away])
    again = drawn(scan(1000, 1020, 0.0, 0.206, 1), scan(1009, 1012, 100.0, 0.206, 2))._state()
    assert latest_pass(again) is again, "two scans that agree are one"


@pytest.mark.parametrize("group", [1, 30], ids=["each sample has its time", "a record has one"])
def test_hole_that_is_measured_again_at_once_while_it_is_reamed_has_its_new_size(group):
    """The tool passes the place, turns 2.5 m below it, and is back after 6 seconds; above it turns 0.5 m inside."""
    down, up = scan(1000, 1014, 0.0, 0.206, 1), scan(1011, 1014, 0.0, 0.214, 2)
    times = np.arange(down[0].size + up[0].size) / 120
    up = tuple(column[::-1] for column in up[:3])
    columns = [np.concatenate(both) for both in zip(down[:3], up, strict=True)]
    last = latest_pass(drawn((*columns, times // (group / 120) * (group / 120)))._state())
    depth = last.start_depth + np.arange(last.radius.size) * last.settings.pitch / last.settings.sectors
    seen = (depth > 1011.2) & (depth < REAMED[1] - 0.2)
    assert 2 * np.median(last.radius[seen]) == pytest.approx(0.214, abs=0.0002)
    assert 2 * np.std(last.radius[seen]) < 0.0006, "nothing of the size before is left"
    before = (depth > REAMED[0] + 0.2) & (depth < 1010.8)
    assert 2 * np.median(last.radius[before]) == pytest.approx(0.206, abs=0.0002), "nobody has measured it again"


def test_a_wall_without_its_sums_has_an_uncertainty_of_as_many_vertices():
    wall = hb.Wall(bit_diameter=BIT, max_distance=0.5)
    for columns in scan(1000, 1002, 0.0, 0.206, 1), scan(1000.1, 1020, 100.0, 0.206, 2):
        wall.append(*(columns[0], columns[1], columns[2] + 0.002 * (columns[3] < 50), columns[3]))
    last = latest_pass(wall._state())
    assert last.sample_columns[0].size < wall.sample_count
    assert last.sigma.size == len(wall)


def test_what_a_pass_measured_that_the_wall_does_not_take_counts_until_the_next_pass():
    wall = drawn(scan(1000, 1020, 0.0, 0.217, 1))._state()
    reamed = np.rec.fromarrays([of[::-1] for of in scan(1009, 1012, 100.0, 0.204, 2)], dtype=SAMPLE)
    last = latest_pass(wall, apart=reamed)
    assert last.sample_columns[0].tolist() == sorted(last.sample_columns[0].tolist())
    depth = last.start_depth + np.arange(last.radius.size) * last.settings.pitch / last.settings.sectors
    inside, away = (depth > REAMED[0] + 0.2) & (depth < REAMED[1] - 0.2), abs(depth - 1010.5) > 3
    assert 2 * np.median(last.radius[inside]) == pytest.approx(0.204, abs=2e-4)
    assert np.array_equal(last.radius[away], wall.radius[away])
    again = drawn(scan(1000, 1020, 0.0, 0.217, 1), scan(1009, 1012, 200.0, 0.216, 3))._state()
    later = latest_pass(again, apart=reamed)
    assert 2 * np.median(later.radius[inside]) == pytest.approx(0.216, abs=5e-4), "reamed since"
    elsewhere = reamed.copy()
    elsewhere["depth"] += 100
    assert latest_pass(wall, apart=elsewhere) is wall


def test_a_few_samples_of_one_side_supersede_nothing():
    first, later = scan(1000, 1020, 0.0, 0.206, 1), scan(1009, 1012, 100.0, 0.214, 2)
    side = later[1] < 40
    columns = [np.concatenate(both) for both in zip(first, (column[side] for column in later), strict=True)]
    assert not superseded(*columns).any()


@pytest.mark.parametrize(("digits", "found"), [(7, True), (3, False)], ids=["stuck", "rounded"])
def test_hole_in_which_the_tool_sent_one_radius_is_not_measured(digits, found):
    depth, toolface, radius, time = scan(1000, 1020, 0.0, 0.217, 3)
    constant = (depth > 1012) & (depth < 1014)
    wall = drawn((depth, toolface, np.round(np.where(constant, 0.1085, radius), digits), time))
    last = latest_pass(wall._state(), was_stuck=True)
    inside = (wall.depth > 1012.3) & (wall.depth < 1013.7)
    assert last.sampled[inside].any() == (not found)
    assert latest_pass(wall._state()).sampled[inside].all(), "only who watches the tool knows that it was stuck"
    assert last.sampled[~((wall.depth > 1011.5) & (wall.depth < 1014.5))].mean() > 0.9


@pytest.mark.parametrize("digits", [6, 4])
@pytest.mark.parametrize("stopped", [[2], [0, 1, 2, 3]], ids=["one of four", "all"])
def test_what_a_stuck_sensor_of_several_sent_is_not_measured(stopped, digits):
    """Four sensors send together; each that is stuck has a value of its own."""
    draw = np.random.default_rng(4)
    depth = np.repeat(np.arange(1000.0, 1020.0, 0.02), 4)
    sensor = np.arange(depth.size) % 4
    toolface = (np.repeat(np.arange(depth.size // 4) * 77.3, 4) + 90 * sensor) % 360
    radius = np.round(0.1085 + draw.normal(0, 0.0005, depth.size), digits)
    held = np.isin(sensor, stopped) & (depth > 1012)
    radius[held] = (0.1071 + 0.0004 * sensor)[held]
    order = np.lexsort((toolface, depth))  # a wall has the samples of one depth in any order
    found = stuck(depth[order], toolface[order], radius[order], 50 * depth[order])
    assert found[held[order]].mean() > 0.98
    assert found[~held[order]].mean() < 0.02

"""The summary of a wall against sums made turn by turn from its radii."""

from __future__ import annotations

import math
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden

import helibore as hb
from helibore.logs.summary import summarize
from helibore.logs.zone_criteria import Criteria
from helibore.logs.zones import classify

K, BIT, PITCH = 72, 0.216, 0.1
TOOLFACE = np.arange(K) * 5.0


def wall_of(*stretches: tuple[int, np.ndarray]) -> Any:
    rows = np.concatenate([np.tile(shape, (turns, 1)) for turns, shape in stretches])
    settings = SimpleNamespace(sectors=K, pitch=PITCH, start_toolface=0.0, bit_diameter=BIT)
    return SimpleNamespace(settings=settings, start_depth=1000.0, radius=rows.ravel())


GAUGE = np.full(K, BIT / 2)
OVAL = BIT / 2 + 0.002 * np.cos(np.radians(2 * TOOLFACE))
WASHED = GAUGE + 0.02
GAP = np.where(TOOLFACE < 30, np.nan, BIT / 2)


def test_a_hole_much_smaller_than_the_bit_is_reported() -> None:
    assert summarize(wall_of((10, GAUGE - 0.006))).warnings == ()
    text = "half of the turns are at least 50 % smaller than the bit: are bit size and units right?"
    assert summarize(wall_of((10, GAUGE / 2), (4, WASHED))).warnings == (text,)


def test_a_hole_twice_as_large_as_the_bit_is_reported() -> None:
    text = "half of the turns are at least 2.0 times as large as the bit: are bit size and units right?"
    assert summarize(wall_of((10, 2 * GAUGE), (4, GAUGE))).warnings == (text,)


def test_a_wall_without_a_full_turn_is_reported() -> None:
    samples = hb.Caliper(np.full(5, 100.0), np.linspace(0.0, 300.0, 5), np.full(5, BIT / 2))
    warnings = hb.reconstruct(samples, bit_diameter=BIT, sectors=K, pitch=PITCH).summary().warnings
    assert warnings == (f"the wall has no full turn: it is 0 m long, and a turn is {PITCH:g} m",)


def test_every_number_is_that_of_the_full_turns() -> None:
    wall = wall_of((10, GAUGE), (5, WASHED), (10, OVAL), (4, GAP))
    found = summarize(wall)
    squares = [np.mean(shape**2) for shape, turns in ((GAUGE, 10), (WASHED, 5), (OVAL, 10)) for _ in range(turns)]
    mean = 2 * math.sqrt(sum(squares) / 25)
    assert found.mean_diameter == pytest.approx(mean, rel=1e-12)
    assert found.volume == pytest.approx(math.pi / 4 * mean**2 * 2.5, rel=1e-12)
    assert found.excess == pytest.approx(mean**2 / BIT**2 - 1, rel=1e-12)
    assert (found.whole_turns, found.incomplete_turns) == pytest.approx((2.5, 0.4))
    assert found.least_diameter.value == pytest.approx(BIT - 0.004)
    assert found.greatest_diameter.value == pytest.approx(BIT + 0.04)
    assert 1001.0 < found.greatest_diameter.depth < 1001.5
    assert 1001.5 < found.inscribed_diameter.depth < 1002.5
    assert found.ovality[1] == pytest.approx(0.004 / BIT)
    assert found.washed_out == pytest.approx(0.5)
    assert dict(found.kinds) == {"washout": pytest.approx(0.5)}
    assert found.without_radius == pytest.approx(4 * 6 / (29 * K))
    assert (found.start, found.stop) == (1000.0, pytest.approx(1000 + (29 * K - 1) * PITCH / K))


def test_volume_and_mean_diameter_are_of_the_same_metres_of_hole() -> None:
    wall = wall_of((10, GAUGE), (5, WASHED), (10, OVAL), (10, GAUGE), (1, GAP))
    cuts = [1000.0, *(1000.0 + 0.3048 * np.arange(1, 11)), 1003.4]  # feet, where a turn is 0.1 m
    rows = [summarize(wall, start, stop) for start, stop in pairwise(cuts)]
    for row in rows:
        assert row.whole_turns == pytest.approx(row.stop - row.start)
        assert row.volume == pytest.approx(math.pi / 4 * row.mean_diameter**2 * (row.stop - row.start), rel=1e-9)
    assert sum(row.volume for row in rows) == pytest.approx(summarize(wall, 1000.0, 1003.4).volume)
    assert sum(row.washed_out for row in rows) == pytest.approx(0.5)
    upwards = wall_of((30, GAUGE))
    upwards.settings.pitch = -PITCH
    assert summarize(upwards, 997.111, 998.222).whole_turns == pytest.approx(1.111)
    assert summarize(upwards).whole_turns == pytest.approx(3.0)


def test_an_interval_counts_the_metres_that_lie_in_it() -> None:
    wall = wall_of((10, GAUGE), (5, WASHED), (10, GAUGE))
    found = summarize(wall, 1001.2, 1002.0)
    assert found.washed_out == pytest.approx(0.3)
    assert found.whole_turns == pytest.approx(0.8)
    assert (found.start, found.stop) == (1001.2, 1002.0)


def test_an_interval_that_ends_above_its_start_is_refused(golden: Golden) -> None:
    with golden.raises():
        summarize(wall_of((10, GAUGE)), 1001.0, 1000.0)


@pytest.mark.parametrize("end", [math.inf, -math.inf, math.nan])
def test_an_end_that_is_not_finite_is_refused_by_name(end: float) -> None:
    for wall in (wall_of((10, GAUGE)), hb.Wall(bit_diameter=BIT)):
        with pytest.raises(hb.InputError, match=rf"^start = {end}: must be finite$"):
            summarize(wall, start=end)
        with pytest.raises(hb.InputError, match=rf"^stop = {end}: must be finite$"):
            summarize(wall, stop=end)


def test_an_interval_within_a_turn_has_the_coverage_of_the_turn() -> None:
    wall = wall_of((10, GAUGE), (4, GAP), (10, GAUGE))
    assert summarize(wall, 1000.51, 1000.53).coverage == 1.0
    assert summarize(wall, 1001.22, 1001.24).coverage == pytest.approx(66 / 72)  # 6 of 72 sectors are missing
    assert summarize(wall, 1000.93, 1001.05).coverage == pytest.approx((7 + 5 * 66 / 72) / 12)
    assert math.isnan(summarize(wall, 1500.0, 1501.0).coverage)


def test_washed_out_is_what_zones_call_washout() -> None:
    wall = wall_of((10, GAUGE), (5, WASHED), (10, OVAL), (4, GAP))
    found = classify(wall)
    np.testing.assert_array_equal(found.logs.c2 - BIT >= Criteria().washout, found.kind == 1)


def test_a_wall_without_a_full_turn_has_no_numbers() -> None:
    found = hb.Wall(bit_diameter=BIT).summary()
    assert found.vertices == found.samples == 0
    assert found.whole_turns == found.volume == found.washed_out == 0
    for number in (found.mean_diameter, found.excess, found.least_diameter.value, found.without_radius, found.start):
        assert math.isnan(number)


@pytest.mark.parametrize("pitch", [0.1, -0.1])
def test_the_samples_of_a_whole_wall_are_those_that_it_was_made_of(pitch: float) -> None:
    """The last row lies behind the last vertex, by less than a vertex's height."""
    depth = np.repeat(np.append(1000 + 0.0125 * np.arange(100), 1001.257), 4)
    caliper = hb.Caliper(depth, np.tile([0.0, 90, 180, 270], 101), np.full(depth.size, 0.11))
    wall = hb.reconstruct(caliper, bit_diameter=BIT, sectors=12, pitch=pitch)
    assert np.ptp(wall.depth) < np.ptp(depth)
    assert wall.summary().samples == wall.sample_count == len(caliper)
    assert wall.summary(stop=1000.5).samples == 4 * 41


def test_a_gauge_hole_is_not_called_washed_out_or_sound() -> None:
    caliper = hb.Caliper.gauge(100, 101, BIT)
    found = hb.reconstruct(caliper, bit_diameter=BIT).summary()
    assert found.basis == "gauge"
    assert math.isnan(found.washed_out)
    assert found.samples == len(caliper)
    assert found.nearest_half <= found.nearest_most


def test_washed_out_is_not_known_where_samples_see_little_of_most_turns() -> None:
    depth = np.arange(1000.0, 1020.0, 0.1)
    wall = hb.reconstruct(hb.Caliper(depth, depth * 4 % 360, np.full(depth.size, 0.14)), bit_diameter=0.216)
    found = wall.summary()
    assert found.whole_turns > 19
    assert found.coverage < 0.3
    assert math.isnan(found.washed_out)
    assert "washed out" not in found.numbers()

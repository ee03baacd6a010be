"""The viewer's memory of when the wall was how long."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

import helibore as hb
from helibore.viewer.feed import history_of
from helibore.viewer.scene import MOST_POINTS, History


def test_growth_is_kept_and_nothing_else() -> None:
    history = History()
    history.note(100.0, 500, math.nan)
    history.note(102.0, 500, 10.0)
    history.note(103.5, 600, 12.5)
    history.note(103.0, 700, 12.6)
    assert history.as_columns() == {"time": [100.0, 103.5], "vertices": [500, 600], "bit_depth": [None, 12.5]}


def test_points_are_a_second_apart_and_the_last_is_now() -> None:
    history = History()
    for i in range(101):
        history.note(i / 10, i + 1, 1.0)
    columns = history.as_columns()
    assert columns["time"][-1] == 10.0
    assert 10 <= len(columns["time"]) <= 13
    assert all(b - a > 0.89 for a, b in itertools.pairwise(columns["time"][:-1]))


def test_a_month_is_still_few_points_from_its_start_to_its_end() -> None:
    history = History()
    for i in range(0, 30 * 86400, 20):
        history.note(float(i), i + 1, 1.0)
    times = history.as_columns()["time"]
    assert len(times) <= MOST_POINTS + 1
    assert (times[0], times[-1]) == (0.0, 30 * 86400 - 20.0)
    assert max(b - a for a, b in itertools.pairwise(times)) < 3000


def drilled(start: float, back: float = 0.0) -> hb.Wall:
    """Return ten metres drilled in 1,000 s; the last 2 s lie ``back`` metres above."""
    time = np.arange(0.0, 1000.0, 0.2)
    depth = 2000.0 + time / 100 - np.where(time > 998, back, 0.0)
    caliper = hb.Caliper(depth, time * 400 % 360, 0.108 + 0 * depth, start + time)
    return hb.reconstruct(caliper, bit_diameter=0.216)


def test_a_saved_wall_was_as_long_as_its_samples_reached() -> None:
    wall = drilled(1.7e9)
    history = history_of(wall)
    assert history is not None
    columns = history.as_columns()
    assert (columns["time"][0], columns["time"][-1]) == (1.7e9, pytest.approx(1.7e9 + 1000, abs=1))
    assert columns["vertices"][-1] == pytest.approx(len(wall), abs=2)
    at = int(np.searchsorted(columns["time"], 1.7e9 + 500))
    assert wall.depth[columns["vertices"][at]] == pytest.approx(2005.0, abs=0.1)
    assert columns["bit_depth"][at] == pytest.approx(2005.0, abs=0.1)


@pytest.mark.parametrize("wall", [drilled(0.0), drilled(1.7e9, back=5.0)], ids=["no date", "a later pass"])
def test_a_wall_whose_past_is_not_known_has_no_past(wall: hb.Wall) -> None:
    assert history_of(wall) is None

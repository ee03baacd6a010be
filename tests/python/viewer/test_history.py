"""The viewer's memory of when the wall was how long."""

from __future__ import annotations

import itertools
import math

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

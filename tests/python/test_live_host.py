"""The host API: what is polled, and what a host's own mistakes cost. Its C++ twin is compared in test_cpp.py."""

from __future__ import annotations

import threading

import live_pushes
import numpy as np
import pytest

import helibore as hb
from helibore import Live
from helibore.live.configuration import parse


def test_a_poll_tells_everything_since_the_last():
    """One thread pushes, another polls and keeps a copy by what the polls tell: in the end it is the wall."""
    live = Live(parse(live_pushes.CONFIGURATION))
    found = live_pushes.pushes()
    pushing = threading.Thread(target=lambda: [push.call(live) for push in found])
    pushing.start()
    copy, accepted, rows, events = np.empty(0), 0, 0, []
    while True:
        over = not pushing.is_alive()
        news = live.poll()
        events += news.events
        rows = news.images.get("GR", (0, rows))[1]
        if "main" in news.changes:
            accepted += news.changes["main"].accepted
            radius = live.wall.radius
            copy = np.concatenate([copy, np.full(len(radius) - len(copy), np.nan)])
            for start, stop in news.changes["main"].ranges:
                copy[start:stop] = radius[start:stop]
        if over:
            break
    pushing.join()
    assert np.array_equal(copy, live.wall.radius, equal_nan=True)
    assert accepted == live.wall.sample_count == 900
    assert rows == len(live.images["GR"])
    stations = [event.text for event in events if event.rule == "station"]
    assert stations == ["station at 60 m: inclination[2] = 190: must lie in 0 to 180 degrees"]
    assert live.poll() == hb.live.model.Update()


def test_a_depth_that_is_no_number_costs_only_itself():
    live = Live(parse(live_pushes.CONFIGURATION))
    with pytest.raises(ValueError, match=r"^depth\[1\] = nan: must be finite$"):
        live.append_image("GR", [1.0, np.nan], np.ones((2, 4)))
    update = live.append_stations([np.nan, 0.0, 130.0], [1.0, 0.0, 5.0], [0.0, 0.0, 90.0])
    assert [event.text for event in update.events] == ["station at nan m: depth must be finite"]
    assert live.path is not None
    assert live.images == {}

"""One well of many: what the catalogue says of it."""

from __future__ import annotations

import numpy as np

import helibore as hb
from helibore.logs.turn_logs import NO_UNCERTAINTY
from helibore.runs.run_settings import RunSettings
from helibore.runs.well import catalogue_row


def test_the_catalogue_says_that_a_tool_with_few_arms_measured() -> None:
    depth = np.repeat(np.arange(1000, 1003, 0.05), 4)
    arm = np.tile([0, 1, 0, 1], depth.size // 4)
    toolface = np.tile([0.0, 90.0, 180.0, 270.0], depth.size // 4)
    caliper = hb.Caliper(depth, toolface, np.full(depth.size, 0.11), arm=arm)
    wall = hb.reconstruct(caliper, bit_diameter=0.2, sectors=64)
    row = catalogue_row("W", RunSettings(gauge=True, wall=wall.settings), wall, wall.logs(), wall.summary())
    assert row["warnings"] == (  # the vertices at the four arms: 4 of 64
        "a tool with few arms measured 6 % of the turns; the wall between its arms is interpolated, and C1, C2, "
        f"ovality and zones are the arms'; {NO_UNCERTAINTY}"
    )

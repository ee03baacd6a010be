"""A host pushes bit depth, hole depth and rotation as values; samples of other sources get their depth from them."""

from __future__ import annotations

import numpy as np
import pytest
from live_wires import WALL, Clock, same_bits

from helibore import Live
from helibore.live.rules.configuration import parse
from helibore.live.server import Server
from helibore.live.wire import wits

VALUES = (
    WALL + '[source.rig]\naddress = "values"\nunits = "metric"\n'
    'items = { bit_depth = "bit", hole_depth = "hole", rotation = "rpm" }\nshow.WOB = { name = "wob", unit = "kN" }\n'
)
FROM_BIT = VALUES + (
    '[source.mwd]\naddress = "host"\nunits = "metric"\n'
    'caliper = { toolface = ["5010"], radius = ["5012"], offset = 2.0 }\n'
)
BY_WITS = FROM_BIT.replace(VALUES[len(WALL) :], '[source.rig]\naddress = "host"\nunits = "metric"\n'
                           'items = { bit_depth = "0108", hole_depth = "0110", rotation = "0120" }\n')  # fmt: skip


def drilled(live: Live, clock: Clock, push) -> Live:
    """Drill 3 m; ``push`` gives bit depth, hole depth and rotation; the tool 2 m above the bit sends a sample."""
    for step in range(150):
        clock.step(5)
        depth = round(102 + 0.02 * step, 2)
        push(live, depth, depth, 100.0)
        sample = [(5010, f"{step * 37 % 360}"), (5012, f"{108 + step % 5}")]
        live.receive("mwd", wits.frame(sample))
    clock.step(5)
    push(live, depth, depth, 100.0)
    return live


def by_wits(live: Live, bit: float, hole: float, rpm: float) -> None:
    live.receive("rig", wits.frame([(108, f"{bit}"), (110, f"{hole}"), (120, f"{rpm}")]))


def by_values(live: Live, bit: float, hole: float, rpm: float) -> None:
    live.append_values("rig", {"bit": bit, "hole": hole, "rpm": rpm, "wob": 50.0})


def test_pushed_depths_give_the_wall_that_sent_ones_give(tmp_path):
    clock, other = Clock(), Clock()
    with Live(parse(FROM_BIT), tmp_path, clock=clock) as live:
        drilled(live, clock, by_values)
    expected = drilled(Live(parse(BY_WITS), clock=other), other, by_wits)
    assert live.model.counts["drawn"] == expected.model.counts["drawn"] == 150
    assert same_bits(live.wall, expected.wall)
    assert same_bits(Live.replay(tmp_path).wall, live.wall)
    assert [one.name for one in live.passes] == [one.name for one in expected.passes] == ["drill"]
    assert live.model.channels.by_name["WOB"].value == 50.0


def test_many_values_at_once_are_rows_in_order_and_nan_is_missing():
    live = Live(parse(VALUES))
    live.append_values("rig", {"bit": np.linspace(100, 110, 20_001), "rpm": np.full(20_001, np.nan)})
    bit = live.model.rig.tracks["bit_depth"].value
    assert len(bit) == 20_001
    assert (np.diff(bit) > 0).all()
    assert len(live.model.rig.tracks["rotation"].value) == 0
    assert live.model.readers[1].lacking() == ""


@pytest.mark.parametrize(
    ("source", "values", "rule"),
    [
        ("mwd", {"bit": 1.0}, "source 'mwd': append_values needs address"),
        ("none", {"bit": 1.0}, "source 'none': is not in the configuration"),
        ("rig", {"bit": [1.0, 2.0], "hole": [1.0]}, "hole has 1 values, bit has 2"),
        ("rig", {"bit": float("inf")}, "bit: must be finite, or NaN"),
    ],
)
def test_wrong_values_are_refused_and_nothing_is_stored(source, values, rule):
    live = Live(parse(FROM_BIT))
    with pytest.raises(ValueError, match=rule):
        live.append_values(source, values)
    assert live.model.records == 0


def test_a_jump_of_a_pushed_depth_is_held_like_one_that_was_sent():
    live = Live(parse(VALUES))
    for bit in (100.0, 100.1, 900.0, 100.2):
        live.append_values("rig", {"bit": bit})
    assert live.model.rig.tracks["bit_depth"].value.tolist() == [100.0, 100.1, 100.2]


def test_a_server_opens_nothing_for_values(tmp_path):
    with Live(parse(VALUES), tmp_path) as live:
        server = Server(live)
        server.start()
        try:
            assert server.openers == {}
            live.append_values("rig", {"bit": 101.0})
        finally:
            server.stop()
    assert live.model.records == 1


def test_bytes_that_are_not_of_append_values_are_said():
    live = Live(parse(VALUES))
    update = live.receive("rig", b"&&\n0108100\n!!\n")
    assert {event.rule for event in update.events} == {"stray_text"}

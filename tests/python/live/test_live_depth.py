"""Where a sensor was, which pass it was on, and what is never guessed."""

from __future__ import annotations

import numpy as np
import pytest
from live_wires import (
    FRAMES,
    FROM_BIT,
    SECOND,
    SENT,
    Clock,
    from_bit,
    rig,
    same_bits,
    sample,
)

from helibore import Live
from helibore.live import live as live_module
from helibore.live.model.depth_jumps import HeldSample
from helibore.live.model.events import Flag
from helibore.live.model.sample_rows import ROW
from helibore.live.rules.configuration import parse
from helibore.live.rules.depth_limits import DepthLimits
from helibore.live.wire import wits


def test_depth_is_the_bit_depth_when_it_was_measured_less_the_offset():
    clock = Clock()
    live = from_bit(latency=7.0, clock=clock)
    draw = np.random.default_rng(5)
    measured, expected, times, bits = [], [], [], []
    bit = 120.0
    for _ in range(200):
        clock.step(float(draw.uniform(0.1, 3)))
        if draw.random() < 0.5:
            bit += float(draw.uniform(0, 0.2))
            rig(live, bit)
            times.append(clock.monotonic)
            bits.append(float(f"{bit:.3f}"))
        else:
            sample(live, toolface=float(len(measured)))
            measured.append(clock.monotonic - 7 * SECOND)
    for time in measured:
        if time >= times[0] and time < times[-1]:
            expected.append(float(np.interp(time, times, bits)) - 10.0)
    found = live.wall.samples.depth
    assert len(expected) > 50
    np.testing.assert_allclose(np.sort(found), np.sort(expected), rtol=0, atol=1e-9)
    assert live.model.waiting + len(expected) + live.model.counts["flag NO_DEPTH"] == len(measured)


def test_depth_from_the_bit_replays_with_the_same_bits(tmp_path, monkeypatch):
    clock = Clock()
    draw = np.random.default_rng(6)
    with Live(parse(FROM_BIT.replace("LATENCY", "2.5")), tmp_path, clock=clock) as live:
        for i in range(400):
            clock.step(float(draw.choice([0.0, 0.3, 1.0])))
            if i % 3 == 0:
                rig(live, 120 + 0.01 * i - (3 if 200 < i < 260 else 0), 120 + 0.01 * min(i, 200), draw.choice([0, 60]))
            else:
                sample(live, float(draw.uniform(0, 360)))
    for records in (1, 5, 8192):
        monkeypatch.setattr(live_module, "WINDOW_RECORDS", records)
        again = Live.replay(tmp_path)
        assert same_bits(again.wall, live.wall)
        assert again.model.counts == live.model.counts
    assert live.model.counts["flag NOT_ROTATING"] > 10
    assert live.model.counts["flag OFF_BOTTOM"] > 10


@pytest.mark.parametrize(
    ("bit", "hole", "rpm", "activity", "drawn", "flags"),
    [
        (150, 150, 60, None, True, ()),
        (150, 150, 60, 2, True, ()),
        (148, 150, 60, None, True, ("OFF_BOTTOM",)),  # a re-scan
        (148, 150, 60, 2, True, ("OFF_BOTTOM",)),
        (148, 150, 60, 4, False, ("OFF_BOTTOM",)),  # reaming: a layer of its own
        (148, 150, 60, 8, False, ("OFF_BOTTOM",)),  # tripping
        (148, 150, 0, None, False, ("OFF_BOTTOM", "NOT_ROTATING")),
        (150, 150, 0, None, False, ("NOT_ROTATING",)),  # sliding
    ],
)
def test_passes_and_flags(bit, hole, rpm, activity, drawn, flags):
    live = from_bit()
    rig(live, bit, hole, rpm, activity)
    sample(live)
    assert live.wall.sample_count == drawn
    reported = {name.removeprefix("flag ") for name, count in live.model.counts.items() if count and "flag" in name}
    assert reported == set(flags)


def test_layers_keep_passes_apart():
    live = Live(
        parse(FROM_BIT.replace("LATENCY", "0") + '[layers]\nream = ["ream"]\nmain = ["drill"]\n'), clock=Clock()
    )
    rig(live, 150, 150)
    sample(live, 10)
    rig(live, 148, 150, activity=4)
    sample(live, 20)
    rig(live, 148, 150, activity=2)
    sample(live, 30)
    assert live.wall.samples.toolface.tolist() == [10]
    assert live.layers["ream"].samples.toolface.tolist() == [20]
    assert live.model.counts["kept apart"] == 1


def test_depth_is_never_guessed():
    clock = Clock()
    live = from_bit(clock=clock)
    sample(live)  # before any depth
    rig(live, 150)
    clock.step(1)
    sample(live)  # waits for the next depth
    assert live.model.waiting == 1
    clock.step(61)
    rig(live, 151)  # too late: 62 s between the depths
    assert (live.model.waiting, live.wall.sample_count) == (0, 0)
    assert live.model.counts["flag NO_DEPTH"] == 2


def test_no_depth_is_interpolated_in_the_middle_of_a_gap_either():
    """Half way through a gap of 110 s each bit depth is 55 s away."""
    clock = Clock()
    live = from_bit(clock=clock)
    rig(live, 150)
    clock.step(55)
    sample(live)
    clock.step(55)
    rig(live, 151)
    assert (live.model.waiting, live.wall.sample_count) == (0, 0)
    assert live.model.counts["flag NO_DEPTH"] == 1


def test_a_string_that_does_not_turn_is_not_drawn_before_the_first_bit_depth(tmp_path):
    """Also not at a replay, which reads the bit depth together with the sample."""
    items = 'items = { bit_depth = "0108", rotation = "0120" }\n'
    text = SENT + '[source.rig]\naddress = "host"\nunits = "metric"\n' + items
    with Live(parse(text), tmp_path, clock=Clock()) as live:
        live.receive("rig", wits.frame([(120, "0")]))
        live.receive("mwd", FRAMES[0])
        live.receive("rig", wits.frame([(108, "110.0")]))
    for one in (live, Live.replay(tmp_path)):
        assert (one.model.counts["flag NOT_ROTATING"], one.wall.sample_count) == (3, 0)


def texts(live, rule):
    return {event.source: event.newest.text for event in live.model.events.latest if event.rule == rule}


def test_no_sample_is_drawn_between_two_levels_of_bit_depth(golden):
    clock = Clock()
    live = from_bit(clock=clock)
    for depth in (500.0, 500.1, 320.0, 320.1):  # lifted while the line was down; the second value confirms it
        clock.step(5)
        rig(live, depth)
        clock.step(5)
        sample(live)
    assert live.wall.samples.depth.tolist() == [500.05 - 10.0]
    clock.step(5)
    rig(live, 320.2)
    np.testing.assert_allclose(live.wall.samples.depth, [310.15, 490.05])
    assert (live.model.counts["flag RANGE"], live.model.counts["not drawn"]) == (2, 2)
    golden(texts(live, "range")["mwd"])
    golden(texts(live, "depth_jump")["rig"])


def test_bit_depth_that_changes_to_feet_is_refused_for_as_long_as_it_lasts(tmp_path, monkeypatch, golden):
    clock = Clock()
    with Live(parse(FROM_BIT.replace("LATENCY", "0")), tmp_path, clock=clock) as live:
        for i in range(300):
            depth = 500 + 0.5 * i
            rig(live, depth / 0.3048 if 40 <= i < 290 else depth)  # 125 m are drilled meanwhile
            if i == 289:
                golden(texts(live, "depth_jump")["rig"])
            clock.step(1)
            sample(live, float(i * 37 % 360))
            clock.step(1)
        assert live.wall.samples.depth.max() < 650.0
        assert live.model.counts["drawn"] == 39 + 8
        assert live.model.events.counts["rig", "depth_jump"] == 2 * (250 + 1)  # bit and hole; back in metres: confirmed
    for records in (1, 8192):
        monkeypatch.setattr(live_module, "WINDOW_RECORDS", records)
        again = Live.replay(tmp_path)
        assert same_bits(again.wall, live.wall)
        assert (again.model.counts, again.model.events.counts) == (live.model.counts, live.model.events.counts)


def test_a_sent_depth_that_changes_to_feet_is_refused_for_as_long_as_it_lasts():
    live = Live(parse(FROM_BIT.replace("offset = 10.0, latency = LATENCY", 'depth = ["5011"]')), clock=Clock())
    for i in range(100):
        depth = (500 + i) / (0.3048 if 20 <= i < 90 else 1.0)
        live.receive("mwd", wits.frame([(5010, str(i)), (5011, f"{depth:.2f}"), (5012, "110")]))
    assert live.wall.samples.depth.tolist() == [500.0 + i for i in range(100) if not 20 <= i < 90]
    assert live.model.counts["flag RANGE"] == 70
    assert live.model.events.counts["mwd", "depth_jump"] == 70


@pytest.mark.parametrize(
    ("before", "after", "depth"),
    [
        ('bit_depth = "0108", hole_depth = "0110"', 'bit_depth = { item = "0108", unit = "ft" }', 500.2),
        ("[source.rig]", "[depth]\njump = 2000.0\n[source.rig]", 500.2 / 0.3048),
    ],
)
def test_a_level_that_was_refused_is_used_with_a_corrected_unit_or_a_larger_jump(before, after, depth):
    clock, text = Clock(), FROM_BIT.replace("LATENCY", "0")
    live = Live(parse(text), clock=clock)
    rig(live, 500.0)
    for bit in (500.1, 500.2):
        clock.step(61)
        rig(live, bit / 0.3048)
        sample(live)
    assert live.wall.sample_count == 0
    live.reconfigure(parse(text.replace(before, after)))
    for _ in range(2):
        clock.step(1)
        rig(live, 500.2 / 0.3048)
        sample(live)
    assert live.wall.samples.depth[-1] == pytest.approx(depth - 10.0, abs=1e-3)


@pytest.mark.parametrize(("change", "used"), [('depth_unit = "ft", ', True), ("latency = 1.0, ", False)])
def test_a_level_of_sent_depths_is_forgotten_if_their_unit_changes_and_kept_otherwise(change, used):
    """Feet are read as metres for 20 samples, as the bit depth shows; the right unit is then no jump."""
    clock, text = Clock(), FROM_BIT.replace("offset = 10.0, latency = LATENCY", 'depth = ["5011"]')
    live = Live(parse(text), clock=clock)

    def drill(start: int, stop: int) -> None:
        for i in range(start, stop):
            rig(live, 500.0 + 0.1 * i)
            clock.step(1)
            feet = f"{(490 + 0.1 * i) / 0.3048:.2f}"
            live.receive("mwd", wits.frame([(5010, f"{i}"), (5011, feet), (5012, "110")]))
            clock.step(1)

    drill(0, 20)
    assert live.wall.sample_count == 0
    live.reconfigure(parse(text.replace('depth = ["5011"]', f'{change}depth = ["5011"]')))
    drill(20, 60)
    assert (live.wall.sample_count > 30) == used
    assert live.model.events.counts["mwd", "depth_jump"] == 0


def test_a_level_of_bit_depth_outlives_a_change_of_other_items():
    clock, text = Clock(), FROM_BIT.replace("LATENCY", "0")
    live = Live(parse(text), clock=clock)
    rig(live, 500.0)
    clock.step(61)
    rig(live, 500.1 / 0.3048)
    live.reconfigure(parse(text.replace(', activity = "0107"', "")))
    clock.step(1)
    rig(live, 500.2 / 0.3048)
    clock.step(1)
    rig(live, 500.3)
    value = live.model.rig.tracks["bit_depth"].value
    np.testing.assert_allclose(value[np.isfinite(value)], [500.0, 500.3])
    assert live.model.events.counts["rig", "depth_jump"] == 4, "of bit and hole"


def test_only_the_sample_that_jumped_is_refused_when_nothing_can_confirm_its_jump_any_more():
    """The rows that are held with it keep their own reasons."""
    rows = np.zeros(5, ROW)
    rows["depth"] = [100.0, 101.0, 500.0, 102.0, 103.0]
    rows["flags"] = [0, 0, 0, Flag.NULL, Flag.DUPLICATE]
    held = HeldSample(DepthLimits())
    assert len(held.take(rows)[0]) == 2
    held.forget()
    assert held.take(rows[:1])[0]["flags"].tolist() == [Flag.RANGE, Flag.NULL, Flag.DUPLICATE, 0]

"""Every gap, bad value, late survey and clock set back is told, and costs no more than itself."""

from __future__ import annotations

import numpy as np
import pytest
from live_wires import (
    FRAMES,
    SECOND,
    SENT,
    Clock,
    from_bit,
    rig,
    rules,
    same_bits,
    sample,
    station,
)

from helibore import Live
from helibore.live import wits
from helibore.live.configuration import parse


def test_gaps_late_frames_repeats_and_duplicates():
    live = Live(parse(SENT))
    for number in (0, 1, 4, 2, 2, 5, 3, 6):
        live.receive("mwd", FRAMES[number])
    assert rules(live) == ["gap", "late", "duplicate", "repeated", "late"]
    watch = live.model.readers[1].watches[5004]
    assert (watch.last, watch.lost, watch.missing) == (6, 0, set())
    assert live.model.counts["flag DUPLICATE"] == 3
    in_order = Live(parse(SENT))
    for frame in FRAMES[:7]:
        in_order.receive("mwd", frame)
    assert same_bits(live.wall, in_order.wall)


def test_a_counter_that_is_reset_or_wraps_loses_nothing():
    for numbers, told in (
        ([7, 8, 0, 1, 2], ["repeated", "reset"]),
        ([2**31 - 1, 0, 1], []),
        ([5, 2**31 - 5], ["reset"]),
    ):
        live = Live(parse(SENT))
        for place, number in enumerate(numbers):
            live.receive("mwd", FRAMES[place].replace(b"5004%d\r" % place, b"5004%d\r" % number))
        assert rules(live) == told
        assert live.wall.sample_count == 3 * len(numbers)


def test_bad_values_are_flagged_told_and_cost_only_their_triple():
    live = Live(parse(SENT))
    live.receive("mwd", b"hello\r\n" + wits.frame([
        (5010, "10"), (5011, "100.5"), (5012, "1.0.0"), (5013, "20"), (5014, "100.6"), (5015, "-999.25"),
        (5016, "30"), (5017, "100.7"), (5018, "4.3"), (5018, "110")]))  # fmt: skip
    live.receive("mwd", wits.frame([(5010, "10"), (5011, "100.5"), (5012, "110"), (5013, "20")]))
    assert live.wall.sample_count == 1
    counts = live.model.counts
    assert [counts[f"flag {name}"] for name in ("INVALID", "NULL", "RANGE")] == [1, 2, 1]
    texts = [str(event) for event in live.model.events.latest]
    assert texts == [
        "mwd connection 1 line 1: stray_text: b'hello': text between frames is not read",
        "mwd connection 1: invalid: item 5012 = b'1.0.0': is not a number",
        "mwd connection 1: twice: item 5018 = b'110': is there twice in a frame: the first counts",
    ]


def test_a_cut_connection_costs_its_open_frame_only():
    live = Live(parse(SENT))
    live.connected("mwd", 1, "127.0.0.1:5")
    live.receive("mwd", FRAMES[0] + FRAMES[1][:30], 1)
    live.closed("mwd", 1)
    for connection in range(2, 102):
        live.receive("mwd", FRAMES[connection] + FRAMES[connection + 1][:30], connection)
    assert live.wall.sample_count == 3 * 101
    assert live.model.events.counts["mwd", "cut_off"] == 100


def test_a_late_survey_moves_only_what_lies_below_the_station_above_it():
    live = Live(parse(SENT))
    assert live.path is None
    for row in ((0, 0, 0), (50, 5, 10), (130, 9, 20)):
        update = live.receive("mwd", station(*row))
    assert update.path_from == 50
    above, before = live.path.position([20.0, 50.0]), live.path.position([90.0])
    update = live.receive("mwd", station(80, 3, 200))
    assert update.path_from == 50
    assert np.array_equal(live.path.position([20.0, 50.0]), above)
    assert not np.array_equal(live.path.position([90.0]), before)
    assert live.receive("mwd", station(80, 3, 200.0)).path_from is None
    update = live.receive("mwd", station(90, 190, 0))
    assert update.path_from is None
    assert "station at 90 m: inclination" in update.events[-1].text
    assert len(live.survey) == 4


def test_image_rows_come_with_their_depth():
    live = Live(parse(SENT))
    for depth, first in ((101.0, "1"), (100.5, "2"), (101.0, "3")):
        row = [(5110, first), (5111, "20"), (5112, "-9999"), (5113, "x")]
        update = live.receive("mwd", wits.frame([*row, (821, f"{depth}")]))
    assert update.images == {"GR": (2, 3)}
    depth, values = live.images["GR"].arrays()
    assert depth.tolist() == [100.5, 101.0]
    np.testing.assert_array_equal(values, [[2, 20, np.nan, np.nan], [3, 20, np.nan, np.nan]])
    image = live.image("GR")
    np.testing.assert_array_equal(image.values, values)
    assert (image.name, image.unit, image.toolface.tolist()) == ("GR", "gAPI", [75.0, 165.0, 255.0, 345.0])
    with pytest.raises(ValueError, match="image 'RES': no source brings it"):
        live.image("RES")


def test_a_clock_set_back_an_hour_is_told_and_changes_nothing(tmp_path):
    clocks = Clock(), Clock()
    walls = []
    for clock, jump in zip(clocks, (0, -3600 * SECOND), strict=True):
        live = from_bit(latency=1.0, clock=clock)
        for i in range(60):
            clock.step(0.5)
            if i == 30:
                clock.wall += jump
            rig(live, 150 + 0.01 * i)
            sample(live, float(i))
        walls.append(live.wall)
    assert same_bits(*walls)
    assert [str(e) for e in live.model.events.latest] == [
        "helibore: clock: the wall clock was set by -3600.000 s: not followed"
    ]
    clock = Clock()
    with Live(parse(SENT), tmp_path, clock=clock) as live:
        clock.step(10)
        live.receive("mwd", FRAMES[0])
    clock.wall -= 3600 * SECOND
    clock.monotonic = 1
    with Live(parse(SENT), tmp_path, clock=clock) as live:
        now = live.model.clock.now
        live.receive("mwd", FRAMES[1])
        assert live.model.clock.now >= now
        assert rules(live) == ["clock"]


def test_silence_and_uncovered_depth_are_told():
    clock = Clock()
    live = Live(parse(SENT), clock=clock)
    live.receive("mwd", FRAMES[0])
    clock.step(121)
    live.receive("mwd", wits.frame([(5010, "1"), (5011, "140"), (5012, "110")]))
    assert [str(e) for e in live.model.events.latest] == [
        "mwd connection 0: silence: nothing came for 121.0 s",
        f"helibore: depth_gap: layer main: no samples from {live.wall.samples.depth[-2]:.3f} m to 140.000 m",
    ]


def test_keep_alives_are_counted_and_hold_nothing():
    live = Live(parse(SENT))
    live.receive("mwd", wits.HEARTBEAT * 3)
    assert live.model.counts["keep_alives"] == 3
    assert live.model.counts["received"] == 0

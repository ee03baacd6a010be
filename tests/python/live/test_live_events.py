"""Every gap, bad value, late survey and clock set back is reported, and costs no more than itself."""

from __future__ import annotations

import threading

import numpy as np
import pytest
from live_wires import (
    FRAMES,
    SECOND,
    SENT,
    WALL,
    Clock,
    from_bit,
    rig,
    rules,
    same_bits,
    sample,
    station,
)

from helibore import Live
from helibore.base.utc_time import utc
from helibore.live import live as live_module
from helibore.live.model.events import Event, EventBook
from helibore.live.rules.configuration import parse
from helibore.live.wire import wits


def test_gaps_late_frames_repeats_and_duplicates():
    live = Live(parse(SENT))
    for number in (0, 1, 4, 2, 2, 5, 3, 6):
        live.receive("mwd", FRAMES[number])
    assert rules(live) == ["gap", "late", "duplicate", "repeated", "late"]
    watch = live.model.readers[1].watches[5004]
    assert (watch.last, watch.lost, watch.missing) == (6, 0, [])
    assert live.model.counts["flag DUPLICATE"] == 3
    in_order = Live(parse(SENT))
    for frame in FRAMES[:7]:
        in_order.receive("mwd", frame)
    assert same_bits(live.wall, in_order.wall)


def test_a_counter_that_is_reset_or_wraps_loses_nothing():
    for numbers, reported in (
        ([7, 8, 0, 1, 2], ["repeated", "reset"]),
        ([2**31 - 1, 0, 1], []),
        ([5, 2**31 - 5], ["reset"]),
    ):
        live = Live(parse(SENT))
        for place, number in enumerate(numbers):
            live.receive("mwd", FRAMES[place].replace(b"5004%d\r" % place, b"5004%d\r" % number))
        assert rules(live) == reported
        assert live.wall.sample_count == 3 * len(numbers)


def test_bad_values_are_flagged_told_and_cost_only_their_triple(golden):
    live = Live(parse(SENT), clock=Clock())
    live.receive("mwd", b"hello\r\n" + wits.frame([
        (5010, "10"), (5011, "100.5"), (5012, "1.0.0"), (5013, "20"), (5014, "100.6"), (5015, "-999.25"),
        (5016, "30"), (5017, "100.7"), (5018, "4.3"), (5018, "110")]))  # fmt: skip
    live.receive("mwd", wits.frame([(5010, "10"), (5011, "100.5"), (5012, "110"), (5013, "20")]))
    assert live.wall.sample_count == 1
    counts = live.model.counts
    assert [counts[f"flag {name}"] for name in ("INVALID", "NULL", "RANGE")] == [1, 2, 1]
    golden([str(event) for event in live.poll().events])


def test_a_toolface_that_no_tool_has_gives_an_event(golden):
    live = Live(parse(SENT), clock=Clock())
    live.receive("mwd", wits.frame([(5010, "-3000000"), (5011, "100.5"), (5012, "110")]))
    golden([event.text for event in live.poll().events])
    assert live.model.counts["flag RANGE"] == 1


@pytest.mark.parametrize("size", [(1.2, ""), (0.216, ", radius_range = [0.1, 9.0]")])
def test_a_radius_that_no_wall_takes_costs_only_its_sample(size, golden):
    """A wall refuses radii above 2 m; the range of a bit of 1.2 m ends at 2.4 m."""
    text = SENT.replace("0.216", str(size[0])).replace("groups = 3", "groups = 3" + size[1])
    live = Live(parse(text), clock=Clock())
    items = [(5010, "10"), (5011, "100.5"), (5012, "2300"), (5013, "20"), (5014, "100.6"), (5015, "600")]
    update = live.receive("mwd", wits.frame(items))
    golden([event.text.partition("[")[0] for event in update.events])
    assert live.wall.samples.radius.tolist() == [0.6]


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


def test_image_rows_come_with_their_depth(golden):
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
    with golden.raises(kind=ValueError):
        live.image("RES")


def test_passes_have_the_times_of_the_clock_that_was_set_right(tmp_path):
    """A machine begins in 1970, and a session ten years ahead follows; the model's time never goes back."""
    clock, true = Clock(), Clock().wall
    clock.wall = 0
    with Live(parse(SENT), tmp_path, clock=clock) as live:
        for frame in FRAMES[:3]:
            clock.step(10)
            live.receive("mwd", frame)
        assert utc(live.passes[0].start).startswith("1970-01-01T00:00:10")
        clock.wall += true
        live.receive("mwd", FRAMES[3])
        assert live.model.clock.now < true
        assert (live.passes[0].start, live.passes[0].stop) == (true + 10 * SECOND, true + 30 * SECOND)
        live.checkpoint()
    years = 10 * 365 * 86_400 * SECOND
    for ahead in (years, -years):
        clock.wall, clock.monotonic = clock.wall + ahead + SECOND, 1
        with Live(parse(SENT), tmp_path, clock=clock) as live:
            live.receive("mwd", FRAMES[4 if ahead > 0 else 5])
            assert (live.passes[0].start, live.passes[-1].stop) == (true + 10 * SECOND, clock.wall)
            found = live.passes
    assert Live.replay(tmp_path).passes == found


def test_a_clock_set_back_an_hour_is_told_and_changes_nothing(tmp_path, golden):
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
    golden([str(e) for e in live.model.events.latest])
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
        assert [event.rule for event in live.model.events.latest] == ["clock"]


def test_silence_and_uncovered_depth_are_told():
    clock = Clock()
    live = Live(parse(SENT), clock=clock)
    live.receive("mwd", FRAMES[0])
    clock.step(121)
    live.receive("mwd", wits.frame([(5010, "1"), (5011, "140"), (5012, "110")]))
    last = live.wall.samples.depth[-2]
    assert [str(e) for e in live.model.events.latest] == [
        "2023-11-14T22:15:21.000Z mwd connection 1: silence: nothing came for 121.0 s",
        "2023-11-14T22:15:21.000Z mwd connection 1 line 13: depth_gap: layer main: no samples "
        f"from {last:.3f} m to 140.000 m",
    ]


def test_more_hole_than_gap_reach_without_a_sample_is_told_also_after_a_restart(tmp_path, golden):
    def drilled(live, *depths):
        for depth in depths:
            live.receive("mwd", wits.frame([(5010, "1"), (5011, f"{depth:g}"), (5012, "110")]))
        return [event.text for event in live.poll().events if event.rule == "depth_gap"]

    with Live(parse(SENT), tmp_path, clock=Clock()) as live:
        assert drilled(live, 100, 100.5, 101) == []
        golden(drilled(live, 101.6))
    with Live(parse(SENT), tmp_path, clock=Clock()) as live:
        live.poll()
        golden(drilled(live, 103.25))
        assert drilled(live, 102, 102.2) == []  # re-scanned
    up = SENT.replace("start_depth = 100.0", "start_depth = 105.0\npitch = -0.1")
    expected = ["layer main: no samples from 104.500 m to 101.000 m"]
    assert drilled(Live(parse(up), clock=Clock()), 105, 104.5, 104.9, 101, 101.2) == expected
    wider = SENT.replace("[wall]", "[wall]\ngap_reach = 2.0")
    assert drilled(Live(parse(wider), clock=Clock()), 100, 101.9) == []


def test_the_log_has_what_a_source_repeats_once_a_minute_with_its_number(caplog, monkeypatch, golden):
    now = [1000.0]
    monkeypatch.setattr(live_module.time, "monotonic", lambda: now[0])
    live = Live(parse(SENT), clock=Clock())
    with caplog.at_level("INFO", "helibore.live"):
        for _ in range(122):
            live.report("link", f"refused at {now[0]:g}", "mwd")
            live.report("alarm_lost", "begins", "mwd")
            now[0] += 1.0
    logged = [message.split("mwd: ")[1] for message in caplog.messages if "link" in message]
    golden(logged)  # fmt: skip
    assert sum("alarm_lost" in message for message in caplog.messages) == 122
    with caplog.at_level("INFO", "helibore.live"):
        live.reconfigure(parse(SENT))
        live.report("link", "refused again", "mwd")
    assert caplog.messages[-1].endswith("mwd: link: refused again")


def test_keep_alives_are_counted_and_hold_nothing():
    live = Live(parse(SENT))
    live.receive("mwd", wits.HEARTBEAT * 3)
    assert live.model.counts["keep_alives"] == 3
    assert live.model.counts["received"] == 0


def key(event):
    return event.source, event.rule


def test_events_of_one_rule_are_joined_and_a_replay_tells_the_same_whatever_the_window(tmp_path, monkeypatch):
    clock, draw = Clock(), np.random.default_rng(12)
    bad = [b"stray\r\n", b"!!\r\n", wits.frame([(5010, "1"), (5011, "101"), (5012, "x")]), FRAMES[7], FRAMES[2],
           b"&&\r\n50", wits.frame([(5004, "9"), (5010, "3"), (5011, "180"), (5012, "110")]),
           station(60, 190, 0)]  # fmt: skip
    stream = []
    with Live(parse(SENT), tmp_path, clock=clock) as live:
        for number in draw.integers(0, len(bad) + 1, 400).tolist():
            piece = bad[number] if number < len(bad) else FRAMES[len(stream) % 200]
            stream.append(piece)
            clock.step(float(draw.choice([0.1, 0.5, 125.0], p=[0.5, 0.48, 0.02])))
            clock.wall += int(draw.choice([0, 0, 0, -3 * SECOND]))
            live.receive("mwd", piece)
    reported = {key(event): event for event in live.model.events.latest}
    assert {"stray_text", "stray_end", "invalid", "unclosed", "gap", "duplicate", "station", "silence", "clock",
            "depth_gap"} <= {rule for _, rule in reported}  # fmt: skip
    for (source, rule), event in reported.items():
        assert event.count == live.model.events.counts[source, rule]
        assert event.newest.count == 1
    for records, size in ((1, 1), (7, 1 << 20), (8192, 3000), (8192, 1 << 20)):
        monkeypatch.setattr(live_module, "WINDOW_RECORDS", records)
        monkeypatch.setattr(live_module, "WINDOW_BYTES", size)
        assert {key(event): event for event in Live.replay(tmp_path).model.events.latest} == reported
    lines = b"".join(stream).split(b"\n")
    assert lines[reported["mwd", "stray_text"].line - 1] == b"stray\r"
    assert lines[reported["mwd", "invalid"].line - 1] == b"5012x\r"
    assert lines[reported["mwd", "invalid"].newest.line - 1] == b"5012x\r"
    for rule in ("gap", "duplicate", "station", "depth_gap"):
        assert lines[reported["mwd", rule].line - 1] == b"&&\r"


def test_events_of_two_records_layers_and_pass_numbers_are_told_as_they_came(tmp_path, monkeypatch):
    configuration = parse(
        WALL + '[source.mwd]\naddress = "host"\nunits = "metric"\nitems = { pass_number = "0812" }\n'
        'caliper = { first = "5010", groups = 1, order = ["toolface", "depth", "radius"] }\n'
        '[source.mwd.pass_numbers]\ndrill = [1]\nrescan = [2]\n[layers]\nagain = ["rescan", "unknown"]\n'
    )
    draw, depth, one, other = np.random.default_rng(2), 100.0, 0, 0
    with Live(configuration, tmp_path, clock=Clock()) as live:
        for _ in range(60):
            depth, one, other = (
                depth + draw.choice([0.1, 5.0]), one + draw.choice([1, 3]), other + draw.choice([1, 2])
            )  # fmt: skip
            said, radius = draw.choice(["1", "2", "7", "9", "8", "1.5"]), draw.choice(["110", "x"], p=[0.8, 0.2])
            live.receive("mwd", wits.frame([(804, f"{one}"), (812, said), (5004, f"{other}"), (5010, "1"),
                                            (5011, f"{depth:.1f}"), (5012, radius)]))  # fmt: skip
    reported = {key(event): event for event in live.model.events.latest}
    assert set(reported) == {("mwd", rule) for rule in ("gap", "pass", "depth_gap", "invalid")}
    for records in (1, 7, 8192):
        monkeypatch.setattr(live_module, "WINDOW_RECORDS", records)
        assert {key(event): event for event in Live.replay(tmp_path).model.events.latest} == reported


def test_a_frame_that_the_end_of_a_connection_completes_has_its_time_whatever_the_window(tmp_path, monkeypatch):
    clock = Clock()
    with Live(parse(SENT), tmp_path, clock=clock) as live:
        for connection, closed in ((1, True), (2, False), (3, True), (4, False)):
            for place, frame in enumerate(FRAMES[3 * connection : 3 * connection + 3]):
                live.receive("mwd", frame.removesuffix(b"\r\n") if place == 2 else frame, connection)
                clock.step(0.7)
            if closed:
                live.closed("mwd", connection)
            clock.step(3)
    assert live.wall.sample_count == 3 * 11
    assert len(set(live.wall.samples.time)) == 10, "a frame that the next connection ends came with its first record"
    for records in (1, 2, 8192):
        monkeypatch.setattr(live_module, "WINDOW_RECORDS", records)
        assert same_bits(Live.replay(tmp_path).wall, live.wall)
        assert np.array_equal(Live.replay(tmp_path).wall.samples.time, live.wall.samples.time)


def test_an_event_says_how_often_since_when(golden):
    clock = Clock()
    live = Live(parse(SENT), clock=clock)
    for _ in range(3):
        clock.step(60)
        live.receive("mwd", b"&&\r\n!!\r\n!!\r\n")
    (event,) = live.model.events.latest
    golden(str(event))
    assert event.time.isoformat() == "2023-11-14T22:14:20+00:00"
    assert (event.line, event.newest.line, event.newest.time.minute) == (3, 9, 16)


def test_a_flood_holds_no_more_than_a_trickle():
    live = Live(parse(SENT), clock=Clock())
    update = live.receive("mwd", b"!!\r\n" * 50_000 + b"&&\r\nbad\r\n!!\r\n" * 20_000)
    listed = [(event.rule, event.count, event.line) for event in update.events]
    assert listed == [
        *(("stray_end", 1, line) for line in range(1, 8)),
        ("stray_end", 50_000 - 7, 8),
        *(("not_an_item", 1, 50_002 + 3 * n) for n in range(7)),
        ("not_an_item", 20_000 - 7, 50_002 + 3 * 7),
    ]
    assert [event.newest.line for event in update.events[7::8]] == [50_000, 109_999]
    for _ in range(50):
        live.receive("mwd", b"!!\r\n" * 20)
    events = live.poll().events
    assert len(events) == 16
    assert sum(event.count for event in events) == 71_000
    assert len(live.model.events.latest) == 2


def test_threads_that_tell_lose_no_count():
    book = EventBook()
    event = Event(0, "a", 1, 1, -1, "rule", "text")
    threads = [threading.Thread(target=lambda: [book.report(event) for _ in range(5000)]) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert book.counts["a", "rule"] == book.latest[0].count == sum(event.count for event in book.take()) == 20_000


@pytest.mark.parametrize(("start", "pitch"), [(110.0, ""), (90.0, "pitch = -0.1\n")])
def test_samples_before_the_start_of_the_wall_are_reported(start, pitch):
    live = Live(parse(SENT.replace("start_depth = 100.0\n", f"start_depth = {start:g}\n{pitch}")))
    for frame in FRAMES[:7]:
        live.receive("mwd", frame)
    events = [event for event in live.poll().events if event.rule == "outside"]
    assert sum(event.count for event in events) == 21
    rule = f"lies before the wall, which begins at start_depth = {start:g} m: not drawn"
    assert events[0].text == f"layer main: a sample at 100.0 m {rule}"
    assert (len(live.wall), live.model.counts["drawn"]) == (0, 0)


@pytest.mark.parametrize("turn", [(0.0, 2 * np.pi), (-np.pi, np.pi)])
@pytest.mark.parametrize("unit", ["", "rad", "deg"])
def test_toolfaces_that_seem_to_be_radians_are_told_unless_their_unit_is_stated(turn, unit):
    stated = f', toolface_unit = "{unit}"' if unit else ""
    caliper = 'caliper = { toolface = ["5010"], depth = ["5011"], radius = ["5012"]' + stated + " }\n"
    live = Live(parse(WALL + '[source.mwd]\naddress = "host"\nunits = "metric"\n' + caliper), clock=Clock())
    angles = np.linspace(*turn, 120)
    for i, angle in enumerate(angles.tolist()):
        live.receive("mwd", wits.frame([(5010, f"{angle:.4f}"), (5011, f"{100 + i / 100:.2f}"), (5012, "110")]))
    assert live.model.events.counts["mwd", "toolface"] == (0 if unit else 1)
    assert bool(live.model.readers[1].seems_radians) == (not unit)
    if not unit:
        (event,) = [event for event in live.model.events.latest if event.rule == "toolface"]
        assert event.text.endswith('they are radians: state toolface_unit = "rad", or "deg" if they are degrees')
    expected = np.degrees(angles) if unit == "rad" else angles
    np.testing.assert_allclose(live.wall.samples.toolface, expected % 360, atol=0.01)

"""The live wall: the same bits as batch and as replay however the bytes came, and every flag where it belongs."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import helibore as hb
from helibore import Live
from helibore.live import live as live_module
from helibore.live import wits
from helibore.live.configuration import parse
from helibore.live.journal import Journal, JournalFullError, segments
from helibore.simulate import Hole, Lift, Tool, simulate

SECOND = 1_000_000_000
WALL = "[wall]\nbit_diameter = 0.216\nstart_depth = 100.0\nsectors = 16\nthreads = 1\n"
SENT = (
    WALL + '[source.mwd]\naddress = "host"\nunits = "metric"\n'
    'caliper = { first = "5010", groups = 3, order = ["toolface", "depth", "radius"] }\n'
    'survey = {}\nimage.GR = { first = "5110", count = 4, unit = "gAPI", depth = "0821" }\n'
)
FROM_BIT = (
    WALL + '[source.rig]\naddress = "host"\nunits = "metric"\n'
    'items = { bit_depth = "0108", hole_depth = "0110", rotation = "0120", activity = "0107" }\n'
    '[source.mwd]\naddress = "host"\nunits = "metric"\n'
    'caliper = { toolface = ["5010"], radius = ["5012"], offset = 10.0, latency = LATENCY }\n'
)


class Clock:
    """A clock the test sets: wall and monotonic ns."""

    def __init__(self) -> None:
        self.wall, self.monotonic = 1_700_000_000 * SECOND, 5 * SECOND

    def __call__(self) -> tuple[int, int]:
        return self.wall, self.monotonic

    def step(self, seconds: float) -> None:
        self.wall += int(seconds * SECOND)
        self.monotonic += int(seconds * SECOND)


def small_run(samples=600):
    """Samples of a tool that is lifted once, and their frames of three triples."""
    tool = Tool(lifts=(Lift(103.0, 2.0),), noise=0.001)
    run = simulate(Hole.example(start=100.0, stop=105.0, seed=4), tool, samples=samples, seed=4)
    frames = []
    for i in range(0, samples, 3):
        items = []
        for j in range(3):
            row = (run.toolface[i + j], run.depth[i + j], 1000 * run.radius[i + j])
            items += [(5010 + 3 * j + k, f"{value:.4f}") for k, value in enumerate(row)]
        frames.append(wits.frame([(5004, str(i // 3)), *items]))
    return run, frames


RUN, FRAMES = small_run()


def sent_rows():
    """What the frames say, read by the slow way: (n, 3) toolface, depth, radius."""
    rows = []
    for frame in FRAMES:
        values = [float(line[4:]) for line in frame.decode().split("\r\n")[2:-2]]
        rows += [values[i : i + 3] for i in range(0, 9, 3)]
    return np.array(rows) * [1.0, 1.0, 0.001]


def batch_wall(frame_times):
    """The reconstruction of what the frames say; frame i came ``frame_times[i]`` ns after the start."""
    toolface, depth, radius = sent_rows().T
    caliper = hb.Caliper(depth, toolface, radius, np.repeat(np.array(frame_times) / SECOND, 3))
    return hb.reconstruct(caliper, bit_diameter=0.216, start_depth=100.0, sectors=16)


def same_bits(a, b) -> bool:
    names = ("radius", "nearest", "support", "iterations", "depth", "toolface")
    return all(np.array_equal(getattr(a, n), getattr(b, n), equal_nan=True) for n in names) and len(a) > 0


@settings(max_examples=15, deadline=None)
@given(st.randoms())
def test_a_run_with_a_lift_in_random_packets_ends_with_the_bits_of_the_batch(random):
    stream = b"".join(FRAMES)
    cuts = sorted(random.sample(range(1, len(stream)), 25))
    clock = Clock()
    live = Live(parse(SENT), clock=clock)
    came = []
    for start, stop in zip([0, *cuts], [*cuts, len(stream)], strict=True):
        clock.step(random.choice([0.0, 0.001, 3.0]))
        came.append(clock.monotonic - Clock().monotonic)
        live.receive("mwd", stream[start:stop])
    ends = np.cumsum([len(frame) for frame in FRAMES])
    assert same_bits(live.wall, batch_wall(np.array(came)[np.searchsorted([*cuts, len(stream)], ends)]))
    assert live.model.counts["drawn"] == 600


def test_replay_and_restart_give_the_bits_of_live_whatever_the_window(tmp_path, monkeypatch):
    clock = Clock()
    configuration = parse(SENT)
    for part in (FRAMES[:90], FRAMES[90:]):
        with Live(configuration, tmp_path, clock=clock) as live:
            for frame in part:
                clock.step(0.2)
                live.receive("mwd", frame[:20])
                live.receive("mwd", frame[20:])
    for records, size in ((1, 1), (7, 1 << 20), (8192, 3000)):
        monkeypatch.setattr(live_module, "WINDOW_RECORDS", records)
        monkeypatch.setattr(live_module, "WINDOW_BYTES", size)
        again = Live.replay(tmp_path)
        assert same_bits(again.wall, live.wall)
        assert again.model.counts == live.model.counts
    assert same_bits(live.wall, batch_wall(np.arange(1, 201) * (SECOND // 5)))


def test_every_change_is_told_and_a_scan_of_two_metres_touches_only_its_reach():
    live = Live(parse(SENT))
    before = live.wall.radius
    lifted = False
    for frame in FRAMES:
        update = live.receive("mwd", frame)
        after = live.wall.radius
        grown = np.full(len(after), np.nan)
        grown[: len(before)] = before
        changed = (grown != after) & ~(np.isnan(grown) & np.isnan(after))
        changed[len(before) :] = True
        for start, stop in update.changes["main"].ranges:
            changed[start:stop] = False
        assert not changed.any()
        deepest = max(float(line[4:]) for line in frame.decode().split("\r\n") if line[:4] in ("5011", "5014", "5017"))
        if deepest < 102.9 and len(after) == len(before) and len(before):
            lifted = True
            touched = live.wall.depth[update.changes["main"].ranges[0][0] : update.changes["main"].ranges[-1][1]]
            assert touched.min() >= 101.0 - 1.0
            assert touched.max() <= 103.0 + 1.0
        before = after
    assert lifted


def test_changed_quads_are_those_with_a_changed_vertex():
    live = Live(parse(SENT))
    for frame in FRAMES[:60]:
        live.receive("mwd", frame)
    update = live.append_samples([100.7], [33.0], [0.12])
    changed = np.zeros(len(live.wall) + 17, bool)
    for start, stop in update.changes["main"].ranges:
        changed[start:stop] = True
    k = np.arange(len(live.wall))
    expected = changed[k] | changed[k + 1] | changed[k + 16] | changed[k + 17]
    found = np.zeros(len(live.wall), bool)
    for start, stop in update.quads("main", 16):
        found[start:stop] = True
    assert expected.any()
    assert not (expected & ~found).any()
    assert found.sum() <= expected.sum() + 2 * 17
    assert update.quads("other", 16).shape == (0, 2)


def from_bit(latency=0.0, clock=None):
    return Live(parse(FROM_BIT.replace("LATENCY", str(latency))), clock=clock or Clock())


def rig(live, depth, hole=None, rpm=60, activity=None):
    items = [(108, f"{depth:.3f}"), (110, f"{hole if hole is not None else depth:.3f}"), (120, str(rpm))]
    live.receive("rig", wits.frame(items + ([(107, str(activity))] if activity is not None else [])))


def sample(live, toolface=30.0, radius=110.0):
    return live.receive("mwd", wits.frame([(5010, f"{toolface:.2f}"), (5012, f"{radius:.2f}")]))


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
    told = {name.removeprefix("flag ") for name, count in live.model.counts.items() if count and "flag" in name}
    assert told == set(flags)


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


def rules(live) -> list[str]:
    return [event.rule for event in live.model.events.latest]


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


def station(depth, inclination, azimuth):
    return wits.frame([(708, str(depth)), (713, str(inclination)), (715, str(azimuth))])


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


def test_the_host_pushes_samples_stations_and_images(tmp_path):
    configuration = parse(SENT)
    with Live(configuration, tmp_path) as live:
        change = live.append_samples(RUN.depth, RUN.toolface, RUN.radius, RUN.time).changes["main"]
        assert change.accepted == 600
        live.append_stations([0.0, 130.0], [0.0, 5.0], [0.0, 90.0])
        live.append_image("RES", [101.0, 102.0], np.arange(6.0).reshape(2, 3), "ohm.m")
    expected = hb.reconstruct(
        hb.Caliper(RUN.depth, RUN.toolface, RUN.radius, RUN.time), bit_diameter=0.216, start_depth=100.0, sectors=16
    )
    again = Live.replay(tmp_path)
    for one in (live, again):
        assert same_bits(one.wall, expected)
        assert one.path.survey_depth == 130
        assert one.images["RES"].arrays()[1].tolist() == [[0, 1, 2], [3, 4, 5]]


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda live: live.receive("x", b""), "source 'x': is not in the configuration"),
        (lambda live: live.append_samples([1.0], [np.nan], [0.1]), "toolface[0] = nan: must be finite"),
        (lambda live: live.append_samples([1.0], [1.0], [-0.1]), "radius[0] = -0.1: must be larger than 0"),
        (
            lambda live: live.append_samples([1.0, 2.0], [1.0], [0.1]),
            "toolface has 1 values, depth has 2: must be equal",
        ),
        (lambda live: live.append_image("GR", [1.0], np.ones((1, 4))), "image 'GR': comes from a source already"),
        (lambda live: live.append_image("X", [1.0], np.ones((2, 4))), "values has shape (2, 4): must be (1, sectors)"),
    ],
)
def test_a_refused_push_stores_nothing(tmp_path, call, text):
    with Live(parse(SENT), tmp_path) as live:
        with pytest.raises(ValueError) as error:  # noqa: PT011 (the text is compared whole below)
            call(live)
        assert str(error.value) == text
    assert sum(len(segment.records) for segment in segments(tmp_path)) == 1


def test_what_the_disk_refuses_is_not_read(tmp_path, monkeypatch):
    with Live(parse(SENT), tmp_path) as live:

        def refuse(*_):
            raise JournalFullError(28, "No space left on device", "j")

        with monkeypatch.context() as patch:
            patch.setattr(Journal, "append", refuse)
            with pytest.raises(JournalFullError):
                live.receive("mwd", FRAMES[0])
        assert live.wall.sample_count == 0
        live.receive("mwd", FRAMES[0])
        assert live.wall.sample_count == 3


def test_a_journal_is_not_continued_with_another_meaning(tmp_path):
    Live(parse(SENT), tmp_path).close()
    with pytest.raises(ValueError, match="was begun with another configuration of walls, units or items"):
        Live(parse(SENT.replace("metric", "fps")), tmp_path)
    Live(parse(SENT.replace('"host"', '"tcp://127.0.0.1:9"')), tmp_path).close()


def test_damage_in_the_journal_is_told(tmp_path):
    with Live(parse(SENT), tmp_path) as live:
        for frame in FRAMES[:5]:
            live.receive("mwd", frame)
    path = tmp_path / "000001.hbj"
    text = bytearray(path.read_bytes())
    text[-200] ^= 1
    path.write_bytes(text)
    again = Live.replay(tmp_path)
    assert rules(again)[0] == "journal"
    assert "hold no intact record" in again.model.events.latest[0].text
    assert again.wall.sample_count == 12


def test_the_opening_record_holds_the_configuration(tmp_path):
    Live(parse(SENT), tmp_path).close()
    (segment,) = segments(tmp_path)
    assert json.loads(segment.payload(0))["configuration"] == SENT

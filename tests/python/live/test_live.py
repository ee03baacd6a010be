"""The live wall: the same bits as batch and as replay however the bytes came, and every change reported."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from live_wires import (
    FRAMES,
    SECOND,
    SENT,
    WALL,
    Clock,
    batch_wall,
    same_bits,
    sent_rows,
)

import helibore as hb
from helibore import Live
from helibore.live import live as live_module
from helibore.live.frozen_copy import frozen_copy
from helibore.live.rules.configuration import parse
from helibore.live.wire import wits


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


def test_with_direct_the_end_shows_samples_flagged_and_has_the_bits_of_the_batch_with_direct():
    clock, shown = Clock(), 0
    live = Live(parse(SENT.replace("sectors = 16\n", "sectors = 16\ndirect = true\n")), clock=clock)
    plain = Live(parse(SENT), clock=clock)
    came = []
    for frame in FRAMES:
        clock.step(0.2)
        came.append(clock.monotonic - Clock().monotonic)
        reported = live.receive("mwd", frame).changes["main"]
        plain.receive("mwd", frame)
        provisional = np.flatnonzero(live.wall.provisional)
        assert (provisional >= reported.settled).all(), "a settled vertex is never provisional"
        shown += len(provisional)
    assert shown > 0
    toolface, depth, radius = sent_rows().T
    caliper = hb.Caliper(depth, toolface, radius, np.repeat((np.array(came) - came[0]) / SECOND, 3))
    batch = hb.reconstruct(caliper, bit_diameter=0.216, start_depth=100.0, sectors=16, direct=True)
    assert same_bits(live.wall, batch)
    assert np.array_equal(live.wall.provisional, batch.provisional)
    settled = ~live.wall.provisional
    assert 0 < np.count_nonzero(~settled) < len(live.wall)
    assert np.array_equal(live.wall.radius[settled], plain.wall.radius[settled], equal_nan=True)
    assert not plain.wall.provisional.any()


def test_a_silence_is_reported_once_however_seldom_it_is_looked_for():
    clock = Clock()
    live = Live(parse(SENT), clock=clock)
    name = next(iter(live.configuration.sources))
    counts = lambda: live.model.events.counts[name, "silent"]  # noqa: E731
    for silences in (1, 2, 3):
        clock.step(1000.0)
        live.check_silence()
        live.check_silence()
        assert counts() == silences
        live.receive(name, b"&&\r\n!!\r\n")
        assert counts() == silences


def test_one_toolface_serves_several_sensors_each_at_its_angle():
    one = 'toolface = ["5010"], radius = ["5011", "5012", "5013", "5014"], depth = ["5015"]'
    one += ", toolface_offset = [0, 90, 180, 270]"
    four = 'first = "5010", groups = 4, order = ["toolface", "depth", "radius"]'
    walls = []
    for caliper in (one, four):
        live = Live(parse(f'{WALL}[source.mwd]\naddress = "host"\nunits = "metric"\ncaliper = {{ {caliper} }}\n'))
        for k in range(200):
            depth, toolface, radii = f"{100 + 0.05 * k:.2f}", 33 * k % 360, [str(108 + i) for i in range(4)]
            rows = [(f"{(toolface + 90 * i) % 360}", depth, radius) for i, radius in enumerate(radii)]
            flat = [str(toolface), *radii, depth] if caliper == one else [cell for row in rows for cell in row]
            live.receive("mwd", wits.frame([(5010 + i, cell) for i, cell in enumerate(flat)]))
        walls.append(live.wall)
    assert walls[0].sample_count == 800
    assert same_bits(*walls)


@pytest.mark.parametrize("measures", ["radius", "diameter"])
def test_a_breakout_by_diameters_is_no_surer_than_a_key_seat_leaves_it(measures):
    """A diameter does not show on which side a slot is, though a tool that turns sees all around."""
    depth = np.arange(100.0, 106.0, 0.01)[:600]
    toolface = np.arange(600) * 97.0 % 360

    def reach(turned):
        return 108 + 60 * np.maximum(1 - ((toolface + turned - 70) % 360 - 180) ** 2 / 45**2, 0)

    measured = reach(0.0) if measures == "radius" else reach(0.0) + reach(180.0)
    rows = np.column_stack([toolface, depth, measured]).round(4)
    live = Live(parse(SENT.replace("groups = 3", f'groups = 3, measures = "{measures}"')), clock=Clock())
    for three in np.split(rows, 200):
        live.receive("mwd", wits.frame([(5010 + k, f"{value:.4f}") for k, value in enumerate(three.ravel())]))
    for wall in (live.wall, frozen_copy(live).walls["main"]):
        zones = wall.zones().zones
        assert {zone.kind for zone in zones} == {"key seat" if measures == "radius" else "breakout"}
        assert all((zone.confidence > 0.8) == (measures == "radius") for zone in zones)

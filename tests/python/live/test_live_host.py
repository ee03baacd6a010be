"""The host API: what is polled, and what a host's own mistakes cost. Its C++ twin is compared in test_cpp.py."""

from __future__ import annotations

import itertools
import sys
import threading
import tracemalloc

import live_pushes
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import helibore as hb
from helibore import Live
from helibore.live.journal import journal as journals
from helibore.live.model import update as update_module
from helibore.live.model.image_rows import ImageRows
from helibore.live.model.update import Update
from helibore.live.rules.configuration import parse
from helibore.live.snapshot_files import snapshot


def test_a_poll_tells_everything_since_the_last(golden):
    """One thread pushes, another polls and keeps a copy by what the polls tell: in the end it is the wall."""
    live = Live(parse(live_pushes.CONFIGURATION))
    found = live_pushes.pushes()
    pushing = threading.Thread(target=lambda: [push.call(live) for push in found])
    pushing.start()
    copy, accepted, rows, events = np.empty(0), 0, 0, []
    while True:
        over = not pushing.is_alive()
        update = live.poll()
        events += update.events
        rows = update.images.get("GR", (0, rows))[1]
        if "main" in update.changes:
            accepted += update.changes["main"].accepted
            radius = live.wall.radius
            copy = np.concatenate([copy, np.full(len(radius) - len(copy), np.nan)])
            for start, stop in update.changes["main"].ranges:
                copy[start:stop] = radius[start:stop]
        if over:
            break
    pushing.join()
    assert np.array_equal(copy, live.wall.radius, equal_nan=True)
    assert accepted == live.wall.sample_count == 900
    assert rows == len(live.images["GR"])
    stations = [event.text for event in events if event.rule == "station"]
    golden(stations)
    assert live.poll() == Update()


def test_a_poll_tells_what_no_record_caused_and_what_recovery_did(tmp_path):
    with Live(parse(live_pushes.CONFIGURATION), tmp_path) as live:
        live.append_samples([101.0], [0.0], [0.11])
        live.poll()
        live.report("view", "port 8000 is taken")
        assert [event.text for event in live.poll().events] == ["port 8000 is taken"]
        assert live.poll() == Update()
    (segment,) = journals.paths(tmp_path)
    segment.write_bytes(segment.read_bytes()[:-3])
    with Live(parse(live_pushes.CONFIGURATION), tmp_path) as live:
        assert live.journal is not None
        notes = live.journal.recovery.notes
        assert len(notes) == 1
        assert [event.text for event in live.poll().events if event.rule == "journal"] == notes
        assert live.poll().events == []


def test_a_depth_that_is_no_number_costs_only_itself(golden):
    live = Live(parse(live_pushes.CONFIGURATION))
    with golden.raises(kind=ValueError):
        live.append_image("GR", [1.0, np.nan], np.ones((2, 4)))
    update = live.append_stations([np.nan, 0.0, 130.0], [1.0, 0.0, 5.0], [0.0, 0.0, 90.0])
    golden([event.text for event in update.events])
    assert live.path is not None
    assert live.images == {}


@pytest.mark.parametrize(
    ("samples", "reported"),
    [
        (([101.0, 101.1], [0.0, 10.0], [108.0, 0.11]), "radius 108 m: must be above 0 and at most 2"),
        (([101.0, 101.1], [0.0, 10.0], [4.25, 0.11]), "radius 4.25 m: must be above 0 and at most 2"),
        (([101.0, 101.1], [0.0, -2e6], [0.11, 0.11]), "toolface -2e+06 deg: must be from -1e+06 to 1e+06"),
        (([101.0, 101.1], [0.0, 10.0], [0.11, 0.11], [1.0, 1e13]),
         "time 1e+13 s: must be from -4e+09 to 4e+09, in seconds since 1970"),
        (([101.0, 99e3], [0.0, 10.0], [0.11, 0.11]), "depth 99000 m: must be in depth_range [0, 15000]"),
    ],
)  # fmt: skip
def test_a_pushed_sample_that_is_out_of_range_is_left_out_with_an_event(samples, reported):
    live = Live(parse(live_pushes.CONFIGURATION))
    update = live.append_samples(*samples)
    assert [(event.rule, event.text) for event in update.events] == [("range", reported)]
    assert live.wall.sample_count == 1


@pytest.mark.parametrize("connection", [-1, 1 << 32, 1.5, "a"])
def test_a_number_that_is_no_connection_is_refused_and_nothing_is_stored(tmp_path, connection):
    with Live(parse(live_pushes.CONFIGURATION), tmp_path) as live:
        with pytest.raises(ValueError) as raised:  # noqa: PT011 (the text is compared whole below)
            live.receive("host", b"&&", connection)
        assert str(raised.value) == f"connection = {connection!r}: must be a whole number from 0 to 4294967295"
        live.receive("host", b"&&")
    assert Live.replay(tmp_path).model.records == 1


def test_all_bytes_of_a_buffer_of_other_items_are_stored(tmp_path):
    """A buffer of 4 integers has 16 bytes; 4 of them were counted, and the next record was written over the others."""
    with Live(parse(live_pushes.CONFIGURATION), tmp_path) as live:
        for buffer in (memoryview(np.arange(4, dtype=np.int32)), bytearray(b"&&\r\n")):
            live.receive("host", buffer)
    (segment,) = journals.segments(tmp_path)
    stored = [segment.payload(row) for row in np.flatnonzero(segment.records["kind"] == journals.BYTES)]
    assert (stored, segment.damage) == ([np.arange(4, dtype=np.int32).tobytes(), b"&&\r\n"], [])


def test_every_row_of_an_image_that_is_out_of_range_counts():
    live = Live(parse(live_pushes.CONFIGURATION))
    update = live.append_image("GR", [101.0, -5.0, 99e3], [[1, 2], [3, 4], [5, 6]])
    rule = "must be in depth_range [0, 15000]"
    assert [event.text for event in update.events] == [f"image GR: depth {at} m: {rule}" for at in (-5, 99000)]
    assert live.images["GR"].arrays()[1].tolist() == [[1.0, 2.0]]


LIES = {"origin": "edge", "reference": "high-side", "toolface_offset": 30.0}


def test_an_image_that_says_how_it_lies_is_laid_like_one_of_a_source(tmp_path, golden):
    with Live(parse(live_pushes.CONFIGURATION), tmp_path) as live:
        live.append_image("RES", [101.0], np.ones((1, 4)), "ohm.m")
        with golden.raises(kind=ValueError):
            live.image("RES")
        live.append_image("RES", [102.0, 101.5], np.arange(8.0).reshape(2, 4), **LIES)
        live.append_image("RES", [103.0], np.zeros((1, 4)))
        live.append_samples(np.linspace(100, 104, 200), np.arange(200) * 37.0 % 360, np.full(200, 0.11))
        image = live.image("RES")
        expected = hb.SectorImage([101, 101.5, 102, 103], image.values, "RES", "ohm.m", origin="edge",
                                  reference="high-side", offset=30.0)  # fmt: skip
        assert image.on(live.wall).tobytes() == expected.on(live.wall).tobytes()
        snapshot(live, tmp_path / "now")
    assert hb.load(tmp_path / "now" / "main.wall").images["RES"].offset == 30.0
    assert Live.replay(tmp_path).image("RES").on(live.wall).tobytes() == expected.on(live.wall).tobytes()


@pytest.mark.parametrize(
    "given",
    [
        {"origin": "edge"},
        {**LIES, "origin": "middle"},
        {**LIES, "reference": "north"},
        {**LIES, "toolface_offset": np.inf},
        {**LIES, "direction": "left"},
        {**LIES, "toolface_offset": 31},
        {"unit": "gAPI"},
    ],
)  # fmt: skip
def test_an_image_that_lies_otherwise_is_refused_and_not_stored(given, golden):
    live = Live(parse(live_pushes.CONFIGURATION))
    live.append_image("RES", [101.0], np.ones((1, 4)), "ohm.m", **LIES)
    with pytest.raises(ValueError) as raised:  # noqa: PT011 (the text is compared whole below)
        live.append_image("RES", [102.0], np.ones((1, 4)), **given)
    golden(str(raised.value))
    assert len(live.images["RES"]) == 1


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("GR", np.ones((1, 0))),
        ("GR", np.ones((2, 4))),
        ("GR", [[1.0], [2.0, 3.0]]),
        ("GR", [["a"]]),
        ("GR", np.array([[1.0, np.nan, -np.inf]])),
        ("a\0b", np.ones((1, 4))),
        ("/" * 67, np.ones((1, 4))),
        ("\ud800", np.ones((1, 4))),
    ],
)  # fmt: skip
def test_what_is_no_image_is_refused_and_not_stored(name, values, tmp_path, golden):
    with Live(parse(live_pushes.CONFIGURATION), tmp_path) as live:
        with pytest.raises(ValueError) as raised:  # noqa: PT011 (the text is compared whole below)
            live.append_image(name, [101.0], values)
        golden(str(raised.value))
        live.append_image("é" * 100, [101.0], np.ones((1, 4)))
        assert next(path.name for path in snapshot(live, tmp_path / "now")) == f"image-{'é' * 100}.csv"
    assert list(Live.replay(tmp_path).images) == ["é" * 100]


def test_the_rows_that_are_told_are_those_that_came_and_sorted_they_are_the_image():
    live = Live(parse(live_pushes.CONFIGURATION))
    draw, came = np.random.default_rng(3), []
    for _ in range(30):
        depth, values = draw.choice(np.arange(100, 110, 0.5), 3), draw.normal(size=(3, 4))
        live.append_image("GR", depth, values)
        came += zip(depth.tolist(), values.tolist(), strict=True)
        if draw.random() < 0.4:
            start, stop = live.poll().images["GR"]
            reported = live.images["GR"].rows(start, stop)
            assert (reported[0].tolist(), reported[1].tolist()) == tuple(map(list, zip(*came[start:stop], strict=True)))
    latest = dict(came)
    depth, values = live.images["GR"].arrays()
    assert depth.tolist() == sorted(latest)
    assert values.tolist() == [latest[at] for at in depth.tolist()]


def test_rows_that_come_while_others_are_read_are_all_there():
    rows, count, waits = ImageRows(2, "gAPI"), 20_000, sys.getswitchinterval()
    numbers = np.arange(float(count))
    sys.setswitchinterval(1e-6)  # a thread is stopped at nearly every instant of an append
    try:
        pushing = threading.Thread(
            target=lambda: [rows.append(numbers[i : i + 1], np.full((1, 2), float(i))) for i in range(count)]
        )
        pushing.start()
        while pushing.is_alive():
            seen = len(rows)
            depth, values = rows.rows(0, seen)
            assert depth.tolist() == values[:, 1].tolist() == numbers[:seen].tolist()
            assert len(rows.arrays()[0]) >= seen
        pushing.join()
    finally:
        sys.setswitchinterval(waits)
    assert rows.arrays()[0].tolist() == rows.rows(0, count)[0].tolist() == numbers.tolist()


def test_a_poll_of_a_few_rows_copies_a_few_rows():
    rows = ImageRows(1000, "gAPI")
    rows.append(np.arange(4000.0), np.ones((4000, 1000)))  # 32 MB
    tracemalloc.start()
    for i in range(4000, 4010):
        start, stop = rows.append(np.array([float(i)]), np.ones((1, 1000)))
        if i == 4000:
            tracemalloc.reset_peak()  # the buffer has grown, once
        before = tracemalloc.get_traced_memory()[0]
        assert rows.rows(start, stop)[0].tolist() == [i]
        assert tracemalloc.get_traced_memory()[1] - before < 100_000
        tracemalloc.reset_peak()
    tracemalloc.stop()


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.integers(0, 300), st.integers(1, 9)), max_size=120), st.integers(1, 40))
def test_joined_ranges_cover_all_and_close_the_narrowest_gaps(found, most):
    ranges = np.array([(start, start + length) for start, length in found], np.int64).reshape(-1, 2)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(update_module, "MOST_RANGES", most)
        joint = update_module.joined_ranges(ranges).tolist()
    covered = {k for start, stop in ranges.tolist() for k in range(start, stop)}
    reported = {k for start, stop in joint for k in range(start, stop)}
    assert covered <= reported
    assert len(joint) <= most
    gaps = [b[0] - a[1] for a, b in itertools.pairwise(joint)]
    assert all(gap > 0 for gap in gaps)
    holes = [len(list(group)) for _, group in itertools.groupby(
        range(min(covered), max(covered)), key=lambda k: k in covered) if not _] if covered else []  # fmt: skip
    assert sorted(gaps) == sorted(holes)[max(len(holes) - most + 1, 0) :]


def test_a_host_that_never_polls_holds_little(monkeypatch):
    monkeypatch.setattr(update_module, "MOST_RANGES", 100)
    live = Live(parse(live_pushes.CONFIGURATION + "[depth]\ndepth_range = [0, 30000]\n"))
    live.append_samples([20_000.0], [0.0], [0.11])
    live.poll()
    for i in range(150):
        live.append_samples([100.0 + 4.0 * (i * 1237 % 3000)], [0.0], [0.11])
        live.append_stations([float("nan")], [0.0], [0.0])
    update = live.poll()
    assert len(update.changes["main"].ranges) == update_module.MOST_RANGES
    assert update.changes["main"].accepted == 150
    assert (len(update.events), sum(event.count for event in update.events if event.rule == "station")) == (8, 150)

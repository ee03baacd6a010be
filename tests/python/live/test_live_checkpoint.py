"""A restart from a checkpoint has the bits of a replay of the whole journal, wherever the run was cut."""

from __future__ import annotations

import json
import random
import shutil
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from live_wires import FRAMES, RUN, SENT, WALL, Clock, same_bits, station

from helibore import Live
from helibore.live.journal import checkpoint, journal
from helibore.live.model.cell_counts import CellCounts
from helibore.live.model.events import Flag
from helibore.live.model.sequence import SequenceWatch
from helibore.live.rules.configuration import parse
from helibore.live.wire import wits

MIXED = (
    WALL
    + "direct = true\n[samples]\nmost = 16\n[layers]\nmain = ['drill', 'unknown', 'rescan']\nream = ['ream', 'trip']\n"
    '[source.rig]\naddress = "host"\nunits = "metric"\n'
    'items = { bit_depth = "0108", hole_depth = "0110", rotation = "0120", activity = "0107" }\n'
    '[source.bit]\naddress = "host"\nunits = "metric"\n'
    'caliper = { toolface = ["6010"], radius = ["6012"], offset = 2.0, latency = 1.5 }\n'
    'image.RES = { first = "6110", count = 2, unit = "ohm.m", origin = "edge", reference = "high-side",'
    " latency = 2.0 }\n"
    '[source.mwd]\naddress = "host"\nunits = "metric"\n'
    'caliper = { first = "5010", groups = 3, order = ["toolface", "depth", "radius"] }\nsurvey = {}\n'
    'items = { pass_number = "5005" }\n'
    'image.GR = { first = "5110", count = 4, unit = "gAPI", depth = "0821", origin = "edge",'
    ' reference = "high-side" }\n'
)
CONFIGURATION = parse(MIXED)


def opened(folder: Path, clock: Clock | None = None) -> Live:
    """Open a journal whose segments are short."""
    live = Live(CONFIGURATION, folder, clock=clock or Clock())
    assert live.journal is not None
    live.journal._segment_bytes = 12_000
    return live


def play(live: Live, clock: Clock, draw: random.Random, steps: int, first: int) -> None:
    """Play ``steps`` random pushes: packets cut anywhere, gaps, repeats, noise, stations, images and host values."""
    held = {"rig": b"", "mwd": b"", "bit": b""}
    for number in range(first, first + steps):
        clock.step(draw.choice([0.2, 0.5, 1.0]))
        depth = 100.0 + number * 0.02 - (1.5 if number % 60 > 45 else 0)
        rpm, activity = draw.choice(["0", "60", "60"]), draw.choice("224")
        hole = f"{100 + number * 0.02:.3f}"
        held["rig"] += wits.frame([(108, f"{depth:.3f}"), (110, hole), (120, rpm), (107, activity)])
        held["mwd"] += draw.choice(
            [
                FRAMES[number % 200].replace(b"5004", b"50050002\r\n5004" if number % 3 else b"5004"),
                FRAMES[number % 7],
                FRAMES[0].replace(b"50100", b"5010x", 1),
                b"noise\r\n&&\r\n5004" + b"%d\r\n" % draw.randrange(10**6),
                station(float(number), draw.uniform(0, 20), draw.uniform(0, 300)),
                wits.frame([(821, f"{depth:.2f}"), *((5110 + k, str(draw.randrange(99))) for k in range(4))]),
            ]
        )
        held["bit"] += wits.frame([(6010, f"{draw.uniform(0, 360):.2f}"), (6012, f"{draw.uniform(100, 120):.2f}"),
                                   (6110, "1.5"), (6111, str(number))])  # fmt: skip
        for name, text in held.items():
            cut = draw.randrange(len(text) + 1)
            live.receive(name, text[:cut], 1 + number // 50)
            held[name] = text[cut:]
        if draw.random() < 0.2:
            row = draw.randrange(590)
            live.append_samples(RUN.depth[row : row + 9], RUN.toolface[row : row + 9], RUN.radius[row : row + 9])
            live.append_image("HOST", [depth], np.array([[1.0, number]]), origin="edge", reference="high-side")
            live.append_stations([1000.0 + number], [3.0], [draw.uniform(0, 360)])
        if draw.random() < 0.1:
            name = draw.choice(list(held))
            live.closed(name, 1 + number // 50)
            held[name] = b""


def outcome(live: Live) -> dict[str, object]:
    """All that a host can see."""
    model = live.model
    found: dict[str, object] = {
        "walls": {name: (wall._state().sample_columns, wall.radius, wall.nearest, wall.support, wall.iterations)
                  for name, wall in live.layers.items()},
        "images": {name: (rows.unit, *rows.arrays()) for name, rows in live.images.items()},
        "stations": model.stations.rows(), "passes": live.passes, "events": model.events.recorded,
        "counts": dict(+model.counts), "layouts": model.layouts, "records": model.records, "time": model.clock.now,
        "lost": [[watch.lost for watch in reader.watches.values()] for reader in model.readers.values()],
        "bytes": [reader.total("bytes") for reader in model.readers.values()],
        "lines": [reader.total("lines") for reader in model.readers.values()], "waiting": model.waiting,
        "apart": {name: sorted(of.values.tolist()) for name, of in model.apart.items()},
    }  # fmt: skip
    return found


def same(one: object, other: object) -> bool:
    if isinstance(one, np.ndarray):
        return isinstance(other, np.ndarray) and np.array_equal(one, other, equal_nan=True)
    if isinstance(one, dict):
        return isinstance(other, dict) and one.keys() == other.keys() and all(same(one[k], other[k]) for k in one)
    if isinstance(one, (list, tuple)):
        return len(one) == len(other) and all(same(a, b) for a, b in zip(one, other, strict=True))  # type: ignore[arg-type]
    return one == other


def assert_same(live: Live, other: Live) -> None:
    ours, theirs = outcome(live), outcome(other)
    for name in ours:
        assert same(ours[name], theirs[name]), name


@settings(max_examples=8, deadline=None, phases=[Phase.explicit, Phase.generate])
@given(seed=st.integers(0, 10**6), cuts=st.lists(st.integers(1, 60), min_size=1, max_size=4), synced=st.booleans())
def test_a_restart_from_a_checkpoint_has_the_bits_of_the_whole_journal(tmp_path_factory, seed, cuts, synced):
    """Each session writes a checkpoint somewhere and ends anywhere after it, also within a record that is torn."""
    folder, draw, clock, first = tmp_path_factory.mktemp("j"), random.Random(seed), Clock(), 0
    for steps in cuts:
        live = opened(folder, clock)
        play(live, clock, draw, steps, first)
        live.checkpoint()
        assert live.journal is not None
        covered = live.journal._path, live.journal._stop
        play(live, clock, draw, steps // 2, first + steps)
        first += steps + steps // 2
        if live.journal._path == covered[0] and not synced:  # a power cut: any byte after the checkpoint may be lost
            size = draw.randint(covered[1], live.journal._stop)
            live.journal.close()
            with covered[0].open("r+b") as file:
                file.truncate(size)
        else:
            live.journal.close()
        clock.step(60)
    again = opened(folder, clock)
    assert again.journal is not None
    assert_same(again, Live.replay(folder, CONFIGURATION))
    assert sum(cuts) < 60 or again.model.apart["main"].values.size
    play(again, clock, draw, 30, first)
    again.journal.close()
    assert_same(again, Live.replay(folder, CONFIGURATION))


def played(folder, steps=80):
    clock = Clock()
    live = opened(folder, clock)
    for part in range(3):
        play(live, clock, random.Random(part), steps, part * steps)
        live.checkpoint()
    live.close()
    return checkpoint.paths(folder)


def test_a_damaged_checkpoint_falls_back_to_the_one_before_and_then_to_the_journal(tmp_path):
    older, newest = played(tmp_path)
    whole = Live.replay(tmp_path, CONFIGURATION)
    for path in (newest, older):
        text = bytearray(path.read_bytes())
        text[len(text) // 2] ^= 1
        path.write_bytes(text)
        copy = tmp_path.parent / f"{tmp_path.name}-{path.stem}"
        shutil.copytree(tmp_path, copy)
        with opened(copy) as live:
            reported = [event for event in live.poll().events if event.rule == "checkpoint"]
            assert len(reported) == 1 + (path == older)
            assert f"{copy / newest.name}: damaged: BadZipFile" in reported[0].text
            assert same_bits(live.wall, whole.wall)


def rewritten(path, **facts):
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    members["state.json"] = json.dumps(json.loads(members["state.json"]) | facts).encode()
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content)


@pytest.mark.parametrize(
    ("facts", "text"),
    [
        ({"version": 9}, "PATH: version 9: this helibore reads version 3"),
        ({"salt": 1}, "PATH: belongs to another journal"),
        (
            {"meaning": "{}", "configuration": ""},
            "PATH: cannot be restored: PATH: was written with another configuration",
        ),
        ({"state": {"state": {"nonsense": 1}}}, "PATH: cannot be restored: 'Model' object has no attribute 'nonsense'"),
    ],
)
def test_a_checkpoint_that_does_not_fit_is_not_used_and_reported(tmp_path, facts, text):
    older, newest = played(tmp_path, 10)
    older.unlink()
    rewritten(newest, **facts)
    with opened(tmp_path) as live:
        reported = [event.text for event in live.poll().events if event.rule == "checkpoint"]
        assert reported == [text.replace("PATH", str(newest)) + ": not used"]


def test_a_checkpoint_beyond_the_journal_is_not_used(tmp_path):
    played(tmp_path, 10)
    journal.paths(tmp_path)[-1].unlink()
    whole = Live.replay(tmp_path, CONFIGURATION)
    with opened(tmp_path) as live:
        texts = [event.text for event in live.poll().events if event.rule == "checkpoint"]
        assert all("goes beyond the last record of the journal" in text for text in texts)
        assert same_bits(live.wall, whole.wall)


def test_a_checkpoint_beyond_the_journal_is_not_used_when_new_records_have_its_numbers(tmp_path):
    live = Live(parse(SENT), tmp_path)
    assert live.journal is not None
    for frame in FRAMES[:10]:
        live.receive("mwd", frame)
    path, stop = live.journal._path, live.journal._stop
    live.receive("mwd", FRAMES[10])
    live.checkpoint()
    live.journal.close()
    with path.open("r+b") as file:
        file.truncate(stop)
    for number in range(11, 14):
        with Live(parse(SENT), tmp_path) as live:
            live.receive("mwd", FRAMES[number], number)
            assert live.wall.sample_count == 3 * number
        assert same_bits(live.wall, Live.replay(tmp_path).wall)
    assert [path.suffix for path in tmp_path.glob("checkpoint-*")] == [".beyond"]


@pytest.mark.parametrize(("at", "value", "error"), [(8, 1, "RuntimeError"), (10, 8, "error")])
def test_a_damaged_directory_of_a_checkpoint_stops_no_restart(tmp_path, at, value, error):
    newest = played(tmp_path, 10)[-1]
    text = bytearray(newest.read_bytes())
    text[text.index(b"PK\1\2") + at] = value
    newest.write_bytes(text)
    with opened(tmp_path) as live:
        (reported,) = [event.text for event in live.poll().events if event.rule == "checkpoint"]
    assert f"{newest}: damaged: {error}: " in reported


def test_a_model_whose_reading_failed_is_in_no_checkpoint(tmp_path, monkeypatch):
    with Live(parse(SENT), tmp_path) as live:
        assert live.journal is not None
        live.receive("mwd", FRAMES[0])
        live.journal._segment_bytes = 1
        monkeypatch.setattr(live.model.rig, "settle", lambda: 1 / 0)
        with pytest.raises(ZeroDivisionError):
            live.receive("mwd", FRAMES[1])
        assert not live.checkpoint_due
        assert live.checkpoint() is None
    assert checkpoint.paths(tmp_path) == []
    with Live(parse(SENT), tmp_path) as again:
        assert again.wall.sample_count == 6


def test_a_journal_whose_reading_failed_can_be_opened_again(tmp_path, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr("helibore.live.live.read_into", lambda *_: 1 / 0)
        with pytest.raises(ZeroDivisionError):
            Live(parse(SENT), tmp_path)
    Live(parse(SENT), tmp_path).close()


def test_a_part_of_a_checkpoint_that_a_killed_process_left_is_deleted(tmp_path):
    Live(parse(SENT), tmp_path).close()
    (tmp_path / ".checkpoint-000000000012.zip.0123abcd.part").write_bytes(b"a part")
    Live(parse(SENT), tmp_path).close()
    assert not list(tmp_path.glob(".*"))


def test_records_that_a_checkpoint_contains_are_not_read_again(tmp_path, monkeypatch):
    played(tmp_path)
    read = []
    of = journal.Segment.payload
    monkeypatch.setattr(journal.Segment, "payload", lambda self, row: read.append(row) or of(self, row))
    opened(tmp_path).close()
    assert len(read) < 20


@pytest.mark.parametrize(("lost", "text"), [((1, 2, 3), "segments 1 to 3 are missing"), ((2,), "segment 2 is missing")])
def test_segments_that_are_lost_after_a_checkpoint_are_reported(tmp_path, lost, text):
    with opened(tmp_path) as live:
        live.append_samples([100.0], [0.0], [0.11])
        live.checkpoint()
        for number in range(1, 40):
            live.append_samples(100 + np.arange(100) / 1e3, np.arange(100) * 3.0, np.full(100, 0.11 + number / 1e6))
    for path in checkpoint.paths(tmp_path)[1:]:
        path.unlink()
    for number in lost:
        journal.paths(tmp_path)[0].with_name(f"{number:06d}.hbj").unlink()
    with Live(CONFIGURATION, tmp_path) as live:
        assert 0 < live.wall.sample_count < 3901
        assert text in [event.text for event in live.poll().events if event.rule == "journal"]


def test_only_two_checkpoints_are_kept_and_one_is_due_after_each_segment(tmp_path):
    live = opened(tmp_path)
    assert not live.checkpoint_due
    while not live.checkpoint_due:
        live.receive("mwd", FRAMES[0] * 10)
    for _ in range(3):
        live.receive("mwd", FRAMES[1])
        live.checkpoint()
        assert not live.checkpoint_due
    assert len(checkpoint.paths(tmp_path)) == 2
    assert live.journal is not None
    assert checkpoint.position(checkpoint.paths(tmp_path)[-1]) == live.model.next_sequence
    live.close()


def test_the_checkpoint_with_the_greatest_number_is_the_newest(tmp_path):
    for sequence in (999_999_999_999, 1_000_000_000_000, 1_000_000_000_001):
        checkpoint.write(tmp_path, sequence, {}, (None, []))
    assert [checkpoint.position(path) for path in checkpoint.paths(tmp_path)] == [10**12, 10**12 + 1]


def test_a_disk_that_refuses_a_checkpoint_leaves_the_one_before(tmp_path, monkeypatch):
    with Live(parse(SENT), tmp_path) as live:
        live.receive("mwd", FRAMES[0])
        first = live.checkpoint()
        live.receive("mwd", FRAMES[1])

        def refuse(*_, **__):
            raise OSError(28, "No space left on device")

        with monkeypatch.context() as patch:
            patch.setattr(np.lib.format, "write_array", refuse)
            with pytest.raises(OSError, match="No space left"):
                live.checkpoint()
        assert checkpoint.paths(tmp_path) == [first]
    assert not list(tmp_path.glob(".*"))


def test_a_cell_keeps_the_first_samples_of_each_of_its_parts_in_any_grouping():
    draw = np.random.default_rng(1)
    depth, toolface = 100 + draw.random(4000) * 0.5, draw.random(4000) * 360
    counts, seen, slow = CellCounts(16, 0.1, 64), {}, []
    for one, angle in zip(depth.tolist(), toolface.tolist(), strict=True):
        part = int(one // 0.025), int(angle / 360 * 32)
        seen[part] = seen.get(part, 0) + 1
        slow.append(seen[part] <= 8)
    assert 0 < sum(slow) < 4000
    kept = [counts.take(depth[at : at + 50], toolface[at : at + 50]) for at in range(0, 4000, 50)]
    assert np.concatenate(kept).tolist() == slow == CellCounts(16, 0.1, 64).take(depth, toolface).tolist()
    assert CellCounts(16, 0.1, 0).take(depth, toolface).all()


def test_a_tool_that_turns_at_one_depth_does_not_fill_the_memory():
    """Ten times the samples in the same cells: the wall keeps as many as before, and reports the others."""
    live, clock = Live(parse(SENT + "[samples]\nmost = 64\n")), Clock()
    for number in range(2000):
        clock.step(1)
        angles = [(number * 3 + k) * 7.13 % 360 for k in range(3)]
        rows = [(f"{angle:.2f}", f"{101 + k * 0.03:.2f}", str(110 + number / 2e3)) for k, angle in enumerate(angles)]
        items = list(enumerate((text for row in rows for text in row), 5010))
        live.receive("mwd", wits.frame(items))
        if number == 999:
            kept = live.wall.sample_count
    assert live.wall.sample_count == kept == 3 * 32 * 8
    assert live.model.counts["drawn"] == kept
    assert live.model.counts["crowded"] == 6000 - kept
    event = live.model.events.recorded["mwd", "crowded"]
    assert event.count == 6000 - kept
    share = "this part of a vertex's cell already has its share of samples.most = 64 samples of this source"
    assert event.text == f"layer main: {share}: not drawn"


def test_samples_that_no_wall_takes_do_not_fill_the_memory():
    live, clock = Live(parse(SENT + "[samples]\nmost = 64\n[layers]\nmain = ['ream']\n")), Clock()
    sizes = []
    for number in range(2000):
        clock.step(1)
        items = [(5010, f"{number * 7.13 % 360:.2f}"), (5011, "101.00"), (5012, str(110 + number / 2e3))]
        live.receive("mwd", wits.frame(items))
        sizes.append(live.model.apart["main"].values.size)
    assert sizes[1000] == sizes[-1] > 0
    assert live.wall.sample_count == 0


def test_missing_numbers_are_kept_as_ranges():
    watch = SequenceWatch()
    watch.take(np.array([0.0, 60_001.0]))
    assert watch.missing == [(1, 60_001)]
    flags, _ = watch.take(np.array([30_000.0, 1.0, 60_000.0, 30_000.0]))
    assert watch.missing == [(2, 30_000), (30_001, 60_000)]
    assert flags.tolist() == [int(Flag.LATE)] * 3 + [0]
    for start in range(70_000, 70_000 + 4 * 5000, 4):
        watch.take(np.array([start, start + 2.0]))
    assert len(watch.missing) == 1024
    assert watch.lost == 59_997 + 9_998 + 9_999

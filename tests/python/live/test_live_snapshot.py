"""Snapshots: files of one instant, all of them or those of before."""

from __future__ import annotations

import csv
import itertools
import json
import threading
import time

import numpy as np
import pytest
from live_wires import FRAMES, SENT, Clock, same_bits
from patience import PATIENCE

import helibore as hb
from helibore import Live
from helibore.live.frozen_copy import frozen_copy
from helibore.live.rules.configuration import parse
from helibore.live.rules.layout import Layout
from helibore.live.snapshot_files import snapshot
from helibore.live.wire import wits
from helibore.wall.reads import WallReads


def both(number):
    """A frame with a triple and an image row."""
    items = [
        (5010, f"{number * 37 % 360}"),
        (5011, f"{100 + 0.01 * number:.2f}"),
        (5012, "110"),
        (821, f"{100 + number}"),
    ]
    return wits.frame([*items, (5110, "1"), (5111, "2"), (5112, "3"), (5113, "4")])


def table(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def test_the_files_are_of_one_instant_while_the_wall_grows(tmp_path):
    live = Live(parse(SENT))
    stop = threading.Event()

    def push():
        for number in itertools.count(1001):  # no frame twice: a duplicate is a record without a row
            if stop.is_set():
                return
            live.receive("mwd", both(number))

    live.receive("mwd", both(0))
    live.receive("mwd", both(1000))
    pushing = threading.Thread(target=push)
    pushing.start()
    seen = []
    try:
        for number in range(1, 9):
            snapshot(live, tmp_path)
            manifest = json.loads((tmp_path / "snapshot.json").read_text())
            saved = hb.load(tmp_path / "main.wall")
            rows = len(table(tmp_path / "image-GR.csv"))
            assert saved.sample_count == rows
            assert sum(int(row["samples"]) for row in table(tmp_path / "passes.csv")) == rows
            assert manifest["records"] == rows
            assert (manifest["number"], manifest["complete"]) == (number, True)
            assert manifest["files"] == {n: len(b) for n, b in contents(tmp_path).items() if n != "snapshot.json"}
            assert len(saved.images["GR"].depth) == rows
            seen.append(rows)
            while live.model.records < manifest["records"] + 5:  # the sender goes on, however loaded the machine is
                time.sleep(0.001)
    finally:
        stop.set()
        pushing.join()
    assert seen[-1] > seen[0] + 20


def test_what_is_still_reads_as_the_wall_did():
    live = Live(parse(SENT), clock=Clock())
    live.append_stations([0.0, 130.0], [0.0, 9.0], [0.0, 40.0])
    for frame in FRAMES[:100]:
        live.receive("mwd", frame)
    kept, surface, logs = frozen_copy(live).walls["main"], live.wall.surface(live.path), live.wall.logs()
    before = hb.reconstruct(live.wall.samples, bit_diameter=0.216, start_depth=100.0, sectors=16)
    for frame in FRAMES[100:]:
        live.receive("mwd", frame)
    assert len(kept) == len(before) < len(live.wall)
    assert np.array_equal(kept.radius, before.radius, equal_nan=True)
    assert kept.depth[-1] == before.depth[-1]
    assert np.array_equal(kept.surface(kept.path).vertices, surface.vertices)
    assert np.array_equal(kept.logs().equivalent_diameter, logs.equivalent_diameter, equal_nan=True)
    assert np.array_equal(kept.logs().age, logs.age, equal_nan=True)


def test_the_saved_wall_goes_on_with_the_bits_of_the_live_one(tmp_path):
    live = Live(parse(SENT), clock=Clock())
    for frame in FRAMES:
        live.receive("mwd", frame)
    snapshot(live, tmp_path)
    assert same_bits(hb.load(tmp_path / "main.wall"), live.wall)


def test_what_cannot_be_written_leaves_the_snapshot_before(tmp_path, monkeypatch):
    live = Live(parse(SENT), clock=Clock())
    live.receive("mwd", FRAMES[0])
    snapshot(live, tmp_path)
    before = contents(tmp_path)
    live.receive("mwd", FRAMES[1] + both(3))

    def refuse(*_):
        raise OSError(28, "No space left on device")

    for name in ("save", "logs"):
        with monkeypatch.context() as patch:
            patch.setattr(WallReads, name, refuse)
            for frame in FRAMES[2:60]:
                live.receive("mwd", frame)
            with pytest.raises(OSError, match="No space left"):
                snapshot(live, tmp_path)
        assert contents(tmp_path) == before
        assert not (tmp_path / ".new").exists()
    snapshot(live, tmp_path)
    assert json.loads((tmp_path / "snapshot.json").read_text())["number"] == 2


def test_files_of_before_go_and_those_of_others_stay(tmp_path):
    live = Live(parse(SENT), clock=Clock())
    live.receive("mwd", FRAMES[0])
    snapshot(live, tmp_path)
    (tmp_path / "mine.csv").write_text("x")
    (tmp_path.parent / "precious.csv").write_text("y")
    manifest = json.loads((tmp_path / "snapshot.json").read_text())
    manifest |= {"number": 6, "complete": False}  # as a run that was killed between two files leaves it
    manifest["files"] |= {"old.las": 5, "../precious.csv": 1, "/etc/passwd": 2}
    manifest["files"] |= {"..": 1, ".": 1, "": 1, "theirs": 1, "a\0b": 1}
    (tmp_path / "theirs").mkdir()
    (tmp_path / "old.las").write_text("old")
    (tmp_path / "snapshot.json").write_text(json.dumps(manifest))
    (tmp_path / ".new").mkdir()
    (tmp_path / ".new" / "half").write_text("z")
    snapshot(live, tmp_path)
    assert set(contents(tmp_path)) == {"main.wall", "passes.csv", "snapshot.json", "mine.csv"}
    assert (tmp_path.parent / "precious.csv").exists()
    assert (tmp_path / "theirs").is_dir()
    assert json.loads((tmp_path / "snapshot.json").read_text())["number"] == 7
    for damaged in ("", "[]", '{"number": "x", "files": {}}', '{"number": 3, "files": 7}'):
        (tmp_path / "snapshot.json").write_text(damaged)
        snapshot(live, tmp_path)
        assert json.loads((tmp_path / "snapshot.json").read_text())["number"] == 1


def test_no_name_leads_out_of_the_folder(tmp_path):
    live = Live(parse(SENT), clock=Clock())
    for name in ("../../x", "a/b", "a%2Fb", "..\\x"):
        live.append_image(name, [101.0], np.ones((1, 4)))
    (tmp_path / "now").mkdir()
    written = snapshot(live, tmp_path / "now")
    assert {path.name for path in written} == {"image-..%2F..%2Fx.csv", "image-a%2Fb.csv", "image-a%252Fb.csv",
                                               "image-..%5Cx.csv", "snapshot.json"}  # fmt: skip
    assert [path.name for path in tmp_path.iterdir()] == ["now"]


def test_a_bad_image_of_an_older_journal_is_left_out_told_and_stops_no_snapshot(tmp_path, monkeypatch, golden):
    with monkeypatch.context() as older:
        older.setattr(Live, "_image_rows", lambda _live, _name, _rows, values, _unit: values)
        with Live(parse(SENT), tmp_path / "j") as live:
            live.append_image("a\0b", [101.0], np.ones((1, 4)))
            live.append_image("INF", [101.0, 102.0], np.full((2, 4), np.inf), origin="edge", reference="high-side")
            for number in range(100):
                live.receive("mwd", both(number))
    with Live(parse(SENT), tmp_path / "j") as live:
        snapshot(live, tmp_path / "now")
        reported = [event.text for event in live.poll().events]
    names = {"main.wall", "main.las", "image-GR.csv", "image-INF.csv", "passes.csv", "snapshot.json"}
    assert names <= set(contents(tmp_path / "now"))
    assert list(hb.load(tmp_path / "now" / "main.wall").images) == ["GR"]
    golden([text for text in reported if "image" in text])


def test_images_are_sorted_and_laid_when_the_wall_goes_on_already(monkeypatch):
    live = Live(parse(SENT), clock=Clock())
    for number in range(100):
        live.receive("mwd", both(number))
    real, meanwhile = Layout.image, []

    def laid_slowly(*given):
        pushing = threading.Thread(target=live.receive, args=("mwd", both(200)))
        pushing.start()
        pushing.join(PATIENCE)
        meanwhile.append(pushing.is_alive())
        return real(*given)

    monkeypatch.setattr(Layout, "image", laid_slowly)
    kept = frozen_copy(live)
    assert meanwhile == [False]
    assert len(kept.images["GR"][0]) == len(kept.walls["main"].images["GR"].depth) == 100
    assert len(live.images["GR"]) == live.wall.sample_count == len(kept.walls["main"].samples.depth) + 1 == 101


def test_events_are_in_the_snapshot(tmp_path):
    clock = Clock()
    live = Live(parse(SENT), clock=clock)
    for text in (b'a,"b"\r\n', b"&&\r\n!!\r\n", b"late\r\n"):
        clock.step(60)
        live.receive("mwd", text)
    snapshot(live, tmp_path)
    assert table(tmp_path / "events.csv") == [
        {"source": "mwd", "rule": "stray_text", "count": "2", "first_utc": "2023-11-14T22:14:20.000Z",
         "first_connection": "1", "first_line": "1", "first_text": "b'a,\"b\"': text between frames is not read",
         "last_utc": "2023-11-14T22:16:20.000Z", "last_connection": "1", "last_line": "4",
         "last_text": "b'late': text between frames is not read"}
    ]  # fmt: skip


def test_a_gamma_of_one_value_for_the_whole_turn_is_an_image_and_a_column_of_the_logs(tmp_path):
    live = Live(parse(SENT.replace("count = 4", "count = 1")))
    for number in range(1000):
        live.receive("mwd", both(number).replace(b"51101\r", b"5110%d\r" % (50 + number % 2)))
    assert live.images["GR"].sectors == 1
    assert live.image("GR").toolface.shape == (1,)
    snapshot(live, tmp_path)
    assert {row["GR[1]"] for row in table(tmp_path / "image-GR.csv")} == {"50.0", "51.0"}
    wall = hb.load(tmp_path / "main.wall")
    assert set(np.unique(wall.images["GR"].on(wall))) <= {50.0, 51.0}
    with hb.open(tmp_path / "main.las") as opened:
        gamma = opened.set().numbers("GR")
    assert len(gamma) > 10
    assert ((gamma >= 50) & (gamma <= 51)).all()

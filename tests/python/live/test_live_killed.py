"""kill -9 at random instants, of a bare journal and of a live wall under load that rotates, checkpoints and archives.

    writer   ... append -> print | append -> print | append ->  X       what was printed was acknowledged
    reader   every record acknowledged is there, nothing else came between; the wall has the bits of the batch

One kill in four falls while the writer starts and recovers. Only what was added since the last kill is read again, the
whole journal once, at the end. Half of the kills are aimed at a rotation, a checkpoint or the archive.
"""

from __future__ import annotations

import hashlib
import json
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import helibore as hb
from helibore import Live
from helibore.live.journal import journal
from helibore.live.journal.journal import BYTES, segments
from helibore.live.live import read_into
from helibore.live.model.model import Model
from helibore.live.rules.configuration import parse
from helibore.live.wire import wits

START = """
import hashlib, random, sys
from helibore import Live
from helibore.live.rules.configuration import parse
from helibore.live.journal.archived_segments import archive
from helibore.live.journal.checkpoint import paths
from helibore.live.journal.journal import Journal
"""
JOURNAL = (
    START
    + """
with Journal(sys.argv[1], segment_bytes=20000) as j:
    i = int(sys.argv[2])
    print("recovered", flush=True)
    while True:
        j.append(1, 1, b"%d " % i * (i % 50 + 1))
        i += 1
        print(i, flush=True)
"""
)
CONFIGURATION = """
[wall]
bit_diameter = 0.216
start_depth = 100.0
sectors = 16
threads = 1
[journal]
segment_mb = 1
[source.mwd]
address = "host"
units = "metric"
caliper = { first = "5010", groups = 3, order = ["toolface", "depth", "radius"] }
"""
WALL = (
    START
    + """
with Live(parse(sys.argv[3]), sys.argv[1]) as live:
    done = live.model.readers[1].total("bytes")
    wall = live.wall
    print(done, hashlib.sha256(b"".join([wall.radius, wall.nearest, wall.support, wall.depth])).hexdigest(), flush=True)
    draw = random.Random(done)
    live.journal._segment_bytes = 20_000
    with open(sys.argv[2], "rb") as stream:
        stream.seek(done)
        while part := stream.read(draw.choice([1, 37, 100, 1400])):
            if live.journal._stop >= live.journal._segment_bytes:
                print("rotation", flush=True)
            live.receive("mwd", part)
            done += len(part)
            print(done, flush=True)
            if live.checkpoint_due:
                print("checkpoint", flush=True)
                live.checkpoint()
                print("archive", flush=True)
                if len(paths(live.journal.folder)) == 2:
                    archive(live.journal.folder)
"""
)


AIMS = [b"rotation", b"checkpoint", b"archive"]


def kill(code: str, arguments: list[str], draw: random.Random) -> list[bytes]:
    """Run ``code``, kill it at a random instant, or at one of AIMS; return the lines that it printed."""
    writer = subprocess.Popen([sys.executable, "-c", code, *arguments], stdout=subprocess.PIPE)
    assert writer.stdout is not None
    lines = []
    if draw.random() < 0.25:
        time.sleep(draw.uniform(0.05, 0.4))
    else:
        lines.append(writer.stdout.readline())
        if code == WALL and draw.random() < 0.7:
            aim = draw.choice(AIMS) + b"\n"
            while lines[-1] not in (aim, b""):
                lines.append(writer.stdout.readline())
            time.sleep(draw.choice([0.0, draw.uniform(0.0, 0.01)]))
        else:
            time.sleep(draw.uniform(0.0, 0.05))
    writer.send_signal(signal.SIGKILL)
    lines = [line[:-1] for line in lines if line.endswith(b"\n")]
    lines += writer.stdout.read().split(b"\n")[:-1]  # behind the last line end nothing was acknowledged
    writer.stdout.close()
    assert writer.wait() == -signal.SIGKILL
    return lines


def added(folder: Path, first: int) -> tuple[int, list[bytes], list[bytes]]:
    """Payloads of received bytes from segment ``first`` on: the last segment's number, those before it, its own."""
    before: list[bytes] = []
    own: list[bytes] = []
    for segment in segments(folder, first):
        before += own
        rows = np.flatnonzero(segment.records["kind"] == BYTES).tolist()
        own, first = [segment.payload(row) for row in rows], segment.number
        assert segment.damage_texts() == [] or segment.damage[-1][1] == len(segment.text)
    return first, before, own


def kill_journal(folder: Path, kills: int, seed: int) -> tuple[int, int]:
    """Kill the writer of a journal; returns the numbers of records acknowledged and found."""
    draw = random.Random(seed)
    acknowledged, found, first, checked = 0, 0, 1, 0
    for _ in range(kills):
        for line in kill(JOURNAL, [str(folder), str(found)], draw)[1:]:
            acknowledged = max(acknowledged, int(line))
        if journal.paths(folder):
            first, before, own = added(folder, first)
            numbers = [int(payload.split()[0]) for payload in before + own]
            assert numbers == list(range(checked, checked + len(numbers)))
            checked += len(before)
            found = checked + len(own)
        assert found >= acknowledged
    _, before, own = added(folder, 1)
    assert before + own == [b"%d " % i * (i % 50 + 1) for i in range(found)]
    return acknowledged, found


def sent(frames: int) -> tuple[np.ndarray, bytes]:
    """Rows (toolface, depth, radius in mm) of a tool lifted by 2 m again and again, and the frames that say them."""
    i = np.arange(3 * frames)
    depth = 101.0 + i * 5e-4 - 2.0 * (i % 3000 > 2000)
    rows = np.column_stack([i * 22.3 % 360, depth, 110 + 3 * np.sin(i * 0.01)]).round(4)
    texts = [f"{value:.4f}" for value in rows.ravel().tolist()]
    return rows, b"".join(
        wits.frame([(5010 + k, text) for k, text in enumerate(texts[at : at + 9])]) for at in range(0, len(texts), 9)
    )


def bits(wall: hb.Wall) -> bytes:
    return hashlib.sha256(b"".join([wall.radius, wall.nearest, wall.support, wall.depth])).hexdigest().encode()


def kill_wall(folder: Path, kills: int, seed: int, **settings) -> tuple[int, int, int, dict[str, int]]:
    """Kill a live wall, which may have further settings.

    Returns the bytes acknowledged and found, the samples drawn, and how many kills fell where.
    """
    draw = random.Random(seed)
    rows, stream = sent(500 * kills)
    (folder / "stream").write_bytes(stream)
    lines = "".join(f"{name} = {json.dumps(value)}\n" for name, value in settings.items())
    configuration = CONFIGURATION.replace("[journal]", f"{lines}[journal]")
    arguments = [str(folder / "j"), str(folder / "stream"), configuration]
    acknowledged, found, first, checked, rebuilt = 0, 0, 1, 0, b""
    model = Model(parse(configuration))
    fell = {"elsewhere": 0} | {aim.decode(): 0 for aim in AIMS}
    for _ in range(kills):
        lines = kill(WALL, arguments, draw)
        fell[lines[-1].decode() if lines and lines[-1] in AIMS else "elsewhere"] += 1
        lines = [line for line in lines if line not in AIMS]
        if lines and rebuilt:
            assert lines[0].split() == [b"%d" % found, rebuilt]  # what was recovered is what the journal gives
        for line in lines:
            acknowledged = max(acknowledged, int(line.split()[0]))
        if not journal.paths(folder / "j"):
            continue
        first, before, own = added(folder / "j", first)
        assert b"".join(before + own) == stream[checked : checked + sum(map(len, before + own))]
        checked += sum(map(len, before))
        found = checked + sum(map(len, own))
        assert acknowledged <= found < len(stream)
        for _ in read_into(model, folder / "j"):  # only what came since the last kill
            pass
        rebuilt = bits(model.layers["main"])
    again = Live.replay(folder / "j")
    assert bits(again.wall) == rebuilt
    kept = again.wall.samples
    complete = stream[:found].count(b"!!\r\n")  # a frame ends with its line
    given = np.column_stack([kept.toolface, kept.depth, kept.radius])
    expected = rows[: 3 * complete] * [1.0, 1.0, 0.001]
    np.testing.assert_array_equal(given[np.lexsort(given.T)], expected[np.lexsort(expected.T)])
    assert bits(hb.reconstruct(kept, bit_diameter=0.216, start_depth=100.0, sectors=16, **settings)) == rebuilt
    return acknowledged, found, len(kept.depth), fell


def test_a_journal_killed_at_random_instants_has_every_acknowledged_record(tmp_path):
    acknowledged, found = kill_journal(tmp_path, 6, seed=3)
    assert found >= acknowledged > 6


def test_a_live_wall_killed_under_load_recovers_and_has_the_bits_of_the_batch(tmp_path):
    acknowledged, found, samples, _ = kill_wall(tmp_path, 6, seed=7)
    assert found >= acknowledged > 0
    assert samples > 6


def test_a_live_wall_with_the_settings_that_automatic_found_recovers_with_the_bits_of_the_batch(tmp_path):
    depth = np.tile(np.arange(0.0, 20.0, 0.1), 4)
    toolface = (9.0 * depth + np.repeat([0, 90, 180, 270], 200)) % 360
    off = np.random.default_rng(3).normal(0, 2e-4, depth.size)
    earlier = hb.Caliper(depth, toolface, 0.11 + 0.004 * np.cos(2 * np.radians(toolface - 40)) + off)
    found = hb.reconstruct(earlier, bit_diameter=0.216, estimator="automatic", threads=1).settings
    assert found.estimator == "near-and-far"
    names = ("estimator", "covariance", "neighbors", "max_distance")
    acknowledged, _, samples, _ = kill_wall(tmp_path, 3, 11, **{name: getattr(found, name) for name in names})
    assert acknowledged > 0
    assert samples > 6

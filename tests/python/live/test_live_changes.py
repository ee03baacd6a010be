"""A new configuration in a running journal: at once, at a time, or at a hole depth; the same bits at a replay."""

from __future__ import annotations

import datetime
import socket

import pytest
from live_servers import configured, frames, free_port, until
from live_wires import FRAMES, SENT, WALL, Clock, refused, same_bits

from helibore import Live
from helibore.live.journal.journal import BYTES, CLOSED, CONNECTED, JournalFullError, segments
from helibore.live.journal.journal_extracts import sessions
from helibore.live.rules.configuration import load, parse
from helibore.live.server import Server

TURNED = SENT.replace("order =", "toolface_offset = 90.0, order =").replace("0.216", "0.2")
RIG = (
    WALL + '[source.rig]\naddress = "host"\nunits = "metric"\nitems = { bit_depth = "0108", hole_depth = "0110" }\n'
    'caliper = { toolface = ["5010"], radius = ["5012"], offset = OFFSET }\n'
)


def halves(folder, clock):
    """A wall whose configuration changes after half of the frames, in one session."""
    live = Live(parse(SENT), folder, clock=clock)
    for number, frame in enumerate(FRAMES):
        if number == 100:
            live.receive("mwd", frame[:20])
            update = live.reconfigure(parse(TURNED))
            assert [event.rule for event in update.events] == ["configuration"]
            frame = frame[20:]  # a frame that began before the change is read to its end
        clock.step(1.0)
        live.receive("mwd", frame)
    return live


def test_a_change_applies_from_the_next_record_on_without_a_restart(tmp_path):
    clock = Clock()
    with halves(tmp_path, clock) as live:
        assert live.wall.sample_count == 600
        assert [stretch["configuration"] for stretch in live.model.stretches] == [TURNED]
        path = live.checkpoint()
    expected = Live(parse(SENT), clock=Clock())
    for frame in FRAMES[:100]:
        expected.receive("mwd", frame)
    turned = Live(parse(TURNED), clock=Clock())
    for frame in FRAMES[100:]:
        turned.receive("mwd", frame)
    before, after = expected.wall.samples, turned.wall.samples
    pairs = sorted([*zip(before.depth, before.toolface, strict=True), *zip(after.depth, after.toolface, strict=True)])
    assert sorted(zip(live.wall.samples.depth, live.wall.samples.toolface, strict=True)) == pairs
    assert same_bits(Live.replay(tmp_path).wall, live.wall)
    assert [text for _, text in sessions(tmp_path)] == [SENT, TURNED]
    for expected_text in (TURNED, SENT):  # a restart goes on with the last one, or with the one that is given
        with Live(parse(expected_text), tmp_path, clock=clock) as again:
            assert same_bits(again.wall, live.wall)
            assert again.model.configuration.text == expected_text
        path.unlink(missing_ok=True)


def test_a_change_does_not_move_the_clock(tmp_path):
    clock = Clock()
    live = Live(parse(SENT), tmp_path, clock=clock)
    clock.wall += 3600 * 10**9
    live.receive("mwd", FRAMES[0])
    now = live.model.clock.now
    clock.step(1.0)
    live.reconfigure(parse(TURNED))
    assert live.model.clock.now == now + 10**9
    live.close()


@pytest.mark.parametrize(
    ("text", "error"),
    [
        (SENT.replace("sectors = 16", "sectors = 8"), "was begun with another configuration (wall.sectors = 8, was "
         "16); give the old configuration, or begin another journal"),
        (SENT + '[source.x]\naddress = "host"\nunits = "fps"\n',
         "source.x: a source can be added or removed only by a restart"),
    ],
)  # fmt: skip
def test_what_a_running_journal_cannot_change_is_refused_and_changes_nothing(tmp_path, text, error):
    with Live(parse(SENT), tmp_path) as live:
        with pytest.raises(ValueError) as raised:  # noqa: PT011 (the text is compared below)
            live.reconfigure(parse(text))
        assert str(raised.value) in (error, f"{tmp_path}: {error}")
        assert live.configuration.text == SENT
        assert live.model.next_sequence == 0 or not live.model.stretches


def test_a_change_that_the_disk_refuses_changes_nothing(tmp_path, monkeypatch):
    with Live(parse(SENT), tmp_path) as live:
        with monkeypatch.context() as patch:
            patch.setattr("os.pwritev", lambda *_: (_ for _ in ()).throw(OSError(28, "No space left on device")))
            with pytest.raises(JournalFullError):
                live.reconfigure(parse(TURNED))
        live.journal._segment_bytes = 1
        live.receive("mwd", FRAMES[0])  # a new segment, which begins with the old configuration
        assert not live.model.stretches
    assert [text for _, text in sessions(tmp_path)] == [SENT]


def planned(folder, plan):
    """The files of two configurations; the first names the second in ``next``."""
    (folder / "one.toml").write_text(f'[next]\nfile = "two.toml"\n{plan}\n' + RIG.replace("OFFSET", "0.0"))
    (folder / "two.toml").write_text(RIG.replace("OFFSET", "5.0"))
    return load(folder / "one.toml")


def frame(hole, toolface=10.0):
    return b"&&\r\n0108%.2f\r\n0110%.2f\r\n5010%.1f\r\n5012110\r\n!!\r\n" % (hole, hole, toolface)


@pytest.mark.parametrize("by", ["hole_depth", "time"])
def test_the_next_configuration_begins_at_its_hole_depth_or_time(tmp_path, by):
    clock = Clock()
    due = datetime.datetime.fromtimestamp(clock.wall / 1e9 + 10, datetime.UTC).isoformat()
    given = planned(tmp_path, "hole_depth = 130.0" if by == "hole_depth" else f"time = {due}")

    def drill(server, holes):
        for hole in holes:
            clock.step(1.0)
            server._change_if_due()  # the watch thread does this
            stored = server.live.store("rig", 1, frame(hole), 0)
            server.live.draw([*server._queue.take(0), stored])

    with Live(given, tmp_path / "j", clock=clock) as live:
        drill(Server(live), [128.0, 129.0, 129.9, *([129.9] * 6), 130.0, 131.0, 132.0])
        (stretch,) = live.model.stretches
        assert stretch["configuration"] == (tmp_path / "two.toml").read_text()
        depths = live.wall.samples.depth.tolist()
    assert max(depths) == (130.0 if by == "hole_depth" else 129.9)  # then the offset of 5 m
    assert {126.0, 127.0} <= set(depths)
    assert same_bits(Live.replay(tmp_path / "j").wall, live.wall)
    with Live(given, tmp_path / "j", clock=clock) as again:  # the first file is given again: the plan is due at once
        server = Server(again)
        drill(server, [133.0, 134.0])
        assert again.configuration.text == (tmp_path / "two.toml").read_text()
        assert {128.0, 129.0} <= set(again.wall.samples.depth.tolist())
        assert 133.0 not in again.wall.samples.depth.tolist()


def test_a_reload_may_state_in_its_next_file_the_estimator_that_its_own_file_leaves_out(tmp_path):
    given = planned(tmp_path, "hole_depth = 130.0")
    two = tmp_path / "two.toml"
    with Live(given, tmp_path / "j") as live:
        two.write_text(two.read_text().replace("[wall]", '[wall]\nestimator = "inverse-distance"'))
        server = Server(live)
        server.reconfigure(load(tmp_path / "one.toml"))
        two.write_text(two.read_text().replace("inverse-distance", "automatic"))
        with pytest.raises(ValueError, match=r"was begun with another configuration \(wall\.estimator"):
            server.reconfigure(load(tmp_path / "one.toml"))


@pytest.mark.parametrize(
    ("text", "place", "rule", "value"),
    [
        ('file = "two.toml"\n', "next", "either hole_depth or time must be set, and not both", None),
        ('file = "two.toml"\ntime = "2026-05-01"\n', "next.time", "a date and time without quotes", "'2026-05-01'"),
        ('file = "two.toml"\ntime = 2026-05-01T10:00:00\n', "next.time", "have a time zone", "2026-05-01 10:00:00"),
        ("hole_depth = 1.0\n", "next.file", "is missing", None),
    ],
)
def test_a_wrong_plan_is_named(text, place, rule, value):
    found = refused(f"[next]\n{text}" + RIG.replace("OFFSET", "0.0"))
    assert (found[0], found[2]) == (place, value)
    assert rule in found[1]


def test_a_plan_without_a_hole_depth_that_follows_itself_or_cannot_be_begun_never_starts(tmp_path):
    beyond = refused('[next]\nfile = "x"\nhole_depth = 9.0\n' + SENT)
    assert beyond == ("next.hole_depth", "no source maps hole_depth", "9")
    given = planned(tmp_path, "hole_depth = 130.0")
    (tmp_path / "two.toml").write_text((tmp_path / "one.toml").read_text().replace("two", "one"))
    with pytest.raises(ValueError, match=r"^next.file = '.*one.toml': must not occur twice in a chain of next files$"):
        given.following()
    (tmp_path / "two.toml").write_text((tmp_path / "one.toml").read_text().replace("two", f"../{tmp_path.name}/two"))
    with pytest.raises(ValueError, match=r"^next.file = '.*two.toml': must not occur twice in a chain of next files$"):
        given.following()
    (tmp_path / "two.toml").write_text(RIG.replace("OFFSET", "5.0").replace("sectors = 16", "sectors = 8"))
    with pytest.raises(ValueError, match=r"\(wall.sectors = 8, was 16\); give the old configuration"):
        Server(Live(given))


def test_a_server_changes_while_bytes_come(tmp_path):
    port = free_port()
    text = configured(f"listen://127.0.0.1:{port}")
    live = Live(parse(text), tmp_path)
    server = Server(live)
    server.start()
    try:
        with socket.create_connection(("127.0.0.1", port)) as sender:
            sender.sendall(frames(1)[0])
            until(lambda: live.wall.sample_count == 1)
            server.reconfigure(parse(text.replace('radius = ["5012"]', 'radius = ["5012"], toolface_offset = 90.0')))
            sender.sendall(frames(1, 1)[0])
            until(lambda: live.wall.sample_count == 2)
        assert live.wall.samples.toolface.tolist() == [0.0, 127.0]
    finally:
        server.stop()
        live.close()
    assert server.failure is None
    assert same_bits(Live.replay(tmp_path).wall, live.wall)


def events(live):
    return {event.rule: event.newest.text for event in live.model.events.latest}


def test_a_server_connects_a_source_at_its_new_address_and_says_so(tmp_path):
    first, second = free_port(), free_port()
    text = configured(f"tcp://127.0.0.1:{first}")  # nobody listens there
    live = Live(parse(text), tmp_path)
    server = Server(live)
    server.start()
    try:
        until(lambda: server.states["mwd"].startswith("waiting to connect"))
        with socket.create_server(("127.0.0.1", second)) as rig:
            moved = f"tcp://127.0.0.1:{second}"
            server.reconfigure(parse(configured(moved)))
            assert events(live)["address"] == f"the source is now at {moved}"
            sender, _ = rig.accept()
            with sender:
                sender.sendall(frames(1)[0])
                until(lambda: live.wall.sample_count == 1)
                server.reconfigure(parse(configured(f"listen://127.0.0.1:{first}")))
                assert sender.recv(1) == b""  # the old link is closed
        with socket.create_connection(("127.0.0.1", first)) as sender:
            sender.sendall(frames(1, 1)[0])
            until(lambda: live.wall.sample_count == 2)
    finally:
        server.stop()
        live.close()
    assert server.failure is None
    assert live.model.events.counts["mwd", "address"] == 2
    kinds = [(int(row["kind"]), int(row["connection"])) for one in segments(tmp_path) for row in one.records]
    assert [kind for kind in kinds if kind[1]] == [(CONNECTED, 1), (BYTES, 1), (CLOSED, 1), (CONNECTED, 2), (BYTES, 2),
                                                   (CLOSED, 2)]  # fmt: skip
    assert same_bits(Live.replay(tmp_path).wall, live.wall)


def test_an_address_that_cannot_be_used_leaves_the_source_at_the_old_one(tmp_path):
    port = free_port()
    live = Live(parse(configured(f"listen://127.0.0.1:{port}")), tmp_path)
    server = Server(live)
    server.start()
    try:
        with socket.create_server(("127.0.0.1", 0)) as taken:
            other = taken.getsockname()[1]
            server.reconfigure(parse(configured(f"listen://127.0.0.1:{other}")))
        assert events(live)["address"] == (
            f"127.0.0.1 port {other}: Address already in use; give another address of [source.mwd]; until a restart, "
            "the source stays at its old address"
        )
        with socket.create_connection(("127.0.0.1", port)) as sender:
            sender.sendall(frames(1)[0])
            until(lambda: live.wall.sample_count == 1)
    finally:
        server.stop()
        live.close()


def test_what_takes_effect_at_a_restart_only_is_said(tmp_path, golden):
    text = configured("tcp://127.0.0.1:9")
    live = Live(parse(text), tmp_path)
    server = Server(live)
    server.start()
    try:
        server.reconfigure(parse(text.replace('units = "metric"', 'units = "metric"\nmode = "poll"') +
                                 "[alarms]\nlost = 60.0\n"))  # fmt: skip
        golden(events(live)["restart"])
        server.reconfigure(parse(text))  # as it began
        assert live.model.events.counts["", "restart"] == 1
    finally:
        server.stop()
        live.close()

"""An ETP 1.2 server of our own: what it sends is drawn, nothing is lost by a kill, and bad input has a sentence."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("fastavro", reason="ETP needs fastavro")
pytest.importorskip("websockets", reason="ETP needs websockets")

from etp_server import Server
from live_servers import Running, free_port, payloads, until
from live_wires import WALL, Clock

from helibore import Live
from helibore.live import server as server_module
from helibore.live.rules.configuration import parse
from helibore.live.wire.etp_link import encoded, framed

SETTINGS = (
    WALL
    + '[source.rig]\naddress = "ws://127.0.0.1:PORT/etp"\nordered_by = "depth"\n'
    + 'uris = ["eml:///witsml20.ChannelSet(c)"]\n'
    + 'caliper = { toolface = ["TF"], radius = ["RAD"] }\n'
)


@pytest.fixture
def server():
    made = Server()
    yield made
    made.stop()


def settings(server, extra=""):
    return SETTINGS.replace("PORT", str(server.port)) + extra


def numbers(live):
    """The numbers of the drawn samples."""
    return sorted(np.rint((live.wall.samples.depth - 100) * 1000).astype(int).tolist())


def test_what_a_server_sends_is_drawn_and_replayed(server, tmp_path):
    server.count = 300
    with Running(settings(server), tmp_path) as running:
        until(lambda: running.live.wall.sample_count == 300)
        server.count = 500
        until(lambda: running.live.wall.sample_count == 500)
        assert running.server.states["rig"] == f"connected to 127.0.0.1:{server.port}"
    assert numbers(running.live) == list(range(500))
    samples = running.live.wall.samples
    number = np.rint((samples.depth - 100) * 1000).astype(int)
    assert np.array_equal(samples.toolface, number * 37 % 360)
    assert np.allclose(samples.radius, 0.11 + 0.001 * (number % 3))
    again = Live.replay(tmp_path)
    assert np.array_equal(again.wall.radius, running.live.wall.radius, equal_nan=True)
    assert all(payload.startswith(b"etp ") for payload in payloads(tmp_path))


@pytest.mark.parametrize("backfills", [True, False], ids=["from the index asked", "only new values"])
def test_a_new_connection_goes_on_where_the_last_ended(server, tmp_path, backfills):
    server.backfills = backfills
    with Running(settings(server), tmp_path) as running:
        until(lambda: server.subscriptions == 1)
        server.count = 200
        until(lambda: running.live.wall.sample_count == 200)
    server.count = 350
    with Running(settings(server), tmp_path) as again:
        until(lambda: server.subscriptions == 2)
        server.count = 400
        until(lambda: again.live.wall.sample_count >= 400)
        until(lambda: again.live.model.readers[1].position()["RAD"] == pytest.approx(100.399))
        assert numbers(again.live) == list(range(400))
    assert numbers(Live.replay(tmp_path)) == list(range(400))


def test_a_damaged_message_is_kept_said_and_asked_for_again(server, tmp_path):
    server.damaged = {100}
    server.count = 100
    with Running(settings(server), tmp_path) as running:
        until(lambda: running.count("damaged", "rig") == 1)
        until(lambda: running.live.wall.sample_count == 100)
        assert any("damaged message" in line for line in running.reported())
    assert numbers(running.live) == list(range(100))


def test_values_that_wait_are_read_without_the_channel_that_ended(server):
    live, clock = _live("wait = 3.0\n")
    _send(live, _metadata(server), _data({"TF": [1, 2], "RAD": [1]}))
    assert numbers(live) == [1]
    clock.step(4)
    _send(live, _data({"TF": [3], "RAD": [3]}))
    assert numbers(live) == [1, 3]
    assert live.model.events.counts["rig", "flag"] == 0
    assert live.model.counts["flag NULL"] == 1


def test_a_message_cut_by_records_is_read_whole(server):
    live, _ = _live()
    whole = b"".join(framed(one) for one in (_metadata(server), _data({"TF": [1, 2], "RAD": [1, 2]})))
    for start in range(0, len(whole), 37):
        live.receive("rig", whole[start : start + 37], 1)
    assert numbers(live) == [1, 2]


def test_a_value_that_comes_again_is_not_drawn_twice(server):
    live, _ = _live()
    _send(live, _metadata(server), _data({"TF": [1, 2], "RAD": [1, 2]}), _data({"TF": [1, 2], "RAD": [1, 2]}))
    assert numbers(live) == [1, 2]
    live.receive("rig", framed(_metadata(server)) + framed(_data({"TF": [2, 3], "RAD": [2, 3]})), 2)
    assert numbers(live) == [1, 2, 3]


def test_old_values_alone_begin_an_alarm(server):
    live, clock = _live()
    _send(live, _metadata(server), _data({"TF": [900], "RAD": [900]}))
    for number in range(100):
        clock.step(1)
        _send(live, _data({"TF": [number], "RAD": [number]}))
    assert "set back" in live.model.readers[1].doubts["behind"]
    _send(live, _data({"TF": [901], "RAD": [901]}))
    assert "behind" not in live.model.readers[1].doubts


@pytest.mark.parametrize(
    ("change", "rule"),
    [
        ({"units": ["dega", "bar", "m"]}, "unit"),
        ({"index_kind": "DateTime"}, "index"),
        ({"direction": "Decreasing"}, "index"),
    ],
)
def test_metadata_that_do_not_fit_are_said(server, change, rule):
    for name, value in change.items():
        setattr(server, name, value)
    live, _ = _live()
    _send(live, _metadata(server), _data({"TF": [1], "RAD": [1]}))
    assert live.model.events.counts["rig", rule]
    assert numbers(live) == []


def test_a_channel_that_is_missing_is_said_with_those_that_are_there(server):
    server.names = ["TF", "R1", "MD"]
    live, _ = _live()
    _send(live, _metadata(server), _data({"TF": [1]}))
    lacking = live.model.readers[1].lacking()
    assert "radius (channel RAD)" in lacking
    assert "R1" in lacking


def test_a_replaced_range_and_a_truncated_channel_are_said(server):
    live, _ = _live()
    interval = {"startIndex": {"item": 100.0}, "endIndex": {"item": 101.0}, "uom": "m", "depthDatum": ""}
    replaced = encoded(
        "RangeReplaced", {"changeTime": 0, "channelIds": [0], "changedInterval": interval, "data": []}, 9
    )
    ended = encoded("ChannelsTruncated", {"changeTime": 0, "channels": [
        {"channelId": at, "newEndIndex": {"item": 100.001}} for at in (0, 1)]}, 9)  # fmt: skip
    _send(live, _metadata(server), _data({"TF": [1, 5], "RAD": [1, 5]}))
    _send(live, replaced, ended)
    assert live.model.events.counts["rig", "replaced"] == 1
    assert live.model.events.counts["rig", "truncated"] == 2
    _send(live, _data({"TF": [3], "RAD": [3]}))
    assert numbers(live) == [1, 3, 5]


@pytest.mark.parametrize("payload", [b"etp", b"no such line\n", b"etp 4\nabcd", b"\0" * 100, b"etp 99999999\nx"])
def test_bytes_that_are_no_message_stop_nothing(server, payload):
    live, _ = _live()
    live.receive("rig", payload, 1)
    live.receive("rig", framed(_metadata(server)) + framed(_data({"TF": [1], "RAD": [1]})), 2)
    assert numbers(live) == [1]


def _live(extra=""):
    clock = Clock()
    return Live(parse(SETTINGS.replace("PORT", "9002") + extra), clock=clock), clock


def _send(live, *messages):
    live.receive("rig", b"".join(map(framed, messages)), 1)


def _metadata(server):
    channels = {str(at): server._described(at, name) for at, name in enumerate(server.names)}
    return encoded("GetChannelMetadataResponse", {"metadata": channels}, 3)


def _data(values):
    items = [Server._item(Plain, ("TF", "RAD").index(name), number) for name, of in values.items() for number in of]
    return encoded("ChannelData", {"data": items}, 5)


class Plain:
    names = ("TF", "RAD")


def test_a_wrong_token_is_asked_once_and_in_no_file(server, tmp_path, monkeypatch):
    server.token = "right-words"
    monkeypatch.setenv("RIG_TOKEN", "secret-words")
    with Running(settings(server, 'token_env = "RIG_TOKEN"\n'), tmp_path) as running:
        until(lambda: running.server.states["rig"] == "stopped: access denied")
        assert running.count("access", "rig") == 1
        assert any("token_env" in line for line in running.reported())
    assert server.asked == ["Bearer secret-words"]
    assert not any(b"secret-words" in path.read_bytes() for path in tmp_path.iterdir() if path.is_file())


def test_a_right_token_and_a_user_are_sent(server, tmp_path, monkeypatch):
    monkeypatch.setenv("RIG_SECRET", "secret-words")
    server.token, server.count = "secret-words", 5
    with Running(settings(server, 'token_env = "RIG_SECRET"\n'), tmp_path / "a") as running:
        until(lambda: running.live.wall.sample_count == 5)
    server.token = ""
    with Running(settings(server, 'user = "u"\npassword_env = "RIG_SECRET"\n'), tmp_path / "b") as running:
        until(lambda: running.live.wall.sample_count == 5)
    assert server.asked[1:] == ["Basic dTpzZWNyZXQtd29yZHM="]


def _refuses(server):
    server.refuse = "no role for secret-words"


def _lacks(server):
    server.protocols = [3]


def _other(server):
    server.names = ["A", "B", "C"]


def _long(server):
    server.extra = [b"x" * 3000]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (_refuses, "session: the server refuses: no role for "),
        (_lacks, "address: the server has no protocol 21"),
        (_other, "uris: no channel is one that the settings name; its channels: A, B, C"),
        (_long, "message_kb: a message is longer than 2 kB"),
    ],
)
def test_what_a_server_refuses_names_the_setting(server, tmp_path, monkeypatch, change, words):
    monkeypatch.setenv("RIG_TOKEN", "secret-words")
    change(server)
    with Running(settings(server, 'token_env = "RIG_TOKEN"\nmessage_kb = 2\n'), tmp_path) as running:
        until(lambda: running.count("link", "rig"))
        until(lambda: any(words in line for line in running.reported()))
        assert running.server.states["rig"].startswith(("waiting to connect", "connect"))
        assert "secret-words" not in str(running.reported())


def test_a_server_of_another_version_is_named(tmp_path):
    server = Server(version="energistics-tp")
    try:
        with Running(settings(server), tmp_path) as running:
            until(lambda: running.count("link", "rig"))
            assert any("address: " in line and "ETP 1.2" in line for line in running.reported())
    finally:
        server.stop()


def test_a_server_that_asks_to_wait_is_left_alone(server, tmp_path):
    server.status, server.wait = 429, "3600"
    with Running(settings(server), tmp_path) as running:
        until(lambda: running.server.states["rig"].endswith("asked to wait for 3600 s"))
        time.sleep(1.0)
        assert len(server.asked) == 1
        assert running.count("link", "rig") == 1


@pytest.mark.parametrize("status", [404, 500])
def test_a_server_that_fails_is_asked_once_in_each_wait(server, tmp_path, monkeypatch, status):
    waits = []
    monkeypatch.setattr(server_module, "back_off", lambda failures, _: waits.append(failures) or 0.01)
    server.status = status
    with Running(settings(server), tmp_path) as running:
        until(lambda: len(waits) >= 4)
        assert any(f"answered {status}" in line for line in running.reported())
        assert any("address" in line for line in running.reported()) == (status == 404)
    assert waits == list(range(1, len(waits) + 1)), "each longer than the one before"
    assert len(server.asked) <= len(waits) + 1


def test_a_server_that_is_not_there_is_named(tmp_path):
    with Running(SETTINGS.replace("PORT", str(free_port())), tmp_path / "a") as running:
        until(lambda: running.count("link", "rig"))
        assert running.server.states["rig"].startswith("waiting to connect")


PROGRAM = """
import sys, time
from helibore import Live
from helibore.live.rules.configuration import parse
from helibore.live.server import Server
live = Live(parse(sys.argv[1]), sys.argv[2])
server = Server(live)
server.start()
print("up", flush=True)
time.sleep(600)
"""


def _begun(command):
    process = subprocess.Popen(command, stdout=subprocess.PIPE)
    assert process.stdout
    assert process.stdout.readline().startswith(b"up")
    return process


def _killed(process):
    process.kill()
    process.wait()
    process.stdout.close()


def test_kills_of_helibore_and_of_the_server_lose_nothing(tmp_path):
    port, count, since = free_port(), 3000, tmp_path / "since"
    since.write_text("")
    script = str(Path(__file__).parent / "etp_server.py")
    serves = [sys.executable, script, str(port), "1000", str(count), "--begun", str(since)]
    draws = [sys.executable, "-c", PROGRAM, SETTINGS.replace("PORT", str(port)), str(tmp_path / "j")]
    server, program = _begun(serves), _begun(draws)
    for _ in range(2):
        time.sleep(0.5)
        _killed(program)
        program = _begun(draws)
        time.sleep(0.5)
        _killed(server)
        server = _begun(serves)
    _killed(program)
    with Running(SETTINGS.replace("PORT", str(port)), tmp_path / "j") as last:
        until(lambda: last.live.wall.sample_count >= count)
        assert numbers(last.live) == list(range(count))
    _killed(server)
    again = Live.replay(tmp_path / "j")
    assert np.array_equal(again.wall.radius, last.live.wall.radius, equal_nan=True)

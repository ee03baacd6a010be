"""Alarms: each begins and ends when its cause does, is delivered, and delays nothing."""

from __future__ import annotations

import base64
import contextlib
import fcntl
import http.server
import io
import json
import math
import os
import queue
import resource
import signal
import socket
import struct
import subprocess
import sys
import termios
import threading
import time
import urllib.request
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from live_servers import Running, configured, frames, free_port, until
from live_wires import SECOND, WALL, Clock, refused
from patience import PATIENCE

from helibore import Live
from helibore.base.errors import InputError
from helibore.live import alarms as module
from helibore.live.alarms import Alarm, Alarms
from helibore.live.journal.journal import Journal
from helibore.live.rules.configuration import parse
from helibore.live.server import TICK
from helibore.live.wire import wits

HOST = WALL + '[source.mwd]\naddress = "host"\nunits = "metric"\nsilence = 60.0\n'
STATES = {"mwd": "connected to rig"}


def alarmed(text, folder=None, states=STATES):
    clock = Clock()
    live = Live(parse(text), folder, clock=clock)
    return live, clock, Alarms(live, states)


def thread(name, run):
    return threading.Thread(target=run, name=name, daemon=True)


def rules(alarms):
    return [(alarm.rule, alarm.source) for alarm in alarms.active]


def texts(live):
    return {event.rule: event.newest.text for event in live.model.events.latest}


def test_no_data_is_an_alarm_from_its_begin_to_its_end(golden):
    live, clock, alarms = alarmed(HOST)
    clock.step(60)
    alarms.check()
    assert alarms.active == []
    clock.step(1)
    alarms.check()
    alarms.check()
    assert rules(alarms) == [("no_data", "mwd")]
    assert str(alarms.active[0]).startswith("no data mwd: nothing has come for 60 s, since 22:14:21 UTC")
    clock.step(10)
    live.receive("mwd", frames(1)[0])
    alarms.check()
    assert alarms.active == []
    assert texts(live)["alarm_no_data"] == "nothing has come for 60 s"
    golden(texts(live)["alarm_no_data_end"])
    assert alarms.counts == {("no_data", "mwd"): 1}


@pytest.mark.parametrize(
    ("items", "alarms"),
    [
        ({108: 118, 120: 0}, False), ({108: 118}, False), ({108: 118, 107: 3, 120: 40}, False),
        ({108: 118, 107: 9, 120: 60}, False),
        ({108: 120, 107: 3, 120: 0}, False), ({108: 120, 120: 0}, True), ({108: 118, 120: 60}, True),
        ({108: 118, 107: 7, 120: 0}, True),
    ],
    ids=["off bottom", "turns?", "in slips", "tripped", "in slips at once", "sliding", "backreamed", "circulating"],
)  # fmt: skip
def test_a_tool_may_be_silent_while_its_pumps_may_be_off(items, alarms):
    rig = '[source.rig]\naddress = "host"\nunits = "metric"\nsilence = 60.0\n'
    rig += 'items = { bit_depth = "0108", hole_depth = "0110", activity = "0107", rotation = "0120" }\n'
    caliper = 'caliper = { toolface = ["5010"], radius = ["5012"], offset = 4.0 }\n'
    live, clock, found = alarmed(HOST + caliper + rig, None, STATES | {"rig": "connected"})
    for _ in range(9):
        live.receive("rig", wits.frame([(110, "120"), *((item, str(value)) for item, value in items.items())]))
        found.check()
        clock.step(10)
    found.check()
    assert rules(found) == [("no_data", "mwd")] * alarms
    if alarms:
        live.receive("rig", wits.frame([(110, "120"), (108, "112"), (107, "3"), (120, "0")]))
        found.check()
        assert rules(found) == [("no_data", "mwd")], "it was due before the string was lifted"
    live.receive("rig", wits.frame([(110, "120"), (108, "120"), (107, "2"), (120, "60")]))
    clock.step(50)
    found.check()
    assert ("no_data", "mwd") not in rules(found) or alarms, "the tool is due from now on"
    clock.step(20)
    found.check()
    assert rules(found)[-1] == ("no_data", "rig") or rules(found)[-1] == ("no_data", "mwd")
    assert ("no_data", "mwd") in rules(found)


def test_the_alarm_of_stuck_sensors_names_all_of_them_as_they_stop():
    four = "caliper = { toolface = ['5010'], radius = ['5012', '5013', '5014', '5015'], "
    live, clock, found = alarmed(
        HOST
        + 'items = { bit_depth = "0108" }\n'
        + four
        + "toolface_offset = [0.0, 90.0, 180.0, 270.0], offset = 4.0 }\n"
    )
    said = []
    for row in range(900):
        clock.step(1)
        radii = [(5012 + one, f"{108 + one + (row < 600 + 10 * one) * 0.001 * (row % 97):.3f}") for one in range(4)]
        live.receive("mwd", wits.frame([(5010, str(row * 37 % 360)), *radii]))
        found.check()
        said += [one.text.partition(" constant")[0] for one in found.active if one.rule == "stays"]
    assert list(dict.fromkeys(said)) == ["radius 1", "radius 1, 2", "radius 1, 2, 3", "all radii"]
    assert found.counts["stays", "mwd"] == 1


def test_a_source_that_is_not_connected_is_lost_after_its_time_and_at_once_if_it_stopped():
    states = {"mwd": "listening"}
    _, clock, alarms = alarmed(HOST.replace("host", "listen://127.0.0.1:1") + "[alarms]\nlost = 20.0\n", None, states)
    for seconds, state, expected in [
        (20, "listening", []), (1, "listening", [("lost", "mwd")]), (1, "connected to rig", []),
        (19, "waiting to connect", []), (0, "stopped: access denied", [("lost", "mwd")]), (0, "ended", []),
    ]:  # fmt: skip
        states["mwd"] = state
        clock.step(seconds)
        alarms.check()
        assert rules(alarms) == expected, state
        if state.startswith("stopped"):
            assert alarms.active[0].text == "stopped: access denied"  # not for 20 s yet


def test_depth_that_stands_while_samples_come_is_an_alarm():
    text = HOST + 'items = { bit_depth = "0108" }\ncaliper = { toolface = ["5010"], radius = ["5012"] }\n'
    live, clock, alarms = alarmed(text + "[alarms]\nstanding = 30.0\n")

    def send(depth, number):
        live.receive("mwd", b"&&\r\n5004%d\r\n0108%.3f\r\n501010\r\n5012110\r\n!!\r\n" % (number, depth))
        alarms.check()

    for number in range(4):
        clock.step(10)
        send(110.0 + number % 2 * 0.005, number)
        assert alarms.active == []
    clock.step(10)
    send(110.0, 5)
    assert rules(alarms) == [("standing", "")]
    send(110.5, 6)
    assert alarms.active == []
    clock.step(40)
    alarms.check()  # no sample comes: this is not standing
    assert rules(alarms) == []


def test_samples_that_are_all_refused_are_an_alarm_until_one_is_usable():
    text = HOST + 'caliper = { toolface = ["5010"], depth = ["5011"], radius = ["5012"] }\n'
    live, clock, alarms = alarmed(text + "[alarms]\nrefused = 30.0\n")

    def send(seconds, radius, depth=110.0):
        clock.step(seconds)
        live.receive(
            "mwd", b"&&\r\n501010\r\n5011%.3f\r\n5012%.4f\r\n!!\r\n" % (depth + clock.wall % 997 / 1e3, radius)
        )
        alarms.check()

    send(1, 110)
    send(1, 4.33)  # inches, as millimetres
    clock.step(300)
    alarms.check()
    assert rules(alarms) == [("no_data", "mwd")]  # one wrong sample, and then silence
    send(1, 110)
    for _ in range(4):
        send(10, 4.33)
    assert rules(alarms) == []
    send(1, -9999)
    assert rules(alarms) == [("refused", "mwd")]
    expected = (
        "no sample was usable for 30 s: 4 depth or radius out of range, 1 no value: another unit or diameters come "
        "(caliper.radius_unit, caliper.measures), or the hole is as wide (caliper.radius_range, depth.depth_range)"
    )
    assert texts(live)["alarm_refused"] == expected
    send(1, 110)
    assert rules(alarms) == []
    for _ in range(5):
        send(10, 110, 50.0)
    assert "5 before the start of the wall" in texts(live)["alarm_refused"]


def test_items_that_never_come_are_an_alarm_that_names_those_that_do():
    items = 'items = { bit_depth = "0108" }\n'
    live, clock, alarms = alarmed(HOST + items + 'caliper = { toolface = ["5010"], radius = ["5012"] }\n')

    def send(frame):
        clock.step(50)
        live.receive("mwd", frame)
        alarms.check()

    for _ in range(3):
        send(b"&&\r\n0108110\r\n08445\r\n501010\r\n!!\r\n")
        assert rules(alarms) == []
    send(b"&&\r\n0108110\r\n081140\r\n501010\r\n!!\r\n")
    assert rules(alarms) == [("refused", "mwd"), ("missing", "mwd")]
    text = texts(live)["alarm_missing"]
    assert text.startswith("no frame had radius (item 5012): ")
    assert text.endswith("items that came and are not mapped: 0811, 0844, for 120 s")
    send(b"&&\r\n5012110\r\n501010\r\n0108110\r\n!!\r\n")
    assert ("missing", "mwd") not in rules(alarms)


def test_bytes_without_a_frame_are_an_alarm():
    live, clock, alarms = alarmed(HOST)
    for _ in range(4):
        clock.step(50)
        live.receive("mwd", b"<xml>hello</xml>\r\n")
        alarms.check()
    assert rules(alarms) == [("missing", "mwd")]
    assert texts(live)["alarm_missing"].startswith("bytes come, and no WITS frame (&& ... !!)")
    live.receive("mwd", frames(1)[0])
    alarms.check()
    assert rules(alarms) == []


def test_samples_of_a_string_that_does_not_turn_are_no_alarm():
    items = 'items = { bit_depth = "0108", rotation = "0120" }\n'
    live, clock, alarms = alarmed(HOST + items + 'caliper = { toolface = ["5010"], radius = ["5012"] }\n')
    for number in range(40):
        clock.step(10)
        live.receive("mwd", b"&&\r\n0108%.3f\r\n01200\r\n501010\r\n5012110\r\n!!\r\n" % (110 + number / 10))
        alarms.check()
    assert live.model.counts["flag NOT_ROTATING"] == 40
    assert rules(alarms) == []


def test_a_jump_of_depth_is_an_alarm_for_a_minute():
    text = HOST + 'items = { bit_depth = "0108" }\n'
    live, clock, alarms = alarmed(text)
    for depth in (2000.0, 9000.0, 2000.1):  # one wrong value is no alarm
        live.receive("mwd", b"&&\r\n0108%.3f\r\n!!\r\n" % depth)
        alarms.check()
    assert rules(alarms) == []
    live.receive("mwd", b"&&\r\n01086561.7\r\n!!\r\n")
    alarms.check()
    assert rules(alarms) == [("depth_jump", "mwd")]
    assert texts(live)["alarm_depth_jump"].startswith(
        "bit depth refused, 6561.7 m: the last depth used was 2000.1 m, and it seems that feet"
    )
    clock.step(61)
    alarms.check()
    assert rules(alarms) == [("no_data", "mwd")]
    restarted = Alarms(live, STATES)
    restarted.check()
    assert ("depth_jump", "mwd") not in rules(restarted)  # it was before the start


def test_disk_sync_lock_and_folder_are_alarms(tmp_path, monkeypatch, golden):
    live, clock, alarms = alarmed(HOST + "[alarms]\nsync = 3.0\ndisk_gb = 2.0\n", tmp_path / "j")
    alarms.check()
    assert alarms.active == []
    with monkeypatch.context() as patch:
        patch.setattr(Journal, "bytes_left", property(lambda _: 1_500_000_000))
        alarms.check()
        golden(texts(live)["alarm_disk"])
    clock.step(4)
    alarms.check()
    assert rules(alarms) == [("sync", "")]
    alarms.synced = clock()[1]
    (tmp_path / "j/lock").rename(tmp_path / "lock")
    alarms.check()
    assert rules(alarms) == [("journal", "")]
    assert "the journal's folder or its lock file is gone: No such file" in texts(live)["alarm_journal"]
    (tmp_path / "j/lock").touch()
    alarms.check()
    assert rules(alarms) == [("journal", "")]
    (tmp_path / "lock").rename(tmp_path / "j/lock")
    alarms.check()
    assert alarms.active == []
    (tmp_path / "j").rename(tmp_path / "k")
    alarms.check()
    assert rules(alarms) == [("journal", "")]
    (tmp_path / "k").rename(tmp_path / "j")
    live.close()


def test_a_clock_that_is_set_is_an_alarm_for_a_minute(golden):
    live, clock, alarms = alarmed(HOST)
    clock.wall -= 3600 * SECOND
    alarms.check()
    golden(texts(live)["alarm_clock"])
    clock.step(59)
    alarms.check()
    assert rules(alarms) == [("clock", "")]
    clock.step(1)
    alarms.check()
    assert rules(alarms) == []


def test_no_descriptor_is_an_alarm(monkeypatch, golden):
    live, _, alarms = alarmed(HOST)
    with monkeypatch.context() as patch:
        patch.setattr(os, "open", lambda *_: (_ for _ in ()).throw(OSError(24, "Too many open files")))
        alarms.check()
    golden(texts(live)["alarm_descriptors"])
    alarms.check()
    assert alarms.active == []


@pytest.mark.parametrize(("radius", "rule", "text"), [
    (0.1, "tight", "at 100.80 m the diameter is 16.0 mm below the bit diameter"),
    (0.13, "washout", "at 100.80 m the diameter is 44.0 mm above the bit diameter"),
])  # fmt: skip
def test_a_tight_hole_and_a_washout_are_alarms_once_a_turn_is_beyond_the_limit(radius, rule, text):
    live, clock, alarms = alarmed(HOST + "[alarms]\ntight = 0.01\nwashout = 0.03\n")
    k = np.arange(16 * 20)
    radii = np.full(len(k), 0.108)
    radii[40] = radius  # one sample is not a turn
    alarms.changed(live.append_samples(100 + k * 0.1 / 16, k * 22.5 % 360, radii))
    alarms.check()
    assert alarms.active == []
    radii[16 * 8 : 16 * 10] = radius
    live, clock, alarms = alarmed(HOST + "[alarms]\ntight = 0.01\nwashout = 0.03\n")
    alarms.changed(live.append_samples(100 + k * 0.1 / 16, k * 22.5 % 360, radii))
    alarms.check()
    assert [(alarm.rule, alarm.text) for alarm in alarms.active] == [(rule, text)]
    clock.step(61)
    alarms.check()
    assert rules(alarms) == [("no_data", "mwd")]


def test_a_tight_hole_and_a_washout_end_with_the_worst_of_their_turns():
    live, clock, alarms = alarmed(HOST + "[alarms]\ntight = 0.01\nwashout = 0.03\n")
    k = np.arange(16 * 20)
    for depth, radius in ((100, 0.13), (102, 0.16), (104, 0.14)):
        alarms.changed(live.append_samples(depth + k * 0.1 / 16, k * 22.5 % 360, np.full(len(k), radius)))
        alarms.check()
        clock.step(10)
    (begun,) = [alarm for alarm in alarms.active if alarm.rule == "washout"]
    assert begun.text.endswith(" m the diameter is 44.0 mm above the bit diameter")
    clock.step(61)
    alarms.check()
    ended = texts(live)["alarm_washout_end"]
    assert ended.startswith(f"after 91.0 s: {begun.text}; the worst: at 10")
    assert ended.endswith(" m the diameter is 104.0 mm above the bit diameter")
    assert 102 <= float(ended.split(" at ")[-1].split()[0]) < 104
    alarms.changed(live.append_samples(106 + k * 0.1 / 16, k * 22.5 % 360, np.full(len(k), 0.13)))
    alarms.check()
    clock.step(61)
    alarms.check()
    assert "104.0 mm" not in texts(live)["alarm_washout_end"]  # of an alarm before


def test_an_alarm_shows_the_name_of_its_source_as_the_configuration_has_it():
    assert str(Alarm("no_data", "mwd_1", 0, 0, "x")).startswith("no data mwd_1: x, since ")
    assert Alarm("no_data", "mwd_1", 0, 0, "x").said(named=False).startswith("no data: x, since "), "the only source"


@pytest.mark.parametrize(("zone", "shown"), [("UTC", ""), ("Asia/Tokyo", ", 07:14:21 here")])
def test_an_alarm_has_the_local_time_where_it_is_another_one(monkeypatch, zone, shown):
    monkeypatch.setenv("TZ", zone)
    time.tzset()
    try:
        _, clock, alarms = alarmed(HOST)
        clock.step(61)
        alarms.check()
        assert str(alarms.active[0]) == f"no data mwd: nothing has come for 60 s, since 22:14:21 UTC{shown}"
    finally:
        monkeypatch.undo()
        time.tzset()


def test_the_limits_are_those_of_the_bit_that_drills_now():
    live, _, alarms = alarmed(HOST + "[alarms]\ntight = 0.01\n")
    live.reconfigure(parse((HOST + "[alarms]\ntight = 0.01\n").replace("0.216", "0.19")))
    k = np.arange(16 * 20)
    alarms.changed(live.append_samples(100 + k * 0.1 / 16, k * 22.5 % 360, np.full(len(k), 0.096)))
    alarms.check()
    assert alarms.active == []  # 24 mm below the first bit


class Hook:
    """A real HTTP server that keeps what is posted to it."""

    def __init__(self, answer=200):
        self.lines, self.authorized, hook = [], [], self
        self.let = threading.Event()

        class Pages(http.server.BaseHTTPRequestHandler):
            def do_POST(self):
                hook.authorized.append(self.headers["Authorization"])
                hook.lines.append(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
                if answer is None:
                    hook.let.wait(PATIENCE)
                self.send_response(answer or 200)
                if answer == 302:
                    self.send_header("Location", "/elsewhere")
                self.send_header("Content-Length", "0")
                self.end_headers()

            def do_GET(self):
                self.send_response(200)
                self.end_headers()

            def log_message(self, *_):
                pass

        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Pages)
        self.url = f"http://127.0.0.1:{self.server.server_address[1]}/hook"
        threading.Thread(target=self.server.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True).start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.let.set()
        self.server.shutdown()
        self.server.server_close()


def test_a_line_of_json_goes_to_the_command_and_to_the_webhook(tmp_path, monkeypatch):
    keep = [sys.executable, "-c", f"import sys; open({str(tmp_path / 'lines')!r}, 'a').write(sys.stdin.read())"]
    with Hook() as hook:
        monkeypatch.setenv("ALARM_HOOK", hook.url)
        live, clock, alarms = alarmed(HOST + f'[alarms]\ncommand = {json.dumps(keep)}\nwebhook = "env:ALARM_HOOK"\n')
        alarms.start(thread)
        clock.step(61)
        alarms.check()
        live.receive("mwd", frames(1)[0])
        clock.step(1)
        alarms.check()
        until(lambda: len(hook.lines) == 2)
        alarms.close()
    lines = [json.loads(line) for line in (tmp_path / "lines").read_text().splitlines()]
    assert lines == hook.lines
    assert [(line["alarm"], line["source"], line["state"]) for line in lines] == [
        ("no_data", "mwd", "begins"), ("no_data", "mwd", "ends"),
    ]  # fmt: skip
    assert lines[0]["time"] == "2023-11-14T22:14:21.000Z"
    assert lines[0]["text"] == "nothing has come for 60 s"
    assert "alarm_not_delivered" not in texts(live)


def test_the_command_gets_no_secret_and_the_resolver_no_password(tmp_path, monkeypatch):
    for name in ("HELIBORE_TOKEN", "STORE_PASSWORD", "AWS_SECRET_ACCESS_KEY", "HORN_KEY"):
        monkeypatch.setenv(name, "s3cret")
    asked, resolve = [], socket.getaddrinfo
    monkeypatch.setattr(
        socket, "getaddrinfo", lambda host, *more, **how: asked.append(host) or resolve(host, *more, **how)
    )
    with Hook() as hook:
        monkeypatch.setenv("HOOK", hook.url.replace("://", "://rig:p%40ss@"))
        listed = json.dumps(["sh", "-c", f"env > {tmp_path}/variables"])
        settings = f'[alarms]\nwebhook = "env:HOOK"\ncommand = {listed}\nenvironment = ["HORN_KEY"]\n'
        _, clock, alarms = alarmed(HOST + settings)
        alarms.start(thread)
        clock.step(61)
        alarms.check()
        until(lambda: hook.lines)
        alarms.close()
    assert hook.authorized[0] == "Basic " + base64.b64encode(b"rig:p@ss").decode()
    assert set(asked) == {"127.0.0.1"}
    variables = (tmp_path / "variables").read_text()
    assert "HORN_KEY=s3cret" in variables
    assert f"PATH={os.environ['PATH']}" in variables
    assert variables.count("s3cret") == 1
    monkeypatch.delenv("HORN_KEY")
    with pytest.raises(InputError) as refused:
        alarmed(HOST + settings)
    assert refused.value.place == "alarms.environment"


def is_running(pid):
    stat = Path(f"/proc/{pid}/stat")
    return stat.exists() and stat.read_text().rpartition(")")[2].split()[0] != "Z"


def hanging(folder):
    """A command that never ends, and what it starts neither."""
    return ["sh", "-c", f"sleep 1000 & echo $! >> {folder}/pids; wait"]


@pytest.mark.parametrize("way", ["command", "webhook"])
def test_a_command_or_a_webhook_that_hangs_delays_no_alarm(tmp_path, monkeypatch, way):
    """It may hang for 1000 s here, so a check that waited for it would not return."""
    monkeypatch.setattr(module, "SECONDS", 1000.0)
    with Hook(answer=None) as hook:
        target = json.dumps(hanging(tmp_path)) if way == "command" else f'"{hook.url}"'
        live, clock, alarms = alarmed(HOST + f"[alarms]\n{way} = {target}\n")
        alarms.start(thread)
        for _ in range(module.MOST_LINES):
            clock.step(61)
            alarms.check()
            live.receive("mwd", b"&&\r\n!!\r\n")
            alarms.check()
        assert alarms.counts["no_data", "mwd"] == module.MOST_LINES
        assert alarms.undelivered >= module.MOST_LINES - 1  # the queue is bounded
        monkeypatch.setattr(module, "SECONDS", 0.1)
        alarms.close()
        if way == "command":
            until((tmp_path / "pids").exists)
            until(lambda: not any(map(is_running, (tmp_path / "pids").read_text().split())))  # none outlives helibore
            assert not alarms._thread.is_alive() or alarms.undelivered
    alarms._thread.join(PATIENCE)  # no later line goes to whoever listens at that port by then
    assert not alarms._thread.is_alive()


def test_a_command_that_hangs_is_ended_with_what_it_started(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "SECONDS", 0.3)
    monkeypatch.setattr(module, "WAITS", (0.0,))
    live, clock, alarms = alarmed(HOST + f"[alarms]\ncommand = {json.dumps(hanging(tmp_path))}\n")
    alarms.start(thread)
    clock.step(61)
    alarms.check()
    until(lambda: alarms.undelivered == 1)
    reported = texts(live)["alarm_not_delivered"]  # before `close`, which may kill the command for the next line
    alarms.close()
    for pid in (tmp_path / "pids").read_text().split() if (tmp_path / "pids").exists() else ():
        until(lambda pid=pid: not is_running(pid))
    assert reported == "command: TimeoutExpired"


def test_a_late_webhook_without_a_socket_does_not_end_the_watch():
    _, _, alarms = alarmed(HOST + '[alarms]\nwebhook = "http://127.0.0.1:9/"\n')
    alarms._posting = (-math.inf, [SimpleNamespace(sock=None)])
    alarms.check()
    assert not alarms.active


def waiting(link, way):
    """Return the number of bytes that wait at a socket: received (FIONREAD) or sent (TIOCOUTQ), and not read there."""
    return struct.unpack("i", fcntl.ioctl(link.fileno(), way, bytes(4)))[0]


@pytest.mark.parametrize(("head", "undelivered"), [(b"", 1), (b"HTTP/1.1 200 OK\r\nX: ", 0)])
def test_a_webhook_that_drips_its_answer_is_ended_in_time(monkeypatch, head, undelivered):
    """Each byte comes in time; the whole answer never does. With the status 200 the line is delivered."""
    monkeypatch.setattr(module, "SECONDS", 1000.0)
    monkeypatch.setattr(module, "WAITS", (0.0,))
    begun, ended = queue.Queue(), []

    def drip(server):
        for _ in range(2):
            link, _ = server.accept()
            with link, contextlib.suppress(OSError):
                link.recv(65536)
                link.sendall(head)
                until(lambda link=link: not waiting(link, termios.TIOCOUTQ))  # it is at the other end
                begun.put(link)
                while True:
                    link.sendall(b"x")
                    time.sleep(0.02)
            ended.append(link)

    with socket.create_server(("127.0.0.1", 0)) as server:
        thread("drip", lambda: drip(server)).start()
        live, clock, alarms = alarmed(HOST + f'[alarms]\nwebhook = "http://127.0.0.1:{server.getsockname()[1]}/"\n')
        alarms.start(thread)
        clock.step(61)
        alarms.check()
        live.receive("mwd", b"\r\n")
        alarms.check()
        for number in (1, 2):
            begun.get(timeout=PATIENCE)
            _, made = alarms._posting
            until(
                lambda made=made: made[0].sock is None or not waiting(made[0].sock, termios.FIONREAD)
            )  # it has the status
            alarms._posting = -math.inf, made  # it began long ago
            until(lambda number=number: alarms.check() or len(ended) == number)  # the watch thread checks
        alarms.close()
    assert alarms.undelivered == 2 * undelivered
    assert ("alarm_not_delivered" in texts(live)) == bool(undelivered)


@pytest.mark.parametrize(("answer", "text"), [(500, "Internal Server Error"), (302, "Found")])
def test_what_is_not_delivered_is_tried_again_and_told(monkeypatch, answer, text):
    monkeypatch.setattr(module, "WAITS", (0.0, 0.01, 0.01))
    with Hook(answer) as hook:
        live, clock, alarms = alarmed(HOST + f'[alarms]\nwebhook = "{hook.url}"\n')
        alarms.start(thread)
        clock.step(61)
        alarms.check()
        until(lambda: alarms.undelivered == 1)
        assert len(hook.lines) == 3
        alarms.close()
    assert texts(live)["alarm_not_delivered"] == f"webhook: {text}"


def test_a_command_that_fails_says_why(monkeypatch, golden, tmp_path):
    monkeypatch.setattr(module, "WAITS", (0.0,))
    keeps = f"sleep 1000 & echo $! >> {tmp_path}/pids"  # it keeps stderr, for longer than a test waits
    fails = ["sh", "-c", f"{keeps}; echo one >&2; echo 'no such\\033 host' >&2; echo >&2; exit 3"]
    live, clock, alarms = alarmed(HOST + f"[alarms]\ncommand = {json.dumps(fails)}\n")
    alarms.start(thread)
    clock.step(61)
    alarms.check()
    until(lambda: alarms.undelivered == 1)
    alarms.close()
    for pid in (tmp_path / "pids").read_text().split():
        with contextlib.suppress(ProcessLookupError):
            os.kill(int(pid), signal.SIGKILL)
    golden(texts(live)["alarm_not_delivered"])


@pytest.mark.parametrize(
    ("entry", "rule", "value"),
    [
        ("lost = 0", "must be at least 0.1 s", "0"),
        ("losst = 9", "did you mean lost?", None),
        ('webhook = "ftp://x/y"', "must be https://..., http://... or env:NAME", "'ftp://x/y'"),
        ('webhook = "htps://rig:s3cret@x/y"', "must be https://..., http://... or env:NAME", "'htps:...'"),
        ('webhook = "https://x/y?token=s3cret"', "must not hold a user, a password or a query", "'https://x/...'"),
        ('command = "beep"', "must be a list", "'beep'"),
    ],
)
def test_wrong_settings_of_alarms_are_named(entry, rule, value):
    found = refused(HOST + f"[alarms]\n{entry}\n")
    assert (found[0], found[2]) == (f"alarms.{entry.partition(' ')[0]}", value)
    assert rule in found[1]


@pytest.mark.parametrize("command", ["/no/such/horn", "no-such-horn", __file__])
def test_a_command_that_cannot_be_run_is_an_error_at_the_start(command):
    with pytest.raises(ValueError, match=r"^alarms\.command\[0\] = '.*': must be a program that can be run$"):
        alarmed(HOST + f"[alarms]\ncommand = {json.dumps([command])}\n")


def test_alarms_that_last_end_at_the_stop(tmp_path, golden):
    log = tmp_path / "log"
    keep = ["sh", "-c", f"cat >> {log}"]
    live, clock, alarms = alarmed(HOST + f"[alarms]\ncommand = {json.dumps(keep)}\n")
    alarms.start(thread)
    clock.step(70)
    alarms.check()
    alarms.begin("failure", "thread draw died")
    clock.step(5)
    alarms.close()
    found = [json.loads(line) for line in log.read_text().splitlines()]
    assert [(line["alarm"], line["state"]) for line in found] == [
        ("no_data", "begins"), ("failure", "begins"), ("no_data", "ends"),
    ]  # fmt: skip
    golden(texts(live)["alarm_no_data_end"])
    assert rules(alarms) == [("failure", "")]


@pytest.mark.parametrize("scheme", ["env", "ENV"])
def test_a_webhook_whose_variable_is_not_set_is_an_error_at_the_start(monkeypatch, scheme, golden):
    monkeypatch.delenv("NO_SUCH", raising=False)
    with golden.raises():
        alarmed(HOST + f'[alarms]\nwebhook = "{scheme}:NO_SUCH"\n')


def test_a_webhook_whose_variable_holds_no_address_is_an_error_at_the_start(monkeypatch):
    monkeypatch.setenv("HOOK", "hooks.example/s3cret")
    rule = r"^alarms\.webhook = 'env:HOOK': the variable must hold https://\.\.\. or http://\.\.\.$"
    with pytest.raises(ValueError, match=rule):
        alarmed(HOST + '[alarms]\nwebhook = "env:HOOK"\n')


def test_alarms_do_not_change_the_meaning():
    assert parse(HOST).meaning() == parse(HOST + "[alarms]\nlost = 9.0\n").meaning()


def test_a_running_server_shows_its_alarms_in_metrics_and_status(tmp_path):
    from rich.console import Console

    from helibore.cli.live_status_page import Page
    from helibore.cli.prometheus_metrics import metrics

    assert TICK <= 0.5
    with Running(configured(f"listen://127.0.0.1:{free_port()}") + "[alarms]\nlost = 0.1\n", tmp_path) as running:
        until(lambda: rules(running.server.alarms) == [("lost", "mwd")])
        assert 'helibore_alarm_active{alarm="lost",source="mwd"} 1.0' in metrics(running.server)
        console = Console(width=160, record=True, file=io.StringIO())
        console.print(Page(running.server).draw())
        shown = console.export_text()
        assert "ALARMS" in shown
        assert "lost mwd: listening: not connected for 0.1 s, since " in shown
        with socket.create_connection(("127.0.0.1", running.live.configuration.sources["mwd"].address.port)):
            until(lambda: rules(running.server.alarms) == [])
        assert 'helibore_alarm_active{alarm="lost",source="mwd"} 0.0' in metrics(running.server)
        assert 'helibore_alarms_total{alarm="lost",source="mwd"} 1.0' in metrics(running.server)


def test_a_dead_thread_is_an_alarm_that_is_delivered(tmp_path, monkeypatch, golden):
    with Hook() as hook:
        text = configured(f"listen://127.0.0.1:{free_port()}") + f'[alarms]\nwebhook = "{hook.url}"\n'
        running = Running(text, tmp_path)
        running.server.start()
        monkeypatch.setattr(Live, "sync", lambda _: 1 / 0)
        until(lambda: hook.lines)
        monkeypatch.undo()
        running.server.stop()
        running.live.close()
    assert hook.lines[0]["alarm"] == "failure"
    assert hook.lines[0]["journal"] == str(tmp_path)
    golden(hook.lines[0]["text"])


def test_the_death_of_the_thread_that_delivers_is_a_failure(tmp_path, monkeypatch, golden):
    monkeypatch.setattr(Alarms, "_sent", lambda *_: 1 / 0)
    text = configured(f"listen://127.0.0.1:{free_port()}") + '[alarms]\nlost = 0.1\ncommand = ["true"]\n'
    running = Running(text, tmp_path)
    running.server.start()
    until(lambda: ("failure", "") in rules(running.server.alarms))
    golden(texts(running.live)["alarm_failure"])
    running.server.stop()
    running.live.close()


class Command:
    """``helibore live`` as a process; ``lines`` is what it has written to stderr so far."""

    def __init__(self, folder, text, *options):
        (folder / "rig.toml").write_text(text)
        self.metrics_port = free_port()
        self.lines = []
        arguments = ["live", str(folder / "rig.toml"), "--journal", str(folder / "j"), "-q", *options]
        self.process = subprocess.Popen(
            [sys.executable, "-m", "helibore", *arguments, "--metrics-port", str(self.metrics_port),
             "--token", "s3"],
            stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True,
        )  # fmt: skip
        self.reading = threading.Thread(target=lambda: self.lines.extend(self.process.stderr), daemon=True)
        self.reading.start()
        until(lambda: self.process.poll() is None and self.metrics())

    def metrics(self):
        try:
            with urllib.request.urlopen(f"http://127.0.0.1:{self.metrics_port}/metrics?token=s3", timeout=5) as page:
                return page.read().decode()
        except OSError:
            return ""

    def exhaust_descriptors(self, hard):
        """Set the limit to the lowest number that no descriptor has now, so that none can be opened."""
        used = {int(path.name) for path in Path(f"/proc/{self.process.pid}/fd").iterdir()}
        resource.prlimit(self.process.pid, resource.RLIMIT_NOFILE, (min(set(range(len(used) + 1)) - used), hard))

    def said(self, text):
        return any(text in line for line in list(self.lines))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()
        self.reading.join()
        self.process.stderr.close()


def test_a_process_without_descriptors_folder_or_lock_alarms_and_recovers(tmp_path):
    port = free_port()
    with Command(tmp_path, configured(f"listen://127.0.0.1:{port}") + "[alarms]\nlost = 1000.0\n") as command:
        soft, hard = resource.prlimit(command.process.pid, resource.RLIMIT_NOFILE)
        text = "alarm_descriptors: no file and no connection can be opened"
        until(lambda: command.exhaust_descriptors(hard) or command.said(text))
        until(lambda: 'helibore_alarm_active{alarm="descriptors",source=""} 1.0' in command.metrics())
        resource.prlimit(command.process.pid, resource.RLIMIT_NOFILE, (soft, hard))
        until(lambda: command.said("alarm_descriptors_end: after "))
        (tmp_path / "j/lock").rename(tmp_path / "lock")
        until(lambda: command.said("alarm_journal: the journal's folder or its lock file is gone"))
        until(lambda: 'helibore_alarm_active{alarm="journal",source=""} 1.0' in command.metrics())
        (tmp_path / "lock").rename(tmp_path / "j/lock")
        until(lambda: 'helibore_alarm_active{alarm="journal",source=""} 0.0' in command.metrics())
        (tmp_path / "j").rename(tmp_path / "k")
        until(lambda: command.said("disk: [Errno 2] "))
        until(lambda: 'helibore_alarm_active{alarm="journal",source=""} 1.0' in command.metrics())
        (tmp_path / "k").rename(tmp_path / "j")
        with socket.create_connection(("127.0.0.1", port)) as sender:
            sender.sendall(b"".join(frames(20)))
            until(lambda: "helibore_samples_drawn_total 20.0" in command.metrics())
        command.process.send_signal(signal.SIGTERM)
        assert command.process.wait(PATIENCE) == 0
    assert Live.replay(tmp_path / "j").wall.sample_count == 20


def test_alarms_are_on_the_page():
    pytest.importorskip("uvicorn", reason="the page is served by the extra 'view'")
    from helibore.cli.live_view import Window
    from helibore.viewer.page_files import page

    if page("app.js") is None:
        pytest.skip("the page was not built: Node.js 18 is missing")
    live, clock, alarms = alarmed(HOST)
    with Window("well-7") as window:
        window.follow(live)
        clock.step(61)
        alarms.check()
        window.refresh(STATES, alarms.active)
        (shown,) = window.scene.state.alarms
        assert shown.startswith("no data: nothing has come for 60 s, since 22:14:21 UTC"), "of the only source"
        live.receive("mwd", b"\r\n")
        alarms.check()
        window.refresh(STATES, alarms.active)
        assert window.scene.state.alarms == ()

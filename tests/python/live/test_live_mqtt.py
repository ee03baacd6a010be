"""An MQTT broker of its own: what it sends is drawn, nothing is lost by a kill, and bad input has a sentence."""

from __future__ import annotations

import json
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from live_servers import Running, free_port, payloads, until
from live_wires import WALL, Clock
from patience import PATIENCE

from helibore import Live
from helibore.live.rules.configuration import parse
from helibore.live.wire.mqtt_link import MOST_WAITING, framed

MOSQUITTO = shutil.which("mosquitto", path="/usr/sbin:/usr/bin:/usr/local/sbin:/opt/homebrew/sbin")
mqtt = pytest.importorskip("paho.mqtt.client", reason="MQTT needs paho-mqtt")

SETTINGS = (
    WALL
    + '[source.rig]\naddress = "mqtt://127.0.0.1:PORT"\nunits = "metric"\nclient = "well-7"\ntopics = ["rig7/#"]\n'
    + 'sequence = "seq"\n'
    + 'caliper = { toolface = ["tool.tf"], radius = ["tool.rad"], depth = ["md"] }\n'
)


def message(n):
    return json.dumps({"seq": n, "md": 100 + 0.001 * n, "tool": {"tf": n * 37 % 360, "rad": 110.0 + n % 3}})


CONNECT = b"\x10\x0c\x00\x04MQTT\x04\x02\x00\x3c\x00\x00"
"""The first packet of a client without a name."""


class Broker:
    """A mosquitto that keeps its sessions in a folder."""

    def __init__(self, folder: Path, extra: str = "") -> None:
        self.port, self.folder = free_port(), folder
        self._file = folder / "mosquitto.conf"
        lines = [f"listener {self.port} 127.0.0.1", "persistence true", f"persistence_location {folder}/", extra,
                 "max_queued_messages 0", "user root"]  # fmt: skip
        self._file.write_text("\n".join([*lines, "" if "allow_anonymous" in extra else "allow_anonymous true", ""]))
        self.begin()

    def begin(self, extra: str = "") -> None:
        self._file.write_text(f"{self._file.read_text()}{extra}\n")
        self._process = subprocess.Popen([MOSQUITTO, "-c", self._file], stdout=subprocess.DEVNULL,
                                         stderr=subprocess.DEVNULL)  # fmt: skip

        def answers() -> bool:
            try:
                with socket.create_connection(("127.0.0.1", self.port), timeout=PATIENCE) as link:
                    link.sendall(CONNECT)
                    return bool(link.recv(4))  # only then does a signal end it: one that comes as it begins is lost
            except OSError:
                return False

        until(answers)

    def end(self, how=signal.SIGTERM) -> None:
        self._process.send_signal(how)
        self._process.wait(PATIENCE)

    def sender(self):
        from paho.mqtt.enums import CallbackAPIVersion

        client = mqtt.Client(CallbackAPIVersion.VERSION2, "sender")
        client.connect("127.0.0.1", self.port)
        client.loop_start()
        return client


@pytest.fixture
def broker(tmp_path):
    if MOSQUITTO is None:
        pytest.skip("mosquitto is not installed")
    folder = tmp_path / "broker"
    folder.mkdir()
    made = Broker(folder)
    yield made
    made.end(signal.SIGKILL)


def publish(client, texts, topic="rig7/caliper", **options):
    for sent in [client.publish(topic, text, qos=1, **options) for text in texts]:
        sent.wait_for_publish(30)


def settings(broker):
    return SETTINGS.replace("PORT", str(broker.port))


def numbers(live):
    """The sequence numbers of the drawn samples."""
    return sorted(np.rint((live.wall.samples.depth - 100) * 1000).astype(int).tolist())


def test_what_a_broker_sends_is_drawn_and_replayed(broker, tmp_path):
    sender = broker.sender()
    publish(sender, ['{"md": 5}'], retain=True)
    with Running(settings(broker), tmp_path / "j") as running:
        until(lambda: running.server.states["rig"].startswith("connected") or running.count("retained", "rig"))
        publish(sender, [message(n) for n in range(200)])
        publish(sender, ["{broken", '{"tool": {"tf": NaN}}', "[1]", '"text"', '{"md": "x", "tool": {"tf": 1}}'])
        publish(sender, ["1" * 300_000])
        publish(sender, [message(205)])
        until(lambda: running.live.wall.sample_count == 201)
        assert running.count("retained", "rig") == 1
        assert running.count("not_json", "rig") == 4
        assert running.count("invalid", "rig") == 1
        assert running.count("refused", "rig") == 1
        assert running.count("gap", "rig") == 1
    sender.loop_stop()
    again = Live.replay(tmp_path / "j")
    assert np.array_equal(again.wall.radius, running.live.wall.radius, equal_nan=True)
    assert numbers(again) == [*range(200), 205]


def test_messages_wait_at_the_broker_while_helibore_is_away(broker, tmp_path):
    broker.end()
    broker.begin("max_inflight_messages 0")
    sender = broker.sender()
    with Running(settings(broker), tmp_path / "j") as running:
        until(lambda: running.server.openers["rig"] is not None and running.live.model.counts["connections rig"])
        publish(sender, [message(0)])
        until(lambda: running.live.wall.sample_count == 1)
    count = MOST_WAITING + 300  # the broker's answer to the subscription stands behind them
    publish(sender, [message(n) for n in range(1, count)])
    broker.end()  # SIGTERM: it stores what waits
    broker.begin()
    with Running(settings(broker), tmp_path / "j") as again:
        until(lambda: again.live.wall.sample_count == count)
        assert numbers(again.live) == list(range(count))
        until(lambda: again.server.states["rig"].startswith("connected"))
    sender.loop_stop()


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


def test_a_kill_loses_nothing_and_doubles_nothing(broker, tmp_path):
    sender, count = broker.sender(), 1500
    begun = [sys.executable, "-c", PROGRAM, settings(broker), str(tmp_path / "j")]
    first = subprocess.Popen(begun, stdout=subprocess.PIPE)
    assert first.stdout
    assert first.stdout.readline() == b"up\n"
    until(
        lambda: (
            (tmp_path / "j").exists() and any(b"127.0.0.1" in p.read_bytes() for p in (tmp_path / "j").glob("*.hbj"))
        )
    )
    time.sleep(0.5)
    sending = threading.Thread(target=lambda: publish(sender, [message(n) for n in range(count)]))
    sending.start()
    running = first
    for pause in (0.4, 0.7, 0.5):
        time.sleep(pause)
        running.kill()
        running.wait()
        assert running.stdout
        running.stdout.close()
        running = subprocess.Popen(begun, stdout=subprocess.PIPE)
        assert running.stdout
        assert running.stdout.readline() == b"up\n"
    sending.join()
    running.kill()
    running.wait()
    running.stdout.close()
    with Running(settings(broker), tmp_path / "j") as last:
        until(lambda: last.live.wall.sample_count >= count)
        assert numbers(last.live) == list(range(count))
    sender.loop_stop()


def test_a_broker_that_refuses_the_user_is_asked_once(tmp_path, monkeypatch):
    if MOSQUITTO is None:
        pytest.skip("mosquitto is not installed")
    monkeypatch.setenv("BROKER_PASSWORD", "secret-words")
    (tmp_path / "passwords").write_text("")
    broker = Broker(tmp_path, f"allow_anonymous false\npassword_file {tmp_path}/passwords")
    try:
        user = 'user = "rig7"\npassword_env = "BROKER_PASSWORD"\n'
        text = settings(broker).replace('sequence = "seq"\n', 'sequence = "seq"\n' + user)
        with Running(text, tmp_path / "j") as running:
            until(lambda: running.server.states["rig"] == "stopped: access denied")
            assert running.count("access", "rig") == 1
            assert any("password_env" in line for line in running.reported())
        assert not any(b"secret-words" in path.read_bytes() for path in (tmp_path / "j").iterdir() if path.is_file())
    finally:
        broker.end(signal.SIGKILL)


def test_a_broker_that_is_not_there_is_named(tmp_path):
    with Running(SETTINGS.replace("PORT", str(free_port())), tmp_path) as running:
        until(lambda: running.count("link", "rig"))
        assert running.server.states["rig"].startswith("waiting to connect")


def test_a_message_that_comes_again_is_not_drawn_twice():
    live = Live(parse(SETTINGS.replace("PORT", "1883")), clock=Clock())
    one = framed("new", b"rig7/a", message(1).encode())
    live.receive("rig", one[:25])
    live.receive("rig", one[25:] + framed("dup", b"rig7/a", message(1).encode()), 1)
    live.receive(
        "rig", framed("dup", b"rig7/a", message(1).encode()) + framed("dup", b"rig7/a", message(2).encode()), 2
    )
    assert numbers(live) == [1, 2]
    assert live.model.events.counts["rig", "duplicate"] == 2


@pytest.mark.parametrize("payload", [b"mqtt", b"no such line\n", b"mqtt new 5 99999999\nx", b"\0" * 100])
def test_bytes_that_are_no_message_stop_nothing(payload):
    live = Live(parse(SETTINGS.replace("PORT", "1883")), clock=Clock())
    live.receive("rig", payload, 1)
    live.receive("rig", framed("new", b"rig7/a", message(1).encode()), 2)
    assert numbers(live) == [1]


def test_feet_and_inches_are_converted():
    text = SETTINGS.replace("metric", "fps").replace("PORT", "1883")
    live = Live(parse(text), clock=Clock())
    row = json.dumps({"md": 400.0, "tool": {"tf": 10, "rad": 4.5}}).encode()
    live.receive("rig", framed("new", b"rig7/a", row))
    assert live.wall.samples.depth[0] == pytest.approx(121.92)
    assert live.wall.samples.radius[0] == pytest.approx(0.1143)


def test_the_journal_has_what_came(broker, tmp_path):
    sender = broker.sender()
    with Running(settings(broker), tmp_path / "j") as running:
        until(lambda: running.live.model.counts["connections rig"])
        publish(sender, [message(7)])
        until(lambda: running.live.wall.sample_count == 1)
    assert framed("new", b"rig7/caliper", message(7).encode()) in payloads(tmp_path / "j")
    sender.loop_stop()

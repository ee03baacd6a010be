"""Links, the queue and the threads, over loopback and pseudo terminals."""

from __future__ import annotations

import contextlib
import os
import pty
import resource
import socket
import threading
import time
import urllib.request
from types import SimpleNamespace

import pytest
from click.testing import CliRunner
from live_servers import Running, configured, frames, free_port, is_closed, payloads, until
from live_wires import refused
from patience import PATIENCE

from helibore import Live
from helibore.base.identity import Access
from helibore.cli import cli, metrics_server
from helibore.cli.prometheus_metrics import metrics
from helibore.live import server as server_module
from helibore.live.journal.journal import JournalFullError
from helibore.live.rules.configuration import parse
from helibore.live.server import Server, back_off
from helibore.live.wire import transport, wits


def test_back_off_grows_to_its_limit_and_is_spread():
    assert [back_off(n, 60.0, lambda: 1.0) for n in (1, 2, 3, 6, 7, 50)] == [1, 2, 4, 32, 60, 60]
    assert [back_off(n, 5.0, lambda: 1.0) for n in (1, 2, 3, 4, 50)] == [1, 2, 4, 5, 5]
    assert back_off(3, 60.0, lambda: 0.0) == 2.0


def test_a_link_that_gave_bytes_and_broke_is_opened_again_at_once(tmp_path, monkeypatch):
    waits = []
    monkeypatch.setattr(server_module, "back_off", lambda failures, longest: waits.append((failures, longest)) or 0.01)
    port = free_port()
    with Running(configured(f"tcp://127.0.0.1:{port}"), tmp_path) as running:
        until(lambda: len(waits) > 5)  # nobody listens yet
        refused = f"waiting to connect: 127.0.0.1:{port}: Connection refused"
        until(lambda: running.server.states["mwd"] == refused)
        for number in range(2):
            with socket.create_server(("127.0.0.1", port)) as sender:
                link, _ = sender.accept()
                link.sendall(frames(1, number)[0])
                until(lambda: running.live.model.counts["received"] > number)  # noqa: B023
                link.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")  # reset, not closed
                waits.clear()
                link.close()
            until(lambda: waits)
            assert waits[0] == (1, 5.0)


def test_a_file_is_read_to_its_end(tmp_path):
    (tmp_path / "rig.wits").write_bytes(b"".join(frames(500)))
    with Running(configured(f"file://{tmp_path}/rig.wits"), tmp_path / "j") as running:
        assert running.server.wait(PATIENCE)
    assert running.live.wall.sample_count == 500
    assert b"".join(payloads(tmp_path / "j")) == b"".join(frames(500))
    assert sum(running.server.latency.counts) >= 2


def test_a_file_is_read_at_its_speed(tmp_path):
    stream = b"".join(frames(20))
    (tmp_path / "rig.wits").write_bytes(stream)
    start = time.monotonic()
    with Running(configured(f"file://{tmp_path}/rig.wits?speed={2 * len(stream)}"), tmp_path / "j") as running:
        assert running.server.wait(PATIENCE)
    assert time.monotonic() - start >= 0.5
    assert running.live.wall.sample_count == 20


def test_a_listener_keeps_every_byte_of_a_sender_that_reconnects(tmp_path, monkeypatch):
    monkeypatch.setattr(server_module, "FIRST_WAIT", 0.01)
    port = free_port()
    with Running(configured(f"listen://127.0.0.1:{port}"), tmp_path) as running:
        for i in range(100):
            with socket.create_connection(("127.0.0.1", port)) as sender:
                sender.sendall(frames(1, i)[0])
            until(lambda i=i: running.live.wall.sample_count == i + 1)
    assert b"".join(payloads(tmp_path)) == b"".join(frames(100))
    assert running.live.model.counts["connections mwd"] == 100


def test_a_client_comes_back_when_the_server_does(tmp_path, monkeypatch):
    monkeypatch.setattr(server_module, "FIRST_WAIT", 0.05)
    port = free_port()
    with Running(configured(f"tcp://127.0.0.1:{port}"), tmp_path) as running:
        until(lambda: running.count("link", "mwd") > 0)
        for i in range(3):
            with socket.create_server(("127.0.0.1", port)) as rig:
                connection, _ = rig.accept()
                with connection:
                    connection.sendall(frames(1, i)[0])
                    until(lambda i=i: running.live.wall.sample_count == i + 1)
                    connection.settimeout(0.1)
                    with pytest.raises(TimeoutError):
                        connection.recv(1)  # listen only: nothing is ever written


@pytest.mark.parametrize(("mode", "wanted"), [("heartbeat", wits.HEARTBEAT), ("poll", wits.POLL)])
def test_heartbeat_and_poll_are_sent_when_asked_for(tmp_path, mode, wanted):
    with socket.create_server(("127.0.0.1", 0)) as rig:
        port = rig.getsockname()[1]
        with Running(configured(f"tcp://127.0.0.1:{port}", f'mode = "{mode}"\nevery = 0.05\n'), tmp_path) as running:
            connection, _ = rig.accept()
            with connection, connection.makefile("rb") as stream:
                assert stream.read(3 * len(wanted)) == 3 * wanted
                connection.sendall(frames(1)[0])
                until(lambda: running.live.wall.sample_count == 1)


def test_who_is_not_allowed_is_turned_away(tmp_path):
    port = free_port()
    with Running(configured(f"listen://127.0.0.1:{port}", 'allow = ["10.0.0.0/8"]\n'), tmp_path) as running:
        for _ in range(50):
            with socket.create_connection(("127.0.0.1", port)) as sender:
                assert sender.recv(1) == b""
        until(lambda: running.count("refused", "mwd") == 50)
        assert running.live.model.events.latest[-1].text == "127.0.0.1: is not in allow"
    assert b"".join(payloads(tmp_path)) == b""


def test_a_second_sender_is_turned_away_while_the_first_sends(tmp_path):
    port = free_port()
    with (
        Running(configured(f"listen://127.0.0.1:{port}"), tmp_path) as running,
        socket.create_connection(("127.0.0.1", port)) as one,
    ):
        one.sendall(frames(1)[0])
        until(lambda: running.live.wall.sample_count == 1)
        with socket.create_connection(("127.0.0.1", port)) as two:
            assert two.recv(1) == b""
        one.sendall(frames(1, 1)[0])
        until(lambda: running.live.wall.sample_count == 2)


def test_a_slow_sender_is_not_replaced_by_a_newcomer_and_a_silent_one_only_by_a_whole_frame(tmp_path, monkeypatch):
    port, now = free_port(), [1000.0]
    monkeypatch.setattr(transport, "time", SimpleNamespace(monotonic=lambda: now[0]))
    with (
        Running(configured(f"listen://127.0.0.1:{port}", "replace_after = 10.0\n"), tmp_path) as running,
        socket.create_connection(("127.0.0.1", port)) as one,
    ):
        until(lambda: running.server.states["mwd"].startswith("connected"))
        for number, frame in enumerate(frames(3), 1):  # its own interval is longer than replace_after
            now[0] += 20.0
            one.sendall(frame)
            until(lambda number=number: running.live.wall.sample_count == number)
        now[0] += 20.0
        with socket.create_connection(("127.0.0.1", port)) as two:
            two.sendall(frames(1, 50)[0])
            assert is_closed(two)
        one.sendall(frames(1, 3)[0])
        until(lambda: running.live.wall.sample_count == 4)
        now[0] += 61.0  # silent for longer than three of its intervals
        for number, noise in enumerate((b"GET / HTTP/1.1\r\n\r\n", b"&&\r\n!!\r\n", b""), 2):
            with socket.create_connection(("127.0.0.1", port)) as scanner:
                scanner.sendall(noise)
            until(lambda number=number: running.count("refused", "mwd") == number)
        with socket.create_connection(("127.0.0.1", port)) as three:
            three.sendall(frames(1, 4)[0])
            until(lambda: running.live.wall.sample_count == 5)
            assert is_closed(one)
            three.sendall(frames(1, 5)[0])
            until(lambda: running.live.wall.sample_count == 6)


def test_a_listener_that_cannot_accept_tries_again_once_a_second(monkeypatch):
    """Without a descriptor for the connection, the listening socket stays readable."""
    port, refused = free_port(), []
    source = parse(configured(f"listen://127.0.0.1:{port}")).sources["mwd"]
    one = transport.TcpListener(source, lambda *why: refused.append(why))

    def no_descriptor():
        raise OSError(24, "Too many open files")

    real = one._listening
    broken = SimpleNamespace(accept=no_descriptor, fileno=real.fileno, close=real.close)
    monkeypatch.setattr(one, "_listening", broken)
    with contextlib.closing(one), socket.create_connection(("127.0.0.1", port)):
        for _ in range(10):
            assert one.open(0.01) is None
    assert refused == [("link", "a connection could not be accepted: [Errno 24] Too many open files")]


def test_a_descriptor_beyond_1024_is_read(tmp_path):
    resource.setrlimit(resource.RLIMIT_NOFILE, (2048, resource.getrlimit(resource.RLIMIT_NOFILE)[1]))
    held = [os.open(os.devnull, os.O_RDONLY) for _ in range(1100)]
    try:
        port = free_port()
        with (
            Running(configured(f"listen://127.0.0.1:{port}"), tmp_path) as running,
            socket.create_connection(("127.0.0.1", port)) as sender,
        ):
            sender.sendall(frames(1)[0])
            until(lambda: running.live.wall.sample_count == 1)
    finally:
        for file in held:
            os.close(file)


def test_a_listener_off_loopback_must_say_who_may_connect():
    place, rule, _ = refused(configured("listen://0.0.0.0:5000"))
    assert place == "source.mwd.allow"
    assert "may connect to a listener on 0.0.0.0" in rule
    place, rule, value = refused(configured("listen://0.0.0.0:5000", 'allow = ["rig"]\n'))
    assert (place, value) == ("source.mwd.allow", "['rig']")
    assert "must be IP addresses or networks" in rule


def test_a_serial_line(tmp_path):
    pytest.importorskip("serial", reason="pyserial is not installed")
    line, device = pty.openpty()
    with Running(configured(f"serial://{os.ttyname(device)}?baud=115200"), tmp_path) as running:
        until(lambda: running.server.states["mwd"].startswith("connected"))
        for frame in frames(20):
            os.write(line, frame)
        until(lambda: running.live.wall.sample_count == 20)
    os.close(line)
    os.close(device)


def test_a_full_disk_makes_the_sender_wait_and_loses_nothing(tmp_path, monkeypatch):
    port = free_port()
    full = threading.Event()
    with Running(configured(f"listen://127.0.0.1:{port}"), tmp_path) as running:
        append = running.live.journal.append

        def refuse(*arguments):
            if full.is_set():
                raise JournalFullError(28, "No space left on device", "j")
            return append(*arguments)

        monkeypatch.setattr(running.live.journal, "append", refuse)
        with socket.create_connection(("127.0.0.1", port)) as sender:
            sender.sendall(frames(1)[0])
            until(lambda: running.live.wall.sample_count == 1)
            full.set()
            sender.sendall(b"".join(frames(50, 1)))
            until(lambda: running.server.states["mwd"] == "waiting for the disk")
            assert running.live.wall.sample_count == 1
            full.clear()
            until(lambda: running.live.wall.sample_count == 51)
            assert running.server.states["mwd"].startswith("connected to 127.0.0.1")
    assert b"".join(payloads(tmp_path)) == b"".join(frames(51))


def test_a_disk_that_does_not_sync_is_told_and_the_reading_goes_on(tmp_path, monkeypatch):
    port = free_port()
    real, refusals = os.fdatasync, []

    def fdatasync(file):
        if len(refusals) < 3:
            refusals.append(file)
            raise OSError(5, "Input/output error")
        real(file)

    with Running(configured(f"listen://127.0.0.1:{port}"), tmp_path) as running:
        monkeypatch.setattr(os, "fdatasync", fdatasync)
        with socket.create_connection(("127.0.0.1", port)) as sender:
            sender.sendall(frames(1)[0])
            until(lambda: len(refusals) == 3)
            sender.sendall(frames(1, 1)[0])
            until(lambda: running.live.wall.sample_count == 2)
        assert running.count("disk") == 1
        assert [e.text for e in running.live.model.events.latest if e.rule == "disk"] == [
            f"[Errno 5] Input/output error: not synced: '{tmp_path}'"
        ]


def test_with_sync_ms_0_a_sender_waits_for_a_disk_that_does_not_sync(tmp_path, monkeypatch):
    port = free_port()
    real, refusing = os.fdatasync, threading.Event()

    def fdatasync(file):
        if refusing.is_set():
            raise OSError(5, "Input/output error")
        real(file)

    monkeypatch.setattr(os, "fdatasync", fdatasync)
    with Running(configured(f"listen://127.0.0.1:{port}", "[journal]\nsync_ms = 0\n"), tmp_path) as running:
        with socket.create_connection(("127.0.0.1", port)) as sender:
            sender.sendall(frames(1)[0])
            until(lambda: running.live.wall.sample_count == 1)
            refusing.set()
            sender.sendall(b"".join(frames(20, 1)))
            until(lambda: running.server.states["mwd"] == "waiting for the disk")
            assert running.live.wall.sample_count == 1
            refusing.clear()
            until(lambda: running.live.wall.sample_count == 21)
        assert running.live.model.counts["connections mwd"] == 1
    assert b"".join(payloads(tmp_path)) == b"".join(frames(21))


@pytest.mark.parametrize(
    ("of", "name", "thread"),
    [(Live, "sync", "sync"), (Live, "draw", "draw"), (Live, "check_silence", "watch"), (Live, "store", "mwd")],
)
def test_the_death_of_a_thread_is_a_failure_that_is_shown(tmp_path, monkeypatch, caplog, of, name, thread):
    port = free_port()
    live = Live(parse(configured(f"listen://127.0.0.1:{port}")), tmp_path)
    server = Server(live)
    server.start()

    def die(*_):
        raise RuntimeError("killed")

    try:
        with monkeypatch.context() as patch, socket.create_connection(("127.0.0.1", port)) as sender:
            patch.setattr(of, name, die)
            sender.sendall(frames(1)[0])
            until(lambda: live.model.events.counts["", "failure"] > 0)
            assert str(server.failure) == "killed"
            assert not server.wait(1.0)
            until(lambda: f"thread {thread} died: RuntimeError: killed" in caplog.text)
            assert 'helibore_events_total{rule="failure",source=""} 1.0' in metrics(server)
    finally:
        server.stop()
        live.close()


def test_the_command_ends_with_an_error_when_a_thread_died(tmp_path, monkeypatch):
    def die(*_):
        raise RuntimeError("killed")

    (tmp_path / "rig.toml").write_text(configured(f"listen://127.0.0.1:{free_port()}"))
    monkeypatch.setattr(Server, "_sync", die)
    result = CliRunner().invoke(cli, ["live", str(tmp_path / "rig.toml"), "--journal", str(tmp_path / "j"), "-q"])
    assert result.exit_code != 0
    assert "killed" in str(result.exception) + result.output


def test_silence_is_an_event_when_it_begins(tmp_path):
    port = free_port()
    with Running(configured(f"listen://127.0.0.1:{port}", "silence = 0.4\n"), tmp_path) as running:
        silent = lambda: running.count("silent", "mwd")  # noqa: E731
        until(lambda: silent() == 1)  # it has never sent a byte
        with socket.create_connection(("127.0.0.1", port)) as sender:
            sender.sendall(frames(1)[0])
            until(lambda: running.live.wall.sample_count == 1)
            until(lambda: silent() == 2)
            sender.sendall(frames(1, 1)[0])
            until(lambda: silent() == 3)
        assert [e.newest.text for e in running.live.model.events.latest if e.rule == "silent"] == [
            "nothing has come for 0.4 s"
        ]


def test_idle_connections_to_the_metrics_are_bounded_and_end(tmp_path, monkeypatch):
    monkeypatch.setenv("HELIBORE_LIMIT_TOKEN_SECONDS", "1")
    with Running(configured(f"listen://127.0.0.1:{free_port()}"), tmp_path) as running:
        port = free_port()
        pages = metrics_server.MetricsServer(running.server, port, Access(token="s3"))
        held = [socket.create_connection(("127.0.0.1", port)) for _ in range(30)]
        threads = [t for t in threading.enumerate() if t.name.startswith("metrics ")]
        assert len(threads) == metrics_server.CONNECTIONS

        def answers():
            with (
                contextlib.suppress(OSError),
                urllib.request.urlopen(f"http://127.0.0.1:{port}/metrics?token=s3") as page,
            ):
                return b"helibore_queue_records" in page.read()
            return False

        until(answers)
        for one in held:
            assert is_closed(one)
            one.close()
        pages.close()


def test_two_servers_cannot_share_an_address(tmp_path):
    port = free_port()
    with Running(configured(f"listen://127.0.0.1:{port}"), tmp_path / "a"):
        other = Running(configured(f"listen://127.0.0.1:{port}"), tmp_path / "b")
        with pytest.raises(OSError, match=f"127.0.0.1 port {port}: Address already in use; give another address of"):
            other.server.start()
        other.live.close()

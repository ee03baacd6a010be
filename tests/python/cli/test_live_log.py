"""The log of ``helibore live`` never delays the drawing: a blocked stderr, a full disk."""

from __future__ import annotations

import contextlib
import logging
import logging.config
import os
import signal
import socket
import subprocess
import sys
import threading
import urllib.request

import pytest
from live_servers import configured, frames, free_port, payloads, until
from patience import PATIENCE

from helibore import Live
from helibore.cli import live_log
from helibore.cli.live_log import LogWriter

LOGGER = logging.getLogger("test of the log")


class Blocked(logging.Handler):
    """A handler that waits until it may write."""

    def __init__(self):
        super().__init__()
        self.let, self.lines = threading.Event(), []

    def emit(self, record):
        self.let.wait(PATIENCE)
        self.lines.append(record.getMessage())


@pytest.fixture
def logger():
    LOGGER.setLevel(logging.INFO)
    LOGGER.propagate = False
    yield LOGGER
    for handler in list(LOGGER.handlers):
        LOGGER.removeHandler(handler)


def test_a_blocked_handler_delays_nobody_and_what_is_left_out_is_counted(logger, monkeypatch):
    monkeypatch.setattr(live_log, "MOST_WAITING", 10)
    blocked = Blocked()
    writer = LogWriter([blocked])
    logger.addHandler(writer)
    for number in range(100):  # would wait for a minute each
        logger.warning("line %d", number)
    lost = int(writer.trouble().split(" ")[0])
    assert 88 <= lost <= 90  # the thread holds one of them
    assert writer.trouble() == ""
    blocked.let.set()
    until(lambda: len(blocked.lines) == 100 - lost)
    writer.stop()
    assert not writer.alive
    assert blocked.lines[:3] == ["line 0", "line 1", "line 2"]


def test_what_waits_is_written_at_the_end(logger):
    blocked = Blocked()
    writer = LogWriter([blocked])
    logger.addHandler(writer)
    for number in range(50):
        logger.info("line %d", number)
    blocked.let.set()
    writer.stop()
    assert blocked.lines == [f"line {number}" for number in range(50)]


def test_a_library_that_sets_up_logging_does_not_end_the_log(logger):
    blocked = Blocked()
    blocked.let.set()
    writer = LogWriter([blocked])
    logger.addHandler(writer)
    logging.config.dictConfig({"version": 1, "disable_existing_loggers": False})  # uvicorn does so
    logger.warning("after it")
    until(lambda: blocked.lines == ["after it"])
    writer.stop()


def test_a_handler_that_fails_is_reported_and_goes_on(logger, golden):
    class Full:
        """A stream whose disk is full at first."""

        def __init__(self):
            self.text, self.full = "", True

        def write(self, text):
            if self.full:
                raise OSError(28, "No space left on device")
            self.text += text

        def flush(self):
            pass

    stream = Full()
    writer = LogWriter([logging.StreamHandler(stream)])
    logger.addHandler(writer)
    logger.warning("lost")
    found = []
    until(lambda: found.append(writer.trouble()) or found[-1])
    golden(found[-1])
    stream.full = False
    logger.warning("kept")
    writer.stop()
    assert stream.text == "kept\n"


def test_a_stderr_that_nobody_reads_does_not_stop_the_drawing(tmp_path):
    port, page = free_port(), free_port()
    (tmp_path / "rig.toml").write_text(configured(f"listen://127.0.0.1:{port}"))
    arguments = ["live", str(tmp_path / "rig.toml"), "--journal", str(tmp_path / "j"), "-q"]
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    with contextlib.suppress(BlockingIOError):
        while os.write(writing, b"x" * 4096):  # until the pipe is full
            pass
    os.set_blocking(writing, True)
    process = subprocess.Popen(
        [sys.executable, "-m", "helibore", *arguments, "--metrics-port", str(page), "--token", "s3"],
        stderr=writing, stdout=subprocess.DEVNULL,
    )  # fmt: skip
    os.close(writing)

    def metrics():
        try:
            with urllib.request.urlopen(f"http://127.0.0.1:{page}/metrics?token=s3", timeout=5) as answer:
                return answer.read().decode()
        except OSError:
            return ""

    try:
        until(metrics)
        for number in range(3):  # each noise is a warning
            with socket.create_connection(("127.0.0.1", port)) as sender:
                sender.sendall(b"noise\r\n" * 20 + frames(1, number)[0])
                until(lambda number=number: f"helibore_samples_drawn_total {number + 1}.0" in metrics())
        process.send_signal(signal.SIGTERM)
        until(lambda: len(payloads(tmp_path / "j")) >= 3)
        while process.poll() is None and os.read(reading, 65536):  # the end of the command may wait for its stderr
            pass
        process.wait(PATIENCE)
    finally:
        process.kill()
        process.wait()
        os.close(reading)
    assert Live.replay(tmp_path / "j").wall.sample_count == 3

"""The status page of ``helibore live`` on a terminal that does not behave."""

from __future__ import annotations

import io
import threading

import pytest
from live_servers import Running, configured, free_port, until
from patience import PATIENCE

from helibore.cli import live_command


class FullTerminal(io.StringIO):
    """Takes no text, as after Ctrl-S, until it is lost."""

    def __init__(self) -> None:
        super().__init__()
        self.lost = threading.Event()
        self.asked = threading.Event()

    def isatty(self) -> bool:
        return True

    def write(self, _text: str) -> int:
        self.asked.set()
        self.lost.wait()
        raise OSError(5, "Input/output error")


@pytest.fixture
def terminal(monkeypatch):
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr(live_command, "LAST_SECONDS", 0.01)
    terminal = FullTerminal()
    yield terminal
    terminal.lost.set()


def test_a_terminal_that_takes_no_text_delays_nothing_and_one_that_is_lost_is_reported(
    terminal, tmp_path, monkeypatch, golden
):
    monkeypatch.setattr("sys.stdout", terminal)  # not in the fixture: pytest sets it again between the two
    with Running(configured(f"listen://127.0.0.1:{free_port()}"), tmp_path / "j") as running:

        def watch():
            with live_command._screen(running.server, quiet=False) as show:
                show()
                assert terminal.asked.wait(PATIENCE)
                show()

        watching = threading.Thread(target=watch, daemon=True)
        watching.start()
        watching.join(PATIENCE)
        assert not watching.is_alive()
        terminal.lost.set()
        until(lambda: [event for event in running.live.model.events.latest if event.rule == "terminal"])
        (event,) = (event for event in running.live.model.events.latest if event.rule == "terminal")
        golden(event.text)
        assert running.server.failure is None


def test_a_quiet_command_asks_no_terminal(terminal, tmp_path, monkeypatch):
    monkeypatch.setattr("sys.stdout", terminal)
    with (
        Running(configured(f"listen://127.0.0.1:{free_port()}"), tmp_path / "j") as running,
        live_command._screen(running.server, quiet=True) as show,
    ):
        show()
    assert not terminal.asked.is_set()

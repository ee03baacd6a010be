"""A kind of source is two files: a toy kind runs, and nothing else names it."""

from __future__ import annotations

import socket
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
from live_servers import Running, until
from live_wires import WALL, refused, same_bits

import helibore as hb
from helibore import Live
from helibore.cli.live_check import described
from helibore.live import kinds
from helibore.live.rules.configuration import parse
from helibore.live.rules.kinds import kinds as found_kinds
from helibore.live.rules.live_groups import live_groups
from helibore.live.wire import transport
from helibore.settings.listing import rows

TOY = (
    WALL
    + '[source.toy]\naddress = "toy://127.0.0.1:PORT"\n'
    + 'caliper = { toolface = ["tf"], radius = ["rad"], depth = ["md"] }\n'
)


@pytest.fixture(autouse=True)
def _toy():
    """The folder of the toy kind, as a program would add it."""
    kinds.__path__.append(str(Path(__file__).parent / "toy_kind"))
    found_kinds.cache_clear()
    yield
    kinds.__path__.pop()
    found_kinds.cache_clear()
    for name in ("toy", "toy_link"):
        sys.modules.pop(f"helibore.live.kinds.{name}", None)


def _sender(lines: bytes):
    """A peer that takes the greeting, then sends ``lines``."""
    listening = socket.create_server(("127.0.0.1", 0))
    greetings = []

    def serve() -> None:
        link, _ = listening.accept()
        with link, listening:
            greetings.append(link.recv(100))
            link.sendall(lines)
            link.recv(1)

    threading.Thread(target=serve, daemon=True).start()
    return listening.getsockname()[1], greetings


def test_a_kind_of_two_files_draws_and_replays(tmp_path):
    depth, toolface = 100 + 0.01 * np.arange(300), np.arange(300) * 37.0 % 360
    lines = "".join(f"md={d:.2f} tf={t:g} rad=0.11 other=1\n" for d, t in zip(depth, toolface, strict=True)).encode()
    port, greetings = _sender(lines)
    text = TOY.replace("PORT", str(port)) + 'greeting = "hi"\n'
    with Running(text, tmp_path) as running:
        until(lambda: running.live.model.counts["drawn"] == 300)
        assert running.live.model.readers[1].unmapped() == ["other"]
    assert greetings == [b"hi\n"]
    caliper = hb.Caliper(np.round(depth, 2), toolface, np.full(300, 0.11), running.live.wall.samples.time)
    expected = hb.reconstruct(caliper, bit_diameter=0.216, start_depth=100.0, sectors=16)
    assert same_bits(running.live.wall, expected)
    assert same_bits(Live.replay(tmp_path).wall, expected)


def test_what_a_kind_lacks_is_said_with_its_names():
    live = Live(parse(TOY.replace("PORT", "9")))
    live.receive("toy", b"md=101 TF=5 RAD=0.11\n")
    reader = live.model.readers[1]
    lacking = reader.lacking()
    assert "toolface (channel tf), radius (channel rad)" in lacking
    assert lacking.endswith("TF, RAD")


def test_the_check_shows_the_names_of_a_kind():
    assert any("tf" in line for line in described(parse(TOY.replace("PORT", "9"))))


def test_a_wrong_address_has_the_rule_of_its_kind():
    place, rule, value = refused(TOY.replace("127.0.0.1:PORT", "nowhere"))
    assert (place, value) == ("source.toy.address", "'toy://nowhere'")
    assert "toy://HOST:PORT" in rule


def test_the_settings_of_a_kind_are_listed_with_all_others():
    assert ("live.source.toy.greeting", "", "hello", "", "What is sent to the toy.") in list(rows(live_groups()))


def test_each_scheme_has_one_kind():
    schemes = [scheme for kind in found_kinds() for scheme in kind.schemes]
    assert len(schemes) == len(set(schemes))
    assert {"tcp", "listen", "serial", "file", "host", "https", "toy"} <= set(schemes)
    assert not hasattr(transport, "ToyLink")

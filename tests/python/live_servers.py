"""A server on a journal, the frames that its sender sends, and `until`, for the tests of live servers."""

from __future__ import annotations

import random
import socket

import numpy as np
from live_wires import WALL
from patience import PATIENCE, wait

from helibore import Live
from helibore.live.journal.journal import BYTES, segments
from helibore.live.rules.configuration import parse
from helibore.live.server import Server
from helibore.live.wire import wits

SOURCE = (
    '[source.mwd]\naddress = "ADDRESS"\nunits = "metric"\n'
    'caliper = { toolface = ["5010"], depth = ["5011"], radius = ["5012"] }\n'
)


CLAIMS: list[socket.socket] = []
"""What holds the ports that `free_port` gave, until the process ends."""


def configured(address, extra=""):
    """A configuration with one source."""
    return WALL + SOURCE.replace("ADDRESS", address) + extra


def frames(count, first=0):
    return [
        wits.frame([(5004, str(i)), (5010, str(i * 37 % 360)), (5011, f"{100 + 0.01 * i:.2f}"), (5012, "110")])
        for i in range(first, first + count)
    ]


def until(condition, seconds=PATIENCE):
    """Wait until ``condition`` is true."""
    wait(condition, lambda: "it did not come", pause=0.005, seconds=seconds)


def payloads(folder):
    """The received bytes in a journal, record by record."""
    return [s.payload(r) for s in segments(folder) for r in np.flatnonzero(s.records["kind"] == BYTES)]


def free_port():
    """Return a port that nobody but the caller gets: the system gives no such low port to others, nor do other workers.

    A connection that the system gives its port could even meet itself, where nobody listens yet.
    """
    while True:
        port = random.SystemRandom().randrange(10_000, 32_000)
        claim = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)  # UDP: the port is left to a server
        try:
            claim.bind(("127.0.0.1", port))
            socket.create_server(("127.0.0.1", port)).close()
        except OSError:
            claim.close()
            continue
        CLAIMS.append(claim)
        return port


def is_closed(link):
    try:
        return link.recv(1) == b""
    except ConnectionResetError:  # it sent what nobody read
        return True


class Running:
    """A server on a journal; it must not fail."""

    def __init__(self, text, folder):
        self.text = text
        self.live = Live(parse(text), folder)
        self.server = Server(self.live)

    def __enter__(self):
        self.server.start()
        return self

    def __exit__(self, *_):
        self.server.stop()
        self.live.close()
        assert self.server.failure is None

    def count(self, rule, source=""):
        return self.live.model.events.counts[source, rule]

    def reported(self):
        return [str(event) for event in self.live.model.events.latest]

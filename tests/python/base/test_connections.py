"""Connections without the token: few, ended in time, counted; and one with the token is answered among them."""

from __future__ import annotations

import select
import socket
from types import SimpleNamespace

import pytest

from helibore.base import connections as module
from helibore.base.connections import Connections, Listener, most_connections


def listening(connections):
    bound = Listener(socket.AF_INET, socket.SOCK_STREAM)
    bound.connections = connections
    bound.bind(("127.0.0.1", 0))
    bound.listen(64)
    bound.setblocking(False)
    return bound


def accepted(listener):
    """Accept what waits, as an event loop does."""
    found = []
    while select.select([listener], [], [], 0)[0]:
        try:
            found.append(listener.accept()[0])
        except BlockingIOError:
            continue
    return found


def is_ended(link):
    return bool(select.select([link], [], [], 0)[0]) and link.recv(1) == b""


def test_strangers_are_few_and_end_and_a_request_with_the_token_is_answered():
    connections = Connections("page", most=12, strangers=4, seconds=0.0)
    with listening(connections) as listener:
        first = socket.create_connection(listener.getsockname())
        ours = accepted(listener)
        connections.admit(first.getsockname())
        others = [socket.create_connection(listener.getsockname()) for _ in range(30)]
        ours += accepted(listener)
        assert connections.refused == 26, "of 30 strangers, 4 are left"
        for link in ours:
            if is_ended(link):
                link.close()  # as the event loop does
        assert len([link for link in ours if link.fileno() >= 0]) == 5
        connections.check()
        assert connections.refused == 30, "no stranger stays"
        assert not is_ended(first)
        last = socket.create_connection(listener.getsockname())
        ours += accepted(listener)
        assert ours[-1].getpeername() == last.getsockname()
        for link in (first, last, *others, *ours):
            link.close()


def test_no_more_connections_than_the_limit_are_open():
    connections = Connections("page", most=3, strangers=2)
    with listening(connections) as listener:
        links = []
        for _ in range(5):
            link = socket.create_connection(listener.getsockname())
            links += [link, *accepted(listener)]
            connections.admit(link.getsockname())
        assert connections.refused == 2
        for link in links:
            link.close()


def test_what_is_refused_is_counted_and_reported_once_a_minute(monkeypatch):
    now, texts = [100.0], []
    monkeypatch.setattr(module, "time", SimpleNamespace(monotonic=lambda: now[0]))
    connections = Connections("page", most=10, seconds=5.0)
    connections.report = texts.append
    for second in range(121):
        now[0] = 100.0 + second
        connections.count_refused()
        connections.check()
    assert [text.split(" connections refused")[0] for text in texts] == ["page: 1", "page: 60", "page: 60"]
    assert connections.refused == 121


def test_a_server_takes_a_share_of_the_descriptors(monkeypatch):
    resource = pytest.importorskip("resource")
    for descriptors, most in ((256, 64), (1 << 20, 128), (4, 2), (resource.RLIM_INFINITY, 128)):
        monkeypatch.setattr(resource, "getrlimit", lambda _, found=descriptors: (found, found))
        assert most_connections() == most
    monkeypatch.setenv("HELIBORE_LIMIT_CONNECTIONS", "1000")
    assert most_connections() == 1000

"""The open connections of a server: how many there may be, and how long one may take to show the token.

    listener --accept--> Connections.add -> stranger --admit: it has shown the token--> may stay
                                               |
                          a newcomer, or SECONDS later: it is ended, and counted

The server ends the stranger that has waited longest when another one comes. So strangers hold few descriptors, however
many they are, and a request that comes at once is always answered.
"""

from __future__ import annotations

import contextlib
import logging
import socket
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from helibore.base.limits import limit

LOGGER = logging.getLogger("helibore.connections")
LOGGER.addHandler(logging.NullHandler())  # a host decides where its events go
REPORT_EVERY = 60.0
"""Least seconds between two reports of refused connections."""
SHARE = 4
"""A server uses at most one in so many of the descriptors that the process may have; the others are for its work."""
STRANGERS = 16
"""Greatest number of connections that have not shown the token."""


def most_connections() -> int:
    """Return how many connections a server may hold: the limit ``connections``, but at most a share of descriptors."""
    try:
        import resource
    except ImportError:  # not on Windows
        return limit("connections")
    descriptors = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    return limit("connections") if descriptors < 0 else max(min(limit("connections"), descriptors // SHARE), 2)


@dataclass
class _Open:
    connection: Any
    since: float
    admitted: bool = False


class Connections:
    """The open connections of one server, by the address of their peer; any thread may call the methods.

    Attributes
    ----------
    refused : int
        Number of connections that were refused: ended before they showed the token, without a right token, or too many.
    report : callable
        Is called with a text after a connection was refused, at most once a minute. By default it is a warning of the
        logger ``helibore.connections``.
    """

    def __init__(self, name: str, most: int, strangers: int = STRANGERS, seconds: float | None = None) -> None:
        self.name, self.most, self.strangers = name, most, min(strangers, most)
        self.seconds = float(limit("token_seconds")) if seconds is None else seconds
        self.refused = 0
        self.report: Callable[[str], object] = LOGGER.warning
        self._open: dict[Any, _Open] = {}
        self._lock = threading.Lock()
        self._reported, self._report_from = 0, 0.0

    def add(self, connection: Any, peer: Any) -> bool:
        """Take a new connection as a stranger; return False, and count it, if there are too many connections."""
        with self._lock:
            for key in [key for key, one in self._open.items() if one.connection.fileno() < 0]:
                del self._open[key]
            if len(self._open) >= self.most:
                self.refused += 1
                return False
            waiting = [one for one in self._open.values() if not one.admitted]
            if len(waiting) >= self.strangers:
                self._end(min(waiting, key=lambda one: one.since))
            self._open[_key(peer)] = _Open(connection, time.monotonic())
            return True

    def admit(self, peer: Any) -> None:
        """Let the connection of a peer stay: a request on it has shown the token."""
        with self._lock:
            if one := self._open.get(_key(peer)):
                one.admitted = True

    def count_refused(self) -> None:
        """Count a connection that is refused because its request does not have the token."""
        with self._lock:
            self.refused += 1

    def remove(self, peer: Any) -> None:
        """Forget a connection that is closed; a connection whose socket was closed is forgotten without this."""
        with self._lock:
            self._open.pop(_key(peer), None)

    def check(self) -> None:
        """End each stranger that has waited too long, and report what was refused; call this a few times a second."""
        now = time.monotonic()
        with self._lock:
            for one in self._open.values():
                if not one.admitted and now - one.since > self.seconds:
                    self._end(one)
            refused, known = self.refused, self._reported
            if refused == known or now < self._report_from:
                return
            self._reported, self._report_from = refused, now + REPORT_EVERY
        most = f"at most {self.most} connections, {self.strangers} of them without the token"
        self.report(f"{self.name}: {refused - known} connections refused: no right token in {self.seconds:g} s; {most}")

    def _end(self, one: _Open) -> None:
        """End a stranger: whoever reads the connection sees its end and closes it. A second call does nothing."""
        if one.connection.fileno() < 0:
            return
        one.admitted = True  # it is counted once, and no stranger any more
        self.refused += 1
        with contextlib.suppress(OSError):
            one.connection.shutdown(socket.SHUT_RDWR)


def _key(peer: Any) -> Any:
    return tuple(peer[:2]) if isinstance(peer, tuple | list) else peer


class Listener(socket.socket):
    """A listening socket that adds each connection that it accepts to ``connections``, and closes those refused.

    It accepts one connection at a time: asyncio would accept all that wait, and read none of them meanwhile, so that a
    request with the token could be ended before it is read.
    """

    connections: Connections
    _pausing = False

    def accept(self) -> tuple[socket.socket, Any]:
        """Accept a connection; every second time, and if it is refused, raise BlockingIOError as if none had come."""
        self._pausing = not self._pausing
        if not self._pausing:
            raise BlockingIOError
        connection, peer = super().accept()
        if not self.connections.add(connection, peer):
            connection.close()
            raise BlockingIOError
        return connection, peer

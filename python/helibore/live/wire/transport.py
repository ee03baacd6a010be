"""Receive bytes as a TCP client or listener, from a serial port or a file, by one link at a time.

    open() -> Link      Link.read(seconds) -> bytes, b"" if nothing came, None if the link ended

``store.py`` has the links to stores. ``server.py`` sends bytes only if the ``mode`` of the source says so, and decides
when to try again.
"""

from __future__ import annotations

import ipaddress
import selectors
import socket
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from helibore.base.errors import needs, port_error
from helibore.live.wire import wits
from helibore.live.wire.address import Address

Network = ipaddress.IPv4Network | ipaddress.IPv6Network
CHUNK = 65536
PATIENCE = 3
"""A newcomer replaces a sender only after a silence of this many times the longest pause between the sender's bytes."""
ACCEPT_AGAIN = 1.0
"""Seconds until the next try after a connection could not be accepted, for example if no descriptor is free."""


class AccessDeniedError(OSError):
    """The peer refused the user, the password or the token. Another try would also fail, and could lock the account."""


class BusyError(OSError):
    """The peer asks to be left alone for ``seconds``."""

    def __init__(self, text: str, seconds: float) -> None:
        super().__init__(text)
        self.seconds = seconds


class Link(ABC):
    """One open connection.

    Attributes
    ----------
    useful
        Whether what came can be read; a refused answer of a store cannot.
    went_well
        Whether the link did at least once all that it should, so that earlier failures do not count any more.
    """

    peer: str
    useful: bool = True
    went_well: bool = True

    @abstractmethod
    def read(self, seconds: float) -> bytes | None:
        """Return bytes; b"" if no bytes came within ``seconds``; None if the link has ended."""

    def write(self, payload: bytes) -> None:  # noqa: B027  # not every kind sends
        """Send a heartbeat or a poll; links that cannot send ignore the call."""

    @property
    def holds(self) -> int:
        """Number of payloads that `read` has returned, of a link that acknowledges them; 0 of other links."""
        return 0

    def on_disk(self, mark: int) -> None:  # noqa: B027  # not every kind acknowledges
        """Acknowledge the first ``mark`` payloads: the journal has them on the disk."""

    def close(self) -> None:  # noqa: B027  # not every kind holds something open
        """Close the link."""


@dataclass
class Opener:
    """Opens links to one source by calling ``connect`` with a time limit in seconds.

    ``ends`` is whether the source ends when its link ends, as a file does.
    """

    connect: Callable[[float], Link | None]
    ends: bool = False

    def open(self, seconds: float) -> Link | None:
        """Return a link, or None if no peer came within ``seconds``; raise OSError if the link cannot be opened."""
        return self.connect(seconds)

    def close(self) -> None:
        """Close what stays open between two links, such as a listener."""


def readable(sockets: list[socket.socket], seconds: float) -> list[Any]:
    """Wait up to ``seconds`` until a socket can be read; return the sockets that can be read."""
    # unlike other selectors, a poll works with any descriptor number and needs no new descriptor
    with selectors.PollSelector() as selector:
        for one in sockets:
            selector.register(one, selectors.EVENT_READ)
        return [key.fileobj for key, _ in selector.select(seconds)]


def _keep_alive(connection: socket.socket) -> None:
    """Let the system detect within half a minute that the peer is gone, also if a cable is disconnected."""
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for option, value in (("TCP_KEEPIDLE", 10), ("TCP_KEEPINTVL", 5), ("TCP_KEEPCNT", 3)):
        if hasattr(socket, option):
            connection.setsockopt(socket.IPPROTO_TCP, getattr(socket, option), value)


class SocketLink(Link):
    """A TCP connection to a sender; ``listener`` decides whether a newcomer replaces this sender."""

    def __init__(
        self, connection: socket.socket, peer: str, listener: TcpListener | None = None, first: bytes = b""
    ) -> None:
        self.peer, self.last_received, self.longest = peer, time.monotonic(), 0.0
        self._connection, self._listener, self._first = connection, listener, first
        _keep_alive(connection)
        connection.settimeout(5.0)

    def read(self, seconds: float) -> bytes | None:
        if self._first:
            first, self._first = self._first, b""
            return first
        beside = self._listener.watched() if self._listener else []
        ready = readable([self._connection, *beside], seconds)
        if self._connection in ready:  # before newcomers: a sender that connects again has closed this link
            payload = self._connection.recv(CHUNK)
            now = time.monotonic()
            self.longest, self.last_received = max(self.longest, now - self.last_received), now
            return payload or None
        return None if self._listener and ready and self._listener.replaces(self, ready) else b""

    def write(self, payload: bytes) -> None:
        self._connection.sendall(payload)

    def close(self) -> None:
        self._connection.close()


def _connected(host: str, port: int, seconds: float) -> SocketLink:
    """Return a connection to a sender; if it fails, the OSError names the address."""
    name = f"{host}:{port}"
    try:
        return SocketLink(socket.create_connection((host, port), timeout=seconds), name)
    except OSError as error:
        raise OSError(f"{name}: {error.strerror or error}") from error


@dataclass
class Newcomer:
    """A connection that was accepted and is not read as the sender yet, and the bytes that have come from it."""

    connection: socket.socket
    peer: str
    parser: wits.Parser
    sent: bytes = b""


class Sender(Protocol):
    """What this file needs of the settings of a source that sends WITS."""

    @property
    def name(self) -> str: ...
    @property
    def address(self) -> Address: ...
    @property
    def allow(self) -> Sequence[Network]: ...
    @property
    def replace_after(self) -> float: ...
    @property
    def nulls(self) -> Sequence[float]: ...
    @property
    def limits(self) -> tuple[int, int, int]: ...


class TcpListener(Opener):
    """Accepts one sender at a time; ``refuse`` reports each peer that is refused, by rule and text.

    A peer outside ``allow`` is refused. A newcomer replaces the sender only if the sender has been silent for at least
    ``replace_after`` seconds and at least `PATIENCE` times the longest interval between its bytes, and only after
    the newcomer sent a whole frame with an item.
    """

    def __init__(self, source: Sender, refuse: Callable[[str, str], None]) -> None:
        super().__init__(self._next)
        host, port = source.address.host, source.address.port
        family = socket.AF_INET6 if ":" in host else socket.AF_INET
        try:
            self._listening = socket.create_server((host, port), family=family, backlog=64)
        except OSError as error:
            raise port_error(error, host, port, f"address of [source.{source.name}]") from error
        self._listening.settimeout(0.0)
        self.port = int(self._listening.getsockname()[1])
        self._source, self._refuse = source, refuse
        self._allow = source.allow
        self._newcomer: Newcomer | None = None
        self._accept_from = 0.0

    def _next(self, seconds: float) -> Link | None:
        """Return the next allowed connection, or None if none came within ``seconds``."""
        if self._newcomer is None and readable(self.watched(), seconds):
            self._accept()
        if (one := self._newcomer) is None:
            return None
        self._newcomer = None
        return SocketLink(one.connection, one.peer, self, one.sent)

    def watched(self) -> list[socket.socket]:
        """Return the sockets to wait for besides the sender's: the listener and the newcomer."""
        listening = [self._listening] if time.monotonic() >= self._accept_from else []
        return listening + ([self._newcomer.connection] if self._newcomer else [])

    def _accept(self) -> None:
        """Accept a newcomer, or refuse it if it is not allowed or if another newcomer waits."""
        try:
            connection, address = self._listening.accept()
        except BlockingIOError:
            return  # the peer closed the connection again
        except OSError as error:
            self._accept_from = time.monotonic() + ACCEPT_AGAIN
            self._refuse("link", f"a connection could not be accepted: {error}")
            return
        peer = ipaddress.ip_address(str(address[0]).partition("%")[0])
        mapped = getattr(peer, "ipv4_mapped", None) or peer
        if not any(mapped in network for network in self._allow if network.version == mapped.version):
            connection.close()
            self._refuse("refused", f"{mapped}: is not in allow")
        elif self._newcomer is not None:
            connection.close()
            self._refuse("refused", f"{mapped}: another newcomer is being checked")
        else:
            parser = wits.Parser(self._source.nulls, *self._source.limits)
            self._newcomer = Newcomer(connection, f"{address[0]}:{address[1]}", parser)

    def replaces(self, sender: SocketLink, ready: list[Any]) -> bool:
        """Accept a newcomer or read its bytes; return whether it replaces ``sender``."""
        if self._listening in ready:
            self._accept()
        one = self._newcomer
        if one is None:
            return False
        silent = time.monotonic() - sender.last_received
        if silent < max(self._source.replace_after, PATIENCE * sender.longest):
            return self._drop("another sender is connected")
        if one.connection not in ready:
            return False
        try:
            piece = one.connection.recv(CHUNK)
        except OSError:
            piece = b""
        one.sent += piece
        if not piece or len(one.sent) > CHUNK:
            return self._drop("another sender is connected, and no whole frame came")
        return bool(len(one.parser.feed(piece).items))

    def _drop(self, why: str) -> bool:
        assert self._newcomer is not None
        self._refuse("refused", f"{self._newcomer.peer}: {why}")
        self._newcomer.connection.close()
        self._newcomer = None
        return False

    def close(self) -> None:
        self._listening.close()
        if self._newcomer:
            self._newcomer.connection.close()


class SerialLink(Link):
    """An open serial port."""

    def __init__(self, port: Any, peer: str) -> None:
        self.peer, self._port = peer, port

    def read(self, seconds: float) -> bytes | None:
        self._port.timeout = seconds
        first = self._port.read(1)
        return bytes(first + self._port.read(min(self._port.in_waiting, CHUNK))) if first else b""

    def write(self, payload: bytes) -> None:
        self._port.write(payload)

    def close(self) -> None:
        self._port.close()


class FileLink(Link):
    """An open file that gives ``speed`` bytes a second; with 0, it gives all bytes at once."""

    def __init__(self, file: Path, speed: float) -> None:
        self.peer, self._speed = str(file), speed
        self._stream = file.open("rb")
        self._start, self._sent = time.monotonic(), 0

    def read(self, seconds: float) -> bytes | None:
        size = CHUNK
        if self._speed:
            due = int((time.monotonic() - self._start) * self._speed) - self._sent
            if due <= 0:
                time.sleep(min(seconds, 1.0 / self._speed))
                return b""
            size = min(due, CHUNK)
        payload = self._stream.read(size)
        self._sent += len(payload)
        return payload or None

    def close(self) -> None:
        self._stream.close()


def opener(source: Sender, refuse: Callable[[str, str], None]) -> Opener:
    """Return the opener for a source that is not a store; ``refuse`` is as in `TcpListener`.

    Raises
    ------
    OSError
        If the address of a listener cannot be used.
    MissingExtraError
        If pyserial (for a serial source) is not installed.
    """
    address = source.address
    if address.kind == "listen":
        return TcpListener(source, refuse)
    if address.kind == "file":
        return Opener(lambda _: FileLink(Path(address.file), address.speed), ends=True)
    if address.kind == "tcp":
        return Opener(lambda seconds: _connected(address.host, address.port, max(seconds, 5.0)))
    with needs("pyserial", "serial"):
        import serial
    file, baud = address.file, address.baud
    return Opener(lambda seconds: SerialLink(serial.Serial(file, baud, timeout=seconds, write_timeout=5), file))

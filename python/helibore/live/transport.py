"""Where bytes come from: TCP client and listener, serial port, file (a store: store.py). One link at a time each.

    open() -> Link      Link.read(seconds) -> bytes, b"" when nothing came, None when the link ended

Nothing is ever written unless the source's mode says so. Not here: what the bytes mean, when to try again.
"""

from __future__ import annotations

import contextlib
import ipaddress
import select
import socket
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

from helibore.live.sources import Source
from helibore.live.store import Position, StoreClient

CHUNK = 65536
REPLACE_AFTER = 10.0
"""Seconds of silence after which a listener lets a new connection take the place of the one it has."""


class Link(Protocol):
    """One open connection."""

    peer: str

    def read(self, seconds: float) -> bytes | None:
        """Return bytes, b"" when none came within ``seconds``, None when the link has ended."""

    def write(self, payload: bytes) -> None:
        """Send a heartbeat or a poll."""

    def close(self) -> None:
        """Close it."""


class Opener(Protocol):
    """Opens links to one source."""

    ends: bool
    """Whether the source is over when its link ends (a file)."""

    def open(self, seconds: float) -> Link | None:
        """Return a link, None when none came within ``seconds``; OSError when it cannot be."""

    def close(self) -> None:
        """Close it."""


def _keep_alive(connection: socket.socket) -> None:
    """Notice within half a minute that the other side is gone, with a cable pulled too."""
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for option, value in (("TCP_KEEPIDLE", 10), ("TCP_KEEPINTVL", 5), ("TCP_KEEPCNT", 3)):
        if hasattr(socket, option):
            connection.setsockopt(socket.IPPROTO_TCP, getattr(socket, option), value)


class SocketLink:
    """A TCP connection; ``watch`` is called when ``beside`` (the listener) has something."""

    def __init__(
        self, connection: socket.socket, peer: str, beside: socket.socket | None = None,
        watch: Callable[[], bool] = lambda: False,
    ) -> None:  # fmt: skip
        self.peer = peer
        self._connection, self._beside, self._watch = connection, beside, watch
        _keep_alive(connection)
        connection.settimeout(5.0)

    def read(self, seconds: float) -> bytes | None:
        """Return what came."""
        sockets = [self._connection, *([self._beside] if self._beside else [])]
        ready, _, _ = select.select(sockets, [], [], seconds)
        if self._connection in ready:  # first: a sender that left and came back has left
            return self._connection.recv(CHUNK) or None
        return None if self._beside in ready and self._watch() else b""

    def write(self, payload: bytes) -> None:
        """Send ``payload``."""
        self._connection.sendall(payload)

    def close(self) -> None:
        """Close the connection."""
        self._connection.close()


class TcpClient:
    """Connects to a server."""

    ends = False

    def __init__(self, source: Source) -> None:
        self._target = (source.address.host, source.address.port)

    def open(self, seconds: float) -> Link | None:
        """Connect, within ``seconds``."""
        connection = socket.create_connection(self._target, timeout=max(seconds, 5.0))
        return SocketLink(connection, f"{self._target[0]}:{self._target[1]}")

    def close(self) -> None:
        """Nothing is held."""


class TcpListener:
    """Waits for one sender at a time; a peer that is not allowed, or that comes while another sends, is refused."""

    ends = False

    def __init__(self, source: Source, refuse: Callable[[str, str], None]) -> None:
        host, port = source.address.host, source.address.port
        family = socket.AF_INET6 if ":" in host else socket.AF_INET
        self._listening = socket.socket(family, socket.SOCK_STREAM)
        self._listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            self._listening.bind((host, port))
        except OSError:
            self._listening.close()
            raise
        self._listening.listen(64)
        self.port = int(self._listening.getsockname()[1])
        self._allow = [ipaddress.ip_network(network) for network in source.allow]
        self._refuse = refuse
        self._waiting: tuple[socket.socket, str] | None = None
        self._link: SocketLink | None = None
        self._last_received = 0.0

    def open(self, seconds: float) -> Link | None:
        """Return the next allowed connection."""
        self._link = None
        if self._waiting is None:
            ready, _, _ = select.select([self._listening], [], [], seconds)
            if ready:
                self._accept()
        if self._waiting is None:
            return None
        (connection, peer), self._waiting = self._waiting, None
        self._last_received = time.monotonic()
        link = _NotingSocketLink(connection, peer, self._listening, self._another)
        link.last_received = self._note_received
        return link

    def _note_received(self) -> None:
        self._last_received = time.monotonic()

    def _accept(self) -> None:
        connection, address = self._listening.accept()
        peer = ipaddress.ip_address(str(address[0]).partition("%")[0])
        mapped = getattr(peer, "ipv4_mapped", None) or peer
        if any(mapped in network for network in self._allow if network.version == mapped.version):
            self._waiting = connection, f"{address[0]}:{address[1]}"
            return
        connection.close()
        self._refuse("refused", f"{mapped}: is not in allow")

    def _another(self) -> bool:
        """A second sender connects: True if it replaces a silent one."""
        self._accept()
        if self._waiting is None:
            return False
        if time.monotonic() - self._last_received > REPLACE_AFTER:
            return True
        (connection, peer), self._waiting = self._waiting, None
        connection.close()
        self._refuse("refused", f"{peer}: another sender is connected")
        return False

    def close(self) -> None:
        """Stop listening."""
        self._listening.close()


class _NotingSocketLink(SocketLink):
    """Notes when bytes came."""

    last_received: Callable[[], None] = staticmethod(lambda: None)

    def read(self, seconds: float) -> bytes | None:
        payload = super().read(seconds)
        if payload:
            self.last_received()
        return payload


class SerialPort:
    """A serial line, 8N1."""

    ends = False

    def __init__(self, source: Source) -> None:
        try:
            import serial
        except ImportError as error:
            raise ImportError('serial sources need pyserial: pip install "helibore[serial]"') from error
        self._serial: Any = serial
        self._file, self._baud = source.address.file, source.address.baud

    def open(self, seconds: float) -> Link | None:
        """Open the port."""
        return SerialLink(self._serial.Serial(self._file, self._baud, timeout=seconds, write_timeout=5), self._file)

    def close(self) -> None:
        """Nothing is held."""


class SerialLink:
    """An open serial port."""

    def __init__(self, port: Any, peer: str) -> None:
        self.peer, self._port = peer, port

    def read(self, seconds: float) -> bytes | None:
        """Return what came."""
        self._port.timeout = seconds
        first = self._port.read(1)
        return bytes(first + self._port.read(min(self._port.in_waiting, CHUNK))) if first else b""

    def write(self, payload: bytes) -> None:
        """Send ``payload``."""
        self._port.write(payload)

    def close(self) -> None:
        """Close the port."""
        self._port.close()


class FileReplay:
    """A recorded stream, at ``speed`` bytes a second (0: as fast as it is taken)."""

    ends = True

    def __init__(self, source: Source) -> None:
        self._file, self._speed = Path(source.address.file), source.address.speed

    def open(self, seconds: float) -> Link | None:  # noqa: ARG002 (a file is there or it is not)
        """Open the file."""
        return FileLink(self._file, self._speed)

    def close(self) -> None:
        """Nothing is held."""


class FileLink:
    """An open file."""

    def __init__(self, file: Path, speed: float) -> None:
        self.peer, self._speed = str(file), speed
        self._stream = file.open("rb")
        self._start, self._sent = time.monotonic(), 0

    def read(self, seconds: float) -> bytes | None:
        """Return what is due."""
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

    def write(self, payload: bytes) -> None:
        """A file is not written to."""

    def close(self) -> None:
        """Close the file."""
        self._stream.close()


def opener(source: Source, refuse: Callable[[str, str], None], position: Position = lambda: None) -> Opener:
    """Return what opens links to ``source``; ``refuse`` reports refused peers, ``position`` returns a log's last index.

    Raises
    ------
    OSError
        If a listener cannot have its address.
    ImportError
        If a serial source lacks pyserial, or a store httpx2.
    ValueError
        If a store's password or certificates are missing.
    """
    if source.address.kind == "https":
        return StoreClient(source, position)
    if source.address.kind == "listen":
        return TcpListener(source, refuse)
    kinds: dict[str, Callable[[Source], Opener]] = {"tcp": TcpClient, "serial": SerialPort, "file": FileReplay}
    return kinds[source.address.kind](source)


def close_quietly(link: Link) -> None:
    """Close a link that may be broken already."""
    with contextlib.suppress(OSError):
        link.close()

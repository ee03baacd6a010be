"""A WebSocket to a server, read by the thread that calls: the rules of ``websockets`` over one socket.

The connections of ``websockets`` itself read and ping in two more threads, and each message waits until both have run.
Certificates are always verified. Redirects are not followed: the headers may hold a secret.
"""

from __future__ import annotations

import contextlib
import socket
import ssl
import time
from collections import deque
from collections.abc import Mapping

from websockets.client import ClientProtocol
from websockets.frames import Frame, Opcode
from websockets.protocol import State
from websockets.typing import Subprotocol
from websockets.uri import parse_uri

from helibore.live.wire.address import Address
from helibore.live.wire.transport import CHUNK, readable

SEND = 5.0
"""Seconds in which the server must take what is sent, and complete a TLS record that has begun."""
KEEP_ALIVE = 15.0
"""Seconds after which a silent server is pinged, and after which it counts as gone."""
TOO_LONG = 1009
"""Code with which a connection ends because of a message above the limit."""


class EndedError(OSError):
    """The connection has ended; ``too_long`` is whether a message above the limit came."""

    def __init__(self, text: str, *, too_long: bool) -> None:
        super().__init__(text)
        self.too_long = too_long


class WebSocket:
    """One connection.

    Parameters
    ----------
    address
        The server.
    subprotocol
        What both sides will speak; ``spoken`` is what the server chose, or None.
    headers
        Headers of the request.
    trust
        Certificates of authorities; None: without encryption.
    most_bytes
        A longer message ends the connection.
    seconds
        The longest time until the server has answered.

    Raises
    ------
    OSError
        If there is no connection; TimeoutError if the time has passed.
    websockets.exceptions.InvalidHandshake
        If the server does not open a WebSocket.
    """

    def __init__(
        self, address: Address, subprotocol: str, headers: Mapping[str, str], trust: ssl.SSLContext | None,
        most_bytes: int, seconds: float,
    ) -> None:  # fmt: skip
        end = time.monotonic() + seconds
        self._protocol = ClientProtocol(
            parse_uri(address.url), subprotocols=[Subprotocol(subprotocol)], max_size=most_bytes
        )
        self._messages = deque[bytes]()
        self._parts: list[bytes] = []
        self._heard, self._pinged = time.monotonic(), False
        self._socket = socket.create_connection((address.host, address.port), timeout=seconds)
        try:
            if trust:
                self._socket = trust.wrap_socket(self._socket, server_hostname=address.host)
            self._socket.settimeout(SEND)
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            request = self._protocol.connect()
            request.headers.update(headers)
            self._protocol.send_request(request)
            self._flush()
            while self._protocol.state is State.CONNECTING and not self._protocol.handshake_exc:
                if (left := end - time.monotonic()) <= 0:
                    raise TimeoutError
                self._take(left)
            if self._protocol.handshake_exc:
                raise self._protocol.handshake_exc
        except BaseException:
            self._socket.close()
            raise
        self.spoken = self._protocol.subprotocol

    def send(self, message: bytes) -> None:
        """Send a binary message."""
        if self._protocol.state is not State.OPEN:
            raise self._ended()
        self._protocol.send_binary(message)
        self._flush()

    def receive(self, seconds: float) -> bytes | None:
        """Return a message, None if none came within ``seconds``; raise EndedError after the last one."""
        end = time.monotonic() + seconds
        while not self._messages:
            if self._protocol.state is not State.OPEN:
                raise self._ended()
            self._take(max(end - time.monotonic(), 0.0))
            self._keep_alive()
            if not self._messages and time.monotonic() >= end and self._protocol.state is State.OPEN:
                return None
        return self._messages.popleft()

    def close(self) -> None:
        """Say that the connection ends, and end it."""
        with contextlib.suppress(OSError):
            if self._protocol.state is State.OPEN:
                self._protocol.send_close(1000)
                self._flush()
        self._socket.close()

    def _take(self, seconds: float) -> None:
        """Take what comes within ``seconds``, and send what the protocol answers."""
        decrypted = isinstance(self._socket, ssl.SSLSocket) and self._socket.pending()
        if not decrypted and not readable([self._socket], seconds):
            return
        try:
            payload = self._socket.recv(CHUNK)
        except OSError:
            payload = b""
        self._heard, self._pinged = time.monotonic(), False
        if payload:
            self._protocol.receive_data(payload)
        else:
            self._protocol.receive_eof()
        self._flush()
        for event in self._protocol.events_received():
            if isinstance(event, Frame) and event.opcode in (Opcode.TEXT, Opcode.BINARY, Opcode.CONT):
                self._parts.append(bytes(event.data))
                if event.fin:
                    self._messages.append(b"".join(self._parts))
                    self._parts = []

    def _flush(self) -> None:
        """Send what the protocol wants to send; an empty piece ends the sending."""
        try:
            for piece in self._protocol.data_to_send():
                if piece:
                    self._socket.sendall(piece)
                else:
                    self._socket.shutdown(socket.SHUT_WR)
        except OSError:
            if self._protocol.state is State.OPEN:
                self._protocol.receive_eof()

    def _keep_alive(self) -> None:
        """Ping a silent server; one that stays silent is gone."""
        silent = time.monotonic() - self._heard
        if silent > KEEP_ALIVE and not self._pinged and self._protocol.state is State.OPEN:
            self._protocol.send_ping(b"")
            self._flush()
            self._pinged, self._heard = True, time.monotonic()
        elif silent > KEEP_ALIVE and self._protocol.state is State.OPEN:
            raise EndedError(f"the server sent nothing for {2 * KEEP_ALIVE:g} s", too_long=False)

    def _ended(self) -> EndedError:
        sent, received = self._protocol.close_sent, self._protocol.close_rcvd
        if received is None and sent is not None:  # what came broke a rule
            text = f"address: what came is no message of a WebSocket: {sent.reason}"
            return EndedError(text, too_long=sent.code == TOO_LONG)
        why = f": {received.reason}" if received and received.reason else ""
        return EndedError(f"the server closed the connection{why}", too_long=False)

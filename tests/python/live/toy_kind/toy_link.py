"""The links of the toy kind."""

from __future__ import annotations

import socket

from helibore.live.wire.transport import Link, Opener


class ToyLink(Link):
    def __init__(self, host: str, port: int, greeting: str) -> None:
        self.peer = f"{host}:{port}"
        self._socket = socket.create_connection((host, port), timeout=5)
        self._socket.sendall(greeting.encode() + b"\n")

    def read(self, seconds: float) -> bytes | None:
        self._socket.settimeout(seconds)
        try:
            return self._socket.recv(4096) or None
        except TimeoutError:
            return b""

    def close(self) -> None:
        self._socket.close()


class ToyOpener(Opener):
    def __init__(self, host: str, port: int, greeting: str) -> None:
        super().__init__(lambda _: ToyLink(host, port, greeting))

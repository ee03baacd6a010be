"""Serve the metrics of ``helibore live`` over HTTP or HTTPS, and decide who may read the metrics and the page."""

from __future__ import annotations

import hmac
import http.server
import os
import queue
import socket
import ssl
import time
from contextlib import suppress
from dataclasses import dataclass
from http import HTTPStatus
from typing import Any
from urllib.parse import parse_qs, urlsplit

from helibore.base.errors import InputError, port_error
from helibore.cli.prometheus_metrics import metrics
from helibore.live.server import Server

CONNECTIONS, SECONDS = 8, 5.0
"""Greatest number of connections at a time, and of seconds that a connection may last."""


@dataclass(frozen=True)
class Access:
    """The address that serves page and metrics, the secret that both require, and the PEM files for HTTPS.

    Raises
    ------
    InputError
        If other machines can reach ``host`` and there is no token, if the token is empty, if there is a key without a
        certificate, or if the certificate cannot be used.
    """

    host: str = "127.0.0.1"
    token: str | None = None
    certificate: str | None = None
    key: str | None = None

    def __post_init__(self) -> None:
        if self.token == "":
            raise InputError("token", "must not be empty")
        if not self.token and not (self.host in ("localhost", "::1") or self.host.startswith("127.")):
            raise InputError(f"host {self.host}", "is open to other machines, so it needs a token")
        if self.key and not self.certificate:
            raise InputError("key", "needs a certificate")
        self.context()

    def context(self) -> ssl.SSLContext | None:
        """Return the SSL context for HTTPS; None for HTTP."""
        if self.certificate is None:
            return None
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        try:
            context.load_cert_chain(self.certificate, self.key)
        except (OSError, ValueError) as error:  # an error of ssl is an OSError
            raise InputError("certificate", f"cannot be used with its key: {error}", repr(self.certificate)) from None
        return context

    def permits(self, query: str, authorization: str) -> bool:
        """Return whether no token is required, or the request has it as ``?token=`` or ``Authorization: Bearer``."""
        given = [*parse_qs(query).get("token", []), authorization.removeprefix("Bearer ")]
        wanted = (self.token or "").encode()
        return not wanted or any(hmac.compare_digest(one.encode(), wanted) for one in given)


class MetricsServer(http.server.HTTPServer):
    """Serves /metrics to at most `CONNECTIONS` connections at a time, and ends a connection after `SECONDS`.

    All its threads start with the server, and it keeps a file descriptor in reserve. Therefore the server still answers
    when the process can get no more threads or file descriptors.
    """

    def __init__(self, server: Server, port: int, access: Access) -> None:
        class Pages(http.server.BaseHTTPRequestHandler):
            timeout = SECONDS

            def do_GET(self) -> None:
                parts = urlsplit(self.path)
                if not access.permits(parts.query, self.headers.get("Authorization", "")):
                    status, body = HTTPStatus.FORBIDDEN, b"token: missing or wrong\n"
                elif parts.path != "/metrics":
                    status, body = HTTPStatus.NOT_FOUND, b"only /metrics is here\n"
                else:
                    status, body = HTTPStatus.OK, metrics(server).encode()
                self.send_response(status)
                self.send_header("Content-Type", "text/plain; version=0.0.4")
                self.send_header("Content-Length", str(len(body)))
                self.end_headers()
                self.wfile.write(body)

            def log_message(self, *_: object) -> None:
                """Print nothing."""

        self.address_family = socket.AF_INET6 if ":" in access.host else socket.AF_INET
        try:
            super().__init__((access.host, port), Pages)
        except OSError as error:
            raise port_error(error, access.host, port, "port for metrics (--metrics-port)") from error
        if context := access.context():
            self.socket = context.wrap_socket(self.socket, server_side=True, do_handshake_on_connect=False)
        self._asked: queue.Queue[Any] = queue.Queue()
        self._since: dict[Any, float] = {}  # by open connection: when it was accepted
        self._reserve = os.open(os.devnull, os.O_RDONLY)
        metrics(server)  # the first call of `metrics` imports a library
        for name, run in (
            ("metrics", self.serve_forever),
            *((f"metrics {n}", self._answer) for n in range(CONNECTIONS)),
        ):
            server.thread(name, run).start()

    def get_request(self) -> Any:
        try:
            return super().get_request()
        except OSError:
            if self._reserve < 0:
                time.sleep(0.1)  # the client still waits; `serve_forever` would try again at once
                raise
            os.close(self._reserve)
            self._reserve = -1
            return super().get_request()

    def process_request(self, request: Any, client_address: Any) -> None:
        """Pass a connection to a thread; refuse the connection if all threads are busy."""
        if len(self._since) >= CONNECTIONS:
            self.shutdown_request(request)
            return
        self._since[request] = time.monotonic()
        self._asked.put((request, client_address))

    def _answer(self) -> None:
        while (asked := self._asked.get()) is not None:
            request, address = asked
            with suppress(Exception):  # a client may leave or be slow
                self.finish_request(request, address)
            self.shutdown_request(request)
            del self._since[request]
            if self._reserve < 0:
                with suppress(OSError):
                    self._reserve = os.open(os.devnull, os.O_RDONLY)

    def service_actions(self) -> None:
        """End the connections that have taken more than `SECONDS`."""
        for request, since in list(self._since.items()):
            if time.monotonic() - since > SECONDS:
                with suppress(OSError):
                    request.shutdown(socket.SHUT_RDWR)

    def handle_error(self, *_: object) -> None:
        """Ignore errors of a request: a client may leave or be slow."""

    def close(self) -> None:
        self.shutdown()
        for _ in range(CONNECTIONS):
            self._asked.put(None)
        self.server_close()
        if self._reserve >= 0:
            os.close(self._reserve)

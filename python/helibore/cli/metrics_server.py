"""Serve the metrics of ``helibore live`` over HTTP or HTTPS, to who has the token."""

from __future__ import annotations

import http.server
import os
import queue
import socket
import time
from contextlib import suppress
from http import HTTPStatus
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from helibore.base.connections import Connections
from helibore.base.errors import port_error
from helibore.base.limits import limit
from helibore.cli.prometheus_metrics import metrics
from helibore.live.server import Server

if TYPE_CHECKING:
    from helibore.base.identity import Access

CONNECTIONS = 8
"""Greatest number of connections that are read at a time."""


class MetricsServer(http.server.HTTPServer):
    """Serves /metrics to at most `CONNECTIONS` connections at a time; ``connections`` bounds those without the token.

    All its threads start with the server, and it keeps a file descriptor in reserve. Therefore the server still answers
    when the process can get no more threads or file descriptors. ``beside`` are the connections of the page.
    """

    request_queue_size = 4 * CONNECTIONS  # a burst of connections: with the default of 5, some wait for seconds

    def __init__(self, server: Server, port: int, access: Access, beside: Connections | None = None) -> None:
        connections = Connections("metrics", 3 * CONNECTIONS, 2 * CONNECTIONS)
        shown = (connections, beside) if beside else (connections,)

        class Pages(http.server.BaseHTTPRequestHandler):
            timeout = limit("token_seconds")
            server_version, sys_version = "helibore", ""

            def do_GET(self) -> None:
                parts = urlsplit(self.path)
                headers = {name.lower(): value for name, value in self.headers.items()}
                if refusal := access.refusal(parts.path, parts.query, headers):
                    connections.count_refused()
                    status, body = HTTPStatus.FORBIDDEN, f"{refusal}\n".encode()
                elif parts.path != "/metrics":
                    status, body = HTTPStatus.NOT_FOUND, b"only /metrics is here\n"
                else:
                    connections.admit(self.client_address)
                    status, body = HTTPStatus.OK, metrics(server, shown).encode()
                self.send_response(status)
                self.send_header("Content-Type", "text/plain; version=0.0.4")
                self.send_header("Content-Length", str(len(body)))
                self.end_headers()
                self.wfile.write(body)

            def log_message(self, *_: object) -> None:
                """Print nothing."""

        self.connections = connections
        self.address_family = socket.AF_INET6 if ":" in access.host else socket.AF_INET
        try:
            super().__init__((access.host, port), Pages)
        except OSError as error:
            raise port_error(error, access.host, port, "port for metrics (--metrics-port)") from error
        if context := access.context():
            self.socket = context.wrap_socket(self.socket, server_side=True, do_handshake_on_connect=False)
        self.url = access.url(self.server_address[1], "metrics")
        self._asked: queue.Queue[Any] = queue.Queue()
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
        """Pass a connection to a thread, unless there are too many connections."""
        if self.connections.add(request, client_address):
            self._asked.put((request, client_address))
        else:
            self.shutdown_request(request)

    def _answer(self) -> None:
        while (asked := self._asked.get()) is not None:
            request, address = asked
            with suppress(Exception):  # a client may leave or be slow
                self.finish_request(request, address)
            self.connections.remove(address)
            self.shutdown_request(request)
            if self._reserve < 0:
                with suppress(OSError):
                    self._reserve = os.open(os.devnull, os.O_RDONLY)

    def service_actions(self) -> None:
        """End connections that do not show the token."""
        self.connections.check()

    def handle_error(self, *_: object) -> None:
        """Ignore errors of a request: a client may leave or be slow."""

    def close(self) -> None:
        self.shutdown()
        for _ in range(CONNECTIONS):
            self._asked.put(None)
        self.server_close()
        if self._reserve >= 0:
            os.close(self._reserve)

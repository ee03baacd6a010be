"""The server in its own thread. It binds the socket for uvicorn itself, so that a port in use raises an OSError."""

from __future__ import annotations

import contextlib
import ipaddress
import socket
import threading
import time
from typing import Any
from urllib.parse import quote

from helibore.base.errors import InputError, needs, port_error
from helibore.viewer.scene import Scene

START_SECONDS = 20.0


class PageServer:
    """Serves a scene until `close`; over HTTPS if ``certificate``, a PEM file, is given.

    ``key`` is the PEM file of the certificate's key; None: the certificate's file also has the key. Raises InputError
    if ``host`` is open to other machines and there is no token, or if ``port`` is not in 0 to 65535; OSError if the
    port is in use.
    """

    def __init__(
        self, scene: Scene, *, host: str, port: int, token: str | None,
        certificate: str | None = None, key: str | None = None,
    ) -> None:  # fmt: skip
        loopback = host == "localhost"
        with contextlib.suppress(ValueError):
            loopback = loopback or ipaddress.ip_address(host).is_loopback
        if not loopback and not token:
            raise InputError(f"host {host}", "is open to other machines, so it needs a token")
        uvicorn = import_server()
        from helibore.viewer.access import LOOPBACK
        from helibore.viewer.html_export import MOST_ADDRESS
        from helibore.viewer.web_app import MOST_TEXT, application

        self._socket = _bind(host, port)
        name = f"[{host}]" if ":" in host else host
        bound = self._socket.getsockname()[1]
        scheme = "https" if certificate else "http"
        self.url = f"{scheme}://{name}:{bound}/" + (f"?token={quote(token, safe='')}" if token else "")
        config = uvicorn.Config(
            application(scene, token, tuple(dict.fromkeys((*LOOPBACK, name)))),
            ws="websockets-sansio",
            ssl_certfile=certificate,
            ssl_keyfile=key,
            ws_max_size=2 * MOST_TEXT,
            ws_per_message_deflate=False,
            h11_max_incomplete_event_size=2 * MOST_ADDRESS,  # the query escapes %41 of the address again, as %2541
            log_level="critical",
            access_log=False,
            lifespan="on",
            timeout_graceful_shutdown=1,
        )
        self._server = uvicorn.Server(config)
        run = {"sockets": [self._socket]}
        self._thread = threading.Thread(target=self._server.run, kwargs=run, name="helibore-view-server", daemon=True)
        self._thread.start()
        until = time.monotonic() + START_SECONDS
        while not self._server.started:
            if not self._thread.is_alive() or time.monotonic() > until:
                self.close()
                raise RuntimeError("the viewer's server did not start: this is a bug in helibore")
            time.sleep(0.005)

    @property
    def alive(self) -> bool:
        """Whether the thread is running."""
        return self._thread.is_alive()

    def wait(self) -> None:
        """Block until Ctrl-C, then close."""
        try:
            while self._thread.is_alive():
                self._thread.join(0.5)
        except KeyboardInterrupt:
            pass
        finally:
            self.close()

    def close(self) -> None:
        """Disconnect the pages and free the port. May be called twice."""
        self._server.should_exit = True
        self._thread.join(10)
        self._socket.close()


def import_server() -> Any:
    """Return uvicorn; raise `MissingExtraError` if a library of the extra ``view`` is missing."""
    with needs("", "view"):
        import starlette  # noqa: F401
        import uvicorn
        import websockets  # noqa: F401
    return uvicorn


PORT_OPTION = "port, or 0 (--port; --view-port of helibore live)"


def _bind(host: str, port: int) -> socket.socket:
    if not 0 <= port <= 65535:
        raise InputError("port", "must be from 0 to 65535", str(port))
    bound = socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET, socket.SOCK_STREAM)
    bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        bound.bind((host, port))
        bound.listen(128)
    except OSError as error:
        bound.close()
        raise port_error(error, host, port, PORT_OPTION) from error
    return bound

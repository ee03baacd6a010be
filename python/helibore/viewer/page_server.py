"""The server in its own thread. It binds the socket for uvicorn itself, so that a port in use raises an OSError.

The socket is a `Listener`: connections that do not show the token are few, and are ended soon.
"""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Sequence
from typing import Any

from helibore.base.connections import Connections, Listener, most_connections
from helibore.base.errors import InputError, needs, port_error
from helibore.base.identity import Access
from helibore.viewer.scene import Scene

START_SECONDS = 20.0
BACKLOG = 128
"""Connections that the system holds until they are accepted."""


class PageServer:
    """Serves a scene, or those of several wells, until `close`, at the address and with the token of ``access``.

    ``connections`` counts the connections that were refused. Raises InputError if ``port`` is not in 0 to 65535;
    OSError if the port is in use.
    """

    def __init__(self, shown: Scene | Sequence[Scene], access: Access, *, port: int = 0) -> None:
        uvicorn = import_server()
        from helibore.viewer.html_export import MOST_ADDRESS
        from helibore.viewer.web_app import MOST_TEXT, application

        self.connections = Connections("page", most_connections())
        self._socket = _bind(access.host, port, self.connections)
        self.url = access.url(self._socket.getsockname()[1])
        config = uvicorn.Config(
            application(shown, access, self.connections),
            loop="asyncio",  # others do not accept connections by the method of the socket
            http="h11",
            ws="websockets-sansio",
            proxy_headers=False,  # a header must not say from where a connection comes
            ssl_certfile=access.certificate,
            ssl_keyfile=access.key,
            ws_max_size=2 * MOST_TEXT,
            ws_per_message_deflate=False,
            h11_max_incomplete_event_size=2 * MOST_ADDRESS,  # the query escapes %41 of the address again, as %2541
            log_level="critical",
            access_log=False,
            lifespan="on",
            backlog=BACKLOG,
            server_header=False,
            timeout_graceful_shutdown=1,
        )
        connections = self.connections

        class Server(uvicorn.Server):  # type: ignore[misc, name-defined]  # a class of the extra
            async def on_tick(self, counter: int) -> bool:
                """Check the connections ten times a second."""
                connections.check()
                return bool(await super().on_tick(counter))

        self._server = Server(config)
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


PORT_OPTION = "port, or 0"


def _bind(host: str, port: int, connections: Connections) -> Listener:
    if not 0 <= port <= 65535:
        raise InputError("port", "must be from 0 to 65535", str(port))
    bound = Listener(socket.AF_INET6 if ":" in host else socket.AF_INET, socket.SOCK_STREAM)
    bound.connections = connections
    bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        bound.bind((host, port))
        bound.listen(BACKLOG)
    except OSError as error:
        bound.close()
        raise port_error(error, host, port, PORT_OPTION) from error
    return bound

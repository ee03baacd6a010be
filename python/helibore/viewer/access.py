"""Which requests the server answers, and what a browser may do with the answers.

If the viewer has a token, a request must have the same token, except for the paths in `NEEDS_NO_TOKEN`. Without a
token, the Host header must be a name of the viewer, so that a page of another server cannot reach the viewer through
another name for 127.0.0.1. In either case, if a browser sends an Origin, it must be that of the viewer. A browser
hides why a websocket failed to open, so a websocket with a wrong token is opened and then closed with the reason.
"""

from __future__ import annotations

import contextlib
import hmac
from typing import Any
from urllib.parse import parse_qs, urlsplit

from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Receive, Scope, Send

LOOPBACK = ("127.0.0.1", "localhost", "[::1]")
NEEDS_NO_TOKEN = ("/app.js", "/app.css", "/healthz")
NO_TOKEN = "token: missing or wrong. Open the address that the viewer printed, with its ?token=..."
POLICY = (
    "default-src 'self'; connect-src 'self'; img-src 'self' data: blob:; style-src 'self'; object-src 'none'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'self' http://127.0.0.1:* http://localhost:*"
)
HEADERS = [
    (b"content-security-policy", POLICY.encode()),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cache-control", b"no-cache"),
]


class AccessControl:
    """Checks Host, Origin and token of each request, and adds `HEADERS` to each answer."""

    def __init__(self, app: ASGIApp, token: str | None, hosts: tuple[str, ...]) -> None:
        self.app, self.hosts = app, hosts
        self.token = token or None  # an empty token would protect nothing, and would switch off the check of the host

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def with_headers(message: Any) -> None:
            if message["type"] == "http.response.start":
                message["headers"] = [*message["headers"], *HEADERS]
            await send(message)

        refusal = self.refusal(scope) if scope["type"] in ("http", "websocket") else None
        if refusal is None:
            await self.app(scope, receive, with_headers)
        elif scope["type"] == "http":
            await PlainTextResponse(refusal + "\n", 403)(scope, receive, with_headers)
        else:
            await receive()
            if refusal == NO_TOKEN:
                await send({"type": "websocket.accept"})
            await send({"type": "websocket.close", "code": 4403, "reason": refusal[:120]})

    def refusal(self, scope: Scope) -> str | None:
        """Return why a request is refused, or None if it is not refused."""
        headers = {name.decode("latin-1").lower(): value.decode("latin-1") for name, value in scope["headers"]}
        host = headers.get("host", "")
        if self.token is None and _without_port(host) not in self.hosts:
            return f"host {host[:60]!r}: this viewer answers to {', '.join(self.hosts)} only"
        origin = headers.get("origin")
        if origin is not None and _host_of(origin) != host:
            return f"origin {origin[:60]!r}: only the viewer's own page may connect"
        if self.token is None or (scope["type"] == "http" and scope["path"] in NEEDS_NO_TOKEN):
            return None
        given = parse_qs(scope["query_string"].decode("latin-1")).get("token", [""])[0]
        return None if hmac.compare_digest(given.encode(), self.token.encode()) else NO_TOKEN


def _host_of(origin: str) -> str | None:
    with contextlib.suppress(ValueError):  # "http://[::1" has no host
        return urlsplit(origin).netloc
    return None


def _without_port(host: str) -> str:
    return host.rsplit(":", 1)[0] if ":" in host and not host.endswith("]") else host

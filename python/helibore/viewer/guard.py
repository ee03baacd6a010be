"""Who may ask the page's server anything, and what a browser may do with the answers.

The Host must be one we answer to (a page elsewhere cannot reach us through its own name for 127.0.0.1), the Origin,
where a browser sends one, must be ourselves, and beyond loopback the token must match. A page that is turned away is
told why: a browser hides the reason of a websocket that never opened, so one with a wrong token is opened, then closed
with a sentence.
"""

from __future__ import annotations

import hmac
from typing import Any
from urllib.parse import parse_qs, urlsplit

from starlette.responses import PlainTextResponse, Response
from starlette.types import ASGIApp, Receive, Scope, Send

LOOPBACK = ("127.0.0.1", "localhost", "[::1]", "::1")
OPEN_TO_ALL = ("/app.js", "/app.css", "/licences.txt", "/healthz")
NO_TOKEN = "token: missing or wrong. Open the address that the viewer printed, with its ?token=..."
POLICY = (
    "default-src 'self'; connect-src 'self'; img-src 'self' data: blob:; style-src 'self'; object-src 'none'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'self' http://127.0.0.1:* http://localhost:*"
)


class Guard:
    """Checks Host, Origin and token, and sets the headers that keep the page to itself."""

    def __init__(self, app: ASGIApp, token: str | None, hosts: tuple[str, ...]) -> None:
        self.app, self.token, self.hosts = app, token, hosts

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        refusal = self.refusal(scope)
        if refusal is None:
            await self.app(scope, receive, self._with_headers(send) if scope["type"] == "http" else send)
        elif scope["type"] == "http":
            await self._with_headers_response(PlainTextResponse(refusal + "\n", 403), scope, receive, send)
        else:
            await receive()
            if refusal == NO_TOKEN:
                await send({"type": "websocket.accept"})
            await send({"type": "websocket.close", "code": 4403, "reason": refusal[:120]})

    def refusal(self, scope: Scope) -> str | None:
        """Return why a request is turned away, or None."""
        headers = {name.decode("latin-1").lower(): value.decode("latin-1") for name, value in scope["headers"]}
        host = headers.get("host", "")
        if self.token is None and _name(host) not in self.hosts:
            return f"host {host[:60]!r}: this viewer answers to {', '.join(self.hosts)} only"
        origin = headers.get("origin")
        if origin is not None and urlsplit(origin).netloc != host:
            return f"origin {origin[:60]!r}: only the viewer's own page may connect"
        open_to_all = scope["type"] == "http" and scope["path"] in OPEN_TO_ALL
        if self.token is not None and not open_to_all:
            given = parse_qs(scope["query_string"].decode("latin-1")).get("token", [""])[0]
            if not hmac.compare_digest(given.encode(), self.token.encode()):
                return NO_TOKEN
        return None

    @staticmethod
    def _with_headers(send: Send) -> Send:
        async def sending(message: Any) -> None:
            if message["type"] == "http.response.start":
                message["headers"] = [
                    *message["headers"],
                    (b"content-security-policy", POLICY.encode()),
                    (b"x-content-type-options", b"nosniff"),
                    (b"referrer-policy", b"no-referrer"),
                    (b"cache-control", b"no-cache"),
                ]
            await send(message)

        return sending

    async def _with_headers_response(self, response: Response, scope: Scope, receive: Receive, send: Send) -> None:
        await response(scope, receive, self._with_headers(send))


def _name(host: str) -> str:
    """Return a Host header without its port."""
    return host.rsplit(":", 1)[0] if ":" in host and not host.endswith("]") else host

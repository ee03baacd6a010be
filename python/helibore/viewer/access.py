"""Which requests the page's server answers, and what a browser may do with the answers.

`helibore.base.identity` has the rule; this file applies it to Starlette. A browser hides why a websocket failed to
open, so a websocket without the token is opened and then closed with the reason.
"""

from __future__ import annotations

from typing import Any

from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Receive, Scope, Send

from helibore.base.connections import Connections
from helibore.base.identity import NO_TOKEN, Access

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
    """Refuses each request that `Access.refusal` refuses, and adds `HEADERS` to each answer.

    Each request that is answered admits its connection to ``connections``.
    """

    def __init__(self, app: ASGIApp, access: Access, connections: Connections | None = None) -> None:
        self.app, self.access, self.connections = app, access, connections

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def with_headers(message: Any) -> None:
            if message["type"] == "http.response.start":
                message["headers"] = [*message["headers"], *HEADERS]
            await send(message)

        refusal = self._refusal(scope) if scope["type"] in ("http", "websocket") else None
        if refusal is None:
            await self.app(scope, receive, with_headers)
        elif scope["type"] == "http":
            end = {"connection": "close"}
            await PlainTextResponse(refusal + "\n", 403, headers=end)(scope, receive, with_headers)
        else:
            await receive()
            if refusal == NO_TOKEN:
                await send({"type": "websocket.accept"})
            await send({"type": "websocket.close", "code": 4403, "reason": refusal[:120]})

    def _refusal(self, scope: Scope) -> str | None:
        headers = {name.decode("latin-1").lower(): value.decode("latin-1") for name, value in scope["headers"]}
        refusal = self.access.refusal(scope["path"], scope["query_string"].decode("latin-1"), headers)
        if self.connections is not None:
            if refusal is None:
                self.connections.admit(scope["client"])
            else:
                self.connections.count_refused()
        return refusal

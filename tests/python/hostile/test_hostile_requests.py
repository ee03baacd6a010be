"""Forty hostile requests to the servers of page and metrics: each is refused or ended, and the servers go on.

The corpus is a list of raw bytes. No request has the token, or it has a right one and breaks another rule. No answer
has a traceback or anything of the wall, and after all of them both servers answer who has the token.
"""

from __future__ import annotations

import socket
import urllib.request
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from urllib.parse import urlsplit

import pytest
from live_servers import Running, configured, free_port, until
from made_wall import MadeWall, curved_path
from patience import PATIENCE

pytest.importorskip("starlette", reason='the page needs the extra: pip install "helibore[view]"')
pytest.importorskip("uvicorn", reason='the page needs the extra: pip install "helibore[view]"')

from helibore.base.identity import Access
from helibore.cli.metrics_server import MetricsServer
from helibore.viewer.feed import Feed
from helibore.viewer.page_server import PageServer

TOKEN = "s3cret"
UPGRADE = (
    b"Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
    b"Sec-WebSocket-Key: YWJjZGVmZ2hpamtsbW5vcA==\r\n"
)
RIGHT = b"Authorization: Bearer s3cret\r\n"


def asked(target: bytes, more: bytes = b"", method: bytes = b"GET") -> bytes:
    return method + b" " + target + b" HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n" + more + b"\r\n"


REQUESTS: dict[str, bytes] = {
    # Without the token, or with a wrong one.
    "no token": asked(b"/"),
    "metrics without a token": asked(b"/metrics"),
    "empty token": asked(b"/metrics?token="),
    "token cut": asked(b"/healthz?token=s3cre"),
    "token and more": asked(b"/healthz?token=s3crett"),
    "token in the fragment": asked(b"/healthz#token=s3cret"),
    "token in the path": asked(b"/s3cret/healthz"),
    "wrong token first": asked(b"/healthz?token=wrong&token=s3cret"),
    "token as Basic": asked(b"/healthz", b"Authorization: Basic czNjcmV0\r\n"),
    "token in a cookie": asked(b"/healthz", b"Cookie: token=s3cret\r\n"),
    "token of other letters": asked(b"/healthz?token=S3CRET"),
    "token that is no UTF-8": asked(b"/healthz?token=%ff%fe"),
    "token of a million letters": asked(b"/healthz?token=" + b"a" * 1_000_000),
    "a pick without a token": asked(b"/api/pick", b"Content-Length: 2\r\n", b"PUT") + b"{}",
    "a delete without a token": asked(b"/api/pick?key=1", method=b"DELETE"),
    "a print without a token": asked(b"/api/print.pdf?start=1000&stop=1010"),
    "a websocket without a token": asked(b"/ws", UPGRADE).replace(b"Connection: close\r\n", b""),
    "another host": asked(b"/metrics").replace(b"127.0.0.1", b"evil.example"),
    "a forwarded address": asked(b"/healthz", b"X-Forwarded-For: 127.0.0.1\r\nX-Forwarded-Proto: https\r\n"),
    # With the token, from the page of another server.
    "another origin": asked(b"/healthz?token=s3cret", b"Origin: http://evil.example\r\n"),
    "origin null": asked(b"/metrics?token=s3cret", b"Origin: null\r\n"),
    "another site": asked(b"/metrics?token=s3cret", b"Sec-Fetch-Site: cross-site\r\n"),
    "another port of the site": asked(b"/api/picks.csv?token=s3cret", b"Sec-Fetch-Site: same-site\r\n"),
    "a print for another site": asked(b"/api/print.pdf?start=1&stop=2", RIGHT + b"Sec-Fetch-Site: cross-site\r\n"),
    "a websocket of another origin": asked(b"/ws?token=s3cret", UPGRADE + b"Origin: http://evil.example\r\n"),
    # No HTTP, or too much of it.
    "nothing": b"",
    "a byte": b"\0",
    "noise": bytes(range(256)) * 8,
    "TLS": b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + b"a" * 200,
    "HTTP/2": b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
    "HTTP/0.9": b"GET /metrics\r\n",
    "no version": b"GET /metrics HTTP/9.9\r\n\r\n",
    "half a request": b"GET /healthz?token=s3cret HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Half: ",
    "a line without end": b"GET /" + b"a" * 400_000,
    "a thousand headers": asked(b"/healthz", b"X: y\r\n" * 1000),
    "a header of a megabyte": asked(b"/healthz", b"X: " + b"y" * 1_000_000 + b"\r\n"),
    "two lengths": asked(b"/api/pick", b"Content-Length: 2\r\nContent-Length: 200\r\n", b"PUT") + b"{}",
    "length and chunks": asked(b"/api/pick", b"Content-Length: 2\r\nTransfer-Encoding: chunked\r\n", b"PUT") + b"0\r\n",
    "a chunk of 2**64 bytes": asked(b"/api/pick", b"Transfer-Encoding: chunked\r\n", b"PUT") + b"ffffffffffffffff\r\nx",
    "a path above the root": asked(b"/../../../../etc/passwd"),
}  # fmt: skip


@pytest.fixture(scope="module")
def ports(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, int]]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("HELIBORE_LIMIT_TOKEN_SECONDS", "1")
        access, metrics_port = Access(token=TOKEN), free_port()
        feed = Feed(MadeWall(5000), path=curved_path(), attributes={}, well="A-1")
        feed.scene.draw_pages = lambda *_: b"%PDF of the wall"
        page = PageServer(feed.scene, access)
        with Running(configured(f"listen://127.0.0.1:{free_port()}"), tmp_path_factory.mktemp("j")) as running:
            metrics = MetricsServer(running.server, metrics_port, access)
            yield {"page": urlsplit(page.url).port or 0, "metrics": metrics_port}
            assert page.connections.refused + metrics.connections.refused > len(REQUESTS)
            metrics.close()
        page.close()


def answer(port: int, request: bytes) -> bytes:
    """Return all that the server sends until it ends the connection."""
    received = b""
    with socket.create_connection(("127.0.0.1", port), timeout=PATIENCE) as link:
        try:
            link.sendall(request)
            while piece := link.recv(65536):
                received += piece
        except (ConnectionResetError, BrokenPipeError):  # it did not read all
            pass
    return received


def test_there_are_forty() -> None:
    assert len(REQUESTS) == 40


def test_no_hostile_request_gets_or_stops_anything(ports: dict[str, int]) -> None:
    with ThreadPoolExecutor(8) as pool:
        both = [(name, where) for name in REQUESTS for where in ports]
        answers = list(pool.map(lambda one: answer(ports[one[1]], REQUESTS[one[0]]), both))
    for one, received in zip(both, answers, strict=True):
        status = received.split(b" ")[1:2] if received.startswith(b"HTTP/") else []
        assert status in ([], [b"400"], [b"403"], [b"404"], [b"414"], [b"431"], [b"501"], [b"505"], [b"101"]), one
        for kept in (b"Traceback", b"helibore_", b'"vertices"', b"handshake", b"%PDF", b"<canvas", b"root:", b"s3cret"):
            assert kept not in received, one
        if status == [b"101"]:
            assert b"token: missing or wrong" in received, "it is opened to say why"

    def lives(where: str, path: str) -> bool:
        url = f"http://127.0.0.1:{ports[where]}/{path}?token={TOKEN}"
        with urllib.request.urlopen(url, timeout=PATIENCE) as page:
            return page.status == 200 and len(page.read()) > 20

    until(lambda: lives("page", "healthz") and lives("metrics", "metrics"))

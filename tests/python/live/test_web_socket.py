"""A WebSocket over one socket against the server of ``websockets``: whole messages, TLS, ends, silence, redirects."""

from __future__ import annotations

import contextlib
import socket
import ssl
import threading
import time

import pytest
from patience import PATIENCE, wait

pytest.importorskip("websockets", reason="ETP needs websockets")

from websockets.exceptions import InvalidHandshake, InvalidStatus
from websockets.sync.server import serve

from helibore.live.wire import web_socket
from helibore.live.wire.address import Address
from helibore.live.wire.web_socket import EndedError, WebSocket


@contextlib.contextmanager
def served(handler, **settings):
    """Serve each connection with ``handler``; yield the port."""
    server = serve(handler, "localhost", 0, subprotocols=["words"], **settings)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield server.socket.getsockname()[1]
    finally:
        server.shutdown()


def connected(port, kind="ws", trust=None, most=1 << 20, headers=None):
    address = Address(kind, host="localhost", port=port, url=f"{kind}://localhost:{port}/a/b?c")
    return contextlib.closing(WebSocket(address, "words", headers or {}, trust, most, PATIENCE))


def until_ended(link):
    """The messages up to the end, and the error that ends them."""
    came = []
    for _ in range(int(10 * PATIENCE)):
        try:
            if (message := link.receive(0.1)) is not None:
                came.append(message)
        except EndedError as error:
            return came, error
    raise AssertionError("it did not end")


def echo(link):
    for message in link:
        link.send(message)


@pytest.mark.parametrize("size", [0, 1, 125, 126, 65_535, 65_536, 1_000_000])
def test_a_message_of_any_length_comes_back(size):
    message = bytes(range(256)) * (size // 256) + bytes(size % 256)
    with served(echo) as port, connected(port) as link:
        assert link.spoken == "words"
        link.send(message)
        assert link.receive(PATIENCE) == message


def test_messages_in_pieces_and_together_come_in_order():
    def handler(link):
        link.send([b"ab", b"", b"c" * 70_000, b"d"])
        link.ping()
        link.send(b"1")
        link.send("text")
        link.close(1000, "enough")

    with served(handler) as port, connected(port) as link:
        came, error = until_ended(link)
    assert came == [b"ab" + b"c" * 70_000 + b"d", b"1", b"text"]
    assert str(error) == "the server closed the connection: enough"
    assert not error.too_long


def test_nothing_is_returned_in_time():
    with served(echo) as port, connected(port) as link:
        began = time.monotonic()
        assert link.receive(0.0) is None
        assert link.receive(0.1) is None
        assert time.monotonic() - began >= 0.1


@pytest.mark.parametrize("pieces", [1, 3])
def test_a_message_above_the_limit_ends_the_connection(pieces):
    def handler(link):
        link.send(b"small")
        link.send([b"x" * 500] * pieces if pieces > 1 else b"x" * 1001)
        link.recv()

    with served(handler) as port, connected(port, most=1000) as link:
        came, error = until_ended(link)
    assert came == [b"small"]
    assert error.too_long
    with pytest.raises(EndedError):
        link.send(b"more")


@pytest.mark.parametrize(
    ("sent", "why"), [(b"\x82\x81abcdz", "mask"), (b"\xf2\x01z", "reserved bits"), (b"\x80\x01z", "continuation")]
)
def test_bytes_that_break_the_rules_are_named(sent, why):
    def handler(link):
        link.send(b"good")
        link.socket.sendall(sent)
        link.recv()

    with served(handler) as port, connected(port) as link:
        came, error = until_ended(link)
    assert came == [b"good"]
    assert "address: what came is no message of a WebSocket" in str(error)
    assert why in str(error)


def test_encrypted_messages_longer_than_a_record_come_whole():
    trustme = pytest.importorskip("trustme")
    authority, context = trustme.CA(), ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    authority.issue_cert("localhost").configure_cert(context)
    trust = ssl.create_default_context()
    with served(echo, ssl=context) as port:
        with pytest.raises(ssl.SSLCertVerificationError), connected(port, "wss", trust):
            pass
        authority.configure_trust(trust)
        with connected(port, "wss", trust) as link:
            for size in (3, 200_000, 16_384, 5):
                link.send(b"x" * size)
            assert [len(link.receive(PATIENCE)) for _ in range(4)] == [3, 200_000, 16_384, 5]


def test_a_redirect_is_not_followed():
    asked, status = [], [302]

    def answer(connection, request):
        asked.append(request.headers.get("Authorization"))
        response = connection.respond(status[0], "there\n")
        response.headers["Location"] = f"ws://localhost:{request.headers['Host'].rpartition(':')[2]}/other"
        return response

    with served(echo, process_request=answer) as port, pytest.raises(InvalidStatus) as raised:
        connected(port, headers={"Authorization": "Bearer x"})
    assert raised.value.response.status_code == 302
    assert asked == ["Bearer x"]


def test_a_silent_server_is_pinged_and_kept_only_if_it_answers(monkeypatch):
    with served(echo) as port, connected(port) as link:
        for _ in range(3):
            link._heard -= 2 * web_socket.KEEP_ALIVE
            assert link.receive(0.0) is None
            assert link._pinged
            wait(lambda: link.receive(0.01) or not link._pinged, lambda: "no answer", pause=0.0)
        link.send(b"here")
        assert link.receive(PATIENCE) == b"here"
    monkeypatch.setattr(web_socket, "KEEP_ALIVE", 0.1)
    release = threading.Event()
    with served(lambda link: (stop_reading(link), release.wait(PATIENCE))) as port:
        with connected(port) as link:
            _, error = until_ended(link)
        release.set()
    assert "sent nothing" in str(error)


def stop_reading(link):
    """Let nothing that comes be answered."""
    link.protocol.receive_data = lambda _: None


@pytest.mark.parametrize("answer", [b"", b"HTTP/1.1 200 OK\r\n\r\n", b"\0" * 70_000, b"&&\r\n0108100\r\n!!\r\n"])
def test_a_server_of_another_kind_is_refused(answer):
    def speak(listening):
        link, _ = listening.accept()
        with link:
            link.recv(4096)
            link.sendall(answer)

    with socket.create_server(("localhost", 0)) as listening:
        speaker = threading.Thread(target=speak, args=(listening,), daemon=True)
        speaker.start()
        with pytest.raises(InvalidHandshake):
            connected(listening.getsockname()[1])
        speaker.join()


def test_a_server_that_says_nothing_costs_the_time_that_is_given():
    with socket.create_server(("localhost", 0)) as listening:
        port = listening.getsockname()[1]
        address = Address("ws", host="localhost", port=port, url=f"ws://localhost:{port}/")
        with pytest.raises(TimeoutError):
            WebSocket(address, "words", {}, None, 1000, 0.2)

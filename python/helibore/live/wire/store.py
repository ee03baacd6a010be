"""Poll a WITSML store over HTTPS: send a query, store the answer as it comes, query again from the last index.

    thread of the link:  POST question -> bytes (bounded, in time) -> queue -> read() -> journal -> model
                              ^------------- every ``every`` seconds, from the reader's last index on

Certificates are always verified against the system's authorities and those of ``ca``. Redirects, proxies, netrc files
and compressed answers are not used. Every answer, also a refused one, is in the journal before any code reads it; if it
equals the previous answer, only this fact is stored. The password is read from the environment and appears in no text.
An answer that fails ends the link with an OSError; ``server.py`` decides when to try again.
"""

from __future__ import annotations

import contextlib
import email.utils
import hashlib
import logging
import os
import queue
import socket
import ssl
import threading
import time
from collections.abc import Callable
from typing import Any, Protocol

from helibore.base.errors import InputError, needs
from helibore.live.wire import witsml
from helibore.live.wire.address import Address
from helibore.live.wire.redaction import Redactor, check_password
from helibore.live.wire.transport import AccessDeniedError, BusyError, Link, Opener

PIECE = 1 << 19
LONGEST_RETRY = 86_400.0
"""The most seconds that a store can ask helibore to wait."""
SOON = 0.25
"""Seconds until the query for the rest of a partial answer."""


Position = Callable[[], tuple[str, str] | None]


class Object(Protocol):
    """An object of a store: the uids of well, wellbore and object."""

    @property
    def uids(self) -> tuple[str, str, str]: ...


class Polling(Protocol):
    """What this file needs of the table of a store; `StoreTable` says what each setting means."""

    @property
    def every(self) -> float: ...
    @property
    def user(self) -> str: ...
    @property
    def password_env(self) -> str: ...
    @property
    def ca(self) -> str: ...
    @property
    def timeout(self) -> float: ...
    @property
    def answer_mb(self) -> int: ...
    @property
    def log(self) -> Object | None: ...
    @property
    def trajectory(self) -> Object | None: ...


class Polled(Protocol):
    """What this file needs of a store."""

    @property
    def name(self) -> str: ...
    @property
    def address(self) -> Address: ...
    @property
    def table(self) -> Polling: ...


class StoreClient(Opener):
    """Opens links that poll a store.

    ``position`` returns the index of the last row that was read, as (text, unit); None: no row yet. ``refused`` has
    the checksum of the last refused answer to each kind of query, over all links, so that a repeated answer takes only
    a line of the journal.

    Raises
    ------
    MissingExtraError
        If httpx2 is not installed.
    InputError
        If the password is not in the environment or `check_password` refuses it, or if ``ca`` is not a file of
        certificates.
    """

    def __init__(self, source: Polled, position: Position) -> None:
        super().__init__(lambda _: StoreLink(self))  # the link sends the first query
        with needs("httpx2", "witsml"):
            import httpx2
        self.source, self.position, self.http = source, position, httpx2
        for name in ("httpx2", "httpcore2"):  # below WARNING they log headers, which may repeat the password
            logging.getLogger(name).setLevel(logging.WARNING)
        place, table = f"source.{source.name}", source.table
        self._trust = ssl.create_default_context()
        if table.ca:
            try:
                self._trust.load_verify_locations(table.ca)
            except OSError as error:
                raise InputError(f"{place}.ca", f"is no file of certificates: {error}", repr(table.ca)) from None
        self._auth: tuple[str, str] | None = None
        self.refused: dict[str, bytes] = {}
        if table.user:
            if table.password_env not in os.environ:
                raise InputError(f"{place}.password_env", "is not set in the environment", repr(table.password_env))
            self._auth = table.user, os.environ[table.password_env]
            check_password(f"{place}.password_env", self._auth[1])
        self.redactor = Redactor(self._auth)

    def client(self) -> Any:
        """Return a client of httpx2 that verifies the certificate and sends the credentials to this store only."""
        return self.http.Client(verify=self._trust, auth=self._auth, trust_env=False, follow_redirects=False)


class StoreLink(Link):
    """Polls a store until it is closed or an answer fails."""

    def __init__(self, store: StoreClient) -> None:
        self.peer = store.source.address.url
        self._client, self._http, self._source = store.client(), store.http, store.source
        self._table = store.source.table
        self._position, self._refused, self._redactor = store.position, store.refused, store.redactor
        self._pieces: queue.SimpleQueue[bytes | OSError | threading.Event] = queue.SimpleQueue()
        self._closed = threading.Event()
        self._before: dict[str, bytes] = {}
        self._socket: socket.socket | None = None
        self._answering = False
        self.useful = self.went_well = False
        self._thread = threading.Thread(target=self._poll, name=f"poll {store.source.name}", daemon=True)
        self._thread.start()

    def read(self, seconds: float) -> bytes | None:
        try:
            piece = self._pieces.get(timeout=seconds)
        except queue.Empty:
            if not self._thread.is_alive() and self._pieces.empty():
                raise OSError("the polling ended") from None
            return b""
        if isinstance(piece, OSError):
            raise piece
        if isinstance(piece, threading.Event):  # the caller reads again only after it has stored all earlier pieces
            piece.set()
            return b""
        return piece

    def close(self) -> None:
        self._closed.set()

    def _poll(self) -> None:
        try:
            while not self._closed.is_set():
                partial = self._ask_log() if self._table.log else False
                if self._table.trajectory and not partial:
                    self._ask("trajectory", witsml.trajectory_query(self._table.trajectory.uids), "returnElements=all")
                self.went_well = True
                self._closed.wait(SOON if partial else self._table.every)
        except AccessDeniedError as error:
            self._pieces.put(error)
        except BusyError as error:
            self._pieces.put(BusyError(self._redactor.clean_text(str(error)), error.seconds))
        except (OSError, self._http.TransportError) as error:
            self._pieces.put(OSError(self._redactor.clean_text(str(error) or type(error).__name__)))
        except Exception as error:
            self._pieces.put(OSError(f"{self._source.address.host}: {type(error).__name__}"))
        finally:
            with contextlib.suppress(Exception):
                self._client.close()

    def _ask_log(self) -> bool:
        """Query the log from its last index on; return whether the store limited its answer and has more rows."""
        assert self._table.log is not None
        options = "returnElements=data-only" if "log" in self._before else "returnElements=all"
        return self._ask("log", witsml.log_query(self._table.log.uids, self._position()), options)

    def _ask(self, kind: str, query: str, options: str) -> bool:
        """Send a query and wait until its answer is stored; return whether the answer is new and partial.

        Raises
        ------
        OSError
            If the answer is not whole, does not come from a store, or reports an error.
        """
        body, state, failure = self._answer(witsml.envelope(kind, query, options))
        body = self._redactor.clean(body, cut=state != "whole")
        self.useful = state == "whole"
        same = state == "whole" and body == self._before.get(kind)
        if state == "refused":
            body = self._refusal(kind, body)
        if body or state != "cut":
            framed = witsml.framed(kind, "same" if same else state, b"" if same else body)
            for start in range(0, len(framed), PIECE):
                self._pieces.put(framed[start : start + PIECE])
        if failure is not None:
            raise failure
        if not self._stored():
            return False
        self._before[kind] = body
        try:
            answer = witsml.read_answer(body)
        except ValueError as error:
            raise OSError(f"{self._source.address.host}: {kind}: {error}") from None
        if answer.result < 0:
            raise OSError(f"{self._source.address.host}: {kind}: error {answer.result}: {answer.message}")
        return answer.result == witsml.PARTIAL and not same

    def _stored(self) -> bool:
        """Wait until all pieces are in the journal; return False if the link is closed before that."""
        mark = threading.Event()
        self._pieces.put(mark)
        while not mark.wait(SOON):
            if self._closed.is_set():
                return False
        return True

    def _refusal(self, kind: str, body: bytes) -> bytes:
        """Return the bytes of a refused answer to store; b"" if it equals the previous refused answer of its kind."""
        checksum = hashlib.blake2b(body).digest()
        if self._refused.get(kind) == checksum:
            return b""
        self._refused[kind] = checksum
        return body

    def _note_socket(self, event: str, facts: dict[str, Any]) -> None:
        """Keep the socket of the connection; httpx2 calls this at every step of a request."""
        if event.endswith(("start_tls.complete", "connect_tcp.complete")):
            self._socket = facts["return_value"].get_extra_info("socket")

    def _hang_up(self) -> None:
        """Close the connection of an answer that takes too long; this also ends a read that waits for its headers."""
        with contextlib.suppress(OSError):
            if self._socket is not None:
                self._socket.shutdown(socket.SHUT_RDWR)

    def _answer(self, question: bytes) -> tuple[bytes, str, OSError | None]:
        """Send a query; return the body of its answer, its state ("whole", "cut" or "refused"), and the error if any.

        A body that is not whole ends where the answer was broken off.
        """
        table, host = self._table, self._source.address.host
        end = time.monotonic() + table.timeout
        headers = {"Content-Type": "text/xml; charset=utf-8", "SOAPAction": f'"{witsml.ACTION}"',
                   "Accept-Encoding": "identity"}  # fmt: skip
        body, refused, denied, wait = bytearray(), "", None, 0.0
        self._answering = False
        late = threading.Timer(table.timeout + 1.0, self._hang_up)  # httpx2 has no time limit for all headers together
        late.daemon = True
        late.start()
        try:
            with self._client.stream(
                "POST",
                self._source.address.url,
                content=question,
                headers=headers,
                timeout=table.timeout,
                extensions={"trace": self._note_socket},
            ) as response:
                self._answering = True
                if response.status_code != 200:
                    refused = f"answered {response.status_code}"
                    wait = retry_after(response.headers.get("retry-after", ""))
                    if response.status_code in (401, 403):
                        denied = AccessDeniedError(f"{host}: {refused}: the user or the password is wrong")
                elif response.headers.get("content-encoding", "identity") != "identity":
                    refused = "sent a compressed answer, which was not asked for"
                for piece in response.iter_raw():
                    body += piece
                    if len(body) > table.answer_mb << 20:
                        del body[table.answer_mb << 20 :]
                        refused = refused or f"an answer of more than {table.answer_mb} MB: refused"
                        break
                    if time.monotonic() > end or self._closed.is_set():
                        slow = OSError(f"{host}: {refused or f'the answer took longer than {table.timeout:g} s'}")
                        return bytes(body), "refused" if refused else "cut", slow
        except self._http.TransportError as error:
            slow_headers = time.monotonic() > end and not self._answering
            said = str(error)
            if isinstance(error, self._http.ProtocolError):  # its text repeats what the store sent
                said = "the answer ended early, or is not HTTP"
            reason = f"the answer took longer than {table.timeout:g} s" if slow_headers else said
            broken = OSError(f"{host}: {refused or reason or type(error).__name__}")
            return bytes(body), "refused" if refused else "cut", denied or broken
        finally:
            late.cancel()
        failure = OSError(f"{host}: {refused}") if refused else None
        if wait and refused:
            failure = BusyError(f"{host}: {refused}: asked to wait for {wait:g} s", wait)
        return bytes(body), "refused" if refused else "whole", denied or failure


def retry_after(text: str) -> float:
    """Return the seconds, at most LONGEST_RETRY, for which a header Retry-After asks to wait; 0 if it is not valid."""
    if text.strip().isdigit():
        return min(float(text), LONGEST_RETRY)
    try:
        when = email.utils.parsedate_to_datetime(text)
    except ValueError:
        return 0.0
    return min(max(when.timestamp() - time.time(), 0.0), LONGEST_RETRY)

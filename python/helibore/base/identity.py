"""Who may use a server of helibore: one rule for the page of a wall, the page of a live wall and the metrics.

    --token, a file, HELIBORE_TOKEN or a random token -> Access -> refusal(request) -> None, or why it is refused

Every request must carry the token, on this machine too: each user of a machine can reach the ports of all others. A
browser also says which page made a request. Only the server's own page may make one; another page may at most open the
server's page, as a link or in a frame.
"""

from __future__ import annotations

import contextlib
import hmac
import os
import secrets
import ssl
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import parse_qs, quote, urlsplit

from helibore.base.errors import InputError

VARIABLE = "HELIBORE_TOKEN"
"""The environment variable that may hold the token."""
NO_TOKEN = "token: missing or wrong. Open the address that helibore printed, with its ?token=..."
LONGEST_FILE = 4096
"""The most bytes of a file with a token."""


def random_token() -> str:
    """Return a new token of 256 bits."""
    return secrets.token_urlsafe(32)


def find_token(token: str | None = None, file: str | os.PathLike[str] | None = None) -> str:
    """Return the token that is given, else that of a file, else that of the environment, else a random one.

    A file that does not exist is made, with a random token, and only its owner can read it.

    Raises
    ------
    InputError
        If the token is empty, or if the file does not hold one line of text.
    """
    if token is None and file is not None:
        return _token_of(Path(file))
    if token is None:
        token = os.environ.get(VARIABLE)
    return random_token() if token is None else token


def _token_of(file: Path) -> str:
    with contextlib.suppress(FileExistsError):
        descriptor = os.open(file, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        try:
            os.write(descriptor, f"{random_token()}\n".encode())
        finally:
            os.close(descriptor)
    with file.open("rb") as found:
        lines = found.read(LONGEST_FILE + 1).split(b"\n")
    try:
        token = lines[0].decode().strip()
    except UnicodeDecodeError:
        token = ""
    if not token or any(line.strip() for line in lines[1:]) or len(lines[0]) > LONGEST_FILE:
        raise InputError(f"token file {file}", "must hold one line: the token")
    return token


@dataclass(frozen=True)
class Access:
    """The address of a server, the token that it requires, and the PEM files for HTTPS.

    Attributes
    ----------
    host
        Address that the server listens on.
    token
        Secret that every request must carry.
    certificate, key
        PEM files for HTTPS; without ``key``, the file of the certificate also has the key. None: HTTP.

    Raises
    ------
    InputError
        If the token is empty, if there is a key without a certificate, or if the certificate cannot be used.
    """

    host: str = "127.0.0.1"
    token: str = field(default_factory=random_token, repr=False)
    certificate: str | None = None
    key: str | None = None

    def __post_init__(self) -> None:
        if not self.token:
            raise InputError("token", "must not be empty")
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

    def url(self, port: int, path: str = "") -> str:
        """Return the address of a path of the server, with the token."""
        name = f"[{self.host}]" if ":" in self.host else self.host
        return f"{'https' if self.certificate else 'http'}://{name}:{port}/{path}?token={quote(self.token, safe='')}"

    def refusal(self, path: str, query: str, headers: Mapping[str, str]) -> str | None:
        """Return why a request is refused, or None if it is not refused; the names of headers are in lower case."""
        host, origin, site = headers.get("host", ""), headers.get("origin"), headers.get("sec-fetch-site")
        if not self._has_token(query, headers.get("authorization", "")):
            return NO_TOKEN
        if origin is not None and _host_of(origin) != host:
            return f"origin {origin[:60]!r}: only the page of this server may connect"
        if site not in (None, "same-origin", "none") and path != "/":
            return f"sec-fetch-site {site[:60]!r}: only the page of this server may ask for this"
        return None

    def _has_token(self, query: str, authorization: str) -> bool:
        """Return whether a request has the token as ``?token=`` or as ``Authorization: Bearer``."""
        given = parse_qs(query).get("token", [])[:1]
        if authorization.startswith("Bearer "):
            given.append(authorization.removeprefix("Bearer "))
        wanted = self.token.encode()
        return any(hmac.compare_digest(one.encode("utf-8", "replace"), wanted) for one in given)


def _host_of(origin: str) -> str | None:
    with contextlib.suppress(ValueError):  # "http://[::1" has no host
        return urlsplit(origin).netloc
    return None

"""Addresses of sources: tcp://HOST:PORT, listen://HOST:PORT, serial:///DEVICE, file:///PATH, https://STORE or host."""

from __future__ import annotations

from dataclasses import dataclass
from urllib.parse import parse_qs, urlsplit

from helibore.base.errors import InputError


@dataclass(frozen=True)
class Address:
    """An address of kind ``tcp``, ``listen``, ``serial``, ``file``, ``https`` or ``host`` (the program)."""

    kind: str
    host: str = ""
    port: int = 0
    file: str = ""
    baud: int = 9600
    speed: float = 0.0
    url: str = ""

    @property
    def is_loopback(self) -> bool:
        """Whether only this machine can reach the address."""
        return self.host in ("localhost", "::1") or self.host.startswith("127.")


def read_address(text: object) -> Address:
    """Return the address that ``text`` names.

    Raises
    ------
    InputError
        If ``text`` is not an address; the message never shows a user, a password or a query.
    """
    if not isinstance(text, str):
        raise ValueError("must be a text that is not empty")
    if text == "host":
        return Address("host")
    try:
        parts = urlsplit(text)
        query = {key: values[-1] for key, values in parse_qs(parts.query).items()}
        if parts.scheme in ("tcp", "listen") and parts.hostname and parts.port and not query:
            return Address(parts.scheme, host=parts.hostname, port=parts.port)
        if parts.scheme == "serial" and parts.path and set(query) <= {"baud"}:
            return Address("serial", file=parts.path, baud=int(query.get("baud", "9600")))
        if parts.scheme == "file" and parts.path and set(query) <= {"speed"}:
            return Address("file", file=parts.path, speed=float(query.get("speed", "0")))
        if (
            parts.scheme == "https"
            and parts.hostname
            and parts.username is None
            and not (parts.fragment or parts.query)
        ):
            return Address("https", host=parts.hostname, port=443 if parts.port is None else parts.port, url=text)
    except ValueError:  # the port or the host is not valid
        pass
    scheme = text.partition(":")[0]
    if "@" in text:
        shown = f"{scheme}://...@{text.rpartition('@')[2].partition('?')[0]}"
        raise InputError("", "must not hold a user or password: give user and password_env", repr(shown))
    if scheme == "https" and "?" in text:
        shown = text.partition("?")[0] + "?..."
        raise InputError("", "must not hold a query: it would be in the journal", repr(shown))
    if scheme == "http":
        raise ValueError("must be https: what is sent in the clear can be read and changed")
    raise ValueError("must be tcp://HOST:PORT, listen://HOST:PORT, serial:///DEVICE?baud=N, "
                     "file:///PATH?speed=BYTES_A_SECOND, https://STORE or host")  # fmt: skip

"""Addresses of sources: tcp://HOST:PORT, listen://HOST:PORT, serial:///DEVICE, file:///PATH, https://STORE or host."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from urllib.parse import parse_qs, urlsplit

from helibore.base.errors import InputError


@dataclass(frozen=True)
class Address:
    """An address of kind ``tcp``, ``listen``, ``serial``, ``file``, ``https`` or ``host`` (the calling program).

    Attributes
    ----------
    host, port
        Host and port number of a ``tcp``, ``listen`` or ``https`` address.
    file
        The path of the device or of the file.
    baud
        Baud rate of a serial port.
    speed
        Number of bytes to read from a file in each second; 0: read as fast as possible.
    url
        The whole address of a store.
    """

    kind: str
    host: str = ""
    port: int = 0
    file: str = ""
    baud: int = 9600
    speed: float = 0.0
    url: str = ""

    @property
    def is_loopback(self) -> bool:
        """Whether only programs on this machine can reach the address."""
        return self.host in ("localhost", "::1") or self.host.startswith("127.")


def read_server_address(text: str, rule: str, secrets: str, ports: Mapping[str, int], *, with_path: bool) -> Address:
    """Return the address of a server, with the usual port of its scheme if it names none.

    The user and the password stand in the settings that ``secrets`` names.

    Raises
    ------
    InputError
        If ``text`` is no such address, with ``rule``; the message never shows a user, a password or a query.
    """
    scheme = text.partition(":")[0]
    if "@" in text:
        raise InputError("", f"must not hold a user or password: give {secrets}", f"'{scheme}://...'")
    try:
        parts = urlsplit(text)
        port = parts.port or ports.get(parts.scheme, 0)
    except ValueError:
        raise InputError("", rule, repr(text.partition("?")[0])) from None
    if not parts.hostname or parts.query or parts.fragment or (parts.path.strip("/") and not with_path):
        raise InputError("", rule, repr(text.partition("?")[0]))
    return Address(parts.scheme, host=parts.hostname, port=port, url=text)


def read_address(text: object) -> Address:
    """Return the address that ``text`` names.

    Raises
    ------
    InputError
        If ``text`` is not an address; the message never shows a user, a password or the query of a network address.
    """
    if not isinstance(text, str):
        raise InputError("", "must be a text that is not empty", repr(text))
    if text == "host":
        return Address("host")
    try:
        parts = urlsplit(text, allow_fragments=False)  # a path may contain "#"
        query = {key: values[-1] for key, values in parse_qs(parts.query).items()}
        plain = "@" not in parts.netloc and not query
        if parts.scheme in ("tcp", "listen") and parts.hostname and parts.port and plain:
            return Address(parts.scheme, host=parts.hostname, port=parts.port)
        baud, speed = int(query.get("baud", "9600")), float(query.get("speed", "0"))
        if parts.scheme == "serial" and parts.path and set(query) <= {"baud"} and baud > 0:
            return Address("serial", file=parts.path, baud=baud)
        if parts.scheme == "file" and parts.path and set(query) <= {"speed"} and 0 <= speed < math.inf:
            return Address("file", file=parts.path, speed=speed)
        if parts.scheme == "https" and parts.hostname and parts.username is None and not ("#" in text or parts.query):
            return Address("https", host=parts.hostname, port=443 if parts.port is None else parts.port, url=text)
    except ValueError:  # the port, the host or a number is not valid
        pass
    scheme = text.partition(":")[0].lower()
    start, mark, _ = text.partition("?")
    is_local = scheme in ("serial", "file")
    shown = text if is_local or not mark else start + "?..."
    rule = ("must be tcp://HOST:PORT, listen://HOST:PORT, serial:///DEVICE?baud=N, "
            "file:///PATH?speed=BYTES_A_SECOND, https://STORE or host")  # fmt: skip
    if "@" in text and not is_local:
        shown = f"{scheme}://..." if "://" in text else "..."
        rule = "must not hold a user or password" + (": give user and password_env" if scheme == "https" else "")
    elif scheme == "https" and mark:
        rule = "must not hold a query: the journal would store it"
    elif scheme == "http":
        rule = "must be https: others can read and change what http sends"
    raise InputError("", rule, repr(shown))

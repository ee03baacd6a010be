"""Where a source is: tcp://HOST:PORT, listen://HOST:PORT, serial:///DEVICE, file:///PATH, https://STORE or host."""

from __future__ import annotations

import ipaddress
from dataclasses import dataclass
from urllib.parse import parse_qs, urlsplit

from helibore.live.tables import Table


@dataclass(frozen=True)
class Address:
    """Where bytes come from: ``tcp``, ``listen``, ``serial``, ``file``, ``https`` or ``host``."""

    kind: str
    host: str = ""
    port: int = 0
    file: str = ""
    baud: int = 9600
    speed: float = 0.0
    url: str = ""


def check_allowed(table: Table, address: Address, allow: tuple[str, ...], given: bool) -> None:
    """A listener that is not on loopback needs to be told who may connect."""
    for index, network in enumerate(allow):
        try:
            ipaddress.ip_network(network)
        except ValueError:
            rule = "must be an IP address or a network such as 10.1.0.0/16"
            raise table.fail(f"allow[{index}]", network, rule) from None
    loopback = address.host == "localhost" or address.host.startswith("127.") or address.host == "::1"
    if address.kind == "listen" and not loopback and not given:
        raise ValueError(f"{table.place}.allow: must be set: who may connect to a listener on {address.host}")


def read_address(table: Table) -> Address:
    """Take ``address`` out of the table of a source."""
    kinds = '"file:///PATH?speed=1", "https://STORE" or "host" (the program pushes the bytes)'
    text = table.text(
        "address", why=f'"tcp://HOST:PORT", "listen://HOST:PORT", "serial:///dev/ttyS0?baud=9600", {kinds}'
    )
    if text == "host":
        return Address("host")
    parts = urlsplit(text)
    query = {key: values[-1] for key, values in parse_qs(parts.query).items()}
    try:
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
            and not parts.fragment
            and not parts.query
        ):
            return Address("https", host=parts.hostname, port=443 if parts.port is None else parts.port, url=text)
    except ValueError:
        pass
    if parts.username is not None:
        shown = text.replace(parts.netloc.rpartition("@")[0], "...")
        raise table.fail("address", shown, "must not hold a user or password: give user and password_env")
    if parts.scheme == "https" and parts.query:
        raise table.fail(
            "address", text.partition("?")[0] + "?...", "must not hold a query: it would be in the journal"
        )
    if parts.scheme == "http":
        raise table.fail("address", text, "must be https: what is sent in the clear can be read and changed")
    raise table.fail("address", text, "must be tcp://HOST:PORT, listen://HOST:PORT, serial:///DEVICE?baud=N, "
                                      "file:///PATH?speed=BYTES_A_SECOND, https://STORE or host")  # fmt: skip

"""Where a source is: tcp://HOST:PORT, listen://HOST:PORT, serial:///DEVICE, file:///PATH or host."""

from __future__ import annotations

import ipaddress
from dataclasses import dataclass
from urllib.parse import parse_qs, urlsplit

from helibore.live.tables import Table


@dataclass(frozen=True)
class Address:
    """Where bytes come from: ``tcp``, ``listen``, ``serial`` or ``file``."""

    kind: str
    host: str = ""
    port: int = 0
    file: str = ""
    baud: int = 9600
    speed: float = 0.0


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
    text = table.text("address", why='"tcp://HOST:PORT", "listen://HOST:PORT", "serial:///dev/ttyS0?baud=9600", '
                                     '"file:///PATH?speed=1" or "host" (the program pushes the bytes)')  # fmt: skip
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
    except ValueError:
        pass
    raise table.fail("address", text, "must be tcp://HOST:PORT, listen://HOST:PORT, serial:///DEVICE?baud=N, "
                                      "file:///PATH?speed=BYTES_A_SECOND or host")  # fmt: skip

"""Simulate a rig that sends WITS from a tool in a known hole, by a telemetry that is slow, late and loses frames.

    mud pulse   1 triple in 2 s          EM      5 triples/s
    wired pipe  900 triples/s            memory  3,000 triples/s recorded

The rig sends bit and hole depth, rotation and activity once a second of drilling time, survey stations when the bit
has passed them, gamma rows, and frames of up to 30 triples (toolface, depth, radius: items 5010 to 5099).
"""

from __future__ import annotations

import errno
import socket
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from helibore.base.arrays import Floats
from helibore.base.errors import InputError, port_error
from helibore.live.wire import wits
from helibore.live.wire.address import Address, read_address
from helibore.simulation.tool import Hole, Lift, Tool, simulate

TELEMETRY = {
    "mud-pulse": (0.5, 1, 20.0),
    "em": (5.0, 1, 2.0),
    "wired-pipe": (900.0, 30, 0.0),
    "memory": (3000.0, 30, 0.0),
}
"""For each telemetry: triples a second, triples a frame, and seconds between measurement and arrival."""

BIT_DIAMETER = 0.216
"""Bit diameter of every rig, metres."""

CONFIGURATION = """\
[wall]
bit_diameter = {bit_diameter}
start_depth = {start}

[source.rig]
address = "{address}"
units = "metric"
items = {{ bit_depth = "0108", hole_depth = "0110", rotation = "0120", activity = "0107" }}
caliper = {{ first = "5010", groups = {groups}, order = ["toolface", "depth", "radius"] }}
survey = {{}}
image.GR = {{ first = "5110", count = 16, unit = "gAPI", depth = "0821", origin = "edge", reference = "high-side" }}
"""


def configuration(address: str, telemetry: str = "wired-pipe", start: float = 2000.0) -> str:
    """Return the TOML with which ``helibore live`` connects to ``address`` and reads a rig of this telemetry."""
    _, groups, _ = _usual(telemetry)
    return CONFIGURATION.format(address=address, bit_diameter=BIT_DIAMETER, start=start, groups=groups)


def _usual(telemetry: str) -> tuple[float, int, float]:
    if telemetry not in TELEMETRY:
        raise InputError(f"telemetry '{telemetry}'", f"must be one of {', '.join(TELEMETRY)}")
    return TELEMETRY[telemetry]


@dataclass(frozen=True)
class Faults:
    """Shares of caliper frames that are ``dropped``, sent twice (``doubled``), or sent 5 s ``late``."""

    dropped: float = 0.0
    doubled: float = 0.0
    late: float = 0.0

    def __post_init__(self) -> None:
        for name in ("dropped", "doubled", "late"):
            if not 0 <= getattr(self, name) < 1:
                raise InputError(name, "must be in [0, 1)", f"{getattr(self, name):g}")


class Rig:
    """A rig that drills a known hole and sends what its tool measures.

    Parameters
    ----------
    telemetry
        A name in TELEMETRY.
    start, stop
        The interval that is drilled, depths in metres.
    lift
        Metres by which the tool is lifted once, when half of the interval is drilled, to scan these metres again; 0:
        there is no lift. Or a tuple of lifts.
    faults, seed
        The faults of the telemetry, and the seed of all random numbers.
    rate
        Number of triples in a second of drilling time; None: the rate of the telemetry.

    Attributes
    ----------
    triples
        (n, 3): toolface (deg), depth (m) and radius (m) of each triple that is sent at least once, rounded as sent.
    """

    def __init__(
        self, telemetry: str = "wired-pipe", start: float = 2000.0, stop: float = 2010.0,
        lift: float | tuple[Lift, ...] = 2.0,
        faults: Faults | None = None, seed: int = 0, rate: float | None = None,
    ) -> None:  # fmt: skip
        usual, self.groups, self.latency = _usual(telemetry)
        self._telemetry, self._start = telemetry, start
        self._draw = np.random.default_rng([seed, 11])
        half_way = start + (stop - start) / 2
        lifts = lift if isinstance(lift, tuple) else (Lift(half_way, lift),) if lift else ()
        tool = Tool(sample_rate=usual if rate is None else rate, lifts=lifts)
        self.run = simulate(Hole.example(start, stop, bit_diameter=BIT_DIAMETER, seed=seed), tool, seed=seed)
        # The triples rounded as sent: toolface to 0.01 deg, depth to 0.1 mm, radius to 0.01 mm.
        toolface, radius = np.round(self.run.toolface, 2) % 360.0, np.round(self.run.radius * 1e3, 2) * 1e-3
        self._rows: Floats = np.column_stack([toolface, np.round(self.run.depth, 4), radius])
        self.triples, self._order = self._in_order(faults or Faults())

    def frames(self) -> Iterator[tuple[float, bytes]]:
        """Yield (drilling time s, frame) in the order of sending; a caliper frame is made only when it is yielded."""
        for at, frame in self._order:
            yield at, frame if isinstance(frame, bytes) else self._caliper(frame)

    def configuration(self, address: str) -> str:
        """Return the TOML with which ``helibore live`` reads this rig at ``address``."""
        return configuration(address, self._telemetry, self._start)

    def _in_order(self, faults: Faults) -> tuple[Floats, list[tuple[float, bytes | int]]]:
        """Return the triples that are sent, and all frames in order of sending.

        Each frame is a drilling time and, for a caliper frame, its number; for another frame, its bytes.
        """
        rows = self._rows
        sent: list[tuple[float, bytes | int]] = [*self._surface(), *self._stations_and_gamma()]
        kept = np.ones(len(rows), bool)
        starts = range(0, len(rows), self.groups)
        chance = self._draw.random((len(starts), 3))
        for number, first in enumerate(starts):
            at = float(self.run.time[min(first + self.groups, len(rows)) - 1]) + self.latency
            if chance[number, 0] < faults.dropped:
                kept[first : first + self.groups] = False
                continue
            at += 5.0 if chance[number, 1] < faults.late else 0.0
            sent.append((at, number))
            if chance[number, 2] < faults.doubled:
                sent.append((at + 0.5, number))
        return rows[kept], sorted(sent, key=lambda entry: entry[0])

    def _caliper(self, number: int) -> bytes:
        group = self._rows[number * self.groups : (number + 1) * self.groups]
        items = [(5004, str(number))]
        for place, (toolface, depth, radius) in enumerate(group.tolist()):
            first = 5010 + 3 * place
            items += [(first, f"{toolface:.2f}"), (first + 1, f"{depth:.4f}"), (first + 2, f"{radius * 1e3:.2f}")]
        return wits.frame(items)

    def _surface(self) -> Iterator[tuple[float, bytes]]:
        seconds = np.arange(0.0, float(self.run.time[-1]) + 1.0)
        bit = np.interp(seconds, self.run.time, self.run.depth)
        deepest = np.maximum.accumulate(bit)
        for number, second in enumerate(seconds.tolist()):
            depth, hole = float(bit[number]), float(deepest[number])
            yield second, wits.frame([(104, str(number)), (107, "2"), (108, f"{depth:.3f}"), (110, f"{hole:.3f}"),
                                      (113, "20.00"), (120, "117"), (121, "15000")])  # fmt: skip

    def _stations_and_gamma(self) -> Iterator[tuple[float, bytes]]:
        """Yield (drilling time, frame) of each survey station and row of gamma; each is sent when the bit passes."""
        run = self.run
        deepest = np.maximum.accumulate(run.depth)

        def sent(depth: float, *items: tuple[int, str]) -> tuple[float, bytes]:
            passed = min(int(np.searchsorted(deepest, depth)), len(run.time) - 1)
            return float(run.time[passed]) + self.latency, wits.frame(items)

        stations = zip(run.station_depth.tolist(), run.inclination.tolist(), run.azimuth.tolist(), strict=True)
        for number, (depth, inclination, azimuth) in enumerate(stations):
            angles = (713, f"{inclination:.4f}"), (715, f"{azimuth:.4f}")
            yield sent(depth, (704, str(number)), (708, f"{depth:.2f}"), *angles)
        for depth, row in zip(run.gamma_depth.tolist(), run.gamma.tolist(), strict=True):
            yield sent(depth, (821, f"{depth:.2f}"), *((5110 + j, f"{value:.1f}") for j, value in enumerate(row)))


def play(rig: Rig, link: socket.socket, speed: float = 1.0, packet: int = 1400) -> int:
    """Send a rig's frames ``speed`` times as fast as it drilled, and return the number of bytes sent.

    With ``speed`` 0, frames are sent without waiting. A packet has at most ``packet`` bytes, or one frame that is
    longer than that.
    """
    begin, sent, held = time.monotonic(), 0, bytearray()
    first = None

    def flush() -> None:
        nonlocal sent
        link.sendall(held)
        sent += len(held)
        held.clear()

    for at, frame in rig.frames():
        first = at if first is None else first
        wait = (at - first) / speed - (time.monotonic() - begin) if speed else 0.0
        if wait > 0 or len(held) + len(frame) > packet:
            flush()
        if wait > 0:
            time.sleep(wait)
        held += frame
    flush()
    return sent


def socket_address(text: str) -> Address:
    """Return an address; raise an InputError unless it is ``tcp://HOST:PORT`` or ``listen://HOST:PORT``."""
    with suppress(ValueError):
        address = read_address(text)
        if address.kind in ("tcp", "listen"):
            return address
    raise InputError(f"address '{text}'", "must be tcp://HOST:PORT or listen://HOST:PORT")


def connect(address: str, seconds: float = 30.0) -> socket.socket:
    """Return a socket: ``tcp://HOST:PORT`` connects, ``listen://HOST:PORT`` waits for one connection.

    Raises an OSError that names the address if there is no connection within ``seconds``.
    """
    found = socket_address(address)
    where = (found.host, found.port)
    try:
        if found.kind == "tcp":
            return _connected(where, seconds)
        listening = socket.create_server(where, family=socket.AF_INET6 if ":" in found.host else socket.AF_INET)
    except OSError as error:
        raise port_error(error, *where, "address") from error
    with listening:
        listening.settimeout(seconds)
        try:
            return listening.accept()[0]
        except TimeoutError as error:
            raise TimeoutError(errno.ETIMEDOUT, f"{address}: nobody connected within {seconds:g} s") from error


def _connected(where: tuple[str, int], seconds: float) -> socket.socket:
    """Return a socket that is connected to an address; while the connection is refused, try again for ``seconds``."""
    end = time.monotonic() + seconds
    while True:
        try:
            connection = socket.create_connection(where, timeout=seconds)
        except ConnectionRefusedError:
            if time.monotonic() > end:
                raise
            time.sleep(0.2)
        else:
            connection.settimeout(None)  # sending may have to wait long, until the receiver's disk has room again
            return connection

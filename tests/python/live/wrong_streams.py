"""Streams that are well formed and wrong, by WITS, MQTT, ETP and from a store: what is wrong, and which alarm says so.

A rig drills at 20 m/h and sends bit depth, hole depth, rotation and a sample each second. From AFTER on, or from the
start, something is wrong: with what is measured, or with how it is sent. `played` returns when the alarm began.
"""

from __future__ import annotations

import datetime
import json
import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import numpy as np
from live_wires import Clock
from small_store import LOG, enveloped

from helibore import Live
from helibore.live.alarms import Alarm
from helibore.live.rules.configuration import parse
from helibore.live.server import Server
from helibore.live.wire import etp_link, mqtt_link, wits, witsml

AFTER, BEGAN, RATE = 600, 1_700_000_000, 20 / 3600
WALL = "[wall]\nbit_diameter = 0.216\nstart_depth = 1990.0\nsectors = 16\nthreads = 1\n[source.rig]\n"
NAMED = 'items = { bit_depth = "BIT", hole_depth = "HOLE", rotation = "RPM" }\n'
CALIPER = 'caliper = { toolface = ["TF"], radius = RADII, offset = 0.0TURNED }\n'


@dataclass(frozen=True)
class Moment:
    """What is measured in one second; ``radius`` has a value for each sensor; None: nothing comes."""

    second: int
    bit: float | None
    hole: float | None
    rpm: float
    toolface: float | None
    radius: tuple[float | None, ...]


def moments(sensors: int):
    draw = np.random.default_rng(21)
    for second in range(20_000):
        depth = 2000 + RATE * second
        radius = tuple((0.109 + 0.001 * draw.standard_normal(sensors)).tolist())
        yield Moment(second, depth, depth, 110 + float(draw.normal()), float(draw.uniform(0, 360)), radius)


class Wire(ABC):
    """How moments are sent; a test changes the attributes."""

    address = ""
    names: Mapping[str, str] = MappingProxyType({})

    def __init__(self, sensors: int = 1) -> None:
        self.sensors = sensors
        self.names = dict(type(self).names) | {f"R{n}": f"R{n}" for n in range(sensors)}
        self.connection = 1
        self.raw: Callable[[bytes], bytes] = lambda sent: sent
        self.late = 0.0  # seconds by which the clock of an index is set back
        self.units: dict[str, str] = {}

    def configuration(self) -> str:
        radii = json.dumps([f"R{n}" for n in range(self.sensors)])
        turned = f", toolface_offset = {[360 * n // self.sensors for n in range(self.sensors)]}"
        return (
            WALL
            + self.address
            + NAMED
            + CALIPER.replace("RADII", radii).replace("TURNED", turned if self.sensors > 1 else "")
        )

    def values(self, moment: Moment) -> dict[str, float]:
        """The values in the units in which they are sent, by the names of now."""
        found = {"BIT": moment.bit, "HOLE": moment.hole, "RPM": moment.rpm, "TF": moment.toolface}
        found |= {f"R{n}": None if one is None else 1000 * one for n, one in enumerate(moment.radius)}
        return {self.names.get(name, name): value for name, value in found.items() if value is not None}

    @abstractmethod
    def sent(self, moment: Moment) -> bytes:
        """The bytes of a moment."""


class Wits(Wire):
    address = 'address = "host"\nunits = "metric"\n'
    names = MappingProxyType({"BIT": "0108", "HOLE": "0110", "RPM": "0120", "TF": "5010"})

    def __init__(self, sensors: int = 1) -> None:
        super().__init__(sensors)
        self.names |= {f"R{n}": f"50{12 + n}" for n in range(sensors)}
        self.configured = dict(self.names)

    def configuration(self) -> str:
        text = super().configuration()
        for name, item in self.configured.items():
            text = text.replace(f'"{name}"', f'"{item}"')
        return text

    def sent(self, moment: Moment) -> bytes:
        return self.raw(wits.frame([(int(name), f"{value:.2f}") for name, value in self.values(moment).items()]))


class Mqtt(Wire):
    address = 'address = "mqtt://127.0.0.1:1883"\nunits = "metric"\nclient = "c"\ntopics = ["rig/#"]\n'

    def __init__(self, sensors: int = 1) -> None:
        super().__init__(sensors)
        self.state = "new"

    def sent(self, moment: Moment) -> bytes:
        text = json.dumps({name: round(value, 3) for name, value in self.values(moment).items()})
        return mqtt_link.framed(self.state, b"rig/a", self.raw(text.encode()))


class Etp(Wire):
    address = 'address = "ws://127.0.0.1:9002/e"\nuris = ["eml:///c"]\nordered_by = "time"\n'

    def __init__(self, sensors: int = 1) -> None:
        super().__init__(sensors)
        self.units = {"BIT": "m", "HOLE": "m", "RPM": "rpm", "TF": "dega", **{f"R{n}": "mm" for n in range(sensors)}}
        self._session: object = None

    def sent(self, moment: Moment) -> bytes:
        values, messages = self.values(moment), []
        session = (tuple(self.names.items()), tuple(self.units.items()))
        channels = {self.names.get(one, one): unit for one, unit in self.units.items()}
        if session != self._session:
            self.connection, self._session = self.connection + 1, session
            records = {str(at): _channel(at, name, unit) for at, (name, unit) in enumerate(channels.items())}
            messages.append(etp_link.encoded("GetChannelMetadataResponse", {"metadata": records}, 3))
        index = [{"item": int((BEGAN + moment.second - self.late) * 1e6)}]
        items = [{"channelId": list(channels).index(name), "indexes": index, "value": {"item": value},
                  "valueAttributes": []} for name, value in values.items()]  # fmt: skip
        messages.append(self.raw(etp_link.encoded("ChannelData", {"data": items}, 5)))
        return b"".join(map(etp_link.framed, messages))


def _channel(number: int, name: str, unit: str) -> dict[str, Any]:
    nothing = {"startIndex": {"item": None}, "endIndex": {"item": None}, "uom": "", "depthDatum": ""}
    index = {"indexKind": "DateTime", "interval": nothing, "direction": "Increasing", "name": "T", "uom": "us",
             "depthDatum": "", "indexPropertyKindUri": "", "filterable": True}  # fmt: skip
    return {"uri": name, "id": number, "indexes": [index], "channelName": name, "dataKind": "typeDouble", "uom": unit,
            "depthDatum": "", "channelClassUri": "", "status": "Active", "source": "", "axisVectorLengths": [],
            "attributeMetadata": [], "customData": {}}  # fmt: skip


class Stored(Wire):
    """A store that is asked each second, and answers with the rows of the last three."""

    address = 'address = "https://store.example"\nlog = { well = "w", wellbore = "b", log = "l", index = "time" }\n'

    def __init__(self, sensors: int = 1) -> None:
        super().__init__(sensors)
        self.units = {"BIT": "m", "HOLE": "m", "RPM": "rpm", "TF": "dega", **{f"R{n}": "mm" for n in range(sensors)}}
        self.rows: list[str] = []
        self.stands = False

    def sent(self, moment: Moment) -> bytes:
        if self.stands:
            return witsml.framed("log", "same", b"")
        values = self.values(moment)
        time = datetime.datetime.fromtimestamp(BEGAN + moment.second - self.late, datetime.UTC)
        names = [self.names.get(one, one) for one in self.units]
        cells = [f"{values[one]:.3f}" if one in values else "" for one in names]
        self.rows = [*self.rows[-2:], ",".join([time.isoformat().replace("+00:00", "Z"), *cells])]
        lists = (
            f"<mnemonicList>T,{','.join(names)}</mnemonicList><unitList>s,{','.join(self.units.values())}</unitList>"
        )
        data = "".join(f"<data>{row}</data>" for row in self.rows)
        return witsml.framed(
            "log", "whole", self.raw(enveloped(LOG.replace("HEADER", "").replace("ROWS", lists + data)))
        )


@dataclass(frozen=True)
class Wrong:
    """A wrong stream: what changes, the alarm, the seconds until it at most, and words that the alarm must have."""

    wire: type[Wire]
    rule: str
    within: float
    measured: Callable[[Moment], Moment] | None = None
    sent: Callable[[Any], None] | None = None
    words: tuple[str, ...] = ()
    sensors: int = 1
    after: int = AFTER


def _radius(change: Callable[[float], float | None]) -> Callable[[Moment], Moment]:
    return lambda m: replace(m, radius=tuple(None if one is None else change(one) for one in m.radius))


def _sensor(number: int, value: float) -> Callable[[Moment], Moment]:
    return lambda m: replace(m, radius=tuple(value if n == number else one for n, one in enumerate(m.radius)))


def _toolface(change: Callable[[float], float | None]) -> Callable[[Moment], Moment]:
    return lambda m: replace(m, toolface=None if m.toolface is None else change(m.toolface))


def _deeper(bit: float, hole: float) -> Callable[[Moment], Moment]:
    return lambda m: replace(m, bit=m.bit + bit, hole=m.hole + hole)


def _renamed(name: str, to: str) -> Callable[[Any], None]:
    return lambda wire: wire.names.update({name: to})


def _set(**values: Any) -> Callable[[Any], None]:
    return lambda wire: [setattr(wire, name, value) for name, value in values.items()]


def _united(name: str, unit: str) -> Callable[[Any], None]:
    return lambda wire: wire.units.update({name: unit})


DEAD = lambda m: replace(m, radius=(None,) * len(m.radius), toolface=None)  # noqa: E731
NO_BIT = lambda m: replace(m, bit=None, hole=None)  # noqa: E731
GONE = lambda m: replace(m, bit=None, hole=None, toolface=None, radius=(None,) * len(m.radius))  # noqa: E731
FROZEN = lambda m: replace(m, bit=2000 + RATE * AFTER, hole=2000 + RATE * AFTER)  # noqa: E731
FEET = lambda m: replace(m, bit=m.bit / 0.3048, hole=m.hole / 0.3048)  # noqa: E731
QUOTED = lambda sent: re.sub(rb": ([^,}]*)", rb': "\1"', sent)  # noqa: E731

STREAMS = {
    "WITS: the tool dies": Wrong(Wits, "no_samples", 65, DEAD),
    "WITS: the depth slips down": Wrong(Wits, "depth_step", 5, _deeper(9.3, 9.3), words=("hole.shift",)),
    "WITS: the depth slips up": Wrong(Wits, "depth_step", 5, _deeper(-9.3, 0)),
    "WITS: the depth slips far": Wrong(Wits, "depth_step", 5, _deeper(60, 60)),
    "WITS: another hole": Wrong(Wits, "hole_falls", 5, _deeper(-20, -20), words=("hole.name",)),
    "WITS: diameters as radii": Wrong(Wits, "radius_scale", 110, _radius(lambda r: 2 * r), after=0,
                                      words=("measures",)),
    "WITS: inches as millimetres": Wrong(Wits, "radius_scale", 110, _radius(lambda r: r / 25.4 * 2), after=0,
                                         words=("measures", "radius_unit")),
    "WITS: a sensor sticks far off": Wrong(Wits, "sensors", 130, _sensor(2, 0.131), sensors=4),
    "WITS: a sensor sticks": Wrong(Wits, "stays", 60, _sensor(1, 0.1093), sensors=4),
    "WITS: the radius sticks": Wrong(Wits, "stays", 60, _sensor(0, 0.1093)),
    "WITS: the toolface sticks": Wrong(Wits, "toolface_stays", 1100, _toolface(lambda _: 77.0),
                                       words=("items.rotation",)),
    "WITS: toolfaces in tens of degrees": Wrong(Wits, "toolface_stays", 1100, _toolface(lambda t: t / 10),
                                                words=("toolface_unit",)),
    "WITS: toolfaces in tenths": Wrong(Wits, "toolface", 110, _toolface(lambda t: 10 * t), after=0),
    "WITS: toolfaces in radians": Wrong(Wits, "toolface", 110, _toolface(np.radians), after=0,
                                        words=("toolface_unit",)),
    "WITS: gravity instead of magnetic toolface": Wrong(Wits, "refused", 130, sent=_renamed("TF", "0717")),
    "WITS: the item of the radius moves": Wrong(Wits, "refused", 130, sent=_renamed("R0", "5099")),
    "WITS: only the item of the bit stays away": Wrong(Wits, "no_depth", 130, NO_BIT),
    "WITS: nothing but keep-alives": Wrong(Wits, "no_depth", 130,
                                           sent=_set(raw=lambda _: b"&&\r\n0111-9999\r\n!!\r\n")),
    "WITS: the bit depth stands while samples come": Wrong(Wits, "standing", 910, FROZEN),
    "WITS: feet as metres": Wrong(Wits, "depth_jump", 10, FEET),
    "WITS: all radii are null": Wrong(Wits, "refused", 130, _radius(lambda _: -0.99925)),
    "WITS: radii in micrometres": Wrong(Wits, "refused", 130, _radius(lambda r: 1000 * r), words=("radius_range",)),
    "WITS: the lines have lost their items": Wrong(Wits, "no_depth", 130,
                                                   sent=_set(raw=lambda s: s.replace(b"0108", b"0199"))),
    "MQTT: the tool dies": Wrong(Mqtt, "no_samples", 65, DEAD),
    "MQTT: the depth slips": Wrong(Mqtt, "depth_step", 5, _deeper(9.3, 9.3)),
    "MQTT: the radius sticks": Wrong(Mqtt, "stays", 60, _sensor(0, 0.1093)),
    "MQTT: a key changes its name": Wrong(Mqtt, "refused", 130, sent=_renamed("R0", "r0")),
    "MQTT: all messages are retained ones": Wrong(Mqtt, "no_depth", 130, sent=_set(state="retained")),
    "MQTT: no JSON any more": Wrong(Mqtt, "no_depth", 130, sent=_set(raw=lambda s: s[:-1])),
    "MQTT: numbers as texts": Wrong(Mqtt, "no_depth", 130, sent=_set(raw=QUOTED)),
    "store: the log stands": Wrong(Stored, "no_rows", 310, sent=_set(stands=True)),
    "store: the clock is set back": Wrong(Stored, "behind", 60, sent=_set(late=3600.0)),
    "store: mnemonics in another case": Wrong(Stored, "missing", 130, sent=_renamed("TF", "tf"), after=0),
    "store: the tool dies": Wrong(Stored, "no_samples", 65, DEAD),
    "store: the radius sticks": Wrong(Stored, "stays", 60, _sensor(0, 0.1093)),
    "store: a unit that is none of length": Wrong(Stored, "refused", 130, sent=_united("R0", "bar")),
    "ETP: the tool dies": Wrong(Etp, "no_samples", 70, DEAD),
    "ETP: the clock is set back": Wrong(Etp, "behind", 70, sent=_set(late=3600.0)),
    "ETP: the depth slips": Wrong(Etp, "depth_step", 10, _deeper(-9.3, 0)),
    "ETP: a channel changes its name": Wrong(Etp, "refused", 140, sent=_renamed("R0", "r0")),
    "ETP: a unit that is none of length": Wrong(Etp, "refused", 140, sent=_united("R0", "bar")),
    "ETP: damaged messages": Wrong(Etp, "no_depth", 130, sent=_set(raw=lambda s: s[:-4])),
}  # fmt: skip


def played(
    name: str, lacking: Callable[[Server, Alarm], list[str]] = lambda *_: []
) -> tuple[float, str, list[str], list[str]]:
    """Return the seconds from what is wrong to the alarm, its text, false alarms, and where the alarm is not shown.

    The seconds are infinite if no alarm came in time; ``lacking`` returns where an alarm is not shown.
    """
    stream, clock = STREAMS[name], Clock()
    wire = stream.wire(stream.sensors)
    live = Live(parse(wire.configuration()), clock=clock)
    server = Server(live)
    server.states["rig"] = "connected"
    false: list[str] = []
    for made in moments(stream.sensors):
        clock.step(1.0)
        moment = made
        if made.second >= stream.after:
            moment = stream.measured(made) if stream.measured else made
            if stream.sent and made.second == stream.after:
                stream.sent(wire)
        payload = wire.sent(moment)
        live.receive("rig", payload, wire.connection)
        server.alarms.check()
        begun = {alarm.rule: alarm for alarm in server.alarms.active}
        if made.second < stream.after:
            false += [alarm.text for alarm in begun.values() if alarm.text not in false]
        elif alarm := begun.get(stream.rule):
            assert live.model.events.counts[alarm.source, f"alarm_{stream.rule}"]
            return made.second - stream.after, alarm.text, false, lacking(server, alarm)
        elif made.second > stream.after + stream.within + 60:
            return float("inf"), f"only {[str(one) for one in begun.values()]}", false, []
    raise AssertionError("the stream is too short")

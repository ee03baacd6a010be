"""A server of ETP 1.2 for tests: three channels by depth that grow, or whatever a test makes of them.

``python etp_server.py PORT RATE COUNT --begun FILE`` serves in a process of its own, with RATE values a second of each
channel up to COUNT. How many there are follows from the time since FILE was written, so a server that is killed and
started again has what it would have had. If `etptypes` and `etpproto` are installed (they need pydantic below 2, and so
an environment of their own), these encode and decode every message; otherwise the schemas of helibore do.
"""

from __future__ import annotations

import argparse
import contextlib
import threading
import time
from pathlib import Path
from typing import Any

from websockets.exceptions import ConnectionClosed
from websockets.sync.server import serve

try:
    import importlib
    import re
    from io import BytesIO

    import etptypes.energistics.etp.v12.datatypes.message_header as header_module
    from etpproto.messages import Message
    from etptypes import avro_schema
    from fastavro import schemaless_reader

    INDEPENDENT = True
except ImportError:
    from helibore.live.wire import etp_link

    INDEPENDENT = False

SUBPROTOCOL = "etp12.energistics.org"
NAMES = ("TF", "RAD", "MD")
UNITS = ("dega", "mm", "m")
FIRST, STEP = 100.0, 0.001


def value(name: str, number: int) -> float:
    return {"TF": float(number * 37 % 360), "RAD": 110.0 + number % 3, "MD": FIRST + STEP * number}[name]


def _class(name: str) -> Any:
    folder = "core" if name in ("RequestSession", "OpenSession", "Ping", "Pong", "CloseSession",
                                "ProtocolException") else "channel_subscribe"  # fmt: skip
    snake = re.sub(r"(?<=[a-z])([A-Z])", r"_\1", name).lower()
    return getattr(importlib.import_module(f"etptypes.energistics.etp.v12.protocol.{folder}.{snake}"), name)


def encode(name: str, body: dict[str, Any], number: int, answers: int, flags: int = 2) -> bytes:
    if not INDEPENDENT:
        return etp_link.encoded(name, body, number, answers, flags)
    made = _class(name)
    import json

    facts = json.loads(avro_schema(made))
    header = header_module.MessageHeader(protocol=int(facts["protocol"]), messageType=int(facts["messageType"]),
                                         correlationId=answers, messageId=number, messageFlags=flags)  # fmt: skip
    return Message(header, made(**body)).encode_message()


def decode(message: bytes) -> tuple[str, dict[str, Any], int]:
    if not INDEPENDENT:
        name, header, body = etp_link.decoded(message)
        return name, body, header["messageId"]
    import json

    stream = BytesIO(message)
    header = schemaless_reader(stream, json.loads(header_module.avro_schema))
    for name in ("RequestSession", "GetChannelMetadata", "SubscribeChannels", "GetRanges", "Pong"):
        facts = json.loads(avro_schema(_class(name)))
        if (int(facts["protocol"]), int(facts["messageType"])) == (header["protocol"], header["messageType"]):
            return name, schemaless_reader(stream, facts), header["messageId"]
    return "", {}, header["messageId"]


class Server:
    """Serves ``count`` values of each channel, which a test or the time increases."""

    def __init__(self, port: int = 0, *, token: str = "", user: str = "", backfills: bool = True,
                 version: str = SUBPROTOCOL) -> None:  # fmt: skip
        self.count, self.first = 0, 0
        self.names, self.units = list(NAMES), list(UNITS)
        self.index_kind, self.direction = "MeasuredDepth", "Increasing"
        self.token, self.backfills, self.user = token, backfills, user
        self.status, self.wait = 0, ""  # that answer each connection
        self.refuse = ""  # text of a ProtocolException that answers RequestSession
        self.protocols = [21]
        self.damaged: set[int] = set()
        self.extra: list[bytes] = []  # messages to be sent as they are
        self.asked: list[str] = []
        self.sent, self.subscriptions = 0, 0
        self._stop = threading.Event()
        self._serving = serve(self._serve, "127.0.0.1", port, subprotocols=[version], process_request=self._admit,
                              compression=None)  # fmt: skip
        self.port = self._serving.socket.getsockname()[1]
        self._thread = threading.Thread(target=self._serving.serve_forever, daemon=True)
        self._thread.start()

    def stop(self) -> None:
        self._stop.set()
        self._serving.shutdown()

    def _admit(self, connection: Any, request: Any) -> Any:
        self.asked.append(request.headers.get("Authorization", ""))
        if self.status:
            answer = connection.respond(self.status, "no\n")
            if self.wait:
                answer.headers["Retry-After"] = self.wait
            return answer
        if self.token and self.asked[-1] != f"Bearer {self.token}":
            return connection.respond(401, "no\n")
        return None

    def _serve(self, socket: Any) -> None:
        with contextlib.suppress(ConnectionClosed):
            self._session(socket)

    def _session(self, socket: Any) -> None:
        number, done, begun = 1, {}, {}

        def send(name: str, body: dict[str, Any], answers: int = 0, flags: int = 2) -> None:
            nonlocal number
            number += 2
            socket.send(encode(name, body, number, answers, flags))

        while not self._stop.is_set():
            try:
                message = socket.recv(0 if done and any(one < self.count for one in done.values()) else 0.01)
            except TimeoutError:
                message = b""
            if message:
                name, body, asked = decode(message)
                if name == "RequestSession":
                    if self.refuse:
                        error = {"message": self.refuse, "code": 4}
                        send("ProtocolException", {"error": error, "errors": {}}, asked)
                        continue
                    version = {"major": 1, "minor": 2, "revision": 0, "patch": 0}
                    protocols = [{"protocol": one, "protocolVersion": version, "role": "store",
                                  "protocolCapabilities": {}} for one in self.protocols]  # fmt: skip
                    send("OpenSession", {
                        "applicationName": "test", "applicationVersion": "1", "serverInstanceId": b"\1" * 16,
                        "supportedProtocols": protocols, "supportedDataObjects": [], "supportedCompression": "",
                        "supportedFormats": ["xml"], "currentDateTime": 0, "earliestRetainedChangeTime": 0,
                        "sessionId": b"\2" * 16, "endpointCapabilities": {},
                    }, asked)  # fmt: skip
                elif name == "GetChannelMetadata":
                    ids = 10 * len(self.asked)  # numbers of a session
                    send("GetChannelMetadataResponse", {"metadata": {
                        str(at): self._described(ids + at, one) for at, one in enumerate(self.names)
                    }}, asked)  # fmt: skip
                elif name == "SubscribeChannels":
                    for one in body["channels"].values():
                        start = one["startIndex"]["item"]
                        at = self.first if start is None else round((start - FIRST) / STEP)
                        done[one["channelId"]] = at if self.backfills or start is None else max(at, self.count)
                    self.subscriptions += 1
                elif name == "GetRanges":
                    for one in body["channelRanges"]:
                        ends = (one["interval"][end]["item"] for end in ("startIndex", "endIndex"))
                        low, high = (round((end - FIRST) / STEP) for end in ends)
                        items = [
                            self._item(channel, at) for channel in one["channelIds"] for at in range(low, high + 1)
                        ]
                        for start in range(0, len(items), 500):
                            send("GetRangesResponse", {"data": items[start : start + 500]}, asked, 3)
            while self.extra:
                socket.send(self.extra.pop(0))
            count, items = self.count, []
            for channel, at in done.items():
                stop = min(count, at + 200)
                items += [self._item(channel, each) for each in range(at, stop)]
                done[channel] = stop
            if items:
                begun |= done
                self.sent += len(items)
                if any(one in self.damaged for one in done.values()):
                    self.damaged = set()
                    socket.send(encode("ChannelData", {"data": items}, 7, 0)[:-5])
                    continue
                send("ChannelData", {"data": items})

    def _described(self, number: int, name: str) -> dict[str, Any]:
        ends = {"startIndex": {"item": FIRST}, "endIndex": {"item": FIRST + STEP * self.count}, "uom": "m",
                "depthDatum": ""}  # fmt: skip
        index = {"indexKind": self.index_kind, "interval": ends, "direction": self.direction, "name": "MD", "uom": "m",
                 "depthDatum": "", "indexPropertyKindUri": "", "filterable": True}  # fmt: skip
        unit = self.units[self.names.index(name)]
        return {"uri": f"eml:///witsml20.Channel({name})", "id": number, "indexes": [index], "channelName": name,
                "dataKind": "typeDouble", "uom": unit, "depthDatum": "", "channelClassUri": "", "status": "Active",
                "source": "", "axisVectorLengths": [], "attributeMetadata": [], "customData": {}}  # fmt: skip

    def _item(self, channel: int, number: int) -> dict[str, Any]:
        name = self.names[channel % 10]
        return {"channelId": channel, "indexes": [{"item": FIRST + STEP * number}],
                "value": {"item": value(name, number) if name in NAMES else 1.0}, "valueAttributes": []}  # fmt: skip


def main() -> None:
    options = argparse.ArgumentParser()
    options.add_argument("port", type=int)
    options.add_argument("rate", type=float)
    options.add_argument("count", type=int)
    options.add_argument("--begun", type=Path, required=True)
    given = options.parse_args()
    server = Server(given.port)
    print("up", "independent" if INDEPENDENT else "", flush=True)
    began = given.begun.stat().st_mtime
    while True:
        server.count = min(given.count, int((time.time() - began) * given.rate))
        time.sleep(0.002)


if __name__ == "__main__":
    main()

"""Subscribe to channels of an ETP 1.2 server over a WebSocket: protocol 21, ChannelSubscribe, as its customer.

    RequestSession -> OpenSession -> GetChannelMetadata -> SubscribeChannels, each channel from its last index on
    ChannelData ... -> read() -> journal -> reader        a channel that begins later than asked: GetRanges for the rest

Each message from the metadata on is stored as it came, behind one line: ``etp BYTES\\n``. Messages are Avro, binary;
compressed ones are not asked for and not read. Certificates are always verified; proxies and redirects are not used.
Token and password are read from the environment and appear in no text.
"""

from __future__ import annotations

import base64
import io
import logging
import ssl
import time
import uuid
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

from helibore.base.errors import InputError, needs
from helibore.live.wire.address import Address
from helibore.live.wire.redaction import Redactor
from helibore.live.wire.store import retry_after
from helibore.live.wire.transport import AccessDeniedError, BusyError, Link, Opener

if TYPE_CHECKING:
    from helibore.live.wire.web_socket import WebSocket

VERSION = "etp12.energistics.org"
"""Name of ETP 1.2 as a subprotocol of WebSocket."""
ANSWER = 10.0
"""Seconds for an answer of the server."""
AT_ONCE = 65_536
"""Bytes of messages from which no further one is stored together with them."""
CORE, SUBSCRIBE = 0, 21
FINAL, COMPRESSED, EXTENDED = 0x02, 0x08, 0x20
"""Flags of a message: the last of several; a compressed body; a longer header."""
OTHER_SERVER = 400, 404, 405, 426, 501
"""Answers to a request for a WebSocket from servers that have none of ETP 1.2 at this path."""
NO_ACCESS = 10, 27
"""Codes of a ProtocolException: the authorization expired, or is required."""
Positions = Callable[[], dict[str, float] | None]
"""Returns for each channel that sent a value the index from which it is asked for again."""
MESSAGES = {
    (CORE, 1): "RequestSession", (CORE, 2): "OpenSession", (CORE, 5): "CloseSession", (CORE, 8): "Ping",
    (CORE, 9): "Pong", (CORE, 1000): "ProtocolException", (CORE, 1001): "Acknowledge",
    (SUBSCRIBE, 1): "GetChannelMetadata", (SUBSCRIBE, 2): "GetChannelMetadataResponse",
    (SUBSCRIBE, 3): "SubscribeChannels", (SUBSCRIBE, 12): "SubscribeChannelsResponse", (SUBSCRIBE, 4): "ChannelData",
    (SUBSCRIBE, 6): "RangeReplaced", (SUBSCRIBE, 8): "SubscriptionsStopped", (SUBSCRIBE, 9): "GetRanges",
    (SUBSCRIBE, 10): "GetRangesResponse", (SUBSCRIBE, 13): "ChannelsTruncated",
}  # fmt: skip
"""Name of each message by protocol and type; a ProtocolException comes with the protocol of its cause."""
NUMBERS = {name: number for number, name in MESSAGES.items()}
RECORDS = {
    "MessageHeader": "protocol int, messageType int, correlationId long, messageId long, messageFlags int",
    "MessageHeaderExtension": "extension DataValue{}",
    "Version": "major int, minor int, revision int, patch int",
    "SupportedProtocol": "protocol int, protocolVersion Version, role string, protocolCapabilities DataValue{}",
    "SupportedDataObject": "qualifiedType string, dataObjectCapabilities DataValue{}",
    "ErrorInfo": "message string, code int",
    "RequestSession": "applicationName string, applicationVersion string, clientInstanceId Uuid, "
    "requestedProtocols SupportedProtocol[], supportedDataObjects SupportedDataObject[], "
    "supportedCompression string[], supportedFormats string[], currentDateTime long, earliestRetainedChangeTime long, "
    "serverAuthorizationRequired boolean, endpointCapabilities DataValue{}",
    "OpenSession": "applicationName string, applicationVersion string, serverInstanceId Uuid, "
    "supportedProtocols SupportedProtocol[], supportedDataObjects SupportedDataObject[], supportedCompression string, "
    "supportedFormats string[], currentDateTime long, earliestRetainedChangeTime long, sessionId Uuid, "
    "endpointCapabilities DataValue{}",
    "CloseSession": "reason string",
    "Ping": "currentDateTime long",
    "Pong": "currentDateTime long",
    "ProtocolException": "error null|ErrorInfo, errors ErrorInfo{}",
    "Acknowledge": "",
    "GetChannelMetadata": "uris string{}",
    "GetChannelMetadataResponse": "metadata ChannelMetadataRecord{}",
    "ChannelMetadataRecord": "uri string, id long, indexes IndexMetadataRecord[], channelName string, "
    "dataKind ChannelDataKind, uom string, depthDatum string, channelClassUri string, status ActiveStatusKind, "
    "source string, axisVectorLengths int[], attributeMetadata AttributeMetadataRecord[], customData DataValue{}",
    "AttributeMetadataRecord": "attributeId int, attributeName string, dataKind ChannelDataKind, uom string, "
    "depthDatum string, attributePropertyKindUri string, axisVectorLengths int[]",
    "IndexMetadataRecord": "indexKind ChannelIndexKind, interval IndexInterval, direction IndexDirection, "
    "name string, uom string, depthDatum string, indexPropertyKindUri string, filterable boolean",
    "IndexInterval": "startIndex IndexValue, endIndex IndexValue, uom string, depthDatum string",
    "IndexValue": "item null|long|double|PassIndexedDepth",
    "PassIndexedDepth": "pass long, direction PassDirection, depth double",
    "SubscribeChannels": "channels ChannelSubscribeInfo{}",
    "ChannelSubscribeInfo": "channelId long, startIndex IndexValue, dataChanges boolean, "
    "requestLatestIndexCount null|int",
    "SubscribeChannelsResponse": "success string{}",
    "ChannelData": "data DataItem[]",
    "DataItem": "channelId long, indexes IndexValue[], value DataValue, valueAttributes DataAttribute[]",
    "DataAttribute": "attributeId int, attributeValue DataValue",
    "RangeReplaced": "changeTime long, channelIds long[], changedInterval IndexInterval, data DataItem[]",
    "SubscriptionsStopped": "reason string, channelIds long{}",
    "GetRanges": "requestUuid Uuid, channelRanges ChannelRangeInfo[]",
    "ChannelRangeInfo": "channelIds long[], interval IndexInterval, secondaryIntervals IndexInterval[]",
    "GetRangesResponse": "data DataItem[]",
    "ChannelsTruncated": "channels TruncateInfo[], changeTime long",
    "TruncateInfo": "channelId long, newEndIndex IndexValue",
    "DataValue": "item null|boolean|int|long|float|double|string|ArrayOfBoolean|ArrayOfNullableBoolean|ArrayOfInt|"
    "ArrayOfNullableInt|ArrayOfLong|ArrayOfNullableLong|ArrayOfFloat|ArrayOfDouble|ArrayOfString|ArrayOfBytes|bytes|"
    "AnySparseArray",
    "AnySparseArray": "slices AnySubarray[]",
    "AnySubarray": "start long, slice AnyArray",
    "AnyArray": "item ArrayOfBoolean|ArrayOfInt|ArrayOfLong|ArrayOfFloat|ArrayOfDouble|ArrayOfString|bytes",
    **{f"ArrayOf{one.title()}": f"values {one}[]" for one in ("boolean", "int", "long", "float", "double", "string")},
    "ArrayOfBytes": "values bytes[]",
    "ArrayOfNullableBoolean": "values (null|boolean)[]",
    "ArrayOfNullableInt": "values (null|int)[]",
    "ArrayOfNullableLong": "values (null|long)[]",
}
"""Fields of each record in order; ``X[]`` is an array of X, ``X{}`` a map from texts to X, ``X|Y`` a union."""
ENUMS = {
    "ChannelDataKind": "DateTime ElapsedTime MeasuredDepth PassIndexedDepth TrueVerticalDepth typeBoolean typeInt "
    "typeLong typeFloat typeDouble typeString typeBytes",
    "ActiveStatusKind": "Active Inactive",
    "ChannelIndexKind": "DateTime ElapsedTime MeasuredDepth TrueVerticalDepth PassIndexedDepth Pressure Temperature "
    "Scalar",
    "IndexDirection": "Increasing Decreasing Unordered",
    "PassDirection": "Up HoldingSteady Down",
}


def _schema(text: str, known: set[str]) -> Any:
    """Return the Avro schema of a type; a record or enumeration stands in full where it occurs first."""
    if text.endswith("[]"):
        return {"type": "array", "items": _schema(text[:-2].strip("()"), known)}
    if text.endswith("{}"):
        return {"type": "map", "values": _schema(text[:-2], known)}
    if "|" in text:
        return [_schema(one, known) for one in text.split("|")]
    if text in known or text not in {*RECORDS, *ENUMS, "Uuid"}:
        return text
    known.add(text)
    if text in ENUMS:
        return {"type": "enum", "name": text, "symbols": ENUMS[text].split()}
    if text == "Uuid":
        return {"type": "fixed", "name": text, "size": 16}
    fields = [one.split(" ") for one in RECORDS[text].split(", ") if one]
    return {"type": "record", "name": text, "fields": [{"name": n, "type": _schema(of, known)} for n, of in fields]}


@cache
def _avro() -> Any:
    import fastavro

    return fastavro


@cache
def _parsed(name: str) -> Any:
    return _avro().parse_schema(_schema(name, set()))


def encoded(name: str, body: dict[str, Any], number: int, answers: int = 0, flags: int = FINAL) -> bytes:
    """Return a message: its header and its body."""
    out = io.BytesIO()
    protocol, kind = NUMBERS[name]
    header = {"protocol": protocol, "messageType": kind, "correlationId": answers, "messageId": number,
              "messageFlags": flags}  # fmt: skip
    _avro().schemaless_writer(out, _parsed("MessageHeader"), header)
    _avro().schemaless_writer(out, _parsed(name), body)
    return out.getvalue()


def decoded(message: bytes) -> tuple[str, dict[str, Any], dict[str, Any]]:
    """Return name, header and body of a message; the name of a message that no one needs is "".

    Raises
    ------
    ValueError
        If the message is damaged, or compressed.
    """
    stream = io.BytesIO(message)
    try:
        header: dict[str, Any] = _avro().schemaless_reader(stream, _parsed("MessageHeader"))
        number = header["protocol"], header["messageType"]
        name = MESSAGES.get(number, MESSAGES.get((CORE, header["messageType"]), "") if number[1] >= 1000 else "")
        if header["messageFlags"] & COMPRESSED and name:
            raise ValueError("it is compressed, and no compression was agreed")
        if header["messageFlags"] & EXTENDED:
            _avro().schemaless_reader(stream, _parsed("MessageHeaderExtension"))
        body: dict[str, Any] = _avro().schemaless_reader(stream, _parsed(name)) if name else {}
    except ValueError as error:
        raise ValueError(f"not a message of ETP 1.2: {error}") from None
    except Exception as error:  # the decoder raises errors of all kinds
        raise ValueError(f"not a message of ETP 1.2: {type(error).__name__}") from None
    return name, header, body


def framed(message: bytes) -> bytes:
    """Return a message as it is stored."""
    return f"etp {len(message)}\n".encode() + message


def _error_of(body: dict[str, Any]) -> tuple[str, int]:
    """Return text and code of a ProtocolException."""
    errors = [one for one in (body["error"], *body["errors"].values()) if one]
    return "; ".join(one["message"] for one in errors)[:200], errors[0]["code"] if errors else 0


class EtpLink(Link):
    """One session with a server."""

    def __init__(self, opener: EtpOpener) -> None:
        self._opener, self.peer = opener, f"{opener.address.host}:{opener.address.port}"
        self.went_well = False
        self._number = 0
        self._waiting: list[bytes] = []
        self._failure: OSError | None = None
        self._names: dict[int, str] = {}
        self._starts: dict[str, float] = {}
        self._metadata: dict[str, dict[str, Any]] = {}
        self._socket = opener.socket()
        try:
            if self._socket.spoken != VERSION:
                raise OSError(f"{self.peer}: address: the server does not speak ETP 1.2 ({VERSION})")
            self._open_session()
            self._subscribe()
        except BaseException:
            self.close()
            raise

    def _send(self, name: str, body: dict[str, Any], answers: int = 0) -> None:
        self._number += 2  # a client's numbers are even
        try:
            self._socket.send(encoded(name, body, self._number, answers))
        except self._opener.ended as error:
            raise self._ended(error) from None

    def _receive(self, seconds: float) -> bytes | None:
        """Return a message without credentials, None if none came."""
        try:
            message = self._socket.receive(seconds)
        except self._opener.ended as error:
            raise self._ended(error) from None
        return self._opener.redactor.clean(message) if message is not None else None

    def _ended(self, error: Any) -> OSError:
        if error.too_long:
            return OSError(f"{self.peer}: message_kb: a message is longer than {self._opener.most_bytes >> 10} kB")
        return OSError(f"{self.peer}: {self._opener.redactor.clean_text(str(error))}")

    def _answers(self, what: str) -> Iterator[tuple[str, dict[str, Any], dict[str, Any], bytes]]:
        """Yield the messages that come, until ANSWER seconds have passed; an exception or an end raises OSError."""
        end = time.monotonic() + ANSWER
        while (left := end - time.monotonic()) > 0:
            if (message := self._receive(left)) is None:
                break
            name, header, body = self._checked(message)
            if name == "ProtocolException":
                raise self._refused(what, body)
            yield name, header, body, message
        raise OSError(f"{self.peer}: no {what} within {ANSWER:g} s")

    def _checked(self, message: bytes) -> tuple[str, dict[str, Any], dict[str, Any]]:
        try:
            name, header, body = decoded(message)
        except ValueError as error:
            raise OSError(f"{self.peer}: a damaged message: {error}") from None
        if name == "Ping":
            self._send("Pong", {"currentDateTime": _now()}, header["messageId"])
        if name == "CloseSession":
            raise OSError(f"{self.peer}: the server closed the session: {body['reason'][:200]}")
        return name, header, body

    def _refused(self, what: str, body: dict[str, Any]) -> OSError:
        text, code = _error_of(body)
        text = f"{self.peer}: {what}: the server refuses: {text} (code {code})"
        return AccessDeniedError(f"{text}: {self._opener.proof}") if code in NO_ACCESS else OSError(text)

    def _open_session(self) -> None:
        wanted = {"protocol": SUBSCRIBE, "protocolVersion": {"major": 1, "minor": 2, "revision": 0, "patch": 0},
                  "role": "store", "protocolCapabilities": {}}  # fmt: skip
        size = {"item": self._opener.most_bytes}
        self._send("RequestSession", {
            "applicationName": "helibore", "applicationVersion": "1", "clientInstanceId": uuid.uuid4().bytes,
            "requestedProtocols": [wanted], "supportedDataObjects": [], "supportedCompression": [],
            "supportedFormats": ["xml"], "currentDateTime": _now(), "earliestRetainedChangeTime": 0,
            "serverAuthorizationRequired": False, "endpointCapabilities": {"MaxWebSocketMessagePayloadSize": size},
        })  # fmt: skip
        for name, _, body, _ in self._answers("session"):
            if name == "OpenSession":
                if all(one["protocol"] != SUBSCRIBE for one in body["supportedProtocols"]):
                    raise OSError(f"{self.peer}: address: the server has no protocol {SUBSCRIBE}, ChannelSubscribe")
                return

    def _subscribe(self) -> None:
        """Ask what the channels are, and subscribe to those that the settings name."""
        uris = {str(number): uri for number, uri in enumerate(self._opener.uris)}
        self._send("GetChannelMetadata", {"uris": uris})
        there: list[str] = []
        for name, header, body, message in self._answers("metadata of uris"):
            if name == "GetChannelMetadataResponse":
                self._waiting.append(framed(message))
                for one in body["metadata"].values():
                    there.append(one["channelName"])
                    if one["channelName"] in self._opener.names and one["channelName"] not in self._metadata:
                        self._metadata[one["channelName"]] = one
                if header["messageFlags"] & FINAL or self._metadata.keys() >= self._opener.names:
                    break
        if not self._metadata:
            listed = ", ".join(sorted(there)[:20]) or "none"
            raise OSError(f"{self.peer}: uris: no channel is one that the settings name; its channels: {listed}")
        known = self._opener.position() or {}
        channels: dict[str, dict[str, Any]] = {}
        for name, one in self._metadata.items():
            first = one["indexes"][0]["interval"]["startIndex"] if one["indexes"] else {"item": None}
            if name in known:
                self._starts[name], first = known[name], {"item": known[name]}
            self._names[one["id"]] = name
            channels[str(len(channels))] = {"channelId": one["id"], "startIndex": first, "dataChanges": True,
                                            "requestLatestIndexCount": None}  # fmt: skip
        self._send("SubscribeChannels", {"channels": channels})

    def read(self, seconds: float) -> bytes | None:
        if self._waiting:
            return self._waiting.pop(0)
        if self._failure:
            raise self._failure
        message, parts, size = self._receive(seconds), list[bytes](), 0
        while message is not None:
            parts.append(framed(message))
            size += len(message)
            self._judge(message)
            if self._failure or size > AT_ONCE:
                break
            try:
                message = self._receive(0)  # what has come meanwhile is stored and drawn together
            except OSError as error:
                self._failure = error
                break
        return b"".join(parts)

    def _judge(self, message: bytes) -> None:
        """Note what ends the session, because the journal gets the message first; ask for values that are missing."""
        try:
            name, _, body = self._checked(message)
            if name == "SubscriptionsStopped":
                raise OSError(f"{self.peer}: the server ended the subscription: {body['reason'][:200]}")
            if name == "ProtocolException":
                raise self._refused("subscription to uris", body)
        except OSError as error:
            self._failure, self.useful, self.went_well = error, False, False
            return
        if name == "ChannelData":
            self.went_well = True
            if self._starts:
                self._ask_for_ranges(body["data"])

    def _ask_for_ranges(self, items: list[dict[str, Any]]) -> None:
        """Ask for the values between the index that a channel should begin with and the one it begins with."""
        index = None
        for item in items:
            index = item["indexes"][0]["item"] if item["indexes"] else index
            name = self._names.get(item["channelId"], "")
            start = self._starts.pop(name, None)
            if start is None or not isinstance(index, (int, float)) or index <= start:
                continue
            axis = self._metadata[name]["indexes"][0]["interval"]
            interval = axis | {"startIndex": {"item": start}, "endIndex": {"item": index}}
            asked = {"channelIds": [item["channelId"]], "interval": interval, "secondaryIntervals": []}
            self._send("GetRanges", {"requestUuid": uuid.uuid4().bytes, "channelRanges": [asked]})

    def close(self) -> None:
        self._socket.close()


def _now() -> int:
    """Return microseconds since 1970."""
    return time.time_ns() // 1000


class EtpOpener(Opener):
    """Opens sessions with one server.

    ``secret`` is (user, password), or ("", token); None: no proof of identity. ``position`` is as in `Positions`.

    Raises
    ------
    MissingExtraError
        If websockets or fastavro is not installed.
    InputError
        If ``ca`` is not a file of certificates.
    """

    def __init__(
        self, place: str, address: Address, uris: Sequence[str], names: set[str], most_bytes: int,
        secret: tuple[str, str] | None, ca: str, position: Positions,
    ) -> None:  # fmt: skip
        super().__init__(lambda _: EtpLink(self))
        with needs("fastavro", "etp"):
            import fastavro  # noqa: F401
        with needs("websockets", "etp"):
            import websockets.exceptions

            from helibore.live.wire import web_socket
        logging.getLogger("websockets.client").setLevel(logging.WARNING)  # below, it logs headers with the secret
        self._errors: Any = websockets.exceptions
        self._connect, self.ended = web_socket.WebSocket, web_socket.EndedError
        self.address, self.uris, self.names, self.most_bytes, self.position = address, uris, names, most_bytes, position
        self.redactor = Redactor(secret)
        self.proof = "token_env" if secret and not secret[0] else "user or password_env"
        self._headers = {"etp-encoding": "binary"}
        if secret:
            words = base64.b64encode(":".join(secret).encode()).decode()
            self._headers["Authorization"] = f"Basic {words}" if secret[0] else f"Bearer {secret[1]}"
        self._trust = ssl.create_default_context() if address.kind == "wss" else None
        if self._trust and ca:
            try:
                self._trust.load_verify_locations(ca)
            except OSError as error:
                raise InputError(f"{place}.ca", f"is no file of certificates: {error}", repr(ca)) from None

    def socket(self) -> WebSocket:
        """Return a WebSocket; raise OSError if the server refuses it."""
        name = f"{self.address.host}:{self.address.port}"
        try:
            return self._connect(self.address, VERSION, self._headers, self._trust, self.most_bytes, ANSWER)
        except self._errors.InvalidStatus as error:
            status, wait = error.response.status_code, retry_after(error.response.headers.get("Retry-After", ""))
            if status in (401, 403):
                raise AccessDeniedError(f"{name}: answered {status}: {self.proof}") from None
            text = f"{name}: answered {status}"
            if status in OTHER_SERVER:
                text += f": address: it may be another path, or speak no ETP 1.2 ({VERSION})"
            elif 300 <= status < 400:
                text += ": address: redirects are not followed"
            raise (BusyError(f"{text}: asked to wait for {wait:g} s", wait) if wait else OSError(text)) from None
        except self._errors.WebSocketException as error:  # its text may repeat what the server sent
            raise OSError(f"{name}: address: no WebSocket of ETP 1.2: {type(error).__name__}") from None
        except TimeoutError:
            raise OSError(f"{name}: no connection within {ANSWER:g} s") from None
        except OSError as error:
            raise OSError(f"{name}: {error.strerror or error}") from None

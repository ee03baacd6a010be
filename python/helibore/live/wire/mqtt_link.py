"""Subscribe to an MQTT broker with QoS 1: a message is acknowledged only once the journal has it on the disk.

    broker -> paho's thread -> queue -> read() -> journal -> sync -> on_disk() -> acknowledged

The session of the client name stays at the broker, which keeps the messages of QoS 1 and 2 while helibore is away and
sends again what was not acknowledged, with the mark ``dup``. Each message is framed with one line:

    mqtt STATE TOPIC_BYTES PAYLOAD_BYTES\\n TOPIC PAYLOAD      STATE: new, dup, retained, large (without payload)
"""

from __future__ import annotations

import contextlib
import queue
import ssl
import threading
import time
from collections import deque
from collections.abc import Sequence
from typing import Any

from helibore.base.errors import InputError, needs
from helibore.live.wire.address import Address
from helibore.live.wire.transport import AccessDeniedError, Link, Opener

ANSWER = 10.0
"""Seconds for the broker's answers to the connection and to the subscriptions."""
KEEP_ALIVE = 15
"""Seconds after which a silent connection is checked."""
FULL_CHECK = 0.25
"""Seconds between two checks of whether the queue is full."""
MOST_WAITING = 1000
"""The most messages that wait to be stored; beyond that, the broker waits."""
DENIED = 4, 5, 134, 135
"""Codes with which a broker refuses a user or a password."""
REFUSED = 128
"""Codes of a subscription from this one on are refusals."""


def framed(state: str, topic: bytes, payload: bytes) -> bytes:
    """Return a message as it is stored."""
    return f"mqtt {state} {len(topic)} {len(payload)}\n".encode() + topic + payload


class MqttLink(Link):
    """One connection to a broker."""

    useful = True

    def __init__(self, opener: MqttOpener) -> None:
        self._opener, host, port = opener, opener.address.host, opener.address.port
        self.peer = f"{host}:{port}"
        self._came: queue.Queue[tuple[bytes, int]] = queue.Queue(MOST_WAITING)
        self._unacknowledged: deque[tuple[int, int]] = deque()
        self._delivered, self.went_well = 0, False
        self._answers: queue.SimpleQueue[tuple[str, Any]] = queue.SimpleQueue()
        self._ended, self._closing = threading.Event(), threading.Event()
        self._client = client = opener.client()
        client.on_connect = lambda *facts: self._answers.put(("connected", facts[3]))
        client.on_subscribe = lambda *facts: self._answers.put(("subscribed", facts[3]))
        client.on_disconnect = lambda *_: self._end()
        client.on_message = self._message
        try:
            client.connect(host, port, keepalive=KEEP_ALIVE)
            client.loop_start()
            code = self._answer("connected")
            if code.is_failure:
                text = f"{self.peer}: the broker refuses the connection: {code}"
                raise AccessDeniedError(f"{text}: user or password_env") if code.value in DENIED else OSError(text)
            client.subscribe([(topic, 1) for topic in opener.topics])
            self._check_subscription()
        except BaseException:
            self.close()
            raise

    def _end(self) -> None:
        self._ended.set()
        self._answers.put(("ended", None))

    def _answer(self, kind: str) -> Any:
        """Return the broker's answer; None if so many messages wait that the answer stands behind them."""
        end = time.monotonic() + ANSWER
        while (left := end - time.monotonic()) > 0:
            try:
                came, facts = self._answers.get(timeout=min(left, FULL_CHECK))
            except queue.Empty:
                if self._came.full():
                    return None
                continue
            if came == kind:
                return facts
            if came == "ended":
                raise OSError(f"{self.peer}: the broker closed the connection")
        raise OSError(f"{self.peer}: no answer within {ANSWER:g} s")

    def _check_subscription(self) -> None:
        """Wait for the answer to the subscription, unless it stands behind messages that must be read first."""
        if (granted := self._answer("subscribed")) is None:
            return
        for topic, code in zip(self._opener.topics, granted, strict=True):
            if code.value >= REFUSED:
                raise OSError(f"{self.peer}: topics: the broker refuses {topic!r}: its rights are missing")
        self.went_well = True

    def _message(self, _: object, __: object, message: Any) -> None:
        """Queue a message; paho's thread waits here while the queue is full, so the broker waits, too."""
        state = "retained" if message.retain else "dup" if message.dup else "new"
        topic, payload = message.topic.encode(), message.payload
        if len(payload) > self._opener.most_bytes:
            state, payload = "large", b""
        mid = message.mid if message.qos else -1
        while not self._closing.is_set():
            with contextlib.suppress(queue.Full):
                self._came.put((framed(state, topic, payload), mid), timeout=FULL_CHECK)
                return

    def read(self, seconds: float) -> bytes | None:
        try:
            payload, mid = self._came.get(timeout=seconds)
        except queue.Empty:
            if self._ended.is_set() and self._came.empty():
                raise OSError(f"{self.peer}: the connection to the broker ended") from None
            if not self.went_well:
                self._check_subscription()
            return b""
        self._delivered += 1
        if mid >= 0:
            self._unacknowledged.append((self._delivered, mid))
        return payload

    @property
    def holds(self) -> int:
        return self._delivered

    def on_disk(self, mark: int) -> None:
        while self._unacknowledged and self._unacknowledged[0][0] <= mark:
            self._client.ack(self._unacknowledged.popleft()[1], 1)

    def close(self) -> None:
        self._closing.set()
        with contextlib.suppress(Exception):
            self._client.disconnect()
        with contextlib.suppress(Exception):
            self._client.loop_stop()


class MqttOpener(Opener):
    """Opens links to one broker.

    Raises
    ------
    MissingExtraError
        If paho-mqtt is not installed.
    InputError
        If ``ca`` is not a file of certificates.
    """

    def __init__(
        self, place: str, address: Address, client: str, topics: Sequence[str], most_bytes: int,
        auth: tuple[str, str] | None, ca: str,
    ) -> None:  # fmt: skip
        super().__init__(lambda _: MqttLink(self))
        with needs("paho-mqtt", "mqtt"):
            import paho.mqtt.client
            import paho.mqtt.enums
        self._version = paho.mqtt.enums.CallbackAPIVersion.VERSION2
        self._paho, self.address, self.topics, self.most_bytes = paho.mqtt.client, address, topics, most_bytes
        self._name, self._auth = client, auth
        self._trust = ssl.create_default_context() if address.kind == "mqtts" else None
        if self._trust and ca:
            try:
                self._trust.load_verify_locations(ca)
            except OSError as error:
                raise InputError(f"{place}.ca", f"is no file of certificates: {error}", repr(ca)) from None

    def client(self) -> Any:
        """Return a client of paho that keeps its session, acknowledges nothing by itself and does not reconnect."""
        client = self._paho.Client(
            self._version, self._name, clean_session=False, reconnect_on_failure=False, manual_ack=True
        )
        client.connect_timeout = ANSWER
        if self._auth:
            client.username_pw_set(*self._auth)
        if self._trust:
            client.tls_set_context(self._trust)
        return client

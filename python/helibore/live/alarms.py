"""Alarms: send a line at once when something goes wrong, and another when the cause is gone.

    watch thread: check() every TICK -> begins, ends -> event, metrics, log, page
                                             '-> queue -> one thread -> command, webhook       a line of JSON each

Only the thread behind the queue waits for the command and the webhook. The command and the webhook each have a time
limit of SECONDS, and at most MOST_LINES lines wait in the queue. ``check`` takes the time from the clock of `Live`, so
that a test can set it.
"""

from __future__ import annotations

import contextlib
import datetime
import http.client
import json
import os
import queue
import shutil
import signal
import socket
import subprocess
import threading
import time
import urllib.error
import urllib.request
from collections import Counter, deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from helibore.base.addresses import split_credentials
from helibore.base.errors import InputError
from helibore.base.utc_time import SECOND, utc
from helibore.live.ahead import Ahead, TightAhead
from helibore.live.live import Live
from helibore.live.model.model import OUTSIDE, USABLE
from helibore.live.model.update import Update
from helibore.live.rules.configuration import AlarmLimits
from helibore.live.rules.sources import Source
from helibore.logs.zone_criteria import median_enlargement

HOLD = 60.0
"""Seconds that an alarm with a momentary cause (clock, depth jump, tight hole, washout) lasts after the last cause."""
MOMENTARY = "depth_jump", "depth_step", "hole_falls"
"""Rules of the model whose every event begins an alarm that lasts for HOLD."""
SECONDS = 10.0
"""Time limit of one run of the alarm command, and of one request to the webhook."""
WAITS = (0.0, 1.0, 5.0)
"""Seconds to wait before the first, the second and the third try to deliver a line."""
LONGEST_LINE = 200
"""The most bytes that are kept of the last line on the command's stderr: those at the end of the line."""
MOST_LINES = 100
"""The most lines that wait in the queue for the command and the webhook."""
MOST_RANGES = 256
"""The most changed ranges of vertices that wait for the next check; if there are more, the latest ranges are kept."""
ENVIRONMENT = (
    "PATH", "HOME", "USER", "LOGNAME", "SHELL", "LANG", "LANGUAGE", "TZ", "TMPDIR", "DISPLAY", "WAYLAND_DISPLAY",
    "XDG_RUNTIME_DIR", "DBUS_SESSION_BUS_ADDRESS",
)  # fmt: skip
"""The environment variables that the command gets, with those of ``LC_`` and of the setting ``environment``.

The others stay away from it, because passwords and tokens are among them.
"""
STEP = 0.01
"""Metres by which the bit must move to count as moving."""
TICK = 0.25
"""Seconds between two checks."""
WAITING = "waiting for the disk"
"""Text in `Server.states` for a source whose record cannot be stored yet, because the disk refuses it."""
REASONS = {
    "NULL": "no value",
    "INVALID": "not a number",
    "RANGE": "depth or radius out of range",
    "DUPLICATE": "sent twice",
    "NO_DEPTH": "no bit depth close in time",
    OUTSIDE: "before the start of the wall",
}
"""The reason in words for each outcome of a sample that is refused."""
CAUSES = {
    "NULL": "what it sends has another name (caliper), or is null (nulls)",
    "INVALID": "texts or another unit come (caliper), or the names are those of other values",
    "RANGE": "another unit or diameters come (caliper.radius_unit, caliper.measures), or the hole is as wide "
    "(caliper.radius_range, depth.depth_range)",
    "DUPLICATE": "the sender repeats itself, or what it counts is no sequence number",
    "NO_DEPTH": "the bit depth has another name (items.bit_depth), or comes too rarely (passes.max_depth_gap)",
    OUTSIDE: "the depth is wrong, or wall.start_depth is too deep",
}
"""What may be the cause of each of these reasons, and the setting to check."""


def local(wall: int) -> datetime.datetime:
    """Return a time, ns since 1970, in this machine's time zone."""
    return datetime.datetime.fromtimestamp(wall / 1e9, datetime.UTC).astimezone()


def clock_text(wall: int) -> str:
    """Return a time, ns since 1970, as a clock shows it: in UTC and, if it differs, in this machine's time zone."""
    here = local(wall)
    return f"{utc(wall)[11:19]} UTC" + (f", {here:%H:%M:%S} here" if here.utcoffset() else "")


class _NoRedirects(urllib.request.HTTPRedirectHandler):
    """Makes a redirect an error, because a redirected POST would become a GET without the line of JSON."""

    def redirect_request(self, *_: object) -> None:
        return None


class _RecordingHandler(urllib.request.HTTPHandler, urllib.request.HTTPSHandler):
    """Opens connections to the webhook and appends each connection to ``made``, so that a slow request can be ended."""

    def __init__(self, made: list[http.client.HTTPConnection]) -> None:
        super().__init__()
        self._made = made

    def do_open(self, http_class: Any, req: urllib.request.Request, **options: Any) -> Any:
        def connection(*arguments: Any, **more: Any) -> http.client.HTTPConnection:
            self._made.append(http_class(*arguments, **more))
            return self._made[-1]

        return super().do_open(connection, req, **options)


class _LastLine:
    """Keeps the last line of a command's stderr; a thread reads stderr, because child processes may never close it."""

    def __init__(self, descriptor: int) -> None:
        self._stream = open(descriptor, "rb")  # noqa: SIM115 (the thread closes it)
        self._line = b""
        self._thread = threading.Thread(target=self._read, name="stderr of the alarm command", daemon=True)
        self._thread.start()

    def _read(self) -> None:
        with self._stream:
            while line := self._stream.readline(LONGEST_LINE):
                self._line = line.strip() or self._line

    def text(self) -> str:
        """Return ": " and the last line, or "" if the command wrote no line; call this after the command has ended."""
        self._thread.join(TICK)
        line = self._line.decode(errors="replace")
        return f": {''.join(c if c.isprintable() else '?' for c in line)}" if line else ""


def is_connected(source: Source, state: str) -> bool:
    """Return whether a source in this state (`Server.states`) counts as connected.

    A source with the address ``host`` always counts as connected. A source that has ended, or that waits for the disk,
    also counts as connected.
    """
    return source.address.kind == "host" or state.startswith(("connected", "ended", WAITING))


@dataclass(frozen=True)
class Alarm:
    """An alarm that has begun.

    Attributes
    ----------
    rule, source
        Name of the rule, such as ``lost``, and name of the source ("" if the alarm belongs to no source).
    wall, monotonic
        Time at which the alarm began: ns since 1970, and ns of the monotonic clock.
    text
        Cause of the alarm, in words.
    """

    rule: str
    source: str
    wall: int
    monotonic: int
    text: str

    def __str__(self) -> str:
        return self.said(named=True)

    def said(self, named: bool) -> str:
        """Return the alarm in words; only if it is ``named``, its source is among them."""
        what = f"{self.rule.replace('_', ' ')} {self.source if named else ''}".strip()
        return f"{what}: {self.text}, since {clock_text(self.wall)}"


def receiver(limits: AlarmLimits) -> str:
    """Check the command and the webhook; return the address of the webhook, or "" if there is none.

    Raises
    ------
    InputError
        If the command is no program on this machine, if a variable of ``environment`` is not set, or if the environment
        variable of the webhook is not set or does not hold ``https://...`` or ``http://...``.
    """
    if limits.command and shutil.which(limits.command[0]) is None:
        raise InputError("alarms.command[0]", "must be a program that can be run", repr(limits.command[0]))
    for name in limits.environment:
        if name not in os.environ:
            raise InputError("alarms.environment", "is not set in the environment", repr(name))
    address = limits.webhook or ""
    if address.lower().startswith("env:"):
        if address[4:] not in os.environ:
            raise InputError("alarms.webhook", "is not set in the environment", repr(address))
        variable, address = address, os.environ[address[4:]]
        if not address.startswith(("https://", "http://")):
            raise InputError("alarms.webhook", "the variable must hold https://... or http://...", repr(variable))
    return address


@dataclass
class Refused:
    """The samples of one source that were refused since its last usable sample.

    ``first`` and ``last`` are the times (monotonic ns) of the first and the last check that found such samples, and
    ``reasons`` counts these samples by outcome. ``before`` counts all samples up to the last check by outcome.
    """

    before: Counter[str]
    first: int = 0
    last: int = 0
    reasons: Counter[str] = field(default_factory=Counter)


class Alarms:
    """The alarms of a running server.

    Parameters
    ----------
    live
        The live wall; its configuration gives the limits, and its clock gives the time.
    states
        State of each source, in words (`Server.states`).

    Attributes
    ----------
    synced, sampled
        Monotonic time of the last successful sync, and of the last sample of each source; ns.
    counts, undelivered
        Number of alarms of each (rule, source), and number of lines that did not fit in the queue, or that the command
        or the webhook did not take; a line that neither took is counted twice.

    Raises
    ------
    InputError
        For the reasons that `receiver` states.
    """

    def __init__(self, live: Live, states: Mapping[str, str]) -> None:
        self._live, self._states, self._limits = live, states, live.configuration.alarms
        self._active: dict[tuple[str, str], Alarm] = {}
        self._lock = threading.Lock()
        self.counts: Counter[tuple[str, str]] = Counter()
        self.undelivered = 0
        wall, self.synced = live.clock()
        self._drift = wall - self.synced
        self._connected = dict.fromkeys(states, self.synced)
        self._position, self._moved = np.nan, self.synced
        self._received = self._before = live.model.counts["received"]  # at the last check; when the depth changed
        self._sampled = -(1 << 62)
        self._refused = {name: Refused(self._outcomes(name)) for name in live.configuration.sources}
        self._lacking: dict[str, int] = {}
        self._rested: dict[str, int] = {}  # by source: when its tool last had a reason to be silent
        self.sampled: dict[str, int] = {}
        self._jumps = self._depth_jumps()
        self._held: dict[tuple[str, str], tuple[int, str]] = {}
        self._changed: deque[tuple[int, int]] = deque(maxlen=MOST_RANGES)
        self._worst: dict[str, tuple[float, str]] = {}
        self._lock_file = live.journal.folder / "lock" if live.journal else None
        self._journal = str(live.journal.folder) if live.journal else ""
        self._inode = self._lock_file.stat().st_ino if self._lock_file else 0
        self._address = address = receiver(self._limits)
        self._ways = [
            way for way, wanted in ((self._command, self._limits.command), (self._webhook, address)) if wanted
        ]
        self._lines: queue.Queue[bytes] = queue.Queue(MOST_LINES)
        self._posting: tuple[float, list[http.client.HTTPConnection]] | None = None
        self._running: subprocess.Popen[bytes] | None = None
        self._starting, self._closed = threading.Lock(), False
        self.ahead = Ahead(live)
        self._tight: TightAhead | None = None
        self._stopping = threading.Event()
        self._thread: threading.Thread | None = None

    def start(self, thread: Callable[[str, Callable[[], None]], threading.Thread]) -> None:
        """Start the thread that delivers lines, if there is a command or a webhook; ``thread`` is `Server.thread`."""
        if self._ways:
            self._thread = thread("alarms", self._deliver)
            self._thread.start()

    @property
    def active(self) -> list[Alarm]:
        """The alarms that have begun and not ended, in the order in which they began."""
        with self._lock:
            return list(self._active.values())

    def changed(self, update: Update) -> None:
        """Remember which vertices of the wall changed, if an alarm needs them; the drawing thread calls this."""
        change = update.changes.get(self._live.model.main)
        if change and (self._limits.tight is not None or self._limits.washout is not None):
            self._changed.extend((int(start), int(stop)) for start, stop in change.ranges)

    def check(self) -> None:
        """Begin each alarm whose cause exists, and end each alarm whose cause is gone; ``failure`` never ends."""
        wall, now = self._live.clock()
        drift, self._drift = wall - now - self._drift, wall - now
        if abs(drift) > self._limits.clock * SECOND:
            self._held["clock", ""] = now, f"the wall clock was set by {drift / SECOND:+.3f} s"
        self._measure(now)
        self._hang_up()
        before, self._jumps = self._jumps, self._depth_jumps()
        for key, (count, text) in self._jumps.items():
            if count != before.get(key, (0, ""))[0]:
                self._held[key] = now, text
        found = {key: text for key, (at, text) in self._held.items() if now - at < HOLD * SECOND}
        found |= self._of_sources(now) | self._of_samples(now) | self._of_depth(now) | self._of_journal(now)
        found |= self._of_ahead()
        try:
            os.close(os.open(os.devnull, os.O_RDONLY))
        except OSError as error:
            found["descriptors", ""] = f"no file and no connection can be opened: {error.strerror}"
        if self._live.model.out_of_memory:
            found["memory", ""] = "a record was set aside because the memory was full; a restart draws it"
        for (rule, source), text in found.items():
            self.begin(rule, text, source)
        self._name_anew(self._live.model.watch.active.copy())
        for alarm in self.active:
            if alarm.rule != "failure" and (alarm.rule, alarm.source) not in found:
                self._end(alarm, wall, f"after {(now - alarm.monotonic) / SECOND:.1f} s: ")

    def _name_anew(self, found: Mapping[tuple[str, str], str]) -> None:
        """Give each alarm of the watch the latest text of its rule: more sensors may be stuck by now."""
        with self._lock:
            self._active |= {
                key: replace(self._active[key], text=text) for key, text in found.items() if key in self._active
            }

    def _of_ahead(self) -> dict[tuple[str, str], str]:
        """Return the text of the alarm ``tight_ahead``; at another place it ends, and begins with the next check."""
        before, self._tight = self._tight, self.ahead.look()
        if self._tight is None or (before and not self._tight.meets(before)):
            return {}
        return {("tight_ahead", ""): self._tight.text}

    def _hang_up(self) -> None:
        """End a request to the webhook that takes over SECONDS; urllib limits only the time for each piece of data.

        What the webhook sent before that counts. So only reading ends: if both ways ended, its next byte would reset
        the connection, and whether a line with the status 200 is delivered would depend on which thread runs first.
        """
        if (posting := self._posting) and time.monotonic() - posting[0] > SECONDS:
            for connection in posting[1]:
                if (link := connection.sock) is not None:  # None before it connects and after it closes
                    with contextlib.suppress(OSError):
                        socket.socket.shutdown(link, socket.SHUT_RD)

    def begin(self, rule: str, text: str, source: str = "") -> None:
        """Begin an alarm, unless an alarm of the same rule and source has begun and not ended."""
        alarm = Alarm(rule, source, *self._live.clock(), text)
        with self._lock:
            if self._active.setdefault((rule, source), alarm) is not alarm:
                return
            self.counts[rule, source] += 1
        self._report(alarm, alarm.wall)

    def _end(self, alarm: Alarm, wall: int, ended: str) -> None:
        with self._lock:
            del self._active[alarm.rule, alarm.source]
        _, worst = self._worst.pop(alarm.rule, (0.0, alarm.text))
        said = alarm if worst == alarm.text else replace(alarm, text=f"{alarm.text}; the worst: {worst}")
        self._report(said, wall, ended)

    def close(self) -> None:
        """End all alarms except ``failure``, and stop the thread that delivers lines.

        The thread first tries once to deliver each waiting line. This method waits for it at most half of SECONDS.
        """
        wall, now = self._live.clock()
        for alarm in self.active:
            if alarm.rule != "failure":
                self._end(alarm, wall, f"helibore stops, after {(now - alarm.monotonic) / SECOND:.1f} s: ")
        self._stopping.set()
        if self._thread:
            self._thread.join(SECONDS / 2)
        with self._starting:  # a command that hangs must not outlive helibore, and no other one begins
            self._closed, running = True, self._running
        if running is not None and running.poll() is None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(running.pid, signal.SIGKILL)

    def _of_sources(self, now: int) -> dict[tuple[str, str], str]:
        found = {}
        ages, resting = self._live.ages(), self._live.model.rig.pumps_may_be_off
        for name, source in self._live.configuration.sources.items():
            state = self._states[name]
            if state == "ended":
                continue
            is_tool = bool(source.caliper or source.images) and "bit_depth" not in source.rig
            if resting and is_tool and ("no_data", name) not in self._active:
                self._rested[name] = now
            if min(ages[name], (now - self._rested.get(name, -(1 << 62))) / SECOND) > source.silence:
                found["no_data", name] = f"nothing has come for {source.silence:g} s"
            if is_connected(source, state):
                self._connected[name] = now
            elif state.startswith("stopped"):
                found["lost", name] = state
            elif now - self._connected[name] > self._limits.lost * SECOND:
                found["lost", name] = f"{state}: not connected for {self._limits.lost:g} s"
            if state == WAITING:
                found["disk", ""] = "the disk takes no record"
        return found

    def _outcomes(self, source: str) -> Counter[str]:
        """Return the number of samples of a source for each outcome."""
        counted = self._live.model.outcomes
        return Counter({outcome: counted[source, outcome] for outcome in (USABLE, *REASONS)})

    def _of_samples(self, now: int) -> dict[tuple[str, str], str]:
        """Return the text of each alarm about samples (``refused``, ``toolface``, ``missing``) that has a cause."""
        found: dict[tuple[str, str], str] = {}
        found |= self._live.model.watch.active.copy() | self._live.model.channels.active.copy()
        for name, refused in self._refused.items():
            new = self._outcomes(name) - refused.before
            refused.before += new
            if new:
                self.sampled[name] = now
            if new[USABLE]:
                refused.reasons.clear()
            elif new:
                refused.first = refused.first if refused.reasons else now
                refused.last, refused.reasons = now, refused.reasons + new
            if refused.reasons and refused.last - refused.first > self._limits.refused * SECOND:
                why = ", ".join(f"{count:,} {REASONS[reason]}" for reason, count in refused.reasons.most_common())
                cause = CAUSES[refused.reasons.most_common(1)[0][0]]
                found["refused", name] = f"no sample was usable for {self._limits.refused:g} s: {why}: {cause}"
        for reader in list(self._live.model.readers.values()):
            name = reader.source.name
            if reader.seems_radians:
                found["toolface", name] = reader.seems_radians
            found |= {(rule, name): text for rule, text in list(reader.doubts.items())}
            if lacking := reader.lacking():
                if now - self._lacking.setdefault(name, now) > self._limits.refused * SECOND:
                    found["missing", name] = f"{lacking}, for {self._limits.refused:g} s"
            else:
                self._lacking.pop(name, None)
        return found

    def _depth_jumps(self) -> dict[tuple[str, str], tuple[int, str]]:
        """Return, for each rule of MOMENTARY and source, the number of its events and the text of the latest one."""
        events = (event for event in self._live.model.events.latest if event.rule in MOMENTARY)
        return {(event.rule, event.source): (event.count, event.newest.text) for event in events}

    def _of_depth(self, now: int) -> dict[tuple[str, str], str]:
        """Return the text of the alarm ``standing`` if samples come although the bit depth does not change.

        If no bit depth is known, the number of vertices counts instead.
        """
        model, limit = self._live.model, int(self._limits.standing * SECOND)
        bit = model.rig.tracks["bit_depth"].value[-1:].tolist()
        position = bit[0] if bit else float(len(self._live.wall))
        if not abs(position - self._position) <= STEP:
            self._position, self._moved, self._before = position, now, model.counts["received"]
        if model.counts["received"] != self._received:
            self._received, self._sampled = model.counts["received"], now
        if now - self._moved > limit and now - self._sampled < limit:
            came = self._received - self._before
            text = f"{came:,} samples came, and depth has not changed for {self._limits.standing:g} s"
            return {
                ("standing", ""): f"{text}: the depth is stuck (items.bit_depth), or the tool measures at one place"
            }
        return {}

    def _of_journal(self, now: int) -> dict[tuple[str, str], str]:
        journal, found = self._live.journal, {}
        if journal is None or self._lock_file is None:
            return {}
        try:
            if self._lock_file.stat().st_ino != self._inode:
                found["journal", ""] = "the lock file of the journal was replaced"
            left = journal.bytes_left / 1e9
            if left < self._limits.disk_gb:
                found["disk", ""] = f"{left:.2f} GB left for the journal, less than {self._limits.disk_gb:g} GB"
        except OSError as error:
            found["journal", ""] = f"the journal's folder or its lock file is gone: {error.strerror}"
        interval = self._live.configuration.journal.sync_interval
        if interval and now - self.synced > (self._limits.sync + interval) * SECOND:
            found["sync", ""] = f"the journal was not synced for {self._limits.sync:g} s"
        return found

    def _measure(self, now: int) -> None:
        """Find causes of the alarms ``tight`` and ``washout`` in changed turns; keep the latest and the worst cause.

        A turn is a cause if its median diameter is beyond the limit and none of its radii is missing.
        """
        wall, limits = self._live.wall, self._limits
        sectors, bit = wall.settings.sectors, self._live.model.configuration.wall["bit_diameter"]
        for start, stop in [self._changed.popleft() for _ in range(len(self._changed))]:
            first, last = start // sectors, min(-(-stop // sectors), len(wall) // sectors)
            if last <= first:
                continue
            turns = wall.vertices(first * sectors, last * sectors)
            over = median_enlargement(turns.radius, sectors, bit)
            for rule, limit, sign in (("tight", limits.tight, -1), ("washout", limits.washout, 1)):
                if limit is not None and (sign * over > limit).any():
                    turn = int(np.nanargmax(sign * over))
                    depth, word = turns.depth[turn * sectors], "below" if rule == "tight" else "above"
                    text = f"at {depth:.2f} m the diameter is {1e3 * abs(over[turn]):.1f} mm {word} the bit diameter"
                    self._held[rule, ""] = now, text
                    self._worst[rule] = max(self._worst.get(rule, (0.0, "")), (float(sign * over[turn]), text))

    def _report(self, alarm: Alarm, wall: int, ended: str = "") -> None:
        """Report that an alarm begins, or that it ``ended``, and queue the line for the command and the webhook."""
        self._live.report(f"alarm_{alarm.rule}" + ("_end" if ended else ""), ended + alarm.text, alarm.source)
        state = "ends" if ended else "begins"
        line = {"journal": self._journal, "alarm": alarm.rule, "source": alarm.source, "state": state,
                "time": utc(wall), "local_time": local(wall).isoformat(timespec="milliseconds"),
                "text": alarm.text}  # fmt: skip
        try:
            if self._ways:
                self._lines.put_nowait(json.dumps(line).encode() + b"\n")
        except queue.Full:
            self.undelivered += 1

    def _deliver(self) -> None:
        """Give each line to the command and to the webhook."""
        while not (self._closed or (self._stopping.is_set() and self._lines.empty())):
            try:
                line = self._lines.get(timeout=TICK)
            except queue.Empty:
                continue
            for way in self._ways:
                self.undelivered += not any(self._sent(way, line, wait) for wait in WAITS)

    def _sent(self, way: Callable[[bytes], None], line: bytes, wait: float) -> bool:
        if self._stopping.wait(wait) and wait:
            return False
        try:
            way(line)
        except (OSError, ValueError, RuntimeError, subprocess.SubprocessError, http.client.HTTPException) as error:
            reason = getattr(error, "reason", getattr(error, "strerror", None)) or type(error).__name__
            if isinstance(error, urllib.error.HTTPError):  # the phrase that the server sends may repeat a password
                reason = http.client.responses.get(error.code, f"answered {error.code}")
            self._live.report("alarm_not_delivered", f"{way.__name__.strip('_')}: {reason}")
            return False
        return True

    def _command(self, line: bytes) -> None:
        named = {*ENVIRONMENT, *self._limits.environment}
        environment = {name: value for name, value in os.environ.items() if name in named or name.startswith("LC_")}
        reading, writing = os.pipe()
        said = _LastLine(reading)
        try:
            with self._starting:
                if self._closed:
                    raise ChildProcessError(0, "helibore stops")
                command = subprocess.Popen(self._limits.command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL,
                                           stderr=writing, env=environment, start_new_session=True)  # fmt: skip
                self._running = command
        finally:
            os.close(writing)
        try:
            command.communicate(line, timeout=SECONDS)
        except subprocess.TimeoutExpired:
            os.killpg(command.pid, signal.SIGKILL)  # also the processes that the command started
            command.wait()
            raise
        if command.returncode:
            raise ChildProcessError(command.returncode, f"it ended with {command.returncode}{said.text()}")

    def _webhook(self, line: bytes) -> None:
        address, credentials = split_credentials(self._address)
        headers = {"Content-Type": "application/json"} | ({"Authorization": credentials} if credentials else {})
        request = urllib.request.Request(address, line, headers, method="POST")
        try:
            made: list[http.client.HTTPConnection] = []
            self._posting = time.monotonic(), made
            urllib.request.build_opener(_NoRedirects, _RecordingHandler(made)).open(request, timeout=SECONDS).close()
        except urllib.error.HTTPError as error:
            error.close()
            raise
        finally:
            self._posting = None

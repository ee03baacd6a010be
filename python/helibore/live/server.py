"""Run the sources of a live wall.

    link -> journal -> queue (bounded) -> model          a full queue or a full disk stops the reading: the sender waits

Each source has a thread that reads it. Five more threads draw, sync the journal, watch, write checkpoints, and make the
fits of an automatic estimator, which take a second or two while the wall goes on growing as before. Bytes are in the
journal before they are in the queue. A broken link is opened again after 1, 2, 4, 5, 5 ... s; a store is asked again
after 1, 2, 4 ... 60 s. Each wait is randomly shortened by up to half, so that the sources do not reconnect at the same
time.
"""

from __future__ import annotations

import contextlib
import functools
import random
import threading
import time
from collections import deque
from collections.abc import Callable

from helibore.base.errors import InputError
from helibore.base.utc_time import SECOND
from helibore.live.alarms import TICK, WAITING, Alarms
from helibore.live.journal import checkpoint
from helibore.live.journal import journal as journals
from helibore.live.journal.archived_segments import archive
from helibore.live.journal.journal import JournalFullError
from helibore.live.journal.session_header import changed_to
from helibore.live.live import Live, Stored
from helibore.live.model.events import LOGGER
from helibore.live.model.update import Update
from helibore.live.rules.configuration import Configuration
from helibore.live.rules.kinds import kind_of
from helibore.live.rules.sources import Source
from helibore.live.wire.transport import AccessDeniedError, BusyError, Link, Opener

QUEUE_BYTES = 4 << 20
QUEUE_RECORDS = 4096
FIRST_WAIT = 1.0
CHECKPOINT_AGAIN = 60.0
"""Seconds until the next try after a checkpoint could not be written."""
TABLES_OF_START = "journal", "snapshot", "alarms"
"""Tables that a running server does not change."""


def back_off(failures: int, longest: float, draw: Callable[[], float] = random.random) -> float:
    """Return the seconds to wait after ``failures`` failures: 1, 2, 4 ... ``longest``, times a random 0.5 to 1."""
    return float(min(longest, FIRST_WAIT * 2.0 ** min(failures - 1, 16)) * (0.5 + 0.5 * draw()))


def _is_elsewhere(source: Source, used: Source) -> bool:
    """Return whether a source must be connected again after its settings changed from ``used``.

    A source of a kind that resumes loses nothing, so it is connected again for any changed setting.
    """
    return source.address != used.address or (kind_of(source).resumes and source != used)


class Queue:
    """Stored records that the model has not taken yet, in the order of the journal."""

    def __init__(self, live: Live) -> None:
        self._live = live
        self._ready = threading.Condition()
        self._records: deque[Stored] = deque()
        self._bytes = 0
        self._storing = threading.Lock()

    def put(self, source: str, connection: int, payload: bytes, kind: int, stop: threading.Event) -> None:
        """Store and queue a record; first wait while the queue is full, but no longer after ``stop``.

        A JournalFullError means that the record is neither stored nor queued.
        """
        with self._ready:
            while not stop.is_set() and (self._bytes > QUEUE_BYTES or len(self._records) > QUEUE_RECORDS):
                self._ready.wait(TICK)
        self._store(lambda: self._live.store(source, connection, payload, kind))

    def change(self, configuration: Configuration) -> None:
        """Store and queue a change of the configuration."""
        self._store(lambda: self._live.store_change(configuration))

    def fit(self, fit: bytes) -> int:
        """Store and queue what a fit found; return the number of its record."""
        return int(self._store(lambda: self._live.store_fit(fit)).record["sequence"][0])

    def _store(self, store: Callable[[], Stored]) -> Stored:
        with self._storing:  # the order of the queue is the order of the journal
            stored = store()
            with self._ready:
                self._records.append(stored)
                self._bytes += len(stored.payloads[0])
                self._ready.notify_all()
            return stored

    def take(self, seconds: float) -> list[Stored]:
        """Remove and return all queued records; if there are none, wait up to ``seconds`` for the first."""
        with self._ready:
            if not self._records:
                self._ready.wait(seconds)
            taken, self._records, self._bytes = list(self._records), deque(), 0
            self._ready.notify_all()
            return taken

    def __len__(self) -> int:
        return len(self._records)


class Latency:
    """The times from the arrival of a packet until the wall is updated with it.

    Attributes
    ----------
    counts, sum
        Number of measured times up to each of BOUNDS (s) and above the last bound; sum of all measured times, s.
    latest
        The latest thousand times, s.
    """

    BOUNDS = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)

    def __init__(self) -> None:
        self.counts = [0] * (len(self.BOUNDS) + 1)
        self.sum = 0.0
        self.latest: deque[float] = deque(maxlen=1000)

    def add(self, seconds: float) -> None:
        """Count one packet with which the wall was updated ``seconds`` after the packet arrived."""
        self.counts[next((i for i, bound in enumerate(self.BOUNDS) if seconds <= bound), len(self.BOUNDS))] += 1
        self.sum += seconds
        self.latest.append(seconds)

    def quantile(self, share: float) -> float:
        """Return the quantile ``share`` (0 to 1) of the latest thousand times; 0 if there is no time yet."""
        ordered = sorted(self.latest)
        return ordered[min(int(share * len(ordered)), len(ordered) - 1)] if ordered else 0.0


class Server:
    """Runs the sources of a live wall.

    Parameters
    ----------
    live
        The wall and its journal. The caller closes it, after :meth:`stop`.
    updated
        Function that the drawing thread calls with every Update.

    Attributes
    ----------
    latency
        The times from the arrival of a packet until the wall is updated with it.
    states
        What each source does now, in words.
    last_received
        Time of the last bytes of each source, seconds of the monotonic clock.
    failure
        The error for which a thread stopped the server; None if no thread has failed.
    """

    def __init__(self, live: Live, updated: Callable[[Update], None] = lambda _: None) -> None:
        self.live = live
        self.latency = Latency()
        self.states = dict.fromkeys(live.configuration.sources, "not started")
        self.last_received: dict[str, float] = {}
        self.failure: BaseException | None = None
        self._updated = updated
        self._queue = Queue(live)
        self._stop = threading.Event()
        self._drained = threading.Event()
        self.openers: dict[str, Opener] = {}
        self._threads: dict[str, threading.Thread] = {}
        self._begun, self._used = live.configuration, dict[str, Source]()
        self._connections: dict[str, int] = {}
        self.alarms = Alarms(live, self.states)
        self._marking, self._marks = threading.Lock(), dict[Link, int]()
        self._sync_soon = threading.Event()
        self._changing = threading.Lock()
        self._following = self._checked(live.configuration)
        self._drawing = self.thread("draw", self._draw)
        jobs = {"sync": self._sync, "watch": self._watch, "checkpoint": self._checkpoint, "fit": self._fit}
        self._own = [self._drawing, *(self.thread(name, run) for name, run in jobs.items())]

    def start(self) -> None:
        """Open listeners, then start the threads.

        Raises
        ------
        OSError
            If the address of a listener cannot be used.
        MissingExtraError, InputError
            For the reasons of `opener` and `StoreClient`.
        """
        self._change_if_due()
        self._used = dict(self.live.configuration.sources)
        try:
            for name, source in self._used.items():
                if source.address.kind != "host":
                    self.openers[name] = self._opener(name, source)
        except BaseException:
            for one in self.openers.values():
                one.close()
            raise
        self.alarms.start(self.thread)
        for name, one in list(self.openers.items()):
            self._begin(self._used[name], one)
        for thread in self._own:
            thread.start()

    def stop(self) -> None:
        """Stop reading, draw the queued records, and sync the journal."""
        self._stop.set()
        self._sync_soon.set()
        for source_thread in list(self._threads.values()):
            source_thread.join()
        self._drained.set()
        for thread in self._own:
            thread.join()
        for one in self.openers.values():
            one.close()
        self.alarms.close()
        self.live.sync()

    def reconfigure(self, configuration: Configuration) -> None:
        """Read all later bytes with another configuration; connect each source with a new address there.

        An event names the changed settings that take effect only at a restart: those of `TABLES_OF_START` and
        `SourceKind.of_start`.

        Raises
        ------
        InputError
            If `Live.reconfigure` refuses the configuration, or if a configuration that follows by ``next`` breaks a
            rule.
        JournalFullError
            If the change could not be stored; then nothing has changed.
        """
        following = self._checked(configuration)
        with self._changing:
            self._change(configuration)
            self._following = following

    def _change(self, configuration: Configuration) -> None:
        """Store and queue a change; connect sources at new addresses; report the settings that wait for a restart."""
        self._queue.change(configuration)
        for name, source in self.live.configuration.sources.items():
            if (used := self._used.get(name)) and _is_elsewhere(source, used):
                self._move(source)
        if names := self._unused(self.live.configuration):
            self.live.report("restart", f"takes effect at a restart only: {', '.join(names)}")

    def _unused(self, now: Configuration) -> list[str]:
        """Return the names of the settings that differ from what the server uses until a restart."""
        names = [name for name in TABLES_OF_START if getattr(now, name) != getattr(self._begun, name)]
        pairs = [(now.sources[name], used) for name, used in self._used.items()]
        return names + [f"source.{source.name}.{name}" for source, used in pairs for name in kind_of(used).of_start
                        if getattr(source.table, name) != getattr(used.table, name)]  # fmt: skip

    def _move(self, source: Source) -> None:
        """Connect a source at its new address; if that fails, report the reason and stay at the old address."""
        name, kind = source.name, source.address.kind
        try:
            one = None if kind == "host" else self._opener(name, source)
        except (OSError, ValueError, ImportError) as error:
            why = getattr(error, "strerror", None) or error
            self._report(name, "address", f"{why}; until a restart, the source stays at its old address")
            return
        self._used[name] = source
        self.openers.pop(name, None)
        self._report(name, "address", f"the source is now at {self.live.configuration.source[name]['address']}")
        if one:
            self._begin(source, one)

    def _begin(self, source: Source, one: Opener) -> None:
        """Start the thread that opens links to a source with ``one`` and reads them."""
        self.openers[source.name] = one
        follow = functools.partial(self._follow, source, one, self._threads.get(source.name))
        self._threads[source.name] = thread = self.thread(source.name, follow)
        thread.start()

    def _checked(self, configuration: Configuration) -> list[Configuration]:
        """Return the configurations that follow by ``next``; refuse a change that a running journal cannot make."""
        following, before = configuration.following(), self.live.configuration
        for each in [configuration, *following]:
            before = changed_to(each, before)
        return following

    def _change_if_due(self) -> None:
        """Change to each following configuration whose time or hole depth is reached."""
        depth = self.live.model.rig.tracks["hole_depth"].value[-1:].tolist()
        with self._changing, contextlib.suppress(JournalFullError):  # the next call tries again
            while (plan := self.live.configuration.next) and plan.is_due(
                self.live.clock()[0], depth[0] if depth else float("nan")
            ):
                self._change(self._following[0])
                del self._following[0]

    def thread(self, name: str, run: Callable[[], None]) -> threading.Thread:
        """Return a thread that, if it fails, reports an event, logs the error and stops the server."""

        def guarded() -> None:
            try:
                run()
            except BaseException as error:
                self.fail(name, error)

        return threading.Thread(target=guarded, name=name, daemon=True)

    def fail(self, thread: str, error: BaseException) -> None:
        """Report that a thread died, begin an alarm, and stop."""
        # A SystemExit, raised again by the caller, would end the program with the exit code 0.
        died = error if isinstance(error, Exception) else RuntimeError(repr(error))
        self.failure = self.failure or died  # set first: all that follows needs memory, which may be full
        self._stop.set()
        self._drained.set()
        text = f"thread {thread} died: {type(error).__name__}: {error}"
        self.live.report("failure", text)
        self.alarms.begin("failure", text)
        LOGGER.critical("thread %s died", thread, exc_info=error)

    def wait(self, seconds: float | None = None) -> bool:
        """Wait until every source has ended, a thread has failed, or ``seconds`` have passed.

        Only a source that is a file ends. Return whether all sources have ended and the drawing thread has taken all
        their records; `stop` waits until the last records are drawn.
        """
        end = time.monotonic() + (seconds if seconds is not None else float("inf"))
        while time.monotonic() < end and self.failure is None:
            running = any(thread.is_alive() for thread in list(self._threads.values()))
            if self.openers and not running and not len(self._queue):
                return True
            time.sleep(0.02)
        return False

    @property
    def queued(self) -> int:
        """Number of records that are stored and that the drawing thread has not taken yet."""
        return len(self._queue)

    def _report(self, source: str, rule: str, text: str) -> None:
        self.live.report(rule, text, source)

    def _opener(self, name: str, source: Source) -> Opener:
        readers, number, kind = self.live.model.readers, self.live.model.numbers[name], kind_of(source)
        return kind.open(source, lambda: readers[number].position(), functools.partial(self._report, name))

    def _is_used(self, source: Source) -> bool:
        """Return whether the server runs and ``source`` is still connected with these settings."""
        return not self._stop.is_set() and self._used[source.name] is source

    def _pause(self, source: Source, seconds: float) -> None:
        end = time.monotonic() + seconds
        while self._is_used(source) and (left := end - time.monotonic()) > 0:
            self._stop.wait(min(TICK, left))

    def _follow(self, source: Source, one: Opener, before: threading.Thread | None) -> None:
        """Open and read a source again and again until it ends or moves to another address, or the server stops.

        ``before`` is the thread that read the source at its old address; this thread waits until ``before`` has ended.
        """
        if before:
            before.join()
        try:
            self._read_again_and_again(source, one)
        finally:
            if self._used[source.name] is not source:
                one.close()

    def _read_again_and_again(self, source: Source, one: Opener) -> None:
        failures = 0
        longest = kind_of(source).longest_wait
        drawn = self.live.model.readers[self.live.model.numbers[source.name]].connection
        self._connections.setdefault(source.name, drawn)
        while self._is_used(source):
            began, why, asked = time.monotonic(), "the connection ended, and nothing came", 0.0
            link: Link | None = None
            self.states[source.name] = "connecting" if source.address.kind != "listen" else "listening"
            try:
                link = one.open(TICK)
                if link is None:
                    continue
                self._connections[source.name] += 1
                failures = 0 if self._read(source, link, self._connections[source.name]) else failures + 1
            except AccessDeniedError as error:
                self._report(source.name, "access", f"{error}: not asked again")
                self.states[source.name] = "stopped: access denied"
                self._pause(source, float("inf"))
                return
            except OSError as error:
                came = self.last_received.get(source.name, 0.0) > began
                failures = 1 if came and link is not None and link.went_well else failures + 1
                why, asked = str(error), error.seconds if isinstance(error, BusyError) else 0.0
                self._report(source.name, "link", why)
            if one.ends and failures == 0:
                self.states[source.name] = "ended"
                return
            if failures and source.address.kind != "listen":
                self.states[source.name] = f"waiting to connect: {why}"
                self._pause(source, max(asked, back_off(failures, longest)))

    def _read(self, source: Source, link: Link, connection: int) -> bool:
        """Read one link to its end; return whether any bytes came."""
        connected = f"connected to {link.peer}"
        # A store is connected once it answers.
        self.states[source.name] = "connecting" if kind_of(source).answers else connected
        came, write_at = False, time.monotonic()
        message, every = source.message or (b"", 0.0)
        try:
            self._put(source, connection, link.peer.encode(), journals.CONNECTED)
            while self._is_used(source):
                if message and time.monotonic() >= write_at:
                    link.write(message)
                    write_at = time.monotonic() + every
                wait = min(TICK, max(write_at - time.monotonic(), 0)) if message else TICK
                payload = link.read(wait)
                if payload is None:
                    break
                if payload:
                    if link.useful:
                        came, self.states[source.name] = True, connected
                        self.last_received[source.name] = time.monotonic()
                    if self._put(source, connection, payload, journals.BYTES) and link.holds:
                        self._stored(link)
        finally:
            with contextlib.suppress(OSError):  # the link may be broken
                link.close()
            self._put(source, connection, b"", journals.CLOSED)
        return came

    def _stored(self, link: Link) -> None:
        """Let the next sync acknowledge what ``link`` has returned; without syncs, acknowledge it now."""
        if self.live.journal is None or self.live.configuration.journal.sync_interval == 0:
            link.on_disk(link.holds)
            return
        with self._marking:
            self._marks[link] = link.holds
        self._sync_soon.set()

    def _put(self, source: Source, connection: int, payload: bytes, kind: int) -> bool:
        """Store a record; while the disk is full, try again every second and let the sender wait.

        Return False if the server stopped before the record was stored.
        """
        state, reported = self.states[source.name], False
        while True:
            try:
                self._queue.put(source.name, connection, payload, kind, self._stop)
            except JournalFullError as error:
                if not reported:
                    self._report(source.name, "disk", str(error))
                    self.states[source.name] = WAITING
                    reported = True
                if self._stop.wait(1.0):
                    return False  # the record is neither stored nor drawn
            else:
                self.states[source.name] = state
                return True

    def _draw(self) -> None:
        while not (self._drained.is_set() and not len(self._queue)):
            stored = self._queue.take(TICK)
            if not stored:
                continue
            update = self.live.draw(stored)
            now = time.monotonic_ns()
            for one in stored:
                self.latency.add((now - one.monotonic) / 1e9)
            self.alarms.changed(update)
            self._updated(update)

    def _sync(self) -> None:
        """Sync every ``sync_ms`` milliseconds; report when the disk first refuses a sync, and when it works again."""
        interval = self.live.configuration.journal.sync_interval
        if self.live.journal is None or interval == 0:
            return
        failing = False
        while not self._stop.is_set():
            self._sync_soon.wait(interval)
            self._sync_soon.clear()
            with self._marking:
                marks, self._marks = self._marks, {}
            try:
                self.live.sync()
                for link, mark in marks.items():
                    with contextlib.suppress(OSError, ValueError):  # the link may have ended
                        link.on_disk(mark)
                self.alarms.synced = self.live.clock()[1]
                if failing:
                    self.live.report("synced", "the disk takes the journal again")
                failing = False
            except OSError as error:
                if not failing:
                    self.live.report("disk", str(error))
                failing = True
                with self._marking:  # a later sync acknowledges them
                    self._marks = marks | self._marks
                self._stop.wait(interval)

    def _checkpoint(self) -> None:
        """Write a checkpoint after each segment, then archive old segments; after an error, try again in a minute."""
        rules = self.live.configuration.journal
        while not self._stop.wait(TICK):
            try:
                path = self.live.checkpoint() if self.live.checkpoint_due else None
                if path and rules.keep_days is not None and len(checkpoint.paths(path.parent)) == checkpoint.KEPT:
                    before = self.live.clock()[0] - int(rules.keep_days * 86_400 * SECOND)
                    archive(path.parent, remove=rules.old == "remove", before=before)
            except (OSError, InputError) as error:
                self.live.report("checkpoint", str(error))
                self._stop.wait(CHECKPOINT_AGAIN)

    def _fit(self) -> None:
        """Make the fits that are due while the other threads go on; after an error of the disk, try again later."""
        while not self._stop.wait(TICK):
            if (fit := self.live.fit()) is None or self._stop.is_set():
                continue
            try:
                number = self._queue.fit(fit)
            except JournalFullError:
                self._stop.wait(FIRST_WAIT)
                continue
            while self.live.model.next_sequence <= number and not self._stop.wait(TICK):
                pass  # the drawing thread has not come to it yet

    def _watch(self) -> None:
        """Report silence when it begins, check the alarms, and begin the next configuration when it is due."""
        while not self._stop.wait(TICK):
            self.live.check_silence()
            self.alarms.check()
            self._change_if_due()

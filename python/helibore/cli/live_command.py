"""``helibore live rig.toml``: build a wall from live sources, and show the status until Ctrl-C."""

from __future__ import annotations

import functools
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from helibore.cli.quantities import FILE, FOLDER
from helibore.cli.sections import opt, section
from helibore.cli.terminal import console as terminal_console
from helibore.cli.terminal import echo
from helibore.cli.token_options import TOKEN

if TYPE_CHECKING:
    from helibore.base.identity import Access
    from helibore.cli.live_log import LogWriter
    from helibore.cli.live_view import Window
    from helibore.live.live import Live
    from helibore.live.rules.configuration import Configuration
    from helibore.live.server import Server

TICK = 0.25
"""Seconds between two checks of the server."""
WHERE = "the token is that of HELIBORE_TOKEN or --token-file"
LAST_SECONDS = 1.0
"""Seconds for which page and metrics show the failure of a thread before the command ends.

The command also waits this long, at most, for the thread that draws the status page.
"""


@click.command(short_help="Build a wall from live sources while a hole is drilled.")
@click.argument("configuration", type=FILE)
@section(
    "Options",
    opt("--journal", "Folder of the journal.  [journal.folder]", type=FOLDER),
    opt("--snapshot folder", "Folder to write wall, mesh, logs, images and events to.  [snapshot.folder]", type=FOLDER),
    opt("--every", "Seconds between snapshots.  [snapshot.every]", type=click.FloatRange(1)),
    opt("--metrics-port", "Serve Prometheus metrics on this port.", type=click.IntRange(0, 65535)),
    opt("--view page", "Show the wall in a browser while it grows (extra 'view').", is_flag=True),
    opt("--view-port", "Port of --view; 0: a free port.", type=click.IntRange(0, 65535), default=0),
    opt("--seconds", "Stop after this time.  [until Ctrl-C, or all files are read]", type=click.FloatRange(0)),
    opt("--check", "Check the configuration, print how helibore reads each item, and stop.", is_flag=True),
    opt("-q --quiet", "Do not show the status page.", is_flag=True),
    opt("--host", "Address of page and metrics.", default="127.0.0.1"),
    *TOKEN,
    opt("--certificate", "PEM file: serve page and metrics over HTTPS.", metavar="FILE"),
    opt("--key", "PEM file of the private key of --certificate.  [the file of --certificate]", metavar="FILE"),
    opt("--log", "Also write all events to this file, which is rotated at 10 MB.", metavar="FILE"),
)
def live(
    configuration: Path, journal: Path | None, folder: Path | None, every: float | None, metrics_port: int | None,
    page: bool, view_port: int, seconds: float | None, check: bool, quiet: bool, log: str | None, host: str,
    token: str | None, token_file: Path | None, certificate: str | None, key: str | None,
) -> None:  # fmt: skip
    """Build a wall from the sources in CONFIGURATION while they send; every byte is stored in a journal first.

    \b
    helibore live rig.toml --journal well-7.journal --snapshot now

    docs/driller.md ("While drilling") has the smallest CONFIGURATION, docs/live.md has every setting. After SIGHUP
    (kill -HUP), CONFIGURATION is read again, and its changes apply to later bytes.
    """
    from helibore.base.identity import Access, find_token
    from helibore.cli.lines import counts_line
    from helibore.cli.live_check import described
    from helibore.cli.live_log import logged
    from helibore.cli.metrics_server import MetricsServer
    from helibore.live.alarms import receiver
    from helibore.live.live import Live
    from helibore.live.rules.configuration import load
    from helibore.live.server import Server

    settings = load(configuration)
    if check:
        settings.following()
        receiver(settings.alarms)
        echo(f"{configuration}: is valid; sources: {', '.join(settings.sources)}")
        echo("\n".join(described(settings)))
        return
    where = journal or (Path(settings.journal.folder) if settings.journal.folder else None)
    if where is None:
        raise click.UsageError("no journal: give --journal FOLDER, or journal.folder in the configuration")
    target = folder or (Path(settings.snapshot.folder) if settings.snapshot.folder else None)
    allowed = Access(host, find_token(token, token_file), certificate, key)
    with ExitStack() as stack:
        log_writer = stack.enter_context(logged(log, quiet))
        window = stack.enter_context(_window(configuration.stem, view_port, allowed)) if page else None
        running = stack.enter_context(Live(settings, where))
        if window:
            window.follow(running)
        server = Server(running, window.show if window else lambda _: None)
        with ExitStack() as serving:
            show = serving.enter_context(_screen(server, quiet))  # made before the server can use all file descriptors
            if window:
                serving.callback(window.close)
            with _signals() as (stopped, changed):  # before a source can send: a run may be ended as soon as it is seen
                server.start()
                serving.callback(server.stop)
                if not quiet and not terminal_console().is_terminal:  # a terminal has the status page
                    _say_sources(settings, where)
                if metrics_port is not None:
                    pages = MetricsServer(server, metrics_port, allowed, window.connections if window else None)
                    pages.connections.report = functools.partial(running.report, "connections")
                    serving.callback(pages.close)
                    _announce("the metrics are at", pages.url)
                reload = functools.partial(_reload, server, configuration, changed)
                every = every or settings.snapshot.every
                _loop(server, window, show, seconds, target, every, log_writer, reload, stopped)
        if target:
            _snapshot(running, target)
        if server.failure is not None:
            raise server.failure
        echo(f"{counts_line(running)}; journal {where}")


def _window(well: str, port: int, access: Access) -> Window:
    """Serve a new page and return its `Window`. If the port is in use, the command ends before a journal is opened."""
    from helibore.cli.live_view import Window

    window = Window(well, access, port=port)
    _announce("the wall is shown at", window.url)
    return window


def _say_sources(settings: Configuration, journal: Path) -> None:
    """Print where each source is from now on."""
    words = {"listen": "listens at", "host": "is pushed by the program:"}
    for name, source in settings.sources.items():
        echo(f"{name} {words.get(source.address.kind, 'is read from')} {settings.source[name]['address']}")
    echo(f"the journal is {journal}")


def _announce(text: str, url: str) -> None:
    """Print the address of a server, with its token on a terminal only, because a log must not show a secret."""
    address = url.partition("?")[0]
    echo(f"{text} {url if sys.stdout.isatty() else f'{address}?token=... ({WHERE})'}")


@contextmanager
def _screen(server: Server, quiet: bool) -> Iterator[Callable[[], None]]:
    """Show the status page on a terminal; yield a function that lets a thread draw the page again.

    If the terminal takes no text (after Ctrl-S, or if its connection is lost), only the drawing thread waits. Without
    a terminal, or if ``quiet``, the function does nothing.
    """
    from rich.live import Live as Screen

    from helibore.cli.live_status_page import Page

    page, console = Page(server), terminal_console()
    if quiet or not console.is_terminal:
        yield lambda: None
        return
    due, ended = threading.Event(), threading.Event()

    def draw() -> None:
        try:
            with Screen(page.draw(), console=console, screen=False, auto_refresh=False, transient=True) as screen:
                screen.refresh()
                while due.wait() and not ended.is_set():
                    due.clear()
                    screen.update(page.draw(), refresh=True)
        except OSError as error:
            server.live.report("terminal", f"{error}: the status is not shown any more")

    thread = server.thread("status", draw)
    thread.start()
    try:
        yield due.set
    finally:
        ended.set()
        due.set()
        thread.join(LAST_SECONDS)


@contextmanager
def _signals() -> Iterator[tuple[threading.Event, threading.Event]]:
    """Catch signals; yield what Ctrl-C and SIGTERM set, and what SIGHUP sets."""
    stopped, changed = threading.Event(), threading.Event()
    before = {number: signal.signal(number, lambda *_: stopped.set()) for number in (signal.SIGINT, signal.SIGTERM)}
    before[signal.SIGHUP] = signal.signal(signal.SIGHUP, lambda *_: changed.set())
    try:
        yield stopped, changed
    finally:
        for number, was in before.items():
            signal.signal(number, was)


def _loop(
    server: Server, window: Window | None, show: Callable[[], None], seconds: float | None, target: Path | None,
    every: float, log: LogWriter, reload: Callable[[], None], stopped: threading.Event,
) -> None:  # fmt: skip
    """Update the status page (``show``) and the browser's page (``window``) and write snapshots, until the run ends.

    The run ends when it is ``stopped``, after ``seconds``, or if a thread fails; without a browser's page, also after
    all files are read. ``reload`` reads the configuration again if it is due.
    """
    end = time.monotonic() + (seconds if seconds is not None else float("inf"))
    next_snapshot = time.monotonic() + every
    while not stopped.is_set() and time.monotonic() < end and not (server.wait(TICK) and window is None):
        if window and (thread := window.dead_thread()):
            server.fail(thread, RuntimeError("it ended"))
        if window and not _show(window, server):
            window = None
        if not log.alive:
            server.fail("log", RuntimeError("it ended"))
        if trouble := log.trouble():
            server.live.report("log", trouble)
        reload()
        show()
        if server.failure is not None:
            if window:
                _show(window, server)
            stopped.wait(LAST_SECONDS)
            return
        if target and time.monotonic() >= next_snapshot:
            _snapshot(server.live, target)
            next_snapshot = time.monotonic() + every
        stopped.wait(TICK if window else 0)


def _reload(server: Server, configuration: Path, changed: threading.Event) -> None:
    """Read the configuration again after SIGHUP; if it cannot be used, report the error and keep the old one."""
    from helibore.live.rules.configuration import load

    if not changed.is_set():
        return
    changed.clear()
    try:
        server.reconfigure(load(configuration))
    except (OSError, ValueError) as error:
        server.live.report("configuration", f"{error}: the changed configuration is not used")


def _show(window: Window, server: Server) -> bool:
    """Update the browser's page; if the wall cannot be shown, report the error, also on the page, and return False."""
    try:
        window.refresh(server.states, server.alarms.active, server.alarms.ahead.outlook)
    except (OSError, ValueError) as error:
        server.live.report("view", str(error))
        window.report(str(error))
        return False
    return True


def _snapshot(running: Live, target: Path) -> None:
    """Write a snapshot; if it cannot be written, report the error and go on."""
    try:
        from helibore.live.snapshot_files import snapshot

        snapshot(running, target)
    except (OSError, ValueError) as error:
        running.report("snapshot", str(error))

"""``helibore live rig.toml``: connect, store, draw, and show the status until Ctrl-C."""

from __future__ import annotations

import logging.handlers
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from helibore.cli.live_metrics import Access
    from helibore.cli.live_view import Window
    from helibore.live.live import Live
    from helibore.live.server import Server

TICK = 0.25
"""Seconds between two checks of the server."""
LOGGER = logging.getLogger("helibore.live")


@click.command(short_help="Build a wall from live sources while a hole is drilled.")
@click.argument("configuration", type=click.Path(path_type=Path, dir_okay=False))
@click.option(
    "--journal", type=click.Path(path_type=Path, file_okay=False), help="Folder of the journal.  [journal.folder]"
)
@click.option(
    "--snapshot",
    "folder",
    type=click.Path(path_type=Path, file_okay=False),
    help="Write wall, mesh and images here.  [snapshot.folder]",
)
@click.option("--every", type=float, help="Seconds between snapshots.  [snapshot.every]")
@click.option("--metrics-port", type=int, help="Serve Prometheus metrics on this port.")
@click.option("--view", "page", is_flag=True, help="Show the wall in a browser while it grows (extra 'view').")
@click.option("--view-port", type=click.IntRange(0, 65535), default=0, help="Port of --view.  [a free one]")
@click.option("--seconds", type=float, help="Stop after this time.  [until Ctrl-C, or all files are read]")
@click.option("--check", is_flag=True, help="Check the configuration and stop.")
@click.option("-q", "--quiet", is_flag=True, help="No status page.")
@click.option("--host", default="127.0.0.1", help="Address of page and metrics; other machines need --token.")
@click.option("--token", envvar="HELIBORE_TOKEN", help="Secret that page and metrics ask for.  [HELIBORE_TOKEN]")
@click.option("--certificate", type=click.Path(dir_okay=False), help="PEM file: serve page and metrics over HTTPS.")
@click.option("--key", type=click.Path(dir_okay=False), help="PEM file of its private key.  [the certificate's file]")
@click.option("--log", type=click.Path(dir_okay=False), help="Write all events to this file, too; rotated at 10 MB.")
def live(
    configuration: Path, journal: Path | None, folder: Path | None, every: float | None, metrics_port: int | None,
    page: bool, view_port: int, seconds: float | None, check: bool, quiet: bool, log: str | None, **access: str | None,
) -> None:  # fmt: skip
    """Grow a wall from the sources in CONFIGURATION; store every byte in a journal first.

    \b
    helibore live rig.toml --journal well-7.journal --snapshot now
    """
    from helibore.cli.live_metrics import Access, MetricsServer
    from helibore.live.configuration import load
    from helibore.live.live import Live
    from helibore.live.server import Server

    settings = load(configuration)
    if check:
        click.echo(f"{configuration}: fine: {', '.join(settings.sources)}")
        return
    where = journal or (Path(settings.journal.folder) if settings.journal.folder else None)
    if where is None:
        raise click.UsageError("no journal: give --journal FOLDER, or journal.folder in the configuration")
    target = folder or (Path(settings.snapshot.folder) if settings.snapshot.folder else None)
    allowed = Access(**access)  # type: ignore[arg-type]
    with ExitStack() as stack:
        stack.enter_context(_logged(log, quiet))
        window = stack.enter_context(_window(configuration.stem, view_port, allowed)) if page else None
        running = stack.enter_context(Live(settings, where))
        if window:
            window.follow(running)
        server = Server(running, window.show if window else lambda _: None)
        with ExitStack() as serving:
            show = serving.enter_context(_screen(server, quiet))  # loads its libraries while descriptors are left
            if window:
                serving.callback(window.close)
            server.start()
            serving.callback(server.stop)
            if metrics_port is not None:
                serving.callback(MetricsServer(server, metrics_port, allowed).close)
            _watch(server, window, show, seconds, target, every or settings.snapshot.every)
        if target:
            _snapshot(running, target)
        if server.failure is not None:
            raise server.failure
        counts = running.model.counts
        click.echo(f"{counts['drawn']:,} samples drawn, {counts['not drawn']:,} not, {len(running.wall):,} vertices; "
                   f"journal {where}")  # fmt: skip


def _window(well: str, port: int, access: Access) -> Window:
    """Serve the page before the journal is opened, so that the command ends here if the page cannot be served."""
    from helibore.cli.live_view import Window

    window = Window(well, port=port, **vars(access))
    shown = window.url if sys.stdout.isatty() else window.url.partition("?")[0]  # no secret in the log of a service
    click.echo(f"the wall is shown at {shown}")
    return window


@contextmanager
def _logged(file: str | None, quiet: bool) -> Iterator[None]:
    """Write warnings to stderr, unless the status page is there, and all events to ``file``."""
    log = logging.StreamHandler()
    log.setLevel(logging.CRITICAL if sys.stdout.isatty() and not quiet else logging.WARNING)
    handlers: list[logging.Handler] = [log]
    if file:
        handlers.append(logging.handlers.RotatingFileHandler(file, maxBytes=10 << 20, backupCount=5, encoding="utf-8"))
    before = LOGGER.level
    LOGGER.setLevel(logging.INFO)
    for handler in handlers:
        handler.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(message)s", "%Y-%m-%d %H:%M:%S%z"))
        LOGGER.addHandler(handler)
    try:
        yield
    finally:
        LOGGER.setLevel(before)
        for handler in handlers:
            LOGGER.removeHandler(handler)
            handler.close()


@contextmanager
def _screen(server: Server, quiet: bool) -> Iterator[Callable[[], None]]:
    """Show the status page on a terminal; return what draws it again."""
    from rich.console import Console
    from rich.live import Live as Screen

    from helibore.cli.live_status import Page

    page, console = Page(server), Console()
    if quiet or not console.is_terminal:
        yield lambda: None
        return
    with Screen(page.draw(), console=console, screen=False, auto_refresh=False, transient=True) as screen:
        yield lambda: screen.update(page.draw(), refresh=True)


def _watch(
    server: Server, window: Window | None, show: Callable[[], None], seconds: float | None, target: Path | None,
    every: float,
) -> None:  # fmt: skip
    """Show the page and write snapshots until the end; the browser's page stays open after all files are read."""
    stopped = threading.Event()
    before = {number: signal.signal(number, lambda *_: stopped.set()) for number in (signal.SIGINT, signal.SIGTERM)}
    end = time.monotonic() + (seconds if seconds is not None else float("inf"))
    next_snapshot = time.monotonic() + every
    try:
        while not stopped.is_set() and time.monotonic() < end and not (server.wait(TICK) and window is None):
            if window and (thread := window.dead_thread()):
                server.fail(thread, RuntimeError("it ended"))
            if window and not _show(window, server):
                window = None
            show()
            if server.failure is not None:
                return
            if target and time.monotonic() >= next_snapshot:
                _snapshot(server.live, target)
                next_snapshot = time.monotonic() + every
            stopped.wait(TICK if window else 0)
    finally:
        for number, was in before.items():
            signal.signal(number, was)


def _show(window: Window, server: Server) -> bool:
    """Update the page; if the wall cannot be shown, report the error, also on the page, and return False."""
    try:
        window.refresh(server.states, server.alarms.active)
    except (OSError, ValueError) as error:
        server.live.report("view", str(error))
        window.report(str(error))
        return False
    return True


def _snapshot(running: Live, target: Path) -> None:
    """Write a snapshot; if it cannot be written, report the error and go on."""
    try:
        from helibore.live.snapshot import snapshot

        snapshot(running, target)
    except (OSError, ValueError) as error:
        running.report("snapshot", str(error))

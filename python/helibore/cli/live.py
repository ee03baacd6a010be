"""``helibore live rig.toml``: connect, store, draw, and show the status until Ctrl-C."""

from __future__ import annotations

import http.server
import logging
import signal
import socket
import sys
import threading
import time
from contextlib import nullcontext, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from helibore.cli.live_view import Window
    from helibore.live.live import Live
    from helibore.live.server import Server

TICK = 0.25
"""Seconds between two checks of the server."""
METRICS_CONNECTIONS, METRICS_SECONDS = 8, 5.0


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
@click.option("--metrics-port", type=int, help="Serve Prometheus metrics on this port of loopback.")
@click.option("--view", "page", is_flag=True, help="Show the wall in a browser while it grows (extra 'view').")
@click.option("--view-port", type=click.IntRange(0, 65535), default=0, help="Port of --view.  [a free one]")
@click.option("--seconds", type=float, help="Stop after this time.  [until Ctrl-C, or all files are read]")
@click.option("--check", is_flag=True, help="Check the configuration and stop.")
@click.option("-q", "--quiet", is_flag=True, help="No status page.")
def live(
    configuration: Path, journal: Path | None, folder: Path | None, every: float | None, metrics_port: int | None,
    page: bool, view_port: int, seconds: float | None, check: bool, quiet: bool,
) -> None:  # fmt: skip
    """Grow a wall from the sources in CONFIGURATION; store every byte in a journal first.

    \b
    helibore live rig.toml --journal well-7.journal --snapshot now
    """
    from helibore.live.configuration import load
    from helibore.live.live import Live

    settings = load(configuration)
    if check:
        click.echo(f"{configuration}: fine: {', '.join(settings.sources)}")
        return
    where = journal or (Path(settings.journal.folder) if settings.journal.folder else None)
    if where is None:
        raise click.UsageError("no journal: give --journal FOLDER, or journal.folder in the configuration")
    target = folder or (Path(settings.snapshot.folder) if settings.snapshot.folder else None)
    with _window(configuration.stem, view_port) if page else nullcontext() as window, Live(settings, where) as running:
        _run(running, window, metrics_port, seconds, target, every or settings.snapshot.every, quiet)
        counts = running.model.counts
        click.echo(f"{counts['drawn']:,} samples drawn, {counts['not drawn']:,} not, {len(running.wall):,} vertices; "
                   f"journal {where}")  # fmt: skip


def _window(well: str, port: int) -> Window:
    """Serve the page before the journal is opened, so that the command ends here if the page cannot be served."""
    from helibore.cli.live_view import Window

    window = Window(well, port=port)
    click.echo(f"the wall is shown at {window.url}")
    return window


def _run(
    running: Live, window: Window | None, metrics_port: int | None, seconds: float | None, target: Path | None,
    every: float, quiet: bool,
) -> None:  # fmt: skip
    """Serve the sources until the end, then write the last snapshot."""
    from helibore.live.server import Server

    log = logging.StreamHandler()  # to stderr: without a terminal, every warning
    log.setFormatter(logging.Formatter("%(levelname)s %(message)s"))
    log.setLevel(logging.CRITICAL if sys.stdout.isatty() and not quiet else logging.WARNING)
    logging.getLogger("helibore.live").addHandler(log)
    if window:
        window.follow(running)
    server = Server(running, window.show if window else lambda _: None)
    server.start()
    try:
        pages = _serve_metrics(server, metrics_port) if metrics_port is not None else None
        try:
            _watch(server, window, seconds, target, every, quiet)
        finally:
            if pages:
                pages.shutdown()
                pages.server_close()
    finally:
        server.stop()
        if window:
            window.close()
        logging.getLogger("helibore.live").removeHandler(log)
    if target:
        _snapshot(running, target)
    if server.failure is not None:
        raise server.failure


def _watch(
    server: Server, window: Window | None, seconds: float | None, target: Path | None, every: float, quiet: bool
) -> None:
    """Show the page and write snapshots until the end; the browser's page stays open after all files are read."""
    from rich.console import Console
    from rich.live import Live as Screen

    from helibore.cli.live_status import Page

    stopped = threading.Event()
    before = {number: signal.signal(number, lambda *_: stopped.set()) for number in (signal.SIGINT, signal.SIGTERM)}
    page, console = Page(server), Console()
    end = time.monotonic() + (seconds if seconds is not None else float("inf"))
    next_snapshot = time.monotonic() + every
    try:
        with Screen(console=console, screen=False, auto_refresh=False, transient=True) as screen:
            while not stopped.is_set() and time.monotonic() < end and not (server.wait(TICK) and window is None):
                if server.failure is not None:
                    return
                if window and not _show(window, server):
                    window = None
                if not quiet and console.is_terminal:
                    screen.update(page.draw(), refresh=True)
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
        window.refresh(server.states)
    except (OSError, ValueError) as error:
        server.live.report("view", str(error))
        window.report(str(error))
        return False
    return True


def _snapshot(running: Live, target: Path) -> None:
    """Write a snapshot; if it cannot be written, report the error and go on."""
    from helibore.live.snapshot import snapshot

    try:
        snapshot(running, target)
    except (OSError, ValueError) as error:
        running.report("snapshot", str(error))


class _Metrics(http.server.ThreadingHTTPServer):
    """Serves /metrics on loopback to a few connections at a time, each for a few seconds at most."""

    daemon_threads = True

    def __init__(self, server: Server, port: int) -> None:
        from helibore.cli.live_status import metrics

        class Pages(http.server.BaseHTTPRequestHandler):
            timeout = METRICS_SECONDS

            def do_GET(self) -> None:
                found = self.path == "/metrics"
                body = metrics(server).encode() if found else b"only /metrics is here\n"
                self.send_response(200 if found else 404)
                self.send_header("Content-Type", "text/plain; version=0.0.4")
                self.send_header("Content-Length", str(len(body)))
                self.end_headers()
                self.wfile.write(body)

            def log_message(self, *_: object) -> None:
                """Print nothing."""

        super().__init__(("127.0.0.1", port), Pages)
        self._free = threading.BoundedSemaphore(METRICS_CONNECTIONS)

    def process_request(self, request: Any, client_address: Any) -> None:
        if self._free.acquire(blocking=False):
            super().process_request(request, client_address)
        else:
            self.shutdown_request(request)

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        late = threading.Timer(METRICS_SECONDS, self._hang_up, (request,))
        late.daemon = True
        try:
            late.start()
            super().process_request_thread(request, client_address)
        finally:
            late.cancel()
            self._free.release()

    @staticmethod
    def _hang_up(request: Any) -> None:
        with suppress(OSError):
            request.shutdown(socket.SHUT_RDWR)

    def handle_error(self, *_: object) -> None:
        """Ignore errors of a request: a client may leave or be slow."""


def _serve_metrics(server: Server, port: int) -> _Metrics:
    pages = _Metrics(server, port)
    server.thread("metrics", pages.serve_forever).start()
    return pages

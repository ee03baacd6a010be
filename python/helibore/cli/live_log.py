"""The log of ``helibore live``: a thread writes warnings to stderr and, with --log, all events to a file.

event -> LogWriter.emit -> queue -> thread -> stderr, file        a blocked terminal or a slow disk delays no packet
"""

from __future__ import annotations

import logging.handlers
import queue
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from helibore.base.harmless import printable
from helibore.live.model.events import LOGGER

MOST_WAITING = 1000
"""Most log lines that wait for a slow stderr or file; further lines are left out and counted."""
SECONDS = 2.0
"""Most seconds that `LogWriter.stop` waits for the queued lines to be written."""
STOP = logging.LogRecord("", 0, "", 0, "", None, None)


class LogWriter(logging.Handler):
    """Queues log records; a separate thread passes the records to ``handlers``."""

    def __init__(self, handlers: list[logging.Handler]) -> None:
        super().__init__()
        self._handlers = handlers
        self._waiting: queue.Queue[logging.LogRecord] = queue.Queue(MOST_WAITING)
        self._lost, self._reason = 0, ""
        for handler in handlers:
            handler.handleError = self._note_error  # type: ignore[method-assign]
        self._thread = threading.Thread(target=self._write, name="log", daemon=True)
        self._thread.start()

    def emit(self, record: logging.LogRecord) -> None:
        """Queue a record; this never waits."""
        try:
            self._waiting.put_nowait(record)
        except queue.Full:
            self._lost, self._reason = self._lost + 1, "stderr or the log file is blocked or too slow"

    def trouble(self) -> str:
        """Return how many lines were lost since the last call, and why the last line was lost; "" if none was lost."""
        lost, self._lost = self._lost, 0
        return f"{lost} lines were not written: {self._reason}" if lost else ""

    @property
    def alive(self) -> bool:
        """Whether the thread that writes the lines is running."""
        return self._thread.is_alive()

    def stop(self) -> None:
        """Wait until the queued lines are written, `SECONDS` at most; then the thread ends.

        This method is not named ``close``, because uvicorn calls ``close`` of all handlers while the log is in use.
        """
        with suppress(queue.Full):
            self._waiting.put_nowait(STOP)
        self._thread.join(SECONDS)

    def _write(self) -> None:
        while (record := self._waiting.get()) is not STOP:
            for handler in self._handlers:
                if record.levelno >= handler.level:
                    handler.handle(record)

    def _note_error(self, record: logging.LogRecord) -> None:  # noqa: ARG002 (as `logging.Handler.handleError`)
        self._lost, self._reason = self._lost + 1, str(sys.exc_info()[1])


class PrintableLines(logging.Formatter):
    """Writes a message in one line without characters that a terminal obeys; only a traceback has more lines."""

    def formatMessage(self, record: logging.LogRecord) -> str:  # noqa: N802 (a method of `logging.Formatter`)
        return printable(super().formatMessage(record)).replace("\n", "\\n")


@contextmanager
def logged(file: str | None, quiet: bool) -> Iterator[LogWriter]:
    """Write warnings to stderr, unless the terminal shows the status page, and all events to ``file``, if given."""
    shown = logging.StreamHandler()
    shown.setLevel(logging.CRITICAL if sys.stdout.isatty() and not quiet else logging.WARNING)
    handlers: list[logging.Handler] = [shown]
    if file:
        handlers.append(logging.handlers.RotatingFileHandler(file, maxBytes=10 << 20, backupCount=5, encoding="utf-8"))
    for handler in handlers:
        handler.setFormatter(PrintableLines("%(asctime)s %(levelname)s %(message)s", "%Y-%m-%d %H:%M:%S%z"))
    before, writer = LOGGER.level, LogWriter(handlers)
    LOGGER.setLevel(logging.INFO)
    LOGGER.addHandler(writer)
    try:
        yield writer
    finally:
        LOGGER.setLevel(before)
        LOGGER.removeHandler(writer)
        writer.stop()
        if not writer.alive:
            for handler in handlers:
                handler.close()

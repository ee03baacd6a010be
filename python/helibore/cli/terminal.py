"""Print for a terminal; show the stages of a verb and their times, a moving bar during each, and a summary.

All that commands print passes here, so that no name, unit or value of a file can move the cursor, change the colours or
the title of a terminal, or hide a part of the text: see `helibore.base.harmless`. The bar appears on stderr if stderr
is a terminal and --quiet is not given. rich is imported when something is shown.
"""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import click

from helibore.base.harmless import printable

if TYPE_CHECKING:
    from rich.console import Console


def echo(text: str, *, err: bool = False, nl: bool = True, over: bool = False) -> None:
    """Print a text; ``over`` replaces the line that the cursor is in."""
    click.echo(("\r\x1b[K" if over else "") + printable(text), err=err, nl=nl)


def console(**options: Any) -> Console:
    """Return a console of rich that shows escapes of all texts, but not of its own colours and bars."""
    from rich.console import Console
    from rich.segment import Segment

    class Printable(Console):
        def render_str(self, text: str, **how: Any) -> Any:  # measures what is shown
            return super().render_str(printable(text), **how)

        def render(self, renderable: Any, options: Any = None) -> Iterator[Segment]:
            for part in super().render(renderable, options):
                yield part if part.control else Segment(printable(part.text), part.style)

    return Printable(**options)


@contextmanager
def _dots() -> Iterator[None]:
    """Show every few seconds that something still runs."""
    over = threading.Event()

    def show() -> None:
        while not over.wait(3.0):
            echo("...", err=True)

    thread = threading.Thread(target=show, daemon=True)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()


class Terminal:
    """Shows progress and summaries, or nothing if ``quiet``; remembers how long each stage took.

    If stderr is no terminal, ``lines`` shows what each stage does as a line there; otherwise such a run shows no stage.
    """

    def __init__(self, quiet: bool, lines: bool = False) -> None:
        self.quiet, self.lines = quiet, lines
        self.seconds: dict[str, float] = {}

    @contextmanager
    def stage(self, name: str, doing: str) -> Iterator[None]:
        """Time a stage; while the stage lasts, show the text ``doing``."""
        start = time.perf_counter()
        with self._bar(doing):
            yield
        self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - start

    @contextmanager
    def _bar(self, doing: str) -> Iterator[None]:
        if self.quiet or not sys.stderr.isatty():
            if self.lines and not self.quiet:
                echo(doing, err=True)
                with _dots():
                    yield
            else:
                yield
            return
        from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

        columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
        with Progress(*columns, console=console(stderr=True), transient=True) as progress:
            progress.add_task(doing, total=None)
            yield

    def times(self) -> str:
        """Return the stages and their times in one line."""
        parts = [f"{name} {seconds:.2f} s" for name, seconds in self.seconds.items()]
        return f"{', '.join(parts)}; {sum(self.seconds.values()):.2f} s in all"

    def summary(self, lines: list[tuple[str, str]]) -> None:
        """Print labels and texts in two columns; a line with an empty label belongs to the label above it."""
        if self.quiet:
            return
        from rich.table import Table
        from rich.text import Text

        table = Table.grid(padding=(0, 2))
        table.add_column(style="bold cyan", no_wrap=True)
        table.add_column(overflow="fold")
        for label, text in lines:
            table.add_row(label, Text(printable(text)))
        shown = console(highlight=False)
        if not shown.is_terminal:
            shown = console(highlight=False, width=110)
        shown.print(table)

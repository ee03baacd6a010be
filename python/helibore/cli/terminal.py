"""Show the stages of a verb and their times, a moving bar during each stage, and a summary in two columns.

The bar appears on stderr if stderr is a terminal and --quiet is not given. rich is imported when something is shown.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager


class Terminal:
    """Shows progress and summaries, or nothing if ``quiet``; remembers how long each stage took."""

    def __init__(self, quiet: bool) -> None:
        self.quiet = quiet
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
            yield
            return
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

        columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
        with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
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
        from rich.console import Console
        from rich.table import Table
        from rich.text import Text

        table = Table.grid(padding=(0, 2))
        table.add_column(style="bold cyan", no_wrap=True)
        table.add_column(overflow="fold")
        for label, text in lines:
            table.add_row(label, Text(text))
        console = Console(highlight=False)
        if not console.is_terminal:
            console = Console(highlight=False, width=110)
        console.print(table)

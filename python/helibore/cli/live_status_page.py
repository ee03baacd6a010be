"""The status of a running server, as a page for the terminal (rich). The page does not change the server."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from helibore.cli.prometheus_metrics import bytes_left, source_ages
from helibore.live.alarms import local
from helibore.live.wire.wits import RULE_NAMES

if TYPE_CHECKING:
    from rich.console import RenderableType

    from helibore.live.server import Server


def _local_time(wall: int) -> str:
    """Return a time (ns since 1970) as "HH:MM:SS here, " in the time zone of this machine; "" if that zone is UTC."""
    time = local(wall)
    return f"{time:%H:%M:%S} here, " if time.utcoffset() else ""


class Page:
    """The status page. Its rates are averages over the time since the page was last drawn."""

    def __init__(self, server: Server) -> None:
        self._server = server
        self._before: dict[str, tuple[float, float]] = {}

    def _rate(self, name: str, value: float) -> float:
        now = time.monotonic()
        before, at = self._before.get(name, (value, now))
        self._before[name] = (value, now)
        return (value - before) / (now - at) if now > at else 0.0

    def draw(self) -> RenderableType:
        from rich.console import Group
        from rich.panel import Panel
        from rich.text import Text

        latest = self._server.live.model.events.latest[-8:]
        events = [
            Text(f"{_local_time(event.newest.wall)}{event}", overflow="ellipsis", no_wrap=True) for event in latest
        ]
        alarms = [Text(str(alarm), style="bold red") for alarm in self._server.alarms.active]
        return Group(
            *([Panel(Group(*alarms), title="ALARMS", title_align="left", style="red")] if alarms else []),
            Panel(self._sources(), title="sources", title_align="left"),
            Panel(self._wall(), title="wall", title_align="left"),
            Panel(Group(*events) if events else Text("none"), title="latest events", title_align="left"),
        )

    def _sources(self) -> RenderableType:
        from rich.table import Table

        table = Table("source", "state", "bytes/s", "frames", "age", "missing", "bad", expand=True, box=None)
        ages = source_ages(self._server)
        for reader in self._server.live.model.readers.values():
            name, age = reader.source.name, ages[reader.source.name]
            total = reader.total("bytes")
            table.add_row(
                name, self._server.states[name], f"{self._rate(name, total):,.0f}", f"{reader.total('frames'):,}",
                "-" if age is None else f"{age:.1f} s", f"{sum(w.lost for w in reader.watches.values()):,}",
                f"{sum(reader.total(rule) for rule in RULE_NAMES):,}",
            )  # fmt: skip
        return table

    def _wall(self) -> RenderableType:
        from rich.table import Table

        server, model = self._server, self._server.live.model
        table = Table.grid(padding=(0, 2))
        table.add_column(style="bold")
        bit, hole = (model.rig.tracks[name].value[-1:].tolist() for name in ("bit_depth", "hole_depth"))
        table.add_row("bit", f"{bit[0]:,.2f} m" if bit else "-", "hole", f"{hole[0]:,.2f} m" if hole else "-")
        channels = [f"{one.name} {one.value:g} {one.unit}".strip() for one in model.channels.by_name.values()]
        if channels:
            table.add_row("rig", ", ".join(channels))
        for name, wall in server.live.layers.items():
            table.add_row(name, f"{len(wall):,} vertices", "samples", f"{wall.sample_count:,}")
        for run in list(model.passes.latest.values()):  # a copy, because other threads change the dict
            called = "" if run.number is None else f", number {run.number}"
            table.add_row("pass", f"{run.name}{called}", run.source or "host", f"{run.samples:,} samples")
        drawn = model.counts["drawn"]
        table.add_row(
            "drawn", f"{drawn:,} ({self._rate('drawn', drawn):,.0f}/s)", "refused", f"{model.counts['not drawn']:,}"
        )
        table.add_row("in no layer", f"{model.counts['kept apart']:,}", "waiting for depth", f"{model.waiting:,}")
        latency = server.latency
        table.add_row(
            "latency", f"{1e3 * latency.quantile(0.5):.1f} ms", "p99", f"{1e3 * latency.quantile(0.99):.1f} ms"
        )
        if server.live.journal:
            left = bytes_left(server.live.journal) / 1e9
            table.add_row("journal", str(server.live.journal.folder), "left", f"{left:,.1f} GB")
        return table

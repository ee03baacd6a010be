"""What a running server shows: a page for people (rich) and a text for Prometheus. Both only read.

Every number here is counted where the thing happens; nothing is guessed from another number.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from helibore.live.events import Flag
from helibore.live.pass_rules import PASSES
from helibore.live.wits import RULE_NAMES

if TYPE_CHECKING:
    from rich.console import RenderableType

    from helibore.live.server import Server

PARSED = ("bytes", "frames", "items", "nulls", "not_numbers", *RULE_NAMES)


def metrics(server: Server) -> str:
    """Return every counter in the Prometheus text format."""
    live, model = server.live, server.live.model
    lines: list[str] = []

    def family(name: str, kind: str, text: str, rows: list[tuple[str, float]]) -> None:
        lines.extend([f"# HELP helibore_{name} {text}", f"# TYPE helibore_{name} {kind}"])
        lines.extend(f"helibore_{name}{label} {value:.17g}" for label, value in rows)

    readers = {reader.source.name: reader for reader in model.readers.values()}
    for count in PARSED:
        rows = [(_label(source=name), float(reader.total(count))) for name, reader in readers.items()]
        family(f"wits_{count}_total", "counter", f"WITS {count.replace('_', ' ')} read.", rows)
    lost = [(_label(source=name), float(sum(w.lost for w in r.watches.values()))) for name, r in readers.items()]
    family("sequence_numbers_missing", "gauge", "Sequence numbers that were skipped and have not come.", lost)
    ages = [(_label(source=name), age) for name, age in source_ages(server).items() if age is not None]
    family("source_age_seconds", "gauge", "Time since the last byte.", ages)
    family(
        "samples_received_total",
        "counter",
        "Samples that have a depth or never will.",
        [("", model.counts["received"])],
    )
    family("samples_drawn_total", "counter", "Samples drawn in a layer.", [("", model.counts["drawn"])])
    family("samples_waiting", "gauge", "Samples whose depth is not known yet.", [("", model.waiting)])
    flags = [(_label(flag=str(flag.name).lower()), float(model.counts[f"flag {flag.name}"])) for flag in Flag]
    family("samples_flagged_total", "counter", "Samples with a flag.", flags)
    passes = [(_label(**{"pass": name}), float(model.counts[f"pass {name}"])) for name in PASSES]
    family("samples_of_pass_total", "counter", "Samples by the pass they belong to.", passes)
    told = sorted((_label(source=event.source, rule=event.rule), event) for event in model.events.latest)
    family("events_total", "counter", "Events by source and rule.", [(label, event.count) for label, event in told])
    first = [(label, event.wall / 1e9) for label, event in told]
    family("event_first_timestamp_seconds", "gauge", "When an event of this source and rule was first.", first)
    last = [(label, event.newest.wall / 1e9) for label, event in told]
    family("event_last_timestamp_seconds", "gauge", "When an event of this source and rule was last.", last)
    vertices = [(_label(layer=name), float(len(wall))) for name, wall in live.layers.items()]
    family("wall_vertices", "gauge", "Vertices of each layer.", vertices)
    if live.journal:
        family("journal_bytes_left", "gauge", "Bytes left on the journal's disk.", [("", live.journal.bytes_left)])
    family("queue_records", "gauge", "Records stored and not yet drawn.", [("", server.queued)])
    _histogram(server, lines)
    return "\n".join(lines) + "\n"


def _histogram(server: Server, lines: list[str]) -> None:
    latency = server.latency
    name = "helibore_latency_seconds"
    lines.extend([f"# HELP {name} From a packet's arrival to its changed vertices.", f"# TYPE {name} histogram"])
    total = 0
    for bound, count in zip([*latency.BOUNDS, float("inf")], latency.counts, strict=True):
        total += count
        lines.append(f'{name}_bucket{{le="{"+Inf" if bound == float("inf") else f"{bound:g}"}"}} {total}')
    lines.extend([f"{name}_sum {latency.sum:.9g}", f"{name}_count {total}"])


def _label(**labels: str) -> str:
    quoted = str.maketrans({"\\": "\\\\", '"': '\\"', "\n": " "})
    escaped = (f'{key}="{value.translate(quoted)}"' for key, value in labels.items())
    return "{" + ",".join(escaped) + "}"


def source_ages(server: Server) -> dict[str, float | None]:
    """Return the seconds since the last byte of each source; None before the first."""
    now = time.monotonic()
    return {name: None if (heard := server.heard.get(name)) is None else now - heard for name in server.states}


class Page:
    """The status page; rates are since it was last drawn."""

    def __init__(self, server: Server) -> None:
        self._server = server
        self._before: dict[str, tuple[float, float]] = {}

    def _rate(self, name: str, value: float) -> float:
        now = time.monotonic()
        before, at = self._before.get(name, (value, now))
        self._before[name] = (value, now)
        return (value - before) / (now - at) if now > at else 0.0

    def draw(self) -> RenderableType:
        """Return the page."""
        from rich.console import Group
        from rich.panel import Panel
        from rich.text import Text

        events = [
            Text(str(event), overflow="ellipsis", no_wrap=True) for event in self._server.live.model.events.latest[-8:]
        ]
        return Group(
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
        for name, wall in server.live.layers.items():
            table.add_row(name, f"{len(wall):,} vertices", "samples", f"{wall.sample_count:,}")
        for run in list(model.passes.latest.values()):  # it grows meanwhile
            called = "" if run.number is None else f", number {run.number}"
            table.add_row("pass", f"{run.name}{called}", run.source or "host", f"{run.samples:,} samples")
        drawn = model.counts["drawn"]
        table.add_row(
            "drawn", f"{drawn:,} ({self._rate('drawn', drawn):,.0f}/s)", "not drawn", f"{model.counts['not drawn']:,}"
        )
        table.add_row("kept apart", f"{model.counts['kept apart']:,}", "waiting for depth", f"{model.waiting:,}")
        latency = server.latency
        table.add_row(
            "latency", f"{1e3 * latency.quantile(0.5):.1f} ms", "p99", f"{1e3 * latency.quantile(0.99):.1f} ms"
        )
        if server.live.journal:
            table.add_row(
                "journal", str(server.live.journal.folder), "left", f"{server.live.journal.bytes_left / 1e9:,.1f} GB"
            )
        return table

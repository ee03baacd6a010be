"""The status of a running server: a page for the terminal (rich), and metrics for Prometheus.

The page and the metrics do not change the server.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterable
from typing import TYPE_CHECKING

from helibore.live.alarms import local
from helibore.live.model.events import Flag
from helibore.live.rules.pass_rules import PASSES
from helibore.live.wire.wits import RULE_NAMES

if TYPE_CHECKING:
    from rich.console import RenderableType

    from helibore.live.journal.journal import Journal
    from helibore.live.server import Server

PARSED = ("bytes", "frames", "items", "nulls", "not_numbers", *RULE_NAMES)


def metrics(server: Server) -> str:
    """Return the metrics of a server in the text format of Prometheus."""
    from prometheus_client import CollectorRegistry
    from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, HistogramMetricFamily, Metric
    from prometheus_client.exposition import generate_latest
    from prometheus_client.registry import Collector

    live, model = server.live, server.live.model
    families: list[Metric] = []
    kinds = {"counter": CounterMetricFamily, "gauge": GaugeMetricFamily}

    def family(name: str, kind: str, text: str, rows: Iterable[tuple[tuple[str, ...], float]], *labels: str) -> None:
        made = kinds[kind](f"helibore_{name}", text, labels=labels)
        for values, number in rows:
            made.add_metric(values, number)
        families.append(made)

    readers = {reader.source.name: reader for reader in model.readers.values()}
    for count in PARSED:
        rows = [((name,), float(reader.total(count))) for name, reader in readers.items()]
        family(f"wits_{count}", "counter", f"WITS {count.replace('_', ' ')} read.", rows, "source")
    lost = [((name,), float(sum(w.lost for w in r.watches.values()))) for name, r in readers.items()]
    family("sequence_numbers_missing", "gauge", "Sequence numbers that were skipped and have not come.", lost, "source")
    ages = [((name,), age) for name, age in source_ages(server).items() if age is not None]
    family("source_age_seconds", "gauge", "Time since the last byte.", ages, "source")
    now = server.live.clock()[1]
    sampled = [((name,), (now - last) / 1e9) for name, last in sorted(server.alarms.sampled.items())]
    family("sample_age_seconds", "gauge", "Time since the last caliper sample.", sampled, "source")
    counts, text = model.counts, "Samples whose depth is known, or will never be known."
    family("samples_received", "counter", text, [((), counts["received"])])
    family("samples_drawn", "counter", "Samples drawn in a layer.", [((), counts["drawn"])])
    family("samples_refused", "counter", "Samples that a flag keeps out of all layers.", [((), counts["not drawn"])])
    family("samples_in_no_layer", "counter", "Good samples that no layer takes.", [((), counts["kept apart"])])
    family("samples_waiting", "gauge", "Samples and image rows whose depth is not known yet.", [((), model.waiting)])
    flags = [((str(flag.name).lower(),), float(counts[f"flag {flag.name}"])) for flag in Flag]
    family("samples_flagged", "counter", "Samples with a flag.", flags, "flag")
    passes = [((name,), float(counts[f"pass {name}"])) for name in PASSES]
    family("samples_of_pass", "counter", "Samples by the kind of pass to which they belong.", passes, "pass")
    events = sorted(((event.source, event.rule), event) for event in model.events.latest)
    place = ("source", "rule")
    family("events", "counter", "Events by source and rule.", [(key, event.count) for key, event in events], *place)
    first = [(key, event.wall / 1e9) for key, event in events]
    family("event_first_timestamp_seconds", "gauge", "First event of this source and rule.", first, *place)
    last = [(key, event.newest.wall / 1e9) for key, event in events]
    family("event_last_timestamp_seconds", "gauge", "Last event of this source and rule.", last, *place)
    active = {(alarm.rule, alarm.source) for alarm in server.alarms.active}
    alarms = sorted(server.alarms.counts.items())
    begun = [(key, float(count)) for key, count in alarms]
    family("alarms", "counter", "Alarms that have begun.", begun, "alarm", "source")
    lasts = [(key, float(key in active)) for key, _ in alarms]
    family("alarm_active", "gauge", "1 while an alarm lasts.", lasts, "alarm", "source")
    text = "Alarms that the command or the webhook did not take."
    family("alarms_undelivered", "counter", text, [((), float(server.alarms.undelivered))])
    vertices = [((name,), float(len(wall))) for name, wall in live.layers.items()]
    family("wall_vertices", "gauge", "Vertices of each layer.", vertices, "layer")
    if live.journal:
        family("journal_bytes_left", "gauge", "Bytes left on the journal's disk.", [((), bytes_left(live.journal))])
    family("queue_records", "gauge", "Records stored and not yet drawn.", [((), server.queued)])
    latency, bounds = server.latency, [f"{bound:g}" for bound in server.latency.BOUNDS] + ["+Inf"]
    buckets = list(zip(bounds, itertools.accumulate(latency.counts), strict=True))
    text = "Time from the arrival of a packet to the change of its vertices."
    families.append(HistogramMetricFamily("helibore_latency_seconds", text, buckets=buckets, sum_value=latency.sum))

    class Families(Collector):
        def collect(self) -> list[Metric]:
            return families

    registry = CollectorRegistry()
    registry.register(Families())
    return generate_latest(registry).decode()


def source_ages(server: Server) -> dict[str, float | None]:
    """Return the seconds since the last byte of each source; None before its first byte."""
    now = time.monotonic()
    last = server.last_received
    return {name: now - last[name] if name in last else None for name in server.states}


def bytes_left(journal: Journal) -> float:
    """Return the free bytes of the disk that holds a journal; NaN if the folder of the journal cannot be read."""
    try:
        return float(journal.bytes_left)
    except OSError:
        return float("nan")


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

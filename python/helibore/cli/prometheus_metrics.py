"""The metrics of a running server for Prometheus: every counter, gauge and histogram. They do not change the server."""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterable
from typing import TYPE_CHECKING

from helibore.live.model.events import Flag
from helibore.live.rules.pass_rules import PASSES
from helibore.live.wire.wits import RULE_NAMES

if TYPE_CHECKING:
    from helibore.base.connections import Connections
    from helibore.live.journal.journal import Journal
    from helibore.live.server import Server

PARSED = ("bytes", "frames", "items", "nulls", "not_numbers", *RULE_NAMES)


def metrics(server: Server, connections: Iterable[Connections] = ()) -> str:
    """Return the metrics of a server, and of the connections to page and metrics, in the text format of Prometheus."""
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
    shown = [((one.source, one.name), one.value) for one in list(model.channels.by_name.values())]
    family("channel", "gauge", "Latest value of a channel of the rig.", shown, "source", "channel")
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
    refused = [((one.name,), float(one.refused)) for one in connections]
    family("connections_refused", "counter", "Connections without the token, or too many.", refused, "server")
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

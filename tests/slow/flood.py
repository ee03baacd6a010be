"""Thousands of connections without the token, on page and metrics: ``python tests/slow/flood.py [--seconds 15]``.

    rig --2,000 triples/s--> helibore live --view --metrics-port   (256 descriptors)  <--idle, half-sent-- strangers
    a second source that falls silent every few seconds --> alarms --> command

Phases without and with strangers take turns. Strangers hold 1,000 idle connections and 1,000 half-sent requests on page
and metrics together, and come again when they are ended. For each phase: the time from a packet to its vertices, and
how long page and metrics take to answer who has the token. At the end: triples lost, alarms that began or ended and
lines that the command got (the bar: all), and the ratio of the p99 with and without (the bar: 2). The strangers use the
same processors, so the ratio is for a machine that is not full.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import multiprocessing
import os
import re
import resource
import selectors
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests" / "python")]

from live_servers import free_port, until  # noqa: E402

from bench.live.load import CONFIGURATION, send  # noqa: E402
from helibore.live.wire import wits  # noqa: E402

DESCRIPTORS = 256
EACH = 500
"""Idle connections, and half-sent requests, on each of page and metrics."""
TOKEN = "s3cret"
SECOND_SOURCE = """
[source.other]
address = "listen://127.0.0.1:{port}"
units = "metric"
silence = 1.0
[alarms]
command = ["sh", "-c", "cat >> alarms.txt"]
"""
COMMAND = """
import atexit, json, sys, time
from helibore.cli import cli
from helibore.live.server import Latency
taken, add = [], Latency.add
Latency.add = lambda self, seconds: (taken.append((time.time(), seconds)), add(self, seconds))
atexit.register(lambda: open("taken.json", "w").write(json.dumps(taken)))
cli(sys.argv[1:])
"""


def strangers(ports: tuple[int, int], rate: float, stop: Any, counts: Any) -> None:
    """Hold idle and half-sent connections; open those again that are ended, at most ``rate`` a second."""
    resource.setrlimit(resource.RLIMIT_NOFILE, (5 * EACH, max(5 * EACH, resource.getrlimit(resource.RLIMIT_NOFILE)[1])))
    selector, waiting = selectors.EpollSelector(), [(port, half) for port in ports for half in (0, 1)] * EACH
    opened, began = 0, time.monotonic()
    while not stop.is_set():
        while waiting and opened < 4 * EACH + rate * (time.monotonic() - began):
            port, half = waiting.pop()
            opened += 1
            link = socket.socket()
            link.setblocking(False)
            link.connect_ex(("127.0.0.1", port))
            selector.register(link, selectors.EVENT_READ | (selectors.EVENT_WRITE if half else 0), (port, half))
        for key, events in selector.select(0.02):
            link, (port, half) = key.fileobj, key.data
            try:
                if events & selectors.EVENT_WRITE:
                    link.send(b"GET /metrics?token=wrong HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Half: " + b"x" * 100)
                    selector.modify(link, selectors.EVENT_READ, key.data)
                ended = bool(events & selectors.EVENT_READ) and link.recv(4096) == b""
            except OSError:
                ended = True
            if ended:
                selector.unregister(link)
                link.close()
                waiting.append((port, half))
    counts.put(opened)


def silences(port: int, stop: threading.Event) -> None:
    """Send a frame every three seconds: the source is silent for more than a second between them."""
    with socket.create_connection(("127.0.0.1", port)) as link:
        while not stop.wait(3.0):
            link.sendall(wits.frame([(121, "1")]))


def answered(url: str) -> float:
    """Return the seconds that a request with the token takes; infinity if it is not answered."""
    began = time.monotonic()
    try:
        with urllib.request.urlopen(url, timeout=10) as answer:
            answer.read()
    except OSError:
        return float("inf")
    return time.monotonic() - began


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--seconds", type=float, default=15.0, help="of a phase")
    options.add_argument("--phases", type=int, default=6)
    options.add_argument("--rate", type=float, default=50.0, help="connections opened again in a second")
    chosen = options.parse_args()
    context = multiprocessing.get_context("spawn")
    rig, other, page, metrics = (free_port() for _ in range(4))
    urls = {"page": f"http://127.0.0.1:{page}/healthz?token={TOKEN}"}
    urls["metrics"] = f"http://127.0.0.1:{metrics}/metrics?token={TOKEN}"
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "rig.toml").write_text(CONFIGURATION.format(port=rig) + SECOND_SOURCE.format(port=other))
        arguments = ["live", "rig.toml", "--journal", "j", "-q", "--view", "--view-port", str(page), "--metrics-port",
                     str(metrics), "--log", "events.log"]  # fmt: skip
        process = subprocess.Popen(
            [sys.executable, "-c", COMMAND, *arguments], cwd=folder, env={**os.environ, "HELIBORE_TOKEN": TOKEN},
            stdout=subprocess.DEVNULL, stderr=(folder / "stderr").open("w"),
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (DESCRIPTORS, DESCRIPTORS)),
        )  # fmt: skip
        stop = threading.Event()
        try:
            until(lambda: process.poll() is not None or _is_open(metrics), 60)
            assert process.poll() is None, (folder / "stderr").read_text()
            threading.Thread(target=silences, args=(other, stop), daemon=True).start()
            counts: Any = context.Queue()
            total = chosen.seconds * chosen.phases + 10
            rigging = context.Process(target=send, args=(rig, total, 2000, 4000, counts), daemon=True)
            rigging.start()
            time.sleep(5)
            phases = [phase(context, (page, metrics), urls, chosen, bool(n % 2)) for n in range(chosen.phases)]
            rigging.join()
            sent = counts.get()
            text = urllib.request.urlopen(urls["metrics"], timeout=60).read().decode()
            descriptors = len(list(Path(f"/proc/{process.pid}/fd").iterdir()))
        finally:
            stop.set()
            process.send_signal(signal.SIGTERM)
            code = process.wait(60)
        taken = np.array(json.loads((folder / "taken.json").read_text()))
        lines = [json.loads(line) for line in (folder / "alarms.txt").read_text().splitlines()]
        events = (folder / "events.log").read_text().count(": alarm_")
        refusals = (folder / "events.log").read_text().count(": connections:")
    late: dict[bool, list[float]] = {False: [], True: []}
    for flooded, since, end, times in phases:
        found = taken[(taken[:, 0] > since) & (taken[:, 0] < end), 1]
        late[flooded] += found.tolist()
        shown = "; ".join(
            f"{name} answers {np.isfinite(of).sum()} of {len(of)}, median {1e3 * np.median(of):.0f} ms"
            for name, of in times.items()
        )
        figures = f"p50 {1e3 * np.quantile(found, 0.5):.2f} ms, p99 {1e3 * np.quantile(found, 0.99):.2f} ms"
        print(f"{'with' if flooded else 'without'} strangers: {figures}; {shown}")
    drawn = float(re.findall(r"^helibore_samples_drawn_total (\S+)", text, re.MULTILINE)[0])
    refused = [line for line in text.splitlines() if line.startswith("helibore_connections_refused_total{")]
    without, flooded = (float(np.quantile(late[key], 0.99)) for key in (False, True))
    print(f"{sent:,} triples sent, {sent - drawn:.0f} lost; exit code {code}; {descriptors} descriptors at the end")
    print(f"{events} alarms began or ended, {len(lines)} lines came; {refusals} events say what was refused")
    print("\n".join(refused))
    ratio = flooded / without
    print(f"p99 {1e3 * without:.2f} ms without, {1e3 * flooded:.2f} ms with: ratio {ratio:.2f}; the bar is 2")
    if sent != drawn or len(lines) != events or code or ratio > 2:
        sys.exit(1)


def phase(context: Any, ports: tuple[int, int], urls: dict[str, str], chosen: Any, flooded: bool) -> Any:
    """Run one phase; return whether it is flooded, its times, and the seconds of each answer by server."""
    stop, counts = context.Event(), context.Queue()
    flood = context.Process(target=strangers, args=(ports, chosen.rate, stop, counts), daemon=True)
    if flooded:
        flood.start()
        time.sleep(3)  # they all have come once
    since = time.time()
    times: dict[str, list[float]] = {name: [] for name in urls}
    while time.time() < since + chosen.seconds - (3 if flooded else 0):
        for name, url in urls.items():
            times[name].append(answered(url))
        time.sleep(0.2)
    end = time.time()
    if flooded:
        stop.set()
        counts.get()
        flood.join()
    return flooded, since, end, times


def _is_open(port: int) -> bool:
    with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port)):
        return True
    return False


if __name__ == "__main__":
    main()

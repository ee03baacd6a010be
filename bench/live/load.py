"""Measure the live wall under load, with a journal: ``python -m bench.live.load --minutes 10 [--page or --reader]``.

A child process on the same machine sends 2,000 triples/s in frames of 30 and 4,000 other items/s in frames of 40, while
the hole gets 100 m deeper. At the end the wall is compared with the batch reconstruction of its samples. Then the
benchmark prints triples lost, the time from a packet's arrival to its changed vertices, the share of a core, and
memory. ``--page`` shows the wall in Debian's chromium, and prints how long after the wall the page has new vertices,
and how long after the wall it draws them. That browser draws a picture of 683 by 384 with the processor, in idle time
only; at a rig a graphics card draws, mostly that of another computer. With ``--reader``, a process receives what such a
page receives, and draws nothing.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import multiprocessing
import os
import resource
import shutil
import socket
import sys
import tempfile
import time
from collections import deque
from multiprocessing.synchronize import Event
from pathlib import Path
from typing import Any

import numpy as np

import helibore as hb
from helibore.cli.live_view import Window
from helibore.live.model.update import Update
from helibore.live.rules.configuration import parse
from helibore.live.server import Server
from helibore.live.wire import wits
from helibore.viewer.protocol import WRITE

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "python"))

CONFIGURATION = """
[wall]
bit_diameter = 0.216
start_depth = 1000.0
threads = 1
[source.rig]
address = "listen://127.0.0.1:{port}"
units = "metric"
items = {{ bit_depth = "0108", hole_depth = "0110", rotation = "0120" }}
caliper = {{ first = "5010", groups = 30, order = ["toolface", "depth", "radius"] }}
"""


# Records when the page has more vertices than before, and when it has drawn them: [ms since 1970, number of vertices].
RECORDER = """() => {
  const seen = (window.seen = { taken: [], drawn: [] });
  let waiting = null;  // [number, frames before, fence or null]
  setInterval(() => {
    const app = window.__wall?.app;
    const size = app?.store?.levels[0].size ?? 0;
    if (size > (seen.taken.at(-1)?.[1] ?? 0)) seen.taken.push([Date.now(), size]);
    if (!waiting && size > (seen.drawn.at(-1)?.[1] ?? 0)) waiting = [size, app.renderer.frames, null];
  }, 5);
  setInterval(() => {
    const { gpu, frames } = window.__wall?.app ?? {};
    if (!waiting || frames === waiting[1]) return;
    waiting[2] ??= gpu.gl.fenceSync(gpu.gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    if (gpu.gl.getSyncParameter(waiting[2], gpu.gl.SYNC_STATUS) !== gpu.gl.SIGNALED) return;
    seen.drawn.push([Date.now(), waiting[0]]);
    gpu.gl.deleteSync(waiting[2]);
    waiting = null;
  }, 50);
}"""


def watch(url: str, stop: Event, seen: multiprocessing.Queue[dict[str, Any]]) -> None:
    """Open the page in a browser until ``stop``.

    Put into ``seen`` the times at which the page had new vertices (taken), and at which it had drawn them (drawn).
    """
    from playwright.sync_api import sync_playwright
    from screen import FLAGS

    os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0))
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        page = browser.new_page(viewport={"width": 683, "height": 384})
        page.goto(url)
        page.evaluate(RECORDER)
        stop.wait()
        seen.put(page.evaluate("window.seen"))
        browser.close()


def read(url: str, stop: Event, seen: multiprocessing.Queue[dict[str, Any]]) -> None:
    """Receive until ``stop`` what a page receives, and draw nothing; put the times of new vertices into ``seen``."""
    from page_protocol import unpack
    from websockets.asyncio.client import connect

    taken: list[tuple[float, int]] = []

    async def take() -> None:
        async with connect(url.replace("http", "ws", 1).replace("/?", "/ws?")) as socket:
            session = ""
            while not stop.is_set():
                try:
                    said = await asyncio.wait_for(socket.recv(), 0.5)
                except TimeoutError:
                    continue
                if isinstance(said, bytes):
                    message = unpack(said)
                    await socket.send(json.dumps({"session": session, "ack": message.sequence}))
                    if message.kind == WRITE and message.level == 0 and message.total > (taken[-1][1] if taken else 0):
                        taken.append((1e3 * time.time(), message.total))
                elif (greeting := json.loads(said))["type"] == "handshake":
                    session = greeting["session"]
                    wanted = {"tiles": [[0, 1000]], "focus": 0, "mask": 0}
                    await socket.send(json.dumps({"session": session, "subscribe": wanted}))

    asyncio.run(take())
    seen.put({"taken": taken})


def send(port: int, seconds: float, triples: int, items: int, counts: multiprocessing.Queue[int]) -> None:
    """Send frames like a rig: every 10 ms, the frames that are due; put the number of triples sent into ``counts``."""
    draw = np.random.default_rng(1)
    step = 100.0 / (triples * max(seconds, 60.0))
    link = socket.create_connection(("127.0.0.1", port))
    begin, sent, surface = time.monotonic(), 0, 0
    while (now := time.monotonic() - begin) < seconds:
        out = []
        while (surface + 1) * 40 <= now * items:
            depth = f"{1000 + sent * step + 0.01:.4f}"
            known = [(108, depth), (110, depth), (120, "120")]
            out.append(wits.frame(known + [(121 + i, f"{draw.uniform(0, 1e4):.2f}") for i in range(37)]))
            surface += 1
        while sent + 30 <= now * triples:
            rows = []
            for i in range(30):
                first, k = 5010 + 3 * i, sent + i
                rows += [(first, f"{k * 22.3 % 360:.2f}"), (first + 1, f"{1000 + k * step:.6f}"),
                         (first + 2, f"{draw.normal(110, 1):.3f}")]  # fmt: skip
            out.append(wits.frame(rows))
            sent += 30
        if out:
            link.sendall(b"".join(out))
        time.sleep(0.01)
    link.close()
    counts.put(sent)


def memory() -> float:
    """Return the resident memory of this process, MB."""
    with open("/proc/self/statm") as file:  # noqa: PTH123
        return int(file.read().split()[1]) * resource.getpagesize() / 1e6


def main() -> None:
    """Send the load to a live wall, compare the wall, and print the figures."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--minutes", type=float, default=1.0)
    options.add_argument("--triples", type=int, default=2000, help="triples sent in a second")
    options.add_argument("--items", type=int, default=4000, help="other items sent in a second")
    options.add_argument("--page", action="store_true")
    options.add_argument("--reader", action="store_true")
    chosen = options.parse_args()
    seconds = 60 * chosen.minutes
    with socket.create_server(("127.0.0.1", 0)) as probe:
        port = probe.getsockname()[1]
    with tempfile.TemporaryDirectory() as folder:
        live = hb.Live(parse(CONFIGURATION.format(port=port)), folder)
        context = multiprocessing.get_context("spawn")
        window, reported = (Window("load") if chosen.page or chosen.reader else None), deque[tuple[float, int]]()

        def updated(update: Update) -> None:
            reported.append((time.time(), len(live.wall)))
            if window:
                window.show(update)

        server = Server(live, updated)
        server.latency.latest = deque()
        server.start()
        stop = context.Event()
        seen: multiprocessing.Queue[dict[str, Any]] = context.Queue()
        if window:
            window.follow(live)
            watcher = context.Process(target=watch if chosen.page else read, args=(window.url, stop, seen))
            watcher.start()
        counts: multiprocessing.Queue[int] = context.Queue()
        rig = context.Process(target=send, args=(port, seconds, chosen.triples, chosen.items, counts))
        rig.start()
        while live.wall.sample_count == 0:
            time.sleep(0.01)
        cpu, clock, marks = time.process_time(), time.monotonic(), []
        while rig.is_alive():
            time.sleep(1.0)
            if window:
                window.refresh({"rig": "connected"})
            marks.append((memory(), live.wall.sample_count))
        busy = (time.process_time() - cpu) / (time.monotonic() - clock)
        server.wait(1.0)
        if window:
            stop.set()
            pages = {name: np.array(of) for name, of in seen.get().items()}
            watcher.join()
            window.close()
        server.stop()
        live.close()
        assert server.failure is None
        batch = hb.reconstruct(live.wall.samples, **vars(live.wall.settings))
        assert np.array_equal(batch.radius, live.wall.radius, equal_nan=True), "the live wall is not the batch wall"
        late = np.array(server.latency.latest)
        reader = live.model.readers[1]
        lost = counts.get() - live.wall.sample_count
        (warm, first), (last, count) = marks[len(marks) // 4], marks[-1]
        bad = sum(reader.total(rule) for rule in wits.RULES)
        half, most = 1e3 * np.quantile(late, 0.5), 1e3 * np.quantile(late, 0.99)
        each = 1e6 * (last - warm) / max(count - first, 1)
        print(f"{live.wall.sample_count:,} triples drawn, {lost} lost, {bad} bad lines")
        print(f"packet in to vertices out: p50 {half:.2f} ms, p99 {most:.2f} ms, most {1e3 * late.max():.1f} ms")
        if window:
            known, size = np.array(reported).T
            for name, of in pages.items():
                first = np.searchsorted(of[:, 1], size)  # the first report of the page with all vertices of that time
                inside = (size >= of[0, 1]) & (first < len(of))
                delay = of[first[inside], 0] - 1e3 * known[inside]
                half, most = np.quantile(delay, [0.5, 0.99])
                print(f"vertices out to {name} by the page: p50 {half:.0f} ms, p99 {most:.0f} ms, {len(of)} times")
        print(f"{100 * busy:.0f} % of a core; {warm:.0f} to {last:.0f} MB, {each:.0f} bytes a sample of the wall")


if __name__ == "__main__":
    main()

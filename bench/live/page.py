"""Measure the live viewer in a real browser: first picture, append to pixels, panning, bytes, memory, many clients.

    python -m bench.live.page [--quads 1000000] [--appends 9] [--clients 10] [--hidden 60] [--exports]

This needs Debian's chromium and playwright; the browser draws with software GL, as a weak computer at a rig would. The
wall is that of tests/python/made_wall.py, and the page is checked to hold its values before anything is timed. The
command prints one line for each figure, and the machine's load before and after; load makes every time longer.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import json
import multiprocessing
import os
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "python"))

from made_wall import BIT, MadeWall, curved_path, gamma_and_resistivity
from page_protocol import unpack
from screen import CHROMIUM, FLAGS

import helibore as hb
from helibore.viewer import Viewer

# Pans by a hundredth of the section in each frame; returns the milliseconds that the page's own script takes in each.
PAN = """(frames) => new Promise((done) => {
  const { app } = window.__wall;
  const times = [];
  app.renderer.draw = () => {
    const began = performance.now();
    Object.getPrototypeOf(app.renderer).draw.call(app.renderer);
    times.push(performance.now() - began);
  };
  const step = () => {
    if (times.length >= frames) {
      delete app.renderer.draw;
      return done(times);
    }
    app.view.show(app.view.top - app.view.length / 100, app.view.length, app.store);
    requestAnimationFrame(step);
    return undefined;
  };
  step();
})"""

# Flies through the hole for `seconds`; each frame waits until its pixels are drawn. Returns the frames a second, the
# seconds, the triangles of the last frame.
FLY = """([camera, seconds]) => new Promise((done) => {
  const { app } = window.__wall;
  const { gl } = app.renderer.gpu;
  const pixel = new Uint8Array(4);
  let [frames, began] = [0, 0];
  app.view.choose({ camera });
  app.renderer.draw = () => {
    Object.getPrototypeOf(app.renderer).draw.call(app.renderer);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    if (++frames === 5) began = performance.now(); // the first frames load what the view needs
    if (frames <= 5 || performance.now() - began < 1000 * seconds) return;
    delete app.renderer.draw;
    document.getElementById('fly').click();
    const spent = (performance.now() - began) / 1000;
    done([(frames - 5) / spent, spent, app.renderer.gpu.stats.triangles]);
  };
  document.getElementById('fly').click();
})"""

# Resolves when the page has drawn a wall of `size` vertices or more and the GPU has finished.
DRAWN = """(size) => new Promise((done) => {
  const { app } = window.__wall;
  const gl = app.renderer.gpu.gl;
  const pixel = new Uint8Array(4);
  let frames = -1;
  const look = () => {
    if (app.store.levels[0].size >= size) {
      if (frames < 0) frames = app.renderer.frames;
      else if (app.renderer.frames > frames || !app.renderer.scheduled) {
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
        return done();
      }
    }
    setTimeout(look, 4);
    return undefined;
  };
  look();
})"""


def say(name: str, value: float, unit: str, bar: str = "") -> None:
    print(f"{name:<52} {value:10.2f} {unit:<10} {bar}", flush=True)


def load() -> str:
    return " ".join(f"{x:.1f}" for x in os.getloadavg())


def memory(root: int) -> float:
    """Return the proportional memory (PSS) of a process and all its descendants, MB."""
    parents: dict[int, list[int]] = {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                fields = (entry / "stat").read_text().rsplit(")", 1)[1].split()
            except OSError:
                continue
            parents.setdefault(int(fields[1]), []).append(int(entry.name))
    total, todo = 0, [root]
    while todo:
        process = todo.pop()
        todo += parents.get(process, [])
        try:
            rollup = (Path("/proc") / str(process) / "smaps_rollup").read_text()
        except OSError:
            continue
        total += int(rollup.split("\nPss:", 1)[1].split()[0])
    return total / 1024


def ready(page: Any) -> None:
    while not page.evaluate("Boolean(window.__wall?.ready)"):
        time.sleep(0.01)


def in_the_browser(quads: int, appends: int) -> None:
    from playwright.sync_api import sync_playwright

    wall = MadeWall(quads)
    began = time.perf_counter()
    viewer = hb.view(wall, path=curved_path(), attributes=gamma_and_resistivity(wall), well="bench")
    say("server: wall read and packed", time.perf_counter() - began, "s")
    with sync_playwright() as playwright:
        context = playwright.chromium.launch_persistent_context("", executable_path=CHROMIUM, args=FLAGS, headless=True)
        page = context.pages[0]
        page.set_viewport_size({"width": 1366, "height": 768})
        time.sleep(1)
        browser = browser_process()
        empty = memory(browser)
        page.goto(viewer.url)
        ready(page)
        say(
            "first picture, from navigation",
            page.evaluate("window.__wall.stats.firstPicture") / 1000,
            "s",
            "3 s at 1 M, 4 s at 5 M",
        )
        time.sleep(3)
        check(page, wall)
        say("bytes to the first picture and at rest", page.evaluate("window.__wall.stats.bytes") / 1e6, "MB")
        measure_appends(page, wall, viewer, appends)
        say("page memory over an empty page", memory(browser) - empty, "MB", "250 MB at 1 M")
        measure_panning(page)
        measure_hover(page)
        measure_flight(page, browser)
        visit_all(page, wall)
        say("page memory after a walk along the whole well", memory(browser) - empty, "MB")
        context.close()
    viewer.close()


def visit_all(page: Any, wall: MadeWall) -> None:
    """Show thirty sections of the wall from end to end, so that tiles are loaded and dropped."""
    for depth in np.linspace(wall.depth[0], wall.depth[-1], 30):
        page.evaluate(f"window.__wall.app.view.centre({depth}, window.__wall.app.store)")
        time.sleep(0.15)
    time.sleep(1)


def check(page: Any, wall: MadeWall) -> None:
    last = len(wall) - 200
    radius = page.evaluate(f"window.__wall.app.store.vertex({last})?.radius ?? -1")
    assert abs(radius - wall.radius[last]) < 6e-6, "the page does not hold the wall: nothing is measured"


def measure_panning(page: Any) -> None:
    times = page.evaluate(PAN, 200)
    say("own script of a frame while panning, p50", float(np.median(times)), "ms", "8 ms at 1 M")
    say("own script of a frame while panning, p95", float(np.percentile(times, 95)), "ms")


def processor_seconds(root: int) -> float:
    """Return the processor time that a process and all its descendants have used."""
    total = 0
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit() and (int(entry.name) == root or root in ancestors(int(entry.name))):
            with contextlib.suppress(OSError):
                total += sum(map(int, (entry / "stat").read_text().rsplit(")", 1)[1].split()[11:13]))
    return total / os.sysconf("SC_CLK_TCK")


def measure_flight(page: Any, browser: int) -> None:
    """Fly through sections of several lengths, and print the frames a second."""
    middle = page.evaluate("(([a, b]) => (a + b) / 2)(window.__wall.app.store.span)")
    for length in (10, 30, 100):
        page.evaluate(f"(({{ view, store }}) => view.show({middle}, {length}, store))(window.__wall.app)")
        time.sleep(1)
        before = processor_seconds(browser)
        rate, seconds, triangles = page.evaluate(FLY, ["down", 4])
        say(f"flight, {length} m in view: frames a second", rate, "", "15 at 1 M")
        spent = (processor_seconds(browser) - before) / (rate * seconds)
        say(f"flight, {length} m in view: processor time of a frame", 1000 * spent, "ms", f"{triangles:,} triangles")
    page.evaluate("window.__wall.app.view.choose({ camera: 'straight' })")


def measure_hover(page: Any) -> None:
    """Move the pointer along the image of a page at rest, and print what the page draws in this time."""
    time.sleep(3)
    image = page.evaluate("window.__wall.app.renderer.rects.image")
    stage = page.evaluate("document.getElementById('stage').getBoundingClientRect().toJSON()")
    before = page.evaluate("[window.__wall.stats.pictures, window.__wall.stats.frames]")
    for step in range(20):
        page.mouse.move(stage["x"] + image["left"] + 40 + step, stage["y"] + image["top"] + 40 + 10 * step)
        time.sleep(0.05)
    after = page.evaluate("[window.__wall.stats.pictures, window.__wall.stats.frames]")
    say("3-D pictures that 20 moves of the pointer draw", after[0] - before[0], "", "0")
    say("frames of ink that they draw", after[1] - before[1], "")


def measure_appends(page: Any, wall: MadeWall, viewer: Viewer, appends: int) -> None:
    times, sizes = [], []
    for _ in range(appends):
        before = page.evaluate("window.__wall.stats.bytes")
        change = wall.grow(1000)
        values = {attribute.name: column for attribute, column in gamma_and_resistivity(wall).items()}
        began = time.perf_counter()
        viewer.update(change, values)
        page.evaluate(DRAWN, len(wall))
        times.append(time.perf_counter() - began)
        time.sleep(0.6)
        sizes.append((page.evaluate("window.__wall.stats.bytes") - before) / 1000)
    say("append of 1,000 quads to pixels, median", float(np.median(times)), "s", "0.4 s")
    say("append of 1,000 quads to pixels, worst", max(times), "s")
    say("bytes a quad on the wire, two attributes, median", float(np.median(sizes)), "B", "20 B")


def browser_process() -> int:
    """Return the process of the chromium that playwright started: the youngest that descends from this process."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                command = (entry / "cmdline").read_bytes()
            except OSError:
                continue
            if b"chromium" in command and b"--type=" not in command and b"--remote-debugging" in command:
                found.append(int(entry.name))
    return max(process for process in found if os.getpid() in ancestors(process))


def ancestors(process: int) -> list[int]:
    """Return the processes from which a process descends; [] if it has ended."""
    found = []
    while process > 1:
        try:
            fields = (Path("/proc") / str(process) / "stat").read_text().rsplit(")", 1)[1].split()
        except OSError:
            return []
        process = int(fields[1])
        found.append(process)
    return found


def hidden(seconds: int) -> None:
    """Print how a page catches up when it is shown again, after ``seconds`` behind another tab at 1,000 quads/s."""
    from tabs import Tabs, until

    wall = MadeWall(40_000)
    with hb.view(wall, path=curved_path()) as viewer, Tabs(viewer.url) as page:
        until(lambda: page.evaluate("Boolean(window.__wall?.ready)"))
        time.sleep(1)
        page.hide()
        before = page.evaluate("window.__wall.stats")
        began = time.perf_counter()
        for step in range(10 * seconds):
            viewer.update(wall.grow(100))
            time.sleep(max(0.0, began + (step + 1) / 10 - time.perf_counter()))
        time.sleep(0.5)
        held = page.evaluate("window.__wall.stats")
        began = time.perf_counter()
        page.show()
        page.evaluate(f"({DRAWN})({len(wall)})")
        say(f"hidden {seconds} s: shown again to pixels", time.perf_counter() - began, "s")
        after = page.evaluate("window.__wall.stats")
        say(f"hidden {seconds} s: quads it lacked when shown", len(wall) - held["size"], "")
        say(f"hidden {seconds} s: frames drawn while hidden", held["frames"] - before["frames"], "")
        say(f"hidden {seconds} s: frames drawn to catch up", after["frames"] - before["frames"], "", "1")
        say(f"hidden {seconds} s: bytes a quad", (after["bytes"] - before["bytes"]) / (len(wall) - 40_000), "B")


def many_clients(count: int, rounds: int = 3) -> None:
    """Print time and memory of appends without a page, and, in turn, with ``count`` pages, of which one never reads."""
    found: dict[int, list[tuple[float, float, float]]] = {0: [], count: []}
    for _ in range(rounds):
        for pages, figures in found.items():
            figures.append(with_clients(pages))
    for pages, figures in found.items():
        p50, p99, grown = (float(np.median(column)) for column in zip(*figures, strict=True))
        say(f"append of 1,000 samples with {pages} pages, p50", p50, "ms")
        say(f"append of 1,000 samples with {pages} pages, p99", p99, "ms", "+20 %" if pages else "")
        say(f"memory the process grew by with {pages} pages", grown, "MB")
    print("    p99 of each round: " + "; ".join(f"{n} pages {[round(f[1], 2) for f in fs]}" for n, fs in found.items()))


def with_clients(pages: int) -> tuple[float, float, float]:
    """Append 300 times while ``pages`` pages read; return p50 and p99 in ms, and by how many MB this process grew."""
    wall = hb.Wall(bit_diameter=BIT, start_depth=1000.0)
    rng = np.random.default_rng(1)
    wall.append(*samples(rng, 0))
    viewer = hb.view(wall)
    spawn = multiprocessing.get_context("spawn")
    stop, started = spawn.Event(), spawn.Event()
    readers = spawn.Process(target=read, args=(viewer.url, pages, stop, started))
    readers.start()
    started.wait(60)
    before = own_memory()
    times = append_steadily(wall, viewer, rng)
    grown = own_memory() - before
    stop.set()
    readers.join()
    viewer.close()
    return float(np.percentile(times, 50)) * 1e3, float(np.percentile(times, 99)) * 1e3, grown


def while_saving(rounds: int = 3) -> None:
    """Print the time of appends alone and, in turn, while exports of 500 m are fetched without a pause."""
    found: dict[bool, list[tuple[float, float, float]]] = {False: [], True: []}
    for _ in range(rounds):
        for fetching, figures in found.items():
            figures.append(with_exports(fetching))
    for figures in found.values():
        p50, p99, count = (float(np.median(column)) for column in zip(*figures, strict=True))
        name = f"append of 1,000 samples while {count:.0f} exports are made"
        say(f"{name}, p50", p50, "ms")
        say(f"{name}, p99", p99, "ms")


def with_exports(fetching: bool) -> tuple[float, float, float]:
    """Append samples to a wall of 500 m 300 times; return p50 and p99 of an append, ms, and the number of exports."""
    wall = hb.Wall(bit_diameter=BIT, start_depth=500.0)
    rng = np.random.default_rng(1)
    wall.append(500 + np.sort(rng.uniform(0, 500, 300_000)), rng.uniform(0, 360, 300_000), np.full(300_000, 0.11))
    with hb.view(wall) as viewer:
        spawn = multiprocessing.get_context("spawn")
        stop, started, made = spawn.Event(), spawn.Event(), spawn.Value("i", 0)
        fetcher = spawn.Process(target=fetch, args=(viewer.url, stop, started, made))
        if fetching:
            fetcher.start()
            started.wait(60)
        times = append_steadily(wall, viewer, rng)
        stop.set()
        if fetching:
            fetcher.join()
    return float(np.percentile(times, 50)) * 1e3, float(np.percentile(times, 99)) * 1e3, made.value


def fetch(url: str, stop: Any, started: Any, made: Any) -> None:
    """Fetch exports until ``stop``; count them in ``made``."""
    import urllib.request

    while not stop.is_set():
        with urllib.request.urlopen(url.replace("/?", "/api/export.html?start=500&stop=1000&")) as answer:
            assert len(answer.read()) > 3e6, "an export of 300,000 vertices"
        made.value += 1
        started.set()


def append_steadily(wall: hb.Wall, viewer: Viewer, rng: np.random.Generator) -> list[float]:
    """Append 300 times, fifty a second at most; return the seconds that each append took."""
    times = []
    for step in range(1, 301):
        batch = samples(rng, step)
        began = time.perf_counter()
        change = wall.append(*batch)
        viewer.update(change)
        times.append(time.perf_counter() - began)
        time.sleep(0.02)
    return times


def own_memory() -> float:
    """Return the proportional memory (PSS) of this process alone, MB."""
    rollup = Path("/proc/self/smaps_rollup").read_text()
    return int(rollup.split("\nPss:", 1)[1].split()[0]) / 1024


def samples(rng: np.random.Generator, step: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    depth = 1000 + 0.5 * step + np.sort(rng.uniform(0, 0.5, 1000))
    return depth, rng.uniform(0, 360, 1000), rng.uniform(0.108, 0.118, 1000)


def read(url: str, pages: int, stop: Any, started: Any) -> None:
    """Run `read_all` in a separate process."""
    asyncio.run(read_all(url, pages, stop, started))


async def read_all(url: str, pages: int, stop: Any, started: Any) -> None:
    """Read like ``pages`` pages until ``stop``; the first page reads nothing after it has subscribed."""
    from websockets.asyncio.client import connect

    async def reader(stalls: bool) -> None:
        async with connect(url.replace("http", "ws", 1).replace("/?", "/ws?"), max_queue=1) as socket:
            session = json.loads(await socket.recv())["session"]
            wanted = {"tiles": [[0, 1000]], "focus": 0, "mask": 0}
            await socket.send(json.dumps({"session": session, "subscribe": wanted}))
            while not stop.is_set():
                if stalls:
                    await asyncio.sleep(0.2)
                    continue
                try:
                    said = await asyncio.wait_for(socket.recv(), 0.5)
                except TimeoutError:
                    continue
                if isinstance(said, bytes):
                    await socket.send(json.dumps({"session": session, "ack": unpack(said).sequence}))

    tasks = [asyncio.create_task(reader(i == 0)) for i in range(pages)]
    await asyncio.sleep(1)
    started.set()
    await asyncio.gather(*tasks)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--quads", type=int, default=1_000_000)
    parser.add_argument("--appends", type=int, default=9)
    parser.add_argument("--clients", type=int, default=10)
    parser.add_argument("--hidden", type=int, default=60, help="seconds that a page is hidden; 0 skips the hidden page")
    parser.add_argument("--exports", action="store_true", help="also measure appends while exports are made")
    options = parser.parse_args()
    print(f"load {load()}, {os.cpu_count()} cores, {options.quads:,} quads")
    in_the_browser(options.quads, options.appends)
    if options.hidden:
        hidden(options.hidden)
    if options.clients:
        many_clients(options.clients)
    if options.exports:
        while_saving()
    print(f"load {load()}")


if __name__ == "__main__":
    main()

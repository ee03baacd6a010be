"""The viewer's page in a real browser (Debian's chromium, software GL), for the tests that look at it.

The chromium-headless-shell is the same browser without a window's frame, for two thirds of the processor time.

`Screen` is one open page; pixels are read back from the page's own canvas. `Chromium` is the browser's process, one for
all tests of a worker; the fixture `browser` in conftest.py connects to it.
"""

from __future__ import annotations

import base64
import importlib.util
import itertools
import os
import shutil
import signal
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from patience import PATIENCE, wait

CHROMIUM = shutil.which("chromium-headless-shell") or shutil.which("chromium")
MISSING = [
    *([] if CHROMIUM else ["Debian's chromium (apt-get install chromium-headless-shell)"]),
    *(f"{name} (pip)" for name in ("playwright", "starlette", "uvicorn") if importlib.util.find_spec(name) is None),
]
if not MISSING:
    from helibore.viewer.page_files import page as page_file

    if page_file("app.js") is None:
        MISSING.append("the page, which is built if Node.js 18 or later is installed")
NEEDS_BROWSER = [
    pytest.mark.browser,
    pytest.mark.skipif(bool(MISSING), reason=f"the page cannot be tried without {', '.join(MISSING)}"),
]

FLAGS = [
    *("--headless=new", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking"),
    *("--disable-component-update", "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader"),
    *("--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"),
    "--disable-gpu-compositing",  # software GL is slow: it draws WebGL, and nothing else of the page
]

# Counts the answers that the page has asked for and not read. Runs before the page's own scripts.
COUNTED = """(() => {
  window.__unread = 0;
  const counted = (of, name) => {
    const own = of[name];
    of[name] = function (...more) {
      window.__unread++;
      return own.apply(this, more).finally(() => setTimeout(() => window.__unread--)); // after what waits for it
    };
  };
  counted(window, 'fetch');
  for (const name of ['arrayBuffer', 'blob', 'json', 'text']) counted(Response.prototype, name);
})()"""

# Resolves when the server has sent all and it is drawn: when four looks find the same, each after an answer of the
# server and a frame, so that a slow server, browser or machine has had its turn between them. New values stop glowing
# at once.
AT_REST = """async (patience) => {
  const { app, wells } = window.__wall;
  const end = performance.now() + 1000 * patience;
  const served = location.protocol.startsWith('http');
  const later = (of, ...more) => new Promise((done) => of(done, ...more));
  const ofPage = ({ renderer: { sharpening, loading, timers: { unseen } }, figures: { pending } }) =>
    [sharpening, loading, unseen, pending].map(Boolean);
  for (let before = '', quiet = 0; quiet < 4; ) {
    await later(setTimeout, 25);
    if (served) await fetch(`healthz${location.search}`).then((answer) => answer.text()).catch(() => '');
    await later(requestAnimationFrame);
    await later(setTimeout);
    const waits = [window.__unread > 0, ...(app ? ofPage(app) : [Boolean(wells.sharpening)])];
    const now = JSON.stringify([waits, window.__wall.stats ?? wells.wells.map(({ connection }) => connection.stats)]);
    if (app?.glow.ranges.length) { app.glow.ranges.length = 0; app.repaint(); }
    quiet = now === before && !waits.includes(true) ? quiet + 1 : 0;
    before = now;
    if (performance.now() > end) throw new Error(`never at rest: ${now}`);
  }
}"""

# Whether the zones have come, which are found after the wall is served; none are looked for in a gauge hole, or before
# there is a turn.
ZONES_FOUND = """(({ app }) => !app?.store || app.store.basis === 'gauge' || app.zonesTo !== null
  || app.store.levels[0].size < app.store.levels[0].sectors)(window.__wall)"""

FRAME = "new Promise((done) => requestAnimationFrame(() => setTimeout(done)))"
READS = {"evaluate", "get_attribute", "inner_text", "input_value", "is_hidden", "is_visible", "locator"}

UNDRAWN = """
const gl = WebGL2RenderingContext.prototype;
for (const name of ['compileShader', 'linkProgram', 'drawArrays', 'drawElements', 'blitFramebuffer'])
  gl[name] = () => {};
gl.getProgramParameter = (program, what) => what === gl.LINK_STATUS ? true : 0;
"""

# Draws at once and reads the WebGL canvas back, as RGBA bytes of a rectangle in CSS pixels.
READ = """([name, strip]) => {
  const { app } = window.__wall;
  const gl = app.renderer.gpu.gl;
  app.renderer.gpu.draw(app.renderer.look());
  const { left, top, width, height } = app.renderer.rects[name];
  const h = Math.round(strip ?? height);
  const pixels = new Uint8Array(4 * Math.round(width) * h);
  const y = Math.round(app.renderer.gpu.height - top - h);
  gl.readPixels(Math.round(left), y, Math.round(width), h, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  let text = '';
  for (const byte of pixels) text += String.fromCharCode(byte);
  return { width: Math.round(width), height: h, text: btoa(text) };
}"""


# Of every visible list: what the browser would make it wide with its chosen text alone, less what it is.
WIDER_THAN_ITS_BOX = """[...document.querySelectorAll('select')].filter((e) => e.checkVisibility()).map((e) => {
  const copy = e.cloneNode(false);
  copy.append(new Option(e.selectedOptions[0]?.text ?? ''));
  e.after(copy);
  copy.style = 'position: absolute; width: max-content; min-width: 0; max-width: none; flex: none';
  const wide = copy.getBoundingClientRect().width - e.getBoundingClientRect().width;
  copy.remove();
  return [e.id, wide];
}).filter(([, wide]) => wide > 0.5)"""


class Chromium:
    """A browser process that several connections share; ``words`` are further options, and the page to open."""

    def __init__(self, *words: str) -> None:
        self._folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        own = ["--remote-debugging-port=0", f"--user-data-dir={self._folder.name}", *(words or ["about:blank"])]
        # A session of its own: Debian's program is a script, whose end would not end the browser.
        self._process = subprocess.Popen(
            [str(CHROMIUM), *FLAGS, *own],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        said = Path(self._folder.name) / "DevToolsActivePort"
        end = time.monotonic() + PATIENCE
        while not (said.exists() and len(said.read_text().split()) == 2):
            assert time.monotonic() < end, "the browser did not start"
            time.sleep(0.02)
        port, path = said.read_text().split()
        self.address, self.socket = f"http://127.0.0.1:{port}", f"ws://127.0.0.1:{port}{path}"

    def close(self) -> None:
        os.killpg(self._process.pid, signal.SIGTERM)
        self._process.wait(PATIENCE)
        self._folder.cleanup()


def new_tab(browser: Any) -> Any:
    """Return an empty page whose waits have the patience of all tests.

    It is a tab of the first window: a window of its own costs half a second of processor time.
    """
    context = browser.contexts[0] if browser.contexts else browser.new_context()
    context.set_default_timeout(1000 * PATIENCE)
    return context.new_page()


class Screen:
    """A page on a viewer, with what a test asks of it."""

    now: float | None = None
    """The time of a page whose clock stands; None: it goes."""

    def __init__(
        self, browser: Any, url: str, address: str = "", size: tuple[int, int] = (1000, 640), drawn: bool = True,
        grows: bool = False,
    ) -> None:  # fmt: skip
        """Open the page, and wait until it shows all that the server has; of a wall that ``grows``, the first picture.

        Not ``drawn``: only text and ink are drawn, no WebGL.
        """
        self.requests: list[str] = []
        self.errors: list[str] = []
        self.page = new_tab(browser)
        self.page.set_viewport_size({"width": size[0], "height": size[1]})
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.on("websocket", lambda socket: self.requests.append(socket.url))
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.drawn, self.grows = drawn, grows
        self.page.add_init_script(COUNTED)
        if self.now is not None:
            self.page.add_init_script(f"Date.now = () => {1000 * self.now}")
        if not drawn:
            self.page.add_init_script(UNDRAWN)
        self.goto(url + address)

    def __getattr__(self, name: str) -> Any:
        """Return what the page has of this name. What is read is of the frame after the last input, not before it."""
        if name in READS:
            self.page.evaluate(FRAME)
        return getattr(self.page, name)

    def goto(self, url: str) -> None:
        """Open another page, and wait until it shows all that the server has."""
        self.page.goto(url)
        self._opened()

    def reload(self) -> None:
        """Open the page again, and wait until it shows all that the server has."""
        self.page.reload()
        self._opened()

    def _opened(self) -> None:
        self.until("window.__wall?.ready")
        if not self.grows:
            self.until(ZONES_FOUND)
            self.settle()

    def until(self, condition: str) -> None:
        wait(
            lambda: self.page.evaluate(f"Boolean({condition})"),
            lambda: f"never: {condition}; page errors {self.errors}",
            pause=0.05,
        )

    def point_at(self, across: float = 0.5, down: float = 0.5) -> None:
        """Move the pointer over the image track, shares of its width and height."""
        left, top, width, height = self.evaluate(
            "(({ left, top }, { image }) => [left + image.left, top + image.top, image.width, image.height])"
            "(document.getElementById('stage').getBoundingClientRect(), window.__wall.app.renderer.rects)"
        )
        self.page.mouse.move(left + across * width, top + down * height)
        self.until("window.__wall.app.view.cursor")
        self.settle()

    def settle(self) -> None:
        """Wait until nothing arrives and everything is drawn; what glows is made to stop."""
        self.page.evaluate(AT_REST, PATIENCE)

    def address(self) -> str:
        """The page's address after #, once it holds what the page shows."""
        self.until("window.__wall.addressed()")
        found: str = self.evaluate("location.hash")
        return found

    def touching(self, canvas: str) -> list[tuple[str, str]]:
        """Return the texts on a canvas that overlap, in pairs."""
        labels = self.evaluate(f"document.getElementById('{canvas}').labels")
        assert labels
        return [
            (a["text"], b["text"])
            for a, b in itertools.combinations(labels, 2)
            if a["left"] < b["right"] and b["left"] < a["right"] and a["top"] < b["bottom"] and b["top"] < a["bottom"]
        ]

    def cut_selects(self) -> list[tuple[str, float]]:
        """Return the visible lists whose chosen text is wider than their box, in pixels."""
        found: list[tuple[str, float]] = self.evaluate(WIDER_THAN_ITS_BOX)
        return found

    def struck(self, canvas: str) -> list[tuple[str, list[float]]]:
        """Return the texts on a canvas that a line strikes; not those on a ground of their own, nor lines of a grid."""
        labels, strokes = self.evaluate(
            f"(({{ labels, strokes }}) => [labels, strokes])(document.getElementById('{canvas}'))"
        )
        assert strokes
        return [
            (one["text"], line) for one in labels if not one.get("ground") for line in strokes if _crosses(line, one)
        ]

    def pixels(self, name: str) -> np.ndarray:
        assert self.drawn, "the screen draws no WebGL"
        got = self.page.evaluate(READ, [name, None])
        bytes_ = base64.b64decode(got["text"])
        return np.frombuffer(bytes_, np.uint8).reshape(got["height"], got["width"], 4)[::-1]

    def stats(self) -> dict[str, float]:
        found: dict[str, float] = self.evaluate("window.__wall.stats")
        return found

    def readout(self) -> dict[str, str]:
        script = "[...document.querySelectorAll('#readout > *')].map((e) => e.textContent)"
        flat = self.evaluate(script)
        return dict(zip(flat[::2], flat[1::2], strict=True))

    def close(self) -> None:
        """Close the page, whose tab stores nothing for the next; an AssertionError names errors of its scripts."""
        self.page.evaluate("localStorage.clear()")
        self.page.close()
        assert self.errors == []


def _crosses(line: list[float], box: dict[str, float]) -> bool:
    """Whether a line passes through the inside of a box."""
    x0, y0, x1, y1 = line
    ends = [0.0, 1.0]  # the part of the line that is inside
    for start, run, low, high in ((x0, x1 - x0, box["left"], box["right"]), (y0, y1 - y0, box["top"], box["bottom"])):
        if run == 0:
            if not low < start < high:
                return False
            continue
        a, b = sorted(((low - start) / run, (high - start) / run))
        ends = [max(ends[0], a), min(ends[1], b)]
    return ends[0] < ends[1]

"""The viewer's page in a real browser (Debian's chromium, software GL), for the tests that look at it.

`Screen` is one open page; pixels are read back from the page's own canvas. The `browser` itself is in conftest.py.
"""

from __future__ import annotations

import base64
import importlib.util
import shutil
import time
from typing import Any

import numpy as np
import pytest

CHROMIUM = shutil.which("chromium")
MISSING = [
    *([] if CHROMIUM else ["Debian's chromium (apt-get install chromium)"]),
    *(f"{name} (pip)" for name in ("playwright", "starlette", "uvicorn") if importlib.util.find_spec(name) is None),
]
if not MISSING:
    from helibore.viewer.server import page as page_file

    if page_file("app.js") is None:
        MISSING.append("the page, which is built where Node.js 18 is")
NEEDS_BROWSER = [
    pytest.mark.browser,
    pytest.mark.skipif(bool(MISSING), reason=f"the page is not tried: without {', '.join(MISSING)}"),
]

FLAGS = [
    *("--headless=new", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking"),
    *("--disable-component-update", "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader"),
    *("--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"),
]
PATIENCE = 40.0  # seconds: software GL on a busy machine

# Draws at once and reads the WebGL canvas back, as RGBA bytes of a rectangle in CSS pixels.
READ = """([name, strip]) => {
  const { app } = window.__wall;
  const gl = app.gpu.renderer.getContext();
  app.gpu.draw(app.look());
  const { left, top, width, height } = app.rects[name];
  const h = Math.round(strip ?? height);
  const pixels = new Uint8Array(4 * Math.round(width) * h);
  const y = Math.round(app.gpu.height - top - h);
  gl.readPixels(Math.round(left), y, Math.round(width), h, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  let text = '';
  for (const byte of pixels) text += String.fromCharCode(byte);
  return { width: Math.round(width), height: h, text: btoa(text) };
}"""


class Screen:
    """A page on a viewer, with what a test asks of it."""

    def __init__(self, browser: Any, url: str, address: str = "", size: tuple[int, int] = (1366, 768)) -> None:
        self.requests: list[str] = []
        self.errors: list[str] = []
        self.page = browser.new_page(viewport={"width": size[0], "height": size[1]})
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.on("websocket", lambda socket: self.requests.append(socket.url))
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.goto(url + address)
        self.until("window.__wall?.ready")

    def __getattr__(self, name: str) -> Any:
        return getattr(self.page, name)

    def until(self, condition: str) -> None:
        end = time.monotonic() + PATIENCE
        while not self.page.evaluate(f"Boolean({condition})"):
            assert time.monotonic() < end, f"never: {condition}; page errors {self.errors}"
            time.sleep(0.05)

    def settle(self) -> None:
        """Wait until nothing arrives, nothing glows and everything is drawn."""
        before = None
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            now = self.page.evaluate("JSON.stringify([window.__wall.stats, window.__wall.app.glow.ranges.length])")
            if now == before and now.endswith(",0]"):
                return
            before = now
            time.sleep(0.2)
        raise AssertionError("the page never came to rest")

    def pixels(self, name: str) -> np.ndarray:
        got = self.page.evaluate(READ, [name, None])
        bytes_ = base64.b64decode(got["text"])
        return np.frombuffer(bytes_, np.uint8).reshape(got["height"], got["width"], 4)[::-1]

    def stats(self) -> dict[str, float]:
        found: dict[str, float] = self.page.evaluate("window.__wall.stats")
        return found

    def readout(self) -> dict[str, str]:
        script = "[...document.querySelectorAll('#readout > *')].map((e) => e.textContent)"
        flat = self.page.evaluate(script)
        return dict(zip(flat[::2], flat[1::2], strict=True))

    def close(self) -> None:
        self.page.close()
        assert self.errors == []

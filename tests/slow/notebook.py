"""The viewer in JupyterLab, driven in Chromium: `python tests/slow/notebook.py [PICTURE.png]`; needs jupyterlab.

Runs a notebook that shows a wall; scrolls the image and reads the trait in Python; appends, and looks for the new
vertices; saves, opens the notebook again without a kernel, and looks for the card.
"""

from __future__ import annotations

import contextlib
import json
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import urllib.request
from pathlib import Path
from typing import Any

from playwright.sync_api import sync_playwright

FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
CELLS = [
    """import numpy as np, helibore as hb
k = np.arange(60_000)
wall = hb.Wall(bit_diameter=0.216, sectors=64, pitch=0.1, start_depth=2000.0)
wall.append(2000 + k * 0.0005, k * 37.0, 0.110 + 0.005 * np.cos(np.radians(2 * 37.0 * k)))
viewer = hb.view(wall)
viewer""",
    "print('depths', viewer.widget.depths)",
    "viewer.update(wall.append(2030 + k * 0.0005, k * 37.0, np.full(len(k), 0.112)))",
    "viewer.widget.depths = (2040.0, 2050.0)",
]


def free_port() -> int:
    with socket.socket() as bound:
        bound.bind(("127.0.0.1", 0))
        port: int = bound.getsockname()[1]
        return port


def notebook() -> str:
    empty = {"cell_type": "code", "metadata": {}, "outputs": [], "execution_count": None}
    cells = [{**empty, "id": f"c{i}", "source": text} for i, text in enumerate(CELLS)]
    kernel = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
    return json.dumps({"cells": cells, "metadata": kernel, "nbformat": 4, "nbformat_minor": 5})


def lab(folder: Path, port: int) -> subprocess.Popen[bytes]:
    """Start JupyterLab and wait until it answers."""
    options = ["--no-browser", "--allow-root", f"--port={port}", "--ServerApp.token=", f"--ServerApp.root_dir={folder}"]
    quiet = subprocess.DEVNULL
    server = subprocess.Popen([sys.executable, "-m", "jupyter", "lab", *options], stdout=quiet, stderr=quiet)
    for _ in range(120):
        with contextlib.suppress(OSError):
            urllib.request.urlopen(f"http://127.0.0.1:{port}/api", timeout=2).read()
            return server
        time.sleep(0.5)
    raise AssertionError("JupyterLab did not start")


def until(frame: Any, expression: str, seconds: float = 60.0) -> None:
    """Wait until an expression is true in the frame, whose policy forbids what Playwright's own waiting does."""
    end = time.monotonic() + seconds
    while not frame.evaluate(expression):
        if time.monotonic() > end:
            raise AssertionError(f"never true: {expression}")
        time.sleep(0.1)


def main(picture: str | None) -> None:
    folder = Path(tempfile.mkdtemp())
    file = folder / "wall.ipynb"
    file.write_text(notebook())
    port = free_port()
    server = lab(folder, port)
    address = f"http://127.0.0.1:{port}/lab/tree/wall.ipynb"
    try:
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
            page = browser.new_page(viewport={"width": 1500, "height": 1100})
            page.goto(address)
            page.get_by_text("import numpy").first.wait_for(timeout=90_000)
            page.get_by_text("| Idle").first.wait_for(timeout=90_000)  # a cell that is run before it is lost

            def run(cell: int) -> None:
                page.locator(".jp-CodeCell").nth(cell).locator(".cm-content").click()
                page.keyboard.press("Control+Enter")

            run(0)
            frame = page.frame_locator('iframe[title="helibore"]')
            frame.locator("#ink").wait_for(timeout=90_000)
            inside = next(f for f in page.frames if f.url == "about:srcdoc")
            until(inside, "window.__wall?.ready && window.__wall.app.notebook !== null")
            until(inside, "window.__wall.app.status === 'live'")
            assert not page.locator('[class^="helibore-"]').first.is_visible(), "the card is hidden"
            if picture:
                time.sleep(2)
                page.screenshot(path=picture)
            before = inside.evaluate("window.__wall.app.view.top")
            box = inside.evaluate("(({image}) => image)(window.__wall.app.renderer.rects)")
            ink = frame.locator("#ink")
            ink.hover(position={"x": box["left"] + 40, "y": box["top"] + 300})
            page.mouse.wheel(0, 400)
            until(inside, f"Math.abs(window.__wall.app.view.top - {before}) > 0.01")
            time.sleep(2)
            run(1)
            output = page.locator(".jp-CodeCell").nth(1).locator(".jp-OutputArea-output")
            output.wait_for(timeout=30_000)
            top = float(output.inner_text().split("(")[1].split(",")[0])
            shown = inside.evaluate("window.__wall.app.view.top")
            assert abs(top - shown) < 0.01 < abs(top - before), (top, shown, before)
            size = inside.evaluate("window.__wall.app.store.levels[0].size")
            run(2)
            until(inside, f"window.__wall.app.store.levels[0].size > {size}")
            run(3)
            until(inside, "Math.abs(window.__wall.app.view.top - 2040) < 0.5")
            page.keyboard.press("Control+s")
            time.sleep(3)
            saved = json.loads(file.read_text())
            outputs = json.dumps(saved["cells"][0]["outputs"])
            size = len(file.read_bytes())
            assert "data:image/png" in outputs, "the saved notebook has no picture"
            assert size < 60_000, f"the saved notebook has {size:,} bytes"
            print(f"the saved notebook has {size:,} bytes")
            browser.close()
            server.terminate()
            server.wait()
            server = lab(folder, port)
            browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
            page = browser.new_page(viewport={"width": 1500, "height": 1100})
            page.goto(address + "?reset")
            page.locator(".jp-OutputArea-output img").first.wait_for(state="attached", timeout=90_000)
            if picture:
                page.screenshot(path=picture.replace(".png", "-saved.png"))
            page.locator(".jp-OutputArea-output img").first.wait_for(timeout=10_000)
            browser.close()
        print("passed: shown, trait follows the wheel, growth, depths from Python, saved card")
    finally:
        server.terminate()
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else None)

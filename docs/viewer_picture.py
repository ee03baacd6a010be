"""Draws docs/helibore-viewer.png: the viewer on a simulated hole, as Chromium shows it.

    python docs/viewer_picture.py docs/helibore-viewer.png

The hole has a gamma image, a survey, a stretch without samples, one that was scanned again, and three picked beds.
Needs the extra ``test`` and Debian's chromium. The processor draws the page, so that every machine draws the same.
"""

from __future__ import annotations

import io
import shutil
import sys
import time
from functools import partial
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page, sync_playwright

import helibore as hb
from helibore.simulation import Bed, Hole, Simulation, Tool, simulate

FLAGS = ["--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
GAP = (2046.0, 2049.5)  # metres without a sample
AGAIN = (2057.0, 2060.0)  # metres scanned again


def show() -> tuple[hb.Viewer, Simulation]:
    """Serve the wall as it grows, with its gap and its second pass."""
    run = simulate(Hole.example(2000.0, 2080.0, seed=4), Tool(), seed=4)
    there = (run.depth < GAP[0]) | (run.depth > GAP[1])
    wall = hb.reconstruct(
        hb.Caliper(run.depth[there], run.toolface[there], run.radius[there], run.time[there]),
        bit_diameter=run.hole.bit_diameter,
        max_distance=0.4,
    )
    path = hb.Survey(run.station_depth, run.inclination, run.azimuth).path(head=(312.0, 145.0, 1862.0), extend=50.0)
    gamma = hb.SectorImage(run.gamma_depth, run.gamma, name="GR", unit="gAPI", origin="edge", reference="high-side")
    viewer = hb.view(
        wall, path=path, attributes={hb.Attribute("GR", "gAPI", 20, 140): gamma.on(wall)}, well="Simulated"
    )
    second = (run.depth > AGAIN[0]) & (run.depth < AGAIN[1])
    time_later = run.time[second] + 1e5
    viewer.update(wall.append(run.depth[second], run.toolface[second], run.radius[second] + 0.003, time_later))
    viewer.scene.update_state(bit_depth=2091.3, newest=time.time())
    return viewer, run


def pick(bed: Bed) -> hb.Pick:
    """A bed's top as a pick."""
    return hb.Pick(kind="bed", depth=bed.depth, apparent_dip=bed.dip, toolface=bed.direction % 360)


def settle(page: Page) -> None:
    """Wait until nothing arrives, nothing glows, nothing is drawn anew."""
    before = None
    state = "window.__wall?.ready ? JSON.stringify([__wall.stats, __wall.app.glow.ranges]) : null"
    while (now := page.evaluate(state)) is None or now != before:
        before = now
        page.wait_for_timeout(500)


def main(output: Path) -> None:
    viewer, run = show()
    for bed in [bed for bed in run.hole.beds if AGAIN[0] - 5 < bed.depth < AGAIN[1] + 2][:3]:
        viewer.scene.change_picks(partial(hb.Picks.put, pick=pick(bed)))
    address = "#md=2054&sec=24&quantity=GR"
    with viewer, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        page = browser.new_page(viewport={"width": 1366, "height": 768})
        page.goto(viewer.url + address)
        settle(page)
        page.mouse.move(300, 590)
        settle(page)
        picture = Image.open(io.BytesIO(page.screenshot()))
        browser.close()
    picture.convert("RGB").save(output, optimize=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]))

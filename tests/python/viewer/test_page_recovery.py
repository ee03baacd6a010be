"""The page comes right by itself: hidden, its server killed, re-scanned over a seam, the survey corrected.

Right means: to the pixel what a page opened afterwards shows.
"""

from __future__ import annotations

import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from locations import ROOT
from patience import PATIENCE
from screen import NEEDS_BROWSER, Screen

pytestmark = NEEDS_BROWSER

from live_servers import free_port, until  # noqa: E402
from made_wall import MadeWall, curved_path  # noqa: E402
from tabs import Tabs  # noqa: E402

import helibore as hb  # noqa: E402
from helibore.logs.picks import Pick, Picks  # noqa: E402
from helibore.logs.zones import classify  # noqa: E402

SEAM = 16384  # first vertex of the second tile
ADDRESS = "#md=1025.6&sec=6&camera=outside"
SIZE = (1000, 640)  # pixels: software GL has fewer to draw
SERVED = """
import sys
sys.path.insert(0, sys.argv[1])
from made_wall import MadeWall, curved_path
import helibore as hb
wall = MadeWall(40_000)
wall.patch(16_000, 17_000, float(sys.argv[3]))
hb.view(wall, path=curved_path(), port=int(sys.argv[2]), token="s3").wait()
"""

SERVED_PICKS = """
import sys
import helibore as hb
from helibore.logs.picks import Picks
wall = hb.reconstruct(hb.Caliper.gauge(1015.0, 1035.0, 0.2), bit_diameter=0.2, sectors=16)
wall.picks = Picks.load(sys.argv[2])
hb.view(wall, port=int(sys.argv[1]), token="s3", picks_file=sys.argv[2]).wait()
"""

# How many frames the page has drawn, and the radii it then holds of what came while it was hidden.
CAUGHT_UP = """() => {
  const { app, stats } = window.__wall;
  const radius = [];
  for (let k = 41000; k < 100000; k += 777) radius.push(app.store.vertex(k)?.radius ?? NaN);
  return { frames: stats.frames, bytes: stats.bytes, radius: radius.map((r) => (Number.isNaN(r) ? null : r)) };
}"""


def alike(screen: Any) -> None:
    """Give both pages of a comparison the same colours and the same eye, and no glow."""
    screen.evaluate("window.__wall.app.selection.setColours({ low: -0.002, high: 0.03 })")
    screen.evaluate("window.__wall.app.glow.ranges.length = 0")
    screen.evaluate("window.__wall.fit()")
    screen.settle()


def shows_what_a_new_page_shows(browser: Any, screen: Any, url: str, *scripts: str) -> None:
    """Check that a page has the numbers of these scripts and the pixels that a page opened now has."""
    new = Screen(browser, url, ADDRESS, SIZE)
    new.settle()
    for script in scripts:
        assert screen.evaluate(script) == pytest.approx(new.evaluate(script), abs=1e-6, nan_ok=True), script
    for one in (screen, new):
        alike(one)
    for part in ("image", "wall"):
        want = new.pixels(part)
        assert len(np.unique(want.reshape(-1, 4), axis=0)) > 50, "a picture, not a blank"
        np.testing.assert_array_equal(screen.pixels(part), want)
    new.close()


def test_a_hidden_page_catches_up_at_once() -> None:
    wall = MadeWall(40_000)
    with hb.view(wall, path=curved_path()) as viewer, Tabs(viewer.url) as page:
        until(lambda: page.evaluate("Boolean(window.__wall?.ready)"))
        until(lambda: page.evaluate("window.__wall.app.figures.summary !== null"))
        until(lambda: page.evaluate("!window.__wall.app.figures.pending"))
        page.evaluate(
            "(() => { window.asked = 0; const ask = window.requestAnimationFrame.bind(window);"
            " window.requestAnimationFrame = (draw) => { window.asked++; return ask(draw); }; })()"
        )
        page.hide()
        before = page.evaluate("window.__wall.stats")
        for _ in range(60):  # a minute at 1,000 quads a second, only faster
            viewer.update(wall.grow(1000))
            time.sleep(0.02)
        until(lambda: page.evaluate("window.__wall.stats.size") == 100_000)
        turns = len(classify(wall).logs)  # found after the last append, and then sent to the page
        until(
            lambda: (
                len(viewer._feed._zones.logs) == turns
                and viewer.scene.state.curves[0]["version"] == viewer._feed._logged
            )
        )
        until(
            lambda: (
                page.evaluate("window.__wall.app.curves.offered[0]?.version")
                == sum(row["version"] for row in viewer.scene.state.curves)
            )
        )
        assert page.evaluate("window.__wall.stats.frames") == before["frames"], "nothing is drawn for nobody"
        assert page.evaluate("window.asked") <= 1, (
            "one frame waits, however much has arrived; it may have been asked before"
        )
        page.show()
        until(lambda: page.evaluate("window.__wall.stats.frames") > before["frames"])
        caught = page.evaluate(f"({CAUGHT_UP})()")
        # One; another for the row of the alarm of a new zone; and what glows fades, up to five times a second.
        assert 1 <= caught["frames"] - before["frames"] < 20, "not one for each of the 60 appends"
        np.testing.assert_allclose(caught["radius"], wall.radius[np.arange(41_000, 100_000, 777)], atol=5.1e-6)
        assert caught["bytes"] - before["bytes"] < 20 * 60_000


def served(port: int, patch: float) -> AbstractContextManager[str]:
    """Serve a wall from a process of its own, which is killed at the end."""
    return run(port, SERVED, str(ROOT / "tests" / "python"), str(port), str(patch))


@contextmanager
def run(port: int, script: str, *values: str) -> Iterator[str]:
    process = subprocess.Popen([sys.executable, "-c", script, *values])
    url = f"http://127.0.0.1:{port}/?token=s3"
    try:
        until(lambda: process.poll() is not None or answers(url))
        assert process.poll() is None, "the server did not start"
        yield url
    finally:
        process.kill()
        process.wait(PATIENCE)


def answers(url: str) -> bool:
    try:
        with urllib.request.urlopen(url.replace("/?", "/healthz?"), timeout=5):
            return True
    except (urllib.error.URLError, OSError):
        return False


def test_a_killed_server_is_found_again_when_it_is_back(browser: Any) -> None:
    port = free_port()
    with served(port, 0.0) as url:
        screen = Screen(browser, url, ADDRESS, SIZE)
        screen.settle()
    screen.until("document.getElementById('lamp').className === 'lamp lost'")
    assert screen.evaluate("document.getElementById('lampText').textContent") == "Connection lost, trying again"
    with served(port, 0.01) as url:
        screen.until("document.getElementById('lamp').className !== 'lamp lost'")
        screen.until(f"window.__wall.app.store.vertex({SEAM})?.radius > 0.115")
        assert round(screen.evaluate("window.__wall.app.view.middle"), 6) == 1025.6
        shows_what_a_new_page_shows(browser, screen, url)
        screen.close()


def test_picks_made_while_the_server_is_away_are_saved_when_it_is_back(browser: Any, tmp_path: Path) -> None:
    port, file = free_port(), tmp_path / "a.wall.picks.csv"
    Picks([Pick(kind="bed", depth=1024.0 + i, toolface=40.0, apparent_dip=60.0) for i in range(3)]).save(file)
    kept = "window.__wall.app.picking.kept.map(({ depth }) => Math.round(depth)).sort().join()"
    with run(port, SERVED_PICKS, str(port), str(file)) as url:
        screen = Screen(browser, url, ADDRESS, SIZE, drawn=False)
        screen.until(f"{kept} === '1024,1025,1026'")
        screen.keyboard.press("d")
    screen.until("document.getElementById('lamp').className === 'lamp lost'")
    screen.evaluate(
        "(({ picking }) => { picking.put({ ...picking.kept[0], key: 'new', depth: 1027 });"
        " picking.put({ ...picking.kept[1], note: 'changed' }); picking.remove(picking.kept[2]); })(window.__wall.app)"
    )
    screen.until("document.getElementById('dipSaved').textContent === '3 changes not saved'")
    stays = "window.dispatchEvent(new Event('beforeunload', { cancelable: true }))"
    assert screen.evaluate(stays) is False, "the browser asks before it leaves the page"
    with run(port, SERVED_PICKS, str(port), str(file)):
        screen.until("document.getElementById('dipSaved').textContent === 'saved in a.wall.picks.csv'")
        assert screen.evaluate(kept) == "1024,1025,1027"
        assert screen.evaluate(stays) is True
        assert [(round(one.depth), one.note) for one in Picks.load(file)] == [(1024, ""), (1025, "changed"), (1027, "")]
        screen.keyboard.press("Control+z")
        screen.until(f"{kept} === '1024,1025,1026,1027'")
        screen.close()


def test_a_rescan_over_a_seam_and_a_corrected_survey_are_drawn_in_place(browser: Any) -> None:
    wall = MadeWall(40_000)
    with hb.view(wall, path=curved_path()) as viewer:
        screen = Screen(browser, viewer.url, ADDRESS, SIZE)
        alike(screen)
        first = {part: screen.pixels(part) for part in ("image", "wall")}
        viewer.update(wall.patch(SEAM - 200, SEAM + 200, 0.01))
        screen.until(f"window.__wall.app.store.vertex({SEAM + 199})?.radius > 0.115")
        held = [SEAM - 201, SEAM - 200, SEAM - 1, SEAM, SEAM + 199, SEAM + 200]
        radius = screen.evaluate(f"{held}.map((k) => window.__wall.app.store.vertex(k).radius)")
        np.testing.assert_allclose(radius, wall.radius[held], atol=5.1e-6)
        tiles = "window.__wall.app.store.levels[0].tiles"
        halo = screen.evaluate(f"[...{tiles}.get(0).texels.slice(4 * {SEAM}, 4 * {SEAM} + 260)]")
        assert halo == screen.evaluate(f"[...{tiles}.get(1).texels.slice(0, 260)]"), "the halo is the next tile's start"
        shows_what_a_new_page_shows(browser, screen, viewer.url)
        assert not np.array_equal(screen.pixels("image"), first["image"])
        patched = screen.pixels("wall")
        viewer.set_path(hb.Survey([900.0, 2000.0], [60.0, 60.0], [200.0, 200.0]).path())
        screen.until("Math.abs(window.__wall.app.path.at(1010).tangent[2] - 0.5) < 1e-3")
        shows_what_a_new_page_shows(browser, screen, viewer.url)
        assert not np.array_equal(screen.pixels("wall"), patched)
        screen.close()


def test_provisional_vertices_are_dotted_until_they_settle(browser: Any) -> None:
    wall = MadeWall(20_000)
    top, bottom = 1024.0, 1026.0
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, ADDRESS, SIZE)
        alike(screen)
        plain = screen.pixels("image")
        shown = (wall.depth >= top) & (wall.depth < bottom)
        wall.provisional[shown] = True
        viewer.update(None)
        k = int(np.flatnonzero(shown)[70])
        screen.until(f"window.__wall.app.store.vertex({k}).state & 0x200")
        alike(screen)
        differs = (screen.pixels("image") != plain).any(axis=-1)
        depth = 1022.6 + 6 * (np.arange(len(differs)) + 0.5) / len(differs)
        inside, outside = (depth > top + 0.15) & (depth < bottom - 0.05), (depth < top - 0.05) | (depth > bottom + 0.15)
        assert not differs[outside].any()
        assert 0.2 < differs[inside].mean() < 0.3, "two by two of four by four pixels"
        wall.provisional[:] = False
        viewer.update(None)
        screen.until(f"!(window.__wall.app.store.vertex({k}).state & 0x200)")
        alike(screen)
        np.testing.assert_array_equal(screen.pixels("image"), plain)
        screen.close()

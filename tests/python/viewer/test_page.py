"""The page in a real browser: what it draws, sends and survives.

Every test opens its own page. Pixels are read back from the page's own canvas.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any
from urllib.parse import urlsplit

import numpy as np
import pytest
from made_wall import MadeWall, curved_path, gamma_and_resistivity
from patience import PATIENCE
from screen import NEEDS_BROWSER, Screen, new_tab

import helibore as hb

pytestmark = NEEDS_BROWSER


@pytest.fixture
def shown(browser: Any) -> Iterator[Any]:
    wall = MadeWall(40_000)
    with hb.view(wall, path=curved_path(), attributes=gamma_and_resistivity(wall), well="Made-1") as viewer:
        screen = Screen(browser, viewer.url, "#md=1012&sec=24")
        screen.wall, screen.viewer = wall, viewer
        yield screen
        screen.close()


def test_hover_says_what_the_wall_says(shown: Any) -> None:
    shown.settle()
    rect = shown.evaluate("window.__wall.app.renderer.rects.image")
    stage = shown.evaluate("(({left, top}) => ({left, top}))(document.getElementById('stage').getBoundingClientRect())")
    wall = shown.wall
    for x, y in ((0.21, 0.3), (0.5, 0.52), (0.83, 0.9)):
        shown.mouse.move(
            stage["left"] + rect["left"] + x * rect["width"], stage["top"] + rect["top"] + y * rect["height"]
        )
        shown.settle()
        cursor = shown.evaluate("window.__wall.app.view.cursor")
        k = shown.evaluate("window.__wall.app.renderer.vertex?.k ?? -1")
        text = shown.readout()
        assert text["MD"] == f"{cursor['depth']:.2f} m"
        if k < 0:
            assert text["Radius"] == "no data"
            continue
        assert abs(cursor["depth"] - wall.depth[k]) <= 0.05 + 0.05 / 64 + 1e-9
        assert abs((cursor["toolface"] - wall.toolface[k] + 180) % 360 - 180) <= 180 / 64 + 1e-9
        assert text["Radius"] == f"{round(wall.radius[k], 5) * 1000:.2f} mm"
        assert text["Samples used"] == str(wall.support[k])
        assert text["Nearest sample"] == f"{round(wall.nearest[k], 4) * 1000:.1f} mm"
        quad = shown.evaluate(f"window.__wall.app.store.levels[0].quadAt({cursor['depth']}, {cursor['toolface']})")
        gr = next(iter(gamma_and_resistivity(wall).values()))[quad]
        assert float(text["GR"].removesuffix(" gAPI")) == float(f"{gr:.5g}")


def test_gaps_are_hatched_grey_and_nothing_else_is(shown: Any) -> None:
    shown.settle()
    image = shown.pixels("image")[..., :3].astype(int)
    rows = np.linspace(1000, 1024, len(image), endpoint=False)
    grey = (abs(image - image[..., :1]).max(axis=-1) <= 2) & (image[..., 0] > 140) & (image[..., 0] < 225)
    gap = (rows > 1012.15) & (rows < 1012.45)
    assert grey[gap].all()
    assert not grey[(rows > 1002) & (rows < 1011)].any()
    hole = shown.pixels("wall")[..., :3].astype(int)
    middle, bit = hole.shape[1] // 2, int(0.2 * hole.shape[1])
    across = hole[gap, middle - bit + 3 : middle + bit - 3]
    assert (abs(across - across[..., :1]).max(axis=-1) <= 2).all(), "hatched at bit size on the straightened hole"
    assert set(np.unique(across)) == {158, 204}


def test_tiles_join_without_a_crack(browser: Any) -> None:
    wall = MadeWall(40_000)
    with hb.view(wall, path=curved_path()) as viewer:
        screen = Screen(browser, viewer.url, "#md=1025.6&sec=6&quantity=radius")
        screen.settle()
        background = [0xF4, 0xF5, 0xF6]
        image = screen.pixels("image")[2:-2, 2:-2, :3]
        assert not (image == background).all(axis=-1).any()
        tube = screen.pixels("wall")[..., :3]
        hole = (tube == background).all(axis=-1)
        for row in hole[200:500]:
            wide = np.flatnonzero(~row)
            assert len(wide) == 0 or not row[wide[0] : wide[-1] + 1].any(), "background shows through the wall"
        screen.close()


# From then on, what glows does not fade: a picture shows it as it was when it came, however long the picture takes.
AS_THEY_COME = """(({ glow }) => {
  const on = glow.on.bind(glow);
  Object.assign(glow, { on: (tile) => on(tile, glow.ranges.at(-1)?.at), fade: () => false });
})(window.__wall.app)"""


def test_new_quads_glow_and_cost_few_bytes(shown: Any) -> None:
    shown.evaluate("window.__wall.app.selection.follow(true)")
    shown.until("window.__wall.app.zones.length")
    shown.settle()
    before = shown.stats()["bytes"]
    shown.evaluate(AS_THEY_COME)
    shown.viewer.update(shown.wall.grow(1000))
    shown.until("window.__wall.stats.size === 41000")
    image = shown.pixels("image")[..., :3].astype(int)
    magenta = (image[..., 0] > 150) & (image[..., 2] > 120) & (image[..., 1] < 90)
    assert magenta.any()
    shown.settle()
    assert shown.stats()["bytes"] - before <= 16 * 1000, "the overview and the heads included"


def test_looking_differently_sends_nothing(shown: Any) -> None:
    shown.settle()
    before = shown.stats()
    views = []
    for change in (
        "selection.setQuantity('RES')",
        "selection.setColours({map: 'cividis'})",
        "selection.setColours({dynamic: true})",
        "view.choose({shape: 5, tube: 20, median: 3})",
        "view.choose({cut: 'north', units: 'in', theme: 'dark'})",
        "view.show(1008, 12, window.__wall.app.store)",
    ):
        shown.evaluate(f"window.__wall.app.{change}")
        views.append(shown.pixels("image").tobytes())
    after = shown.stats()
    assert (after["bytes"], after["sent"]) == (before["bytes"], before["sent"])
    assert len(set(views)) >= 5, "and each is another picture"


# Pans by five frames; resolves to what was written though it was so already: element and attribute.
WRITTEN_AGAIN = """new Promise((done) => {
  const { view, store } = window.__wall.app;
  const again = ({ oldValue, target, attributeName: name }) => oldValue === target.getAttribute(name);
  const found = [];
  const take = (records) => found.push(...records.filter(again).map((one) => `${one.target.id} ${one.attributeName}`));
  const written = new MutationObserver(take);
  written.observe(document, { subtree: true, attributes: true, attributeOldValue: true });
  const step = (frames) => {
    if (!frames) return done([...new Set(found)]);
    view.show(view.top + 0.1, view.length, store);
    return requestAnimationFrame(() => step(frames - 1));
  };
  step(5);
})"""


def test_panning_writes_no_attribute_that_has_its_value_already(shown: Any) -> None:
    shown.settle()
    again = shown.evaluate(WRITTEN_AGAIN)
    assert set(again) <= {"printAll href"}, "the browser finds the style of such an element anew, in every frame"


def test_nothing_is_asked_of_another_machine(shown: Any) -> None:
    shown.settle()
    assert shown.requests
    own = urlsplit(shown.viewer.url).netloc
    assert [url for url in shown.requests if own not in url and not url.startswith("data:")] == []


def test_the_picture_comes_back_after_context_loss(shown: Any) -> None:
    shown.settle()
    before = shown.pixels("image"), shown.pixels("wall")
    shown.evaluate("window.lose = window.__wall.app.renderer.gpu.gl.getExtension('WEBGL_lose_context')")
    shown.evaluate("window.lose.loseContext()")
    shown.until("window.__wall.app.renderer.gpu.gl.isContextLost()")
    shown.evaluate("window.lose.restoreContext()")
    shown.until("!window.__wall.app.renderer.gpu.gl.isContextLost()")
    shown.settle()
    np.testing.assert_array_equal(shown.pixels("image"), before[0])
    np.testing.assert_array_equal(shown.pixels("wall"), before[1])


def test_a_message_that_cannot_be_read_is_said_and_the_page_comes_right(browser: Any) -> None:
    page = new_tab(browser)
    page.set_viewport_size({"width": 1000, "height": 640})
    sent = []

    def between(socket: Any) -> None:
        server = socket.connect_to_server()

        def pass_on(message: Any) -> None:
            if isinstance(message, bytes) and not sent:
                sent.append(len(message))
                message = message[:-3]
            socket.send(message)

        server.on_message(pass_on)

    with hb.view(MadeWall(20_000)) as viewer:
        page.route_web_socket("**/ws?*", between)
        page.add_init_script(
            "new MutationObserver(() => { const at = document.getElementById('connection');"
            " if (at && !at.hidden) (window.said ??= []).push(at.textContent); })"
            ".observe(document, { subtree: true, childList: true, attributes: true });"
        )
        page.goto(viewer.url + "#md=1010&sec=10")
        end = time.monotonic() + PATIENCE
        while not page.evaluate("Boolean(window.__wall?.ready)"):
            assert time.monotonic() < end
            time.sleep(0.05)
        assert page.evaluate("window.said")[0] == (
            "The server sent what this page cannot read, trying again: "
            f"message of {sent[0] - 3} bytes: its head says {sent[0]}"
        )
        assert not page.is_visible("#connection")
        page.close()


def test_a_browser_that_stores_nothing_shows_the_page(browser: Any) -> None:
    page = new_tab(browser)
    page.set_viewport_size({"width": 1000, "height": 640})
    with hb.view(MadeWall(20_000)) as viewer:
        page.add_init_script(
            "for (const name of ['localStorage', 'sessionStorage']) Object.defineProperty(window, name,"
            " { get() { throw new DOMException('Access is denied for this document.', 'SecurityError'); } });"
        )
        page.goto(viewer.url)
        end = time.monotonic() + PATIENCE
        while not page.evaluate("Boolean(window.__wall?.ready)"):
            assert time.monotonic() < end
            time.sleep(0.05)
        page.close()


@pytest.mark.parametrize("size", [(1366, 768), (1920, 1080)])
def test_everything_fits_on_the_screen(browser: Any, size: tuple[int, int]) -> None:
    wall = MadeWall(30_000)
    with hb.view(wall, attributes=gamma_and_resistivity(wall)) as viewer:
        screen = Screen(browser, viewer.url, "", size, drawn=False)
        screen.settle()
        overflow = screen.evaluate(
            "[...document.querySelectorAll('#bar, main, aside')]"
            ".map((e) => [e.id || e.tagName, e.scrollWidth - e.clientWidth])"
        )
        assert [name for name, extra in overflow if extra > 0] == []
        assert screen.evaluate(
            "document.querySelector('aside').scrollHeight <= document.querySelector('aside').clientHeight"
        )
        screen.close()

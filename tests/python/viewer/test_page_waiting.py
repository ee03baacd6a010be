"""A page that was there first: before the first sample, before the first survey, before the server was started anew.

Each comes right, or says why not, without being opened again.
"""

from __future__ import annotations

from typing import Any

import pytest
from made_wall import MadeWall, curved_path
from screen import NEEDS_BROWSER, Screen, new_tab

import helibore as hb

pytestmark = NEEDS_BROWSER

from test_page_recovery import ADDRESS, SIZE, free_port, shows_what_a_new_page_shows  # noqa: E402

from helibore.base.identity import Access  # noqa: E402
from helibore.viewer.feed import Feed  # noqa: E402
from helibore.viewer.page_server import PageServer  # noqa: E402
from helibore.viewer.scene import Scene  # noqa: E402

WORDS = "document.getElementById('connection').textContent"
EYE = "window.__wall.app.renderer.gpu.outside.position"


class Waiting(Screen):
    """A page that has nothing to show yet."""

    def until(self, condition: str) -> None:
        super().until("window.__wall" if condition == "window.__wall?.ready" else condition)


@pytest.mark.parametrize("size", [(390, 844), (768, 1024), (1366, 768)])
def test_rig_mode_says_in_large_type_within_the_window_why_it_waits(browser: Any, size: tuple[int, int]) -> None:
    scene = Scene()
    server = PageServer(scene, Access())
    scene.update_state(
        sources="rig: listening, since 20:34:15 UTC.\n0 samples received.\n"
        "Check that the sender of rig runs and sends to port 9973 of this machine."
    )
    screen = Waiting(browser, server.url, "#rig=1" if size[0] < 600 else "", size, drawn=False)
    if size[0] == 1366:
        screen.keyboard.press("k")
    elif size[0] == 768:
        screen.click("#rigOpen")
    screen.until(f"{WORDS}.includes('port 9973') && document.body.classList.contains('rig')")
    box = screen.locator("#connection").bounding_box()
    assert box["x"] >= 0
    assert box["y"] >= 0
    assert box["x"] + box["width"] <= size[0]
    assert box["y"] + box["height"] <= size[1]
    type_size = float(screen.evaluate("getComputedStyle(document.getElementById('connection')).fontSize")[:-2])
    assert type_size >= (17 if size[0] < 600 else 30)
    assert screen.evaluate(
        "(({ scrollHeight, clientHeight }) => scrollHeight <= clientHeight)(document.getElementById('connection'))"
    )
    screen.close()
    server.close()


def labels(screen: Screen) -> set[str]:
    return {one["text"] for one in screen.evaluate("document.getElementById('ink').labels")}


def test_a_page_opened_before_the_first_sample_waits_and_then_shows_the_wall(browser: Any) -> None:
    scene = Scene()
    server = PageServer(scene, Access())
    scene.update_state(sources="mwd: listening. 0 samples received.")
    screen = Waiting(browser, server.url, f"{ADDRESS}&theme=dark", SIZE)
    screen.until(f"{WORDS} === 'Waiting for the first samples.\\nmwd: listening. 0 samples received.'")
    assert screen.is_visible("#connection")
    assert screen.inner_text("#lampText") == "waiting"
    assert not any(screen.is_visible(part) for part in ("aside", "#foot", "#follow", "#pass"))
    assert screen.evaluate("document.documentElement.className") == "dark"
    scene.update_state(
        sources="mwd: connected to 127.0.0.1. 12 samples received, 12 wait for their depth.", bit_depth=1031.0
    )
    screen.until(f"{WORDS}.endsWith('12 samples received, 12 wait for their depth.')")
    scene.update_state(lost=("mwd",))
    screen.until("document.getElementById('lampText').textContent === 'waiting for mwd to connect'")
    assert screen.evaluate("document.getElementById('lamp').className") == "lamp late"
    scene.update_state(lost=())
    for key in "f[hidrc1 p":
        screen.keyboard.press(key)
    feed = Feed(MadeWall(40_000), path=curved_path(), attributes={}, well="Made-1", scene=scene)
    feed.start()
    screen.until("window.__wall.ready")
    assert not screen.is_visible("#connection")
    assert screen.is_visible("aside")
    assert screen.is_visible("#wallHead")
    assert screen.inner_text("#well") == "Made-1"
    screen.settle()
    screen.evaluate("window.__wall.app.view.choose({ theme: 'light' })")
    shows_what_a_new_page_shows(browser, screen, server.url)
    screen.close()
    feed.close()
    server.close()


def test_the_first_survey_places_a_page_that_was_open_before_it(browser: Any) -> None:
    with hb.view(MadeWall(40_000)) as viewer:
        screen = Screen(browser, viewer.url, ADDRESS, SIZE)
        screen.settle()
        assert {"no survey", "90°", "180°", "270°"} < labels(screen)
        assert not {"TVD m", "N", "U", "up"} & labels(screen)
        for path in (curved_path(), None, hb.Survey([900.0, 2000.0], [60.0, 60.0], [200.0, 200.0]).path()):
            viewer.set_path(path)
            screen.until(f"window.__wall.app.path.surveyed === {'true' if path else 'false'}")
            screen.settle()
            assert ("no TVD" in labels(screen)) == ("U" in labels(screen)) == bool(path), (
                "the surveys begin in the hole"
            )
            assert ("no survey" in labels(screen)) != bool(path)
            cuts = screen.evaluate(
                "[...document.getElementById('cut').options].filter((o) => !o.hidden).map((o) => o.text)"
            )
            assert ("U-R-D-L-U: cut at high side" in cuts) == bool(path)
            assert (cuts == ["cut at 0° of the tool", "cut at 180° of the tool"]) != bool(path)
            shows_what_a_new_page_shows(browser, screen, viewer.url, EYE, "window.__wall.app.path.tvd(1025)")
        screen.close()


def test_a_page_with_the_token_of_before_says_so_and_lives_again_with_the_right_one(browser: Any) -> None:
    port = free_port()
    with hb.view(MadeWall(20_000), port=port, token="first") as viewer:
        screen = Screen(browser, viewer.url, "#md=1010&sec=10", SIZE, drawn=False)
        screen.settle()
    screen.until("document.getElementById('lampText').textContent === 'The server was stopped, trying again'")
    assert not screen.is_visible("#connection")
    with hb.view(MadeWall(20_000), port=port, token="second") as viewer:
        screen.until("document.getElementById('lampText').textContent.startsWith('The server refused')")
        assert screen.inner_text("#connection") == (
            "The server refused this page: token: missing or wrong. Open the address that helibore printed, with its "
            "?token=..."
        )
        assert "lost" in screen.evaluate("document.getElementById('lamp').className")
        other = new_tab(browser)
        assert other.goto(viewer.url.replace("second", "wrong")).status == 403
        assert other.inner_text("body").strip() == (
            "token: missing or wrong. Open the address that helibore printed, with its ?token=..."
        )
        other.close()
    with hb.view(MadeWall(20_064), port=port, token="first"):
        screen.until("window.__wall.stats.size === 20064")
        assert not screen.is_visible("#connection")
        assert screen.evaluate("document.getElementById('lamp').className") == "lamp "
        screen.close()

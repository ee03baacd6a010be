"""The page at five sizes of window: nothing is cut, nothing covers another, no control is out of reach."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from made_wall import MadeWall, curved_path
from screen import NEEDS_BROWSER, Screen

import helibore as hb
from helibore.logs.picks import Pick

pytestmark = NEEDS_BROWSER

SIZES = [(1920, 1080), (1366, 768), (1024, 768), (820, 1180), (390, 844)]
OUT_OF_REACH = """[...document.querySelectorAll('button, select, input, canvas, #foot a, aside')]
  .filter((e) => e.checkVisibility() && !e.closest('aside > *, .unseen'))
  .map((e) => [e.id || e.textContent, e.getBoundingClientRect()])
  .filter(([, { left, right, bottom }]) => left < -0.5 || right > innerWidth + 0.5 || bottom > innerHeight + 0.5)
  .map(([name]) => name)"""


@pytest.fixture(scope="module")
def viewer() -> Iterator[Any]:
    """A hole on a path that was planned, with tops, a pick, and an image with thinner rows than the wall."""
    wall = MadeWall(60_000)
    wall.intervals = (hb.Interval("Draupne Fm", 1003.0, 1012.0), hb.Interval("Heather Fm", 1012.0, 1030.0))
    rows = {hb.Attribute("AMP", rows=(1000.0, 0.005)): np.arange(60_000) % 50.0}
    plan = hb.Survey([970.0, 1100.0], [38.0, 38.0], [70.0, 70.0]).path(extend=1000.0)
    with hb.view(wall, path=curved_path(), attributes=rows, plan=plan, well="Made-1 T2") as viewer:
        viewer.scene.intervals = wall.intervals
        pick = Pick(kind="fracture", depth=1008.0, toolface=40.0, apparent_dip=40.0)
        viewer.scene.change_picks(lambda picks: picks.put(pick))
        yield viewer


def outside(screen: Screen, canvas: str) -> list[str]:
    """Return the texts that leave a canvas."""
    labels, wide, tall = screen.evaluate(f"[{canvas}.labels, {canvas}.clientWidth, {canvas}.clientHeight]")
    return [
        one["text"]
        for one in labels
        if one["left"] < 0 or one["top"] < 0 or one["right"] > wide + 0.5 or one["bottom"] > tall
    ]


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("camera", ["straight", "outside", "down"])
def test_no_text_is_cut_or_covered_and_no_control_out_of_reach(
    browser: Any, viewer: Any, size: tuple[int, int], camera: str
) -> None:
    tab = "&tab=3d" if size[0] < 1000 and camera != "straight" else ""
    screen = Screen(browser, viewer.url, f"#md=1008&sec=20&camera={camera}{tab}&at=1011_40", size, drawn=False)
    screen.until("document.getElementById('ink').labels.some(({ text }) => /^(Draupne|Heather) Fm/.test(text))")
    screen.settle()
    assert screen.touching("ink") == []
    labels = screen.evaluate("ink.labels")
    for plan in (one for one in labels if one["text"] == "plan, N up"):
        left, right, top, bottom = plan["left"] - 1, plan["left"] + 92, plan["top"], plan["bottom"] + 92
        hidden = [
            one["text"]
            for one in labels
            if one["left"] < right and left < one["right"] and one["top"] < bottom and top < one["bottom"]
        ]
        assert [text for text in hidden if "Fm" in text or "/" in text] == [], "below the plan"
    assert outside(screen, "ink") == []
    assert screen.evaluate(OUT_OF_REACH) == []
    assert screen.cut_selects() == []
    screen.close()


@pytest.mark.parametrize("size", SIZES[:3])
def test_a_long_value_of_the_read_out_does_not_break_the_names_by_words(
    browser: Any, viewer: Any, size: tuple[int, int]
) -> None:
    screen = Screen(browser, viewer.url, "#md=1008&sec=20", size, drawn=False)
    screen.settle()
    screen.evaluate("readout.lastElementChild.textContent = 'does not pass: −40.5 mm (−41.3 to −39.7 mm, 95 %)'")
    lines = screen.evaluate(
        "[...document.querySelectorAll('#readout dt')].map((e) => [e.textContent,"
        " (() => { const r = document.createRange(); r.selectNodeContents(e); return r.getClientRects().length; })()])"
    )
    assert len(lines) > 8
    assert [one for one in lines if one[1] > 2] == []
    screen.close()


@pytest.mark.parametrize("size", SIZES[:3])
def test_an_image_names_its_unit_however_narrow_it_is(browser: Any, viewer: Any, size: tuple[int, int]) -> None:
    screen = Screen(browser, viewer.url, "#md=1008&sec=20&camera=outside", size, drawn=False)
    screen.settle()
    heads = [one["text"] for one in screen.evaluate("ink.labels") if one["text"].startswith("Over bit")]
    assert heads
    assert all(text.endswith(" [mm]") for text in heads)
    screen.close()


def test_the_bar_of_a_phones_scale_stands_above_the_words(browser: Any, viewer: Any) -> None:
    screen = Screen(browser, viewer.url, "#md=1008&sec=20&camera=outside&tab=3d", SIZES[-1], drawn=False)
    screen.until("ink.labels.some(({ text }) => text.includes('from the planned path'))")
    screen.settle()
    labels = screen.evaluate("ink.labels")
    words = min(one["top"] for one in labels if "hole ×" in one["text"])
    left = screen.evaluate("window.__wall.app.renderer.rects.wall.left")
    bars = [one for one in labels if one["text"].endswith(" m") and abs(one["left"] - left - 104) < 2]
    assert bars
    assert all(one["bottom"] < words for one in bars)
    screen.close()


def test_a_narrow_section_names_the_angles_above_and_below_it_alone(browser: Any) -> None:
    with hb.view(MadeWall(20_000)) as viewer:
        screen = Screen(browser, viewer.url, "#md=1008&sec=12", (1024, 768), drawn=False)
        screen.settle()
        labels, strokes = screen.evaluate("[polar.labels.map(({ text }) => text), polar.strokes]")
        assert {"0°", "180°"} <= set(labels)
        assert not {"90°", "270°"} & set(labels)
        across = [x for x0, _, x1, _ in strokes for x in (x0, x1)]
        assert max(across) - min(across) > 90, "its outer ring"
        screen.close()


@pytest.mark.parametrize("size", SIZES)
def test_no_column_of_the_list_of_zones_leaves_its_place(browser: Any, size: tuple[int, int]) -> None:
    wall = MadeWall(60_000)
    wall.radius[(wall.depth > 1023.0) & (wall.depth < 1025.0)] += 0.06
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, "#tab=zones" if size[0] < 1000 else "", size, drawn=False)
        screen.until("window.__wall.app.zones.some(({ measure }) => measure > 0.1)")
        screen.settle()
        assert re.search(r"[+]1\d\d$", screen.evaluate("zones.children[1].children[3].textContent"))
        wider = (
            "[...zones.querySelectorAll('span')].filter((e) => e.scrollWidth > e.clientWidth).map((e) => e.textContent)"
        )
        assert screen.evaluate(wider) == []
        screen.close()


def test_where_the_sizes_of_zones_have_no_room_the_worst_has_its_own(browser: Any) -> None:
    wall = MadeWall(60_000)
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, "#md=1047&sec=500", SIZES[1], drawn=False)
        screen.until("window.__wall.app.zones.length === 4")
        screen.settle()
        sizes = {one["text"] for one in screen.evaluate("ink.labels") if re.match("[WB] [+]", one["text"])}
        assert sizes == {"W +42", "W +41", "B +31"}, "a breakout beside a washout gives way"
        screen.close()


def test_a_phone_says_how_much_of_a_turn_without_a_zone_is_measured(browser: Any) -> None:
    """Nobody shall take hole that was not measured for hole without a zone."""
    caliper = hb.Caliper.gauge(2000.0, 2010.0, 0.216)
    away = abs(caliper.depth - 2005.0) > 1.5
    seen = hb.Caliper(caliper.depth[away], caliper.toolface[away], caliper.radius[away])
    with hb.view(hb.reconstruct(seen, bit_diameter=0.216, sectors=16)) as viewer:
        said = set()
        for depth in (2002.0, 2005.0):
            screen = Screen(browser, viewer.url, f"#at={depth}_10&sec=10", SIZES[-1], drawn=False)
            screen.settle()
            said.add(screen.inner_text("#briefZone"))
            screen.close()
        assert said == {"no zone, 100 % of the turn measured", "no zone, 0 % of the turn measured"}

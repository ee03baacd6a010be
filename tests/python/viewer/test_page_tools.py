"""The page's tools in a real browser: replay, picked dips, the camera inside the hole, the address, exported files."""

from __future__ import annotations

import base64
import itertools
import json
import math
import re
import struct
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from made_wall import BIT, MadeWall, curved_path, gamma_and_resistivity
from patience import PATIENCE
from screen import NEEDS_BROWSER, Screen, new_tab

import helibore as hb
from helibore.cli.view_command import section_printer
from helibore.logs.curves import ScalarCurve
from helibore.logs.picks import Pick, Picks, plane
from helibore.settings.template import Template, TemplateTrack

pytestmark = NEEDS_BROWSER

DIPS = "window.__wall.app.picking.planes().kept.map(({ dip, azimuth }) => [dip, azimuth])"


CLOCK = r"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d (UTC|[+−]\d\d:\d\d)"
"""A time with its day and its distance from UTC."""


@pytest.fixture(scope="module")
def viewer() -> Iterator[Any]:
    wall = MadeWall(40_000)
    with hb.view(wall, path=curved_path(), attributes=gamma_and_resistivity(wall), well="Made-1") as viewer:
        yield viewer


@contextmanager
def picked_fracture() -> Iterator[Any]:
    """Show a wall with the pick F1 at 1018 m."""
    with hb.view(MadeWall(60_000), path=curved_path()) as viewer:
        pick = Pick(kind="fracture", depth=1018.0, toolface=40.0, apparent_dip=40.0, note="F1")
        viewer.scene.change_picks(lambda picks: picks.put(pick))
        yield viewer


def place(screen: Screen, toolface: float, depth: float) -> tuple[float, float]:
    """Where a wall point is on the image track, in the window."""
    x, y = screen.evaluate(
        "([toolface, depth]) => { const { app } = window.__wall; const { image } = app.renderer.rects;"
        " const { left, top } = document.getElementById('stage').getBoundingClientRect();"
        " const dial = app.path.dial(depth); const zero = dial.up ?? 0;"
        " const turn = (((toolface - zero) % 360) + 360) % 360 / 360;"
        " return [left + image.left + turn * image.width,"
        "   top + image.top + (depth - app.view.top) / app.view.length * image.height]; }",
        [toolface, depth],
    )
    return float(x), float(y)


def test_picked_points_give_the_bed_that_was_made(browser: Any, viewer: Any) -> None:
    """The made beds lie at depth + 0.6 cos(toolface - 40) = constant, deepest at toolface 220."""
    screen = Screen(browser, viewer.url, "#md=1009&sec=6&quantity=GR", drawn=False)
    screen.keyboard.press("d")
    screen.settle()
    assert screen.is_visible("#dips")
    assert screen.inner_text("#dipSaved") == "not saved in a file"
    radii = []
    for toolface in (10, 80, 150, 220, 300):
        depth = 1009 - 0.6 * math.cos(math.radians(toolface - 40))
        screen.mouse.click(*place(screen, toolface, depth))
        radii.append(screen.evaluate("window.__wall.app.picking.points.at(-1).radius"))
    plane = screen.evaluate(
        "(({ apparent, deepest, misfit, depth }) => ({ apparent, deepest, misfit, depth }))"
        "(window.__wall.app.picking.planes().current)"
    )
    assert plane["apparent"] == pytest.approx(math.degrees(math.atan(0.6 / np.mean(radii))), abs=1.0)
    assert (plane["deepest"] - 220 + 180) % 360 - 180 == pytest.approx(0, abs=3)
    assert plane["depth"] == pytest.approx(1009, abs=0.03)
    assert plane["misfit"] < 0.03
    screen.keyboard.press("Enter")
    screen.until("window.__wall.app.picking.kept.length")
    screen.settle()
    assert screen.inner_text("#dipText").endswith("1 plane, 0 breakouts.")
    labels = [one["text"] for one in screen.evaluate("document.getElementById('ink').labels")]
    assert {"True", "dip [°]", "0", "30", "60", "90"} <= set(labels)
    assert "bed" in labels, "the legend of the classes in view"
    assert "fault" not in labels
    unstated = "from a north that is not stated (path.north states it)"
    assert screen.inner_text("#netText") == f"1 pole, lower hemisphere; rose: dip azimuths {unstated}"
    with screen.expect_download() as saved:
        screen.click("#dipSave")
    rows = Path(saved.value.path()).read_text().splitlines()
    assert float(rows[1].split(",")[3]) == pytest.approx(plane["apparent"], abs=0.01)
    (pick,) = viewer.scene.picks
    assert pick.dip(viewer.scene.path) == pytest.approx(screen.evaluate(DIPS)[0], abs=0.2)
    assert screen.evaluate("window.__wall.app.picking.selected") == pick.key, "a new pick is selected"
    screen.keyboard.press("Escape")
    screen.mouse.click(*place(screen, 130, pick.depth))
    screen.until("window.__wall.app.picking.pick")
    screen.keyboard.press("Escape")
    assert screen.evaluate("window.__wall.app.picking.pick") is None
    assert screen.is_visible("#dips"), "the first Esc deselects"
    screen.keyboard.press("Escape")
    assert not screen.is_visible("#dips")
    again = Screen(browser, viewer.url, screen.address(), drawn=False)
    again.until("window.__wall.app.picking.kept.length")
    np.testing.assert_allclose(again.evaluate(DIPS), screen.evaluate(DIPS), atol=1e-6)
    again.close()
    screen.close()
    viewer.scene.change_picks(Picks.clear)


def test_the_page_says_which_north_the_dip_azimuths_count_from(browser: Any) -> None:
    path = hb.Survey([900.0, 2000.0], [30.0, 30.0], [200.0, 200.0], north="grid").path()
    with hb.view(MadeWall(20_000), path=path) as viewer:
        viewer.scene.change_picks(lambda picks: picks.put(Pick(kind="bed", depth=1012.0, toolface=0.0)))
        screen = Screen(browser, viewer.url, "#md=1012&sec=6", drawn=False)
        screen.until("document.getElementById('netText').textContent.endsWith('dip azimuths from grid north')")
        screen.close()


def test_a_drag_moves_the_selected_pick_alone_and_says_so(browser: Any) -> None:
    bed = hb.Pick(kind="bed", depth=1010.0, apparent_dip=0.0, toolface=0.0)
    with hb.view(MadeWall(30_000), path=curved_path()) as viewer:
        viewer.scene.change_picks(lambda picks: picks.put(bed))
        screen = Screen(browser, viewer.url, "#md=1010&sec=2", drawn=False)
        screen.until("window.__wall.app.picking.kept.length")
        screen.keyboard.press("d")
        screen.settle()

        def drag(start: float, stop: float) -> None:
            screen.mouse.move(*place(screen, 90, start))
            screen.mouse.down()
            for depth in np.linspace(start, stop, 4):
                screen.mouse.move(*place(screen, 92 if start != stop else 60, depth))
            screen.mouse.up()
            screen.settle()

        screen.evaluate("window.__wall.app.picking.setClass('breakout')")
        drag(1010.0, 1010.4)
        assert [(pick.kind, pick.depth) for pick in viewer.scene.picks] == [("bed", 1010.0)]
        screen.mouse.click(*place(screen, 90, 1010.0))
        screen.settle()
        drag(1010.0, 1010.4)
        (pick,) = viewer.scene.picks
        assert pick.depth == pytest.approx(1010.4, abs=0.02)
        assert "bed at 1010.40 m: moved by 0.40 m" in screen.inner_text("#notice")
        screen.mouse.click(*place(screen, 0, pick.depth))
        screen.settle()
        assert screen.evaluate("window.__wall.app.picking.selected") == pick.key, (
            "a press on a handle deselects nothing"
        )
        x, y = place(screen, 90, pick.depth)
        screen.mouse.move(x, y)
        screen.mouse.down()
        screen.mouse.move(x + 2, y + 2)
        screen.mouse.up()
        screen.settle()
        assert screen.evaluate("window.__wall.app.picking.selected") == pick.key, "nor does one on its body"
        assert screen.inner_text("#dipText").splitlines()[-2].endswith("A new pick begins off it.")
        screen.keyboard.press("2")
        screen.settle()
        assert "was a bed" in screen.inner_text("#notice")
        assert screen.input_value("#pickClass") == "fracture"
        screen.keyboard.press("Escape")
        screen.settle()
        assert screen.input_value("#pickClass") == "fracture", "the next one is of this class, too"
        screen.keyboard.press("5")
        screen.settle()
        assert screen.inner_text("#dipText").startswith("Next fault (1 to 6): ")
        assert [pick.kind for pick in viewer.scene.picks] == ["fracture"], "no pick is selected, so only the next one"
        screen.evaluate("(key) => { window.__wall.app.picking.selected = key; }", pick.key)
        screen.evaluate("window.__wall.app.view.show(1020, 2, window.__wall.app.store)")
        screen.keyboard.press("1")
        screen.settle()
        assert [pick.kind for pick in viewer.scene.picks] == ["fracture"], "nor does one change that is out of view"
        assert screen.evaluate("[window.__wall.app.picking.selected, window.__wall.app.picking.kind]") == [None, "bed"]
        screen.close()


def test_a_steep_plane_is_drawn_where_it_reaches_the_section_and_costs_nothing_where_it_does_not(browser: Any) -> None:
    steep = hb.Pick(kind="fracture", depth=1010.0, apparent_dip=85.0, toolface=90.0)  # reaches 1.2 m up and down
    with hb.view(MadeWall(30_000), path=curved_path()) as viewer:
        viewer.scene.change_picks(lambda picks: picks.put(steep))
        screen = Screen(browser, viewer.url, "#md=1010&sec=1", (1366, 768), drawn=False)
        screen.until("window.__wall.app.picking.kept.length")
        picture = "document.getElementById('ink').toDataURL()"
        tried = {}
        for middle in (1010.0, 1011.05, 1013.0):
            screen.evaluate(
                "((top, { app }) => (delete app.picking.plane(app.picking.kept[0]).curve,"
                f" app.view.show(top, 1, app.store), app.redraw()))({middle - 0.5}, window.__wall)"
            )
            screen.settle()
            with_plane = screen.evaluate(picture)
            computed = screen.evaluate("'curve' in window.__wall.app.picking.plane(window.__wall.app.picking.kept[0])")
            screen.evaluate("(window.__wall.app.picking.kept = [], window.__wall.app.redraw())")
            screen.settle()
            tried[middle] = (screen.evaluate(picture) != with_plane, computed)
            screen.evaluate("window.__wall.app.picking.show()")
            screen.settle()
        assert tried == {1010.0: (True, True), 1011.05: (True, True), 1013.0: (tried[1013.0][0], False)}
        screen.evaluate("window.__wall.app.view.show(1009.5, 1, window.__wall.app.store)")
        screen.settle()
        curve = "window.__wall.app.picking.plane(window.__wall.app.picking.kept[0]).curve.depths"
        across = screen.evaluate(curve)
        assert max(across) - min(across) == pytest.approx(2 * 0.108 * np.tan(np.radians(85)), rel=0.1)
        viewer.set_path(hb.Survey([900.0, 2000.0], [30.0, 30.0], [200.0, 200.0]).path())
        screen.until("window.__wall.app.path.version > 1")
        screen.settle()
        assert screen.evaluate(curve) != across, "another path, another curve"
        screen.close()


def test_replay_shows_the_wall_as_it_was_and_comes_back(browser: Any) -> None:
    wall = MadeWall(12_000)
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url)
        screen.keyboard.press("r")
        screen.until("!document.getElementById('notice').hidden")
        assert screen.inner_text("#notice").startswith("Nothing to replay")
        viewer.scene.history.note(viewer.scene.history.as_columns()["time"][0] + 0.001, 12_001, 1019.0)
        viewer.update(wall.grow(8_000))
        screen.until("window.__wall.stats.size === 20000")
        screen.settle()
        now = screen.pixels("image")
        screen.keyboard.press("r")
        screen.until("window.__wall.app.replay.past")
        screen.evaluate("(() => { const { replay } = window.__wall.app; replay.show(replay.points.time[0]); })()")
        assert screen.evaluate("window.__wall.app.store.end") == pytest.approx(1000 + 11_999 * 0.1 / 64)
        screen.settle()
        assert not np.array_equal(screen.pixels("image"), now)
        assert re.search(rf"as at {CLOCK} ", screen.inner_text("#lampText"))
        assert "first pass" in screen.inner_text("#lampText")
        run = "document.getElementById('run')"
        screen.until(f"{run}.labels?.some(({{ text }}) => text.endsWith('- - data'))")
        at = screen.evaluate(f"{run}.strokes.map(([x]) => x)")
        assert at == [0], "the moment, at the start of the run"
        texts = [one["text"] for one in screen.evaluate(f"{run}.labels")]
        assert {"1018.7 m", "1031.2 m"} <= set(texts), "from the data at the start to their end"
        screen.page.set_viewport_size({"width": 390, "height": 844})
        screen.until(f"(({{ left, right }}) => left > 0 && right < 390)({run}.getBoundingClientRect())")
        screen.page.set_viewport_size({"width": 1000, "height": 640})
        screen.settle()
        assert screen.evaluate("window.__wall.app.store.vertex(12100)") is None
        viewer.update(wall.grow(64))
        screen.until("window.__wall.stats.size === 20064")
        assert screen.evaluate("window.__wall.app.store.end") == pytest.approx(1000 + 11_999 * 0.1 / 64)
        screen.click("#live")
        assert screen.evaluate("window.__wall.app.store.end") == pytest.approx(1000 + 20_063 * 0.1 / 64)
        screen.until("document.getElementById('pass').value === 'latest'")
        screen.close()


def test_the_camera_inside_sees_the_wall_and_the_gap(browser: Any, viewer: Any) -> None:
    screen = Screen(browser, viewer.url, "#md=1012&sec=6&camera=outside", (1366, 768))
    screen.keyboard.press("i")
    screen.until("document.getElementById('camera').value === 'down'")
    screen.settle()
    inside = screen.pixels("wall")[80:-40, :, :3].astype(int)
    unlit = (inside.max(axis=-1) <= 12).mean()
    assert 0.0005 < unlit < 0.1, "the wall is all around, the gap too; nothing is beyond the reach of the lamp"
    rows, columns = np.indices(inside.shape[:2])
    far = np.hypot(rows - inside.shape[0] / 2, columns - inside.shape[1] / 2)
    light = [inside[(far > r) & (far < r + 20)].mean() for r in (30, 60, 150)]
    assert light[0] < light[1] < light[2], "lit from the eye"
    labels = [one["text"] for one in screen.evaluate("document.getElementById('ink').labels")]
    assert any(text.startswith("inside, down   high side up   true to scale") for text in labels)
    assert any(text.startswith("10") and text.endswith(" m") for text in labels), "rings have their depths"
    up = screen.evaluate(
        "(() => { const { app } = window.__wall; const d = app.view.top + 2;"
        " const { gpu, rects } = app.renderer;"
        " const at = (t) => gpu.project({ centre: app.path.at(d).centre.map((x, i) => x"
        "   + 0.1 * (Math.cos(t) * app.path.at(d).high[i] + Math.sin(t) * app.path.at(d).right[i])) }, rects.wall);"
        " const dial = app.path.dial(d).up * Math.PI / 180;"
        " return [at(dial), at(dial + Math.PI / 2), at(dial + Math.PI)]; })()"
    )
    assert up[0][1] < up[1][1] < up[2][1], "high side up"
    assert up[1][0] > up[0][0], "looking down the hole, toolface grows clockwise"
    box = screen.evaluate(
        "(({ left, top, width, height }) => [left + width / 2, top + height / 2])"
        "(document.getElementById('orbit').getBoundingClientRect())"
    )
    top = screen.evaluate("window.__wall.app.view.top")
    screen.mouse.move(*box)
    screen.mouse.wheel(0, 100)
    screen.until(f"window.__wall.app.view.top > {top + 0.1}")
    for key, way in (("ArrowUp", 1), ("ArrowDown", -1)):
        top = screen.evaluate("window.__wall.app.view.top")
        screen.keyboard.press(key)
        assert (screen.evaluate("window.__wall.app.view.top") - top) * way == pytest.approx(0.15), "up: ahead"
    assert screen.inner_text("#fly") == "Fly"
    screen.keyboard.press("v")
    assert screen.inner_text("#fly") == "Stop"
    screen.until(f"window.__wall.app.view.top > {top + 0.5}")
    screen.click("#fly")
    assert screen.inner_text("#fly") == "Fly"
    screen.keyboard.press("v")
    screen.evaluate("window.__wall.app.view.choose({ camera: 'outside' })")
    screen.until("document.getElementById('fly').textContent === 'Fly'")  # only inside
    screen.evaluate("window.__wall.app.view.choose({ camera: 'up' })")
    screen.keyboard.press("i")
    screen.until("document.getElementById('camera').value === 'straight'")
    screen.close()


def test_a_deep_groove_is_dark_from_inside_and_its_lip_is_not_paler_than_the_wall(browser: Any) -> None:
    """Of one colour everywhere: what differs is light. The lamp shines straight on the far side of the groove."""
    wall = MadeWall(40_000, pitch=0.01)
    wall.radius = np.where(
        np.abs(wall.depth - 1001.5) < 0.012, BIT / 2 + 0.045, BIT / 2 + 1e-4 * np.sin(40 * wall.depth)
    )
    with hb.view(wall, path=curved_path()) as viewer:
        address = "#md=1002&sec=2&camera=down&tube=1&quantity=over&range=-9_9&at=1001.5"
        screen = Screen(browser, viewer.url, address, (1366, 768))
        screen.settle()
        light = screen.pixels("wall")[:, :, :3].mean(axis=-1)
        places = (
            "(({ path, store, renderer: { gpu, rects: { wall } } }, depth) => {"
            " const { centre, high } = path.at(depth);"
            " const [x, y] = gpu.project({ centre: centre.map((one, i) => one - store.bitRadius * high[i]) }, wall);"
            " return [x - wall.left, y - wall.top]; })(window.__wall.app, %f)"
        )
        (x, above), (_, rim), (_, below) = (screen.evaluate(places % depth) for depth in (1001.40, 1001.48, 1001.6))
        smooth = light[round(rim) + 6 : round(above), round(x)].max()
        groove = light[round(below) : round(rim), round(x)]
        assert groove.min() < 0.5 * smooth
        assert groove.max() < 1.25 * smooth, "a wall that faces the lamp is at most so much lighter"
        screen.close()


def test_a_cleft_is_darker_from_inside_the_deeper_it_is(browser: Any) -> None:
    """Of one colour everywhere; seen is the far side of the cleft, which faces the lamp."""
    address = "#md=1002&sec=2&camera=down&quantity=over&range=-900_900&at=1001.5&tab=3d"
    places = (
        "(({ path, store, renderer: { gpu, rects: { wall } } }) => {"
        " const at = (depth) => { const { centre, high } = path.at(depth);"
        "  return gpu.project({ centre: centre.map((one, i) => one - store.bitRadius * high[i]) }, wall); };"
        " const [x] = at(1001.5);"
        " const quarter = (3 * at(1001.488)[1] + at(1001.512)[1]) / 4;"
        " return [x - wall.left - 20, quarter, at(1001.56)[1]]; })(window.__wall.app)"
    )
    light = []
    for depth in (0.001, 0.006, 0.045):
        wall = MadeWall(80_000, pitch=0.005)
        wall.radius = BIT / 2 + np.where(np.abs(wall.depth - 1001.5) < 0.012, depth, 0.0)
        with hb.view(wall, path=curved_path()) as viewer:
            screen = Screen(browser, viewer.url, address, (1366, 768))
            screen.settle()
            pixels = screen.pixels("wall")[:, :, :3].mean(axis=-1)
            x, cleft, beside = (round(one) for one in screen.evaluate(places))
            light.append(pixels[cleft, x] / pixels[beside, x])
            screen.close()
    assert light == sorted(light, reverse=True)
    assert light[0] > 0.75
    assert 0.12 < light[-1] < 0.45, "its ground is dark, and seen"


def test_the_ground_of_a_key_seat_is_no_dark_line_from_inside(browser: Any) -> None:
    """Of one colour everywhere. The groove of a pipe of 120 mm is no cleft: its ground is as light as its sides."""
    wall = MadeWall(80_000, pitch=0.005)
    away = np.radians((wall.toolface + 180) % 360 - 180)
    middle = BIT / 2 + 0.030 - 0.060
    chord = 0.060**2 - (middle * np.sin(away)) ** 2
    groove = middle * np.cos(away) + np.sqrt(np.maximum(chord, 0.0))
    wall.radius = np.where((chord > 0) & (np.cos(away) > 0), np.maximum(BIT / 2, groove), BIT / 2)
    with hb.view(wall, path=curved_path()) as viewer:
        screen = Screen(
            browser, viewer.url, "#md=1002&sec=2&camera=down&quantity=over&range=-900_900&tab=3d", (1366, 768)
        )
        screen.settle()
        light = screen.pixels("wall")[:, :, :3].mean(axis=-1)
        x, y = (round(one) for one in screen.evaluate(WALL_PLACE % (0.0, 1001.5)))
        beside = round(screen.evaluate(WALL_PLACE % (12.0, 1001.5))[0])
        screen.close()
    assert light[y, x] > 0.9 * light[y, beside]


# Where a place of the wall is on the 3-D view, from a toolface and a depth.
WALL_PLACE = (
    "(({ path, store, renderer: { gpu, rects: { wall } } }, toolface, depth) => {"
    " const { centre, high, right } = path.at(depth); const t = (toolface * Math.PI) / 180;"
    " const at = centre.map((x, i) => x + store.bitRadius * (Math.cos(t) * high[i] + Math.sin(t) * right[i]));"
    " const [x, y] = gpu.project({ centre: at }, wall); return [x - wall.left, y - wall.top]; })"
    "(window.__wall.app, %f, %f)"
)


def test_a_closed_fracture_is_dark_from_inside_under_the_colours_of_radii(browser: Any) -> None:
    """The wall is smooth; the image is dark in the fracture, noisy elsewhere, and has an edge that is no line."""
    wall = MadeWall(80_000, pitch=0.005)
    wall.radius = np.full(len(wall), BIT / 2 + 0.001)
    rng = np.random.default_rng(45)
    amplitude = 60 + 12 * (wall.depth > 1002.2) + rng.normal(0, 1.5, len(wall))
    away = np.abs(wall.depth - 1001.6 - 0.06 * np.cos(np.radians(wall.toolface - 200)))
    amplitude = amplitude - 40 * np.exp(-((away / 0.008) ** 2))
    seen = {}
    for name, image in (("AMP", amplitude), ("PLAIN", np.full(len(wall), 60.0))):
        with hb.view(wall, path=curved_path(), attributes={hb.Attribute(name, "dB"): image}) as viewer:
            address = "#md=1002&sec=2&camera=down&quantity=over&beside=&at=1001.6&tab=3d"
            screen = Screen(browser, viewer.url, address, (1366, 768))
            screen.until(f"ink.labels.some(({{ text }}) => text.includes('dark and light by {name}'))")
            screen.settle()
            light = screen.pixels("wall")[:, :, :3].mean(axis=-1)
            found = []
            for toolface in (20, 110, 200, 290):
                trace = 1001.6 + 0.06 * math.cos(math.radians(toolface - 200))
                on, *off = (
                    light[round(y) - 1 : round(y) + 2, round(x) - 1 : round(x) + 2].mean()
                    for x, y in (screen.evaluate(WALL_PLACE % (toolface, trace + by)) for by in (0.0, -0.08, 0.08))
                )
                found.append(on / np.mean(off))
            x, y = screen.evaluate(WALL_PLACE % (20, 1002.2))
            edge = light[round(y) - 4 : round(y) + 5, round(x) - 1 : round(x) + 2].mean(axis=1)
            seen[name] = (max(found), np.ptp(edge) / edge.mean())
            screen.close()
    assert seen["PLAIN"][0] == pytest.approx(1, abs=0.12)
    assert seen["AMP"][0] < 0.6, "all around the hole"
    assert seen["AMP"][1] < seen["PLAIN"][1] + 0.1, "the edge is no line"


def test_an_open_fracture_is_lit_from_inside_under_its_dark_image(browser: Any) -> None:
    """It crosses the seam of two tiles at 1001.28 m, and the image is darkest in it."""
    wall = MadeWall(80_000, pitch=0.005)
    trace = 1001.31 + 0.1 * np.cos(np.radians(wall.toolface - 200))
    away = np.abs(wall.depth - trace)
    wall.radius = BIT / 2 + 0.03 * np.clip((0.021 - away) / 0.006, 0, 1)
    amplitude = np.where(away < 0.018, 5.0, 60.0)
    image = {hb.Attribute("AMP", "dB", 5, 80): amplitude}
    with hb.view(wall, path=curved_path(), attributes=image) as viewer:
        for quantity in ("over", "AMP"):
            address = f"#md=1001.5&sec=2&camera=down&quantity={quantity}&at=1001.22_200&tab=3d"
            screen = Screen(browser, viewer.url, address, (1366, 768))
            screen.settle()
            light = screen.pixels("wall")[:, :, :3].mean(axis=-1)
            found = []
            for toolface in range(0, 360, 15):
                depth = 1001.31 + 0.1 * math.cos(math.radians(toolface - 200))
                ground, beside = (
                    light[round(y) - 1 : round(y) + 2, round(x) - 1 : round(x) + 2].mean()
                    for x, y in (screen.evaluate(WALL_PLACE % (toolface, depth + by)) for by in (-0.01, 0.06))
                )
                found.append(ground / beside)
            assert min(found) > 0.12, f"no black hole under {quantity}"
            assert max(found) < 0.6, "nor a light block where tiles meet"
            screen.close()


def test_no_light_slab_is_beside_a_closed_fracture_at_the_seam_of_two_tiles(browser: Any) -> None:
    """Beyond the seam at 1001.28 m are other values than those before it, in reverse order."""
    wall = MadeWall(40_000, pitch=0.005)
    wall.radius = np.full(len(wall), BIT / 2 + 0.001)
    amplitude = 60 - 40 * np.exp(-(((wall.depth - 1001.33) / 0.008) ** 2))
    with hb.view(wall, path=curved_path(), attributes={hb.Attribute("AMP", "dB", 20, 80): amplitude}) as viewer:
        address = "#md=1001.9&sec=2&camera=down&quantity=over&beside=&tab=3d"
        screen = Screen(browser, viewer.url, address, (1366, 768))
        screen.until("ink.labels.some(({ text }) => text.includes('dark and light by AMP'))")
        screen.settle()
        light = screen.pixels("wall")[:, :, :3].mean(axis=-1)
        for toolface in (20, 110, 290):
            on, before, after = (
                light[round(y) - 1 : round(y) + 2, round(x) - 1 : round(x) + 2].mean()
                for x, y in (screen.evaluate(WALL_PLACE % (toolface, depth)) for depth in (1001.33, 1001.285, 1001.25))
            )
            assert on < 0.7 * before
            assert before == pytest.approx(after, rel=0.08)
        screen.close()


def test_dips_stand_beside_their_traces_and_in_one_form_in_the_list_of_a_picture(browser: Any) -> None:
    """With intervals they are twice as long as without, and traces are steep at the right end of the image."""
    with hb.view(MadeWall(60_000), path=curved_path()) as viewer:
        for depth, kind in ((1015.0, "bed"), (1018.1, "induced fracture"), (1021.0, "fault")):
            pick = Pick(kind=kind, depth=depth, toolface=70.0, apparent_dip=65.0, dip_sigma=3.0, toolface_sigma=8.0)
            viewer.scene.change_picks(lambda picks, pick=pick: picks.put(pick))
        screen = Screen(browser, viewer.url, "#md=1018.1&sec=2", (1600, 1000), drawn=False)
        screen.until("window.__wall.app.picking.kept.length === 3")
        screen.settle()
        form = r"\d+ ± \d+ / \d{3} ± \d+"
        image, view, planes, labels = screen.evaluate(
            "(({ renderer: { rects: { image } }, view, picking }) => [image, [view.top, view.length],"
            " picking.planes().kept.flatMap(({ curve }) => (curve ? [curve.depths] : [])), ink.labels])"
            "(window.__wall.app)"
        )
        named = [one for one in labels if re.fullmatch(form, one["text"])]
        assert len(named) == len(planes) == 1
        for i, depth in enumerate(planes[0]):
            x, y = image["left"] + 3 * i, image["top"] + (depth - view[0]) / view[1] * image["height"]
            assert not (named[0]["left"] < x < named[0]["right"] and named[0]["top"] < y < named[0]["bottom"])
        screen.evaluate("window.__wall.app.view.show(1014, 8, window.__wall.app.store)")
        screen.settle()
        screen.evaluate(
            "(() => { window.__said = []; const { prototype } = CanvasRenderingContext2D;"
            " const write = prototype.fillText; prototype.fillText = function (...of) {"
            " window.__said.push(of[0]); return write.apply(this, of); }; })()"
        )
        with screen.page.expect_download():
            screen.click("#png")
        said = screen.evaluate("window.__said")
        assert len([text for text in said if re.fullmatch(form, text)]) >= 6, "on the image and in the list"
        assert not [text for text in said if "toward" in text or ("±" in text and "…" in text)]
        screen.close()


def test_on_its_path_angles_that_have_no_room_beside_their_disc_stand_in_another_row_whole(browser: Any) -> None:
    depth = np.arange(1228.0, 1235.0, 0.01)
    path = hb.Survey([1180.0, 1270.0], [34.0, 37.0], [20.0, 22.0]).path()
    wall = hb.reconstruct(
        hb.Caliper(depth, depth * 3600 % 360, np.full(depth.size, 0.109)), bit_diameter=0.2159, sectors=32
    )
    for bed in (1228.9, 1229.2, 1233.8):
        wall.picks.append(replace(plane("bed", bed, 11.0, 102.0, path), dip_sigma=0.6, toolface_sigma=1.7))
    with hb.view(wall, path=path) as viewer:
        address = "#md=1231.4&sec=6&camera=outside"
        screen = Screen(browser, viewer.url, address, (1366, 768), drawn=False)
        screen.until("globalThis.more")
        screen.settle()
        left = screen.evaluate("window.__wall.app.renderer.rects.wall.left")
        labels = screen.evaluate("ink.labels")
        screen.close()
    beside = [one["text"] for one in labels if one["left"] > left and "±" in one["text"]]
    assert beside
    assert not [text for text in beside if "95 %" not in text and not re.fullmatch(r"11 ± \d+ / 102 ± \d+", text)]


def test_a_trace_is_thin_and_that_of_the_selected_pick_two_lines_beside_what_it_marks(browser: Any) -> None:
    """At its deepest point a trace is level: how opaque the ink is there, from 8 pixels above to 8 below."""
    across = (
        "([x, y]) => { const ink = document.getElementById('ink'); const { left, top } = ink.getBoundingClientRect();"
        " const ratio = ink.width / ink.clientWidth; const high = Math.round(16 * ratio);"
        " const { data } = ink.getContext('2d').getImageData("
        "  Math.round((x - left) * ratio), Math.round((y - top - 8) * ratio), 1, high);"
        " return Array.from({ length: high }, (_, i) => data[4 * i + 3] / 255); }"
    )
    with picked_fracture() as viewer:
        screen = Screen(browser, viewer.url, "#md=1018.1&sec=4", drawn=False)
        screen.keyboard.press("d")
        screen.settle()
        at = place(screen, 40, 1018 + BIT / 2 * math.tan(math.radians(40)))
        rows = [np.array(screen.evaluate(across, [at[0] + dx, at[1]])) for dx in range(-6, 7)]
        assert 0 < max(np.count_nonzero(row[4:-4] > 0.75) for row in rows) <= 2, "its dashes"
        screen.mouse.click(*at)
        screen.until("window.__wall.app.picking.selected")
        screen.mouse.move(5, 5)
        screen.settle()
        row = np.array(screen.evaluate(across, list(at)))
        assert row[7:10].max() == 0, "what it marks is seen"
        assert row[2:6].max() > 0.9
        assert row[10:14].max() > 0.9
        screen.close()


def test_a_fracture_keeps_its_aperture_and_how_sure_its_dip_is(browser: Any) -> None:
    """At once, and after its crest was dragged; both stand in the table."""
    wall = MadeWall(80_000, pitch=0.005)
    trace = 1001.5 + 0.1 * np.cos(np.radians(wall.toolface - 200))
    wall.radius = BIT / 2 + np.where(np.abs(wall.depth - trace) < 0.01, 0.03, 0.0)
    wide = 0.02 * math.cos(math.atan(0.1 / (BIT / 2)))
    with hb.view(wall, path=curved_path()) as viewer:
        screen = Screen(browser, viewer.url, "#md=1001.5&sec=2", (1366, 768), drawn=False)
        screen.keyboard.press("d")
        screen.keyboard.press("2")
        screen.settle()
        for toolface in (20, 110, 200, 290):
            screen.mouse.click(*place(screen, toolface, 1001.5 + 0.1 * math.cos(math.radians(toolface - 200))))
        screen.settle()
        assert re.search(r"dip [0-9.]+° ± [1-9] toward [0-9]{3}° ± [1-9]", screen.inner_text("#dipText")), (
            "not kept yet"
        )
        screen.keyboard.press("Enter")
        screen.until("window.__wall.app.picking.kept.length === 1 && !window.__wall.app.picking.unsaved.size")
        screen.settle()
        assert re.search(r"aperture about 1\d mm, at least [23]\d mm deep", screen.inner_text("#dipText"))
        (pick,) = viewer.scene.picks
        assert pick.aperture == pytest.approx(wide, abs=0.004)
        assert 0.2 < pick.dip_sigma < 3
        shown = screen.evaluate(
            "(({ picking, path }) => more.marksOf(picking.planes().kept[0], path))(window.__wall.app)"
        )
        assert shown == [f" ± {math.ceil(half)}" for half in pick.dip_interval(curved_path())]
        with screen.expect_download() as saved:
            screen.click("#dipSave")
        names, row = (line.split(",") for line in Path(saved.value.path()).read_text().splitlines())
        assert float(row[names.index("APERTURE (m)")]) == pytest.approx(wide, abs=0.004)
        screen.evaluate("window.__wall.app.view.show(996.5, 12, window.__wall.app.store)")
        screen.settle()
        screen.keyboard.press("ArrowRight")
        screen.until("!window.__wall.app.picking.unsaved.size")
        screen.settle()
        (turned,) = viewer.scene.picks
        assert turned.toolface == pytest.approx(pick.toolface + 1)
        assert turned.dip_sigma > 3 * pick.dip_sigma, "by hand, with more of the hole in view"
        assert "coarse scale" in screen.inner_text("#dipText")
        screen.close()


def test_inside_noise_is_no_relief(browser: Any) -> None:
    """The same radii: what may be chance by their uncertainty is smooth, what is sure is seen."""
    wall = MadeWall(80_000, pitch=0.005)
    wall.radius = BIT / 2 + 3e-4 * np.sin(wall.depth * 200) * np.sin(np.radians(12 * wall.toolface))
    with hb.view(wall, path=curved_path()) as viewer:
        rough = []
        for sigma in (5e-5, 2e-3):
            viewer.scene.set_trust(np.zeros(len(wall), bool), np.full(len(wall), sigma))
            screen = Screen(
                browser, viewer.url, "#md=1002&sec=2&camera=down&quantity=over&range=-900_900&tab=3d", (1366, 768)
            )
            screen.settle()
            light = screen.pixels("wall")[100:-100, :, :3].mean(axis=-1)
            rough.append(np.abs(np.diff(light[:, 200:500], axis=1)).mean() / light[:, 200:500].mean())
            screen.close()
        assert rough[1] < 0.5 * rough[0]


def test_the_colours_below_the_dark_view_inside_are_those_of_the_wall(browser: Any, viewer: Any) -> None:
    """From inside, the wall has the colours of the light page: bit size is white."""
    address = "#md=1010&sec=10&tab=3d&theme=dark&quantity=over&camera="
    middle = (
        "(() => { const ink = document.getElementById('ink'); const ratio = ink.width / ink.clientWidth;"
        " const [low, high] = ink.labels.filter(({ text, bottom }) => /^[−0-9.]+$/.test(text)"
        "   && bottom > ink.clientHeight - 20).slice(-2);"
        " const x = (low.right + high.left) / 2; const y = (low.top + low.bottom) / 2;"
        " return [...ink.getContext('2d').getImageData(x * ratio, y * ratio, 1, 1).data]; })()"
    )
    for camera, light in (("outside", False), ("down", True)):
        screen = Screen(browser, viewer.url, address + camera, (1366, 768), drawn=False)
        screen.settle()
        assert (screen.evaluate(middle)[0] > 128) == light, camera
        screen.close()


def test_inside_is_true_to_scale_with_depths_however_long_the_section_is(browser: Any, viewer: Any) -> None:
    screen = Screen(browser, viewer.url, "#md=1015&sec=30&camera=down&tube=10&tab=3d", (1366, 768))
    screen.settle()
    assert screen.evaluate("window.__wall.app.view.tubeFactor(window.__wall.app.store)") == 1
    assert screen.is_hidden("#tube")
    screen.until("document.getElementById('ink').labels.some(({ text }) => text === '1000.5 m')")  # by the hole's size
    top = screen.evaluate("window.__wall.app.view.top")
    screen.keyboard.press("ArrowUp")
    assert screen.evaluate("window.__wall.app.view.top") - top == pytest.approx(1.5 * BIT / 2), "a step by it, too"
    screen.evaluate("window.__wall.app.view.choose({ camera: 'outside' })")
    assert screen.evaluate("window.__wall.app.view.tubeFactor(window.__wall.app.store)") == 10
    screen.close()


def test_picks_are_switched_off_where_curves_are_and_stay_so_in_the_address(browser: Any) -> None:
    with picked_fracture() as viewer:
        screen = Screen(browser, viewer.url, "#md=1018&sec=10&camera=down&at=1018_40", (1366, 768), drawn=False)
        named = "document.getElementById('ink').labels.filter(({ text }) => /^F1|fracture/.test(text)).length"
        eye = "window.__wall.app.renderer.gpu.camera.position"
        screen.until(f"{named} >= 3")
        before = screen.evaluate(eye)
        screen.select_option("#curve", label="✓ picks")
        screen.until(f"{named} === 0")
        assert screen.is_hidden("#netSection")
        assert not screen.evaluate("'dips' in window.__wall.app.renderer.rects"), "no track of dips"
        assert screen.evaluate(eye) == pytest.approx(before), "the eye stays before the fracture"
        address = screen.address()
        assert "picks=off" in address
        again = Screen(browser, viewer.url, address, (1366, 768), drawn=False)
        again.settle()
        assert again.evaluate(named) == 0
        again.keyboard.press("d")
        again.until(f"{named} > 0")
        again.close()
        screen.select_option("#curve", label="picks")
        screen.until(f"{named} >= 3")
        assert "picks=" not in screen.address()
        screen.close()


def test_inside_the_line_of_a_pick_lies_on_the_wall_as_in_the_log(browser: Any) -> None:
    with picked_fracture() as viewer:
        screen = Screen(browser, viewer.url, "#md=1018&sec=10&camera=down&at=1018&tab=3d", (1366, 768), drawn=False)
        screen.until("document.getElementById('ink').labels.some(({ text }) => text === 'F1')")
        covered = screen.evaluate(
            "(({ path, store, renderer: { gpu, rects: { wall } } }, slope) => {"
            " const { centre, high, right, tangent } = path.at(1018);"
            " const ink = document.getElementById('ink').getContext('2d');"
            " const share = (r) => Array.from({ length: 120 }, (_, i) => (3 * i * Math.PI) / 180).filter((t) => {"
            "  const [x, y] = [r * Math.cos(t), r * Math.sin(t)];"
            "  const z = slope * (x * Math.cos(0.698) + y * Math.sin(0.698));"
            "  const at = centre.map((one, j) => one + x * high[j] + y * right[j] + z * tangent[j]);"
            "  const [left, top] = gpu.project({ centre: at }, wall);"
            "  return ink.getImageData(left - 2, top - 2, 5, 5).data.some((one, j) => j % 4 === 3 && one > 120);"
            " }).length / 120;"
            " return [0.88, 1, 1.1].map((one) => share(one * store.bitRadius)); })"
            f"(window.__wall.app, {np.tan(np.radians(40.0))})"
        )
        assert covered[1] > 0.5, "the line, dashed"
        assert max(covered[::2]) < 0.15, "depths and the mark of the cursor alone"
        screen.close()


def test_inside_the_words_of_a_pick_stand_above_its_line_where_a_slide_has_no_room_below(browser: Any) -> None:
    """Below a line that fills the pane stand the compass and the words at the foot."""
    with hb.view(MadeWall(60_000), path=curved_path()) as viewer:
        pick = Pick(kind="fracture", depth=1018.0, toolface=200.0, apparent_dip=8.0)
        viewer.scene.change_picks(lambda picks: picks.put(pick))
        screen = Screen(browser, viewer.url, "#md=1018&sec=3&camera=down&at=1018_200", (1366, 768), drawn=False)
        screen.until("window.__wall.app.picking.kept.length === 1")
        screen.settle()
        labels = labels_of_slide(screen)
        words = [one for one in labels if re.match(r"fracture at|dip \d", one["text"])]
        (up,) = [one for one in labels if one["text"] == "U" and one["left"] > 500]
        assert len(words) == 2
        assert max(one["bottom"] for one in words) < up["top"], "above the hole's upper side"
        screen.close()


def test_inside_the_words_of_a_pick_leave_room_for_the_letters_of_the_sides(browser: Any) -> None:
    wall = hb.reconstruct(hb.Caliper.gauge(1860.0, 1865.0, 0.311), bit_diameter=0.311, sectors=32, pitch=0.05)
    wall.path = hb.Survey([1800.0, 1900.0], [38.0, 38.0], [142.0, 142.0], north="true").path()
    wall.picks.append(Pick(kind="fracture", depth=1862.4, toolface=271.0, apparent_dip=62.5))
    with hb.view(wall, path=wall.path) as viewer:
        address = "#md=1862.4&sec=2&camera=down&at=1862.4_0"
        screen = Screen(browser, viewer.url, address, (1600, 900), drawn=False)
        screen.until("window.__wall.app.picking.kept.length === 1")
        screen.settle()
        left = screen.evaluate("window.__wall.app.renderer.rects.wall.left")
        inside = [one for one in screen.evaluate("ink.labels") if one["left"] >= left]
        words = [one for one in inside if re.match(r"fracture at|dip \d", one["text"])]
        sides = [one for one in inside if one["text"] in ("U", "R", "D", "L")]
        assert (len(words), len(sides)) == (2, 4)
        for side, one in itertools.product(sides, words):
            across = side["left"] < one["right"] and one["left"] < side["right"]
            assert not (across and side["top"] < one["bottom"] and one["top"] < side["bottom"]), (side, one)
        screen.close()


def test_inside_the_long_name_of_a_pick_is_not_cut_by_the_pane(browser: Any) -> None:
    with hb.view(MadeWall(60_000), path=curved_path()) as viewer:
        name = "Open fracture with a long name that a geologist gave it"
        pick = Pick(kind="fracture", depth=1018.0, toolface=200.0, apparent_dip=50.0, note=name)
        viewer.scene.change_picks(lambda picks: picks.put(pick))
        viewer.scene.update_state(bit_depth=1019.0, newest=time.time())
        screen = Screen(browser, viewer.url, "#md=1018&sec=3&camera=down&at=1018_200", (1024, 768), drawn=False)
        screen.until("window.__wall.app.picking.kept.length === 1")
        screen.until("ink.labels.some(({ text, left }) => text.startsWith('Open fracture') && left > 400)")
        left, width = screen.evaluate("(({ wall }) => [wall.left, wall.width])(window.__wall.app.renderer.rects)")
        (one,) = [one for one in screen.evaluate("ink.labels") if one["text"].startswith("Open fracture")]
        assert left <= one["left"] < one["right"] <= left + width
        assert one["text"].endswith("…")
        screen.close()


def test_inside_a_top_without_a_pick_is_level(browser: Any) -> None:
    wall = MadeWall(60_000)
    wall.intervals = (hb.Interval("Draupne", 1018.0, 1030.0),)
    path = hb.Survey([970.0, 1100.0], [40.0, 40.0], [70.0, 70.0]).path(extend=100.0)
    with hb.view(wall, path=path) as viewer:
        viewer.scene.intervals = wall.intervals
        screen = Screen(browser, viewer.url, "#md=1020&sec=8&camera=down&at=1017.6&tab=3d", (1366, 768), drawn=False)
        screen.until("ink.labels.some(({ text }) => text === 'Draupne')")
        drawn = screen.evaluate(
            "(({ path, store, renderer: { gpu, rects: { wall } } }, rgb) => {"
            " const { centre, high, right, tangent } = path.at(1018);"
            " const ink = document.getElementById('ink').getContext('2d');"
            " const share = (level) => Array.from({ length: 60 }, (_, i) => (i * Math.PI) / 30).filter((t) => {"
            "  const [x, y] = [Math.cos(t), Math.sin(t)].map((one) => store.bitRadius * one);"
            "  const z = level ? -(x * high[2] + y * right[2]) / tangent[2] : 0;"
            "  const at = centre.map((one, j) => one + x * high[j] + y * right[j] + z * tangent[j]);"
            "  const [left, top] = gpu.project({ centre: at }, wall);"
            "  const { data } = ink.getImageData(left - 4, top - 4, 9, 9);"
            "  return Array.from({ length: 81 }, (_, k) => data.slice(4 * k, 4 * k + 4))"
            "   .some((one) => one[3] > 200 && rgb.every((value, c) => Math.abs(one[c] - value) < 25));"
            " }).length / 60;"
            " return [share(true), share(false)]; })(window.__wall.app, [0x19, 0x5b, 0x1f])"
        )
        assert drawn[0] > 0.7
        assert drawn[1] < 0.4, "not square to the hole"
        screen.close()


@pytest.mark.parametrize("size", [(1366, 768), (1024, 640)])
def test_the_legend_of_picks_begins_behind_the_colours_below_the_hole(browser: Any, size: tuple[int, int]) -> None:
    wall = MadeWall(12_800)
    name = "acoustic amplitude, normalised over the whole run"
    with hb.view(wall, attributes={hb.Attribute(name, "m"): np.linspace(0, 0.01, 12_800)}) as viewer:
        for kind in ("fracture", "bed"):
            pick = Pick(kind=kind, depth=1010.0, toolface=40.0, apparent_dip=10.0)
            viewer.scene.change_picks(lambda picks, pick=pick: picks.put(pick))
        screen = Screen(browser, viewer.url, "#md=1010&sec=6&camera=down&tab=3d", size, drawn=False)
        screen.evaluate(f"window.__wall.app.selection.setQuantity('{name}')")
        screen.settle()
        texts = [one["text"] for one in screen.evaluate("document.getElementById('ink').labels")]
        assert {"bed", "fracture"} & set(texts), "as many as there is room for"
        assert screen.touching("ink") == []
        screen.close()


def test_inside_the_eye_stands_before_the_held_cursor_and_no_pick_veils_the_wall(browser: Any) -> None:
    wall = MadeWall(60_000)
    with hb.view(wall, path=curved_path()) as viewer:
        screen = Screen(browser, viewer.url, "#md=1015&sec=10&camera=down", (1366, 768))
        screen.settle()
        bare = screen.evaluate("document.getElementById('ink').getContext('2d').getImageData(900, 300, 1, 1).data[3]")
        near = "(({ path, renderer: { gpu, rects } }) => gpu.project(path.at(%f), rects.wall))(window.__wall.app)"
        assert screen.evaluate(near % 1012.0), "from the top of the section"
        screen.evaluate("window.__wall.app.view.point({ depth: 1018, toolface: 20 }, true)")
        viewer.scene.change_picks(
            lambda picks: picks.put(replace(plane("fracture", 1018.0, 41.0, 35.0, curved_path()), aperture=0.0152))
        )
        screen.until("document.getElementById('ink').labels.some(({ text }) => /° toward /.test(text))")
        screen.settle()
        assert screen.evaluate(near % 1012.0) is None, "behind the eye"
        across = screen.evaluate(near % 1018.0)
        assert across, "before it"
        texts = [one["text"] for one in screen.evaluate("document.getElementById('ink').labels")]
        assert {"dip 41° toward 035°", "aperture about 15 mm"} <= set(texts)
        assert "dip / azimuth, north not stated" in " ".join(texts), "once on the picture"
        assert "fracture at 1018.00 m" in texts
        veil = screen.evaluate(
            "(([x, y]) => document.getElementById('ink').getContext('2d').getImageData(x, y, 1, 1).data[3])"
            f"([{across[0]} + 40, {across[1]} + 10])"
        )
        assert veil == bare == 0
        marked = screen.evaluate(
            "(({ path, renderer: { gpu, rects }, view }) => { const { cursor } = view;"
            " const { centre, high, right } = path.at(cursor.depth);"
            " const [c, s] = [Math.cos, Math.sin].map((f) => f((cursor.toolface * Math.PI) / 180));"
            " const r = window.__wall.app.store.bitRadius * view.tubeFactor(window.__wall.app.store);"
            " const spot = centre.map((x, i) => x + r * (c * high[i] + s * right[i]));"
            " const [left, top] = gpu.project({ centre: spot }, rects.wall);"
            " const { data } = document.getElementById('ink').getContext('2d')"
            "   .getImageData(left - 12, top - 12, 24, 24);"
            " return data.filter((x, i) => i % 4 === 3 && x > 200).length; })"
            "(window.__wall.app)"
        )
        assert marked > 50, "the held cursor is marked on the wall"
        eye = "(({ path, renderer: { gpu }, view }) => gpu.camera.position.map((x, i) => x + gpu.origin[i]))"
        before = screen.evaluate(f"{eye}(window.__wall.app)")
        top = screen.evaluate("window.__wall.app.view.top")
        screen.keyboard.press("Escape")
        screen.settle()
        assert not screen.evaluate("window.__wall.app.view.pinned")
        assert screen.evaluate(f"{eye}(window.__wall.app)") == pytest.approx(before, abs=1e-6), "Esc moves no eye"
        assert screen.evaluate("window.__wall.app.view.top") == top, "and no section"
        texts = [one["text"] for one in screen.evaluate("document.getElementById('ink').labels")]
        assert "fracture at 1018.00 m" in texts, "the nearest plane has the whole label"
        screen.evaluate("window.__wall.app.view.point({ depth: 1018, toolface: 20 }, true)")
        screen.settle()
        screen.keyboard.press("ArrowUp")
        assert screen.evaluate("[window.__wall.app.view.pinned, window.__wall.app.view.top > 1013]") == [False, True]
        screen.close()


def test_the_letters_of_the_sides_are_whole_inside(browser: Any, viewer: Any) -> None:
    screen = Screen(browser, viewer.url, "#md=1008&sec=2&camera=down&tube=1", (1920, 1080))
    for depth in np.arange(1007.5, 1008.5, 0.07):
        screen.evaluate(f"window.__wall.app.view.show({depth - 1}, 2, window.__wall.app.store)")
        screen.settle()
        wall, labels = screen.evaluate("[window.__wall.app.renderer.rects.wall, document.getElementById('ink').labels]")
        letters = [one for one in labels if one["text"] in "URDL" and one["left"] > wall["left"] and one["top"] > 80]
        assert sorted(one["text"] for one in letters) == ["D", "L", "R", "U"], depth
        assert all(one["bottom"] < wall["height"] - 20 for one in letters)
    screen.close()


@pytest.mark.parametrize("inclination", [50.0, 78.0])
def test_on_the_path_a_long_name_of_a_formation_is_in_the_pane_and_not_on_the_hole(
    browser: Any, inclination: float
) -> None:
    wall = MadeWall(40_000)
    wall.intervals = [hb.Interval("Kimmeridge Clay Formation, Upper Member", 1001.0, 1030.0)]
    depth = np.arange(900.0, 1300.0, 30.0)
    path = hb.Survey(depth, np.full(depth.size, inclination), np.full(depth.size, 60.0)).path()
    with hb.view(wall, path=path) as viewer:
        viewer.scene.intervals = tuple(wall.intervals)
        sure = {"dip_sigma": 0.6, "toolface_sigma": 1.0}
        long = Pick(
            kind="fracture", depth=1035.0, toolface=90.0, apparent_dip=50.0, note="Name of 30 letters, one more", **sure
        )
        viewer.scene.change_picks(lambda picks: picks.put(long))
        screen = Screen(browser, viewer.url, "#md=1025&sec=50&camera=outside", (1366, 768))
        screen.settle()
        found = screen.evaluate("""(() => {
          const { renderer: { gpu, rects: { wall } }, path, view, store } = window.__wall.app;
          const radius = store.bitRadius * view.tubeFactor(store);
          const at = (depth) => [-0.9, 0, 0.9].map((side) => {
            const frame = path.at(depth);
            return gpu.project(frame, wall, gpu.aside(frame, side * radius));
          });
          const hole = Array.from({ length: 500 }, (_, i) => at(1000 + i / 10)).flat();
          const names = ink.labels.filter(({ text, left }) => text.startsWith('Kimm') && left > wall.left);
          return names.map(({ left, right, top, bottom }) => [
            left - wall.left, wall.left + wall.width - right,
            hole.filter(([x, y]) => x > left && x < right && y > top && y < bottom).length,
          ]);
        })()""")
        assert len(found) == 1
        angles = [one["text"] for one in screen.evaluate("ink.labels") if " ± " in one["text"] and one["left"] > 600]
        assert [text for text in angles if not re.search(r"(^| )\d+ ± \d+ / \d+ ± \d+$", text)] == [], (
            "a name is cut, its angles are not"
        )
        assert found[0][0] >= 0
        assert found[0][1] >= 0
        assert found[0][2] == 0
        screen.close()


def test_on_the_path_discs_have_their_angles_and_a_top_that_was_picked_is_no_second_line(browser: Any) -> None:
    """A top within 0.2 m of a pick is the pick, with the top's name; labels of nearer planes come first inside."""
    path = hb.Survey([970.0, 1100.0], [30.0, 30.0], [70.0, 70.0], north="grid").path(extend=100.0)
    wall = MadeWall(20_000)
    wall.intervals = (hb.Interval("Draupne", 1003.0, 1006.1), hb.Interval("Hugin", 1006.1, 1012.0))
    wall.picks = Picks()
    with hb.view(wall, path=path) as viewer:
        viewer.scene.intervals = wall.intervals
        for depth, dip in ((1006.0, 20.0), (1004.0, 40.0), *((1008 + 0.05 * i, 10.0) for i in range(20))):
            pick = Pick(kind="bed" if depth == 1006.0 else "fracture", depth=depth, toolface=40.0, apparent_dip=dip)
            viewer.scene.change_picks(lambda picks, pick=pick: picks.put(pick))
        first, second = ("{:.0f} / {:03.0f}".format(*pick.dip(path)) for pick in list(viewer.scene.picks)[:2])
        flatter = "hole × 5 wide: traces on it look flatter"
        for address, shown, wide in (
            ("#md=1007&sec=10&camera=outside&tube=5&at=1004_40", second, True),
            ("#md=1007&sec=8&camera=down&ahead=0.8", "fracture at 1004.00 m", False),
        ):
            screen = Screen(browser, viewer.url, address, (1366, 768))
            screen.until(f"document.getElementById('ink').labels.some(({{ text }}) => text === '{shown}')")
            screen.settle()
            texts = [one["text"] for one in screen.evaluate("document.getElementById('ink').labels")]
            assert f"Hugin   {first}" in texts, address
            assert any(text.endswith("dip / azimuth from grid north") for text in texts)
            assert any(text.startswith(flatter) for text in texts) == wide
            wall_left = screen.evaluate("window.__wall.app.renderer.rects.wall.left")
            labels = [one for one in screen.evaluate("ink.labels") if one["left"] > wall_left]
            assert not [one for one in labels if one["text"] == "Hugin"], "not named twice in 3-D"
            assert screen.touching("ink") == []
            screen.close()


def test_every_top_beside_the_path_has_its_name_in_rows_where_they_are_close(browser: Any) -> None:
    path = hb.Survey([970.0, 1100.0], [40.0, 40.0], [70.0, 70.0]).path(extend=100.0)
    tops = {"Draupne": 1003.0, "Heather": 1003.3, "Hugin": 1003.6, "Sleipner": 1003.9}
    wall = MadeWall(20_000)
    wall.intervals = tuple(hb.Interval(name, top, 1012.0) for name, top in tops.items())
    with hb.view(wall, path=path) as viewer:
        viewer.scene.intervals = wall.intervals
        pick = Pick(kind="bed", depth=1003.6, toolface=40.0, apparent_dip=15.0, note="F1 open")
        viewer.scene.change_picks(lambda picks: picks.put(pick))
        screen = Screen(browser, viewer.url, "#md=1008&sec=20&camera=outside", (1366, 768))
        screen.until("document.getElementById('ink').labels.some(({ text }) => text.startsWith('Hugin'))")
        screen.settle()
        wall_left = screen.evaluate("window.__wall.app.renderer.rects.wall.left")
        labels = [one["text"] for one in screen.evaluate("ink.labels") if one["left"] > wall_left]
        words = " ".join(labels).split()
        assert {"Draupne", "Heather", "Sleipner"} <= set(words)
        assert not [text for text in labels if "dip" in text and text.split()[0] in tops], "nothing is said of a dip"
        assert any(text.startswith("Hugin") for text in labels)
        assert any("F1 open " in text for text in labels), "the name of the pick"
        assert screen.touching("ink") == []
        screen.close()


# The labels of the path view, as on a slide if asked, the axis and both edges of the hole in it, and its place.
DRAWN_ON_PATH = """((slide) => {
  const { app: { path, view, store, renderer } } = window.__wall;
  const ink = document.getElementById('ink');
  if (slide) ink.slide = {};
  renderer.drawInk(renderer.look());
  delete ink.slide;
  const radius = store.bitRadius * view.tubeFactor(store);
  const { rects: { wall }, gpu } = renderer;
  const hole = Array.from({ length: 41 }, (_, i) => path.at(view.top + (view.length * i) / 40))
    .flatMap((frame) => [-1, 0, 1].map((side) => gpu.project(frame, wall, gpu.aside(frame, side * radius))));
  return [ink.labels, hole, wall];
})(%s)"""


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_the_planned_path_is_seen_over_the_hole_with_its_distance_where_it_is_farthest(
    browser: Any, theme: str
) -> None:
    path = hb.Survey([970.0, 1100.0], [40.0, 40.0], [70.0, 70.0], north="grid").path(extend=100.0)
    plan = hb.Survey([970.0, 1100.0], [39.0, 39.0], [70.0, 70.0], north="grid").path(extend=100.0)
    wall = MadeWall(20_000)
    wall.intervals = (hb.Interval("Draupne", 1003.0, 1012.0),)
    with hb.view(wall, path=path, plan=plan) as viewer:
        viewer.scene.intervals = wall.intervals
        for size in ((1366, 768), (1920, 1080)):
            screen = Screen(
                browser, viewer.url, f"#md=1008&sec=20&camera=outside&tab=3d&theme={theme}", size, drawn=False
            )
            screen.until("document.getElementById('ink').labels.some(({ text }) => text === 'planned path')")
            screen.settle()
            bottom = screen.evaluate("Math.min(window.__wall.app.view.bottom, window.__wall.app.store.span[1])")
            away = np.linalg.norm(plan.position(np.arange(970.0, 1100.0, 0.01)) - path.position([bottom])[0], axis=1)
            for slide in ("false", "true"):
                labels, hole, pane = screen.evaluate(DRAWN_ON_PATH % slide)
                texts = [one["text"] for one in labels if one["left"] > pane["left"]]
                assert f"{away.min():.1f} m" in texts
                assert {"plan, N up", "side, WSW–ENE", "N"} <= set(texts)
                words = [one for one in labels if re.search(r"hole ×|from the planned path", one["text"])]
                assert bool(words) == (slide == "false"), "on a slide they stand above the picture"
                for one in words:
                    assert not [
                        p for p in hole if one["left"] < p[0] < one["right"] and one["top"] < p[1] < one["bottom"]
                    ]
                # Of the plan some three of five places are blue, though the hole is drawn wider than it is off.
                blue = screen.evaluate(
                    "(([rgb, points]) => { const { app: { renderer: { gpu, rects: { wall } } } } = window.__wall;"
                    " const ink = document.getElementById('ink'); const ratio = ink.width / ink.clientWidth;"
                    " return points.filter((centre) => { const [x, y] = gpu.project({ centre }, wall);"
                    "  const { data } = ink.getContext('2d').getImageData(x * ratio, y * ratio, 1, 1);"
                    "  return data[3] > 200 && rgb.every((value, i) => Math.abs(value - data[i]) < 60); }).length"
                    "  / points.length; })",
                    [
                        [0x15, 0x57, 0xB0] if theme == "light" else [0x72, 0xAE, 0xF7],
                        plan.position(np.linspace(1000.0, 1015.0, 200)).tolist(),
                    ],
                )
                assert 0.4 < blue < 0.9
            screen.close()


def test_the_side_shows_tops_at_the_dip_that_its_section_cuts(browser: Any) -> None:
    """A bed that dips along the hole has its dip there, and one that dips across it is level."""
    path = hb.Survey([970.0, 1100.0], [40.0, 40.0], [70.0, 70.0], north="grid").path(extend=100.0)
    wall = MadeWall(20_000)
    wall.intervals = (hb.Interval("Along", 1003.0, 1008.0), hb.Interval("Across", 1008.0, 1012.0))
    with hb.view(wall, path=path) as viewer:
        viewer.scene.intervals = wall.intervals
        for depth, azimuth in ((1003.0, 70.0), (1008.0, 160.0)):
            pick = plane("bed", depth, 30.0, azimuth, path)
            viewer.scene.change_picks(lambda picks, pick=pick: picks.put(pick))
        screen = Screen(browser, viewer.url, "#md=1008&sec=20&camera=outside&tab=3d", (1366, 768), drawn=False)
        screen.until("window.__wall.app.picking.kept.length === 2")
        screen.settle()
        side = next(one for one in screen.evaluate("ink.labels") if one["text"] == "side, WSW–ENE")
        slopes = [
            math.degrees(math.atan2(line[3] - line[1], line[2] - line[0]))
            for line in screen.evaluate("ink.strokes")
            if math.hypot(line[2] - line[0], line[3] - line[1]) == pytest.approx(32, abs=0.01)
            and line[0] > side["left"] - 20
        ]
        assert sorted(slopes) == pytest.approx([0, 30], abs=0.5)
        screen.close()


def test_on_a_slide_of_the_path_a_disc_at_the_upper_edge_is_whole_and_the_caption_stands_above(browser: Any) -> None:
    """An eye that the user put sees the hole up to the upper edge of the picture."""
    with hb.view(MadeWall(20_000), path=curved_path()) as viewer:
        pick = Pick(kind="fracture", depth=1008.0, toolface=40.0, apparent_dip=20.0)
        viewer.scene.change_picks(lambda picks: picks.put(pick))
        screen = Screen(browser, viewer.url, "#md=1012&sec=20&camera=outside", (1366, 768), drawn=False)
        screen.until("window.__wall.app.picking.kept.length === 1")
        screen.settle()
        screen.evaluate(
            "(() => { const { app } = window.__wall; const { renderer, path, view } = app;"
            " const at = path.at(1008).centre; const to = renderer.gpu.position({ centre: at }); to[2] -= 2.8;"
            " view.lookFrom([to[0] + 8, to[1] - 8, to[2], ...to]); renderer.aim();"
            " const draw = renderer.drawInk.bind(renderer); renderer.drawInk = (look) => { draw(look);"
            " const ink = document.getElementById('ink'); if (!ink.slide) return;"
            " const { wall } = renderer.rects; const ratio = ink.width / ink.clientWidth;"
            " const y = renderer.gpu.project(path.at(1008), wall)[1];"
            " const { data } = ink.getContext('2d').getImageData(wall.left * ratio, 0, wall.width * ratio, 76 * ratio);"
            " let blue = 0; for (let i = 0; i < data.length; i += 4)"
            " blue += data[i + 3] > 60 && data[i + 2] > data[i] + 60;"
            " window.__slide = { y, blue: blue / ratio / ratio, labels: ink.labels.map(({ text }) => text) }; }; })()"
        )
        screen.settle()
        with screen.page.expect_download():
            screen.click("#slide")
        seen = screen.evaluate("window.__slide")
        assert 20 < seen["y"] < 76, "the disc lies where the page has its controls"
        assert seen["blue"] > 200, "and is drawn there"
        assert not [text for text in seen["labels"] if "hole ×" in text]
        screen.close()


def labels_of_slide(screen: Screen) -> list[dict[str, Any]]:
    """Save a slide, and return the texts on it."""
    screen.evaluate(
        "(() => { const { renderer } = window.__wall.app; const draw = renderer.drawInk.bind(renderer);"
        " renderer.drawInk = (look) => { draw(look); const ink = document.getElementById('ink');"
        " if (ink.slide) window.__labels = ink.labels; }; })()"
    )
    with screen.page.expect_download():
        screen.click("#slide")
    found: list[dict[str, Any]] = screen.evaluate("window.__labels")
    return found


def test_a_slide_of_the_path_has_the_side_view_beside_the_plan(browser: Any) -> None:
    """Depths and names take the places below the plan and at the left edge."""
    path = hb.Survey([970.0, 1110.0], [30.0, 30.0], [60.0, 60.0]).path()
    with hb.view(MadeWall(57_600), path=path) as viewer:
        viewer.scene.intervals = tuple(
            hb.Interval(f"Formation {depth:.0f}", depth, depth + 12) for depth in (1010.0, 1030.0, 1050.0, 1070.0)
        )
        for depth, dip in ((1010.0, 12), (1020.0, 60), (1035.0, 65), (1050.0, 20), (1060.0, 70), (1070.0, 18)):
            kind = "bed" if dip < 30 else "fracture"
            pick = Pick(kind=kind, depth=depth, toolface=80.0, apparent_dip=dip, dip_sigma=1.0, toolface_sigma=2.0)
            viewer.scene.change_picks(lambda picks, pick=pick: picks.put(pick))
        screen = Screen(browser, viewer.url, "#md=1045&sec=90&camera=outside", (1440, 900), drawn=False)
        screen.until("window.__wall.app.picking.kept.length === 6")
        screen.settle()
        labels = labels_of_slide(screen)
        (plan,) = [one for one in labels if one["text"] == "plan, N up"]
        (side,) = [one for one in labels if one["text"].startswith("side, ")]
        box = {"left": side["left"], "right": side["left"] + 92, "top": side["top"], "bottom": side["bottom"] + 116}
        assert not [
            one["text"]
            for one in labels
            if one["right"] > box["left"] + 1
            and one["left"] < box["right"] - 1
            and one["bottom"] > box["top"] + 1
            and one["top"] < box["bottom"] - 1
            and not box["left"] <= (one["left"] + one["right"]) / 2 <= box["right"]
        ], "nothing reaches into it"
        assert abs(plan["left"] - side["left"]) > 92 or abs(plan["top"] - side["top"]) > 92
        screen.close()


def test_a_full_view_in_perspective_has_no_axis_of_depth_beside_it(browser: Any, viewer: Any) -> None:
    """No height of the picture is one depth: the map of the well stands there; the depths stand along the hole."""
    screen = Screen(browser, viewer.url, "#md=1012&sec=12&camera=outside&tab=3d", (1366, 768), drawn=False)
    screen.settle()
    rects, labels = screen.evaluate("[window.__wall.app.renderer.rects, document.getElementById('ink').labels]")
    assert rects["axis"]["width"] == 0
    assert rects["map"]["width"] > 0
    depths = [one for one in labels if re.fullmatch(r"10[0-9.]+", one["text"])]
    ends = rects["map"]["top"], rects["map"]["top"] + rects["map"]["height"]
    assert [one for one in depths if one["left"] < rects["map"]["left"] + 60 and ends[0] < one["top"] < ends[1]] == []
    assert len([one for one in labels if re.fullmatch(r"10[0-9.]+ m", one["text"])]) >= 3
    screen.close()


def test_the_map_of_a_short_well_ends_at_tenths_of_a_metre(browser: Any) -> None:
    wall = hb.reconstruct(hb.Caliper.gauge(106.5, 109.5, 0.2), bit_diameter=0.2, sectors=16, pitch=0.1)
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, "", (1366, 768), drawn=False)
        screen.until("window.__wall.app.store && document.getElementById('ink').labels.length > 5")
        screen.settle()
        ends, texts = screen.evaluate(
            "(({ store, view }) => [store.span, document.getElementById('ink').labels.map(({ text }) => text)])"
            "(window.__wall.app)"
        )
        assert {f"{end:.1f}" for end in ends} <= set(texts)
        assert screen.touching("ink") == []
        screen.close()


def test_the_line_of_the_cursor_hides_no_tadpole(browser: Any) -> None:
    with hb.view(MadeWall(20_000), path=curved_path()) as viewer:
        pick = Pick(kind="bed", depth=1008.0, toolface=40.0, apparent_dip=30.0)
        viewer.scene.change_picks(lambda picks: picks.put(pick))
        screen = Screen(browser, viewer.url, "#md=1008&sec=10", drawn=False)
        screen.until("window.__wall.app.picking.kept.length")
        screen.settle()
        dip, _ = pick.dip(curved_path())
        left, width, middle = screen.evaluate(
            "(({ left, width, top, height }) => [left, width, top + height / 2])(window.__wall.app.renderer.rects.dips)"
        )
        x, y = left + 12 + dip / 90 * (width - 24), middle
        ratio = screen.evaluate("ink.width / ink.clientWidth")
        pixel = (
            f"[...document.getElementById('ink').getContext('2d').getImageData({x * ratio}, {y * ratio}, 1, 1).data]"
        )
        head = screen.evaluate(pixel)
        screen.evaluate("window.__wall.app.view.point({ depth: 1008, toolface: 20 }, true)")
        screen.settle()
        assert screen.evaluate(pixel) == head
        screen.close()


def test_the_page_says_where_an_image_has_thinner_rows_than_the_wall(browser: Any) -> None:
    wall = MadeWall(20_000)
    values = np.tile(np.arange(len(wall)) % 50.0, (2, 1))
    named = {hb.Attribute("ATV", rows=(1000.0, 0.01)): values[0], hb.Attribute("GR", rows=(1000.0, 0.2)): values[1]}
    with hb.view(wall, attributes=named) as viewer:
        for name, said in (("ATV", "each 0.01 m, turns each 0.1 m: wall.pitch=0.01m shows all"), ("GR", None)):
            screen = Screen(browser, viewer.url, f"#md=1008&sec=10&quantity={name}&beside=", drawn=False)
            screen.settle()
            assert screen.readout().get(f"Rows of {name}") == said
            texts = [one["text"] for one in screen.evaluate("ink.labels")]
            assert ("drawn each 0.1 m" in texts) == bool(said), "all that has room"
            wide = Screen(browser, viewer.url, screen.address(), (1600, 640), drawn=False)
            wide.settle()
            texts = [one["text"] for one in wide.evaluate("ink.labels")]
            assert ("rows of 0.01 m, drawn each 0.1 m" in texts) == bool(said)
            wide.close()
            screen.close()


def test_an_address_shows_a_colleague_the_same_picture(browser: Any, viewer: Any) -> None:
    first = Screen(browser, viewer.url, "#md=1012&sec=20&quantity=RES&cut=north&theme=dark&shape=3")
    first.settle()
    first.mouse.click(*place(first, 120, 1009.0))
    first.keyboard.press("s")
    first.evaluate("window.__wall.app.selection.setColours({ low: 2, high: 150, map: 'cividis', log: true })")
    first.settle()
    address = first.address()
    second = Screen(browser, viewer.url, address)
    second.settle()
    for name in ("image", "wall"):
        np.testing.assert_array_equal(second.pixels(name), first.pixels(name))
    assert second.readout() == first.readout()
    assert second.evaluate("window.__wall.app.view.pins.length") == 1
    first.close()
    second.close()


@pytest.mark.parametrize("camera", ["outside", "down"])
def test_an_address_keeps_where_the_eye_was_put_in_3d(browser: Any, viewer: Any, camera: str) -> None:
    first = Screen(browser, viewer.url, f"#md=1009&sec=8&camera={camera}", (1366, 768))
    first.settle()
    x, y = first.evaluate("(({ left, top }) => [left + 150, top + 300])(orbit.getBoundingClientRect())")
    first.mouse.move(x, y)
    for _ in range(4):
        first.mouse.wheel(0, -100)
    first.mouse.down()
    first.mouse.move(x + 60, y + 30, steps=3)
    first.mouse.up()
    first.settle()
    second = Screen(browser, viewer.url, first.address(), (1366, 768))
    second.settle()
    camera_of = "(({ position, axes }) => [...position, ...axes.flat()])(window.__wall.app.renderer.gpu.camera)"
    seen = first.evaluate(camera_of)
    assert second.evaluate(camera_of) == pytest.approx(seen, abs=0.003)
    second.keyboard.press("h")
    second.settle()
    assert second.evaluate(camera_of) != pytest.approx(seen, abs=0.1), "the whole section is in view again"
    assert "eye=" not in second.address()
    assert "head=" not in second.address()
    first.close()
    second.close()


def test_an_address_keeps_the_eye_inside_where_a_cursor_was_held(browser: Any, viewer: Any) -> None:
    first = Screen(browser, viewer.url, "#md=1009&sec=8&camera=down&at=1010.5", (1366, 768))
    first.settle()
    first.keyboard.press("Escape")
    first.settle()
    second = Screen(browser, viewer.url, first.address(), (1366, 768))
    second.settle()
    eye = "window.__wall.app.renderer.gpu.camera.position"
    assert second.evaluate(eye) == pytest.approx(first.evaluate(eye), abs=0.003)
    assert not second.evaluate("window.__wall.app.view.pinned")
    first.close()
    second.close()


def test_a_note_where_the_angles_of_a_dip_stand_is_below_its_line(browser: Any) -> None:
    with hb.view(MadeWall(40_000), path=curved_path()) as viewer:
        bed = Pick(kind="bed", depth=1006.0, toolface=0.0, note="Top sand")
        notes = [
            Pick(kind="note", depth=depth, toolface=0.0, note="sharp base, lag of shale clasts, see the core of run 3")
            for depth in (1006.0, 1013.0)
        ]
        viewer.scene.picks.extend([bed, *notes])
        screen = Screen(browser, viewer.url, "#md=1010&sec=20", drawn=False)
        screen.until("window.__wall.app.picking.notes.length === 2")
        labels = screen.evaluate("document.getElementById('ink').labels")
        (angles,) = (one for one in labels if one["text"].startswith("Top sand"))
        low, high = sorted(one["top"] for one in labels if one["text"].startswith("sharp base"))
        assert low >= angles["bottom"], "both stand: the note of the bed below the line"
        assert high > low + 100
        screen.close()


def test_notes_are_saved_beside_the_picks(browser: Any, tmp_path: Path) -> None:
    file = tmp_path / "made.picks.csv"
    long = "wash & <b>out</b> " + "x" * 70
    with hb.view(MadeWall(40_000), picks_file=file) as viewer:
        screen = Screen(browser, viewer.url, "#md=1010&sec=20", drawn=False)
        screen.settle()
        for depth, text in ((1006.0, "tight, reamed twice"), (1013.0, long)):
            screen.mouse.move(*place(screen, 90, depth))
            screen.until(f"Math.abs(window.__wall.app.view.cursor?.depth - {depth}) < 0.1")
            screen.keyboard.press("b")
            title = screen.inner_text("#noteTitle")
            assert title.startswith(f"Note at {depth:.0f}"[:10])
            assert title.endswith("saved in made.picks.csv")
            screen.keyboard.type(text)
            screen.keyboard.press("Enter")
            screen.until(f"window.__wall.app.picking.notes.some(({{ depth }}) => Math.abs(depth - {depth}) < 0.1)")
        screen.until("!window.__wall.app.picking.waits")
        screen.settle()
        texts = [one["text"] for one in screen.evaluate("document.getElementById('ink').labels")]
        assert "tight, reamed twice" in texts
        assert any(text.startswith("wash & <b>out</b>") and text.endswith("…") for text in texts), (
            "cut to the track's width"
        )
        assert screen.evaluate("window.__wall.app.picking.planes().kept") == [], "a note is no plane"
        screen.close()
    picks = Picks.load(file)
    assert [(one.kind, round(one.depth), one.note) for one in picks] == [
        ("note", 1006, "tight, reamed twice"), ("note", 1013, long[:80]),
    ]  # fmt: skip
    with hb.view(MadeWall(40_000), picks_file=file) as viewer:
        viewer.scene.picks.extend(picks)
        again = Screen(browser, viewer.url, "#md=1010&sec=20", drawn=False)
        again.settle()
        kept = "window.__wall.app.picking.notes.map(({ note }) => note)"
        again.until(f"{kept}.length === 2")
        again.mouse.move(*place(again, 200, 1006.0))
        again.until("Math.abs(window.__wall.app.view.cursor?.depth - 1006) < 0.1")
        again.keyboard.press("b")
        assert again.evaluate("document.getElementById('noteText').value") == "tight, reamed twice"
        again.keyboard.press("Escape")
        again.until("!document.getElementById('note').open")
        assert len(again.evaluate(kept)) == 2, "Escape changes nothing"
        again.until("document.activeElement === document.body")
        again.mouse.move(*place(again, 210, 1006.0))
        again.until("Math.abs(window.__wall.app.view.cursor?.depth - 1006) < 0.1")
        again.keyboard.press("b")
        again.click("#note button[value=remove]")
        again.until(f"{kept}.length === 1 && !window.__wall.app.picking.waits")
        again.close()
    assert [one.note for one in Picks.load(file)] == [long[:80]]


def test_an_export_opens_from_disk_and_asks_nothing(browser: Any, viewer: Any, tmp_path: Path) -> None:
    viewer.scene.change_picks(lambda picks: picks.put(Pick(kind="bed", depth=1011.0, toolface=40.0, apparent_dip=60.0)))
    live = Screen(browser, viewer.url, "#md=1012&sec=20&quantity=GR")
    live.until("window.__wall.app.picking.kept.length === 1")
    live.settle()
    with live.expect_download() as saved:
        live.click("#export")
    file = tmp_path / "wall.html"
    saved.value.save_as(file)
    assert file.stat().st_size < 4_000_000
    shown = Screen(browser, file.as_uri())
    shown.settle()
    for name in ("image", "wall"):
        np.testing.assert_array_equal(shown.pixels(name), live.pixels(name))
    assert shown.requests == [file.as_uri()]
    assert re.match(rf"export of {CLOCK} ", shown.inner_text("#lampText"))
    assert not shown.is_visible("#csv")
    kept = shown.evaluate("window.__wall.app.picking.kept.map(({ kind, depth }) => [kind, depth])")
    assert kept == [["bed", 1011]], "with its picks"
    assert shown.inner_text("#netText").startswith("1 pole"), "and what draws them"
    viewer.scene.change_picks(Picks.clear)
    shown.mouse.move(*place(shown, 100, 1010))
    shown.until("window.__wall.app.view.cursor")
    shown.settle()
    assert shown.readout()["Radius"].endswith("mm")
    assert shown.inner_text("#sectionTitle") == "1002.0–1022.0 m"
    shown.evaluate("(({ view, store }) => view.show(1010, 5, store))(window.__wall.app)")
    shown.settle()
    assert shown.inner_text("#sectionTitle") == "exported 1002.0–1022.0 m", "the figures are not of what is in view"
    shown.close()
    live.close()


def test_an_export_is_bounded_and_says_what_is_wrong(viewer: Any) -> None:
    for query, text in (
        ("start=1000", "stop: missing"),
        ("start=nan&stop=3", "must be a finite number"),
        ("start=5000&stop=6000", "the wall does not reach there"),
    ):
        with pytest.raises(urllib.error.HTTPError) as refused:
            urllib.request.urlopen(viewer.url.replace("/?", f"/api/export.html?{query}&"))
        assert refused.value.code == 400
        assert text in refused.value.read().decode()


def test_what_the_server_cannot_write_is_said_on_the_page(browser: Any, viewer: Any) -> None:
    screen = Screen(browser, viewer.url, "#md=1012&sec=20", drawn=False)
    screen.settle()
    for query, text in (
        ("start=1000", "The section was not written: stop: missing; ask for ?start=DEPTH&stop=DEPTH in metres."),
        (
            "start=5000&stop=6000",
            "The section was not written: start = 5000, stop = 6000: the wall does not reach there.",
        ),
    ):
        # In one go: the page may draw between two, and then sets the address again.
        screen.evaluate(f"""(() => {{
            const link = document.getElementById('export');
            link.href = 'api/export.html?{query}&' + location.search.slice(1);
            link.click();
        }})()""")
        screen.until(f"document.getElementById('notice').textContent === {json.dumps(text)}")
        assert screen.is_visible("#notice")
    assert screen.url.startswith(viewer.url), "the page is still there"
    with screen.expect_download() as saved:
        screen.evaluate("window.__wall.app.redraw()")
        screen.settle()
        screen.click("#csv")
    assert saved.value.suggested_filename == "section-1002.0-1022.0.csv"
    assert Path(saved.value.path()).read_text().startswith("vertex,depth [m],")
    screen.until("document.getElementById('notice').hidden")
    screen.close()


def test_text_of_an_export_cannot_end_its_script() -> None:
    from helibore.viewer.html_export import _scripts

    text = "".join(_scripts({"well": "</script><script>alert(1)</script><!--"}, [b"\xff\xee", b""], 'x = "</script>";'))
    assert text.count("</script>") == 2
    enclosed = text.split(">", 1)[1].split("</script>")[0]
    assert json.loads(enclosed) == {"well": "</script><script>alert(1)</script><!--", "messages": ["/+4=", ""]}


def test_fingers_move_and_zoom_the_tracks(browser: Any, viewer: Any) -> None:
    screen = Screen(browser, viewer.url, "#md=1012&sec=10", drawn=False)
    screen.settle()
    before = screen.evaluate("(({ top, length }) => ({ top, length }))(window.__wall.app.view)")
    touch = (
        "([moves]) => { const ink = document.getElementById('ink'); const { left, top } = ink.getBoundingClientRect();"
        " ink.setPointerCapture = () => {};"
        " for (const [type, id, x, y] of moves) ink.dispatchEvent(new PointerEvent(type,"
        "   { pointerId: id, pointerType: 'touch', clientX: left + x, clientY: top + y, bubbles: true,"
        "     buttons: type === 'pointerup' ? 0 : 1 })); }"
    )
    screen.evaluate(touch, [[["pointerdown", 1, 200, 400], ["pointermove", 1, 200, 300], ["pointerup", 1, 200, 300]]])
    moved = screen.evaluate("window.__wall.app.view.top")
    height = screen.evaluate("window.__wall.app.renderer.rects.image.height")
    assert moved == pytest.approx(before["top"] + 100 * 10 / height, abs=0.02)
    fingers = [["pointerdown", 1, 200, 300], ["pointerdown", 2, 200, 400], ["pointermove", 2, 200, 600]]
    screen.evaluate(touch, [[*fingers, ["pointerup", 2, 200, 600], ["pointerup", 1, 200, 300]]])
    assert screen.evaluate("window.__wall.app.view.length") < 0.6 * before["length"]
    screen.close()


def test_a_geologist_reopens_the_picks_changes_one_and_boxes_a_breakout(browser: Any, tmp_path: Path) -> None:
    """Select, class, drag, type a number, delete, a box; the file beside the wall holds it, and the print shows it."""
    wall, file = MadeWall(20_000), tmp_path / "a.wall.picks.csv"
    with hb.view(wall, path=curved_path(), picks_file=file) as viewer:
        viewer.scene.picks += [
            Pick(kind="bed", depth=depth, toolface=40.0, apparent_dip=60.0) for depth in (1009.0, 1015.0)
        ]
        screen = Screen(browser, viewer.url, "#md=1012&sec=12", (1366, 768), drawn=False)
        screen.until("window.__wall.app.picking.kept.length === 2")
        screen.settle()
        colour, net = (screen.locator(name).bounding_box() for name in ("#colour", "#net"))
        assert colour["y"] + colour["height"] <= min(768, net["y"]), "Colour is above the fold, the net below it"
        screen.keyboard.press("d")
        assert screen.inner_text("#dipSaved") == "saved in a.wall.picks.csv"
        screen.mouse.click(*place(screen, 130, 1009.0))
        screen.until("window.__wall.app.picking.pick")
        assert screen.locator("#dipUndo").is_disabled()
        screen.page.select_option("#pickClass", "fracture")
        down, beside = place(screen, 130, 1009.0), place(screen, 130, 1009.6)
        screen.mouse.move(*down)
        screen.mouse.down()
        screen.mouse.move(*beside, steps=4)
        screen.mouse.up()
        screen.page.fill("#pickFields [name=apparent_dip]", "50")
        screen.keyboard.press("Enter")
        screen.until("window.__wall.app.picking.pick.apparent_dip === 50")
        screen.page.evaluate("window.__wall.app.view.choose({units: 'ft'})")
        depth = screen.locator("#pickFields label", has_text="MD ft").locator("input")
        depth.fill(f"{1009.6 / 0.3048:.2f}")
        screen.keyboard.press("Enter")
        screen.until("Math.abs(window.__wall.app.picking.pick.depth - 1009.6) < 0.01")
        depth.fill("99999")
        screen.keyboard.press("Enter")
        screen.page.get_by_text("is outside the wall").wait_for()
        screen.until("document.querySelector('#pickFields [name=depth]').value !== '99999'")  # by the next picture
        depth.fill(f"{1011 / 0.3048:.2f}")
        screen.keyboard.press("Enter")
        screen.until("Math.abs(window.__wall.app.picking.pick.depth - 1011) < 0.01")
        screen.locator("#dipUndo").click()  # takes back the last change, not the pick
        screen.until("Math.abs(window.__wall.app.picking.pick.depth - 1009.6) < 0.01")
        screen.mouse.click(*place(screen, 130, 1015.0))
        screen.until("window.__wall.app.picking.pick?.kind === 'bed'")
        screen.locator("#dipRemove").click()
        screen.page.select_option("#pickClass", "breakout")
        screen.mouse.move(*place(screen, 230, 1010.5))
        screen.mouse.down()
        screen.mouse.move(*place(screen, 270, 1013.5), steps=4)
        screen.mouse.up()
        screen.until("window.__wall.app.picking.boxes.length")
        end = time.monotonic() + PATIENCE
        while not (file.exists() and "breakout" in file.read_text()) and time.monotonic() < end:
            time.sleep(0.05)
        screen.close()
    fracture, box = Picks.load(file)
    assert (fracture.kind, fracture.apparent_dip) == ("fracture", 50.0)
    assert fracture.depth == pytest.approx(1009.6, abs=0.03)
    assert (box.kind, box.depth, box.height) == ("breakout", pytest.approx(1012, abs=0.03), pytest.approx(3, abs=0.05))
    assert (box.toolface, box.opening) == (pytest.approx(250, abs=1), pytest.approx(40, abs=2))


def test_an_open_fracture_that_is_picked_is_washed_out_no_more(browser: Any) -> None:
    depth = np.repeat(np.arange(1000.0, 1010.0, 0.02), 36)
    radius = BIT / 2 + 0.03 * (np.abs(depth - 1003) < 0.4)
    samples = hb.Caliper(depth, np.tile(np.arange(0.0, 360.0, 10.0), depth.size // 36), radius)
    wall = hb.reconstruct(samples, bit_diameter=BIT, sectors=36, pitch=0.02)
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, "#md=1003&sec=4", drawn=False)
        washed = "[...document.querySelectorAll('#section dt')].find((e) => e.textContent === 'Washed out')"
        screen.until(f"{washed}?.nextElementSibling.textContent.startsWith('0.8 m of 4.0 m')")
        pick = Pick(kind="fracture", depth=1003.0, toolface=0.0, apparent_dip=75.0, aperture=0.1)
        viewer.scene.change_picks(lambda picks: picks.put(pick))
        viewer.scene.update_state(sources={})
        screen.until(f"{washed}?.nextElementSibling.textContent.startsWith('0.0 m of 4.0 m')")
        screen.until("!document.querySelector('#zones button')")
        viewer.scene.change_picks(lambda picks: picks.clear())
        viewer.scene.update_state(sources={"": 1})
        screen.until(f"{washed}?.nextElementSibling.textContent.startsWith('0.8 m of 4.0 m')")
        screen.close()


def test_the_page_prints_what_is_in_view_with_its_picks(browser: Any) -> None:
    """As `helibore view` draws it: the same button beside the picks and below the log."""
    depth = np.arange(1000.0, 1030.0, 0.01)
    wall = hb.reconstruct(
        hb.Caliper(depth, np.arange(depth.size) * 37.0, np.full(depth.size, 0.11)), bit_diameter=0.216, sectors=32
    )
    for depth in (1009.0, 2000.0, 2001.0):  # the last two are of another hole
        wall.picks.append(Pick(kind="bed", depth=depth, toolface=40.0, apparent_dip=60.0))
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, "#units=ft", drawn=False)
        screen.settle()
        assert not screen.is_visible("#print")
        scales, draw = [], section_printer(wall, {"title": "A"})
        viewer.scene.draw_pages = lambda *wanted: scales.append(wanted[-1]) or draw(*wanted)
        viewer.scene.update_state(ended=True, prints=True)
        screen.until("window.__wall.app.prints")
        top = "window.__wall.app.view.top"  # without a zone, it opens at its picks, but not above the wall
        screen.until(f"Math.abs({top} - Math.max(1000, 1009 - window.__wall.app.view.length / 2)) < 0.05")
        screen.evaluate("window.__wall.app.view.show(998, 12, window.__wall.app.store)")
        screen.keyboard.press("d")
        screen.settle()
        with screen.expect_download() as saved:
            screen.click("#dipPrint")
        assert saved.value.suggested_filename == "log-998.0-1010.0.pdf"
        assert Path(saved.value.path()).read_bytes().startswith(b"%PDF")
        screen.page.select_option("#sectionLength", "1:50")
        screen.settle()
        assert screen.inner_text("#dipPrint") == "Print section"
        on_paper = r"\d+\.\d–\d+\.\d ft, in view, on paper at 1:50, with its picks \(PDF\)\. Print well.*"
        assert re.fullmatch(on_paper, screen.get_attribute("#dipPrint", "title"))
        with screen.expect_download():
            screen.click("#dipPrint")
        assert scales == [100, 50], "12 m on 468 pixels are 1:97"
        screen.page.get_by_text("is saved as a PDF. Print well, below the log, prints it all.").wait_for()
        on_paper = "The whole well on paper at 1:50, nearest to the scale in view, 1.97 ft long, with its picks (PDF)"
        assert screen.get_attribute("#printAll", "title") == on_paper
        with screen.expect_download() as saved:
            screen.click("#printAll")
        assert saved.value.suggested_filename == "log-1000.0-1030.0.pdf"
        screen.evaluate("window.__wall.app.view.show(2000, 5, window.__wall.app.store)")
        screen.close()


def test_images_stand_side_by_side_at_the_scale_of_paper(browser: Any, viewer: Any) -> None:
    screen = Screen(browser, viewer.url, "#md=1012&sec=12&quantity=GR", (1366, 768))
    screen.settle()
    alone = screen.pixels("image")
    screen.keyboard.press("e")
    screen.settle()
    assert screen.evaluate("[window.__wall.app.view.quantity, window.__wall.app.view.beside]") == ["over", ["GR"]]
    both = screen.pixels("beside0")
    assert abs(both[:, 5].astype(int) - alone[:, 5]).mean() <= 4, "the same image, narrower"
    assert not np.array_equal(screen.pixels("image")[:, 5], both[:, 5])
    assert "beside=GR" in screen.address()
    head = screen.evaluate(
        "(({ left, top }, { beside0 }) => [left + beside0.left + 40, top + 12])"
        "(document.getElementById('stage').getBoundingClientRect(), window.__wall.app.renderer.rects)"
    )
    screen.mouse.click(*head)
    screen.settle()
    assert screen.evaluate("[window.__wall.app.view.quantity, window.__wall.app.view.beside]") == ["GR", ["over"]]
    screen.evaluate("window.__wall.app.view.widen('image', 300)")
    screen.evaluate("window.__wall.app.selection.setQuantity('over')")
    screen.settle()
    assert screen.evaluate("window.__wall.app.renderer.rects.beside0.width") == 300, "an image keeps its width"
    screen.page.select_option("#sectionLength", "1:200")
    screen.settle()
    height = screen.evaluate("window.__wall.app.renderer.rects.image.height")
    assert screen.evaluate("window.__wall.app.view.length") == pytest.approx(height / 96 * 0.0254 * 200)
    assert screen.evaluate("document.getElementById('sectionLength').value") == "1:200"
    screen.close()


def test_a_curtain_lays_the_image_beside_over_the_first_and_the_passes_over_each_other(browser: Any) -> None:
    """Left of the line the first image, right of it the other one; the pointer moves the line."""
    wall = MadeWall(20_000)
    with hb.view(wall, attributes=gamma_and_resistivity(wall), path=curved_path()) as viewer:
        screen = Screen(browser, viewer.url, "#md=1012&sec=12&quantity=GR", (1366, 768))
        screen.keyboard.press("e")
        screen.settle()
        first, other = screen.pixels("image"), screen.pixels("beside0")
        middle = first.shape[1] // 2
        screen.keyboard.press("w")
        screen.until("globalThis.more")
        screen.settle()
        both = screen.pixels("image")
        np.testing.assert_array_equal(both[:, : middle - 1], first[:, : middle - 1])
        np.testing.assert_array_equal(both[:, middle + 1 :], other[:, middle + 1 :])
        texts = [one["text"] for one in screen.evaluate("document.getElementById('ink').labels")]
        assert {"◂ Over bit radius", "GR ▸"} <= set(texts)
        screen.point_at(across=0.25)
        screen.settle()
        both = screen.pixels("image")
        np.testing.assert_array_equal(both[:, middle // 2 + 2 :], other[:, middle // 2 + 2 :])
        assert "curtain=0.2" in screen.address()
        screen.evaluate("window.__wall.app.view.showImages('over', [])")  # alone again: the two passes
        viewer.update(wall.patch(64 * 100, 64 * 140, 0.01))
        screen.until("window.__wall.app.store.vertex(6410)?.radius > 0.115")
        screen.until("window.__wall.app.alarms.zones.length")  # its line takes height from the image
        screen.settle()
        latest = screen.pixels("image")
        screen.keyboard.press("w")
        screen.keyboard.press("x")
        screen.until("window.__wall.app.view.pass === 'first'")
        screen.until("window.__wall.app.view.pass === 'latest'")
        screen.keyboard.press("x")
        screen.evaluate("window.__wall.app.view.choose({ pass: 'latest', curtain: null })")
        screen.settle()
        whole = screen.pixels("image")
        assert not np.array_equal(latest, whole)
        screen.evaluate("window.__wall.app.view.choose({ pass: 'first' })")
        screen.settle()
        line = round(0.25 * whole.shape[1])
        np.testing.assert_array_equal(latest[:, : line - 2], whole[:, : line - 2])
        np.testing.assert_array_equal(latest[:, line + 2 :], screen.pixels("image")[:, line + 2 :])
        screen.close()


def test_change_is_the_difference_to_the_wall_beside_and_else_what_was_measured_again(browser: Any) -> None:
    wall = MadeWall(20_000)
    shown = "window.__wall.app.selection.quantity.id"
    difference = hb.Attribute("earlier", "m", color_map="difference")
    for attributes, expected in (({difference: np.full(20_000, 0.002)}, "earlier"), ({}, "change")):
        with hb.view(wall, attributes=attributes) as viewer:
            screen = Screen(browser, viewer.url, "#md=1012&sec=12", (1366, 768))
            screen.page.select_option("#pass", "change")
            screen.until(f"{shown} === '{expected}'")
            if not attributes:
                screen.settle()
                once = screen.pixels("image")
                viewer.update(wall.patch(64 * 100, 64 * 140, 0.01))
                screen.until("window.__wall.app.store.vertex(6410)?.radius > 0.115")
                screen.settle()
                again = screen.pixels("image")
                assert len({tuple(pixel) for row in once for pixel in row}) <= 8, "hatched: measured once"
                assert not np.array_equal(once, again)
            screen.close()


def test_three_images_are_shown_in_turn(browser: Any, viewer: Any) -> None:
    screen = Screen(browser, viewer.url, "#md=1012&sec=12&quantity=over&beside=GR~RES", (1366, 768), drawn=False)
    screen.settle()
    now = "[window.__wall.app.view.quantity, ...window.__wall.app.view.beside].join()"
    names = screen.evaluate(now).split(",")
    assert len(names) == 3
    screen.keyboard.press("x")
    for turn in (1, 2, 3):
        screen.until(f"{now} === '{','.join(names[turn % 3 :] + names[: turn % 3])}'")
    screen.keyboard.press("x")
    screen.settle()
    screen.close()


def test_curves_stand_beside_the_image_and_tracks_are_dragged_into_a_template(browser: Any, tmp_path: Path) -> None:
    wall = MadeWall(20_000)
    depth = np.arange(1000.0, 1031.0, 0.5)
    template = Template("ft", None, (TemplateTrack("curves", "", ("ROP",), 100), TemplateTrack("image", "Radius")))
    curve = ScalarCurve("ROP", "m/h", depth, depth - 1000, (0.0, 40.0))
    with hb.view(wall, path=curved_path(), curves=[curve], template=template) as viewer:
        screen = Screen(browser, viewer.url, "#md=1012&sec=12&at=1012.25_10", (1366, 768), drawn=False)
        screen.until("window.__wall.app.curves.held.get('ROP')")
        screen.settle()
        assert screen.readout()["ROP"] == "12.25 m/h"
        assert screen.readout()["MD"] == f"{1012.25 / 0.3048:.2f} ft"
        rects = "window.__wall.app.renderer.rects"
        assert screen.evaluate(f"[{rects}.curves.width, {rects}.curves.left < {rects}.image.left]") == [100, True]
        names = screen.evaluate("[...document.getElementById('curve').options].map(({ text }) => text)")
        assert {"Curves", "✓ ROP", "DEQ", "template …"} <= set(names)
        left, top = screen.evaluate(
            f"(({{ left, top }}) => [left + {rects}.curves.left, top])"
            "(document.getElementById('stage').getBoundingClientRect())"
        )
        screen.mouse.move(left + 99, top + 60)
        screen.mouse.down()
        screen.mouse.move(left + 139, top + 60, steps=3)
        screen.mouse.up()
        screen.settle()
        assert screen.evaluate(f"{rects}.curves.width") == 140
        image = screen.evaluate(f"{rects}.image.left + {rects}.image.width")
        screen.mouse.move(left + 60, top + 60)
        screen.mouse.down()
        screen.mouse.move(image + 10, top + 60, steps=3)
        screen.mouse.up()
        screen.settle()
        assert screen.evaluate(f"{rects}.curves.left > {rects}.image.left")
        with screen.expect_download() as saved:
            screen.page.select_option("#curve", label="template …")
        file = tmp_path / "template.toml"
        saved.value.save_as(file)
        read = Template.load(file)
        assert read.unit == "ft"
        kinds = [(track.kind, track.width) for track in read.track]
        assert ("curves", 140) in kinds
        assert kinds.index(("curves", 140)) > [kind for kind, _ in kinds].index("image")
        asked: list[Template | None] = []
        viewer.scene.draw_pages = lambda *_, template=None: asked.append(template) or b"%PDF"
        viewer.scene.update_state(ended=True, prints=True)
        screen.until("window.__wall.app.prints")
        with screen.expect_download():
            screen.click("#print")
        assert asked[0] is not None
        assert asked[0].track == read.track, "the print has the tracks as they were dragged"
        screen.close()


def test_narrow_heads_stay_apart_and_keep_name_and_unit(browser: Any) -> None:
    """Four tracks of 64 pixels: no text of one head touches that of the next, and no text leaves its track."""
    depth = np.arange(1000.0, 1031.0, 0.5)
    curve = ScalarCurve("GR_gAPI_long", "gAPI", depth, depth - 1000, (0.0, 150.0))
    with hb.view(MadeWall(20_000), path=curved_path(), curves=[curve]) as viewer:
        viewer.scene.change_picks(lambda picks: picks.put(Pick(kind="bed", depth=1012.0, toolface=0.0)))
        screen = Screen(browser, viewer.url, "#md=1012&sec=12&curves=GR_gAPI_long", (1366, 768), drawn=False)
        screen.until("window.__wall.app.curves.held.get('GR_gAPI_long')")
        for wide in (64, 80, 110):
            screen.evaluate(f"window.__wall.app.view.widen('caliper', {wide})")
            screen.evaluate(f"window.__wall.app.view.widen('curves', {wide})")
            screen.settle()
            rects = screen.evaluate("window.__wall.app.renderer.rects")
            labels = screen.evaluate("document.getElementById('ink').labels")
            heads = {name: [one for one in labels if one["top"] < 80 and within(one, rects[name])] for name in rects}
            for name in ("caliper", "curves", "dips"):
                track = rects[name]
                for one in heads[name]:
                    assert one["left"] >= track["left"] - 1, (wide, name, one)
                    assert one["right"] <= track["left"] + track["width"] + 1, (wide, name, one)
            named = {one["text"] for one in heads["curves"]}
            assert "gAPI" in named or any(text.endswith(" gAPI") for text in named), named
            assert {"Caliper [mm]", "Cal. mm", "Cal."} & {one["text"] for one in heads["caliper"]}
        screen.close()


def within(label: dict[str, Any], track: dict[str, float]) -> bool:
    """Whether the middle of a label lies in a track."""
    return track["left"] <= (label["left"] + label["right"]) / 2 <= track["left"] + track["width"]


def test_a_curve_that_changes_just_after_it_was_asked_for_comes_though_nothing_more_arrives(browser: Any) -> None:
    wall = MadeWall(20_000)
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, "#md=1012&sec=12&curves=DEQ", drawn=False)
        curve = "(({ held, offered }) => [held.get('DEQ'), offered.find(({ name }) => name === 'DEQ')])"
        curve += "(window.__wall.app.curves)"
        screen.until(f"{curve}[0]")
        before = screen.evaluate(f"{curve}[1].version")
        ask = "(({ curves, glow }) => { glow.fade = () => false; curves.asked.set('DEQ', performance.now()); })"
        viewer.update(wall.grow(6400))
        screen.until("window.__wall.stats.size === 26400")
        screen.evaluate(f"{ask}(window.__wall.app)")
        screen.until(f"{curve}[1].version > {before}")
        screen.until(f"{curve}[0].version === {curve}[1].version")
        screen.close()


def test_the_first_two_curves_of_files_are_shown_at_once_where_there_is_room(browser: Any) -> None:
    depth = np.arange(1000.0, 1031.0, 0.5)
    curves = [ScalarCurve(name, "", depth, depth - 1000, (0.0, 40.0)) for name in ("GR", "ROP", "RES")]
    with hb.view(MadeWall(20_000), curves=curves) as viewer:
        for size, shown in (((1366, 768), ["GR", "ROP"]), ((1000, 640), [])):
            screen = Screen(browser, viewer.url, "#md=1012&sec=12", size, drawn=False)
            screen.until("window.__wall.app.curves.offered.length > 3")
            screen.settle()
            assert screen.evaluate("window.__wall.app.curves.shown.map(({ name }) => name)") == shown
            assert screen.evaluate("window.__wall.app.renderer.rects.pane.width") >= 150
            screen.close()


def test_a_depth_is_typed_the_next_class_is_beside_the_cursor_and_a_scale_survives_a_reload(browser: Any) -> None:
    with hb.view(MadeWall(60_000), path=curved_path()) as viewer:
        screen = Screen(browser, viewer.url, "#md=1012&sec=12", (1366, 768), drawn=False)
        screen.page.select_option("#sectionLength", "1:200")
        screen.keyboard.press("Escape")
        screen.evaluate("document.activeElement.blur()")
        screen.keyboard.press("g")
        screen.keyboard.type("1050.5")
        screen.keyboard.press("Enter")
        screen.until("Math.abs(window.__wall.app.view.middle - 1050.5) < 0.01")
        assert screen.evaluate("window.__wall.app.view.cursor.depth") == 1050.5
        screen.keyboard.press("g")  # Enter has left the field
        screen.keyboard.type("9999")
        screen.keyboard.press("Enter")
        screen.page.get_by_text("9999.00 m is outside the wall").wait_for()
        screen.keyboard.press("?")
        screen.until("document.getElementById('help').open && document.getElementById('help').scrollTop === 0")
        screen.keyboard.press("Escape")
        screen.until("document.getElementById('goTo').value === '1050.5'")
        screen.keyboard.press("d")
        screen.keyboard.press("5")
        screen.mouse.move(*place(screen, 130, 1052.0))
        screen.until("document.getElementById('ink').labels.some(({ text }) => text === 'fault')")
        screen.until("window.__wall.addressed()")
        screen.reload()
        screen.until("document.getElementById('sectionLength').value === '1:200'")
        screen.close()


def test_a_string_hangs_in_the_hole_and_is_dragged(browser: Any) -> None:
    depth = np.arange(2000.0, 2016.0, 0.002)
    radius = np.where(abs(depth - 2006) < 0.5, 0.104, 0.108)
    wall = hb.reconstruct(hb.Caliper(depth, depth * 9000 % 360, radius), bit_diameter=0.216)
    string = [hb.RigidBody(0.2, 1.0), hb.RigidBody(0.17, 2.0, 1.0)]
    own = wall.passage(string, sigma=True)
    with hb.view(wall, string=string) as viewer:
        screen = Screen(browser, viewer.url, "#md=2008&sec=16&string=2010", (1366, 768), drawn=False)
        screen.until("window.__wall.app.renderer.look().string?.clearance > 0")
        screen.settle()

        def clearance(at: float) -> str:
            values = [np.interp(at, own.depth + 1.5, column) * 1000 for column in (own.clearance, own.low, own.high)]
            return f"{values[0]:+.1f} mm ({values[1]:+.1f} to {values[2]:+.1f} mm, 95\u00a0%)".replace("-", "−")

        assert screen.readout()["String to 2010.0 m"] == clearance(2010.0)
        labels = [one["text"] for one in screen.evaluate("document.getElementById('ink').labels")]
        assert clearance(2010.0) in labels
        box = screen.evaluate(
            "(({ left, top }, { wall }) => [left + wall.left + wall.width / 2, top + wall.top, wall.height / 16])"
            "(document.getElementById('stage').getBoundingClientRect(), window.__wall.app.renderer.rects)"
        )
        screen.mouse.move(box[0], box[1] + 9.5 * box[2])
        screen.mouse.down()
        screen.mouse.move(box[0], box[1] + 6.5 * box[2], steps=4)
        screen.mouse.up()
        screen.settle()
        dragged = screen.evaluate("window.__wall.app.view.string")
        assert dragged == pytest.approx(2007.0, abs=0.05)
        assert "string=2007" in screen.address()
        tight = screen.readout()[f"String to {dragged:.1f} m"]
        assert float(tight.split()[0]) < 9
        assert screen.evaluate("window.__wall.app.view.middle") == pytest.approx(2008), "the log stays"
        screen.mouse.click(box[0], box[1] + 6.5 * box[2])
        screen.until("window.__wall.app.view.string === null")
        screen.evaluate("window.__wall.app.view.choose({ string: 2016 })")  # to 2 mm, the end of the wall
        screen.until("window.__wall.app.renderer.look().string?.clearance > 0")
        viewer.scene.update_state(string={"bodies": [[0.2, 99.0, 0.0]], "why": "length: must be shorter"})
        screen.until("window.__wall.app.string.why")
        screen.settle()
        assert "length: must be shorter" in screen.readout().values()
        screen.close()


def test_the_picture_on_the_stage_is_saved_as_it_is_seen(browser: Any, viewer: Any) -> None:
    screen = Screen(browser, viewer.url, "#md=1010&sec=20")
    screen.settle()
    with screen.page.expect_download() as download:
        screen.click("#png")
    body = Path(download.value.path()).read_bytes()
    assert body[:8] == b"\x89PNG\r\n\x1a\n"
    assert download.value.suggested_filename.endswith("-1000.0-1020.0.png")
    width, height = (int.from_bytes(body[at : at + 4], "big") for at in (16, 20))
    on_screen = screen.evaluate("[stage.clientWidth, stage.clientHeight]")
    ratio = min(4, 3840 / on_screen[0])
    assert [width, height - 26 * ratio] == pytest.approx([ratio * side for side in on_screen], abs=1.5)
    screen.settle()
    assert screen.evaluate("document.getElementById('ink').width") == on_screen[0], "as before on the screen"
    colours = screen.evaluate(
        """([base64, ratio]) => new Promise((done) => {
          const image = new Image();
          image.onload = () => {
            const canvas = document.createElement('canvas');
            Object.assign(canvas, { width: image.width, height: image.height });
            const ink = canvas.getContext('2d');
            ink.drawImage(image, 0, 0);
            const { left, top, width, height } = window.__wall.app.renderer.rects.image;
            const { data } = ink.getImageData(left * ratio, (top + 26) * ratio, width * ratio, height * ratio);
            const found = new Set();
            for (let i = 0; i < data.length; i += 4) found.add(data[i] * 65536 + data[i + 1] * 256 + data[i + 2]);
            done(found.size);
          };
          image.src = `data:image/png;base64,${base64}`;
        })""",
        [base64.b64encode(body).decode(), ratio],
    )
    assert colours > 50, "the image is in it, not only the ink"
    screen.close()


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_tops_cross_all_tracks_and_the_plan_runs_beside_the_hole(browser: Any, theme: str) -> None:
    depth = np.arange(2000.0, 2040.0, 0.01)
    path = hb.Survey([1900.0, 2100.0], [30.0, 40.0], [40.0, 60.0]).path()
    plan = hb.Survey([1900.0, 2100.0], [30.0, 40.0], [40.0, 50.0]).path()
    wall = hb.reconstruct(
        hb.Caliper(depth, depth * 3600 % 360, np.full(depth.size, 0.11)), bit_diameter=0.216, sectors=32
    )
    wall.intervals = [
        hb.Interval("Heather", 1990.0, 2012.0),
        hb.Interval("Hugin", 2012.0, 2025.5),
        hb.Interval("Sleipner", 2025.5),
    ]
    with hb.view(wall, path=path, plan=plan) as viewer:
        screen = Screen(browser, viewer.url, f"#md=2020&sec=20&theme={theme}", (1366, 768), drawn=False)
        screen.settle()
        y = "(({ view, renderer }) => renderer.rects.axis.top + (%f - view.top) / 20 * renderer.rects.axis.height)"
        y += "(window.__wall.app)"
        labels = screen.evaluate("document.getElementById('ink').labels")
        tops = {one["text"]: one["top"] for one in labels if one["text"] in ("Heather", "Hugin", "Sleipner")}
        for name, depth_of in (("Heather", 2010.0), ("Hugin", 2012.0), ("Sleipner", 2025.5)):
            assert 0 < tops[name] - screen.evaluate(y % depth_of) < 14, "the name stands under its top, or in view"
        strokes = screen.evaluate("document.getElementById('ink').strokes")
        right = screen.evaluate("(({ wall }) => wall.left + wall.width)(window.__wall.app.renderer.rects)")
        for top in (2012.0, 2025.5):
            level = screen.evaluate(y % top)
            across = [
                line for line in strokes if abs(line[1] - level) < 1 and line[1] == line[3] and line[2] >= right - 1
            ]
            assert across, "a line from the depths to the end of the last track"
        screen.evaluate("window.__wall.app.view.point({ depth: 2013, toolface: 10 }, true)")
        screen.settle()
        assert screen.readout()["Interval"] == "Hugin"
        screen.evaluate("window.__wall.app.view.choose({ camera: 'outside' })")
        screen.settle()
        labels, left = screen.evaluate(
            "[document.getElementById('ink').labels, window.__wall.app.renderer.rects.wall.left]"
        )
        assert any(one["text"].startswith("Hugin") and one["left"] > left for one in labels), "beside the hole"
        shown = screen.evaluate("window.__wall.app.store.plan")
        assert np.abs(np.array(shown[-1]) - plan.position([2100.0])[0]).max() < 0.01
        picture = "document.getElementById('ink').toDataURL()"
        with_plan = screen.evaluate(picture)
        screen.evaluate("(window.__wall.app.store.plan = [], window.__wall.app.redraw())")
        screen.settle()
        assert screen.evaluate(picture) != with_plan
        screen.close()


@pytest.mark.parametrize(("length", "address", "shown"), [(45, "", 45), (120, "", 0), (45, "#sec=21", 21)])
def test_a_short_saved_wall_is_whole_at_first_and_a_longer_one_at_its_worst_zone(
    browser: Any, length: float, address: str, shown: float
) -> None:
    """At up to 1:500, unless the address states how long the section is."""
    depth = np.arange(1000.0, 1000.0 + length, 0.01)
    radius = np.where(abs(depth - 1035.0) < 1.0, 0.13, 0.108)
    wall = hb.reconstruct(hb.Caliper(depth, depth * 3600 % 360, radius), bit_diameter=0.216, sectors=32)
    with hb.view(wall) as viewer:
        viewer.scene.update_state(ended=True)
        screen = Screen(browser, viewer.url, address, (1366, 768), drawn=False)
        screen.until("window.__wall.app.opened !== null")
        screen.settle()
        top, bottom = screen.evaluate("(({ view }) => [view.top, view.bottom])(window.__wall.app)")
        screen.close()
    usual = 768 * 0.0254 / 96 * 200  # metres of the height of the window at 1:200
    assert bottom - top == pytest.approx(shown, abs=0.1) if shown else bottom - top < usual
    assert top < 1034 < 1036 < bottom


def test_casings_and_mud_logs_stand_in_tracks_and_the_shoe_in_the_hole(browser: Any) -> None:
    depth = np.arange(2000.0, 2040.0, 0.01)
    wall = hb.reconstruct(
        hb.Caliper(depth, depth * 3600 % 360, np.full(depth.size, 0.11)), bit_diameter=0.216, sectors=32
    )
    wall.intervals = [
        hb.Interval("Conductor", 0.0, 120.0, "Casing", 0.762),
        hb.Interval("Surface", 0.0, 2012.5, "Casing", 0.244),
        hb.Interval("Sandstone, clr to transl, f to m gr, sub-ang to sub-rnd, mod srt", 2005.0, 2020.0, "Lithology"),
        hb.Interval("in feet", 500.0, 510.0, "Shows"),
    ]
    texts = "document.getElementById('ink').labels.map(({ text }) => text)"
    path = hb.Survey([1900.0, 2100.0], [30.0, 40.0], [40.0, 60.0]).path()
    with hb.view(wall, path=path) as viewer:
        address = "#md=2012&sec=20&curves=Casing~Lithology~Shows"
        screen = Screen(browser, viewer.url, address, (1920, 1080), drawn=False)
        screen.until("globalThis.more")
        screen.evaluate("window.__wall.app.view.point({ depth: 2010, toolface: 10 }, true)")
        screen.settle()
        assert {"Casing [mm]", "Surface", "244", "Lithology"} <= set(screen.evaluate(texts))
        words = " ".join(screen.evaluate(texts))
        assert "sub-ang to sub-rnd" in words, "in as many lines as it needs"
        assert "1 outside" in words
        assert "none of 1" in words, "a wrong unit gets a sentence; the rest is drawn"
        read = screen.readout()
        assert read["Casing"] == "Surface, 244 mm, shoe at 2012.5 m"
        assert read["Lithology"].startswith("Sandstone")
        rects = screen.evaluate("window.__wall.app.renderer.rects")
        shoe = rects["axis"]["top"] + (2012.5 - 2002) / 20 * rects["axis"]["height"]
        sides = [line for line in screen.evaluate("document.getElementById('ink').strokes") if line[0] == line[2]]
        for track in ("column0", "wall"):
            left, right = rects[track]["left"], rects[track]["left"] + rects[track]["width"]
            pipe = [line for line in sides if left < line[0] < right and abs(line[3] - shoe) < 1]
            assert len(pipe) == 2, f"both walls of the casing end at the shoe: {track}"
            assert sum(line[0] for line in pipe) == pytest.approx(left + right, abs=2), "about the middle"
        for camera in ("outside", "down"):
            screen.evaluate(f"window.__wall.app.view.choose({{ camera: '{camera}' }})")
            screen.settle()
            assert "shoe Surface, 244 mm" in screen.evaluate(texts)
        rects = "window.__wall.app.renderer.rects"
        for depth, tracks in ((2028.0, {"column1", "column2"}), (2012.0, {"column0", "column1", "column2"})):
            screen.evaluate(f"window.__wall.app.view.centre({depth}, window.__wall.app.store)")
            screen.settle()
            found = {name for name in screen.evaluate(rects) if name.startswith("column")}
            assert found == tracks, "casings have a track where one is in view; a track of a wrong unit stays"
        shown = screen.evaluate("(window.__wall.app.curves.choose('Lithology'), window.__wall.app.view.curves)")
        assert shown == ["Casing", "Shows"]
        screen.settle()
        assert "column2" not in screen.evaluate("window.__wall.app.renderer.rects")
        assert not screen.errors
        screen.close()


def test_a_part_that_does_not_come_is_said_and_the_rest_drawn(browser: Any) -> None:
    depth = np.arange(2000.0, 2005.0, 0.01)
    wall = hb.reconstruct(
        hb.Caliper(depth, depth * 3600 % 360, np.full(depth.size, 0.11)), bit_diameter=0.216, sectors=32
    )
    wall.intervals = [hb.Interval("Surface", 0.0, 2003.0, "Casing", 0.34)]
    with hb.view(wall) as viewer:
        browser.contexts[0].route("**/more.js*", lambda route: route.abort())
        try:
            screen = Screen(browser, viewer.url, "", (1366, 768), drawn=False)
            screen.until("document.getElementById('notice').textContent.includes('did not come')")
            assert not screen.errors
            screen.close()
        finally:
            browser.contexts[0].unroute("**/more.js*")


# Plays a video in the page: how long it is, and how many colours its last frame has.
PLAYED = """([base64, { left, width }]) => new Promise((done, failed) => {
  const video = document.createElement('video');
  video.muted = true;
  video.onerror = () => failed(new Error(video.error.message));
  video.onended = () => {
    const canvas = document.createElement('canvas');
    Object.assign(canvas, { width: video.videoWidth, height: video.videoHeight });
    const ink = canvas.getContext('2d');
    ink.drawImage(video, 0, 0);
    const { data } = ink.getImageData(left + width / 4, canvas.height / 4, width / 2, canvas.height / 2);
    const found = new Set();
    for (let i = 0; i < data.length; i += 4) found.add([0, 1, 2].map((c) => data[i + c] >> 3).join());
    done([video.currentTime, canvas.width, canvas.height, found.size]);
  };
  video.src = `data:video/webm;base64,${base64}`;
  video.play();
})"""


def test_a_flight_is_filmed(browser: Any, viewer: Any) -> None:
    screen = Screen(browser, viewer.url, "#md=1010&sec=5", (1100, 560))
    screen.evaluate("window.__wall.app.view.choose({ camera: 'down' })")
    screen.settle()
    with screen.page.expect_download() as download:
        screen.click("#film")
        screen.until("window.__wall.app.view.top > 1009.5")
        screen.click("#film")
    assert download.value.suggested_filename.endswith(".webm")
    body = Path(download.value.path()).read_bytes()
    assert body[:4] == b"\x1a\x45\xdf\xa3"
    pane = screen.evaluate("(({ left, width }) => ({ left, width }))(window.__wall.app.renderer.rects.wall)")
    player = new_tab(browser)  # an empty page: that of the viewer may load no video
    seconds, width, height, colours = player.evaluate(PLAYED, [base64.b64encode(body).decode(), pane])
    player.close()
    assert seconds > 0.2
    assert [width, height - 26] == screen.evaluate("[stage.clientWidth, stage.clientHeight]")
    assert colours > 20, "the wall is in it, not only the ink"
    assert screen.inner_text("#fly") == "Fly"
    screen.close()


@pytest.mark.parametrize("dip", [20.0, 65.0, 78.0])
def test_a_held_plane_is_seen_whole_from_inside_whatever_its_dip(browser: Any, viewer: Any, dip: float) -> None:
    """Its ring fills much of the pane, and nothing of it is behind the controls or beyond an edge."""
    viewer.scene.change_picks(
        lambda picks: picks.put(Pick(kind="fault", depth=1010.0, toolface=200.0, apparent_dip=dip, radius=0.1))
    )
    screen = Screen(browser, viewer.url, "#md=1010&sec=12&camera=down&tube=1&at=1010.05_10", (1366, 768), drawn=False)
    screen.until("document.getElementById('ink').labels.some(({ text }) => text === 'fault at 1010.00 m')")
    screen.settle()
    ring = screen.evaluate(
        "(({ path, renderer: { gpu, rects: { wall }, look } }) => Array.from({ length: 72 }, (_, i) => {"
        "  const { centre, high, right, tangent } = path.at(1010);"
        "  const [c, s] = [Math.cos(i * Math.PI / 36), Math.sin(i * Math.PI / 36)];"
        f" const along = Math.tan({dip} * Math.PI / 180) * Math.cos((5 * i - 200) * Math.PI / 180);"
        "  return gpu.project({ centre: centre.map((x, j) =>"
        "    x + 0.1 * (c * high[j] + s * right[j] + along * tangent[j])) }, wall); }))(window.__wall.app)"
    )
    assert None not in ring
    across, down = np.array(ring).T
    left, width, height = screen.evaluate(
        "(({ left, width, height }) => [left, width, height])(window.__wall.app.renderer.rects.wall)"
    )
    assert left < across.min() < across.max() < left + width
    assert 80 < down.min() < down.max() < height
    assert np.ptp(across) > 0.3 * width
    screen.close()
    viewer.scene.change_picks(Picks.clear)


def test_a_slide_is_the_view_in_larger_type_and_the_page_stays(browser: Any, viewer: Any) -> None:
    screen = Screen(browser, viewer.url, "#md=1010&sec=20&camera=down", (1366, 768))
    screen.settle()
    before = screen.evaluate("JSON.stringify([window.__wall.app.renderer.rects, window.__wall.app.view.top])")
    with screen.page.expect_download() as download:
        screen.click("#slide")
    assert download.value.suggested_filename == "Made-1-1000.0-1020.0-inside.slide.png"
    wide, high = struct.unpack(">II", Path(download.value.path()).read_bytes()[16:24])
    assert [wide, high] == [3840, 2160], "960 by 540 points, as a slide has"
    screen.settle()
    assert screen.evaluate("JSON.stringify([window.__wall.app.renderer.rects, window.__wall.app.view.top])") == before
    screen.close()


@pytest.mark.parametrize("address", ["#md=1010&sec=20", "#md=1010&sec=6&camera=down&tab=3d"])
def test_a_picture_with_picks_is_16_to_9_and_filled(browser: Any, viewer: Any, address: str) -> None:
    for depth in (1008.5, 1010.0):
        pick = Pick(kind="fracture", depth=depth, toolface=40.0, apparent_dip=40.0)
        viewer.scene.change_picks(lambda picks, pick=pick: picks.put(pick))
    screen = Screen(browser, viewer.url, address, (1366, 768), drawn=False)
    screen.until("window.__wall.app.picking.kept.length === 2")
    screen.settle()
    with screen.page.expect_download() as download:
        screen.click("#png")
    body = Path(download.value.path()).read_bytes()
    wide, high = struct.unpack(">II", body[16:24])
    assert wide / high == pytest.approx(16 / 9, rel=0.01)
    emptiest = screen.evaluate(
        """([base64, share]) => new Promise((done) => {
          const image = new Image();
          image.onload = () => {
            const canvas = document.createElement('canvas');
            Object.assign(canvas, { width: 800, height: 450 });
            const ink = canvas.getContext('2d');
            ink.drawImage(image, 0, 0, 800, 450);
            const left = Math.round(800 * share);
            const { data } = ink.getImageData(left, 0, 800 - left, 450);
            const marked = Array.from({ length: 450 }, (_, y) => {
              const row = data.slice(4 * y * (800 - left), 4 * (y + 1) * (800 - left));
              return row.some((one, i) => i % 4 < 3 && Math.abs(one - row[i % 4]) > 24);
            });
            let [empty, most] = [0, 0];
            for (const one of marked) { empty = one ? 0 : empty + 1; most = Math.max(most, empty); }
            done(most / 450);
          };
          image.src = `data:image/png;base64,${base64}`;
        })""",
        [
            base64.b64encode(body).decode(),
            screen.evaluate("stage.clientWidth / (stage.clientHeight + 26)") * high / wide,
        ],
    )
    assert emptiest < 0.25, "of the height beside the view"
    screen.close()
    viewer.scene.change_picks(Picks.clear)


def test_the_eye_inside_goes_before_the_selected_pick(browser: Any, viewer: Any) -> None:
    for depth in (1003.0, 1018.0):
        pick = Pick(kind="fracture", depth=depth, toolface=40.0, apparent_dip=40.0)
        viewer.scene.change_picks(lambda picks, pick=pick: picks.put(pick))
    screen = Screen(browser, viewer.url, "#md=1010&sec=20", (1366, 768), drawn=False)
    screen.until("window.__wall.app.picking.kept.length === 2")
    screen.keyboard.press("d")
    before = (
        "(({ path, renderer: { gpu, rects } }) => [%f, %f].map((depth) => Boolean(gpu.project(path.at(depth),"
        " rects.wall))))(window.__wall.app)"
    )
    screen.mouse.click(*place(screen, 130, 1018.0))
    screen.until("window.__wall.app.picking.pick")
    screen.keyboard.press("i")
    screen.settle()
    assert "fracture at 1018.00 m" in [one["text"] for one in screen.evaluate("ink.labels")]
    assert screen.evaluate(before % (1017.5, 1018.1)) == [False, True]
    screen.mouse.click(*place(screen, 130, 1003.0))
    screen.settle()
    assert "fracture at 1003.00 m" in [one["text"] for one in screen.evaluate("ink.labels")], "another pick is selected"
    assert screen.evaluate(before % (1002.5, 1003.1)) == [False, True]
    screen.mouse.click(*place(screen, 130, 1009.0))
    screen.settle()
    assert screen.evaluate("window.__wall.app.view.pinned") is False, "the next pick follows the pointer"
    assert screen.evaluate(before % (1002.5, 1003.1)) == [False, True], "the eye stays"
    screen.keyboard.press("i")
    screen.until("document.getElementById('camera').value === 'straight'")
    screen.close()
    viewer.scene.change_picks(Picks.clear)


def test_a_picture_waits_for_the_parts_of_the_wall_that_have_not_arrived(browser: Any, viewer: Any) -> None:
    screen = Screen(browser, viewer.url, "#md=1010&sec=10", drawn=False)
    screen.settle()
    screen.evaluate(
        "(() => { const [{ tiles }] = window.__wall.app.store.levels; const has = tiles.has.bind(tiles);"
        " let came = 0; tiles.has = (index) => came && has(index);"
        " const toBlob = HTMLCanvasElement.prototype.toBlob;"
        " HTMLCanvasElement.prototype.toBlob = function (...more) {"
        "  window.__saved = came; return toBlob.apply(this, more); };"
        " setTimeout(() => { came = 1; }, 500); })()"
    )
    with screen.page.expect_download():
        screen.click("#png")
    assert screen.evaluate("window.__saved") == 1
    screen.close()


# Keeps the look of the next slide.
LOOK_OF_SLIDE = """(() => { const { gpu } = window.__wall.app.renderer; const draw = gpu.draw.bind(gpu);
 gpu.draw = (look, ...more) => {
  if (document.getElementById('ink').slide) window.__look = look;
  return draw(look, ...more); }; })()"""
# How many pieces of the wall and of its overview a look has.
PIECES = """(({ store: { levels }, wallPieces }) =>
 levels.map((level) => wallPieces.filter(({ tile }) => tile.level === level).length))"""


def pieces_of_slide(screen: Screen, pieces: str) -> Any:
    """Save a slide, and return how many pieces its look has."""
    screen.evaluate(LOOK_OF_SLIDE)
    with screen.page.expect_download():
        screen.click("#slide")
    return screen.evaluate(f"{pieces}(window.__look)")


def test_a_picture_of_a_long_section_shows_the_wall_and_not_its_overview(browser: Any) -> None:
    """A section of 80 tiles is drawn from the overview while it moves, whose cells are 45 degrees wide."""
    with hb.view(MadeWall(80 * 256 * 64, pitch=0.005), path=curved_path()) as viewer:
        screen = Screen(browser, viewer.url, "#md=1051&sec=101&camera=outside&tab=3d", drawn=False)
        screen.settle()
        assert screen.evaluate(f"{PIECES}(window.__wall.app.renderer.look())") == [0, 2]
        assert pieces_of_slide(screen, PIECES) == [80, 0]
        assert screen.evaluate(f"{PIECES}(window.__wall.app.renderer.look())") == [0, 2], "the page as before"
        screen.close()


def test_tracks_of_a_slide_are_drawn_from_the_wall_by_the_pixels_of_the_picture(browser: Any) -> None:
    """Forty metres in 6 mm turns are fine on the page; the slide is laid out in fewer pixels, and has four to each."""
    pieces = PIECES.replace("wallPieces", "imagePieces")
    with hb.view(MadeWall(28 * 256 * 64, pitch=0.006), path=curved_path()) as viewer:
        screen = Screen(browser, viewer.url, "#md=1021&sec=44", (1600, 900), drawn=False)
        screen.settle()
        assert screen.evaluate(f"{pieces}(window.__wall.app.renderer.look())") == [28, 0]
        assert pieces_of_slide(screen, pieces) == [28, 0]
        screen.close()


def test_the_overview_is_drawn_round(browser: Any) -> None:
    """From the end of a straight hole its outline is a circle: eight cells around are no eight corners."""
    path = hb.Survey([970.0, 1200.0], [0.0, 0.0], [0.0, 0.0]).path(extend=100.0, reference="north")
    wall = MadeWall(80 * 256 * 64, pitch=0.005)
    wall.radius[:] = BIT / 2
    with hb.view(wall, path=path) as viewer:
        screen = Screen(browser, viewer.url, "#md=1051&sec=101&camera=outside&tab=3d&tube=20")
        screen.settle()
        screen.evaluate(
            "(() => { const { renderer, view } = window.__wall.app;"
            " view.eye = [0, 0.01, 64, 0, 0, 0]; renderer.aim(); })()"
        )
        screen.settle()
        seen = screen.pixels("wall")[..., :3].astype(int)
        y, x = np.nonzero((np.abs(seen - seen[0, 0]) > 12).any(axis=2))
        angles, far = np.arctan2(y - y.mean(), x - x.mean()), np.hypot(x - x.mean(), y - y.mean())
        rim = [far[(angles > at) & (angles <= at + math.pi / 36)].max() for at in np.arange(-36, 36) * math.pi / 36]
        screen.close()
    assert min(rim) > 0.97 * max(rim), rim


def test_the_path_over_the_full_width_is_looked_at_anew_and_straight_turns_the_head_back(browser: Any) -> None:
    path = hb.Survey([970.0, 1100.0], [60.0, 60.0], [70.0, 70.0]).path(extend=100.0)
    with hb.view(MadeWall(20_000), path=path) as viewer:
        screen = Screen(browser, viewer.url, "#md=1008&sec=20&camera=outside", (1366, 768), drawn=False)
        screen.settle()
        ends = (
            "(({ view, path, renderer: { gpu, rects: { wall } } }) => [view.top, view.bottom].map((depth) =>"
            " gpu.project(path.at(depth), wall)[0]))(window.__wall.app)"
        )
        before = np.ptp(screen.evaluate(ends))
        screen.click("#whole")
        screen.settle()
        assert np.ptp(screen.evaluate(ends)) > 1.5 * before
        screen.evaluate("window.__wall.app.view.choose({ camera: 'down' })")
        screen.evaluate("window.__wall.app.view.head = [0.5, 0.2]")
        screen.evaluate("window.__wall.app.view.choose({ camera: 'straight' })")
        assert screen.evaluate("window.__wall.app.view.head") == [0, 0]
        screen.close()


@pytest.mark.parametrize("camera", ["straight", "down"])
def test_a_slide_has_whole_heads_and_no_hint_or_scale(browser: Any, camera: str) -> None:
    wall = MadeWall(12_800)
    name = "a name of an image that is longer than the head of its track on a slide"
    with hb.view(wall, attributes={hb.Attribute(name, "m"): np.linspace(0, 0.01, 12_800)}) as viewer:
        screen = Screen(browser, viewer.url, f"#md=1010&sec=20&camera={camera}&at=1010_40", (1366, 768))
        screen.evaluate(f"window.__wall.app.selection.setQuantity('{name}')")
        screen.settle()
        screen.evaluate(
            "(() => { const { renderer } = window.__wall.app; const draw = renderer.drawInk.bind(renderer);"
            " renderer.drawInk = (look) => { draw(look);"
            " if (document.getElementById('ink').slide)"
            " window.__slide = document.getElementById('ink').labels.map(({ text }) => text),"
            " window.__cursor = look.view.cursor; }; })()"
        )
        with screen.page.expect_download():
            screen.click("#slide")
        screen.settle()
        said = screen.evaluate("window.__slide")
        assert not [text for text in said if text.startswith(("Pick dips", "1:")) or "…" in text], said
        assert name in said
        assert screen.evaluate("[window.__cursor, window.__wall.app.view.cursor.depth]") == [None, 1010], "no cursor"
        assert screen.evaluate("document.getElementById('ink').slide === undefined")
        screen.close()


def test_the_view_is_saved_as_a_vector_picture(browser: Any, viewer: Any) -> None:
    """Each text of the picture stands where the page has it, and the wall is a picture in it."""
    pick = hb.Pick(kind="fracture", depth=1010.0, apparent_dip=50.0, toolface=90.0)
    viewer.scene.change_picks(lambda picks: picks.put(pick))
    screen = Screen(browser, viewer.url, "#md=1010&sec=20&camera=down", (1366, 768))
    screen.until("window.__wall.app.picking.kept.length")
    screen.settle()
    with screen.page.expect_download() as download:
        screen.click("#svg")
    assert download.value.suggested_filename == "Made-1-1000.0-1020.0-inside.svg"
    root = ElementTree.parse(download.value.path()).getroot()
    labels = screen.evaluate("document.getElementById('ink').labels")
    svg = "{http://www.w3.org/2000/svg}"
    (shown,) = [group for group in root.iter(f"{svg}g") if group.get("transform") == "translate(0 26)"]
    texts = [(text.text, float(text.get("y", "nan"))) for text in shown.iter(f"{svg}text")]
    assert len(labels) > 20
    for one in labels:
        places = [y for text, y in texts if text == one["text"]]
        assert any(one["top"] - 1 < y < one["bottom"] + 4 for y in places), one
    pictures = [image for image in root.iter(f"{svg}image") if float(image.get("width", "0")) > 500]
    wide, high = struct.unpack(">II", base64.b64decode(pictures[0].get("href", "").split(",")[1])[16:24])
    assert [wide, high] == screen.evaluate("[2 * stage.clientWidth, 2 * stage.clientHeight]")
    listed = [text.text for text in root.iter(f"{svg}text")]
    assert "fracture" in listed, "beside the stereonet"
    assert any("lower hemisphere" in (text or "") for text in listed)
    assert not list(root.iter(f"{svg}script"))
    screen.close()
    viewer.scene.change_picks(Picks.clear)

"""The page on any screen: tabs below 1000 px, a large read-out below 600 px, more on 4K; keyboard for all."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from made_wall import MadeWall, curved_path, gamma_and_resistivity
from screen import NEEDS_BROWSER, Screen

import helibore as hb

pytestmark = NEEDS_BROWSER

LONG = "volve_F-12_2010_pfcs_xy_caliper"
OUTSIDE = """[...document.querySelectorAll('button, select, input, canvas, p, dt, dd')]
  .filter((e) => e.checkVisibility() && !e.closest('aside, #zones, .unseen'))
  .map((e) => [e.id || e.textContent, e.getBoundingClientRect()])
  .filter(([, { left, right, bottom }]) => left < -0.5 || right > innerWidth + 0.5 || bottom > innerHeight + 0.5)
  .map(([name]) => name)"""


@pytest.mark.parametrize("size", [(390, 844), (820, 1180)])
def test_tabs_show_one_panel_each_within_the_screen(browser: Any, size: tuple[int, int]) -> None:
    wall = MadeWall(30_000)
    with hb.view(wall, path=curved_path(), attributes=gamma_and_resistivity(wall), well=LONG) as viewer:
        screen = Screen(browser, viewer.url, "#md=1020&sec=30", size, drawn=False)
        screen.until("window.__wall.app.zones.length")
        assert screen.inner_text("#well") == screen.get_attribute("#well", "title") == LONG
        cut = "[well, lampText].filter((e) => e.scrollHeight > e.clientHeight + 1 || e.scrollWidth > e.clientWidth + 1)"
        assert screen.evaluate(f"{cut}.map((e) => e.id)") == []
        shown = {"log": "#ink", "3d": "#ink", "section": "#turn", "zones": "#zones"}
        tabs: dict[str, Any] = {}
        for tab, panel in shown.items():
            screen.click(f"#tabs button[value='{tab}']")
            screen.settle()
            assert screen.is_visible(panel)
            assert screen.is_visible("#section") == (tab == "section")
            at = screen.locator("#tabs").bounding_box()
            assert at == tabs.setdefault("at", at), "the tabs stay where they are"
            assert screen.is_visible("#rigOpen") == (size[0] >= 600)
            assert screen.evaluate(OUTSIDE) == []
            widths = screen.evaluate(
                "(({ image, wall }) => [image.width, wall.width])(window.__wall.app.renderer.rects)"
            )
            assert (widths[0] > 150, widths[1] > 150) == (tab != "3d", tab == "3d")
            assert screen.touching("ink") == []
            assert screen.struck("ink") == []
            assert screen.cut_selects() == []
            letters = [one for one in screen.evaluate("ink.labels") if one["text"] in ("W", "B") and one["left"] < 80]
            strip = screen.evaluate("(({ axis }) => [axis.left, axis.left + 14])(window.__wall.app.renderer.rects)")
            assert all(strip[0] <= one["left"] and one["right"] <= strip[1] for one in letters)
            assert letters or tab not in ("log", "3d")
            if tab == "3d":
                end = screen.evaluate("(({ wall }) => wall.left + wall.width)(window.__wall.app.renderer.rects)")
                sizes = [one for one in screen.evaluate("ink.labels") if re.match("[WB] [+]", one["text"])]
                assert sizes
                assert all(one["left"] > end for one in sizes), "beside the hole, not on it"
            if tab == "section":
                assert screen.struck("polar") == []
                assert {"C1", "C2", "bit"} <= {one["text"] for one in screen.evaluate("polar.labels")}
            texts = [one["text"] for one in screen.evaluate("document.getElementById('ink').labels")]
            assert tab not in ("log", "3d") or "Over bit radius [mm]" in texts
            if tab == "3d":
                low, high = screen.evaluate("(({ low, high }) => [low, high])(window.__wall.app.selection.quantity)")
                assert {f"−{-1000 * low:g}", f"{1000 * high:g}"} <= set(texts), "its colour bar"
        screen.click("#tabs button[value='log']")
        screen.keyboard.press("ArrowDown")
        screen.settle()
        if size[0] < 600:
            depth = screen.evaluate("window.__wall.app.view.cursor.depth")
            assert screen.inner_text("#briefDepth") == f"{depth:.2f} m"
            assert screen.evaluate("getComputedStyle(document.getElementById('briefDepth')).fontSize") == "34px"
        assert "tab=" not in screen.address()
        screen.close()


@pytest.mark.parametrize("size", [(390, 844), (768, 1024)])
def test_every_tab_is_about_the_section_of_the_log_at_any_scale(browser: Any, size: tuple[int, int]) -> None:
    section = "(({ top, length }) => [top, length])(window.__wall.app.view)"
    with hb.view(MadeWall(64_000)) as viewer:
        screen = Screen(browser, viewer.url, "#md=1050", size, drawn=False)
        screen.settle()
        assert screen.evaluate("window.__wall.app.renderer.paper") == 200
        top, length = screen.evaluate(section)
        for tab in ("3d", "section", "zones", "section", "log"):
            screen.click(f"#tabs button[value='{tab}']")
            screen.settle()
            assert screen.evaluate(section) == [top, length], tab
            if tab == "section":
                assert screen.inner_text("#sectionTitle") == f"{top:.1f}–{top + length:.1f} m"
        assert screen.evaluate("window.__wall.app.renderer.paper") == 200
        screen.close()
        if size[0] >= 600:
            screen = Screen(browser, viewer.url, "#tab=section", size, drawn=False)
            assert screen.evaluate("window.__wall.app.view.length") == pytest.approx(length, rel=1e-3)
            screen.close()


@pytest.mark.parametrize("size", [(820, 1180), (768, 1024)])
def test_a_tablet_shows_every_figure_of_the_cross_section_in_a_zone(browser: Any, size: tuple[int, int]) -> None:
    with hb.view(MadeWall(30_000)) as viewer:
        screen = Screen(browser, viewer.url, "", size, drawn=False)
        screen.until("window.__wall.app.zones.length")
        screen.keyboard.press("n")
        screen.settle()
        names = screen.evaluate("[...document.querySelectorAll('#turn dt')].map((e) => e.textContent)")
        assert "Zone" in names
        assert names[-1] != "Zone", "what the zone is judged by"
        ends = "[...document.querySelectorAll('#turn dd')].at(-1).getBoundingClientRect().bottom"
        assert screen.evaluate(ends) <= screen.evaluate("crossSection.getBoundingClientRect().bottom")
        screen.close()


def test_the_read_out_of_a_phone_says_why_a_value_is_missing(browser: Any) -> None:
    wall = MadeWall(30_000)
    said = "Object.fromEntries([...briefMore.children].map((e, i, all) => [e.textContent, all[i + 1]?.textContent]))"
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, "#md=1020&sec=20", (390, 844), drawn=False)
        rows = {}
        for cursor in (None, {"depth": 1020, "toolface": 10}, {"depth": 1012.3, "toolface": 10}):
            screen.evaluate("(cursor) => window.__wall.app.view.point(cursor, true)", cursor)
            screen.settle()
            rows[str(cursor and cursor["depth"])] = screen.evaluate(said)
        assert (rows["None"]["Over bit"], rows["None"]["TVD"]) == ("tap image", "no survey")
        assert rows["1020"]["Over bit"].endswith(" mm")
        assert [rows["1012.3"][name] for name in ("C1", "C2", "Over bit")] == ["no data"] * 3
        screen.close()


def test_the_log_of_a_phone_is_as_high_in_a_zone_as_outside_and_comes_to_rest(browser: Any) -> None:
    """The depth in words is that of the middle: where a zone made it higher, it changed section and middle."""
    with hb.view(MadeWall(40_000), path=curved_path()) as viewer:
        screen = Screen(browser, viewer.url, "", (390, 844), drawn=False)
        screen.until("window.__wall.app.zones.length")
        screen.settle()
        heights = set()
        for depth in (1010.0, "window.__wall.app.zones[0].start + 0.1"):
            screen.evaluate(f"window.__wall.app.view.point({{ depth: {depth}, toolface: 10 }}, true)")
            screen.settle()
            heights.add(screen.evaluate("window.__wall.app.renderer.rects.image.height"))
        assert screen.inner_text("#briefZone") not in ("", "no zone")
        assert len(heights) == 1
        screen.close()


def test_a_tab_without_zones_says_so(browser: Any) -> None:
    caliper = hb.Caliper.gauge(2000.0, 2010.0, 0.216)
    with hb.view(hb.reconstruct(caliper, bit_diameter=0.216, sectors=16)) as viewer:
        screen = Screen(browser, viewer.url, "", (390, 844), drawn=False)
        assert not screen.is_visible("#zonesTitle")
        assert screen.inner_text("#briefZone") == "not measured"
        screen.click("#tabs button[value='zones']")
        screen.settle()
        assert screen.is_visible("#zonesTitle")
        assert screen.inner_text("#zonesTitle") == "Zones need a caliper"
        screen.close()


@pytest.mark.parametrize(
    ("bit", "criteria", "words"),
    [
        (0.0958, None, "No zone: washout from 12.7 mm, breakout from 25.4 mm; zones.scaled lowers both"),
        (0.0958, hb.Criteria.scaled(0.0958), "No zone: washout from 5.6 mm, breakout from 11.3 mm"),
        (0.216, None, "No zone: washout from 12.7 mm, breakout from 25.4 mm"),
    ],
)
def test_no_zone_names_the_limits(browser: Any, bit: float, criteria: hb.Criteria | None, words: str) -> None:
    """So that nobody takes a slim hole for a smooth one because its breakouts do not reach limits in inches."""
    turns = np.arange(0.0, 100.0, 1 / 32)
    caliper = hb.Caliper(2000.0 + 0.1 * turns, 360.0 * turns % 360.0, np.full(turns.size, 0.5 * bit))
    wall = hb.reconstruct(caliper, bit_diameter=bit, sectors=16)
    with hb.view(wall, criteria=criteria) as viewer:
        screen = Screen(browser, viewer.url, "", (1366, 768), drawn=False)
        screen.until("document.getElementById('zonesTitle').textContent")
        assert screen.inner_text("#zonesTitle") == words
        cut = "(({ scrollHeight, clientHeight }) => scrollHeight - clientHeight)(document.getElementById('%s'))"
        assert screen.evaluate(cut % "zonesTitle") <= 0
        assert screen.evaluate(cut % "zonesCard") <= 0
        screen.close()


@pytest.mark.parametrize("size", [(900, 700), (700, 600), (999, 800)])
def test_a_low_window_gives_its_height_to_the_log(browser: Any, size: tuple[int, int]) -> None:
    image = "window.__wall.app.renderer.rects.image.height"
    with hb.view(MadeWall(30_000), path=curved_path()) as viewer:
        viewer.scene.update_state(prints=True)
        screen = Screen(browser, viewer.url, "#md=1020&sec=12", size, drawn=False)
        screen.settle()
        assert screen.evaluate(image) > 0.5 * size[1]
        screen.keyboard.press("d")
        screen.settle()
        assert screen.evaluate(image) > 0.33 * size[1]
        stage = screen.evaluate("document.getElementById('stage').getBoundingClientRect().bottom")
        boxes = [screen.locator(name).bounding_box() for name in ("#pickClass", "#dipUndo", "#dipPrint", "#dipText")]
        assert all(box["y"] >= stage and box["y"] + box["height"] <= size[1] for box in boxes)
        assert screen.evaluate("(({ scrollHeight, clientHeight }) => scrollHeight - clientHeight)(dips)") <= 0
        cut = "[...document.querySelectorAll('#dips button')].filter((e) => e.scrollWidth > e.clientWidth).length"
        assert screen.evaluate(cut) == 0
        screen.close()


FINGER = """(moves) => {
  const { app } = window.__wall;
  const ink = document.getElementById('ink');
  const { left, top } = ink.getBoundingClientRect();
  ink.setPointerCapture = () => {};
  const { image } = app.renderer.rects;
  for (const [type, toolface, depth] of moves) {
    const turn = (((toolface - (app.path.dial(depth).up ?? 0)) % 360) + 360) % 360 / 360;
    const x = image.left + turn * image.width;
    const y = image.top + ((depth - app.view.top) / app.view.length) * image.height;
    const at = { clientX: left + x, clientY: top + y, buttons: type === 'pointerup' ? 0 : 1 };
    ink.dispatchEvent(new PointerEvent(type, { pointerId: 1, pointerType: 'touch', bubbles: true, ...at }));
  }
}"""


@pytest.mark.parametrize("size", [(390, 844), (768, 1024)])
def test_a_finger_draws_a_sine_classes_deletes_and_restores_it(browser: Any, size: tuple[int, int]) -> None:
    with hb.view(MadeWall(30_000), path=curved_path()) as viewer:
        screen = Screen(browser, viewer.url, "#md=1020&sec=12", size, drawn=False)
        screen.click("#menu")
        keys = screen.locator("#keys").bounding_box()
        assert min(keys["width"], keys["height"]) >= 44
        screen.click("#dipOpen")
        screen.settle()
        said = [screen.inner_text("#dipText")]
        buttons = ["#pickClass", "#dipUndo", "#dipLoad", "#dipClose"]
        boxes = [screen.locator(button).bounding_box() for button in buttons]
        assert all(box["x"] >= 0 and box["x"] + box["width"] <= size[0] and box["height"] >= 44 for box in boxes)
        image = screen.evaluate(
            "document.getElementById('stage').getBoundingClientRect().top + window.__wall.app.renderer.rects.image.top"
            " + window.__wall.app.renderer.rects.image.height"
        )
        assert all(image <= box["y"] and box["y"] + box["height"] <= size[1] for box in boxes), "below the image"
        crest, half, trough = (120.0, 1019.0), (210.0, 1020.0), (290.0, 1020.9)
        screen.evaluate(FINGER, [["pointerdown", *crest], ["pointermove", *half], ["pointermove", *trough]])
        screen.evaluate(FINGER, [["pointerup", *trough]])
        screen.until("window.__wall.app.picking.kept.length && !window.__wall.app.picking.dragged")
        assert screen.evaluate("window.__wall.app.picking.pick") is not None, "its class and name can be given at once"
        made = screen.evaluate("window.__wall.app.picking.kept[0]")
        screen.until("!document.getElementById('notice').hidden")
        assert re.match(r"bed at 10\d\d\.\d\d m: true dip \d", screen.inner_text("#notice"))
        screen.evaluate("window.__wall.app.notice('')")
        screen.evaluate(FINGER, [["pointerdown", 210.0, made["depth"]], ["pointerup", 210.0, made["depth"]]])
        screen.until("window.__wall.app.picking.pick")
        rise, angles = np.array([1019.0, 1020.0, 1020.9]), np.radians([120.0, 210.0, 290.0])
        across = np.column_stack([np.ones(3), np.cos(angles), np.sin(angles)])
        middle, *slopes = np.linalg.solve(across, rise)  # the sine through the three points
        assert made["toolface"] == pytest.approx(np.degrees(np.arctan2(slopes[1], slopes[0])) % 360, abs=2)
        assert made["depth"] == pytest.approx(middle, abs=0.02)
        text = "document.getElementById('dipText').textContent"
        screen.until(f"{text}.includes('3 points, no misfit')")  # of the next frame
        said.append(screen.inner_text("#dipText"))
        if size[0] < 600:
            numbers = [field.bounding_box() for field in screen.locator("#pickFields input").all()]
            fold = screen.locator("#tabs").bounding_box()["y"]
            assert len(numbers) == 4
            assert all(box["height"] >= 44 and box["y"] + box["height"] <= fold for box in numbers), "in view"
        moved = [("pointerdown", 210.0, made["depth"]), ("pointermove", 210.0, made["depth"] + 1)]
        screen.evaluate(FINGER, [*moved, ["pointerup", 210.0, made["depth"] + 1]])
        screen.page.select_option("#pickClass", "fracture")
        screen.until("window.__wall.app.picking.pick.kind === 'fracture'")
        assert screen.evaluate("window.__wall.app.picking.pick.depth") == pytest.approx(made["depth"] + 1, abs=0.02)
        screen.page.select_option("#pickClass", "breakout")  # no class of a plane: that of the next pick
        screen.until("window.__wall.app.picking.kind === 'breakout' && !window.__wall.app.picking.pick")
        assert screen.evaluate("window.__wall.app.picking.kept[0].kind") == "fracture"
        screen.settle()
        said.append(screen.inner_text("#dipText"))
        assert len(set(said)) == 3
        assert not re.search("click|digit", "".join(said), re.IGNORECASE), "a finger has neither"
        screen.page.select_option("#pickClass", "bed")
        screen.evaluate("window.__wall.app.picking.selected = window.__wall.app.picking.kept[0].key")
        screen.evaluate("window.__wall.app.redraw()")
        screen.click("#dipRemove")
        screen.until("window.__wall.app.picking.kept.length === 0")
        for _ in range(3):
            screen.click("#dipUndo")
        screen.until("window.__wall.app.picking.kept.length === 1")
        (kept,) = screen.evaluate("window.__wall.app.picking.kept")
        assert (kept["kind"], kept["depth"]) == ("bed", pytest.approx(made["depth"]))
        screen.close()


def test_the_keyboard_moves_the_cursor_and_the_page_says_where_it_is(browser: Any) -> None:
    with hb.view(MadeWall(60_000)) as viewer:
        screen = Screen(browser, viewer.url, "#md=1020&sec=20", drawn=False)
        for key in ("ArrowDown", "ArrowRight", "ArrowRight"):
            screen.keyboard.press(key)
        cursor = screen.evaluate("window.__wall.app.view.cursor")
        assert cursor["depth"] == pytest.approx(1020.1)
        assert cursor["toolface"] == pytest.approx(2 * 360 / 64)
        over = screen.readout()["Over bit radius"]
        assert "mm" in over
        screen.until(f"document.getElementById('spoken').textContent.startsWith('1020.10 m, over bit {over}')")
        screen.keyboard.press("End")
        assert screen.evaluate("window.__wall.app.view.bottom - window.__wall.app.store.span[1]") == pytest.approx(0)
        screen.keyboard.press("+")
        assert screen.evaluate("window.__wall.app.view.length") == pytest.approx(20 / 1.5)
        screen.close()


def test_the_cursor_has_its_values_in_a_section_longer_than_the_tiles_that_are_held(browser: Any) -> None:
    with hb.view(MadeWall(4_000_000)) as viewer:
        screen = Screen(browser, viewer.url, "#md=3600&sec=4000", drawn=False)
        app = "window.__wall.app"
        seen = f"{app}.store.levels[0].tilesBetween({app}.view.top, {app}.view.bottom).length"
        assert screen.evaluate(seen) > 64
        for key in ("ArrowDown", "ArrowRight"):
            screen.keyboard.press(key)
        screen.until("/over bit .*mm/.test(document.getElementById('spoken').textContent)")  # once its tile has come
        assert "mm" in screen.readout()["Over bit radius"]
        screen.close()


def test_4k_shows_more_in_larger_text_and_the_pointer_hits(browser: Any) -> None:
    with hb.view(MadeWall(30_000)) as viewer:
        screen = Screen(browser, viewer.url, "#md=1020&sec=20", (3840, 2160), drawn=False)
        image = screen.evaluate("window.__wall.app.renderer.rects.image")
        stage = screen.evaluate("document.getElementById('stage').getBoundingClientRect().toJSON()")
        assert stage["width"] > 2800
        assert screen.evaluate("window.__wall.app.renderer.rects.image.height") > 1000
        screen.mouse.move(
            stage["left"] + 1.75 * (image["left"] + image["width"] / 2),
            stage["top"] + 1.75 * (image["top"] + image["height"] / 2),
        )
        screen.until("window.__wall.app.view.cursor")
        cursor = screen.evaluate("window.__wall.app.view.cursor")
        assert cursor["depth"] == pytest.approx(1020, abs=0.05)
        assert cursor["toolface"] == pytest.approx(180, abs=1)
        screen.close()

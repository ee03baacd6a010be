"""What a geologist would look at first: nothing overlaps, nothing is cut off, the same depth is at the same place in
every panel, and what is not known is not shown as if it were. At both sizes of screen that people have at the rig."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from made_wall import MadeWall, curved_path, gamma_and_resistivity
from screen import NEEDS_BROWSER, Screen

import helibore as hb

pytestmark = NEEDS_BROWSER

SIZES = [(1366, 768), (1920, 1080)]
VIEWS = [
    "#md=1012&sec=24",
    "#md=1012.3&sec=3&quantity=RES&units=in&theme=dark",
    "#md=1200&sec=420&quantity=GR&cut=north&shape=5",
    "#md=1012&sec=12&camera=down",
    "",  # following the bit
]
# Row by row of pixels of the ink canvas, in CSS pixels, the share of a column range that has a colour.
ROWS_OF = """([name, rgb]) => {
  const canvas = document.getElementById('ink');
  const { left, top, width, height } = window.__wall.app.renderer.rects[name];
  const got = canvas.getContext('2d').getImageData(left, top, width, height).data;
  const rows = [];
  for (let y = 0; y < height; y++) {
    let count = 0;
    for (let x = 0; x < width; x++) {
      const i = 4 * (y * width + x);
      if (rgb.every((value, c) => Math.abs(got[i + c] - value) < 40) && got[i + 3] > 100) count++;
    }
    rows.push(count / width);
  }
  return rows;
}"""
# Row by row of pixels of a panel's ink, whether a pixel has a colour.
INK_OF = """([name, rgb]) => {
  const { left, top, width, height } = window.__wall.app.renderer.rects[name];
  const got = document.getElementById('ink').getContext('2d').getImageData(left, top, width, height);
  const drawn = (i) => got.data[i + 3] > 200 && rgb.every((value, c) => Math.abs(got.data[i + c] - value) < 12);
  return Array.from({ length: got.height }, (_, y) =>
    Array.from({ length: got.width }, (_, x) => Number(drawn(4 * (y * got.width + x)))));
}"""
CURSOR = [0xE8, 0x41, 0x0D]  # in the 3-D view
INK = [0x1B, 0x21, 0x26]


@pytest.fixture(scope="module")
def viewer() -> Iterator[Any]:
    wall = MadeWall(300_000)
    with hb.view(wall, path=curved_path(), attributes=gamma_and_resistivity(wall), well="Made-1 T2") as viewer:
        viewer.scene.update_state(bit_depth=1477.5)
        yield viewer


@pytest.mark.parametrize("address", VIEWS)
def test_no_text_touches_another_or_leaves_its_canvas(browser: Any, viewer: Any, address: str) -> None:
    screen = Screen(browser, viewer.url, address, SIZES[0], drawn=False)
    for down in (None, 0.33, 0.62):
        for size in SIZES:
            screen.page.set_viewport_size({"width": size[0], "height": size[1]})
            screen.until(f"innerWidth === {size[0]} && innerHeight === {size[1]}")
            screen.settle()
            if down is not None:
                screen.point_at(0.31, down)
            for canvas in ("ink", "polar"):
                labels = screen.evaluate(f"document.getElementById('{canvas}').labels")
                assert len(labels) > 4
                assert screen.touching(canvas) == [], (canvas, size)
                assert screen.struck(canvas) == [], (canvas, size)
                wide, tall = screen.evaluate(
                    "(({clientWidth, clientHeight}) => [clientWidth, clientHeight])"
                    f"(document.getElementById('{canvas}'))"
                )
                outside = [
                    one["text"]
                    for one in labels
                    if one["left"] < 0 or one["top"] < 0 or one["right"] > wide or one["bottom"] > tall
                ]
                assert outside == [], (canvas, size)
    screen.close()


# Of every zone of the list: whether its row is whole, whether any of it is to be seen, whether it is the current one.
LISTED = """(() => {
  const list = document.getElementById('zones');
  const head = list.firstElementChild.getBoundingClientRect().bottom;
  const end = list.getBoundingClientRect().bottom;
  return [...list.querySelectorAll('button')].map((row) => {
    const { top, bottom } = row.getBoundingClientRect();
    return [top > head - 0.5 && bottom < end + 0.5, bottom > head + 0.5 && top < end - 0.5, row.ariaCurrent === 'true'];
  });
})()"""


@pytest.mark.parametrize(("size", "least"), [((1366, 768), 8), ((1920, 1080), 10), ((768, 1024), 6)])
def test_the_list_of_zones_shows_whole_rows_and_counts_the_others(
    browser: Any, viewer: Any, size: tuple[int, int], least: int
) -> None:
    screen = Screen(browser, viewer.url, "#md=1012&sec=24", size, drawn=False)
    screen.settle()
    for key, where in ((None, "below"), ("p", "above")):  # the least of the zones
        if key:
            screen.keyboard.press(key)
            screen.settle()
            screen.until("document.getElementById('zonesMore').textContent.includes('above')")
        rows = screen.evaluate(LISTED)
        whole = [row[0] for row in rows]
        assert whole == [row[1] for row in rows]
        assert sum(whole) >= least
        assert screen.inner_text("#zonesMore") == f"{len(rows) - sum(whole)} {where}"
        assert [current for *_, current in rows] == [False] * (len(rows) - 1) + [key == "p"]
    assert whole[-1], "a jump shows the row of its zone"
    screen.close()


def test_a_zone_that_changes_replaces_its_own_row_alone(browser: Any, viewer: Any) -> None:
    listed = "[...document.querySelectorAll('#zones button')].map((row) => row.title)"
    screen = Screen(browser, viewer.url, "#md=1012&sec=24", (1366, 768), drawn=False)
    screen.settle()
    screen.evaluate("window.rows = [...document.querySelectorAll('#zones button')]")
    before = screen.evaluate(listed)
    worst, least = before[0], before[-1]
    screen.evaluate("""(({ app }) => {
      const weight = ({ severity, confidence }) => severity * confidence;
      const least = app.zones.reduce((a, b) => (weight(a) < weight(b) ? a : b));
      app.zones = app.zones.map((zone) => (zone === least ? { ...zone, severity: 900 } : zone));
      app.redraw();
    })(window.__wall)""")
    screen.until("document.querySelector('#zones button').title.includes('900.0 times')")
    after = screen.evaluate(listed)
    assert after[0].split(",")[0] == least.split(",")[0]
    assert after[1:] == before[:-1]
    assert screen.evaluate("window.rows.map((row) => row.isConnected)") == [True] * (len(before) - 1) + [False]
    screen.evaluate("window.__wall.app.zones = window.__wall.app.zones.filter(({ severity }) => severity < 900)")
    screen.evaluate("window.__wall.app.redraw()")
    screen.until(f"document.querySelector('#zones button').title === {worst!r}")
    assert screen.evaluate(listed) == before[:-1]
    screen.close()


def test_a_short_list_of_zones_shows_them_all(browser: Any, viewer: Any) -> None:
    screen = Screen(browser, viewer.url, "#md=1012&sec=24", (1366, 768), drawn=False)
    screen.settle()
    for count in range(1, 8):
        screen.evaluate(f"(({{ app }}) => {{ app.zones = app.zones.slice(-{count}); app.redraw(); }})(window.__wall)")
        screen.until(f"document.querySelectorAll('#zones button').length === {count}")
        assert [row[0] for row in screen.evaluate(LISTED)] == [True] * count
        assert screen.inner_text("#zonesMore") == ""
        screen.evaluate("window.__wall.app.zones = window.__wall.app.zonesBefore")
    screen.close()


def test_the_colours_fold_where_the_panel_lacks_room_and_stay_as_chosen(browser: Any, viewer: Any) -> None:
    high = Screen(browser, viewer.url, "#md=1012&sec=24", SIZES[1], drawn=False)
    high.settle()
    assert high.is_visible("#histogram")
    high.close()
    screen = Screen(browser, viewer.url, "#md=1012&sec=24&quantity=GR", SIZES[0], drawn=False)
    screen.settle()
    assert not screen.is_visible("#histogram")
    assert screen.inner_text("#colourText") == "Colour: GR, 20 to 140 gAPI"
    screen.focus("#colourText")
    screen.keyboard.press("Enter")
    screen.wait_for_selector("#histogram")
    screen.reload()
    assert screen.is_visible("#histogram")
    screen.close()


@pytest.mark.parametrize("size", [*SIZES, (1024, 768)])
def test_no_control_is_cut_off(browser: Any, viewer: Any, size: tuple[int, int]) -> None:
    """Every control lies in the window, touches no other, and the longest of its words fit; while picking dips, too."""
    screen = Screen(browser, viewer.url, "", size, drawn=False)
    screen.settle()
    check_controls(screen, size)
    screen.keyboard.press("d")
    screen.settle()
    check_controls(screen, size)
    if screen.is_visible("#menu"):
        before = screen.evaluate("document.getElementById('stage').clientHeight")
        screen.click("#menu")
        screen.settle()
        assert screen.is_visible("#cut")
        assert screen.evaluate("document.getElementById('stage').clientHeight") <= before
        check_controls(screen, size)
    screen.close()


def check_controls(screen: Screen, size: tuple[int, int]) -> None:
    longest = "85.2 %, 12.2 % interpolated, 2.3 % empty"  # beside a gap
    screen.evaluate(f"document.querySelector('#section dd').textContent = '{longest}'")
    controls = screen.evaluate(
        """[...document.querySelectorAll('button, select, input, #foot a, #lampText, h1')]
           .filter((e) => e.offsetParent && !e.closest('#zones')) // the list of zones scrolls
           .map((e) => {
             const { left, top, right, bottom } = e.getBoundingClientRect();
             const cut = Math.max(e.scrollWidth - e.clientWidth, e.scrollHeight - e.clientHeight);
             return { name: e.id || e.textContent, left, top, right, bottom, cut: e.tagName === 'SELECT' ? 0 : cut };
           })"""
    )
    assert len(controls) > 15
    for a, b in itertools.combinations(controls, 2):
        apart = a["right"] <= b["left"] or b["right"] <= a["left"] or a["bottom"] <= b["top"] or b["bottom"] <= a["top"]
        assert apart, (a["name"], b["name"])
    assert [c["name"] for c in controls if c["left"] < 0 or c["right"] > size[0] or c["bottom"] > size[1]] == []
    assert [(c["name"], c["cut"]) for c in controls if c["cut"] > 1] == []
    assert screen.cut_selects() == []


BOXES = """[...document.querySelectorAll('#wallHead > *')].filter((e) => e.offsetWidth).map((e) => {
  const { left, top, right, bottom } = e.getBoundingClientRect();
  return { left, top, right, bottom };
})"""


def on_controls(screen: Screen, labels: list[dict[str, Any]]) -> list[str]:
    """Return the texts of the ink that touch a control of the hole."""
    bar = screen.evaluate("document.getElementById('stage').getBoundingClientRect().top")
    return [
        one["text"]
        for one, box in itertools.product(labels, screen.evaluate(BOXES))
        if one["left"] < box["right"] and box["left"] < one["right"]
        if one["top"] + bar < box["bottom"] and box["top"] < one["bottom"] + bar
    ]


@pytest.mark.parametrize("size", [(1000, 700), (1600, 900)])
@pytest.mark.parametrize("camera", ["straight", "down"])
def test_beside_a_widened_image_the_words_on_the_hole_are_whole(
    browser: Any, viewer: Any, size: tuple[int, int], camera: str
) -> None:
    address = f"#md=1012&sec=12&widths=image~2000&median=5&camera={camera}"
    screen = Screen(browser, viewer.url, address, size, drawn=False)
    screen.settle()
    pane = screen.evaluate("window.__wall.app.renderer.rects.pane")
    right = pane["left"] + pane["width"]
    labels = [one for one in screen.evaluate("document.getElementById('ink').labels") if one["left"] >= pane["left"]]
    texts = [one["text"] for one in labels]
    assert {"U", "D"} <= set(texts)
    assert [one["text"] for one in labels if one["right"] > right] == []
    assert on_controls(screen, labels) == []
    said = ["shape × 3", "median 5"] if camera == "straight" else ["inside, down", "true to scale", "median of 5"]
    assert all(any(part in text for text in texts) for part in said), texts
    screen.close()


@pytest.mark.parametrize(("size", "name"), [((1366, 768), "Hole"), ((2000, 900), "Hole, straightened")])
def test_the_head_of_the_straightened_hole_says_what_is_seen(
    browser: Any, viewer: Any, size: tuple[int, int], name: str
) -> None:
    screen = Screen(browser, viewer.url, "#md=1012&sec=12", size, drawn=False)
    for turn, side in ((0, "L"), (90, "D"), (225, "U–R"), (-90, "U")):
        screen.evaluate(f"window.__wall.app.view.choose({{ turn: {turn} }})")
        screen.settle()
        head = [one for one in screen.evaluate("document.getElementById('ink').labels") if one["bottom"] < 80]
        texts = [one["text"] for one in head]
        assert {name, f"seen from {side}, right half cut away", "bit"} <= set(texts)
        assert any(text.endswith(", shape × 3 about bit") for text in texts)
        assert on_controls(screen, head) == []
    screen.close()


@pytest.mark.parametrize("size", [(1024, 768), (1366, 768)])
def test_beside_two_images_and_dips_the_head_still_says_what_is_cut_away(
    browser: Any, viewer: Any, size: tuple[int, int]
) -> None:
    screen = Screen(browser, viewer.url, "#md=1012&sec=12&beside=GR", size, drawn=False)
    screen.keyboard.press("d")
    screen.settle()
    rects = screen.evaluate("window.__wall.app.renderer.rects")
    assert rects["dips"]["width"]
    assert rects["pane"]["width"] < 300
    head = [one for one in screen.evaluate("document.getElementById('ink').labels") if one["bottom"] < 80]
    assert any(one["text"].startswith("right half cut") or one["text"].endswith("right half cut away") for one in head)
    assert on_controls(screen, head) == []
    screen.close()


def test_a_jump_turns_the_side_of_a_zone_to_the_front_until_the_user_turns_the_hole(browser: Any, viewer: Any) -> None:
    screen = Screen(browser, viewer.url, "#md=1012&sec=12&cut=north", (1366, 768))
    turn, kind = "window.__wall.app.view.turn", "zonesCard.querySelector('[aria-current]')?.innerText ?? ''"
    screen.until("window.__wall.app.zones.length")
    screen.evaluate(
        "window.__wall.app.renderer.gpu.draw = () => {}"
    )  # the picture is looked at when a breakout is found
    for _ in range(40):
        screen.keyboard.press("n")
        screen.settle()
        if "breakout" in screen.evaluate(kind):
            break
        assert screen.evaluate(turn) == 0, "a washout has no side"
    screen.evaluate("delete window.__wall.app.renderer.gpu.draw")
    wall = screen.evaluate("window.__wall.app.renderer.rects.wall")
    pixels = screen.pixels("wall")[..., :3].astype(int)
    cut = int(pixels.shape[1] / 2 - 4), int(pixels.shape[1] / 2 + 4)
    front = pixels[pixels.shape[0] // 2 - 4 : pixels.shape[0] // 2 + 4, cut[0] : cut[1]]
    assert (front[..., 0] - front[..., 2]).mean() > 60, "orange: the breakout is in the middle"
    turned = screen.evaluate(turn)
    assert f"turn={turned}" in screen.address()
    bar = screen.evaluate("document.getElementById('stage').getBoundingClientRect().top")
    x, y = wall["left"] + wall["width"] / 2, bar + wall["top"] + wall["height"] / 3
    screen.mouse.move(x, y)
    screen.mouse.down()
    screen.mouse.move(x + 80, y, steps=3)
    screen.mouse.up()
    assert screen.evaluate(turn) == pytest.approx((turned - 40) % 360)
    middle = screen.evaluate("window.__wall.app.view.middle")
    screen.click("#zoneNext")
    screen.settle()
    assert screen.evaluate("window.__wall.app.view.middle") != middle
    assert screen.evaluate(turn) == pytest.approx((turned - 40) % 360)
    screen.click("#zoneBefore")
    screen.settle()
    assert screen.evaluate("window.__wall.app.view.middle") == pytest.approx(middle)
    screen.close()


@pytest.mark.parametrize("size", SIZES)
def test_the_same_depth_is_at_the_same_height_in_every_panel(browser: Any, viewer: Any, size: tuple[int, int]) -> None:
    screen = Screen(browser, viewer.url, "#md=1012&sec=24", size)
    screen.settle()
    rect = screen.evaluate("window.__wall.app.renderer.rects.image")
    place = {depth: (depth - 1000) / 24 * rect["height"] for depth in (1012.0, 1012.6)}
    image = screen.pixels("image")[..., :3].astype(int)
    scale = len(image) / rect["height"]
    grey = (abs(image - image[..., :1]).max(axis=-1) <= 2).mean(axis=1) > 0.95
    hatched = np.flatnonzero(grey) / scale
    pitch = 0.1 / 24 * rect["height"]  # a helix: the gap's edges slope by one pitch over the image
    assert hatched[0] == pytest.approx(place[1012.0], abs=1.5 + 2 * pitch)
    assert hatched[-1] == pytest.approx(place[1012.6], abs=1.5 + 2 * pitch)
    screen.point_at(0.4, 0.75)
    lines = {name: np.array(screen.evaluate(ROWS_OF, [name, INK])) for name in ("axis", "image", "caliper")}
    at = [int(np.argmax(lines[name])) for name in ("image", "caliper")]
    assert at[0] == at[1]
    assert lines["image"][at[0]] > 0.95
    assert lines["caliper"][at[0]] > 0.9
    tag = np.flatnonzero(lines["axis"] > 0.3)
    assert abs((tag[0] + tag[-1]) / 2 - at[0]) <= 1, "the flag with the depth is centred on its line"
    depth = screen.evaluate("window.__wall.app.view.cursor.depth")
    assert depth == pytest.approx(1000 + 24 * (at[0] + 0.5) / rect["height"], abs=1.5 * 24 / rect["height"])
    screen.close()


def test_the_ring_in_3d_is_at_the_cursors_depth(browser: Any, viewer: Any) -> None:
    screen = Screen(browser, viewer.url, "#md=1030&sec=24&camera=outside", (1366, 768), drawn=False)
    screen.settle()
    screen.point_at(0.4, 0.4)
    before = screen.stats()["pictures"]
    screen.point_at(0.4, 0.5)
    assert screen.stats()["pictures"] == before, "the cursor moves in the ink alone"
    ring = np.array(screen.evaluate(INK_OF, ["wall", CURSOR])) == 1
    left, top = screen.evaluate("(({ left, top }) => [left, top])(window.__wall.app.renderer.rects.wall)")
    for one in screen.evaluate("document.getElementById('ink').labels"):
        edges = [
            int(one[side] - start) for side, start in (("top", top), ("bottom", top), ("left", left), ("right", left))
        ]
        if edges[3] > 0:
            ring[max(0, edges[0] - 1) : edges[1] + 2, max(0, edges[2] - 1) : edges[3] + 2] = False
    assert ring.sum() > 8
    expected = screen.evaluate(
        "(() => { const { app } = window.__wall;"
        " const [x, y] = app.renderer.gpu.project(app.path.at(app.view.cursor.depth), app.renderer.rects.wall);"
        " return [x - app.renderer.rects.wall.left, y]; })()"
    )
    rows, columns = np.nonzero(ring)
    near = np.hypot(columns - expected[0], rows - expected[1]) < 40
    assert near.sum() > 8
    assert np.ptp(columns[~near]) < 10
    steps = np.diff(np.unique(rows[~near]))
    assert (steps > 1).sum() == 1, "the dots in the plan and the side are of this colour, too"
    assert (steps == 1).sum() < 18
    rows, columns = rows[near], columns[near]
    size = screen.evaluate(
        "window.__wall.app.store.bitRadius * window.__wall.app.view.tubeFactor(window.__wall.app.store)"
    )
    metre = screen.evaluate(
        "(() => { const { path, renderer: { gpu, rects } } = window.__wall.app;"
        " const of = (d) => gpu.project(path.at(d), rects.wall);"
        " const [a, b] = [of(1025), of(1035)]; return Math.hypot(a[0] - b[0], a[1] - b[1]) / 10; })()"
    )
    # Only the near half of the ring is seen: its middle is off the axis by less than the hole's radius.
    assert np.hypot(columns.mean() - expected[0], rows.mean() - expected[1]) < 1.1 * size * metre
    screen.close()


# Where the axis of the hole is in the path view, in CSS pixels.
AXIS = """(({ view, path, renderer }) => Array.from({ length: 41 }, (_, i) =>
  renderer.gpu.project(path.at(view.top + (view.length * i) / 40), renderer.rects.wall)).filter(Boolean))"""


def test_on_its_path_no_depth_is_cut_and_the_plan_hides_no_hole(browser: Any, viewer: Any) -> None:
    screen = Screen(browser, viewer.url, "#md=1240&sec=12&camera=outside", (1366, 768), drawn=False)
    sides = set()
    for depth in range(1040, 1440, 40):
        screen.evaluate(f"window.__wall.app.view.centre({depth}, window.__wall.app.store)")
        screen.evaluate("window.__wall.fit()")
        screen.settle()
        pane = screen.evaluate("window.__wall.app.renderer.rects.pane")
        right = pane["left"] + pane["width"]
        labels = screen.evaluate("document.getElementById('ink').labels")
        assert [one["text"] for one in labels if one["right"] > right] == []
        (plan,) = [one for one in labels if one["text"].startswith("plan, N up")]
        side = 92
        bars = [one for one in labels if re.fullmatch(r"[0-9.]+ m", one["text"]) and one["left"] < plan["left"] + side]
        assert any(0 < one["top"] - plan["bottom"] - side < 20 for one in bars), "the bar of the plan's scale"
        for other in (one for one in labels if one["text"].startswith("side, ")):
            below = other["left"] == plan["left"] and other["top"] > plan["top"]
            assert not below or other["top"] > plan["bottom"] + side + 20, "it leaves the bar of the plan in view"
        assert pane["left"] < plan["left"] < right - side
        axis = screen.evaluate(f"{AXIS}(window.__wall.app)")
        sides.add(plan["left"] > pane["left"] + pane["width"] / 2)
        assert not any(plan["left"] < x < plan["left"] + side and 80 < y < plan["bottom"] + side for x, y in axis)
    assert len(sides) == 2, "the plan is at the left, or where the hole is there at the right"
    screen.close()


def test_what_a_wall_without_a_survey_cannot_know_is_not_shown(browser: Any) -> None:
    with hb.view(MadeWall(30_000)) as viewer:
        screen = Screen(browser, viewer.url, "#md=1010&sec=10&camera=outside", drawn=False)
        screen.point_at(0.4, 0.4)
        texts = [one["text"] for one in screen.evaluate("document.getElementById('ink').labels")]
        assert {"no survey", "0°", "90°", "180°", "270°"} <= set(texts)
        assert not {"TVD m", "N", "U", "up"} & set(texts)
        assert any(text.startswith("no survey: drawn vertical") for text in texts)
        said = screen.readout()
        assert (said["TVD"], said["From high side / azimuth"]) == ("–", "– / –")
        assert said["Toolface"].endswith("°")
        screen.close()


def test_tiles_join_without_a_speck_at_any_scale(browser: Any, viewer: Any) -> None:
    screen = Screen(browser, viewer.url, "#md=1050&sec=20&quantity=radius")
    for length in (31, 77, 170, 260):
        screen.evaluate(f"window.__wall.app.view.show(1050, {length}, window.__wall.app.store)")
        screen.settle()
        image = screen.pixels("image")[2:-2, 2:-2, :3]
        assert not (image == [0xF4, 0xF5, 0xF6]).all(axis=-1).any(), length
    screen.close()


def test_a_saved_wall_of_gauge_starts_with_colours_for_its_own_size(browser: Any) -> None:
    wall = MadeWall(20_000)
    wall.radius = np.clip(wall.radius, 0.1072, 0.1088)
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, "#md=1010&sec=15", drawn=False)
        screen.settle()
        low, high = screen.evaluate("(({ low, high }) => [low, high])(window.__wall.app.selection.quantity)")
        assert -0.0015 < low <= -0.0008
        assert 0.0008 <= high < 0.0015
        screen.close()


def test_the_panel_of_a_narrow_window_cuts_no_value_and_no_choice(browser: Any, viewer: Any) -> None:
    screen = Screen(browser, viewer.url, "#md=1012&sec=12", (1024, 768), drawn=False)
    screen.evaluate("(window.__wall.app.path.assumed = true, window.__wall.app.redraw())")
    screen.until("document.getElementById('readout').innerText.includes('assumed')")
    assert (
        screen.evaluate(
            "(({ scrollWidth, clientWidth }) => scrollWidth - clientWidth)(document.querySelector('aside'))"
        )
        == 0
    )
    lines = "[...document.querySelectorAll('#colour label')].map((one) => one.getClientRects().length)"
    opened = f"(document.getElementById('colour').open = true, {lines})"
    assert screen.evaluate(opened) == [1, 1, 1], "each box beside its word"
    screen.close()


@pytest.mark.parametrize("size", [(390, 844), (768, 1024), (1024, 768)])
def test_in_rig_mode_no_word_is_hidden_or_touches_another(browser: Any, viewer: Any, size: tuple[int, int]) -> None:
    screen = Screen(browser, viewer.url, "#rig=1", size, drawn=False)
    screen.settle()
    boxes = (
        "(id) => (({ left, right, top, bottom }) => ({ left, right, top, bottom }))"
        "(document.getElementById(id).getBoundingClientRect())"
    )
    lamp, *texts = (screen.page.evaluate(boxes, name) for name in ("rigLamp", "rigAge", "rigAgeMore"))
    assert not [
        one
        for one in texts
        if lamp["left"] < one["right"] and lamp["top"] < one["bottom"] and one["top"] < lamp["bottom"]
    ]
    labels = screen.evaluate("document.getElementById('ink').labels") if size[0] >= 1000 else []
    sides = sorted(
        (one["left"], one["right"]) for one in labels if one["text"] in ("up", "down", "U", "D") and one["top"] < 80
    )
    assert all(one[1] + 2 < other[0] for one, other in itertools.pairwise(sides)), sides
    assert bool(sides) == (size[0] >= 1000)
    screen.close()

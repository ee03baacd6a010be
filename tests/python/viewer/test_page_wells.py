"""Several wells on one page: where they are, what joins their tops, and the way to each well's own page."""

from __future__ import annotations

import itertools
import json
import re
import struct
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from command import run
from patience import wait
from screen import NEEDS_BROWSER, Screen

import helibore as hb
from helibore.base.identity import Access
from helibore.viewer.feed import Feed
from helibore.viewer.page_server import PageServer
from helibore.viewer.scene import Scene

COLOURS = Path(hb.__file__).parent / "base" / "color_maps.json"
HEADS = {"A-1": (10.0, 20.0, -30.0), "B-2": (15.0, 60.0, -30.0), "C-3": (40.0, 90.0, -30.0)}
TOPS = {"A-1": (1004.0, 1010.0), "B-2": (1006.0, 1009.0), "C-3": (1003.5, 1012.0)}


def made(head: tuple[float, float, float] | None, tops: tuple[float, ...] = (), inclination: float = 30.0) -> hb.Wall:
    """A hole at bit size from 1000 to 1016 m, with the beds Upper, Lower ..."""
    wall = hb.reconstruct(hb.Caliper.gauge(1000.0, 1016.0, 0.2), bit_diameter=0.2, sectors=16, pitch=0.1)
    if head is not None:
        survey = hb.Survey([990.0, 1030.0], [inclination, inclination], [75.0, 75.0])
        wall.path = survey.path(head=head)
    ends = [*tops[1:], 1016.0]
    names = (f"Bed {number}" for number in range(len(tops)))
    wall.intervals = tuple(map(hb.Interval, names, tops, ends))
    return wall


@pytest.fixture(scope="module")
def wells() -> Iterator[Any]:
    walls = {name: made(HEADS[name], TOPS[name]) for name in HEADS}
    with hb.view_wells(walls) as viewer:
        yield viewer, walls


def answer(viewer: Any, path: str) -> Any:
    address, token = viewer.url.split("?")
    with urllib.request.urlopen(f"{address}{path}?{token}") as got:
        return got.read()


def test_each_well_has_its_own_addresses(wells: Any) -> None:
    viewer, walls = wells
    listed = json.loads(answer(viewer, "api/wells"))
    assert [one["name"] for one in listed] == list(HEADS)
    assert [tuple(one["head"]) for one in listed] == list(HEADS.values())
    assert [one["length"] for one in listed] == pytest.approx([16.0] * 3, abs=0.2)
    for one, wall in zip(listed, walls.values(), strict=True):
        assert json.loads(answer(viewer, f"{one['address']}healthz"))["vertices"] == len(wall)
        assert json.loads(answer(viewer, f"{one['address']}api/history"))["vertices"] == [len(wall)]
    assert json.loads(answer(viewer, "healthz"))["vertices"] == sum(map(len, walls.values()))


@pytest.mark.parametrize("path", ["", "wells.js", "app.css", "api/wells", "w/0/", "w/1/api/summary"])
def test_who_has_no_token_gets_nothing(wells: Any, path: str) -> None:
    with pytest.raises(urllib.error.HTTPError, match="403"):
        urllib.request.urlopen(wells[0].url.split("?")[0] + path)


def test_no_well_is_refused() -> None:
    with pytest.raises(hb.InputError, match="walls: must have at least one"):
        hb.view_wells({})


def test_a_picks_file_of_no_well_is_refused() -> None:
    with pytest.raises(hb.InputError, match="picks_files = B: must name wells of walls"):
        hb.view_wells({"A": made(None)}, picks_files={"B": "B.picks.csv"})


def test_picks_of_each_well_are_saved_beside_its_archive_and_shown_again(
    tmp_path: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    files = [tmp_path / name for name in ("A.wall", "B.wall")]
    for file in files:
        made(None).save(file)
    seen: list[Any] = []

    def serve(viewer: Any) -> None:
        with viewer:
            seen.append({name: [pick.depth for pick in scene.picks] for name, scene in viewer.scenes.items()})
            pick = {"key": "f1", "kind": "fracture", "depth": 1004.0, "toolface": 30.0, "apparent_dip": 40.0}
            address, token = viewer.url.split("?")
            put = urllib.request.Request(f"{address}w/1/api/pick?{token}", json.dumps(pick).encode(), method="PUT")
            urllib.request.urlopen(put)

    monkeypatch.setattr("helibore.cli.view_command.serve_page", serve)
    monkeypatch.setattr("helibore.cli.view_command.check_page", lambda: None)
    for _ in range(2):
        done = run("view", *files, "--no-browser")
        assert done.exit_code == 0, done.output
    assert seen == [{"A": [], "B": []}, {"A": [], "B": [1004.0]}]
    assert not (tmp_path / "A.wall.picks.csv").exists()
    assert "picks saved in" in " ".join(done.output.split())


@pytest.mark.parametrize("option", [["--bit-diameter", "8in"], ["--html", "all.html"], ["--picks", "picks.csv"]])
def test_options_of_one_well_are_refused(tmp_path: Any, option: list[str]) -> None:
    files = [tmp_path / name for name in ("a.wall", "b.wall")]
    for file in files:
        made(None).save(file)
    result = run("view", *map(str, files), *option)
    assert result.exit_code == 2
    assert f"{option[0]}: does not go with several archives" in result.output


class TestPage:
    pytestmark = NEEDS_BROWSER

    def test_a_click_on_a_well_side_by_side_opens_its_page_to_pick_there(self, browser: Any, wells: Any) -> None:
        viewer, _ = wells
        screen = Screen(browser, viewer.url, "#mode=section", drawn=False)
        x, y = screen.evaluate(
            "(({ left, top }, { columns: [, { rects: { image } }] }) =>"
            " [left + image.left + image.width / 2, top + image.top + image.height / 2])"
            "(document.getElementById('stage').getBoundingClientRect(), window.__wall.wells.section)"
        )
        with screen.page.expect_popup() as opened:
            screen.mouse.click(x, y)
        page = opened.value
        picks = "Boolean(window.__wall?.ready && window.__wall.app.picking.on)"
        wait(lambda: page.evaluate(picks), lambda: "the page picks", pause=0.05)
        assert page.evaluate("document.getElementById('well').title") == "B-2"
        assert page.evaluate("Math.abs(window.__wall.app.view.middle - 1008) < 2"), "at the depth of the click"
        page.keyboard.press("d")
        assert not page.evaluate("window.__wall.app.picking.on")
        screen.mouse.click(x, y + 40)
        wait(lambda: page.evaluate(picks), lambda: "the page picks again", pause=0.05)
        assert len(screen.page.context.pages) >= 2
        pick = {"key": "f1", "kind": "fracture", "depth": 1008.0, "toolface": 30.0, "apparent_dip": 40.0}
        page.evaluate("(pick) => window.__wall.app.picking.change([{ key: pick.key, pick }])", pick)
        screen.until("window.__wall.wells.wells[1].planes.length === 1")
        page.evaluate("window.__wall.app.picking.change([{ key: 'f1', pick: null }])")
        screen.until("window.__wall.wells.wells[1].planes.length === 0")
        page.close()
        links = screen.page.locator("#wells a", has_text="pick dips")
        assert [one.get_attribute("href").endswith("&picking=1") for one in links.all()] == [True] * 3
        screen.close()

    @pytest.mark.parametrize("size", [(1366, 768), (1024, 768), (820, 1180), (390, 844)])
    def test_every_control_of_the_wells_is_in_any_window_and_no_name_is_cut(
        self, browser: Any, wells: Any, size: tuple[int, int]
    ) -> None:
        screen = Screen(browser, wells[0].url, size=size, drawn=False)
        names = ["mode", "tube", "units", "fit", "png", "theme", "wells", "tops"]
        boxes = {name: screen.locator(f"#{name}").bounding_box() for name in names}
        assert [name for name, box in boxes.items() if not box] == []
        assert all(box["x"] >= 0 and box["x"] + box["width"] <= size[0] for box in boxes.values())
        assert all(box["y"] < size[1] for box in boxes.values())
        labels, wide = screen.evaluate("[ink.labels, ink.clientWidth]")
        assert [one["text"] for one in labels if one["left"] < 0 or one["right"] > wide] == []
        assert any(one["text"].startswith("Bed") for one in labels)
        screen.close()

    def test_wells_stand_where_their_paths_are(self, browser: Any, wells: Any) -> None:
        viewer, walls = wells
        screen = Screen(browser, viewer.url, drawn=False)
        for i, wall in enumerate(walls.values()):
            for depth in (1000.0, 1007.3, 1016.0):
                place = screen.evaluate(
                    "([i, depth]) => { const { wells } = window.__wall;"
                    " return wells.scene.at(wells.wells[i], depth).map((x, j) => x + wells.scene.origin[j]); }",
                    [i, depth],
                )
                north, east, down = wall.path.position([depth])[0]
                assert place == pytest.approx([east, north, -down], abs=2e-3)
        assert screen.evaluate("document.getElementById('placed').textContent") == ""
        screen.close()

    def test_a_joined_bed_ends_at_its_tops(self, browser: Any, wells: Any) -> None:
        viewer, walls = wells
        screen = Screen(browser, viewer.url, "#off=discs_planes_box", drawn=False)
        screen.until("window.__wall.wells.scene.areas.places.length")
        places, origin = screen.evaluate("(({ areas, origin }) => [areas.places, origin])(window.__wall.wells.scene)")
        points = np.array(places).reshape(-1, 4)[:, :3] + origin
        for name, wall in walls.items():
            for top in TOPS[name]:
                north, east, down = wall.path.position([top])[0]
                assert np.abs(points - [east, north, -down]).max(axis=1).min() < 2e-3
        screen.close()

    def test_tops_level_at_one_height(self, browser: Any, wells: Any) -> None:
        screen = Screen(browser, wells[0].url, "#mode=section&datum=Bed+1", drawn=False)
        heights = screen.evaluate(
            "(({ section }) => section.columns.map(({ well, datum, rects }) =>"
            " well.store.intervals.map(([, at]) => section.y(section.down(well, at), rects))))(window.__wall.wells)"
        )
        assert len(heights) == 3
        upper, lower = np.array(heights).T
        assert np.ptp(lower) < 1e-9
        thickness = np.array([bottom - top for top, bottom in TOPS.values()])
        assert (lower - upper) / thickness == pytest.approx([(lower - upper)[0] / thickness[0]] * 3)
        screen.close()

    @pytest.mark.parametrize("surveyed", [True, False])
    def test_wells_hang_on_a_top_by_true_depth_if_all_have_it(self, browser: Any, surveyed: bool) -> None:
        tops = (1004.0, 1010.0)
        walls = {"A-1": made(HEADS["A-1"], tops), "B-2": made(HEADS["B-2"] if surveyed else None, tops, 60.0)}
        with hb.view_wells(walls) as viewer:
            screen = Screen(browser, viewer.url, "#mode=section&datum=Bed+1", drawn=False)
            screen.until("window.__wall.wells.section.columns.length === 2")
            rows = screen.evaluate(
                "(({ section }) => section.columns.map(({ well, rects }) =>"
                " [1004, 1010].map((depth) => section.y(section.down(well, depth), rects))))(window.__wall.wells)"
            )
            found = screen.evaluate(
                "(({ section }) => section.columns.map(({ rects: { image } }, i) =>"
                f" section.found(image.left + 9, {json.dumps(rows)}[i][1]).depth))(window.__wall.wells)"
            )
            texts = screen.evaluate("document.getElementById('ink').labels.map(({ text }) => text)")
            with screen.page.expect_download() as download:
                screen.click("#svg")
            saved = list(ElementTree.parse(download.value.path()).getroot().itertext())
            how = "true vertical" if surveyed else "measured"
            assert f"A-1, B-2   hung on Bed 1, by {how} depth" in saved
            screen.close()
        upper, lower = np.array(rows).T
        assert np.ptp(lower) < 1e-6
        assert found == pytest.approx([1010.0, 1010.0], abs=0.02)
        ratio = np.cos(np.radians(30)) / np.cos(np.radians(60)) if surveyed else 1.0
        assert (lower - upper)[0] / (lower - upper)[1] == pytest.approx(ratio, rel=1e-3)
        assert texts.count("TVD m") == (2 if surveyed else 1)

    def test_equal_true_depths_stand_at_one_height(self, browser: Any) -> None:
        """In a well that builds and in a straight one; every track and the pointer use the axis of true depth."""
        build = hb.Survey([990.0, 1000.0, 1016.0, 1030.0], [0.0, 10.0, 60.0, 60.0], [75.0] * 4)
        walls = {"Straight": made((0.0, 0.0, 990.0)), "Builds": made((0.0, 40.0, 985.0))}
        walls["Builds"].path = build.path(head=(0.0, 40.0, 985.0))
        with hb.view_wells(walls) as viewer:
            screen = Screen(browser, viewer.url, "#mode=section&datum=~tvd", drawn=False)
            screen.until("window.__wall.wells.section.columns.length === 2")
            for name, wall in walls.items():
                for depth in (1001.0, 1007.3, 1014.5):
                    y, top, length, rect, found = screen.evaluate(
                        "([name, depth]) => { const { section } = window.__wall.wells;"
                        " const { well, rects } = section.columns.find((one) => one.well.name === name);"
                        " const y = section.y(section.down(well, depth), rects); const { left, width } = rects.image;"
                        " return [y, section.top, section.length, rects.axis,"
                        "   section.found(left + width / 2, y).depth]; }",
                        [name, depth],
                    )
                    tvd = float(wall.path.position([depth])[0][2])
                    assert y == pytest.approx(rect["top"] + (tvd - top) / length * rect["height"], abs=0.5)
                    assert found == pytest.approx(depth, abs=0.01)
            texts = screen.evaluate("document.getElementById('ink').labels.map(({ text }) => text)")
            assert texts.count("TVD m") == 2
            screen.close()

    @pytest.mark.parametrize("mode", ["scene", "section"])
    def test_where_a_bed_ends_that_one_well_lacks_is_marked_as_not_known(self, browser: Any, mode: str) -> None:
        """In the scene as side by side: a question mark, dashed edges, a fainter bed."""
        walls = {name: made(HEADS[name], (1002.0, 1005.0, 1009.0)) for name in ("A-1", "B-2")}
        upper, _, lower = walls["B-2"].intervals
        strips = []
        for lacking, marks in ((True, 1), (False, 0)):
            if lacking:
                walls["B-2"].intervals = (hb.Interval(upper.name, 1002.0, lower.start), lower)
            else:
                walls["B-2"].intervals = walls["A-1"].intervals
            with hb.view_wells(walls) as viewer:
                screen = Screen(browser, viewer.url, f"#mode={mode}&off=discs", drawn=False)
                screen.until("window.__wall.wells.drawn.length === 2")
                screen.until("document.getElementById('ink').labels.length > 5")
                screen.click("#fit")
                texts = screen.evaluate("document.getElementById('ink').labels.map(({ text }) => text)")
                assert texts.count("?") == marks
                alphas = screen.evaluate("window.__wall.wells.scene.areas.tints.filter((_, i) => i % 4 === 3)")
                strips.append([alphas.count(round(255 * one)) for one in (0.15, 0.32, 0.95)])
                screen.close()
        if mode == "scene":
            (faint, firm, edges), whole = strips
            assert faint > 0, "the bed that one well lacks"
            assert (faint + firm, 0) == (whole[1], whole[0])
            assert edges > 4 * whole[2], "its edges are dashes"

    def test_the_letter_of_north_is_whole_where_north_is_at_the_left(self, browser: Any, wells: Any) -> None:
        screen = Screen(browser, wells[0].url, drawn=False)
        screen.until("window.__wall.wells.drawn.length > 1")
        screen.evaluate("window.__wall.wells.scene.fit([-1, 0, 0.3])")
        screen.until("ink.labels.some(({ text, right }) => text === 'N' && right < 30)")
        assert screen.evaluate("ink.labels.find(({ text }) => text === 'N').left") >= 0
        screen.close()

    def test_the_scene_shows_planes_as_discs_and_names_their_colours(self, browser: Any) -> None:
        walls = {name: made(HEADS[name], TOPS[name]) for name in ("A-1", "B-2")}
        for wall in walls.values():
            wall.picks = [hb.Pick(kind="fracture", depth=1006.0 + i, apparent_dip=60.0, toolface=90.0) for i in (0, 4)]
        with hb.view_wells(walls) as viewer:
            screen = Screen(browser, viewer.url, drawn=False)
            screen.until("window.__wall.wells.drawn.length === 2 && window.__wall.wells.wells[1].planes.length")
            screen.click("#fit")
            screen.until("document.getElementById('ink').labels.some(({ text }) => text === 'fracture')")
            width, height, corners, towards = screen.evaluate(
                "(({ scene, wells }) => { const { low, high, rect, from } = scene; const [{ planes: [plane] }] = wells;"
                " const { a, b, frame: { high: up, right, tangent } } = plane;"
                " const [n, e, d] = tangent.map((t, i) => t - a * up[i] - b * right[i]);"
                " const share = (e * from[0] + n * from[1] - d * from[2]) / Math.hypot(n, e, d) / Math.hypot(...from);"
                " const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((c) =>"
                "   scene.project([0, 1, 2].map((i) => ((c >> i) & 1 ? high : low)[i]), rect));"
                " return [rect.width, rect.height, corners, Math.abs(share)]; })(window.__wall.wells)"
            )
            assert towards > 0.5, "rather the face of the disc than its edge"
            texts = screen.evaluate("document.getElementById('ink').labels.map(({ text }) => text)")
            for wall in walls.values():
                for pick in wall.picks:
                    assert "{:.0f} / {:03.0f}".format(*pick.dip(wall.path)) in texts, "each disc has its angles"
            assert "TVD m" in texts
            across, down = np.array(corners).T
            assert 0 < across.min() < across.max() < width
            assert 0 < down.min() < down.max() < height
            screen.close()

    def test_the_nearer_the_eye_the_thinner_the_lines_and_the_hole(self, browser: Any) -> None:
        """Two wells 700 m apart: seen as a whole, then one alone. Discs are seen through, their edges are not."""
        walls = {"A-1": made((0.0, 0.0, 0.0), TOPS["A-1"]), "B-2": made((0.0, 700.0, 0.0), TOPS["B-2"])}
        walls["A-1"].picks = [hb.Pick(kind="fracture", depth=1006.0, apparent_dip=60.0, toolface=90.0)]
        state = (
            "(({ scene, tube }) => [tube, scene.thin, 2 * Math.hypot(...scene.from) *"
            " window.__wall.wells.gpu.outside.tangent / scene.rect.height])(window.__wall.wells)"
        )
        with hb.view_wells(walls) as viewer:
            screen = Screen(browser, viewer.url, "#off=fence_box", drawn=False)
            screen.until("window.__wall.wells.drawn.length === 2 && window.__wall.wells.wells[0].planes.length")
            said = "ink.labels.map(({ text }) => text)"
            screen.until(
                f"{said}.includes('B-2, 700 m E →')"
            )  # they would be dots: the first is seen, and where the other is
            assert "A-1" in screen.evaluate(said)
            screen.click("#fit")
            screen.until("!ink.labels.some(({ text }) => / m [NESW]/.test(text))")  # both are in view
            far = screen.evaluate(state)
            screen.click("#wells button")
            screen.until(f"window.__wall.wells.tube < {far[0]}")
            near = screen.evaluate(state)
            assert near[1] < far[1] / 10
            assert [1.5 < thin / pixel < 4 for _, thin, pixel in (far, near)] == [True, True], "a line has some pixels"
            assert 0.1 * 2 * far[0] < 16 / 4, "no hole of 16 m is drawn as a disc"
            alphas = screen.evaluate("window.__wall.wells.scene.areas.tints.filter((_, i) => i % 4 === 3)")
            assert {round(255 * 0.35), round(255 * 0.9)} <= set(alphas)
            screen.close()

    def test_one_of_wells_far_apart_has_measured_depths_and_a_scale_bar(self, browser: Any) -> None:
        walls = {"A-1": made((0.0, 0.0, 0.0), TOPS["A-1"]), "B-2": made((0.0, 700.0, 0.0), TOPS["B-2"])}
        with hb.view_wells(walls) as viewer:
            screen = Screen(browser, viewer.url, drawn=False)
            said = "ink.labels.map(({ text }) => text)"
            screen.until(f"{said}.includes('B-2, 700 m E →')")
            texts = screen.evaluate(said)
            depths = [float(text.split()[1]) for text in texts if text.startswith("MD ")]
            assert len(depths) >= 3
            assert all(1000 <= depth <= 1016 for depth in depths)
            assert np.unique(np.diff(sorted(depths))).size == 1, "each of the same step"
            assert any(re.fullmatch(r"[\d.]+ m", text) for text in texts), "the length of the bar"
            screen.click("#fit")
            screen.until(f"!{said}.some((text) => text.startsWith('MD '))")  # the whole box has its own letters
            screen.close()

    def test_wells_that_wait_for_their_first_data_are_counted_and_come(self, browser: Any) -> None:
        scenes, wall = [Scene(), Scene(), Scene()], made(HEADS["A-1"])
        Feed(wall, path=wall.path, attributes={}, well="A-1", scene=scenes[1])
        server = PageServer(scenes, Access())
        try:
            with urllib.request.urlopen(server.url.replace("/?", "/api/wells?")) as answered:
                assert [one and one["name"] for one in json.load(answered)] == [None, "A-1", None]
            screen = Screen(browser, server.url, drawn=False)
            said = "document.getElementById('lampText').textContent"
            screen.until(f"{said} === '2 of 3 wells wait for their first data'")
            wall = made(HEADS["B-2"])
            Feed(wall, path=wall.path, attributes={}, well="B-2", scene=scenes[2])
            screen.page.wait_for_selector("text=1 of 3 wells waits for its first data")  # the page has begun anew
            screen.until("window.__wall?.wells.drawn.length === 2")
            screen.close()
        finally:
            server.close()

    def test_heights_are_exaggerated_and_the_picture_says_so(self, browser: Any, wells: Any) -> None:
        screen = Screen(browser, wells[0].url, drawn=False)
        box = (
            "(({ scene }) => { const { low, high, rect } = scene; const [x, y, z] = low;"
            " const [a, b] = [[x, y, z], [x, y, high[2]]].map((at) => scene.project(at, rect));"
            " const c = scene.project([high[0], y, z], rect);"
            " return Math.hypot(b[0] - a[0], b[1] - a[1]) / Math.hypot(c[0] - a[0], c[1] - a[1]);"
            "})(window.__wall.wells)"
        )
        flat = screen.evaluate(box)
        screen.page.select_option("#tall", "5")
        screen.until("window.__wall.wells.scene.tall === 5 && window.__wall.wells.scene.fitted")
        labels = "document.getElementById('ink').labels.map(({ text }) => text).join()"
        screen.until(f"{labels}.includes('heights × 5: dips look steeper')")
        assert screen.evaluate(box) > 2.5 * flat
        assert "true dip" not in screen.evaluate(labels)
        screen.until("location.hash.includes('tall=5')")
        screen.close()

    def test_a_top_is_the_disc_of_its_bed_or_a_level_ring_without_a_dip(self, browser: Any) -> None:
        walls = {name: made(HEADS[name], TOPS[name]) for name in ("A-1", "B-2")}
        pick = hb.Pick(kind="bed", depth=1004.0, apparent_dip=30.0, toolface=90.0)
        walls["A-1"].picks = [pick]
        with hb.view_wells(walls) as viewer:
            screen = Screen(browser, viewer.url, "#off=fence_box", drawn=False)
            screen.until("window.__wall.wells.drawn.length === 2 && window.__wall.wells.wells[0].planes.length")
            screen.click("#fit")
            screen.until("document.getElementById('ink').labels.some(({ text }) => text.startsWith('Bed 1'))")
            texts = screen.evaluate("document.getElementById('ink').labels.map(({ text }) => text)")
            angles = "{:.0f} / {:03.0f}".format(*pick.dip(walls["A-1"].path))
            beds = sorted(text for text in texts if text.startswith("Bed"))
            assert beds == sorted([f"Bed 0   {angles}", "Bed 0", *["Bed 1"] * 2])
            assert angles not in texts, "the disc of a top is not drawn a second time"
            heights = screen.evaluate(
                "(({ scene, drawn }) => drawn.map((well) => scene.topsOf(well).map(({ plane, start }) =>"
                " scene.disc(well, plane).map(({ edge }) => edge[2] - scene.at(well, start)[2]))))(window.__wall.wells)"
            )
            high = [np.abs(edge).max() for well in heights for edge in well]
            assert max(high[1:]) < 1e-6, "the ring of a top without a dip is level, though the hole leans by 30 degrees"
            assert high[0] > 0.1
            screen.close()

    @pytest.mark.parametrize(("inclination", "cut"), [(30.0, "cut at high side"), (0.5, "cut at north")])
    def test_casings_end_at_their_shoes_and_images_say_where_they_are_cut(
        self, browser: Any, inclination: float, cut: str
    ) -> None:
        walls = {name: made(HEADS[name], TOPS[name], inclination) for name in ("A-1", "B-2")}
        for wall in walls.values():
            wall.intervals = (*wall.intervals, hb.Interval("Surface", 0.0, 1002.0, "Casing", 0.244))
        with hb.view_wells(walls) as viewer:
            screen = Screen(browser, viewer.url, "#mode=section", (1366, 768), drawn=False)
            screen.until("window.__wall.wells.section.columns.length === 2")
            screen.until("document.getElementById('ink').labels.some(({ text }) => text === 'Bed 1')")
            texts = screen.evaluate("document.getElementById('ink').labels.map(({ text }) => text)")
            assert texts.count("shoe Surface, 244 mm") == 2
            assert texts.count(cut) == 2
            assert screen.evaluate("document.getElementById('cut').selectedOptions[0].text").endswith(cut)
            assert screen.touching("ink") == []
            screen.evaluate("document.getElementById('mode').value = 'scene'")
            screen.evaluate("document.getElementById('mode').dispatchEvent(new Event('change'))")
            screen.until("document.getElementById('ink').labels.some(({ text }) => text === 'TVD m')")
            screen.click("#fit")
            screen.until("document.getElementById('ink').labels.some(({ text }) => text === 'shoe Surface, 244 mm')")
            screen.close()
        with hb.view(walls["A-1"], path=walls["A-1"].path) as one:
            screen = Screen(browser, one.url, "", (1920, 1080), drawn=False)
            screen.until(f"document.getElementById('ink').labels.some(({{ text }}) => text === '{cut}')")
            screen.close()

    @pytest.mark.parametrize("apart", [0.3, 1.5])
    def test_names_of_tops_and_picks_keep_the_order_of_their_depths_at_every_well(
        self, browser: Any, apart: float
    ) -> None:
        """Of wells far apart, whose tops are a few pixels from each other; a name without room is left out."""
        tops = tuple(1003.0 + apart * i for i in range(5))
        walls = {"A-1": made((0.0, 0.0, 0.0), tops), "B-2": made((250.0, -280.0, 0.0), tops)}
        for wall in walls.values():  # the edges of their discs are not in the order of their middles
            wall.picks = [
                hb.Pick(kind="fracture", depth=depth, apparent_dip=60.0, toolface=45.0 * i, note=f"F{i}")
                for i, depth in enumerate(tops)
            ]
        with hb.view_wells(walls) as viewer:
            screen = Screen(browser, viewer.url, drawn=False)
            screen.until("window.__wall.wells.drawn.length === 2")
            screen.click("#fit")
            screen.until("!ink.labels.some(({ text }) => / m [NESW]/.test(text))")  # none is beyond the edge
            screen.until("document.getElementById('ink').labels.some(({ text }) => text === 'Bed 1')")
            labels, ends = screen.evaluate(
                "(({ scene, drawn }) => [document.getElementById('ink').labels,"
                " drawn.map((well) => scene.project(scene.at(well, 1003), scene.rect))])(window.__wall.wells)"
            )
            for first, (x, _) in itertools.product("BF", ends):
                names = [one for one in labels if re.match(rf"{first}(ed )?\d", one["text"])]
                here = [one for one in names if abs(one["left"] - x) < abs(ends[1][0] - ends[0][0]) / 2]
                assert len(here) > (first == "B")
                assert [one["text"] for one in sorted(here, key=lambda one: one["top"])] == sorted(
                    one["text"] for one in here
                )
            assert screen.touching("ink") == []
            screen.close()

    @pytest.mark.parametrize("size", [(1366, 768), (390, 844)])
    def test_in_the_scene_no_words_cover_a_hole_or_others_and_beds_make_way_first(
        self, browser: Any, size: tuple[int, int]
    ) -> None:
        """Of three wells on one pad, one of them nearly level, with tops, a shoe and picks that are close together."""
        heads = {"A-1": (0.0, 0.0, 0.0), "B-2": (41.0, -12.0, 8.0), "C-3": (-12.0, 43.0, -5.0)}
        walls = {
            name: made(head, (1003.0, 1009.0), inclination)
            for (name, head), inclination in zip(heads.items(), (34.0, 80.0, 5.0), strict=True)
        }
        for wall in walls.values():
            wall.intervals = (*wall.intervals, hb.Interval("Surface", 0.0, 1002.0, "Casing", 0.244))
            wall.picks = [
                hb.Pick(kind=kind, depth=1002.5 + i, apparent_dip=50.0, toolface=20.0 * i, note=f"{kind[0]}{i}")
                for i, kind in enumerate(6 * ("bed", "fracture"))
            ]
        with hb.view_wells(walls) as viewer:
            screen = Screen(browser, viewer.url, "", size, drawn=False)
            screen.until("window.__wall.wells.drawn.length === 3")
            screen.until("window.__wall.wells.wells.every((well) => well.planes.length === 12)")
            screen.click("#fit")
            screen.until("ink.labels.some(({ text }) => text.startsWith('dip / azimuth'))")
            labels, holes = screen.evaluate(
                "(({ scene, drawn }) => [document.getElementById('ink').labels, drawn.map((well) => "
                " Array.from({ length: 81 }, (_, i) => scene.project(scene.at(well, 1000 + i / 5), scene.rect)))])"
                "(window.__wall.wells)"
            )
            assert screen.touching("ink") == []
            screen.close()
        beside = [one for one in labels if re.match(r"Bed|[bf]\d|shoe", one["text"])]
        for one, hole in itertools.product(beside, holes):
            for x, y in hole:
                assert not (one["left"] < x < one["right"] and one["top"] < y < one["bottom"]), one["text"]
        names = [one["text"][0] for one in beside]
        assert names.count("B") >= 3
        assert names.count("f") > names.count("b")

    @pytest.mark.parametrize("size", [(1366, 768), (390, 844)])
    def test_side_by_side_angles_are_whole_and_no_top_strikes_them_also_on_a_phone(
        self, browser: Any, size: tuple[int, int]
    ) -> None:
        walls = {name: made(HEADS[name], (1003.0, 1006.0, 1009.0, 1012.0)) for name in HEADS}
        for wall in walls.values():  # at many distances from the tops
            wall.picks = [
                hb.Pick(kind="fracture", depth=1001.5 + 0.93 * i, apparent_dip=40.0, toolface=30.0 * i)
                for i in range(12)
            ]
        with hb.view_wells(walls) as viewer:
            screen = Screen(browser, viewer.url, "#mode=section", size, drawn=False)
            screen.until("window.__wall.wells.wells.every((well) => well.planes.length === 12)")
            screen.until("ink.labels.filter(({ text }) => / [/] [0-9]/.test(text)).length > 5")
            widths = screen.evaluate("window.__wall.wells.section.columns.map(({ rects }) => rects.image.width)")
            texts = [one["text"] for one in screen.evaluate("ink.labels")]
            struck = [text for text, _ in screen.struck("ink") if " / " in text]
            screen.close()
        assert min(widths) > 55
        assert not [text for text in texts if re.search(r"\d.*…$", text)], "no number is cut"
        assert struck == []

    def test_side_by_side_the_wells_have_one_scale_of_the_caliper_and_a_key(self, browser: Any) -> None:
        toolface, depth = np.tile(np.arange(16) * 22.5, 160), 1000.0 + np.arange(16 * 160) / 160
        walls = {}
        for name, radius, wide in (("tight", 0.1, 0.1), ("wide", 0.1, 0.16)):
            washout = np.where((depth > 1006) & (depth < 1009), wide, radius)
            caliper = hb.Caliper(depth, toolface, washout)
            walls[name] = hb.reconstruct(caliper, bit_diameter=0.2, sectors=16, pitch=0.1)
        walls["tight"].picks.append(hb.Pick(kind="fracture", depth=1004.0, apparent_dip=10.0, toolface=0.0))
        walls["wide"].picks.append(hb.Pick(kind="bed", depth=1004.0, apparent_dip=10.0, toolface=0.0))
        with hb.view_wells(walls) as viewer:
            screen = Screen(browser, viewer.url, "#mode=section", (1366, 768), drawn=False)
            with screen.page.expect_download() as download:
                screen.click("#svg")
            root = ElementTree.parse(download.value.path()).getroot()
            words = [text.text or "" for text in root.iter("{http://www.w3.org/2000/svg}text")]
            assert words.count("Caliper [mm]") == 2, words
            first, second = (words[at - 2 : at] for at, word in enumerate(words) if word == "bit 200")
            assert first == second, "one diameter has one place"
            assert float(second[1]) >= 320
            key = [word for word in words if word in {"bed", "fracture", "fault", "breakout", "washout"}]
            assert key == ["washout", "bed", "fracture"]
            colour = screen.evaluate("window.__wall.wells.view.theme === 'dark' ? 1 : 0")
            washout = f"#{json.loads(COLOURS.read_text())['zones']['washout'][colour]}"
            filled = [path.get("d") for path in root.iter() if path.get("fill") == washout]
            assert len(filled) == 2, "the strip and the key have the same colour"
            screen.close()

    def test_side_by_side_the_dips_have_a_track_and_numbers_and_the_zones_their_colours(self, browser: Any) -> None:
        walls = {name: made(HEADS[name], TOPS[name]) for name in ("A-1", "B-2")}
        walls["A-1"].picks = [hb.Pick(kind="fracture", depth=1007.0, apparent_dip=60.0, toolface=90.0)]
        with hb.view_wells(walls) as viewer:
            screen = Screen(browser, viewer.url, "#mode=section&units=mm", (1366, 768), drawn=False)
            screen.until("window.__wall.wells.section.columns[0]?.rects.dips")
            dip, azimuth = walls["A-1"].picks[0].dip(walls["A-1"].path)
            screen.until("document.getElementById('ink').labels.some(({ text }) => text === 'fracture')")
            labels = screen.evaluate("document.getElementById('ink').labels.map(({ text }) => text)")
            assert f"{dip:.0f} / {azimuth:03.0f}" in labels
            assert labels.count("dip [°]") == 2, "each well has the track, so that the wells stay alike"
            ends = screen.evaluate("window.__wall.wells.section.columns.map(({ rects }) => rects.dips.left + 84)")
            assert ends[1] == pytest.approx(screen.evaluate("document.getElementById('ink').clientWidth"), abs=12)
            apart = np.hypot(*np.subtract(HEADS["A-1"], HEADS["B-2"])[:2])
            assert f"{apart:.0f} m apart" in labels
            screen.evaluate("document.getElementById('planes').click()")
            screen.until("!window.__wall.wells.section.columns[0].rects.dips")
            assert screen.touching("ink") == []
            screen.close()

    def test_pointer_finds_well_and_depth(self, browser: Any, wells: Any) -> None:
        screen = Screen(browser, wells[0].url, "#mode=section", drawn=False)
        screen.until("window.__wall.wells.drawn.length === 3")
        rect, top, length = screen.evaluate(
            "(({ section: { columns, top, length } }) => [columns[1].rects.image, top, length])(window.__wall.wells)"
        )
        bar = screen.evaluate("document.getElementById('stage').getBoundingClientRect().top")
        screen.mouse.move(rect["left"] + 0.5 * rect["width"], bar + rect["top"] + 0.25 * rect["height"])
        screen.until("document.querySelector('#readout dd')")
        found = screen.readout()
        assert found["Well"] == "B-2"
        assert float(found["MD"].split()[0]) == pytest.approx(top + 0.25 * length, abs=0.1)
        assert found["Bed"] == "–"
        screen.close()

    @pytest.mark.parametrize("mode", ["scene", "section"])
    def test_the_wells_are_saved_as_a_vector_picture(self, browser: Any, wells: Any, mode: str) -> None:
        screen = Screen(browser, wells[0].url, f"#mode={mode}", drawn=False)
        with screen.page.expect_download() as download:
            screen.click("#svg")
        root = ElementTree.parse(download.value.path()).getroot()
        texts = [text.text for text in root.iter("{http://www.w3.org/2000/svg}text")]
        assert set(HEADS) <= set(texts)
        assert "Bed 1" in texts
        screen.close()

    @pytest.mark.parametrize("mode", ["scene", "section"])
    def test_a_slide_of_the_wells_leaves_the_page_as_it_was(self, browser: Any, wells: Any, mode: str) -> None:
        screen = Screen(browser, wells[0].url, f"#mode={mode}", drawn=False)
        with screen.page.expect_download() as download:
            screen.click("#slide")
        assert download.value.suggested_filename == f"wells-{mode}.slide.png"
        wide, high = struct.unpack(">II", Path(download.value.path()).read_bytes()[16:24])
        assert [wide, high] == [3840, 2160]
        assert screen.evaluate("stage.clientWidth + document.querySelector('aside').offsetWidth") == 1000
        screen.close()

    def test_a_picture_of_the_wells_waits_for_what_has_not_arrived(self, browser: Any, wells: Any) -> None:
        screen = Screen(browser, wells[0].url, "#mode=section", drawn=False)
        screen.evaluate(
            "(() => { const { wells } = window.__wall; window.__saved = 0;"
            " const draw = wells.draw.bind(wells); wells.draw = () => { draw();"
            " if (document.getElementById('ink').slide) { window.__saved++; window.__tiles = well.mostTiles; } };"
            " const [well] = wells.wells; const { tiles } = well.store.levels[0];"
            " window.__tile = tiles.get(0); tiles.delete(0); well.ask = () => {}; })()"
        )
        with screen.page.expect_download():
            screen.click("#slide")
            screen.page.wait_for_timeout(400)
            assert screen.evaluate("window.__saved") == 0, "it waits"
            screen.evaluate("window.__wall.wells.wells[0].store.levels[0].tiles.set(0, window.__tile)")
        assert screen.evaluate("window.__saved") == 1
        tiles = screen.evaluate("[window.__tiles, window.__wall.wells.wells[0].mostTiles]")
        assert tiles == [256, 64], "of a picture, and of the page, which is drawn while it moves"
        screen.close()

    def test_a_slide_of_the_scene_is_filled_and_says_how_sure_dips_are_and_what_has_no_data(self, browser: Any) -> None:
        walls = {name: made(HEADS[name], TOPS[name]) for name in ("A-1", "B-2")}
        dip = {"apparent_dip": 40.0, "dip_sigma": 1.0, "toolface_sigma": 2.0}
        walls["A-1"].picks.append(hb.Pick(kind="fracture", depth=1008.0, toolface=30.0, **dip))
        with hb.view_wells(walls) as viewer:
            screen = Screen(browser, viewer.url, "#mode=scene", (1000, 800), drawn=False)
            screen.evaluate(
                "(() => { const { wells } = window.__wall; const draw = wells.draw.bind(wells); wells.draw = () => {"
                " draw(); const ink = document.getElementById('ink'); if (!ink.slide) return;"
                " const seen = wells.scene.corners.map((at) => wells.scene.project(at, wells.scene.rect));"
                " window.__slide = [ink.labels.map(({ text }) => text), seen]; }; })()"
            )
            eye = screen.evaluate("window.__wall.wells.scene.from")
            with screen.page.expect_download():
                screen.click("#slide")
            texts, corners = screen.evaluate("window.__slide")
            wide, tall = (max(at[axis] for at in corners) - min(at[axis] for at in corners) for axis in (0, 1))
            assert wide > 0.78 * 960 or tall > 0.78 * 490
            assert "no data" in texts
            assert any(re.fullmatch(r"\d+ ± \d+ / \d{3} ± \d+", text) for text in texts)
            assert any("± 95 %" in text for text in texts)
            assert screen.evaluate("window.__wall.wells.scene.from") == pytest.approx(eye), "the page as before"
            screen.close()

    def test_a_slide_side_by_side_has_no_place_no_scale_and_no_number_struck_through(self, browser: Any) -> None:
        with hb.view_wells({"One": made(None, (1004.0, 1010.0)), "Two": made(None, (1006.0, 1009.65))}) as viewer:
            screen = Screen(browser, viewer.url, "#mode=section", drawn=False)
            assert screen.evaluate("document.getElementById('placed').textContent") == ""
            screen.evaluate(
                "(() => { window.__said = []; const { prototype } = CanvasRenderingContext2D;"
                " const write = prototype.fillText; prototype.fillText = function (...of) {"
                " window.__said.push(of[0]); return write.apply(this, of); };"
                " const { wells } = window.__wall; const draw = wells.draw.bind(wells); wells.draw = () => { draw();"
                " const ink = document.getElementById('ink'); if (!ink.slide) return;"
                " window.__axis = wells.section.columns[1].rects.axis;"
                " window.__ink = [ink.labels, ink.strokes]; }; })()"
            )
            with screen.page.expect_download():
                screen.click("#slide")
            said, axis, (labels, strokes) = screen.evaluate("[window.__said, window.__axis, window.__ink]")
            assert "One, Two   by measured depth" in said
            assert not [text for text in said if "apart" in text]
            assert not [one["text"] for one in labels if one["text"].startswith("1:")]
            right = axis["left"] + axis["width"]
            numbers = [one for one in labels if one["text"].isdigit() and axis["left"] < one["left"] < right]
            assert "1010" in [one["text"] for one in numbers], "a bed of Two begins at this number"
            across = [(a, b, y) for a, y, b, low in strokes if y == low and b - a > 5 and a >= axis["left"] - 1]
            assert [(a, b) for a, b, y in across if a < axis["left"] + 1 and b < right], "a line comes from the left"
            for one in numbers:
                middle = (one["top"] + one["bottom"]) / 2
                assert not [y for a, b, y in across if a < one["right"] and b > one["left"] and abs(y - middle) < 5]
            screen.close()

    def test_a_wells_page_opens(self, browser: Any, wells: Any) -> None:
        screen = Screen(browser, wells[0].url, drawn=False)
        links = screen.evaluate("[...document.querySelectorAll('#wells a')].map(({ href }) => href)")
        screen.close()
        own = Screen(browser, links[::2][2], drawn=False)  # beside it is the way to pick
        own.until("document.title.startsWith('C-3')")
        assert own.evaluate("window.__wall.app.store.intervals.length") == 2
        own.close()

    def test_wells_without_a_place_stand_apart_and_the_page_says_so(self, browser: Any) -> None:
        with hb.view_wells({"One": made(None), "Two": made(None), "Three": made((5.0, 5.0, 0.0))}) as viewer:
            screen = Screen(browser, viewer.url, drawn=False)
            east = screen.evaluate("window.__wall.wells.wells.map((well) => well.path.at(1005).centre[1])")
            assert abs(east[1] - east[0]) > 1.0
            note = screen.evaluate("document.getElementById('placed').textContent")
            assert "One, Two" in note
            screen.page.select_option("#mode", "section")
            with screen.page.expect_download() as download:
                screen.click("#svg")
            texts = ElementTree.parse(download.value.path()).getroot().itertext()
            assert not [text for text in texts if "No place is stated" in text], "side by side no place counts"
            assert f"{east[1] - east[0]:g} m apart" in note
            assert "Three" not in note
            screen.close()

"""The page shows nothing as measured, known or dipping that is not: each point in a real browser."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from made_wall import BIT, MadeWall, gamma
from screen import NEEDS_BROWSER, Screen

import helibore as hb
from helibore.plot.content import Drawing, content_of
from helibore.wall.interpolation import on_quads
from helibore.wall.uncertainty import NORMAL_95

pytestmark = NEEDS_BROWSER

ENDS = "Object.fromEntries(window.__wall.app.selection.quantities.map(({ id, low, high }) => [id, [low, high]]))"


# Pixels of the cross-section in the colour of the band and the cursor.
COLOURED = """(() => {
  const { width, height } = document.getElementById('polar');
  const { data } = document.getElementById('polar').getContext('2d').getImageData(0, 0, width, height);
  let count = 0;
  for (let i = 0; i < data.length; i += 4) if (data[i] > data[i + 1] + 40 && data[i] > data[i + 2] + 40) count++;
  return count;
})()"""


def ink_texts(screen: Screen) -> list[str]:
    return [label["text"] for label in screen.evaluate("document.getElementById('ink').labels")]


def with_gamma(caliper: hb.Caliper, reference: Any = "high-side", end: float = 2040.0) -> hb.Wall:
    """A wall of a caliper with a gamma image."""
    wall = hb.reconstruct(caliper, bit_diameter=BIT, sectors=32)
    depth = np.arange(2000.0, end, 0.1)
    rows = gamma(depth[:, None], np.arange(16.0)[None] * 22.5)
    wall.images["GR"] = hb.SectorImage(depth, rows, "GR", "gAPI", origin="edge", reference=reference)
    return wall


def test_of_a_gauge_hole_only_the_images_are_shown_as_measured(browser: Any) -> None:
    with hb.view(with_gamma(hb.Caliper.gauge(2000.0, 2040.0, BIT))) as viewer:
        screen = Screen(browser, viewer.url, "#md=2020&sec=30", drawn=False)
        screen.point_at()
        said = "No caliper: the hole is drawn at bit size, 216.0 mm (8.504 in). Nothing measured its "
        assert screen.inner_text("#basis") == f"{said}diameter, section, volume or washout."
        assert screen.is_visible("#basis")
        assert not screen.is_visible("#crossSection")
        assert not screen.is_visible("#zonesCard")
        texts = ink_texts(screen)
        assert "GR [gAPI]" in texts
        assert not [text for text in texts if text.startswith(("Caliper", "C1", "C2", "least", "bit ", "Over bit"))]
        assert screen.evaluate("window.__wall.app.renderer.rects.caliper.width") == 0
        assert screen.evaluate("window.__wall.app.selection.quantities.map(({ id }) => id)") == ["GR"]
        section = screen.inner_text("#section")
        assert section.split() == ["Hole", "size,", "volume,", "washout", "not", "measured"]
        values = screen.readout()
        assert values["Radius"] == "not measured"
        assert not {"Over bit radius", "Change", "Nearest sample", "Samples used"} & set(values)
        assert not any(screen.is_visible(control) for control in ("#shape", "#median"))
        assert values["GR"].endswith("gAPI")
        screen.close()


def test_an_image_measured_in_rows_is_drawn_in_rows_with_their_values(browser: Any) -> None:
    wall = with_gamma(hb.Caliper.gauge(2000.0, 2040.0, BIT))
    values = wall.images["GR"].values
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, "#md=2025.05&sec=4&quantity=GR")
        screen.settle()
        image = screen.pixels("image").astype(int)[:, :, :3]
        height = len(image)
        edges = (np.arange(1, 40) * height / 40).round().astype(int)
        changes = np.flatnonzero(np.abs(np.diff(image, axis=0)).max(axis=(1, 2)) > 0) + 1
        assert set(changes) <= {edge + by for edge in edges for by in (-1, 0, 1)}, "level edges, every 0.1 m"
        assert len(changes) > 30
        for depth, toolface in ((2023.53, 11.0), (2025.58, 191.0), (2025.62, 348.0), (2026.9, 100.0)):
            screen.evaluate(f"window.__wall.app.view.point({{ depth: {depth}, toolface: {toolface} }}, true)")
            screen.settle()
            row = values[round((depth - 2000.0) / 0.1)]
            assert float(screen.readout()["GR"].split()[0]) == pytest.approx(row[int(toolface / 22.5)], abs=0.01)
        # Edges of rows lie in the middle of pixels.
        length = 0.02 * screen.evaluate("window.__wall.app.renderer.rects.wall.height")
        screen.evaluate(f"window.__wall.app.view.show({2015.04 + length / 2}, {length}, window.__wall.app.store)")
        screen.settle()
        hole = screen.pixels("wall").astype(int)[:, :, :3]
        across = slice(hole.shape[1] // 2 - 40, hole.shape[1] // 2 - 4)
        change = np.abs(np.diff(hole[:, across], axis=0)).max(axis=2)
        lines = (change > 4).any(axis=1)
        dashed = lines & (change == 0).any(axis=1)
        assert lines.sum() > 60
        assert dashed.sum() < 0.1 * lines.sum(), "edges of rows are lines on the straightened hole too"
        screen.close()


def test_an_image_measured_in_rows_has_no_line_without_data_where_tiles_meet(browser: Any) -> None:
    wall = with_gamma(hb.Caliper.gauge(2000.0, 2080.0, BIT), end=2080.0)
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, "#md=2051&sec=4&quantity=GR")
        screen.settle()
        level = "window.__wall.app.store.levels[0]"
        seam = screen.evaluate(f"{level}.startDepth + {level}.rows * {level}.pitch")
        edge = round((seam - 2000.05) / 0.1) * 0.1 + 2000.05  # of the image row there
        height = screen.evaluate("window.__wall.app.renderer.rects.image.height")
        for pixel in (0.004, 0.011, 0.03):
            for shift in np.linspace(-0.004, 0.004, 5):  # the edge lies in the middle of a pixel, or just beside it
                top = edge - (height // 2 + 0.5 + shift) * pixel
                screen.evaluate(f"window.__wall.app.view.show({top}, {height * pixel}, window.__wall.app.store)")
                screen.settle()
                image = screen.pixels("image").astype(int)[:, :, :3]
                bare = np.flatnonzero((image == (244, 245, 246)).all(axis=2).any(axis=1))
                assert not bare.size, f"rows {bare} with the colour of the page, {pixel} m a pixel, shift {shift}"
        screen.close()


def test_the_range_of_what_is_in_view_is_chosen_and_said(browser: Any) -> None:
    wall = with_gamma(hb.Caliper.gauge(2000.0, 2040.0, BIT))
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, "#md=2020&sec=30", drawn=False)
        screen.settle()
        ends = "(({ low, high }) => [low, high])(window.__wall.app.renderer.look().quantity)"
        whole = screen.evaluate(ends)
        assert "static" in ink_texts(screen)
        screen.click("#inView")
        screen.evaluate("window.__wall.app.view.show(2020, 1, window.__wall.app.store)")
        screen.settle()
        assert "range in view" in ink_texts(screen)
        rows = wall.images["GR"].values[200:210]
        low, high = screen.evaluate(ends)
        assert low == pytest.approx(np.percentile(rows, 2), abs=4)
        assert high == pytest.approx(np.percentile(rows, 98), abs=4)
        assert [low, high] != pytest.approx(whole)
        again = Screen(browser, viewer.url, screen.address(), drawn=False)
        again.settle()
        assert again.evaluate(ends) == pytest.approx([low, high])
        again.click("#inView")
        again.settle()
        assert again.evaluate(ends) == pytest.approx(whole, rel=1e-4)
        again.close()
        screen.close()


@pytest.mark.parametrize(("reference", "sides"), [("high-side", "URDL"), ("north", "NESW")])
def test_without_a_survey_the_sides_are_named_as_in_print(browser: Any, reference: str, sides: str) -> None:
    wall = with_gamma(hb.Caliper.gauge(2000.0, 2040.0, BIT), reference)
    wall.made_from["toolface"] = "assumed"  # as a run notes it
    assert content_of(wall, Drawing()).reference == reference
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, "#md=2020&sec=30", drawn=False)
        texts = ink_texts(screen)
        assert [text for text in texts if text in sides][:5] == [*sides, sides[0]]
        assert "no survey" in texts  # of true depth
        assert "assumed" in texts, "beside the letters"
        assert screen.evaluate("document.getElementById('cut').selectedOptions[0].text").startswith("-".join(sides))
        assert screen.evaluate("document.getElementById('cut').selectedOptions[0].text").endswith("(assumed)")
        assert "From high side / azimuth, assumed" in screen.readout()
        screen.close()


def test_an_average_caliper_has_a_size_and_no_shape(browser: Any) -> None:
    depth = np.arange(2000.0, 2040.0, 0.1)
    wall = with_gamma(hb.Caliper.from_average(depth, BIT + 0.03 * (np.abs(depth - 2020) < 3)))
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, "#md=2020&sec=38", drawn=False)
        screen.until("window.__wall.app.zones.length")
        screen.settle()
        assert screen.inner_text("#basis") == "Average caliper: size measured, shape assumed round."
        assert not screen.is_visible("#crossSection")
        texts = ink_texts(screen)
        assert any(text.startswith("mean,") for text in texts)
        assert not {"C1", "C2"} & set(texts)
        screen.close()
        phone = Screen(browser, viewer.url, "#md=2020&sec=38", (390, 844), drawn=False)
        phone.settle()
        assert "GR [gAPI]" in ink_texts(phone), "the one image that was measured"
        look = (
            "(({ color, backgroundColor: ground }) => [color, ground])(getComputedStyle(document.getElementById('%s')))"
        )
        for theme in ("light", "dark"):
            phone.evaluate(f"window.__wall.app.view.choose({{ theme: '{theme}' }})")
            phone.settle()
            alarm = phone.evaluate(look % "alarm")[1]
            for colour in phone.evaluate(look % "basis"):
                red, green, blue = map(int, re.findall(r"\d+", colour)[:3])
                assert colour != alarm
                assert red - max(green, blue) < 60, "what is always so is not in the colours of an alarm"
        phone.close()


@pytest.mark.parametrize("arms", [4, 32])
def test_track_section_and_zones_say_the_diameters_of_the_logs(browser: Any, arms: int) -> None:
    """Of a tool with few arms they are those of its arms, between which the wall is rounder than the hole."""
    depth = np.repeat(np.arange(2000, 2010, 0.05), arms)
    around = np.array([0, 60, 180, 240]) if arms == 4 else np.arange(arms) * 360 / arms
    toolface = (np.tile(around, depth.size // arms) + 4 * depth) % 360
    radius = 0.115 + 0.018 * np.cos(np.radians(2 * toolface)) * (np.abs(depth - 2005) < 3)
    arm = np.tile(np.arange(arms) % 2, depth.size // arms) if arms == 4 else None
    wall = hb.reconstruct(hb.Caliper(depth, toolface, radius, arm=arm), bit_diameter=BIT)
    logs, K = wall.logs(), wall.settings.sectors
    assert logs.shape == ("arms" if arms == 4 else "wall")
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, "#md=2005&sec=8", (1366, 768), drawn=False)
        screen.until("window.__wall.app.zones.length")
        screen.until(f"Boolean(window.__wall.app.curves.byArms) === {str(arms == 4).lower()}")
        screen.settle()
        assert {"C1", "C2", "least, under bit"} <= set(ink_texts(screen))
        by_turn = wall.radius[: len(logs) * K].reshape(-1, K)
        of_wall = (by_turn + np.roll(by_turn, -K // 2, axis=1)).min(axis=1)
        rounder = np.where(np.abs(logs.depth - 2005) < 2, np.abs(logs.least_diameter - of_wall), 0)
        row = int(np.nanargmax(rounder))
        assert (rounder[row] > 1e-3) == (arms == 4)
        beside = logs.depth[row] + 0.4 * wall.settings.pitch  # in the same turn
        screen.evaluate(f"window.__wall.app.view.point({{ depth: {beside}, toolface: null }}, true)")
        screen.settle()
        said = screen.evaluate("[...document.querySelectorAll('#turn > *')].map((e) => e.textContent)")
        sizes = [float(text.split()[0]) for text in said[1:6:2]]
        assert [text.split(" at ")[0] for text in said[:6:2]] == (
            ["C1 of arms", "C2 of arms", "Least"] if arms == 4 else ["C1", "C2", "Least"]
        )
        assert sizes == pytest.approx([1000 * one[row] for one in (logs.c1, logs.c2, logs.least_diameter)], abs=0.06)
        screen.close()


def test_a_measured_wall_has_no_banner_and_the_figures_of_its_summary(browser: Any) -> None:
    wall = with_gamma(hb.Caliper.gauge(2000.0, 2040.0, BIT))
    depth, toolface = wall.depth, wall.toolface
    larger = np.where(np.abs(depth - 2020) < 3, 0.02, 0.0) + np.where(np.abs(depth - 2021) < 0.3, 0.005, 0.0)
    measured = with_gamma(hb.Caliper(depth, toolface, 0.5 * BIT + larger))
    with hb.view(measured) as viewer:
        screen = Screen(browser, viewer.url, "#md=2020&sec=20", drawn=False)
        screen.until("window.__wall.app.figures.summary && window.__wall.app.zones.length")
        screen.settle()
        assert not screen.is_visible("#basis")
        summary = measured.summary(2010.0, 2030.0)
        text = screen.inner_text("#section")
        assert summary.washed_out == pytest.approx(6, abs=0.5)
        assert f"{summary.washed_out:.1f} m" in text
        assert f"{summary.volume:.3f} m³" in text
        whole = summary.whole_turns + summary.incomplete_turns
        assert f"{summary.washed_out:.1f} m of {whole:.1f} m, {100 * summary.washed_out / whole:.1f} %" in text
        assert f"{summary.whole_turns:.1f} m of whole turns" in text
        assert "largest_gap" in screen.get_attribute("#section dd", "title")
        (zone,) = measured.zones().zones
        shown = screen.evaluate("window.__wall.app.zones")
        assert [(one["kind"], one["start"]) for one in shown] == [(zone.kind, pytest.approx(zone.start, abs=1e-3))]
        assert zone.confidence_text == "99 %"
        row = ["W", "washout", f"{zone.start:.1f}–{zone.stop:.1f}", "+50", "99 %"]
        assert screen.inner_text("#zones button").split("\n") == row
        assert screen.inner_text("#zones div").split() == ["kind", "MD", "m", "mm", "sure"]
        assert screen.inner_text("#zonesTitle").lower() == "1 zone, worst first"
        assert screen.get_attribute("#zones button", "title").startswith("washout, 99 % sure, ")
        screen.evaluate("window.__wall.app.view.show(2000, 5, window.__wall.app.store)")
        screen.keyboard.press("n")
        cursor = screen.evaluate("window.__wall.app.view.cursor.depth")
        assert cursor == pytest.approx((zone.start + zone.stop) / 2, abs=1e-3)
        assert screen.evaluate("window.__wall.app.view.middle") == pytest.approx(cursor)
        screen.settle()
        assert screen.readout()["Radius"] == "–", "a cursor at a depth alone is on no quad, whose data could lack"
        screen.keyboard.press("f")
        viewer.scene.update_state(ended=True)  # a saved wall: it begins with its worst zone and follows nothing
        screen.until("!window.__wall.app.view.follow")
        assert screen.evaluate("window.__wall.app.view.middle") == pytest.approx(cursor)
        assert not screen.is_visible("#follow")
        screen.close()


def test_a_saved_wall_begins_within_its_ends_though_its_worst_zone_lies_near_one(browser: Any) -> None:
    wall = with_gamma(hb.Caliper.gauge(2000.0, 2020.0, BIT))
    radius = 0.5 * BIT + np.where(np.abs(wall.depth - 2018) < 1, 0.02, 0.0)
    with hb.view(with_gamma(hb.Caliper(wall.depth, wall.toolface, radius))) as viewer:
        viewer.scene.update_state(ended=True)
        screen = Screen(browser, viewer.url, drawn=False)
        screen.until("window.__wall.app.zones.length && !window.__wall.app.view.follow")
        top, bottom = screen.evaluate("[window.__wall.app.view.top, window.__wall.app.view.bottom]")
        assert 2000 - 0.01 <= top < bottom <= 2020 + 0.01
        screen.close()


def test_the_figures_of_a_growing_wall_stand_under_the_depths_that_they_are_of(browser: Any) -> None:
    wall = MadeWall(64 * 150)
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, "#md=1010&sec=30&follow=1", (1366, 768), drawn=False)
        screen.until("window.__wall.app.figures.summary")
        screen.settle()
        assert not screen.is_visible("#follow"), "nothing has come"
        assert "end of data, 1015.0 m" in ink_texts(screen)
        assert "changed" not in ink_texts(screen), "nothing glows"
        for turns in (30, 17):  # its turns are measured every 2 s at most
            viewer.update(wall.grow(64 * turns))
            end = wall.depth[-1]
            screen.until(f"window.__wall.app.store.end > {end - 0.001}")
            screen.settle()
            start, stop = map(float, screen.inner_text("#sectionTitle").removesuffix(" m").split("–"))
            metres = float(re.search(r"of ([0-9.]+) m,", screen.inner_text("#section")).group(1))  # type: ignore[union-attr]
            assert stop - start == pytest.approx(metres, abs=0.11)
            assert stop <= end + 0.05
            assert screen.inner_text("#follow") == "Following"
            assert {f"data to {end:.1f} m, not measured yet", "new", "changed"} <= set(ink_texts(screen))
        screen.close()


@pytest.mark.parametrize(
    ("survey", "head", "known"),
    [
        (([1970.0, 2100.0], [60.0, 60.0]), (0.0, 0.0, 0.0), None),
        (([1970.0, 2100.0], [60.0, 60.0]), (0.0, 0.0, 1500.0), 1525.0),
        (([0.0, 1000.0, 1000.001, 2100.0], [0.0, 0.0, 60.0, 60.0]), (0.0, 0.0, -54.9), 1510.0),
    ],
)
def test_true_depth_is_that_of_the_survey_or_none(
    browser: Any, survey: tuple[list[float], list[float]], head: tuple[float, float, float], known: float | None
) -> None:
    path = hb.Survey(survey[0], survey[1], [30.0] * len(survey[0])).path(head=head)
    with hb.view(MadeWall(20_000, start=2000.0), path=path) as viewer:
        screen = Screen(browser, viewer.url, "#md=2020&sec=20&at=2020_0", drawn=False)
        screen.settle()
        texts = ink_texts(screen)
        assert ("TVD m" in texts, "no TVD" in texts) == (known is not None, known is None)
        assert screen.readout()["TVD"] == ("–" if known is None else f"{known:.2f} m")
        assert np.isnan(screen.evaluate("window.__wall.app.path.tvd(2101)")), "beyond the survey"
        screen.close()


def test_colours_come_from_the_whole_wall_and_are_those_of_the_print(browser: Any) -> None:
    wall = with_gamma(hb.Caliper.gauge(2000.0, 2040.0, BIT))
    depth, toolface = wall.depth, wall.toolface
    wall = with_gamma(hb.Caliper(depth, toolface, 0.5 * BIT + 0.017 * (np.abs(depth - 2035) < 2)))
    content = content_of(wall, Drawing(unit="mm", polar=(), body=(), start=2000.0, stop=2010.0))
    over, gr = (track.shown.scale for track in content.tracks[2:])  # type: ignore[union-attr]
    assert (over.low, over.high, over.color_map) == (-20.0, 20.0, "over-bit")
    with hb.view(wall) as viewer:
        found = []
        for size, address in (((1366, 768), "#md=2005&sec=8"), ((900, 600), "#md=2035&sec=3"), ((1000, 640), "")):
            screen = Screen(browser, viewer.url, address, size, drawn=False)
            screen.settle()
            found.append(screen.evaluate(ENDS))
            screen.close()
    assert found[0] == found[1] == found[2]
    assert found[0]["over"] == pytest.approx([over.low / 1000, over.high / 1000])
    assert found[0]["GR"] == pytest.approx([gr.low, gr.high])


def test_a_gauge_hole_does_not_look_rough_beside_its_washout(browser: Any) -> None:
    """Neither the scale of the caliper nor the colours follow the section: a picture has one meaning in the well."""
    depth = np.arange(2000.0, 2080.0, 0.005)
    radius = np.where(abs(depth - 2010) < 1, 0.13, 0.1081 + 0.0002 * np.sin(depth * 5))
    wall = hb.reconstruct(hb.Caliper(depth, depth * 7200 % 360, radius), bit_diameter=0.216, sectors=32)
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, "#md=2010&sec=10", (1366, 768), drawn=False)

        def ends() -> tuple[list[str], list[float]]:
            screen.settle()
            left, width = screen.evaluate(
                "(({ left, width }) => [left, width])(window.__wall.app.renderer.rects.caliper)"
            )
            numbers = [
                one["text"]
                for one in screen.evaluate("document.getElementById('ink').labels")
                if one["bottom"] < 80 and left <= one["left"] and one["right"] <= left + width and one["text"].isdigit()
            ]
            return numbers, screen.evaluate("(({ low, high }) => [low, high])(window.__wall.app.selection.quantity)")

        in_washout = ends()
        assert len(in_washout[0]) == 2
        least, greatest = map(float, in_washout[0])
        assert least < 216 < 260 <= greatest
        for middle, length in ((2040, 10), (2060, 3), (2040, 80)):
            screen.evaluate(f"window.__wall.app.view.show({middle - length / 2}, {length}, window.__wall.app.store)")
            assert ends() == in_washout, (middle, length)
        screen.close()


@pytest.mark.parametrize(("gash", "reach"), [(0.0, 216.0), (0.05, 264.0)])
def test_an_open_fracture_does_not_stretch_the_colours_and_the_caliper(browser: Any, gash: float, reach: float) -> None:
    """What is a few centimetres long along the hole is written at the edge; the rest of the hole keeps its relief."""
    depth = np.arange(2000.0, 2020.0, 0.0005)
    toolface = depth * 36000 % 360
    along = depth - 2010.0 - BIT * np.cos(np.radians(toolface - 35))
    radius = 0.5 * BIT + 0.0025 * np.cos(np.radians(2 * toolface)) + gash * (np.abs(along) < 0.04)
    wall = hb.reconstruct(hb.Caliper(depth, toolface, radius), bit_diameter=BIT)
    content = content_of(wall, Drawing(unit="mm", polar=(), body=()))
    caliper, image = content.tracks[1:3]
    assert (image.shown.scale.low, image.shown.scale.high) == (-3.0, 3.0)  # type: ignore[union-attr]
    assert caliper.limits[1] <= 225  # type: ignore[union-attr]
    with hb.view(wall) as viewer:
        assert viewer.scene.state.ranges["over"] == pytest.approx((-0.003, 0.003))
        screen = Screen(browser, viewer.url, "#md=2010&sec=20", (1366, 768), drawn=False)
        left, width = screen.evaluate("(({ left, width }) => [left, width])(window.__wall.app.renderer.rects.caliper)")
        inside = [
            one["text"]
            for one in screen.evaluate("document.getElementById('ink').labels")
            if left <= one["left"] and one["right"] <= left + width
        ]
        low, high = (float(text) for text in inside if text.isdigit())
        assert 205 <= low < 216 < high <= 225
        beyond = [float(text.split()[0]) for text in inside if text.endswith("→")]
        assert bool(beyond) == bool(gash)
        assert all(value > reach for value in beyond)
        screen.close()


def test_the_cross_section_says_on_which_side_a_key_seat_lies(browser: Any) -> None:
    depth = np.arange(2000.0, 2012.0, 0.0005)
    toolface = depth * 36000 % 360
    slot = 0.02 * np.exp(-((((toolface - 187 + 180) % 360 - 180) / 20) ** 2)) * (np.abs(depth - 2006) < 3)
    wall = hb.reconstruct(hb.Caliper(depth, toolface, 0.5 * BIT + slot), bit_diameter=BIT)
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, "#md=2006&sec=12", (1366, 768), drawn=False)
        screen.keyboard.press("n")
        screen.settle()
        said = screen.evaluate("[...document.getElementById('turn').children].map((e) => e.textContent)")
        assert abs(int(said[said.index("Toolface") + 1].removesuffix("°")) - 187) <= 2
        screen.close()


def test_bit_size_is_in_the_middle_of_the_colours_in_light_and_dark(browser: Any) -> None:
    wall = MadeWall(20_000)
    wall.radius[:] = BIT / 2
    wall.radius[wall.depth > 1015] += 0.003
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, "#md=1010&sec=20")
        middles = []
        for theme in ("light", "dark"):
            screen.evaluate(f"window.__wall.app.view.choose({{ theme: '{theme}' }})")
            screen.settle()
            image = screen.pixels("image")[..., :3].astype(int)
            middles.append(image[len(image) // 4, 40])
            wide = image[-10, 40]
            assert wide[0] - wide[2] > 40, "over bit is orange"
        assert abs(middles[0] - [0xF4, 0xF3, 0xF0]).max() <= 3
        assert abs(middles[1] - [0x1F, 0x28, 0x30]).max() <= 3
        screen.close()


@pytest.mark.parametrize(("theme", "page"), [("light", 0xF5), ("dark", 0x18)])
def test_the_straightened_hole_stands_off_the_page_and_trouble_keeps_its_colour(
    browser: Any, theme: str, page: int
) -> None:
    wall = MadeWall(20_000)
    wall.radius[:] = BIT / 2
    wall.radius[wall.depth > 1015] += 0.003
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, f"#md=1010&sec=20&theme={theme}", (1366, 700))
        screen.settle()
        image, hole = (screen.pixels(name)[..., :3].astype(float) for name in ("image", "wall"))
        middle, bit = hole.shape[1] // 2, int(0.2 * hole.shape[1])
        gauge = hole[len(hole) // 4, middle - bit + 3 : middle + bit - 3]
        assert np.ptp(gauge, axis=1).max() < 35, "gauge hole is pale"
        tint, neutral = gauge.mean(axis=0), image[len(image) // 4, 40]
        assert abs(tint / tint.max() - neutral / neutral.max()).max() < 0.15, (
            "in the hue of the middle of the colour bar"
        )
        apart = abs(gauge.mean(axis=1) - page)
        assert apart[: bit // 4].min() > 20, "its edge"
        assert apart[bit:].min() > 20, "the half that is cut open"
        same = image[-10, 40]
        for place in (middle - bit // 2, middle + bit // 2):
            wide = hole[-10, place]
            ratios = wide / wide.max() - same / same.max()
            assert abs(ratios).max() < 0.08, "the hue of the colour bar"
            assert 0.85 < wide.max() / same.max() <= 1.01
        screen.close()


def test_what_goes_straight_around_the_hole_is_level_from_afar(browser: Any) -> None:
    wall = MadeWall(64 * 10 * 2000, start=1000.0)
    wall.radius[:] = BIT / 2
    wall.radius[(wall.depth > 2000) & (wall.depth < 2016)] += 0.02
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, "#md=2000&sec=1990")
        screen.settle()
        assert screen.evaluate("window.__wall.app.renderer.look().imagePieces.every(({ tile }) => tile.level.rings)")
        image = screen.pixels("image")[2:-2, 2:-2, :3].astype(int)
        washed = image[..., 0] - image[..., 2] > 40
        tops = np.argmax(washed, axis=0)
        assert washed.any(axis=0).all()
        assert np.ptp(tops) == 0, "its top is at one height all around"
        screen.close()


def test_from_outside_a_wall_is_seen_through_only_where_it_is_in_doubt(browser: Any) -> None:
    wall = MadeWall(12_800)
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, "#md=1005&sec=5&camera=outside", (1000, 700))
        screen.settle()
        views = []
        for millimetres in (0.5, 2, 8):
            sigma = np.full(len(wall), millimetres / 1000 / NORMAL_95)
            viewer.scene.set_trust(np.zeros(len(wall), bool), sigma)
            level = round(2 * np.log2(4 * millimetres))
            screen.until(f"window.__wall.app.store.vertex(3200)?.state >> 12 === {level}")
            screen.settle()
            views.append((screen.pixels("wall")[..., :3] == screen.pixels("wall")[100, 5, :3]).all(axis=-1))
        screen.close()
    sure, fair, unsure = views
    assert 0 < sure.mean() < 1
    np.testing.assert_array_equal(fair, sure)
    holes = unsure & ~sure
    assert holes.sum() > 0.05 * (~sure).sum()
    for dx, dy in ((0, 1), (1, 0), (1, 1), (1, -1)):
        assert not (holes & np.roll(holes, (dy, dx), (0, 1))).any(), "lines"


def test_what_lies_between_arms_is_hatched_and_not_counted_as_measured(browser: Any) -> None:
    depth = np.repeat(np.arange(2000.0, 2030.0, 0.05), 4)
    arm = np.tile([0, 1, 2, 3], depth.size // 4)
    radius = BIT / 2 + 0.02 + 0.0002 * (arm % 2)
    caliper = hb.Caliper(depth, (depth * 12 + arm * 90) % 360, radius, arm=arm)
    wall = hb.reconstruct(caliper, bit_diameter=BIT)
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, "#md=2015&sec=10&at=2015_45", (1366, 700))
        screen.until("window.__wall.app.store.vertex(9608)?.state & 0x800")
        screen.settle()
        screen.until("window.__wall.app.figures.summary")
        assert "interpolated" in ink_texts(screen)
        k = screen.evaluate("window.__wall.app.renderer.vertex.k")
        assert wall.angular_gap[k] > 60
        assert screen.readout()["Samples used"] == "8 (interpolated)"
        assert f"{100 * wall.summary(2010, 2020).coverage:.1f} %" in screen.inner_text("#section")
        row = slice(9600 - 9600 % 64, 9600 - 9600 % 64 + 64)
        share = int(100 * (wall.angular_gap[row] <= 60).mean() + 0.5)
        assert f"{share}\u00a0% of the turn" in screen.inner_text("#turn")
        image = screen.pixels("image")[..., :3].astype(int)
        full = image[..., 0] - image[..., 2] > 100  # the orange of 20 mm over bit, not faded
        assert full.mean() == pytest.approx((wall.angular_gap <= 60).mean(), abs=0.05)
        grey = abs(image - image[..., :1]).max(axis=-1) <= 2
        assert 0.03 < grey.mean() < 0.2, "sparse lines"
        screen.close()


# Pixels of the cross-section in about this colour.
ALIKE = """(colour) => {
  const { width, height } = document.getElementById('polar');
  const { data } = document.getElementById('polar').getContext('2d').getImageData(0, 0, width, height);
  let count = 0;
  for (let i = 0; i < data.length; i += 4) if (colour.every((value, c) => Math.abs(data[i + c] - value) < 8)) count++;
  return count;
}"""


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("over", [0.02, -0.02])
def test_the_cross_section_has_the_colour_of_the_image(browser: Any, theme: str, over: float) -> None:
    depth = np.arange(2000.0, 2030.0, 0.0025)
    wall = hb.reconstruct(hb.Caliper(depth, depth * 3600 % 360, np.full(depth.size, BIT / 2 + over)), bit_diameter=BIT)
    with hb.view(wall) as viewer:
        screen = Screen(browser, viewer.url, f"#md=2015&sec=10&theme={theme}", (1366, 768))
        screen.settle()
        image = screen.pixels("image")
        colour = image[len(image) // 2, 100, :3].tolist()
        assert (colour[0] > colour[2] + 50) if over > 0 else (colour[2] > colour[0] + 50)
        ring = np.pi * 64**2 * abs((BIT / 2 + over) ** 2 - (BIT / 2) ** 2) / 0.15**2  # 150 mm are 64 pixels
        assert screen.evaluate(ALIKE, colour) == pytest.approx(ring, rel=0.25)  # less its outlines
        screen.close()


def test_the_cross_section_has_a_band_that_encloses_95_percent(browser: Any) -> None:
    random = np.random.default_rng(12)
    depth = np.sort(random.uniform(2000.0, 2020.0, 20_000))
    radius = BIT / 2 + random.normal(0, 0.002, depth.size)
    wall = hb.reconstruct(hb.Caliper(depth, random.uniform(0, 360, depth.size), radius), bit_diameter=BIT)
    sigma = on_quads(wall.sigma, wall.settings.sectors)
    for came_with_it in (False, True):
        if came_with_it:
            wall.attributes["sigma"] = sigma
        with hb.view(wall) as viewer:
            screen = Screen(browser, viewer.url, "#md=2010&sec=10&at=2010_100", drawn=False)
            screen.evaluate("Object.assign(window.__wall.app.view, { shape: 10 })")
            screen.evaluate("window.__wall.app.redraw()")
            screen.settle()
            text = screen.inner_text("#turn")
            band = screen.evaluate(COLOURED)
            k = screen.evaluate("window.__wall.app.store.levels[0].turnAt(2010)")
            read = screen.readout()
            screen.close()
        mean = 1.96e3 * np.nanmean(sigma[k : k + wall.settings.sectors])
        shown = float(re.search(r"Radius, 95 %\n± ([\d.]+) mm", text)[1])
        assert shown == pytest.approx(mean, abs=0.05 if came_with_it else 0.1 * mean)  # else in sixteen steps
        assert mean > 0.5
        assert band > 500
        half = float(read["Radius, 95 %"].removeprefix("± ").removesuffix(" mm"))
        if came_with_it:
            assert half == pytest.approx(1.96e3 * float(read["sigma"].replace("−", "-")), abs=0.06)


@pytest.mark.parametrize("pitch", [0.4, -0.4])
def test_a_vertex_is_seen_around_its_place_and_an_attribute_on_its_quad(browser: Any, pitch: float) -> None:
    wall = MadeWall(16 * 100, sectors=16, pitch=pitch)
    wall.radius[:] = 0.108
    k = 16 * 40 + 7
    wall.radius[k] += 0.03
    column = np.where(np.arange(len(wall)) == k, 100.0, 0.0)
    depth, toolface = wall.depth[k], wall.toolface[k]
    address = f"#md={depth}&sec=4&beside=GR&at={depth - 0.2 * pitch}_{toolface - 6}"
    with hb.view(wall, attributes={hb.viewer.Attribute("GR", "gAPI", 0, 100): column}) as viewer:
        screen = Screen(browser, viewer.url, address, (1366, 700))
        screen.evaluate("window.__wall.app.selection.setColours({ low: 0, high: 0.03 })")
        screen.settle()
        places = []
        for name in ("image", "beside0"):
            pixels = screen.pixels(name)[2:-2, 2:-2, :3].astype(int)
            usual = np.median(pixels, axis=(0, 1))
            y, x = np.nonzero(np.abs(pixels - usual).max(axis=-1) > 60)
            share = (y.mean() + 2.5) / (len(pixels) + 4), (x.mean() + 2.5) / (pixels.shape[1] + 4)
            places.append((depth - 2 + 4 * share[0], 360 * share[1]))
        middle = (depth + 0.5 * pitch * (1 + 1 / 16), toolface + 0.5 * 22.5)
        for place, wanted in zip(places, ((depth, toolface), middle), strict=True):
            assert place[0] == pytest.approx(wanted[0], abs=0.05 * abs(pitch))
            assert place[1] == pytest.approx(wanted[1], abs=0.05 * 22.5)
        assert screen.readout()["Radius"] == "138.00 mm", "it is the vertex whose colour is under the cursor"
        screen.evaluate("window.__wall.app.view.choose({ camera: 'outside' })")
        screen.settle()
        pixels = screen.pixels("wall")[..., :3].astype(int)
        y, x = np.nonzero(pixels[..., 0] > 1.5 * pixels[..., 2])  # the vertex is brown, the others blue
        at = len(y) // 2
        top = "document.getElementById('orbit').offsetTop"
        screen.evaluate(f"window.__wall.app.renderer.pickAt({x[at]}, {y[at]} - {top}, true)")
        cursor = screen.evaluate("window.__wall.app.view.cursor")
        assert (cursor["depth"], cursor["toolface"]) == pytest.approx((depth, toolface)), "in 3-D the cursor is on it"
        screen.close()


@pytest.mark.parametrize("length", [4, 400], ids=["tiles", "overview"])
def test_an_image_is_drawn_where_the_wall_has_no_radius(browser: Any, length: int) -> None:
    wall = MadeWall(64 * 2000)
    wall.radius[(wall.depth > 1050) & (wall.depth < 1100)] = np.nan
    column = np.where(wall.depth > 1090, np.nan, gamma(wall.depth, wall.toolface))
    with hb.view(wall, attributes={hb.viewer.Attribute("GR", "gAPI", 20, 140): column}) as viewer:
        screen = Screen(browser, viewer.url, f"#md=1075&sec={length}&quantity=GR&beside=over&at=1075_90", (1366, 700))
        screen.settle()
        values = screen.readout()
        assert values["Radius"] == "no data"
        k = screen.evaluate("window.__wall.app.store.levels[0].quadAt(1075, 90)")
        assert values["GR"] == f"{column[k]:.5g} gAPI"
        rect = screen.evaluate("window.__wall.app.renderer.rects.image")

        def grey(name: str, top: float, bottom: float) -> float:
            """The share of grey pixels between two depths."""
            y = [int((depth - 1075 + length / 2) / length * rect["height"]) for depth in (top, bottom)]
            found = screen.pixels(name)[y[0] + 1 : y[1] - 1, 2:-2, :3].astype(int)
            assert found.size
            return float((np.ptp(found, axis=-1) == 0).mean())

        seen = (1060, 1088) if length > 50 else (1073.5, 1076.5)
        assert grey("image", *seen) == 0
        assert grey("beside0", *seen) == 1
        if length > 50:
            assert grey("image", 1092, 1098) == 1, "the image has no value there either"
        screen.close()

"""Pictures on paper: the structure of the figures, what is written on them, and errors."""

from __future__ import annotations

import io
import math
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden
from hypothesis import given
from hypothesis import strategies as st
from locations import WEB
from matplotlib.image import imsave
from plotted_wall import BIT, image_of, plotted_wall

import helibore as hb
from helibore import plot
from helibore.base.colors import FILL_COLORS
from helibore.logs.curves import ScalarCurve, nice_limits
from helibore.logs.turn_logs import NO_UNCERTAINTY
from helibore.plot.content import REFERENCES, Drawing, content_of
from helibore.plot.cross_sections import sections_at, telling_depths
from helibore.plot.depth_scales import FEET, Lines, usual_depth_scale
from helibore.plot.diameters import Diameters, diameters, thinned
from helibore.plot.hatching import HATCH, HATCH_BYTES, LINE, NO_DATA, NO_DATA_LINE, PALE, PALENESS, hatch
from helibore.plot.html_report import page
from helibore.plot.interval_tracks import tops_across
from helibore.plot.log import MARGIN, _divided
from helibore.plot.paper import MM, Sheet
from helibore.plot.print_header import SIDES_TEXT, facts, header_height, header_rows, sentence, shifts
from helibore.plot.shading import View, shade
from helibore.plot.solid import Stretched, exaggeration, most_relief, turns_between
from helibore.plot.tracks import HEAD, CaliperTrack, DepthTrack, ImageTrack, Stretch
from helibore.simulation.hole import Breakout, Washout
from helibore.simulation.tool import Hole, Tool, simulate
from helibore.wall.interpolation import on_quads


@pytest.fixture(scope="module")
def wall() -> hb.Wall:
    return plotted_wall()


def texts(figure: Any) -> list[Any]:
    """Every visible text with a word in it."""
    found = figure.findobj(lambda artist: hasattr(artist, "get_text"))
    return [text for text in found if text.get_text().strip() and text.get_visible()]


def assert_readable(figure: Any) -> None:
    """No text leaves the page, and none touches another."""
    figure.draw_without_rendering()
    shown = [(text.get_text(), text.get_window_extent()) for text in texts(figure)]
    page = figure.bbox
    for label, box in shown:
        assert box.x0 >= page.x0, label
        assert box.x1 <= page.x1, label
        assert box.y0 >= page.y0, label
        assert box.y1 <= page.y1, label
    for (one, first), (two, second) in combinations(shown, 2):
        apart = first.x1 <= second.x0 or second.x1 <= first.x0 or first.y1 <= second.y0 or second.y1 <= first.y0
        assert apart, (one, two)


def measured(wall: hb.Wall) -> Diameters:
    zones = wall.zones()
    return diameters(wall, zones.logs)


def tracks_of(figure: Any) -> list[Any]:
    """The axes of the tracks: those whose depth grows downwards over many metres."""
    return [axes for axes in figure.axes if axes.get_ylim()[0] > 1000 > 400 and axes.get_xlim()[0] >= 0]


def test_a_log_says_all_that_a_reader_must_know(wall: hb.Wall) -> None:
    figure = plot.log(wall, title="A well", subtitle="A run", dpi=60)
    words = " | ".join(text.get_text() for text in texts(figure))
    for needed in (
        "A well", "A run", "2,000.00 to 2,022.00 m MD (22.0 m)", "8.504 in (216.0 mm)", "1:40, 25 mm on paper a metre",
        "from the high side, clockwise looking downhole", "radius measured by an azimuthal caliper",
        "Caliper [mm]", "bit size 216.0 mm", "by area", "under bit", "bit to C2", "C2 to C1", "C1", "C2",
        "Over bit radius [mm]", "GR [gAPI]", "RES [ohm.m]", "logarithmic", "16 sectors, static", "Depth", "MD [m]",
        "missing: no value, or not sampled there", "Cross sections, looking downhole", "tube × ", "shape × ",
        "coloured by radius", "rings each",
    ):  # fmt: skip
        assert needed in words, needed
    assert "A   2,0" in words
    assert_readable(figure)


def test_what_lies_between_arms_is_hatched_and_named() -> None:
    depth = np.repeat(np.arange(2000, 2006, 0.05), 4)
    arm = np.tile([0, 1, 0, 1], depth.size // 4)
    toolface = (np.tile([0, 90, 180, 270], depth.size // 4) + 2 * depth) % 360
    radius = 0.108 + 0.004 * np.cos(np.radians(2 * toolface))
    wall = hb.reconstruct(hb.Caliper(depth, toolface, radius, arm=arm), bit_diameter=BIT)
    figure = plot.log(wall, dpi=100, polar=(2003.0,), body=())
    words = [text.get_text() for text in texts(figure)]
    measured = wall.summary().coverage
    assert f"{100 * measured:.2f} % of the turns; the rest is interpolated between arms" in words
    assert "interpolated between arms" in words
    assert "radius measured by the arms of a caliper" in words
    assert words.count(sentence(NO_UNCERTAINTY)) == 1
    assert_readable(figure)
    for dpi in (50, 70, 150):  # letters stand wider where dots are few; the key's boxes take 5.2 mm
        foot = {text.get_text(): text for text in plot.log(wall, dpi=dpi, polar=(), body=()).texts}
        ends = foot["missing: no value, or not sampled there."].get_window_extent().x1
        assert foot["interpolated between arms"].get_window_extent().x0 - ends > 5.2 / 25.4 * dpi
    for reference in REFERENCES:
        second = plot.pages(wall, (210.0, 120.0), scale=40, polar=(), body=(), reference=reference)[1]
        assert_readable(second)
        foot = {text.get_text(): text.get_window_extent() for text in second.texts}
        made = next(place for text, place in foot.items() if text.startswith("helibore"))
        assert foot[SIDES_TEXT[reference]].y0 > made.y1  # not shortened, and on a line of its own
    (section,) = sections_at(wall, [2003.0], (wall.angular_gap > 60.0).astype(float))
    gap = wall.angular_gap[30 * 64 - 32 : 31 * 64 - 32]  # the turn around 2003 m
    assert np.count_nonzero(section.interpolated) == pytest.approx(np.count_nonzero(gap > 60), abs=2)
    assert f"rings each 50 mm; {100 * section.interpolated.mean():.0f} % interpolated" in words
    pixels = tracks_of(figure)[-1].images[0].get_array()
    dark = (pixels == np.array(HATCH_BYTES)).all(axis=2)
    width = max(round(LINE / 25.4 * 100), 1) / round(HATCH / 25.4 * 100)
    assert dark.mean() == pytest.approx((1 - measured) * width, rel=0.15)
    assert (dark.mean(axis=0) > 0).mean() > 0.8
    beside_a_gap = [text.get_text() for text in texts(plot.log(plotted_wall(), dpi=50, body=()))]
    assert "interpolated" in beside_a_gap
    assert "interpolated between arms" not in beside_a_gap


def test_a_gap_along_the_hole_of_a_tool_with_a_full_turn_of_sensors_is_not_between_arms() -> None:
    depth = np.repeat(np.concatenate([np.arange(2000, 2003, 0.05), np.arange(2004.6, 2008, 0.05)]), 32)
    arm = np.tile(np.arange(32) % 16, depth.size // 32)
    caliper = hb.Caliper(depth, np.tile(np.arange(32) * 11.25, depth.size // 32), np.full(depth.size, 0.108), arm=arm)
    wall = hb.reconstruct(caliper, bit_diameter=BIT)
    words = [text.get_text() for text in texts(plot.log(wall, dpi=50, polar=(), body=()))]
    assert f"{100 * wall.summary().coverage:.2f} % of the turns; the rest is interpolated" in words
    assert "interpolated" in words


@pytest.mark.parametrize("basis", ["average", "gauge"])
def test_a_wall_that_was_not_measured_around_says_so(basis: str) -> None:
    depth = np.arange(1000.0, 1030.0, 0.2)
    caliper = (
        hb.Caliper.gauge(1000.0, 1030.0, BIT)
        if basis == "gauge"
        else hb.Caliper.from_average(depth, 0.22 + 0.002 * np.sin(depth))
    )
    wall = hb.reconstruct(caliper, bit_diameter=BIT, sectors=16)
    wall.images["GR"] = image_of(depth, np.add.outer(depth - 900, np.arange(8.0)))
    figure = plot.log(wall, dpi=50)
    words = [text.get_text() for text in texts(figure)]
    (said,) = [text for text in texts(figure) if text.get_text() == wall.basis_text]
    assert said.get_color() == "#b3261e"
    assert not [word for word in words if word.startswith(("Radius", "Cross", "least"))]
    assert ("Caliper [mm]" in words) == (basis == "average")
    assert ("Samples" in words) == (basis == "average"), "those of a gauge hole are no measurements"
    assert_readable(figure)


def test_a_picture_claims_no_reference_that_nothing_states(golden: Golden) -> None:
    toolface = np.arange(0.0, 360.0 * 200, 15.0)
    caliper = hb.Caliper(1000.0 + toolface / 7200.0, toolface, 0.11 + 0.002 * np.cos(np.radians(2 * toolface)))
    wall = hb.reconstruct(caliper, bit_diameter=BIT, sectors=16)
    figure = plot.log(wall, dpi=60)
    words = [text.get_text() for text in texts(figure)]
    assert "as the samples count it; no path states what 0 is" in words
    assert {"0°", "90°", "180°", "270°"} <= set(words)
    assert not {"U", "L", "N", "S"} & set(words)
    assert_readable(figure)
    named = [text.get_text() for text in texts(plot.log(wall, dpi=60, reference="north", body=()))]
    assert {"N", "E", "S", "W"} <= set(named)
    wall.images["GR"] = image_of(np.arange(1000.0, 1010.0, 0.5), np.arange(160.0).reshape(20, 8))
    assert {"U", "R", "D", "L"} <= {text.get_text() for text in texts(plot.log(wall, dpi=60, body=()))}
    with golden.raises():
        plot.log(wall, reference="")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("curves", "names"),
    [((), []), (("C1", "C2"), ["c1", "c2"]), (("D0", "D90"), ["d0", "d90"]), (("C1", "C2", "D0", "D90"), None)],
)
def test_the_caliper_track_draws_the_pairs_that_are_asked_for(
    wall: hb.Wall, curves: tuple[str, ...], names: list[str] | None
) -> None:
    names = ["c1", "c2", "d0", "d90"] if names is None else names
    figure = plot.log(wall, curves=curves, unit="mm", dpi=150, polar=(), body=())
    axes = tracks_of(figure)[1]
    turns = measured(wall)
    lines = [line for line in axes.lines if len(line.get_xdata()) == turns.depth.size]
    assert len(lines) == len(names) + 2
    for name, line in zip(["least", *names, "area"], lines, strict=True):
        np.testing.assert_array_equal(line.get_xdata(), getattr(turns, name) / 0.001)
        np.testing.assert_array_equal(line.get_ydata(), turns.depth)
    words = [text.get_text() for text in texts(figure)]
    named = {"C1": "C1", "C2": "C2", "D0": "U–D", "D90": "R–L"}
    assert [name for name in named if named[name] in words] == list(curves)
    assert_readable(figure)


def test_the_head_of_a_curve_has_its_unit_once(wall: hb.Wall) -> None:
    curve = ScalarCurve("GR_gAPI", "gAPI", np.array([2000.0, 2012.0]), np.array([20.0, 90.0]))
    words = [text.get_text() for text in texts(plot.log(wall, scalars=[curve], polar=(), body=(), dpi=40))]
    assert "GR [gAPI]" in words
    assert "GR_gAPI [gAPI]" not in words


def test_an_overview_has_the_tracks_of_a_log_and_a_body_beside_them(wall: hb.Wall) -> None:
    figure = plot.overview(wall, title="A well", scale=200, dpi=60)
    assert_readable(figure)
    words = " | ".join(text.get_text() for text in texts(figure))
    for needed in (
        "A well",
        "Caliper [mm]",
        "GR [gAPI]",
        "RES [ohm.m]",
        "tube × ",
        "shape × ",
        "coloured by ",
        "MD [m]",
    ):
        assert needed in words, needed
    assert "Cross sections" not in words
    height = figure.get_size_inches()[1] * MM
    tracks = [axes for axes in figure.axes if axes.get_ylim() == (wall.depth[-1], 2000.0)]
    assert len(tracks) == 5
    for axes in tracks:
        assert axes.get_position().height * height == pytest.approx((wall.depth[-1] - 2000) * 5)
    body = figure.axes[-1].get_position()
    assert all(axes.get_position().x1 < body.x0 for axes in tracks)
    plain = plot.overview(wall, body=(), dpi=60)
    assert plain.get_size_inches()[0] < figure.get_size_inches()[0]


def test_the_lines_to_a_body_beyond_the_interval_stay_beside_the_tracks(wall: hb.Wall) -> None:
    from matplotlib.lines import Line2D

    figure = plot.overview(wall, start=2000, stop=2005, body=(2010, 2014), scale=40, dpi=40)
    tracks = next(axes for axes in figure.axes if axes.get_ylim() == (2005, 2000)).get_position()
    ties = [line for line in figure.findobj(Line2D) if line in figure.artists and line.get_color() == "#5d6b77"]
    assert [line.get_ydata()[0] for line in ties] == pytest.approx([tracks.y0] * 2)


@pytest.mark.parametrize("scale", [200, 500])
def test_the_paper_has_the_scale_it_says(wall: hb.Wall, scale: int) -> None:
    figure = plot.log(wall, scale=scale, start=2002, stop=2020, dpi=60, polar=(), body=())
    height = figure.get_size_inches()[1] * MM
    tracks = [axes for axes in figure.axes if axes.get_ylim() == (2020, 2002)]
    assert len(tracks) == 5
    for axes in tracks:
        box = axes.get_position()
        assert box.height * height == pytest.approx(18 * 1000 / scale, abs=1e-6)
        assert axes.get_shared_y_axes().joined(axes, tracks[0])
        assert box.y1 == pytest.approx(tracks[0].get_position().y1, abs=1e-12)
    for ending, size in ((".pdf", 72.0), (".svg", 72.0)):
        points = plot.rendered([figure], ending)[:4000].decode("latin-1")
        assert f"{height / MM * size:.5f}".rstrip("0")[:8] in points or f"{height / MM * size:g}" in points


def test_pages_cover_the_interval_once_at_one_scale(wall: hb.Wall) -> None:
    figures = plot.pages(wall, paper=(210, 200), scale=40, dpi=50, polar=(), body=())
    ends = []
    for number, figure in enumerate(figures, 1):
        width, height = figure.get_size_inches() * MM
        assert (width, height) == (pytest.approx(210), pytest.approx(200))
        (bottom, top) = figure.axes[-1].get_ylim()
        assert figure.axes[-1].get_position().height * height == pytest.approx((bottom - top) * 25)
        assert [text for text in texts(figure) if text.get_text().endswith(f"page {number} of {len(figures)}")]
        ends.append((top, bottom))
        assert_readable(figure)
    assert len(figures) > 3
    assert (ends[0][0], ends[-1][1]) == (pytest.approx(2000.0), pytest.approx(wall.depth[-1]))
    assert [end for _, end in ends[:-1]] == [start for start, _ in ends[1:]]
    assert [end for _, end in ends[:-1]] == [round(end) for _, end in ends[:-1]]  # at a line with a number


@pytest.mark.parametrize(
    "paper",
    [
        "letter",
        (210.0, 60.0),
        (210.0, -60.0),
        (math.nan, 297.0),
    ],
)
def test_paper_without_room_for_the_tracks_is_refused(wall: hb.Wall, paper: Any, golden: Golden) -> None:
    with golden.raises():
        plot.pages(wall, paper, dpi=40, polar=(), body=())


def test_a_gap_is_grey_in_every_track(wall: hb.Wall) -> None:
    figure = plot.log(wall, dpi=60, polar=(), body=())
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())[..., :3]
    tracks = [axes for axes in figure.axes if axes.get_ylim()[0] > axes.get_ylim()[1]]
    assert len(tracks) == 5
    grey = []
    for axes, depth in ((tracks[1], 2014.15), (tracks[2], 2014.15), (tracks[3], 2005.15)):
        right, up = axes.transData.transform((np.mean(axes.get_xlim()) + 0.02 * np.ptp(axes.get_xlim()), depth))
        grey.append(tuple(pixels[int(pixels.shape[0] - up), int(right) + 2]))
    assert set(grey) <= {NO_DATA, NO_DATA_LINE}, grey


def test_diameters_against_a_loop(wall: hb.Wall) -> None:
    turns = measured(wall)
    K, radius = wall.settings.sectors, wall.radius
    for turn in range(turns.depth.size):
        one = radius[turn * K : (turn + 1) * K]
        across = [one[j] + one[(j + K // 2) % K] for j in range(K)]
        there = [size for size in across if not math.isnan(size)]
        assert turns.least[turn] == pytest.approx(min(there, default=np.nan), nan_ok=True)
        assert turns.greatest[turn] == pytest.approx(max(there, default=np.nan), nan_ok=True)
        if there and len(there) == K:
            assert turns.c1[turn] == max(across)
            widest = across.index(max(across))
            assert turns.c2[turn] in (across[(widest + K // 4) % K], across[(widest - K // 4) % K])
            assert (turns.d0[turn], turns.d90[turn]) == (across[0], across[K // 4])
        else:
            assert np.isnan([turns.c1[turn], turns.c2[turn], turns.d0[turn], turns.d90[turn]]).all()
    few = thinned(turns, 2001.0, 2021.0, 17)
    assert few.depth.size == 17
    inside = (turns.depth >= 2001) & (turns.depth <= 2021)
    assert np.nanmax(few.greatest) == np.nanmax(turns.greatest[inside])
    assert np.nanmin(few.least) == np.nanmin(turns.least[inside])


def test_a_turn_without_a_diameter_of_every_arm_is_neither_the_most_oval_nor_the_usual_one() -> None:
    area = np.array([0.20, 0.20, 0.30, 0.20, 0.21, 0.10])
    oval = np.array([np.nan, 0.01, 0.01, 0.09, 0.01, 0.01])
    columns = dict.fromkeys(("c1", "c2", "d0", "d90"), area)
    turns = Diameters(depth=10.0 * np.arange(6), area=area, least=area, greatest=area + oval, coverage=area, **columns)
    assert telling_depths(turns, 0.0, 60.0) == [10.0, 20.0, 30.0, 50.0]


def test_sections_stand_in_the_worst_zone_of_each_kind_and_in_a_usual_turn() -> None:
    """Here the largest turn is in the washout and the most oval one in no zone, as at an open fracture."""
    breakouts = (Breakout(2005.0, 2005.25, 60.0, 60.0, 0.040), Breakout(2010.0, 2014.0, 60.0, 60.0, 0.020))
    hole = Hole(start=2000.0, stop=2030.0, breakouts=breakouts, washouts=(Washout(2020.0, 2023.0, 0.025),))
    run = simulate(hole, Tool(), samples=60_000)
    wall = hb.reconstruct(hb.Caliper(run.depth, run.toolface, run.radius), bit_diameter=BIT, sectors=32)
    zones = wall.zones().zones
    assert {zone.kind for zone in zones} == {"washout", "breakout"}
    content = content_of(wall, Drawing())
    depths = [section.depth for section in content.sections]
    for zone in zones:
        assert any(zone.start <= depth <= zone.stop for depth in depths)
    assert any(all(not zone.start <= depth <= zone.stop for zone in zones) for depth in depths)
    assert len(depths) <= 4


def test_a_caliper_track_is_grey_over_the_turns_without_a_radius_and_beyond_the_wall() -> None:
    depth = 0.05 + 0.1 * np.arange(10)
    columns = dict.fromkeys(("area", "c1", "c2", "d0", "d90", "least", "greatest"), np.full(10, BIT))
    turns = Diameters(depth=depth, coverage=(np.arange(10) != 4).astype(float), **columns)
    track = CaliperTrack(turns, "azimuthal", BIT, "mm", (200.0, 230.0))
    stretch = Stretch(-0.2, 1.2, 0.0, 140.0, Lines.of(10))
    (image,) = track.draw(Sheet(50, 140, 254), 0.0, stretch).images
    pixels = image.get_array()
    shown = pixels[..., 3] > 0
    assert (shown == shown[:, :1]).all()
    middle = -0.2 + 1.4 * (np.arange(shown.shape[0]) + 0.5) / shown.shape[0]
    grey = (middle < 0) | ((middle > 0.4) & (middle < 0.5)) | (middle > 1)
    np.testing.assert_array_equal(shown[:, 0], grey)
    assert {tuple(one) for one in np.unique(pixels[grey][..., :3].reshape(-1, 3), axis=0)} == {NO_DATA, NO_DATA_LINE}


def test_diameters_beyond_the_scale_of_the_caliper_are_written_at_its_edge() -> None:
    """Of the values within two lines of text, the farthest is written, at its depth."""
    depth = 0.05 + 0.1 * np.arange(100)
    columns = {name: np.full(100, BIT) for name in ("area", "c1", "c2", "d0", "d90", "least", "greatest")}
    columns["c1"][[20, 21, 60]] = 0.294, 0.299, 0.2649
    columns["least"][40] = 0.1955
    turns = Diameters(depth=depth, coverage=np.ones(100), **columns)
    for unit, limits, texts_at in (
        ("mm", (200.0, 260.0), [("← 196", 4.05), ("299 →", 2.15), ("265 →", 6.05)]),
        ("in", (8.0, 10.0), [("← 7.7", 4.05), ("11.8 →", 2.15), ("10.4 →", 6.05)]),
        ("mm", (190.0, 300.0), []),
    ):
        track = CaliperTrack(turns, "azimuthal", BIT, unit, limits, ("C1", "C2"))
        axes = track.draw(Sheet(50, 140, 254), 0.0, Stretch(0.0, 10.0, 0.0, 140.0, Lines.of(10)))
        found = [(text.get_text(), round(text.get_position()[1], 3)) for text in axes.texts]
        assert found == texts_at
        assert [text.get_position()[0] for text in axes.texts] == [limits["→" in text] for text, _ in texts_at]
    without = CaliperTrack(turns, "azimuthal", BIT, "mm", (200.0, 260.0)).draw(
        Sheet(50, 140, 254), 0.0, Stretch(0.0, 10.0, 0.0, 140.0, Lines.of(10))
    )
    assert [text.get_text() for text in without.texts] == ["← 196"], "C1 is not drawn"


def test_the_line_of_a_top_does_not_strike_through_a_depth_number() -> None:
    axes = DepthTrack(20).draw(Sheet(50, 140, 254), 0.0, Stretch(1003.5, 1007.5, 0.0, 140.0, Lines.of(20)))
    tops_across(axes, [hb.Interval("Brae Fm", 1003.5, 1006.0)], Stretch(1003.5, 1007.5, 0.0, 140.0, Lines.of(20)))
    (top,) = [line for line in axes.lines if list(line.get_ydata()) == [1006.0, 1006.0]]
    (number,) = [text for text in axes.texts if text.get_text() == "1006.0"]
    assert number.get_zorder() > top.get_zorder()
    ground = number.get_bbox_patch()
    assert ground is not None
    assert ground.get_facecolor() == (1.0, 1.0, 1.0, 1.0)


def test_what_is_not_measured_is_hatched_as_on_the_page() -> None:
    """Lines over no data rise and are dense; those over interpolated values fall, are sparse, over a faded colour."""
    sheet = Sheet(30, 30, 96)
    orange = np.full((60, 60, 3), (176, 74, 12), np.uint8)
    rows, columns = np.mgrid[:60, :60]
    left, right = columns < 20, columns >= 40
    shown = hatch(sheet, orange, left, right)
    assert (shown[:, 20:40] == orange[:, 20:40]).all()
    for side, line, across, apart in (
        (left, HATCH_BYTES, rows - columns, 10),
        (right, NO_DATA_LINE, rows + columns, 7),
    ):
        lines = (shown == line).all(axis=2) & side
        assert lines[side].mean() == pytest.approx(2 / apart, rel=0.1)
        assert len(set((across[lines] % apart).tolist())) == 2, "as far apart as the page's, in one direction"
    between = shown[left & ~(shown == HATCH_BYTES).all(axis=2)]
    assert (between == np.round(0.45 * np.array([176, 74, 12]) + 0.55 * 245)).all()
    shaders = (WEB / "src" / "shaders.js").read_text()
    light = "dark ? (line ? vec3(0.36) : vec3(0.24)) : (line ? vec3(0.62) : vec3(0.80))"
    assert light in shaders
    assert [round(255 * one) for one in (0.62, 0.8, 0.55, 0.96)] == [NO_DATA_LINE[0], NO_DATA[0], HATCH_BYTES[0], PALE]
    for rule in ("gl_FragCoord.x - gl_FragCoord.y, 7.0) < 1.6", "gl_FragCoord.x + gl_FragCoord.y, 10.0) < 1.3"):
        assert rule in shaders
    assert f"vec3(0.96), between ? {PALENESS}" in shaders


def test_sections_are_the_vertices_nearest_to_the_depth(wall: hb.Wall, golden: Golden) -> None:
    (section,) = sections_at(wall, [2003.14])
    K = wall.settings.sectors
    for j in range(K):
        column = slice(j, None, K)
        nearest = np.argmin(np.abs(wall.depth[column] - 2003.14))
        assert section.radius[j] == wall.radius[column][nearest]
    samples = wall.samples
    assert section.sample_radius.size == np.count_nonzero(np.abs(samples.depth - 2003.14) <= 0.05) > 0
    with golden.raises():
        sections_at(wall, [5.0])


def test_scales_lines_and_limits() -> None:
    assert [usual_depth_scale(length) for length in (3.0, 20.0, 40.0, 41.0, 200.0, 201.0, 9000.0)] == [
        20, 20, 40, 200, 200, 500, 500,
    ]  # fmt: skip
    assert Lines.of(200) == Lines(1.0, 5.0)
    assert Lines.of(500) == Lines(2.0, 10.0)
    lines = Lines.of(200)
    assert lines.major(1.0, 11.0) == [5.0, 10.0]
    assert lines.minor(3.5, 7.5) == [4.0, 6.0, 7.0]
    assert lines.label(3085.0) == "3085"
    assert Lines.of(20).label(10.5) == "10.5"
    assert nice_limits(np.array([8.5, 12.1]), 8.5, 0.4) == (8.0, 13.0)
    assert nice_limits(np.array([np.nan]), 8.5, 0.4) == (8.3, 8.7)


@given(st.floats(1.0, 5000.0), st.floats(0.5, 900.0), st.integers(5, 2000))
def test_lines_and_limits_keep_their_promises(start: float, length: float, scale: int) -> None:
    lines = Lines.of(scale)
    assert lines.fine * 1000 / scale >= 4.0 - 1e-9
    assert lines.coarse * 1000 / scale >= 20.0 - 1e-9
    assert round(lines.coarse / lines.fine) == pytest.approx(lines.coarse / lines.fine)
    low, high = nice_limits(np.array([start, start + length]), start, 0.1)
    assert low < start
    assert high >= start + 0.99 * length


@given(st.floats(0.02, 3.0))
def test_a_narrow_place_is_not_drawn_inside_out(share: float) -> None:
    radius = np.full((20, 16), 0.5 * BIT)
    radius[5] *= share
    _, shape = exaggeration(Stretched(0, radius, (0.0, 2.0), 0.0), BIT)
    assert 1 <= shape <= 10
    assert (0.5 * BIT + shape * (radius - 0.5 * BIT)).min() > 0


def test_the_body_is_the_stretch_with_most_relief(wall: hb.Wall, golden: Golden) -> None:
    run = simulate(Hole(2000.0, 2040.0, washouts=(hb_washout(2025.0, 2030.0),)), Tool(sample_rate=4.0))
    made = hb.reconstruct(hb.Caliper(run.depth, run.toolface, run.radius), bit_diameter=BIT, sectors=16)
    ends = most_relief(made, 2000.0, 2040.0)
    assert ends is not None
    assert ends[0] <= 2026 < 2029 <= ends[1]
    with golden.raises():
        turns_between(wall, 1.0, 2.0)
    with golden.raises():
        turns_between(wall, 2013.3, 2014.6)


def test_what_is_exaggerated_is_written_on_the_body(wall: hb.Wall) -> None:
    one = turns_between(wall, 2001, 2010)
    tube, shape = exaggeration(one, BIT)
    words = [text.get_text() for text in texts(plot.log(wall, body=(2001, 2010), dpi=40))]
    assert [
        word for word in words if word.startswith(f"tube × {tube:g} against depth, shape × {shape:g} more; seen from")
    ]
    round_hole = hb.reconstruct(hb.Caliper.gauge(0, 20, BIT), bit_diameter=BIT)
    assert exaggeration(turns_between(round_hole, 0, 12), BIT)[1] == 1.0  # nothing to exaggerate


def test_noise_is_exaggerated_less_than_relief() -> None:
    around = np.cos(np.radians(22.5 * np.arange(16)))
    smooth = np.full((200, 16), 0.5 * BIT) + 0.004 * np.maximum(around, 0)
    noisy = smooth + np.random.default_rng(0).normal(0, 2e-4, smooth.shape)
    ends = (0.0, 199 * 0.01)
    assert exaggeration(Stretched(0, smooth, ends, 0.0), BIT)[1] == 10
    tube, shape = exaggeration(Stretched(0, noisy, ends, 0.0), BIT)
    assert shape < 10
    assert tube * shape * 2e-4 / 0.01 == pytest.approx(0.2, rel=0.1)


def test_a_breakout_behind_the_hole_sticks_out_as_far_as_one_in_front() -> None:
    def outline(at: float) -> Any:
        away = (5.0 * np.arange(72) - at + 180) % 360 - 180
        radius = np.tile(0.108 + 0.022 * np.exp(-((away / 18) ** 2)), (120, 1)).ravel()
        view = View(facing=0.0, tube=10.0, shape=5.0, width=200, height=400)
        seen = shade(radius, np.full((radius.size, 3), 0.8), 72, 0.1, (0.0, 0.0), BIT, view).pixels[..., 3] > 0.5
        return np.argmax(seen, axis=1)[120:300]  # the left edge

    np.testing.assert_allclose(outline(130), outline(50), atol=1)


def test_the_steep_side_of_a_breakout_is_drawn_without_gaps() -> None:
    away = (5.0 * np.arange(72) - 50 + 180) % 360 - 180
    radius = np.tile(0.108 + 0.022 * np.exp(-((away / 18) ** 2)), (120, 1)).ravel()
    view = View(facing=0.0, tube=10.0, shape=5.0, width=200, height=400)
    seen = shade(radius, np.full((radius.size, 3), 0.8), 72, 0.1, (0.0, 0.0), BIT, view).pixels[120:300, :, 3]
    for row in seen:
        first, *_, last = np.flatnonzero(row)
        assert row[first + 1 : last].min() == 1


def hb_washout(start: float, stop: float) -> Any:
    from helibore.simulation.tool import Washout

    return Washout(start, stop, 0.03)


@pytest.mark.parametrize(
    "options",
    [
        {"scale": 0},
        {"scale": 10**9},
        {"reference": "up"},
        {"left": 45},
        {"curves": ("C3",)},
        {"unit": "m"},
        {"start": 2010, "stop": 2001},
        {"start": 3000, "stop": 3001},
        {"images": ["X"]},
        {"reference": "north"},
        {"looks": {"GR": plot.Look(limits=(0, 9), log=True)}},
        {"body": (2001,)},
        {"body": (2001, math.nan)},
        {"dpi": 5},
    ],
)
def test_options_that_break_a_rule(wall: hb.Wall, options: dict[str, Any], golden: Golden) -> None:
    with golden.raises():
        plot.log(wall, **options)


def wall_with(depth: Any, values: Any, unit: str = "gAPI") -> hb.Wall:
    wall = hb.reconstruct(hb.Caliper.gauge(1000.0, 1005.0, BIT), bit_diameter=BIT, sectors=8)
    wall.images["X"] = image_of(depth, values, "X", unit)
    return wall


def test_images_that_cannot_be_shown() -> None:
    depth = np.arange(1000.0, 1005.0, 0.1)
    values = np.add.outer(depth, np.arange(4.0))
    late = ([*depth, 2000.0], [*np.full_like(values, np.nan), [1, 2, 3, 4]])
    same = np.full_like(values, 7.0)
    cases = [
        (wall_with(depth + 500, values), r"image 'X' reaches from 1500 to .* m: outside the interval, 1000 to"),
        (wall_with(depth, same), r"image 'X', .*: constant, 7 at both .*: give limits=\(low, high\)"),
        (wall_with(depth, -values, "ohm.m"), r"image 'X', .*: all 200 are missing"),
        (wall_with(*late), r"image 'X', .*: all 200 are missing"),
    ]  # fmt: skip
    for wall, message in cases:
        with pytest.raises(ValueError, match=message):
            plot.log(wall)
    constant = wall_with(depth, np.full_like(values, 7.0))
    assert plot.log(constant, looks={"X": plot.Look(limits=(0, 10))}, dpi=40, body=())


@pytest.mark.parametrize("window", [None, 1.0])
def test_a_value_below_zero_of_a_logarithmic_image_is_drawn_as_no_data_and_counted(window: float | None) -> None:
    depth = np.arange(1000.0, 1005.0, 0.1)
    values = np.add.outer(depth, np.arange(4.0))
    values[[3, 20], 2] = -0.5, 0.0
    wall = wall_with(depth, values, "ohm.m")
    content = content_of(wall, plot.Drawing(looks={"X": plot.Look(window=window)}))
    (track,) = [one for one in content.tracks if isinstance(one, ImageTrack)]
    assert track.shown.dropped == 2
    assert "2 not above 0: no data" in track.shown.note
    assert np.flatnonzero(np.isnan(track.source[1])).tolist() == [14, 82]
    assert plot.log(wall, looks={"X": plot.Look(window=window)}, dpi=40, body=())


@pytest.mark.parametrize("own", ["high-side", "north", "parallel-transport"])
def test_toolfaces_count_from_what_the_path_says(own: Any) -> None:
    wall = hb.reconstruct(hb.Caliper.gauge(1000.0, 1005.0, BIT), bit_diameter=BIT, sectors=8)
    wall.path = hb.Survey([1000.0, 1005.0], [48.0, 48.0], [248.0, 248.0]).path(reference=own)
    rows = np.tile(np.arange(16.0), (50, 1))
    wall.images["X"] = image_of(1000.0 + 0.1 * np.arange(50), rows, "X", reference="high-side")
    content = content_of(wall, plot.Drawing())
    assert content.reference == own
    drawn = next(track.source[0] for track in content.tracks if isinstance(track, ImageTrack))
    assert isinstance(drawn, hb.SectorImage)
    # The high side lies at 254.87 from north here, and so it does with parallel transport down a straight hole.
    high = 0.0 if own == "high-side" else 254.87
    cells = np.floor(((drawn.toolface - high) % 360) / 22.5)
    assert (np.isclose(drawn.values[20], cells)).mean() > 0.99
    words = [text.get_text() for text in texts(plot.log(wall, dpi=40, body=()))]
    assert {"high-side": "U", "north": "E", "parallel-transport": "90°"}[own] in words
    assert "16 sectors, static" in words
    with pytest.raises(
        ValueError, match=f"^reference = '{'north' if own != 'north' else 'high-side'}': the wall's path"
    ):
        plot.log(wall, reference="north" if own != "north" else "high-side")


def test_a_hole_without_relief_has_no_body_unless_one_is_asked_for() -> None:
    wall = hb.reconstruct(hb.Caliper.gauge(1000.0, 1060.0, BIT), bit_diameter=BIT, sectors=8)
    depth = np.arange(1000.0, 1060.0, 0.1)
    wall.images["X"] = image_of(depth, np.add.outer(depth, np.arange(4.0)), "X")
    assert content_of(wall, plot.Drawing()).stretched is None
    content = content_of(wall, plot.Drawing(body=(1010.0, 1020.0)))
    assert content.stretched is not None
    assert [body.name for body in content.bodies] == ["X"]
    assert content.stretched.depth == pytest.approx((1010.0, 1020.0), abs=wall.settings.pitch)


def test_what_a_colour_scale_cuts_off_is_counted() -> None:
    depth = np.arange(1000.0, 1005.0, 0.1)
    values = np.add.outer(np.linspace(1, 99, depth.size), np.zeros(4))
    values[0, 0] = np.nan
    there = values[np.isfinite(values)]
    words = [text.get_text() for text in texts(plot.log(wall_with(depth, values), dpi=40, body=()))]
    low, high = np.percentile(there, [2, 98])
    beyond = int(((there < low) | (there > high)).sum())
    assert beyond == 7
    assert f"{beyond} beyond the ends ({100 * beyond / 199:.2g}\u00a0%)" in words
    look = plot.Look(limits=(10.0, 1000.0), log=True)
    figure = plot.log(wall_with(depth, values), looks={"X": look}, dpi=40, body=())
    below = int((there < 10).sum())
    assert f"logarithmic, {below} beyond the ends ({100 * below / 199:.2g}\u00a0%)" in [
        text.get_text() for text in texts(figure)
    ]
    assert_readable(figure)
    whole = plot.log(wall_with(depth, values), looks={"X": plot.Look(limits=(0.0, 100.0))}, dpi=40, body=())
    assert not [text for text in texts(whole) if "beyond" in text.get_text()]
    values[5] = values[5] + np.array([0.0, 0.0, 60.0, 0.0])
    sliding = plot.log(wall_with(depth, values), looks={"X": plot.Look(window=2.0)}, dpi=40, body=())
    assert [text for text in texts(sliding) if text.get_text().startswith("1 beyond the ends (0.5\u00a0%)")]


def test_an_image_without_a_unit_says_so() -> None:
    depth = np.arange(1000.0, 1005.0, 0.1)
    figure = plot.log(wall_with(depth, np.add.outer(depth, np.arange(4.0)), ""), dpi=40, body=())
    assert "X [no unit]" in [text.get_text() for text in texts(figure)]


def test_paper_too_long_for_its_format(wall: hb.Wall, tmp_path: Path, golden: Golden) -> None:
    figure = plot.log(wall, scale=200, dpi=40, polar=(), body=())
    figure.set_size_inches(8, 300)
    with golden.raises():
        plot.save(figure, tmp_path / "log.pdf")
    figure.set_size_inches(300, 8)
    with golden.raises():
        plot.save(figure, tmp_path / "log.pdf")
    figure.set_size_inches(8, 2000)
    with golden.raises():
        plot.save(figure, tmp_path / "log.png")
    with golden.raises():
        plot.save([figure, figure], tmp_path / "log.png")
    with golden.raises():
        plot.save([], tmp_path / "log.pdf")
    assert not list(tmp_path.iterdir())


def test_pages_of_a_long_well_are_divided_at_numbers(wall: hb.Wall) -> None:
    content = content_of(wall, plot.Drawing(scale=20, polar=(), body=()))
    parts = _divided(content, 250.0)
    assert all(bottom > top for top, bottom in parts)
    assert max(bottom - top for top, bottom in parts) <= 250.0 / 50
    assert MARGIN + HEAD < 60


def test_no_page_ends_within_a_sinusoid() -> None:
    wall = plotted_wall()
    picks = [hb.Pick(kind="fracture", depth=2000.3 + 0.9 * i, apparent_dip=65.0, toolface=90.0) for i in range(20)]
    bare = _divided(content_of(wall, plot.Drawing(scale=20, polar=(), body=())), 250.0)
    wall.picks = picks
    parts = _divided(content_of(wall, plot.Drawing(scale=20, polar=(), body=())), 250.0)
    assert [top for top, _ in parts[1:]] == [bottom for _, bottom in parts[:-1]]
    assert (parts[0][0], parts[-1][1]) == (bare[0][0], bare[-1][1])
    ends = [bottom for _, bottom in parts[:-1]]
    half = 0.5 * wall.settings.bit_diameter * math.tan(math.radians(65.0))
    assert any(abs(bottom - pick.depth) <= half for _, bottom in bare[:-1] for pick in picks), "else this shows nothing"
    assert not any(abs(end - pick.depth) <= half for end in ends for pick in picks)


def test_the_last_page_is_no_stub_and_the_ends_have_their_depths(wall: hb.Wall) -> None:
    content = content_of(wall, plot.Drawing(scale=40, start=2000.3, stop=2021.7, polar=(), body=()))
    length = content.paper_length()
    parts = _divided(content, (length - 20.0 + header_height(content)) / 2)
    assert [top for top, _ in parts[1:]] == [bottom for _, bottom in parts[:-1]]
    assert (parts[0][0], parts[-1][1]) == (2000.3, 2021.7)
    assert min(bottom - top for top, bottom in parts) * 1000 / 40 >= 40
    figure = plot.log(wall, scale=40, start=2000.3, stop=2021.7, polar=(), body=(), dpi=60)
    assert_readable(figure)
    ends = {text.get_text(): text.get_window_extent() for text in tracks_of(figure)[0].texts}
    frame, least = tracks_of(figure)[0].bbox, 0.5 / 25.4 * 60  # half a millimetre off the frame
    assert frame.y1 - ends["2000.3"].y1 > least
    assert ends["2021.7"].y0 - frame.y0 > least


def test_depths_are_in_feet_and_sizes_in_inches(wall: hb.Wall) -> None:
    inch, metric = (
        next(one for one in content_of(wall, plot.Drawing(unit=unit, body=())).tracks if isinstance(one, ImageTrack))
        for unit in ("ft", "mm")
    )
    assert (inch.shown.unit, metric.shown.unit) == ("in", "mm")
    np.testing.assert_allclose(25.4 * inch.source[1], metric.source[1])
    assert 25.4 * inch.shown.scale.high == pytest.approx(metric.shown.scale.high), "the same colours"
    lines = Lines.of(240, FEET)
    assert (lines.fine, lines.coarse) == (pytest.approx(5 * 0.3048), pytest.approx(20 * 0.3048))
    assert [lines.label(depth) for depth in lines.major(2000.0, 2015.0)] == ["6580", "6600"]
    figure = plot.log(
        wall, unit="ft", scale=40, start=2000.0, stop=2006.0, polar=(2003.0,), header={"mud": "oil"}, dpi=60
    )
    assert_readable(figure)
    words = " | ".join(text.get_text() for text in texts(figure))
    for needed in ("MD [ft]", "6,561.68 to 6,581.36 ft MD (19.7 ft)", "7.62 mm on paper a foot", "Caliper [in]",
                   "A   6,571.52 ft", "Mud | oil", "Company | not given"):  # fmt: skip
        assert needed in words, needed
    assert "m MD" not in words


def test_zones_are_listed_worst_first_and_every_page_says_whose_it_is(wall: hb.Wall) -> None:
    figures = plot.pages(wall, title="A well", unit="mm", body=(), dpi=50)
    zones = wall.zones()
    worst = zones.by_severity()
    assert [of.severity * of.confidence for of in worst] == sorted(
        (of.severity * of.confidence for of in zones.zones), reverse=True
    )
    assert zones.by_severity(stop=worst[0].start) == [one for one in worst if one.start < worst[0].start]
    (listed,) = [figure for figure in figures if "Zones, worst first" in [text.get_text() for text in figure.texts]]
    words = [text.get_text() for text in listed.texts]
    rows = [(f"{zone.start:,.1f} – {zone.stop:,.1f}", f"{1000 * zone.measure:+.1f}") for zone in worst]
    assert [(a, b) for a, b in pairwise(words) if " – " in a and b[0] in "+-"] == rows
    for number, figure in enumerate(figures, 1):
        assert_readable(figure)
        foot = [text.get_text() for text in figure.texts]
        assert {"Zones:", "washout", "breakout", f"helibore {hb.__version__}, page {number} of {len(figures)}"} <= {
            *foot
        }
        of_tracks = [text for text in foot if text.startswith("A well, ") and text.endswith("1:40")]
        assert len(of_tracks) == ("Caliper [mm]" in foot), "a page without tracks has no depth scale"
        assert ("A well" in foot) == (not of_tracks or number == 1)
    strips = [text.get_text() for figure in figures for axes in figure.axes for text in axes.texts]
    assert "breakout" in strips, "a word where it fits"


def test_a_narrow_head_keeps_the_whole_name(wall: hb.Wall) -> None:
    depth = np.linspace(2000, 2022, 50)
    curves = [ScalarCurve(f"PRESSURE_{n}", "psi", depth, 10000 + depth * n) for n in range(6)]
    figure = plot.log(wall, scalars=curves, dpi=100, polar=(), body=())
    width = figure.get_size_inches()[0] * MM
    drawn = [track.width for track in content_of(wall, plot.Drawing(scalars=curves)).tracks]
    assert drawn[2:8] == [15.0] * 6, "curves first, then images, then the paper"
    assert width == pytest.approx(sum(drawn) + 2 * (len(drawn) - 1) + 2 * MARGIN)
    words = "".join("".join(text.get_text().split()) for text in figure.texts)
    for curve in curves:
        assert f"{curve.name}[psi]" in words
    assert_readable(figure)


def test_another_wall_stands_beside_on_the_same_depths(wall: hb.Wall, golden: Golden) -> None:
    depth = np.arange(2004, 2030, 0.02)
    other = hb.reconstruct(hb.Caliper(depth, depth * 900 % 360, np.full(depth.size, BIT / 2 + 0.06)), bit_diameter=BIT)
    drawing = plot.Drawing(beside={"F-15": other}, polar=(), body=(), scale=200)
    content = content_of(wall, drawing)
    assert content.bottom == pytest.approx(2030, abs=0.3), "the ends of both"
    own, images, beside, image = content.tracks[1], content.tracks[2:5], content.tracks[5], content.tracks[6]
    assert [track.shown.name for track in images] == ["Over bit radius", "GR", "RES"]  # type: ignore[union-attr]
    assert (beside.name, image.shown.name) == ("F-15: ", "F-15: over bit")  # type: ignore[union-attr]
    assert image.shown.scale == images[0].shown.scale, "one colour is one size"  # type: ignore[union-attr]
    assert beside.limits == own.limits  # type: ignore[union-attr]
    assert own.limits[1] > (BIT + 0.12) / 0.0254  # type: ignore[union-attr]
    assert_readable(plot.pages(wall, beside={"F-15": other}, polar=(), body=(), scale=200, dpi=60)[0])
    gauge = hb.reconstruct(hb.Caliper.gauge(2000.0, 2010.0, BIT), bit_diameter=BIT)
    with golden.raises():
        content_of(wall, plot.Drawing(beside={"F-15": gauge}))


def test_orange_fills_over_bit_and_blue_under_it_by_shape_alone() -> None:
    """Bit to the least diameter strong, from there to the greatest pale; a zone changes no colour."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    depth = np.arange(2000, 2010, 0.002)
    oval = 0.01 * np.cos(np.radians(2 * depth * 3000))
    size = np.select([depth < 2003, depth < 2006], [0.03, -0.008], 0.0)
    wall = hb.reconstruct(hb.Caliper(depth, depth * 3000 % 360, BIT / 2 + size + oval), bit_diameter=BIT, sectors=16)
    assert "washout" in {zone.kind for zone in wall.zones().zones}
    figure = plot.log(wall, unit="mm", dpi=150, curves=(), polar=(), body=())
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())[..., :3]
    axes = tracks_of(figure)[1]

    def color(diameter: float, at: float) -> str:
        right, up = axes.transData.transform((1000 * BIT + diameter, at))
        return "#" + bytes(pixels[int(pixels.shape[0] - up), int(right)]).hex()

    over, pale, under = (FILL_COLORS[fill] for fill in ("over", "partly over", "under"))
    assert [color(size, 2001.33) for size in (5, 30, 50, 70, 90)] == [over, over, pale, pale, "#ffffff"]
    assert [color(size, 2004.33) for size in (-28, -8, 12)] == [under, under, "#ffffff"]
    assert [color(size, 2008.33) for size in (-25, -9, 9)] == ["#ffffff", under, pale]


def test_a_scalar_track_draws_its_curve_to_its_gaps() -> None:
    made = hb.reconstruct(hb.Caliper.gauge(2000.0, 2010.0, BIT), bit_diameter=BIT, sectors=8)
    values = np.arange(11.0) * 7
    values[4] = np.nan
    curve = ScalarCurve("ROP", "m/h", 2000.0 + np.arange(11.0), values)
    figure = plot.log(made, scalars=[curve], dpi=40, polar=(), body=())
    assert "ROP [m/h]" in [text.get_text() for text in texts(figure)]
    lines = [line for axes in figure.axes for line in axes.lines if np.size(line.get_xdata()) == 11]
    (drawn,) = [line for line in lines if np.isnan(line.get_xdata()).sum() == 1]
    np.testing.assert_array_equal(drawn.get_xdata(), values)
    np.testing.assert_array_equal(drawn.get_ydata(), curve.depth)


def test_a_picture_and_a_report_state_the_header_of_the_log() -> None:
    made = hb.reconstruct(hb.Caliper.gauge(2000.0, 2001.0, BIT), bit_diameter=BIT, sectors=8)
    labels = {
        "company": "Company", "field": "Field", "location": "Location", "date": "Date", "datum": "Depth datum",
        "mud": "Mud", "bit": "Bit", "remarks": "Remarks", "API": "API",
    }  # fmt: skip
    header = {name: f"my {name}" for name in labels}
    figure = plot.log(made, title="W-1", header=header, dpi=30, polar=(), body=())
    words = " | ".join(text.get_text() for text in texts(figure))
    long = plot.log(made, header={"a name of an entry that is longer than its column": "x"}, dpi=80, polar=(), body=())
    assert_readable(long)
    rows = page(made, title="W-1", header=header, dpi=30, polar=(), body=())
    assert "W-1" in words
    assert "<h1>W-1</h1>" in rows
    for name, label in labels.items():
        assert f"{label} | my {name}" in words
        assert f"<tr><th>{label}</th><td>my {name}</td></tr>" in rows


def test_a_wall_that_came_with_its_uncertainty_shows_half_the_interval(wall: hb.Wall) -> None:
    assert not [track for track in content_of(wall, plot.Drawing(polar=(), body=())).tracks if _sure(track)]
    known = plotted_wall()
    known.attributes["sigma"] = sigma = on_quads(known.sigma, known.settings.sectors)
    content = content_of(known, plot.Drawing(unit="mm", polar=(), body=()))
    (track,) = [track for track in content.tracks if _sure(track)]
    np.testing.assert_allclose(track.source[1][: sigma.size], 1959.964 * sigma)
    assert np.isnan(track.source[1][sigma.size :]).all()
    assert (track.shown.unit, track.shown.scale.low) == ("mm", 0.0)
    assert_readable(plot.log(known, polar=(), body=()))


def _sure(track: object) -> bool:
    return isinstance(track, ImageTrack) and track.shown.name == "Radius, 95 %"


@pytest.mark.parametrize("curves", [("C1", "C2"), ("C1", "C2", "D0", "D90")])
def test_every_line_of_the_caliper_track_has_its_key(wall: hb.Wall, curves: tuple[str, ...]) -> None:
    figure = plot.log(wall, curves=curves, polar=(), body=(), dpi=60)
    caliper = tracks_of(figure)[1]
    drawn = {line.get_color() for line in caliper.lines if len(set(line.get_xdata())) > 2}
    keys = {line.get_color() for line in figure.lines + figure.artists if hasattr(line, "get_xdata")}
    assert len(drawn) == 2 + len(curves) // 2, "by area, least, and each pair"
    assert drawn <= keys
    filled = [part for part in caliper.collections if part.get_facecolor().size]
    assert not [part for part in filled if np.any(part.get_linewidth())], "a fill has no edge that looks like a curve"
    words = [text.get_text() for text in texts(figure)]
    assert {"by area", "least", *({"C1", "C2"} & set(curves))} <= set(words)
    assert_readable(figure)


@pytest.mark.parametrize("scale", [40, 50, 60, 70, 80])
def test_the_bodies_take_what_the_last_page_has_left(wall: hb.Wall, scale: int) -> None:
    last = plot.pages(wall, scale=scale, polar=(), dpi=40)[-1]
    bodies = [axes.get_position().height * 297 for axes in last.axes if axes.images and axes.get_ylim()[0] < 2040]
    tall = [height for height in bodies if 79 < height < 206]
    lowest = min(axes.get_position().y0 for axes in last.axes) * 297
    assert len(tall) >= 1
    assert lowest < 297 / 3, "the last page is filled"


def test_the_header_names_picks_and_tops_and_a_picture_stands_below_the_tracks() -> None:
    """Tops and picks outside the interval are not named; the picture keeps its proportions."""
    wall = hb.reconstruct(hb.Caliper.gauge(1000, 1010, 0.2), bit_diameter=0.2, sectors=16)
    wall.picks = hb.Picks([
        hb.Pick(kind=kind, depth=depth, toolface=0.0, apparent_dip=30.0)
        for kind, depth in (("bed", 1002.0), ("bed", 1003.0), ("fault", 1004.0), ("fracture", 1009.0))
    ])  # fmt: skip
    wall.intervals = (hb.Interval("Upper", 1002.5, 1004.5), hb.Interval("Lower", 1004.5, math.inf))
    content = content_of(wall, Drawing(start=1001.0, stop=1004.2, unit="mm"))
    rows = {label: text for label, text, _ in facts(content)}
    assert rows["Picks"] == "2 beds, 1 fault"
    assert rows["Tops [m]"] == "Upper 1002.5"
    wall.intervals = tuple(hb.Interval(f"Top {i}", 1001.0 + 0.2 * i, 1001.2 + 0.2 * i) for i in range(14))
    many_tops = content_of(wall, Drawing(unit="mm"))
    assert dict(row[:2] for row in facts(many_tops))["Tops [m]"].count(",") == 13, "a report names all"
    many = [text for label, text, _ in header_rows(many_tops) if "Top " in text or "more" in text]
    assert many[0] == "Top 0 1001.0, Top 1 1001.2, Top 2 1001.4", "three names have room in a row"
    assert [text.count(",") for text in many] == [2, 2, 2, 2]
    assert many[-1] == "Top 9 1002.8, Top 10 1003.0, and 3 more"
    wall.intervals = (hb.Interval("Upper", 1002.5, 1004.5),)
    written = io.BytesIO()
    red = np.zeros((30, 90, 3))
    red[..., 0] = 1.0
    imsave(written, red, format="png")
    for figures in ([hb.plot.log(wall, picture=written.getvalue())], hb.plot.pages(wall, picture=written.getvalue())):
        axes = next(
            axes for figure in figures for axes in figure.axes
            if axes.images and axes.images[0].get_array().shape[:2] == (30, 90)
        )  # fmt: skip
        box = axes.get_window_extent()
        assert box.width / box.height == pytest.approx(3.0, rel=1e-6)


def test_the_header_states_by_how_much_passes_were_shifted() -> None:
    """Every depth of the print has moved with them."""
    wall = plotted_wall()
    left = [["shift", "pass 1: left where it is: no other pass matches it"]]
    found = [["shift", "pass 1: +0.300 m; the others"], ["shift", "pass 2: -0.300 +- 0.006 m found; second best"]]
    for lines, row in ((left, []), (found, ["pass 1: +0.300 m; pass 2: -0.300 ± 0.006 m"])):
        wall.made_from = {"preparation": lines}
        rows = shifts(content_of(wall, plot.Drawing(polar=(), body=())))
        assert [text for _, text, _ in rows] == row

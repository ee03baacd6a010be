"""Picks on paper, the tracks of a template, and hatching of the shaded body between arms."""

from __future__ import annotations

import functools
import math
import operator
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text
from plotted_wall import BIT, image_of, plotted_wall

import helibore as hb
from helibore import plot
from helibore.base.colors import PICK_COLORS, TOP_COLOR
from helibore.logs.picks import PLANES, Pick, plane
from helibore.plot.content import Drawing, content_of
from helibore.plot.hatching import HATCH_BYTES
from helibore.plot.html_report import page
from helibore.plot.paper import MM
from helibore.plot.pick_pages import table_row
from helibore.plot.picked import DipTrack
from helibore.plot.shading import View, shade
from helibore.plot.tracks import CaliperTrack, DepthTrack, ImageTrack, ScalarTrack
from helibore.settings.template import Template
from helibore.settings.toml_reading import TomlSource, read_table

BED = Pick(kind="bed", depth=2010.0, toolface=90.0, apparent_dip=60.0, radius=0.1)
BOX = Pick(kind="breakout", depth=2005.0, toolface=350.0, height=2.0, opening=40.0)


def as_template(tree: dict[str, object]) -> Template:
    return read_table(Template, tree, TomlSource("template"))


@pytest.fixture(scope="module")
def wall() -> hb.Wall:
    wall = plotted_wall()
    wall.picks += [BED, BOX, Pick(kind="fault", depth=2050.0, toolface=0.0)]
    return wall


def test_a_plane_is_a_sinusoid_on_images_and_a_tadpole(wall: hb.Wall) -> None:
    wall.path = hb.Survey([0.0, 3000.0], [30.0] * 2, [0.0] * 2).path()
    figure = hb.plot.log(wall, polar=(), body=())
    wall.path = None
    lines = [line for axes in figure.axes for line in axes.lines]
    head, pole = [line for line in lines if line.get_marker() == "o"]
    assert np.hypot(pole.get_xdata()[0], pole.get_ydata()[0]) == pytest.approx(
        np.sqrt(2) * np.sin(np.radians(BED.dip(wall_path())[0] / 2))
    )
    assert (head.get_xdata()[0], head.get_ydata()[0]) == pytest.approx((BED.dip(wall_path())[0], 2010.0))
    (curve, *_others) = [line for line in lines if np.size(line.get_xdata()) == 181 and line.get_color() != "white"]
    across, depth = curve.get_data()
    assert depth.max() == pytest.approx(2010 + 0.1 * np.tan(np.radians(60)))
    assert across[np.argmax(depth)] == 90
    boxes = [line for line in lines if np.size(line.get_xdata()) == 5]
    assert {(float(min(line.get_ydata())), float(max(line.get_ydata()))) for line in boxes} == {(2004.0, 2006.0)}
    edges = sorted({float(min(line.get_xdata())) for line in boxes})
    assert edges == [-30.0, 150.0, 330.0, 510.0, 690.0], "both sides, and what crosses the edge of the image"
    texts = [text.get_text() for text in figure.texts]
    assert {"True dip [°]", "tail: dip azimuth, N up", "Picks:"} <= set(texts)
    assert texts.count("bed") == 3, "its symbol, its colour, and its row in the table"
    assert "fault" not in texts, "none of it lies in the interval"


def test_a_sine_or_box_that_reaches_into_the_interval_is_drawn_there(wall: hb.Wall) -> None:
    def drawn(start: float) -> tuple[set[int], set[str]]:
        figure = hb.plot.log(wall, polar=(), body=(), start=start, stop=start + 3)
        lines = [line for axes in figure.axes for line in axes.lines if line.get_color() in PICK_COLORS.values()]
        return {np.size(line.get_xdata()) for line in lines} & {5, 181}, {text.get_text() for text in figure.texts}

    half = 0.1 * np.tan(np.radians(60))
    sizes, texts = drawn(2010 + half - 0.05)  # the centre of the bed is above, its trough inside
    assert sizes == {181}
    assert {"Picks:", "bed"} <= texts
    assert "Apparent dip [°]" not in texts, "no tadpole stands in the interval"
    sizes, texts = drawn(2010 + half + 0.05)
    assert sizes == set()
    assert "Picks:" not in texts
    assert drawn(2005.9)[0] == {5}, "the lower end of the breakout"


def test_tadpoles_have_the_colour_of_their_class_and_stay_whole(wall: hb.Wall) -> None:
    steep = [Pick(kind=kind, depth=2003.0, toolface=90.0, apparent_dip=88.0) for kind in PLANES]
    wall.picks, kept = type(wall.picks)(steep), wall.picks
    figure = hb.plot.log(wall, polar=(), body=())
    wall.picks = kept
    axes, net = [axes for axes in figure.axes if any(line.get_marker() == "D" for line in axes.lines)]
    assert len([line for line in net.lines if line.get_marker() in ("o", "s", "D", "^")]) == 5
    heads = [line for line in axes.lines if line.get_marker() in ("o", "s", "D", "^")]
    drawn = [line for line in figure.artists if isinstance(line, Line2D)]
    legend = [line for line in drawn if line.get_marker() in ("o", "s", "D", "^")][: len(PLANES)]
    for shown in (heads, legend):
        assert [line.get_markeredgecolor() for line in shown] == [PICK_COLORS[kind] for kind in PLANES]
        assert [line.get_markerfacecolor() == "white" for line in shown] == [False, True, False, True, False]
    tails = [line for line in axes.lines if np.size(line.get_xdata()) == 2 and line.get_color() in PICK_COLORS.values()]
    assert [line.get_color() for line in tails if max(line.get_xdata()) > 88] == [PICK_COLORS[kind] for kind in PLANES]
    low, high = axes.get_xlim()
    assert low < 0 < max(max(line.get_xdata()) for line in tails) < high, "the tail, and so the head, is inside"


def wall_path() -> hb.Path:
    return hb.Survey([0.0, 3000.0], [30.0] * 2, [0.0] * 2).path()


def test_without_a_survey_the_dip_is_that_to_the_hole(wall: hb.Wall) -> None:
    assert DipTrack([BED, BOX], None).planes == [(BED, 60.0, 90.0)]
    assert [DipTrack([BED], None, of).tail for of in ("high-side", "north", "")] == [
        "toolface, U up", "toolface, N up", "toolface, 0° up"
    ]  # fmt: skip
    assert content_of(wall, Drawing(start=2016.5, polar=(), body=())).tracks[-1].__class__ is ImageTrack
    report = page(wall, body=(), polar=(), dpi=30)
    assert "<th>breakout</th>" not in report
    rows = report[report.index('<section id="picks">') :]
    assert "Without a survey, dip and azimuth are not known. Toolfaces: from the high side" in rows
    assert '<td>bed</td><td class="number">2,010.00</td><td class="number">–</td>' in rows
    assert '<td>breakout</td><td class="number">2,005.00</td>' in rows


def test_a_template_says_which_tracks_there_are_and_how_wide(wall: hb.Wall) -> None:
    tracks = [
        {"kind": "image", "name": "GR", "width": 192},
        {"kind": "dips"},
        {"kind": "curves", "names": ["RUGO", "NONE", "DEQ"], "width": 192},
        {"kind": "image", "name": "Radius"},
        {"kind": "image", "name": "none"},
        {"kind": "caliper"},
    ]
    found = content_of(wall, Drawing(template=as_template({"track": tracks}), polar=(), body=())).tracks
    kinds = [DepthTrack, ImageTrack, DipTrack, ScalarTrack, ScalarTrack, ImageTrack, CaliperTrack]
    assert [type(track) for track in found] == kinds
    assert [found[at].width for at in (1, 3, 4)] == pytest.approx([50.8, 25.4, 25.4])
    assert [type(one) for one in content_of(wall, Drawing(template=Template(), polar=(), body=())).tracks] == [
        DepthTrack
    ]


def test_header_and_foot_have_room_above_and_below_a_narrow_track(wall: hb.Wall) -> None:
    template = as_template({"track": [{"kind": "image", "name": "Radius", "width": 60}]})
    for draw in (plot.log, plot.overview):
        figure = draw(wall, template=template, polar=(), body=(), dpi=60)
        figure.draw_without_rendering()
        texts = [text for text in figure.findobj(Text) if text.get_visible() and text.get_text().strip()]
        assert len(texts) > 20
        assert [text.get_text() for text in texts if text.get_window_extent().x1 > figure.bbox.x1] == []


def test_a_template_leaves_out_a_curve_without_a_value_in_the_interval(wall: hb.Wall) -> None:
    """RUGO is missing within half a window of the wall's end."""
    template = as_template({"track": [{"kind": "curves", "names": ["RUGO", "DEQ"]}]})
    top = float(wall.depth[0])
    drawing = Drawing(template=template, start=top, stop=top + 0.4, images=(), polar=(), body=())
    assert [track.curve.name for track in content_of(wall, drawing).tracks[1:]] == ["DEQ"]  # type: ignore[union-attr]


def test_the_body_is_hatched_where_it_lies_between_arms_and_nowhere_else() -> None:
    radius, colors = np.full(60 * 32, 0.1), np.ones((60 * 32, 3))
    between = (np.arange(60 * 32) < 30 * 32).astype(float)
    view = View(0.0, tube=5.0, shape=1.0, width=200, height=400, hatch=8)
    args = (radius, colors, 32, 0.1, (0.0, 0.0), 0.2, view)
    plain, hatched = shade(*args).pixels, shade(*args, between).pixels
    differs = np.abs(plain - hatched).max(axis=2) > 0.05
    rows = np.flatnonzero(differs.any(axis=1))
    assert rows.max() < 230, "the lower half is as it was"
    seen = plain[..., 3] > 0.9
    assert 0.1 < differs[:200][seen[:200]].mean() < 0.5, "lines, not a surface"
    bright = differs & (plain[..., :3].min(axis=2) > 0.85)
    assert bright.sum() > 300
    assert HATCH_BYTES[0] - 1 <= 255 * hatched[bright][:, :3].min() < HATCH_BYTES[0] + 25


def words(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.findobj(Text)]


def test_a_pick_has_the_same_angles_in_the_table_and_beside_the_body_as_on_the_page() -> None:
    wall = plotted_wall()
    wall.path = hb.Survey([0.0, 3000.0], [30.0] * 2, [0.0] * 2).path()
    pick = replace(plane("fracture", 2010.0, 48.0, 35.0, wall.path), dip_sigma=0.4, toolface_sigma=0.9)
    wall.picks = [pick]
    steep, aside = (math.ceil(half) for half in pick.dip_interval(wall.path))
    content = content_of(wall, Drawing(polar=(), scale=200))
    assert table_row(pick, content)[2:4] == [f"48.0 ± {steep}", f"035 ± {aside}"]
    figure = hb.plot.log(wall, polar=(), body=(2006.0, 2014.0))
    beside = [text.get_text() for axes in figure.axes for text in axes.texts]
    assert f"48 ± {steep} / 035 ± {aside}" in beside


def test_a_note_stands_at_its_depth_on_the_image_and_the_name_of_a_top_beside_the_body() -> None:
    """The name stands off what is behind: here a breakout at the left of the body that is wider than its front."""
    depth = np.repeat(np.arange(2000.0, 2012.0, 0.05), 36)
    toolface = np.tile(10.0 * np.arange(36), depth.size // 36)
    lobe = 0.022 * np.exp(-((((2 * toolface - 80 + 180) % 360 - 180) / 40) ** 2)) * (abs(depth - 2006) < 4)
    wall = hb.reconstruct(hb.Caliper(depth, toolface, 0.108 + lobe), bit_diameter=0.216, sectors=36)
    wall.picks = [Pick(kind="note", depth=2004.0, toolface=0.0, note="core 3")]
    wall.intervals = (hb.Interval("Hugin", 2006.0),)
    figure = hb.plot.log(wall, polar=(), body=(2000.0, 2012.0))
    (note,) = [text for axes in figure.axes for text in axes.texts if text.get_text() == "core 3"]
    assert note.get_position()[1] == 2004.0
    (body, name) = next((axes, text) for axes in figure.axes for text in axes.texts if text.get_text() == "Hugin")
    pixels = np.asarray(body.images[0].get_array())
    left, right, bottom, top = body.images[0].get_extent()
    row = pixels[int((name.get_position()[1] - top) / (bottom - top) * len(pixels)), :, 3]
    edge = left + np.argmax(row > 0.5) / row.size * (right - left)
    assert name.get_position()[0] < edge + 0.01 * (right - left)


def test_picks_stand_on_a_page_of_their_own_with_their_angles_and_the_north(wall: hb.Wall) -> None:
    """A table, the poles and the strikes; the picks outside the interval are not there."""
    survey = hb.Survey([0.0, 3000.0], [30.0] * 2, [0.0] * 2, north="grid")
    wall.path = survey.path()
    figures = plot.pages(wall, polar=(), body=(), scale=200, dpi=50)
    content = content_of(wall, Drawing(polar=(), body=(), scale=200))
    dip, azimuth = BED.dip(wall.path)
    wall.path = None
    said = words(figures[-1])
    assert not {"Poles of planes", "Strikes"} & {text for figure in figures[:-1] for text in words(figure)}
    assert {"Poles of planes", "lower hemisphere, equal area", "Strikes", "N", "E", "S", "W", "bed: 1"} <= set(said)
    assert "Aperture, opening" in said, "no head is cut"
    assert {"2,010.00", "2,005.00", f"{dip:.1f}", f"{azimuth:03.0f}", "60.0", "by hand"} <= set(said)
    assert "2,050.00" not in said
    assert any(text.startswith("Dip azimuths count from grid north.") for text in said)
    row = table_row(Pick(kind="fault", depth=2010.0, toolface=5.0, misfit=0.0042, points=6, note="open"), content)
    assert row[-3:] == ["–", "4.2, 6 points", "open"]
    assert table_row(Pick(kind="fault", depth=2010.0, toolface=5.0, aperture=0.0172), content)[-3] == "17 mm"
    sure = Pick(kind="fault", depth=2010.0, toolface=5.0, apparent_dip=30.0, dip_sigma=0.9, toolface_sigma=2.0)
    assert table_row(sure, content)[4:6] == ["30.0 ± 2", "5 ± 4"], "without a path those of its own angles"
    assert table_row(Pick(kind="breakout", depth=2010.0, toolface=5.0, height=1.0, opening=44.0), content)[-3] == "44°"
    bars = [patch.get_xy() for axes in figures[-1].axes for patch in axes.patches]
    ends = sorted(float(np.degrees(np.arctan2(*bar.mean(axis=0))) % 360) for bar in bars)
    strike = (azimuth - 90) % 180
    assert len(ends) == 2
    assert [abs(end - strike - turn) < 6 for end, turn in zip(ends, (0, 180), strict=True)] == [True, True]


def test_a_print_without_the_picks_has_nothing_of_them(wall: hb.Wall) -> None:
    sheets = [plot.pages(wall, polar=(), body=(), scale=200, dpi=50, with_picks=shown) for shown in (True, False)]
    said = [{text for page in pages for text in words(page)} for pages in sheets]
    assert len(sheets[1]) < len(sheets[0])
    assert {"Poles of planes", "Picks"} <= said[0]
    assert not {"Poles of planes", "Picks"} & said[1]


def test_a_washout_at_an_open_fracture_that_was_picked_is_drawn_as_the_fracture() -> None:
    depth = np.arange(1000.0, 1010.0, 0.01)
    radius = BIT / 2 + np.where(np.abs(depth - 1003) < 0.2, 0.03, 0.0) + np.where(np.abs(depth - 1007) < 0.5, 0.03, 0.0)
    toolface = np.tile(np.arange(0.0, 360.0, 10.0), depth.size)
    samples = hb.Caliper(np.repeat(depth, 36), toolface, np.repeat(radius, 36))
    wall = hb.reconstruct(samples, bit_diameter=BIT, sectors=36, pitch=0.02, estimator="inverse-distance")
    pick = Pick(kind="fracture", depth=1003.0, toolface=0.0, apparent_dip=60.0, aperture=0.1)

    def middles(**options: Any) -> list[int]:
        (track,) = [one for one in content_of(wall, Drawing(**options)).tracks if isinstance(one, DepthTrack)]
        return [round((zone.start + zone.stop) / 2) for zone in track.zones]

    assert middles() == [1003, 1007]
    wall.picks = [pick]
    assert middles() == [1007]
    assert middles(with_picks=False) == [1003, 1007]
    assert [round(zone.start) for zone in content_of(wall, Drawing()).zones.zones] == [1006]
    text = page(wall, polar=(), body=(), start=1001.0, stop=1005.0)
    assert "1 washout is an open fracture that was picked." in text
    wall.picks = [replace(pick, aperture=None)]
    assert middles() == [1003, 1007]


def test_a_note_is_a_row_of_the_table_and_no_plane() -> None:
    wall = plotted_wall()
    wall.picks = [Pick(kind="note", depth=2010.0, toolface=0.0, note="washout in coal?")]
    figures = plot.pages(wall, polar=(), body=(), scale=200, dpi=50)
    said = words(figures[-1])
    row = said.index("2,010.00")
    assert said[row - 1 : row + 8] == ["note", "2,010.00", "–", "–", "–", "–", "–", "–", "washout in coal?"]
    assert "Poles of planes" not in words(figures[-1])
    survey = hb.Survey([0.0, 3000.0], [30.0] * 2, [0.0] * 2).path()
    assert np.isnan(wall.picks[0].dip(survey)).all()
    table = wall.picks.table(survey)
    assert hb.Picks.parse(table, survey) == wall.picks


def test_many_picks_fill_pages_and_none_is_lost() -> None:
    wall = plotted_wall()
    wall.picks += [Pick(kind="bed", depth=2000.5 + 0.1 * at, toolface=9.0, apparent_dip=5.0) for at in range(150)]
    figures = plot.pages(wall, polar=(), body=(), scale=500, dpi=50)
    depths = [f"{2000.5 + 0.1 * at:,.2f}" for at in range(150)]
    rows = [[text for text in words(figure) if text in depths] for figure in figures]
    assert functools.reduce(operator.iadd, rows, []) == depths, "in their order, each once"
    assert [bool(row) for row in rows] == [False, True, True, True]
    assert [figure.get_size_inches() * MM == pytest.approx([210, 297]) for figure in figures] == [True] * 4


def test_tracks_that_do_not_fit_on_a4_become_narrower_at_the_same_scale(wall: hb.Wall) -> None:
    wall.intervals, wall.path = (hb.Interval("Hugin", 2004.0),), wall_path()
    images = dict(wall.images)
    for count, paper in ((1, (210, 297)), (7, (297, 210))):
        wall.images.update({f"GR{at}": replace_name(wall.images["GR"], f"GR{at}") for at in range(count)})
        content = content_of(wall, Drawing(polar=(), body=(), scale=200))
        before = sum(track.width + 2.0 for track in content.tracks) - 2.0
        assert before > 190, "they do not fit"
        figures = plot.pages(wall, polar=(), body=(), scale=200, dpi=50)
        assert [tuple(figure.get_size_inches() * MM) == pytest.approx(paper) for figure in figures] == [True] * len(
            figures
        )
        depth = figures[0].axes[0]
        box, (bottom, top) = depth.get_position(), depth.get_ylim()
        assert box.height * figures[0].get_size_inches()[1] * MM == pytest.approx((bottom - top) * 5)
        boxes = sorted(
            (axes.get_position() for axes in figures[0].axes if axes.get_ylim() == (bottom, top)),
            key=lambda one: one.x0,
        )
        assert boxes[-1].x1 * paper[0] <= paper[0] - 9.99
        assert all(one.x1 < next_one.x0 for one, next_one in pairwise(boxes))
    wall.images.clear()
    wall.images.update(images)
    wall.intervals, wall.path = (), None


def replace_name(image: hb.SectorImage, name: str) -> hb.SectorImage:
    return image_of(image.depth, image.values, name)


def test_the_shaded_body_shows_planes_and_tops_at_their_depths(wall: hb.Wall) -> None:
    wall.intervals = (hb.Interval("Hugin", 2007.0), hb.Interval("Deep", 2021.0))
    bed = Pick(kind="bed", depth=2006.0, toolface=90.0, apparent_dip=20.0)
    wall.picks, kept = type(wall.picks)([bed, BED]), wall.picks
    figure = plot.log(wall, polar=(), body=(2002.0, 2009.0))
    wall.picks, wall.intervals = kept, ()
    bodies = [axes for axes in figure.axes if axes.images and axes.get_ylabel().startswith("Depth")]
    assert len(bodies) == 2
    for body in bodies:
        assert {text.get_text() for text in body.texts} == {"20 / 090 apparent", "Hugin"}, "what lies in the body"
        top, plane = (
            next(line for line in body.lines if line.get_color() == color) for color in (TOP_COLOR, PICK_COLORS["bed"])
        )
        lean = 0.5 * (BIT / 2) * np.tan(np.radians(20.0)) * 2
        assert (top.get_ydata()[[0, -1]]) == pytest.approx([2007.0] * 2, abs=0.02), "at its edges it is not nearer"
        assert abs(plane.get_ydata()[[0, -1]] - 2006.0).max() < lean + 0.02

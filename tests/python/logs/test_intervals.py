"""Named intervals of a wall: their numbers against the hole, in archives, files, pictures, pages and commands."""

from __future__ import annotations

import copy
import csv
import math
import pickle
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from command import run

import helibore as hb
from helibore.plot.content import Drawing, content_of
from helibore.plot.html_report import _intervals
from helibore.plot.log import draw_tracks
from helibore.plot.paper import Sheet
from helibore.settings.template import Template, TemplateTrack
from helibore.viewer.feed import Feed
from helibore.viewer.protocol import handshake

BIT, UPPER, LOWER, STEP = 0.2, 0.205, 0.26, 1003.0
NAMED = (
    hb.Interval("Above", 900, 999), hb.Interval("Upper", 995, STEP), hb.Interval("Lower <b>", STEP),
)  # fmt: skip


@cache
def made() -> hb.Wall:
    """A round hole, wider below STEP, from 1000 to 1006 m."""
    k = np.arange(32 * 60 + 1)
    depth = 1000.0 + k * 0.1 / 32
    caliper = hb.Caliper(depth, k * 360 / 32 % 360, np.where(depth < STEP, UPPER, LOWER) / 2)
    wall = hb.reconstruct(caliper, bit_diameter=BIT, sectors=32, max_distance=0.04)
    wall.intervals = NAMED[::-1]
    return wall


def test_the_numbers_of_each_interval() -> None:
    above, upper, lower = made().interval_table().intervals
    assert above.summary is None
    assert upper.summary is not None
    assert lower.summary is not None
    assert (upper.summary.start, upper.summary.stop) == pytest.approx((1000.0, STEP))
    assert upper.summary.volume == pytest.approx(math.pi / 4 * UPPER**2 * 3, rel=0.01)
    assert lower.summary.volume == pytest.approx(math.pi / 4 * LOWER**2 * 3, rel=0.01)
    assert lower.summary.mean_diameter == pytest.approx(LOWER, abs=1e-3)
    assert (upper.summary.kinds.get("washout", 0), lower.summary.kinds["washout"]) == pytest.approx((0, 3), abs=0.21)
    assert math.isnan(lower.volume_sigma)


def test_the_uncertainty_of_a_volume_is_that_of_its_turns() -> None:
    wall = made()
    logs = wall.logs(sigma=True)
    lower = wall.interval_table(sigma=True).intervals[-1]
    assert lower.volume_sigma == pytest.approx(logs.volume_sigma[logs.depth > STEP].sum())


@pytest.mark.parametrize(("unit", "factor"), [("m", 1.0), ("in", 0.0254), ("ft", 0.0254)])
def test_rows_have_their_units(unit: str, factor: float) -> None:
    head, _, upper, lower = made().interval_table().rows(unit)
    at = head.index(f"DMEAN ({'in' if unit == 'ft' else unit})")
    assert float(upper[at]) * factor == pytest.approx(UPPER, abs=1e-3)
    along = 0.3048 if unit == "ft" else 1.0
    assert float(lower[1]) * along == pytest.approx(STEP, abs=0.005)
    assert lower[2] == ""


def test_archives_copies_and_pickles_keep_them(tmp_path: Path) -> None:
    wall = made()
    wall.save(tmp_path / "w.wall")
    for again in (hb.load(tmp_path / "w.wall"), copy.deepcopy(wall), pickle.loads(pickle.dumps(wall))):
        assert again.intervals == NAMED


@pytest.mark.parametrize("wrong", ["tops.csv", [("A", 3.0)], 7])
def test_a_wall_refuses_other_values(wrong: object) -> None:
    with pytest.raises(hb.InputError, match="intervals"):
        copy.copy(made()).intervals = wrong  # type: ignore[assignment]


@pytest.mark.parametrize("ends", [(math.nan, 3), (math.inf, math.inf), (4, 3)])
def test_an_interval_has_its_ends_in_order(ends: tuple[float, float]) -> None:
    with pytest.raises(hb.InputError, match="start must be finite"):
        hb.Interval("A", *ends)


def test_the_page_gets_them_when_it_connects() -> None:
    scene = Feed(made(), path=None, attributes={}, well="").scene
    scene.intervals = made().intervals
    assert handshake(scene)["intervals"] == [["Above", 900, 999], ["Upper", 995, STEP], ["Lower <b>", STEP, None]]


def test_a_print_has_their_names_and_a_line_at_each_top_across_all_tracks() -> None:
    content = content_of(made(), Drawing(polar=(), body=()))
    sheet = Sheet(210, 500, 50)
    draw_tracks(sheet, content, content.top, content.bottom, 10)
    texts = [text.get_text() for text in sheet.figure.texts]
    assert {"Intervals", "Upper", "Lower <b>"} <= set(texts)
    assert "Above" not in texts
    tracks = [axes for axes in sheet.figure.axes if axes.get_ylim() == (content.bottom, content.top)]
    assert len(tracks) == len(content.tracks)
    assert all(any(STEP in line.get_ydata() for line in axes.lines) for axes in tracks)
    table = _intervals(content)
    assert "Lower &lt;b&gt;" in table
    assert "1,003" in table or "1003.00" in table


PLACED = (
    hb.Interval("Surface", 0, 1002, "Casing", 0.34), hb.Interval("Far", 0, 500, "Casing", 0.5),
    hb.Interval("clr to transl, f to m gr <b>, sub-ang to sub-rnd, mod srt, sil cmt", 1001, 1005, "Lithology"),
)  # fmt: skip


def test_casings_and_mud_logs_are_tracks_of_their_own(tmp_path: Path) -> None:
    wall = copy.deepcopy(made())
    wall.intervals = (*NAMED, *PLACED)
    wall.save(tmp_path / "w.wall")
    assert set(hb.load(tmp_path / "w.wall").intervals) == {*NAMED, *PLACED}
    assert [row.interval for row in wall.interval_table().intervals] == list(NAMED), "only formations are measured"
    content = content_of(wall, Drawing(polar=(), body=()))
    sheet = Sheet(260, 500, 50)
    draw_tracks(sheet, content, content.top, content.bottom, 10)
    texts = [text.get_text() for text in sheet.figure.texts]
    assert {"Casing [mm]", "Lithology", "Surface", "340.0 mm"} <= set(texts)
    assert "Far" not in texts
    assert any("1 of 2 outside" in text for text in texts), "said where it is drawn"
    (casing,) = (track for track in content.tracks if getattr(track, "name", "") == "Casing")
    (axes,) = (axes for axes, track in zip(sheet.figure.axes, content.tracks, strict=False) if track is casing)
    walls = sorted(float(line.get_segments()[0][0][0]) for line in axes.collections[:2])
    assert walls == pytest.approx([-0.17, 0.17]), "to scale"
    assert all(line.get_segments()[0][1][1] == 1002 for line in axes.collections[:2]), "down to the shoe"
    table = _intervals(content)
    assert "340.0" in table
    assert "f to m gr &lt;b&gt;" in table
    assert "1 of 2 outside" in table


def test_a_template_places_a_track_of_intervals() -> None:
    wall = copy.deepcopy(made())
    wall.intervals = PLACED
    named = TemplateTrack("intervals", "Lithology", (), 192), TemplateTrack("image", "Radius")
    template = Template(track=(TemplateTrack("caliper"), *named, TemplateTrack("intervals", "Shows")))
    found = content_of(wall, Drawing(template=template, polar=(), body=())).tracks
    assert [getattr(track, "name", None) or type(track).__name__ for track in found] == [
        "DepthTrack", "Casing", "CaliperTrack", "Lithology", "ImageTrack",
    ]  # fmt: skip
    assert found[3].width == pytest.approx(50.8)


def test_intervals_in_a_wrong_unit_get_a_sentence_and_the_rest_is_drawn() -> None:
    wall = copy.deepcopy(made())
    wall.intervals = (hb.Interval("A", 305, 306, "Lithology"), hb.Interval("B", 306, 307, "Lithology"))
    content = content_of(wall, Drawing(polar=(), body=()))
    sheet = Sheet(260, 500, 50)
    draw_tracks(sheet, content, content.top, content.bottom, 10)
    words = " ".join(text.get_text() for text in sheet.figure.texts)
    assert "none of 2" in words
    assert "unit right?" in words


@pytest.mark.parametrize(
    ("values", "part"),
    [
        ({"diameter": 9.625, "track": "Casing"}, "at most 2 m"),
        ({"diameter": 0.2}, "track must be given"),
        ({"track": 7}, "track"),
    ],
)
def test_a_casing_keeps_its_rules(values: dict[str, object], part: str) -> None:
    with pytest.raises(hb.InputError, match=part):
        hb.Interval("A", 0, 10, **values)  # type: ignore[arg-type]


def test_one_command_from_tops_to_a_table(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    bare = copy.deepcopy(made())
    bare.intervals = ()
    bare.save("w.wall")
    Path("tops.csv").write_text("Surface,MD\nUpper,995\nLower,1003\n")
    done = run("logs", "w.wall", "-o", "l.csv", "--interval-table", "i.csv")
    assert "--intervals" in done.output
    done = run("logs", "w.wall", "-o", "l.csv", "--intervals", "tops.csv", "--interval-table", "i.csv")
    assert "intervals.unit" in done.output
    words = ("--intervals", "tops.csv", "-s", "intervals.unit=m")
    done = run("logs", "w.wall", "-o", "l.csv", "--interval-table", "i.csv", *words)
    assert done.exit_code == 0, done.output
    rows = list(csv.DictReader(Path("i.csv").read_text().splitlines()))
    assert [row["INTERVAL"] for row in rows] == ["Upper", "Lower"]
    assert float(rows[1]["DMEAN (m)"]) == pytest.approx(LOWER, abs=1e-3)
    assert "names Surface, depths MD, in m" in " ".join(done.output.split())
    assert "Lower, 1003.00 m to the bottom: mean" in " ".join(done.output.split())
    again = run("logs", "l.csv.toml", "-o", "l2.csv", "-q")
    assert again.exit_code == 0, again.output
    Path("p.toml").write_text('archive = "w.wall"\nintervals = {file = "tops.csv", unit = "m"}\n')
    assert run("logs", "p.toml", "-o", "l.csv", "--interval-table", "j.csv", "-q").exit_code == 0
    assert Path("j.csv").read_text() == Path("i.csv").read_text()
    Path("casing.csv").write_text("Casing,Shoe (m),OD (in)\nSurface,1002,13 3/8\n")
    Path("p.toml").write_text('archive = "w.wall"\nintervals = ["tops.csv", "casing.csv"]\n')
    done = run("logs", "p.toml", "-o", "l.csv", "--interval-table", "j.csv", "-s", "intervals.unit=m")
    assert done.exit_code == 0, done.output
    assert "1 of casing.csv" in done.output
    assert Path("j.csv").read_text() == Path("i.csv").read_text()

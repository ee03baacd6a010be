"""The report: one page that needs nothing else, whose tables hold what an independent loop finds."""

from __future__ import annotations

import base64
import copy
import html
import io
import math
import re
from html.parser import HTMLParser
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from golden_texts import Golden
from screen import NEEDS_BROWSER, new_tab

import helibore as hb
from helibore.cli import cli
from helibore.logs.turn_logs import NO_UNCERTAINTY
from helibore.logs.zones import SIZES
from helibore.plot import log
from helibore.plot.content import Drawing, content_of
from helibore.plot.html_report import intervals, largest_gaps, number, page, report
from helibore.plot.print_header import sentence
from helibore.simulation.tool import Hole, Tool, simulate

BIT = 0.216


@pytest.fixture(scope="module")
def wall() -> hb.Wall:
    """30 m with a washout, breakouts, and a gap of 4 m."""
    run = simulate(Hole.example(2000.0, 2030.0), Tool(sample_rate=5.0))
    there = (run.depth < 2012) | (run.depth > 2016)
    made = hb.reconstruct(
        hb.Caliper(run.depth[there], run.toolface[there], run.radius[there]), bit_diameter=BIT, sectors=32
    )
    made.images["GR"] = hb.SectorImage(run.gamma_depth, run.gamma, "GR", "gAPI", origin="edge", reference="high-side")
    return made


@pytest.mark.parametrize("unit", [1.0, 0.3048])
@pytest.mark.parametrize("length", [2.0, 20.0, 100.0])
def test_no_row_of_the_table_of_diameters_is_empty(unit: float, length: float) -> None:
    """Whatever multiple of the unit an interval starts at, its first row does not end there."""
    for tenths in range(20000, 20500):
        top = tenths / 10 * unit
        content = SimpleNamespace(top=top, bottom=top + length * unit, summary=lambda start, stop: (start, stop))
        content.drawing = SimpleNamespace(depth_unit=SimpleNamespace(metres=unit))
        rows: Any = intervals(content)  # type: ignore[arg-type]
        assert min(stop - start for start, stop in rows) > 0.01 * unit
        assert [stop for _, stop in rows[:-1]] == [start for start, _ in rows[1:]]
        assert (rows[0][0], rows[-1][1]) == (content.top, content.bottom)


class Balanced(HTMLParser):
    """Checks that every element is closed in order, and collects what the page would load."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.loads: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.loads += [value or "" for name, value in attrs if name in ("src", "href", "srcset", "action")]
        if tag not in ("meta", "img"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_the_page_is_whole_and_needs_nothing_else(wall: hb.Wall) -> None:
    text = page(wall, [("dropped", "7 rows <b>")], title="Well <script>", subtitle='"&', dpi=40)
    parser = Balanced()
    parser.feed(text)
    assert not parser.open
    assert all(load.startswith(("data:image/png;base64,", "#")) for load in parser.loads)
    without_pictures = re.sub(r"data:image/png;base64,[A-Za-z0-9+/=]+", "", text)
    assert not re.search(r"https?:|//|@import|url\(", without_pictures)
    assert "Well &lt;script&gt;" in text
    assert "7 rows &lt;b&gt;" in text
    assert "<script" not in text
    pictures = [base64.b64decode(load[22:]) for load in parser.loads if load.startswith("data:")]
    assert pictures
    assert all(picture.startswith(b"\x89PNG") for picture in pictures)
    for heading in ("Summary", "Pictures", "Diameters and volumes", "Zones", "Data quality", "Settings"):
        assert f"<h2>{heading}</h2>" in text
    for words in (
        "radius measured by an azimuthal caliper",
        "breakout",
        "criterion washout",
        "Largest gaps",
        "neighbors",
    ):
        assert words in text


def cells(text: str) -> list[str]:
    """The texts of a page, without its pictures."""
    return [html.unescape(one).strip() for one in re.findall(r">([^<]+)<", re.sub(r"data:[^\"]*", "", text))]


def test_tables_have_the_unit_of_the_diameters(wall: hb.Wall) -> None:
    content = content_of(wall, Drawing(polar=(), body=()))
    inch, metric = (cells(page(wall, dpi=40, polar=(), body=(), unit=unit)) for unit in ("in", "mm"))
    inch, metric = ([text.replace("\u00ad", "") for text in found] for found in (inch, metric))
    assert {"Mean [in]", "Least [in]", "Greatest [in]", "Enlargement [in]", "Elongation [in]"} <= set(inch)
    assert {"Mean [mm]", "Least [mm]", "Greatest [mm]", "Enlargement [mm]", "Elongation [mm]"} <= set(metric)
    assert not [text for text in metric if "[in]" in text]
    note = next(text for text in inch if text.startswith("Worst first"))
    assert all(f"{name.capitalize()}: {text}.".replace(" - ", " − ") in note for name, text in SIZES.items())
    row = intervals(content)[0]
    assert {f"{row.mean_diameter / 0.0254:.3f}", f"{row.greatest_diameter.value / 0.0254:.3f}"} <= set(inch)
    assert {f"{row.mean_diameter * 1e3:.1f}", f"{row.greatest_diameter.value * 1e3:.1f}"} <= set(metric)


def test_sizes_of_the_summary_and_of_reach_are_in_the_units_of_the_picture(wall: hb.Wall) -> None:
    units = {"mm": ("mm", "m"), "in": ("in", "m"), "ft": ("in", "ft")}
    for unit, (size, depth) in units.items():
        shown = cells(page(wall, dpi=40, polar=(), body=(), unit=unit))
        for label in ("Diameter", "Nearest sample"):
            text = shown[shown.index(label) + 1]
            assert {"in", "mm"} & set(re.findall(r"[a-z]+", text)) == {size}
        pitch = wall.settings.pitch / {"m": 1.0, "ft": 0.3048}[depth]
        assert f"pitch {pitch:.4g} {depth}," in shown[shown.index("Helix") + 1]


def test_the_ends_of_a_volume_range_differ(wall: hb.Wall) -> None:
    shown = cells(page(wall, dpi=40, polar=(), body=(), unit="ft"))
    ranges = [text.split(" to ") for text in shown if re.fullmatch(r"\d\.\d+ to \d\.\d+", text)]
    assert ranges
    assert all(low != high for low, high in ranges)


def test_a_zone_has_its_extreme_and_the_depth_of_its_largest_diameter(wall: hb.Wall) -> None:
    found = wall.zones()
    worst = found.by_severity()[0]
    shown = cells(page(wall, dpi=40, polar=(), body=()))
    size = {"washout": "C2 − bit", "breakout": "C1 − C2"}[worst.kind] + f" {1000 * worst.measure:.1f} mm"
    at = shown.index(
        f"{worst.kind} {worst.confidence_text}, {size}, {worst.severity:.1f} ×, widest at {worst.peak:,.2f} m"
    )
    assert shown[at + 3 : at + 5] == [f"{1000 * size:.1f}" for size in (worst.enlargement, worst.elongation)]


def test_openings_that_a_tool_with_few_arms_does_not_know_are_a_dash() -> None:
    depth = np.repeat(np.arange(0, 3, 0.05), 4)
    toolface, arm = np.tile([0.0, 90.0, 180.0, 270.0], 60), np.tile([0, 1, 0, 1], 60)
    oval = hb.Caliper(depth, toolface, np.where(arm == 0, 0.125, 0.108), arm=arm)
    shown = cells(page(hb.reconstruct(oval, bit_diameter=BIT), dpi=40, polar=(), body=()))
    at = next(number for number, text in enumerate(shown) if "C1 − C2 34.0 mm" in text)
    assert shown[at + 5 : at + 7] == ["0", "–"], "nor is there a spread of arms that do not turn"


def test_a_report_without_zones_states_the_criteria_that_nothing_meets() -> None:
    """9.4 mm over bit all along: no washout by 0.5 in, and not of bit size either."""
    wide = hb.Caliper(np.repeat(np.arange(0, 3, 0.02), 36), np.tile(np.arange(36) * 10.0, 150), np.full(5400, 0.1127))
    wall = hb.reconstruct(wide, bit_diameter=BIT)
    criteria = (
        "washout C2 − bit at least 0.5 in, breakout C1 − C2 at least 1 in, key seat height at least 0.25 in, "
        "undergauge least diameter − bit below −0.25 in; over at least 0.3 m of hole"
    )
    shown = cells(page(wall, unit="in", dpi=40, polar=(), body=()))
    assert f"None. Criteria: {criteria}. No measured part of the hole meets one of these criteria." in shown
    assert "none by the criteria at the foot" in shown
    words = [text.get_text() for text in log(wall, unit="in", polar=(), body=()).texts]
    assert f"Criteria: {criteria}" in words


def test_settings_have_units_and_say_each_thing_once(wall: hb.Wall, golden: Golden) -> None:
    shown = cells(page(wall, dpi=40, polar=(), body=()))
    rows = shown[shown.index("bit diameter") :]
    table = dict(zip(rows[0::2], rows[1::2], strict=False))
    assert {name: table[name] for name in ("bit diameter", "pitch", "max distance", "start toolface", "tolerance")} == {
        "bit diameter": "0.216 m", "pitch": "0.1 m", "max distance": "1 m", "start toolface": "0 deg",
        "tolerance": "1e-06 m",
    }  # fmt: skip
    assert (table["start depth"], table["window"], table["direct"]) == ("that of the samples", "all samples", "no")
    golden(table["toolface 0"])  # as the image says, and the picture
    golden(table["class"])
    assert rows.count("bit diameter") == rows.count("pitch") == 1
    assert not {"None", "False"} & set(shown)
    made = hb.reconstruct(wall.samples, bit_diameter=BIT, sectors=8)
    made.made_from = {"files": [{"name": "a.csv", "blake2b": "f00d"}], "by": "me"}
    shown = cells(page(made, dpi=40, polar=(), body=()))
    assert shown[shown.index("made from") + 1] == "a.csv, BLAKE2b f00d"
    assert shown[shown.index("made from: by") + 1] == "me"


def test_settings_of_several_numbers_are_listed(wall: hb.Wall) -> None:
    """A wall with near and far neighbours has a covariance."""
    covariance = (0.109, 1e-7, 1e-6, 0.05, 0.06, 4e-6, -0.1, 0.6)
    made = hb.reconstruct(
        wall.samples, bit_diameter=BIT, estimator="near-and-far", covariance=covariance, sectors=32, pitch=0.5
    )
    assert ", ".join(f"{of:.10g}" for of in covariance) in page(made, dpi=40, polar=(), body=())


def test_no_number_is_minus_nought() -> None:
    assert (number(-0.0004), number(-0.04, 1), number(-0.06, 1), number(math.nan)) == ("0.000", "0.0", "-0.1", "")


def test_intervals_against_a_loop(wall: hb.Wall) -> None:
    content = content_of(wall, Drawing(polar=(), body=()))
    rows = intervals(content)
    assert (rows[0].start, rows[-1].stop) == (content.top, content.bottom)
    assert all(one.stop == other.start for one, other in pairwise(rows))
    K, pitch, radius = wall.settings.sectors, wall.settings.pitch, wall.radius
    for row in rows:
        volume, whole, count = 0.0, 0, 0
        for turn in range(radius.size // K):
            one = radius[turn * K : (turn + 1) * K]
            if row.start <= wall.depth[turn * K : (turn + 1) * K].mean() < row.stop:
                count += 1
                if np.isfinite(one).all():
                    whole += 1
                    volume += math.pi * float(np.mean(one**2)) * pitch
        assert row.whole_turns / (row.whole_turns + row.incomplete_turns) == pytest.approx(whole / count)
        if whole:
            assert row.volume == pytest.approx(volume)
            assert row.excess == pytest.approx(volume / (whole * pitch * math.pi * BIT**2 / 4) - 1)
        else:
            assert (row.volume, math.isnan(row.excess)) == (0, True)


def test_the_largest_gap_is_found(wall: hb.Wall) -> None:
    gaps = largest_gaps(content_of(wall, Drawing(polar=(), body=())).turns, wall.settings.pitch)
    # No sample from 2012 to 2016 m: a vertex within max_distance of one, a metre, has a radius.
    assert gaps[0][0] == pytest.approx(2013.0, abs=0.2)
    assert gaps[0][1] == pytest.approx(2015.0, abs=0.2)


def test_a_wall_that_was_not_measured_says_so() -> None:
    wall = hb.reconstruct(hb.Caliper.gauge(10.0, 15.0, BIT), bit_diameter=BIT, sectors=8)
    text = page(wall, dpi=40)
    assert '<p class="warning">gauge hole at bit size: not measured.</p>' in text
    assert "The hole was not measured." in text


def test_report_on_the_command_line(wall: hb.Wall, tmp_path: Path, golden: Golden) -> None:
    wall.save(tmp_path / "well.wall")
    arguments = ["report", str(tmp_path / "well.wall"), "--dpi", "40", "--header", "well=W-1", "-o"]
    result = CliRunner().invoke(cli, [*arguments, str(tmp_path / "well.html")])
    assert result.exit_code == 0, result.output
    text = (tmp_path / "well.html").read_text(encoding="utf-8")
    assert "<title>W-1</title>" in text
    assert "well.wall: archive of a wall" in text
    refused = CliRunner().invoke(cli, [*arguments, str(tmp_path / "well.txt")])
    assert refused.exit_code == 2
    golden(refused.stderr)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["well.html", "well.html.toml", "well.wall"]


def test_an_old_report_outlives_an_error(wall: hb.Wall, tmp_path: Path, golden: Golden) -> None:
    (tmp_path / "well.html").write_text("old")
    with golden.raises():
        report(wall, tmp_path / "well.html", start=1, stop=2)
    assert (tmp_path / "well.html").read_text() == "old"
    assert len(list(tmp_path.iterdir())) == 1


@NEEDS_BROWSER[0]
@NEEDS_BROWSER[1]
@pytest.mark.parametrize(("unit", "width"), [("in", 1200), ("mm", 1200), ("in", 390)])
def test_no_table_is_wider_than_its_page(unit: str, width: int, wall: hb.Wall, browser: Any, tmp_path: Path) -> None:
    report(wall, tmp_path / "well.html", dpi=40, polar=(), body=(), unit=unit)
    shown = new_tab(browser)
    shown.set_viewport_size({"width": width, "height": 900})
    shown.goto((tmp_path / "well.html").as_uri())
    over = "[...document.querySelectorAll('table')].map((one) => one.offsetWidth - one.parentElement.offsetWidth)"
    found = shown.evaluate(over)
    shown.close()
    assert len(found) > 4
    assert max(found) <= 0


@NEEDS_BROWSER[0]
@NEEDS_BROWSER[1]
@pytest.mark.parametrize("unit", ["in", "mm", "ft"])
def test_in_print_the_table_of_formations_is_no_wider_than_a4(
    unit: str, wall: hb.Wall, browser: Any, tmp_path: Path
) -> None:
    """A browser shrinks all pages to the widest thing on one, and the depth scale of the pictures is no longer true."""
    with_tops = copy.copy(wall)
    with_tops.intervals = [hb.Interval("Lower Draupne Formation", 2001.0, 2011.0), hb.Interval("Heather", 2011.0)]
    report(with_tops, tmp_path / "well.html", dpi=40, polar=(), body=(), unit=unit)
    shown = new_tab(browser)
    shown.set_viewport_size({"width": round(210 / 25.4 * 96), "height": 1123})
    shown.emulate_media(media="print")
    shown.goto((tmp_path / "well.html").as_uri())
    over = "[...document.querySelectorAll('table')].map((one) => one.offsetWidth - one.parentElement.offsetWidth)"
    found = shown.evaluate(over)
    heads = shown.evaluate("document.querySelector('#intervals thead').textContent").replace("\u00ad", "")
    shown.close()
    assert len(found) > 5
    assert max(found) <= 0
    assert {"Least", "Greatest", "Inscribed", "Washout", "Undergauge"} <= set(re.findall(r"[A-Z][a-z]+", heads))


def test_a_tool_with_few_arms_has_its_share_of_the_turns_and_hatched_pictures() -> None:
    from matplotlib.image import imread

    from helibore.plot.hatching import HATCH_BYTES

    depth = np.repeat(np.arange(2000, 2003, 0.05), 4)
    arm = np.tile([0, 1, 0, 1], depth.size // 4)
    toolface = (np.tile([0, 90, 180, 270], depth.size // 4) + 12 * depth) % 360
    made = hb.reconstruct(hb.Caliper(depth, toolface, np.full(depth.size, 0.11), arm=arm), bit_diameter=BIT)
    text = page(made, dpi=60, polar=(), body=())
    share = 100 * np.mean(made.logs().coverage)
    assert 5 < share < 30
    assert cells(text).count(f"{share:.2f} % of the turns; the rest is interpolated between arms") == 2
    assert cells(text).count(NO_UNCERTAINTY) == 2  # a warning of the summary, and among the facts of the zones
    assert f"<p>{sentence(NO_UNCERTAINTY)}</p>" in text  # below the table of volumes
    (picture,) = re.findall(r"data:image/png;base64,([A-Za-z0-9+/=]+)", text)
    pixels = np.round(imread(io.BytesIO(base64.b64decode(picture)))[..., :3] * 255)
    assert (pixels == np.array(HATCH_BYTES)[:3]).all(axis=2).sum() > 300

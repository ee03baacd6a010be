"""Cards of notebooks: small, alone, and true to the numbers."""

from __future__ import annotations

import base64
import re
import struct
import zlib
from functools import cache
from xml.etree import ElementTree

import numpy as np
import pytest

import helibore as hb
from helibore.base.colors import MISSING
from helibore.base.notebook import curve_picture, map_picture
from helibore.plot.content import Drawing, content_of


@cache
def everything():
    k = np.arange(40_000)
    caliper = hb.Caliper(1000 + k * 0.0005, k * 37.0, 0.11 + 0.004 * np.sin(k / 900))
    wall = hb.reconstruct(caliper, bit_diameter=0.216)
    survey = hb.Survey([0, 500, 1000, 1100], [0, 10, 40, 60], [10, 20, 30, 40])
    image = hb.SectorImage(1000 + np.arange(300) * 0.1, np.random.default_rng(3).uniform(0, 150, (300, 16)), "GR",
                           "gAPI", origin="edge", reference="north")  # fmt: skip
    tuning = hb.tune(hb.Caliper(caliper.depth[::8], caliper.toolface[::8], caliper.radius[::8]),
                     bit_diameter=0.216, targets=100)  # fmt: skip
    washed = hb.Caliper(caliper.depth, caliper.toolface, caliper.radius + 0.03 * (caliper.depth > 1015))
    zones, summary = hb.reconstruct(washed, bit_diameter=0.216).zones(), wall.summary()
    return {
        "wall": wall,
        "logs": wall.logs(),
        "zones": zones,
        "summary": summary,
        "caliper": caliper,
        "survey": survey,
        "image": image,
        "tuning": tuning,
    }


@pytest.mark.parametrize("name", everything())
def test_a_card_is_small_and_needs_nothing_else(name):
    html = everything()[name]._repr_html_()
    assert 500 < len(html.encode()) < 30_000
    assert not re.search(r"https?://|url\(|<script|<link| id=| class=", html)
    assert "nan" not in re.sub(r"base64,[^\"]+", "", html)


def test_a_tuning_shows_what_it_chose_and_every_candidate():
    tuning = everything()["tuning"]
    html = tuning._repr_html_()
    assert tuning.best.name in html
    assert f"{1e3 * tuning.best.box:.3g} mm" in html
    assert html.count("<circle") == 2 * len(tuning.candidates)


def test_empty_things_have_a_card():
    assert "Wall(empty)" in hb.Wall(bit_diameter=0.2)._repr_html_()
    assert "no samples" in hb.Caliper([], [], [])._repr_html_()


def test_zones_say_how_many_and_which_is_worst():
    zones = everything()["zones"]
    html, worst = zones._repr_html_(), max(zones.zones, key=lambda zone: zone.severity)
    assert f"{len(zones.of('washout'))} zone, {sum(zone.length for zone in zones.of('washout')):.1f} m" in html
    assert f"{worst.kind} ({worst.confidence_text}) {worst.start:.2f} to {worst.stop:.2f} m" in html


def test_the_wall_says_what_its_summary_says():
    wall = everything()["wall"]
    for html in (wall._repr_html_(), wall.summary()._repr_html_()):
        assert f"{wall.summary().mean_diameter * 1000:.1f} mm" in html
        assert f"at {wall.summary().greatest_diameter.depth:.2f} m" in html


def pixels_of(html):
    source = re.search(r"base64,([^\"]+)", html)
    png = base64.b64decode(source[1])
    width, height = struct.unpack(">2I", png[16:24])
    start = png.index(b"IDAT")
    size = struct.unpack(">I", png[start - 4 : start])[0]
    pixels = np.frombuffer(zlib.decompress(png[start + 4 : start + 4 + size]), np.uint8).reshape(height, -1)
    return pixels[:, 1:].reshape(height, width, 3)


def test_a_card_has_the_colours_of_the_print():
    wall, image = everything()["wall"], everything()["image"]
    wall.images["GR"] = image
    content = content_of(wall, Drawing(polar=(), body=(), unit="mm"))
    radius, gamma = (track.shown.scale for track in content.tracks[2:])
    over = (wall.radius - 0.108) * 1000
    assert (pixels_of(wall._repr_html_())[0, :64] == radius.colors(over[:64])[:, :3]).all()
    assert (pixels_of(image._repr_html_())[0, :16] == gamma.colors(image.values[0])[:, :3]).all()
    wall.images.clear()


def test_a_card_of_samples_says_how_many_rows_were_left_out():
    frame = {"DEPTH": [1.0, 1.1, 1.2], "TOOLFACE": [0.0, 90.0, 180.0], "RADIUS": [0.1, np.nan, 0.1]}
    assert "a value in 1 of the table&#x27;s rows" in hb.Caliper.from_table(frame)._repr_html_()
    assert "missing" not in hb.Caliper([1.0], [0.0], [0.1])._repr_html_()


def test_a_card_of_samples_says_how_many_repeat_others():
    columns = [[1.0, 1.1, 1.0, 1.0], [0.0, 90.0, 0.0, 0.0], [0.1, 0.1, 0.1, 0.1]]
    caliper = hb.Caliper(*columns)
    assert caliper.repeated == 2
    assert "2 equal to an earlier sample, counted again, since there is no time" in caliper._repr_html_()
    timed = hb.Caliper(*columns, time=[0.0, 0.0, 0.0, 1.0])
    assert timed.repeated == 1
    assert "1 equal to an earlier sample, counted once" in timed._repr_html_()
    assert "repeated" not in hb.Caliper([1.0], [0.0], [0.1])._repr_html_()


def test_a_map_has_the_colours_of_its_cells():
    values = np.array([[0.0, 1.0, np.nan], [1.0, 0.0, 1.0]])
    pixels = pixels_of(map_picture(values, None, "a map"))
    assert tuple(pixels[0, 2]) == MISSING
    assert (pixels[0, 0] == pixels[1, 1]).all()
    assert (pixels[0, 1] == pixels[1, 0]).all()
    assert (pixels[0, 0] != pixels[0, 1]).any()


def test_a_curve_breaks_where_a_value_is_missing():
    svg = ElementTree.fromstring(curve_picture(np.array([1.0, 2, np.nan, 3, 4]), np.arange(5.0), "a <curve>"))
    assert re.sub("[0-9. ]", "", svg.find("path").get("d")) == "MLML"
    assert svg.find("title").text == "a <curve>"
    assert curve_picture(np.array([np.nan]), np.array([1.0]), "none") == ""

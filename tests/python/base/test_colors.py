"""Colour maps and scales: lightness, distance from the grey, limits, logarithms, and that page and meshes agree."""

from __future__ import annotations

import json
import shutil
import subprocess

import numpy as np
import pytest
from golden_texts import Golden
from locations import WEB
from patience import PATIENCE

from helibore.base.colors import COLOR_MAPS, MISSING, ColorScale, color_table, colors_of, customary_map

# Machado, Oliveira and Fernandes 2009, severity 1, on linear light.
WEAKNESS = {
    "protan": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "deutan": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
}


def linear(colors: np.ndarray) -> np.ndarray:
    share = colors[..., :3] / 255.0
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def lab(light: np.ndarray) -> np.ndarray:
    """CIELAB of linear sRGB, D65."""
    to_xyz = [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
    xyz = light @ np.array(to_xyz).T / [0.95047, 1.0, 1.08883]
    f = np.where(xyz > 216 / 24389, np.cbrt(xyz), (24389 / 27 * xyz + 16) / 116)
    return np.stack([116 * f[..., 1] - 16, 500 * (f[..., 0] - f[..., 1]), 200 * (f[..., 1] - f[..., 2])], axis=-1)


@pytest.mark.parametrize("name", COLOR_MAPS)
def test_no_map_comes_near_the_grey_of_what_is_missing(name: str) -> None:
    away = np.linalg.norm(lab(linear(color_table(name, 1024))) - lab(linear(np.array(MISSING))), axis=1)
    assert away.min() > 15, "a just noticeable difference is about 2"


ZONES = json.loads((WEB.parents[1] / "base" / "color_maps.json").read_text())["zones"]
DIVERGING = ("difference", "over-bit", "over-bit-dark")


@pytest.mark.parametrize("weakness", WEAKNESS)
@pytest.mark.parametrize("name", DIVERGING[1:])
def test_both_sides_of_the_bit_keep_their_order_for_weak_eyes(name: str, weakness: str) -> None:
    seen = np.clip(linear(color_table(name, 31)) @ np.array(WEAKNESS[weakness]).T, 0, 1)
    steps = np.diff(lab(seen)[:, 0]) * (-1 if name == "over-bit" else 1)
    assert (steps[:15] < 0.5).all()
    assert (steps[15:] > -0.5).all()


@pytest.mark.parametrize("name", DIVERGING[1:])
def test_hole_that_is_tight_is_no_fainter_than_hole_that_is_wide_by_as_much(name: str) -> None:
    light = lab(linear(color_table(name, 101)))[:, 0]
    away = abs(light - light[50])
    assert (away[50::-1] >= away[50:] - 0.5).all(), "the string sticks in the tight one"
    assert away[31] > 1.2 * away[69], "tight hole differs by less from the bit than wide hole does"


@pytest.mark.parametrize("dark", [False, True])
def test_zones_that_are_tight_are_no_fainter_than_those_that_are_wide(dark: bool) -> None:
    paper = 0.0091 if dark else 0.91  # luminance of the page, #14181c and #f4f5f6

    def contrast(kind: str) -> float:
        color = np.array(list(bytes.fromhex(ZONES[kind][dark])))
        luminance = float(linear(color) @ [0.2126, 0.7152, 0.0722])
        return (max(luminance, paper) + 0.05) / (min(luminance, paper) + 0.05)

    assert contrast("undergauge") >= contrast("washout")


@pytest.mark.parametrize("name", [name for name in COLOR_MAPS if name not in DIVERGING])
def test_lightness_goes_one_way(name: str) -> None:
    steps = np.diff(lab(linear(color_table(name, 64)))[:, 0])
    assert (steps > 0).all() or (steps < 0).all()


@pytest.mark.parametrize("weakness", WEAKNESS)
@pytest.mark.parametrize("name", [name for name, of in COLOR_MAPS.items() if of.safe])
def test_a_safe_map_keeps_its_order_for_weak_eyes(name: str, weakness: str) -> None:
    seen = np.clip(linear(color_table(name, 32)) @ np.array(WEAKNESS[weakness]).T, 0, 1)
    steps = np.diff(lab(seen)[:, 0])
    assert (steps > 0.5).all() or (steps < -0.5).all()


def test_conductive_shale_and_enlarged_are_dark() -> None:
    ends = {name: lab(linear(color_table(name, 2)))[:, 0] for name in COLOR_MAPS}
    for name, low_is_dark in (("resistivity", True), ("image", True), ("gamma", False), ("caliper", False)):
        assert (ends[name][0] < ends[name][1]) == low_is_dark, name
    assert {name: customary_map(name) for name in ("GR", "RES", "ABDC", "radius")} == {
        "GR": "gamma",
        "RES": "resistivity",
        "ABDC": "image",
        "radius": "caliper",
    }
    assert customary_map("X", "gAPI") == "gamma"
    assert customary_map("APRA", "OHMM") == "resistivity"


@pytest.mark.skipif(shutil.which("node") is None, reason="Node.js is not here: the page's colours cannot be asked")
def test_the_page_has_the_same_colours() -> None:
    script = """
        import { MAPS, lookup } from './src/color.js';
        console.log(JSON.stringify(Object.fromEntries(Object.keys(MAPS).map((n) => [n, [...lookup(n)]]))));
    """
    node = shutil.which("node")
    assert node is not None
    run = subprocess.run(
        [node, "--input-type=module", "-e", script],
        cwd=WEB,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=True,
    )
    page = json.loads(run.stdout)
    assert list(page) == list(COLOR_MAPS)
    for name, table in page.items():
        own = np.column_stack([color_table(name, 256), np.full(256, 255, np.uint8)])
        assert np.array(table).reshape(256, 4).tolist() == own.tolist(), name


def test_a_scale_spans_its_ends_and_clips_beyond() -> None:
    scale = ColorScale(0.0, 10.0, "gamma")
    values = np.array([[-5.0, 0.0, 5.0], [10.0, 99.0, np.nan]])
    assert scale.share(values)[0].tolist() == [0, 0, 0.5]
    colors = scale.colors(values)
    assert colors.shape == (2, 3, 4)
    assert colors[0, 0].tolist() == colors[0, 1].tolist() == [*COLOR_MAPS["gamma"].stops[0], 255]
    assert colors[1, 0].tolist() == colors[1, 1].tolist() == [*COLOR_MAPS["gamma"].stops[-1], 255]
    assert colors[1, 2].tolist() == [*MISSING, 255]
    turned = ColorScale(0.0, 10.0, "gamma", reverse=True)
    assert turned.colors(values)[0, 0].tolist() == [*COLOR_MAPS["gamma"].stops[-1], 255]


def test_a_log_scale_puts_ten_midway_from_one_to_a_hundred() -> None:
    scale = ColorScale(1, 100, "resistivity", log=True)
    np.testing.assert_allclose(scale.share(np.array([1.0, 10.0, 100.0, np.nan])), [0, 0.5, 1, np.nan])
    assert colors_of(np.array([1.0, 10.0, 100.0]), log=True)[1].tolist() == pytest.approx(
        [*color_table("viridis", 1023)[511].tolist(), 255], abs=1
    )


def test_matplotlib_draws_the_same_colours() -> None:
    pytest.importorskip("matplotlib")
    scale = ColorScale(0, 10, "image", reverse=True)
    cmap, norm = scale.matplotlib()
    values = np.linspace(0, 10, 41)
    drawn = np.rint(np.array(cmap(norm(values))) * 255)
    assert np.abs(drawn - scale.colors(values)).max() <= 2
    masked = cmap(norm(np.ma.masked_invalid([np.nan])))[0]
    assert np.rint(255 * np.array(masked[:3])).tolist() == list(MISSING)
    assert ColorScale(1, 10, log=True).matplotlib()[1](10**0.5) == pytest.approx(0.5)


@pytest.mark.parametrize(
    "arguments",
    [
        (0, 1, "jet"),
        (5, 5),
        (0, np.inf),
        (0, 20, "resistivity", True),
    ],
)
def test_a_scale_without_sense_is_refused(arguments: tuple, golden: Golden) -> None:
    with golden.raises():
        ColorScale(*arguments)


def test_negative_resistivity_has_no_colour_on_a_log_scale() -> None:
    values = np.array([[1.0, np.nan], [-2.0, 0.0]])
    text = r"^values\[1, 0\] = -2: must be above 0 on a log scale \(2 of 4 are not\); make them NaN to show"
    with pytest.raises(ValueError, match=text):
        ColorScale(1, 10, log=True).colors(values)
    with pytest.raises(ValueError, match=text):
        colors_of(values, log=True)

"""Pixels of pictures, of walls and of images, against slow loops."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from plotted_wall import BIT, image_of

import helibore as hb
from helibore.plot.raster import Grid, at_points, unroll_image, unroll_wall


@st.composite
def helices(draw: st.DrawFn) -> tuple[Any, float, np.ndarray]:
    K = draw(st.integers(3, 9))
    pitch = draw(st.sampled_from([0.1, -0.1, 0.37]))
    turns = draw(st.integers(1, 12))
    settings = hb.Settings(bit_diameter=BIT, sectors=K, pitch=pitch, start_toolface=draw(st.sampled_from([0.0, 33.0])))
    values = np.array(draw(st.lists(st.floats(0, 9), min_size=K * turns, max_size=K * turns)))
    missing = draw(st.lists(st.booleans(), min_size=values.size, max_size=values.size))
    return settings, draw(st.sampled_from([0.0, 50.3])), np.where(missing, np.nan, values)


@given(helices(), st.integers(1, 40), st.integers(12, 30), st.sampled_from([0.0, 90.0, 180.0]))
def test_pixels_of_a_wall_are_means_of_the_vertices_in_them(
    helix: tuple[Any, float, np.ndarray], rows: int, columns: int, left: float
) -> None:
    settings, start, values = helix
    K, pitch = settings.sectors, settings.pitch
    ends = sorted((start - 0.217, start + pitch * values.size / K + 0.2))
    grid = Grid(ends[0], ends[1], rows, columns, left)
    found = unroll_wall(values, settings, start, grid)
    height = (ends[1] - ends[0]) / rows
    for row in range(rows):
        for column in range(columns):
            toolface = left + (column + 0.5) * 360 / columns - settings.start_toolface
            j = math.floor(toolface * K / 360 + 0.5) % K
            if abs(toolface * K / 360 + 0.5 - round(toolface * K / 360 + 0.5)) < 1e-9:
                continue  # on a border both are right
            inside = [
                values[k]
                for k in range(j, values.size, K)
                if ends[0] + row * height + 1e-9 < start + k * pitch / K < ends[0] + (row + 1) * height - 1e-9
            ]
            near = [abs((start + k * pitch / K - ends[0]) / height % 1.0 - 0.5) for k in range(j, values.size, K)]
            if any(abs(one - 0.5) < 1e-6 for one in near):
                continue  # a vertex on the edge of a row
            if len(inside) < 2:
                middle = (ends[0] + (row + 0.5) * height - start) / pitch - j / K
                if abs(middle + 0.5 - round(middle + 0.5)) < 1e-9:
                    continue
                turn = math.floor(middle + 0.5)
                expected = values[turn * K + j] if 0 <= turn < values.size // K else np.nan
            else:
                there = [value for value in inside if not math.isnan(value)]
                expected = np.mean(there) if there and 2 * len(there) >= len(inside) else np.nan
            assert found[row, column] == pytest.approx(expected, nan_ok=True)


def test_a_page_has_the_pixels_of_the_roll() -> None:
    settings = hb.Settings(bit_diameter=BIT, sectors=8, pitch=-0.1)
    values = np.random.default_rng(3).random(8 * 300)
    image = hb.SectorImage(
        70 + 0.1 * np.arange(300), values.reshape(300, 8), "GR", reference="high-side", origin="edge"
    )
    whole = Grid(65.013, 105.013, 800, 16)  # no vertex lies on the border of a pixel
    roll = unroll_wall(values, settings, 100.0, whole), unroll_image(image, image.values, whole)
    for first in range(0, 800, 80):  # some of them beyond the ends of both
        page = Grid(65.013 + first * 0.05, 69.013 + first * 0.05, 80, 16)
        for part, all_of_it in zip(
            (unroll_wall(values, settings, 100.0, page), unroll_image(image, image.values, page)), roll, strict=True
        ):
            np.testing.assert_allclose(part, all_of_it[first : first + 80])


@pytest.mark.parametrize("origin", ["edge", "centre"])
@pytest.mark.parametrize("direction", ["clockwise", "counterclockwise"])
def test_pixels_of_an_image_are_its_cells(origin: str, direction: str) -> None:
    rng = np.random.default_rng(3)
    depth = np.array([10.0, 10.1, 10.2, 10.35, 11.0, 11.1])
    values = rng.random((6, 5))
    values[1, 2] = np.nan
    image = image_of(depth, values, origin=origin, direction=direction, offset=17.0, reach=0.08)
    grid = Grid(9.8, 11.3, 211, 47, 90.0)
    pixels = unroll_image(image, image.values, grid)
    settings = hb.Settings(bit_diameter=BIT, sectors=3)
    for row in range(0, 211, 3):
        for column in range(47):
            at, toolface = 9.8 + (row + 0.5) * 1.5 / 211, 90 + (column + 0.5) * 360 / 47
            turned = (toolface - 17) * (1 if direction == "clockwise" else -1) / 72 + (0.5 if origin == "centre" else 0)
            nearest = int(np.argmin(np.abs(depth - at)))
            expected = values[nearest, math.floor(turned) % 5] if abs(depth[nearest] - at) <= 0.08 else np.nan
            assert pixels[row, column] == pytest.approx(expected, nan_ok=True)
            point = at_points(image, image.values, np.array([at]), np.array([toolface]))
            assert point[0] == pytest.approx(expected, nan_ok=True)
    assert settings.sectors == 3
    coarse = unroll_image(image, image.values, Grid(9.9, 10.3, 1, 5, 0.0))
    assert np.isfinite(coarse).all()


def test_many_sectors_are_averaged_over_few_pixels() -> None:
    values = np.tile(np.arange(40.0), 6)
    settings = hb.Settings(bit_diameter=BIT, sectors=40)
    found = unroll_wall(values, settings, 0.0, Grid(0.15, 0.25, 1, 4, -4.5))
    assert found[0] == pytest.approx([4.5, 14.5, 24.5, 34.5])

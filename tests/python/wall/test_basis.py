"""Walls of wells without an azimuthal caliper: the size is right, gaps stay gaps, and everything says what it is."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np
import pytest
from golden_texts import Golden

import helibore as hb


def test_an_average_caliper_gives_a_round_wall_of_its_size() -> None:
    depth = np.arange(1000, 1020, 0.1)
    diameter = 0.22 + 0.002 * (depth - 1000)
    wall = hb.reconstruct(hb.Caliper.from_average(depth, diameter), bit_diameter=0.216, sectors=32)
    assert wall.basis == "average"
    assert (wall.support == 8).all()
    expected = np.interp(wall.depth, depth, diameter) / 2
    assert np.abs(wall.radius - expected).max() < 1e-4  # a tenth of what the diameter grows in a row, halved
    turns = wall.radius[: len(wall) // 32 * 32].reshape(-1, 32)
    assert np.ptp(turns, axis=1).max() < 2e-4


def test_missing_diameters_are_left_out_and_a_gap_stays_a_gap() -> None:
    depth = np.arange(0, 20, 0.25)
    diameter = np.where((depth > 5) & (depth < 15), np.nan, 0.25)
    caliper = hb.Caliper.from_average(depth[::-1], diameter[::-1])
    assert len(caliper) == 16 * np.isfinite(diameter).sum()
    wall = hb.reconstruct(caliper, bit_diameter=0.216)
    missing = np.isnan(wall.radius)
    assert missing[(wall.depth > 6.1) & (wall.depth < 13.9)].all()
    assert not missing[(wall.depth < 5.9) | (wall.depth > 14.1)].any()


def test_a_depth_of_an_average_caliper_that_is_not_finite_is_named_by_its_row(golden: Golden) -> None:
    with golden.raises():
        hb.Caliper.from_average([100.0, np.nan], [0.2, 0.2])
    assert len(hb.Caliper.from_average([100.0, np.nan], [0.2, np.nan])) == 16


def test_gauge_hole_is_exactly_at_bit_size_and_reaches_both_ends() -> None:
    caliper = hb.Caliper.gauge(100.0, 103.25, 0.216)
    assert (caliper.depth.min(), caliper.depth.max()) == (100.0, 103.25)
    wall = hb.reconstruct(caliper, bit_diameter=0.216)
    assert wall.basis == "gauge"
    assert (wall.radius == 0.108).all()
    assert wall.samples.basis == "gauge"


def test_a_wall_is_measured_unless_it_says_otherwise() -> None:
    assert hb.Wall(bit_diameter=0.2).basis == hb.Caliper([1.0], [0.0], [0.1]).basis == "azimuthal"
    assert hb.Wall(bit_diameter=0.2, basis="gauge").surface().basis == "gauge"
    assert "not measured" in repr(hb.Caliper.gauge(0, 1, 0.2))
    assert "measured" not in repr(hb.Caliper([1.0], [0.0], [0.1]))


@pytest.mark.parametrize("basis", ["average", "gauge"])
def test_files_say_what_the_wall_is_made_from(tmp_path: Path, basis: str) -> None:
    caliper = {"gauge": hb.Caliper.gauge(0, 2, 0.2), "average": hb.Caliper.from_average([0, 1, 2], [0.2, 0.2, 0.2])}
    surface = hb.reconstruct(caliper[basis], bit_diameter=0.2).surface()
    words = {"gauge": b"gauge hole at bit size: not measured", "average": b"average caliper: size measured"}[basis]
    for ending in ("ply", "obj", "stl", "glb"):
        surface.save(tmp_path / f"wall.{ending}")
    for ending in ("ply", "obj", "stl"):
        assert words in (tmp_path / f"wall.{ending}").read_bytes()[:400], ending
    content = (tmp_path / "wall.glb").read_bytes()
    scene = json.loads(content[20 : 20 + struct.unpack("<I", content[12:16])[0]])
    assert scene["meshes"][0]["extras"]["basis"] == basis


def test_everything_says_that_arms_measured_the_radius(tmp_path: Path) -> None:
    depth = np.repeat(np.arange(0, 3, 0.05), 4)
    arm = np.tile([0, 1, 0, 1], depth.size // 4)
    caliper = hb.Caliper(depth, 90.0 * np.arange(depth.size), np.full(depth.size, 0.1), arm=arm)
    words = "radius measured by the arms of a caliper"
    made = hb.reconstruct(caliper, bit_diameter=0.2)
    made.save(tmp_path / "arms.wall")
    for wall in (made, hb.load(tmp_path / "arms.wall")):
        logs, surface = wall.logs(), wall.surface()
        said = [caliper.table().facts["basis"], wall.basis_text, wall.summary().numbers()["basis"]]
        said += [logs.facts()["basis"], surface.metadata["basis"], wall.volume().metadata["basis"]]
        assert said == [words] * 6
        assert repr(logs) == f"Logs(29 turns, 0.0492188 to 2.84922 m, {words})"
        surface.save(tmp_path / "arms.stl")
        assert (tmp_path / "arms.stl").read_bytes()[:80] == f"helibore: {words}".encode().ljust(80)


def test_the_picture_says_that_the_shape_is_not_measured() -> None:
    pytest.importorskip("matplotlib")
    wall = hb.reconstruct(hb.Caliper.gauge(0, 2, 0.2), bit_diameter=0.2)
    values = np.arange(320.0).reshape(20, 16)
    wall.images["GR"] = hb.SectorImage(np.arange(20) * 0.1, values, "GR", origin="edge", reference="high-side")
    texts = [text.get_text() for text in hb.plot.overview(wall, dpi=40).texts]
    assert "gauge hole at bit size: not measured" in texts


@pytest.mark.parametrize(
    "call",
    [
        lambda: hb.Caliper.from_average([1, 2], [0.2, 8.5]),
        lambda: hb.Caliper.from_average([1, 2], [0.2, 0]),
        lambda: hb.Caliper.from_average([1, 2], [np.nan, np.nan]),
        lambda: hb.Caliper.from_average([1, 2], [0.2]),
        lambda: hb.Caliper.gauge(20, 10, 0.2),
        lambda: hb.Caliper.gauge(0, np.inf, 0.2),
        lambda: hb.Caliper.gauge(0, 10, 8.5),
        lambda: hb.Caliper.gauge(0, 10, 0.2, step=0),
        lambda: hb.Caliper([1], [0], [0.1], basis="guess"),
        lambda: hb.Wall(bit_diameter=0.2, basis="bit"),
    ],
)
def test_bad_input_is_named(call, golden: Golden) -> None:
    with golden.raises():
        call()

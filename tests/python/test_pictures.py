"""The shaded view against geometry, the overview against its own promises, the demo against the truth."""

from __future__ import annotations

import re
import sys
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
import trimesh
from click.testing import CliRunner

import helibore
from helibore.cli import cli
from helibore.demo import drill, error, rebuild
from helibore.pictures import Track, overview, save_png
from helibore.shading import View, shade
from helibore.simulate import Hole, Tool, simulate

SECTORS, PITCH, TURNS = 32, 0.1, 31


def shaded(radius: np.ndarray, colors: np.ndarray, pitch: float = PITCH, **view: float):  # type: ignore[no-untyped-def]
    seen = View(facing=90.0, width=200, height=420, **view)  # type: ignore[arg-type]
    return shade(radius, colors, SECTORS, pitch, (500.0, 0.0), 0.2, seen)


def round_hole() -> tuple[np.ndarray, np.ndarray]:
    """Radius 0.1 m; red from toolface 0, green from 120, blue from 240."""
    toolface = np.arange(SECTORS * (TURNS + 1)) % SECTORS * 360.0 / SECTORS
    return np.full(toolface.size, 0.1), np.eye(3)[(toolface // 120).astype(int)]


def test_round_hole_is_as_wide_and_long_as_it_should_be() -> None:
    picture = shaded(*round_hole(), tube=5.0, tilt=20.0)
    covered = picture.pixels[..., 3] > 0.5
    metres = (picture.right - picture.left) / 200
    rows = np.flatnonzero(covered.any(axis=1))
    middle = covered[210]
    assert middle.sum() * metres == pytest.approx(5.0 * 0.2, abs=2 * metres)
    depth = picture.top + (rows[[0, -1]] + [0, 1]) * (picture.bottom - picture.top) / 420
    overhang = 0.5 * np.tan(np.radians(20.0))  # the ends are ellipses, seen from above
    assert depth == pytest.approx([500.0 - overhang, 503.1 + overhang], abs=0.03)
    edges = [np.flatnonzero(line)[[0, -1]] for line in covered[rows[0] + 20 : rows[-1] - 20]]
    assert all(
        line[first : last + 1].all()
        for line, (first, last) in zip(covered[rows[0] + 20 : rows[-1] - 20], edges, strict=True)
    )


@pytest.mark.parametrize("pitch", [PITCH, -PITCH])
def test_toolface_grows_to_the_left_seen_from_the_formation(pitch: float) -> None:
    radius, colors = round_hole()
    line = shaded(radius, colors, pitch=pitch, tube=5.0).pixels[210]
    inside = np.flatnonzero(line[:, 3] > 0.99)
    named = np.argmax(line[inside, :3], axis=1)
    # Seen from toolface 90: the first green vertex, at 123.75, is to the left of the last red one, at 112.5.
    border = inside[np.flatnonzero(np.diff(named))]
    assert (named[0], named[-1]) == (1, 0)
    assert len(border) == 1
    centre, half = 100, 0.5 * inside.size
    assert (centre - border[0]) / half == pytest.approx(np.sin(np.radians(118.125 - 90.0)), abs=0.04)


def test_steep_wall_leaves_no_pixel_empty() -> None:
    radius, colors = round_hole()
    turn = np.arange(radius.size) / SECTORS
    radius = radius + 0.03 * (np.abs(turn - 16) < 4)
    picture = shaded(radius, colors, tube=8.0, shape=3.0)
    covered = picture.pixels[..., 3] > 0.5
    rows = np.flatnonzero(covered.any(axis=1))
    for line in covered[rows[0] + 15 : rows[-1] - 15]:
        first, last = np.flatnonzero(line)[[0, -1]]
        assert line[first : last + 1].mean() > 0.995


def test_overview_is_labelled_and_nothing_overlaps(tmp_path: Path) -> None:
    run = simulate(Hole.example(2000.0, 2014.0), Tool(sample_rate=5.0))
    wall = helibore.reconstruct(helibore.Caliper(run.depth, run.toolface, run.radius), bit_diameter=0.216)
    figure = overview(wall, Track(run.gamma_depth, run.gamma, "Gamma ray", "gAPI"), "A title", "A subtitle", dpi=60)
    save_png(figure, tmp_path / "p.png")
    assert [path.name for path in tmp_path.iterdir()] == ["p.png"]
    assert (tmp_path / "p.png").read_bytes().startswith(b"\x89PNG")
    texts = [text for text in figure.findobj(lambda artist: hasattr(artist, "get_text")) if text.get_text().strip()]
    words = " ".join(text.get_text() for text in texts)
    for label in (
        "Radius beyond bit size [mm]",
        "Gamma ray [gAPI]",
        "Measured depth [m]",
        "T top, R right",
        "A subtitle",
    ):
        assert label in words
    assert re.search(r"20\d\d to 20\d\d m, coloured by gamma ray", words)
    assert re.search(r"diameter × 10 against depth, relief × 3 more; seen from toolface \d+°", words)
    shown = [(text.get_text(), text.get_window_extent()) for text in texts if text.get_visible()]
    page = figure.bbox
    for label, box in shown:
        on_page = box.x0 >= page.x0 and box.x1 <= page.x1 and box.y0 >= page.y0 and box.y1 <= page.y1
        assert on_page or not label, label
    for (one, first), (two, second) in combinations(shown, 2):
        apart = first.x1 <= second.x0 or second.x1 <= first.x0 or first.y1 <= second.y0 or second.y1 <= first.y0
        assert apart, (one, two)
    radius_axes, track_axes = figure.axes[:2]
    assert radius_axes.get_ylim() == track_axes.get_ylim() == (wall.depth.max(), wall.depth.min())


def test_gaps_are_drawn_as_gaps() -> None:
    run = simulate(Hole.example(2000.0, 2012.0), Tool(sample_rate=5.0))
    there = (run.depth < 2004) | (run.depth > 2008)
    wall = helibore.reconstruct(
        helibore.Caliper(run.depth[there], run.toolface[there], run.radius[there]), bit_diameter=0.216
    )
    assert np.isnan(wall.radius).any()
    figure = overview(wall, Track(run.gamma_depth, run.gamma, "Gamma ray", "gAPI"), "gap", dpi=40)
    cells = figure.axes[0].collections[0].get_array()
    assert np.array_equal(cells.mask.ravel(), np.isnan(wall.radius[: cells.size]))


def test_demo(tmp_path: Path) -> None:
    result = CliRunner().invoke(cli, ["demo", "-o", str(tmp_path), "--seed", "3"])
    assert result.exit_code == 0, result.output
    assert sorted(path.name for path in tmp_path.iterdir()) == ["helibore-demo.glb", "helibore-demo.png"]
    scene = trimesh.load_scene(tmp_path / "helibore-demo.glb")
    assert len(scene.to_geometry().faces) == 2 * 31936
    demonstration = rebuild(drill(3))
    wall, hole = demonstration.wall, demonstration.simulation.hole
    off = 1e3 * (wall.radius - hole.radius(wall.depth, wall.toolface))
    assert (
        f"rebuilt minus true radius: rms {np.sqrt(np.mean(off**2)):.2f} mm, mean {off.mean():+.2f} mm" in result.output
    )
    assert f"half of the vertices within {np.median(np.abs(off)):.2f} mm" in result.output
    assert error(demonstration).rms < 0.6e-3


def test_without_matplotlib_the_demo_says_what_is_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    result = CliRunner().invoke(cli, ["demo", "-o", str(tmp_path)])
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr == 'helibore: a picture needs matplotlib: pip install "helibore[plot]"\n'
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("pitch", [PITCH, -PITCH])
def test_depth_runs_down_the_picture(pitch: float) -> None:
    radius, _ = round_hole()
    depth = 500.0 + np.arange(radius.size) * pitch / SECTORS
    colors = np.eye(3)[(depth > 500.0 + 0.5 * TURNS * pitch).astype(int)]  # red above, green below
    picture = shaded(radius, colors, pitch=pitch, tube=2.0)
    middle = picture.pixels[:, 100]
    inside = np.flatnonzero(middle[:, 3] > 0.99)
    named = np.argmax(middle[inside, :3], axis=1)
    assert (named[0], named[-1]) == (0, 1)
    assert 0.5 * (picture.top + picture.bottom) == pytest.approx(500.0 + 0.5 * TURNS * pitch)

"""The shaded view against geometry, the demo against the truth."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from golden_texts import Golden
from late_imports import trimesh

from helibore.cli import cli
from helibore.plot.shading import View, shade
from helibore.simulation.demonstration import drill, error, rebuild

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


def test_demo(tmp_path: Path) -> None:
    result = CliRunner().invoke(cli, ["demo", "-o", str(tmp_path), "--seed", "3"])
    assert result.exit_code == 0, result.output
    assert sorted(path.name for path in tmp_path.iterdir()) == ["helibore-demo.glb", "helibore-demo.png"]
    scene = trimesh().load_scene(tmp_path / "helibore-demo.glb")
    assert len(scene.to_geometry().faces) == 2 * 31936
    assert (tmp_path / "helibore-demo.png").read_bytes().startswith(b"\x89PNG")
    demonstration = rebuild(drill(3))
    wall, hole = demonstration.wall, demonstration.simulation.hole
    off = 1e3 * (wall.radius - hole.radius(wall.depth, wall.toolface))
    assert (
        f"rebuilt minus true radius: rms {np.sqrt(np.mean(off**2)):.2f} mm, mean {off.mean():+.2f} mm" in result.output
    )
    assert f"half of the vertices within {np.median(np.abs(off)):.2f} mm" in result.output
    assert error(demonstration).rms < 0.6e-3


def test_without_matplotlib_the_demo_writes_all_but_the_picture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, golden: Golden
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    result = CliRunner().invoke(cli, ["demo", "-o", str(tmp_path)])
    assert result.exit_code == 0
    said = [line for line in result.stderr.splitlines() if line != "..."]
    golden(said[:2])
    assert 'no picture: it needs matplotlib: pip install "helibore[plot]"' in " ".join(result.stdout.split())
    assert "rebuilt minus true radius" in result.stdout
    assert [path.name for path in tmp_path.iterdir()] == ["helibore-demo.glb"]


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

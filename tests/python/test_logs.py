"""Logs of a wall's turns: against exact ellipses, a slow loop, gaps, and error texts."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import helibore as hb
from helibore.logs import turn_logs


def helix(radius: np.ndarray, sectors: int, pitch: float = 0.1) -> Any:
    settings = SimpleNamespace(sectors=sectors, pitch=pitch, start_toolface=30.0)
    return SimpleNamespace(settings=settings, start_depth=1000.0, radius=radius)


@pytest.mark.parametrize(("a", "b"), [(0.108, 0.108), (0.13, 0.108), (0.2, 0.108)])
def test_the_equivalent_diameter_of_an_ellipse_is_exact(a: float, b: float) -> None:
    """Half axes a and b: the area is pi a b."""
    angle = np.radians(np.arange(64 * 5) * 360 / 64 + 30)
    logs = turn_logs(helix(a * b / np.hypot(b * np.cos(angle), a * np.sin(angle)), 64), 0.216)
    np.testing.assert_allclose(logs.equivalent_diameter, 2 * math.sqrt(a * b), rtol=0, atol=1e-6)
    np.testing.assert_allclose(logs.volume, math.pi * a * b * 0.1, rtol=1e-5)
    np.testing.assert_allclose(logs.excess, a * b / 0.108**2 - 1, rtol=0, atol=2e-5)


@pytest.mark.parametrize("pitch", [0.1, -0.1])
def test_every_turn_equals_a_slow_loop(pitch: float) -> None:
    random = np.random.default_rng(4)
    radius = random.uniform(0.1, 0.15, 7 * 12 + 5)
    radius[[14, 15, 40]] = np.nan
    radius[60:72] = np.nan
    logs = turn_logs(helix(radius, 12, pitch), 0.216)
    assert logs.depth.size == 7
    for turn in range(7):
        there = [r for r in radius[turn * 12 : turn * 12 + 12].tolist() if not math.isnan(r)]
        whole = len(there) == 12
        square = sum(r * r for r in there) / 12 if whole else math.nan
        expected = {
            "depth": sum(1000 + k * pitch / 12 for k in range(turn * 12, turn * 12 + 12)) / 12,
            "mean": sum(there) / 12 if whole else math.nan,
            "smallest": min(there, default=math.nan),
            "largest": max(there, default=math.nan),
            "equivalent_diameter": 2 * math.sqrt(square),
            "volume": math.pi * square * 0.1,
            "excess": square / 0.108**2 - 1,
            "coverage": len(there) / 12,
        }
        for name, value in expected.items():
            assert getattr(logs, name)[turn] == pytest.approx(value, rel=1e-12, nan_ok=True), name


def test_a_wall_of_gauge_hole_has_no_excess_and_an_empty_one_no_rows() -> None:
    depth = np.arange(0, 3, 0.005)
    caliper = hb.Caliper(depth, np.arange(depth.size) * 37.0 % 360, np.full(depth.size, 0.108))
    wall = hb.reconstruct(caliper, bit_diameter=0.216)
    assert abs(turn_logs(wall, 0.216).excess).max() < 1e-12
    assert turn_logs(hb.Wall(bit_diameter=0.216), 0.216).depth.shape == (0,)


@pytest.mark.parametrize("size", [0.0, -0.2, math.nan, math.inf])
def test_a_bit_must_have_a_size(size: float) -> None:
    with pytest.raises(ValueError, match=rf"^bit_diameter = {size}: must be finite and above 0$"):
        turn_logs(helix(np.full(24, 0.1), 12), size)

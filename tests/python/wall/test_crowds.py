"""Samples that crowd: at one depth, at one toolface, on a few of either. Ties, splits and instruction sets."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
from reference import Floats, bits, reference

import helibore as hb

BIT = 0.216
Columns = tuple[Floats, ...]


def crowd(shape: str, n: int) -> Columns:
    """2 m of hole; four fifths of the samples as the shape says, in order of arrival, the others anywhere."""
    rng = np.random.default_rng(len(shape))
    depth, toolface = rng.uniform(0, 2, n), rng.uniform(0, 360, n)
    of_shape = rng.random(n) < 0.8
    if "depth" in shape:
        depth[of_shape] = rng.choice([0.4, 1.3] if "two depths" in shape else [1.1], of_shape.sum())
    if "whole degrees" in shape:
        toolface[of_shape] = np.floor(toolface[of_shape])
    if "arms" in shape:
        toolface[of_shape] = rng.choice([11.0, 101.0, 191.0, 281.0], of_shape.sum())
    if "one arm" in shape:
        toolface[of_shape] = 359.99
    if "shaking" in shape:
        toolface[of_shape] = (toolface[of_shape] + rng.normal(0, 1e-7, of_shape.sum())) % 360
    return depth, toolface, BIT / 2 + 0.003 * rng.standard_normal(n)


SHAPES = [
    "one depth",
    "two depths",
    "one depth, whole degrees",
    "one depth, four arms",
    "one depth, one arm",
    "one depth, four arms, shaking",
    "four arms",
    "one arm",
    "one arm, shaking",
]
SETTINGS: list[dict[str, Any]] = [
    {},
    {"neighbors": 1, "pitch": -0.3, "start_depth": 2.0},
    {"neighbors": 40, "angular_scale": 3.0, "max_distance": 0.3},
    {"sectors": 5, "pitch": 0.05, "window": 200},
    {"bit_diameter": 3.0, "max_distance": None, "start_depth": -0.5},
]


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("chosen", SETTINGS, ids=str)
def test_agrees_with_the_reference(shape: str, chosen: dict[str, Any]) -> None:
    """Equal distances go by canonical order. The reference rounds them, because it computes mirror images apart."""
    settings = {"bit_diameter": BIT, "sectors": 16, "pitch": 0.2} | chosen
    columns = crowd(shape, 3000)
    wall = hb.reconstruct(hb.Caliper(*columns), **settings)
    truth = reference(*columns, **settings, digits=13)
    clear = abs(wall.radius - truth.radius) <= 1e-12
    np.testing.assert_allclose(wall.nearest, truth.nearest, rtol=1e-11, atol=1e-13)
    np.testing.assert_array_equal(wall.support, truth.support)
    assert np.mean(clear) >= (0.98 if "shaking" in shape else 1.0)  # 1e-7 degrees are 2e-10 m: neither tie nor not


@pytest.mark.parametrize("timed", [False, True])
@pytest.mark.parametrize("pitch", [0.1, -0.1])
@pytest.mark.parametrize("shape", SHAPES)
def test_any_split_gives_the_same_bits(shape: str, pitch: float, timed: bool) -> None:
    """Batches while drilling ahead and turning at one depth, and batches that fall anywhere."""
    columns = crowd(shape, 9000)
    if timed:
        columns = (*columns, np.floor(np.arange(9000) / 7))
    ahead = np.argsort(np.sign(pitch) * columns[0], kind="stable")
    settings: dict[str, Any] = {"bit_diameter": BIT, "sectors": 32, "pitch": pitch, "start_depth": 1.0 - np.sign(pitch)}
    for order in (ahead, np.arange(9000)):
        rows = tuple(c[order] for c in columns)
        once = hb.Wall(**settings)
        once.append(*rows)
        split = hb.Wall(**settings)
        for first, last in itertools.pairwise([*range(0, 9000, 700), 9000]):
            before = split.radius
            change = split.append(*(c[first:last] for c in rows))
            same = np.ones(before.size, bool)
            for start, stop in change.ranges:
                same[start:stop] = False
            np.testing.assert_array_equal(split.radius[: before.size][same], before[same])
        assert bits(split) == bits(once)


@pytest.mark.parametrize("shape", SHAPES)
def test_threads_and_instruction_sets(shape: str) -> None:
    columns = crowd(shape, 20_000)
    walls = set()
    for instruction_set, threads in (("plain", 1), ("automatic", 1), ("automatic", 3)):
        wall = hb.Wall(bit_diameter=BIT, pitch=0.05, instruction_set=instruction_set, threads=threads)
        wall.append(*columns)
        walls.add(bits(wall))
    assert len(walls) == 1


def test_a_wall_far_inside_the_bit() -> None:
    """Radii of a hundredth of the bit's: what ties at the first trial radius may not tie at the last."""
    depth, toolface, radius = crowd("one depth, four arms, shaking", 3000)
    settings: dict[str, Any] = {"bit_diameter": 2.0, "sectors": 16, "pitch": 0.2}
    wall = hb.reconstruct(hb.Caliper(depth, toolface, radius / 100), **settings)
    truth = reference(depth, toolface, radius / 100, **settings, digits=13)
    assert np.mean(abs(wall.radius - truth.radius) <= 1e-12) >= 0.98

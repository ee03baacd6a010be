"""How far the toolfaces of a pass lie from those of another: a rough hole of known shape, seen by two passes."""

from __future__ import annotations

import numpy as np
import pytest

from helibore.base.arrays import Floats
from helibore.preparation.shifts import Shifts, find_shifts

SHIFT = 0.31
"""Metres that the second pass lies too high."""


def rough(seed: int, waves: tuple[int, ...]) -> list[Floats]:
    """Return a value in each 0.05 m from -5 to 45 m, by harmonic: the radius of a hole of smooth random shape."""
    rng, along = np.random.default_rng(seed), np.arange(-5, 45, 0.05)

    def smooth(size: float, step: int) -> Floats:
        found: Floats = np.interp(along, along[::step], rng.normal(0, size, along[::step].size))
        return found

    level = smooth(0.003, 8)
    return [level, *(smooth(0.002, 80) + 1j * smooth(0.002, 80) if of in waves else 0 * along for of in (1, 2, 3))]


def matched(
    waves: tuple[int, ...],
    offset: float,
    diameters: bool = False,
    spiral: float = 0.0,
    lag: float = 50,
    turns: float = 20.0,
) -> Shifts:
    """Return what is found of two passes of four arms, whose second has ``offset`` degrees too little toolface.

    The first turns by 15 degrees a metre, the second by ``turns``.
    """
    rng, hole, along = np.random.default_rng(4), rough(3, waves), np.arange(-5, 45, 0.05)

    def radius(depth: Floats, toolface: Floats) -> Floats:
        found = 0.1 + np.interp(depth, along, hole[0].real) + spiral * np.cos(np.radians(toolface) - 2 * np.pi * depth)
        for of in waves:
            wave = np.interp(depth, along, hole[of].real) + 1j * np.interp(depth, along, hole[of].imag)
            found += (wave * np.exp(1j * of * np.radians(toolface))).real
        return found

    parts = []
    for number in range(2):
        depth = np.repeat(np.arange(0, 40, 0.1), 4)
        toolface = np.tile([0, 90, 180, 270], depth.size // 4) + (turns if number else 15.0) * depth + lag * number
        true = depth + number * SHIFT
        seen = radius(true, toolface)
        if diameters:
            seen = (seen + radius(true, toolface + 180)) / 2
        seen += rng.normal(0, 3e-4, depth.size)
        parts.append((depth, (toolface - number * offset) % 360, seen, np.full(depth.size, number)))
    return find_shifts(*(np.concatenate(column) for column in zip(*parts, strict=True)), held=[0])


@pytest.mark.parametrize("offset", [0.0, 15.0, -40.0, 180.0])
def test_an_offset_is_found_and_does_not_move_the_shift(offset: float) -> None:
    found = matched((1, 2, 3), offset)
    one = found.functions[1]
    assert one.found
    assert abs(one.shift.mean() - SHIFT) < 0.02
    assert one.toolface is not None
    assert abs((one.toolface.angle - offset + 180) % 360 - 180) < 3 * one.toolface.sigma < 9
    assert one.toolface.is_offset == (offset != 0)
    said = [line for line in found.lines() if "toolface" in line]
    assert len(said) == (offset != 0)
    assert all(f"toolface_shifts=1={one.toolface.angle:.1f}deg" in line for line in said)


def test_diameters_leave_180_degrees_open() -> None:
    one = matched((2,), 15.0, diameters=True, lag=10, turns=22.0).functions[1]
    assert one.toolface is not None
    assert one.toolface.by_half
    assert abs((one.toolface.angle - 15 + 90) % 180 - 90) < 3 * one.toolface.sigma < 9
    assert "or 180 degrees more" in one.toolface.sentence(1)


@pytest.mark.parametrize("offset", [0.0, 180.0])
def test_two_diameters_say_that_they_know_an_offset_but_for_180_degrees(offset: float) -> None:
    found = matched((2,), offset, diameters=True, lag=10, turns=22.0)
    said = [line for line in found.lines() if "toolface" in line]
    assert said == [
        "pass 1: its toolfaces lie as those of the others do, or 180 degrees more, which fits nearly as well"
    ]


@pytest.mark.parametrize("offset", [100.0, 180.0])
def test_of_two_angles_that_fit_nearly_alike_the_likelier_is_taken(offset: float) -> None:
    """A faint spiral on an oval hole shows which half is right; beside the wrong half it would be an error."""
    one = matched((2,), offset, spiral=0.0005, lag=10, turns=22.0).functions[1]
    assert one.toolface is not None
    assert one.toolface.by_half
    assert one.toolface.is_offset
    assert abs((one.toolface.angle - offset + 180) % 360 - 180) < 3 * one.toolface.sigma < 9
    assert "180 degrees more" in one.toolface.sentence(1)


@pytest.mark.parametrize("lag", [20.0, 30.0, 60.0, 70.0])
@pytest.mark.parametrize("diameters", [False, True])
def test_no_offset_is_reported_where_the_arms_of_both_passes_lie_alike_along_the_hole(
    lag: float, diameters: bool
) -> None:
    """Between their arms the hole is a guess, and the likeliest angle is one that lays arms over arms."""
    found = matched((1, 2, 3), 0.0, diameters, lag=lag, turns=15.0)
    said = [line for line in found.lines() if "toolface" in line]
    assert len(said) == 1
    assert "is not known" in said[0]


def test_a_round_hole_says_nothing_and_in_a_spiral_depth_may_be_the_cause() -> None:
    """The spiral turns by 3.6 degrees in a centimetre."""
    for waves, spiral in (((), 0.0), ((), 0.003)):
        one = matched(waves, 0.0, spiral=spiral).functions[1]
        assert one.toolface is not None
        assert not one.toolface.is_offset

"""Find the direction and the opening of breakout lobes in a section; ``base.axial`` has the part shared with images.

height(toolface) = distance of the wall from the centre of the unworn circle, less the circle's radius

     .-----.             The axis of a turn is half the angle of sum w exp(2 i toolface). The weight w is the height
   (  o   )  )  lobe     less opening_level times the turn's greatest height; it is 0 where that is negative.
     `-----'             Opposite breakout lobes add up, because the angles are doubled.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from helibore.base.arrays import Floats, Integers
from helibore.base.axial import Axes, BreakoutLobe, axial_mean, lobe_of
from helibore.base.ranges import PIECE, pieces
from helibore.logs.turn_logs import Logs

ONE_AXIS = 1e-3
"""Degrees; if the axes of the arms in a zone deviate by less than this from their mean, the arms do not turn."""


def rows(radius: Floats, turns: Integers, sectors: int) -> Floats:
    """Return the radii of ``turns``, whose numbers rise, (turns, sectors).

    Only the radii from the first to the last of these turns are read.
    """
    first, last = int(turns[0]), int(turns[-1])
    return radius[first * sectors : (last + 1) * sectors].reshape(-1, sectors)[turns - first]


def sections(logs: Logs, turns: Integers, radius: Floats, start: float) -> tuple[Floats, Floats]:
    """Return each vertex's height over the unworn circle, metres, and direction from its centre, degrees.

    Both are (turns, sectors). A turn without an unworn circle has that of the bit about the axis.
    """
    toolface = np.radians(start + np.arange(logs.sectors) * (360 / logs.sectors))
    around = rows(radius, turns, logs.sectors)
    known = np.isfinite(logs.unworn_diameter[turns])
    centre_0, centre_90 = (np.where(known, of[turns], 0.0)[:, None] for of in (logs.unworn_0, logs.unworn_90))
    diameter = np.where(known, logs.unworn_diameter[turns], logs.bit_diameter)[:, None]
    x, y = around * np.cos(toolface) - centre_0, around * np.sin(toolface) - centre_90
    return np.hypot(x, y) - diameter / 2, np.degrees(np.arctan2(y, x))


def lobes_of(
    logs: Logs, turns: Integers, radius: Floats, start: float, level: float, both: bool
) -> tuple[float, float, tuple[BreakoutLobe, ...]]:
    """Return the axis of a breakout or the toolface of a key seat, its deviation among the turns, and the lobes.

    Axis, toolface and deviation are degrees.

    Parameters
    ----------
    logs, turns, radius, start
        The logs, the zone's turns, the radii of all vertices, and the toolface of the first sector.
    level
        `Criteria.opening_level`.
    both
        Whether there are two opposite lobes (a breakout) or one (a key seat).
    """
    fold = 2 if both else 1  # opposite lobes have one axis, which repeats after 180 degrees; a key seat has a direction
    by_turn, total = np.empty(turns.size, dtype=np.complex128), np.zeros(logs.sectors)
    for piece in pieces(slice(0, turns.size), max(PIECE // logs.sectors, 1)):
        height, direction = sections(logs, turns[piece], radius, start)
        weight = np.maximum(height - level * height.max(axis=1, keepdims=True), 0)
        by_turn[piece] = (weight * np.exp(1j * fold * np.radians(direction))).sum(axis=1)
        total += height.sum(axis=0)
    angles = np.degrees(np.angle(by_turn)) / fold
    spread = axial_mean(angles * fold / 2)  # half of an angle that repeats after 360 degrees repeats after 180
    toolface = spread.mean * 2 / fold % (360 / fold)
    mean = total / turns.size
    sides = [toolface, toolface + 180] if both else [toolface]
    lobes = tuple(lobe_of(mean, side, start, None, level) for side in sides)
    return toolface, spread.deviation * 2 / fold, lobes


def axes_of_arms(axes: Axes) -> Axes:
    """Return ``axes``, with a deviation of NaN if the arms did not turn: it would say nothing about the lobes."""
    return replace(axes, deviation=math.nan) if axes.deviation < ONE_AXIS else axes


def lobes_of_arms(
    logs: Logs, turns: Integers, radius: Floats, start: float, both: bool
) -> tuple[float, float, tuple[BreakoutLobe, ...]]:
    """Return what `lobes_of` returns, from the arm diameters of a tool with few arms; openings are NaN.

    The radii of the wall decide which of the two lobes is higher.
    """
    axes = logs.c1_toolface[turns]
    spread = axes_of_arms(axial_mean(axes))
    half, uneven = (logs.c1 - logs.c2)[turns] / 2, logs.uneven[turns] / 2
    low, high = float(np.median(half - uneven)), float(np.median(half + uneven))
    number = np.rint((axes - start) * (logs.sectors / 360)).astype(np.int64)
    around, every = rows(radius, turns, logs.sectors), np.arange(turns.size)
    first, second = (around[every, (number + add) % logs.sectors] for add in (0, logs.sectors // 2))
    # The first end of an axis of 179 degrees lies near 180, on the other side than the mean of 179 and 1, which is 0.
    difference = (first - second) * np.where(np.abs(axes - spread.mean) > 90, -1, 1)
    near, far = (high, low) if np.nansum(difference) >= 0 else (low, high)
    sides = (BreakoutLobe(spread.mean, np.nan, near), BreakoutLobe(spread.mean + 180, np.nan, far))
    if both:
        return spread.mean, spread.deviation, sides
    side = sides[0] if near >= far else sides[1]
    return side.toolface, spread.deviation, (side,)

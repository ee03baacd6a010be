"""Where the lobes of a section lie, how wide they open, and the statistics of axes.

    height(toolface) = distance of the wall from the centre of the area, less C2/2

         .-----.             the axis of a turn: half the direction of sum w exp(2 i toolface), w the height
       (  o   )  )  lobe     above opening_level times the greatest; doubled, opposite lobes add up
         `-----'

Axes have no sense of direction: 1 and 179 degrees are 2 apart. Their mean and spread are Mardia's:

    mean = 1/2 atan2(sum L sin 2a, sum L cos 2a)     R = |sum L exp(2 i a)| / sum L     s = 1/2 sqrt(-2 ln R)
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats
from helibore.logs.turn_logs import Logs

Turns = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Lobe:
    """One side of a breakout, or a key seat, from the mean section of its zone.

    Attributes
    ----------
    toolface
        Of its middle by weight, [0, 360), degrees.
    opening
        The angle over which it stands higher than ``opening_level`` times its height, degrees.
    height
        The greatest, over the circle of C2, metres.
    """

    toolface: float
    opening: float
    height: float


@dataclass(frozen=True)
class Axes:
    """Statistics of axes.

    Attributes
    ----------
    mean
        [0, 180), degrees; NaN where there are none.
    deviation
        Standard deviation, degrees; infinite where the axes point nowhere.
    concentration
        R, from 0 (anywhere) to 1 (all alike).
    count, weight
        How many, and the sum of their weights (lengths).
    """

    mean: float
    deviation: float
    concentration: float
    count: int
    weight: float


def axial_mean(axes: Floats, weights: Floats | None = None) -> Axes:
    """Return mean and spread of axes in degrees, weighted."""
    weight = np.ones(axes.size) if weights is None else weights
    total = float(weight.sum())
    if not total > 0:
        return Axes(math.nan, math.nan, math.nan, int(axes.size), total)
    sum_ = complex((weight * np.exp(2j * np.radians(axes))).sum())
    R = min(abs(sum_) / total, 1.0)
    mean = math.degrees(math.atan2(sum_.imag, sum_.real)) / 2 % 180
    deviation = math.degrees(math.sqrt(abs(2 * math.log(R)))) / 2 if R > 0 else math.inf
    return Axes(0.0 if mean == 180 else mean, deviation, R, int(axes.size), total)


def sections(logs: Logs, turns: Turns, radius: Floats, start: float) -> tuple[Floats, Floats]:
    """Return height over the circle of C2 and direction from its centre, degrees, both (turns, sectors)."""
    toolface = np.radians(start + np.arange(logs.sectors) * (360 / logs.sectors))
    x = radius[turns] * np.cos(toolface) - logs.centre_0[turns, None]
    y = radius[turns] * np.sin(toolface) - logs.centre_90[turns, None]
    return np.hypot(x, y) - logs.c2[turns, None] / 2, np.degrees(np.arctan2(y, x))


def lobes_of(
    logs: Logs, turns: Turns, radius: Floats, start: float, level: float, both: bool
) -> tuple[float, float, tuple[Lobe, ...]]:
    """Return axis or toolface, its deviation from turn to turn, and the lobes of a zone.

    Parameters
    ----------
    logs, turns, radius, start
        The logs, the zone's turns, the radii of all turns (turns, sectors), and the toolface of the first sector.
    level
        `Criteria.opening_level`.
    both
        Two opposite lobes (a breakout), or one (a key seat).
    """
    height, direction = sections(logs, turns, radius, start)
    weight = np.maximum(height - level * height.max(axis=1, keepdims=True), 0)
    fold = 2 if both else 1  # opposite lobes are one axis; a key seat has a direction
    by_turn = (weight * np.exp(1j * fold * np.radians(direction))).sum(axis=1)
    angles = np.degrees(np.angle(by_turn)) / fold
    spread = axial_mean(angles * fold / 2)  # angles that repeat after 360 are axes of half their size
    toolface = spread.mean * 2 / fold % (360 / fold)
    mean = height.mean(axis=0)
    sides = [toolface, toolface + 180] if both else [toolface]
    lobes = tuple(lobe_of(mean, side, start, None, level) for side in sides)
    return toolface, spread.deviation * 2 / fold, lobes


def lobe_of(height: Floats, toolface: float, start: float, floor: float | None, level: float = 0.0) -> Lobe:
    """Return the lobe of a mean section within a quarter turn of a toolface.

    ``floor`` is the height at which its opening is measured; None: ``level`` times the greatest.
    """
    step = 360 / height.size
    first = math.ceil((toolface - 90 - start) / step)
    last = math.floor((toolface + 90 - start) / step)
    number = np.arange(first, last + 1)
    angle, side = start + number * step, height[number % height.size]
    peak = int(np.argmax(side))
    floor = level * float(side[peak]) if floor is None else floor
    weight = np.maximum(side - floor, 0)
    middle = float((weight * angle).sum() / weight.sum()) if weight.sum() > 0 else toolface
    ends = (_crossing(side[peak::-1], floor), _crossing(side[peak:], floor))
    return Lobe(middle % 360, (ends[0] + ends[1]) * step, float(side[peak]))


def _crossing(side: Floats, floor: float) -> float:
    """Steps from the first value to where values fall to the floor, linear between; all of them where they do not."""
    below = np.flatnonzero(side < floor)
    if not below.size:
        return float(side.size - 1)
    after = int(below[0])
    above, under = side[after - 1], side[after]
    return float(after - 1 + (above - floor) / (above - under))

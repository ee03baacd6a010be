"""Axes and lobes around a circle, for breakouts of a wall and breakouts of an image.

An axis at a is also an axis at a + 180, so 1 and 179 degrees are 2 apart. With weights L, the mean and the spread s of
axes at the angles a are those of Mardia:

    mean = 1/2 atan2(sum L sin 2a, sum L cos 2a)     R = |sum L exp(2 i a)| / sum L     s = 1/2 sqrt(-2 ln R)
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from helibore.base.arrays import Floats


@dataclass(frozen=True)
class BreakoutLobe:
    """One side of a breakout, or a key seat, from the mean section of its zone."""

    toolface: float  # direction of its weighted middle, [0, 360), degrees
    opening: float  # angle over which the lobe is above the floor of `lobe_of`, degrees; NaN if the arms are too few
    height: float  # in a wall: the greatest height above the circle of C2, metres; in an image: the greatest darkness


@dataclass(frozen=True)
class Axes:
    """Statistics of axes."""

    mean: float  # [0, 180), degrees; NaN if there are no axes
    deviation: float  # standard deviation, degrees; large to infinite without a preferred direction, NaN if not known
    concentration: float  # R, from 0 (no preferred direction) to 1 (all axes are equal)
    count: int
    weight: float  # the sum of the weights (lengths)

    def spread(self, what: str, unit: str, decimals: int) -> str:
        """Return the deviation as text, such as "s.d. 4.0 deg"; if it is NaN, the count and ``what``, as "1 zone"."""
        if math.isnan(self.deviation):
            return f"{self.count} {what}{'s' * (self.count != 1)}"
        return f"s.d. {self.deviation:.{decimals}f}{unit}"


def axial_mean(axes: Floats, weights: Floats | None = None) -> Axes:
    """Return the weighted mean and spread of ``axes``, degrees; both are NaN if the weights add up to 0 or less."""
    weight = np.ones(axes.size) if weights is None else weights
    total = float(weight.sum())
    if not total > 0:
        return Axes(math.nan, math.nan, math.nan, int(axes.size), total)
    sum_ = complex((weight * np.exp(2j * np.radians(axes))).sum())
    R = min(abs(sum_) / total, 1.0)
    mean = math.degrees(math.atan2(sum_.imag, sum_.real)) / 2 % 180
    deviation = math.degrees(math.sqrt(abs(2 * math.log(R)))) / 2 if R > 0 else math.inf
    deviation = deviation if axes.size > 1 else math.nan
    return Axes(0.0 if mean == 180 else mean, deviation, R, int(axes.size), total)


def lobe_of(height: Floats, toolface: float, start: float, floor: float | None, level: float = 0.0) -> BreakoutLobe:
    """Return the lobe of a mean section, searched within a quarter turn to either side of ``toolface``.

    The values of ``height`` are evenly spaced around the hole, and the first lies at the toolface ``start``. ``floor``
    is the height at which the opening is measured; None: ``level`` times the greatest height of the lobe.
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
    return BreakoutLobe(middle % 360, (ends[0] + ends[1]) * step, float(side[peak]))


def _crossing(side: Floats, floor: float) -> float:
    """Return how many steps after the first value the values fall to ``floor``, interpolated linearly.

    If no value is below the floor, return the number of all steps; if the first value is below it, return 0.
    """
    below = np.flatnonzero(side < floor)
    if not below.size:
        return float(side.size - 1)
    after = int(below[0])
    if after == 0:
        return 0.0
    above, under = side[after - 1], side[after]
    return float(after - 1 + (above - floor) / (above - under))

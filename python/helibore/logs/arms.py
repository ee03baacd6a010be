"""The diameters that the arms of a tool measured. If a tool has few arms, they give the shape of the hole.

    arm 1     r(toolface) + r(toolface + 180)  at each depth, linear between readings, averaged over each turn

Between the arms the wall is interpolated. The eight nearest samples of a vertex come from several arms, so an oval hole
becomes rounder than it is. If a tool does not measure all around the hole, the largest and smallest diameters, ovality
and zones therefore come from the arms. Only area, volume, centre and circles, which need the whole section, come from
the wall.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from helibore.base.angles import wrapped
from helibore.base.arrays import Floats, Integers
from helibore.samples.caliper import Caliper

FEW_ARMS = 8
"""A tool with few arms measures at most this many diameters; a tool with more diameters measures all around."""
_SAME_AXIS = 1e-3  # degrees, to which toolfaces are rounded to compare them
_DIRECTIONS = round(360 / _SAME_AXIS)


@dataclass(frozen=True, eq=False)
class ArmDiameters:
    """The diameters that the arms measured in each turn; made by `arm_diameters`.

    Attributes
    ----------
    diameter, toolface
        (arms, turns) diameters, metres, and their axes, degrees in [0, 180); NaN if no reading is near.
    uneven
        (arms, turns) difference of the two ends' distances from the tool's axis, metres; 0 if diameters,
        not radii, were measured.
    """

    diameter: Floats
    toolface: Floats
    uneven: Floats

    def sizes(self) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        """Return five values for each turn; all are NaN if an arm has no diameter in the turn.

        They are the largest diameter, its axis, its unevenness, the diameter whose axis is nearest to a right angle to
        this axis, and the smallest diameter.
        """
        turns = np.arange(self.diameter.shape[1])
        largest = np.argmax(np.nan_to_num(self.diameter, nan=-np.inf), axis=0)
        axis = self.toolface[largest, turns]
        across = np.abs((self.toolface - axis + 90) % 180 - 90)
        second = np.argmax(np.nan_to_num(across, nan=-np.inf), axis=0)
        whole = np.where(np.isnan(self.diameter).any(axis=0), np.nan, 0.0)
        c1, c2 = self.diameter[largest, turns] + whole, self.diameter[second, turns] + whole
        return c1, axis + whole, self.uneven[largest, turns] + whole, c2, self.diameter.min(axis=0)


def arm_diameters(arms: Caliper, depth: Floats, height: float, reach: float) -> ArmDiameters | None:
    """Return the diameters of the arms at each turn.

    Parameters
    ----------
    arms
        Samples with their arm numbers.
    depth, height
        Middles of the turns, and height of a turn, metres.
    reach
        Metres: a turn gets no diameter of an arm if all readings of that arm are farther away.

    Returns
    -------
    ArmDiameters or None
        None if no two samples lie opposite each other, or if there are fewer than two or more than `FEW_ARMS`
        diameters.
    """
    number, at, diameter, axis, uneven = _pairs(arms)
    names = np.unique(number)
    if not 2 <= names.size <= FEW_ARMS:
        return None
    rows: list[list[Floats]] = [[], [], []]
    for name in names:
        mine = number == name
        doubled = np.exp(2j * np.radians(axis[mine]))
        columns = np.stack([diameter[mine], uneven[mine], doubled.real, doubled.imag])
        size, off, x, y = _means(at[mine], columns, depth, height, reach)
        for row, values in zip(rows, (size, wrapped(np.degrees(np.arctan2(y, x)) / 2, 180.0), off), strict=True):
            row.append(values)
    return ArmDiameters(*(np.stack(row) for row in rows))


def _pairs(arms: Caliper) -> tuple[Integers, Floats, Floats, Floats, Floats]:
    """Return columns of the pairs of opposite samples at one depth: arm, depth, diameter, axis, difference of radii.

    Axes are degrees in [0, 180). Samples at the same place, as from two calipers with the same direction, are averaged
    first, and get the least of their arm numbers. If there are fewer axes than arm numbers, axes take the place of arm
    numbers.
    """
    assert arms.arm is not None
    half = _DIRECTIONS // 2
    toolface = np.rint(np.mod(arms.toolface, 360.0) / _SAME_AXIS).astype(np.int64) % _DIRECTIONS
    time = np.zeros(len(arms)) if arms.time is None else arms.time
    order = _by_place(arms.depth, time, toolface % half * 2 + toolface // half)
    depth, time, toolface = arms.depth[order], time[order], toolface[order]
    other = (np.diff(depth) != 0) | (np.diff(time) != 0) | (np.diff(toolface) != 0)
    start = np.flatnonzero(np.concatenate([[True], other])[: order.size])
    radius = np.add.reduceat(arms.radius[order], start) / np.diff(np.append(start, order.size))
    number = np.minimum.reduceat(arms.arm[order], start)
    depth, time, toolface = depth[start], time[start], toolface[start]
    opposite = np.abs(np.abs(np.diff(toolface)) - half) <= 2
    first = np.flatnonzero((np.diff(depth) == 0) & (np.diff(time) == 0) & opposite)
    second = first + 1
    axis = toolface[first] % half
    pair = np.minimum(number[first], number[second])
    if np.count_nonzero(np.bincount(axis)) < np.unique(pair).size:  # arms share an axis, and one is missing in places
        pair = axis
    off = np.abs(radius[first] - radius[second])
    return pair, depth[first], radius[first] + radius[second], np.multiply(axis, _SAME_AXIS), off


def _by_place(depth: Floats, time: Floats, direction: Integers) -> Integers:
    """Return the order by depth, then time, then direction, which is a whole number below `_DIRECTIONS`.

    The samples of a wall have the first two orders already; then one sort of nearly sorted numbers is enough.
    """
    deeper, later = np.diff(depth), np.diff(time)
    if ((deeper < 0) | ((deeper == 0) & (later < 0))).any():
        found: Integers = np.lexsort((direction, time, depth))
        return found
    place = np.concatenate([[0], np.cumsum((deeper != 0) | (later != 0))])[: depth.size]
    order: Integers = np.argsort(place * _DIRECTIONS + direction, kind="stable")
    return order


def _means(at: Floats, columns: Floats, depth: Floats, height: float, reach: float) -> Floats:
    """Return the means of ``columns``, linear between readings, over ``height`` around each depth: (columns, depths).

    ``at`` are the depths of the readings; a mean is NaN if all of them are farther away than ``reach``.
    """
    known, inverse, count = np.unique(at, return_inverse=True, return_counts=True)
    values = np.stack([np.bincount(inverse, column) / count for column in columns])
    low = np.clip(depth - height / 2, known[0], known[-1])
    high = np.clip(depth + height / 2, known[0], known[-1])
    steps = np.diff(known) * (values[:, 1:] + values[:, :-1]) / 2
    whole = np.concatenate([np.zeros((len(values), 1)), np.cumsum(steps, axis=1)], axis=1)

    def integral(to: Floats) -> Floats:
        row = np.clip(np.searchsorted(known, to, "right") - 1, 0, known.size - 1)
        there = np.stack([np.interp(to, known, column) for column in values])
        area: Floats = whole[:, row] + (to - known[row]) * (values[:, row] + there) / 2
        return area

    middle = np.stack([np.interp(depth, known, column) for column in values])
    wide = high - low > 1e-3 * height
    means: Floats = np.divide(integral(high) - integral(low), high - low, out=middle, where=wide)
    after = np.clip(np.searchsorted(known, depth), 0, known.size - 1)
    nearest = np.minimum(np.abs(known[after] - depth), np.abs(known[np.maximum(after - 1, 0)] - depth))
    means[:, nearest > reach] = np.nan
    return means

"""Detection of depths that jump.

2010.1  2010.2  9840.0  2010.3             a single jump: wrong
2010.1  2010.2  1800.0  1800.1  1800.2     a jump that the next depth confirms: the tool was lifted
2010.1  2010.2  6595.1  6595.4  6595.8     feet instead of metres: wrong for as long as it lasts
"""

from __future__ import annotations

import numpy as np

from helibore.base import units
from helibore.base.arrays import Floats, Integers, Mask, Rows
from helibore.base.utc_time import SECOND
from helibore.live.model.events import Flag
from helibore.live.rules.depth_limits import DepthLimits

CONFIRMED_WITHIN = 600 * SECOND
"""Nanoseconds. A sample whose depth jumps is used only if the next sample confirms the jump within this time."""
FOOT = units.factor("ft", units.LENGTH)
NEAR = 0.02
"""The relative error within which the ratio of two depths counts as that of feet to metres, or of metres to feet."""
DRAWABLE = Flag.OFF_BOTTOM | Flag.GAP_BEFORE | Flag.LATE


def _steps(last: float, depth: Floats) -> Floats:
    """Return the length of the step to each depth from the depth before it; ``last`` is the depth before the first."""
    joined = np.concatenate([[last], depth])
    steps: Floats = np.abs(joined[1:] - joined[:-1])
    return steps


def unit_differs(depth: Floats | float, known: Floats | float) -> Mask:
    """Return whether the ratio of a depth to a known depth is near that of feet to metres or of metres to feet."""
    ratio = depth / np.maximum(known, 1e-9)
    differs: Mask = (np.abs(ratio / FOOT - 1) < NEAR) | (np.abs(ratio * FOOT - 1) < NEAR)
    return differs


def unit_rule(depth: float, known: float) -> str:
    """Return as text which unit was read as the other, if `unit_differs` is true for the two depths."""
    return f"it seems that {'feet were read as metres' if depth > known else 'metres were read as feet'}"


class LastDepth:
    """The last depth that was used, and the last depth that was refused for its unit (NaN: none).

    A depth that jumps is compared with both depths. While depths are refused, drilling goes on, so that the ratio of
    the refused depths to the last used depth changes.
    """

    STATE: tuple[str, ...] = ("_last", "_other_unit")

    def __init__(self, limits: DepthLimits) -> None:
        self.limits = limits
        self._last = self._other_unit = np.nan

    def forget(self) -> None:
        """Use the next depth without a check, because another configuration reads the depths from now on."""
        self._last = self._other_unit = np.nan

    def _use(self, depth: float) -> None:
        self._last, self._other_unit = depth, np.nan

    def _use_last_of(self, depths: Floats) -> None:
        if len(depths):
            self._use(float(depths[-1]))

    def _near(self, depth: float, other: float) -> bool:
        return abs(depth - other) <= self.limits.jump

    def _has_other_unit(self, depth: float) -> bool:
        """Return whether a depth that jumps seems to have another unit; if so, remember it as refused."""
        if self._near(depth, self._other_unit) or unit_differs(depth, self._last):
            self._other_unit = depth
            return True
        return False

    def _refused(self, depth: float) -> str:
        why = f"the last depth used was {self._last:g} m, and {unit_rule(depth, self._last)}"
        mend = "correct the unit, or, if the step is right, set depth.jump above it, and reload"
        return f"refused, {depth:.6g} m: {why}; {mend}"

    def _confirmed(self, depth: float) -> str:
        why = "used, because the depth before this one confirms the jump"
        return f"jumped from {self._last:.6g} to {depth:.6g} m: {why}"


class Steps(LastDepth):
    """Checks bit or hole depths.

    A value that jumps is not used. If the next value lies near the value that jumped, it confirms the jump and is used,
    unless it seems to have another unit.
    """

    STATE = (*LastDepth.STATE, "_rejected")

    def __init__(self, limits: DepthLimits) -> None:
        super().__init__(limits)
        self._rejected = np.nan

    def take(self, values: Floats) -> tuple[Integers, dict[int, str]]:
        """Return the indices of the values that must not be used, and texts to report, by index.

        There is a text for each value that confirms a jump, and for each value that seems to have another unit.
        """
        wrong = self.limits.outside(values)
        known = np.isfinite(values) & ~wrong
        levels: dict[int, str] = {}
        if np.isnan(self._rejected) and not (_steps(self._last, values[known]) > self.limits.jump).any():
            self._use_last_of(values[known])
            return np.flatnonzero(wrong), levels
        for row in np.flatnonzero(known).tolist():
            value = float(values[row])
            if np.isnan(self._last) or self._near(value, self._last):
                self._use(value)
            elif self._has_other_unit(value):
                wrong[row], levels[row] = True, self._refused(value)
            elif self._near(value, self._rejected):
                levels[row] = self._confirmed(value)
                self._use(value)
            else:
                wrong[row], self._rejected = True, value
                continue
            self._rejected = np.nan
        return np.flatnonzero(wrong), levels


class HeldSample(LastDepth):
    """Checks the depths of one source's samples; it holds a sample whose depth jumps until the next sample comes."""

    STATE = (*LastDepth.STATE, "_held")

    def __init__(self, limits: DepthLimits) -> None:
        super().__init__(limits)
        self._held: Rows | None = None

    def forget(self) -> None:
        """Use the next depth without a check; the held sample is refused, because nothing can confirm it any more."""
        super().forget()
        if self._held is not None:
            self._held = self._held.copy()
            self._held["flags"][0] |= int(Flag.RANGE)  # the rows after it have no usable depth anyway

    def take(self, rows: Rows) -> tuple[Rows, list[int], dict[int, str]]:
        """Return the rows to place, in order of arrival; the indices of unconfirmed rows; texts to report, by index.

        A row is unconfirmed if its depth jumps and the next row does not confirm the jump. There is a text for each row
        that confirms a jump, and for each row whose depth seems to have another unit. An unconfirmed row, and a row
        with another unit, get the flag RANGE. If the last row with a usable depth jumps, it is held for the next call,
        with the rows after it.
        """
        if self._held is not None:
            rows = np.concatenate([self._held, rows])
        depth = rows["depth"]
        known = (depth == depth) & ~self.limits.outside(depth) & ((rows["flags"] & ~int(DRAWABLE)) == 0)
        levels: dict[int, str] = {}
        if self._held is None and not (_steps(self._last, depth[known]) > self.limits.jump).any():
            self._use_last_of(depth[known])
            return rows, [], levels
        self._held = None
        jumped = -1
        wrong: list[int] = []
        for row in np.flatnonzero(known).tolist():
            value = float(depth[row])
            use = np.isnan(self._last) or self._near(value, self._last)
            if jumped >= 0:
                soon = rows["time"][row] - rows["time"][jumped] <= CONFIRMED_WITHIN
                if soon and not use and self._near(value, float(depth[jumped])):
                    use, levels[row] = True, self._confirmed(value)
                else:
                    wrong.append(jumped)
                jumped = -1
            if use:
                self._use(value)
            elif self._has_other_unit(value):
                rows["flags"][row] |= int(Flag.RANGE)
                levels[row] = self._refused(value)
            else:
                jumped = row
        rows["flags"][wrong] |= int(Flag.RANGE)
        if jumped >= 0:
            self._held, rows = rows[jumped:], rows[:jumped]
        return rows, wrong, levels

"""Checks of depths: the table ``[depth]``, and the detection of depths that jump.

2010.1  2010.2  9840.0  2010.3             a single jump: wrong
2010.1  2010.2  1800.0  1800.1  1800.2     a jump that the next depth confirms: the tool was lifted
"""

from __future__ import annotations

from typing import Annotated

import numpy as np
import numpy.typing as npt
from pydantic import AfterValidator

from helibore.live.checks import Table, within
from helibore.live.clock import SECOND
from helibore.live.events import Flag

CONFIRMED_WITHIN = 600 * SECOND
"""A jump counts only if the next sample confirms it within this time."""
Values = npt.NDArray[np.float64]
Rows = npt.NDArray[np.void]


def _ordered(limits: list[float]) -> list[float]:
    if len(limits) != 2 or not limits[0] < limits[1]:
        raise ValueError("must be [least, most] in metres, least < most")
    return limits


class DepthLimits(Table):
    """The range of depths, the longest step between two depths, and how far below the hole a depth may be; metres."""

    depth_range: Annotated[list[float], AfterValidator(_ordered)] = [0.0, 15_000.0]
    jump: Annotated[float, within(0.1)] = 100.0
    beyond_hole: Annotated[float, within(0)] = 10.0

    def outside(self, depth: Values) -> npt.NDArray[np.bool_]:
        """Return which depths are outside the range; NaN counts as inside."""
        wrong: npt.NDArray[np.bool_] = (depth < self.depth_range[0]) | (depth > self.depth_range[1])
        return wrong

    def rule(self) -> str:
        """Return the text of the rule for the range."""
        return f"must be in depth_range [{self.depth_range[0]:g}, {self.depth_range[1]:g}]"


def _steps(last: float, depth: Values) -> Values:
    """Return the length of the step to each depth from the one before it, which for the first is ``last``."""
    joined = np.concatenate([[last], depth])
    steps: Values = np.abs(joined[1:] - joined[:-1])
    return steps


class Steps:
    """Checks bit or hole depths: a value that jumps is used only if the next value does not jump back."""

    STATE = ("_last", "_rejected")

    def __init__(self, limits: DepthLimits) -> None:
        self._limits = limits
        self._last = self._rejected = np.nan

    def wrong(self, values: Values) -> npt.NDArray[np.int64]:
        """Return the rows of the values that are wrong."""
        wrong = self._limits.outside(values)
        known = np.isfinite(values) & ~wrong
        if np.isnan(self._rejected) and not (_steps(self._last, values[known]) > self._limits.jump).any():
            self._last = values[known][-1] if known.any() else self._last
            return np.flatnonzero(wrong)
        for row in np.flatnonzero(known).tolist():
            value = values[row]
            near = [abs(value - other) <= self._limits.jump for other in (self._last, self._rejected)]
            if np.isnan(self._last) or any(near):
                self._last, self._rejected = value, np.nan
            else:
                wrong[row], self._rejected = True, value
        return np.flatnonzero(wrong)


class HeldSample:
    """Checks the depths of one source's samples; it holds a sample that jumps until the next one comes."""

    STATE = ("_last", "_held")

    def __init__(self, limits: DepthLimits) -> None:
        self.limits = limits
        self._last = np.nan
        self._held: Rows | None = None

    def take(self, rows: Rows) -> tuple[Rows, Rows]:
        """Return the rows to place, in order of arrival, and the rows among them whose jump was not confirmed.

        Rows whose jump was not confirmed get the flag RANGE. If the last row jumps, it is held for the next call.
        """
        if self._held is not None:
            rows = np.concatenate([self._held, rows])
        depth = rows["depth"]
        known = (depth == depth) & ~self.limits.outside(depth) & ((rows["flags"] & ~int(DRAWABLE)) == 0)
        if self._held is None and not (_steps(self._last, depth[known]) > self.limits.jump).any():
            self._last = depth[known][-1] if known.any() else self._last
            return rows, rows[:0]
        self._held = None
        jumped = -1
        wrong: list[int] = []
        for row in np.flatnonzero(known).tolist():
            near_last = np.isnan(self._last) or abs(depth[row] - self._last) <= self.limits.jump
            if jumped >= 0:
                soon = rows["time"][row] - rows["time"][jumped] <= CONFIRMED_WITHIN
                if soon and not near_last and abs(depth[row] - depth[jumped]) <= self.limits.jump:
                    near_last = True  # this row confirms the jump
                else:
                    wrong.append(jumped)
                jumped = -1
            if near_last:
                self._last = depth[row]
            else:
                jumped = row
        rows["flags"][wrong] |= int(Flag.RANGE)
        if jumped >= 0:
            self._held, rows = rows[jumped:], rows[:jumped]
        return rows, rows[wrong]


DRAWABLE = Flag.OFF_BOTTOM | Flag.GAP_BEFORE | Flag.LATE

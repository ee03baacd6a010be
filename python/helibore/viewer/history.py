"""When the wall was how long: what a page needs to go back to how it looked at 02:14.

A point a second at first; when there are too many, every other is dropped, and from then on points stand as far
apart as those that stay, so that a month of drilling is a few thousand points, evenly spread.
Not here: earlier radii (a page shows the first pass of each).
"""

from __future__ import annotations

import math
from typing import Any

MOST = 4096


class History:
    """Points (time, vertices, bit depth), in order of time and of vertices."""

    def __init__(self) -> None:
        self._points: list[tuple[float, int, float]] = []
        self._apart = 1.0

    def note(self, time: float, vertices: int, bit_depth: float) -> None:
        """Note that the wall has `vertices` now; only growth counts."""
        points = self._points
        if points and (vertices <= points[-1][1] or time < points[-1][0]):
            return
        if len(points) > 1 and time - points[-2][0] < self._apart:
            points.pop()
        points.append((time, vertices, bit_depth))
        if len(points) > MOST:
            self._points = points = [*points[:-1:2], points[-1]]
            self._apart = max(2 * self._apart, (points[-1][0] - points[0][0]) / len(points))

    def copy(self) -> History:
        """Return one that notes nothing of what is noted here from now on."""
        other = History()
        other._points, other._apart = list(self._points), self._apart
        return other

    def as_columns(self) -> dict[str, list[Any]]:
        """Return the points as columns for JSON: seconds since 1970, counts, metres or None."""
        return {
            "time": [round(time, 3) for time, _, _ in self._points],
            "vertices": [count for _, count, _ in self._points],
            "bit_depth": [depth if math.isfinite(depth) else None for _, _, depth in self._points],
        }

"""How long the wall was at which time: the page's replay needs it to show the wall as it was at 02:14.

One point a second at first. When there are too many points, every second one is dropped and the spacing doubles, so a
month of drilling is a few thousand evenly spaced points. Earlier radii are not kept; a replay shows the first pass.
"""

from __future__ import annotations

import math
from typing import Any

MOST = 4096


class History:
    """Points (time, vertices, bit depth), rising in time and in vertices."""

    def __init__(self) -> None:
        self._points: list[tuple[float, int, float]] = []
        self._spacing = 1.0

    def note(self, time: float, vertices: int, bit_depth: float) -> None:
        """Add a point if the wall has grown."""
        points = self._points
        if points and (vertices <= points[-1][1] or time < points[-1][0]):
            return
        if len(points) > 1 and time - points[-2][0] < self._spacing:
            points.pop()
        points.append((time, vertices, bit_depth))
        if len(points) > MOST:
            self._points = points = [*points[:-1:2], points[-1]]
            self._spacing = max(2 * self._spacing, (points[-1][0] - points[0][0]) / len(points))

    def frozen_copy(self) -> History:
        """Return a copy that later points do not change."""
        copy = History()
        copy._points, copy._spacing = list(self._points), self._spacing
        return copy

    def as_columns(self) -> dict[str, list[Any]]:
        """Return the points as columns for JSON: seconds since 1970, counts, metres or None."""
        return {
            "time": [round(time, 3) for time, _, _ in self._points],
            "vertices": [count for _, count, _ in self._points],
            "bit_depth": [depth if math.isfinite(depth) else None for _, _, depth in self._points],
        }

"""Convert measured depths to true vertical depths if the survey gives them, and, by the elevation, to TVDSS.

    zero of depths  ---- 0 ----+            TVD    down from the zero of depths (rotary table, kelly bushing)
           elevation           |
    sea level       -----------+---- 0      TVDSS  TVD - elevation: negative above the sea level
                               |

A true depth is known if the survey begins at depth 0 or the path's head gives the true depth of the first station.
Otherwise "down" counts from a first station somewhere in the hole, and so is not a true depth. Log files do not state
the elevation, so it is an option.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from helibore.base.arrays import Floats
from helibore.base.errors import InputError
from helibore.trajectory.survey import Path

SURFACE = 0.001
"""Metres; a survey that begins this near to depth 0 counts as beginning at depth 0."""


@dataclass(frozen=True)
class TrueDepth:
    """True depths along a path."""

    path: Path
    name: str  # "TVD" or "TVDSS"
    down: float  # the "down" of the path's coordinates at which the true depth is 0, metres

    def at(self, depth: Floats) -> Floats:
        """Return the true depths of measured depths, metres; NaN beyond the ends of the path."""
        found = np.full(depth.size, np.nan)
        there = (depth >= self.path.start_depth) & (depth <= self.path.stop_depth)
        found[there] = self.path.position(depth[there])[:, 2] - self.down
        return found


def true_depth(path: Path | None, elevation: float | None) -> TrueDepth | None:
    """Return the true vertical depths of a path; with ``elevation``, metres, depths below sea level.

    If true depths are not known, return None, or raise an InputError if ``elevation`` is given.
    """
    if path is not None and abs(path.start_depth) <= SURFACE:
        zero = path.head[2]
    elif path is not None and path.head[2] != 0:
        zero = 0.0
    elif elevation is None:
        return None
    else:
        rule = (
            "depth below sea level needs a wall with a path whose survey begins at depth 0, or whose head gives the "
            "true depth of its first station"
        )
        raise InputError("elevation", rule, f"{elevation:g}")
    return TrueDepth(path, "TVD", zero) if elevation is None else TrueDepth(path, "TVDSS", zero + elevation)

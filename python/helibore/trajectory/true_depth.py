"""True vertical depth of a measured depth, if the survey gives it; depth below sea level, if the datum is known.

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
    """True depths along a path; ``down`` is where they are 0, in the path's coordinates, metres."""

    path: Path
    name: str
    down: float

    def at(self, depth: Floats) -> Floats:
        """Return the true depths of measured depths, metres; NaN beyond the ends of the path."""
        found = np.full(depth.size, np.nan)
        there = (depth >= self.path.start_depth) & (depth <= self.path.stop_depth)
        found[there] = self.path.position(depth[there])[:, 2] - self.down
        return found


def true_depth(path: Path | None, elevation: float | None) -> TrueDepth | None:
    """Return the true depths of a path. If they are not known, return None; raise InputError for an ``elevation``."""
    surface = path is not None and abs(path.start_depth) <= SURFACE
    known = path is not None and (surface or path.head[2] != 0)
    if path is None or not known:
        if elevation is None:
            return None
        needs = (
            "a wall with a path whose survey begins at depth 0, or whose head says the true depth of its first station"
        )
        raise InputError("elevation", f"depth below sea level needs {needs}", f"{elevation:g}")
    zero = path.head[2] if surface else 0.0
    return TrueDepth(path, "TVD", zero) if elevation is None else TrueDepth(path, "TVDSS", zero + elevation)

"""True vertical depth beside measured depth, where the survey says it; below mean sea level, where the datum is known.

    zero of depths  ---- 0 ----+            TVD    down from the zero of depths (rotary table, kelly bushing)
           elevation           |
    sea level       -----------+---- 0      TVDSS  TVD - elevation: negative above the sea level
                               |

A survey begins at depth 0, or its path's head says how deep its first station truly lies. Nothing else is a true depth:
down from a first station somewhere in the hole is not. No file that is read states the elevation, so it is an option.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from helibore.base.arrays import Floats

if TYPE_CHECKING:
    from helibore.trajectory.survey import Path

SURFACE = 0.001
"""Metres: a survey that begins no farther from depth 0 begins there."""


@dataclass(frozen=True)
class TrueDepth:
    """True depths along a path: ``down`` of the zero that they count from, in the path's coordinates."""

    path: Path
    name: str
    down: float

    def at(self, depth: Floats) -> Floats:
        """True depths at measured ones, metres; NaN where the path does not reach."""
        found = np.full(depth.size, np.nan)
        there = (depth >= self.path.start_depth) & (depth <= self.path.stop_depth)
        found[there] = self.path.position(depth[there])[:, 2] - self.down
        return found


def true_depth(path: Path | None, elevation: float | None) -> TrueDepth | None:
    """Return the true depth that a path tells: None where it tells none and no ``elevation`` asks for it.

    Raises
    ------
    ValueError
        If there is an elevation, but no true depth that it could be taken off.
    """
    surface = path is not None and abs(path.start_depth) <= SURFACE
    known = path is not None and (surface or path.head[2] != 0)
    if path is None or not known:
        if elevation is None:
            return None
        raise ValueError(
            f"elevation = {elevation:g}: depth below sea level needs a wall with a path whose survey begins at depth "
            "0, or whose head says the true depth of its first station"
        )
    zero = path.head[2] if surface else 0.0
    return TrueDepth(path, "TVD", zero) if elevation is None else TrueDepth(path, "TVDSS", zero + elevation)

"""The angular gap of each vertex: how far apart, around the hole, the samples on its two sides are.

              x  sample clockwise           gap = clockwise angle + counter-clockwise angle, degrees,
    vertex  o                                     to the nearest samples within ``reach`` metres of its depth;
              x  sample counter-clockwise         0 at a sample's toolface, 360 where there are none, or one elsewhere

A small gap means that the tool saw this part of the turn. Between few arms it is large: the wall there is interpolated,
however near the arms' samples are.

Vertices of one toolface lie a pitch apart, so each toolface is one line of depths. For each line the samples are
searched sector by sector outwards, nearest sector first, for all its vertices at once.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from helibore.base.arrays import Floats
from helibore.samples.helix import Helix


def angular_gap(helix: Helix, count: int, depth: Floats, toolface: Floats, reach: float) -> Floats:
    """Return the gap at vertices 0 to ``count`` of a helix, (count,) degrees.

    Parameters
    ----------
    helix, count
        Where vertices lie, and how many.
    depth, toolface
        Of the samples, the depth rising: metres, degrees.
    reach
        Metres of depth, above and below a vertex, whose samples count; both ends included.
    """
    K = helix.sectors
    gap = np.full(count, 360.0)
    around = np.mod(toolface - helix.start_toolface, 360.0)
    sector = np.minimum((around * (K / 360.0)).astype(np.int64), K - 1)
    order = np.argsort(sector, kind="stable")  # of one sector in the order of depth
    starts = np.searchsorted(sector[order], np.arange(K + 1))
    depths = [depth[order[first:stop]] for first, stop in pairwise(starts)]
    angles = [around[order[first:stop]] for first, stop in pairwise(starts)]
    for line in range(min(K, count)):
        at = helix.depth(np.arange(line, count, K))
        own = line * (360.0 / K)
        sides = []
        for way in (1, -1):
            side = np.full(at.size, 360.0)
            rows = np.arange(at.size)
            for step in range(K + 1):  # the last one is the first again: its part on the other side
                number = (line + step if way == 1 else line - 1 - step) % K
                if depths[number].size:
                    off = np.mod(way * (angles[number] - own), 360.0)
                    first = np.searchsorted(depths[number], at[rows] - reach, "left")
                    stop = np.searchsorted(depths[number], at[rows] + reach, "right")
                    found = np.flatnonzero(stop > first)
                    bounds = np.column_stack([first[found], stop[found]]).ravel()
                    least = np.minimum.reduceat(np.append(off, np.inf), bounds)[::2] if found.size else off[:0]
                    side[rows[found]] = least
                    rows = np.delete(rows, found)
                    if not rows.size:
                        break
            sides.append(side)
        gap[line::K] = np.where(sides[0] == 0.0, 0.0, np.minimum(sides[0] + sides[1], 360.0))
    return gap

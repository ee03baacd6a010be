"""The empty boxes around the vertices of a wall: how large a gap left-out samples must stand in.

width    angle to the nearest sample within half a pitch of depth
height   depth to the nearest sample within half a sector of angle, at most 0.5 m
"""

from __future__ import annotations

import numpy as np

from helibore.base.arrays import Floats
from helibore.base.settings import Settings
from helibore.wall.estimates import Columns

_MOST_BOX_DEPTH, _BOXES = 0.5, 500


def empty_boxes(samples: Columns, settings: Settings, count: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Half the height (m) and half the width (degrees) of the empty boxes around random vertices of the wall.

    At most `_BOXES` different ones, repeated.
    """
    depth, toolface, _ = samples
    some = min(count, _BOXES)
    where, angle = rng.uniform(depth[0], depth[-1], some), rng.uniform(0.0, 360.0, some)
    height, width = np.full(some, _MOST_BOX_DEPTH), np.full(some, 180.0)
    reach = max(abs(settings.pitch) / 2, _MOST_BOX_DEPTH)
    first, last = np.searchsorted(depth, where - reach), np.searchsorted(depth, where + reach)
    for i in range(some):
        band = slice(first[i], last[i])
        along = np.abs(depth[band] - where[i])
        turn = np.abs((toolface[band] - angle[i] + 180.0) % 360.0 - 180.0)
        height[i] = along[turn <= 180.0 / settings.sectors].min(initial=_MOST_BOX_DEPTH)
        width[i] = turn[along <= abs(settings.pitch) / 2].min(initial=180.0)
    return np.resize(height, count), np.resize(width, count)

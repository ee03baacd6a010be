"""Where the hole runs, for the page: frames of the path at every `FRAME_STEP` metres of the wall's depth.

The page places a wall point itself: centre + R (cos(toolface) high + sin(toolface) right), centre and directions linear
between frames. Without a path the hole is straight and vertical below (0, 0), toolface 0 to the north.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from helibore.viewer.messages import FRAME_STEP
from helibore.viewer.scene import Frames, Helix


def count_for(helix: Helix, vertices: int, rows: int) -> int:
    """Frames needed for a wall of `vertices`, up to the end of its last tile, so that no tile waits for one."""
    tile = rows * helix.sectors
    span = (-(-max(vertices, 1) // tile) * tile + helix.sectors + 1) * abs(helix.pitch) / helix.sectors
    return int(np.ceil(span / FRAME_STEP)) + 2


def on_path(helix: Helix, path: Any | None, first: int, stop: int) -> Frames:
    """Return frames [first, stop). Past either end of the path they run on straight."""
    depth = helix.start_depth + np.arange(first, stop) * np.copysign(FRAME_STEP, helix.pitch)
    count = len(depth)
    if path is None:
        centre = np.column_stack([np.zeros(count), np.zeros(count), depth])
        north, east = (np.tile(axis, (count, 1)) for axis in ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]))
        return Frames(centre, north, east, surveyed=False)
    inside = np.clip(depth, path.start_depth, path.stop_depth)
    frame = path.frame(inside)
    beyond = (depth - inside)[:, None] * frame[:, 2]
    return Frames(path.position(inside) + beyond, frame[:, 0], frame[:, 1])

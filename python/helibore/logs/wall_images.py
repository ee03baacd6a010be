"""Radius, uncertainty and images of a wall by turn and sector, as images of a table of logs.

    row      one turn of the helix, at its mean depth    sector   one vertex of the turn
    RADIUS, RADIUS_SIGMA                                 centred on the toolface of the vertices
    NAME_IMG, an image of the wall                       centred half a sector further on, as the quads of a mesh

The row of a turn holds its vertices, which lie up to half a pitch above and below its mean depth.
"""

from __future__ import annotations

import re
from types import SimpleNamespace
from typing import Any, cast

import numpy as np

from helibore.base.arrays import Floats
from helibore.base.tables import LogImage
from helibore.samples.helix import WallLike


def wall_images(wall: Any, sigma: bool = False) -> list[LogImage]:
    """Return the radius of a wall, its sigma if asked for, and its images, with one row for each whole turn.

    ``logs.table(images=wall_images(wall)).save("w.dlis")`` writes them beside the logs of the same wall. Descriptions
    state what toolfaces count from and the order of the sectors. An image with another reference than the wall's path
    is turned (`SectorImage.onto`).

    Parameters
    ----------
    wall
        A `helibore.Wall`.
    sigma
        Whether to add the standard uncertainty of each radius, which leaves samples out.
    """
    sectors, zero = wall.settings.sectors, wall.settings.start_toolface
    turns = wall.radius.size // sectors
    from_what = getattr(wall.path, "reference", None) or "an unstated zero"
    order = f"sectors clockwise looking downhole, toolface from {from_what}"

    def by_turn(values: Floats) -> Floats:
        return values[: turns * sectors].reshape(turns, sectors)

    found = [LogImage("RADIUS", "m", f"Radius of the wall, {order}", by_turn(wall.radius), zero)]
    if sigma:
        text = f"Standard uncertainty of RADIUS, {order}"
        found.append(LogImage("RADIUS_SIGMA", "m", text, by_turn(wall.sigma), zero))
    for name, image in wall.images.items():
        values = by_turn(image.on(_centred(wall)))
        mnemonic = re.sub(r"[^A-Z0-9_]", "_", name.upper())
        mnemonic = f"{mnemonic if mnemonic[:1].isalpha() else f'IMAGE_{mnemonic}'}_IMG"
        while any(mnemonic == each.mnemonic for each in found):
            mnemonic += "_"
        unit = image.unit.encode("ascii", "replace").decode()
        found.append(LogImage(mnemonic, unit, f"Image, {order}", values, zero + 180.0 / sectors))
    return found


def _centred(wall: Any) -> WallLike:
    """Return a helix whose quads have their centres at the depths of the wall's vertices, one for each vertex."""
    sectors, pitch = wall.settings.sectors, wall.settings.pitch
    start = wall.start_depth - (sectors + 1) / 2 * pitch / sectors
    room = np.empty(wall.radius.size + sectors + 1)
    shifted = SimpleNamespace(settings=wall.settings, start_depth=start, radius=room, path=wall.path, threads=None)
    return cast(WallLike, shifted)

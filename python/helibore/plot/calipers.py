"""Diameters along the hole, as the caliper track draws them: by area, least and greatest, pairs, one row a turn.

    across(toolface) = r(toolface) + r(toolface + 180)      by area = 2 sqrt(mean(r^2))

Of more turns than a picture has rows, a row shows the mean, the least and the greatest of its turns, so that no
washout of one turn is lost. Derived logs for files are in ``helibore.logs.turn_logs``.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from helibore.base.arrays import Floats
from helibore.logs.turn_logs import turn_logs
from helibore.samples.helix import WallLike


@dataclass(frozen=True)
class Diameters:
    """One row a turn, from the shallowest to the deepest, each (rows,) float64, metres; NaN where missing.

    Attributes
    ----------
    depth
        Of the middle of the turn.
    area
        Diameter of the circle of the same area; NaN unless the turn is whole.
    c1, c2
        Largest diameter of the turn and the one at right angles to it; NaN unless the turn is whole.
    d0, d90
        Diameters across toolfaces 0 and 180, and 90 and 270; NaN unless the turn is whole.
    least, greatest
        Across the hole, through the axis; of what is there.
    coverage
        Share of the turn that has a radius.
    """

    depth: Floats
    area: Floats
    c1: Floats
    c2: Floats
    d0: Floats
    d90: Floats
    least: Floats
    greatest: Floats
    coverage: Floats


NAMES = tuple(field.name for field in fields(Diameters))


def diameters(wall: WallLike, bit_diameter: float) -> Diameters:
    """Measure every full turn of a wall."""
    logs = turn_logs(wall, bit_diameter)
    K = wall.settings.sectors
    by_turn = wall.radius[: logs.depth.size * K].reshape(-1, K)
    half = K // 2  # with an odd number the far side is the mean of the two vertices next to it
    far = 0.5 * (np.roll(by_turn, -half, axis=1) + np.roll(by_turn, -((K + 1) // 2), axis=1))
    across = by_turn + far
    columns = {
        "depth": logs.depth,
        "area": logs.equivalent_diameter,
        "c1": logs.c1,
        "c2": logs.c2,
        "d0": logs.diameter_0,
        "d90": logs.diameter_90,
        "least": np.fmin.reduce(across, axis=1),
        "greatest": np.fmax.reduce(across, axis=1),
        "coverage": logs.coverage,
    }
    order = slice(None) if wall.settings.pitch > 0 else slice(None, None, -1)
    return Diameters(**{name: column[order] for name, column in columns.items()})


def thinned(turns: Diameters, top: float, bottom: float, rows: int) -> Diameters:
    """Return the turns between two depths, at most about ``rows`` rows of them."""
    inside = slice(np.searchsorted(turns.depth, top), np.searchsorted(turns.depth, bottom, side="right"))
    columns = {name: getattr(turns, name)[inside] for name in NAMES}
    count = columns["depth"].size
    if count <= rows:
        return Diameters(**columns)
    first = np.unique(np.arange(rows) * count // rows)
    sizes = np.diff(np.append(first, count))
    found = {
        "least": np.fmin.reduceat(columns["least"], first),
        "greatest": np.fmax.reduceat(columns["greatest"], first),
    }
    for name in ("depth", "coverage"):
        found[name] = np.add.reduceat(columns[name], first) / sizes
    for name in ("area", "c1", "c2", "d0", "d90"):  # of a row at least half of whose turns are whole
        there = np.isfinite(columns[name])
        total = np.add.reduceat(np.where(there, columns[name], 0.0), first)
        known = np.add.reduceat(there.astype(np.float64), first)
        found[name] = np.where(2 * known >= sizes, total / np.maximum(known, 1), np.nan)
    return Diameters(**found)

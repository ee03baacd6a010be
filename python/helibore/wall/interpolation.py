"""Interpolate values that were measured with the samples, with the weights of the wall's radius.

    gamma on the wall:   sum(w v) / sum(w)   over the neighbours of each vertex that have a value

w is the weight and v the value of a neighbour. Neighbours and weights are those of the radius (Energies 2021, 14, 291).
Sector images are not interpolated here, but by `SectorImage`.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from helibore.base.angles import wrapped
from helibore.base.arrays import Floats, Integers, column
from helibore.base.errors import InputError
from helibore.samples.caliper import Caliper
from helibore.wall.wall_columns import WallColumns


def canonical_order(caliper: Caliper) -> Integers:
    """Return the rows of ``caliper``, (m,), in the order of `Wall.samples`; with times, equal rows count once."""
    if caliper.time is None:
        return np.argsort(caliper.depth, kind="stable")
    columns = (caliper.depth, caliper.time, wrapped(caliper.toolface), caliper.radius)
    order = np.lexsort(columns[::-1])
    same = np.ones(order.size, dtype=bool)
    same[:1] = False
    for values in columns:
        same[1:] &= values[order[1:]] == values[order[:-1]]
    return order[~same]


def in_canonical_order(samples: Caliper, values: npt.ArrayLike, caliper: Caliper | None) -> Floats:
    """Reorder ``values`` from the rows of ``caliper`` (None: of ``samples``) to the rows of a wall's ``samples``."""
    if caliper is None:
        return column("values", values, len(samples), "the wall")
    array = column("values", values, len(caliper), "caliper")
    order = canonical_order(caliper)
    if not all(np.array_equal(getattr(caliper, name)[order], getattr(samples, name)) for name in ("depth", "radius")):
        raise InputError("caliper", "must hold the samples of the wall, in the order they were appended")
    return array[order]


def on_quads(values: Floats, sectors: int) -> Floats:
    """Return the mean of the four corners of each quad (k, k+1, k+1+K, k+K), (q,); NaN if a corner is NaN."""
    count = max(values.size - sectors - 1, 0)
    corners = [values[first : first + count] for first in (0, 1, sectors + 1, sectors)]
    mean: Floats = (corners[0] + corners[1] + corners[2] + corners[3]) / 4
    return mean


def measured_quads(wall: WallColumns) -> Floats:
    """Return 1 for each quad whose four corners are measured (`Wall.measured`), 0 for the others, (q,)."""
    measured: Floats = (on_quads(wall.measured.astype(np.float64), wall.settings.sectors) == 1.0).astype(np.float64)
    return measured

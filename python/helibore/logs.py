"""Logs of a wall: one row for every full turn of its helix.

    area = 1/2 int r^2 dtoolface = pi mean(r^2)        equivalent diameter = 2 sqrt(mean(r^2))

The mean over evenly spaced toolfaces is the periodic trapezoid rule: for a smooth hole its error falls faster than any
power of the sectors, where the area of the polygon loses 2.5 % at 16. A turn with a missing radius has no area, since
what is missing need not be like what is there; `coverage` says how much there is. The last turn counts when it is full.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from helibore.arrays import Floats
from helibore.surface import WallLike


@dataclass(frozen=True)
class TurnLogs:
    """Columns of one row a turn, each (turns,) float64, owned; made by `turn_logs`.

    Attributes
    ----------
    depth
        Mean depth of the turn's vertices, metres.
    mean, smallest, largest
        Radius, metres. The mean is NaN unless the turn is whole; the others are of what is there.
    equivalent_diameter
        Diameter of the circle of the same area, metres; NaN unless the turn is whole.
    volume
        Volume of the hole over one pitch, cubic metres; NaN unless the turn is whole.
    excess
        Volume over that of a hole of bit size, as a fraction of the latter: 0.1 is ten percent; negative where the hole
        is under gauge; NaN unless the turn is whole.
    coverage
        Vertices with a radius, as a fraction of the turn.
    """

    depth: Floats
    mean: Floats
    smallest: Floats
    largest: Floats
    equivalent_diameter: Floats
    volume: Floats
    excess: Floats
    coverage: Floats


def turn_logs(wall: WallLike, bit_diameter: float) -> TurnLogs:
    """Measure every full turn of a wall.

    Parameters
    ----------
    wall
        Radii on a helix; it is not changed.
    bit_diameter
        Metres; what `TurnLogs.excess` compares with.

    Raises
    ------
    ValueError
        ``bit_diameter = 0: must be finite and above 0``.
    """
    if not (np.isfinite(bit_diameter) and bit_diameter > 0):
        raise ValueError(f"bit_diameter = {bit_diameter}: must be finite and above 0")
    K, pitch = wall.settings.sectors, wall.settings.pitch
    radius = wall.radius
    turns = radius.size // K
    radius = radius[: turns * K].reshape(turns, K)
    square = np.einsum("ij,ij->i", radius, radius) / K
    coverage = np.ones(turns)
    broken = np.isnan(square)
    coverage[broken] = np.mean(~np.isnan(radius[broken]), axis=1)
    volume = np.pi * square * abs(pitch)
    return TurnLogs(
        depth=wall.start_depth + (np.arange(turns, dtype=np.float64) * K + (K - 1) / 2) * (pitch / K),
        mean=radius.mean(axis=1),
        smallest=np.fmin.reduce(radius, axis=1),
        largest=np.fmax.reduce(radius, axis=1),
        equivalent_diameter=2 * np.sqrt(square),
        volume=volume,
        excess=square / (bit_diameter / 2) ** 2 - 1,
        coverage=coverage,
    )

"""The settings of a wall. The radius of every vertex depends only on these settings and on the samples."""

from __future__ import annotations

import math
import operator
from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from helibore.base.errors import InputError

_OPTIONAL = ("start_depth", "stop_depth", "window", "max_distance", "kriging_range", "stop_vertex")


@dataclass(frozen=True, kw_only=True)
class Settings:
    """Settings of a wall; the method was published in Energies 2021, 14, 291.

    Attributes
    ----------
    bit_diameter
        Metres, 0.001 to 4; the first trial radius is half of it.
    sectors
        K, the number of vertices in a turn; 3 or more.
    pitch
        Metres along the hole from one turn to the next; negative for a well logged upwards.
    start_depth, stop_depth
        Depths at which the helix starts and stops, metres, within 1e7 of 0; None: the depths of the first and of the
        last sample along the helix.
    start_toolface
        Toolface of vertex 0, degrees, within 1e6 of 0.
    first_vertex, stop_vertex
        The wall is a stretch of the helix, from ``first_vertex``, a multiple of ``sectors``, up to but without
        ``stop_vertex``, which replaces ``stop_depth``; None: to the last sample. If ``first_vertex`` is not 0,
        ``start_depth`` must be given. The values of the stretch equal those of the whole wall exactly if it gets all
        samples within `Wall.reach`.
    neighbors
        V, the number of nearest samples that a vertex is estimated from; 1 to 256, with kriging 1 to 64. None: 8, with
        kriging 16.
    window
        U: search only this many consecutive samples around the vertex's depth, as published; None: search all, exactly.
    power
        Weights are distance^-power; above 0, at most 100.
    max_distance
        Metres, 1e-9 or more; samples farther away are not used; None: no limit.
    max_iterations, tolerance
        The estimate is repeated with the new radius until the radius moves by at most ``tolerance`` metres, and at most
        ``max_iterations`` times.
    angular_scale
        0.001 to 1000. 1: distances around the hole are true arc lengths; 2: twice that, as in the published Eq. 4.
        Above 1, more neighbours lie above and below than around: 4 halves the error of many holes, whose shape changes
        little with depth (``bench/accuracy/angular_scale.py``).
    estimator
        'inverse-distance', the published method; or 'kriging': ordinary kriging of the neighbours that the last
        estimate by inverse distance used, at its trial radius. Kriging weighs neighbours by how alike two radii are at
        their distance, so it averages out noise and follows slopes. Its radius may lie outside the radii used, by at
        most half of their range.
    kriging_range
        Metres, in the metric of ``angular_scale``: the distance from which two radii are no longer correlated (the
        covariance is Wendland's C2 function); a range above half a turn counts as half a turn. None:
        `helibore.reconstruct` takes four times the median distance of the 16th nearest sample; a live wall must be
        given a range.
    nugget
        Variance of the noise divided by the variance of the shape, for kriging; at least 1e-6.
    sigma
        Keep for each vertex the sums from which `Wall.sigma` is computed; `Wall.sigma` then need not estimate all
        vertices again. Radii do not depend on this setting.
    gap_reach, largest_gap
        A part of the turn counts as measured where the angle between the nearest samples on its two sides, within
        ``gap_reach`` metres of depth, is at most ``largest_gap`` degrees. Radii do not depend on these two settings.
    direct
        Direct connection (published Eq. 6), for live walls: where a vertex is not settled and samples lie in its cell
        (half a sector to either side, half a pitch up and down), the vertex takes the radius of the last of these
        samples in canonical order. Once it is settled, it is interpolated like any other vertex.
    most_vertices
        An append that would give the wall more vertices is refused, and the error names the depth; so one wrong depth
        does not fill the memory. 1 to 2147483647.
    """

    bit_diameter: float
    sectors: int = 64
    pitch: float = 0.1
    start_depth: float | None = None
    stop_depth: float | None = None
    start_toolface: float = 0.0
    neighbors: int = cast(int, None)  # becomes 8 or 16
    window: int | None = None
    power: float = 1.0
    max_distance: float | None = 1.0
    max_iterations: int = 4
    tolerance: float = 1e-6
    angular_scale: float = 1.0
    estimator: str = "inverse-distance"
    kriging_range: float | None = None
    nugget: float = 0.1
    sigma: bool = False
    direct: bool = False
    first_vertex: int = 0
    stop_vertex: int | None = None
    gap_reach: float = 0.5
    largest_gap: float = 60.0
    most_vertices: int = 100_000_000

    def __post_init__(self) -> None:
        if self.neighbors is None:
            object.__setattr__(self, "neighbors", 16 if self.estimator == "kriging" else 8)
        for name, value in vars(self).items():
            if value is not None or name not in _OPTIONAL:
                self.__dict__[name] = _checked(name, value)
        if not (math.isfinite(self.gap_reach) and self.gap_reach > 0):
            raise InputError("gap_reach", "must be finite and above 0", str(self.gap_reach))
        if not 0 < self.largest_gap <= 360:
            raise InputError("largest_gap", "must be above 0 and at most 360", str(self.largest_gap))


def _checked(name: str, value: Any) -> float | int | bool | str:
    """Return the value of a setting, converted to the type of this setting; an integer must fit into 32 bits."""
    if name == "estimator":
        if value not in ("inverse-distance", "kriging"):
            raise InputError(name, "must be 'inverse-distance' or 'kriging'", repr(value))
        return str(value)
    if name in ("direct", "sigma"):
        if not isinstance(value, bool | np.bool_):
            raise InputError(name, "must be True or False", repr(value))
        return bool(value)
    whole = name in ("sectors", "neighbors", "max_iterations", "window", "most_vertices", "first_vertex", "stop_vertex")
    try:
        made = operator.index(value) if whole else float(value)
    except (TypeError, ValueError):
        raise InputError(name, f"must be {'an integer' if whole else 'a number'}", repr(value)) from None
    if whole and abs(made) >= 2**31:
        raise InputError(name, "absolute value must be below 2147483648", str(made))
    return made

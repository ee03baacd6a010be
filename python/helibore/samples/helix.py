"""The helix of a wall: where each vertex lies along and around the hole. Surfaces, volumes and images use it.

Vertex k has depth start_depth + k pitch/K and toolface (start_toolface + k 360/K) mod 360. A helix has neither radii
nor positions in space.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np

from helibore.base.arrays import Floats, Integers
from helibore.base.errors import InputError
from helibore.samples.caliper import Basis, basis_text
from helibore.settings.wall_settings import Settings


class WallLike(Protocol):
    """What surfaces, volumes, images and logs need of a wall; `helibore.Wall` is such a wall."""

    @property
    def settings(self) -> Settings: ...
    @property
    def start_depth(self) -> float: ...
    @property
    def radius(self) -> Floats: ...


class Helix(NamedTuple):
    """A helix in metres and degrees; ``pitch`` is negative if the helix grows upwards."""

    start_depth: float
    start_toolface: float
    pitch: float
    sectors: int
    first: int = 0  # number that vertex 0 of this helix has on the whole helix, a multiple of sectors

    def depth(self, k: Integers) -> Floats:
        """Return the depth of vertices, metres, equal to the depths of the wall to the last bit."""
        depth: Floats = self.start_depth + (self.first + k) * self.pitch / self.sectors
        return depth

    def turn_depths(self, turns: int) -> Floats:
        """Return the depths of the middles of the first turns, metres."""
        number = self.first // self.sectors + np.arange(turns, dtype=np.float64)
        return self.start_depth + (number * self.sectors + (self.sectors - 1) / 2) * (self.pitch / self.sectors)

    def toolface(self, k: Integers) -> Floats:
        """Return the toolface of vertices, degrees in [0, 360); every turn has the toolfaces of the first turn."""
        first = np.mod(self.start_toolface + np.arange(self.sectors) * 360.0 / self.sectors, 360.0)
        toolface: Floats = first[k % self.sectors]
        return toolface

    def ends(self, vertices: int) -> tuple[float, float]:
        """Return the depths of the shallowest and the deepest of this many vertices, metres; ``first`` must be 0."""
        last = self.start_depth + (vertices - 1) * self.pitch / self.sectors
        return min(self.start_depth, last), max(self.start_depth, last)

    def between(self, start: float, stop: float, vertices: int) -> slice:
        """Return which vertices, of a wall of this many ``vertices``, have depths in [start, stop], metres: a slice."""
        sign = math.copysign(1.0, self.pitch)
        low, high = (start, stop) if sign > 0 else (-stop, -start)

        def along(k: int) -> float:
            return sign * (self.start_depth + (self.first + k) * self.pitch / self.sectors)

        places = range(vertices)
        return slice(bisect_left(places, low, key=along), bisect_right(places, high, key=along))

    def quads(self, vertices: int) -> int:
        """Return the number of quads between ``vertices`` vertices."""
        return quad_room(vertices, self.sectors)


def quad_room(vertices: int, sectors: int) -> int:
    """Return the number of quads between ``vertices`` vertices of a helix with this many ``sectors`` in a turn."""
    return max(vertices - sectors - 1, 0)


def helix_of(wall: WallLike) -> Helix:
    """Return the helix of a wall; a wall without samples has no start depth yet and gets depth 0."""
    settings, start = wall.settings, float(wall.start_depth)
    return Helix(
        0.0 if math.isnan(start) else start,
        float(settings.start_toolface),
        float(settings.pitch),
        int(settings.sectors),
    )


def whole_helix(wall: WallLike) -> Helix:
    """Return the whole helix of which a wall may be a stretch (``first_vertex``).

    On the whole helix, the depths of this wall's vertices equal those of the whole wall to the last bit.
    """
    settings: Any = wall.settings
    helix, first = helix_of(wall), getattr(settings, "first_vertex", 0)
    return helix._replace(start_depth=settings.start_depth, first=first) if first else helix


def basis_of(wall: WallLike) -> Basis:
    """Return the basis of a wall; a wall without the attribute ``basis`` counts as azimuthal."""
    basis: Basis = getattr(wall, "basis", "azimuthal")
    return basis


def basis_text_of(wall: WallLike) -> str:
    """Return the basis of a wall in words; a wall without ``basis_text`` gets the usual words for its basis."""
    text: str = getattr(wall, "basis_text", basis_text(basis_of(wall)))
    return text


def vertex_range(helix: Helix, count: int, start: float | None, stop: float | None) -> tuple[int, int]:
    """Return the half-open range of vertices whose depth lies in [start, stop), whichever way the helix grows.

    If ``start`` or ``stop`` is None, there is no bound on that side. Raises InputError if a bound is not finite,
    ``stop`` is not greater than ``start``, or no vertex lies in the interval.
    """
    for name, bound in (("start", start), ("stop", stop)):
        if bound is not None and not math.isfinite(bound):
            raise InputError(name, "must be finite", str(bound))
    if start is not None and stop is not None and start >= stop:
        raise InputError("stop", f"must be greater than start = {start:g}", f"{stop:g}")

    def depth(k: int) -> float:
        return helix.start_depth + k * helix.pitch / helix.sectors

    if helix.pitch > 0:
        first = 0 if start is None else bisect_left(range(count), start, key=depth)
        last = count if stop is None else bisect_left(range(count), stop, key=depth)
    else:
        first = 0 if stop is None else bisect_right(range(count), -stop, key=lambda k: -depth(k))
        last = count if start is None else bisect_right(range(count), -start, key=lambda k: -depth(k))
    if first >= last and not (start is None and stop is None):
        reach = f"reaches from {depth(0):g} to {depth(count - 1):g} m" if count else "is empty"
        raise InputError(f"start = {start}, stop = {stop}", f"no vertex lies in [start, stop); the wall {reach}")
    return first, last


def expand_ranges(ranges: Integers) -> Integers:
    """Return all integers in half-open ranges [start, stop), (m, 2), in order."""
    return np.concatenate([np.arange(start, stop) for start, stop in ranges] or [np.arange(0)])


def numbered(ranges: Sequence[Integers]) -> Integers:
    """Return for each integer in several arrays of half-open ranges, in order, which array holds it: 0, 1 and so on."""
    counts = [int((of[:, 1] - of[:, 0]).sum()) for of in ranges]
    return np.repeat(np.arange(len(counts)), counts)

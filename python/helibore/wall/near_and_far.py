"""Kriging with near and far neighbours at single places, in NumPy: for expected errors, and with samples left out.

The core kriges the vertices of a wall in groups of eight that share their neighbours (`cpp/src/search/near_far.hpp`).
Here, each place has its own; their expected errors agree within some per cent. Samples in a box around a place can be
left out, and a place has its expected error under the covariance.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from helibore import _core
from helibore.base.arrays import Floats, Integers, distinct
from helibore.base.thread_count import thread_count
from helibore.settings.wall_settings import Settings
from helibore.wall.covariance import Covariance, Term, covariance_of
from helibore.wall.estimates import Boxes, Columns, in_core

SHARE = 0.35
"""Size of a cell of the thinned set, as a share of the lengths of the long term; also in `near_far.cpp`."""
_MOST_FAR = 4_000
"""Samples that are looked at for far neighbours; of more, every nth one."""

_AT_ONCE = 200
"""Systems that are solved at once."""

Place = tuple[float, float]
"""Depth (m) and toolface (degrees)."""


class Places:
    """Neighbours of places on the wall among the samples, which are in order of depth."""

    def __init__(self, samples: Columns, covariance: Covariance, count: int, max_distance: float) -> None:
        self.samples, self.covariance, self.count, self.max_distance = samples, covariance, count, max_distance
        self._long = covariance.terms[min(1, len(covariance.terms) - 1)]

    def nearest(self, places: Sequence[Place], term: Term, count: int, boxes: Boxes | None = None) -> list[Integers]:
        """Return the rows of the nearest samples of each place by the lengths of a term, outside its box."""
        depth, toolface = np.array(places).reshape(-1, 2).T.copy()
        trial, none = np.full(depth.size, self.covariance.radius), np.full(depth.size, -1.0)
        limit = None if np.isinf(self.max_distance) else self.max_distance
        settings = Settings(bit_diameter=2.0 * self.covariance.radius, neighbors=count, max_distance=limit)
        points = (depth, toolface, trial, *(boxes or (none, none)))
        stretch = term.along / term.around
        found = _core.nearest_to(in_core(self.samples), points, vars(settings), stretch, thread_count(None))
        return [rows[rows >= 0] for rows in found]

    def neighbours(self, places: Sequence[Place], boxes: Boxes | None = None) -> list[Integers]:
        """Return the rows of the near and far neighbours of each place, in order."""
        near = [self.nearest(places, term, self.count, boxes) for term in self.covariance.terms[:2]]
        sizes = np.column_stack(boxes or (np.full(len(places), -1.0),) * 2).tolist()
        far = [self._far(place, box) for place, box in zip(places, sizes, strict=True)]
        return [distinct(np.concatenate(rows)) for rows in zip(*near, far, strict=True)]

    def across(self, toolface: Floats, at: float) -> Floats:
        """Return the arc lengths from toolfaces to another, metres."""
        turn = np.abs(toolface - at)
        found: Floats = np.radians(np.minimum(turn, 360.0 - turn)) * self.covariance.radius
        return found

    def _outside(self, rows: Integers, place: Place, box: Sequence[float]) -> Integers:
        if box[0] < 0:
            return rows
        depth, toolface, _ = self.samples
        turn = np.abs(toolface[rows] - place[1])
        turn = np.minimum(turn, 360.0 - turn)
        return rows[(np.abs(depth[rows] - place[0]) > box[0]) | (turn > box[1])]

    def _far(self, place: Place, box: Sequence[float]) -> Integers:
        depth, toolface, _ = self.samples
        height = SHARE * self._long.along
        around = int(np.ceil(2.0 * np.pi * self.covariance.radius / (SHARE * self._long.around)))
        half = min(self.max_distance, 1.5 * self._long.along + max(box[0], 0.0))
        first, last = np.floor((place[0] - half) / height) * height, np.ceil((place[0] + half) / height) * height
        start, stop = np.searchsorted(depth, [first, last])
        rows = self._outside(np.arange(start, stop, 1 + (stop - start) // _MOST_FAR), place, box)
        turned = (toolface[rows] - self.covariance.turn * depth[rows]) % 360.0
        column = np.minimum((turned * (around / 360.0)).astype(np.int64), around - 1)
        cell = np.floor((depth[rows] - first) / height).astype(np.int64) * around + column
        of_cell = np.full(cell.max(initial=-1) + 1, -1)
        of_cell[cell[::-1]] = rows[::-1]  # the first row of a cell is assigned last
        rows = of_cell[of_cell >= 0]
        along = depth[rows] - place[0]
        across = self.across((toolface[rows] - self.covariance.turn * along) % 360.0, place[1])
        rows, along, across = _within(self.max_distance, rows, along, across)
        square = (across / self._long.around) ** 2 + (along / self._long.along) ** 2
        return rows if rows.size <= self.count else rows[np.argpartition(square, self.count - 1)[: self.count]]

    def between(self, rows: Integers) -> Floats:
        """Return the covariances of samples with each other, noise included; of m rows of n samples, (m, n, n)."""
        depth, toolface, _ = self.samples
        turn, along = (of[rows][..., :, None] - of[rows][..., None, :] for of in (toolface, depth))
        return self.covariance.at(turn, along) + self.covariance.noise * np.eye(rows.shape[-1])

    def toward(self, rows: Integers, place: tuple[Floats, Floats] | Place) -> Floats:
        """Return the covariances of samples with the radius at a place."""
        depth, toolface, _ = self.samples
        return self.covariance.at(toolface[rows] - place[1], depth[rows] - place[0])

    def estimates(self, places: Sequence[Place], boxes: Boxes | None = None) -> Floats:
        """Return the radius at each place (m) and its kriging variance (m^2), (m, 2); NaN if it has no neighbour."""
        rows, found = self.neighbours(places, boxes), np.full((len(places), 2), np.nan)
        for first in range(0, len(places), _AT_ONCE):
            part = slice(first, first + _AT_ONCE)
            found[part] = self._estimates(places[part], rows[part])
        return found

    def _estimates(self, places: Sequence[Place], rows: list[Integers]) -> Floats:
        """Solve all systems at once: those of fewer neighbours have rows of 0 more, and 1 on the diagonal."""
        counts = np.array([of.size for of in rows])
        used = np.arange(max(counts.max(), 1)) < counts[:, None]
        all_rows = np.zeros(used.shape, dtype=np.int64)
        all_rows[used] = np.concatenate(rows)
        matrix = np.where(used[:, :, None] & used[:, None], self.between(all_rows), np.eye(used.shape[1]))
        at = np.array(places).T[..., None]
        toward = used * self.toward(all_rows, (at[0], at[1]))
        radius = used * (self.samples[2][all_rows] - self.covariance.radius)
        one, value, of_place = np.moveaxis(np.linalg.solve(matrix, np.stack([1.0 * used, radius, toward], -1)), -1, 0)
        with np.errstate(divide="ignore", invalid="ignore"):  # without a neighbour 0 / 0
            mean = value.sum(axis=1) / one.sum(axis=1)
            rest = (1.0 - of_place.sum(axis=1)) ** 2 / one.sum(axis=1)
        estimate = self.covariance.radius + mean + np.sum(toward * (value - mean[:, None] * one), axis=1)
        variance = np.maximum(self.covariance.variance - np.sum(toward * of_place, axis=1) + rest, 0.0)
        return np.where(counts[:, None] > 0, np.column_stack([estimate, variance]), np.nan)

    def square_error(self, rows: Integers, weights: Floats, place: Place) -> float:
        """Return the expected square of the error of a weighted mean of samples at a place, m^2."""
        expected = weights @ self.between(rows) @ weights - 2.0 * weights @ self.toward(rows, place)
        return max(float(self.covariance.variance + expected), 0.0)


def _within(max_distance: float, rows: Integers, along: Floats, across: Floats) -> tuple[Integers, Floats, Floats]:
    near = np.hypot(along, across) <= max_distance
    return rows[near], along[near], across[near]


def estimate_near_and_far(samples: Columns, rows: Integers, settings: Settings, box: Boxes | None = None) -> Floats:
    """Estimate the radius at each of the samples ``rows`` from the other samples, outside the box around it.

    Returns the radii (m) and their kriging variances (m^2), (m, 2); NaN where there is no neighbour. Without boxes,
    only samples at the same position are left out.
    """
    limit = np.inf if settings.max_distance is None else settings.max_distance
    among = Places(samples, covariance_of(settings.covariance or ()), settings.neighbors, limit)
    places = list(zip(samples[0][rows].tolist(), samples[1][rows].tolist(), strict=True))
    return among.estimates(places, box or (np.zeros(rows.size), np.zeros(rows.size)))

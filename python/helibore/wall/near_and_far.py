"""Kriging with near and far neighbours at single places, in NumPy: for expected errors, and with samples left out.

The core kriges the vertices of a wall in groups of eight that share their neighbours (`cpp/src/search/near_far.hpp`).
Here, each place has its own; their expected errors agree within some per cent. Samples in a box around a place can be
left out, and a place has its expected error under the covariance.
"""

from __future__ import annotations

import numpy as np

from helibore.base.arrays import Floats, Integers, distinct
from helibore.settings.wall_settings import Settings
from helibore.wall.covariance import Covariance, Term, covariance_of
from helibore.wall.estimates import Boxes, Columns

SHARE = 0.35
"""Size of a cell of the thinned set, as a share of the lengths of the long term; also in `near_far.cpp`."""
_MOST_FAR = 4_000
"""Samples that are looked at for far neighbours; of more, every nth one."""


class Places:
    """Neighbours of places on the wall among the samples, which are in order of depth."""

    def __init__(self, samples: Columns, covariance: Covariance, count: int, max_distance: float) -> None:
        self.samples, self.covariance, self.count, self.max_distance = samples, covariance, count, max_distance
        self._start = 0.5 * count * float(np.ptp(samples[0])) / samples[0].size + 0.02
        self._long = covariance.terms[min(1, len(covariance.terms) - 1)]

    def rows_between(self, low: float, high: float) -> Integers:
        """Return the rows of the samples with depths from ``low`` to ``high``."""
        start, stop = np.searchsorted(self.samples[0], [low, high])
        return np.arange(start, stop)

    def nearest(self, place: tuple[float, float], term: Term, count: int, box: tuple[float, float]) -> Integers:
        """Return the rows of the nearest samples by the lengths of a term, outside the box (m, deg)."""
        depth, toolface, _ = self.samples
        half = self._start + max(box[0], 0.0)
        while True:
            rows = self._outside(self.rows_between(place[0] - half, place[0] + half), place, box)
            along = depth[rows] - place[0]
            across = self.across(toolface[rows], place[1])
            rows, along, across = _within(self.max_distance, rows, along, across)
            square = (across / term.around) ** 2 + (along / term.along) ** 2
            whole = half > self.max_distance or (place[0] - half < depth[0] and place[0] + half > depth[-1])
            if rows.size > count:
                rows = rows[np.argpartition(square, count - 1)[:count]]
                if whole or np.partition(square, count - 1)[count - 1] <= (half / term.along) ** 2:
                    return rows
            elif whole:
                return rows
            half *= 2.0

    def neighbours(self, place: tuple[float, float], box: tuple[float, float] = (-1.0, -1.0)) -> Integers:
        """Return the rows of the near and far neighbours of a place (depth m, toolface deg), in order."""
        near = [self.nearest(place, term, self.count, box) for term in self.covariance.terms[:2]]
        return distinct(np.concatenate([*near, self._far(place, box)]))

    def across(self, toolface: Floats, at: float) -> Floats:
        """Return the arc lengths from toolfaces to another, metres."""
        turn = np.abs(toolface - at)
        found: Floats = np.radians(np.minimum(turn, 360.0 - turn)) * self.covariance.radius
        return found

    def _outside(self, rows: Integers, place: tuple[float, float], box: tuple[float, float]) -> Integers:
        if box[0] < 0:
            return rows
        depth, toolface, _ = self.samples
        turn = np.abs(toolface[rows] - place[1])
        turn = np.minimum(turn, 360.0 - turn)
        return rows[(np.abs(depth[rows] - place[0]) > box[0]) | (turn > box[1])]

    def _far(self, place: tuple[float, float], box: tuple[float, float]) -> Integers:
        depth, toolface, _ = self.samples
        height = SHARE * self._long.along
        around = int(np.ceil(2.0 * np.pi * self.covariance.radius / (SHARE * self._long.around)))
        half = min(self.max_distance, 1.5 * self._long.along + box[0])
        first, last = np.floor((place[0] - half) / height) * height, np.ceil((place[0] + half) / height) * height
        rows = self.rows_between(first, last)
        rows = self._outside(rows[:: 1 + rows.size // _MOST_FAR], place, box)
        cell = np.floor(depth[rows] / height) * around + np.floor(toolface[rows] * (around / 360.0))
        rows = rows[np.unique(cell, return_index=True)[1]]
        along, across = depth[rows] - place[0], self.across(toolface[rows], place[1])
        rows, along, across = _within(self.max_distance, rows, along, across)
        square = (across / self._long.around) ** 2 + (along / self._long.along) ** 2
        return rows if rows.size <= self.count else rows[np.argpartition(square, self.count - 1)[: self.count]]

    def between(self, rows: Integers) -> Floats:
        """Return the covariances of samples with each other, noise included."""
        depth, toolface, _ = self.samples
        turn, along = toolface[rows][:, None] - toolface[rows], depth[rows][:, None] - depth[rows]
        return self.covariance.at(turn, along) + self.covariance.noise * np.eye(rows.size)

    def toward(self, rows: Integers, place: tuple[float, float]) -> Floats:
        """Return the covariances of samples with the radius at a place."""
        depth, toolface, _ = self.samples
        return self.covariance.at(toolface[rows] - place[1], depth[rows] - place[0])

    def estimate(self, place: tuple[float, float], box: tuple[float, float] = (-1.0, -1.0)) -> tuple[float, float]:
        """Return the radius at a place (m) and its kriging variance (m^2); NaN if it has no neighbour."""
        rows = self.neighbours(place, box)
        if not rows.size:
            return np.nan, np.nan
        toward, radius = self.toward(rows, place), self.samples[2][rows]
        sides = np.stack([np.ones(rows.size), radius - self.covariance.radius, toward], axis=1)
        one, value, of_place = np.linalg.solve(self.between(rows), sides).T
        mean = value.sum() / one.sum()
        estimate = self.covariance.radius + mean + toward @ (value - mean * one)
        variance = self.covariance.variance - toward @ of_place + (1.0 - of_place.sum()) ** 2 / one.sum()
        return float(estimate), max(float(variance), 0.0)

    def square_error(self, rows: Integers, weights: Floats, place: tuple[float, float]) -> float:
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
    depth, toolface, _ = samples
    heights, widths = box or (np.zeros(rows.size), np.zeros(rows.size))
    found = [
        among.estimate((depth[row], toolface[row]), (height, width))
        for row, height, width in zip(rows, heights, widths, strict=True)
    ]
    return np.array(found).reshape(-1, 2)

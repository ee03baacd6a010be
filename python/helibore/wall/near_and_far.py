"""Kriging with near and far neighbours at single places, in NumPy: for expected errors, and with samples left out.

The core kriges the vertices of a wall in groups of eight that share their neighbours (`cpp/src/search/near_far.hpp`).
Here, each place has its own; their expected errors agree within some per cent. Samples in a box around a place can be
left out, and a place has its expected error under the covariance.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from helibore import _core
from helibore.base.arrays import Floats, Integers, Mask, distinct
from helibore.base.thread_count import thread_count
from helibore.settings.wall_settings import Settings
from helibore.wall.covariance import Covariance, CovarianceFrom, Term, excess_noise, likely_by, stretch_of, stretches_of
from helibore.wall.estimates import Boxes, Columns, in_core
from helibore.wall.spikes import BURST

SHARE, SMALL_SHARE = 0.35, 0.25
"""Size of the cell of a far neighbour, as a share of the lengths of the long term; the small one where noise is large.
These and the next two are also in `near_far.cpp`, which says what they do."""
_LARGE_NOISE = 0.25
_MOST_AVERAGED = 32
_BESIDE, _MOST_OFF = 8, 2.5
"""`Settings.robust`: neighbours with which one is compared, and deviations of the noise by which it may differ. Also in
`near_far.cpp`; so is `BURST`."""
_MOST_FAR = 4_000
"""Samples that are looked at for far neighbours; of more, every nth one."""

_AT_ONCE = 200
"""Systems that are solved at once."""

Place = tuple[float, float]
"""Depth (m) and toolface (degrees)."""


class Neighbours(NamedTuple):
    """Neighbours of one place, (n), or of m places, (m, n): samples, or means of some."""

    depth: Floats
    toolface: Floats
    radius: Floats
    members: Floats  # number of samples of each
    row: Floats  # of the first sample of each


class Places:
    """Neighbours of places on the wall among the samples, which are in order of depth."""

    def __init__(
        self, samples: Columns, of: Covariance | tuple[Sequence[CovarianceFrom], int], count: int, max_distance: float,
        robust: bool = False,
    ) -> None:  # fmt: skip
        """``of``: the covariance, or stretches of the hole and the number of that in which the places lie."""
        stretches, number = ([CovarianceFrom(-np.inf, of)], 0) if isinstance(of, Covariance) else of
        covariance = stretches[number].covariance
        self.samples, self.covariance, self.count = samples, covariance, count
        self.max_distance, self.robust = max_distance, robust
        self._stretches, self._number = stretches, number
        self._long = covariance.terms[min(1, len(covariance.terms) - 1)]
        noisy = covariance.noise > _LARGE_NOISE * self._long.variance
        self._share, self._averaged = (SMALL_SHARE, _MOST_AVERAGED) if noisy else (SHARE, 1)
        self._wanted = (3 * count + 1) // 2 if noisy else count
        self._height = self._share * self._long.along
        self._cells = (-1, -1), np.empty(0, np.int64), np.empty(0, np.int64)  # what _by_cells() returned last
        self._taken = np.zeros(samples[0].size, dtype=bool)

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

    def neighbours(self, places: Sequence[Place], boxes: Boxes | None = None) -> list[Neighbours]:
        """Return the near and far neighbours of each place."""
        near = [self.nearest(places, term, self.count, boxes) for term in self.covariance.terms[:2]]
        sizes = np.column_stack(boxes or (np.full(len(places), -1.0),) * 2).tolist()
        if self.covariance.half_turns:
            opposite = self.nearest([(z, (at + 180.0) % 360.0) for z, at in places], self._long, self.count)
            near.append([self._used(*of) for of in zip(opposite, places, sizes, strict=True)])
        found = []
        for place, box, *by_term in zip(places, sizes, *near, strict=True):
            rows = distinct(np.concatenate(by_term))
            both = zip(self.of_rows(rows), self._far(place, box, rows), strict=True)
            found.append(Neighbours._make(np.concatenate(parts) for parts in both))
        return found

    def of_rows(self, rows: Integers) -> Neighbours:
        """Return samples as neighbours."""
        depth, toolface, radius = self.samples
        return Neighbours(depth[rows], toolface[rows], radius[rows], np.ones(rows.size), rows.astype(np.float64))

    def across(self, toolface: Floats, at: float) -> Floats:
        """Return the arc lengths from toolfaces to another, metres."""
        turn = np.abs(toolface - at)
        found: Floats = np.radians(np.minimum(turn, 360.0 - turn)) * self.covariance.radius
        return found

    def _used(self, rows: Integers, place: Place, box: Sequence[float]) -> Integers:
        rows, (depth, toolface, _) = rows[self._outside(rows, place, box)], self.samples
        distance = np.hypot(depth[rows] - place[0], self.across(toolface[rows], place[1]))
        return rows[distance <= self.max_distance]

    def _outside(self, rows: Integers, place: Place, box: Sequence[float]) -> Mask:
        depth, toolface, _ = self.samples
        turn = np.abs(toolface[rows] - place[1])
        turn = np.minimum(turn, 360.0 - turn)
        return (np.abs(depth[rows] - place[0]) > box[0]) | (turn > box[1])

    def _by_cells(self, first: float, last: float) -> tuple[Integers, Integers]:
        """Return the rows of samples between two depths, in order of their cells, and the cells."""
        depth, toolface, _ = self.samples
        start, stop = np.searchsorted(depth, [first, last]).tolist()
        if self._cells[0] != (start, stop):
            rows = np.arange(start, stop, 1 + (stop - start) // _MOST_FAR)
            around = int(np.ceil(2.0 * np.pi * self.covariance.radius / (self._share * self._long.around)))
            turned = (toolface[rows] - self.covariance.turn * depth[rows]) % 360.0
            column = np.minimum((turned * (around / 360.0)).astype(np.int64), around - 1)
            cell = np.floor((depth[rows] - first) / self._height).astype(np.int64) * around + column
            order = np.argsort(cell, kind="stable")
            self._cells = (start, stop), rows[order], cell[order]
        return self._cells[1:]

    def _far(self, place: Place, box: Sequence[float], near: Integers) -> Neighbours:
        depth, toolface, radius = self.samples
        half = min(self.max_distance, 1.5 * self._long.along + max(box[0], 0.0))
        first, last = np.floor((place[0] - half) / self._height), np.ceil((place[0] + half) / self._height)
        rows, cell = self._by_cells(first * self._height, last * self._height)
        self._taken[near] = True
        free = self._outside(rows, place, box) & ~self._taken[rows]
        self._taken[near] = False
        rows, cell = rows[free], cell[free]
        starts = np.flatnonzero(np.diff(cell, prepend=-1))
        stretch = stretch_of(self._stretches, depth[rows])  # a mean of unlike stretches is like neither
        ends = np.append(np.flatnonzero((np.diff(cell) != 0) | (np.diff(stretch) != 0)) + 1, rows.size)
        stops = np.minimum(ends[np.searchsorted(ends, starts, side="right")], starts + self._averaged)
        leads = rows[starts]
        along = depth[leads] - place[0]
        across = self.across((toolface[leads] - self.covariance.turn * along) % 360.0, place[1])
        within = np.flatnonzero(np.hypot(along, across) <= self.max_distance)
        if self.covariance.half_turns:
            across = np.minimum(across, np.pi * self.covariance.radius - across)
        square = (across / self._long.around) ** 2 + (along / self._long.along) ** 2
        if within.size > self._wanted:
            within = within[np.argpartition(square[within], self._wanted - 1)[: self._wanted]]
        if not within.size:
            return self.of_rows(within)
        counts = (stops - starts)[within]
        begins = np.cumsum(counts) - counts
        of_cells = rows[np.repeat(starts[within] - begins, counts) + np.arange(counts.sum())]
        heads, leads = leads[within], np.repeat(leads[within], counts)
        down = depth[of_cells] - depth[leads]
        turn = (toolface[of_cells] - toolface[leads] - self.covariance.turn * down + 180.0) % 360.0 - 180.0
        means = [np.add.reduceat(of, begins) / counts for of in (down, turn, radius[of_cells])]
        at = depth[heads] + means[0], toolface[heads] + means[1] + self.covariance.turn * means[0]
        return Neighbours(*at, means[2], counts.astype(np.float64), heads.astype(np.float64))

    def between(self, of: Neighbours) -> Floats:
        """Return the covariances of neighbours with each other, noise included, (n, n) or (m, n, n)."""
        turn, along = (at[..., :, None] - at[..., None, :] for at in (of.toolface, of.depth))
        noise = self.covariance.noise / of.members + excess_noise(self._stretches, self._number, of.depth)
        return self.covariance.at(turn, along) + noise[..., None] * np.eye(of.depth.shape[-1])

    def toward(self, of: Neighbours, place: tuple[Floats, Floats] | Place) -> Floats:
        """Return the covariances of neighbours with the radius at a place."""
        return self.covariance.at(of.toolface - place[1], of.depth - place[0])

    def estimates(self, places: Sequence[Place], boxes: Boxes | None = None) -> Floats:
        """Return the radius at each place (m) and its kriging variance (m^2), (m, 2); NaN if it has no neighbour."""
        neighbours, found = self.neighbours(places, boxes), np.full((len(places), 2), np.nan)
        for first in range(0, len(places), _AT_ONCE):
            part = slice(first, first + _AT_ONCE)
            found[part] = self._estimates(places[part], neighbours[part])
        return found

    def _estimates(self, places: Sequence[Place], neighbours: list[Neighbours]) -> Floats:
        """Solve all systems at once: those of fewer neighbours have rows of 0 more, and 1 on the diagonal."""
        counts = np.array([of.depth.size for of in neighbours])
        used = np.arange(max(counts.max(), 1)) < counts[:, None]
        of = Neighbours(*(np.ones(used.shape) for _ in Neighbours._fields))
        for whole, parts in zip(of, zip(*neighbours, strict=True), strict=True):
            whole[used] = np.concatenate(parts)
        matrix = np.where(used[:, :, None] & used[:, None], self.between(of), np.eye(used.shape[1]))
        if self.robust:
            matrix += self._added(of, used)[..., None] * np.eye(used.shape[1])
        at = np.array(places).T[..., None]
        toward = used * self.toward(of, (at[0], at[1]))
        radius = used * (of.radius - self.covariance.radius)
        one, value, of_place = np.moveaxis(np.linalg.solve(matrix, np.stack([1.0 * used, radius, toward], -1)), -1, 0)
        with np.errstate(divide="ignore", invalid="ignore"):  # without a neighbour 0 / 0
            mean = value.sum(axis=1) / one.sum(axis=1)
            rest = (1.0 - of_place.sum(axis=1)) ** 2 / one.sum(axis=1)
        estimate = self.covariance.radius + mean + np.sum(toward * (value - mean[:, None] * one), axis=1)
        variance = np.maximum(self.covariance.variance - np.sum(toward * of_place, axis=1) + rest, 0.0)
        return np.where(counts[:, None] > 0, np.column_stack([estimate, variance]), np.nan)

    def _added(self, of: Neighbours, used: Mask) -> Floats:
        """Return what is added to the noise variance of neighbours that differ from those beside them, m^2."""
        single, found = used & (of.members == 1.0), np.zeros(used.shape)
        if used.shape[1] <= _BESIDE:
            return found
        along = of.depth[:, :, None] - of.depth[:, None]
        turned = of.toolface[:, :, None] - of.toolface[:, None] - self.covariance.turn * along
        turned -= 360.0 * np.round(turned / 360.0)
        short = self.covariance.terms[0]
        across = np.radians(turned) * self.covariance.radius
        square = (short.along / short.around * across) ** 2 + along**2
        in_burst = np.abs(of.row[:, :, None] - of.row[:, None]) <= BURST
        square = np.where(single[:, None] & ~in_burst, square, np.inf)
        near = np.argpartition(square, _BESIDE - 1, axis=-1)[..., :_BESIDE]
        beside = np.sort(np.take_along_axis(of.radius[:, None], near.reshape(len(near), 1, -1), -1).reshape(near.shape))
        low, high = beside[..., 1], beside[..., -2]
        off = np.maximum(of.radius - high, low - of.radius) > _MOST_OFF * np.sqrt(self.covariance.noise)
        judged = single & (np.isfinite(square).sum(axis=-1) >= _BESIDE) & off
        return np.where(judged, (of.radius - 0.5 * (low + high)) ** 2, 0.0)


def estimate_near_and_far(samples: Columns, rows: Integers, settings: Settings, box: Boxes | None = None) -> Floats:
    """Estimate the radius at each of the samples ``rows`` from the other samples, outside the box around it.

    Returns the radii (m) and their kriging variances (m^2), (m, 2); NaN where there is no neighbour. Without boxes,
    only samples at the same position are left out.
    """
    places = list(zip(samples[0][rows].tolist(), samples[1][rows].tolist(), strict=True))
    return estimates_at(samples, places, settings, box or (np.zeros(rows.size), np.zeros(rows.size)))


def estimates_at(samples: Columns, places: Sequence[Place], settings: Settings, boxes: Boxes | None = None) -> Floats:
    """Return the radius at each place (m) and its variance (m^2) by the covariances of the settings, (m, 2)."""
    base, mean, square = np.zeros((3, len(places)))
    for share, there, among in by_covariance(samples, places, settings):
        some = None if boxes is None else (boxes[0][there], boxes[1][there])
        radius, variance = among.estimates([places[i] for i in there.tolist()], some).T
        base[there] = among.covariance.radius
        off = radius - base[there]
        mean[there] += share * off
        square[there] += share * (variance + off**2)
    return np.column_stack([base + mean, square - mean**2])


def by_covariance(
    samples: Columns, places: Sequence[Place], settings: Settings
) -> Iterator[tuple[float, Integers, Places]]:
    """Yield for each covariance of the settings its share, the places where it counts, and their neighbours."""
    limit = np.inf if settings.max_distance is None else settings.max_distance
    stretches = stretches_of(settings)
    if len(stretches) == 1:
        for covariance, share in likely_by(settings):
            among = Places(samples, covariance, settings.neighbors, limit, settings.robust)
            yield share, np.arange(len(places)), among
        return
    of = stretch_of(stretches, np.array(places).reshape(-1, 2)[:, 0])
    for number in distinct(of).tolist():
        among = Places(samples, (stretches, number), settings.neighbors, limit, settings.robust)
        yield 1.0, np.flatnonzero(of == number), among

r"""The radius that one pass saw along the hole, as a smooth field with its uncertainty.

    radius(depth, toolface) = level + sum over n = 0 .. 4 of (a_n cos n toolface + b_n sin n toolface) + noise

The coefficients change along the hole (an Ornstein-Uhlenbeck process). Two filters, one down and one up the hole, give
their mean and covariance where the pass has rows. So a tool with few arms is uncertain exactly where none of its arms
looked. The variance of each harmonic, the noise and the length over which the hole changes are found from the readings;
spikes count little, since the noise is taken to follow Student's t.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from helibore.base.arrays import Floats, Mask, numbers

HARMONICS = 4
SECTORS = 12
"""Largest number of readings in a row; the samples of a row in one sector become one reading, their median."""
FREEDOM = 5.0
"""Degrees of freedom of the noise."""

_BLOCK, _LEAD = 64, 24  # rows of a block of the filters, and rows before and after it with which a filter begins
_LENGTHS = (0.3, 1.0, 3.0)  # metres
_ROUNDS = 3
_ANGLES = 24  # at which the variance of a field is kept
_LEAST = 1e-5  # m: least noise, and least deviation of a harmonic
_FOURTH = 0.25  # most power of the fourth harmonic, of that of the second: four arms cannot tell it from the mean
_FAR = 4.0  # lengths: nothing is known of the field where two rows are farther apart


@dataclass(frozen=True)
class RowsOfPass:
    """Readings of one pass in m rows along the hole, at most r in a row; radii less their median."""

    depth: Floats  # of each row, (m,) m, rising
    angle: Floats  # radians, (m, r)
    radius: Floats  # m, (m, r); NaN where a row has fewer than r readings
    away: Floats  # m, (m, r): depth of each reading, less that of its row

    @property
    def known(self) -> Mask:
        """Whether there is such a reading, (m, r)."""
        return np.isfinite(self.radius)

    def design(self) -> Floats:
        """Return the terms of the series, 1, cos a, sin a, cos 2a, ..., at each angle, (m, r, 9)."""
        return terms(self.angle)


def terms(angle: Floats) -> Floats:
    waves = [np.exp(1j * n * angle) for n in range(1, HARMONICS + 1)]
    return np.stack([np.ones(angle.shape), *(part for wave in waves for part in (wave.real, wave.imag))], axis=-1)


def in_rows(depth: Floats, toolface: Floats, radius: Floats, cell: float) -> RowsOfPass:
    """Return samples as rows of at most ``cell`` metres, and readings of at most 30 degrees."""
    place = np.floor(depth / cell).astype(np.int64)
    sector = np.floor(toolface % 360.0 * (SECTORS / 360.0)).astype(np.int64)
    order = np.lexsort((radius, sector, place))
    place, sector = place[order], sector[order]
    first = np.flatnonzero(np.append(True, (place[1:] != place[:-1]) | (sector[1:] != sector[:-1])))
    count = np.diff(np.append(first, place.size))
    level = radius[order]
    middle = 0.5 * (level[first + (count - 1) // 2] + level[first + count // 2])
    rows = np.flatnonzero(np.append(True, place[1:] != place[:-1]))
    where = np.add.reduceat(depth[order], rows) / np.diff(np.append(rows, place.size))
    row = np.searchsorted(place[rows], place[first])
    beside = np.arange(first.size) - np.searchsorted(row, np.arange(rows.size))[row]
    angle, away = np.zeros((2, rows.size, beside.max() + 1))
    value = np.full(angle.shape, np.nan)
    angle[row, beside] = np.radians(np.add.reduceat(toolface[order] % 360.0, first) / count)
    away[row, beside] = np.add.reduceat(depth[order], first) / count - where[row]
    value[row, beside] = middle - np.median(middle)
    return RowsOfPass(where, angle, value, away)


@dataclass(frozen=True)
class Field:
    """The field of a pass at its m rows."""

    depth: Floats  # (m,) m
    mean: Floats  # coefficients, (m, 9) m
    variance: Floats  # of the radius at each of 24 angles, (m, 24) m^2
    prior: Floats  # variance of each coefficient along the hole, (9,) m^2
    length: float  # m: over which the coefficients change
    noise: float  # m: deviation of a reading
    readings: RowsOfPass  # from which it was found, as they were at the depths of their rows

    @property
    def total(self) -> float:
        """Variance of the radius along the hole, m^2."""
        return float(self.prior[0] + self.prior[1::2].sum())

    def seen(self, depth: Floats, design: Floats) -> tuple[Floats, Floats, Mask]:
        """Return mean and variance of the radius at depths (m, s), for the terms (m, r, 9) of each row, (m, s, r).

        Also return where the field is known, (m, s).
        """
        at = np.clip(np.searchsorted(self.depth, depth), 1, self.depth.size - 1)
        gap = self.depth[at] - self.depth[at - 1]
        part = (depth - self.depth[at - 1]) / gap
        unknown = ((part < 0) | (part > 1) | (gap > _FAR * self.length))[..., None]
        nearest = at - (part < 0.5)
        coefficients = self.mean[at - 1] + part[..., None] * (self.mean[at] - self.mean[at - 1])
        mean = np.where(unknown, 0.0, coefficients @ design.swapaxes(1, 2))
        sector = (
            np.round(np.arctan2(design[..., 2], design[..., 1]) * (_ANGLES / (2 * np.pi))).astype(np.int64) % _ANGLES
        )
        between = self.total * gap / self.length / 6.0
        variance = self.variance[nearest[..., None], sector[:, None]] + between[..., None]
        variance = np.where(unknown, self.total, np.minimum(variance, self.total))
        return mean, variance, ~unknown[..., 0]


def seen_by_all(fields: Sequence[Field], depth: Floats, design: Floats) -> tuple[Floats, Floats, Mask]:
    """Return what ``Field.seen`` returns, by all fields together; each counts for what it saw, the prior once."""
    precision = np.full((*depth.shape, design.shape[1]), 1.0 / max(each.total for each in fields))
    weighted, seen = np.zeros(precision.shape), np.zeros(depth.shape, dtype=bool)
    for each in fields:
        mean, variance, known = each.seen(depth, design)
        precision += 1.0 / variance - 1.0 / each.total
        weighted += mean / variance
        seen |= known
    return weighted / precision, 1.0 / precision, seen


def fit(rows: RowsOfPass) -> Field:
    """Return the field of a pass of at least two rows."""
    known, radius = rows.known, np.nan_to_num(rows.radius)
    spread = max(float(np.median(np.abs(radius[known])) * 1.4826) ** 2, _LEAST**2)
    prior = np.full(2 * HARMONICS + 1, 0.2 * spread)
    noise, length, weight = 0.1 * spread, _LENGTHS[1], known.astype(np.float64)
    design = rows.design()
    mean: Floats = np.zeros((len(design), prior.size))
    covariance: Floats = np.empty(0)
    for turn in range(_ROUNDS):
        if turn > 0:
            slope = (design @ np.gradient(mean, rows.depth, axis=0)[..., None])[..., 0]
            radius = np.nan_to_num(rows.radius) - slope * rows.away
        weighted = design * weight[..., None]
        matrix, side = weighted.swapaxes(1, 2) @ design, (weighted * radius[..., None]).sum(axis=1)
        filters = Filters(rows.depth, matrix / noise, side / noise)
        if turn == _ROUNDS - 2:
            length = max(_LENGTHS, key=lambda each: filters.evidence(prior, each))
        mean, covariance = filters.smoothed(prior, length)
        own = ((design @ covariance) * design).sum(axis=2)
        off = np.square(radius - (design @ mean[..., None])[..., 0]) + own
        weight = np.where(known, (FREEDOM + 1) / (FREEDOM + off / noise), 0.0)
        noise = max(float((weight * off)[known].mean()), _LEAST**2)
        power = (np.square(mean) + np.diagonal(covariance, axis1=1, axis2=2)).mean(axis=0)
        prior[0] = power[0]
        waves = 0.5 * (power[1::2] + power[2::2])
        waves[2] = min(waves[2], max(waves[0], waves[1]))
        waves[3] = min(waves[3], _FOURTH * waves[1])
        prior[1:] = np.repeat(waves, 2)
        prior = np.maximum(prior, _LEAST**2)
    level = RowsOfPass(rows.depth, rows.angle, np.where(known, radius, np.nan), np.zeros(radius.shape))
    around = terms(np.linspace(0.0, 2 * np.pi, _ANGLES, endpoint=False))
    variance = ((around @ covariance) * around).sum(axis=2)
    return Field(rows.depth, mean, variance, prior, length, float(np.sqrt(noise)), level)


class Filters:
    """Blocks of rows that are filtered side by side; each begins some rows early, so that its start is forgotten.

    For each row, ``matrix`` (m, 9, 9) is the precision that its readings give the coefficients, and ``side`` (m, 9)
    this precision times the coefficients that they say.
    """

    def __init__(self, depth: Floats, matrix: Floats, side: Floats) -> None:
        place = np.arange(0, depth.size, _BLOCK) + np.arange(-_LEAD, _BLOCK + _LEAD)[:, None]  # (steps, blocks)
        inside = (place >= 0) & (place < depth.size)
        at = np.clip(place, 0, depth.size - 1)
        self.matrix, self.side = (
            np.where(inside[..., None, None], matrix[at], 0.0),
            np.where(inside[..., None], side[at], 0.0),
        )
        self.gap = np.abs(np.diff(depth[at], axis=0))
        core = slice(_LEAD, _LEAD + _BLOCK)
        self.inside = np.zeros(inside.shape, dtype=bool)
        self.inside[core] = inside[core]
        self.order = np.argsort(place[self.inside])

    def evidence(self, prior: Floats, length: float) -> float:
        """Return the logarithm of the evidence, but for a constant."""
        total = 0.0
        for step, before, expected, precision, weighted in self._steps(prior, length, 1):
            mean, old = (
                np.linalg.solve(of, by[..., None])[..., 0] for of, by in ((precision, weighted), (before, expected))
            )
            gained = (mean * weighted).sum(axis=1) - (old * expected).sum(axis=1)
            gained += np.linalg.slogdet(before)[1] - np.linalg.slogdet(precision)[1]
            total += 0.5 * float(gained[self.inside[step]].sum())
        return total

    def smoothed(self, prior: Floats, length: float) -> tuple[Floats, Floats]:
        """Return mean and covariance of the coefficients at each row."""
        precision, weighted = np.zeros(self.matrix.shape), np.zeros(self.side.shape)
        for step, _, _, after, gained in self._steps(prior, length, 1):
            precision[step] += after - np.diag(1.0 / prior)
            weighted[step] += gained
        for step, before, expected, _, _ in self._steps(prior, length, -1):
            precision[step] += before
            weighted[step] += expected
        covariance: Floats = numbers(np.linalg.inv(precision[self.inside][self.order]))
        return (covariance @ weighted[self.inside][self.order][..., None])[..., 0], covariance

    def _steps(self, prior: Floats, length: float, way: int) -> Iterator[tuple[int, Floats, Floats, Floats, Floats]]:
        """Yield each step, and precision and precision times mean before and after its own readings."""
        steps = range(len(self.matrix))[::way]
        before = np.broadcast_to(np.diag(1.0 / prior), self.matrix.shape[1:])
        expected = np.zeros(self.side.shape[1:])
        for step in steps:
            after, gained = before + self.matrix[step], expected + self.side[step]
            yield step, before, expected, after, gained
            if step != steps[-1]:
                keep = np.exp(-self.gap[min(step, step + way)] / length)[:, None]
                covariance = np.linalg.inv(after)
                mean = keep * (covariance @ gained[..., None])[..., 0]
                covariance = np.square(keep)[..., None] * covariance
                covariance[:, range(prior.size), range(prior.size)] += (1 - np.square(keep)) * prior
                before = np.linalg.inv(covariance)
                expected = (before @ mean[..., None])[..., 0]

r"""Find how far the toolfaces of a pass lie from those of the others, once its shift is known.

    likelihood |      .-.             the pass is turned by each angle and compared with the field of the others;
               |_.   /   \     .-.    a rival that gains nearly as much says that the hole, or the tool, cannot tell:
               | \__/     \___/   \__ an oval equals itself turned by 180 degrees
               +----------------------- angle

In a spiral, a centimetre of depth is some degrees of toolface. So each stretch of the pass has its own shift beside
that of the path, and the angle is what no such shift explains. Its deviation comes from how much the stretches differ.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace

import numpy as np

from helibore.base.arrays import Complexes, Floats, Mask
from helibore.preparation.depth_paths import STRETCH, DepthPath, student
from helibore.preparation.fields import FREEDOM, HARMONICS, Field, Filters, RowsOfPass, seen_by_all, terms

STEP = 3.0
"""Degrees between trial angles."""
LEAST = 1.0
"""Degrees: smaller offsets are not reported."""
FINEST = 0.2
"""Degrees: least deviation of an offset."""
SURE = 3.0
"""Deviations by which an offset differs from 0."""

_AWAY = 60.0  # degrees: a rival lies farther away
_RIVAL, _LEAD = 0.85, 8.0  # a rival gains more than this share, or less than this logarithm less
_LEAST_GAIN = 8.0  # logarithm of the likelihood over the mean of all angles
_FEW, _ALIKE = 6, 0.25  # readings in a row up to which arms may lie alike, and how alike, from 0 to 1, is too much
_BESIDE = 2.0  # degrees: so far beside an angle the slope of the evidence is taken


@dataclass(frozen=True)
class ToolfaceMatch:
    """How far the toolfaces of a pass lie from those of the others, degrees in [-180, 180)."""

    angle: float  # to add to the toolfaces of the pass
    sigma: float
    by_half: bool = False  # whether 180 degrees more fit nearly as well
    clear: bool = True  # whether no other angle does

    @property
    def is_offset(self) -> bool:
        """Whether the pass is clearly turned against the others."""
        return self.clear and abs(self.angle) > max(SURE * self.sigma, LEAST)

    @property
    def worth_saying(self) -> bool:
        """Whether there is an offset, or may be one that the readings cannot show."""
        return self.is_offset or self.by_half or not self.clear

    def sentence(self, number: int) -> str:
        """Return what the offset of pass ``number`` means and the setting that mends it, or how far it is not known."""
        if not self.clear:
            return (
                "how far its toolfaces lie from those of the others is not known: other angles fit nearly as well, or "
                "its arms lie as those of another pass do"
            )
        half = ", or 180 degrees more, which fits nearly as well" if self.by_half else ""
        if not self.is_offset:
            return f"its toolfaces lie as those of the others do{half}"
        return (
            f"its toolfaces lie {-self.angle:+.1f} +- {self.sigma:.1f} degrees from those of the others{half}; "
            f"preparation.toolface_shifts={number}={self.angle:.1f}deg would mend it"
        )


def find_toolface(own: Field, fields: Sequence[Field], path: DepthPath) -> ToolfaceMatch:
    """Return the angle of a pass on its path through the fields of others."""
    rows = own.readings
    there = path.known
    if not there.any():
        return ToolfaceMatch(0.0, np.inf, clear=False)
    some = RowsOfPass(rows.depth[there], rows.angle[there], rows.radius[there] - path.bias, rows.away[there])
    where = some.depth + path.shift[there]
    trials = np.arange(-180.0, 180.0, STEP)
    gains = np.array([_fit(some, fields, where, own.noise, angle).sum() for angle in trials]) / path.divisor
    gains -= gains.mean()
    best = int(np.argmax(gains))
    apart = np.abs((trials - trials[best] + 180.0) % 360.0 - 180.0)
    rivals = (apart > _AWAY) & ((gains > _RIVAL * gains[best]) | (gains > gains[best] - _LEAD))
    opposite = apart > 180.0 - _AWAY / 2
    by_half, clear = bool((rivals & opposite).any()), not (rivals & ~opposite).any() and gains[best] > _LEAST_GAIN
    start = float(trials[best])
    if (gains[rivals & opposite] > gains[best] - _LEAD).any():  # of two alike, the one near 0
        start = (start + 90.0) % 180.0 - 90.0
    angle, sigma = start, np.inf
    together = _Together(replace(some, depth=where), own, fields)
    for _ in range(3):
        step, sigma = together.refined(angle)
        angle += float(np.clip(step, -STEP, STEP))
    by_length = together.longer().refined(angle)[0]
    by_depth = _twist(own, there) * float(np.median(path.sigma[there]))
    sigma = float(np.sqrt(sigma**2 + by_length**2 + by_depth**2))
    # The best trial and the refined angle agree.
    clear = bool(clear and np.isfinite(sigma)) and abs(angle - start) < 2 * STEP and not _lie_alike(some, where, fields)
    return ToolfaceMatch((angle + 180.0) % 360.0 - 180.0, sigma, by_half, clear)


def _lie_alike(rows: RowsOfPass, where: Floats, fields: Sequence[Field]) -> bool:
    """Return whether the few arms of a pass and of another lie alike along the hole, turned by one angle if at all.

    What each saw is then a guess between the arms of the other, and the likeliest angle lays arms over arms.
    """
    count = rows.angle.shape[1]

    def place(of: RowsOfPass) -> Complexes:
        found: Complexes = (np.exp(1j * count * of.angle) * of.known).sum(axis=1) / np.maximum(of.known.sum(axis=1), 1)
        return found

    if count > _FEW:
        return False
    own = place(rows)
    for each in fields:
        near = np.clip(np.searchsorted(each.depth, where), 0, each.depth.size - 1)
        if abs(complex((own * place(each.readings)[near].conj()).mean())) > _ALIKE:
            return True
    return False


def _twist(own: Field, there: Mask) -> float:
    """Return the angle by which a metre of depth turns the hole that a pass saw, degrees."""
    design = own.readings.design()
    by_depth = (design @ np.gradient(own.mean, own.depth, axis=0)[..., None])[..., 0][there]
    by_angle = (_by_angle(design) @ own.mean[..., None])[..., 0][there]
    known = own.readings.known[there]
    power = float(np.square(by_angle)[known].sum())
    return float(np.degrees(abs(float((by_angle * by_depth)[known].sum())) / power)) if power > 0 else 0.0


def _by_angle(design: Floats) -> Floats:
    """Return how the terms of a series change with the angle, a radian."""
    n = np.arange(1, HARMONICS + 1)
    change = np.zeros(design.shape)
    change[..., 1::2], change[..., 2::2] = -n * design[..., 2::2], n * design[..., 1::2]
    return change


class _Together:
    """The readings of a pass and of the others as rows of one field, in which the pass may be turned.

    The slope of the evidence of this field over the angle is a sum over the readings of the pass. A reading counts by
    what the others know of the hole at its depth and in its direction.
    """

    def __init__(self, rows: RowsOfPass, own: Field, fields: Sequence[Field]) -> None:
        parts, noises = [rows], [own.noise]
        for each in fields:
            near = slice(*np.searchsorted(each.depth, (rows.depth[0] - own.length, rows.depth[-1] + own.length)))
            seen = each.readings
            parts.append(RowsOfPass(seen.depth[near], seen.angle[near], seen.radius[near], seen.away[near]))
            noises.append(each.noise)
        wide = max(part.angle.shape[1] for part in parts)

        def column(name: str, fill: float) -> Floats:
            values = [getattr(part, name) for part in parts]
            padded = [np.pad(of, ((0, 0), (0, wide - of.shape[1])), constant_values=fill) for of in values]
            return np.concatenate(padded)[order]

        depth = np.concatenate([part.depth for part in parts])
        order = np.argsort(depth, kind="stable")
        self.depth, self.angle, self.radius = depth[order], column("angle", 0.0), column("radius", np.nan)
        self.own = order < rows.depth.size
        self.noise = np.square(np.repeat(noises, [part.depth.size for part in parts]))[order, None]
        self.prior = np.mean([each.prior for each in (own, *fields)], axis=0)
        self.length = own.length
        self.stretch = np.unique(np.floor(self.depth[self.own] / STRETCH), return_inverse=True)[1]
        self.precision = np.isfinite(self.radius) / self.noise
        self.radius = np.nan_to_num(self.radius)

    def refined(self, angle: float) -> tuple[float, float]:
        """Return a step towards the angle with the most evidence, degrees, and the deviation of the angle.

        The precision of each reading follows from Student's t at the angle before.
        """
        low, high = self._slopes(angle - _BESIDE), self._slopes(angle + _BESIDE)
        slope, bend = 0.5 * (low + high), (low - high) / (2 * _BESIDE)
        total = float(bend.sum())
        if total <= 0:
            return 0.0, np.inf
        step = float(slope.sum()) / total
        left = slope - step * bend
        return step, float(np.hypot(np.sqrt(max(np.square(left).sum(), total)) / total, FINEST))

    def longer(self) -> _Together:
        """Return the same readings as rows of a field that changes along the hole over three times the length.

        How long that is, is not well known; where arms lie nearly alike, the angle depends on it.
        """
        found = copy(self)
        found.length = 3.0 * self.length
        return found

    def _slopes(self, angle: float) -> Floats:
        """Return how much the logarithm of the evidence rises with the angle in each stretch, a degree."""
        turned = self.angle + np.radians(angle) * self.own[:, None]
        design = terms(turned)
        weighted = design * self.precision[..., None]
        filters = Filters(self.depth, weighted.swapaxes(1, 2) @ design, (weighted * self.radius[..., None]).sum(axis=1))
        mean, covariance = filters.smoothed(self.prior, self.length)
        off = self.radius - (design @ mean[..., None])[..., 0]
        own = ((design @ covariance) * design).sum(axis=2)
        known = self.precision > 0
        weight = (FREEDOM + 1) / (FREEDOM + (np.square(off) + own) / self.noise)
        change = _by_angle(design)
        rises = off * (change @ mean[..., None])[..., 0] - ((design @ covariance) * change).sum(axis=2)
        found: Floats = np.bincount(self.stretch, (self.precision * rises)[self.own].sum(axis=1)).astype(np.float64)
        self.precision = np.where(known, weight / self.noise, 0.0)
        return np.radians(found)


def _fit(rows: RowsOfPass, fields: Sequence[Field], where: Floats, noise: float, angle: float) -> Floats:
    turned = replace(rows, angle=rows.angle + np.radians(angle))
    mean, variance, _ = seen_by_all(fields, where[:, None], turned.design())
    off = rows.radius - mean[:, 0]
    fits: Floats = np.where(np.isnan(off), 0.0, student(off, variance[:, 0] + noise**2)).sum(axis=1)
    return fits

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
from dataclasses import dataclass, replace

import numpy as np

from helibore.base.arrays import Floats
from helibore.preparation.depth_paths import STRETCH, DepthPath, student
from helibore.preparation.fields import FREEDOM, Field, RowsOfPass, seen_by_all

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
_FEW, _MORE = 6, 2.0  # readings in a row up to which an error is larger than stretches say, and by how much: an arm
# looks at one side of the hole for many of them (``python -m bench.accuracy.preparation toolface``)
_FREE = 0.1  # metres: deviation of the shift of a stretch from the path
_SMALL_ANGLE, _SMALL_DEPTH = 1.0, 0.01  # degrees and metres, for slopes


@dataclass(frozen=True)
class ToolfaceMatch:
    """How far the toolfaces of a pass lie from those of the others, degrees in [-180, 180)."""

    angle: float  # to add to the toolfaces of the pass
    sigma: float
    by_half: bool = False  # whether 180 degrees more fit as well
    clear: bool = True  # whether no other angle does

    @property
    def is_offset(self) -> bool:
        """Whether the pass is clearly turned against the others."""
        return self.clear and abs(self.angle) > max(SURE * self.sigma, LEAST)

    def sentence(self, number: int) -> str:
        """Return what a clear offset of the pass ``number`` means, and the setting that mends it."""
        half = ", or 180 degrees more, which the readings cannot tell" if self.by_half else ""
        return (
            f"its toolfaces lie {-self.angle:+.1f} +- {self.sigma:.1f} degrees from those of the others{half}; "
            f"preparation.toolface_shifts={number}={self.angle:.1f}deg would mend it"
        )


def find_toolface(rows: RowsOfPass, fields: Sequence[Field], path: DepthPath, noise: float) -> ToolfaceMatch:
    """Return the angle of a pass on its path through the fields of others; parameters as of `find_path`."""
    there = path.known
    some = RowsOfPass(rows.depth[there], rows.angle[there], rows.radius[there], rows.away[there])
    where = some.depth + path.shift[there]
    trials = np.arange(-180.0, 180.0, STEP)
    gains = np.array([_fit(some, fields, where, path.bias, noise, angle).sum() for angle in trials]) / path.divisor
    gains -= gains.mean()
    best = int(np.argmax(gains))
    apart = np.abs((trials - trials[best] + 180.0) % 360.0 - 180.0)
    rivals = (apart > _AWAY) & ((gains > _RIVAL * gains[best]) | (gains > gains[best] - _LEAD))
    opposite = apart > 180.0 - _AWAY / 2
    by_half, clear = bool((rivals & opposite).any()), not (rivals & ~opposite).any() and gains[best] > _LEAST_GAIN
    start = float(trials[best])
    if by_half:  # of the two, the one near 0
        start = (start + 90.0) % 180.0 - 90.0
    angle, sigma = start, np.inf
    for _ in range(3):
        step, sigma = _refined(some, fields, where, path.bias, noise, angle)
        angle += float(np.clip(step, -STEP, STEP))
    if some.angle.shape[1] <= _FEW:
        sigma *= _MORE
    clear = bool(clear) and abs(angle - start) < 2 * STEP  # the best trial and the least squares agree
    return ToolfaceMatch((angle + 180.0) % 360.0 - 180.0, sigma, by_half, clear)


def turned(rows: RowsOfPass, angle: float) -> RowsOfPass:
    """Return rows with an angle, degrees, added to their toolfaces."""
    return replace(rows, angle=rows.angle + np.radians(angle))


def _seen(rows: RowsOfPass, fields: Sequence[Field], where: Floats, angle: float) -> tuple[Floats, Floats]:
    mean, variance, _ = seen_by_all(fields, where[:, None], turned(rows, angle).design())
    return mean[:, 0], variance[:, 0]


def _fit(rows: RowsOfPass, fields: Sequence[Field], where: Floats, bias: float, noise: float, angle: float) -> Floats:
    mean, variance = _seen(rows, fields, where, angle)
    off = rows.radius - bias - mean
    fits: Floats = np.where(np.isnan(off), 0.0, student(off, variance + noise**2)).sum(axis=1)
    return fits


def _refined(
    rows: RowsOfPass, fields: Sequence[Field], where: Floats, bias: float, noise: float, angle: float
) -> tuple[float, float]:
    """Return a step of iterated least squares for the angle, with a free shift in each stretch, and its deviation."""
    mean, variance = _seen(rows, fields, where, angle)
    off = np.nan_to_num(rows.radius - bias - mean)
    weight = np.where(rows.known, (FREEDOM + 1) / (FREEDOM * (variance + noise**2) + np.square(off)), 0.0)
    by_angle, by_depth = (
        (_seen(rows, fields, where + depth, angle + turn)[0] - _seen(rows, fields, where - depth, angle - turn)[0])
        / (2 * (depth + turn))
        for depth, turn in ((0.0, _SMALL_ANGLE), (_SMALL_DEPTH, 0.0))
    )
    stretch = np.unique(np.floor(rows.depth / STRETCH), return_inverse=True)[1]

    def summed(values: Floats) -> Floats:
        found: Floats = np.bincount(stretch, (weight * values).sum(axis=1)).astype(np.float64)
        return found

    share = summed(by_angle * by_depth) / (summed(np.square(by_depth)) + 1 / _FREE**2)
    information = summed(np.square(by_angle)) - share * summed(by_angle * by_depth)
    slope = summed(by_angle * off) - share * summed(by_depth * off)
    total = max(float(information.sum()), 1e-12)
    step = float(slope.sum()) / total
    left = slope - step * information
    return step, float(np.hypot(np.sqrt(max(np.square(left).sum(), total)) / total, FINEST))

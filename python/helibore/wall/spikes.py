"""Spikes: samples that differ from the wall beside them, above and below, as neither a ledge nor the edge of a breakout
does.

A sample is compared with the eight samples nearest to it on the wall, and with the eight nearest where distances around
the hole count `_ALONG` times as much. The `BURST` samples before and after it in order of depth do not count: a tool
often errs several times in a row, and what is real is seen again in the next turn. The sample is a spike if, both
times, it differs from the middle of the eight, their median, by more than `_LARGE` robust deviations, and at most one
of the eight lies nearer to it than to the middle; whether the tool makes spikes is decided by those with none. Radii in
coarse steps differ by one step at least.
"""

from __future__ import annotations

import numpy as np

from helibore import _core
from helibore.base.arrays import Floats, Integers, Mask
from helibore.base.thread_count import thread_count
from helibore.settings.wall_settings import Settings
from helibore.wall.estimates import Columns, few_rows, in_core

MANY = 0.006
"""Share of the samples; if more are spikes, the tool makes them. Of holes without spikes, whose events are each seen by
a few samples, up to 0.0057 look so; an event that one sample sees is no other than a spike."""
BURST = 8
"""Samples in a row that may be wrong. Also in `near_far.cpp`."""
_BESIDE, _LARGE, _ALONG = 8, 3.3, 8.0
_SOME = 4000
_MEDIAN = 1.4826
"""Standard deviation of normal errors over the median of their absolute values."""


def has_spikes(samples: Columns) -> bool:
    """Return whether more than the share `MANY` of the samples, which are in order of depth, are spikes."""
    rows = few_rows(samples[0], _SOME)
    if rows.size < min(samples[0].size, _SOME):  # a crowd at one depth, where each is compared with all
        return False
    return bool(np.mean(find_spikes(samples, rows, most_alike=0)[0]) > MANY)


def find_spikes(samples: Columns, rows: Integers, most_alike: int = 1) -> tuple[Mask, Floats]:
    """Return whether each of some samples is a spike, and the middle of the samples beside it, metres."""
    radius = samples[2]
    spikes, middle = np.ones(rows.size, dtype=bool), np.full(rows.size, np.inf)
    for stretch in (1.0, _ALONG):
        beside = radius[_beside(samples, rows, stretch)]
        here = np.median(beside, axis=1)
        off = radius[rows] - here
        far = np.abs(off)
        deviation = max(_MEDIAN * np.median(far), far[far > 0.0].min() if far.any() else 0.0)
        alike = np.sum(np.sign(off)[:, None] * (beside - here[:, None]) > 0.5 * far[:, None], axis=1)
        spikes &= (far > _LARGE * deviation) & (alike <= most_alike)
        middle = np.where(far < np.abs(radius[rows] - middle), here, middle)
    return spikes, middle


def _beside(samples: Columns, rows: Integers, stretch: float) -> Integers:
    """Return the nearest samples of each one, but for those of its burst; where these are all, the sample itself."""
    depth, toolface, radius = samples
    trial, none = np.full(rows.size, np.median(radius)), np.zeros(rows.size)
    settings = Settings(bit_diameter=2.0 * trial[0], neighbors=_BESIDE + 2 * BURST, max_distance=None)
    points = depth[rows], toolface[rows], trial, none, none
    found = _core.nearest_to(in_core(samples), points, vars(settings), stretch, thread_count(None))
    turn = (toolface[found] - toolface[rows][:, None] + 180.0) % 360.0 - 180.0
    distance = np.hypot(stretch * np.radians(turn) * trial[0], depth[found] - depth[rows][:, None])
    distance[(found < 0) | (np.abs(found - rows[:, None]) <= BURST)] = np.inf
    nearest = np.argsort(distance, axis=1, kind="stable")[:, :_BESIDE]
    chosen = np.take_along_axis(found, nearest, axis=1)
    return np.where(np.isfinite(np.take_along_axis(distance, nearest, axis=1)), chosen, rows[:, None])

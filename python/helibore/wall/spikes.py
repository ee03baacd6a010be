"""Spikes: samples that differ from all samples beside them, as neither a ledge nor the edge of a breakout does.

A sample is compared with the middle of the eight samples nearest to it on the wall, their median. It is a spike if it
differs by more than `_LARGE` robust deviations, and by more than twice as much as the second greatest of the eight
samples differ from the samples beside each of them. Radii in coarse steps differ by one step at least.
"""

from __future__ import annotations

import numpy as np

from helibore import _core
from helibore.base.arrays import Floats, Integers, Mask, distinct
from helibore.base.thread_count import thread_count
from helibore.settings.wall_settings import Settings
from helibore.wall.estimates import Columns, few_rows, in_core

MANY = 0.0075
"""Share of the samples; if more are spikes, the tool makes them. Of holes without spikes, with a sharp key seat, say,
up to 0.0055 of the samples of a rotating tool look so."""
_BESIDE, _LARGE, _OTHERS = 8, 3.3, 2.0
_SOME = 2000
_FARTHEST = 0.12
"""Metres: if the eighth nearest sample mostly lies farther away, too few of them lie in the same breakout, whose edges
would be spikes."""
_MEDIAN = 1.4826
"""Standard deviation of normal errors over the median of their absolute values."""


def has_spikes(samples: Columns) -> bool:
    """Return whether more than the share `MANY` of the samples, which are in order of depth, are spikes."""
    rows = few_rows(samples[0], _SOME)
    if rows.size < min(samples[0].size, _SOME):  # a crowd at one depth, where each is compared with all
        return False
    return _apart(samples, rows) <= _FARTHEST and bool(np.mean(find_spikes(samples, rows)[0]) > MANY)


def find_spikes(samples: Columns, rows: Integers) -> tuple[Mask, Floats]:
    """Return whether each of some samples is a spike, and the middle of the samples beside it, metres."""
    radius, beside = samples[2], _beside(samples, rows)
    middle: Floats = np.median(radius[beside], axis=1)
    others = distinct(beside.ravel())
    of_others = np.abs(radius[others] - np.median(radius[_beside(samples, others)], axis=1))
    second = np.partition(of_others[np.searchsorted(others, beside)], -2, axis=1)[:, -2]
    off = np.abs(radius[rows] - middle)
    deviation = max(_MEDIAN * np.median(off), off[off > 0.0].min() if off.any() else 0.0)
    return (off > _LARGE * deviation) & (off > _OTHERS * second), middle


def _apart(samples: Columns, rows: Integers) -> float:
    """Return the median distance to the farthest of the samples beside each one, metres."""
    depth, toolface, radius = samples
    beside = _beside(samples, rows)
    turn = (toolface[beside] - toolface[rows][:, None] + 180.0) % 360.0 - 180.0
    across = np.radians(turn) * np.median(radius)
    return float(np.median(np.hypot(across, depth[beside] - depth[rows][:, None]).max(axis=1)))


def _beside(samples: Columns, rows: Integers) -> Integers:
    depth, toolface, radius = samples
    trial, none = np.full(rows.size, np.median(radius)), np.zeros(rows.size)
    settings = Settings(bit_diameter=2.0 * trial[0], neighbors=_BESIDE, max_distance=None)
    points = depth[rows], toolface[rows], trial, none, none
    found = _core.nearest_to(in_core(samples), points, vars(settings), 1.0, thread_count(None))
    return np.where(found >= 0, found, rows[:, None])  # fewer than eight: the sample itself

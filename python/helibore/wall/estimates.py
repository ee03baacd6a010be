"""Estimates at chosen points from samples of which some are left out: for cross-validation and for uncertainty.

The core finds the neighbours of each point and estimates its radius by the method of the wall.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from helibore import _core
from helibore.base.arrays import Floats, Integers
from helibore.base.settings import Settings
from helibore.samples.caliper import Caliper

SPREAD_SCALES = (1.0, 4.0, 16.0)
"""Angular scales of the metrics in which the core measures `Estimates.spread`."""

Columns = tuple[Floats, Floats, Floats]


class Estimates(NamedTuple):
    """Estimates at m points; NaN where no sample is within ``max_distance``.

    Attributes
    ----------
    radius
        Metres, (m,).
    nearest, farthest
        Metres, (m,): to the nearest sample used, on the wall; to the farthest, in the metric of ``angular_scale``.
    square_weights
        Sum of the squared weights, (m,).
    scatter
        Mean square of the radii used about ``radius``, weighted by inverse distance, m^2, (m,).
    spread
        Mean distance to the samples used, likewise, metres: three times (m,), in metrics of `SPREAD_SCALES`.
    by_nugget
        Radii by kriging with each of the nuggets asked for, (m,) each.
    """

    radius: Floats
    nearest: Floats
    farthest: Floats
    square_weights: Floats
    scatter: Floats
    spread: list[Floats]
    by_nugget: list[Floats]


def in_depth_order(caliper: Caliper) -> Columns:
    """Depth, toolface in [0, 360) and radius by depth; samples at one depth keep their order."""
    order = np.argsort(caliper.depth, kind="stable")
    toolface = np.mod(caliper.toolface[order], 360.0)
    return caliper.depth[order], np.where(toolface < 360.0, toolface, 0.0), caliper.radius[order]


def estimate_left_out(
    samples: Columns,
    rows: Integers,
    settings: Settings,
    box: tuple[Floats, Floats] | None = None,
    threads: int = 1,
    trial: Floats | None = None,
    nuggets: Sequence[float] = (),
) -> Estimates:
    """Estimate the radius at some samples from the others.

    Parameters
    ----------
    samples
        As `in_depth_order` returns them.
    rows
        (m,) rows of ``samples``.
    settings
        What the wall is built with.
    box
        (m,) metres and (m,) degrees: samples at most so far above or below the row and at most so far beside it are
        left out, too. None: only those at the position of the row.
    trial
        (m,) metres: radii near those looked for, at which one estimate is made. None: the iteration of the method.
    nuggets
        Of kriging, for `Estimates.by_nugget`.
    """
    depth, toolface, _ = samples
    nothing = np.zeros(rows.size)
    if trial is None:
        trial = np.full(rows.size, settings.bit_diameter / 2)
    else:
        settings = replace(settings, max_iterations=1)
    points = (depth[rows], toolface[rows], trial, *(box or (nothing, nothing)))
    return Estimates(*_core.estimate_at(samples, points, vars(settings), threads, nuggets))


def find_kriging_range(samples: Columns, settings: Settings, targets: int = 1000) -> float:
    """Return four times the median distance from a sample to the 16th nearest other, in the metric of the settings.

    Half a turn of a hole of bit size where samples are too few, or all at one position, to have such a distance.
    """
    rows = np.unique(np.linspace(0, samples[0].size - 1, min(targets, samples[0].size)).astype(np.int64))
    simple = replace(settings, estimator="inverse-distance", neighbors=16, max_distance=None, max_iterations=2)
    farthest = estimate_left_out(samples, rows, simple).farthest
    farthest = farthest[farthest > 0]
    if farthest.size:
        return 4.0 * float(np.median(farthest))
    return float(0.5 * np.pi * settings.bit_diameter * settings.angular_scale)

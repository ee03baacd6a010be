"""Estimate the radius at samples that are left out, from the other samples: for cross-validation and uncertainty.

The core finds the neighbours of each point and estimates its radius by the method of the wall. A sample is left out
alone, or together with all samples in a box around it. The box is as large as the empty box around a random place on
the wall.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from helibore import _core
from helibore.base.angles import wrapped
from helibore.base.arrays import Floats, Integers, distinct
from helibore.base.errors import InputError
from helibore.base.thread_count import thread_count
from helibore.samples.caliper import Caliper
from helibore.settings.wall_settings import Settings

FEWEST_SAMPLES = 100
MOST_UNMEASURED = 0.5
"""Share of the turns; a tool that leaves a larger share unmeasured has few arms, or sends few samples."""
MOST_BOX_DEPTH = 1.0  # metres
FEW_BOXES = 200
"""Number of boxes that is enough for an uncertainty. `tune` makes one box for each target, so that its choice hardly
varies with the boxes."""
_LEVEL = 1e-3
"""Metres: samples within this depth are compared, however near in toolface others are."""
_COMPARISONS = 2e6
"""With this many comparisons a range is found in some 30 ms."""
MOST_COMPARISONS = 2e7
"""Each of the samples left out is compared with all that lie within `_LEVEL` of its depth: at most so many in all."""

Columns = tuple[Floats, Floats, Floats]
Boxes = tuple[Floats, Floats]


class Estimates(NamedTuple):
    """Estimates at m points, (m,) each; NaN where no sample is within ``max_distance``."""

    radius: Floats  # metres
    nearest: Floats  # metres in the metric of ``angular_scale``: distance to the nearest sample used
    farthest: Floats  # metres, same metric: distance to the farthest sample used
    square_weights: Floats  # sum of the squared weights
    scatter: Floats  # m^2: mean square of (radius of a sample used - ``radius``)
    along: Floats  # m^2: mean square of the distances along the hole to the samples used
    across: Floats  # m^2: mean square of the distances around the hole to the samples used
    by_nugget: list[Floats]  # metres: radii by kriging, one array for each of the nuggets given


class Ordered(tuple[Floats, Floats, Floats]):
    """Columns in order of depth; the core copies and checks them once, however many estimates are made from them."""

    @cached_property
    def in_core(self) -> _core.PointSamples:
        return _core.PointSamples(*self, threads=1)


def in_core(samples: Columns) -> _core.PointSamples:
    """Return the core's copy of samples in order of depth."""
    return (samples if isinstance(samples, Ordered) else Ordered(samples)).in_core


def depth_order(caliper: Caliper) -> Integers:
    """Return the rows of samples in order of depth, (m,); with times, equal rows count once, as in a wall.

    At one depth, time, toolface, radius and arm decide: the order does not depend on that in which the rows are given.
    """
    known = caliper.depth, caliper.time, wrapped(caliper.toolface), caliper.radius, caliper.arm
    columns = [of for of in known if of is not None]
    order: Integers = np.arange(len(caliper)) if _ascend(columns) else np.lexsort(columns[::-1])
    if caliper.time is None or not order.size:
        return order
    same = [of[order[1:]] == of[order[:-1]] for of in columns[:4]]
    distinct_rows: Integers = order[np.append([True], ~np.logical_and.reduce(same))]
    return distinct_rows


def _ascend(columns: Sequence[Floats | Integers]) -> bool:
    """Return whether rows are in order of the first column, equal ones in that of the next; faster than a sort."""
    same = np.ones(max(columns[0].size - 1, 0), dtype=bool)
    for of in columns:
        if np.any(of[1:][same] < of[:-1][same]):
            return False
        same &= of[1:] == of[:-1]
    return True


def in_depth_order(caliper: Caliper) -> Ordered:
    """Return depth, toolface in [0, 360) and radius, in the `depth_order` of the samples."""
    order = depth_order(caliper)
    return Ordered((caliper.depth[order], wrapped(caliper.toolface)[order], caliper.radius[order]))


def choose_left_out(
    samples: Columns, settings: Settings, most: int, seed: int, purpose: str, boxes: int = FEW_BOXES
) -> tuple[Integers, Boxes]:
    """Return the rows to leave out, (m,) with m at most ``most``, and half the height and width of a box around each.

    At most ``boxes`` of the boxes are different. If many samples lie near one depth, fewer than ``most`` are left out.

    Raises InputError if ``most`` is below 1, if there are fewer than `FEWEST_SAMPLES` samples, or if the settings have
    a window. In these errors, ``purpose`` says what the samples are needed for, such as "to tune".
    """
    count = samples[0].size
    if most < 1:
        raise InputError("targets", "must be 1 or more", str(most))
    if settings.window is not None:
        rule = f"must be None {purpose}: samples are left out of the exact search"
        raise InputError("window", rule, str(settings.window), "wall.window")
    if count < FEWEST_SAMPLES:
        raise InputError("samples", f"too few samples {purpose}: must be at least {FEWEST_SAMPLES}", str(count))
    most = min(most, max(int(MOST_COMPARISONS / _crowd(samples[0])), FEWEST_SAMPLES), count)
    rng = np.random.default_rng(seed)
    rows = np.sort(rng.choice(count, most, replace=False))
    return rows, empty_boxes(samples, settings, rows.size, rng, boxes)


def empty_boxes(
    samples: Columns, settings: Settings, count: int, rng: np.random.Generator, different: int = FEW_BOXES
) -> Boxes:
    """Return half the height (m) and half the width (degrees) of the empty boxes around random places on the wall.

    Half the height is the distance in depth to the nearest sample within half a sector of angle, at most 1 m. (With a
    limit of 0.5 m, samples of the same arm, with the same bias, would be too close.) Half the width is the angle to the
    nearest sample within half a pitch of depth. At most ``different`` boxes are computed; they are repeated until
    there are ``count`` boxes.
    """
    depth, toolface, _ = samples
    some = min(count, different)
    where, angle = rng.uniform(depth[0], depth[-1], some), rng.uniform(0.0, 360.0, some)
    height, width = np.full(some, MOST_BOX_DEPTH), np.full(some, 180.0)
    half_pitch, half_sector = abs(settings.pitch) / 2, 180.0 / settings.sectors
    reaches = (half_pitch, max(half_pitch, MOST_BOX_DEPTH))
    starts, stops = (np.searchsorted(depth, [where + sign * reach for reach in reaches]) for sign in (-1.0, 1.0))
    for i in range(some):
        for k, reach in enumerate(reaches):  # the first reach is enough in most cases
            band = slice(starts[k, i], stops[k, i])
            along = np.abs(depth[band] - where[i])
            turn = np.abs(toolface[band] - angle[i])
            turn = np.minimum(turn, 360.0 - turn)
            height[i] = along[turn <= half_sector].min(initial=MOST_BOX_DEPTH)
            if reach == half_pitch:
                width[i] = turn.min(initial=180.0)
            if height[i] <= reach:
                break
    return np.resize(height, count), np.resize(width, count)


def estimate_left_out(
    samples: Columns,
    rows: Integers,
    settings: Settings,
    box: Boxes | None = None,
    threads: int = 1,
    trial: Floats | None = None,
    nuggets: Sequence[float] = (),
) -> Estimates:
    """Estimate the radius at each of the samples ``rows`` from the other samples.

    Parameters
    ----------
    samples
        As `in_depth_order` returns them.
    rows
        (m,) rows of ``samples``.
    settings
        Settings of the wall.
    box
        (m,) metres and (m,) degrees: for each row, samples within this distance above or below its sample, and within
        this angle beside it, are also left out. None: only samples at the same position are left out.
    trial
        (m,) metres: initial radii; one estimate is made from them, without iteration. None: the method iterates.
    nuggets
        The nuggets of kriging for which `Estimates.by_nugget` has radii.
    """
    if settings.estimator == "near-and-far":  # `helibore.wall.near_and_far` leaves samples out of it
        rule = "must be 'inverse-distance' or 'kriging' to be cross-validated"
        raise InputError("estimator", rule, "'near-and-far'", "wall.estimator")
    depth, toolface, _ = samples
    nothing = np.zeros(rows.size)
    if trial is None:
        trial = np.full(rows.size, settings.bit_diameter / 2)
    else:
        settings = replace(settings, max_iterations=1)
    points = (depth[rows], toolface[rows], trial, *(box or (nothing, nothing)))
    return Estimates(*_core.estimate_at(in_core(samples), points, vars(settings), threads, nuggets))


def estimate_places(samples: Columns, places: Sequence[tuple[float, float]], settings: Settings) -> Floats:
    """Return the radius at places (depth in metres, toolface in degrees), m; NaN if no sample is in reach."""
    depth, toolface = np.array(places).T.copy()
    trial, none = np.full(depth.size, settings.bit_diameter / 2), np.full(depth.size, -1.0)
    points = (depth, toolface, trial, none, none)
    return Estimates(*_core.estimate_at(in_core(samples), points, vars(settings), thread_count(None), ())).radius


def spread(count: int, most: int) -> Integers:
    """Return up to ``most`` of ``count`` rows, spread evenly."""
    return distinct(np.linspace(0, count - 1, min(most, count)).astype(np.int64))


def few_rows(depth: Floats, most: int) -> Integers:
    """Return up to ``most`` rows, spread evenly; fewer in a crowd, because each is compared with all of it."""
    return spread(depth.size, int(np.clip(_COMPARISONS / _crowd(depth), 2, most)))


def _crowd(depth: Floats) -> float:
    """Return the mean number of samples within `_LEVEL` of the depth of a sample."""
    rows = spread(depth.size, 1000)
    starts, stops = (np.searchsorted(depth, depth[rows] + reach) for reach in (-_LEVEL, _LEVEL))
    return float(np.mean(stops - starts + 1))


def find_kriging_range(samples: Columns, settings: Settings) -> float:
    """Return four times the median distance from a sample to the 16th nearest one, in the metric of the settings.

    The median is that of up to 1,000 samples. They are fewer if many samples lie near one depth, because each is
    then compared with all of these. If there are too few samples, or all lie at one position, return half the
    circumference at bit size.
    """
    rows = few_rows(samples[0], 1000)
    simple = replace(settings, estimator="inverse-distance", neighbors=16, max_distance=None, max_iterations=2)
    farthest = estimate_left_out(samples, rows, simple).farthest
    farthest = farthest[farthest > 0]
    if farthest.size:
        return 4.0 * float(np.median(farthest))
    return float(0.5 * np.pi * settings.bit_diameter * settings.angular_scale)

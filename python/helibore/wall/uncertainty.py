"""The uncertainty of a wall: `Wall.sigma`, calibrated by leaving samples out.

    sigma^2 = (q / 1.96)^2 (tau^2 W + c S^a D^b)

    W   sum of the squared weights, which is the share of the noise tau^2 that remains
    S   mean square of the differences between the radii used and the estimate; it shows how much the wall changes
    D   mean square of the distances to the samples used; distances around the hole are multiplied by the stretch

Samples are left out with boxes as large as the empty boxes around random places (`choose_left_out`). tau, c, a, b and
the stretch maximise the likelihood of the errors, by Student's t with 5 degrees of freedom. The variance of an error is
that of the estimate plus the noise tau^2 of the sample itself. q is the 95 % quantile of the absolute errors, each
divided by its standard deviation. If the radii are quantised, tau^2 is at least step^2 / 12: samples with the same
radius agree, but are not that sure. So the true radius lies within 1.96 sigma of the wall with 95 % probability, at
places like those of the left-out samples. Sigma is NaN in gaps of the turn (`Wall.angular_gap` above
`Settings.largest_gap`), and at places that are farther from the samples used than 98 % of the left-out samples are, or
half as far again but at most 0.15 m, as far as a measured vertex may be from its sample.

With near and far neighbours, sigma is that of the covariance instead: the kriging variance of each radius, times the
square of one factor, q / 1.96 within 0.85 to 2.5, from a few hundred left-out samples; if the arms of the samples are
known, plus what their biases add (`helibore.wall.arm_biases`). If most samples have no other one within 0.1 m, they do
not tell noise from a rough wall between them: half of the noise then counts as roughness, with the kriging variance. Of
closer samples, the part of the noise by which each one does not differ from the nearest one counts: a fine roughness
that the covariance takes for noise, or the error of steps, which neighbours share. If the samples of few arms leave
several turns of the shape along the hole about as likely, the kriging variance is the expected square about the mean of
their walls. There, a gap of the turn is measured within the greatest length of the covariance along the hole (0.5 to
15 m) above and below the vertex, unless within that length the samples lie as those of one to three arms: these cannot
show how the shape changes around the hole. A gap that is wider than the length of the long term around the hole (two
thirds of it if the term repeats after half a turn) may hide a shape, unless the shape turns past the arms.

With `Settings.stretches`, all this is by the covariance of the stretch in which a vertex lies.

Samples metres away say nothing about a breakout of a metre. If at more than 0.1 % of places spread over the wall the
scatter of the samples near (what each differs from the estimate of those above it, squared, over the variance of that)
is above 4 times what the covariance leads to expect, the hole has such short events: it is not alike all along. Then
the variance is multiplied by the scatter at each vertex, so that sigma is large beside what the samples show to change,
and small elsewhere; and a gap of the turn is measured within `Settings.gap_reach`, as by the other estimators, because
an event between samples that are farther apart is seen by none.

In other holes, what a shape changes along the hole grows with the shape: a breakout that is twice as deep is twice as
uneven. Where the wall is farther from the radius of the covariance than its standard deviation (of the shape and such
roughness), the variance is multiplied by the square of their ratio.

If a tool leaves more than half of the turns unmeasured (few arms, telemetry), samples are too far apart to separate
noise from shape. Then tau^2 (1 + W) replaces tau^2 W.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from helibore import _core
from helibore.base.arrays import Floats, distinct
from helibore.base.errors import InputError
from helibore.samples.helix import whole_helix
from helibore.settings.wall_settings import Settings
from helibore.wall.estimates import (
    FEWEST_SAMPLES,
    MOST_UNMEASURED,
    Columns,
    choose_left_out,
    estimate_left_out,
    few_rows,
)
from helibore.wall.spikes import find_spikes
from helibore.wall.wall_columns import WallColumns

if TYPE_CHECKING:
    from helibore.wall.covariance import Covariance

TARGETS = 2000
_FEW_TARGETS = 300
_FACTORS = (0.85, 2.5)
_CLOSE = 0.1  # metres: samples that are not so close do not tell noise from a rough wall
_OF_HALF_TURNS = 2.0 / 3.0  # share of the length around of a term that repeats after half a turn
_EVENT = 4.0
"""Scatter of the samples near a place, over what the covariance leads to expect, that a short event has: in holes that
are alike all along it was at most 3.1."""
_EVENTS = 1e-3  # share of the places
_PLACES = 20_000  # about
_ROUGHNESS = 0.5  # share of the noise that then is roughness of the wall
_LEAST, _OF_LEAST = 0.9, 0.623  # of normal values, the least nine of ten have this share of the mean square
NORMAL_95 = 1.959964


@dataclass(frozen=True)
class Calibration:
    """The parameters of the uncertainty of a wall; `helibore.wall.uncertainty` explains the symbols."""

    noise: float  # tau, metres
    between: float  # c
    scatter_power: float  # a
    distance_power: float  # b
    stretch: float
    quantile: float  # q
    reach: float  # metres: how far the rms distance to the samples used may be

    def sigma(self, sums: tuple[Floats, ...]) -> Floats:
        """Return the standard uncertainty of estimates, metres; NaN beyond ``reach``.

        ``sums`` are W, S and the mean squares of the distances along and around the hole.
        """
        square_weights, scatter, along, across = sums
        ratio = self.quantile / NORMAL_95
        share, powers = ratio * ratio, (self.scatter_power, self.distance_power)
        rule = (share * self.noise * self.noise, share * self.between, *powers, self.stretch, self.reach)
        return _core.sigma_of((square_weights, scatter, along, across), rule)


def calibrate(samples: Columns, settings: Settings, threads: int = 1) -> Calibration:
    """Calibrate the uncertainty of a wall with these settings and samples; for errors see `choose_left_out`."""
    rows, boxes = choose_left_out(samples, settings, TARGETS, 0, "for an uncertainty")
    found = _core.calibrate(samples, rows, boxes, vars(settings), threads)
    if found is None:
        rule = "too few samples for an uncertainty: no sample has another one outside its box and within max_distance"
        raise InputError("samples", rule)
    # Nine digits: no result depends on what rounding leaves of the others.
    return Calibration(*(float(f"{value:.9g}") for value in found))


def wall_sigma(wall: WallColumns, threads: int) -> Floats:
    """Return the standard uncertainty at each vertex, for `Wall.sigma`. ``wall`` must have its ``sums``.

    The uncertainty is NaN if the wall is assumed round: the samples around the hole are copies of one reading, or of
    bit size.
    """
    if wall.basis != "azimuthal":
        return np.full(wall.radius.size, np.nan)
    depth, toolface, radius = wall.sample_columns[:3]
    if wall.settings.estimator == "near-and-far":
        return _near_and_far_sigma(wall, (depth, toolface, radius), threads)
    calibration = calibrate((depth, toolface, radius), wall.settings, threads)
    sigma, unmeasured = calibration.sigma(wall.sums), _unmeasured(wall)
    if np.mean(unmeasured) > MOST_UNMEASURED:
        noise = calibration.quantile / NORMAL_95 * calibration.noise
        sigma = np.sqrt(sigma * sigma + noise * noise)  # in the bits of every machine
    sigma[unmeasured] = np.nan
    return sigma


def _near_and_far_sigma(wall: WallColumns, samples: Columns, threads: int) -> Floats:
    from helibore.wall.arm_biases import arm_shares, remaining_products
    from helibore.wall.covariance import noise_at, stretch_of, stretches_of

    factor = near_and_far_factor(samples, wall.settings)
    variance = factor**2 * wall.sums[0]
    stretches = stretches_of(wall.settings)
    depth = whole_helix(wall).depth(np.arange(variance.size))
    of = stretch_of(stretches, depth)
    rough = _roughness(samples, wall.settings, stretches[0].covariance.radius) * noise_at(wall.settings, depth)
    variance += factor**2 * rough
    events = shows_events(samples, wall.settings, threads)
    if events:
        variance *= wall.sums[1]
    else:
        middle, shape = np.array([(each.radius, each.variance) for _, each in stretches])[of].T
        variance *= np.maximum((wall.radius - middle) ** 2 / (shape + rough), 1.0)
    remaining = remaining_products(samples, wall.arms, wall.settings)
    if remaining is not None:
        arm, products = remaining
        shares = arm_shares(wall.sample_columns, arm, wall.settings, threads)
        variance += np.einsum("in,ij,jn->n", shares, products, shares)
    sigma: Floats = np.sqrt(variance)
    for number in distinct(of).tolist():
        rules = with_gaps_of_shape(samples, wall.settings, stretches[number].covariance, events)
        sigma[(of == number) & _unmeasured(replace(wall, settings=rules))] = np.nan
    return sigma


def _roughness(samples: Columns, settings: Settings, radius: float) -> float:
    """Return the share of the noise that is roughness of a wall of a radius, or what samples side by side share."""
    from helibore.wall.covariance import noise_at

    rows = few_rows(samples[0], TARGETS)
    simple = replace(settings, estimator="inverse-distance", neighbors=1, max_distance=None, angular_scale=1.0)
    found = estimate_left_out(samples, rows, simple, trial=np.full(rows.size, radius))
    if np.sum(found.nearest <= _CLOSE) < 0.5 * rows.size:
        return _ROUGHNESS
    squares = (samples[2][rows] - found.radius) ** 2 / (2.0 * noise_at(settings, samples[0][rows]))
    squares = np.sort(squares[np.isfinite(squares)])
    differ = squares[: int(np.ceil(_LEAST * squares.size))].mean() / _OF_LEAST
    return float(f"{max(1.0 - differ, 0.0):.6g}")  # six digits: as in `calibrate`


def shows_events(samples: Columns, settings: Settings, threads: int) -> bool:
    """Return whether samples show short events, such as breakouts, which the covariance of the hole does not have."""
    length = float(np.ptp(samples[0]))
    pitch = max(abs(settings.pitch), length * settings.sectors / _PLACES)
    places = replace(
        settings, sigma=True, direct=False, pitch=pitch, start_depth=None, stop_depth=None, first_vertex=0,
        stop_vertex=None,
    )  # fmt: skip
    wall = _core.Wall(vars(places), threads, "automatic")
    wall.append(*samples)
    scatter = wall.sums()[1]
    return bool(np.sum(scatter > _EVENT) > _EVENTS * scatter.size)


def with_gaps_of_shape(samples: Columns, settings: Settings, covariance: Covariance, events: bool) -> Settings:
    """Return the settings with the ``gap_reach`` and ``largest_gap`` for near and far neighbours by a covariance.

    `helibore.wall.uncertainty` states these rules: in wider gaps no error can be known. ``events``: `shows_events`.
    """
    from helibore.wall.covariance import shows_around

    around = float(np.degrees(covariance.terms[min(1, len(covariance.terms) - 1)].around / covariance.radius))
    around *= _OF_HALF_TURNS if covariance.half_turns else 1.0
    alike = not events and shows_around(samples, covariance.gap_reach)
    reach = covariance.gap_reach if alike else settings.gap_reach
    most = settings.largest_gap if covariance.turn else min(settings.largest_gap, around)
    return replace(settings, gap_reach=reach, largest_gap=most)


def arm_sigma(wall: WallColumns) -> float:
    """Return the standard uncertainty that all radii of a wall share by the biases of the tool's arms, metres.

    The mean over a turn takes all arms alike. It is 0 if the arms are not known, or the estimator is not near and far
    neighbours.
    """
    from helibore.wall.arm_biases import remaining_products

    if wall.settings.estimator != "near-and-far" or wall.basis != "azimuthal":
        return 0.0
    depth, toolface, radius = wall.sample_columns[:3]
    remaining = remaining_products((depth, toolface, radius), wall.arms, wall.settings)
    return 0.0 if remaining is None else float(np.sqrt(np.mean(remaining[1])))


def near_and_far_factor(samples: Columns, settings: Settings) -> float:
    """Return the factor of the kriging standard deviation, from samples that are left out with boxes around them.

    It is 1 if there are too few samples to leave any out.
    """
    if samples[0].size < FEWEST_SAMPLES:
        return 1.0
    from helibore.wall.covariance import noise_at
    from helibore.wall.near_and_far import estimate_near_and_far

    rows, boxes = choose_left_out(samples, settings, _FEW_TARGETS, 0, "for an uncertainty")
    if settings.robust:  # a spike shows no error
        good = ~find_spikes(samples, rows)[0]
        rows, boxes = rows[good], (boxes[0][good], boxes[1][good])
    found = estimate_near_and_far(samples, rows, settings, boxes)
    share = np.abs(found[:, 0] - samples[2][rows]) / np.sqrt(found[:, 1] + noise_at(settings, samples[0][rows]))
    share = share[np.isfinite(share)]
    if not share.size:
        return 1.0
    return float(f"{np.clip(np.quantile(share, 0.95) / NORMAL_95, *_FACTORS):.6g}")  # six digits: as in `calibrate`


def _unmeasured(wall: WallColumns) -> np.ndarray:
    """Return whether each vertex lies in a gap of the turn above `Settings.largest_gap`.

    In most walls no vertex lies in such a gap, and a part of the samples is enough to show this. The depths are divided
    into intervals no longer than `Settings.gap_reach`, and the turn into parts no wider than a third of the largest
    gap. If each part of each interval has a sample, no gap is longer than two parts.
    """
    depth, toolface = wall.sample_columns[:2]
    ends = whole_helix(wall).depth(np.array([0, wall.radius.size - 1]))
    intervals = int(np.ceil(np.ptp(ends) / wall.settings.gap_reach)) + 1
    parts = int(np.ceil(1080 / wall.settings.largest_gap))
    if intervals * parts > depth.size:
        return wall.angular_gap > wall.settings.largest_gap
    some = slice(None, None, max(1, depth.size // (20 * parts * intervals)))
    interval = np.floor((depth[some] - ends.min()) * (intervals / max(np.ptp(ends), 1e-9)))
    inside = (interval >= 0) & (interval < intervals)
    cell = interval[inside] * parts + np.floor(toolface[some][inside] * (parts / 360.0))
    if np.bincount(cell.astype(np.int64), minlength=intervals * parts).all():
        return np.zeros(wall.radius.size, dtype=bool)
    return wall.angular_gap > wall.settings.largest_gap

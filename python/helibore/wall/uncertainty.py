"""How sure a wall is: `Wall.sigma`, calibrated by leaving samples out.

    sigma^2 = (q / 1.96)^2 (tau^2 W + c (G / G~) (S / S~)^beta)

    W   sum of the squared weights: how much of the noise tau is left
    G   mean distance to the samples used, in a metric of its own: what lies between them
    S   mean square of their radii about the estimate: how much the wall changes there
    ~   the median of the left-out samples

Samples are left out with boxes as empty as those around vertices (`empty_boxes`). tau, c, beta and the metric of G have
the greatest likelihood of their errors, by Student's t with 5 degrees of freedom; an error has the variance of the
estimate plus the noise tau^2 of the sample itself. q is the 95 % quantile of the errors in these units. So the true
radius lies within 1.96 sigma of the wall with 95 % probability where the wall is like the places that were left out.
Where it is not, sigma is NaN: farther from samples than 98 % of the left-out ones, and in gaps of the turn
(`Wall.angular_gap` above `Settings.largest_gap`).
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace

import numpy as np

from helibore import _core
from helibore.base.arrays import Floats
from helibore.base.errors import InputError
from helibore.base.settings import Settings
from helibore.samples.helix import helix_of
from helibore.wall.empty_boxes import empty_boxes
from helibore.wall.estimates import Columns, Estimates, estimate_left_out
from helibore.wall.state import WallState

FEWEST_SAMPLES = 100
TARGETS = 2000
NORMAL_95 = 1.959964
_FREEDOM = 5.0
_NOISE_SHARES = (0.0, *np.geomspace(1e-3, 0.999, 14).tolist())
_POWERS = (0.5, 0.65, 0.8, 0.95)
_SMALLEST = 1e-9  # metres; smaller errors are rounding


@dataclass(frozen=True)
class Calibration:
    """What the uncertainty of a wall is computed with; names as above.

    Attributes
    ----------
    noise
        tau, metres.
    between
        c, square metres.
    power
        beta.
    metric
        Which of `Estimates.spread` is G.
    usual_spread, usual_scatter
        G~ (m) and S~ (m^2).
    quantile
        q.
    reach
        98 % of the left-out samples are at most so far from the nearest sample used, metres.
    """

    noise: float
    between: float
    power: float
    metric: int
    usual_spread: float
    usual_scatter: float
    quantile: float
    reach: float

    def sigma(self, of: Estimates) -> Floats:
        """Return the standard uncertainty of estimates, metres; NaN beyond ``reach``."""
        shape = (of.spread[self.metric] / self.usual_spread) * (of.scatter / self.usual_scatter) ** self.power
        variance = self.noise**2 * of.square_weights + self.between * shape
        return np.where(of.nearest <= self.reach, self.quantile / NORMAL_95 * np.sqrt(variance), np.nan)


def calibrate(samples: Columns, settings: Settings, threads: int = 1, seed: int = 0) -> Calibration:
    """Calibrate the uncertainty of the walls that these settings make of these samples.

    Raises
    ------
    InputError
        ``samples = 37: too few samples for an uncertainty: must be at least 100``.
    """
    depth, _, radius = samples
    if depth.size < FEWEST_SAMPLES:
        rule = f"too few samples for an uncertainty: must be at least {FEWEST_SAMPLES}"
        raise InputError("samples", rule, str(depth.size))
    rng = np.random.default_rng(seed)
    rows = np.sort(rng.choice(depth.size, min(TARGETS, depth.size), replace=False))
    found = estimate_left_out(samples, rows, settings, empty_boxes(samples, settings, rows.size, rng), threads)
    known = np.isfinite(found.radius)
    if not known.any():
        raise InputError("samples", "too few samples for an uncertainty: none has another within max_distance")
    squares = np.maximum((found.radius - radius[rows])[known] ** 2, _SMALLEST**2)
    weights, scatter = found.square_weights[known], np.maximum(found.scatter[known], _SMALLEST**2)
    spread = [each[known] for each in found.spread]

    def shape(metric: int, power: float) -> Floats:
        """G / G~ (S / S~)^beta."""
        scattered: Floats = (scatter / np.median(scatter)) ** power
        return spread[metric] / np.median(spread[metric]) * scattered

    best = (-np.inf, 0, 0.0, 0.0, 0.0)
    for metric, power in itertools.product(range(len(spread)), _POWERS):
        changes = shape(metric, power)
        for share in _NOISE_SHARES:
            form = np.maximum(share * (1.0 + weights) + (1.0 - share) * changes, 1e-12)
            scale, likelihood = _student(squares / form, form)
            best = max(best, (likelihood, metric, power, share, scale))
    _, metric, power, share, scale = best
    noise, between = float(np.sqrt(share * scale)), (1.0 - share) * scale
    variance = noise**2 * (1.0 + weights) + between * shape(metric, power)
    quantile = float(np.sqrt(np.quantile(squares / variance, 0.95)))
    reach = float(np.quantile(found.nearest[known], 0.98))
    usual = float(np.median(spread[metric])), float(np.median(scatter))
    return Calibration(noise, between, power, metric, *usual, quantile, reach)


def _student(squares: Floats, form: Floats) -> tuple[float, float]:
    """Scale of errors with these squares by Student's t, and its logarithmic likelihood, without constants."""
    scale = float(np.mean(squares))
    for _ in range(12):
        scale = float(np.mean((_FREEDOM + 1.0) * squares / (_FREEDOM + squares / scale)))
    terms = (_FREEDOM + 1.0) * np.log1p(squares / (_FREEDOM * scale)) + np.log(form * scale)
    return scale, -0.5 * float(np.sum(terms))


def wall_sigma(wall: WallState, threads: int) -> Floats:
    """Return the standard uncertainty at each vertex: `Wall.sigma`."""
    depth, toolface, radius = wall.sample_columns[:3]
    samples = (depth, toolface, radius)
    calibration = calibrate(samples, wall.settings, threads)
    helix = helix_of(wall)
    number = np.arange(wall.radius.size)
    none = np.full(number.size, -1.0)
    points = (helix.depth(number), helix.toolface(number), wall.radius, none, none)
    found = Estimates(*_core.estimate_at(samples, points, vars(replace(wall.settings, max_iterations=1)), threads, ()))
    sigma = calibration.sigma(found)
    sigma[wall.angular_gap > wall.settings.largest_gap] = np.nan
    return sigma

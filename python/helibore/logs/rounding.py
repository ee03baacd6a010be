"""What radii in coarse steps make of the mean radius of a turn.

A radius r is measured as the nearest multiple of the step q. With normal noise of deviation tau, the mean of many such
samples is off by q / pi exp(-2 pi^2 tau^2 / q^2) sin(2 pi r / q), to the first term of its series: more samples do not
help, and where a hole is round, all of the turn is off alike. Where r changes by steps around the turn, it cancels.
Nobody knows the phase, so the uncertainty of the turn's mean is

    q / (sqrt2 pi) exp(-2 pi^2 tau^2 / q^2) |mean of exp(2 pi i r / q) over the turn|
"""

from __future__ import annotations

import numpy as np

from helibore.base.arrays import Floats, distinct
from helibore.settings.wall_settings import Settings

_ROUNDING = 1e-9  # metres


def step_of(radius: Floats) -> float:
    """Return the step of which all differences of radii are multiples, to 1 %, metres; 0 if there is none."""
    gaps = np.diff(distinct(radius))
    gaps = gaps[gaps > _ROUNDING]
    if not gaps.size:
        return 0.0
    least = float(gaps.min())
    return least if np.all(np.abs(gaps - least * np.round(gaps / least)) <= 0.01 * least) else 0.0


def rounding_sigma(radius: Floats, measured: Floats, settings: Settings) -> Floats:
    """Return the uncertainty of the mean radius of turns by the steps of the measured radii, metres.

    ``radius`` is (turns, sectors), NaN where it is not known. Only a covariance knows the noise of samples, in a round
    hole with up to q^2 / 4 of rounding; else the noise is taken to be 0.
    """
    step = step_of(measured)
    if not step:
        return np.zeros(len(radius))
    square = max(settings.covariance[1] - step**2 / 4.0, 0.0) if settings.covariance else 0.0
    greatest = step / (np.sqrt(2.0) * np.pi) * np.exp(-2.0 * np.pi**2 * square / step**2)
    known = np.isfinite(radius)
    alike = np.abs(np.exp(2j * np.pi / step * np.where(known, radius, 0.0)).sum(axis=1, where=known))
    found: Floats = greatest * alike / np.maximum(known.sum(axis=1), 1)
    return found

"""The uncertainty of largest and least diameters and of ovality, by draws.

A largest diameter is not linear in the radii: where a hole is nearly round, errors decide where it lies, and they make
it larger. So the radii of a turn are drawn again with their uncertainty:

    sigma^2 = spread^2 + (stated - wall + G bias)^2

spread is the standard deviation of a diameter of the drawn turns, bias how much larger it is in their mean than that of
the wall, and stated the diameter of the logs, which may be that of the tool's arms. The wall has errors already, so the
errors of the draws add less than they did: in a round hole, where the bias grows as the root of the variance, the part
1 / G = sqrt(2) - 1. Errors are alike over some degrees around the turn. All turns take the same fields of errors, so
that a turn has the same values in every part of a wall.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from helibore.base.arrays import Floats, Integers
from helibore.logs.log_columns import SHAPE_SIGMA

_PAIRS = 32
"""Fields of errors; each is taken with both signs."""
_WIDTHS = 2.0 * 1.25 ** np.arange(25)
"""Degrees over which errors are alike, of which the next is taken."""
_GROWTH = 1.0 / (np.sqrt(2.0) - 1.0)
_CHUNK = 2048  # turns


def shape_sigma(
    radius: Floats, sigma: Floats, alike: Floats, stated: dict[str, Floats], accuracy: Floats
) -> dict[str, Floats]:
    """Return the uncertainty of C1, C2, C1 - C2 and ovality of each turn, from that of each radius.

    Parameters
    ----------
    radius, sigma
        (turns, sectors) metres. A turn with a NaN has no uncertainty.
    alike
        (turns,) degrees over which the errors of a turn are alike.
    stated
        ``c1``, ``c2`` and ``ovality_api`` of each turn, as `Logs` has them.
    accuracy
        (turns,) standard uncertainty that all radii of a turn share, metres; it widens C1 and C2.

    Returns
    -------
    dict
        The columns of `SHAPE_SIGMA`, (turns,) each.
    """
    turns = len(radius)
    of_stated = np.stack([stated["c1"], stated["c2"], stated["c1"] - stated["c2"], stated["ovality_api"]])
    level = np.rint(np.log(np.maximum(alike, _WIDTHS[0]) / _WIDTHS[0]) / np.log(_WIDTHS[1] / _WIDTHS[0]))
    width = np.clip(np.nan_to_num(level), 0, _WIDTHS.size - 1).astype(np.int64)
    found = np.full((4, turns), np.nan)
    known = np.flatnonzero(np.isfinite(radius).all(axis=1) & np.isfinite(sigma).all(axis=1))
    for first in range(0, known.size, _CHUNK):
        rows = known[first : first + _CHUNK]
        found[:, rows] = _deviations(radius[rows], sigma[rows], width[rows], of_stated[:, rows])
    found[:2] = np.hypot(found[:2], 2 * accuracy)
    return dict(zip(SHAPE_SIGMA, found, strict=True))


def _deviations(radius: Floats, sigma: Floats, width: Integers, stated: Floats) -> Floats:
    fields = _fields(radius.shape[1])
    across = _diameters(radius)
    own, mean, square = _measures(across), np.zeros_like(stated), np.zeros_like(stated)
    for pair in range(_PAIRS):
        error = _diameters(sigma * fields[pair][width])
        for drawn in (across + error, across - error):
            off_own = _measures(drawn) - own
            mean += off_own / (2 * _PAIRS)
            square += off_own**2 / (2 * _PAIRS)
    found: Floats = np.sqrt(square - mean**2 + (stated - own + _GROWTH * mean) ** 2)
    return found


def _diameters(radius: Floats) -> Floats:
    """Return the diameters from each vertex; with an odd number of sectors the far side lies between two vertices."""
    near, far = radius.shape[1] // 2, (radius.shape[1] + 1) // 2
    across: Floats = radius + 0.5 * (np.roll(radius, -near, axis=1) + np.roll(radius, -far, axis=1))
    return across


def _measures(across: Floats) -> Floats:
    """Return C1, C2, C1 - C2 and ovality of turns of diameters, (4, turns)."""
    turn, sectors = np.arange(len(across)), across.shape[1]
    greatest = np.argmax(across, axis=1)
    c1, least, quarter = across[turn, greatest], across.min(axis=1), greatest + sectors // 4
    ends = [across[turn, (quarter + more) % sectors] for more in (0, 1)]
    c2 = ends[0] + sectors % 4 / 4 * (ends[1] - ends[0])
    return np.stack([c1, c2, c1 - c2, (c1 - least) / (c1 + least)])


@cache
def _fields(sectors: int) -> Floats:
    """Return (pairs, widths, sectors) fields of unit variance, with a Gaussian correlation around the turn."""
    harmonic = np.arange(sectors // 2 + 1)[:, None]
    angle = 2.0 * np.pi * harmonic * np.arange(sectors) / sectors
    power = np.exp(-np.pi * (harmonic[:, 0] * _WIDTHS[:, None] / 360.0) ** 2)
    power[:, 1:] *= 2.0
    drawn = np.random.default_rng(0).normal(size=(2, _PAIRS, harmonic.size, 1))
    waves = drawn[0] * np.cos(angle) + drawn[1] * np.sin(angle)
    fields = np.einsum("wh,phs->pws", np.sqrt(power), waves)
    scaled: Floats = fields / np.sqrt(np.mean(fields**2, axis=0))
    return scaled

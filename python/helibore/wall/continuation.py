"""Decide whether the shape of a hole continues along it, for tools that leave most of each turn unmeasured.

Such tools have few arms, or send few samples by telemetry.

If the shape continues (a breakout, a key seat, an oval hole), the wall between two arms is known from samples at the
same toolface, metres above or below: kriging with a large angular scale uses them. Cross-validation cannot decide this,
because no sample lies between the arms. The likelihood of the samples can decide it:

    Up to 60 random blocks of the hole, each 10 m long, give 8 to 48 samples each. In a block the radius is a constant
    plus a Gaussian process with the covariance of kriging: Wendland's C2 function of distance / range, and a nugget.
    The likelihood is the restricted one: the constants of the blocks are integrated out. All blocks share one variance,
    the one that maximises the likelihood.

A covariance is long if its angular scale is in `LONG`, and short if it is in `SHORT`. The best long covariance is
chosen if its likelihood exceeds that of the best short one by more than `LEAST_GAIN` nats a block. On holes of known
shape, right choices gained 36 or more and wrong choices lost (bench/accuracy/known_holes.py). A shape that turns with
the tool cannot be distinguished from a shape that does not turn.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from helibore import _core
from helibore.base.arrays import Floats
from helibore.base.thread_count import thread_count
from helibore.samples.helix import Helix
from helibore.settings.wall_settings import Settings
from helibore.wall.estimates import MOST_UNMEASURED, Columns

LEAST_GAIN = 8.0
"""Nats a block by which the log-likelihood of a long covariance must exceed that of a short one."""
SHORT, LONG = (1.0, 2.0, 4.0, 8.0), (64.0, 200.0, 400.0)
"""Angular scales of the short covariances, and of the long ones."""
RANGES = (0.3, 1.0, 3.0, 12.0, 30.0, 80.0)
LEAST_LONG_RANGE = 12.0
"""Metres along the hole: a covariance with a shorter range is not long."""
NUGGETS = (0.003, 0.02, 0.1, 0.4)
_BLOCKS, _FEWEST_SAMPLES, _MOST_SAMPLES, _BLOCK_LENGTH, _POSITIONS = 60, 8, 48, 10.0, 2000


def find_continuation(samples: Columns, settings: Settings, seed: int) -> tuple[Settings | None, float]:
    """Find the settings of kriging for a hole whose shape continues along it.

    Returns
    -------
    settings
        None if the shape does not continue, if the tool measures half of the turns or more, if all radii are equal, or
        if no block has enough samples.
    gain
        Log-likelihood of the best long covariance less that of the best short one, nats a block; NaN if they were not
        compared.
    """
    if not leaves_most_unmeasured(samples, settings) or np.ptp(samples[2]) < 1e-9:
        return None, np.nan
    likelihoods = dict(_likelihoods(samples, np.random.default_rng(seed)))
    long = [key for key in likelihoods if key[0] in LONG and key[1] >= LEAST_LONG_RANGE]
    short = [key for key in likelihoods if key[0] in SHORT]
    if not (long and short):
        return None, np.nan
    scale, reach, nugget = best = max(long, key=lambda key: likelihoods[key])
    gain = likelihoods[best] - max(likelihoods[key] for key in short)
    found = replace(
        settings, estimator="kriging", neighbors=16, angular_scale=scale, kriging_range=reach, nugget=nugget,
        max_distance=reach,
    )  # fmt: skip
    return (found if gain > LEAST_GAIN else None), gain


def leaves_most_unmeasured(samples: Columns, settings: Settings) -> bool:
    """Return whether most of each turn has no sample within ``gap_reach`` and half the ``largest_gap``.

    Turns without any sample do not count: a hole may be logged in two parts.
    """
    helix, gaps = spread_gaps(samples, settings, settings.gap_reach)
    at = helix.depth(np.arange(gaps.size))
    first, last = (np.searchsorted(samples[0], at + sign * settings.gap_reach) for sign in (-1.0, 1.0))
    open_ = gaps[last > first] > settings.largest_gap
    return not open_.size or bool(np.mean(open_) > MOST_UNMEASURED)


def spread_gaps(samples: Columns, settings: Settings, reach: float) -> tuple[Helix, Floats]:
    """Return places spread over the wall, and the gap of the turn around each, of samples within ``reach`` of depth."""
    depth, toolface, _ = samples
    turns = max(_POSITIONS // settings.sectors, 1)
    spread = Helix(depth[0], 0.0, max(float(np.ptp(depth)), 1e-6) / turns, settings.sectors)
    return spread, _core.angular_gaps(spread, turns * settings.sectors, depth, toolface, reach, thread_count(None))


def _likelihoods(samples: Columns, rng: np.random.Generator) -> Iterator[tuple[tuple[float, float, float], float]]:
    """Yield for each covariance (angular scale, range, nugget), and the mean of its log-likelihood over the blocks."""
    rows = _blocks(samples[0], rng)
    if not rows.size:
        return
    depth, toolface, radius = (column[rows] for column in samples)
    turn = np.abs(toolface[:, :, None] - toolface[:, None])
    around = np.minimum(turn, 360.0 - turn) * np.radians(np.median(radius))
    along = depth[:, :, None] - depth[:, None]
    sides = np.stack([np.ones_like(radius), radius - radius.mean()], axis=-1)
    contrasts = rows.shape[1] - 1
    for scale in (*SHORT, *LONG):
        distance = np.hypot(scale * around, along)
        half_turn = np.pi * float(np.median(radius)) * scale  # kriging uses no longer range
        for reach in RANGES:
            part = np.minimum(distance / min(reach, half_turn), 1.0)
            covariance = (1.0 - part) ** 4 * (1.0 + 4.0 * part)
            for nugget in NUGGETS:
                try:
                    root = np.linalg.cholesky(covariance + nugget * np.eye(contrasts + 1))
                except np.linalg.LinAlgError:  # with arc lengths, a covariance may be not positive definite
                    continue
                one, value = np.moveaxis(np.linalg.solve(root, sides), -1, 0)
                ones = np.sum(one**2, axis=1)
                rest = float(np.sum(value**2) - np.sum(np.sum(one * value, axis=1) ** 2 / ones))
                size = 2.0 * np.log(np.diagonal(root, axis1=1, axis2=2)).sum() + np.log(ones).sum()
                variance = max(rest, 1e-18) / (len(rows) * contrasts)
                yield (scale, reach, nugget), -0.5 * (float(size) / len(rows) + contrasts * np.log(variance))


def _blocks(depth: Floats, rng: np.random.Generator) -> np.ndarray:
    """Return the rows of random samples from random blocks of the hole, (blocks, samples); empty if samples are few."""
    length = min(_BLOCK_LENGTH, float(np.ptp(depth)))
    first = rng.uniform(depth[0], depth[-1] - length, _BLOCKS) if depth[-1] - length > depth[0] else depth[:1]
    ends = np.searchsorted(depth, [first, first + length])
    count = min(_MOST_SAMPLES, max(_FEWEST_SAMPLES, int(np.median(ends[1] - ends[0]))))
    wide = [(low, high) for low, high in ends.T if high - low >= count]
    return np.array([rng.choice(np.arange(low, high), count, replace=False) for low, high in wide])

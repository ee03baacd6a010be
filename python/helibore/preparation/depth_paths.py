r"""Find the shift of a pass as a function of depth: the likeliest smooth path through how well each shift fits.

    shift  |....__..            each row of the pass has a likelihood for each shift on a grid; the shift wanders from
           |__/....\__          row to row, and may jump. A forward and a backward pass give its distribution at each
           +---------- depth    row. How much it wanders is chosen by the evidence; a constant shift wanders hardly.

A shift that wanders is looked for once more about the line through it (a cable that stretches); that path is kept if it
wanders less, with the deviation of the first, which knows of no line. A pass that moves to and fro has mass, so its
path is found once more as one whose slope wanders, not the shift itself; how much the slope does is chosen by the
evidence as well.

Readings follow Student's t about the field of the other passes. Neighbouring readings err together, so the logarithm of
the likelihood is divided by the geometric mean of two numbers: how much more the slope of the fit over whole stretches
varies than if readings erred alone, and how much more the differences from the field do.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from helibore.base.arrays import Floats, Integers, Mask, distinct
from helibore.preparation.fields import FREEDOM, HARMONICS, Field, RowsOfPass, seen_by_all

MOST = 2.2
"""Largest shift, metres."""
STEP = 0.02
"""Metres between trial shifts."""
GRID = np.arange(-round(MOST / STEP), round(MOST / STEP) + 1) * STEP
APART = 0.12
"""Metres; a shift is known if it lies within this with a probability of 98 %."""

CALM, RESTLESS = 0.003, 0.01
"""Metres in 5 cm: greatest wander of a cable that stretches, and least of a pass that moves to and fro."""

FINEST = STEP / np.sqrt(12.0)
"""Metres: least deviation of a shift, which may lie anywhere between two trial shifts."""

_WANDERS = (0.0003, 0.001, CALM, RESTLESS, 0.03, 0.1)  # metres in 5 cm of depth
_NEARLY = 1.0  # logarithm: a pass moves to and fro if the evidence for it is at most so much less than for a calm path
_JUMP = 1e-6  # probability of a jump from one row to the next; a true step pays it back over the rows that follow
_ROWS_AT_ONCE = 256
_SLOPES = (0.01, 0.03, 0.1, 0.3, 1.0, 3.0)  # variance of the change of a shift's slope in 1 m of depth, 1/m
_NEAR = 0.06  # metres from the path within which a row is asked which shift it says
_SHORTEST, _LONGEST, _HEIGHTS = 1.5, 12.0, (0.08, 0.15)  # metres: waves about a path
_MOST_WAVES, _PHASES = 300, 16
_BLOCK, _LEAD = 160, 60  # rows that are smoothed at once, and rows before and after them
STRETCH = 2.0
"""Metres in which readings err together."""


@dataclass(frozen=True)
class DepthPath:
    """The shift of each of m rows, metres, and how it was found."""

    shift: Floats  # (m,)
    sigma: Floats  # (m,)
    known: Mask  # (m,): within 0.12 m
    fits: Floats  # logarithm of the likelihood of each shift in each row, divided as above, (m, shifts)
    bias: float  # m: how much more the readings are than the fields
    divisor: float  # of the logarithm of the likelihood
    wander: float  # metres in 5 cm of depth
    base: Floats  # shift of each row at which the trial shifts are 0, (m,) m


def find_path(rows: RowsOfPass, fields: Sequence[Field], noise: float) -> DepthPath:
    """Return the path that a pass takes through the fields of others.

    Parameters
    ----------
    rows
        The readings of the pass.
    fields
        What the others saw, less their biases.
    noise
        Metres, of a reading of the pass.
    """
    path = _path_about(np.zeros(rows.depth.size), rows, fields, noise)
    known = path.known
    restless = path.wander >= RESTLESS
    sloped = path
    if path.wander > _WANDERS[0] and known.sum() >= 3:
        slope, level = np.polyfit(rows.depth[known], path.shift[known], 1, w=1 / path.sigma[known])
        sloped = _path_about(slope * rows.depth + level, rows, fields, noise)
    if sloped.wander >= (RESTLESS if restless else path.wander):
        return _smoothed(path, rows.depth) if restless else path
    return replace(sloped, sigma=np.maximum(sloped.sigma, path.sigma), known=sloped.known & known)


def _path_about(base: Floats, rows: RowsOfPass, fields: Sequence[Field], noise: float) -> DepthPath:
    """Return the path of a pass that is moved by ``base`` (m,) beforehand."""
    rows = replace(rows, depth=rows.depth + base)
    bias, divisor = 0.0, 4.0
    wanders: tuple[float, ...] = _WANDERS
    for _ in range(2):
        raw = _fits(rows, fields, bias, noise)
        probability, wander = _probabilities(rows.depth, raw / divisor, wanders)
        shift = probability @ GRID
        excess = _excess(rows.depth, raw, shift)
        mean, variance, _ = seen_by_all(fields, (rows.depth + shift)[:, None], rows.design())
        off = rows.radius - mean[:, 0]
        bias = float(np.nanmedian(off))
        noise *= max(1.0, 1.4826 * float(np.nanmedian(np.abs(off - bias) / np.sqrt(variance[:, 0] + noise**2))))
        together = _together(rows, (off - bias) / np.sqrt(variance[:, 0] + noise**2))
        divisor = float(np.sqrt(max(excess, 1.0) * together))
        at = _WANDERS.index(wander)
        wanders = _WANDERS[max(at - 1, 0 if wander < RESTLESS else _WANDERS.index(RESTLESS)) : at + 2]
    probability, wander = _probabilities(rows.depth, raw / divisor, wanders)
    shift = probability @ GRID
    away = GRID - shift[:, None]
    sigma = np.hypot(np.sqrt((probability * np.square(away)).sum(axis=1)), FINEST)
    known = (sigma < APART) & ((probability * (np.abs(away) > APART)).sum(axis=1) < 0.02)
    return DepthPath(base + shift, sigma, known, raw / divisor, bias, divisor, wander, base)


def _smoothed(path: DepthPath, depth: Floats) -> DepthPath:
    """Return a path that moves to and fro with a slope that wanders; rows in which it is another are not known."""
    mean, precision = _said_alone(path)
    shift, variance, _ = max(
        (with_slope(depth, mean, precision, slope) for slope in _SLOPES), key=lambda found: found[2]
    )
    known = path.known & (np.abs(shift - path.shift) < APART)
    shift = np.where(known, shift, path.shift)
    return replace(
        path, shift=shift, sigma=np.where(known, np.hypot(np.sqrt(variance), FINEST), path.sigma), known=known
    )


def _said_alone(path: DepthPath) -> tuple[Floats, Floats]:
    """Return mean and precision of the normal law that stands for what each row says by itself of a shift near the
    path; a precision of 0 where it says nothing."""
    away = path.base[:, None] + GRID - path.shift[:, None]
    score = path.fits - 0.5 * np.square(away / _NEAR)
    probability = np.exp(score - score.max(axis=1, keepdims=True))
    probability /= probability.sum(axis=1, keepdims=True)
    mean = (probability * away).sum(axis=1)
    both = 1.0 / ((probability * np.square(away - mean[:, None])).sum(axis=1) + FINEST**2)
    precision = np.maximum(both - 1.0 / _NEAR**2, 0.0)
    return path.shift + mean * both / np.maximum(precision, 1e-9), precision


def with_slope(depth: Floats, mean: Floats, precision: Floats, slope: float) -> tuple[Floats, Floats, float]:
    """Return mean and variance of the shift of each row, and the evidence but for a constant, for rows that say
    ``mean`` with ``precision`` and a slope whose changes have the variance ``slope`` in a metre."""
    shift, variance, evidence = np.empty(depth.size), np.empty(depth.size), 0.0
    for first in range(0, depth.size, _BLOCK):
        start, stop = max(first - _LEAD, 0), min(first + _BLOCK + _LEAD, depth.size)
        gap = np.diff(depth[start:stop])
        bends = np.diff(np.diff(np.eye(stop - start), axis=0) / gap[:, None], axis=0)
        bends /= np.sqrt(0.5 * slope * (gap[1:] + gap[:-1]))[:, None]
        said = precision[start:stop] * mean[start:stop]
        matrix = bends.T @ bends + np.diag(precision[start:stop] + 1.0 / MOST**2)
        inverse = np.linalg.inv(matrix)
        found = inverse @ said
        evidence += 0.5 * float(said @ found - np.linalg.slogdet(matrix)[1] - len(bends) * np.log(slope))
        inside = slice(first - start, first - start + _BLOCK)
        shift[first : first + _BLOCK] = found[inside]
        variance[first : first + _BLOCK] = np.diagonal(inverse)[inside]
    return shift, variance, evidence


def wave_about(path: DepthPath, depth: Floats) -> tuple[float, float, float]:
    """Return the most that a wave about the path gains (logarithm of the likelihood), and its height and length, m.

    A pass that moves may have too few readings for the evidence of a shift that wanders, not for that of one wave.
    """
    phases = np.arange(_PHASES)
    row = np.flatnonzero(path.known)
    length = float(np.ptp(depth[row]))
    least, most = length / _LONGEST, length / _SHORTEST
    best = (0.0, 0.0, 0.0)
    for height in _HEIGHTS:
        moved = path.shift[row, None] - path.base[row, None] + height * np.sin(2 * np.pi * phases / _PHASES)
        gains = _at(path, row, moved) - _at(path, row, (path.shift - path.base)[row, None])
        for wave in length / np.linspace(least, most, min(int(2 * (most - least)) + 1, _MOST_WAVES)):
            phase = np.round(depth[row] / wave * _PHASES).astype(np.int64) % _PHASES
            by_phase = np.stack([np.bincount(phase, each, _PHASES) for each in gains.T], axis=1)
            total = max(by_phase[phases, (phases + lag) % _PHASES].sum() for lag in phases)
            best = max(best, (float(total), height, float(wave)))
    return best


def _at(path: DepthPath, row: Integers, shift: Floats) -> Floats:
    """Return the logarithm of the likelihood of shifts (r, k), less the base of the path, in r rows, (r, k)."""
    at = np.clip(np.round((shift - GRID[0]) / STEP).astype(np.int64), 0, GRID.size - 1)
    found: Floats = path.fits[row[:, None], at]
    return found


def student(off: Floats, variance: Floats) -> Floats:
    """Return the logarithm of the density of each difference, 0 where there is none."""
    return np.nan_to_num(
        -0.5 * (FREEDOM + 1) * np.log1p(np.square(off) / (FREEDOM * variance)) - 0.5 * np.log(variance)
    )


def _fits(rows: RowsOfPass, fields: Sequence[Field], bias: float, noise: float) -> Floats:
    """Return the logarithm of the likelihood of each shift in each row, less its mean.

    A row from which a shift may lead to where the field is not known says nothing: another shift would fit by chance.
    """
    fits = np.empty((rows.depth.size, GRID.size))
    design = rows.design()
    for start in range(0, rows.depth.size, _ROWS_AT_ONCE):
        some = slice(start, start + _ROWS_AT_ONCE)
        mean, variance, known = seen_by_all(fields, rows.depth[some, None] + GRID, design[some])
        off = rows.radius[some, None] - bias - mean
        one = np.where(np.isnan(off), 0.0, student(off, variance + noise**2)).sum(axis=2)
        fits[some] = np.where(known.all(axis=1, keepdims=True), one - one.mean(axis=1, keepdims=True), 0.0)
    return fits


def _excess(depth: Floats, fits: Floats, shift: Floats) -> float:
    """Return how much more the slope of the fits varies over stretches than their curvature at the path, or the slopes
    of the rows, say; these are the same if readings err alone, and where two shifts fit alike there is no curvature."""
    at = np.clip(np.round((shift - GRID[0]) / STEP).astype(np.int64), 2, GRID.size - 3)
    row = np.arange(at.size)
    above, here, below = fits[row, at - 2], fits[row, at], fits[row, at + 2]
    slope, bend = (below - above) / (4 * STEP), -(below - 2 * here + above) / (2 * STEP) ** 2
    stretch = np.unique(np.floor(depth / STRETCH), return_inverse=True)[1]
    return float(np.square(np.bincount(stretch, slope)).sum() / max(bend.sum(), np.square(slope).sum(), 1e-9))


def _together(rows: RowsOfPass, off: Floats) -> float:
    """Return how much more the waves in the differences of whole stretches vary than if readings erred alone."""
    stretch = np.unique(np.floor(rows.depth / STRETCH), return_inverse=True)[1]
    known = rows.known
    scaled = np.where(known, np.clip(off, -4.0, 4.0), 0.0)
    each = max(float(np.square(scaled).sum()), 1e-9)
    waves = (np.exp(1j * n * rows.angle) * scaled for n in range(HARMONICS + 1))
    sums = [wave.sum(axis=1) for wave in waves]
    power = [np.square(np.bincount(stretch, wave.real)) + np.square(np.bincount(stretch, wave.imag)) for wave in sums]
    return max(1.0, max(float(of.sum()) for of in power) / each)


def _probabilities(depth: Floats, fits: Floats, wanders: tuple[float, ...]) -> tuple[Floats, float]:
    """Return the probability of each shift in each row, for the wander with the most evidence, and this wander."""
    likelihood = np.exp(fits - fits.max(axis=1, keepdims=True))
    gaps = np.maximum(np.round(np.diff(depth) / (0.25 * 0.05)), 1.0)
    best, chosen, most = np.empty(0), wanders[0], -np.inf
    for wander in wanders:
        forward, evidence = _forward(likelihood, gaps, wander)
        if evidence > most - (_NEARLY if (chosen, wander) == (CALM, RESTLESS) else 0.0):
            best, chosen, most = forward, wander, max(evidence, most)
    backward = np.ones(GRID.size)
    kernels = _kernels(gaps, chosen)
    for row in range(depth.size - 2, -1, -1):
        backward = _moved(backward * likelihood[row + 1], kernels[gaps[row]])
        backward /= backward.sum()
        best[row] *= backward
    best /= best.sum(axis=1, keepdims=True)
    return best, chosen


def _forward(likelihood: Floats, gaps: Floats, wander: float) -> tuple[Floats, float]:
    forward, kernels, evidence = np.empty(likelihood.shape), _kernels(gaps, wander), 0.0
    belief = np.full(GRID.size, 1.0 / GRID.size)
    for row in range(len(likelihood)):
        if row:
            belief = _moved(belief, kernels[gaps[row - 1]])
        belief = belief * likelihood[row]
        total = belief.sum()
        evidence += np.log(total)
        belief = forward[row] = belief / total
    return forward, float(evidence)


def _moved(belief: Floats, kernel: Floats) -> Floats:
    spread: Floats = (1 - _JUMP) * np.convolve(belief, kernel, "same") + _JUMP / GRID.size * belief.sum()
    return spread


def _kernels(gaps: Floats, wander: float) -> dict[float, Floats]:
    """Return for each distance between rows, in quarters of 5 cm, how a shift spreads over it."""
    kernels = {}
    for gap in distinct(gaps).tolist():
        variance = np.square(wander / STEP) * gap / 4
        wide = min(int(np.ceil(4 * np.sqrt(variance))), GRID.size // 2)
        kernel = np.exp(-0.5 * np.square(np.arange(-wide, wide + 1)) / variance)
        if variance < 0.5:
            kernel = np.array([variance / 2, 1 - variance, variance / 2])
        kernels[gap] = kernel / kernel.sum()
    return kernels

"""The covariance of a hole: how alike the radii at two places are, fitted to the samples.

    C(a, b) = sum over terms of  variance M(h),   h^2 = chord^2 / around^2 + (depth difference)^2 / along^2
    M(h) = (1 + sqrt3 h) exp(-sqrt3 h)    (Matern 3/2)
    chord = 2 R sin(toolface difference / 2)      R: the median radius

The chord is a distance in space, so C is positive definite whatever the lengths are. One sample also has the noise
variance. The first term is short, the second is long; a third, fine one is there only if the samples show it.

The parameters maximise the restricted likelihood of the samples; of more than 300, that of small blocks: each block has
64 samples from a window of the hole; windows are short and long, so that the blocks show what single samples, arms and
passes share. Such a composite likelihood counts samples more than once, so its curvature says nothing about certainty.
Weak priors decide what the samples leave open, for example the shape between fixed arms.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from helibore.base.arrays import Floats, Integers
from helibore.wall.estimates import Columns

FEWEST = 40
"""Number of samples that a fit needs."""
MOST_TERMS = 3
_ONE_BLOCK = 300
"""So many samples are one block: their likelihood is exact, and costs less than that of small blocks."""
_BLOCKS, _BLOCK_SIZE = 12, 64
_WINDOWS = (0.3, 1.0, 4.0, 16.0, 64.0)  # metres
_ROOT3 = float(np.sqrt(3.0))
_STARTS = ((1e-6, 0.05, 0.06, 4e-6, 0.1, 0.6, 0.25e-6), (1e-6, 0.03, 0.03, 4e-6, 0.1, 8.0, 1e-6),
           (0.3e-6, 0.06, 0.3, 20e-6, 0.12, 40.0, 4e-6))  # fmt: skip
_FINE = [(share, around, 2.5 * around) for share in (0.3, 0.7) for around in (0.006, 0.012, 0.025)]
_FINE_GAIN = 0.05  # nats a block that a fine term must gain
_LEAST_NOISE = 1e-12  # m^2
_ENOUGH = 0.003  # nats a block; a smaller gain ends the search


class Term(NamedTuple):
    """One part of the covariance."""

    variance: float  # m^2
    around: float  # metres around the hole
    along: float  # metres along the hole


@dataclass(frozen=True)
class Covariance:
    """The covariance of the radii of a hole; `helibore.wall.covariance` has the formula."""

    terms: tuple[Term, ...]  # short, long and, in some holes, fine
    noise: float  # m^2: variance of the noise of one sample
    radius: float  # R, metres

    def at(self, turn: Floats, along: Floats) -> Floats:
        """Return the covariance of two radii, m^2; ``turn`` (deg) and ``along`` (m) are differences of position."""
        chord = 2.0 * self.radius * np.sin(np.radians(turn) / 2.0)
        total = np.zeros(np.broadcast(turn, along).shape)
        for term in self.terms:
            total += term.variance * _matern(np.sqrt((chord / term.around) ** 2 + (along / term.along) ** 2))
        return total

    @property
    def variance(self) -> float:
        """Variance of the radius, m^2."""
        return sum(term.variance for term in self.terms)


def _matern(h: Floats) -> Floats:
    found: Floats = (1.0 + _ROOT3 * h) * np.exp(-_ROOT3 * h)
    return found


def content_seed(samples: Columns) -> int:
    """Return a seed that depends on nothing but the samples."""
    content = hashlib.sha256(b"".join(column.tobytes() for column in samples))
    return int.from_bytes(content.digest()[:8], "little")


def fit_covariance(samples: Columns, step: float = 0.0) -> Covariance | None:
    """Fit the covariance to samples in order of depth; None if there are fewer than `FEWEST`, or all radii are equal.

    ``step`` is the step of quantised radii, metres: the noise is then at least step^2 / 48.
    """
    depth, toolface, radius = samples
    if depth.size < FEWEST or float(np.ptp(radius)) < 1e-9:
        return None
    middle = float(np.median(radius))
    rows = choose_blocks(depth, toolface, middle, np.random.default_rng(content_seed(samples)))
    blocks = _Blocks.of(depth[rows], toolface[rows], radius[rows], middle)
    least_noise = max(_LEAST_NOISE, step**2 / 48.0)
    limits = _limits(middle, least_noise)
    few = blocks.every(2)
    trials = [_climb(few, np.clip(np.log(start), *limits), limits, 8) for start in _STARTS]
    best = _climb(blocks, max(trials, key=lambda of: of[1])[0], limits, 20)
    fine = _with_fine(blocks, best, limits)
    values = np.exp(fine[0] if fine[1] > best[1] + _FINE_GAIN else best[0])
    rounded = [float(f"{value:.5g}") for value in values]  # last bits of logarithms differ between machines
    noise, lengths = rounded[6], [*rounded[:6], *rounded[7:]]
    terms = tuple(Term(*lengths[i : i + 3]) for i in range(0, len(lengths), 3))
    return Covariance(terms, noise, float(f"{middle:.5g}"))


def choose_blocks(depth: Floats, toolface: Floats, radius: float, rng: np.random.Generator) -> Integers:
    """Return the rows of the samples of each block, (blocks, samples).

    Few samples are one block. Else the first blocks hold the samples nearest to random places on the wall, the others
    random samples of windows.
    """
    if depth.size <= _ONE_BLOCK:
        return np.arange(depth.size)[None]
    size = _BLOCK_SIZE
    places = zip(rng.uniform(depth[0], depth[-1], _BLOCKS), rng.uniform(0.0, 360.0, _BLOCKS), strict=True)
    chosen = [_nearest(depth, toolface, radius, place, size) for place in places]
    for window in _WINDOWS:
        for centre in rng.uniform(depth[0], depth[-1], _BLOCKS):
            low, high = np.searchsorted(depth, [centre - window / 2, centre + window / 2])
            if high - low < size:
                low = int(np.clip((low + high - size) // 2, 0, depth.size - size))
                high = low + size
            chosen.append(np.sort(rng.choice(np.arange(low, high), size, replace=False)))
    return np.array(chosen)


def _nearest(depth: Floats, toolface: Floats, radius: float, place: tuple[float, float], size: int) -> Integers:
    """Return the rows of the samples nearest to a place on the wall."""
    half = radius
    while True:
        low, high = np.searchsorted(depth, [place[0] - half, place[0] + half])
        turn = np.abs(toolface[low:high] - place[1])
        distance = np.hypot(np.radians(np.minimum(turn, 360.0 - turn)) * radius, depth[low:high] - place[0])
        if distance.size >= size and (
            np.partition(distance, size - 1)[size - 1] <= half or distance.size == depth.size
        ):
            found: Integers = low + np.sort(np.argsort(distance, kind="stable")[:size])
            return found
        half *= 2.0


class _Blocks(NamedTuple):
    """Squares of chords and of depth differences in each block, (blocks, n, n) m^2, and the radii (blocks, n)."""

    chord: Floats
    along: Floats
    radius: Floats

    @classmethod
    def of(cls, depth: Floats, toolface: Floats, radius: Floats, middle: float) -> _Blocks:
        half = np.radians(toolface[:, :, None] - toolface[:, None]) / 2.0
        along = depth[:, :, None] - depth[:, None]
        return cls((2.0 * middle * np.sin(half)) ** 2, along**2, radius - radius.mean(axis=1, keepdims=True))

    def every(self, nth: int) -> _Blocks:
        return _Blocks(*(column[::nth] for column in self))


_Limits = tuple[Floats, Floats]
_PRIORS = np.array([0.0, 0.02, 0.02, 0.03, 0.15, 0.02, 0.0])  # nats a block for one unit of the logarithm, squared
_EXPECTED = np.log([1.0, 0.05, 0.06, 4e-6, 0.10, 0.6, 1.0])
_NOISE = 6  # index of the noise; the first six are variance, around and along of the short and of the long term


def _limits(radius: float, least_noise: float) -> _Limits:
    low = [1e-12, 0.004, 0.004, 1e-12, 0.35 * radius, 0.02, least_noise]
    high = [1e-2, 4 * radius, 60.0, 1e-2, 2.5 * radius, 200.0, 1e-2]
    return np.log(low), np.log(high)


def _with_fine(blocks: _Blocks, best: tuple[Floats, float], limits: _Limits) -> tuple[Floats, float]:
    """Return the likeliest parameters with a fine term, three more than without."""
    low = np.append(limits[0], np.log([1e-12, 0.003, 0.006]))
    high = np.append(limits[1], np.log([1e-3, 0.04, 0.2]))
    few = blocks.every(3)
    starts = []
    for share, around, along in _FINE:
        start = np.append(best[0], np.log([share * np.exp(best[0][_NOISE]), around, along]))
        start[_NOISE] += np.log(1.0 - share)
        start = np.clip(start, low, high)
        starts.append((start, _likelihood(few, start)))
    start, gain = max(starts, key=lambda of: of[1])
    if gain < _likelihood(few, best[0]) - 0.5:
        return best
    return _climb(blocks, start, (low, high), 15)


def _prior(at: Floats) -> tuple[float, Floats, Floats]:
    """Return the log-prior, its slope and its curvature (a matrix)."""
    off = at[: _PRIORS.size] - _EXPECTED
    slope, curvature = np.zeros(at.size), np.zeros((at.size, at.size))
    slope[: _PRIORS.size] = -2.0 * _PRIORS * off
    np.fill_diagonal(curvature[: _PRIORS.size, : _PRIORS.size], 2.0 * _PRIORS)
    ratio = at[0] + np.log(4.0) - at[_NOISE]
    slope[0] -= 0.04 * ratio
    slope[_NOISE] += 0.04 * ratio
    curvature[np.ix_([0, _NOISE], [0, _NOISE])] += 0.04 * np.array([[1.0, -1.0], [-1.0, 1.0]])
    return -float(_PRIORS @ off**2 + 0.02 * ratio**2), slope, curvature


def _triples(at: Floats) -> list[int]:
    """Return the index of the first parameter of each term."""
    return [0, 3, 7][: 2 + (at.size > _NOISE + 1)]


class _Fitted(NamedTuple):
    value: float  # log-likelihood, nats a block, with the prior
    inner: Floats  # P, (blocks, n, n)
    outer: Floats  # P r, (blocks, n)
    parts: list[Floats]  # derivatives of the covariance by each parameter, without that by the noise


def _evaluate(blocks: _Blocks, at: Floats, slopes: bool) -> _Fitted | None:
    values = np.exp(at)
    size = blocks.radius.shape[1]
    covariance = np.zeros(blocks.chord.shape)
    parts = []
    for first in _triples(at):
        variance, around, along = values[first : first + 3]
        of_chord, of_along = blocks.chord * (3.0 / around**2), blocks.along * (3.0 / along**2)
        distance = np.sqrt(of_chord + of_along)
        decay = variance * np.exp(-distance)
        part = decay * (1.0 + distance)
        covariance += part
        if slopes:
            parts += [part, decay * of_chord, decay * of_along]
    diagonal = np.arange(size)
    covariance[:, diagonal, diagonal] += values[_NOISE]
    try:
        root = np.linalg.cholesky(covariance)
    except np.linalg.LinAlgError:
        return None
    inverse = np.linalg.inv(root)
    ones = inverse.sum(axis=2)
    whitened = np.einsum("bij,bj->bi", inverse, blocks.radius)
    squares = np.sum(ones**2, axis=1)
    rest = np.sum(whitened**2, axis=1) - np.sum(ones * whitened, axis=1) ** 2 / squares
    logs = 2.0 * np.log(np.diagonal(root, axis1=1, axis2=2)).sum(axis=1) + np.log(squares)
    value = -0.5 * float(np.mean(logs + rest)) + _prior(at)[0]
    if not slopes:
        return _Fitted(value, covariance, ones, [])
    inner = inverse.transpose(0, 2, 1) @ inverse
    row = inner.sum(axis=2)
    inner -= row[:, :, None] * row[:, None] / squares[:, None, None]
    return _Fitted(value, inner, np.einsum("bij,bj->bi", inner, blocks.radius), parts)


def _likelihood(blocks: _Blocks, at: Floats) -> float:
    found = _evaluate(blocks, at, slopes=False)
    return found.value if found else -np.inf


def _climb(blocks: _Blocks, at: Floats, limits: _Limits, most: int) -> tuple[Floats, float]:
    """Find the likeliest parameters by damped Fisher scoring between limits; return them and their log-likelihood."""
    now = _evaluate(blocks, at, slopes=True)
    if now is None:
        return at, -np.inf
    damping = 1e-2
    for _ in range(most):
        slope, curvature = _slope_and_curvature(now, at)
        free = ~(((at <= limits[0]) & (slope < 0)) | ((at >= limits[1]) & (slope > 0)))
        for _ in range(6):
            damped = curvature[np.ix_(free, free)]
            damped += damping * np.diag(np.diagonal(damped) + 0.01)
            step = np.zeros(at.size)
            step[free] = np.linalg.solve(damped, slope[free])
            trial = np.clip(at + np.clip(step, -2.0, 2.0), *limits)
            new = _evaluate(blocks, trial, slopes=True)
            if new is not None and new.value > now.value:
                break
            damping *= 6.0
        else:
            break
        gain = new.value - now.value
        at, now, damping = trial, new, damping / 5.0
        if gain < _ENOUGH:
            break
    return at, now.value


def _slope_and_curvature(of: _Fitted, at: Floats) -> tuple[Floats, Floats]:
    """Return the derivatives of the log-likelihood, and its expected second derivatives with the other sign."""
    count, size = of.outer.shape
    noise = np.broadcast_to(np.exp(at[_NOISE]) * np.eye(size), of.inner.shape)
    parts = [*of.parts[:_NOISE], noise, *of.parts[_NOISE:]]
    products = [of.inner @ part for part in parts]
    traces = np.array([np.trace(product, axis1=1, axis2=2).sum() for product in products])
    squares = np.array([np.sum(of.outer * np.einsum("bij,bj->bi", part, of.outer)) for part in parts])
    flat = np.array([product.reshape(-1) for product in products])
    turned = np.array([product.transpose(0, 2, 1).reshape(-1) for product in products])
    _, prior_slope, prior_curvature = _prior(at)
    return 0.5 * (squares - traces) / count + prior_slope, 0.5 * (flat @ turned.T) / count + prior_curvature

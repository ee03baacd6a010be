"""The covariance of a hole: how alike the radii at two places are, fitted to the samples.

    C(a, b) = sum over terms of  variance M(h),   h^2 = chord^2 / around^2 + (depth difference)^2 / along^2
    M(h) = (1 + sqrt3 h) exp(-sqrt3 h)    (Matern 3/2)
    chord = 2 R sin((toolface difference - turn * depth difference) / 2)      R: the median radius

The chord is a distance in space, so C is positive definite whatever the lengths are. One sample also has the noise
variance. The first term is short, the second is long; a third, fine one is there only if the samples show it. So is the
turn: a breakout, say, may turn along the hole. If that is much likelier, the long term repeats after half a turn, as
breakouts and ovals do: its chord is R sin of the whole angle, which is a distance too. An odd number of arms that do
not pass the shape cannot show this; it is then sought only beside turns that they leave open. If that is likelier, the
short term is smooth, M(h) = exp(-h^2 / 2), so that a wall without roughness is averaged over more samples.

The parameters maximise the restricted likelihood of the samples; of more than 300, that of small blocks: each block has
64 samples from a window of the hole; windows are short and long, so that the blocks show what single samples, arms and
passes share. Such a composite likelihood counts samples more than once, so its curvature says nothing about certainty.
Weak priors decide what the samples leave open, for example the shape between fixed arms.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from helibore import _core
from helibore.base.arrays import Floats, Integers
from helibore.base.thread_count import thread_count
from helibore.settings.wall_settings import Settings
from helibore.wall.estimates import Columns, spread
from helibore.wall.spikes import find_spikes

FEWEST = 40
"""Number of samples that a fit needs."""
MOST_TERMS = 3
FARTHEST_ALIKE = 15.0
"""Metres along the hole over which samples count, at most, in the gaps of a wall with a covariance."""
_ONE_BLOCK = 300
"""So many samples are one block: their likelihood is exact, and costs less than that of small blocks."""
_BLOCKS, BLOCK_SIZE = 12, 64
"""Blocks of each of six kinds, and samples of a block."""
_WINDOWS = (0.3, 1.0, 4.0, 16.0, 64.0)  # metres
_PLACES = 100
_SAME_ARMS = 0.7  # mean cosine
_SAME_DEPTH = 0.5  # metres
_LEAST_TURN = 120.0
"""Degrees a metre: one to three arms do not show a slower turn. To three, an oval that turns slowly looks like a circle
off centre that turns the other way, twice as fast."""
_SHORT_AROUND, _LONG_AROUND = 3, 6
"""Indices in the setting: below 0 if the short term is smooth, and if the long term repeats after half a turn."""
_BESIDE_BORDER = 0.2
"""Metres: samples of another stretch count so far from it. Also in `near_far.cpp`."""
_SEEDING = 100_000  # samples


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
    turn: float = 0.0  # degrees a metre along the hole
    half_turns: bool = False  # the long term repeats after half a turn
    smooth: bool = False  # the short term is

    def at(self, turn: Floats, along: Floats) -> Floats:
        """Return the covariance of two radii, m^2; ``turn`` (deg) and ``along`` (m) are differences of position."""
        turned = np.radians(turn - self.turn * along)
        chord = (2.0 * self.radius * np.sin(turned / 2.0)) ** 2
        length = along**2
        total = np.zeros(np.broadcast(turn, along).shape)
        for number, term in enumerate(self.terms):
            across = (self.radius * np.sin(turned)) ** 2 if number == 1 and self.half_turns else chord
            square = across / term.around**2 + length / term.along**2
            total += term.variance * (np.exp(-0.5 * square) if number == 0 and self.smooth else _matern(square))
        return total

    @property
    def values(self) -> tuple[float, ...]:
        """The setting ``covariance`` of a wall."""
        values = [self.radius, self.noise, *(value for term in self.terms for value in term)]
        if self.smooth:
            values[_SHORT_AROUND] *= -1.0
        if self.half_turns:
            values[_LONG_AROUND] *= -1.0
        return (*values, self.turn) if self.turn else tuple(values)

    @property
    def variance(self) -> float:
        """Variance of the radius, m^2."""
        return sum(term.variance for term in self.terms)

    @property
    def gap_reach(self) -> float:
        """Metres along the hole: samples so far above and below a place show whether an arm saw it."""
        return float(np.clip(max(term.along for term in self.terms), 0.5, FARTHEST_ALIKE))


class CovarianceFrom(NamedTuple):
    """A stretch of a hole, with its own covariance."""

    start: float  # the depth from which on it counts, metres
    covariance: Covariance


Likely = list[tuple[Covariance, float]]
"""Covariances, each with its share of the probability, the greatest first."""


def _matern(square: Floats) -> Floats:
    h = np.sqrt(3.0 * square)
    found: Floats = (1.0 + h) * np.exp(-h)
    return found


def content_seed(samples: Columns) -> int:
    """Return a seed that depends on nothing but the samples; of more than `_SEEDING`, some are enough."""
    rows = spread(samples[0].size, _SEEDING)
    content = hashlib.sha256(b"".join(column[rows].tobytes() for column in samples))
    return int.from_bytes(content.digest()[:8], "little")


def fit_covariance(samples: Columns, turning: bool = True, threads: int | None = None) -> Covariance | None:
    """Fit the covariance to samples in order of depth; None if there are fewer than `FEWEST`, or all radii are equal.

    If the radii are quantised, the noise is at least step^2 / 48. Without ``turning``, neither a turn nor a fine term
    is sought, which takes a fifth of the time.
    """
    likely = likely_covariances(samples, turning, threads=threads)
    return likely[0][0] if likely else None


def likely_covariances(
    samples: Columns, turning: bool = True, robust: bool = False, threads: int | None = None
) -> Likely:
    """Return the fitted covariance, and those with other turns that the samples leave about as likely, with shares.

    As `fit_covariance`, [] for None; the shares are those of probability. Few arms that do not cross leave several
    turns. If ``robust``, spikes have the radius of the samples beside them.
    """
    depth, toolface, radius = samples
    if depth.size < FEWEST or float(np.ptp(radius)) < 1e-9:
        return []
    middle = float(np.median(radius))
    rows = np.arange(depth.size)[None]  # few samples are one block
    if depth.size > _ONE_BLOCK:
        rows = choose_blocks(depth, toolface, middle, np.random.default_rng(content_seed(samples)))
    blocks, spacing = values_without_spikes(samples, rows.ravel(), robust), typical_spacing(samples, middle)
    least_turn = np.inf if not turning else 0.0 if shows_around(samples, _SAME_DEPTH) else _LEAST_TURN
    found = _core.fit_covariance(blocks, rows.shape[1], middle, spacing, least_turn, thread_count(threads))
    return [(covariance_of(values), share) for values, share in found]


def values_without_spikes(samples: Columns, rows: Integers, robust: bool) -> Columns:
    """Return some of the samples; if ``robust``, spikes among them have the radius of the samples beside them."""
    depth, toolface, radius = (column[rows] for column in samples)
    if robust:
        spikes, beside = find_spikes(samples, rows)
        radius = np.where(spikes, beside, radius)
    return depth, toolface, radius


def typical_spacing(samples: Columns, radius: float) -> float:
    """Return the typical distance between samples on a wall of a radius, metres."""
    return float(np.sqrt(2.0 * np.pi * radius * np.ptp(samples[0]) / samples[0].size))


def shows_around(samples: Columns, reach: float) -> bool:
    """Return whether samples within ``reach`` of each other along the hole show how the shape changes around it.

    They do not if they lie as those of one, two or three arms: how alike their radii are then follows from the length
    along the hole and from that around it alike.
    """
    depth, toolface, _ = samples
    sums, pairs = np.zeros(3), 0
    for at in depth[spread(depth.size, _PLACES)]:
        low, high = np.searchsorted(depth, [at - 0.5 * reach, at + 0.5 * reach])
        near = np.radians(toolface[low + spread(high - low, BLOCK_SIZE)])
        for arms in range(3):
            sums[arms] += np.abs(np.exp(1j * (arms + 1) * near).sum()) ** 2 - near.size
        pairs += near.size * (near.size - 1)
    return bool(sums.max() <= _SAME_ARMS * pairs)


def covariance_of(values: Sequence[float]) -> Covariance:
    """Return the covariance that the setting ``covariance`` of a wall holds."""
    radius, noise, *lengths = values
    turn = lengths.pop() if len(lengths) % 3 else 0.0
    if lengths[6:7] == [0.0]:  # the third term of a stretch that has two
        del lengths[6:]
    half_turns = len(values) > _LONG_AROUND and values[_LONG_AROUND] < 0.0
    terms = tuple(Term(lengths[i], abs(lengths[i + 1]), lengths[i + 2]) for i in range(0, len(lengths), 3))
    return Covariance(terms, noise, radius, turn, half_turns, values[_SHORT_AROUND] < 0.0)


def other_turns(likely: Likely) -> tuple[float, ...] | None:
    """Return the setting ``other_turns`` of a wall, whose covariance is the first of the likely ones."""
    values = [(share, *of.values, *(() if of.turn else (0.0,))) for of, share in likely[1:]]
    return tuple(value for of in values for value in of) or None


def stretches_of(settings: Settings) -> list[CovarianceFrom]:
    """Return the stretches of the hole that the settings of a wall have; the first is what lies above the others."""
    others = np.reshape(settings.stretches or (), (-1, 13)).tolist()
    first = CovarianceFrom(-np.inf, covariance_of(settings.covariance or ()))
    return [first, *(CovarianceFrom(start, covariance_of(values)) for start, *values in others)]


def stretch_of(stretches: Sequence[CovarianceFrom], depth: Floats) -> Integers:
    """Return the number of the stretch at each depth."""
    return np.searchsorted([of.start for of in stretches], depth, side="right") - 1


def noise_at(settings: Settings, depth: Floats) -> Floats:
    """Return the noise variance of samples at depths, m^2."""
    stretches = stretches_of(settings)
    noise: Floats = np.array([each.covariance.noise for each in stretches])[stretch_of(stretches, depth)]
    return noise


def excess_noise(stretches: Sequence[CovarianceFrom], number: int, depth: Floats) -> Floats:
    """Return what samples at depths have more of noise for vertices of a stretch, m^2; `near_far.hpp` explains it."""
    own = stretches[number].covariance
    radius, variance = np.array([(of.radius, of.noise + of.variance) for _, of in stretches]).T
    greater = np.maximum(variance, own.noise + own.variance)
    more = greater - own.noise - own.variance + (radius - own.radius) ** 2
    start, stop = [*(of.start for of in stretches), np.inf][number : number + 2]
    away = np.maximum(np.maximum(start - depth, depth - stop), 0.0)
    of_stretch = stretch_of(stretches, depth)
    found: Floats = more[of_stretch] + greater[of_stretch] * (away / _BESIDE_BORDER) ** 2
    return found


def stretch_values(stretches: Sequence[CovarianceFrom]) -> tuple[float, ...] | None:
    """Return the setting ``stretches`` of a wall; None for none."""
    values: list[float] = []
    for start, of in stretches:
        shape = replace(of, turn=0.0).values
        values += [start, *shape, *((0.0, 1.0, 1.0) if len(of.terms) == 2 else ()), of.turn]
    return tuple(values) or None


def likely_by(settings: Settings) -> Likely:
    """Return the covariances that the settings of a wall leave likely, with their shares; that of the wall first."""
    others = np.reshape(settings.other_turns or (), (-1, 10)).tolist()
    shares = [1.0 - sum(share for share, *_ in others), *(share for share, *_ in others)]
    covariances = [settings.covariance or (), *(values for _, *values in others)]
    return [(covariance_of(values), share) for values, share in zip(covariances, shares, strict=True)]


def choose_blocks(
    depth: Floats, toolface: Floats, radius: float, rng: np.random.Generator, number: int = _BLOCKS
) -> Integers:
    """Return the rows of the samples of each block, (blocks, samples): ``number`` of each of six kinds.

    The first blocks hold the samples nearest to random places on the wall, the others
    random samples of windows.
    """
    size = BLOCK_SIZE
    places = zip(rng.uniform(depth[0], depth[-1], number), rng.uniform(0.0, 360.0, number), strict=True)
    chosen = [_nearest(depth, toolface, radius, place, size) for place in places]
    for window in _WINDOWS:
        for centre in rng.uniform(depth[0], depth[-1], number):
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

"""How far the arms of a tool are off: their biases, how sure they are, and what they add to a wall's uncertainty.

    radius = shape(depth, toolface) + bias[arm] + noise

The shape has the covariance of the hole with a free mean, and the biases are normal with one variance: where arms pass
the same wall, or a shape that continues, they disagree. Their mean is not known: it stays in the wall. The biases are
expected values over the deviations that are likely, by the restricted likelihood of `_MOST` samples together and a
prior. A shape that continues along the whole hole is always thought possible: of fixed arms, which only see such a
shape, the biases are small. `Settings.arm_biases` subtracts them.

Large biases are no proof that arms are off: a breakout that turns may turn the tool, whose arms then follow the shape.
The covariance of the samples as they are, with a shape that turns, competes with that of the samples less biases. With
either one, shape and biases have a likelihood, and the greater one decides.

A wall is a weighted mean of samples. With w the sums of the weights of each arm at a vertex and D the expected products
of what remains of the biases, they add w D w to the variance.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from helibore import _core
from helibore.base.arrays import Floats, Integers, distinct
from helibore.samples.caliper import Caliper
from helibore.settings.wall_settings import Settings
from helibore.wall.covariance import FEWEST, Covariance, Likely, covariance_of, fit_covariance, likely_covariances
from helibore.wall.estimates import Columns, depth_order, in_depth_order
from helibore.wall.interpolation import canonical_order

_DEVIATIONS = np.geomspace(1e-5, 3e-2, 60)  # metres
_USUAL = 2.5e-4  # metres, 0.01 inch; the logarithm of the deviation has a normal prior about this, of deviation 1
_APART = 4.0  # deviations of the differences of biases in two halves of the hole
_JUDGED = 40  # samples of an arm in a half
_SMALL = 0.1
"""Biases up to this share of the noise of a sample are none."""
_WHOLE_HOLE = 1e6
_MOST, _ROUNDS = 1200, 4
MOST_ARMS = 256
"""Arms with larger numbers have no bias."""


def arm_numbers(samples: Columns, arms: Caliper | None) -> Integers | None:
    """Return 0, 1, ... for the arm of each sample.

    None if an arm is not known, or if all samples have one or there are more than `MOST_ARMS`: not those of a tool.
    """
    if arms is None or arms.arm is None:
        return None
    order = canonical_order(arms)
    if not np.array_equal(arms.radius[order], samples[2]):
        return None
    numbers: Integers = np.unique(arms.arm[order], return_inverse=True)[1].reshape(-1)
    return numbers if 0 < numbers.max(initial=0) < MOST_ARMS else None


class Found(NamedTuple):
    """The biases of arms 0, 1, ..."""

    biases: Floats  # metres
    covariance: Floats  # of the biases, m^2, (a, a)
    likelihood: float  # logarithm of the restricted likelihood of samples with shape and biases, but for a constant


def find_biases(samples: Columns, arm: Integers, covariance: Covariance) -> Found:
    """Return the biases of arms 0, 1, ...; 0 for fewer samples than a fit needs."""
    depth, toolface, radius = samples
    count = int(arm.max()) + 1
    if depth.size < FEWEST:
        return Found(np.zeros(count), np.zeros((count, count)), 0.0)
    # The numbers of samples and arms are the seed: the radii with and without biases have the same ones.
    rng = np.random.default_rng([depth.size, count])
    rows = np.sort(rng.choice(depth.size, min(_MOST, depth.size), replace=False))
    turn, along = (of[rows][:, None] - of[rows] for of in (toolface, depth))
    longest = covariance.terms[min(1, len(covariance.terms) - 1)]
    whole = replace(covariance, terms=(*covariance.terms, longest._replace(along=_WHOLE_HOLE)))
    matrix = whole.at(turn, along) + covariance.noise * np.eye(rows.size)
    of_arm = (arm[rows][:, None] == np.arange(count)).astype(np.float64)
    sides = np.column_stack([np.ones(rows.size), radius[rows] - covariance.radius, of_arm])
    root = np.linalg.cholesky(matrix)
    sides = np.linalg.solve(root, sides)
    products = sides.T @ sides
    shape = 2.0 * np.sum(np.log(root.diagonal())) + np.log(products[0, 0])
    products -= np.outer(products[0], products[0]) / products[0, 0]  # the mean is free
    size, axes = np.linalg.eigh(products[2:, 2:])
    toward, size = axes.T @ products[2:, 1], np.maximum(size, 0.0)
    variances = _DEVIATIONS[:, None] ** 2
    spread = variances / (1.0 + variances * size)  # of each axis, by deviation
    likelihood = np.sum(toward**2 * spread + np.log(spread / variances), axis=1) - np.log(_DEVIATIONS / _USUAL) ** 2
    weights = np.exp(0.5 * (likelihood - likelihood.max()))
    of_both = np.log(weights.sum()) + 0.5 * (likelihood.max() - shape - products[1, 1])
    weights /= weights.sum()
    each = spread * toward
    mean = weights @ each
    off = each - mean
    inner = np.diag(weights @ spread) + (weights[:, None] * off).T @ off
    biases: Floats = axes @ mean
    return Found(biases, axes @ inner @ axes.T, float(of_both))


def remaining_products(samples: Columns, arms: Caliper | None, settings: Settings) -> tuple[Integers, Floats] | None:
    """Return the arm of each sample, 0, 1, ..., and the expected products of what remains of the biases, m^2, (a, a).

    None if the arms are not known. What remains is what `Settings.arm_biases` has not subtracted from the samples.
    """
    arm = arm_numbers(samples, arms)
    if arm is None or arms is None or arms.arm is None:
        return None
    subtracted = biases_of(settings, distinct(arms.arm))
    measured = samples[0], samples[1], samples[2] + subtracted[arm]
    found, covariance, _ = find_biases(measured, arm, covariance_of(settings.covariance or ()))
    off = found - subtracted
    return arm, covariance + np.outer(off, off)


def found_biases(
    caliper: Caliper, covariance: Covariance | None = None, threads: int | None = None
) -> tuple[float, ...] | None:
    """Return the biases for `Settings.arm_biases`; None if all are small, or if there are not several
    arms with numbers from 0 to 255.

    ``covariance`` is that of the samples without biases; None: it is fitted too, as if the shape did not turn.
    """
    if caliper.arm is None:
        return None
    numbers, arm = np.unique(caliper.arm, return_inverse=True)
    if numbers.size < 2 or numbers[0] < 0 or numbers[-1] >= MOST_ARMS:
        return None
    arm = arm.reshape(-1)[depth_order(caliper)]
    samples = in_depth_order(caliper)
    biases = np.zeros(numbers.size)
    for _round in range(_ROUNDS):  # a covariance takes great biases for shape
        less = samples[0], samples[1], samples[2] - biases[arm]
        found = covariance or fit_covariance(less, turning=False, threads=threads)
        if found is None:
            break
        before, biases = biases, find_biases(samples, arm, found).biases
        if covariance or np.abs(biases - before).max() <= np.sqrt(found.noise):
            break
    if found is None or np.abs(biases).max() <= _SMALL * np.sqrt(found.noise):
        return None
    if _halves_differ(samples, arm, found):
        return None
    by_number = np.zeros(int(numbers[-1]) + 1)
    by_number[numbers] = np.round(biases, 7)
    return tuple(by_number.tolist())


def _halves_differ(samples: Columns, arm: Integers, covariance: Covariance) -> bool:
    """Return whether the halves of the hole do not have the same biases: then the arms took a shape for biases.

    Compared are arms with some samples in both, and apart from what the arms share: a mean of all is the hole's.
    """
    count, half = int(arm.max()) + 1, arm.size // 2
    halves = [slice(half), slice(half, None)]
    judged = np.flatnonzero(np.all([np.bincount(arm[rows], minlength=count) >= _JUDGED for rows in halves], axis=0))
    if judged.size < 2:
        return False
    one, other = (
        find_biases((samples[0][rows], samples[1][rows], samples[2][rows]), arm[rows], covariance) for rows in halves
    )
    apart, among = np.eye(judged.size) - 1.0 / judged.size, np.ix_(judged, judged)
    off = apart @ (other.biases[judged] - one.biases[judged])
    variance = (apart @ (one.covariance[among] + other.covariance[among]) @ apart).diagonal()
    return bool(np.any(np.abs(off) > _APART * np.sqrt(variance)))


def follow_the_shape(caliper: Caliper, biases: tuple[float, ...], less: Covariance, threads: int | None) -> Likely:
    """Return the covariances of the samples as they are, if these are likelier than ``biases`` and a shape; else [].

    ``less`` is the covariance of the samples less the biases. Biases below the noise do not hide a shape.
    """
    if caliper.arm is None or max(map(abs, biases)) <= np.sqrt(less.noise):
        return []
    samples = in_depth_order(caliper)
    arm = np.unique(caliper.arm, return_inverse=True)[1].reshape(-1)[depth_order(caliper)]
    likely = likely_covariances(samples, threads=threads)
    as_they_are, without = (find_biases(samples, arm, of).likelihood for of in (likely[0][0], less))
    return likely if as_they_are > without else []


def biases_of(settings: Settings, numbers: Integers) -> Floats:
    """Return the biases that the settings have for arms with these numbers, metres; 0 for arms without one."""
    biases = np.zeros(MOST_ARMS + 1)
    stated = settings.arm_biases or ()
    biases[: len(stated)] = stated
    found: Floats = biases[np.where((numbers >= 0) & (numbers < MOST_ARMS), numbers, MOST_ARMS)]
    return found


def without_biases(caliper: Caliper, settings: Settings) -> Caliper:
    """Return the samples less the biases of their arms, which the settings have."""
    if caliper.arm is None or settings.arm_biases is None:
        return caliper
    radius = caliper.radius - biases_of(settings, caliper.arm)
    return Caliper(caliper.depth, caliper.toolface, radius, caliper.time, arm=caliper.arm)


def arm_shares(samples: tuple[Floats, ...], arm: Integers, settings: Settings, threads: int) -> Floats:
    """Return the share of each arm in the radius of each vertex, (arms, n)."""
    wall = _core.Wall(vars(settings) | {"direct": False}, threads, "automatic")
    wall.append(*samples)
    shares = wall.interpolate_samples([(arm == each).astype(np.float64) for each in range(arm.max() + 1)], threads)
    return np.array(shares)

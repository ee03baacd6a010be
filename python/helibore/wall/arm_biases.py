"""How far the arms of a tool are off: the variance of their biases, and what it adds to the uncertainty of a wall.

    radius = shape(depth, toolface) + bias[arm] + noise

The shape has the covariance of the hole, and the biases are normal with one variance. It is the mean of the variances
from (0.01 mm)^2 to (3 mm)^2 by their restricted likelihood in the blocks of `helibore.wall.covariance`: where arms pass
the same wall, or a shape that continues, they disagree, and two or three arms may agree by chance. A wall is a weighted
mean of samples. With W the sum of the weights of one arm at a vertex, its bias adds W^2 times the variance.
"""

from __future__ import annotations

import numpy as np

from helibore import _core
from helibore.base.arrays import Floats, Integers
from helibore.samples.caliper import Caliper
from helibore.settings.wall_settings import Settings
from helibore.wall.covariance import FEWEST, Covariance, choose_blocks, content_seed
from helibore.wall.estimates import Columns
from helibore.wall.interpolation import canonical_order

_DEVIATIONS = np.geomspace(1e-5, 3e-3, 40)  # metres


def arm_numbers(samples: Columns, arms: Caliper | None) -> Integers | None:
    """Return 0, 1, ... for the arm of each sample; None if an arm is not known, or all samples have one."""
    if arms is None or arms.arm is None:
        return None
    order = canonical_order(arms)
    if not np.array_equal(arms.radius[order], samples[2]):
        return None
    numbers: Integers = np.unique(arms.arm[order], return_inverse=True)[1].reshape(-1)
    return numbers if numbers.max(initial=0) > 0 else None


def bias_variance(samples: Columns, arm: Integers, covariance: Covariance) -> float:
    """Return the variance of the biases of the arms, m^2; 0 for fewer samples than a fit needs."""
    depth, toolface, radius = samples
    if depth.size < FEWEST:
        return 0.0
    rows = choose_blocks(depth, toolface, covariance.radius, np.random.default_rng(content_seed(samples)))
    turn, along = (of[rows][:, :, None] - of[rows][:, None] for of in (toolface, depth))
    matrix = covariance.at(turn, along) + covariance.noise * np.eye(rows.shape[1])
    of_arm = (arm[rows][..., None] == np.arange(arm.max() + 1)).astype(np.float64)
    sides = np.concatenate([np.ones((*rows.shape, 1)), (radius[rows] - covariance.radius)[..., None], of_arm], axis=2)
    products = np.swapaxes(sides, 1, 2) @ np.linalg.solve(matrix, sides)
    products -= products[:, :, :1] * products[:, :1] / products[:, :1, :1]  # the mean of each block is free
    total = products.sum(axis=0) * min(1.0, depth.size / rows.size)
    size, axes = np.linalg.eigh(total[2:, 2:])
    square, size = (axes.T @ total[2:, 1]) ** 2, np.maximum(size, 0.0)
    variances = _DEVIATIONS**2
    spread = 1.0 + variances[:, None] * size
    likelihood = np.sum(square * variances[:, None] / spread - np.log(spread), axis=1)
    share = np.exp(likelihood - likelihood.max())
    return float(share @ variances / share.sum())


def square_shares(samples: tuple[Floats, ...], arm: Integers, settings: Settings, threads: int) -> Floats:
    """Return at each vertex the sum over the arms of the square of an arm's share in the radius, (n,)."""
    wall = _core.Wall(vars(settings) | {"direct": False}, threads, "automatic")
    wall.append(*samples)
    shares = wall.interpolate_samples([(arm == each).astype(np.float64) for each in range(arm.max() + 1)], threads)
    total: Floats = np.sum(np.square(shares), axis=0)
    return total

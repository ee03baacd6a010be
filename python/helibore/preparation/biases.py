"""What each arm of each pass reads too much, found where several of them saw the same cell of the wall.

    radius = wall(cell) + by_pass[pass] + by_arm[arm] + noise

The walls of the cells, a level and a slope each, are eliminated, which leaves one linear system as small as the number
of biases. Only differences can be found: the mean bias is 0. Not here: gain errors, and a bias that changes within a
pass.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats, Integers, finite_column, require, whole_column
from helibore.base.errors import InputError

__all__ = ["Bias", "arm_sides", "find_bias"]

_STEEPNESS = 0.001  # m: how much a wall may well change from the middle of a cell to its edge


@dataclass(frozen=True)
class Bias:
    """How much each pass and each arm reads too much; of a sample, the sum of the two.

    Attributes
    ----------
    passes, arms
        Their numbers, (p,) and (a,) int64, sorted.
    by_pass, by_arm
        Their biases, (p,) and (a,) m; the mean of each over the shared samples is 0.
    shared
        Samples of each pass and arm that lie in cells another one saw too, (p, a) int64: what the biases rest on.
    noise
        Robust deviation of a sample from its cell after correction, m.
    """

    passes: Integers
    arms: Integers
    by_pass: Floats
    by_arm: Floats
    shared: Integers
    noise: float

    def at(self, pass_number: npt.ArrayLike, arm: npt.ArrayLike | None = None) -> Floats:
        """Bias of each sample, (n,) m, new: subtract it from the radius. InputError at an unknown pass or arm."""
        number = whole_column("pass_number", pass_number)
        arms = np.zeros(number.size, dtype=np.int64) if arm is None else whole_column("arm", arm)
        pass_row = rows_of("pass_number", number, self.passes)
        return self.by_pass[pass_row] + self.by_arm[rows_of("arm", arms, self.arms)]


def find_bias(
    depth: npt.ArrayLike,
    toolface: npt.ArrayLike,
    radius: npt.ArrayLike,
    pass_number: npt.ArrayLike,
    arm: npt.ArrayLike | None = None,
    *,
    cell: float = 0.5,
    sectors: int = 24,
    floor: float = 0.0002,
    expected: float = 0.002,
) -> Bias:
    """Find the bias of each pass and arm from the cells of the wall that more than one of them saw.

    Samples are r = wall(cell) + by_pass + by_arm + noise; the walls of the cells are eliminated, the biases solved for
    with Huber's weights (1.345 deviations, found by the median) in ten rounds.

    Parameters
    ----------
    depth, toolface, radius, pass_number
        Metres, degrees, metres, whole numbers: (n,), finite. Depths with their shifts applied.
    arm
        Whole numbers; None: one arm. Any classes will do, such as those of :func:`arm_sides`.
    cell, sectors
        Height of a cell in m and cells around the hole.
    floor
        Least deviation, m. Quantised radii mostly agree exactly, and their median deviation is 0: about half a step.
    expected
        Expected deviation of biases, m: a weak pull to 0 that decides what overlap does not.

    Notes
    -----
    Huber, Ann. Math. Statist. 35 (1964) 73.
    """
    where = finite_column("depth", depth)
    distance = finite_column("radius", radius, where.size, "depth")
    number = whole_column("pass_number", pass_number, where.size, "depth")
    angle = finite_column("toolface", toolface, where.size, "depth")
    arms = np.zeros(where.size, dtype=np.int64) if arm is None else whole_column("arm", arm, where.size, "depth")
    if not (cell > 0 and sectors >= 1 and floor > 0 and expected > 0):
        place = f"cell = {cell:g}, sectors = {sectors}, floor = {floor:g}, expected = {expected:g}"
        raise InputError(place, "all must be larger than 0")
    passes, arm_numbers = np.unique(number), np.unique(arms)
    group = np.searchsorted(passes, number) * arm_numbers.size + np.searchsorted(arm_numbers, arms)
    groups = passes.size * arm_numbers.size
    sector = (angle % 360.0) / 360.0 * sectors
    around = np.floor(sector) % sectors
    aside = 2.0 * (sector - np.floor(sector)) - 1.0
    cells, spot = np.unique(np.floor(where / cell) * sectors + around, return_inverse=True)
    pairs, pair = np.unique(spot * groups + group, return_inverse=True)
    alone = np.bincount(pairs // groups, minlength=cells.size) < 2
    shared = np.bincount(group, weights=~alone[spot], minlength=groups).astype(np.int64)
    design = np.zeros((groups, passes.size + arm_numbers.size))
    every = np.arange(groups)
    design[every, every // arm_numbers.size] = 1.0
    design[every, passes.size + every % arm_numbers.size] = 1.0
    biases: Floats = np.zeros(design.shape[1])
    weight: Floats = np.ones(distance.size)
    deviation = floor
    for _ in range(10):
        walls = _Walls(spot, aside, weight, cells.size, (deviation / _STEEPNESS) ** 2)
        matrix, side = walls.eliminated(distance, pair, pairs, groups)
        ridge = (deviation / expected) ** 2 * np.eye(design.shape[1])
        biases = np.linalg.solve(design.T @ matrix @ design + ridge, design.T @ side).astype(np.float64, copy=False)
        corrected = distance - (design @ biases)[group]
        residual = np.abs(corrected - walls.fitted(corrected))
        used = residual[~alone[spot]]
        deviation = max(floor, 1.4826 * float(np.median(used))) if used.size else floor
        weight = np.minimum(1.0, 1.345 * deviation / np.maximum(residual, 1e-12))
    table = shared.reshape(passes.size, arm_numbers.size)
    by_pass = _centred(biases[: passes.size], table.sum(axis=1))
    by_arm = _centred(biases[passes.size :], table.sum(axis=0))
    return Bias(passes, arm_numbers, by_pass, by_arm, table, deviation)


def arm_sides(arm: npt.ArrayLike, toolface: npt.ArrayLike, sides: int = 8) -> Integers:
    """Classes of arms by the side of the hole they lie on, for arms that sag in an inclined hole.

    The weight of the tool bends and closes its arms, each by its direction: the two ends of a diameter read differently
    when they change places. Passes that lie rotated in the hole tell that from the hole's own shape.

    Parameters
    ----------
    arm
        Whole numbers, not negative, (n,).
    toolface
        Of the tool's reference, degrees from the high side, (n,), finite.
    sides
        Classes of each arm; the first is centred on 0.

    Returns
    -------
    ndarray
        arm * sides + side, (n,) int64, for :func:`find_bias`.
    """
    if sides < 1:
        raise InputError("sides", "must be at least 1", str(sides))
    looking = finite_column("toolface", toolface)
    number = whole_column("arm", arm, looking.size, "toolface")
    return number * sides + np.floor((looking / 360.0 * sides + 0.5) % sides).astype(np.int64) % sides


class _Walls:
    """The wall of every cell, level + slope * aside, aside from -1 to 1 across it, by weighted least squares.

    The slope has a weak pull to 0. Without it, passes that look at other edges of a cell would take the slope for bias.
    """

    def __init__(self, spot: Integers, aside: Floats, weight: Floats, cells: int, ridge: float) -> None:
        self.spot, self.aside, self.weight, self.cells = spot, aside, weight, cells
        self.sum_1, self.sum_t = self._sum(np.ones(spot.size)), self._sum(aside)
        self.sum_tt = self._sum(aside**2) + ridge
        self.determinant = self.sum_1 * self.sum_tt - self.sum_t**2

    def _sum(self, values: Floats) -> Floats:
        return np.bincount(self.spot, weights=self.weight * values, minlength=self.cells).astype(np.float64, copy=False)

    def fitted(self, radius: Floats) -> Floats:
        """The wall at every sample."""
        r, rt = self._sum(radius), self._sum(radius * self.aside)
        level = (self.sum_tt * r - self.sum_t * rt) / self.determinant
        slope = (self.sum_1 * rt - self.sum_t * r) / self.determinant
        fit: Floats = level[self.spot] + slope[self.spot] * self.aside
        return fit

    def eliminated(self, radius: Floats, pair: Integers, pairs: Integers, groups: int) -> tuple[Floats, Floats]:
        """Normal equations of the groups alone: matrix = sum over cells of diag(a) - (a b) S^-1 (a b)'.

        a and b are the sums of w and w t of each group in the cell, S those of the cell as a 2 x 2 matrix. ``pairs``
        are the cells and groups that have samples, cell * groups + group, sorted.
        """
        a = np.bincount(pair, weights=self.weight, minlength=pairs.size)
        b = np.bincount(pair, weights=self.weight * self.aside, minlength=pairs.size)
        spot, group = pairs // groups, pairs % groups
        rest = np.bincount(pair, weights=self.weight * (radius - self.fitted(radius)), minlength=pairs.size)
        side: Floats = np.bincount(group, weights=rest, minlength=groups).astype(np.float64, copy=False)
        matrix: Floats = np.diag(np.bincount(group, weights=a, minlength=groups))
        for first in range(0, self.cells, 1024):
            begin, end = np.searchsorted(spot, [first, first + 1024])
            rows = slice(first, min(first + 1024, self.cells))
            table = np.zeros((2, rows.stop - first, groups))
            table[:, spot[begin:end] - first, group[begin:end]] = a[begin:end], b[begin:end]
            over = 1.0 / self.determinant[rows, None]
            for i, j, share in ((0, 0, self.sum_tt), (0, 1, -self.sum_t), (1, 0, -self.sum_t), (1, 1, self.sum_1)):
                matrix -= (table[i] * (share[rows, None] * over)).T @ table[j]
        return matrix, side


def rows_of(name: str, numbers: Integers, known: Integers) -> Integers:
    """Row of each number among the known ones, which are sorted."""
    row = np.minimum(np.searchsorted(known, numbers), max(known.size - 1, 0))
    there = known[row] == numbers if known.size else np.zeros(numbers.size, dtype=bool)
    require(name, numbers, there, f"is not among {known.tolist()}")
    return row


def _centred(bias: Floats, shared: Integers) -> Floats:
    """Less their mean over the shared samples; 0 where nothing is shared."""
    if not shared.any():
        return np.zeros(bias.size)
    return np.where(shared > 0, bias - np.average(bias, weights=shared), 0.0)

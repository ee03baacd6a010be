"""What each arm of each pass reads too much, found where several of them saw the same cell of the wall.

    radius = wall(cell) + by_pass[pass] + by_arm[arm] + by_both[pass, arm] + noise

The walls of the cells, a level and a slope each, are eliminated, which leaves one linear system as small as the number
of biases. ``by_both`` is what an arm does in one pass alone: an arm that drifts from pass to pass, while another stays,
is no shape of the hole. All three are pulled to 0 as far as overlap does not decide (shrinkage).

Only differences can be found. Zero is the mean of all, unless some arms drift while others are steady: then it is the
mean of the steady ones. Arms that never saw one part of the wall, as in passes that all lie at one bearing, cannot be
told from the hole's shape: they form groups of their own (``Bias.part``), and ``by_arm`` is NaN. Not here: gain errors,
and a bias that changes within a pass.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats, Integers, finite_column, require, whole_column
from helibore.base.errors import InputError

__all__ = ["Bias", "arm_sides", "find_bias"]

_STEEPNESS = 0.001  # m: how much a wall may well change from the middle of a cell to its edge
_OVERLAP = 0.02  # of its cells that a pass and arm must share with another one to be compared with it
_ENOUGH = 30  # shared samples of a pass and arm that say something of their disagreement
_CELLS_SHARED = 5  # and the least number of them
_PAIRS_AT_ONCE = 1 << 16
_STEADY = 0.33  # of the drift of another arm: an arm that drifts less is steady beside it


@dataclass(frozen=True)
class Bias:
    """How much each pass and each arm reads too much; of a sample, the sum of the three.

    Attributes
    ----------
    passes, arms
        Their numbers, (p,) and (a,) int64, sorted.
    by_pass, by_arm
        Their biases, (p,) and (a,) m; NaN for arms that cannot be told from the hole's shape.
    by_both
        What each arm of each pass reads too much beside these, (p, a) m.
    table
        Their sums, (p, a) m; NaN where an arm of a pass shares no cell with another.
    shared
        Samples of each pass and arm that lie in cells another one saw too, (p, a) int64: what the biases rest on.
    part
        Passes and arms of one number saw cells of each other, directly or by others, (p, a) int64; -1: shared nothing.
    noise
        Robust deviation of a sample from its cell after correction, m.
    """

    passes: Integers
    arms: Integers
    by_pass: Floats
    by_arm: Floats
    by_both: Floats
    table: Floats
    shared: Integers
    part: Integers
    noise: float

    def at(self, pass_number: npt.ArrayLike, arm: npt.ArrayLike | None = None) -> Floats:
        """Bias of each sample, (n,) m, new: subtract it from the radius. InputError at an unknown pass or arm."""
        number = whole_column("pass_number", pass_number)
        arms = np.zeros(number.size, dtype=np.int64) if arm is None else whole_column("arm", arm)
        rows = rows_of("pass_number", number, self.passes), rows_of("arm", arms, self.arms)
        apart = np.nan_to_num(self.by_pass)[rows[0]] + np.nan_to_num(self.by_arm)[rows[1]]
        table = self.table[rows]
        return np.where(np.isnan(table), apart, table)

    @property
    def drift(self) -> Floats:
        """How far each arm goes from its least to its largest bias over the passes, (a,) m; NaN with fewer than two."""
        known = np.where(self.shared > 0, self.table, np.nan)
        enough = np.isfinite(known).sum(axis=0) > 1
        drift = np.full(self.arms.size, np.nan)
        drift[enough] = np.nanmax(known[:, enough], axis=0) - np.nanmin(known[:, enough], axis=0)
        return drift

    def lines(self, names: Sequence[str]) -> list[str]:
        """Return one sentence a pass, with the arms by ``names``, and what disagrees or cannot be told."""
        lines = []
        for row, number in enumerate(self.passes):
            arms = [
                f"{name} {1e3 * value:+.2f}"
                for name, value, samples in zip(names, self.table[row], self.shared[row], strict=True)
                if samples
            ]
            count = int(self.shared[row].sum())
            lines.append(f"pass {number}, mm: {', '.join(arms) or 'no overlap'} ({count:,} samples in shared cells)")
        return [*lines, *self.warnings(names)]

    def disagreements(self, names: Sequence[str]) -> list[str]:
        """Return a sentence for arms that drift, and for passes and arms that disagree by more than their noise."""
        lines, known = [], np.where(self.shared >= _ENOUGH, self.table, np.nan)
        drift = np.nan_to_num(self.drift)
        drifting = drift > np.maximum(3.0 * self.noise, drift.min(initial=0.0) / _STEADY)
        for arm in np.flatnonzero(drifting).tolist() if not drifting.all() else ():  # all alike: that is the passes
            others = [f"{names[i]} by {1e3 * drift[i]:.2f}" for i in np.flatnonzero(~drifting).tolist()]
            least, most = int(np.nanargmin(known[:, arm])), int(np.nanargmax(known[:, arm]))
            beside = f", {' and '.join(others)}" if others else ""
            ends = [f"{1e3 * known[row, arm]:+.2f} in pass {self.passes[row]}" for row in (least, most)]
            span = f"{names[arm]} drifts by {1e3 * drift[arm]:.2f} mm over the passes"
            lines.append(f"{span}, from {ends[0]} to {ends[1]}{beside}")
        if np.isfinite(known).any():
            low, high = (divmod(int(found(known)), self.arms.size) for found in (np.nanargmin, np.nanargmax))
            if known[high] - known[low] > self.noise:
                ends = [
                    f"{names[at[1]]} of pass {self.passes[at[0]]} reads {1e3 * known[at]:+.2f} mm" for at in (high, low)
                ]
                lines.append(f"passes or arms disagree by more than their noise ({1e3 * self.noise:.2f} mm): "
                             f"{', '.join(ends)}")  # fmt: skip
        return lines

    def warnings(self, names: Sequence[str]) -> list[str]:
        """Return the disagreements, and a sentence for what cannot be told."""
        lines = self.disagreements(names)
        unknown = [names[arm] for arm in np.flatnonzero(np.isnan(self.by_arm)).tolist()]
        if unknown:
            few = unknown if len(unknown) <= 6 else [*unknown[:5], f"{len(unknown) - 5} more"]
            lines.append(
                f"the biases of {' and '.join(few)} cannot be told from the hole's shape: they never saw one part "
                "of the wall (passes at one bearing)"
            )
        return lines


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
    both: bool = True,
    rounds: int = 10,
) -> Bias:
    """Find the bias of each pass and arm from the cells of the wall that more than one of them saw.

    The walls of the cells are eliminated, the biases solved for with Huber's weights (1.345 deviations, found by the
    median) in some rounds.

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
    both
        Whether an arm may read differently in each pass; else ``by_both`` is 0.
    rounds
        Of weights and biases in turn.

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
    shape = passes.size, arm_numbers.size
    group = np.searchsorted(passes, number) * shape[1] + np.searchsorted(arm_numbers, arms)
    groups = shape[0] * shape[1]
    sector = (angle % 360.0) / 360.0 * sectors
    around = np.floor(sector) % sectors
    aside = 2.0 * (sector - np.floor(sector)) - 1.0
    cells, spot = np.unique(np.floor(where / cell) * sectors + around, return_inverse=True)
    pairs, pair = np.unique(spot * groups + group, return_inverse=True)
    alone = np.bincount(pairs // groups, minlength=cells.size) < 2
    shared = np.bincount(group, weights=~alone[spot], minlength=groups).astype(np.int64).reshape(shape)
    every = np.arange(groups)
    design = np.zeros((groups, shape[0] + shape[1] + (groups if both and min(shape) > 1 else 0)))
    design[every, every // shape[1]] = 1.0
    design[every, shape[0] + every % shape[1]] = 1.0
    if design.shape[1] > sum(shape):
        design[every, sum(shape) + every] = 1.0
    biases: Floats = np.zeros(design.shape[1])
    weight: Floats = np.ones(distance.size)
    deviation = floor
    for _ in range(rounds):
        walls = _Walls(spot, aside, weight, cells.size, (deviation / _STEEPNESS) ** 2)
        matrix, side = walls.eliminated(distance, pair, pairs, groups)
        ridge = (deviation / expected) ** 2 * np.eye(design.shape[1])
        biases = np.linalg.solve(design.T @ matrix @ design + ridge, design.T @ side).astype(np.float64, copy=False)
        corrected = distance - (design @ biases)[group]
        residual = np.abs(corrected - walls.fitted(corrected))
        used = residual[~alone[spot]]
        deviation = max(floor, 1.4826 * float(np.median(used))) if used.size else floor
        weight = np.minimum(1.0, 1.345 * deviation / np.maximum(residual, 1e-12))
    part = _parts(pairs, groups).reshape(shape)
    part[shared == 0] = -1
    return _referred((design @ biases).reshape(shape), passes, arm_numbers, shared, part, deviation)


def _parts(pairs: Integers, groups: int) -> Integers:
    """Number of the part that each group belongs to; groups that share enough cells belong to one part."""
    cell, group = pairs // groups, pairs % groups
    together = np.zeros((groups, groups))
    for first in range(0, int(cell.max(initial=-1)) + 1, 4096):
        begin, end = np.searchsorted(cell, [first, first + 4096])
        seen = np.zeros((4096, groups))
        seen[cell[begin:end] - first, group[begin:end]] = 1.0
        together += seen.T @ seen
    least = np.minimum(together.diagonal()[:, None], together.diagonal())
    joined = together >= np.maximum(_CELLS_SHARED, _OVERLAP * least)
    part = np.arange(groups)
    for _ in range(groups):
        lowest = np.where(joined | np.eye(groups, dtype=bool), part, groups).min(axis=1, initial=groups)
        if (lowest == part).all():
            break
        part = lowest
    return part


def _referred(total: Floats, passes: Integers, arms: Integers, shared: Integers, part: Integers, noise: float) -> Bias:
    """Place the zero of every part, and split the sums into passes, arms and both."""
    table = np.where(shared > 0, total, 0.0)
    squares, weight = np.zeros((2, arms.size))
    for each in np.unique(part[part >= 0]):
        mine = np.where(part == each, shared, 0)
        mean = (mine * table).sum(axis=0) / np.maximum(mine.sum(axis=0), 1)
        several = np.count_nonzero(mine, axis=0) > 1
        squares += several * (mine * np.square(table - mean)).sum(axis=0)
        weight += several * mine.sum(axis=0)
    drift = np.sqrt(np.where(weight > 0, squares / np.maximum(weight, 1), np.nan))
    most = np.nan_to_num(drift).max(initial=0.0)
    steady = np.where(drift < _STEADY * most, True, False) if most > noise else np.zeros(arms.size, dtype=bool)
    for each in np.unique(part[part >= 0]):
        mine = part == each
        zero = mine & steady if (mine & steady).any() else mine
        table[mine] -= np.average(table[zero], weights=shared[zero])
    weights = np.maximum(shared, 1e-9)
    by_arm = np.average(table, axis=0, weights=weights) if table.size else np.zeros(arms.size)
    by_pass = np.average(table - by_arm, axis=1, weights=weights) if table.size else np.zeros(passes.size)
    by_both = np.where(shared > 0, table - by_arm - by_pass[:, None], 0.0)

    if arms.size > 1:  # an arm that shares no part with another cannot be compared with it
        own = [set(part[part[:, a] >= 0, a].tolist()) for a in range(arms.size)]
        others: list[set[int]] = [set().union(*(own[b] for b in range(arms.size) if b != a)) for a in range(arms.size)]
        known = [bool(mine & rest) for mine, rest in zip(own, others, strict=True)]
        by_arm = np.where(known, by_arm, np.nan)
    return Bias(
        passes, arms, by_pass, by_arm, by_both, np.where(shared > 0, table, np.nan), shared, part, noise
    )  # fmt: skip


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
        _, first, count = np.unique(spot, return_index=True, return_counts=True)
        begin = np.repeat(first, count)  # of each pair's cell
        size = np.repeat(count, count)
        for start in range(0, pairs.size, _PAIRS_AT_ONCE):
            some = np.arange(start, min(start + _PAIRS_AT_ONCE, pairs.size))
            one = np.repeat(some, size[some])
            step = np.arange(one.size) - np.repeat(np.cumsum(size[some]) - size[some], size[some])
            two, at = begin[one] + step, spot[one]
            share = a[one] * (self.sum_tt[at] * a[two] - self.sum_t[at] * b[two])
            share += b[one] * (self.sum_1[at] * b[two] - self.sum_t[at] * a[two])
            place = group[one] * groups + group[two]
            share /= self.determinant[at]
            matrix -= np.bincount(place, weights=share, minlength=groups**2).reshape(groups, groups)
        return matrix, side


def rows_of(name: str, numbers: Integers, known: Integers) -> Integers:
    """Row of each number among the known ones, which are sorted."""
    row = np.minimum(np.searchsorted(known, numbers), max(known.size - 1, 0))
    there = known[row] == numbers if known.size else np.zeros(numbers.size, dtype=bool)
    require(name, numbers, there, f"is not among {known.tolist()}")
    return row

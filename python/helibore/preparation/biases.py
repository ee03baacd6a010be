"""Find the bias of each arm in each pass: the amount by which the arm's radii are too large.

    radius = level(depth) + shape(sector) + wall(cell) + by_pass[pass] + by_arm[arm] + by_both[pass, arm] + noise

A cell is half a metre of depth in one sector of the hole. Two arms that measure in one cell are compared directly. Arms
in different sectors are compared by the level at their depth and by the shape that the hole keeps along the log. How
far cells depart from level and shape is estimated together with the biases. If the tool rotates, biases of its arms can
be separated from the shape of the hole; if it keeps one toolface, they cannot.

``by_both`` is the bias of an arm in one pass only: if an arm drifts from pass to pass while another does not, the shape
of the hole cannot be the cause. Biases that the samples do not determine are pulled to 0 (shrinkage). The covariance of
biases is the posterior covariance plus that of the scores of intervals of 10 m (the sandwich estimate for clustered
samples), since walls are correlated along the hole.

Only differences can be found. Zero is the mean of all arms; if some arms drift while others are steady, zero is the
mean of the steady arms. A bias that is not known well enough, for example because its deviation exceeds both 0.127 mm
and a third of the bias, is not subtracted (`Bias.table`). Gain errors, and biases that change within a pass, are not
supported.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats, Integers, Mask, distinct, finite_column, require, whole_column
from helibore.base.errors import InputError

__all__ = ["Bias", "arm_sides", "find_bias"]

_STEEPNESS = 0.001  # m: expected change of a wall from the middle of a cell to its edge
_SHAPE = 0.01  # m: expected departure of a sector from the mean radius along the whole log
_KNOWN = 0.000127  # m, 0.01 in of diameter: a bias is subtracted if its deviation is at most this,
_CERTAIN = 1.0 / 3.0  # or at most this share of the bias
_DOUBT = 0.001  # m: an arm whose unknown bias may be larger than this is left out
_STRETCH = 10.0  # m: walls are correlated along the hole over this length
_PAIRS_AT_ONCE = 1 << 16
_STEADY = 0.33  # an arm is steady if it drifts by less than this share of another arm's drift


@dataclass(frozen=True)
class Bias:
    """The biases of p passes and a arms, metres: positive if the readings are too large.

    Where ``table`` is not NaN, it is the sum of ``by_pass``, ``by_arm`` and ``by_both``, in which NaN counts as 0.
    """

    passes: Integers  # numbers of the passes, (p,), sorted
    arms: Integers  # numbers of the arms, (a,), sorted
    by_pass: Floats  # (p,); NaN for passes of which no bias is known
    by_arm: Floats  # (a,); NaN for arms that cannot be separated from the hole's shape
    by_both: Floats  # the remaining bias of each arm in each pass, (p, a)
    estimate: Floats  # best estimate of the whole bias of each arm in each pass, (p, a)
    sigma: Floats  # standard deviation of the estimate, (p, a)
    # What is subtracted, (p, a): the estimate; NaN where its deviation exceeds both 0.127 mm and a third of it, for an
    # arm that drifts and cannot be compared with a steady arm, and where less than half of an arm's samples can be
    # compared.
    table: Floats
    samples: Integers  # number of samples of each pass and arm, (p, a)
    part: Integers  # entries (a pass and an arm) with equal numbers can be compared, and share one zero, (p, a)
    drift: Floats  # largest less least bias of an arm over the passes that can be compared, (a,); NaN if fewer than two
    drift_sigma: Floats  # standard deviation of ``drift``, (a,)
    drift_ends: Integers  # indices in ``passes`` of the passes with the least and the largest bias of an arm, (a, 2)
    noise: float  # metres: robust deviation of a sample from its cell after correction

    def at(self, pass_number: npt.ArrayLike, arm: npt.ArrayLike | None = None) -> Floats:
        """Return the bias of each sample, (n,) metres, new, to subtract from the radius; 0 if the bias is not known.

        Raises
        ------
        InputError
            For an unknown pass or arm.
        """
        number = whole_column("pass_number", pass_number)
        arms = (
            np.zeros(number.size, dtype=np.int64)
            if arm is None
            else whole_column("arm", arm, number.size, "pass_number")
        )
        rows = rows_of("pass_number", number, self.passes), rows_of("arm", arms, self.arms)
        return np.nan_to_num(self.table)[rows]

    def doubtful(self) -> Mask:
        """Return which arms in which passes may be off by over 1 mm (two deviations) and cannot be corrected, (p, a).

        No arm counts as doubtful if arms with a known bias have less than half of the samples: too few to compare with.
        """
        known = np.isfinite(self.table) & (self.samples > 0)
        wrong = ~known & (self.samples > 0) & (np.fmax(np.abs(self.estimate), 2.0 * self.sigma) > _DOUBT)
        if 2 * int(self.samples[known].sum()) < int(self.samples.sum()):
            return np.zeros_like(wrong)
        return wrong

    def lines(self, names: Sequence[str]) -> list[str]:
        """Return a sentence on the biases in each pass, then the `warnings`; ``names`` are the names of the arms."""
        lines = []
        for row, number in enumerate(self.passes):
            arms = [
                f"{name} {1e3 * value:+.2f} ± {1e3 * sigma:.2f}" if np.isfinite(value) else f"{name} not known"
                for name, value, sigma, samples in zip(
                    names, self.table[row], self.sigma[row], self.samples[row], strict=True
                )
                if samples
            ]
            lines.append(f"pass {number}, mm: {', '.join(arms)}")
        return [*lines, *self.warnings(names)]

    def disagreements(self, names: Sequence[str]) -> list[str]:
        """Return a sentence for each arm that drifts, and for passes or arms that disagree by more than noise."""
        lines: list[str] = []
        drift = self.drift
        known = np.isfinite(drift)
        steadiest = drift[known].min(initial=np.inf)  # if all arms drift alike, passes differ, not arms
        drifting = drift > np.maximum(3.0 * np.fmax(self.noise, self.drift_sigma), steadiest / _STEADY)
        others = [f"{names[i]} by {1e3 * drift[i]:.2f}" for i in np.flatnonzero(known & ~drifting).tolist()]
        beside = f", {_few(others)}" if others else ""
        for arm in np.flatnonzero(drifting).tolist():
            ends = [f"{1e3 * self.estimate[row, arm]:+.2f} in pass {self.passes[row]}" for row in self.drift_ends[arm]]
            span = f"{names[arm]} drifts by {1e3 * drift[arm]:.2f} mm over the passes"
            lines.append(f"{span}, from {ends[0]} to {ends[1]}{'' if lines else beside}")
        seen = np.isfinite(self.table) & (self.samples > 0)
        if seen.any():
            largest = np.argmax(np.bincount(self.part[seen], self.samples[seen]))
            known = np.where(seen & (self.part == largest), self.table, np.nan)
            low, high = (divmod(int(found(known)), self.arms.size) for found in (np.nanargmin, np.nanargmax))
            if known[high] - known[low] > max(self.noise, 3.0 * np.hypot(self.sigma[high], self.sigma[low])):
                ends = [
                    f"{names[at[1]]} of pass {self.passes[at[0]]} reads {1e3 * known[at]:+.2f} mm" for at in (high, low)
                ]
                lines.append(f"passes or arms disagree by more than their noise ({1e3 * self.noise:.2f} mm): "
                             f"{', '.join(ends)}")  # fmt: skip
        return lines

    def warnings(self, names: Sequence[str]) -> list[str]:
        """Return the disagreements, and sentences on the biases that are not known."""
        lines = self.disagreements(names)
        unknown = [names[arm] for arm in np.flatnonzero(np.isnan(self.by_arm)).tolist()]
        if unknown:
            lines.append(
                f"the bias of {_few(unknown)} cannot be separated from the hole's shape: the arms never see the same "
                "part of the wall, or the shape turns with the tool"
            )
        left = [
            f"{names[arm]} of pass {self.passes[row]}"
            for row, arm in np.argwhere(np.isnan(self.table) & (self.samples > 0)).tolist()
        ]
        if left:
            lines.append(
                f"the bias of {_few(left)} is not known: its deviation exceeds {1e3 * _KNOWN:g} mm and a third of it, "
                "or too few samples can be compared with a steady arm; not corrected"
            )
        return lines


def _few(names: list[str]) -> str:
    """Return the names as text; if there are more than six, the first five and how many more."""
    few = names if len(names) <= 6 else [*names[:5], f"{len(names) - 5} more"]
    return " and ".join([", ".join(few[:-1]), few[-1]] if len(few) > 1 else few)


def find_bias(
    depth: npt.ArrayLike,
    toolface: npt.ArrayLike,
    radius: npt.ArrayLike,
    pass_number: npt.ArrayLike,
    arm: npt.ArrayLike | None = None,
    *,
    sides: int = 1,
    cell: float = 0.5,
    sectors: int = 24,
    floor: float = 0.0002,
    expected: float = 0.002,
    rounds: int = 10,
) -> Bias:
    """Find the bias of each arm in each pass by comparing the radii that passes and arms measured on one wall.

    One least-squares solution gives the levels, a further level and a slope for each cell, and the biases. Samples have
    Huber's weights (1.345 deviations, estimated by the median), which each round computes anew.

    Parameters
    ----------
    depth, toolface, radius, pass_number
        Metres, degrees, metres, whole numbers: (n,), finite. Depths include the shifts of their passes.
    arm
        Whole numbers: the arm of each sample, or its class as :func:`arm_sides` returns it; None: one arm.
    sides
        Number of sides of the hole into which :func:`arm_sides` divided the arms, whose numbers then are arm * sides +
        side; 1: not divided.
    cell, sectors
        Height of a cell in metres, and number of cells around the hole.
    floor
        Least deviation of samples, metres. Quantised radii mostly agree exactly, so that their median deviation is 0;
        for these, give about half a step.
    expected
        Expected deviation of biases, metres: a weak pull to 0, which matters only where the samples do not determine a
        bias.
    rounds
        Number of rounds; each computes weights, then biases.

    Notes
    -----
    Huber, Ann. Math. Statist. 35 (1964) 73; Liang and Zeger, Biometrika 73 (1986) 13 (clustered samples).
    """
    where = finite_column("depth", depth)
    distance = finite_column("radius", radius, where.size, "depth")
    number = whole_column("pass_number", pass_number, where.size, "depth")
    angle = finite_column("toolface", toolface, where.size, "depth")
    arms = np.zeros(where.size, dtype=np.int64) if arm is None else whole_column("arm", arm, where.size, "depth")
    if not (cell > 0 and sectors >= 1 and floor > 0 and expected > 0 and sides >= 1 and rounds >= 1):
        place = f"cell = {cell:g}, sectors = {sectors}, floor = {floor:g}, expected = {expected:g}, sides = {sides}"
        place += f", rounds = {rounds}"
        raise InputError(place, "all must be above 0")
    passes, arm_numbers = distinct(number), distinct(arms)
    shape = passes.size, arm_numbers.size
    group = np.searchsorted(passes, number) * shape[1] + np.searchsorted(arm_numbers, arms)
    row, of = np.divmod(np.arange(shape[0] * shape[1]), shape[1])
    tool = (arm_numbers // sides)[of]
    design = np.hstack([_indicators(row), _indicators(of), _indicators(row * (tool.max(initial=0) + 1) + tool)])
    prior = np.concatenate([np.full(design.shape[1], expected), np.full(sectors, _SHAPE)])
    terms = np.zeros((len(design) + sectors, prior.size))
    terms[: len(design), : design.shape[1]] = design
    terms[len(design) :, design.shape[1] :] = np.eye(sectors)
    walls = _Walls(where, angle, group, len(design), cell, sectors)
    weight: Floats = np.ones(distance.size)
    deviation, rough = floor, expected
    for _ in range(rounds):
        walls.weigh(weight, deviation, rough)
        matrix, side = walls.eliminated(distance)
        precision = terms.T @ matrix @ terms + np.diag(np.square(deviation / prior))
        found = terms @ np.linalg.solve(precision, terms.T @ side)
        residual, rough = walls.residual(distance, found)
        rough = max(rough, 0.3 * deviation)
        used = np.abs(residual[walls.compared])
        deviation = max(floor, 1.4826 * float(np.median(used))) if used.size else floor
        scores = walls.scores(residual, np.unique(np.floor(where / _STRETCH), return_inverse=True)[1]) @ terms
        weight = np.minimum(1.0, 1.345 * deviation / np.maximum(np.abs(residual), 1e-12))
    inverse = np.linalg.inv(precision)
    spread = inverse @ (scores.T @ scores) @ inverse + deviation**2 * inverse
    covariance = terms[: len(design)] @ spread @ terms[: len(design)].T
    samples = np.bincount(group, minlength=len(design)).reshape(shape)
    return _referred(found[: len(design)], covariance, passes, arm_numbers, samples, deviation)


def _indicators(of: Integers) -> Floats:
    """Return a column for each distinct number, with 1 in the rows that have this number, 0 in the other rows."""
    columns: Floats = (of[:, None] == distinct(of)).astype(np.float64)
    return columns


def _parts(joined: Mask) -> Integers:
    """Return the number of each group's part; groups that are joined, directly or through others, are one part."""
    size = len(joined)
    part = np.arange(size)
    for _ in range(size):
        lowest = np.where(joined | np.eye(size, dtype=bool), part, size).min(axis=1, initial=size)
        if (lowest == part).all():
            break
        part = lowest
    return part


def _referred(
    found: Floats, covariance: Floats, passes: Integers, arms: Integers, samples: Integers, noise: float
) -> Bias:
    """Return the `Bias`: set the zero of each part (passes and arms that can be compared), and split each bias into
    the terms of its pass, its arm, and both.

    ``found`` is the bias of every arm in every pass, up to a constant, and ``covariance`` is its covariance.
    """
    shape, count = samples.shape, samples.ravel()
    arm, seen, variance = np.tile(np.arange(arms.size), passes.size), count > 0, covariance.diagonal()
    part = _parts(variance[:, None] + variance - 2.0 * covariance <= (2.0 * _KNOWN) ** 2)
    drift, drift_sigma, rms = np.full((3, arms.size), np.nan)
    drift_ends = np.zeros((arms.size, 2), dtype=np.int64)
    for each in range(arms.size):  # within the part that has most of the arm's samples
        mine = (arm == each) & seen
        mine &= part == np.argmax(np.bincount(part[mine], count[mine], 1))
        if np.count_nonzero(mine) > 1:
            low, high = (int(np.argmin(np.where(mine, sign * found, np.inf))) for sign in (1, -1))
            drift[each], drift_ends[each] = found[high] - found[low], (low // arms.size, high // arms.size)
            drift_sigma[each] = np.sqrt(max(variance[high] + variance[low] - 2.0 * covariance[low, high], 0.0))
            rms[each] = np.sqrt(np.cov(found[mine], aweights=count[mine], bias=True))
    most = np.nan_to_num(rms).max(initial=0.0)
    steady = rms < _STEADY * most
    if most <= noise or not steady.any():
        steady[:] = True
    separated = np.full(arms.size, arms.size == 1)
    known = np.zeros(count.size, dtype=bool)
    estimate, sigma = np.zeros((2, count.size))
    sizes = np.bincount(part, seen)
    for each in [-1, *np.flatnonzero(sizes > 1).tolist()] if seen.any() else ():  # -1: all, for groups alone in a part
        mine = (part == each) | (each < 0)
        zero = mine & seen & steady[arm]
        sure = bool(zero.any())
        weights = np.where(zero if sure else mine, count, 0)
        weights = weights / weights.sum()
        estimate[mine] = found[mine] - weights @ found
        own = variance - 2.0 * (covariance @ weights) + weights @ covariance @ weights
        sigma[mine] = np.sqrt(np.maximum(own[mine], 0.0))
        if each >= 0:
            held = np.bincount(arm, np.where(mine, count, 0)) / np.bincount(arm, count)
            sure = sure and held[held > 0].min() >= 0.5  # few passes do not show which arm drifts
            known |= mine & (sigma <= np.maximum(_KNOWN, _CERTAIN * np.abs(estimate))) & sure
            beside = distinct(arm[mine & known & seen])
            separated[beside] |= beside.size > 1
    table, estimate, sigma = (of.reshape(shape) for of in (np.where(known, estimate, np.nan), estimate, sigma))
    weight = np.where(np.isfinite(table), samples + 1e-9, 0.0)
    rest = np.nan_to_num(table)
    by_arm = np.where(separated, (weight * rest).sum(axis=0) / np.maximum(weight.sum(axis=0), 1e-9), np.nan)
    rest = np.where(weight > 0, rest - np.nan_to_num(by_arm), 0.0)
    by_pass = (weight * rest).sum(axis=1) / np.maximum(weight.sum(axis=1), 1e-9)
    by_both = np.where(weight > 0, rest - by_pass[:, None], 0.0)
    by_pass = np.where(weight.any(axis=1), by_pass, np.nan)
    return Bias(
        passes, arms, by_pass, by_arm, by_both, estimate, sigma, table, samples, part.reshape(shape),
        drift, drift_sigma, drift_ends, noise,
    )  # fmt: skip


def arm_sides(arm: npt.ArrayLike, toolface: npt.ArrayLike, sides: int = 8) -> Integers:
    """Return arm * sides + side, (n,), for :func:`find_bias`: the class of an arm on one side of the hole.

    The weight of the tool bends and closes its arms, depending on their direction, so the two ends of a diameter read
    differently when they change places. Passes in which the tool lay rotated separate this from the shape of the hole.
    ``arm`` are whole numbers, ``toolface`` degrees of the tool's reference from the high side, (n,); the first side is
    centred on 0.
    """
    if sides < 1:
        raise InputError("sides", "must be at least 1", str(sides))
    looking = finite_column("toolface", toolface)
    number = whole_column("arm", arm, looking.size, "toolface")
    return number * sides + np.floor((looking / 360.0 * sides + 0.5) % sides).astype(np.int64) % sides


class _Walls:
    """The wall in cells: a level for each row of cells, and in each cell a further level + slope * aside.

    ``aside`` runs from -1 to 1 across the cell.

    Weighted least squares eliminates levels and slopes from the equations of the groups (passes and arms) and sectors.
    The expected roughness pulls the level of a cell to 0, and the expected steepness pulls its slope to 0. Otherwise
    the slope would be taken for bias if passes measure at different edges of a cell.
    """

    def __init__(
        self, depth: Floats, toolface: Floats, group: Integers, groups: int, cell: float, sectors: int
    ) -> None:
        place = (toolface % 360.0) / 360.0 * sectors
        self.sector = np.floor(place).astype(np.int64) % sectors
        self.aside = 2.0 * (place - np.floor(place)) - 1.0
        self.group, self.groups, self.sectors = group, groups, sectors
        self.row = np.unique(np.floor(depth / cell), return_inverse=True)[1]
        cells, self.spot = np.unique(self.row * sectors + self.sector, return_inverse=True)
        self.row_of, self.sector_of = np.divmod(cells, sectors)
        pairs, self.pair = np.unique(self.spot * groups + group, return_inverse=True)
        self.cell_of, self.group_of = np.divmod(pairs, groups)  # of every pair of a cell and a group with samples in it
        self.compared = (np.bincount(self.cell_of, minlength=cells.size) > 1)[self.spot]

    def weigh(self, weight: Floats, deviation: float, rough: float) -> None:
        """Set the weights and ``deviation`` of samples, and how far cells depart from level and shape (``rough``)."""
        self.weight = weight
        self.sum_1, self.sum_t = self._sum(np.ones(weight.size)), self._sum(self.aside)
        self.own_1, self.own_tt = self.sum_1 + (deviation / rough) ** 2, self._sum(self.aside**2)
        self.own_tt += (deviation / _STEEPNESS) ** 2
        self.determinant = self.own_1 * self.own_tt - self.sum_t**2
        self.variance = deviation**2 / self.own_1

    def _sum(self, values: Floats) -> Floats:
        return np.bincount(self.spot, self.weight * values, self.row_of.size).astype(np.float64, copy=False)

    def _fitted(self, radius: Floats) -> tuple[Floats, Floats]:
        """Fit ``radius`` cell by cell; return the level of each cell, and the fitted wall at every sample."""
        r, rt = self._sum(radius), self._sum(radius * self.aside)
        level = (self.own_tt * r - self.sum_t * rt) / self.determinant
        slope = (self.own_1 * rt - self.sum_t * r) / self.determinant
        return level, level[self.spot] + slope[self.spot] * self.aside

    def eliminated(self, radius: Floats) -> tuple[Floats, Floats]:
        """Return matrix and right-hand side of the normal equations of the groups and sectors alone.

        A cell contributes diag(a) - (a b) S^-1 (a b)' to the equations of its groups. Here a and b are the sums of w
        and w * aside of each group in the cell, and S is the 2 x 2 matrix of the sums over the cell. The row and the
        sector of the cell get the sums of this over the groups. Then the level of each row of cells is eliminated.
        """
        groups, sectors, cell, group, rows = (
            self.groups,
            self.sectors,
            self.cell_of,
            self.group_of,
            self.row.max(initial=-1) + 1,
        )
        a: Floats = np.bincount(self.pair, self.weight, cell.size).astype(np.float64, copy=False)
        b: Floats = np.bincount(self.pair, self.weight * self.aside, cell.size).astype(np.float64, copy=False)
        rest = np.bincount(self.pair, self.weight * (radius - self._fitted(radius)[1]), cell.size)
        matrix: Floats = np.zeros((groups + sectors, groups + sectors))
        matrix[:groups, :groups] = np.diag(np.bincount(group, a, groups)) - self._shared(a, b)
        left = a * (self.own_tt * self.sum_1 - self.sum_t**2)[cell] + b * ((self.own_1 - self.sum_1) * self.sum_t)[cell]
        left = a - left / self.determinant[cell]
        cell_left: Floats = np.bincount(cell, left, self.row_of.size).astype(np.float64, copy=False)
        cell_rest = np.bincount(cell, rest, self.row_of.size)
        matrix[:groups, groups:] = _table(group, self.sector_of[cell], left, groups, sectors)
        matrix[groups:, :groups] = matrix[:groups, groups:].T
        matrix[groups:, groups:] = np.diag(np.bincount(self.sector_of, cell_left, sectors))
        side = np.append(np.bincount(group, rest, groups), np.bincount(self.sector_of, cell_rest, sectors))
        self.coupling = np.hstack([_table(self.row_of[cell], group, left, rows, groups),
                                   _table(self.row_of, self.sector_of, cell_left, rows, sectors)])  # fmt: skip
        self.row_left = np.bincount(self.row_of, cell_left) + 1e-9
        self.row_rest = np.bincount(self.row_of, cell_rest)
        shares = self.coupling / self.row_left[:, None]
        return matrix - self.coupling.T @ shares, side - shares.T @ self.row_rest

    def _shared(self, a: Floats, b: Floats) -> Floats:
        """Return the sum over all cells of (a b) S^-1 (a b)', with a, b and S as above; (groups, groups)."""
        total: Floats = np.zeros((self.groups, self.groups))
        _, first, count = np.unique(self.cell_of, return_index=True, return_counts=True)
        begin, size = np.repeat(first, count), np.repeat(count, count)  # first pair, and number of pairs, in its cell
        for start in range(0, size.size, _PAIRS_AT_ONCE):
            some = np.arange(start, min(start + _PAIRS_AT_ONCE, size.size))
            one = np.repeat(some, size[some])
            step = np.arange(one.size) - np.repeat(np.cumsum(size[some]) - size[some], size[some])
            two, at = begin[one] + step, self.cell_of[one]
            share = a[one] * (self.own_tt[at] * a[two] - self.sum_t[at] * b[two])
            share += b[one] * (self.own_1[at] * b[two] - self.sum_t[at] * a[two])
            share /= self.determinant[at]
            total += _table(self.group_of[one], self.group_of[two], share, self.groups, self.groups)
        return total

    def residual(self, radius: Floats, found: Floats) -> tuple[Floats, float]:
        """Return each radius less the fit with ``found``, and the deviation of cells from level and shape, metres."""
        level = (self.row_rest - self.coupling @ found) / self.row_left
        rest = radius - found[self.group] - found[self.groups + self.sector] - level[self.row]
        cells, fitted = self._fitted(rest)
        return rest - fitted, float(np.sqrt((np.square(cells) + self.variance).sum() / max(cells.size, 1)))

    def scores(self, residual: Floats, stretch: Integers) -> Floats:
        """Return the sum of the weighted residuals of each group and sector in each interval ``stretch`` of depth.

        The shape is (stretches, groups + sectors).
        """
        count, force = int(stretch.max(initial=-1)) + 1, self.weight * residual
        return np.hstack([
            _table(stretch, self.group, force, count, self.groups),
            _table(stretch, self.sector, force, count, self.sectors),
        ])  # fmt: skip


def _table(row: Integers, column: Integers, weights: Floats, rows: int, columns: int) -> Floats:
    sums = np.bincount(row * columns + column, weights, rows * columns).reshape(rows, columns)
    return sums.astype(np.float64, copy=False)


def rows_of(name: str, numbers: Integers, known: Integers) -> Integers:
    """Return the index of each number in ``known``, which is sorted; raise InputError at ``name`` if it is missing."""
    row = np.minimum(np.searchsorted(known, numbers), max(known.size - 1, 0))
    there = known[row] == numbers if known.size else np.zeros(numbers.size, dtype=bool)
    require(name, numbers, there, f"is not among {known.tolist()}")
    return row

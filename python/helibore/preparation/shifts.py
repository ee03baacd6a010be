r"""How far each pass is off in depth, found by correlating its median radius along the hole with that of the others.

    radius       _/\__/\_____     pass, moved by the trial shift       correlation(shift) has its peak
    less trend     _/\__/\____    the others                           at the shift to be added to its depths

All arms of a pass count alike, so a pass that lies rotated in the hole still matches. Only differences can be found:
unless one pass is held, the mean of the shifts is 0. Not here: stretching within a pass.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats, Integers, Mask, finite_column, whole_column
from helibore.base.errors import InputError
from helibore.preparation.biases import rows_of

__all__ = ["Shifts", "find_shifts"]

_WIDEST_GAP = 1.0  # m between samples of one pass that a profile bridges
_ROUNDS = 5


@dataclass(frozen=True)
class Shifts:
    """How far each pass is off in depth.

    Attributes
    ----------
    passes
        (p,) int64, sorted.
    shift
        To be added to the depths of each pass, (p,) m; 0 where nothing was found.
    correlation, before
        With the others at the shift found and at none, (p,); NaN where they do not overlap.
    found
        Whether a peak of the least correlation asked for lies inside the limits, (p,).
    """

    passes: Integers
    shift: Floats
    correlation: Floats
    before: Floats
    found: Mask

    def at(self, pass_number: npt.ArrayLike) -> Floats:
        """Shift of each sample, (n,) m, new: add it to the depth. Raises InputError at an unknown pass."""
        return self.shift[rows_of("pass_number", whole_column("pass_number", pass_number), self.passes)]

    def lines(self) -> list[str]:
        """Return one sentence a pass."""
        lines = []
        for row, number in enumerate(self.passes):
            text = "left where it is: no clear match"
            if self.found[row]:
                before, after = self.before[row], self.correlation[row]
                text = f"{self.shift[row]:+.3f} m found, correlation {before:.2f} before, {after:.2f} after"
            lines.append(f"pass {number}: {text}")
        return lines


def find_shifts(
    depth: npt.ArrayLike,
    radius: npt.ArrayLike,
    pass_number: npt.ArrayLike,
    *,
    reference: int | None = None,
    step: float = 0.05,
    limit: float = 2.0,
    trend: float = 10.0,
    least: float = 0.4,
) -> Shifts:
    """Find the depth shift of each pass.

    Parameters
    ----------
    depth, radius, pass_number
        Metres, metres, whole numbers, (n,), finite, in any order.
    reference
        A pass to hold; the others are shifted onto it alone. None: each onto the mean of the others, again and again
        until they rest.
    step, limit
        Spacing of the trial shifts and the largest of them, m; the best is refined by a parabola.
    trend
        Length of the running mean that is taken off first, m. At least so much overlap is asked for.
    least
        Correlation below which a pass is left where it is.

    Raises
    ------
    InputError
        If lengths differ, a value is not finite, a setting breaks its rule or ``reference`` is no pass.
    """
    where = finite_column("depth", depth)
    distance = finite_column("radius", radius, where.size, "depth")
    number = whole_column("pass_number", pass_number, where.size, "depth")
    if not (0 < step <= limit and trend > 2 * step):
        place = f"step = {step:g}, limit = {limit:g}, trend = {trend:g}"
        raise InputError(place, "must be 0 < step <= limit and trend > 2 step")
    passes, row = np.unique(number, return_inverse=True)
    if reference is not None and reference not in passes:
        raise InputError("reference", f"is not among {passes.tolist()}", str(reference))
    count = passes.size
    shift, found = np.zeros(count), np.zeros(count, dtype=bool)
    best, before = np.full(count, np.nan), np.full(count, np.nan)
    if count == 0:
        return Shifts(passes, shift, best, before, found)
    grid = np.arange(int(np.ptp(where) / step) + 2)
    profiles = [
        _profile((where[row == i] - where.min()) / step, distance[row == i], grid, step, trend) for i in range(count)
    ]
    most, enough = round(limit / step), round(trend / step)
    held = passes == reference
    for turn in range(_ROUNDS):
        start = shift.copy()
        placed = np.stack([_moved(p, s / step) for p, s in zip(profiles, shift, strict=True)])
        for i in np.flatnonzero(~held):
            others = placed[held] if reference is not None else np.delete(placed, i, axis=0)
            curve = _correlations(profiles[i], _mean(others), most, enough)
            if turn == 0:
                before[i] = curve[most]
            shift[i], best[i], found[i] = _peak(curve, most, least)
            shift[i] *= step
        if reference is None and found.any():
            shift[found] -= shift[found].mean()
        if reference is not None or np.abs(shift - start).max() < 0.01 * step:
            break
    found[held], best[held], before[held] = True, 1.0, 1.0
    return Shifts(passes, shift, best, before, found)


def _profile(place: Floats, radius: Floats, grid: Integers, step: float, trend: float) -> Floats:
    """Median radius of each grid step less the running mean; NaN beyond the samples and in gaps. ``place`` in steps."""
    row = np.round(place)
    order = np.lexsort((radius, row))
    cells, first, count = np.unique(row[order], return_index=True, return_counts=True)
    at = np.add.reduceat(place[order], first) / count if cells.size else cells
    level = 0.5 * (radius[order[first + (count - 1) // 2]] + radius[order[first + count // 2]])
    profile = np.interp(grid, at, level, left=np.nan, right=np.nan)
    if at.size > 1:
        after = np.clip(np.searchsorted(at, grid), 1, at.size - 1)
        profile[(at[after] - at[after - 1]) * step > _WIDEST_GAP] = np.nan
    known = np.isfinite(profile)
    half = round(0.5 * trend / step)
    first, last = np.maximum(grid - half, 0), np.minimum(grid + half + 1, grid.size)
    sums = np.concatenate([[0.0], np.cumsum(np.where(known, profile, 0.0))])
    counts = np.concatenate([[0], np.cumsum(known)])
    smooth: Floats = (sums[last] - sums[first]) / np.maximum(counts[last] - counts[first], 1)
    detrended: Floats = profile - smooth
    return detrended


def _moved(profile: Floats, steps: float) -> Floats:
    grid = np.arange(profile.size, dtype=np.float64)
    return np.interp(grid - steps, grid, profile, left=np.nan, right=np.nan)


def _mean(profiles: Floats) -> Floats:
    known = np.isfinite(profiles)
    count = known.sum(axis=0)
    total = np.where(known, profiles, 0.0).sum(axis=0)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def _correlations(profile: Floats, others: Floats, most: int, enough: int) -> Floats:
    """Pearson's correlation at shifts of -most ... most grid steps, (2 most + 1,); NaN where too little overlaps."""
    curve = np.full(2 * most + 1, np.nan)
    for lag in range(max(-most, 1 - profile.size), min(most, profile.size - 1) + 1):
        mine = profile[max(0, -lag) : profile.size - max(0, lag)]
        theirs = others[max(0, lag) : others.size - max(0, -lag)]
        both = np.isfinite(mine) & np.isfinite(theirs)
        if np.count_nonzero(both) >= enough:
            a, b = mine[both] - mine[both].mean(), theirs[both] - theirs[both].mean()
            power = float((a @ a) * (b @ b))
            curve[lag + most] = a @ b / np.sqrt(power) if power > 0 else np.nan
    return curve


def _peak(curve: Floats, most: int, least: float) -> tuple[float, float, bool]:
    """Shift in grid steps, correlation there and whether it counts: the top of the parabola through the best three."""
    if np.isnan(curve).all():
        return 0.0, float("nan"), False
    top = int(np.nanargmax(curve))
    if top in (0, 2 * most) or not curve[top] >= least or np.isnan(curve[[top - 1, top + 1]]).any():
        return 0.0, float(curve[top]), False
    left, middle, right = curve[top - 1 : top + 2]
    bend = left - 2.0 * middle + right
    aside = 0.5 * (left - right) / bend if bend < 0 else 0.0
    return top - most + float(aside), float(middle - 0.25 * (left - right) * aside), True

r"""Find the depth shift of each pass by correlating its median radius along the hole with that of the other passes.

    radius       _/\__/\_____     pass, moved by the trial shift       correlation(shift) has its peak
    less trend     _/\__/\____    the others                           at the shift to be added to its depths

All arms of a pass count alike, so a pass in which the tool lay rotated still matches. Only differences can be found, so
the mean of the shifts that are found is set to 0, unless some passes are held (not shifted). A hole whose shape
repeats along it (a spiral, regular ledges) matches at several shifts; if another peak of the correlation is nearly as
high as the best, no shift is found. Stretching within a pass is not supported.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats, Integers, Mask, finite_column, whole_column
from helibore.base.errors import InputError
from helibore.preparation.biases import rows_of

__all__ = ["Shifts", "find_shifts"]

_STEP = 0.05  # m between trial shifts; the best shift is refined by a parabola
_LIMIT = 2.0  # m: the largest trial shift
_TREND = 10.0  # m: length of the running mean that is subtracted first, and least overlap of two passes
_LEAST = 0.4  # least correlation: with less, a pass is not shifted
_WIDEST_GAP = 1.0  # m: longest gap between samples of one pass across which its profile is interpolated
_ROUNDS = 5
_VALLEY = 0.7  # the best peak ends where the curve falls to this share of the best correlation
_GRID = 0.2  # steps: the error of a shift due to the grid and its linear interpolation
_RIVAL = 0.9  # the shift is ambiguous if a second peak is higher than this share of the best correlation


@dataclass(frozen=True)
class Shifts:
    """The depth shift of each of p passes; columns are (p,), metres."""

    passes: Integers  # numbers of the passes, sorted
    shift: Floats  # to add to the depths of the pass; 0 for a held pass and where no shift was found
    correlation: Floats  # with the other passes at the shift; 1 for a held pass, NaN if less than 10 m overlap
    before: Floats  # the correlation if all passes but this one are shifted; 1 for a held pass
    found: Mask  # whether the pass is held, or the correlation has one clear peak of at least 0.4 within 2 m
    sigma: Floats  # standard deviation of the shift, from the peak's curvature; 0 for a held pass, NaN without a peak
    second: Floats  # shift at the second-best peak of the correlation; NaN where there is none
    second_correlation: Floats  # the correlation at this second-best peak

    def at(self, pass_number: npt.ArrayLike) -> Floats:
        """Return the shift of each sample, (n,) m, new, to add to the depth. Raises InputError for an unknown pass."""
        return self.shift[rows_of("pass_number", whole_column("pass_number", pass_number), self.passes)]

    def lines(self) -> list[str]:
        """Return a sentence for each pass that was not held."""
        lines = []
        for row, number in enumerate(self.passes):
            if self.sigma[row] == 0:
                continue
            before, after, second = self.before[row], self.correlation[row], self.second_correlation[row]
            text = "left where it is: no clear match"
            rival = "" if np.isnan(second) else f"{self.second[row]:+.3f} m with correlation {second:.2f}"
            if self.found[row]:
                text = (
                    f"{self.shift[row]:+.3f} +- {self.sigma[row]:.3f} m found, correlation with the others "
                    f"{before:.2f} before, {after:.2f} after{'; second best ' if rival else ''}{rival}"
                )
            elif rival and second > _RIVAL * after:
                text += f", since the hole repeats itself (correlation {after:.2f}, and {rival})"
            lines.append(f"pass {number}: {text}")
        return lines


def find_shifts(
    depth: npt.ArrayLike,
    radius: npt.ArrayLike,
    pass_number: npt.ArrayLike,
    *,
    held: Sequence[int] = (),
) -> Shifts:
    """Find the depth shift of each pass.

    Parameters
    ----------
    depth, radius, pass_number
        Metres, metres, whole numbers, (n,), finite, in any order.
    held
        Passes that are not shifted. The other passes are first shifted to match the held ones. Then each of them is
        shifted to match the mean of all other passes, held or not. This is repeated until the shifts no longer change,
        at most until 5 rounds are done.
    """
    where = finite_column("depth", depth)
    distance = finite_column("radius", radius, where.size, "depth")
    number = whole_column("pass_number", pass_number, where.size, "depth")
    passes, row = np.unique(number, return_inverse=True)
    for one in held:
        if one not in passes:
            raise InputError("held", f"is not among the passes {passes.tolist()}", str(one))
    count = passes.size
    shift, found = np.zeros(count), np.zeros(count, dtype=bool)
    best, before, sigma, second, second_best = np.full((5, count), np.nan)
    result = Shifts(passes, shift, best, before, found, sigma, second, second_best)
    if count == 0:
        return result
    grid = np.arange(int(np.ptp(where) / _STEP) + 2)
    profiles = [_profile((where[row == i] - where.min()) / _STEP, distance[row == i], grid) for i in range(count)]
    most, enough = round(_LIMIT / _STEP), round(_TREND / _STEP)
    fixed = np.isin(passes, held)
    for turn in range(_ROUNDS):
        first = turn == 0 and fixed.any()
        start = shift.copy()
        placed = np.stack([_moved(p, s / _STEP) for p, s in zip(profiles, shift, strict=True)])
        for i in np.flatnonzero(~fixed):
            others = placed[fixed] if first else np.delete(placed, i, axis=0)
            curve, overlap = _correlations(profiles[i], _mean(others), 2 * most, enough)
            peak = _peak(curve, most, overlap)
            shift[i], sigma[i], second[i] = peak.shift * _STEP, peak.sigma * _STEP, peak.second * _STEP
            best[i], second_best[i], found[i] = peak.correlation, peak.second_correlation, peak.found
            placed[i] = _moved(profiles[i], peak.shift)
        if not fixed.any():
            second -= _center(shift, found)
        if not first and np.abs(shift - start).max() < 0.01 * _STEP:
            break
    found[fixed], best[fixed], before[fixed] = True, 1.0, 1.0
    sigma[fixed] = 0.0
    # Ambiguity is judged last: while some passes are out of place, each of them makes a peak of its own.
    found &= ~(second_best > _RIVAL * best)
    shift[~found] = 0.0
    if not fixed.any():
        second -= _center(shift, found)
    placed = np.stack([_moved(p, s / _STEP) for p, s in zip(profiles, shift, strict=True)])
    for i in np.flatnonzero(~fixed):
        before[i] = _correlations(profiles[i], _mean(np.delete(placed, i, axis=0)), 0, enough)[0][0]
    return result


def _center(shift: Floats, found: Mask) -> float:
    """Subtract the mean of the found shifts from each found shift, in place, and return this mean."""
    mean = float(shift[found].mean()) if found.any() else 0.0
    shift[found] -= mean
    return mean


def _profile(place: Floats, radius: Floats, grid: Integers) -> Floats:
    """Return the median radius in each grid step, less its running mean; NaN beyond the samples and in wide gaps.

    ``place`` is the depth of each sample in grid steps.
    """
    row = np.round(place)
    order = np.lexsort((radius, row))
    cells, first, count = np.unique(row[order], return_index=True, return_counts=True)
    at = np.add.reduceat(place[order], first) / count if cells.size else cells
    level = 0.5 * (radius[order[first + (count - 1) // 2]] + radius[order[first + count // 2]])
    profile = np.interp(grid, at, level, left=np.nan, right=np.nan)
    if at.size > 1:
        after = np.clip(np.searchsorted(at, grid), 1, at.size - 1)
        profile[(at[after] - at[after - 1]) * _STEP > _WIDEST_GAP] = np.nan
    known = np.isfinite(profile)
    half = round(0.5 * _TREND / _STEP)
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


def _correlations(profile: Floats, others: Floats, most: int, enough: int) -> tuple[Floats, Integers]:
    """Return Pearson's correlation of two profiles, and the number of steps that overlap, (2 most + 1,) each.

    There is one value of each for every shift from -most to most grid steps. Where fewer than ``enough`` steps overlap,
    or a profile is constant, the correlation is NaN.
    """
    curve = np.full(2 * most + 1, np.nan)
    overlap = np.zeros(2 * most + 1, dtype=np.int64)
    for lag in range(max(-most, 1 - profile.size), min(most, profile.size - 1) + 1):
        mine = profile[max(0, -lag) : profile.size - max(0, lag)]
        theirs = others[max(0, lag) : others.size - max(0, -lag)]
        both = np.isfinite(mine) & np.isfinite(theirs)
        overlap[lag + most] = np.count_nonzero(both)
        if overlap[lag + most] >= enough:
            a, b = mine[both] - mine[both].mean(), theirs[both] - theirs[both].mean()
            power = float((a @ a) * (b @ b))
            curve[lag + most] = a @ b / np.sqrt(power) if power > 0 else np.nan
    return curve, overlap


class _Peak(NamedTuple):
    """The best peak of a correlation curve, and the second best: shifts and deviation in grid steps, and correlations.

    ``found`` is whether there is such a peak; if not, only ``correlation`` may be known.
    """

    shift: float = 0.0
    sigma: float = np.nan
    correlation: float = np.nan
    second: float = np.nan
    second_correlation: float = np.nan
    found: bool = False


def _peak(curve: Floats, most: int, overlap: Integers) -> _Peak:
    """Return the highest peak of the correlation ``curve`` within ``most`` steps of its middle, and the second best.

    The peak is the top of a parabola through three steps. The variance of its shift is (1 - c^2) / (n c |c''|) plus the
    square of `_GRID`; c is the correlation, and n the number of independent steps of overlap, one step in four.
    """
    middle = curve.size // 2
    inside = curve[middle - most : middle + most + 1]
    if np.isnan(inside).all():
        return _Peak()
    top = int(np.nanargmax(inside)) + middle - most
    height = float(curve[top])
    if abs(top - middle) == most or not height >= _LEAST or np.isnan(curve[[top - 1, top + 1]]).any():
        return _Peak(correlation=height)
    left, right = curve[top - 1], curve[top + 1]
    bend = left - 2.0 * height + right
    if not bend < 0:
        return _Peak(correlation=height)
    aside = float(0.5 * (left - right) / bend)
    height = min(float(height - 0.25 * (left - right) * aside), 1.0)
    sigma = float(np.sqrt((1.0 - height**2) / (0.25 * overlap[top] * height * -bend) + _GRID**2))
    peaks = np.flatnonzero((curve[1:-1] >= curve[:-2]) & (curve[1:-1] >= curve[2:])) + 1
    low = np.flatnonzero(~(curve > _VALLEY * height))  # where the best peak ends
    begin, end = low[low < top].max(initial=-1), low[low > top].min(initial=curve.size)
    peaks = peaks[(peaks <= begin) | (peaks >= end)]
    second, second_height = np.nan, np.nan
    if peaks.size:
        rival = int(peaks[np.argmax(curve[peaks])])
        second, second_height = float(rival - middle), float(curve[rival])
    return _Peak(top - middle + aside, sigma, height, second, second_height, True)

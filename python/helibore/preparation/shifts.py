r"""Find the depth shift of each pass along the hole by what the other passes saw.

    depth of the hole = depth + shift(depth)     constant, stretched (a cable), in steps, or to and fro (yo-yo, heave)

The others are a field of radii with an uncertainty (``fields``), and the shift is a path through how well the readings
of the pass fit it (``depth_paths``). Only differences can be found: the mean of the shifts that are found is set to 0,
unless some passes are held (not shifted). A pass is left where it is if it overlaps the others by too little, if its
shift is not known to 0.12 m in half of its rows, or if the hole repeats itself, so that another shift fits nearly as
well. Where the shift of a row is not known, it is taken from the rows around, and its deviation says so.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats, Integers, Mask, finite_column, runs_of, whole_column
from helibore.base.errors import InputError
from helibore.preparation.biases import rows_of
from helibore.preparation.depth_paths import (
    APART,
    FINEST,
    GRID,
    RESTLESS,
    STEP,
    DepthPath,
    find_path,
    wave_about,
)
from helibore.preparation.fields import Field, RowsOfPass, fit, in_rows, seen_by_all
from helibore.preparation.toolface_matches import LEAST, ToolfaceMatch, find_toolface

__all__ = ["DepthFunction", "Shifts", "find_shifts"]

_CELL = 0.05  # m: height of a row of readings; more if the passes have more than `_MOST_ROWS` of these
_MOST_ROWS = 20_000
_OVERLAP = 10.0  # m: least overlap of a pass with the others
_RIVAL = 0.8  # another shift is a rival if it gains more than this share of what the found one gains
_AT_ONCE = 4  # most passes in place with which a pass is matched, those that it overlaps most
_REPORTED = 0.01  # share of the rows whose shift is not known, from which a pass is reported
_REPEATED = 0.6  # correlation of a hole with itself, moved, from which it repeats itself
_REPEATED_TO_AND_FRO = 0.55  # the same for a path that moves to and fro, which can follow a repeat more easily
_TURNS = 3  # most times that a pass is turned
_VAGUE = 0.04  # metres: median deviation of a shift from which a pass that moves to and fro is refused
_JUMPED = 0.45  # metres: more than a shift can change where a tool goes to and fro
_MOVES = 10.0  # logarithm of the likelihood that one of some thousand waves gains, from which a pass may move
_LEAST_GAIN = 4.0  # logarithm of the likelihood that the found shift must gain over a rival: odds of 50


@dataclass(frozen=True)
class DepthFunction:
    """The shift of one pass along the hole, linear between k depths of the pass, metres."""

    depth: Floats = field(default_factory=lambda: np.zeros(1))  # of the pass, (k,), rising
    shift: Floats = field(default_factory=lambda: np.zeros(1))  # to add to these depths, (k,)
    sigma: Floats = field(default_factory=lambda: np.full(1, np.nan))  # deviation of the shift, (k,); 0: held
    known: Mask = field(default_factory=lambda: np.zeros(1, dtype=bool))  # whether the shift is known to 0.12 m, (k,)
    found: bool = False  # False: the pass is not shifted
    reason: str = ""  # why it is not
    second: float = np.nan  # shift of the second-best match
    second_share: float = np.nan  # what that gains, as a share of what the best gains
    before: float = np.nan  # median difference of the readings from the others, unshifted
    after: float = np.nan  # and shifted
    toolface: ToolfaceMatch | None = None  # how far its toolfaces lie from those of the others; None: not compared


@dataclass(frozen=True)
class Shifts:
    """The depth function of each of p passes, sorted by number."""

    passes: Integers
    functions: tuple[DepthFunction, ...]

    @property
    def shift(self) -> Floats:
        """The mean shift of each pass, (p,) m."""
        return np.array([each.shift.mean() for each in self.functions])

    @property
    def sigma(self) -> Floats:
        """The median deviation of the shift of each pass, (p,) m; 0 for a held pass, NaN where none was found."""
        return np.array([np.median(each.sigma) for each in self.functions])

    @property
    def found(self) -> Mask:
        """Whether each pass is held or was shifted, (p,)."""
        return np.array([each.found for each in self.functions], dtype=bool)

    def at(self, pass_number: npt.ArrayLike, depth: npt.ArrayLike) -> Floats:
        """Return the shift of each sample, (n,) m, new, to add to the depth. Raises InputError for an unknown pass."""
        number = whole_column("pass_number", pass_number)
        where = finite_column("depth", depth, number.size, "pass_number")
        row = rows_of("pass_number", number, self.passes)
        shift = np.empty(where.size)
        for index, each in enumerate(self.functions):
            mine = row == index
            shift[mine] = np.interp(where[mine], each.depth, each.shift)
        return shift

    def lines(self) -> list[str]:
        """Return sentences for each pass that was not held."""
        lines = []
        for number, each in zip(self.passes.tolist(), self.functions, strict=True):
            if each.found and (each.sigma == 0).all():
                continue
            lines.append(f"pass {number}: {_sentence(each) if each.found else f'left where it is: {each.reason}'}")
            if each.found and each.toolface is not None and each.toolface.worth_saying:
                lines.append(f"pass {number}: {each.toolface.sentence(number)}")
            if each.found and np.mean(~each.known) > _REPORTED:
                runs = sorted(runs_of(~each.known), key=lambda run: each.depth[run[0]] - each.depth[run[1] - 1])
                first, stop = runs[0]
                share, top, end = 100 * np.mean(~each.known), each.depth[first], each.depth[stop - 1]
                lines.append(
                    f"pass {number}: its shift is not known to {APART:g} m in {share:.0f} % of its rows, most of all "
                    f"from {top:.1f} to {end:.1f} m: taken from the rows around"
                )
        return lines


def _sentence(each: DepthFunction) -> str:
    least, most, sigma = each.shift.min(), each.shift.max(), np.median(each.sigma)
    varies = f", from {least:+.3f} to {most:+.3f} m" if most - least > 2 * sigma else ""
    second = f"; second best {each.second:+.2f} m away, with {each.second_share:.2f} of the gain"
    if np.isnan(each.before):
        return f"{each.shift.mean():+.3f} m; the other passes were matched to it"
    return (
        f"{each.shift.mean():+.3f} +- {sigma:.3f} m found{varies}; the readings differ from the others by "
        f"{1e3 * each.before:.2f} mm before, {1e3 * each.after:.2f} mm after (median)"
        f"{'' if np.isnan(each.second) else second}"
    )


def find_shifts(
    depth: npt.ArrayLike,
    toolface: npt.ArrayLike,
    radius: npt.ArrayLike,
    pass_number: npt.ArrayLike,
    *,
    held: Sequence[int] = (),
) -> Shifts:
    """Find the depth shift of each pass as a function of depth.

    Parameters
    ----------
    depth, toolface, radius, pass_number
        Metres, degrees, metres, whole numbers, (n,), finite, in any order.
    held
        Passes that are not shifted; the others are shifted to match them. Without held passes, the pass that covers
        most is the first to match. Each next pass is matched to the four passes in place that it overlaps most; a pass
        that is refused is matched once more when all others are in place.
    """
    where = finite_column("depth", depth)
    angle = finite_column("toolface", toolface, where.size, "depth")
    distance = finite_column("radius", radius, where.size, "depth")
    number = whole_column("pass_number", pass_number, where.size, "depth")
    passes, row = np.unique(number, return_inverse=True)
    for one in held:
        if one not in passes:
            raise InputError("held", f"is not among the passes {passes.tolist()}", str(one))
    samples = [(where[row == i], angle[row == i], distance[row == i]) for i in range(passes.size)]
    functions = _Matching(samples, np.isin(passes, held)).run()
    if not any(one in held for one in passes):
        functions = _centred(functions)
    return Shifts(passes, tuple(functions))


def _centred(functions: list[DepthFunction]) -> list[DepthFunction]:
    """Return the functions less the mean of those found."""
    found = [each.shift.mean() for each in functions if each.found]
    mean = float(np.mean(found)) if len(found) > 1 else 0.0
    return [replace(each, shift=each.shift - mean) if each.found else each for each in functions]


class _Matching:
    """Passes that are matched one after the other with those already in place."""

    def __init__(self, samples: list[tuple[Floats, Floats, Floats]], held: Mask) -> None:
        self.held = held
        self.ends = [(float(depth.min()), float(depth.max())) for depth, _, _ in samples]
        length = max((bottom - top for top, bottom in self.ends), default=0.0)
        self.samples, self.cell = samples, max(_CELL, length / _MOST_ROWS)
        self.rows = [in_rows(*each, self.cell) for each in samples]
        self.fits: dict[int, Field] = {}
        self.functions = [DepthFunction() for _ in samples]
        self.bias = np.zeros(len(samples))

    def run(self) -> list[DepthFunction]:
        first = np.flatnonzero(self.held).tolist()
        if not first and self.rows:
            first = [int(np.argmax([bottom - top for top, bottom in self.ends]))]
        for index in first:
            sigma = np.full(2, 0.0 if self.held[index] else FINEST)
            known = np.ones(2, dtype=bool)
            self.functions[index] = DepthFunction(np.array(self.ends[index]), np.zeros(2), sigma, known, True)
        placed, left = list(first), [index for index in range(len(self.rows)) if index not in first]
        tried_with = {}  # how many passes were in place
        while left:
            index = max(left, key=lambda one: max(self._overlap(one, other) for other in placed))
            left.remove(index)
            tried_with[index] = len(placed)
            self._match(index, placed)
        for index, count in tried_with.items():
            if not self.functions[index].found and len(placed) > count:
                self._match(index, placed)
        if len(placed) == 1 and not self.held.any():
            alone = "it is the only pass" if len(self.functions) == 1 else "no other pass matches it"
            self.functions[first[0]] = DepthFunction(reason=alone)
        return self.functions

    def _overlap(self, index: int, other: int) -> float:
        """Return the length in which a pass overlaps one in place, metres."""
        (top, bottom), function = self.ends[index], self.functions[other]
        above, below = (end + float(np.interp(end, function.depth, function.shift)) for end in self.ends[other])
        return min(bottom, below) - max(top, above)

    def _fitted(self, index: int) -> Field:
        if index not in self.fits:
            self.fits[index] = fit(self.rows[index])
        return self.fits[index]

    def _placed(self, index: int) -> Field:
        """Return the field of a pass in place, at depths of the hole and less the bias of the pass."""
        field, function, bias = self._fitted(index), self.functions[index], self.bias[index]
        moved = field.depth + np.interp(field.depth, function.depth, function.shift)
        moved = np.maximum.accumulate(moved + 1e-9 * np.arange(moved.size))
        readings = replace(field.readings, depth=moved, radius=field.readings.radius - bias)
        return replace(
            field, depth=moved, mean=field.mean - bias * (np.arange(field.prior.size) == 0), readings=readings
        )

    def _match(self, index: int, placed: list[int]) -> None:
        self.functions[index] = self._matched(index, placed)
        if self.functions[index].found:
            placed.append(index)

    def _matched(self, index: int, placed: list[int]) -> DepthFunction:
        overlaps = {other: max(self._overlap(index, other), 0.0) for other in placed}
        most = sorted(placed, key=lambda other: -overlaps[other])[:_AT_ONCE]
        if overlaps[most[0]] < _OVERLAP:
            overlap = f"{overlaps[most[0]]:.1f} m, less than {_OVERLAP:g} m"
            return DepthFunction(reason=f"it overlaps the others by {overlap}")
        others = [other for other in most if overlaps[other] >= _OVERLAP]
        theirs = [self._placed(other) for other in others]
        rows, path, toolface = self._path(index, theirs)
        found = replace(_judged(rows, theirs, path), toolface=toolface)
        if not found.found:
            return found
        self.bias[index] = path.bias
        own = np.zeros(found.depth.size)
        for other, seen in zip(others, theirs, strict=True):
            sigma = np.interp(self.rows[other].depth, self.functions[other].depth, self.functions[other].sigma)
            own += np.square(np.interp(found.depth + found.shift, seen.depth, sigma)) / len(others)
        return replace(found, sigma=np.sqrt(np.square(found.sigma) + np.where(own > FINEST**2, own, 0.0)))

    def _path(self, index: int, theirs: list[Field]) -> tuple[RowsOfPass, DepthPath, ToolfaceMatch]:
        """Return the path of a pass and its toolfaces' offset, which is taken off its readings until none is left.

        A pass that is turned fits elsewhere along the hole; and its sectors must be those of the others, because in the
        means of sectors a narrow lobe looks like a wide one.
        """
        depth, toolface, radius = self.samples[index]
        angle = 0.0
        for left in range(_TURNS, -1, -1):
            mine = self._fitted(index)
            path = find_path(mine.readings, theirs, mine.noise)
            match = find_toolface(mine, theirs, path)
            total = replace(match, angle=(angle + match.angle + 180.0) % 360.0 - 180.0)
            if left < _TURNS:  # what is left after a turn that was to leave none; a half more may fit nearly as well
                rest = (match.angle + 90.0) % 180.0 - 90.0 if match.by_half else match.angle
                total = replace(total, sigma=float(np.hypot(match.sigma, rest)))
            if not left or not total.is_offset or abs(match.angle) < LEAST / 2:
                break
            angle = total.angle
            self.rows[index] = in_rows(depth, toolface + angle, radius, self.cell)
            del self.fits[index]
        return mine.readings, path, total


def _judged(rows: RowsOfPass, theirs: list[Field], path: DepthPath) -> DepthFunction:
    """Return the depth function of a path, or one that says why it is refused."""
    where = rows.depth + path.shift
    inside = np.any([(where >= each.depth[0]) & (where <= each.depth[-1]) for each in theirs], axis=0)
    if not inside.any():
        return DepthFunction(reason="none of its readings lies where the others have some")
    known = path.known & inside
    known &= _in_long_pieces(rows.depth, path.shift, known)
    second, share, gain_of = _rival(path)
    repeats = _repeats(theirs[0])
    design = rows.design()
    before, after = (
        float(np.nanmedian(np.abs(rows.radius - path.bias - seen_by_all(theirs, at[:, None], design)[0][:, 0])[inside]))
        for at in (rows.depth, where)
    )
    result = DepthFunction(second=second, second_share=share, before=before, after=after)
    lead = (1 - share) * max(gain_of, 0.0)
    if share > _RIVAL and gain_of > _LEAST_GAIN:
        by = f"moved by {second:+.2f} m more it matches nearly as well ({share:.2f} of the gain of {gain_of:.0f})"
        return replace(result, reason=f"no clear match, since {by}")
    if lead < _LEAST_GAIN:
        over = "shifts far from it" if np.isnan(second) else f"a shift that is {second:+.2f} m more"
        by = f"the best shift gains only {lead:.1f} over {over}, less than {_LEAST_GAIN:g}"
        return replace(result, reason=f"no clear match, since {by} (logarithm of the likelihood)")
    if repeats > (_REPEATED if path.wander < RESTLESS else _REPEATED_TO_AND_FRO):
        return replace(result, reason=f"no clear match, since the hole repeats itself (correlation {repeats:.2f})")
    best = f"of all constant shifts, {GRID[int(np.argmax(path.fits.sum(axis=0)))]:+.2f} m fits best"
    best = "" if path.base.any() else f"; {best}"
    if known.sum() < 0.5 * inside.sum():
        part = f"its shift is known to {APART:g} m in {100 * known.sum() / max(inside.sum(), 1):.0f} % of its rows"
        return replace(result, reason=f"no clear match: {part}{best}")
    sigma = float(np.median(path.sigma[inside]))
    if path.wander >= RESTLESS and sigma > _VAGUE:
        rule = f"it moves to and fro, and its shift is known to {sigma:.3f} m only (median), not to {_VAGUE:g} m"
        return replace(result, reason=f"no clear match: {rule}{best}")
    gained, height, wave = wave_about(path, rows.depth) if path.wander < RESTLESS else (0.0, 0.0, 0.0)
    if gained > _MOVES:
        by = f"by {gained:.0f}, more than {_MOVES:g}"
        moved = f"moved to and fro by {height:g} m in {wave:.1f} m it matches better ({by})"
        return replace(result, reason=f"no clear match, since {moved}{best}")
    shift = np.interp(rows.depth, rows.depth[known], path.shift[known])
    beyond = np.abs(shift - path.shift)
    deviation = np.where(known, path.sigma, np.hypot(path.sigma, beyond))
    return replace(result, depth=rows.depth, shift=shift, sigma=deviation, known=known, found=True)


def _in_long_pieces(depth: Floats, shift: Floats, known: Mask) -> Mask:
    """Return the rows between two jumps of a shift that are at least as far apart as passes must overlap.

    In a shorter piece another shift may fit by chance.
    """
    piece, rows = np.zeros(depth.size, dtype=np.int64), np.flatnonzero(known)
    piece[rows[1:]] = np.abs(np.diff(shift[rows])) > _JUMPED
    piece = np.cumsum(piece)
    ends = np.flatnonzero(np.diff(piece, prepend=-1, append=piece[-1] + 1))
    lengths = depth[ends[1:] - 1] - depth[ends[:-1]]
    long: Mask = (lengths >= _OVERLAP)[piece] | (piece[-1] == 0)
    return long


def _rival(path: DepthPath) -> tuple[float, float, float]:
    """Return the second-best constant offset from the path, its share of the gain, and the gain of the path."""
    at = np.round((path.shift - path.base - GRID[0]) / STEP).astype(np.int64)
    away = np.arange(-GRID.size + 1, GRID.size)
    score = np.full(away.size, np.nan)
    for index, one in enumerate(away.tolist()):
        there = (at + one >= 0) & (at + one < GRID.size)
        if there.sum() >= 0.5 * at.size:
            score[index] = path.fits[np.flatnonzero(there), at[there] + one].sum() / there.mean()
    level = np.nanmedian(score)
    gain = score - level
    middle = GRID.size - 1
    low = np.flatnonzero(~(gain > 0.5 * gain[middle]))
    first, last = low[low < middle].max(initial=-1), low[low > middle].min(initial=gain.size)
    beyond = np.where((away + middle > first) & (away + middle < last), np.nan, gain)
    if np.isnan(beyond).all():
        return np.nan, 0.0, float(gain[middle])
    rival = int(np.nanargmax(beyond))
    share = float(beyond[rival] / gain[middle]) if gain[middle] > 0 else 1.0
    return float(away[rival] * STEP), share, float(gain[middle])


def _repeats(theirs: Field) -> float:
    """Return the highest correlation of a field with itself, moved by up to 4.4 m, beyond where it falls below 0.5."""
    grid = np.arange(theirs.depth[0], theirs.depth[-1], _CELL)
    values = np.stack([np.interp(grid, theirs.depth, each) for each in theirs.mean.T], axis=1)
    values -= values.mean(axis=0)
    lags = range(min(round(2 * GRID[-1] / _CELL), grid.size // 2))
    curve = []
    for lag in lags:
        one, other = values[: grid.size - lag], values[lag:]
        power = float(np.square(one).sum() * np.square(other).sum())
        curve.append(float((one * other).sum()) / np.sqrt(power) if power > 0 else 0.0)
    low = np.flatnonzero(np.array(curve) < 0.5)
    return max(curve[int(low[0]) :], default=0.0) if low.size else 0.0

"""Decide which samples to leave out: each step judges samples, changes none of them, and returns a :class:`Step`.

    step = spikes(toolface, radius, turn)
    radius[step.kept], step.counts         # counts: {"spike": 3}

A step has a name, its settings, a mask of the samples to drop and a count for each reason. No step knows what another
step dropped, so select the kept samples before the next step if it should judge only these. No step repairs a value.
`Echo` converts travel times to radii.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from helibore import _core
from helibore.base.arrays import Floats, Integers, Mask, column, distinct, runs_of, whole_column
from helibore.base.errors import InputError

_SAMPLES_AT_ONCE = 1 << 17
LONGEST_BURST = 5
"""Largest number of samples side by side that are taken for a burst of spikes."""


class SuspectRows(NamedTuple):
    """Rows that stand out, as `judge_rows` of the core finds them; ``preparation.hpp`` explains the causes."""

    cause: str
    column: int  # index among the columns of readings; -1: all of them
    first: int
    stop: int  # the row after the last
    dropped: bool
    radius: float  # metres: at which the arms stay, or by how much two columns differ; NaN for spikes
    other: int  # the other column of a disagreement

    @property
    def rows(self) -> int:
        return self.stop - self.first


@dataclass(frozen=True)
class Step:
    """The result of one step; it depends only on ``settings`` and the samples."""

    name: str
    settings: Mapping[str, float | int]
    dropped: Mask  # True where the value is to be left out; same shape as the values judged
    counts: Mapping[str, int] = field(default_factory=dict)  # dropped samples for each reason
    unjudged: int = 0  # samples that the step could not judge (too few neighbours); they are kept

    @property
    def kept(self) -> Mask:
        """Mask of the samples to keep: True where ``dropped`` is False, a new array."""
        return ~self.dropped


def in_range(values: npt.ArrayLike, low: float, high: float) -> Step:
    """Drop the values (n,) that are missing (NaN), below ``low`` or above ``high``; ``counts`` has each reason."""
    array = column("values", values)
    if not low <= high:
        raise InputError(f"low = {low:g}, high = {high:g}", "low must not be larger than high")
    missing, below, above = np.isnan(array), array < low, array > high
    counts = {name: int(np.count_nonzero(m)) for name, m in (("missing", missing), ("below", below), ("above", above))}
    return Step("range", {"low": low, "high": high}, missing | below | above, counts)


def spikes(
    toolface: npt.ArrayLike,
    radius: npt.ArrayLike,
    turn: npt.ArrayLike,
    depth: npt.ArrayLike | None = None,
    *,
    threshold: float = 6.0,
    floor: float = 0.0005,
) -> Step:
    """Drop samples that disagree with the neighbouring turns at the same toolface, in time and in depth.

    A breakout, a key seat or a ledge continues from turn to turn or around the hole; a spike does not. In each of the
    three turns before and after, take the two samples next to the toolface, one on either side. Of these samples, the
    six nearest in toolface are compared with the sample, but none farther than 20 degrees (with few arms: 0.75 of the
    angle between them). The sample is a spike if all of these hold::

        1  it lies beyond the second largest or second smallest of them by more than the tolerance plus a tenth of the
           difference of those two
        2  no sample next to its toolface in the turn before or after is within half the tolerance of it, and it is one
           of a burst: at most five samples side by side in its turn, no more than a third of the turn, that lie
           beyond their neighbours in this way. No sample beside the burst is within half the tolerance of its end,
           unless the first rule holds for that sample, too. A turn of at most five samples, such as a row of arms, may
           be a burst as a whole
        3  of the four samples before and the four after it, by depth, in its 10 degrees, none is more than three turns
           away; or the nearest such sample is farther than 5 cm in depth, or differs by more than the tolerance

    The tolerance is ``threshold`` times a deviation. The deviation of a turn is 1.4826 times the median distance of its
    samples from the medians of their neighbours; each hundred turns use their median deviation.

    Parameters
    ----------
    toolface, radius, turn
        Degrees, metres, and whole numbers in order of time, (n,). Samples with a NaN radius are kept and not counted.
    depth
        Metres, (n,), for the third rule; None: the third rule is left out.
    threshold
        The tolerance, in deviations.
    floor
        Least deviation, metres, also where the samples show less noise. Quantised radii need about one step, because
        their median distance is often 0.

    Returns
    -------
    Step
        ``unjudged`` counts samples with fewer than four neighbours in other turns.

    Notes
    -----
    1.4826 = 1 / 0.6745, the quartile of the normal distribution.
    """
    angle = column("toolface", toolface)
    distance = column("radius", radius, angle.size, "toolface")
    number = whole_column("turn", turn, angle.size, "toolface")
    where = np.zeros(angle.size) if depth is None else column("depth", depth, angle.size, "toolface")
    if not (threshold > 0 and floor > 0):
        raise InputError(f"threshold = {threshold:g}, floor = {floor:g}", "must be above 0")
    present = np.flatnonzero(np.isfinite(distance))
    order = present[np.lexsort((angle[present] % 360.0, number[present]))]
    rings = _Rings(angle[order] % 360.0, distance[order], number[order])
    middle, low, high, judged = np.empty((4, order.size))
    alone = np.empty(order.size, dtype=bool)
    for start in range(0, order.size, _SAMPLES_AT_ONCE):
        at = np.arange(start, min(start + _SAMPLES_AT_ONCE, order.size))
        judged[at], middle[at], low[at], high[at] = rings.neighbours(at)
    tolerance = threshold * np.maximum(rings.deviation(middle), floor)
    slack = tolerance + 0.1 * (high - low)
    for start in range(0, order.size, _SAMPLES_AT_ONCE):
        at = np.arange(start, min(start + _SAMPLES_AT_ONCE, order.size))
        alone[at] = ~rings.supported(at, 0.5 * tolerance[at])
    beyond = (judged >= 4) & ((rings.radius > high + slack) | (rings.radius < low - slack))
    found = np.flatnonzero(rings.bursts(beyond & alone, beyond, tolerance))
    if depth is not None and found.size:
        found = found[~rings.repeated(found, where[order], tolerance)]
    dropped = np.zeros(angle.size, dtype=bool)
    dropped[order[found]] = True
    unjudged = int(np.count_nonzero(judged < 4))
    return Step("spikes", {"threshold": threshold, "floor": floor}, dropped, {"spike": found.size}, unjudged)


class _Rings:
    """Samples sorted by turn and toolface: the samples of a turn form a ring."""

    reach, used = 3, 6  # number of turns on either side, and number of the neighbours in them that are compared

    def __init__(self, angle: Floats, radius: Floats, turn: Integers) -> None:
        self.angle, self.radius = angle, radius
        self.turns, first, count, ring = _runs_of(turn)
        self.first, self.count, self.ring = first, count, ring
        self.key = ring * 360.0 + angle

    def _next_to(self, at: Integers, step: int) -> tuple[Integers, Mask]:
        """Return the two samples in the turn ``step`` turns away that are next to the toolface of each ``at``, (n, 2).

        Also return whether that turn exists, (n,).
        """
        ring = np.searchsorted(self.turns, self.turns[self.ring[at]] + step)
        ring = np.minimum(ring, self.turns.size - 1)
        there = self.turns[ring] == self.turns[self.ring[at]] + step
        after = np.searchsorted(self.key, ring * 360.0 + self.angle[at]) - self.first[ring]
        pair = np.stack([after - 1, after], axis=1) % self.count[ring, None]
        return self.first[ring, None] + pair, there

    def neighbours(self, at: Integers) -> tuple[Floats, Floats, Floats, Floats]:
        """Return the number of neighbours of each sample ``at`` in other turns, and radii of these neighbours.

        The radii are the median, the second smallest and the second largest.
        """
        pairs = [self._next_to(at, step) for step in range(-self.reach, self.reach + 1) if step]
        candidates = np.concatenate([pair for pair, _ in pairs], axis=1)
        gap = np.abs((self.angle[candidates] - self.angle[at, None] + 180.0) % 360.0 - 180.0)
        # The limit of a tool with few arms is 0.75 of the angle between two arms: a sample beyond it is of another arm.
        far = gap > np.maximum(20.0, 270.0 / self.count[self.ring[at], None])
        far[:, 1::2] |= candidates[:, 1::2] == candidates[:, ::2]  # a turn of one sample gives one neighbour
        gap[far | ~np.repeat(np.stack([there for _, there in pairs], axis=1), 2, axis=1)] = np.inf
        nearest = np.argsort(gap, axis=1, kind="stable")[:, : self.used]
        absent = np.isinf(np.take_along_axis(gap, nearest, axis=1))
        values = self.radius[np.take_along_axis(candidates, nearest, axis=1)]
        values = np.sort(np.where(absent, np.nan, values), axis=1)  # NaN are sorted to the end
        number = self.used - absent.sum(axis=1)
        row, last = np.arange(at.size), np.maximum(number - 1, 0)
        middle = 0.5 * (values[row, last // 2] + values[row, (last + 1) // 2])
        return number.astype(np.float64), middle, values[row, np.minimum(1, last)], values[row, np.maximum(last - 1, 0)]

    def deviation(self, middle: Floats) -> Floats:
        """Return for each sample the robust deviation of radii from ``middle``, the median of their neighbours, metres.

        Each block of a hundred turns has one deviation, the median of the deviations of its turns. A turn through a
        breakout has a larger median distance, which is due to shape and not to noise.
        """
        off = np.nan_to_num(np.abs(self.radius - middle), nan=np.inf)
        off = off[np.lexsort((off, self.ring))][self.first + (self.count - 1) // 2]
        block = np.arange(off.size) // 100
        _, first, count, _ = _runs_of(block)
        median: Floats = 1.4826 * off[np.lexsort((off, block))][first + (count - 1) // 2]
        deviation: Floats = np.where(np.isfinite(median), median, 0.0)[block[self.ring]]
        return deviation

    def supported(self, at: Integers, tolerance: Floats) -> Mask:
        """Return whether each sample ``at`` agrees with a sample next to its toolface in the turn before or after."""
        agrees = np.zeros(at.size, dtype=bool)
        for step in (-1, 1):
            pair, there = self._next_to(at, step)
            near = np.abs(self.radius[pair] - self.radius[at, None]) <= tolerance[:, None]
            agrees |= near.any(axis=1) & there
        return agrees

    def bursts(self, odd: Mask, beyond: Mask, tolerance: Floats) -> Mask:
        """Return which of the ``odd`` samples are in a burst: few side by side in a turn, unlike those beside them.

        A sample beside a burst that is ``beyond`` its neighbours too does not support the burst.
        """
        found = np.zeros(odd.size, dtype=bool)
        rings = distinct(self.ring[odd])
        for first, count in zip(self.first[rings].tolist(), self.count[rings].tolist(), strict=True):
            ring = np.arange(first, first + count)
            if odd[ring].all():
                found[ring] = count <= LONGEST_BURST
                continue
            ring = np.roll(ring, -int(np.argmin(odd[ring])))  # begins with a sample that is not odd
            for begin, end in runs_of(odd[ring]):
                if end - begin > max(1, min(LONGEST_BURST, count // 3)):
                    continue
                ends = ring[[begin, end - 1]]
                beside = ring[[begin - 1, end % count]]
                off = np.abs(self.radius[ends] - self.radius[beside])
                found[ring[begin:end]] = ((off > 0.5 * tolerance[ends]) | beyond[beside]).all()
        return found

    def repeated(self, at: Integers, depth: Floats, tolerance: Floats) -> Mask:
        """Return whether each sample ``at`` agrees with a sample more than three turns and at most 5 cm of depth away.

        That other sample is the nearest in depth among the four before and the four after in the same 10 degrees.
        """
        cell = np.floor(self.angle / 10.0)
        order = np.lexsort((depth, cell))
        place = np.empty(order.size, dtype=np.int64)
        place[order] = np.arange(order.size)
        beside = place[at, None] + np.array([-4, -3, -2, -1, 1, 2, 3, 4])
        other = order[np.clip(beside, 0, order.size - 1)]
        off = np.abs(depth[other] - depth[at, None])
        apart = np.abs(self.turns[self.ring[other]] - self.turns[self.ring[at]][:, None]) > self.reach
        off[(cell[other] != cell[at, None]) | ~apart] = np.inf
        nearest = np.argmin(off, axis=1, keepdims=True)
        radius = self.radius[np.take_along_axis(other, nearest, axis=1)[:, 0]]
        agrees: Mask = (off.min(axis=1) <= 0.05) & (np.abs(radius - self.radius[at]) <= tolerance[at])
        return agrees


def _runs_of(values: Integers) -> tuple[Integers, Integers, Integers, Integers]:
    """Return the distinct values of a sorted column, first row and count of each, and the index of each row's value."""
    different, first, count = np.unique(values, return_index=True, return_counts=True)
    return different, first, count, np.repeat(np.arange(different.size), count)


def stuck(arms: Sequence[npt.ArrayLike], *, rows: int = 50, moving: float = 0.5) -> Step:
    """Drop runs of rows in which the reading of one arm (or sector) is constant or missing while the others change.

    Parameters
    ----------
    arms
        Two or more columns of readings in the order they were taken, (n,) each; NaN is missing.
    rows
        Least number of rows with one and the same reading; shorter runs do not count.
    moving
        A constant reading is a fault if, within the run, the readings of the other arms changed in at least this mean
        share of rows. In a smooth pipe the readings of all arms are constant, and none is at fault.

    Returns
    -------
    Step
        ``dropped`` is (arms, n). The reasons are ``stuck`` (one value throughout) and ``dead`` (missing throughout).
    """
    if len(arms) < 2:
        raise InputError(f"arms has {len(arms)} columns", "must have at least 2, to compare")
    if rows < 2 or not 0 < moving <= 1:
        raise InputError(f"rows = {rows}, moving = {moving:g}", "rows must be at least 2, moving in (0, 1]")
    values = _table("arms", arms)
    dropped, counts = np.zeros(values.shape, dtype=bool), {"stuck": 0, "dead": 0}
    for found in map(SuspectRows._make, _core.stuck_arms(list(values), rows, moving)):
        dropped[found.column, found.first : found.stop] = True
        counts["dead" if np.isnan(found.radius) else "stuck"] += found.rows
    return Step("stuck", {"rows": rows, "moving": moving}, dropped, counts)


def repeated_rows(*columns: npt.ArrayLike) -> Step:
    """Drop rows that equal an earlier row in every column (n,); the first of equal rows is kept. NaN equals NaN."""
    if not columns:
        raise InputError("columns", "must have at least one column")
    values = _table("columns", columns)
    order = np.lexsort(values)  # stable: among equals the earliest comes first
    ahead, behind = values[:, order[1:]], values[:, order[:-1]]
    same = np.all((ahead == behind) | (np.isnan(ahead) & np.isnan(behind)), axis=0)
    dropped = np.zeros(values.shape[1], dtype=bool)
    dropped[order[1:]] = same
    return Step("repeated rows", {"columns": len(columns)}, dropped, {"repeated": int(np.count_nonzero(same))})


def share_of_repeats(depth: Floats, toolface: Floats, radius: Floats, *, most: int = 1 << 15) -> float:
    """Return the share of rows that equal an earlier row; of many rows, only about ``most`` are judged.

    Hashes of depth and toolface choose these rows, so that all equal rows are among them, or none.
    """
    return _core.share_of_repeats(depth, toolface, radius, most)


def closed(arms: Sequence[npt.ArrayLike], radius: float, *, tolerance: float = 0.002) -> Step:
    """Drop rows taken with the caliper closed: no arm reads more than the closed radius plus a tolerance.

    Parameters
    ----------
    arms
        One or more columns of readings, (n,), in the order they were taken; NaN is missing. A row without any reading
        is not judged.
    radius, tolerance
        Radius of the closed tool, and how much more a closed arm may read, in the unit of the readings.

    Returns
    -------
    Step
        ``dropped`` is (n,), one value a row.
    """
    if not radius > 0 or not tolerance >= 0:
        rule = "radius must be above 0, tolerance not negative"
        raise InputError(f"radius = {radius:g}, tolerance = {tolerance:g}", rule)
    if not len(arms):
        raise InputError("arms", "must have at least one column")
    values = _table("arms", arms)
    silent = np.all(np.isnan(values), axis=0)
    shut = ~np.any(values > radius + tolerance, axis=0) & ~silent
    counts = {"closed": int(np.count_nonzero(shut))}
    return Step("closed", {"radius": radius, "tolerance": tolerance}, shut, counts, int(np.count_nonzero(silent)))


def _table(name: str, columns: Sequence[npt.ArrayLike]) -> Floats:
    """Return columns of equal length as the rows of an array."""
    first = column(f"{name}[0]", columns[0])
    rest = [column(f"{name}[{i}]", columns[i], first.size, f"{name}[0]") for i in range(1, len(columns))]
    return np.stack([first, *rest])

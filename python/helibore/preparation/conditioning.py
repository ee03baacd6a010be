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

import numpy as np
import numpy.typing as npt

from helibore import _core
from helibore.base.arrays import Floats, Integers, Mask, column, runs_of, whole_column
from helibore.base.errors import InputError
from helibore.preparation.readings import Readings

_SAMPLES_AT_ONCE = 1 << 17
_APART = 0.0025  # m: two calipers that look in the same direction disagree if their radii differ by more than this
_CLOSED_LENGTH = 2.0  # m: arms are closed if they stay at their least radius over this length
_CLOSED_ROWS, _STANDING = 20, 0.01  # rows, m: or in this many rows while the tool stands
LONGEST_BURST = 5
"""Largest number of samples side by side, or of rows of an arm, that are taken for a burst of spikes."""
_BURST_LENGTH = 1.0  # m: a burst in the rows of an arm is no longer than this along the hole
_ROW_LENGTH = 0.05  # m: rows in which all arms jump at once are spikes if they reach over no more than this
_ELSEWHERE = 2.0  # m: readings no farther along the hole than this support a burst
_ROWS_APART = 10  # a disagreement is reported if it lasts at least this many rows


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


def arm_spikes(
    arms: Sequence[npt.ArrayLike],
    depth: npt.ArrayLike,
    toolface: Sequence[npt.ArrayLike] | None = None,
    across: Sequence[bool] | None = None,
    *,
    threshold: float = 6.0,
    floor: float = 0.001,
) -> Step:
    """Drop readings of a tool with few arms that its rows before and after contradict, at any distance of rows.

    A reading is odd if it is off the running median of its arm (eight rows on either side) by more than ``threshold``
    deviations. Odd readings are spikes in two cases::

        burst   at most five rows of one arm in succession, over at most 1 m, in which no other arm is odd the same way,
                and no reading elsewhere within 2 m and 15 degrees is as far off (but one odd row proves nothing)
        row     all arms (three of four, at least two) are odd the same way in one row, or in rows over at most 5 cm

    The deviation of an arm is the 85th percentile of its distances from the running median, over 1.44, in each hundred
    rows; so ledges widen it.

    Parameters
    ----------
    arms
        Columns of readings in the order they were taken, metres of radius, (n,) each; NaN is missing.
    depth
        Metres, (n,); NaN where it is not known.
    toolface, across
        Toolface of each arm, degrees, (n,) each, and whether an arm is a diameter, which looks both ways; None: no
        reading elsewhere supports a burst.
    threshold, floor
        Deviations, and the least deviation in metres.

    Returns
    -------
    Step
        ``dropped`` is (arms, n). The reasons are ``burst`` and ``row``.
    """
    if not (threshold > 0 and floor > 0):
        raise InputError(f"threshold = {threshold:g}, floor = {floor:g}", "must be above 0")
    values = _table("arms", arms)
    where = column("depth", depth, values.shape[1], "arms[0]")
    known = np.isfinite(values)
    odd = np.stack([_core.odd_readings(each, threshold, floor) for each in values])
    moved = np.nan_to_num(np.abs(np.diff(where, prepend=where[:1])))
    along = np.cumsum(moved)
    beside = np.pad(odd, ((0, 0), (1, 1)))
    lone = (odd != 0) & (beside[:, :-2] != odd) & (beside[:, 2:] != odd)
    trusted = np.where(lone, np.nan, values)
    angles = None if toolface is None else _table("toolface", toolface)
    ways = np.where([False] * len(values) if across is None else list(across), 180.0, 360.0)
    rows = np.zeros(values.shape[1], dtype=bool)
    most = np.maximum(2, 0.75 * known.sum(axis=0))
    for sign in (-1, 1):
        for first, last in runs_of((odd == sign).sum(axis=0) >= most):
            rows[first:last] |= last - first == 1 or along[last - 1] - along[first] <= _ROW_LENGTH
    burst = np.zeros(values.shape, dtype=bool)
    for arm in range(len(values)):
        others = np.delete(odd, arm, axis=0)
        for sign in (-1, 1):
            with_it = (others == sign).any(axis=0)
            for first, last in runs_of((odd[arm] == sign) & ~rows):
                short = last - first <= LONGEST_BURST and along[last - 1] - along[first] <= _BURST_LENGTH
                if not short or with_it[max(first - 1, 0) : last + 1].any():
                    continue
                if angles is None or not _seen_elsewhere(trusted, values, angles, ways, along, arm, (first, last)):
                    burst[arm, first:last] = True
    dropped = burst | (rows & known)
    counts = {"burst": int(np.count_nonzero(burst)), "row": int(np.count_nonzero(rows & known))}
    return Step("spikes of arms", {"threshold": threshold, "floor": floor}, dropped, counts)


def _seen_elsewhere(
    trusted: Floats, values: Floats, angles: Floats, ways: Floats, along: Floats, arm: int, burst: tuple[int, int]
) -> bool:
    """Return whether a reading outside a burst of an arm, near in depth and toolface, is as far off as the burst.

    It is if it differs from the middle of the burst by less than a quarter of the burst's height over the readings
    before and after.
    """
    first, last = burst
    begin = int(np.searchsorted(along, along[first] - _ELSEWHERE))
    end = int(np.searchsorted(along, along[last - 1] + _ELSEWHERE, side="right"))
    middle, angle = float(np.median(values[arm, first:last])), float(angles[arm, (first + last) // 2])
    base = np.concatenate([values[arm, max(first - 3, 0) : first], values[arm, last : last + 3]])
    height = abs(middle - float(np.nanmedian(base))) if np.isfinite(base).any() else 0.0
    half = 0.5 * np.minimum(ways, ways[arm])[:, None]
    off = np.abs((angles[:, begin:end] - angle + half) % (2.0 * half) - half)
    near = (off <= 15.0) & (np.abs(trusted[:, begin:end] - middle) < 0.25 * height)
    near[arm, first - begin : last - begin] = False
    return bool(near.any())


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
        rings = np.unique(self.ring[odd])
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
    count = values.shape[1]
    changed = np.ones(values.shape, dtype=bool)
    changed[:, 1:] = (values[:, 1:] != values[:, :-1]) & ~(np.isnan(values[:, 1:]) & np.isnan(values[:, :-1]))
    moves = np.zeros((len(values), count + 1), dtype=np.int64)
    np.cumsum(changed, axis=1, out=moves[:, 1:])
    total = moves.sum(axis=0)
    dropped, counts = np.zeros(values.shape, dtype=bool), {"stuck": 0, "dead": 0}
    for arm in range(len(values)):
        first = np.flatnonzero(changed[arm])
        last = np.append(first[1:], count)
        others = total - moves[arm]
        share = (others[last] - others[np.minimum(first + 1, last)]) / (
            (len(values) - 1) * np.maximum(last - first - 1, 1)
        )
        fault = (last - first >= rows) & (share >= moving)
        dropped[arm] = np.repeat(fault, last - first)
        silent = int(np.count_nonzero(dropped[arm] & np.isnan(values[arm])))
        counts["dead"] += silent
        counts["stuck"] += int(np.count_nonzero(dropped[arm])) - silent
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


def saturated(radius: npt.ArrayLike, depth: npt.ArrayLike) -> Step:
    """Drop the flat tops of an arm that has opened as far as it can: runs of rows at its largest reading.

    The largest reading is a limit of the arm if readings accumulate there: at least five times as many as in the 2 mm
    below it. If more than half of the readings are there, it is no limit, because in a pipe most readings are equal. A
    flat top has five readings or more in succession, over half a metre or more.

    Parameters
    ----------
    radius, depth
        Metres, (n,), in the order they were taken; NaN is missing.

    Returns
    -------
    Step
        ``settings["limit"]`` is the largest reading.
    """
    values = column("radius", radius)
    where = column("depth", depth, values.size, "radius")
    known = np.isfinite(values)
    limit = float(values[known].max()) if known.any() else np.nan
    top = known & (values >= limit - 1e-9)
    below = known & ~top & (values > limit - 0.002)
    dropped = np.zeros(values.size, dtype=bool)
    if 2 * np.count_nonzero(top) <= np.count_nonzero(known) and np.count_nonzero(top) >= 5 * np.count_nonzero(below):
        for first, last in _stretches(top, 5):
            dropped[first:last] = abs(where[last - 1] - where[first]) >= 0.5
    return Step("saturated", {"limit": limit}, dropped, {"at the limit": int(np.count_nonzero(dropped))})


def closed_stretches(readings: Readings) -> tuple[float, list[tuple[int, int, int, int]]]:
    """Find the runs of rows in which all arms stay closed, and the ramps on which they close before and open after.

    Each row counts by its largest radius. The closed radius is the least of these. If their median is not 10 mm larger,
    there is no stretch. A stretch has three rows or more within 2 mm of the closed radius, over 2 m or more, or 20 rows
    or more at one depth. On a ramp the radius grows from row to row, away from the closed stretch.

    Returns
    -------
    The closed radius, metres (NaN: there is no radius), and four row numbers for each stretch: where its first ramp
    begins, where the stretch begins and ends, and where its second ramp ends. Each end is the row after the last.
    """
    radii = np.stack(readings.radii)
    known = np.isfinite(radii).any(axis=0)
    if not known.any():
        return np.nan, []
    largest = np.where(known, np.nan_to_num(radii, nan=-np.inf).max(axis=0), np.nan)
    level = float(np.nanmin(largest))
    if np.nanmedian(largest) < level + 0.01:
        return level, []
    found = []
    for first, last in _stretches(known & (largest <= level + 0.002), 3):
        depth = readings.depth[first:last][np.isfinite(readings.depth[first:last])]
        length = float(np.ptp(depth)) if depth.size else 0.0
        if length < _CLOSED_LENGTH and not (last - first >= _CLOSED_ROWS and length <= _STANDING):
            continue
        begin, end = first, last
        while end < largest.size and largest[end] > largest[end - 1]:
            end += 1
        while begin > 0 and largest[begin - 1] > largest[begin]:
            begin -= 1
        found.append((begin, first, last, end))
    return level, found


def disagreements(readings: Readings) -> list[str]:
    """Return a sentence for each two calipers that look in the same direction and differ by over 2.5 mm of radius.

    Only runs of 10 rows or more count. Raises an InputError if a pair differs in at least half of the rows in
    which both have a radius.
    """
    place = [(sensor.mounting, sensor.offset) for sensor in readings.sensors]
    lines = {}
    for one in range(len(place)):
        for other in range(one):
            if readings.arm[one] == readings.arm[other] or place[one] != place[other]:
                continue
            names = " and ".join(readings.channels[int(readings.arm[number])] for number in (other, one))
            off = np.abs(readings.radii[one] - readings.radii[other])
            known = off[np.isfinite(off)]
            if known.size and np.median(known) > _APART:
                apart_by = f"{1e3 * np.median(known):.1f} mm of radius in half of the rows"
                rule = f"look in the same direction and differ by {apart_by}: name the caliper to use"
                raise InputError(f"{readings.name}: {names}", rule)
            found = _stretches(off > _APART, _ROWS_APART)
            if found:
                first, last = max(found, key=lambda ends: ends[1] - ends[0])
                lines[names] = (
                    f"{readings.name}: {names} look in the same direction and differ by more than "
                    f"{1e3 * _APART:.1f} mm of radius in "
                    f"{sum(last - first for first, last in found):,} rows, the longest stretch from "
                    f"{readings.depth[first]:.2f} to {readings.depth[last - 1]:.2f} m: name the caliper to use"
                )
    return list(lines.values())


def _stretches(mask: Mask, rows: int) -> list[tuple[int, int]]:
    """Return the runs of the mask, as `runs_of` does, that have at least ``rows`` rows."""
    return [(first, last) for first, last in runs_of(mask) if last - first >= rows]


def _table(name: str, columns: Sequence[npt.ArrayLike]) -> Floats:
    """Return columns of equal length as the rows of an array."""
    first = column(f"{name}[0]", columns[0])
    rest = [column(f"{name}[{i}]", columns[i], first.size, f"{name}[0]") for i in range(1, len(columns))]
    return np.stack([first, *rest])

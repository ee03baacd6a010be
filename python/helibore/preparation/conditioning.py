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
from helibore.base.arrays import Floats, Mask, column, whole_column
from helibore.base.errors import InputError


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
    six nearest in toolface are compared with the sample, but none farther than 20 degrees (with few samples in a turn:
    0.75 of the angle between two, at most 45 degrees). The sample is a spike if all of these hold::

        1  it lies beyond the second largest or second smallest of them by more than the tolerance plus a tenth of the
           difference of those two
        2  no sample next to its toolface in the turn before or after is within half the tolerance of it, and it is one
           of a burst: at most five samples side by side in its turn, no more than a third of the turn, that lie
           beyond their neighbours in this way. No sample beside the burst is within half the tolerance of its end,
           unless the first rule holds for that sample, too. A turn of at most five samples, such as a row of arms, may
           be a burst as a whole
        3  no sample confirms it: of the samples in its 10 degrees, more than three turns but at most 2 m away, the two
           nearest before and the two after it, by depth, differ by more than half the tolerance (with few samples in a
           turn: the four nearest differ by more than the tolerance)
        4  its turn is at most a metre long: in a longer one the tool slides, and its samples are not of one place

    The tolerance is ``threshold`` times a deviation. The deviation of a turn is 1.4826 times the median distance of its
    samples from the medians of their neighbours; each hundred turns use the median deviation of every fourth.

    Parameters
    ----------
    toolface, radius, turn
        Degrees, metres, and whole numbers in order of time, (n,). Samples with a NaN radius are kept and not counted.
    depth
        Metres, (n,), for the last two rules; None: they are left out.
    threshold
        The tolerance, in deviations.
    floor
        Least deviation, metres, also where the samples show less noise. Quantised radii need about one step, because
        their median distance is often 0.

    Returns
    -------
    Step
        ``unjudged`` counts samples with fewer than four neighbours in other turns that no sample next to their toolface
        in the turn before or after agrees with.

    Notes
    -----
    1.4826 = 1 / 0.6745, the quartile of the normal distribution.
    """
    angle = column("toolface", toolface)
    distance = column("radius", radius, angle.size, "toolface")
    number = whole_column("turn", turn, angle.size, "toolface")
    where = None if depth is None else column("depth", depth, angle.size, "toolface")
    found, unjudged = _core.find_spikes(angle, distance, number, where, threshold, floor)
    dropped = np.zeros(angle.size, dtype=bool)
    dropped[found] = True
    return Step("spikes", {"threshold": threshold, "floor": floor}, dropped, {"spike": found.size}, unjudged)


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

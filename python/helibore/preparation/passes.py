"""Several passes over one stretch of hole: which is which, which to use, and how two walls differ.

A tool that goes over a stretch more than once sees one wall, through three errors of its own::

    radius = wall(depth + shift[pass], toolface) + by_pass[pass] + by_arm[arm] + noise

``shifts`` finds the first, ``biases`` the other two. Not here: stretching of depths within a pass.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats, Integers, finite_column, whole_column
from helibore.base.errors import InputError
from helibore.preparation.conditioning import Step
from helibore.wall.points import evaluate
from helibore.wall.wall import Wall

__all__ = ["choose", "difference", "evaluate", "number_passes"]


def number_passes(depth: npt.ArrayLike, reversal: float = 5.0) -> Integers:
    """Number the passes: a new one begins where the tool turned and then went back by more than ``reversal``.

    Parameters
    ----------
    depth
        Metres, finite, in order of time, (n,).
    reversal
        Metres; smaller turns (heave, a stuck tool worked free) stay in their pass.

    Returns
    -------
    ndarray
        (n,) int64 from 0; the sample at a turning point, the last of equals, ends its pass.
    """
    track = finite_column("depth", depth)
    if not reversal > 0:
        raise InputError("reversal", "must be larger than 0", f"{reversal:g}")
    sign = 1 if _turn(track, 0, 1, reversal)[1] > _turn(track, 0, -1, reversal)[1] else -1  # 1: down at first
    begins, noticed = [0], 0
    while noticed < track.size:
        end, noticed = _turn(track, noticed, sign, reversal)
        begins.append(end + 1)
        sign = -sign
    return np.repeat(np.arange(len(begins) - 1), np.diff(begins))


def _turn(track: Floats, start: int, sign: int, reversal: float) -> tuple[int, int]:
    """Return where a pass that goes down (``sign`` 1) or up (-1) at ``start`` ends, and where that is noticed.

    The end is the last row of the greatest depth so far; it is noticed at the first row that lies more than
    ``reversal`` back from it. If none does: the last row, and the number of rows.
    """
    peak, end, rows = -np.inf, start, 1024
    while start < track.size:
        ahead = sign * track[start : start + rows]
        greatest = np.maximum.accumulate(np.maximum(ahead, peak))
        back = np.flatnonzero(greatest - ahead > reversal)
        count = back[0] + 1 if back.size else ahead.size
        at_peak = np.flatnonzero(ahead[:count] == greatest[count - 1])
        end = start + int(at_peak[-1]) if at_peak.size else end
        if back.size:
            return end, start + int(back[0])
        peak, start, rows = greatest[-1], start + rows, 2 * rows
    return track.size - 1, track.size


def choose(
    pass_number: npt.ArrayLike,
    depth: npt.ArrayLike,
    passes: Sequence[int] | None = None,
    *,
    latest: bool = False,
    cell: float = 0.5,
) -> Step:
    """Choose the passes a wall is built from: merged, or the latest that was there.

    Parameters
    ----------
    pass_number, depth
        Whole numbers and metres, (n,).
    passes
        Which to use, earliest first; None: all, by number. An unknown pass and one that is given twice are an error.
    latest
        In each ``cell`` metres of depth keep only the last of ``passes`` that has a sample there, reason ``replaced``.
    """
    number = whole_column("pass_number", pass_number)
    where = finite_column("depth", depth, number.size, "pass_number")
    if not cell > 0:
        raise InputError("cell", "must be larger than 0", f"{cell:g}")
    known, group = np.unique(number, return_inverse=True)
    order = known if passes is None else np.array(passes, dtype=np.int64)
    strange = np.setdiff1d(order, known)
    if strange.size:
        raise InputError("passes", f"{strange[0]} is not among the passes of the samples")
    if np.unique(order).size != order.size:
        raise InputError("passes", "must not hold one pass twice")
    rank_of = np.full(known.size, -1, dtype=np.int64)
    rank_of[np.searchsorted(known, order)] = np.arange(order.size)
    rank = rank_of[group]
    other = rank < 0
    replaced = np.zeros(number.size, dtype=bool)
    if latest:
        rows, row = np.unique(np.floor(where / cell), return_inverse=True)
        last = np.full(rows.size, -1, dtype=np.int64)
        np.maximum.at(last, row, rank)
        replaced = ~other & (rank < last[row])
    counts = {"not chosen": int(np.count_nonzero(other)), "replaced": int(np.count_nonzero(replaced))}
    settings = {"passes": order.size, "latest": int(latest), "cell": cell}
    return Step("passes", settings, other | replaced, counts)


def difference(before: Wall, after: Wall) -> Floats:
    """How much larger a wall is than an earlier one: an attribute of the later wall.

    Parameters
    ----------
    before, after
        Walls of one hole; their helices need not agree.

    Returns
    -------
    ndarray
        Radius of ``after`` less radius of ``before`` at every vertex of ``after``, (n,) m; positive where the hole has
        grown, NaN where either has no support.
    """
    return after.radius - evaluate(before, after.depth, after.toolface)

"""Several passes over one interval of hole: number them, choose those to use, and compare two walls.

A tool that passes an interval more than once measures one wall, with three errors::

    radius = wall(depth + shift[pass](depth), toolface) + by_pass[pass] + by_arm[arm] + noise

``shifts`` finds the first error, which may vary along the hole, and ``biases`` the other two.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from helibore import _core
from helibore.base.arrays import Floats, Integers, distinct, finite_column, runs_of, whole_column
from helibore.base.errors import InputError
from helibore.preparation.conditioning import Step
from helibore.samples.caliper import Caliper
from helibore.wall.points import evaluate
from helibore.wall.wall import Wall

ODD_ROWS = 3
"""Least number of successive rows in which a pass differs from the merged wall; a spike has fewer."""
ODD_RADIUS = 0.005
"""Least difference of an odd row from the merged wall, metres of radius (10 mm of diameter). The passes of a real X-Y
caliper differ from their merged wall by 1.3 mm over 3 rows."""
ODD_DEVIATIONS = 6.0
"""Least difference of an odd row, in robust deviations, so that a pass that differs everywhere (a shift) is not odd."""


def number_passes(depth: npt.ArrayLike, reversal: float = 5.0) -> Integers:
    """Number the passes; a new pass begins where the tool turns back and then moves back by more than ``reversal``.

    Parameters
    ----------
    depth
        Metres, finite, in order of time, (n,).
    reversal
        Metres; smaller turns (heave, a stuck tool worked free) stay in their pass.

    Returns
    -------
    ndarray
        (n,) int64 from 0. The sample at a turning point ends its pass; if several have the depth of the turning point,
        the last of them ends it.
    """
    track = finite_column("depth", depth)
    if not reversal > 0:
        raise InputError("reversal", "must be above 0", f"{reversal:g}", "preparation.reversal")
    return _core.number_passes(track, reversal)


def choose(
    pass_number: npt.ArrayLike,
    depth: npt.ArrayLike,
    passes: Sequence[int] | None = None,
    *,
    latest: bool = False,
    cell: float = 0.5,
) -> Step:
    """Choose the passes from which a wall is built: all their samples, or at each depth those of the latest pass only.

    Parameters
    ----------
    pass_number, depth
        Whole numbers and metres, (n,).
    passes
        The passes to use, earliest first; None: all, by number. An unknown pass or a pass given twice is an error.
    latest
        In each ``cell`` metres of depth keep only the last of ``passes`` that has a sample there, and drop the other
        passes as ``replaced``.
    """
    number = whole_column("pass_number", pass_number)
    where = finite_column("depth", depth, number.size, "pass_number")
    if not cell > 0:
        raise InputError("cell", "must be above 0", f"{cell:g}")
    known, group = np.unique(number, return_inverse=True)
    order = known if passes is None else np.array(passes, dtype=np.int64)
    strange = np.setdiff1d(order, known)
    if strange.size:
        rule = f"{strange[0]} is not among the passes of the samples"
        raise InputError("passes", rule, setting="preparation.passes")
    if distinct(order).size != order.size:
        raise InputError("passes", "must not hold the same pass twice", setting="preparation.passes")
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
    """Return how much larger a wall is than an earlier wall, metres, as an attribute of the later wall.

    Parameters
    ----------
    before, after
        Walls of one hole; their helices may differ.

    Returns
    -------
    ndarray
        Radius of ``after`` less radius of ``before`` at every vertex of ``after``, (n,) m; positive where the hole has
        grown, NaN where one of the walls has no radius.
    """
    return after.radius - evaluate(before, after.depth, after.toolface)


def odd_passes(wall: Wall, caliper: Caliper, pass_number: npt.ArrayLike, arm_names: Sequence[str] = ()) -> list[str]:
    """Return sentences on the places where a pass reads farthest below, and farthest above, the wall of all passes.

    The differences of each arm in each pass from the wall, less their median, are averaged by row. In a place that is
    reported, 3 rows or more in succession differ to one side by more than 5 mm and more than 6 robust deviations.

    Parameters
    ----------
    wall
        The wall made from the samples of all passes.
    caliper, pass_number
        The samples of this wall, and the pass of each sample, (n,).
    arm_names
        The name of each arm, by its number in ``caliper.arm``; empty: sentences do not name arms.

    Returns
    -------
    list
        A sentence on the place farthest below, and a sentence on the place farthest above, if there are such places.
    """
    number = whole_column("pass_number", pass_number, len(caliper), "caliper")
    passes = distinct(number)
    worst = {"less": (0.0, ""), "more": (0.0, "")}
    for one in passes if passes.size > 1 else ():
        of_pass = number == one
        for arm in (None,) if caliper.arm is None else distinct(caliper.arm[of_pass]).tolist():
            mine = np.flatnonzero(of_pass if arm is None else of_pass & (caliper.arm == arm))
            off = caliper.radius[mine] - evaluate(wall, caliper.depth[mine], caliper.toolface[mine])
            mine, off = mine[np.isfinite(off)], off[np.isfinite(off)]
            if not off.size:
                continue
            depth, row = np.unique(caliper.depth[mine], return_inverse=True)
            off = np.bincount(row, off - np.median(off)) / np.bincount(row)
            least = max(ODD_RADIUS, ODD_DEVIATIONS * 1.4826 * float(np.median(np.abs(off))))
            for sign, word in ((-1, "less"), (1, "more")):
                for first, stop in runs_of(sign * off > least):
                    most = float((sign * off[first:stop]).max())
                    if stop - first >= ODD_ROWS and most > worst[word][0]:
                        name = "" if arm is None or not arm_names else f" ({arm_names[arm]})"
                        sentence = (
                            f"pass {one}{name} reads up to {1e3 * most:.1f} mm {word} in radius than the merged wall, "
                            f"from {depth[first]:.2f} to {depth[stop - 1]:.2f} m in {stop - first} rows; "
                            f"preparation.passes={one} shows it"
                        )
                        worst[word] = most, sentence
    return [sentence for _, sentence in worst.values() if sentence]

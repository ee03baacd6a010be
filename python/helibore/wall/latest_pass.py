"""The wall as the last pass saw it: of hole that was scanned again and has changed, without the samples of before.

    samples, also of passes that the wall does not take
            -> row of 0.25 m -> its passes: the tool turned back, or came back -> median of the changes by direction
                                    |-> 1 mm and 3 standard errors: what the latest pass saw again is left out
    radii in order of time -> one value 50 times in a row: the sensor was stuck, and has measured nothing

A wall takes all samples of its passes. Where a hole was reamed between two passes, its radii lie between the sizes that
both saw, a reaming pass may have seen what the wall has not, and a stuck tool makes hole of one size. So whoever says
what passes now reads this.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from helibore import _core
from helibore.base.arrays import Floats, Integers, Mask, Rows, joined, runs_of
from helibore.samples.helix import whole_helix
from helibore.settings.wall_settings import Settings
from helibore.wall.state import WallState
from helibore.wall.wall import Wall

ROW, SECTORS = 0.25, 16
"""Metres of a row, and its directions; by more than a row the tool must move back for another pass."""
LEAST_SECTORS = 4
"""Directions that the latest pass and those before must have in common."""
CHANGED, ERRORS = 0.001, 3.0
"""Metres and standard errors by which the wall must have moved."""
STUCK, STUCK_ROUNDED, ROUNDED = 50, 600, 0.2
"""Equal radii in a row; the same if more than ROUNDED of all others repeat the one before, as rounded values do."""
MOST_SENSORS = 12
"""Samples at one time that are those of several sensors; more are those of one, sent together."""
BESIDE, AROUND = 1.0, 4.0
"""Metres from a sample that is left out within which the wall is drawn again, and within which samples count for it."""
SAMPLE = np.dtype([(name, np.float64) for name in ("depth", "toolface", "radius", "time")])
"""A sample of a pass that the wall does not take: metres, degrees, and the time as in the wall."""


def latest_pass(wall: WallState, was_stuck: bool = False, apart: Rows | None = None) -> WallState:
    """Return a wall whose samples have times without those of before the latest pass; of a stuck tool, if it ever was.

    Hole that is made up may have one radius, so only who watched the tool says that it ``was_stuck``. ``apart``:
    samples (`SAMPLE`) of passes that the wall does not take, which count as its own.
    """
    if len(wall.sample_columns) < 4 or not wall.sample_columns[0].size:
        return wall
    K, helix, columns = wall.settings.sectors, whole_helix(wall), wall.sample_columns
    added = np.zeros(columns[0].size, bool)
    if apart is not None and apart.size:
        top, bottom = helix.ends(wall.radius.size)
        apart = apart[(apart["depth"] > top) & (apart["depth"] < bottom)]
        both = [np.concatenate([own, apart[name]]) for own, name in zip(columns, SAMPLE.names or (), strict=True)]
        order = np.argsort(both[0], kind="stable")
        columns, added = tuple(of[order] for of in both), order >= added.size
    left_out = superseded(*columns)
    if was_stuck:
        left_out |= stuck(*columns)
    moves = left_out != added
    if not moves.any():
        return wall
    kept = tuple(column[~left_out] for column in columns)
    values: list[Any] = [wall.radius, wall.nearest, wall.support, wall.iterations, *wall.sums]
    drawn = [column.copy() for column in values]
    turns = np.floor((columns[0][moves] - helix.start_depth) / helix.pitch).astype(np.int64)
    beside, most = round(BESIDE / abs(helix.pitch)), wall.radius.size // K
    marks = np.zeros(max(most, 1), bool)
    marks[np.clip(turns, 0, most - 1)] = True
    for first, stop in joined(runs_of(marks), 2 * beside):
        first, stop = max(0, first - beside), min(most, stop + beside)
        part = _drawn_again(wall, kept, first, stop)
        for column, again in zip(drawn, part, strict=True):
            column[K * first : K * stop] = again
    radius, nearest, support, iterations, *sums = drawn
    ends = {"start_depth": helix.start_depth, "stop_depth": None, "stop_vertex": helix.first + wall.radius.size}
    settings = Settings(**(vars(wall.settings) | ends))  # whoever draws it again has as many vertices
    return replace(
        wall, settings=settings, sample_columns=kept, radius=radius, nearest=nearest, support=support,
        iterations=iterations, sums=tuple(sums),
    )  # fmt: skip


def _drawn_again(wall: WallState, columns: tuple[Floats, ...], first: int, stop: int) -> list[Any]:
    """Return radius, nearest, support, iterations and sums of some turns, drawn from these samples alone."""
    K, helix, depth = wall.settings.sectors, whole_helix(wall), columns[0]
    start = helix.start_depth + helix.pitch * first
    ends = sorted((start, start + helix.pitch * (stop - first)))
    near = (depth > ends[0] - AROUND) & (depth < ends[1] + AROUND)
    size = K * (stop - first)
    if not near.any():
        missing, none = np.full(size, np.nan), np.zeros(size, np.int32)
        return [missing, missing, none, none, *(missing for _ in wall.sums)]
    place = {"start_depth": start, "stop_depth": None, "first_vertex": 0, "stop_vertex": size, "direct": False}
    again = Wall(**(vars(wall.settings) | place))
    again.append(*(column[near] for column in columns))
    state = again._state()
    return [state.radius, state.nearest, state.support, state.iterations, *state.sums]


def superseded(depth: Floats, toolface: Floats, radius: Floats, time: Floats) -> Mask:
    """Return which samples a later pass of their row contradicts, where it measured that depth again."""
    row = np.floor(depth / ROW).astype(np.int64)
    by_time = np.argsort(time, kind="stable")
    passes = np.empty(len(depth), np.int64)
    passes[by_time] = _core.number_passes(depth[by_time], ROW)
    if not passes.any():
        return np.zeros(len(depth), bool)
    low, high = np.full(passes.max() + 1, np.inf), np.full(passes.max() + 1, -np.inf)
    np.minimum.at(low, passes, depth)
    np.maximum.at(high, passes, depth)
    order = np.lexsort((passes, row))
    changes = [np.diff(of[order], prepend=of[order[0]] - 1) != 0 for of in (row, passes)]
    begins = np.flatnonzero(changes[0] | changes[1])
    stops = np.append(begins[1:], len(order))
    of = row[order[begins]]
    last = np.flatnonzero(np.diff(of, append=of[-1] + 1) != 0)  # the latest pass of each row
    first = np.append(0, last[:-1] + 1)
    found = np.zeros(len(depth), bool)
    sector = np.floor(toolface % 360 / (360 / SECTORS)).astype(np.int64) % SECTORS
    for a, b in zip(first[first < last].tolist(), last[first < last].tolist(), strict=True):
        old, new = order[begins[a] : begins[b]], order[begins[b] : stops[b]]
        old = old[(depth[old] >= low[passes[new[0]]]) & (depth[old] <= high[passes[new[0]]])]
        if _differ(sector[old], radius[old], sector[new], radius[new]):
            found[old] = True
    return found


def _differ(old: Integers, before: Floats, new: Integers, now: Floats) -> bool:
    """Return whether the radii of two passes differ by more than their errors, in the median of the directions."""
    counts = [np.bincount(at, minlength=SECTORS) for at in (old, new)]
    both = np.minimum(*counts) > 0
    if np.count_nonzero(both) < LEAST_SECTORS:
        return False
    was, now = (
        np.bincount(at, of, SECTORS)[both] / n[both]
        for at, of, n in zip((old, new), (before, now), counts, strict=True)
    )
    moved = now - was
    error = 1.25 * float(np.std(moved)) / np.sqrt(moved.size)
    return bool(abs(np.median(moved)) > max(CHANGED, ERRORS * error))


def stuck(depth: Floats, _: Floats, radius: Floats, time: Floats) -> Mask:
    """Return which samples belong to so many equal radii in a row that the tool was stuck.

    Of sensors that send at one time, a value in a row is one that comes at each time.
    """
    times, at = np.unique(time, return_inverse=True)
    beside = radius.size / times.size
    by_time, by_value = np.lexsort((depth, time)), np.lexsort((at, radius))
    equal = np.diff(radius[by_time]) == 0
    again = (np.diff(radius[by_value]) == 0) & (np.diff(at[by_value]) <= 1)
    found = np.zeros(radius.size, bool)
    for order, repeats, many in ((by_time, equal, 1.0), (by_value, again, beside)):
        if many > MOST_SENSORS:
            continue
        runs = [(first, stop) for first, stop in runs_of(repeats) if stop - first + 1 >= STUCK]
        long = sum(stop - first for first, stop in runs)
        others = len(repeats) - long
        share = (np.count_nonzero(repeats) - long) / others if others > 0 else 1.0
        rounded = 1 - (1 - share) ** (1 / many) > ROUNDED
        for first, stop in runs:
            if stop - first + 1 >= (STUCK_ROUNDED if rounded else STUCK):
                found[order[first : stop + 1]] = True
    return found

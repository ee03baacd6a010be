"""Compare the samples of a caliper with what it measured at the same place before: another hole, a slipped depth.

    placed samples -> rows of 0.1 m x 16 sectors -> difference to what is around, and at least ten minutes old
                                                         |-> median of 50 samples: the wall is nearer, or farther
    mean radius of 120 rows, and the same of before -> correlation at -15 to 15 m: the depth slipped

Times are counted in steps of ten minutes, and a value of before is at least two steps old. So the result does not
depend on how the stream was cut into windows, and the samples of one pass over a place are not compared with each
other. Sectors count alike, so an eccentric tool changes nothing.
"""

from __future__ import annotations

import bisect
import math
from collections import deque
from collections.abc import Callable

import numpy as np

from helibore.base.arrays import Floats, Integers, Rows, distinct
from helibore.base.utc_time import SECOND

Passed = tuple[int, list[tuple[int, float]]]
Say = Callable[[int, str, str, bool], None]
"""Takes wall clock time, rule, text, and whether the rule's cause lasts; an empty text ends it."""

STEP = 600 * SECOND
"""Nanoseconds in a step of time."""
ROW, SECTORS, BLOCK = 0.1, 16, 100
"""Metres of a row, sectors of a row, and rows of a block of memory."""
AROUND = 2
"""Number of rows above and below whose values of before count for a place, in its sector and the two beside it."""
MOST_IN_ROW = 64
"""Number of samples of one pass over a row that are compared; later ones are only remembered."""
ROWS, DISTINCT, SAMPLES, LEAST_SECTORS = 60, 20, 50, 8
"""Latest rows that are kept; how many, and how many samples, are compared together; sectors that must have samples."""
ERRORS = 2.0
"""Standard errors of the median over sectors by which it must be beyond a limit: an eccentric tool spreads sectors."""
NEARER, FARTHER = -0.0045, 0.006
"""Metres by which the wall must have moved."""
OFTEN = 5
"""Number of new rows after which sizes are compared again."""
PROFILE, LAGS, LEAST_LAG, EVERY = 120, 150, 5, 10
"""Rows of a profile; rows by which it is shifted at most and at least; number of new rows until the next try."""
SMOOTH = 2 * AROUND + 1
"""Number of rows of which a profile takes the mean."""
FITS, DOES_NOT, RELIEF = 0.82, 0.35, 0.0007
"""Correlation at the best lag, correlation without a lag; least standard deviation of a profile, metres."""
NEARER_ROWS = 0.15
"""Share of the rows of a profile that must be nearer than before, by half of its relief: a hole that grew has none."""
TRIES, SAME_LAG = 4, 3
"""Number of tries in a row that must find one lag, within this many rows."""
OF_WALL = "another_hole", "wall_nearer", "wall_farther", "depth_slipped"
"""The rules of this file."""
CELL = np.dtype([("at", "i4", (3,)), ("sum", "f8"), ("count", "i4"), ("value", "f4", (2,))])
"""Three latest steps with samples, the newest first; sum and number of the newest; means of the two before it."""


class WallMemory:
    """What one caliper measured, by place and step of time, and the comparison of its new samples with that.

    Attributes
    ----------
    passed
        The latest rows: number, and of each compared sample the sector and the difference.
    """

    STATE = (
        "_blocks",
        "passed",
        "_profile",
        "_row",
        "_sum",
        "_count",
        "_found",
        "_step",
        "_lasts",
        "_since",
        "_slipped",
        "_lags",
    )

    def __init__(self) -> None:
        self._blocks: dict[int, Rows] = {}
        self.passed: deque[Passed] = deque(maxlen=ROWS)
        self._profile: deque[tuple[int, float]] = deque(maxlen=PROFILE)
        self._row, self._sum, self._count = 0, 0.0, 0
        self._found: list[tuple[int, float]] = []
        self._step = 0
        self._lasts = ""
        self._since = 0
        self._slipped = False
        self._lags: list[int] = []
        self._cache: dict[int, Floats] = {}  # values of before, by row: they stay for a step of time

    def begin_hole(self, kickoff: float | None) -> None:
        """Forget what was measured below ``kickoff``, or everywhere if it is None."""
        first = 0 if kickoff is None else math.floor(kickoff / ROW)
        self._blocks = {} if kickoff is None else {at: of for at, of in self._blocks.items() if at * BLOCK <= first}
        if (last := self._blocks.get(first // BLOCK)) is not None:
            last[first % BLOCK :] = np.zeros(1, CELL)
        self.passed.clear()
        self._profile.clear()
        self._found, self._lags, self._sum, self._count = [], [], 0.0, 0
        self._lasts, self._slipped, self._cache = "", False, {}

    def take(self, columns: tuple[Integers, Integers, Floats, Floats, Floats], fell: list[int], say: Say) -> None:
        """Take samples in order of arrival: wall clock time, model time, depth, toolface and radius.

        ``fell`` has the model times at which the hole depth fell and at which it had its old value again, in turn.
        """
        wall, time, depth, toolface, radius = columns
        steps = np.maximum.accumulate(np.maximum(time // STEP, self._step))
        rows = np.floor(depth / ROW).astype(np.int64)
        sectors = np.floor(toolface % 360 / (360 / SECTORS)).astype(np.int64) % SECTORS
        cuts = np.flatnonzero((np.diff(rows) != 0) | (np.diff(steps) != 0)) + 1
        for start, stop in zip([0, *cuts.tolist()], [*cuts.tolist(), len(rows)], strict=True):
            row = int(rows[start])
            if steps[start] != self._step:
                self._step, self._cache = int(steps[start]), {}
            if row != self._row and self._count:
                self._pass_row(int(wall[start]), int(time[start]), fell, say)
            self._row = row
            before = self._before(row, row + 1)[0]
            self._remember(row, self._step, sectors[start:stop], radius[start:stop])
            for value in radius[start:stop].tolist():  # one by one: the sum must not depend on windows
                self._sum += value
            self._count += stop - start
            rest = slice(start, min(stop, start + MOST_IN_ROW - len(self._found)))
            pairs = zip(sectors[rest].tolist(), (radius[rest] - before[sectors[rest]]).tolist(), strict=True)
            self._found += [(sector, moved) for sector, moved in pairs if moved == moved]

    def _cells(self, row: int) -> Rows:
        block = self._blocks.get(row // BLOCK)
        if block is None:
            block = self._blocks[row // BLOCK] = np.zeros((BLOCK, SECTORS), CELL)
        cells: Rows = block[row % BLOCK]
        return cells

    def _before(self, first: int, stop: int) -> Floats:
        """Return for each row from ``first`` to ``stop`` and each sector the mean of the values of before around it."""
        rows = np.stack([self._old(one) for one in range(first - AROUND, stop + AROUND)])
        known = np.isfinite(rows)
        sums = []
        for values in (known.astype(float), np.where(known, rows, 0.0)):
            beside = values + np.roll(values, 1, axis=1) + np.roll(values, -1, axis=1)
            sums.append(sum(beside[shift : shift + stop - first] for shift in range(2 * AROUND + 1)))
        count, total = sums
        return np.where(count > 0, total / np.maximum(count, 1), np.nan)

    def _old(self, row: int) -> Floats:
        """Return for each sector of a row the mean of the latest step that is at least two steps old, or NaN."""
        if (found := self._cache.get(row)) is not None:
            return found
        found = np.full(SECTORS, np.nan)
        if row // BLOCK in self._blocks:
            cells = self._blocks[row // BLOCK][row % BLOCK]
            at = cells["at"]
            values = np.column_stack([cells["sum"] / np.maximum(cells["count"], 1), cells["value"]])
            known = (at > 0) & (at <= self._step - 2)
            newest = values[np.arange(SECTORS), known.argmax(axis=1)]
            found = np.where(known.any(axis=1), newest, np.nan)
        self._cache[row] = found
        return found

    def _remember(self, row: int, step: int, sectors: Integers, radius: Floats) -> None:
        cells = self._cells(row)
        new = distinct(sectors)
        new = new[cells["at"][new, 0] != step]
        cells["value"][new, 1] = cells["value"][new, 0]
        cells["value"][new, 0] = cells["sum"][new] / np.maximum(cells["count"][new], 1)
        cells["at"][new, 1:] = cells["at"][new, :2]
        cells["at"][new, 0] = step
        cells["sum"][new] = cells["count"][new] = 0
        np.add.at(cells["sum"], sectors, radius)
        np.add.at(cells["count"], sectors, 1)

    def _pass_row(self, wall: int, time: int, fell: list[int], say: Say) -> None:
        """End the pass over a row and judge the latest rows."""
        self.passed.append((self._row, self._found))
        if self._found:
            self._profile.append((self._row, self._sum / self._count))
        self._sum, self._count, self._found = 0.0, 0, []
        self._since += 1
        if self._since % OFTEN == 0 and (rows := self._latest()):
            self._judge_size(wall, rows, bisect.bisect_right(fell, time) % 2 == 1, say)
        if self._since % EVERY == 0 and len(self._profile) == PROFILE and not self._lasts:
            self._judge_depth(wall, say)

    def _latest(self) -> list[Passed]:
        """Return as many of the latest rows as have DISTINCT numbers and SAMPLES; none if there are too few."""
        rows: list[Passed] = []
        numbers, samples = set[int](), 0
        for row, found in reversed(self.passed):
            if found:
                rows.append((row, found))
                numbers.add(row)
                samples += len(found)
            if len(numbers) >= DISTINCT and samples >= SAMPLES:
                return rows
        return []

    def _judge_size(self, wall: int, rows: list[Passed], fallen: bool, say: Say) -> None:
        """Compare the median over sectors of the median difference in each sector with the limits."""
        by_sector: dict[int, list[float]] = {}
        for _, found in rows:
            for sector, moved in found:
                by_sector.setdefault(sector, []).append(moved)
        if len(by_sector) < LEAST_SECTORS:
            return
        medians = [float(np.median(values)) for values in by_sector.values()]
        moved, error = float(np.median(medians)), 1.25 * float(np.std(medians)) / math.sqrt(len(medians))
        if NEARER / 2 < moved < FARTHER / 2 and self._lasts:
            say(wall, self._lasts, "", False)
            self._lasts = ""
            self._profile.clear()  # it holds rows of both sizes
        nearer = moved < 0
        if self._lasts or NEARER - ERRORS * error <= moved <= FARTHER + ERRORS * error:
            return
        samples, numbers = sum(map(len, by_sector.values())), [row for row, _ in rows]
        span = f"from {min(numbers) * ROW:.1f} to {(max(numbers) + 1) * ROW:.1f} m"
        what = f"the wall {span} is {1e3 * abs(moved):.1f} mm {'nearer' if nearer else 'farther'} than it was"
        evidence = f"{what}, in the median of {samples} samples in {len(by_sector)} of {SECTORS} directions"
        if fallen:
            self._lasts = "another_hole"
            cause = "the hole depth fell before: this is another hole; set hole.name and hole.kickoff"
        elif nearer:
            self._lasts = "wall_nearer"
            cause = (
                "another hole (hole.name), a slipped depth (hole.shift), or other settings of the sensor (measures, "
                "radius_unit); or the formation creeps, and nothing is wrong"
            )
        else:
            self._lasts = "wall_farther"
            cause = "it washed out or was reamed wider; or this is another hole (hole.name)"
        say(wall, self._lasts, f"{evidence}: {cause}", self._lasts != "wall_farther")

    def _judge_depth(self, wall: int, say: Say) -> None:
        """Find the shift of depth at which the profile of the latest rows fits what was there before."""
        new = dict(self._profile)  # of a row that was passed twice, the latest
        numbers = np.array(sorted(new))
        if len(numbers) < PROFILE * 2 // 3 or numbers[-1] - numbers[0] > 4 * PROFILE:
            return
        radius = np.convolve([new[row] for row in numbers.tolist()], np.ones(SMOOTH) / SMOOTH, "valid")
        numbers = numbers[SMOOTH // 2 : -(SMOOTH // 2)]
        before = self._means(numbers)
        here = _correlation(radius, before)
        if here > FITS and self._slipped:
            self._slipped = False
            say(wall, "depth_slipped", "", False)
        nearer = np.count_nonzero(radius - before < -radius.std() / 2)
        if self._slipped or not here < DOES_NOT or nearer < NEARER_ROWS * len(radius):
            self._lags = []
            return
        first = int(numbers[0]) - LAGS
        old = self._means(np.arange(first, int(numbers[-1]) + LAGS + 1))
        fits = np.array([_correlation(radius, old[numbers - first + lag]) for lag in range(-LAGS, LAGS + 1)])
        best = int(np.nanargmax(fits))
        there, lag = float(fits[best]), best - LAGS
        if there <= FITS or abs(lag) < LEAST_LAG:
            self._lags = []
            return
        self._lags = [*self._lags, lag]
        self._lags = self._lags if max(self._lags) - min(self._lags) <= SAME_LAG else [lag]
        if len(self._lags) == TRIES:
            self._slipped = True
            text = (
                f"the wall from {numbers[0] * ROW:.1f} to {(numbers[-1] + 1) * ROW:.1f} m fits what was measured "
                f"before {lag * ROW:+.1f} m from there (correlation {there:.2f}; {here:.2f} where it is drawn): the "
                f"depth slipped; or the hole repeats itself; add {lag * ROW:+.1f} m to hole.shift, or correct the depth"
            )
            say(wall, "depth_slipped", text, True)

    def _means(self, numbers: Integers) -> Floats:
        """Return the mean radius of before of each row; NaN of a row with too few sectors."""
        first = int(numbers[0])
        values = self._before(first, int(numbers[-1]) + 1)[numbers - first]
        known = np.isfinite(values)
        count = known.sum(axis=1)
        mean = np.where(known, values, 0.0).sum(axis=1) / np.maximum(count, 1)
        return np.where(count >= LEAST_SECTORS, mean, np.nan)


def _correlation(new: Floats, old: Floats) -> float:
    """Return the correlation of two profiles; NaN if too little of the old one is known or it has no relief."""
    known = np.isfinite(old)
    if np.count_nonzero(known) < len(new) * 0.8:
        return math.nan
    new, old = new[known] - new[known].mean(), old[known] - old[known].mean()
    sizes = float(np.sqrt(np.mean(new * new))), float(np.sqrt(np.mean(old * old)))
    return float(np.mean(new * old)) / (sizes[0] * sizes[1]) if min(sizes) > RELIEF else math.nan

"""Named intervals of a hole, such as formations, and what a wall measures in each.

    wall.intervals = hb.read_intervals("tops.csv")     a formation reaches from its top to the next top
    wall.interval_table().save("formations.csv")       a row a formation, with the numbers of `Wall.summary`

Archives keep the intervals; prints, reports and the viewer's page show them: formations by their tops across all
tracks, the others in the track that they name, casings to scale.
"""

from __future__ import annotations

import csv
import io
import math
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from helibore.base import units
from helibore.base.atomic_file import write_whole
from helibore.base.decimals import DECIMALS
from helibore.base.errors import InputError, check_ending
from helibore.base.harmless import HIDDEN, cell, printable
from helibore.logs.summary import WallSummary, summarize
from helibore.logs.zones import KINDS, Classification
from helibore.samples.helix import WallLike, helix_of

LONGEST_NAME = 400
MOST = 10_000
"""Most intervals of a wall."""
WIDEST = 2.0
"""Metres: an outer diameter is at most this wide."""
CASING = "Casing"
"""Name of the track of casings."""


@dataclass(frozen=True)
class Interval:
    """A named interval of a hole: a formation from its top to the next, a section, a perforated interval.

    Attributes
    ----------
    name
        At most 400 characters: a formation, a casing, or what a mud log says.
    start, stop
        Measured depths, metres. ``stop`` is infinite where no deeper top is known.
    track
        Name of the track that shows it, such as ``"Casing"`` or ``"Lithology"``; "": a formation.
    diameter
        Outer diameter, metres, of a casing or another pipe, whose shoe is at ``stop``. None: it is no pipe.
    """

    name: str
    start: float
    stop: float = math.inf
    track: str = ""
    diameter: float | None = None

    def __post_init__(self) -> None:
        for part, least in (("name", 1), ("track", 0)):
            text = getattr(self, part)
            if not isinstance(text, str) or not least <= len(text.strip()) <= LONGEST_NAME:
                raise InputError(part, f"must be a text of {least} to {LONGEST_NAME} characters", repr(text))
            if HIDDEN.search(text):
                rule = "must not hold control characters, marks that turn text around or halves of surrogate pairs"
                raise InputError(part, rule, printable(text))
        for end in ("start", "stop"):
            vars(self)[end] = float(getattr(self, end))
        if not (math.isfinite(self.start) and self.start <= self.stop):
            rule = "start must be finite, and stop not above it"
            raise InputError(f"interval {self.name!r}", rule, f"{self.start:g} to {self.stop:g} m")
        if self.diameter is not None:
            if not self.track:
                raise InputError(f"interval {self.name!r}", "track must be given for a pipe, such as 'Casing'")
            vars(self)["diameter"] = float(self.diameter)
            if not 0 < self.diameter <= WIDEST:
                rule = f"diameter must be above 0 and at most {WIDEST:g} m"
                raise InputError(f"interval {self.name!r}", rule, f"{self.diameter:g} m")

    def as_row(self) -> list[str | float | None]:
        """Return name, start and stop as JSON can hold them; of a casing or a mud log track and diameter follow."""
        row: list[str | float | None] = [self.name, self.start, None if math.isinf(self.stop) else self.stop]
        return [*row, self.track, *([] if self.diameter is None else [self.diameter])] if self.track else row


def tracks_of(intervals: Iterable[Interval]) -> dict[str, list[Interval]]:
    """Return the intervals by the name of their track, in the order of the depths at which the tracks begin."""
    found: dict[str, list[Interval]] = {}
    for one in intervals:
        found.setdefault(one.track, []).append(one)
    return found


def outside_text(intervals: Sequence[Interval], top: float, bottom: float) -> str:
    """Return in words how many intervals lie outside the part of a hole that is shown; "" if all lie inside."""
    outside = sum(one.stop <= top or one.start >= bottom for one in intervals)
    if not outside:
        return ""
    if outside < len(intervals):
        return f"{outside} of {len(intervals)} outside {top:.0f} to {bottom:.0f} m"
    return f"none of {len(intervals)} within {top:.0f} to {bottom:.0f} m: is their unit right?"


def checked_intervals(intervals: Iterable[Interval]) -> tuple[Interval, ...]:
    """Return intervals sorted by depth; refuse any other value."""
    if isinstance(intervals, str) or not isinstance(intervals, Iterable):
        raise InputError("intervals", "must be a list of Interval", type(intervals).__name__)
    found = tuple(intervals)
    for number, one in enumerate(found):
        if not isinstance(one, Interval):
            raise InputError(f"intervals[{number}]", "must be an Interval", type(one).__name__)
    if len(found) > MOST:
        raise InputError("intervals", f"must be at most {MOST}", str(len(found)))
    return tuple(sorted(found, key=lambda one: (one.start, one.stop)))


class IntervalRow(NamedTuple):
    """What a wall measures in an interval.

    Attributes
    ----------
    interval
        The interval.
    summary
        Numbers of the part of it that the wall reaches; None if the wall reaches no part.
    volume_sigma
        Upper limit of the standard uncertainty of the volume, m3: the sum of those of the turns. NaN if not known.
    """

    interval: Interval
    summary: WallSummary | None
    volume_sigma: float


@dataclass(frozen=True)
class IntervalTable:
    """What a wall measures in each of its intervals; made by `Wall.interval_table`.

    Attributes
    ----------
    intervals
        A row for each interval, by depth: ``interval``, ``summary`` and ``volume_sigma``.
    """

    intervals: tuple[IntervalRow, ...]

    def rows(self, unit: str = "m") -> list[list[str]]:
        """Return rows of text, of which the first has the names of the columns.

        Parameters
        ----------
        unit
            Of diameters: ``"m"``, ``"mm"`` or ``"in"``; ``"ft"``: inches, and feet for depths. Volumes are m3.
        """
        across, along = ("in", "ft") if unit == "ft" else (unit, "m")
        head = [
            "INTERVAL", f"TOP ({along})", f"BOTTOM ({along})", f"LOGGED ({along})", f"DMEAN ({across})",
            f"DLEAST ({across})", f"DGREATEST ({across})", f"DINSC ({across})", "VOL (m3)", "VOL_SIGMA (m3)",
            "EXCESS (%)", "COVER (%)", *(f"{kind.upper().replace(' ', '_')} ({along})" for kind in KINDS[1:]),
        ]  # fmt: skip

        def length(value: float, to: str, decimals: int = 2) -> str:
            return _text(value / units.factor(to, units.LENGTH), decimals)

        rows = [head]
        for of, found, sigma in self.intervals:
            row = [cell(of.name), length(of.start, along), length(of.stop, along)]
            if found is None:
                rows.append([*row, "0.00", *[""] * (len(head) - 4)])
                continue
            sizes = (
                found.mean_diameter, found.least_diameter.value, found.greatest_diameter.value,
                found.inscribed_diameter.value,
            )  # fmt: skip
            whole = found.whole_turns > 0
            row.append(length(found.whole_turns + found.incomplete_turns, along))
            row += [length(size, across, DECIMALS[across]) for size in sizes]
            row += [_text(found.volume if whole else math.nan, 4), _text(sigma, 4), _text(100 * found.excess, 2)]
            row.append(_text(100 * found.coverage, 1))
            shaped = found.basis == "azimuthal"
            row += [length(found.kinds.get(kind, 0.0), along) if shaped else "" for kind in KINDS[1:]]
            rows.append(row)
        return rows

    def save(self, filename: str | os.PathLike[str], unit: str = "m") -> None:
        """Write `rows` to a CSV file, whole or not at all; ``filename`` ends in .csv, ``unit`` is that of `rows`."""
        check_ending(filename, (".csv",))
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerows(self.rows(unit))
        write_whole(filename, lambda file: file.write(text.getvalue().encode()))


def _text(value: float, decimals: int) -> str:
    return f"{value:.{decimals}f}" if math.isfinite(value) else ""


def interval_table(wall: WallLike, intervals: Sequence[Interval], zones: Classification) -> IntervalTable:
    """Return what a wall measures in each formation, as `Wall.interval_table` does; ``zones`` are those of the wall."""
    logs = zones.logs
    top, bottom = helix_of(wall).ends(len(wall.radius)) if len(wall.radius) else (math.nan, math.nan)
    rows = []
    for one in checked_intervals(one for one in intervals if not one.track):
        start, stop = max(one.start, top), min(one.stop, bottom)
        if not start < stop:
            rows.append(IntervalRow(one, None, math.nan))
            continue
        found = summarize(wall, start, stop, zones=zones)
        uncertain = logs.volume_sigma[logs.rows_between(start, stop)]
        rows.append(IntervalRow(one, found, float(uncertain.sum()) if uncertain.size else math.nan))
    return IntervalTable(tuple(rows))

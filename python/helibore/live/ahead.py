"""What lies ahead of the bit while the string is tripped: the nearest place that a body at the bit does not pass.

    bit moves up       |ahead|     from 2010.3 to 2012.1 m a body of 0.3 m with 207.1 mm passes
                   ----#-------bit   "tight hole 8.2 m above the bit"

The body is rigid and straight, and its lower end is the bit. Its greatest diameter is that of `Wall.drift`, of the part
of the wall that lies ahead; hole that is not sampled counts as open. So what is said to be tight is tight, whatever
lies between the samples, also where a telemetry tool measured only a few places of each turn.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace

import numpy as np

from helibore.live.live import Live
from helibore.logs.passage import drift_of
from helibore.samples.helix import helix_of
from helibore.wall.state import WallState
from helibore.wall.wall_columns import NEAR_DEPTH

MOVED = 1.0
"""Metres that the bit must move in one direction until what lies there is looked at."""
SHARE = 20.0
"""Looking takes at most one part in so many of the time."""


@dataclass(frozen=True)
class TightAhead:
    """Tight hole ahead of the bit.

    Attributes
    ----------
    distance
        Metres from the bit to it; 0: the bit is in it.
    above
        Whether it is above the bit: the string is pulled out.
    top, bottom, diameter
        Its ends, and the greatest diameter of a body that passes all of it, metres.
    text
        All of it in words.
    """

    distance: float
    above: bool
    top: float
    bottom: float
    diameter: float
    text: str

    def meets(self, other: TightAhead) -> bool:
        """Return whether ``other`` is the same tight hole, as the bit comes nearer to it."""
        return self.top < other.bottom and other.top < self.bottom


class Ahead:
    """Looks ahead of the bit of a live wall; `look` is called a few times a second."""

    def __init__(self, live: Live) -> None:
        self._live = live
        self._from, self._up = math.nan, False  # where the bit turned round last, and whether it moves up
        self._moves = False
        self._due = 0.0
        self.found: TightAhead | None = None

    def look(self) -> TightAhead | None:
        """Return what is tight ahead; None if nothing is, if the bit is on bottom, or if it has not moved yet."""
        model, limits = self._live.model, self._live.configuration.alarms
        bit = model.rig.tracks["bit_depth"].value[-1:].tolist()
        if not bit or limits.tight is None or not limits.ahead or model.rig.on_bottom:
            self._from, self._moves, self.found = math.nan, False, None
            return None
        self._follow(bit[0])
        if not self._moves:
            self.found = None
        elif time.monotonic() >= self._due:
            began = time.monotonic()
            self.found = self._tight(bit[0], limits.ahead, limits.body, limits.tight)
            self._due = time.monotonic() + SHARE * (time.monotonic() - began)
        return self.found

    def _follow(self, bit: float) -> None:
        """Find out in which direction the bit has moved by MOVED."""
        if self._from != self._from:
            self._from = bit
        up = bit < self._from
        if self._moves and up == self._up:
            self._from = bit  # the farthest place in this direction
        elif abs(bit - self._from) >= MOVED:
            self._moves, self._up, self._from, self.found = True, up, bit, None
            self._due = 0.0

    def _tight(self, bit: float, ahead: float, body: float, tight: float) -> TightAhead | None:
        ends = (bit - ahead - body, bit + body) if self._up else (bit - 2 * body, bit + ahead + body)
        stretch = self._stretch(*ends)
        if stretch is None or len(stretch.radius) < stretch.settings.sectors:
            return None
        height = len(stretch.radius) // stretch.settings.sectors * abs(stretch.settings.pitch)
        if body > height:
            return None
        drift = drift_of(stretch, body, upper_limit=True)
        limit = self._live.model.configuration.wall["bit_diameter"] - tight
        nearest = None
        for spot in drift.tight(limit):
            top, bottom = sorted((spot.start + body / 2, spot.stop - body / 2))  # of what is in the body's way
            near, far = (bit - bottom, bit - top) if self._up else (top - bit, bottom - bit)
            if far > 0 and (nearest is None or near < nearest[0]):
                nearest = near, top, bottom, spot.least
        if nearest is None:
            return None
        distance, top, bottom, least = max(nearest[0], 0.0), *nearest[1:]
        where = f"{distance:.1f} m {'above' if self._up else 'below'} the bit" if distance else "at the bit"
        size = f"a body of {body:g} m at the bit with more than {1e3 * least:.1f} mm does not pass"
        bit_size = f"bit {1e3 * (limit + tight):.1f} mm"
        text = f"tight hole {where}: from {top:.1f} to {bottom:.1f} m {size} ({bit_size})"
        return TightAhead(round(distance, 2), self._up, round(top, 2), round(bottom, 2), round(least, 4), text)

    def _stretch(self, top: float, bottom: float) -> WallState | None:
        """Return the whole turns of the wall between two depths, with the samples that decide what is sampled there."""
        wall = self._live.wall._state()
        count = wall.radius.size
        helix = helix_of(wall)
        part = helix.between(top, bottom, count)
        first, stop = (-(-end // helix.sectors) * helix.sectors for end in (part.start, part.stop))
        stop = min(stop, count // helix.sectors * helix.sectors)
        if stop <= first:
            return None
        depth, reach = wall.sample_columns[0], max(NEAR_DEPTH, wall.settings.gap_reach)
        near = slice(*np.searchsorted(depth, (top - reach, bottom + reach)).tolist())  # samples are sorted by depth
        path = self._live.model.stations.reaching(bottom)
        start = float(wall.start_depth) + first * helix.pitch / helix.sectors
        path = path if path is not None and path.start_depth <= min(top, start) else None
        return replace(
            wall,
            settings=replace(wall.settings, start_depth=start),
            start_depth=start,
            radius=wall.radius[first:stop],
            nearest=wall.nearest[first:stop],
            support=wall.support[first:stop],
            iterations=wall.iterations[first:stop],
            sample_columns=tuple(column[near] for column in wall.sample_columns),
            path=path,
            sums=(),
        )

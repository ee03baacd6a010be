"""What lies ahead of the bit while the string is tripped: the nearest place that the string does not pass.

    bit moves up       |ahead|     from 2010.3 to 2012.1 m the stabiliser does not pass
                   ----#------[stabiliser]------bit    "8.2 m", so far the bit moves until it sticks

The string is that of the configuration or, without one, a body as wide as the bit whose lower end is the bit. It is
rigid and straight. Its clearance is that of `Wall.passage`, in the part of the wall that lies ahead; hole that is not
sampled counts as open. So what is said to be tight is tight, whatever lies between the samples, also where a telemetry
tool measured only a few places of each turn.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace

import numpy as np

from helibore.base.arrays import Integers, runs_of
from helibore.live.live import Live
from helibore.live.rules.configuration import AlarmLimits
from helibore.logs.passage import Passage, passage_of
from helibore.settings.output_settings import RigidBody
from helibore.wall.state import WallState
from helibore.wall.wall_columns import NEAR_DEPTH

MOVED = 0.5
"""Metres that the bit must move in one direction until what lies there is looked at."""
SHARE, SHARE_ON_BOTTOM = 20.0, 100.0
"""Looking takes at most one part in so many of a processor's time, for a tripped bit and for one on bottom."""


@dataclass(frozen=True)
class TightAhead:
    """Tight hole ahead of the bit; while the bit is on bottom, on its way out.

    Attributes
    ----------
    sticks_at
        Depth of the bit at which the string sticks, metres.
    above
        Whether the bit moves up: the string is pulled out.
    top, bottom
        Its ends, metres.
    body
        The body that sticks first: "bit", its name, or its number.
    diameter, needed
        The greatest diameter of this body that would pass, and its own, metres.
    places
        The number of tight places ahead.
    worst
        Ends, metres, and how much too thick the string is, at the tightest of these; None if it is this one.
    tightest
        Of this place and of the worst, if it is another: the depth of the bit at which the string is tightest there,
        metres, and the number of the body that sticks.
    moving
        Whether the bit is tripped; it is on bottom otherwise.
    text
        This place in words, without what changes as the bit comes nearer.
    """

    sticks_at: float
    above: bool
    top: float
    bottom: float
    body: str
    diameter: float
    needed: float
    text: str
    places: int = 1
    worst: tuple[float, float, float] | None = None
    tightest: tuple[tuple[float, int], ...] = ()
    moving: bool = True

    def meets(self, other: TightAhead) -> bool:
        """Return whether ``other`` is the same tight hole, as the bit comes nearer to it."""
        return self.top <= other.bottom and other.top <= self.bottom


class Ahead:
    """Looks ahead of the bit of a live wall; `look` is called a few times a second."""

    def __init__(self, live: Live) -> None:
        self._live = live
        self._from, self._up = math.nan, False  # where the bit turned round last, and whether it moves up
        self._moves = False
        self._due = 0.0
        self.found: TightAhead | None = None

    def look(self) -> TightAhead | None:
        """Return what is tight ahead; None if nothing is, if the bit is on bottom, or if it has not moved yet.

        Of a bit on bottom, `found` has what is tight on its way out.
        """
        model, limits = self._live.model, self._live.configuration.alarms
        bit = model.rig.tracks["bit_depth"].value[-1:].tolist()
        if not bit or limits.tight is None or not limits.ahead:
            self._from, self._moves, self.found = math.nan, False, None
            return None
        if on_bottom := model.rig.on_bottom:
            self._from, self._moves, self._up = math.nan, False, True
        else:
            self._follow(bit[0])
        if (self._moves or on_bottom) and time.monotonic() >= self._due:
            began = time.thread_time()
            self.found = self._tight(bit[0], limits)
            self._due = time.monotonic() + (SHARE_ON_BOTTOM if on_bottom else SHARE) * (time.thread_time() - began)
        return self.found if self._moves else None

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

    def _tight(self, bit: float, limits: AlarmLimits) -> TightAhead | None:
        configuration = self._live.model.configuration
        size, ahead, tight = configuration.wall["bit_diameter"], limits.ahead or 0.0, limits.tight or 0.0
        string = configuration.string or (RigidBody(size, limits.body),)
        # A body is tight where the hole is less than the bit by the limit. It begins to stick where it touches. This is
        # looked for up to half of the limit, since in a hole as wide as the bit noise of the samples is not tight.
        thin, touching = (
            [replace(body, diameter=max(0.0, min(body.diameter, size - least))) for body in string]
            for least in (tight, 0.5 * tight)
        )
        length = max(body.position + body.length for body in string)
        above, below = (ahead, 0.0) if self._up else (0.0, ahead)
        stretch = self._stretch(bit - above - length, bit + below, length)
        if stretch is None:
            return None
        found = passage_of(stretch, thin, upper_limit=True)
        lower = found.depth + length / 2
        travel = bit - lower if self._up else lower - bit
        order = np.argsort(travel, kind="stable")  # from what the string meets first
        order = order[(travel[order] >= -found.height) & (travel[order] <= ahead)]
        touches = passage_of(stretch, touching, upper_limit=True).clearance[order] < 0
        runs, end = [], 0
        for first, stop in runs_of(found.clearance[order] < 0):
            while first > end and touches[first - 1]:
                first -= 1
            runs.append(order[first:stop])
            end = stop
        if not runs:
            return None
        spots = [self._spot(found, rows) for rows in runs]
        top, bottom, passes, number, row = spots[0]
        body = string[number]
        places = _joined([(start, stop, string[of].diameter - least) for start, stop, least, of, _ in spots])
        worst = max(places, key=lambda place: place[2])
        is_nearest = worst[0] <= top <= worst[1]
        tightest = [(round(float(lower[row]), 2), number)]
        if not is_nearest:
            inside = [spot for spot in spots if worst[0] <= spot[0] <= worst[1]]
            *_, of, at = max(inside, key=lambda spot: string[spot[3]].diameter - spot[2])
            tightest.append((round(float(lower[at]), 2), of))
        name = body.name or ("bit" if body.position == 0 else f"body {number + 1}")
        sizes = f"{1e3 * passes:.1f} mm pass at most, the {name} has {1e3 * body.diameter:.1f} mm"
        side = "above" if self._up else "below"
        text = f"tight hole {side} the bit at {bit:.1f} m: from {top:.1f} to {bottom:.1f} m {sizes}"
        return TightAhead(
            round(float(lower[runs[0][0]]), 2), self._up, round(top, 2), round(bottom, 2), name,
            round(passes, 4), body.diameter, text, len(places),
            None if is_nearest else (round(worst[0], 2), round(worst[1], 2), round(worst[2], 4)), tuple(tightest),
            self._moves,
        )  # fmt: skip

    def _spot(self, found: Passage, rows: Integers) -> tuple[float, float, float, int, int]:
        """Return the ends of a tight place, what passes at most of the body that sticks first, its number, and where.

        The last is the row of ``found`` in which this body is tightest.
        """
        number = int(found.contact_body[rows[found.clearance[rows] < 0][0], 0])
        of_body = rows[found.contact_body[rows, 0] == number]
        touched = found.contact_depth[of_body, 0]
        row = int(of_body[np.argmin(found.clearance[of_body])])
        passes = found.string[number].diameter + float(found.clearance[row])
        return float(touched.min()), float(touched.max()), passes, number, row

    def _stretch(self, top: float, bottom: float, beyond: float) -> WallState | None:
        """Return the whole turns between two depths, with the samples that decide what is sampled there.

        Turns that the wall does not have, up to so many metres beyond its ends, are without a radius; None if it has
        none of them.
        """
        wall = self._live.wall._state()
        K, pitch = wall.settings.sectors, wall.settings.pitch
        start_depth = float(wall.start_depth)
        first, stop = sorted((end - start_depth) / pitch for end in (top, bottom))
        first, stop = math.floor(first) - 1, math.ceil(stop) + 1  # whole bodies, at the first and the last place
        held, more = wall.radius.size // K, math.ceil(beyond / abs(pitch)) + 2
        first, stop = max(first, -more), min(stop, held + more)
        own = slice(K * min(max(first, 0), held), K * min(max(stop, 0), held))
        if own.start >= own.stop:
            return None
        lack = (own.start - K * first, K * stop - own.stop)
        depth, reach = wall.sample_columns[0], max(NEAR_DEPTH, wall.settings.gap_reach)
        near = slice(*np.searchsorted(depth, (top - reach, bottom + reach)).tolist())  # samples are sorted by depth
        path = self._live.model.stations.reaching(bottom)
        start = start_depth + first * pitch
        path = path if path is not None and path.start_depth <= min(top, start) else None
        return replace(
            wall,
            settings=replace(wall.settings, start_depth=start),
            start_depth=start,
            radius=np.pad(wall.radius[own], lack, constant_values=np.nan),
            nearest=np.pad(wall.nearest[own], lack, constant_values=np.nan),
            support=np.pad(wall.support[own], lack),
            iterations=np.pad(wall.iterations[own], lack),
            sample_columns=tuple(column[near] for column in wall.sample_columns),
            path=path,
            sums=(),
        )


def _joined(spots: list[tuple[float, float, float]]) -> list[tuple[float, float, float]]:
    """Return the places that overlap as one, with the greatest excess: bodies stick there one after the other."""
    found: list[tuple[float, float, float]] = []
    for top, bottom, excess in sorted(spots):
        if found and top <= found[-1][1]:
            last = found.pop()
            top, bottom, excess = last[0], max(last[1], bottom), max(last[2], excess)
        found.append((top, bottom, excess))
    return found

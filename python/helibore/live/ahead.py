"""What lies above and below the bit: the places that the string does not pass.

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
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from helibore.base.arrays import Integers, runs_of
from helibore.live.live import Live
from helibore.live.rules.configuration import AlarmLimits
from helibore.logs.passage import Passage, passage_of
from helibore.settings.output_settings import RigidBody
from helibore.wall.state import WallState
from helibore.wall.wall_columns import NEAR_DEPTH

MOVED = 0.25
"""Metres that the bit must move in one direction until what lies there is looked at."""
SHARE, SHARE_AT_REST = 20.0, 100.0
"""Looking takes at most one part in so many of a processor's time, for a tripped bit and for another."""


class Place(NamedTuple):
    """A tight place: its ends, what passes at most of the body that sticks most, when the string sticks, and where.

    ``sticks_at`` is the depth of the bit at which the string begins to stick there, by the body ``first``;
    ``tightest`` is that at which it is tightest, and ``body`` the number of the body that sticks there. Metres.
    """

    top: float
    bottom: float
    passes: float
    sticks_at: float
    first: str
    tightest: float
    body: int


@dataclass(frozen=True)
class TightAhead:
    """Tight hole ahead of the bit on one side.

    Attributes
    ----------
    sticks_at
        Depth of the bit at which the string sticks, metres.
    above
        Whether it lies above the bit.
    top, bottom
        Its ends, metres.
    body
        The body that sticks first: "bit", its name, or its number.
    diameter, needed
        The greatest diameter of this body that would pass, and its own, metres.
    places
        The number of tight places on this side.
    nearest, worst
        That at which the string sticks first, and the tightest.
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
    places: int
    nearest: Place
    worst: Place

    def meets(self, other: TightAhead) -> bool:
        """Return whether ``other`` is the same tight hole, as the bit comes nearer to it."""
        return self.top <= other.bottom and other.top <= self.bottom


@dataclass(frozen=True)
class Outlook:
    """What is tight above and below the bit.

    Attributes
    ----------
    up, down
        What the string meets if it is pulled, and if it is run in; None if nothing is tight there.
    bodies
        For each body of the string, the depths of the bit at which it first sticks if the string is pulled, and if it
        is run in, metres; None: nowhere.
    moving
        "up" or "down", if the bit is tripped; "" if it is on bottom or has not moved yet.
    touching
        For each body, the diameter with which it counts where it touches, metres.
    """

    up: TightAhead | None
    down: TightAhead | None
    bodies: tuple[tuple[float | None, float | None], ...]
    moving: str
    touching: tuple[float, ...]


class Ahead:
    """Looks ahead of the bit of a live wall; `look` is called a few times a second."""

    def __init__(self, live: Live) -> None:
        self._live = live
        self._from, self._up = math.nan, True  # where the bit turned round last, and whether it moves up
        self._moves = self._on_bottom = False
        self._due = 0.0
        self.outlook: Outlook | None = None

    @property
    def found(self) -> TightAhead | None:
        """What is tight where the bit moves, or on its way out if it is on bottom."""
        if self.outlook is None or not (self._moves or self._on_bottom):
            return None
        return self.outlook.up if self._up else self.outlook.down

    def look(self) -> TightAhead | None:
        """Return what is tight ahead; None if nothing is, if the bit is on bottom, or if it has not moved yet."""
        model, limits = self._live.model, self._live.configuration.alarms
        bit = model.rig.tracks["bit_depth"].value[-1:].tolist()
        if not bit or limits.tight is None or not limits.ahead:
            self._from, self._moves, self.outlook = math.nan, False, None
            return None
        self._on_bottom = model.rig.on_bottom
        if self._on_bottom:
            self._from, self._moves, self._up = math.nan, False, True
        else:
            self._follow(bit[0])
        moving = ("up" if self._up else "down") if self._moves else ""
        if time.monotonic() >= self._due:
            began = time.thread_time()
            self.outlook = self._look_around(bit[0], limits, moving)
            self._due = time.monotonic() + (SHARE if self._moves else SHARE_AT_REST) * (time.thread_time() - began)
        elif self.outlook is not None and self.outlook.moving != moving:
            self.outlook = replace(self.outlook, moving=moving)
        return self.found if self._moves else None

    def _follow(self, bit: float) -> None:
        """Find out in which direction the bit has moved by MOVED."""
        if self._from != self._from:
            self._from = bit
        up = bit < self._from
        if self._moves and up == self._up:
            self._from = bit  # the farthest place in this direction
        elif abs(bit - self._from) >= MOVED:
            self._moves, self._up, self._from = True, up, bit
            self._due = 0.0

    def _look_around(self, bit: float, limits: AlarmLimits, moving: str) -> Outlook:
        configuration = self._live.model.configuration
        size, ahead, tight = configuration.wall["bit_diameter"], limits.ahead or 0.0, limits.tight or 0.0
        string = configuration.string or (RigidBody(size, limits.body, name="bit"),)
        # A body is tight where the hole is less than the bit by the limit. It begins to stick where it touches. This is
        # looked for up to half of the limit, since in a hole as wide as the bit noise of the samples is not tight.
        thin, touching = (
            [replace(body, diameter=max(0.0, min(body.diameter, size - least))) for body in string]
            for least in (tight, 0.5 * tight)
        )
        counts = tuple(body.diameter for body in touching)
        length = max(body.position + body.length for body in string)
        stretch = self._stretch(bit - ahead - length, bit + ahead, length)
        if stretch is None:
            return Outlook(None, None, ((None, None),) * len(string), moving, counts)
        together = _Tight(stretch, thin, touching)
        alone = [_Tight(stretch, [one], [other]) for one, other in zip(thin, touching, strict=True)]
        sides = [self._side(together, string, bit, ahead, up) for up in (True, False)]
        at = [
            tuple(
                _first([*own.sticks_at(bit, ahead, up), *together.sticks_at(bit, ahead, up, number)], up)
                for up in (True, False)
            )
            for number, own in enumerate(alone)
        ]
        return Outlook(sides[0], sides[1], tuple((up, down) for up, down in at), moving, counts)

    def _side(
        self, tight: _Tight, string: Sequence[RigidBody], bit: float, ahead: float, up: bool
    ) -> TightAhead | None:
        """Return what is tight above or below the bit; None if nothing is."""
        found, lower = tight.found, tight.lower
        runs = tight.runs(bit, ahead, up)
        if not runs:
            return None
        spots = []
        for rows in runs:
            top, bottom, passes, number, row = self._spot(found, rows)
            name = string[number].name or ("bit" if string[number].position == 0 else f"body {number + 1}")
            at = round(float(lower[rows[0]]), 2), name, round(float(lower[row]), 2), number
            spots.append(Place(round(top, 2), round(bottom, 2), round(passes, 4), *at))
        spot = spots[0]
        body = string[spot.body]
        places = _joined(spots, string)
        nearest = (max if up else min)(places, key=lambda place: place.sticks_at)
        worst = max(places, key=lambda place: string[place.body].diameter - place.passes)
        sizes = f"{1e3 * spot.passes:.1f} mm pass at most, the {spot.first} has {1e3 * body.diameter:.1f} mm"
        side = "above" if up else "below"
        ends = f"from {spot.top:.1f} to {spot.bottom:.1f} m"
        text = f"tight hole {side} the bit at {bit:.1f} m: {ends} {sizes}"
        return TightAhead(
            spot.sticks_at, up, spot.top, spot.bottom, spot.first, spot.passes, body.diameter, text,
            len(places), nearest, worst,
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


class _Tight:
    """Where bodies on one axis stick in a stretch of a wall: by the limit, and from where they touch."""

    def __init__(self, stretch: WallState, thin: Sequence[RigidBody], touching: Sequence[RigidBody]) -> None:
        self.found = passage_of(stretch, thin, upper_limit=True)
        self.lower = self.found.depth + self.found.length / 2
        self._touches = passage_of(stretch, touching, upper_limit=True).clearance < 0

    def runs(self, bit: float, ahead: float, up: bool) -> list[Integers]:
        """Return the rows of each tight stretch within ``ahead`` on one side, from what the string meets first."""
        travel = bit - self.lower if up else self.lower - bit
        order = np.argsort(travel, kind="stable")
        order = order[(travel[order] >= -0.49 * self.found.height) & (travel[order] <= ahead)]
        runs, end = [], 0
        for first, stop in runs_of(self.found.clearance[order] < 0):
            while first > end and self._touches[order[first - 1]]:
                first -= 1
            runs.append(order[first:stop])
            end = stop
        return runs

    def sticks_at(self, bit: float, ahead: float, up: bool, body: int = 0) -> list[float]:
        """Return the depths of the bit at which a body begins to stick on one side."""
        held = self.found.contact_body[:, 0] == body
        runs = (rows[held[rows]] for rows in self.runs(bit, ahead, up))
        return [round(float(self.lower[rows[0]]), 2) for rows in runs if rows.size]


def _first(depths: list[float], up: bool) -> float | None:
    """Return the depth that the bit reaches first, if it moves up or down."""
    return (max if up else min)(depths, default=None)


def _joined(spots: list[Place], string: Sequence[RigidBody]) -> list[Place]:
    """Return the places that overlap as one, as tight as the tightest: bodies stick there one after the other.

    The string begins to stick there as it does in the one that it meets first.
    """
    order = {spot: number for number, spot in enumerate(spots)}
    found: list[Place] = []
    for spot in sorted(spots):
        if not (found and spot.top <= found[-1].bottom):
            found.append(spot)
            continue
        last = found.pop()
        first = min(last, spot, key=lambda place: order.get(place, 0))
        worst = max(last, spot, key=lambda place: string[place.body].diameter - place.passes)
        bottom = max(last.bottom, spot.bottom)
        joined = worst._replace(top=last.top, bottom=bottom, sticks_at=first.sticks_at, first=first.first)
        order[joined] = min(order[last], order[spot])
        found.append(joined)
    return found

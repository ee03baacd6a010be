"""What lies above and below the bit: the places that the string does not pass.

    bit moves up       |ahead|     from 2010.3 to 2012.1 m the stabiliser does not pass
                   ----#------[stabiliser]------bit    "8.2 m", so far the bit moves until it sticks

The string is that of the configuration or, without one, a body as wide as the bit whose lower end is the bit. Each of
its bodies is rigid and straight, and between them it bends with the hole, as collars do: a rigid string of 30 m would
stick in any hole that builds a degree. So each body has the clearance of `Wall.passage` in the straightened hole, in
the part of the wall that lies ahead; hole that is not sampled counts as open. So what is said to be tight is tight,
whatever lies between the samples, also where a telemetry tool measured only a few places of each turn. Of hole that was
scanned again and has changed, the samples of the last scan count, whether the wall takes its pass or not. What is not
said to be tight may be tight where the turns are not sampled: so each body has the first such hole that it would enter.

Hole is tight where it is less than the bit by the limit, and where a body is likely too thick for it; each place has
the probability that the string sticks there, unless a sensor is known to be off. The alarm has the limit alone.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from statistics import NormalDist
from typing import NamedTuple

import numpy as np

from helibore.base.arrays import Floats, Integers, Mask, joined, runs_of
from helibore.base.errors import InputError
from helibore.base.utc_time import SECOND
from helibore.live.live import Live
from helibore.live.rules.configuration import AlarmLimits
from helibore.logs.passage import SURER, hanging_at, passage_of, without_noise
from helibore.logs.turn_logs import LEAST_SAMPLED
from helibore.logs.zone_criteria import Criteria
from helibore.samples.helix import helix_of
from helibore.settings.output_settings import RigidBody
from helibore.wall.state import WallState
from helibore.wall.uncertainty import NORMAL_95
from helibore.wall.wall_columns import NEAR_DEPTH

MOVED = 0.25
"""Metres that the bit must move in one direction until what lies there is looked at."""
RESTS, SLOWEST = 10.0, 90.0
"""Seconds after which a bit that has not moved on counts as hanging: it may move either way. One that moves slowly
hangs after twice the time that it took to move on, and at most SLOWEST."""
MOVES_ON = 0.05
"""Metres that it moves on at least."""
HEAVES, HEAVE = 30.0, 3.0
"""Seconds after the bit turned round, and metres from there, within which it may only heave: it hangs."""
MORE = 15.0
"""Metres of hole on both sides that are solved beforehand while the string is tripped, and last while the wall does."""
LEAST_GAP = 0.25
"""Metres of hole that must not be sampled on end, so that it counts as not seen."""
APART = 0.25
"""Metres of hole between two tight places that count as two."""
TRUENESS = 0.0015
"""Metres by which a body is too thick at least: by a millimetre the diameters of a caliper may be off all over."""
FAR = 1e6
"""Metres above or below all hole."""
SHARE, SHARE_AT_REST = 20.0, 100.0
"""Solving takes at most one part in so many of a processor's time, for a tripped bit and for another."""


class Place(NamedTuple):
    """A tight place: its ends, what passes at most of the body that sticks most, when the string sticks, and where.

    Ends and size are those of the whole place, whichever way the string comes from. ``sticks_at`` is the depth of the
    bit at which the string begins to stick there, by the body ``first``; ``tightest`` is that at which it is tightest,
    and ``body`` the number of the body that sticks there. ``sure`` is the probability that it is too thick by TRUENESS,
    ``within`` half the 95 % interval of what passes; None: not known. ``at_most``: less may pass, since too little is
    sampled there. Metres.
    """

    top: float
    bottom: float
    passes: float
    sticks_at: float
    first: str
    tightest: float
    body: int
    sure: float | None = None
    within: float | None = None
    at_most: bool = False


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
        The tight places on this side, from that at which the string sticks first.
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
    places: tuple[Place, ...]

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
        "up" or "down", if the bit is tripped; "" if it is on bottom, hangs or has not moved yet.
    unseen
        For each body, the first hole that it would enter up, and down, of which no sensor has seen enough: its ends,
        metres, down to the bottom of the hole; None: all hole was seen up to where it sticks, or as far as is looked.
    hangs
        Whether the bit has not moved on for some time, or may only heave.
    same
        Minutes in which bit depths came and did not change.
    """

    up: TightAhead | None
    down: TightAhead | None
    bodies: tuple[tuple[float | None, float | None], ...]
    moving: str
    unseen: tuple[tuple[tuple[float, float] | None, ...], ...] = ()
    hangs: bool = False
    same: int = 0


class Ahead:
    """Looks ahead of the bit of a live wall; `look` is called a few times a second."""

    def __init__(self, live: Live) -> None:
        self._live = live
        self._from, self._heads_up = math.nan, True  # the farthest place on the way of the bit, and whether that is up
        self._moves = self._on_bottom = self._hangs = False
        self._turned, self._at = math.nan, 0  # where the bit turned round last, and when
        self._up = True  # whether it moves up, but for heave
        self._last, self._since = math.nan, 0  # where the bit moved on last, and when
        self._took = 0  # nanoseconds that it took to move on
        self._bit, self._changed = math.nan, 0  # the newest bit depth, and when it changed last
        self._newest, self._came = list[int](), 0  # the frame of the newest bit depth, and when it came
        self._due = 0.0
        self._known: object = None  # the wall of which `_bodies` are known, between the depths `_ends`
        self._ends = (math.nan, math.nan)
        self._string: tuple[RigidBody, ...] = ()
        self._bodies: list[_Tight] = []
        self._whole: list[Place] = []  # the tight places of all bodies, from above
        self._seen: list[tuple[float, float]] = []  # ends of the hole that is sampled, from above
        self._seen_to = math.inf  # the depth below which it was not looked for, though the wall goes on
        self.outlook: Outlook | None = None
        self._beyond: tuple[TightAhead | None, ...] = (None, None)  # what is tighter than the limit, up and down

    @property
    def found(self) -> TightAhead | None:
        """What is tighter than the limit where the bit moves, or on its way out if it is on bottom."""
        if self.outlook is None or not (self._moves or self._on_bottom):
            return None
        return self._beyond[0 if self._up else 1]

    def look(self) -> TightAhead | None:
        """Return what is tight ahead; None if nothing is, if the bit is on bottom, or if it has not moved yet."""
        model, limits = self._live.model, self._live.configuration.alarms
        bit = model.rig.tracks["bit_depth"].value[-1:].tolist()
        if not bit or not limits.ahead or (limits.tight is None and not model.configuration.string):
            self._from, self._moves, self.outlook = math.nan, False, None
            return None
        self._on_bottom, now = model.rig.on_bottom, self._live.clock()[1]
        if self._on_bottom:
            self._from, self._turned, self._moves, self._up, self._heads_up = math.nan, math.nan, False, True, True
        else:
            self._follow(bit[0], now)
        if not abs(bit[0] - self._last) < MOVES_ON:
            self._took, self._last, self._since = now - self._since, bit[0], now
        if bit[0] != self._bit:
            self._bit, self._changed = bit[0], now
        newest = model.rig.tracks["bit_depth"].order[-1:].tolist()
        if newest != self._newest or model.rig.at_rest:
            self._newest, self._came = newest, now
        rests = min(max(RESTS * SECOND, 2 * self._took), SLOWEST * SECOND)
        self._hangs = self._came - self._since > rests or self._heaves(bit[0], now)
        moving = ("up" if self._up else "down") if self._moves and not self._hangs else ""
        if time.monotonic() >= self._due:
            began = time.thread_time()
            self._solve(bit[0], limits)
            self._due = time.monotonic() + (SHARE if self._moves else SHARE_AT_REST) * (time.thread_time() - began)
        self.outlook = self._look_around(bit[0], limits.ahead, moving)
        return self.found if self._moves and limits.tight is not None else None

    def _follow(self, bit: float, now: int) -> None:
        """Find out in which direction the bit has moved by MOVED, and does not only heave."""
        if self._from != self._from:
            self._from = bit
        up = bit < self._from
        if self._moves and up == self._heads_up:
            self._from = bit  # the farthest place in this direction
        elif abs(bit - self._from) >= MOVED:
            if self._moves:
                self._turned, self._at = self._from, now
            self._moves, self._heads_up, self._from = True, up, bit
        if not self._heaves(bit, now):
            self._up = self._heads_up

    def _heaves(self, bit: float, now: int) -> bool:
        """Return whether the bit turned round so short a time ago, and so near, that it may only heave."""
        return now - self._at < HEAVES * SECOND and abs(bit - self._turned) < HEAVE

    def _solve(self, bit: float, limits: AlarmLimits) -> None:
        """Find where each body sticks in the hole around the bit, unless that is known of this wall."""
        configuration, wall = self._live.model.configuration, self._live.wall
        size, ahead = configuration.wall["bit_diameter"], limits.ahead or 0.0
        tight = Criteria.undergauge if limits.tight is None else limits.tight
        string = configuration.string or (RigidBody(size, limits.body, name="bit"),)
        length = max(body.position + body.length for body in string)
        top, bottom = bit - ahead - length, bit + ahead
        apart = self._live.model.apart[self._live.model.main].values.size
        wrong = self._live.model.watch.active  # what a stuck sensor sends is left out
        off = any(rule == "sensors" and ("stays", source) not in wrong for rule, source in wrong)
        known = id(wall), wall.settings, wall.sample_count, apart, string, limits, off
        if known == self._known and self._ends[0] <= top and bottom <= self._ends[1]:
            return
        more = min(ahead, MORE) if self._moves else 0.0
        self._known, self._string, self._ends = known, string, (top - more, bottom + more)
        # A body is tight where the hole is less than the bit by the limit. It begins to stick where it touches; in a
        # hole as wide as the bit, noise of the samples is not tight.
        thin, touching = (
            [max(0.0, min(body.diameter, size - least)) for body in string] for least in (tight, TRUENESS)
        )
        stretch, sigma = self._stretch(*self._ends, length), None
        stretch = stretch and self._live.model.last_scan(stretch)
        self._seen = [] if stretch is None else _seen(stretch)
        self._seen_to = self._ends[1] if max(helix_of(wall).ends(len(wall))) > self._ends[1] else math.inf
        if stretch is not None:
            stretch, sigma = _quiet(stretch)
        if off:  # its error is no noise: nobody knows how sure its radii are
            sigma = None
        each = zip(range(len(string)), string, thin, touching, strict=True)
        self._bodies = [] if stretch is None else [_Tight(*of, self._narrow(stretch, sigma, *of[1:])) for of in each]
        ways = (-FAR, False), (FAR, True)
        whole = [one for bit, up in ways for of in self._bodies for one in of.places(bit, 2 * FAR, up)]
        self._whole = _joined(whole, string)

    def _narrow(
        self, stretch: WallState, sigma: Floats | None, body: RigidBody, *thin: float
    ) -> list[tuple[WallState, Floats | None]]:
        """Return the parts of a stretch in which a body may stick, each with its sigma."""
        K, pitch = stretch.settings.sectors, stretch.settings.pitch
        turns = np.where(np.isnan(stretch.radius), np.inf, stretch.radius).reshape(-1, K).min(axis=1)
        reach = math.ceil(body.length / abs(pitch)) + 2  # turns beside which it may be
        parts = []
        for first, stop in joined(runs_of(2.0 * turns < max(thin)), 2 * reach):
            top, bottom = sorted(stretch.start_depth + pitch * turn for turn in (first - reach, stop + reach))
            if part := self._stretch(top, bottom, body.length, stretch):
                away = round((part.start_depth - stretch.start_depth) / pitch) * K
                rows = away + np.arange(part.radius.size)
                held = (rows >= 0) & (rows < stretch.radius.size)
                own = None if sigma is None else np.where(held, sigma[np.where(held, rows, 0)], np.nan)
                parts.append((part, own))
        return parts

    def _look_around(self, bit: float, ahead: float, moving: str) -> Outlook:
        up, down = ([of.places(bit, ahead, up) for of in self._bodies] for up in (True, False))
        sides = self._side(up, bit, up=True), self._side(down, bit, up=False)
        self._beyond = tuple(
            self._side([of.places(bit, ahead, up, "beyond") for of in self._bodies], bit, up) for up in (True, False)
        )
        at = tuple((_first(above, up=True), _first(below, up=False)) for above, below in zip(up, down, strict=True))
        at = at or ((None, None),) * len(self._string)
        hole = self._live.model.rig.tracks["hole_depth"].value[-1:].tolist()
        room = ahead, min(ahead, max(0.0, hole[0] - bit)) if hole else ahead  # the bit moves no deeper than the hole
        bottom = min(hole[0] if hole else bit + ahead, self._seen_to)
        unseen = tuple(self._unseen(body, bit, bottom, room, of) for body, of in zip(self._string, at, strict=True))
        same = max(0, self._came - self._changed) // (60 * SECOND)
        return Outlook(*sides, at, moving, unseen, self._hangs, same)

    def _side(self, places: Sequence[Sequence[Place]], bit: float, up: bool) -> TightAhead | None:
        """Return what is tight above or below the bit, from the places of each body; None if nothing is.

        The string begins to stick in a place as the body does that meets it first.
        """
        string, met, found = self._string, [one for of_body in places for one in of_body], list[Place]()
        for whole in self._whole:
            if of := [one for one in met if one.top <= whole.bottom and whole.top <= one.bottom]:
                first = (max if up else min)(of, key=lambda one: one.sticks_at)
                worst = max(of, key=lambda one: string[one.body].diameter - one.passes)
                found.append(whole._replace(
                    sticks_at=first.sticks_at, first=first.first, tightest=worst.tightest, body=worst.body
                ))  # fmt: skip
        if not found:
            return None
        found.sort(key=lambda one: one.sticks_at, reverse=up)
        nearest, body = found[0], string[found[0].body]
        needed = f"the {_name(body, nearest.body)} has {1e3 * body.diameter:.1f} mm"
        ends = f"from {nearest.top:.1f} to {nearest.bottom:.1f} m"
        text = f"tight hole {'above' if up else 'below'} the bit at {bit:.1f} m: {ends}"
        text += f" {1e3 * nearest.passes:.1f} mm pass at most, {needed}"
        return TightAhead(
            nearest.sticks_at, up, nearest.top, nearest.bottom, nearest.first, nearest.passes, body.diameter, text,
            tuple(found),
        )  # fmt: skip

    def _unseen(
        self, body: RigidBody, bit: float, bottom: float, room: tuple[float, float],
        at: tuple[float | None, float | None],
    ) -> tuple[tuple[float, float] | None, ...]:  # fmt: skip
        """Return the first hole that a body enters before it sticks, up and down, of which too little is sampled."""
        travel = [most if end is None else abs(bit - end) for most, end in zip(room, at, strict=True)]
        lower = bit - body.position
        upper = lower - body.length
        gaps = _gaps(self._seen, upper - travel[0], max(bottom, lower))

        def met(top: float, end: float) -> list[tuple[float, float]]:
            return [gap for gap in gaps if min(gap[1], end) - max(gap[0], top) >= LEAST_GAP]

        above, below = met(upper - travel[0], lower), met(upper, lower + travel[1])
        return max(above, default=None), min(below, default=None)

    def _stretch(self, top: float, bottom: float, beyond: float, wall: WallState | None = None) -> WallState | None:
        """Return the turns of the wall between two depths, with the samples that decide what is sampled there.

        Vertices that the wall does not have, up to so many metres beyond its ends, are without a radius; None if it has
        none of them.
        """
        wall = wall or self._live.wall._state()
        K, pitch = wall.settings.sectors, wall.settings.pitch
        start_depth = float(wall.start_depth)
        first, stop = sorted((end - start_depth) / pitch for end in (top, bottom))
        first, stop = math.floor(first) - 1, math.ceil(stop) + 1  # whole bodies, at the first and the last place
        held, more = wall.radius.size, math.ceil(beyond / abs(pitch)) + 2
        first, stop = max(first, -more), min(stop, math.ceil(held / K) + more)  # the last turn may be cut
        own = slice(min(K * max(first, 0), held), min(K * max(stop, 0), held))
        if own.start >= own.stop:
            return None
        lack = (own.start - K * first, K * stop - own.stop)
        depth, reach = wall.sample_columns[0], max(NEAR_DEPTH, wall.settings.gap_reach)
        near = slice(*np.searchsorted(depth, (top - reach, bottom + reach)).tolist())  # samples are sorted by depth
        start = start_depth + first * pitch
        return replace(
            wall,
            settings=replace(wall.settings, start_depth=start, stop_depth=None, stop_vertex=K * (stop - first)),
            start_depth=start,
            radius=np.pad(wall.radius[own], lack, constant_values=np.nan),
            nearest=np.pad(wall.nearest[own], lack, constant_values=np.nan),
            support=np.pad(wall.support[own], lack),
            iterations=np.pad(wall.iterations[own], lack),
            sample_columns=tuple(column[near] for column in wall.sample_columns),
            path=None,
            sums=tuple(np.pad(column[own], lack, constant_values=np.nan) for column in wall.sums),
        )


class _Tight:
    """Where one body of the string sticks in parts of a wall: beyond the limit, and where it is likely too thick."""

    def __init__(
        self, number: int, body: RigidBody, thin: float, touching: float,
        parts: Sequence[tuple[WallState, Floats | None]],
    ) -> None:  # fmt: skip
        self._number, self._name, alone = number, _name(body, number), replace(body, position=0.0)
        self._to_bit = body.position + body.length / 2  # metres from the middle of the body to the bit
        self._parts: list[_Part] = []
        for part, sigma in parts:
            found = passage_of(part, [alone], upper_limit=True)
            passes = body.diameter + found.clearance
            beyond = passes < thin
            chances = [_NO_CHANCE] * passes.size
            for first, stop in runs_of(passes < max(thin, touching)):
                lower_end = float(found.depth[first + np.argmin(passes[first:stop])]) + body.length / 2
                chance = _chance(part, alone, sigma, lower_end)
                beyond[first:stop] = beyond[first:stop].any()
                if beyond[first] or not chance.middle >= -TRUENESS:
                    chances[first:stop] = [chance] * (stop - first)
            tight = np.array([chance is not _NO_CHANCE for chance in chances])
            contact = found.contact_depth[:, 0]
            self._parts.append(_Part(found.depth, passes, contact, beyond, tight, chances, found.height))

    def places(self, bit: float, ahead: float, up: bool, of: str = "tight") -> list[Place]:
        """Return the places within ``ahead`` on one side that are tight, or beyond the limit."""
        places = []
        for part in self._parts:
            lower = part.depth + self._to_bit
            travel = bit - lower if up else lower - bit
            for rows in _runs(getattr(part, of), travel, -0.49 * part.height, ahead):
                row = rows[np.argmin(part.passes[rows])]
                touched = part.contact[rows]
                ends = round(float(touched.min()), 2), round(float(touched.max()), 2)
                begins = lower[rows[0]] + (0.5 if up else -0.5) * part.height  # between this turn and the one before
                sticks_at, tightest = round(float(begins), 2), round(float(lower[row]), 2)
                passes = round(float(part.passes[row]), 4)
                chance = part.chances[row][1:]
                places.append(Place(*ends, passes, sticks_at, self._name, tightest, self._number, *chance))
        return places


class _Chance(NamedTuple):
    """What a body clears, likely (NaN: not known); and `Place.sure`, `Place.within` and `Place.at_most`."""

    middle: float
    sure: float | None
    within: float | None
    at_most: bool


_NO_CHANCE = _Chance(math.inf, None, None, False)


class _Part(NamedTuple):
    """A body in a part of a wall, turn by turn: where its middle is, what passes there, and where that touches first.

    ``beyond``: of a place that is tight by the limit; ``tight``: of one where it sticks, with the chances of the place.
    """

    depth: Floats
    passes: Floats
    contact: Floats
    beyond: Mask
    tight: Mask
    chances: list[_Chance]
    height: float


def _chance(part: WallState, body: RigidBody, sigma: Floats | None, lower_end: float) -> _Chance:
    """Return how sure it is that a body sticks with its lower end at a depth."""
    found = hanging_at(part, [body], lower_end, part.sampled, sigma)
    if found is None or not math.isfinite(found.low):
        return _Chance(math.nan, None, None, found is not None and found.at_most)
    middle, deviation = 0.5 * (found.low + found.high), max((found.high - found.low) / (2 * NORMAL_95), 1e-6)
    sure = round(NormalDist(middle, deviation).cdf(-TRUENESS), 3)
    return _Chance(middle, sure, round(NORMAL_95 * deviation, 4), found.at_most)


def _runs(tight: Mask, travel: Floats, least: float, most: float) -> list[Integers]:
    """Return the rows of each tight stretch on the way, from what the body meets first."""
    order = np.argsort(travel, kind="stable")
    order = order[(travel[order] >= least) & (travel[order] <= most)]
    return [order[first:stop] for first, stop in runs_of(tight[order])]


def _quiet(stretch: WallState) -> tuple[WallState, Floats | None]:
    """Return a stretch without the noise of its radii, as far as their uncertainty is known, and what is left of it."""
    try:
        sigma = stretch.sigma
    except InputError:  # too few samples
        return stretch, None
    radius = without_noise(stretch.radius, sigma, stretch.settings.sectors)
    return replace(stretch, radius=radius, sums=()), SURER * sigma


def _seen(stretch: WallState) -> list[tuple[float, float]]:
    """Return the ends of the hole whose turns are sampled, from above."""
    K, pitch, start = stretch.settings.sectors, stretch.settings.pitch, float(stretch.start_depth)
    turns = stretch.sampled.reshape(-1, K).mean(axis=1) >= LEAST_SAMPLED
    found = [sorted((start + pitch * first, start + pitch * stop)) for first, stop in runs_of(turns)]
    return sorted((top, bottom) for top, bottom in found)


def _gaps(seen: Sequence[tuple[float, float]], top: float, bottom: float) -> list[tuple[float, float]]:
    """Return the ends of what lies between two depths and is not seen."""
    tops = [top, *(end for _, end in seen)]
    bottoms = [*(start for start, _ in seen), bottom]
    gaps = [(round(max(top, up), 2), round(min(bottom, down), 2)) for up, down in zip(tops, bottoms, strict=True)]
    return [(up, down) for up, down in gaps if down - up >= LEAST_GAP]


def _name(body: RigidBody, number: int) -> str:
    """Return what the page and the alarms call a body."""
    return body.name or ("bit" if body.position == 0 else f"body {number + 1}")


def _first(places: Sequence[Place], up: bool) -> float | None:
    """Return the depth at which a body sticks first, if the bit moves up or down; None: nowhere."""
    return (max if up else min)((place.sticks_at for place in places), default=None)


def _joined(places: Sequence[Place], string: Sequence[RigidBody]) -> list[Place]:
    """Return the places that overlap or nearly do as one, as tight as the tightest: bodies stick there in turn."""
    found: list[Place] = []
    for place in sorted(places):
        if not (found and place.top <= found[-1].bottom + APART):
            found.append(place)
            continue
        last = found.pop()
        worst = max(last, place, key=lambda one: string[one.body].diameter - one.passes)
        found.append(worst._replace(top=last.top, bottom=max(last.bottom, place.bottom)))
    return found

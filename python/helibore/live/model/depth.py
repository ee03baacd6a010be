"""The depth of a sensor when it measured, and the pass of the string at that time.

    bit depth  *-------*-------*-----      *: entries as they arrive; between them, bit depth is interpolated in time
    sample                m   r            r: received, m: measured, at receive time - latency
    sensor depth = bit depth at m - offset, or the depth that the frame of the sample states

A sample gets its depth when the entries before and after its time have arrived, so its depth does not depend on how
the stream was cut into packets. Depth is never extrapolated, and never interpolated between two bit depths that are
more than ``max_depth_gap`` seconds or ``depth.jump`` metres apart. Heave and stretch of the string are not modelled.

Each bit depth entry decides the pass from the string's motion:

    activity 4 or 5: ream                  other activity, on bottom: drill
    activity 8 or 9: trip                  other activity, off bottom: trip if the string does not turn, else rescan

If the sender counts its passes, its pass number decides instead (``pass_rules.py``).
"""

from __future__ import annotations

import numpy as np

from helibore.base.arrays import Floats, Integers, Mask
from helibore.base.utc_time import SECOND
from helibore.live.model.depth_jumps import unit_differs, unit_rule
from helibore.live.model.events import Flag
from helibore.live.model.growing_array import GrowingArray
from helibore.live.rules.depth_limits import DepthLimits
from helibore.live.rules.pass_rules import DRILL, REAM, RESCAN, TRIP, UNKNOWN, PassRules

DEEP_ENOUGH = 100.0
"""Metres. The unit of smaller depths is not checked: a sensor high above the bit may be at bit depth / 3.28."""


RESTING = (3, 13, 14, 15, 16)
"""Activities (WITS item 0107) in which the string hangs in its slips: a connection, service, repair, a survey."""
CIRCULATING, TRIPPING = 7, (8, 9)


class QuantityHistory:
    """Entries (time, order, value) of one quantity in order of arrival; ``order`` is the number of their frame."""

    STATE = ("_time", "_order", "_value")

    def __init__(self) -> None:
        self._time, self._order, self._value = GrowingArray(np.int64), GrowingArray(np.int64), GrowingArray(np.float64)

    @property
    def time(self) -> Integers:
        return self._time.values

    @property
    def order(self) -> Integers:
        return self._order.values

    @property
    def value(self) -> Floats:
        return self._value.values

    def append(self, time: Integers, order: Integers, value: Floats) -> None:
        """Append the entries whose ``value`` is finite."""
        known = np.isfinite(value)
        for column, of in ((self._time, time), (self._order, order), (self._value, value)):
            column.append(of[known])

    def before(self, order: Integers) -> Integers:
        """Return the index of the latest entry in or before each frame ``order``; -1 if there is no such entry."""
        return self.order.searchsorted(order, side="right") - 1

    def forget(self, count: int) -> None:
        """Delete the first ``count`` entries."""
        for column in (self._time, self._order, self._value):
            column.forget(count)


class RigHistory:
    """Bit depth, hole depth, rotation and activity over time, and the pass at each bit depth entry."""

    STATE = ("tracks", "_kind", "_off_bottom", "_reached", "_deepest", "_hole")

    def __init__(self, rules: PassRules, limits: DepthLimits) -> None:
        self.use(rules, limits)
        self.tracks = {name: QuantityHistory() for name in ("bit_depth", "hole_depth", "rotation", "activity")}
        self._kind, self._off_bottom = GrowingArray(np.int64), GrowingArray(np.bool_)
        self._reached = GrowingArray(np.float64)  # greatest hole or bit depth at each entry; inf before any hole depth
        self._deepest = self._hole = -np.inf

    def use(self, rules: PassRules, limits: DepthLimits) -> None:
        """Use these rules and limits from now on."""
        self._rules, self._limits = rules, limits

    def begin_hole(self) -> None:
        """Forget how deep the hole was, because another hole begins."""
        self._deepest = self._hole = -np.inf

    @property
    def on_bottom(self) -> bool:
        """Whether the bit is on bottom, by the latest bit depth."""
        latest = self._off_bottom.values[-1:]
        return bool(len(latest) and not latest[0])

    @property
    def at_rest(self) -> bool:
        """Whether the string hangs still, by the latest activity: then a bit depth may be sent only when it changes.

        If the hole has become deeper since the last bit depth, the activity is wrong.
        """
        activity, bit, hole = (self.tracks[name] for name in ("activity", "bit_depth", "hole_depth"))
        if not (activity.value[-1:].size and bit.order.size and activity.value[-1] in RESTING):
            return False
        return not hole.value[-1:] > self._latest("hole_depth", bit.order[-1:])

    @property
    def turns(self) -> bool:
        """Whether the string turns, by the latest rotation."""
        return bool((self.tracks["rotation"].value[-1:] >= self._rules.rotating).any())

    @property
    def pumps_may_be_off(self) -> bool:
        """Whether a tool that sends by mud pulses may be silent, by the latest values.

        The string hangs in its slips or, off bottom, is tripped, or neither turns nor circulates.
        """
        activity = self.tracks["activity"].value[-1:].tolist()
        works = activity == [CIRCULATING] or (self.turns and not (activity and activity[0] in TRIPPING))
        return self.at_rest or bool(self._off_bottom.values[-1:].any() and not works)

    def settle(self) -> None:
        """Decide the pass at each new bit depth entry; call this after all frames up to now are appended."""
        bit = self.tracks["bit_depth"]
        first = len(self._kind.values)
        if first == len(bit.value):
            return
        order, time, depth = bit.order[first:], bit.time[first:], bit.value[first:]
        deepest = np.maximum.accumulate(np.maximum(depth, self._deepest))
        self._deepest = float(deepest[-1])
        hole = self._latest("hole_depth", order)
        off = np.where(np.isnan(hole), deepest, hole) - depth > self._rules.on_bottom
        turning = self._turning(order, time)
        activity = self._latest("activity", order, time)
        kind = np.where(off, np.where(turning == 0, TRIP, RESCAN), DRILL)
        kind = np.where((activity == 4) | (activity == 5), REAM, kind)
        kind = np.where(np.isin(activity, TRIPPING), TRIP, kind)
        reached = np.where(np.isnan(hole), -np.inf, np.maximum(hole, deepest))
        reached = np.maximum.accumulate(np.concatenate([[self._hole], reached]))[1:]
        self._hole = float(reached[-1])
        self._reached.append(np.where(np.isneginf(reached), np.inf, reached))
        self._kind.append(kind)
        self._off_bottom.append(off)

    def _latest(self, name: str, order: Integers, time: Integers | None = None) -> Floats:
        """Return the latest value of a quantity in or before each frame ``order``; NaN if there is no such value.

        If ``time`` is given, a value that is older than ``stale`` seconds at that time is NaN, too.
        """
        track = self.tracks[name]
        if not len(track.value):
            return np.full(len(order), np.nan)
        at = track.before(order)
        values = np.where(at >= 0, track.value[at], np.nan)
        if time is not None:
            values = np.where(time - track.time[at] > self._rules.stale * SECOND, np.nan, values)
        return values

    def _turning(self, order: Integers, time: Integers) -> Integers:
        """Return for each frame 1 if the string turns, 0 if it does not, -1 if the rotation is unknown or stale."""
        rotation = self._latest("rotation", order, time)
        return np.where(np.isnan(rotation), -1, (rotation >= self._rules.rotating).astype(np.int64))

    def place(
        self, time: Integers, order: Integers, depth: Floats, offset: Floats, now: int
    ) -> tuple[Floats, Integers, Integers, Mask]:
        """Return (depth, pass, flags, ready) of measurements, each (n,). Ready: no later record can change the depth.

        Parameters
        ----------
        time
            Time of each measurement, ns.
        order
            Number of the frame that contained the measurement: the latest bit depth in or before this frame is used.
            It is -1 if the source has a latency: then the latest bit depth at or before ``time`` is used.
        depth
            The sensor's depth if it was sent; NaN if it must be computed from the bit depth.
        offset
            Metres from the bit up to the sensor.
        now
            Time of the latest record, ns. A measurement without a depth that is more than ``max_depth_gap`` older than
            ``now`` becomes ready, with the flag NO_DEPTH.
        """
        bit = self.tracks["bit_depth"]
        at = self._bit_before(time, order)
        sent = ~np.isnan(depth)
        flags = np.zeros(len(time), np.int64)
        flags[self._not_rotating(time, order)] |= Flag.NOT_ROTATING
        if not len(bit.value):
            expired = now - time > self._rules.max_depth_gap * SECOND
            flags[~sent] |= Flag.NO_DEPTH
            return depth, np.full(len(time), UNKNOWN), flags, sent | expired
        known = at >= 0
        kind = np.where(known, self._kind.values[at], UNKNOWN)
        flags[self._wrong_depth(depth, known, at)] |= Flag.RANGE
        flags[known & self._off_bottom.values[at]] |= Flag.OFF_BOTTOM
        found, ready = self._from_bit(time, at, now)
        across = ~sent & np.isfinite(found) & self._across_jump(time, at)
        found[across] = np.nan
        flags[across] |= Flag.RANGE
        flags[~sent & np.isnan(found) & ~across] |= Flag.NO_DEPTH
        return np.where(sent, depth, found - offset), kind, flags, sent | ready

    def _bit_before(self, time: Integers, order: Integers) -> Integers:
        """Return the index of the latest bit depth entry when each measurement was made; -1 if there is no such entry.

        That is the latest entry in or before frame ``order`` or, if ``order`` is -1, at or before ``time``.
        """
        bit = self.tracks["bit_depth"]
        at: Integers = np.where(order >= 0, bit.before(order), np.searchsorted(bit.time, time, side="right") - 1)
        return at

    def _across_jump(self, time: Integers, at: Integers) -> Mask:
        """Return which measurements lie between bit depth entries ``at`` and ``at + 1`` that differ by a jump."""
        bit = self.tracks["bit_depth"]
        low, high = np.maximum(at, 0), np.minimum(at + 1, len(bit.value) - 1)
        jumps = np.abs(bit.value[high] - bit.value[low]) > self._limits.jump
        across: Mask = jumps & (time != bit.time[low])
        return across

    def _wrong_depth(self, depth: Floats, known: Mask, at: Integers) -> Mask:
        """Return which of the sent depths are wrong; before the first hole depth, no depth is wrong.

        A depth is wrong if it is more than ``beyond_hole`` below the hole, or if it is greater than DEEP_ENOUGH and
        seems to have another unit than the bit depth.
        """
        at = np.maximum(at, 0)
        has_hole = known & np.isfinite(self._reached.values[at])
        in_feet = unit_differs(depth, self.tracks["bit_depth"].value[at])
        too_deep = depth > self._reached.values[at] + self._limits.beyond_hole
        wrong: Mask = has_hole & (too_deep | (in_feet & (depth > DEEP_ENOUGH)))
        return wrong

    def depth_rule(self, row: np.void) -> str:
        """Return the reason why a pending row has the flag RANGE at the depth that `place` gave it."""
        depth = float(row["depth"])
        if self._limits.outside(np.array(depth)):
            return f"depth {depth:g} m: {self._limits.rule()}"
        bit, at = self.tracks["bit_depth"], int(self._bit_before(row["time"], row["order"]))
        if np.isnan(depth):
            step = f"the bit depth jumps from {bit.value[at]:g} m to {bit.value[at + 1]:g} m"
            return f"no depth: {step}, more than {self._limits.jump:g} m: nothing is interpolated between them"
        known, hole = bit.value[max(at, 0)], self._reached.values[max(at, 0)]
        if unit_differs(depth, known):
            return f"depth {depth:g} m: the bit is at {known:g} m: {unit_rule(depth, known)}"
        rule = f"lies more than {self._limits.beyond_hole:g} m below the hole"
        return f"depth {depth:g} m: {rule}, which is {hole:g} m deep"

    def _from_bit(self, time: Integers, at: Integers, now: int) -> tuple[Floats, Mask]:
        """Return the bit depth at ``time``, interpolated from entries ``at`` and ``at + 1``, and whether it is final.

        A depth that cannot be interpolated is NaN. A depth is final if later entries cannot change it.
        """
        bit = self.tracks["bit_depth"]
        gap = int(self._rules.max_depth_gap * SECOND)
        last = len(bit.value) - 1
        low, high = np.maximum(at, 0), np.minimum(at + 1, last)
        after = time - bit.time[low]
        exact = (at >= 0) & (after == 0)
        span = np.maximum(bit.time[high] - bit.time[low], 1)
        between = (at >= 0) & (at < last) & (span <= gap)
        depth = bit.value[low] + (bit.value[high] - bit.value[low]) * (after / span)
        depth = np.where(exact, bit.value[low], np.where(between, depth, np.nan))
        final = exact | (at < 0) | (at < last) | (after > gap) | (now - time > gap)
        return depth, final

    def _not_rotating(self, time: Integers, order: Integers) -> Mask:
        track = self.tracks["rotation"]
        if not len(track.value):
            return np.zeros(len(time), bool)
        at = np.where(order >= 0, track.before(order), np.searchsorted(track.time, time, side="right") - 1)
        fresh = (at >= 0) & (time - track.time[at] <= self._rules.stale * SECOND)
        return fresh & (track.value[at] < self._rules.rotating)

    def forget(self, time: int) -> None:
        """Delete the entries that no measurement at ``time`` or later needs."""
        for name, track in self.tracks.items():
            if len(track.time) <= 4096:
                continue
            needed = time - int(max(self._rules.stale, self._rules.max_depth_gap) * SECOND)
            spare = int(np.searchsorted(track.time, needed)) - 1
            if spare > 4096:
                track.forget(spare)
                if name == "bit_depth":
                    for column in (self._kind, self._off_bottom, self._reached):
                        column.forget(spare)

"""What passes through the hole: the drift of rigid cylinders, and the clearance of a string of bodies.

    drift = wall.drift(9.0)                         the greatest diameter of a rigid cylinder 9 m long, at each depth
    drift.least, drift.at_least                     where the hole is tightest
    bit, collar = RigidBody(0.2159, 0.3), RigidBody(0.203, 9.0, 0.3)
    wall.passage([bit, collar]).tight()             the intervals that the string does not pass

The cylinders are rigid and straight, and share one axis; the hole has its shape in three dimensions along the path. So
a body of 9 m in a hole of 0.216 m that builds 15 degrees in 30 m has only 0.128 m: in a curved hole ask for short
bodies, as long as the stiff parts of the string. ``curvature`` is what the curvature of the path alone costs. Where a
vertex beside a body has no sample near it, the result is unknown, never a number (`Wall.measured` without its limit of
the wall's change: that is what the interval says). The core (``passage.hpp``) solves it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from helibore import _core
from helibore.base.arrays import Floats, Integers, Mask, column, runs_of
from helibore.base.errors import InputError
from helibore.base.tables import LogColumn, LogTable, Tabular, columns_of
from helibore.base.thread_count import thread_count
from helibore.logs.turn_logs import Logs
from helibore.samples.helix import WallLike, basis_of, basis_text_of, whole_helix
from helibore.settings.output_settings import RigidBody
from helibore.trajectory.survey import Path, core_path

MANDRELS = {"api-casing": 0.152, "api-large-casing": 0.305, "api-tubing": 1.067}
"""Lengths of the drift mandrels of API 5CT, metres: casing up to 8 5/8 in, casing from 9 5/8 in, tubing."""
OPEN = 1.0
"""Metres: radius of hole that counts as wide open."""
TOUCHED = 0.03
"""Metres from a sample; a radius so near to one bounds what passes, also in a gap between the arms of a tool."""
BESIDE = 2
"""Vertices above, below and on both sides of a radius; it is thought no narrower than they are."""
QUIET = 2.0
"""Standard uncertainties by which a radius may differ from the mean of those beside it, and be thought equal to it."""
SURER = 0.75
"""Uncertainty of such a radius as a share of its own: radii beside each other share samples, so it is not a fifth."""
RIGID = "rigid, straight bodies on one axis; unknown where a vertex beside a body is not measured"


@dataclass(frozen=True)
class TightSpot:
    """An interval of depths of a string's middle at which its clearance is below a limit.

    Attributes
    ----------
    start, stop
        Measured depths, metres.
    least
        The least clearance in it, metres; for `Drift` the least diameter.
    depth, toolface
        Where the string touches first at that place: metres and degrees.
    body
        Number of the body that touches there, from 0, in the order of the string.
    """

    start: float
    stop: float
    least: float
    depth: float
    toolface: float
    body: int


@dataclass(frozen=True, eq=False)
class Passage(Tabular):
    """The clearance of a rigid string at each turn of a wall; made by `Wall.passage`.

    Arrays have one row per full turn, float64, owned. NaN: unknown, because a vertex beside a body is not measured, or
    the string reaches beyond the wall.

    Attributes
    ----------
    depth
        (turns,) measured depth of the string's middle, metres.
    clearance
        (turns,) the greatest clearance that any position of the axis leaves between a body and the wall, as a diameter,
        metres; below 0 if the string does not pass.
    low, high
        (turns,) the ends of the interval that holds the clearance of the true hole with 95 % probability, metres; NaN
        without ``sigma=True``, and where a vertex beside a body has no sigma. It counts that errors of the wall stand
        in the way of the string, where the hole is smooth, and that they hide what stands in its way, where the hole
        is rougher than the wall.
    contact_depth, contact_toolface
        (turns, 5) where the string touches, if it is made thicker by the clearance: metres and degrees; the place that
        holds the string most is the first. NaN where it touches at fewer places.
    contact_body
        (turns, 5) int64 number of the body that touches there, from 0; -1 where it touches at fewer places.
    curvature
        (turns,) what the curvature of the path alone costs a cylinder as long as the string, metres: length x angle /
        8, with the angle between the directions of the path at its ends. NaN without a path, and beyond its ends.
    string
        The bodies.
    height
        Metres along the hole from one turn to the next.
    """

    depth: Floats
    clearance: Floats
    low: Floats
    high: Floats
    contact_depth: Floats
    contact_toolface: Floats
    contact_body: Integers
    curvature: Floats
    string: tuple[RigidBody, ...]
    height: float

    @property
    def length(self) -> float:
        """Length of the string, metres."""
        return max(body.position + body.length for body in self.string)

    @property
    def least(self) -> float:
        """The least clearance that is known, metres; NaN if none is known."""
        return float(np.nanmin(self.clearance)) if self.known.any() else math.nan

    @property
    def at_least(self) -> int | None:
        """The row of the least clearance; None if no clearance is known."""
        return int(np.nanargmin(self.clearance)) if self.known.any() else None

    @property
    def known(self) -> Mask:
        """(turns,) bool: whether the clearance is known."""
        return np.isfinite(self.clearance)

    def tight(self, limit: float = 0.0) -> list[TightSpot]:
        """Return the intervals where the clearance is below a limit, the tightest first.

        Parameters
        ----------
        limit
            Metres.
        """
        spots = []
        for first, stop in runs_of(self.clearance < limit):
            row = first + int(np.argmin(self.clearance[first:stop]))
            ends = sorted((float(self.depth[first]), float(self.depth[stop - 1])))
            top, bottom = ends[0] - self.height / 2, ends[1] + self.height / 2
            where = float(self.contact_depth[row, 0]), float(self.contact_toolface[row, 0])
            least, body = float(self.clearance[row]), int(self.contact_body[row, 0])
            spots.append(TightSpot(top, bottom, least, *where, body))
        return sorted(spots, key=lambda spot: (spot.least, spot.start))

    def column(self, rows: Logs | None = None) -> LogColumn:
        """Return the clearance as a log, to be given to `Logs.table` or `Logs.save` in ``more``.

        Parameters
        ----------
        rows
            Logs of the same wall, whose rows the column gets: the least of the turns in a row, NaN if one of them is
            unknown. None: one row for each turn.
        """
        name, meaning = self._name()
        return LogColumn(name, "m", meaning, self.clearance if rows is None else self._in(rows))

    def table(self) -> LogTable:
        """Return one row for each turn: clearance, interval, first contact, and what curvature costs."""
        name, meaning = self._name()
        columns: list[Any] = [
            ("DEPT", "m", "Measured depth of the middle of the string", self.depth),
            (name, "m", meaning, self.clearance),
            ("LOW", "m", "Lower end of the interval that holds it with 95 % probability", self.low),
            ("HIGH", "m", "Upper end of that interval", self.high),
            ("TOUCH", "m", "Measured depth where the string touches first", self.contact_depth[:, 0]),
            ("TOUCHTF", "deg", "Toolface where the string touches first", self.contact_toolface[:, 0]),
            ("BODY", "", "Number of the body that touches first, from 1", _numbers(self.contact_body[:, 0]), 0),
            ("CURVE", "m", "What the curvature of the path alone costs", self.curvature),
        ]
        skipped = [] if np.isfinite(self.low).any() else ["LOW", "HIGH"]
        return LogTable(columns_of(*(of for of in columns if of[0] not in skipped)), self.facts())

    def facts(self) -> dict[str, str]:
        """Return the bodies and the meaning of the clearance as texts; every output states them."""
        bodies = {
            f"body {number}": f"{body.name + ', ' if body.name else ''}{body.diameter:.6g} m outer diameter, "
            f"{body.length:.6g} m long, {body.position:.6g} m above the lower end"
            for number, body in enumerate(self.string, 1)
        }
        return {**bodies, "passage": RIGID}

    def _name(self) -> tuple[str, str]:
        return "CLEARANCE", "Least clearance of the rigid string, as a diameter"

    def _in(self, rows: Logs) -> Floats:
        half = rows.height / 2 * (1 + 1e-9)
        order = np.argsort(self.depth, kind="stable")
        depth, clearance = self.depth[order], self.clearance[order]
        starts, stops = (np.searchsorted(depth, rows.depth + side) for side in (-half, half))
        of_row = [
            clearance[first:stop].min() if stop > first else np.nan for first, stop in zip(starts, stops, strict=True)
        ]
        return column(self._name()[0], of_row)


class Drift(Passage):
    """The greatest diameter of a rigid cylinder at each turn of a wall; made by `Wall.drift`. See `Passage`."""

    @property
    def diameter(self) -> Floats:
        """(turns,) float64 the greatest diameter, metres: `clearance`, because the cylinder has no diameter of its own.

        It is 0 if the path is so curved that the hole holds no straight line of this length.
        """
        return self.clearance

    def _name(self) -> tuple[str, str]:
        size = f"{self.length:.3f}".rstrip("0").rstrip(".").replace(".", "_")
        return f"DRIFT_{size}M", f"Greatest diameter of a rigid cylinder {self.length:g} m long"

    def facts(self) -> dict[str, str]:
        return {"passage": f"one rigid, straight cylinder {self.length:.6g} m long; {RIGID.partition('; ')[2]}"}


def passage_of(
    wall: WallLike, string: Iterable[RigidBody], sigma: Floats | None = None, *, upper_limit: bool = False
) -> Passage:
    """Return the clearance of a string, as `Wall.passage` does; ``sigma`` is the uncertainty of each radius, metres.

    With ``upper_limit``, hole that is not sampled counts as wide open. Then the result is known everywhere, and a
    thicker string does not pass, whatever the hole is between the samples; whether this one passes is not known.
    """
    bodies = tuple(string)
    if not bodies:
        raise InputError("string", "must have a body")
    for number, body in enumerate(bodies):
        if not isinstance(body, RigidBody):
            rule = "must be a RigidBody(diameter, length, position)"
            raise InputError(f"string[{number}]", rule, type(body).__name__)
    return Passage(**_solved(wall, bodies, sigma, upper_limit))


@dataclass(frozen=True)
class Hanging:
    """The clearance of a rigid string at one place, as an end of a wall that grows lets it be known.

    Attributes
    ----------
    clearance, low, high
        As in `Passage`, metres; NaN: unknown.
    depth
        Where the string touches first, metres.
    body
        Number of the body that touches there, from 0.
    at_most
        Whether the clearance may be less, because a vertex beside a body is not measured and counts as wide open.
    """

    clearance: float
    low: float
    high: float
    depth: float
    body: int
    at_most: bool

    def at_sigma(self, number: float) -> float:
        """Return the clearance so many standard uncertainties above what it is thought to be; NaN: not known."""
        return 0.5 * (self.low + self.high) + number * (self.high - self.low) / 3.92


def hanging_at(
    wall: WallLike, string: Sequence[RigidBody], lower_end: float, sampled: Mask | None, sigma: Floats | None = None
) -> Hanging | None:
    """Return the clearance of a string whose lower end is at a depth, metres; None if no body is beside measured hole.

    Hole above and below the wall counts as wide open, as hole that the bit has drilled and no sensor has passed. So the
    clearance is that of the bodies beside the wall. ``sampled`` and ``sigma`` are those of `Wall`, one for each radius.
    """
    helix, radius = whole_helix(wall), column("radius", wall.radius)
    K = helix.sectors
    length = max(body.position + body.length for body in string)
    ends = ((end - helix.start_depth) / helix.pitch - helix.first / K for end in (lower_end - length, lower_end))
    first, stop = sorted(ends)
    first, stop = math.floor(first) - 2, math.ceil(stop) + 2
    own = slice(min(K * max(first, 0), radius.size), min(K * max(stop, 0), radius.size))  # the last turn may be cut
    if own.start >= own.stop:
        return None
    lack = (own.start - K * first, K * stop - own.stop)

    def part(values: Any, beyond: float) -> Floats:
        padded: Floats = np.pad(values[own], lack, constant_values=beyond)
        return padded

    place = (helix.start_depth, helix.start_toolface, helix.pitch, K, helix.first + K * first)
    middle = length / 2
    bodies = [(middle - body.position - body.length, middle - body.position, body.diameter) for body in string]
    path, threads = core_path(getattr(wall, "path", None)), thread_count(getattr(wall, "threads", None))
    known = np.isfinite(radius) if sampled is None else sampled
    inward = None if sigma is None else _inward(radius[own], sigma[own], K)
    row = round((lower_end - middle - helix.start_depth) / helix.pitch - helix.first / K - 0.5) - first
    for at_most in (False, True):
        if at_most:
            known = _touched(wall, known)
            inward = None if inward is None else _filled(inward)
        radii = part(np.where(known, radius, OPEN) if at_most else radius, OPEN)
        counts = np.empty(0) if at_most else part(known.astype(np.float64), 1.0)
        counted = known | (not at_most)  # hole that counts as open has no error
        errors = np.empty(0) if inward is None else np.pad(np.where(counted[own], inward, 0.0), lack)
        found = _core.passage_columns(place, radii, path, bodies, counts, errors, threads, row)
        clearance, body = float(found["clearance"][row]), int(found["contact_body"][row, 0])
        if math.isfinite(clearance):
            low, high = float(found["low"][row]), float(found["high"][row])
            depth = float(found["contact_depth"][row, 0])
            return Hanging(clearance, low, high, depth, body, at_most) if clearance < OPEN else None
    return None


def _touched(wall: WallLike, sampled: Mask) -> Mask:
    """Return which radii bound what passes: those that are sampled, and those at a sample."""
    near: Floats | None = getattr(wall, "nearest", None)
    return sampled if near is None else sampled | (near <= TOUCHED)


def _filled(errors: Floats) -> Floats:
    """Return uncertainties of radii; those not known are as large as the others are in the middle."""
    known = errors[np.isfinite(errors)]
    return np.where(np.isnan(errors), np.median(known), errors) if known.size else errors


def without_noise(radius: Floats, sigma: Floats, sectors: int) -> Floats:
    """Return radii, each nearer to the mean of those beside it by QUIET x sigma; their uncertainty is SURER x sigma.

    A body touches where the hole is narrowest. Of hundreds of radii with an error each, the narrowest lies far too
    near: without this, a body was said to stick in a hole of bit size.
    """
    held = radius.size // sectors * sectors
    turns, error = radius[:held].reshape(-1, sectors), sigma[:held].reshape(-1, sectors)
    known = np.isfinite(turns)
    total, count = (_beside(values) for values in (np.where(known, turns, 0.0), known.astype(np.float64)))
    mean = total / np.maximum(count, 1.0)
    away = turns - mean
    quiet = mean + np.copysign(np.maximum(0.0, abs(away) - QUIET * error), away)
    found = np.array(radius)
    found[:held] = np.where(np.isfinite(quiet), quiet, turns).ravel()
    return found


def _beside(turns: Floats) -> Floats:
    """Return the sum of each value and those up to BESIDE turns and sectors away."""
    padded, found = np.pad(turns, ((BESIDE, BESIDE), (0, 0))), np.zeros_like(turns)
    for by in range(2 * BESIDE + 1):
        for turned in range(-BESIDE, BESIDE + 1):
            found += np.roll(padded[by : by + len(turns)], turned, axis=1)
    return found


def drift_of(wall: WallLike, length: float | str, sigma: Floats | None = None) -> Drift:
    """Return the greatest diameter of a rigid cylinder, as `Wall.drift` does."""
    if isinstance(length, str):
        if length not in MANDRELS:
            raise InputError("length", f"must be metres or one of {', '.join(MANDRELS)}", repr(length))
        length = MANDRELS[length]
    found = _solved(wall, (RigidBody(0.0, float(length)),), sigma, False)
    for name in ("clearance", "low", "high"):
        found[name] = np.maximum(found[name], 0.0)
    return Drift(**found)


def _solved(wall: WallLike, string: Sequence[RigidBody], sigma: Floats | None, upper_limit: bool) -> dict[str, Any]:
    if basis_of(wall) != "azimuthal":
        raise InputError("passage", f"needs a shape that was measured; this wall: {basis_text_of(wall)}")
    helix, radius = whole_helix(wall), column("radius", wall.radius)
    K, pitch = helix.sectors, helix.pitch
    turns = radius.size // K
    length = max(body.position + body.length for body in string)
    if length > turns * abs(pitch):
        rule = f"must be shorter than the wall, {turns * abs(pitch):g} m of whole turns"
        raise InputError("length of the string", rule, f"{length:g}")
    path: Path | None = getattr(wall, "path", None)
    middle = length / 2
    bodies = [(middle - body.position - body.length, middle - body.position, body.diameter) for body in string]
    sampled: Mask | None = getattr(wall, "sampled", getattr(wall, "measured", None))
    errors = np.empty(0) if sigma is None else _inward(radius, column("sigma", sigma, radius.size, "radius"), K)
    if upper_limit and sampled is not None:
        sampled, errors = _touched(wall, sampled), _filled(errors)
        errors = np.where(sampled, errors, 0.0) if errors.size else errors  # hole that counts as open has none
        radius, sampled = np.where(sampled, radius, OPEN), None
    counts = np.empty(0) if sampled is None else sampled.astype(np.float64)
    threads = thread_count(getattr(wall, "threads", None))
    place = (helix.start_depth, helix.start_toolface, pitch, K, helix.first)
    found = _core.passage_columns(place, radius, core_path(path), bodies, counts, errors, threads)
    depth = helix.turn_depths(turns)
    return found | {
        "depth": depth,
        "curvature": _curvature(path, depth, length),
        "string": tuple(string),
        "height": abs(pitch),
    }


def _inward(radius: Floats, sigma: Floats, sectors: int) -> Floats:
    """Return the uncertainty of each radius, metres; at most what makes it as narrow as the hole beside it.

    A radius at the edge of a washout or key seat may be that of either, so its uncertainty is great. But it is not less
    than that of the gauge hole, where the string clears what it clears beside the edge.
    """
    held = radius.size // sectors * sectors
    wide, sure = radius[:held].reshape(-1, sectors), sigma[:held].reshape(-1, sectors)
    least, surest = wide.copy(), sure.copy()
    for away in range(1, BESIDE + 1):
        for own, other in ((slice(away, None), slice(None, -away)), (slice(None, -away), slice(away, None))):
            for here in ((own, slice(None)), (slice(None), own)):
                there = tuple(other if part is own else part for part in here)
                np.fmin(least[here], wide[there], out=least[here])
                np.fmin(surest[here], sure[there], out=surest[here])
    found = np.array(sigma)
    found[:held] = np.minimum(sure, (wide - least) / 1.96 + 3.0 * surest).ravel()  # NaN: not known
    return found


def _curvature(path: Path | None, depth: Floats, length: float) -> Floats:
    """Return what the curvature of a path costs a cylinder: length x angle / 8, twice the height of the arc, metres."""
    cost = np.full(depth.size, np.nan)
    if path is None:
        return cost
    inside = (depth - length / 2 >= path.start_depth) & (depth + length / 2 <= path.stop_depth)
    upper, lower = (path.tangent(depth[inside] + side * length / 2) for side in (-1, 1))
    chord = np.linalg.norm(lower - upper, axis=1) / 2
    cost[inside] = length * 2 * np.arcsin(np.minimum(chord, 1)) / 8
    return cost


def _numbers(body: Integers) -> Floats:
    return np.where(body < 0, np.nan, body + 1.0)

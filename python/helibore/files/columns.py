"""Channels with roles become what the rest takes: wall samples, a survey, a sector image. Metres and degrees from here.

    radius    -> one wall point a row at toolface + angle
    diameter  -> two, half of it each, at toolface + angle and opposite
    (n, K) radius-image -> K a row at first + i * step (+ toolface where there is one)

Rows without a value are left out and counted. Nothing is converted on a suspicion: a diameter in a radius's place,
radians in a degree's, a unit that cannot be right are errors that say so (``suspect``).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from helibore import units
from helibore.roles import ROLES, Role, RoleMap, guess
from helibore.survey import Survey

from . import suspect
from .channel import LogSet
from .source import complaint

if TYPE_CHECKING:
    from helibore.caliper import Caliper

Floats = npt.NDArray[np.float64]

LARGEST_RADIUS = 2.0
"""Metres: the largest radius a Caliper holds."""


@dataclass(frozen=True)
class WallSamples:
    """Wall points of a set, in file order; a row's points follow one another.

    Attributes
    ----------
    depth, toolface, radius
        Metres, degrees in [0, 360), metres; (n,) float64.
    time
        Seconds, None where the set has no time.
    row
        Row of the set each point came from, (n,) int64.
    rows
        Rows in the set.
    dropped
        Channel to how many of its values were missing and left out.
    notes
        One sentence for each channel used: its role, unit and reason.
    """

    depth: Floats
    toolface: Floats
    radius: Floats
    time: Floats | None
    row: npt.NDArray[np.int64]
    rows: int
    dropped: dict[str, int] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class SectorColumns:
    """A sector image as it stands in the file.

    Attributes
    ----------
    name, unit
        As in the file.
    depth
        (n,) float64, metres, strictly growing or strictly falling.
    values
        (n, K), NaN where missing.
    first, step
        Angle of the first sector and from one to the next, degrees, as the file or a map states; None where neither
        does. Whether a sector starts or is centred there is for the caller to know: files do not say.
    members
        The columns it was joined from.
    dropped
        Rows left out because they have no depth.
    """

    name: str
    unit: str
    depth: Floats
    values: npt.NDArray[np.floating]
    first: float | None
    step: float | None
    members: tuple[str, ...]
    dropped: int


def column(one: LogSet, role: Role) -> Floats:
    """Return a channel in metres, degrees or seconds. A unit that is missing or does not fit is an error."""
    kind = ROLES[role.role]
    values = one.numbers(role.channel)
    if not kind:
        return values
    if not role.unit and role.role != "time":
        inferred = suspect.unstated_angle(values) if kind == units.ANGLE else ""
        if not inferred:
            rule = f'unit missing: state it in a map ([channels."{role.channel}"] unit = ...); {role.role} is {kind}'
            raise complaint(one.path, rule, column=role.channel)
        return values
    try:
        return values * (units.factor(role.unit, kind) if role.unit else 1.0)
    except ValueError as error:
        raise complaint(one.path, str(error), column=role.channel) from error


def caliper(one: LogSet, roles: RoleMap | None = None, bit_diameter: float | None = None) -> Caliper:
    """Return the wall samples of a set as a Caliper; :func:`samples` also tells what was left out.

    A radius that no Caliper holds (0, a spike of metres) is an error that names its line: condition the samples first.
    """
    from helibore.caliper import Caliper

    found = samples(one, roles, bit_diameter)
    wrong = np.flatnonzero((found.radius <= 0.0) | (found.radius > LARGEST_RADIUS))
    if wrong.size:
        radius, row = found.radius[wrong[0]], int(found.row[wrong[0]])
        rule = (
            f"radius {radius:g} m: must be larger than 0 and at most {LARGEST_RADIUS:g} m; condition the samples first"
        )
        raise complaint(one.path, rule, one.place(row))
    try:
        return Caliper(found.depth, found.toolface, found.radius, found.time)
    except ValueError as error:
        raise complaint(one.path, str(error)) from error


def samples(one: LogSet, roles: RoleMap | None = None, bit_diameter: float | None = None) -> WallSamples:
    """Turn the channels of a set into wall points.

    Parameters
    ----------
    one
        A set of an opened file.
    roles
        What each channel means; guessed where None.
    bit_diameter
        Metres. Known, it decides whether a radius is one; else a ``bit-diameter`` channel does.

    Raises
    ------
    ValueError
        If there is no depth, no wall channel or no toolface; a unit is missing, unknown or of the wrong kind; values
        cannot be what their role says; or nothing is left.
    """
    roles = roles or guess(one)
    depth = column(one, _needed(one, roles, "depth"))
    arms = roles.all("radius", "diameter", "radius-image")
    if not arms:
        raise complaint(one.path, _no_arms(roles))
    turning = roles.one("toolface")
    toolface = np.zeros(one.rows)
    if turning is not None:
        toolface = column(one, turning)
        suspect.angles(one, turning, toolface)
    bit = bit_diameter if bit_diameter is not None else _bit(one, roles)
    time = _time(one, roles)
    valid = np.isfinite(depth) & np.isfinite(toolface)
    grids = []
    for arm in arms:
        radius = column(one, arm).reshape(one.rows, -1)
        suspect.lengths(one, arm, radius, bit)
        angles, radius = _points(one, arm, radius, turning is not None)
        grids.append((toolface[:, None] + angles, radius))
    dropped = _count_missing(one, roles, depth, toolface, time)
    if time is not None:
        valid &= np.isfinite(time)
    angle, radius = (np.concatenate(parts, axis=1) for parts in zip(*grids, strict=True))
    keep = valid[:, None] & np.isfinite(radius)
    row = np.broadcast_to(np.arange(one.rows)[:, None], radius.shape)[keep]
    if not row.size:
        raise complaint(one.path, f"no row has depth, toolface and a radius ({_told(dropped) or 'no values'})")
    wrapped = angle[keep] % 360.0
    wrapped[wrapped == 360.0] = 0.0  # the remainder of a tiny negative angle
    times = time[row] if time is not None else None
    return WallSamples(depth[row], wrapped, radius[keep], times, row, one.rows, dropped, _notes(roles, arms))


def _needed(one: LogSet, roles: RoleMap, role: str) -> Role:
    found = roles.one(role)
    if found is None:
        near = [f"; {each.channel} is {each.reason}" for each in roles if f"like {role}, but" in each.reason]
        rule = f'no channel has the role {role}: name one in a map ([channels."..."] role = "{role}"){"".join(near)}'
        raise complaint(one.path, rule)
    return found


def _no_arms(roles: RoleMap) -> str:
    means = [each.channel for each in roles.all("mean-diameter")]
    if means:
        return f"{', '.join(means)}: a mean diameter has no direction; no channel has the role radius or diameter"
    return "no channel has the role radius, diameter or radius-image: name one in a map"


def _told(dropped: dict[str, int]) -> str:
    return ", ".join(f"{count} values missing in {name}" for name, count in dropped.items())


def _points(one: LogSet, arm: Role, radius: Floats, turning: bool) -> tuple[Floats, Floats]:
    """Angles (1, p) from the toolface and radii (n, p) of one arm."""
    if arm.role == "radius-image":
        if arm.first is None or arm.step is None:
            rule = "the angles of its sectors are not stated: set first and step (degrees) in a map"
            raise complaint(one.path, rule, column=arm.channel)
        return np.array([[arm.first + arm.step * sector for sector in range(radius.shape[1])]]), radius
    if radius.shape[1] != 1:
        rule = f"a {arm.role} has one value a row, this has {radius.shape[1]}: its role is radius-image"
        raise complaint(one.path, rule, column=arm.channel)
    if arm.angle is None and not turning:
        rule = "no toolface: name the toolface channel, or the angle of this one, in a map"
        raise complaint(one.path, rule, column=arm.channel)
    if arm.angle is not None and not turning and not arm.confirmed and "arm pair" in arm.reason:
        rule = "an arm pair that turns with the tool needs a toolface: name the channel, or confirm the angle, in a map"
        raise complaint(one.path, rule, column=arm.channel)
    angle = arm.angle or 0.0
    if arm.role == "radius":
        return np.full((1, 1), angle), radius
    return np.full((1, 2), (angle, angle + 180.0)), np.repeat(radius / 2.0, 2, axis=1)


def _bit(one: LogSet, roles: RoleMap) -> float | None:
    """Median of the bit-diameter channel, metres."""
    role = roles.one("bit-diameter")
    if role is None or not role.unit:
        return None
    values = column(one, role)
    return float(np.median(values[np.isfinite(values)])) if np.isfinite(values).any() else None


def _time(one: LogSet, roles: RoleMap) -> Floats | None:
    """Seconds: as stated, or since 1970 where the file holds dates."""
    role = roles.one("time")
    if role is None:
        return None
    channel = one[role.channel]
    if not channel.is_text:
        return column(one, role)
    seconds = np.full(one.rows, np.nan)
    for row, cell in enumerate(channel.values):
        if cell:
            try:
                seconds[row] = np.datetime64(cell.rstrip("Z"), "us").astype(np.int64) / 1e6
            except ValueError:
                rule = f"{cell[:40]!r} is no ISO 8601 date and time"
                raise complaint(one.path, rule, one.place(row), role.channel) from None
    return seconds


def _count_missing(one: LogSet, roles: RoleMap, depth: Floats, toolface: Floats, time: Floats | None) -> dict[str, int]:
    """How many values of each channel used are missing, where any are."""
    named = {"depth": depth, "toolface": toolface, "time": time}
    counts = {}
    for role in roles.all("depth", "toolface", "time"):
        values = named[role.role]
        if values is not None:
            counts[role.channel] = int(np.count_nonzero(~np.isfinite(values)))
    for role in roles.all("radius", "diameter", "radius-image"):
        counts[role.channel] = one[role.channel].missing
    return {name: count for name, count in counts.items() if count}


def _notes(roles: RoleMap, arms: list[Role]) -> tuple[str, ...]:
    used = [*roles.all("depth", "toolface", "time", "bit-diameter"), *arms]
    return tuple(f"{role.channel} is {role.role} in {role.unit or 'no stated unit'}: {role.reason}" for role in used)


def survey(one: LogSet, roles: RoleMap | None = None) -> Survey:
    """Return the directional survey of a set.

    Stations without depth, inclination or azimuth are left out; the set's remarks say how many.

    Raises
    ------
    ValueError
        If a column is not there, its unit is missing or wrong, degrees look like radians, or depth does not grow.
    """
    roles = roles or guess(one)
    named = {role: _needed(one, roles, role) for role in ("depth", "inclination", "azimuth")}
    columns = {role: column(one, found) for role, found in named.items()}
    suspect.survey_angles(one, named["inclination"], named["azimuth"], columns["inclination"], columns["azimuth"])
    keep = np.isfinite(columns["depth"]) & np.isfinite(columns["inclination"]) & np.isfinite(columns["azimuth"])
    if not keep.all():
        remark = f"survey: {int(np.count_nonzero(~keep))} of {one.rows} stations left out: a value is missing"
        if remark not in one.remarks:
            one.remarks.append(remark)
    rows = np.flatnonzero(keep)
    depth = columns["depth"][rows]
    falls = np.flatnonzero(np.diff(depth) <= 0)
    if falls.size:
        first = int(falls[0])
        kind = "repeats" if depth[first] == depth[first + 1] else "falls from"
        rule = f"depth {depth[first + 1]:g} m {kind} {depth[first]:g} m: must grow"
        raise complaint(one.path, rule, one.place(int(rows[first + 1])), named["depth"].channel)
    try:
        return Survey(depth, columns["inclination"][rows], columns["azimuth"][rows])
    except ValueError as error:
        raise complaint(one.path, str(error)) from error


def image(one: LogSet, name: str, roles: RoleMap | None = None) -> SectorColumns:
    """Return a sector image with its depth; rows without a depth are left out and counted.

    Raises
    ------
    ValueError
        If the channel has no sectors, or depth does not strictly grow or strictly fall.
    """
    roles = roles or guess(one)
    channel = one[name]
    if len(channel.shape) != 2:
        images = [each.channel for each in roles.all("image", "radius-image")]
        raise complaint(one.path, f"has no sectors; the images are {', '.join(images) or 'none'}", column=name)
    named = _needed(one, roles, "depth")
    depth = column(one, named)
    rows = np.flatnonzero(np.isfinite(depth))
    if not rows.size:
        raise complaint(one.path, "has no value", column=named.channel)
    steps = np.diff(depth[rows])
    wrong = np.flatnonzero(steps <= 0 if steps.sum() >= 0 else steps >= 0)
    if wrong.size:
        at = int(wrong[0])
        before, after = depth[rows[at]], depth[rows[at + 1]]
        place = one.place(int(rows[at + 1]))
        rule = f"depth {after:g} m after {before:g} m: an image's depth must strictly grow or strictly fall"
        raise complaint(one.path, rule, place, named.channel)
    role = roles.roles.get(name) or Role(name, "image", "")
    dropped = one.rows - rows.size
    return SectorColumns(
        name, channel.unit, depth[rows], channel.values[rows], role.first, role.step, channel.members, dropped
    )

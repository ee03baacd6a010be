"""Turn channels with roles into readings: what each sensor measured in each row, in metres, degrees and seconds.

    radius        one sensor, at its angle            radius-image  one sensor for each sector, at first + i * step
    diameter      two sensors of half the diameter,   travel-time   times of one sensor or of sectors, which an Echo
                  at its angle and on the other side                converts to radii

Readings keep the flaws of the log; ``helibore.preparation.prepare`` finds and corrects them. A likely mistake raises an
error and is never corrected silently: a diameter in place of a radius, radians read as degrees, a wrong unit
(``plausibility``).
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np

from helibore.base import units
from helibore.base.angles import wrapped
from helibore.base.arrays import Floats, Integers, Mask
from helibore.base.errors import InputError
from helibore.channels import plausibility
from helibore.channels.columns import about_names, column, needed
from helibore.channels.header_entries import log_header
from helibore.channels.roles import ROLES, WALL, Role, RoleMap, guess, toolface_reference, toolface_rule
from helibore.files.headings import is_number
from helibore.files.raw_set import Channel, RawSet
from helibore.preparation.readings import IMAGE_ROW, HoleDirection, Readings
from helibore.preparation.sensors import Sensor
from helibore.samples.bit_sizes import FEW
from helibore.trajectory.references import Plane, to_high_side

if TYPE_CHECKING:
    from helibore.settings.preparation_settings import Echo

REFERENCE_WORDS = {"high-side": "the high side", "horizontal-north": "north, in the horizontal plane"}
"""Words of `note` for what a toolface counts from."""

ANGLES_AGREE = 0.5
"""Degrees: two toolfaces of one set agree if the median and the spread of their difference are at most this."""

UNSTATED = {
    units.ANGLE: "deg, since a value is beyond 2 pi (no unit stated)",
    units.TIME: "s, as no unit is stated",
}
"""Texts of `note` on the unit of a channel without a stated unit; the key is what the channel measures."""

SETTINGS = {role: f"columns.{role}" for role in ("depth", "toolface", "radius", "diameter")} | {
    "radius-image": "columns.radius", "travel-time": "columns.travel_time",
}  # fmt: skip
"""The setting that names the columns of a role, and their units."""

CALIPER_NAME = re.compile("rad|cal|arm|finger", re.IGNORECASE)
"""What the name of a caliper's channel may hold."""

ONE_BIT = 0.001
"""Metres: sizes of a bit that differ by less are those of one bit."""
BITS = (0.03, 1.5)
"""Metres: the least and the greatest bit that the header of a file may state."""

TIME_OF_DAY = re.compile(r"\d{1,2}:\d\d(:\d\d(\.\d*)?)?")
WITH_TIME = re.compile(r"(\S+[T ]\d[\d:.]*) ?(Z|UTC|[+-]\d\d(?::?\d\d)?)?")
"""A date with a time of day, and perhaps its zone."""

NORTH = ("n", "north", "m", "mtf", "magnetic", "0")
HIGH_SIDE = ("h", "hs", "high side", "high-side", "g", "gtf", "gravity", "top", "1")


def readings(
    log_set: RawSet,
    roles: RoleMap | None = None,
    bit_diameter: float | None = None,
    echo: Echo | None = None,
    tracked: bool = False,
) -> Readings:
    """Return what each sensor measured in each row of a set, for `helibore.prepare`.

    Parameters
    ----------
    roles
        What each channel means; None: the roles are guessed.
    bit_diameter
        Metres; None: from a ``bit-diameter`` channel if there is one. Radii are compared with it, to find diameters
        that are given as radii.
    echo
        How travel times become radii; None: a channel of travel times is refused.
    tracked
        Whether depths and toolfaces come from another source by time; the set then needs a time, but neither a depth
        nor a toolface.

    Raises
    ------
    InputError
        If a channel that is needed is missing; a unit is missing, unknown or of the wrong kind; a depth is NaN or
        infinite (an empty depth is allowed); or values cannot be what their role says.
    """
    roles = roles or guess(log_set)
    arms = roles.all(*WALL)
    if not arms:
        raise log_set.input_error(_no_arms(log_set, roles))
    depth = np.full(log_set.rows, np.nan)
    if not tracked or roles.one("depth"):
        role = needed(log_set, roles, "depth")
        depth = column(log_set, role, SETTINGS["depth"])
        odd = log_set[role.channel].odd_row
        if odd is not None:
            raise log_set.input_error("NaN or infinite: a depth must be finite, or empty", odd, role.channel)
        plausibility.depths(log_set, role, depth)
    turning = roles.one("toolface")
    toolface = np.zeros(log_set.rows)
    if turning is not None:
        toolface = column(log_set, turning, SETTINGS["toolface"])
        plausibility.angles(log_set, turning, toolface)
    bit = bit_diameter if bit_diameter is not None else bit_of_channel(log_set, roles)
    sensors: list[Sensor] = []
    radii: list[Floats] = []
    arm: list[str] = []
    across: list[bool] = []
    for role in arms:
        radius = _radius(log_set, role, bit, echo)
        angles = _angles(log_set, role, radius.shape[1], turning is not None or tracked)
        sensors += [Sensor(role.channel, role.offset, angle, role.latency) for angle in angles]
        radii += list(radius.T) if len(angles) == radius.shape[1] else [0.5 * radius[:, 0]] * 2
        arm += _arm_names(log_set, role, radius.shape[1]) * (len(angles) // radius.shape[1])
        across += [role.role == "diameter"] * len(angles)
    names = list(dict.fromkeys(arm))
    time = _time(log_set, roles, tracked)
    if tracked and time is None:
        needed(log_set, roles, "time")
    return Readings(
        log_set.path.name, depth, toolface, tuple(sensors), tuple(radii),
        np.array([names.index(name) for name in arm], dtype=np.int64), tuple(names), tuple(across), time,
        _passes(log_set, roles),
        turning.reference if turning else "", _high_side(log_set, roles), turning is not None,
        _count_missing(log_set, roles, depth, toolface, time),
        (*_notes(roles, arms), *agreement_of_angles(log_set, roles)),
        turning.north if turning else "", _hole(log_set, roles), log_set.place, _echo_of_all(log_set, arms, echo),
    )  # fmt: skip


def _echo_of_all(log_set: RawSet, arms: Sequence[Role], echo: Echo | None) -> Echo | None:
    """Return how travel times became radii if all arms have them; refuse casing where an arm has none."""
    timed = [arm for arm in arms if arm.role == "travel-time"]
    if len(timed) == len(arms):
        return echo
    if timed and echo is not None and echo.casing:
        other = next(arm.channel for arm in arms if arm not in timed)
        rule = f"a casing measures the velocity for travel times, and {other} is none: read one of them"
        raise log_set.input_error(rule, column=timed[0].channel)
    return None


def _no_arms(log_set: RawSet, roles: RoleMap) -> str:
    """Return the error text for a set without a wall channel; it says what the set can be used for instead."""
    means = [each.channel for each in roles.all("mean-diameter")]
    if means:
        return (
            f"{', '.join(means)}: a mean diameter has no direction; no channel has the role radius or diameter "
            "(as an average caliper, hb.Caliper.from_average, it makes a round hole)"
        )
    rule = "no channel has the role radius, diameter or radius-image: name one by an option or in a map"
    standoffs = [each for each in roles if each.role == "none" and "a standoff counts" in each.reason]
    if standoffs:
        return f"{standoffs[0].channel}: {standoffs[0].reason.replace('NAME', standoffs[0].channel)}"
    images = [each.channel for each in roles.all("image")]
    if images:
        return f"{rule} (its images {', '.join(images)} lie on a gauge hole, hb.Caliper.gauge)"
    if roles.one("inclination") is not None and roles.one("azimuth") is not None:
        return f"{rule} (it holds a survey, not a caliper)"
    near = [
        each.name for each in log_set
        if CALIPER_NAME.search(each.name) and not each.is_text and len(each.shape) == 1
        and units.measures(each.unit) in ("", units.LENGTH)
    ]  # fmt: skip
    how = f"columns.radius={near[0] if len(near) == 1 else 'NAME'}:in"
    depth = roles.one("depth")
    if depth is not None and not depth.unit:
        how += f" and columns.depth={depth.channel}:ft, since {depth.channel} states no unit"
    return f"{rule}, such as {how}; the channels are {', '.join(log_set.names)}{about_names(log_set)}"


def _radius(log_set: RawSet, arm: Role, bit: float | None, echo: Echo | None) -> Floats:
    """Return the readings of a wall channel as (n, p) radii or diameters, metres, for p values in each row."""
    values = column(log_set, arm, SETTINGS[arm.role]).reshape(log_set.rows, -1)
    if arm.role == "travel-time":
        if echo is None:
            raise log_set.input_error(
                "a travel time needs the velocity in the mud and the tool's radius", column=arm.channel
            )
        values = echo.radius(values)
    if arm.zero:
        values = values + (2.0 * arm.zero if arm.role == "diameter" else arm.zero)
    plausibility.lengths(log_set, arm, values, bit)
    if arm.role in ("radius", "diameter") and values.shape[1] != 1:
        rule = f"a {arm.role} has one value a row, this has {values.shape[1]}: its role is radius-image"
        raise log_set.input_error(rule, column=arm.channel)
    return values


def _angles(log_set: RawSet, arm: Role, width: int, turning: bool) -> list[float]:
    """Return the directions in which the sensors of one channel look, degrees from the toolface."""
    if width > 1 or arm.role == "radius-image":
        if arm.first is None or arm.step is None or np.isnan(arm.step):
            stated = "not stated" if arm.first is None or arm.step is None else "uneven"
            rule = f"the angles of its sectors are {stated}: set first and step (degrees) in a map"
            rule += f", or, if they are even around the tool, columns.radius={arm.channel}@ANGLE, that of the first"
            names = log_set[arm.channel].member_names if width < IMAGE_ROW else ()
            if names and arm.role == "radius-image":
                each = " ".join(f"columns.radius={name}@{360 * at / width:g}" for at, name in enumerate(names))
                rule += f", or name the arms of a tool with few arms: {each}"
            raise log_set.input_error(rule, column=arm.channel)
        return [arm.first + arm.step * sector for sector in range(width)]
    if arm.angle is None and not turning:
        rule = "no toolface: name the toolface channel, or the angle of this channel, by an option or in a map"
        raise log_set.input_error(rule, column=arm.channel)
    if arm.angle is not None and not turning and not arm.confirmed and arm.turns:
        rule = "an arm pair that turns with the tool needs a toolface: name its channel in a map"
        rule += f"; of a tool that does not turn, state the angle of each pair: columns.diameter={arm.channel}@0"
        raise log_set.input_error(rule, column=arm.channel)
    angle = arm.angle or 0.0
    return [angle, angle + 180.0] if arm.role == "diameter" else [angle]


def _arm_names(log_set: RawSet, role: Role, width: int) -> list[str]:
    """Return the name of the arm of each value in a row.

    If a row has two or more values but too few for an image, each value has its own arm. Otherwise all values belong
    to one arm.
    """
    if not 1 < width < IMAGE_ROW:
        return [role.channel] * width
    members = log_set[role.channel].member_names
    return list(members) or [f"{role.channel}[{sector}]" for sector in range(1, width + 1)]


def bit_of_channel(log_set: RawSet, roles: RoleMap) -> float | None:
    """Return the median of the bit-diameter channel, metres; None if there is no such channel, unit or value."""
    role = roles.one("bit-diameter")
    known = plausibility.present(column(log_set, role)) if role is not None and role.unit else np.empty(0)
    return float(np.median(known)) if known.size else None


def stated_bit(log_set: RawSet, roles: RoleMap) -> tuple[float, str] | None:
    """Return the one bit diameter that a set states, metres, and where: its bit-diameter channel, or else its header.

    Return None if it states none. Raise InputError if the channel has several.
    """
    role = roles.one("bit-diameter")
    known = plausibility.present(column(log_set, role)) if role is not None and role.unit else np.empty(0)
    if role is not None and known.size:
        low, high = float(known.min()), float(known.max())
        if high - low > ONE_BIT:
            rule = f"has bits from {units.size_text(low)} to {units.size_text(high)}: state that of the wall"
            raise InputError(f"{log_set.path.name}, column {role.channel}", rule, setting="wall.bit_diameter")
        return float(np.median(known)), role.channel
    text = log_header([log_set.header]).get("bit", "")
    with suppress(InputError):
        size = units.quantity(text, units.LENGTH) if text and not is_number(text) else np.nan
        if BITS[0] <= size <= BITS[1]:
            return size, "its header"
    return None


def _time(log_set: RawSet, roles: RoleMap, needed_here: bool) -> Floats | None:
    """Return the times of all rows in seconds, NaN where missing; None without a time channel.

    Dates become seconds since 1970; dates without a time zone are UTC. A time of day is joined with the date in the
    column DATE of its row. A channel whose role is a guess and whose first text is no date is not used, unless the
    time is needed.
    """
    role = roles.one("time")
    if role is None:
        return None
    channel = log_set[role.channel]
    if not channel.is_text:
        return column(log_set, role)
    cells = _dated(log_set, channel)
    first = next((cell.strip() for cell in cells if cell.strip()), "")
    if not needed_here and not role.confirmed and first and not _is_date(first):
        remark = f"{channel.name} is not used: {first[:40]!r} is no ISO 8601 date and time"
        if remark not in log_set.remarks:
            log_set.remarks.append(remark)
        return None
    seconds = np.full(log_set.rows, np.nan)
    zoned: bool | None = None
    for row, text in enumerate(cells):
        cell = text.strip()
        if not cell or cell.lower() == "nat":
            continue
        try:
            seconds[row], has_zone = _since_1970(cell)
        except ValueError:
            rule = f"{cell[:40]!r} is no ISO 8601 date and time"
            raise log_set.input_error(rule, row, role.channel) from None
        if has_zone is not (zoned if zoned is not None else has_zone):
            rule = (
                f"{cell[:40]!r} has {'a' if has_zone else 'no'} time zone, unlike the dates above: "
                "all dates must have one, or none"
            )
            raise log_set.input_error(rule, row, role.channel)
        zoned = has_zone
    return seconds


def _dated(log_set: RawSet, channel: Channel) -> list[str]:
    """Return the texts of a time channel; a time of day follows the text of the column DATE, if there is one."""
    cells: list[str] = channel.values.tolist()
    dates = next((each for each in log_set if each.is_text and each.name.upper() == "DATE"), None)
    if dates is None or not all(TIME_OF_DAY.fullmatch(cell.strip()) for cell in cells if cell.strip()):
        return cells
    pairs = zip(dates.values.tolist(), cells, strict=True)
    return [f"{date.strip()}T{cell.strip()}" if date.strip() and cell.strip() else "" for date, cell in pairs]


def _is_date(cell: str) -> bool:
    try:
        _since_1970(cell)
    except ValueError:
        return False
    return True


def _since_1970(cell: str) -> tuple[float, bool]:
    """Return the seconds since 1970 of a date in ISO 8601, and whether it has a time zone."""
    if cell.isalpha():  # NumPy would read "now" and "today"
        raise ValueError(cell)
    found = WITH_TIME.fullmatch(cell)
    text, zone = found.groups() if found else (cell, None)
    seconds = float(np.datetime64(text, "us").astype(np.int64)) / 1e6
    if zone and zone[0] in "+-":
        minutes = 60 * int(zone[1:3]) + int(zone[3:].removeprefix(":") or 0)
        seconds -= 60.0 * (minutes if zone[0] == "+" else -minutes)
    return seconds, zone is not None


def _passes(log_set: RawSet, roles: RoleMap) -> Integers | None:
    role = roles.one("pass")
    if role is None:
        return None
    values = log_set.numbers(role.channel)
    known = np.isfinite(values)
    broken = np.flatnonzero(known & (np.floor(values) != values))
    if broken.size:
        row = int(broken[0])
        raise log_set.input_error(f"{values[row]:g}: a pass is a whole number", row, role.channel)
    return np.where(known, values, -1.0).astype(np.int64)


def _high_side(log_set: RawSet, roles: RoleMap) -> Mask | None:
    """Return a mask of the rows whose toolface counts from the high side; None without a toolface-reference channel."""
    role = roles.one("toolface-reference")
    if role is None:
        return None
    channel = log_set[role.channel]
    words = channel.values if channel.is_text else [f"{value:g}" for value in channel.values]
    tagged = np.zeros(log_set.rows, dtype=bool)
    for row, word in enumerate(words):
        bare = str(word).strip().lower()
        tagged[row] = bare in HIGH_SIDE
        if not tagged[row] and bare not in NORTH:
            rule = f"must be one of {', '.join(NORTH)} (north) or {', '.join(HIGH_SIDE)} (high side)"
            raise log_set.input_error(f"{str(word)[:40]!r}: {rule}", row, role.channel)
    return tagged


def _hole(log_set: RawSet, roles: RoleMap) -> HoleDirection | None:
    """Return the direction of the hole at each row; None without inclination and azimuth, or if their units fail."""
    inclined, turned = roles.one("inclination"), roles.one("azimuth")
    usable = all(
        role is not None
        and role.unit
        and log_set[role.channel].shape == (log_set.rows,)
        and not log_set[role.channel].is_text
        for role in (inclined, turned)
    )
    if inclined is None or turned is None or not usable:
        return None
    inclination, azimuth = column(log_set, inclined), column(log_set, turned)
    known = np.isfinite(inclination) & np.isfinite(azimuth)
    if not known.any():
        return None
    return HoleDirection(inclination, azimuth, turned.north)


def agreement_of_angles(log_set: RawSet, roles: RoleMap) -> list[str]:
    """Compare the toolfaces of a set with each other, by the direction of the hole in the same set.

    Returns a sentence for each toolface that is not in use, with the median and the spread of the difference from the
    toolface in use. A constant difference is often that of two norths.
    """
    used, hole = roles.one("toolface"), _hole(log_set, roles)
    if used is None or hole is None or used.reference in ("", "automatic"):
        return []
    lines = []
    own = _from_high_side(log_set, used, hole)
    for channel in log_set:
        if channel.name == used.channel or channel.is_text or channel.shape != (log_set.rows,) or not channel.unit:
            continue
        if toolface_rule(channel) is None or units.measures(channel.unit) != units.ANGLE:
            continue
        reference, north = toolface_reference(channel)
        if not reference:
            continue
        other = Role(channel.name, "toolface", "", channel.unit, reference=reference, north=north)
        off = wrapped(_from_high_side(log_set, other, hole) - own + 180.0) - 180.0
        off = off[np.isfinite(off)]
        if off.size < FEW:
            continue
        middle = float(np.degrees(np.angle(np.mean(np.exp(1j * np.radians(off))))))
        away = wrapped(off - middle + 180.0) - 180.0
        middle += float(np.median(away))
        spread = 1.4826 * float(np.median(np.abs(away - np.median(away))))
        turned = roles.one("azimuth")
        between = f"{used.channel} and {channel.name}, by {turned.channel if turned else ''}"
        if abs(middle) <= ANGLES_AGREE and spread <= ANGLES_AGREE:
            lines.append(f"{between}: agree, to {middle:+.2f} deg (median), spread {spread:.2f} deg")
            continue
        norths = {
            one: each
            for one, each in ((channel.name, north), (used.channel, used.north), ("the hole", hole.north))
            if each
        }
        stated = f" (stated: {', '.join(f'{one} {each} north' for one, each in norths.items())})" if norths else ""
        lines.append(
            f"{between}: disagree by {middle:+.2f} deg (median), spread {spread:.2f} deg{stated}; {used.channel} is "
            "used. A constant difference may be the declination between two norths"
        )
    return lines


def _from_high_side(log_set: RawSet, role: Role, hole: HoleDirection) -> Floats:
    """Return a toolface channel counted from the high side, degrees, by the direction of the hole at each row."""
    angle = column(log_set, role)
    if role.reference == "high-side":
        return angle
    plane: Plane = "horizontal" if role.reference == "horizontal-north" else "section"
    return to_high_side(angle, hole.inclination, hole.azimuth, plane)


def _count_missing(
    log_set: RawSet, roles: RoleMap, depth: Floats, toolface: Floats, time: Floats | None
) -> dict[str, int]:
    """Return, for each channel in use that lacks values, how many are missing."""
    named = {"depth": depth, "toolface": toolface, "time": time}
    counts = {}
    for role in (*roles.all("depth", "toolface", "time"), *roles.all(*WALL)):
        values = None if role.role == "time" and not log_set[role.channel].is_text else named.get(role.role)
        missing = log_set[role.channel].missing if values is None else int(np.count_nonzero(~np.isfinite(values)))
        if missing:
            counts[role.channel] = missing
    return counts


def _notes(roles: RoleMap, arms: list[Role]) -> tuple[str, ...]:
    """Return a sentence for each role in use, and one for each group of sensors that look in one direction."""
    used = [*roles.all("depth", "toolface", "toolface-reference", "time", "pass", "bit-diameter"), *arms]
    by_direction: dict[tuple[str, float, float], list[str]] = {}
    for role in arms:
        if role.angle is not None:
            by_direction.setdefault((role.role, role.angle, role.offset), []).append(role.channel)
    advice = "to use one only, name it by an option or in a map"
    together = [
        f"{' and '.join(names)} are {kind} in one direction and are merged; {advice}"
        for (kind, _, _), names in by_direction.items()
        if len(names) > 1
    ]
    return (*(note(role) for role in used), *together)


def note(role: Role) -> str:
    """Return the sentence that states the role of a channel, the place of its sensor, and the reason."""
    parts = [f"{role.channel} is {role.role}"]
    kind = units.LENGTH if role.role == "bit-diameter" else role.role
    if kind not in ("pass", "toolface-reference"):
        parts.append(f"in {role.unit or UNSTATED.get(ROLES.get(kind, kind), 'no stated unit')}")
    if role.angle is not None:
        parts.append(f"at {role.angle:g} deg")
    if role.offset:
        parts.append(f"{role.offset:g} m up the string")
    if role.latency:
        parts.append(f"{role.latency:g} s late")
    if role.reference:
        parts.append(
            f"from {f'{role.north} ' if role.north else ''}{REFERENCE_WORDS.get(role.reference, role.reference)}"
        )
    return f"{' '.join(parts)}: {role.reason}"

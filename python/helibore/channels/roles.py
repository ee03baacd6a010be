"""Guess the role of each channel of a set, with a reason. A TOML map can override the guess.

    name, description, unit, shape  --guess-->  role: depth, toolface, radius, diameter, inclination, image ...
    [channels."pfc1_x_in"]  role = "diameter"  unit = "in"  angle = 0.0        (an entry of a map)

A guess uses names, descriptions, units and shapes, never the values. ``columns`` converts the values.
A ``diameter`` is two wall points, at ``angle`` and ``angle + 180``; a ``radius`` is one wall point. ``angle`` is
counted from the toolface channel if there is one, else from the toolface reference.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from helibore.base import units
from helibore.files.headings import unit_in_name
from helibore.files.raw_set import Channel, RawSet

ROLES: dict[str, str] = {
    "depth": units.LENGTH,
    "time": units.TIME,
    "toolface": units.ANGLE,
    "radius": units.LENGTH,
    "diameter": units.LENGTH,
    "mean-diameter": units.LENGTH,
    "radius-image": units.LENGTH,
    "travel-time": units.TIME,
    "image": "",
    "inclination": units.ANGLE,
    "azimuth": units.ANGLE,
    "tvd": units.LENGTH,
    "north": units.LENGTH,
    "east": units.LENGTH,
    "bit-diameter": units.LENGTH,
    "pass": "",
    "toolface-reference": "",
    "none": "",
}
"""Every role, and what its unit must measure ("" for any unit)."""

SINGLE = (
    "depth", "time", "toolface", "inclination", "azimuth", "tvd", "north", "east", "bit-diameter", "pass",
    "toolface-reference",
)  # fmt: skip
"""Roles that only one channel of a set can have; the channel that fits the earliest of `PATTERNS` gets the role."""

WALL = ("radius", "diameter", "radius-image", "travel-time")
"""Roles whose values are wall points."""

REFERENCES = ("north", "high-side", "automatic")
"""What a toolface channel may count from; automatic: north where the hole is nearly vertical, else the high side."""

# Role, pattern of the whole name (unit suffix taken off, lower case), pattern anywhere in the description.
# Within a role the earlier pattern wins, so "md" is taken before "tdep".
PATTERNS: tuple[tuple[str, str, str], ...] = (
    ("depth", r"md|m\.?depth|measured ?depth|depth[_ ]?md|md[_ ]?depth", r"^measured depth$"),
    ("depth", r"dept|depth|depthmd|dmd|hole[_ ]?depth", r"^depth$|\bdepth hole\b|\bmeasured depth\b"),
    ("depth", r"tdep|bdep|index", r"\bframe \d+ depth\b"),
    ("time", r"time|t|etim|elapsed|elapsed[_ ]?time|timestamp|utc|date[_ ]?time|dtimstn", r"^(elapsed )?time$"),
    ("toolface", r"toolface|tool[_ ]face|tf|tfo|gtf|mtf|hstf|sgtf|smtf", r"\btool ?face\b"),
    ("toolface", r"rb|hsrb|rbof|relative[_ ]bearing", r"\brelative bearing\b"),
    (
        "toolface",
        r"(p1|pad_?1_?)(az|azim|azimuth|no)(_\w+)?",
        r"\b(pad|arm|caliper|electrode) ?(1|one) (azimuth|north)",
    ),
    ("toolface", r"(at\d?)?[gm]tfm?", r"^$ never"),
    ("inclination", r"incl?|inclination|incdeg|innm|inclm?", r"\binclination\b"),
    ("inclination", r"devi?(_.*)?|deviation|hdev|drift", r"\bhole deviation\b"),
    ("azimuth", r"azi?|azim|azimuth|azideg|hazi|azin?m?", r"\b(hole )?azimuth\b"),
    ("tvd", r"tvd|tvdss", r"\btrue vertical depth\b"),
    ("north", r"n/s|n|ns|north|northing|dispns", r"^(northing|north[- ]south)\b"),
    ("east", r"e/w|e|ew|east|easting|dispew", r"^(easting|east[- ]west)\b"),
    ("bit-diameter", r"bs|bit[_ ]?size|bit[_ ]?d(iam(eter)?)?", r"\bbit ?size\b"),
    ("pass", r"pass([_ ]?(no|nr|number|id))?", r"^pass( number)?$"),
    ("toolface-reference", r"(toolface|tf)[_ ]?(ref(erence)?|type)", r"^toolface (reference|type)$"),
)
NO_RULE = "no rule fits"

NORTH = re.compile(r"(p1|pad_?1_?)(az|azim|azimuth|no)(_\w+)?|s?mtfm?|at\d?mtfm?")
"""Names of toolfaces that count from north: the azimuth of pad 1, and magnetic toolfaces."""
NORTH_TEXT = re.compile(r"(1|one) (azimuth|north)|\bmagnetic tool ?face\b|\bfrom (magnetic |true |grid )?north\b", re.I)

RADIUS = re.compile(r"(wall[_ ]?|hole[_ ]?|cal(iper)?[_ ]?)?(radius|radi)|r")
DIAMETER = re.compile(r"(wall[_ ]?|hole[_ ]?|cal(iper)?[_ ]?)?diam(eter)?|dia|d")
# One of the two arm pairs of an X-Y caliper: pfc1_x, cal_y, c1, xcal, caliper_2; by the numbers of the arms, C13, C24.
ARM = re.compile(
    r"(?:.*(?:cal|caliper|pfc|arm|diam)[a-z]*\d?[_ ]?)(x|y)|(x|y)[_ ]?cal(?:iper)?|(?:c|cal|caliper)[_ ]?(1|2|13|24)"
)
SIDE = re.compile(r"\bcaliper\b.*\b(horizontal|vertical)\b|\b(horizontal|vertical)\b.*\bcaliper\b", re.IGNORECASE)
ECHO = re.compile(r"(tw)?tt\d?|travel[_ ]?time|transit[_ ]?time|awtt|two[_ ]?way[_ ]?time")
MEAN = re.compile(r"hcal|cali?|calcm|caliper|.*cal.*(ave|avg|mean).*|(ave|avg|mean)[_ ]?cal.*|[du]cav")
# The largest or smallest diameter of a row: it is no mean and has no direction (cal_max_diameter, CMAX, HMIN).
EXTREME = re.compile(r".*(cal|diam).*(max|min).*|(max|min).*(cal|diam).*|[ch](max|min)")
CALIPER_TEXT = re.compile(r"\bcaliper\b(?!.*\b(matrix|filtered|corrected porosity|salinity)\b)", re.IGNORECASE)


@dataclass(frozen=True)
class Role:
    """The role of one channel, and the reason as a sentence."""

    channel: str
    role: str  # one of ROLES
    reason: str
    unit: str = ""  # of the values; "" if it is not known
    angle: float | None = None  # of a radius or diameter: its direction, degrees from the toolface; None: not known
    first: float | None = None  # of an image: angle of its first sector, degrees; None: not stated
    step: float | None = None  # of an image: angle from one sector to the next, degrees; None: not stated
    offset: float = 0.0  # of a wall channel: metres from the point whose depth is recorded up to its sensor
    latency: float = 0.0  # seconds from the measurement of this sensor to its time stamp
    reference: str = ""  # of a toolface: what it counts from, one of REFERENCES; "": as the wall's toolface
    confirmed: bool = False  # whether a map states this role, so that checks for likely mistakes are skipped

    @property
    def turns(self) -> bool:
        """Whether the channel is an arm pair, whose angle counts from the tool and so needs a toolface channel."""
        return "arm pair" in self.reason


@dataclass(frozen=True)
class RoleMap:
    """The roles of a set's channels, by channel name, in file order."""

    set_name: str | None = None
    roles: dict[str, Role] = field(default_factory=dict)

    def __iter__(self) -> Iterator[Role]:
        return iter(self.roles.values())

    def __getitem__(self, channel: str) -> Role:
        return self.roles[channel]

    def all(self, *roles: str) -> list[Role]:
        """Return the entries of all channels that have one of these roles."""
        return [each for each in self if each.role in roles]

    def one(self, role: str) -> Role | None:
        """Return the entry of the first channel that has this role, or None."""
        found = self.all(role)
        return found[0] if found else None


def guess(log_set: RawSet) -> RoleMap:
    """Guess the role of every channel of a set, each with its reason; the role is ``none`` if no role fits."""
    roles = {channel.name: _none(channel, NO_RULE) for channel in log_set}
    _single_roles(log_set, roles)
    has_toolface = any(role.role == "toolface" for role in roles.values())
    for channel in log_set:
        if roles[channel.name].role != "none" or channel.is_text:
            continue
        if len(channel.shape) == 2:
            roles[channel.name] = _image_role(channel)
        elif channel.shape[0] != log_set.rows:
            roles[channel.name] = _none(channel, f"{channel.shape[0]} values beside {log_set.rows} rows: an axis")
        else:
            roles[channel.name] = _wall_role(channel, has_toolface) or roles[channel.name]
    _text_roles(log_set, roles, has_toolface)
    _pair_arms(roles)
    return RoleMap(log_set.name, roles)


def _text_roles(log_set: RawSet, roles: dict[str, Role], has_toolface: bool) -> None:
    """Give a missing role to a text column whose name fits, so that an error names its bad cell later."""
    taken = {each.role for each in roles.values()}
    for channel in log_set:
        if not channel.is_text or roles[channel.name].role != "none" or len(channel.shape) != 1:
            continue
        for role, name, _ in PATTERNS:
            wanted = role in ("depth", "toolface", "inclination", "azimuth") and role not in taken
            if wanted and re.fullmatch(name, stem(channel)) and _fits(channel, ROLES[role]):
                reason = f"named {channel.name}, but not every cell is a number"
                roles[channel.name] = Role(channel.name, role, reason, channel.unit)
                taken.add(role)
                break
        found = None if taken & set(WALL) else _wall_role(channel, has_toolface or "toolface" in taken)
        if roles[channel.name].role == "none" and found is not None and found.role in WALL:
            roles[channel.name] = replace(found, reason=f"{found.reason}, but not every cell is a number")


def _none(channel: Channel, reason: str) -> Role:
    return Role(channel.name, "none", reason, channel.unit)


def stem(channel: Channel) -> str:
    """Return the channel's name in lower case without the unit at its end: ``pfc1_x_in`` -> ``pfc1_x``."""
    name = channel.name.lower()
    unit = unit_in_name(channel.name).lower()
    if unit and name.endswith(unit) and not name[: -len(unit)].endswith(("[", "(")):
        name = name[: -len(unit)].rstrip("_ ") or name
    return re.sub(r"\s*[\[(][^\])]*[\])]\s*$", "", name).strip()


def _fits(channel: Channel, kind: str) -> bool:
    """Return whether a channel's unit allows a role: the unit is of this kind or not stated, or no unit is needed."""
    return not kind or not channel.unit or units.measures(channel.unit) == kind


def _single_roles(log_set: RawSet, roles: dict[str, Role]) -> None:
    """Assign each role of `SINGLE` (depth, time, toolface ...) to the channel that fits it best.

    The other channels that fit a role do not get it; their reasons name the channel that has the role. If no channel
    fits depth, the index becomes the depth if its unit is one of length.
    """
    inclined = any(one.is_text and re.fullmatch(r"incl?|inclination|devi?|deviation", stem(one)) for one in log_set)
    for role, name, described in PATTERNS:
        for channel in log_set:
            allowed = not channel.is_text or role in ("time", "toolface-reference")
            how = _match(channel, name, described) if allowed and channel.shape == (log_set.rows,) else ""
            if not how or roles[channel.name].role != "none":
                continue
            if not _fits(channel, ROLES[role]):
                reason = f"{how}, like {role}, but {channel.unit!r} is no known unit of {ROLES[role]}"
                roles[channel.name] = _none(channel, reason)
                continue
            owner = next((each.channel for each in roles.values() if each.role == role), None)
            if owner is not None:
                roles[channel.name] = _none(channel, f"{how}, like {role}; {owner} has this role")
            elif role == "azimuth" and not inclined:
                reason = f"{how}, but a survey also needs an inclination (an angle around the hole is a toolface)"
                roles[channel.name] = _none(channel, reason)
            else:
                index = " and it is the index" if channel.name == log_set.index else ""
                reference = toolface_reference(channel) if role == "toolface" else ""
                roles[channel.name] = Role(channel.name, role, how + index, channel.unit, reference=reference)
                inclined = inclined or role == "inclination"
    first = log_set[log_set.index] if log_set.index else None
    placed = any(each.role == "depth" for each in roles.values())
    if first is None or placed or first.is_text or roles[first.name].role != "none":
        return
    if units.measures(first.unit) == units.LENGTH:
        roles[first.name] = Role(first.name, "depth", "it is the index and a length", first.unit)


def toolface_reference(channel: Channel) -> str:
    """Return "north" if the name or description of a toolface says that it counts from north, else ""."""
    return "north" if NORTH.fullmatch(stem(channel)) or NORTH_TEXT.search(channel.description) else ""


def _match(channel: Channel, name: str, described: str) -> str:
    if re.fullmatch(name, stem(channel)):
        return f"named {channel.name}"
    found = re.search(described, channel.description, re.IGNORECASE) if channel.description else None
    return f'described as "{channel.description}"' if found else ""


def _image_role(channel: Channel) -> Role:
    """Return the role of an image: a caliper image has a unit of length, and an echo image has travel times."""
    sectors = channel.shape[1]
    if channel.members:
        ends = f"{channel.member_names[0]} to {channel.member_names[-1]}"
        reason = f"{sectors} columns {ends}, numbered without a gap, one unit"
    else:
        reason = f"stored as an array of {sectors}"
    role = "image"
    if units.measures(channel.unit) == units.LENGTH:
        role, reason = "radius-image", f"{reason}, in a unit of length"
    elif _is_echo(channel):
        role, reason = "travel-time", f"{reason}, in a unit of time, named or described as a travel time"
    first = step = None
    axis = channel.axis
    if axis is not None and units.measures(axis.unit) == units.ANGLE:
        scale = units.factor(axis.unit, units.ANGLE)
        first = axis.first * scale if axis.first == axis.first else None
        step = None if axis.step is None else axis.step * scale
        stated = "not stated" if axis.step is None else f"{axis.step:g}" if axis.step == axis.step else "uneven"
        reason += f"; its axis starts at {axis.first:g} {axis.unit}, step {stated}"
    else:
        reason += "; the angle of its first sector is not stated"
    return Role(channel.name, role, reason, channel.unit, first=first, step=step)


def _is_echo(channel: Channel) -> bool:
    """Return whether a channel is named or described as a travel time, in a unit of time."""
    named = ECHO.fullmatch(stem(channel)) or re.search(r"\btravel ?time\b", channel.description, re.IGNORECASE)
    return bool(named) and units.measures(channel.unit) == units.TIME


def _wall_role(channel: Channel, has_toolface: bool) -> Role | None:
    """Return the role of a wall channel: radius, diameter, arm, travel time or mean diameter; None if none fits."""
    if _is_echo(channel):
        reason = f"named or described as a travel time ({channel.description or channel.name})"
        return Role(channel.name, "travel-time", reason, channel.unit, 0.0 if has_toolface else None)
    if not _fits(channel, units.LENGTH):
        return None
    name, unit = stem(channel), channel.unit
    if side := SIDE.search(channel.description):
        vertical = (side[1] or side[2]).lower() == "vertical"
        angle = 0.0 if vertical else 90.0
        reason = f'described as "{channel.description}": a diameter through {angle:g} and {angle + 180:g} deg'
        return Role(channel.name, "diameter", reason, unit, angle)
    if arm := ARM.fullmatch(name):
        letter = (arm[1] or arm[2] or {"1": "x", "2": "y"}[arm[3][0]]).lower()
        angle = {"x": 0.0, "y": 90.0}[letter]
        reason = f"named like the {letter} arm pair of a caliper: across the hole at {angle:g} deg from the toolface"
        return Role(channel.name, "diameter", reason, unit, angle)
    if EXTREME.fullmatch(name):
        return _none(channel, f"named {channel.name}: the extreme diameter of a row has no direction and is no mean")
    if RADIUS.fullmatch(name):
        return Role(channel.name, "radius", f"named {channel.name}", unit, 0.0 if has_toolface else None)
    if DIAMETER.fullmatch(name) and has_toolface:
        return Role(channel.name, "diameter", f"named {channel.name}", unit, 0.0)
    if MEAN.fullmatch(name) or DIAMETER.fullmatch(name) or (unit and CALIPER_TEXT.search(channel.description)):
        reason = f"named or described as a caliper ({channel.description or channel.name}) without a direction"
        return Role(channel.name, "mean-diameter", reason, unit)
    return None


def _pair_arms(roles: dict[str, Role]) -> None:
    """Remove the role of each arm pair that is named x or y if no pair has the other direction."""
    arms = [each for each in roles.values() if each.role == "diameter" and each.turns]
    if len({arm.angle for arm in arms}) == 1:
        for arm in arms:
            reason = "named like one arm pair of an X-Y caliper, but its partner at right angles is missing"
            roles[arm.channel] = replace(arm, role="none", reason=reason, angle=None)

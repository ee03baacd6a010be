"""Guess the role of each channel of a set, with a reason. A TOML map can override the guess.

    name, description, unit, shape  --guess-->  role: depth, toolface, radius, diameter, inclination, image ...
    [channels."pfc1_x_in"]  role = "diameter"  unit = "in"  angle = 0.0        (an entry of a map)

A guess uses names, descriptions, units and shapes, never the values. ``columns`` converts the values. The names are
data, in ``role_names.json``; every name is tried before any description, and a user's map can add names.
A ``diameter`` is two wall points, at ``angle`` and ``angle + 180``; a ``radius`` is one wall point. ``angle`` is
counted from the toolface channel if there is one, else from the toolface reference.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path

from helibore.base import units
from helibore.channels.sectors import NO_SECTORS_TEXT
from helibore.files.headings import unit_in_name
from helibore.files.raw_set import Channel, RawSet
from helibore.settings.role_settings import ROLES as ROLES

SINGLE = (
    "depth", "time", "toolface", "inclination", "azimuth", "tvd", "north", "east", "bit-diameter", "pass",
    "toolface-reference",
)  # fmt: skip
"""Roles that only one channel of a set can have; the channel that fits the earliest name gets it."""

WALL = ("radius", "diameter", "radius-image", "travel-time")
"""Roles whose values are wall points."""

NO_RULE = "no rule fits"

ECHO = re.compile(r"(tw)?tt\d?|travel[_ ]?time|transit[_ ]?time|awtt|two[_ ]?way[_ ]?time")
SONIC_TEXT = re.compile(r"\b(transit|transmitter|receiver|sonic|compressional|shear|integrated)\b", re.IGNORECASE)
"""Words in the description of one time a row through the formation, which is no echo from the wall."""
CALIPER_TEXT = re.compile(r"\bcaliper\b(?!.*\b(matrix|filtered|corrected porosity|salinity)\b)", re.IGNORECASE)
NORTH_TEXT = re.compile(r"\bfrom (magnetic |true |grid )?north\b", re.IGNORECASE)
ONE_OF_SEVERAL = re.compile(r"\b(arm|finger|radius)\b", re.IGNORECASE)

NAMES_FILE = Path(__file__).with_name("role_names.json")


@dataclass(frozen=True)
class NameRule:
    """One entry of the table of names: which names and descriptions mean a role, and what is known by the name."""

    role: str
    names: tuple[str, ...] = ()  # whole names, in lower case, without a unit
    pattern: str = "$ never"  # a regular expression for the whole name
    described: str = "$ never"  # a regular expression anywhere in the description
    never: str = "$ never"  # a regular expression that occurs neither in the name nor in the description
    reference: str = ""  # of a toolface: a `ToolfaceReference`, or "" for the wall's own
    north: str = ""  # of an angle from north: true, magnetic or grid; "": not known by the name
    angle: float | None = None  # of an arm: its direction, degrees from the toolface
    unit: str = ""  # of the values, where the file states none
    arm: str = ""  # "x" or "y": one pair of an X-Y caliper, which turns with the tool
    reason: str = ""  # why a channel of this name has no role
    unit_stated: bool = False  # whether the channel must state its unit
    needs_toolface: bool = False  # whether the set must have a toolface

    def named(self, channel: Channel) -> bool:
        """Return whether the name of a channel fits this rule."""
        return any(name in self.names or re.fullmatch(self.pattern, name) for name in _spellings(channel))

    def says(self, channel: Channel) -> bool:
        """Return whether the description of a channel fits this rule."""
        return bool(channel.description and re.search(self.described, channel.description, re.IGNORECASE))

    def allows(self, channel: Channel) -> bool:
        """Return whether nothing in a channel's name, description or unit rules the role out."""
        text = re.sub(r"_", " ", f"{channel.name} {channel.description}")
        return not re.search(self.never, text, re.IGNORECASE) and bool(channel.unit or not self.unit_stated)


@dataclass(frozen=True)
class RoleNames:
    """The names of channels by role: roles that one channel of a set has, wall channels, and sets of arms."""

    single: tuple[NameRule, ...]
    wall: tuple[NameRule, ...]
    sets: tuple[tuple[tuple[str, ...], float], ...]  # names of arms that belong together, and the angle between two

    def with_rules(self, rules: Iterable[NameRule]) -> RoleNames:
        """Return these names after ``rules``, which come first."""
        own = tuple(rules)
        return replace(
            self,
            single=(*(rule for rule in own if rule.role in SINGLE), *self.single),
            wall=(*(rule for rule in own if rule.role not in SINGLE), *self.wall),
        )


@cache
def _table() -> tuple[RoleNames, re.Pattern[str]]:
    table = json.loads(NAMES_FILE.read_text(encoding="utf-8"))
    single, wall = (
        tuple(NameRule(**{**entry, "names": tuple(entry.get("names", ()))}) for entry in table[part])
        for part in ("single", "wall")
    )
    sets = tuple((tuple(names), float(each["step"])) for each in table["sets"] for names in each["names"])
    return RoleNames(single, wall, sets), re.compile(f"(?:{'|'.join(table['endings'])})$")


def role_names() -> RoleNames:
    """Return the names that helibore knows, from the file ``role_names.json`` beside this one."""
    return _table()[0]


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
    zero: float = 0.0  # of a wall channel: metres added to its radii; of standoffs, the radius of the tool's face
    reference: str = ""  # of a toolface: what it counts from, a `ToolfaceReference`; "": as the wall's toolface
    north: str = ""  # of an angle from north: true, magnetic or grid; "": not stated
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


def guess(log_set: RawSet, names: RoleNames | None = None) -> RoleMap:
    """Guess the role of every channel of a set, each with its reason; the role is ``none`` if no role fits.

    ``names`` are the names to know; None: those of helibore.
    """
    names = names or role_names()
    roles = {channel.name: _none(channel, NO_RULE) for channel in log_set}
    _single_roles(log_set, roles, names)
    has_toolface = any(role.role == "toolface" for role in roles.values())
    for channel in log_set:
        if roles[channel.name].role != "none" or channel.is_text:
            continue
        if len(channel.shape) == 2:
            roles[channel.name] = _image_role(channel, names)
        elif channel.shape[0] != log_set.rows:
            roles[channel.name] = _none(channel, f"{channel.shape[0]} values beside {log_set.rows} rows: an axis")
        else:
            roles[channel.name] = _wall_role(channel, has_toolface, names) or roles[channel.name]
    _text_roles(log_set, roles, has_toolface, names)
    _sets_of_arms(log_set, roles, names)
    _pair_arms(roles)
    _radii_all_around(log_set, roles)
    return RoleMap(log_set.name, roles)


def _radii_all_around(log_set: RawSet, roles: dict[str, Role]) -> None:
    """Beside radii by sector, leave out diameters and radii of single arms, and the toolface of a diameter.

    Such tables are logs of a wall (`Wall.logs`): its diameters are those of its sectors, not measured once more.
    """
    around = next((each.channel for each in roles.values() if each.role == "radius-image"), None)
    if around is None:
        return
    for name, role in roles.items():
        derived = role.role == "toolface" and "diameter" in log_set[name].description.lower()
        if derived or role.role in ("radius", "diameter"):
            roles[name] = _none(log_set[name], f"{role.reason}; {around} has the radii all around the hole")


def _text_roles(log_set: RawSet, roles: dict[str, Role], has_toolface: bool, names: RoleNames) -> None:
    """Give a missing role to a text column whose name fits, so that an error names its bad cell later."""
    taken = {each.role for each in roles.values()}
    for channel in log_set:
        if not channel.is_text or roles[channel.name].role != "none" or len(channel.shape) != 1:
            continue
        for rule in names.single:
            wanted = rule.role in ("depth", "toolface", "inclination", "azimuth") and rule.role not in taken
            if wanted and rule.named(channel) and rule.allows(channel) and _fits(channel, ROLES[rule.role]):
                reason = f"named {channel.name}, but not every cell is a number"
                roles[channel.name] = Role(channel.name, rule.role, reason, channel.unit)
                taken.add(rule.role)
                break
        found = None if taken & set(WALL) else _wall_role(channel, has_toolface or "toolface" in taken, names)
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
    return re.sub(r"\s*[\[(][^\])]*[\])]\s*$", "", name).strip().rstrip(".")


def _spellings(channel: Channel) -> tuple[str, str]:
    """Return the channel's name without its unit, and without the ending of a variant too: ``rb_s`` -> ``rb``."""
    plain = stem(channel)
    return plain, _table()[1].sub("", plain) or plain


def _fits(channel: Channel, kind: str) -> bool:
    """Return whether a channel's unit allows a role: the unit is of this kind or not stated, or no unit is needed."""
    return not kind or not channel.unit or units.measures(channel.unit) == kind


def _single_roles(log_set: RawSet, roles: dict[str, Role], names: RoleNames) -> None:
    """Assign each role of `SINGLE` (depth, time, toolface ...) to the channel that fits it best.

    All names are tried before any description: a pad's azimuth is described like the hole's. The other channels that
    fit a role do not get it; their reasons name the channel that has the role. If no channel fits depth, the index
    becomes the depth if its unit is one of length.
    """
    candidates = [one for one in log_set if one.shape == (log_set.rows,)]
    inclined = any(
        (rule.named(one) or rule.says(one)) and _fits(one, units.ANGLE)
        for rule in names.single if rule.role == "inclination" for one in candidates
    )  # fmt: skip
    for by_name in (True, False):
        for rule in names.single:
            for channel in candidates:
                free = roles[channel.name].role == "none" and (by_name or roles[channel.name].reason == NO_RULE)
                if not free or (channel.is_text and rule.role not in ("time", "toolface-reference")):
                    continue
                if (rule.named(channel) if by_name else rule.says(channel)) and rule.allows(channel):
                    how = f"named {channel.name}" if by_name else f'described as "{channel.description}"'
                    roles[channel.name] = _single_role(log_set, roles, rule, channel, how, inclined)
    first = log_set[log_set.index] if log_set.index else None
    placed = any(each.role == "depth" for each in roles.values())
    if first is None or placed or first.is_text or roles[first.name].role != "none":
        return
    if units.measures(first.unit) == units.LENGTH:
        roles[first.name] = Role(first.name, "depth", "it is the index and a length", first.unit)


def _single_role(
    log_set: RawSet, roles: dict[str, Role], rule: NameRule, channel: Channel, how: str, inclined: bool
) -> Role:
    """Return the role of a channel that fits a rule: that of the rule, or none with the reason why not."""
    role = rule.role
    if not _fits(channel, ROLES[role]):
        return _none(channel, f"{how}, like {role}, but {channel.unit!r} is no known unit of {ROLES[role]}")
    owner = next((each.channel for each in roles.values() if each.role == role), None)
    if owner is not None:
        return _none(channel, f"{how}, like {role}; {owner} has this role")
    if role == "azimuth" and not inclined:
        reason = f"{how}, but a survey also needs an inclination (an angle around the hole is a toolface)"
        return _none(channel, reason)
    index = " and it is the index" if channel.name == log_set.index else ""
    reference, north = _reference(rule, channel) if role == "toolface" else ("", "")
    if role == "azimuth":
        north = north_stated(channel)
    return Role(channel.name, role, how + index, channel.unit or rule.unit, reference=reference, north=north)


def _reference(rule: NameRule, channel: Channel) -> tuple[str, str]:
    """Return what a toolface counts from, and which north, by its rule, or else its description; "" if not stated."""
    rules = [rule, *(each for each in role_names().single if each.role == "toolface" and each.says(channel))]
    known = next((each for each in rules if each.reference), NameRule("toolface"))
    reference = known.reference or ("north" if NORTH_TEXT.search(channel.description) else "")
    return reference, (known.north or north_stated(channel)) if reference.endswith("north") else ""


def toolface_rule(channel: Channel, names: RoleNames | None = None) -> NameRule | None:
    """Return the rule by which a channel is a toolface, by its name or else its description; None if it is none."""
    rules = [rule for rule in (names or role_names()).single if rule.role == "toolface" and rule.allows(channel)]
    return next((rule for rule in rules if rule.named(channel)), None) or next(
        (rule for rule in rules if rule.says(channel)), None
    )


def toolface_reference(channel: Channel) -> tuple[str, str]:
    """Return what a toolface counts from, a `ToolfaceReference`, and which north, by its name or description, or ""."""
    return _reference(toolface_rule(channel) or NameRule("toolface"), channel)


NORTH_SHORT = {"mag": "magnetic", "tn": "true", "gn": "grid"}
"""Abbreviations of norths in the names of surveys."""


def north_stated(channel: Channel) -> str:
    """Return the north that a channel's name and description state: true, grid or magnetic; "" if none or several.

    A name may have the north as an abbreviation at its end: AZIM_MAG, AZIM_TN, AZIM_GN.
    """
    name = re.sub(r"[\W_]+", " ", channel.name.lower()).strip()
    text = f"{name} {re.sub(r'[^a-z0-9]+', ' ', channel.description.lower())}"
    named = set(re.findall(r"\b(true|grid|magnetic)\b", text))
    named |= {north for short, north in NORTH_SHORT.items() if re.search(rf" {short}( \w+)?$", name)}
    return named.pop() if len(named) == 1 else ""


UNCERTAINTY = re.compile(r"_sigma\b|\buncertainty\b|\bstandard deviation\b", re.IGNORECASE)


def _image_role(channel: Channel, names: RoleNames) -> Role:
    """Return the role of an image: a caliper image has a unit of length, and an echo image has travel times."""
    for rule in names.wall:
        if rule.role == "none" and (rule.named(channel) or rule.says(channel)) and rule.allows(channel):
            return _none(channel, rule.reason)
    if channel.axis is None and NO_SECTORS_TEXT.search(channel.description):
        return _none(channel, f'described as "{channel.description}", not as sectors around the hole')
    sectors = channel.shape[1]
    if channel.members:
        ends = f"{channel.member_names[0]} to {channel.member_names[-1]}"
        reason = f"{sectors} columns {ends}, numbered without a gap, one unit"
    else:
        reason = f"stored as an array of {sectors}"
    role = "image"
    if UNCERTAINTY.search(f"{stem(channel)} {channel.description}"):
        reason += ", an uncertainty"
    elif units.measures(channel.unit) == units.LENGTH:
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
    sonic = len(channel.shape) == 1 and SONIC_TEXT.search(channel.description)
    return bool(named) and units.measures(channel.unit) == units.TIME and not sonic


def _wall_role(channel: Channel, has_toolface: bool, names: RoleNames) -> Role | None:
    """Return the role of a wall channel: radius, diameter, arm, travel time or mean diameter; None if none fits."""
    if _is_echo(channel):
        reason = f"named or described as a travel time ({channel.description or channel.name})"
        return Role(channel.name, "travel-time", reason, channel.unit, 0.0 if has_toolface else None)
    if not _fits(channel, units.LENGTH):
        return None
    for rule in names.wall:
        named, unit = rule.named(channel), channel.unit or rule.unit
        if not (named or rule.says(channel)) or not rule.allows(channel) or (rule.needs_toolface and not has_toolface):
            continue
        how = f"named {channel.name}" if named else f'described as "{channel.description}"'
        if rule.role == "none":
            return _none(channel, f"{how}: {rule.reason}")
        if rule.role == "mean-diameter":
            reason = f"named or described as a caliper ({channel.description or channel.name}) without a direction"
            return Role(channel.name, rule.role, reason, unit)
        if rule.arm:
            how = f"named like the {rule.arm} arm pair of a caliper: across the hole at {rule.angle:g} deg"
            how += " from the toolface"
        elif rule.role == "diameter" and not rule.needs_toolface and rule.angle is not None:
            how += f": a diameter through {rule.angle:g} and {rule.angle + 180:g} deg"
        angle = rule.angle if rule.angle is not None or not has_toolface else 0.0
        return Role(channel.name, rule.role, how, unit, angle)
    if channel.unit and CALIPER_TEXT.search(channel.description):
        reason = f"named or described as a caliper ({channel.description}) without a direction"
        return Role(channel.name, "mean-diameter", reason, channel.unit)
    return None


def _sets_of_arms(log_set: RawSet, roles: dict[str, Role], names: RoleNames) -> None:
    """Give three calipers of one tool their directions: three diameters lie 60 degrees apart, and are no X-Y pair.

    If the descriptions speak of arms, the channels may also be three radii, 120 degrees apart; then they get no role.
    """
    by_name = {stem(channel): channel for channel in log_set if channel.shape == (log_set.rows,)}
    for members, step in names.sets:
        arms = [by_name[name] for name in members if name in by_name and _fits(by_name[name], units.LENGTH)]
        if len(arms) < len(members):
            continue
        shown = ", ".join(arm.name for arm in arms)
        for number, arm in enumerate(arms):
            angle = step * number
            reason = f"one arm pair of {shown}, {step:g} deg apart: across the hole at {angle:g} deg from the toolface"
            role = Role(arm.name, "diameter", reason, arm.unit, angle)
            if any(ONE_OF_SEVERAL.search(each.description) for each in arms):
                reason = (
                    f"{shown} are three diameters {step:g} deg apart, or three radii {2 * step:g} deg apart: name them "
                    f"in a map, or columns.diameter={arm.name}@{angle:g}, columns."
                    f"radius={arm.name}@{2 * angle:g}"
                )
                role = _none(arm, reason)
            roles[arm.name] = role


def _pair_arms(roles: dict[str, Role]) -> None:
    """Remove the role of each arm pair that is named x or y if no pair has the other direction."""
    arms = [each for each in roles.values() if each.role == "diameter" and each.turns]
    if len({arm.angle for arm in arms}) == 1:
        for arm in arms:
            reason = "named like one arm pair of an X-Y caliper, but its partner at right angles is missing"
            roles[arm.channel] = replace(arm, role="none", reason=reason, angle=None)

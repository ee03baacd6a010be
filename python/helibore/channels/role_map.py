"""The role map, a TOML file that replaces guessed roles of channels; ``helibore inspect`` prints one, ready to edit.

    set = "MAIN"                       # which set of the file; left out if the file has one set
    [channels."pfc1_x_in"]
    role = "diameter"                  # one of helibore.channels.roles.ROLES
    unit = "in"
    angle = 0.0                        # degrees from the toolface (radius, diameter)
    offset = 1.2                       # metres from the point whose depth is recorded up to this sensor
    latency = 0.5                      # seconds from a measurement to its time stamp
    first = 11.25                      # images: angle of the first sector; in a radius image, of the sector's centre
    step = 22.5                        # images: angle from one sector to the next
    reference = "north"                # toolface: what it counts from: north, horizontal-north (the azimuth of a pad),
                                       # high-side, or automatic (by inclination)
    north = "magnetic"                 # toolface from north, azimuth: true, magnetic or grid

    [[names]]                          # names that mean a role in every file that is read with this map
    names = ["XRB", "RBX"]             # without units
    role = "toolface"
    reference = "high-side"            # also: north; angle, of an arm

A channel that the map does not name keeps its guessed role. The role of a channel that the map names is confirmed: the
checks for likely mistakes are skipped.
"""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from helibore.base import units
from helibore.base.errors import InputError, check_choice, check_names
from helibore.base.toml_file import read_toml
from helibore.channels.log_set import LogFile
from helibore.channels.roles import (
    REFERENCES,
    ROLES,
    SINGLE,
    WALL,
    NameRule,
    Role,
    RoleMap,
    guess,
    role_names,
    toolface_reference,
)
from helibore.files.raw_set import Channel, RawSet
from helibore.trajectory.references import NORTHS

KEYS = {
    "role": str, "unit": str, "angle": float, "first": float, "step": float, "offset": float, "latency": float,
    "reference": str, "north": str,
}  # fmt: skip
ANGLES, PLACE = ("angle", "first", "step"), ("offset", "latency")
SPELLING = re.compile(r"(?P<name>.+?)(?:@(?P<angle>[-+]?\d+\.?\d*))?(?::(?P<unit>[^:]+))?")


def write_map(roles: RoleMap, with_set: bool = True, warning: str = "") -> str:
    """Return roles as a TOML map, with reasons as comments, and channels without a role as comments to edit.

    If the file is refused with these roles, ``warning`` says why; it becomes the first comment.
    """
    lines = [_comment(f"Refused with these roles: {warning}"), ""] if warning else []
    if roles.set_name and with_set:
        lines += [f"set = {quoted(roles.set_name)}", ""]
    for role in roles:
        if role.role == "none":
            continue
        lines += [_comment(role.reason), f"[channels.{quoted(role.channel)}]"]
        lines.append(f'role = "{role.role}"')
        if role.unit or (ROLES[role.role] and role.role != "time"):
            comment = "" if role.unit else "   # not stated in the file: fill it in"
            lines.append(f"unit = {quoted(role.unit)}{comment}")
        lines += [f"{key} = {float(getattr(role, key))!r}" for key in ANGLES if getattr(role, key) is not None]
        lines += [f"{key} = {getattr(role, key)!r}" for key in PLACE if getattr(role, key)]
        lines += [f"{key} = {quoted(getattr(role, key))}" for key in ("reference", "north") if getattr(role, key)]
        lines.append("")
    return "\n".join([*lines, *_without_role(roles)])


def _without_role(roles: RoleMap) -> list[str]:
    """Return comments on the channels without a role.

    The comments list the names of the channels if the other roles make the set usable. If not, the comments are entries
    to fill in.
    """
    rest = [role for role in roles if role.role == "none"]
    if not rest:
        return []
    usable = roles.one("depth") and roles.all(*WALL, "image", "mean-diameter", "inclination")
    about = f"Without a role; take the # away and fill in. Roles: {', '.join(ROLES)}"
    if usable:
        about = f"Without a role: {', '.join(quoted(role.channel) for role in rest)}"
    lines = [*textwrap.wrap(about, 116, initial_indent="# ", subsequent_indent="# "), ""]
    for role in () if usable else rest:
        entry = [f"[channels.{quoted(role.channel)}]", f'role = ""   # {role.reason}', f"unit = {quoted(role.unit)}"]
        lines += [*map(_comment, entry), ""]
    return lines


def _comment(text: str) -> str:
    """Return text as a TOML comment on one line; a blank replaces each control character, which TOML refuses."""
    return "# " + "".join(c if c.isprintable() else " " for c in text)


def quoted(text: str) -> str:
    """Return text as a TOML basic string."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c.isprintable() else f"\\U{ord(c):08x}" for c in escaped) + '"'


def read_map(path: str | Path, file: LogFile) -> RoleMap:
    """Read a TOML map, and replace guessed roles of the set that it names, or of the only set, by the roles of the map.

    An InputError names the map, the channel and the rule if the map is not TOML, names a key, role, channel, unit or
    set that does not exist, gives a role a value that does not belong to it, or gives one role to two channels.
    """
    path = Path(path)
    tree = read_toml(path, path.name)
    check_names(f"{path.name}: ", tree, ("set", "channels", "names"))
    entries = tree.get("channels", {})
    if not isinstance(entries, dict) or not isinstance(tree.get("set", ""), str):
        raise InputError(path.name, "channels must be tables, set must be a name")
    log_set = file.set(tree.get("set"))
    names = role_names().with_rules(_name_rules(tree.get("names", []), path.name))
    return overlay(guess(log_set, names), log_set, entries, path.name)


def _name_rules(entries: Any, place: str) -> list[NameRule]:
    """Return the names that a map adds to those of helibore."""
    if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        raise InputError(place, "names must be tables, [[names]]")
    rules = []
    for number, entry in enumerate(entries, 1):
        at = f"{place}: names {number}"
        check_names(f"{at}: ", entry, ("names", "role", "reference", "north", "angle"))
        listed, role = entry.get("names"), entry.get("role")
        if not isinstance(listed, list) or not listed or not all(isinstance(name, str) for name in listed):
            raise InputError(f"{at}: names", "must be a list of names", repr(listed))
        check_choice(f"{at}: role", role, ROLES)
        stated = {key: entry[key] for key in ("reference", "north") if key in entry}
        for key, value in stated.items():
            check_choice(f"{at}: {key}", value, REFERENCES if key == "reference" else NORTHS)
        angle = entry.get("angle")
        if angle is not None and (type(angle) not in (int, float) or not math.isfinite(angle)):
            raise InputError(f"{at}: angle", "must be a finite number", repr(angle))
        lower = tuple(name.lower() for name in listed)
        angle = None if angle is None else float(angle)
        rules.append(NameRule(role, lower, angle=angle, reason=f"{place} says so", **stated))
    return rules


def overlay(roles: RoleMap, log_set: RawSet, entries: dict[str, Any], place: str, why: str = "the map") -> RoleMap:
    """Return the roles, replaced where a channel has an entry; ``place`` names the map in errors.

    A replaced role has the reason ``why``. If an entry gives a role that only one channel can have, a channel with the
    same guessed role loses that role.
    """
    changed = dict(roles.roles)
    for name, entry in entries.items():
        if name not in log_set:
            raise InputError(place, f"no channel {name!r}; the set holds {', '.join(log_set.names)}")
        base = changed.get(name) or Role(name, "none", "", log_set[name].unit)
        changed[name] = _entry(base, entry, f"{place}: {name}", why, log_set[name])
    for role in SINGLE:
        stated = [each for each in changed.values() if each.role == role and each.confirmed]
        if len(stated) > 1:
            raise InputError(f"{place}: {stated[1].channel}", f"{stated[0].channel} is the {role} already")
        for each in list(changed.values()):
            if stated and each.role == role and not each.confirmed:
                reason = f"{stated[0].channel} is mapped as the {role}"
                changed[each.channel] = replace(each, role="none", reason=reason)
    return RoleMap(roles.set_name, changed)


def _entry(base: Role, entry: Any, place: str, why: str, channel: Channel) -> Role:
    if not isinstance(entry, dict):
        raise InputError(place, "must be a table")
    for key, value in entry.items():
        if key not in KEYS:
            raise InputError(f"{place}: {key}", f"must be one of {', '.join(KEYS)}")
        number = isinstance(value, float) or (type(value) is int and abs(value) < 2**63)  # TOML integers have 64 bits
        if not (number if KEYS[key] is float else isinstance(value, str)):
            raise InputError(f"{place}: {key}", f"must be {'a number' if KEYS[key] is float else 'text'}", repr(value))
    role = entry.get("role", base.role)
    check_choice(f"{place}: role", role, ROLES)
    unit = entry.get("unit", base.unit)
    if unit and ROLES[role] and units.measures(unit) != ROLES[role]:
        raise InputError(f"{place}: unit", f"must be a unit of {ROLES[role]} for a {role}", repr(unit))
    own_reference, own_north = base.reference, base.north
    if role != base.role:
        own_reference, own_north = toolface_reference(channel) if role == "toolface" else ("", "")
    reference, north = entry.get("reference", own_reference), entry.get("north", own_north)
    if "reference" in entry and (role != "toolface" or reference not in REFERENCES):
        rule = f"must be one of {', '.join(REFERENCES)}, of a toolface"
        raise InputError(f"{place}: reference", rule, repr(reference))
    if "north" in entry and (role not in ("toolface", "azimuth") or north not in NORTHS):
        rule = f"must be one of {', '.join(NORTHS)}, of a toolface or an azimuth"
        raise InputError(f"{place}: north", rule, repr(north))
    angle, first, step = (
        float(entry[key]) if key in entry else getattr(base, key) if role == base.role else None for key in ANGLES
    )
    offset, latency = (float(entry.get(key, getattr(base, key))) for key in PLACE)
    if not (math.isfinite(offset) and math.isfinite(latency)):
        raise InputError(f"{place}: offset = {offset:g}, latency", "must be finite", f"{latency:g}")
    if (offset or latency) and role not in WALL:
        raise InputError(place, f"offset and latency belong to a sensor: a role of {', '.join(WALL)}")
    return Role(base.channel, role, why, unit, angle, first, step, offset, latency, reference, north, True)


def parse_options(
    log_set: RawSet, roles: RoleMap, columns: Mapping[str, str | None], arms: Mapping[str, Sequence[str]]
) -> RoleMap:
    """Replace roles by columns written ``NAME[@ANGLE][:UNIT]``, as in options of the command line.

    ``columns`` holds a column by role, for roles that only one channel has; None leaves the role as it is. ``arms``
    holds columns by role, for wall channels; if any is given, all other channels lose their wall roles. Raise
    InputError if a column is not in the set, is given two roles, has an angle that its role does not take, or has a
    unit that is unknown or of a wrong kind; the error names the column.
    """
    wanted = [(role, spelling) for role, spelling in columns.items() if spelling is not None]
    wall = [(role, spelling) for role, spellings in arms.items() for spelling in spellings]
    turning = columns.get("toolface") is not None or roles.one("toolface") is not None
    entries: dict[str, Any] = {}
    for role, spelling in wanted + wall:
        name, angle, unit = _split_option(log_set, spelling)
        entry: dict[str, Any] = {"role": role} | ({"unit": unit} if unit else {})
        if angle is not None and role not in WALL:
            raise InputError(
                f"{log_set.path.name}: {spelling}", "an angle belongs to a radius, diameter or travel-time"
            )
        if angle is not None and len(log_set[name].shape) > 1:
            rule = "an angle belongs to a column of one value a row; a map states first and step of an image"
            raise InputError(f"{log_set.path.name}: {spelling}", rule)
        if role in WALL and len(log_set[name].shape) == 1:
            angle = _own_angle(roles, name, role, turning) if angle is None else angle
            entry |= {} if angle is None else {"angle": angle}
        if name in entries:
            raise log_set.input_error(f"is given two roles, {entries[name]['role']} and {role}", column=name)
        entries[name] = entry
    if wall:
        dropped = {
            each.channel: replace(each, role="none", reason="other columns are named") for each in roles.all(*WALL)
        }
        roles = RoleMap(roles.set_name, roles.roles | dropped)
    laid = overlay(roles, log_set, entries, log_set.path.name, "named by an option")
    for name, entry in entries.items():
        if "unit" not in entry:  # a name alone does not confirm a unit: degrees that look like radians are refused
            laid.roles[name] = replace(laid.roles[name], confirmed=False)
    return laid


def _own_angle(roles: RoleMap, name: str, role: str, turning: bool) -> float | None:
    """Return the angle of an arm whose option states none.

    This is the guessed angle if the role is as guessed, but not for an arm pair that turns with the tool if there is no
    toolface. Otherwise it is 0 for a radius or travel time if there is a toolface, and None for any other arm.
    """
    known = roles.roles.get(name)
    if known is not None and known.role == role and known.angle is not None and (turning or not known.turns):
        return known.angle
    return 0.0 if turning and role != "diameter" else None


def _split_option(log_set: RawSet, spelling: str) -> tuple[str, float | None, str | None]:
    """Return name, angle and unit of ``NAME[@ANGLE][:UNIT]``, or only the name if the whole text names a channel."""
    if spelling in log_set:
        return spelling, None, None
    match = SPELLING.fullmatch(spelling)
    if match is None or match["name"] not in log_set:
        wanted = match["name"] if match else spelling
        raise log_set.input_error(f"not in the file, which has {', '.join(log_set.names)}", column=repr(wanted))
    return match["name"], float(match["angle"]) if match["angle"] else None, match["unit"]

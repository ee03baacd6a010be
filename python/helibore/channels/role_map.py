"""The role map, a TOML file that replaces guessed roles of channels; ``helibore inspect`` prints one, ready to edit.

    set = "MAIN"                       # which set of the file; left out if the file has one set
    [channels."pfc1_x_in"]
    role = "diameter"                  # one of helibore.settings.role_settings.ROLES
    unit = "in"
    angle = 0.0                        # degrees from the toolface (radius, diameter)
    offset = 1.2                       # metres from the point whose depth is recorded up to this sensor
    latency = 0.5                      # seconds from a measurement to its time stamp
    zero = 0.08                        # metres added to its radii: of standoffs, the radius of the tool's face
    first = 11.25                      # images: angle of the first sector; in a radius image, of the sector's centre
    step = 22.5                        # images: angle from one sector to the next
    reference = "north"                # toolface: what it counts from: north, horizontal-north (the azimuth of a pad),
                                       # high-side, or automatic (by inclination)
    north = "magnetic"                 # toolface from north, azimuth: true, magnetic or grid

    [[names]]                          # names that mean a role in every file that is read with this map
    names = ["XRB", "RBX"]             # without units
    role = "toolface"
    unit = "deg"                       # where a file states none
    reference = "high-side"            # also: north; angle, of an arm

A channel that the map does not name keeps its guessed role. The role of a channel that the map names is confirmed: the
checks for likely mistakes are skipped.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from helibore.base import units
from helibore.base.errors import InputError
from helibore.channels.log_set import LogFile
from helibore.channels.roles import (
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
from helibore.settings.role_settings import ChannelRole, MapOfRoles, RoleOfNames
from helibore.settings.toml_reading import TomlSource, read_table

CHANNELS = ("channels",)
"""The table of a map that holds the entries of channels."""
A_MAP = TomlSource("map")
"""Where entries come from that no file states."""
ANGLES, PLACE = ("angle", "first", "step"), ("offset", "latency", "zero")
SPELLING = re.compile(
    r"(?P<name>.+?)(?:@(?P<angle>[-+]?\d+\.?\d*))?(?::(?P<unit>[^:+]+))?(?P<zero>\+\d+(?:\.\d*)?[A-Za-z]+)?"
)


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
    source, tree = TomlSource.load(path)
    stated = read_table(MapOfRoles, tree, source)
    log_set = file.set(stated.set)
    for number, each in enumerate(stated.names):
        _check_unit(each.unit, each.role, source, ("names", number, "unit"))
    names = role_names().with_rules(_name_rule(each, path.name) for each in stated.names)
    return overlay(guess(log_set, names), log_set, tree.get("channels", {}), source)


def _name_rule(stated: RoleOfNames, place: str) -> NameRule:
    """Return names that a map adds to those of helibore."""
    return NameRule(
        stated.role,
        tuple(name.lower() for name in stated.names),
        unit=stated.unit or "",
        angle=stated.angle,
        reason=f"{place} says so",
        reference=stated.reference or "",
        north=stated.north or "",
    )


def overlay(
    roles: RoleMap,
    log_set: RawSet,
    entries: Mapping[str, Any],
    source: TomlSource = A_MAP,
    why: str = "the map",
    keys: tuple[str, ...] = CHANNELS,
) -> RoleMap:
    """Return the roles, replaced where a channel has an entry, which is a table of `ChannelRole`.

    ``source`` is where the entries come from, and ``keys`` lead to them, for errors. A replaced role has the reason
    ``why``. If an entry gives a role that only one channel can have, a channel with the same guessed role loses it.
    """
    changed = dict(roles.roles)
    for name, entry in entries.items():
        if name not in log_set:
            rule = f"no channel of this name; the set holds {', '.join(log_set.names)}"
            raise source.error((*keys, name), rule)
        base = changed.get(name) or Role(name, "none", "", log_set[name].unit)
        stated = read_table(ChannelRole, entry, source, (*keys, name)).changed()
        changed[name] = _entry(base, stated, source, (*keys, name), why, log_set[name])
    for role in SINGLE:
        stated_so = [each for each in changed.values() if each.role == role and each.confirmed]
        if len(stated_so) > 1:
            rule = f"{stated_so[0].channel} is the {role} already"
            raise source.error((*keys, stated_so[1].channel), rule)
        for each in list(changed.values()):
            if stated_so and each.role == role and not each.confirmed:
                reason = f"{stated_so[0].channel} is mapped as the {role}"
                changed[each.channel] = replace(each, role="none", reason=reason)
    return RoleMap(roles.set_name, changed)


def _check_unit(unit: str | None, role: str, source: TomlSource, at: tuple[str | int, ...]) -> None:
    """Raise InputError if a unit does not measure what its role asks for."""
    if unit and ROLES[role] and units.measures(unit) != ROLES[role]:
        raise source.error(at, f"must be a unit of {ROLES[role]} for a {role}", unit)


def _entry(
    base: Role, entry: Mapping[str, Any], source: TomlSource, at: tuple[str, ...], why: str, channel: Channel
) -> Role:
    """Return the role of a channel: what its entry states, and what was known before where it states nothing."""
    role, unit = entry.get("role", base.role), entry.get("unit", base.unit)
    _check_unit(unit, role, source, (*at, "unit"))
    own_reference, own_north = base.reference, base.north
    if role != base.role:
        own_reference, own_north = toolface_reference(channel) if role == "toolface" else ("", "")
    for key, of in (("reference", ("toolface",)), ("north", ("toolface", "azimuth"))):
        if key in entry and role not in of:
            raise source.error((*at, key), f"belongs to a role of {' or '.join(of)}", entry[key])
    angle, first, step = (entry.get(key, getattr(base, key) if role == base.role else None) for key in ANGLES)
    offset, latency, zero = (entry.get(key, getattr(base, key)) for key in PLACE)
    for key, value in zip(PLACE, (offset, latency, zero), strict=True):
        if value and role not in WALL:
            raise source.error((*at, key), f"belongs to a sensor: a role of {', '.join(WALL)}", value)
    reference, north = entry.get("reference", own_reference), entry.get("north", own_north)
    return Role(base.channel, role, why, unit, angle, first, step, offset, latency, zero, reference, north, True)


def parse_options(
    log_set: RawSet, roles: RoleMap, columns: Mapping[str, str | None], arms: Mapping[str, Sequence[str]]
) -> RoleMap:
    """Replace roles by columns written ``NAME[@ANGLE][:UNIT][+ZERO]``, as in options of the command line.

    ``columns`` holds a column by role, for roles that only one channel has; None leaves the role as it is. The angle of
    an image is that of its first sector; the others follow it evenly around the hole. ``arms`` holds columns by role,
    for wall channels; if any is given, all other channels lose their wall roles. Raise InputError if a column is not in
    the set, is given two roles, has an angle that its role does not take, or has a unit that is unknown or of a wrong
    kind; the error names the column.
    """
    wanted = [(role, spelling) for role, spelling in columns.items() if spelling is not None]
    wall = [(role, spelling) for role, spellings in arms.items() for spelling in spellings]
    turning = columns.get("toolface") is not None or roles.one("toolface") is not None
    entries: dict[str, Any] = {}
    for role, spelling in wanted + wall:
        name, angle, unit, zero = _split_option(log_set, spelling)
        entry: dict[str, Any] = {"role": role} | ({"unit": unit} if unit else {}) | ({"zero": zero} if zero else {})
        if angle is not None and role not in WALL:
            raise InputError(
                f"{log_set.path.name}: {spelling}", "an angle belongs to a radius, diameter or travel-time"
            )
        if angle is not None and len(log_set[name].shape) > 1:
            if role == "diameter":
                rule = "an angle of diameters belongs to a column of one value a row"
                raise InputError(f"{log_set.path.name}: {spelling}", rule)
            entry |= {"first": angle, "step": 360.0 / log_set[name].shape[1]}
            entry["role"] = "radius-image" if role == "radius" else role
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
    laid = overlay(roles, log_set, entries, TomlSource(log_set.path.name), "named by an option", ())
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


def _split_option(log_set: RawSet, spelling: str) -> tuple[str, float | None, str | None, str | None]:
    """Return name, angle, unit and zero of ``NAME[@ANGLE][:UNIT][+ZERO]``, or the name if the whole text is one."""
    if spelling in log_set:
        return spelling, None, None, None
    known = [name for name in log_set.names if spelling.startswith((f"{name}@", f"{name}:", f"{name}+"))]
    if known:  # a repeated name ends in its number: CALI:1@0
        name = max(known, key=len)
        match = SPELLING.fullmatch(f"NAME{spelling[len(name) :]}")
        if match is not None and match["name"] == "NAME":
            return name, *_values_of(match)
    match = SPELLING.fullmatch(spelling)
    if match is None or match["name"] not in log_set:
        wanted = match["name"] if match else spelling
        raise log_set.input_error(f"not in the file, which has {', '.join(log_set.names)}", column=repr(wanted))
    return match["name"], *_values_of(match)


def _values_of(match: re.Match[str]) -> tuple[float | None, str | None, str | None]:
    """Return angle, unit and zero of a column's spelling; a length keeps its unit."""
    zero = match["zero"]
    return float(match["angle"]) if match["angle"] else None, match["unit"], zero.removeprefix("+") if zero else None

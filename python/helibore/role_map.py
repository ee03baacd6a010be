"""The role map: a TOML file that overrides guessed roles, printed by ``helibore inspect`` ready to edit.

    set = "MAIN"                       # which set of the file; left out when there is one
    [channels."pfc1_x_in"]
    role = "diameter"                  # one of helibore.roles.ROLES
    unit = "in"
    angle = 0.0                        # degrees from the toolface (radius, diameter)
    first = 11.25                      # images: angle of the first sector's centre, and from one to the next
    step = 22.5

What a map does not name keeps its guess. What it names is confirmed: checks that only suspect a wrong column are off.
"""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

from helibore.files.channel import LogFile, LogSet
from helibore.roles import ROLES, SINGLE, Role, RoleMap, guess, measures

KEYS = {"role": str, "unit": str, "angle": float, "first": float, "step": float}


def write_map(roles: RoleMap, with_set: bool = True) -> str:
    """Return roles as a TOML map, reasons as comments; channels without a role are left out."""
    lines = []
    if roles.set_name and with_set:
        lines += [f"set = {quoted(roles.set_name)}", ""]
    for role in roles:
        if role.role == "none":
            continue
        lines += [f"# {role.reason}".replace("\n", " "), f"[channels.{quoted(role.channel)}]"]
        lines.append(f'role = "{role.role}"')
        if role.unit or (ROLES[role.role] and role.role != "time"):
            comment = "" if role.unit else "   # not stated in the file: fill it in"
            lines.append(f"unit = {quoted(role.unit)}{comment}")
        for key in ("angle", "first", "step"):
            value = getattr(role, key)
            if value is not None:
                lines.append(f"{key} = {float(value)!r}")
        lines.append("")
    return "\n".join(lines)


def quoted(text: str) -> str:
    """Return text as a TOML basic string."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in escaped) + '"'


def read_map(path: str | Path, file: LogFile) -> RoleMap:
    """Read a TOML map and lay it over the guessed roles of the set it names.

    Raises
    ------
    ValueError
        Naming map, channel and rule: not TOML, an unknown key, role, channel or unit, a unit of the wrong kind, one
        role given twice.
    """
    path = Path(path)
    try:
        tree = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"{path.name}: not TOML: {error}") from error
    unknown = set(tree) - {"set", "channels"}
    if unknown:
        raise ValueError(f"{path.name}: {min(unknown)}: must be one of set, channels")
    entries = tree.get("channels", {})
    if not isinstance(entries, dict) or not isinstance(tree.get("set", ""), str):
        raise ValueError(f"{path.name}: channels must be tables, set must be a name")
    return overlay(guess(file.set(tree.get("set"))), file.set(tree.get("set")), entries, path.name)


def overlay(roles: RoleMap, one: LogSet, entries: dict[str, Any], place: str) -> RoleMap:
    """Return the roles with the entries of a map laid over them; ``place`` names the map in errors."""
    changed = dict(roles.roles)
    for name, entry in entries.items():
        if name not in one:
            raise ValueError(f"{place}: no channel {name!r}; the set holds {', '.join(one.names)}")
        base = changed.get(name) or Role(name, "none", "", one[name].unit)
        changed[name] = _entry(base, entry, f"{place}: {name}")
    for role in SINGLE:
        stated = [each for each in changed.values() if each.role == role and each.confirmed]
        if len(stated) > 1:
            raise ValueError(f"{place}: {stated[1].channel}: {stated[0].channel} is the {role} already")
        for each in list(changed.values()):
            if stated and each.role == role and not each.confirmed:
                reason = f"{stated[0].channel} is mapped as the {role}"
                changed[each.channel] = replace(each, role="none", reason=reason)
    return RoleMap(roles.set_name, changed)


def _entry(base: Role, entry: Any, place: str) -> Role:
    if not isinstance(entry, dict):
        raise ValueError(f"{place}: must be a table")
    for key, value in entry.items():
        if key not in KEYS:
            raise ValueError(f"{place}: {key}: must be one of {', '.join(KEYS)}")
        number = isinstance(value, int | float) and not isinstance(value, bool)
        if not (number if KEYS[key] is float else isinstance(value, str)):
            raise ValueError(f"{place}: {key} = {value!r}: must be {'a number' if KEYS[key] is float else 'text'}")
    role = entry.get("role", base.role)
    if role not in ROLES:
        raise ValueError(f"{place}: role = {role!r}: must be one of {', '.join(ROLES)}")
    unit = entry.get("unit", base.unit)
    if unit and ROLES[role] and measures(unit) != ROLES[role]:
        raise ValueError(f"{place}: unit = {unit!r}: must be a unit of {ROLES[role]} for a {role}")
    angle, first, step = (
        float(entry[key]) if key in entry else getattr(base, key) if role == base.role else None
        for key in ("angle", "first", "step")
    )
    return Role(base.channel, role, "the map", unit, angle, first, step, confirmed=True)

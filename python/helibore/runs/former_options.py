"""Read what an earlier version wrote into a project: the options of its command, as tables of settings of today.

[options]                             [logs]     step = 0.5    casing = [0.1778]
step = 0.5  casings = [0.1778]   ->   [zones]    washout = 0.00762
criteria = ["washout=0.3in"]
limits = ["GR=20,150"]                [look.GR]  limits = [20.0, 150.0]
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from helibore.base.errors import unknown_name
from helibore.settings.declared import Member, members
from helibore.settings.groups import GROUPS
from helibore.settings.look_texts import look_of_text, merged_looks
from helibore.settings.toml_reading import TomlSource

GROUP_OF = {"reconstruct": "mesh", "mesh": "mesh", "logs": "logs", "plot": "print", "report": "print"}
"""The group of the settings that the options of a command had."""
LOOKS = {
    "limits": "", "color_maps": "map:", "color_map": "map:", "dynamic": "window:", "logs": "log", "log": "log",
    "linear": "linear",
}  # fmt: skip
"""Options for images and curves, NAME or NAME=VALUE, and what stands before the value in the text of a look."""
LISTS = {"headers": "header", "criteria": "zones"}
"""Options that were lists of NAME=VALUE, and the groups of these settings."""
OTHERS = {"well": ("header", "well"), "scaled": ("zones", "scaled")}
VALUES: dict[str, Callable[[Any], Any]] = {
    "scale": lambda value: int(text) if (text := str(value).removeprefix("1:")).isdecimal() else value,
    "curves": lambda value: [each for each in value if each != "none"] if isinstance(value, list) else value,
}
"""What values of today are made of the values that were texts: the scale 1:200, the curves none."""


def with_tables(tree: dict[str, Any], source: TomlSource) -> dict[str, Any]:
    """Return the tables of a project without ``options``, which are added to the tables of the settings they mean."""
    made = {name: value for name, value in tree.items() if name != "options"}
    group = GROUP_OF.get(str(tree.get("verb", "reconstruct")), "mesh")
    known: dict[str, Member] = members(GROUPS[group])
    names = {name: of.name for of in known.values() for name in (of.name, *of.formerly)}
    looks = [text for name, value in _lists(tree.get("look", {})) for text in _look_texts(name, value)]
    if looks:
        made["look"] = {name: value for name, value in tree["look"].items() if isinstance(value, dict)}
    for name, value in tree.get("options", {}).items():
        if name in ("start_depth", "stop_depth"):
            made.setdefault(name, value)
        elif name in OTHERS:
            table, key = OTHERS[name]
            made.setdefault(table, {}).setdefault(key, value)
        elif name in LISTS and _texts(value):
            for key, text in (each.split("=", 1) for each in value if "=" in each):
                made.setdefault(LISTS[name], {}).setdefault(key.replace("-", "_"), text)
        elif name in LOOKS and group == "print" and _texts(value):
            looks += _look_texts(name, value)
        elif name in names:
            changed = VALUES.get(name, lambda same: same)(value)
            made.setdefault(group, {}).setdefault(names[name], changed)
        else:
            raise unknown_name(source.place(("options", name)), name, [*names, *OTHERS, *LISTS])
    if looks:
        read = merged_looks(look_of_text(text, source.name) for text in looks)
        made["look"] = read | made.get("look", {})
    return made


def _lists(table: Any) -> Iterator[tuple[str, list[str]]]:
    """Yield the entries of the table ``look`` that are options, as they were before each image had a table."""
    for name, value in table.items() if isinstance(table, dict) else ():
        if name in LOOKS and _texts(value):
            yield name, value


def _look_texts(option: str, values: list[str]) -> Iterator[str]:
    """Yield the texts of looks that the values of an option mean, NAME or NAME=VALUE."""
    for each in values:
        name, equals, value = each.rpartition("=")
        yield f"{name}={LOOKS[option]}{value}" if equals else f"{each}={LOOKS[option]}"


def _texts(value: Any) -> bool:
    return isinstance(value, list) and all(isinstance(each, str) for each in value)

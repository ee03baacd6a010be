"""Read declared settings from TOML and from texts of the command line; an error names file, line, key and rule.

source, tree = TomlSource.load(Path("well.toml"))
read_table(Settings, tree["wall"], source, ("wall",))    the table [wall] as `Settings`
parse_setting(member, "8 1/2in")                          the value of one setting, as a command line has it
"""

from __future__ import annotations

import dataclasses
import functools
import re
import typing
from bisect import bisect_left
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, field
from pathlib import Path
from typing import Any, Literal, TypeVar

from helibore.base import units
from helibore.base.errors import InputError, unknown_name
from helibore.base.toml_file import parse_toml, read_text
from helibore.settings.declared import NOUNS, Member, Unit, members, shown, words_of

Key = str | int
Made = TypeVar("Made")
ALONE = {"file": str, "item": str | int}
"""A table with one of these settings may be written as this setting's value alone, if it has this type."""


@dataclass(frozen=True)
class TomlSource:
    """Where settings come from: the name that errors show, the folder of file names, and the text for line numbers.

    If ``recorded``, helibore wrote the file, perhaps an earlier version with other names of settings. Keys lead from
    ``roots``, the tables of the file that are read as one; errors name this one by ``label``.
    """

    name: str
    folder: Path = Path()
    text: str = field(default="", repr=False)
    recorded: bool = False
    roots: tuple[tuple[Key, ...], ...] = ((),)
    label: str = ""

    @classmethod
    def load(cls, path: Path) -> tuple[TomlSource, dict[str, Any]]:
        """Read a TOML file; return its source and its tables."""
        text = read_text(path, path.name)
        tree = parse_toml(text, path.name)
        return cls(path.name, path.parent, text, "helibore" in tree), tree

    def place(self, keys: tuple[Key, ...]) -> str:
        """Return a place for errors: ``well.toml, line 12: image 2.origin``; tables of a list are counted from 1."""
        name = ""
        for key in keys:
            name += f" {key + 1}" if isinstance(key, int) else f".{key}" if name else key
        line = self.line(keys)
        where = f"{self.name}, line {line}" if line else self.name
        return ": ".join(part for part in (where, self.label, name) if part)

    def error(self, keys: tuple[Key, ...], rule: str, value: Any = MISSING) -> InputError:
        """Return the error for a value that breaks a rule."""
        return InputError(self.place(keys), rule, None if value is MISSING else shown(value))

    def located(self, error: InputError, keys: tuple[Key, ...] = ()) -> InputError:
        """Return an error whose place is a setting below ``keys``, such as ``caliper.order``, with its place here."""
        inner = tuple(error.place.split(".")) if error.place else ()
        return InputError(self.place((*keys, *inner)), error.rule, error.value, error.setting)

    def line(self, keys: tuple[Key, ...]) -> int | None:
        """Return the line where a key stands, or its table if the key is missing; None if there is neither."""
        if not self.text:
            return None
        lines, ends = self.text.split("\n"), _ends(self.text)

        @functools.cache
        def begun(count: int) -> Any:
            """Return the tables of the first ``count`` lines, after which no value is open."""
            return parse_toml("\n".join(lines[:count]), self.name)

        whole = begun(len(lines))
        places = ((*root, *keys[:length]) for length in range(len(keys), -1, -1) for root in self.roots)
        found = next((place for place in places if place and _holds(whole, place)), None)
        if found is None:
            return None
        first = bisect_left(ends, True, key=lambda count: _holds(begun(count), found))
        return ends[first - 1] + 1 if first else 1


TOKEN = re.compile(
    r'"{3}(?:\\.|[^\\])*?"{3,5}|\'{3}.*?\'{3,5}|"(?:\\.|[^"\\\n])*"|\'[^\'\n]*\'|#[^\n]*|[\[\]{}\n]', re.DOTALL
)
"""What decides in TOML whether a value goes on in the next line: strings, comments, brackets, ends of lines."""


def _ends(text: str) -> list[int]:
    """Return how many lines have been read wherever a line ends and no value is open, to the end of the text."""
    found, line, depth = [], 0, 0
    for token in map(re.Match.group, TOKEN.finditer(text)):
        line += token.count("\n")
        depth += (token in "[{") - (token in "]}")
        if token == "\n" and depth == 0:
            found.append(line)
    return [*found, line + 1]


def _holds(tree: Any, keys: tuple[Key, ...]) -> bool:
    """Return whether a tree has a key, given with the keys of its tables."""
    for key in keys:
        if isinstance(key, int):
            there = isinstance(tree, list) and key < len(tree)
        else:
            there = isinstance(tree, dict) and key in tree
        if not there:
            return False
        tree = tree[key]
    return True


def read_table(
    kind: type[Made], tree: Any, source: TomlSource, keys: tuple[Key, ...] = (), over: Mapping[str, Any] | None = None
) -> Made:
    """Return a table as an object of a declared class; ``keys`` lead to the table in the file.

    ``over`` holds settings that count over those of the file, by name; those of a table are a mapping.

    Raises
    ------
    InputError
        On a key that is not known, a key that is missing, and a value that breaks its rule.
    """
    known = members(kind)
    return _made(kind, _read_keys(known, tree, source, keys, over or {}), source, keys)


def _read_keys(
    known: dict[str, Member], tree: Any, source: TomlSource, keys: tuple[Key, ...], over: Mapping[str, Any]
) -> dict[str, Any]:
    """Return the values of the keys of a table, and those of ``over``, by the names of the settings."""
    if not isinstance(tree, dict):
        raise source.error(keys, f"must be {NOUNS[dict]}", tree)
    values: dict[str, Any] = {}
    inner = {name: value for name, value in over.items() if isinstance(value, Mapping)}
    for key, value in tree.items():
        member = known.get(key) or _former(known, key, source, keys)
        try:
            if member.stated is not None:
                values[member.name] = read_stated(member.stated, value, source, (*keys, key))
            elif member.name not in inner:
                values[member.name] = read_value(member.hint, member.optional, member.unit, value, source, (*keys, key))
        except InputError as error:
            error.about(_setting(member, keys))
            raise
    for name, value in over.items():
        if name not in inner:
            values[name] = value
        elif known[name].stated is not None:
            values[name] = values.get(name, {}) | value
        else:
            values[name] = read_table(known[name].hint, tree.get(name, {}), source, (*keys, name), value)
    return values


def _setting(member: Member, keys: tuple[Key, ...]) -> str:
    """Return the name of a setting: the declared one, or else its keys in the file, without the numbers of tables."""
    return member.setting or ".".join(each for each in (*keys, member.name) if isinstance(each, str))


def read_stated(kind: type[Any], tree: Any, source: TomlSource, keys: tuple[Key, ...]) -> dict[str, Any]:
    """Return only what a table states, by the names of the settings, each checked by the rules of the class."""
    known = members(kind)
    values = _read_keys(known, tree, source, keys, {})
    if any(member.default is MISSING and name not in values for name, member in known.items()):
        return {name: _checked(known[name], value, source, keys) for name, value in values.items()}
    made = _made(kind, values, source, keys)
    return {name: getattr(made, name) for name in values}


def _checked(member: Member, value: Any, source: TomlSource, keys: tuple[Key, ...]) -> Any:
    try:
        return member.checked(value)
    except InputError as error:
        raise source.located(error, keys) from error


def _made(kind: type[Made], values: dict[str, Any], source: TomlSource, keys: tuple[Key, ...]) -> Made:
    known = members(kind)
    for name, member in known.items():
        if member.default is MISSING and name not in values:
            choices = f"; it must be one of {member.choice_text}" if member.choices else ""
            raise source.error((*keys, name), f"is missing{choices}").about(_setting(member, keys))
    try:
        return kind(**values)
    except InputError as error:
        if (name := error.place.partition(".")[0]) in known:
            error.about(_setting(known[name], keys))
        if name in ("", *known):
            raise source.located(error, keys) from error
        raise (error.within(place) if (place := source.place(keys)) else error) from error


def _former(known: dict[str, Member], key: str, source: TomlSource, keys: tuple[Key, ...]) -> Member:
    """Return the setting that had the name ``key`` in an earlier version; refuse a name that never was one."""
    for member in known.values():
        if key in member.formerly:
            if source.recorded:
                return member
            raise source.error((*keys, key), f"is now called {member.name}")
    raise unknown_name(source.place((*keys, key)), key, known)


def read_value(
    hint: Any, optional: bool, unit: Unit | None, value: Any, source: TomlSource, keys: tuple[Key, ...]
) -> Any:
    """Return a value of TOML in a type.

    "none" stands for None where None is allowed; a text such as "8.5in" is a number where the number has a unit; the
    name of a file or of an item is a table that has only this name, a list of quantities, with or without a name behind
    them, is a table that has them in the order of its keys, and one table is a list of tables.
    """
    if value == "none" and optional:
        return None
    hint, words = words_of(hint)
    if words:
        return value if value in words else _number_or_word(hint, words, unit, value, source, keys)
    kind = typing.get_origin(hint) or hint
    if dataclasses.is_dataclass(kind):
        known = members(typing.cast(type[Any], kind))
        alone = next((name for name, of in ALONE.items() if name in known and isinstance(value, of)), None)
        value = value if alone is None else {alone: value}
        quantities = all(member.unit is not None or name == "name" for name, member in known.items())
        if quantities and isinstance(value, list) and len(value) <= len(known):
            value = dict(zip(known, value, strict=False))
        return read_table(typing.cast(type[Any], kind), value, source, keys)
    if kind is tuple:
        return _read_list(typing.get_args(hint), unit, value, source, keys)
    if kind is dict and typing.get_args(hint) and isinstance(value, dict):
        of = typing.get_args(hint)[1]
        return {name: read_value(of, False, unit, each, source, (*keys, name)) for name, each in value.items()}
    if kind is Path and isinstance(value, str):
        return source.folder / value
    if kind is float and unit is not None and isinstance(value, str):
        try:
            return units.quantity(value, unit.kind)
        except InputError as error:
            rule = f"{error.place}: {error.rule}" if error.place.startswith("unit") else error.rule
            raise source.error(keys, rule, value) from error
    if kind is float and type(value) is int:
        return value  # the class converts it, and refuses one that is too large
    choices = typing.get_args(hint) if kind is Literal else ()
    if hint is Any or type(value) is kind or value in choices:
        return value
    raise source.error(keys, f"must be {'one of ' + ', '.join(map(str, choices)) if choices else NOUNS[kind]}", value)


def _number_or_word(
    hint: Any, words: tuple[Any, ...], unit: Unit | None, value: Any, source: TomlSource, keys: tuple[Key, ...]
) -> Any:
    try:
        return read_value(hint, False, unit, value, source, keys)
    except InputError as error:
        raise source.error(keys, f"{error.rule}; or one of {', '.join(words)}", value) from error


def _read_list(parts: tuple[Any, ...], unit: Unit | None, value: Any, source: TomlSource, keys: tuple[Key, ...]) -> Any:
    endless = parts[-1] is Ellipsis
    if dataclasses.is_dataclass(parts[0]) and isinstance(value, dict | str):
        return (read_value(parts[0], False, unit, value, source, keys),)
    if not isinstance(value, list) or not (endless or len(parts) == len(value)):
        if dataclasses.is_dataclass(parts[0]) or typing.get_origin(parts[0]) is dict:
            raise source.error(keys, f"must be tables, [[{'.'.join(map(str, keys))}]]", value)
        raise source.error(keys, "must be a list" if endless else f"must be a list of {len(parts)}", value)
    kinds = [parts[0]] * len(value) if endless else parts
    return tuple(
        read_value(of, False, unit, each, source, (*keys, number))
        for number, (of, each) in enumerate(zip(kinds, value, strict=True))
    )


def parse_setting(member: Member, text: str, name: str = "") -> Any:
    """Return the value of a setting from a text of the command line, checked by the rules of the setting.

    The text is what stands behind the equals sign in TOML, but texts need no quotes: ``4``, ``0.3in``, ``true``,
    ``[2, 3]`` or ``2,3``. ``name`` is the place in errors; "": the name of the setting.
    """
    source = TomlSource(name or member.name, Path())
    value: Any = text
    if member.kind not in (str, Path) and member.choices == ():
        value = _as_toml(text, member)
    if member.kind is float and member.unit is not None and member.unit.needed and text.strip()[-1:].isdigit():
        rule = f"needs a unit, such as {text}{member.unit.shown} or {text}mm"
        raise InputError(source.name, rule, shown(text), member.setting)
    try:
        return member.checked(read_value(member.hint, member.optional, member.unit, value, source, ()))
    except InputError as error:
        inner = error.place.removeprefix(f"{source.name}: ").strip()  # of a table in a list: 1.length
        rule = (f"{inner}: " if inner[:1].isdigit() and "." in inner else "") + error.rule + _unit_hint(member, text)
        raise InputError(source.name, rule, shown(text) if error.value else None, member.setting) from error


def _unit_hint(member: Member, text: str) -> str:
    """Return what to add to an error if a user most likely left out the unit: 8.5 for a bit of 8.5in."""
    try:
        number = float(text)
    except ValueError:
        return ""
    if member.unit is None or member.unit.kind != units.LENGTH or number <= 0:
        return ""
    return f"; a number without a unit is metres; did you mean {text}{'mm' if number > 100 else 'in'}?"


def _as_toml(text: str, member: Member) -> Any:
    """Return the TOML value that a text is; the text itself if it is none. A list needs no brackets."""
    if member.kind is not tuple or text.startswith("["):
        return _scalar(text)
    parts = [part.strip() for part in text.split(",") if part.strip()]
    if member.parts[0] is Path:
        return [text]  # a name may have a comma
    if member.parts[0] is str:
        return parts
    if dataclasses.is_dataclass(member.parts[0]):
        return [[_scalar(part) for part in parts]]
    return [[_scalar(one) for one in part.split("=", 1)] if "=" in part else _scalar(part) for part in parts]


def _scalar(text: str) -> Any:
    try:
        return parse_toml(f"value = {text}", "")["value"]
    except InputError:
        return text

"""Make options from declared settings: name, type, default and help of an option come from the declaration.

section("Wall", *options_of(Settings))      --sectors INTEGER   Vertices in a turn, K.  [default: 64]
settings_of(Settings, options)              the `Settings` that the values of these options state
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, Literal, TypeVar

import click
from click.core import ParameterSource

from helibore.base import units
from helibore.base.errors import InputError
from helibore.cli.quantities import Parameter
from helibore.settings.declared import Member, members
from helibore.settings.toml_reading import parse_setting

Made = TypeVar("Made")
METAVARS: dict[Any, str] = {units.LENGTH: "LENGTH", units.ANGLE: "ANGLE", units.TIME: "TIME"}
TYPES: dict[Any, str] = {int: "INTEGER", float: "NUMBER", str: "TEXT", tuple: "LIST", Path: "FILE"}


class SettingType(Parameter[Any]):
    """The type of an option for a setting: it reads a text as settings files do, with the rules of the setting."""

    def __init__(self, member: Member) -> None:
        self.member, self.name = member, member.name

    def joined(self, values: Iterable[Any], param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the values of an option that was given several times as one list."""
        texts = [self.convert(value, param, ctx) if isinstance(value, str) else (value,) for value in values]
        return self.convert(tuple(value for part in texts for value in part), param, ctx)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        try:
            return parse_setting(self.member, value) if isinstance(value, str) else self.member.checked(value)
        except InputError as error:
            self.fail(f"{value!r}: {error.rule}", param, ctx)


def options_of(kind: type[Any], *names: str) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the options, as `section` takes them, for the settings of a class that have an option.

    ``names``: only these settings, in this order.
    """
    known = members(kind)
    for name in names or known:
        if known[name].option is not None:
            yield option_of(known[name])


def option_of(member: Member) -> tuple[str, dict[str, Any]]:
    """Return the option of a setting; its value is None if it is not given, so that other sources may have it."""
    option = member.option
    name, negated = member.name.replace("_", "-"), member.kind is bool and member.default is True
    several = {"multiple": True} if member.kind is tuple and member.parts[-1] is Ellipsis else {}
    usual = f"{'' if option and option.usual else 'default: '}{member.default_text}" if member.default_text else ""
    facts = "; ".join(fact for fact in (usual, "repeatable" if several else "") if fact)
    text = member.summary + (f"  [{facts}]" if facts else "")
    if member.kind is bool:
        flag: dict[str, Any] = {"is_flag": True, "flag_value": not member.default, "default": None}
        flag["type"] = SettingType(member)
        return f"--{'no-' if negated else ''}{name} {member.name}", {"help": member.summary, **flag}
    metavar = (option.metavar if option else None) or (
        f"[{'|'.join(map(str, member.choices))}]"
        if member.kind is Literal
        else METAVARS[member.unit.kind]
        if member.unit
        else TYPES[member.kind]
    )
    return f"--{name}", {"help": text, "type": SettingType(member), "metavar": metavar, **several}


def stated(kind: type[Any], options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings of a class that the command line states; none of them if it states None by the word none."""
    source = click.get_current_context().get_parameter_source
    return {
        name: options[name]
        for name in members(kind)
        if name in options and (options[name] is not None or source(name) is ParameterSource.COMMANDLINE)
    }

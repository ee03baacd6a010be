"""``helibore settings``: list the settings, each with its default, its rule and its text, from their declarations.

Settings that only a command has (files, the page, what is written) are listed after the declared ones, from the options
of the commands.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from dataclasses import MISSING
from typing import Any

import click

from helibore.base.errors import InputError
from helibore.cli import MODULES
from helibore.cli.sections import FAMILIES, SHOWN, Sectioned, SectionOption, near
from helibore.cli.setting_groups import every_group
from helibore.cli.terminal import echo
from helibore.settings.declared import Member, members
from helibore.settings.groups import GROUPS


def known_settings(groups: Mapping[str, type[Any]]) -> dict[str, str]:
    """Return the text of each setting of these groups and of the commands by its name, in order of declaration."""
    options = _options()
    known = {
        f"{group}.{name}": _text(member, options.get(f"{group}.{name}"))
        for group, kind in groups.items()
        for name, member in members(kind).items()
    }
    for name, option in sorted(options.items(), key=lambda of: of[0].partition(".")[0]):
        if name not in known and option.name not in FAMILIES:
            known[name] = _help(option)
    return known


def _options() -> dict[str, SectionOption]:
    """Return the options of all commands by the names of their settings."""
    found: dict[str, SectionOption] = {}
    for verb in SHOWN:
        module = importlib.import_module(f"helibore.cli.{MODULES.get(verb, verb)}_command")
        command: Sectioned = getattr(module, verb)
        for each in (each for each in command.params if isinstance(each, SectionOption)):
            if each.expose_value and each.section != "Options" and (each.setting not in found or not each.rare):
                found[each.setting] = each
    return found


def _text(member: Member, option: SectionOption | None) -> str:
    """Return option, text, rule and default of a declared setting."""
    usual = "must be given" if member.default is MISSING else member.default_text and f"default: {member.default_text}"
    facts = "; ".join(fact for fact in (member.unit.word if member.unit else "", member.rule_text, usual) if fact)
    own = "" if option is None or option.rare else f"({option.opts[0]}) "
    return f"{own}{member.text.replace('``', '')}{f'  [{facts}]' if facts else ''}"


def _help(option: SectionOption) -> str:
    hidden, option.hidden = option.hidden, False
    record = option.get_help_record(click.Context(click.Command("helibore")))
    option.hidden = hidden
    own = "" if option.rare else f"({option.opts[0]}) "
    return own + (record[1] if record else "")


@click.command()
@click.argument("names", nargs=-1, metavar="[NAME]...")
def settings(names: tuple[str, ...]) -> None:
    """List the settings of a wall and of what is made from it: name, what it is, unit, rule, default.

    \b
    helibore settings                     all but those of a live wall
    helibore settings wall echo           those of two groups
    helibore settings wall.power          one
    helibore settings live                the configuration of a live wall
    helibore settings live.journal        one of its tables

    Every command that makes or shows a wall takes them as -s NAME=VALUE, those with an option of their own, too. Of
    several numbers, write 1,2,3; of a switch, true or false. Role maps, templates and the configuration of a live
    wall are files of their own; write their keys without map., template. or live. there.
    """
    known = known_settings(GROUPS)
    chosen = [name.replace("-", "_") for name in names]
    if not {*known, *map(_group, known)}.issuperset(chosen):  # live takes longer to load
        known = known_settings(every_group())
    groups = dict.fromkeys(_group(name) for name in known)
    for name in names:
        if name.replace("-", "_") not in known and name not in groups:
            every = sorted({*known, *groups})
            raise InputError(name, f"no setting or group; {near(name, every)}the groups are {', '.join(groups)}")
    formatter = click.get_current_context().make_formatter()
    for group in groups:
        rows = [
            (name, text)
            for name, text in known.items()
            if _group(name) == group and (not chosen or any(f"{name}.".startswith(f"{one}.") for one in chosen))
        ]
        if rows:
            with formatter.section(group):
                formatter.write_dl(rows, col_max=40)
    if not names:
        formatter.write_paragraph()
        formatter.write_text("Those of a live wall: helibore settings live")
    echo(formatter.getvalue().strip())


def _group(name: str) -> str:
    """Return the group of a setting: what stands before its last dot, or its name."""
    return name.rpartition(".")[0] or name

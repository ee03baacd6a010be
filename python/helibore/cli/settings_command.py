"""``helibore settings``: list the settings that ``-s`` states, each with its default, its commands and its text."""

from __future__ import annotations

import importlib

import click

from helibore.base.errors import InputError
from helibore.cli import MODULES, VERBS
from helibore.cli.sections import FAMILIES, Sectioned, SectionOption, near

SHOWN = ("reconstruct", "mesh", "plot", "report", "view", "logs", "zones")
"""The commands that take settings."""


def known_settings() -> dict[str, tuple[SectionOption, list[str]]]:
    """Return, by name and in the order of the help, each setting and the commands that take it."""
    found: dict[str, tuple[SectionOption, list[str]]] = {}
    for verb in (verb for verb in SHOWN if verb in VERBS):
        module = importlib.import_module(f"helibore.cli.{MODULES.get(verb, verb)}_command")
        command: Sectioned = getattr(module, verb)
        for each in command.params:
            if isinstance(each, SectionOption) and each.expose_value and each.section != "Options":
                found.setdefault(_name(each), (each, []))[1].append(verb)
    return found


def _name(option: SectionOption) -> str:
    family = FAMILIES.get(str(option.name))
    return f"{family}.NAME" if family else option.setting


@click.command()
@click.argument("names", nargs=-1, metavar="[NAME]...")
def settings(names: tuple[str, ...]) -> None:
    """List the settings of a wall and of what is made from it: name, default, what it is.

    \b
    helibore settings                     all
    helibore settings wall echo           those of two groups
    helibore settings wall.power          one

    Every command that makes or shows a wall takes them as -s NAME=VALUE, those with an option of their own, too. Of
    several numbers, write 1,2,3; of a switch, true or false.
    """
    known = known_settings()
    groups = {name.partition(".")[0] for name in known}
    for name in names:
        if name.replace("-", "_") not in known and name not in groups:
            every = sorted({*known, *groups})
            raise InputError(
                name, f"no setting or group; {near(name, every)}the groups are {', '.join(sorted(groups))}"
            )
    chosen = [name.replace("-", "_") for name in names]
    context = click.get_current_context()
    formatter = context.make_formatter()
    last = ""
    for name, (option, verbs) in sorted(known.items(), key=lambda of: of[0].partition(".")[0]):
        group = name.partition(".")[0]
        if chosen and name not in chosen and group not in chosen:
            continue
        if group != last:
            formatter.write(f"\n{group}:\n" if last else f"{group}:\n")
            last = group
        hidden, option.hidden = option.hidden, False
        record = option.get_help_record(click.Context(click.Command("helibore")))
        option.hidden = hidden
        text = record[1] if record else ""
        spelled = "" if option.rare else f"  ({option.opts[0]})"
        taken_by = "" if len(verbs) > 4 else f"  {', '.join(verbs)}."
        with formatter.indentation():
            formatter.write_dl([(f"{name}{spelled}", f"{text}{taken_by}")], col_max=40)
    click.echo(formatter.getvalue().rstrip())

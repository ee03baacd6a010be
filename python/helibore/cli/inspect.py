"""``helibore inspect FILE``: what a file holds, what each channel is taken for and why, and the map to change it.

Prints a table for each set (or the one named), the remarks of the reader, and the role map as TOML, ready to edit and
to pass back with ``--map``. Builds nothing.
"""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import click
import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.table import Table

import helibore
from helibore.channels.depth_remarks import depth_remarks
from helibore.channels.log_set import LogFile, LogSet
from helibore.channels.role_map import read_map, write_map
from helibore.channels.roles import NO_RULE, ROLES, Role, RoleMap, guess
from helibore.files.raw_set import Channel

WIDE = 120
"""Columns a terminal needs for the reasons to stand in the table; else they follow it, one a line."""


@click.command(short_help="What a file holds, and the map of it.")
@click.argument("file", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option(
    "--map", "map_file", type=click.Path(exists=True, dir_okay=False, path_type=Path), help="TOML map of roles."
)
@click.option("--set", "set_name", help="Look at this set only (a file may hold several).")
@click.option("--toml", is_flag=True, help="Print the role map alone, for a file.")
def inspect(file: Path, map_file: Path | None, set_name: str | None, toml: bool) -> None:
    """List the channels of FILE, their units, ranges and gaps, and what each is taken for.

    \b
    helibore inspect well.las
    helibore inspect well.las --toml > map.toml      # change it, then: helibore reconstruct well.las --map map.toml
    """
    with helibore.open(file) as opened:
        mapped = read_map(map_file, opened) if map_file else None
        if mapped:
            set_name = _same_set(set_name, mapped)
        if toml:
            one = opened.set(set_name)
            roles = mapped or guess(one)
            click.echo(write_map(roles, len(opened.sets) > 1, refusal(one, roles)))
            return
        chosen = [opened.set(set_name)] if set_name is not None else list(opened.sets)
        show(Console(), opened, chosen, mapped)


def _same_set(set_name: str | None, mapped: RoleMap) -> str | None:
    if set_name not in (None, mapped.set_name):
        raise ValueError(f"--set {set_name}: the map is for the set {mapped.set_name}")
    return mapped.set_name


def show(console: Console, opened: LogFile, sets: list[LogSet], mapped: RoleMap | None) -> None:
    """Print one table a set, the remarks, and the map."""
    console.print(f"[bold]{escape(opened.path.name)}[/]: {escape(opened.format)}, {len(opened.sets)} set(s)")
    for one in sets:
        roles = mapped or guess(one)
        wide = console.width >= WIDE
        console.print(table(one, roles, wide))
        if not wide:
            for role in roles:
                if role.role != "none" or role.reason != NO_RULE:
                    console.print(
                        f"  {escape(role.channel)}: [green]{role.role}[/], {escape(role.reason)}", highlight=False
                    )
        for remark in [*one.remarks, *depth_remarks(one, roles)]:
            console.print(f"  - {escape(remark)}", highlight=False)
        warning = refusal(one, roles)
        if warning:
            console.print(f"  - [red]refused as it stands[/]: {escape(warning)}", highlight=False)
        console.print("\n[bold]Role map[/] (edit, then pass it with --map):\n")
        # Printed bare: neither wrapped nor coloured, so that it can be copied.
        click.echo(write_map(roles, len(opened.sets) > 1, warning))


def refusal(one: LogSet, roles: RoleMap) -> str:
    """Why the samples or the survey of a set, taken for what they are taken for, would be refused; "" where not."""
    try:
        if roles.all("radius", "diameter", "radius-image"):
            one.readings(roles)
        elif roles.one("inclination") and roles.one("azimuth"):
            one.survey(roles)
    except ValueError as error:
        return str(error)
    return ""


def table(one: LogSet, roles: RoleMap, reasons: bool) -> Table:
    """Return the channels of a set as a table, with a column of reasons or without."""
    drawn = Table(title=f"{one.name}: {one.rows:,} rows", title_justify="left", box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    images = any(len(channel.shape) == 2 for channel in one)
    sectors = ["sectors"] if images else []
    for heading in ("channel", "unit", *sectors, "range", "missing", "role", *(["why"] if reasons else [])):
        justify: Literal["left", "right"] = "right" if heading in ("sectors", "missing") else "left"
        whole = heading in ("range", "missing", "role")
        drawn.add_column(heading, justify=justify, overflow="fold", no_wrap=whole)
    for channel in one:
        role = roles.roles.get(channel.name) or Role(channel.name, "none", "")
        drawn.add_row(
            escape(channel.name),
            _unit(role),
            *([str(channel.shape[1]) if len(channel.shape) == 2 else ""] if images else []),
            escape(span(channel)),
            share(channel),
            "" if role.role == "none" else f"[green]{role.role}[/]",
            *([escape(role.reason)] if reasons else []),
        )
    return drawn


def _unit(role: Role) -> str:
    needed = bool(ROLES[role.role]) and role.role != "time"
    return escape(role.unit) or ("[red]missing[/]" if needed else "")


def span(channel: Channel) -> str:
    """Smallest and largest value, or the first text."""
    if channel.is_text:
        return f"{str(channel.values.flat[0])[:16]!r} ..." if channel.values.size else "text"
    found = channel.values[np.isfinite(channel.values)]
    return f"{short(found.min())} .. {short(found.max())}" if found.size else "no values"


def short(value: float) -> str:
    """Five digits, and all before the point: 0.0386, 2.5554, 1590.1, 1023720."""
    return f"{value:.0f}" if 1e4 <= abs(value) < 1e9 else f"{value:.5g}"


def share(channel: Channel) -> str:
    """Missing values: count and percent."""
    total = channel.values.size
    return f"{channel.missing:,} ({100 * channel.missing / total:.2g} %)" if channel.missing and total else "0"

"""``helibore inspect FILE``: print what a file holds, which role each channel gets and why, and a map of these roles.

The command prints for each set, or for each set that ``--set`` chooses, a table of its channels, remarks, and the role
map as TOML. The user can edit the map and pass it back with ``--map``. The command builds no wall.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click
import numpy as np
from rich.box import SIMPLE_HEAD
from rich.markup import escape
from rich.table import Table

from helibore.channels.depth_remarks import depth_remarks
from helibore.channels.log_set import LogFile, LogSet
from helibore.channels.opening import open as open_file
from helibore.channels.role_map import read_map, write_map
from helibore.channels.roles import NO_RULE, ROLES, Role, RoleMap, guess
from helibore.cli.quantities import FILE
from helibore.cli.terminal import console as terminal_console
from helibore.cli.terminal import echo
from helibore.cli.wall_options import set_names
from helibore.cli.without_caliper import without_caliper
from helibore.files.raw_set import Channel

if TYPE_CHECKING:
    from rich.console import Console

WIDE = 120
"""A terminal with at least this many columns shows the reasons in the table; a narrower one shows them below it."""


@click.command(short_help="Show what a file holds and which role each channel gets.")
@click.argument("file", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--map", "map_file", type=FILE, help="TOML file of roles that replace the guessed roles of channels.")
@click.option(
    "--set",
    "sets",
    multiple=True,
    metavar="SETS",
    help="Show only these sets: a name, numbers (2,5-8), or all sets that hold these columns (with=CALX,CALY).",
)
@click.option("--header-line", type=int, help="Line of the column names of a table (CSV, XLSX).  [helibore finds it]")
@click.option("--toml", is_flag=True, help="Print only the role map, as TOML; a file with it can be given to --map.")
def inspect(file: Path, map_file: Path | None, sets: tuple[str, ...], header_line: int | None, toml: bool) -> None:
    """List the channels of FILE, their units, ranges, missing values, and the role that each channel gets.

    \b
    helibore inspect well.las
    helibore inspect well.las --toml > map.toml      # change it, then: helibore reconstruct well.las --map map.toml
    """
    with open_file(file, header_line=header_line) as opened:
        names = set_names(opened, sets) if sets else [each.name for each in opened.sets]
        mapped = None
        if map_file:
            alone = LogFile(opened.path, opened.format, [opened.set(names[0])]) if sets else opened
            mapped = read_map(map_file, alone)
            names = [each.name for each in opened.sets if each.name == mapped.set_name] or names[:1]
        if toml:
            log_set = opened.set(names[0]) if len(names) == 1 else opened.set()
            roles = mapped or guess(log_set)
            echo(write_map(roles, len(opened.sets) > 1, refusal(log_set, roles)))
            return
        show(terminal_console(), file, opened, names, mapped)


def show(console: Console, file: Path, opened: LogFile, names: list[str], mapped: RoleMap | None) -> None:
    """Print for each of the sets ``names`` a table of its channels, its remarks, and its role map."""
    console.print(f"[bold]{escape(opened.path.name)}[/]: {escape(opened.format)}, {len(opened.sets)} set(s)")
    for number, log_set in enumerate(opened.sets, 1):
        if log_set.name not in names:
            continue
        roles = mapped or guess(log_set)
        wide = console.width >= WIDE
        title = f"{number}. {log_set.name}" if len(opened.sets) > 1 else log_set.name
        console.print(table(log_set, roles, wide, title))
        if not wide:
            for role in roles:
                if role.role != "none" or role.reason != NO_RULE:
                    text = f"  {escape(role.channel)}: [green]{role.role}[/], {escape(role.reason)}"
                    console.print(text, highlight=False)
        for remark in [*log_set.remarks, *depth_remarks(log_set, roles)]:
            console.print(f"  - {escape(remark)}", highlight=False)
        warning = refusal(log_set, roles)
        if warning:
            console.print(f"  - [red]refused with these roles[/]: {escape(warning)}", highlight=False)
        lacks, command = without_caliper(file, opened, roles)
        if command:
            console.print(f"  - {escape(lacks)}:\n", highlight=False)
            echo(command)  # neither wrapped nor coloured, as the map below
        console.print("\n[bold]Role map[/] (edit, then pass it with --map):\n")
        # Printed bare: neither wrapped nor coloured, so that it can be copied.
        echo(write_map(roles, len(opened.sets) > 1, warning))


def refusal(log_set: LogSet, roles: RoleMap) -> str:
    """Return why helibore refuses the samples or the survey of a set with these roles; "" if it takes them."""
    try:
        if roles.all("radius", "diameter", "radius-image"):
            log_set.readings(roles)
        elif roles.one("inclination") and roles.one("azimuth"):
            log_set.survey(roles)
    except ValueError as error:
        return str(error)
    return ""


def table(log_set: LogSet, roles: RoleMap, reasons: bool, title: str) -> Table:
    """Return a table of the channels of a set and their roles; with ``reasons``, also of why they have these roles."""
    drawn = Table(title=f"{title}: {log_set.rows:,} rows", title_justify="left", box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    images = any(len(channel.shape) == 2 for channel in log_set)
    sectors = ["sectors"] if images else []
    for heading in ("channel", "unit", *sectors, "range", "missing", "role", *(["why"] if reasons else [])):
        justify: Literal["left", "right"] = "right" if heading in ("sectors", "missing") else "left"
        whole = heading in ("range", "missing", "role")
        drawn.add_column(heading, justify=justify, overflow="fold", no_wrap=whole)
    for channel in log_set:
        role = roles.roles.get(channel.name) or Role(channel.name, "none", "")
        needs_unit = bool(ROLES[role.role]) and role.role != "time"
        unit = escape(role.unit) or ("[red]missing[/]" if needs_unit else "")
        width = [str(channel.shape[1]) if len(channel.shape) == 2 else ""] if images else []
        colored, why = "" if role.role == "none" else f"[green]{role.role}[/]", [escape(role.reason)] if reasons else []
        drawn.add_row(escape(channel.name), unit, *width, escape(span(channel)), share(channel), colored, *why)
    return drawn


def span(channel: Channel) -> str:
    """Return the smallest and the largest value of a channel; of a channel of texts, the start of the first text."""
    if channel.is_text:
        return f"{str(channel.values.flat[0])[:16]!r} ..." if channel.values.size else "text"
    found = channel.values[np.isfinite(channel.values)]
    return f"{short(found.min())} .. {short(found.max())}" if found.size else "no values"


def short(value: float) -> str:
    """Return a number as text: five significant digits, or, from 10,000 to 1e9, all digits before the decimal point."""
    return f"{value:.0f}" if 1e4 <= abs(value) < 1e9 else f"{value:.5g}"


def share(channel: Channel) -> str:
    """Return the number of missing values of a channel, and their percentage of all its values, as text."""
    return f"{channel.missing:,} ({100 * channel.missing / channel.values.size:.3g} %)" if channel.missing else "0"

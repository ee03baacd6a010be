"""Print the tables and the role maps of ``helibore inspect``; loaded when a file is inspected."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.markup import escape
from rich.table import Table

from helibore.channels.depth_remarks import depth_remarks
from helibore.channels.log_set import LogFile, LogSet
from helibore.channels.role_map import write_map
from helibore.channels.roles import NO_RULE, ROLES, Role, RoleMap, guess
from helibore.cli.terminal import echo
from helibore.cli.without_caliper import without_caliper
from helibore.files.raw_set import Channel

if TYPE_CHECKING:
    from rich.console import Console

WIDE = 120
"""A terminal with at least this many columns shows the reasons in the table; a narrower one shows them below it."""


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

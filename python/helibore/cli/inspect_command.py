"""``helibore inspect FILE``: print what a file holds, which role each channel gets and why, and a map of these roles.

The command prints for each set, or for each set that ``--set`` chooses, a table of its channels, remarks, and the role
map as TOML. The user can edit the map and pass it back with ``--map``. The command builds no wall.
"""

from __future__ import annotations

from pathlib import Path

import click

from helibore.cli.quantities import FILE
from helibore.cli.terminal import console as terminal_console
from helibore.cli.terminal import echo


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
@click.option("--encoding", help="Encoding of a text, such as cp1251.  [UTF-8, or else Windows-1252]")
@click.option("--decimal", type=click.Choice([".", ","]), help="Decimal mark of the numbers.  [the cells decide]")
@click.option("--salvage", is_flag=True, help="Read what lies before the damage of a cut file.")
@click.option("--strict", is_flag=True, help="Refuse a file of which only a part can be read.")
@click.option("--layouts", type=FILE, help="File of rules for the layout of texts.  [the rules of helibore]")
@click.option("--toml", is_flag=True, help="Print only the role map, as TOML; a file with it can be given to --map.")
def inspect(
    file: Path, map_file: Path | None, sets: tuple[str, ...], header_line: int | None, encoding: str | None,
    decimal: str | None, salvage: bool, strict: bool, layouts: Path | None, toml: bool,
) -> None:  # fmt: skip
    """List the channels of FILE, their units, ranges, missing values, and the role that each channel gets.

    \b
    helibore inspect well.las
    helibore inspect well.las --toml > map.toml      # change it, then: helibore reconstruct well.las --map map.toml
    """
    from helibore.base.nulls import NULLS
    from helibore.channels.log_set import LogFile
    from helibore.channels.opening import open_file
    from helibore.channels.role_map import read_map, write_map
    from helibore.channels.roles import guess
    from helibore.cli.inspect_page import refusal, show
    from helibore.cli.set_names import set_names
    from helibore.files.input_file import ReadOptions

    with open_file(file, ReadOptions(NULLS, header_line, encoding, decimal, salvage, strict, layouts)) as opened:
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

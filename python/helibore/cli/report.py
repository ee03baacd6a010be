"""``helibore report SOURCE -o well.html``: one page with pictures, tables, data quality and settings."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from helibore.cli.plot import check_folder, drawing_options, takes_a_drawing
from helibore.cli.reading import FILE
from helibore.cli.terminal import Terminal
from helibore.cli.wall_source import takes_a_wall, wall_from

ENDINGS = (".html", ".htm")


@click.command(short_help="One HTML page: pictures, tables, data quality, settings.")
@takes_a_wall
@click.option("-o", "--output", type=FILE, required=True, help="Page to write: .html.")
@takes_a_drawing
def report(output: Path, quiet: bool, **options: Any) -> None:
    """Write a report of a wall as one self-contained HTML page.

    \b
    helibore report well.wall -o well.html --well "15/9-F-12"
    helibore report xy.csv.gz --diameter x_in@0 --diameter y_in@90 --bit-diameter 6.2in -o xy.html

    SOURCE and the options are those of `helibore plot`. The page needs no network and prints on A4.
    """
    if output.suffix.lower() not in ENDINGS:
        raise ValueError(f"{output}: the ending must be one of {', '.join(ENDINGS)}")
    check_folder(output)
    from helibore.plot.paper import require_matplotlib

    require_matplotlib()
    terminal = Terminal(quiet)
    found = wall_from(options, terminal)
    from helibore.plot.report import report as write

    with terminal.stage("report", "Writing the report"):
        write(found.wall, output, told=found.told, **drawing_options(options, found))
    size = f"{output} ({output.stat().st_size / 1e6:,.1f} MB)"
    terminal.summary([*found.told, ("time", terminal.times()), ("wrote", size)])

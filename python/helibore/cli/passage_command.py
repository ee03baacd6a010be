"""``helibore passage SOURCE -o passage.csv``: what passes through the hole, at each turn of a wall.

This file turns the options into calls of `Wall.drift` and `Wall.passage`; ``helibore.logs.passage`` explains them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from helibore.base.units import size_text
from helibore.cli.declared_options import options_of
from helibore.cli.logs_command import NAMED, write_table
from helibore.cli.outputs import OUTPUT, QUIET
from helibore.cli.sections import Sectioned, section
from helibore.cli.wall_options import SHOWN, takes_a_wall
from helibore.settings.output_settings import PassageSettings

if TYPE_CHECKING:
    from helibore.base.tables import LogTable
    from helibore.cli.lines import Lines
    from helibore.cli.terminal import Terminal
    from helibore.logs.passage import Passage
    from helibore.wall.wall import Wall

WORST = 5
"""Most tight intervals that the terminal lists."""


@click.command(cls=Sectioned, common=(*SHOWN, "well", "header", "unit", "length", "body", "limit", "sigma"))
@section("Options", OUTPUT("Table to write: .las, .csv, .parquet or .dlis."), QUIET)
@section("Passage", *options_of(PassageSettings))
@section("Logs", *NAMED)
@takes_a_wall
def passage(**options: Any) -> None:
    """Write what passes through a hole: the greatest rigid cylinder, or the clearance of a string, at each turn.

    \b
    helibore passage well.wall -o drift.csv --length 9m
    helibore passage well.wall -o clearance.csv --body 8.5in,0.3m --body 8in,9m,0.3m

    The bodies are rigid and straight; in a curved hole a long one is thin, and CURVE is what the path alone costs.
    Where the hole beside a body is not measured, the row is empty.
    """
    if options["length"] is not None and options["body"]:
        raise click.UsageError("--length and --body: give one of them")
    write_table("passage", options, _passage)


def _passage(wall: Wall, options: dict[str, Any], terminal: Terminal) -> tuple[LogTable, Lines]:
    with terminal.stage("passage", "Finding what passes"):
        found: Passage
        if options["body"]:
            found = wall.passage(options["body"], sigma=options["sigma"])
        else:
            found = wall.drift(options["length"] or "api-large-casing", sigma=options["sigma"])
    limit = options["limit"]
    if limit is None:
        limit = 0.0 if options["body"] else wall.settings.bit_diameter
    return found.table(), _lines(found, limit, "clearance" if options["body"] else "diameter")


def _lines(found: Passage, limit: float, what: str) -> Lines:
    """Return the lines on the least value, on what is unknown, and on the intervals below the limit, tightest first."""
    lines = [("string", f"{found.length:g} m long, rigid; {len(found.depth):,} turns")]
    row, unknown = found.at_least, int((~found.known).sum())
    if row is not None:
        size, depth = size_text(float(found.clearance[row])), found.depth[row]
        lines.append(("least", f"{what} {size} with the middle at {depth:.2f} m"))
        places = zip(found.contact_depth[row], found.contact_toolface[row], found.contact_body[row], strict=True)
        for place, toolface, body in places:
            if body >= 0:
                of = f", {found.string[body].name or f'body {body + 1}'}" if len(found.string) > 1 else ""
                lines.append(("", f"touches at {place:.2f} m, toolface {toolface:.0f} deg{of}"))
        if found.curvature[row] > 0:
            lines.append(("", f"the curvature of the path alone costs {size_text(float(found.curvature[row]))}"))
    if unknown:
        length = f"{unknown * found.height:,.1f} m"
        lines.append(("unknown", f"{length}: the hole beside the string is not measured, or the wall ends"))
    spots = found.tight(limit)
    lines.append(("tight", f"{len(spots)} interval{'s' * (len(spots) != 1)} with a {what} below {size_text(limit)}"))
    for spot in spots[:WORST]:
        where = f"{spot.start:.2f} to {spot.stop:.2f} m"
        lines.append(("", f"{where}: {size_text(spot.least)}, first at {spot.depth:.2f} m, {spot.toolface:.0f} deg"))
    return lines

"""``helibore cement SOURCE -o cement.csv``: the slurry of a casing in the measured hole.

This file turns the options into a call of `Logs.cement_sheet`; ``helibore.logs.cement_sheet`` explains it.
"""

from __future__ import annotations

import csv
import io
import math
from typing import TYPE_CHECKING, Any

import click

from helibore.base.units import BARREL
from helibore.cli.declared_options import options_of, stated
from helibore.cli.logs_command import NAMED
from helibore.cli.outputs import OUTPUT, QUIET, check_file, own_options, save_lines
from helibore.cli.sections import Sectioned, section
from helibore.cli.terminal import Terminal
from helibore.cli.wall_options import SHOWN, open_run, takes_a_wall
from helibore.settings.cement_settings import CementJob, CementTable
from helibore.settings.declared import members

if TYPE_CHECKING:
    from helibore.cli.lines import Lines
    from helibore.logs.cement_sheet import CementSheet


@click.command(cls=Sectioned, common=(*SHOWN, *members(CementJob), "sigma", "well"))
@section("Options", OUTPUT("Sheet to write (.csv)."), QUIET)
@section(
    "Cement",
    *options_of(CementTable),
    NAMED[0],
)
@takes_a_wall
def cement(**options: Any) -> None:
    """Write a cement sheet: rat hole, shoe track, open hole and lap of a casing, with excess and measured share.

    \b
    helibore cement well.wall -o cement.csv --casing 9.625in --inner-diameter 8.681in --shoe 1500m --shoe-track 24m \\
                    --previous-shoe 500m --previous-inner 12.415in --top 400m --excess 0.1

    Where the hole was not measured, a section takes the mean of its measured part. Volumes are m3, in the terminal
    also barrels.
    """
    from helibore.base.atomic_file import write_whole
    from helibore.runs.run import make_wall

    output = options["output"]
    check_file(output, (".csv",))
    terminal = Terminal(options["quiet"])
    run = open_run(options, terminal, (output,))
    options = own_options(run, "cement", options)
    for name in ("casing", "shoe"):
        if options[name] is None:
            raise click.UsageError(f"Missing option '--{name}'.")
    job = CementJob(**stated(CementJob, options))
    wall = make_wall(run, options["threads"], terminal.stage).wall
    with terminal.stage("measure", "Measuring"):
        logs = wall.logs(sigma=options["sigma"], caliper_accuracy=options["caliper_accuracy"])
        found = logs.cement_sheet(job)
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(found.rows())
    with terminal.stage("save", f"Writing {output.name}"):
        write_whole(output, lambda file: file.write(text.getvalue().encode()))
        saved = save_lines(run, output, "cement", options)
    unsure: Lines = [("warning", text) for text in logs.warnings()]
    terminal.summary([*run.messages, *_lines(found), *unsure, *saved, ("time", terminal.times())])


def _lines(found: CementSheet) -> Lines:
    """Return a line for each section, one for the total, and one for what is displaced."""
    lines: Lines = []
    for each in found.sections:
        part = f"{each.name}{f' ({each.slurry})' if each.slurry else ''}, {each.top:.2f} to {each.bottom:.2f} m"
        share = "" if each.measured > 0.9995 else f", {100 * each.measured:.1f} % measured"
        lines.append(("" if lines else "cement", f"{part}: {_volume(each.volume)}{share}"))
    sigma = "" if math.isnan(found.sigma) else f", sigma at most {_volume(found.sigma)}"
    excess = f" with {100 * found.job.excess:g} % excess over the open hole" if found.job.excess else ""
    lines.append(("total", f"{_volume(found.total)}{excess}{sigma}"))
    by_bit = sum(each.by_bit_size for each in found.sections)
    lines.append(("", f"{100 * (found.total / by_bit - 1):+.1f} % against bit size" if by_bit else "by caliper"))
    if not math.isnan(found.displacement):
        lines.append(("displace", _volume(found.displacement)))
    return lines


def _volume(cubic_metres: float) -> str:
    return f"{cubic_metres:.2f} m3 ({cubic_metres / BARREL:.1f} bbl)"

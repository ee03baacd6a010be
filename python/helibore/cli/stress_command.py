"""``helibore stress SOURCE -o stress.csv``: the direction of the greatest horizontal stress, and its rank.

This file turns the options into calls of `stress_of_picks` and `stress_of_zones`; ``helibore.logs.stress`` explains
them.
"""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING, Any

import click

from helibore.base.errors import check_ending
from helibore.cli.declared_options import options_of
from helibore.cli.logs_command import NAMED
from helibore.cli.outputs import OUTPUT, QUIET, check_file, own_options, save_lines
from helibore.cli.quantities import FILE
from helibore.cli.sections import Sectioned, opt, section
from helibore.cli.terminal import Terminal
from helibore.cli.wall_options import SHOWN, header_of, load_picks, open_run, picks_option, takes_a_wall
from helibore.cli.zone_options import CRITERIA, criteria_of
from helibore.settings.output_settings import StressSettings

if TYPE_CHECKING:
    from helibore.cli.lines import Lines
    from helibore.logs.stress import HorizontalStress
    from helibore.wall.wall import Wall

SHARED = ("picks", "feature", "of_zones", "scheme", "weighting", "to_true", "latitude", "longitude", "regime", "rose")


@click.command(cls=Sectioned, common=(*SHOWN, *SHARED))
@section("Options", OUTPUT("Record to write (.csv)."), QUIET)
@section(
    "Stress",
    picks_option(exists=True),
    *options_of(StressSettings),
    opt("--rose", "Picture to write: rose, and features by depth (.png, .svg, .pdf).", type=FILE),
    *NAMED[:2],
)
@section("Zones", *CRITERIA)
@takes_a_wall
def stress(**options: Any) -> None:
    """Write the direction of the greatest horizontal stress (SHmax) as a record of the World Stress Map, A to E.

    \b
    helibore stress f12.wall -o shmax.csv --rose shmax.png --latitude 58.4 --longitude 1.9
    helibore stress f12.wall -o shmax.csv --of-zones

    Azimuths count from true north along the path of the wall. Breakouts lie across SHmax, induced fractures along it.
    Features where the hole is inclined by more than 20 degrees are left out.
    """
    from helibore.base.atomic_file import write_whole
    from helibore.runs.run import make_wall

    output, rose = options["output"], options["rose"]
    check_file(output, (".csv",))
    if rose is not None:
        check_ending(rose, (".png", ".svg", ".pdf"))
    terminal = Terminal(options["quiet"])
    run = open_run(options, terminal, tuple(filter(None, (output, rose))))
    options = own_options(run, "stress", options)
    wall = make_wall(run, options["threads"], terminal.stage).wall
    load_picks(run, options["picks"])
    found, lines = found_stress(wall, options)
    name = header_of(run, options).get("well", run.name)
    record = found.record(options["latitude"], options["longitude"], options["regime"], name)
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([record.keys(), record.values()])
    with terminal.stage("save", f"Writing {output.name}"):
        write_whole(output, lambda file: file.write(text.getvalue().encode()))
        if rose is not None:
            from helibore.plot.paper import save
            from helibore.plot.stress_rose import stress_rose

            save(stress_rose(found, name), rose)
        saved = save_lines(run, output, "stress", options, tuple(filter(None, (rose,))))
    if options["latitude"] is None or options["longitude"] is None:
        lines.append(("record", "without --latitude and --longitude, its LAT and LON are empty"))
    terminal.summary([*run.messages, *lines, *saved, ("time", terminal.times())])


def found_stress(wall: Wall, options: dict[str, Any]) -> tuple[HorizontalStress, Lines]:
    """Return SHmax from picks or from the wall's zones, and its lines for the terminal."""
    from helibore.base.errors import InputError
    from helibore.logs.stress import stress_of_picks, stress_of_zones

    if wall.path is None:
        raise InputError("stress", "needs the path of the hole, for azimuths: give --survey")
    kind, weighting = options["feature"], options["weighting"]
    if options["of_zones"]:
        if kind != "breakout":
            raise InputError("feature", "zones are breakouts; induced fractures are among picks", repr(kind))
        zones = wall.zones(criteria_of(wall, options)).zones
        found = stress_of_zones(zones, wall.path, options["scheme"] or "caliper", weighting, options["to_true"])
    else:
        scheme = options["scheme"] or "image"
        found = stress_of_picks(wall.picks, wall.path, kind, scheme, weighting, options["to_true"])
    lines = [("stress", str(found))]
    if not wall.path.survey.north and options["to_true"] is None and found.count:
        lines.append(
            (
                "",
                "the survey does not state its north: azimuths are taken to count from true north "
                "(path.north states it)",
            )
        )
    if found.left_out:
        lines.append(
            ("", f"{found.left_out} left out: the hole is inclined by more than 20 deg, or has no azimuth there")
        )
    if not found.count and not options["of_zones"]:
        lines.append(("", "no pick of this class: --picks names a table, --of-zones takes the breakouts of the wall"))
    return found, lines

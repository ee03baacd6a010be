"""``helibore logs SOURCE -o well.las``: measure every turn, or step of depth, of a wall, and write a file of logs.

This file turns the options into calls of `Wall.logs`, `Logs.annulus`, `classify` and `SectorImage.breakouts`.
``helibore.logs`` says what each log is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from helibore.base.decimals import DECIMALS
from helibore.base.errors import InputError
from helibore.cli.declared_options import options_of
from helibore.cli.lines import (
    annulus_lines,
    breakout_line,
    interval_lines,
    row_line,
    sigma_lines,
    summary_lines,
    zone_lines,
)
from helibore.cli.outputs import OUTPUT, QUIET, check_file, check_folder, own_options, save_lines
from helibore.cli.quantities import FILE, across_and_along, facts_in, split_pair
from helibore.cli.sections import Sectioned, opt, opts, section
from helibore.cli.terminal import Terminal
from helibore.cli.wall_options import (
    SHOWN,
    header_of,
    load_picks,
    open_run,
    picks_option,
    refuse_interval,
    takes_a_wall,
)
from helibore.cli.zone_options import CRITERIA, HEADER, IMAGE_CRITERIA, criteria_of
from helibore.settings.output_settings import LogSettings
from helibore.settings.zone_settings import ImageCriteria

if TYPE_CHECKING:
    from helibore.base.tables import LogColumn, LogImage, LogTable
    from helibore.cli.lines import Lines
    from helibore.logs.turn_logs import Logs
    from helibore.logs.zones import Classification
    from helibore.wall.wall import Wall

ALONG = ("DEPT", "TOP", "BOTTOM", "LENGTH", "NEAREST", "TVD", "PEAK")
"""Columns that hold lengths along the hole or on the wall, not sizes across the hole."""

NAMED = (
    opt("--well", "Name of the well, for the files.  [as the source states it, else the name of its file]"),
    HEADER,
    *options_of(LogSettings, "unit"),
)
"""Options of every table of a wall: the names of the well, and the unit."""

COMMON = (
    *SHOWN, "step", "sigma", "by_sector", "casing", "drift", "well", "header", "unit", "zones", "breakouts",
    "interval_table", "picks", "dips",
)  # fmt: skip
"""Parameters that have an option of their own in ``logs``."""


@click.command(
    "logs",
    cls=Sectioned,
    common=COMMON,
)
@section("Options", OUTPUT("Logs to write: .las, .csv, .parquet or .dlis."), QUIET)
@section(
    "Logs",
    *options_of(LogSettings, "step", "rugosity_window", "sigma", "caliper_accuracy", "by_sector", "casing", "drift"),
    *NAMED,
)
@section(
    "Zones",
    opt("--zones", "Table of washouts, breakouts, key seats and undergauge hole to write; endings as for --output.",
        type=FILE),
    *CRITERIA,
    IMAGE_CRITERIA,
    opt("--interval-table", "Table of diameters, volumes and kinds by interval to write (.csv).", type=FILE),
    opts("--breakouts", "Table to write of the breakouts (dark, opposite sectors) of an image.", metavar="IMAGE=FILE"),
    opt("--dips", "Table to write of the true dips of the picks, for Techlog and Geolog (.csv), Petrel (.dip).",
        type=FILE),
    picks_option(exists=True),
)  # fmt: skip
@takes_a_wall
def logs(**options: Any) -> None:
    """Measure a wall: diameters, ovality, rugosity, volumes, zones, for each turn or each step of depth.

    \b
    helibore logs well.wall -o well.las --step 0.5m --casing "7in" --zones zones.csv
    helibore logs caliper.csv --bit-diameter 8.5in -o well.csv

    With --from and --to, only the rows between them are written. If a row is a turn, it also has the class of hole
    (CLASS). Each image of the wall has a column with its mean around the hole. Every file states bit size, windows,
    definitions and criteria. The file well.las.toml beside well.las repeats the run.
    """
    from helibore.files.dip_writing import ENDINGS, north_text, save_dips
    from helibore.files.log_writing import check_format, save_table
    from helibore.logs.difference_columns import difference_columns
    from helibore.logs.image_means import image_means
    from helibore.logs.intervals import interval_table
    from helibore.logs.summary import summarize

    output, zones_file, by_interval = options["output"], options["zones"], options["interval_table"]
    dips = options["dips"]
    pairs = [split_pair("breakouts", text, "IMAGE=FILE") for text in options["breakouts"]]
    images = {name: Path(file) for name, file in pairs}
    tables = [output, *([zones_file] if zones_file else []), *images.values()]
    for file in tables:
        check_format(file)
        check_folder(file)
    if by_interval:
        check_file(by_interval, (".csv",))
        tables.append(by_interval)
    if dips:
        check_file(dips, ENDINGS)
        tables.append(dips)
    if len({file.resolve() for file in tables}) < len(tables):
        raise click.UsageError("--output, --zones, --breakouts, --dips and --interval-table: the files must differ")
    terminal = Terminal(options["quiet"])
    run = open_run(options, terminal, tables)
    options = own_options(run, "logs", options)
    from helibore.runs.run import make_wall, preparation_lines

    make_wall(run, options["threads"], terminal.stage)
    wall, header = run.wall, {"well": run.name} | header_of(run, options)
    unknown = [name for name in images if name not in wall.images]
    if unknown:
        there = ", ".join(wall.images) or "none"
        raise InputError(f"image {unknown[0]!r}", f"the wall has no image of this name; it has {there}")
    load_picks(run, options["picks"])
    with terminal.stage("measure", "Measuring"):
        measured = _measured(wall, options, run.reference)
        annuli = [measured.rows.annulus(size) for size in options["casing"]]
        dark = [wall.images[name].breakouts(ImageCriteria(**options["image_criteria"])) for name in images]
        images_by_turn = _by_sector(wall, options) if options["by_sector"] else []
        summary = summarize(wall._state(), options["start_depth"], options["stop_depth"], zones=measured.found)
    written = 0
    if dips and wall.path is None:
        raise InputError("dips", "need the path of the hole: give --survey")
    if by_interval and not wall.intervals:
        raise InputError("intervals", "the wall has none: name a file of tops", setting="intervals.file")
    columns = [*measured.columns, *(column for each in annuli for column in each.columns())]
    if annuli:
        columns += measured.rows.integrated_columns()
    columns += [wall.drift(length).column(measured.rows) for length in options["drift"]]
    columns += difference_columns(measured.rows, wall)
    columns += image_means(measured.rows, wall.images)
    facts = measured.zones.criteria.facts() if measured.zones else {}
    prepared = enumerate(preparation_lines(wall), 1)
    facts |= {f"prepared {number}": f"{label} {text}".strip() for number, (label, text) in prepared}
    if measured.columns:
        from helibore.logs.zones import CLASSES

        facts["class"] = CLASSES
    work: list[tuple[Path, LogTable]] = [(output, measured.rows.table(columns, facts, images_by_turn))]
    if zones_file and measured.zones:
        work.append((zones_file, measured.zones.table()))
    work += [(file, each.table()) for file, each in zip(images.values(), dark, strict=True)]
    intervals = interval_table(wall._state(), wall.intervals, measured.found) if wall.intervals else None
    dip_lines: Lines = []
    with terminal.stage("save", f"Writing {output.name}"):
        if by_interval and intervals:
            intervals.save(by_interval, options["unit"])
        if dips and wall.path is not None:
            written = save_dips(wall.picks, wall.path, dips, header["well"])
            planes = f"{written} planes with a true dip, of {len(wall.picks)} picks"
            hint = "" if wall.path.survey.north else "; path.north states it"
            dip_lines.append(("dips", f"{planes}; azimuths from {north_text(wall.path)}{hint}"))
        for file, table in work:
            save_table(in_unit(table, options["unit"]), file, header=header)
        saved = save_lines(run, output, "logs", options, tables[1:])
    terminal.summary([
        *run.messages,
        row_line(measured.rows),
        *sigma_lines(measured.rows),
        *summary_lines(summary),
        *(interval_lines(intervals) if intervals else []),
        *annulus_lines(measured.turns.annulus(size) for size in options["casing"]),
        *(zone_lines(measured.zones, summary, options["unit"]) if measured.zones else []),
        *(breakout_line(each) for each in dark),
        *dip_lines,
        *saved,
        ("time", terminal.times()),
    ])  # fmt: skip


@click.command(cls=Sectioned, common=(*SHOWN, "well", "header", "unit", "scaled"))
@section("Options", OUTPUT("Table to write: .las, .csv, .parquet or .dlis."), QUIET)
@section("Logs", *NAMED)
@section("Zones", *CRITERIA)
@takes_a_wall
def zones(**options: Any) -> None:
    """Write the zones of a wall as a table: washouts, breakouts, key seats and undergauge hole.

    \b
    helibore zones well.wall -o zones.csv
    helibore zones well.wall -o zones.csv -s zones.washout=0.3in -s zones.join=2m

    The table states the criteria. The file zones.csv.toml beside zones.csv repeats the run.
    """
    write_table("zones", options, _found_zones)


def _found_zones(wall: Wall, options: dict[str, Any], _terminal: Terminal) -> tuple[LogTable, Lines]:
    from helibore.logs.summary import summarize
    from helibore.logs.zones import classify

    criteria = criteria_of(wall, options)
    if wall.basis != "azimuthal":
        raise InputError("zones", f"need a shape that was measured; this wall: {wall.basis_text}")
    found = classify(wall, criteria)
    return found.table(), zone_lines(found, summarize(wall._state(), zones=found), options["unit"])


def write_table(
    verb: str, options: dict[str, Any], measure: Callable[[Wall, dict[str, Any], Terminal], tuple[LogTable, Lines]]
) -> None:
    """Make a wall, and write the one table of ``verb``; ``measure`` returns it, with its lines for the terminal."""
    from helibore.files.log_writing import check_format, save_table
    from helibore.runs.run import make_wall

    output = options["output"]
    check_format(output)
    check_folder(output)
    terminal = Terminal(options["quiet"])
    run = open_run(options, terminal, (output,))
    options = own_options(run, verb, options)
    refuse_interval(run, options)
    run = make_wall(run, options["threads"], terminal.stage)
    load_picks(run, None)
    table, lines = measure(run.wall, options, terminal)
    with terminal.stage("save", f"Writing {output.name}"):
        header = {"well": run.name} | header_of(run, options)
        save_table(in_unit(table, options["unit"]), output, header=header)
        saved = save_lines(run, output, verb, options)
    terminal.summary([*run.messages, *lines, *saved, ("time", terminal.times())])


def in_unit(table: LogTable, unit: str) -> LogTable:
    """Return the table with sizes across the hole in ``unit``; ft: in inches, with lengths along the hole in feet."""
    from helibore.base import units
    from helibore.base.tables import LogTable

    across, along = across_and_along(unit)

    def changed(one: LogColumn) -> LogColumn:
        to = along if one.mnemonic in ALONG else across
        if one.unit != "m" or to == "m":
            return one
        values = one.values / units.factor(to, units.LENGTH)
        return replace(one, unit=to, values=values, decimals=DECIMALS[to])

    def image_in(one: LogImage) -> LogImage:
        same = one.unit != "m" or across == "m"
        return one if same else replace(one, unit=across, values=one.values / units.factor(across, units.LENGTH))

    if unit == "m":
        return table
    return LogTable([changed(one) for one in table], facts_in(table.facts, unit), [*map(image_in, table.images)])


class _Measured(NamedTuple):
    """The zones and logs of a wall.

    ``found`` are the zones of the whole wall, ``zones`` the same, or None if its shape was not measured. ``turns`` are
    the turns between --from and --to. ``rows`` are the rows to write: these turns, or steps of depth. ``columns`` are
    added to the rows: the class of hole, if a row is a turn and there are zones.
    """

    found: Classification
    zones: Classification | None
    turns: Logs
    rows: Logs
    columns: list[LogColumn]


def _by_sector(wall: Wall, options: dict[str, Any]) -> list[LogImage]:
    """Return radius, sigma and images of the turns between --from and --to."""
    from helibore.logs.wall_images import wall_images

    if options["step"] is not None:
        raise click.UsageError("--by-sector: does not go with --step, since a row is a turn")
    inside = wall.logs().rows_between(options["start_depth"], options["stop_depth"])
    return [replace(of, values=of.values[inside]) for of in wall_images(wall, options["sigma"])]


def _measured(wall: Wall, options: dict[str, Any], reference: Any) -> _Measured:
    from helibore.logs.zones import classify

    shaped = wall.basis == "azimuthal"
    criteria = criteria_of(wall, options)
    if not shaped and options["zones"]:
        raise InputError("zones", f"need a shape that was measured; this wall: {wall.basis_text}")
    every = wall.logs(
        rugosity_window=options["rugosity_window"], sigma=options["sigma"], caliper_accuracy=options["caliper_accuracy"]
    )
    if reference not in (None, every.reference):
        if every.reference:
            raise InputError(
                f"-s path.reference={reference}", f"the wall's path counts toolfaces from {every.reference}"
            )
        every = replace(every, reference=reference)
    inside = every.rows_between(options["start_depth"], options["stop_depth"])
    if not inside.any():
        ends = (
            f"turns reach from {every.depth.min():g} to {every.depth.max():g} m" if len(every) else "the wall has none"
        )
        raise InputError("--from and --to", f"no full turn of the wall lies between them; {ends}")
    turns = every.between(options["start_depth"], options["stop_depth"])
    found = classify(wall, criteria, every)
    zones = found if shaped else None
    if options["step"] is None:
        classes = [replace(of, values=of.values[inside]) for of in ([zones.column()] if zones else [])]
        return _Measured(found, zones, turns, turns, classes)
    rows = turns.by_step(options["step"])
    if not len(rows):
        ends = f"{turns.depth.min():g} to {turns.depth.max():g} m"
        rule = f"the turns, {ends}, must reach from one multiple of the step to the next"
        raise InputError("step", rule, f"{options['step']:g}")
    return _Measured(found, zones, turns, rows, [])

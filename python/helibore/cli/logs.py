"""``helibore logs SOURCE -o well.las``: every turn, or step of depth, of a wall measured, as a file of logs.

Options become calls of `Wall.logs`, `annulus`, `Wall.zones` and `SectorImage.breakouts` here; what each log is, is
``helibore.logs.turn_logs``' business, and what is printed ``log_lines``'.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from helibore.cli.plot import check_folder
from helibore.cli.quantities import LENGTH
from helibore.cli.reading import FILE
from helibore.cli.sections import Sectioned
from helibore.cli.terminal import Terminal
from helibore.cli.wall_source import takes_a_wall, wall_from

if TYPE_CHECKING:
    from helibore.base.tables import LogColumn, LogTable
    from helibore.logs.turn_logs import Logs
    from helibore.logs.zones import Classification, Criteria
    from helibore.wall.wall import Wall


class LogsCommand(Sectioned):
    """The verb, its options in sections."""

    sections = {"--bit-diameter": "Source", "--step": "Logs", "--zones": "Zones", "--quiet": "Options"}  # noqa: RUF012


@click.command("logs", cls=LogsCommand, short_help="A wall measured into logs: LAS, CSV, Parquet, DLIS.")
@click.option("-o", "--output", type=FILE, required=True, help="Logs to write: .las, .csv, .parquet or .dlis.")
@takes_a_wall
@click.option("--step", type=LENGTH, help="One row for each step of depth.  [one a turn]")
@click.option("--rugosity-window", type=LENGTH, default="1m", show_default=True, help="Of hole, that rugosity is over.")
@click.option("--casing", "casings", type=LENGTH, multiple=True, help="Outer diameter: annulus, clearance; repeatable.")
@click.option("--well", help="Name of the well, for the files.  [name of the source]")
@click.option("--zones", type=FILE, help="Table of washouts, breakouts, key seats, undergauge hole: as --output.")
@click.option(
    "--criterion", "criteria", metavar="NAME=VALUE", multiple=True,
    help="Of zones, such as elongation=0.5in, washout, key-seat, undergauge, symmetry, least-length; repeatable.",
)  # fmt: skip
@click.option("--scaled", is_flag=True, help="Criteria in proportion to the bit; the trade's are for 8.5 in.")
@click.option(
    "--breakouts", metavar="IMAGE=FILE", multiple=True, help="Table of dark, opposite sectors of an image; repeatable."
)
@click.option("-q", "--quiet", is_flag=True, help="Print nothing but errors.")
def logs(output: Path, quiet: bool, **options: Any) -> None:
    """Measure a wall: diameters, ovality, rugosity, volumes, zones, turn by turn or by steps of depth.

    \b
    helibore logs well.wall -o well.las --step 0.5m --casing "7in" --zones zones.csv
    helibore logs xy.csv.gz --diameter x_in@0 --diameter y_in@90 --bit-diameter 6.2in -o xy.csv

    SOURCE and what makes the wall of it are those of `helibore plot`. With --from and --to, rows between them. Rows a
    turn have the class of hole, too (CLASS). Every file states bit size, windows, definitions and criteria.
    """
    from helibore.cli.log_lines import breakout_lines, lines, zone_lines
    from helibore.files.log_files import check_ending, save_table
    from helibore.logs.annulus import annulus

    images = dict(_image_file(text) for text in options["breakouts"])
    tables = [output, *([options["zones"]] if options["zones"] else []), *images.values()]
    for file in tables:
        check_ending(file)
        check_folder(file)
    if len({file.resolve() for file in tables}) < len(tables):
        raise click.UsageError("--output, --zones and --breakouts: the files must differ")
    terminal = Terminal(quiet)
    found = wall_from(options, terminal)
    wall, well = found.wall, options["well"] or found.name
    unknown = [name for name in images if name not in wall.images]
    if unknown:
        there = ", ".join(wall.images) or "none"
        raise ValueError(f"image {unknown[0]!r}: the wall has none of this name; it has {there}")
    with terminal.stage("measure", "Measuring"):
        one = _measured(wall, options)
        annuli = [annulus(one.rows, size) for size in options["casings"]]
        dark = [wall.images[name].breakouts() for name in images]
    columns = [*one.columns, *(column for each in annuli for column in each.columns())]
    facts = one.zones.criteria.facts() if one.zones else {}
    if one.columns:
        from helibore.logs.zones import CLASSES

        facts["class"] = CLASSES
    work: list[tuple[Path, LogTable]] = [(output, one.rows.table(columns, facts))]
    if options["zones"] and one.zones:
        work.append((options["zones"], one.zones.table()))
    work += [(file, each.table()) for file, each in zip(images.values(), dark, strict=True)]
    with terminal.stage("save", f"Writing {output.name}"):
        for file, table in work:
            save_table(table, file, well)
    written = [f"{file} ({file.stat().st_size / 1e6:,.2f} MB)" for file, _ in work]
    terminal.summary([
        *found.told,
        *lines(one.rows, one.turns, [annulus(one.turns, size) for size in options["casings"]]),
        *(zone_lines(one.zones, options["start_depth"], options["stop_depth"]) if one.zones else []),
        *(line for each in dark for line in breakout_lines(each)),
        ("time", terminal.times()),
        ("wrote", ", ".join(written)),
    ])  # fmt: skip


@dataclass(frozen=True)
class _Measured:
    """Zones of the whole wall, where it has a shape; between two depths its turns, the rows to write, more columns."""

    zones: Classification | None
    turns: Logs
    rows: Logs
    columns: list[LogColumn]


def _measured(wall: Wall, options: dict[str, Any]) -> _Measured:
    from helibore.logs.zones import classify
    from helibore.samples.caliper import BASIS_TEXT

    shaped = wall.basis == "azimuthal"
    if not shaped and (options["zones"] or options["criteria"] or options["scaled"]):
        raise ValueError(f"zones need a shape that was measured; this wall: {BASIS_TEXT[wall.basis]}")
    criteria = _criteria(wall, options)
    every = wall.logs(rugosity_window=options["rugosity_window"])
    if options["reference"] not in (None, every.reference):
        if every.reference:
            raise ValueError(f"--reference {options['reference']}: the wall's path counts from {every.reference}")
        every = replace(every, reference=options["reference"])
    inside = every.rows_between(options["start_depth"], options["stop_depth"])
    if not inside.any():
        reach = f"they reach from {every.depth.min():g} to {every.depth.max():g} m" if len(every) else "there are none"
        raise ValueError(f"no full turns of the wall between --from and --to: {reach}")
    turns = every.between(options["start_depth"], options["stop_depth"])
    zones = classify(wall, criteria, every) if shaped else None
    step = options["step"]
    if step is None:
        classes = [replace(of, values=of.values[inside]) for of in ([zones.column()] if zones else [])]
        return _Measured(zones, turns, turns, classes)
    rows = turns.by_step(step)
    if not len(rows):
        ends = f"{turns.depth.min():g} to {turns.depth.max():g} m"
        raise ValueError(f"step = {step:g}: no whole step among the turns, {ends}")
    return _Measured(zones, turns, rows, [])


def _criteria(wall: Wall, options: dict[str, Any]) -> Criteria:
    """The criteria of the trade, or those in proportion to the bit, with what the options set."""
    from helibore.base import units
    from helibore.logs.zones import Criteria

    shares = ("symmetry", "opening_level")
    known = [field.name for field in fields(Criteria)]
    found = {}
    for text in options["criteria"]:
        name, equals, value = text.partition("=")
        name = name.replace("-", "_")
        if not equals or name not in known:
            raise click.UsageError(
                f"--criterion {text}: must be NAME=VALUE, NAME one of {', '.join(known).replace('_', '-')}"
            )
        try:
            found[name] = float(value) if name in shares else units.quantity(value, units.LENGTH)
        except ValueError as error:
            raise click.UsageError(f"--criterion {text}: {error}") from None
    return Criteria.scaled(wall.settings.bit_diameter, **found) if options["scaled"] else Criteria(**found)


def _image_file(text: str) -> tuple[str, Path]:
    name, equals, file = text.rpartition("=")
    if not (name and equals and file):
        raise click.UsageError(f"--breakouts {text}: must be IMAGE=FILE")
    return name, Path(file)

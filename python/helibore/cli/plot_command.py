"""``helibore plot`` and ``helibore report``: draw a wall as a log on paper, or write a report as one HTML page.

This file turns the options into the arguments of a `Drawing`, which ``helibore.plot`` draws. Options that other
commands also have are in ``wall_options``, ``zone_options`` and ``outputs``.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from helibore.base.errors import InputError
from helibore.cli.declared_options import SettingType, option_of, options_of, stated
from helibore.cli.lines import Lines, trust_lines
from helibore.cli.outputs import OUTPUT, QUIET, add_sigma, check_file, own_options, save_lines
from helibore.cli.sections import Sectioned, opt, section
from helibore.cli.stress_command import found_stress
from helibore.cli.terminal import Terminal
from helibore.cli.wall_options import (  # fmt: skip
    BESIDE,
    INCLINATION,
    SCALAR,
    SHOWN,
    TEMPLATE,
    curves_of_files,
    header_of,
    load_picks,
    open_run,
    picks_option,
    takes_a_wall,
    template_of_option,
    walls_beside,
)
from helibore.cli.zone_options import CRITERIA, HEADER, LOOK, criteria_of
from helibore.settings.cement_settings import CementJob
from helibore.settings.declared import members
from helibore.settings.output_settings import StressSettings
from helibore.settings.print_settings import PrintSettings, PrintTable

if TYPE_CHECKING:
    from helibore.logs.curves import ScalarCurve
    from helibore.plot import Look
    from helibore.runs.run import Run

PAGES = (".html", ".htm")
COMMON = (
    *SHOWN, "beside", "scalar", "picks", "header", "template", "scale", "unit", "curves", "look", "polar",
    "no_polar", "body", "no_body", "sigma", "dpi",
)  # fmt: skip
"""Parameters that have an option of their own in ``plot`` and ``report``."""


class DepthScale(SettingType):
    """The type of the depth scale: 200 or 1:200."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        try:
            return super().convert(value.removeprefix("1:") if isinstance(value, str) else value, param, ctx)
        except click.BadParameter as error:
            text = error.message.replace("must be an integer", "must be a whole number, such as 200 or 1:200")
            raise click.BadParameter(text, ctx, param) from error


SCALE = option_of(members(PrintTable)["scale"])
SCALE[1]["type"] = DepthScale(members(PrintTable)["scale"])

takes_a_drawing = section(
    "Print",
    opt("--well", "Name of the well, as the title.  [as the files state it, else the name of the file]"),
    HEADER,
    SCALAR,
    TEMPLATE,
    BESIDE,
    picks_option(exists=True),
    SCALE,
    *options_of(PrintTable, "unit", "curves", "left", "images", "elevation", "ticks", "casing"),
    LOOK,
    *options_of(PrintTable, "polar", "no_polar"),
    *CRITERIA,
    *options_of(PrintTable, "body", "no_body", "sigma", "dpi"),
)  # fmt: skip


@click.command(cls=Sectioned, common=(*COMMON, "paper"))
@section(
    "Options",
    OUTPUT("Picture to write: .png, .svg or .pdf."),
    QUIET,
)
@section("Print", *options_of(PrintTable, "paper"))
@takes_a_drawing
@takes_a_wall
def plot(**options: Any) -> None:
    """Draw the log of a wall: caliper, radius and images, cross sections, 3-D view.

    \b
    helibore plot well.wall -o well.pdf --scale 1:500
    helibore plot caliper.csv --bit-diameter 8.5in -o well.png
    helibore plot --gauge --bit-diameter 8.5in --image mem.las:ABDC:centre -o images.pdf
    helibore plot wall.glb.toml -o wall.pdf

    SOURCE is an archive (.wall), caliper files, or a project (.toml), by hand or as it stands beside an output.
    The file well.pdf.toml beside well.pdf repeats the run.
    """
    import helibore.plot as drawn
    from helibore.plot.paper import ENDINGS, MM, require_matplotlib

    output = options["output"]
    check_file(output, ENDINGS)
    require_matplotlib()
    terminal = Terminal(options["quiet"])
    run, options, drawing = _drawing("plot", options, terminal)
    with terminal.stage("draw", "Drawing"):
        roll = options["paper"] == "roll" or output.suffix.lower() != ".pdf"
        figures = [drawn.log(run.wall, **drawing)] if roll else drawn.pages(run.wall, options["paper"], **drawing)
    with terminal.stage("save", f"Writing {output.name}"):
        drawn.save(figures, output)
        saved = save_lines(run, output, "plot", options)
    width, height = figures[0].get_size_inches() * MM
    pages = f"{len(figures)} pages of " if len(figures) > 1 else ""
    wide = not roll and round(width) > drawn.PAPERS[options["paper"]][0]
    note = (
        f", wider than {options['paper'].upper()}: if the page is fitted to it, the scale is not true" if wide else ""
    )
    paper = ("paper", f"{pages}{width:,.0f} x {height:,.0f} mm{note}")
    terminal.summary([*run.messages, *_trust(run, options), paper, *saved, ("time", terminal.times())])


@click.command(cls=Sectioned, common=COMMON)
@section("Options", OUTPUT("Page to write: .html."), QUIET)
@takes_a_drawing
@takes_a_wall
def report(**options: Any) -> None:
    """Write a report of a wall as one self-contained HTML page.

    \b
    helibore report well.wall -o well.html --header well="15/9-F-12"
    helibore report caliper.csv --bit-diameter 8.5in -o well.html

    SOURCE and the options are those of `helibore plot`. The page needs no network and prints on A4. The tables
    [cement] and [stress] of a project add the sheet of a casing, and a rose of SHmax.
    """
    output = options["output"]
    check_file(output, PAGES)
    from helibore.plot.paper import require_matplotlib

    require_matplotlib()
    terminal = Terminal(options["quiet"])
    run, options, drawing = _drawing("report", options, terminal)
    from helibore.plot.html_report import report as write

    with terminal.stage("report", "Writing the report"):
        write(run.wall, output, messages=run.messages, **_sections(run, options), **drawing)
        saved = save_lines(run, output, "report", options)
    terminal.summary([*run.messages, *_trust(run, options), *saved, ("time", terminal.times())])


def _sections(run: Run, options: dict[str, Any]) -> dict[str, Any]:
    """Return the cement sheet and the stress of a report whose project has these tables."""
    found: dict[str, Any] = {}
    if run.settings.cement:
        stated_job = {name: run.settings.cement[name] for name in members(CementJob) if name in run.settings.cement}
        missing = next((name for name in ("casing", "shoe") if name not in stated_job), None)
        if missing:
            raise InputError(missing, "must be stated in [cement]", setting=f"cement.{missing}")
        sure = {
            name: run.settings.cement[name] for name in ("sigma", "caliper_accuracy") if name in run.settings.cement
        }
        found["cement"] = run.wall.logs(**sure).cement_sheet(CementJob(**stated_job))
    if run.settings.stress:
        usual = {name: member.default for name, member in members(StressSettings).items()}
        found["stress"], lines = found_stress(run.wall, options | usual | run.settings.stress)
        run.messages += lines
    return found


def _drawing(verb: str, options: dict[str, Any], terminal: Terminal) -> tuple[Run, dict[str, Any], dict[str, Any]]:
    """Make the wall; return the run, all options (also those of a repeated run) and the arguments of a `Drawing`."""
    run = open_run(options, terminal, (options["output"],))
    asked = options["look"]
    options = own_options(run, verb, options)
    looks, settings = dict(options["look"]), stated(PrintSettings, options)
    if (template := template_of_option(options["template"])) is not None:
        if click.get_current_context().get_parameter_source("unit") is ParameterSource.COMMANDLINE:
            raise click.UsageError("--unit: does not go with --template, which states the unit")
        settings = {"scale": template.scale, **settings, "unit": template.unit}
    settings |= {name: () for name in ("polar", "body") if options[f"no_{name}"]}
    from helibore.plot.content import RADIUS
    from helibore.runs.run import make_wall

    make_wall(run, options["threads"], terminal.stage)
    if options["sigma"]:
        run.messages += add_sigma(run.wall, terminal)
    load_picks(run, options["picks"])
    header = header_of(run, options)
    # The settings hold the curves from files with their checksums, the options only the inclination.
    options["scalar"] = tuple(text for text in options["scalar"] if text == INCLINATION)
    scalars = [_with_look(curve, looks) for curve in curves_of_files(run, options)]
    run.messages += _drop_looks(looks, {*asked, *run.wall.images, RADIUS})
    drawing = {
        "title": header.pop("well", run.name),
        "header": header,
        "scalars": scalars,
        "subtitle": run.messages[0][1],
        "start": options["start_depth"],
        "stop": options["stop_depth"],
        "looks": looks,
        "reference": run.reference,
        "template": template,
        "beside": walls_beside(options),
        "criteria": criteria_of(run.wall, options),
        **settings,
    }
    return run, options, drawing


def _trust(run: Run, options: dict[str, Any]) -> Lines:
    """Return the warnings on the wall for the terminal; a report has the same warnings in its summary."""
    return trust_lines(run.wall.logs().between(options["start_depth"], options["stop_depth"]).warnings())


def _drop_looks(looks: dict[str, Look], known: set[str]) -> Lines:
    """Remove the looks of images that this wall lacks, and say so: a project also serves other walls and outputs."""
    gone = [name for name in looks if name not in known]
    for name in gone:
        del looks[name]
    return [("look", f"of {', '.join(gone)}: not used, because the wall has no such image")] if gone else []


def _with_look(curve: ScalarCurve, looks: dict[str, Look]) -> ScalarCurve:
    """Return the curve with the scale that ``--look`` states for its name; remove its entry from ``looks``."""
    look = looks.pop(curve.name, None)
    if look is None:
        return curve
    for word, value in (("window", look.window), ("map", look.color_map)):
        if value is not None:
            raise click.UsageError(f"--look {curve.name}={word}: goes with an image, not with a curve")
    return replace(curve, limits=look.limits, log=bool(look.log))

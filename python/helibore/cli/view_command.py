"""``helibore view SOURCE``: show a wall in the browser. This machine serves the page until Ctrl-C."""

from __future__ import annotations

import logging
import math
from collections.abc import Callable
from contextlib import suppress
from threading import Lock
from typing import TYPE_CHECKING, Any

import click

from helibore.base.errors import InputError
from helibore.base.file_endings import ARCHIVE_ENDING
from helibore.cli.declared_options import options_of
from helibore.cli.lines import trust_lines
from helibore.cli.outputs import QUIET, add_sigma, check_file, own_options
from helibore.cli.quantities import FILE
from helibore.cli.sections import Sectioned, opt, section, spelled
from helibore.cli.terminal import Terminal, echo
from helibore.cli.token_options import TOKEN
from helibore.cli.wall_options import (
    BESIDE,
    PROJECT,
    SCALAR,
    SHOWN,
    TEMPLATE,
    curves_of_files,
    header_of,
    load_picks,
    on_command_line,
    open_run,
    picks_option,
    refuse_interval,
    takes_a_wall,
    template_of_option,
    walls_beside,
)
from helibore.cli.zone_options import CRITERIA, HEADER, criteria_of
from helibore.settings.output_settings import PassageSettings, ViewSettings

if TYPE_CHECKING:
    from pathlib import Path

    from helibore.runs.run import Run
    from helibore.settings.template import Template
    from helibore.trajectory.survey import Path as HolePath
    from helibore.viewer import Viewer, WellsViewer
    from helibore.wall.wall import Wall


@click.command(
    cls=Sectioned,
    common=(*SHOWN, "scalar", "template", "beside", "plan", "picks", "header", "well", "host", "port", "token",
            "token_file", "browser", "html", "body", "sigma"),
)  # fmt: skip
@section("Options", QUIET)
@section(
    "Page",
    SCALAR,
    TEMPLATE,
    BESIDE,
    opt("--plan", "Survey file of the planned path, from the same first depth as --survey.", type=FILE),
    picks_option(exists=False),
    HEADER,
    *CRITERIA,
    opt("--well", "Name to show.  [name of the source]", default=""),
    *options_of(ViewSettings, "host", "port"),
    *TOKEN,
    opt("--browser/--no-browser", "Open the page.", default=True),
    opt("--html", "Write the page with the whole wall as this file, which needs no server, and end.", type=FILE),
    *options_of(PassageSettings, "body"),
    *options_of(ViewSettings, "sigma"),
)
@takes_a_wall
def view(**options: Any) -> None:
    """Show a wall in the browser, until Ctrl-C.

    \b
    helibore view well.wall
    helibore view wall.glb.toml
    helibore view caliper.csv --survey survey.csv --bit-diameter 8.5in
    helibore view --gauge --image lwd.las:GRAS:edge --bit-diameter 8.5in
    helibore view well.wall --html well.html
    helibore view A.wall B.wall C.wall --intervals tops.csv

    SOURCE is an archive (.wall), caliper files, or a project (.toml); several archives are wells, which are shown
    in one scene and side by side with their tops joined. The page saves the beds and fractures that you pick to
    FILE.picks.csv, each well to its own. FILE is the first of these that is given, here or in the settings: caliper
    file, --average, archive, --image, --scalar. --picks names another file for the picks. No other file is written,
    unless --html names one.
    """
    if options["html"]:
        check_file(options["html"], (".html", ".htm"))
    terminal = Terminal(options["quiet"])
    several = len(options["source"]) > 1 and all(file.suffix.lower() == ARCHIVE_ENDING for file in options["source"])
    if several:
        refuse_options_of_one()
    check_page()
    if several:
        show_wells(options, terminal)
        return
    run = open_run(options, terminal)
    options = own_options(run, "view", options)
    refuse_interval(run, options)
    from helibore.base.identity import find_token
    from helibore.runs.run import build_wall, placing, read_run, suit_images
    from helibore.viewer import attributes_of
    from helibore.viewer import view as serve

    images, samples = read_run(run, terminal.stage)
    chosen = any(file.suffix.lower() == PROJECT for file in options["source"])
    suit_images(run, images, samples, chosen or on_command_line("pitch") or on_command_line("sectors"))
    wall = build_wall(run, images, samples, options["threads"], terminal.stage).wall
    if options["sigma"]:
        run.messages += add_sigma(wall, terminal)
    criteria = criteria_of(wall, options)
    picks = load_picks(run, options["picks"])
    run.messages.append(("picks", where_saved(picks)))
    header = header_of(run, options)
    well = header.pop("well", run.name)
    terminal.summary(
        [*run.messages, *trust_lines(wall.summary(options["start_depth"], options["stop_depth"]).warnings)]
    )
    with terminal.stage("images", "Mapping images"):
        attributes = attributes_of(wall)
    serving = {name: options[name] for name in ("host", "port", "browser")} | {"reference": run.reference}
    serving["token"] = find_token(options["token"], options["token_file"])
    serving["browser"] &= options["html"] is None
    curves, template = curves_of_files(run, options), template_of_option(options["template"])
    beside = walls_beside(options)
    with placing(run, path_options(run)):
        viewer = serve(
            wall, path=wall.path, attributes=attributes, curves=curves, picks_file=picks, template=template,
            plan=planned(options["plan"], wall.path), beside=beside, criteria=criteria,
            string=options["body"] or (), well=well, **serving,
        )  # fmt: skip
    drawing = {
        "title": well, "header": header, "scalars": curves, "template": template, "beside": beside,
        "criteria": criteria, "reference": run.reference,
    }  # fmt: skip
    viewer.scene.draw_pages = section_printer(wall, drawing)
    viewer.scene.update_state(ended=True, prints=True)  # no samples will be appended
    if options["html"]:
        with viewer, terminal.stage("page", "Writing the page"):
            viewer.save(options["html"])
        size = f"{options['html'].stat().st_size / 1e6:.1f} MB"
        terminal.summary([("wrote", f"{options['html']}, {size}"), ("time", terminal.times())])
        return
    terminal.summary([("time", terminal.times())])
    serve_page(viewer)


WELLS = ("source", "quiet", "intervals", "intervals_unit", "host", "port", "token", "token_file", "browser", "threads")
"""Parameters that go with several archives."""


def refuse_options_of_one() -> None:
    """Raise UsageError if the command line has an option that does not go with several archives."""
    for parameter in click.get_current_context().command.params:
        if parameter.name not in WELLS and on_command_line(parameter.name or ""):
            raise click.UsageError(f"{spelled(parameter.name or '')}: does not go with several archives")


def show_wells(options: dict[str, Any], terminal: Terminal) -> None:
    """Show the walls of several archives together, until Ctrl-C."""
    from helibore.base.identity import find_token
    from helibore.runs.run import build_wall, read_run
    from helibore.viewer import view_wells

    walls: dict[str, Wall] = {}
    picks: dict[str, Path] = {}
    for file in options["source"]:
        run = open_run(options | {"source": (file,)}, terminal)
        wall = build_wall(run, *read_run(run, terminal.stage), options["threads"], terminal.stage).wall
        name = header_of(run, options).get("well", run.name)
        if name in walls:
            raise InputError(file.name, f"the well {name} is shown already")
        walls[name] = wall
        if own := load_picks(run, None):
            picks[name] = own
        terminal.summary([*run.messages, ("picks", where_saved(own))])
    options = own_options(run, "view", options)
    serving = {name: options[name] for name in ("host", "port", "browser")}
    viewer = view_wells(walls, picks_files=picks, token=find_token(options["token"], options["token_file"]), **serving)
    terminal.summary([("time", terminal.times())])
    serve_page(viewer)


def serve_page(viewer: Viewer | WellsViewer) -> None:
    """Serve a page until Ctrl-C."""
    logging.getLogger("helibore.connections").addHandler(logging.StreamHandler())
    with suppress(KeyboardInterrupt):  # Ctrl-C may come before `wait` expects it
        echo(f"{viewer.url}   (Ctrl-C ends the page)")
        viewer.wait()
    viewer.close()


def where_saved(picks: Path | None) -> str:
    """Return a text on where the picks that are made on the page are saved, or on why they are not saved."""
    from helibore.logs.picks import can_save

    if picks is None:
        return "not saved: only a survey was given"
    if can_save(picks):
        return f"saved in {picks}"
    return f"not saved in {picks}: its folder cannot be written; click Download on the page to keep the picks"


def section_printer(wall: Wall, drawing: dict[str, Any]) -> Callable[..., bytes]:
    """Return a function that draws the wall and its picks between two depths, as pages of a PDF.

    If several threads call this function, only one thread draws at a time.
    """
    lock = Lock()

    def draw(
        start: float,
        stop: float,
        unit: str,
        scale: int | None,
        picture: bytes = b"",
        template: Template | None = None,
        with_picks: bool = True,
    ) -> bytes:
        from helibore.plot import pages, rendered

        top, bottom = sorted((float(wall.depth[0]), float(wall.depth[-1])))
        if stop <= top or start >= bottom:
            raise InputError(f"section {start:g} to {stop:g} m", f"the wall reaches from {top:g} to {bottom:g} m")
        with lock:
            options = {"start": max(start, top), "stop": min(stop, bottom), "unit": unit, "scale": scale, **drawing}
            options |= {"picture": picture, "body": ()} if picture else {}
            options |= {"template": template} if template else {}
            options |= {"with_picks": with_picks}
            return rendered(pages(wall, **options), ".pdf")

    return draw


def path_options(run: Run) -> str:
    """Return options, in brackets for an error text, that make the path reach the whole wall; "" if no option can."""
    wall, path, fixed = run.wall, run.wall.path, run.settings.output is not None
    if path is None or fixed or not wall.depth.size:
        return ""
    options = []
    if path.start_depth > wall.depth.min() and run.settings.archive is None:
        options.append(f"--from {path.start_depth:.10g}m")
    if path.stop_depth < wall.depth.max():
        options.append(f"-s path.extend={math.ceil(100 * (wall.depth.max() - path.survey_depth)) / 100:.10g}m")
    return f" ({' '.join(options)})" if options else ""


def planned(file: Path | None, path: HolePath | None) -> HolePath | None:
    """Return the planned path in a survey file; it begins where the surveyed path begins."""
    if file is None:
        return None
    if path is None:
        raise click.UsageError("--plan: needs --survey")
    from helibore.channels.opening import open as open_log

    with open_log(file) as log:
        plan = log.survey()
    if abs(plan.depth[0] - path.start_depth) > 0.01:
        rule = f"must begin at {path.start_depth:.10g} m, where the survey of the hole begins"
        raise InputError(f"{file}: first station", rule, f"{plan.depth[0]:.10g} m")
    return plan.path(head=path.head)


def check_page() -> None:
    """Raise an error if the viewer's extra or its built page is missing; the error says how to install it."""
    from helibore.viewer.page_server import import_server

    import_server()
    from helibore.viewer.page_files import no_page, page

    if page("app.js") is None:
        raise InputError("viewer", no_page())

"""``helibore view hole.wall`` and ``helibore view CALIPER --bit-diameter 8.5in``: look at a wall in the browser.

A wall that was saved is shown as it is, with its path, images and attributes. A caliper file is rebuilt first, by the
columns and settings of ``helibore reconstruct`` that shape what is seen. The page is served on this machine until
Ctrl-C. Nothing is written.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from helibore.cli.quantities import LENGTH
from helibore.cli.reading import COLUMNS, FILE, SURVEY, nulls, open_calipers, open_survey, taking
from helibore.cli.terminal import Terminal

if TYPE_CHECKING:
    from helibore.arrays import Floats
    from helibore.viewer import Viewer

SERVING = ("host", "port", "token", "browser")  # options that say where, not what; they go to `helibore.view`


@click.command()
@click.argument("file", type=FILE)
@click.option(
    "--bit-diameter", type=LENGTH, help="Bit size, as 8.5in or '8 1/2in' or 0.216m; a saved wall has its own."
)
@taking(*COLUMNS)
@click.option("--from", "start_depth", type=LENGTH, help="Depth to start at.  [shallowest sample]")
@click.option("--to", "stop_depth", type=LENGTH, help="Depth to stop at.  [deepest sample]")
@taking(*SURVEY)
@click.option("--sectors", type=int, default=64, show_default=True, help="Vertices a turn.")
@click.option("--pitch", type=LENGTH, default="100mm", show_default=True, help="Of the helix.")
@click.option("--well", default="", help="Name to show.  [the file's]")
@click.option("--host", default="127.0.0.1", show_default=True, help="Address to serve on; others need --token.")
@click.option("--port", type=click.IntRange(0, 65535), default=0, show_default=True, help="0: a free one.")
@click.option("--token", help="Secret that the page's address must carry.")
@click.option("--browser/--no-browser", default=True, show_default=True, help="Open the page.")
@click.option("-q", "--quiet", is_flag=True, help="Print the address and errors only.")
@click.pass_context
def view(context: click.Context, /, file: Path, quiet: bool, **options: Any) -> None:
    """Show a wall in the browser: FILE is a saved .wall, or calipers in any format `helibore inspect` reads."""
    terminal = Terminal(quiet)
    check_page()
    if file.suffix.lower() == ".wall":
        _refuse_settings(context)
        viewer = _saved(terminal, file, options)
    elif options["bit_diameter"] is None:
        raise click.UsageError("Missing option '--bit-diameter': only a saved .wall has its own.")
    else:
        viewer = _rebuilt(terminal, file, options)
    terminal.summary([("time", terminal.times())])
    click.echo(f"{viewer.url}   (Ctrl-C ends it)")
    viewer.wait()
    viewer.close()


def _saved(terminal: Terminal, file: Path, options: dict[str, Any]) -> Viewer:
    """Show the wall of an archive, coloured by its images and attributes too."""
    with terminal.stage("import", "Loading helibore"):
        import helibore
        from helibore.viewer import Attribute
    with terminal.stage("read", f"Reading {file.name}"):
        wall = helibore.load(file)
        quads = max(len(wall) - wall.settings.sectors - 1, 0)
        values: dict[str | Attribute, Floats] = {}
        for name, image in wall.images.items():
            values[Attribute(name, image.unit)] = image.on(wall)
        for name in wall.attributes:
            unit = wall.attributes.units.get(name, "")
            values[Attribute(name, unit)] = wall.attributes.whole(name, wall.start_depth, quads)
    serving = {name: options[name] for name in SERVING}
    return helibore.view(wall, path=wall.path, attributes=values, well=options["well"] or file.stem, **serving)


def _rebuilt(terminal: Terminal, file: Path, options: dict[str, Any]) -> Viewer:
    """Rebuild the wall of a caliper file and show it."""
    with terminal.stage("import", "Loading helibore"):
        import helibore
        from helibore.run import read, rebuild, told
        from helibore.run_settings import PathSettings, RunSettings
        from helibore.settings import Settings
    with terminal.stage("read", f"Reading {file.name}"):
        way = PathSettings(reference=options["reference"], extend=options["extend"])
        settings = RunSettings(caliper=(), wall=Settings(**_settings(options)), path=way, nulls=nulls(options))
        run = read(settings, open_calipers([file], options), open_survey(options), None)
    with terminal.stage("rebuild", "Rebuilding the wall"):
        wall = rebuild(run)
    terminal.summary(list(told(run)))
    serving = {name: options[name] for name in SERVING}
    return helibore.view(wall, path=run.path, well=options["well"] or file.name.split(".")[0], **serving)


def _refuse_settings(context: click.Context) -> None:
    """A saved wall has its settings: options that would make another one are an error, not ignored."""
    for option in context.command.params:
        given = context.get_parameter_source(option.name or "") is ParameterSource.COMMANDLINE
        if given and option.name not in (*SERVING, "file", "well", "quiet"):
            raise click.UsageError(f"{option.opts[0]}: a saved wall has its own settings, path and values.")


def check_page() -> None:
    """Say how to get the extra or the page where one is missing, before any work."""
    from helibore.viewer.run import import_server

    import_server()
    from helibore.viewer.server import NO_PAGE, page

    if page("app.js") is None:
        raise ValueError(NO_PAGE)


def _settings(options: dict[str, Any]) -> dict[str, Any]:
    names = ("bit_diameter", "sectors", "pitch", "start_depth", "stop_depth")
    settings = {name: options[name] for name in names}
    if options["pitch"] < 0:  # the helix starts at its deep end
        settings["start_depth"], settings["stop_depth"] = options["stop_depth"], options["start_depth"]
    return settings

"""``helibore view FILE``: look at a wall in the browser.

    hole.wall                        a saved wall, as it is: with its path, images and attributes
    hole.glb.toml                    the settings beside a mesh: the run is repeated, from the same files only
    caliper.csv --bit-diameter ...   rebuilt, by those options of `helibore reconstruct` that shape what is seen

The page is served on this machine until Ctrl-C. Nothing is written.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from helibore.cli.quantities import BIT, LENGTH
from helibore.cli.reading import COLUMNS, FILE, SURVEY, nulls, open_calipers, open_survey, taking, wall_settings
from helibore.cli.terminal import Terminal
from helibore.cli.wall_source import SETTINGS
from helibore.wall.archive import ENDING as ARCHIVE

if TYPE_CHECKING:
    from helibore.base.arrays import Floats
    from helibore.viewer import Viewer
    from helibore.wall.wall import Wall

SERVING = ("host", "port", "token", "browser")  # options that say where, not what; they go to `helibore.view`


@click.command(short_help="A wall in the browser.")
@click.argument("file", type=FILE)
@click.option(
    "--bit-diameter",
    type=BIT,
    help="Bit size, as 8.5in or '8 1/2in' or 0.216m; walls and settings have their own.",
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
    """Show a wall in the browser: FILE is a saved .wall, a mesh's .toml, or calipers `helibore inspect` reads.

    \b
    helibore view well.wall
    helibore view wall.glb.toml
    helibore view caliper.csv --survey survey.csv --bit-diameter 8.5in
    """
    terminal = Terminal(quiet)
    check_page()
    ending = file.suffix.lower()
    if ending in (ARCHIVE, SETTINGS):
        _refuse_settings(context, "a saved wall has its" if ending == ARCHIVE else "the settings of a run have their")
        viewer = (_saved if ending == ARCHIVE else _repeated)(terminal, file, options)
    elif ending in _mesh_endings():
        raise ValueError(f"{file.name}: a mesh has no samples to go with it; {_instead(file)}")
    elif options["bit_diameter"] is None:
        raise click.UsageError("Missing option '--bit-diameter': only a saved .wall and settings (.toml) have it.")
    else:
        viewer = _rebuilt(terminal, file, options)
    terminal.summary([("time", terminal.times())])
    click.echo(f"{viewer.url}   (Ctrl-C ends it)")
    viewer.wait()
    viewer.close()


def _mesh_endings() -> tuple[str, ...]:
    from helibore.mesh.mesh_files import SURFACE_ENDINGS, VOLUME_ENDINGS

    return (*SURFACE_ENDINGS, *VOLUME_ENDINGS)


def _instead(mesh: Path) -> str:
    """What to view in place of a mesh."""
    from helibore.runs.run_settings import settings_file

    settings = settings_file(mesh)
    if settings.is_file():
        return f"view the settings beside it: helibore view {settings.name}"
    return f"view its settings ({settings.name}), a saved .wall, or the caliper file"


def _saved(terminal: Terminal, file: Path, options: dict[str, Any]) -> Viewer:
    """Show the wall of an archive."""
    with terminal.stage("import", "Loading helibore"):
        import helibore
    with terminal.stage("read", f"Reading {file.name}"):
        wall = helibore.load(file)
    return _shown(terminal, wall, options["well"] or file.stem, options)


def _repeated(terminal: Terminal, file: Path, options: dict[str, Any]) -> Viewer:
    """Repeat the run whose settings these are and show its wall."""
    with terminal.stage("import", "Loading helibore"):
        from helibore.runs.run import repeat, told
    with terminal.stage("rebuild", f"Repeating {file.name}"):
        run = repeat(file)
    if run.wall is None or run.prepared is None:
        raise RuntimeError("a run without a wall; this is a bug in helibore")
    terminal.summary([*told(run), *run.prepared.report])
    return _shown(terminal, run.wall, options["well"] or file.name.split(".")[0], options)


def _shown(terminal: Terminal, wall: Wall, well: str, options: dict[str, Any]) -> Viewer:
    """Show a wall on its path, coloured by its images and attributes too."""
    import helibore
    from helibore.viewer import Attribute

    with terminal.stage("images", "Mapping images"):
        quads = max(len(wall) - wall.settings.sectors - 1, 0)
        values: dict[str | Attribute, Floats] = {}
        for name, image in wall.images.items():
            values[Attribute(name, image.unit)] = image.on(wall)
        for name in wall.attributes:
            unit = wall.attributes.units.get(name, "")
            values[Attribute(name, unit)] = wall.attributes.whole(name, wall.start_depth, quads)
    serving = {name: options[name] for name in SERVING}
    return helibore.view(wall, path=wall.path, attributes=values, well=well, **serving)


def _rebuilt(terminal: Terminal, file: Path, options: dict[str, Any]) -> Viewer:
    """Rebuild the wall of a caliper file and show it."""
    with terminal.stage("import", "Loading helibore"):
        import helibore
        from helibore.runs.run import placing, read, rebuild, told
        from helibore.runs.run_settings import PathSettings, RunSettings
    with terminal.stage("read", f"Reading {file.name}"):
        way = PathSettings(reference=options["reference"], extend=options["extend"], head=options["head"])
        settings = RunSettings(caliper=(), wall=wall_settings(options), path=way, nulls=nulls(options))
        run = read(settings, open_calipers([file], options), open_survey(options), None)
    with terminal.stage("rebuild", "Rebuilding the wall"):
        wall = rebuild(run)
    terminal.summary(list(told(run)))
    serving = {name: options[name] for name in SERVING}
    wall.path = run.path
    with placing(wall, options["survey"]):
        return helibore.view(wall, path=run.path, well=options["well"] or file.name.split(".")[0], **serving)


def _refuse_settings(context: click.Context, who: str) -> None:
    """A wall that has its settings: options that would make another one are an error, not ignored."""
    for option in context.command.params:
        given = context.get_parameter_source(option.name or "") is ParameterSource.COMMANDLINE
        if given and option.name not in (*SERVING, "file", "well", "quiet"):
            raise click.UsageError(f"{option.opts[0]}: {who} own settings, path and values.")


def check_page() -> None:
    """Say how to get the extra or the page where one is missing, before any work."""
    from helibore.viewer.page_server import import_server

    import_server()
    from helibore.viewer.web_app import no_page, page

    if page("app.js") is None:
        raise ValueError(no_page())

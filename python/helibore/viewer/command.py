"""``helibore view CALIPER --bit-diameter 8.5in``: rebuild a wall and look at it in the browser.

Takes the columns and settings of ``helibore reconstruct`` that shape what is seen, serves the page on this machine
and waits for Ctrl-C. Nothing is written.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from helibore.cli.quantities import LENGTH
from helibore.cli.reading import COLUMNS, FILE, SURVEY, nulls, open_calipers, open_survey, taking
from helibore.cli.terminal import Terminal


@click.command()
@click.argument("caliper", type=FILE)
@click.option("--bit-diameter", type=LENGTH, required=True, help="Bit size, as 8.5in or '8 1/2in' or 0.216m.")
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
def view(caliper: Path, quiet: bool, **options: Any) -> None:
    """Show the wall rebuilt from CALIPER, a file of any format `helibore inspect` reads, in the browser."""
    terminal = Terminal(quiet)
    with terminal.stage("import", "Loading helibore"):
        import helibore
        from helibore.run import read, rebuild, told
        from helibore.run_settings import PathSettings, RunSettings
        from helibore.wall import Settings
    check_page()
    with terminal.stage("read", f"Reading {caliper.name}"):
        way = PathSettings(reference=options["reference"], extend=options["extend"])
        settings = RunSettings(caliper=(), wall=Settings(**_settings(options)), path=way, nulls=nulls(options))
        run = read(settings, open_calipers([caliper], options), open_survey(options), None)
    with terminal.stage("rebuild", "Rebuilding the wall"):
        wall = rebuild(run)
    serving = {name: options[name] for name in ("host", "port", "token", "browser")}
    viewer = helibore.view(wall, path=run.path, well=options["well"] or caliper.name.split(".")[0], **serving)
    if not quiet:
        terminal.summary([*told(run), ("time", terminal.times())])
    click.echo(f"{viewer.url}   (Ctrl-C ends it)")
    viewer.wait()
    viewer.close()


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

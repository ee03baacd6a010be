"""``helibore view CALIPER --bit-diameter 8.5in``: rebuild a wall and look at it in the browser.

Takes the columns and settings of ``helibore reconstruct`` that shape what is seen, serves the page on this machine
and waits for Ctrl-C. Nothing is written.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from helibore.cli.quantities import LENGTH
from helibore.cli.terminal import Terminal

FILE = click.Path(path_type=Path)


@click.command()
@click.argument("caliper", type=FILE)
@click.option("--bit-diameter", type=LENGTH, required=True, help="Bit size, as 8.5in or '8 1/2in' or 0.216m.")
@click.option("--depth", metavar="COLUMN", help="NAME[:UNIT] of the depth.")
@click.option("--toolface", metavar="COLUMN", help="NAME[:UNIT] of the toolface or relative bearing.")
@click.option("--radius", metavar="COLUMN", multiple=True, help="NAME[@ANGLE][:UNIT] of an arm's radius; repeatable.")
@click.option("--diameter", metavar="COLUMN", multiple=True, help="NAME[@ANGLE][:UNIT] of a diameter; repeatable.")
@click.option("--time", metavar="COLUMN", help="NAME[:UNIT] of the time.")
@click.option("--from", "start_depth", type=LENGTH, help="Depth to start at.  [shallowest sample]")
@click.option("--to", "stop_depth", type=LENGTH, help="Depth to stop at.  [deepest sample]")
@click.option("--survey", type=FILE, help="Survey file; without one the hole is straight and vertical.")
@click.option("--extend", type=LENGTH, default="0m", show_default=True, help="Straight on past the last station.")
@click.option("--reference", type=click.Choice(["high-side", "north"]), default="high-side", help="What toolface 0 is.")
@click.option("--sectors", type=int, default=64, show_default=True, help="Vertices a turn.")
@click.option("--pitch", type=LENGTH, default="100mm", show_default=True, help="Of the helix.")
@click.option("--well", default="", help="Name to show.  [the file's]")
@click.option("--host", default="127.0.0.1", show_default=True, help="Address to serve on; others need --token.")
@click.option("--port", type=click.IntRange(0, 65535), default=0, show_default=True, help="0: a free one.")
@click.option("--token", help="Secret that the page's address must carry.")
@click.option("--browser/--no-browser", default=True, show_default=True, help="Open the page.")
@click.option("-q", "--quiet", is_flag=True, help="Print the address and errors only.")
def view(caliper: Path, survey: Path | None, quiet: bool, **options: Any) -> None:
    """Show the wall rebuilt from CALIPER, CSV (.gz) or NPZ, in the browser."""
    terminal = Terminal(quiet)
    with terminal.stage("import", "Loading helibore"):
        import helibore
        from helibore.caliper_file import read_caliper
        from helibore.survey_file import read_survey
    check_page()
    with terminal.stage("read", f"Reading {caliper.name}"):
        columns = {name: options[name] for name in ("depth", "toolface", "radius", "diameter", "time")}
        reading = read_caliper(caliper, **columns)
        path = None
        if survey is not None:
            path = read_survey(survey).survey.path(reference=options["reference"], extend=options["extend"])
    with terminal.stage("rebuild", f"Rebuilding the wall from {len(reading.caliper):,} samples"):
        wall = helibore.reconstruct(reading.caliper, **_settings(options))
    serving = {name: options[name] for name in ("host", "port", "token", "browser")}
    viewer = helibore.view(wall, path=path, well=options["well"] or caliper.name.split(".")[0], **serving)
    if not quiet:
        terminal.summary([("read", note) for note in reading.notes] + [("time", terminal.times())])
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

"""``helibore page``: write the page that rebuilds a wall in a browser, without a server and without this package."""

from __future__ import annotations

from pathlib import Path

import click

from helibore.cli.outputs import QUIET, check_file
from helibore.cli.quantities import FILE
from helibore.cli.sections import opt, section
from helibore.cli.terminal import Terminal


@click.command()
@section("Options", opt("-o --output", "File to write.", type=FILE, default="helibore.html"), QUIET)
def page(output: Path, quiet: bool) -> None:
    """Write one HTML file that reads a caliper log, rebuilds its wall and shows it.

    \b
    helibore page -o helibore.html

    The file needs a browser and nothing else. It asks no machine for anything: open it from disk, mail it, or put it on
    a web server. It reads CSV, TSV and LAS 2, and names the command for what it does not do.
    """
    check_file(output, (".html", ".htm"))
    from helibore.viewer.page_files import offline_page

    content = offline_page()
    output.write_bytes(content)
    Terminal(quiet).summary([("wrote", f"{output}, {len(content) / 1e3:.0f} kB")])

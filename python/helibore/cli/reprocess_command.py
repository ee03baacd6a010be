"""``helibore reprocess manifest.toml``: the walls of many wells, here or on a Dask cluster; ``status`` says how far."""

from __future__ import annotations

import math
import sys
from typing import TYPE_CHECKING

import click

from helibore.cli.outputs import QUIET
from helibore.cli.wall_options import Sectioned, opt, section

if TYPE_CHECKING:
    from helibore.runs.reprocess import Progress

FAILED = 3
"""Exit code where wells failed, or the catalogue could not be written."""


@click.command("reprocess", cls=Sectioned, short_help="Rebuild the walls of many wells, on this machine or a cluster.")
@section(
    "Options",
    opt("-o --output", "Folder of the results, any fsspec address.  [the manifest's]"),
    opt("--scheduler", "Dask scheduler, such as tcp://host:8786.  [a cluster on this machine]", metavar="ADDRESS"),
    QUIET,
)
@click.argument("manifest", nargs=-1, required=True, metavar="[status] MANIFEST")
def reprocess(manifest: tuple[str, ...], output: str | None, scheduler: str | None, quiet: bool) -> None:
    """Rebuild the walls of the wells of MANIFEST: archives, meshes, logs, zones and one catalogue of all.

    \b
    helibore reprocess manifest.toml
    helibore reprocess wells.parquet -o s3://field/walls --scheduler tcp://host:8786
    helibore reprocess status manifest.toml

    MANIFEST is TOML, or a Parquet table with one row a well. A well whose outputs are there, from the same files and
    settings, is not made again; status says which wells are not made or out of date, and starts none. Exit code 3: some
    wells failed, and the others are done.
    """
    from helibore.runs.manifest import read_jobs
    from helibore.runs.reprocess import reprocess as run
    from helibore.runs.reprocess import status

    *words, file = manifest
    if words not in ([], ["status"]):
        raise click.UsageError(f"{' '.join(manifest)}: must be MANIFEST, or status MANIFEST")
    jobs = read_jobs(file, output)
    if words:
        found = status(jobs)
        counts = f"{len(found.skipped)} of {found.wells} wells are done, {len(found.failed)} failed"
        click.echo(f"{counts}, {len(found.outdated)} out of date, {found.unmade} not made")
        for well, changed in sorted(found.outdated.items()):
            click.echo(f"{well}: out of date: changed since it was made: {changed}")
    else:
        found = run(jobs, scheduler, progress=None if quiet else _show)
        if not quiet:
            click.echo(found.sentence())
    for well, reason in sorted(found.failed.items()):
        click.echo(f"{well}: {reason}", err=not words)
    if found.orphans and not quiet:
        click.echo(f"not in {file}, but in the output and its catalogue: {', '.join(found.orphans)}")
    for file, reason in found.unwritten.items():
        click.echo(f"{file}: cannot be written: {reason}", err=True)
    if found.failed or found.unwritten:
        click.get_current_context().exit(FAILED)


def _show(progress: Progress) -> None:
    """Show the progress in one line, which the next one replaces on a terminal; elsewhere every tenth of the wells."""
    if not progress.finished:
        click.echo(f"Dask shows its work at {progress.dashboard}", err=True)
        return
    known = progress.finished < progress.wells and math.isfinite(progress.seconds_left)
    left = f", {progress.seconds_left:.0f} s left" if known else ""
    line = f"{progress.finished} of {progress.wells} wells, {len(progress.failed)} failed{left}"
    if sys.stderr.isatty():
        click.echo(f"\r\x1b[K{line}", err=True, nl=progress.finished == progress.wells)
    elif progress.finished * 10 // progress.wells > (progress.finished - 1) * 10 // progress.wells:
        click.echo(line, err=True)

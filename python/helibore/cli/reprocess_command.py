"""``helibore reprocess manifest.toml``: rebuild many wells, here or on a Dask cluster; ``status`` counts the wells."""

from __future__ import annotations

import math
import signal
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

import click

from helibore.cli.outputs import QUIET
from helibore.cli.sections import Sectioned, opt, section
from helibore.cli.terminal import echo

if TYPE_CHECKING:
    from helibore.runs.manifest import Job
    from helibore.runs.reprocess import Progress

MOST_WARNINGS = 10
"""Greatest number of wells whose warnings are shown."""

MOST_NAMED = 5
"""Greatest number of wells with one fault that are named."""

STOPPED = 130
"""Exit code after Ctrl-C, the code that shells use."""

AGAIN = 0.05
"""Seconds after which a Ctrl-C that Python dropped comes again."""

FAILED = 3
"""Exit code if wells failed, or the catalogue could not be written."""


@click.command("reprocess", cls=Sectioned)
@section(
    "Options",
    opt("-o --output", "Folder of the results, at any fsspec address.  [output in the manifest]"),
    opt("--scheduler", "Address of a Dask scheduler, tls://host:8786.  [a cluster on this machine]", metavar="ADDRESS"),
    opt("--insecure-scheduler", "Allow a scheduler without TLS; whoever reaches it can run code here.", is_flag=True),
    opt("--dashboard", "Serve Dask's dashboard, to every user of this machine.", is_flag=True),
    opt(
        "--workers",
        "Number of processes on this machine.  [one for each processor]",
        type=click.IntRange(1),
        metavar="N",
    ),
    opt("--check", "Read the head of each file, say which wells would fail, and stop.", is_flag=True),
    QUIET,
)
@click.argument("manifest", nargs=-1, required=True, metavar="[status] MANIFEST")
def reprocess(
    manifest: tuple[str, ...],
    output: str | None,
    scheduler: str | None,
    insecure_scheduler: bool,
    dashboard: bool,
    workers: int | None,
    check: bool,
    quiet: bool,
) -> None:
    """Rebuild the walls of the wells of MANIFEST: archives, meshes, logs, zones and one catalogue of all wells.

    \b
    helibore reprocess manifest.toml
    helibore reprocess wells.parquet -o s3://field/walls --scheduler tls://host:8786
    helibore reprocess manifest.toml --check
    helibore reprocess status manifest.toml

    MANIFEST is TOML, or a Parquet table with one row a well. A well whose outputs exist, from the same files and
    settings, is not made again. status counts the wells, and names those that are out of date or have failed; it makes
    no well. Ctrl-C stops the command; wells that are done stay, and a second run makes the other wells. Exit code 2: an
    error before any work; 3: some wells failed and the others are done, or the catalogue could not be written; 130:
    stopped by Ctrl-C.
    """
    from helibore.runs.manifest import check_files, read_jobs
    from helibore.runs.preflight import refused_wells
    from helibore.runs.reprocess import reprocess as run
    from helibore.runs.reprocess import status

    *words, file = manifest
    if words not in ([], ["status"]):
        raise click.UsageError(f"{' '.join(manifest)}: must be MANIFEST, or status MANIFEST")
    jobs = read_jobs(file, output)
    if check:
        check_files(jobs)
        refused = refused_wells(jobs)
        echo(f"{len(jobs) - len(refused)} of {len(jobs)} wells have caliper files that can be read")
        _show_failures(refused, jobs)
        click.get_current_context().exit(FAILED if refused else 0)
    if words:
        found = status(jobs)
        counts = f"{len(found.skipped)} of {found.wells} wells are done, {len(found.failed)} failed"
        echo(f"{counts}, {len(found.outdated)} out of date, {found.unmade} not made")
        for well, changed in sorted(found.outdated.items()):
            echo(f"{well}: out of date: changed since it was made: {changed}")
    else:
        seen: list[Progress] = []

        def show(progress: Progress) -> None:
            seen[:] = [progress]
            if not quiet:
                _show(progress)

        try:
            with ctrl_c_again_where_ignored():
                found = run(
                    jobs, scheduler, workers=workers, insecure=insecure_scheduler, dashboard=dashboard, progress=show
                )
        except KeyboardInterrupt:
            counts = f"; {seen[0].sentence()}" if seen else ""
            echo(f"\nstopped{counts}: run the command again to go on, and to write the catalogue", err=True)
            click.get_current_context().exit(STOPPED)
        if not quiet:
            echo(found.sentence())
            _show_warnings(found.warnings)
    _show_failures(found.failed, jobs, err=not words)
    if found.orphans and not quiet:
        echo(f"wells in the output and its catalogue, but not in {file}: {', '.join(found.orphans)}")
    for file, reason in found.unwritten.items():
        echo(f"{file}: cannot be written: {reason}", err=True)
    if found.failed or found.unwritten:
        click.get_current_context().exit(FAILED)


@contextmanager
def ctrl_c_again_where_ignored() -> Iterator[None]:
    """Raise Ctrl-C again if Python drops it, as it does in Dask's callbacks of the garbage collector."""

    def drop(of: sys.UnraisableHookArgs) -> None:
        if isinstance(of.exc_value, KeyboardInterrupt):
            threading.Timer(AGAIN, signal.raise_signal, [signal.SIGINT]).start()
        else:
            before(of)

    before, sys.unraisablehook = sys.unraisablehook, drop
    try:
        yield
    finally:
        sys.unraisablehook = before


def _show(progress: Progress) -> None:
    """Show the progress in a line. On a terminal it replaces the previous line; elsewhere at most ten lines are shown.

    Before the first well is finished, show their number, and the address of Dask's dashboard if it is served.
    """
    if not progress.seconds:
        shown = f"; Dask shows its work at {progress.dashboard}" if progress.dashboard else ""
        echo(f"making {progress.wells - progress.finished} wells{shown}", err=True)
        return
    known = progress.finished < progress.wells and math.isfinite(progress.seconds_left)
    left = f", {progress.seconds_left:.0f} s left" if known else ""
    line = f"{progress.finished} of {progress.wells} wells, {len(progress.failed)} failed{left}"
    if sys.stderr.isatty():
        echo(line, err=True, nl=progress.finished == progress.wells, over=True)
    elif progress.finished * 10 // progress.wells > (progress.finished - 1) * 10 // progress.wells:
        echo(line, err=True)


def _show_failures(failed: Mapping[str, str], jobs: Sequence[Job], err: bool = False) -> None:
    """Show each reason once, with the wells that it concerns, and the remedy that this command has for headers."""
    from helibore.runs.preflight import REMEDY, grouped

    for reason, wells in grouped(failed, jobs):
        more = f" and {len(wells) - MOST_NAMED} more" if len(wells) > MOST_NAMED else ""
        echo(f"{', '.join(sorted(wells)[:MOST_NAMED])}{more}: {reason}", err=err)
    if any("role" in reason or "unit missing" in reason for reason in failed.values()):
        echo(REMEDY, err=err)


def _show_warnings(warnings: Mapping[str, str]) -> None:
    """Show the warnings of the first `MOST_WARNINGS` wells by name; the catalogue has all warnings."""
    for well in sorted(warnings)[:MOST_WARNINGS]:
        echo(f"{well}: {warnings[well]}", err=True)
    if (left := len(warnings) - MOST_WARNINGS) > 0:
        more = f"{left} more wells have" if left > 1 else "1 more well has"
        echo(f"{more} warnings; see the column warnings of the catalogue", err=True)

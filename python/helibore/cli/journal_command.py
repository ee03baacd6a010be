"""``helibore journal``: check, list, replay, export and archive the journal of a live wall."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from helibore.cli.lines import counts_line
from helibore.cli.outputs import OUTPUT, check_file
from helibore.cli.quantities import FILE, FOLDER
from helibore.cli.sections import opt, section
from helibore.cli.terminal import echo

if TYPE_CHECKING:
    from helibore.live.journal.journal import Segment
    from helibore.live.live import Live

JOURNAL = click.argument("folder", type=click.Path(path_type=Path, exists=True, file_okay=False))
CONFIGURATION = opt(
    "-c --configuration", "Read the journal with this configuration.  [the configuration in the journal]", type=FILE
)


@click.group(short_help="Check, list, replay, export and archive a journal.")
def journal() -> None:
    """Work with the journal of a live wall. Of these commands, only archive changes a journal.

    \b
    helibore journal list well-7.journal
    helibore journal verify well-7.journal
    """


@journal.command("list")
@JOURNAL
def list_(folder: Path) -> None:
    """List the sessions, segments and checkpoints of the journal in FOLDER.

    \b
    helibore journal list well-7.journal
    """
    from helibore.base.utc_time import utc
    from helibore.live.journal import checkpoint
    from helibore.live.journal.journal_extracts import sessions

    begun = sessions(folder)
    for segment in _segments(folder):
        wall, lost = segment.records["wall"], sum(stop - start for start, stop in segment.damage)
        times = f"{utc(int(wall[0]))} to {utc(int(wall[-1]))}" if len(wall) else "no record"
        damage = f", {lost:,} bytes damaged" if lost else ""
        echo(f"{segment.path.name}: {len(segment.text):,} bytes, {len(wall):,} records, {times}{damage}")
    for number, (time, text) in enumerate(begun, 1):
        same = number == 1 or text == begun[number - 2][1]
        echo(f"session {number}: {utc(time)}{'' if same else ', with another configuration'}")
    for path in checkpoint.paths(folder):
        with suppress(FileNotFoundError):  # a running `helibore live` has replaced the checkpoint
            echo(f"{path.name}: {path.stat().st_size:,} bytes, records up to {checkpoint.position(path) - 1:,}")


@journal.command()
@JOURNAL
def verify(folder: Path) -> None:
    """Check every record and checkpoint of the journal in FOLDER; end with exit code 2 if any is damaged or missing.

    \b
    helibore journal verify well-7.journal && echo intact
    """
    from helibore.base.errors import InputError
    from helibore.live.journal import checkpoint
    from helibore.live.journal.journal import header_of

    lost = records = salt = 0
    last = -1
    for segment in _segments(folder):
        numbers = segment.records["sequence"]
        records += len(numbers)
        damage = segment.damage_texts()
        if len(numbers) and int(numbers[0]) > last + 1 and not damage and last >= 0:
            damage = [f"{segment.path.name}: records {last + 1} to {int(numbers[0]) - 1} are missing before this file"]
        for text in damage:
            echo(text)
        lost += len(damage)
        last = int(numbers[-1]) if len(numbers) else last
        header = header_of(segment.path)
        salt = header.salt if header else salt
    for path in checkpoint.paths(folder):
        try:
            with suppress(FileNotFoundError):  # a running `helibore live` has replaced the checkpoint
                checkpoint.read(path, salt)
        except InputError as error:
            echo(str(error))
            lost += 1
    if lost:
        places = f"{lost} places are damaged" if lost > 1 else "1 place is damaged"
        raise InputError(str(folder), f"{places}, {records:,} records are intact")
    echo(f"{folder}: {records:,} records are intact")


@journal.command()
@JOURNAL
@section(
    "Options",
    CONFIGURATION,
    opt("--since", "UTC time or number of the first record that --configuration applies to.  [the first record]"),
    opt("-o --output", "Folder to write wall, mesh, logs, images and events to, as helibore live does.", type=FOLDER),
)
def replay(folder: Path, configuration: Path | None, since: str | None, output: Path | None) -> None:
    """Build the wall again from the journal in FOLDER, with a corrected configuration if one is given.

    \b
    helibore journal replay well-7.journal -c corrected.toml -o corrected
    helibore journal replay well-7.journal -c sidetrack.toml --since 2026-05-01T10:00:00Z -o corrected
    """
    from helibore.live.journal.journal_extracts import record_at
    from helibore.live.snapshot_files import snapshot

    if since and not configuration:
        raise click.UsageError("--since needs --configuration")
    live = _replayed(folder, configuration, record_at(folder, since) if since else 0)
    for event in live.model.events.latest:
        echo(str(event))
    if output:
        snapshot(live, output)
    echo(counts_line(live) + (f"; written to {output}" if output else ""))


@journal.command()
@JOURNAL
@section(
    "Options",
    CONFIGURATION,
    opt(
        "-o --output",
        "Folder to write to: one file for the bytes of each record, damaged range and torn end.",
        type=FOLDER,
    ),
)
def quarantine(folder: Path, configuration: Path | None, output: Path | None) -> None:
    """List the records that were set aside from the journal in FOLDER, its damaged ranges, and its torn ends.

    A torn end is a record that was written only in part, and that a restart cut off.

    \b
    helibore journal quarantine well-7.journal -o set-aside
    """
    from helibore.base.atomic_file import write_whole
    from helibore.base.utc_time import utc
    from helibore.live.journal.journal_extracts import quarantine as set_aside

    found: dict[str, bytes] = {}
    model = _replayed(folder, configuration).model
    for one in set_aside(folder, model.set_aside, model.numbers):
        echo(f"record {one.sequence}: {utc(one.wall)} {one.source or 'helibore'} {one.kind}, "
                   f"{len(one.payload):,} bytes: {one.reason}")  # fmt: skip
        found[f"record-{one.sequence}.bin"] = one.payload
    for segment in _segments(folder):
        for (start, stop), text in zip(segment.damage, segment.damage_texts(), strict=True):
            echo(text)
            found[f"{segment.number:06d}-{start}.bin"] = segment.text[start:stop]
    for path in sorted(folder.glob("*.torn")):
        echo(f"{path.name}: {path.stat().st_size:,} bytes were cut off at a restart")
        found[path.name] = path.read_bytes()
    if output:
        output.mkdir(parents=True, exist_ok=True)
        for name, content in found.items():
            write_whole(output / name, lambda file, content=content: file.write(content), private=True)  # type: ignore[misc]
    echo(f"{folder}: {len(found)} items set aside" + (f"; written to {output}" if output and found else ""))


@journal.command()
@JOURNAL
@section(
    "Options",
    CONFIGURATION,
    OUTPUT("A .csv file: a row for each value. A .wits file: the bytes that one source sent."),
    opt("--source", "Name of the source.  [.csv: all sources; .wits: the only source]"),
)
def export(folder: Path, configuration: Path | None, output: Path, source: str | None) -> None:
    """Write what the journal in FOLDER holds to a file for other programs.

    \b
    helibore journal export well-7.journal -o well-7.csv
    helibore journal export well-7.journal --source mwd -o mwd.wits
    """
    import io

    from helibore.base.atomic_file import write_whole
    from helibore.base.errors import InputError
    from helibore.live.journal.journal_extracts import export_bytes, export_csv
    from helibore.live.journal.session_header import sources_of
    from helibore.live.rules.configuration import load

    check_file(output, (".csv", ".wits"))
    sources = sources_of(folder, load(configuration) if configuration else None, source)
    wits = output.suffix.lower() == ".wits"
    if wits and len(sources) > 1:
        names = ", ".join(one.name for one in sources.values())
        raise InputError("--source", f"must be one of {names}: a .wits file has one source")
    counts = []

    def write(file: Any) -> None:
        with _progress(folder) as step:
            if wits:
                counts.append(export_bytes(folder, next(iter(sources)), file, step))
            else:
                text = io.TextIOWrapper(file, "utf-8", newline="", write_through=True)
                counts.append(export_csv(folder, sources, text, step))
                text.detach()

    write_whole(output, write, private=True)
    echo(f"{output}: {counts[0]:,} {'bytes' if wits else 'rows'}")


@journal.command()
@JOURNAL
@click.option("--remove", is_flag=True, help="Delete old segments. A replay of the whole journal is then impossible.")
def archive(folder: Path, remove: bool) -> None:
    """Compress the old segments of the journal in FOLDER into its folder archive; the journal may be in use.

    A segment is old if both checkpoints of the journal contain all records of the segment. Segments that are not old
    are never changed.

    \b
    helibore journal archive well-7.journal
    """
    from helibore.live.journal.archived_segments import archive as put_away

    with _progress(folder) as step:
        done = put_away(folder, remove=remove, report=step)
    what = "removed" if remove else f"moved to {folder / 'archive'}"
    echo(f"{len(done)} segments {what}" if done else f"{folder}: no segment is old")


def _replayed(folder: Path, file: Path | None, since: int = 0) -> Live:
    from helibore.live.live import Live
    from helibore.live.rules.configuration import load

    with _progress(folder) as step:
        return Live.replay(folder, load(file) if file else None, step, since)


def _segments(folder: Path) -> Iterator[Segment]:
    """Yield the segments of a journal, and show on a terminal how many have been read."""
    from helibore.live.journal.journal import segments

    with _progress(folder) as step:
        for segment in segments(folder):
            step(segment)
            yield segment


@contextmanager
def _progress(folder: Path) -> Iterator[Callable[[object], None]]:
    """Show on a terminal, after the first second, how many segments are done; yield a function to count one more."""
    import sys
    import time

    from helibore.live.journal.journal import all_paths

    total, begun, done = len(all_paths(folder)), time.monotonic(), 0
    shown = sys.stderr.isatty()

    def step(_: object) -> None:
        nonlocal done
        done += 1
        if shown and time.monotonic() - begun > 1:
            echo(f"{done} of {total} segments", nl=False, err=True, over=True)

    yield step
    if shown and time.monotonic() - begun > 1:
        echo("", nl=False, err=True, over=True)

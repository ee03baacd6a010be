"""Open every file of a corpus in this process, under a limit on its memory and processor time; print what came of each.

    python tests/python/hostile/open_all.py FOLDER [SECONDS] [MEGABYTES]

A line for each file: its name, "opened" or the class of the error, the error's text, seconds of processor time, and
megabytes of memory that the process took at most. A process that is ended by a file names it in the line before.
"""

from __future__ import annotations

import json
import resource
import signal
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import helibore as hb
from helibore.channels.roles import guess


class TooLongError(BaseException):
    """A file took more processor time than is allowed."""


def open_log(path: Path) -> None:
    with hb.open(path) as file:
        for one in file.sets:
            guess(one)
            for channel in one:
                _ = channel.values


def open_journal(path: Path) -> None:
    from helibore.live.journal.journal import segments

    with tempfile.TemporaryDirectory(prefix="journal-") as name:
        (Path(name) / "000001.hbj").write_bytes(path.read_bytes())
        for segment in segments(name):
            for row in range(len(segment.records)):
                segment.payload(row)


def open_checkpoint(path: Path) -> None:
    from helibore.live.journal import checkpoint

    checkpoint.read(path, 0)


def open_live(path: Path) -> None:
    from helibore.live.rules.configuration import load

    load(path)


def open_manifest(path: Path) -> None:
    from helibore.runs.manifest import check_files, read_jobs

    check_files(read_jobs(path))


def open_settings(path: Path) -> None:
    from helibore.settings.template import Template

    Template.load(path)


def open_picks(path: Path) -> None:
    from helibore.logs.picks import Picks

    Picks.load(path)


OPENERS: dict[str, Any] = {
    "wall": hb.load, "picks": open_picks, "manifest": open_manifest, "live": open_live, "settings": open_settings,
    "journal": open_journal, "checkpoint": open_checkpoint,
}  # fmt: skip


def peak() -> float:
    """The most memory since the last call, MB."""
    status = Path("/proc/self/status").read_text()
    Path("/proc/self/clear_refs").write_text("5")
    return int(status.partition("VmHWM:")[2].split()[0]) / 1024


def main(folder: Path, seconds: float = 5.0, megabytes: int = 500) -> None:
    import importlib

    for library in ("pyarrow.parquet", "pyarrow.csv", "lasio", "dlisio.dlis", "dlisio.lis", "python_calamine"):
        importlib.import_module(library)
    data = int(Path("/proc/self/status").read_text().partition("VmData:")[2].split()[0]) << 10
    resource.setrlimit(resource.RLIMIT_DATA, (data + (megabytes << 20), resource.RLIM_INFINITY))

    def stop(*_: object) -> None:
        raise TooLongError

    signal.signal(signal.SIGPROF, stop)
    for path in sorted(folder.iterdir()):
        print(path.name, end="\t", flush=True)
        peak()
        begun, outcome, text = time.process_time(), "opened", ""
        signal.setitimer(signal.ITIMER_PROF, seconds)
        try:
            OPENERS.get(path.name.partition("-")[0], open_log)(path)
        except (Exception, TooLongError) as error:
            outcome, text = type(error).__name__, str(error)
        signal.setitimer(signal.ITIMER_PROF, 0)
        print(json.dumps([outcome, text, round(time.process_time() - begun, 3), round(peak())]), flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]), *map(float, sys.argv[2:3]), *map(int, sys.argv[3:4]))

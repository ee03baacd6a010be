"""Notes that a worker of this machine leaves of its task: they say which task a dead process was at, and why it died.

    begin a task     a line is added to the task's note
    a fatal signal   the interpreter adds "Fatal Python error: Aborted" to the note, and the process ends
    end a task       the note is deleted

Dask gives the tasks of a dead worker to another worker, and cannot know which of them ended the process. Here a task
finds its own note: after a fatal error it is refused, because it would end the next process in the same way. After it
was killed from outside, for example because memory ran out, it is tried again a few times.
"""

from __future__ import annotations

import faulthandler
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from helibore.base.errors import InputError

FOLDER = "helibore.fault-notes"
"""The key of Dask's configuration with the folder of the notes; Dask hands its configuration to its workers."""

BEGUN, FATAL = "begun\n", "Fatal Python error: "


@contextmanager
def noted(name: str, tries: int) -> Iterator[None]:
    """Keep a note of a task while it runs, if this process has a folder for notes.

    Raises
    ------
    InputError
        If a process ended with a fatal error at this task, or ``tries`` processes were killed at it.
    """
    import dask

    folder = dask.config.get(FOLDER, None)
    if folder is None:
        yield
        return
    path = Path(folder) / name
    earlier = path.read_text(errors="replace") if path.exists() else ""
    if FATAL in earlier:
        fault = earlier.partition(FATAL)[2].partition("\n")[0]
        raise InputError("process", f"ended with a fatal error ({fault}); not tried again")
    if earlier.count(BEGUN) >= tries:
        raise InputError("process", f"was killed {tries} times, perhaps because memory ran out")
    with path.open("a") as note:
        note.write(BEGUN)
        note.flush()
        faulthandler.enable(note, all_threads=False)
        try:
            yield
        finally:
            faulthandler.disable()
    path.unlink()

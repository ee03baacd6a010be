"""Archive old segments of a journal: compress them into its folder ``archive``, or delete them.

A segment is old if both checkpoints of the journal can be read whole and contain all its records. So a restart never
needs an archived segment, not even if the newest checkpoint is damaged. A replay of the whole journal reads archived
segments; only the checkpoints contain the records of deleted segments. ``helibore live`` archives old segments
if ``[journal] keep_days`` is set.
"""

from __future__ import annotations

import itertools
import zlib
from collections.abc import Callable
from pathlib import Path

from helibore.base.atomic_file import make_folder, write_whole
from helibore.base.errors import InputError
from helibore.live.journal import checkpoint
from helibore.live.journal.journal import ARCHIVE, content, first_wall, header_of, paths


def old_segments(folder: Path, before: int | None = None) -> list[Path]:
    """Return the segments whose records both checkpoints contain, but never the last segment.

    If ``before`` is given (ns since 1970), return only the segments that were complete at that time: the first record
    of the next segment was received then or earlier.

    Raises
    ------
    InputError
        If ``folder`` holds no journal, or if the journal does not have two checkpoints that can be read.
    FileNotFoundError
        If a newer checkpoint has replaced one of the two checkpoints meanwhile.
    """
    found, positions = paths(folder), []
    if not found:
        raise InputError(str(folder), "holds no journal (no file 000001.hbj)")
    last = header_of(found[-1])
    for path in checkpoint.paths(folder)[-checkpoint.KEPT :]:
        checkpoint.read(path, last.salt if last else -1, only_facts=True)
        positions.append(checkpoint.position(path))
    if len(positions) < checkpoint.KEPT:
        raise InputError(str(folder), f"has {len(positions)} of the {checkpoint.KEPT} checkpoints that archiving needs")
    old = []
    for path, after in itertools.pairwise(found):
        header = header_of(after)
        if header and header.sequence <= min(positions) and (before is None or 0 < first_wall(after) <= before):
            old.append(path)
    return old


def archive(
    folder: Path, *, remove: bool = False, before: int | None = None, report: Callable[[Path], None] = lambda _: None
) -> list[Path]:
    """Archive or ``remove`` the `old_segments`; return their former paths, and call ``report`` after each segment.

    Raises
    ------
    InputError
        For the reasons of `old_segments`, or if an archived segment differs from the original, which then stays.
    OSError
        If the disk refuses a file, if a newer checkpoint has replaced one of the two checkpoints meanwhile, or if
        another process has just archived a segment.
    """
    done = old_segments(folder, before)
    for path in done:
        if not remove:
            text = path.read_bytes()
            make_folder(folder / ARCHIVE)
            target = folder / ARCHIVE / f"{path.name}.gz"
            packed = zlib.compress(text, 6, zlib.MAX_WBITS | 16)
            write_whole(target, lambda file, packed=packed: file.write(packed), private=True)  # type: ignore[misc]
            if content(target) != (text, ""):
                raise InputError(str(target), f"does not have the contents of {path.name}")
        path.unlink(missing_ok=True)
        report(path)
    return done

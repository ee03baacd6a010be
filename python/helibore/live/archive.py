"""Archive old segments of a journal: compress them into its folder ``archive``, or delete them.

A segment is old if both checkpoints of the journal can be read whole and contain all its records. So a restart never
needs an archived segment, not even if the newest checkpoint is damaged. Archived segments are read by a replay of the
whole journal; after a deletion only the checkpoints know what was in them.
"""

from __future__ import annotations

import gzip
from collections.abc import Callable
from pathlib import Path

from helibore.base.atomic_file import write_whole
from helibore.base.errors import InputError
from helibore.live import checkpoint
from helibore.live.journal import ARCHIVE, content, header_of, paths


def old_segments(folder: Path) -> list[Path]:
    """Return the segments that both checkpoints contain; never the last one.

    Raises
    ------
    InputError
        If the journal has no two checkpoints that can be read.
    """
    found, positions = paths(folder), []
    if not found:
        raise InputError(str(folder), "holds no journal (no file 000001.hbj)")
    last = header_of(found[-1])
    for path in checkpoint.paths(folder)[-checkpoint.KEPT :]:
        checkpoint.read(path, last.salt if last else -1)
        positions.append(checkpoint.position(path))
    if len(positions) < checkpoint.KEPT:
        raise InputError(str(folder), f"has {len(positions)} of the {checkpoint.KEPT} checkpoints that archiving needs")
    headers = [header_of(path) for path in found[1:]]
    return [
        path for path, after in zip(found, headers, strict=False) if after and after.sequence <= min(positions)
    ]  # fmt: skip


def archive(folder: Path, *, remove: bool = False, report: Callable[[Path], None] = lambda _: None) -> list[Path]:
    """Archive or ``remove`` all old segments and return their former paths; ``report`` gets each when it is done.

    Raises
    ------
    InputError
        As `old_segments`, or if an archived segment does not have the bytes of the original, which then stays.
    OSError
        If the disk refuses.
    """
    done = old_segments(folder)
    for path in done:
        if not remove:
            text = path.read_bytes()
            (folder / ARCHIVE).mkdir(exist_ok=True)
            target = folder / ARCHIVE / f"{path.name}.gz"
            packed = gzip.compress(text, 6, mtime=0)
            write_whole(target, lambda file, packed=packed: file.write(packed))  # type: ignore[misc]
            if content(target) != text:
                raise InputError(str(target), f"differs from {path.name}")
        path.unlink()
        report(path)
    return done

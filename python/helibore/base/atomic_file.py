"""Write files whole or not at all: to a temporary file in the same folder, flushed to disk, then renamed.

A reader sees the old file or the new one, never a part, even after a loss of power. Not for files that grow.
"""

from __future__ import annotations

import contextlib
import os
import secrets
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO


def write_whole(path: str | os.PathLike[str], writer: Callable[[BinaryIO], object]) -> None:
    """Call ``writer`` with a temporary binary file in the folder of ``path``, then rename that file to ``path``.

    Parameters
    ----------
    path
        The file to write; it is replaced if it exists. Its folder must exist.
    writer
        Writes the whole content. If it raises, ``path`` does not change and the temporary file is deleted.

    Raises
    ------
    OSError
        If the folder does not exist or cannot be written to, or the disk is full; it names ``path``.
    """

    target = Path(path)
    beside = target.with_name(f".{target.name}.{secrets.token_hex(4)}.part")
    try:
        with beside.open("xb") as file:
            writer(file)
            file.flush()
            os.fsync(file.fileno())
        beside.replace(target)
    except BaseException as error:
        with contextlib.suppress(OSError):
            beside.unlink(missing_ok=True)
        if isinstance(error, OSError) and error.errno is not None:
            raise type(error)(error.errno, error.strerror, str(target)) from error
        raise
    _flush_folder(target.parent)


def _flush_folder(folder: Path) -> None:
    """Flush the rename to disk. Systems that cannot open a folder flush it when they choose."""
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)

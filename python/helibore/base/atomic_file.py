"""Whole files or none: written beside, flushed to disk, then renamed.

A reader, or a machine that loses power, meets the old file or the new one, never a part. Not for files that grow.
"""

from __future__ import annotations

import contextlib
import os
import secrets
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO


def write_whole(path: str | os.PathLike[str], writer: Callable[[BinaryIO], object]) -> None:
    """Call ``writer`` with a binary file beside ``path``, then put that file in the place of ``path``.

    Parameters
    ----------
    path
        The file to write; replaced if it is there. Its folder must be.
    writer
        Writes the whole content. If it raises, ``path`` stays as it was and nothing is left beside it.

    Raises
    ------
    OSError
        If the folder is not there or cannot be written to, or the disk is full; it names ``path``.
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
    """Make the rename itself last; some systems cannot open a folder, and then the system's own pace must do."""
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)

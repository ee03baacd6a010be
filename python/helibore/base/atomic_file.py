"""Write files whole or not at all: to a temporary file in the same folder, flushed to disk, then renamed.

A reader sees the old file or the new one, never a part, even after a loss of power. Files that grow, such as journals,
are written by other code.
"""

from __future__ import annotations

import contextlib
import os
import secrets
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

PRIVATE = 0o600
"""Rights of a file that only its owner may read: journals and what is made of them hold what a rig or store sent."""


def write_whole(path: str | os.PathLike[str], writer: Callable[[BinaryIO], object], private: bool = False) -> None:
    """Call ``writer`` with a temporary binary file in the folder of ``path``, then rename that file to ``path``.

    A ``private`` file gets the rights `PRIVATE`. If ``writer`` raises, ``path`` does not change and the temporary file
    is deleted. An OSError names ``path``.
    """
    target = Path(path)
    beside = target.with_name(f".{target.name}.{secrets.token_hex(4)}.part")
    try:
        rights = PRIVATE if private else 0o666
        with open(beside, "xb", opener=lambda name, flags: os.open(name, flags, rights)) as file:
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
    with contextlib.suppress(OSError):  # not every system can open a folder
        sync_folder(target.parent)


def make_folder(folder: Path) -> None:
    """Make a folder, and those of its parents that do not exist, and flush the names of the new folders to the disk."""
    missing = [one for one in (folder, *folder.parents) if not one.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    for one in missing:
        sync_folder(one.parent)


def sync_folder(folder: Path) -> None:
    """Flush the list of files of a folder to the disk, so that new and renamed files survive a loss of power."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)

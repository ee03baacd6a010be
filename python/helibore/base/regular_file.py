"""Refuse a name that stands for something else than a file before it is opened: a pipe would wait for ever."""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path

from helibore.base.errors import InputError

KINDS = {stat.S_IFIFO: "a pipe", stat.S_IFSOCK: "a socket", stat.S_IFCHR: "a device", stat.S_IFBLK: "a device"}


def check_regular(path: Path) -> None:
    """Raise InputError for a pipe, socket or device, IsADirectoryError for a folder, OSError if nothing is there."""
    mode = stat.S_IFMT(path.stat().st_mode)
    if mode == stat.S_IFDIR:
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if mode in KINDS:
        raise InputError(str(path), f"is {KINDS[mode]}: must be a file; write its content to a file first")

"""Names of layers and images as parts of the names of files: which can be, and how they are written.

    "GR", "../x", "a/b"      ->      image-GR.csv, image-..%2Fx.csv, image-a%2Fb.csv          no folder is left

Which files there are is in ``snapshot.py``.
"""

from __future__ import annotations

LONGEST = 200
"""Bytes; a file system takes 255, and ``image-`` and what is written beside want some."""
RULE = f"must be printable and at most {LONGEST} bytes, for files are named after it"


def escaped(name: str) -> str:
    """Return a name that leads into no other folder, and is another for another name."""
    for character in "%/\\":
        name = name.replace(character, f"%{ord(character):02X}")
    return name


def can_be_file(name: str) -> bool:
    """Whether files can be named after ``name``."""
    return name.isprintable() and len(escaped(name).encode()) <= LONGEST

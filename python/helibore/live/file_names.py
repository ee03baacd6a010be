"""Names of layers and images as parts of file names: which names are allowed, and how they are escaped.

    "GR", "../x", "a/b"      ->      image-GR.csv, image-..%2Fx.csv, image-a%2Fb.csv     always in the folder

``snapshot.py`` lists the files.
"""

from __future__ import annotations

LONGEST = 200
"""Bytes; a file system allows 255, and ``image-`` and the ending of a temporary file need some of them."""
RULE = f"must be printable and at most {LONGEST} bytes, for files are named after it"


def escaped(name: str) -> str:
    """Return ``name`` without folder separators; two different names never become the same."""
    for character in "%/\\":
        name = name.replace(character, f"%{ord(character):02X}")
    return name


def can_be_file(name: str) -> bool:
    """Return whether ``name`` can be part of the name of a file."""
    return name.isprintable() and len(escaped(name).encode()) <= LONGEST

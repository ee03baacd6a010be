"""Names of layers and images as parts of file names: which names are allowed, and how they are escaped.

    "GR", "../x", "a/b"      ->      image-GR.csv, image-..%2Fx.csv, image-a%2Fb.csv     always in the folder

``snapshot_files.py`` lists the files.
"""

from __future__ import annotations

LONGEST = 200
"""Most bytes of a name: fewer than the 255 of a file system, to leave room for ``image-`` and temporary endings."""
RULE = f"must be printable and at most {LONGEST} bytes, because files are named after it"


def escaped(name: str) -> str:
    r"""Return ``name`` with ``%``, ``/`` and ``\`` as ``%25``, ``%2F`` and ``%5C``; different names stay different."""
    for character in "%/\\":
        name = name.replace(character, f"%{ord(character):02X}")
    return name


def can_be_file(name: str) -> bool:
    """Return whether ``name`` can be part of the name of a file."""
    return name.isprintable() and len(escaped(name).encode()) <= LONGEST

"""Walk through the rows of DLIS records, value by value, before dlisio reads them.

    record = name of the frame (OBNAME), then rows: frame number (UVARI) and the values of a row; mostly one row

dlisio 1.0 ends the process if a text states more bytes than its record has, and it counts records, not rows. So the
records of a frame with texts, or with several rows in a record, are walked first.
"""

from __future__ import annotations

from collections.abc import Iterable

SIZES = dict(zip("rfbBxVFzZcCdDluUL", (2, 4, 8, 12, 4, 4, 8, 16, 24, 8, 16, 1, 2, 4, 1, 2, 4), strict=True))
SIZES |= {"j": 8, "q": 1}
"""Bytes of a value by dlisio's letter of its type (FSHORT to ULONG, DTIME, STATUS)."""

PARTS = {"i": "i", "J": "i", "s": "s", "Q": "s", "S": "S", "o": "ius", "O": "sius", "A": "siuss"}
"""The parts of a value of no fixed size: i an integer of 1, 2 or 4 bytes, u one byte, s a short and S a long text."""


def has_texts(layout: str) -> bool:
    """Return whether rows of a layout (`dlisio.dlis.Frame.fmtstr`) hold values of no fixed size."""
    return not set(PARTS).isdisjoint(layout[1:])


def rows_of(records: Iterable[bytes], layout: str) -> int:
    """Return how many rows of a layout the records hold; ValueError if a value runs past the end of its record."""
    steps = _steps(layout)
    count = 0
    for record in records:
        at = _past("o", record, 0)
        while at < len(record):
            for step in steps:
                at = at + step if isinstance(step, int) else _past(step, record, at)
            if at > len(record):
                raise ValueError("a value runs past the end of its record")
            count += 1
    return count


def _steps(layout: str) -> list[int | str]:
    """Return the layout with neighbours of fixed size joined to their number of bytes."""
    steps: list[int | str] = []
    for letter in layout:
        if letter in PARTS:
            steps.append(letter)
        elif steps and isinstance(steps[-1], int):
            steps[-1] += SIZES[letter]
        else:
            steps.append(SIZES[letter])
    return steps


def _past(letter: str, record: bytes, at: int) -> int:
    """Return the offset behind a value of no fixed size."""
    for part in PARTS[letter]:
        first = record[at] if at < len(record) else 0
        if part in "iS":
            size = (1, 1, 2, 4)[first >> 6]
            length = int.from_bytes(record[at : at + size], "big") & (0xFFFFFFFF >> (0, 0, 18, 2)[first >> 6])
            at += size + (length if part == "S" else 0)
        else:
            at += 1 + (first if part == "s" else 0)
        if at > len(record):
            raise ValueError("a value runs past the end of its record")
    return at

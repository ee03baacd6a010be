"""The limits on what one input may ask for. Each is a number that an environment variable may raise.

    HELIBORE_LIMIT_CELLS=50000000 helibore inspect survey.xlsx

The message of a limit says its value and this variable.
"""

from __future__ import annotations

import os

from helibore.base.errors import InputError

LIMITS = {
    "unpacked": 1 << 25,  # bytes to which a packed file may always unpack; `RATIO` limits larger ones
    "cells": 5_000_000,  # of the sheets of a workbook, with the empty ones up to the last row and column
    "sheets": 100,  # of a workbook
    "connections": 128,  # of a page's server; fewer if the process may have fewer than four times as many descriptors
    "token_seconds": 5,  # until a connection to page or metrics has shown the token
    "downloads": 2,  # sections that the page's server writes at a time
    "prints": 2,  # that the page's server has in work at a time
    "members": 1_000,  # of the zip archive that a workbook is
    "columns": 20_000,  # of a table or a log; also other items of a section of the header of LAS
}
"""For each limit its default; the variable is HELIBORE_LIMIT_ and the name in upper case."""


def limit_variable(name: str) -> str:
    """Return the name of the environment variable that changes a limit."""
    return f"HELIBORE_LIMIT_{name.upper()}"


RATIO = 200
"""Most unpacked bytes per packed byte. Logs of mostly -999.25 reach a ratio of 100; gzip bombs can reach 1,032."""


def limit(name: str) -> int:
    """Return the value of a limit; raise InputError if the variable is not a whole number above 0."""
    variable = limit_variable(name)
    text = os.environ.get(variable)
    if text is None:
        return LIMITS[name]
    if not (text.isascii() and text.isdigit() and int(text) > 0):
        raise InputError(variable, "must be a whole number above 0", repr(text))
    return int(text)


def check_limit(place: str, name: str, value: int) -> None:
    """Raise InputError if a value is above a limit."""
    most = limit(name)
    if value > most:
        rule = f"{value:,} {name.replace('_', ' ')}: must be at most {most:,}; {limit_variable(name)} raises this"
        raise InputError(place, rule)


def check_unpacked(place: str, unpacked: int, packed: int) -> None:
    """Raise InputError if a packed file unpacks to more bytes than the limit, and than `RATIO` times its packed bytes.

    ``unpacked`` must be counted, not taken from the file: a directory can lie.
    """
    free = limit("unpacked")
    if unpacked > free and unpacked > RATIO * packed:
        rule = f"unpacks to more than {RATIO} times its size, and to more than {free:,} bytes: refused as a bomb"
        raise InputError(place, f"{rule}; {limit_variable('unpacked')} raises this")
